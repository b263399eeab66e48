"""Flows whose exact course is known, for the physics tests: made, run, and measured."""

import math

import numpy as np

from parsim.case.model import parse
from parsim.domain.comm import Comm
from parsim.fluid.wcmps.settings import Settings
from parsim.run.simulation import Simulation

GRAVITY = 9.81
WOOD = {"wood": {"young": 1e9, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}}


def merged(data, changes):
    """The nested dict `data` with `changes` merged into its tables."""
    data = dict(data)
    for key, value in changes.items():
        both = isinstance(value, dict) and isinstance(data.get(key), dict)
        data[key] = merged(data[key], value) if both else value
    return data


def simulation(data, **changes):
    """A case as a nested dict, with `changes` merged in, after its settling, on one rank."""
    case = parse(merged(data, changes))
    s = Simulation(case, Comm(case.box.faces.x_min.repeats))
    while s.time < 0.0:
        s.step()
    return s


def tank(length, height, spacing, fill=None, across=None, periodic="", **water):
    """A case: a tank of water; `fill` its highest corner (x, z); `across` the width in y, m, or None in 2D.

    `water`: keys of that table, or of its scheme.
    """
    faces = {f"{axis}_{side}": "periodic" for axis in periodic for side in ("min", "max")}
    width = 1.0 if across is None else across
    scheme = {key: water.pop(key) for key in list(water) if key in Settings.model_fields}
    x, z = fill or (length, height)
    return {
        "dimensions": 2 if across is None else 3,
        "spacing": spacing,
        "run": {"until": 1e3},
        "box": {"max": [length, width, height], "faces": faces},
        "water": {"fill": [{"min": [0.0, 0.0, 0.0], "max": [x, width, z]}], "scheme": scheme, **water},
    }


def fluid(s):
    """The particles, and the indices of the water among them."""
    return s.domain.particles, s.near.fluid


def decaying(times, values, omega):
    """Angular frequency and decay rate, 1/s, of A cos(w t + f) exp(-g t), by least squares (Gauss-Newton)."""
    a, w, f, g = values[0], omega, 0.0, 0.05
    for _ in range(60):
        c, s, e = np.cos(w * times + f), np.sin(w * times + f), np.exp(-g * times)
        slopes = np.stack([c * e, -a * times * s * e, -a * s * e, -a * times * c * e], 1)
        step, *_ = np.linalg.lstsq(slopes, values - a * c * e, rcond=None)
        a, w, f, g = np.array([a, w, f, g]) + step
    return w, g


def standing_wave(rows, amplitude, viscosity, across=None, periods=4.0, disorder=0.0, **water):
    """Frequency over the exact one and decay over 2 nu k^2 (Lamb 1932, art. 348) of a standing wave.

    A basin 1 m long and 0.5 m deep; `rows` of particles over the depth; `amplitude` of the surface over the depth;
    starts from a level surface. `water`: keys of its table or of its scheme.
    """
    length, depth = 1.0, 0.5
    spacing = depth / rows
    s = simulation(
        tank(
            length,
            1.3 * depth,
            spacing,
            (length, depth),
            across and across * spacing,
            "y" if across else "",
            viscosity=viscosity,
            disorder=disorder,
            **water,
        )
    )
    k = math.pi / length
    omega = math.sqrt(GRAVITY * k * math.tanh(k * depth))
    speed = amplitude * depth * omega / math.sinh(k * depth)
    p, at = fluid(s)
    p.u[at] = speed * np.cosh(k * p.z[at]) * np.sin(k * p.x[at])
    p.w[at] = -speed * np.sinh(k * p.z[at]) * np.cos(k * p.x[at])
    s.domain.refresh("u", "w")
    times, values = [], []
    while s.time < periods * 2.0 * math.pi / omega:
        s.step()
        p, at = fluid(s)
        u, w = np.cosh(k * p.z[at]) * np.sin(k * p.x[at]), -np.sinh(k * p.z[at]) * np.cos(k * p.x[at])
        times.append(s.time)
        values.append((p.u[at] * u + p.w[at] * w).sum() / (u * u + w * w).sum() / speed)
    w, g = decaying(np.array(times), np.array(values), omega)
    return w / omega, g / (2.0 * viscosity * k * k)


def channel(rows, disorder=0.0, until=2.8, profile="log", across=None, **water):
    """A level frictionless channel 0.2 m deep, periodic, with a profile at t = 0: a dict of what is left at the end.

    spread and mean of u over those at the start; means of u in five layers over those at the start; level over 0.2 m.
    """
    depth = 0.2
    spacing = depth / rows
    case = tank(
        4.0 * depth,
        1.5 * depth,
        spacing,
        (4.0 * depth, depth),
        across and across * spacing,
        "xy" if across else "x",
        disorder=disorder,
        **water,
    )
    fill = case["water"]["fill"][0]
    fill["velocity"] = [0.718, 0.0, 0.0]
    if profile == "log":
        fill["profile"] = {"kind": "log", "roughness": 0.02}
    s = simulation(case)

    def measured():
        p, at = fluid(s)
        layer = np.clip((5.0 * p.z[at] / depth).astype(int), 0, 4)
        return p.u[at].mean(), p.u[at].std(), np.array([p.u[at][layer == k].mean() for k in range(5)])

    mean, spread, layers = measured()
    while s.time < until:
        s.step()
    p, at = fluid(s)
    late = measured()
    return {
        "mean": late[0] / mean,
        "spread": late[1] / spread if spread > 0.0 else math.nan,
        "layers": late[2] / layers,
        "level": 2.0 * p.z[at].mean() / depth,
    }


