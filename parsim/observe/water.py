"""Kernels of what is watched in a run: energies, particles where none may be, front, water levels."""

import math

import numpy as np

from parsim.geometry.inside import nearest_face
from parsim.machine.jit import kernel
from parsim.particles.state import DETACHED, SURFACE


@kernel
def energies(at, kinematics, n, water, gravity, out):
    """Kinetic, potential and elastic energy, J, and m / rho over m / rho0 of each fluid particle `at`: out (n, 4).

    Elastic: what the pair forces put into n, the integral of p / (rho0 s) over s = n / n0 of the state,
    c0^2 / 7 ((s^7 - 1) / 7 - ln s). `water`: mass of a particle, kg, n0, c0^2, m2/s2; gravity (3,), m/s2.
    """
    x, y, z = kinematics.place
    u, v, w = kinematics.velocity
    mass, n0, sound2 = water
    gx, gy, gz = gravity
    for row in range(at.size):
        i = at[row]
        s = n[i] / n0
        s2 = s * s
        out[row, 0] = 0.5 * mass * (u[i] * u[i] + v[i] * v[i] + w[i] * w[i])
        out[row, 1] = -mass * (gx * x[i] + gy * y[i] + gz * z[i])
        out[row, 2] = mass * sound2 / 7.0 * ((s2 * s2 * s2 * s - 1.0) / 7.0 - math.log(s))
        out[row, 3] = 1.0 / s


@kernel
def misplaced(at, place, walls, bodies, gate, slack, count):
    """Count fluid particles deeper than `slack`, m, in walls, bodies and gate into count (3,).

    walls: see `geometry.faces.planes_of_walls`; bodies: centre (b, 3), turn (b, 3, 3), half (b, 3), axes; gate: its low
    and high x, and where it ends below, m.
    """
    x, y, z = place
    centre, turn, half, axes = bodies
    low, high, barrier = gate
    for i in at:
        r, behind = (x[i], y[i], z[i]), False
        for w in range(len(walls)):
            within = True
            for a in range(3):
                within = within and walls[w, 4 + a] <= r[a] <= walls[w, 7 + a]
            height = walls[w, 0] * r[0] + walls[w, 1] * r[1] + walls[w, 2] * r[2] - walls[w, 3]
            behind = behind or (within and height < -slack)
        count[0] += behind
        for b in range(len(centre)):
            count[1] += nearest_face(r, b, centre, turn, half, axes)[0] > slack
        count[2] += low + slack < r[0] < high - slack and r[2] > barrier + slack


@kernel
def count_surface(at, surface):
    """Number of surface and detached particles among `at`."""
    total = 0
    for i in at:
        total += surface[i] >= SURFACE
    return total


@kernel
def columns(at, surface, x, low, width, filled, farthest):
    """Mark the columns of `width`, m, that hold connected water, and its largest x in each."""
    for i in at:
        if surface[i] != DETACHED:
            k = min(max(int((x[i] - low) / width), 0), filled.size - 1)
            filled[k] = 1.0
            farthest[k] = max(farthest[k], x[i])


@kernel
def levels(at, surface, place, gauges, reach, flat, out):
    """Highest connected particle within `reach`, m, of each gauge (k, 2) into out (k,); `flat` ignores y."""
    x, y, z = place
    for k in range(gauges.shape[0]):
        for i in at:
            if surface[i] != DETACHED:
                dx, dy = x[i] - gauges[k, 0], y[i] - gauges[k, 1]
                if dx * dx + (0.0 if flat else dy * dy) < reach * reach:
                    out[k] = max(out[k], z[i])


def front(filled, farthest, spacing):
    """Place of the first column without connected water downstream of the first with some, m: the last water before."""
    wet = np.flatnonzero(filled)
    if not wet.size:
        return np.nan
    gap = np.flatnonzero(filled[wet[0] :] == 0)
    last = wet[0] + gap[0] - 1 if gap.size else filled.size - 1
    return farthest[last] + 0.5 * spacing
