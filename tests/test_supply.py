"""Supplies of ice: floes come in through the inlet as they float, none is lost or doubled, and a blocked one waits."""

import tomllib

import numpy as np
import pytest
import trimesh
from flows import simulation, tank

from parsim.case import ice
from parsim.case.estimate import estimate
from parsim.case.model import parse
from parsim.errors import InputError
from parsim.observe.counts import Counts
from parsim.observe.ice import Ice

SUPPLY = {
    "name": "drift",
    "concentration": 0.9,
    "size": {"kind": "uniform", "min": 0.06, "max": 0.1},
    "thickness": 0.04,
    "density": 900.0,
    "material": "ice",
    "seed": 5,
}
ICE = {"ice": {"young": 1e7, "poisson": 0.3, "friction": 0.1, "restitution": 0.3}}


def reach(across=None, bodies=(), until=1.0, **changes):
    """A short reach, 0.12 m deep, into which floes come; a change to None leaves the key of the supply out."""
    given = tank(0.5, 0.22, 0.01, fill=(0.5, 0.12), across=across, speed=2.0)
    width = 1.0 if across is None else across
    given["box"]["faces"] = {
        "x_min": {"kind": "inlet", "discharge": 0.06 * width},
        "x_max": {"kind": "outlet", "level": 0.12},
    }
    given["water"]["fill"][0]["velocity"] = [0.5, 0.0, 0.0]
    supply = {key: value for key, value in (SUPPLY | changes).items() if value is not None}
    given |= {"materials": ICE, "bodies": list(bodies), "ice": {"supplies": [supply]}, "run": {"until": until}}
    return given


def block(x, **changes):
    """A fixed block at the surface, half in the water."""
    shape = {"size": [0.05, 1.0, 0.06]}
    own = {"name": "block", "shape": shape, "density": 900.0, "position": [x, 0.5, 0.12], "material": "ice"}
    return own | {"fixed": True} | changes


def row(observer, s):
    """The row of an observer, by its columns."""
    return dict(zip((column.name for column in observer.columns), observer(s.case).rows(s)[0], strict=True))


def test_a_completed_case_has_its_floes_and_loads_back_equal():
    case = parse(reach(until=2.0))
    floes = ice.floes_of(case, case.ice.supplies[0])
    assert case.ice.supplies[0].floes == len(floes) == len(case.bodies)
    assert all(body.enters for body in floes)
    area = sum(body.shape.size[0] for body in floes)
    assert area >= 0.9 * 0.5 * 2.0, "as many as can come in"
    assert parse(tomllib.loads(case.to_toml())) == case
    longer = parse(reach(until=3.0))
    assert longer.bodies[: len(floes)] == case.bodies, "the same ones first, whatever the end"
    assert parse(reach(seed=6)).bodies[0].shape != case.bodies[0].shape
    assert "up to" in ice.told(case)[0]


def test_the_estimate_counts_what_is_there_at_once():
    few, many = (estimate(parse(reach(until=until))) for until in (2.0, 20.0))
    assert few.body <= many.body < 1.5 * few.body


def test_floes_come_in_afloat_and_nothing_is_lost():
    s = simulation(reach(concentration=0.7))
    b, inlet, start = s.bodies, s.solids.openings.inlet, s.near.fluid.size
    assert b.gone.all() and not s.solids.samples.here.size
    seen = []
    while s.time < 0.5:
        s.step()
        openings = s.solids.openings
        assert s.near.fluid.size - openings.inlet.emitted + openings.outlet.removed + s.domain.lost == start
        there = ~b.gone
        assert np.isnan(b.lead[~there]).all(), "what waits is not led"
        seen.append(int(there.sum()))
    account = row(Ice, s)
    assert account["let_in"] == account["inside"] == seen[-1] >= 2 and account["balance"] == 0.0
    assert account["due"] == account["blocked"] == 0
    released = ~b.gone & np.isnan(b.lead)
    assert released.any()
    draught = 0.9 * 0.04
    low = b.position[released, 2] - 0.02
    assert abs(low - (0.12 - draught)).max() < 0.006, "they float at their draught"
    assert abs(b.velocity[released, 0] - 0.5).max() < 0.1
    assert row(Counts, s)["in_bodies"] == 0
    volume = sum(
        min(max(b.position[k, 0] + shape.half[0], 0.0), 2.0 * shape.half[0]) * draught
        for k, shape in enumerate(b.shapes)
        if not b.gone[k]
    )
    assert inlet.displaced == pytest.approx(volume, rel=0.2), "to a row and an end of each"
    wanted = 0.7 * 0.5 * s.time
    assert 0.0 <= wanted - s.solids.openings.passage.queues[0].given < 0.1, "as much as was asked for, to a floe"


