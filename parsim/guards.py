"""What ends a run that has gone wrong: what happened, which particles or body, where, and what may help."""

import numpy as np

from parsim.errors import RunError

_SHOWN = 5  # particles in a message
_COLLAPSED = 1e-3  # of the longest time step
_HINT = ("The frame written now shows the place. Usual causes: water.speed (here {speed:.3g} m/s) is less than the "
         "water reaches, bodies overlap at the start, or run.cfl is too large")


def runaway(simulation):
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
    text = (f"{_when(s)}: faster than the speed of sound of the model, {s.scheme.sound:.4g} m/s, or not a number: "
            + "; ".join(told) + (f"; and {more} more" if more > 0 else "") + ". " + _hint(s))
    return RunError(s.comm.share(text))


def collapsed(simulation, dt):
    """The error for a time step that is too short to go on with, None for one that is not."""
    s = simulation
    if dt > _COLLAPSED * s.scheme.time_step(0.0):
        return None
    name, speed = s.bodies.fastest()
    return RunError(f"{_when(s)}: the time step has come down to {dt:.3g} s, for body {name} moves at {speed:.4g} m/s. "
                    + _hint(s))


def outside(simulation, rows):
    """The error for water that has left the box; rows (n, 9): step, time, id, place, velocity."""
    rows = rows[:_SHOWN]
    return RunError(f"{_when(simulation)}: water has left the box: {'; '.join(_particle(row[2:]) for row in rows)}. "
                    'With run.outside = "remove" it is counted and taken out')


def _when(simulation):
    return f"step {simulation.step_count}, t = {simulation.time:.6g} s"


def _particle(row):
    place, speed = (", ".join(f"{value:.4g}" for value in row[part]) for part in (slice(1, 4), slice(4, 7)))
    return f"particle {int(row[0])} at ({place}) m with ({speed}) m/s"


def _hint(simulation):
    return _HINT.format(speed=simulation.case.speed)
