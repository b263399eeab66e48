"""The fields of particles that this scheme has besides the common ones."""

from parsim.particles.state import COMMON, Field

NORMAL = ("nx", "ny", "nz")
STEEP = ("gx", "gy", "gz")
VISCOUS = ("bx", "by", "bz")
FIELDS = (
    *(field._replace(kept=True) if field.name == "p" else field for field in COMMON),  # where the next solution begins
    Field("gx", "f8", "Pa/m", True, "gradient of the pressure in the step before"),
    Field("gy", "f8", "Pa/m", True, "gradient of the pressure in the step before"),
    Field("gz", "f8", "Pa/m", True, "gradient of the pressure in the step before"),
    Field("c", "f8", "-", False, "concentration: measure of the neighbours over that of the lattice"),
    Field("n", "f8", "-", False, "number density: sum of the weights"),
    Field("way", "f8", "Pa", False, "direction in which the solver searches"),
    Field("bx", "f8", "m/s", False, "viscous sum of the velocity"),
    Field("by", "f8", "m/s", False, "viscous sum of the velocity"),
    Field("bz", "f8", "m/s", False, "viscous sum of the velocity"),
    Field("qx", "f8", "m/s", False, "slip of a boundary particle: see fluid.friction"),
    Field("qy", "f8", "m/s", False, "slip of a boundary particle"),
    Field("qz", "f8", "m/s", False, "slip of a boundary particle"),
    Field("nx", "f8", "-", False, "outward normal of a surface particle, else zero"),
    Field("ny", "f8", "-", False, "outward normal of a surface particle, else zero"),
    Field("nz", "f8", "-", False, "outward normal of a surface particle, else zero"),
)
