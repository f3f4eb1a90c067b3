"""Lines of MoorDyn's input files as scenes: every number where it belongs, forces at rest against the catenary, errors of one line.

The decks in data/moordyn name where their numbers come from.
"""

from __future__ import annotations

import math
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from catenaries import touchdown
from typer.testing import CliRunner

from cable_model import moordyn_scene
from cable_model.cable_chain import CableChain
from cable_model.cli import app
from cable_model.errors import ParameterError
from cable_model.moordyn import read
from cable_model.moordyn_scene import scene_of
from cable_model.motion import motion_of
from cable_model.scene import from_dict, load

DATA = Path(__file__).parent / "data" / "moordyn"


def at_rest(scene) -> np.ndarray:
    """The outputs of the chain at rest."""
    model = CableChain(scene)
    model.initialize(motion_of(scene)(0.0, 1))
    return np.array(model.outputs)


# the bottom of the chains is so soft (1e5 Pa/m) that they sink in by 0.13 m, which a catenary does not know
@pytest.mark.parametrize(("name", "line", "within"), [
    ("oc3_hywind", 1, 5e-4), ("oc3_hywind", 2, 5e-4), ("chain_200m", 1, 2e-3), ("chain_50m", 1, 5e-3),
])  # fmt: skip
def test_an_imported_mooring_pulls_as_the_elastic_catenary(name, line, within):
    scene, _ = scene_of(read(DATA / f"{name}.txt"), line)
    cable, top, anchor = scene.cable, scene.top.position, scene.lower_end
    weight = (cable.mass_per_length - scene.water.density * cable.displaced_area) * scene.environment.gravity
    span = math.hypot(top[0] - anchor.x, top[1] - anchor.y)
    across, suspended = touchdown(cable.length, weight, cable.axial_stiffness, span, top[2] - anchor.z)
    up = weight * suspended
    outputs = at_rest(scene)
    assert math.hypot(*outputs[:2]) == pytest.approx(across, rel=within)
    assert outputs[2] == pytest.approx(-up, rel=within)
    assert outputs[3] == pytest.approx(math.hypot(across, up), rel=within)


def test_a_mooring_has_every_number_of_its_deck():
    scene, told = scene_of(read(DATA / "oc3_hywind.txt"), 1)
    damping = 0.8 * (902.2 / 20) * math.sqrt(384.243e6 * 77.7066)
    assert scene == from_dict({
        "title": "Three chains of the OC3-Hywind spar Numbers: example/lines.txt of MoorDyn 2.7.1 (BSD-3-Clause)",
        "source": "MoorDyn input file oc3_hywind.txt, line 1",
        "cable": {
            "length": 902.2, "diameter": 0.09, "mass_per_length": 77.7066, "axial_stiffness": 384.243e6, "axial_damping": damping,
            "normal_drag_coefficient": 1.6, "tangential_drag_coefficient": 0.1 * math.pi, "added_mass_coefficient": 1.0,
        },
        "top": {"position": [5.2, 0.0, -70.0]}, "lower_end": {"anchored": True, "x": 853.87, "z": -320.0},
        "environment": {"gravity": 9.80665}, "water": {"density": 1025.0},
        "seabed": {"level": -320.0, "stiffness": 3e6, "damping_ratio": 1.5e5 * math.sqrt(0.09 / (3e6 * 77.7066))},
    })  # fmt: skip
    assert told == [
        f"changed: BA = -0.8 of critical: cable.axial_damping = {damping:.6g} N.s, that of 20 segments",
        "changed: point 4, Coupled: it is the top and stands still; give [[top.motion]] or move it as an FMU",
        "changed: motion in space: the cable moves in the plane of x and z; solver.space = true lets it leave that",
        "changed: NumSegs = 20: solver.nodes = 51, the default, is finer",
        "left out: dtM = 0.002: steps are implicit here: see solver.time_step",
        "left out: LineOutputs p: every run has the outputs of docs/fmu_variables.md",
        "changed: output FairTen1: its name here is top.tension",
        "changed: output AnchTen1: its name here is body.tension",
        "left out: output FairTen2: every run has the outputs of docs/fmu_variables.md",
        "left out: lines 2, 3 with their types and points: import each by itself with --line",
    ]


