"""Each check finds the fault that is planted in a clean half-sine, and nothing in clean records of any shape."""

import dataclasses
import inspect
import math
import re
from pathlib import Path

import numpy as np
import pytest

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.texts import percent
from strikewave.records import Channel, Record, Request, read_file, thresholds
from strikewave.records.health import CHECKS, examine
from strikewave.records.health.disturbances import mains_hum
from strikewave.records.health.sampled_record import BlowRecord
from strikewave.records.health_notice import (
    BLOW,
    EVERY,
    FIGURES,
    OF_BLOWS,
    OF_BOTH,
    OF_RESPONSES,
    RESPONSE_FIGURES,
    STATUSES,
)
from strikewave.signal.filters import Filter

STEP, PEAK, LENGTH = 1e-6, 1000.0, 100
"""Of the clean half-sine: s, m/s^2, samples."""
SIZE, BEGIN = 6000, 1800.37
AFTER = np.arange(SIZE) > BEGIN + LENGTH + 10
SHAPES = {
    "half-sine": lambda u: np.sin(np.pi * u),
    "haversine": lambda u: np.sin(np.pi * u) ** 2,
    "saw-tooth": lambda u: np.minimum(u / 0.9, (1.0 - u) / 0.1),
    "trapezoid": lambda u: np.minimum(np.minimum(u, 1.0 - u) / 0.1, 1.0),
}


def blow(shape="half-sine", length=LENGTH, noise=1e-3, ringing=0.0, size=None, begin=None):
    """A record with one blow of `PEAK`, with noise and ringing as shares of it."""
    size = 60 * length if size is None else size
    u = (np.arange(size) - (0.3 * size + 0.37 if begin is None else begin)) / length
    values = np.where((u > 0.0) & (u < 1.0), SHAPES[shape](u), 0.0)
    swing = np.exp(-np.maximum(u, 0.0) / 3.0) * np.sin(10.6 * np.pi * u)
    values += np.where(u > 0.0, ringing * swing, 0.0)
    return PEAK * (values + noise * np.random.default_rng(20190321).normal(size=size))


def in_bits(values, bits):
    """A record as a converter with a range of 1.25 peaks to either side gives it."""
    least = 2.5 * PEAK / 2**bits
    return least * np.round(values / least)


def read(values, step=STEP, unit="m/s^2", **wanted):
    [reading] = read_file(
        Record("shot", "text", (Channel("board", values, step, unit=unit),)), {}, Request(**wanted)
    ).channels
    return reading


def found(values, code, **more):
    """The finding of that code, which must be there."""
    findings = read(values, **more).findings
    [finding, *_] = [one for one in findings if one.code == code] or [None]
    assert finding is not None, [one.code for one in findings]
    return finding


def codes(values, **more):
    return [(finding.code, finding.severity) for finding in read(values, **more).findings]


@pytest.mark.verify
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("bits", [8, 12, 24])
def test_a_clean_record_raises_nothing(shape, bits):
    # straight sides and a flat top are what slow and bounded amplifiers make, and cannot be told from them
    flat = {("flat-top", "suspect"), ("slew-rate", "suspect")} if shape == "trapezoid" else set()
    for length in (28, 200, 2000):
        for ringing in (0.0, 0.03):
            for noise in (1e-4, 1e-2):
                if shape == "trapezoid" and bits == 8 and noise < 0.004:
                    continue
                # twice 1 % a sample, or a step of 8 bits, is more than the 2 % that are worth a word
                told = {("noise", "good")} if bits == 8 or (length == 28 and noise == 1e-2) else set()
                # ringing is planted, and on a plateau nothing hides it
                told |= {("ringing", "suspect")} if flat and ringing else set()
                allowed = flat | told
                values = in_bits(blow(shape, length, noise, ringing), bits)
                assert set(codes(values)) <= allowed, (length, ringing, noise)
                assert len(read(values).pulses) == 1


@pytest.mark.parametrize("bits", [8, 12, 24, 52])
@pytest.mark.parametrize("level", [300.0, 700.0, 900.0, 950.0])
def test_clipping_at_a_repeated_value(bits, level):
    values = in_bits(np.minimum(blow(), level), bits)
    finding = found(values, "clipped")
    assert (finding.severity, finding.harms) == ("bad", BLOW)
    assert finding.value == values.max()
    half = LENGTH / math.pi * math.acos(level / PEAK) * STEP
    middle = (BEGIN + 0.5 * LENGTH) * STEP
    assert finding.start == pytest.approx(middle - half, abs=6 * STEP)
    assert finding.end == pytest.approx(middle + half, abs=6 * STEP)


def test_clipping_of_a_negative_blow():
    finding = found(np.maximum(-blow(), -800.0), "clipped")
    assert (finding.value, finding.severity) == (-800.0, "bad")


