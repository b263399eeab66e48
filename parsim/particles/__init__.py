"""Particles, their cells and their neighbours."""
