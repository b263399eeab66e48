"""Made-up output folders of a river: floes that drift down a channel and stop before three piers, and a block that
goes under a cover. They obey no equation; every measure of them is known."""

import json
from pathlib import Path

import numpy as np
from river_scenes import still, surfaces

from parsim.case.model import parse
from parsim.observe.observers import TABLES
from parsim.output import frames
from parsim.output.series import Table

SPEED, DEPTH, STOP, LANES, ROWS = 0.5, 0.4, 8.7, 5, 12
FLOE, STEP = (0.3, 0.3, 0.16), 0.32
MATERIAL = {"ice": {"young": 1e8, "poisson": 0.3, "friction": 0.3, "restitution": 0.3}}
PLANE = 9.0


def channel(**measure):
    """The case of the first one, 12 by 2 m: three piers at 9 m, five lanes of twelve floes upstream of them."""
    piers = [{"name": f"pier{k}", "shape": {"size": [0.2, 0.2, 0.8]}, "density": 2000.0, "material": "ice",
              "position": [9.0, 0.4 + 0.6 * k, 0.4], "fixed": True} for k in range(3)]  # fmt: skip
    floes = [{"name": f"floe{k}_{lane}", "shape": {"size": FLOE}, "density": 900.0, "material": "ice",
              "position": [*start(k, lane), 0.36]} for lane in range(LANES) for k in range(ROWS)]  # fmt: skip
    return parse({
        "title": "Floes at three piers", "dimensions": 3, "spacing": 0.1,
        "box": {"max": [12.0, 2.0, 0.8], "faces": {"x_min": "periodic", "x_max": "periodic"}},
        "water": {"speed": 5.0, "fill": [{"min": [0.0, 0.0, 0.0], "max": [12.0, 2.0, DEPTH]}]},
        "materials": MATERIAL, "bodies": piers + floes, "run": {"until": 60.0},
        "output": {"sensors": [{"kind": "load", "name": "piers"}]},
        "report": {"profiles": [20.0, 60.0]},
        "measure": {"control": {"piers": PLANE}, "jam": {"control": "piers", "reach": [4.7, 8.7]},
                    "head_loss": [2.0, 10.5], "reach": [4.0, 9.0]} | measure,
    })  # fmt: skip


def start(k, lane):
    return 7.4 - 0.6 * k, 0.3 + 0.35 * lane


