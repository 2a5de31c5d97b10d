"""The fit of a smooth pulse: against pulses that are known, an independent solver, and differences of its own squares."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from strikewave.records import _pulse_kernels as kernels
from strikewave.records import pulse_shape
from strikewave.records.pulse_shape import SmoothPulse, fit_smooth_pulse

TIME = np.linspace(0.0, 2.0, 121)
pulses = st.builds(
    SmoothPulse, st.floats(0.5, 1.5), st.floats(0.4, 0.6), st.floats(0.6, 1.2), st.floats(0.2, 0.8), st.floats(0.5, 3.0)
)


@settings(max_examples=30)
@given(pulses)
def test_a_pulse_of_the_family_is_found_again(true):
    fitted = fit_smooth_pulse(TIME, true.at(TIME), 0.5, 1.0)
    # of powers below one a sample that comes near a foot in another valley of the squares misses that foot alone
    assert fitted.misfit < (1e-6 if true.power > 1.0 else 0.02)
    # the fit ends where its steps are 1e-6 of the pulse
    assert fitted.peak == pytest.approx(true.peak, rel=1e-4 if true.power > 1.0 else 0.02)
    assert fitted.width() == pytest.approx(true.width(), rel=1e-4 if true.power > 1.0 else 0.03)


@settings(max_examples=30)
@given(pulses, st.integers(0, 1000))
def test_no_pulse_near_that_of_the_fit_has_fewer_squares(true, seed):
    """An independent solver that begins there gains nothing: the fit ends at a minimum within the bounds."""
    values = true.at(TIME) + 0.05 * np.random.default_rng(seed).normal(size=TIME.size)
    fitted = fit_smooth_pulse(TIME, values, 0.5, 1.0)
    low, high = pulse_shape.LOWEST.copy(), pulse_shape.HIGHEST.copy()
    scale = np.max(values)
    low[0], high[0] = low[0] * scale, high[0] * scale
    low[1], high[1] = TIME[0] - 0.5, TIME[-1]
    start = np.clip(fitted[:5], low + 1e-9, high - 1e-9)
    better = least_squares(lambda v: SmoothPulse(*v).at(TIME) - values, start, bounds=(low, high))
    squares, smooth = np.sum((fitted.at(TIME) - values) ** 2), fitted.power > 1.2
    # of powers about and below one a foot is so steep that a sample there makes 1e-16 of its time 1e-8 of the pulse, or more
    assert squares == pytest.approx((fitted.misfit * fitted.peak) ** 2 * TIME.size, rel=1e-9 if smooth else 1e-4)
    # a foot is a kink, at a sample a valley of the squares: a step over one gained 0.1 % once in 3000 draws, of steep feet 4 %
    assert 2.0 * better.cost > (0.99 if smooth else 0.9) * squares


@settings(max_examples=30)
@given(pulses)
def test_gradient_and_normal_matrix_are_the_derivatives_of_the_pulse(pulse):
    time = pulse.begin + pulse.length * np.array([-0.5, *np.linspace(0.02, 0.98, 40), 1.5])  # no foot is at a sample
    values, spreads = np.cos(time), np.array([1.0, 0.1, 0.3, 0.2, 1.0])
    normal, gradient = np.zeros((5, 5)), np.zeros(5)
    squares = kernels.normal_equations(time, values, np.array(pulse[:5]), spreads, np.zeros(5), normal, gradient)
    rest = pulse.at(time) - values
    assert squares == pytest.approx(np.sum(rest**2), rel=1e-12)
    changes = 1e-6 * np.diag(spreads)
    more, less = (np.array([SmoothPulse(*row).at(time) for row in pulse[:5] + side * changes]) for side in (1, -1))
    slopes = (more - less) / 2e-6
    # a difference over 1e-6 loses 1e-10 to rounding, and 1e-8 to what bends within it near a foot
    assert gradient == pytest.approx(slopes @ rest, rel=1e-6, abs=1e-7)
    assert np.tril(normal) == pytest.approx(np.tril(slopes @ slopes.T), rel=1e-6, abs=1e-7)


def test_a_step_keeps_to_the_bounds():
    """Of a spike the length goes to its lowest, of a step the pulse never ends."""
    for values in ((np.abs(TIME - 1.0) < 0.01) * 1.0, (TIME > 1.0) * 1.0):
        fitted = fit_smooth_pulse(TIME, values, 0.9, 0.2)
        assert pulse_shape.LOWEST[2] * 0.2 <= fitted.length <= pulse_shape.HIGHEST[2] * 0.2
        assert pulse_shape.LOWEST[3] <= fitted.rise_share <= pulse_shape.HIGHEST[3]
        assert pulse_shape.LOWEST[4] <= fitted.power <= pulse_shape.HIGHEST[4]


@settings(max_examples=30)
@given(pulses)
def test_tangents_are_those_of_the_pulse(pulse):
    """Along each, the pulse moves as one does whose parameter is changed."""
    directions, speeds = pulse.tangents(TIME)
    assert np.linalg.norm(directions, axis=0) == pytest.approx(np.ones(5))
    longer = pulse._replace(peak=1.01 * pulse.peak)
    assert pulse.at(TIME) + 0.01 * pulse.peak * speeds[0] * directions[:, 0] == pytest.approx(longer.at(TIME))


@settings(max_examples=20)
@given(pulses)
def test_figures_of_a_pulse_are_those_of_its_samples(pulse):
    """Width, rise and area of a hundred thousand samples of it; the toes beyond two times, too."""
    time = np.linspace(pulse.begin - 0.1, pulse.begin + pulse.length + 0.1, 100_001)
    values, step = pulse.at(time), time[1] - time[0]
    assert pulse.width() == pytest.approx(step * np.count_nonzero(values > 0.1 * pulse.peak), abs=2.0 * step)
    assert pulse.width(0.5) == pytest.approx(step * np.count_nonzero(values > 0.5 * pulse.peak), abs=2.0 * step)
    rising = values[time < pulse.time]
    between = np.count_nonzero((rising > 0.1 * pulse.peak) & (rising < 0.9 * pulse.peak))
    assert pulse.rise() == pytest.approx(step * between, abs=2.0 * step)
    assert time[np.argmax(values)] == pytest.approx(pulse.time, abs=step)
    assert pulse.area() == pytest.approx(np.trapezoid(values, time), rel=1e-4)  # a foot of power 0.5 is steep
    begin, end = pulse.begin + 0.1 * pulse.length, pulse.begin + 0.8 * pulse.length
    beyond = np.trapezoid(np.where((time < begin) | (time > end), values, 0.0), time)
    assert pulse.area_beyond(begin, end) == pytest.approx(beyond, abs=3e-3 * pulse.peak * pulse.length)
    assert pulse.area_beyond(pulse.begin - 1.0, pulse.begin + pulse.length + 1.0) == 0.0
    slope = (pulse.width(0.08) - pulse.width(0.12)) / 0.04
    assert pulse.width_slope() == pytest.approx(slope, rel=1e-9)


@pytest.mark.parametrize("true", [SmoothPulse(2.0, 0.5, 1.0, 0.4, 1.5), SmoothPulse(-5.0, 0.2, 0.7, 0.6, 2.5)])
def test_uncertainty_of_the_fit_is_that_of_normal_equations(true):
    """Derivatives by another step, and the inverse of J'J; figures by theirs. The bound of Cramer and Rao."""
    step, noise = 0.01, 0.03
    time = true.begin + step * np.arange(-100, 200)
    sizes = np.array([abs(true.peak), true.length, true.length, 1.0, 1.0])
    columns, slopes = [], []
    for k in range(5):
        more, less = (SmoothPulse(*(np.array(true[:5]) + side * 1e-3 * sizes[k] * np.eye(5)[k])) for side in (1, -1))
        columns.append((more.at(time) - less.at(time)) / (2e-3 * sizes[k]))
        figures = [np.array([abs(one.peak), one.width(), one.area()]) for one in (more, less)]
        slopes.append((figures[0] - figures[1]) / (2e-3 * sizes[k]))
    inverse = np.linalg.inv(np.array(columns) @ np.array(columns).T)
    expected = noise * np.sqrt(np.diag(np.array(slopes).T @ inverse @ np.array(slopes)))
    # where a pulse begins within a sample of the changed one, derivatives differ by what bends: 1 %
    assert np.array(dataclasses.astuple(true.uncertainty(step, noise))) == pytest.approx(expected, rel=0.01)


