"""The fields of particles that this scheme has besides the common ones."""

from parsim.particles.state import COMMON, Field

NORMAL = ("nx", "ny", "nz")
SHIFT = ("sx", "sy", "sz")
FORCE = ("fx", "fy", "fz")
SLOPES = tuple((f"d{name}x", f"d{name}y", f"d{name}z") for name in "quvw")
ALL_SLOPES = tuple(name for slope in SLOPES for name in slope)
FIELDS = (
    *COMMON,
    Field("omega", "f8", "m3", True, "volume; in 2D m2"),
    Field("m", "f8", "kg", True, "mass; in 2D per metre of width"),
    Field("c", "f8", "-", False, "concentration: measure of the neighbours over that of the lattice"),
    Field("growth", "f8", "m3/s", False, "rate of the volume"),
    Field("gain", "f8", "kg/s", False, "rate of the mass"),
    *(Field(name, "f8", "N", False, "force by pairs, with the momentum of the mass that passes") for name in FORCE),
    *(Field(name, "f8", "m/s", False, "velocity of the particle over that of the water: shifting") for name in SHIFT),
    *(Field(name, "f8", "Pa/m", False, "slope of the pressure less its hydrostatic part") for name in SLOPES[0]),
    *(Field(name, "f8", "1/s", False, "slope of a component of the velocity") for name in ALL_SLOPES[3:]),
    *(
        Field(name, "f8", "-", False, "unit normal, of water at its surface outward, of a sample inward")
        for name in NORMAL
    ),
)