def test_a_lowered_body_has_every_number_of_its_deck_and_what_has_no_place_is_told():
    scene, told = scene_of(read(DATA / "lowered.txt"))
    assert scene == from_dict({
        "title": "A body of 5 t on 400 m of rope, of everything that a file may say", "source": "MoorDyn input file lowered.txt, line 1",
        "cable": {
            "length": 400.0, "diameter": 0.05, "mass_per_length": 2.5, "axial_stiffness": 1e6, "axial_damping": 1e4,
            "stiffness_curve": [[0.0, 0.0], [0.02, 1e4], [0.04, 4e4]], "bending_stiffness": 3.5, "normal_drag_coefficient": 1.2,
            "tangential_drag_coefficient": 0.02 * math.pi, "added_mass_coefficient": 1.1,
        },
        "body": {"mass": 5000.0, "volume": 0.6, "drag_area": 2.5, "added_mass": 0.5 * 1000.0 * 0.6},
        "top": {"position": [3.0, 4.0, 5.0]}, "environment": {"gravity": 9.81}, "water": {"density": 1000.0},
        "seabed": {"level": -600.0, "stiffness": 3e6, "damping_ratio": 1.5e5 * math.sqrt(0.05 / (3e6 * 2.5))},
        "solver": {"nodes": 81}, "run": {"output_step": 0.2},
    })  # fmt: skip
    assert told == [
        "left out: dynamic stiffness 2e6|0.4: cable.axial_stiffness is the static one, rope.dat",
        "changed: EA = rope.dat: its rows are joined smoothly in cable.stiffness_curve, by straight lines in MoorDyn",
        "left out: dynamic damping BA_d = 2e4: the material is elastic with one damping here",
        "left out: CaAx = 0.5: there is no added mass along the cable here",
        "left out: Cl = 0.7: there is no vortex-induced vibration here",
        "changed: point 1, CPLD: it is the top and stands still; give [[top.motion]] or move it as an FMU",
        "left out: Mass of point 1: the end is held or moved, and feels the cable alone here",
        "left out: force on point 2: a body feels weight, water and cable alone here",
        "left out: place of point 2: the scene starts at rest, which is solved for",
        "changed: point 2: above the surface it is dry here, in MoorDyn it floats and drags there too",
        "changed: motion in space: the cable moves in the plane of x and z; solver.space = true lets it leave that",
        "changed: WtrDpth = 0: the depth is 600 m, of the lowest point, as in MoorDyn",
        "left out: dtM = 0.01: steps are implicit here: see solver.time_step",
        "left out: WaveKin = 3: give [waves] in the scene",
        "left out: NewOption = 1: it is unknown here",
        "changed: output FairTen1: its name here is body.tension",
        "changed: output AnchTen1: its name here is top.tension",
        "left out: point 3: it holds no line",
        "left out: line type spare: no line has it",
        "left out: ROD TYPES bar: a cable between a top and a lower end is all there is here",
        "left out: BODIES 1: a cable between a top and a lower end is all there is here",
        "left out: FAILURE 1: give cable.breaking_tension, or parting.time and parting.place",
    ]


def test_the_command_writes_a_scene_that_loads_and_says_what_was_left_out(tmp_path):
    target = tmp_path / "line.toml"
    result = CliRunner().invoke(app, ["import", str(DATA / "oc3_hywind.txt"), "--line", "2", "-o", str(target)])
    scene, told = scene_of(read(DATA / "oc3_hywind.txt"), 2)
    assert result.exit_code == 0
    assert result.output.splitlines() == [*told, f"wrote {target}"]
    assert load(target) == scene
    assert scene.solver.space and scene.lower_end.y == 739.47
    assert [line.removeprefix("# ") for line in target.read_text(encoding="utf-8").splitlines()[: len(told)]] == told


def test_a_scene_is_named_as_its_deck_and_line_and_a_folder_of_that_name_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    deck = shutil.copy(DATA / "oc3_hywind.txt", tmp_path / "oc3.v2.txt")
    for line in ("1", "2"):
        assert CliRunner().invoke(app, ["import", str(deck), "--line", line]).exit_code == 0
    assert sorted(path.name for path in tmp_path.glob("*.toml")) == ["oc3.v2_line1.toml", "oc3.v2_line2.toml"]
    (tmp_path / "oc3.v2_line3.toml").mkdir()
    result = CliRunner().invoke(app, ["import", str(deck), "--line", "3"])
    assert str(result.exception) == "oc3.v2_line3.toml: is a folder. Give the name of a file."


