"""Shock response spectra: time and accuracy beside pyyeti and endaq, and the floor."""

import mpmath as mp
import numba
import numpy as np
from peers import absent
from timing import best, table

from strikewave.signal.srs import Scope, srs

RATE, SAMPLES = 1e6, 1_000_000
FREQUENCIES = np.geomspace(10.0, 10e3, 100)
PULSE = 200
"""Samples of the half-sine that accuracy is read from."""


def shock():
    """Return a decaying burst with noise."""
    t = np.arange(SAMPLES) / RATE
    noise = np.random.default_rng(1).normal(size=SAMPLES)
    return 1e3 * np.exp(-20.0 * t) * (np.sin(2.0 * np.pi * 800.0 * t) + 0.3 * noise)


@numba.njit(fastmath={"contract"})
def _products(values, rounds):
    for _ in range(rounds):
        for i in range(values.size):
            y = values[i]
            for _ in range(8):
                y = y * 0.5 + 1.0
            values[i] = y


def floor(samples, frequencies):
    """Return the time of the arithmetic alone, s: seven vector instructions a sample and frequency.

    Four multiply-adds, a sum, a maximum and a minimum, at the rate of multiply-adds that do not wait for each other.
    """
    values = np.ones(1024)
    return 7.0 * samples * frequencies * best(lambda: _products(values, 4000)) / (4000 * 1024 * 8)


def ours(values, rate, frequencies, q, kind):
    """Return our spectrum."""
    return srs(values, 1.0 / rate, frequencies, q, kind, Scope(upsample=False)).maximax


def pyyeti(values, rate, frequencies, q, kind):
    """Return pyyeti's spectrum of record and residual; no interpolation."""
    from pyyeti.srs import srs as peer

    stype = {"absolute": "absacce", "pseudo-velocity": "pvelo"}[kind]
    return peer(values, rate, frequencies, q, stype=stype, rolloff="none", time="total", parallel="no")


def endaq(values, rate, frequencies, q, kind):
    """Return endaq's spectrum of record and residual."""
    import pandas as pd
    from endaq.calc.shock import shock_spectrum

    index = pd.Index(np.arange(values.size) / rate)
    mode = {"absolute": "srs", "pseudo-velocity": "pvss"}[kind]
    frame = pd.DataFrame({"a": values}, index=index)
    return shock_spectrum(frame, freqs=frequencies, damp=0.5 / q, mode=mode, max_time=None)["a"].to_numpy()


PEERS = {"pyyeti.srs.srs, one process": pyyeti, "endaq.calc.shock.shock_spectrum": endaq}


def half_sine(fT, q):
    """Return the largest relative displacement and absolute acceleration under a half-sine of 1, at 50 digits.

    Mode by mode, z = sum of g exp(p t) over both poles, folded with sin(pi t/T), T = 1, and once more from t = T on.
    """
    with mp.workdps(50):
        w = 2 * mp.pi * mp.mpf(fT)
        p = w * (-1 / mp.mpf(2 * q) + 1j * mp.sqrt(1 - 1 / mp.mpf(2 * q) ** 2))
        factor = mp.pi / (p * p + mp.pi**2)

        def modes(t):  # z and z'' - x, from one pole; the other is its mirror
            grown = sum(mp.exp(p * (t - s)) - mp.cos(mp.pi * (t - s)) for s in (0, 1) if t > s)
            forced = sum(mp.sin(mp.pi * (t - s)) for s in (0, 1) if t > s)
            value = factor * (grown - p * forced / mp.pi) / p.imag
            return value.imag, -(p * p * value).imag

        def climb(row):
            times = mp.linspace(0, 1, 500) + mp.linspace(1, 1 + 1 / mp.mpf(fT), 500)
            k = max(range(len(times)), key=lambda i: abs(modes(times[i])[row]))
            low, high = times[max(k - 1, 0)], times[min(k + 1, len(times) - 1)]
            for _ in range(60):
                a, b = low + (high - low) / 3, high - (high - low) / 3
                low, high = (a, high) if abs(modes(a)[row]) < abs(modes(b)[row]) else (low, b)
            return abs(modes(low)[row])

        return float(climb(0)), float(climb(1))


def misses(spectrum, kind, rates):
    """Return how far a spectrum of a half-sine is from the closed form, at several samples a period."""
    values = np.sin(np.pi * np.arange(PULSE + 1) / PULSE)
    values[-1] = 0.0
    found = []
    for rate in rates:
        displacement, acceleration = half_sine(PULSE / rate, 10.0)
        wanted = acceleration if kind == "absolute" else 2.0 * np.pi / rate * displacement * PULSE**2
        got = spectrum(values, 1.0, np.array([1.0 / rate]), 10.0, kind)[0]
        found.append(f"{abs(got / wanted - 1.0):.1e}")
    return found


def times():
    """Return the rows of the table of times."""
    values, limit = shock(), floor(SAMPLES, FREQUENCIES.size)
    case = (values, RATE, FREQUENCIES, 10.0, "absolute")
    mine = best(lambda: ours(*case))
    rows = [("strikewave, one core", f"{1e3 * mine:.0f} ms", "1", f"{mine / limit:.1f} x")]
    for name, peer in PEERS.items():
        if absent(peer.__name__):
            rows.append((name, absent(peer.__name__), "", ""))
            continue
        took = best(lambda peer=peer: peer(*case), 2)
        rows.append((name, f"{1e3 * took:.0f} ms", f"{took / mine:.0f} x", f"{took / limit:.0f} x"))
    return [*rows, ("floor: the arithmetic alone", f"{1e3 * limit:.0f} ms", "", "1")]


def accuracy(rates=(20.5, 203.0, 1e4, 1e6, 1e7)):
    """Return heading and rows of the table of accuracy."""
    rows = []
    for kind in ("absolute", "pseudo-velocity"):
        rows.append((kind, "strikewave", *misses(ours, kind, (*rates, 1e8))))
        for name, peer in PEERS.items():
            found = [absent(peer.__name__)] * len(rates) if absent(peer.__name__) else misses(peer, kind, rates)
            rows.append((kind, name, *found, "not run"))
    return ("kind", "how", *(f"fs/fn = {rate:g}" for rate in rates), "1e8"), rows


def section():
    """Return the section of the page of benchmarks."""
    return f"""## Shock response spectra

{SAMPLES:,} samples, {FREQUENCIES.size} frequencies from 10 Hz to 10 kHz at 1 MHz, Q = 10, absolute acceleration, record
and residual.

{table(("how", "time", "against ours", "above the floor"), times())}

The floor counts seven vector instructions a sample and frequency at the measured rate of multiply-adds.

How far the largest response (Q = 10) to a half-sine of {PULSE} samples is from the closed form. Straight
lines between the samples lose {(np.pi / PULSE) ** 2 / 12:.0e} of the pulse's area; the rest is the method's.

{table(*accuracy())}
"""


if __name__ == "__main__":
    print(section())
