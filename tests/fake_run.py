"""A made-up output folder: a dam break with four blocks that looks like one and obeys no equation.

Water is a lattice column behind a gate; its particles keep their ids and are laid out under a moving surface height.
"""

import json
from pathlib import Path

import numpy as np

from parsim.observe.observers import TABLES
from parsim.output import frames
from parsim.output.series import Table

TANK, LEVEL, GATE, BLOCK = np.array([0.70, 0.15, 0.30]), 0.15, 0.15, np.array([0.0725, 0.0725, 0.0195])
NAMES = ("A1", "A2", "B1", "B2")
START = np.array([[0.038, 0.037, 0], [0.112, 0.037, 0], [0.038, 0.113, 0], [0.112, 0.113, 0]])
REACH = np.array([0.16, 0.52, 0.18, 0.54])
FACES = np.array([[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]])
CORNERS = np.array([[i, j, k] for k in (-0.5, 0.5) for j in (-0.5, 0.5) for i in (-0.5, 0.5)])


def height(x, time):
    """Surface height (m) at ``x``: an intact column, then a spreading wave, then a slosh; its volume is not exact."""
    if time <= 0:
        return np.where(x < GATE, LEVEL, 1e-6)
    celerity = np.sqrt(9.81 * LEVEL)
    ritter = np.clip(2 * celerity - (x - GATE) / time, 0, 3 * celerity) ** 2 / (9 * 9.81)
    phase = np.pi * x / TANK[0]
    slosh = 0.032 + 0.022 * np.cos(phase) * np.cos(3.4 * (time - 0.05)) + 0.004 * np.sin(9 * phase + 6 * time)
    runup = 0.09 * np.exp(-((TANK[0] - x) / 0.03) - ((time - 0.5) / 0.15) ** 2)
    share = np.clip((time - 0.15) / 0.35, 0, 1)
    return np.maximum((1 - share) * ritter + share * slosh + runup, 1e-6)


def poses(time):
    """Centres (4, 3) and quaternions (4, 4) of the blocks, riding on the surface."""
    centre = START.copy()
    centre[:, 0] += REACH * (1 - np.exp(-((max(time, 0) / 0.55) ** 2)))
    centre[:, 0] = np.minimum(centre[:, 0], TANK[0] - 0.037)
    ahead, behind = (height(centre[:, 0] + d, time) for d in (0.03, -0.03))
    level = LEVEL if time <= 0 else np.maximum((ahead + behind) / 2, 0.0169)
    centre[:, 2] = level - 0.868 * BLOCK[2] + BLOCK[2] / 2
    half = -np.arctan2(ahead - behind, 0.06) / 2 * (time > 0)
    return centre, np.stack([np.cos(half), 0 * half, np.sin(half), 0 * half], 1)


def surfaces(centre, quaternion):
    """Corner points, faces and the body of each face."""
    w, y = quaternion[:, :1], quaternion[:, 2:3]
    cosine, sine = 1 - 2 * y * y, 2 * w * y
    local = CORNERS * BLOCK
    x, z = cosine * local[:, 0] + sine * local[:, 2], -sine * local[:, 0] + cosine * local[:, 2]
    points = np.stack([x, np.broadcast_to(local[:, 1], x.shape), z], -1) + centre[:, None]
    faces = np.concatenate([FACES + 8 * i for i in range(len(centre))])
    return points.reshape(-1, 3), faces, np.repeat(np.arange(len(centre)), len(FACES))


def water(spacing, time, centre):
    """Points and fields: equal parts of the volume in mass coordinates, pressed down under the blocks."""
    counts = np.round([GATE / spacing, TANK[1] / spacing, LEVEL / spacing]).astype(int)
    share, y, depth = (np.ravel(a) for a in np.meshgrid(*((np.arange(n) + 0.5) / n for n in counts), indexing="ij"))
    noise = np.random.default_rng(1).normal(0, 0.2 * spacing, (len(y), 3)) * (time > 0)
    edges = np.linspace(0, TANK[0], 2001)
    heights = height((edges[1:] + edges[:-1]) / 2, time)
    filled = np.concatenate([[0], np.cumsum(heights)])
    # columns are spread evenly inside their share, otherwise the lattice planes would show
    golden = (np.arange(len(y)) * 0.618033988749895) % 1 if time > 0 else 0.5
    x = np.interp((share - 0.5 / counts[0] + golden / counts[0]) * filled[-1], filled, edges)
    points = np.stack([x, y * TANK[1], depth * height(x, time)], 1) + noise
    for middle in centre:
        over = (np.abs(points[:, :2] - middle[:2]) < BLOCK[:2] / 2).all(1)
        bottom = middle[2] - BLOCK[2] / 2
        points[over, 2] *= np.minimum(1, bottom / np.maximum(height(x[over], time), 1e-6))
    splash = (np.arange(len(y)) % 397 == 5) & (points[:, 0] > 0.62) & (time > 0.2)
    points[splash, 2] += 0.12 * (np.arange(splash.sum()) % 7) / 7
    points = np.clip(points, spacing / 2, TANK - spacing / 2)
    kinds = np.where(splash, 3, np.where(depth > 1 - 1.0 / counts[2], 2, np.where(depth > 1 - 3 / counts[2], 1, 0)))
    speed = np.stack([0.8 * points[:, 0] / 0.7, 0 * x, -0.1 * points[:, 2]], 1) * (time > 0)
    pressure = 9810 * np.maximum(height(x, time) - points[:, 2], 0)
    fields = {"id": np.arange(len(y)), "velocity": speed, "pressure": pressure, "class": kinds.astype(np.uint8)}
    return points, fields | {"density_ratio": np.ones(len(y))}


