"""Friction of water at walls and bodies, for every scheme: what boundary samples find, and what water feels of it.

A boundary sample finds its slip, three numbers, from the water that it sees; the water then sums over the samples it
sees. Pairs are the same on both sides, so momentum is kept. By a wall law the slip is the stress on a face, spread over
the water that the sample sees: tau A / (m sum W), an acceleration. By no-slip it is the velocity that a sample would
need for the water between to be at rest at the wall: 2 u_wall less the mean of the water's (Adami, Hu & Adams 2012,
eqs 22-23), felt through the viscosity of the pair.
"""

import math
from typing import NamedTuple

import numpy as np

from parsim.fluid.weights.choice import weight_at
from parsim.machine.jit import each, kernel, prange
from parsim.particles.state import SURFACE
from parsim.particles.tables import Vectors

SLIP = ("qx", "qy", "qz")
KAPPA = 0.41
_POWER = 8.3  # of the law u = 8.3 u* (d u* / nu)^(1/7) (Werner & Wengle 1993)
_FIRST, _THIN = 0.5, 1e-6  # spacings off a face, up to where water counts only if there is no other; how little it does
_LEAST = 1.0  # of ln(30 d / ks): beyond, roughness is larger than what is seen


class Facets(NamedTuple):
    """Faces of boundary samples: particle (f,), its distance to the face, m, normal (f, 3) to the water, area, m2,
    roughness ks, m."""

    at: np.ndarray
    under: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    roughness: np.ndarray


class Seen(NamedTuple):
    """How faces see water: spacing, m; the sum of W of half a lattice; volume of a particle, m^d; viscosity, m2/s;
    density, kg/m3."""

    spacing: float
    half: float
    volume: float
    viscosity: float
    density: float


@kernel
def stress_over_density(speed, distance, roughness, viscosity):
    """Wall stress over density, m2/s2, of water that goes at `speed`, m/s, at a `distance`, m, from the wall.

    (kappa u / ln(30 d / ks))^2 where it is rough (Nikuradse 1933); the power law of Werner & Wengle where it is smooth,
    with its viscous layer; the larger of the two.
    """
    if speed <= 0.0:
        return 0.0
    u = speed / _POWER
    smooth = u * u * math.sqrt(math.sqrt(_POWER * viscosity / (speed * distance)))
    smooth = max(smooth, viscosity * speed / distance)
    if roughness <= 0.0:
        return smooth
    rough = KAPPA * speed / max(math.log(30.0 * distance / roughness), _LEAST)
    return max(smooth, rough * rough)


@each
def rub(facets, lists, kinematics, weight, seen, stress):
    """Stress times area, N, of each face on its wall or body: `stress` (f, 3).

    The velocity is that of the water from half a spacing off the face on, by W and by how far beyond, at the distance
    whose logarithm is the mean. What sees less water than half a lattice is wet for that share.
    """
    at, under, normal, area, roughness = facets
    spacing, half, _, viscosity, density = seen
    start, middle, _, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    for f in prange(at.size):
        i = at[f]
        nx, ny, nz = normal[f, 0], normal[f, 1], normal[f, 2]
        every, total, logs = 0.0, 0.0, 0.0
        sx, sy, sz = 0.0, 0.0, 0.0
        for c in range(start[i], middle[i]):
            j = index[c]
            dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
            r2 = dx * dx + dy * dy + dz * dz
            wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            far = (dx * nx + dy * ny + dz * nz - under[f]) / spacing
            every += wt
            wt *= min(max(far - _FIRST, _THIN), 1.0)
            total += wt
            logs += wt * math.log(max(far, 0.5 * _FIRST))
            sx, sy, sz = sx + wt * (u[j] - u[i]), sy + wt * (v[j] - v[i]), sz + wt * (w[j] - w[i])
        stress[f, 0] = stress[f, 1] = stress[f, 2] = 0.0
        if total <= 0.0:
            continue
        sx, sy, sz = sx / total, sy / total, sz / total
        along = sx * nx + sy * ny + sz * nz
        sx, sy, sz = sx - along * nx, sy - along * ny, sz - along * nz
        speed = math.sqrt(sx * sx + sy * sy + sz * sz)
        distance = spacing * math.exp(logs / total)
        force = density * stress_over_density(speed, distance, roughness[f], viscosity) * area[f]
        if speed > 0.0:
            force *= min(every / half, 1.0) / speed
            stress[f, 0], stress[f, 1], stress[f, 2] = force * sx, force * sy, force * sz


@kernel
def spread(facets, lists, place, weight, mass, stress, slip):
    """Slip of the samples that have faces, m/s2 over W: their stress over the mass, kg, of the water they see."""
    at = facets.at
    x, y, z = place
    last, every = -1, 0.0
    for f in range(at.size):
        i = at[f]
        if i != last:
            last, every = i, 0.0
            slip.x[i] = slip.y[i] = slip.z[i] = 0.0
            for c in range(lists.start[i], lists.middle[i]):
                j = lists.index[c]
                r2 = (x[j] - x[i]) ** 2 + (y[j] - y[i]) ** 2 + (z[j] - z[i]) ** 2
                every += weight_at(weight, r2, 1.0 / math.sqrt(r2))[0]
        if every > 0.0:
            slip.x[i] -= stress[f, 0] / (mass * every)
            slip.y[i] -= stress[f, 1] / (mass * every)
            slip.z[i] -= stress[f, 2] / (mass * every)


