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
from parsim.machine.jit import kernel, prange, rows
from parsim.particles.tables import Vectors

SLIP = ("qx", "qy", "qz")
WEIGHT = "wendland_c4"  # of all that shears, whatever the scheme's: it need not be compiled for each
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
    """How faces see water: spacing, m; the sum of W of half a lattice; viscosity, m2/s; density, kg/m3."""

    spacing: float
    half: float
    viscosity: float
    density: float


@kernel
def logarithm(x):
    """Natural logarithm of 1e-9 < x < 1e9, within 1e-10; by sqrt, for the last bit of log depends on the library."""
    for _ in range(5):
        x = math.sqrt(x)
    y = (x - 1.0) / (x + 1.0)
    square, total, power = y * y, 0.0, y
    for k in range(10):
        total += power / (2 * k + 1)
        power *= square
    return 64.0 * total


@kernel
def stress_over_density(speed, distance, log, roughness, viscosity):
    """Wall stress over density, m2/s2, of water that goes at `speed`, m/s, at a `distance`, m, from the wall.

    `log`: the mean of ln(distance). (kappa u / ln(30 d / ks))^2 where it is rough (Nikuradse 1933); the power law of
    Werner & Wengle where it is smooth, with its viscous layer; the larger of the two.
    """
    if speed <= 0.0:
        return 0.0
    u = speed / _POWER
    smooth = u * u * math.sqrt(math.sqrt(_POWER * viscosity / (speed * distance)))
    smooth = max(smooth, viscosity * speed / distance)
    if roughness <= 0.0:
        return smooth
    rough = KAPPA * speed / max(log + logarithm(30.0 / roughness), _LEAST)
    return max(smooth, rough * rough)


@rows
def rub(facets, lists, kinematics, weight, seen, stress):
    """Stress times area, N, of each face on its wall or body, and the sum of W of the water it sees: `stress` (f, 4).

    The velocity is that of the water from half a spacing off the face on, by W and by how far beyond, and so is the
    distance. The mean of its logarithm is that of the mean less half the relative variance, which is right to 0.003; a
    logarithm for each neighbour took three times as long. What sees less water than half a lattice is wet for that
    share.
    """
    at, under, normal, area, roughness = facets
    spacing, half, viscosity, density = seen
    start, middle, _, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    for f in prange(at.size):
        i = at[f]
        nx, ny, nz = normal[f, 0], normal[f, 1], normal[f, 2]
        every, total, away, squares = 0.0, 0.0, 0.0, 0.0
        sx, sy, sz = 0.0, 0.0, 0.0
        for c in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[c]
            dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
            r2 = dx * dx + dy * dy + dz * dz
            wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            far = (dx * nx + dy * ny + dz * nz - under[f]) / spacing
            every += wt
            wt *= min(max(far - _FIRST, _THIN), 1.0)
            far = max(far, 0.5 * _FIRST)
            total, away, squares = total + wt, away + wt * far, squares + wt * far * far
            sx, sy, sz = sx + wt * (u[j] - u[i]), sy + wt * (v[j] - v[i]), sz + wt * (w[j] - w[i])
        stress[f, 0] = stress[f, 1] = stress[f, 2] = 0.0
        stress[f, 3] = every
        if total <= 0.0:
            continue
        sx, sy, sz = sx / total, sy / total, sz / total
        along = sx * nx + sy * ny + sz * nz
        sx, sy, sz = sx - along * nx, sy - along * ny, sz - along * nz
        speed = math.sqrt(sx * sx + sy * sy + sz * sz)
        mean, square = away / total, squares / total
        log, distance = logarithm(spacing * mean) - 0.5 * (square / (mean * mean) - 1.0), spacing * mean
        force = density * stress_over_density(speed, distance, log, roughness[f], viscosity) * area[f]
        if speed > 0.0:
            force *= min(every / half, 1.0) / speed
            stress[f, 0], stress[f, 1], stress[f, 2] = force * sx, force * sy, force * sz


