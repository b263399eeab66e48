"""`parsim new`: a case to start from, the commented one, an example or a reach."""

from pathlib import Path

from parsim import __version__, terrain
from parsim.case import examples, file, ice, model
from parsim.commands.new_reach import Asked, new_reach
from parsim.errors import InputError, WriteError, suggestion


def new_case(name: str | None, example: str | None = None, asked: Asked = Asked()) -> None:  # noqa: B008
    """Write NAME.toml: the commented case, or the `example` with all its values in one file; never overwrites.

    Where `example` is a file of ground, a folder NAME with the case of what is `asked` of it: see `new_reach`. Raises
    InputError for a name that is taken or an example that there is not, WriteError where it cannot be written.
    """
    if name is None:
        raise InputError("NAME: missing; give the name of the case to write, or --list")
    if example is not None and terrain.is_ground(Path(example)):
        new_reach(name, Path(example), asked)
        return
    if asked != Asked():
        given = f"--from {example}" if example else "--from GROUND: missing"
        raise InputError(f"{given}: stations, spacing, level, reach and scale belong to a file of ground")
    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if not path.name.removesuffix(".toml").strip("."):
        raise InputError(f"NAME = {name!r}: is no name of a file; give the name of the case to write, such as flume")
    text = _text(example)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(f"NAME = {name}: {path} exists already and is not overwritten; choose another name") from None
    except (OSError, ValueError) as error:
        raise WriteError(path, getattr(error, "strerror", None) or error) from None
    print(f"wrote {path}; next: parsim check {path}")


def _text(example):
    starter = Path(__file__).with_name("starter.toml").read_text(encoding="utf-8")
    if example is None:
        return starter
    known = examples.paths()
    if example not in known:
        raise InputError(
            f"--from {example}: no such example; allowed: {', '.join(known)}" + suggestion(examples.like(example))
        )
    schema = starter.split("\n", 1)[0]
    return (
        f"{schema}\n# From the example {example} of parsim {__version__}, with every value written out.\n"
        + ice.undrawn(model.load(known[example])).to_toml()
        + _study(known[example])
    )


def _study(path):
    """The study of an example, as its file has it."""
    given = file.read(path).get("study")
    return "\n" + file.written({"study": given}) if given else ""


def show() -> None:
    """Print the names and titles of the examples."""
    for name, path in examples.paths().items():
        print(f"{name:<28} {file.read(path).get('title', '')}")
