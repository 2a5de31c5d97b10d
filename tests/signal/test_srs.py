"""Shock response spectra against closed forms at high precision, limits that every textbook gives, and traps."""

import functools
import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from strikewave.signal.oscillators import (
    KINDS,
    PLACES,
    acceleration,
    bend,
    displacement,
    free_extremes,
    interpolate,
    recursion,
    velocity,
)
from strikewave.signal.srs import Scope, octaves, rolling_srs, srs

mp.mp.dps = 60
QS = [0.3, 0.5, 0.5000001, 0.7, 10.0, 1e6, math.inf]
MULTIPLES = ("pseudo-velocity", "equivalent-static")
"""Kinds that are the displacement times a power of the frequency."""
RATES = [20.0, 47.0, 300.0, 1e4, 1e6, 1e8]  # samples a period


def mp_poles(w, q):
    """Poles in mpmath; critical damping is stepped aside by 1e-25."""
    zeta = mp.mpf(0) if math.isinf(q) else 1 / (2 * mp.mpf(q))
    zeta += mp.mpf(10) ** -25 if zeta == 1 else 0
    root = mp.sqrt(zeta**2 - 1)
    return w * (-zeta + root), w * (-zeta - root)


class Shape:
    """Response of an oscillator to a base acceleration made of delayed steps, ramps and sines, at 60 digits."""

    def __init__(self, terms, w, q, kind):
        self.terms, self.w, self.kind = terms, mp.mpf(w), kind
        self.p = mp_poles(self.w, q)
        m = {"absolute": [-p * p for p in self.p], "relative-velocity": list(self.p)}.get(kind, [mp.mpf(1), mp.mpf(1)])
        gap = self.p[0] - self.p[1]
        self.m = (m[0] / gap, -m[1] / gap)

    def unit(self, name, size, t):
        total = mp.mpc(0)
        for m, p in zip(self.m, self.p, strict=True):
            if name == "step":
                total += m * (mp.exp(p * t) - 1) / p
            elif name == "ramp":
                total += m * (mp.exp(p * t) - 1 - p * t) / p**2
            else:  # sine of angular frequency ``size``
                total += m * (size * mp.exp(p * t) - size * mp.cos(size * t) - p * mp.sin(size * t)) / (p * p + size**2)
        return total.real

    def __call__(self, t):
        found = mp.mpf(0)
        for name, begin, factor, *size in self.terms:
            if t > begin:
                found += factor * self.unit(name, size[0] if size else None, t - begin)
        return found * {"pseudo-velocity": self.w, "equivalent-static": self.w**2}.get(self.kind, 1)

    def extremes(self, begin, end):
        """Return the magnitudes of the largest and the smallest value between two times."""
        periods = float((end - begin) * abs(self.w)) / (2 * math.pi)
        grid = mp.linspace(begin, end, 60 + int(24 * min(periods, 60.0)))
        values = [self(t) for t in grid]
        return tuple(max(mp.mpf(0), self.climb(grid, [s * v for v in values], s)) for s in (1, -1))

    def climb(self, grid, values, sign):
        """Climb from the two highest places of the grid that are higher than both beside them."""
        padded = [-mp.inf, *values, -mp.inf]
        tops = [k for k in range(len(values)) if padded[k] <= padded[k + 1] >= padded[k + 2]]
        return max(self.climb_from(k, grid, values, sign) for k in sorted(tops, key=lambda k: values[k])[-2:])

    def climb_from(self, k, grid, values, sign):
        low, high = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
        shrink = (mp.sqrt(5) - 1) / 2
        for _ in range(26):
            a, b = high - shrink * (high - low), low + shrink * (high - low)
            low, high = (low, b) if sign * self(a) > sign * self(b) else (a, high)
        return max(values[k], sign * self((low + high) / 2))


def half_sine(T):
    return [("sine", 0, 1, mp.pi / T), ("sine", T, 1, mp.pi / T)]


def sampled(shape, samples):
    """Record of a pulse of one unit and ``samples`` steps, and its terms as straight lines, in steps."""
    if shape == "saw-tooth":
        values = np.arange(samples + 1) / samples
        slope = mp.mpf(1) / samples
        return values, [("ramp", 0, slope), ("ramp", samples, -slope - 1), ("ramp", samples + 1, mp.mpf(1))]
    values = np.ones(samples + 1)
    ends = [(-1, 1), (0, -1), (samples, -1), (samples + 1, 1)]
    return values, [("ramp", mp.mpf(t), mp.mpf(f)) for t, f in ends]


