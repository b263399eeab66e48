"""What a case may say of the weakly compressible scheme."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from parsim.case.types import Real, Share, Switch, Table
from parsim.fluid.wcmps.fields import FIELDS


class Settings(Table):
    """Weakly compressible moving particles (Mellado 2021, ch. 5)."""

    WET: ClassVar[bool] = True

    kind: Literal["wcmps"] = Field("wcmps", description="weakly compressible moving particles")
    sound: Real = Field(10.0, ge=5, le=1000, description="speed of sound over the largest expected speed")
    weight: Literal["wendland_c4", "wendland_c2", "mps"] = Field(
        "wendland_c4", description="weight of the sums over neighbours; mps is re / r - 1"
    )
    support: Real = Field(3.1, ge=2.1, le=4, description="radius of the support over the spacing")
    diffusion: Share = Field(0.5, description="diffusion of density, delta")
    noise_damping: Annotated[Real, Field(ge=0, le=0.005)] = Field(
        0.00015, description="damping of what changes from particle to particle: a biharmonic viscosity over c0 l0^3"
    )
    restitution: Share = Field(0.5, description="restitution of water that comes too close to walls and bodies")
    collision_distance: Share = Field(0.9, description="distance of water that comes too close, over the spacing")
    shifting: Switch = Field(True, description="whether particles are shifted to keep them evenly spread")
    recovery: Share = Field(
        0.3, description="rate at which shifted water takes the density of its arrangement, over 2 sqrt(g / depth)"
    )

    @property
    def fields(self):
        """The fields of particles, those of every scheme with them."""
        return FIELDS

    def sound_speed(self, speed):
        """Speed of sound, m/s, where `speed`, m/s, is the largest expected one."""
        return self.sound * speed

    def faults(self, case):
        """Nothing of a completed case is unknown to it."""
        return []

    def doubts(self):
        """What is allowed but doubtful, messages: a support with which water at rest does not stay so (2D, 1 s)."""
        if self.support >= 2.6:
            return []
        return [
            f"water.scheme.support = {self.support!r}: too small: water at rest boils at 2.1, and at 2.3 to 2.5 its "
            "pressure scatters by 0.1 to 1 % where that is 0.01 % at 3.1; 2.7 or more is quiet"
        ]

    def scheme(self, case, timers=None):
        """The scheme that moves the water of a case."""
        from parsim.fluid.wcmps.scheme import WCMPS  # brings numba along, whose settings a run makes first

        return WCMPS(case, timers)
