"""What a run answers, from spans whose motion is made up: columns, impulses, phases, what was followed, what is missing."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.errors import IntegrationError
from strikewave.contact import Contact
from strikewave.contact._chain_kernels import OPEN, PUSHING
from strikewave.contact.law import elastic_indentation
from strikewave.contact.motion import MotionState
from strikewave.machines import _stack_kernels as column
from strikewave.machines import run as machine_runs
from strikewave.machines import spans as follow
from strikewave.machines import spans as of_spans
from strikewave.machines._kernels import HELD, RETRACTING
from strikewave.machines._layout import APEX_SWITCH, FEED_SWITCH, layout_of
from strikewave.machines.drive import braking_time, spin_up_time
from strikewave.machines.launch import linear_shaper
from strikewave.machines.machine import Arm, Launch, Machine, Striker, Strikers, energy, machine_system, start_state
from strikewave.machines.run import MachineRun, run_machine
from strikewave.machines.spans import (
    ChainSpan,
    Impulses,
    Moments,
    Rebounds,
    StackSpan,
    TapHistories,
    blow_numbers,
    end_at_touch,
    is_flight,
    top_of_flight,
)

from .uneven import OBJECT, uneven

pytestmark = pytest.mark.usefixtures("interpreted")
STEP = 1e-6


def stack_span(begin=0.2, rows=11, touches=((0.2, 0.205, 3.0),), striker=1):
    """Return a span whose columns are straight lines, each of a slope of its own."""
    t = STEP * np.arange(rows)
    history = np.column_stack([10.0 * k + 1e6 * (k + 1) * t for k in range(column.COLUMNS)])
    lines = np.column_stack([100.0 + 1e6 * t, 200.0 + 2e6 * t])
    return StackSpan(
        struck=OBJECT,
        begin=begin,
        step=STEP,
        striker=striker,
        history=history,
        taps=TapHistories(lines, lines + 1.0, lines + 2.0),
        rigid_acceleration=500.0 + 3e6 * t,
        field_position=np.array([0.0, 0.1]),
        field_step=2 * STEP,
        field_force=np.arange(12.0).reshape(6, 2),
        frame=(0.4, 9.7),
        touches=np.array(touches),
        switched=np.array([[APEX_SWITCH, 0.203]]),
        momentum_error=0.0,
        yielded=7e-6,
        rubbed=0.3,
    )


def line(which, t):
    return 10.0 * which + 1e6 * (which + 1) * t


def test_span_of_a_stack_answers_between_its_samples():
    span, since = stack_span(), 2.25e-6
    assert span.end == pytest.approx(0.20001, rel=1e-15)
    moments = span.sample(np.array([0.2 + since, 0.2]))
    at = {name: line(getattr(column, name), since) for name in ("CONTACT_FORCE", "FACE_PLACE", "ASSEMBLY_PLACE")}
    assert moments.contact_force[0] == pytest.approx(at["CONTACT_FORCE"], rel=1e-9)
    assert moments.face_place[0] == pytest.approx(at["FACE_PLACE"], rel=1e-9)
    assert moments.assembly_place[0] == pytest.approx(at["ASSEMBLY_PLACE"], rel=1e-9)
    assert moments.rigid_acceleration[0] == pytest.approx(500.0 + 3e6 * since, rel=1e-9)
    nose, assembly = line(column.NOSE_SPEED, since), line(column.ASSEMBLY_SPEED, since)
    assert moments.assembly_speed[0] == pytest.approx(assembly, rel=1e-9)
    assert moments.object_speed[0] == pytest.approx((0.07 * nose + 0.43 * assembly) / 0.5, rel=1e-9)
    others = {"turntable_angle": "TURNTABLE_ANGLE", "turntable_speed": "TURNTABLE_SPEED"}
    others |= {"indentation": "INDENTATION", "side_force": "SIDE_FORCE"}
    for name, which in others.items():
        assert getattr(moments, name)[0] == pytest.approx(line(getattr(column, which), since), rel=1e-9)
    assert moments.friction_heat[0] == pytest.approx(0.3 + line(column.FRICTION_HEAT, since), rel=1e-9)
    assert [m[1] for m in moments][:2] == [line(column.CONTACT_FORCE, 0.0), 500.0]


def test_span_of_a_stack_gives_its_impulses_with_gravity_and_parts_at_its_faces():
    span = stack_span()
    got = span.impulses(0.200002, 0.200005)
    assert got.contact == pytest.approx(1e6 * (column.CONTACT_IMPULSE + 1) * 3e-6, rel=1e-6)
    weight = 0.5 * 9.7 * 3e-6
    assert got.support == pytest.approx(weight - 1e6 * (column.END_IMPULSE + 1) * 3e-6, rel=1e-6)
    assert got.side == pytest.approx(1e6 * (column.SIDE_IMPULSE + 1) * 3e-6, rel=1e-6)
    whole = span.impulses(-1.0, 9.0)  # no farther than the span
    assert whole.contact == pytest.approx(1e6 * (column.CONTACT_IMPULSE + 1) * 1e-5, rel=1e-9)
    assert whole.support - (weight - 1e6 * (column.END_IMPULSE + 1) * 1e-5) == pytest.approx(weight * 7 / 3, rel=1e-6)
    parting = line(column.FACE_SPEED, 3e-6) - line(column.STRIKER_SPEED, 3e-6)
    assert span.parting_speed(0.200003, 0) == pytest.approx(parting, rel=1e-6)
    assert span.contacts().tolist() == [[0.2, 0.205, 3.0, 1.0]]
    assert span.switches().tolist() == [[APEX_SWITCH, 0.203]]
    assert span.deepest(0.1, 0) == 7e-6
    force, speed, acceleration = span.tap(1)
    assert force[3] == pytest.approx(206.0)
    assert speed[3] == pytest.approx(207.0 + 0.4 + 9.7 * 3e-6, rel=1e-12)
    assert acceleration[3] == pytest.approx(208.0 + 9.7)
    times, forces = span.field()
    assert times == pytest.approx([0.0, 2e-6, 4e-6, 6e-6, 8e-6, 1e-5])
    assert forces.shape == (6, 2)


class Motion:
    """Stands for the motion of a machine: states and forces are lines in time, each of a slope of its own."""

    def __init__(self, system, begin=0.0, end=1.0, switched=((), ()), memory=None):
        at = layout_of(system)
        self.at, self.begin, self.links = at, begin, at.rail + 1 + 3
        self.end = MotionState(end, np.zeros(at.states), np.zeros(at.modes, dtype=np.int64), np.full(at.memories, 9e-5))
        self.switched = tuple(np.array(part) for part in switched)
        memories = np.arange(3.0 * at.memories).reshape(3, -1)
        self.changes = SimpleNamespace(time=np.array([0.0, 0.3, 0.6]), memory=memories)

    def sample(self, times):
        states = np.array([[k + (k + 1) * t for k in range(self.at.states)] for t in times])
        return states, np.array([[100.0 * k + (k + 2) * t for k in range(self.links)] for t in times])

    def impulses(self, low, high):
        return (high - low) * np.arange(1.0, self.links + 1)


def chain_span(**motion):
    system = machine_system(uneven())
    return ChainSpan(OBJECT, layout_of(system), Motion(system, **motion))


def test_span_of_bodies_answers_by_its_states_and_forces():
    span, t = chain_span(), 0.25
    at = span.layout
    (moments,) = [Moments(*(part[0] for part in span.sample(np.array([t]))))]
    y = np.array([k + (k + 1) * t for k in range(at.states)])
    force = np.array([100.0 * k + (k + 2) * t for k in range(13)])
    assert moments.contact_force == pytest.approx(force[:3].sum())
    # frame and stop push, spring and rail hold back: links 6 to 9
    assert moments.rigid_acceleration == pytest.approx((force[6] + force[8] - force[7] - force[9]) / 0.43 + 9.7)
    assert (moments.face_place, moments.assembly_place) == pytest.approx((y[3], y[4]))
    assert moments.assembly_speed == pytest.approx(y[9])
    assert moments.object_speed == pytest.approx((0.07 * y[8] + 0.43 * y[9]) / 0.5)
    assert (moments.turntable_angle, moments.turntable_speed) == pytest.approx((y[10], y[11]))
    assert moments.side_force == pytest.approx(force[10:].sum())
    assert moments.friction_heat == pytest.approx(y[at.rubbed])
    assert moments.indentation == pytest.approx(y[2] - y[3])
    assert span.parting_speed(t, 1) == pytest.approx(y[8] - y[6])
    assert (span.begin, span.end) == (0.0, 1.0)
    smooth = ChainSpan(OBJECT, at._replace(rubs=False), span.motion)
    assert smooth.sample(np.array([t])).rigid_acceleration[0] == pytest.approx(
        (force[6] + force[8] - force[7]) / 0.43 + 9.7
    )


def test_deepest_of_the_strikers_that_push_is_the_indentation():
    span = chain_span()
    x = np.zeros((2, 10))
    x[:, :4] = [[3e-5, 9e-5, 5e-5, 1e-5], [3e-5, 9e-5, 5e-5, 1e-5]]
    forces = np.array([[1.0, 0.0, 2.0], [0.0, 5.0, 2.0]])
    assert span._indentation(x, forces) == pytest.approx([4e-5, 8e-5])


def test_many_times_are_sampled_in_parts(monkeypatch):
    span, times = chain_span(), np.linspace(0.0, 1.0, 23)
    whole = span.sample(times)
    monkeypatch.setattr(of_spans, "_TIMES_AT_ONCE", 5)
    asked = []
    sample = span.motion.sample
    monkeypatch.setattr(span.motion, "sample", lambda some: asked.append(len(some)) or sample(some))
    parts = span.sample(times)
    assert asked == [5, 5, 5, 5, 3]
    assert np.array_equal(np.array(parts), np.array(whole))


def test_impulses_of_bodies_hold_their_weight():
    span = chain_span()
    got = span.impulses(-0.5, 0.3)
    assert got.contact == pytest.approx(0.3 * (1 + 2 + 3))
    assert got.support == pytest.approx(0.3 * (9 - 8 - 10) + 0.5 * 9.7 * 0.3)
    assert got.side == pytest.approx(0.3 * (11 + 12 + 13))
    assert span.impulses(0.9, 3.0).contact == pytest.approx(0.1 * 6)
    assert span.impulses(1.0, 3.0) == span.impulses(-2.0, 0.0) == Impulses(0.0, 0.0, 0.0)


def test_depth_by_a_time_is_that_of_the_changes_before():
    span = chain_span()
    depths = span.layout.depths
    rows = span.motion.changes.memory
    for time, row in ((0.0, 0), (0.29, 0), (0.3, 1), (0.61, 2), (0.99, 2)):
        assert span.deepest(time, 1) == rows[row][depths][1]
    assert span.deepest(1.0, 1) == 9e-5
    assert span.deepest(-0.1, 1) == 9e-5


def test_contacts_and_switches_of_bodies_are_mark_responses(monkeypatch):
    own = chain_span().layout.own_switches.start
    span = chain_span(switched=((0.1, 0.2, 0.3), (own - 1, own, own + 3)))
    assert span.switches().tolist() == [[0.0, 0.2], [3.0, 0.3]]
    tables = {0: [[0.1, 0.2, 3.0]], 1: [[0.5, 0.6, 4.0], [1.0, 1.0, 5.0]], 2: []}
    monkeypatch.setattr(of_spans, "contacts", lambda motion, link: np.array(tables[link]).reshape(-1, 3))
    assert span.contacts().tolist() == [
        [0.1, 0.2, 3.0, 0.0],
        [0.5, 0.6, 4.0, 1.0],
    ]  # what only ends a span begins the next


# a run of spans


def run_of(*spans, machine=None, phases=(), **others):
    return MachineRun(machine or uneven(), tuple(spans), tuple(phases), 0.0, **others)


def test_run_asks_the_span_at_a_time():
    first, second = stack_span(0.2), stack_span(0.20001, touches=((0.20001, 0.200013, 4.0),), striker=0)
    run = run_of(first, second)
    assert run.end == second.end == pytest.approx(0.20002)
    for time, span in ((0.1, first), (0.2, first), (0.200009, first), (0.20001, second), (0.3, second)):
        assert run.span_at(time) is span
    times = np.array([0.200012, 0.200001, 0.20001])
    force = run.sample(times).contact_force
    assert force == pytest.approx([line(column.CONTACT_FORCE, t) for t in (2e-6, 1e-6, 0.0)], rel=1e-6)
    assert run_of(first).sample(0.200001).contact_force == pytest.approx([line(column.CONTACT_FORCE, 1e-6)], rel=1e-6)
    assert run.contacts()[:, 0].tolist() == [0.2, 0.20001]
    assert run_of(second, first).contacts()[:, 3].tolist() == [1.0, 0.0]
    assert run.switch_times(APEX_SWITCH).tolist() == [0.203, 0.203]
    assert run.switch_times(FEED_SWITCH).tolist() == []
    both = run.impulses(0.200008, 0.200013)
    expected = [a + b for a, b in zip(first.impulses(0.200008, 9.0), second.impulses(0.0, 0.200013), strict=True)]
    assert both == pytest.approx(expected, rel=1e-12)
    assert run.impulses(0.200001, 0.20001) == first.impulses(0.200001, 0.20001)
    assert run.deepest(0.2, 1) == 7e-6


def test_run_knows_when_the_object_was_held():
    run = run_of(stack_span(), phases=(("fed", 0.1), ("retract command", 0.3), ("retract", 0.35)))
    assert (run.held, run.released) == ((0.1, 0.3), 0.35)
    flies = Machine(Strikers((Striker(1.3, 0.0, 0.0, Contact(5e9, 1.2)),), 0.3), OBJECT, Launch(striker_speed=3.0))
    run = run_of(stack_span(), machine=flies)
    assert (run.held, run.released) == ((0.0, run.end), run.end)


def whole_run(monkeypatch, machine, change, switched=((), ()), pieces=1, **options):
    """Run a machine by an integrator that ends as it is told; return the run and what the integrator was asked."""
    asked = []
    system = machine_system(machine)
    at = layout_of(system)

    def integrate(system, state, control, sizes, report=None):
        asked.append((state, control, sizes, report))
        motion = Motion(system, begin=state.time, end=state.time + 0.4, switched=switched)
        end = MotionState(state.time + 0.4, state.y.copy(), state.mode.copy(), state.memory.copy())
        change(at, end, len(asked))
        motion.end = end
        motion.changes = SimpleNamespace(time=np.array([state.time]), memory=state.memory[None])
        return motion

    monkeypatch.setattr(machine_runs, "integrate", integrate)
    monkeypatch.setattr(of_spans, "contacts", lambda motion, link: np.empty((0, 3)))
    return run_machine(machine, **options), asked, system


OWN = layout_of(machine_system(uneven())).own_switches.start
FED = ((0.011, 0.042, 0.3, 0.33), (OWN + FEED_SWITCH,) * 4)
"""Times of the feed's phases: off, there, away, and back at the end."""


