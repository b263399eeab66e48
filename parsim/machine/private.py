"""Folders that nobody but this user can put files into: what is loaded from there runs as this user."""

import errno
import os
import stat
from pathlib import Path

_OTHERS = stat.S_IWGRP | stat.S_IWOTH


def folder(path: Path | str) -> Path:
    """`path` without symbolic links, made with what it lacks of parents if it is not there, for this user alone.

    Raises PermissionError, which names the place at fault, where another user could read the folder, or put another one
    in its place; OSError where it cannot be made.
    """
    given = Path(os.path.abspath(path))
    found = Path(os.path.realpath(given))
    for place in reversed((found, *found.parents)):
        if not place.exists():
            place.mkdir(mode=0o700, exist_ok=True)  # mkdir(parents=True) would leave the parents open to a group
    # the way as it was given too, for a link of somebody else can be turned later
    for place in sorted({*given.parents, given, *found.parents} - {found}):
        if fault := _parent(place.lstat()):
            raise PermissionError(errno.EPERM, fault, str(place))
    if fault := _end(found.lstat()):
        raise PermissionError(errno.EPERM, fault, str(found))
    return found


def _parent(found):
    """What lets another user exchange what is in a folder, or behind a link, of these attributes; "" if nothing.

    The owner of / is root, also in a container that shows root under another number.
    """
    if found.st_uid not in (os.geteuid(), os.stat("/").st_uid):
        return f"belongs to user {found.st_uid}"
    if stat.S_ISDIR(found.st_mode) and found.st_mode & _OTHERS and not found.st_mode & stat.S_ISVTX:
        return "can be written by other users"
    return ""


def _end(found):
    """What lets another user into the folder itself; "" if nothing."""
    if found.st_uid != os.geteuid():
        return f"belongs to user {found.st_uid}"
    # one that others may enter can have parts that they may write
    return "is open to other users" if found.st_mode & (stat.S_IRWXG | stat.S_IRWXO) else ""
