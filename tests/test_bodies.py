"""Rigid bodies against exact results: mass, pose, surface, and the free rotor."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from contact_cases import boxes, case, go

from parsim.case.places import rotation
from parsim.geometry.rotation import from_angles, matrices
from parsim.solid.bodies import Bodies, from_case
from parsim.solid.contacts import Contacts
from parsim.solid.shapes import BoxShape

INERTIA = (1.0, 2.0, 3.0)


def rotor(spin=(0.01, 1.0, 0.01)):
    """A body of principal moments 1, 2, 3 kg m2."""
    bodies = Bodies(boxes((1.0, 1.0, 1.0)), [1.0], [(0.0, 0.0, 0.0)], spin=[spin])
    bodies.inertia[:] = INERTIA
    return bodies


def momentum(bodies):
    turn = matrices(bodies.quaternion)
    return np.array([r @ (i * (r.T @ w)) for r, i, w in zip(turn, bodies.inertia, bodies.spin, strict=True)])


def turn_freely(bodies, dt, steps):
    """Spins in the body frame after each step of free rotation, (steps + 1, 3)."""
    conserved, spins = momentum(bodies)[0], []
    for step in range(steps + 1):
        turn = matrices(bodies.quaternion)[0]
        bodies.spin[0] = turn @ ((turn.T @ conserved) / bodies.inertia[0])
        spins.append(turn.T @ bodies.spin[0])
        if step < steps:
            _, bodies.quaternion = bodies.drifted(dt)
    return np.array(spins)


def euler_reference(spin, time, steps):
    """Body-frame spin by Runge-Kutta of order 4 of Euler's equations."""
    i1, i2, i3 = INERTIA

    def rate(w):
        return np.array([(i2 - i3) * w[1] * w[2] / i1, (i3 - i1) * w[2] * w[0] / i2, (i1 - i2) * w[0] * w[1] / i3])

    w, dt = np.array(spin), time / steps
    for _ in range(steps):
        a = rate(w)
        b = rate(w + dt / 2 * a)
        c = rate(w + dt / 2 * b)
        w = w + dt / 6 * (a + 2 * b + 2 * c + rate(w + dt * c))
    return w


def test_mass_properties_of_a_box():
    bodies = Bodies(boxes((0.5, 1.0, 1.5)), [6.0], [(1.0, 2.0, 3.0)])
    assert bodies.volume[0] == 6.0
    assert bodies.inertia[0] == pytest.approx([6 * (4 + 9) / 12, 6 * (1 + 9) / 12, 6 * (1 + 4) / 12], rel=1e-15)
    assert bodies.potential_energy((0.0, 0.0, -9.81)) == pytest.approx(6 * 9.81 * 3, rel=1e-15)


def test_kinetic_energy_is_the_sum_over_points():
    bodies = Bodies(
        boxes((0.1, 0.2, 0.3)),
        [2.0],
        [(0.0, 0.0, 0.0)],
        quaternion=[from_angles((10, 20, 30))],
        velocity=[(1.0, 2.0, 3.0)],
        spin=[(4.0, -5.0, 6.0)],
    )
    nodes = np.array([-1.0, 1.0]) / math.sqrt(3.0)  # two Gauss points along each edge are exact for squares
    points = np.stack(np.meshgrid(nodes, nodes, nodes, indexing="ij"), -1).reshape(-1, 3) * bodies.forms.half
    at = points @ matrices(bodies.quaternion)[0].T
    speed = bodies.velocity[0] + np.cross(bodies.spin[0], at)
    assert bodies.kinetic_energy() == pytest.approx(0.5 * 2.0 / 8 * (speed**2).sum(), rel=1e-13)


def test_surface_is_closed_and_looks_outward():
    bodies = Bodies(
        boxes((0.1, 0.2, 0.3), (1.0, 1.0, 1.0)),
        [1.0, 2.0],
        [(1.0, 2.0, 3.0), (-5.0, 0.0, 0.0)],
        quaternion=[from_angles((10, 20, 30)), (1.0, 0.0, 0.0, 0.0)],
    )
    points, quads, body = bodies.surface()
    corner = points[quads]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    volumes = (cross * (corner.mean(axis=1) - bodies.position[body])).sum(axis=1) / 3
    assert [volumes[body == b].sum() for b in range(2)] == pytest.approx(bodies.volume)
    assert np.linalg.norm(points - bodies.position.repeat(8, 0), axis=1) == pytest.approx(
        np.linalg.norm(bodies.forms.half, axis=1).repeat(8)
    )
    assert np.bincount(quads.ravel()).tolist() == [3] * 16


def test_angles_turn_about_fixed_axes_in_order():
    assert matrices(from_angles((10.0, 20.0, 30.0))[None])[0] == pytest.approx(rotation((10.0, 20.0, 30.0)), abs=1e-15)
    assert from_angles((0.0, 0.0, 0.0)).tolist() == [1.0, 0.0, 0.0, 0.0]


