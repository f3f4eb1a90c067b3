"""Block elimination of fixed structure for the staggered grid: block-tridiagonal, or block-pentadiagonal with bending.

No pivoting: the matrix is positive definite up to drag and follower terms (mass, stiffness, tension >= 0).
Row i couples nodes i-2 ... i+2; `far` (None without bending) says whether the outer bands exist.  The tension of cell i, along t,
changes by T = c + b.(x_(i+1) - x_i) and loads row i with -T t, row i+1 with T t.  It is eliminated right after node i:

    x_i = u - M x_(i+1) - N x_(i+2) + g T     from row i      (g = pivot t)
    T = T0 + e.x_(i+1) + o.x_(i+2),   e = (b + M'b)/(1 + b.g),  o = N'b/(1 + b.g),  T0 = (c - b.u)/(1 + b.g)

which is well conditioned for every axial stiffness: b/(1 + b.g) stays finite as b grows.  Only above an anchored node g = 0: the first
cell is then a plain spring to the ground, whose stiffness joins the inertia of node 1 and costs digits above EA = 1e8 weights.
"""

from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import (
    add,
    add_matrix,
    apply,
    apply_transposed,
    axpy,
    dot,
    inverse,
    load,
    load_from,
    load_matrix,
    multiply,
    outer,
    scale,
    scale_matrix,
    store,
    store_from,
    store_matrix,
    sub,
    zero,
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
def _tension_outer(far, cells, i, upper, like):
    """What the tension of cell i-1 leaves in the upper band of row i."""
    if far is None:
        return upper
    return add_matrix(upper, outer(load_from(cells, i - 1, 3, like), load_from(cells, i - 1, 3 + 2 * len(like), like)))


@kernel
def _store_outer(far, bands, cells, i, pivot, g, rise, share, like):
    """N of node i, less what it moves through its tension; and o."""
    if far is None:
        return
    across = multiply(pivot, load_matrix(bands, 4, i, like))
    o = scale(share, apply_transposed(across, rise))
    store_from(cells, i, 3 + 2 * len(like), o)
    store_matrix(bands, 4, i, _minus(across, outer(g, o)))


@kernel
def _back_outer(far, bands, cells, i, n, value, x, like):
    """What node i+2 adds to node i and to the tension of cell i."""
    if far is None:
        return value
    if i + 2 >= n:
        return value
    beyond = load(x, i + 2, like)
    cells[i, 1] += dot(load_from(cells, i, 3 + 2 * len(like), like), beyond)
    return sub(value, apply(load_matrix(bands, 4, i, like), beyond))


@kernel
def _moved_by_tension(anchor, pivot, t, i):
    """Motion of node i by a unit of the tension above it: none where it is anchored."""
    if anchor is None:
        return apply(pivot, t)
    if i == 0:
        return zero(t)
    return apply(pivot, t)


@kernel
def solve(far, anchor, bands, x, cells, n, like):
    """Solve in place; node n-1 is prescribed, its change zero.

    `bands` (5, n, D*D), the rows' bands -2 ... 2, is overwritten; `x` (n, D) is the right side, then the solution.
    `cells` (n-1, 3D+5) holds c in column 1, then T; t from column 3 on; b from 3+D on, then e; o from 3+2D on.
    """
    width = len(like)
    for i in range(n - 1):
        lower = load_matrix(bands, 1, i, like)
        diagonal = load_matrix(bands, 2, i, like)
        upper = load_matrix(bands, 3, i, like)
        right = load(x, i, like)
        lower, diagonal, right = _lower_outer(far, bands, i, lower, diagonal, right, x, like)
        if i > 0:
            diagonal = _minus(diagonal, multiply(lower, load_matrix(bands, 3, i - 1, like)))
            right = sub(right, apply(lower, load(x, i - 1, like)))
            upper = _upper_outer(far, bands, i, upper, lower, like)
            below = load_from(cells, i - 1, 3, like)
            diagonal = add_matrix(diagonal, outer(below, load_from(cells, i - 1, 3 + width, like)))
            right = axpy(-cells[i - 1, 1], below, right)
            upper = _tension_outer(far, cells, i, upper, like)
        pivot = inverse(diagonal)
        u = apply(pivot, right)
        across = multiply(pivot, upper)
        rise = load_from(cells, i, 3 + width, like)
        g = _moved_by_tension(anchor, pivot, load_from(cells, i, 3, like), i)
        share = 1.0 / (1.0 + dot(rise, g))
        e = scale(share, add(rise, apply_transposed(across, rise)))
        cells[i, 1] = share * (cells[i, 1] - dot(rise, u))
        store(x, i, axpy(cells[i, 1], g, u))
        store_matrix(bands, 3, i, _minus(across, outer(g, e)))
        _store_outer(far, bands, cells, i, pivot, g, rise, share, like)
        store_from(cells, i, 3 + width, e)
    store(x, n - 1, zero(like))
    for i in range(n - 2, -1, -1):
        above = load(x, i + 1, like)
        cells[i, 1] += dot(load_from(cells, i, 3 + width, like), above)
        value = sub(load(x, i, like), apply(load_matrix(bands, 3, i, like), above))
        store(x, i, _back_outer(far, bands, cells, i, n, value, x, like))


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
