"""`parsim new`: a case to start from, the commented one or an example."""

from pathlib import Path

from parsim import __version__
from parsim.case import examples, file, model
from parsim.errors import InputError, WriteError, suggestion


def new_case(name: str | None, example: str | None = None) -> None:
    """Write NAME.toml: the commented case, or the `example` with all its values in one file; never overwrites.

    Raises InputError for a name that is taken or an example that there is not, WriteError where it cannot be written.
    """
    if name is None:
        raise InputError("NAME: missing; give the name of the case to write, or --list")
    path = Path(name if name.endswith(".toml") else f"{name}.toml")
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
        + model.load(known[example]).to_toml()
    )


def show() -> None:
    """Print the names and titles of the examples."""
    for name, path in examples.paths().items():
        print(f"{name:<28} {file.read(path).get('title', '')}")
