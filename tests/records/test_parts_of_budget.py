"""Budgets part by part: what each contribution does to a few samples, by hand, and what is made of its figures."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.base import declare
from strikewave.base.errors import InputError
from strikewave.records import budget, measured_uncertainty
from strikewave.records.budget import (
    GAINS,
    TOPICS,
    BlowStretch,
    Budget,
    Contribution,
    InputQuantity,
    Propagated,
    Simulated,
    changed,
    factors_of,
    law_of_propagation,
    monte_carlo,
    of_share,
)
from strikewave.records.measured_uncertainty import BlowUncertainty, BudgetLine, FigureUncertainty, ReadOff
from strikewave.records.measuring import find_pulses
from strikewave.records.record import Channel

NAN = math.nan

# The law of propagation and Monte Carlo


@pytest.mark.parametrize(
    ("distribution", "divisor"),
    [("normal", 1.0), ("rectangular", math.sqrt(3.0)), ("triangular", math.sqrt(6.0)), ("u-shaped", math.sqrt(2.0))],
)
def test_draws_have_middle_bounds_and_spread_of_their_distribution(distribution, divisor):
    one = InputQuantity("x", 0.6, distribution, 5.0)
    drawn = one.drawn(np.random.default_rng(2), 4000)
    assert one.standard == pytest.approx(0.6 / divisor)
    assert np.std(drawn) == pytest.approx(
        one.standard, rel=0.05
    )  # four of its standard uncertainties, 1 / sqrt(2 x 4000)
    assert np.mean(drawn) == pytest.approx(5.0, abs=5.0 * one.standard / math.sqrt(4000))
    if distribution != "normal":
        assert np.max(np.abs(drawn - 5.0)) <= 0.6
        assert np.ptp(drawn) > 1.1


def test_a_law_takes_half_of_what_a_standard_uncertainty_changes_to_both_sides():
    """x y^2 at 3 and 4: 16 u(x), and 3 (2 x 4 u(y)); the square of u(y) cancels."""
    found = law_of_propagation(
        lambda x: x[:, :1] * x[:, 1:] ** 2,
        [InputQuantity("x", 0.3, estimate=3.0), InputQuantity("y", 0.6, "rectangular", 4.0)],
    )
    assert found.estimate.tolist() == [48.0]
    assert found.contributions[:, 0] == pytest.approx([16.0 * 0.3, 24.0 * 0.6 / math.sqrt(3.0)])
    assert found.standard == pytest.approx([math.hypot(4.8, 24.0 * 0.6 / math.sqrt(3.0))])


@pytest.mark.parametrize(("off", "sound"), [(0.24, True), (0.26, False), (-0.24, True), (-0.26, False)])
def test_intervals_agree_within_a_quarter_of_a_standard_uncertainty(off, sound):
    propagated = Propagated(np.array([10.0]), np.array([[3.0], [4.0]]))
    half = 1.959964 * 5.0

    def simulated(low, high):
        return Simulated(
            np.array([10.0]), np.array([2.0]), np.array([10.0 - half + low]), np.array([10.0 + half + high]), 1, True
        )

    assert simulated(2.0 * off, 0.0).validates(propagated).tolist() == [sound]
    assert simulated(0.0, 2.0 * off).validates(propagated).tolist() == [sound]


def test_trials_are_added_until_all_is_known(monkeypatch):
    monkeypatch.setattr(budget, "TRIALS", 100)
    calls = []

    def model(rows):
        calls.append(len(rows))
        return np.column_stack([np.linspace(0.0, 1.0, len(rows)), np.full(len(rows), NAN)])

    found = monte_carlo(model, [InputQuantity("x", 1.0)], most=1000)
    assert (calls, found.trials, found.stable) == ([100, 100], 200, True)  # the batches are alike
    assert found.low[0] == pytest.approx(0.025, abs=0.006)
    assert found.high[0] == pytest.approx(0.975, abs=0.006)
    assert found.mean[0] == pytest.approx(0.5)
    assert found.standard[0] == pytest.approx(np.std(np.tile(np.linspace(0.0, 1.0, 100), 2), ddof=1))
    calls.clear()
    loud = iter(range(1000))
    found = monte_carlo(lambda rows: np.full((len(rows), 1), float(next(loud))), [InputQuantity("x", 1.0)], most=350)
    assert (found.trials, found.stable) == (400, False)


@pytest.mark.parametrize(("apart", "stable"), [(0.038, True), (0.042, False)])
def test_what_batches_differ_by_is_held_against_the_tolerance(monkeypatch, apart, stable):
    """Two batches whose means are d apart: twice their standard deviation over root two is d; a spread of 0.8, a twentieth."""
    monkeypatch.setattr(budget, "TRIALS", 100)
    batches = iter([np.tile([-0.8, 0.8], 50) + side * apart for side in (-0.5, 0.5, -0.5, 0.5)])
    found = monte_carlo(lambda rows: next(batches)[:, None], [InputQuantity("x", 1.0)], tolerance=0.05, most=200)
    assert found.stable is stable


# Contributions

BLOW = np.array([0.0, 1.0, 4.0, 2.0, 0.0])
STRETCH = BlowStretch(BLOW, 0.5, 8.0, 1.0, 3.0)
DRAWN = np.array([[0.5], [-0.25]])


@pytest.mark.parametrize(
    ("one", "expected"),
    [
        (Contribution("offset", "o", 1.0), [BLOW + 4.0, BLOW - 2.0]), (Contribution("offset", "o", 1.0, relative=False), [BLOW + 0.5, BLOW - 0.25]),
        (Contribution("drift", "d", 1.0), [BLOW + 4.0 * np.array([0, 0, 0.5, 1, 1]), BLOW - 2.0 * np.array([0, 0, 0.5, 1, 1])]),
        (Contribution("linearity", "l", 1.0), [BLOW + 0.5 * BLOW**2 / 8.0, BLOW - 0.25 * BLOW**2 / 8.0]),
        (Contribution("coupling", "c", 1.0, time_constant=2.0), [BLOW + 0.5 * np.array([0, 1, 5, 7, 7]) * 0.5 / 2.0, BLOW - 0.25 * np.array([0, 1, 5, 7, 7]) * 0.25]),
        (Contribution("sensitivity", "s", 1.0), [BLOW, BLOW]), (Contribution("clock", "s", 1.0), [BLOW, BLOW]),
    ],
)  # fmt: skip
def test_what_a_contribution_does_to_five_samples(one, expected):
    np.testing.assert_allclose(changed(STRETCH, [one], DRAWN), expected, atol=1e-14)


def test_gains_and_clocks_multiply():
    kinds = [Contribution(kind, kind, 1.0) for kind in (*budget.GAINS, "clock", "clock", "offset")]
    drawn = np.array([[0.1, 0.2, 0.3, -0.4, 0.5, 0.6, -0.7, 9.0]])
    assert factors_of(GAINS, kinds, drawn) == pytest.approx([1.1 * 1.2 * 1.3 * 0.6 * 1.5])
    assert factors_of(("clock",), kinds, drawn) == pytest.approx([1.6 * 0.3])
    assert factors_of(("clock",), kinds[-1:], drawn[:, -1:]).tolist() == [1.0]


def test_spectra_rise_by_the_logarithm_of_a_known_gain():
    """A Butterworth filter of order 3 at 100 Hz, moved to 120; a resonance of quality 8 at 400 Hz; a response known at two places."""
    f = np.array([50.0, 100.0, 300.0])
    e = np.array([0.2])

    def size(cutoff):
        return 1.0 / np.sqrt(1.0 + (f / cutoff) ** 6)

    found = Contribution("filter", "f", 1.0, frequency=100.0, order=3.0).logarithm(e, f)
    assert found[0] == pytest.approx(np.log(size(120.0) / size(100.0)))
    far = Contribution("filter", "f", 1.0, frequency=100.0, order=300.0).logarithm(e, np.array([1e9]))
    assert far[0] == pytest.approx([300.0 * math.log(1.2)])
    ratio = f / 400.0
    gain = 1.0 / np.abs(1.0 - ratio**2 + 1j * ratio / 8.0)
    found = Contribution("resonance", "r", 1.0, frequency=400.0, quality=8.0).logarithm(e, f)
    assert found[0] == pytest.approx(0.2 * np.log(gain))
    above = Contribution("resonance", "r", 1.0, frequency=100.0, quality=8.0).logarithm(e, np.array([200.0]))
    assert above[0] == pytest.approx([0.0])  # what it takes off above it is left alone
    response = Contribution("response", "r", 1.0, tolerances=((100.0, 0.1), (10000.0, 0.3)))
    assert response.logarithm(e, np.array([0.0, 100.0, 1000.0, 1e5]))[0] == pytest.approx(
        np.log1p(0.2 * np.array([0.1, 0.1, 0.2, 0.3]))
    )


def test_instants_of_sampling_shift_a_stretch_between_its_samples():
    """A Gaussian in the middle of 60 samples, half a sample later and a quarter earlier."""
    t = np.arange(60.0)
    bell = np.exp(-0.5 * ((t - 30.0) / 4.0) ** 2)
    stretch = BlowStretch(bell, 0.5, 1.0, 20.0, 40.0)
    found = changed(stretch, [budget.sampling(0.5)], np.array([[0.25], [-0.125]]))
    for row, shift in zip(found, (0.5, -0.25), strict=True):
        assert row == pytest.approx(np.exp(-0.5 * ((t - 30.0 - shift) / 4.0) ** 2), abs=1e-9)
    one = budget.sampling(0.5)
    assert (one.spread, one.distribution, one.typed) == (0.25, "rectangular", "half of 0.5 s")


def test_two_changes_of_the_spectrum_are_one_after_the_other():
    """Of a level: a response off by a tenth and one off by a fifth; the padding leads from the end back to the begin."""
    stretch = BlowStretch(np.full(20, 3.0), 0.5, 1.0, 5.0, 10.0)
    kinds = [
        Contribution("response", name, 1.0, tolerances=((0.1, share), (1.0, share)))
        for name, share in (("a", 0.1), ("b", 0.2))
    ]
    assert changed(stretch, kinds, np.array([[1.0, 1.0], [0.5, -1.0]])) == pytest.approx(
        np.outer([3.0 * 1.1 * 1.2, 3.0 * 1.05 * 0.8], np.ones(20))
    )
    ramp = BlowStretch(np.linspace(1.0, 3.0, 40), 0.5, 1.0, 5.0, 10.0)
    assert changed(ramp, kinds[:1], np.array([[0.0]]))[0] == pytest.approx(ramp.values)


def test_a_budget_adds_what_it_states_in_amounts():
    budget = Budget((
        Contribution("offset", "o", 3.0, relative=False), Contribution("noise", "n", 4.0 * math.sqrt(3.0), "rectangular", relative=False),
        Contribution("drift", "d", 9.0), Contribution("sensitivity", "s", 5.0, relative=False, status="indicative"),
    ))  # fmt: skip
    assert budget.amount == pytest.approx(5.0)
    assert budget.share is None
    assert budget.indicative == ("s",)
    assert budget.names == ("noise and baseline", "instants of sampling", "o", "n", "d", "s")
    assert len(budget.not_stated) == len(TOPICS) - 2
    assert (of_share(0.06).contributions[0].spread, of_share(0.06).share, of_share(0.06).not_stated) == (0.03, 0.06, ())
    assert of_share(0.06).contributions[0].typed == "6 %, k = 2"
    assert Budget((Contribution("sensitivity", "s", 0.1),)).share is None


def test_a_budget_in_a_document_has_what_is_stated_and_what_the_record_tells():
    one = Contribution("offset", "zero", 3.0, "rectangular", False, "measured", "us", "3 m/s^2")
    document = declare.content(Budget((one, Contribution("clock", "c", 0.5)), "a title", "a.toml"))
    first, second, stated, bare = document["contributions"]
    assert [(row["name"], row["kind"]) for row in (first, second)] == [
        ("noise and baseline", "record"),
        ("instants of sampling", "record"),
    ]
    assert stated == {
        "name": "zero", "kind": "offset", "stated": "3 m/s^2", "distribution": "rectangular",
        "standard": pytest.approx(math.sqrt(3.0)), "status": "measured", "source": "us",
    }  # fmt: skip
    assert (bare["standard"], bare["status"], bare["source"]) == (0.5, None, None)
    assert (document["title"], document["file"]) == ("a title", "a.toml")
    assert len(document["not_stated"]) == len(budget.TOPICS) - 2
    assert [declare.content(Budget(()))[key] for key in ("title", "file")] == [None, None]


# Blows


def test_the_weights_of_an_integral_between_two_places():
    """Straight lines between samples, from 0.5 to 2.25: the integral of any values is that of the lines."""
    values = np.array([2.0, 5.0, 3.0, 7.0])

    def line(x):
        return np.interp(x, np.arange(4.0), values)

    fine = np.linspace(0.5, 2.25, 70001)
    exact = np.sum(0.5 * (line(fine)[1:] + line(fine)[:-1]) * np.diff(fine))
    assert measured_uncertainty._trapezoid(4, 0.5, 2.25) @ values == pytest.approx(exact, rel=1e-9)
    assert measured_uncertainty._trapezoid(4, 0.0, 3.0).tolist() == [0.5, 1.0, 1.0, 0.5]
    assert measured_uncertainty._trapezoid(4, 1.25, 1.75) == pytest.approx([0.0, 0.25, 0.25, 0.0])


def test_rows_have_peak_width_and_area():
    tent = np.interp(np.arange(21.0), [0.0, 10.0, 20.0], [0.0, 4.0, 0.0])
    peak, width, area = measured_uncertainty.read_off(
        np.vstack([tent, 2.0 * tent]), ReadOff(slice(5, 16), 2.0, 18.0, 0.5)
    ).T
    assert width == pytest.approx([0.9 * 20.0 * 0.5] * 2, rel=0.01)
    assert area == pytest.approx(np.array([1.0, 2.0]) * (40.0 - 2.0 * 0.8) * 0.5 / 1.0 * 1.0, rel=0.02)
    assert peak[1] == pytest.approx(2.0 * peak[0])


def half_sine_record(count=400, sign=1.0, step=1e-5, start=7.0, noise=0.0):
    t = np.arange(12 * count)
    u = (t - 10.0 * count) / count
    values = sign * np.where((u > 0.0) & (u < 1.0), 50.0 * np.sin(np.pi * np.clip(u, 0.0, 1.0)), 0.0)
    return Channel("a", values + noise * np.random.default_rng(1).normal(size=t.size), step, start)


@pytest.mark.parametrize(("count", "factor"), [(150, 1), (450, 2), (900, 4)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_long_blows_are_averaged_and_keep_their_figures(count, factor, sign):
    """Two hundred samples a blow and half of its length beside it: peak, width and area are those that were measured."""
    channel = half_sine_record(count, sign)
    (pulse,) = find_pulses(channel.values, channel.step, channel.start)
    found = measured_uncertainty._prepared(channel, pulse)
    assert (found.factor, found.sign) == (factor, sign)
    assert found.stretch.step == pytest.approx(factor * 1e-5)
    assert found.figures == pytest.approx([abs(pulse.peak), pulse.width, abs(pulse.velocity_change)])
    again = measured_uncertainty.read_off(found.stretch.values[None], found.where)[0]
    assert again == pytest.approx(found.figures, rel=2e-3)
    length = (pulse.end - pulse.begin) / channel.step / factor
    assert found.stretch.end - found.stretch.begin == pytest.approx(length, rel=1e-6)
    assert found.stretch.values.size == pytest.approx(2.0 * length + 4.0 / factor, abs=3.0)
    assert found.stretch.begin == pytest.approx(0.5 * length, abs=4.0)
    if factor == 1:  # the last samples that are not nearer than half a length and two samples
        beside = 0.5 * length + 2.0
        assert beside <= found.stretch.begin < beside + 1.0
        assert beside <= found.stretch.values.size - 1 - found.stretch.end < beside + 1.0
    assert np.argmax(found.stretch.values) == pytest.approx(found.stretch.begin + 0.5 * length, abs=1.0)
    assert found.where.inside.stop - found.where.inside.start == pytest.approx(0.5 * length, abs=4.0)


@pytest.mark.parametrize("block", [2, 10**6])
def test_white_noise_of_each_sample_goes_into_the_area_as_its_root(monkeypatch, block):
    """By a hundred samples of half a unit each: 0.5 h sqrt(100), in blocks of any size; averaged over two, the same."""
    monkeypatch.setattr(measured_uncertainty, "LARGEST", block * 300)
    for count in (150, 450):
        channel = half_sine_record(count)
        (pulse,) = find_pulses(channel.values, channel.step, channel.start)
        measured = measured_uncertainty._prepared(channel, pulse)
        found = measured_uncertainty._by_noise(measured, 0.5)
        samples = (pulse.end - pulse.begin) / channel.step
        assert found[2] == pytest.approx(0.5 * 1e-5 * math.sqrt(samples), rel=0.01)
        slope = 50.0 * math.pi / count * math.sqrt(0.99)  # at a tenth of the peak, a sample
        crossing = 0.5 * math.sqrt(2.0) * math.sqrt(2.0 / 3.0) / slope * 1e-5
        assert found[1] == pytest.approx(crossing, rel=0.4)


def test_draws_go_through_blocks_of_any_size(monkeypatch):
    channel = half_sine_record(150)
    (pulse,) = find_pulses(channel.values, channel.step, channel.start)
    measured = measured_uncertainty._prepared(channel, pulse)
    kinds = [
        Contribution("linearity", "l", 0.1),
        Contribution("sensitivity", "s", 0.1),
        Contribution("clock", "c", 0.1),
    ]
    drawn = np.array(
        [[0.0, 0.1, 0.2, 1.0, 2e-5, 3e-5], [0.02, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]]
    )
    whole = measured_uncertainty._model(measured, kinds)(drawn)
    peak, width, area = measured.figures
    assert whole[0] == pytest.approx([1.1 * peak + 1.0, 1.2 * width + 2e-5, 1.1 * 1.2 * area + 3e-5])
    assert whole[1][0] == pytest.approx(1.02 * peak, rel=1e-4)
    assert whole[2] == pytest.approx(measured.figures)
    monkeypatch.setattr(measured_uncertainty, "LARGEST", measured.stretch.values.size)
    assert measured_uncertainty._model(measured, kinds)(drawn) == pytest.approx(whole)
    assert measured_uncertainty._model(measured, kinds[1:])(drawn[:, 1:])[0] == pytest.approx(whole[0])


def line(name, standard, share=0.0):
    return BudgetLine(name, standard, share)


def test_a_blow_like_one_that_was_checked_has_its_coverage():
    def of(standard, method, coverage=2.0, *rows):
        return FigureUncertainty(9.0, standard, coverage * standard, coverage, method, rows)

    rows = (line("a", 3.0), line("b", 4.0), line("c", NAN))
    one = BlowUncertainty(
        {
            "peak": of(5.0, measured_uncertainty.BY_LAW, 2.0, *rows),
            "width": of(5.0, measured_uncertainty.BY_LAW, 2.0, *rows),
        }
    )
    assert one.figures["peak"].by_law == 5.0
    checked = BlowUncertainty(
        {
            "peak": of(12.0, measured_uncertainty.BY_TRIALS, 1.7, line("a", 10.0)),
            "width": of(12.0, measured_uncertainty.BY_LAW, 1.7, line("a", 10.0)),
        }
    )
    found = one.alike(checked).figures
    assert (found["peak"].standard, found["peak"].expanded, found["peak"].coverage) == (6.0, pytest.approx(10.2), 1.7)
    assert found["peak"].method == measured_uncertainty.BY_TRIALS
    assert found["width"] is one.figures["width"]
    still = BlowUncertainty({name: of(12.0, measured_uncertainty.BY_TRIALS, 1.7) for name in ("peak", "width")})
    assert one.alike(still).figures["peak"].standard == 5.0


def test_figures_are_summed_by_the_law_or_by_trials():
    class Kept:
        figures = np.array([10.0, 3.0, 8.0])
        sign = -1.0

    inputs = measured_uncertainty._Inputs(
        (Contribution("offset", "o", 1.0),), (("record", np.array([4.0, NAN, 0.0])),), np.array([False, True, False])
    )
    propagated = Propagated(Kept.figures, np.array([[-3.0, 2.0, 0.0], [4.0, 0.0, 0.0]]))
    found = measured_uncertainty._summed(Kept, inputs, propagated, None)
    peak, width, velocity = (found.figures[name] for name in measured_uncertainty.BUDGETED)
    assert (peak.value, width.value, velocity.value) == (-10.0, 3.0, -8.0)
    assert (peak.standard, peak.expanded, peak.coverage) == (5.0, 10.0, 2.0)
    assert list(peak.contributions) == [line("record", 4.0, 0.64), line("o", 3.0, 0.36)]
    assert math.isnan(width.standard)
    assert width.contributions[0] == line("o", 2.0, 1.0)
    assert (velocity.standard, velocity.coverage, velocity.contributions[0].share) == (0.0, 2.0, 0.0)
    assert (found.trials, found.validated) == (0, {})
    apart = Simulated(
        np.zeros(3), np.array([6.0, 7.0, 0.0]), np.array([1.0, 0.0, 8.0]), np.array([22.0, 0.0, 8.0]), 500, True
    )
    found = measured_uncertainty._summed(Kept, inputs, propagated, apart)
    peak = found.figures["peak"]
    assert (peak.standard, peak.expanded, peak.coverage, peak.method) == (
        6.0,
        12.0,
        2.0,
        measured_uncertainty.BY_TRIALS,
    )
    assert (found.trials, found.validated["peak"], found.validated["velocity_change"]) == (500, False, True)
    assert math.isnan(found.figures["width"].standard)


def test_noise_stands_in_place_of_what_the_record_does_not_tell():
    channel = half_sine_record(150)
    (pulse,) = find_pulses(channel.values[1400:], channel.step, channel.start)
    measured = measured_uncertainty._prepared(Channel("a", channel.values[1400:], channel.step, channel.start), pulse)
    assert np.isnan(dataclasses.astuple(pulse.uncertainty)).all()

    def unknown(*kinds):
        return measured_uncertainty._inputs(
            channel, pulse, Budget(tuple(Contribution(kind, kind, 0.02) for kind in kinds)), measured
        ).unknown.tolist()

    assert unknown() == [True] * 3
    assert unknown("acceleration") == [False, True, False]
    assert unknown("noise") == unknown("offset") == [False] * 3
    found = measured_uncertainty._inputs(
        channel, pulse, Budget((Contribution("noise", "n", 0.02), Contribution("drift", "d", 0.02))), measured
    )
    assert [one.kind for one in found.contributions] == ["sampling", "drift"]
    assert dict(found.added)["n"][2] == pytest.approx(
        measured_uncertainty._by_noise(measured, 0.02 * abs(pulse.peak))[2]
    )
    amount = measured_uncertainty._inputs(
        channel, pulse, Budget((Contribution("noise", "n", 0.02, relative=False),)), measured
    )
    assert dict(amount.added)["n"][2] == pytest.approx(measured_uncertainty._by_noise(measured, 0.02)[2])
    assert [one.name for one in found.quantities] == ["instants of sampling", "d", "peak", "width", "velocity_change"]
    two = measured_uncertainty._Inputs(
        (), (("a", np.array([3.0, NAN, 0.0])), ("b", np.array([4.0, 2.0, 0.0]))), np.zeros(3, bool)
    )
    assert [one.spread for one in two.quantities] == [5.0, 2.0, 0.0]


def test_the_largest_blow_of_each_channel_is_checked_and_the_others_are_like_it(monkeypatch):
    from types import SimpleNamespace

    from strikewave.records import reading
    from strikewave.records.calibration import ChannelCalibration
    from strikewave.records.reading import ChannelReading, FileReading

    done = []

    class Found(SimpleNamespace):
        def alike(self, checked):
            return ("alike", self.peak, checked.peak)

    def uncertainty(channel, pulse, budget, trials=False):
        done.append((pulse.peak, trials))
        return Found(peak=pulse.peak)

    monkeypatch.setattr(reading, "blow_uncertainty", uncertainty)

    def file_of(number, *peaks, unit="m/s^2"):
        pulses = tuple(SimpleNamespace(peak=peak) for peak in peaks)
        return FileReading(
            "f",
            "text",
            (ChannelReading(Channel("a", np.zeros(3), 1.0, unit=unit), number, pulses, (), ChannelCalibration()),),
        )

    files = [file_of(1, 3.0, -7.0, 5.0), file_of(1, 6.0), file_of(2, 1.0), file_of(1)]
    found = [one.channels[0].uncertainties for one in reading.with_budget(files, of_share(0.05))]
    assert found[0][0] == ("alike", 3.0, -7.0)
    assert (found[0][1].peak, found[0][2], found[1][0], found[2][0].peak, found[3]) == (
        -7.0,
        ("alike", 5.0, -7.0),
        ("alike", 6.0, -7.0),
        1.0,
        (),
    )
    assert [one for one in done if one[1]] == [(-7.0, True), (1.0, True)]
    done.clear()
    first, second = reading.with_budget([file_of(3, 4.0), file_of(3, 1.0, -5.0)], of_share(0.05))
    assert first.channels[0].uncertainties == (("alike", 4.0, -5.0),)
    assert second.channels[0].uncertainties[0] == ("alike", 1.0, -5.0)
    assert done == [(-5.0, True), (4.0, False), (1.0, False)]
    amount = Budget((Contribution("offset", "zero", 3.0, relative=False),))
    reading.check_amounts(amount, files[0].channels[0])
    reading.check_amounts(of_share(0.05), file_of(1, 1.0, unit="N").channels[0])
    with pytest.raises(InputError, match="zero states an acceleration"):
        reading.check_amounts(amount, file_of(1, 1.0, unit="N").channels[0])


# Spectra


def largest(values):
    return np.array([np.max(values), -np.min(values), np.mean(values)])


SPECTRAL = half_sine_record(60)


def of_spectrum(*kinds, channel=SPECTRAL, spectrum=largest, pulses=None):
    pulses = find_pulses(channel.values, channel.step, channel.start) if pulses is None else pulses
    return measured_uncertainty.spectrum_uncertainty(
        channel, 0.5, pulses, Budget(kinds), np.array([10.0, 20.0, 80.0]), spectrum
    )


def by(found, name):
    return {one.name: one.standard for one in found.contributions}[name]


def test_what_each_contribution_does_to_a_spectrum():
    values = SPECTRAL.values - 0.5
    plain = largest(values)
    gain, zero = Contribution("sensitivity", "s", 0.03), Contribution("offset", "o", 0.02)
    drift = Contribution("drift", "d", 0.3, "rectangular", relative=False)
    found = of_spectrum(gain, zero, drift)
    assert by(found, "s") == pytest.approx(0.03 * plain)
    assert by(found, "o") == pytest.approx(0.02 * 49.5 * np.ones(3))
    assert by(found, "d")[0] == pytest.approx(
        0.3 / math.sqrt(3.0) * 0.5, rel=0.02
    )  # half of it at the middle of the blow
    assert by(found, "d")[1] == pytest.approx(0.5 * 0.3 / math.sqrt(3.0))  # behind it to one side alone
    stated = np.array([each.standard for each in found.contributions])
    assert found.standard == pytest.approx(np.sqrt(np.nansum(stated**2, axis=0)))
    assert found.expanded == pytest.approx(2.0 * found.standard)
    assert found.lowest(2).standard.tolist() == found.standard[:2].tolist()
    assert [each.standard.size for each in found.lowest(2).contributions] == [2] * 5
    part = measured_uncertainty.SpectrumPart("a", np.arange(6.0).reshape(2, 3))
    rows = measured_uncertainty.SpectrumUncertainty(np.arange(6.0).reshape(2, 3), contributions=[part])
    assert (rows.of_row(1).standard.tolist(), rows.of_row(1).contributions[0].standard.tolist()) == (
        [3.0, 4.0, 5.0],
        [3.0, 4.0, 5.0],
    )


def test_a_clock_moves_a_spectrum_along_its_slope():
    """Of f^-1.5 the slope over the logarithm is -1.5 of it; between lines a chord stands for it."""
    frequency = np.array([10.0, 20.0, 40.0])
    spectrum = 6.0 - 1.5 * np.log(frequency)
    found = measured_uncertainty.spectrum_uncertainty(
        SPECTRAL, 0.0, [], Budget((Contribution("clock", "c", 0.02),)), frequency, lambda values: spectrum
    )
    assert by(found, "c") == pytest.approx(np.full(3, 0.02 * 1.5))
    assert np.isnan(found.standard).all()  # no blow: noise and baseline are not known
    alone = measured_uncertainty.spectrum_uncertainty(
        SPECTRAL, 0.0, [], Budget((Contribution("clock", "c", 0.02),)), frequency[:1], lambda values: spectrum[:1]
    )
    assert by(alone, "c").tolist() == [0.0]


def test_without_a_blow_a_drift_is_a_step_behind_the_first_sample():
    """Zero at the first of 200 samples and all of it from the second on; the mean lacks one of them."""
    channel = Channel("a", np.sin(np.arange(200.0)), 1e-3)
    drift = Contribution("drift", "d", 0.3, relative=False)

    def ends(values):
        return np.array([values[0], values[1], np.mean(values)])

    found = of_spectrum(drift, channel=channel, spectrum=ends, pulses=[])
    assert by(found, "d") == pytest.approx(0.3 * np.array([0.0, 1.0, 199.0 / 200.0]))


def test_noise_moves_a_mean_by_its_root():
    """The mean of 720 samples: 0.4 of 49.5, the largest value, over root 720, to what 24 draws tell of a scatter."""
    found = of_spectrum(Contribution("noise", "n", 0.4), Contribution("noise", "m", 3.0, relative=False))
    assert by(found, "n")[2] == pytest.approx(0.4 * 49.5 / math.sqrt(720.0), rel=0.4)
    assert by(found, "m")[2] == pytest.approx(3.0 / math.sqrt(720.0), rel=0.4)


@pytest.mark.parametrize(("before", "known"), [(460, True), (440, False)])
def test_noise_and_baseline_need_seven_widths_before_the_first_blow(before, known):
    """The blow lasts 59 samples from foot to foot; half of that before it is left out."""
    channel = half_sine_record(60, noise=0.5)
    (whole,) = find_pulses(channel.values, channel.step, channel.start)
    length = (whole.end - whole.begin) / channel.step
    first = round((whole.begin - channel.start) / channel.step - (7.5 * length + (3 if known else -3)))
    cut = Channel("a", channel.values[first:], channel.step, channel.start + first * channel.step)
    found = measured_uncertainty.spectrum_uncertainty(
        cut, 0.0, [whole], Budget(()), np.array([10.0, 20.0, 80.0]), largest
    )
    own = by(found, "noise and baseline")
    assert np.isfinite(own).all() == known
    assert found.standard == pytest.approx(np.hypot(own, by(found, "instants of sampling")), nan_ok=True)
    if known:
        wander = whole.baseline.wander
        quiet = cut.values[: round((whole.begin - cut.start) / cut.step - 0.5 * length)]
        drawn = np.std(quiet) / math.sqrt(quiet.size)  # a stretch of it laid on the record again and again has its mean
        assert own[2] >= 0.99 * wander
        assert own[2] <= math.hypot(1.01 * wander, 3.0 * drawn)


def test_draws_are_those_of_one_generator():
    found = measured_uncertainty._by_draws(
        np.zeros(3), lambda values: values, lambda generator: generator.standard_normal(3)
    )
    rows = np.random.default_rng(0).standard_normal((24, 3))
    assert found == pytest.approx(np.std(rows, axis=0, ddof=1))
