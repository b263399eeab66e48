"""The two kinds of Numba kernel, and the settings that must stand before numba is imported.

`kernel` is strict IEEE arithmetic, for element-wise work and sorting.
`rows` runs a `prange` over particles; inside one particle's neighbour loop the sum may be reordered for SIMD,
which depends on nothing but that particle's own list.

Numba does not notice that a kernel's imported helper has changed, and forgets what it cached once a source file has
another path or date: the cache folder carries a hash of all that, so that an edited or upgraded parsim never runs stale
machine code, and a folder whose kernels were all compiled stays complete.
"""

import hashlib
import os
import sys
from pathlib import Path


def _source_hash():
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        text = path.read_bytes()
        if b"parsim.jit" in text or path.name == "jit.py":
            digest.update(f"{path.absolute()} {path.stat().st_mtime_ns}".encode() + text)
    return digest.hexdigest()[:16]


def variant():
    """A short name of the kernel variant: sources, processor and features, numba and Python."""
    parts = (_source_hash(), os.environ.get("NUMBA_CPU_NAME"), os.environ.get("NUMBA_CPU_FEATURES"),
             sys.modules["numba"].__version__, sys.version)
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]


def _threads():
    """Threads per rank: what the scheduler or the user gave, else one."""
    return os.environ.get("SLURM_CPUS_PER_TASK") or os.environ.get("OMP_NUM_THREADS") or "1"


def _set_environment():
    if "numba" in sys.modules:
        return
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    os.environ.setdefault("NUMBA_CACHE_DIR", str(cache / "parsim" / _source_hash()))
    os.environ.setdefault("NUMBA_NUM_THREADS", _threads())
    # numba takes features only together with a name; the host's own name keeps everything else as it would be
    if "NUMBA_CPU_NAME" not in os.environ and "NUMBA_CPU_FEATURES" not in os.environ:
        import llvmlite.binding as llvm

        features = llvm.get_host_cpu_features()
        if features.get("avx2"):
            os.environ["NUMBA_CPU_NAME"] = llvm.get_host_cpu_name()
            # microcode mitigations make the gather instruction slower than scalar loads on many hosts
            os.environ["NUMBA_CPU_FEATURES"] = features.flatten() + ",+prefer-no-gather"


_set_environment()

from numba import njit, prange  # noqa: E402, F401  (must follow the settings above)

_FAST = {"reassoc", "nsz", "contract"}


def kernel(function):
    """Compile strict and cached, without threads."""
    return njit(function, cache=True, error_model="numpy", nogil=True)


def rows(function):
    """Compile cached, threaded over `prange`, neighbour sums reordered for SIMD."""
    return njit(function, cache=True, error_model="numpy", nogil=True, parallel=True, fastmath=_FAST)
