"""Eddy viscosity for every scheme: nu_t = l^2 |S|, |S| = sqrt(2 S : S), from the gradient of the velocity.

Where it differs between two particles the harmonic mean holds. The gradient is exact for a velocity that is linear in
space, also beside walls and the surface (with the inverse of the sum of e e W; Bonet & Lok 1999).
"""

import math
from typing import NamedTuple

import numpy as np

from parsim.fluid.friction import KAPPA
from parsim.fluid.weights.choice import weight_at
from parsim.geometry.faces import planes_of_walls
from parsim.machine.jit import kernel, prange, rows
from parsim.particles.state import SURFACE

_EVEN = 0.05  # of what a full support has: determinant from which the sum of e e W is taken for singular
_FILTER = 2.0  # width of the filter, in spacings
_DUCT = 0.4  # slope at the wall of Nikuradse's length, which is to be kappa


class Length(NamedTuple):
    """What the length of eddies depends on besides depths: walls but the floor (w, 4), normal and level; whether there
    is a floor; longest, m; most, m2/s, that any viscosity is."""

    walls: np.ndarray
    floor: bool
    longest: float
    most: float = math.inf


class Depths(NamedTuple):
    """Columns of water, nx by ny, `edge` wide, from x and y on, m: bottom and top (nx ny,), m, and whether the top is
    the underside of a body (nx ny,)."""

    x: float
    y: float
    edge: float
    nx: int
    ny: int
    bottom: np.ndarray
    top: np.ndarray
    covered: np.ndarray


def length_of(case):
    """`Length` for the table `water.eddies` of a case."""
    eddies, planes = case.water.eddies, planes_of_walls(case)[:, :4]
    floor = planes[:, 2] > 0.5
    longest = eddies.constant * _FILTER * case.spacing if eddies.kind == "smagorinsky" else math.inf
    return Length(planes[~floor], bool(floor.any()), longest)


@kernel
def _mixing_length(length, depths, x, y, z):
    """kappa d, m, at most the longest; over the floor kappa d sqrt(1 - d / H), which makes the profile logarithmic.

    Between the floor and ice it is that of pipes, 0.14 - 0.08 s^2 - 0.06 s^4 of half the depth, s from 0 half way to 1
    at either (Nikuradse 1933): the shear is not zero half way where one of them is rougher.
    """
    walls, floor, most, _ = length
    for k in range(len(walls)):
        most = min(most, KAPPA * (walls[k, 0] * x + walls[k, 1] * y + walls[k, 2] * z - walls[k, 3]))
    if floor:
        i = min(max(int((x - depths.x) / depths.edge), 0), depths.nx - 1)
        j = min(max(int((y - depths.y) / depths.edge), 0), depths.ny - 1)
        bottom, top = depths.bottom[i * depths.ny + j], depths.top[i * depths.ny + j]
        d, h = z - bottom, max(top - bottom, 0.0)
        if depths.covered[i * depths.ny + j]:
            s = min(abs(2.0 * d - h) / h, 1.0) if h > 0.0 else 1.0
            most = min(most, KAPPA / _DUCT * 0.5 * h * (0.14 - s * s * (0.08 + 0.06 * s * s)))
        elif h > 0.0:
            most = min(most, KAPPA * d * math.sqrt(max(1.0 - d / h, 0.0)))
    return max(most, 0.0)


@kernel
def _strain(m, u, v, w, least):
    """|S|, 1/s, from the sums of e e W and of e W times the change of each component; 0 where these say too little."""
    xx, xy, xz, yy, yz, zz = m
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy  # cofactors
    d, e, f = xx * zz - xz * xz, xz * xy - xx * yz, xx * yy - xy * xy
    determinant = xx * a + xy * b + xz * c
    if determinant <= least:
        return 0.0
    ux, vy = a * u[0] + b * u[1] + c * u[2], b * v[0] + d * v[1] + e * v[2]
    wz = c * w[0] + e * w[1] + f * w[2]
    xy = b * u[0] + d * u[1] + e * u[2] + (a * v[0] + b * v[1] + c * v[2])
    xz = c * u[0] + e * u[1] + f * u[2] + (a * w[0] + b * w[1] + c * w[2])
    yz = c * v[0] + e * v[1] + f * v[2] + (b * w[0] + d * w[1] + e * w[2])
    return math.sqrt(2.0 * (ux * ux + vy * vy + wz * wz) + xy * xy + xz * xz + yz * yz) / determinant


