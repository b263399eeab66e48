"""Laws of contact."""
