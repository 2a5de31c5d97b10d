"""Two sensors, part by part: windows and answers made by hand, each limit from both sides; blows and what belongs to them."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.records import measuring, two_sensors
from strikewave.records.baseline import LocalBaseline
from strikewave.records.measuring import Rebound, RecordedPulse, find_pulses
from strikewave.records.pulse_shape import PulseUncertainty, SmoothPulse
from strikewave.records.two_sensors import PairedMotion, Window, paired_motion

NAN = math.nan
STEP = 1e-3


def motion(**how):
    known = {
        "blows": 1, "delay": 0.0, "delay_uncertainty": 0.0, "gain": 1.0, "gain_uncertainty": 0.0, "explained": 0.9, "peak_lag": 0.0, "common": None,
        "common_uncertainty": 0.0, "differential_peak": 0.0, "differential_in_band": 0.0, "differential_share": 0.0,
        "transfer": SimpleNamespace(alike_to=2500.0), "one_body": "", "reason": "",
    }  # fmt: skip
    return PairedMotion(**{**known, **how})


@pytest.mark.parametrize(
    ("how", "answer", "words"),
    [
        ({}, "yes", "gain 1 ± 0 and delay 0 ± 0 µs; alike within 10 % up to 2500\xa0Hz"),
        ({"gain": 1.039}, "yes", ""), ({"gain": 1.041}, "no", "calibration 2 % more"), ({"gain": 0.961}, "yes", ""), ({"gain": 0.959}, "no", "gain"),
        ({"gain": 1.07, "gain_uncertainty": 0.03}, "yes", ""), ({"gain": 1.073, "gain_uncertainty": 0.03}, "no", "gain"),
        ({"delay": 5.77e-4}, "yes", ""), ({"delay": 5.78e-4}, "no", "sampling 289 µs more"), ({"delay": -5.8e-4}, "no", "delay"),
        ({"delay": 9e-4, "delay_uncertainty": 3.5e-4}, "yes", ""), ({"delay": 9.2e-4, "delay_uncertainty": 3.5e-4}, "no", "delay"),
        ({"gain": 1.05, "delay": 6e-4}, "no", "and sampling"),
        ({"gain_uncertainty": 0.0979}, "yes", ""), ({"gain_uncertainty": 0.0981}, "cannot-tell", "too uncertain"),
        ({"delay_uncertainty": 1.978e-3}, "yes", ""), ({"delay_uncertainty": 1.981e-3}, "cannot-tell", "too uncertain"),
        ({"transfer": SimpleNamespace(alike_to=NAN)}, "cannot-tell", "no band of the transfer function"), ({"transfer": None}, "cannot-tell", "no blow lies"),
        ({"delay": NAN}, "no", "explains 90 % of the energy"),
    ],
)  # fmt: skip
def test_two_sensors_are_one_body_within_twice_what_is_known(how, answer, words):
    """Sampling every ms, a calibration of 2 %, a blow of 20 ms: sampling is known to 1 / sqrt(12) ms."""
    found, reason = two_sensors._as_one_body(motion(**how), False, STEP, 0.02)
    assert found == answer
    assert words in reason
    assert two_sensors._as_one_body(motion(delay=NAN), True, STEP, 0.02)[0] == "cannot-tell"


def test_who_leads_and_which_peak_is_known():
    assert [motion(delay=d, delay_uncertainty=1.0).leads for d in (2.1, 1.9, -2.1, -1.9, NAN)] == [1, 0, 2, 0, 0]
    pulse = recorded(peak=-10.0)
    assert motion(common=pulse, common_uncertainty=1.0).rigid_peak == -10.0
    assert math.isnan(motion(common=pulse, common_uncertainty=1.01).rigid_peak)
    assert math.isnan(motion().rigid_peak)


def recorded(**how):
    smooth = SmoothPulse(5.0, 7.1, 0.02, 0.5, 1.0)
    known = (7.11, 5.0, 0.01, 0.02, 0.06, NAN, 2.0, 0.3, smooth, "record", 7.1, 7.12)
    return dataclasses.replace(RecordedPulse(*known, step=STEP), **how)


def part(peak, doubt, separable=True, cutoff=900.0):
    return SimpleNamespace(peak=peak, peak_uncertainty=doubt, separable=separable, cutoff=cutoff)


def test_the_rigid_peak_is_the_one_that_is_known_best():
    plain = recorded(uncertainty=PulseUncertainty(0.2, 0.1, 0.1))
    assert two_sensors._rigid(plain) == (5.0, 0.2)
    assert two_sensors._rigid(dataclasses.replace(plain, rigid=part(4.0, 0.5), split=part(4.5, 0.4))) == (4.5, 0.4)
    assert two_sensors._rigid(dataclasses.replace(plain, rigid=part(4.0, 0.3), split=part(4.5, 0.4))) == (4.0, 0.3)
    assert two_sensors._rigid(dataclasses.replace(plain, rigid=part(4.0, 0.5), split=part(4.5, 0.4, False))) == (
        4.0,
        0.5,
    )
    assert two_sensors._rigid(dataclasses.replace(plain, rigid=part(4.0, math.inf))) == (4.0, 0.3)


def test_places_lie_within_the_record():
    assert [two_sensors._place(t, 0.5, 3.0, 10) for t in (3.0, 3.76, 2.0, 8.0, 9.0)] == [0, 2, 0, 10, 10]


@pytest.mark.parametrize(
    ("noises", "by"), [((1e-3, 0.0), 0), ((0.0, 2e-3), 1), ((0.0, 0.0), None), ((9.0, 0.0), "all")]
)
def test_the_band_ends_where_a_channel_sinks_below_its_noise(noises, by):
    """A Gaussian pulse of 5 samples: |X| = 5 sqrt(2 pi) exp(-2 (5 pi f)^2) against sqrt(10 n^2 size)."""
    t = np.arange(1000.0)
    pulse = np.exp(-0.5 * ((t - 400.0) / 5.0) ** 2)
    window = Window(pulse, 0.5 * pulse, noises)
    found = two_sensors._band(window, STEP)
    if by == "all":
        assert found == pytest.approx(450.0)
        assert two_sensors._band(window._replace(cutoff=70.0), STEP) == 70.0
    elif by is None:
        assert found > 100.0
    else:
        height = 5.0 * math.sqrt(2.0 * math.pi) * (0.5 if by else 1.0) / (noises[by] * math.sqrt(1e4))
        assert found == pytest.approx(
            1e3 * math.sqrt(0.5 * math.log(height)) / (5.0 * math.pi), rel=0.03
        )  # five lines are averaged
        assert two_sensors._band(window._replace(cutoff=20.0), STEP) == 20.0


def test_a_wave_in_one_channel_makes_its_delay_uncertain():
    """Of a height of a fifth of the peak, far above the cutoff: a quarter of that over 2 pi of the cutoff."""
    t = np.arange(600.0)
    pulse = np.exp(-0.5 * ((t - 200.0) / 20.0) ** 2)
    wave = (
        0.2
        * np.sin(2.0 * np.pi * 0.2 * t)
        * np.clip((t - 150.0) / 30.0, 0.0, 1.0)
        * np.clip((450.0 - t) / 30.0, 0.0, 1.0)
    )
    window = Window(pulse, 0.5 * (pulse + wave), (1e-9, 1e-9), 30.0)
    found = two_sensors._copied(window, STEP)
    assert found.gain == pytest.approx(0.5, rel=2e-3)
    assert abs(found.delay) < 1e-4
    wave_alone = 0.25 * 0.2 / (2.0 * math.pi * 30.0)
    assert found.delay_doubt == pytest.approx(wave_alone, rel=0.05)
    assert two_sensors._copied(window._replace(second=0.5 * pulse), STEP).delay_doubt < 0.1 * wave_alone
    assert two_sensors._copied(window._replace(cutoff=math.inf), STEP).delay_doubt < wave_alone
    both = Window(pulse + wave, 0.5 * (pulse + wave), (1e-9, 1e-9), 30.0)
    assert two_sensors._copied(both, STEP).delay_doubt < 0.1 * wave_alone  # one that both have is none of it


def test_what_half_of_the_band_says_otherwise_is_not_known(monkeypatch):
    """Beyond its own uncertainty, and as a rectangle: of 2 with 1, sqrt(3 / 3); of 1 with a half, sqrt(0.75 / 3)."""
    copies = {
        100.0: two_sensors.Copy(5.0, 3.0, 2.0, 4.0, 0.9, True),
        50.0: two_sensors.Copy(3.0, 1.0, 1.0, 0.5, 0.8, False),
    }
    monkeypatch.setattr(two_sensors, "_band", lambda window, step: 100.0)
    monkeypatch.setattr(two_sensors, "_copied_below", lambda window, step, cutoff: copies[cutoff])
    found = two_sensors._copied(Window(np.zeros(3), np.zeros(3), (0.0, 0.0)), STEP)
    assert found == two_sensors.Copy(
        5.0, pytest.approx(math.hypot(3.0, 1.0)), 2.0, pytest.approx(math.hypot(4.0, 0.5)), 0.9, True
    )
    copies[50.0] = two_sensors.Copy(4.0, 1.1, 2.0, 0.5, 0.8, False)
    found = two_sensors._copied(Window(np.zeros(3), np.zeros(3), (0.0, 0.0)), STEP)
    assert (found.delay_doubt, found.gain_doubt) == (3.0, 4.0)


def half_sine(size, begin, length, height):
    u = (np.arange(size) - begin) / length
    return np.where((u > 0.0) & (u < 1.0), height * np.sin(np.pi * np.clip(u, 0.0, 1.0)), 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_common_and_differential_motion_of_a_weaker_copy(sign):
    """Zeros of 3 and -5, gain 0.6: the common peak is 0.8 of the first, half the difference -0.2 of it, a quarter of that."""
    rng = np.random.default_rng(7)
    blow = half_sine(3000, 1000, 100, 50.0 * sign)
    first, second = 3.0 + blow + 1e-3 * rng.normal(size=3000), -5.0 + 0.6 * blow + 1e-3 * rng.normal(size=3000)
    found = paired_motion(first, second, STEP, find_pulses(first, STEP, 7.0), 7.0)
    assert found.common.peak == pytest.approx(40.0 * sign, rel=1e-3)
    assert found.common.time == pytest.approx(7.0 + 1.05, abs=2e-3)
    assert found.differential_peak == pytest.approx(-10.0 * sign, rel=1e-3)
    assert found.differential_share == pytest.approx(0.25, rel=1e-3)
    assert found.differential_in_band == pytest.approx(10.0, rel=0.03)
    assert found.common_uncertainty == pytest.approx(found.differential_in_band / math.sqrt(3.0), rel=0.02)
    assert math.isnan(found.rigid_peak)  # 14 %
    assert (found.blows, found.one_body, found.leads) == (1, "no", 0)
    assert found.gain == pytest.approx(0.6, rel=1e-3)
    assert found.explained == pytest.approx(1.0, abs=1e-3)
    assert abs(found.peak_lag) <= 2.0 * STEP


def test_peaks_of_two_copies_lie_apart_by_their_delay():
    rng = np.random.default_rng(3)
    size = 6000
    first = half_sine(size, 1000, 100, 50.0) + half_sine(size, 3500, 100, 30.0) + 1e-3 * rng.normal(size=size)
    second = half_sine(size, 1007, 100, 50.0) + half_sine(size, 3507, 100, 30.0) + 1e-3 * rng.normal(size=size)
    blows = find_pulses(first, STEP)
    found = paired_motion(first, second, STEP, blows)
    assert (found.blows, found.leads) == (2, 1)
    assert found.delay == pytest.approx(7e-3, abs=1e-4)
    assert found.peak_lag == pytest.approx(7e-3, abs=2e-3)
    assert found.common.peak == pytest.approx(50.0 * math.cos(math.pi * 3.5 / 100.0), rel=1e-3)
    back = paired_motion(second, first, STEP, blows)
    assert (back.delay, back.leads) == (pytest.approx(-7e-3, abs=1e-4), 2)


# What belongs to a blow


def test_rebounds_of_a_tenth_of_their_blow_are_its_own(monkeypatch):
    """A small contact that is a rebound was not known when its blow was measured: its ringing is none."""
    pulses = [
        recorded(peak=peak, time=time, ringing_frequency=5.0 * time)
        for peak, time in ((-10.0, 1.0), (1.1, 3.0), (0.9, 2.0), (-1.05, 2.5), (7.0, 5.0), (0.8, 6.0))
    ]
    kinds = SimpleNamespace(owner={1: 0, 2: 0, 3: 0, 5: 4}, blows=[0, 4])
    told = []
    monkeypatch.setattr(measuring, "sort_contacts", lambda *args: told.append(args) or kinds)
    first, second = measuring._owned([(pulse, k == 3) for k, pulse in enumerate(pulses)])
    assert first.rebounds == (Rebound(2.5, -1.05, 0.06), Rebound(3.0, 1.1, 0.06))
    assert second.rebounds == (Rebound(6.0, 0.8, 0.06),)
    assert math.isnan(first.ringing_frequency)
    assert second.ringing_frequency == 25.0
    times, sizes, widths, small = told[0]
    assert (times.tolist(), sizes.tolist()) == ([1.0, 3.0, 2.0, 2.5, 5.0, 6.0], [10.0, 1.1, 0.9, 1.05, 7.0, 0.8])
    assert widths.tolist() == [pulses[0].smooth.width()] * 6
    assert small == [False, False, False, True, False, False]
    pulses[5] = recorded(peak=0.69, time=6.0)
    first, second = measuring._owned([(pulse, k == 5) for k, pulse in enumerate(pulses)])
    assert (second.rebounds, second.ringing_frequency) == ((), 25.0)  # too small to be one
    assert first.ringing_frequency == 5.0  # its rebounds are no small contacts


def test_ringing_is_sought_until_the_next_contact(monkeypatch):
    """Of a double hit it is not; each rigid pulse is handed the one before it."""
    pulses = [
        recorded(time=t, begin=t - 0.01, peak=p, rebounds=r)
        for t, p, r in (
            (7.11, 5.0, (Rebound(7.5, 2.0, 0.1),)),
            (8.0, -5.0, ()),
            (9.0, 5.0, ()),
            (9.1, 5.0, ()),
            (12.0, 5.0, ()),
            (13.0, 5.0, ()),
        )
    ]
    seen, handed = [], []

    class Rigid(SimpleNamespace):
        def moved(self, by, sign):
            return ("moved", self.number, by, sign)

    def rigid(stretch, frequency, last):
        handed.append((frequency, last and last.number))
        return Rigid(number=len(handed)) if frequency > 0.0 else None

    stretches = iter([SimpleNamespace(smooth=SimpleNamespace(begin=begin)) for begin in (0.3, 0.4, 0.5, 0.6)])
    monkeypatch.setattr(measuring, "contacts_of", lambda pulses: SimpleNamespace(double={2: 3}))
    monkeypatch.setattr(measuring, "one_sided", lambda values, step, start, pulse: pulse.rebounds)
    monkeypatch.setattr(
        measuring, "stretch_of", lambda values, step, start, pulse, until: seen.append(until) or next(stretches)
    )
    monkeypatch.setattr(measuring, "ringing_of", lambda stretch: {1: 100.0, 2: 50.0}.get(len(seen), 0.0))
    monkeypatch.setattr(
        measuring,
        "split_bands",
        lambda stretch, frequency: SimpleNamespace(signed=lambda sign: ("split", frequency, sign)),
    )
    monkeypatch.setattr(measuring, "rigid_pulse", rigid)
    found = measuring._with_rigid(np.zeros(5), STEP, 7.0, pulses)
    assert seen == [pytest.approx(7.5 - 0.02), pytest.approx(8.99), pytest.approx(12.99), math.inf]
    assert handed == [(100.0, None), (50.0, 1), (0.0, 2), (0.0, 2)]
    assert [(one.rigid, one.split) for one in found] == [
        (("moved", 1, pytest.approx(7.1 - 0.3), 1.0), ("split", 100.0, 1.0)), (("moved", 2, pytest.approx(7.1 - 0.4), -1.0), ("split", 50.0, -1.0)),
        (None, None), (None, None), (None, None), (None, None),
    ]  # fmt: skip


def test_records_too_short_or_not_finite_are_refused():
    assert find_pulses(np.zeros(16), STEP) == []
    for wrong in (np.zeros(15), np.zeros((4, 16)), np.r_[np.zeros(20), np.nan]):
        with pytest.raises(ValueError, match="record"):
            find_pulses(wrong, STEP)


def test_straight_lines_hold_no_blow_however_large():
    line = 3.0 + 7.0 * np.arange(400.0)
    assert find_pulses(line, STEP) == []
    bump = half_sine(400, 200, 20, 1.0)
    assert len(find_pulses(1e6 * (1.0 + 1e-4 * bump), STEP)) == 1
    assert find_pulses(1e6 * (1.0 + 0.9e-6 * bump), STEP) == []
    assert len(find_pulses(1e6 * (1.0 + 1.1e-6 * bump), STEP)) == 1
    assert find_pulses(0.99e-100 * bump, STEP) == []


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_blow_of_a_record_has_its_own_figures(sign):
    """Half-sines of 40 and 60 samples on a level of 3: widths above a tenth, areas over both, times from 7 s on."""
    rng = np.random.default_rng(5)
    values = (
        3.0 + sign * (half_sine(4000, 1000, 40, 50.0) + half_sine(4000, 2500, 60, 30.0)) + 1e-3 * rng.normal(size=4000)
    )
    first, second = find_pulses(values, STEP, 7.0)
    inside = 1.0 - 2.0 * math.asin(0.1) / math.pi
    for pulse, (begin, length, height) in ((first, (1000, 40, 50.0)), (second, (2500, 60, 30.0))):
        assert pulse.peak == pytest.approx(sign * height, rel=1e-3)
        assert pulse.time == pytest.approx(7.0 + STEP * (begin + 0.5 * length), abs=0.3 * STEP)
        assert pulse.width == pytest.approx(STEP * length * inside, rel=2e-3)
        assert pulse.rise == pytest.approx(STEP * length * (math.asin(0.9) - math.asin(0.1)) / math.pi, rel=5e-3)
        assert pulse.velocity_change == pytest.approx(sign * 2.0 / math.pi * height * length * STEP, rel=2e-3)
        assert pulse.begin == pytest.approx(7.0 + STEP * (begin + length * math.asin(0.02) / math.pi), abs=0.5 * STEP)
        assert pulse.end == pytest.approx(
            7.0 + STEP * (begin + length * (1.0 - math.asin(0.02) / math.pi)), abs=0.5 * STEP
        )
        assert (pulse.method, pulse.step, math.isnan(pulse.ringing_frequency)) == ("record", STEP, True)
        assert pulse.offset == pytest.approx(3.0, abs=1e-3)
        assert pulse.noise == pytest.approx(1e-3, rel=0.1)


@pytest.mark.parametrize(("noise", "method"), [(2.3, "record"), (2.7, "fit")])
def test_where_noise_hides_a_tenth_of_the_peak_the_smooth_pulse_counts(noise, method):
    """A parabola over a third of the box of some 44 samples to either side leaves 0.27 of the noise; a tenth of the peak,
    2, is three times that of 2.47."""
    rng = np.random.default_rng(11)
    values = half_sine(3000, 1000, 60, 20.0) + noise * rng.normal(size=3000)
    (pulse,) = find_pulses(values, STEP)
    assert pulse.method == method
    assert pulse.peak == pytest.approx(20.0, abs=noise)


@pytest.mark.parametrize(("noise", "method"), [(0.9, "record"), (1.05, "fit")])
def test_a_blow_of_few_samples_is_smoothed_over_five_of_them_at_most(noise, method):
    """A parabola over two samples to either side leaves the root of 17 / 35 of the noise, three to either side of 1 / 3: a
    tenth of the peak, 2, is three times that of 0.96, or 1.15."""
    rng = np.random.default_rng(11)
    values = half_sine(3000, 1000, 9, 20.0) + noise * rng.normal(size=3000)
    (pulse,) = find_pulses(values, STEP)
    assert pulse.method == method


def test_what_is_known_of_no_baseline():
    bare = recorded(baseline=LocalBaseline(2.0), uncertainty=PulseUncertainty(0.1, 0.2, 0.4))
    assert bare.area_uncertainty(5.0) == 0.4
    known = LocalBaseline(2.0, wander=0.3, width=10)
    assert recorded(baseline=known, step=NAN, uncertainty=PulseUncertainty(0.1, 0.2, 0.4)).area_uncertainty(5.0) == 0.4
    assert not recorded().differs_without_ringing
    rigid = SimpleNamespace(peak=5.0, width=0.02, velocity_change=0.06, peak_uncertainty=0.3)
    for name, limit in (("peak", 5.0), ("width", 0.02), ("velocity_change", 0.06)):
        for share, differs in ((1.0 / 1.049, False), (1.0 / 1.051, True)):
            assert (
                recorded(rigid=SimpleNamespace(**{**vars(rigid), name: limit * share})).differs_without_ringing
                is differs
            )
    both = recorded(rigid=rigid, split=part(4.5, 0.4))
    assert both.methods_apart == pytest.approx(0.5 / 0.5)
    assert (both.rigid_peak, both.rigid_width) == (5.0, 0.02)
    assert math.isnan(recorded(rigid=rigid, split=part(4.5, 0.4, False)).methods_apart)
