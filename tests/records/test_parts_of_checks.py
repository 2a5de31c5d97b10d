"""Parts of the checks of health, on small examples worked by hand, each bound from both sides."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from strikewave.base.texts import percent
from strikewave.records.baseline import LocalBaseline
from strikewave.records.contacts import Baseline
from strikewave.records.health import blows as blow_checks
from strikewave.records.health import disturbances, examine, limits, sampled_record, zero
from strikewave.records.health import disturbances as ringing_checks
from strikewave.records.health.disturbances import _doubt_of_smooth, _swing_after, goes_back, larger_elsewhere
from strikewave.records.health.limits import BlowShape
from strikewave.records.health.sampled_record import BlowRecord
from strikewave.records.health_notice import BLOW, FIGURES
from strikewave.records.measuring import Rebound, RecordedPulse
from strikewave.records.pulse_shape import PulseUncertainty, SmoothPulse
from strikewave.records.ringing import RigidPulse
from strikewave.records.robust import alike_as_one
from strikewave.records.tail import TailModel

STEP, START = 1e-3, 2.0
OF_THE_ZERO = (
    zero.begins_in_blow,
    zero.begins_in_motion,
    zero.unsettled,
    zero.drift_at_blow,
    zero.drift_before,
    zero.offset,
)
OF_A_SHIFT = (zero.step_with_blow, zero.step_alone, zero.drift_after, zero.zero_shift)


@pytest.fixture(autouse=True)
def nothing_kept():
    """Let each test compute what is kept for the next blow."""
    limits._legendre_fit.cache_clear()
    limits._legendre.cache_clear()
    limits._powers_of_a_sine.cache_clear()


def blow(first, last, peak=4.0, top=None, **more):
    """Return a half-sine between two samples, as it is measured."""
    begin, end = START + STEP * first, START + STEP * last
    smooth = SmoothPulse(peak, begin, end - begin, 0.5, 1.0)
    time = smooth.time if top is None else START + STEP * top
    one = RecordedPulse(
        *(time, peak, 0.0, smooth.width(), smooth.area(), math.nan, 0.0, 0.0, smooth, "record", begin, end),
        LocalBaseline(0.0, 0.0, 0.1, 0.0, 40, 10),
        step=STEP,
    )
    return dataclasses.replace(one, **more)


def record(values, *pulses, **more):
    return BlowRecord(np.asarray(values, dtype=float), STEP, START, "m", tuple(pulses), **more)


def test_effects_of_a_level_under_a_half_sine():
    """A level of a tenth of the peak over a width of 0.936 T: 2 T / (pi sqrt(1 - 0.01)) of the width a peak of level,
    T level of the area 2 T peak / pi; from the peak on, half of both."""
    one = blow(100, 200)
    slope = 2.0 / (math.pi * math.sqrt(0.99)) / (1.0 - 2.0 * math.asin(0.1) / math.pi)
    found = sampled_record.effects_of_level(one, 0.4)
    assert found["peak"] == pytest.approx(0.1)
    assert found["width"] == pytest.approx(0.1 * slope, rel=1e-4)
    assert found["velocity_change"] == pytest.approx(0.1 * math.pi / 2.0)
    after = sampled_record.effects_of_level(one, 0.4, after_peak=True)
    assert (after["peak"], after["width"]) == (found["peak"], 0.5 * found["width"])
    assert after["velocity_change"] == 0.5 * found["velocity_change"]
    assert sampled_record.effects_of_level(dataclasses.replace(one, width=math.nan), 0.4).keys() == {
        "peak",
        "velocity_change",
    }


def test_places_and_times_of_a_record_are_each_others_inverse():
    sampled = sampled_record.SampledRecord(np.zeros(50), STEP, START)
    assert [sampled.place(sampled.time(k)) for k in (0, 7, 49)] == [0, 7, 49]
    assert (sampled.place(0.0), sampled.place(9.0)) == (0, 49)


def test_the_next_blow_is_the_first_that_ends_later():
    first, second, third = blow(10, 20), blow(30, 40), blow(50, 60)
    seen = record(np.zeros(90), third, first, second)
    assert [seen.next_begin(one) for one in (first, second, third)] == [second.begin, third.begin, math.inf]


# clipping


def test_the_longest_run():
    assert limits._longest_run(np.array([1, 0, 1, 1, 0, 1, 1, 1, 0, 1, 1], dtype=bool)) == (5, 7)
    assert limits._longest_run(np.array([1, 1, 0], dtype=bool)) == (0, 1)
    assert limits._longest_run(np.zeros(3, dtype=bool)) == (0, -1)


@pytest.mark.parametrize("middle", [10.0, 10.5])
def test_a_parabola_goes_on_above_where_it_was_cut(middle):
    values = 10.0 - 0.1 * (np.arange(21) - middle) ** 2
    assert limits._cut_off(np.minimum(values, 9.5), 9.5) == pytest.approx(0.5)
    assert limits._cut_off(np.minimum(values, 8.4), 8.4) == math.inf  # of more than six samples
    assert limits._cut_off(np.minimum(values, 9.5)[:16], 9.5) == pytest.approx(0.5)
    assert limits._cut_off(np.minimum(values, 9.5)[:15], 9.5) == math.inf


def test_a_parabola_is_laid_through_three_samples_to_either_side():
    """Of a run at 20 to 25: beside it 17 to 19 and 26 to 28, of which no parabola holds all."""
    values = np.zeros(60)
    values[17:29] = [3.0, 4.5, 7.0, *[9.0] * 6, 8.0, 6.0, 1.5]
    places = np.array([-5.5, -4.5, -3.5, 3.5, 4.5, 5.5])
    top = np.polyfit(places, [3.0, 4.5, 7.0, 8.0, 6.0, 1.5], 2)[2]
    assert limits._cut_off(values, 9.0) == pytest.approx(top - 9.0)
    assert limits._cut_off(values[17:29], 9.0) == pytest.approx(top - 9.0)
    assert limits._cut_off(values[18:], 9.0) == limits._cut_off(values[:28], 9.0) == math.inf


@pytest.mark.parametrize(
    ("at", "beside", "zero", "found"),
    [(9, 3, 0.0, 9), (9, 4, 0.0, 0), (8, 3, 0.0, 0), (9, 3, 96.9, 9), (9, 3, 97.0, 0), (3, 0, 0.0, 3), (2, 0, 0.0, 0)],
)
def test_a_rail_has_three_times_as_many_samples_as_the_two_steps_beside_it(at, beside, zero, found):
    """Steps of 1 up to 100: 99 and 98 lie beside it, 97 and 95 do not."""
    values = np.r_[
        np.zeros(9), 50.0, [97.0] * 7, 95.0, [99.0] * (beside // 2), [100.0] * at, [98.0] * (beside - beside // 2)
    ]
    if not beside:
        values = np.r_[np.zeros(9), 50.0, 97.0, 96.0, [100.0] * at, np.zeros(2)]
    assert limits.rail(values, zero).size == found


def test_three_values_stand_among_four_thousand_samples_of_a_rail():
    """Three values must stand among some four thousand samples: of 8192 every second one is looked at."""
    values = np.zeros(8192)
    values[1000:1010] = 100.0
    assert limits.rail(values, 0.0).size == 0
    values[2001] = 50.0
    assert limits.rail(values, 0.0).size == 0
    assert limits.rail(values[:-1], 0.0).size == 10
    values[2002] = 50.0
    assert limits.rail(values, 0.0).size == 10


# the shape of blows


def test_the_last_sample_below_a_level():
    heights = np.array([0.0, 0.1, 0.3, 0.2, 0.6, 1.0])
    assert limits._last_below(heights, np.array([0.05, 0.15, 0.25, 0.5, 0.7, 2.0])).tolist() == [0, 1, 3, 3, 4, 5]
    assert limits._last_below(heights + 1.0, np.array([0.5])).tolist() == [0]
    assert limits._to_both_sides(np.array([-2.0, 3.0])) == 2.0
    assert limits._to_both_sides(np.array([1.0, 3.0])) == -1.0


def half_sine(power=1.0, most=math.inf):
    u = np.clip((np.arange(900) - 300.0) / 200.0, 0.0, 1.0)
    return np.minimum(4.0 * np.sin(np.pi * u) ** power, most)


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0, 3.0])
def test_the_tip_of_a_power_of_a_sine(power):
    """Widths of tip and upper half in closed form; the power is told from the flanks."""
    seen = BlowShape(record(half_sine(power)), blow(300, 500))
    widths = [math.acos(share ** (1.0 / power)) for share in (0.9, 0.5)]
    assert seen.tip == pytest.approx(widths[0] / widths[1], abs=0.002)  # a polynomial follows it to 0.1 %
    assert seen.usual_tip == pytest.approx(widths[0] / widths[1], abs=0.002)
    assert seen.half_sine_of_flanks == pytest.approx(1.0 if power == 1.0 else seen.half_sine_of_flanks, abs=0.02)


@pytest.mark.parametrize("most", [3.2, 2.4])
def test_the_half_sine_of_the_flanks_of_a_clipped_one(most):
    seen = BlowShape(record(half_sine(1.0, most)), blow(300, 500, most))
    assert seen.half_sine_of_flanks == pytest.approx(4.0 / most, rel=0.03)  # widths of samples, 1 % each


def tent(rise, fall):
    return np.interp(np.arange(900.0), [300.0, 300.0 + rise, 300.0 + rise + fall], [0.0, 4.0, 0.0])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_sides_of_a_tent(sign):
    """Slopes are those of the sides, to all digits: neither bends, and both go on to the peak."""
    seen = BlowShape(record(sign * tent(100, 50)), blow(300, 450, sign * 4.0, 400))
    for flank, halfway, slope in zip(seen.flanks, (-1, 1), (4.0 / (100 * STEP), 4.0 / (50 * STEP)), strict=True):
        assert flank.slope == pytest.approx(slope)
        assert flank.bend == pytest.approx(0.0, abs=1e-12)
        assert flank.goes_on == pytest.approx(1.0)
        assert seen.slope_halfway(halfway) == pytest.approx(slope)
    assert seen.side(1)[[0, -1]].tolist() == [0.0, 1.0]
    assert (seen.heights.size, seen.top) == (151, 100)


def test_a_limit_bends_a_straight_side_before_its_tip():
    """Cut at 0.8 of the tip, with the time of the peak where it was: the side goes on to 1.25 of what is left."""
    seen = BlowShape(record(np.minimum(tent(100, 50), 3.2)), blow(300, 450, 3.2, 400))
    assert seen.flanks[0].goes_on == pytest.approx(1.25, rel=1e-6)
    assert limits._bent_off(seen) == pytest.approx(0.25, rel=1e-6)
    assert limits._bent_off(BlowShape(record(half_sine()), blow(300, 500))) == 0.0
    assert limits._bent_off(BlowShape(record(tent(100, 50)), blow(300, 450, 4.0, 400))) == 0.0


def test_what_swings_after_a_blow_to_both_sides():
    values = half_sine()
    values[520] = -0.5
    values[560] = 0.3
    one = blow(300, 500)
    assert BlowShape(record(values), one).swing_to_both_sides == pytest.approx(0.3 / 4.0)
    assert BlowShape(record(values), dataclasses.replace(one, noise=0.05)).swing_to_both_sides == pytest.approx(
        0.1 / 4.0
    )
    values[560] = 0.0
    values[500 + round(2.0 * one.width / STEP) + 2] = 0.9
    assert BlowShape(record(values), one).swing_to_both_sides == pytest.approx(0.0, abs=1e-12)


def test_noise_of_a_top_is_white_or_that_of_a_fifth_of_the_width():
    """Seven coefficients over the samples of the width, or the ripple if it is more."""
    one = blow(300, 500, noise=0.2)
    white = 0.2 * math.sqrt(7.0 / (one.width / STEP)) / 4.0
    assert BlowShape(record(half_sine()), one).noise_of_top == pytest.approx(white)
    rippled = dataclasses.replace(one, baseline=one.baseline._replace(ripple=0.4))
    assert BlowShape(record(half_sine()), rippled).noise_of_top == pytest.approx(0.1)


def test_tops_are_judged_together():
    shapes = [BlowShape(record(half_sine(power)), blow(300, 500, noise=0.2)) for power in (1.0, 2.0)]
    top = limits.top_of(shapes)
    assert top.sharpness == pytest.approx(np.mean([one.tip for one in shapes]))
    assert top.usual == pytest.approx(np.mean([one.usual_tip for one in shapes]))
    assert top.doubt == pytest.approx(1.8 * 3.0 * shapes[0].noise_of_top / math.sqrt(2.0))
    assert limits.top_of([]) is None


# ringing and sampling


def test_a_record_goes_back_by_its_deepest_fall():
    """Beyond six standard deviations of noise: by 0.96 on the way up, and 0.42, 0.34 and so on to 0.1 on the way down."""

    def of(values):
        seen = record(values)
        vars(seen).update(scatter=0.01)
        return goes_back(seen, blow(300, 450, 4.0, 400))

    values = tent(100, 50)
    values[380] -= 1.0
    values[430] += 0.5
    assert of(values) == (pytest.approx(0.90 / 4.0), pytest.approx(STEP * (0.96 + 1.3)))
    assert of(tent(100, 50)) == (0.0, 0.0)
    early = tent(100, 50)
    early[290] = 0.7  # within a quarter of a width before the foot
    assert of(early)[0] == pytest.approx(0.64 / 4.0)
    early[[290, 260]] = 0.0, 0.7
    assert of(early)[0] == 0.0


def test_the_doubt_of_a_smooth_pulse_is_the_swing_that_it_misses():
    """A swing of 0.05 root mean square: sqrt 2 of it on the peak, and A / (pi f) of an area of 2 T / pi."""
    one = blow(300, 500)
    one = dataclasses.replace(one, smooth=one.smooth._replace(misfit=0.05))
    found = _doubt_of_smooth(one, 40.0)
    amplitude = 0.05 * math.sqrt(2.0)
    slope = 2.0 / (math.pi * math.sqrt(0.99)) / (1.0 - 2.0 * math.asin(0.1) / math.pi)
    assert found["peak"] == pytest.approx(amplitude)
    assert found["width"] == pytest.approx(amplitude * slope, rel=6e-3)  # of two digits
    assert found["velocity_change"] == pytest.approx(amplitude / (math.pi * 40.0) / (2.0 / math.pi * 0.2))


@pytest.mark.parametrize(("place", "swing"), [(560, 0.4), (540, 0.0), (500 + 5 * 187 - 2, 0.4), (500 + 5 * 188, 0.0)])
def test_a_record_swings_from_a_quarter_of_a_width_after_a_blow_up_to_five(place, swing):
    values = np.zeros(2000)
    values[place] = 0.8
    assert _swing_after(record(values), blow(300, 500)) == swing
    assert _swing_after(record(values), blow(300, 500, noise=0.081)) == 0.0
    narrow = blow(300, 500, width=100 * STEP)
    values[place], values[[524, 525, 999, 1000]] = 0.0, [9.0, 0.4, 0.0, 9.0]
    assert _swing_after(record(values), narrow) == 0.2
    values[[524, 525, 999, 1000]] = 0.0
    values[place] = 0.8
    assert _swing_after(record(values), blow(300, 500, width=math.nan)) == swing
    after = blow(900, 950)
    assert _swing_after(record(values, blow(300, 500), after), blow(300, 500)) == 0.0


@pytest.mark.parametrize(("times", "swing"), [((3.65, 9.0), 0.4), ((9.0, 3.6), 0.0), ((), 0.4)])
def test_a_rebound_within_five_widths_hides_what_swings(times, swing, monkeypatch):
    """Which begins a width, 0.187 s, before its peak; five widths end at 3.436 s."""
    monkeypatch.setattr(ringing_checks, "one_sided", lambda *given: [SimpleNamespace(time=time) for time in times])
    values = np.zeros(2000)
    values[560] = 0.8
    assert _swing_after(record(values), blow(300, 500)) == swing


def test_a_record_is_larger_elsewhere_by_five_noises():
    values = np.zeros(900)
    values[350] = 6.0  # in the blow
    one = blow(300, 500, noise=0.1)
    for height, seen in ((4.49, 0), (-4.51, 1)):
        values[501] = height
        assert len(examine(record(values, one), larger_elsewhere)) == seen
    values[[500, 501]] = 9.0, 0.0
    assert examine(record(values, one), larger_elsewhere) == []
    assert examine(record(values), larger_elsewhere) == []


def test_what_stands_at_half_the_rate():
    """A spectrum that is flat, of a spike, stands there as high as anywhere; noise of a fourth of it hides it."""
    spike = np.zeros(256)
    spike[128] = 1.0
    assert limits.folded_level(spike, 0.0) == pytest.approx(1.0)
    heard = np.hanning(256)[128] / math.sqrt(0.375 * 256)
    assert limits.folded_level(spike, 0.24 * heard) is not None
    assert limits.folded_level(spike, 0.26 * heard) is None
    assert limits.folded_level(np.zeros(9), 0.0) is None
    t = np.arange(256)
    for share, seen in ((0.05, True), (0.03, False)):  # a line is spread over 20 of 129: rms of 0.25 of it
        values = np.cos(2.0 * np.pi * 20 / 256 * t) + share * np.cos(2.0 * np.pi * 120 / 256 * t)
        level = share * math.sqrt((1.0 + 0.25 + 0.25) / 20.0)
        found = limits.folded_level(values, 0.0)
        assert (found is not None) is (level > 0.02)
        assert not seen or found is None or found == pytest.approx(level, rel=0.05)


# trains and blows


def test_rebounds_are_told_by_the_median_of_their_shares_and_lags():
    pulses = []
    for k, (share, lag) in enumerate(((0.2, 0.02), (0.3, 0.03), (0.5, 0.07))):
        one = blow(100 + 300 * k, 150 + 300 * k, -4.0)
        pulses.append(dataclasses.replace(one, rebounds=(Rebound(one.time + lag, -4.0 * share, -0.1),)))
    [notice] = examine(record(np.zeros(999), *pulses), blow_checks.rebounds)
    assert notice.value == pytest.approx(0.3)
    assert "3 smaller contacts beside 3 of 3 blows, 30 % of the peak, 30\xa0ms after" in notice.message
    assert (notice.start, notice.end) == (pulses[0].time + 0.02, pulses[2].time + 0.07)
    [one] = examine(record(np.zeros(999), pulses[0]), blow_checks.rebounds)
    assert "1 smaller contact beside the blow, 20 %" in one.message
    assert examine(record(np.zeros(999), blow(100, 150)), blow_checks.rebounds) == []


def test_a_double_hit_has_both_its_blows():
    pulses = [blow(100, 110), blow(130, 140, 3.9), blow(700, 710, 4.1)]
    [notice] = examine(record(np.zeros(900), *pulses), blow_checks.double_hit)
    assert notice.value == 1
    assert (notice.start, notice.end) == (pulses[0].begin, pulses[1].end)
    assert "of 4 m and 3.9 m, 30\xa0ms apart" in notice.message
    assert examine(record(np.zeros(900), pulses[0], pulses[2]), blow_checks.double_hit) == []


def test_missing_blows_are_listed_three_and_counted():
    pulses = [blow(100 * k, 100 * k + 10) for k in (1, 2, 3, 4, 7, 8, 11)]
    [notice] = examine(record(np.zeros(1200), *pulses), blow_checks.missing_blow)
    assert notice.value == 4
    assert "no blow at 2.505\xa0s, 2.605\xa0s, 2.905\xa0s and 1 more" in notice.message
    assert (notice.start, notice.end) == (pytest.approx(2.505), pytest.approx(3.005))
    assert "every 100\xa0ms" in notice.message


@pytest.mark.parametrize(("edge", "told"), [(0.39, []), (0.41, ["begins", "ends"])])
def test_a_part_of_another_blow_at_both_edges(edge, told):
    """A tenth of the peak at the edge, which is gone within a width."""
    values = np.zeros(3000)
    values[1400:1600] = half_sine()[300:500]
    values[:60] = values[-60:] = edge
    one = blow(1400, 1600)
    found = examine(record(values, one), blow_checks.cut, blow_checks.part_of_blow)
    assert [word for word in ("begins", "ends") if any(word in notice.message for notice in found)] == told
    if told:
        assert [notice.start for notice in found] == [START, pytest.approx(START + 2999 * STEP)]
        values[500] = values[-500] = 0.21  # within four widths it strays by more than half of that
        assert examine(record(values, one), blow_checks.cut, blow_checks.part_of_blow) == []


# zero


def test_a_level_steps_at_a_place():
    values = np.r_[np.zeros(30), np.full(70, 2.0)]
    assert zero.level_step(values) == (30, 2.0)
    assert zero.level_step(-values) == (30, -2.0)
    assert zero.level_step(values[15:]) is None  # sixteen samples at least
    assert zero.level_step(values[14:]) == (16, 2.0)
    stray = 0.21 * np.tile([1.0, -1.0], 50)
    assert zero.level_step(values + stray) is None  # a tenth of the step
    assert zero.level_step(values + 0.19 / 0.21 * stray) is not None
    values[50] = 24.9
    assert zero.level_step(values) is not None  # 8 % of the span
    values[50] = 25.1
    assert zero.level_step(values) is None


def test_a_step_near_a_blow_is_within_a_length_of_it(monkeypatch):
    monkeypatch.setattr(zero, "level_step", lambda values: (int(values[0]), 1.0))
    seen = [record(np.full(900, place), blow(300, 400)) for place in (199, 201, 499, 501)]
    codes = [notice.code for one in seen for notice in examine(one, zero.step_with_blow, zero.step_alone)]
    assert codes == ["zero-step", "zero-shift", "zero-shift", "zero-step"]


@pytest.mark.parametrize(
    ("level", "share", "severity"), [(0.19, 0.0475, None), (0.21, 0.0525, "good"), (2.1, 0.525, "suspect")]
)
def test_a_zero_far_off_is_noted_from_a_twentieth_of_the_peak_on(level, share, severity):
    one = blow(300, 500, offset=level)
    notices = examine(record(np.zeros(900), one), *OF_THE_ZERO)
    assert [notice.severity for notice in notices] == ([] if severity is None else [severity])
    assert all(notice.value == level for notice in notices)


def test_a_velocity_drifts_by_what_the_record_stands_off():
    """A hundred widths after a blow of area 0.5: standing at c for 1800 samples makes 1.8 c."""
    one = blow(100, 120)
    for level, severity in ((0.49, None), (0.51, "good"), (1.99, "good"), (2.01, "suspect")):
        values = np.r_[np.zeros(120), np.full(1800, level * abs(one.velocity_change) / 1.8)]
        found = examine(record(values, one), zero.velocity_drift)
        assert [notice.severity for notice in found] == ([] if severity is None else [severity])
        if found:
            assert found[0].value == pytest.approx(level * one.velocity_change, rel=1e-9)
    assert examine(record(values[: 120 + 700], one), zero.velocity_drift) == []  # less than 40 widths of 18.7
    late = np.r_[np.full(120 + 1350, -9.0), np.full(450, abs(one.velocity_change) / 1.8)]  # the last quarter tells it
    assert examine(record(late, one), zero.velocity_drift)[0].value == pytest.approx(one.velocity_change)
    for stray, told in ((math.sqrt(450.0) / 3.0 * 0.99, True), (math.sqrt(450.0) / 3.0 * 1.01, False)):
        noisy = late * (1.0 + stray * (-1.0) ** np.arange(late.size))  # three standard errors of its mean
        assert bool(examine(record(noisy, one), zero.velocity_drift)) is told


def test_blows_without_a_foot_are_held_against_the_record():
    one = blow(300, 500)
    values = half_sine() * 0.8
    [notice] = examine(record(values, one), zero.no_foot)
    assert dict(notice.effects)["velocity_change"] == pytest.approx(0.25, rel=1e-3)
    assert examine(record(values, dataclasses.replace(one, begin=one.begin - STEP)), zero.no_foot) == []
    assert examine(record(values, dataclasses.replace(one, method="fit")), zero.no_foot) == []


# noise


def test_effects_are_those_of_the_median_blow_on_the_smallest():
    """Doubts of 0.1, 0.2 and 0.4 of the peak's unit, under peaks of 4, 2 and 8: their median is a tenth of the smallest."""
    pulses = [
        blow(300 * k, 300 * k + 50, peak, uncertainty=PulseUncertainty(doubt, 0.0, 0.0))
        for k, (peak, doubt) in enumerate(((4.0, 0.1), (-2.0, 0.2), (8.0, 0.4)), start=1)
    ]
    found = disturbances.worst_effects(record(np.zeros(2000), *pulses))
    single = [disturbances.worst_effects(record(np.zeros(2000), one))["peak"] * abs(one.peak) for one in pulses]
    assert found["peak"] == pytest.approx(np.median(single) / 2.0)
    assert single[1] / single[0] == pytest.approx(2.0)
    assert single[2] / single[0] == pytest.approx(4.0)