def expected(terms, begin, shock_end, last, rate, q, kind, part):
    """Extremes from the closed form; times in steps."""
    w = 2 * mp.pi / mp.mpf(rate)
    response = Shape(terms, w, q, kind)
    zeta = 0.0 if math.isinf(q) else 0.5 / q
    behind = last + (1 + 2 * zeta) * mp.mpf(1.1) * 2 * mp.pi / w
    found = []
    if part != "residual":
        found.append(response.extremes(mp.mpf(begin), mp.mpf(shock_end)))
    if part != "primary":
        if last > shock_end:
            found.append(response.extremes(mp.mpf(shock_end), mp.mpf(last)))
        found.append(response.extremes(mp.mpf(last), behind))
    return [float(max(row)) for row in zip(*found, strict=True)]


def both(spectrum):
    return [float(spectrum.positive[0]), float(spectrum.negative[0])]


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.verify] if kind in MULTIPLES else []) for kind in KINDS]
)
@pytest.mark.parametrize("part", [pytest.param("primary", marks=pytest.mark.verify), "residual"])
@pytest.mark.parametrize("shape", ["saw-tooth", pytest.param("rectangle", marks=pytest.mark.verify)])
@pytest.mark.parametrize(
    ("q", "rates"),
    [
        *(pytest.param(q, RATES, marks=pytest.mark.verify) for q in (0.3, 0.5, math.inf)),
        pytest.param(10.0, RATES[1::2], marks=pytest.mark.verify),
        (10.0, RATES[::2]),
    ],
)
def test_straight_lines_are_exact_at_every_rate(shape, part, kind, q, rates):
    values, terms = sampled(shape, 50)
    for rate in rates:
        wanted = expected(terms, -1, 50, 51, rate, q, kind, part)
        got = both(srs(values, 1.0, [1.0 / rate], q, kind, Scope(part)))
        assert got == pytest.approx(wanted, rel=1e-7, abs=1e-8 * max(wanted)), rate


@pytest.mark.verify
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("part", ["primary", "residual", "total"])
@pytest.mark.parametrize("q", [0.5, 10.0, math.inf])
def test_half_sine_of_fifty_samples_within_a_thousandth(part, kind, q):
    values = np.sin(np.pi * np.arange(51) / 50)
    values[-1] = 0.0
    for rate in RATES:
        wanted = expected(half_sine(mp.mpf(50)), 0, 50, 50, rate, q, kind, part)
        got = both(srs(values, 1.0, [1.0 / rate], q, kind, Scope(part)))
        # lines cut off (pi/50)^2/12 = 3.3e-4 of the area
        assert got == pytest.approx(wanted, rel=4e-4, abs=4e-4 * max(wanted) + 1e-13), rate


@pytest.mark.verify
def test_half_sine_of_a_thousand_samples_within_a_millionth():
    values = np.sin(np.pi * np.arange(1001) / 1000)
    values[-1] = 0.0
    for rate in (20.0, 100.0, 1500.0, 1e5):
        for q in (10.0, math.inf):
            wanted = expected(half_sine(mp.mpf(1000)), 0, 1000, 1000, rate, q, "absolute", "total")
            got = both(srs(values, 1.0, [1.0 / rate], q))
            assert got == pytest.approx(wanted, rel=2e-6, abs=2e-6 * max(wanted)), rate


@pytest.mark.parametrize("shape", ["saw-tooth", "rectangle"])
def test_ideal_shapes_within_a_thousandth(shape):
    # a rectangle gains half a step on each side; a saw-tooth half a step in all: samples enough for 0.1 %
    samples = 4000
    values, _ = sampled(shape, samples)
    N = mp.mpf(samples)
    terms = {
        "saw-tooth": [("ramp", 0, 1 / N), ("ramp", N, -1 / N), ("step", N, -1)],
        "rectangle": [("step", mp.mpf(0), 1), ("step", N, -1)],
    }[shape]
    for rate in (2000.0, 9000.0, 1e5, 1e7):
        wanted = expected(terms, 0, N, N, rate, 10.0, "absolute", "total")
        assert both(srs(values, 1.0, [1.0 / rate])) == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize("fT", [0.1, 0.3, 0.75, 1.2, 2.3])
