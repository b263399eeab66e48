"""The semi-implicit scheme: its equation against a plain one, water at rest, light bodies, and what it refuses."""

import numpy as np
import pytest
from clouds import PLAIN
from example_cases import PLANE
from flows import GRAVITY, WOOD, fluid, merged, simulation, tank
from test_light_bodies import ADDED

from parsim.case.model import load, parse
from parsim.errors import InputError, RunError
from parsim.fluid.simps.scheme import SIMPS
from parsim.fluid.simps.solver import Solver
from parsim.observe.energy import Energy
from parsim.observe.solver import Solver as Seen
from parsim.particles.state import INTERNAL, SURFACE, VICINITY
from parsim.solid.acceleration import Given, accelerate_bodies, mobilities

SPACING = 0.02
BLOCKS = [{"name": name, "shape": {"size": [0.08, 1.0, 0.08]}, "density": density, "position": [x, 0.5, z],
           "angles": [0.0, angle, 0.0], "material": "wood"}
          for name, density, x, z, angle in (("light", 1.0, 0.13, 0.2, 9.0), ("held", 5e2, 0.3, 0.1, 0.0))]  # fmt: skip
BLOCKS[1]["fixed"] = True


def still(spacing=SPACING, bodies=(), **scheme):
    """A tank 0.4 m long with 0.2 m of water, 2D."""
    data = tank(0.4, 0.4, spacing, fill=(0.4, 0.2)) | {"materials": WOOD, "bodies": list(bodies)}
    return merged(data, {"water": {"scheme": {"kind": "simps", **scheme}}})


@pytest.fixture(scope="module")
def asked():
    """What the solver is asked in the fourth step of a tank with a light and a held block, as it is then: a dict."""
    found, solve, assemble = {}, Solver.solve, SIMPS._assemble

    def look(self, flow, equation, mobility, factor, time):
        names = ("x", "z", "u", "w", "ax", "az", "p", "c", "n", "gx", "gz", "surface", "scale", "body")
        found.update({name: getattr(flow.particles, name).copy() for name in names})
        found.update(flow=flow, equation=equation, mobility=mobility, factor=factor, solver=self)
        found["right"], found["pairs"] = equation.right.copy(), equation.pairs.copy()
        found["diagonal"], found["index"] = equation.diagonal.copy(), flow.near.index.copy()
        return solve(self, flow, equation, mobility, factor, time)

    def note(self, flow, mobility, sides, dt):
        found["sides"] = sides
        return assemble(self, flow, mobility, sides, dt)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(SIMPS, "_assemble", note)
        patch.setattr(Solver, "solve", look)
        s = simulation(still(bodies=BLOCKS))
        for _ in range(4):
            s.step()
    return found | {"dt": s.dt, "lattice": s.scheme.lattice, "scheme": s.scheme}


def test_the_equation_is_that_of_a_plain_version(asked):
    a, lattice, dt, near = asked, asked["lattice"], asked["dt"], asked["flow"].near
    sides = a["sides"]
    laplacian = 4.0 / (lattice.spread * lattice.number)
    stiff, give = 1000.0 / (dt * dt * laplacian), 1.0 / (1000.0 * a["scheme"].sound ** 2)
    share = 0.5 * dt / a["scheme"].time_step(0.0, GRAVITY)
    kappa = {VICINITY: 4 / 3, SURFACE: a["scheme"]._kappa[0], INTERNAL: a["scheme"]._kappa[0]}
    classes = set()
    for i in near.fluid:
        j = near.index[near.start[i] : near.end[i]].astype(int)
        d, v = np.stack([a["x"][j] - a["x"][i], a["z"][j] - a["z"][i]], 1), np.stack([a["u"][j], a["w"][j]], 1)
        r = np.sqrt((d**2).sum(1))
        wt, _ = PLAIN["wendland_c2"](r, lattice.radius)
        wet, w = j < 0, wt * a["scale"][j]
        wet[: near.middle[i] - near.start[i]] = True
        own = np.array([a["u"][i], a["w"][i]])
        v = v - np.where(wet[:, None], own, own + [0.0, dt * GRAVITY])
        opens = 0.5 * lattice.spread * (w / r**2 * (v * d).sum(1)).sum()
        holds = (w[~wet] * -9810.0 * d[~wet, 1]).sum()
        face = sides.area[j][:, [0, 2]]
        before = ~wet & (a["body"][j] >= 0) & ((d * face).sum(1) < 0.0)
        fast = (np.stack([a["ax"][j], a["az"][j]], 1) * face).sum(1)
        sweeps = (fast * wt / np.maximum(a["n"][j], sides.least))[before].sum() / (laplacian * SPACING**2)
        inside = a["surface"][i] == INTERNAL
        missing = max(lattice.number * (0.85 if inside else 1.0) - a["n"][i], 0.0) * kappa[a["surface"][i]]
        closer = min(a["c"][i] - 1.0, 0.02) if inside else min(max(a["c"][i] - 1.0, 0.0), 0.02)
        bent = (w * (d * [a["gx"][i], a["gz"][i]]).sum(1)).sum() if inside else 0.0
        right = stiff * (give * a["p"][i] + share * closer) + 1000.0 * (sweeps - opens / dt) + holds - bent
        assert a["diagonal"][i] == pytest.approx(wt[wet].sum() + missing + stiff * give, rel=1e-9)
        assert a["right"][i] == pytest.approx(right, rel=1e-9, abs=1e-9 * 9810.0 * SPACING)
        classes.add((int(a["surface"][i]), bool(before.any())))
    assert {(INTERNAL, True), (INTERNAL, False), (SURFACE, False), (VICINITY, False)} <= classes


