"""Whether a record was sampled fast enough for its blows, or its swings."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from strikewave.records.health.sampled_record import Array, BlowRecord, ResponseRecord
from strikewave.records.health_notice import Fault
from strikewave.records.response import FEWEST
from strikewave.records.thresholds import HARMED, OfAnswers, OfSampling
from strikewave.signal.pulse import HALF_SINE_WIDTH

FEWEST_AROUND = 64  # samples to either side of the largest blow, at least, whose spectrum is looked at


def few_samples(record: BlowRecord) -> Iterator[Fault]:
    """Find blows of few samples: a half-sine that lasts n of them may lose 1 - cos(pi / (2 n)) of its peak."""
    widths = [pulse.width for pulse in record.pulses if pulse.width > 0.0]
    count = min(widths, default=math.inf) / HALF_SINE_WIDTH / record.step
    if count < OfSampling.FEW:
        loss = 1.0 - math.cos(math.pi / (2.0 * max(count, 1.0)))
        too_few = count < OfSampling.TOO_FEW
        yield Fault(
            count,
            {"loss": loss},
            severity="bad" if count < OfSampling.NONE_LEFT else "suspect" if too_few else "good",
            harms=("peak", "rise", "width") if too_few else (),
        )


def few_samples_of_swing(record: ResponseRecord) -> Iterator[Fault]:
    """Find swings of few samples: between two of them the peak is missed."""
    modes = [
        mode
        for response in record.responses
        for mode in response.modes
        if mode.amplitude > OfSampling.COUNTS * abs(response.peak)
    ]
    count = 1.0 / (max((mode.frequency for mode in modes), default=0.0) * record.step) if modes else math.inf
    if count < OfSampling.FEW_OF_SWING:
        effects = {**record.moved_by(_missed(count) * record.peak), "peak": -_missed(count)}
        yield Fault(count, {"frequency": 1.0 / (count * record.step)}, effects=effects)


def _missed(count: float) -> float:
    """Return by how much the top of a sine of so many samples a swing may be missed."""
    beside, far = math.cos(math.pi / count), math.cos(3.0 * math.pi / count)
    if far < OfAnswers.ROUND * beside and count < OfSampling.TOO_FEW_OF_SWING:
        return 1.0 - beside
    return 1.0 - beside - 0.125 * (beside - far)


def aliased(record: BlowRecord) -> Iterator[Fault]:
    """Find a spectrum that has not fallen off at half the sampling rate: what lies above is folded into it."""
    pulse = record.largest
    if pulse is None or not pulse.width > 0.0:
        return
    reach = max(round(OfSampling.AROUND * pulse.width / record.step), FEWEST_AROUND)
    centre = record.place(pulse.time)
    part = record.values[max(centre - reach, 0) : centre + reach] - pulse.offset
    level = folded_level(part, pulse.noise)
    if level is not None:
        yield Fault(level, harms=("width", "velocity_change") if OfSampling.OF_AREA * level > HARMED else ())


def aliased_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find a spectrum of a response that has not fallen off at half the sampling rate."""
    begin, end = record.span(record.largest)
    last = min(max(record.place(record.largest.decay.end), begin + 2 * FEWEST), end)
    first = max(begin - (last - begin), 0)  # a window of its own length before it: the onset is in its middle
    level = folded_level(record.above[first:last], record.noise)
    if level is not None:
        yield Fault(level)


def folded_level(part: Array, noise: float) -> float | None:
    """Return the level at half the sampling rate over the largest of a spectrum; None where that has fallen off."""
    spectrum = np.abs(np.fft.rfft(part * np.hanning(part.size)))
    top = spectrum[int(OfSampling.TOP_OF_SPECTRUM * spectrum.size) :]
    highest = float(np.max(spectrum))
    if not highest > 0.0:
        return None
    level = math.sqrt(float(np.mean(top**2))) / highest
    heard = noise * math.sqrt(0.375 * part.size) / highest  # a Hann window has the mean square 3/8
    return None if level < OfSampling.FOLDED or level < OfSampling.NOISES * heard else level