def test_residual_of_an_undamped_half_sine_is_the_known_formula(fT):
    # 4 fT cos(pi fT) / (1 - 4 (fT)^2): the Fourier amplitude of the pulse times the angular frequency
    samples = 2000
    values = np.sin(np.pi * np.arange(samples + 1) / samples)
    spectrum = srs(values, 1.0, [fT / samples], math.inf, scope=Scope("residual"))
    wanted = abs(4.0 * fT * math.cos(math.pi * fT) / (1.0 - 4.0 * fT**2))
    assert both(spectrum) == pytest.approx([wanted, wanted], rel=2e-6)


def test_low_frequencies_give_the_velocity_change_and_high_ones_the_peak():
    samples, step = 1000, 1e-6
    values = 500.0 * np.sin(np.pi * np.arange(samples + 1) / samples)
    low = srs(values, step, [1e-2], math.inf, "pseudo-velocity")
    assert low.positive[0] == pytest.approx(500.0 * 2.0 / math.pi * samples * step, rel=2e-6)
    high = np.array([30e3])
    assert srs(values, step, high).maximax[0] == pytest.approx(500.0, rel=2e-3)
    z = srs(values, step, high, kind="displacement").maximax[0]
    assert (2.0 * np.pi * high[0]) ** 2 * z == pytest.approx(500.0, rel=2e-3)


@pytest.mark.parametrize("response", [acceleration, displacement, velocity])
@pytest.mark.parametrize("q", [*QS, 0.05, 0.001])
def test_weights_of_the_filter_at_high_precision(q, response):
    zeta = 0.0 if math.isinf(q) else 0.5 / q
    ws = np.array([1e-9, 1e-6, 1e-3, 0.009, 0.3, 0.75, 3.0])
    found = recursion(ws, zeta, response(ws, zeta))
    kind = {acceleration: "absolute", displacement: "displacement", velocity: "relative-velocity"}[response]
    with mp.workdps(120):
        for i, w in enumerate(ws):
            hat = Shape([("ramp", -1, 1), ("ramp", 0, -2), ("ramp", 1, 1)], w, q, kind)
            p1, p2 = hat.p
            y0, y1, y2 = (hat(mp.mpf(k)) for k in range(3))
            cos, E2 = (mp.exp(p1) + mp.exp(p2)).real, mp.exp((p1 + p2).real)
            wanted = [E2, ((1 - mp.exp(p1)) * (1 - mp.exp(p2))).real, y0, y1 - cos * y0, y2 - cos * y1 + E2 * y0]
            size = float(max(abs(b) for b in wanted[2:]))
            for row, value, scale in zip(found, wanted, [1, float(wanted[1]), size, size, size], strict=True):
                assert abs(float(row[i] - value)) < 1e-12 * scale, (w, q)


def smallwood(w, zeta):
    """Closed form of the ramp-invariant filter, absolute acceleration, as published."""
    E, K = math.exp(-zeta * w), w * math.sqrt(1 - zeta**2)
    C, S = E * math.cos(K), E * math.sin(K) / K
    return 2 * C, E**2, 1 - S, 2 * (S - C), E**2 - S