def places(time):
    """Centres (60, 3) and speeds (60,) of the floes: two layers of them before 8.7 m but for one lane's first floe."""
    found, speeds = [], []
    for lane in range(LANES):
        for k in range(ROWS):
            x, y = start(k, lane)
            there = 1e9 if k == 0 and lane == 2 else STOP - 0.15 - STEP * (k // 2)
            found.append((min(x + SPEED * time, there), y, 0.19 if k % 2 else 0.36))
            speeds.append(SPEED * (x + SPEED * time < there))
    return np.array(found), np.array(speeds)


def write(folder, case, moments, rows, pose, water, first=1):
    """A whole folder: frames at the moments, s, numbered by steps, and rows of bodies at these times, s.

    pose(time): position, quaternion and velocity (nb, 3 or 4) of all bodies; water(time): a frame of it.
    """
    folder = Path(folder)
    (folder / "series").mkdir(parents=True)
    (folder / "case.toml").write_text(case.to_toml())
    entries = {"water": [], "bodies": []}
    for number, time in enumerate(moments, first):
        names = {kind: f"frames/{kind}_{number:06d}.vtkhdf" for kind in entries}
        frame = water(time)
        points, count = frame.pop("position"), len(frame["class"])
        fields = {"id": np.arange(count), **frame, "density_ratio": np.ones(count)}
        frames.write_water(folder / names["water"], points, fields, time, number)
        entries["water"].append((names["water"], float(time)))
        if not case.bodies:
            continue
        place, quaternion, velocity = pose(time)
        place[:, 0] %= case.box.max[0]  # what is seen is in the box; in the series it goes on
        turned = [(body.shape, at, q) for body, at, q in zip(case.bodies, place, quaternion, strict=True)]
        fields = {"position": place, "quaternion": quaternion, "velocity": velocity, "spin": 0.0 * velocity}
        frames.write_bodies(folder / names["bodies"], *surfaces(*turned), fields, time, number)
        entries["bodies"].append((names["bodies"], float(time)))
    for kind, each in entries.items():
        if each:
            frames.write_index(folder / f"{kind}.vtkhdf.series", each)
    table = Table(folder / "series" / "bodies.csv", TABLES["bodies"])
    for step, time in enumerate(rows):
        for body, *values in zip(case.bodies, *pose(time), strict=True):
            table.row(step, float(time), body.name, *map(float, np.concatenate(values)), 0.0, 0.0, 0.0)
    table.close()
    (folder / "run.json").write_text(json.dumps({"status": "done", "case_name": "river"}))
    return folder


def make(folder, **measure):
    """The channel after 60 s: floes stand from about 20 s on, and the level upstream is 0.02 m higher from 30 s on."""
    case = channel(**measure)

    def pose(time):
        place, speed = places(time)
        piers = [body.position for body in case.bodies[:3]]
        velocity = np.zeros((len(case.bodies), 3))
        velocity[3:, 0] = speed
        return np.concatenate([piers, place]), np.tile([1.0, 0.0, 0.0, 0.0], (len(case.bodies), 1)), velocity

    def water(time):
        frame = still(0.1, (0.0, 0.0, 0.0), (12.0, 2.0, DEPTH), speed=SPEED)
        frame["pressure"] += 9810.0 * 0.02 * (time > 30.0) * (frame["position"][:, 0] < PLANE)
        return frame

    write(folder, case, np.arange(0.0, 60.5, 2.0), np.arange(0.0, 60.1, 0.5), pose, water)
    _peaks(Path(folder), np.arange(0.5, 60.1, 0.5))
    return Path(folder)


def _peaks(folder, times):
    """Water pushes steadily, and ice once, by 800 N in 5 ms of the row at 20 s."""
    table = Table(folder / "series" / "peaks.csv", TABLES["peaks"])
    for step, time in enumerate(times):
        for k in range(3):
            for kind in ("water", "contact"):
                steady = [10.0 * (k + 1), 0.0, 0.0, 0.0, 2.0, 0.0] if kind == "water" else [0.0] * 6
                impulse, most = 0.5 * np.array(steady), np.array(steady)
                if kind == "contact" and time == 20.0:
                    impulse[0], most[0] = 800.0 * 0.005, 800.0
                every = [*impulse / 0.5, *steady, *most, *impulse]
                table.row(step, float(time), "piers", f"pier{k}", kind, 0.5, *map(float, every))
    table.close()


def make_cover(folder):
    """A plane in which a block drifts to a cover at 2 m and turns over under it."""
    block = {"name": "block", "shape": {"size": [0.4, 1.0, 0.1]}, "density": 900.0, "material": "ice",
             "position": [0.6, 0.5, 0.35]}  # fmt: skip
    lid = {"name": "lid", "shape": {"size": [1.0, 1.0, 0.1]}, "density": 900.0, "material": "ice",
           "position": [2.5, 0.5, 0.37], "fixed": True}  # fmt: skip
    case = parse({
        "title": "A block at a cover", "dimensions": 2, "spacing": 0.05, "box": {"max": [4.0, 1.0, 0.8]},
        "water": {"speed": 5.0, "fill": [{"min": [0.0, 0.0, 0.0], "max": [4.0, 1.0, DEPTH]}]},
        "materials": MATERIAL, "bodies": [lid, block], "run": {"until": 8.0}, "measure": {"cover": "lid"},
    })  # fmt: skip

    def pose(time):
        x, half = min(0.6 + 0.3 * time, 2.4), np.radians(np.clip(time - 4.0, 0.0, 1.0) * 120.0) / 2.0
        turn = [np.cos(half), 0.0, np.sin(half), 0.0]
        place = [[2.5, 0.5, 0.37], [x, 0.5, 0.35 if time < 4.0 else 0.2]]
        return np.array(place), np.array([[1.0, 0.0, 0.0, 0.0], turn]), np.array([[0.0] * 3, [0.3, 0.0, 0.0]])

    def water(time):
        frame = still(0.05, (0.0, 0.0, 0.0), (4.0, 1.0, DEPTH), speed=SPEED)
        row = np.abs(frame["position"][:, 1] - 0.525) < 0.01
        return {name: values[row] for name, values in frame.items()}

    return write(folder, case, np.arange(0.0, 8.1, 1.0), np.arange(0.0, 8.1, 0.1), pose, water)


PIER = {"name": "pier", "shape": {"size": [0.2, 0.2, 0.8]}, "density": 2000.0, "material": "ice",
        "position": [3.0, 0.5, 0.4], "fixed": True}  # fmt: skip
ICE = {"name": "floe", "shape": {"size": FLOE}, "density": 900.0, "material": "ice", "position": [1.0, 0.5, 0.36]}


def make_odd(folder, moments, rows, bodies=(PIER, ICE), speed=SPEED, drift=SPEED, first=1, **changes):
    """A channel of 4 by 1 m whose free bodies drift from where they are at 0 s on, as other cases want it."""
    case = parse({
        "title": "An odd river", "dimensions": 3, "spacing": 0.1, "materials": MATERIAL, "bodies": [*bodies],
        "box": {"max": [4.0, 1.0, 0.8], "faces": {"x_min": "periodic", "x_max": "periodic"}},
        "water": {"speed": 5.0, "fill": [{"min": [0.0, 0.0, 0.0], "max": [4.0, 1.0, DEPTH]}]},
        "run": {"until": 60.0}, "measure": {},
    } | changes)  # fmt: skip

    def pose(time):
        place = np.array([body.position for body in case.bodies])
        velocity = np.array([[0.0 if body.fixed else drift, 0.0, 0.0] for body in case.bodies])
        return place + velocity * time, np.tile([1.0, 0.0, 0.0, 0.0], (len(place), 1)), velocity

    def water(_):
        return still(0.1, (0.0, 0.0, 0.0), (4.0, 1.0, DEPTH), speed=speed)

    return write(folder, case, moments, rows, pose, water, first)


def series(folder, name, rows):
    """One more series, rows of values after step and time; or other ones in place of those there are."""
    table = Table(folder / "series" / f"{name}.csv", TABLES[name])
    for row in rows:
        table.row(*row)
    table.close()
