"""Vectors and square matrices of the cable's own dimension (2 in the plane, 3 in space) as tuples of floats, row by row.

numba keeps such tuples in registers and drops the branch of the other dimension, so one source serves plane and space.
"""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel


@kernel
def _in_plane(space, x, y, z):
    return (x, z)


@kernel
def _in_space(space, x, y, z):
    return (x, y, z)


axes = by_presence(_in_plane, _in_space)  # a vector in the chain's own dimension


@kernel
def load(array, i, like):
    """Row i of an (n, D) array as a D-vector; D is that of `like`."""
    if len(like) == 2:
        return (array[i, 0], array[i, 1])
    return (array[i, 0], array[i, 1], array[i, 2])


@kernel
def store(array, i, a):
    if len(a) == 2:
        array[i, 0] = a[0]
        array[i, 1] = a[1]
    else:
        array[i, 0] = a[0]
        array[i, 1] = a[1]
        array[i, 2] = a[2]


@kernel
def load_from(array, i, j, like):
    """The D-vector that begins at column j of row i."""
    if len(like) == 2:
        return (array[i, j], array[i, j + 1])
    return (array[i, j], array[i, j + 1], array[i, j + 2])


@kernel
def store_from(array, i, j, a):
    array[i, j] = a[0]
    array[i, j + 1] = a[1]
    if len(a) == 3:
        array[i, j + 2] = a[2]


@kernel
def zero(like):
    if len(like) == 2:
        return (0.0, 0.0)
    return (0.0, 0.0, 0.0)


@kernel
def upward(size, like):
    """Vector of the given size along the vertical, which is the last axis."""
    if len(like) == 2:
        return (0.0, size)
    return (0.0, 0.0, size)


@kernel
def add(a, b):
    if len(a) == 2:
        return (a[0] + b[0], a[1] + b[1])
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@kernel
def sub(a, b):
    if len(a) == 2:
        return (a[0] - b[0], a[1] - b[1])
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def scale(s, a):
    if len(a) == 2:
        return (s * a[0], s * a[1])
    return (s * a[0], s * a[1], s * a[2])


@kernel
def axpy(s, a, b):
    """s a + b."""
    if len(a) == 2:
        return (s * a[0] + b[0], s * a[1] + b[1])
    return (s * a[0] + b[0], s * a[1] + b[1], s * a[2] + b[2])


@kernel
def mix(s, a, t, b):
    """s a + t b."""
    if len(a) == 2:
        return (s * a[0] + t * b[0], s * a[1] + t * b[1])
    return (s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2])


@kernel
def dot(a, b):
    if len(a) == 2:
        return a[0] * b[0] + a[1] * b[1]
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def norm(a):
    return dot(a, a) ** 0.5


@kernel
def unit(a):
    return scale(1.0 / norm(a), a)


@kernel
def load_matrix(bands, j, i, like):
    """Block i of band j of a (., n, D*D) array as a D x D matrix; D is that of the vector `like`."""
    if len(like) == 2:
        return (bands[j, i, 0], bands[j, i, 1], bands[j, i, 2], bands[j, i, 3])
    return (
        bands[j, i, 0], bands[j, i, 1], bands[j, i, 2],
        bands[j, i, 3], bands[j, i, 4], bands[j, i, 5],
        bands[j, i, 6], bands[j, i, 7], bands[j, i, 8],
    )  # fmt: skip


@kernel
def store_matrix(bands, j, i, m):
    if len(m) == 4:
        bands[j, i, 0] = m[0]
        bands[j, i, 1] = m[1]
        bands[j, i, 2] = m[2]
        bands[j, i, 3] = m[3]
    else:
        bands[j, i, 0] = m[0]
        bands[j, i, 1] = m[1]
        bands[j, i, 2] = m[2]
        bands[j, i, 3] = m[3]
        bands[j, i, 4] = m[4]
        bands[j, i, 5] = m[5]
        bands[j, i, 6] = m[6]
        bands[j, i, 7] = m[7]
        bands[j, i, 8] = m[8]


@kernel
def diagonal(s, like):
    """s times the identity."""
    if len(like) == 2:
        return (s, 0.0, 0.0, s)
    return (s, 0.0, 0.0, 0.0, s, 0.0, 0.0, 0.0, s)