@pytest.fixture
def changed(tmp_path):
    """Makes the scene of a deck of data/moordyn, as lines.txt, in which texts are replaced."""

    def scene(name, changes, line=None):
        text = (DATA / f"{name}.txt").read_text(encoding="utf-8")
        for old, new in changes:
            assert text.count(old) == 1
            text = text.replace(old, new)
        (tmp_path / "lines.txt").write_text(text, encoding="utf-8")
        return scene_of(read(tmp_path / "lines.txt"), line)

    shutil.copy(DATA / "rope.dat", tmp_path)
    return scene


def test_a_fixed_point_over_a_free_one_is_the_top_and_a_deep_seabed_is_left_out(changed):
    fixed, deep = ("CPLD     3     4     5 ", "Fixed    3     4     5 "), ("0     0     -600", "0     0     -900")
    scene, told = changed("lowered", (fixed, deep))
    assert scene.top.position == (3.0, 4.0, 5.0)
    assert scene.seabed.stiffness == 0.0
    assert "left out: the seabed at z = -900 m: it lies deeper than 2 lengths below the top" in told


JOINED = (  # a chain from the anchor, point 3, to the body, and the rope to the top
    ("rope.dat|2e6|0.4", "1e6             "),
    ("spare   0.05   2.5      1e6                1e4 ", "spare   0.08   40       9e7                -0.5"),
    (
        "1     rope   1         2         400        80        -",
        "1     rope   1         2         400        80        -\n7     spare  2         3         250        20        t",
    ),
)


@pytest.mark.parametrize("number", [None, 1, 7])
def test_lines_that_meet_at_a_free_point_are_sections_with_its_body_between_them(changed, number):
    """Whichever of them is named, from the lower end to the top."""
    scene, told = changed("lowered", JOINED, number)
    chain, rope = scene.cable.section
    assert (chain.length, chain.mass_per_length, chain.diameter, chain.axial_stiffness) == (250.0, 40.0, 0.08, 9e7)
    assert chain.axial_damping == pytest.approx(0.5 * 250.0 / 20 * math.sqrt(9e7 * 40.0))
    assert (rope.length, rope.axial_stiffness, rope.bending_stiffness, rope.added_mass_coefficient) == (400.0, 1e6, 3.5, 1.1)
    (body,) = scene.cable.body
    assert (body.at, body.mass, body.volume, body.drag_area, body.added_mass) == (250.0, 5000.0, 0.6, 2.5, 0.5 * 1000.0 * 0.6)
    assert scene.lower_end.anchored and scene.lower_end.z == -600.0 and scene.top.position == (3.0, 4.0, 5.0)
    assert scene.solver.nodes == 101 and scene.source == "MoorDyn input file lines.txt, lines 7, 1"
    assert "left out: force on point 2: a body feels weight, water and cable alone here" in told
    assert "changed: output AnchTen1: its name here is top.tension" in told
    assert "left out: output FairTen1: every run has the outputs of docs/fmu_variables.md" in told
    assert not any("with their types and points" in text or "line type" in text for text in told)


