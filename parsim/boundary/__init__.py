"""Walls, gates, periodic sides."""
