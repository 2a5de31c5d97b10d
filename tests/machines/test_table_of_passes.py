"""The figures of a blow in the table of a fast run, from samples whose peak, crossings and areas are known."""

import math

import numpy as np
import pytest

from strikewave.contact._chain_kernels import OPEN, PUSHING, SLIDING_BACK
from strikewave.contact._law_kernels import DAMPING, EXPONENT, STIFFNESS
from strikewave.machines import _pass_kernels as column
from strikewave.machines._kernels import FEEDING, HELD, RELEASED, RETRACTING, carriage
from strikewave.machines._pass_kernels import (
    _crossings,
    _next_row,
    _note_support,
    _open_contact,
    _sample_blow,
    _turning_place,
    measure_row,
    missed_row,
    note_blow,
    note_flight,
    open_row,
    repeats,
)
from strikewave.machines.fast_run import empty_passes
from strikewave.machines.machine import machine_system

from .uneven import OBJECT, TURNING, parts, uneven

pytestmark = pytest.mark.usefixtures("interpreted")


def passes_of(time, acceleration, speed, contacts=()):
    passes = empty_passes(2)
    _next_row(passes)
    passes.counts[column.BLOW_STEPS] = 1
    passes.samples[0], passes.samples[1], passes.samples[2] = 1e3, 0.0, 7.0  # of a blow before
    passes.samples[1, 1] = 50.0
    count = passes.counts[column.SAMPLES] = len(time)
    passes.samples[:, :count] = time, acceleration, speed
    passes.counts[column.CONTACTS_SEEN] = len(contacts)
    for k, one in enumerate(contacts):
        passes.contacts[k] = one
    passes.table[0, column.IMPULSE] = sum(one[2] for one in contacts)
    measure_row(passes)
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
    alone = passes_of([0.0], [3.0], [5.0])
    assert (alone[column.PEAK], alone[column.VELOCITY_CHANGE]) == (3.0, 0.0)
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
    row = passes_of(time, a, time, [contacts[0], contacts[2]])
    assert row[column.LATER] == 1.0
    assert row[column.BLOW_CHANGE] == 0.5


def test_rows_and_contacts_are_used_until_none_is_left():
    passes = empty_passes(2)
    assert passes.counts.tolist()[column.CURRENT] == -1
    assert [_next_row(passes) for _ in range(3)] == [True, True, False]
    assert (passes.counts[column.CURRENT], passes.counts[column.ROWS_USED]) == (1, 2)
    assert passes.table[:, column.STOP_FORCE].tolist() == [0.0, 0.0]
    passes.table[1, column.CONTACTS] = 0.0
    room = passes.contacts.shape[0]
    for k in range(room + 2):
        _open_contact(passes, 10.0 + k)
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
    assert repeats(table, rows, 1e-3, strikers) == found


@pytest.mark.parametrize("which", [column.APPROACH, column.ANGLE])
@pytest.mark.parametrize(("by", "found"), [(0.99e-3, True), (1.01e-3, False), (-1.01e-3, False)])
def test_a_repetition_holds_within_a_share_of_the_last_blow(which, by, found):
    table = np.full((9, column.BLOW_COLUMNS), np.nan)
    table[:, column.APPROACH], table[:, column.ANGLE] = 3.0, -2.0
    table[4:, which] *= 1.0 + by
    assert repeats(table, 9, 1e-3, 2) == found


# rows of passes


def begun(number=2, rows=3):
    """Return what `open_row` takes, at a touch 0.1 before the strike position of a pass."""
    tables, going, struck, circling, at = parts(9.1e5)
    struck.y[at.angle] = number * 2.0 * math.pi / 3.0 - 0.1
    struck.y[at.positions], struck.y[at.speeds] = [1e-3, 2e-3, 3e-3], [5.0, 0.7, 0.9]
    struck.y[at.turntable_speed] = TURNING
    struck.memory[at.contacts.start] = 4.3
    going.mode[circling.touching] = 1
    passes = empty_passes(rows)
    passes.table[:] = 7.0
    passes.counts[[column.FLIGHT_STEPS, column.BLOW_STEPS]] = rows - 1
    return tables, going, struck, circling, at, passes


