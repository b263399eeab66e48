"""Measures of a river with ice: pure functions of arrays, one file for each kind; `reader` applies them to a run."""
