"""The fields of particles that this scheme has besides the common ones."""

from parsim.particles.state import COMMON, Field
from parsim.particles.tables import Traceless

NORMAL = ("nx", "ny", "nz")
VISCOUS = ("bx", "by", "bz")
TWICE_VISCOUS = ("ex", "ey", "ez")
ISOTROPY = ("txx", "txy", "txz", "tyz", "tzz")
FIELDS = (
    *COMMON,
    Field("n", "f8", "-", True, "number density"),
    Field("rate", "f8", "1/s", True, "relative rate of change of n"),
    Field("txx", "f8", "-", True, "what makes the sum of e e W isotropic, times which the gradient is taken, less one"),
    Field("txy", "f8", "-", True, "the same: xy; its trace is zero"),
    Field("txz", "f8", "-", True, "the same: xz"),
    Field("tyz", "f8", "-", True, "the same: yz"),
    Field("tzz", "f8", "-", True, "the same: zz"),
    Field("c", "f8", "-", False, "concentration: measure of the neighbours over that of the lattice"),
    Field("bx", "f8", "1/(m s)", False, "viscous sum of the velocity"),
    Field("by", "f8", "1/(m s)", False, "viscous sum of the velocity"),
    Field("bz", "f8", "1/(m s)", False, "viscous sum of the velocity"),
    Field("qx", "f8", "m/s", False, "slip of a boundary particle: see fluid.friction"),
    Field("qy", "f8", "m/s", False, "slip of a boundary particle"),
    Field("qz", "f8", "m/s", False, "slip of a boundary particle"),
    Field("eddy", "f8", "m2/s", False, "eddy viscosity"),
    Field("ex", "f8", "1/(m3 s)", False, "viscous sum of the viscous sum"),
    Field("ey", "f8", "1/(m3 s)", False, "viscous sum of the viscous sum"),
    Field("ez", "f8", "1/(m3 s)", False, "viscous sum of the viscous sum"),
    Field("nx", "f8", "-", False, "outward normal of a surface particle, else zero"),
    Field("ny", "f8", "-", False, "outward normal of a surface particle, else zero"),
    Field("nz", "f8", "-", False, "outward normal of a surface particle, else zero"),
)


def isotropy(p):
    """The fields of the isotropic gradient."""
    return Traceless(*(getattr(p, name) for name in ISOTROPY))
