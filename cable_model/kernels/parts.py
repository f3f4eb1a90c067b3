"""The type of the parts that a problem has.  No kernels, and no names of effects: these come from the table of effects.

A part that a scene does not name is None, and numba compiles a kernel without its terms; True, or the part's own table, is present.
Presence is a matter of types, since types are what numba compiles for, and what it files compiled code under.  A global that chose code
would be neither: numba would load from its cache, without a word, what had been compiled under another value of it.

For the same reason a type of parts is known by the names of its parts, not by where it is defined: compiled code serves whoever has the
same parts in the same order, such as FMUs of several versions, and nobody else.
"""

import copyreg
import functools
import hashlib
from collections import namedtuple as named


class PartsType(type):
    """The class of types of parts; copies of such a type, as in numba's cache, are made by parts_type."""


@functools.cache
def parts_type(names):
    """The type of parts with these names, a tuple of strings: a named tuple in which each is None unless given."""
    name = "Parts_" + hashlib.sha256(" ".join(names).encode()).hexdigest()[:16]
    made = PartsType(name, (named("Parts", names, defaults=(None,) * len(names)),), {"__slots__": (), "__module__": __name__})
    globals()[name] = made  # numba's pickler asks for it by name
    return made


def _reduced(made):
    return parts_type, (made._fields,)


copyreg.pickle(PartsType, _reduced)