def test_the_matrix_is_symmetric_and_positive_with_the_bodies_in_it(asked):
    a, near = asked, asked["flow"].near
    at, order = near.fluid, {i: k for k, i in enumerate(near.fluid)}
    water = np.diag(a["diagonal"][at])
    for k, i in enumerate(at):
        for t in range(near.start[i], near.middle[i]):
            water[k, order[int(near.index[t])]] -= a["pairs"][t]
    mobility, bodies = a["mobility"], np.zeros((at.size, 2, 6))
    for i, body, row in zip(mobility.at, mobility.body, mobility.rows, strict=True):
        bodies[order[i], body] += row
    assert not mobility.inverse[1].any(), "what is held gives no way"
    whole = water + a["factor"] * np.einsum("iba,bac,kbc->ik", bodies, mobility.inverse, bodies)
    assert np.abs(whole - whole.T).max() < 1e-12 * np.abs(whole).max()
    assert np.linalg.eigvalsh(whole).min() > 0.0
    values, inverse = np.random.default_rng(1).normal(size=at.size), np.zeros(len(a["x"]))
    field = a["flow"].particles.p
    kept, field[at] = field.copy(), values
    image, forces = a["solver"]._applied(a["flow"], a["equation"], mobility, a["factor"], "p", np.zeros(len(field)))
    field[:] = kept
    assert image == pytest.approx(whole @ values, rel=1e-9, abs=1e-9)
    assert forces == pytest.approx(np.einsum("iba,i->ba", bodies, values), rel=1e-9, abs=1e-9)
    mobility.diagonal(a["factor"], inverse)
    assert inverse[at] + a["diagonal"][at] == pytest.approx(np.diag(whole), rel=1e-9)


def test_water_at_rest_stays_so_in_steps_of_the_flow():
    s = simulation(still(0.01))
    explicit = simulation(merged(still(0.01), {"water": {"scheme": {"kind": "wcmps"}}}))
    assert s.scheme.time_step(0.0, GRAVITY) > 20.0 * explicit.scheme.time_step(0.0, GRAVITY)
    before = Energy(s.case).rows(s)[0][-1]
    while s.time < 1.0:
        s.step()
    p, at = fluid(s)
    off = p.p[at] - 9810.0 * (0.2 - p.z[at])
    low = p.z[at] < 0.01
    assert abs(off[low].mean()) < 0.01 * 9810.0 * 0.2 and off.std() < 0.005 * 9810.0 * 0.2
    assert p.z[at].mean() == pytest.approx(0.1, rel=0.002) and s.speed < 0.05
    assert Energy(s.case).rows(s)[0][-1] == pytest.approx(before, rel=0.002)
    ((iterations, residual),) = Seen(s.case).rows(s)
    assert 0 < iterations < 20 and 0.0 < residual < 1e-5


@pytest.mark.parametrize("density", [1.0, 200.0])
def test_a_light_square_rises_as_its_added_mass_lets_it(density):
    data = merged(tank(1.0, 0.8, SPACING, fill=(1.0, 0.4)), {"water": {"scheme": {"kind": "simps"}}})
    block = {"name": "a", "shape": {"size": [0.2, 1.0, 0.2]}, "density": density, "material": "wood",
             "position": [0.5, 0.5, 0.2]}  # fmt: skip
    s = simulation(data | {"materials": WOOD, "bodies": [block]})
    while s.time < 0.05:
        s.step()
    exact = (1000.0 - density) * GRAVITY / (density + ADDED * 1000.0)
    assert s.bodies.velocity[0, 2] / s.time == pytest.approx(exact, rel=0.15)


