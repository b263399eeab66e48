"""Laws of contact against closed forms: how deep, how long, how fast off, and that none makes energy."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from contact_cases import FLAT, HALF, MASS, boxes, budget, case, go

from parsim.case.contacts import Pair
from parsim.case.model import load
from parsim.errors import InputError
from parsim.geometry.rotation import from_angles
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.laws import DEFAULT, LAWS
from parsim.solid.laws.hertz import HertzLaw
from parsim.solid.laws.impulse import ImpulseLaw
from parsim.solid.laws.law import compliance, damping_of
from parsim.solid.laws.spring import SpringLaw
from parsim.solid.shapes import SphereShape

WEIGHTLESS, YOUNG = (0.0, 0.0, 0.0), 1e7
HERTZ, SPRING = HertzLaw(kind="hertz"), SpringLaw(kind="spring", stiffness=2e4)
LAWS_HERE = DEFAULT, HERTZ, SPRING
HALF_SPACE = 1.0 / compliance(*[SimpleNamespace(young=YOUNG, poisson=0.4)] * 2)
RADIUS, SPEED = 0.025, 0.5


def bounce(bodies, law, dt=2e-5, **options):
    """Until it flies again: (deepest, m, time of contact, s, speed over that before, share of the budget kept)."""
    contacts = Contacts(bodies, case(gravity=WEIGHTLESS, young=YOUNG, law=law, **options))
    start, height, before = bodies.position[0, 2], bodies.position[0, 2], budget(bodies, contacts, WEIGHTLESS)
    lowest, touching, lasted = height, False, 0
    for _ in range(4000):
        go(bodies, contacts, dt, 1)
        lowest, touching = min(lowest, bodies.position[0, 2]), contacts.count > 0
        lasted += touching
        if lasted and not touching:
            break
    kept = budget(bodies, contacts, WEIGHTLESS) / before
    return start - lowest, lasted * dt, bodies.velocity[0, 2] / SPEED, kept


def ball(gap=0.0):
    shape = SphereShape(kind="sphere", diameter=2.0 * RADIUS)
    return Bodies([shape], [0.06], [(0.5, 0.5, RADIUS + gap)], velocity=[(0.0, 0.0, -SPEED)])


def test_laws_stand_in_the_order_of_their_numbers():
    assert [law.NUMBER for law in LAWS] == list(range(len(LAWS)))


def test_a_ball_on_a_floor_is_hertz():
    """Depth and time of contact of two half-spaces (Johnson 1985, eqs 11.23, 11.24)."""
    deep, lasted, rebound, kept = bounce(ball(), HERTZ, restitution=1.0, steps=100)
    exact = (15.0 * 0.06 * SPEED**2 / (16.0 * HALF_SPACE * math.sqrt(RADIUS))) ** 0.4
    assert deep == pytest.approx(exact, rel=2e-3)
    assert lasted == pytest.approx(2.94 * exact / SPEED, rel=0.01)
    assert rebound == pytest.approx(1.0, abs=2e-3)
    assert kept == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_a_ball_on_a_spring_swings_half_a_period(gap):
    deep, lasted, rebound, _ = bounce(ball(gap), SPRING, restitution=1.0, steps=100)
    assert deep - gap == pytest.approx(SPEED * math.sqrt(0.06 / 2e4), rel=2e-3)
    assert lasted == pytest.approx(math.pi * math.sqrt(0.06 / 2e4), rel=0.02)
    assert rebound == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("law", LAWS_HERE, ids=lambda law: law.kind)
@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.85])
@pytest.mark.parametrize("form", ["ball", "block"])
def test_every_law_rebounds_by_the_restitution_asked_for(law, restitution, form):
    block = Bodies(boxes(HALF), [MASS], [(0.5, 0.5, HALF[2])], quaternion=[FLAT], velocity=[(0.0, 0.0, -SPEED)])
    rebound = bounce(ball() if form == "ball" else block, law, restitution=restitution, steps=80)[2]
    assert rebound == pytest.approx(restitution, rel=0.02, abs=0.005)


def test_a_face_on_a_floor_is_a_flat_punch():
    block = Bodies(boxes(HALF), [MASS], [(0.5, 0.5, HALF[2])], velocity=[(0.0, 0.0, -SPEED)])
    deep = bounce(block, HERTZ, restitution=1.0, steps=100)[0]
    stiffness = 2.0 * HALF_SPACE * math.sqrt(4.0 * HALF[0] * HALF[1] / math.pi)
    assert deep == pytest.approx(SPEED * math.sqrt(MASS / stiffness), rel=2e-3)


@pytest.mark.parametrize("law", LAWS_HERE, ids=lambda law: law.kind)
def test_no_law_makes_energy(law):
    touched = 0
    for seed in range(30):
        random = np.random.default_rng(seed)
        count = int(random.integers(2, 5))
        shapes = [
            SphereShape(kind="sphere", diameter=random.uniform(0.02, 0.06))
            if random.random() < 0.5
            else boxes(random.uniform(0.01, 0.03, 3))[0]
            for _ in range(count)
        ]
        away = random.uniform(-0.06, 0.06, (count, 3))
        bodies = Bodies(
            shapes,
            [900.0 * shape.volume for shape in shapes],
            (0.5, 0.5, 0.1) + away,
            quaternion=[from_angles(random.uniform(-90.0, 90.0, 3)) for _ in range(count)],
            velocity=random.normal(0.0, 0.5, (count, 3)) - 20.0 * away,
            spin=random.normal(0.0, 10.0, (count, 3)),
        )
        contacts = Contacts(bodies, case(restitution=random.uniform(0.1, 1.0), law=law))
        start = budget(bodies, contacts)
        for step in range(40):
            contacts.step(bodies, np.zeros((count, 6)), step * 5e-4, min(5e-4, contacts.limit()))
            held = bodies.kinetic_energy() + bodies.potential_energy((0.0, 0.0, -9.81)) + contacts.elastic_energy()
            assert held <= start + 1e-6 * abs(start) + 1e-9, (seed, step)
        touched += contacts.overlap > 0.0
    assert touched > 15


@pytest.mark.parametrize("law", LAWS_HERE, ids=lambda law: law.kind)
def test_a_narrow_contact_is_soft_whatever_the_law(law):
    """Boxes that overlap by 10 um sideways hardly feel each other, and rest on 1 mm without a jump."""
    forces = []
    for across in (0.03, 1e-5):
        bodies = Bodies(
            boxes(*[(0.02, 0.02, 0.02)] * 2),
            [0.1] * 2,
            [(0.5, 0.5, 0.5), (0.54 - across, 0.5, 0.5399)],
            fixed=[True, False],
            velocity=[(0.0, 0.0, 0.0), (0.0, 0.0, -0.5)],
        )
        contacts = Contacts(bodies, case(gravity=WEIGHTLESS, young=YOUNG, law=law))
        contacts.step(bodies, np.zeros((2, 6)), 0.0, 1e-6)
        forces.append(bodies.contact_load[1, 2])
    assert forces[0] > 0.0 and forces[1] < 2e-3 * forces[0]
    bodies = Bodies(
        boxes(*[(0.02, 0.02, 0.02)] * 3),
        [0.1] * 3,
        [(0.461, 0.5, 0.5), (0.539, 0.5, 0.5), (0.5, 0.5, 0.54)],
        fixed=[True, True, False],
    )
    contacts = Contacts(bodies, case(restitution=0.3, young=1e8, law=law))
    go(bodies, contacts, 1e-4, 3000)
    assert bodies.position[2, 2] == pytest.approx(0.54, abs=6e-4), "no more than springs as soft let it"
    assert np.abs(bodies.velocity[2]).max() < 1e-3


@pytest.mark.parametrize("law", [*LAWS_HERE, ImpulseLaw(kind="impulse")], ids=lambda law: law.kind)
@pytest.mark.parametrize("slope", [2.0, 8.0])
def test_rolling_friction_holds_a_ball_to_its_angle_and_slows_it_above(law, slope):
    """Held while tan a < mu_r; above, m a = m g (sin a - mu_r cos a) / 1.4 for a ball that does not slip."""
    a, rolling = math.radians(slope), 0.1
    down = (9.81 * math.sin(a), 0.0, -9.81 * math.cos(a))
    shape = SphereShape(kind="sphere", diameter=2.0 * RADIUS)
    rolls = Bodies([shape], [0.06], [(0.3, 0.5, RADIUS)])
    contacts = Contacts(rolls, case(gravity=down, law=law, friction=0.6, restitution=0.3, rolling=rolling))
    before = budget(rolls, contacts, down)
    go(rolls, contacts, 5e-4, 400)
    wound = rolls.velocity[0, 0]
    go(rolls, contacts, 5e-4, 400, time=0.2)
    exact = max(9.81 * (math.sin(a) - rolling * math.cos(a)) / 1.4, 0.0)
    assert rolls.velocity[0, 0] - wound == pytest.approx(0.2 * exact, rel=0.02, abs=1e-3), "held it rocks for a while"
    assert budget(rolls, contacts, down) == pytest.approx(before, abs=2e-3 * abs(before) + 1e-6)


def test_a_pair_of_materials_may_have_its_own_restitution_and_friction():
    given = case(restitution=0.9, friction=0.5)
    given.materials["rail"] = SimpleNamespace(
        young=YOUNG, poisson=0.4, friction=0.1, restitution=0.3, rolling=0.0, crushing_strength=None
    )
    given.contacts.pairs = (Pair(between=("rail", "ice"), restitution=0.2),)
    law = Contacts(Bodies([], [], []), given)._pair_law
    assert law[1, 0, 1] == law[1, 1, 0] == damping_of(0.2) and law[1, 0, 0] == damping_of(0.9)
    assert law[2, 0, 1] == pytest.approx(0.3), "left out it is the mean"
    name, pair = "cases/floating_block/block.toml", 'contacts.pairs=[{between=["polypropylene", "%s"], friction=0.1}]'
    assert load(name, [pair % "polypropylene"]).contacts.pairs[0].friction == 0.1
    with pytest.raises(
        InputError, match='contacts.pairs.0.between = "polypropilene": no such material; .* did you mean'
    ):
        load(name, [pair % "polypropilene"])
    twice = '{between=["polypropylene", "polypropylene"]}'
    with pytest.raises(InputError, match="contacts.pairs.1.between = .*: is given already"):
        load(name, [f"contacts.pairs=[{twice}, {twice}]"])


def test_a_law_is_chosen_in_the_case():
    name = "cases/floating_block/block.toml"
    assert load(name, ['contacts.law={kind="spring", stiffness=1e5}']).contacts.law.stiffness == 1e5
    with pytest.raises(InputError, match="contacts.law.stiffness: missing; stiffness of a contact, N/m"):
        load(name, ['contacts.law={kind="spring"}'])
    assert load(name, ["contacts.law=hertz"]).contacts.law == HERTZ
    for wrong in ('{kind="herz"}', "herz", "3"):
        with pytest.raises(InputError, match="must be 'foundation', 'hertz', 'spring' or 'impulse'"):
            load(name, [f"contacts.law={wrong}"])
    with pytest.raises(InputError, match="contacts.law.stiffness: belongs to kind = 'spring'; allowed: kind, depth"):
        load(name, ["contacts.law={stiffness=1e5}"])


@pytest.mark.parametrize("law", LAWS_HERE, ids=lambda law: law.kind)
@pytest.mark.parametrize(("half", "elements"), [(0.05, 9), (0.0026, 441)])
def test_a_face_rebounds_by_its_restitution_however_many_elements_it_has(law, half, elements):
    block = Bodies(boxes((0.05, 0.05, half)), [1.0], [(0.5, 0.5, half + 1e-4)], velocity=[(0.0, 0.0, -SPEED)])
    contacts, most = Contacts(block, case(gravity=WEIGHTLESS, young=YOUNG, law=law, restitution=0.5)), 0
    for step in range(4000):
        go(block, contacts, 1e-4, 1, time=1e-4 * step)
        most = max(most, contacts.count)
        if most and not contacts.count:
            break
    assert most == elements
    assert block.velocity[0, 2] / SPEED == pytest.approx(0.5, rel=0.002)


def _rebounds(count):
    """Apexes, m, of a damped Hertz ball dropped from 0.5 m, by its own equation and the method of Runge and Kutta."""
    stiff, beta, v, out = 4.0 / 3.0 * HALF_SPACE * math.sqrt(0.05), damping_of(0.8), -math.sqrt(9.81), []

    def rate(z, v):
        hard = stiff * math.sqrt(max(-z, 0.0))
        return v, max(-hard * z - 2.0 * beta * math.sqrt(1.25 * hard) * v, 0.0) - 9.81 if z < 0.0 else -9.81

    for _ in range(count):
        z, dt = 0.0, 1e-6
        while z <= 0.0 or v < 0.0:
            a = rate(z, v)
            b = rate(z + 0.5 * dt * a[0], v + 0.5 * dt * a[1])
            c = rate(z + 0.5 * dt * b[0], v + 0.5 * dt * b[1])
            d = rate(z + dt * c[0], v + dt * c[1])
            z += dt / 6.0 * (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0])
            v += dt / 6.0 * (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1])
        out.append(z + v * v / 19.62)
        v = -math.sqrt(19.62 * out[-1])
    return np.array(out)


@pytest.mark.parametrize(("steps", "within"), [(20, 2.5e-3), (160, 5e-4)])
def test_a_bouncing_ball_follows_its_own_equation(steps, within):
    """Robb 2016, sec. 5.1, with the law "hertz": closer with more steps a contact."""
    ball, before, apexes = Bodies([SphereShape(kind="sphere", diameter=0.1)], [1.0], [(0.5, 0.5, 0.55)]), 0.0, []
    contacts = Contacts(ball, case(law=HERTZ, restitution=0.8, steps=steps, young=YOUNG))
    for step in range(10000):
        go(ball, contacts, 2e-4, 1, time=2e-4 * step)
        speed, height = ball.velocity[0, 2], ball.position[0, 2] - 0.05
        if before > 0.0 >= speed:
            apexes.append(height + speed * speed / 19.62)
        before = speed
        if len(apexes) == 4:
            break
    assert apexes == pytest.approx(_rebounds(4), rel=within)


def oblique(theta, law, mu=0.092, e=0.98, radius=0.0025, speed=3.9):
    """Spin after a hit at `theta`, degrees from the normal, over (1 + e) mu v_n / (2 R): Thornton's measure."""
    a = math.radians(theta)
    along, into = speed * math.sin(a), speed * math.cos(a)
    shape = SphereShape(kind="sphere", diameter=2.0 * radius)
    hit = Bodies([shape], [2.6e-4], [(0.5, 0.5, radius + 1e-6)], velocity=[(along, 0.0, -into)])
    contacts = Contacts(hit, case(gravity=WEIGHTLESS, young=7e10, law=law, friction=mu, restitution=e, steps=80))
    for _ in range(400):
        go(hit, contacts, 1e-6, 1)
        if hit.velocity[0, 2] > 0.0 and not contacts.count:
            break
    return -2.0 * radius * hit.spin[0, 1] / ((1.0 + e) * mu * into)