def test_what_is_yet_before_the_inlet_covers_no_water():
    given = reach(begins=0.05)
    given["water"] |= {"friction": {"kind": "wall_law", "roughness": 0.001}, "eddies": {"kind": "mixing_length"}}
    s = simulation(given)
    while s.bodies.gone.all():
        s.step()
    front = s.bodies.position[0, 0] + s.bodies.shapes[0].half[0]
    assert -0.02 < front < 0.0 and not s.solids.depths.covered.any()


def test_a_supply_by_discharge_begins_and_ends():
    s = simulation(reach(concentration=None, discharge=[[0.0, 0.0], [0.2, 0.02]], begins=0.1, ends=0.3))
    queue = s.solids.openings.passage.queues[0]
    while s.time < 0.4:
        s.step()
        if s.time < 0.1:
            assert queue.wanted == 0.0
    asked = 0.5 * (0.01 + 0.02) * 0.1 + 0.1 * 0.02
    assert queue.wanted == pytest.approx(asked, rel=0.02)
    assert queue.amounts[0] == pytest.approx(s.bodies.volume[0])


@pytest.mark.long
def test_a_blocked_supply_waits_and_says_how_long():
    s = simulation(reach(bodies=[block(0.06)]))
    b = s.bodies
    while s.time < 0.45:
        s.step()
    account = row(Ice, s)
    assert account["let_in"] == 1 and account["coming"] == 1, "the first comes to the block, the next finds no room"
    assert account["blocked"] > 0.05 and account["due"] >= 1
    front = b.position[1, 0] + b.shapes[1].half[0]
    assert 0.005 < front < 0.035 and abs(b.velocity[1, 0]) < 0.02, "and it does not push"
    assert abs(b.contact_load).max() < 1e-9
    near = simulation(reach(bodies=[block(0.03)]))
    while near.time < 0.25:
        near.step()
    account = row(Ice, near)
    assert account["let_in"] == 0 and account["blocked"] > 0.05, "within the way in which it stops none begins to come"


@pytest.mark.parametrize("supplied", [True, False])
def test_no_water_comes_into_what_is_pushed_back_into_the_inlet(supplied):
    """As a jam that has grown up to it may be."""
    given = reach(bodies=[block(0.03, name="jam", fixed=False, position=[0.03, 0.5, "float"])], begins=0.9)
    s = simulation(given if supplied else given | {"ice": {}})
    b, inlet, (_, _, z) = s.bodies, s.solids.openings.inlet, s.bodies.position[0].copy()
    while s.time < 0.15:
        b.position[0, 2], b.quaternion[0], b.spin[0] = z, (1.0, 0.0, 0.0, 0.0), 0.0
        b.velocity[0] = -0.2, 0.0, 0.0
        s.step()
    assert b.position[0, 0] < 0.01 and inlet.covered.sum() >= 3 and row(Counts, s)["in_bodies"] == 0
    b.position[0, 0] = 0.1
    s.solids.openings.passage.turn(s.time)
    assert not inlet.covered.any()


def test_what_passes_the_outlet_is_led_out_level():
    given = reach(
        bodies=[block(0.44, name="out", fixed=False, position=[0.44, 0.5, "float"], velocity=[0.5, 0.0, 0.0])]
    )
    s = simulation(given | {"ice": {}, "run": {"until": 1.0, "outside": "stop"}})
    b, tilt = s.bodies, []
    while s.time < 0.4 and not b.gone[0]:
        s.step()
        if not b.gone[0]:
            tilt.append(2.0 * abs(b.quaternion[0, 2]))
    assert b.gone[0] and b.left[0] < 0.4 and max(tilt) < 0.12, "it does not tip over the end"
    assert np.isnan(b.lead[0])


@pytest.mark.long
def test_floes_across_a_channel_keep_apart():
    s = simulation(reach(across=0.18, shape="polygon", size=0.07, until=0.6))
    while s.time < 0.2:
        s.step()
    b = s.bodies
    there = np.flatnonzero(~b.gone)
    assert there.size >= 3 and abs(b.contact_load[there]).max() < 1e-9, "to rounding"
    assert (b.position[there, 1] > 0.03).all() and (b.position[there, 1] < 0.15).all()
    turns = 2.0 * np.arctan2(b.quaternion[there, 3], b.quaternion[there, 0])
    assert np.ptp(turns) > 0.5, "turned at random"
    assert row(Counts, s)["in_bodies"] == 0


