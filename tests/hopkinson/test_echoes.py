"""A bar calibrated by its echoes: delay lines, a dispersive and lossy bar made in frequency, records that cannot do."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import curve_fit

from strikewave.base.errors import InputError
from strikewave.hopkinson import Bar, GaugeTrace
from strikewave.hopkinson.echoes import (
    FittedValue,
    _band,
    _delay,
    _first_large,
    _foretold,
    _known_length,
    _losses,
    _near_peak,
    _odd,
    _PassData,
    _Passes,
    _passes,
    _phase_speed,
    _Places,
    _places,
    _plain_times,
    _plane,
    _speed_and_length,
    _taper,
    _trips,
    _turns,
    calibrate_bar,
)
from strikewave.waves import End, Layer, LoadPulse, Stack, Tap, WantedError, run_bar
from strikewave.waves.dispersion import wave_number

STEP = 1e-7


def echoes_of(bar, trips=6, loss=0.0, dispersive=True, way="towards", width=8e-6):
    """Return the strain at the gauge of a free bar: each pass a Gaussian carried its way by the transform."""
    near, far = 2.0 * bar.gauge_distance, 2.0 * (bar.length - bar.gauge_distance)
    first, second = (near, far) if way == "towards" else (far, near)
    size = int(2 * trips * (near + far) / bar.speed / STEP)
    time = STEP * np.arange(size)
    pulse = np.exp(-(((time - 100e-6) / width) ** 2))
    w = 2.0 * np.pi * np.fft.rfftfreq(size, STEP)
    k = np.asarray(wave_number(w, bar.rod, "pochhammer-chree" if dispersive else "none"))
    lost = loss(w) if callable(loss) else loss
    total, way_gone, spectrum = np.zeros(w.size, complex), 0.0, np.fft.rfft(pulse)
    for n in range(2 * trips):
        total += (-1.0) ** n * spectrum * np.exp(-(1j * k + lost) * way_gone)
        way_gone += first if n % 2 == 0 else second
    kept = int(trips * (near + far) / bar.speed / STEP)  # the rest holds what wraps around
    return GaugeTrace(1e-3 * np.fft.irfft(total, size)[:kept], STEP)


@pytest.mark.parametrize("way", ["towards", "away"])
@pytest.mark.parametrize("skip", [0, 1, 2])
def test_speed_length_and_loss_of_a_dispersive_bar(rng, way, skip):
    """Made with 5000 m/s, 2.0 m, 0.05 Np/m, a gauge at 0.8 m, searched from 5100 m/s with the length unknown.

    Phase and amplitude are exact but for tails that leave their window and noise of 1e-3: 2e-4 and 2 % of the loss.
    """
    bar = Bar(8000.0, 2e11, 0.02, 0.8, 0.29, 2.0)
    trace = echoes_of(bar, loss=0.05, way=way)
    trace = GaugeTrace(trace.strain + 1e-6 * rng.standard_normal(trace.strain.size), STEP)
    found = calibrate_bar(trace, Bar(8000.0, 8000.0 * 5100.0**2, 0.02, 0.8), way, skip)
    assert found.speed.value == pytest.approx(5000.0, rel=2e-4)
    assert found.length.value == pytest.approx(2.0, rel=2e-4)
    assert found.attenuation.value == pytest.approx(0.05, rel=0.02)
    strong = found.frequency < 40e3
    assert found.phase_speed[strong] == pytest.approx(found.theory_speed[strong], rel=1e-3)


def test_dispersion_is_taken_off_the_speed():
    """Taken as plain, the same bar seems slower: the pulse's own frequencies run below c0."""
    bar = Bar(8000.0, 2e11, 0.04, 0.8, 0.29, 2.0)
    trace = echoes_of(bar, width=12e-6)
    plain = calibrate_bar(trace, bar, theory="none").speed.value
    proper = calibrate_bar(trace, bar).speed.value
    assert proper == pytest.approx(5000.0, rel=2e-4)
    assert plain < proper - 2.0


def test_echoes_of_delay_lines():
    """A free bar in delay lines: whole transits, no loss, no dispersion: speed to 1e-6, loss below 1e-6 Np/m.

    The bar is loaded at its end, 8000 steps long with the gauge 3000 steps before the far end.
    """
    speed = 5000.0
    layer = Layer("bar", 8000.0, 8000.0 * speed**2, 1e-4, 8000 * STEP * speed)
    load = LoadPulse("sine-squared", 1000.0, 60e-6)
    run = run_bar(Stack((layer,), (), End("free")), load, [Tap(0, 0.625)], 8e-3, WantedError(step=STEP))
    strain = run.force[:, 0] / (layer.modulus * layer.area)
    bar = Bar(8000.0, 8000.0 * (1.02 * speed) ** 2, 0.0113, 3000 * STEP * speed, 0.29)
    found = calibrate_bar(GaugeTrace(strain, STEP), bar, "towards", theory="none")
    assert found.speed.value == pytest.approx(speed, rel=1e-6)
    assert found.length.value == pytest.approx(layer.length, rel=1e-6)
    assert abs(found.attenuation.value) < 1e-6
    assert found.times[::2] - found.times[0] == pytest.approx(1.6e-3 * np.arange(found.times[::2].size), abs=1e-9)


