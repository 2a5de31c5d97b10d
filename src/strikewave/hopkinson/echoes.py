"""A bar calibrated by its own echoes: speed, attenuation and dispersion from one gauge and many round trips.

Nothing is between the bars: a pulse runs from end to end and is turned over at each. It passes the gauge again and
again, after 2 d of way round the near end (the one whose distance d is known) and 2 (L - d) round the far one. From
the transforms S of two passes with the way x between them, at each frequency f,

    c(f) = x / tau(f),    a(f) = ln(|S1|/|S2|) / x

with tau the delay by phase and a the attenuation (Np/m), what is lost at the ends included.

Source: the spectral ratio of successive echoes as in C. Bacon, An experimental method for considering dispersion and
attenuation in a viscoelastic Hopkinson bar, Experimental Mechanics 38 (1998) 242-249 (reference from memory).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len, rfft, rfftfreq
from scipy.signal import correlate

from strikewave.errors import InputError
from strikewave.hopkinson.bars import Bar
from strikewave.hopkinson.onset import noise_ceiling
from strikewave.hopkinson.pulses import Quiet, Trace, quieten
from strikewave.signal.pulse import crossing
from strikewave.waves.dispersion import Theory, wave_number

Array = NDArray[np.float64]

Way = Literal["towards", "away"]
ABOVE_NOISE = 10.0
"""Amplitude of a pass over that of the noise, down to which a frequency is used."""
WEAKEST = 0.03
"""Amplitude of a frequency over that of the strongest one of a pass, down to which it is used: below, the tails that
windows cut count."""
LEAD = 0.1
"""Share of the window of a pass that lies before its onset."""
FEWEST_PASSES = 3


class Estimate(NamedTuple):
    """A mean, its standard error (NaN for a single value), and how many values it stands on."""

    value: float
    error: float
    values: int


@dataclass(frozen=True)
class Echoes:
    """What the echoes of a bar say of it.

    Attributes
    ----------
    quiet : Quiet
        The trace.
    times : ndarray
        Of the passes, s: when the first one comes to the gauge, and later ones by the delay of best correlation.
    window : float
        Length of the stretch of each pass, s.
    first : int
        Number of the first pass used.
    speed : Estimate
        Bar speed c0, m/s, from each pair of passes with a known way between them.
    length : Estimate
        Length of the bar, m: given (no error), or from round trips and the speed.
    attenuation : Estimate
        Over a round trip at the pulse's own frequencies, Np/m, each weighted with its energy.
    frequency : ndarray
        Of the band in which every pass stands out of the noise, Hz, shape (K,).
    phase_speed, phase_speed_error : ndarray
        c(f) of the pairs, m/s, and its standard error, shape (K,).
    theory_speed : ndarray
        The phase speed of the theory with the speed found, m/s, shape (K,).
    losses, losses_error : ndarray
        a(f) of the round trips, Np/m, shape (K,).
    theory : str
        Of dispersion, by which c0 was taken from c(f).
    """

    quiet: Quiet = field(repr=False)
    times: Array
    window: float
    first: int
    speed: Estimate
    length: Estimate
    attenuation: Estimate
    frequency: Array = field(repr=False)
    phase_speed: Array = field(repr=False)
    phase_speed_error: Array = field(repr=False)
    theory_speed: Array = field(repr=False)
    losses: Array = field(repr=False)
    losses_error: Array = field(repr=False)
    theory: Theory


class _Passes(NamedTuple):
    """Places (samples) of the passes, the length of their windows, and their transforms."""

    places: NDArray[np.int64]
    size: int
    frequency: Array
    spectra: NDArray[np.complex128]
    first: int


def calibrate_bar(
    trace: Trace, bar: Bar, way: Way = "towards", skip: int = 0, theory: Theory = "pochhammer-chree"
) -> Echoes:
    """Return what many round trips say of a bar whose ends are free.

    Parameters
    ----------
    trace : Trace
        Strain at the gauge.
    bar : Bar
        Its gauge distance to one end is taken as known, its length where it is finite, density and modulus only
        as the begin of the search for the speed.
    way : str, optional
        Whether the first pulse runs "towards" the end whose distance is known, or "away" from it.
    skip : int, optional
        Passes left out at the begin, such as one that met a specimen.
    theory : str, optional
        Of dispersion.

    Raises
    ------
    InputError
        If the trace cannot be used, holds fewer than three passes, or no frequency stands out of the noise.
    """
    quiet = quieten(trace, "echo trace")
    if way not in ("towards", "away"):
        raise InputError("echoes.way", way, '"towards" or "away"')
    near, around = _delays(quiet, bar, way)
    passes = _passes(quiet, near, around, skip)
    usable = _band(passes, quiet)
    if usable.size < 2:
        raise InputError("echo trace", "echoes in the noise", f"passes {ABOVE_NOISE:g} times above their noise")
    step, known = quiet.trace.step, _known_pairs(passes, bar, way)
    if not known:
        hint = "give the length of the bar, or skip fewer passes"
        raise InputError("echo trace", "no two passes with a known way between", "at least one such pair", hint)
    delay = np.array([_delay(passes, n, m, usable, step) for n, m, _ in known])
    distance = np.array([x for *_, x in known])
    weight = np.abs(passes.spectra[0][usable]) ** 2
    w = 2.0 * np.pi * passes.frequency[usable]
    each = np.array([_bar_speed(d, x, (w, weight), bar, theory) for d, x in zip(delay, distance, strict=True)])
    speed = _estimate(each)
    trips = [(n, n + 2) for n in range(passes.places.size - 2)]
    length = _length(passes, trips, usable, speed.value, (bar, step, theory))
    lost = np.array([_loss(passes, n, m, usable) for n, m in trips]) / (2.0 * length.value)
    phase = distance[:, None] / delay
    rod = bar.rod._replace(bar_speed=speed.value)
    return Echoes(
        quiet=quiet,
        times=np.asarray(quiet.trace.start + step * passes.places),
        window=passes.size * step,
        first=skip,
        speed=speed,
        length=length,
        attenuation=_estimate(lost @ weight / weight.sum()),
        frequency=passes.frequency[usable],
        phase_speed=phase.mean(axis=0),
        phase_speed_error=_error(phase),
        theory_speed=np.asarray(w / wave_number(w, rod, theory).real),
        losses=lost.mean(axis=0),
        losses_error=_error(lost),
        theory=theory,
    )


def _delays(quiet: Quiet, bar: Bar, way: Way) -> tuple[float, float]:
    """Return the delay of the second pass, and of a round trip, in samples, by correlation with the first pass.

    The round trip is the largest correlation of the same sign once the first pulse is over; the second pass, turned
    over at one end, the deepest before it.
    """
    x, begin = quiet.trace.strain, quiet.onset
    half = np.abs(x[begin:]) > 0.5 * float(np.abs(x).max())
    inside = begin + int(np.argmax(half))
    width = crossing(x, inside, 0.5 * float(x[inside]), 1) - begin
    if not math.isfinite(width) or begin + 4 * width > x.size:
        raise InputError("echo trace", "one pulse alone", "a record of several round trips")
    template = x[begin : begin + int(2.0 * width)]
    same = correlate(x[begin:], template, "valid")
    clear = int(2.0 * width)
    around = clear + int(np.argmax(same[clear:]))
    if math.isfinite(bar.length):
        around = _near_peak(same, 2.0 * bar.length / bar.speed / quiet.trace.step, 1.0)
    if around <= clear + 1:
        raise InputError("echo trace", "no echo of the sign of the first pulse", "a record of several round trips")
    near = clear + int(np.argmin(same[clear:around]))
    expected = 2.0 * bar.delay / quiet.trace.step
    return float(_near_peak(same, expected if way == "towards" else around - expected, -1.0, near)), float(around)


def _near_peak(same: Array, expected: float, sign: float, fallback: int = 0) -> int:
    """Return the place of the strongest correlation within a tenth of where it is expected."""
    low, high = int(0.9 * expected), int(1.1 * expected) + 1
    if low < 1 or high > same.size:
        return fallback
    return low + int(np.argmax(sign * same[low:high]))


def _passes(quiet: Quiet, near: float, around: float, skip: int) -> _Passes:
    """Cut the passes out as long as they stand out of the noise, turn every second one over, and transform them."""
    size = int(min(near, around - near))
    x, lead = quiet.trace.strain, int(LEAD * min(near, around - near))
    count = int(2 * ((x.size - quiet.onset) // around)) + 2
    offsets = [(n // 2) * around + (n % 2) * near for n in range(count)]
    places = np.array([quiet.onset + round(o) for o in offsets], dtype=np.int64)
    places = places[places - lead + size <= x.size]
    ceiling = noise_ceiling(quiet.noise, x.size)
    drowned = [float(np.abs(x[max(p - lead, 0) : p - lead + size]).max()) <= ceiling for p in places]
    places = places[: drowned.index(True)] if any(drowned) else places
    numbers = np.arange(places.size)[skip:]
    places = places[skip:]
    if places.size < FEWEST_PASSES or places[0] < lead:
        hint = "record longer, or skip fewer passes"
        raise InputError("echo trace", f"{places.size} passes", f"at least {FEWEST_PASSES} whole passes", hint)
    total = next_fast_len(4 * size, real=True)
    taper = _taper(size, lead)
    parts = [(-1.0) ** n * taper * x[p - lead : p - lead + size] for n, p in zip(numbers, places, strict=True)]
    spectra = np.array([rfft(part, total) for part in parts])
    return _Passes(places, size, rfftfreq(total, quiet.trace.step), spectra, skip)


def _taper(size: int, lead: int) -> Array:
    """Return a window with cosine flanks over the lead on both sides."""
    flank = 0.5 * (1.0 - np.cos(np.pi * (np.arange(lead) + 0.5) / max(lead, 1)))
    return np.concatenate([flank, np.ones(size - 2 * lead), flank[::-1]])


def _band(passes: _Passes, quiet: Quiet) -> NDArray[np.intp]:
    """Return the frequencies, from the first a window can hold on, up to the first at which a pass is too weak."""
    amplitude = np.abs(passes.spectra)
    floor = ABOVE_NOISE * quiet.noise * math.sqrt(passes.size)
    clear = np.all(amplitude > np.maximum(floor, WEAKEST * amplitude.max(axis=1, keepdims=True)), axis=0)
    low = int(np.searchsorted(passes.frequency, 1.0 / (passes.size * quiet.trace.step)))
    sunk = np.flatnonzero(~clear[low:])
    return np.arange(low, low + (int(sunk[0]) if sunk.size else clear.size - low))


def _known_pairs(passes: _Passes, bar: Bar, way: Way) -> list[tuple[int, int, float]]:
    """Return pairs of passes with the way between them: round the near end, and round trips of a known length."""
    count = passes.places.size
    turn = 0 if way == "towards" else 1
    pairs = [(n, n + 1, 2.0 * bar.gauge_distance) for n in range(count - 1) if (n + passes.first) % 2 == turn]
    if math.isfinite(bar.length):
        pairs += [(n, n + 2, 2.0 * bar.length) for n in range(count - 2)]
    return pairs


def _delay(passes: _Passes, n: int, m: int, band: NDArray[np.intp], step: float) -> Array:
    """Return the delay from one pass to another at each frequency, by phase, s."""
    turn = np.unwrap(np.angle(passes.spectra[n][band] * np.conj(passes.spectra[m][band])))
    w = 2.0 * np.pi * passes.frequency[band]
    turn -= 2.0 * np.pi * round(float(turn[0]) / (2.0 * np.pi))
    return np.asarray(step * (passes.places[m] - passes.places[n]) + turn / w)


def _loss(passes: _Passes, n: int, m: int, band: NDArray[np.intp]) -> Array:
    """Return the logarithm of the ratio of the amplitudes of two passes."""
    return np.asarray(np.log(np.abs(passes.spectra[n][band]) / np.abs(passes.spectra[m][band])))


def _bar_speed(delay: Array, distance: float, at: tuple[Array, Array], bar: Bar, theory: Theory) -> float:
    """Return the c0 whose theory gives the delays best: least squares with the energy as weight, by iteration."""
    w, weight = at
    c0 = bar.speed
    for _ in range(20):
        rod = bar.rod._replace(bar_speed=c0)
        told = distance * wave_number(w, rod, theory).real / w
        ratio = float((weight * told) @ delay / ((weight * told) @ told))
        c0 /= ratio
        if abs(ratio - 1.0) < 1e-12:
            break
    return c0


def _length(
    passes: _Passes,
    trips: list[tuple[int, int]],
    band: NDArray[np.intp],
    speed: float,
    setting: tuple[Bar, float, Theory],
) -> Estimate:
    """Return the length of the bar: as given, or half of what a wave of the speed found passes in a round trip."""
    bar, step, theory = setting
    if math.isfinite(bar.length):
        return Estimate(bar.length, math.nan, 0)
    w = 2.0 * np.pi * passes.frequency[band]
    weight = np.abs(passes.spectra[0][band]) ** 2
    k = wave_number(w, bar.rod._replace(bar_speed=speed), theory).real / w
    each = [float(np.average(_delay(passes, n, m, band, step) / k, weights=weight)) / 2.0 for n, m in trips]
    return _estimate(np.array(each))


def _estimate(values: Array) -> Estimate:
    error = float(values.std(ddof=1)) / math.sqrt(values.size) if values.size > 1 else math.nan
    return Estimate(float(values.mean()), error, int(values.size))


def _error(rows: Array) -> Array:
    """Return the standard error over rows; NaN for a single one."""
    if rows.shape[0] < 2:
        return np.full(rows.shape[1], np.nan)
    return np.asarray(rows.std(axis=0, ddof=1) / math.sqrt(rows.shape[0]))
