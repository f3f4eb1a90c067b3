"""The page on which a cable is watched: it holds all it needs, and shows the places, tensions and waves of the run at their times."""

from __future__ import annotations

import re
import sys
from dataclasses import replace

import numpy as np
import pytest
from page_support import read_page
from PIL import Image
from typer.testing import CliRunner

from cable_model import cli, load, movie
from cable_model.errors import ParameterError
from cable_model.moving import arrange, evenly, keeping_peaks
from cable_model.page import MOST_FRAMES, figure, write_page
from cable_model.scene import from_dict, with_values
from cable_model.simulation import COLUMNS, Result
from cable_model.surroundings import MOST_PLACES

SCENE = """
title = "A chain </script> & a [body]"
[cable]
length = 20.0
mass_per_length = 1.0
axial_stiffness = 1e5
diameter = 0.01
normal_drag_coefficient = 1.2
[body]
mass = 10.0
[water]
[waves]
amplitude = 0.5
period = 4.0
[top]
position = [0.0, 0.0, 2.0]
[[top.motion]]
kind = "sinusoid"
axis = "x"
amplitude = 1.0
angular_frequency = 2.0
ramp_time = 1.0
[solver]
nodes = 26
[run]
duration = 4.0
output_step = 0.01
"""


def viewed(*arguments):
    done = CliRunner().invoke(cli.app, ["view", *map(str, arguments)])
    return done.exit_code, done.output, done.exception


@pytest.fixture(scope="module")
def page(scene):
    path = scene.with_suffix(".html")
    status, told, _ = viewed(scene, "-o", path)
    assert status == 0, told
    return read_page(path)


def moments(run):
    return evenly(len(run.table), MOST_FRAMES)


def test_the_page_loads_nothing_from_elsewhere(page):
    outside = re.sub(r"<script[^>]*>.*?</script>", "", page.text, flags=re.DOTALL)
    assert len(outside) < 1000 and not re.search(r"https?:|src=|<link|<script|@import", outside)
    assert not re.search(r"<script[^>]*\ssrc\b", page.text)
    assert "<title>A chain &lt;/script&gt; &amp; a [body]</title>" in outside


def test_no_button_sends_the_data_away(page):
    assert page.config["modeBarButtons"] == [["toImage", "pan3d", "orbitRotation", "tableRotation", "resetCameraDefault3d"]]


def test_frames_have_the_places_and_tensions_of_the_run_at_their_times(page, run):
    rows = moments(run)
    assert len(page.frames) == len(rows) == MOST_FRAMES
    labels = [float(step["label"]) for step in page.layout["sliders"][0]["steps"]]
    assert labels == pytest.approx(run["time"][rows], abs=0.006)
    for k, row in enumerate(rows):
        cable = page.at(k, "CableChain")
        shown = np.column_stack([cable[axis] for axis in "xyz"])
        assert shown == pytest.approx(run.shapes[row], abs=0.6e-3)  # rounded to a millimetre
        tensions = cable["line"]["color"]
        assert tensions == pytest.approx(run.tensions[row], abs=0.06)
        assert page.frames[k]["data"][-1]["x"] == [run["time"][row]] * 2  # the cursor


def test_rare_peaks_do_not_take_the_colours_from_the_rest(scene, run):
    def bar(tensions):
        shown = figure(arrange({"CableChain": replace(run, tensions=tensions)}, load(scene), 300), load(scene), [])
        (line,) = (trace["line"] for trace in shown["data"] if "cmax" in trace.get("line", {}))
        return line["cmin"], line["cmax"], line["colorbar"]["title"]["text"]

    usual = np.linspace(50.0, 100.0, run.tensions.size).reshape(run.tensions.shape)
    assert bar(usual) == (50.0, pytest.approx(100.0, rel=1e-2), "tension [N]")
    usual[200:202] = 5e4
    least, most, title = bar(usual)
    assert least < most < 150.0 and title == "tension [N]<br>peaks to 50000"


def test_a_page_that_leaves_output_steps_out_says_so(page, scene, run):
    words = "The cable is shown every 0.0134 s, at one of 1.3 output steps: what swings faster looks slower here."
    assert words in page.layout["annotations"][0]["text"]
    short = replace(run, table=run.table[:300], shapes=run.shapes[:300], tensions=run.tensions[:300])
    assert "is shown every" not in str(figure(arrange({"CableChain": short}, load(scene), MOST_FRAMES), load(scene), [])["layout"])


