"""The pulse without its ringing: fitted together with it, against closed forms and planted truth."""

import math

import numpy as np
import pytest
from planted import classes

from strikewave.records import find_pulses, ringing
from strikewave.records.pulse_shape import SmoothPulse
from strikewave.records.ringing import (
    MODELS,
    Fit,
    RigidPulse,
    Stretch,
    _fit,
    _missed_at_tip,
    _mode,
    _mount,
    _plausible,
    _struck,
    fit_rigid_pulse,
    least_beside_one_mode,
)
from strikewave.records.robust import alike_as_one

STEP, PEAK, LENGTH, BEGIN = 1e-6, 1000.0, 200e-6, 1000e-6
TIME = STEP * np.arange(6000)


def half_sine(time=TIME):
    u = (time - BEGIN) / LENGTH
    return np.where((u > 0.0) & (u < 1.0), PEAK * np.sin(np.pi * np.clip(u, 0.0, 1.0)), 0.0)


def on_a_mount(ratio):
    """Absolute acceleration of an undamped oscillator under a half-sine, in closed form; ratio is 2 f T.

    x'' + w^2 x = w^2 base: A / (1 - r^2) (sin(pi t / T) - r sin(w t)) with r = pi / (w T), and after T the same swing
    from the beginning plus that from the end.
    """
    omega = math.pi * ratio / LENGTH
    r = 1.0 / ratio
    since, after = np.maximum(TIME - BEGIN, 0.0), np.maximum(TIME - BEGIN - LENGTH, 0.0)
    free = -PEAK * r / (1.0 - r**2)
    inside = np.where(TIME < BEGIN + LENGTH, PEAK / (1.0 - r**2) * np.sin(np.pi * since / LENGTH), 0.0)
    return inside + free * (np.sin(omega * since) + np.where(after > 0.0, np.sin(omega * after), 0.0))


def rigid_of(values):
    [pulse] = find_pulses(values, STEP)
    return pulse, pulse.rigid


def on_a_damped_mount(ratio, quality):
    """The same with damping: Duhamel's integral, summed over the samples."""
    omega = math.pi * ratio / LENGTH
    decay = 0.5 * omega / quality
    kernel = np.exp(-decay * TIME) * (2.0 * decay * np.cos(omega * TIME) + omega * np.sin(omega * TIME))
    kernel[0] *= 0.5
    return STEP * np.convolve(half_sine(), kernel)[: TIME.size]


@pytest.mark.parametrize("ratio", [1.6, 2.4, 4.4])
def test_a_sensor_on_a_mount_near_the_frequency_of_the_pulse(ratio, rng):
    """0.2 % of noise: the raw peak is off by up to 60 %, the rigid one by what noise does to a fit of seven parameters."""
    pulse, rigid = rigid_of(on_a_damped_mount(ratio, 10.0) + 0.002 * PEAK * rng.normal(size=TIME.size))
    assert abs(pulse.peak / PEAK - 1.0) > 0.1
    assert rigid.peak == pytest.approx(PEAK, rel=0.02)
    assert rigid.velocity_change == pytest.approx(2.0 / math.pi * PEAK * LENGTH, rel=0.01)
    assert rigid.frequency == pytest.approx(ratio / (2.0 * LENGTH), rel=0.01)
    assert pulse.differs_without_ringing


@pytest.mark.parametrize("share", [0.3, 0.6, 1.0])
@pytest.mark.parametrize("onset", [0.0, 0.5])
def test_a_mode_that_is_struck(share, onset, rng):
    since = np.maximum(TIME - BEGIN - onset * LENGTH, 0.0)
    swing = share * PEAK * np.exp(-since / 300e-6) * np.sin(2.0 * np.pi * 23e3 * since)
    pulse, rigid = rigid_of(half_sine() + swing + 0.002 * PEAK * rng.normal(size=TIME.size))
    assert pulse.peak > (1.0 + 0.4 * share) * PEAK
    assert rigid.peak == pytest.approx(PEAK, rel=0.03)  # it was struck in the middle of a family that bends instead
    assert rigid.width == pytest.approx(0.936 * LENGTH, rel=0.05)


