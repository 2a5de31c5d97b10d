"""The rotary machine against an independent scipy model, closed forms, and its own balances."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave import load_case, run_case
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.notices import notices
from strikewave.base.result import balance_notices
from strikewave.machines import blows, run_machine
from strikewave.machines.blows import contact_table
from strikewave.machines.drive import angle_at_valve_signal

TURN = 60 / 730


def run(*changes):
    return run_case(load_case("li-ma-2019", changes))


def independent_blow(machine, speed, slowest, duration=400e-6):
    """Rigid acceleration of one blow by scipy, from first touch, with its own equations.

    Turntable of constant speed, one striker on its mount, nose, frame, assembly, support spring and stop,
    force clipped at zero; the object rests in the strike position.
    """
    s, o = machine.strikers.first, machine.struck
    radius, q = machine.drive.turntable.radius, machine.engagement
    k, n, chi = s.contact.stiffness, s.contact.exponent, s.contact.hysteresis_factor
    # on its mount the striker runs steadily on the circle R / (1 - m w^2 / k)
    circle = radius / (1 - s.mass * speed**2 / s.mount_stiffness)
    angle0 = -math.acos((radius - q) / circle)
    approach = -circle * speed * math.sin(angle0)
    factor_speed = max(approach, slowest)
    compressed = (o.preload - o.mass * o.gravity) / o.stop_stiffness

    def seat(t):
        p = angle0 + speed * t
        return radius * (math.cos(p) - 1), -radius * speed * math.sin(p)

    def forces(t, y):
        xs, xn, xa, vs, vn, va = y
        base, rate = seat(t)
        mount = s.mount_stiffness * (base - xs) + s.mount_damping * (rate - vs)
        d, dd = xs - xn, vs - vn
        touch = max(k * max(d, 0.0) ** n * (1 + chi * dd / factor_speed), 0.0)
        frame = o.frame_stiffness * (xn - xa) + o.frame_damping * (vn - va)
        spring = o.preload + o.spring * (xa + q) + o.damper * va
        gap = compressed - (xa + q)
        stop = max(o.stop_stiffness * gap - o.stop_damping * va, 0.0) if gap > 0 else 0.0
        return mount, touch, frame, spring, stop

    def rates(t, y):
        mount, touch, frame, spring, stop = forces(t, y)
        return [
            *y[3:],
            (mount - touch) / s.mass,
            (touch - frame) / o.nose_mass + o.gravity,
            (frame - spring + stop) / o.assembly_mass + o.gravity,
        ]

    x0 = circle * math.cos(angle0) - radius
    rest = -q + o.nose_mass * o.gravity / o.frame_stiffness
    solved = solve_ivp(
        rates,
        (0, duration),
        [x0, rest, -q, approach, 0, 0],
        method="DOP853",
        rtol=1e-10,
        atol=1e-13,
        max_step=2e-7,
        dense_output=True,
    )
    t = np.linspace(0, duration, 20001)
    acceleration = []
    for time, y in zip(t, solved.sol(t).T, strict=True):
        _, _, frame, spring, stop = forces(time, y)
        acceleration.append((frame - spring + stop) / o.assembly_mass + o.gravity)
    return np.array(acceleration)


@pytest.mark.verify
@settings(max_examples=10)
@given(
    mass=st.floats(0.3, 3.0),
    nose=st.floats(0.04, 0.1),
    total=st.floats(0.3, 1.0),
    frame=st.floats(3e7, 2e8),
    mount=st.floats(5e7, 1e9),
    e=st.floats(0.4, 1.0),
    engagement=st.floats(1e-3, 6e-3),
)
def test_rigid_peak_against_an_independent_scipy_machine(mass, nose, total, frame, mount, e, engagement):
    """Within 0.1 %, for a massive turntable whose one striker leaves the object time to come to rest."""
    nominal = 730 * 2 * math.pi / 60 * math.sqrt((0.4 - engagement) * engagement)
    slowest = 1.1 * nominal  # above every approach speed: both models then use it throughout
    case = load_case(
        "li-ma-2019",
        [
            f"striker.mass={mass}",
            f"object.nose_mass={nose}",
            f"object.mass={total}",
            f"object.frame_stiffness={frame}",
            f"striker.mount_stiffness={mount}",
            f"contact.restitution={e}",
            f"machine.engagement={engagement}",
            "machine.inertia=1e5",
            "machine.torque=1e5",
            f"contact.slowest_approach={slowest}",
            "machine.strikers=1",
            "object.stop_restitution=0.1",
            "feed.blows=2",
        ],
    )
    machine = build_machine(case)
    second = blows(run_machine(machine))[1]
    expected = independent_blow(machine, second.turntable_speed, slowest).max()
    assert second.rigid_peak == pytest.approx(expected, rel=1e-3)


def test_eleven_blows_at_the_striking_period(solution):
    assert [b.kind for b in solution.blows] == ["full"] * 11
    intervals = np.diff([b.time for b in solution.blows])
    # a quarter turn, and a little more as the turntable slows: by 0.35 % at the last blow
    assert intervals[1:] == pytest.approx(TURN / 4, rel=4e-3)
    assert all(b.turntable_speed < 730 * 2 * math.pi / 60 for b in solution.blows)
    assert np.all(np.diff([b.turntable_speed for b in solution.blows]) < 0)


@pytest.mark.parametrize(
    ("change", "interval"), [("machine.strikers=3", TURN / 3), ("machine.speed=500 rpm", 60 / 500 / 4)]
)
def test_interval_follows_strikers_and_speed(change, interval):
    """27.4 ms with three strikers, 30 ms at 500 r/min, both longer by what the turntable has slowed."""
    found = run(change).blows
    intervals = np.diff([b.time for b in found])[1:]
    speeds = np.array([b.turntable_speed for b in found])[1:]
    set_speed = found[0].turntable_speed
    assert np.all(intervals == pytest.approx(interval, rel=5e-3))
    assert np.all(intervals > interval)
    assert intervals == pytest.approx(interval * set_speed / (0.5 * (speeds[1:] + speeds[:-1])), rel=2e-3)


def test_approach_speed_of_an_object_at_rest_is_that_of_the_cam():
    """w sqrt(2 R q - q^2), once the object has come to rest: few strikers leave it the time."""
    case = load_case("li-ma-2019", ["machine.strikers=1", "object.stop_restitution=0.1", "feed.blows=3"])
    machine = build_machine(case)
    found = blows(run_machine(machine))
    radius, q = machine.drive.turntable.radius, machine.engagement
    for blow in found[1:]:
        circle = radius / (1 - machine.strikers.mass * blow.turntable_speed**2 / machine.strikers.first.mount_stiffness)
        nominal = blow.turntable_speed * math.sqrt(circle**2 - (radius - q) ** 2)
        assert blow.approach_speed == pytest.approx(nominal, rel=1e-5)


def test_impulse_is_the_change_of_momentum(solution):
    """Each impulse is a Gauss quadrature of the forces; the momentum comes from the integrated speeds."""
    for blow in solution.blows:
        assert blow.impulse == pytest.approx(solution.masses["object"] * blow.blow_velocity_change, rel=1e-6)
        assert blow.impulse == pytest.approx(blow.contact_impulse + blow.support_impulse, rel=1e-12)
    assert solution.balance["momentum_error"] < 1e-6
    assert solution.balance["energy_error"] < 1e-6


def test_halving_every_tolerance_changes_no_rigid_peak(published, solution):
    finer = run_case(load_case("li-ma-2019", [f"solver.tolerance={published.solver.tolerance.si / 2}"]))
    for a, b in zip(solution.blows, finer.blows, strict=True):
        assert a.rigid_peak == pytest.approx(b.rigid_peak, rel=1e-6)


@pytest.mark.verify
@settings(max_examples=20)
@given(
    speed=st.floats(20.0, 120.0),
    strikers=st.integers(1, 6),
    spring=st.floats(5e3, 2e5),
    preload=st.floats(50.0, 1500.0),
    damper=st.floats(0.0, 200.0),
    stop=st.floats(0.05, 0.95),
    engagement=st.floats(1e-4, 8e-3),
    inertia=st.floats(0.5, 20.0),
    e=st.floats(0.1, 1.0),
)
def test_balances_hold_whatever_the_machine(speed, strikers, spring, preload, damper, stop, engagement, inertia, e):
    solution = run(
        f"machine.speed={speed}",
        f"machine.strikers={strikers}",
        f"object.spring={spring}",
        f"object.preload={preload}",
        f"object.damper={damper}",
        f"object.stop_restitution={stop}",
        f"machine.engagement={engagement}",
        f"machine.inertia={inertia}",
        f"contact.restitution={e}",
        "feed.blows=4",
    )
    assert solution.balance["energy_error"] < 1e-6
    assert solution.balance["momentum_error"] < 1e-6
    times = [b.time for b in solution.blows]
    assert times == sorted(times)


def test_phases_come_in_order(solution):
    names = [name for name, _ in solution.phases]
    assert names == [
        "spin-up", "at speed", "valve signal", "feed", "fed", "blows", "retract command", "retract", "brake", "stopped",
    ]  # fmt: skip
    times = [time for _, time in solution.phases]
    assert times == sorted(times)
    assert dict(solution.phases)["valve signal"] == 0.0


def test_drive_limit_is_a_located_switch():
    """A weak drive on a light turntable runs into its torque limit among the blows, and the balance still closes."""
    solution = run("machine.inertia=0.3 kg m^2", "machine.torque=3 N m", "feed.blows=6")
    assert solution.balance["energy_error"] < 1e-6
    assert solution.blows[-1].turntable_speed < 0.99 * solution.blows[0].turntable_speed


def test_stiff_spring_brings_the_object_back_onto_the_same_striker():
    solution = run("object.spring=80 kN/m", "object.preload=800 N", "feed.blows=3")
    assert {b.kind for b in solution.blows} == {"double"}
    assert "blow-kind" in {n.code for n in solution.warnings}


def test_object_fed_too_late_is_struck_a_glancing_blow():
    """The stroke ends just after a striker has passed: the one before met the face near the end of its way in."""
    kinds = {b.kind for b in run("feed.arrival=0.55", "feed.blows=3").blows}
    assert "glancing" in kinds


def test_missed_blows_are_named():
    """An object that springs back too slowly is not there for the next striker."""
    solution = run("object.spring=1 kN/m", "object.preload=10 N", "object.damper=0 N s/m", "feed.blows=6")
    kinds = [b.kind for b in solution.blows]
    assert "missed" in kinds
    missed = solution.blows[kinds.index("missed")]
    assert missed.contacts == 0
    assert missed.impulse == 0.0
    assert math.isnan(missed.rigid_peak)


def test_slow_retraction_is_reported_as_more_blows_than_wanted():
    solution = run("feed.retract_time=200 ms", "feed.blows=3")
    assert len(solution.blows) > 3
    assert "blow-count" in {n.code for n in solution.warnings}


def test_memory_that_ends_before_the_last_blow_says_so():
    solution = run("recorder.memory=10000", "feed.blows=11")
    (notice,) = [n for n in solution.warnings if n.code == "recorder-memory"]
    assert notice.value == pytest.approx(-0.01 + 10000 / 1e5)
    assert notice.limit > notice.value


def test_no_blow_at_all_breaks_a_limit(published, solution):
    missed = dataclasses.replace(solution.blows[0], kind="missed")
    (notice,) = notices(published, [missed], None)
    assert notice.code == "no-blow"
    assert notice.broken


def test_open_balance_breaks_a_limit():
    found = list(balance_notices({"energy_error": 2e-6, "momentum_error": math.nan}))
    assert {n.code for n in found if n.broken} == {"energy-balance", "momentum-balance"}


@given(arrival=st.floats(0, 1), speed=st.floats(1, 200), strikers=st.integers(1, 20))
def test_feed_arrives_where_it_is_told(published, arrival, speed, strikers):
    feed = build_machine(published).drive.feed
    feed = type(feed)(**{**feed.__dict__, "arrival": arrival})
    pitch = 2 * math.pi / strikers
    start = angle_at_valve_signal(feed, speed, pitch)
    end = (start + speed * (feed.valve_delay + feed.stroke_time)) / pitch
    assert 0 <= start <= pitch
    assert abs((end - arrival) - round(end - arrival)) < 1e-9


def test_peak_of_a_long_pass_is_found_wherever_it_lies():
    """A deep engagement presses for milliseconds: the table's peak is that of the whole train, finely sampled."""
    case = load_case("li-ma-2019", ["machine.engagement=50 mm", "feed.stroke=80 mm", "feed.blows=1"])
    machine = build_machine(case)
    result = run_machine(machine)
    found = blows(result)
    times = np.linspace(0.0, result.end, 400_001)
    moments = result.sample(times)
    assert max(b.peak_force for b in found) == pytest.approx(moments.contact_force.max(), rel=2e-3)
    assert max(b.rigid_peak for b in found) == pytest.approx(moments.rigid_acceleration.max(), rel=2e-3)


def test_each_contact_belongs_to_the_pass_of_its_striker():
    case = load_case("li-ma-2019", ["machine.engagement=50 mm", "feed.stroke=80 mm", "feed.blows=2"])
    machine = build_machine(case)
    table = contact_table(run_machine(machine))
    assert len(table) > 2
    assert np.all(table[:, 4] % machine.strikers.count == table[:, 3])


def test_pulse_without_end_has_no_width_and_says_so(published, solution):
    endless = dataclasses.replace(solution.blows[0], width=math.nan)
    codes = {n.code for n in notices(published, [endless], None)}
    assert "pulse-width" in codes