def test_a_supply_goes_on_from_what_it_kept():
    one, two = (simulation(reach()) for _ in range(2))
    while one.time < 0.2:
        one.step()
    for name, part in two.solids.parts.items():
        part.restore(one.solids.parts[name].kept())
    kept = [each.solids.openings.kept() for each in (one, two)]
    assert all(np.array_equal(kept[0][name], kept[1][name], equal_nan=True) for name in kept[0])
    assert np.array_equal(one.bodies.gone, two.bodies.gone)
    for each in (one, two):
        each.solids.openings.passage.turn(one.time)
    assert np.array_equal(*(each.solids.openings.passage._goal for each in (one, two)))
    assert one.solids.openings.passage._goal.max() > 0.0


def test_floes_come_in_at_the_level_of_the_inlet_not_at_that_of_the_fill():
    given = reach()
    given["box"]["faces"]["x_min"]["level"] = 0.14
    s = simulation(given)
    while s.bodies.gone[0]:
        s.step()
    assert s.bodies.position[0, 2] - 0.02 == pytest.approx(0.14 - 0.9 * 0.04)


def test_what_comes_in_may_be_left_by_the_level_and_by_the_stream():
    s = simulation(reach(until=3.0, bodies=[block(0.2, shape={"size": [0.05, 1.0, 0.12]}, position=[0.2, 0.5, 0.06])]))
    b, openings = s.bodies, s.solids.openings
    while not np.isfinite(b.lead).any():
        s.step()
    coming = np.flatnonzero(np.isfinite(b.lead))
    openings.inlet.level -= 0.06
    openings.passage.turn(s.time)
    assert openings.passage._goal[coming] == pytest.approx(openings.inlet.surface_speed), "it is above all others"
    openings.inlet.discharge = openings.outlet._edge = 0.0
    openings.inlet._flow()
    openings.passage.turn(s.time)
    for _ in range(1000):
        openings.passage.advance(s.time, 1e-3)
    assert b.lead[coming].max() < 0.05, "it stops with the water"


def test_what_comes_to_the_outlet_against_the_stream_is_not_led_back():
    given = reach(bodies=[block(0.44, name="out", fixed=False, position=[0.44, 0.5, "float"])])
    s = simulation(given | {"ice": {}})
    s.bodies.position[0, 0], s.bodies.velocity[0, 0] = 0.51, -0.1
    s.solids.openings.outlet._edge = -0.1
    s.solids.openings.passage.turn(0.0)
    assert s.bodies.lead[0] == 0.0 and s.solids.openings.passage._goal[0] == 0.0


def test_as_many_floes_are_drawn_as_a_falling_level_and_a_sill_let_come():
    """By less depth the surface is faster."""

    def area(given):
        case = parse(given)
        return sum(body.shape.size[0] for body in ice.floes_of(case, case.ice.supplies[0]))

    given = reach(until=2.0)
    given["box"]["faces"]["x_min"]["level"] = [[0.0, 0.12], [0.1, 0.06], [2.0, 0.06]]
    assert area(given) >= 0.9 * 0.06 * (0.1 * np.log(2.0) / 0.06 + 1.9 / 0.06)
    given = reach(until=2.0)
    given["box"]["faces"]["x_max"]["level"] = 0.07
    assert area(given) >= 0.9 * 0.06 / 0.07 * 2.0, "the level falls to that of the outlet"
    given["box"]["faces"]["x_min"]["profile"] = {"kind": "table", "heights": [0.0, 0.12], "shares": [1.0, 0.0]}
    assert area(given) > 0.06, "the uppermost water does not stand"
    sill = block(0.025, name="sill", position=[0.025, 0.5, 0.03])
    assert area(reach(until=2.0, bodies=[sill])) >= 0.9 * 0.06 / 0.06 * 2.0
    with pytest.raises(InputError, match="2 spacings at least, and the inlet is 0.04 m deep"):
        parse(reach(bodies=[sill | {"shape": {"size": [0.05, 1.0, 0.08]}, "position": [0.025, 0.5, 0.04]}]))


def test_a_concentration_is_that_of_the_surface_between_banks():
    bank = block(0.1, name="bank", shape={"size": [0.2, 0.06, 0.2]}, position=[0.1, 0.03, 0.1])
    s = simulation(reach(across=0.18, bodies=[bank], size=0.06))
    inlet, queue = s.solids.openings.inlet, s.solids.openings.passage.queues[0]
    assert inlet.surface_width == pytest.approx(0.12)
    s.solids.openings.passage.advance(0.5, 0.01)
    assert queue.wanted == pytest.approx(0.01 * 0.9 * 0.12 * inlet.surface_speed)


