"""Smoothed particles in arbitrary Lagrangian-Eulerian form (Vila 1999; Robb et al. 2016)."""
