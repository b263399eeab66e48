"""Joints against closed forms: guide rails, pendulum, springs, given motions; their loads and their work."""

import math

import numpy as np
import pytest
from contact_cases import FLAT, GRAVITY, HALF, MASS, boxes, budget, case, go

from parsim.case.model import load, parse
from parsim.domain.comm import Comm
from parsim.errors import InputError
from parsim.geometry.rotation import from_angles, matrices
from parsim.run.simulation import Simulation
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.joints import JOINTS
from parsim.solid.joints.drives import ScheduleTable, SteadyTable, SwayTable, SwingTable
from parsim.solid.joints.lock import LockTable
from parsim.solid.joints.pendulum import PendulumTable
from parsim.solid.joints.spring import SpringTable

WEIGHTLESS = (0.0, 0.0, 0.0)


def tied(*joints, gravity=GRAVITY, position=(0.5, 0.5, 0.5), walls=(), **state):
    """One block and its contacts."""
    body = Bodies(boxes(HALF), [MASS], [position], names=["a"], joints=joints, **state)
    return body, Contacts(body, case(gravity=gravity, walls=walls))


def test_rails_let_a_body_move_along_them_only():
    rails = LockTable(kind="lock", body="a", locked=("x", "y", "turn_x", "turn_y", "turn_z"))
    body, contacts = tied(rails, quaternion=[from_angles((20.0, 30.0, 0.0))])
    load = np.array([[3.0, -2.0, 0.5, 0.1, 0.2, -0.3]])
    go(body, contacts, 1e-3, 200, load=load)
    fallen = 0.5 * (0.5 / MASS - 9.81) * 0.2**2
    assert body.position[0] == pytest.approx((0.5, 0.5, 0.5 + fallen), rel=1e-12)
    assert not body.spin.any()
    assert body.joint_load[0] == pytest.approx([-3.0, 2.0, 0.0, -0.1, -0.2, 0.3], abs=1e-12)


@pytest.mark.parametrize("locked", [("turn_x", "turn_z"), ("turn_y",)])
def test_a_body_turns_about_the_axes_that_are_left(locked):
    """Torque over the moments about these axes of space, however the body stands."""
    pose = from_angles((20.0, 30.0, 40.0))
    body, contacts = tied(LockTable(kind="lock", body="a", locked=locked), gravity=WEIGHTLESS, quaternion=[pose])
    load, dt = np.array([[0.0, 0.0, 0.0, 1e-4, 2e-4, -3e-4]]), 1e-4
    go(body, contacts, dt, 1, load=load)
    turn = matrices(pose[None])[0]
    inertia = turn @ np.diag(body.inertia[0]) @ turn.T
    left = [a for a, name in enumerate(("turn_x", "turn_y", "turn_z")) if name not in locked]
    exact = np.zeros(3)
    exact[left] = dt * np.linalg.solve(inertia[np.ix_(left, left)], load[0, 3:][left])
    assert body.spin[0] == pytest.approx(exact, rel=1e-6, abs=1e-15)
    go(body, contacts, dt, 500, load=load)
    assert not body.spin[0, [a for a in range(3) if a not in left]].any()


def swing(steps, until, angle=2.5, rod=0.2):
    """A pendulum let go at an angle from its lowest place, rad: its body and contacts at a time."""
    pivot = np.array((0.5, 0.5, 0.5))
    start = pivot + rod * np.array((math.sin(angle), 0.0, -math.cos(angle)))
    body, contacts = tied(PendulumTable(kind="pendulum", body="a", pivot=tuple(pivot)), position=start)
    before = budget(body, contacts)
    go(body, contacts, until / steps, steps)
    return body, np.linalg.norm(body.position[0] - pivot), budget(body, contacts) - before


