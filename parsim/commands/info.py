"""What the command `info` says of an output folder."""

from pathlib import Path

from parsim.output.lock import held
from parsim.output.reader import open as open_run


def tell(out: Path | str) -> None:
    """Print what the output folder `out` holds. Raises InputError when it is none."""
    found = open_run(out)
    told = {key: value for key, value in found.info.items() if not isinstance(value, dict | list)}
    if told.get("status") == "running" and not held(out):
        told["status"] = "killed, or lost with its machine; `parsim resume` goes on"
    unended = "running" if told.get("status") == "running" else "killed"
    told["pieces"] = "; ".join(
        f"from step {piece['from_step']} on {piece['ranks']} ranks: {piece.get('ended', unended)}"
        for piece in found.info.get("pieces", ())
    )
    told |= {
        key: _flat(value)
        for key, value in found.info.items()
        if value and key != "pieces" and isinstance(value, dict | list)
    }
    frames = found.times("water")
    told["frames"] = f"{len(frames)}, {frames[0]:g} to {frames[-1]:g} s" if len(frames) else "none"
    told["series"] = ", ".join(found.series_names) or "none"
    print(found.case.get("title") or out)
    print(*(f"  {key:<10} {value}" for key, value in told.items()), sep="\n")


def _flat(value):
    """A table or list on one line."""
    if not isinstance(value, dict):
        return "; ".join(map(str, value))
    return "; ".join(
        f"{key} {number:.4g}" if isinstance(number, float) else f"{key} {number}" for key, number in value.items()
    )
