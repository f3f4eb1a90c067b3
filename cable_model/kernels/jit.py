"""The one way kernels are compiled: numba nopython, cached under a folder named by a hash of all kernel sources.

numba's own cache does not notice a change in a jitted function of another file; a folder named by the content of every
kernel file does, so kernels may live in several small files.  With NUMBA_DISABLE_JIT=1 kernels run as plain Python.

A kernel is two compiled functions: one that Python calls, and one that other kernels call.  numba optimizes every jitted function
to machine code with all that it calls, so a call tree of depth ten is optimized ten times over.  The second kind stays LLVM code,
not optimized, until a function that Python calls takes it in: a third of the compile time.  And no kernel allocates, so none counts
references (numba's option _nrt): a sixth less time to compile, and to run.  Both need numba's inner workings; with a version other than
those they were tested with, kernels are ordinary jitted functions, and a warning says so.
"""

import functools
import gc
import hashlib
import sys
import warnings
from pathlib import Path

import numba
import numpy as np
from numba import njit, types
from numba.extending import overload

TESTED = ("0.61.", "0.63.", "0.65.", "0.68.")  # versions of numba in which TakenIn and _nrt were found to work
ORDINARY = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}


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
def options():
    """numba's options for what Python calls."""
    if numba.config.DISABLE_JIT:
        return ORDINARY
    if not numba.__version__.startswith(TESTED):
        tested = ", ".join(version.rstrip(".") for version in TESTED)
        warnings.warn(
            f"numba {numba.__version__}, while {tested} are those that were tested: kernels are compiled in the ordinary way, which takes "
            "three times as long, and results are the same. Install one of these for quick starts.",
            stacklevel=2,
        )
        return ORDINARY
    return {**ORDINARY, "_nrt": False}


def link(library):
    """Link into the LLVM code of a numba library that of all that it calls, and keep it as bitcode.

    As a module, and the copy that is linked, it would take eight times the memory: a process that compiles for many scenes would run out.
    """
    import llvmlite.binding as llvm

    for called in dict.fromkeys(library._linking_libraries):
        module = called._get_module_for_linking()
        library._final_module.link_in(module, preserve=module is called._shared_module)  # else it is a copy
    library._finalized = True
    shared, own = library._get_module_for_linking(), library._final_module
    code = shared.as_bitcode()
    library._get_module_for_linking = lambda: llvm.parse_bitcode(code)
    library._shared_module = None
    for module in {id(shared): shared, id(own): own}.values():
        module.close()


def unrun(library, described, environment):
    """The object by which numba knows a compiled function, for one that has no machine code and is not called."""
    from numba import _dynfunc

    return _dynfunc.make_function(described.lookup_module(), described.qualname, "", 0, environment, (library,))


@functools.cache
def inner_options():
    """numba's options for what only kernels call."""
    if "_nrt" not in options():
        return ORDINARY
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
            link(library)
            known_by = unrun(library, lowered.fndesc, lowered.env)
            state.targetctx.insert_user_function(known_by, lowered.fndesc, [library])
            state["cr"] = _LowerResult(lowered.fndesc, lowered.call_helper, cfunc=known_by, env=lowered.env)
            return True

    class Compiler(CompilerBase):
        def define_pipelines(self):
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.passes = [(TakenIn if step is NativeLowering else step, words) for step, words in passes.passes]
            passes.finalize()
            return [passes]

    return {**options(), "pipeline_class": Compiler}


def kernel(function, fastmath=False, forceinline=False):
    """Compile `function` for numba: no Python objects, no GIL, C division rules; cached on disk where a folder is writable.

    `fastmath` is said in any case: else numba takes it from whoever calls the function first.
    """
    saved = numba.config.CACHE_DIR
    if not saved:
        numba.config.CACHE_DIR = _cache_folder()
    try:
        called_by_python = njit(cache=True, **options(), fastmath=fastmath, forceinline=forceinline)(function)
    finally:
        numba.config.CACHE_DIR = saved
    if not numba.config.DISABLE_JIT:
        _compile_without_collecting(called_by_python)
    if "_nrt" in options():
        _refuse_arrays(called_by_python)
    if "pipeline_class" in inner_options():
        called_by_kernels = njit(**inner_options(), fastmath=fastmath, forceinline=forceinline)(function)
        called_by_python.get_call_template = called_by_kernels.get_call_template
        called_by_python.get_overload = called_by_kernels.get_overload
    return called_by_python


# that sums may be taken in any order; not that a product and a sum are rounded once, which only some processors do
SUMS = frozenset(("reassoc", "nsz"))


def summing(function):
    """Like `kernel`, for loops that add up: their terms may be added in any order, so that the processor does several at a time."""
    return kernel(function, fastmath=set(SUMS))


def inlined(function):
    """Like `kernel`, for what a loop over cells calls in one place: never by a call, which would pass what it returns through memory."""
    return kernel(function, forceinline=True)


def summand(function):
    """Likewise what such a loop adds up, computed as it is written: a call would end that several terms are computed at a time."""
    return inlined(function)


def _compile_without_collecting(called_by_python):
    """Keep Python's garbage collector, which finds little in numba's many objects, out of compilation: a tenth of its time."""
    compile_or_load = called_by_python.compile

    def quickly(signature):
        collects = gc.isenabled()
        gc.disable()
        try:
            return compile_or_load(signature)
        finally:
            if collects:
                gc.enable()

    called_by_python.compile = quickly


def _refuse_arrays(called_by_python):
    """Let a kernel fail that gives arrays to Python: without counts of references numba would hand out what they are cut from."""
    compile_or_load = called_by_python.compile

    def checked(signature):
        made = compile_or_load(signature)
        if _cut_arrays(called_by_python.nopython_signatures[-1].return_type):
            raise TypeError(f"{called_by_python.__name__} gives arrays to Python. Decorate it with jit.views.")
        return made

    called_by_python.compile = checked


def _cut_arrays(kind):
    """Whether a type has arrays that may be parts of others; a record is passed on whole."""
    if isinstance(kind, types.BaseTuple):
        return any(_cut_arrays(member) for member in kind)
    return isinstance(kind, types.Array) and not isinstance(kind.dtype, types.Record)


def views(function):
    """Like `kernel`, for a function that cuts arrays into others: called by Python it does so as plain Python."""

    def cut(*arguments):
        return function(*arguments)

    compiled = njit(**inner_options())(function)

    @overload(cut, jit_options=inner_options())
    def _compiled(*arguments):
        return lambda *arguments: compiled(*arguments)

    cut.__name__, cut.__doc__ = function.__name__, function.__doc__
    return cut


# the first of equal types of records: numba looks at their identity, and compares others field by field in every call
_RECORDS: dict[np.dtype, np.dtype] = {}


def for_kernels(numbers):
    """The record of numbers as kernels are called with it: a plain array enters compiled code ten times faster than one with attributes."""
    kind = _RECORDS.setdefault(numbers.dtype, numbers.dtype)
    return numbers if numba.config.DISABLE_JIT else numbers.view(kind, np.ndarray)