def test_row_of_a_pass_begins_with_what_is_so_at_first_touch():
    tables, going, struck, _, _, passes = begun()
    passes.numbers[:] = 7.0
    passes.counts[[column.SAMPLES, column.FALLEN, column.CONTACTS_SEEN]] = 5, 1, 3
    assert open_row(tables.flight, tables.blow, going, struck, passes, 0.71)
    row = passes.table[0]
    names = "PASS STRIKER TIME APPROACH FACE FACE_SPEED DISC_SPEED CONTACTS"
    found = [row[getattr(column, name)] for name in names.split()]
    assert found == [2.0, 1.0, 0.71, 4.3, 2e-3, 0.7, TURNING, 1.0]
    assert row[column.ANGLE] == pytest.approx(-0.1, abs=1e-14)
    zeros = "IMPULSE LATER VELOCITY_CHANGE BLOW_CHANGE LAST_CHANGE BLOW_IMPULSE STOP_FORCE"
    assert [row[getattr(column, name)] for name in zeros.split()] == [0.0] * 7
    assert np.isnan(row[[column.PEAK, column.WIDTH]]).all()
    places = [column.LET_GO, column.FIRST_PLACE, column.HIGHEST, column.SPEED_BEFORE, column.TOP]
    assert passes.numbers[places].tolist() == [7.0, 3e-3, 3e-3, 0.7, -math.inf]
    counts = [column.CURRENT, column.SAMPLES, column.CONTACTS_SEEN, column.ROWS_USED, column.IN_TOUCH, column.FALLEN]
    assert passes.counts[counts].tolist() == [0, 0, 1, 1, 1, 0]
    assert passes.contacts[0].tolist() == [0.71, 0.71, 0.0, 0.0]


def test_later_touch_of_a_pass_adds_a_contact_and_another_pass_a_row():
    tables, going, struck, _, at, passes = begun(rows=2)
    assert open_row(tables.flight, tables.blow, going, struck, passes, 0.71)
    passes.counts[column.SAMPLES] = 9
    before = passes.table[0].copy()
    struck.y[at.positions] = 0.05
    assert open_row(tables.flight, tables.blow, going, struck, passes, 0.72)
    changed = ~np.isclose(before, passes.table[0], rtol=0.0, atol=0.0, equal_nan=True)
    assert np.flatnonzero(changed).tolist() == [column.CONTACTS]
    assert passes.table[0, column.CONTACTS] == 2.0
    assert passes.counts[[column.CURRENT, column.SAMPLES, column.CONTACTS_SEEN]].tolist() == [0, 9, 2]
    struck.y[at.angle] += 2.0 * math.pi / 3.0
    assert open_row(tables.flight, tables.blow, going, struck, passes, 0.73)
    assert passes.table[:, column.PASS].tolist() == [2.0, 3.0]
    assert passes.counts[[column.CURRENT, column.SAMPLES, column.CONTACTS_SEEN]].tolist() == [1, 0, 1]
    struck.y[at.angle] += 2.0 * math.pi / 3.0
    assert not open_row(tables.flight, tables.blow, going, struck, passes, 0.74)


def test_touch_after_its_apex_takes_the_row_of_the_missed_pass():
    tables, going, struck, circling, _, passes = begun()
    going.y[circling.angle] = 4.0 * math.pi / 3.0
    assert missed_row(tables.flight, going, passes, 0.7, 9e-3)
    assert open_row(tables.flight, tables.blow, going, struck, passes, 0.71)
    assert passes.counts[column.ROWS_USED] == 1
    assert passes.table[0, [column.PASS, column.TIME, column.FACE]].tolist() == [2.0, 0.71, 2e-3]


