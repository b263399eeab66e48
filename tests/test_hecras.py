"""HEC-RAS geometry: what its fixed fields say, the ground between sections, and what is refused."""

import numpy as np
import pytest
from ground import packed, parabola, reach, section

from parsim import terrain
from parsim.errors import InputError
from parsim.terrain import hecras, sections
from parsim.terrain.frame import Frame

PLANE = [(0.0, 12.0), (10.0, 10.0), (30.0, 10.0), (40.0, 12.0)]
BANKS = (10, 30)


def test_numbers_that_fill_their_field_run_together(tmp_path):
    """As they do in the file of the Neufpas reach of stochICE."""
    text = section(8370, 0, PLANE, BANKS).replace(packed(np.ravel(PLANE)), "%s")
    line = " 134.174  92.883 134.958  92.421     13592.39202  135.49  92.054  1441.5-12.3456"
    upper = section(8504, 134.1, PLANE, BANKS)
    path = reach(tmp_path, upper, text.replace("Elev= 4", "Elev= 5").replace("%s", line).replace("=10,30", "=135,200"))
    profile = hecras.read(path)[1]
    assert profile.station.tolist() == [134.174, 134.958, 135.0, 135.49, 1441.5]
    assert profile.elevation.tolist() == [92.883, 92.421, 92.39202, 92.054, -12.3456]


def test_a_description_may_say_anything(tmp_path):
    said = "BEGIN DESCRIPTION:\nIce jam of 1996 = 102.3 ft at the bridge\nBank Sta = from survey\nEND DESCRIPTION:\n"
    text = section(8370, 0, PLANE, BANKS).replace("#Sta/Elev", said + "#Sta/Elev")
    assert said in text
    assert hecras.read(reach(tmp_path, section(8504, 134.1, PLANE, BANKS), text))[1].banks == BANKS


def test_cut_lines_run_together_too(tmp_path):
    cut = [
        (305873.538392269, 5106302.71035319),
        (305730.139395134, 5106336.85297156),
        (305620.883016366, 5106350.5100189),
    ]
    path = reach(tmp_path, section(2, 5, PLANE, BANKS, cut=cut), section(1, 0, PLANE, BANKS))
    assert packed(np.ravel(cut), 16, 4).startswith("305873.5383922695106302.71035319")
    assert hecras.read(path)[0].cut == pytest.approx(np.array(cut), abs=1e-7)


def test_a_section_is_what_the_file_says(tmp_path):
    nodes = hecras.read(reach(tmp_path))
    assert [node.river_station for node in nodes] == [300, 240, 200] and [node.length for node in nodes] == [60, 40, 0]
    assert nodes[0].banks == (10, 30) and nodes[0].manning.tolist() == [[0, 0.05], [10, 0.03], [30, 0.05]]
    assert nodes[1].ice == {"Ice Thickness": (0.1, 0.2, 0.1), "Ice Mann": (0.04, 0.05, 0.04)}
    assert sections.manning(nodes, 0.0, 100.0) == pytest.approx(0.03)
    assert sections.manning(nodes, 61.0, 62.0) == pytest.approx(0.03), "that of the nearest section"
    assert sections.chainage(nodes).tolist() == [0.0, 60.0, 100.0]
    assert sections.place_of(nodes, 270.0) == 30.0 and sections.place_of(nodes, 210.0) == 90.0


def test_n_between_the_banks_is_the_mean_by_widths(tmp_path):
    manning = [(0.0, 0.1), (15.0, 0.02), (25.0, 0.04)]
    path = reach(tmp_path, *(section(s, 1, PLANE, BANKS, manning) for s in (2, 1)))
    assert sections.manning(hecras.read(path), 0.0, 1.0) == pytest.approx((5 * 0.1 + 10 * 0.02 + 5 * 0.04) / 20)
    path = reach(tmp_path, *(section(s, 1, PLANE, BANKS, ()) for s in (2, 1)))
    assert sections.manning(hecras.read(path), 0.0, 1.0) is None