THORNTON = [  # impact angle 2 tan(theta) / ((1 + e) mu) and spin of an elastic sphere (Vyas et al. 2021, digitised)
    (0.284, -0.076), (0.977, -0.479), (1.806, -1.514), (2.748, -2.724), (3.677, -3.771),
    (4.707, -4.620), (5.756, -5.012), (7.008, -4.989), (8.416, -5.009), (9.967, -4.996),
]  # fmt: skip


def test_a_ball_that_hits_obliquely_turns_as_thornton_says():
    angles, spins = np.transpose(THORNTON)
    turns = [oblique(math.degrees(math.atan(0.5 * angle * 1.98 * 0.092)), HERTZ) for angle in angles]
    assert turns == pytest.approx(spins, abs=0.2)


@pytest.mark.parametrize("law", [DEFAULT, HERTZ, SpringLaw(kind="spring", stiffness=2e8)], ids=lambda law: law.kind)
def test_a_ball_that_hits_obliquely_slides_or_sticks(law):
    """Chung & Ooi 2011, test 4: -5 where it slides all through; with less of an angle it turns less, smoothly."""
    assert [oblique(theta, law) for theta in (35.0, 50.0, 65.0, 75.0)] == pytest.approx([-5.0] * 4, rel=0.01)
    turns = np.array([oblique(theta, law) for theta in np.arange(2.0, 32.0, 3.0)])
    assert (np.diff(turns) <= 0.01).all() and np.abs(np.diff(turns)).max() < 1.0
