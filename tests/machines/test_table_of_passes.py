"""The figures of a blow in the table of a fast run, from samples whose peak, crossings and areas are known."""

import math

import numpy as np
import pytest

from strikewave.machines import _pass_kernels as column
from strikewave.machines.fast_train import empty_passes


@pytest.fixture(autouse=True)
def interpreted(monkeypatch):
    """Run the parts of the kernels in Python, which compiles nothing for arguments of another type."""
    for name in ("measure_row", "_crossings", "repeats", "_next_row", "_open_contact"):
        monkeypatch.setattr(column, name, getattr(getattr(column, name), "py_func", getattr(column, name)))


def passes_of(time, acceleration, speed, contacts=()):
    passes = empty_passes(2)
    column._next_row(passes)
    count = passes.counts[column.SAMPLES] = len(time)
    passes.samples[:, :count] = time, acceleration, speed
    passes.counts[column.CONTACTS_SEEN] = len(contacts)
    for k, one in enumerate(contacts):
        passes.contacts[k] = one
    passes.table[0, column.IMPULSE] = sum(one[2] for one in contacts)
    column.measure_row(passes)
    return passes.table[0]


UNEVEN = np.array([0.0, 0.3, 0.7, 1.3, 1.6, 2.1, 2.5, 3.1, 3.6, 4.0])
"""Times from the begin of a parabola 100 - 25 (t - 2)^2, whose top lies between two of them."""


@pytest.mark.parametrize("shift", [0.0, 7.0])
def test_a_parabola_has_its_top_between_uneven_samples_and_lines_cross_its_shares(shift):
    a = 100.0 - 25.0 * (UNEVEN - 2.0) ** 2
    v = 100.0 * UNEVEN - 25.0 / 3.0 * ((UNEVEN - 2.0) ** 3 + 8.0)
    row = passes_of(UNEVEN + shift, a, v)
    assert row[column.PEAK] == pytest.approx(100.0, rel=1e-12)
    begin, end = np.interp(10.0, a[:4], UNEVEN[:4]), np.interp(-10.0, -a[5:], UNEVEN[5:])
    assert row[column.WIDTH] == pytest.approx(end - begin, rel=1e-12)
    begin, end = np.interp(2.0, a[:4], UNEVEN[:4]), np.interp(-2.0, -a[5:], UNEVEN[5:])
    change = np.interp(end, UNEVEN, v) - np.interp(begin, UNEVEN, v)
    assert row[column.VELOCITY_CHANGE] == pytest.approx(change, rel=1e-12)


def test_a_pulse_that_rises_to_its_last_sample_has_no_width_and_the_speed_of_all_of_it():
    for a, peak in (([1.0, 2.0, 4.0], 4.0), ([4.0, 3.0, 1.0], 4.0), ([1.0, 3.0, 2.0], 3.0 + 1.0 / 24.0)):
        row = passes_of([0.0, 1.0, 2.0], a, [5.0, 6.0, 9.0])
        assert row[column.PEAK] == pytest.approx(peak)
        assert math.isnan(row[column.WIDTH])
        assert row[column.VELOCITY_CHANGE] == 4.0


@pytest.mark.parametrize(("gap", "later"), [(0.99, 0.0), (1.01, 5.0)])
def test_contacts_after_a_gap_of_a_width_are_later_ones(gap, later):
    time, a = np.linspace(0.0, 4.0, 9), 10.0 * np.sin(np.pi * np.linspace(0.0, 1.0, 9))
    width = passes_of(time, a, time)[column.WIDTH]
    assert width == pytest.approx(4.0 * 0.936, rel=0.02)  # chords of 8 samples
    again = 4.0 + gap * width
    contacts = [
        (0.0, 1.0, 3.0, 0.5),
        (1.2, 4.0, 4.0, 0.8),
        (again, again + 1.0, 1.0, 0.9),
        (again + 1.0, 9.0, 4.0, 1.1),
    ]
    row = passes_of(time, a, time, contacts)
    assert row[column.LATER] == later
    assert row[column.BLOW_IMPULSE] == 12.0 - later
    assert row[column.BLOW_CHANGE] == (0.8 if later else 1.1)


def test_rows_and_contacts_are_used_until_none_is_left():
    passes = empty_passes(2)
    assert passes.counts.tolist()[column.CURRENT] == -1
    assert [column._next_row(passes) for _ in range(3)] == [True, True, False]
    assert (passes.counts[column.CURRENT], passes.counts[column.ROWS_USED]) == (1, 2)
    assert passes.table[:, column.STOP_FORCE].tolist() == [0.0, 0.0]
    passes.table[1, column.CONTACTS] = 0.0
    room = passes.contacts.shape[0]
    for k in range(room + 2):
        column._open_contact(passes, 10.0 + k)
    assert passes.table[1, column.CONTACTS] == room + 2
    assert (passes.counts[column.CONTACTS_SEEN], passes.counts[column.IN_TOUCH]) == (room, 1)
    assert passes.contacts[1].tolist() == [11.0, 11.0, 0.0, 0.0]
    assert passes.contacts[-1, 0] == 10.0 + room - 1


@pytest.mark.parametrize(
    ("period", "rows", "strikers", "found"),
    [
        (1, 9, 6, True),
        (1, 8, 6, False),  # eight blows and the one before
        (3, 15, 6, True),
        (3, 14, 6, False),  # four periods and the one before
        (4, 20, 6, True),
        (6, 30, 6, True),  # a whole turn
        (6, 29, 6, False),
        (6, 40, 7, False),
    ],
)
def test_blows_repeat_with_a_period_up_to_four_or_a_turn(period, rows, strikers, found):
    table = np.full((rows, column.BLOW_COLUMNS), np.nan)
    phase = np.arange(rows) % period
    table[:, column.APPROACH], table[:, column.ANGLE] = 1.0 + 0.1 * phase, 0.5 + 0.2 * phase
    assert column.repeats(table, rows, 1e-3, strikers) == found


@pytest.mark.parametrize("which", [column.APPROACH, column.ANGLE])
@pytest.mark.parametrize(("by", "found"), [(0.99e-3, True), (1.01e-3, False), (-1.01e-3, False)])
def test_a_repetition_holds_within_a_share_of_the_last_blow(which, by, found):
    table = np.full((9, column.BLOW_COLUMNS), np.nan)
    table[:, column.APPROACH], table[:, column.ANGLE] = 3.0, -2.0
    table[4:, which] *= 1.0 + by
    assert column.repeats(table, 9, 1e-3, 2) == found
