"""Inlets and outlets: what comes in follows a formula, nothing is lost or doubled, and the level is that asked for."""

import math
import time as clock
from types import SimpleNamespace

import numpy as np
import pytest
from flows import WOOD, simulation, tank

from parsim.boundary.outlet import normal_level
from parsim.case.course import at_time
from parsim.case.model import parse
from parsim.errors import InputError

REACH = {"length": 0.6, "height": 0.2, "spacing": 0.01, "fill": (0.6, 0.1)}
INLET = {"kind": "inlet", "discharge": 0.04}
OUTLET = {"kind": "outlet", "level": 0.1}
TABLE = {"kind": "table", "heights": [0.0, 0.1]}


def reach(inlet=None, outlet=None, velocity=0.4, across=None, **changes):
    """A short reach of a river, 0.1 m deep, between an inlet and an outlet."""
    given = tank(**REACH, across=across, speed=2.0)
    given["box"]["faces"] = {"x_min": INLET | (inlet or {}), "x_max": OUTLET if outlet is None else outlet}
    given["water"]["fill"][0]["velocity"] = [velocity, 0.0, 0.0]
    return given | changes


def balance(s):
    """Particles inside, less those that came in, plus those that went out or got lost."""
    openings = s.solids.openings
    return s.near.fluid.size - openings.inlet.emitted + openings.outlet.removed + s.domain.lost


@pytest.mark.parametrize("across", [None, pytest.param(0.05, marks=pytest.mark.long)])
def test_every_particle_is_accounted_for_and_the_discharge_is_exact(across):
    width = 1.0 if across is None else across
    s = simulation(reach({"discharge": 0.04 * width}, across=across))
    start = s.near.fluid.size
    while s.time < 0.3:
        s.step()
        assert balance(s) == start
    inlet = s.solids.openings.inlet
    volume = s.scheme.lattice.volume
    asked = 0.04 * width * s.time
    assert inlet.emitted > 100 and s.solids.openings.outlet.removed > 80
    assert abs(inlet.emitted * volume - asked) < inlet.awake.sum() * volume, "to the particles that are on their way"
    ids = s.fluid.id
    assert np.unique(ids).size == ids.size, "no id is given twice"


def test_a_discharge_by_a_table_of_times_comes_in():
    s = simulation(reach({"discharge": [[0.0, 0.02], [0.2, 0.06]]}))
    while s.time < 0.2:
        s.step()
    inlet, volume = s.solids.openings.inlet, s.scheme.lattice.volume
    asked = 0.02 * s.time + 0.5 * 0.2 * s.time * s.time
    assert inlet.discharge == pytest.approx(0.06, abs=0.001)
    assert float(inlet.travel[inlet.awake].sum()) * 0.01 == pytest.approx(asked, rel=0.01)
    assert abs(inlet.emitted * volume - asked) < inlet.awake.sum() * volume


def test_a_table_of_many_times_costs_no_more_at_each_step():
    times = np.cumsum(np.random.default_rng(1).uniform(0.5, 1.5, 200000))
    values = np.sin(times)
    rows, asked = (
        tuple(zip(times.tolist(), values.tolist(), strict=True)),
        [-1.0, *times[:3], 7.3, 5e4, 9e4, times[-1], 1e9],
    )
    began = clock.process_time()
    found = [at_time(rows, time) for _ in range(20) for time in asked]
    assert clock.process_time() - began < 2.0, "4 s where all rows are made an array each time"
    assert found == 20 * np.interp(asked, times, values).tolist()


def test_emitted_particles_stand_where_the_formula_says():
    """Whatever the steps were: x = x_in + travel - (k + 1/2) l0 in rows of one spacing, before the water moves them."""
    case = parse(reach({"profile": {"kind": "linear", "bottom": 0.5}}))
    at_rest = simulation(reach()).scheme.at_rest
    found = []
    for steps in ([0.1], [0.01] * 10, [0.003] * 33 + [0.001]):
        inlet, born = simulation(reach({"profile": {"kind": "linear", "bottom": 0.5}})).solids.openings.inlet, {}
        for dt in steps:
            inlet.follow(0.1, 0.4, 1.0, dt)
            inlet.advance(dt)
            new = inlet.emit(at_rest)
            assert (new.x >= 0.0).all(), "not before it has passed"
            for ident, z in zip(new.id, new.z, strict=True):
                born[int(ident)] = float(z)
        found.append(born)
    assert found[0] == found[1] == found[2] and len(found[0]) >= 30
    assert case.box.faces.x_min.discharge == 0.04


