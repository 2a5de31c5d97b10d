"""The parts of a fast run as they are written: from free flight into a blow and back, what rings, who crowds, why it ends."""

import math

import numpy as np
import pytest

from strikewave.contact import _integrator
from strikewave.contact._chain_kernels import (
    GRAVITY,
    MASS,
    OPEN,
    PLACE,
    PUSHING,
    SLIDING,
    SLIDING_BACK,
    SPEED,
    STICKING,
)
from strikewave.contact._integrator import END, FULL, STOPPED
from strikewave.contact._law_kernels import SPOT
from strikewave.contact.motion import MotionState
from strikewave.machines import _train_kernels as kernels
from strikewave.machines._kernels import (
    CARRIED,
    FEEDING,
    FIRST,
    HALF_FACE,
    LEFT,
    SECOND,
    bend_of,
    face_of,
    larger,
    nose_motion,
    place_bases,
)
from strikewave.machines._layout import FEED_SWITCH, layout_of
from strikewave.machines._pass_kernels import LET_GO, ROWS_USED
from strikewave.machines._train_kernels import (
    AT_EDGE,
    CROWDED,
    DONE,
    LATE,
    QUIET,
    STUCK,
    TOO_MANY,
    Train,
    _keep_spot,
    begin_blow,
    blow_energy,
    crowded,
    end_blow,
    follow_blow,
    rigid_energy,
    ringing,
    run_train,
)
from strikewave.machines.fast_run import controls, empty_passes, train_tables
from strikewave.machines.machine import energy

from .uneven import THETA, TURNING, parts, uneven

pytestmark = pytest.mark.usefixtures("interpreted")
T = 0.7
SHARE, MASS_OF_ALL = 0.14, 0.5
"""Of the nose in the mass of the object, kg."""


def begun(**changes):
    tables, going, struck, circling, at = parts(**changes)
    begin_blow(tables.flight, tables.blow, tables.mounted, going, struck, T)
    return tables, going, struck, circling, at


def test_blow_begins_with_the_striker_that_touches_on_its_circle():
    tables, going, struck, circling, at = parts()
    flight, blow = tables.flight, tables.blow
    let_go = begin_blow(flight, blow, tables.mounted, going, struck, T)
    chain = blow.chain
    assert chain.values[at.contacts.start].tolist() == tables.mounted.laws[2].tolist()
    assert chain.values[at.mounts.start].tolist() == tables.mounted.mounts[2].tolist()
    assert blow.seats[0].tolist() == tables.mounted.seats[2].tolist()
    assert chain.bodies[0, [MASS, CARRIED]].tolist() == [1.3, 1.3]
    mode, memory = struck.mode, struck.memory
    assert mode[[at.contacts.start, at.mounts.start, at.frame]].tolist() == [PUSHING] * 3
    assert mode[at.held_modes].tolist() == going.mode[circling.held_modes].tolist()
    assert mode[at.on_face].tolist() == [1]
    assert memory[at.own_memory].tolist() == [0.51, THETA + 0.3]
    assert (memory[at.depths][0], memory[at.growths][0]) == (3e-5, 1.3)
    assert struck.y[at.turntable].tolist() == [THETA, TURNING, 0.013, 73.0]
    assert struck.y[at.held_energies].tolist() == going.y[circling.held_energies].tolist()
    place, speed, _ = nose_motion(flight, 2, THETA, TURNING)
    place_bases(flight, T, going.y, going.mode, going.memory)
    x, v = struck.y[at.positions], struck.y[at.speeds]
    assert x[:2].tolist() == [place, face_of(flight, going.y, going.mode, going.memory)]
    assert v.tolist() == [speed, 0.9, 0.9]
    # what moves as one body keeps its centre: that of the steady bend under its weight
    centre = -4.7e-3 + SHARE * 0.07 * 9.7 / 9.1e3
    assert SHARE * x[1] + (1.0 - SHARE) * x[2] == pytest.approx(centre, abs=1e-17)
    assert memory[at.contacts.start] == speed - 0.9
    assert let_go == rigid_energy(flight, T, going) - blow_energy(blow, T, struck)
    going.y[circling.speeds] = 40.0
    begin_blow(flight, blow, tables.mounted, going, struck, T)
    assert memory[at.contacts.start] == 0.0


