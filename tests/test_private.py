"""Folders that are this user's alone: what is refused, and that no other user gets into what is not."""

import json
import os
import random

import pytest
from strangers import NOBODY, NOGROUP, as_nobody, as_root

from parsim.machine import private

MODES = (0o700, 0o711, 0o750, 0o755, 0o770, 0o775, 0o777, 0o1777, 0o2775)
CHAINS = 300

# tries to write into the last folder of each chain and to put another in the place of any; prints one word for each
ATTACK = """
import contextlib, json, os, sys
for chain in json.loads(sys.argv[1]):
    got = "nothing"
    for folder in chain:
        with contextlib.suppress(OSError):
            os.chmod(folder, 0o777)
    with contextlib.suppress(OSError):
        open(chain[-1] + "/index", "w").close()
        got = "written"
    for folder in reversed(chain):
        with contextlib.suppress(OSError):
            os.rename(folder, folder + "-moved")
            got = "exchanged"
            break
    print(got)
"""


def refused(path):
    """Why a folder is refused, "" for one that is taken."""
    try:
        private.folder(path)
    except PermissionError as error:
        return f"{error.filename} {error.strerror}"
    return ""


def test_what_is_missing_is_made_for_this_user_alone(tmp_path):
    before = os.umask(0)
    try:
        made = private.folder(tmp_path / "a" / "b")
    finally:
        os.umask(before)
    assert [folder.stat().st_mode & 0o777 for folder in (made, made.parent)] == [0o700, 0o700]
    assert private.folder(made) == made


@pytest.mark.parametrize("which, mode, why", [
    ("a", 0o755, ""), ("a", 0o1777, ""), ("a", 0o775, "can be written by other users"),
    ("a", 0o777, "can be written by other users"), ("a/b", 0o755, "is open to other users"),
    ("a/b", 0o770, "is open to other users"),
])  # fmt: skip
def test_the_place_at_fault_is_named(which, mode, why, tmp_path):
    private.folder(tmp_path / "a" / "b")
    (tmp_path / which).chmod(mode)
    assert refused(tmp_path / "a" / "b") == (f"{tmp_path / which} {why}" if why else "")


def test_a_link_is_followed_once(tmp_path):
    private.folder(tmp_path / "real")
    (tmp_path / "link").symlink_to("real")
    assert private.folder(tmp_path / "link" / "a") == tmp_path / "real" / "a"


@as_root
@pytest.mark.parametrize("which", ["a/b", "a", "link"])
def test_what_is_of_another_user_is_refused(which, public):
    private.folder(public / "a" / "b")
    (public / "link").symlink_to(public / "a")
    os.lchown(public / which, NOBODY, NOGROUP)
    way = public / "link" / "b" if which == "link" else public / "a" / "b"
    assert refused(way) == f"{public / which} belongs to user {NOBODY}"


@as_root
def test_no_other_user_gets_into_a_folder_that_is_taken(public):
    """Folders in folders in folders with random owners, groups and rights, attacked as `nobody`."""
    draw, chains = random.Random(1), []
    for number in range(CHAINS):
        chain = [public / f"{number}"]
        chain += [chain[0] / "a", chain[0] / "a" / "b"]
        chain[-1].mkdir(parents=True)
        for folder in chain:
            os.chown(folder, draw.choices((0, NOBODY), (9, 1))[0], draw.choice((0, NOGROUP)))
            folder.chmod(0o700 if folder == chain[-1] and draw.random() < 0.7 else draw.choice(MODES))
        chains.append([str(folder) for folder in chain])
    taken = [not refused(chain[-1]) for chain in chains]
    got = as_nobody(ATTACK, json.dumps(chains)).split()
    outcomes = {(took, what) for took, what in zip(taken, got, strict=True)}
    assert {what for took, what in outcomes if took} == {"nothing"}
    assert {what for took, what in outcomes if not took} == {"nothing", "written", "exchanged"}
    assert sum(taken) > CHAINS / 20
