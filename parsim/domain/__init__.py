"""Slabs of cell layers, their halos and their balance, and exact sums over ranks."""