def retracted(at, end, _):
    end.mode[at.feed] = RETRACTING
    end.y[at.dissipated][0] += 1.0


def test_run_is_held_to_the_scales_of_one_contact(monkeypatch):
    machine = uneven()
    told = []
    run, asked, system = whole_run(monkeypatch, machine, retracted, FED, tolerance=3e-9, progress=told.append)
    ((start, control, sizes, report),) = asked
    at = layout_of(system)
    approach = machine.nominal_approach
    depth = float(elastic_indentation(machine.strikers.first.contact, 0.07, approach))
    assert start.y.tolist() == start_state(machine, system).y.tolist()
    assert control.tolerance == 3e-9
    assert control.scale[at.positions] == pytest.approx([depth] * 5)
    assert control.scale[at.speeds] == pytest.approx([approach] * 5)
    assert control.scale[[at.angle, at.belt_twist]] == pytest.approx([depth / 0.21] * 2)
    assert control.scale[[at.turntable_speed, at.motor_speed]] == pytest.approx([approach / 0.21] * 2)
    assert control.scale[at.energies] == pytest.approx([0.25 * approach**2] * 14)
    pitch_time = 2.0 * math.pi / 3.0 / 76.0
    expected = 0.011 + 0.031 + 0.0037 + 0.027 + 6 * pitch_time
    assert control.first_step == pytest.approx(2e-3 * depth / approach)
    assert control.largest_step == pytest.approx(0.02 * pitch_time)
    assert control.end == pytest.approx(3.0 * expected)
    assert sizes == (13, at.switches)
    report(0.25 * expected)
    report(2.0 * expected)
    assert told == pytest.approx([0.25, 1.0])
    assert run.machine is machine