CASE = """title = "Four blocks released on a dry bed"
dimensions = 3
spacing = {spacing}
gravity = [0.0, 0.0, -9.81]
box = {{ min = [0.0, 0.0, 0.0], max = [0.7, 0.15, 0.3], faces = {{ z_max = "open" }} }}
gate = {{ min_x = 0.15, max_x = 0.155, bottom = 0.0, speed = 0.4, opens = 0.0 }}
water = {{ density = 1000.0, fill = [{{ min = [0.0, 0.0, 0.0], max = [0.15, 0.15, 0.15] }}] }}
run = {{ until = {until} }}
report = {{ snapshots = [0.4, 0.8, 1.2], places = [0.4, 0.8], alike_until = 1.5 }}
"""
BODY = """[[bodies]]
name = "{}"
shape = {{ kind = "box", size = [0.0725, 0.0725, 0.0195] }}
density = 868.0
material = "plastic"
position = [0.05, 0.05, 0.1]
"""
REFERENCE = """# Made up.
case,block,quantity,low,high,model,unit,time,source
dry_four,B1,max X,0.18,0.18,0.30,m,1.5,"Amaro et al. 2021, section 5"
dry_four,,front arrives at the end wall,0.41,0.41,0.41,s,0.41,5.1
dry_four,A2,X,0.60,0.66,,m,1.0,"Amaro et al. 2021, section 5"
other,B1,max X,0.2,0.26,0.28,m,1.2,other case
"""


def make(folder, spacing=0.015, times=None, series=0.02):
    """Write a whole output folder and return its path; ``times`` (s) of the frames."""
    folder = Path(folder)
    times = np.arange(-0.05, 1.25, 0.1) if times is None else np.asarray(times)
    (folder / "series").mkdir(parents=True)
    (folder / "case.toml").write_text(
        CASE.format(spacing=spacing, until=times[-1]) + "".join(BODY.format(name) for name in NAMES)
    )
    (folder / "reference.csv").write_text(REFERENCE)
    indices = {"water": [], "bodies": []}
    for number, time in enumerate(times):
        centre, quaternion = poses(time)
        points, fields = water(spacing, time, centre)
        names = {kind: f"frames/{kind}_{number:06d}.vtkhdf" for kind in indices}
        frames.write_water(folder / names["water"], points, fields, time, number * 100)
        loads = {f"{kind}_load": np.zeros((4, 6)) for kind in ("water", "contact", "gravity")}
        pose = {"position": centre, "quaternion": quaternion, "velocity": 0 * centre, "spin": 0 * centre, **loads}
        frames.write_bodies(folder / names["bodies"], *surfaces(centre, quaternion), pose, time, number * 100)
        for kind, entries in indices.items():
            entries.append((names[kind], float(time)))
            frames.write_index(folder / f"{kind}.vtkhdf.series", entries)
    _series(folder / "series", np.arange(times[0], times[-1] + 1e-9, series))
    _info(folder, len(fields["id"]), len(times))
    return folder


def _table(folder, name, rows, units=None):
    table = Table(folder / f"{name}.csv", units or TABLES[name])
    for row in rows:
        table.row(*row)
    table.close()


def _series(folder, times):
    kinetic = 0.6 * np.exp(-((times - 0.3) ** 2) / 0.1) * (times > 0)
    potential = 2.5 - 1.06 * kinetic - 0.3 * np.clip(times, 0, 1)
    rows = [
        (i, t, 1e-4, k, p, 0.01 * k, 0.05 * k, 0.3, 0.0, 0.001 * k, 0.0, k * 1.06 + p + 0.3)
        for i, (t, k, p) in enumerate(zip(times, kinetic, potential, strict=True))
    ]
    _table(folder, "energy", rows)
    rows = [(i, t, 1000, 1200, 3000, 0, 0, 0, 0, 200, 3.375e-3 * (1 + 0.002 * t), 0) for i, t in enumerate(times)]
    _table(folder, "counts", rows)
    bodies, loads, gauges, front = [], [], [], []
    for i, t in enumerate(times):
        centre, quaternion = poses(t)
        for name, c, q in zip(NAMES, centre, quaternion, strict=True):
            bodies.append((i, t, name, *c, *q, *[0.0] * 6))
            loads += [(i, t, name, kind, 0.1 * t, 0.0, size, 0.0, 0.0, 0.0) for kind, size in LOADS]
        gauges += [(i, t, "wall", 0.69, 0.075, float(height(0.69, t)))]
        front.append((i, t, min(0.15 + 1.35 * max(t, 0), 0.695)))
    for name, rows in (("bodies", bodies), ("loads", loads), ("gauges", gauges), ("front", front)):
        _table(folder, name, rows)
    _table(folder, "timings", [(i, t, 0.01 * i) for i, t in enumerate(times)], {"step": "-", "time": "s", "wall": "s"})


LOADS = (("water", 0.87), ("contact", 0.0), ("gravity", -0.87))


def _info(folder, particles, steps):
    info = {
        "status": "done", "parsim": "0.1.0", "case_name": "dry_four", "ranks": 2, "threads": 1, "kernel": "avx2",
        "host": "bench", "started": "2026-01-01T00:00:00", "wall_s": 100.0, "warnings": ["block B1 is 3 spacings thin"],
        "versions": {"python": "3.11", "numpy": "2.0"}, "steps": steps, "time": 1.25, "lost": 0,
        "particles": {"fluid": particles, "wall": 500, "body": 100, "gate": 10},
        "phases": {"gradient": 40.0, "neighbours": 20.0, "shifting": 25.0, "contacts": 1.0, "output": 2.0},
        "rate": {"particle_steps_per_second_per_core": 1.2e6}, "leaks": {"walls": 0, "bodies": 0, "gate": 0},
    }  # fmt: skip
    (folder / "run.json").write_text(json.dumps(info))
