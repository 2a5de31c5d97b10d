"""Decaying swings: exact sums of them, an independent solver, and each bound from both sides."""

import math

import numpy as np
import pytest
from scipy.optimize import least_squares

from strikewave.records import response
from strikewave.records.response import Mode, decaying_modes

STEP = 2e-5
TIME = STEP * np.arange(600)


def swing(decay, frequency, amplitude, phase=0.3, time=TIME):
    return amplitude * np.exp(-decay * time) * np.cos(2.0 * math.pi * frequency * time + phase)


def exact(decay, frequency, amplitude):
    """Return frequency, damping ratio, amplitude and time to fall to 1/e."""
    return frequency, decay / math.hypot(decay, 2.0 * math.pi * frequency), amplitude, 1.0 / decay


@pytest.mark.parametrize("scale", [1e-9, -3e4])
def test_three_swings_on_a_level_are_found_with_their_figures_the_one_of_most_energy_first(scale):
    """Energies go with amplitude squared times the time to fall to 1/e: 2250 / 230, 640 / 90, 1600 / 410; the rest are
    weaker. A sum of exponentials is what is fitted: rounding is left."""
    parts = [(90.0, 620.0, 25.3), (230.0, 1900.0, 47.4), (410.0, 4300.0, 40.0)]
    values = scale * (sum(swing(*part) for part in parts) + 7.0)
    found = decaying_modes(values, STEP)
    for mode, part in zip(found, (parts[1], parts[0], parts[2]), strict=True):
        figures = (mode.frequency, mode.damping, mode.amplitude / abs(scale), mode.decay_time)
        assert figures == pytest.approx(exact(*part), rel=1e-7)
        assert mode.frequency_uncertainty < 1e-6 * mode.frequency


def test_of_four_swings_the_three_of_most_energy_are_told():
    parts = [(90.0, 620.0, 10.0), (230.0, 1900.0, 50.0), (410.0, 4300.0, 40.0), (300.0, 7300.0, 60.0)]
    found = decaying_modes(sum(swing(*part) for part in parts), STEP)
    assert [round(mode.frequency) for mode in found] == [7300, 1900, 4300]


def test_time_constant_and_damping_are_those_of_an_oscillator():
    """x'' + 2 D w0 x' + w0^2 x = 0 decays by D w0 and swings with w0 sqrt(1 - D^2)."""
    natural, damping = 5000.0, 0.3
    mode = Mode(natural * math.sqrt(1.0 - damping**2) / (2.0 * math.pi), damping, 2.0, 0.0, 0.0)
    assert mode.decay_time == pytest.approx(1.0 / (damping * natural), rel=1e-12)
    assert response._energy(mode) == pytest.approx(-4.0 / (damping * natural), rel=1e-12)


def columns_by_difference(parameters):
    """Return the derivatives of swings and a level by decay, angular frequency, cosine and sine of each, and level."""

    def model(v):
        pairs = v[:-1].reshape(-1, 4)
        both = [np.exp(-d * TIME) * (a * np.cos(w * TIME) + b * np.sin(w * TIME)) for d, w, a, b in pairs]
        return sum(both) + v[-1]

    sizes = np.maximum(np.abs(parameters), 1.0) * 1e-6
    steps = np.diag(sizes)
    return np.array([(model(parameters + s) - model(parameters - s)) / (2.0 * np.max(s)) for s in steps]).T, model


def newey_west(columns, rest):
    """Return (J'J)^-1 J'S J (J'J)^-1 as products of whole matrices; what the fit took of the noise is put back."""
    n = rest.size
    apart = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    memory = n // 20
    taper = np.maximum(1.0 - apart / (memory + 1), 0.0)
    base, corner = np.linalg.qr(columns)
    scattered = np.zeros((columns.shape[1], columns.shape[1]))
    own = np.array([np.sum(rest[k:] * rest[: n - k]) for k in range(n)])
    for _ in range(4):
        put_back = np.zeros(n)
        for k in range(columns.shape[1]):
            for lag in range(memory + 1):
                put_back[lag] += scattered[k, k] * np.sum(base[lag:, k] * base[: n - lag, k])
        scattered = base.T @ (((own + put_back) / n)[apart] * taper) @ base
    back = np.linalg.inv(corner)
    return back @ scattered @ back.T


