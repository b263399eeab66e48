"""Which samples of walls, gate and bodies have faces to the water, and what these find: see `parsim.fluid.friction`."""

from typing import NamedTuple

import numpy as np

from parsim.fluid.friction import SLIP, WEIGHT, Facets, Seen, mirror, rub, slip_of, spread
from parsim.fluid.reference import Lattice
from parsim.geometry.faces import names_of_walls, planes_of_walls, velocities_of_walls
from parsim.geometry.rotation import matrices
from parsim.particles.state import BODY, GATE_DOWN, GATE_UP, WALL
from parsim.particles.tables import Kinematics, Vectors


class Rubbing(NamedTuple):
    """What the water feels of samples: their slip, and how much each counts (n,), nothing if it does not rub."""

    slip: Vectors
    share: np.ndarray


class Friction:
    """The faces of all samples of a case that rub.

    `stress` (f, 4): force, N, on each face of this rank in this step, and the sum of W of the water it sees.
    """

    def __init__(self, case, bodies, samples, gate):
        self.bodies, self._gate = bodies, gate
        self._lattice = lattice = Lattice(case.dimensions, case.spacing, case.water.scheme.support, WEIGHT)
        table, self._spacing = case.water.friction, case.spacing
        self._by_law = table.kind == "wall_law"
        self._planes, self._velocities = planes_of_walls(case), velocities_of_walls(case)
        self.slides = bool(self._velocities.any())
        self._rubs = np.array([table.walls is None or name in table.walls for name in names_of_walls(case)], bool)
        self._bodies_rub, self._mass = table.bodies, case.water.density * lattice.volume
        half = sum(w for w, _, _, up in lattice.points() if up > 0.5 * case.spacing)
        viscosity, density = case.water.viscosity, case.water.density
        self._seen = Seen(case.spacing, half, viscosity, density)
        rough = [table.roughness if m.roughness is None else m.roughness for m in case.materials.values()]
        self._of_walls = table.roughness
        self._of_bodies = np.array(rough or [0.0])[bodies.material]
        self._patches = _patches(samples)
        self.stress = np.zeros((0, 4))

    def find(self, p, near):
        """Note, after a rebuild, the faces of this rank's samples, which of all particles rub, and what slides."""
        if self.slides:
            self._note_sliding(p, near)
        if not self._by_law:
            self.share = np.where(self._rubbing(p), p.scale, 0.0)
        else:
            self.share = np.zeros(len(p))  # of what has no face nothing is felt, in the halo as here
            fixed, own = self._fixed(p, np.arange(len(p))), self._own(p, np.flatnonzero(p.kind == BODY))
            every = Facets(*map(np.concatenate, zip(fixed, own, strict=True)))
            self.share[every.at] = 1.0
            here = np.zeros(len(p), bool)
            here[near.boundary] = True
            self._facets = facets = Facets(*(each[here[every.at]] for each in every))
            of_body = p.body[facets.at] >= 0
            self._turned = np.flatnonzero(of_body), facets.normal[of_body], p.body[facets.at[of_body]]
            self.stress = np.zeros((len(self._facets.at), 4))

    def find_slip(self, flow):
        """Set the slip of this rank's samples, and refresh it in the halos."""
        p, lists, weight = flow.particles, flow.near.lists, self._lattice.weight
        kinematics = p.kinematics
        if self.slides:  # samples of walls stay where they are
            kinematics = Kinematics(p.place, Vectors(*map(np.add, p.velocity, self._sliding)))
        if self._by_law:
            self._turn()
            rub(self._facets, lists, kinematics, weight, self._seen, self.stress)
            spread(self._facets, self._mass, self.stress, slip_of(p))
        else:
            mirror(flow.near.boundary, lists, kinematics, weight, slip_of(p))
        flow.domain.refresh(*SLIP)

    def _note_sliding(self, p, near):
        """Note the velocities (3, n), m/s, of samples behind a side that moves; `sliding`: those of this rank."""
        self._sliding, walls = np.zeros((3, len(p))), np.flatnonzero(p.kind == WALL)
        for k in np.flatnonzero(self._velocities.any(axis=1)):
            at = walls[(_before(self._planes[k], p, walls) < 0.0) & self._inside(p, walls, k)]
            self._sliding[:, at] = self._velocities[k][:, None]
        self.sliding = near.boundary[self._sliding[:, near.boundary].any(axis=0)]

    def power(self, force):
        """Work, W, (n,), that sides do on the water by its forces (n, 3), N, on the samples `sliding`."""
        return -(force * self._sliding[:, self.sliding].T).sum(axis=1)

    def _turn(self):
        """Bring the normals of bodies to their present pose."""
        at, normal, body = self._turned
        if len(body):
            turn = matrices(self.bodies.quaternion)
            self._facets.normal[at] = np.einsum("fij,fj->fi", turn[body], normal)

    def _rubbing(self, p):
        """Which particles rub: (n,) bool."""
        of_wall = np.zeros(len(p), bool)
        for plane in self._planes[self._rubs]:
            of_wall |= _before(plane, p, slice(None)) < 0.0
        of_gate = (p.kind == GATE_UP) | (p.kind == GATE_DOWN)
        return ((p.kind == WALL) & of_wall) | of_gate | ((p.kind == BODY) & self._bodies_rub)

    def _fixed(self, p, at):
        """Faces of the walls and the gate among the samples `at`."""
        parts = []
        for k, plane in enumerate(self._planes):
            if self._rubs[k]:
                first = (p.kind[at] == WALL) & (_before(plane, p, at) > -self._spacing) & (_before(plane, p, at) < 0.0)
                parts.append((at[first & self._inside(p, at, k)], plane))
        if self._gate:
            for kind, side, level in ((GATE_UP, -1.0, self._gate.min_x), (GATE_DOWN, 1.0, self._gate.max_x)):
                plane = np.array([side, 0.0, 0.0, side * level])
                first = (p.kind[at] == kind) & (_before(plane, p, at) > -self._spacing)
                parts.append((at[first & self._inside(p, at, -1)], plane))
        area = self._spacing ** (self._lattice.dimensions - 1)
        found = [np.concatenate([np.zeros(0, np.int64), *(at for at, _ in parts)])]
        found.append(np.concatenate([np.zeros(0), *(-_before(plane, p, at) for at, plane in parts)]))
        found.append(np.concatenate([np.zeros((0, 3)), *(np.tile(plane[:3], (at.size, 1)) for at, plane in parts)]))
        order = np.argsort(found[0], kind="stable")
        count = order.size
        return Facets(*(each[order] for each in found), np.full(count, area), np.full(count, self._of_walls))

    def _inside(self, p, at, but):
        """Which samples are in front of all walls, `but` this one."""
        out = np.ones(at.size, bool)
        for k, plane in enumerate(self._planes):
            if k != but:
                out &= _before(plane, p, at) > 0.0
        return out

    def _own(self, p, at):
        """Faces of the bodies among the samples `at`, their normals in the body frame."""
        first, under, normal, area = self._patches
        if not self._bodies_rub:
            at = at[:0]
        begin, end = first[p.sample[at]], first[p.sample[at] + 1]
        particle = np.repeat(at, end - begin)
        row = np.concatenate([np.zeros(0, np.int64), *(np.arange(b, e) for b, e in zip(begin, end, strict=True))])
        return Facets(particle, under[row], normal[row], area[row], self._of_bodies[p.body[particle]])


def _before(plane, p, at):
    """How far particles are in front of a plane, m: (n,)."""
    return plane[0] * p.x[at] + plane[1] * p.y[at] + plane[2] * p.z[at] - plane[3]


def _patches(samples):
    """The patches of all bodies in the order of their samples: first of each, distance to it, m, normal, area, m2."""
    each, count = samples.of_body, len(samples)
    begin = np.cumsum([0, *(len(s.offsets) for s in each)])
    sample = np.concatenate([np.zeros(0, int), *(s.sample + at for s, at in zip(each, begin[:-1], strict=True))])
    order = np.argsort(sample, kind="stable")
    normal = np.concatenate([np.zeros((0, 3)), *(s.normal for s in each)])[order]
    place = np.concatenate([np.zeros((0, 3)), *(s.place for s in each)])[order]
    area = np.concatenate([np.zeros(0), *(s.area for s in each)])[order]
    under = ((place - samples.offsets[sample[order]]) * normal).sum(axis=1)
    return np.searchsorted(sample[order], np.arange(count + 1)), under, normal, area
