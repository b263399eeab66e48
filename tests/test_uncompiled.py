"""The kernels' own tests with the compiler off: what numba forgives or hides, Python tells."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
OWN = ("weights", "exact", "contact_geometry", "neighbours", "bodies", "shapes", "sweeps")
SLOW = (
    "second_order add_up floating energy plate sphere_re rolls turned nearest_point rays patches every_shape reach_and"
)
LONG = " and ".join(f"not {word}" for word in SLOW.split())


@pytest.mark.long
def test_kernels_pass_their_tests_uncompiled():
    files = [HERE / f"test_{name}.py" for name in OWN]
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", LONG, *files],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 0, ran.stdout[-3000:]
    assert "skipped" not in ran.stdout