def test_a_prismatic_channel_laid_straight_is_exact(tmp_path):
    """A parabola that falls by 1 in 1000; y runs to the left, so from the right bank on."""
    surface = terrain.read(reach(tmp_path))
    x, y = np.linspace(0.0, 100.0, 51), np.linspace(-20.0, 20.0, 81)
    z = surface.on(x, y, Frame()).z
    points = np.array(parabola(0.0))
    exact = 10.0 - 0.001 * x[:, None] + np.interp(20.0 - y, *points.T)
    assert np.abs(z - exact).max() < 1e-9


def test_sections_are_aligned_by_their_banks(tmp_path):
    """A channel 20 m wide becomes 40 m wide, with other stations: half way it is 30 m wide."""
    wide = [(100.0, 12.0), (105.0, 10.0), (145.0, 10.0), (150.0, 12.0)]
    surface = terrain.read(reach(tmp_path, section(2, 100, PLANE, BANKS), section(1, 0, wide, (105, 145))))
    across = surface.on(np.array([50.0]), np.array([-22.0, -15.0, 0.0, 14.99, 18.75, 22.49]), Frame()).z[0]
    assert across[1:4] == pytest.approx(10.0, abs=0.01) and across[4] == pytest.approx(11.0, abs=0.01)
    assert across[5] == pytest.approx(12.0, abs=0.01) and across[0] == pytest.approx(10.0 + 2 * 7 / 7.5, abs=0.01)


def test_a_section_may_end_at_its_banks(tmp_path):
    bare = [(10.0, 11.0), (20.0, 10.0), (30.0, 11.0)]
    surface = terrain.read(reach(tmp_path, *(section(s, 50, bare, BANKS) for s in (2, 1))))
    assert surface.on(np.array([25.0]), np.array([-10.0, -5.0, 0.0, 10.0]), Frame()).z[0].tolist() == [11, 10.5, 10, 11]


def test_walls_in_a_section_stand(tmp_path):
    wall = [(0.0, 12.0), (10.0, 12.0), (10.0, 10.0), (30.0, 10.0), (30.0, 12.0), (40.0, 12.0)]
    surface = terrain.read(reach(tmp_path, *(section(s, 50, wall, BANKS) for s in (2, 1))))
    assert surface.on(np.array([25.0]), np.array([-10.01, -9.99, 9.99, 10.01]), Frame()).z[0] == pytest.approx(
        [12, 10, 10, 12]
    )


def test_on_the_map_sections_lie_where_their_cut_lines_do(tmp_path):
    """Two sections of one plane that runs up with the station, 40 m long, a quarter turn from each other."""
    slope = [(0.0, 10.0), (10.0, 11.0), (30.0, 13.0), (40.0, 14.0)]
    cuts = [(1000.0, 2060.0), (1000.0, 2020.0)], [(1060.0, 2000.0), (1020.0, 2000.0)]
    path = reach(tmp_path, *(section(s, 60, slope, BANKS, cut=cut) for s, cut in zip((2, 1), cuts, strict=True)))
    surface = terrain.read(path, "map")
    assert surface.low == pytest.approx((1000, 2000)) and surface.high == pytest.approx((1060, 2060))
    got = surface.on(np.array([0.0, 15.0, 20.0]), np.array([0.0, 15.0, 20.0, 60.0]), Frame((1000.0, 2000.0))).z
    assert got[0, 2:] == pytest.approx([14.0, 10.0]) and got[2, 0] == pytest.approx(14.0)
    assert np.isnan(got[0, 0]), "inside of the bend there is no section"
    frame = Frame((1000.0, 2060.0), -90.0)  # the same in a case whose x runs along the first cut line
    assert surface.on(np.array([0.0, 20.0, 40.0]), np.array([0.0]), frame).z[:, 0] == pytest.approx([10, 12, 14])