def test_a_long_stretch_is_averaged_before_it_is_fitted():
    """Means over nine samples of a pulse of 2000: what they lose of a peak is (pi 9 / 2000)^2 / 24."""
    true = SmoothPulse(5.0, 3.0, 2.0, 0.4, 1.5)
    time = np.linspace(2.0, 6.0, 2003)
    fitted = fit_smooth_pulse(time, true.at(time), 3.1, 1.8)
    assert np.array(fitted[:5]) == pytest.approx(np.array(true[:5]), rel=1e-3)
    assert fitted.misfit < 1e-4


def test_a_filter_of_a_pulse_is_that_of_its_samples():
    """A low-pass leaves of a half-sine what it leaves of the same one sampled by hand."""
    from strikewave.signal.filters import Filter, effect_on_pulse

    low = Filter(2.0)
    t = np.arange(-4.0, 5.0, 1.0 / 400)
    by_hand = effect_on_pulse(low, np.where((t > 0) & (t < 1), np.sin(np.pi * np.clip(t, 0, 1)), 0.0), 1.0 / 400)
    found = SmoothPulse(-3.0, 7.0, 1.0, 0.5, 1.0).through(low)
    assert np.array(found) == pytest.approx(np.array(by_hand), rel=2e-3)


def marquardt(time, values, start, low, high, spreads, rounds, converged):
    """Return where the steps of Marquardt with the damping of Nielsen lead, by numpy's solver, and the squares there.

    Parameters at a bound that the gradient presses on are held; what goes beyond is put on the bound.
    """

    def at(pulse):
        slope, normal, gradient = np.zeros(5), np.zeros((5, 5)), np.zeros(5)
        squares = kernels.normal_equations(time, values, pulse, spreads, slope, normal, gradient)
        return squares, normal + np.tril(normal, -1).T, gradient

    pulse = start.copy()
    squares, normal, gradient = at(pulse)
    damping, growth = 0.1 * np.max(np.diag(normal)), 2.0
    for _ in range(rounds - 1):
        free = ~(((pulse <= low) & (gradient > 0.0)) | ((pulse >= high) & (gradient < 0.0)))
        step = np.zeros(5)
        step[free] = np.linalg.solve((normal + damping * np.eye(5))[np.ix_(free, free)], -gradient[free])
        trial = np.clip(pulse + spreads * step, low, high)
        step = (trial - pulse) / spreads
        gained = squares - at(trial)[0]
        short = np.linalg.norm(step) < converged * np.linalg.norm(pulse / spreads)
        if gained > 0.0:
            ends = short or gained < 1e-8 * squares
            share = min(gained / max(step @ (damping * step - gradient), 1e-300), 1.0)
            damping, growth = damping * max(1.0 / 3.0, 1.0 - (2.0 * share - 1.0) ** 3), 2.0
            pulse, (squares, normal, gradient) = trial, at(trial)
        else:
            ends = short or damping > 1e12
            damping, growth = damping * growth, 2.0 * growth
        if ends:
            break
    return pulse, squares