def test_energies_are_those_of_the_bodies():
    """Free flight: one body and the disc with all strikers. A blow: what the machine's own energy says of its system,
    less what the contact, the belt and the motor hold."""
    tables, going, struck, _, at = begun()
    speed, turning = 0.9, TURNING
    centre = -4.7e-3 + SHARE * 0.07 * 9.7 / 9.1e3
    push, stop = -4.7e-3 + 5.5e-3, 4.7e-3 - 5.5e-3 + (390.0 - 0.5 * 9.7) / 2.1e5
    stored = 390.0 * push + 0.5 * 41e3 * push**2 + 0.5 * 2.1e5 * stop**2
    expected = 0.25 * speed**2 - 0.5 * 9.7 * centre + 0.5 * 4.3 * turning**2 + stored
    assert stop > 1e-4
    assert rigid_energy(tables.flight, T, going) == pytest.approx(expected, rel=1e-13)
    y = struck.y
    y[at.positions] += [3e-5, 1e-5, -2e-5]
    y[at.speeds] = 4.0, 5.0, 7.0
    struck.mode[at.contacts.start] = OPEN
    whole = energy(tables.blow, MotionState(T, y, struck.mode, struck.memory))
    held = 0.5 * 2100.0 * 0.013**2 + 0.5 * 0.7 * 73.0**2
    assert blow_energy(tables.blow, T, struck) == pytest.approx(whole - held, abs=1e-10)


@pytest.mark.parametrize("belt", [2100.0, math.inf])
def test_blow_ends_with_the_momentum_and_mean_place_of_its_bodies(belt):
    tables, going, struck, circling, at = begun(disc={"belt_stiffness": belt})
    flight, blow, inertia = tables.flight, tables.blow, 4.3 if belt < math.inf else 5.0
    y, mode = struck.y, struck.mode
    y[at.positions], y[at.speeds] = [-4.1e-3, -4.2e-3, -4.4e-3], [4.0, 5.0, 7.0]
    y[at.turntable] = THETA + 0.01, 69.0, 0.021, 72.0
    y[at.held_energies] += 7.0
    mode[at.held_modes], mode[at.rail] = mode[at.held_modes] + 3, STICKING
    mode[at.rail] = SLIDING_BACK
    struck.memory[at.own_memory] = 0.61, 5.1
    struck.memory[at.depths][0], struck.memory[at.growths][0] = 4e-5, 1.6
    place_bases(blow, T, y, mode, struck.memory)
    first, before = blow.chain.bases[FIRST, 0], blow_energy(blow, T, struck)
    momentum = (inertia - 1.3 * first**2) * 69.0 + 1.3 * first * 4.0
    let_go = end_blow(flight, blow, tables.mounted, going, struck, T)
    z = going.y
    mean = SHARE * -4.2e-3 + (1.0 - SHARE) * -4.4e-3 - SHARE * 0.07 * 9.7 / 9.1e3
    assert z[circling.positions][0] == pytest.approx(mean, rel=1e-14)
    assert z[circling.speeds][0] == pytest.approx(SHARE * 5.0 + (1.0 - SHARE) * 7.0, rel=1e-15)
    assert z[circling.turntable_speed] == pytest.approx(momentum / inertia, rel=1e-14)
    assert (z[circling.angle], z[circling.belt_twist]) == (THETA + 0.01, 0.021)
    assert z[circling.motor_speed] == (72.0 if belt < math.inf else z[circling.turntable_speed])
    assert z[circling.held_energies].tolist() == y[at.held_energies].tolist()
    assert going.memory[circling.own_memory].tolist() == [0.61, 5.1]
    assert let_go == before - rigid_energy(flight, T, going)
    across = [abs(nose_motion(flight, j, z[circling.angle], TURNING)[2]) for j in range(3)]
    assert going.mode[circling.on_face].tolist() == [int(a <= 0.08) for a in across] == [1, 0, 1]
    # each of the noses that shares the spot has its depth
    assert tables.mounted.deepest.tolist() == [4e-5] * 3
    assert flight.seats[:, LEFT] == pytest.approx(4e-5 * (1.0 - 1.0 / 1.6), rel=1e-15)