@pytest.mark.long
def test_a_pendulum_swings_with_the_exact_period():
    """Elliptic integral by the arithmetic-geometric mean; order two in the step; rod and energy kept."""
    rod, a, b = 0.2, 1.0, math.cos(1.25)  # let go at 2.5 rad
    for _ in range(10):
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    period = 2.0 * math.pi * math.sqrt(rod / 9.81) / a
    lowest = []
    for steps in (200, 400):
        body, length, gained = swing(steps, period / 4.0)
        assert length == pytest.approx(rod, rel=1e-12)
        assert abs(gained) < 2e-3 * MASS * 9.81 * rod
        lowest.append(abs(body.position[0, 0] - 0.5))
    assert lowest[1] < 1e-4 * rod and 3.0 < lowest[0] / lowest[1] < 5.0
    body, _, gained = swing(40000, 100.0 * period)
    assert abs(gained) < 1e-3 * MASS * 9.81 * rod, "no drift in a hundred swings"


def test_the_rod_carries_weight_and_swing():
    body, _, _ = swing(4000, 0.3)
    arm = (body.position[0] - 0.5) / 0.2
    speed = np.linalg.norm(body.velocity[0])
    carried = -body.joint_load[0, :3] @ arm
    assert carried == pytest.approx(MASS * speed**2 / 0.2 - 9.81 * MASS * arm[2], rel=0.01)


def test_a_body_on_a_spring_swings_and_comes_to_rest():
    spring = {"kind": "spring", "body": "a", "to": (0.5, 0.5, 0.9), "stiffness": 20.0, "length": 0.3}
    body, contacts = tied(SpringTable(**spring))
    before, period = budget(body, contacts), 2.0 * math.pi * math.sqrt(MASS / 20.0)
    go(body, contacts, period / 600, 600)
    assert body.position[0, 2] == pytest.approx(0.5, abs=1e-5) and abs(body.velocity[0, 2]) < 0.01
    assert budget(body, contacts) == pytest.approx(before, abs=1e-4)
    body, contacts = tied(SpringTable(**spring, damping=1.0))
    before = budget(body, contacts)
    go(body, contacts, 1e-3, 3000)
    assert body.position[0, 2] == pytest.approx(0.6 - MASS * 9.81 / 20.0, abs=1e-6)
    assert body.joint_load[0, 2] == pytest.approx(9.81 * MASS, rel=1e-6)
    assert budget(body, contacts) == pytest.approx(before, rel=1e-3)


def test_a_rope_pulls_only_and_a_boom_holds_across_only():
    rope = SpringTable(kind="spring", body="a", to=(0.5, 0.5, 0.7), stiffness=1e3, length=0.4, slack=True)
    body, contacts = tied(rope)
    go(body, contacts, 1e-3, 200)
    assert body.velocity[0, 2] == pytest.approx(-9.81 * 0.2, rel=1e-9), "it has not come to its end"
    go(body, contacts, 1e-3, 100)
    assert body.velocity[0, 2] > -9.81 * 0.2, "now it has"
    boom = SpringTable(kind="spring", body="a", to=(0.5, 0.0, 0.5), line_to=(0.5, 1.0, 0.5), stiffness=1e3)
    body, contacts = tied(boom, gravity=(5.0, 0.3, 0.0), velocity=[(0.0, 0.2, 0.0)])
    go(body, contacts, 1e-3, 1000)
    assert body.position[0, 1] == pytest.approx(0.5 + 0.2 + 0.15, rel=1e-3) or body.position[0, 1] > 0.7
    assert abs(body.position[0, 0] - 0.5) < 2.1 * 5.0 * MASS / 1e3


def test_a_spring_off_the_centre_turns_the_body():
    at = SpringTable(kind="spring", body="a", at=(0.03, 0.0, 0.0), to=(0.53, 0.5, 0.6), stiffness=10.0)
    body, contacts = tied(at, gravity=WEIGHTLESS, quaternion=[FLAT])
    go(body, contacts, 1e-4, 1, load=None)
    assert body.spring_load[0] == pytest.approx([0.0, 0.0, 1.0, 0.0, -0.03, 0.0], rel=1e-3, abs=1e-6)


