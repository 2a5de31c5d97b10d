"""The digits of a run's tables follow the ranges of its results; tables of data are never rounded."""

import dataclasses
import re
from decimal import Decimal

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from strikewave.analyses.machine.report import blow_table
from strikewave.analyses.machine.result import answer_columns, blow_columns, summary_words
from strikewave.analyses.machine.screen import show
from strikewave.base.constants import STANDARD_GRAVITY as G
from strikewave.base.result import Band
from strikewave.reporting.numbers import ShownUnits, showing

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
