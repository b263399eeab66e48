"""SPH-ALE in whole cases: water at rest, what is conserved, bodies, the same bits on any ranks, and what it refuses."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import parsim
from parsim.__main__ import main
from parsim.case.model import parse
from parsim.domain.comm import Comm
from parsim.errors import InputError
from parsim.run.simulation import Simulation

BITS = Path(__file__).with_name("same_bits_sphale.toml")
TANK = {
    "dimensions": 2,
    "spacing": 0.01,
    "box": {"max": [0.1, 1.0, 0.2]},
    "run": {"until": 1.0},
    "water": {"scheme": {"kind": "sphale"}, "fill": [{"min": [0.0, 0.0, 0.0], "max": [0.1, 1.0, 0.1]}]},
}
WOOD = {"wood": {"young": 1e9, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}}


def simulation(data, steps=0):
    """A case as a nested dict after so many steps on one rank."""
    case = parse(data)
    s = Simulation(case, Comm(case.box.faces.x_min.repeats))
    for _ in range(steps):
        s.step()
    return s


def amounts(s):
    """Mass and momentum (4,) of the water."""
    p, at = s.domain.particles, s.near.fluid
    return np.stack([p.m, p.m * p.u, p.m * p.v, p.m * p.w])[:, at].sum(axis=1)


def test_water_at_rest_stays_so():
    s = simulation(TANK, 400)
    p, at = s.domain.particles, s.near.fluid
    low = at[p.z[at] < s.case.spacing]
    assert s.speed < 2e-3
    assert p.p[low] == pytest.approx(9810.0 * (0.1 - p.z[low]), rel=0.01)
    assert p.omega[at] == pytest.approx(1e-4, rel=0.02)
    assert p.z[at].max() == pytest.approx(0.095, abs=2e-4)


def test_water_between_periodic_sides_keeps_mass_and_momentum():
    faces = {f"{a}_{s}": "periodic" for a in "xz" for s in ("min", "max")}
    fill = {"min": [0.0, 0.0, 0.0], "max": [0.1, 1.0, 0.2], "velocity": [0.5, 0.0, 0.2]}
    water = {**TANK["water"], "fill": [fill], "speed": 1.0, "disorder": 0.2}
    s = simulation(TANK | {"gravity": [0.0, 0.0, 0.0], "box": TANK["box"] | {"faces": faces}, "water": water})
    p, before = s.domain.particles, amounts(s)
    p.u[s.near.fluid] += 0.1 * np.sin(60.0 * p.z[s.near.fluid])
    s.domain.refresh("u")
    moved = amounts(s)
    for _ in range(60):
        s.step()
    after = amounts(s)
    assert after[0] == pytest.approx(before[0], rel=1e-13)
    assert after[1:] == pytest.approx(moved[1:], abs=1e-11 * before[0])


@pytest.mark.parametrize("density", [100.0, 500.0])
def test_a_body_afloat_stays_where_it_is(density):
    box = {"name": "box", "shape": {"size": [0.1, 1.0, 0.06]}, "density": density, "material": "wood",
           "position": [0.15, 0.5, "float"]}  # fmt: skip
    fill = {"min": [0.0, 0.0, 0.0], "max": [0.3, 1.0, 0.1]}
    data = TANK | {"box": {"max": [0.3, 1.0, 0.2]}, "materials": WOOD, "bodies": [box]}
    s = simulation(data | {"water": TANK["water"] | {"fill": [fill]}})
    first = s.bodies.position[0].copy()
    for _ in range(500):
        s.step()
    assert abs(s.bodies.position[0] - first).max() < 0.4 * s.case.spacing
    assert abs(s.bodies.velocity[0]).max() < 0.1


@pytest.fixture(scope="module")
def one_rank(tmp_path_factory):
    """The output of the case on one rank."""
    out = tmp_path_factory.mktemp("sphale") / "one"
    # a process of its own, as for every run: see parsim/run/warm.py
    subprocess.run([sys.executable, "-m", "parsim", "run", BITS, "-o", out], check=True)
    return out


def test_the_case_does_what_the_comparison_needs(one_rank):
    run = parsim.open(one_rank)
    counts = run.series("counts")
    assert run.info["steps"] > 40 and run.info["rebuilds"] > 4
    assert run.series("energy")["dissipated_contacts"][-1] > 1e-5, "nothing has touched"
    assert max(counts["lost"]) == 0


@pytest.mark.long
def test_same_bits_on_three_ranks(one_rank, mpirun, tmp_path, capsys):
    assert mpirun(3, ["run", BITS, "-o", tmp_path / "other"], timeout=240).returncode == 0
    assert main(["compare", str(one_rank), str(tmp_path / "other")]) == 0, capsys.readouterr().out


def test_same_bits_on_two_ranks_and_over_a_restart(one_rank, mpirun, tmp_path, capsys):
    assert mpirun(2, ["run", BITS, "-o", tmp_path / "out", "--until", "0.016"], timeout=240).returncode == 0
    assert mpirun(1, ["resume", tmp_path / "out", "--until", "0.03"], timeout=240).returncode == 0
    assert main(["compare", str(one_rank), str(tmp_path / "out")]) == 0, capsys.readouterr().out


REFUSED = {
    "friction": ({"water": {"friction": {"kind": "no_slip"}}}, "water.friction: is not in"),
    "eddies": ({"water": {"eddies": {"kind": "mixing_length"}}}, "water.eddies: is not in"),
    "motion": ({"motion": {"kind": "sway", "amplitude": 0.01, "period": 1.0}}, "motion: is not in"),
    "inlet": ({"box": {"faces": {"x_min": {"kind": "inlet", "discharge": 0.01}}}}, 'box.faces.x_min = "inlet": is not'),
    "outlet": ({"box": {"faces": {"x_max": {"kind": "outlet"}}}}, 'box.faces.x_max = "outlet": is not in'),
    "side": ({"box": {"faces": {"z_min": {"kind": "wall", "velocity": [0.1, 0.0, 0.0]}}}}, "z_min.velocity: is not in"),
    "channel": ({"channel": {"discharge": 0.01}}, "channel: is not in"),
    "light body": (
        {
            "materials": WOOD,
            "bodies": [
                {
                    "name": "box",
                    "shape": {"size": [0.05, 1.0, 0.03]},
                    "density": 190.0,
                    "material": "wood",
                    "position": [0.05, 0.5, "float"],
                }
            ],
        },
        "bodies.box: density 190 kg/m3 times its thinnest side, 0.03 m: must be at least 6 kg/m2",
    ),
    "step": ({"run": {"cfl": 1.2}}, "run.cfl = 1.2: must be at most 1.0"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_the_scheme_does_not_know_is_refused_by_name(name):
    changes, words = REFUSED[name]
    data = TANK | {key: TANK[key] | value if key in TANK else value for key, value in changes.items()}
    with pytest.raises(InputError) as refusal:
        parse(data)
    assert words in str(refusal.value) and 'water.scheme.kind = "sphale"' in str(refusal.value)
