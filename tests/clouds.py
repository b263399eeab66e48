"""Small particle clouds for the tests of lists and sweeps, and the weights of their neighbours in plain formulas."""

import numpy as np

from parsim.domain.comm import Comm
from parsim.domain.domain import Domain
from parsim.fluid.wcmps.fields import FIELDS
from parsim.particles.cells import Grid
from parsim.particles.neighbours import Neighbours
from parsim.particles.state import FLUID, WALL, Particles, make_id


def _mps(r, radius):
    w = np.maximum(radius / r - 1, 0)
    return w, w


def _wendland_c2(r, radius):
    q = np.minimum(r / radius, 1)
    w = q**2 * (1 - q) ** 3
    return w, (1 - q) ** 4 * (4 * q + 1) + 1.5 * w


def _wendland_c4(r, radius):
    q = np.minimum(r / radius, 1)
    w = q**2 * (1 - q) ** 4 * (1 + 4 * q)
    return w, (1 - q) ** 5 * (1 + 5 * q + 8 * q**2) + 1.8 * w


# W and the measure of concentration at distances r (n,)
PLAIN = {"mps": _mps, "wendland_c2": _wendland_c2, "wendland_c4": _wendland_c4}


class Fixed:
    """A source of samples that are always there."""

    def __init__(self, particles):
        self.particles = particles

    def samples(self, slab, time):
        p = self.particles
        return p.take(slab.cells(p.x, p.y, p.z) >= 0)


def cloud(count, size, seed, walls=0):
    """`count` random fluid particles and `walls` wall ones in a box of `size` (3,), with random fields."""
    rng = np.random.default_rng(seed)
    place = rng.uniform(0, 1, (count + walls, 3)) * size
    kind = np.where(np.arange(count + walls) < count, FLUID, WALL)
    ident = np.concatenate([make_id(FLUID, np.arange(count)), make_id(WALL, np.arange(walls))])
    every = Particles(count + walls, FIELDS, id=ident, kind=kind, x=place[:, 0], y=place[:, 1], z=place[:, 2])
    for name in ("u", "v", "w"):
        setattr(every, name, rng.normal(size=count + walls))
    every.n[:] = rng.uniform(90, 110, count + walls)
    every.scale[count:] = rng.uniform(0.8, 1.2, walls)
    return every


def listed(every, size, radius, periodic=(False, False, False)):
    """A domain and lists of all particles on one rank."""
    grid = Grid(np.zeros(3), np.asarray(size, float), radius, periodic)
    fluid = every.kind == FLUID
    domain = Domain(grid, Comm(periodic[0]), [Fixed(every.take(~fluid))], FIELDS)
    domain.rebuild(every.take(fluid), 0.0)
    near = Neighbours(32)
    near.build(domain, radius)
    return domain, near


def lattice(counts, spacing, jitter=0.0, seed=0):
    """A periodic lattice of fluid, moved by up to `jitter` spacings: particles and the box size (3,)."""
    rng = np.random.default_rng(seed)
    axes = [(np.arange(c) + 0.5) * spacing for c in counts]
    place = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    place = place + rng.uniform(-jitter, jitter, place.shape) * spacing
    size = np.array(counts) * spacing
    place %= size
    count = len(place)
    every = Particles(
        count, FIELDS, id=make_id(FLUID, np.arange(count)), kind=FLUID, x=place[:, 0], y=place[:, 1], z=place[:, 2]
    )
    return every, size


def outside_box(points, centre, turn, half, axes):
    """Signed distance (n,) to a turned box, m, and the outward direction (n, 3)."""
    local = (points - centre) @ turn
    over = np.abs(local) - half
    over[:, [a for a in range(3) if a not in axes]] = -np.inf
    beyond = np.maximum(over, 0.0)
    distance = np.sqrt((beyond**2).sum(axis=1)) + np.minimum(over.max(axis=1), 0.0)
    direction = np.sign(local) * beyond
    length = np.sqrt((direction**2).sum(axis=1))
    return distance, (direction / np.where(length > 0, length, 1.0)[:, None]) @ turn.T