@pytest.mark.parametrize(("peak", "severity"), [(5.7, "good"), (5.5, "suspect")])
def test_a_noisy_blow_is_suspect_below_15_db(peak, severity):
    one = blow(300, 500, -peak, method="fit", noise=1.0)
    [notice] = examine(record(np.zeros(900), one), disturbances.noisy)
    assert notice.value == pytest.approx(20.0 * math.log10(peak))
    assert notice.severity == severity
    small = dataclasses.replace(one, peak=1e-3 * one.peak, noise=1e-3)
    assert examine(record(np.zeros(900), small), disturbances.noisy)[0].value == pytest.approx(notice.value)
    assert examine(record(np.zeros(900), dataclasses.replace(one, method="record")), disturbances.noisy) == []


# a zero without blows


def beginning(first=4.0, second=0.0, end=0.0, size=2000):
    """Return a record that begins in a ramp of a hundred samples, and what it spans after that and at its end."""
    values = np.zeros(size)
    values[:100] = np.linspace(first, 0.0, 100)
    values[150] = second
    values[-1] = end
    return values


def unsettled(values, noise=0.1, level=0.0, slope=0.0):
    seen = record(values)
    vars(seen).update(noise=noise, line=Baseline(level, slope))
    return [(one.code, one.value, one.severity, one.harms) for one in examine(seen, *OF_THE_ZERO)]


