"""From the text of a case file to a checked case, and what it will cost."""