def test_places_wake_and_sleep_with_the_level():
    inlet = simulation(reach()).solids.openings.inlet
    assert inlet.awake.sum() == 10
    inlet.level = 0.1249
    inlet._wake()
    assert inlet.awake.sum() == 12, "a row wakes a quarter of a spacing early"
    inlet.level = 0.1176
    inlet._wake()
    assert inlet.awake.sum() == 12, "and does not go to sleep at once"
    inlet.level = 0.112
    inlet._wake()
    assert inlet.awake.sum() == 11
    inlet.follow(0.112, 0.4, 0.0, 0.001)
    assert float(inlet.speed.sum()) * 0.01 == pytest.approx(0.04, rel=1e-12), "whatever the level"


def test_no_water_comes_in_where_something_fixed_stands():
    """A sill at the inlet: the discharge comes in over it, with the profile of what is left, and nothing leaks."""
    sill = {"name": "sill", "shape": {"size": [0.3, 1.0, 0.04]}, "density": 2000.0, "position": [0.15, 0.5, 0.02]}
    given = reach({"profile": {"kind": "linear", "bottom": 0.5}}) | {
        "materials": WOOD, "bodies": [sill | {"material": "wood", "fixed": True}]
    }  # fmt: skip
    s = simulation(given)
    inlet, start = s.solids.openings.inlet, s.near.fluid.size
    assert inlet.solid.sum() == 4 and not inlet.awake[inlet.solid].any() and inlet.awake.sum() == 6
    shares = inlet.speed[inlet.awake]
    assert not s.time and shares.sum() * 0.01 == pytest.approx(0.04)
    assert shares / shares.mean() == pytest.approx(0.5 + (inlet._z[inlet.awake] - 0.04) / 0.06)
    while s.time < 0.3:
        s.step()
        assert balance(s) == start and not s.domain.lost
    p, at = s.domain.particles, s.near.fluid
    assert p.x[at].min() > -0.005 and not ((p.x[at] < 0.295) & (p.z[at] < 0.035)).any(), "none gets under it"


def test_a_wave_over_a_sill_is_let_out_by_the_depth_there():
    sill = {"name": "sill", "shape": {"size": [0.3, 1.0, 0.04]}, "density": 2000.0, "position": [0.15, 0.5, 0.02]}
    more = {"materials": WOOD, "bodies": [sill | {"material": "wood", "fixed": True}]}
    inlet = simulation(reach({"absorb": 1.0}) | more).solids.openings.inlet
    inlet.follow(0.1, 0.4, 1.0, 1e-9)
    wave, dt = math.sqrt(9.81 * 0.06), 1e-6
    speed = 0.4 - math.sqrt(9.81 / 0.06) * 0.001
    inlet.follow(0.101, speed, 1.0, dt)
    assert 0.04 - inlet.discharge == pytest.approx(wave * 0.001 * dt / (0.06 / (wave - speed)), rel=1e-3)


def test_water_goes_on_beyond_the_outlet_and_not_back():
    s = simulation(reach())
    outlet, p = s.solids.openings.outlet, s.domain.particles
    beyond = np.flatnonzero((p.kind == 0) & (p.x > 0.55))
    p.x[beyond] += 0.06
    outlet.find(p, s.domain.own)
    p.u[beyond[::2]] = -0.3
    outlet.hold(p, s.scheme.at_rest)
    at = outlet._at
    assert at.size and p.p[at] == pytest.approx(9810.0 * np.maximum(outlet.level - p.z[at], 0.0))
    assert outlet.turned().sum() == np.isin(at, beyond[::2]).sum()
    p.u[at] += 1.0
    p.w[at] = 1.0
    outlet.release(p)
    assert p.u[at].min() == 0.0 and p.u[at].max() == pytest.approx(0.4, abs=1e-12) and not p.w[at].any()