def test_row_of_a_missed_pass_has_its_apex():
    tables, going, _, circling, _, passes = begun()
    going.y[circling.angle], going.y[circling.turntable_speed] = 5.1 * 2.0 * math.pi / 3.0, 69.0
    assert missed_row(tables.flight, going, passes, 0.72, 9e-3)
    row = passes.table[0]
    found = [row[getattr(column, name)] for name in ("PASS", "STRIKER", "TIME", "FACE", "DISC_SPEED")]
    assert found == [5.0, 2.0, 0.72, 9e-3, 69.0]
    zeros = ("CONTACTS", "VELOCITY_CHANGE", "BLOW_CHANGE", "LAST_CHANGE", "BLOW_IMPULSE", "STOP_FORCE")
    assert [row[getattr(column, name)] for name in zeros] == [0.0] * 6
    assert np.count_nonzero(row == 7.0) == 8  # what there is none of stays as it was
    # the same pass again, or an earlier one, is known
    assert missed_row(tables.flight, going, passes, 0.73, 9e-3)
    going.y[circling.angle] = 4.1 * 2.0 * math.pi / 3.0
    assert missed_row(tables.flight, going, passes, 0.74, 9e-3)
    assert passes.counts[column.ROWS_USED] == 1
    passes.counts[column.ROWS_USED] = 3
    passes.table[2, column.PASS] = 5.0
    going.y[circling.angle] = 6.1 * 2.0 * math.pi / 3.0
    assert not missed_row(tables.flight, going, passes, 0.75, 9e-3)


def test_passes_count_from_0():
    tables, going, _, circling, _, passes = begun()
    for number, rows in ((-1, 0), (0, 1), (1, 2)):
        going.y[circling.angle] = number * 2.0 * math.pi / 3.0
        assert missed_row(tables.flight, going, passes, 0.7, 9e-3)
        assert passes.counts[column.ROWS_USED] == rows


@pytest.mark.parametrize(
    ("phase", "since", "rows"),
    [(HELD, 0.5, 1), (RELEASED, 0.7, 1), (RELEASED, 0.6, 0), (HELD - 1, 0.7, 0), (RETRACTING, 0.7, 0)],
)
def test_pass_is_missed_only_where_the_object_is_held(phase, since, rows):
    """Or is released by this very apex; the first pass of a turn has number 0."""
    tables, going, _, circling, _, passes = begun()
    going.mode[circling.feed], going.memory[circling.feed_start] = phase, since
    going.y[circling.angle] = 0.1
    assert missed_row(tables.flight, going, passes, 0.7, 9e-3)
    assert passes.counts[column.ROWS_USED] == rows


# steps of a blow and of a flight, each a motion at constant acceleration


def step_of(record, r, time, step, y, rate, change):
    """Let row r of a record be a step in which a state goes as y + rate t + change t^2/2."""
    dense = record.dense[r]
    dense[:] = 0.0
    delta = rate * step + 0.5 * change * step**2
    dense[0], dense[1], dense[2] = y, delta, -0.5 * change * step**2
    record.time[r], record.step[r] = time, step


K = 3.0e6
"""Of the contact in these steps, a linear one, N/m."""


def in_blow(speeds=(4.0, 1.0, 0.5), accelerations=(-900.0, 700.0, 300.0), places=(1e-5, 2e-6, -4.7e-3)):
    """Return a blow of three steps of a linear contact, its striker, nose and assembly at constant accelerations."""
    tables, going, struck, _, at, passes = begun()
    chain = tables.blow.chain
    open_row(tables.flight, tables.blow, going, struck, passes, 0.71)
    chain.values[at.contacts.start, [STIFFNESS, EXPONENT, DAMPING]] = K, 1.0, 0.0
    y, rate, change = np.zeros((3, at.states))
    y[at.positions], y[at.speeds] = places, speeds
    rate[at.positions], rate[at.speeds], change[at.positions] = speeds, accelerations, accelerations
    for r, (time, step) in enumerate(((0.71, 3e-6), (0.710003, 5e-6), (0.710008, 2e-6))):
        step_of(
            struck.record,
            r,
            time,
            step,
            y + rate * (time - 0.71) + 0.5 * change * (time - 0.71) ** 2,
            rate + change * (time - 0.71),
            change,
        )
        mode = struck.record.mode[r]
        mode[:] = struck.mode
        mode[at.contacts.start] = mode[at.mounts.start] = mode[at.frame] = PUSHING
        mode[at.support] = mode[at.stop] = PUSHING
        mode[at.rail], mode[at.feed] = SLIDING_BACK, FEEDING
        struck.record.memory[r] = struck.memory
        struck.record.memory[r][at.depths], struck.record.memory[r][at.feed_start] = 0.0, 0.71 - 0.019
    passes.numbers[[column.FIRST_PLACE, column.HIGHEST]] = places[2]
    passes.counts[column.BLOW_STEPS] = 0
    return tables, struck, at, passes, (y, rate, change)


