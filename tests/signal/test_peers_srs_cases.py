"""Inputs on which others test their shock response spectra, with what they must give from closed forms.

Inputs: pyyeti (pyyeti/tests/test_srs.py) and endaq-python (tests/calc/test_shock.py), both on GitHub. Values are
derived here: of an oscillator with H(s) = (2 z w s + w^2) / (s^2 + 2 z w s + w^2), base to absolute acceleration.
"""

import math

import numpy as np
import pytest

from strikewave.signal.srs import Scope, response_history, rms_spectrum, srs


def of_ramp(t, w, z):
    """Absolute acceleration when the base's is t from t = 0 on: t - e^(-z w t) sin(w_d t)/w_d."""
    wd = w * math.sqrt(1.0 - z * z)
    t = np.maximum(t, 0.0)
    return t - np.exp(-z * w * t) * np.sin(wd * t) / wd


def of_sine(t, w, z, f):
    """Absolute acceleration when the base's is sin(2 pi f t) from t = 0 on: the steady part and what dies away."""
    drive = 2.0 * math.pi * f
    H = (w * w + 2j * z * w * drive) / (w * w - drive**2 + 2j * z * w * drive)
    wd = w * math.sqrt(1.0 - z * z)
    a = -H.imag  # value and slope are zero at the start
    b = (z * w * a - drive * H.real) / wd
    return np.imag(H * np.exp(1j * drive * t)) + np.exp(-z * w * t) * (a * np.cos(wd * t) + b * np.sin(wd * t))


@pytest.mark.verify
@pytest.mark.parametrize("part", ["primary", "residual", "total"])
def test_block_of_pyyeti(part):
    """1 from sample 10 to 79 at 800 Hz, Q = 15, 3 to 14.6 Hz; the sides take one step each."""
    rate, q, cut = 800.0, 15.0, 80
    frequency = np.arange(3.0, 15.0, 0.4)
    record = np.zeros(cut)
    record[10:] = 1.0
    found = srs(record, 1.0 / rate, frequency, q, scope=Scope(part))
    t = np.linspace(0.0, 1.0, 400_001)  # 2.5 us: a swing of 15 Hz loses (2 pi 15 2.5e-6)^2/8 = 7e-9
    end = (cut - 1) / rate
    chosen = t <= end if part == "primary" else t > end if part == "residual" else t > -1.0
    for one, low, high in zip(frequency, found.negative, found.positive, strict=True):
        w, z = 2.0 * math.pi * one, 0.5 / q
        sides = [of_ramp(t - k / rate, w, z) for k in (9, 10, cut - 1, cut)]
        wanted = rate * (sides[0] - sides[1] - sides[2] + sides[3])[chosen]
        # residual begins one step after the end, where the base is at rest again
        assert high == pytest.approx(max(wanted.max(), 0.0), rel=1e-6 if part != "residual" else 2e-3, abs=1e-9)
        assert low == pytest.approx(max(-wanted.min(), 0.0), rel=1e-6 if part != "residual" else 2e-3, abs=1e-9)


@pytest.mark.verify
def test_two_sines_on_an_offset_of_pyyeti():
    """12 + sin(2 pi 15 t) + 3 sin(2 pi 35 t) for 5 s at 200 Hz, Q = 50, from the steady state."""
    rate, q, frequency = 200.0, 50.0, [5.0, 10.0, 35.0, 38.0]
    t = np.arange(0.0, 5.0, 1.0 / rate)
    record = np.sin(2 * np.pi * 15 * t) + 3 * np.sin(2 * np.pi * 35 * t) + 12.0
    found = srs(record, 1.0 / rate, frequency, q, scope=Scope("primary", initial="steady")).maximax
    fine = np.arange(0.0, t[-1], 1e-4)
    bends = np.diff(np.diff(record), prepend=0.0) * rate
    for one, value in zip(frequency[:2], found[:2], strict=True):  # as straight lines: a ramp from each sample on
        w = 2.0 * math.pi * one
        wanted = 12.0 + sum(bend * of_ramp(fine - k / rate, w, 0.5 / q) for k, bend in enumerate(bends))
        assert value == pytest.approx(np.max(wanted), rel=1e-5)  # of 1e-4 s between: (2 pi 35 1e-4)^2/8 = 6e-5 of 0.1
    for one, value in zip(frequency[2:], found[2:], strict=True):  # interpolated first: as the sines that were sampled
        w = 2.0 * math.pi * one
        wanted = 12.0 + of_sine(fine, w, 0.5 / q, 15.0) + 3.0 * of_sine(fine, w, 0.5 / q, 35.0)
        # 57 samples a swing of 35 Hz then lose (pi/57)^2/3 = 0.1 %; the start and the end are no sines
        assert value == pytest.approx(np.max(wanted), rel=5e-3)
    assert 152.0 < found.max() < 172.0  # as there


@pytest.mark.verify
def test_two_sines_without_their_offset_of_pyyeti():
    """The same record with its first sample, 12, taken off all: what is left begins from rest."""
    rate, q, frequency = 200.0, 50.0, [5.0, 10.0]
    t = np.arange(0.0, 5.0, 1.0 / rate)
    record = np.sin(2 * np.pi * 15 * t) + 3 * np.sin(2 * np.pi * 35 * t) + 12.0
    found = srs(record, 1.0 / rate, frequency, q, scope=Scope("primary", initial="shifted"))
    fine = np.arange(0.0, t[-1], 1e-4)
    bends = np.diff(np.diff(record), prepend=0.0) * rate  # straight lines: a ramp from each sample on
    for one, high, low in zip(frequency, found.positive, found.negative, strict=True):
        w = 2.0 * math.pi * one
        wanted = sum(bend * of_ramp(fine - k / rate, w, 0.5 / q) for k, bend in enumerate(bends))
        # of 1e-4 s between, where 35 Hz is what swings fastest: (2 pi 35 1e-4)^2/8 = 6e-5
        assert (high, low) == pytest.approx((np.max(wanted), -np.min(wanted)), rel=1e-4)


