"""Sides of the box: what exists is listed here."""

from parsim.boundary.sides.inlet import InletSide
from parsim.boundary.sides.open import OpenSide
from parsim.boundary.sides.outlet import OutletSide
from parsim.boundary.sides.periodic import PeriodicSide
from parsim.boundary.sides.wall import WallSide
from parsim.case.types import choice

Side = choice(WallSide, OpenSide, PeriodicSide, InletSide, OutletSide)
WALL, OPEN = WallSide(), OpenSide()