def test_a_known_length_is_one_unknown_less():
    bar = Bar(8000.0, 2e11, 0.02, 0.8, 0.29, 2.0)
    trace = echoes_of(bar)
    known = calibrate_bar(trace, bar)
    unknown = calibrate_bar(trace, Bar(8000.0, 2e11, 0.02, 0.8))
    assert known.speed.freedom == unknown.speed.freedom + 1
    assert known.length == FittedValue(2.0, pytest.approx(math.nan, nan_ok=True), 0)
    assert dataclasses.astuple(known.round_trip) == pytest.approx(dataclasses.astuple(unknown.length), rel=1e-6)
    assert known.other_way.misfit > 100.0  # turned round, the times do not fit
    assert known.speed.value == pytest.approx(5000.0, rel=2e-4)


def test_one_pulse_alone_or_noise_is_refused(rng):
    bar = Bar(8000.0, 2e11, 0.02, 0.8)
    time = STEP * np.arange(4000)
    one = np.exp(-(((time - 300e-6) / 8e-6) ** 2)) + 1e-4 * rng.standard_normal(time.size)
    with pytest.raises(InputError):
        calibrate_bar(GaugeTrace(one, STEP), bar)
    with pytest.raises(InputError):
        calibrate_bar(GaugeTrace(rng.standard_normal(4000), STEP), bar)
    with pytest.raises(InputError, match="towards"):
        calibrate_bar(GaugeTrace(one, STEP), bar, way="sideways")
    with pytest.raises(InputError, match="passes"):
        calibrate_bar(echoes_of(Bar(8000.0, 2e11, 0.02, 0.8, 0.29, 2.0)), bar, skip=50)


BAR = Bar(8000.0, 2e11, 0.02, 0.8, 0.29, 2.0)
UNKNOWN = Bar(8000.0, 8000.0 * 5100.0**2, 0.02, 0.8)
"""5000 m/s and 2 m as the records below are made; the same without its length, searched from 5100 m/s."""


def test_least_squares_by_one_column_is_a_mean_with_its_standard_error():
    """1, 2, 3: mean 2, standard deviation 1, standard error 1/sqrt(3), two degrees of freedom."""
    found = _plane(np.ones((3, 1)), np.array([1.0, 2.0, 3.0]), np.ones(3))
    assert (found.value[0], found.errors(0), found.freedom) == pytest.approx((2.0, 1.0 / math.sqrt(3.0), 2), rel=1e-12)
    assert FittedValue(0.0, 1.0, 1).student == pytest.approx(math.tan(0.475 * math.pi), rel=1e-9)  # of Cauchy


@pytest.mark.verify
@pytest.mark.parametrize("bar", [BAR, UNKNOWN], ids=["length known", "length unknown"])
def test_standard_errors_are_the_scatter_of_records_with_noise(bar, rng):
    """120 records in noise of 1 %: what is true lies within Student's 95 % in 87 % of them at least.

    120 draws of 95 % fall below 87 % once in ten thousand times. The mean over all is off by less than four of its own
    standard errors: noise does not move speed, length or loss to one side. Root mean squares of 120 errors of 9 degrees of
    freedom are within a quarter of the scatter of the records.
    """
    clean = echoes_of(BAR, loss=0.05)
    found = [
        calibrate_bar(GaugeTrace(clean.strain + 1e-5 * rng.standard_normal(clean.strain.size), STEP), bar)
        for _ in range(120)
    ]
    for name, true in (("speed", 5000.0), ("round_trip", 2.0), ("attenuation", 0.05)):
        each = [getattr(one, name) for one in found]
        off, error = np.array([one.value - true for one in each]), np.array([one.error for one in each])
        assert np.mean(np.abs(off) < each[0].student * error) > 0.87, name
        assert abs(off.mean()) < 4.0 * off.std() / math.sqrt(120), name
        assert math.sqrt(np.mean(error**2)) == pytest.approx(off.std(), rel=0.25), name


