"""Water where none can be: inside bodies, and in gaps too thin for a particle. It is brought out again.

Water one layer thick has no pressure, so it can sink into what it lies on. And between two solids that close, the last
layer is torn to drops that see no other water: nothing drives them out along the gap, and they carried what lies on
them like balls, without friction and for ever, and rang like springs. What water does in such a gap is a matter of
`films`; the drops in it push nothing and go the way in which the gap widens.
"""

import math
from typing import NamedTuple

import numpy as np

from parsim.coupling.gaps import gap_ahead
from parsim.geometry.rotation import to_body, to_global
from parsim.machine.jit import kernel
from parsim.particles.state import BODY, SHUT_IN
from parsim.solid.shapes.kernels import distance

_WAY_OUT = 5.0  # spacings that the fastest water goes while a particle inside a body comes out
_THIN = 0.7  # gap, in spacings, under which a layer has parted into drops
_APART = 0.5  # spacings that drops in a gap keep from each other: in a pocket all ways lead to one place after all


class Ways(NamedTuple):
    """spacing, m; rates out of a body and to the middle of a gap, 1/s; speed along a gap, m/s; unit vector down."""

    spacing: float
    out: float
    middle: float
    along: float
    down: tuple[float, float, float]


class Stray:
    """Brings stray water of a case out; `beside`: the particles (n,) of this rank's water that may meet a body."""

    def __init__(self, case, samples):
        self.samples, self._spacing = samples, case.spacing
        self._rate = case.speed / case.spacing
        # as fast along a gap as what falls half a spacing, for the pressure that drives it is unknown
        self._along = math.sqrt(math.hypot(*case.gravity) * case.spacing)

    def find(self, domain, near):
        """Note, after a rebuild, which of this rank's water may meet a body."""
        self.beside = near.fluid[domain.near(BODY, "kind")[near.fluid]]
        self._lead = np.zeros((self.beside.size, 3))

    def turn_out(self, flow, pose, solids, dt):
        """Turn the velocity of water that is inside a body so that it comes out again; see what is shut in beside one.

        pose: of the bodies; solids: see `gap_ahead`; dt: of the step, s, in which what is shut in goes a tenth of a
        spacing along its gap at most. The impulse is not given back: these are single particles.
        """
        p, samples, pull = flow.particles, self.samples, math.hypot(*flow.gravity) or 1.0
        ways = Ways(
            self._spacing,
            self._rate / _WAY_OUT,
            min(self._rate, 0.25 / dt),
            min(self._along, 0.1 * self._spacing / dt),
            tuple(g / pull for g in flow.gravity),
        )
        of_samples = p.body, samples.shift, samples.bodies.fixed
        motion, noted = samples.motion(*pose), (p.surface, self._lead)
        turn_out(self.beside, flow.near.lists, of_samples, motion, solids, ways, p.kinematics, noted)

    def lead_out(self, p, dt):
        """Move what is shut in along its gap for dt, s, once its places are those of the step: it gains no speed."""
        for place, way in zip(p.place, self._lead.T, strict=True):
            place[self.beside] += dt * way


@kernel
def gap_at(x, b, solids, turn, spacing):
    """(depth of x (3,) in body `b`, negative outside; the gap there to the next solid, m; the way across it (3,))."""
    bodies = solids[0]
    centre = bodies.centre[b]
    high, n = distance(bodies.forms, b, to_body(turn, x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]))
    n = to_global(turn, n[0], n[1], n[2])
    gap = high + gap_ahead(x, n, b, solids, spacing) if high < 0.5 * spacing else np.inf
    return -high, gap, n


@kernel
def across(dx, dy, dz, n):
    """What of a vector is across n (3,)."""
    along = dx * n[0] + dy * n[1] + dz * n[2]
    return dx - along * n[0], dy - along * n[1], dz - along * n[2]


