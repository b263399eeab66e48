"""Parameter tables: CSV files whose first line names keys of a case, each further line being a run of its own."""

import csv
from pathlib import Path

from parsim.errors import InputError


def rows(path):
    """The changes "key=value" that each row of a table makes: a list of lists of texts; an empty cell makes none.

    Values are those of case files; one with a comma, such as a list, stands in double quotes. Empty lines and those
    that begin with # do not count. Raises InputError with every fault found.
    """
    keys, *lines = _lines(Path(path))
    messages = [] if all(keys) else [f"{path}: column {keys.index('') + 1} names no key"]
    messages += [f"{path}: two columns are named {key}" for key in dict.fromkeys(keys) if keys.count(key) > 1 and key]
    if ";" in keys[0]:
        messages.append(f"{path}: separated by semicolons; separate the values with commas")
    messages += [
        f"{path}: row {number} has {len(cells)} values for {len(keys)} keys"
        for number, cells in enumerate(lines, 1)
        if len(cells) != len(keys)
    ]
    if messages:
        raise InputError(messages)
    return [[f"{key}={cell}" for key, cell in zip(keys, cells, strict=True) if cell] for cells in lines]


def row(path, number):
    """The changes that row `number`, counted from 1, makes. Raises InputError."""
    every = rows(path)
    if not 1 <= number <= len(every):
        raise InputError(f"--row = {number}: {path} has {len(every)} rows; allowed: 1 to {len(every)}")
    return every[number - 1]


def _lines(path):
    try:
        with open(path, encoding="utf-8-sig", newline="") as file:
            lines = [[cell.strip() for cell in line] for line in csv.reader(file, strict=True)]
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: not a CSV table in UTF-8: {error}") from None
    lines = [line for line in lines if any(line) and not line[0].startswith("#")]
    if len(lines) < 2:
        raise InputError(f"{path}: holds no row; the first line names keys of the case, each further one is a run")
    return lines