@pytest.mark.parametrize(("flow", "manning", "slope"), [(0.1435, 0.0213, 0.002), (5.0, 0.03, 0.0005)])
def test_normal_depth(flow, manning, slope):
    def channel(width):
        return lambda level: (width * max(level, 0.0), width, max(level, 0.0))

    depth = normal_level(flow, manning, slope, channel(1.0), 0, 0.0)
    assert depth ** (5 / 3) * math.sqrt(slope) / manning == pytest.approx(flow)
    for width in (3.0, 0.01):
        depth = normal_level(width * flow, manning, slope, channel(width), 2, 0.0)
        area = width * depth
        through = area * (area / (width + 2.0 * depth)) ** (2 / 3) * math.sqrt(slope) / manning
        assert through == pytest.approx(width * flow)
    assert normal_level(0.0, manning, slope, channel(3.0), 2, 0.5) == 0.5


def test_the_normal_depth_between_sides_that_repeat_is_that_of_a_wide_channel():
    given = reach({"discharge": 0.002}, {"kind": "outlet", "normal": {"manning": 0.02, "slope": 0.0013}}, across=0.05)
    given["box"]["faces"] |= {"y_min": "periodic", "y_max": "periodic"}
    out = simulation(given).solids.openings.outlet
    out.discharge = 0.002
    assert out._asked(0.0) == pytest.approx((0.02 * 0.04 / math.sqrt(0.0013)) ** 0.6)


@pytest.mark.parametrize(("outlet", "level"), [
    ({"kind": "outlet", "rating": [[0.0, 0.05], [0.08, 0.15]]}, 0.1),
    ({"kind": "outlet", "normal": {"manning": 0.02, "slope": 0.0013}}, (0.02 * 0.04 / math.sqrt(0.0013)) ** 0.6),
    ({"kind": "outlet", "level": [[0.0, 0.09], [1.0, 0.11]]}, 0.1),
])  # fmt: skip
def test_the_level_is_that_of_rating_normal_flow_or_a_table(outlet, level):
    out = simulation(reach(outlet=outlet | {"absorb": 0.0})).solids.openings.outlet
    for _ in range(3):
        out.follow(0.1, 0.4, 0.4, 0.5, 0.001)
    assert out.level == pytest.approx(level, rel=1e-9)


def test_a_wave_from_inside_is_let_out():
    """The level gives way such that the invariant that runs in, V - 2 sqrt(g h), stays: dV = sqrt(g / h) dh."""
    rise, wave = 0.002, math.sqrt(9.81 / 0.1)
    for sign, answer in ((1.0, rise), (-1.0, 0.0)):
        out = simulation(reach()).solids.openings.outlet
        out.follow(0.1, 0.4, 0.4, 0.5, 1e-6)
        assert out.level == pytest.approx(0.1)
        for _ in range(1000):
            out.follow(0.1 + rise, 0.4 + sign * wave * rise, 0.4, 0.5, 1e-4)
        assert out.level - 0.1 == pytest.approx(answer, abs=0.06 * rise), "and what runs in is not answered"


def test_an_inlet_that_absorbs_gives_way_to_a_wave():
    """dV = -sqrt(g / h) dh of the wave that runs out: then none runs back; its own waves are not answered."""
    rise, wave = 0.002, math.sqrt(9.81 / 0.1)
    for sign, answer in ((-1.0, 0.1 * wave * rise), (1.0, 0.0)):
        inlet = simulation(reach({"absorb": 1.0})).solids.openings.inlet
        inlet.follow(0.1, 0.4, 1.0, 1e-6)
        assert inlet.discharge == pytest.approx(0.04)
        for _ in range(5000):
            inlet.follow(0.1 + rise, 0.4 + sign * wave * rise, 1.0, 1e-4)
        told = 0.3 * 0.1 * wave * rise if answer else 1e-5  # it comes late, and means go along
        assert 0.04 - inlet.discharge == pytest.approx(answer, abs=told)


def test_what_an_absorbing_inlet_could_not_let_out_does_not_come_in_later():
    inlet = simulation(reach({"absorb": 1.0, "discharge": 0.005})).solids.openings.inlet
    total, wave, dt = 0.0, math.sqrt(9.81 / 0.1), 1e-3
    for rise in 0.02 * np.sin(2e-3 * math.pi * np.arange(30000)):
        inlet.follow(0.1 + rise, 0.05 - wave * rise, 1.0, dt)
        assert inlet.discharge >= 0.0, "nothing goes out"
        total += inlet.discharge * dt
    assert total == pytest.approx(30.0 * 0.005, rel=0.1)