@kernel
def way_along(x, n, b, solids, turn, spacing, down):
    """Unit vector (3,) along the gap at x (3,), across n (3,): away from the body's centre, but not steeply up.

    Under a ball, which has its centre straight behind, up. Back if the gap widens there; zero if a solid is in the way.
    """
    centre = solids[0].centre[b]
    dx, dy, dz = across(x[0] - centre[0], x[1] - centre[1], x[2] - centre[2], n)
    size = math.sqrt(dx * dx + dy * dy + dz * dz)
    if size < 1e-6 * spacing:
        dx, dy, dz = across(-down[0], -down[1], -down[2], n)
        size = math.sqrt(dx * dx + dy * dy + dz * dz)
        if size < 1e-6:
            return 0.0, 0.0, 0.0
    size = -size if dx * down[0] + dy * down[1] + dz * down[2] < -0.5 * size else size
    dx, dy, dz = dx / size, dy / size, dz / size
    e = 0.5 * spacing
    _, fore, _ = gap_at((x[0] + e * dx, x[1] + e * dy, x[2] + e * dz), b, solids, turn, spacing)
    _, back, _ = gap_at((x[0] - e * dx, x[1] - e * dy, x[2] - e * dz), b, solids, turn, spacing)
    if back > fore + 1e-3 * spacing:
        dx, dy, dz = -dx, -dy, -dz
    if gap_ahead(x, (dx, dy, dz), b, solids, spacing) < e:
        return 0.0, 0.0, 0.0
    return dx, dy, dz


@kernel
def away_from_others(i, lists, place, n, reach):
    """Vector (3,) across n (3,) off the fluid around particle `i`: of length 1 for one at half of `reach`, m."""
    start, middle, _, index = lists
    x, y, z = place
    px, py, pz = 0.0, 0.0, 0.0
    for s in range(start[i], middle[i]):
        j = index[s]
        dx, dy, dz = x[i] - x[j], y[i] - y[j], z[i] - z[j]
        r = math.sqrt(dx * dx + dy * dy + dz * dz)
        if 0.0 < r < reach:
            share = 2.0 * (1.0 - r / reach) / r
            px, py, pz = px + share * dx, py + share * dy, pz + share * dz
    return across(px, py, pz, n)


@kernel
def turn_out(at, lists, of_samples, motion, solids, ways, kinematics, noted):
    """Velocity of fluid inside a body: outward where the surface is nearest, at least its depth at the rate out.

    Fluid in a thin gap between a body and another solid goes with the body, and besides, `lead` (n, 3) of `at` (n,),
    m/s, to the middle of the gap, and along, off other fluid there; its class says so. Bodies that move come before
    fixed ones; where two overlap by more than half a spacing there is no gap. `of_samples`: body and shift of each
    particle, and whether a body is fixed; `noted`: the classes of all, and `lead`.
    """
    surface, lead = noted
    body, shift, fixed = of_samples
    _, middle, end, index = lists
    position, turn, velocity, spin, _, _ = motion
    spacing, out, middling, along, down = ways
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    for row in range(at.size):
        i = at[row]
        one, two, three, caught = -1, -1, -1, False  # bodies seen last, of which a list has many samples
        lead[row] = 0.0
        for s in range(middle[i], end[i]):
            j = index[s]
            b = body[j]
            if b < 0 or b == one or b == two or b == three:
                continue
            one, two, three = b, one, two
            t = turn[b].ravel()
            place = x[i] - shift[j, 0], y[i] - shift[j, 1], z[i] - shift[j, 2]
            depth, gap, n = gap_at(place, b, solids, t, spacing)
            thin = -0.5 * spacing < gap < _THIN * spacing
            if (caught and fixed[b]) or (not thin and (caught or depth <= 0.0)):
                continue
            dx, dy, dz = place[0] - position[b, 0], place[1] - position[b, 1], place[2] - position[b, 2]
            p, q, r = spin[b]
            bu = velocity[b, 0] + q * dz - r * dy
            bv = velocity[b, 1] + r * dx - p * dz
            bw = velocity[b, 2] + p * dy - q * dx
            if thin:
                u[i], v[i], w[i], surface[i] = bu, bv, bw, SHUT_IN
                way, off = way_along(place, n, b, solids, t, spacing, down), middling * (0.5 * gap + depth)
                free = away_from_others(i, lists, kinematics.place, n, _APART * spacing)
                wx, wy, wz = way[0] + free[0], way[1] + free[1], way[2] + free[2]
                speed = along / max(math.sqrt(wx * wx + wy * wy + wz * wz), 1.0)
                lead[row, 0] = off * n[0] + speed * wx
                lead[row, 1] = off * n[1] + speed * wy
                lead[row, 2] = off * n[2] + speed * wz
                caught = True
                if fixed[b]:
                    continue
                break
            away = (u[i] - bu) * n[0] + (v[i] - bv) * n[1] + (w[i] - bw) * n[2]
            more = max(depth * out - away, 0.0)
            u[i] += more * n[0]
            v[i] += more * n[1]
            w[i] += more * n[2]
