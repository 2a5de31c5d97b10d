"""Numbers whose unit the data or the user decide: one usual unit on each face."""

import math
from types import SimpleNamespace

import pytest

from strikewave.analyses.machine.blow_histories import BlowReading
from strikewave.analyses.record.rows import units_given
from strikewave.base.declare import declarations, units
from strikewave.base.result import Comparison
from strikewave.base.shock_quantities import (
    FORCE,
    LENGTH,
    MICROSECONDS,
    OF_CHANNEL,
    PUBLISHED_QUANTITIES,
    STRESS,
    usual_unit,
)
from strikewave.machines.blows import Blow
from strikewave.reporting.chapters import published
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import amount
from strikewave.reporting.parts import NONE
from strikewave.reporting.table_files import _comparisons
from strikewave.reporting.terminal import print_published
from strikewave.sensors.trial import SensorPulse

COMPARED = [
    ("first.peak_force", 71e3, "(kN)", "71"),
    ("first.indentation", 2e-3, "(µm)", "2000"),
    ("first.approach_speed", 5.0, "(m/s)", "5"),
    ("window", 0.2, "(ms)", "200"),
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


def declared_twice():
    """Yield the published names of a number that a row of a result has, and what its field measures."""
    rows = {"sensor_": SensorPulse, "": Blow, "total_peak": BlowReading, "wave_peak": BlowReading}
    for name in PUBLISHED_QUANTITIES:
        field = name.partition(".")[2]
        kind = next(one for start, one in sorted(rows.items(), reverse=True) if field.startswith(start))
        declared = declarations(kind).get(field.removeprefix("sensor_"))
        if declared is not None:
            yield name, declared.quantity


@pytest.mark.parametrize(("name", "quantity"), list(declared_twice()))
def test_a_published_number_measures_what_the_field_of_the_result_does(name, quantity):
    assert PUBLISHED_QUANTITIES[name].units == quantity.units


def test_every_published_number_but_those_of_trains_and_elements_is_one_of_a_declared_field():
    others = set(PUBLISHED_QUANTITIES) - {name for name, _ in declared_twice()}
    assert others == {"first.force_width", "first.force_over_mass", "count", "window"}


def test_documents_say_of_published_numbers_that_their_quantity_has_the_unit():
    assert {units(Comparison)[key] for key in ("published", "computed")} == {"that of its quantity"}


def test_a_row_of_the_workbook_has_the_unit_of_its_quantity():
    rows = _comparisons(SimpleNamespace(comparisons=[Comparison("first.peak_force", 7e4, "", 7e4, 0.0, "predicted")]))
    assert next(rows)[:3] == ("first.peak_force", "N", 7e4)


@pytest.mark.parametrize(("value", "text"), [(0.0, "0 µs"), (-2e-6, "-2 µs"), (math.nan, NONE), (None, NONE)])
def test_a_time_at_or_below_zero_is_a_number_in_a_sentence_as_in_a_table(value, text):
    assert amount(MICROSECONDS, value) == text
    cells = Column.of("delay", [value], MICROSECONDS).texts()
    assert cells == [text.removesuffix(" µs")]
