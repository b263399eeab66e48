"""Films of water in gaps too thin for a particle: what keeps a grounded floe afloat and touching floes apart.

A gap thinner than the spacing holds no particle, so a face that looks into it would feel no water at all: a floe on the
bed would be pressed onto it, two floes together, by the full pressure on their other sides. In nature water stands in
such gaps, at the pressure of the water around them. Here every face is cut into patches, one per sample of its outer
layer. The pressure in a film is hydrostatic, at the mean head of the water that the body sees along its edges; a patch
feels it as far as a solid lies close in front of it and no particle does, and as far as its face is fed: by the share
of its rim where there is water, of all the rim that such water would reach and that is open to it.
"""

import math
from typing import NamedTuple

import numpy as np

from parsim.coupling.gaps import FAR, Bodies, gap_ahead
from parsim.fluid.weights.choice import weight_at
from parsim.geometry.faces import period, planes_of_walls
from parsim.geometry.nearby import near_bodies
from parsim.geometry.rotation import matrices, to_global
from parsim.machine.jit import kernel
from parsim.particles.state import BODY, SHUT_IN

_NEAR = 1.0  # gap, in spacings, up to which a film is whole; from FAR on there is none
_FEED = 4.0  # a quarter of a layer of water in sight of a rim wets it


class Patches(NamedTuple):
    """Sample, face, whether on a rim, whether its sample has no other, place (n, 3), m, normal (n, 3) and area, m2, of
    each patch; of each sample its particle on this rank or -1, its patches by face (samples, 6), and its body."""

    sample: np.ndarray
    face: np.ndarray
    rim: np.ndarray
    lone: np.ndarray
    place: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    row: np.ndarray
    patch: np.ndarray
    body: np.ndarray


class Water(NamedTuple):
    """Pressure, Pa, and class of the particles; slope of the hydrostatic head (3,), Pa/m; spacing, m; full layers."""

    pressure: np.ndarray
    surface: np.ndarray
    head: np.ndarray
    spacing: float
    layer: float
    deep: float


class Found(NamedTuple):
    """Of each patch, by rows (n, 6): see `Films.loads`."""

    load: np.ndarray
    wet: np.ndarray
    dry: np.ndarray
    heads: np.ndarray


class Films:
    """The patches of all bodies. What they need from step to step is in `bodies.film`: see `Bodies`.

    Faces are numbered 2 axis + (0 low, 1 high) in the body frame.
    """

    def __init__(self, case, bodies, samples, lattice):
        self.bodies, self.samples = bodies, samples
        self._spacing, self._weight = case.spacing, lattice.weight
        self._layer, self._deep = _layers(lattice)
        self._planes = planes_of_walls(case)
        self._period = period(case)
        self._density = case.water.density
        each = samples.of_body
        first = np.cumsum([0, *(len(s.offsets) for s in each)])
        self.sample = np.concatenate(
            [np.zeros(0, int), *(s.sample + at for s, at in zip(each, first[:-1], strict=True))]
        )
        self._face = np.concatenate([np.zeros(0, int), *(s.face for s in each)])
        self._rim = np.concatenate([np.zeros(0, bool), *(s.rim for s in each)])
        self._place = np.concatenate([np.zeros((0, 3)), *(s.place for s in each)])
        self._normal = np.concatenate([np.zeros((0, 3)), *(s.normal for s in each)])
        self._area = np.concatenate([np.zeros(0), *(s.area for s in each)])
        self._patch = np.full((len(samples), 6), -1)
        self._patch[self.sample, self._face] = np.arange(self.sample.size)
        self._lone = (self._patch[self.sample] >= 0).sum(axis=1) == 1

    def find(self, domain):
        """Note, after a rebuild, which patches this rank has, their particles, and which bodies are near which."""
        p, own = domain.particles, domain.own
        row = np.full(len(self.samples), -1)
        at = own.start + np.flatnonzero((p.kind[own] == BODY) & (p.image[own] == 0))
        row[p.sample[at]] = at
        self._row = row
        patches = self._patch[self.samples.here]
        self._here = np.sort(patches[patches >= 0])
        span = self.bodies.radius + 0.5 * (FAR + 2.0) * self._spacing
        self._first, self._others = near_bodies(self.bodies.position, span, self._period)

    def loads(self, domain, near, plate, position, quaternion, gravity):
        """What this rank's patches add to sums over all ranks: values (n, 6) and their rows (n,).

        Rows by body: loads, N and N m; then, each `bodies` rows further on, by face the wet rim and the rim that is dry
        though open and below the water line, in patches; and the sum of the heads along wet rims, Pa, and their number.
        gravity (3,), m/s2: what pulls in this step.
        """
        p, here = domain.particles, self._here
        found = Found(*np.zeros((4, here.size, 6)))
        patches = Patches(
            self.sample,
            self._face,
            self._rim,
            self._lone,
            self._place,
            self._normal,
            self._area,
            self._row,
            self._patch,
            self.samples.body,
        )
        # water that goes round has no head along its way
        head = np.where(np.isinf(self._period), self._density * np.array(gravity), 0.0)
        water = Water(p.p, p.surface, head, self._spacing, self._layer, self._deep)
        points, solids = (p.place, self.samples.shift), self.around(plate, position, quaternion)
        patch_loads(here, patches, near.lists, points, solids, (water, self._weight), self.bodies.film, found)
        body = self.samples.body[self.sample[here]].astype(np.int64)
        return np.concatenate(found), np.concatenate([body + k * len(self.bodies) for k in range(4)])

    def around(self, plate, position, quaternion):
        """All that a gap may end at, with the bodies at a pose: see `gap_ahead`; `plate` is the gate's outline (4,)."""
        turn = matrices(quaternion).reshape(-1, 9)
        bodies = Bodies(position, turn, self.bodies.forms, self.bodies.radius, self._first, self._others, self._period)
        return bodies, self._planes, plate

    def keep(self, wet, dry, heads):
        """Note the sums over all ranks, (bodies, 6) each, for the next step."""
        fed = wet.sum(1) / np.maximum(wet.sum(1) + dry.sum(1), 1e-300)
        rim = wet + dry
        self.bodies.film[:, 0] = heads[:, 0] / np.maximum(heads[:, 1], 1e-300)
        # a face that is sealed all round is as well fed as the body
        self.bodies.film[:, 1:] = np.where(rim > 0.0, wet / np.maximum(rim, 1e-300), fed[:, None])


