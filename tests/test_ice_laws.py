"""Floes are drawn from their laws, by number or by area, and each is the same whatever else is drawn."""

import math
from itertools import pairwise

import numpy as np
import pytest

from parsim.errors import InputError
from parsim.ice.draw import Laws, area_of, draw, drawn, evenly, stream_of
from parsim.ice.field import covering
from parsim.ice.laws import Histogram, Listed, Lognormal, Power, Ratio, Uniform
from parsim.solid.shapes.polygon import centred, faults_of

MANY = 10_000
BAR = 1.63 / math.sqrt(MANY)  # Kolmogorov: passed by 99 % of samples that are of the law
THICK, SQUARE = Listed(kind="list", values=(0.1,)), Listed(kind="list", values=(1.0,))
EDGES, SHARES = (0.1, 0.2, 0.5, 0.6), (0.5, 0.2, 0.3)


def phi(x, median, sigma):
    return np.array([0.5 * math.erfc(-math.log(v / median) / (sigma * math.sqrt(2.0))) for v in np.atleast_1d(x)])


def cut_normal(x):
    low, high = phi([0.1, 0.8], 0.3, 0.4)
    return (phi(x, 0.3, 0.4) - low) / (high - low)


# law, its distribution in plain formulas
LAWS = {
    "uniform": (Uniform, {"min": 0.1, "max": 0.4}, lambda x: (x - 0.1) / 0.3),
    "lognormal": (Lognormal, {"median": 0.3, "sigma": 0.4, "min": 0.1, "max": 0.8}, cut_normal),
    "power": (Power, {"exponent": 2.5, "min": 0.1, "max": 1.0}, lambda x: (0.1**-1.5 - x**-1.5) / (0.1**-1.5 - 1.0)),
    "power 1": (Power, {"exponent": 1.0, "min": 0.1, "max": 1.0}, lambda x: np.log(x / 0.1) / math.log(10.0)),
    "histogram": (Histogram, {"edges": EDGES, "shares": SHARES}, lambda x: np.interp(x, EDGES, [0.0, 0.5, 0.7, 1.0])),
}


def law(name, weight):
    table, keys, cdf = LAWS[name]
    return table(kind=name.split()[0], weight=weight, **keys), cdf


def sizes(size, dimensions=3):
    """10^4 sizes, as floes have them."""
    laws = Laws("box" if dimensions == 2 else "disc", size, THICK, SQUARE, dimensions)
    return np.sort([draw(7, 3, n, laws).size for n in range(1, MANY + 1)])


def off(found, cdf, shares):
    """Largest difference between a distribution and what of these `shares` lies up to each value found."""
    reached = np.cumsum(shares) / np.sum(shares)
    return max(np.abs(reached - cdf(found)).max(), np.abs(reached - shares / np.sum(shares) - cdf(found)).max())


@pytest.mark.parametrize("name", LAWS)
def test_sizes_by_number(name):
    size, cdf = law(name, "number")
    found = sizes(size)
    assert off(found, cdf, np.ones(MANY)) < BAR


@pytest.mark.parametrize(("dimensions", "power"), [(3, 2), (2, 1)])
@pytest.mark.parametrize("name", LAWS)
def test_sizes_by_area(name, dimensions, power):
    """The area of the floes up to a size is the law's; in 2D, where area is length, too. By number it is far off."""
    size, cdf = law(name, "area")
    found = sizes(size, dimensions)
    shares = found**power
    assert off(found, cdf, shares) < 1.63 * math.sqrt((shares**2).sum()) / shares.sum() * 1.2
    assert off(found, cdf, np.ones(MANY)) > 4.0 * BAR


