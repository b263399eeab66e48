"""The tables of a case about the friction of water, and its eddies."""

from typing import Annotated, Literal

from pydantic import Field

from parsim.case.types import NotNegative, Real, Switch, Table

FaceName = Literal["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"]


class Friction(Table):
    """How walls, gate and bodies rub the water."""

    kind: Literal["wall_law", "no_slip"] = Field(
        description="wall_law: the stress of a turbulent layer; no_slip: water is at rest at the wall, for flows whose "
        "layers are resolved"
    )
    roughness: NotNegative = Field(
        0.0, description="equivalent sand roughness ks of what has no material of its own, m; 0 is smooth"
    )
    walls: tuple[FaceName, ...] | None = Field(None, description="sides that rub; left out: all that are walls")
    bodies: Switch = Field(True, description="whether bodies rub")


class Eddies(Table):
    """Eddy viscosity nu_t = l^2 |S|."""

    kind: Literal["mixing_length", "smagorinsky"] = Field(
        description="mixing_length: l = 0.41 d sqrt(1 - d/H) over the floor, 0.41 d at sides; smagorinsky: that, at "
        "most constant times two spacings"
    )
    constant: Annotated[Real, Field(gt=0, le=0.5)] = Field(0.15, description="Smagorinsky's constant")
