"""The errors that a user can cause, with the exit code each one ends in, and what was perhaps meant instead."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

_LONGEST = 1000  # characters of a message


class InputError(Exception):
    """Bad input; carries every message found at once, each a line of bounded length. Exit code 2."""

    def __init__(self, messages: str | Iterable[str]) -> None:
        self.messages = [_line(message) for message in ([messages] if isinstance(messages, str) else messages)]
        super().__init__("\n".join(self.messages))


class RunError(Exception):
    """A run that has gone wrong in its physics; the message says where and what may help. Exit code 1."""


class WriteError(Exception):
    """A file or folder that cannot be written. Exit code 74. `shared`: raised on all ranks; rank 0 tells of it."""

    def __init__(self, path: Path | str, reason: str | Exception, shared: bool = False) -> None:
        self.path, self.reason, self.shared = path, reason, shared
        super().__init__(path, reason)  # so that it can be sent from rank to rank

    def __str__(self) -> str:
        return f"cannot write {self.path}: {self.reason}"


def nearest(name: str, known: Iterable[str], likeness: float = 0.7) -> str | None:
    """The one among the texts `known` that is most like the text `name`, None where none is: 1 would be the same."""
    return next(iter(get_close_matches(name, known, 1, likeness)), None)


def suggestion(meant: Path | str | None) -> str:
    """The words that end a message about a name, "; did you mean ...?"; none where `meant` is None."""
    return "" if meant is None else f"; did you mean {meant}?"


def _line(message):
    """A message on one line, without the middle of what somebody wrote much too long."""
    line = "".join(letter if letter.isprintable() else f"\\x{ord(letter):02x}" for letter in message)
    half = _LONGEST // 2
    return line if len(line) <= _LONGEST else f"{line[:half]} ... {line[-half:]}"