@pytest.mark.parametrize("length", [50, 100, 1000])
def test_the_rounded_top_of_a_coarse_recorder_is_no_clipping(length):
    values = in_bits(blow(length=length, noise=0.0), 8)
    assert np.count_nonzero(values == values.max()) >= 3
    assert "clipped" not in dict(codes(values))


def test_the_quiet_zero_of_a_coarse_recorder_is_no_clipping():
    values = in_bits(blow(noise=1e-4), 8)
    assert np.count_nonzero(values == values.min()) > 1000
    assert codes(values) == []


@pytest.mark.parametrize("share", [0.05, 0.3])
def test_zeros_before_and_after_a_blow_that_fills_its_record_are_no_clipping(share):
    zeros = np.zeros(int(share * 400))
    values = np.concatenate([zeros, 500.0 * np.sin(np.pi * np.arange(400) / 400.0), zeros])
    assert "clipped" not in [code for code, _ in codes(values)]


def test_a_top_that_turns_within_a_step_of_the_converter_is_no_clipping():
    """Three samples at the top, by chance one beside: the parabola through both sides turns within the step."""
    values = np.round(in_bits(blow(noise=1e-4), 12))
    step = 2.5 * PEAK / 2**12
    top = int(np.argmax(values))
    levels = np.array([-8, -7, -5, -3, -2, 0, 0, 0, -3, -8, -14])
    values[top - 5 : top + 6] = 1002.0 + step * levels
    assert "clipped" not in dict(codes(values))


@pytest.mark.parametrize("level", [-50.0, -100.0])
def test_clipping_of_negative_ringing_alone_harms_the_ringing_alone(level):
    swing = np.where(AFTER, 300.0 * np.exp(-(np.arange(SIZE) - BEGIN) / 300.0) * np.sin(0.14 * np.arange(SIZE)), 0.0)
    finding = found(np.maximum(blow() + swing, level), "clipped")
    assert (finding.value, finding.severity, finding.harms) == (level, "suspect", ("ringing_frequency", "spectrum"))


@pytest.mark.parametrize("level", [500.0, 700.0, 850.0])
def test_a_saturated_amplifier_gives_a_flat_top(level, rng):
    """Rounded clipping with noise after it: no value comes again and again."""
    clean = blow(noise=0.0) / level
    finding = found(level * clean / (1.0 + clean**20) ** 0.05 + rng.normal(size=SIZE), "flat-top")
    assert (finding.severity, finding.harms) == ("suspect", BLOW)
    assert 1.0 - 2.0 / math.pi * math.asin(level / PEAK) < finding.value < 1.0
    assert "clipped" not in dict(codes(level * clean / (1.0 + clean**20) ** 0.05 + rng.normal(size=SIZE)))


@pytest.mark.parametrize(
    ("share", "severity"), [(0.012, "good"), (0.055, "suspect"), (-0.055, "suspect"), (0.2, "bad"), (-0.2, "bad")]
)
def test_zero_shift(share, severity):
    values = blow(noise=1e-4) + share * PEAK * AFTER
    finding = found(values, "zero-shift")
    assert finding.value == pytest.approx(share * PEAK, rel=0.02)
    assert finding.severity == severity
    assert "spectrum" in finding.harms
    assert share == 0.012 or "peak" in finding.harms  # it may have come before the peak
    [pulse] = read(values).pulses
    assert pulse.peak == pytest.approx(PEAK, rel=0.01)


def test_a_zero_that_steps_between_blows():
    values = blow(noise=1e-4) + 0.2 * PEAK * (np.arange(SIZE) > 4000)
    finding = found(values, "zero-step")
    assert (finding.severity, finding.value) == ("bad", pytest.approx(0.2 * PEAK, rel=0.01))


def test_a_shift_that_comes_back_is_no_ac_coupling():
    """A tenth of the peak at once, its own time constant: it has nothing of the velocity change."""
    k = np.arange(SIZE) - BEGIN - 0.5 * LENGTH
    values = blow(noise=1e-4) + np.where(k > 0.0, 0.1 * PEAK * np.exp(-np.maximum(k, 0.0) / 1200.0), 0.0)
    finding = found(values, "zero-shift")
    assert finding.value == pytest.approx(0.1 * PEAK, rel=0.25)  # at the end of the blow
    constant = float(finding.message.partition("time constant of ")[2].split()[0])
    assert constant == pytest.approx(1.2, rel=0.05)  # of a grid of 120 over two decades
    assert "ac-coupling" not in dict(codes(values))


def coupled(tau, values=None):
    """A blow through a high-pass of first order: y = x - (1 / tau) int exp(-(t - s) / tau) x ds, in samples."""
    from scipy.signal import lfilter

    clean = blow(noise=0.0) if values is None else values
    pole = math.exp(-STEP / tau)
    area = lfilter([0.5 * STEP * (1.0 + pole) / 2.0, 0.5 * STEP * (1.0 + pole) / 2.0], [1.0, -pole], clean)
    return clean - area / tau


