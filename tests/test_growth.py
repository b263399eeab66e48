"""A long run takes no more memory than a short one, and makes no energy."""

from pathlib import Path

import pytest
from test_water import POOL, simulation

from parsim.output.measure import Measure

LONG = 100_000


def resident():
    """Resident memory of this process, bytes."""
    return 4096 * int(Path("/proc/self/statm").read_text().split()[1])


@pytest.mark.slow
def test_memory_does_not_grow_over_many_steps():
    fill = [{"min": [0.0, 0.0, 0.0], "max": [0.2, 1.0, 0.12], "velocity": [0.5, 0.0, 0.0]}]
    body = {"name": "block", "shape": {"size": [0.06, 1.0, 0.03]}, "density": 700.0, "material": "wood",
            "position": [0.1, 0.5, "float"]}
    s = simulation(POOL | {"spacing": 0.02, "water": {"fill": fill}, "bodies": [body], "run": {"until": 1e3}})
    count, marks, measure = s.near.fluid.size, [], Measure(s.case, s)
    energy = [measure.rows(s)["energy"][0][-1]]
    for step in range(LONG):
        s.step()
        if step % (LONG // 10) == LONG // 10 - 1:
            marks.append(resident())
            energy.append(measure.rows(s)["energy"][0][-1])
    print(f"total energy, J: {[round(total, 3) for total in energy]}")
    print(f"resident, MB: {[round(mark / 1e6, 1) for mark in marks]}")
    assert s.near.fluid.size == count and s.domain.lost == 0
    assert max(energy) <= energy[0]  # nothing drives it
    assert marks[-1] - marks[1] < 1e6