@pytest.mark.parametrize("aspect", [2.14, 2.0])
def test_a_floe_that_fits_only_lengthwise_comes_in_so(aspect):
    s = simulation(reach(across=0.16, size=0.3, aspect=aspect, shape="box", until=20.0))
    passage = s.solids.openings.passage
    queue, nothing = passage.queues[0], passage._near()
    assert not nothing.row.size and all(passage._enters(queue, nothing, 0.0) for _ in range(12))


def test_what_is_near_the_inlet_is_seen_at_the_level_of_now_and_across_sides_that_repeat(tmp_path):
    trimesh.creation.icosphere(3, 0.06).export(tmp_path / "ball.stl")
    shape = {"kind": "mesh", "file": str(tmp_path / "ball.stl")}
    given = reach(across=0.18, size=0.06, bodies=[block(0.1, shape=shape, position=[0.1, 0.09, 0.06])])
    given["box"]["faces"] |= {"y_min": "periodic", "y_max": "periodic"}
    s = simulation(given)
    passage, inlet, wide = s.solids.openings.passage, s.solids.openings.inlet, []
    for inlet.level in (0.15, 0.1, 0.15):
        ends = passage._seen(0).plan.extents()
        wide.append(ends[3].max() - ends[1].min())
    assert wide[0] == wide[2] < wide[1] - 0.01
    s.bodies.position[1] = 0.1, 0.17, 0.12
    seen = passage._seen(1)
    assert seen.row.tolist() == [1, 1] and seen.plan.cy == pytest.approx([0.17, -0.01])


def test_thin_floes_are_told_of_once():
    said = [warning for warning in parse(reach(thickness=0.03)).warnings() if "usable loads" in warning]
    assert len(said) == 1 and said[0].startswith("ice.supplies.drift: ")


WRONG = [
    ({"concentration": None}, "ice.supplies.drift.concentration, discharge: none given; must be exactly one"),
    ({"discharge": 0.01}, "drift.concentration, discharge: both given; must be exactly one"),
    ({"concentration": None, "discharge": [[1.0, 0.1], [1.0, 0.2]]}, "drift.discharge: time 1 after 1 s: times must"),
    ({"concentration": None, "discharge": -0.1}, "drift.discharge = -0.1: must be 0 or more"),
    ({"ends": 0.5, "begins": 0.7}, "drift.ends = 0.5: must be after begins = 0.7 s"),
    ({"material": "wood"}, 'drift.material = "wood": no such material; allowed: ice'),
    ({"density": 1000.0}, "drift.density = 1000.0: does not float"),
    ({"shape": "disc"}, 'drift.shape = "disc": must be "box" in a 2D case'),
    ({"thickness": 0.12}, "drift.thickness: reaches 0.12 m, a draught of 0.108 m; water must come in under it"),
    ({"thickness": 0.01}, "drift.size, thickness: "),
    ({"size": {"kind": "uniform", "min": 0.2, "max": 0.1}}, "drift.size.min = 0.2: must not be greater than max"),
    ({"size": 0.6}, "drift.size: reaches 0.6 m; must be at most the length of the box, 0.5 m"),
    ({"floes": 3}, "drift.floes = 3: there are 0 bodies drift_1 to drift_3"),
]


@pytest.mark.parametrize(("changes", "said"), WRONG)
def test_a_wrong_supply_is_told(changes, said):
    with pytest.raises(InputError) as error:
        parse(reach(**changes))
    assert said in str(error.value)


def test_a_supply_wants_an_inlet_and_floes_that_fit_through_it():
    given = reach()
    given["box"]["faces"]["x_min"] = "wall"
    with pytest.raises(
        InputError, match='"drift": floes come in through an inlet; box.faces.x_min must be of the kind'
    ):
        parse(given)
    with pytest.raises(InputError, match="floes are wider than the inlet, the largest of 0.5 m; it has room for"):
        parse(reach(across=0.3, size=0.5))
    given = reach()
    given["bodies"] = [block(0.2, enters=True)]
    with pytest.raises(InputError, match="bodies.block.enters = true: is written with the floes of ice.supplies"):
        parse(given)
    given = reach()
    with pytest.raises(InputError, match='drift.name = "drift": there is no spacing'):
        parse({key: value for key, value in given.items() if key != "spacing"})
    faces = {"x_min": given["box"]["faces"]["x_min"] | {"profile": {"kind": "table", "heights": [], "shares": []}}}
    with pytest.raises(InputError, match='"drift": the water has no speed at the surface; box.faces.x_min.profile'):
        parse(given | {"box": given["box"] | {"faces": faces}})
    given["ice"]["supplies"].append(SUPPLY)
    with pytest.raises(InputError, match='ice: name = "drift" is given more than once'):
        parse(given)
