"""The one way kernels are compiled: numba nopython, cached under a folder named by a hash of all kernel sources.

numba's own cache does not notice a change in a jitted function of another file; a folder named by the content of every
kernel file does, so kernels may live in several small files.  With NUMBA_DISABLE_JIT=1 kernels run as plain Python.

A kernel is two compiled functions: one that Python calls, and one that other kernels call.  numba optimizes every jitted function
to machine code with all that it calls, so a call tree of depth ten is optimized ten times over.  The second kind stays LLVM code,
not optimized, until a function that Python calls takes it in: a third of the compile time.  This needs numba's inner workings; with
a version other than those it was tested with, kernels are ordinary jitted functions.
"""

import functools
import hashlib
import sys
from pathlib import Path

import numba
from numba import njit

TESTED = ("0.68.",)  # versions of numba in which TakenIn was found to work
OPTIONS = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}


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


@functools.cache
def inner_options():
    """numba's options for what only kernels call."""
    if numba.config.DISABLE_JIT or not numba.__version__.startswith(TESTED):
        return OPTIONS
    from numba import _dynfunc
    from numba.core.compiler import CompilerBase, DefaultPassBuilder, _LowerResult
    from numba.core.compiler_machinery import register_pass
    from numba.core.typed_passes import NativeLowering

    @register_pass(mutates_CFG=True, analysis_only=False)
    class TakenIn(NativeLowering):
        """Writes LLVM code and leaves it so, linked with the code of what it calls."""

        _name = "lowering_of_inner_kernels"

        def run_pass(self, state):
            state.flags.no_compile = state.flags.no_cpython_wrapper = True
            super().run_pass(state)
            library, lowered = state.library, state["cr"]
            for called in dict.fromkeys(library._linking_libraries):
                library._final_module.link_in(called._get_module_for_linking(), preserve=True)
            library._finalized = True
            # numba knows a compiled function by a Python object; this one has no machine code, and nothing calls it
            name = lowered.fndesc.qualname
            known_by = _dynfunc.make_function(lowered.fndesc.lookup_module(), name, "", 0, lowered.env, (library,))
            state.targetctx.insert_user_function(known_by, lowered.fndesc, [library])
            state["cr"] = _LowerResult(lowered.fndesc, lowered.call_helper, cfunc=known_by, env=lowered.env)
            return True

    class Compiler(CompilerBase):
        def define_pipelines(self):
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.passes = [(TakenIn if step is NativeLowering else step, words) for step, words in passes.passes]
            passes.finalize()
            return [passes]

    return {**OPTIONS, "pipeline_class": Compiler}


def kernel(function):
    """Compile `function` for numba: no Python objects, no GIL, C division rules; cached on disk where a folder is writable."""
    saved = numba.config.CACHE_DIR
    if not saved:
        numba.config.CACHE_DIR = _cache_folder()
    try:
        called_by_python = njit(cache=True, **OPTIONS)(function)
    finally:
        numba.config.CACHE_DIR = saved
    if "pipeline_class" in inner_options():
        called_by_kernels = njit(**inner_options())(function)
        called_by_python.get_call_template = called_by_kernels.get_call_template
        called_by_python.get_overload = called_by_kernels.get_overload
    return called_by_python
