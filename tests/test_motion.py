"""A box that moves: what is felt in it, against what is seen from outside, and the work that is done."""

import math

import numpy as np
import pytest
from flows import GRAVITY, WOOD, fluid, simulation, tank

from parsim.case.model import load, parse
from parsim.case.motion import Sine, Spline
from parsim.coupling.moving import Moving
from parsim.errors import InputError
from parsim.geometry.rotation import matrices

SWAY = {"kind": "sway", "amplitude": 0.02, "period": 0.8, "phase": 30.0}
ROLL = {"kind": "roll", "about": [0.1, 0.0, 0.2], "amplitude": 20.0, "period": 1.3, "phase": 50.0}
BLOCK = {"name": "a", "shape": {"size": [0.04, 1.0, 0.04]}, "density": 500.0, "position": [0.2, 0.5, 0.1],
         "material": "wood"}  # fmt: skip


def shaken(motion, **changes):
    """A tank of still water, 0.4 m long and 0.1 m deep."""
    return tank(0.4, 0.2, 0.01, fill=(0.4, 0.1), speed=1.0) | {"motion": motion} | changes


def test_a_sine_knows_its_rate_and_how_that_changes():
    course, t, h = Sine(0.3, 0.8, 30.0), 0.37, 1e-4
    before, now, after = (course(t + k * h) for k in (-1, 0, 1))
    assert now[0] == pytest.approx(0.3 * math.sin(2.0 * math.pi * t / 0.8 + math.pi / 6.0))
    assert now[1] == pytest.approx((after[0] - before[0]) / (2.0 * h), rel=1e-6)
    assert now[2] == pytest.approx((after[1] - before[1]) / (2.0 * h), rel=1e-6)
    assert course(-0.1) == (pytest.approx(0.15), 0.0, 0.0)


def test_a_table_of_times_is_as_smooth_as_what_it_is_of():
    rows = [(t, 3.0 * t * t * (1.0 - t) ** 2) for t in np.linspace(0.0, 1.0, 41).tolist()]
    course = Spline(rows, 2.0)
    for t in (0.0, 0.013, 0.5, 0.77, 1.0):
        value, rate, second = course(t)
        assert value == pytest.approx(6.0 * t * t * (1.0 - t) ** 2, abs=1e-5)
        assert rate == pytest.approx(12.0 * t * (1.0 - t) * (1.0 - 2.0 * t), abs=1e-3)
        assert second == pytest.approx(12.0 * (1.0 - 6.0 * t + 6.0 * t * t), abs=0.1)
    assert course(-1.0) == (0.0, 0.0, 0.0) and course(1.5) == (0.0, 0.0, 0.0)


def test_what_flies_straight_is_turned_and_bent_as_is_felt():
    """A point at constant velocity outside, seen from the box that rolls."""
    moving, course = Moving(parse(shaken(ROLL, gravity=[0.0, 0.0, -GRAVITY]))), Sine(math.radians(20.0), 1.3, 50.0)
    pivot, h, t = np.array([0.1, 0.2]), 1e-4, 0.45

    def seen(time):
        fall = np.array([0.3 + 0.7 * time, 0.1 - 0.4 * time - 0.5 * GRAVITY * time**2]) - pivot
        c, s = math.cos(course(time)[0]), math.sin(course(time)[0])
        return np.array([c * fall[0] - s * fall[1], s * fall[0] + c * fall[1]]) + pivot

    (x, z), velocity = seen(t), (seen(t + h) - seen(t - h)) / (2.0 * h)
    turning = moving.turning(t)
    felt = np.array(turning.felt(x, z)) + np.array(moving.gravity(t))[[0, 2]]
    felt += 2.0 * turning.rate * np.array([-velocity[1], velocity[0]])
    assert felt == pytest.approx((seen(t + h) - 2.0 * seen(t) + seen(t - h)) / h**2, rel=1e-4)


def test_a_body_without_weight_stays_where_it_is_while_the_box_sways():
    s = simulation({"dimensions": 2, "run": {"until": 9.0}, "box": {"max": [0.4, 1.0, 0.2]}, "gravity": [0.0] * 3,
                    "materials": WOOD, "bodies": [BLOCK], "motion": SWAY, "output": {"series": 0.005}})  # fmt: skip
    course = Sine(0.02, 0.8, 30.0)
    while s.time < 0.5:
        s.step()
    gone, (x, rate, _), start = s.bodies.position[0, 0] - 0.2, course(s.time), course(0.0)
    assert gone == pytest.approx(start[0] + start[1] * s.time - x, abs=1e-4)
    assert s.bodies.velocity[0, 0] == pytest.approx(start[1] - rate, abs=1e-3)
    assert s.solids.pull.work == pytest.approx(s.bodies.kinetic_energy(), rel=1e-3)


