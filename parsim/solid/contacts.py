"""Contacts of rigid bodies with each other, walls and what is driven, and their motion under all loads."""

import functools
import math

import numpy as np

from parsim.case.scales import gravity_at as ramped
from parsim.geometry.faces import period, planes_of_walls
from parsim.geometry.rotation import matrices
from parsim.solid import table
from parsim.solid.handover import begin, finish
from parsim.solid.hard import advance_hard
from parsim.solid.kinetics import kinetic
from parsim.solid.laws.pairs import law_of_pairs, thinnest
from parsim.solid.nearby import Beside
from parsim.solid.points import deepest
from parsim.solid.search import (
    ELEMENT,
    KEY,
    NORMAL,
    SLOT_KEY,
    STRETCH,
    TOUCHING,
    Touch,
    fill_slots,
    recall,
    room_for_pairs,
    room_for_slots,
    sort_pairs,
)
from parsim.solid.shapes import elements_of
from parsim.solid.shapes.forms import forms_of
from parsim.solid.springs import hasten, held_by_springs
from parsim.solid.substeps import elastic
from parsim.solid.tanks import KEPT, recall_tanks, room_for_tanks
from parsim.solid.together import Together

_OVERLAP = 0.01  # of the least width of a body, above which it is doubtful
_SHARE = 0.1  # of the smallest edge that a body may move in one step


