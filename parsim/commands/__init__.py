"""The commands that read and tell: check, info, doctor, new."""