def test_a_square_as_dense_as_water_stays_where_it_is():
    block = BLOCKS[0] | {"density": 1000.0, "position": [0.2, 0.5, 0.1], "angles": [0.0, 0.0, 0.0]}
    s = simulation(still(bodies=[block]))
    while s.time < 0.5:
        s.step()
    assert s.bodies.position[0] == pytest.approx([0.2, 0.5, 0.1], abs=0.0005)


REFUSED = {
    "eddies": (["water.eddies={kind='smagorinsky'}"], "water.eddies: there are none"),
    "no slip": (["water.friction={kind='no_slip'}"], 'water.friction.kind = "no_slip": must be "wall_law"'),
    "inlet": (["box.faces.x_min={kind='inlet',discharge=0.1}"], 'box.faces.x_min = "inlet": must be a wall, open'),
    "outlet": (["box.faces.x_max={kind='outlet',level=0.4}"], 'box.faces.x_max = "outlet": must be a wall, open'),
    "roll": (["motion={kind='roll',about=[0.2,0,0],amplitude=4.0,period=1.0}"], 'motion.kind = "roll": must be "sway"'),
    "lid": (["box.faces.z_max={kind='wall',velocity=[0.1,0,0]}", "water.friction={kind='wall_law'}", "bodies=[]"],
            "box.faces.z_max.velocity = [0.1, 0.0, 0.0]: sides stand"),
    "weight": (["water.scheme.weight=wendland_c4"], "water.scheme.weight = 'wendland_c4': must be"),
    "shifting": (["water.scheme.shifting=false"], "water.scheme.shifting: belongs to kind = 'wcmps'"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_it_cannot_do_is_refused_by_name(name, tmp_path):
    path, (changes, told) = tmp_path / "case.toml", REFUSED[name]
    path.write_text(PLANE)
    load(path, ["water.scheme.kind=simps"])
    with pytest.raises(InputError) as error:
        load(path, ["water.scheme.kind=simps", *changes])
    assert [told in message for message in error.value.messages] == [True], error.value.messages


def test_a_tank_may_sway():
    motion = {"kind": "sway", "amplitude": 0.01, "period": 0.9, "phase": 90.0}
    s = simulation(still(0.02) | {"motion": motion})
    first = Energy(s.case).rows(s)[0]
    while s.time < 0.45:
        s.step()
    p, at = fluid(s)
    last = Energy(s.case).rows(s)[0]
    assert p.z[at][p.x[at] > 0.3].max() - p.z[at][p.x[at] < 0.1].max() != 0.0
    assert s.speed > 0.02 and last[-1] - first[-1] < last[7] + 1e-3 * abs(first[-1])


def test_an_equation_that_is_not_solved_ends_the_run():
    s = simulation(still(iterations=2, tolerance=1e-10))
    with pytest.raises(RunError, match=r"equation is not solved: residual .* after 2 iterations, wanted 1e-10"):
        for _ in range(3):
            s.step()


def test_it_is_chosen_by_name_alone():
    case = parse(merged(still(), {"water": {"scheme": {"kind": "simps"}}}))
    assert case.water.scheme.kind == "simps" and case.water.scheme.faults(case) == []


def test_bodies_give_way_as_they_are_accelerated():
    """Free, locked along x, and on a rod: what a load adds to the accelerations that all loads make."""
    rng, n = np.random.default_rng(5), 3
    free, rod = np.ones((n, 6)), np.zeros((n, 3))
    free[1, 0], rod[2] = 0.0, (0.0, 0.6, 0.8)
    root = rng.normal(size=(n, 6, 6))
    added = np.zeros((n, 24))
    added[:, :21] = (root @ root.transpose(0, 2, 1))[:, *np.triu_indices(6)]
    quaternion = rng.normal(size=(n, 4))
    quaternion /= np.sqrt((quaternion**2).sum(1))[:, None]
    bodies = Given(
        rng.uniform(0.1, 1.0, n),
        rng.uniform(0.1, 1.0, (n, 3)),
        quaternion,
        rng.normal(size=(n, 6)),
        rng.normal(size=(n, 3)),
        free,
        np.zeros((n, 6)),
        rod,
        np.array([0.0, 0.0, 0.3]),
    )
    inverse, load, gravity = np.empty((n, 6, 6)), rng.normal(size=(n, 6)), np.array([0.0, 0.0, -9.81])
    mobilities(added, bodies, inverse)
    found = []
    for more in (0.0, 1.0):
        a, turn, change = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 6))
        accelerate_bodies(more * load, added, bodies, gravity, a, turn, change)
        found.append(np.hstack([a, turn]))
    assert np.einsum("bac,bc->ba", inverse, load) == pytest.approx(found[1] - found[0], rel=1e-9, abs=1e-9)
    assert inverse == pytest.approx(inverse.transpose(0, 2, 1), rel=1e-9, abs=1e-9)