@pytest.mark.parametrize(
    ("rail", "speed", "mode", "left"),
    [
        (STICKING, 3.0, STICKING, 0.0),
        (SLIDING, 3.0, SLIDING, 3.0),
        (SLIDING, -3.0, SLIDING_BACK, -3.0),
        (SLIDING_BACK, 5e-3, SLIDING, 5e-3),
    ],
)
def test_rail_goes_on_as_the_object_slips_on_the_carriage(rail, speed, mode, left):
    tables, going, struck, circling, at = begun()
    struck.mode[at.rail] = rail
    struck.y[at.speeds] = 4.0, speed, speed
    end_blow(tables.flight, tables.blow, tables.mounted, going, struck, T)
    assert going.mode[circling.rail] == mode
    assert going.y[circling.speeds][0] == pytest.approx(left, rel=1e-15)


def test_rail_slides_either_way_on_the_carriage_that_moves():
    """The carriage comes in with 1 m/s: what goes out slower than that slips on it the other way."""
    for speed, mode in ((-1.5, SLIDING_BACK), (-0.5, SLIDING)):
        tables, going, struck, circling, at = begun()
        struck.mode[at.feed] = FEEDING
        struck.memory[at.feed_start] = T - 0.015
        struck.mode[at.rail] = SLIDING
        struck.y[at.speeds] = 4.0, speed, speed
        end_blow(tables.flight, tables.blow, tables.mounted, going, struck, T)
        carried = tables.flight.chain.bases[SPEED, 0]
        assert -1.2 < carried < -0.9
        assert going.mode[circling.rail] == mode
        struck.mode[at.rail] = STICKING
        end_blow(tables.flight, tables.blow, tables.mounted, going, struck, T)
        assert going.y[circling.speeds][0] == carried


def test_object_without_a_rail_goes_on_as_it_is():
    tables, going, struck, circling, at = begun(struck={"friction": 0.0, "stiction": None})
    struck.y[at.speeds] = 4.0, -3.0, -3.0
    end_blow(tables.flight, tables.blow, tables.mounted, going, struck, T)
    assert going.y[circling.speeds][0] == pytest.approx(-3.0, rel=1e-15)


@pytest.mark.parametrize(("spots", "expected"), [((5e-3, 2.0, 5e-3), [9, 2, 9]), ((0.0, 0.0, 0.0), [1, 2, 9])])
def test_depth_is_kept_for_all_that_share_a_spot(spots, expected):
    tables, *_ = parts()
    mounted = tables.mounted
    mounted.laws[:, SPOT] = spots
    mounted.deepest[:], mounted.growth[:] = [1e-5, 2e-5, 3e-5], 1.5
    _keep_spot(mounted, tables.flight.seats, 2, 9e-5, 1.8)
    assert mounted.deepest == pytest.approx(np.array(expected) * 1e-5, rel=1e-14)
    assert mounted.growth.tolist() == [1.8 if k == 9 else 1.5 for k in expected]