def _layers(lattice):
    """Sums of W over the first layer of a lattice, one spacing ahead, and of W d / r2 over all layers, in spacings."""
    points = [(w, r, up / lattice.spacing) for w, _, r, up in lattice.points() if up > 0.5 * lattice.spacing]
    first = math.fsum(w for w, _, up in points if up < 1.5)
    return first, math.fsum(w * up * (lattice.spacing / r) ** 2 for w, r, up in points)


@kernel
def water_at(i, x, n, lists, place, surface, weight):
    """Sums of sample i: W over all the water it sees; W d / r2 over that before its face, at x with normal n, d ahead.

    Without what is shut in, which pushes nothing.

    The second is what the water pushes with: one layer does about 85 % of what deep water does, the film the rest.
    """
    start, middle, _, index = lists
    px, py, pz = place
    every, ahead = 0.0, 0.0
    for c in range(start[i], middle[i]):
        j = index[c]
        if surface[j] == SHUT_IN:
            continue
        dx, dy, dz = px[j] - px[i], py[j] - py[i], pz[j] - pz[i]
        r2 = dx * dx + dy * dy + dz * dz
        wt, slope, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
        every += wt
        if (px[j] - x[0]) * n[0] + (py[j] - x[1]) * n[1] + (pz[j] - x[2]) * n[2] > 0.0:
            ahead += slope * (dx * n[0] + dy * n[1] + dz * n[2])
    return every, ahead


@kernel
def patch_loads(here, patches, lists, points, solids, water, film, found):
    """Load of the film on each patch `here`, and what its rim tells of the water: see `Films.loads`.

    `points`: places and shifts of the particles; `solids`: see `gap_ahead`; `water`: Water and its weight; `film`: see
    `Bodies`.
    """
    sample, face, on_rim, lone, place, normal, area, row, patch, body = patches
    (px, py, pz), shift = points
    centre, turn = solids[0].centre, solids[0].turn
    (pressure, surface, head, spacing, layer, deep), weight = water
    load, wet, dry, heads = found
    for k in range(here.size):
        m = here[k]
        s, f = sample[m], face[m]
        b = body[s]
        lx, ly, lz = to_global(turn[b], place[m, 0], place[m, 1], place[m, 2])
        x = (centre[b, 0] + lx, centre[b, 1] + ly, centre[b, 2] + lz)
        n = to_global(turn[b], normal[m, 0], normal[m, 1], normal[m, 2])
        i = row[s]
        every, before = 0.0, 0.0
        if i >= 0:
            there = (x[0] + shift[i, 0], x[1] + shift[i, 1], x[2] + shift[i, 2])
            every, before = water_at(i, there, n, lists, points[0], surface, weight)
            before *= spacing / deep
        value = film[b, 0] + head[0] * x[0] + head[1] * x[1] + head[2] * x[2]
        if on_rim[m]:
            share = min(_FEED * every / layer, 1.0) if i >= 0 and pressure[i] > 0.0 else 0.0
            if share > 0.0:
                ax, ay, az = px[i] - shift[i, 0], py[i] - shift[i, 1], pz[i] - shift[i, 2]
                heads[k, 0] = share * (pressure[i] - head[0] * ax - head[1] * ay - head[2] * az)
                heads[k, 1] = share
                wet[k, f] = share
            if share < 1.0 and value > 0.0 and film[b, 0] != 0.0:
                for g in range(6):
                    c = patch[s, g]
                    if (g == f) != lone[m] or c < 0:
                        continue
                    ex, ey, ez = to_global(turn[b], place[c, 0], place[c, 1], place[c, 2])
                    edge = (centre[b, 0] + ex, centre[b, 1] + ey, centre[b, 2] + ez)
                    out = to_global(turn[b], normal[c, 0], normal[c, 1], normal[c, 2])
                    gap = gap_ahead(edge, out, b, solids, spacing)
                    if gap > FAR * spacing:
                        dry[k, f] = 1.0 - share
        if value <= 0.0 or film[b, 1 + f] == 0.0 or before >= 1.0:
            continue
        gap = gap_ahead(x, n, b, solids, spacing)
        closed = min(max((FAR - gap / spacing) / (FAR - _NEAR), 0.0), 1.0)
        force = -value * film[b, 1 + f] * area[m] * closed * (1.0 - before)
        fx, fy, fz = force * n[0], force * n[1], force * n[2]
        load[k, 0], load[k, 1], load[k, 2] = fx, fy, fz
        load[k, 3], load[k, 4], load[k, 5] = ly * fz - lz * fy, lz * fx - lx * fz, lx * fy - ly * fx