@pytest.mark.parametrize(("joint", "shift", "turn"), [
    (SteadyTable(kind="steady", body="a", velocity=(0.1, 0.0, 0.2), spin=(0.0, 1.0, 0.0)), (0.03, 0, 0.06), 0.3),
    (ScheduleTable(kind="schedule", body="a", rows=[(0.0, 0, 0, 0), (0.2, 0.1, 0, 0), (1.0, 0.1, 0, 0.8)]),
     (0.1, 0, 0.1), 0),
    (SwayTable(kind="sway", body="a", amplitude=(0.1, 0, 0), frequency=1.0), (0.1 * math.sin(0.6 * math.pi), 0, 0), 0),
    (SwingTable(kind="swing", body="a", pivot=(0.5, 0.5, 0.7), speed=2.0),
     (-0.2 * math.sin(0.6), 0, 0.2 - 0.2 * math.cos(0.6)), 0.6),
])  # fmt: skip
def test_a_given_motion_is_followed(joint, shift, turn):
    body, contacts = tied(joint)
    go(body, contacts, 1e-3, 300, load=np.full((1, 6), 0.5))
    assert body.position[0] - 0.5 == pytest.approx(np.array(shift, float), abs=1e-12)
    assert body.quaternion[0] == pytest.approx([math.cos(turn / 2), 0.0, math.sin(turn / 2), 0.0], abs=1e-9)


def test_what_is_driven_does_the_work_that_others_get():
    """A plate that pushes a block along a floor and lifts itself."""
    joint = SteadyTable(kind="steady", body="a", velocity=(0.2, 0.0, 0.1))
    bodies = Bodies(
        boxes(HALF, HALF),
        [MASS] * 2,
        [(0.3, 0.5, 0.012), (0.3735, 0.5, HALF[2])],
        names=["a", "b"],
        joints=[joint],
        velocity=[(0.2, 0.0, 0.1), (0.0, 0.0, 0.0)],
    )
    contacts = Contacts(bodies, case())
    before = budget(bodies, contacts)
    go(bodies, contacts, 2e-4, 1000)
    assert bodies.position[1, 0] > 0.38 and contacts.driven_work > 0.0
    assert budget(bodies, contacts) == pytest.approx(before, abs=1e-6 * contacts.driven_work)


def test_a_restart_keeps_the_bits():
    joints = [
        PendulumTable(kind="pendulum", body="body0", pivot=(0.5, 0.5, 0.8)),
        SteadyTable(kind="steady", body="body1", velocity=(-0.3, 0.0, 0.0)),
    ]

    def pair():
        bodies = Bodies(boxes(HALF, HALF), [MASS] * 2, [(0.5, 0.5, 0.5), (0.6, 0.5, 0.5)], joints=joints)
        return bodies, Contacts(bodies, case())

    (bodies, contacts), (other, resumed) = pair(), pair()
    go(bodies, contacts, 1e-3, 150)
    other.restore(bodies.kept())
    resumed.restore(contacts.kept())
    for b, c in ((bodies, contacts), (other, resumed)):
        go(b, c, 1e-3, 100, time=0.15)
    assert contacts.dissipated > 0.0
    assert all(np.array_equal(getattr(bodies, n), getattr(other, n)) for n in ("position", "velocity", "joint_load"))


WATER = """
dimensions = 2
spacing = 0.01
[box]
max = [0.4, 1.0, 0.3]
[[water.fill]]
min = [0.0, 0.0, 0.0]
max = [0.4, 1.0, 0.2]
[materials.wood]
young = 1e8
poisson = 0.3
friction = 0.4
restitution = 0.5
[[bodies]]
name = "plate"
shape = {size = [0.08, 1.0, 0.06]}
density = 500.0
position = [0.2, 0.5, 0.1]
material = "wood"
[run]
until = 1.0
settle = 0.5
"""


def wet(tmp_path, joint, **changes):
    """A run of a plate under water with a joint."""
    path = tmp_path / "case.toml"
    path.write_text(WATER + joint)
    return Simulation(load(path, [f"{key}={value}" for key, value in changes.items()]), Comm())


@pytest.mark.long
def test_rails_hold_what_the_water_lifts(tmp_path):
    s = wet(tmp_path, '[[joints]]\nkind = "lock"\nbody = "plate"\nlocked = ["z"]\n')
    held = []
    while s.time < 0.3:
        s.step()
        held.append(s.bodies.joint_load[0, 2] if s.time > 0.0 else math.nan)
    assert np.nanmean(held) == pytest.approx(-500.0 * 9.81 * 0.08 * 0.06, rel=0.03)
    assert s.bodies.position[0, 2] == 0.1