@pytest.mark.parametrize(
    ("more", "noise", "found"),
    [
        ({}, 0.199, "cut"),
        ({}, 0.201, None),
        ({"end": 0.79}, 0.1, "cut"),
        ({"end": 0.801}, 0.1, None),
        ({"second": 0.39}, 0.1, "cut"),
        ({"second": 0.41}, 0.1, "not-settled"),
        ({"first": -4.0}, 0.1, "cut"),
    ],
)
def test_a_record_begins_in_a_blow_that_falls_off_on_one_side(more, noise, found):
    """It spans 4 in its first twentieth: 20 noises of 0.2, five ends of 0.8, ten times what the next twentieth does."""
    [*notices] = unsettled(beginning(**more), noise)
    first = more.get("first", 4.0)
    expected = {"cut": ("cut", START, "bad", FIGURES), "not-settled": ("not-settled", abs(first), "bad", FIGURES)}
    assert notices == ([expected[found]] if found else [])


def test_a_record_that_swings_first_to_both_sides_is_not_settled():
    """By a tenth to the other side; the zero is that of the line in the middle of the record."""
    for deep, code in ((-0.398, "cut"), (-0.402, "not-settled")):
        values = beginning(4.0) + 10.0
        values[50] = 10.0 + deep
        [(found, _, _, _)] = unsettled(values, 0.05, 10.0 - 0.001 * 1000.0, 0.001)
        assert found == code
    [(_, value, _, _)] = unsettled(values, 0.05, 10.0)
    assert value == pytest.approx(4.402)
    assert unsettled(beginning(4.0, 0.5, 0.81), 0.1) == []
    assert unsettled(beginning(4.0, 0.5, 0.79), 0.1)[0][0] == "not-settled"
    assert unsettled(beginning(4.0, 0.5), 0.201) == []


@pytest.mark.parametrize(
    ("level", "drift", "stray", "found"),
    [
        (9.9, 0.0, 0.0, False),
        (10.1, 0.0, 0.0, True),
        (-10.1, 0.0, 0.0, True),
        (-1.0, 2.01, 0.0, True),
        (1.0, -1.99, 0.0, False),
        (10.1, 0.0, 0.2, False),
        (30.0, 0.0, 0.2, True),
        (-1.0, 2.01, 0.2, False),
        (-2.5, 6.0, 0.2, True),
    ],
)
def test_a_zero_far_off_or_adrift_is_not_settled(level, drift, stray, found):
    """Of noise 0.1: 100 of it off, or 20 of it between first and last sample; what the record strays about its line
    counts as noise does, 1.48 of its median."""
    size = 2000
    line = level + drift / (size - 1) * np.arange(size)
    notices = unsettled(line + stray * (-1.0) ** np.arange(size), 0.1, level, drift / (size - 1))
    assert notices == (
        [("not-settled", pytest.approx(level + drift * 1000.0 / 1999.0), "bad", FIGURES)] if found else []
    )


# a zero beside blows


@pytest.mark.parametrize(
    ("slope", "severity"), [(3.9e-4 / 1.872, None), (4.1e-4 / 1.872, "suspect"), (-1e-3, "suspect")]
)
def test_a_drift_with_nothing_before_the_blow_falsifies_its_peak(slope, severity):
    """Half of forty widths of 187 samples: 2 % of a peak of 4 are a slope of 0.08 / 3744 a sample."""
    one = blow(300, 500, baseline=LocalBaseline(0.0))
    seen = record(np.zeros(900), dataclasses.replace(one, width=one.width))
    slope *= 0.08 / 3744.0 / (4e-4 / 1.872) * (187.2 / (one.width / STEP))
    vars(seen).update(line=Baseline(0.0, slope))
    found = examine(seen, *OF_THE_ZERO)
    assert [(one.code, one.value, one.severity) for one in found] == (
        [("drift", pytest.approx(899 * slope), severity)] if severity else []
    )
    assert not found or found[0].harms == (*BLOW, "spectrum")


@pytest.mark.parametrize(("drift", "noted"), [(0.19, False), (0.21, True), (-0.21, True)])
def test_a_drift_before_a_blow_is_noted_from_a_twentieth_of_the_peak_on(drift, noted):
    one = blow(300, 500, -4.0)
    one = dataclasses.replace(one, baseline=one.baseline._replace(slope=drift / 899))
    found = examine(record(np.zeros(900), one), *OF_THE_ZERO)
    assert [(each.code, each.value, each.severity, each.harms) for each in found] == (
        [("drift", pytest.approx(drift), "good", ("spectrum",))] if noted else []
    )


