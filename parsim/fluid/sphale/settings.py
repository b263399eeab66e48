"""What a case may say of the scheme of smoothed particles in arbitrary Lagrangian-Eulerian form."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from parsim.case.types import Real, Share, Switch, Table
from parsim.fluid.sphale.fields import FIELDS

_LARGEST_CFL = 1.0
_LIGHTEST = 0.6  # spacings of water that a body weighs, from which it floats still; at 0.4 it shakes (2D, 0.5 s)


class Settings(Table):
    """Smoothed particles with Riemann fluxes between them (Robb et al. 2016)."""

    WET: ClassVar[bool] = True

    kind: Literal["sphale"] = Field(description="smoothed particles with Riemann fluxes between them")
    sound: Real = Field(10.0, ge=5, le=1000, description="speed of sound over the largest expected speed")
    weight: Literal["wendland_c4", "wendland_c2"] = Field(
        "wendland_c2", description="weight of the sums over neighbours: the slope of this kernel"
    )
    support: Real = Field(3.0, ge=2.1, le=4, description="radius of the support over the spacing")
    stages: Literal[2, 3] = Field(3, description="stages of a step in time; of two, sound grows at a cfl near 1")
    dissipation: Share = Field(
        0.1,
        description="least share of the jump of pressure by the speed of approach, which takes more of it by itself",
    )
    evening: Annotated[Real, Field(ge=0, le=0.2)] = Field(
        0.05, description="how fast neighbours swap water until their volumes are even, over the speed of sound"
    )
    recovery: Share = Field(
        0.1, description="rate at which volumes become those of the particles' arrangement, over 2 sqrt(g / depth)"
    )
    shifting: Switch = Field(True, description="whether particles leave the water's velocity to stay evenly spread")

    @property
    def fields(self):
        """The fields of particles, those of every scheme with them."""
        return FIELDS

    def sound_speed(self, speed):
        """Speed of sound, m/s, where `speed`, m/s, is the largest expected one."""
        return self.sound * speed

    def faults(self, case):
        """What of a completed case this scheme does not know yet: messages."""
        faces = case.box.faces
        given = {
            "water.friction": case.water.friction is not None,
            "water.eddies": case.water.eddies is not None,
            "channel": case.channel is not None,
            "motion": case.motion is not None,
        }
        for name in type(faces).model_fields:
            side = getattr(faces, name)
            given[f'box.faces.{name} = "{side.kind}"'] = side.kind in ("inlet", "outlet")
            given[f"box.faces.{name}.velocity"] = any(getattr(side, "velocity", None) or ())
        out = [
            f'{key}: is not in water.scheme.kind = "sphale"; leave it out, or use "wcmps"'
            for key, here in given.items()
            if here
        ]
        if case.run.cfl > _LARGEST_CFL:
            out.append(
                f'run.cfl = {case.run.cfl!r}: must be at most {_LARGEST_CFL!r} with water.scheme.kind = "sphale"'
            )
        return out + [f"bodies.{body.name}: {text}" for body in case.bodies for text in _too_light(case, body)]

    def doubts(self):
        """Nothing to doubt."""
        return []

    def scheme(self, case, timers=None):
        """The scheme that moves the water of a case."""
        from parsim.fluid.sphale.scheme import SPHALE  # brings numba along, whose settings a run makes first

        return SPHALE(case, timers)


def _too_light(case, body):
    """Whether water would shake a body: a message, or nothing."""
    if body.fixed or (body.density is None) == (body.mass is None):
        return
    side = 2.0 * body.shape.thinnest(case.dimensions == 2)
    density, least = case.density_of(body), _LIGHTEST * case.water.density * case.spacing
    if density * side < (1.0 - 1e-9) * least:
        yield (
            f"density {density:.6g} kg/m3 times its thinnest side, {side:.6g} m: must be at least {least:.6g} kg/m2, "
            f'{_LIGHTEST:g} spacings of water, with water.scheme.kind = "sphale"'
        )