@pytest.mark.parametrize("tau", [100e-6, 400e-6, 1600e-6])
def test_ac_coupling_is_recognised_with_its_time_constant_and_its_effect(tau, rng):
    truth = read(blow(noise=0.0)).pulses[0]
    values = coupled(tau) + 1e-3 * PEAK * rng.normal(size=SIZE)
    finding = found(values, "ac-coupling")
    assert finding.value == pytest.approx(tau, rel=0.03)
    [pulse] = read(values).pulses
    effects = dict(finding.effects)
    assert effects["peak"] == pytest.approx(pulse.peak / truth.peak - 1.0, abs=0.01)
    assert effects["velocity_change"] == pytest.approx(pulse.velocity_change / truth.velocity_change - 1.0, abs=0.02)
    assert ("peak" in finding.harms) == (abs(effects["peak"]) > 0.05)
    assert "spectrum" in finding.harms


@pytest.mark.parametrize("wanted", ["auto", 400e-6])
def test_ac_coupling_is_taken_off_on_request(wanted, rng):
    truth = read(blow(noise=0.0)).pulses[0]
    reading = read(coupled(400e-6) + 1e-3 * PEAK * rng.normal(size=SIZE), ac_coupling=wanted)
    [pulse] = reading.pulses
    assert reading.status == "good"
    assert pulse.peak == pytest.approx(truth.peak, rel=0.01)
    assert pulse.velocity_change == pytest.approx(truth.velocity_change, rel=0.02)
    [finding] = [one for one in reading.findings if one.code == "ac-coupling"]
    assert "was taken off" in finding.message


def test_what_only_looks_like_ac_coupling(rng):
    """Shifts, drifts, slow motion, warming and ringing: none has the velocity change in its undershoot."""
    k = np.arange(SIZE)
    since = np.maximum(k - BEGIN - LENGTH, 0.0)
    fools = {
        "motion": -0.05 * PEAK * np.sin(since / 400.0) * np.exp(-since / 800.0),
        "shift": -0.02 * PEAK * AFTER,
        "warming": 0.2 * PEAK * np.exp(-k / 2000.0),
        "drift": 0.1 * PEAK * k / SIZE,
        "ringing": 0.3 * PEAK * np.exp(-since / 300.0) * np.sin(since / 6.0),
        "step": -0.05 * PEAK * (k > 4000),
    }
    for name, fault in fools.items():
        values = blow(noise=0.0) + fault + 1e-3 * PEAK * rng.normal(size=SIZE)
        assert "ac-coupling" not in dict(codes(values)), name


def test_where_no_ac_coupling_is_recognised_nothing_is_taken_off():
    reading = read(blow(), ac_coupling="auto")
    assert reading.pulses[0].peak == pytest.approx(read(blow()).pulses[0].peak, rel=1e-12)
    assert "nothing was taken off" in found(blow(), "ac-coupling", ac_coupling="auto").message


def test_a_zero_shift_of_20_percent_harms_everything():
    assert found(blow() + 0.2 * PEAK * AFTER, "zero-shift").harms == FIGURES


def test_no_zero_shift_below_a_percent():
    assert codes(blow(noise=1e-4) + 0.005 * PEAK * AFTER) == []


@pytest.mark.parametrize(("share", "severity"), [(1.0, "good"), (4.0, "suspect")])
def test_drift_of_the_integrated_velocity(share, severity):
    change = PEAK * LENGTH * STEP * 2.0 / math.pi
    values = blow(noise=1e-4) + AFTER * share * change / (np.count_nonzero(AFTER) * STEP)
    finding = found(values, "velocity-drift")
    assert finding.value == pytest.approx(share * change, rel=0.03)
    assert (finding.severity, finding.harms) == (severity, ("spectrum",))


@pytest.mark.parametrize(("count", "loss"), [(5, "4.9 %"), (10, "1.2 %"), (20, "0.3 %")])
def test_few_samples_lose_what_the_cosine_says(count, loss):
    """1 - cos(pi / (2 n)) at n intervals of a half-sine."""
    assert percent(1.0 - math.cos(0.5 * math.pi / count)) == loss
    values = np.zeros(2000)
    values[1000 : 1000 + 2 * count] = PEAK * np.maximum(np.sin(np.pi * (np.arange(2 * count) + 0.5) / count), 0.0)
    record = BlowRecord(values, STEP, 0.0, "", tuple(pulse_of(0.935 * count * STEP)))
    [finding] = [one for one in examine(record) if one.code == "few-samples"]
    assert finding.value == pytest.approx(count, rel=0.01)
    assert f"by {percent(1.0 - math.cos(0.5 * math.pi / finding.value))}" in finding.message