def test_phases_follow_the_feed(monkeypatch):
    machine = uneven(drive={"face_width": math.inf})
    run, _, system = whole_run(monkeypatch, machine, retracted, FED)
    disc = machine.drive.turntable
    stops = braking_time(disc, float(start_state(machine, system).y[layout_of(system).turntable_speed]))
    expected = {
        "spin-up": -1.2 - spin_up_time(disc),
        **{"at speed": -1.2, "valve signal": 0.0, "feed": 0.011, "fed": 0.042},
        **{"retract command": 0.3 - 0.0037, "retract": 0.3, "brake": 0.4, "stopped": 0.4 + stops},
    }
    assert dict(run.phases) == pytest.approx(expected, rel=1e-12)
    times = [time for _, time in run.phases]
    assert times == sorted(times)
    rows = np.array([[0.2, 0.201, 3.0, 0.0]])
    monkeypatch.setattr(MachineRun, "contacts", lambda self: rows)
    assert dict(machine_runs._phases(run, 70.0))["blows"] == 0.2


@pytest.mark.parametrize(
    ("name", "lost"), [("frame", -3.0), ("driven", 3.0), ("dragged", -3.0), ("rubbed", -3.0), ("fed", 3.0), ("", 0.0)]
)
def test_energy_that_a_run_misses_is_told_over_what_flowed(monkeypatch, name, lost):
    """The motion stands still: what is booked is missing."""

    def change(at, end, _):
        end.mode[at.feed] = RETRACTING
        end.y[at.driven] += -2.0
        end.y[at.dissipated][0] = -1.0
        end.y[at.dissipated][1] = 4.0
        if name == "frame":
            end.y[at.dissipated][at.frame] += 3.0
        elif name:
            end.y[getattr(at, name)] += 3.0

    machine = uneven(feed={"stroke": 0.0})
    run, *_ = whole_run(monkeypatch, machine, change, FED)
    flowed = (
        abs(-2.0 + (3.0 if name == "driven" else 0.0)) + 5.0 + (3.0 if name in ("frame", "dragged", "rubbed") else 0.0)
    )
    assert run.energy_error == pytest.approx(abs(-2.0 - 3.0 + lost) / flowed, rel=1e-6)