def shift_of(model, *pulses):
    seen = record(np.zeros(900), *(pulses or (blow(300, 400, 5.0), blow(600, 700, -4.0))))
    vars(seen).update(tail=model)
    return [(one.code, one.severity, "spectrum" in one.harms) for one in examine(seen, *OF_A_SHIFT)]


@pytest.mark.parametrize(
    ("kind", "level", "error", "found"),
    [
        ("shift", 0.039, 0.0, []),
        ("shift", 0.041, 0.0, [("zero-shift", "good", True)]),
        ("shift", -0.041, 0.0, [("zero-shift", "good", True)]),
        ("shift", 0.041, 0.0136, [("zero-shift", "good", True)]),
        ("shift", 0.041, 0.0138, []),
        ("shift", 0.119, 0.0, [("zero-shift", "good", True)]),
        ("shift", 0.121, 0.0, [("zero-shift", "suspect", True)]),
        ("decay", 0.041, math.nan, [("zero-shift", "good", True)]),
        ("line", 0.199, 0.0, []),
        ("line", -0.201, 0.0, [("drift", "good", True)]),
        ("rest", 0.3, 0.0, []),
        ("motion", 0.3, 0.0, []),
        ("ac-coupling", 0.3, 0.0, []),
    ],
)
def test_a_shift_is_noted_from_a_hundredth_of_the_smallest_peak_and_three_errors_on(kind, level, error, found):
    assert shift_of(TailModel(kind, level, error, 0.02)) == found
    assert shift_of(None) == []


def test_a_shift_says_what_it_may_have_done_from_the_peak_on():
    """Half of it on the width and the area of the last blow, without a sign."""
    pulses = blow(300, 400, 5.0), blow(600, 700, -4.0)
    seen = record(np.zeros(900), *pulses)
    vars(seen).update(tail=TailModel("decay", 0.2, 0.0, 0.0213))
    [found] = examine(seen, *OF_A_SHIFT)
    expected = sampled_record.effects_of_level(pulses[1], 0.2, after_peak=True)
    assert dict(found.effects) == pytest.approx({name: abs(effect) for name, effect in expected.items()})
    assert "by 0.2 m, 5.0 % of the peak, and comes back with a time constant of 21.3\xa0ms" in found.message
    assert (found.value, found.start) == (0.2, pulses[1].end)
    line = TailModel("line", -0.3)
    vars(seen).update(tail=line)
    assert examine(seen, *OF_A_SHIFT)[0].start == pulses[1].end


def test_a_record_that_steps_is_told_with_its_place():
    values = np.r_[np.zeros(500), np.full(500, 2.0)]
    for pulses, code in (((), "zero-step"), ((blow(420, 480),), "zero-shift")):
        [found] = examine(record(values, *pulses), *OF_A_SHIFT)
        assert (found.code, found.value, found.start) == (code, 2.0, START + 500 * STEP)


def test_ac_coupling_falsifies_a_figure_by_the_most_of_all_blows():
    pulses = blow(300, 400, 5.0), blow(600, 700, 4.0)
    others = (
        dataclasses.replace(pulses[0], peak=5.0 / 0.97, width=pulses[0].width / 1.01),
        dataclasses.replace(
            pulses[1], peak=4.0 / 0.98, width=pulses[1].width / 0.98, velocity_change=pulses[1].velocity_change / 0.9
        ),
    )
    seen = record(np.zeros(900), *pulses)
    vars(seen).update(tail=TailModel("ac-coupling", -0.1, math.nan, 0.05, 1e-3), uncoupled_pulses=others)
    [found] = examine(seen, zero.ac_coupling)
    assert dict(found.effects) == pytest.approx({"peak": -0.03, "width": -0.02, "velocity_change": -0.1})
    assert (found.value, found.start) == (0.05, pulses[0].begin)
    assert "high-pass of 3.183\xa0Hz" in found.message
    assert "tau = 50\xa0ms +- 2\xa0ms" in found.message
    cut = (dataclasses.replace(pulses[0], width=math.nan), pulses[1])
    seen = record(np.zeros(900), *cut)
    vars(seen).update(tail=TailModel("ac-coupling", -0.1, math.nan, 0.05, 1e-3), uncoupled_pulses=cut)
    assert dict(examine(seen, zero.ac_coupling)[0].effects) == {"peak": 0.0, "width": 0.0, "velocity_change": 0.0}
    vars(seen).update(uncoupled_pulses=())
    [found] = examine(seen, zero.ac_coupling)
    assert set(dict(found.effects).values()) == {-1.0}
    vars(seen).update(tail=TailModel("ac-coupling", -0.1, math.nan, 0.4, 1e-3))
    assert dict(examine(seen, zero.ac_coupling)[0].effects)["peak"] == pytest.approx(-0.5 * 0.1 / 0.4)
    vars(seen).update(tail=TailModel("shift", 0.1))
    assert examine(seen, zero.ac_coupling) == []


@pytest.mark.parametrize(
    ("stands", "as_at_first"), [(0.0, False), (0.049, False), (0.051, True), (0.149, True), (0.151, False)]
)
def test_a_velocity_does_not_drift_where_the_record_ends_as_it_began(stands, as_at_first):
    """The record ends at 0.1, which drifts by ten times the velocity change in so long; where it stood within a twentieth
    of a second of that at first, its zero is that."""
    one = blow(200, 220, 4.0)
    change = one.velocity_change
    size = 2001
    after = (size - 220) * STEP
    unit = change / after  # drifts by the velocity change
    values = np.full(size, 10.0 * unit)
    values[:100] = 10.0 * unit + (stands - 0.1) / 0.1 * unit
    seen = record(values, one)
    level, drift = 10.0 * unit, 10.0 * change
    assert zero._as_at_first(seen, level, drift) is as_at_first
    assert zero._as_at_first(seen, level, 1e-3 * change) is (stands == 0.1)
    near = record(values, blow(199, 219, 4.0))  # less than two beginnings before the blow
    assert not zero._as_at_first(near, level, drift)


# noise and hum

RATE = 1800.0
"""Of samples that are the means of hum, 30 a period of 60 Hz."""


def hum(frequency, amplitude, size, third=0.0, rate=RATE):
    angle = 2.0 * np.pi * frequency * np.arange(size) / rate + 0.4
    return amplitude * np.sin(angle) + third * np.sin(3.0 * angle)


def hum_of(values, spans=(), step=1.0 / RATE, start=0.0):
    return disturbances.hum_beside(np.asarray(values, dtype=float), step, start, spans)


@pytest.mark.parametrize("frequency", [50.0, 60.0])
def test_hum_with_its_harmonic_is_found_exactly(frequency):
    """Half of what it spans; a mean over three samples takes sin(3 x) / (3 sin x) of a line, x = pi f / rate."""
    values = 5.0 + hum(frequency, 2.0, 900, 0.5)
    assert hum_of(values) == (frequency, pytest.approx(0.5 * np.ptp(values), rel=1e-9))
    assert hum_of(1e-9 * values)[1] == pytest.approx(0.5e-9 * np.ptp(values), rel=1e-6, abs=0.0)
    x = math.pi * frequency / (3.0 * RATE)
    fine = hum_of(hum(frequency, 2.0, 2700, rate=3.0 * RATE), step=1.0 / (3.0 * RATE))
    whole = np.max(np.abs(hum(frequency, 2.0, 2700, rate=3.0 * RATE)[1::3])) / 2.0
    assert fine == (frequency, pytest.approx(2.0 * whole * math.sin(3.0 * x) / (3.0 * math.sin(x)), rel=1e-9))


def test_hum_is_sought_where_its_third_harmonic_is_sampled():
    for rate, seen in ((361.0, True), (359.0, False)):
        assert (hum_of(hum(60.0, 2.0, 400, rate=rate), step=1.0 / rate) is not None) is seen


@pytest.mark.parametrize(("share", "seen"), [(0.8, True), (0.83, False)])
def test_hum_explains_six_tenths_of_the_quiet_parts(share, seen):
    """Beside a line of whole periods: 1 of 1 + share^2; before the blow and after it alike."""
    values = hum(60.0, 1.0, 1800)
    beside = share * np.sin(2.0 * np.pi * 700.0 * np.arange(1800) / RATE)
    assert (hum_of(values + beside) is not None) is seen
    for part in (slice(0, 600), slice(600, None)):
        only = values.copy()
        only[part] += beside[part]
        assert (hum_of(only, [(600.01 / RATE, 600.02 / RATE)]) is not None) is seen
    assert hum_of(values + 0.001 * beside, [(14.5 / RATE, 14.6 / RATE)]) is not None
    values[:14] = 0.0  # fewer than half a period of the means tell nothing
    assert hum_of(values, [(14.5 / RATE, 14.6 / RATE)]) is not None
    values[:16] = 0.0
    assert hum_of(values, [(16.5 / RATE, 16.6 / RATE)]) is None


@pytest.mark.parametrize("frequency", [31.0, 40.0, 62.5, 80.0, 37.2, 48.0, 75.0, 96.0])
def test_what_swings_beside_the_mains_is_no_hum(frequency):
    values = hum(frequency, 2.0, 300) + hum(50.0 if frequency in (31.0, 40.0, 62.5, 80.0) else 60.0, 0.5, 300)
    assert hum_of(values) is None


def test_hum_is_looked_for_beside_blows():
    """A length before each and twenty after it are not quiet; where too little is left, three after it."""
    clean = hum(50.0, 1.0, 1800)
    begin, end = 900.5 / RATE, 910.5 / RATE
    expected = pytest.approx(hum_of(clean)[1], rel=1e-9)
    for place, seen in ((891, True), (1110, True), (889, False), (1112, False)):
        values = clean.copy()
        values[place] += 40.0
        found = hum_of(values, [(begin, end)])
        assert (found is not None and found[1] == expected) is seen
    for start, place, seen in ((0.0, 1110, True), (5.0, 1110, True), (5.0, 1112, False)):
        values = clean.copy()
        values[place] += 40.0
        found = hum_of(values, [(start + begin, start + end)], start=start)
        assert (found is not None and found[1] == expected) is seen
    short = hum(50.0, 1.0, 200)
    for place, seen in ((99, True), (112, False), (110, True)):  # 20 lengths reach beyond the end
        values = short.copy()
        values[place] += 40.0
        found = hum_of(values, [(70.5 / RATE, 80.5 / RATE)])
        assert (found is not None and found[1] == pytest.approx(hum_of(short)[1], rel=1e-9)) is seen


