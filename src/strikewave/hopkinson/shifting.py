"""A pulse carried along a bar, from the gauge to the face at the specimen.

Each frequency runs at its own speed: over a distance x the component exp(i w t) is turned by exp(-i k(w) x). What is
left after the plain delay x/c0 is taken off is the change of shape. A bar that loses energy has a complex k; carried
back, the wave grows by what it lost.

Only the strain on the gauge's own place in the section is carried: the first mode has no uniform section at high
frequencies (its strain at the surface is not the mean one), and no correction for that is made here.

Source: P. S. Follansbee, C. Frantz, Wave Propagation in the Split Hopkinson Pressure Bar, Journal of Engineering
Materials and Technology 105 (1983) 61-66.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from strikewave.waves.dispersion import Rod, Theory, wave_number

Array = NDArray[np.float64]

SLOWEST = 0.5
"""Slowest phase speed of a component over the bar speed, 0.576 of it for the first mode in steel: padding leaves room
for its delay."""
ABOVE_NOISE = 4.0
"""Amplitude over that of noise alone which counts as signal: noise reaches it once in ten million frequencies."""
MOST_NODES = 2000
"""Frequencies at which the wave number is solved for; between them a cubic interpolates. Phases then differ by far less
than noise, and a record of a million samples takes no longer."""


class Carrier(NamedTuple):
    """How pulses are carried: the bar, the theory of dispersion, the highest frequency that it turns (Hz).

    Above that frequency a record holds noise, and waves of higher modes that no theory of the first one carries:
    they keep the turn of that frequency, which does not move them in time.
    """

    rod: Rod
    theory: Theory = "pochhammer-chree"
    highest: float = math.inf


def carried(pulse: Array, step: float, distance: float, carrier: Carrier, advance: float = 0.0) -> Array:
    """Return a pulse after a distance along a bar, with the delay distance/c0 taken off.

    Parameters
    ----------
    pulse : array
        Samples, shape (N,), about zero at its begin. Its end is led to zero by half a cosine in the padding.
    step : float
        s.
    distance : float
        m; below zero it is carried back to where it came from.
    carrier : Carrier
        Bar, theory and highest frequency.
    advance : float, optional
        Time by which the result is moved forward beside, s; need not be whole steps.

    Returns
    -------
    ndarray
        Shape (N,), on the clock of the pulse plus distance/c0.

    Examples
    --------
    >>> t = 1e-7 * np.arange(4000)
    >>> pulse = np.exp(-(((t - 1e-4) / 8e-6) ** 2))
    >>> steel = Carrier(Rod(0.01, 5000.0, 0.29))
    >>> there = carried(pulse, 1e-7, 0.5, steel)
    >>> back = carried(there, 1e-7, -0.5, steel)
    >>> float(there.max().round(3)), bool(abs(back - pulse).max() < 1e-6)
    (0.99, True)
    """
    size, rod = pulse.size, carrier.rod
    slack = int(abs(distance) / rod.bar_speed * (1.0 / SLOWEST - 1.0) / step)
    total = scipy.fft.next_fast_len(2 * size + 2 * slack, real=True)
    padded = np.zeros(total)
    padded[:size] = pulse
    padded[size : 2 * size] = pulse[-1] * 0.5 * (1.0 + np.cos(np.pi * np.arange(1, size + 1) / size))
    w = 2.0 * np.pi * scipy.fft.rfftfreq(total, step)
    turned = np.minimum(w, 2.0 * np.pi * carrier.highest)
    turn = (_wave_numbers(turned, rod, carrier.theory) - turned / rod.bar_speed) * distance - w * advance
    return np.asarray(scipy.fft.irfft(scipy.fft.rfft(padded) * np.exp(-1j * turn), total)[:size])


def highest_frequency(pulse: Array, step: float, noise: float, width: float) -> float:
    """Return the frequency from which on a pulse does not stand out of white noise any more, Hz.

    Its spectrum is taken by the largest value within 2/width, since that of a plateau has zeros each 1/width.

    Parameters
    ----------
    pulse : array
        Samples, shape (N,).
    step, noise, width : float
        Sampling step (s), standard deviation of the noise, duration of the pulse (s).
    """
    amplitude = np.abs(scipy.fft.rfft(pulse))
    wide = max(round(2.0 / width * pulse.size * step), 1)
    envelope = scipy.ndimage.maximum_filter1d(amplitude, 2 * wide + 1)
    sunk = np.flatnonzero(envelope <= ABOVE_NOISE * noise * math.sqrt(pulse.size))
    place = int(sunk[0]) if sunk.size else amplitude.size - 1
    return float(scipy.fft.rfftfreq(pulse.size, step)[place])


def _wave_numbers(w: Array, rod: Rod, theory: Theory) -> NDArray[np.complex128]:
    """Return k at ascending frequencies, solved at nodes and interpolated by a cubic between them."""
    if theory == "none" or w.size <= MOST_NODES:
        return _running(w, rod, theory)
    from scipy.interpolate import CubicSpline

    nodes = np.linspace(0.0, float(w.max()), MOST_NODES)
    return np.asarray(CubicSpline(nodes, _running(nodes, rod, theory))(w))


def _running(w: Array, rod: Rod, theory: Theory) -> NDArray[np.complex128]:
    """Return k; where the Love-Rayleigh theory lets nothing run, that of the plain bar."""
    k = np.asarray(wave_number(w, rod, theory))
    if theory == "love-rayleigh":
        k = np.where(np.abs(k.imag) > 0.0, w / rod.bar_speed, k)
        limit = w / (rod.bar_speed * SLOWEST)
        return np.where(k.real > limit, limit, k)
    return k