def test_the_oscillator_is_that_of_the_closed_form():
    """Ramp-invariant: exact but for the lines between 200 samples of the half-sine, (pi / 200)^2 / 12 = 2e-5."""
    response, gains = _mount(half_sine(), TIME, STEP, math.pi * 2.4 / LENGTH, 1e-9)
    assert gains.tolist() == [1.0]
    assert np.max(np.abs(response[0] - on_a_mount(2.4))) < 1e-4 * PEAK


def test_the_oscillator_is_the_recursion_over_samples():
    """A first-order recursion with a complex root; many pulses at once as each alone, to rounding."""
    from scipy.signal import lfilter

    pulses = np.array([half_sine(), half_sine(TIME - 700e-6)])
    omega, decay = np.array([[4e4], [9e4]]), np.array([[2e3], [6e4]])
    together, _ = _mount(pulses, TIME, STEP, omega, decay)
    for k in range(2):
        w, d = omega[k, 0], decay[k, 0]
        grown = np.exp(complex(-d, w) * STEP)
        first = (grown - 1.0) / complex(-d, w)
        ramp = (first - STEP) / (complex(-d, w) * STEP)
        swing = lfilter([ramp, first - ramp], [1.0, -grown], pulses[k])
        assert together[k, 0] == pytest.approx(2.0 * d * swing.real + (w**2 - d**2) / w * swing.imag, abs=1e-9 * PEAK)


def test_what_one_mode_leaves_of_one_and_of_two():
    """Of one next to nothing, between the lines of the grid (3 % of frequency, a factor 1.8 of decay); of two of equal
    size and frequencies far apart the half, which is the other one."""
    one, two = (np.exp(-TIME / 2e-3) * np.sin(2.0 * np.pi * f * TIME) for f in (23e3, 37e3))
    fine = slice(0, 300)
    assert least_beside_one_mode(one[fine], STEP, 25e3) < 0.02 * np.sum(one[fine] ** 2)
    assert least_beside_one_mode((one + two)[fine], STEP, 25e3) == pytest.approx(np.sum(two[fine] ** 2), rel=0.1)


def test_what_one_mode_leaves_is_the_least_of_its_grid(rng):
    """Each frequency, 61 over a factor e^1.8, and each decay, 12 over e^6.7, by numpy's least squares."""
    values, step, frequency = rng.normal(size=30), 2e-4, 700.0
    time = step * np.arange(30)
    left = []
    for omega in 2.0 * np.pi * frequency * np.exp(np.linspace(-0.9, 0.9, 61)):
        for decay in 2.0 * np.pi * frequency * np.exp(np.linspace(-7.0, -0.3, 12)):
            columns = np.exp(-decay * time)[:, None] * np.stack([np.cos(omega * time), np.sin(omega * time)]).T
            left.append(np.linalg.lstsq(columns, values, rcond=None)[1][0])
    assert least_beside_one_mode(values, step, frequency) == pytest.approx(min(left), rel=1e-9)
    assert least_beside_one_mode(values[:7], step, frequency) == 0.0
    assert least_beside_one_mode(values[:8], step, frequency) > 0.0


def test_a_struck_swing_begins_at_rest_and_its_cosine_grows_in_a_quarter_of_it():
    """A half and a whole swing after its onset: 1 - e^-2 and 1 - e^-4 of a cosine, and a sine of a quarter."""
    omega, decay = 2.0 * math.pi / 40e-6, 3e3
    since = 1e-6 * np.array([-5.0, 0.0, 10.0, 20.0, 40.0])
    pulse = np.arange(5.0)
    columns, gains = _struck(pulse, since, 1e-6, omega, decay)
    fall = np.exp(-decay * np.maximum(since, 0.0))
    assert gains.tolist() == [1.0, 0.0, 0.0]
    assert columns[0].tolist() == pulse.tolist()
    expected = np.array([0.0, 0.0, 0.0, -(1.0 - math.exp(-2.0)), 1.0 - math.exp(-4.0)])
    assert columns[1] == pytest.approx(fall * expected, abs=1e-12)
    assert columns[2] == pytest.approx(fall * np.array([0.0, 0.0, 1.0, 0.0, 0.0]), abs=1e-12)