def test_an_absorbing_inlet_does_not_feed_its_own_waves():
    """Six rows of water over 1.6 m. One that answered the level alone had given twice as much at 2.5 s."""
    given = tank(1.6, 0.3, 0.02, fill=(1.6, 0.12), disorder=0.2, speed=1.5)
    given["water"]["fill"][0]["velocity"] = [1.0 / 3.0, 0.0, 0.0]
    given["box"]["faces"] = {"x_min": INLET | {"absorb": 1.0}, "x_max": {"kind": "outlet", "level": 0.12}}
    s, seen = simulation(given), []
    while s.time < 2.5:
        s.step()
        seen.append(s.solids.openings.inlet.discharge)
    assert s.solids.openings.inlet.emitted == pytest.approx(250, abs=9)
    assert seen == pytest.approx([0.04] * len(seen), rel=0.1)


def test_an_outlet_over_a_sill_knows_the_water_over_it():
    sill = {"name": "sill", "shape": {"size": [0.3, 1.0, 0.04]}, "density": 2000.0, "position": [0.45, 0.5, 0.02]}
    more = {"materials": WOOD, "bodies": [sill | {"material": "wood", "fixed": True}]}
    normal = {"kind": "outlet", "normal": {"manning": 0.02, "slope": 0.0013}, "absorb": 0.0}
    for outlet, level in (
        ({"kind": "outlet", "rating": [[0.0, 0.05], [0.08, 0.15]], "absorb": 0.0}, 0.08),
        (normal, 0.04 + (0.02 * 0.024 / math.sqrt(0.0013)) ** 0.6),
    ):
        out = simulation(reach(outlet=outlet) | more).solids.openings.outlet
        out.follow(0.1, 0.4, 0.4, 0.5, 0.001)
        assert out.discharge == pytest.approx(0.4 * 0.06) and out.level == pytest.approx(level, rel=1e-3)


def test_the_water_beyond_goes_along_with_that_before():
    out = simulation(reach()).solids.openings.outlet
    for edge in (0.4, 0.5, 0.5, 0.5):
        out.follow(0.1, 0.4, edge, 0.5, 1.0)
        gained = out._gain
        assert gained == pytest.approx(0.1 if out._edge == 0.5 and edge == 0.5 and gained else 0.0)
    out.follow(0.1, 0.4, 0.3, 0.5, 0.001)
    assert out._gain == pytest.approx(-0.2 * 0.001 / (0.1 * math.sqrt(0.1 / 9.81)))
    out.follow(0.1, 0.4, math.nan, 0.5, 0.001)
    assert out._gain == 0.0, "no water is there"


def test_openings_go_on_from_what_they_kept():
    one, two = (simulation(reach()) for _ in range(2))
    for _ in range(50):
        one.step()
    two.solids.openings.restore(one.solids.openings.kept())
    kept = [each.solids.openings.kept() for each in (one, two)]
    assert all(np.array_equal(kept[0][name], kept[1][name], equal_nan=True) for name in kept[0])


