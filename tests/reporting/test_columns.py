"""Columns that screen and page share."""

import pytest

from strikewave.base.declare import KEY
from strikewave.base.units import in_unit
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.reporting.parts import NONE, Tag
from strikewave.reporting.terminal import print_rows

COLUMNS = (
    Column("blow", ["first", "second"], priority=KEY, words=True),
    Column("peak", [40709.86, float("nan")], "m/s^2", shown="g"),
    Column("kept", [Tag("yes", "good"), None], words=True),
)


@pytest.mark.parametrize("unit", ["g", "m/s^2"])
def test_screen_and_page_show_the_same_cells_in_the_unit_of_the_head(unit, capsys):
    with showing(ShownUnits.read(unit)):
        print_rows("Blows", COLUMNS)
        table = page_table("Blows", COLUMNS)
    printed = [line.split() for line in capsys.readouterr().out.splitlines()]
    cells = [[cell.text if isinstance(cell, Tag) else cell for cell in row] for row in table.cells()]
    assert cells == [["first", f"{in_unit(40709.86, 'm/s^2', unit):.0f}", "yes"], ["second", NONE, NONE]]
    assert printed[-2:] == cells
    assert table.columns[1] == f"peak ({unit.replace('^2', '²')})"
    assert [f"({unit.replace('^2', '²')})"] in printed