def test_a_mode_is_a_pulse_and_what_a_mount_makes_of_it():
    """Neither changes what a slow pulse is: both have a gain of one."""
    pulse = half_sine()[::10]
    columns, gains = _mode(pulse, TIME[::10], 10.0 * STEP, 1e5, 2e3)
    assert gains.tolist() == [1.0, 1.0]
    assert np.array_equal(columns[0], pulse)
    assert np.array_equal(columns[1], _mount(pulse, TIME[::10], 10.0 * STEP, 1e5, 2e3)[0][0])
    assert np.sum(columns[1]) == pytest.approx(np.sum(pulse), rel=1e-4)


def test_a_tip_is_missed_by_the_mean_over_a_25th_of_its_length():
    """Four samples of a hundred: their mean for samples halfway beside the tip, and what is left of them is added. What lies beyond a quarter of the length is none of it; between both as likely."""
    pulse = SmoothPulse(7.0, 40.5, 100.0, 0.5, 1.0)
    own = 7.0 * np.mean(np.cos(np.pi * np.array([-1.5, -0.5, 0.5, 1.5]) / 100.0))
    for places, value, top in (
        (range(89, 93), 0.8, own + 0.8),
        (range(89, 93), -9.0, None),
        (range(112, 116), 9.0, 0.0),
    ):
        rest = np.zeros(200)
        rest[list(places)] = value
        seen = pulse.at(np.arange(200.0)) + rest
        if top is None:  # the next four beside the dip
            top = np.mean(seen[93:97])
        elif top == 0.0:
            top = max(own, np.mean(seen[112:116]))
        assert _missed_at_tip(rest, pulse, 1.0) == pytest.approx(abs(top - 7.0) / math.sqrt(3.0), rel=1e-9)
        assert _missed_at_tip(rest, pulse._replace(begin=81.0, length=200.0), 2.0) == pytest.approx(
            abs(top - 7.0) / math.sqrt(3.0), rel=1e-9
        )
    rest = np.zeros(200)
    rest[116:] = 99.0  # 25.5 samples after the tip, and 25 are near it
    assert _missed_at_tip(rest, pulse, 1.0) == pytest.approx((7.0 - own) / math.sqrt(3.0))
    assert _missed_at_tip(rest[:60], pulse, 1.0) == 0.0
    assert _missed_at_tip(np.zeros(68), pulse, 1.0) == 0.0  # two are near, four are needed
    assert _missed_at_tip(np.zeros(70), pulse, 1.0) > 0.0


GUESS = SmoothPulse(100.0, 3e-3, 2e-3, 0.5, 1.0)


def fit_of(model, misfit, peak=100.0, length=2e-3, omega=2e4, decay=500.0, doubt=(0.0, 0.0, 0.0)):
    return Fit(
        SmoothPulse(peak, 3e-3, length, 0.5, 1.0), omega, decay, misfit, np.array(doubt), model.__name__.strip("_")
    )


def test_a_rigid_pulse_is_narrower_than_four_times_its_guess_and_higher_than_a_quarter():
    for peak, length, plausible in (
        (26.0, 7.9e-3, True),
        (24.0, 7.9e-3, False),
        (26.0, 8.1e-3, False),
        (24.0, 9e-3, False),
    ):
        assert _plausible(fit_of(_mount, 0.01, peak, length), GUESS) is plausible


@pytest.fixture
def chosen(monkeypatch):
    """Return what is chosen of fits that are put in, by model and beginning, and which beginnings were tried."""

    def choose(fits, models=None, noise=0.0):
        tried = []

        def put_in(values, step, guess, frequency, model, onset):
            tried.append((model, round(guess.length / GUESS.length, 9), onset))
            assert (step, frequency, values.size) == (1e-5, 9e3, 5)
            return fits.get(tried[-1], fits.get(model))

        monkeypatch.setattr(ringing, "_fit", put_in)
        return fit_rigid_pulse(np.zeros(5), 1e-5, GUESS, 9e3, noise, models), tried

    return choose


