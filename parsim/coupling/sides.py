"""The surface of bodies as the pressure equation has it: an area vector for each sample of the outer layer.

A sample turns the mean pressure of the water before it, rising to its face as in water at rest, into a force on that
area; by the same shares the volume that the moving face sweeps is taken from that water. However its particles lie, an
even pressure then pushes a closed body nowhere, and that of water at rest lifts it by what it displaces.
"""

import math
from typing import NamedTuple

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.geometry.rotation import matrices, to_global
from parsim.machine.jit import kernel
from parsim.particles.state import BODY

_WET = 0.8  # of the weight of half a lattice: a face with less water before it is wet for its share of that only


class Sides(NamedTuple):
    """Of each particle: area vector (n, 3), m2, outwards, zero where it has no face; way from it to its face (n, 3), m.

    least: weight of the water before a face that wets it.
    """

    area: np.ndarray
    way: np.ndarray
    least: float


class Faces:
    """The area vectors of all samples of `bodies` in their frames, and the ways to the middles of these faces."""

    def __init__(self, samples, lattice):
        count = len(samples)
        self._area, self._way = np.zeros((count, 3)), np.zeros((count, 3))
        area, first = np.zeros(count), 0
        for each in samples.of_body:
            at = first + each.sample
            np.add.at(self._area, at, each.area[:, None] * each.normal)
            np.add.at(self._way, at, each.area[:, None] * (each.place - each.offsets[each.sample]))
            np.add.at(area, at, each.area)
            first += len(each.offsets)
        self._way /= np.where(area > 0.0, area, 1.0)[:, None]
        self._widen(samples)
        half = math.fsum(w for w, _, _, up in lattice.points() if up > 0.5 * lattice.spacing)
        self._least = _WET * half

    def _widen(self, samples):
        """Move all faces out so far that they enclose the volume of the body: at corners they are cut."""
        size = np.sqrt((self._area**2).sum(axis=1))
        held = (self._area * (samples.offsets + self._way)).sum(axis=1)
        for b, shape in enumerate(samples.bodies.shapes):
            at = np.flatnonzero((samples.body == b) & (size > 0.0))
            axes = 2 if samples.bodies.planar else 3
            wanting = (axes * shape.volume - held[at].sum()) / max(size[at].sum(), 1e-300)
            self._way[at] += wanting * self._area[at] / size[at, None]

    def at(self, p, quaternion):
        """`Sides` of the particles `p`, halo included, whose bodies are turned by `quaternion` (bodies, 4)."""
        area, way = np.zeros((len(p), 3)), np.zeros((len(p), 3))
        turn = matrices(quaternion).reshape(-1, 9)
        turn_faces(np.flatnonzero(p.kind == BODY), (p.body, p.sample), (self._area, self._way), turn, area, way)
        return Sides(area, way, self._least)


@kernel
def turn_faces(at, which, own, turn, area, way):
    """Area vectors and ways of the samples `at`, turned with their bodies; which: body and sample of each particle."""
    body, sample = which
    for i in at:
        t, s = turn[body[i]], sample[i]
        area[i, 0], area[i, 1], area[i, 2] = to_global(t, own[0][s, 0], own[0][s, 1], own[0][s, 2])
        way[i, 0], way[i, 1], way[i, 2] = to_global(t, own[1][s, 0], own[1][s, 1], own[1][s, 2])


@kernel
def wet(at, lists, place, weight, area, out):
    """Sum of the weights of the water before the faces of the samples `at`: out (n,), of each particle."""
    start, middle, _, index = lists
    x, y, z = place
    for i in at:
        out[i] = 0.0
        for t in range(start[i], middle[i]):
            j = index[t]
            dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
            if dx * area[i, 0] + dy * area[i, 1] + dz * area[i, 2] > 0.0:
                r2 = dx * dx + dy * dy + dz * dz
                wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
                out[i] += wt


@kernel
def press(at, lists, place, acceleration, water, sides, out):
    """Forces, N, on the samples `at`, how they depend on accelerations: see `fluid.simps.sweeps.reaction`.

    water: weight; p (n,), Pa; wetness (n,), see `wet`; share of p that counts; density; rise
    of the pressure of water at rest (3,), Pa/m.
    """
    start, middle, _, index = lists
    x, y, z = place
    ax, ay, az = acceleration
    weight, p, wetness, share, density, rise = water
    area, way, least = sides
    for row in range(at.size):
        i = at[row]
        out.force[row, :] = 0.0
        out.lever[row, :] = 0.0
        out.response[row, :] = 0.0
        nx, ny, nz = area[i, 0], area[i, 1], area[i, 2]
        size = math.sqrt(nx * nx + ny * ny + nz * nz)
        if size == 0.0 or wetness[i] == 0.0:
            continue
        nx, ny, nz = nx / size, ny / size, nz / size
        own = ax[i] * nx + ay[i] * ny + az[i] * nz
        total, high, deep = 0.0, 0.0, 0.0
        for t in range(start[i], middle[i]):
            j = index[t]
            dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
            if dx * nx + dy * ny + dz * nz <= 0.0:
                continue
            r2 = dx * dx + dy * dy + dz * dz
            wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            dx, dy, dz = dx - way[i, 0], dy - way[i, 1], dz - way[i, 2]
            total += wt * p[j]
            high += wt * (dx * nx + dy * ny + dz * nz)
            deep -= wt * (rise[0] * dx + rise[1] * dy + rise[2] * dz)
        f = size / max(wetness[i], least)
        high = max(high, 0.0)
        pressed = -f * (share * total + deep + density * own * high)
        out.force[row, 0], out.force[row, 1], out.force[row, 2] = pressed * nx, pressed * ny, pressed * nz
        e = f * density * high
        out.response[row, 0], out.response[row, 1], out.response[row, 2] = e * nx * nx, e * nx * ny, e * nx * nz
        out.response[row, 3], out.response[row, 4], out.response[row, 5] = e * ny * ny, e * ny * nz, e * nz * nz
