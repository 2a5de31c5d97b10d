"""The workbook of a result: numbers as numbers, text as text, the same bytes each time."""

import dataclasses

import openpyxl
import pytest

from strikewave import load_case, run_case
from strikewave.base.datasets import LabelledArrays
from strikewave.base.errors import InputError
from strikewave.base.result import Band, InputShare, Notice
from strikewave.base.units import parse_quantity
from strikewave.reporting import table_files
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.reporting.table_files import WORKBOOK, check_workbook, write_workbook

FORMULAS = ["=1+1", "+1", "-cmd", "@SUM(A1)", "#N/A", "{=1}"]


@pytest.fixture(scope="module")
def run():
    solution = run_case(load_case("li-ma-2019", ["feed.blows=1", "compare=true"]))
    few = {dim: slice(None, None, 40) for dim, count in solution.data.sizes.items() if count > 1000}
    bands = {"first.rigid_peak": Band(3e4, 5e4, 0.95, (InputShare("machine.engagement", 0.6),))}
    notices = [Notice("text", words, 1.0) for words in FORMULAS] + [Notice("odd", "a\x00b\x1fc", float("nan"))]
    short = solution.data.isel(few)  # reading back takes seconds for all samples
    return dataclasses.replace(
        solution, sampled=LabelledArrays.of_xarray(short), band=bands, notices=(*solution.notices, *notices)
    )


def sheets_of(result, folder):
    folder.mkdir(exist_ok=True)
    assert write_workbook(result, folder) == WORKBOOK
    book = openpyxl.load_workbook(folder / WORKBOOK)
    return {sheet.title: list(sheet.iter_rows()) for sheet in book.worksheets}


@pytest.mark.parametrize("units", ["", "g,us,kN"])
def test_workbook_holds_the_numbers_of_the_run_under_their_units(run, tmp_path, units):
    with showing(ShownUnits.read(units) if units else None):
        sheets = sheets_of(run, tmp_path)
    assert list(sheets)[:6] == ["summary", "blows", "band", "comparison", "warnings", "inputs"]
    unit = "g" if units else "m/s^2"
    size = parse_quantity(f"1 {unit}", "m/s^2", "")
    heads, first = ([cell.value for cell in row] for row in sheets["blows"][:2])
    # the conversion and its inverse: two roundings
    assert first[heads.index(f"rigid_peak [{unit}]")] * size == pytest.approx(run.blows[0].rigid_peak, rel=1e-15)
    name, low, high, shown, level, inputs = (cell.value for cell in sheets["band"][1])
    assert (name, shown, level, inputs) == ("first.rigid_peak", unit, 0.95, "machine.engagement (60 %)")
    assert (low * size, high * size) == pytest.approx((3e4, 5e4), rel=1e-15)
    heads = [cell.value for cell in sheets["histories"][0]]
    force = heads.index(f"rigid_acceleration [{unit}]")
    column = [row[force].value for row in sheets["histories"][1:]]
    assert max(column) * size == pytest.approx(float(run.data["rigid_acceleration"].max()), rel=1e-15)
    assert len(column) == run.data.sizes["time"]


def test_inputs_stand_as_typed_and_in_si_with_where_they_come_from(run, tmp_path):
    rows = {row[0].value: [cell.value for cell in row[1:]] for row in sheets_of(run, tmp_path)["inputs"]}
    values = run.case.values()
    assert set(values) - set(rows) <= {path for path in values if path.startswith("published")}
    for path in ("machine.speed", "object.frame_stiffness", "feed.blows"):
        value = values[path]
        typed, si, unit, provenance, _, note = rows[path]
        assert (typed, si, provenance, note or "") == (value.typed, value.si, value.provenance, value.note)
        assert unit == {"machine.speed": "rad/s", "object.frame_stiffness": "N/m", "feed.blows": None}[path]


def test_text_that_looks_like_a_formula_stays_text(run, tmp_path):
    cells = [row[2] for row in sheets_of(run, tmp_path)["warnings"]]
    found = {cell.value: cell.data_type for cell in cells}
    assert {word: found[word] for word in FORMULAS} == dict.fromkeys(FORMULAS, "s")
    assert found["a b c"] == "s"


def test_equal_results_give_equal_bytes(run, tmp_path):
    (tmp_path / "a").mkdir(), (tmp_path / "b").mkdir()
    assert len({(tmp_path / name / write_workbook(run, tmp_path / name)).read_bytes() for name in "ab"}) == 1


def test_histories_longer_than_a_sheet_are_thinned_and_it_is_said(run, tmp_path, monkeypatch, capsys):
    count = run.data.sizes["time"]
    monkeypatch.setattr(table_files, "MOST_ROWS", -(-count // 4))
    rows = sheets_of(run, tmp_path)["histories"]
    assert len(rows) - 1 == -(-count // 4)
    assert rows[0][0].value.startswith("time (every 4th instant")
    assert "sheet histories: every 4th instant" in capsys.readouterr().err
    step = [row[0].value for row in rows[1:4]]
    assert step == pytest.approx(run.data["time"].values[[0, 4, 8]].tolist(), rel=1e-15)


def test_workbook_without_its_writer_is_refused_before_the_work(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"--xlsx needs openpyxl: .*strikewave\[formats\]"):
        check_workbook()
