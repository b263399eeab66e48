"""From an output folder to what goes on in it: the case, and the newest whole checkpoint."""

from __future__ import annotations

import math
import sys
import tomllib
from typing import TYPE_CHECKING, Any, NamedTuple

from parsim.case.file import read
from parsim.case.model import parse
from parsim.errors import InputError
from parsim.machine import variant
from parsim.output import checkpoint
from parsim.output.reader import open as open_run

if TYPE_CHECKING:
    from pathlib import Path

    from parsim.case.model import Case


class Found(NamedTuple):
    """What to go on with; without checkpoint from the beginning."""

    case: Case
    checkpoint: checkpoint.Checkpoint | None
    name: str  # of the case
    kernel: str | None  # variant of the machine code, where it is known


def find(
    out: Path | str, until: float | None = None, kernel: str | None = None, wanted: Case | None = None
) -> Found | None:
    """What to go on with in the output folder `out`, Found; None: the run is done.

    `until` (s) replaces the end of the case, `kernel` the variant; `wanted` is the Case that the run is expected to be
    of, whose end holds too. Prints what is done and what was left out. Raises InputError where there is nothing to go
    on with, or not so.

    The case is that of the checkpoint, but for its end, which is the one that `--until` has last put into case.toml.
    """
    run = open_run(out)
    folder, info = run.folder, run.info
    if wanted is not None and until is None:
        until = wanted.run.until
    if info.get("status") == "done" and _ends(run, until) <= info["time"]:
        print(f"{folder}: the run is done, at t = {info['time']:g} s; a later --until prolongs it", flush=True)
        return None
    found = _newest(folder)
    noted = folder / "case.toml"
    if found is not None:
        data, kernel_used, name = tomllib.loads(found.case), found.account["kernel"], found.account["name"]
        _check_versions(found)
        if noted.is_file():
            data["run"]["until"] = _end_of(noted, data)
    elif noted.is_file():
        print(f"{folder}: holds no checkpoint, the run begins again", flush=True)
        data, kernel_used, name = read(noted), info.get("kernel"), info.get("case_name", "")
    else:
        raise InputError(f"OUT = {folder}: holds neither a checkpoint nor a case to begin with")
    if wanted is not None:
        _check_wanted(folder, tomllib.loads(wanted.to_toml()), data)
    if until is not None:
        _check_end(found, until, wanted is None)
        data["run"]["until"] = until
    if kernel is None and kernel_used is not None:
        _check_kernel(folder, kernel_used)
    return Found(parse(data), found, name, kernel or kernel_used)


def _check_kernel(folder, used):
    if used not in variant.possible():
        raise InputError(
            f"{folder}: computed with kernel variant {used}, which this processor does not have; "
            f"with --kernel the run goes on to other last bits; possible: {', '.join(variant.possible())}"
        )


def _ends(run, until):
    """The end that a run is to have, s; that of its case where none is given."""
    try:
        return run.case["run"]["until"] if until is None else until
    except (InputError, KeyError, TypeError):
        return -math.inf


def _check_wanted(folder, wanted, data):
    changed = changed_keys(wanted, data)
    if changed:
        hint = "; a supply without `ends` has floes to the end of the run, so that a later end gives it others"
        raise InputError(
            f"OUT = {folder}: is the run of another case, which differs in {', '.join(changed)}; give a "
            f"changed case a folder of its own{hint if 'ice.supplies' in changed else ''}"
        )


def _check_end(found, until, refused):
    """Refuse an end before the checkpoint."""
    if found is not None and refused and until <= found.account["time"]:
        raise InputError(
            f"--until = {until!r}: must be later than the checkpoint, which is at t = {found.account['time']:g} s"
        )


def _end_of(path, data):
    """run.until of the case file at `path`, else of the case `data`; what else differs is told, and not followed."""
    try:
        noted = _flat(read(path))
    except InputError as error:
        _warn(f"{message}; the case of the checkpoint holds" for message in error.messages)
        return data["run"]["until"]
    changed = changed_keys(data, noted)
    if changed:
        _warn([f"{path}: {', '.join(changed)}: not as in the checkpoint, which holds; a changed case is another run"])
    return noted.get("run.until", data["run"]["until"])


def changed_keys(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """The keys in which two cases, nested dicts, differ, but for run.until."""
    one, other = _flat(one), _flat(other)
    return [key for key in one | other if key != "run.until" and one.get(key) != other.get(key)]


def _flat(data, path=""):
    """Values of nested tables by key.path."""
    flat: dict[str, Any] = {}
    for key, value in data.items():
        flat |= _flat(value, f"{path}{key}.") if isinstance(value, dict) else {path + key: value}
    return flat


def _newest(folder):
    found, broken = checkpoint.newest(folder)
    _warn(broken)
    if broken and found is None:
        raise InputError(
            f"OUT = {folder}: holds no whole checkpoint; start again with `parsim run CASE -o {folder} --force`"
        )
    return found


def _check_versions(found):
    """Warn of what goes on with other last bits."""
    wrote = found.account["versions"]
    _warn(
        f"{found.path}: written with {name} {wrote[name]}, this is {now}; last bits may differ"
        for name, now in variant.versions().items()
        if wrote[name] != now
    )


def _warn(lines):
    for line in lines:
        print(f"warning: {line}", file=sys.stderr, flush=True)
