"""Which machine code the kernels become: width of the vectors, hardware gather or not, and where it is cached.

Reordered sums differ in the last bit between variants, so one is chosen for a whole job: what the user names, else what
was measured fastest on this kind of processor when parsim first ran there (`parsim.run.probe`), else the first. Nothing
here imports numba, which reads the settings that `apply` makes when it is imported.
"""

import functools
import hashlib
import os
import platform
import re
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

from parsim import __version__
from parsim.errors import InputError, nearest, suggestion
from parsim.launch import mpirun
from parsim.machine import private

# features added to the host's; the gather instruction is slower than scalar loads on many hosts, by microcode, and
# without AVX-512 vectors are 256 bits long
VARIANTS = {
    "256": {"avx512f": False, "prefer-no-gather": True},
    "256-gather": {"avx512f": False},
    "512": {"prefer-256-bit": False, "prefer-no-gather": True},
    "512-gather": {"prefer-256-bit": False},
    "host": {},
}
NAME = "PARSIM_KERNEL"  # environment variable that hands the choice on to child processes


@functools.cache
def _host():
    """Name and features (dict) of this processor, as LLVM knows them."""
    import llvmlite.binding as llvm

    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features()


def possible() -> list[str]:
    """Names of the variants that this processor can run, the safest first."""
    _, features = _host()
    if not features.get("avx2"):
        return ["host"]
    return [name for name in VARIANTS if name != "host" and (name.startswith("256") or features.get("avx512vl"))]


def checked(name: str) -> str:
    """`name` if this processor can run that variant; InputError otherwise."""
    if name not in possible():
        raise InputError(
            f"kernel = {name}: not a variant of this processor; possible: {', '.join(possible())}"
            + suggestion(nearest(name, possible()))
        )
    return name


def chosen() -> str | None:
    """The variant of this process or, None before any choice, the one remembered for this kind of processor."""
    if NAME in os.environ:
        return checked(os.environ[NAME])
    try:
        name = _memory().read_text().strip()
    except OSError:
        return None
    return name if name in possible() else None


def remember(name: str) -> None:
    """Note `name` as the choice for this kind of processor, where the cache can be written."""
    draft = _memory().with_suffix(f".{os.getpid()}")
    try:
        draft.parent.mkdir(parents=True, exist_ok=True)
        draft.write_text(name + "\n")
        draft.replace(_memory())
    except OSError:
        pass


def apply() -> None:
    """Set what numba reads when it is imported: processor, features, cache folder, threads."""
    if "numba" in sys.modules:
        return
    name = os.environ[NAME] = chosen() or possible()[0]
    cpu, features = _host()
    if name != "host":
        changes = [f"{'+' if on else '-'}{feature}" for feature, on in VARIANTS[name].items()]
        os.environ.update(NUMBA_CPU_NAME=cpu, NUMBA_CPU_FEATURES=",".join([features.flatten(), *changes]))
    os.environ["NUMBA_CACHE_DIR"] = str(_cache())
    os.environ.setdefault("NUMBA_NUM_THREADS", _threads())


def code() -> str:
    """A short name of the machine code itself: variant, sources, processor, numba and Python."""
    parts = (source_hash(), *_host()[:1], os.environ[NAME], version("numba"), sys.version)
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]


def versions() -> dict[str, str]:
    """Versions of all that the last bits of a result depend on, besides the variant."""
    return {
        "parsim": __version__,
        "python": platform.python_version(),
        "processor": _host()[0],
        **{name: version(name) for name in ("numpy", "numba")},
    }


def source_hash() -> str:
    """Hash of path, date and text of all files with kernels.

    Numba does not notice that a kernel's imported helper has changed, and forgets what it cached once a source file has
    another path or date: a cache folder of this name never holds stale code, and once complete it stays so.
    """
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        text = path.read_bytes()
        marks = b"parsim.machine.jit", b"@implements", b"@compiled"
        if any(word in text for word in marks) or path.name in ("jit.py", "variant.py"):
            digest.update(f"{path.absolute()} {path.stat().st_mtime_ns}".encode() + text)
    return digest.hexdigest()[:16]


def mark(folder: Path | str) -> Path:
    """The file in a cache folder that says that the machine code of this process is complete there."""
    return Path(folder, f"complete-{code()}")


def _cache():
    """Folder for the machine code: the first that is this user's alone and holds it or can be written.

    Code of another user would run if it were loaded. Raises InputError where there is no such folder.
    """
    given = os.environ.get("NUMBA_CACHE_DIR")
    first = Path(given) if given else _folder()
    if re.fullmatch("[0-9a-f]{16}", first.name):  # the parent process has been here, maybe with another variant
        first = first.parent
    reasons = []
    for folder in dict.fromkeys((first, _folder(), _spare())):
        try:
            found = _usable(folder / code())
        except OSError as error:
            reasons.append(f"{error.filename or folder} {error.strerror}")
            continue
        if reasons and mpirun.world()[0] == 0:
            print(f"warning: the kernel cache is not used: {reasons[0]}; using {found}", file=sys.stderr, flush=True)
        return found
    raise InputError(
        "NUMBA_CACHE_DIR: no folder for the kernel cache that this user alone can write: "
        f"{'; '.join(reasons)}; name one"
    )


def _spare():
    return Path(tempfile.gettempdir(), f"parsim-{os.geteuid()}")


def _usable(folder):
    """`folder`, made if need be, as this user's alone; OSError if it is not, or holds no code and cannot be written."""
    folder = private.folder(folder)
    if not mark(folder).exists():
        with tempfile.TemporaryFile(dir=folder):
            pass
    return folder


def _folder():
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "parsim"


def _memory():
    return _folder() / f"kernel-{_host()[0]}-numba-{version('numba')}"


def _threads():
    """Threads per rank: what the scheduler or the user gave, else one."""
    return os.environ.get("SLURM_CPUS_PER_TASK") or os.environ.get("OMP_NUM_THREADS") or "1"