@kernel
def spread(facets, mass, stress, slip):
    """Slip of the samples that have faces, m/s2 over W: their stress over the mass, kg, of the water they see."""
    at, last = facets.at, -1
    for f in range(at.size):
        i = at[f]
        if i != last:
            last = i
            slip.x[i] = slip.y[i] = slip.z[i] = 0.0
        if stress[f, 3] > 0.0:
            seen = mass * stress[f, 3]
            slip.x[i] -= stress[f, 0] / seen
            slip.y[i] -= stress[f, 1] / seen
            slip.z[i] -= stress[f, 2] / seen


@kernel
def mirror(at, lists, kinematics, weight, slip):
    """Slip, m/s, of the samples `at` for water that is at rest at the wall."""
    start, middle, _, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    qx, qy, qz = slip.x, slip.y, slip.z
    for row in range(at.size):
        i = at[row]
        every, sx, sy, sz = 0.0, 0.0, 0.0, 0.0
        for c in range(start[i], middle[i]):
            j = index[c]
            dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
            r2 = dx * dx + dy * dy + dz * dz
            wt, _, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            every += wt
            sx, sy, sz = sx + wt * u[j], sy + wt * v[j], sz + wt * w[j]
        if every > 0.0:  # else what is listed lies between the support and its skin
            sx, sy, sz = sx / every, sy / every, sz / every
        qx[i], qy[i], qz[i] = 2.0 * u[i] - sx, 2.0 * v[i] - sy, 2.0 * w[i] - sz


@kernel
def _by_sample(weight, d, slip, velocity, drag):
    """Acceleration of water with this `velocity` by a sample at `d` from it: by a wall law where `drag` is zero."""
    r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
    wt, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
    if drag == 0.0:
        return wt * slip[0], wt * slip[1], wt * slip[2]
    size = drag * g
    return size * (slip[0] - velocity[0]), size * (slip[1] - velocity[1]), size * (slip[2] - velocity[2])


@rows
def drag_water(at, lists, kinematics, weight, rubbing, drag, acceleration):
    """Add to the acceleration of the water `at` what the samples it sees give it.

    `rubbing`: slip and share (n,) of samples, zero of those that do not rub; `drag`: 2 d nu / n0, or 0 by a wall law.
    """
    _, middle, end, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    (qx, qy, qz), scale = rubbing
    ax, ay, az = acceleration.x, acceleration.y, acceleration.z
    by_law = 1.0 if drag == 0.0 else 0.0
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi = x[i], y[i], z[i]
        ui, vi, wi = (u[i], v[i], w[i]) if drag != 0.0 else (0.0, 0.0, 0.0)
        sx, sy, sz = 0.0, 0.0, 0.0
        for c in range(np.uint64(middle[i]), np.uint64(end[i])):
            j = index[c]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            wt, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            share = scale[j] * (by_law * wt + drag * g)
            sx += share * (qx[j] - ui)
            sy += share * (qy[j] - vi)
            sz += share * (qz[j] - wi)
        ax[i] += sx
        ay[i] += sy
        az[i] += sz


@kernel
def drag_samples(at, lists, kinematics, weight, rubbing, drag, force):
    """Take from the `force` over mass (samples, 3), m/s2, on the samples `at` what these give to the water."""
    start, middle, _, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    (qx, qy, qz), scale = rubbing
    for row in range(at.size):
        i = at[row]
        share = scale[i]
        if share == 0.0:
            continue
        sx, sy, sz = 0.0, 0.0, 0.0
        for c in range(start[i], middle[i]):
            j = index[c]
            d, own = (x[i] - x[j], y[i] - y[j], z[i] - z[j]), (u[j], v[j], w[j])
            fx, fy, fz = _by_sample(weight, d, (qx[i], qy[i], qz[i]), own, drag)
            sx, sy, sz = sx + fx, sy + fy, sz + fz
        force[row, 0] -= share * sx
        force[row, 1] -= share * sy
        force[row, 2] -= share * sz


def slip_of(p):
    """The slip of the boundary samples."""
    return Vectors(*(getattr(p, name) for name in SLIP))
