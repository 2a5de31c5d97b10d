"""The pulse without its ringing by a low-pass between the two bands, with what that costs.

Independent of the joint fit (`strikewave.records.ringing`): no mode is modelled. The cutoff lies where two costs
together are least, both over the peak:

loss
    what the filter takes off a pulse. It is corrected by sending a family of ideal pulses through the same filter, each
    as long as makes it come out as wide as the record does; how far the family disagrees is what is not known of it;
leak
    what the filter leaves of the wave part, which is as large in the blow as its decay after it says.

A third cost no filter can take off: in the pulse's own band an elastic body moves by -s a'' / w^2 more than a rigid
one, with the frequency w of its lowest mode. For a half-sine of duration T this is s / (2 f T)^2 of the peak.
"""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np

from strikewave.base import declare
from strikewave.base.shock_quantities import FREQUENCY, MICROSECONDS, OF_CHANNEL, RATIO
from strikewave.base.texts import percent
from strikewave.records.record import Array
from strikewave.records.ringing import RINGS_WITHIN, Stretch, spectrum_after, swings_after
from strikewave.records.smooth_pulse import SmoothPulse
from strikewave.records.thresholds import OfRingingSought
from strikewave.signal.filters import Filter
from strikewave.signal.pulse import HALF_SINE_WIDTH, crossing, measure_pulse

# Ideal pulses of one length, flat to peaked, leaning or not, as contacts, pads and machines make them; no saw-tooths
FAMILY = tuple(SmoothPulse(1.0, 0.0, 1.0, rise, power) for power in (0.7, 1.0, 1.5, 2.0, 3.0) for rise in (0.25, 0.5))
# Cutoff times length: a fifth of the peak is left at the shortest, 0.01 % taken at the longest; 40 are right to 0.1 %
LENGTHS = np.exp(np.linspace(math.log(0.15), math.log(30.0), 40))
# Samples of a tabulated pulse and of 1 / cutoff; 1 / cutoffs on either side
SAMPLES, SAMPLES_OF_CUTOFF, REACH = 200, 20, 4.0
# Times the narrowest width that a filter lets out by which the filtered pulse must be wider: less tells no length
NARROWER = 1.03
# Cutoffs that are tried, over the frequency of the lowest mode
CUTOFFS = np.exp(np.linspace(math.log(0.15), math.log(1.0), 25))
HIGHEST = 0.45  # share of the sampling rate above which there is no cutoff
# Standard uncertainty of s: 1 on a mount, pi^2/6 at the far end of a free bar, -pi^2/3 at the struck end
ELASTIC = 1.65
# Standard uncertainties of peak and width, over themselves, by shapes that the family has not: the smallest of 0.5, 1,
# 1.5, 2, 3 and 4 % with which two standard uncertainties hold 97 of 100 of 318 planted blows that ring (seeds that no
# Test has).
OTHER_SHAPES = 0.01, 0.02
# Height at the foot of a swing that begins there, over its own: area 1 / w, times 1.3 cutoffs of a low-pass
ONSET = 0.2
# Times that the wave part may be larger in the blow than after it: its decay is that of a few swings
LARGEST_GROWTH = 3.0
# Height of a spectral peak, over the highest, that is a mode: lower, side lobes count; higher, a bar loses its first
OTHER_MODES = 0.1
NOISES = 4.0  # times the noise of a spectrum that such a peak must be: noise reaches it once in 1e7 lines (exp(-16))
UNKNOWN = 0.1  # uncertainty of the peak above which no figure is given: 20 % (95 %) is a whole tolerance of a shock