@pytest.mark.parametrize("planar", [True, False])
def test_a_body_without_weight_flies_straight_and_spins_on_while_the_box_rolls(planar):
    """Seen from outside: the place turned back, and the spin with that of the box."""
    body = BLOCK | {"velocity": [0.1, 0.0, -0.05], "spin": [0.0, 0.7, 0.0], "position": [0.2, 0.5, 0.1]}
    box = {"min": [-2.0, 0.0, -2.0], "max": [2.0, 1.0, 2.0]}
    if not planar:
        body |= {"shape": {"size": [0.05, 0.03, 0.02]}, "spin": [0.5, 0.7, -0.9], "velocity": [0.1, 0.03, -0.05]}
    s = simulation({"dimensions": 2 if planar else 3, "spacing": 0.1, "run": {"until": 9.0}, "box": box,
                    "gravity": [0.0] * 3, "materials": WOOD, "bodies": [body], "motion": ROLL,
                    "output": {"series": 0.01}})  # fmt: skip
    course, pivot = Sine(math.radians(20.0), 1.3, 50.0), np.array([0.1, 0.0, 0.2])

    def outside():
        """Place, velocity and angular momentum."""
        angle, rate, _ = course(s.time)
        c, si = math.cos(angle), math.sin(angle)
        back, turning = np.array([[c, 0.0, si], [0.0, 1.0, 0.0], [-si, 0.0, c]]), np.array([0.0, rate, 0.0])
        arm, own = s.bodies.position[0] - pivot, matrices(s.bodies.quaternion)[0]
        spin = s.bodies.spin[0] + turning
        momentum = own @ (s.bodies.inertia[0] * (own.T @ spin))
        return back @ arm + pivot, back @ (s.bodies.velocity[0] + np.cross(turning, arm)), back @ momentum

    place, velocity, momentum = outside()
    while s.time < 0.6:
        s.step()
    now = outside()
    assert now[0] == pytest.approx(place + s.time * velocity, abs=2e-4)
    assert now[1] == pytest.approx(velocity, abs=2e-3)
    assert now[2] == pytest.approx(momentum, abs=2e-3 * np.linalg.norm(momentum))


def test_water_in_a_box_that_leans_leans_back():
    """Slowly brought to a slope of two degrees, it ends level as seen from outside."""
    rows = [[0.2 * k, 1.0 - math.cos(0.2 * k * math.pi / 1.6)] for k in range(9)]
    s = simulation(shaken({"kind": "roll", "about": [0.2, 0.0, 0.0], "angle": rows}))
    while s.time < 2.4:
        s.step()
    p, at = fluid(s)
    top = [p.z[at][np.abs(p.x[at] - x) < 0.03].max() for x in (0.05, 0.35)]
    assert top[1] - top[0] == pytest.approx(0.3 * math.tan(math.radians(2.0)), abs=0.004), "x_max has sunk"


@pytest.mark.parametrize("motion", [SWAY | {"phase": 90.0}, ROLL | {"amplitude": 3.0, "phase": 0.0}])
def test_the_work_of_the_box_is_what_the_water_gains(motion):
    from parsim.observe.energy import Energy

    s = simulation(shaken(motion))
    still = simulation(shaken(motion | {"amplitude": 0.0}))
    made = {}
    for name, each in (("moves", s), ("stands", still)):
        row = Energy(s.case).rows(each)[0]
        while each.time < 0.4:
            each.step()
        made[name] = Energy(s.case).rows(each)[0][-1] - row[-1] - each.solids.pull.work
    assert s.solids.pull.work > 0.05
    assert made["moves"] - made["stands"] == pytest.approx(0.0, abs=0.15 * s.solids.pull.work), (
        "0.04 of it at half the spacing"
    )


def test_it_goes_on_from_what_it_kept():
    one, two = (simulation(shaken(SWAY)) for _ in range(2))
    for _ in range(20):
        one.step()
    two.solids.pull.restore(one.solids.pull.kept())
    assert np.array_equal(one.solids.pull.kept()["drive"], two.solids.pull.kept()["drive"], equal_nan=True)


def test_a_motion_is_read_from_a_file_beside_the_case(tmp_path):
    (tmp_path / "roll.csv").write_text("time,angle\n0.0,0.0\n1.0,2.0\n")
    (tmp_path / "case.toml").write_text(
        'dimensions = 2\nspacing = 0.01\n[motion]\nkind = "roll"\nabout = [0, 0, 0]\nangle = {file = "roll.csv"}\n'
        "[box]\nmax = [0.1, 1.0, 0.1]\n[water]\nfill = [{min = [0.0, 0.0, 0.0], max = [0.1, 1.0, 0.05]}]\n"
        "[run]\nuntil = 1.0\n"
    )
    assert load(tmp_path / "case.toml").motion.angle == ((0.0, 0.0), (1.0, 2.0))


WRONG = [
    (SWAY | {"displacement": [[0.0, 0.0], [1.0, 1.0]]}, {}, "motion.amplitude: is given, and displacement too"),
    ({"kind": "sway", "amplitude": 0.1}, {}, "motion.period: missing; give amplitude and period, or displacement"),
    ({"kind": "sway", "displacement": [[1.0, 0.0], [1.0, 1.0]]}, {}, "motion.displacement: time 1 after 1 s"),
    ({"kind": "roll", "amplitude": 1.0, "period": 1.0}, {}, "motion.about: missing"),
    ({"kind": "heave"}, {}, "motion.kind"),
    (SWAY, {"gate": {"min_x": 0.1, "max_x": 0.12}}, "motion: with a box that moves there is no gate"),
    (SWAY, {"gravity_ramp": 0.1}, "motion: gravity_ramp = 0.1: must be 0"),
]


@pytest.mark.parametrize(("motion", "changes", "said"), WRONG)
def test_a_wrong_motion_is_told(motion, changes, said):
    with pytest.raises(InputError) as error:
        parse(shaken(motion, **changes))
    assert said in str(error.value)


@pytest.mark.parametrize(("faces", "said"), [
    ({"x_min": {"kind": "inlet", "discharge": 0.01}}, 'motion.kind = "roll": box.faces.x_min = "inlet": must be'),
    ({"x_max": {"kind": "outlet", "level": 0.1}}, 'box.faces.x_max = "outlet": must be a wall or open'),
    ({"x_min": "periodic", "x_max": "periodic"}, 'box.faces.x_min = "periodic": must be a wall or open'),
])  # fmt: skip
def test_sides_that_make_no_sense_in_it_are_told(faces, said):
    given = shaken(ROLL)
    given["box"]["faces"] = faces
    with pytest.raises(InputError) as error:
        parse(given)
    assert said in str(error.value)
