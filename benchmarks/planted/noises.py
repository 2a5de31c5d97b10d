"""Noise of several colours, standard deviation 1."""

import numpy as np
from scipy.signal import lfilter

COLOURS = ("white", "pink", "brown", "autoregressive")


def noise(rng, size, colour):
    """Return noise without mean."""
    white = rng.normal(size=size)
    if colour == "white":
        return white
    if colour == "autoregressive":
        # a pole between slightly and strongly correlated neighbours; the first samples forget how it began
        pole = rng.uniform(0.5, 0.98)
        values = lfilter([1.0], [1.0, -pole], rng.normal(size=size + 400))[400:]
    else:
        frequencies = np.fft.rfftfreq(size)
        frequencies[0] = np.inf
        values = np.fft.irfft(np.fft.rfft(white) * frequencies ** {"pink": -0.5, "brown": -1.0}[colour], size)
    values = values - np.mean(values)
    return values / np.std(values)
