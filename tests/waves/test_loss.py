"""Loss in the time domain: constant over its band, passive, causal, and the same as the work of a cycle."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave.waves import spectral
from strikewave.waves.layers import Branch
from strikewave.waves.spectral import dynamic_stiffness, fit_loss


def test_a_single_branch_is_the_standard_linear_solid():
    # loss factor of the Zener solid peaks at w tau = 1/sqrt(1 + k1/k) with (k1/k) / (2 sqrt(1 + k1/k))
    k, k1, tau = 2.0, 3.0, 1e-4
    peak = 1.0 / (2.0 * math.pi * tau * math.sqrt(1.0 + k1 / k))
    K = dynamic_stiffness(k, (Branch(k1, tau),), [peak, 1e-3, 1e12])
    assert K[0].imag / K[0].real == pytest.approx(k1 / k / (2.0 * math.sqrt(1.0 + k1 / k)), rel=1e-14)
    assert K[1].real == pytest.approx(k, rel=1e-9)
    assert K[2].real == pytest.approx(k + k1, rel=1e-9)


@pytest.mark.parametrize(
    ("loss_factor", "low", "high", "branches"),
    [(0.02, 1e4, 1e5, 2), (0.3, 1e4, 1e5, 2), (0.02, 1e3, 1e5, 3), (0.2, 1e3, 1e5, 3), (0.5, 1e3, 1e5, 4)],
)
def test_few_branches_hold_five_percent(loss_factor, low, high, branches):
    fit = fit_loss(4e6, loss_factor, low, high)
    assert len(fit.branches) == branches
    f = np.geomspace(low, high, 1999)
    wt = 2.0 * np.pi * f[:, None] * np.array([b.relaxation for b in fit.branches])
    shares = np.array([b.stiffness for b in fit.branches])
    storage = fit.stiffness + (wt**2 / (1 + wt**2)) @ shares
    spectral = (wt / (1 + wt**2)) @ shares
    # the fit looks at 121 frequencies; between them the deviation is flat to the square of their distance
    assert np.max(np.abs(spectral / storage / loss_factor - 1.0)) == pytest.approx(fit.error, rel=2e-3)
    assert fit.error <= 0.05
    assert fit.band == (low, high)


@settings(max_examples=8)
@given(st.floats(1e-3, 0.9), st.floats(0.5, 2.0), st.floats(1.0, 1e5))
def test_passive_at_every_frequency(loss_factor, decades, low):
    fit = fit_loss(1.0, loss_factor, low, low * 10.0**decades)
    assert fit.stiffness > 0.0
    assert all(b.stiffness > 0.0 and b.relaxation > 0.0 for b in fit.branches)
    K = dynamic_stiffness(fit.stiffness, fit.branches, np.geomspace(1e-6 * low, 1e8 * low, 500))
    assert np.all(K.imag > 0.0)
    assert np.all(np.diff(K.real) > -1e-12)  # a passive causal solid stiffens with frequency


@settings(max_examples=8)
@given(st.floats(1e-3, 0.9), st.floats(1e-3, 1e12), st.floats(10.0, 1e5))
def test_storage_stiffness_is_met_at_the_middle_of_the_band(loss_factor, stiffness, low):
    fit = fit_loss(stiffness, loss_factor, low, 100.0 * low)
    K = dynamic_stiffness(fit.stiffness, fit.branches, 10.0 * low)
    assert K.real == pytest.approx(stiffness, rel=1e-12)


@settings(max_examples=8)
@given(st.floats(0.01, 0.5))
def test_stiffness_rises_as_causality_asks(loss_factor):
    # constant loss needs K ~ f^((2/pi) atan eta) (Kjartansson 1979); the fit ripples by its 5 % about that
    fit = fit_loss(1.0, loss_factor, 1e3, 1e5)
    K = dynamic_stiffness(fit.stiffness, fit.branches, [10**3.5, 10**4.5]).real
    assert math.log10(K[1] / K[0]) == pytest.approx(2.0 / math.pi * math.atan(loss_factor), rel=0.05)


@pytest.mark.verify
def test_work_of_a_cycle_is_that_of_the_loss():
    # the branches as differential equations in time, solved apart from dynamic_stiffness; W = pi Im K X^2
    fit = fit_loss(1.0, 0.3, 1e3, 1e5)
    f = 2e4
    w = 2.0 * math.pi * f
    shares = np.array([b.stiffness for b in fit.branches])
    tau = np.array([b.relaxation for b in fit.branches])

    def rates(t, y):
        speed = w * math.cos(w * t)
        force = fit.stiffness * math.sin(w * t) + np.sum(y[:-1])
        return np.append(shares * speed - y[:-1] / tau, force * speed)

    settled = 100.0 / f  # the longest relaxation has died by e^-20 and more
    assert settled > 20 * tau.max()
    y = solve_ivp(rates, (0.0, settled), np.zeros(tau.size + 1), rtol=1e-10, atol=1e-12, method="DOP853").y[:, -1]
    cycle = solve_ivp(
        rates, (settled, settled + 1.0 / f), np.append(y[:-1], 0.0), rtol=1e-11, atol=1e-13, method="DOP853"
    )
    K = dynamic_stiffness(fit.stiffness, fit.branches, f)
    assert cycle.y[-1, -1] == pytest.approx(math.pi * K.imag, rel=1e-7)


def test_no_loss_needs_no_branch():
    assert fit_loss(5.0, 0.0, 1e3, 1e5) == (5.0, (), 0.0, (1e3, 1e5))


def test_what_four_branches_cannot_hold_to_five_percent_says_so():
    fit = fit_loss(1.0, 0.1, 1e2, 1e6)
    assert len(fit.branches) == 4
    assert 0.05 < fit.error < 0.15


@pytest.mark.parametrize(
    ("values", "word"),
    [
        ((1.0, 5.0, 1e2, 1e6), "smaller loss factor or a narrower band"),
        ((0.0, 0.1, 1e3, 1e5), "stiffness"),
        ((math.inf, 0.1, 1e3, 1e5), "stiffness"),
        ((1.0, -0.1, 1e3, 1e5), "loss factor"),
        ((1.0, math.nan, 1e3, 1e5), "loss factor"),
        ((1.0, 0.1, 1e5, 1e3), "band"),
        ((1.0, 0.1, 0.0, 1e3), "band"),
    ],
)
def test_bad_values_are_refused_in_words(values, word):
    with pytest.raises(ValueError, match=word):
        fit_loss(*values)


# the fit of one set of relaxation times


@pytest.mark.parametrize(
    ("eta", "low", "high", "count", "width"),
    [
        (0.3, 1e3, 1e5, 4, 0.7),
        (0.05, 2e2, 9e3, 3, 0.9),
        (0.7, 1e3, 1e4, 2, 0.4),
        (0.2, 1e3, 3e4, 1, 1.0),
        (0.3, 1e3, 1e5, 4, 1.9),
    ],
)
def test_a_fit_is_the_best_one_that_is_not_negative(eta, low, high, count, width):
    """Karush, Kuhn and Tucker: of |(Im K/eta - Re K)/Re K|^2 at 121 frequencies with Re K = 1 in the middle of the band.

    The slope along every share that is above zero is that of the scale, and no smaller along one that is zero. Six rounds
    of weights leave 1e-5 of them.
    """
    deviation, shares, times = spectral._least_squares(eta, low, high, count, width)
    middle = math.sqrt(low * high)
    if count > 1:
        assert times[0] / times[-1] == pytest.approx((high / low) ** width, rel=1e-12)
    assert times * times[::-1] == pytest.approx((2.0 * math.pi * middle) ** -2.0, rel=1e-12)
    assert np.ptp(np.diff(np.log(times))) < 1e-9 if count > 1 else True

    def stiffness(f):
        return np.column_stack([np.ones(len(f)), *(dynamic_stiffness(0.0, (Branch(1.0, tau),), f) for tau in times)])

    K = stiffness(np.geomspace(low, high, 121))
    at_middle = stiffness(np.array([middle]))[0].real
    assert at_middle @ shares == pytest.approx(1.0, rel=1e-12)
    total = K @ shares
    assert deviation == pytest.approx(np.abs(total.imag / total.real / eta - 1.0).max(), rel=1e-12)
    rows = (K.imag / eta - K.real) / total.real[:, None]
    slope = rows.T @ (rows @ shares)
    beyond = slope - (shares @ slope) * at_middle
    size = np.abs(rows.T @ rows).max()
    assert np.abs(beyond[shares > 0.0]).max() < 1e-6 * size
    assert beyond.min() > -1e-6 * size
    assert shares.min() >= 0.0
    assert shares[0] > 0.0


def test_the_fewest_branches_at_the_best_width_are_taken(monkeypatch):
    """Made-up fits: two branches miss 5 %, of three those of a width of 0.5; a solid that would creep does not count."""
    asked = []

    def fitted(eta, low, high, count, width):
        asked.append((count, width))
        off = {1: 0.3, 2: 0.051, 3: 0.01}[count] + 0.001 * abs(width - 0.5)
        rest = 9e-4 if count == 3 and width < 0.5 else 1.1e-3
        return off, np.array([rest, *([0.4] * (count - 1)), 0.0]), np.array([3.0, 2.0, 1.0])[:count]

    monkeypatch.setattr(spectral, "_least_squares", fitted)
    share, branches, error = spectral._shares.__wrapped__(0.2, 1e3, 1e5)
    best = min(width for width in spectral.WIDTHS if width >= 0.5)
    assert (share, error) == (1.1e-3, pytest.approx(0.01 + 0.001 * (best - 0.5), rel=1e-12))
    assert branches == (Branch(0.4, 3.0), Branch(0.4, 2.0))  # a branch of no stiffness is none
    assert asked == [(1, 1.0), *((count, width) for count in (2, 3) for width in spectral.WIDTHS)]
    assert spectral.WIDTHS[[0, -1]] == pytest.approx([0.3, 2.0])


@pytest.mark.parametrize(("off", "taken"), [(0.249, True), (0.251, False), (None, False)])
def test_the_loss_of_another_material_is_refused_with_how_close_it_came(monkeypatch, off, taken):
    rest, counts = 0.5 if off else 9e-4, set()

    def fitted(eta, low, high, count, width):
        counts.add(count)
        return off or 0.0, np.array([rest, 0.5]), np.array([1.0])

    monkeypatch.setattr(spectral, "_least_squares", fitted)
    if taken:
        assert spectral._shares.__wrapped__(0.2, 1e3, 1e5)[2] == off
        assert counts == {1, 2, 3, 4}
        return
    words = r"branches \(the closest is 25 % off\): take" if off else "branches: take"
    with pytest.raises(ValueError, match=words):
        spectral._shares.__wrapped__(0.2, 1e3, 1e5)


@pytest.mark.parametrize("values", [(5e-3, 5e-3, 5e-3, 9e-3), (7.0, 5e-3, 1e3, 1e5)])
def test_small_values_have_a_fit_of_their_own_scale(values):
    fit = fit_loss(*values)
    K = dynamic_stiffness(fit.stiffness, fit.branches, math.sqrt(values[2] * values[3]))
    assert K.real == pytest.approx(values[0], rel=1e-9)
    assert K.imag / K.real == pytest.approx(values[1], rel=0.06)
    assert fit_loss(values[0], 0.0, *values[2:]).stiffness == values[0]
