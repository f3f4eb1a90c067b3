"""Parts that are present or absent when the FMU initializes, not when it is compiled; it serves the export only.

A part of numba's type Optional(bool) or Optional(array) answers `part is None` at run time, with the arithmetic of the kernel that is
chosen: results are bit-identical.  Import this before any kernel: it takes the place of the decorator `kernel` and of the choice
`by_presence`.
"""

import functools
from typing import Any

from numba import njit, types
from numba.core import codegen
from numba.core.imputils import impl_ret_borrowed
from numba.core.registry import cpu_target
from numba.core.typing.templates import AbstractTemplate, infer, signature
from numba.extending import intrinsic, lower_builtin, overload

from cable_model.kernels import jit


def kernel(function, fastmath=False, forceinline=False):
    """Compile `function` for other kernels only, without a cache: no code for another machine can get into the export."""
    return njit(**jit.inner_options(), fastmath=fastmath, forceinline=forceinline)(function)


@intrinsic
def there(typing_context, part):
    """What an optional value is, where it is known to be one."""

    def code(context, builder, signature, arguments):
        holder = context.make_helper(builder, signature.args[0], value=arguments[0])
        return impl_ret_borrowed(context, builder, signature.return_type, holder.data)

    return part.type(part), code


def by_presence(absent, present):
    """As choice.by_presence, and for a part that is known at run time only a branch to either side, whose types must agree."""

    def choose(part, *args):
        return absent(part, *args) if part is None else present(part, *args)

    def either(part, *args):
        if part is None:
            return absent(None, *args)
        return present(True, *args)

    def by_table(part, *args):
        if part is None:
            return absent(None, *args)
        return present(there(part), *args)

    @overload(choose, strict=False, jit_options=jit.inner_options())
    def _compiled(part, *args):
        if isinstance(part, types.Optional):
            return by_table if isinstance(part.type, types.Array) else either
        chosen = absent if isinstance(part, types.NoneType) or part is None else present
        return getattr(chosen, "py_func", chosen)

    return choose


@infer
class _ItemOfOptionalTuple(AbstractTemplate):
    """t[0] of a tuple that may be None: kernels ask `t is None` first."""

    key = "static_getitem"

    def generic(self, args, kws):
        holder, index = args
        if isinstance(holder, types.Optional) and isinstance(holder.type, types.UniTuple) and isinstance(index, int):
            return signature(holder.type.dtype, *args)
        return None


@lower_builtin("static_getitem", types.Optional, types.Any)
def _item_of_optional_tuple(context, builder, sig, args):
    holder = context.make_helper(builder, sig.args[0], value=args[0])
    return impl_ret_borrowed(context, builder, sig.return_type, builder.extract_value(holder.data, args[1]))


class Apart(codegen.JITCodeLibrary):
    """LLVM code of one function, neither optimized nor linked nor made executable: nothing is called in this process."""

    def finalize(self) -> None:
        """Leave it as it is."""
        self._finalized = True


def _names(library):
    """Names of the functions that a numba library has, and of those that it calls."""
    functions = list(library._final_module.functions)
    return {f.name for f in functions if not f.is_declaration}, {f.name for f in functions if f.is_declaration}


def callers_first(library):
    """A numba library and all whose code it calls, directly or not, each once and after one that calls it.

    LLVM's linker leaves out what nothing has asked for yet.  What a library was lowered with and asks for no more, as the call was in a
    branch that fell away, does not count.
    """
    called_first = []
    seen = {library}
    names = functools.cache(_names)

    def visit(one):
        asked = names(one)[1]
        for called in one._linking_libraries:
            if called not in seen and asked & names(called)[0]:
                seen.add(called)
                visit(called)
        called_first.append(one)

    visit(library)
    return called_first[::-1]


def whole(library):
    """LLVM module of a library and of all that it calls, each linked once."""
    module = library._final_module
    for called in callers_first(library)[1:]:
        module.link_in(called._get_module_for_linking())
    return module


def _no_executable(library, fndesc, env):
    """Instead of machine code, the object by which numba knows a compiled function."""
    return jit.unrun(library, fndesc, env)


def take_over() -> None:
    """Let the kernels, which must not be imported yet, be compiled by this file's functions, and to LLVM code only."""
    jit.kernel = jit.views = kernel
    from cable_model.kernels import choice

    choice.by_presence = by_presence
    jit.link = Apart.finalize
    codegen.JITCPUCodegen._library_class = Apart
    context: Any = cpu_target.target_context
    context.get_executable = _no_executable
