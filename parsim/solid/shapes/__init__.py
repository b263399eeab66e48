"""Shapes of bodies: what exists is listed here."""

from parsim.case.types import choice
from parsim.solid.shapes.box import BoxShape

Shape = choice(BoxShape)
