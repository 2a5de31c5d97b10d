"""The solution: saved and loaded alike, whole or not at all, with units; hostile files refused."""

import csv
import dataclasses
import io
import json
import math

import numpy as np
import pytest

from strikewave import load_solution
from strikewave.base.datasets import LabelledArrays, seal
from strikewave.base.documents import plain
from strikewave.base.errors import InputError
from strikewave.base.units import DIMENSIONS, convertible
from strikewave.reporting.numbers import ShownUnits, showing


def test_saved_and_loaded_alike(solution, tmp_path):
    solution.save(tmp_path / "solution.nc")
    again = load_solution(tmp_path)
    assert again == solution
    assert again.data.equals(solution.data)
    assert again.document() == solution.document()


def test_every_history_has_a_unit(solution):
    for name, variable in solution.data.variables.items():
        assert name == "blow" or variable.attrs["units"], name


def test_histories_agree_with_the_table(solution):
    data = solution.data
    peaks = data["pulse_acceleration"].max("pulse_time").values
    assert peaks == pytest.approx([b.rigid_peak for b in solution.blows], rel=1e-4)
    # the train is sampled every 10 us: a 200 us pulse loses at most (pi/20)^2/8 of its peak, and the spikes of the force more
    assert float(data["rigid_acceleration"].max()) == pytest.approx(max(peaks), rel=5e-3)
    impulse = np.trapezoid(np.nan_to_num(data["pulse_force"].values), data["pulse_time"].values, axis=1)
    assert impulse == pytest.approx([b.contact_impulse for b in solution.blows], rel=1e-4)


def test_recorder_sees_the_train_through_its_window(solution, published):
    record = solution.data["record_acceleration"]
    time = solution.data["record_time"].values
    assert time[0] == pytest.approx(-published.recorder.pre_trigger.si)
    assert record.sizes["record_time"] == published.recorder.memory.si
    assert float(record.max()) <= float(solution.data["blow_rigid_peak"].max())
    assert not record.values[time < 0].any()


def test_csv_has_units_and_all_blows(solution):
    lines = solution.tables()["blows.csv"].splitlines()
    assert "time [s]" in lines[0]
    assert "rigid_peak [m/s^2]" in lines[0]
    assert len(lines) == 1 + len(solution.blows)


def in_si(text):
    """Return the columns of a CSV text by their names; those with a unit in SI."""
    head, *rows = csv.reader(io.StringIO(text))
    columns = {}
    for name, cells in zip(head, zip(*rows, strict=True), strict=True):
        what, _, unit = name.removesuffix("]").partition(" [")
        si, size = convertible(unit, DIMENSIONS) if unit else ("", 1.0)
        columns[what] = si, [float(cell) * size if unit and cell else cell for cell in cells]
    return columns


def test_csv_in_units_of_a_choice_holds_the_same_numbers(solution):
    usual = in_si(solution.tables()["blows.csv"])
    with showing(ShownUnits.read("g,us,kN,mm,mJ")):
        text = solution.tables()["blows.csv"]
    assert "rigid_peak [g]" in text
    assert "width [us]" in text
    shown = in_si(text)
    assert usual.keys() == shown.keys()
    for name, (si, values) in usual.items():
        assert shown[name][0] == si
        # a division and a multiplication round once each
        assert shown[name][1] == (pytest.approx(values, rel=1e-15) if si else values)


def test_plain_json_has_no_nan():
    text = json.dumps(plain({"a": [np.float64(math.inf), np.int64(3), np.nan]}), allow_nan=False)
    assert text == '{"a": [null, 3, null]}'


@pytest.mark.parametrize("content", [b"", b"not a file", b"\x89HDF\r\n\x1a\n" + b"\x00" * 100])
def test_damaged_files_are_refused(tmp_path, content):
    path = tmp_path / "solution.nc"
    path.write_bytes(content)
    with pytest.raises(InputError, match="strikewave run"):
        load_solution(path)


def test_flipped_bits_are_refused_before_hdf5_reads_them(solution, tmp_path, rng):
    """HDF5 takes most of them for other numbers, and does not come to an end on some."""
    path = tmp_path / "solution.nc"
    few = solution.data.isel(time=slice(0, 50), record_time=slice(0, 50))
    dataclasses.replace(solution, sampled=LabelledArrays.of_xarray(few)).save(path)
    whole = path.read_bytes()
    for place in rng.integers(0, len(whole), 200):
        data = bytearray(whole)
        data[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(data)
        with pytest.raises(InputError, match=r"check sum is missing|bytes of it have changed"):
            load_solution(path)


@pytest.mark.verify
@pytest.mark.parametrize(("schema", "words"), [(3, "run the case.toml beside it again"), (99, "update strikewave")])
def test_a_file_of_another_schema_is_refused_with_what_to_do(solution, tmp_path, schema, words):
    import xarray

    solution.save(tmp_path / "whole.nc")
    with xarray.open_dataset(tmp_path / "whole.nc", engine="h5netcdf") as whole:
        whole.load().assign_attrs(strikewave_schema=schema).to_netcdf(tmp_path / "solution.nc", engine="h5netcdf")
    seal(tmp_path / "solution.nc")
    with pytest.raises(InputError, match=words):
        load_solution(tmp_path)


def test_foreign_netcdf_is_refused(tmp_path):
    import xarray

    path = tmp_path / "foreign.nc"
    xarray.Dataset({"a": ("x", np.arange(3))}).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(InputError, match="strikewave run"):
        load_solution(path)
    with pytest.raises(InputError):
        load_solution(tmp_path / "absent.nc")


def test_first_blow_without_a_width_is_still_drawn(solution):
    """A pulse that never falls to 10 % within its window has no width; the picture then shows the whole window."""
    from strikewave.analyses.machine.figures.pulses import summary

    endless = dataclasses.replace(solution.blows[0], width=math.nan)
    figure = summary(dataclasses.replace(solution, blows=(endless, *solution.blows[1:])))
    drawn = figure.axes[1].lines[0].get_xdata()
    assert drawn[-1] == pytest.approx(solution.data["pulse_time"].values[-1] * 1e6)
