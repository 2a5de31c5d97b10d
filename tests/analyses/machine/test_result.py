"""The solution: saved and loaded alike, with units and digits; hostile files refused; units that the user chose."""

import csv
import dataclasses
import io
import json
import math
import re
from decimal import Decimal
from html import unescape

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from strikewave import load_case, load_solution, run_case
from strikewave.analyses.machine.report import blow_table, report
from strikewave.analyses.machine.result import answer_columns, blow_columns, summary_words
from strikewave.analyses.machine.screen import show
from strikewave.base.constants import STANDARD_GRAVITY as G
from strikewave.base.datasets import LabelledArrays, seal
from strikewave.base.documents import plain
from strikewave.base.errors import InputError
from strikewave.base.result import Band
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


BANDS = {
    "first.rigid_peak": Band(900.0 * G, 6500.0 * G, 0.95),
    "typical.rigid_peak": Band(3800.0 * G, 4600.0 * G, 0.95),
    "first.width": Band(130e-6, 290e-6, 0.95),
    "first.velocity_change": Band(0.5, 7.1, 0.95),
}


@pytest.fixture
def banded(solution):
    return dataclasses.replace(solution, band=BANDS)


def printed(capsys, solution):
    """Return the cells of rigid peak, width and velocity change of each blow on the screen, the last three there."""
    show(solution)
    found = re.findall(r"^ *\d+ +full .*$", capsys.readouterr().out, re.MULTILINE)
    assert len(found) == len(solution.blows)
    return [line.split()[-3:] for line in found]


def test_a_table_has_one_digit_more_than_the_narrowest_range_leaves(banded, capsys, monkeypatch):
    """Half widths of 400 g, 80 us and 3 m/s leave hundreds, tens and ones, so the table has tens, ones and tenths."""
    monkeypatch.setenv("COLUMNS", "80")
    wanted = [
        [f"{round(b.rigid_peak / G, -1):.0f}", f"{b.width * 1e6:.0f}", f"{b.velocity_change:.1f}"] for b in banded.blows
    ]
    assert printed(capsys, banded) == wanted
    table = blow_table(banded).parts[0]
    places = [next(k for k, head in enumerate(table.columns) if name in head) for name in ("rigid", "width", "change")]
    assert [[row[k] for k in places] for row in table.rows] == wanted


def test_in_another_unit_a_table_has_as_many_digits(banded, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    with showing(ShownUnits.read("m/s2")):
        for blow, (peak, *_) in zip(banded.blows, printed(capsys, banded), strict=True):
            assert peak == f"{round(blow.rigid_peak, -2):.0f}"


def test_without_a_range_and_in_data_nothing_is_rounded(solution, banded, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    for blow, (peak, width, change) in zip(solution.blows, printed(capsys, solution), strict=True):
        assert peak == f"{blow.rigid_peak / G:.1f}"
        assert (width, change) == (f"{blow.width * 1e6:.1f}", f"{blow.velocity_change:.3f}")
    assert banded.tables() == solution.tables()
    assert banded.document()["blows"] == solution.document()["blows"]
    assert banded.to_dataframe().equals(solution.to_dataframe())


def without_contradiction(sentence, columns):
    """Check that each number of a sentence stands in a column of its unit, with as many decimals or more."""
    said = re.findall(r"([\d.]+(?:e[+-]?\d+)?)\s(g|µs|m/s|kN)(?![\w/])", sentence)
    for number, unit in said:
        cells = [cell for column in columns if f"({unit})" in column.head for cell in column.texts()]
        off = {cell: abs(Decimal(cell) - Decimal(number)) for cell in cells if cell[0].isdigit()}
        ends = {cell: Decimal(1).scaleb(int(Decimal(cell).as_tuple().exponent)) for cell in [*off, number]}
        assert any(off[cell] <= (ends[cell] + ends[number]) / 2 and ends[cell] <= ends[number] for cell in off), number
    return [unit for _, unit in said]


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(peak=st.floats(0.1, 1e5), width=st.floats(1e-6, 0.1), change=st.floats(1e-3, 100.0), force=st.floats(1.0, 1e7))
def test_a_sentence_without_ranges_contradicts_no_table(solution, peak, width, change, force):
    """A headline of 99.98 g above 100.0 g: of blows of any size each number of the sentence is in the table."""
    first = dataclasses.replace(
        solution.blows[0], rigid_peak=peak * G, width=width, velocity_change=change, peak_force=force
    )
    one = dataclasses.replace(solution, blows=(first,), readings=(None,))
    for sentence in (summary_words(one), "; ".join(words for name, words in one.highlights() if "range" not in name)):
        assert without_contradiction(sentence, blow_columns("blows", one.blows)) == ["g", "µs", "m/s", "kN"]


def test_a_range_of_a_yielding_contact_has_the_digits_of_its_table(solution):
    """A peak of 99.98 g beside answers of a contact in whole g."""
    row = dataclasses.replace(solution.contact.rows[0], rigid_peak=99.98 * G)
    answers = dataclasses.replace(solution.contact, rows=(row,))
    assert without_contradiction("99.98 g", answer_columns(answers)) == ["g"]


CHOICE = ShownUnits.read("m/s2,ms,N")
USUAL = re.compile(r".{0,40}(?:\d (?:g|µs|us|kN)\b|\((?:g|µs|us|kN)\))")
"""A number, or a head, in the usual unit of an acceleration, a time or a force."""
AS_TYPED = {"Warnings", "Set-up", "Inputs", "How to run this again"}
"""Sections that repeat values as they were typed, and notices, which are worded before anything is shown."""


@pytest.mark.verify
@pytest.mark.parametrize("name", ["li-ma-2019-fig13", "rodgers-2009-amplifier"])
def test_no_usual_unit_stands_beside_the_chosen_ones(name, capsys):
    solution = run_case(load_case(name, ["feed.blows=1"] if name.startswith("li-ma") else []))
    with showing(CHOICE):
        show(solution)
        page = report(solution)
    screen = "".join(line for line in capsys.readouterr() for line in line.splitlines(True) if "fitted:" not in line)
    assert USUAL.findall(screen) == []
    assert "(m/s²)" in screen
    sections = re.split(r"<h[12][^>]*>", re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.S))
    heads = [section.partition("<")[0] for section in sections]
    assert set(heads) > AS_TYPED - {"Warnings"}
    for head, section in zip(heads, sections, strict=True):
        if head not in AS_TYPED:
            text = unescape(re.sub(r"<[^>]+>", "|", section)).replace("\n", " ")
            assert USUAL.findall(text) == [], head


def test_what_stands_beside_the_blows_is_in_the_chosen_unit_of_a_speed():
    solution = run_case(load_case("jesd22-b111-b"))
    with showing(ShownUnits.read("km/h")):
        words = blow_table(solution).text
    assert re.search(r"at the nominal [\d.]+ km/h and", words)
    assert "m/s " not in words