@declare.dataclass
class BandSplit:
    """A blow split by a low-pass into its rigid part and its wave part."""

    cutoff: float = declare.number(FREQUENCY, "of the zero-phase low-pass, -3 dB")
    lowest_mode: float = declare.number(FREQUENCY, "frequency of the lowest mode of the wave part")
    peak: float = declare.number(OF_CHANNEL, "of the rigid part, the loss corrected, with its sign")
    width: float = declare.number(MICROSECONDS, "of the rigid part at 10 % of its peak")
    peak_uncertainty: float = declare.number(OF_CHANNEL, "standard uncertainty of that peak")
    width_uncertainty: float = declare.number(MICROSECONDS, "standard uncertainty of that width")
    loss: float = declare.number(
        RATIO, "what the filter takes off the peak of a pulse as wide, over it: the mean of the family"
    )
    loss_uncertainty: float = declare.number(
        RATIO, "what is not known of the peak by how the family disagrees, over it"
    )
    leak: float = declare.number(
        RATIO, "what is not known of the peak by what the filter leaves of the wave part, over it"
    )
    elastic: float = declare.number(
        RATIO, "what is not known of the peak by what the lowest mode does in the pulse's own band, over it"
    )
    widening: float = declare.number(RATIO, "what the filter adds to the width of a pulse, over it")
    wave_energy: float = declare.number(
        RATIO,
        "integral of the square of the wave part (what the filter takes off the record, less what it takes off the "
        "pulse) over that of the record, from the begin of the blow on",
    )

    @declare.computed(declare.word("whether the low-pass separates pulse and ringing"))
    def separable(self) -> bool:
        """Whether the bands lie so far apart that the rigid part can be separated."""
        return self.peak_uncertainty <= UNKNOWN * abs(self.peak)

    @declare.computed(declare.word("why it does not"))
    def reason(self) -> str:
        """Why it cannot be separated; empty where it can."""
        if self.separable:
            return ""
        parts = {
            "the filter changes pulses of different shape differently": self.loss_uncertainty,
            "the filter leaves too much of the wave part": self.leak,
            "the lowest mode moves in the band of the pulse": self.elastic,
        }
        most = max(parts, key=lambda name: parts[name])
        return f"the bands of pulse and wave part overlap: {most} ({percent(parts[most], 0)} of the peak)"

    def signed(self, sign: float) -> BandSplit:
        """Return the split of a blow turned round for a sign of -1."""
        return replace(self, peak=sign * self.peak)


def split_bands(stretch: Stretch, frequency: float) -> BandSplit | None:
    """Split a positive blow that rings, near a frequency in Hz; None where the low-pass leaves no pulse."""
    values, step, begin, end, width, smooth, noise = stretch
    lowest = _lowest_mode(stretch, frequency)
    swing = _swing_in_blow(stretch, lowest)
    scale = max(smooth.peak, float(np.max(values[begin : end + 1])) - swing)
    cutoff = _best_cutoff(width * step, lowest, swing / scale, step)
    if not cutoff > 0.0:
        return None
    filter_ = Filter(cutoff)
    low = filter_.apply(values, step)
    top = begin + int(np.argmax(low[begin : end + 1]))
    if not low[top] > 0.0:
        return None
    found = measure_pulse(_only(low, top), step)
    members = _family_as_wide(cutoff * found.width)
    if members is None or not found.peak > 0.0:
        return None
    left, lengths, wider = members
    peaks, widths = found.peak / left, lengths / cutoff
    peak, own_width = float(np.mean(peaks)), float(np.mean(widths))
    spread = float(np.std(peaks)) / peak
    leak = swing * float(filter_.gain(lowest, step)) / peak
    elastic = ELASTIC / (2.0 * lowest * own_width / HALF_SINE_WIDTH) ** 2
    noisy = noise * math.sqrt(2.0 * cutoff * step) / peak
    at_foot = math.hypot(leak, noisy, ONSET * swing / peak * cutoff / lowest)
    slope = float(np.mean([member.width_slope() / member.width() for member in FAMILY]))
    wave = values - low
    pulse_lost = float(np.mean(1.0 - left)) * peak * math.sqrt(0.5)  # its root mean square, as a half-sine has it
    taken = float(np.sum(wave[begin:] ** 2)) - pulse_lost**2 * own_width / step
    return BandSplit(
        cutoff,
        lowest,
        peak,
        own_width,
        peak * math.hypot(spread, leak, elastic, noisy, OTHER_SHAPES[0]),
        own_width * math.hypot(float(np.std(widths)) / own_width, at_foot * slope, elastic, OTHER_SHAPES[1]),
        float(np.mean(1.0 - left)),
        spread,
        leak,
        elastic,
        float(np.mean(wider)),
        max(taken, 0.0) / float(np.sum(values[begin:] ** 2)),
    )


def _only(values: Array, top: int) -> Array:
    """Return the excursion around a place, nothing beside it."""
    first, last = (crossing(values, top, 0.0, side) for side in (-1, 1))
    alone = values.copy()
    if math.isfinite(first):
        alone[: math.floor(first)] = 0.0
    if math.isfinite(last):
        alone[math.ceil(last) + 1 :] = 0.0
    return alone


