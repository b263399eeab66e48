"""The one table of particle fields, and the structure of arrays made from it.

*Kept* fields migrate between ranks, are written and restart; *derived* ones are recomputed in every step.
"""

from typing import NamedTuple

import numpy as np

from parsim.particles.tables import Kinematics, Traceless, Vectors

FLUID, BODY, GATE_UP, GATE_DOWN, WALL = 0, 1, 2, 3, 4
INTERNAL, VICINITY, SURFACE, DETACHED = 0, 1, 2, 3
POSITION = ("x", "y", "z")
VELOCITY = ("u", "v", "w")
ACCELERATION = ("ax", "ay", "az")
NORMAL = ("nx", "ny", "nz")
VISCOUS = ("bx", "by", "bz")
TWICE_VISCOUS = ("ex", "ey", "ez")
ISOTROPY = ("txx", "txy", "txz", "tyz", "tzz")
_ID_BITS = 56


class Field(NamedTuple):
    """One particle field: name, numpy dtype, unit, kept or derived, meaning."""

    name: str
    dtype: str
    unit: str
    kept: bool
    meaning: str


FIELDS = (
    Field("id", "i8", "-", True, "from the place in the initial lattice; unique over all kinds"),
    Field("kind", "u1", "-", True, "fluid, body, gate seen from upstream or downstream, wall"),
    Field("body", "i4", "-", True, "index of the rigid body, -1 elsewhere"),
    Field("sample", "i4", "-", True, "index of the sample in its body or gate, -1 elsewhere"),
    Field("x", "f8", "m", True, "position downstream"),
    Field("y", "f8", "m", True, "position across"),
    Field("z", "f8", "m", True, "position up"),
    Field("u", "f8", "m/s", True, "velocity downstream"),
    Field("v", "f8", "m/s", True, "velocity across"),
    Field("w", "f8", "m/s", True, "velocity up"),
    Field("n", "f8", "-", True, "number density"),
    Field("rate", "f8", "1/s", True, "relative rate of change of n"),
    Field("txx", "f8", "-", True, "what makes the sum of e e W isotropic, times which the gradient is taken, less one"),
    Field("txy", "f8", "-", True, "the same: xy; its trace is zero"),
    Field("txz", "f8", "-", True, "the same: xz"),
    Field("tyz", "f8", "-", True, "the same: yz"),
    Field("tzz", "f8", "-", True, "the same: zz"),
    Field("surface", "u1", "-", True, "internal, vicinity of the surface, surface, detached"),
    Field("scale", "f8", "-", True, "volume of the sample over spacing^d"),
    Field("image", "u1", "-", True, "1 for the periodic image of another particle"),
    Field("p", "f8", "Pa", False, "pressure"),
    Field("c", "f8", "-", False, "concentration: measure of the neighbours over that of the lattice"),
    Field("ax", "f8", "m/s2", False, "acceleration by pairs"),
    Field("ay", "f8", "m/s2", False, "acceleration by pairs"),
    Field("az", "f8", "m/s2", False, "acceleration by pairs"),
    Field("bx", "f8", "1/(m s)", False, "viscous sum of the velocity"),
    Field("by", "f8", "1/(m s)", False, "viscous sum of the velocity"),
    Field("bz", "f8", "1/(m s)", False, "viscous sum of the velocity"),
    Field("ex", "f8", "1/(m3 s)", False, "viscous sum of the viscous sum"),
    Field("ey", "f8", "1/(m3 s)", False, "viscous sum of the viscous sum"),
    Field("ez", "f8", "1/(m3 s)", False, "viscous sum of the viscous sum"),
    Field("nx", "f8", "-", False, "outward normal of a surface particle, else zero"),
    Field("ny", "f8", "-", False, "outward normal of a surface particle, else zero"),
    Field("nz", "f8", "-", False, "outward normal of a surface particle, else zero"),
)
NAMES = tuple(field.name for field in FIELDS)
KEPT = tuple(field.name for field in FIELDS if field.kept)
# kept fields that differ between particles of water
OF_WATER = ("id", *POSITION, *VELOCITY, "n", "rate", *ISOTROPY, "surface")
WATER_BYTES = sum(np.dtype(field.dtype).itemsize for field in FIELDS if field.name in OF_WATER)  # kept, of a particle
_DTYPES = {field.name: field.dtype for field in FIELDS}
_DEFAULTS = {"body": -1, "sample": -1, "scale": 1.0}


class Particles:
    """Structure of arrays: one contiguous array of shape (count,) per kept field, and per derived one once `sorted`."""

    __slots__ = NAMES

    def __init__(self, count=0, **given):
        for name in KEPT:
            values = np.asarray(given.get(name, _DEFAULTS.get(name, 0)), _DTYPES[name])
            setattr(self, name, np.ascontiguousarray(values) if values.ndim else np.full(count, values))

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

    @property
    def normal(self):
        """What points out of the water where it has a surface, and is zero inside."""
        return self.vectors(NORMAL)

    @property
    def isotropy(self):
        """The fields of the isotropic gradient."""
        return Traceless(*(getattr(self, name) for name in ISOTROPY))

    def take(self, index):
        """The particles at `index` (any numpy index), kept fields only."""
        kept = {name: getattr(self, name)[index] for name in KEPT}
        return Particles(kept["id"].size, **kept)

    @staticmethod
    def join(parts):
        """One after the other, kept fields only; a single part is passed on as it is."""
        if len(parts) == 1:
            return parts[0]
        kept = {name: np.concatenate([getattr(part, name) for part in parts]) for name in KEPT}
        return Particles(kept["id"].size, **kept)

    @staticmethod
    def sorted(parts, order, buffers):
        """Joined `parts` in `order` (n,), derived fields zero, in arrays kept in the dict `buffers`.

        What an earlier call with the same buffers returned is void. One field after another: no second copy of all.
        """
        out = Particles.__new__(Particles)
        for name in NAMES:
            room = buffers.get(name)
            if room is None or room.size < order.size:
                room = buffers[name] = np.empty(int(1.1 * order.size), _DTYPES[name])
            field = room[: order.size]
            if name in KEPT:
                joined = np.concatenate([getattr(part, name) for part in parts])
                np.take(joined, order, out=field, mode="clip")  # another mode would make one more copy
            else:
                field[:] = 0
            setattr(out, name, field)
        return out

    def pack(self):
        """Kept fields as one uint8 buffer, for a message."""
        return np.concatenate([getattr(self, name).view(np.uint8) for name in KEPT])

    @staticmethod
    def unpack(buffer):
        """The inverse of `pack`."""
        size = sum(np.dtype(_DTYPES[name]).itemsize for name in KEPT)
        count, at, kept = buffer.size // size, 0, {}
        for name in KEPT:
            length = count * np.dtype(_DTYPES[name]).itemsize
            kept[name] = buffer[at : at + length].copy().view(_DTYPES[name])
            at += length
        return Particles(count, **kept)


def make_id(kind, number):
    """Ids of all kinds in one int64: the kind above, the number within the kind below; fluid sorts first."""
    return (np.int64(kind) << _ID_BITS) + np.asarray(number, np.int64)