def pulse_of(width):
    """A measured pulse of that width."""
    [pulse] = read(blow()).pulses
    return [dataclasses.replace(pulse, width=width)]


@pytest.mark.parametrize(
    ("length", "severity", "harms"),
    [(4, "bad", ("peak", "rise", "width")), (7, "suspect", ("peak", "rise", "width")), (15, "good", ())],
)
def test_few_samples(length, severity, harms):
    finding = found(blow(length=length, size=3000, noise=1e-4), "few-samples")
    assert finding.value == pytest.approx(length, rel=0.2)
    assert (finding.severity, finding.harms) == (severity, harms)


def test_enough_samples():
    assert codes(blow(length=22, size=3000, noise=1e-4)) == []


@pytest.mark.parametrize("frequency", [0.46, 0.54, 0.48, 0.52])
def test_ringing_near_half_the_rate_or_folded_to_it(frequency):
    k = np.arange(SIZE) - BEGIN
    swing = np.where(k > 0.0, 400.0 * np.exp(-np.maximum(k, 0.0) / 60.0) * np.sin(2.0 * np.pi * frequency * k), 0.0)
    finding = found(blow() + swing, "alias")
    area = ("width", "velocity_change") if finding.value > 0.025 else ()  # twice that of the area is 5 %
    assert (finding.severity, finding.harms) == ("suspect", ("peak", "rise", *area, "spectrum"))
    assert 0.02 < finding.value < 1.0


def test_ringing_well_below_half_the_rate_is_no_alias():
    assert "alias" not in dict(codes(blow(ringing=0.4)))


def test_noise_alone_is_no_alias():
    assert "alias" not in dict(codes(blow(noise=0.03)))


def test_polarity():
    finding = found(-blow(), "polarity")
    assert (finding.severity, finding.value, finding.harms) == ("suspect", -1.0, ())
    assert codes(-blow(), calibrations={"all": {"polarity": -1}}) == []


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
def test_a_blow_cut_at_the_end(share):
    finding = found(blow()[: int(BEGIN + share * LENGTH)], "cut")
    assert (finding.severity, finding.harms) == ("suspect", BLOW)
    assert finding.start == pytest.approx(BEGIN * STEP, abs=10 * STEP)
    assert "cut by the end" in finding.message


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("share", [0.3, 0.5, 0.7])
def test_a_blow_cut_at_the_begin(share, sign):
    values = sign * blow()[int(BEGIN + share * LENGTH) :]
    finding = found(values, "cut")
    assert (finding.severity, finding.harms) == ("bad", FIGURES)
    assert "begins in a blow" in finding.message


def test_a_sensor_that_has_not_settled(rng):
    values = 1e4 * np.exp(-np.arange(SIZE) / 2000.0) + rng.normal(size=SIZE)
    finding = found(values, "not-settled")
    assert (finding.severity, finding.harms) == ("bad", FIGURES)
    assert 1e4 * math.exp(-3.0) < finding.value < 1e4


def test_a_record_that_begins_in_ringing(rng):
    values = 500.0 * np.exp(-np.arange(SIZE) / 300.0) * np.cos(0.2 * np.arange(SIZE)) + rng.normal(size=SIZE)
    finding = found(values, "not-settled")
    assert (finding.severity, finding.harms) == ("bad", FIGURES)
    assert finding.value == pytest.approx(1000.0, rel=0.1)
    assert "swings" in finding.message


def test_a_far_zero_is_said_and_taken_off():
    finding = found(blow() - 5000.0, "not-settled")
    assert finding.value == pytest.approx(-5000.0, abs=1.0)
    assert (finding.severity, finding.harms) == ("suspect", ("spectrum",))
    assert read(blow() - 5000.0).pulses[0].peak == pytest.approx(PEAK, rel=0.01)


def test_a_drift_known_before_the_blow_is_carried_on_under_it():
    """600 over the record, 60 % of the peak, a line: it leaves the peak where it was."""
    values = blow() + 5000.0 + 0.1 * np.arange(SIZE)
    finding = found(values, "drift")
    assert (finding.severity, finding.harms) == ("good", ("spectrum",))
    assert finding.value == pytest.approx(600.0, rel=0.01)
    [pulse] = read(values).pulses
    assert pulse.peak == pytest.approx(PEAK, rel=0.003)


def test_a_drift_with_nothing_before_the_blow_harms_its_figures():
    values = (blow() + 2.0 * np.arange(SIZE))[int(BEGIN) - 60 :]
    finding = found(values, "drift")
    assert (finding.severity, finding.harms) == ("suspect", (*BLOW, "spectrum"))


