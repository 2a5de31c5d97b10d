"""ISO/TS 18571 against scores computed by hand, and against the package of TU Graz."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.signal.iso18571 import (
    RATE,
    SAMPLES,
    Rating,
    best_delay,
    corridor_score,
    magnitude_score,
    rate,
    slope_score,
    warped_path,
)

TIME = np.linspace(0.0, 1.0, 400)
PULSE = np.where((TIME > 0.3) & (TIME < 0.7), np.sin(np.pi * (TIME - 0.3) / 0.4) ** 2, 0.0)


def bells(generator, time, count=4):
    """Return a sum of random bells, the kind of history that crash tests give."""
    return sum(
        generator.normal() * np.exp(-(((time - generator.uniform(0.1, 0.9)) / generator.uniform(0.01, 0.15)) ** 2))
        for _ in range(count)
    )


@settings(max_examples=20, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.floats(1e-6, 1e6))
def test_a_history_agrees_with_itself_in_any_unit(seed, size):
    values = size * bells(np.random.default_rng(seed), TIME)
    assert rate(values, values) == Rating(1.0, 1.0, 1.0, 1.0, 1.0, 0)


def test_an_offset_costs_what_the_corridor_says():
    """|d| = 0.14 N: ((0.5 - 0.14) / 0.45)^2 = 0.64 at every sample; no slope and no shift differ."""
    found = rate(PULSE / PULSE.max(), PULSE / PULSE.max() + 0.14)
    assert found.corridor == pytest.approx(0.64, rel=1e-12)
    assert found.phase == 1.0
    assert found.slope == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(("offset", "score"), [(0.0499, 1.0), (0.05, 1.0), (0.5, 0.0), (0.501, 0.0)])
def test_the_corridors_end_at_5_and_50_percent(offset, score):
    for size in (1.0, -40.0):
        assert corridor_score(size * np.ones(9), size * (1.0 + np.full(9, offset))) == pytest.approx(score, abs=1e-12)


@pytest.mark.parametrize("delay", [-40, -7, 7, 40, 79])
def test_a_shift_costs_its_share_of_a_fifth_of_the_interval(delay):
    """The pulse stays inside: what is left overlaps exactly, so magnitude and slope are whole; 80 samples score 0."""
    found = rate(PULSE, np.roll(PULSE, delay))
    assert found.delay == delay
    assert found.phase == pytest.approx(1.0 - abs(delay) / 80.0, rel=1e-12)
    assert found.magnitude == pytest.approx(1.0, abs=1e-12)
    assert found.slope == pytest.approx(1.0, abs=1e-12)


def test_a_shift_of_a_fifth_of_the_interval_has_no_phase():
    assert rate(PULSE, np.roll(PULSE, 80)).phase == 0.0


@pytest.mark.parametrize(("factor", "slope"), [(1.2, 0.9), (0.5, 0.75), (3.0, 0.0)])
def test_a_factor_costs_half_of_what_it_differs_from_one_in_slope(factor, slope):
    assert rate(PULSE, factor * PULSE).slope == pytest.approx(slope, abs=1e-12)


def test_a_step_of_another_height_has_the_magnitude_of_the_heights():
    """A step from 1 to 2 against one from 1 to 2.2: warping cannot help where they differ, 200 pairs, 40 over 400; where
    they are equal all ways cost nothing, and that of 399 pairs is taken, as the package does: 40 over 799."""
    reference = np.where(np.arange(400) < 200, 1.0, 2.0)
    compared = np.where(np.arange(400) < 200, 1.0, 2.2)
    assert rate(reference, compared).magnitude == pytest.approx(1.0 - 2.0 * 40.0 / 799.0, rel=1e-12)


def test_the_overall_rating_is_the_weighted_mean():
    found = rate(PULSE, 1.3 * np.roll(PULSE, 9) + 0.02)
    parts = 0.4 * found.corridor + 0.2 * (found.phase + found.magnitude + found.slope)
    assert found.overall == pytest.approx(parts, rel=1e-12)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(18, 45), st.sampled_from([1e-6, 1.0, 1e6]), st.booleans())
def test_the_delay_is_that_of_the_largest_coefficient_of_overlapping_parts(seed, size, unit, walks):
    """By numpy's coefficient of correlation, shift by shift, up to whole samples of a fifth of the interval; of noise
    and of walks, whose overlapping parts have means of their own, in any unit."""
    reference, compared = unit * np.random.default_rng(seed).normal(size=(2, size))
    if walks:
        reference, compared = reference.cumsum(), compared.cumsum()
    most = int(0.2 * size + 1e-9)

    def coefficient(lag):
        kept = size - abs(lag)
        pair = (reference[:kept], compared[lag:]) if lag >= 0 else (reference[-kept:], compared[:kept])
        return np.corrcoef(*pair)[0, 1]

    assert best_delay(reference, compared) == max(range(-most, most + 1), key=coefficient)


def test_a_delay_does_not_depend_on_an_offset_a_million_times_the_pulse():
    """Offsets are taken off first: of 1e6 squared, the sums would have lost all digits of the pulse."""
    assert best_delay(PULSE + 1e7, np.roll(PULSE, 23) - 3e6) == 23


@pytest.mark.parametrize(("compared", "delay"), [(1.0, 0), (-1.0, 4), (0.0, 0)])
def test_of_equal_coefficients_the_least_shift_counts_and_that_forward_first(compared, delay):
    """A wave of 8 samples fits at -8, 0 and 8, its negative at -4 and 4; nothing correlates with a constant."""
    wave = np.tile([1.0, 2.0, 1.0, 0.0, -1.0, -2.0, -1.0, 0.0], 5)
    assert best_delay(wave, compared * wave) == delay


def test_of_two_shifts_by_one_that_forward_counts():
    wave = np.tile([1.0, -1.0], 12)
    assert best_delay(wave, -wave) == 1


def test_a_shift_beside_which_one_of_them_does_not_vary_may_be_the_best():
    """What overlaps at a shift by three back is level; at one by two both have their one spike at the end."""
    reference, compared = np.zeros(20), np.zeros(20)
    reference[19] = 2.0
    compared[17:] = [5.0, 1.0, 3.0]
    assert best_delay(reference, compared) == -2
    assert best_delay(reference[::-1], compared[::-1]) == 2


@pytest.mark.parametrize(("size", "reach"), [(40, 3), (35, 3), (30, 2), (21, 2)])
def test_a_spike_may_be_warped_by_less_than_a_tenth_of_the_interval(size, reach):
    """One sample less than a tenth, rounded up, as the package has it; farther away it is missed twice over."""
    reference = np.zeros(size)
    reference[size // 2] = 1.0
    for side in (-1, 1):
        assert magnitude_score(reference, np.roll(reference, side * reach)) == 1.0
        assert magnitude_score(reference, np.roll(reference, side * (reach + 1))) == 0.0


@pytest.mark.parametrize("size", [18, 19, 30])
def test_slopes_are_averaged_over_nine_samples_and_over_fewer_at_the_ends(size):
    reference, compared = np.random.default_rng(size).normal(size=(2, size)).cumsum(axis=1)

    def averaged(values):
        slope = np.gradient(values)
        half = [min(k, size - 1 - k, 4) for k in range(size)]
        return np.array([slope[k - n : k + n + 1].mean() for k, n in enumerate(half)])

    wanted = averaged(reference)
    error = np.abs(averaged(compared) - wanted).sum() / np.abs(wanted).sum()
    assert slope_score(reference, compared) == pytest.approx(max(1.0 - 0.5 * error, 0.0), rel=1e-12)
    assert slope_score(reference, reference + 0.1 * (compared - reference)) == pytest.approx(
        1.0 - 0.05 * error, rel=1e-12
    )


def test_of_a_level_reference_only_a_level_has_its_slope():
    """The error is then infinite, and no warning is given."""
    assert slope_score(np.ones(20), np.full(20, 3.0)) == 1.0
    assert slope_score(np.ones(20), np.arange(20.0)) == 0.0


def test_samples_at_the_rate_of_the_standard_are_a_crash_pulse_of_a_tenth_of_a_second():
    assert RATE == 10_000.0
    assert SAMPLES / RATE == 0.1


@pytest.mark.parametrize(
    ("overall", "grade"), [(1.0, "excellent"), (0.94, "good"), (0.8, "fair"), (0.58, "poor"), (0.0, "poor")]
)
def test_grades_begin_above_their_limits(overall, grade):
    assert Rating(0.0, 0.0, 0.0, 0.0, overall, 0).grade == grade


@settings(max_examples=20, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(8, 30))
def test_the_warped_path_costs_least_of_all(seed, reach, size):
    """Against the recursion, cell by cell."""
    generator = np.random.default_rng(seed)
    first, second = generator.normal(size=size), generator.normal(size=size)
    cost = np.full((size, size), np.inf)
    for i in range(size):
        for j in range(max(0, i - reach), min(size, i + reach + 1)):
            before = [cost[k, m] for k, m in ((i - 1, j), (i, j - 1), (i - 1, j - 1)) if k >= 0 and m >= 0]
            cost[i, j] = (first[i] - second[j]) ** 2 + (min(before) if before else 0.0)
    path = warped_path(first, second, reach)
    steps = np.diff(path, axis=0)
    assert path[0].tolist() == [0, 0]
    assert path[-1].tolist() == [size - 1, size - 1]
    assert ((steps == 0) | (steps == 1)).all()
    assert (steps.sum(axis=1) > 0).all()
    assert np.abs(path[:, 0] - path[:, 1]).max() <= reach
    assert ((first[path[:, 0]] - second[path[:, 1]]) ** 2).sum() == pytest.approx(cost[-1, -1], rel=1e-12)


@pytest.mark.parametrize(
    ("first", "second", "words"),
    [
        (PULSE, PULSE[:-1], "as many samples"),
        (PULSE[:9], PULSE[:9], "18 or more"),
        (PULSE, np.where(TIME < 0.5, PULSE, np.nan), "finite"),
        (np.where(TIME < 0.5, PULSE, np.inf), PULSE, "finite"),
        (np.zeros(400), PULSE, "zero throughout"),
    ],
)
def test_what_cannot_be_rated_is_refused(first, second, words):
    with pytest.raises(ValueError, match=words):
        rate(first, second)


def assert_as_the_package(pairs, size=400):
    from objective_rating_metrics.rating import ISO18571

    generator, time = np.random.default_rng(5), np.linspace(0.0, 1.0, size)
    for _ in range(pairs):
        reference = bells(generator, time)
        moved = np.interp(time - generator.uniform(-0.1, 0.1), time, generator.uniform(0.7, 1.3) * reference)
        compared = moved + generator.uniform(0.0, 0.5) * bells(generator, time)
        stamps = 1e-4 * np.arange(size)
        theirs = ISO18571(np.column_stack([stamps, reference]), np.column_stack([stamps, compared]))
        names = ("corridor", "phase", "magnitude", "slope", "overall")
        expected = [getattr(theirs, f"{name}_rating")(-1) for name in names]
        # a path of warping that costs the same to rounding may still be another one
        assert list(rate(reference, compared)[:5]) == pytest.approx(expected, abs=1e-6)


@pytest.mark.verify
def test_scores_are_those_of_the_package_of_tu_graz():
    assert_as_the_package(4)


@pytest.mark.verify
def test_scores_of_a_hundred_pairs_are_those_of_the_package_of_tu_graz():
    assert_as_the_package(100)
