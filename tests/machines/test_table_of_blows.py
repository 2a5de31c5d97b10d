"""The table of blows of a run that is made up: a pulse of half a sine, a contact that gives back 0.7 of its speed."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.contact import Contact
from strikewave.contact.elastoplastic import spot_after
from strikewave.machines._layout import APEX_SWITCH
from strikewave.machines.blows import _kind, _work, blows, contact_table, counted_passes, pulse_window, window_ends
from strikewave.machines.machine import Launch, Machine, Striker, Strikers
from strikewave.machines.spans import Impulses, Moments, Rebounds

from .uneven import OBJECT, uneven

PITCH = 2.0 * math.pi / 3.0
TOUCH, LASTS = 0.2, 1e-3
"""When the blow begins, and how long it lasts, s."""
FLYING = Machine(
    Strikers((Striker(1.3, 0.0, 0.0, Contact(5e9, 1.2)),), 0.3), OBJECT, Launch(striker_speed=3.0, rebounds=Rebounds())
)


class Made:
    """A run in which all is known in closed form; each blow repeats the one at `TOUCH`."""

    def __init__(self, rows, machine=None, apexes=(), held=(0.1, 0.9), end=1.0, released=0.9):
        self.machine, self.rows, self.apexes = machine or uneven(), np.array(rows, dtype=float).reshape(-1, 4), apexes
        self.held, self.end, self.released, self.asked, self.parted = held, end, released, [], []
        self.depths = (0.0, 0.0)

    def contacts(self):
        return self.rows

    def switch_times(self, which):
        return np.array(self.apexes, dtype=float) if which == APEX_SWITCH else np.empty(0)

    def sample(self, times):
        self.asked.append(times)
        x = (times - TOUCH) / LASTS
        inside = (x >= 0.0) & (x <= 1.0)
        sine = np.where(inside, np.sin(math.pi * x), 0.0)
        return Moments(
            contact_force=np.where(x < 0.5, 800.0, 0.49 * 800.0) * sine,
            rigid_acceleration=5000.0 * sine,
            face_place=-4e-3 + 0.1 * times,
            assembly_place=-2e-3 + 5e-3 * np.sin(2.0 * math.pi * (times - TOUCH)),
            assembly_speed=0.0 * times,
            object_speed=3.0 * times,
            turntable_angle=9.1 * PITCH + 10.0 * (times - TOUCH) * PITCH,
            turntable_speed=70.0 + times,
            indentation=6e-5 * sine,
            side_force=-40.0 * sine + 1.0,
            friction_heat=7.0 * times,
        )

    def impulses(self, begin, end):
        return Impulses(1000.0 * (end - begin), -70.0 * (end - begin), 50.0 * (end - begin))

    def deepest(self, time, striker):
        assert striker == 1
        return self.depths[0] if time < TOUCH else self.depths[1]

    def span_at(self, time):
        self.parted.append(time)
        return SimpleNamespace(parting_speed=lambda time, striker: 100.0 * (time - TOUCH) + striker)


def one(*rows, **changes):
    run = Made(rows or [(TOUCH, TOUCH + LASTS, 3.0, 1.0)], **changes)
    (blow,) = blows(run)
    return blow, run


def test_blow_has_the_figures_of_its_pulse():
    blow, run = one()
    assert (blow.index, blow.kind, blow.striker, blow.contacts) == (1, "full", 2, 1)
    assert (blow.time, blow.approach_speed) == (TOUCH, 3.0)
    assert blow.contact_time == pytest.approx(LASTS, rel=1e-9)
    assert blow.rebound_speed == pytest.approx(0.1 + 1.0, rel=1e-9)
    assert TOUCH + 0.9 * LASTS < run.parted[0] < TOUCH + LASTS  # the span that ends there
    assert blow.rigid_peak == pytest.approx(5000.0, rel=1e-6)
    width = LASTS * (1.0 - 2.0 * math.asin(0.1) / math.pi)
    assert blow.width == pytest.approx(width, rel=1e-6)
    assert blow.rise == pytest.approx(LASTS * (math.asin(0.9) - math.asin(0.1)) / math.pi, rel=1e-5)
    assert blow.velocity_change == pytest.approx(2.0 * 5000.0 * LASTS / math.pi * math.cos(math.asin(0.02)), rel=1e-5)
    assert (blow.peak_force, blow.side_force) == pytest.approx((800.0, -39.0), rel=1e-5)
    assert blow.indentation == pytest.approx(6e-5, rel=1e-9)
    assert blow.restitution == pytest.approx(0.7, rel=1e-4)  # of 2001 samples
    assert (blow.contact_impulse, blow.support_impulse, blow.impulse) == pytest.approx((1.0, -0.07, 0.93), rel=1e-9)
    assert (blow.side_impulse, blow.friction_heat) == pytest.approx((0.05, 7e-3), rel=1e-9)
    assert blow.blow_velocity_change == pytest.approx(3e-3, rel=1e-9)
    assert blow.momentum_error == pytest.approx(0.93 - 0.5 * 3e-3, rel=1e-9)
    assert blow.turntable_speed == pytest.approx(70.2, rel=1e-12)
    # a quarter of a period after: the path goes on until the object is taken back
    assert blow.largest_displacement == pytest.approx(5e-3, rel=1e-5)
    spot = spot_after(uneven().strikers.each[1].contact, blow.indentation, 0.0)
    assert blow.contact_stiffness == pytest.approx(spot.stiffness, rel=1e-12)
    assert (blow.residual_indentation, blow.flattening) == (0.0, 1.0)


def test_displacement_ends_with_the_next_blow_or_the_retraction():
    for until in (0.25, 0.3):
        blow, _ = one(released=until)
        assert blow.largest_displacement == pytest.approx(5e-3 * math.sin(2.0 * math.pi * (until - TOUCH)), rel=1e-5)
    run = Made([(TOUCH, TOUCH + LASTS, 3.0, 1.0), (0.25, 0.2505, 3.0, 1.0)])
    assert blows(run)[0].largest_displacement == pytest.approx(5e-3 * math.sin(0.1 * math.pi), rel=1e-5)
    blow, _ = one(released=0.1)  # as it was taken back before: to the last release
    assert blow.largest_displacement == pytest.approx(5e-3 * math.sin(2e-3 * math.pi), rel=1e-5)


def test_momentum_is_measured_by_the_largest_impulse_and_by_a_speed_at_least():
    blow, run = one()
    for impulses, scale in ((Impulses(2.0, -5.0), 5.0), (Impulses(3.0, 1.0), 3.0), (Impulses(0.0, 1e-9), 0.5e-6)):
        run.impulses = lambda begin, end, found=impulses: found
        (blow,) = blows(run)
        missed = abs(impulses.contact + impulses.support - 0.5 * blow.blow_velocity_change)
        assert blow.momentum_error == pytest.approx(missed / scale, rel=1e-9)


@pytest.mark.parametrize(("before", "after", "deep"), [(0.0, 9e-5, 9e-5), (9e-5, 9e-5, 6e-5), (8e-5, 9e-5, 9e-5)])
def test_what_yields_in_a_blow_is_its_indentation(before, after, deep):
    run = Made([(TOUCH, TOUCH + LASTS, 3.0, 1.0)])
    run.depths = before, after
    (blow,) = blows(run)
    assert blow.indentation == pytest.approx(deep, rel=1e-9)


def test_blow_is_sampled_from_50_us_before_to_1_5_ms_after_it_every_quarter_of_a_microsecond():
    _, run = one()
    times = run.asked[1]  # after the angles of first touch
    assert times[0] - TOUCH == pytest.approx(-50e-6, abs=1e-12)
    assert np.diff(times)[0] == pytest.approx(0.25e-6, rel=1e-3)
    assert times[-1] - TOUCH == pytest.approx(LASTS + 1.5e-3, abs=0.25e-6)
    early = Made([(20e-6, 20e-6 + LASTS, 3.0, 1.0)])
    assert pulse_window(early, 20e-6, 1e-3)[0][0] == pytest.approx(-20e-6, abs=0.25e-6)
    since, force, acceleration = pulse_window(run, TOUCH, 1e-3, 1e-6)
    assert since == pytest.approx(np.arange(-50, 1001) * 1e-6, abs=1e-15)
    assert force.max() == pytest.approx(800.0, rel=1e-4)
    assert acceleration.max() == pytest.approx(5000.0, rel=1e-4)
    assert pulse_window(run, 0.9, 5.0, 0.03)[0][-1] == pytest.approx(0.09)  # to the end of the run


def test_window_of_a_blow_lasts_a_swing_of_its_frame_and_a_second_at_most():
    soft = uneven(struck={"frame_stiffness": 2e3})
    swing = 1.0 / soft.struck.frame_frequency
    assert 5e-3 < swing < 0.05
    _, run = one(machine=soft)
    assert run.asked[1][-1] - TOUCH == pytest.approx(LASTS + swing, abs=1e-6)
    lies = Made([(TOUCH, 2.9, 3.0, 1.0)], end=3.0, held=(0.1, 2.9), released=2.9)
    blows(lies)
    times = lies.asked[1]
    assert times[-1] - TOUCH == pytest.approx(1.0, abs=1e-5)
    assert np.diff(times)[0] == pytest.approx(5e-6, rel=1e-3)  # 200 000 samples at most
    nexts = Made([(TOUCH, TOUCH + LASTS, 3.0, 1.0), (TOUCH + 1.8e-3, 0.3, 3.0, 1.0)], machine=FLYING)
    nexts.deepest = lambda time, striker: 0.0
    nexts.rows[:, 3] = 0.0
    blows(nexts)
    assert nexts.asked[0][-1] - TOUCH == pytest.approx(0.1 + 1.5e-3, abs=2e-6)


# which blow it is


def judged(*rows, machine=None, shares=None, width=1e-4):
    run = Made(rows, machine=machine)
    if shares:
        run.impulses = lambda begin, end: Impulses(shares if begin > TOUCH + 1e-9 else 1.0, 0.0, 0.0)
    return _kind(run, np.array(rows), width)


def test_blow_below_half_the_nominal_speed_is_glancing():
    nominal = uneven().nominal_approach
    for share, kind in ((0.499, "glancing"), (0.501, "full")):
        assert judged((TOUCH, 0.21, share * nominal, 1.0)) == (kind, 0.21)
    assert judged((TOUCH, 0.21, 1e-3, 1.0), machine=FLYING)[0] == "full"


@pytest.mark.parametrize(
    ("gap", "share", "kind", "end"),
    [(1.01e-4, 0.101, "double", 0.213), (1.01e-4, 0.099, "full", 0.21), (0.99e-4, 0.9, "full", 0.213)],
)
def test_second_group_of_contacts_makes_a_double_blow_by_its_impulse(gap, share, kind, end):
    """A width later, with a tenth of the impulse; else it is none of the blow, which ends with its first group."""
    first, later = (TOUCH, 0.21, 9.0, 1.0), (0.21 + gap, 0.2115, 0.2, 1.0)
    found = judged(first, later, (0.21155, 0.213, 0.1, 1.0), shares=share)
    assert found == (kind, end)


def test_contacts_before_the_gap_belong_to_the_blow():
    rows = [(TOUCH, 0.21, 9.0, 1.0), (0.21005, 0.212, 1.0, 1.0), (0.22, 0.221, 1.0, 1.0)]
    assert judged(*rows, shares=0.05) == ("full", 0.212)


# which passes there are


def test_contacts_belong_to_the_pass_of_their_striker():
    """The turntable has turned 9.1 pitches at 0.2 s, and turns 10 a second; a launched machine counts its blows."""
    run = Made([(TOUCH, 0.201, 3.0, 1.0), (0.239, 0.24, 3.0, 1.0), (0.241, 0.242, 3.0, 1.0)])
    assert contact_table(run)[:, 4].tolist() == [9.0, 9.0, 10.0]
    assert contact_table(run)[:, :4].tolist() == run.rows.tolist()
    flown = Made([(TOUCH, 0.201, 3.0, 0.0), (0.3, 0.301, 2.0, 0.0)], machine=FLYING)
    assert contact_table(flown)[:, 4].tolist() == [0.0, 1.0]
    assert contact_table(Made([])).shape == (0, 5)


def test_passes_count_while_the_object_is_held():
    run = Made([], apexes=(0.09, 0.1, 0.39, 0.9, 0.9 + 5e-13, 0.9 + 5e-12), held=(0.1, 0.9))
    found = counted_passes(run)
    assert list(found) == [8, 11, 16]
    assert list(found.values()) == [0.1, 0.39, 0.9 + 5e-13]  # rounding of the end counts, no more
    assert counted_passes(Made([])) == {}


def test_missed_passes_stand_among_the_blows():
    run = Made([(TOUCH, TOUCH + LASTS, 3.0, 1.0)], apexes=(0.11, 0.205, 0.29))
    first, struck, last = blows(run)
    assert [one.kind for one in (first, struck, last)] == ["missed", "full", "missed"]
    assert [one.index for one in (first, struck, last)] == [1, 2, 3]
    assert [one.time for one in (first, struck, last)] == [0.11, TOUCH, 0.29]
    assert (first.striker, last.striker) == (8 % 3 + 1, 10 % 3 + 1)
    assert first.largest_displacement == pytest.approx(-4e-3 + 0.011 + 5.5e-3)
    assert (first.turntable_speed, first.contacts) == (pytest.approx(70.11), 0)
    zeros = "impulse contact_impulse support_impulse peak_force velocity_change blow_velocity_change side_force"
    assert [getattr(first, name) for name in f"{zeros} side_impulse friction_heat".split()] == [0.0] * 9
    nothing = "approach_speed rebound_speed contact_time restitution rigid_peak width rise indentation flattening"
    assert all(math.isnan(getattr(first, name)) for name in nothing.split())


def test_object_that_is_not_pushed_has_no_pulse():
    run = Made([(TOUCH, TOUCH + LASTS, 3.0, 1.0)])
    pushed = run.sample
    run.sample = lambda times: pushed(times)._replace(rigid_acceleration=-pushed(times).rigid_acceleration)
    (blow,) = blows(run)
    assert all(math.isnan(one) for one in (blow.rigid_peak, blow.width, blow.rise, blow.velocity_change))
    run.sample = lambda times: pushed(times)._replace(rigid_acceleration=1e-6 * pushed(times).rigid_acceleration)
    assert blows(run)[0].rigid_peak == pytest.approx(5e-3, rel=1e-6)


def test_contact_that_takes_no_work_has_no_restitution():
    run = Made([(TOUCH, TOUCH + LASTS, 3.0, 1.0)])
    still = run.sample
    run.sample = lambda times: still(times)._replace(indentation=3e-5 + 0.0 * times)
    (blow,) = blows(run)
    assert math.isnan(blow.restitution)
    assert blow.indentation == 3e-5
    run.sample = lambda times: still(times)._replace(contact_force=1e-3 * still(times).contact_force)
    assert blows(run)[0].restitution == pytest.approx(0.7, rel=1e-4)  # however small


def test_work_of_all_contacts_of_a_blow_counts():
    """The first half of the sine takes, the second half gives back: cut in two contacts it is the same."""
    cut = TOUCH + 0.37 * LASTS
    rows = np.array([[TOUCH, cut, 3.0, 1.0], [cut, TOUCH + LASTS, 1.0, 1.0]])
    assert _work(Made(rows), rows) == pytest.approx((6e-5, 0.7), rel=1e-4)
    assert _work(Made(rows), rows[:1])[0] == pytest.approx(6e-5 * math.sin(0.37 * math.pi), rel=1e-6)


# windows


def test_window_holds_a_tail_a_swing_or_a_quarter_more_than_the_touch():
    rows = [(TOUCH, 0.204, 3.0, 1.0), (0.2045, 0.2052, 1.0, 1.0), (0.4, 0.4001, 3.0, 1.0)]
    run = Made(rows)
    found = [SimpleNamespace(kind=kind, time=time) for kind, time in (("full", TOUCH), ("missed", 0.3), ("full", 0.4))]
    ends = window_ends(run, found)
    assert ends[0] == pytest.approx(0.2052 + 1.25 * 0.0052, rel=1e-12)
    assert math.isnan(ends[1])
    assert ends[2] == pytest.approx(0.4001 + 1.5e-3, rel=1e-12)
    assert window_ends(run, found, 0.02)[0] == pytest.approx(0.2252, rel=1e-12)
    swing = 1.0 / uneven(struck={"frame_stiffness": 2e3}).struck.frame_frequency
    soft = Made(rows, machine=uneven(struck={"frame_stiffness": 2e3}))
    assert window_ends(soft, found)[2] == pytest.approx(0.4001 + swing, rel=1e-12)
    near = [found[0], SimpleNamespace(kind="missed", time=0.209), found[2]]
    assert window_ends(run, near)[0] == 0.209
    assert window_ends(Made(rows, end=0.401), found)[2] == 0.401
    lies = Made([(TOUCH, 1.9, 3.0, 1.0)], end=9.0)
    assert window_ends(lies, found[:1])[0] == pytest.approx(1.2, rel=1e-12)