def test_listed_sizes():
    values, shares = (0.1, 0.2, 0.4), (0.5, 0.3, 0.2)
    found = sizes(Listed(kind="list", values=values, shares=shares))
    assert [np.mean(found == v) for v in values] == pytest.approx(shares, abs=0.015)
    found = sizes(Listed(kind="list", weight="area", values=values, shares=shares))
    area = np.array([np.sum(found[found == v] ** 2) for v in values])
    assert area / area.sum() == pytest.approx(shares, abs=0.03)
    even = sizes(Listed(kind="list", values=values))
    assert [np.mean(even == v) for v in values] == pytest.approx([1 / 3] * 3, abs=0.015)
    never = Listed(kind="list", values=values, shares=(1.0, 0.0, 0.0))
    assert never.at(0.0) == never.at(1.0) == 0.1


def test_thickness_and_aspect():
    laws = Laws("box", Uniform(kind="uniform", min=0.1, max=0.4), Ratio(kind="ratio", ratio=0.3, min=0.05, max=0.1),
                Uniform(kind="uniform", min=1.0, max=2.0))  # fmt: skip
    floes = [draw(1, 1, n, laws) for n in range(1, 2000)]
    assert all(f.thickness == pytest.approx(min(max(0.3 * f.size, 0.05), 0.1), abs=1e-9) for f in floes)
    edges = np.array([np.ptp(f.outline, axis=0) for f in floes])
    assert edges[:, 0] == pytest.approx(np.array([f.size for f in floes]))
    assert np.mean(edges[:, 0] / edges[:, 1]) == pytest.approx(1.5, abs=0.03)
    assert abs(np.corrcoef(edges[:, 0], edges[:, 0] / edges[:, 1])[0, 1]) < 0.08, "one number for each of them"


def test_polygons_are_convex_and_of_their_area():
    laws = Laws("polygon", Uniform(kind="uniform", min=0.1, max=0.4), THICK, Uniform(kind="uniform", min=1.0, max=3.0))
    floes = [draw(1, 1, n, laws) for n in range(1, 500)]
    assert {len(f.outline) for f in floes} == {5, 6, 7, 8}
    for f in floes:
        assert list(faults_of(f.outline)) == []
        assert area_of(f.outline) == pytest.approx(math.pi / 4.0 * f.size**2, rel=1e-6)
        assert centred(tuple(map(tuple, f.outline.tolist()))) == pytest.approx(f.outline, abs=1e-8), "about its centre"


@pytest.mark.parametrize("shape", ["box", "disc", "polygon"])
def test_a_floe_hangs_on_no_other(shape):
    laws = Laws(shape, law("lognormal", "area")[0], THICK, SQUARE)
    few, many = (covering(area, 5, 9, laws) for area in (1.0, 20.0))
    assert 3 < len(few) < len(many)
    alone = draw(5, 9, 3, laws)
    for same in (few[2], many[2]):
        assert same.key == alone.key and same.size == alone.size and np.array_equal(same.outline, alone.outline)
    assert [f.size for f in few] == [f.size for f in many[: len(few)]]
    others = {draw(*key, laws).size for key in ((5, 9, 3), (6, 9, 3), (5, 10, 3), (5, 9, 4))}
    assert len(others) == 4, "seed, stream and number all count"


def test_parts_of_a_counter_do_not_meet():
    parts = [evenly((1, 2, number), part, 200) for number in (1, 2) for part in range(4)]
    assert len({v for part in parts for v in part}) == 8 * 200
    assert evenly((1, 2, 1), 0, 5) == parts[0][:5]
    assert stream_of("ice.fields.a") != stream_of("ice.fields.b")


def test_numbers_are_those_of_philox():
    raw = np.random.Philox(key=np.array([4, 5], np.uint64), counter=np.array([0, 0, 6, 0], np.uint64)).random_raw(3)
    assert evenly((4, 5, 6), 0, 3) == [int(r >> np.uint64(11)) / 2**53 for r in raw]


def test_as_many_floes_as_come_nearest():
    laws = Laws("disc", Uniform(kind="uniform", min=0.1, max=0.4), THICK, SQUARE)
    for asked in (0.3, 1.0, 4.0):
        areas = np.cumsum([f.area for f, _ in zip(drawn(2, 2, laws), range(300), strict=False)])
        floes = covering(asked, 2, 2, laws)
        assert abs(sum(f.area for f in floes) - asked) == pytest.approx(np.abs(areas - asked).min())


