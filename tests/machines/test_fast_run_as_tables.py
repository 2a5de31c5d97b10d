"""What a fast run is made of and what it tells: its two systems, its steps, its table of blows, its balance."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.base.errors import IntegrationError
from strikewave.contact._chain_kernels import AHEAD, BEHIND, KIND, MASS
from strikewave.contact._law_kernels import STIFFNESS
from strikewave.contact.law import elastic_indentation
from strikewave.machines import _pass_kernels as column
from strikewave.machines import fast_run
from strikewave.machines import fast_run as fast
from strikewave.machines._kernels import STOP_AT_TOUCH
from strikewave.machines._layout import layout_of
from strikewave.machines.fast_run import controls, empty_passes, fast_train, train_tables, why_not
from strikewave.machines.machine import machine_system, start_state

from .uneven import STRIKERS, uneven

pytestmark = pytest.mark.usefixtures("interpreted")


def test_free_flight_is_one_body_and_a_blow_one_striker():
    machine = uneven()
    tables, going, struck = train_tables(machine)
    whole = machine_system(machine)
    flight, blow, at = tables.flight, tables.blow, layout_of(whole)
    assert flight.chain.bodies.tolist() == [[0.5, 9.7, 0.0]]
    assert flight.chain.joins[:, [BEHIND, AHEAD]].tolist() == [[0, 1], [1, 0], [0, 1]]  # to the carriage
    assert flight.chain.values.tolist() == whole.chain.values[at.support :].tolist()
    assert flight.chain.joins[:, KIND].tolist() == whole.chain.joins[at.support :, KIND].tolist()
    assert flight.chain.bases.shape == (7, 1)
    assert flight.settings[28:].tolist() == [0.07, 9.1e7, 9.7, 0.14]
    assert flight.settings[:28].tolist() == blow.settings.tolist()
    assert blow.settings[STOP_AT_TOUCH] == 0.0
    stretch = [one.mass / one.mount_stiffness for one in STRIKERS]
    assert flight.seats[:, :3].tolist() == whole.seats.tolist()
    assert flight.seats[:, 3].tolist() == stretch
    assert flight.seats[:, 4].tolist() == [0.0] * 3
    assert blow.chain.bodies[:, MASS].tolist() == [0.9, 0.07, 0.43]
    assert blow.chain.bases.shape == (7, 2)
    # striker, nose, assembly; seat, carriage: contact, mount, frame, support, stop, rail
    joins = [[0, 1], [3, 0], [1, 2], [2, 4], [4, 2], [2, 4]]
    assert blow.chain.joins[:, [BEHIND, AHEAD]].tolist() == joins
    kept = [0, 3, 6, 7, 8, 9]
    assert blow.chain.values.tolist() == whole.chain.values[kept].tolist()
    assert blow.seats.tolist() == whole.seats[:1].tolist()
    mounted = tables.mounted
    assert mounted.laws.tolist() == whole.chain.values[:3].tolist()
    assert mounted.mounts[:, STIFFNESS].tolist() == [2e6, 3e6, 5e6]
    assert mounted.masses.tolist() == [0.9, 1.1, 1.3]
    assert (mounted.deepest.tolist(), mounted.growth.tolist()) == ([0.0] * 3, [1.0] * 3)
    start, circling = start_state(machine, whole), layout_of(flight)
    assert going.y[circling.positions].tolist() == [start.y[at.positions][at.assembly]]
    assert going.y[circling.turntable].tolist() == start.y[at.turntable].tolist()
    assert going.mode[circling.held_modes].tolist() == start.mode[at.held_modes].tolist()
    assert going.mode[circling.on_face].tolist() == start.mode[at.on_face].tolist()
    assert going.memory[circling.own_memory].tolist() == start.memory[at.own_memory].tolist()
    assert going.memory[circling.growths].tolist() == struck.memory[layout_of(blow).growths][:3].tolist() == [1.0] * 3
    assert len(going.record.time) == len(struck.record.time) >= 1


def test_steps_are_held_to_the_engagement_in_flight_and_to_a_contact_in_a_blow():
    machine = uneven()
    tables, *_ = train_tables(machine)
    approach, pitch_time = machine.nominal_approach, 2.0 * math.pi / 3.0 / 76.0
    depth = float(elastic_indentation(STRIKERS[0].contact, 0.07, approach))
    end = 3.0 * (0.011 + 0.031 + 0.0037 + 0.027 + 6 * pitch_time)
    flight, blow = controls(machine, 1e-7, tables)
    for control, system, place in ((flight, tables.flight, 5.5e-3), (blow, tables.blow, depth)):
        at = layout_of(system)
        scale = np.zeros(at.states)
        scale[at.positions], scale[at.speeds] = place, approach
        scale[at.turntable] = place / 0.21, approach / 0.21, place / 0.21, approach / 0.21
        assert control.scale == pytest.approx(scale, rel=1e-13)
        assert (control.tolerance, control.end) == (1e-7, pytest.approx(end, rel=1e-13))
    assert (flight.first_step, flight.largest_step) == pytest.approx((5e-3 * pitch_time, 0.1 * pitch_time))
    assert (blow.first_step, blow.largest_step) == pytest.approx((2e-3 * depth / approach, 0.02 * pitch_time))


def test_table_of_passes_begins_empty():
    passes = empty_passes(7)
    assert passes.table.shape == (7, 19)
    assert np.isnan(passes.table).all()
    assert passes.counts.tolist() == [-1] + [0] * 7
    assert passes.numbers.tolist() == [0.0] * 5
    assert (passes.samples.shape, passes.contacts.shape) == ((3, 8192), (64, 4))


# what a run tells


def row(**values):
    out = np.arange(19.0) + 100.0
    for name, value in values.items():
        out[getattr(column, name)] = value
    return out


def rubs(tables, going, *_):
    going.y[layout_of(tables.flight).rubbed] += 1.0


def told(monkeypatch, machine, rows, change=rubs, **options):
    """Return a fast run whose kernel wrote some rows, and what it was asked."""
    asked = []

    def run(tables, going, struck, both, train, passes):
        asked.append((train, passes, both))
        passes.table[: len(rows)] = np.array(rows).reshape(-1, 19)
        passes.counts[[column.ROWS_USED, column.FLIGHT_STEPS, column.BLOW_STEPS]] = len(rows), 11, 13
        return change(tables, going, struck, passes) or fast.kernels.DONE, 0.75

    monkeypatch.setattr(fast.kernels, "run_train", run)
    return fast_train(machine, **options), asked[0]


HIT = {"CONTACTS": 2.0, "APPROACH": 9.0, "IMPULSE": 4.0, "LATER": 0.39, "STRIKER": 1.0}


def test_passes_are_told_by_their_kind(monkeypatch):
    machine = uneven()
    nominal = machine.nominal_approach
    rows = [
        row(**HIT),
        row(**HIT | {"LATER": 0.41}),
        row(**HIT | {"APPROACH": 0.499 * nominal}),
        row(**HIT | {"APPROACH": 0.501 * nominal}),
        row(CONTACTS=0.0, STRIKER=2.0, FACE=-3e-3),
    ]
    run, _ = told(monkeypatch, machine, rows)
    assert run.kinds == ["full", "double", "glancing", "full", "missed"]
    full, double, _, _, missed = run.blows
    assert (full.index, full.kind, full.striker, full.contacts) == (1, "full", 2, 2)
    assert (missed.index, missed.striker, missed.contacts) == (5, 3, 0)
    assert (full.time, full.approach_speed, full.rigid_peak, full.width) == (102.0, 9.0, 104.0, 105.0)
    assert (full.velocity_change, full.face_place, full.face_speed) == (106.0, 110.0, 111.0)
    assert (full.largest_displacement, full.stop_force, full.angle) == (112.0, 113.0, 114.0)
    assert (full.turntable_speed, full.blow_velocity_change, full.contact_impulse) == (115.0, 116.0, 118.0)
    # a double one counts to its last release
    assert (double.blow_velocity_change, double.contact_impulse) == (117.0, 4.0)
    assert (full.impulse, double.impulse) == (0.5 * 116.0, 0.5 * 117.0)
    assert missed.largest_displacement == pytest.approx(2.5e-3, rel=1e-12)
    assert run.column("stop_force").tolist() == [113.0] * 5
    assert (run.end, run.steps) == (0.75, (11, 13))


def test_run_is_asked_for_so_many_passes_or_all(monkeypatch):
    machine = uneven()
    energy = 0.25 * machine.nominal_approach**2
    run, (train, passes, both) = told(monkeypatch, machine, [row(**HIT)], repeats=1e-3, least=4, quiet=0.03)
    assert train == (0.03, pytest.approx(energy, rel=1e-13), 0, 1e-3, 4)
    assert len(passes.table) == 45
    assert both[0].tolerance == 1e-6
    run, (train, passes, both) = told(monkeypatch, machine, [row(**HIT)], blows=9, tolerance=1e-8)
    assert train == (1e-2, pytest.approx(energy, rel=1e-13), 9, 0.0, 0)
    assert len(passes.table) == 49
    assert both[0].tolerance == 1e-8
    assert run.machine is machine
    # the feed does not end it: it holds as long as there are blows
    pitch_time = 2.0 * math.pi / 3.0 / 76.0
    assert both[0].end == pytest.approx(3.0 * (0.011 + 0.031 + 0.0037 + 0.027 + 10 * pitch_time))


@pytest.mark.parametrize("belt", [2100.0, math.inf])
@pytest.mark.parametrize(
    ("name", "lost", "flow"),
    [
        ("", 0.0, 0.0),
        ("driven", 3.0, 3.0),
        ("dragged", -3.0, 3.0),
        ("fed", 3.0, 0.0),
        ("rubbed", -3.0, 3.0),
        ("support", -3.0, 3.0),
        ("contact", -3.0, 3.0),
        ("mount", -3.0, 3.0),
        ("frame", -3.0, 3.0),
        ("let go", -3.0, 3.0),
    ],
)
def test_energy_that_a_fast_run_misses_is_told_over_what_flowed(monkeypatch, belt, name, lost, flow):
    """Nothing moved but the motor on its belt, by 2 rad/s and 1 mrad; what is booked is missing."""
    gained = []

    def change(tables, going, struck, passes):
        at, own = layout_of(tables.flight), layout_of(tables.blow)
        going.y[at.dissipated][at.stop] += 1.0
        if belt < math.inf:
            twist, motor = going.y[at.belt_twist], going.y[at.motor_speed]
            gained.append(0.5 * 2100.0 * ((twist + 1e-3) ** 2 - twist**2) + 0.35 * ((motor + 2.0) ** 2 - motor**2))
            going.y[at.belt_twist] += 1e-3
            going.y[at.motor_speed] += 2.0
        if name in ("driven", "dragged", "fed", "rubbed"):
            going.y[getattr(at, name)] += 3.0
        elif name == "support":
            going.y[at.dissipated][at.support] += 3.0
        elif name == "let go":
            passes.numbers[column.LET_GO] += 3.0
        elif name:
            place = {"contact": own.contacts.start, "mount": own.mounts.start, "frame": own.frame}[name]
            struck.y[own.dissipated][place] += 3.0

    machine = uneven(disc={"belt_stiffness": belt}, feed={"stroke": 0.0})
    run, _ = told(monkeypatch, machine, [row(**HIT)], change)
    missing = abs(sum(gained) + 1.0 - lost)
    assert run.energy_error == pytest.approx(missing / (1.0 + flow), rel=1e-7)
    assert run.let_go == (3.0 if name == "let go" else 0.0)


def test_energy_of_a_rest_begins_where_the_balance_begins(monkeypatch):
    """What the object gains on its way is that of its height and spring at its end."""

    def moves(tables, going, struck, passes):
        going.y[layout_of(tables.flight).speeds] += 4.0
        going.y[layout_of(tables.flight).driven] += 4.0

    run, _ = told(monkeypatch, uneven(feed={"stroke": 0.0}), [row(**HIT)], moves)
    assert run.energy_error < 1e-9  # 0.25 kg m^2/s^2 of 16


@pytest.mark.parametrize("why", sorted(fast.WHY))
def test_run_that_fails_says_why(monkeypatch, why):
    with pytest.raises(IntegrationError, match=fast.WHY[why]):
        told(monkeypatch, uneven(), [], lambda *_: why)


def test_object_counts_as_one_body_to_a_hundredth_of_the_square_of_its_frequency():
    """(k + k_stop)/M over k_frame M/(m_nose m_assembly)."""
    reduced = 0.07 * 0.43 / 0.5
    for share, refused in ((0.99e-2, False), (1.01e-2, True)):
        frame = (41e3 + 2.1e5) / 0.5 * reduced / share
        found = why_not(uneven(struck={"frame_stiffness": frame}))
        assert bool(found) == refused
    assert "0.1 of its frame's frequency: at most 0.1" in found
    assert why_not(dataclasses.replace(uneven(), layered=object())).startswith("the object is a stack")
    with pytest.raises(ValueError, match="no single body"):
        fast_train(uneven(struck={"frame_stiffness": frame}))


def test_what_is_compiled_ahead_is_of_the_smallest_tables(monkeypatch):
    """Nothing of a machine is in them: one row, one column, and zeros."""
    seen = []
    monkeypatch.setattr(fast_run, "_compile", lambda kernel, arguments: seen.append(arguments))
    monkeypatch.setattr(fast_run, "await_kernel", seen.append)
    fast_run.compile_fast_run()

    def flat(value):
        return [one for part in value for one in flat(part)] if isinstance(value, tuple) else [value]

    assert seen.count("_integrator.advance") == 1
    values = [one for arguments in seen if isinstance(arguments, tuple) for one in flat(arguments)]
    numbers = [one for one in values if isinstance(one, float | int)]
    assert set(numbers) == {0}
    arrays = {one.shape for one in values if isinstance(one, np.ndarray)}
    passes = {one.shape for one in empty_passes(1)}
    records = [(1,), (1,), (1, 8, 1), (1, 1), (1, 1), (1,), (1, 2)]
    assert arrays - passes == {*records} - passes
    parts = [part for arguments in seen for part in arguments if type(part).__name__ == "Part"]
    assert len(parts) > 5
    assert all([one.shape for one in part.record] == records for part in parts)
    assert all(one.table.shape[0] == 1 for arguments in seen for one in arguments if type(one).__name__ == "PassTable")
