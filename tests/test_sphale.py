"""The sweeps of SPH-ALE against slow plain versions, exact solutions and conservation."""

import numpy as np
import pytest
from clouds import PLAIN, cloud, listed

from parsim.fluid.sphale import loads, riemann, sweeps, tables
from parsim.fluid.weights import WEIGHTS
from parsim.particles.tables import Vectors

SIZE, RE = np.array([1.3, 0.9, 0.7]), 0.2
DENSITY, SOUND = 1000.0, 20.0
MODULUS, IMPEDANCE = DENSITY * SOUND**2, DENSITY * SOUND
GRAVITY = np.array([0.3, -0.2, -9.81])
CONSTANTS = tables.Constants(
    over=1.7,
    volume=0.002,
    density=DENSITY,
    modulus=MODULUS,
    impedance=IMPEDANCE,
    drag=0.01,
    least=0.1,
    ease=3.0 / SOUND,
    even=1.0,
    gx=GRAVITY[0],
    gy=GRAVITY[1],
    gz=GRAVITY[2],
    hx=DENSITY * GRAVITY[0],
    hy=DENSITY * GRAVITY[1],
    hz=DENSITY * GRAVITY[2],
    spread=0.5,
    own=1.0,
    whole=30.0,
    flat=0.0,
)
WATER = DENSITY, MODULUS, IMPEDANCE, 1.0, 0.0  # with the whole jump of pressure


def vectors(array):
    """Rows of (3, n) as kernels take them."""
    return Vectors(*(np.ascontiguousarray(row) for row in array))


class Cloud:
    """Random water and walls with random fields, as arrays and as the sweeps take them."""

    def __init__(self, walls, weight="wendland_c2"):
        domain, self.near = listed(cloud(400, SIZE, seed=4, walls=walls), SIZE, RE)
        p, rng = domain.particles, np.random.default_rng(8)
        self.p, n = p, len(p)
        self.weight, self.plain = WEIGHTS[weight].of_radius(RE), PLAIN[weight]
        self.frame, self.slope = 0.1 * rng.normal(size=(3, n)), rng.normal(size=(4, 3, n)) * 3.0
        self.slope[0] *= 1e3
        self.acceleration, normal = rng.normal(size=(3, n)), rng.normal(size=(3, n))
        self.normal = normal / np.sqrt((normal**2).sum(0))
        self.state = tables.State(
            p.place, p.velocity, vectors(self.frame), rng.normal(size=n) * 1e3, rng.uniform(0.8, 1.2, n) * 0.002
        )
        self.slopes = tables.Slopes(*(vectors(rows) for rows in self.slope))
        self.solid = tables.Solid(p.scale, vectors(self.acceleration), vectors(self.normal))
        self.rates = tables.Rates(np.zeros(n), np.zeros(n), vectors(np.zeros((3, n))))

    def fluxes(self):
        """Rates of volume (n,), mass (n,) and momentum (n, 3)."""
        given = self.near.fluid, self.near.lists, self.state, self.slopes, self.solid, self.weight, CONSTANTS
        sweeps.fluxes(*given, self.rates)
        return self.rates.volume, self.rates.mass, np.stack(self.rates.momentum, 1)

    def reactions(self):
        """Forces (k, 3) on the samples that see water and how they depend on accelerations (k, 6)."""
        at = self.near.boundary
        out = tables.Reaction(np.empty((at.size, 3)), np.empty((at.size, 3)), np.empty((at.size, 6)))
        loads.reaction(at, self.near.lists, self.state, self.slopes, self.solid, self.weight, CONSTANTS, out)
        return out.force, out.response

    def pair(self, i, j):
        """Way from i to j (3,), and twice the volumes times the slope of the kernel over it."""
        place = np.stack(self.p.place, 1)
        way = place[j] - place[i]
        w, _ = self.plain(np.sqrt(way @ way), RE)
        return way, 2.0 * CONSTANTS.over * w / (way @ way)


def minmod(a, b):
    return np.where(a * b > 0.0, np.sign(a) * np.minimum(abs(a), abs(b)), 0.0)


