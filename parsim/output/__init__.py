"""What a run writes, and the reader of it."""