def _lowest_mode(stretch: Stretch, frequency: float) -> float:
    """Return the lowest frequency at which the record rings after its blow, Hz."""
    if not swings_after(stretch):
        return frequency
    after = stretch.values[stretch.end : round(stretch.end + RINGS_WITHIN * stretch.width)]
    frequencies, height = spectrum_after(after, stretch.step)
    peaks = np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] >= height[2:])) + 1
    lowest = OfRingingSought.LOWEST_RATIO / (stretch.width * stretch.step)
    high = [k for k in peaks if frequencies[k] >= lowest]
    noise = NOISES * stretch.noise * math.sqrt(0.375 * after.size)  # a Hann window has the mean square 3/8
    least = max(OTHER_MODES * max((height[k] for k in high), default=0.0), noise)
    return float(min((frequencies[k] for k in high if height[k] >= least), default=frequency))


def _swing_in_blow(stretch: Stretch, frequency: float) -> float:
    """Return how large the wave part is when the pulse has its peak: as after the blow, grown back by its decay."""
    values, step, _, end, width, smooth, _ = stretch
    if not swings_after(stretch):
        return math.sqrt(2.0) * smooth.misfit * smooth.peak
    period = max(round(1.0 / (frequency * step)), 2)
    after = values[end : round(end + RINGS_WITHIN * width)]
    first = float(np.max(np.abs(after[: max(period, 4)])))
    half = after.size // 2
    sizes = [math.sqrt(float(np.mean(part**2))) for part in (after[:half], after[half:])]
    rate = math.log(sizes[0] / sizes[1]) / half if min(sizes) > 0.0 else 0.0
    back = max(end - smooth.time / step, 0.0)
    return first * min(math.exp(max(rate, 0.0) * back), LARGEST_GROWTH)


def _best_cutoff(width: float, lowest: float, swing: float, step: float) -> float:
    """Return the cutoff at which spread of the family and leak of the wave part are least together, Hz; NaN for none.

    The pulse is taken to be as wide as the record, through the filter a half-sine of this width.
    """
    best, cost = math.nan, math.inf
    for cutoff in CUTOFFS * lowest:
        if cutoff > HIGHEST / step:
            break
        members = _family_as_wide(_width_through(cutoff * width))
        if members is None:
            continue
        peaks = 1.0 / members[0]
        one = math.hypot(float(np.std(peaks) / np.mean(peaks)), swing * float(Filter(cutoff).gain(lowest, step)))
        if one < cost:
            best, cost = float(cutoff), one
    return best


def _family_as_wide(width: float) -> tuple[Array, Array, Array] | None:
    """Return what a filter leaves of the family that comes out of it as wide, over one over its cutoff.

    Shares of the peak, widths before the filter over one over its cutoff, shares added to the width; None where the
    width is that of the filter.
    """
    rows = []
    for member, (through, left) in zip(FAMILY, _tables(), strict=True):
        if width < NARROWER * through[0]:
            return None
        length = float(np.interp(width, through, LENGTHS))
        own = length * member.width()
        rows.append((float(np.interp(length, LENGTHS, left)), own, width / own - 1.0))
    left, own_widths, wider = np.array(rows).T
    return left, own_widths, wider


def _width_through(width: float) -> float:
    """Return the width of a half-sine after a filter, from that before it, both over one over its cutoff."""
    through, _ = _tables()[FAMILY.index(SmoothPulse(1.0, 0.0, 1.0, 0.5, 1.0))]
    return float(np.interp(width / HALF_SINE_WIDTH, LENGTHS, through))


@functools.cache
def _tables() -> tuple[tuple[Array, Array], ...]:
    """Return, for each of the family over `LENGTHS`, its width through a filter of cutoff 1, and the peak left."""
    filter_ = Filter(1.0)
    tables = []
    for member in FAMILY:
        rows = []
        for length in LENGTHS:
            step = min(length / SAMPLES, 1.0 / SAMPLES_OF_CUTOFF)
            count = math.ceil((length + 2.0 * REACH) / step)
            pulse = member._replace(begin=REACH, length=float(length)).at(step * np.arange(count))
            gain = filter_.gain(np.fft.rfftfreq(count, step), step)
            after = measure_pulse(np.fft.irfft(gain * np.fft.rfft(pulse), count), step)
            rows.append((after.width, after.peak))
        widths, peaks = np.array(rows).T
        tables.append((np.maximum.accumulate(widths), peaks))
    return tuple(tables)