@pytest.mark.parametrize("w", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("q", [0.6, 10.0, 100.0])
def test_filter_is_smallwoods(w, q):
    decay, stiffness, *weights = (
        row[0] for row in recursion(np.array([w]), 0.5 / q, acceleration(np.array([w]), 0.5 / q))
    )
    a1, a2, *published = smallwood(w, 0.5 / q)
    assert [1 + decay - stiffness, decay] == pytest.approx([a1, a2], rel=1e-13)
    assert weights == pytest.approx(published, rel=1e-11, abs=1e-14)


def stepped(values, fn, q, kind, fine=100):
    """Extremes while a record lasts, by matrix exponentials of 1/100 of a step, straight lines between samples."""
    w = 2 * math.pi * fn
    a2 = 0.0 if math.isinf(q) else w / q
    u = 1.0 / fine
    # state z, z', x, dx/dt
    move = expm(np.array([[0, 1, 0, 0], [-w * w, -a2, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0.0]]) * u)
    reading = {
        "absolute": [w * w, a2],
        "displacement": [1.0, 0.0],
        "relative-velocity": [0.0, 1.0],
        "pseudo-velocity": [w, 0.0],
        "equivalent-static": [w * w, 0.0],
    }[kind]
    z, v, last, seen = 0.0, 0.0, 0.0, [0.0]
    for value in values:
        x = np.array([z, v, last, value - last])
        for _ in range(fine):
            x = move @ x
            seen.append(reading[0] * x[0] + reading[1] * x[1])
        z, v, last = x[0], x[1], value
    return max(seen), -min(seen)


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.floats(-10, 10).map(lambda v: round(v, 3)), min_size=2, max_size=12).filter(any),
    st.floats(1e-4, 0.3),
    st.sampled_from([*QS, 0.1]),
    st.sampled_from(tuple(KINDS)),
)
def test_any_polygon_matches_matrix_exponentials(values, fn, q, kind):
    spectrum = srs(values, 1.0, [fn], q, kind, Scope("primary", upsample=False))
    wanted = stepped(values, fn, q, kind)
    # the reference picks its samples: it may miss (2 pi fn / 100)^2 / 8 of a peak
    assert both(spectrum) == pytest.approx(wanted, rel=6e-5, abs=6e-5 * max(wanted))


@settings(max_examples=40, deadline=None)
@given(st.floats(1e-4, 0.45), st.sampled_from([*QS, 0.05, 0.001]), st.floats(-1, 1), st.floats(-1, 1))
def test_free_vibration_matches_matrix_exponentials(fn, q, z, v):
    w = 2 * math.pi * fn
    rates = np.array([[0.0, 1.0], [-w * w, 0.0 if math.isinf(q) else -w / q]])
    first = expm(rates) @ [z, v]
    top, bottom = (float(s[0]) for s in free_extremes(
        np.array([w]), 0.0 if math.isinf(q) else 0.5 / q, np.array([z]), np.array([first[0] - z])
    ))  # fmt: skip
    # fine enough for the fast mode first, then far enough for the slow one
    seen = [z, 0.0]
    for reach in (40.0 / (w + w / q), 1.1 * 2 * math.pi / w, 10.0 / (w * q) if q < 0.5 else 1.0):
        move, x = expm(rates * (reach / 2000)), np.array([z, v])
        for _ in range(2000):
            x = move @ x
            seen.append(x[0])
    size = abs(z) + abs(v) / w
    assert top == pytest.approx(max(seen), abs=1e-5 * size)
    assert bottom == pytest.approx(min(seen), abs=1e-5 * size)


@pytest.mark.parametrize("q", [0.02, 0.3, 0.5, 10.0, math.inf])
@pytest.mark.parametrize("w", [1e-7, 1e-2, 0.7, 2.5])
def test_bend_of_a_step_keeps_its_digits(w, q):
    found = bend(
        np.array([[w], [0.9], [3.0]]), 0.0 if math.isinf(q) else 0.5 / q, PLACES
    )  # both ways beside each other
    p1, p2 = mp_poles(mp.mpf(w), q)
    s, a, w2 = (p1 - p2) / 2, -(p1 + p2).real / 2, mp.mpf(w) ** 2
    for i, place in enumerate(PLACES):
        u = mp.mpf(place)
        first = (mp.exp(-a * u) * mp.sinh(s * (1 - u)) / mp.sinh(s)).real - (1 - u)
        second = (mp.exp(a * (1 - u)) * mp.sinh(s * u) / mp.sinh(s)).real - u
        P = (first + second) / w2
        for got, wanted in ((found[0][0, i], P), (found[1][0, i], (second - 2 * a * P) / w2)):
            assert float(got) == pytest.approx(float(wanted), rel=1e-10, abs=1e-13)


@pytest.fixture(scope="module")
def record():
    rng = np.random.default_rng(5)
    t = np.arange(3000) * 1e-5
    return np.exp(-t * 200) * (np.sin(2 * np.pi * 700 * t) + 0.3 * rng.normal(size=t.size))


FN = np.geomspace(1.0, 40e3, 41)