@kernel
def outer(a, b):
    if len(a) == 2:
        return (a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1])
    return (
        a[0] * b[0], a[0] * b[1], a[0] * b[2],
        a[1] * b[0], a[1] * b[1], a[1] * b[2],
        a[2] * b[0], a[2] * b[1], a[2] * b[2],
    )  # fmt: skip


@kernel
def add_matrix(m, n):
    if len(m) == 4:
        return (m[0] + n[0], m[1] + n[1], m[2] + n[2], m[3] + n[3])
    return (
        m[0] + n[0], m[1] + n[1], m[2] + n[2],
        m[3] + n[3], m[4] + n[4], m[5] + n[5],
        m[6] + n[6], m[7] + n[7], m[8] + n[8],
    )  # fmt: skip


@kernel
def scale_matrix(s, m):
    if len(m) == 4:
        return (s * m[0], s * m[1], s * m[2], s * m[3])
    return (
        s * m[0], s * m[1], s * m[2],
        s * m[3], s * m[4], s * m[5],
        s * m[6], s * m[7], s * m[8],
    )  # fmt: skip


@kernel
def apply(m, a):
    """Matrix times vector."""
    if len(a) == 2:
        return (m[0] * a[0] + m[1] * a[1], m[2] * a[0] + m[3] * a[1])
    return (
        m[0] * a[0] + m[1] * a[1] + m[2] * a[2],
        m[3] * a[0] + m[4] * a[1] + m[5] * a[2],
        m[6] * a[0] + m[7] * a[1] + m[8] * a[2],
    )


@kernel
def apply_transposed(m, a):
    """Transposed matrix times vector."""
    if len(a) == 2:
        return (m[0] * a[0] + m[2] * a[1], m[1] * a[0] + m[3] * a[1])
    return (
        m[0] * a[0] + m[3] * a[1] + m[6] * a[2],
        m[1] * a[0] + m[4] * a[1] + m[7] * a[2],
        m[2] * a[0] + m[5] * a[1] + m[8] * a[2],
    )


@kernel
def multiply(m, n):
    """Matrix times matrix."""
    if len(m) == 4:
        return (
            m[0] * n[0] + m[1] * n[2], m[0] * n[1] + m[1] * n[3],
            m[2] * n[0] + m[3] * n[2], m[2] * n[1] + m[3] * n[3],
        )  # fmt: skip
    return (
        m[0] * n[0] + m[1] * n[3] + m[2] * n[6], m[0] * n[1] + m[1] * n[4] + m[2] * n[7], m[0] * n[2] + m[1] * n[5] + m[2] * n[8],
        m[3] * n[0] + m[4] * n[3] + m[5] * n[6], m[3] * n[1] + m[4] * n[4] + m[5] * n[7], m[3] * n[2] + m[4] * n[5] + m[5] * n[8],
        m[6] * n[0] + m[7] * n[3] + m[8] * n[6], m[6] * n[1] + m[7] * n[4] + m[8] * n[7], m[6] * n[2] + m[7] * n[5] + m[8] * n[8],
    )  # fmt: skip


@kernel
def inverse(m):
    """Inverse by cofactors; for the well-scaled diagonal blocks of a block elimination only."""
    if len(m) == 4:
        d = 1.0 / (m[0] * m[3] - m[1] * m[2])
        return (d * m[3], -d * m[1], -d * m[2], d * m[0])
    c0 = m[4] * m[8] - m[5] * m[7]
    c1 = m[5] * m[6] - m[3] * m[8]
    c2 = m[3] * m[7] - m[4] * m[6]
    d = 1.0 / (m[0] * c0 + m[1] * c1 + m[2] * c2)
    return (
        d * c0, d * (m[2] * m[7] - m[1] * m[8]), d * (m[1] * m[5] - m[2] * m[4]),
        d * c1, d * (m[0] * m[8] - m[2] * m[6]), d * (m[2] * m[3] - m[0] * m[5]),
        d * c2, d * (m[1] * m[6] - m[0] * m[7]), d * (m[0] * m[4] - m[1] * m[3]),
    )  # fmt: skip


@kernel
def copy_to(y, x):
    """y = x, for arrays (n, D)."""
    for i in range(y.shape[0]):
        for k in range(y.shape[1]):
            y[i, k] = x[i, k]
