"""A run from its start to its end: setting up, stepping, keeping."""