def test_ringing_is_the_energy_about_the_steady_bend_and_circle():
    """The parts swing about the bend with which the frame carries its nose, and the steady circle: spring and speed."""
    tables, _, struck, _, at = begun()
    flight, blow, y = tables.flight, tables.blow, struck.y
    y[at.positions][2], y[at.speeds] = -4.7e-3, [4.0, 5.0, 7.0]
    place_bases(blow, T, y, struck.mode, struck.memory)
    push = 390.0 + 41e3 * (-4.7e-3 + 5.5e-3) + 23.0 * 7.0
    d = 4.7e-3 - 5.5e-3 + (390.0 - 0.5 * 9.7) / 2.1e5
    ratio = uneven().struck.stop_damping
    stop = 2.1e5 * d + ratio * -7.0
    struck.mode[at.stop] = PUSHING
    carried = bend_of(flight.settings, (stop - push) / MASS_OF_ALL + 9.7)
    bend, off = 3e-6, 5e-6
    y[at.positions][1] = -4.7e-3 + carried + bend
    circle = larger(TURNING, 1.3 / 5e6)
    rides = blow.chain.bases[PLACE, 0] - (circle - 1.0) * blow.chain.bases[SECOND, 0]
    y[at.positions][0] = rides + off
    reduced = 0.07 * 0.43 / 0.5
    of_frame = 0.5 * 9.1e3 * bend**2 + 0.5 * reduced * 2.0**2
    swings = 4.0 - circle * blow.chain.bases[SPEED, 0]
    of_striker = 0.5 * 5e6 * off**2 + 0.5 * 1.3 * swings**2
    found, apart = ringing(flight, blow, struck, T)
    assert found == pytest.approx(of_frame, rel=1e-9)
    swing = math.sqrt(2.0 * of_frame / 9.1e3) + math.sqrt(2.0 * of_striker / 5e6)
    left = 3e-5 * (1.0 - 1.0 / 1.3)
    assert apart == pytest.approx(y[at.positions][1] - (rides + off) + left - swing, abs=1e-15)
    y[at.positions][0] = rides - off  # the farther of both counts
    assert ringing(flight, blow, struck, T)[1] == pytest.approx(y[at.positions][1] - rides + left - swing, abs=1e-15)
    struck.mode[at.on_face] = 0
    assert ringing(flight, blow, struck, T) == (found, math.inf)


@pytest.mark.parametrize(("deep", "half", "found"), [(1e-6, 0.08, True), (-1e-6, 0.08, False), (1e-6, 0.001, False)])
def test_another_striker_behind_the_face_crowds(deep, half, found):
    """The first one is before the face, far across; how deep its nose may be is what its spot has left."""
    tables, _, struck, _, at = begun()
    flight, y = tables.flight, struck.y
    flight.settings[HALF_FACE] = half
    place = nose_motion(flight, 0, y[at.angle], y[at.turntable_speed])[0]
    y[at.positions][at.nose] = place - flight.seats[0, LEFT] - deep
    assert crowded(flight, tables.blow, struck, 2) == found


def test_striker_whose_blow_it_is_crowds_nobody():
    tables, _, struck, _, at = begun()
    struck.y[at.positions][at.nose] = struck.y[at.positions][0] - 1e-4
    assert crowded(tables.flight, tables.blow, struck, 0)
    assert not crowded(tables.flight, tables.blow, struck, 2)


# how a blow and a run end, with an integrator that says what it is told


class Told:
    """Stands for the integrator: each call takes the next line, and does what it says to the part."""

    def __init__(self, *lines):
        self.lines, self.calls = list(lines), []

    def __call__(self, system, control, t, h, y, mode, memory, record, count):
        why, *change = self.lines.pop(0)
        self.calls.append((control, t, h, count))
        for one in change:
            one(y, mode, memory, record)
        return why, t + 0.01, 0.5 * h, 0, 1


def driven(monkeypatch, *lines, **train):
    """Return what `run_train` says when the integrator is told so, and with which control and first step it was asked."""
    tables, going, struck, circling, at = parts(9.1e7)
    told = Told(*lines)
    monkeypatch.setattr(kernels, "advance", told)
    passes = empty_passes(train.pop("rows", 4))
    settings = {"share": 1e-2, "energy": 10.0, "most": 0, "repeats": 0.0, "least": 0} | train
    both = controls(uneven(), 1e-6, tables)
    monkeypatch.setattr(kernels, "note_blow", lambda *_: None)
    monkeypatch.setattr(kernels, "measure_row", lambda *_: None)
    return run_train(tables, going, struck, both, Train(**settings), passes), told, passes, both, (circling, at)


LAYOUT = layout_of(train_tables(uneven())[0].flight)
OF_BLOW = layout_of(train_tables(uneven())[0].blow)


