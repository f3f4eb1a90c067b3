"""A moving picture of runs of a scene: the cable in true proportions, and the top tension beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from cable_model.errors import ParameterError, writing
from cable_model.moving import Picture, arrange, panels
from cable_model.plots import COLOURS, GREY, SEA, SEABED, STYLES, open_axis
from cable_model.scene import Scene
from cable_model.simulation import Result

MOST_FRAMES = 150
WRITERS: dict[str, Any] = {".gif": PillowWriter, ".mp4": FFMpegWriter}
SIDE = {False: (12.0, -80.0), True: (20.0, -60.0)}  # elevation and azimuth from which the cable is seen in the plane, and in space, degrees


def check_movie(path: Path) -> None:
    """Refuse, before minutes are spent, what is no name of a movie, and one that cannot be written here."""
    kind = path.suffix.lower()
    if path.is_dir() or kind not in WRITERS:
        raise ParameterError(f"{path}: no name of a movie. Give one that ends in .gif or .mp4.")
    if not WRITERS[kind].isAvailable():
        raise ParameterError(f"{path}: ffmpeg, which writes {kind}, is not there. Install ffmpeg, or give a name that ends in .gif.")


def write_movie(results: Mapping[str, Result], scene: Scene, path: Path) -> None:
    """Write the movie of runs of a scene by their models' names, as fast as the run where Picture.pace has it so."""
    picture = arrange(results, scene, MOST_FRAMES)
    figure = Figure(figsize=(10.0, 5.6), dpi=80, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(scene.title, parse_math=False, fontsize=11)
    places = figure.add_gridspec(1, 2, width_ratios=(1.6, 1.0), wspace=0.12)
    space: Any = figure.add_subplot(places[0], projection="3d", proj_type="ortho")
    draw = _space(space, picture, scene)
    move = _tension(figure.add_subplot(places[1]), picture, scene)
    writer: AbstractMovieWriter = WRITERS[path.suffix.lower()](fps=1.0 / picture.pace)
    path.parent.mkdir(parents=True, exist_ok=True)
    with writing(path), writer.saving(figure, path, dpi=figure.dpi):
        for k in range(len(picture.times)):
            draw(k)
            move(k)
            writer.grab_frame()


def _space(space: Any, picture: Picture, scene: Scene) -> Callable[[int], None]:
    """Draw water, seabed and cables; what is returned moves them to a moment."""
    space.set(**{f"{axis}lim": (picture.low[k], picture.high[k]) for k, axis in enumerate("xyz")}, xlabel="x [m]", zlabel="z [m]")
    space.set_box_aspect(picture.high - picture.low)
    for k, axis in enumerate((space.xaxis, space.yaxis, space.zaxis)):
        axis.set_major_locator(MaxNLocator(1 + round(5 * (picture.high - picture.low)[k] / picture.size)))
    space.view_init(*SIDE[scene.solver.space])
    if scene.solver.space:
        space.set_ylabel("y [m]")
    else:
        space.set_yticks([])
    if picture.seabed is not None:
        space.plot_surface(*np.meshgrid(picture.seabed.x, picture.seabed.y), picture.seabed.at(0), color=SEABED, alpha=0.35)
    lines = [
        space.plot([], [], [], color=colour, linestyle=style, linewidth=2.5, marker="o", markevery=[0], label=label)[0]
        for label, colour, style in zip(picture.cables, COLOURS, STYLES, strict=False)
    ]
    if len(lines) > 1:
        space.legend(loc="upper left")
    water: list[Any] = []

    def draw(k: int) -> None:
        for line, moving in zip(lines, picture.cables.values(), strict=True):
            line.set_data_3d(*moving.places[k].T)
        if picture.surface is not None and (picture.surface.moves or not water):
            while water:
                water.pop().remove()
            sea = picture.surface
            water.append(space.plot_surface(*np.meshgrid(sea.x, sea.y), sea.at(k), color=SEA, alpha=0.35, rstride=1, cstride=1))

    return draw


def _tension(axis: Axes, picture: Picture, scene: Scene) -> Callable[[int], None]:
    """Draw the top tension; what is returned moves the cursor to a moment."""
    for moving, colour, style in zip(picture.cables.values(), COLOURS, STYLES, strict=False):
        panel = panels(moving.run, scene)[0]
        axis.plot(moving.run["time"], *panel.lines.values(), color=colour, linestyle=style, linewidth=1.2)
        axis.set(xlabel="time [s]", title=panel.label)
        open_axis(axis, panel.least)
    axis.grid(alpha=0.3)
    cursor = axis.axvline(0.0, color=GREY)

    def move(k: int) -> None:
        cursor.set_xdata([picture.times[k]] * 2)

    return move
