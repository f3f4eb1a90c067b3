"""The one way kernels are compiled: numba nopython, cached under a folder named by a hash of all kernel sources.

numba's own cache does not notice a change in a jitted function of another file; a folder named by the content of every
kernel file does, so kernels may live in several small files.  With NUMBA_DISABLE_JIT=1 kernels run as plain Python.
"""

import functools
import hashlib
import sys
from pathlib import Path

import numba
from numba import njit


@functools.cache
def source_hash() -> str:
    """Hexadecimal hash of every kernel source in this folder, of numba's version and of Python's."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.version_info}".encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> str:
    import platformdirs

    return str(Path(platformdirs.user_cache_dir("cable_fmu")) / source_hash())


def kernel(function):
    """Compile `function` for numba: no Python objects, no GIL, C division rules; cached on disk where a folder is writable."""
    saved = numba.config.CACHE_DIR
    if not saved:
        numba.config.CACHE_DIR = _cache_folder()
    try:
        return njit(cache=True, error_model="numpy", nogil=True)(function)
    finally:
        numba.config.CACHE_DIR = saved
