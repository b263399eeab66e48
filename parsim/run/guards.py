"""What ends a run that has gone wrong: what happened, which particles or body, where, and what may help."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from parsim.errors import RunError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from parsim.run.simulation import Simulation

_SHOWN = 5  # particles in a message
_COLLAPSED = 1e-3  # of the longest time step
_EARLY = 20  # steps in which the start is to blame
_HARD = 0.1  # of the speed of sound that a contact gives a body in one step


def runaway(simulation: Simulation) -> RunError:
    """The error for water or a body at or over the model's speed of sound, or not a number; asked for on all ranks."""
    s, p, at = simulation, simulation.domain.particles, simulation.near.fluid
    speed = np.sqrt(p.u[at] ** 2 + p.v[at] ** 2 + p.w[at] ** 2)
    bad = at[~(speed < s.scheme.sound)]
    rows = np.stack([p.id[bad], p.x[bad], p.y[bad], p.z[bad], p.u[bad], p.v[bad], p.w[bad]], 1).astype(float)
    rows = np.concatenate([np.zeros((0, 7)), *s.comm.stream(rows)])
    rows = rows[np.argsort(rows[:, 0])]
    bodies = s.bodies.at_fault(s.scheme.sound)
    told = [f"body {name}" for name in bodies[:_SHOWN]] + [_particle(row) for row in rows[:_SHOWN]]
    more = len(rows) + len(bodies) - len(told)
    text = (
        f"{_when(s)}: faster than the speed of sound of the model, {s.scheme.sound:.4g} m/s, or not a number: "
        + "; ".join(told)
        + (f"; and {more} more" if more > 0 else "")
        + ". "
        + _likely(s)
    )
    return RunError(s.comm.share(text))


def collapsed(simulation: Simulation, dt: float) -> RunError | None:
    """The error for a time step that is too short to go on with, None for one that is not."""
    s = simulation
    if dt > _COLLAPSED * s.scheme.time_step(0.0):
        return None
    text = f"{_when(s)}: the time step has come down to {dt:.3g} s, for "
    if s.contacts.limit() <= dt or s.speed > s.case.speed > 0.0:
        name, speed = s.bodies.fastest()
        text += f"body {name} moves at {speed:.4g} m/s. "
    else:
        text += f"a body is accelerated by {s.bodies.surface_acceleration():.4g} m/s2. "
    return RunError(text + _likely(s))


def outside(simulation: Simulation, rows: Sequence[Sequence[Any]]) -> RunError:
    """The error for what has left the box: rows of step, time, what, id, place, velocity."""
    told = [_particle(row[3:]) if row[2] == "water" else _moving(row[2], row[4:]) for row in rows]
    more = f"; and {len(told) - _SHOWN} more" if len(told) > _SHOWN else ""
    return RunError(
        f"{_when(simulation)}: has left the box: {'; '.join(told[:_SHOWN])}{more}. "
        'With run.outside = "remove" it is counted and taken out'
    )


def _when(simulation):
    return f"step {simulation.step_count}, t = {simulation.time:.6g} s"


def _particle(row):
    return _moving(f"particle {int(row[0])}", row[1:])


def _moving(what, values):
    place, speed = (", ".join(f"{value:.4g}" for value in values[part]) for part in (slice(0, 3), slice(3, 6)))
    return f"{what} at ({place}) m with ({speed}) m/s"


def _likely(simulation):
    """What may be the cause, that which there are signs of first."""
    s, case, b = simulation, simulation.case, simulation.bodies
    speed = f"water.speed = {case.speed:.4g} m/s is less than the water or a body reaches"
    start = "what is there at the start is too close: bodies to each other, to walls or to the water"
    step = f"run.cfl = {case.run.cfl:g} is too large"
    signs = []
    if s.step_count < _EARLY:
        signs.append(start)
    if 0.0 < case.speed < s.speed < s.scheme.sound:
        signs.append(f"{speed}: {s.speed:.4g} m/s in the step before")
    if b.names:
        with np.errstate(invalid="ignore"):  # the run has gone wrong: loads may be no numbers
            kick = np.sqrt((b.contact_load[:, :3] ** 2).sum(1)) / b.mass * s.dt
        if (hit := int(np.argmax(kick))) >= 0 and kick[hit] > _HARD * s.scheme.sound:
            force = math.sqrt((b.contact_load[hit, :3] ** 2).sum())
            signs.append(
                f"body {b.names[hit]} is in a contact of {force:.4g} N: contacts.steps_per_contact = "
                f"{case.contacts.steps_per_contact} is too few, or its material too stiff"
            )
    if case.run.cfl > 1.0:
        signs.append(step)
    possible = (speed, start, step) if case.speed else (start, step)
    others = [text for text in possible if not any(sign.startswith(text) for sign in signs)]
    first = f"Most likely {'; or '.join(signs)}. Else " if signs else "Most likely "
    return f"{first}{'; or '.join(others)}. The frame written now shows the place"