def test_rounding_of_a_run_at_rest_is_not_shown_as_motion(scene, run, tmp_path):
    """Lines of 490 N and 0 m whose last digits move, as they do at rest."""
    table = np.array(run.table)
    noise = np.random.default_rng(1).uniform(-1.0, 1.0, len(table))
    for name, value in (("top.tension", 490.0), ("body.tension", 98.0), ("body.x", 3.0), ("body.z", -18.0)):
        table[:, COLUMNS.index(name)] = value * (1.0 + 1e-13 * noise)
    still = {"CableChain": replace(run, table=table)}
    shown = figure(arrange(still, load(scene), MOST_FRAMES), load(scene), [])["layout"]
    for axis, middle, least in (("yaxis", 490.0, 0.49), ("yaxis2", 98.0, 0.49), ("yaxis3", 0.0, 2e-3)):
        low, high = shown[axis]["range"]
        assert 0.5 * (low + high) == pytest.approx(middle, abs=1e-9) and high - low == pytest.approx(least)
    moving = figure(arrange({"CableChain": run}, load(scene), 9), load(scene), [])["layout"]
    assert "range" not in moving["yaxis"] and "range" not in moving["yaxis3"]


def test_of_two_cables_one_is_coloured_and_both_move(page):
    assert "line" not in page.at(0, "TowCable")
    assert page.at(0, "TowCable")["x"] != page.at(200, "TowCable")["x"]


def test_proportions_are_true(page):
    space = page.layout["scene"]
    scales = [space["aspectratio"][axis] / np.ptp(space[f"{axis}axis"]["range"]) for axis in "xyz"]
    assert space["aspectmode"] == "manual" and scales == pytest.approx([scales[0]] * 3)
    for k in range(len(page.frames)):
        for axis in "xyz":
            low, high = space[f"{axis}axis"]["range"]
            assert all(low <= place <= high for place in page.at(k, "CableChain")[axis])


def test_the_waves_are_those_of_the_scene(page, run):
    (sheet,) = (trace for trace in page.data if trace["type"] == "surface")
    omega = 0.5 * np.pi
    for k, row in enumerate(moments(run)):
        heights = page.frames[k]["data"][0]["z"]
        wave = 0.5 * np.cos(omega**2 / 9.80665 * np.array(sheet["x"]) - omega * run["time"][row])
        assert heights == pytest.approx(np.array([wave, wave]), abs=2e-3)


def test_waves_too_short_for_the_picture_are_not_shown_as_others(scene, run):
    short = with_values(load(scene), {"waves.period": 0.3, "waves.amplitude": 0.01})
    assert not arrange({"CableChain": run}, short, 10).surface.moves
    assert arrange({"CableChain": run}, load(scene), 10).surface.moves


def test_water_and_seabed_that_are_far_away_do_not_make_the_cable_small(run):
    deep = from_dict({
        "cable": {"length": 20.0, "mass_per_length": 1.0, "axial_stiffness": 1e5, "diameter": 0.01}, "water": {},
        "seabed": {"level": -60.0, "stiffness": 1e5},
    })  # fmt: skip
    sunk = Result(run.columns, run.table, run.shapes - np.array([0.0, 0.0, 30.0]))
    picture = arrange({"CableChain": sunk}, deep, 10)
    assert picture.surface is None and picture.seabed.heights.ravel() == pytest.approx([-60.0] * 4)
    assert arrange({"CableChain": run}, deep, 10).seabed is None


def test_no_peak_of_a_series_is_lost():
    series = np.random.default_rng(1).normal(size=100_003)
    series[[12_345, 54_321]] = 99.0, -99.0
    kept = keeping_peaks(series, 2000)
    assert len(kept) <= 2000 and {12_345, 54_321} <= set(kept)


def test_a_long_run_of_a_fine_mesh_in_a_spread_sea_is_below_six_megabytes(tmp_path):
    rows, nodes = 1000, 1001
    random = np.random.default_rng(1)
    table = np.column_stack((np.linspace(0.0, 10800.0, rows), random.uniform(1e4, 1e5, (rows, len(COLUMNS) - 1))))
    run = Result(COLUMNS, table, random.uniform(-300.0, 0.0, (rows, nodes, 3)), tensions=random.uniform(0.0, 1e5, (rows, nodes)))
    sea = from_dict({
        "cable": {"length": 300.0, "mass_per_length": 1.0, "axial_stiffness": 1e5, "diameter": 0.1}, "water": {}, "solver": {"space": True},
        "waves": {"amplitude": 3.0, "period": 11.5},
    })  # fmt: skip
    surface = arrange({"CableChain": run}, sea, 3).surface
    assert surface.moves and 0.5 * MOST_PLACES < len(surface.x) * len(surface.y) <= MOST_PLACES
    straight = Result(COLUMNS, table, run.shapes[:, [0, -1]])
    write_page({"CableChain": run, "TowCable": straight}, sea, tmp_path / "page.html", [])

    assert (tmp_path / "page.html").stat().st_size < 6e6


