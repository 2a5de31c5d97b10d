"""Uncertainty budgets: published examples, closed forms, and planted records whose every contribution is drawn."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from strikewave.records.budget import (
    DIVISORS,
    BlowStretch,
    Budget,
    Contribution,
    InputQuantity,
    changed,
    law_of_propagation,
    monte_carlo,
)
from strikewave.records.measured_uncertainty import ReadOff, blow_uncertainty, read_off
from strikewave.records.measuring import find_pulses
from strikewave.records.pulse_shape import SmoothPulse
from strikewave.records.record import Channel
from strikewave.signal.pulse import measure_pulse


def _sum(x):
    return np.sum(x, axis=1, keepdims=True)


def _four(distribution, last=1.0):
    """Return four inputs of standard uncertainty 1, the last one of another."""
    return [
        InputQuantity(f"X{k}", u * DIVISORS[distribution], distribution) for k, u in enumerate([1.0, 1.0, 1.0, last])
    ]


@pytest.mark.parametrize(
    ("distribution", "last", "standard", "end", "by_law", "sound"),
    [
        # JCGM 101:2008, clause 9.2, tables 2 to 4: standard uncertainty and end of the interval of 95 %, by Monte Carlo and
        # by the law of propagation, and whether that is validated there (to one digit of the standard uncertainty).
        ("normal", 1.0, 2.00, 3.92, 3.92, True),
        ("rectangular", 1.0, 2.00, 3.88, 3.92, True),
        ("rectangular", 10.0, 10.1, 17.0, 19.9, False),
    ],
)
def test_additive_models_of_jcgm_101_clause_9_2(distribution, last, standard, end, by_law, sound):
    inputs = _four(distribution, last)
    law, found = law_of_propagation(_sum, inputs), monte_carlo(_sum, inputs, seed=1, tolerance=0.01)
    # 1 % is asked of Monte Carlo, and the tables have three digits
    assert found.stable
    assert found.standard[0] == pytest.approx(standard, rel=0.01)
    assert found.high[0] == pytest.approx(end, abs=0.01 * standard + 0.05)
    assert found.low[0] == pytest.approx(-end, abs=0.01 * standard + 0.05)
    assert 1.96 * law.standard[0] == pytest.approx(by_law, abs=0.05)
    assert bool(found.validates(law)[0]) is sound


def test_mass_calibration_of_jcgm_101_clause_9_3():
    """A model that is not linear: the first-order law misses a third of the uncertainty, as the example shows."""
    inputs = [
        InputQuantity("m_R", 0.050, "normal", 100_000.0),
        InputQuantity("dm_R", 0.020, "normal", 1.234),
        InputQuantity("rho_a", 0.10, "rectangular", 1.20),
        InputQuantity("rho_W", 1e3, "rectangular", 8e3),
        InputQuantity("rho_R", 50.0, "rectangular", 8e3),
    ]

    def mass(x):
        nominal, added, air, weight, reference = x.T
        return ((nominal + added) * (1.0 + (air - 1.2) * (1.0 / weight - 1.0 / reference)) - 100_000.0)[:, None]

    law, found = law_of_propagation(mass, inputs), monte_carlo(mass, inputs, seed=2, tolerance=0.01)
    assert law.standard[0] == pytest.approx(0.0539, abs=5e-5)
    assert found.mean[0] == pytest.approx(1.234, abs=0.001)
    assert found.standard[0] == pytest.approx(0.0754, rel=0.01)  # what is asked
    assert (found.low[0], found.high[0]) == pytest.approx((1.0834, 1.3825), abs=0.01 * 0.0754 + 1e-3)
    assert not found.validates(law)[0]


@pytest.mark.parametrize("distribution", ["normal", "rectangular", "triangular", "u-shaped"])
def test_draws_have_the_standard_uncertainty_of_their_distribution(distribution):
    drawn = InputQuantity("x", 0.3, distribution, 5.0).drawn(np.random.default_rng(1), 200_000)
    standard = InputQuantity("x", 0.3, distribution).standard
    assert np.std(drawn) == pytest.approx(standard, rel=0.01)  # six standard deviations of that of 200 000 draws
    assert np.mean(drawn) == pytest.approx(5.0, abs=6.0 * standard / math.sqrt(200_000))
    if distribution != "normal":
        assert np.max(np.abs(drawn - 5.0)) == pytest.approx(0.3, rel=0.02)


STEP, LENGTH, PEAK = 2e-6, 1e-3, 5e3


def _record(noise=0.0, seed=0, step=STEP):
    time = np.arange(-12e-3, 4e-3, step)
    blow = np.where((time > 0.0) & (time < LENGTH), PEAK * np.sin(np.pi * time / LENGTH), 0.0)
    return Channel("a", blow + noise * np.random.default_rng(seed).standard_normal(time.size), step, -12e-3)


def _found(*contributions, channel=None, **options):
    channel = channel or _record()
    [pulse] = find_pulses(channel.values, channel.step, channel.start)
    return pulse, blow_uncertainty(channel, pulse, Budget(contributions), **options).figures


GAIN = Contribution("sensitivity", "certificate", 0.02)


def test_a_gain_alone_is_the_share_itself():
    pulse, found = _found(GAIN)
    # 1e-6: the instants of a clean record of 500 samples do nothing more
    assert found["peak"].standard == pytest.approx(0.02 * pulse.peak, rel=1e-6)
    beyond = pulse.uncertainty.velocity_change  # the area beyond the feet, 0.02 %
    assert beyond == pytest.approx(0.0002 * pulse.velocity_change, rel=0.05)
    assert found["velocity_change"].standard == pytest.approx(
        math.hypot(0.02 * pulse.velocity_change, beyond), rel=1e-6
    )
    assert found["peak"].expanded == pytest.approx(0.04 * pulse.peak, rel=1e-6)
    first = found["peak"].contributions[0]
    assert (first.name, first.standard) == ("certificate", pytest.approx(0.02 * pulse.peak))
    assert found["width"].standard < 1e-6 * pulse.width


def test_contributions_add_in_quadrature_and_a_rectangle_counts_a_over_root_three():
    others = Contribution("amplifier", "gain", 0.03, "rectangular"), Contribution("transverse", "t", 0.01, "u-shaped")
    pulse, found = _found(GAIN, *others)
    together = math.sqrt(0.02**2 + 0.03**2 / 3.0 + 0.01**2 / 2.0)
    assert found["peak"].standard / pulse.peak == pytest.approx(together, rel=1e-6)
    assert sum(row.share for row in found["peak"].contributions) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("contribution", "peak", "width", "velocity"),
    [
        # of a half-sine of peak A and length T, by a share e of it; the width lies between the crossings of 10 %
        (Contribution("offset", "zero", 0.01), 0.01, None, 0.01 * math.pi / 2.0),
        (Contribution("drift", "shift", 0.01), 0.005, None, 0.01 * math.pi / 4.0),
        (Contribution("linearity", "bend", 0.01), 0.01, None, 0.01 * math.pi / 4.0),
        (Contribution("clock", "clock", 0.01), 0.0, 0.01, 0.01),
        # y + e v / tau: at the peak v is half of 2 A T / pi, over the pulse its mean is
        (Contribution("coupling", "ac", 0.1, time_constant=0.1), 0.1 * 0.01 / math.pi, None, 0.1 * 0.01 / 2.0),
    ],
)
def test_changes_of_a_half_sine_have_their_closed_forms(contribution, peak, width, velocity):
    pulse, found = _found(contribution)
    # 1 %: second order of the changes, and the foot, where 2 % of the peak is left
    assert found["peak"].standard / pulse.peak == pytest.approx(peak, rel=0.01, abs=1e-7)
    [by_it] = [row.standard for row in found["velocity_change"].contributions if row.name == contribution.name]
    assert by_it / pulse.velocity_change == pytest.approx(velocity, rel=0.02)
    if width is not None:
        assert found["width"].standard / pulse.width == pytest.approx(width, rel=1e-6)


def test_an_offset_moves_the_width_by_the_slopes_at_a_tenth():
    _, found = _found(Contribution("offset", "zero", 0.005))
    # w = T (1 - 2 asin(s)/pi) with s = 0.1 (1 + e) - e: dw = -2T/(pi sqrt(1 - s^2)) ds, ds = -0.9 e
    slope = 2.0 * LENGTH / (math.pi * math.sqrt(1.0 - 0.01))
    assert found["width"].standard == pytest.approx(slope * 0.9 * 0.005, rel=0.01)  # e bends the flank by its square


@pytest.mark.parametrize("kind", ["resonance", "filter", "response"])
def test_changes_of_the_spectrum_are_their_gain_for_a_slow_swing(kind):
    time = np.arange(20_000) * 1e-6
    swing = BlowStretch(np.sin(2.0 * np.pi * 1e3 * time), 1e-6, 1.0, 0.0, 19_999.0)
    one = Contribution(kind, kind, 1.0, frequency=8e3, order=2.0, quality=30.0, tolerances=((500.0, 0.01), (2e3, 0.05)))
    found = float(np.max(changed(swing, [one], np.array([[0.1]]))[0, 5_000:15_000]))
    ratio = 1.0 / 8.0
    wanted = {
        "resonance": ((1.0 - ratio**2) ** 2 + (ratio / 30.0) ** 2) ** -0.05,
        "filter": math.sqrt((1.0 + ratio**4) / (1.0 + (ratio / 1.1) ** 4)),
        "response": 1.0 + 0.1 * 0.03,  # the middle of both frequencies on a logarithmic axis
    }[kind]
    assert found - 1.0 == pytest.approx(wanted - 1.0, rel=0.02)  # a padded stretch leaks a little


def test_instants_of_sampling_move_the_peak_as_a_parabola_through_three_samples_misses_it():
    """Of ten samples a pulse, the figures of all places of a half-sine scatter as the budget of one says."""
    channel = _record(step=LENGTH / 10.0)
    places = np.linspace(-0.5, 0.5, 41)[:-1] * channel.step
    found = []
    for place in places:
        time = channel.time + place
        values = np.where((time > 0.0) & (time < LENGTH), PEAK * np.sin(np.pi * time / LENGTH), 0.0)
        [pulse] = find_pulses(values, channel.step, channel.start)
        found.append(pulse.width)
    _, uncertainty = _found(channel=channel)
    assert uncertainty["width"].standard == pytest.approx(
        np.std(found), rel=1.0
    )  # its size: a corner is no band-limited one


def test_noise_of_each_sample_goes_into_the_area_by_its_root():
    pulse, found = _found(Contribution("noise", "recorder", 0.01))
    samples = (pulse.end - pulse.begin) / STEP
    wanted = math.hypot(0.01 * PEAK * STEP * math.sqrt(samples), pulse.uncertainty.velocity_change)
    assert found["velocity_change"].standard == pytest.approx(wanted, rel=0.01)


WHOLE = (
    GAIN,
    Contribution("linearity", "linearity", 0.01, "rectangular"),
    Contribution("resonance", "mounting", 1.0, "rectangular", frequency=60e3, quality=30.0),
    Contribution("filter", "anti-alias filter", 0.1, "rectangular", frequency=10e3, order=4.0),
    Contribution("offset", "zero", 0.005, "rectangular"),
    Contribution("clock", "clock", 1e-4, "rectangular"),
)


@pytest.mark.verify
def test_monte_carlo_validates_the_law_of_propagation_where_no_rectangle_dominates():
    channel = _record(noise=10.0)
    [pulse] = find_pulses(channel.values, channel.step, channel.start)
    found = blow_uncertainty(channel, pulse, Budget(WHOLE), trials=True, seed=3)
    assert found.trials >= 20_000
    assert found.validated["peak"]
    assert found.validated["velocity_change"]
    assert found.figures["peak"].method == found.figures["velocity_change"].method == "law of propagation"
    # a rectangle that dominates: whether it is near enough to a normal figure is a matter of the tolerance
    assert found.figures["width"].contributions[0].name == "zero"


def test_one_rectangle_that_dominates_is_no_normal_figure():
    """Its interval of 95 % is 0.95 a, not 2 a/sqrt(3): Monte Carlo finds it, and counts."""
    channel = _record()
    [pulse] = find_pulses(channel.values, channel.step, channel.start)
    one = Contribution("amplifier", "gain", 0.05, "rectangular")
    found = blow_uncertainty(channel, pulse, Budget((one,)), trials=True)
    assert found.figures["peak"].method == "Monte Carlo"
    assert found.figures["peak"].expanded == pytest.approx(0.95 * 0.05 * pulse.peak, rel=0.02)  # 1.3 % is asked
    assert found.figures["peak"].coverage == pytest.approx(0.95 * math.sqrt(3.0), rel=0.02)


def test_equal_seeds_give_equal_trials():
    first, second, other = (monte_carlo(_sum, _four("rectangular"), seed) for seed in (5, 5, 6))
    assert np.array_equal(first.low, second.low)
    assert first.trials == second.trials
    assert first.low[0] != other.low[0]


def test_where_too_little_lies_before_a_blow_its_uncertainty_is_not_known_unless_the_budget_states_it():
    channel = _record()
    late = Channel("a", channel.values[channel.time > -3e-3], STEP, -3e-3)  # three widths before the blow
    _, found = _found(GAIN, channel=late)
    assert all(math.isnan(one.expanded) for one in found.values())
    _, found = _found(GAIN, Contribution("offset", "zero", 0.01), channel=late)
    assert found["peak"].standard == pytest.approx(PEAK * math.hypot(0.02, 0.01), rel=0.01)
    assert math.isnan(next(row.standard for row in found["peak"].contributions if row.name == "noise and baseline"))
    _, found = _found(Contribution("acceleration", "all", 0.02), channel=late)
    assert found["peak"].standard == pytest.approx(PEAK * 0.02, rel=0.01)
    assert math.isnan(found["width"].standard)


def test_a_blow_that_is_cut_has_no_width_and_costs_no_more_trials():
    channel = _record()
    cut = Channel("a", channel.values[channel.time < 0.8 * LENGTH], STEP, channel.start)
    [pulse] = find_pulses(cut.values, cut.step, cut.start)
    found = blow_uncertainty(cut, pulse, Budget((GAIN,)), trials=True)
    assert found.trials <= 100_000  # of a million at most
    assert math.isnan(found.figures["width"].expanded)
    assert found.figures["peak"].standard == pytest.approx(0.02 * pulse.peak, rel=1e-3)


def test_figures_of_a_negative_blow_keep_their_sign():
    channel = _record()
    pulse, found = _found(*WHOLE, channel=replace(channel, values=-channel.values))
    _, upwards = _found(*WHOLE)
    assert found["peak"].value == pulse.peak < 0.0
    assert found["velocity_change"].value == pulse.velocity_change < 0.0
    assert found["width"].value == pulse.width > 0.0
    assert [one.standard for one in found.values()] == pytest.approx([one.standard for one in upwards.values()])


def test_rows_are_read_off_as_records_are_measured():
    generator = np.random.default_rng(3)
    place = np.arange(400)
    for _ in range(40):
        rise, length, power = generator.uniform(0.2, 0.8), generator.uniform(60.0, 200.0), generator.uniform(0.8, 2.5)
        row = SmoothPulse(generator.uniform(1.0, 9.0), generator.uniform(60.0, 150.0), length, rise, power).at(
            1.0 * place
        )
        row += 0.03 * np.sin(place / generator.uniform(5.0, 40.0))
        known = measure_pulse(row, 1.0)
        [[peak, width, area]] = read_off(row[None, :], ReadOff(slice(0, 400), 12.3, 371.8, 1.0))
        assert (peak, width) == pytest.approx((known.peak, known.width), rel=1e-12)
        grid = np.concatenate([[12.3], np.arange(13, 372), [371.8]])
        assert area == pytest.approx(float(np.trapezoid(np.interp(grid, place, row), grid)), rel=1e-9)


def test_what_is_not_stated_is_listed():
    assert "temperature" in Budget(WHOLE).not_stated
    assert "calibration of the sensor" not in Budget(WHOLE).not_stated
    assert Budget((Contribution("acceleration", "all", 0.05),)).not_stated == ()


@pytest.mark.verify
def test_expanded_uncertainty_holds_planted_blows_whose_chain_is_drawn():
    """300 records through drawn chains: true figures lie within k = 2 as often as 95 % says."""
    generator = np.random.default_rng(11)
    clean = _record()
    [truth] = find_pulses(clean.values, clean.step, clean.start)
    names = ("peak", "width", "velocity_change")
    inside = np.zeros(3)
    count = 300
    for _ in range(count):
        drawn = np.array([[one.input.drawn(generator, 1)[0] for one in WHOLE]])
        begin = (truth.begin - clean.start) / STEP
        stretch = BlowStretch(clean.values, STEP, PEAK, begin, begin + LENGTH / STEP)
        values = changed(stretch, WHOLE, drawn)[0] * (1.0 + drawn[0, 0])
        values = values - drawn[0, 4] * PEAK * (
            clean.time < -2e-3
        )  # a zero that shifted: the baseline does not show it
        values += 5.0 * generator.standard_normal(values.size)
        record = Channel("a", values, STEP * (1.0 + drawn[0, 5]), clean.start)
        [pulse] = find_pulses(record.values, record.step, record.start)
        found = blow_uncertainty(record, pulse, Budget(WHOLE)).figures
        for k, name in enumerate(names):
            inside[k] += abs(getattr(pulse, name) - getattr(truth, name)) <= found[name].expanded
    # 95 % of 300, and three standard deviations of that to both sides (3.8 %); above, as flat distributions are held more
    assert np.all(inside / count >= 0.91), inside / count
