"""From an output folder to what goes on in it: the case, and the newest whole checkpoint."""

import sys
import tomllib

from parsim import variant
from parsim.case import parse
from parsim.case_file import read
from parsim.errors import InputError
from parsim.output import checkpoint
from parsim.output.reader import open as open_run


def find(out, until=None, kernel=None):
    """(case, checkpoint) to go on with in the output folder `out`; `until` (s) replaces the end of the case.

    No case: the run is done. No checkpoint: it was stopped before the first one and begins again. `kernel`: variant in
    place of that of the checkpoint. Prints what is done and what was left out. Raises InputError where there is nothing
    to go on with, or not so.

    The case is that of the checkpoint, but for its end, which is the one that `--until` has last put into case.toml.
    """
    run = open_run(out)
    folder = run.folder
    if run.info.get("status") == "done" and (until is None or until <= run.info["time"]):
        print(f"{folder}: the run is done, at t = {run.info['time']:g} s; --until prolongs it", flush=True)
        return None, None
    found = _newest(folder)
    noted = folder / "case.toml"
    if found is not None:
        data = tomllib.loads(found.case)
        _check(found, until, kernel)
        if noted.is_file():
            data["run"]["until"] = _end_of(noted, data)
    elif noted.is_file():
        print(f"{folder}: holds no checkpoint, the run begins again", flush=True)
        data = read(noted)
    else:
        raise InputError(f"OUT = {folder}: holds neither a checkpoint nor a case to begin with")
    if until is not None:
        data["run"]["until"] = until
    return parse(data), found


def _end_of(path, data):
    """run.until of the case file at `path`, else of the case `data`; what else differs is told, and not followed."""
    try:
        noted = _flat(read(path))
    except InputError as error:
        _warn(f"{message}; the case of the checkpoint holds" for message in error.messages)
        return data["run"]["until"]
    kept = _flat(data)
    changed = [key for key in kept | noted if key != "run.until" and kept.get(key) != noted.get(key)]
    if changed:
        _warn([f"{path}: {', '.join(changed)}: not as in the checkpoint, which holds; a changed case is another run"])
    return noted.get("run.until", data["run"]["until"])


def _flat(data, path=""):
    """Values of nested tables by key.path."""
    flat = {}
    for key, value in data.items():
        flat |= _flat(value, f"{path}{key}.") if isinstance(value, dict) else {path + key: value}
    return flat


def _newest(folder):
    found, broken = checkpoint.newest(folder)
    _warn(broken)
    if broken and found is None:
        raise InputError(f"OUT = {folder}: holds no whole checkpoint; start again with `parsim run CASE -o {folder} "
                         "--force`")
    return found


def _check(found, until, kernel):
    """Refuse what cannot go on from a checkpoint, warn of what goes on with other last bits."""
    time, wrote, used = (found.account[key] for key in ("time", "versions", "kernel"))
    if until is not None and until <= time:
        raise InputError(f"--until = {until!r}: must be later than the checkpoint, which is at t = {time:g} s")
    if kernel is None and used not in variant.possible():
        raise InputError(f"{found.path}: computed with kernel variant {used}, which this processor does not have; with "
                         f"--kernel the run goes on to other last bits; possible: {', '.join(variant.possible())}")
    _warn(f"{found.path}: written with {name} {wrote[name]}, this is {now}; last bits may differ"
          for name, now in variant.versions().items() if wrote[name] != now)


def _warn(lines):
    for line in lines:
        print(f"warning: {line}", file=sys.stderr, flush=True)
