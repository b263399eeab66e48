"""The pile of tests/test_shares.py among the ranks of a job, as a program: what it is in a file after some steps.

Arguments: file, how uneven parts may be (`Shares`), and a file to go on from, if there is one.
"""

import pickle
import sys
from pathlib import Path

from test_shares import AMONG_RANKS, moved

from parsim.domain.comm import Comm
from parsim.domain.shares import Shares


def main(out, uneven, start=None):
    """Go some steps, and let the last rank write what bodies and contacts keep."""
    comm = Comm()
    kept = moved(
        Shares(comm, 0.0, float(uneven)), start and pickle.loads(Path(start).read_bytes()), AMONG_RANKS[bool(start)]
    )
    if comm.rank == comm.size - 1:
        Path(out).write_bytes(pickle.dumps(kept[1]))


if __name__ == "__main__":
    main(*sys.argv[1:])