def test_figures_and_their_uncertainties_are_those_of_an_independent_fit(rng):
    """Two swings in coloured noise: scipy's least squares from the truth, derivatives by difference, whole matrices."""
    noise = np.convolve(rng.normal(size=602), [1.0, 0.7, 0.3], "valid")
    values = swing(150.0, 1100.0, 20.0) + swing(260.0, 2700.0, 30.0, -0.9) + 4.0 + noise
    found = sorted(decaying_modes(values, STEP), key=lambda mode: mode.frequency)
    omegas = [2.0 * math.pi * f for f in (1100.0, 2700.0)]
    start = np.array([150.0, omegas[0], 19.0, -6.0, 260.0, omegas[1], 18.0, 23.0, 4.0])
    _, model = columns_by_difference(start)
    best = least_squares(lambda v: model(v) - values, start, x_scale=np.abs(start), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    columns, _ = columns_by_difference(best.x)
    covariance = newey_west(columns, values - model(best.x))
    for k, mode in enumerate(found):
        decay, omega, a, b = best.x[4 * k : 4 * k + 4]
        frequency, damping, amplitude, _ = exact(decay, omega / (2.0 * math.pi), math.hypot(a, b))
        assert (mode.frequency, mode.damping, mode.amplitude) == pytest.approx(
            (frequency, damping, amplitude), rel=1e-6
        )
        pair = covariance[4 * k : 4 * k + 2, 4 * k : 4 * k + 2]
        assert mode.frequency_uncertainty == pytest.approx(math.sqrt(pair[1, 1]) / (2.0 * math.pi), rel=1e-4)
        by = 1e-5 * np.array([decay, omega])
        slope = [
            (exact(decay + s, (omega + t) / (2.0 * math.pi), 1.0)[1] - damping) / max(s, t) for s, t in np.diag(by)
        ]
        assert mode.damping_uncertainty == pytest.approx(math.sqrt(slope @ pair @ slope), rel=1e-3)


def certain(values, roots, step=STEP):
    found = response._fitted(values, step, np.array(roots, dtype=complex))
    return None if found is None else found[1].tolist()


def test_uncertainties_follow_from_the_covariance_and_the_certain_is_told_from_it(monkeypatch):
    """A covariance of two modes put in: decays, frequencies, cosine and sine of each, level. An amplitude is certain
    beyond four of its standard uncertainties, a frequency below a tenth of itself."""
    parts = [(150.0, 1100.0, 0.2), (260.0, 2700.0, 0.3)]
    omegas = [2.0 * math.pi * part[1] for part in parts]
    root = np.random.default_rng(4).normal(size=(9, 9))
    covariance = 1e-5 * root @ root.T
    seen = {}

    def put_in(columns, rest):
        seen["shape"] = columns.shape
        return covariance

    monkeypatch.setattr(response, "covariance_of", put_in)
    values, roots = sum(swing(*part) for part in parts), [complex(-p[0], w) for p, w in zip(parts, omegas, strict=True)]
    found, sure = response._fitted(values, STEP, np.array(roots))
    assert seen["shape"] == (600, 9)
    assert sure.tolist() == [True, True]
    for k, (mode, part, omega) in enumerate(zip(found, parts, omegas, strict=True)):
        decay, size = part[0], math.hypot(part[0], omega)
        slope = np.zeros(9)
        slope[[k, 2 + k]] = 1.0 / size - decay**2 / size**3, -decay * omega / size**3
        assert (mode.frequency, mode.damping, mode.amplitude) == pytest.approx(exact(*part)[:3], rel=1e-7)
        assert mode.frequency_uncertainty == pytest.approx(math.sqrt(covariance[2 + k, 2 + k]) / (2.0 * math.pi))
        assert mode.damping_uncertainty == pytest.approx(math.sqrt(slope @ covariance @ slope), rel=1e-6)
    for share, expected in ((0.999, [True, True]), (1.001, [True, False])):
        covariance = np.diag([*6 * [1e-5], 0.4 * (0.3 * share / 4.0) ** 2, 0.0, 1.0])
        covariance[7, 7] = 1.6 * (0.3 * share / 4.0) ** 2
        assert certain(values, roots) == expected
        covariance = np.diag([1.0, 1.0, 1.0, (0.1 * share * omegas[1]) ** 2, *5 * [1e-5]])
        assert certain(values, roots) == expected
    covariance = None
    assert certain(values, roots) is None


def test_a_swing_that_keeps_more_than_nine_tenths_does_not_decay():
    """Decay times the time of the last sample: 0.099 and 0.101."""
    for share, seen in ((0.099, 0), (0.101, 1)):
        values = swing(share / TIME[-1], 1300.0, 5.0)
        assert len(decaying_modes(values, STEP)) == seen
        assert certain(values, [complex(-share / TIME[-1], 2.0 * math.pi * 1300.0)]) == [bool(seen)]


def test_fewer_than_thirty_samples_show_no_swing():
    """The shortest window holds four fifths of them, and 24 at least."""
    time = STEP * np.arange(30)
    values = swing(700.0, 5000.0, 3.0, time=time)
    [mode] = decaying_modes(values, STEP)
    assert mode.frequency == pytest.approx(5000.0, rel=1e-6)
    assert (
        decaying_modes(values[:29], STEP)
        == decaying_modes(np.zeros(500), STEP)
        == decaying_modes(values[:5], STEP)
        == ()
    )


def test_swings_faster_than_half_the_rate_or_slower_than_they_decay_are_none():
    """Beside one that is sound, and that is found without them."""
    sound = complex(-200.0, 2.0 * math.pi * 900.0)
    for decay, frequency in ((9000.0, 1300.0), (300.0, 1.0 / STEP - 1300.0)):
        values = swing(200.0, 900.0, 7.0) + swing(decay, frequency, 5.0)
        assert certain(values, [sound, complex(-decay, 2.0 * math.pi * frequency)]) is None


def test_the_weakest_of_roots_that_do_not_fit_are_dropped_one_by_one(monkeypatch):
    """The second decays faster than it swings: it goes, though the first is the lesser here."""
    values = swing(200.0, 900.0, 7.0) + swing(9000.0, 1300.0, 5.0)
    values[0] = 0.0  # one zero is no silence
    roots = [complex(-200.0, 2.0 * math.pi * 900.0), complex(-9000.0, 2.0 * math.pi * 1300.0)]
    monkeypatch.setattr(response, "_roots", lambda values, step: roots)
    [mode] = decaying_modes(values, STEP)
    assert mode.frequency == pytest.approx(900.0, rel=0.01)
    fits = iter([([], np.array([True, False])), (["last"], np.array([True]))])
    asked = []
    monkeypatch.setattr(response, "_fitted", lambda values, step, roots: asked.append(roots.tolist()) or next(fits))
    monkeypatch.setattr(response, "_energy", lambda mode: 0.0)
    assert decaying_modes(values, STEP) == ("last",)
    assert asked == [roots, roots[:1]]


@pytest.mark.parametrize("size", [40_000, 41_000])
def test_a_long_stretch_is_thinned(size):
    time = 1e-6 * np.arange(size)
    [mode] = decaying_modes(swing(90.0, 1500.0, 8.0, time=time), 1e-6)
    # the filter before thinning has ends, which cost some hundredths of a percent
    assert (mode.frequency, mode.amplitude, mode.decay_time) == pytest.approx((1500.0, 8.0, 1.0 / 90.0), rel=2e-3)


def test_a_pencil_gives_amplitudes_at_the_begin_of_the_stretch_that_its_window_is_of():
    """Roots of a window that begins late: the amplitude is carried back by the decay."""
    late = 150
    values = swing(350.0, 2100.0, 6.0) + swing(120.0, 5200.0, 2.0)
    found = sorted(response._pencil(values[late:], STEP, late * STEP), key=lambda pair: pair[0].imag)
    strong = [pair for pair in found if pair[1] > 1e-6]
    for (root, amplitude), (decay, frequency, size) in zip(
        strong, ((350.0, 2100.0, 6.0), (120.0, 5200.0, 2.0)), strict=True
    ):
        assert root == pytest.approx(complex(-decay, 2.0 * math.pi * frequency), rel=1e-7)
        assert amplitude == pytest.approx(size, rel=1e-6)


@pytest.mark.parametrize(
    ("share", "cycles", "kept", "factor"), [(0.095, 40, 84, 12), (0.105, 40, 334, 3), (1.0, 90, 400, 1)]
)
def test_roots_are_those_that_all_windows_show_within_a_twentieth(monkeypatch, share, cycles, kept, factor):
    """Three windows of what thinning leaves: eight samples or more of the fastest swing whose line is a tenth of the
    highest beside that of the level, 400 at most. Roots of the first count where both others have one within 5 % of its
    frequency, the one of most energy first."""
    windows = []
    answers = iter(
        [
            [(-20.0 + 1000.0j, 2.0), (-30.0 + 3000.0j, 9.0), (-40.0 + 5000.0j, 3.0), (-50.0 + 7000.0j, 9.0)],
            [(-1.0 + 1049.0j, 1.0), (-1.0 + 3149.0j, 1.0), (-1.0 + 4751.0j, 1.0), (-1.0 + 7351.0j, 1.0)],
            [(-1.0 + 951.0j, 1.0), (-1.0 + 2849.0j, 1.0), (-1.0 + 5249.0j, 1.0), (-1.0 + 7000.0j, 1.0)],
        ]
    )

    def answer(values, step, late):
        windows.append((values.size, step, late))
        return next(answers)

    monkeypatch.setattr(response, "_pencil", answer)
    turn = 2.0 * math.pi * np.arange(1000) / 1000
    lines = np.cos(10.0 * turn) + share * np.cos(cycles * turn)
    faded = np.hanning(2000)[1000:-1]  # and 0, where the lines are at their level
    roots = response._roots(np.r_[(lines - lines[-1])[:-1] / faded, 0.0], STEP)
    assert roots == [-40.0 + 5000.0j, -20.0 + 1000.0j]
    step = factor * STEP
    expected = [(kept, step, 0.0), (kept - round(0.1 * kept), step, 0.1 * kept * step), (round(0.8 * kept), step, 0.0)]
    assert windows == [pytest.approx(one) for one in expected]


def test_what_is_no_swing_is_dropped_by_the_pencil():
    """A decay without a swing, one that swings less than it decays, one that grows, and one that swings on."""
    growing = 1e-3 * np.exp(120.0 * TIME) * np.cos(2.0 * math.pi * 6100.0 * TIME)
    slow = 30.0 * np.exp(-800.0 * TIME) * np.cos(780.0 * TIME)
    for other in (20.0 * np.exp(-500.0 * TIME), slow, growing):
        found = [
            root
            for root, amplitude in response._pencil(swing(350.0, 2100.0, 6.0) + other, STEP, 0.0)
            if amplitude > 1e-4
        ]
        assert found == [pytest.approx(complex(-350.0, 2.0 * math.pi * 2100.0), rel=1e-5)]
    assert response._pencil(swing(350.0, 2100.0, 6.0)[:23], STEP, 0.0) == []
    assert len(response._pencil(swing(350.0, 2100.0, 6.0)[:24], STEP, 0.0)) == 1


@pytest.mark.parametrize(("amplitude", "seen"), [(4.6, 1), (3.4, 0)])
def test_a_swing_of_less_than_a_fiftieth_of_the_largest_is_not_sought(amplitude, seen):
    """Beside a level of 100: of its two singular values each has half of the amplitude."""
    values = swing(1.0, 2100.0, amplitude) + 100.0
    assert len(response._pencil(values, STEP, 0.0)) == seen