@pytest.mark.parametrize("period", [3000, 9000])
def test_slow_motion_after_a_quiet_beginning_leaves_the_figures(period):
    """5 % of the peak from the end of the blow on: what moves after it says nothing of the zero before it."""
    clean = read(blow(noise=1e-4)).pulses[0]
    k = np.maximum(np.arange(SIZE) - BEGIN - LENGTH, 0.0)
    reading = read(blow(noise=1e-4) + 0.05 * PEAK * np.sin(2.0 * np.pi * k / period))
    assert not {name for f in reading.findings for name in f.harms} & {"peak", "rise", "width"}
    [pulse] = reading.pulses
    assert pulse.peak == pytest.approx(clean.peak, rel=0.002)
    assert pulse.width == pytest.approx(clean.width, rel=0.002)
    assert pulse.offset == pytest.approx(clean.offset, abs=1e-4 * PEAK)


def coloured(rng, size, pole):
    """Noise whose neighbours are alike, of standard deviation 1."""
    from scipy.signal import lfilter

    return lfilter([math.sqrt(1.0 - pole**2)], [1.0, -pole], rng.normal(size=size + 2000))[2000:]


@pytest.mark.verify
@pytest.mark.parametrize("pole", [0.0, 0.9, 0.99])
def test_the_uncertainty_of_figures_covers_noise_of_any_colour(pole, rng):
    """Errors over their standard uncertainties: 1 in root mean square; 60 draws know it to 9 %, the baseline to as much."""
    draws = []
    for _ in range(60):
        values = blow(noise=0.0) + 0.02 * PEAK * coloured(rng, SIZE, pole)
        [pulse] = read(values).pulses
        truth = PEAK * LENGTH * STEP * 2.0 / math.pi
        draws.append((pulse.velocity_change - truth) / pulse.uncertainty.velocity_change)
    assert 0.6 < math.sqrt(np.mean(np.square(draws))) < 1.5


def test_coloured_noise_is_told_with_what_it_does(rng):
    finding = found(blow(noise=0.0) + 0.05 * PEAK * coloured(rng, SIZE, 0.99), "noise")
    assert finding.severity == "suspect"
    assert "velocity_change" in finding.harms
    assert dict(finding.effects)["velocity_change"] > 0.05
    assert "velocity change +-" in finding.message


def test_white_noise_of_a_percent_is_no_warning():
    assert codes(blow(noise=0.01)) == []


@pytest.mark.parametrize("frequency", [50.0, 60.0])
def test_hum_is_named_with_its_effect(frequency):
    """1 000 Hz half-sine in hum of 2 % of its peak, 120 ms at 50 kHz."""
    values = blow(length=25, size=6000, noise=1e-4)
    values += 0.02 * PEAK * np.sin(2.0 * np.pi * frequency * np.arange(6000) * 2e-5 + 1.0)
    finding = found(values, "hum", step=2e-5)
    assert finding.value == pytest.approx(0.02 * PEAK, rel=0.1)
    assert f"{frequency:g}\xa0Hz" in finding.message
    assert {"peak", "velocity_change"} <= set(dict(finding.effects))


def test_a_slow_motion_after_the_blow_is_no_hum():
    k = np.maximum(np.arange(6000) - 1900.0, 0.0)
    values = blow(length=25, size=6000, noise=1e-4) + 0.02 * PEAK * np.sin(2.0 * np.pi * 50.0 * k * 2e-5)
    assert "hum" not in dict(codes(values, step=2e-5))


def test_white_noise_counts_where_too_little_lies_before():
    """8 % of noise, 24 samples a pulse: twice the uncertainty of a fitted peak is 6 %."""
    values = blow(noise=0.08, length=24, begin=60.0, size=1500)
    finding = found(values, "noise")
    assert "peak" in finding.harms
    assert "short-pretrigger" in dict(codes(values))


def test_too_short_a_beginning_is_said():
    finding = found(blow()[int(BEGIN) - 250 :], "short-pretrigger")
    assert (finding.severity, finding.harms) == ("good", ())


@pytest.mark.parametrize(("share", "severity"), [(2.2, "bad"), (1.8, None), (1.1, None), (0.8, "suspect")])
def test_velocity_change_against_the_drop_height(share, severity):
    """A fall from h arrives with v = sqrt(2 g h); the blow changes it by v, or by 2 v if all comes back."""
    change = PEAK * LENGTH * STEP * 2.0 / math.pi
    height = (change / share) ** 2 / (2.0 * STANDARD_GRAVITY)
    said = dict(codes(blow(), drop_height=height))
    assert said == ({"drop-height": severity} if severity else {})
    if severity:
        finding = found(blow(), "drop-height", drop_height=height)
        assert finding.value == pytest.approx(change, rel=0.01)
        assert finding.harms == ("peak", "velocity_change", "spectrum")


def test_a_drop_height_says_nothing_of_a_record_without_acceleration():
    assert codes(blow(), unit="N", drop_height=1e6) == []


