"""What a case may say of the semi-implicit scheme."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from parsim.case.types import LEAST, Count, Real, Share, Table
from parsim.fluid.simps.fields import FIELDS
from parsim.geometry.faces import SIDES, names_of_walls, velocities_of_walls


class Settings(Table):
    """Semi-implicit moving particles (Amaro et al. 2021, sec. 4.1).

    Where a default is not that of the article, the article's is named. With all of those at once water at rest boils
    and sinks: on H/20 it has lost a quarter of its level after 4 s, which it keeps to 0.02 % with the defaults.
    """

    WET: ClassVar[bool] = True

    kind: Literal["simps"] = Field(description="semi-implicit moving particles: time steps by the flow, not by sound")
    weight: Literal["wendland_c2", "mps"] = Field(
        "wendland_c2", description="weight of the sums over neighbours; the article's is mps, re / r - 1"
    )
    support: Real = Field(2.6, ge=2.1, le=4, description="radius of the support over the spacing; the article's is 2.1")
    courant: Annotated[Real, Field(ge=LEAST, le=1)] = Field(
        0.2, description="time step over spacing / largest speed, where run.cfl is 1"
    )
    sound: Real = Field(
        100.0,
        ge=10,
        le=1e4,
        description="speed of sound, by which water gives way to pressure, over the largest expected speed; the "
        "article's compressibility, 1e-8 1/Pa, makes it 316 m/s",
    )
    divergence: Share = Field(
        1.0, description="share of the divergence of the velocity that a step takes away; the article's is 0.01"
    )
    relaxation: Share = Field(
        0.5,
        description="share of what water lies too close that a step as long as at rest takes away; the article's is "
        "0.01 of any step",
    )
    noise_damping: Share = Field(
        0.2, description="share of what changes from particle to particle that a step takes away; the article's is 0"
    )
    least_pressure: Share = Field(
        0.3, description="share of the least pressure around in what gradients count from; the article's is 1"
    )
    collision_distance: Share = Field(0.8, description="distance of particles that come too close, over the spacing")
    restitution: Share = Field(0.2, description="restitution of particles that come too close")
    tolerance: Annotated[Real, Field(ge=1e-14, le=0.1)] = Field(
        1e-5, description="residual of the pressure equation over its right-hand side"
    )
    preconditioner: Literal["lattice", "diagonal"] = Field(
        "lattice",
        description="what the solver of the pressure equation looks through: a lattice of nodes, with few iterations "
        "for any number of particles, or the diagonal alone, whose messages stay short on very many ranks",
    )
    iterations: Count = Field(2000, description="iterations of the solver after which a run is given up")

    @property
    def fields(self):
        """The fields of particles, those of every scheme with them."""
        return FIELDS

    def sound_speed(self, speed):
        """Speed of sound, m/s, where `speed`, m/s, is the largest expected one."""
        return self.sound * speed

    def doubts(self):
        """Nothing to doubt."""
        return []

    def faults(self, case):
        """What of a case this scheme cannot do: messages."""
        with_it = f'with water.scheme.kind = "{self.kind}"'
        water, out = case.water, []
        if water.eddies is not None:
            out.append(f"water.eddies: there are none {with_it}; leave them out")
        if water.friction is not None and water.friction.kind != "wall_law":
            out.append(f'water.friction.kind = "{water.friction.kind}": must be "wall_law" {with_it}')
        for name, velocity in zip(names_of_walls(case), velocities_of_walls(case).tolist(), strict=True):
            if any(velocity):
                out.append(f"box.faces.{name}.velocity = {velocity}: sides stand {with_it}; leave it out")
        for name in (name for axis in case.axes for name in SIDES[axis]):
            kind = getattr(case.box.faces, name).kind
            if kind in ("inlet", "outlet"):
                out.append(f'box.faces.{name} = "{kind}": must be a wall, open or periodic {with_it}')
        if case.motion is not None and case.motion.kind != "sway":
            out.append(f'motion.kind = "{case.motion.kind}": must be "sway" {with_it}')
        return out

    def scheme(self, case, timers=None):
        """The scheme that moves the water of a case."""
        from parsim.fluid.simps.scheme import SIMPS  # brings numba along, whose settings a run makes first

        return SIMPS(case, timers)