def test_a_mean_lies_in_the_middle_of_its_samples():
    """Of three; a length before a blow ends at the first of them, so that it is not quiet."""
    rate = 3.0 * RATE
    values = hum(50.0, 1.0, 5400, rate=rate)
    values[1200:1203] = 40.0
    for begin, seen in ((1210.0, True), (1211.5, False)):
        found = hum_of(values, [(begin / rate, (begin + 10.0) / rate)], step=1.0 / rate)
        assert (found is not None and found[1] < 1.01) is seen


def test_six_thousand_means_are_looked_at():
    values = np.zeros(12_000)
    values[6001:] = hum(50.0, 1.0, 5999)
    assert hum_of(values) is None
    values[5000:] = hum(50.0, 1.0, 7000)
    values[:6000] = hum(50.0, 1.0, 6000)
    values[6000:] = 9.0
    assert hum_of(values) == (50.0, pytest.approx(np.max(hum(50.0, 1.0, 6000)), rel=1e-9))


@pytest.mark.parametrize(("size", "seen"), [(36, True), (35, False), (74, True), (75, True)])
def test_hum_of_a_few_periods_is_seen_from_1_2_on(size, seen):
    found = hum_of(hum(60.0, 1.0, size))
    assert (found is not None) is seen
    assert not seen or found == (60.0, pytest.approx(1.0, rel=5e-3))


@pytest.mark.parametrize(("share", "seen"), [(0.095, True), (0.105, False)])
def test_hum_of_a_few_periods_leaves_a_tenth_of_what_a_cubic_does(share, seen):
    """With what neither a cubic nor a swing of 50 or 60 Hz takes of the record."""
    size = 60
    k = np.arange(size)
    angles = [2.0 * np.pi * f / RATE * k for f in (50.0, 60.0)]
    columns = np.array([*(k.astype(float) ** n for n in range(4)), *map(np.cos, angles), *map(np.sin, angles)]).T
    base, _ = np.linalg.qr(columns)
    other = np.sin(2.0 * np.pi * 333.0 / RATE * k)
    other -= base @ (base.T @ other)
    values = hum(50.0, 1.0, size)
    bent = values - np.polynomial.polynomial.polyval(k / 59.0, np.polynomial.polynomial.polyfit(k / 59.0, values, 3))
    squares = np.sum(bent**2)
    values += math.sqrt(share / (1.0 - share) * squares / np.sum(other**2)) * other
    assert (hum_of(values) is not None) is seen


def test_noise_is_told_by_the_largest_wander_or_by_that_of_a_sample():
    """From 2 % of a figure on, twice a standard uncertainty of a hundredth."""
    doubts = PulseUncertainty(0.0404, 0.0, 0.0), PulseUncertainty(0.0396, 0.0, 0.0)
    for doubt, told in zip(doubts, (True, False), strict=True):
        pulses = [
            dataclasses.replace(one, uncertainty=doubt, baseline=one.baseline._replace(wander=wander))
            for one, wander in ((blow(100, 150), 0.03), (blow(400, 450), 0.01), (blow(700, 750), math.nan))
        ]
        found = examine(record(np.zeros(900), *pulses), disturbances.hum, disturbances.noise)
        assert [(one.code, one.value) for one in found] == ([("noise", 0.03)] if told else [])
    lone = dataclasses.replace(blow(400, 450), uncertainty=doubts[0], baseline=LocalBaseline(0.0))
    seen = record(np.zeros(900), lone)
    vars(seen).update(noise=0.017)
    [found] = examine(seen, disturbances.hum, disturbances.noise)
    assert (found.value, found.effects[0]) == (0.017, ("peak", pytest.approx(0.0202)))
    assert "a sample" in found.message
    [short] = examine(
        record(np.zeros(900), dataclasses.replace(lone, baseline=LocalBaseline(0.0, widths=5))),
        disturbances.short_before,
    )
    assert (short.value, short.end, short.severity) == (5, lone.begin, "good")
    assert examine(record(np.zeros(900), blow(400, 450), lone), disturbances.short_before) == []
    assert (
        examine(record(np.zeros(900)), disturbances.short_before)
        == examine(record(np.zeros(900)), disturbances.hum, disturbances.noise)
        == []
    )


@pytest.mark.parametrize(("amplitude", "code"), [(0.041, ["hum"]), (0.039, [])])
def test_hum_is_noted_from_a_hundredth_of_the_smallest_peak_on(amplitude, code):
    values = hum(50.0, amplitude, 900, rate=1000.0)
    pulses = [
        dataclasses.replace(blow(450, 455, peak), uncertainty=PulseUncertainty(0.0, 0.0, 0.0)) for peak in (-4.0, 9.0)
    ]
    found = examine(record(values, *pulses), disturbances.hum, disturbances.noise)
    assert [one.code for one in found] == code
    assert not found or found[0].value == pytest.approx(amplitude, rel=0.02)
    assert not found or f"{percent(found[0].value / 4.0)} of the peak" in found[0].message


def test_where_no_noise_is_known_that_of_samples_does_it():
    one = blow(300, 500, -4.0, noise=0.2)
    found = disturbances._effects(record(np.zeros(900)), one)
    white = one.smooth.uncertainty(STEP, 0.2)
    for name in ("peak", "width", "velocity_change"):
        assert found[name] == pytest.approx(2.0 * getattr(white, name) / abs(getattr(one, name)))
    assert disturbances._effects(record(np.zeros(900)), dataclasses.replace(one, width=math.nan)) == {}
    known = dataclasses.replace(one, uncertainty=PulseUncertainty(0.1, math.nan, 0.002))
    assert disturbances._effects(record(np.zeros(900)), known) == {
        "peak": pytest.approx(0.05),
        "velocity_change": pytest.approx(0.004 / abs(one.velocity_change)),
    }


def test_noise_is_the_least_ratio_of_the_blows_that_are_fitted():
    pulses = [blow(100 * k, 100 * k + 50, peak, method="fit", noise=0.1) for k, peak in ((1, 3.0), (3, -2.0), (5, 4.0))]
    [found] = examine(record(np.zeros(900), *pulses, blow(700, 750, 0.5)), disturbances.noisy)
    assert found.value == pytest.approx(20.0 * math.log10(20.0))
    assert found.harms == ("rise",)


# sampling


@pytest.mark.parametrize(
    ("count", "severity", "harms"),
    [
        (20.1, None, ()),
        (19.9, "good", ()),
        (10.1, "good", ()),
        (9.9, "suspect", ("peak", "rise", "width")),
        (5.1, "suspect", ("peak", "rise", "width")),
        (4.9, "bad", ("peak", "rise", "width")),
    ],
)
def test_samples_of_the_narrowest_half_sine(count, severity, harms):
    wide = blow(300, 500)
    one = dataclasses.replace(wide, width=count * STEP * (1.0 - 2.0 * math.asin(0.1) / math.pi))
    found = examine(record(np.zeros(900), wide, one, dataclasses.replace(wide, width=math.nan)), limits.few_samples)
    assert [(each.severity, each.harms) for each in found] == ([(severity, harms)] if severity else [])
    assert not found or found[0].value == pytest.approx(count, rel=1e-6)
    assert examine(record(np.zeros(900)), limits.few_samples) == []


@pytest.mark.parametrize(("length", "reach"), [(40, 150), (10, 64)])
def test_a_spectrum_is_that_of_four_widths_around_the_largest_blow(length, reach):
    """Or 64 samples if more; a spike within them is seen, beyond them not, and the zero of the blow is taken off."""
    one = blow(1000, 1000 + length, offset=7.0)
    assert reach == max(round(4.0 * one.width / STEP), 64)
    middle = 1000 + length // 2
    for place, seen in ((-reach + 8, True), (-reach - 1, False), (reach - 9, True), (reach, False)):
        values = 7.0 + one.smooth.at(START + STEP * np.arange(3000))
        values[middle + place] += 4e3
        assert bool(examine(record(values, blow(200, 240, 1.0), one), limits.aliased)) is seen
    found = examine(record(values, dataclasses.replace(one, width=math.nan)), limits.aliased)
    assert found == examine(record(values), limits.aliased) == []


@pytest.mark.parametrize(("level", "area"), [(0.0245, False), (0.0255, True)])
def test_what_is_folded_harms_areas_twice_as_much(level, area, monkeypatch):
    monkeypatch.setattr(limits, "folded_level", lambda part, noise: level)
    [found] = examine(record(np.zeros(3000), blow(1000, 1040)), limits.aliased)
    assert found.value == level
    assert found.harms == ("peak", "rise", *(("width", "velocity_change") if area else ()), "spectrum")


# blows


def parts(seen, at_end):
    """Return what is found of another blow at the end of a record, or at its begin."""
    found = examine(seen, blow_checks.part_of_blow)
    return [one for one in found if ("record ends" in one.message) is at_end]


@pytest.mark.parametrize(
    ("place", "value", "part"),
    [
        (11, 0.0, True),
        (374, 0.199, True),
        (374, 0.201, False),
        (747, 0.21, False),
        (748, 0.21, True),
        (748, 9.0, True),
        (374, -0.21, False),
        (187, 0.201, False),
        (187, 0.199, True),
        (186, 0.9, True),
        (373, -0.21, False),
    ],
)
@pytest.mark.parametrize("at_end", [False, True])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_part_of_a_blow_is_over_within_a_width_and_quiet_after_it(place, value, part, at_end, sign):
    """Of a width of 187 samples the first eighth stands at a tenth of the peak; half a tenth is no quiet, from the end of
    one width to four."""
    values = np.zeros(3000)
    values[:12] = 0.41  # the median of 23
    values[place] = value
    values += 3.0
    one = blow(1400, 1600, 4.0 * sign, offset=2.65 * sign)  # the quiet stands off the zero of the blow
    own = parts(record(sign * (values[::-1] if at_end else values), one), at_end)
    if place == 11:  # half of the eighth does not stand there
        assert own == []
        return
    assert bool(own) is part
    assert not own or own[0].value == (START + 2999 * STEP if at_end else START)


def test_a_part_of_a_blow_needs_four_widths_beside_one():
    for before, seen in ((748, True), (747, False)):
        values = np.zeros(3000)
        values[:100] = 1.0
        assert bool(parts(record(values, blow(before, before + 200)), False)) is seen
        ends = record(values[::-1], blow(3000 - before - 187 - 200, 3000 - before - 187, 4.0))
        assert bool(parts(ends, True)) is seen
    assert parts(record(values), True) == []