def test_drift_about_a_principal_axis_is_exact():
    bodies = Bodies(
        boxes((0.1, 0.2, 0.3)), [1.0], [(0.0, 0.0, 0.0)], velocity=[(1.0, 2.0, 3.0)], spin=[(0.0, 0.7, 0.0)]
    )
    position, quaternion = bodies.drifted(2.0)
    assert position[0] == pytest.approx((2.0, 4.0, 6.0))
    assert quaternion[0] == pytest.approx((math.cos(0.7), 0.0, math.sin(0.7), 0.0), abs=1e-15)
    assert (bodies.position == 0.0).all() and bodies.quaternion[0, 0] == 1.0


def test_free_rotor_keeps_momentum_and_energy():
    bodies = rotor()
    start, energy = momentum(bodies)[0], bodies.kinetic_energy()
    energies = []
    for w in turn_freely(bodies, 0.005, 16000):  # 80 s: two periods of the tumbling
        energies.append(0.5 * (w * w * INERTIA).sum())
    assert momentum(bodies)[0] == pytest.approx(start, abs=1e-13)
    assert abs(energies[-1] / energy - 1) < 1e-6
    assert max(abs(e / energy - 1) for e in energies) < 1e-5


def test_free_rotor_converges_to_euler():
    exact = euler_reference((0.01, 1.0, 0.01), 10.0, 4000)
    # Jacobi elliptic functions give the same: w1, w2, w3 at 10 s
    assert exact == pytest.approx((-0.874573438, 0.484996187, 0.505001221), abs=1e-8)
    coarse, fine = (np.abs(turn_freely(rotor(), 10.0 / n, n)[-1] - exact).max() for n in (400, 800))
    assert fine < 1e-3
    assert 3.8 < coarse / fine < 4.2


def test_from_case():
    shape = BoxShape(size=(0.2, 0.4, 0.6))
    body = {
        "shape": shape,
        "position": (1.0, 2.0, 3.0),
        "angles": (0.0, 0.0, 90.0),
        "velocity": (1.0, 0.0, 0.0),
        "spin": (0.0, 0.0, 1.0),
        "material": "ice",
        "fixed": False,
        "released": None,
        "enters": False,
    }
    bodies = (SimpleNamespace(name="a", **body), SimpleNamespace(name="b", **body | {"released": 1.0}))
    case = SimpleNamespace(
        bodies=bodies, joints=(), materials={"steel": None, "ice": None}, dimensions=3, mass_of=lambda body: 5.0
    )
    made = from_case(case)
    assert made.names == ["a", "b"] and made.material.tolist() == [1, 1] and made.mass.tolist() == [5.0, 5.0]
    assert made.forms.half[0] == pytest.approx((0.1, 0.2, 0.3))
    assert made.held(0.5).tolist() == [False, True] and made.held(1.0).tolist() == [False, False]
    assert made.velocity.tolist() == [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    assert made.surface_speed() == pytest.approx(1.0 + math.sqrt(0.14))


def test_no_bodies():
    none = Bodies([], [], [])
    assert len(none) == 0 and none.kinetic_energy() == 0.0 and none.surface_speed() == 0.0
    assert [a.shape for a in none.surface()] == [(0, 3), (0, 4), (0,)]


def test_the_metre_across_a_plane_does_not_count_as_a_radius():
    """Else a small box that spins in 2D is told to be as fast as sound, and makes the step small."""
    made = [Bodies(boxes((0.01, 0.5, 0.02)), 1.0, [[0.0, 0.5, 0.0]], spin=[[0.0, 30.0, 0.0]], planar=flat)
             for flat in (True, False)]  # fmt: skip
    reach = [np.hypot(0.01, 0.02), np.sqrt(0.01**2 + 0.5**2 + 0.02**2)]
    assert [box.surface_speed() for box in made] == pytest.approx(30.0 * np.array(reach))
    assert [box.surface_acceleration() for box in made] == pytest.approx(900.0 * np.array(reach))


@pytest.mark.long
def test_a_rotor_keeps_its_energy_for_a_hundred_thousand_steps():
    """Tumbling about the middle axis: bounded by the square of the step, without drift."""
    body = Bodies([BoxShape(size=(0.08, 0.06, 0.02))], [1.0], [(0.5, 0.5, 0.5)], spin=[(0.3, 5.0, 0.2)])
    contacts, energy = Contacts(body, case(gravity=(0.0, 0.0, 0.0), walls=())), []
    for step in range(100_000):
        go(body, contacts, 1e-3, 1, time=1e-3 * step)
        energy.append(body.kinetic_energy())
    error = np.array(energy) / energy[0] - 1.0
    assert np.abs(error).max() < 4e-7
    assert abs(error[-20_000:].mean() - error[:20_000].mean()) < 1e-8
