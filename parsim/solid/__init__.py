"""Rigid bodies and their contacts."""