def touches(y, mode, memory, record):
    mode[LAYOUT.touching] = 2
    record.event[0, 0] = LAYOUT.own_switches.start + LAYOUT.touches.start + 2


def opens(y, mode, memory, record):
    """The contact is over, and nothing rings: the nose far from the circle, the frame at its steady bend."""
    mode[OF_BLOW.contacts] = OPEN
    mode[OF_BLOW.support] = mode[OF_BLOW.stop] = OPEN
    y[OF_BLOW.positions][1] = y[OF_BLOW.positions][2] = 2e-3
    y[OF_BLOW.speeds][1:] = -1.0


def event(own):
    def change(y, mode, memory, record):
        record.event[0, 0] = LAYOUT.own_switches.start + own

    return change


def passed(count):
    def change(y, mode, memory, record):
        record.event[0, 0] = LAYOUT.own_switches.start + 3
        mode[LAYOUT.passes] = count
        y[LAYOUT.angle] = count * 2.0 * math.pi / 3.0

    return change


def edge(layout):
    def change(y, mode, memory, record):
        mode[layout.edge] = 1

    return change


@pytest.mark.parametrize(
    ("lines", "why"),
    [
        ([(_integrator.STUCK,)], STUCK),
        ([(END,)], LATE),
        ([(FULL,), (FULL,), (END,)], LATE),
        ([(STOPPED, edge(LAYOUT))], AT_EDGE),
        ([(STOPPED, event(FEED_SWITCH))], DONE),
        ([(STOPPED, passed(1)), (STOPPED, event(FEED_SWITCH))], DONE),
        ([(STOPPED, touches), (_integrator.STUCK,)], STUCK),
        ([(STOPPED, touches), (END,)], LATE),
        ([(STOPPED, touches), (STOPPED, edge(OF_BLOW))], AT_EDGE),
        ([(STOPPED, touches), (STOPPED,)], DONE),
        ([(STOPPED, touches), (FULL, opens), (END,)], LATE),
        ([(STOPPED, touches), (FULL,), (FULL, opens), (END,)], LATE),
    ],
)
def test_run_ends_as_the_integrator_says(monkeypatch, lines, why):
    (found, t), told, *_ = driven(monkeypatch, *lines)
    assert found == why
    assert t == pytest.approx(0.01 * len(lines))
    assert not told.lines


def test_blow_is_followed_with_its_own_control_and_the_flight_goes_on_with_a_first_step(monkeypatch):
    _, told, passes, (flight, blow), _ = driven(
        monkeypatch, (FULL,), (STOPPED, touches), (FULL,), (FULL, opens), (END,)
    )
    assert [call[0] for call in told.calls] == [flight, flight, blow, blow, flight]
    steps = [call[2] for call in told.calls]
    first, own = flight.first_step, blow.first_step
    assert steps == [first, 0.5 * first, own, 0.5 * own, first]
    assert [call[1] for call in told.calls] == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04])
    assert [call[3] for call in told.calls] == [LAYOUT.switches] * 2 + [OF_BLOW.switches] * 2 + [LAYOUT.switches]
    assert passes.counts[ROWS_USED] == 1


def test_run_ends_with_its_last_pass_or_with_the_table(monkeypatch):
    lines = [(STOPPED, passed(k)) for k in (1, 2, 3)]
    (why, t), *_ = driven(monkeypatch, *lines, most=2)
    assert (why, t) == (DONE, pytest.approx(0.02))
    (why, t), _, passes, *_ = driven(monkeypatch, *lines, rows=2)
    assert (why, t) == (TOO_MANY, pytest.approx(0.03))
    assert passes.counts[ROWS_USED] == 2
    (why, t), *_ = driven(monkeypatch, (STOPPED, passed(1)), (STOPPED, passed(2), touches), rows=1)
    assert (why, t) == (TOO_MANY, pytest.approx(0.02))


