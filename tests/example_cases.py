"""Two small valid cases, from which the tests of case files make others."""

from pathlib import Path

ROOT = Path(__file__).parent.parent
SPACE = (ROOT / "parsim" / "commands" / "starter.toml").read_text(encoding="utf-8")
PLANE = """
dimensions = 2
spacing = 0.01
[box]
max = [0.5, 1.0, 0.6]
[water]
fill = [{min = [0.0, 0.0, 0.0], max = [0.5, 1.0, 0.4]}]
[materials.wood]
young = 1e9
poisson = 0.3
friction = 0.4
restitution = 0.5
[[bodies]]
name = "square"
shape = {size = [0.1, 1.0, 0.1]}
density = 500.0
position = [0.25, 0.5, 0.4]
material = "wood"
[run]
until = 1.0
"""
# the same with water that flows
FLOWING = PLANE.replace("0.4]}", """0.4], velocity = [0.2, 0.0, 0.0], profile = {kind = "log", roughness = 0.001}}""")
# a body, to be filled with its name, position and angles
BLOCK = '{name="%s", shape={size=[0.05,0.05,0.02]}, density=900, position=%s, angles=%s, material="polypropylene"}'


def bodies(*entries):
    """The change "bodies=[...]" of blocks given as (name, position, angles), texts."""
    return "bodies=[" + ",".join(BLOCK % entry for entry in entries) + "]"


def write(folder):
    """Both cases as files in `folder`: {"3d": path, "2d": path}."""
    paths = {"3d": folder / "space.toml", "2d": folder / "plane.toml"}
    for kind, text in (("3d", SPACE), ("2d", PLANE)):
        paths[kind].write_text(text, encoding="utf-8")
    return paths
