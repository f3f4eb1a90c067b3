"""Names of the inputs and outputs of both models, in the order of the arrays that carry them.  SI; z up from still water."""

SHAPE_POINTS = 11  # of the cable in an FMU, evenly from the lower end to the top

INPUTS = (
    "top.x", "top.y", "top.z",
    "top.vx", "top.vy", "top.vz",
    "top.ax", "top.ay", "top.az",
    "winch.speed",
    "lower.x", "lower.y", "lower.z",
    "lower.vx", "lower.vy", "lower.vz",
    "lower.ax", "lower.ay", "lower.az",
    "water.current_x", "water.current_y",
    "lower_end.let_go",
)  # fmt: skip

OUTPUTS = (
    "top.force_x", "top.force_y", "top.force_z",
    "top.tension", "top.declination",
    "body.x", "body.y", "body.z",
    "body.vx", "body.vy", "body.vz",
    "body.tension",
    "cable.tension_max", "cable.tension_min", "cable.slack_fraction",
    "solver.steps", "solver.newton_iterations", "solver.rejected_steps",
    "top.force_mean_x", "top.force_mean_y", "top.force_mean_z",
    "coupling.growth",
    "audit.energy", "audit.momentum",
    "top.force_next_x", "top.force_next_y", "top.force_next_z",
    "lower.force_x", "lower.force_y", "lower.force_z",
    "lower.force_mean_x", "lower.force_mean_y", "lower.force_mean_z",
    "lower.declination",
    "cable.bending_moment_max", "cable.suspended_length", "seabed.force_z",
    "seabed.touchdown_x", "seabed.touchdown_y", "seabed.touchdown_z",
    "winch.paid_out", "water.elevation",
    "cable.parted", "cable.remaining_length",
    "top.moment_x", "top.moment_y", "top.moment_z", "lower.moment_x", "lower.moment_y", "lower.moment_z",
)  # fmt: skip

SHAPE = tuple(f"shape.{of}[{i}]" for i in range(1, SHAPE_POINTS + 1) for of in ("x", "y", "z", "tension"))  # told where they are asked for