class Contacts:
    """Moves the bodies of a case, deterministically: all that hold them get the same bits, whoever finds what.

    gravity_at: what pulls at a time, (3,), m/s2; that of the case if left out.
    driven: plates with half (3,), m, `centre` and `velocity` at a time (`parsim.boundary.gate.Gate`).
    shares: among whom the work is shared out (`parsim.domain.shares.Shares`), all of whom step together; None: nobody.
    Attributes: driven_work, J, work of what is driven on bodies and on water so far; count, elements that touch; steps,
    sub-steps of the last step; residual, of hard bodies' impulses, and overlap, over the least width of a body that
    touches, the largest so far.
    """

    def __init__(self, bodies, case, driven=(), gravity_at=None, shares=None):
        self.bodies, self._driven = bodies, list(driven)
        self._ramp, self._gravity = functools.partial(ramped, case), np.array(case.gravity, float)
        self._gravity_at = gravity_at or self._ramp
        self._steps_per_contact = case.contacts.steps_per_contact
        material = list(case.materials).index(case.wall_material) if case.materials else 0
        self._walls, self._period = _of_material(planes_of_walls(case, "bodies"), material), period(case)
        self._law, self._pair_law = case.contacts.law.NUMBER, law_of_pairs(case, bodies)
        law = case.contacts.law
        self._hard, self.residual = (law.sweeps, law.residual) if law.INSTANT else None, 0.0
        self.overlap = 0.0
        first, self._elements, cell = elements_of(bodies)
        self._first = np.append(first, np.full(len(self._driven), first[-1]))  # what is driven has none
        self._table = _table(bodies, cell, self._driven, material)
        self._forms = forms_of(bodies.shapes, bodies.planar, [plate.half for plate in self._driven])
        self._beside, self.shares, self._together = Beside(), shares, Together(shares)
        self._pairs, self._shift = room_for_pairs(64)
        self._tanks = room_for_tanks(64)
        self._marks, self._slots = room_for_slots(4096)
        self._smallest = 2.0 * thinnest(bodies) if len(bodies) else math.inf
        self._taken = self.driven_work = self._time = 0.0
        self.count, self.steps = 0, 0
        self._reacts = np.flatnonzero(bodies.joints.reacts)
        self._by_joints = np.array([b for b, *_ in bodies.joints.driven], int)
        self._key, self._element = np.zeros(0, np.int64), np.zeros(0, np.int64)
        self._memory = np.zeros((0, NORMAL - STRETCH))
        self._pair, self._stored = np.zeros(0, np.int64), np.zeros((0, KEPT))

    def limit(self):
        """Largest step of the water, s, over which the normals of contacts may be kept; inf when nothing moves."""
        speed = self.bodies.surface_speed()
        return _SHARE * self._smallest / speed if speed > 0.0 else math.inf

    def step(self, bodies, water_load, time, dt):
        """Advance `bodies` from `time` over `dt`, s, under `water_load` (nb, 6), N and N m, gravity and contacts.

        Sets pose, velocity and spin, the mean loads of the step and the accelerations; nothing touching: one exact
        step.
        """
        bodies.water_load[:] = water_load
        self._grow(time, dt)
        self._gravity = np.array(self._gravity_at(time + 0.5 * dt))
        before, held = self._tied_now() if self._reacts.size else None, bodies.held(time)
        number, slots, reach = self._prepare(bodies, held, time, dt, self.shares)
        if self._hard:
            self.count, self.steps, taken, work, left = advance_hard(
                self._table, self._touch(), number, dt, self._hard, self._steps_per_contact
            )
            self.residual = max(self.residual, left)
        else:
            of = dt, reach, self._steps_per_contact
            self.count, self.steps, taken, work = self._together.advance(self._table, self._touch(), number, of)
        self._taken, self.driven_work, self._time = self._taken + taken, self.driven_work + work, time + dt
        self.overlap = max(self.overlap, deepest(self._touch(), number))
        self._remember(number, slots)
        turns, loads = (bodies.acceleration, bodies.angular_acceleration), (bodies.contact_load, bodies.spring_load)
        finish(self._table, dt, _pose(bodies), *turns, *loads)
        self._grow(time, dt)
        if before:
            self._react(before, held, dt)

    def energies(self):
        """(stored at the present pose, dissipated so far) in contacts and in springs to the world, J.

        What contacts took out of the motion and do not hold is dissipated: there is no third.
        """
        if not len(self.bodies):
            return 0.0, self._taken
        self._gravity = np.array(self._gravity_at(self._time))
        number, *_ = self._prepare(self.bodies, self.bodies.fixed, self._time, 0.0)
        held = 0.0 if self._hard else float(elastic(self._table, self._touch(), number))
        return float(held_by_springs(self._table, self.bodies.springs)) + held, self._taken - held

    def elastic_energy(self):
        """Energy, J, stored in contacts and springs at the present pose."""
        return self.energies()[0]

    @property
    def dissipated(self):
        """Energy, J, lost in contacts so far."""
        return self.energies()[1]

    def doubts(self):
        """What was doubtful so far: messages."""
        if self.overlap > _OVERLAP:
            yield (
                f"bodies have overlapped by {100.0 * self.overlap:.3g} % of the least width of one: their materials "
                "are too soft, or contacts.steps_per_contact too few, for how fast they meet"
            )

    def kept(self):
        """What a restart needs: name -> array; friction's memory by pair and element, tanks by pair, totals."""
        totals = np.array([self._taken, self.driven_work, self._time, self.overlap, self.residual])
        return {
            "key": self._key.copy(),
            "element": self._element.copy(),
            "memory": self._memory.copy(),
            "pair": self._pair.copy(),
            "stored": self._stored.copy(),
            "totals": totals,
        }

    def restore(self, kept):
        """Go on from what `kept` returned."""
        self._key, self._element, self._pair = (np.array(kept[name], np.int64) for name in ("key", "element", "pair"))
        self._stored = np.array(kept["stored"], float).reshape(-1, KEPT)
        self._memory = np.array(kept["memory"], float).reshape(-1, NORMAL - STRETCH)
        self._taken, self.driven_work, self._time, self.overlap, self.residual = map(float, kept["totals"])
        self.count = len(self._key)

    def _prepare(self, bodies, held, time, dt, shares=None):
        """Update the kernels' copy of the bodies and list what may touch within `dt`: (pairs, slots, reach, m)."""
        m = self._table
        for row, plate in enumerate(self._driven, len(bodies)):
            m[row, table.POSITION : table.POSITION + 3] = plate.centre(time)
            m[row, table.VELOCITY + 2] = plate.velocity(time)
        begin(m, _pose(bodies), bodies.mass, held, bodies.water_load, self._gravity, bodies.planar, bodies.gravity_load)
        self._tie(bodies, time, dt)
        if len(bodies.springs):
            hasten(m, bodies.springs, dt)
        number, reach = self._list_pairs(bodies.planar, dt, shares)
        return number, self._list_slots(number, reach), reach

    def _tie(self, bodies, time, dt):
        """Let the kernels know of what joints drive, and that springs pull all the time."""
        m = self._table
        for b in bodies.springs[:, 0].astype(int):
            if m[b, table.ROLE] == table.ALONE:
                m[b, table.ROLE] = table.INVOLVED
        for b, velocity, spin in bodies.drives(time, dt):
            m[b, table.ROLE], m[b, table.LIGHT] = table.DRIVEN, 0.0
            m[b, table.INVERSE : table.INVERSE + 3] = m[b, table.GIVEN : table.GIVEN + 3] = 0.0
            m[b, table.GIVEN + 3 : table.GIVEN + 6] = 0.0
            m[b, table.VELOCITY : table.VELOCITY + 3], m[b, table.SPIN : table.SPIN + 3] = velocity, spin

    def _grow(self, time, dt):
        """Count half the work of gravity that grows over a step: asked before it and after."""
        less = np.subtract(self._ramp(time), self._ramp(time + dt))
        if less.any():
            there = np.where(self.bodies.gone, 0.0, self.bodies.mass)
            self.driven_work += 0.5 * float((there[:, None] * self.bodies.position * less).sum())

    def _tied_now(self):
        """Momentum (k, 6), kg m/s, kg m2/s, of the bodies that react to joints, and place (d, 3), m, and energy, J, of
        those that are driven."""
        b, at, driven = self.bodies, self._reacts, self._by_joints
        turn = matrices(b.quaternion[at])
        own = np.einsum("bij,bj,bkj,bk->bi", turn, b.inertia[at], turn, b.spin[at])
        momentum = np.hstack([b.mass[at, None] * b.velocity[at], own])
        each = (getattr(b, name)[driven] for name in ("mass", "inertia", "quaternion", "velocity", "spin"))
        energy = kinetic(*each) - float((b.mass[driven, None] * b.position[driven] @ self._gravity).sum())
        return momentum, b.position[driven], energy

    def _react(self, before, held, dt):
        """Note the loads of joints, what changed the momentum besides other loads; count the work of what is driven.

        That is what changed its energy besides the water; what it does to others is counted with the contacts. On what
        is `held` (nb,) only springs act.
        """
        b, at, driven, now = self.bodies, self._reacts, self._by_joints, self._tied_now()
        others = b.water_load[at] + b.contact_load[at] + b.gravity_load[at]
        b.joint_load[at] = np.where(held[at, None], b.spring_load[at], (now[0] - before[0]) / dt - others)
        by_water = float((b.water_load[driven, :3] * (now[1] - before[1])).sum())
        by_water += dt * float((b.water_load[driven, 3:] * b.spin[driven]).sum())
        self.driven_work += now[2] - before[2] - by_water

    def _touch(self):
        springs = self.bodies.springs
        return Touch(
            self._first,
            self._elements,
            self._walls,
            self._law,
            self._pair_law,
            self._pairs,
            self._shift,
            self._marks,
            self._slots,
            self._tanks,
            self._forms,
            springs,
            np.searchsorted(springs[:, 0], np.arange(len(self._table) + 1)),
        )

    def _list_pairs(self, planar, dt, shares):
        find = self._period, planar, len(self.bodies)
        number, reach = self._beside.near_pairs(self._table, self._touch(), find, dt, shares)
        if number > len(self._pairs):
            self._pairs, self._shift = room_for_pairs(2 * number)
            number, reach = self._beside.near_pairs(self._table, self._touch(), find, dt, shares)
        if number > 1:
            sort_pairs(self._pairs, self._shift, number)
        if number > len(self._tanks):
            self._tanks = room_for_tanks(2 * number)
        recall_tanks(self._touch(), number, self._pair, self._stored)
        return number, reach

    def _list_slots(self, number, reach):
        if number == 0:
            return 0
        count = fill_slots(self._table, self._touch(), number, reach)
        if count > len(self._marks):
            self._marks, self._slots = room_for_slots(2 * count)
            count = fill_slots(self._table, self._touch(), number, reach)
        recall(self._marks, self._slots, count, self._key, self._element, self._memory)
        return count

    def _remember(self, number, count):
        if not count and not len(self._key) and not len(self._pair):
            return
        at = np.flatnonzero(self._tanks[:number, :KEPT].any(axis=1))
        self._pair, self._stored = self._pairs[at, KEY], self._tanks[at, :KEPT]
        at = np.flatnonzero(self._marks[:count, TOUCHING])
        self._key, self._element = self._marks[at, SLOT_KEY], self._marks[at, ELEMENT]
        self._memory = self._slots[at, STRETCH:NORMAL]


