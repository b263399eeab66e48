"""What a case may be but should not: gauges that see no water, fills that are not what their numbers say."""

import math

import numpy as np
import pytest
from example_cases import ROOT
from test_water import TANK

from parsim.case.fill import level_over, water_at
from parsim.case.model import load, parse

CLOSED = TANK | {"box": {"max": [0.4, 1.0, 0.4]}}


def fills(*boxes, **more):
    """A tank with fills from and to these x and z, m: tuples of four."""
    fill = [{"min": [x0, 0.0, z0], "max": [x1, 1.0, z1], **more} for x0, x1, z0, z1 in boxes]
    return CLOSED | {"water": {"fill": fill}}


def told(case):
    """The warnings of a case as one text."""
    return "\n".join(parse(case).warnings())


def floes(gap, x=0.2, level=0.3):
    """Two floes with a gap of this width about x = 0.2 m and a gauge at x."""
    body = {"shape": {"size": [0.1, 1.0, 0.06]}, "density": 600.0, "material": "wood"}
    places = (0.15 - gap / 2, 0.25 + gap / 2)
    bodies = [body | {"name": f"b{i}", "position": [place, 0.5, "float"]} for i, place in enumerate(places)]
    return fills((0.0, 0.4, 0.0, level)) | {"bodies": bodies, "output": {"sensors": [{"name": "here", "x": x}]}}


@pytest.mark.parametrize(("gap", "x", "blocked"), [
    (0.0, 0.2, True), (0.0016, 0.2, True), (0.0099, 0.2, True), (0.01, 0.2, False), (0.03, 0.2, False),
    (0.0016, 0.15, True), (0.0016, 0.09, False), (0.0016, 0.11, True), (0.0016, 0.005, False),
])  # fmt: skip
def test_a_gauge_needs_a_gap_of_a_spacing_within_its_reach(gap, x, blocked):
    assert ("output.sensors.here: " in told(floes(gap, x))) is blocked


def test_a_gauge_between_a_body_and_a_wall_or_on_dry_ground():
    body = {
        "name": "b",
        "shape": {"size": [0.391, 1.0, 0.06]},
        "density": 600.0,
        "material": "wood",
        "position": [0.1955, 0.5, "float"],
    }
    case = fills((0.0, 0.4, 0.0, 0.3)) | {"output": {"sensors": [{"name": "here", "x": 0.396}]}}
    assert "sensors.here: stands at or between" in told(case | {"bodies": [body]})
    assert "sensors" not in told(case | {"bodies": [body | {"position": [0.1955, 0.5, 0.2]}]}), "under water"
    dry = floes(0.0) | {"water": {"fill": fills((0.0, 0.1, 0.0, 0.3))["water"]["fill"]}}
    dry["bodies"] = [b | {"position": [*b["position"][:2], 0.35]} for b in dry["bodies"]]
    assert "sensors" not in told(dry), "no water there"


@pytest.mark.parametrize("name", ["4_blocks_dry", "9_blocks_50mm"])
def test_blocks_on_a_reservoir_leave_a_gauge_no_room(name):
    path = ROOT / "cases" / "ice_release" / f"{name}.toml"
    for x in (0.075, 0.005, 0.145):
        change = f'output.sensors=[{{name="reservoir", x={x}}}]'
        assert "output.sensors.reservoir: " in "".join(load(path, [change]).warnings())


def test_a_gauge_reads_a_narrow_gap_at_a_fine_spacing():
    path = ROOT / "cases" / "ice_release" / "4_blocks_dry.toml"
    change = 'output.sensors=[{name="reservoir", x=0.075}]'  # gaps of 5/3 mm cross there
    said = {spacing: load(path, [change, f"spacing={spacing}"]).warnings() for spacing in (0.0025, 0.001)}
    assert "sensors" in "".join(said[0.0025]) and said[0.001] == []


