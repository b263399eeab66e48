"""What has left the box."""

from parsim.observe.observer import columns


class Lost:
    """One row for each particle or body that has left since it was last told of, on rank 0; told at once.

    Unlike those of others its rows begin with a step and a time of their own.
    """

    name = "lost"
    columns = columns(what="-", id="-", x="m", y="m", z="m", u="m/s", v="m/s", w="m/s")

    def __init__(self, case):
        pass

    def rows(self, s):
        """See `Observer`."""
        return [
            [int(step), float(time), what, int(ident), *map(float, rest)] for step, time, what, ident, *rest in s.gone
        ]
