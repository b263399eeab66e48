"""Processes: ranks, signals, exit codes."""
