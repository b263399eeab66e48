"""parsim: free-surface flow carrying solids, by moving particles and discrete elements, parallel over MPI."""

__version__ = "0.1.0"


def open(folder):
    """Open an output folder for reading: see :class:`parsim.output.reader.Run`."""
    from parsim.output.reader import open as open_run

    return open_run(folder)
