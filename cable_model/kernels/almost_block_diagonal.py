"""Elimination for the box grid: an almost block diagonal matrix, with pivoting among the rows that are still there.

N unknowns a node.  Rows: N/2 end conditions on the first node (`lower`), N rows for each cell on its two nodes (`blocks`),
N/2 end conditions on the last node (`upper`).  The N/2 rows that a cell cannot eliminate are carried to the next one, so
every column is eliminated among 3N/2 rows and the work is linear in the number of nodes.
"""

from cable_model.kernels.jit import kernel


@kernel
def _eliminate(stack, rows, columns, width):
    """Eliminate the first `columns` columns of `stack` with row pivoting; keeps the reciprocals of the pivots."""
    for k in range(columns):
        best = k
        size = abs(stack[k, k])
        for r in range(k + 1, rows):
            if abs(stack[r, k]) > size:
                size = abs(stack[r, k])
                best = r
        if best != k:
            for j in range(k, width):
                kept = stack[k, j]
                stack[k, j] = stack[best, j]
                stack[best, j] = kept
        inverse = 1.0 / stack[k, k]
        stack[k, k] = inverse
        for r in range(k + 1, rows):
            factor = stack[r, k] * inverse
            if factor != 0.0:
                for j in range(k + 1, width):
                    stack[r, j] -= factor * stack[k, j]


@kernel
def solve(blocks, lower, upper, stack, x, like):
    """Solve into x (n, N): blocks (>=n-1, N, 2N+1), lower and upper (N/2, N+1), each row's last number its right-hand side.

    `like` has the length N; `stack` (3N/2, 2N+1) is work.  blocks are overwritten.
    """
    size = len(like)
    half = size // 2
    rows = size + half
    width = 2 * size + 1
    n = x.shape[0]
    for r in range(half):
        for k in range(size):
            stack[r, k] = lower[r, k]
            stack[r, size + k] = 0.0
        stack[r, 2 * size] = lower[r, size]
    for i in range(n - 1):
        for r in range(size):
            for k in range(width):
                stack[half + r, k] = blocks[i, r, k]
        _eliminate(stack, rows, size, width)
        for r in range(size):
            for k in range(r, width):
                blocks[i, r, k] = stack[r, k]
        for r in range(half):
            for k in range(size):
                stack[r, k] = stack[size + r, size + k]
                stack[r, size + k] = 0.0
            stack[r, 2 * size] = stack[size + r, 2 * size]
    for r in range(half):
        for k in range(size):
            stack[half + r, k] = upper[r, k]
            stack[half + r, size + k] = 0.0
        stack[half + r, 2 * size] = upper[r, size]
    _eliminate(stack, size, size, width)
    for r in range(size - 1, -1, -1):
        value = stack[r, 2 * size]
        for k in range(r + 1, size):
            value -= stack[r, k] * x[n - 1, k]
        x[n - 1, r] = value * stack[r, r]
    for i in range(n - 2, -1, -1):
        for r in range(size - 1, -1, -1):
            value = blocks[i, r, 2 * size]
            for k in range(size):
                value -= blocks[i, r, size + k] * x[i + 1, k]
            for k in range(r + 1, size):
                value -= blocks[i, r, k] * x[i, k]
            x[i, r] = value * blocks[i, r, r]