def test_run_that_does_not_come_back_names_its_passes(monkeypatch):
    def stays(at, end, _):
        end.mode[at.feed], end.mode[at.passes] = HELD, 3

    with pytest.raises(IntegrationError, match=r"after 0\.4 s only 3 of 5 passes"):
        whole_run(monkeypatch, uneven(), stays, FED)

    def late(at, end, _):
        retracted(at, end, 1)
        end.mode[at.passes] = 2

    slow = uneven(feed={"stroke_time": 0.01, "blows": 1, "valve_delay": 0.0})
    end = 3.0 * (0.01 + 0.0037 + 0.027 + 2 * 2.0 * math.pi / 3.0 / 76.0)
    assert 0.2 < end < 0.4
    with pytest.raises(IntegrationError, match="only 2 of 1 passes"):
        whole_run(monkeypatch, slow, late, FED)


def test_striker_that_met_the_edge_is_named_with_its_depth(monkeypatch):
    def meets(at, end, _):
        end.mode[at.edge] = 2
        end.y[at.positions] = [0.0, 4e-3, 0.0, 1e-3, 0.0]

    with pytest.raises(IntegrationError, match=r"striker 2 met the edge of the face 3 mm .*160 mm.*5\.5 mm"):
        whole_run(monkeypatch, uneven(), meets, FED)