def test_a_blow_that_reaches_the_last_sample_but_one_is_cut():
    values = np.zeros(900)
    for end, cut in ((897, False), (898, True)):
        [*found] = examine(record(values, blow(end - 100, end)), blow_checks.cut, blow_checks.part_of_blow)
        assert [("end of the record" in one.message, one.severity, one.harms) for one in found] == (
            [(True, "suspect", BLOW)] if cut else []
        )
    [found] = examine(record(values, blow(300, 400, width=math.nan)), blow_checks.cut, blow_checks.part_of_blow)
    assert "by the begin" in found.message
    assert (found.value, found.start, found.end) == pytest.approx((2.35, 2.3, 2.4))


@pytest.mark.parametrize(
    ("change", "severity"),
    [(2.01, "bad"), (1.99, None), (0.91, None), (0.89, "suspect"), (-2.01, "bad"), (-0.91, None)],
)
def test_a_fall_gives_its_speed_to_twice_that(change, severity):
    """sqrt(2 g h) of 0.5 m is 3.1316 m/s; the largest change counts."""
    speed = math.sqrt(9.80665)
    pulses = [blow(300, 400, velocity_change=change * speed), blow(600, 700, velocity_change=0.1)]
    seen = BlowRecord(np.zeros(900), STEP, START, "m/s^2", tuple(pulses), drop_height=0.5)
    found = examine(seen, blow_checks.above_fall, blow_checks.below_fall)
    assert [(one.severity, one.value) for one in found] == (
        [(severity, pytest.approx(abs(change) * speed))] if severity else []
    )
    for other in (
        dataclasses.replace(seen, drop_height=0.0),
        dataclasses.replace(seen, unit="g"),
        dataclasses.replace(seen, pulses=()),
    ):
        assert examine(other, blow_checks.above_fall, blow_checks.below_fall) == []


@pytest.mark.parametrize(("span", "swings"), [(2.9, False), (3.1, True)])
def test_a_record_without_a_blow_holds_something_beyond_thirty_noises(span, swings):
    values = np.zeros(900)
    values[[300, 301]] = 0.5 * span, -0.5 * span
    seen = record(values)
    vars(seen).update(noise=0.1)
    [found] = examine(seen, blow_checks.only_swings, blow_checks.only_noise)
    assert ("spectrum" in found.harms) is not swings


# the train


def locked(moved=0.0, scale=0.0, before=0.6, after=0.6, doubt=0.0, scatter=0.0, period=20e-3):
    """Return a record of six blows each 20 ms, its first and last so many periods from its ends."""
    step = 1e-5
    times = START + before * period + period * np.arange(6) + moved * period * np.array([0, -1, 0, 0, 2, 0])
    peaks = 4.0 * (1.0 + scale * (-1.0) ** np.arange(6))
    pulses = [
        dataclasses.replace(blow(0, 4, peak), time=time, uncertainty=PulseUncertainty(doubt * peak, 0.0, 0.0))
        for time, peak in zip(times, peaks, strict=True)
    ]
    seen = BlowRecord(np.zeros(round((before + 5.0 + after) * period / step) + 1), step, START, "m", tuple(pulses))
    vars(seen).update(scatter=scatter)
    return seen


@pytest.mark.parametrize(
    ("how", "blips"),
    [
        ({}, True),
        ({"before": 1.24}, True),
        ({"before": 1.26}, False),
        ({"after": 1.24}, True),
        ({"after": 1.26}, False),
        ({"scale": 0.0110}, True),
        ({"scale": 0.0114}, False),
        ({"scale": 0.02, "doubt": 0.0122}, True),
        ({"scale": 0.02, "doubt": 0.0115}, False),
        ({"scale": 0.02, "doubt": math.nan, "scatter": 4.0 * 0.0122}, True),
        ({"scale": 0.02, "doubt": math.nan, "scatter": 4.0 * 0.0115}, False),
        ({"moved": 0.00054}, True),
        ({"moved": 0.00058}, False),
        ({"moved": 0.0021, "doubt": 0.005}, True),
        ({"moved": 0.0023, "doubt": 0.005}, False),
    ],
)
def test_blips_of_the_mains_are_as_even_and_as_many_as_they_must_be(how, blips):
    """No place is left where one is due within 1.25 periods. Half of six peaks are higher and half lower: 1.2 x 1.4826 of
    that is their spread, 2 % or three uncertainties. Gaps of a period +- m or 2 m spread by 1.206 x 1.4826 m: a thousandth,
    or 3 sqrt 2 times what noise moves a peak by, its share of a width of 3.74 ms."""
    found = examine(locked(**how), blow_checks.mains_blips)
    assert bool(found) is blips
    if blips:
        [first, *_, last] = locked(**how).pulses
        assert (found[0].value, found[0].start, found[0].end) == (20e-3, first.begin, last.end)


@pytest.mark.parametrize("period", [10e-3, 1.0 / 60.0, 1.0 / 120.0])
def test_blips_of_all_mains_are_told(period):
    assert [one.value for one in examine(locked(period=period), blow_checks.mains_blips)] == [period]


def test_a_place_for_a_blip_is_counted_to_the_last_sample():
    """1.25 periods are 2500 samples; the last blip lies a fifth of a sample behind one."""
    for samples, blips in ((2499.8, True), (2500.8, False)):
        assert bool(examine(locked(before=0.6001, after=samples / 2000.0), blow_checks.mains_blips)) is blips


# ringing beside its model


def rigid_of(one, peak=0.0, width=0.0, area=0.0, doubts=(0.0, 0.0, 0.0)):
    """Return the pulse without ringing of which a blow is off by these shares, and as uncertain as these."""
    figures = one.peak / (1.0 + peak), one.width / (1.0 + width), one.velocity_change / (1.0 + area)
    stated = [doubt * abs(figure) for doubt, figure in zip(doubts, figures, strict=True)]
    return RigidPulse(figures[0], math.nan, *figures[1:], *stated, 4e3, 0.01, 0.01, "mode", one.smooth)


@pytest.fixture
def rings(monkeypatch):
    """Return what is told of a blow after which a record swings by a share, and that goes back by another."""

    def told(one, swing=0.0, frequency=math.nan, back=(0.0, 0.0)):
        monkeypatch.setattr(ringing_checks, "_swing_after", lambda record, pulse: swing * abs(pulse.peak))
        monkeypatch.setattr(ringing_checks, "ringing_of", lambda stretch: frequency)
        monkeypatch.setattr(ringing_checks, "goes_back", lambda record, pulse: back)
        found = examine(record(np.zeros(900), one), ringing_checks.ringing)
        return found[0] if found else None

    return told


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_ringing_is_noted_by_a_fiftieth_of_a_figure_or_15_percent_of_the_peak(rings, sign):
    one = blow(300, 500, 4.0 * sign)
    for effect, swing, noted in ((0.0199, 0.149, False), (0.0201, 0.0, True), (-0.0201, 0.0, True), (0.0, 0.151, True)):
        for name in ("peak", "width", "area"):
            found = rings(dataclasses.replace(one, rigid=rigid_of(one, **{name: effect})), swing)
            assert (found is not None) is noted
            if found is not None:
                field = "velocity_change" if name == "area" else name
                assert dict(found.effects)[field] == pytest.approx(effect)
                assert (found.value, found.start) == (pytest.approx(swing), one.begin)
    for doubt, harms in ((0.0199, ()), (0.0201, ("width", "rise"))):
        found = rings(dataclasses.replace(one, rigid=rigid_of(one, width=0.03, doubts=(0.01, doubt, 0.01))))
        assert set(found.harms) == set(harms)
    cut = dataclasses.replace(one, width=math.nan)
    assert dict(rings(dataclasses.replace(cut, rigid=rigid_of(one, peak=0.1)), 0.2).effects).keys() == {
        "peak",
        "velocity_change",
    }
    own = dataclasses.replace(one, rigid=rigid_of(one, peak=0.1), ringing_frequency=7.1e3)
    assert "rings at 7100\xa0Hz" in rings(own).message
    assert "rings at 4000\xa0Hz" in rings(dataclasses.replace(own, ringing_frequency=math.nan)).message


@pytest.mark.parametrize(
    ("swing", "misfit", "frequency", "harms"),
    [
        (0.149, 0.059, 1e3, None),
        (0.149, 0.061, math.nan, None),
        (0.61, 0.0, math.nan, ("peak", "rise", "width")),
        (0.59, 0.0, math.nan, ()),
        (0.59, 0.119, math.nan, ()),
        (0.59, 0.121, math.nan, ("peak", "rise", "width")),
        (0.151, 0.0, 1.49, ()),
        (0.0, 0.061, 1.49, ()),
    ],
)
def test_ringing_that_no_mode_explains_harms_where_it_is_strong(rings, swing, misfit, frequency, harms):
    """Swings in a width below 1.5 are those of the blow; a swing of 60 % of the peak, or a misfit of 12 %, are strong."""
    one = blow(300, 500)
    one = dataclasses.replace(one, smooth=one.smooth._replace(misfit=misfit))
    slow = frequency / one.smooth.width() if frequency < 10.0 else frequency
    found = rings(one, swing, slow)
    assert (found and found.harms) == harms
    if found:
        assert (found.value, found.start) == (pytest.approx(swing), one.end)
        assert "as slowly as the blow itself" in found.message
    if misfit > 0.06 and harms == ("peak", "rise", "width") and swing < 0.6:  # of a fit it is what noise does
        assert rings(dataclasses.replace(one, method="fit"), swing, slow).harms == ()


def test_ringing_that_no_mode_explains_is_held_against_the_smooth_pulse(rings):
    one = blow(300, 500)
    one = dataclasses.replace(one, smooth=one.smooth._replace(misfit=0.03, peak=4.2), peak=4.4)
    found = rings(one, 0.2, 1.51 / one.smooth.width())
    effects = {"peak": 4.4 / 4.2, "width": 1.0, "velocity_change": one.velocity_change / one.smooth.area()}
    assert dict(found.effects) == pytest.approx({name: ratio - 1.0 for name, ratio in effects.items()})
    assert "by 20 % of the peak" in found.message
    assert set(found.harms) == {"peak", "rise", "velocity_change"}  # of 4.8 % and a doubt of 4.2 and 1.7 %
    wide = rings(dataclasses.replace(one, smooth=one.smooth._replace(misfit=0.3)), 0.2, 1.51 / one.smooth.width())
    assert "by 30 % of the peak" in wide.message


