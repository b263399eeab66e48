"""Water: the schemes that move it are listed here, what they share stands beside their folders."""

from parsim.case.types import choice
from parsim.fluid.dry import settings as dry
from parsim.fluid.simps import settings as simps
from parsim.fluid.sphale import settings as sphale
from parsim.fluid.wcmps import settings as wcmps

Scheme = choice(wcmps.Settings, simps.Settings, sphale.Settings, dry.Settings)
DEFAULT, DRY = wcmps.Settings(), dry.Settings(kind="none")
