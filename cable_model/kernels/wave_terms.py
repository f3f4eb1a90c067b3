"""The terms of sums over many waves along a path: E exp(a s) of each component, order by order, and what is added up of them.

See wave_records.py.  A record's polynomials lie one after the other, each with ORDER + 1 coefficients by rising order.
"""

from cable_model.kernels.jit import kernel, summand, summing
from cable_model.kernels.wave_sums import COSINE, FREQUENCY, NUMBER, PHASE, SIGN, SINE, angle_of, circle, power

ORDER = 6  # of the polynomials
TERMS = 4  # rows: real and imaginary part of E, and of a


@summand
def _phasor(size, rise, angle):
    c, s = circle(angle)
    across = size * power(rise)
    return across * c, across * s


@kernel
def set_terms(waves, row, along, count, place, z, t, velocity, rise, terms):
    """E of the components, of the sizes in a row of the table, at a place and moment, and a along a path that rises at `rise`."""
    number, frequency, phase, size = waves[NUMBER], waves[FREQUENCY], waves[PHASE], waves[row]
    to_x, to_y = waves[along], waves[SINE]
    real, imaginary, grows, turns = terms[0], terms[1], terms[2], terms[3]
    x, y, vx, vy = place[0], _y_of(place), velocity[0], _y_of(velocity)
    for j in range(count):
        angle = angle_of(number[j], to_x[j], to_y[j], x, y, frequency[j], t, phase[j])
        real[j], imaginary[j] = _phasor(size[j], number[j] * z, angle)
    for j in range(count):
        grows[j] = number[j] * rise
        turns[j] = number[j] * (to_x[j] * vx + to_y[j] * vy) - frequency[j]


@kernel
def raise_terms(count, share, terms):
    """Times a and a share: the next order's."""
    real, imaginary, grows, turns = terms[0], terms[1], terms[2], terms[3]
    for j in range(count):
        r, i = share * real[j], share * imaginary[j]
        real[j] = r * grows[j] - i * turns[j]
        imaginary[j] = r * turns[j] + i * grows[j]


@kernel
def _y_of(v):
    if len(v) == 2:
        return 0.0
    return v[1]


@kernel
def row_of_directions(like):
    """Of the cosines of the components' directions: in the plane 1 or -1."""
    return SIGN if len(like) == 2 else COSINE


@summing
def add_in_plane(sign, waves, along, count, terms, record, at):
    number, to_x, real, imaginary = waves[NUMBER], waves[along], terms[0], terms[1]
    u = w = u_z = w_z = u_zz = w_zz = 0.0
    for j in range(count):
        k = number[j]
        c, s = to_x[j] * real[j], imaginary[j]
        u += c
        w += s
        u_z += k * c
        w_z += k * s
        u_zz += k * (k * c)
        w_zz += k * (k * s)
    step = ORDER + 1
    record[at] += u
    record[at + step] += sign * w
    record[at + 2 * step] += sign * u_z
    record[at + 3 * step] += w_z
    record[at + 4 * step] += u_zz
    record[at + 5 * step] += sign * w_zz


@summing
def add_in_space(sign, waves, along, count, terms, record, at):
    number, to_x, to_y, real, imaginary = waves[NUMBER], waves[along], waves[SINE], terms[0], terms[1]
    u = v = w = u_z = v_z = w_z = w_xx = w_xy = 0.0
    zzz = xzz = yzz = xxz = xyz = xxx = xxy = 0.0
    for j in range(count):
        k, x, y = number[j], to_x[j], to_y[j]
        c, s = real[j], imaginary[j]
        u += x * c
        v += y * c
        w += s
        c *= k
        s *= k
        u_z += x * c
        v_z += y * c
        w_z += s
        w_xx += x * (x * s)
        w_xy += x * (y * s)
        c *= k
        s *= k
        zzz += s
        xzz += x * c
        yzz += y * c
        xxz += x * (x * s)
        xyz += x * (y * s)
        xxx += x * (x * (x * c))
        xxy += x * (x * (y * c))
    for k, value in enumerate(
        (u, v, sign * w, sign * u_z, sign * v_z, w_z, w_xx, w_xy, sign * zzz, xzz, yzz, sign * xxz, sign * xyz, xxx, xxy)
    ):
        record[at + k * (ORDER + 1)] += value


@summing
def add_surface_in_plane(waves, along, count, terms, record, at):
    number, to_x, real, imaginary = waves[NUMBER], waves[along], terms[0], terms[1]
    height = slope = curvature = 0.0
    for j in range(count):
        steep = number[j] * to_x[j]
        height += real[j]
        slope -= steep * imaginary[j]
        curvature -= steep * (steep * real[j])
    for k, value in enumerate((height, slope, curvature)):
        record[at + k * (ORDER + 1)] += value


@summing
def add_surface_in_space(waves, along, count, terms, record, at):
    number, to_x, to_y, real, imaginary = waves[NUMBER], waves[along], waves[SINE], terms[0], terms[1]
    height = slope_x = slope_y = xx = xy = yy = 0.0
    for j in range(count):
        x, y = number[j] * to_x[j], number[j] * to_y[j]
        height += real[j]
        slope_x -= x * imaginary[j]
        slope_y -= y * imaginary[j]
        xx -= x * (x * real[j])
        xy -= x * (y * real[j])
        yy -= y * (y * real[j])
    for k, value in enumerate((height, slope_x, slope_y, xx, xy, yy)):
        record[at + k * (ORDER + 1)] += value


@summing
def square_sums(waves, count, terms):
    """Sums of the squares of the terms, and of these times the squares of omega, k^3 and k^3 omega."""
    number, frequency, real, imaginary = waves[NUMBER], waves[FREQUENCY], terms[0], terms[1]
    all_of = faster = sharper = both = 0.0
    for j in range(count):
        square = real[j] * real[j] + imaginary[j] * imaginary[j]
        quick = frequency[j] * frequency[j]
        steep = number[j] * number[j] * number[j]
        steep *= steep
        all_of += square
        faster += square * quick
        sharper += square * steep
        both += square * (quick * steep)
    return all_of, faster, sharper, both


@summing
def square_sums_at_surface(waves, row):
    size, frequency = waves[row], waves[FREQUENCY]
    all_of = faster = 0.0
    for j in range(waves.shape[1]):
        square = size[j] * size[j]
        all_of += square
        faster += square * (frequency[j] * frequency[j])
    return all_of, faster