def test_touching_fills_are_one_water():
    three = parse(fills((0.0, 0.4, 0.0, 0.15), (0.0, 0.4, 0.15, 0.17), (0.0, 0.2, 0.17, 0.3))).water.fill
    assert water_at(three, 0.1, 0.5) == (0.0, 0.3) and water_at(three, 0.3, 0.5) == (0.0, 0.17)
    x, y = np.array([0.1, 0.3]), np.array([0.5, 0.5])
    assert level_over(three, three[0], x, y).tolist() == [0.3, 0.17]
    assert level_over(three[::-1], three[1], x, y).tolist() == [0.3, 0.17]
    apart = parse(fills((0.0, 0.4, 0.0, 0.1), (0.0, 0.4, 0.2, 0.3))).water.fill
    assert water_at(apart, 0.1, 0.5) == (0.2, 0.3) and level_over(apart, apart[0], x, y).tolist() == [0.1, 0.1]
    assert water_at(three, 0.5, 0.5) is None


def test_a_body_floats_in_stacked_fills_as_in_one():
    body = {
        "name": "a",
        "shape": {"size": [0.1, 1.0, 0.06]},
        "density": 800.0,
        "material": "wood",
        "position": [0.2, 0.5, "float"],
    }
    one = parse(fills((0.0, 0.4, 0.0, 0.17)) | {"bodies": [body]})
    two = parse(fills((0.0, 0.4, 0.0, 0.15), (0.0, 0.4, 0.15, 0.17)) | {"bodies": [body]})
    assert two.bodies == one.bodies and two.depth == one.depth
    assert one.bodies[0].position[2] == pytest.approx(0.17 - 0.8 * 0.06 + 0.03)


@pytest.mark.parametrize(("box", "words"), [
    ((0.0, 0.4, 0.0, 0.025), "0.01 m3 of water asked for, 0.008 m3 placed (-20.0%): spacing = 0.01 does not"),
    ((0.0, 0.245, 0.0, 0.1), "0.0245 m3 of water asked for, 0.024 m3 placed (-2.0%)"),
    ((0.0, 0.4, 0.0, 0.1), None), ((0.0, 0.4, 0.0, 0.3001), None),
])  # fmt: skip
def test_water_that_is_not_the_amount_asked_for_is_told_with_both_numbers(box, words):
    said = told(fills(box))
    assert words in said if words else "asked for" not in said


@pytest.mark.parametrize(("low", "high", "words"), [
    (0.2, 0.21, None), (0.202, 0.208, "0.0394 m3 of water asked for, 0.039 m3 placed (-1.0%)"),
    (0.206, 0.214, "0.0392 m3 of water asked for, 0.04 m3 placed (+2.0%)"),
])  # fmt: skip
def test_water_in_the_place_of_the_gate_is_not_asked_for(low, high, words):
    said = told(fills((0.0, 0.4, 0.0, 0.1)) | {"gate": {"min_x": low, "max_x": high}})
    assert words in said if words else "asked for" not in said


def test_a_table_whose_mean_is_not_one_is_told():
    table = {"kind": "table", "heights": [0.0, 0.2], "shares": [1.0, 1.5]}
    assert "profile.shares: their mean over the depth is 1.25" in told(
        fills((0.0, 0.4, 0.0, 0.2), velocity=[0.1, 0.0, 0.0], profile=table)
    )
    table["shares"] = [0.5, 1.5]
    assert told(fills((0.0, 0.4, 0.0, 0.2), velocity=[0.1, 0.0, 0.0], profile=table)) == ""


def test_a_profile_of_water_at_rest_is_told():
    assert "water.fill.0.profile: has no effect" in told(fills((0.0, 0.4, 0.0, 0.2), profile={"kind": "linear"}))


@pytest.mark.parametrize(("support", "doubtful"), [(2.1, True), (2.59, True), (2.6, False), (4.0, False)])
def test_a_support_with_which_water_boils_is_told(support, doubtful):
    case = fills((0.0, 0.4, 0.0, 0.2))
    case["water"] |= {"scheme": {"support": support}}
    assert (f"water.scheme.support = {support}: too small" in told(case)) is doubtful