def plain_rates(c, i):
    """Rates of particle i by the formulas, pair by pair."""
    near, s, velocity = c.near, c.state, np.stack(c.p.velocity, 1)
    volume, mass, momentum, frame = 0.0, 0.0, np.zeros(3), c.frame.T
    head = DENSITY * GRAVITY
    for j in near.index[near.start[i] : near.middle[i]].astype(int):
        way, g = c.pair(i, j)
        e, r = way / np.sqrt(way @ way), np.sqrt(way @ way)
        g *= s.omega[i] * s.omega[j]
        dq, dv = s.p[j] - s.p[i] - head @ way, velocity[j] - velocity[i]
        left, right = (
            (np.append(dq, dv), 2.0 * c.slope[:, :, i] @ way - np.append(dq, dv)),
            (np.append(dq, dv), 2.0 * c.slope[:, :, j] @ way - np.append(dq, dv)),
        )
        left, right = 0.5 * minmod(*left), 0.5 * minmod(*right)
        pl, pr = s.p[i] + 0.5 * head @ way + left[0], s.p[j] - 0.5 * head @ way - right[0]
        vl, vr = velocity[i] + left[1:], velocity[j] - right[1:]
        mean, jump = 0.5 * (pl + pr), (vl - vr) @ e
        z = IMPEDANCE * (1.0 + 4.0 * mean / MODULUS)
        p = mean + 0.5 * z * jump * min(max(3.0 / SOUND * jump, 0.1), 1.0)
        normal = 0.5 * (vl + vr) @ e + 0.5 * (pl - pr) / z
        rho = DENSITY * (1.0 + p / MODULUS - 3.0 * (p / MODULUS) ** 2)
        own, other = velocity[i] + frame[i], velocity[j] + frame[j]
        swap = (s.omega[i] - s.omega[j]) / (s.omega[i] + s.omega[j])
        flux = rho * (normal - 0.5 * (own + other) @ e + swap)
        upwind = vl if flux > 0.0 else vr
        upwind = upwind + (normal - upwind @ e) * e
        mass -= g * r * flux
        momentum -= g * (r * flux * upwind + p * way) - 0.5 * g * CONSTANTS.drag / r**2 * (dv @ way) * way
        volume += 0.5 * g * (other - own) @ way - g * r * swap
    for j in near.index[near.middle[i] : near.end[i]].astype(int):
        way, g = c.pair(i, j)
        g *= s.omega[i] * CONSTANTS.volume * c.p.scale[j]
        momentum -= g * wall_pressure(c, i, j, way) * way
        volume += g * (velocity[j] - velocity[i] - frame[i]) @ way
    return volume, mass, momentum


def wall_pressure(c, i, j, way):
    velocity, n = np.stack(c.p.velocity, 1), c.normal[:, j]
    across, along = (velocity[j] - velocity[i]) @ n, c.slope[1:, :, i] @ way @ n
    jump = across - minmod(across, along - across)
    share = min(2.0 * max(-way @ n / np.sqrt(way @ way), 0.0), 1.0) * min(max(3.0 / SOUND * jump, 0.03), 1.0)
    z = IMPEDANCE * (1.0 + 4.0 * c.state.p[i] / MODULUS)
    return c.state.p[i] + 0.5 * DENSITY * (GRAVITY - c.acceleration[:, j]) @ way + share * z * jump


@pytest.mark.parametrize("weight", ["wendland_c2", "wendland_c4"])
def test_fluxes_are_those_of_the_formulas(weight):
    c = Cloud(150, weight)
    volume, mass, momentum = c.fluxes()
    for i in c.near.fluid[::40]:
        wanted = plain_rates(c, i)
        assert volume[i] == pytest.approx(wanted[0], rel=1e-9, abs=1e-12)
        assert mass[i] == pytest.approx(wanted[1], rel=1e-9, abs=1e-9)
        assert momentum[i] == pytest.approx(wanted[2], rel=1e-9, abs=1e-8)


def test_what_one_particle_loses_the_others_gain():
    c = Cloud(0)
    _, mass, momentum = c.fluxes()
    assert abs(mass.sum()) < 1e-13 * abs(mass).sum()
    assert abs(momentum.sum(0)).max() < 1e-13 * abs(momentum).sum()


def test_what_samples_do_to_the_water_the_water_does_to_them():
    c = Cloud(150)
    _, mass, momentum = c.fluxes()
    force, _ = c.reactions()
    assert abs(mass.sum()) < 1e-13 * abs(mass).sum()
    assert abs(momentum.sum(0) + force.sum(0)).max() < 1e-13 * abs(momentum).sum()


