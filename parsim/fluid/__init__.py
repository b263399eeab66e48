"""Water: the schemes that move it are listed here, what they share stands beside their folders."""

from parsim.case.types import choice
from parsim.fluid.wcmps import settings as wcmps

Scheme = choice(wcmps.Settings)
DEFAULT = wcmps.Settings()