def state(motion, t):
    y, rate, change = motion
    return y + rate * t + 0.5 * change * t**2


def from_carriage(x, v, since, stroke_time=0.031):
    """Return place and speed of the assembly from the carriage, on its way in for so long."""
    settings = machine_system(uneven(feed={"stroke_time": stroke_time})).settings
    place, speed, _ = carriage(settings, FEEDING, since)
    return x - place, v - speed


def rigid(x, v, t):
    """Return the acceleration of the assembly by frame, stop, support and rail, and gravity, m/s^2."""
    frame = 9.1e5 * (x[1] - x[2]) + 210.0 * (v[1] - v[2])
    away, rate = from_carriage(x[2], v[2], 0.019 + t)
    support = 390.0 + 41e3 * (away + 5.5e-3) + 23.0 * rate
    return (frame + stop_force(away, rate) - support + 31.0) / 0.43 + 9.7


def stop_force(x, v):
    return 2.1e5 * (-x - 5.5e-3 + (390.0 - 0.5 * 9.7) / 2.1e5) - OBJECT.stop_damping * v


@pytest.mark.parametrize(("weight", "closed"), [(5e-3, True), (0.0, False)])
def test_sample_of_a_step_is_the_acceleration_of_the_assembly_at_its_time(weight, closed):
    tables, struck, at, passes, motion = in_blow()
    work = np.empty(at.states)
    _sample_blow(tables.blow, struck.record, 1, 0.3, weight, passes, work)
    _sample_blow(tables.blow, struck.record, 2, 0.8, weight, passes, work)
    impulse = 0.0
    for k, (t, step) in enumerate(((3e-6 + 0.3 * 5e-6, 5e-6), (8e-6 + 0.8 * 2e-6, 2e-6))):
        y = state(motion, t)
        x, v = y[at.positions], y[at.speeds]
        assert passes.samples[:, k] == pytest.approx([0.71 + t, rigid(x, v, t), v[2]], rel=1e-11)
        impulse += weight * step * K * (x[0] - x[1])
    assert passes.counts[column.SAMPLES] == 2
    assert passes.numbers[column.TOP] == passes.samples[1, :2].max()
    assert passes.table[0, column.IMPULSE] == pytest.approx(impulse, rel=1e-9)
    assert passes.contacts[0, 2] == passes.table[0, column.IMPULSE]
    assert passes.counts[column.FALLEN] == 0


def test_samples_end_where_the_pulse_has_fallen_after_its_contact_and_where_the_table_ends():
    tables, struck, at, passes, _ = in_blow()
    work, foot = np.empty(at.states), column.FOOT_LEVEL
    _sample_blow(tables.blow, struck.record, 0, 0.5, 0.0, passes, work)
    a = passes.samples[1, 0]
    for top, weight, fallen in ((a / foot * 1.02, 0.0, 1), (a / foot * 0.98, 0.0, 0), (a / foot * 1.02, 0.1, 0)):
        passes.numbers[column.TOP] = top
        _sample_blow(tables.blow, struck.record, 0, 0.5, weight, passes, work)
        assert passes.counts[column.FALLEN] == fallen
    room = passes.samples.shape[1]
    passes.counts[column.SAMPLES] = room - 1
    before = passes.table[0, column.IMPULSE]
    for _ in range(2):
        _sample_blow(tables.blow, struck.record, 1, 0.5, 0.1, passes, work)
        assert passes.counts[column.SAMPLES] == room
    assert passes.table[0, column.IMPULSE] > before