HUNG = "1     rope   1         2         400        80        -"
WRONG = [
    ("oc3_hywind", (), None, "lines.txt: has the lines 1, 2, 3. Name one with --line."),
    ("oc3_hywind", (), 7, "lines.txt: has no line 7, only 1, 2, 3. Name one of them with --line."),
    ("lowered", (("rope    0.05   2.5 ", "rope    0.05   2,5 "),), None, "lines.txt, row 5: Mass/m = '2,5': must be a number. Mend it."),
    ("lowered", (("rope    0.05 ", "rope    0    "),), None, "lines.txt, row 5: Diam = 0: must be > 0. Mend it."),
    (
        "lowered", (("1e6                1e4        0      1.2   1.0   0.02   0\n", "1e6                1e4        0\n"),), None,
        "lines.txt, row 6: a line type has 6 columns: must be 10 as in MoorDyn v2 (v1 has no EI). Complete the row.",
    ),
    ("lowered", (("-390   5000", "-390   5t"),), None, "lines.txt, row 19: Mass = '5t': must be a number. Mend it."),
    (
        "lowered", ((HUNG, HUNG[:30]),), None, "lines.txt, row 24: NumSegs is missing, column 6 of 4. Complete the row as in MoorDyn v2.",
    ),
    ("lowered", ((HUNG, HUNG.replace("80", "8.5")),), None, "lines.txt, row 24: NumSegs = '8.5': must be a whole number. Mend it."),
    ("lowered", ((HUNG, HUNG.replace("80", "0 ")),), None, "lines.txt, row 24: NumSegs = 0: must be at least 1. Mend it."),
    (
        "lowered", ((HUNG, HUNG.replace("rope", "wire")),), None,
        "lines.txt, row 24: line type 'wire' is unknown: known are rope, spare. Give one of them.",
    ),
    ("lowered", ((HUNG, HUNG.replace(" 2 ", " 8 ")),), None, "lines.txt, row 24: point 8 is unknown: known are 1, 2, 3. Give one of them."),
    (
        "lowered", ((HUNG, HUNG.replace(" 2 ", "R1A")),), None,
        "lines.txt, row 24: end B is on 'R1A': must be a point. Put a coupled, fixed or free point there.",
    ),
    (
        "lowered", (("2     Free     3", "2     Body1    3"),), None,
        "lines.txt, row 19: point 2 is on 'Body1': must be coupled, fixed or free. Write it so, at its place.",
    ),
    (
        "lowered", (("1     CPLD ", "1     Fixed"), ("2     Free     3", "2     Fixed    3")), None,
        "lines.txt, row 24: both ends of line 1 are fixed: one must be the top, coupled (or fixed, over a free one). "
        "Write Coupled at the end that a host moves.",
    ),
    (
        "lowered", ((HUNG, HUNG + "\n" + HUNG.replace("1     rope   1", "2     rope   3") + "\n" + HUNG.replace("1 ", "4 ", 1)),), 1,
        "lines.txt, row 19: point 2 is free and holds the lines 1, 2, 4: must hold two at most. Make it fixed or coupled.",
    ),
    ("lowered", (("-390   5000", "-390   0"),), None,
     "lines.txt, line 1: body.mass = 0 kg: must be > 0 for a body with volume, drag area or added mass. "
     "Give the body's mass, or remove all of [body]."),
    ("lowered", (("1000     rho", "water    rho"),), None, "lines.txt, row 28: rho = 'water': must be a number. Mend it."),
    (
        "lowered", (("1000     rho", "1000"),), None,
        "lines.txt, row 28: the option's name is missing, column 2 of 1. Complete the row as in MoorDyn v2.",
    ),
    (
        "lowered", (("3     Fixed    0 ", "2     Fixed    0 "),), None,
        "lines.txt, row 20: ID 2 stands twice in its section. Give each its own.",
    ),
    (
        "lowered", (("(-)     (m)    (kg/m)   (N)                (N-s)      (Nm2)  (-)   (-)   (-)    (-)    (-)\nrope ", "rope "),
                    ("rope.dat|2e6|0.4", "1e6")), None,
        "lines.txt, row 4: has numbers where a table's names or units stand, which are not read. "
        "Put a row of names and a row of units above it.",
    ),
    (
        "lowered", (("spare ", "rope  "),), None,
        "lines.txt, row 6: line type 'rope' stands twice in its section. Give each its own name.",
    ),
    (
        "lowered", JOINED[1:], None,
        "lines.txt, row 5: EA is a table: must be a number where lines hang together. Give the stiffness at the mean tension.",
    ),
    ("lowered", ((HUNG, ""),), None, "lines.txt: nothing in section LINES. Give a whole MoorDyn v2 input file."),
    ("lowered", (("0.2      dtOut", "-2 kBot"),), None, "lines.txt, row 31: kBot = -2: must be >= 0. Mend it."),
    (
        "lowered", (("rope.dat|2e6|0.4", "SYROPE:a.dat|1|2"),), None,
        "lines.txt, row 5: EA is of Syrope's model: must be a number or a table. Give the stiffness at the mean tension.",
    ),
    ("lowered", (("rope.dat|2e6|0.4", "-1e6            "),), None, "lines.txt, row 5: EA = -1e6: must be > 0. Mend it."),
]  # fmt: skip


@pytest.mark.parametrize(("name", "changes", "line", "words"), WRONG)
def test_what_is_wrong_in_a_deck_is_told_with_its_file_and_row(changed, name, changes, line, words):
    with pytest.raises(ParameterError) as refused:
        changed(name, changes, line)
    assert str(refused.value) == words


def test_of_two_coupled_points_the_lower_one_is_a_driven_lower_end(changed):
    scene, told = changed("lowered", (("2     Free     3", "2     Coupled  3"),))
    assert (scene.lower_end.driven, scene.lower.position, scene.top.position) == (True, (3.0, 4.0, -390.0), (3.0, 4.0, 5.0))
    assert "changed: point 2, Coupled: it is the lower end and stands still; give [[lower.motion]] or move it as an FMU" in told


