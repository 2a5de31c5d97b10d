"""Strikers on bars: closed forms of linear laws, what every blow loses, and each touch where the histories show it."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from strikewave.contact import Contact
from strikewave.contact.law import Damper, PressureCap
from strikewave.waves import End, Impactor, Joint, Layer, LoadPulse, Stack, Tap, WantedError, _kernels, run_bar, transit
from strikewave.waves import bar as bar_module
from strikewave.waves.transit import TimeGrid, empty_averages, state_at_rest, tables_of

Z, STEP = 5.0, 2e-3


def bar(transit=3.0, impedance=Z):
    return Layer("bar", 1.0, impedance * impedance, 1.0, transit * impedance)


ENDLESS = Stack((bar(),), (), End("matched"))


def struck(stack, contact, mass=1.5, speed=0.8, duration=2.0, step=STEP):
    return run_bar(stack, Impactor(mass, speed, contact), [Tap(0, 0.0)], duration, WantedError(step=step))


@pytest.mark.parametrize("damping", [0.0, 1.3])
def test_a_linear_contact_on_an_endless_bar_is_a_damped_swing(damping):
    """m u' = -F, d' = u - F/Z, F = k d + c d': with s = 1 + c/Z, s d'' + (k/Z + c/m) d' + (k/m) d = 0, s d'(0) = v0.

    It parts where F falls through zero. Trapezoidal steps: (w dt)^2/12 of each radian, 1e-5 here; what a first step has
    not yet moved and a last one moves too far is a step of what is lost and pressed.
    """
    k, m, v0 = 40.0, 1.5, 0.8
    s = 1.0 + damping / Z
    run = struck(ENDLESS, Contact(k, 1.0, damper=Damper(damping, 0.0, "never-pulls") if damping else None))
    decay = 0.5 * (k / Z + damping / m) / s
    w = math.sqrt(k / m / s - decay**2)
    time = run.time
    d = v0 / s / w * np.exp(-decay * time) * np.sin(w * time)
    rate = v0 / s * np.exp(-decay * time) * (np.cos(w * time) - decay / w * np.sin(w * time))
    force = k * d + damping * rate
    first = int(np.flatnonzero(force < 0.0)[0])
    assert run.face_force[:first] == pytest.approx(force[:first], abs=3e-5 * force.max())
    assert np.all(run.face_force[first + 1 :] == 0.0)
    assert run.deepest == pytest.approx(d.max(), rel=3e-5)
    end = math.pi / w if not damping else run.touches[0, 1]
    assert run.touches == pytest.approx(np.array([[0.0, end, v0]]), abs=2e-5)
    # a damper takes c d'^2, and where it would pull what the spring still holds; to half a step of its first power, 1.4 %
    lost = np.trapezoid(damping * rate[:first] ** 2) * STEP + (0.5 * k * d[first] ** 2 if damping else 0.0)
    assert run.energy_lost == pytest.approx(lost, rel=1.5e-2, abs=1e-6)
    # a force that is there at once acts on the bar for the whole first step, on the striker for half of it
    assert run.impulse == pytest.approx(m * (v0 - run.striker_speed) + 0.5 * STEP * run.face_force[0], rel=1e-12)


LAWS = {
    "spring": Contact(40.0, 1.0),
    "hertz": Contact(60.0, 1.5),
    "lossy": Contact(60.0, 1.5, 0.7),
    "lossy line": Contact(40.0, 10 / 9, 0.3),
    "damper": Contact(60.0, 1.5, damper=Damper(2.0, 0.5, "never-pulls")),
    "approach": Contact(60.0, 1.5, damper=Damper(2.0, 0.5, "on-approach")),
    "yields": Contact(60.0, 1.5, cap=PressureCap(0.3, "point")),
    "yields and loses": Contact(60.0, 1.5, 0.4, cap=PressureCap(0.3, "point")),
    "rigid": None,
}


@pytest.mark.parametrize("name", LAWS)
def test_what_a_striker_no_longer_has_is_in_the_bar_or_lost(name):
    """m (v0^2 - u^2)/2 = sum F v dt + lost, v of the face; better with half the step, and lost only where a law loses."""
    missing = []
    for step in (STEP, STEP / 2):
        run = struck(ENDLESS, LAWS[name], step=step)
        into = np.sum(run.face_force**2) / Z * step
        kinetic = 0.5 * 1.5 * (0.8**2 - run.striker_speed**2)
        if name == "rigid":  # of the first step, in which the bar jumps to the striker's speed, half counts
            into -= 0.5 * run.face_force[0] ** 2 / Z * step
        missing.append(abs(kinetic - into - run.energy_lost) / kinetic)
        assert run.energy_lost > 0.02 * kinetic or name in ("spring", "hertz", "rigid")
        assert run.energy_lost == pytest.approx(0.0, abs=1e-4 * kinetic) or name not in ("spring", "hertz", "rigid")
    assert missing[1] < 5e-4, missing
    assert missing[1] < 0.6 * missing[0] + 1e-6, missing


STIFF = {
    "rigid": None,
    "hertz": Contact(2e4, 1.5),
    "lossy": Contact(2e4, 1.5, 0.5),
    "damper": Contact(2e4, 1.5, damper=Damper(100.0, 0.5, "never-pulls")),
    "yields": Contact(2e4, 1.5, cap=PressureCap(0.3, "point")),
}


@pytest.mark.parametrize("name", STIFF)
def test_touches_are_where_the_force_acts_and_begin_at_the_speed_of_both(name):
    """A heavy striker follows a short bar against a wall: it bounces, and comes again."""
    stack = Stack((bar(0.12),), (), End("spring", 15.0))
    run = struck(stack, STIFF[name], 8.0, 0.8, 4.0)
    step = STEP
    touching = run.face_force > 0.0
    begins = np.flatnonzero(touching & ~np.concatenate([[False], touching[:-1]]))
    ends = np.flatnonzero(~touching & np.concatenate([[False], touching[:-1]]))
    assert len(begins) == len(run.touches) > 1
    assert run.touches[:, 0] == pytest.approx(begins * step, abs=1.01 * step)
    # a damper that would pull lets the force go two steps before the indentation has gone
    assert run.touches[: len(ends), 1] == pytest.approx(ends * step, abs=2.01 * step)
    # the striker's speed by Newton, straight between steps
    u = 0.8 - np.concatenate([[0.0], np.cumsum(0.5 * step * (run.face_force[1:] + run.face_force[:-1]))]) / 8.0
    closing = u - run.velocity[:, 0]
    assert run.touches[0, 2] == 0.8
    for (_, _, approach), row in zip(run.touches[1:], begins[1:], strict=True):
        assert approach == pytest.approx(closing[row - 1], abs=0.02)


def test_a_touch_that_lasts_ends_with_the_run():
    """Of a rigid striker that follows an endless bar it never leaves: to one step behind the last sample."""
    run = struck(ENDLESS, None, duration=1.0)
    assert len(run.touches) == 1
    assert run.touches[0] == pytest.approx([0.0, 1.0 + 2 * STEP, 0.8], abs=1.5 * STEP)


@pytest.mark.parametrize(("chi", "exponent"), [(0.7, 1.5), (0.3, 10 / 9)])
def test_a_lossy_contact_on_an_endless_bar_against_scipy(chi, exponent):
    """F = K d^n (1 + chi d'/v0), d' = u - F/Z, solved for F: second order in the step."""
    stiffness, m, v0 = 60.0, 1.5, 0.8

    def force_at(d, u):
        spring = stiffness * np.maximum(d, 0.0) ** exponent
        return np.maximum(spring * (1.0 + chi * u / v0) / (1.0 + spring * chi / (Z * v0)), 0.0)

    def rates(_, x):
        f = float(force_at(x[0], x[1]))
        return [x[1] - f / Z, -f / m]

    misses = []
    for step in (2 * STEP, STEP):
        run = struck(ENDLESS, Contact(stiffness, exponent, chi), duration=0.7, step=step)
        found = solve_ivp(rates, (0.0, 0.71), [0.0, v0], "DOP853", run.time, rtol=1e-10, atol=1e-13)
        expected = force_at(*found.y)
        misses.append(np.abs(run.face_force - expected).max() / expected.max())
        # of a parabola's top
        assert run.deepest == pytest.approx(found.y[0].max(), rel=1e-4)
    assert misses[1] < 1e-4
    assert misses[0] / misses[1] == pytest.approx(4.0, abs=0.6)


def test_a_striker_slower_than_its_law_knows_loses_as_one_of_that_speed():
    """chi d'/v with v = 0.5 m/s at least: at 0.1 m/s as a law of a fifth of chi."""
    slow = run_bar(
        ENDLESS, Impactor(1.5, 0.1, Contact(60.0, 1.5, 0.7), 0.5), [Tap(0, 0.0)], 1.0, WantedError(step=STEP)
    )
    weak = run_bar(ENDLESS, Impactor(1.5, 0.1, Contact(60.0, 1.5, 0.14)), [Tap(0, 0.0)], 1.0, WantedError(step=STEP))
    assert slow.face_force == pytest.approx(weak.face_force, rel=1e-9, abs=1e-12)


def test_a_striker_feels_the_end_of_its_stack():
    """Impulses on the face and on a wall behind two layers, and the momentum between them; forces on both by nodes."""
    stack = Stack((bar(0.2), bar(0.3, 9.0)), (Joint(200.0),), End("rigid"))
    run = run_bar(stack, Impactor(1.5, 0.8, LAWS["hertz"]), [Tap(0, 0.0), Tap(1, 1.0)], 1.5, WantedError(step=STEP))
    assert run.impulse == pytest.approx(np.sum(run.face_force) * STEP, rel=1e-2)
    assert run.end_impulse == pytest.approx(np.sum(run.end_force) * STEP, rel=1e-2)
    assert run.end_impulse > 0.2 * run.impulse
    assert run.momentum_error < 1e-12
    assert np.array_equal(run.face_force, run.force[:, 0])
    assert np.array_equal(run.end_force, run.force[:, 1])
    assert np.all(run.velocity[:, 1] == pytest.approx(0.0, abs=1e-15))
    # the wall feels the first wave 0.5 s after the blow, through the joint
    assert np.flatnonzero(run.end_force)[0] == pytest.approx(0.5 / STEP, abs=2)
    assert run.field_force[0, 0] == 0.0


def test_norms_under_a_striker_are_those_under_the_force_that_it_gave():
    """Strike a stack, and drive the same one by the force on its face: the same waves, to rounding."""
    stack = Stack((bar(0.2), bar(0.3, 9.0)), (Joint(200.0),), End("dashpot", 3.0))
    grid, steps = TimeGrid(0.01, (20, 30), 0.0), 90
    nodes = np.array([[0, 0], [1, 30], [0, 7]])
    found = []
    load = np.zeros(0)
    for by in ("strike", "drive"):
        seen = _kernels.Recording(nodes, 1, np.zeros((steps, 3)), np.zeros((steps, 3)))
        none = _kernels.Recording(nodes[:0], 1, np.zeros((1, 0)), np.zeros((1, 0)))
        extremes = _kernels.Extremes(nodes, 1, np.zeros(3), np.zeros(3))
        averages, norms = empty_averages(nodes[:1], nodes[1:], 7, 5), np.zeros(6)
        tables, state = tables_of(stack, grid), state_at_rest(stack, grid)
        more = (none, seen), averages, extremes, norms
        if by == "strike":
            row = bar_module._law(Impactor(1.5, 0.8, LAWS["hertz"]))
            striker = _kernels.RigidStriker(row, 1.5, 0.8)
            _, _, entered, through, _, _ = _kernels.strike(tables, state, striker, steps, *more, np.zeros((3, 3)))
            load = seen.force[:, 0].copy()
        else:
            entered, through = _kernels.drive(tables, state, load, _kernels.FORCE, *more)
        found.append(
            [seen.force, seen.velocity, averages.velocity, averages.force, extremes.greatest, norms, entered, through]
        )
    assert norms.min() > 0.0
    for one, other in zip(*found, strict=True):
        assert one == pytest.approx(other, rel=1e-11, abs=1e-11)
    assert extremes.greatest.tolist() == seen.force.max(axis=0).tolist()


def test_touches_beyond_those_that_are_kept_change_nothing(monkeypatch):
    """Of five or so the first two: while one lasts at the end of the run, and after it."""
    stack = Stack((bar(0.12),), (), End("spring", 15.0))
    for duration in (1.9, 4.0):
        monkeypatch.setattr(bar_module, "_MOST_TOUCHES", 1000)
        whole = struck(stack, STIFF["hertz"], 8.0, 0.8, duration)
        assert len(whole.touches) > 3
        monkeypatch.setattr(bar_module, "_MOST_TOUCHES", 2)
        few = struck(stack, STIFF["hertz"], 8.0, 0.8, duration)
        assert np.array_equal(few.touches, whole.touches[:2])
        assert np.array_equal(few.face_force, whole.face_force)
        monkeypatch.setattr(bar_module, "_MOST_TOUCHES", len(whole.touches))
        assert np.array_equal(struck(stack, STIFF["hertz"], 8.0, 0.8, duration).touches, whole.touches)
    assert len(whole.touches) == bar_module._MOST_TOUCHES


def test_events_beyond_those_that_are_kept_change_nothing(monkeypatch):
    """A middle bar bounces between two: its joints open and close four times."""
    stack = Stack((bar(0.2), bar(0.1), bar(0.3, 9.0)), (Joint(unilateral=True), Joint(unilateral=True)), End("rigid"))
    load = LoadPulse("half-sine", 5.0, 0.15)
    whole = run_bar(stack, load, [Tap(1, 0.0), Tap(2, 0.0)], 6.0, WantedError(step=0.01))
    assert len(whole.events) > 3
    assert np.all(np.diff(whole.events[:, 1]) >= 0.0)
    for k in (0, 1):  # each joint opens, closes, opens, ..
        states = whole.events[whole.events[:, 0] == k, 2]
        assert states.tolist() == [1.0, 0.0] * (len(states) // 2) + [1.0] * (len(states) % 2)
        for time, opened in whole.events[whole.events[:, 0] == k, 1:]:
            at = round(time / 0.01)
            assert (whole.force[at, k] == 0.0) == bool(opened)
    monkeypatch.setattr(bar_module, "MOST_EVENTS", 3)
    monkeypatch.setattr(transit, "MOST_EVENTS", 3)
    few = run_bar(stack, load, [Tap(1, 0.0), Tap(2, 0.0)], 6.0, WantedError(step=0.01))
    assert np.array_equal(few.events, whole.events[:3])
    assert np.array_equal(few.force, whole.force)


LINEAR = {
    "rigid": None,
    "spring": Contact(4e3, 1.0),
    "damped": Contact(4e3, 1.0, damper=Damper(2.0, 0.0, "never-pulls")),
    "damped while it comes": Contact(4e3, 1.0, damper=Damper(2.0, 0.0, "on-approach")),
    "lossy": Contact(4e3, 1.0, 0.4),
}


@pytest.mark.parametrize("name", LINEAR)
def test_a_blow_of_a_linear_law_is_as_much_weaker_as_it_is_slower(name):
    """Of 0.8 m/s / 1024: forces, speeds and losses go with it, times stay, touch after touch."""
    stack = Stack((bar(0.12),), (), End("spring", 15.0))
    fast, slow = (struck(stack, LINEAR[name], 8.0, v, 1.4) for v in (0.8, 0.8 / 1024.0))
    assert len(fast.touches) > 1
    for each in ("face_force", "velocity", "striker_speed", "impulse", "deepest"):
        was, now = getattr(fast, each), getattr(slow, each)
        assert now * 1024.0 == pytest.approx(was, rel=1e-9, abs=1e-9), each
    assert slow.energy_lost * 1024.0**2 == pytest.approx(fast.energy_lost, rel=1e-9, abs=1e-9)
    assert slow.touches[:, :2] == pytest.approx(fast.touches[:, :2], rel=1e-9)
    assert slow.touches[:, 2] * 1024.0 == pytest.approx(fast.touches[:, 2], rel=1e-9, abs=1e-9)


def test_a_weak_damper_takes_what_is_its_share():
    """Half of the coefficient half as much, for a damper so weak that it changes no motion."""
    lost = [struck(ENDLESS, Contact(60.0, 1.5, damper=Damper(c, 0.5, "never-pulls"))).energy_lost for c in (8e-3, 4e-3)]
    assert lost[0] / lost[1] == pytest.approx(2.0, rel=1e-3)
