"""Where the bodies are and how they move."""

import numpy as np

from parsim.observe.observer import columns


class Bodies:
    """One row for each body."""

    name = "bodies"
    columns = columns(
        body="-",
        x="m",
        y="m",
        z="m",
        q0="-",
        q1="-",
        q2="-",
        q3="-",
        u="m/s",
        v="m/s",
        w="m/s",
        spin_x="rad/s",
        spin_y="rad/s",
        spin_z="rad/s",
    )

    def __init__(self, case):
        pass

    def rows(self, s):
        """See `Observer`."""
        values = np.hstack([s.bodies.shown(name) for name in ("position", "quaternion", "velocity", "spin")])
        return [[name, *map(float, row)] for name, row in zip(s.bodies.names, values, strict=True)]