@pytest.mark.verify
def test_the_scatter_of_the_speed_is_near_to_the_least_possible(rng):
    """A pulse s in noise of standard deviation n is timed to n/sqrt(sum s'^2) at best (Cramer and Rao).

    For a Gaussian of height A and width w: n sqrt(step w/sqrt(pi/2))/A, carried through the turns of twelve passes. The
    band leaves out a part of the steepness: 1.6 times that, where weights by energy alone give 3.
    """
    clean = echoes_of(BAR, loss=0.05)
    found = [
        calibrate_bar(GaugeTrace(clean.strain + 1e-5 * rng.standard_normal(clean.strain.size), STEP), UNKNOWN)
        for _ in range(60)
    ]
    timed = 1e-2 * math.sqrt(STEP * 8e-6 / math.sqrt(math.pi / 2.0))
    n = np.arange(found[0].times.size)
    near, far = (n + 1) // 2, n // 2
    design = np.column_stack([np.ones(n.size), near, far])
    strength = np.exp(-2.0 * 0.05 * (near * 1.6 + far * 2.4))
    least = timed * math.sqrt(np.linalg.inv((design.T * strength) @ design)[1, 1]) * 5000.0**2 / 1.6
    off = np.sqrt(np.mean([(one.speed.value - 5000.0) ** 2 for one in found]))
    assert 0.8 * least < off < 1.6 * least


def test_passes_of_a_bar_without_noise_give_its_constants():
    """The windows cut next to nothing of a pulse of 8 us: 1e-6 of speed and length, 1e-4 of the loss."""
    found = calibrate_bar(echoes_of(BAR, loss=0.05), UNKNOWN)
    assert found.speed.value == pytest.approx(5000.0, rel=1e-6)
    assert found.length.value == pytest.approx(2.0, rel=1e-6)
    assert found.attenuation.value == pytest.approx(0.05, rel=1e-4)
    # 1.6 m round the near end is the shorter way, and dispersion takes a microsecond; twelve passes in six trips
    assert found.window == pytest.approx(320e-6, abs=2e-6)
    assert (found.times.size, found.first, found.speed.freedom) == (12, 0, 9)
    assert found.times[0] == pytest.approx(100e-6 - 8e-6, abs=6e-6)
    strong = found.frequency < 40e3
    assert found.losses[strong] == pytest.approx(0.05, rel=5e-3)
    assert found.phase_speed[strong] == pytest.approx(found.theory_speed[strong], rel=3e-5)  # tails that are cut
    assert found.frequency[0] == pytest.approx(1.0 / found.window, rel=0.3)
    later = calibrate_bar(echoes_of(BAR, loss=0.05), UNKNOWN, skip=2)
    assert (later.times.size, later.first) == (10, 2)
    assert later.times == pytest.approx(found.times[2:], abs=1e-12)


def test_attenuation_is_the_mean_over_the_energy_of_the_first_pass():
    """0.02 Np/m and as much more for each 100 kHz/pi: that of each frequency, and weighted with the pass's own energy."""
    trace = echoes_of(BAR, loss=lambda w: 0.02 + 1e-7 * w)
    found = calibrate_bar(trace, BAR)
    w = 2.0 * np.pi * found.frequency
    strong = found.frequency < 40e3
    assert found.losses[strong] == pytest.approx((0.02 + 1e-7 * w)[strong], rel=2e-2)  # windows cut tails
    place, size = round(found.times[0] / STEP), round(found.window / STEP)
    one = _taper(size, int(0.2 * size)) * trace.strain[place - int(0.2 * size) :][:size]
    # the transform of that stretch at the frequencies of the band
    energy = np.abs(np.exp(-1j * np.outer(w, STEP * np.arange(size))) @ one) ** 2
    assert found.attenuation.value == pytest.approx(float(found.losses @ energy / energy.sum()), rel=1e-6)
    assert found.attenuation.freedom == found.times.size - 3
    assert found.attenuation.error < 1e-3 * found.attenuation.value


def test_the_band_of_echoes_ends_at_3_percent_of_a_gaussian():
    """exp(-(pi f w)^2) = 0.03: sqrt(ln(1/0.03))/(pi w); the windows cut nothing of 20 us; to a bin or two, 3 %."""
    found = calibrate_bar(echoes_of(BAR, width=20e-6), BAR)
    assert found.frequency[-1] == pytest.approx(math.sqrt(math.log(1.0 / 0.03)) / (math.pi * 20e-6), rel=0.03)


def test_passes_end_where_they_drown(rng):
    """0.5 Np/m over 4 m a trip: after three trips a pass is exp(-6) of the first, about the noise of 1e-3."""
    trace = echoes_of(BAR, loss=0.5)
    found = calibrate_bar(GaugeTrace(trace.strain + 1e-6 * rng.standard_normal(trace.strain.size), STEP), BAR)
    assert 3 <= found.times.size <= 7


@pytest.mark.parametrize("bar", [BAR, UNKNOWN], ids=["length known", "length unknown"])
@pytest.mark.parametrize("way", ["towards", "away"])
def test_the_wrong_way_of_the_first_pulse_shows(bar, way, rng):
    """With the length the times do not fit; without it the other way gives 5000 m/s, this one 2 x 0.8 over 2 x 1.2 of it."""
    trace = echoes_of(BAR, way=way)
    trace = GaugeTrace(trace.strain + 1e-6 * rng.standard_normal(trace.strain.size), STEP)
    found = calibrate_bar(trace, bar, "away" if way == "towards" else "towards")
    if math.isfinite(bar.length):
        assert found.other_way.misfit < 0.01
    assert found.other_way.speed == pytest.approx(5000.0, rel=1e-4)