@functools.cache
def spectra(q, kind, part):
    rng = np.random.default_rng(5)
    t = np.arange(3000) * 1e-5
    record = np.exp(-t * 200) * (np.sin(2 * np.pi * 700 * t) + 0.3 * rng.normal(size=t.size))
    return srs(record, 1e-5, FN, q, kind, Scope(part))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("q", [0.4, 10.0, math.inf])
def test_scale_polarity_and_order(record, q, kind):
    plain = spectra(q, kind, "total")
    scaled = srs(-8.0 * record, 1e-5, FN, q, kind)
    assert np.allclose(scaled.negative, 8.0 * plain.positive, rtol=1e-12, atol=0)
    assert np.allclose(scaled.positive, 8.0 * plain.negative, rtol=1e-12, atol=0)
    mixed = np.random.default_rng(1).permutation(FN.size)
    assert np.allclose(srs(record, 1e-5, FN[mixed], q, kind).maximax, plain.maximax[mixed], rtol=1e-12, atol=0)
    one = [srs(record, 1e-5, f, q, kind).maximax[0] for f in FN[::5]]
    assert np.allclose(one, plain.maximax[::5], rtol=1e-12, atol=0)
    late = srs(np.concatenate([np.zeros(777), record]), 1e-5, FN[:30], q, kind)
    assert np.allclose(late.maximax, plain.maximax[:30], rtol=1e-9, atol=0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("q", [0.05, 0.4, 0.5, 3.0, 50.0, math.inf])
def test_finer_samples_on_the_same_lines_change_nothing(kind, q):
    rng = np.random.default_rng(7)
    fn = np.geomspace(1e-4, 0.3, 25)
    for signal in (rng.normal(size=4000), np.sin(0.3 * np.arange(4000.0)), rng.normal(size=4000) ** 9):
        coarse = np.concatenate([[0.0], signal, [0.0]])
        fine = np.interp(np.arange(4001 * 9 + 1) / 9.0, np.arange(4002.0), coarse)
        scope = Scope(upsample=False)
        one, other = srs(coarse, 1.0, fn, q, kind, scope), srs(fine, 1.0 / 9.0, fn, q, kind, scope)
        # what a parabola between places within a step leaves in the choice of the highest step; most at 20 decay times a step
        rtol = 1e-4 if q < 0.1 else 1e-5
        assert np.allclose(one.positive, other.positive, rtol=rtol, atol=0)
        assert np.allclose(one.negative, other.negative, rtol=rtol, atol=0)


@pytest.mark.parametrize("part", ["total", "primary"])
@pytest.mark.parametrize("q", [0.3, 10.0, math.inf])
def test_a_blow_has_its_spectrum_wherever_it_stands_among_the_segments_of_the_record(part, q):
    """A segment of 512 samples ends before, in and after it; the same blow ten times smaller stands in the next one."""
    blow = np.random.default_rng(9).normal(size=7)
    blow, fn = np.concatenate([blow, np.zeros(40)]), np.array([0.004, 0.03, 0.11, 0.24])
    found = [
        srs(
            np.concatenate([np.zeros(before), blow, np.zeros(900), 0.1 * blow]),
            1.0,
            fn,
            q,
            scope=Scope(part, end=before + 46.0, upsample=False),
        )
        for before in (1, 250, 500, *range(503, 514), 1020, 1022, 1024)
    ]
    for one in found[1:]:
        # a segment that exceeds the best by less than 1e-6 is not gone through
        assert one.positive == pytest.approx(found[0].positive, rel=1e-6)
        assert one.negative == pytest.approx(found[0].negative, rel=1e-6)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("q", [0.4, 10.0, math.inf])
def test_total_is_the_larger_of_primary_and_residual(q, kind):
    total, primary, residual = (spectra(q, kind, part) for part in ("total", "primary", "residual"))
    for side in ("positive", "negative", "maximax"):
        assert np.array_equal(total.side(side), np.maximum(primary.side(side), residual.side(side)))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("q", [0.3, 0.5, 10.0, math.inf])
def test_trailing_zeros_change_nothing(q, kind):
    pulse = np.sin(np.pi * np.arange(101) / 100)
    pulse[-1] = 0.0
    fn = np.geomspace(1e-7, 0.05, 30)
    alone = srs(pulse, 1.0, fn, q, kind)
    for zeros in (1, 10, 100_000):
        longer = srs(np.concatenate([pulse, np.zeros(zeros)]), 1.0, fn, q, kind)
        for side in ("positive", "negative"):
            floor = 1e-9 * alone.maximax
            assert np.all(np.abs(longer.side(side) - alone.side(side)) <= 1e-9 * alone.side(side) + floor)
    ended = srs(np.concatenate([pulse, np.ones(50)]), 1.0, fn, q, kind, Scope(end=100.0))
    assert np.array_equal(ended.positive, alone.positive)


def test_what_follows_the_record_counts_by_default():
    pulse = np.sin(np.pi * np.arange(101) / 100)
    during, always = (srs(pulse, 1.0, [1e-5], kind="pseudo-velocity", scope=s) for s in (Scope("primary"), None))
    assert always.positive[0] > 50.0 * during.positive[0]


def test_peaks_between_samples_count():
    # an undamped oscillator swings on at 20 samples a period: picking samples loses up to 1.2 %
    samples, rate = 60, 20.0
    pulse = np.sin(np.pi * np.arange(samples + 1) / samples)
    pulse[-1] = 0.0
    for shift in np.linspace(0.0, 1.0, 7):
        fn = 1.0 / (rate + shift)
        fT = fn * samples
        wanted = abs(4.0 * fT * math.cos(math.pi * fT) / (1.0 - 4.0 * fT**2))
        long = srs(np.concatenate([pulse, np.zeros(25)]), 1.0, [fn], math.inf, scope=Scope("primary"))
        assert long.negative[0] == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize("share", [4.0, 3.0, 2.3])
def test_bursts_near_half_the_rate_are_read_between_samples(share):
    def burst(t):
        return np.exp(-(((t - 200.0) / 40.0) ** 2)) * np.sin(2 * np.pi * t / share + 0.4)

    coarse, fine = burst(np.arange(401.0)), burst(np.arange(401 * 64) / 64.0)
    fn = np.array([1.0 / share])
    for kind in KINDS:
        wanted = srs(fine, 1.0 / 64, fn, 10.0, kind).maximax
        assert srs(coarse, 1.0, fn, 10.0, kind).maximax == pytest.approx(wanted, rel=2e-3)
        assert srs(coarse, 1.0, fn, 10.0, kind, Scope(upsample=False)).maximax < 0.9 * wanted


@pytest.mark.parametrize("factor", [2, 4, 8, 10])
def test_interpolated_lines_carry_the_spectrum(factor):
    t = np.arange(600.0)
    for f in (0.01, 0.04 * factor):  # up to the frequencies that the factor is taken for
        fine = interpolate(np.cos(2 * np.pi * f * t), factor)
        k = np.arange(fine.size)[200 * factor : 400 * factor + 1]
        true = np.cos(2 * np.pi * f * k / factor) / np.sinc(f / factor) ** 2  # what lines have to run through
        assert np.allclose(fine[k], true, atol=2e-4)


def test_a_record_cut_away_from_zero_does_not_ring():
    held = interpolate(np.full(50, 2.0), 8)
    assert np.allclose(held, 2.0, rtol=1e-4)


def test_denormal_responses_do_not_slow_the_loop():
    x = np.zeros(200_000)
    x[0] = 1.0
    spectrum = srs(x, 1.0, [0.04, 0.01], 2.0)
    assert np.allclose(spectrum.maximax, srs(x[:2], 1.0, [0.04, 0.01], 2.0).maximax, rtol=1e-9)


def test_rolling_windows_are_single_spectra(record):
    fn = np.array([20.0, 700.0, 9e3])
    found = rolling_srs(record, 1e-5, fn, (500e-5, 250e-5), 10.0, "pseudo-velocity")
    assert found.maximax.shape == (11, 3)
    assert found.time[:2] == pytest.approx([249.5e-5, 499.5e-5])
    for row, start in enumerate(range(0, 2501, 250)):
        alone = srs(record[start : start + 500], 1e-5, fn[:2], 10.0, "pseudo-velocity")
        assert np.allclose(found.positive[row, :2], alone.positive, rtol=1e-12)
        assert np.allclose(found.negative[row, :2], alone.negative, rtol=1e-12)


def test_octaves_meet_both_ends():
    assert octaves(10.0, 10240.0, 6).size == 61
    assert octaves(10.0, 10240.0, 6)[-1] == 10240.0
    assert octaves(10.0, 25.0, 1).tolist() == [10.0, 20.0]
    assert octaves(5.0, 5.0).tolist() == [5.0]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"values": [1.0]}, "two samples"),
        ({"values": [[1.0, 2.0]]}, "one row"),
        ({"values": [1.0, math.nan]}, "not finite"),
        ({"step": 0.0}, "step must be above zero"),
        ({"step": math.inf}, "step must be above zero"),
        ({"frequencies": [0.0]}, "above zero"),
        ({"frequencies": []}, "one row of finite"),
        ({"frequencies": [math.inf]}, "finite"),
        ({"frequencies": [0.5]}, "below half the sampling rate, 0.5 Hz, got 0.5 Hz: leave them out"),
        ({"q": 0.0}, "quality factor"),
        ({"q": math.nan}, "quality factor"),
        (
            {"kind": "velocity"},
            "absolute, displacement, relative-velocity, pseudo-velocity, equivalent-static, got 'velocity'",
        ),
        ({"scope": Scope("all")}, "total, primary, residual, got 'all'"),
        ({"scope": Scope(end=-1.0)}, "end of the shock"),
        ({"scope": Scope(end=math.nan)}, "end of the shock"),
    ],
)
def test_wrong_inputs_are_refused_in_words(change, words):
    given = {"values": [0.0, 1.0, 0.0], "step": 1.0, "frequencies": [0.01], **change}
    with pytest.raises(ValueError, match=words):
        srs(**given)