def flier(**launch):
    return Machine(Strikers((Striker(1.3, 0.0, 0.0, Contact(5e9, 1.2)),), 0.3), OBJECT, Launch(**launch))


def test_launched_run_is_paced_by_its_frame_and_its_energy_by_what_flew(monkeypatch):
    """Steps of 2.5 rad of the frame, or 2 % of the time; what came is counted in what flowed."""
    for follow_for, longest in ((0.5, 2.5 / (2.0 * math.pi * OBJECT.frame_frequency)), (2e-4, 0.02 * 2.1e-4)):
        machine = flier(striker_speed=3.0, object_speed=-2.0, follow=follow_for)

        def loses(at, end, _):
            end.y[at.dissipated][0] += 1.5

        run, asked, system = whole_run(monkeypatch, machine, loses)
        assert asked[0][1].largest_step == pytest.approx(longest, rel=1e-12)
        assert asked[0][1].end == pytest.approx(3.0 * (follow_for + 1e-5), rel=1e-12)
        came = 0.5 * 1.3 * 9.0 + 0.5 * 0.5 * 4.0
        assert run.energy_error == pytest.approx(1.5 / (1.5 + came), rel=1e-6)
        assert run.phases == (("release", -0.0), ("end", 0.4))
        del system
    assert machine_runs.STABLE == 2.5


