"""Draws model.png, which lies beside this and goes into every FMU: `python -m fmu_src.documentation.icon`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

PIXELS, COLOURS = 200, 24


def draw(path: Path) -> None:
    """A cable from a vessel at the surface to a body, in few colours: every FMU has it."""
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot
    from PIL import Image

    figure = pyplot.figure(figsize=(2.0, 2.0), dpi=PIXELS / 2.0)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    axes.axis("off")
    along = np.linspace(0.0, 1.0, 60)
    surface = 0.72 + 0.012 * np.sin(8.0 * np.pi * along)
    axes.fill_between(along, 0.0, surface, color="#dcebf5", linewidth=0.0)
    axes.plot(along, surface, color="#3478a6", linewidth=1.5)
    axes.fill([0.56, 0.96, 0.88, 0.62], [0.82, 0.82, 0.70, 0.70], color="#223344")
    axes.plot(0.2 + 0.44 * np.sqrt(along), 0.2 + 0.55 * along, color="#aa3333", linewidth=3.0)
    axes.plot(0.2, 0.2, "o", color="#555577", markersize=16.0)
    figure.savefig(path, metadata={"Software": None})
    pyplot.close(figure)
    with Image.open(path) as drawn:
        drawn.convert("RGB").quantize(COLOURS).save(path, optimize=True)


if __name__ == "__main__":
    draw(Path(__file__).with_name("model.png"))
