"""Water: the schemes that move it are listed here, what they share stands beside their folders."""

from typing import get_args

from parsim.case.types import choice
from parsim.fluid.dry import settings as dry
from parsim.fluid.simps import settings as simps
from parsim.fluid.sphale import settings as sphale
from parsim.fluid.wcmps import settings as wcmps

_WET = wcmps.Settings, simps.Settings, sphale.Settings
Scheme = choice(*_WET, dry.Settings)
SCHEMES = tuple(get_args(each.model_fields["kind"].annotation)[0] for each in _WET)
DEFAULT, DRY = wcmps.Settings(), dry.Settings(kind="none")