def test_wrong_sides_windows_and_grids_are_refused_in_words():
    with pytest.raises(ValueError, match="maximax, positive or negative"):
        srs([0.0, 1.0, 0.0], 1.0, [0.01]).side("both")
    for window in ((1.0, 1.0), (4.0, 1.0), (2.0, 0.0), (math.nan, 1.0)):
        with pytest.raises(ValueError, match="window must hold"):
            rolling_srs([0.0, 1.0, 0.0], 1.0, [0.01], window)
    with pytest.raises(ValueError, match="octaves need"):
        octaves(2.0, 1.0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"values": [3.0, 1.0]}, None),  # two samples
        ({"values": [3.0, math.inf, 1.0]}, "not finite"),
        ({"step": -1.0}, "step must be above zero"),
        ({"step": 5e-3, "frequencies": [1.0]}, None),
        ({"frequencies": [0.01, -0.01]}, "above zero"),
        ({"frequencies": [0.01, 0.0]}, "above zero"),
        ({"frequencies": [1e-3, 0.499]}, None),
        ({"frequencies": [[0.01, 0.02]]}, "one row"),
        ({"frequencies": [0.01, 0.6]}, "rate, 0.5 Hz, got 0.6 Hz"),
        ({"q": 1e-3}, None),
        ({"q": -1.0}, "quality factor"),
        ({"scope": Scope(end=0.0)}, "end of the shock"),
        ({"scope": Scope(end=0.4)}, "end of the shock"),  # not a step
        ({"scope": Scope(end=0.6)}, None),
        ({"scope": Scope(end=math.inf)}, "end of the shock"),
    ],
)
def test_what_is_asked_of_a_spectrum_ends_where_it_is_said(change, words):
    given = {"values": [0.0, 1.0, 0.0], "step": 1.0, "frequencies": [0.01], **change}
    if words is None:
        assert np.all(np.isfinite(srs(**given).maximax))
        return
    with pytest.raises(ValueError, match=words):
        srs(**given)


