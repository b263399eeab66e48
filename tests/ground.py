"""Files of made-up ground for the tests of beds: a plane, a parabolic channel, sections."""

import numpy as np
import trimesh

from parsim.terrain.height_field import HeightField

X, Y = np.linspace(100.0, 104.0, 41), np.linspace(200.0, 202.0, 21)


def plane(x, y):
    """Heights of a plane."""
    return 5.0 - 0.02 * (x - 100.0) + 0.1 * (y - 200.0)


def channel(x, y):
    """Heights of a channel along x, a parabola 0.3 m deep across 2 m."""
    return 4.0 + 0.3 * (y - 201.0) ** 2 + 0.0 * x


def field(shape=plane, x=X, y=Y):
    """A `HeightField` of a shape."""
    return HeightField(x, y, shape(*np.meshgrid(x, y, indexing="ij")))


def write(path, field):
    """Write heights on a grid of square cells as an ESRI ASCII raster."""
    size = field.x[1] - field.x[0]
    head = {
        "ncols": len(field.x),
        "nrows": len(field.y),
        "xllcenter": repr(float(field.x[0])),
        "yllcenter": repr(float(field.y[0])),
        "cellsize": repr(float(size)),
        "NODATA_value": -9999,
    }
    rows = np.where(np.isnan(field.z), -9999.0, field.z).T[::-1]
    text = "\n".join(
        [*(f"{key} {value}" for key, value in head.items()), *(" ".join(map(repr, r.tolist())) for r in rows)]
    )
    path.write_text(text + "\n", encoding="utf-8")


def raster(folder, shape=plane, holes=(), name="ground.asc"):
    """An ESRI ASCII file of a shape, without data at nodes (i, j)."""
    z = field(shape).z.copy()
    for i, j in holes:
        z[i, j] = np.nan
    write(folder / name, HeightField(X, Y, z))
    return folder / name


def scattered(count=400, seed=1):
    """Points (n, 3) of the plane on no grid, with the corners of the rectangle."""
    dice = np.random.default_rng(seed)
    x, y = dice.uniform(X[0], X[-1], count), dice.uniform(Y[0], Y[-1], count)
    x, y = np.append(x, X[[0, 0, -1, -1]]), np.append(y, Y[[0, -1, 0, -1]])
    return np.stack([x, y, plane(x, y)], -1)


def sheet(folder, shape=plane):
    """An open surface of triangles in an STL file."""
    corners = field(shape)
    x, y = np.meshgrid(X, Y, indexing="ij")
    node = np.arange(x.size).reshape(x.shape)
    a, b, c, d = (part.ravel() for part in (node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    points = np.stack([x.ravel(), y.ravel(), corners.z.ravel()], -1)
    trimesh.Trimesh(points, faces, process=False).export(folder / "ground.stl")
    return folder / "ground.stl"


def packed(numbers, width=8, across=10):
    """Numbers in fields of fixed width, as HEC-RAS writes them: those that fill their field run together."""
    words = [f"{number:.{width}g}"[:width].rjust(width) for number in numbers]
    return "\n".join("".join(words[at : at + across]) for at in range(0, len(words), across))


def section(station, length, points, banks, manning=((0.0, 0.05), (10.0, 0.03), (30.0, 0.05)), cut=(), more=""):
    """The text of a cross-section; points (station, elevation)."""
    lines = [f"Type RM Length L Ch R = 1 ,{station}    ,{length},{length},{length}"]
    if cut:
        lines += [f"XS GIS Cut Line={len(cut)}", packed(np.ravel(cut), 16, 4)]
    lines += ["Node Last Edited Time=Mar/20/2024 10:06:07", f"#Sta/Elev= {len(points)} ", packed(np.ravel(points))]
    if manning:
        lines += [f"#Mann= {len(manning)} ,0,0", packed(np.ravel([(s, n, 0.0) for s, n in manning]), 8, 9)]
    lines += [*([more] if more else []), f"Bank Sta={banks[0]:g},{banks[1]:g}", "Exp/Cntr=0.3,0.1", ""]
    return "\n".join(lines)


def parabola(bottom, width=40.0):
    """Points of a section: 1 m of bank, a parabola 2 m deep between stations 10 and 30, its lowest point at 20."""
    stations = [0.0, *np.linspace(10.0, 30.0, 41), width]
    return [(s, bottom + min(2.0 * ((s - 20.0) / 10.0) ** 2, 2.0) + (s in (0.0, width)) * 1.0) for s in stations]


def reach(folder, *sections, name="reach.g01"):
    """A geometry file of these sections, three of a prismatic channel that falls by 0.1 m in 100 m if left out."""
    sections = sections or tuple(
        section(station, length, parabola(bottom), (10, 30), more="Ice Thickness=0.1,0.2,0.1\nIce Mann=0.04,0.05,0.04")
        for station, length, bottom in ((300, 60, 10.0), (240, 40, 9.94), (200, 0, 9.9))
    )
    head = ["Geom Title=made up", "Program Version=6.41", "", "River Reach=Made,Up", "Reach XY= 0 ", ""]
    (folder / name).write_text("\n".join([*head, *sections]))
    return folder / name
