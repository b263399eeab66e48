"""Which way the faces of what is solid look: unit normals of its samples, into the water."""

import functools

import numpy as np

from parsim.geometry.faces import SIDES
from parsim.geometry.rotation import matrices
from parsim.machine.jit import kernel
from parsim.particles.state import BODY, FLUID, GATE_DOWN, GATE_UP
from parsim.solid.shapes.kernels import distance


class Normals:
    """Of the samples of walls, gate and bodies: of the nearest face; none in corners, where two walls meet.

    low, high (3,), m: where walls stand along each axis, infinite where none does.
    """

    def __init__(self, case, bodies, samples):
        self._bodies, self._samples = bodies, samples
        stands = np.array([[getattr(case.box.faces, side).holds_water for side in pair] for pair in SIDES])
        self.low = np.where(stands[:, 0], case.box.min, -np.inf)
        self.high = np.where(stands[:, 1], case.box.max, np.inf)

    @functools.cached_property
    def _own(self):
        """In the frames of their bodies, (samples, 3)."""
        out = np.empty((len(self._samples), 3))
        facing(self._samples.offsets, self._samples.body, self._bodies.forms, out)
        return out

    def place(self, p, normal):
        """Write those of the samples among the particles `p` to `normal`, Vectors, as the bodies are turned now."""
        which = p.kind, p.body, p.sample
        place_normals(which, p.place, (self.low, self.high), self._own, matrices(self._bodies.quaternion), normal)


@kernel
def facing(offsets, body, forms, out):
    """Outward normal (n, 3) of the face of its body that is nearest to each of the points `offsets` (n, 3)."""
    for s in range(body.size):
        o = offsets[s]
        _, n = distance(forms, body[s], (o[0], o[1], o[2]))
        out[s, 0], out[s, 1], out[s, 2] = n[0], n[1], n[2]


@kernel
def place_normals(which, place, walls, own, turn, normal):
    """Normals of all that is no water; `which`: kind, body and sample of each particle."""
    kind, body, sample = which
    (low, high), (x, y, z), (nx, ny, nz) = walls, place, normal
    for i in range(kind.size):
        if kind[i] == FLUID:
            continue
        if kind[i] == BODY:
            n, t = own[sample[i]], turn[body[i]]
            nx[i] = t[0, 0] * n[0] + t[0, 1] * n[1] + t[0, 2] * n[2]
            ny[i] = t[1, 0] * n[0] + t[1, 1] * n[1] + t[1, 2] * n[2]
            nz[i] = t[2, 0] * n[0] + t[2, 1] * n[1] + t[2, 2] * n[2]
            continue
        a = 1.0 if x[i] < low[0] else (-1.0 if x[i] > high[0] else 0.0)
        b = 1.0 if y[i] < low[1] else (-1.0 if y[i] > high[1] else 0.0)
        c = 1.0 if z[i] < low[2] else (-1.0 if z[i] > high[2] else 0.0)
        sides = abs(a) + abs(b) + abs(c)
        if sides == 0.0 and kind[i] == GATE_UP:
            a = -1.0
        elif sides == 0.0 and kind[i] == GATE_DOWN:
            a = 1.0
        if sides > 1.0:
            a, b, c = 0.0, 0.0, 0.0
        nx[i], ny[i], nz[i] = a, b, c
