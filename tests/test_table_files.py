"""Tables of a scene in files of their own: CSV, and currents over time and depth as netCDF."""

import dataclasses
import math
import re

import numpy as np
import pytest

from cable_model import load
from cable_model.errors import ParameterError
from cable_model.parameters import holder_of
from cable_model.table_files import _columns

SCENE = """
[cable]
length = 50.0
diameter = 0.02
mass_per_length = 1.5
axial_stiffness = 4e6
[body]
mass = 400.0
[water]
density = 1025.0
[solver]
space = true
"""


def written(folder, more, **files):
    """The scene with more, after its files are written beside it."""
    for name, text in files.items():
        (folder / name.replace("__", ".")).write_text(text, encoding="utf-8")
    path = folder / "scene.toml"
    path.write_text(SCENE + more, encoding="utf-8")
    return path


TEXTS = {
    "commas and names": "time,z,speed,direction\n0,0,0.5,0\n60,0,0.8,1.5\n",
    "semicolons and comments": "# a comment\n0; 0; 0.5; 0\n\n60; 0; 0.8; 1.5  # another",
    "units": "time [s], z (m), Speed (m/s), direction (rad)\n0,0,0.5,0\n60,0,0.8,1.5\n",
    "blanks": "0 0 0.5 0\n60\t0\t0.8\t1.5",
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_rows_come_from_a_file_beside_the_scene(tmp_path, monkeypatch, text):
    path = written(tmp_path, '[current]\ntable = "flow.csv"\n', flow__csv=text)
    monkeypatch.chdir("/")
    assert load(path).current.table == ((0.0, 0.0, 0.5, 0.0), (60.0, 0.0, 0.8, 1.5))


def test_every_table_of_a_scene_may_be_a_file(tmp_path):
    motion = "\n".join(f"{t} 0 0 {0.1 * t * t}" for t in range(6))
    more = '[top]\ntable = "heave.dat"\n[waves]\nrecord = "waves.csv"\n'
    record = "\n".join(f"{0.5 * k},{math.sin(0.5 * k)}" for k in range(40))
    scene = load(written(tmp_path, more, heave__dat=motion, waves__csv=record))
    assert scene.top.table[3] == (3.0, 0.0, 0.0, pytest.approx(0.9))
    assert len(scene.waves.record) == 40


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("0 0 1 0\n1 0 x 0\n", "current.table: {}, line 2: 'x' is no number. Give numbers."),
        ("0 0 1\n", "current.table: {}, line 1 = 3 columns: must be 4: s, m, m/s, rad. Mend the row."),
        ("# nothing\n", "current.table: {}: no rows. Give rows of numbers."),
        ("0 0 nan 0\n", "current.table[0][2] = nan s, m, m/s, rad: must be finite."),
        ("0,0,1.0O,0\n10,0,0.2,0\n", "current.table: {}, line 1: '1.0O' is no number. Give numbers."),
        (
            "z,time,speed,direction\n0,0,1,0\n",
            "current.table: {}, line 1: names 'z,time,speed,direction': must be time (s), z (m), ",
        ),
        (
            "time (h),z,speed,direction\n0,0,1,0\n",
            "current.table: {}, line 1: names 'time (h),z,speed,direction': must be time (s), ",
        ),
        ("time,z,u,v\n0,0,1,0\n", "current.table: {}, line 1: names 'time,z,u,v': must be "),
    ],
)
def test_a_file_that_is_no_table_is_one_clear_error(tmp_path, text, told):
    path = written(tmp_path, '[current]\ntable = "flow.csv"\n', flow__csv=text)
    with pytest.raises(ParameterError) as error:
        load(path)
    assert str(error.value).startswith(told.format(tmp_path / "flow.csv"))


def test_every_table_that_may_be_a_file_says_what_its_columns_are_called():
    """As the first row of a file may call them: as many names as there are columns, and a unit for each."""
    found = []
    for part in ("top", "lower", "winch", "cable", "current", "waves"):
        for field in dataclasses.fields(holder_of(f"{part}.x")):
            count = _columns(f"{part}.{field.name}")
            if count:
                found.append(f"{part}.{field.name}")
                assert len(re.findall(r"\[(.*?)\]", field.metadata["description"])[0].split(", ")) == count, found[-1]
                assert len(field.metadata["unit"].split(", ")) == count, found[-1]
    assert {"top.table", "lower.table", "winch.speeds", "current.levels", "current.table", "waves.table", "waves.record"} < set(found)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(ParameterError, match=r"current\.table: .*gone\.csv: no such file\. Give a file beside the scene, or the rows\."):
        load(written(tmp_path, '[current]\ntable = "gone.csv"\n'))
    with pytest.raises(ParameterError, match=r"netCDF is read for current\.table alone"):
        load(written(tmp_path, '[top]\ntable = "gone.nc"\n', gone__nc=""))


