"""Records whose truth is known: numpy and a file format, nothing of the package that reads them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

SHAPES = ("half-sine", "haversine", "saw-tooth", "triangle")
TIP = 0.85
"""Share of a saw-tooth in which it rises."""
A = np.arcsin
WIDTH = {
    "half-sine": 1 - 2 * A(0.1) / np.pi,
    "haversine": 1 - 2 * A(0.1**0.5) / np.pi,
    "saw-tooth": 0.9,
    "triangle": 0.9,
}
RISE = {
    "half-sine": (A(0.9) - A(0.1)) / np.pi,
    "haversine": (A(0.9**0.5) - A(0.1**0.5)) / np.pi,
    "saw-tooth": 0.8 * TIP,
    "triangle": 0.4,
}
AREA = {"half-sine": 2 / np.pi, "haversine": 0.5, "saw-tooth": 0.5, "triangle": 0.5}
PEAK_AT = {"half-sine": 0.5, "haversine": 0.5, "saw-tooth": TIP, "triangle": 0.5}


def shape(kind, u):
    """Return a pulse of unit height over 0 < u < 1."""
    inside = (u > 0) & (u < 1)
    u = np.clip(u, 0, 1)
    form = {
        "half-sine": np.sin(np.pi * u),
        "haversine": np.sin(np.pi * u) ** 2,
        "saw-tooth": np.minimum(u / TIP, (1 - u) / (1 - TIP)),
        "triangle": 1 - np.abs(2 * u - 1),
    }
    return np.where(inside, form[kind], 0.0)


@dataclass(frozen=True)
class Blow:
    """What was planted: begin and duration, s, and height."""

    begin: float
    duration: float
    height: float


@dataclass(frozen=True)
class Planted:
    """A record in g, and what is in it."""

    time: np.ndarray
    values: np.ndarray
    kind: str
    blows: tuple
    signal_to_noise: float
    ringing: float
    ringing_frequency: float
    clipped: bool

    def figures(self, blow):
        """Return time of the peak, peak, rise, width and area of a blow, without its ringing."""
        T, H, kind = blow.duration, blow.height, self.kind
        return {
            "time": blow.begin + PEAK_AT[kind] * T,
            "peak": H,
            "rise": RISE[kind] * T,
            "width": WIDTH[kind] * T,
            "velocity_change": AREA[kind] * H * T,
        }


def plant(rng):
    """Return a record of 1 to 15 blows of 80 to 400 us: 5 to 60 dB above the noise, offset, drift, ringing, clipping.

    Noise is white; its decibels are 20 log10 of the mean height over its standard deviation.
    """
    rate = rng.choice([100e3, 200e3, 500e3, 1e6])
    count, kind = int(rng.integers(1, 16)), str(rng.choice(SHAPES))
    duration, gap, height = rng.uniform(80e-6, 400e-6), rng.uniform(5e-3, 25e-3), 10 ** rng.uniform(2.3, 4.3)
    decibels = rng.uniform(5, 60)
    ringing = rng.uniform(0.03, 0.3) if rng.random() < 0.5 else 0.0
    frequency, decay = rng.uniform(3e3, min(30e3, rate / 8)), rng.uniform(0.2e-3, 2e-3)
    lead = rng.uniform(2e-3, 10e-3)
    time = np.arange(int((lead + count * gap + rng.uniform(0, 10e-3)) * rate)) / rate
    values, blows = np.zeros(time.size), []
    for k in range(count):
        blow = Blow(
            lead + k * gap + 2e-4 * rng.normal(),
            duration * (1 + 0.03 * rng.normal()),
            height * (1 + 0.08 * rng.normal()),
        )
        values += blow.height * shape(kind, (time - blow.begin) / blow.duration)
        since = np.maximum(time - blow.begin - 0.5 * blow.duration, 0.0)
        values += ringing * blow.height * np.exp(-since / decay) * np.sin(2 * np.pi * frequency * since)
        blows.append(blow)
    offset, drift = height * rng.uniform(-0.1, 0.1), height * rng.uniform(-0.02, 0.02)
    values += offset + drift * time / time[-1] + height * 10 ** (-decibels / 20) * rng.normal(size=time.size)
    clipped = bool(rng.random() < 0.1)
    if clipped:
        values = np.minimum(values, offset + height * rng.uniform(0.7, 0.9))
    return Planted(time, values, kind, tuple(blows), decibels, ringing, frequency if ringing else np.nan, clipped)


def write(planted, path: Path):
    """Write a record as text: time in ms, acceleration in g, nine digits."""
    import pyarrow as pa
    import pyarrow.csv

    columns = {"time [ms]": planted.time * 1e3, "board [g]": planted.values}
    pa.csv.write_csv(pa.table(columns), path)
