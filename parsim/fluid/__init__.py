"""Water schemes."""
