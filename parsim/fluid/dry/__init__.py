"""No water at all: bodies alone."""