WRONG = [
    ({"x_max": INLET}, "box.faces.x_max = \"inlet\": must be x_min"),
    ({"x_min": OUTLET}, "box.faces.x_min = \"outlet\": must be x_max"),
    ({"x_min": INLET | {"discharge": -1.0}}, "x_min.discharge = -1: must be 0 or more"),
    ({"x_min": INLET | {"discharge": 0.5}}, "5 m/s through 0.1 m2, more than the largest expected speed, 2 m/s"),
    ({"x_min": INLET | {"discharge": [[1.0, 0.1], [1.0, 0.2]]}}, "x_min.discharge: time 1 after 1 s: times must grow"),
    ({"x_min": INLET | {"level": 0.005}}, "x_min.level = 0.005: must be more than a spacing above the floor"),
    ({"x_min": INLET | {"profile": {"kind": "log", "roughness": 5.0}}}, "profile.roughness = 5.0: must be less than"),
    ({"x_min": INLET | {"level": 0.3}}, "x_min.level = 0.3: must be below the top of the box, 0.2 m"),
    ({"x_min": INLET | {"level": [[0.0, 0.1], [9.0, 0.015]]}}, "discharge = 0.04: is 2.667 m/s through 0.015 m2, more"),
    ({"x_min": INLET | {"profile": TABLE | {"shares": [2.0, -0.5]}}}, "profile.shares = [2.0, -0.5]: must be 0"),
    ({"x_min": INLET | {"profile": TABLE | {"shares": [0.0, 0.0]}}}, "profile.shares = [0.0, 0.0]: must not all be 0"),
    ({"x_max": {"kind": "outlet", "rating": [[0.0, 0.1], [1.0, 9.0]]}}, "rating: level = 9: must be below the top"),
    ({"x_max": {"kind": "outlet"}}, "level, rating, normal: none given; must be exactly one"),
    ({"x_max": OUTLET | {"rating": [[0.0, 0.1], [1.0, 0.2]]}}, "level and rating given; must be exactly one"),
    ({"x_max": {"kind": "outlet", "level": -0.1}}, "x_max.level = -0.1: must be above the floor"),
    ({"x_max": {"kind": "outlet", "level": 0.3}}, "x_max.level = 0.3: must be below the top of the box"),
    ({"x_max": {"kind": "outlet", "rating": [[0.0, 0.1], [1.0, 0.1]]}}, "rating: level 0.1 after 0.1: must grow"),
    ({"x_max": {"kind": "outlet", "rating": [[0.1, 0.1], [0.1, 0.2]]}}, "rating: discharge 0.1 after 0.1: must grow"),
    ({"x_max": {"kind": "outlet", "normal": {"manning": 0.02}}}, "x_max.normal.slope: missing"),
    ({"x_min": {"kind": "inlet"}}, "x_min.discharge: missing"),
    ({"x_max": {"kind": "outlet", "normal": {"manning": 0.1, "slope": 1e-6}}}, "normal: uniform flow of what comes in"),
]  # fmt: skip


@pytest.mark.parametrize(("faces", "said"), WRONG)
def test_a_wrong_opening_is_told(faces, said):
    given = reach()
    given["box"]["faces"] |= faces
    with pytest.raises(InputError) as error:
        parse(given)
    assert said in str(error.value)


def test_what_is_doubtful_in_openings_is_told():
    short = reach(outlet={"kind": "outlet", "rating": [[0.0, 0.05], [0.03, 0.1]]})
    assert any("rating: ends at 0.03, and up to 0.04 come in" in text for text in parse(short).warnings())
    fast = reach({"discharge": 0.15, "profile": {"kind": "linear"}})
    assert any("x_min.profile: comes in at up to 3 m/s, more than" in text for text in parse(fast).warnings())


def test_an_opening_without_gravity_is_told():
    for up in (0.0, 9.81):
        with pytest.raises(InputError, match=r"x_max.kind: gravity = .*: must go along -z beside an outlet"):
            parse(reach(gravity=[0.0, 0.0, up]))


def test_an_inlet_without_water_is_told():
    given = reach()
    given["water"]["fill"][0]["min"] = [0.2, 0.0, 0.0]
    with pytest.raises(InputError, match="no fill reaches the inlet, x = 0.0 m"):
        parse(given)
    given["water"] = {}
    with pytest.raises(InputError, match='x_min = "inlet": there is no water'):
        parse(given)


def test_levels_may_be_below_zero():
    given = reach({"level": -0.3}, OUTLET | {"level": [[0.0, -0.3], [9.0, -0.35]]})
    given["box"] |= {"min": [0.0, 0.0, -0.4], "max": [0.6, 1.0, 0.1]}
    given["water"]["fill"][0] |= {"min": [0.0, 0.0, -0.4], "max": [0.6, 1.0, -0.3]}
    assert parse(given).box.faces.x_max.level[1] == (9.0, -0.35)


def test_the_row_of_the_series_balances():
    from parsim.observe.openings import Openings

    s = simulation(reach())
    start = s.near.fluid.size
    while s.time < 0.1:
        s.step()
    names = [column.name for column in Openings.columns]
    row = SimpleNamespace(**dict(zip(names, Openings(s.case).rows(s)[0], strict=True)))
    assert row.balance == start and row.let_in > 0 and row.level_out == pytest.approx(0.1, abs=0.01)
    assert row.discharge_in == 0.04 and 0.0 <= row.clipped < 0.2