def test_fits_begin_anew_until_they_fit(chosen):
    """Of a model that misses less than 3 % no other beginning is tried; late onsets are of a struck mode alone; where
    all miss by more than a fifth nothing else is."""
    every = [(m, share, onset) for share, onset in ((1.0, 0.0), (0.65, 0.0)) for m in MODELS] + [(_struck, 1.0, 0.45)]
    assert chosen({m: fit_of(m, 0.031) for m in MODELS})[1] == every
    assert chosen({m: fit_of(m, 0.029 if m is _mode else 0.031) for m in MODELS})[1] == [
        one for one in every if one[0] is not _mode or one[1] == 1.0
    ]
    found, tried = chosen({m: fit_of(m, 0.201) for m in MODELS})
    assert (found, tried) == (None, every[:3])
    found, tried = chosen({m: fit_of(m, 0.199) for m in MODELS})
    assert (found, tried) == (None, every)
    assert chosen({})[0] is None
    assert chosen({_mode: fit_of(_mode, 0.031)}, [_mode])[1] == every[1:2]
    better = {_mount: fit_of(_mount, 0.1), every[3]: fit_of(_mount, 0.09, 90.0)}
    assert chosen(better)[0].peak == 90.0
    assert chosen(better | {every[3]: fit_of(_mount, 0.11, 90.0)})[0].peak == 100.0


@pytest.mark.parametrize(
    ("misfits", "noise", "model"),
    [
        ((0.119, 0.5, 0.5), 0.0, "mount"),
        ((0.121, 0.5, 0.5), 0.0, None),
        ((0.029, 0.001, 0.5), 0.0, "mount"),
        ((0.031, 0.001, 0.5), 0.0, "mode"),
        ((0.031, 0.001, 0.5), 3.2, "mount"),
        ((0.074, 0.05, 0.5), 0.0, "mount"),
        ((0.076, 0.05, 0.5), 0.0, "mode"),
        ((0.076, 0.05, 0.03), 0.0, "struck"),
    ],
)
def test_the_simplest_model_that_fits_about_as_well_is_taken(chosen, misfits, noise, model):
    """Within 1.5 times the least, 3 % of the peak, or what noise is of it; 12 % are poor."""
    found, _ = chosen({m: fit_of(m, misfit) for m, misfit in zip(MODELS, misfits, strict=True)}, noise=noise)
    assert (found and found.model) == model


def test_what_does_not_swing_or_cannot_be_is_no_fit(chosen):
    fits = {
        _mount: fit_of(_mount, 0.02, decay=0.71 * 2e4),
        _mode: fit_of(_mode, 0.02, peak=20.0),
        _struck: fit_of(_struck, 0.02),
    }
    assert chosen(fits)[0].model == "struck"
    assert chosen(fits | {_mount: fit_of(_mount, 0.02, decay=0.69 * 2e4)})[0].model == "mount"


@pytest.mark.parametrize(
    ("model", "omega", "shapes"),
    [
        (_mount, 2e3, (0.025, 0.04, 0.015)),
        (_mode, 2.0 * math.pi * 2.51 / (0.936231 * 2e-3), (0.025, 0.04, 0.015)),
        (_mode, 2.0 * math.pi * 2.49 / (0.936231 * 2e-3), (0.2 * 1.5, 0.25 * 1.5, 0.15 * 1.5)),
    ],
)
def test_a_rigid_pulse_is_as_uncertain_as_its_fit_its_models_and_its_shape(chosen, model, omega, shapes):
    """Root sum of squares of the fit's, of what models as good say, equally likely up to it, and of shapes with half of
    what is missed. A model that misses more than 1.5 times as much says nothing."""
    doubt = np.array([2.0, 3e-5, 5e-3])
    fits = {model: fit_of(model, 0.045, omega=omega, decay=90.0, doubt=doubt)}
    fits[_struck] = fit_of(_struck, 0.067, 107.0, 1.9e-3)
    if model is _mode:
        fits[_mount] = fit_of(_mount, 0.068, 130.0)
    found, _ = chosen(fits)
    best, other = fits[model].pulse, fits[_struck].pulse
    own = np.array([100.0, best.width(), best.area()])
    apart = np.abs(own - [107.0, other.width(), other.area()]) / math.sqrt(3.0)
    floor = own * np.sqrt(np.square(shapes) + 0.0225**2)
    expected = np.sqrt(doubt**2 + apart**2 + floor**2)
    named = [getattr(found, f"{name}_uncertainty") for name in ("peak", "width", "velocity_change")]
    assert named == pytest.approx(expected, rel=1e-4)
    assert (found.peak, found.width, found.velocity_change) == pytest.approx(own)
    assert found.rise == best.rise()
    assert (found.frequency, found.misfit, found.shape) == (pytest.approx(omega / (2.0 * math.pi)), 0.045, best)
    assert found.damping == pytest.approx(90.0 / math.hypot(90.0, omega))
    moved = found.moved(0.5, -1.0)
    assert (moved.peak, moved.velocity_change) == (-found.peak, -found.velocity_change)
    assert moved.shape == best._replace(begin=best.begin + 0.5, peak=-best.peak)
    assert moved.width == found.width