@pytest.mark.parametrize(("least", "ends"), [(0, 2), (1, 2), (2, 3), (3, 4)])
def test_repeats_are_looked_for_once_a_pass_after_the_least(monkeypatch, least, ends):
    """Only a new row is looked at, of those before the last one, which may go on."""
    looked = []

    def found(table, rows, tolerance, strikers):
        looked.append((rows, tolerance, strikers))
        return rows >= 1

    monkeypatch.setattr(kernels, "repeats", found)
    lines = [(STOPPED, passed(k)) for k in (1, 2, 2, 3, 4, 5)]
    (why, t), *_ = driven(monkeypatch, *lines, repeats=1e-3, least=least, rows=9)
    assert why == DONE
    calls = {2: 2, 3: 4, 4: 5}[ends]
    assert t == pytest.approx(0.01 * calls)
    assert looked == [(rows - 1, 1e-3, 3) for rows in range(least + 1, ends + 1)]


def test_energy_that_a_blow_lets_go_is_booked_as_it_begins_and_as_it_ends(monkeypatch):
    """A blow in which nothing happens lets go what it has more as one body before than after."""
    for first in (0, 2):
        tables, going, struck, circling, _ = parts(9.1e3)
        going.mode[circling.touching] = first
        passes, both = empty_passes(3), controls(uneven(), 1e-6, tables)
        before = rigid_energy(tables.flight, T, going)
        monkeypatch.setattr(kernels, "advance", Told((STOPPED,)))
        monkeypatch.setattr(kernels, "note_blow", lambda *_: None)
        monkeypatch.setattr(kernels, "measure_row", lambda *_: None)
        passes.numbers[LET_GO] = 3.0
        train = Train(1e-2, 10.0, 0, 0.0, 0)
        why, _ = follow_blow(tables, going, struck, both[1], train, passes, T, np.empty(struck.y.size))
        assert why == DONE
        lost = before - rigid_energy(tables.flight, T + 0.01, going)
        assert abs(lost) > 0.02
        assert passes.numbers[LET_GO] == pytest.approx(3.0 + lost, abs=1e-9)


def test_first_striker_touches_as_any_other(monkeypatch):
    def first(y, mode, memory, record):
        touches(y, mode, memory, record)
        mode[LAYOUT.touching] = 0

    (why, t), *_ = driven(monkeypatch, (STOPPED, first), (STOPPED,))
    assert (why, t) == (DONE, pytest.approx(0.02))


def test_blow_that_another_striker_crowds_ends_so(monkeypatch):
    def far(y, mode, memory, record):
        y[OF_BLOW.positions][OF_BLOW.nose] = -0.5

    (why, _), *_ = driven(monkeypatch, (STOPPED, touches), (FULL, far))
    assert why == CROWDED


@pytest.mark.parametrize(("share", "quiet"), [(0.99, False), (1.01, True)])
def test_blow_is_over_below_a_share_of_the_energy(monkeypatch, share, quiet):
    """With the frame straight at rest as one body the nose's speed of 2 m/s over the assembly's rings: 0.5 m 2^2."""
    tables, going, struck, _, _ = parts()
    ring = 0.5 * 0.07 * 0.43 / 0.5 * 4.0

    def swings(y, mode, memory, record):
        opens(y, mode, memory, record)
        y[OF_BLOW.speeds][1:] = -1.0, -3.0

    # without what holds it the object falls freely: its frame bends by nothing
    told = Told((FULL, swings), (END,))
    monkeypatch.setattr(kernels, "advance", told)
    monkeypatch.setattr(kernels, "note_blow", lambda *_: None)
    monkeypatch.setattr(kernels, "measure_row", lambda *_: None)
    both = controls(uneven(), 1e-6, tables)
    train = Train(1e-2, 100.0 * share * ring, 0, 0.0, 0)
    spring = tables.blow.chain.values[OF_BLOW.support]
    spring[:] = 0.0
    why, _ = follow_blow(tables, going, struck, both[1], train, empty_passes(3), T, np.empty(struck.y.size))
    assert why == (QUIET if quiet else LATE)


def test_body_of_a_flight_has_the_mass_and_gravity_of_the_object():
    tables, *_ = parts()
    assert tables.flight.chain.bodies[0, [MASS, GRAVITY]].tolist() == [0.5, 9.7]
