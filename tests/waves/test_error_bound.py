"""Transits that are no whole number of steps: how the error falls, and that the printed bound holds.

References are the same stacks on a fine step on which every transit is whole by construction, so that only
the rounding of the coarse one is seen.
"""

import dataclasses
import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from strikewave.base.constants import material
from strikewave.contact import Contact
from strikewave.contact.law import PressureCap
from strikewave.waves import (
    BONDED,
    Branch,
    End,
    Joint,
    Layer,
    LoadPulse,
    Sampled,
    Stack,
    Tap,
    WantedError,
    _kernels,
    choose_grid,
    grid_of,
    round_bar,
    run_bar,
    transit,
)
from strikewave.waves.transit import empty_averages

FINE = 1e-9


def timed(name, impedance, transit):
    """Return a layer by impedance and transit time; unit density and area, so that Z = c."""
    return Layer(name, 1.0, impedance * impedance, 1.0, transit * impedance)


def timed_stack(impedances, transits, joints, end):
    layers = tuple(timed(f"{k}", z, t) for k, (z, t) in enumerate(zip(impedances, transits, strict=True)))
    return Stack(layers, tuple(joints), end)


JOINTS = {
    "bonded": (BONDED, BONDED),
    "compliant": (Joint(2e10), Joint(1e10, 2e3)),
    "gasket": (Joint(1e10, branches=(Branch(1e10, 2e-6),)), Joint(8e9, branches=(Branch(5e9, 9e-6),))),
}


@pytest.mark.parametrize("kind", JOINTS)
@pytest.mark.parametrize("end", ["free", "matched", "rigid"])
def test_error_falls_with_the_step(kind, end):
    """First order: transits of 10, 17.4 and 13.4 steps keep their fraction .4 when the step is divided by 6."""
    coarse = 2e-7
    stack = timed_stack([3e4, 1e4, 2e4], [10 * coarse, 17.4 * coarse, 13.4 * coarse], JOINTS[kind], End(end))
    load = LoadPulse("sine-squared", 1e4, 30e-6)
    taps = [Tap(0, 0.0), Tap(1, 0.0), Tap(2, 0.0)]
    # .4 of a step is whole at a fifth of it; smaller still, so that the trapezoidal rule leaves nothing
    whole = coarse / 6**2 / 10
    reference = run_bar(stack, load, taps, 80e-6, WantedError(step=whole))
    assert reference.grid.mismatch < 1e-12
    velocity, acceleration, mismatch = [], [], []
    for k in range(3):
        run = run_bar(stack, load, taps, 80e-6, WantedError(step=coarse / 6**k))
        exact = reference.velocity[:: round(run.grid.step / whole)][: len(run.time)]
        velocity.append(np.abs(run.velocity - exact).max())
        # the same central difference of both: what it smears is no error of rounding
        rate = (exact[2:] - exact[:-2]) / (2 * run.grid.step)
        acceleration.append(np.abs(run.acceleration[1:-1] - rate).max())
        # it overstates, but not so much as to be of no use
        assert 0.01 < velocity[-1] / run.bound.velocity <= 1.0
        assert 0.002 < acceleration[-1] / run.bound.acceleration <= 1.0
        mismatch.append(run.grid.mismatch)
    assert mismatch == pytest.approx([0.4 / 13.4, 0.4 / 80.4, 0.4 / 482.4], rel=1e-9)
    # the acceleration has corners where the pulse begins and ends; its largest error sits beside one, at a sample
    for errors, near in ((velocity, 0.01), (acceleration, 0.05)):
        found = np.log(np.asarray(errors[:-1]) / errors[1:]) / math.log(6)
        assert abs(found[-1] - 1.0) < near, f"orders {found}, errors {errors}"