def _pose(bodies):
    return bodies.position, bodies.quaternion, bodies.velocity, bodies.spin


def _of_material(walls, material):
    return np.column_stack([walls, np.full(len(walls), float(material))])


def _table(bodies, cell, driven, material):
    """The kernels' copy of the bodies, then of what is `driven`, upright boxes of one material."""
    count = len(bodies)
    out = np.zeros((count + len(driven), table.WIDTH))
    for at, values in ((table.HALF, bodies.forms.half), (table.INERTIA, bodies.inertia), (table.CELL, cell)):
        out[:count, at : at + 3] = values
    out[:count, table.MATERIAL], out[:count, table.RADIUS] = bodies.material, bodies.radius
    out[:count, table.SHAPE] = bodies.forms.shape
    joints = bodies.joints
    out[:, table.FREE : table.FREE + 6] = 1.0
    out[:count, table.FREE : table.FREE + 6], out[:count, table.ROD : table.ROD + 4] = joints.free, joints.rod
    for b, *_ in joints.driven:
        out[b, table.FREE : table.FREE + 6] = 0.0
    for row, plate in enumerate(driven, count):
        out[row, table.ROLE], out[row, table.MATERIAL] = table.DRIVEN, material
        out[row, table.HALF : table.HALF + 3] = plate.half
        out[row, table.CELL : table.CELL + 3] = np.max(cell, initial=0.0, where=np.isfinite(cell))
        out[row, [table.QUATERNION, table.TURN, table.TURN + 4, table.TURN + 8]] = 1.0
    return out