@pytest.mark.parametrize("lacking", ["LINE TYPES", "POINTS", "LINES", "OPTIONS"])
def test_a_file_that_ends_too_early_is_told_by_the_section_that_it_lacks(lacking, tmp_path):
    text = (DATA / "chain_50m.txt").read_text(encoding="utf-8")
    path = tmp_path / "cut.txt"
    path.write_text(text[: text.index(f"- {lacking} -")].rsplit("\n", 1)[0], encoding="utf-8")
    with pytest.raises(ParameterError, match=rf"^cut\.txt: no section {lacking}\. Give a whole MoorDyn v2 input file\.$"):
        read(path)


@pytest.mark.parametrize(("table", "words"), [
    (None, "lines.txt, row 5: EA = 'rope.dat': must be a number or a file in {folder!r}. Put the file there."),
    ("0 0\n", "lines.txt, row 5: EA = 'rope.dat': must be a file of 3 lines of heads and at least 2 rows. Complete it."),
    ("0 0\n0.1 x\n", "rope.dat, row 5: tension = 'x': must be a number. Mend it."),
    ("0 0\n0 1\n", "rope.dat, row 5: the last strain and tension: must be > 0. Sort the rows by strain."),
    ("0 0\n2 1\n1 2\n", "lines.txt, line 1: cable.stiffness_curve = 3 rows: must be [0, 0] and rows of rising strain and tension. "
                   "Sort the rows by strain."),
])  # fmt: skip
def test_what_is_wrong_with_a_table_of_the_stiffness_is_told(changed, tmp_path, table, words):
    changed("lowered", ())
    (tmp_path / "rope.dat").unlink()
    if table is not None:
        (tmp_path / "rope.dat").write_text("head\nhead\nhead\n" + table, encoding="utf-8")
    with pytest.raises(ParameterError) as refused:
        scene_of(read(tmp_path / "lines.txt"))
    assert str(refused.value) == words.format(folder=str(tmp_path))


def test_friction_is_told_to_be_another_than_moordyns():
    scene, told = scene_of(read(DATA / "chain_50m.txt"))
    assert scene.seabed.friction_coefficient == 0.5
    assert "changed: FrictionCoefficient = 0.5: friction holds a cable at rest here; in MoorDyn it only slows what slides" in told


def test_the_page_has_the_table_of_the_code():
    page = (Path(__file__).parents[1] / "docs" / "how_to" / "moordyn.md").read_text(encoding="utf-8")
    table = page.split("<!-- table -->\n")[1].split("<!-- end of table -->")[0]
    assert len(table) > 2000 and table in str(moordyn_scene.__doc__)


def test_a_deck_that_is_not_there_is_told(tmp_path):
    with pytest.raises(ParameterError, match=r"no such file\. Give the path of a MoorDyn input file\.$"):
        read(tmp_path / "none.txt")


SLOPING = """2 3
-900 100
-200 0 200
-900 -200 -80
-900 0 -81
-900 200 -80
100 -200 -30
100 0 -30
100 200 -32
"""


def test_a_seafloor_of_its_own_file_becomes_a_grid(tmp_path):
    text = (DATA / "chain_50m.txt").read_text(encoding="utf-8")
    (head,) = [line for line in text.splitlines() if "OPTIONS" in line]
    path = tmp_path / "lines.txt"
    path.write_text(text.replace(head, f"{head}\nfloor.txt SeafloorFile"), encoding="utf-8")
    with pytest.raises(ParameterError, match=r"SeafloorFile = 'floor.txt': must be a file in"):
        scene_of(read(path))
    (tmp_path / "floor.txt").write_text(SLOPING.replace("2 3", "3 3"), encoding="utf-8")
    with pytest.raises(ParameterError, match=r"'floor.txt' has 6 points: must be 3 times 3, as its first line says"):
        scene_of(read(path))
    (tmp_path / "floor.txt").write_text(SLOPING, encoding="utf-8")
    flat, _ = scene_of(read(DATA / "chain_50m.txt"))
    scene, told = scene_of(read(path))
    rows = [tuple(float(word) for word in line.split()) for line in SLOPING.splitlines()[3:]]
    assert scene.seabed == replace(flat.seabed, level=0.0, grid=tuple(rows))
    assert scene.solver.space
    assert (
        "changed: SeafloorFile = floor.txt: seabed.grid joins its heights smoothly and goes straight on; MoorDyn by lines, and level"
        in told
    )
    assert "left out: WtrDpth = 50: heights come from floor.txt" in told