def test_a_shock_ends_at_the_sample_nearest_to_its_end():
    """What follows is taken as zero."""
    values, fn = np.random.default_rng(3).normal(size=30), [0.02, 0.2]
    for end, kept in ((5.0, 6), (5.4, 6), (5.6, 7), (100.0, 30)):
        for step in (1.0, 1e-3):
            one = srs(values, step, np.divide(fn, step), scope=Scope(end=end * step))
            assert np.array_equal(one.maximax, srs(values[:kept], step, np.divide(fn, step)).maximax)


@pytest.mark.parametrize(
    ("hop", "starts"), [(10.0, [0, 10, 20, 30]), (9.0, [0, 9, 18, 27]), (15.0, [0, 15, 30]), (31.0, [0])]
)
@pytest.mark.parametrize("fn", [0.01, 0.21])
def test_windows_slide_as_far_as_the_record_lasts(hop, starts, fn):
    """Forty samples, ten a window; each as if nothing came before or after, also where the record is interpolated."""
    values = np.convolve(np.random.default_rng(6).normal(size=44), np.ones(5) / 5.0, "valid")
    found = rolling_srs(values, 1.0, [fn], (10.0, hop), 7.0)
    assert found.time.tolist() == [start + 4.5 for start in starts]
    fine = interpolate(values, 1 if fn < 0.05 else 8)
    factor = 1 if fn < 0.05 else 8
    for row, start in enumerate(starts):
        part = fine[start * factor : (start + 9) * factor + 1]
        # with the rise to its first sample and the fall from its last one over a whole step
        ramp = np.arange(1, factor) / factor
        framed = np.concatenate([ramp * part[0], part, ramp[::-1] * part[-1], [0.0]])
        alone = srs(framed, 1.0 / factor, [fn], 7.0, scope=Scope(upsample=False))
        assert found.positive[row] == pytest.approx(alone.positive, rel=1e-9)
        assert found.negative[row] == pytest.approx(alone.negative, rel=1e-9)
        assert found.maximax[row, 0] == max(found.positive[row, 0], found.negative[row, 0])