def test_a_fit_that_misses_little_has_the_uncertainty_of_a_swing_like_the_pulse(chosen):
    """A fifth of the peak, a quarter of the width and 15 % of the area, with half of the 2 % that it misses."""
    omega = 2.0 * math.pi * 2.49 / (0.936231 * 2e-3)
    found, _ = chosen({_mode: fit_of(_mode, 0.02, omega=omega, decay=90.0, doubt=np.zeros(3))})
    assert found.peak_uncertainty / found.peak == pytest.approx(math.hypot(0.2, 0.01), rel=1e-9)
    assert found.width_uncertainty / found.width == pytest.approx(math.hypot(0.25, 0.01), rel=1e-9)
    assert found.velocity_change_uncertainty / found.velocity_change == pytest.approx(math.hypot(0.15, 0.01), rel=1e-9)


def mounted(v, count, step, guess, omega0):
    """Return what a sensor on a mount records of a pulse of peak 1, by Duhamel's integral over finer samples."""
    fine = 8
    time = step / fine * np.arange(count * fine)
    omega, decay = omega0 * math.exp(v[4]), omega0 * math.exp(v[4] + v[5])
    pulse = SmoothPulse(1.0, guess.begin + v[0] * guess.length, guess.length * math.exp(v[1]), v[2], v[3]).at(time)
    kernel = np.exp(-decay * time) * (
        2.0 * decay * np.cos(omega * time) + (omega**2 - decay**2) / omega * np.sin(omega * time)
    )
    kernel[0] *= 0.5
    return (step / fine * np.convolve(pulse, kernel)[: time.size])[::fine]


@pytest.mark.parametrize("smooth", [False, True])
def test_doubts_of_a_fit_are_those_of_least_squares_of_all_its_parameters(smooth, rng):
    """Width and area of the covariance s^2 (J'J)^-1 of seven parameters, derivatives by difference; of the area without
    what is not known of the amplitude alone, which the peak has of its own."""
    guess, count, step, omega0 = SmoothPulse(1.0, 25.0, 60.0, 0.5, 1.0), 480, 0.5, 0.28
    truth = np.array([0.03, 0.05, 0.45, 1.4, 0.02, -2.6])
    other = np.sin(np.arange(count) / 37.0) if smooth else rng.normal(size=count)  # neighbours that are alike to 0.9996
    values = 3.0 * mounted(truth, count, step, guess, omega0) + (0.001 if smooth else 0.005) * other
    fit = _fit(values, step, guess, omega0 / (2.0 * math.pi), _mount, 0.0)
    pulse = fit.pulse
    decays = math.log(fit.omega / omega0), math.log(fit.decay / fit.omega)
    shape = (pulse.begin - 25.0) / 60.0, math.log(pulse.length / 60.0), pulse.rise_share, pulse.power
    v = np.array([*shape, *decays])
    assert v == pytest.approx(truth, abs=0.1)
    assert pulse.peak == pytest.approx(3.0, rel=0.02)
    base = mounted(v, count, step, guess, omega0)
    time = step * np.arange(count)
    rest = values - _mount(pulse.at(time), time, step, fit.omega, fit.decay)[0][0]  # with lines between its samples
    steps = 1e-4 * np.eye(6)
    slopes = [
        pulse.peak * (mounted(v + s, count, step, guess, omega0) - mounted(v - s, count, step, guess, omega0)) / 2e-4
        for s in steps
    ]
    columns = np.array([*slopes, base]).T
    variance = np.sum(rest**2) / (count - 9) * alike_as_one(rest, 0.98)
    covariance = variance * np.linalg.inv(columns.T @ columns)

    def figures(w):
        one = SmoothPulse(w[6], 0.0, 60.0 * math.exp(w[1]), w[2], w[3])
        return np.array([one.peak, one.width(), one.area()])

    whole = np.append(v, pulse.peak)
    slopes = np.array([(figures(whole + s) - figures(whole - s)) / 2e-5 for s in 1e-5 * np.eye(7)])
    variances = np.diag(slopes.T @ covariance @ slopes).copy()
    alone = variance / np.sum(base**2)
    variances -= np.array([1.0, 0.0, pulse.area() / pulse.peak]) ** 2 * alone
    own = math.sqrt(variance / (0.5 * pulse.length / step))
    tip = _missed_at_tip(rest, pulse, step)
    expected = [math.sqrt(variances[0] + own**2 + tip**2), math.sqrt(variances[1]), math.sqrt(variances[2])]
    assert fit.doubt == pytest.approx(np.array(expected), rel=0.01)  # terms of the second order in what is left
    assert fit.misfit == pytest.approx(math.sqrt(np.mean(rest**2)) / pulse.peak, rel=1e-3)
    scaled = _fit(1e4 * values, step, guess, omega0 / (2.0 * math.pi), _mount, 0.0)
    assert scaled.doubt == pytest.approx(fit.doubt * [1e4, 1.0, 1e4], rel=1e-3)
    assert scaled.pulse.peak == pytest.approx(1e4 * pulse.peak, rel=1e-4)
    assert _fit(-values, step, guess, omega0 / (2.0 * math.pi), _mount, 0.0) is None