def test_phases_of_a_launch_begin_with_its_release():
    span = stack_span(0.2)
    machine = flier(striker_speed=3.0, travel=0.7)
    run = run_of(span, machine=machine, ended="rest")
    assert machine_runs._phases(run, 0.0) == (("release", -0.7), ("blows", 0.2), ("rest", run.end), ("end", run.end))


@pytest.mark.parametrize("launch", [{"striker_speed": 3.0}, {"object_speed": -2.0}, {"arm": Arm(2.0, 0.7, 5.0, 11.0)}])
def test_brake_stops_what_was_launched_and_takes_its_energy(launch):
    one = Striker(1.3, 5e6, 11.0, Contact(5e9, 1.2)) if "arm" in launch else Striker(1.3, 0.0, 0.0, Contact(5e9, 1.2))
    machine = Machine(Strikers((one,), 0.3), OBJECT, Launch(**launch))
    system = machine_system(machine)
    at, state = layout_of(system), start_state(machine, system)
    state.y[at.speeds] = 3.0, 5.0, 5.0
    before = energy(system, state)
    stopped, taken = machine_runs._caught(machine.start, system, state)
    stands = {"striker_speed": [0.0, 5.0, 5.0], "object_speed": [3.0, 0.0, 0.0], "arm": [0.0, 5.0, 5.0]}
    assert stopped.y[at.speeds].tolist() == stands[next(iter(launch))]
    assert taken == pytest.approx(before - energy(system, stopped), rel=1e-12)
    kinetic = {
        "striker_speed": 0.65 * 9.0,
        "object_speed": 0.25 * 25.0,
        "arm": 0.65 * 9.0 + 0.5 * (2.0 - 1.3 * 0.49) * 25.0,
    }
    assert taken == pytest.approx(kinetic[next(iter(launch))], rel=1e-6)
    assert stopped.y[at.turntable_speed] == 0.0
    assert state.y[at.speeds].tolist() == [3.0, 5.0, 5.0]


def test_rotary_machine_has_nothing_that_a_brake_catches():
    machine = uneven()
    system = machine_system(machine)
    state = start_state(machine, system)
    stopped, taken = machine_runs._caught(machine.start, system, state)
    assert taken == 0.0
    assert stopped.y.tolist() == state.y.tolist()


# rebounds


