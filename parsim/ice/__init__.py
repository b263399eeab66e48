"""Floes of ice: their laws, their draws, and where there is room for them."""