SMOOTH = SmoothPulse(2.0, 1010e-6, 300e-6, 0.5, 1.0)


@pytest.fixture
def given(monkeypatch):
    """Return what is fitted of a stretch, and what comes of a fit that is put in."""

    def give(values, begin, end, width, frequency, rigid=None, least=0.0, last=None, swings=True, step=1e-6):
        seen = {}

        def fit(*asked):
            seen.setdefault("fits", []).append(asked)
            return rigid

        def beside(tail, step, frequency):
            seen["tail"] = tail.size
            return least(seen) if callable(least) else least

        monkeypatch.setattr(ringing, "fit_rigid_pulse", fit)
        monkeypatch.setattr(ringing, "least_beside_one_mode", beside)
        monkeypatch.setattr(ringing, "swings_after", lambda stretch: swings)
        stretch = Stretch(values, step, begin, end, width, SMOOTH, 0.06)
        return ringing.rigid_pulse(stretch, frequency, last), seen

    return give


def stand_in(misfit=0.01, damping=0.05, model="mode"):
    return RigidPulse(2.0, 1e-5, 1e-4, 3e-4, 0.1, 1e-6, 1e-5, 5e3, damping, misfit, model, SMOOTH)


@pytest.mark.parametrize(
    ("width", "frequency", "low", "high", "factor", "tail"),
    [
        (300.0, 5e3, 820, 2520, 4, (1320 + 75 - 820) / 4),
        (300.0, 40e3, 820, 2220, 2, (1320 + 75 - 820) / 2),
        (70.0, 20e3, 958, 1620, 2, (1320 + 17.5 - 958) / 2),
        (40.0, 12e3, 976, 1820, 1, 1320 + 120 - 976),
        (5.0, 400e3, 997, 1344, 1, 1320 + 1.25 - 997),
        (420.0, 2.3e3, 748, 3929, 7, (1320 + 1260 - 748) / 7),
        (900.0, 2.4e3, 460, 4000, 8, (1320 + 225 - 460) / 8),
    ],
)
def test_what_is_fitted_of_a_stretch(given, rng, width, frequency, low, high, factor, tail):
    """From 0.6 widths before the feet to three widths, six swings or 24 samples after them; means that leave some 500
    samples, 12 a swing and 24 a width. The tail begins a quarter of a width after the feet, or three widths where the
    blow may be one lobe."""
    values = rng.normal(size=4000)
    found, seen = given(values, 1000, 1320, width, frequency)
    [(part, step, guess, asked, noise, models)] = seen["fits"]
    count = (high - low) // factor
    assert part == pytest.approx(values[low : low + count * factor].reshape(count, factor).mean(axis=1))
    assert (step, asked, models) == (pytest.approx(factor * 1e-6), frequency, MODELS)
    assert noise == pytest.approx(0.06 / math.sqrt(factor))
    middle = 1e-6 * (low + 0.5 * (factor - 1))
    assert guess == SMOOTH._replace(begin=pytest.approx(SMOOTH.begin - middle))
    assert seen["tail"] == count - round(tail)
    assert found is None
    found, _ = given(values, 1000, 1320, width, frequency, stand_in())
    assert found.shape.begin == pytest.approx(SMOOTH.begin + middle)