def test_plotly_knows_every_property_of_the_figure(scene, run):
    objects = pytest.importorskip("plotly.graph_objects")
    shown = figure(arrange({"CableChain": run, "TowCable": run}, load(scene), 3), load(scene), ["an error"])
    objects.Figure(data=shown["data"], layout=shown["layout"])  # what frames repeat of the data has no types


def test_a_run_that_stops_is_shown_so_far_and_told(tmp_path, monkeypatch):
    monkeypatch.setattr(movie, "MOST_FRAMES", 10)
    hauled = tmp_path / "hauled.toml"
    winch = "\n[winch]\nfitted = true\nspeeds = [[0.0, 0.0], [2.0, -40.0]]\n"
    hauled.write_text(SCENE.replace("[waves]\namplitude = 0.5\nperiod = 4.0\n", "") + winch, encoding="utf-8")
    status, told, error = viewed(hauled, "-o", tmp_path / "a.html", "--movie", tmp_path / "a.gif")
    page = read_page(tmp_path / "a.html")
    assert status == 1 and type(error) is cli.RunStopped and f"wrote {tmp_path / 'a.gif'}" in told
    assert str(error).startswith("CableChain at t = 1.") and "the winch hauled in the whole cable" in str(error)
    assert "the winch hauled in the whole cable" in page.layout["annotations"][0]["text"].replace("<br>", " ")
    assert 1.0 < float(page.layout["sliders"][0]["steps"][-1]["label"]) < 2.0
    with Image.open(tmp_path / "a.gif") as moving:
        assert moving.n_frames == 10
        first = np.asarray(moving.convert("L"), dtype=float)
        moving.seek(9)
        changed = np.any(np.abs(first - np.asarray(moving.convert("L"))) > 100.0, axis=0)
        assert np.any(changed[: len(changed) // 2]) and np.any(changed[len(changed) // 2 :])  # the cable, and the cursor


@pytest.mark.skipif(not movie.FFMpegWriter.isAvailable(), reason="no ffmpeg (apt-get install ffmpeg)")
def test_ffmpeg_writes_a_movie(scene, run, tmp_path, monkeypatch):
    monkeypatch.setattr(movie, "MOST_FRAMES", 3)
    movie.write_movie({"CableChain": run}, load(scene), tmp_path / "a.mp4")
    assert (tmp_path / "a.mp4").read_bytes()[4:8] == b"ftyp"


@pytest.fixture
def refused(monkeypatch):
    """The line that an error is; nothing may be simulated before it."""

    def simulated(*arguments: object) -> None:
        raise AssertionError

    monkeypatch.setattr(cli, "run_with_progress", simulated)

    def view(*arguments: object) -> str:
        _, _, error = viewed(*arguments)
        assert type(error) is ParameterError
        return str(error)

    return view


def test_other_files_than_pages_and_movies_are_refused_before_simulating(scene, refused, tmp_path):
    for name in (tmp_path, tmp_path / "a.png"):
        assert refused(scene, "-o", name) == f"{name}: no name of a page. Give one that ends in .html."
        assert refused(scene, "--movie", name) == f"{name}: no name of a movie. Give one that ends in .gif or .mp4."


def test_a_table_of_results_is_refused(refused, tmp_path):
    told = f"{tmp_path / 'a.csv'}: a table of results has no shapes of the cable. Give the scene that it is of."
    assert refused(tmp_path / "a.csv") == told


def test_what_is_not_installed_is_named(scene, refused, monkeypatch):
    monkeypatch.setattr(movie.FFMpegWriter, "isAvailable", lambda: False)
    told = "a.mp4: ffmpeg, which writes .mp4, is not there. Install ffmpeg, or give a name that ends in .gif."
    assert refused(scene, "--movie", "a.mp4") == told
    monkeypatch.setitem(sys.modules, "plotly.io", None)
    assert refused(scene) == "plotly: not installed. Install it with pip install 'cable-fmu[view]'."
