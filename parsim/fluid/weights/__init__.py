"""Weights of the water's sums, by name: what exists is listed here."""

from parsim.fluid.weights import mps, wendland_c2, wendland_c4

WEIGHTS = {"wendland_c4": wendland_c4, "wendland_c2": wendland_c2, "mps": mps}
