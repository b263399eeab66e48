"""Put the report together: choose the moments, draw, and write OUT/report."""

import io

from parsim.output.frames import replacing, write_text
from parsim.output.reader import open as open_run
from parsim.report import budgets, plane, plots, tables
from parsim.report.animation import animate, chosen, rate
from parsim.report.page import listing, page, picture, preformatted, section, table
from parsim.report.pictures import Gallery, snapshot, wanted

SNAPSHOTS, PROFILES = (0.4, 0.8, 1.2), (0.41, 0.83)  # s
DOTS = 110


class Folder:
    """OUT/report: every picture is kept there as a file and given to the page."""

    def __init__(self, folder):
        self.folder = folder

    def keep(self, name, suffix, data, alternative, caption):
        """Write one file and return its place in the page."""
        with replacing(self.folder / f"{name}.{suffix}") as part:
            part.write_bytes(data)
        return picture(data, suffix, alternative, caption)

    def figure(self, name, drawn, alternative, caption):
        """Keep a figure as PNG; nothing for None."""
        if drawn is None:
            return ""
        target = io.BytesIO()
        drawn.savefig(target, format="png", dpi=DOTS)
        return self.keep(name, "png", target.getvalue(), alternative, caption)


def moments(times, asked):
    """Frames nearest to the ``asked`` times that the run has reached; the thirds of a shorter run."""
    if not len(times):
        return []
    slack = (times[-1] - times[0]) / max(len(times) - 1, 1) / 2
    reached = [time for time in asked if time <= times[-1] + slack + 1e-9]
    reached = reached or [times[-1] * share for share in (1 / 3, 2 / 3, 1)]
    return sorted({int(abs(times - time).argmin()) for time in reached})


def build(out, vtk=True):
    """Write OUT/report/index.html and the pictures beside it; returns the page's path. ``vtk`` allows pyvista.

    Raises InputError when ``out`` is no output folder, WriteError when the report cannot be written.
    """
    run = open_run(out)
    folder, times = Folder(run.folder / "report"), run.times("water")
    frames, film = moments(times, SNAPSHOTS), chosen(len(times)) if len(times) else []
    gallery = Gallery(run, wanted(run, frames, film), vtk)
    parts = [
        listing(tables.summary(run)),
        section("Here and published", tables.compared(run)),
        section("Pictures", *(_snapshot(folder, run, gallery, frame, times[frame]) for frame in frames)),
        section("Animation", _film(folder, run, gallery, film, times)),
        *_curves(folder, run, moments(times, PROFILES)),
        section("Speed", table(("quantity", "value"), tables.speed(run)), folder.figure(
            "phases", budgets.phases(run), "Bars: seconds in each phase of the solver.",
            "Wall time by phase of the solver, with shares.")),
        section("Warnings", listing(run.info.get("warnings", []), "warnings") or "<p>None.</p>"),
        section("Versions", table(("part", "version"), tables.versions(run, gallery.method))),
        section("The case", preformatted(_case_text(run))),
    ]  # fmt: skip
    path = folder.folder / "index.html"
    write_text(path, page(run.case.get("title", run.folder.name), f"parsim report of {run.folder.name}", parts))
    return path


def _case_text(run):
    path = run.folder / "case.toml"
    return path.read_text(encoding="utf-8") if path.is_file() else ""


def _snapshot(folder, run, gallery, frame, time):
    name, moment = f"snapshot_{frame:06d}", f"t = {time:.3f} s"
    if run.case["dimensions"] == 2:
        return folder.figure(name, plane.snapshot(run, frame), f"Particles coloured by pressure and speed, {moment}.",
                             f"{moment}: pressure and speed of the water, bodies in warm colours.")  # fmt: skip
    return folder.figure(
        name, snapshot(gallery, frame), f"Water, gate and named bodies at {moment}, oblique, front and top view.",
        f"{moment}: from the side and above, from the front (flow to the right), and from above. "
        "Look at where the bodies ride on the wave, and the height of the gate (grey).")  # fmt: skip


def _film(folder, run, gallery, frames, times):
    if len(frames) < 2:
        return ""
    data, suffix = animate(run, gallery, frames)
    slower = (len(frames) - 1) / rate(len(frames)) / max(times[frames[-1]] - times[frames[0]], 1e-12)
    span = f"{times[frames[0]]:.2f} to {times[frames[-1]]:.2f} s"
    pace = f"{slower:.1f} times slower than real" if slower >= 1 else f"{1 / slower:.1f} times faster than real"
    return folder.keep("animation", suffix, data, f"Animation of bodies and water from {span}.",
                       f"{span}, {len(frames)} frames, {pace}.")  # fmt: skip


def _curves(folder, run, frames):
    """The sections of curves."""
    profiles = plots.profiles(run, frames) if frames else None
    return [
        section("Trajectories of the bodies", folder.figure(
            "trajectories", plots.trajectories(run), "Curves of x and z of each body's centre over time.",
            "X is the position of a block's centre, not its displacement. Squares with bars: the experiments' spread "
            "at the quoted time; crosses: the published model.")),
        section("Water profile", folder.figure(
            "profiles", profiles, "Surface height along the tank at two times.",
            "Highest connected water across the tank, splash left out, in the frames nearest to the quoted times; "
            "bodies in their places. The line is the free surface and stops where bodies cover it.")),
        section("Front", folder.figure(
            "front", plots.front(run), "Curve of the front's position over time.",
            "Front of the connected water; it has arrived when two spacings from the end wall (black).")),
        section("Energy", folder.figure(
            "energy", budgets.energy(run), "Curves of the parts of the energy over time.",
            "All parts of the energy and their sum; below, what was created: positive is energy from nothing, "
            "negative is dissipation. W is the work done from outside.")),
        section("Volume and particles", folder.figure(
            "volume", budgets.volume(run), "Curves of the water's volume and of misplaced particles.",
            "Volume against its first value; particles found in walls, bodies or gate, and lost: all should stay 0.")),
        section("Gauges", folder.figure(
            "gauges", plots.gauges(run), "Curves of water level at the gauges.",
            "Water level at the gauges; gaps are dry.")),
        section("Loads on the bodies", folder.figure(
            "loads", plots.loads(run), "Curves of forces on each body.",
            "Forces along the flow (fx) and upward (fz), as means over a step.")),
    ]  # fmt: skip