@pytest.mark.parametrize("level", [0.0, 3.3, -1e4])
def test_a_dead_channel(level):
    [finding] = read(np.full(SIZE, level)).findings
    assert (finding.code, finding.severity, finding.value, finding.harms) == ("dead", "bad", level, FIGURES)


def test_noise_alone_holds_no_blow(rng):
    finding = found(rng.normal(size=SIZE), "no-pulse")
    assert (finding.severity, finding.harms) == ("bad", (*BLOW, "interval", "spectrum"))


def test_a_record_that_swings_higher_than_its_blow():
    k = np.arange(SIZE) - 4500
    values = blow() + 1500.0 * np.exp(-((k / 300.0) ** 2)) * np.sin(k / 8.0)
    finding = found(values, "swings")
    assert (finding.severity, finding.harms) == ("suspect", BLOW)
    assert finding.value == pytest.approx(1500.0, rel=0.02)


def test_noise_that_hides_the_blow():
    finding = found(blow(noise=0.3), "noisy")
    assert finding.value == pytest.approx(-20.0 * math.log10(0.3), abs=1.5)
    assert (finding.severity, finding.harms) == ("suspect", ("rise",))


def test_a_straight_line_is_no_blow():
    """A count or a clock beside the data: fast, and without blows."""
    for values in (
        np.arange(50_000) * 1e-5,
        np.cumsum(np.full(50_000, 0.1)),
        np.float32(1.7 * np.arange(50_000)).astype(float),
    ):
        assert ("no-pulse", "bad") in codes(values)
        assert read(values).pulses == ()


def test_findings_come_the_worst_first():
    values = np.minimum(blow() + 0.05 * PEAK * AFTER, 800.0)
    severities = [finding.severity for finding in read(values).findings]
    assert severities == sorted(severities, key=("bad", "suspect", "good").index)
    assert severities[0] == "bad"


def limited(values, most):
    """Values as an amplifier of a largest slope a sample follows them."""
    followed, now = values.copy(), values[0]
    for k in range(1, values.size):
        now += min(max(values[k] - now, -most), most)
        followed[k] = now
    return followed


@pytest.mark.parametrize("shape", ["half-sine", "haversine"])
@pytest.mark.parametrize("length", [40, 100, 400])
def test_an_amplifier_that_is_too_slow_makes_straight_sides(shape, length):
    """At half of its steepest slope a half-sine loses 5 % of its peak, and a haversine 11 %."""
    clean = blow(shape, length, noise=0.0)
    most = 0.5 * float(np.max(np.diff(clean)))
    noise = 1e-3 * PEAK * np.random.default_rng(1).normal(size=clean.size)
    finding = found(limited(clean, most) + noise, "slew-rate")
    assert (finding.severity, finding.harms) == ("suspect", BLOW)
    assert finding.value == pytest.approx(most / STEP, rel=0.02)  # the noise of a slope over 12 samples and more
    assert "slew-rate" not in dict(codes(clean + noise))


def test_a_saw_tooth_of_straight_sides_is_none_of_a_slow_amplifier():
    assert "slew-rate" not in dict(codes(blow("saw-tooth", 200)))
    equal = PEAK * np.maximum(1.0 - np.abs(np.arange(SIZE) - BEGIN) / 50.0, 0.0)
    found(equal + np.random.default_rng(1).normal(size=SIZE), "slew-rate")


def noisy(share, seed=2):
    """Noise whose neighbours are alike, of such a share of the peak."""
    alike = np.convolve(np.random.default_rng(seed).normal(size=SIZE + 5), np.full(6, 1.0 / np.sqrt(6.0)), "valid")
    return share * PEAK * alike


@pytest.mark.parametrize("shape", ["half-sine", "haversine"])
def test_a_slow_amplifier_is_seen_in_noise_by_the_corner_it_makes(shape):
    """Noise of 1.5 % on 20 samples a side hides whether that is straight; at 0.4 of its slope a half-sine loses 10 %."""
    clean = blow(shape, 40, noise=0.0)
    slow = limited(clean, 0.4 * float(np.max(np.diff(clean))))
    for seed in range(4):
        noise = 0.015 * PEAK * np.random.default_rng(seed).normal(size=clean.size)
        assert "corner" in found(slow + noise, "slew-rate").message
        assert "slew-rate" not in dict(codes(clean + noise))


def test_a_pulse_with_a_corner_and_one_steep_side_is_a_saw_tooth():
    """That of a standard, its rise and its fall straight, in noise; turned round it is one too."""
    u = np.clip((np.arange(SIZE) - BEGIN) / 200.0, 0.0, 1.0)
    tooth = PEAK * np.minimum(u / 0.85, (1.0 - u) / 0.15)
    for values in (tooth, tooth[::-1]):
        assert "slew-rate" not in dict(codes(values + noisy(0.01)))


