"""What looks like chance and is the same everywhere."""

import numpy as np


def scatter(index: np.ndarray) -> np.ndarray:
    """A fixed shuffle: a well-mixed 64-bit number of each index (splitmix64 of Steele, Lea & Flood 2014)."""
    with np.errstate(over="ignore"):
        z = (np.asarray(index).astype(np.uint64) + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return z ^ (z >> np.uint64(31))


def swayed(index: np.ndarray) -> np.ndarray:
    """A fixed shuffle of each index, from -1 to 1."""
    return scatter(index) / 2.0**63 - 1.0
