"""What samples bring to their bodies: levers of forces, the inertia that the water adds, and their pressures after."""

import numpy as np

from parsim.machine.jit import kernel


@kernel
def arms_of(at, body, place, shift, centre, out):
    """Where the samples `at` are from the centres (bodies, 3) of their bodies: out (n, 3), m.

    `shift` (particles, 3): from a body to its periodic image whose sample a particle is, m.
    """
    x, y, z = place
    for row in range(at.size):
        i = at[row]
        b = body[i]
        out[row, 0] = x[i] - shift[i, 0] - centre[b, 0]
        out[row, 1] = y[i] - shift[i, 1] - centre[b, 1]
        out[row, 2] = z[i] - shift[i, 2] - centre[b, 2]


@kernel
def levers(arms, force, out):
    """Force and torque about the body's centre of each sample at `arms` (n, 3): rows of out (n, 6)."""
    for row in range(len(arms)):
        dx, dy, dz = arms[row]
        fx, fy, fz = force[row]
        out[row, 0], out[row, 1], out[row, 2] = fx, fy, fz
        out[row, 3] = dy * fz - dz * fy
        out[row, 4] = dz * fx - dx * fz
        out[row, 5] = dx * fy - dy * fx


@kernel
def added_inertia(arms, response, out):
    """J^T S J of each sample, S its `response`, J = (1, -[r]), r in `arms`: upper triangles by rows of out (n, 24)."""
    j, s, sj = np.zeros((3, 6)), np.zeros((3, 3)), np.zeros((3, 6))
    j[0, 0] = j[1, 1] = j[2, 2] = 1.0
    for row in range(len(arms)):
        dx, dy, dz = arms[row]
        j[0, 4], j[0, 5], j[1, 3], j[1, 5], j[2, 3], j[2, 4] = dz, -dy, -dz, dx, dy, -dx
        s[0, 0], s[0, 1], s[0, 2], s[1, 1], s[1, 2], s[2, 2] = response[row]
        s[1, 0], s[2, 0], s[2, 1] = s[0, 1], s[0, 2], s[1, 2]
        for e in range(3):
            for c in range(6):
                sj[e, c] = s[e, 0] * j[0, c] + s[e, 1] * j[1, c] + s[e, 2] * j[2, c]
        k = 0
        for a in range(6):
            for c in range(a, 6):
                out[row, k] = j[0, a] * sj[0, c] + j[1, a] * sj[1, c] + j[2, a] * sj[2, c]
                k += 1
        out[row, 21:] = 0.0


@kernel
def respond(at, body, arms, change, lever, p):
    """Pressure p of the samples `at` after the `change` (bodies, 6) of their bodies' accelerations; lever (n, 3)."""
    for row in range(at.size):
        i = at[row]
        dx, dy, dz = arms[row]
        c = change[body[i]]
        p[i] += (
            lever[row, 0] * (c[0] + c[4] * dz - c[5] * dy)
            + lever[row, 1] * (c[1] + c[5] * dx - c[3] * dz)
            + lever[row, 2] * (c[2] + c[3] * dy - c[4] * dx)
        )
