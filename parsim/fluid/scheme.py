"""What every scheme of the water is, and all that it may touch."""

from typing import NamedTuple, Protocol


class Flow(NamedTuple):
    """The water: `Particles`, `Neighbours`, `Domain` (refreshing, sum, count, max); no rank, no case, no body.

    speed, m/s: the largest of anything; keep: the share of velocity kept in this step, less than 1 while it settles;
    gravity, m/s2: what pulls in this step; turning: how the box turns (`coupling.moving.Turning`), or None.
    """

    particles: object
    near: object
    domain: object
    speed: float = 0.0
    keep: float = 1.0
    gravity: tuple = (0.0, 0.0, 0.0)
    turning: object = None


class Solids(Protocol):
    """What a step may ask of walls, gate and bodies (`parsim.coupling.solids`).

    depths: `turbulence.Depths` of the water, None where there are no eddies.
    """

    depths: object

    def place(self, flow, time, ahead):
        """Bring the samples of all that is solid to where it is at time + ahead, s."""

    def normals(self, flow, out):
        """Write to `out`, Vectors of the particles, the unit normals of all samples into the water."""

    def hold(self, flow, at_rest):
        """Give water beyond an outlet, at the half step, the pressure that is there by the scheme's `at_rest`."""

    def release(self, flow):
        """Give it, at the full step, the velocity that it goes on with."""

    def rub(self, flow):
        """What the water feels of the friction of walls and bodies, slip and share of samples; None where none rubs."""

    def sliding(self):
        """Samples of walls that move in their own planes, (n,); None where none do."""

    def slide(self, flow, force, dt):
        """Note what these do on the water in dt, s: `force` (n, 3), N, is its friction on them."""

    def pushed(self):
        """Whether there is anything that the water can push."""

    def push(self, flow, reaction, time, dt):
        """Let the water push the bodies: `reaction` is its force on the samples `near.body` and what that depends on.

        The accelerations that follow, and the pressures with them, are then those of the samples.
        """

    def sides(self, flow, weight, dt):
        """What bodies show of their surface in this step, a `sides.Sides`; how wet it is goes to the field `n`."""

    def loosen(self, flow, reaction, faces, time, dt):
        """The same without the pressures of the water: how what they push gives way, a `Mobility`, None if nothing.

        `reaction` is that without them; faces: what `sides` gave, its weight, how wet samples are.
        """

    def give_way(self, flow, change, dt):
        """Change the accelerations of bodies and of their samples by `change` (bodies, 6), m/s2 and 1/s2."""

    def driven(self, time):
        """Whether anything solid is driven from outside at `time`, s."""

    def drive(self, flow, reaction, time, dt):
        """Account for the work that what is driven does on the water, whose `reaction` on `near.gate` it is."""

    def advance(self, flow, time, dt):
        """Move the bodies over dt, s, under what has pushed them, gravity and contacts, and place the samples there."""


class Scheme(Protocol):
    """One way to move the water. `step` is one screen and reads like the method.

    STATE: names of the fields whose values at the end of a step are needed of the neighbouring slabs. lattice: a
    `reference.Lattice`; mass of a particle, kg; sound, m/s: what nothing may be faster than.
    """

    STATE: tuple
    lattice: object
    mass: float
    sound: float

    def at_rest(self, pressure):
        """Fields of water at rest at pressures (n,), Pa: name -> (n,)."""

    def time_step(self, speed, acceleration):
        """Stable time step, s, at the largest speed, m/s, and acceleration, m/s2."""

    def step(self, flow, solids, time, dt):
        """Advance the water by dt, s, and with `solids` all that is in it."""

    def rubbed(self, flow, solids, at):
        """Force of friction, N, on the samples `at`: (n, 3)."""

    def extremes(self, p, near, start):
        """Largest speed, m/s, of this rank's water, infinite when not finite, and largest distance from `start`, m."""

    def compression(self, p, at):
        """Density of the particles `at` over that of the water at no pressure, (n,)."""

    def shares(self, p, at):
        """Mass of the particles `at` over `mass`, (n,)."""

    def elastic(self, p, at):
        """Elastic energy of the particles `at`, J, (n,)."""
