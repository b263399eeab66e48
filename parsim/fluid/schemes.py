"""The schemes of the water: what exists is listed here."""

from parsim.case.types import choice
from parsim.fluid.wcmps import settings as wcmps

Scheme = choice(wcmps.Settings)
DEFAULT = wcmps.Settings()
