"""Weakly compressible moving particles (Mellado 2021)."""