@pytest.mark.parametrize(("share", "told"), [(0.049, False), (0.051, True)])
def test_a_blow_that_goes_back_rings_within(rings, share, told):
    """Peak and width as much as it goes back, the velocity change twice what lies between, without signs."""
    one = blow(300, 500, -4.0)
    found = rings(one, back=(share, 0.01))
    assert (found is not None) is told
    if found is not None:
        expected = {"peak": share, "width": share, "velocity_change": 0.02 / abs(one.velocity_change)}
        assert dict(found.effects) == pytest.approx(expected)
        assert "+-5.1 %" in found.message
        assert (found.value, found.start, found.end) == (share, one.begin, one.end)
    assert rings(dataclasses.replace(one, method="fit"), back=(share, 0.01)) is None


def test_of_several_blows_that_ring_the_worst_is_told(monkeypatch):
    """What harms before what does not, then the largest effect."""
    pulses = [blow(100, 150), blow(300, 350), blow(500, 550)]
    for effects, worst in (((0.03, 0.06, 0.04), 1), ((0.03, 0.04, 0.035), 1), ((-0.09, 0.06, 0.04), 0)):
        struck = [
            dataclasses.replace(one, rigid=rigid_of(one, width=effect))
            for one, effect in zip(pulses, effects, strict=True)
        ]
        monkeypatch.setattr(ringing_checks, "_swing_after", lambda record, pulse: 0.0)
        [found] = examine(record(np.zeros(900), *struck), ringing_checks.ringing)
        assert found.start == pulses[worst].begin
    assert examine(record(np.zeros(900)), ringing_checks.ringing) == []


# sides and tops


def test_the_doubt_of_a_bend_is_that_of_noise_or_of_what_swings():
    """Of a cubic four coefficients, of 77 samples between 2 and 77 % of a straight side, and what ripples beside it."""
    one = blow(300, 450, 4.0, 400, noise=0.2)
    assert BlowShape(record(tent(100, 50)), one).flanks[0].bend == pytest.approx(0.2 * math.sqrt(7.0 / 77.0) / 4.0)
    rippled = dataclasses.replace(one, baseline=one.baseline._replace(ripple=0.1))
    assert BlowShape(record(tent(100, 50)), rippled).flanks[0].bend == pytest.approx(0.1 / 4.0)
    unknown = dataclasses.replace(one, noise=0.0, baseline=one.baseline._replace(ripple=math.nan))
    values = tent(100, 50)
    size = round(2.0 * one.width / STEP) + 1
    swing = 0.3 * np.sin(2.0 * np.pi * np.arange(size) / 30.0)
    values[450 : 450 + size] += swing
    expected = min(-np.min(swing), math.sqrt(2.0 * np.var(swing)))
    seen = record(values)
    vars(seen).update(scatter=0.0)
    assert BlowShape(seen, unknown).flanks[0].bend == pytest.approx(expected / 4.0, rel=1e-6)
    vars(seen).update(scatter=0.1)
    left = math.sqrt(2.0 * (np.var(swing) - 0.01 * (1.0 + 3.0 * math.sqrt(2.0 / size))))
    assert BlowShape(seen, unknown).flanks[0].bend == pytest.approx(left / 4.0, rel=1e-6)
    vars(seen).update(scatter=1.0)
    assert BlowShape(seen, unknown).flanks[0].bend == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("rise", "known"), [(5, True), (4, False)])
def test_six_samples_of_a_side_tell_its_bend(rise, known):
    flank = BlowShape(record(tent(rise, 50)), blow(300, 350 + rise, 4.0, 300 + rise)).flanks[0]
    assert flank.slope == pytest.approx(4.0 / (rise * STEP))
    assert flank.bend == (pytest.approx(0.0, abs=1e-12) if known else math.inf)
    assert math.isnan(flank.goes_on) is not known


def test_the_straightest_three_quarters_of_a_side_count():
    """A side with a foot of 18 % that bends: from 22 % on it is a line, which goes on to what it is at the peak."""
    k = np.arange(101.0)
    line = 4.0 * (k / 100.0)
    side = np.where(k < 18, 4.0 * 0.18 * (k / 18.0) ** 3, line)
    values = np.zeros(900)
    values[300:401] = side
    values[401:451] = np.linspace(4.0, 0.0, 51)[1:]
    flank = BlowShape(record(values), blow(300, 450, 4.0, 400)).flanks[0]
    assert flank.bend == pytest.approx(0.0, abs=1e-12)
    assert (flank.slope, flank.goes_on) == (pytest.approx(4.0 / (100 * STEP)), pytest.approx(1.0))


@pytest.mark.parametrize(("samples", "known"), [(5, True), (4, False)])
def test_a_top_of_six_steps_has_a_shape(samples, known):
    """Samples above 40 % of the peak, between the first ones below it."""
    values = np.zeros(900)
    values[400 : 400 + samples] = 4.0 * np.array([0.41, 0.8, 1.0, 0.9, 0.41][:samples])
    seen = BlowShape(record(values), blow(395, 410, 4.0, 402))
    assert math.isnan(seen.tip) is not known
    if known:  # what lies beyond the feet is none of it
        values[[398, 406]] = -3.0
        assert BlowShape(record(values), blow(395, 410, 4.0, 402)).tip == seen.tip


@pytest.mark.parametrize("side", [1, -1])
def test_the_usual_tip_is_that_of_a_power_with_the_same_widths_of_both_sides_together(side):
    """A rise of a half-sine and a fall of its cube: widths at 20 and 50 % of the peak of each, by their arc cosines."""
    u = np.clip((np.arange(900) - 300.0) / 200.0, 0.0, 1.0)
    values = 4.0 * np.where(u < 0.5, np.sin(np.pi * u), np.sin(np.pi * u) ** 3)
    seen = BlowShape(record(values[::side]), blow(300, 500) if side > 0 else blow(399, 599))
    low, upper = (math.acos(share) + math.acos(share ** (1.0 / 3.0)) for share in (0.2, 0.5))
    power = brentq(lambda p: math.acos(0.5 ** (1.0 / p)) / math.acos(0.2 ** (1.0 / p)) - upper / low, 1.0, 3.0)
    assert seen.usual_tip == pytest.approx(math.acos(0.9 ** (1.0 / power)) / math.acos(0.5 ** (1.0 / power)), rel=1e-3)


