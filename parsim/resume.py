"""From an output folder to what goes on in it: the case, and the newest whole checkpoint."""

import sys
import tomllib
from pathlib import Path

from parsim.case import parse
from parsim.case_file import read
from parsim.errors import InputError
from parsim.output import checkpoint
from parsim.output.reader import open as open_run


def find(out, until=None, tell=print):
    """(case, checkpoint) to go on with in the output folder `out`; `until` (s) replaces the end of the case.

    No case: the run is done. No checkpoint: it was stopped before the first one and begins again. `tell` prints that,
    and which checkpoints are broken. Raises InputError where there is nothing to go on with.
    """
    run = open_run(out)
    folder = run.folder
    if run.info.get("status") == "done" and (until is None or until <= run.info["time"]):
        tell(f"{folder}: the run is done, at t = {run.info['time']:g} s; --until prolongs it", flush=True)
        return None, None
    found, broken = checkpoint.newest(folder)
    for line in broken:
        tell(f"warning: {line}", file=sys.stderr, flush=True)
    if broken and found is None:
        raise InputError(f"OUT = {folder}: holds no whole checkpoint; start again with `parsim run CASE -o {folder} "
                         "--force`")
    if found is not None:
        data = tomllib.loads(found.case)
    elif (folder / "case.toml").is_file():
        tell(f"{folder}: holds no checkpoint, the run begins again", flush=True)
        data = read(Path(folder, "case.toml"))
    else:
        raise InputError(f"OUT = {folder}: holds neither a checkpoint nor a case to begin with")
    if until is not None:
        data["run"]["until"] = until
    return parse(data), found
