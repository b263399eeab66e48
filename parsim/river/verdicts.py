"""What a measured run comes to: whether its ice has jammed, what became of blocks at a cover, which bodies touch."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from parsim.geometry.rotation import matrices
from parsim.river import ice, profiles
from parsim.river.arches import neighbours, outline
from parsim.river.blocks import Block, Cover, Path, block, tilts, ups
from parsim.river.jam import Jam, extent, jam, kind
from parsim.river.planes import mean_speed

if TYPE_CHECKING:
    from parsim.river.reader import River

_LEAST = 0.5  # of the ice that the supply has in the reach while it drifts, without which nothing has jammed
_NEAR = 0.5  # spacings between footprints that count as neighbours, and over the bed on which a floe has grounded


class Verdict(NamedTuple):
    """A jam, or None; where it stands, head and toe, m, NaN where no frame shows it; how many floes lie over each other
    where there are any, and its kind, "none" without a jam, "unknown" if the run is shorter than the window; what it
    was judged by: supply of ice, m3/s, speed of the water, m/s, window, s."""

    jam: Jam | None
    head: float
    toe: float
    layers: float
    kind: str
    supply: float
    water: float
    window: float


def verdict(river: River) -> Verdict | None:
    """Whether ice has jammed; None where the case does not ask, or has no ice."""
    sought, at = river.measure.jam, river.loose
    if sought is None or not at.any() or not len(river.tracks.time):
        return None
    tracks, reach, plane = river.tracks, sought.reach, river.measure.control[sought.control]
    supply = sought.supply or _supply(river, reach)
    speed = mean_speed(tracks.home[:, at], tracks.speed[:, at], river.volume[at], reach)
    # floes left behind once the ice has gone are no jam
    enough = river.stored(reach) * river.drift >= _LEAST * supply * (reach[1] - reach[0])
    speed = np.where(enough, speed, np.nan)
    wait = river.wait
    by = supply, river.drift, wait
    found = jam(tracks.time, river.passed(plane), speed, supply, river.drift, wait)
    if found is None:
        known = tracks.time[-1] - tracks.time[0] >= wait
        return Verdict(None, np.nan, np.nan, np.nan, "none" if known else "unknown", *by)
    fields, x, end = river.fields, river.columns.x, found.begin + wait
    moves, solid, cover = (
        profiles.mean_between(fields.time, of, found.begin, end)
        for of in (fields.speed, fields.solid, fields.concentration)
    )
    head, toe = extent(x, profiles.across(moves).mean, river.drift, plane, river.length)
    there = (x >= head) & (x <= toe)
    layers = float(ice.layers(solid[there].sum() / cover[there].sum(), river.floe)) if there.any() else np.nan
    grounded = on_the_bed(river, river.run.nearest(end, "bodies"), (head, toe)).any()
    return Verdict(found, head, toe, layers, kind(layers, bool(grounded)), *by)


def _supply(river, reach):
    """Ice that drifts down a reach where nothing holds it, m3/s: the most that has come into it over the time that
    makes a jam, or, where that is more, what is in it at the start at the speed of the water."""
    time, came = river.tracks.time, river.passed(reach[0])
    wait = min(river.wait, float(time[-1] - time[0]))
    begin = time[time + wait <= time[-1] * (1.0 + 1e-9)]
    most = (np.interp(begin + wait, time, came) - came[: len(begin)]).max() / wait if wait > 0.0 else 0.0
    return max(float(most), float(river.stored(reach)[0] / (reach[1] - reach[0]) * river.drift))


def on_the_bed(river: River, frame: int, reach: tuple[float, float]) -> np.ndarray:
    """Which floes (nb,) with their centre in a reach, m, have a corner within half a spacing of the bed."""
    bodies = river.run.bodies(frame)
    corners, body = bodies["points"][bodies["quads"].ravel()], np.repeat(bodies["body"], 4)
    near, x = np.zeros(len(river.loose), bool), bodies["position"][:, 0]
    near[body[corners[:, 2] - river.floor(*corners[:, :2].T) <= _NEAR * river.case.spacing]] = True
    return near & (x >= reach[0]) & (x <= reach[1]) & river.loose


def blocks(river: River) -> dict[str, Block]:
    """What became of every block by its name; none where the case names no cover."""
    if river.measure.cover is None or not len(river.tracks.time):
        return {}
    names, tracks, found = river.run.body_names, river.tracks, {}
    lid = names.index(river.measure.cover)
    cover, right_left = (
        [at[0, lid] + end for end in _ends(river, lid, 0, axis)] for axis, at in enumerate((tracks.x, tracks.y))
    )
    for k in np.flatnonzero(river.loose).tolist():
        tilt, length = np.full(len(tracks.time), np.nan), np.nan
        there = np.flatnonzero(np.isfinite(tracks.x[:, k]))
        if len(there):
            tilt[there] = tilts(ups(tracks.quaternion[there, k]))
            low, high = _ends(river, k, there[0], 0)
            length = high - low
        y, below = tracks.y[:, k], tracks.z[:, k] < tracks.z[0, lid]
        path = Path(tracks.time, tracks.x[:, k], tilt, below & (right_left[0] <= y) & (y <= right_left[1]))
        found[names[k]] = block(path, length, Cover(*cover), river.drift)
    return found


def _ends(river, body, row, axis):
    """Where a body begins and ends along x, y or z, 0 to 2, from its centre in a row of the tracks, m."""
    (turn,) = matrices(river.tracks.quaternion[row, body].copy()[None])
    shape = river.case.bodies[body].shape
    return -float(shape.reach(-turn[axis])), float(shape.reach(turn[axis]))


def outlines(river: River, frame: int) -> dict[int, np.ndarray]:
    """Convex outlines (k, 2), m, on the plan of the bodies that are there in a frame but for the bed, by number."""
    bodies = river.run.bodies(frame)
    return {
        int(k): outline(bodies["points"][np.unique(bodies["quads"][bodies["body"] == k]), :2])
        for k in np.unique(bodies["body"])
        if not river.ground[k]
    }


def pairs(river: River, frame: int) -> list[tuple[int, int]]:
    """Numbers of floes and piers whose outlines are at most half a spacing apart in a frame; none of a 2D run."""
    if river.planar:
        return []
    piers = set(river.piers)
    around = {k: corners for k, corners in outlines(river, frame).items() if river.loose[k] or k in piers}
    keys, near = [*around], neighbours([*around.values()], _NEAR * river.case.spacing, river.period)
    found = [(keys[one], keys[other]) for one, other in near]
    return [pair for pair in found if not piers.issuperset(pair)]
