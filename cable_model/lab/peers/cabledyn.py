"""CableDyn (Fortran, finite elements, generalized-alpha) on a scene: its coupled point is driven with the scene's top motion."""

from __future__ import annotations

import numpy as np

from cable_model.errors import ParameterError
from cable_model.lab.peers import deck
from cable_model.scene import Scene
from cable_model.studies.timed import Timed


def run(scene: Scene, segments: int, calls: int) -> Timed:
    """Run a scene from CableDyn's static equilibrium, with its default damping of high frequencies, in `calls` steps an output step.

    Raises ParameterError where CableDyn is not installed, NotTranslated where it cannot run the scene.
    """
    try:
        import cabledyn
    except ImportError as absent:
        raise ParameterError("cabledyn: not installed. Install it with pip install 'cable-fmu[peers]'.") from absent
    deck.refuse_untranslated(scene, "CableDyn")
    if deck.let_go(scene):
        raise deck.NotTranslated("CableDyn cannot let go of a point through its Python interface.")
    outputs = max(1, round(scene.run.duration / scene.run.output_step))
    # it wants a whole number of its steps
    options = (f"{scene.run.output_step / calls} dtM", f"{outputs * scene.run.output_step} TMax", "1e4 kBot", "0 cBot")
    with deck.written(deck.text(scene, segments, options)) as path:
        try:
            system = cabledyn.CableDyn(path)
        except cabledyn.CableDynError as failure:
            return Timed(np.zeros(0), np.zeros(0), np.zeros((0, 3)), 0.0, str(failure))
        with system:
            driven = system.host_dofs()
            line = system.line(1)
            size = system.n_coupled_dof
            q, v, a = np.zeros(size), np.zeros(size), np.zeros(size)

            def move(time: float, h: float, before: np.ndarray, after: np.ndarray) -> None:
                q[driven], v[driven], a[driven] = after[:3], after[3:6], after[6:9]
                try:
                    system.step(h, q, v, a)
                except cabledyn.CableDynError as failure:
                    raise RuntimeError(str(failure)) from failure

            def read() -> tuple[float, np.ndarray]:
                return float(np.linalg.norm(system.calc_output()[driven])), _lower_end(line)

            return deck.drive(scene, calls, move, read)


def _lower_end(line) -> np.ndarray:
    return np.asarray(line.node_positions()).reshape(-1, 3)[0]
