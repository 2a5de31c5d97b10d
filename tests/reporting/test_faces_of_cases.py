"""Over all faces of a built-in case one name has one value, one unit and one meaning."""

import csv
import functools
import math
import re

import pytest

from strikewave import load_case, run_case, run_wave
from strikewave.base import declare
from strikewave.base.units import in_unit
from strikewave.cases.files import bundled_cases
from strikewave.reporting.faces import _keys, at, data_columns, face_rows, face_table, leaves
from strikewave.reporting.numbers import headed
from strikewave.reporting.shown_result import shown_table
from strikewave.reporting.table_files import _sheets

QUICK = ("jesd22-b111-b", "en-166-ball", "rodgers-2009-amplifier", "togami-1996-bar")
OTHERS = [name for name in bundled_cases() if name not in QUICK and load_case(name).mesh is None]
NUMBER = re.compile(r"^([−-]?\d[\d.]*(?:e[+-]?\d+)?)(?: (\S+))?$")


@pytest.fixture(scope="module", params=[*QUICK, *(pytest.param(name, marks=pytest.mark.verify) for name in OTHERS)])
def result(request):
    case = load_case(request.param)
    return run_wave(case) if case.machine is None else run_case(case)


def shown_as(value, text, si, usual):
    """Tell whether a text without its unit is a value in SI, to the last digit that it has."""
    number, decimals = float(text.replace("−", "-")), len(text.partition("e")[0].partition(".")[2])
    places = decimals - int(text.partition("e")[2] or 0)
    size = 10.0 ** (-places if "." in text or "e" in text else -min(0, places))
    digits = len(re.sub(r"\D", "", text.partition("e")[0]).rstrip("0"))
    if "." not in text and number:  # an integer may be rounded to its significant digits
        size = 10.0 ** max(0, math.floor(math.log10(abs(number))) + 1 - max(digits, 4))
    return abs(number - (in_unit(value, si, usual) if si not in ("", "1") else value)) <= 0.5000001 * size


def test_columns_of_files_and_python_are_the_keys_of_the_document(result):
    document, one = result.document(), declare.declarations(type(result))[result.main_rows]
    rows = document[one.key or result.main_rows]
    rows = list(rows.values()) if isinstance(rows, dict) else rows
    columns = {column.name: column for column in data_columns(result, result.main_rows)}
    seen = 0
    for path, leaf in leaves(one.of):
        if leaf.kind != "number" or not leaf.in_document:
            continue
        keys = _keys(one.of, path)
        column = columns[".".join(keys)]
        assert document["units"][keys[-1]] == leaf.quantity.si == column.si, keys
        for row, value in zip(rows, column.values, strict=True):
            held = functools.reduce(lambda inner, key: inner and inner[key], keys, row)
            assert held == (None if value is None or not math.isfinite(value) else value), keys
            seen += held is not None
    assert seen >= 4


def test_cells_of_page_and_notebook_are_the_values_that_python_has(result):
    one = declare.declarations(type(result))[result.main_rows]
    heads, rows = shown_table(result)
    table = face_table(result, result.main_rows)
    page = dict(zip(table.columns, zip(*table.cells(), strict=True), strict=True))
    seen = 0
    for path, leaf in leaves(one.of):
        head = headed(
            leaf.label or leaf.quantity.label or path[-1].replace("_", " "), leaf.quantity.si, leaf.quantity.usual
        )
        if leaf.kind != "number" or head not in heads:
            continue
        for row, face in zip(rows, face_rows(result, result.main_rows), strict=True):
            text, value = row[heads.index(head)], at(face.value, path)
            if value is not None and math.isfinite(value):
                assert shown_as(value, text, leaf.quantity.si, leaf.quantity.usual), (head, text, value)
                seen += 1
        assert list(page[head]) == [row[heads.index(head)] for row in rows], head
    assert seen >= 2


def test_key_numbers_of_workbook_and_python_are_declared_values(result):
    sheets = {title: [list(row) for row in rows] for title, _, rows in _sheets(result)}
    numbers = result.highlights()
    assert numbers
    for label, text in numbers:
        assert [label, text] in sheets["summary"]
    table = next(iter(result.tables().values()))
    assert len(next(csv.reader(table.splitlines()))) >= 3
