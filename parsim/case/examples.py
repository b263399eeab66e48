"""The example cases by name, such as ice_release/4_blocks_dry; they travel with parsim."""

from pathlib import Path

from parsim.errors import nearest


def paths():
    """{name: case file} of all examples: those in the installed package, or in the checkout that this is part of."""
    package = Path(__file__).parents[1]
    folder = next((place for place in (package / "cases", package.parent / "cases") if place.is_dir()), package)
    return {f"{path.parent.name}/{path.stem}": path for path in sorted(folder.glob("*/[!_]*.toml"))}


def path_of(given):
    """The case file that is meant by a path: what is there, else the example of that name, else the path itself."""
    return given if given.exists() else paths().get(given.as_posix(), given)


def like(text):
    """The name of the example that `text`, with or without a folder, is most like, or None."""
    known = {word: name for name in paths() for word in (name.split("/")[1], name)}
    return known.get(nearest(text, known))