class TestNetcdf:
    xarray = pytest.importorskip("xarray")

    def data(self, **changes):
        times = np.array(["2026-01-01T00:00", "2026-01-01T06:00"], dtype="datetime64[ns]")
        u, v = np.array([[0.3, 0.1], [0.0, -0.4]]), np.array([[0.4, 0.0], [0.2, 0.0]])
        return self.xarray.Dataset(
            {
                "ucur": (("time", "depth"), u, {"standard_name": "eastward_sea_water_velocity"}),
                "vcur": (("time", "depth"), v, {"standard_name": "northward_sea_water_velocity"}),
            },
            coords={"time": times, "depth": ("depth", [0.0, 100.0], {"positive": "down"})},
        ).assign(changes)

    def test_velocities_over_time_and_depth_are_rows(self, tmp_path):
        self.data().to_netcdf(tmp_path / "ocean.nc", engine="scipy")
        rows = np.array(load(written(tmp_path, '[current]\ntable = "ocean.nc"\n')).current.table)
        assert rows[:, 0].tolist() == [0.0, 0.0, 21600.0, 21600.0]
        assert rows[:, 1].tolist() == [0.0, -100.0, 0.0, -100.0]
        assert rows[:, 2] * np.cos(rows[:, 3]) == pytest.approx([0.3, 0.1, 0.0, -0.4], abs=1e-12)
        assert rows[:, 2] * np.sin(rows[:, 3]) == pytest.approx([0.4, 0.0, 0.2, 0.0], abs=1e-12)

    def test_a_grid_of_places_is_asked_for_one(self, tmp_path):
        self.data().expand_dims(lat=[1.0, 2.0]).to_netcdf(tmp_path / "ocean.nc", engine="scipy")
        with pytest.raises(ParameterError, match=r"ucur over lat, time, depth: must be over time and height\. Cut out one place\."):
            load(written(tmp_path, '[current]\ntable = "ocean.nc"\n'))

    def test_what_lacks_a_velocity_is_refused(self, tmp_path):
        self.data().drop_vars("vcur").to_netcdf(tmp_path / "ocean.nc", engine="scipy")
        with pytest.raises(ParameterError, match="no variable northward_sea_water_velocity or v or vo"):
            load(written(tmp_path, '[current]\ntable = "ocean.nc"\n'))

    def test_a_file_of_another_kind_is_refused(self, tmp_path):
        with pytest.raises(ParameterError, match=r"ocean\.nc: not read as netCDF"):
            load(written(tmp_path, '[current]\ntable = "ocean.nc"\n', ocean__nc="no such thing"))

    def test_one_moment_and_falling_times_are_read(self, tmp_path):
        data = self.data()
        data.isel(time=[1]).to_netcdf(tmp_path / "ocean.nc", engine="scipy")
        assert len(load(written(tmp_path, '[current]\ntable = "ocean.nc"\n')).current.table) == 2
        data.isel(time=[1, 0]).to_netcdf(tmp_path / "falling.nc", engine="scipy")
        data.to_netcdf(tmp_path / "rising.nc", engine="scipy")
        falling, rising = (load(written(tmp_path, f'[current]\ntable = "{name}.nc"\n')).current.table for name in ("falling", "rising"))
        assert sorted(falling) == sorted(rising)

    def test_other_units_and_an_axis_of_unknown_sense_are_refused(self, tmp_path):
        data = self.data()
        data["ucur"].attrs["units"] = "cm s-1"
        data.to_netcdf(tmp_path / "ocean.nc", engine="scipy")
        with pytest.raises(ParameterError, match=r"ucur in 'cm s-1': must be in m/s\. Convert it\."):
            load(written(tmp_path, '[current]\ntable = "ocean.nc"\n'))
        data = self.data().rename(depth="lev")
        data["lev"].attrs.pop("positive")
        data.to_netcdf(tmp_path / "ocean.nc", engine="scipy")
        with pytest.raises(ParameterError, match=r"lev without `positive`: must be up or down\."):
            load(written(tmp_path, '[current]\ntable = "ocean.nc"\n'))