def test_what_no_mode_explains_or_makes_better_is_no_ringing(given, rng):
    """A quarter of the squares that the smooth pulse misses in the tail, and half of its root mean square in all."""
    values = 0.3 * rng.normal(size=2400)

    def alone():
        low, count, factor = 820, 466, 3
        part = values[low : low + count * factor].reshape(count, factor).mean(axis=1)
        return part - SMOOTH.at(1e-6 * (low + 1.0 + factor * np.arange(count)))

    values = values[:2220]
    squares, root = np.sum(alone() ** 2), math.sqrt(np.mean(alone() ** 2))
    sizes = (1000, 1320, 300.0, 6.7e3)
    for share, fitted in ((0.249, True), (0.251, False)):
        assert ("fits" in given(values, *sizes, stand_in(), share * squares)[1]) is fitted
    for share, better in ((0.49, True), (0.51, False)):
        assert (given(values, *sizes, stand_in(share * root / 2.0))[0] is not None) is better
    for damping, swings, rings in ((0.19, False, True), (0.21, False, False), (0.21, True, True)):
        assert (given(values, *sizes, stand_in(0.0, damping), swings=swings)[0] is not None) is rings
    for frequency in (math.nan, 0.0):
        assert given(values, *sizes[:3], frequency, stand_in(0.0)) == (None, {})
    for size, enough in ((24, True), (23, False)):
        assert ("fits" in given(values[:size], 2, 10, 8.0, 2e5, stand_in())[1]) is enough


def test_the_model_of_the_blow_before_is_tried_first(given, rng):
    values = 0.3 * rng.normal(size=2220)
    asked = [one[5] for one in given(values, 1000, 1320, 300.0, 6.7e3, None, last=stand_in(model="struck"))[1]["fits"]]
    assert asked == [[_struck], MODELS]
    fits = given(values, 1000, 1320, 300.0, 6.7e3, stand_in(), last=stand_in(model="mount"))[1]["fits"]
    assert [one[5] for one in fits] == [[_mount]]


@pytest.mark.parametrize("power", [1.0, 2.0])
def test_a_pulse_that_does_not_ring_has_no_other(power, rng):
    for rise in (0.3, 0.5, 0.8):
        clean = SmoothPulse(PEAK, BEGIN, LENGTH, rise, power).at(TIME)
        assert rigid_of(clean + 0.01 * PEAK * rng.normal(size=TIME.size))[1] is None


def test_a_negative_blow_has_a_negative_rigid_peak():
    since = np.maximum(TIME - BEGIN, 0.0)
    swing = 0.7 * PEAK * np.exp(-since / 300e-6) * np.sin(2.0 * np.pi * 23e3 * since)
    _, rigid = rigid_of(-half_sine() - swing)
    assert rigid.peak == pytest.approx(-PEAK, rel=0.02)
    assert rigid.velocity_change < 0.0
    assert rigid.shape.begin == pytest.approx(BEGIN, abs=0.03 * LENGTH)
    assert np.max(np.abs(rigid.shape.at(TIME) + half_sine())) < 0.06 * PEAK