@pytest.mark.long
def test_a_given_motion_moves_the_water(tmp_path):
    """A plate that sways gives the water energy, and the account of all energy stays closed."""
    sway = 'kind = "sway"\nbody = "plate"\namplitude = [0.01, 0.0, 0.0]\nfrequency = 2.0\nbegins = 0.0\n'
    s = wet(tmp_path, f"[[joints]]\n{sway}")
    work = []
    while s.time < 0.5:
        s.step()
        work.append(s.contacts.driven_work)
    assert s.bodies.position[0, 0] == pytest.approx(0.2 + 0.01 * math.sin(4.0 * math.pi * s.time), abs=1e-9)
    assert max(work) > 1e-3 and np.isfinite(work).all()


BODY = {
    "name": "a",
    "shape": {"size": [0.1, 0.1, 0.1]},
    "density": 500.0,
    "material": "wood",
    "position": [0.5, 0.5, 0.5],
}
WOOD = {"wood": {"young": 1e8, "poisson": 0.3, "friction": 0.4, "restitution": 0.5}}


@pytest.mark.parametrize(("joints", "said"), [
    ([{"kind": "lock", "body": "b", "locked": ["x"]}], 'joints.0.body = "b": no such body; allowed: a'),
    ([{"kind": "lok", "body": "a"}], "joints.0.kind = 'lok': must be 'lock', 'steady'"),
    ([{"kind": "lock", "body": "a", "locked": ["turn"]}], "must be 'x', 'y', 'z', 'turn_x'"),
    ([{"kind": "steady", "body": "a"}, {"kind": "lock", "body": "a", "locked": ["x"]}], 'kind "steady" already'),
    ([{"kind": "pendulum", "body": "a", "pivot": [0.5, 0.5, 0.5]}], "is the centre of the body"),
    ([{"kind": "schedule", "body": "a", "rows": [[0.0, 0, 0, 0], [0.0, 1, 0, 0]]}], "must grow from row to row"),
    ([{"kind": "schedule", "body": "a", "rows": [[0.0, 0, 0, 0], [1.0, 1, 0, 0, 3]]}], "each has 4 numbers"),
    ([{"kind": "swing", "body": "a", "pivot": [0, 0, 0], "axis": [0, 0, 0], "speed": 1.0}], "has no direction"),
    ([{"kind": "spring", "body": "a", "to": [0, 0, 0], "line_to": [0, 0, 0], "stiffness": 1.0}], "leave it out"),
    ([{"kind": "spring", "body": "a", "to": [0, 0, 0], "stiffness": 0.0}], "joints.0.stiffness = 0.0: must be"),
])  # fmt: skip
def test_what_is_wrong_with_a_joint_is_told(joints, said):
    given = {
        "dimensions": 3,
        "box": {"max": [1.0, 1.0, 1.0]},
        "materials": WOOD,
        "bodies": [BODY],
        "run": {"until": 1.0},
    }
    with pytest.raises(InputError) as error:
        parse(given | {"joints": joints})
    assert said in str(error.value)


