"""Units of other codes follow from three; curves, columns and numbers are as those codes take them."""

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.exchange.deck import LARGEST_ID, check_ids, lasting, plain, real, rows
from strikewave.exchange.ls_dyna.deck import keyword
from strikewave.exchange.units import SYSTEMS, unit_system
from strikewave.fem.model import TimeCurve


def test_mm_tonne_s_gives_newtons_megapascals_and_millijoules():
    system = SYSTEMS["mm-t-s"]
    assert (system.force, system.stress, system.energy) == (1.0, 1e-6, 1e3)


def test_mm_gram_microsecond_gives_meganewtons_terapascals_and_kilojoules():
    system = SYSTEMS["mm-g-us"]
    assert (system.force, system.stress, system.energy) == (1e-6, 1e-12, 1e-3)


@pytest.mark.parametrize("name", SYSTEMS)
def test_newtons_second_law_and_the_wave_speed_hold_in_every_system(name):
    system = SYSTEMS[name]
    # products of powers of ten, rounded to 14 digits each
    assert system.force == pytest.approx(system.density * system.distance**3 * system.acceleration, rel=1e-13)
    assert system.velocity**2 == pytest.approx(system.stress / system.density, rel=1e-13)
    assert system.heat_capacity == pytest.approx(system.density * system.specific_heat, rel=1e-13)
    assert system.energy == pytest.approx(system.force * system.distance, rel=1e-13)
    assert system.rate * system.duration == pytest.approx(1.0, rel=1e-13)


def test_unknown_system_names_the_nearest():
    with pytest.raises(InputError, match='"mm-t-s"'):
        unit_system("mm-ton-s")


def test_ids_beyond_eight_columns_are_refused():
    check_ids(LARGEST_ID)
    with pytest.raises(InputError, match="99999999"):
        check_ids(LARGEST_ID + 1)


@pytest.mark.parametrize("width", [10, 20])
def test_numbers_keep_the_digits_that_columns_hold(rng, width):
    values = rng.choice([-1.0, 1.0], 2000) * 10.0 ** rng.uniform(-12, 12, 2000)
    texts = [real(value, width) for value in values]
    assert max(map(len, texts)) <= width
    # the worst is -d.ddde-dd in ten columns, four digits; in twenty at least 13
    worst = max(abs(float(text) / value - 1.0) for text, value in zip(texts, values, strict=True))
    assert worst < (1e-3 if width == 10 else 1e-12)


def test_a_number_that_ten_columns_would_cut_makes_a_long_keyword():
    lines = keyword("MAT_ELASTIC", [1, 7.823456789e-9, 211000.0, 0.288])
    assert lines[0] == "*MAT_ELASTIC+"
    assert float(lines[1][20:40]) == 7.823456789e-9
    assert keyword("MAT_ELASTIC", [1, 7.82e-9, 211000.0, 0.288])[0] == "*MAT_ELASTIC"


def test_curves_are_constant_to_the_end_and_from_0():
    curve = TimeCurve((1e-6, 2e-6), (3.0, 4.0))
    longer = lasting(curve, 1e-3)
    instants = np.linspace(0.0, 1e-3, 1001)
    given = np.interp(instants, curve.time, curve.value)
    assert np.array_equal(np.interp(instants, longer.time, longer.value, left=0.0, right=0.0), given)


def test_titles_are_ascii_and_never_a_keyword():
    assert plain("*NODE\n/BEGIN é", 80) == "NODE /BEGIN ?"


def test_tables_larger_than_a_piece_are_whole():
    text = "".join(rows("%6d\n", [np.arange(10_000)]))
    assert [int(line) for line in text.splitlines()] == list(range(10_000))