@rows
def eddy_viscosity(at, lists, kinematics, weight, length, depths, lattice, out):
    """Eddy viscosity, m2/s, of the water `at`: out (n,). lattice: number density n0 and dimensions.

    Sums in order took four times as long, here and in `mix`: half of a step in three dimensions.
    """
    n0, dimensions = lattice
    start, middle, _, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    least = _EVEN * (n0 / dimensions) * (n0 / dimensions) * (n0 / dimensions if dimensions == 3 else 1.0)
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi = x[i], y[i], z[i], u[i], v[i], w[i]
        xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        ux, uy, uz, vx, vy, vz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for c in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[c]
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            _, g, _ = weight_at(weight, r2, 1.0 / math.sqrt(r2))
            gx, gy, gz = g * dx, g * dy, g * dz
            du, dv, dw = u[j] - ui, v[j] - vi, w[j] - wi
            xx, xy, xz = xx + gx * dx, xy + gx * dy, xz + gx * dz
            yy, yz, zz = yy + gy * dy, yz + gy * dz, zz + gz * dz
            ux, uy, uz = ux + gx * du, uy + gy * du, uz + gz * du
            vx, vy, vz = vx + gx * dv, vy + gy * dv, vz + gz * dv
            wx, wy, wz = wx + gx * dw, wy + gy * dw, wz + gz * dw
        if dimensions == 2:
            yy = 1.0
        strain = _strain((xx, xy, xz, yy, yz, zz), (ux, uy, uz), (vx, vy, vz), (wx, wy, wz), least)
        size = _mixing_length(length, depths, xi, yi, zi)
        out[i] = min(size * size * strain, length.most)


@rows
def mix(at, lists, kinematics, surface, weight, viscosities, viscous, acceleration):
    """Add the viscous stress to the acceleration of the water `at`: by the molecular and the eddy `viscosities`, m2/s.

    A pair acts along the change of its velocity (Morris, Fox & Zhu 1997), which is right to 0.03 % also where a steady
    flow has brought the particles into rows, as it does; along the pair, as in the momentum sweep, viscosity is then
    7 % too small. Where one of them is at the surface it does the latter: only that leaves a rigid turn alone there.
    viscous: 2 d / n0, and d. Loops without branches become vector code.
    """
    start, middle, _, index = lists
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    molecular, eddy = viscosities
    twice, turned = 2.0 * viscous[0], viscous[1] + 2.0
    ax, ay, az = acceleration.x, acceleration.y, acceleration.z
    for row in prange(at.size):
        i = at[row]
        xi, yi, zi, ui, vi, wi = x[i], y[i], z[i], u[i], v[i], w[i]
        sx, sy, sz, own, loose = 0.0, 0.0, 0.0, molecular + eddy[i], 1.0 if surface[i] >= SURFACE else 0.0
        for c in range(np.uint64(start[i]), np.uint64(middle[i])):
            j = index[c]
            other = molecular + eddy[j]
            both = own + other if own + other > 0.0 else 1.0
            dx, dy, dz = x[j] - xi, y[j] - yi, z[j] - zi
            r2 = dx * dx + dy * dy + dz * dz
            inverse = 1.0 / math.sqrt(r2)
            _, g, _ = weight_at(weight, r2, inverse)
            size = twice * g * own * other / both
            du, dv, dw = u[j] - ui, v[j] - vi, w[j] - wi
            along = max(1.0 if surface[j] >= SURFACE else 0.0, loose)
            across, along = size * (1.0 - along), size * along * turned * inverse * inverse
            along *= du * dx + dv * dy + dw * dz
            sx += across * du + along * dx
            sy += across * dv + along * dy
            sz += across * dw + along * dz
        ax[i] += sx
        ay[i] += sy
        az[i] += sz