def test_touches_within_five_times_a_blow_are_one():
    """A blow of 1 ms: a gap of 4.9 ms belongs to it, of 5.1 ms not; and the next is measured by itself."""
    rows = np.array([[1.0, 1.001], [1.0059, 1.006], [1.05, 1.052], [1.0615, 1.062], [1.2, 1.201]])
    assert blow_numbers(rows).tolist() == [0, 0, 1, 1, 2]
    assert blow_numbers(rows[:0]).tolist() == []
    assert is_flight(1.0, 1.001, 1.00601)
    assert not is_flight(1.0, 1.001, 1.00599)


@pytest.mark.parametrize(
    ("brake", "touch", "approach", "ends"),
    [
        (None, 2.0, 0.0199 * 3.0, "rest"),
        (None, 2.0, 0.0201 * 3.0, ""),
        (None, 1.1505, 0.0, ""),  # of the blow before
        (2, 2.0, 5.0, "brake"),
        (1, 2.0, 5.0, "brake"),
        (3, 2.0, 0.0, ""),
    ],
)
def test_following_ends_at_rest_or_with_the_brake(brake, touch, approach, ends):
    rows = np.array([[1.0, 1.001, 3.0], [1.15, 1.1501, 2.0], [1.1503, 1.1504, 9.0]])
    assert end_at_touch(Rebounds(brake), rows, touch, approach) == ends
    assert end_at_touch(Rebounds(brake), rows[:0], touch, approach) == ""


@pytest.mark.parametrize("released", [0.1, -5.0])
def test_top_of_a_flight_is_where_both_go_as_fast(released, monkeypatch):
    """Parabolas: object 0.9 - 9.81 (t - 0.2), striker 0.1 t; from the release, or the begin of the span."""
    span = chain_span(begin=0.1, end=0.6)
    at = span.layout

    def sample(times):
        states = np.zeros((len(times), at.states))
        states[:, at.speeds.start] = 0.1 * times
        # before 0.1 s they had parted and met already
        states[:, at.speeds.start + 3] = states[:, at.speeds.start + 4] = 0.9 - 9.81 * (times - 0.2)
        return states, np.zeros((len(times), 13))

    monkeypatch.setattr(span.motion, "sample", sample)
    assert top_of_flight(span, released) == pytest.approx((0.9 + 9.81 * 0.2) / 9.91, abs=1e-11)
    asked = []
    monkeypatch.setattr(span.motion, "sample", lambda times: asked.append(times) or sample(times))
    top_of_flight(span, 0.15)
    assert (asked[0][0], asked[0][-1], len(asked[0])) == (0.15, 0.6, follow.FLIGHT_SAMPLES)


# how a launched run goes on from touch to touch


def followed(monkeypatch, machine, ends, rows=(), speeds=3.0, **patches):
    """Follow a launched machine by an integrator whose spans end at given times, at a touch each but the last.

    ``rows`` are the contacts, each told once its span is over. Returns the run, and begin and end asked for each span.
    """
    asked, left = [], list(ends)
    at = layout_of(machine_system(machine))

    def integrate(system, state, control, sizes, report=None):
        asked.append((state.time, control.end))
        time = left.pop(0)
        motion = Motion.__new__(Motion)
        motion.at, motion.begin, motion.links = at, state.time, at.stop + 2
        motion.switched = np.empty(0), np.empty(0, dtype=int)
        motion.changes = SimpleNamespace(time=np.array([state.time]), memory=state.memory[None])
        motion.end = MotionState(time, state.y.copy(), state.mode.copy(), state.memory.copy())
        motion.end.mode[at.contacts] = PUSHING if left else OPEN
        motion.end.memory[at.contacts] = speeds
        motion.end.y[at.speeds] = 5.0, 0.0, 0.0
        return motion

    def contacts(motion, link):
        inside = [row for row in rows if motion.begin <= row[0] < motion.end.time]
        return np.array(inside, dtype=float).reshape(-1, 3)

    monkeypatch.setattr(machine_runs, "integrate", integrate)
    monkeypatch.setattr(of_spans, "contacts", contacts)
    for name, value in patches.items():
        monkeypatch.setattr(machine_runs, name, value)
    return run_machine(machine), asked


ROWS = [(0.1, 0.101, 3.0), (0.3, 0.301, 2.0), (0.5, 0.501, 1.0)]