def test_of_several_reaches_one_is_named(tmp_path):
    path = reach(tmp_path, section(2, 5, PLANE, BANKS), section(1, 0, PLANE, BANKS))
    other = "River Reach=Side          ,Arm   \n" + section(9, 7, PLANE, BANKS) + section(8, 0, PLANE, BANKS)
    path.write_text(path.read_text() + other)
    assert hecras.read(path, "side, arm")[0].river_station == 9 and hecras.read(path, "Made,Up")[0].river_station == 2
    with pytest.raises(InputError, match="has 2 reaches; name one of Made, Up; Side, Arm"):
        hecras.read(path)
    with pytest.raises(
        InputError, match='has no reach "Side, Army"; allowed: Made, Up; Side, Arm; did you mean Side, Arm?'
    ):
        hecras.read(path, "Side, Army")


def test_bridges_between_sections_are_passed_over(tmp_path):
    bridge = "Type RM Length L Ch R = 3 ,1.5     ,,,\nBridge Culvert--1,0,0,-1, 0 \nBank Sta=1,2\n"
    path = reach(tmp_path, section("2.25*", 5, PLANE, BANKS), bridge, section(1, 0, PLANE, BANKS))
    assert [node.river_station for node in hecras.read(path)] == [2.25, 1.0]


def _with(old, new, station=2):
    """Two sections, in that with this station something else."""
    return [section(s, 5, PLANE, BANKS).replace(*((old, new) if s == station else ("", ""))) for s in (2, 1)]


@pytest.mark.parametrize(("parts", "said"), [
    ([section(1, 5, PLANE, BANKS), section(2, 0, PLANE, BANKS)], "sections are out of order: 2 comes after 1; river"),
    ([section(2, 0, PLANE, BANKS), section(1, 0, PLANE, BANKS)], "section 2: the length of its channel to section 1"),
    ([section(2, 0, PLANE, BANKS)], "has one cross-section, 2; a reach needs two or more"),
    (["Junct Name=a"], "holds no cross-section"),
    (_with("= 1 ,2 ", "= 1 ,two "), "section two (line 7): Type RM Length L Ch R = 1,two,5,5,5: must be"),
    (_with("Elev= 4", "Elev= 1"), "section 2 (line 7): #Sta/Elev has 1 points; must have two or more"),
    (_with("Elev= 4", "Elev= 6"), "#Sta/Elev: a field of 8 columns is no number: could not convert"),
    (_with("Elev= 4", "Elev= x"), "#Sta/Elev= x: must begin with a whole number"),
    (_with("      30      10", "       3      10"), "#Sta/Elev: station 3 comes after 10; stations must ascend"),
    (_with("      30      10", "     nan      10"), "section 2 (line 7): #Sta/Elev: holds nan; must be finite"),
    (_with("2    ,5,5,5", "2    ,5,inf,5"), "section 2: the length of its channel to section 1 is inf; must"),
    (_with("Sta=10,30", "Sta=10,50"), "Bank Sta = (10.0, 50.0): must be two stations, left and right, from 0 to 40"),
    (_with("Sta=10,30", "Sta=ten,30"), "Bank Sta=ten,30: must be numbers"),
    (_with("Bank Sta=10,30", ""), "Bank Sta = None: must be two stations"),
])  # fmt: skip
def test_what_is_wrong_in_a_file_is_told_with_its_place(tmp_path, parts, said):
    path = reach(tmp_path, *parts)
    with pytest.raises(InputError) as error:
        terrain.read(path)
    assert len(error.value.messages) == 1 and str(error.value).startswith(f"{path}: ") and said in str(error.value)


def test_a_section_without_cut_line_is_on_no_map(tmp_path):
    with pytest.raises(InputError, match='section 300 has no cut line on the map; use layout = "straight"'):
        terrain.read(reach(tmp_path), "map")


def test_numbers_that_are_too_few_are_told(tmp_path):
    path = reach(tmp_path, section(2, 5, PLANE, BANKS))
    path.write_text(path.read_text().split("#Mann")[0].rstrip()[:-8])
    with pytest.raises(InputError, match="#Sta/Elev: holds 7 numbers; 4 entries need 8"):
        terrain.read(path)