def test_sine_at_resonance_of_pyyeti():
    """3 sin(2 pi 15 t), Q = 20: 3 sqrt(Q^2 + 1) at 15 Hz, and most at 15 Hz/p, p^2 = Q^2 (sqrt(1 + 2/Q^2) - 1)."""
    q, drive, rate = 20.0, 15.0, 3000.0
    record = 3.0 * np.sin(2.0 * np.pi * drive * np.arange(30_000) / rate)
    p = q * math.sqrt(math.sqrt(1.0 + 2.0 / q**2) - 1.0)
    top = 3.0 * math.sqrt((1.0 + (p / q) ** 2) / ((1.0 - p * p) ** 2 + (p / q) ** 2))
    at, most = srs(record, 1.0 / rate, [drive, drive / p], q, scope=Scope("primary")).maximax
    # 150 periods leave e^(-pi 150/20) = 6e-11 of the beginning; 200 samples a period lose (pi/200)^2/3 = 8e-5
    assert at == pytest.approx(3.0 * math.sqrt(q * q + 1.0), rel=2e-4)
    assert most == pytest.approx(top, rel=2e-4)
    assert most > at


def test_soft_oscillator_of_pyyeti_stays_while_its_base_moves():
    """1 for 1 s, then -1 for 1 s; later the other way: velocity to 1 and -1, displacement to 1 and back to 0."""
    record = np.zeros(700)
    record[10:110], record[110:210], record[300:400], record[400:500] = 1.0, -1.0, -1.0, 1.0
    soft = [1e-5]  # Hz: w t = 4e-4 after 7 s, and 2 z w t = 2e-5 is lost to the damper
    # of straight lines the velocity is 0.5, 99 and 0.25 steps: 0.9975; the displacement stays 1
    for kind, most, least in (("displacement", 1.0, 0.0), ("relative-velocity", 0.9975, 0.9975)):
        found = srs(record, 0.01, soft, 25.0, kind, Scope("primary"))
        assert found.positive == pytest.approx([most], rel=1e-4)
        assert found.negative == pytest.approx([least], abs=1e-4)


GAINS = [
    ("displacement", lambda w, s, z: 1.0),
    ("relative-velocity", lambda w, s, z: s),
    ("absolute", lambda w, s, z: 2.0 * z * w * s + w * w),
    ("pseudo-velocity", lambda w, s, z: w),
    ("equivalent-static", lambda w, s, z: w * w),
]
"""Of each kind, the response over that of 1/(s^2 + 2 z w s + w^2)."""


@pytest.mark.parametrize(("kind", "gain"), GAINS)
@pytest.mark.parametrize(("natural", "damping"), [(12.5, 0.3), (250.0, 0.05), (1000.0, 0.01)])
def test_transfer_functions_of_endaq(kind, gain, natural, damping):
    """Steady response to a sine of 100 Hz: |G(i 2 pi 100)|, at 10 kHz; there within 10 %, here by the straight lines."""
    step, drive = 1e-4, 100.0
    record = np.sin(2.0 * np.pi * drive * step * np.arange(20_000))
    history = response_history(record, step, natural, 0.5 / damping, kind)[-5000:]  # 50 periods
    w, s = 2.0 * math.pi * natural, 2j * math.pi * drive
    wanted = abs(gain(w, s, damping) / (s * s + 2.0 * damping * w * s + w * w))
    # straight lines lose (pi/100)^2/3 = 3.3e-4; 1.5 s leave e^(-2 pi 12.5 0.3 1.5) = 5e-16 of the beginning
    assert math.sqrt(2.0 * np.mean(history**2)) == pytest.approx(wanted, rel=5e-4)


@pytest.mark.parametrize(("kind", "gain"), GAINS)
@pytest.mark.parametrize(("natural", "damping"), [(12.5, 0.3), (250.0, 0.05)])
def test_root_mean_square_of_a_steady_sine_is_that_of_its_transfer_function(kind, gain, natural, damping):
    """As the RMS spectra of pyyeti: |G(i 2 pi 100)|/sqrt(2) of a sine of 100 Hz, at 10 kHz."""
    step, drive = 1e-4, 100.0
    record = np.sin(2.0 * np.pi * drive * step * np.arange(20_000))
    w, s = 2.0 * math.pi * natural, 2j * math.pi * drive
    wanted = abs(gain(w, s, damping) / (s * s + 2.0 * damping * w * s + w * w)) / math.sqrt(2.0)
    whole, first = (rms_spectrum(record[:n], step, [natural], 0.5 / damping, kind)[0] for n in (20_000, 15_000))
    found = math.sqrt((20_000 * whole**2 - 15_000 * first**2) / 5_000)  # of the last 50 periods, which are steady
    # straight lines lose (pi/100)^2/3 = 3.3e-4; 1.5 s leave e^(-2 pi 12.5 0.3 1.5) = 5e-16 of the beginning
    assert found == pytest.approx(wanted, rel=5e-4)