def test_a_campaign_has_the_figures_without_ringing(rng):
    """Three blows of 1000 that ring by 60 %, and one that does not: raw peaks are left out, rigid ones are not."""
    from strikewave.records import Channel, Record, Request, read_file, summed

    since = np.maximum(TIME - BEGIN, 0.0)
    swing = 0.6 * PEAK * np.exp(-since / 300e-6) * np.sin(2.0 * np.pi * 23e3 * since)
    files = []
    for k in range(4):
        values = half_sine() + (swing if k else 0.0) + 0.002 * PEAK * rng.normal(size=TIME.size)
        record = Record(f"{k}.csv", "text", (Channel("board", values, STEP, unit="m/s^2"),))
        files.append(read_file(record, {}, Request()))
    campaign = summed(files)
    assert campaign.statistics["peak"].n == 1
    assert campaign.statistics["rigid_peak"].n == 4
    assert campaign.statistics["rigid_peak"].mean == pytest.approx(PEAK, rel=0.02)
    assert campaign.statistics["rigid_width"].mean == pytest.approx(0.936 * LENGTH, rel=0.05)


@pytest.mark.verify
def test_its_uncertainty_covers_noise(rng):
    """A swing of 60 % in noise of 2 %: two standard uncertainties hold 19 of 20 peaks; 16 draws allow three beyond."""
    since = np.maximum(TIME - BEGIN, 0.0)
    clean = half_sine() + 0.6 * PEAK * np.exp(-since / 300e-6) * np.sin(2.0 * np.pi * 23e3 * since)
    guess = SmoothPulse(PEAK, 200e-6, LENGTH, 0.5, 1.0)
    part = clean[800:2000].reshape(-1, 3).mean(axis=1)
    beyond = 0
    for _ in range(16):
        rigid = fit_rigid_pulse(part + 0.02 * PEAK * rng.normal(size=part.size), 3.0 * STEP, guess, 23e3, 0.02 * PEAK)
        beyond += abs(rigid.peak - PEAK) > 2.0 * rigid.peak_uncertainty
    assert beyond <= 3


def flat_pulse():
    """Flat for 60 % of its length, with ramps of half a cosine: no family has it."""
    u = np.clip((TIME - BEGIN) / LENGTH, 0.0, 1.0)
    return PEAK * (0.5 - 0.5 * np.cos(np.pi * np.clip(np.minimum(u, 1.0 - u) / 0.2, 0.0, 1.0)))


def saw_tooth():
    """Straight up to a sharp tip, down in a tenth of the length, as a filter of 16 samples leaves it."""
    u = (TIME - BEGIN) / LENGTH
    sharp = np.maximum(np.minimum(u / 0.9, (1.0 - u) / 0.1), 0.0)
    filtered = np.convolve(sharp, np.hanning(18)[1:-1], "same")
    return PEAK * filtered / np.max(filtered)


@pytest.mark.parametrize("shape", [saw_tooth, flat_pulse])
@pytest.mark.parametrize("swings", [1.0, 2.0, 9.0])
def test_the_stated_uncertainty_covers_what_no_family_of_pulses_has(shape, swings, rng):
    """Two standard uncertainties of the peak, whether pulse and swing look alike or a tip is cut off."""
    since = np.maximum(TIME - BEGIN, 0.0)
    swing = 0.5 * PEAK * np.exp(-since / 500e-6) * np.sin(2.0 * np.pi * swings / LENGTH * since)
    _, rigid = rigid_of(shape() + swing + 0.002 * PEAK * rng.normal(size=TIME.size))
    assert rigid is None or abs(rigid.peak - PEAK) < max(2.0 * rigid.peak_uncertainty, 0.05 * PEAK)
    assert swings < 2.5 or rigid is not None


@pytest.mark.parametrize("seed", [320071, 320121, 320188, 320355])
def test_a_blow_that_is_one_lobe_of_its_ringing(seed):
    """Planted pulses that ring less than once in the width of what is seen, twice as high as they are: the tail alone
    is more than one mode, for the pulse goes on in it, and yet the pulse is found."""
    [draft] = classes.draw("ringing", seed).files
    [pulse] = find_pulses(draft.sign * draft.values, draft.setting.step)
    [blow] = draft.blows
    assert pulse.rigid.frequency * pulse.width < 1.0
    assert pulse.peak > 1.8 * blow.peak
    assert pulse.rigid.peak == pytest.approx(blow.peak, rel=0.05)  # what shapes do that no model has: 2.5 % each way
    assert abs(pulse.rigid.peak - blow.peak) < 2.0 * pulse.rigid.peak_uncertainty