def bouncing(brake=None, follow=0.9):
    return flier(striker_speed=5.0, follow=follow, rebounds=Rebounds(brake))


def test_brake_takes_the_last_flight_back_to_its_top(monkeypatch):
    """The flight before the third touch is followed again, to its top; what flew there is stopped, and its energy booked."""
    top = {"top_of_flight": lambda span, released: 0.41 if released == 0.301 else math.nan}
    run, asked = followed(monkeypatch, bouncing(2), (0.1, 0.3, 0.5, 0.41, 0.6), ROWS, **top)
    limit = 3.0 * (0.9 + 1e-5)
    assert asked == [(0.0, limit), (0.1, limit), (0.3, limit), (0.3, 0.41)]
    assert (run.ended, run.end, len(run.spans)) == ("brake", 0.41, 3)
    assert run.braked == pytest.approx(0.65 * 25.0, rel=1e-9)
    # it came with 16.25 J, and nothing else flowed: none is missing
    assert run.energy_error < 1e-9
    assert dict(run.phases)["brake"] == 0.41


def test_run_rests_where_it_comes_slowly(monkeypatch):
    run, asked = followed(monkeypatch, bouncing(), (0.1, 0.3, 0.5), ROWS, speeds=0.05)
    assert (run.ended, run.end, len(asked)) == ("rest", 0.3, 2)  # 0.05 m/s are below 2 % of 3 m/s
    assert run.braked == 0.0


def test_run_goes_on_until_its_time_is_over(monkeypatch):
    run, asked = followed(monkeypatch, bouncing(follow=0.35), (0.1, 0.3, 0.5, 0.7), ROWS)
    assert (run.ended, run.end, len(asked)) == ("", 0.5, 3)  # the first touch after it
    run, asked = followed(monkeypatch, bouncing(), (0.1, 0.3, 0.5, 0.7), ROWS)
    assert (run.ended, run.end, len(asked)) == ("", 0.7, 4)  # it came to no touch more
    run, asked = followed(monkeypatch, flier(striker_speed=5.0, follow=0.9), (0.1, 0.3), ROWS)
    assert (run.end, len(asked)) == (0.1, 1)  # without rebounds a touch is no end, and nothing stops there
    run, asked = followed(monkeypatch, bouncing(follow=0.035), (0.1, 0.3, 0.5), ROWS)
    assert len(asked) == 1


def test_blow_on_a_stack_is_followed_by_itself(monkeypatch):
    """The x-t field of the first one alone is kept; a launched machine ends with the blow after its time."""
    told = []

    def strike(layered, struck, system, state, field):
        told.append((state.time, field))
        end = MotionState(state.time + 0.01, state.y.copy(), state.mode.copy(), state.memory.copy())
        end.mode[layout_of(system).contacts] = OPEN
        return stack_span(state.time, 11, striker=0), end

    def struck(follow):
        machine = flier(striker_speed=5.0, follow=follow)
        return Machine(machine.strikers, machine.struck, machine.start, layered=SimpleNamespace())

    run, asked = followed(monkeypatch, struck(0.9), (0.1, 0.3, 0.5), strike=strike)
    assert told == [(0.1, True), (0.3, False)]
    assert [begin for begin, _ in asked] == pytest.approx([0.0, 0.11, 0.31])
    assert [type(span).__name__ for span in run.spans] == ["ChainSpan", "StackSpan"] * 2 + ["ChainSpan"]
    told.clear()
    run, asked = followed(monkeypatch, struck(0.305), (0.1, 0.3, 0.5), strike=strike)
    assert told == [(0.1, True), (0.3, False)]
    assert len(asked) == 2


def test_striker_with_a_damper_strikes_no_stack():
    damped = Striker(1.3, 0.0, 0.0, linear_shaper(1e8, 1.0, 0.5))
    machine = Machine(Strikers((damped,), 0.3), OBJECT, Launch(striker_speed=3.0), layered=SimpleNamespace())
    with pytest.raises(ValueError, match="with hysteresis, not with a damper"):
        run_machine(machine)