def test_blow_books_impulse_and_contacts_of_its_steps():
    """A linear contact along parabolas: the integral of its force; open in the second step, and closed again."""
    tables, struck, at, passes, motion = in_blow()
    record, contact = struck.record, at.contacts.start
    record.mode[1, contact], struck.mode[contact] = OPEN, OPEN
    passes.numbers[column.SPEED_BEFORE] = 0.2
    note_blow(tables.flight, tables.blow, struck, passes, 3, np.empty(at.states))
    y, rate, change = (part[at.positions][0] - part[at.positions][1] for part in motion)
    through = [K * (y * t + rate * t**2 / 2 + change * t**3 / 6) for t in (0.0, 3e-6, 8e-6, 10e-6)]
    impulses = through[1], through[3] - through[2]
    row = passes.table[0]
    assert passes.contacts[:2, 2] == pytest.approx(impulses, rel=1e-9)
    assert row[column.IMPULSE] == pytest.approx(sum(impulses), rel=1e-9)
    assert passes.contacts[:2, 0] == pytest.approx([0.71, 0.710008], abs=1e-15)
    assert passes.contacts[:2, 1] == pytest.approx([0.710003, 0.71001], abs=1e-15)
    changes = [0.14 * v[1] + 0.86 * v[2] - 0.2 for v in (state(motion, t)[at.speeds] for t in (3e-6, 10e-6))]
    assert passes.contacts[:2, 3] == pytest.approx(changes, rel=1e-9)
    assert row[column.LAST_CHANGE] == pytest.approx(changes[1], rel=1e-9)
    assert row[column.CONTACTS] == 2.0
    counts = [column.CONTACTS_SEEN, column.IN_TOUCH, column.BLOW_STEPS, column.SAMPLES]
    assert passes.counts[counts].tolist() == [2, 0, 3, 15]
    # the five points of a step in their order
    nodes = 0.5 + 0.5 * np.polynomial.legendre.leggauss(5)[0]
    times = np.concatenate([0.71 + 3e-6 * nodes, 0.710003 + 5e-6 * nodes, 0.710008 + 2e-6 * nodes])
    assert passes.samples[0, :15] == pytest.approx(times, abs=1e-15)


def test_contact_that_ends_before_the_last_step_has_ended_though_another_begins():
    tables, struck, at, passes, _ = in_blow()
    struck.record.mode[:3, at.contacts.start], struck.mode[at.contacts.start] = [PUSHING, PUSHING, OPEN], PUSHING
    note_blow(tables.flight, tables.blow, struck, passes, 3, np.empty(at.states))
    assert passes.contacts[0, 1] == pytest.approx(0.710008, abs=1e-15)
    assert passes.counts[[column.CONTACTS_SEEN, column.IN_TOUCH]].tolist() == [1, 0]


def test_contact_that_lasts_beyond_its_steps_goes_on():
    tables, struck, at, passes, _ = in_blow()
    struck.mode[at.contacts.start] = PUSHING
    passes.counts[column.BLOW_STEPS] = 4
    note_blow(tables.flight, tables.blow, struck, passes, 2, np.empty(at.states))
    assert passes.counts[[column.CONTACTS_SEEN, column.IN_TOUCH, column.BLOW_STEPS]].tolist() == [1, 1, 6]
    assert passes.contacts[0, 1] == 0.71
    assert passes.table[0, column.LAST_CHANGE] == 0.0


@pytest.mark.parametrize(("fallen", "mode", "samples"), [(0, OPEN, 15), (1, OPEN, 0), (1, PUSHING, 15)])
def test_pulse_that_has_fallen_is_sampled_in_touch_alone(fallen, mode, samples):
    tables, struck, at, passes, _ = in_blow()
    struck.record.mode[:3, at.contacts.start] = struck.mode[at.contacts.start] = mode
    passes.counts[column.FALLEN] = fallen
    note_blow(tables.flight, tables.blow, struck, passes, 3, np.empty(at.states))
    assert passes.counts[column.SAMPLES] == samples


