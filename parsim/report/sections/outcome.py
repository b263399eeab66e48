"""How the run went, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from parsim.report.measures import wall_time
from parsim.report.page import listing, section

if TYPE_CHECKING:
    from parsim.output.reader import Run
    from parsim.report.build import Page


def parts(page: Page) -> str:
    """Its warnings."""
    return section("Warnings", listing(page.run.info.get("warnings", []), "warnings") or "<p>None.</p>")


def lines(run: Run) -> list[str]:
    """Status, size and time."""
    info = run.info
    told = [f"Status: {info.get('status', 'unknown')}."]
    if error := info.get("error"):
        told.append(f"It ended with: {error}")
    if "steps" in info and "time" in info:
        told.append(
            f"Simulated to {info['time']:.4g} s in {info['steps']} steps: {wall_time(run):.4g} s of "
            f"wall time on {info.get('ranks', '?')} ranks x {info.get('threads', '?')} threads."
        )
    if particles := info.get("particles"):
        told.append("Particles: " + ", ".join(f"{count} {kind}" for kind, count in particles.items()) + ".")
    if info.get("warnings"):
        told.append(f"Warnings: {len(info['warnings'])}.")
    return told
