"""Another user of the machine, `nobody`, for tests that run as root."""

import os
import pwd
import shutil
import subprocess
import sys

import pytest

NOBODY, NOGROUP = pwd.getpwnam("nobody").pw_uid, pwd.getpwnam("nobody").pw_gid
as_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can act as another user")


def give_away(folder):
    """Make `nobody` the owner of a folder and all that is in it."""
    for path in (folder, *folder.rglob("*")):
        os.lchown(path, NOBODY, NOGROUP)


def as_nobody(script, *words):
    """Standard output of a Python script that runs as `nobody`; that it fails fails the test."""
    line = [shutil.which("python3", path="/usr/bin:/bin") or sys.executable, "-I", "-c", script, *map(str, words)]
    done = subprocess.run(line, user=NOBODY, group=NOGROUP, extra_groups=[], capture_output=True, text=True, cwd="/")
    assert done.returncode == 0, done.stderr
    return done.stdout
