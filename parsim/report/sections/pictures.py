"""What it looked like: pictures at some times, and a film."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.report import plane
from parsim.report.animation import animate, rate
from parsim.report.page import section
from parsim.report.pictures import snapshot

if TYPE_CHECKING:
    from parsim.report.build import Page


def parts(page: Page) -> str:
    """The pictures at `report.snapshots`, and the film."""
    times = page.run.times("water")
    return "".join(
        (
            section("Pictures", *(_snapshot(page, frame, times[frame]) for frame in page.frames)),
            section("Animation", _film(page, page.film, times)),
        )
    )


def _snapshot(page, frame, time):
    name, moment = f"snapshot_{frame:06d}", f"t = {time:.3f} s"
    if page.run.case["dimensions"] == 2:
        return page.figure(
            name,
            plane.snapshot(page.run, frame),
            f"Particles coloured by pressure and speed, {moment}.",
            f"{moment}: pressure and speed of the water, bodies in warm colours.",
        )
    return page.figure(
        name,
        snapshot(page.gallery, frame),
        f"Water, gate and named bodies at {moment}, oblique, front and top view.",
        f"{moment}: from the side and above, from the front, and from above. "
        + "The gate is grey." * bool(page.run.case.get("gate")),
    )


def _film(page, frames, times):
    if len(frames) < 2:
        return ""
    data, suffix = animate(page.run, page.gallery, frames)
    slower = (len(frames) - 1) / rate(len(frames)) / max(times[frames[-1]] - times[frames[0]], 1e-12)
    span = f"{times[frames[0]]:.2f} to {times[frames[-1]]:.2f} s"
    pace = f"{slower:.1f} times slower than real" if slower >= 1 else f"{1 / slower:.1f} times faster than real"
    return page.keep(
        "animation",
        suffix,
        data,
        f"Animation of bodies and water from {span}.",
        f"{span}, {len(frames)} frames, {pace}.",
    )