def looks(tip=0.43, usual=0.43, noise_of_top=0.0, swing=0.0, higher=1.0, flanks=None, halfway=(4.0, 4.0), rigid=None):
    """Return a blow with a shape that is put in; flanks are slope, bend and how far each goes on."""
    one = blow(300, 500, rigid=rigid)
    sides = tuple(limits.Flank(*each) for each in (flanks or ((40.0, 0.05, 1.0), (40.0, 0.05, 1.0))))
    seen = record(np.zeros(900), one)
    return SimpleNamespace(
        **{"tip": tip, "usual_tip": usual, "noise_of_top": noise_of_top, "swing_to_both_sides": swing},
        **{"half_sine_of_flanks": higher, "flanks": sides, "pulse": one, "record": seen},
        slope_halfway=lambda side: halfway[(side + 1) // 2],
    )


def shaped(*shapes):
    """Return a record whose blows have such shapes."""
    seen = record(np.zeros(900), *(one.pulse for one in shapes))
    seen._made[limits._shapes] = list(shapes)
    return seen


TOPS = (limits.flat_top, limits.bent_tip)
SLOPES = (limits.straight_side, limits.corner)


@pytest.mark.parametrize(
    ("how", "flat"),
    [
        ({"tip": 0.4501}, True),
        ({"tip": 0.4499}, False),
        ({"tip": 0.4501 + 1.8 * 3.0 * 0.01, "noise_of_top": 0.01}, True),
        ({"tip": 0.4499 + 1.8 * 3.0 * 0.01, "noise_of_top": 0.01}, False),
        ({"tip": 0.4501 + 1.8 * 0.02, "swing": 0.02}, True),
        ({"tip": 0.4499 + 1.8 * 0.02, "swing": 0.02}, False),
        ({"tip": math.nan}, False),
    ],
)
def test_a_top_is_flat_by_two_hundredths_and_its_doubt(how, flat):
    found = examine(shaped(looks(**how)), *TOPS)
    assert [(one.code, one.value, one.harms) for one in found] == ([("flat-top", how["tip"], BLOW)] if flat else [])
    for higher, told in ((1.049, False), (1.051, True)):
        [one] = examine(shaped(looks(tip=0.5, higher=higher), looks(tip=0.5, higher=higher)), *TOPS)
        assert ("half-sine of its flanks would be 5 % higher" in one.message) is told


@pytest.mark.parametrize(
    ("goes_on", "bend", "noise_of_top", "bent"),
    [
        (1.0201 + 0.02, 0.0099, 0.0, True),
        (1.0199 + 0.02, 0.0099, 0.0, False),
        (1.5, 0.0101, 0.0, False),
        (1.0801 + 0.02, 0.0, 0.02, True),
        (1.0799 + 0.02, 0.0, 0.02, False),
    ],
)
def test_a_straight_side_goes_on_above_the_peak_by_more_than_its_tip_is_rounded(goes_on, bend, noise_of_top, bent):
    """Two hundredths, three of what noise does, and two samples of its slope: of 40 a second over 4, 0.02. Of two straight
    sides the less steep one counts."""
    for flanks in (
        ((40.0, bend, goes_on), (90.0, 0.05, 2.0)),
        ((40.0, bend, goes_on), (90.0, 0.0, 2.0)),
        ((90.0, 0.05, 2.0), (40.0, bend, goes_on)),
    ):
        higher = limits._bent_off(looks(flanks=flanks, noise_of_top=noise_of_top))
        steep = flanks[1][1] == 0.0 and bend > 0.01
        assert higher == pytest.approx(goes_on - 1.0 if bent else 1.0 if steep else 0.0)
    both = [looks(flanks=((40.0, 0.0, goes_on), (90.0, 0.05, 1.0))) for goes_on in (1.2, 1.3)]
    [found] = examine(shaped(*both), *TOPS)
    assert (found.code, found.value) == ("flat-top", pytest.approx(0.2))
    assert examine(shaped(*both, looks()), *TOPS) == examine(shaped(), *TOPS) == []


@pytest.mark.parametrize(
    ("flanks", "told"),
    [
        (((40.0, 0.0099), (30.0, 0.05)), "one side is"),
        (((40.0, 0.0101), (30.0, 0.05)), None),
        (((40.0, 0.0), (37.0, 0.0)), "its sides are"),
        (((40.0, 0.0), (35.0, 0.0)), "one side is"),
        (((40.0, 0.05), (30.0, 0.0)), None),
        (((40.0, 0.0), (7.9, 0.0099)), None),
        (((40.0, 0.0), (8.1, 0.0099)), "one side is"),
        (((40.0, 0.0), (7.9, 0.0101)), "one side is"),
    ],
)
def test_the_steeper_side_is_straight_where_an_amplifier_is_too_slow(flanks, told):
    """Unless both are, and one is a fifth as steep or less, as those of a saw-tooth."""
    for order in (flanks, flanks[::-1]):
        one = looks(flanks=order)
        found = examine(shaped(looks(), one), *SLOPES)
        assert [(each.code, each.value) for each in found] == ([("slew-rate", 40.0)] if told else [])
        assert not told or told in found[0].message


@pytest.mark.parametrize(
    ("how", "corner"),
    [
        ({"tip": 0.4099}, True),
        ({"tip": 0.4101}, False),
        ({"tip": 0.4099 - 1.8 * 3.0 * 0.01, "noise_of_top": 0.01}, True),
        ({"tip": 0.4101 - 1.8 * 3.0 * 0.01, "noise_of_top": 0.01}, False),
        ({"tip": 0.3, "halfway": (1.41, 4.0)}, True),
        ({"tip": 0.3, "halfway": (1.39, 4.0)}, False),
        ({"tip": 0.3, "halfway": (4.0, 1.39)}, False),
        ({"tip": 0.3, "rigid": "one"}, False),
    ],
)
def test_a_top_is_a_corner_between_sides_that_are_about_as_steep(how, corner):
    one = looks(**how)
    found = examine(shaped(one), *SLOPES)
    assert [(each.code, each.value) for each in found] == ([("slew-rate", 4.0)] if corner else [])


# rails


def test_a_rail_is_off_the_zero_by_a_hundredth_of_the_span():
    """Where the steps of the converter are a tenth of it: 1 of 100."""
    values = np.r_[0.0, 50.0, 99.0, 99.3, 99.4, [100.0] * 9]
    for zero_at, found in ((98.9, 9), (99.1, 0)):
        for level in (0.0, 50.0, -70.0):
            assert limits.rail(values + level, zero_at + level).size == found


def test_the_step_of_a_converter_is_the_least_near_the_top():
    """A step of 0.9 within a twentieth of the span, beside which the next two of 100 count: up to 2.25 below it."""
    few = np.r_[0.0, 10.0, 10.1, 94.9, [97.8] * 4, [100.0] * 9, 98.7]  # those at 97.8 and 98.7 lie within
    assert limits.rail(few, 0.0).size == limits.rail(few - 70.0, -70.0).size == limits.rail(few + 90.0, 90.0).size == 0
    far = np.r_[0.0, 10.0, 10.1, 94.9, [97.7] * 4, [100.0] * 9, 98.6]
    assert limits.rail(far, 0.0).size == limits.rail(far - 70.0, -70.0).size == limits.rail(far + 90.0, 90.0).size == 9


def test_a_switch_has_no_rail():
    values = np.r_[np.zeros(20), np.full(20, 5.0)]
    assert limits.rail(values, 0.0).size == 0
    values[3] = 2.0
    assert limits.rail(values, 0.0).size == 20


def clips(values, *pulses):
    return [
        (one.value, one.severity, one.start, one.end, one.harms)
        for one in examine(record(values, *pulses), limits.clipped)
    ]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_rail_in_a_blow_is_bad_and_one_outside_suspect(sign):
    values = np.r_[np.linspace(0.0, 0.3, 300), np.linspace(0.0, 3.9, 40), np.full(20, 4.0), np.linspace(3.9, 0.3, 540)]
    place = (pytest.approx(START + STEP * 340), pytest.approx(START + STEP * 359))
    one = blow(300, 360, 4.0 * sign)
    assert clips(sign * values, one) == [(4.0 * sign, "bad", *place, BLOW)]
    elsewhere = [blow(360, 400, 4.0 * sign), blow(200, 339, 4.0 * sign)]
    assert clips(sign * values, *elsewhere) == [(4.0 * sign, "suspect", *place, ("ringing_frequency", "spectrum"))]
    for edge in (blow(359, 400, 4.0 * sign), blow(200, 340, 4.0 * sign)):
        assert clips(sign * values, edge)[0][1] == "bad"
    [found] = examine(record(sign * values, one, blow(800, 850, sign)), limits.clipped)
    assert "for 2e+04\xa0us in 1 of 2 blows" in found.message


def test_zeros_before_or_after_a_blow_are_no_rail():
    values = np.r_[np.zeros(20), 5.0 + np.arange(50.0), np.zeros(20)]
    assert clips(values) == []
    assert clips(values + 1.0)[0][:2] == (1.0, "suspect")
    inside = np.r_[3.0, np.zeros(20), 5.0 + np.arange(50.0), 7.0]
    assert clips(inside)[0][:2] == (0.0, "suspect")


# what a record is examined by


def test_noise_before_the_first_blow_is_that_of_two_widths_of_it():
    """From three widths to one before its begin, sixteen samples at least; or of all samples, if that is more."""
    one = blow(600, 700)
    width = one.width / STEP
    last = round(600 - width)
    first = last - round(2.0 * width)
    for place, seen in ((first, True), (first - 1, False), (last - 1, True), (last, False)):
        values = np.zeros(900)
        values[place] = 10.0
        examined_ = record(values, blow(750, 800), one)
        vars(examined_).update(noise=0.1)
        size = last - first
        expected = 10.0 * math.sqrt((1.0 - 1.0 / size) / size) if seen else 0.1
        assert examined_.scatter == pytest.approx(expected)
    narrow = dataclasses.replace(blow(100, 103), width=3 * STEP)
    for before, seen in ((19, True), (18, False)):
        values = np.zeros(900)
        values[0] = 10.0
        moved = dataclasses.replace(narrow, begin=START + STEP * before)
        examined_ = record(values, moved)
        vars(examined_).update(noise=0.1)
        assert (examined_.scatter > 0.2) is seen


def test_a_level_under_no_velocity_change_has_no_effect_on_it():
    one = blow(100, 200, velocity_change=0.0)
    assert sampled_record.effects_of_level(one, 0.4).keys() == {"peak", "width"}
    assert sampled_record.effects_of_level(blow(100, 200, -4.0), 0.4)["peak"] == pytest.approx(-0.1)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (-9806.65, "m/s^2", "-1000\xa0g"),
        (0.99e-3, "s", "990\xa0us"),
        (-0.99e-3, "s", "-990\xa0us"),
        (1.01e-3, "s", "1.01\xa0ms"),
        (9990.0, "Hz", "9990\xa0Hz"),
        (-10010.0, "Hz", "-10.01\xa0kHz"),
        (1.5e-3, "1", "1500 ustrain"),
        (12.5, "N", "12.5 N"),
        (12.5, "", "12.5"),
    ],
)
def test_values_are_written_with_units_of_a_usual_size(value, unit, text):
    assert sampled_record.with_unit(value, unit) == text


@pytest.mark.parametrize(("peak", "told"), [(0.004, False), (-0.004, True)])
def test_blows_are_negative_where_the_first_is(peak, told):
    found = examine(record(np.zeros(900), blow(100, 150, peak), blow(300, 350, -peak)), blow_checks.polarity)
    assert [(one.value, one.severity) for one in found] == ([(-1.0, "suspect")] if told else [])
    assert examine(record(np.zeros(900)), blow_checks.polarity) == []


def test_shapes_are_those_of_blows_that_are_read_off_the_record():
    pulses = blow(100, 150), blow(300, 350, method="fit"), blow(500, 550, width=math.nan), blow(700, 750, width=5e-3)
    assert [one.pulse for one in limits._shapes(record(np.zeros(900), *pulses))] == [pulses[0], pulses[3]]


def test_pulses_without_ringing_are_those_without_the_coupling():
    """An undershoot is no ringing; what is known of the tail holds on."""
    pulses = blow(100, 150), blow(300, 350)
    others = blow(100, 150, rigid=rigid_of(pulses[0])), blow(300, 350)
    seen = record(np.zeros(900), *pulses)
    model = TailModel("ac-coupling", -0.1, math.nan, 0.05, 1e-3)
    vars(seen).update(tail=model, uncoupled_pulses=others)
    found = seen.ringing_as_uncoupled()
    assert [one.rigid for one in found.pulses] == [others[0].rigid, None]
    assert (found.tail, found.uncoupled_pulses) == (model, others)
    vars(seen).update(uncoupled_pulses=())
    assert seen.ringing_as_uncoupled() is seen


# responses


def test_a_fit_explains_what_is_no_chance():
    """Five standard errors, of as many values as count: rest^2 / n."""
    rest = 0.1 * (-1.0) ** np.arange(100)
    squares = float(rest @ rest)
    assert alike_as_one(rest, 0.99) == 1.0
    for share, explained in ((1.01, True), (0.99, False)):
        before = squares + share * 25.0 * squares / 100
        assert zero._explains((before, rest, rest), (squares, rest, rest)) is explained


@pytest.mark.parametrize(("share", "flat"), [(0.55, True), (0.98, False)])
def test_flat_tops_of_a_swing(share, flat):
    """A sine cut at a share of its height is flat for 1 - 2 asin(share) / pi of its half swings."""
    t = np.arange(1000) + 0.5
    values = np.clip(np.sin(2.0 * np.pi * t / 100), -share, share)
    found = limits._flat(values, 0.0)
    assert (found is not None) is flat
    if flat:
        assert found[0] == pytest.approx(1.0 - 2.0 / math.pi * math.asin(0.98 * share), abs=0.03)  # two samples of 50
        assert found[1] == pytest.approx(1.0 - 2.0 / math.pi * math.asin(0.98), rel=1e-9)
    noisy = limits._flat(values, 0.05 * share)
    if flat:
        assert noisy[1] == pytest.approx(1.0 - 2.0 / math.pi * math.asin(1.0 - 0.22), rel=1e-9)
    assert limits._flat(np.zeros(9), 0.0) is None