def test_windows_may_be_as_long_as_the_record_and_as_short_as_two_samples():
    values = np.array([0.0, 1.0, 3.0, -2.0, 1.0])
    assert rolling_srs(values, 1.0, [0.01], (5.0, 1.0)).time.tolist() == [2.0]
    assert rolling_srs(values, 1.0, [0.01], (2.0, 1.0)).time.tolist() == [0.5, 1.5, 2.5, 3.5]
    for window in ((1.4, 1.0), (5.6, 1.0), (2.0, 0.4), (0.0, 1.0), (2.0, -1.0), (math.inf, 1.0)):
        with pytest.raises(ValueError, match="window must hold"):
            rolling_srs(values, 1.0, [0.01], window)


@pytest.mark.parametrize(
    ("arguments", "grid"),
    [
        ((3.0, 24.0, 1.0), [3.0, 6.0, 12.0, 24.0]),
        ((3.0, 23.9, 1.0), [3.0, 6.0, 12.0]),
        ((3.0, 24.0 * (1.0 + 5e-10), 1.0), [3.0, 6.0, 12.0, 24.0]),
        ((3.0, 24.0 * (1.0 + 1.5e-9), 1.0), [3.0, 6.0, 12.0, 24.0]),
        ((1.0, 2.0, 2.0), [1.0, math.sqrt(2.0), 2.0]),
        ((1.0, 64.0, 0.5), [1.0, 4.0, 16.0, 64.0]),
    ],
)
def test_frequencies_at_even_ratios_by_hand(arguments, grid):
    found = octaves(*arguments)
    assert found == pytest.approx(grid, rel=2e-9)
    # to the bit, where it is within 1e-9
    assert bool(found[-1] == arguments[1]) is math.isclose(arguments[1], grid[-1], rel_tol=1e-9)


@pytest.mark.parametrize(
    "arguments", [(0.0, 1.0), (-1.0, 1.0), (2.0, 1.9), (1.0, math.inf), (1.0, 2.0, 0.0), (1.0, 2.0, math.inf)]
)
def test_grids_that_make_no_sense_are_refused(arguments):
    with pytest.raises(ValueError, match="octaves need"):
        octaves(*arguments)
    assert octaves(1e-3, 2e-3, 1e-3).tolist() == [1e-3]


@pytest.mark.parametrize(("frequency", "least", "most"), [(0.46, 0.0, 2.5e-4), (0.47, 0.01, 0.03)])
def test_interpolation_is_flat_up_to_0_46_of_the_rate_and_no_further(frequency, least, most):
    """With 32 samples on each side; what is further is told as well: the band ends."""
    turn = 2.0 * np.pi * frequency * np.arange(600.0)
    fine = interpolate(np.cos(turn), 10) + 1j * interpolate(np.sin(turn), 10)
    k = np.arange(2000, 4001)
    true = np.exp(2j * np.pi * frequency * k / 10) / np.sinc(frequency / 10) ** 2
    assert least <= np.abs(fine[k] - true).max() < most
