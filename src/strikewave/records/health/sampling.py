"""Whether a record was sampled fast enough."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from strikewave.base.percents import percent
from strikewave.records.health.examined import Examined
from strikewave.records.health_notice import FIGURES, HARMED, HealthNotice
from strikewave.signal.pulse import HALF_SINE_WIDTH

Array = NDArray[np.float64]

FEW, TOO_FEW, NONE_LEFT = 20.0, 10.0, 5.0
"""Samples of a half-sine at which 0.3, 1.2 and 4.9 % of its peak may be missed, 1 - cos(pi / (2 n))."""
AROUND, FEWEST_AROUND = 4.0, 64
"""Widths around the largest blow whose spectrum is looked at, in 64 samples to either side at least."""
TOP_OF_SPECTRUM = 0.85
"""Share of half the sampling rate from which on a spectrum should have fallen off: where anti-alias filters pass
least."""
FOLDED, NOISES_OF_SPECTRUM = 0.02, 4.0
"""Share of the largest value that is too much there, and how many times that of the noise it must be.

2 % that is folded down may shift a peak by as much."""
OF_AREA = 2.0
"""Times the level at half the sampling rate that folding may do to the area: the largest value of the spectrum is about
the area of the blow, what is folded lies anywhere down to frequency zero, and twice its root mean square covers it."""


def few_samples(record: Examined) -> list[HealthNotice]:
    """Find blows of few samples: a half-sine that lasts n of them may lose 1 - cos(pi / (2 n)) of its peak."""
    widths = [p.width for p in record.pulses if p.width > 0.0]
    if not widths:
        return []
    count = min(widths) / HALF_SINE_WIDTH / record.step
    if count >= FEW:
        return []
    loss = 1.0 - math.cos(math.pi / (2.0 * max(count, 1.0)))
    severity = "bad" if count < NONE_LEFT else "suspect" if count < TOO_FEW else "good"
    message = f"a blow has {count:.1f} samples: its peak may be missed by {percent(loss)}; sample faster"
    return [
        HealthNotice(
            "few-samples", message, count, severity=severity, harms=("peak", "rise", "width") if count < TOO_FEW else ()
        )
    ]


def aliased(record: Examined) -> list[HealthNotice]:
    """Find a spectrum that has not fallen off at half the sampling rate: what lies above is folded into it."""
    pulse = record.largest
    if pulse is None or not pulse.width > 0.0:
        return []
    reach = max(round(AROUND * pulse.width / record.step), FEWEST_AROUND)
    centre = record.place(pulse.time)
    part = record.values[max(centre - reach, 0) : centre + reach] - pulse.offset
    level = folded_level(part, pulse.noise)
    if level is None:
        return []
    message = (
        f"at half the sampling rate the spectrum still has {percent(level)} of its largest value: what lies above was "
        "folded into the record, anywhere, also into the blow; sample faster or filter before"
    )
    area = ("width", "velocity_change") if OF_AREA * level > HARMED else ()
    harms = tuple(name for name in FIGURES if name in ("peak", "rise", "spectrum", *area))
    return [HealthNotice("alias", message, level, severity="suspect", harms=harms)]


def folded_level(part: Array, noise: float) -> float | None:
    """Return what stands at half the sampling rate, over the largest value of a spectrum; None where it has fallen off.

    Examples
    --------
    >>> t = np.arange(400.0)
    >>> folded_level(np.exp(-t / 50.0) * np.sin(0.3 * t), 0.0) is None
    True
    >>> folded_level(np.exp(-t / 50.0) * np.sin(3.0 * t), 0.0) > 0.1
    True
    """
    spectrum = np.abs(np.fft.rfft(part * np.hanning(part.size)))
    top = spectrum[int(TOP_OF_SPECTRUM * spectrum.size) :]
    highest = float(np.max(spectrum))
    if not highest > 0.0:
        return None
    level = math.sqrt(float(np.mean(top**2))) / highest
    heard = noise * math.sqrt(0.375 * part.size) / highest  # a Hann window has the mean square 3/8
    return None if level < FOLDED or level < NOISES_OF_SPECTRUM * heard else level