SPIKE, RISING, RINGING = (
    np.exp(-(((TIME - 1.0) / 0.02) ** 2)),
    np.clip(TIME - 0.7, 0.0, None),
    SmoothPulse(1.0, 0.4, 1.1, 0.3, 1.7).at(TIME) + 0.2 * np.sin(9.0 * TIME),
)


@pytest.mark.parametrize("values", [SPIKE, RISING, RINGING])
@pytest.mark.parametrize("power", [0.6, 2.5])
def test_each_step_of_the_fit_is_that_of_marquardt_and_nielsen(values, power):
    """Where the fit may take two to fifty evaluations, within bounds that some of the parameters come to."""
    time = (TIME - 0.5) / 0.8
    low, high = pulse_shape.LOWEST.copy(), pulse_shape.HIGHEST.copy()
    low[1], high[1] = time[0] - 0.5, time[-1]
    start = np.array([1.0, -0.1, 1.2, 0.5, power])
    for rounds, converged in ((2, 1e-6), (3, 1e-6), (5, 1e-6), (9, 1e-6), (16, 1e-6), (50, 1e-2), (50, 1e-6)):
        found = kernels.fit_pulse(time, values, start, low, high, pulse_shape.SPREADS, rounds, converged)
        expected = marquardt(time, values, start, low, high, pulse_shape.SPREADS, rounds, converged)
        # rounding grows with the condition of the matrix
        assert found[0] == pytest.approx(expected[0], rel=1e-6, abs=1e-8)
        assert found[1] == pytest.approx(expected[1], rel=1e-8, abs=1e-15)


def test_a_pulse_may_begin_half_its_guessed_length_before_its_samples_and_is_the_best_of_three_fits():
    """One that is cut in its rise; and a flat one, which the fit from a pointed beginning misses."""
    cut = SmoothPulse(3.0, -0.35, 1.3, 0.5, 1.0)
    fitted = fit_smooth_pulse(TIME, cut.at(TIME), 0.0, 0.8)
    assert np.array(fitted[:5]) == pytest.approx(np.array(cut[:5]), rel=1e-4)
    far = fit_smooth_pulse(TIME, SmoothPulse(3.0, -0.9, 2.2, 0.5, 1.0).at(TIME), 0.0, 0.8)
    assert far.begin == pytest.approx(-0.4)
    for values in (SPIKE, RINGING):
        fitted = fit_smooth_pulse(TIME, values, 0.5, 0.8)
        time, low, high = (TIME - 0.5) / 0.8, pulse_shape.LOWEST.copy(), pulse_shape.HIGHEST.copy()
        low[1], high[1] = time[0] - 0.5, time[-1]
        scale = np.max(values)
        squares = [
            marquardt(time, values / scale, start, low, high, pulse_shape.SPREADS, 50, 1e-6)[1]
            for start in np.clip(pulse_shape.STARTS, low, high)
        ]
        assert (fitted.misfit * fitted.peak) ** 2 * TIME.size == pytest.approx(min(squares) * scale**2, rel=1e-6)
