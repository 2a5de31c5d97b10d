"""Numbers whose unit the data or the user decide: one usual unit on each face."""

import pytest

from strikewave.analyses.record.rows import units_given
from strikewave.base.result import Comparison
from strikewave.base.shock_quantities import FORCE, LENGTH, OF_CHANNEL, STRESS, usual_unit
from strikewave.reporting.chapters import published
from strikewave.reporting.terminal import print_published

COMPARED = [
    ("first.peak_force", 71e3, "(kN)", "71"),
    ("first.approach_speed", 5.0, "(m/s)", "5"),
]


@pytest.mark.parametrize(("quantity", "value", "head", "text"), COMPARED)
def test_a_published_number_has_the_unit_of_the_key_numbers_on_page_and_screen(quantity, value, head, text, capsys):
    row = Comparison(quantity, value, "measured", value, 0.0, "predicted")
    [table] = published([row])[0].parts
    assert head in table.cells()[0][0]
    assert table.cells()[0][1:3] == [text, text]
    print_published([row])
    screen = capsys.readouterr().out
    assert head in screen
    assert text in screen


@pytest.mark.parametrize("quantity", [FORCE, STRESS, LENGTH])
def test_a_channel_has_the_unit_of_a_computed_number(quantity):
    assert usual_unit(quantity.si) == quantity.usual
    assert units_given(quantity.si)[OF_CHANNEL.given_by] == quantity.units
