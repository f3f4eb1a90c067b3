"""Where the nodes are: uniform, graded towards the lower end, or equally spaced in the travel time of transverse waves.

mesh (n-1, 2): unstretched length h of each cell and its split b, the share of it below the image of the cell's midpoint.
"""

from cable_model.kernels.jit import kernel


@kernel
def arc_length(xi, grading, length, end_tension, weight):
    """Arc length from the lower end at xi in 0..1: length xi^grading, or with grading 0 equal travel time ds ~ sqrt(T)."""
    if grading >= 1.0:
        return length * xi**grading
    top = end_tension + weight * length
    if weight <= 0.0 or end_tension < 0.0:
        return length * xi
    low, high = end_tension**0.5, top**0.5
    return length * xi * (low + xi * (high - low) + low) / (high + low)  # (root^2 - low^2)/weight, exact for next to no weight too


@kernel
def fill_mesh(mesh, grading, length, end_tension, weight):
    n = mesh.shape[0] + 1
    below = 0.0
    for i in range(n - 1):
        middle = arc_length((i + 0.5) / (n - 1), grading, length, end_tension, weight)
        above = length if i == n - 2 else arc_length((i + 1.0) / (n - 1), grading, length, end_tension, weight)
        mesh[i, 0] = above - below
        mesh[i, 1] = (middle - below) / (above - below)
        below = above
