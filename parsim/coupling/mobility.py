"""How bodies give way to the pressure of the water: what makes one system of both.

The pressures p of the water push bodies with the forces J^T p, which accelerate them by K J^T p, K = M^-1 with all that
holds them, and so the water beside them makes room by J K J^T p: symmetric, never negative (Batty, Bertails & Bridson
2007, eq. 13). It is applied without ever being formed: per particle of water and body six numbers of J.
"""

import math

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import kernel

_MOST = 8  # bodies that one particle of water may see; it pushes the first ones


class Mobility:
    """Of all bodies in a step: `inverse` (bodies, 6, 6) is K.

    `units` (6,) of exact sums of forces and torques. `at` (m,), `body` (m,), `rows` (m, 6): which water sees which
    body, and J: force and torque, N and N m, of one Pa there. faces: `Sides`, weight, wetness (n,): see `sides.wet`.
    """

    def __init__(self, domain, near, beside, samples, centre, inverse, faces, units):
        p = domain.particles
        self._domain, self.inverse, self._units = domain, inverse, np.array(units)
        count = len(beside) * _MOST
        at, body, rows = np.empty(count, np.int64), np.empty(count, np.int64), np.empty((count, 6))
        of_samples = p.body, samples.shift, centre
        number = levers_of_water(beside, near.lists, p.place, of_samples, faces, at, body, rows)
        self.at, self.body, self.rows = at[:number], body[:number], rows[:number]

    def __bool__(self):
        return bool(self.inverse.any())

    def forces(self, values):
        """Forces and torques (bodies, 6), N and N m, of pressures `values` (particles,), Pa, on all bodies."""
        each = values[self.at][:, None] * self.rows
        return self._domain.sum(each, self._units, self.body, len(self.inverse))

    def accelerations(self, forces):
        """What forces and torques (bodies, 6) accelerate: (bodies, 6), m/s2 and 1/s2."""
        out = np.empty_like(forces)
        give_way(self.inverse, forces, out)
        return out

    def open(self, accelerations, factor, out):
        """Add to `out` (particles,) what `accelerations` (bodies, 6) make room by: `factor` times J times these."""
        make_room(self.at, self.body, self.rows, accelerations, factor, out)

    def diagonal(self, factor, out):
        """Add to `out` (particles,) `factor` times the diagonal of J K J^T."""
        own(self.at, self.body, self.rows, self.inverse, factor, out)


@kernel
def levers_of_water(beside, lists, place, of_samples, faces, at, body, rows):
    """Of the water `beside` bodies the force and torque of one Pa on each body that it sees: number of rows written.

    of_samples: body and shift of each particle, centres (bodies, 3); faces: see `Mobility`.
    """
    _, middle, end, index = lists
    x, y, z = place
    whose, shift, centre = of_samples
    (area, way, least), weight, wetness = faces
    number = 0
    for i in beside:
        first = number
        for t in range(middle[i], end[i]):
            j = index[t]
            b = whose[j]
            if b < 0:
                continue
            dx, dy, dz = x[i] - x[j], y[i] - y[j], z[i] - z[j]
            if dx * area[j, 0] + dy * area[j, 1] + dz * area[j, 2] <= 0.0:
                continue
            r2 = dx * dx + dy * dy + dz * dz
            wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            if wt <= 0.0:
                continue
            k = first
            while k < number and body[k] != b:
                k += 1
            if k == number:
                if number - first == _MOST:
                    continue
                at[k], body[k] = i, b
                rows[k, :] = 0.0
                number += 1
            f = -wt / max(wetness[j], least)
            ex, ey, ez = f * area[j, 0], f * area[j, 1], f * area[j, 2]
            px = x[j] - shift[j, 0] - centre[b, 0]
            py = y[j] - shift[j, 1] - centre[b, 1]
            pz = z[j] - shift[j, 2] - centre[b, 2]
            rows[k, 0] += ex
            rows[k, 1] += ey
            rows[k, 2] += ez
            rows[k, 3] += py * ez - pz * ey
            rows[k, 4] += pz * ex - px * ez
            rows[k, 5] += px * ey - py * ex
    return number


@kernel
def give_way(inverse, forces, out):
    """Accelerations `out` (bodies, 6) of forces (bodies, 6) by `inverse` (bodies, 6, 6)."""
    for b in range(len(forces)):
        for a in range(6):
            s = 0.0
            for c in range(6):
                s += inverse[b, a, c] * forces[b, c]
            out[b, a] = s


@kernel
def make_room(at, body, rows, accelerations, factor, out):
    """See `Mobility.open`."""
    for k in range(at.size):
        s = 0.0
        for a in range(6):
            s += rows[k, a] * accelerations[body[k], a]
        out[at[k]] += factor * s


@kernel
def own(at, body, rows, inverse, factor, out):
    """See `Mobility.diagonal`."""
    for k in range(at.size):
        s = 0.0
        for a in range(6):
            for c in range(6):
                s += rows[k, a] * inverse[body[k], a, c] * rows[k, c]
        out[at[k]] += factor * s