def test_highest_place_and_largest_force_of_the_stop_in_a_step():
    """At its begin, middle and end: the assembly turns back in the middle; the stop bears the most at the begin."""
    still, turns = (0.0, 0.0, 0.0), (0.0, 0.0, -4e5)
    for accelerations, speeds, best in ((turns, (0.0, 0.0, 1.0), 2), (still, still, 0), (still, (0.0, 0.0, -3.0), 2)):
        tables, struck, at, passes, motion = in_blow(speeds, accelerations)
        _note_support(tables.blow, struck.record, 1, passes, np.empty(at.states))
        places = [state(motion, 3e-6 + 5e-6 * x)[[2, 5]] for x in (0.0, 0.5, 1.0)]
        row = passes.table[0]
        highest = max(-4.7e-3, *(x for x, _ in places))
        assert row[column.LARGEST_DISPLACEMENT] == pytest.approx(highest + 4.7e-3, rel=1e-9)
        forces = [stop_force(*from_carriage(*places[k], 0.019 + 3e-6 + 2.5e-6 * k)) for k in range(3)]
        assert row[column.STOP_FORCE] == pytest.approx(max(forces), rel=1e-10)
        assert np.argmax(forces) == best
        passes.table[0, column.STOP_FORCE] = 0.0
        struck.record.mode[1, at.stop] = OPEN
        _note_support(tables.blow, struck.record, 1, passes, np.empty(at.states))
        assert row[column.STOP_FORCE] == 0.0


def in_flight(speed, acceleration, steps=(0.4, 0.3), highest=-4.8e-3):
    """Return a flight of an object at a constant acceleration from a place, its row begun, and its layout."""
    tables, going, struck, circling, _ = parts(feed={"stroke_time": 2.0})
    passes = empty_passes(3)
    open_row(tables.flight, tables.blow, going, struck, passes, 0.71)
    passes.numbers[[column.FIRST_PLACE, column.HIGHEST]] = -5e-3, highest
    passes.counts[column.BLOW_STEPS] = 1
    t = 0.0
    for r, step in enumerate(steps):
        y, rate, change = np.zeros((3, circling.states))
        y[circling.positions] = -4.7e-3 + speed * t + 0.5 * acceleration * t**2
        y[circling.speeds] = rate[circling.positions] = speed + acceleration * t
        rate[circling.speeds] = change[circling.positions] = acceleration
        step_of(going.record, r, 0.8 + t, step, y, rate, change)
        going.record.mode[r], going.record.memory[r] = going.mode, going.memory
        going.record.mode[r][circling.stop], going.record.mode[r][circling.feed] = OPEN, FEEDING
        going.record.memory[r][circling.feed_start] = 0.1
        t += step
    return tables.flight, going, circling, passes


@pytest.mark.parametrize(
    ("speed", "acceleration", "rise"),
    [
        (0.006, -0.02, 0.0009),  # v^2/(2 a), 0.3 s in
        (0.006, -0.01, 0.0018),  # 0.6 s in: within the second step
        (0.006, -0.005, 0.006 * 0.7 - 0.0025 * 0.49),  # not yet back
        (-0.006, 0.02, 0.0),  # falls, and comes back up to -0.006 0.7 + 0.01 0.49 > 0
    ],
)
def test_object_is_farthest_where_it_turns_back(speed, acceleration, rise):
    flight, going, circling, passes = in_flight(speed, acceleration)
    note_flight(flight, going, passes, 2, np.empty(circling.states))
    rise = max(rise, 0.7 * speed + 0.245 * acceleration)
    highest = max(-4.7e-3 + rise, -4.8e-3)
    assert passes.table[0, column.LARGEST_DISPLACEMENT] == pytest.approx(highest + 5e-3, rel=1e-8)
    assert passes.counts[column.FLIGHT_STEPS] == 2
    flight, going, circling, passes = in_flight(speed, acceleration, highest=-1e-3)  # it was farther before
    note_flight(flight, going, passes, 2, np.empty(circling.states))
    assert passes.table[0, column.LARGEST_DISPLACEMENT] == pytest.approx(4e-3, rel=1e-14)


def test_turning_place_is_the_top_of_its_parabola():
    _, going, circling, _ = in_flight(0.006, -0.02)
    place = _turning_place(circling, going.record.dense[0], np.empty(circling.states))
    assert place == pytest.approx(-4.7e-3 + 0.0009, abs=1e-15)  # flat at the top


