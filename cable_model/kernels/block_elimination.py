"""Block elimination of fixed structure for the staggered grid: block-tridiagonal, or block-pentadiagonal with bending.

No pivoting: the matrix is positive definite up to drag and follower terms (mass, stiffness, tension >= 0).
Row i couples nodes i-2 ... i+2; `far` (None without bending) says whether the outer bands exist.
"""

from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import (
    apply,
    inverse,
    load,
    load_matrix,
    multiply,
    scale_matrix,
    store,
    store_matrix,
    sub,
)


@kernel
def _minus(m, n):
    if len(m) == 4:
        return (m[0] - n[0], m[1] - n[1], m[2] - n[2], m[3] - n[3])
    return (
        m[0] - n[0], m[1] - n[1], m[2] - n[2],
        m[3] - n[3], m[4] - n[4], m[5] - n[5],
        m[6] - n[6], m[7] - n[7], m[8] - n[8],
    )  # fmt: skip


@kernel
def _lower_outer(far, bands, i, lower, diagonal, right, x, like):
    """Remove node i-2 from row i."""
    if far is None:
        return lower, diagonal, right
    if i < 2:
        return lower, diagonal, right
    outer = load_matrix(bands, 0, i, like)
    lower = _minus(lower, multiply(outer, load_matrix(bands, 3, i - 2, like)))
    diagonal = _minus(diagonal, multiply(outer, load_matrix(bands, 4, i - 2, like)))
    return lower, diagonal, sub(right, apply(outer, load(x, i - 2, like)))


@kernel
def _upper_outer(far, bands, i, upper, lower, like):
    """What node i-1 leaves in the upper band of row i."""
    if far is None:
        return upper
    return _minus(upper, multiply(lower, load_matrix(bands, 4, i - 1, like)))


@kernel
def _store_outer(far, bands, i, pivot, like):
    if far is None:
        return
    store_matrix(bands, 4, i, multiply(pivot, load_matrix(bands, 4, i, like)))


@kernel
def _back_outer(far, bands, i, n, value, x, like):
    if far is None:
        return value
    if i + 2 >= n:
        return value
    return sub(value, apply(load_matrix(bands, 4, i, like), load(x, i + 2, like)))


@kernel
def solve(far, bands, x, n, like):
    """Solve in place: `bands` (5, n, D*D) holds the rows' bands -2..2 and is overwritten; `x` (n, D) the right side, then the solution."""
    for i in range(n):
        lower = load_matrix(bands, 1, i, like)
        diagonal = load_matrix(bands, 2, i, like)
        upper = load_matrix(bands, 3, i, like)
        right = load(x, i, like)
        lower, diagonal, right = _lower_outer(far, bands, i, lower, diagonal, right, x, like)
        if i > 0:
            diagonal = _minus(diagonal, multiply(lower, load_matrix(bands, 3, i - 1, like)))
            right = sub(right, apply(lower, load(x, i - 1, like)))
            upper = _upper_outer(far, bands, i, upper, lower, like)
        pivot = inverse(diagonal)
        store_matrix(bands, 3, i, multiply(pivot, upper))
        _store_outer(far, bands, i, pivot, like)
        store(x, i, apply(pivot, right))
    for i in range(n - 2, -1, -1):
        value = sub(load(x, i, like), apply(load_matrix(bands, 3, i, like), load(x, i + 1, like)))
        store(x, i, _back_outer(far, bands, i, n, value, x, like))


@kernel
def clear_outer(far, bands, n):
    """Set the outer bands to zero before terms are added to them."""
    if far is None:
        return
    for i in range(n):
        for k in range(bands.shape[2]):
            bands[0, i, k] = 0.0
            bands[4, i, k] = 0.0


@kernel
def identity_row(far, bands, x, i, like):
    """Turn row i into 'no change': its node is prescribed."""
    none = scale_matrix(0.0, load_matrix(bands, 2, i, like))
    store_matrix(bands, 1, i, none)
    store_matrix(bands, 3, i, none)
    for k in range(bands.shape[2]):
        bands[2, i, k] = 0.0
    for k in range(len(like)):
        bands[2, i, k * (len(like) + 1)] = 1.0
        x[i, k] = 0.0
    if far is not None:
        for k in range(bands.shape[2]):
            bands[0, i, k] = 0.0
            bands[4, i, k] = 0.0