@each
def mirror(at, lists, kinematics, weight, slip):
    """Slip, m/s, of the samples `at` for water that is at rest at the wall."""
    start, middle, _, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    qx, qy, qz = slip.x, slip.y, slip.z
    for row in prange(at.size):
        i = at[row]
        every, sx, sy, sz = 0.0, 0.0, 0.0, 0.0
        for c in range(start[i], middle[i]):
            j = index[c]
            r2 = (x[j] - x[i]) ** 2 + (y[j] - y[i]) ** 2 + (z[j] - z[i]) ** 2
            wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            every += wt
            sx, sy, sz = sx + wt * u[j], sy + wt * v[j], sz + wt * w[j]
        if every > 0.0:  # else what is listed lies between the support and its skin
            sx, sy, sz = sx / every, sy / every, sz / every
        qx[i], qy[i], qz[i] = 2.0 * u[i] - sx, 2.0 * v[i] - sy, 2.0 * w[i] - sz


@kernel
def _by_sample(weight, d, slip, velocity, loose, drag, dimensions):
    """Acceleration of water with this `velocity` by a sample at `d` from it: by a wall law where `drag` is zero."""
    r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    wt, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
    if drag == 0.0:
        return wt * slip[0], wt * slip[1], wt * slip[2]
    change = (slip[0] - velocity[0], slip[1] - velocity[1], slip[2] - velocity[2])
    return shear(drag * g, r2, d, change, loose, dimensions)


@kernel
def shear(size, r2, d, change, loose, dimensions):
    """Acceleration of a particle by the viscosity of a pair, whose velocities differ by `change`, at `d` from it.

    `size` is 2 d nu W / (r2 n0). Along the change (Morris, Fox & Zhu 1997), which is right to 0.03 % also where a
    steady flow has brought the particles into rows, as it does; along `d`, as in the momentum sweep, viscosity is then
    7 % too small. `loose`: whether one of them is at the surface: there only the latter leaves a rigid turn alone.
    """
    if loose:
        b = (dimensions + 2) * size / r2 * (change[0] * d[0] + change[1] * d[1] + change[2] * d[2])
        return b * d[0], b * d[1], b * d[2]
    return size * change[0], size * change[1], size * change[2]


@each
def drag_water(at, lists, kinematics, surface, weight, rubbing, drag, acceleration):
    """Add to the acceleration of the water `at` what the samples it sees give it.

    `rubbing`: slip and share (n,) of samples, zero of those that do not rub; `drag`: 2 d nu / n0, or 0 by a wall law,
    and d.
    """
    _, middle, end, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    (qx, qy, qz), scale = rubbing
    ax, ay, az = acceleration.x, acceleration.y, acceleration.z
    for row in prange(at.size):
        i = at[row]
        sx, sy, sz = 0.0, 0.0, 0.0
        own, loose = (u[i], v[i], w[i]), surface[i] >= SURFACE
        for c in range(middle[i], end[i]):
            j = index[c]
            share = scale[j]
            if share == 0.0:
                continue
            d = (x[j] - x[i], y[j] - y[i], z[j] - z[i])
            fx, fy, fz = _by_sample(weight, d, (qx[j], qy[j], qz[j]), own, loose, drag[0], drag[1])
            sx, sy, sz = sx + share * fx, sy + share * fy, sz + share * fz
        ax[i] += sx
        ay[i] += sy
        az[i] += sz


@each
def drag_samples(at, lists, kinematics, surface, weight, rubbing, drag, mass, force):
    """Add to the `force` (samples, 3), N, on the samples `at` what these give to the water that they see, times -1."""
    start, middle, _, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    (qx, qy, qz), scale = rubbing
    for row in prange(at.size):
        i = at[row]
        share = scale[i] * mass
        if share == 0.0:
            continue
        sx, sy, sz = 0.0, 0.0, 0.0
        for c in range(start[i], middle[i]):
            j = index[c]
            d, own, loose = (x[i] - x[j], y[i] - y[j], z[i] - z[j]), (u[j], v[j], w[j]), surface[j] >= SURFACE
            fx, fy, fz = _by_sample(weight, d, (qx[i], qy[i], qz[i]), own, loose, drag[0], drag[1])
            sx, sy, sz = sx + fx, sy + fy, sz + fz
        force[row, 0] -= share * sx
        force[row, 1] -= share * sy
        force[row, 2] -= share * sz


def slip_of(p):
    """The slip of the boundary samples."""
    return Vectors(*(getattr(p, name) for name in SLIP))