def test_blows_of_one_record_show_together_what_noise_hides_in_each():
    """A limit like |x|^16 takes 5 % off each of nine half-sines in noise of 2.5 %."""
    u = np.arange(12_000) / 40.0
    clean = PEAK * sum(np.sin(np.pi * np.clip(u - 12.0 - 30.0 * k, 0.0, 1.0)) for k in range(9))
    limit = PEAK * (0.95**-16 - 1.0) ** (-1.0 / 16.0)
    bent = clean / (1.0 + (clean / limit) ** 16) ** (1.0 / 16.0)
    noise = 0.025 * PEAK * np.random.default_rng(3).normal(size=u.size)
    found(bent + noise, "flat-top")
    assert "flat-top" not in dict(codes(clean + noise))
    assert "flat-top" not in dict(codes((bent + noise)[:600]))  # one of them


@pytest.mark.parametrize("taken", [0.06, 0.15])
def test_a_limit_bends_the_straight_side_of_a_saw_tooth_before_its_tip(taken):
    """The line goes on to what the tip was; the tip of the saw-tooth itself is on it."""
    u = np.clip((np.arange(SIZE) - BEGIN) / 300.0, 0.0, 1.0)
    tooth = PEAK * np.minimum(u / 0.85, (1.0 - u) / 0.15)
    limit = PEAK * ((1.0 - taken) ** -12 - 1.0) ** (-1.0 / 12.0)
    bent = tooth / (1.0 + (tooth / limit) ** 12) ** (1.0 / 12.0)
    noise = 1e-3 * PEAK * np.random.default_rng(1).normal(size=SIZE)
    finding = found(bent + noise, "flat-top")
    assert finding.value == pytest.approx(taken / (1.0 - taken), abs=0.02)  # the side bends a little from its middle on
    assert "flat-top" not in dict(codes(tooth + noise))


@pytest.mark.parametrize("swings", [6.0, 12.0])
def test_ringing_that_dies_within_the_blow_makes_the_record_go_back(swings):
    """A third of the peak, e^-8 of it left at the end: what follows the blow is quiet."""
    u = np.clip((np.arange(SIZE) - BEGIN) / 100.0, 0.0, None)
    swing = -PEAK / 3.0 * np.exp(-8.0 * u) * np.sin(2.0 * np.pi * swings * u)
    finding = found(blow(length=100, begin=BEGIN) + swing, "ringing")
    assert finding.severity == "suspect"
    assert "peak" in finding.harms


@pytest.mark.verify
@pytest.mark.parametrize("shape", ["half-sine", "haversine", "saw-tooth", "trapezoid"])
def test_a_pulse_in_noise_does_not_go_back(shape):
    """Noise of 2 % of the peak, white or with a memory, makes a top of hundreds of samples fall and rise by 10 %."""
    for seed in range(3):
        white = 0.02 * PEAK * np.random.default_rng(seed).normal(size=SIZE)
        for noise in (white, noisy(0.02, seed)):
            assert "ringing" not in dict(codes(blow(shape, 400, size=SIZE) + noise))