@st.composite
def rounded_stacks(draw):
    """Random stacks whose transits are whole at FINE, a smooth load, taps, and a coarser step that rounds them."""
    count = draw(st.integers(2, 5))
    base = draw(st.lists(st.integers(200, 6000), min_size=count, max_size=count))
    z = [1e4 * 10.0**x for x in draw(st.lists(st.floats(-1.0, 1.0), min_size=count, max_size=count))]
    joints, shortest = [], FINE * sum(base)
    for before, after in itertools.pairwise(z):
        kind = draw(st.sampled_from(["bonded", "compliant", "gasket"]))
        y = 1 / before + 1 / after
        relaxation = 10.0 ** draw(st.floats(-6.0, -4.5))
        stiffness = 1 / (y * relaxation)
        if kind == "bonded":
            joints.append(BONDED)
            continue
        shortest = min(shortest, 20 * relaxation)
        if kind == "compliant":
            joints.append(Joint(stiffness, draw(st.floats(0.0, 2.0)) / y))
        else:
            tau = 10.0 ** draw(st.floats(-6.0, -4.0))
            joints.append(Joint(stiffness, branches=(Branch(stiffness * draw(st.floats(0.1, 3.0)), tau),)))
    kind = draw(st.sampled_from(["free", "matched", "rigid", "mass", "spring", "dashpot"]))
    lasting = 10.0 ** draw(st.floats(-6.0, -4.0))
    value = {"mass": z[-1] * lasting, "spring": z[-1] / lasting, "dashpot": z[-1] * 1e5 * lasting}.get(kind, 0.0)
    stack = timed_stack(z, [FINE * n for n in base], joints, End(kind, value))
    load = LoadPulse("sine-squared", 1e4, draw(st.floats(10e-6, 80e-6)))
    places = st.tuples(st.integers(0, count - 1), st.sampled_from([0.0, 1.0]) | st.floats(0.0, 1.0))
    taps = [Tap(*place) for place in draw(st.lists(places, min_size=1, max_size=3))]
    duration = draw(st.floats(20e-6, 120e-6))
    # a fiftieth of what must be resolved, as a run takes at most when it chooses
    largest = min(shortest, load.rise_time, duration) / 50.0
    most = max(2, min(int(largest / FINE), *base))
    return stack, load, taps, duration, draw(st.integers(max(2, most // 2), most))


@pytest.mark.verify
@settings(max_examples=60)
@given(rounded_stacks())
def test_bound_is_never_exceeded(case):
    """Rounding alone never does more than the bound; with the trapezoidal rule, 1e-3 and 1e-2 of the peak more.

    What rounding does is seen between two fine runs: of the stack, and of the lengths that the coarse grid gives it.
    """
    stack, load, taps, duration, ratio = case
    step = ratio * FINE
    run = run_bar(stack, load, taps, duration, WantedError(step=step))
    assume(run.grid.mismatch > 0.0)
    exact = run_bar(stack, load, taps, duration + 2 * step, WantedError(step=FINE))
    assert exact.grid.mismatch < 1e-12
    transits = [n * step for n in run.grid.counts]
    other = timed_stack([x.impedance for x in stack.layers], transits, stack.joints, stack.end)
    assert [x.length for x in other.layers] == pytest.approx(run.grid.lengths(stack), rel=1e-12)
    rounded = run_bar(other, load, taps, duration + 2 * step, WantedError(step=FINE))
    assert rounded.grid.mismatch < 1e-12
    velocity = np.abs(rounded.velocity - exact.velocity).max()
    acceleration = np.abs(rounded.acceleration - exact.acceleration)[1:].max()
    assert velocity <= run.bound.velocity
    assert acceleration <= run.bound.acceleration
    n = len(run.time)
    found, peak = exact.velocity[::ratio][:n], np.abs(exact.velocity).max()
    assert np.abs(run.velocity - found).max() <= run.bound.velocity + 1e-3 * peak
    found, peak = exact.acceleration[::ratio][:n], np.abs(exact.acceleration).max()
    assert np.abs(run.acceleration - found)[1:].max() <= run.bound.acceleration + 1e-2 * peak


THREE = (
    round_bar("steel", material("65Mn"), 0.0703, 0.03),
    round_bar("aluminium", material("2A12"), 0.0371, 0.03),
    round_bar("end", material("45 steel"), 0.0519, 0.025),
)


@pytest.mark.parametrize(
    "joints", [(BONDED, BONDED), (Joint(5e9), Joint(3e9, branches=(Branch(3e9, 5e-6),)))], ids=["bonded", "held"]
)
def test_default_reaches_what_it_promises(joints):
    """Three layers without a common step: 1e-3 of the velocity, 1e-2 of the acceleration, by bound and by error.

    The reference has a mismatch at least ten times smaller.
    """
    stack, load = Stack(THREE, joints), LoadPulse("sine-squared", 2e4, 100e-6)
    taps = [Tap(2, 1.0), Tap(0, 0.37)]
    run = run_bar(stack, load, taps, 300e-6)
    assert run.grid.mismatch > 0.0
    assert run.relative_bound[0] <= 1e-3
    assert run.relative_bound[1] <= 1e-2
    grid = choose_grid(stack, run.grid.mismatch / 10, 4e-9, 2e-10)
    fine = run_bar(stack, load, taps, 301e-6, WantedError(step=grid.step))
    assert fine.grid.mismatch <= 0.1 * run.grid.mismatch
    for name, share in (("velocity", 1e-3), ("acceleration", 1e-2)):
        found, exact = getattr(run, name), getattr(fine, name)
        for k in range(len(taps)):
            error = np.abs(found[1:, k] - np.interp(run.time[1:], fine.time, exact[:, k])).max()
            assert error <= share * np.abs(exact).max(), (name, k)


def test_asking_for_more_gives_more():
    """A hundredth of the error asked for: the bound keeps it."""
    stack, load = Stack(THREE, (BONDED, BONDED)), LoadPulse("sine-squared", 2e4, 100e-6)
    run = run_bar(stack, load, [Tap(2, 1.0)], 150e-6, WantedError(1e-5, 1e-4))
    assert run.relative_bound[0] <= 1e-5
    assert run.relative_bound[1] <= 1e-4


def test_bound_that_cannot_be_kept_is_reported():
    """Many layers, a long run, delay lines alone: the bound of the best try is larger than what is wanted, and finite."""
    layers = tuple(timed(f"{k}", 1e4, 1e-6 * math.sqrt(p)) for k, p in enumerate([2, 3, 5, 7, 11, 13, 17, 19, 23, 29]))
    stack, load = Stack(layers, (BONDED,) * 9), LoadPulse("sine-squared", 1e4, 20e-6)
    run = run_bar(stack, load, [Tap(9, 1.0)], 2e-3, WantedError(method="delay lines"))
    assert 1e-3 < run.relative_bound[0] < math.inf
    assert 0.0 < run.bound.velocity < math.inf
    assert len(run.time) <= 20_001


@pytest.mark.verify
@pytest.mark.parametrize("shape", ["rectangle", "half-sine", "triangle", "trapezoid"])
def test_corner_of_the_load_leaves_the_acceleration_unbounded(shape):
    """Behind a corner the acceleration jumps: its bound stays above the wanted 1e-2 at every step, and says so."""
    run = run_bar(Stack(THREE, (BONDED, BONDED)), LoadPulse(shape, 1e4, 50e-6), [Tap(2, 1.0)], 100e-6)
    assert run.grid.mismatch > 0.0
    assert 1e-2 < run.relative_bound[1] < math.inf
    # without a jump the velocity has no more than corners, and keeps its 1e-3
    assert (run.relative_bound[0] > 1e-3) == (shape == "rectangle")


def test_no_bound_where_the_theorem_does_not_hold():
    """A joint that opens, or a layer that comes with a speed: infinite, and still a run."""
    first, second = THREE[:2]
    load = LoadPulse("sine-squared", 1e4, 50e-6)
    for joint in (Joint(unilateral=True), Joint(1e9, unilateral=True, preload=1e3), Joint(unilateral=True, gap=1e-6)):
        run = run_bar(Stack((first, second), (joint,)), load, [Tap(1, 1.0)], 50e-6)
        assert run.bound.velocity == run.bound.acceleration == math.inf
        assert np.all(np.isfinite(run.velocity))
    striker = round_bar("striker", material("65Mn"), 0.05, 0.03, speed=3.0)
    run = run_bar(Stack((striker, second), (BONDED,)), load, [Tap(1, 1.0)], 50e-6)
    assert run.bound.velocity == run.bound.acceleration == math.inf


def test_whole_steps_leave_nothing_to_bound():
    """Transits that are whole steps: a bound of rounding size only."""
    stack = timed_stack([1e4, 3e4], [3e-6, 7e-6], [BONDED], End("free"))
    run = run_bar(stack, LoadPulse("sine-squared", 1e4, 30e-6), [Tap(1, 1.0)], 100e-6, WantedError(step=1e-7))
    assert run.grid.counts == (30, 70)
    assert run.relative_bound[0] < 1e-10
    assert run.relative_bound[1] < 1e-10


def test_tap_between_nodes_is_in_the_bound():
    """On whole steps the nearest node is what is read: half a step away at most, and the bound covers that."""
    stack = timed_stack([1e4], [10e-6], [], End("free"))
    load = LoadPulse("sine-squared", 1e4, 30e-6)
    exact = run_bar(stack, load, [Tap(0, 0.4925)], 100e-6, WantedError(step=1e-8))
    run = run_bar(stack, load, [Tap(0, 0.4925)], 100e-6, WantedError(step=2e-7))
    assert run.grid.mismatch < 1e-12
    for name in ("velocity", "acceleration"):
        error = np.abs(getattr(run, name) - getattr(exact, name)[::20][: len(run.time)])[1:].max()
        assert 0.0 < error <= getattr(run.bound, name)


TRANSITS = st.lists(st.floats(1e-6, 50e-6), min_size=1, max_size=6)


def of_transits(transits):
    return timed_stack([1e4] * len(transits), transits, [BONDED] * (len(transits) - 1), End("free"))


@given(TRANSITS, st.floats(-6.0, -2.0), st.floats(1e-8, 5e-7), st.floats(1.0, 100.0))
def test_chosen_grid_is_consistent(transits, mismatch, largest, range_):
    """Counts, step and mismatch fit together, no worse than plain rounding at the same step, within the limits."""
    stack, wanted = of_transits(transits), 10.0**mismatch
    smallest = largest / range_
    grid = choose_grid(stack, wanted, largest, smallest)
    ratios = np.array(grid.counts) * grid.step / np.array(transits)
    assert np.abs(ratios - 1.0).max() == pytest.approx(grid.mismatch, abs=1e-13)
    assert grid.mismatch <= grid_of(stack, grid.step).mismatch + 1e-13
    assert min(grid.counts) >= 1
    # the even share of the mismatch shifts the step by no more than the mismatch
    shortest = min(transits)
    unshifted = shortest / round(shortest / grid.step)
    assert abs(grid.step / unshifted - 1.0) <= grid.mismatch + 1e-13
    assert unshifted <= largest * (1 + 1e-12)
    if len(transits) == 1:
        assert grid.mismatch < 1e-15


@given(TRANSITS, st.floats(-6.0, -2.0), st.floats(1e-8, 5e-7), st.floats(1.0, 100.0))
def test_chosen_grid_is_the_coarsest_or_else_the_best(transits, mismatch, largest, range_):
    """Against trying t/n one by one, each with the best shift: the first that is good enough, or the best of all."""
    wanted, smallest, shortest = 10.0**mismatch, largest / range_, min(transits)
    first = max(1, math.ceil(shortest / largest))
    tried = []
    for n in range(first, max(first, math.floor(shortest / smallest)) + 1):
        ratios = [max(round(t * n / shortest), 1) * shortest / n / t for t in transits]
        tried.append((max(ratios) - min(ratios)) / (max(ratios) + min(ratios)))
        if tried[-1] <= wanted * (1 - 1e-9):
            break
    grid = choose_grid(of_transits(transits), wanted, largest, smallest)
    assert grid.mismatch == pytest.approx(min(tried), abs=1e-12) or grid.mismatch <= wanted
    if tried[-1] <= wanted * (1 - 1e-9):
        assert round(shortest / grid.step) <= first + len(tried) - 1


@given(st.lists(st.integers(1, 300), min_size=1, max_size=6), st.floats(1e-9, 1e-7), st.floats(0.02, 1.0))
def test_whole_steps_are_found(counts, unit, part):
    """Transits that are multiples of a unit: the largest step within the limit that divides them all, exactly."""
    common = math.gcd(*counts)
    stack = of_transits([n * unit for n in counts])
    largest = common * unit * part * (1 + 1e-9)
    pieces = math.ceil(1.0 / (part * (1 + 1e-9)))
    # no two ratios of counts up to 300 differ by less than 1/300^2 unless they are equal
    grid = choose_grid(stack, 1e-9, largest, largest / 3)
    assert grid.counts == tuple(n // common * pieces for n in counts)
    assert grid.mismatch < 1e-13


def test_steps_that_cannot_be_used_are_refused():
    stack = of_transits([1e-5])
    for step in (0.0, -1e-9, math.nan, math.inf):
        with pytest.raises(ValueError, match="step must be above zero"):
            grid_of(stack, step)
    with pytest.raises(ValueError, match="nodes; at most"):
        grid_of(stack, 1e-13)
    # one step at least
    assert grid_of(stack, 1e-3).counts == (1,)


def test_runs_that_make_no_sense_are_refused():
    stack, load = of_transits([1e-5]), LoadPulse("sine-squared", 1e4, 20e-6)
    with pytest.raises(ValueError, match="at least one tap"):
        run_bar(stack, load, [], 1e-4)
    for tap in (Tap(1, 0.5), Tap(-1, 0.5), Tap(0, 1.005), Tap(0, -0.005), Tap(0, math.nan)):
        with pytest.raises(ValueError, match="outside the stack of 1 layers"):
            run_bar(stack, load, [tap], 1e-4)
    for duration in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="duration must be above zero"):
            run_bar(stack, load, [Tap(0, 0.5)], duration)


def test_measured_load_gets_a_step_too():
    """A sampled sine-squared is the pulse itself, to what straight lines between its samples leave."""
    stack, pulse = Stack(THREE, (BONDED, BONDED)), LoadPulse("sine-squared", 2e4, 100e-6)
    t = np.linspace(0.0, 100e-6, 2001)
    run = run_bar(stack, Sampled(t, pulse.at(t)), [Tap(2, 1.0)], 150e-6)
    same = run_bar(stack, pulse, [Tap(2, 1.0)], 150e-6, WantedError(step=run.grid.step))
    n = math.ceil(150e-6 / run.grid.step / 20_000)
    # the sagitta of 50 ns of sin^2, 2 (pi/100 us)^2 (50 ns)^2/8 of the peak, in each of a few waves at once
    sagitta = 2 * (math.pi / 100e-6) ** 2 * (50e-9) ** 2 / 8
    size = len(run.time)
    difference = np.abs(run.velocity - same.velocity[::n][:size]).max() / np.abs(same.velocity).max()
    assert difference < 5 * sagitta


# parts of the choice of a grid, by hand


@pytest.mark.parametrize(("layers", "at_once"), [(2, 7), (12, 5), (40, 3)])
def test_steps_are_compared_some_at_once_as_far_as_memory_goes(monkeypatch, layers, at_once):
    """At most 60 values a table, at most 7 steps of it and at least 3; all from t/20 to t/60 are tried."""
    noted = []

    def arange(begin, end, dtype):
        noted.append((begin, end))
        return np.arange(begin, end, dtype=dtype)

    monkeypatch.setattr(transit, "np", SimpleNamespace(**{**vars(np), "arange": arange}))
    for name, value in (("MOST_TRIED", 60), ("FEWEST_AT_ONCE", 3), ("MOST_AT_ONCE", 7)):
        monkeypatch.setattr(transit, name, value)
    choose_grid(of_transits([6.0] + [6.0 * math.e] * (layers - 1)), 0.0, 0.301, 0.0999)
    assert [begin for begin, _ in noted] == list(range(20, 61, at_once))
    assert [end for _, end in noted] == [min(begin + at_once, 61) for begin in range(20, 61, at_once)]


@pytest.mark.parametrize("wanted", [0.0, 1e-5, 1e-4, 1e-3, 1e-2])
def test_how_many_steps_are_compared_at_once_changes_nothing(monkeypatch, wanted):
    stack = of_transits([1.0, math.e, math.pi, 7.3])
    whole = choose_grid(stack, wanted, 0.3, 2e-3)
    monkeypatch.setattr(transit, "FEWEST_AT_ONCE", 1)
    monkeypatch.setattr(transit, "MOST_AT_ONCE", 7)
    assert choose_grid(stack, wanted, 0.3, 2e-3) == whole
    assert (whole.mismatch <= wanted) == (wanted >= 1e-4)


@pytest.mark.parametrize(
    ("largest", "smallest", "counts"),
    # 11/4, 14/5, 16/6, 19/7, 22/8, 24/9, 27/10 beside e
    [
        (0.26, 0.0999, (7, 19)),
        (0.26, 0.15, (4, 11)),
        (0.13, 0.0999, (10, 27)),
        (0.13, 0.12, (8, 22)),
        (9.0, 0.6, (1, 3)),
    ],
)
def test_the_best_of_some_steps_is_taken_where_none_is_good_enough(largest, smallest, counts):
    grid = choose_grid(of_transits([1.0, math.e]), 1e-9, largest, smallest)
    assert grid.counts == counts
    # both are off by as much, in opposite directions
    ratios = counts[0] * grid.step, counts[1] * grid.step / math.e
    assert abs(ratios[0] - 1.0) == pytest.approx(abs(ratios[1] - 1.0), rel=1e-9)
    assert grid.mismatch == pytest.approx(abs(ratios[1] - 1.0), rel=1e-9)


def test_a_layer_thinner_than_the_shortest_step_takes_one(monkeypatch):
    stack = of_transits([10.0, 1.0, 7.0])
    assert choose_grid(stack, 1e-9, 5.0, 2.0) == transit.TimeGrid(2.0, (5, 1, 4), 1.0)
    monkeypatch.setattr(transit, "MOST_NODES", 9)  # 18 s, cut into 9
    assert choose_grid(stack, 1e-9, 5.0, 1e-3) == transit.TimeGrid(2.0, (5, 1, 4), 1.0)
    assert grid_of(stack, 2.0).counts == (5, 1, 4)
    with pytest.raises(ValueError, match=r"into 9\.05 nodes; at most 9e\+00: take a step above 2 s"):
        grid_of(stack, 1.99)


def test_a_tap_has_the_nearest_node_and_a_field_nodes_evenly_in_time():
    """Two layers of 1 s and 3 s and 5 m and 9 m: of eight places two and six; fewer layers where there are many."""
    first, second = timed("a", 5.0, 1.0), timed("b", 3.0, 3.0)
    grid = transit.TimeGrid(0.25, (4, 15), 0.0)
    assert transit.nearest_nodes(grid, [(1, 0.3), (0, 0.6), (1, 1.0)]).tolist() == [[1, 4], [0, 2], [1, 15]]
    assert transit.nearest_nodes(grid, []).shape == (0, 2)
    nodes, places = transit.field_nodes(Stack((first, second), (BONDED,)), grid, 2, 8)
    assert nodes.tolist() == [[0, 0], [0, 4], *([1, n] for n in (0, 3, 6, 9, 12, 15))]
    assert places == pytest.approx([0.0, 5.0, *(5.0 + 9.0 * n / 15 for n in (0, 3, 6, 9, 12, 15))], rel=1e-14)
    assert transit.field_nodes(Stack((first, second), (BONDED,)), grid, 2, 1)[0].tolist() == [
        [0, 0],
        [0, 4],
        [1, 0],
        [1, 15],
    ]
    many = Stack(tuple(timed(f"{k}", 1.0 + k, 1.0) for k in range(8)), (BONDED,) * 7)
    for most, kept in ((8, range(8)), (7, (0, 2, 4, 6, 7)), (3, (0, 3, 6, 7)), (4, (0, 2, 4, 6, 7)), (1, (0, 7))):
        nodes, places = transit.field_nodes(many, transit.TimeGrid(0.5, (2,) * 8, 0.0), most, 16)
        assert nodes.tolist() == [[k, n] for k in kept for n in (0, 2)]
        begins = np.cumsum([0.0, *range(1, 9)])
        assert places.tolist() == [begins[k + side] for k in kept for side in (0, 1)]


def test_a_bound_by_hand():
    """2/Z = 1 and 1/4, transits of 4 and 9; e = 0.5 (4, 6, 10) = 2, 3, 5; w = 3, 5, 7; steps of 8, read a quarter off.

    v^2 = (2/Z) (2^2/4 + 2 2 (3 + 0.5 3)), a^2 = (2/Z) (3^2/4 + 2 3 (5 + 0.5 5)), and 2 s times the slopes
    (2/Z) (3^2/4 + 2 3 5) and (2/Z) (5^2/4 + 2 5 7).
    """
    stack = timed_stack([2.0, 8.0], [4.0, 9.0], [Joint(1.0)], End("rigid"))
    grid = transit.TimeGrid(8.0, (4, 5), 0.5)
    integrals = np.array([4.0, 6.0, 10.0, 3.0, 5.0, 7.0])

    def bound(*places):
        found = transit.error_bound(stack, grid, integrals, places)
        return found.velocity, found.acceleration

    exact = pytest.approx((math.sqrt(19.0), math.sqrt(47.25)), rel=1e-14)
    assert bound((0, 0.0)) == bound((0, 0.25)) == bound((0, 1.0)) == bound((1, 0.2), (0, 0.0), (1, 1.0)) == exact
    lower = 0.25 * (4.0 / 9.0 + 18.0), 0.25 * (1.0 + 45.0)
    assert bound((1, 0.4)) == pytest.approx([math.sqrt(x) for x in lower], rel=1e-14)
    off = math.sqrt(19.0) + 2.0 * math.sqrt(32.25), math.sqrt(47.25) + 2.0 * math.sqrt(76.25)
    for place in (0.0625, 0.3125, 0.4375):  # a quarter of a step behind a node, and before one
        assert bound((0, place)) == pytest.approx(off, rel=1e-14)
        assert bound((1, 0.4), (0, place), (0, 0.25)) == pytest.approx(off, rel=1e-14)
    for moving in (dataclasses.replace(stack.layers[1], speed=0.1), dataclasses.replace(stack.layers[1], speed=-0.1)):
        other = Stack((stack.layers[0], moving), (BONDED,))
        assert math.isinf(transit.error_bound(other, grid, integrals, [(0, 0.0)]).velocity)


@pytest.mark.parametrize("end", [End("free"), End("dashpot", 5.0), End("matched")])
def test_norms_of_the_rates_are_those_of_all_waves_in_flight(end):
    """Sum of (d^k P)^2 + (d^k M)^2 over all nodes, of bonded layers: what entered at both faces is what there is.

    P and M from force and velocity at every node; of a layer of n steps the waves that have arrived, P at its last node
    and M at its first, count in the next layer. A dashpot takes away what waves throw off it, and nothing is let in.
    """
    step, counts = 0.5, (5, 3, 7)
    layers = tuple(timed(f"{k}", z, n * step) for k, (z, n) in enumerate(zip((2.0, 7.0, 3.0), counts, strict=True)))
    stack, grid = Stack(layers, (BONDED, BONDED), end), transit.TimeGrid(step, counts, 0.0)
    load = np.concatenate([np.zeros(3), np.random.default_rng(5).uniform(-1.0, 1.0, 20), np.zeros(17)])
    nodes = np.array([(k, j) for k, n in enumerate(counts) for j in range(n + 1)])
    seen = _kernels.Recording(nodes, 1, np.zeros((40, len(nodes))), np.zeros((40, len(nodes))))
    none = _kernels.Recording(nodes[:0], 1, np.zeros((1, 0)), np.zeros((1, 0)))
    unseen = _kernels.Extremes(nodes[:0], 1, np.zeros(0), np.zeros(0))
    tables, state = transit.tables_of(stack, grid), transit.state_at_rest(stack, grid)
    found = np.zeros(6)
    _kernels.drive(
        tables, state, load, _kernels.FORCE, (seen, none), empty_averages(nodes[:0], nodes[:0], 1, 1), unseen, found
    )  # fmt: skip
    z = np.array([layers[k].impedance for k, _ in nodes])
    last = np.array([counts[k] for k, _ in nodes])
    waves = np.concatenate(
        [
            (0.5 * (seen.force + z * seen.velocity))[:, nodes[:, 1] < last],
            (0.5 * (seen.force - z * seen.velocity))[:, nodes[:, 1] > 0],
        ],
        axis=1,
    )
    z = np.concatenate([z[nodes[:, 1] < last], z[nodes[:, 1] > 0]])
    waves = np.vstack([np.zeros((3, waves.shape[1])), waves])  # at rest before
    for k in (1, 2, 3):
        rates = np.diff(waves, k, axis=0)[3 - k :] / step**k
        norms = np.sqrt((rates**2 / z).sum(axis=1) * step)
        assert found[k - 1] == pytest.approx(norms.sum() * step, rel=1e-12)
        assert found[2 + k] == pytest.approx(norms.max(), rel=1e-12)


@pytest.mark.parametrize(
    ("joint", "end", "carried"),
    [
        (BONDED, End(), []),
        (Joint(mass=0.5), End("mass", 0.7), [0.5, 0.7]),
        (Joint(mass=5e-3), End("mass", 7e-3), [5e-3, 7e-3]),
        (Joint(2e-3, 0.1, attached=3e-3), End("oscillator", 2e-3, 4.0), [3e-3, 2e-3]),
        (Joint(2.0, 0.1, attached=0.3), End("oscillator", 0.9, 4.0, 0.2), [0.3, 0.9]),
        (Joint(unilateral=True, gap=0.1), End("spring", 4.0), []),
        (Joint(2.0, branches=(Branch(3.0, 0.4),)), End("dashpot", 4.0), []),
    ],
)
def test_parts_that_fly_have_their_mass_times_their_speed_and_half_of_its_square(joint, end, carried):
    """4 kg at 2 m/s, 9 kg at -3 m/s, 25 kg at 5 m/s; masses move with what follows them.

    What hangs at the end is no part of a momentum. The other joint, before or behind, carries 0.1 kg on a spring.
    """
    other = Joint(7.0, attached=0.1)
    for joints, speeds in (((joint, other), (2.0, -3.0, 5.0)), ((other, joint), (5.0, 2.0, -3.0))):
        flying = zip((2.0, 3.0, 5.0), speeds, strict=True)
        layers = tuple(dataclasses.replace(timed("x", z, z), speed=v) for z, v in flying)
        stack = Stack(layers, joints, end)
        grid = transit.TimeGrid(0.5, (4, 6, 10), 0.0)
        tables, state = transit.tables_of(stack, grid), transit.state_at_rest(stack, grid)
        place = joints.index(joint)
        inside = [(z * z, v) for z, v in zip((2.0, 3.0, 5.0), speeds, strict=True)]
        inside += [(0.1, speeds[2 - place])]
        ended = end.kind in ("mass", "oscillator")
        inside += [(m, speeds[1 + place]) for m in carried[: len(carried) - ended]]
        parts = inside + [(m, speeds[2]) for m in carried[len(carried) - ended :] if ended]
        assert _kernels.energy(tables, state) == pytest.approx(sum(0.5 * m * v * v for m, v in parts), rel=1e-14)
        assert _kernels.momentum(tables, state) == pytest.approx(sum(m * v for m, v in inside), rel=1e-13)
        for k, node in ((0, 0), (0, 2), (0, 4), (1, 0), (1, 6), (2, 3)):
            seen = _kernels.force_and_velocity(tables, state, k, node)
            assert seen == (pytest.approx(0.0, abs=1e-14), pytest.approx(speeds[k], rel=1e-14))
        assert state.joint[place, _kernels.OPEN] == (joint.gap > 0.0)
        if joint.gap:
            assert state.joint[place, _kernels.COMPRESSION] == -0.1


@pytest.mark.parametrize(
    ("stiffness", "place", "rate", "energy"),
    [
        (40.0, 0.2, 0.0, 0.5 * 40.0 * 0.2**2),
        (40.0, 0.2, 0.4, 0.5 * 40.0 * 0.3**2),  # half a step ahead
        (40.0, -0.05, 0.0, 0.5 * 40.0 * 0.05**2),
        (40.0, -0.175, 0.0, 0.5 * 3.0 * 0.075 + 3.0 * 0.1),  # let go at 3/40 m, the bolt pulled 0.1 m further
        (40.0, -0.275, 0.4, 0.5 * 3.0 * 0.075 + 3.0 * 0.1),
        (math.inf, -0.2, 0.4, 3.0 * 0.2),
        (math.inf, 0.0, 0.0, 0.0),
    ],
)
def test_a_bolted_joint_holds_what_its_spring_and_its_bolt_were_given(stiffness, place, rate, energy):
    """A spring of 40 N/m between halves of a flange, and a bolt that pulls 3 N however far they part."""
    damping = 0.0 if math.isinf(stiffness) else 7.0
    joint = Joint(stiffness, damping, unilateral=True, preload=3.0)
    for joints, k in (([joint, BONDED], 0), ([BONDED, joint], 1)):
        stack = timed_stack([9.0, 4.0, 2.0], [1.0, 1.0, 1.0], joints, End())
        grid = transit.TimeGrid(0.5, (2, 2, 2), 0.0)
        tables, state = transit.tables_of(stack, grid), transit.state_at_rest(stack, grid)
        state.joint[k, _kernels.COMPRESSION], state.joint[k, _kernels.RATE] = place, rate
        assert _kernels.energy(tables, state) == pytest.approx(energy, rel=1e-12, abs=1e-15)
        assert _kernels.momentum(tables, state) == 0.0


@pytest.mark.parametrize(
    ("end", "coefficients"),
    [
        (End("free"), [1.0, 0.0, 0.0, 0.0, 0.0]),
        (End("matched"), [0.5, 1.0, 4.0, 0.0, 0.0]),
        (End("rigid"), [0.0, 2.0, 0.0, 0.0, 0.0]),
        (End("dashpot", 12.0), [0.25, 1.5, 12.0, 0.0, 0.0]),
        (End("spring", 48.0), [0.25, 1.5, 12.0, 1.0, 1.0]),  # k dt/2
        (End("mass", 3.0), [0.25, 1.5, 12.0, -1.0, -1.0]),  # 2 m/dt
        (End("oscillator", 3.0, 40.0, 7.0), [0.0, 0.0, 0.0, 0.0, 0.0, 10.0, 7.0, 12.0]),
    ],
)
def test_an_end_by_hand(end, coefficients):
    """Behind 4 kg/s, of steps of 0.5 s: f = 1/(1 + R/Z) (a + 2 R/Z P), and what a gains of f and of R v."""
    stack = timed_stack([9.0, 4.0], [1.0, 1.0], [BONDED], end)
    found = transit.tables_of(stack, transit.TimeGrid(0.5, (2, 2), 0.0)).end
    assert found.tolist() == coefficients + [0.0] * (8 - len(coefficients))


@pytest.mark.parametrize(
    ("joint", "kind", "values", "branches"),
    [
        (BONDED, _kernels.BONDED, {"STIFFNESS": math.inf}, []),
        (Joint(mass=5e-3), _kernels.MASS, {"STIFFNESS": math.inf, "RESISTANCE": 0.02}, []),
        (
            Joint(40.0, 7.0, attached=5e-3),
            _kernels.OSCILLATOR,
            {"STIFFNESS": 40.0, "DAMPING": 7.0, "RESISTANCE": 10.0, "INERTIA": 0.02},
            [],
        ),
        (
            Joint(40.0, 7.0, unilateral=True, preload=3.0),
            _kernels.UNILATERAL,
            {"STIFFNESS": 40.0, "DAMPING": 7.0, "PRELOAD": 3.0},
            [],
        ),
        (
            Joint(contact=Contact(2.0, 2.0), preload=18.0),
            _kernels.CONTACT,
            {"STIFFNESS": math.inf, "PRELOAD": 18.0, "DATUM": 3.0},
            [],
        ),
        (
            # dt/(2 tau) = 3: r/4, (1 - 3)/(1 + 3)
            Joint(40.0, 7.0, (Branch(16.0, 0.5 / 6.0),)),
            _kernels.ELASTIC,
            {"STIFFNESS": 40.0, "DAMPING": 7.0, "RESISTANCE": 7.0 + 10.0 + 1.0, "BRANCHES": 2.0},
            [(10.0, 1.0), (1.0, -0.5)],
        ),
    ],
)
def test_a_joint_by_hand(joint, kind, values, branches):
    """Of steps of 0.5 s; the second of two, behind a bonded one."""
    stack = timed_stack([9.0, 4.0, 2.0], [1.0, 1.0, 1.0], [BONDED, joint], End())
    tables = transit.tables_of(stack, transit.TimeGrid(0.5, (2, 2, 2), 0.0))
    assert tables.joint_kind.tolist() == [_kernels.BONDED, kind]
    expected = np.zeros(_kernels.JOINT_VALUES)
    for name, value in values.items():
        expected[getattr(_kernels, name)] = value
    assert tables.joint_value[1] == pytest.approx(expected, rel=1e-14)
    assert tables.branch[1].tolist() == [pytest.approx(x, rel=1e-14) for x in branches] + [[0.0, 0.0]] * (
        5 - len(branches)
    )
    assert tables.start.tolist() == [0, 3, 6]
    assert tables.nodes.tolist() == [3, 3, 3]
    assert tables.law[1].any() == (joint.contact is not None)
    assert not tables.law[0].any()


def test_a_contact_at_rest_is_as_deep_as_its_preload_or_first_yield():
    """2 d^2: 18 N at 3, 50 N at 5."""
    for joint, deepest in (
        (Joint(contact=Contact(2.0, 2.0), preload=18.0), 3.0),
        (Joint(contact=Contact(2.0, 1.5, cap=PressureCap(2.0 * 5.0**1.5, "point")), preload=18.0), 5.0),
    ):
        stack = timed_stack([4.0, 2.0], [1.0, 1.0], [joint], End())
        row = transit.state_at_rest(stack, transit.TimeGrid(0.5, (2, 2), 0.0)).joint[0]
        if joint.contact.cap is not None:
            assert row[_kernels.DEEPEST] == pytest.approx(deepest, rel=1e-12)
        else:
            assert row[_kernels.DEEPEST] >= deepest
        assert row[_kernels.GROWTH] == 1.0


@pytest.mark.parametrize(("gap", "seen"), [(0.9e-12, 0.0), (1.1e-12, 1.0)])
def test_a_gap_below_rounding_is_none(gap, seen):
    stack = timed_stack([2.0, 8.0], [4.0, 9.0], [Joint(unilateral=True, gap=gap)], End())
    assert transit.state_at_rest(stack, transit.TimeGrid(1.0, (4, 9), 0.0)).joint[0, _kernels.OPEN] == seen


def test_a_grid_has_fifty_million_nodes_at_most_and_a_run_ten_thousand_events():
    stack = of_transits([1.0])
    assert grid_of(stack, 1.0 / 49e6).counts == (49_000_000,)
    with pytest.raises(ValueError, match="at most 5e\\+07"):
        grid_of(stack, 1.0 / 51e6)
    assert transit.state_at_rest(stack, transit.TimeGrid(0.5, (2,), 0.0)).events.shape == (10_000, 3)


def test_a_joint_has_a_spring_and_four_branches_at_most():
    branches = tuple(Branch(1.0 + k, 2.0) for k in range(5))
    stack = timed_stack([2.0, 8.0], [4.0, 9.0], [Joint(1.0, branches=branches)], End())
    with pytest.raises(ValueError, match="at most 4 Maxwell branches, got 5"):
        transit.tables_of(stack, transit.TimeGrid(1.0, (4, 9), 0.0))
