"""Records of the surface over points, where waves reach up to it as it is: see wave_records.py, whose heads they have."""

from cable_model.kernels.choice import by_presence
from cable_model.kernels.jit import kernel
from cable_model.kernels.vector import axpy, norm, sub, upward
from cable_model.kernels.wave_records import (
    MOMENT,
    MOST_TRIES,
    PLACE,
    SPAN,
    TOLERANCE,
    ahead_of,
    begin_record,
    limit_reach,
    path_of,
    polynomials,
    serves,
)
from cable_model.kernels.wave_sums import AMPLITUDE, heights
from cable_model.kernels.wave_terms import (
    ORDER,
    add_surface_in_plane,
    add_surface_in_space,
    raise_terms,
    row_of_directions,
    set_terms,
    square_sums,
    square_sums_at_surface,
)

SURFACE_TOLERANCE = 5.0 * TOLERANCE  # of the surface's rate and height, which move the water's motion by less than itself


@kernel
def _renew_surface(waves, records, record, position, velocity, t):
    least = square_sums_at_surface(waves, AMPLITUDE)
    along = row_of_directions(position)
    first = PLACE + 2 * len(position)
    ahead = ahead_of(record)
    tries = 0
    while True:
        place = axpy(ahead, velocity, position)
        begin_record(record, place, velocity, t + ahead)
        set_terms(waves, AMPLITUDE, along, waves.shape[1], place, 0.0, t + ahead, velocity, 0.0, records.terms)
        squares = square_sums(waves, waves.shape[1], records.terms)
        for order in range(ORDER + 2):
            if order > 0:
                raise_terms(waves.shape[1], 1.0 / order, records.terms)
            if order <= ORDER and len(position) == 2:
                add_surface_in_plane(waves, along, waves.shape[1], records.terms, record, first + order)
            elif order <= ORDER:
                add_surface_in_space(waves, along, waves.shape[1], records.terms, record, first + order)
        missing, _, _, _ = square_sums(waves, waves.shape[1], records.terms)
        limit_reach(record, squares, missing, least, norm(velocity), SURFACE_TOLERANCE)
        tries += 1
        if ahead < record[SPAN] or tries == MOST_TRIES:
            return
        ahead = ahead_of(record) if tries < MOST_TRIES - 1 else 0.0


@kernel
def _surface_summed(followed, waves, i, velocity, position, t):
    return heights(waves, position, t)


@kernel
def _flat(v):
    return axpy(-v[len(v) - 1], upward(1.0, v), v)


@kernel
def _reads(records, i):
    """Whose record a point reads; a state from outside may say anything."""
    reads = records[i, records.shape[1] - 1]
    return int(reads) if 0.0 <= reads < records.shape[0] else i


@kernel
def _surface_record(waves, followed, i, velocity, place, t):
    """The point whose record serves the point i: of points above one another one has it, else each its own."""
    records = followed.surface
    last = records.shape[1] - 1
    k = _reads(records, i)
    if serves(records[k], place, t):
        return k
    k = _reads(records, (i + 1) % records.shape[0])
    if not serves(records[k], place, t):
        k = i
        _renew_surface(waves, followed, records[i], place, velocity, t)
    records[i, last] = k
    return k


@kernel
def _surface_in_plane(record, s, e, speed):
    first = PLACE + 4
    (height, slope, curvature), (rate, slope_rate, curvature_rate) = polynomials(record, first, 0, s)
    bent = slope + curvature * e
    rate += e * (slope_rate + 0.5 * curvature_rate * e) - bent * speed
    return height + e * (slope + 0.5 * curvature * e), rate, (bent, 0.0)


@kernel
def _surface_in_space(record, s, e, speed):
    first = PLACE + 6
    (height, x, y), (rate, x_rate, y_rate) = polynomials(record, first, 0, s)
    (xx, xy, yy), (xx_rate, xy_rate, yy_rate) = polynomials(record, first, 3, s)
    more_x, more_y = xx * e[0] + xy * e[1], xy * e[0] + yy * e[1]
    height += e[0] * (x + 0.5 * more_x) + e[1] * (y + 0.5 * more_y)
    rate += e[0] * (x_rate + 0.5 * (xx_rate * e[0] + xy_rate * e[1])) + e[1] * (y_rate + 0.5 * (xy_rate * e[0] + yy_rate * e[1]))
    x += more_x
    y += more_y
    return height, rate - x * speed[0] - y * speed[1], (x, y, 0.0)


@kernel
def _surface_followed(followed, waves, i, velocity, position, t):
    if i < 0 or i >= followed.surface.shape[0]:
        return heights(waves, position, t)
    place = _flat(position)
    record = followed.surface[_surface_record(waves, followed, i, _flat(velocity), place, t)]
    s = t - record[MOMENT]
    begun, speed = path_of(record, place)
    e = sub(place, axpy(s, speed, begun))
    if len(position) == 2:
        return _surface_in_plane(record, s, e[0], speed[0])
    return _surface_in_space(record, s, e, speed)


surface_at = by_presence(_surface_summed, _surface_followed)
"""As wave_sums.heights, likewise."""
