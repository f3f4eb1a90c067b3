"""The choice between two kernels by whether a part is present, and parts without or with other ones, made when numba compiles.

numba drops the branch of `if part is None` only where the part is absent: where it is present both branches must still agree
in their types.  A choice made here compiles one side only, so the two sides may return different things.
"""

from numba import types
from numba.extending import overload

from cable_model.kernels.jit import inner_options


def by_presence(absent, present):
    """A function f(part, ...) that is `absent` where part is None and `present` otherwise."""

    def choose(part, *args):
        return absent(part, *args) if part is None else present(part, *args)

    # not inline="always": numba 0.68 then loses stores of the inlined kernel
    @overload(choose, strict=False, jit_options=inner_options())
    def _compiled(part, *args):
        chosen = absent if isinstance(part, types.NoneType) or part is None else present
        # a kernel itself, not one more that calls it: a seventh of all functions that numba compiles
        return getattr(chosen, "py_func", None) or (lambda part, *args: chosen(part, *args))

    return choose


def without(*names):
    """A function f(parts) that gives the same parts with these absent."""

    def fewer(parts):
        return parts._replace(**dict.fromkeys(names))

    @overload(fewer, jit_options=inner_options())
    def _compiled(parts):
        made = parts.instance_class
        # numba wants the members of a named tuple spelled out
        return eval(f"lambda parts: made({', '.join('None' if n in names else f'parts.{n}' for n in made._fields)})", {"made": made})

    return fewer


def given(*names):
    """A function f(parts, *values) that gives the same parts with a value for each of these that is present."""

    def told(parts, *values):
        return parts._replace(**{name: value for name, value in zip(names, values, strict=True) if getattr(parts, name) is not None})

    @overload(told, jit_options=inner_options())
    def _compiled(parts, *values):
        made = parts.instance_class
        absent = {name for name, kind in zip(made._fields, parts.types, strict=True) if isinstance(kind, types.NoneType)}
        members = [f"values[{names.index(n)}]" if n in names and n not in absent else f"parts.{n}" for n in made._fields]
        return eval(f"lambda parts, *values: made({', '.join(members)})", {"made": made})

    return told
