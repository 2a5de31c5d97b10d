"""Which step a run takes, which samples it keeps, and what is added to its bound: worked by hand on runs that are made up."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.waves import (
    BONDED,
    End,
    Impactor,
    Joint,
    Layer,
    LoadPulse,
    Sampled,
    Stack,
    Tap,
    WantedError,
    bar,
    run_bar,
)
from strikewave.waves.bar import BarRun, faces_of_hung, hung_acceleration
from strikewave.waves.transit import ErrorBound, TimeGrid


def layer(name, transit, impedance=2.0, **more):
    """A layer by its transit; of unit density and area, so that Z = c."""
    return Layer(name, 1.0, impedance * impedance, 1.0, transit * impedance, **more)


TWO = Stack((layer("a", 3.0), layer("b", 5.0)), (BONDED,))
LOAD = LoadPulse("sine-squared", 7.0, 4.0)
RISE = 4.0 * (math.asin(math.sqrt(0.9)) - math.asin(math.sqrt(0.1))) / math.pi
OPENS = Stack(TWO.layers, (Joint(unilateral=True),))


@pytest.fixture
def tried(monkeypatch):
    """Let runs be made up: grids and bounds come from lists, and what is asked for is noted."""
    noted = SimpleNamespace(asked=[], grids=[], bounds=[], samplings=[], pays=False)

    def choose(stack, mismatch, largest, smallest):
        noted.asked.append((mismatch, largest, smallest))
        step, worst = noted.grids[min(len(noted.asked), len(noted.grids)) - 1]
        return TimeGrid(step, (1,) * len(stack.layers), worst)

    def run(stack, load, places, duration, grid, sampling):
        noted.samplings.append(sampling)
        return SimpleNamespace(relative_bound=noted.bounds[min(len(noted.asked), len(noted.bounds)) - 1])

    monkeypatch.setattr(bar, "choose_grid", choose)
    monkeypatch.setattr(bar, "_run", run)
    monkeypatch.setattr(bar, "_with_lumped_error", lambda run, sampling: ("lines", run.relative_bound))
    monkeypatch.setattr(bar, "spectral_bar", lambda *_: ("spectrum", None))
    monkeypatch.setattr(bar, "spectrum_pays", lambda *_: noted.pays)
    return noted


def chosen(noted, grids, bounds, stack=TWO, **wanted):
    """Return how a run of 60 s ended, and the mismatches that were asked for."""
    noted.grids, noted.bounds = grids, bounds
    ended = run_bar(stack, LOAD, [Tap(0, 0.5), Tap(1, 0.5)], 60.0, WantedError(1e-3, 1e-2, **wanted))[0]
    return ended, [pytest.approx(asked[0], rel=1e-12) for asked in noted.asked]


def test_a_first_try_that_keeps_what_is_wanted_is_the_last(tried):
    assert chosen(tried, [(1e-3, 9e-5)], [(1e-3, 1e-2)]) == ("lines", [1e-4])


@pytest.mark.parametrize(("bound", "miss"), [((3e-3, 1e-3), 3.0), ((5e-4, 4e-2), 4.0), ((3e-3, 4e-2), 4.0)])
def test_a_next_try_aims_at_half_of_what_is_wanted(tried, bound, miss):
    assert chosen(tried, [(1e-3, 9e-5)], [bound, (0.0, 0.0)]) == ("lines", [1e-4, 9e-5 / (2.0 * miss)])


def test_an_acceleration_that_no_longer_halves_is_left_as_it_is(tried):
    """4, 1.9, 1.0 times what is wanted: the second try halved it, the third did not, and the velocity is good."""
    grids = [(1e-3, 9e-5), (1e-3, 8e-6), (1e-3, 7e-7)]
    bounds = [(5e-4, 4e-2), (5e-4, 1.9e-2), (5e-4, 1.01e-2), (0.0, 0.0)]
    assert chosen(tried, grids, bounds) == ("lines", [1e-4, 9e-5 / 8.0, 8e-6 / 3.8])


def test_a_velocity_that_misses_goes_on_though_the_acceleration_is_hopeless(tried):
    grids = [(1e-3, 9e-5), (1e-3, 8e-6)]
    bounds = [(5e-3, 4e-2), (3e-3, 3.9e-2), (0.0, 0.0)]
    assert chosen(tried, grids, bounds) == ("lines", [1e-4, 9e-5 / 10.0, 8e-6 / 6.0])


def test_whole_steps_are_made_shorter_instead(tried):
    """What is left is the way from a tap to the nearest node: a step of a sixth for three times too much."""
    chosen(tried, [(1e-3, 1e-13)], [(3e-3, 0.0), (0.0, 0.0)])
    assert [asked[0] for asked in tried.asked] == [1e-4, 1e-4]
    assert tried.asked[1][1] == pytest.approx(1e-3 / 6.0, rel=1e-12)


def test_tries_end_after_four_where_no_grid_is_better_and_where_no_bound_holds(tried):
    falling = [(1e-3, mismatch) for mismatch in (9e-5, 4e-6, 2e-7, 1e-8, 5e-10, 2e-11)]
    assert len(chosen(tried, falling, [(9e-3, 0.0)])[1]) == 4
    tried.asked.clear()
    assert len(chosen(tried, [(1e-3, 2e-4)], [(9.0, 0.0)])[1]) == 1  # 1e-4 was asked for
    tried.asked.clear()
    assert len(chosen(tried, [(1e-3, 1e-5)], [(math.inf, math.inf)])[1]) == 1


@pytest.mark.parametrize(
    ("method", "pays", "bound", "ended"),
    [
        ("auto", True, 1.1e-3, "spectrum"),
        ("auto", True, 9e-4, "lines"),
        ("auto", False, 1.1e-3, "lines"),
        ("delay lines", True, 1.1e-3, "lines"),
    ],
)
def test_a_bound_that_cannot_be_kept_goes_to_a_spectrum_that_pays(tried, method, pays, bound, ended):
    tried.pays = pays
    assert chosen(tried, [(1e-3, 2e-4)], [(bound, 0.0)], method=method)[0] == ended


@pytest.mark.parametrize(
    ("mismatch", "stack", "method", "ended"),
    [
        (0.051, TWO, "auto", "spectrum"),
        (0.049, TWO, "auto", "lines"),
        (0.051, TWO, "delay lines", "lines"),
        (0.051, OPENS, "auto", "lines"),
    ],
)
def test_layers_that_a_grid_would_change_by_more_than_a_twentieth_go_to_the_spectrum(
    tried, mismatch, stack, method, ended
):
    assert chosen(tried, [(1e-3, mismatch)], [(0.0, 0.0)], stack, method=method)[0] == ended


def test_layers_that_a_grid_would_change_by_more_than_half_are_refused_with_what_to_do(tried):
    """b: 1 kg/m^3, 4 Pa, 1 m^2, 10 m; 60 s are 20 transits of 3 s, in two layers."""
    assert chosen(tried, [(1e-3, 0.5)], [(0.0, 0.0)], method="delay lines")[0] == "lines"
    with pytest.raises(
        ValueError, match=r"layer a is too thin.*in 3 s.*4\.0e\+01 layer steps.*of 0\.6667 N/m.*of 6 kg"
    ):
        chosen(tried, [(1e-3, 0.51)], [(0.0, 0.0)], method="delay lines")


@pytest.mark.parametrize(
    ("stack", "load", "duration", "taps", "period", "largest", "smallest"),
    [
        # the load is the first to change
        (TWO, LOAD, 60.0, 2, math.inf, RISE / 50.0, 60.0 * 2 / 1e7),
        (OPENS, LOAD, 60.0, 2, math.inf, RISE / 400.0, 60.0 * 2 / 1e7),
        (TWO, LOAD, 0.3, 2, math.inf, 0.3 / 50.0, 0.3 * 2 / 1e7),
        (TWO, LOAD, 60.0, 2, 0.25, 0.25 / 50.0, 60.0 * 2 / 1e7),
        (TWO, LOAD, 60.0, 2, 1e-6, 60.0 * 2 / 4e6, 60.0 * 2 / 1e7),  # as far as four million samples go
        (TWO, LoadPulse("rectangle", 7.0, 400.0), 600.0, 2, math.inf, 8.0 / 50.0, 600.0 * 2 / 1e7),
        (Stack((layer("a", 8.0 / 150),) * 150, (BONDED,) * 149), LOAD, 60.0, 1, math.inf, RISE / 50, 60.0 / 1e5),
    ],
)
def test_the_first_step_resolves_what_changes_first(tried, stack, load, duration, taps, period, largest, smallest):
    """By 50 steps, 400 where a joint opens; the shortest costs ten million layer steps, or 100 000 steps."""
    tried.grids, tried.bounds = [(1e-3, 0.0)], [(0.0, 0.0)]
    run_bar(stack, load, [Tap(0, 0.5)] * taps, duration, WantedError(period=period))
    assert tried.asked == [(1e-4, pytest.approx(largest, rel=1e-12), pytest.approx(smallest, rel=1e-12))]
    assert tried.samplings[0].shortest == pytest.approx(min(8.0, RISE if load is LOAD else 400.0, duration))


def test_a_step_that_would_be_shorter_than_the_shortest_is_that_one(tried):
    """A load of 4 us within 1e9 s."""
    tried.grids, tried.bounds = [(500.0, 0.0)], [(0.0, 0.0)]
    run_bar(TWO, LoadPulse("sine-squared", 7.0, 4e-6), [Tap(0, 0.5)], 1e9)
    assert tried.asked[0][1:] == (1e9 * 2 / 1e7, 1e9 * 2 / 1e7)


@pytest.mark.parametrize(
    ("duration", "step", "shortest", "every"),
    [
        (1.0, 1e-5, 1.0, 5),  # 100 000 steps
        (1.0, 0.99e-5, 1.0, 6),
        (1.0, 1e-5, 1.6e-3, 3),  # a fiftieth of 160 steps
        (1.0, 1e-5, 1.4e-3, 2),
        (1.0, 1e-5, 1e-5, 1),
        (1.0, 1e-3, 1.0, 1),
    ],
)
def test_some_20_000_samples_are_kept_but_fifty_in_the_shortest_time(duration, step, shortest, every):
    assert bar._every(duration, step, shortest, 1) == every


def test_samples_of_all_taps_are_four_million_at_most():
    assert bar._every(1.0, 1e-6, 1e-4, 3) == 2  # a half of three million
    assert bar._every(1.0, 1e-6, 1e-5, 4) == 1
    with pytest.raises(ValueError, match="changes within 1e-05 s"):
        bar._every(1.0, 1e-6, 1e-5, 5)


@pytest.mark.parametrize(("step", "words"), [(4.4, None), (4.51, r"changes a transit by 50 %: take one below 1\.5 s")])
def test_a_step_may_be_one_and_a_half_transits(step, words):
    if words is None:
        assert (
            run_bar(TWO, LoadPulse("rectangle", 7.0, 40.0), [Tap(0, 0.0)], 60.0, WantedError(step=step)).grid.counts[0]
            == 1
        )
        return
    with pytest.raises(ValueError, match=words):
        run_bar(TWO, LoadPulse("rectangle", 7.0, 40.0), [Tap(0, 0.0)], 60.0, WantedError(step=step))


def test_a_run_lasts_a_hundred_thousandth_of_the_transit_at_least():
    """8 s through both layers."""
    load = LoadPulse("rectangle", 7.0, 1.0)
    with pytest.raises(ValueError, match=r"take one above 8e-05 s"):
        run_bar(TWO, load, [Tap(0, 0.0)], 7.9e-5)
    with pytest.raises(ValueError, match="too long to follow"):  # the next refusal
        run_bar(TWO, load, [Tap(0, 0.0)], 8.1e-5, WantedError(step=1.0))


@pytest.mark.parametrize(("step", "taps", "refused"), [(1e-3, 399, False), (1e-3, 401, True)])
def test_a_step_that_is_asked_for_leaves_four_million_samples_at_most(monkeypatch, step, taps, refused):
    monkeypatch.setattr(bar, "_run", lambda *_: None)
    monkeypatch.setattr(bar, "_with_lumped_error", lambda run, sampling: (sampling.every, sampling.shortest))
    load = LoadPulse("rectangle", 7.0, 1.0)
    asked = [Tap(0, 0.0)] * taps, 10.0, WantedError(step=step)
    if not refused:
        assert run_bar(TWO, load, *asked) == (1, 1.0)
        return
    with pytest.raises(ValueError, match=r"take a step above 0\.001 s"):
        run_bar(TWO, load, *asked)


def made_up(rows, scale, bound=(1.0, 2.0), stack=TWO):
    """A run of two taps whose velocity is a square of time at one, and whose acceleration a cube at the other."""
    n = np.arange(float(rows))
    velocity, acceleration = np.zeros((rows, 2)), np.zeros((rows, 2))
    velocity[:, 1], acceleration[:, 0] = scale * n * n, scale * n**3
    return SimpleNamespace(
        stack=stack, load=LOAD, places=(), duration=60.0, grid=TimeGrid(0.5, (6, 10), 0.25), bound=ErrorBound(*bound),
        time=n, velocity=velocity, acceleration=acceleration,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("joint", "end"),
    [
        (Joint(2.0), End()),
        (Joint(mass=1.0), End()),
        (Joint(2.0, attached=1.0), End()),
        (BONDED, End("mass", 1.0)),
        (BONDED, End("spring", 1.0)),
        (BONDED, End("oscillator", 1.0, 2.0)),
    ],
)
def test_twice_what_half_the_step_changes_is_added_and_a_third_of_the_bend(monkeypatch, joint, end):
    """Of five samples: -n^2 at most 16, -n^3 at most 64; the second difference of 2 n^3 is 12 n, 36 at most."""
    stack, finer = Stack(TWO.layers, (joint,), end), []

    def again(stack, load, places, duration, grid, sampling):
        finer.append((grid, sampling))
        return made_up(6, 1.0)

    monkeypatch.setattr(bar, "_run", again)
    monkeypatch.setattr(bar, "replace", lambda run, bound: bound)
    found = bar._with_lumped_error(made_up(5, 2.0, stack=stack), bar._Sampling(3, 0.125))
    assert finer == [(TimeGrid(0.25, (12, 20), 0.25), bar._Sampling(6, 0.125))]
    assert found.velocity == pytest.approx(1.0 + 2.0 * 16.0, rel=1e-14)
    assert found.acceleration == pytest.approx(2.0 + 2.0 * 64.0 + 36.0 / 3.0, rel=1e-14)


def test_half_the_step_that_changes_nothing_adds_nothing(monkeypatch):
    """Two samples have no second difference."""
    stack = Stack(TWO.layers, (Joint(2.0),))
    monkeypatch.setattr(bar, "_run", lambda *_: made_up(2, 3.0))
    monkeypatch.setattr(bar, "replace", lambda run, bound: bound)
    assert bar._with_lumped_error(made_up(2, 3.0, stack=stack), bar._Sampling(1, 0.5)) == ErrorBound(1.0, 2.0)


@pytest.mark.parametrize(
    ("joint", "end", "bound"),
    [
        (BONDED, End("free"), (1.0, 2.0)),
        (BONDED, End("rigid"), (1.0, 2.0)),
        (BONDED, End("dashpot", 1.0), (1.0, 2.0)),
        (Joint(2.0), End(), (math.inf, math.inf)),
    ],
)
def test_nothing_is_run_again_where_nothing_is_lumped_or_no_bound_holds(monkeypatch, joint, end, bound):
    monkeypatch.setattr(bar, "_run", None)
    run = made_up(5, 2.0, bound, Stack(TWO.layers, (joint,), end))
    assert bar._with_lumped_error(run, bar._Sampling(3, 0.125)) is run


def spiked(steps, at):
    """A force of 1 N at one step alone, and of nothing at all others."""
    values = np.zeros(steps + 1)
    values[at] = 1.0
    return Sampled(0.01 * np.arange(steps + 1.0), values)


@pytest.mark.parametrize(("at", "seen"), [(10, 1.0), (11, 0.0), (14, 0.0), (15, 1.0)])
def test_extremes_are_looked_at_twenty_times_in_the_shortest_time(at, seen):
    """Of 1 s at 0.01 s a step: every fifth; the rear face hears it 40 steps later, doubled nowhere as it is matched."""
    stack = Stack((layer("a", 0.2), layer("b", 0.2)), (BONDED,), End("matched"))
    run = bar._run(stack, spiked(60, at), [(0, 0.0)], 0.6, TimeGrid(0.01, (20, 20), 0.0), bar._Sampling(1, 1.0))
    assert run.face_greatest[:, 0].tolist() == [seen, seen]
    assert run.face_greatest[1, 1] == seen
    assert run.field_greatest[0] == run.field_greatest[-1] == seen
    assert np.all(run.face_least == 0.0)
    pulled = Sampled(run.load.time, -run.load.values)
    run = bar._run(stack, pulled, [(0, 0.0)], 0.6, TimeGrid(0.01, (20, 20), 0.0), bar._Sampling(1, 1.0))
    assert run.face_least.tolist() == [[-seen, -seen], [-seen, -seen]]
    assert run.field_least[0] == -seen


@pytest.mark.parametrize(("less", "samples"), [(0.5e-12, 11), (1.5e-12, 10)])
def test_a_whole_number_of_steps_is_one_to_a_millionth_of_a_millionth(less, samples):
    load = LoadPulse("rectangle", 3.0, 100.0)
    stack, grid = Stack((layer("a", 0.4),)), TimeGrid(0.01, (40,), 0.0)
    assert len(bar._run(stack, load, [(0, 0.0)], 0.1 * (1.0 - less), grid, bar._Sampling(1, 0.5)).time) == samples


@pytest.mark.parametrize(("duration", "every", "coarse"), [(9.98, 3, 1), (9.99, 2, 2), (15.03, 7, 3)])
def test_a_field_has_500_rows_or_so_and_a_tap_one_row_in_every_kept_step(duration, every, coarse):
    """Of a jump of force that runs along a matched bar of 40 steps: a place d steps in is pressed from step d on."""
    stack = Stack((layer("a", 0.4),), (), End("matched"))
    load = LoadPulse("rectangle", 3.0, 100.0)
    run = bar._run(stack, load, [(0, 0.25), (0, 1.0)], duration, TimeGrid(0.01, (40,), 0.0), bar._Sampling(every, 0.5))
    steps = round(duration / 0.01)
    assert run.time == pytest.approx(0.01 * np.arange(0, steps + 1, every), rel=1e-12)
    assert run.force.shape == (steps // every + 1, 2)
    assert run.force[:, 0].tolist() == [3.0 * (k * every >= 10) for k in range(steps // every + 1)]
    assert run.velocity[:, 1].tolist() == [1.5 * (k * every >= 40) for k in range(steps // every + 1)]
    assert run.field_time == pytest.approx(0.01 * coarse * np.arange(steps // coarse + 1), rel=1e-12)
    assert run.field_position == pytest.approx(2.0 * 0.01 * np.arange(41), rel=1e-12)
    row, place = np.indices(run.field_force.shape)
    assert np.array_equal(run.field_force, 3.0 * (row * coarse >= place))
    assert np.array_equal(run.field_velocity, 1.5 * (row * coarse >= place))
    assert run.field_layer.tolist() == [0] * 41
    # to one kept step behind the last, and the step after it
    passed = every * (steps // every + 1) + 1
    assert run.impulse == pytest.approx(3.0 * 0.01 * passed, rel=1e-12)
    assert run.end_impulse == pytest.approx(3.0 * 0.01 * (passed - 40), rel=1e-12)
    assert run.momentum == pytest.approx(3.0 * 0.01 * 40, rel=1e-12)
    assert run.mean_push[-1] == pytest.approx(0.0, abs=1e-12)


def test_the_push_on_a_bar_is_averaged_with_the_hat_of_a_kept_step():
    """F = 3 + n at the face, the same four steps later at the end; hats of three steps, (1, 2/3, 1/3)/3 to either side.

    Of a straight line the average is its middle. The first row counts what lies within the run, (F0 + (4 F1 + 2 F2)/3)/3;
    at the second the end is pressed from the fourth step on, by (2 3 + 4)/9.
    """
    stack = Stack((layer("a", 0.04),), (), End("matched"))
    load = Sampled(0.01 * np.arange(40.0), 3.0 + np.arange(40.0))
    run = bar._run(stack, load, [(0, 0.5)], 0.12, TimeGrid(0.01, (4,), 0.0), bar._Sampling(3, 0.5))
    assert run.mean_push == pytest.approx([35.0 / 9.0, 6.0 - 10.0 / 9.0, 4.0, 4.0, 4.0], rel=1e-12)


def test_a_striker_is_kept_with_its_touches_and_its_slowest_approach():
    load = Impactor(2.0, 3.0, None, 0.125)
    row = bar._law(load)
    assert math.isinf(row[bar.STIFFNESS])
    assert row[bar.SLOWEST] == 0.125
    run = run_bar(Stack((layer("a", 0.3),)), load, [Tap(0, 1.0)], 2.0, WantedError(step=0.01))
    assert run.touches.shape == (1, 3)  # off with the first echo, at 0.6 s
    assert run.touches[0] == pytest.approx([0.0, 0.6, 3.0], abs=0.011)
    # m u' = -Z u until then, 2 u' = -2 u, and by the trapezoidal rule half of the step in which they part
    assert run.striker_speed == pytest.approx(3.0 * math.exp(-0.595), rel=1e-4)
    # the first force, 6 N, acts on the bar for a whole step, on the striker for half of it
    assert run.impulse == pytest.approx(2.0 * (3.0 - run.striker_speed) + 0.03, rel=1e-12)
    assert math.isinf(run.bound.velocity)


def whole(**changes):
    """A run of 2 kg and 3 kg at 2 taps, with changes."""
    nothing = np.zeros((3, 2))
    fields = {one.name: nothing for one in dataclasses.fields(BarRun)} | {
        "stack": TWO, "places": ((0, 0.5), (1, 0.5)), "time": np.array([0.0, 0.5, 1.0]), "bound": ErrorBound(0.5, 3.0),
        "impulse": 0.0, "end_impulse": 0.0, "momentum": 0.0,
    }  # fmt: skip
    return BarRun(**(fields | changes))


@pytest.mark.parametrize(
    ("values", "speeds", "error"),
    [
        ((8.0, 2.0, 5.0), (0.0, 0.0), 1.0 / 8.0),
        ((2.0, -10.0, 9.0), (0.0, 0.0), 3.0 / 10.0),
        ((0.0, 2.0, -3.0), (0.5, -2.0), 1.0 / (6.0 * 0.5 + 10.0 * 2.0)),  # of 6 kg and 10 kg
        ((0.0, 0.0, 0.0), (0.0, 0.0), 0.0),
    ],
)
def test_the_error_of_momentum_is_over_the_largest_that_flowed(values, speeds, error):
    stack = Stack(tuple(dataclasses.replace(x, speed=v) for x, v in zip(TWO.layers, speeds, strict=True)), (BONDED,))
    impulse, end, gained = values
    run = whole(stack=stack, impulse=impulse, end_impulse=end, momentum=gained)
    assert run.momentum_error == pytest.approx(error, rel=1e-14)


def test_bounds_are_over_the_largest_values_or_those_of_one_wave_where_all_taps_stand_still():
    """F/Z at Z = 2: 3 at most; it changes by 2.5 in half a second at the beginning, and its rates are one-sided there."""
    moving = np.array([[0.0, 1.0], [-4.0, 2.0], [0.5, 0.0]])
    force = np.array([[1.0, 0.0], [6.0, 2.0], [6.0, 0.0]])
    assert whole(velocity=moving, acceleration=5.0 * moving, force=force).relative_bound == (0.5 / 4.0, 3.0 / 20.0)
    still = whole(velocity=2.9e-9 * np.ones((3, 2)), acceleration=moving, force=force)
    assert still.relative_bound == pytest.approx((0.5 / 3.0, 3.0 / 5.0), rel=1e-14)
    assert still.waves.tolist() == (0.5 * force).tolist()
    barely = whole(velocity=3.1e-9 * np.ones((3, 2)), acceleration=moving, force=force)
    assert barely.relative_bound == pytest.approx((0.5 / 3.1e-9, 3.0 / 4.0), rel=1e-14)
    assert whole().relative_bound == (math.inf, math.inf)
    other = Stack((layer("a", 1.0, 2.0), layer("b", 1.0, 5.0)), (BONDED,))
    assert whole(stack=other, force=force, places=((1, 0.0), (0, 1.0))).waves[1].tolist() == [6.0 / 5.0, 2.0 / 2.0]


def test_masses_on_springs_are_pushed_by_what_is_lost_from_face_to_face():
    hung = Stack(
        (layer("a", 1.0),) * 4,
        (Joint(1.0, attached=2.0), BONDED, Joint(1.0, attached=5.0)),
        End("oscillator", 4.0, 1.0),
    )
    assert faces_of_hung(hung) == [(0, 1.0), (1, 0.0), (2, 1.0), (3, 0.0)]
    faces = np.array([[10.0, 4.0, 7.0, 17.0], [1.0, 2.0, 3.0, 13.0]])
    found = hung_acceleration(hung, faces, np.array([20.0, 6.0]))
    assert found.tolist() == [[3.0, -2.0, 5.0], [-0.5, -2.0, 1.5]]
    assert hung_acceleration(TWO, np.empty((2, 0)), np.array([20.0, 6.0])).shape == (2, 0)
    assert faces_of_hung(Stack((layer("a", 1.0),), (), End("oscillator", 4.0, 1.0))) == []