@pytest.mark.parametrize(("acceleration", "first", "last"), [(0.2, 1, 7), (-0.2, 8, 8), (9.0, 0, 0)])
def test_largest_force_of_the_stop_is_found_from_the_first_to_the_last_of_nine_times(acceleration, first, last):
    flight, going, circling, passes = in_flight(-0.05, acceleration, (0.1, 0.3))
    going.record.mode[1, circling.stop] = PUSHING
    note_flight(flight, going, passes, 2, np.empty(circling.states))
    forces = []
    for t in 0.1 + 0.3 * np.arange(9) / 8:
        place, speed = -4.7e-3 - 0.05 * t + 0.5 * acceleration * t**2, acceleration * t - 0.05
        forces.append(stop_force(*from_carriage(place, speed, 0.7 + t, 2.0)))
    assert first <= np.argmax(forces) <= last
    assert passes.table[0, column.STOP_FORCE] == pytest.approx(max(*forces, 0.0), rel=1e-12)


def test_stop_of_a_flight_is_looked_at_nine_times_a_step_until_the_retraction():
    flight, going, circling, passes = in_flight(-0.05, 0.2, (0.1, 0.3))
    work = np.empty(circling.states)
    going.record.mode[1, circling.stop] = PUSHING
    going.record.memory[0, circling.feed_start] = 0.2  # of the step before
    note_flight(flight, going, passes, 2, work)
    times = 0.1 + 0.3 * np.arange(9) / 8
    motion = [(-4.7e-3 - 0.05 * t + 0.1 * t**2, 0.2 * t - 0.05, 0.7 + t, 2.0) for t in times]
    forces = [stop_force(*from_carriage(*one)) for one in motion]
    assert 0 < np.argmax(forces) < 8
    assert passes.table[0, column.STOP_FORCE] == pytest.approx(max(forces), rel=1e-12)
    passes.table[0, column.STOP_FORCE] = passes.counts[column.FLIGHT_STEPS] = 0.0
    going.record.mode[1, circling.feed] = RETRACTING
    passes.numbers[column.HIGHEST] = -1.0
    note_flight(flight, going, passes, 2, work)
    assert passes.table[0, column.STOP_FORCE] == 0.0
    assert passes.counts[column.FLIGHT_STEPS] == 2
    assert passes.numbers[column.HIGHEST] == pytest.approx(-4.7e-3 - 5e-3 + 1e-3, rel=1e-9)  # of the step before


def test_flight_before_the_first_pass_and_after_a_missed_one_moves_nothing():
    flight, going, circling, passes = in_flight(0.006, -0.02)
    work = np.empty(circling.states)
    passes.table[0, [column.CONTACTS, column.LARGEST_DISPLACEMENT]] = 0.0, -9.0
    note_flight(flight, going, passes, 2, work)
    assert passes.table[0, column.LARGEST_DISPLACEMENT] == -9.0
    assert passes.numbers[column.HIGHEST] > -4.8e-3
    passes.numbers[column.HIGHEST] = -1.0
    before = passes.table.copy(), passes.numbers.copy()
    passes.counts[column.CURRENT] = -1
    note_flight(flight, going, passes, 2, work)
    assert np.array_equal(passes.table, before[0], equal_nan=True)
    assert passes.numbers.tolist() == before[1].tolist()
    assert passes.counts[column.FLIGHT_STEPS] == 4


def test_pulse_that_begins_at_its_top_has_no_rise():
    """A level is crossed between the last sample above it and the first at or below it, on the nearest sides of the top."""
    samples = np.array(
        [[0.0, 1.0, 3.0, 4.0, 6.0, 7.0], [1.0, 5.0, 2.0, 8.0, 4.0, 1.0], [1.0, 2.0, 4.0, 7.0, 11.0, 16.0]]
    )
    begin, end, before, after = _crossings(samples, 3, 6, 4.0)
    assert (begin, before) == pytest.approx((3.0 + 1.0 / 3.0, 5.0))
    assert (end, after) == pytest.approx((6.0, 11.0))
    begin, end, before, after = _crossings(samples, 3, 6, 0.5)
    assert math.isnan(begin)
    assert math.isnan(end)
    assert (before, after) == (1.0, 16.0)
    assert _crossings(samples, 3, 5, 1.0)[2:] == pytest.approx((1.0, 11.0))
    assert _crossings(samples, 3, 5, 1.0)[0] == 0.0
