"""Blocks, and the parts of a case that contacts read, for the tests of contacts."""

import math
from types import SimpleNamespace

import numpy as np

from parsim.case.model import Faces
from parsim.geometry.rotation import from_angles, matrices, turn_of
from parsim.solid.bodies import Bodies
from parsim.solid.laws import DEFAULT
from parsim.solid.shapes import BoxShape

HALF, MASS, MU = (0.03625, 0.03625, 0.00975), 0.089, 0.412
GRAVITY = (0.0, 0.0, -9.81)
EDGE = from_angles((math.degrees(math.atan2(HALF[1], HALF[2])), 0.0, 0.0))  # centre above an edge
_ACROSS = np.cross(HALF, (0.0, 0.0, 1.0)) / np.hypot(*HALF[:2])
CORNER = np.array(turn_of(*(_ACROSS * math.acos(HALF[2] / math.hypot(*HALF)))))  # centre above a corner
FLAT = (1.0, 0.0, 0.0, 0.0)


def boxes(*half):
    """Shapes of boxes of these half edges (3,), m."""
    return [BoxShape(size=tuple(2.0 * float(h) for h in each)) for each in half]


class Plate:
    """A gate that has always been rising."""

    half = np.array([0.0025, 1e3, 1e3])

    def bottom(self, time):
        return 0.4 * time

    def centre(self, time):
        return np.array([0.5025, 0.0, self.bottom(time) + self.half[2]])

    def velocity(self, time):
        return 0.4


def case(
    restitution=0.8545,
    friction=MU,
    gravity=GRAVITY,
    walls=("z_min",),
    young=1e7,
    steps=20,
    law=DEFAULT,
    rolling=0.0,
    ramp=0.0,
    strength=None,
    **other,
):
    """The parts of a case that contacts read; soft materials make long sub-steps."""
    faces = dict.fromkeys([f"{a}_{s}" for a in "xyz" for s in ("min", "max")], "open") | dict.fromkeys(walls, "wall")
    material = SimpleNamespace(
        young=young,
        poisson=0.4,
        friction=friction,
        restitution=restitution,
        rolling=rolling,
        crushing_strength=strength,
    )
    numbers = SimpleNamespace(steps_per_contact=steps, law=law, pairs=())
    box = SimpleNamespace(min=(0.0, 0.0, 0.0), max=(1.0, 1.0, 1.0), faces=Faces(**faces | other))
    return SimpleNamespace(
        dimensions=3,
        axes=(0, 1, 2),
        gravity=gravity,
        gravity_ramp=ramp,
        contacts=numbers,
        gate=None,
        materials={"ice": material},
        wall_material="ice",
        box=box,
    )


def blocks(positions, **other):
    return Bodies(boxes(*[HALF] * len(positions)), [MASS] * len(positions), positions, **other)


def go(bodies, contacts, dt, steps, time=0.0, load=None):
    load = np.zeros((len(bodies), 6)) if load is None else load
    for step in range(steps):
        contacts.step(bodies, load, time + step * dt, dt)


def momenta(bodies):
    turn = matrices(bodies.quaternion)
    linear = (bodies.mass[:, None] * bodies.velocity).sum(axis=0)
    own = [r @ (i * (r.T @ w)) for r, i, w in zip(turn, bodies.inertia, bodies.spin, strict=True)]
    return linear, np.sum(own, axis=0) + (bodies.mass[:, None] * np.cross(bodies.position, bodies.velocity)).sum(axis=0)


def budget(bodies, contacts, gravity=GRAVITY):
    energy = bodies.kinetic_energy() + bodies.potential_energy(gravity) + contacts.elastic_energy()
    return energy + contacts.dissipated - contacts.driven_work
