"""Ice that is crushed at a pressure: forces at most that over the area, the energy spent, the impulse unchanged."""

import math

import numpy as np
import pytest
from contact_cases import FLAT, HALF, MASS, budget, case, go
from test_laws import LAWS_HERE, SPEED, WEIGHTLESS, YOUNG, ball

from parsim.case.contacts import Material
from parsim.case.model import load
from parsim.errors import InputError
from parsim.solid.bodies import Bodies
from parsim.solid.contacts import Contacts
from parsim.solid.laws import DEFAULT
from parsim.solid.laws.law import compliance
from parsim.solid.shapes import BoxShape

AREA, STRENGTH, DT = 4.0 * HALF[0] * HALF[1], 2e4, 1e-5
MATERIAL = Material(young=YOUNG, poisson=0.4, friction=0.4, restitution=0.8)
RIGID = 1.0 / (compliance(MATERIAL, MATERIAL) * HALF[2])  # of the default law, Pa/m


def hit(bodies, **options):
    """Until it flies again: (deepest, m, largest force, N, impulse, N s, speed after, m/s, shares of the budget)."""
    contacts = Contacts(bodies, case(gravity=WEIGHTLESS, young=YOUNG, steps=80, **options))
    start, before = bodies.position[0, 2], budget(bodies, contacts, WEIGHTLESS)
    deepest = largest = impulse = 0.0
    shares = []
    for _ in range(4000):
        go(bodies, contacts, DT, 1)
        force = bodies.contact_load[0, 2]
        deepest, largest = max(deepest, start - bodies.position[0, 2]), max(largest, force)
        impulse += force * DT
        shares.append(budget(bodies, contacts, WEIGHTLESS) / before)
        if len(shares) > 10 and force == 0.0:
            break
    return deepest, largest, impulse, bodies.velocity[0, 2], shares


def block(speed=SPEED, half=HALF):
    shape = BoxShape(size=tuple(2.0 * h for h in half))
    return Bodies([shape], [MASS], [(0.5, 0.5, half[2])], quaternion=[FLAT], velocity=[(0.0, 0.0, -speed)])


def test_a_face_is_crushed_at_its_strength():
    """Elastic to the depth p / k, then a constant force p A; it flies off with what the foundation still holds."""
    deepest, largest, impulse, speed, shares = hit(block(), restitution=1.0, strength=STRENGTH)
    elastic = STRENGTH / RIGID
    held = 0.5 * RIGID * AREA * elastic**2
    exact = elastic + (0.5 * MASS * SPEED**2 - held) / (STRENGTH * AREA)
    assert exact > 3.0 * elastic
    assert deepest == pytest.approx(exact, rel=0.01)
    assert largest == pytest.approx(STRENGTH * AREA, rel=1e-9)
    assert speed == pytest.approx(math.sqrt(2.0 * held / MASS), rel=0.01)
    assert impulse == pytest.approx(MASS * (SPEED + speed), rel=0.01)
    assert min(shares) > 1.0 - 1e-9 and max(shares) < 1.0 + 1e-9, "what crushing takes is counted as dissipated at once"


@pytest.mark.parametrize("law", LAWS_HERE, ids=lambda law: law.kind)
@pytest.mark.parametrize("form", [ball, block])
def test_no_force_is_more_than_strength_and_area_allow(law, form):
    """What is round: the area of its cap. Weaker material rebounds slower; none makes energy."""
    whole = hit(form(), law=law, restitution=0.9)
    area = {block: lambda deepest: AREA, ball: lambda deepest: math.pi * 0.025 * deepest}[form]
    strengths = [share * whole[1] / area(whole[0]) for share in (0.5, 0.1)]
    weaker = [hit(form(), law=law, restitution=0.9, strength=strength) for strength in strengths]
    for (deepest, largest, impulse, speed, shares), strength in zip(weaker, strengths, strict=True):
        assert largest <= strength * area(deepest) * 1.001  # sub-steps go deeper than what is seen of them
        assert min(shares) > 1.0 - 1e-9 and max(shares) < 1.0 + 1e-9
        assert impulse == pytest.approx(form().mass[0] * (SPEED + speed), rel=0.02)
    assert whole[3] > weaker[0][3] > weaker[1][3] >= 0.0
    assert whole[0] < weaker[0][0] < weaker[1][0]


def test_two_bodies_are_crushed_as_the_weaker_of_them():
    pair = Bodies(
        [BoxShape(size=tuple(2.0 * h for h in HALF))] * 2,
        [MASS] * 2,
        [(0.5, 0.5, 0.5 + 2.0 * HALF[2]), (0.5, 0.5, 0.5)],
        quaternion=[FLAT] * 2,
        velocity=[(0.0, 0.0, -SPEED), (0.0, 0.0, SPEED)],
    )
    parts = case(gravity=WEIGHTLESS, young=YOUNG, steps=80, strength=STRENGTH)
    contacts, most = Contacts(pair, parts), 0.0
    for _ in range(2000):
        go(pair, contacts, DT, 1)
        most = max(most, pair.contact_load[0, 2])
    assert most == pytest.approx(STRENGTH * AREA, rel=1e-6)
    np.testing.assert_allclose(pair.velocity.sum(axis=0), 0.0, atol=1e-12)


def test_what_is_crushed_is_remembered():
    """A checkpoint amid the contact goes on with the same bits."""
    parts = case(gravity=WEIGHTLESS, young=YOUNG, steps=80, strength=STRENGTH)
    one, other = block(), block()
    contacts = Contacts(one, parts)
    go(one, contacts, DT, 40)
    assert contacts.count
    again = Contacts(other, parts)
    other.restore(one.kept())
    again.restore(contacts.kept())
    go(one, contacts, DT, 300)
    go(other, again, DT, 300)
    np.testing.assert_array_equal(one.position, other.position)
    np.testing.assert_array_equal(one.velocity, other.velocity)


def test_strength_is_nothing_for_contacts_without_time():
    message = r'materials\.rubber\.crushing_strength = 1000000\.0: contacts of the law "impulse" take no time'
    with pytest.raises(InputError, match=message):
        load("cases/bouncing_sphere/impulse.toml", ["materials.rubber.crushing_strength=1e6"])


def test_an_unknown_strength_changes_nothing():
    """The same bits as without the key: nothing is ever crushed."""
    assert DEFAULT.kind == "foundation"
    never, strong = hit(block()), hit(block(), strength=1e12)
    assert never == strong
