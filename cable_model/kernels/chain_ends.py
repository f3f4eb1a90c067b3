"""Where the ends of the chain are held and how they go: on their course within a communication step, less what has drifted."""

from typing import NamedTuple

from cable_model.kernels import grid, header
from cable_model.kernels.choice import by_presence
from cable_model.kernels.fluid import Stream, with_stream
from cable_model.kernels.jit import kernel
from cable_model.kernels.layout import vector_at
from cable_model.kernels.path import CARRIED, LOWER_END, UPPER_END, Ends, arrive, leaves_plane, stream_crosses, take_stream
from cable_model.kernels.pending import followed
from cable_model.kernels.vector import axes, axpy, sub


class Course(NamedTuple):
    """Where the ends, the winch and the water go while a communication step is integrated."""

    path: object
    span: float  # s
    bridge: object  # over the time that was pending at its start
    pending: float  # s


@kernel
def _end_on(parts, course, which, time):
    x, vx, _ = followed(course.path, course.span, course.bridge, course.pending, time, which.column)
    y, vy, _ = followed(course.path, course.span, course.bridge, course.pending, time, which.column + 1)
    z, vz, _ = followed(course.path, course.span, course.bridge, course.pending, time, which.column + 2)
    return axes(parts.space, x, y, z), axes(parts.space, vx, vy, vz)


@kernel
def _none_on(driven, parts, course, time):
    still = axes(parts.space, 0.0, 0.0, 0.0)
    return still, still


@kernel
def _driven_on(driven, parts, course, time):
    return _end_on(parts, course, LOWER_END, time)


_lower_on = by_presence(_none_on, _driven_on)


@kernel
def ends_on(parts, course, time):
    """Places and velocities of the ends in the chain's dimension at `time` from the start of the communication step.

    Those of a lower end that nothing drives are 0.
    """
    top, top_velocity = _end_on(parts, course, UPPER_END, time)
    lower, lower_velocity = _lower_on(parts.driven, parts, course, time)
    return Ends(top, lower), Ends(top_velocity, lower_velocity)


@kernel
def _rate_on(parts, course, which, time):
    _, _, x = followed(course.path, course.span, course.bridge, course.pending, time, which.column)
    _, _, y = followed(course.path, course.span, course.bridge, course.pending, time, which.column + 1)
    _, _, z = followed(course.path, course.span, course.bridge, course.pending, time, which.column + 2)
    return axes(parts.space, x, y, z)


@kernel
def accelerations_on(parts, course, time):
    """Accelerations of the top, and of a lower end that has gone: 0."""
    return Ends(_rate_on(parts, course, UPPER_END, time), axes(parts.space, 0.0, 0.0, 0.0))


@kernel
def _in_stream(stream, parts, course, began, done):
    _, x, rate_x = followed(course.path, course.span, course.bridge, course.pending, done, CARRIED)
    _, y, rate_y = followed(course.path, course.span, course.bridge, course.pending, done, CARRIED + 1)
    return with_stream(parts, Stream(x, y, rate_x, rate_y, began + done))


@kernel
def _as_they_are(stream, parts, course, began, done):
    return parts


_flowing = by_presence(_as_they_are, _in_stream)


@kernel
def in_water_at(parts, course, began, done):
    """The parts with the current that inputs give `done` after a communication step began."""
    return _flowing(parts.stream, parts, course, began, done)


@kernel
def _free(anchor, space, p):
    return None


@kernel
def _anchored(anchor, space, p):
    return axes(space, p[0].lower_end.x, p[0].lower_end.y, p[0].lower_end.z)


_anchor = by_presence(_free, _anchored)


@kernel
def _at_anchor(driven, parts, p, state):
    return _anchor(parts.anchor, parts.space, p)


@kernel
def _where_driven(driven, parts, p, state):
    return vector_at(parts, state, header.LOWER)


held_place = by_presence(_at_anchor, _where_driven)  # of the lower end at the start; None where nothing holds it


@kernel
def _resting(driven, parts, state, k):
    return axes(parts.space, 0.0, 0.0, 0.0)


@kernel
def _moving(driven, parts, state, k):
    return vector_at(parts, state, header.LOWER + k)


_lower_rate = by_presence(_resting, _moving)


@kernel
def end_rates(parts, state, k):
    """Velocities (k = 3) or accelerations (6) of the ends now."""
    return Ends(vector_at(parts, state, header.TOP + k), _lower_rate(parts.driven, parts, state, k))


@kernel
def _as_prescribed(held, parts, p, view, velocity, position, h):
    return velocity


@kernel
def _drawn_to(held, parts, p, view, velocity, position, h):
    """Velocity that also removes the drift between the prescribed top and its integrated position, a quarter of it within h."""
    integrated = grid.held_top(parts.box, parts.inextensible, view, _anchored(held, parts.space, p))
    return axpy(0.25 / h, sub(position, integrated), velocity)


_above_seabed = by_presence(_as_prescribed, _drawn_to)


@kernel
def _without_anchor(anchor, parts, p, view, velocity, position, h):
    return _above_seabed(parts.seabed, parts, p, view, velocity, position, h)


_top_velocity = by_presence(_without_anchor, _drawn_to)  # drift arises where something below holds the cable


@kernel
def _lower_drawn_to(driven, parts, p, view, velocity, position, h):
    """The same for a driven lower end: it has come to where all cell vectors lead down from the integrated top."""
    at = grid.held_top(parts.box, parts.inextensible, view, position)
    for i in range(view.mesh.shape[0]):
        at = axpy(-view.mesh[i, 0], grid.cell_vector(parts.box, parts.inextensible, view, i, at), at)
    return axpy(0.25 / h, sub(position, at), velocity)


_lower_velocity = by_presence(_as_prescribed, _lower_drawn_to)


@kernel
def closing_velocities(parts, p, view, velocities, places, h):
    """Velocities of the ends at the end of a step that also remove what they have drifted from `places` at its start, within some h."""
    return Ends(
        _top_velocity(parts.anchor, parts, p, view, velocities.top, places.top, h),
        _lower_velocity(parts.driven, parts, p, view, velocities.lower, places.lower, h),
    )


@kernel
def an_end_leaves_plane(parts, path, state, length):
    """Whether an end, or a current that inputs give, leaves the vertical plane of a chain that moves in one."""
    if parts.space is not None:
        return False
    if stream_crosses(path):
        return True
    y = state[header.TOP + 1]
    if parts.driven is not None and leaves_plane(path, y, length, LOWER_END):
        return True
    return leaves_plane(path, y, length, UPPER_END)


@kernel
def move_ends(parts, path, state):
    """Take the ends and the stream to the end of a path."""
    take_stream(path, state)
    arrive(UPPER_END, path, state)
    if parts.driven is not None:
        arrive(LOWER_END, path, state)