@pytest.mark.parametrize(("share", "doubtful"), [(0.99, False), (1.01, True)])
def test_water_faster_than_expected_is_told(share, doubtful):
    expected = 2.0 * math.sqrt(9.81 * 0.2)
    case = fills((0.0, 0.4, 0.0, 0.2), velocity=[0.0, 0.0, -share * expected])
    assert ("more than the largest expected speed, 2.801 m/s" in told(case)) is doubtful


@pytest.mark.parametrize(("boxes", "thin"), [
    ([(0.0, 0.4, 0.0, 0.03)], "water.fill.0: 3 particles along z, 0.03 m"), ([(0.0, 0.4, 0.0, 0.04)], None),
    ([(0.0, 0.4, 0.0, 0.03), (0.0, 0.2, 0.03, 0.06)], None),
    ([(0.0, 0.4, 0.0, 0.03), (0.0, 0.4, 0.05, 0.2)], "water.fill.0: 3 particles along z"),
    ([(0.1, 0.12, 0.0, 0.2)], "water.fill.0: 2 particles along x, 0.02 m"),
])  # fmt: skip
def test_water_thinner_than_the_support_is_told(boxes, thin):
    said = told(fills(*boxes))
    assert thin in said if thin else "particles along" not in said


@pytest.mark.parametrize(("z", "fixed", "words"), [
    (0.07, True, "bodies.b0: leaves a passage of 0.02 m, 2 spacings, to box.faces.z_min"), (0.08, True, None),
    (0.05, True, None), (0.07, False, None),
])  # fmt: skip
def test_a_narrow_passage_under_a_fixed_body_is_told(z, fixed, words):
    body = {
        "name": "b0",
        "shape": {"size": [0.1, 1.0, 0.1]},
        "density": 600.0,
        "material": "wood",
        "position": [0.2, 0.5, z],
        "fixed": fixed,
    }
    said = told(fills((0.0, 0.4, 0.0, 0.3)) | {"bodies": [body]})
    assert words in said if words else "passage" not in said


@pytest.mark.parametrize(("gap", "words"), [
    (0.025, "bodies.b0: leaves a passage of 0.025 m, 2.5 spacings, to bodies.b1"), (0.03, None), (0.0, None),
])  # fmt: skip
def test_a_narrow_passage_between_fixed_bodies_is_told(gap, words):
    case = floes(gap)
    case["bodies"] = [body | {"fixed": True} for body in case["bodies"]]
    said = told(case)
    assert words in said if words else "passage" not in said


def test_smooth_walls_do_not_rub_water_without_viscosity():
    case = fills((0.0, 0.4, 0.0, 0.3))
    case["water"] |= {"friction": {"kind": "wall_law"}, "viscosity": 0.0}
    assert "what is smooth rubs such water with no stress at all" in told(case)
    case["water"] |= {"friction": {"kind": "wall_law", "roughness": 0.001}}
    assert "no stress" not in told(case)


def test_bodies_that_are_longer_than_the_period_are_doubted():
    """Together: of two images of one of them that touch the other, contacts know the nearer."""
    ice = {"young": 1e9, "poisson": 0.3, "friction": 0.1, "restitution": 0.3}
    boom = {"name": "boom", "shape": {"size": [0.8, 0.1, 0.1]}, "density": 900.0, "material": "ice",
            "position": [0.5, 0.2, 0.15]}  # fmt: skip
    floe = boom | {"name": "floe", "shape": {"size": [0.3, 0.1, 0.1]}, "position": [0.5, 0.2, 0.3]}
    case = {"dimensions": 3, "materials": {"ice": ice}, "bodies": [boom, floe], "run": {"until": 1.0},
            "box": {"max": [1.0, 0.4, 0.4], "faces": {"x_min": "periodic", "x_max": "periodic"}}}  # fmt: skip
    assert "bodies.boom: with bodies.floe 1.1 m long, more than the 1 m after which x repeats" in told(case)
    floe["shape"] = {"size": [0.19, 0.1, 0.1]}
    assert "repeats" not in told(case)