def test_a_plane_keeps_its_joints():
    body = BODY | {"shape": {"size": [0.1, 1.0, 0.1]}}
    given = {
        "dimensions": 2,
        "box": {"max": [1.0, 1.0, 1.0]},
        "materials": WOOD,
        "bodies": [body],
        "run": {"until": 1.0},
    }
    with pytest.raises(InputError, match="leads out of the plane"):
        parse(given | {"joints": [{"kind": "steady", "body": "a", "velocity": [0.0, 1.0, 0.0]}]})
    late = [[0.0, 0, 0, 0], [5.0, 0.1, 0, 0], [6.0, 0.1, 0.2, 0]]
    turned = [[0.0, 0, 0, 0], [5.0, 0.1, 0, 0, 0, 10.0, 0], [6.0, 0.1, 0, 0, 0, 0, 5.0]]
    for key, words in (
        ("amplitude", {"kind": "sway", "amplitude": [0.0, 0.01, 0.0], "frequency": 10.0}),
        ("turn", {"kind": "sway", "turn": [5.0, 0.0, 0.0], "frequency": 10.0}),
        ("rows.2", {"kind": "schedule", "rows": late}),
        ("rows.2", {"kind": "schedule", "rows": turned}),
        ("axis", {"kind": "swing", "pivot": [0.5, 0.5, 0.5], "axis": [1.0, 0.0, 0.0], "speed": 1.0}),
        ("spin", {"kind": "steady", "spin": [0.0, 0.0, 1.0]}),
    ):
        with pytest.raises(InputError, match=rf"joints.0.{key} = .*leads out of the plane"):
            parse(given | {"joints": [words | {"body": "a"}]})
    for words in (
        {"kind": "sway", "amplitude": [0.1, 0.0, 0.1], "turn": [0.0, 5.0, 0.0], "frequency": 1.0},
        {"kind": "schedule", "rows": [[0.0, 0, 0, 0], [1.0, 0.1, 0, 0.1, 0, 9.0, 0]]},
        {"kind": "swing", "pivot": [0.1, 0.0, 0.2], "axis": [0.0, -2.0, 0.0], "speed": 1.0},
        {"kind": "steady", "velocity": [1.0, 0.0, 1.0], "spin": [0.0, 1.0, 0.0]},
    ):
        parse(given | {"joints": [words | {"body": "a"}]})
    with pytest.raises(InputError, match="each has 4 numbers"):
        parse(given | {"joints": [{"kind": "schedule", "body": "a", "rows": [[0.0, 0, 0, 0], [1.0, 0, 0, 0, 0]]}]})
    with pytest.raises(InputError, match="y must be 0.5 in a 2D case"):
        parse(given | {"joints": [{"kind": "spring", "body": "a", "to": [0.5, 0.0, 0.0], "stiffness": 1.0}]})
    with pytest.raises(InputError, match="pivot = .*: y must be 0.5 in a 2D case"):
        parse(given | {"joints": [{"kind": "pendulum", "body": "a", "pivot": [0.5, 0.0, 0.9]}]})
    with pytest.raises(InputError, match="must begin with zero"):
        parse(given | {"joints": [{"kind": "schedule", "body": "a", "rows": [[0.0, 0.1, 0, 0], [1.0, 0.2, 0, 0]]}]})
    assert len(JOINTS) == 7


def test_a_schedule_is_read_where_it_is_and_not_all_of_it():
    rows = tuple(
        (0.1 * k, math.sin(k), 0.0, math.cos(k) - 1.0, 0.0, 3.0 * k, 0.0)[: 4 + 3 * (k % 2)] for k in range(50)
    )
    table = ScheduleTable(kind="schedule", body="a", rows=rows)
    every = np.array([(*row, *(0.0,) * (7 - len(row))) for row in rows])
    for time in (*every[:, 0], -1.0, 0.05, 2.34, 4.89999, 7.0):
        exact = [np.interp(time, every[:, 0], column) for column in every[:, 1:].T]
        pose = table.pose(time, np.zeros(3))
        assert [*pose.shift, *pose.turn] == [*exact[:3], *np.radians(exact[3:])]
    asked = []

    class Row(tuple):
        __slots__ = ()

        def __getitem__(self, at):
            asked.append(at)
            return super().__getitem__(at)

        def __iter__(self):
            asked.append(self)
            return super().__iter__()

    many = ScheduleTable.model_construct(rows=tuple(Row((float(k), 0.0, 0.0, 0.0)) for k in range(4096)))
    assert not many.pose(1234.5, np.zeros(3)).shift.any() and len(asked) < 30


def test_an_axis_of_any_length_is_a_direction():
    small, large = (
        SwingTable(kind="swing", body="a", pivot=(0.0, 0.0, 0.0), axis=(0.0, length, 0.0), speed=1.0)
        for length in (1e-200, 1.0)
    )
    centre = np.array([0.3, 0.5, 0.1])
    assert (small.pose(0.7, centre).shift == large.pose(0.7, centre).shift).all()