@pytest.mark.parametrize("power", [0.9, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("taken", [0.06, 0.15])
def test_a_soft_limit_is_seen_from_what_it_takes_off_a_pulse(power, taken):
    """A limit like |x|^10 takes 6 and 15 % off; the pulse itself is as pointed as a half-sine or nearly."""
    u = (np.arange(SIZE) - BEGIN) / LENGTH
    clean = PEAK * np.sin(np.pi * np.clip(u, 0.0, 1.0)) ** power
    limit = PEAK * ((1.0 - taken) ** -10 - 1.0) ** -0.1
    bent = clean / (1.0 + (clean / limit) ** 10) ** 0.1
    assert float(np.max(bent)) == pytest.approx((1.0 - taken) * PEAK, rel=1e-3)
    noise = np.random.default_rng(1).normal(size=SIZE)
    assert found(bent + noise, "flat-top").harms == BLOW
    assert "flat-top" not in dict(codes(clean + noise))


@pytest.mark.parametrize("periods", [1.4, 1.9, 8.0])
def test_hum_is_named_where_few_periods_are_recorded(periods):
    """A blow of 100 samples in quiet of so many periods of 60 Hz, the phase so that it begins on a slope."""
    step = periods / 60.0 / SIZE
    swing = 0.05 * PEAK * np.sin(2.0 * np.pi * 60.0 * step * np.arange(SIZE) + 1.0)
    assert found(blow() + swing, "hum", step=step).value == pytest.approx(0.05 * PEAK, rel=0.1)


def test_samples_too_slow_for_the_mains_tell_of_no_hum():
    """At 70 Hz a swing of 10 Hz has the samples of one of 60 Hz."""
    time = np.arange(700) / 70.0
    assert mains_hum(BlowRecord(np.sin(2.0 * np.pi * 10.0 * time), 1.0 / 70.0)) is None


def test_less_than_a_period_of_hum_is_a_drift():
    values = blow() + 0.05 * PEAK * np.sin(np.linspace(0.0, 2.0, SIZE))
    assert "hum" not in dict(codes(values, step=2.0 / (2.0 * np.pi * 50.0) / SIZE))


def test_blips_in_step_with_the_mains_are_suspect_and_blows_of_a_machine_are_not(rng):
    def record(jitter):
        time = np.arange(20_000) * 5e-6
        begins = 4e-3 + 1.0 / 60.0 * (np.arange(6) + jitter * rng.normal(size=6))
        return sum(np.exp(-0.5 * ((time - t) / 0.2e-3) ** 2) for t in begins) + 1e-3 * rng.normal(size=time.size)

    finding = found(record(0.0), "mains", step=5e-6)
    assert (finding.severity, finding.harms) == ("suspect", (*BLOW, "interval"))
    assert finding.value == pytest.approx(1.0 / 60.0)
    assert "mains" not in dict(codes(record(0.03), step=5e-6))


def struck_train(rng, period, width, jitter=0.0, scatter=0.0, after=0.5, blows=7):
    """Half-sines of 4000 a period apart, each early or late by a share of it, in noise of 2; `after` periods follow."""
    step, length = min(width / 20.0, 20e-6), width / 0.936
    time = np.arange(int((blows + after) * period / step)) * step
    begins = 0.5 * period + period * (np.arange(blows) + jitter * rng.uniform(-1.0, 1.0, blows))
    peaks = 4000.0 * (1.0 + scatter * rng.normal(size=blows))
    u = (time[:, None] - begins) / length
    return np.sum(np.where((u > 0.0) & (u < 1.0), peaks * np.sin(np.pi * u), 0.0), axis=1) + 2.0 * rng.normal(
        size=time.size
    ), step


@pytest.mark.parametrize("jitter", [0.0, 0.005])
@pytest.mark.parametrize("period", [10e-3, 1.0 / 60.0, 20e-3])
def test_a_train_in_the_period_of_the_mains_of_blows_too_short_for_it_is_struck(rng, period, jitter):
    values, step = struck_train(rng, period, 200e-6, jitter)
    reading = read(values, step=step)
    assert len(reading.pulses) == 7
    assert reading.status == "good"
    assert len(reading.figures("peak")) == 7


@pytest.mark.parametrize(
    ("how", "blips"), [({}, True), ({"jitter": 0.005}, False), ({"scatter": 0.06}, False), ({"after": 2.0}, False)]
)
def test_long_blows_in_step_with_the_mains_are_struck_where_the_mains_would_not_do_so(rng, how, blips):
    """Of 2 ms a 20 ms: early or late, of several heights, or none where one is due; else one record does not show it."""
    values, step = struck_train(rng, 20e-3, 2e-3, **how)
    assert ("mains" in dict(codes(values, step=step))) is blips


def test_ringing_that_a_filter_takes_off_harms_nothing():
    """At 53 kHz by a fifth of the peak; a filter at 30 kHz leaves a hundredth of it, and widens the pulse of 100 us."""
    values = blow(ringing=0.2)
    assert {"peak", "width"} <= set(found(values, "ringing").harms)
    reading = read(values, filter=Filter(30e3))
    [(_, harms)] = [(finding.code, finding.harms) for finding in reading.findings if finding.code == "ringing"]
    assert "peak" not in harms
    assert reading.pulses[0].peak == pytest.approx(PEAK, rel=0.01)


def test_every_check_is_one_row_with_a_function_of_its_own_and_a_code_of_the_docs():
    functions = [check.find for check in CHECKS]
    assert len(set(functions)) == len(functions)
    page = Path(__file__).parents[2].joinpath("docs/records.md").read_text("utf-8")
    codes = {
        code for row in re.findall(r"^\| (`[^|]*)\|", page, re.MULTILINE) for code in re.findall(r"`([a-z-]+)`", row)
    }
    assert {check.name for check in CHECKS} <= codes
    for check in CHECKS:
        harmed = {OF_BLOWS: FIGURES, OF_RESPONSES: RESPONSE_FIGURES, OF_BOTH: ()}[check.of]
        assert check.severity in STATUSES
        assert check.harms == EVERY or set(check.harms) <= set(harmed)
        assert check.find.__doc__.startswith("Find ")


def test_every_threshold_says_why():
    lines = inspect.getsource(thresholds).splitlines()
    stated = [k for k, line in enumerate(lines) if ": Final = " in line]
    assert len(stated) > 80
    assert [lines[k] for k in stated if "  # " not in lines[k] and not lines[k - 1].lstrip().startswith("# ")] == []