def test_the_response_is_how_forces_on_samples_depend_on_their_accelerations():
    c = Cloud(150)
    before, response = c.reactions()
    change = np.array([0.3, -0.4, 0.2])
    for component, by in zip(c.solid.acceleration, change, strict=True):
        component[c.near.boundary] += by
    after, _ = c.reactions()
    xx, xy, xz, yy, yz, zz = response.T
    matrix = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), 2, 0)
    assert after - before == pytest.approx(-matrix @ change, rel=1e-6, abs=1e-9 * abs(before).max())
    assert np.linalg.eigvalsh(matrix).min() >= -1e-12 * matrix.max()


@pytest.mark.parametrize("flat", [0.0, 1.0])
def test_slopes_of_linear_fields_are_exact(flat):
    c = Cloud(150)
    constants = CONSTANTS._replace(flat=flat, over=9000.0)
    if flat:
        c.p.y[:] = 0.5
    place, wanted = np.stack(c.p.place, 1), np.random.default_rng(3).normal(size=(4, 3))
    if flat:
        wanted[:, 1] = 0.0
    hydrostatic = np.array([constants.hx, constants.hy, constants.hz])
    state = c.state._replace(p=place @ (wanted[0] + hydrostatic), velocity=vectors(wanted[1:] @ place.T))
    around = tables.Around(np.zeros(len(place)), vectors(np.zeros((3, len(place)))), vectors(np.zeros((3, len(place)))))
    out = tables.Slopes(*(vectors(np.zeros((3, len(place)))) for _ in range(4)))
    sweeps.slopes(c.near.fluid, c.near.lists, state, c.p.scale, c.weight, constants, out, around)
    found = np.array(out)[:, :, c.near.fluid]
    good = (abs(found - wanted[:, :, None]) < 1e-6 * (1.0 + abs(found).max())).all(axis=(0, 1))
    assert good.mean() > 0.8, "all but what has too few neighbours"


@pytest.mark.parametrize("pressures", [(2000.0, 1000.0), (0.0, 0.0), (-500.0, 800.0)])
@pytest.mark.parametrize("speeds", [(0.0, 0.0), (0.2, -0.1), (-0.1, 0.1)])
def test_the_state_between_two_particles_is_that_of_the_riemann_problem(pressures, speeds):
    """Exact: two waves of Tait's water, both isentropic, for shocks are so to the third order."""

    def density(p):
        return DENSITY * (1.0 + 7.0 * p / MODULUS) ** (1.0 / 7.0)

    def sound(p):
        return SOUND * (density(p) / DENSITY) ** 3

    def rise(p):
        """Change of the velocity across a wave from p = 0."""
        return (sound(p) - SOUND) / 3.0

    (pl, pr), (nl, nr) = pressures, speeds
    low, high = -2e4, 2e4
    for _ in range(80):
        p = 0.5 * (low + high)
        over = (nl - (rise(p) - rise(pl))) - (nr + (rise(p) - rise(pr)))
        low, high = (p, high) if over > 0.0 else (low, p)
    exact = nl - (rise(p) - rise(pl))
    found, normal, rho = riemann.interface((pl, nl), (pr, nr), WATER)
    wave = abs(pl) + abs(pr) + IMPEDANCE * abs(nl - nr)
    assert found == pytest.approx(p, abs=wave**2 / MODULUS + 1e-9), "of the second order"
    assert normal == pytest.approx(exact, abs=wave**2 / MODULUS / IMPEDANCE + 1e-12)
    assert rho == pytest.approx(density(found), rel=3e-5)


def test_a_moving_wall_makes_the_pressure_of_its_wave():
    still, up, meeting, whole = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.1), (*WATER[:3], 1.0, 3.0 / 0.1)
    found = riemann.wall_pressure(0.0, (0.0, 0.0, -0.01), 0.0, up, meeting, still, whole)
    assert found == pytest.approx(IMPEDANCE * 0.1)
    assert riemann.wall_pressure(500.0, (0.0, 0.0, 0.01), 0.0, up, meeting, still, whole) == 500.0, "it looks away"
    assert riemann.wall_pressure(500.0, (0.0, 0.0, -0.01), 0.0981, up, still, still, whole) == 500.0 + 49.05
    mirrored = (0.0, 0.0, 0.2)
    assert riemann.wall_pressure(0.0, (0.0, 0.0, -0.01), 0.0, up, meeting, mirrored, whole) == 0.0