def test_a_histogram_from_a_file(tmp_path):
    path = tmp_path / "sizes.csv"
    path.write_text("size,share\n# sieves\n0.1,0\n0.2,0.5\n\n0.5,0.2\n0.6,0.3\n")
    read = Histogram(kind="histogram", file=str(path)).completed()
    assert (read.edges, read.shares, read.file, read.weight) == (EDGES, SHARES, None, "area")
    assert list(read.faults()) == []


@pytest.mark.parametrize(("text", "told"), [
    ("0.1,0.2\n0.2,0.8\n", "the share of the first line is 0.2; must be 0"),
    ("0.1,0\n0.2,x\n", "line 2 is '0.2,x'; must be two numbers"),
    ("0.1,0\n0.2\n", "line 2 is '0.2'; must be two numbers"),
    ("0.1,0\n", "has 1 lines of numbers; a class takes two"),
    ("", "has 0 lines of numbers"),
    ("-0.1,0\n0.2,1\n", "values must be positive"),
    ("0.1,0\n0.2,nan\n", "must be two numbers"),
])  # fmt: skip
def test_a_wrong_file(tmp_path, text, told):
    path = tmp_path / "sizes.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=told):
        Histogram(kind="histogram", file=str(path)).completed()


def test_no_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read: No such file"):
        Histogram(kind="histogram", file=str(tmp_path / "none.csv")).completed()
    with pytest.raises(InputError, match="edges and shares are given besides"):
        Histogram(kind="histogram", file="a.csv", edges=EDGES, shares=SHARES).completed()


@pytest.mark.parametrize(("table", "told"), [
    (Uniform(kind="uniform", min=0.3, max=0.2), "min = 0.3: must not be greater than max = 0.2"),
    (Power(kind="power", exponent=2.0, min=0.3, max=0.2), "must not be greater"),
    (Power(kind="power", exponent=-20.0, min=1e-9, max=1e9), "is more than numbers hold"),
    (Ratio(kind="ratio", ratio=0.2, min=0.3, max=0.2), "must not be greater"),
    (Lognormal(kind="lognormal", median=0.1, sigma=0.1, min=0.5, max=0.6), "leave less than a millionth"),
    (Listed(kind="list", values=(0.1, 0.2), shares=(0.5, 0.4)), "their sum is 0.9; must be 1"),
    (Listed(kind="list", values=(0.1, 0.2), shares=(1.0,)), "1 entries for 2 values"),
    (Histogram(kind="histogram"), "none is given; a class has two"),
    (Histogram(kind="histogram", edges=(0.1, 0.3, 0.2), shares=(0.5, 0.5)), "must be ascending"),
    (Histogram(kind="histogram", edges=EDGES, shares=(0.5, 0.5)), "2 entries for 3 classes"),
])  # fmt: skip
def test_wrong_laws(table, told):
    (found,) = table.faults()
    assert told in found


def test_laws_reach_their_ends():
    for name in LAWS:
        for weight in ("number", "area"):
            table, _ = law(name, weight)
            values = [table.at(share) for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
            assert all(a < b for a, b in pairwise(values))
            low, high = (EDGES[0], EDGES[-1]) if name == "histogram" else (table.min, table.max)
            assert (values[0], values[-1]) == pytest.approx((low, high))


def test_limits_are_judged_by_the_dimensions():
    """By area few are left of many in a plane, where floes cover a length, and next to none in 3D."""
    law = Lognormal(kind="lognormal", median=0.08, sigma=2.5, min=0.06, max=0.1, weight="area")
    assert list(law.faults(3)) and not list(law.faults(2))


def test_corners_far_from_the_origin_are_about_their_centre_too():
    near = ((0.0, 0.0), (0.3, 0.02), (0.31, 0.2), (0.05, 0.29))
    far = tuple((x + 305600.0, y + 5106300.0) for x, y in near)
    assert centred(far) == pytest.approx(centred(near), abs=1e-8)