def periodic_box(rows, length, viscosity, **water):
    """A doubly periodic box of water without gravity, in 2D, of `rows` particles each way."""
    case = tank(length, length, length / rows, periodic="xz", speed=1.0, viscosity=viscosity, **water)
    return case | {"gravity": [0.0, 0.0, 0.0]}


def shear_wave(rows, pressure, along, viscosity=2e-3):
    """Decay over nu k^2, largest kinetic energy over the first, mean pressure at the end of u ~ sin(k x).

    `pressure`, Pa; `along` = 0: planes along the lattice; 1: along its diagonal, for a lattice is stiffer there by as
    much as it is softer along its axes. The kinetic energy of 1 m/s at the start, to a decay by half.
    """
    length = 0.4
    s = simulation(periodic_box(rows, length, viscosity))
    k = 2.0 * math.pi / length * np.array([along, 1.0])
    way = np.array([1.0, -along]) / math.hypot(1.0, along)
    p, at = fluid(s)
    p.n[at] = s.scheme.at_rest(np.full(at.size, pressure))["n"]
    wave = np.sin(k[0] * p.x + k[1] * p.z)
    p.u[:], p.w[:] = way[0] * wave, way[1] * wave
    s.domain.refresh("n")
    most = 0.0
    while s.time < math.log(2.0) / (viscosity * (k**2).sum()):
        s.step()
        p, at = fluid(s)
        most = max(most, (p.u[at] ** 2 + p.w[at] ** 2).mean() / 0.5)
    wave = np.sin(k[0] * p.x[at] + k[1] * p.z[at])
    left = 2.0 * ((p.u[at] * way[0] + p.w[at] * way[1]) * wave).mean()
    return -math.log(left) / (viscosity * (k**2).sum() * s.time), most, p.p[at].mean()


def taylor_green(rows, disorder, until=0.5, reynolds=100.0):
    """Kinetic energy of a Taylor-Green vortex over the exact one at the end."""
    s = simulation(periodic_box(rows, 1.0, 1.0 / reynolds, disorder=disorder))
    k, (p, at) = 2.0 * math.pi, fluid(s)
    p.u[:], p.w[:] = -np.cos(k * p.x) * np.sin(k * p.z), np.sin(k * p.x) * np.cos(k * p.z)
    pressure = -250.0 * (np.cos(2.0 * k * p.x) + np.cos(2.0 * k * p.z))
    p.n[:] = s.scheme.lattice.number * (1.0 + pressure / s.scheme.stiffness) ** (1.0 / 7.0)
    first = (p.u[at] ** 2 + p.w[at] ** 2).mean()
    while s.time < until:
        s.step()
    p, at = fluid(s)
    return (p.u[at] ** 2 + p.w[at] ** 2).mean() / first / math.exp(-4.0 * k * k / reynolds * s.time)


def energy(s):
    """Kinetic, potential and elastic energy of the water, J per kg of one particle."""
    p, at = fluid(s)
    n = p.n[at] / s.scheme.lattice.number
    elastic = s.scheme.sound**2 / 7.0 * ((n**7 - 1.0) / 7.0 - np.log(n))
    return (0.5 * (p.u[at] ** 2 + p.v[at] ** 2 + p.w[at] ** 2) + GRAVITY * p.z[at] + elastic).sum()


def dam_break(rows):
    """Times T = t sqrt(2 g / a) at which the front is at Z = x / a of 2, 3, 4, 5, and the most energy over the first.

    A column a wide and 2 a high, `rows` particles over a.
    """
    a = 0.05715
    s = simulation(tank(8.0 * a, 3.0 * a, a / rows, (a, 2.0 * a)))
    first, most, times, front = energy(s), 0.0, [], []
    while s.time < 0.25:
        s.step()
        p, at = fluid(s)
        times.append(s.time * math.sqrt(2.0 * GRAVITY / a))
        front.append((p.x[at][p.surface[at] != 3].max() + 0.5 * s.case.spacing) / a)
        most = max(most, energy(s) / first) if s.step_count % 10 == 0 else most
    return np.interp([2.0, 3.0, 4.0, 5.0], np.maximum.accumulate(front), times), most


def square_in_tank(side, spacing, density, height, width, depth, angle=0.0, **body):
    """A tank, 2D, `width` wide and `depth` deep, with a square of `side` whose centre is at `height`, all in m."""
    square = {
        "name": "square",
        "shape": {"size": [side, 1.0, side]},
        "density": density,
        "material": "wood",
        "position": [0.5 * width, 0.5, height],
        "angles": [0.0, angle, 0.0],
        **body,
    }
    return tank(width, depth + 2.0 * side, spacing, (width, depth)) | {"materials": WOOD, "bodies": [square]}


def course(s, until):
    """Times, s, places (n, 3), m, and tilts, degrees, of the first body of a simulation run to `until`."""
    rows = []
    while s.time < until:
        s.step()
        q = s.bodies.quaternion[0]
        rows.append([s.time, *s.bodies.position[0], math.degrees(2.0 * math.atan2(q[2], q[0]))])
    rows = np.array(rows)
    return rows[:, 0], rows[:, 1:4], rows[:, 4]