@pytest.mark.parametrize("share", [0.8, 1.2])
def test_a_first_pass_of_another_strength_is_told(share, rng):
    """As where the pulse met something before its second pass: all but the first are weaker or stronger by a fifth."""
    trace = echoes_of(BAR, loss=0.05)
    strain = trace.strain.copy()
    strain[2500:] *= share
    noisy = GaugeTrace(strain + 1e-6 * rng.standard_normal(strain.size), STEP)
    found = calibrate_bar(noisy, UNKNOWN)
    assert found.odd is not None
    assert found.odd.number == 1
    assert found.odd.strength == pytest.approx(1.0 / share, rel=0.01)
    assert abs(found.odd.late) < STEP
    assert calibrate_bar(noisy, UNKNOWN, skip=1).odd is None
    assert calibrate_bar(GaugeTrace(trace.strain + noisy.strain - strain, STEP), UNKNOWN).odd is None


def test_a_pulse_too_near_to_the_begin_of_the_record_has_its_own_words():
    trace = echoes_of(BAR)
    with pytest.raises(InputError, match="pre-trigger"):
        calibrate_bar(GaugeTrace(trace.strain[700:], STEP), BAR)


def passes_of(near, far, first=0, bar=UNKNOWN, way="towards", noise=0.0, late=(0.0, 0.0)):
    """Return eight passes of a plain bar, and their energies: turns of these times at either end, and what is odd."""
    n = first + np.arange(8)
    ends = ((n + 1) // 2, n // 2) if way == "towards" else (n // 2, (n + 1) // 2)
    bends = noise * np.array([1.0, -2.0, 1.5, 0.5, -1.0, 2.0, -0.5, -1.5])
    times = (ends[0] - ends[0][0]) * near + (ends[1] - ends[1][0]) * far + bends
    times[:2] += late
    w = 2.0 * np.pi * np.array([1e4, 2e4, 4e4])
    logs = np.log([3.0, 2.0, 1.0]) - 0.2 * (n[:, None] // 2) - 0.03 * (n[:, None] % 2) + bends[:, None] / 1e-6
    energy = np.exp(-0.3 * np.arange(8))
    data = _PassData(
        np.repeat(times[:, None], 3, axis=1), logs, energy, np.array([9.0, 4.0, 1.0]), w, first, bar, "none"
    )
    return data, times, ends


@pytest.mark.parametrize("way", ["towards", "away"])
@pytest.mark.parametrize("first", [0, 1])
def test_errors_of_a_bar_of_seconds_are_those_of_its_begin_too(way, first):
    """3.2 and 4.8 s round the ends of 1.6 and 2.4 m: 0.5 m/s; slopes of the length of about one, as scipy carries them."""
    slow = Bar(8000.0, 8000.0 * 0.51**2, 0.02, 0.8)
    data, times, ends = passes_of(3.2, 4.8, first, noise=1e-3, way=way, bar=slow)
    turns = [end - end[0] for end in ends]
    free, _, _ = _speed_and_length(data, way)

    def model(_, begin, speed, length):
        return begin + 2.0 * (0.8 / speed * turns[0] + (length - 0.8) / speed * turns[1])

    found, spread = curve_fit(model, times, times, (0.0, 0.5, 2.0), data.energy**-0.5, xtol=1e-13, ftol=1e-13)
    error = np.sqrt(np.diag(spread))
    # slopes by differences of scipy
    assert free.speed == FittedValue(pytest.approx(found[1], rel=1e-8), pytest.approx(error[1], rel=5e-5), 5)
    assert free.length == FittedValue(pytest.approx(found[2], rel=1e-8), pytest.approx(error[2], rel=5e-5), 5)


@pytest.mark.parametrize("way", ["towards", "away"])
@pytest.mark.parametrize("first", [0, 1])
def test_speed_and_length_of_times_that_do_not_fit_with_the_errors_of_a_curve_fit(way, first):
    """0.8 m at 5000 m/s is 320 us, 1.2 m 480 us; times off by a tenth of a us: values and errors as scipy finds them."""
    data, times, ends = passes_of(320e-6, 480e-6, first, noise=1e-7, way=way)
    turns = [end - end[0] for end in ends]
    free, plain, design = _speed_and_length(data, way)
    assert plain == pytest.approx(times, rel=1e-12)
    assert np.array_equal(design, np.column_stack([np.ones(8), *turns]))
    sigma = 1.0 / np.sqrt(data.energy)

    def model(_, begin, speed, length):
        return begin + 1e6 * 2.0 * (0.8 / speed * turns[0] + (length - 0.8) / speed * turns[1])

    found, spread = curve_fit(model, times, 1e6 * times, (0.0, 5010.0, 2.01), sigma, xtol=1e-13, ftol=1e-13)
    error = np.sqrt(np.diag(spread))
    # slopes by differences of scipy
    assert free.speed == FittedValue(pytest.approx(found[1], rel=1e-8), pytest.approx(error[1], rel=1e-3), 5)
    assert free.length == FittedValue(pytest.approx(found[2], rel=1e-8), pytest.approx(error[2], rel=1e-3), 5)

    known = data._replace(bar=BAR)
    ways = 1.6 * turns[0] + 2.4 * turns[1]
    found, spread = curve_fit(lambda _, b, v: b + 1e6 * ways / v, times, 1e6 * times, (0.0, 5010.0), sigma)
    speed, left, of_ways = _known_length(known, way)
    assert speed == FittedValue(pytest.approx(found[1], rel=1e-8), pytest.approx(math.sqrt(spread[1, 1]), rel=1e-3), 6)
    miss = times - (1e-6 * found[0] + ways / found[1])
    assert left == pytest.approx(math.sqrt(np.mean(miss**2)), rel=1e-4)
    # the same at each frequency
    for phase in (_phase_speed(known, of_ways, 1.0),):
        assert phase[0] == pytest.approx([speed.value] * 3, rel=1e-12)
        assert phase[1] == pytest.approx([speed.error] * 3, rel=1e-9)


@pytest.mark.parametrize(("near", "far"), [(320e-6, -480e-6), (-320e-6, 480e-6)])
def test_passes_out_of_turn_are_refused(near, far):
    with pytest.raises(InputError, match="passes out of turn"):
        _speed_and_length(passes_of(near, far)[0], "towards")


def test_attenuation_is_what_a_round_trip_takes_over_its_way():
    """0.2 a trip of 4 m: 0.05 Np/m, at each frequency and by energy; the length's own error counts."""
    exact = _losses(passes_of(320e-6, 480e-6)[0], FittedValue(2.0, math.nan, 0))
    assert exact[0].value == pytest.approx(0.05, rel=1e-12)
    assert exact[1] == pytest.approx([0.05] * 3, rel=1e-12)
    data = passes_of(320e-6, 480e-6, noise=1e-8)[0]
    mean, each, errors = _losses(data, FittedValue(2.0, math.nan, 0))
    trips, turned = np.arange(8) // 2, np.arange(8) % 2
    found, spread = curve_fit(
        lambda _, a, b, c: a + b * turned + c * trips, trips, data.logs[:, 0], (0.0, 0.0, 0.0), data.energy**-0.5
    )
    assert each == pytest.approx([-found[2] / 4.0] * 3, rel=1e-7)
    assert errors == pytest.approx([math.sqrt(spread[2, 2]) / 4.0] * 3, rel=1e-5)
    assert (mean.value, mean.error, mean.freedom) == pytest.approx((each[0], errors[0], 5), rel=1e-9)
    unsure = _losses(data, FittedValue(2.0, 0.1, 5))[0]
    assert unsure.error == pytest.approx(math.hypot(mean.error, mean.value * 0.05), rel=1e-9)


def test_a_pass_that_those_after_it_do_not_foretell_is_odd():
    """Late by 3 us among times off by some ns: the second before the first; less than a sample never is."""
    for late, number, by in (((0.0, 3e-6), 2, 3e-6), ((-3e-6, 0.0), 1, -3e-6), ((1e-6, 2e-6), 2, 2e-6)):
        data, times, ends = passes_of(320e-6, 480e-6, noise=1e-9, late=late)
        design = np.column_stack([np.ones(8), *ends])
        found = _odd(data, times, design, 1e-7)
        assert found.number == number
        assert found.late == pytest.approx(by, abs=2e-8)
        assert found.strength == pytest.approx(1.0, abs=0.02)
        assert _odd(data, times, design, 4e-6) is None
    data, times, ends = passes_of(320e-6, 480e-6, first=3, noise=1e-9)
    louder = data.logs.copy()
    louder[0] += 0.5
    found = _odd(data._replace(logs=louder), times, np.column_stack([np.ones(8), *ends]), 1e-7)
    assert (found.number, found.strength) == (4, pytest.approx(math.exp(0.5), rel=0.02))
    # what is foretold: a straight line through six points off by one; Student at 1 in 1000 with 4 degrees is 8.6
    line = np.column_stack([np.ones(7), np.arange(7.0)])
    values = np.array([0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    fit, spread = np.polyfit(np.arange(1.0, 7.0), values[1:], 1, cov=True)
    error = math.sqrt(spread[1, 1] + np.sum((values[1:] - np.polyval(fit, np.arange(1.0, 7.0))) ** 2) / 4)
    for times_error, sure in ((8.605, False), (8.615, True), (-8.615, True)):
        values[0] = fit[1] + times_error * error
        apart, seen = _foretold(line, values, np.ones(7), 0)
        assert apart == pytest.approx(times_error * error, rel=1e-9)
        assert seen == sure


def test_weighted_least_squares_worked_by_hand():
    """Weights 1 and 3 of 0 and 4: mean 3, variance (9 + 3)/1, standard error sqrt(12/4)."""
    found = _plane(np.ones((2, 1)), np.array([0.0, 4.0]), np.array([1.0, 3.0]))
    assert (found.value[0], found.errors(0)) == pytest.approx((3.0, math.sqrt(3.0)), rel=1e-12)
    assert found.carried(np.array([-2.0])) == pytest.approx(2.0 * math.sqrt(3.0), rel=1e-12)
    assert math.isnan(_plane(np.ones((1, 1)), np.ones(1), np.ones(1)).errors(0))
    assert FittedValue(1.0, 0.1, 3).student == pytest.approx(3.182446, abs=1e-6)
    assert math.isnan(FittedValue(1.0, 0.1, 0).student)


def test_windows_and_largest_correlations_worked_by_hand():
    """Flanks of a quarter of the lead, (1 - cos(pi (k + 1/2)/2))/2; the first within nine tenths, and its top."""
    flank = [0.5 * (1 - math.sqrt(0.5)), 0.5 * (1 + math.sqrt(0.5))]
    assert _taper(9, 8) == pytest.approx([*flank, 1, 1, 1, 1, 1, *flank[::-1]], rel=1e-14)
    assert list(_taper(4, 3)) == [1.0] * 4
    same = np.array([9.0, 9.0, 0.0, 1.0, 4.6, 4.9, 3.0, 0.0, 5.0, 0.0])
    assert _first_large(same, 3) == 5
    assert _first_large(np.array([9.0, 9.0, 0.0, 4.4, 0.0, 0.0, 5.0]), 2) == 6
    ramp = np.arange(200.0)
    ramp[100] = -50.0
    # within 90 to 110 of 100, both ends taken
    assert _near_peak(ramp, 100.0, 1.0) == 110
    assert _near_peak(ramp, 100.0, -1.0) == 100
    assert _near_peak(ramp, 104.0, 1.0) == 114
    assert _near_peak(ramp, 1.2, 1.0, fallback=7) == 1
    assert _near_peak(ramp, 181.0, 1.0, fallback=7) == 199
    for out in (1.0, 182.0):
        assert _near_peak(ramp, out, 1.0, fallback=7) == 7


def trace_of(*parts, size=1200, onset=100):
    """A quiet trace of pulses at places, each so many times one that rises as a square and falls in a line."""
    one = np.concatenate([8.0 * (np.arange(21) / 20) ** 2, np.full(9, 8.0), 8.0 - 0.2 * np.arange(41)])
    x = np.zeros(size)
    for place, times in parts:
        x[place : place + one.size] += times * one[: size - place]
    return SimpleNamespace(trace=GaugeTrace(x, 0.5, 3.0), onset=onset, noise=0.0)


FOOT = 100 + 2 * 10.0 - (14 + (0.5 - 0.49) / (0.5625 - 0.49))
"""Of the line through a quarter, at sample 10 of the rise, and a half, between 14 and 15."""
EXPECTED = Bar(1.0, 4.0, 0.02, 77.5)
"""2 m/s: round its near end in 77.5 s, 155 samples of half a second."""


def test_passes_are_found_by_correlation_near_to_where_they_are_expected():
    """The second one at 150, though a deeper one lies at 280, unless that is twice as deep; the trip is 400."""
    trace = trace_of((100, 1.0), (250, -0.6), (380, -0.9), (500, 0.95), (650, -0.5), (900, 0.9))
    assert _places(trace, EXPECTED, "towards") == pytest.approx((FOOT, 150.0, 400.0), rel=1e-12)
    away = Bar(1.0, 4.0, 0.02, 0.5 * (400 - 155))
    assert _places(trace, away, "away") == pytest.approx((FOOT, 150.0, 400.0), rel=1e-12)
    weak = trace_of((100, 1.0), (250, -0.44), (380, -0.9), (500, 0.95), (900, 0.9))
    assert _places(weak, EXPECTED, "towards").near == 280.0
    # nothing is expected within the trip: the deepest
    for distance in (0.2, 210.0):
        assert _places(trace, Bar(1.0, 4.0, 0.02, distance), "towards").near == 280.0
    # nine tenths of the largest echo make a round trip, less does not
    late = trace_of((100, 1.0), (250, -0.6), (500, 0.85), (900, 0.97))
    assert _places(late, EXPECTED, "towards").around == 800.0
    # a pulse that falls at once from its top, to less than a quarter
    cut = trace_of((100, 1.0), (250, -0.6), (380, -0.9), (500, 0.95), (900, 0.9))
    for place in (100, 250, 380, 500, 900):
        cut.trace.strain[place + 21 : place + 71] = 0.0
    assert _places(cut, EXPECTED, "towards") == pytest.approx((FOOT, 150.0, 400.0), rel=1e-12)
    # a later pulse of twice the height: half of it is reached by the first one still, on its plateau
    strong = trace_of((100, 1.0), (250, -0.6), (500, 1.9), (900, 1.9))
    assert _places(strong, EXPECTED, "towards").foot == pytest.approx(FOOT, rel=1e-12)


def test_records_of_one_pulse_are_refused_by_its_width():
    """Half of the height at 150 and the foot at 105.86: two widths are 88 samples, and two of those must follow."""
    assert int(2.0 * (150.0 - FOOT)) == 88
    with pytest.raises(InputError, match="no echo of the sign of the first pulse"):
        _places(trace_of((100, 1.0), size=106 + 176), EXPECTED, "towards")
    with pytest.raises(InputError, match="one pulse alone"):
        _places(trace_of((100, 1.0), size=106 + 175), EXPECTED, "towards")
    with pytest.raises(InputError, match="one pulse alone"):  # it never falls
        _places(trace_of((100, 1.0), size=140), EXPECTED, "towards")


def test_passes_are_cut_out_turned_over_and_transformed(rng):
    """From 100.4 on, 150 and 400 apart: windows of 150 samples from 30 before each place, padded to 600."""
    x = rng.standard_normal(770)
    quiet = SimpleNamespace(trace=GaugeTrace(x, 0.5, 3.0), noise=0.0)
    for skip, places in ((0, [100, 250, 500, 650]), (1, [250, 500, 650])):
        found = _passes(quiet, _Places(100.4, 150.0, 400.0), skip)
        assert list(found.places) == places
        assert (found.size, found.first) == (150, skip)
        assert found.frequency == pytest.approx(np.arange(301) / 300.0, rel=1e-14)
        for n, place in enumerate(places, skip):
            part = (1 if n % 2 == 0 else -1) * _taper(150, 30) * x[place - 30 : place + 120]
            assert found.spectra[n - skip] == pytest.approx(np.fft.rfft(part, 600), rel=1e-10, abs=1e-12)
    # the far end nearer: 130 of the 400
    assert _passes(quiet, _Places(100.4, 270.0, 400.0), 0).size == 130
    # a last window that lacks a sample is no pass
    short = SimpleNamespace(trace=GaugeTrace(x[:-1], 0.5, 3.0), noise=0.0)
    assert list(_passes(short, _Places(100.4, 150.0, 400.0), 0).places) == [100, 250, 500]
    with pytest.raises(InputError, match="2 passes"):
        _passes(short, _Places(100.4, 150.0, 400.0), 1)
    # passes end with the first that stays below the ceiling: 4.29 deviations in 770 samples are sqrt(2 ln 77000) = 4.74
    x[470:620] *= 0.9 * 4.74 / np.abs(x[470:620]).max()
    calm = SimpleNamespace(trace=GaugeTrace(np.concatenate([9.0 * x[:470], x[470:]]), 0.5, 3.0), noise=1.0)
    with pytest.raises(InputError, match="2 passes"):
        _passes(calm, _Places(100.4, 150.0, 400.0), 0)
    calm.noise = 0.89
    assert _passes(calm, _Places(100.4, 150.0, 400.0), 0).places.size >= 3
    # a lead of 30 samples of half a second
    early = SimpleNamespace(trace=GaugeTrace(x[70:], 0.5, 3.0), noise=0.0)
    assert _passes(early, _Places(30.4, 150.0, 400.0), 0).places[0] == 30
    with pytest.raises(InputError, match=r"1\.45e\+07 us before the first pass: at least 1\.5e\+07 us|1\.45e\+07 us"):
        _passes(early, _Places(29.4, 150.0, 400.0), 0)


def test_the_band_of_passes_worked_by_hand():
    """From 1/(20 x 0.25 ms) = 200 Hz on, up to where a pass is below 10 x 0.1 sqrt(20) = 4.47 or 3 % of its strongest."""
    strong = np.array([99.0, 9.0, 9.0, 9.0, 9.0, 5.0, 9.0, 9.0, 9.0, 9.0])
    for second, low, high in (
        (np.full(10, 9.0), 2, 10),
        (np.where(np.arange(10) == 7, 4.4, 9.0), 2, 7),
        (np.where(np.arange(10) == 7, 4.5, 9.0), 2, 10),
        (np.where(np.arange(10) == 0, 301.0, 9.0), 2, 2),
        (np.where(np.arange(10) == 0, 299.0, 9.0), 2, 10),
        (np.where(np.arange(10) < 2, 0.0, 9.0), 2, 10),
    ):
        passes = _Passes(np.arange(2), 20, 100.0 * np.arange(10), np.array([strong, second * 1j]), 0)
        found = _band(passes, SimpleNamespace(noise=0.1, trace=SimpleNamespace(step=0.25e-3)))
        assert list(found) == list(range(low, high))


def test_delays_by_phase_are_those_the_passes_were_made_with():
    """400 samples, and -0.3 to 1.4 ms more, whose phase turns over several times in the band."""
    frequency = np.arange(0.0, 5000.0, 50.0)
    more = -0.3e-3 + 1.7e-3 * (frequency / 5000.0) ** 2
    band = np.arange(4, 90)
    first = np.exp(1j * frequency / 700.0) * (1.0 + frequency)
    passes = _Passes(
        np.array([100, 500]), 50, frequency, np.array([first, 0.5 * first * np.exp(-2j * np.pi * frequency * more)]), 0
    )
    assert _delay(passes, 1, band, 0.5e-3) == pytest.approx(0.2 + more[band], rel=1e-12)
    assert _delay(passes, 0, band, 0.5e-3) == pytest.approx(np.zeros(86), abs=1e-15)


def test_plain_times_are_least_squares_of_phases():
    """w^2 of the weight: (3 x 1 d1 + 1 x 4 d2)/7 without dispersion; with it, each frequency as much later as it is slow."""
    data = passes_of(320e-6, 480e-6)[0]
    small = data._replace(
        delays=np.array([[0.0, 0.0], [7.0, 14.0]]), weight=np.array([3.0, 1.0]), w=np.array([1.0, 2.0])
    )
    assert _plain_times(small, 5000.0) == pytest.approx([0.0, 11.0], rel=1e-14)
    slow = data._replace(theory="pochhammer-chree", w=2.0 * np.pi * np.array([2e4, 6e4, 1e5]))
    later = (
        np.asarray(wave_number(slow.w, UNKNOWN.rod._replace(bar_speed=4900.0), "pochhammer-chree")).real
        * 4900.0
        / slow.w
    )
    assert later.max() > 1.02
    root = np.sqrt(slow.weight) * slow.w
    expected = [np.linalg.lstsq((root * later)[:, None], root * one, rcond=None)[0][0] for one in slow.delays]
    assert _plain_times(slow, 4900.0) == pytest.approx(expected, rel=1e-12, abs=1e-18)


def test_turns_and_trips_before_each_pass():
    data = passes_of(320e-6, 480e-6)[0]._replace(energy=np.ones(5))
    assert _turns(data, "towards").T.tolist() == [[1.0] * 5, [0, 1, 1, 2, 2], [0, 0, 1, 1, 2]]
    assert _turns(data, "away").T.tolist() == [[1.0] * 5, [0, 0, 1, 1, 2], [0, 1, 1, 2, 2]]
    assert _trips(data).T.tolist() == [[1.0] * 5, [0, 1, 0, 1, 0], [0, 0, 1, 1, 2]]
    later = data._replace(first=3)
    assert _turns(later, "towards").T.tolist() == [[1.0] * 5, [0, 0, 1, 1, 2], [0, 1, 1, 2, 2]]
    assert _trips(later).T.tolist() == [[1.0] * 5, [1, 0, 1, 0, 1], [0, 1, 1, 2, 2]]
    even = data._replace(first=4)
    assert _turns(even, "away").T.tolist() == _turns(data, "away").T.tolist()
    assert _trips(even).T.tolist() == _trips(data).T.tolist()


def test_no_pass_is_odd_that_less_than_two_too_many_foretell():
    """Three values are sought: of six passes the first is judged by five, of seven the second too, of five none."""
    for count, late, number in (
        (7, (0.0, 3e-6), 2),
        (6, (0.0, 3e-6), None),
        (6, (3e-6, 0.0), 1),
        (5, (3e-6, 0.0), None),
    ):
        data, times, ends = passes_of(320e-6, 480e-6, noise=1e-9, late=late)
        few = data._replace(delays=data.delays[:count], logs=0.0 * data.logs[:count], energy=data.energy[:count])
        found = _odd(few, times[:count], np.column_stack([np.ones(8), *ends])[:count], 1e-7)
        assert (found and found.number) == number, (count, late)


def test_what_is_foretold_weighs_the_pass_itself():
    """A mean of four, weights 2, and a value of weight 1/2: sqrt(s^2 (2 + 1/8)); Student at 1 in 1000, 3 degrees: 12.924."""
    values = np.array([0.0, 1.0, -1.0, 1.0, -1.0])
    weight = np.array([0.5, 2.0, 2.0, 2.0, 2.0])
    spread = math.sqrt(2 * 4 / 3 * (2 + 1 / 8))
    for times, sure in ((12.91, False), (12.94, True)):
        values[0] = times * spread
        assert _foretold(np.ones((5, 1)), values, weight, 0) == (pytest.approx(times * spread, rel=1e-12), sure)
