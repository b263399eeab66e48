"""The tables of a case about the friction of water, and its eddies, and what may be wrong with them."""

import math
from typing import Annotated, Literal

from pydantic import Field

from parsim.case.types import LEAST, NotNegative, Real, Switch, Table
from parsim.geometry.faces import names_of_walls, velocities_of_walls

FaceName = Literal["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"]


class Friction(Table):
    """How walls, gate and bodies rub the water."""

    kind: Literal["wall_law", "no_slip"] = Field(
        description="wall_law: the stress of a turbulent layer; no_slip: water is at rest at the wall, for flows whose "
        "layers are resolved"
    )
    roughness: NotNegative = Field(
        0.0, description="equivalent sand roughness ks of walls and gate, and of bodies whose material has none, m"
    )
    walls: tuple[FaceName, ...] | None = Field(None, description="sides that rub; left out: all that are walls")
    bodies: Switch = Field(True, description="whether bodies rub")


class Eddies(Table):
    """Eddy viscosity nu_t = l^2 |S|."""

    kind: Literal["mixing_length", "smagorinsky"] = Field(
        description="mixing_length: l = 0.41 d sqrt(1 - d/H) over the floor, 0.41 d at sides; smagorinsky: that, at "
        "most constant times two spacings"
    )
    constant: Annotated[Real, Field(ge=LEAST, le=0.5)] = Field(0.15, description="Smagorinsky's constant")


def faults(case):
    """What is wrong with the friction of a completed case: messages."""
    out, friction = [*_sliding(case)], case.water.friction
    own = [n for n, m in case.materials.items() if m.roughness is not None]
    if not case.water.scheme.WET:
        given = [f"water.{name}" for name in ("friction", "eddies") if getattr(case.water, name) is not None]
        return out + [f"{name}: there is no water" for name in given + [f"materials.{name}.roughness" for name in own]]
    walls = names_of_walls(case)
    if case.water.eddies is not None and case.water.eddies.kind == "mixing_length" and not walls:
        out.append('water.eddies.kind = "mixing_length": there is no wall to be at a distance from; use "smagorinsky"')
    if friction is None:
        return out + [f"materials.{name}.roughness: nothing rubs the water; water.friction is missing" for name in own]
    if friction.kind == "no_slip":
        if case.water.viscosity == 0.0:
            out.append('water.viscosity = 0.0: must be more than 0 with water.friction.kind = "no_slip"')
        given = [("water.friction.roughness", friction.roughness)] if friction.roughness else []
        given += [(f"materials.{name}.roughness", case.materials[name].roughness) for name in own]
        out += [f'{key} = {value!r}: is for kind = "wall_law"; without slip walls are smooth' for key, value in given]
    wrong = [name for name in friction.walls or () if name not in walls]
    allowed = ", ".join(walls) or "none"
    return out + [f'water.friction.walls = "{name}": is no wall; allowed: {allowed}' for name in wrong]


def _sliding(case):
    """What is wrong with sides that move."""
    friction, walls = case.water.friction, names_of_walls(case)
    free = [body.name for body in case.bodies if not body.fixed]
    for name, velocity in zip(walls, velocities_of_walls(case).tolist(), strict=True):
        key, across = f"box.faces.{name}.velocity = {velocity}", "xyz".index(name[0])
        if not any(velocity):
            continue
        if velocity[across] != 0.0:
            yield f"{key}: {name[0]} must be 0; a side moves in its own plane"
        elif case.dimensions == 2 and velocity[1] != 0.0:
            yield f"{key}: y must be 0 in a 2D case"
        elif friction is None or name not in (walls if friction.walls is None else friction.walls):
            yield f"{key}: nothing feels it; water.friction is missing, or this side is not in its walls"
        elif free:
            yield f"{key}: bodies.{free[0]}: must be fixed; contacts do not feel that a side moves"
        elif math.hypot(*velocity) > case.speed:
            yield f"{key}: is more than the largest expected speed, {case.speed:.4g} m/s; give water.speed"


def doubts(case):
    """What is allowed but doubtful: messages."""
    friction = case.water.friction
    if friction is None or friction.kind == "no_slip":
        return
    given = {"water.friction.roughness": friction.roughness}
    given |= {f"materials.{n}.roughness": m.roughness for n, m in case.materials.items() if m.roughness is not None}
    if case.water.viscosity == 0.0 and not all(given.values()):
        yield "water.viscosity = 0.0: what is smooth rubs such water with no stress at all; 1e-6 m2/s is that of water"
    most = 30.0 * 1.5 * case.spacing / math.e
    for key, rough in given.items():
        if rough > most:
            yield (
                f"{key} = {rough!r}: more than {most:.3g} m; the water that walls see, 1.5 spacings off, then lies "
                "within the roughness, and the stress is that of water at e / 30 of it"
            )
