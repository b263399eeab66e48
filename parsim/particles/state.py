"""The particle fields that every scheme has, and the structure of arrays made from these and its own.

*Kept* fields migrate between ranks, are written and restart; *derived* ones are recomputed in every step.
"""

from typing import NamedTuple

import numpy as np

from parsim.particles.tables import Kinematics, Vectors

FLUID, BODY, GATE_UP, GATE_DOWN, WALL, INLET = 0, 1, 2, 3, 4, 5
INTERNAL, VICINITY, SURFACE, DETACHED, SHUT_IN = 0, 1, 2, 3, 4  # the last two have no pressure
POSITION = ("x", "y", "z")
VELOCITY = ("u", "v", "w")
ACCELERATION = ("ax", "ay", "az")
_ID_BITS = 56


class Field(NamedTuple):
    """One particle field: name, numpy dtype, unit, kept or derived, meaning."""

    name: str
    dtype: str
    unit: str
    kept: bool
    meaning: str


COMMON = (  # fields of every scheme
    Field("id", "i8", "-", True, "from the place in the initial lattice; unique over all kinds"),
    Field("kind", "u1", "-", True, "fluid, body, gate seen from upstream or downstream, wall, water about to come in"),
    Field("body", "i4", "-", True, "index of the rigid body, -1 elsewhere"),
    Field("sample", "i4", "-", True, "index of the sample in its body or gate, -1 elsewhere"),
    Field("x", "f8", "m", True, "position downstream"),
    Field("y", "f8", "m", True, "position across"),
    Field("z", "f8", "m", True, "position up"),
    Field("u", "f8", "m/s", True, "velocity downstream"),
    Field("v", "f8", "m/s", True, "velocity across"),
    Field("w", "f8", "m/s", True, "velocity up"),
    Field("surface", "u1", "-", True, "internal, vicinity of the surface, surface, detached, shut in between solids"),
    Field("scale", "f8", "-", True, "volume of the sample over spacing^d"),
    Field("image", "u1", "-", True, "1 for the periodic image of another particle"),
    Field("p", "f8", "Pa", False, "pressure"),
    Field("ax", "f8", "m/s2", False, "acceleration by pairs"),
    Field("ay", "f8", "m/s2", False, "acceleration by pairs"),
    Field("az", "f8", "m/s2", False, "acceleration by pairs"),
)
_OF_SOLIDS = ("kind", "body", "sample", "scale", "image")  # kept fields that are the same for all water
_DEFAULTS = {"body": -1, "sample": -1, "scale": 1.0}


def of_water(fields):
    """Names of the kept fields that differ between particles of water."""
    return tuple(field.name for field in fields if field.kept and field.name not in _OF_SOLIDS)


def water_bytes(fields):
    """Bytes of these of one particle."""
    return sum(np.dtype(field.dtype).itemsize for field in fields if field.name in of_water(fields))


class Particles:
    """Structure of arrays: one contiguous array of shape (count,) per kept field, and per derived one once `sorted`.

    `fields`: what there is, a tuple of `Field`; what is solid has the common ones until it is sorted in with water.
    """

    def __init__(self, count=0, fields=COMMON, **given):
        self.fields = fields
        for field in fields:
            if field.kept:
                values = np.asarray(given.get(field.name, _DEFAULTS.get(field.name, 0)), field.dtype)
                setattr(self, field.name, np.ascontiguousarray(values) if values.ndim else np.full(count, values))

    def __len__(self):
        return self.id.size

    def vectors(self, names):
        """The three fields of one vector, such as `POSITION`, as kernels take them."""
        return Vectors(*(getattr(self, name) for name in names))

    @property
    def place(self):
        """Where the particles are, m."""
        return self.vectors(POSITION)

    @property
    def velocity(self):
        """How fast they go, m/s."""
        return self.vectors(VELOCITY)

    @property
    def kinematics(self):
        """Place and velocity."""
        return Kinematics(self.place, self.velocity)

    @property
    def acceleration(self):
        """How fast that changes by pairs, m/s2; from one step to the next kept for what is solid only."""
        return self.vectors(ACCELERATION)

    def take(self, index):
        """The particles at `index` (any numpy index), kept fields only."""
        kept = {name: getattr(self, name)[index] for name in self._kept}
        return Particles(kept["id"].size, self.fields, **kept)

    @property
    def _kept(self):
        return [field.name for field in self.fields if field.kept]

    @staticmethod
    def join(parts):
        """One after the other, kept fields only, those of the first part; a single part is passed on as it is."""
        if len(parts) == 1:
            return parts[0]
        fields = parts[0].fields
        kept = {field.name: _joined(parts, field) for field in fields if field.kept}
        return Particles(kept["id"].size, fields, **kept)

    @staticmethod
    def sorted(parts, order, buffers):
        """Joined `parts` in `order` (n,), derived fields zero, in arrays kept in the dict `buffers`.

        What an earlier call with the same buffers returned is void. One field after another: no second copy of all.
        """
        out = Particles.__new__(Particles)
        out.fields = parts[0].fields
        for field in out.fields:
            room = buffers.get(field.name)
            if room is None or room.size < order.size:
                room = buffers[field.name] = np.empty(int(1.1 * order.size), field.dtype)
            values = room[: order.size]
            if field.kept:  # another mode would make one more copy
                np.take(_joined(parts, field), order, out=values, mode="clip")
            else:
                values[:] = 0
            setattr(out, field.name, values)
        return out

    def pack(self):
        """Kept fields as one uint8 buffer, for a message."""
        return np.concatenate([getattr(self, name).view(np.uint8) for name in self._kept])

    @staticmethod
    def unpack(buffer, fields):
        """The inverse of `pack` for particles of such `fields`."""
        kept = [(field.name, np.dtype(field.dtype)) for field in fields if field.kept]
        count, at, found = buffer.size // sum(dtype.itemsize for _, dtype in kept), 0, {}
        for name, dtype in kept:
            length = count * dtype.itemsize
            found[name] = buffer[at : at + length].copy().view(dtype)
            at += length
        return Particles(count, fields, **found)


def _joined(parts, field):
    """One field of all parts; those that do not have it get its default."""
    default = _DEFAULTS.get(field.name, 0)
    return np.concatenate(
        [
            getattr(part, field.name) if hasattr(part, field.name) else np.full(len(part), default, field.dtype)
            for part in parts
        ]
    )


def make_id(kind, number):
    """Ids of all kinds in one int64: the kind above, the number within the kind below; fluid sorts first."""
    return (np.int64(kind) << _ID_BITS) + np.asarray(number, np.int64)
