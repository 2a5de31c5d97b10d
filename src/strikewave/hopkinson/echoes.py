"""A bar calibrated by its own echoes: speed, attenuation and dispersion from one gauge and many round trips.

Nothing is between the bars: a pulse runs from end to end and is turned over at each. It passes the gauge again and
again, after 2 d of way round the near end (the one whose distance d is known) and 2 (L - d) round the far one. From
the transforms S of two passes with the way x between them, at each frequency f,

    c(f) = x / tau(f),    a(f) = ln(|S1|/|S2|) / x

with tau the delay by phase and a the attenuation (Np/m), losses at the ends included. All passes count at once: their
times are t0 + N tau_near + M tau_far after N turns at the near end and M at the far one, a straight plane by least
squares, each pass with the weight of its energy since all have the same noise. The noise of two passes is independent,
so that the residual gives the standard errors.

Source: the spectral ratio of successive echoes as in C. Bacon, An experimental method for considering dispersion and
attenuation in a viscoelastic Hopkinson bar, Experimental Mechanics 38 (1998) 242-249.
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import Literal, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import Quantity
from strikewave.base.errors import InputError
from strikewave.base.shock_quantities import BAR_SPEED, MICROSECONDS, RATIO, SHARE
from strikewave.hopkinson.bars import Bar
from strikewave.hopkinson.pulses import GaugeTrace, Quiet, noise_ceiling, quieten
from strikewave.signal.pulse import crossing
from strikewave.waves.dispersion import Theory, wave_number

Array = NDArray[np.float64]

Way = Literal["towards", "away"]
ABOVE_NOISE = 10.0
"""Least amplitude of a pass over that of the noise at a used frequency: its phase is then known to 0.1 rad."""
WEAKEST = 0.03
"""Least amplitude of a used frequency over that of the strongest one of a pass: below, the tails that windows cut
count."""
LEAD = 0.2
"""Share of the window of a pass before its foot: the foot itself, and the error of correlation, must lie inside."""
FLANK = 0.25
"""Share of the lead over which the window rises; the foot of a pulse must not lie on it."""
FEWEST_PASSES = 3
"""Least number of passes: the turns at either end and a first time are sought."""
ROUNDS, CONVERGED = 20, 1e-12
"""Rounds of the search for the bar speed whose dispersion gives the times, and the change that ends it. Dispersion is a
small correction, so that each round gains two digits or more."""
ONCE_IN = 1e-3
"""Share of records in which chance makes a good pass look odd. Chosen."""
FOOT_LEVELS = (0.25, 0.5)
"""Shares of the height on the line through the foot: clear of the noise, on the steep part."""
PULSE_WIDTHS = 2.0
"""Widths at half height after the foot without a search for echoes: the first pulse is over then."""
LARGE = 0.9
"""Share of the largest correlation that the first round trip reaches. Chosen: a trip in a metal bar loses less than a
tenth."""
NEAR_SEARCH = 0.1
"""Share of the expected delay within which the second pass is sought: the error of a stated speed or distance."""
TWICE_AS_DEEP = 0.5
"""Share of the deepest correlation that the expected one must reach to be taken for the second pass."""
STRONGER = 0.02
"""Share of amplitude by which a pass may differ from later ones without being odd: a weak reflection on the way."""

OFF = SHARE._replace(signed=True)
FITTED_LENGTH = Quantity("m", "mm", "length", digits=5)


@declare.dataclass
class FittedValue:
    """A value by least squares, in the unit of its quantity.

    Examples
    --------
    >>> round(FittedValue(1.0, 0.1, 3).student, 3)
    3.182
    """

    value: float = declare.number(declare.NOT_MEASURED, "by least squares")
    error: float = declare.number(declare.NOT_MEASURED, "its standard error; null without freedom")
    freedom: int = declare.count("degrees of freedom of the fit")

    @declare.computed(declare.number(RATIO, "standard errors to either side that hold 95 %; null without freedom"))
    def student(self) -> float:
        """Standard errors to either side that hold 95 % of Student's distribution: 12.7 for one degree, 2 for many."""
        return float(scipy.special.stdtrit(self.freedom, 0.975)) if self.freedom > 0 else math.nan


@declare.dataclass
class Odd:
    """An early pass that does not agree with those after it."""

    number: int = declare.count("its number from 1")
    late: float = declare.number(MICROSECONDS, "how late it is")
    strength: float = declare.number(
        RATIO, "its amplitude over what those after it give, each weighted with the energy of its frequencies"
    )


class Ways(NamedTuple):
    """Bar speed (m/s) for the other way of the first pulse, and its residual of times over that of the stated way."""

    speed: float
    misfit: float


@declare.dataclass
class Echoes:
    """The calibration of a bar by its echoes; arrays over frequency have the shape (K,).

    The speed is that of the turns at the near end, or of all ways where the length is given. The first pass comes at
    its foot, later ones by the delay of best correlation.
    """

    quiet: Quiet = field(repr=False)
    times: Array = declare.history("s", "when each pass comes to the gauge", key="passes")
    first: int = declare.count("number of the first pass used, from 0", key="first_pass")
    window: float = declare.number(MICROSECONDS, "length of the stretch of each pass")
    speed: FittedValue = declare.part(FittedValue, "bar speed", quantity=Quantity("m/s", "m/s", "bar speed", digits=5))
    stated_speed: float = declare.number(BAR_SPEED, "bar speed as stated")

    @declare.computed(declare.number(OFF, "speed found over the stated one, less 1", headline="off the stated one"))
    def difference(self) -> float:
        """Speed found over the stated one, less 1."""
        return self.speed.value / self.stated_speed - 1.0

    length: FittedValue = declare.part(
        FittedValue, "length of the bar: given, or from round trips and the speed", quantity=FITTED_LENGTH
    )
    round_trip: FittedValue = declare.part(
        FittedValue, "length by round trips and the speed of the turns at the near end", quantity=FITTED_LENGTH
    )
    attenuation: FittedValue = declare.part(
        FittedValue,
        "attenuation over a round trip at the pulse's own frequencies, each weighted with its energy",
        quantity=Quantity("1/m", "1/m", digits=3),
    )
    odd: Odd | None = declare.part(
        Odd, "last of the first two passes that does not go with those after it; null without one", key="odd_pass"
    )
    other_way: Ways

    @declare.computed(declare.number(BAR_SPEED, "bar speed if the first pulse ran the other way", key="other_way"))
    def other_speed(self) -> float:
        """Bar speed if the first pulse ran the other way."""
        return self.other_way.speed

    theory: Theory = declare.word("theory of dispersion by which the bar speed was taken", key="dispersion")
    frequency: Array = declare.history("Hz", "of the band in which every pass stands out of the noise")
    phase_speed: Array = declare.history("m/s", "phase speed at each frequency")
    phase_speed_error: Array = declare.history("m/s", "its standard error")
    theory_speed: Array = declare.history("m/s", "phase speed of the theory with the speed found")
    losses: Array = declare.history("1/m", "attenuation of the round trips at each frequency")
    losses_error: Array = declare.history("1/m", "its standard error")


class _Passes(NamedTuple):
    """Places (samples) of the passes, the length of their windows, their transforms, number of the first."""

    places: NDArray[np.int64]
    size: int
    frequency: Array
    spectra: NDArray[np.complex128]
    first: int


def calibrate_bar(
    trace: GaugeTrace, bar: Bar, way: Way = "towards", skip: int = 0, theory: Theory = "pochhammer-chree"
) -> Echoes:
    """Return speed, length, dispersion and attenuation of a bar with free ends from many round trips.

    Parameters ---------- trace : GaugeTrace Strain at the gauge. bar : Bar Its gauge distance to one end is taken as
    known, its length where it is finite; density and modulus only begin the search for the speed. way : str, optional
    Direction of the first pulse: "towards" the end whose distance is known, or "away" from it. skip : int, optional
    Passes left out at the begin, such as one that met a specimen. theory : str, optional Theory of dispersion.

    Raises
    ------
    InputError
        If the trace cannot be used, holds fewer than three passes, or no frequency stands out of the noise.
    """
    quiet = quieten(trace, "echo trace")
    if way not in ("towards", "away"):
        raise InputError("echoes.way", way, '"towards" or "away"')
    passes = _passes(quiet, _places(quiet, bar, way), skip)
    usable = _band(passes, quiet)
    if usable.size < 2:
        raise InputError("echo trace", "echoes in the noise", f"passes {ABOVE_NOISE:g} times above their noise")
    step = quiet.trace.step
    delays = np.array([_delay(passes, n, usable, step) for n in range(passes.places.size)])
    amplitude = np.abs(passes.spectra[:, usable])
    energy = (amplitude**2).sum(axis=1)
    w, logs = 2.0 * np.pi * passes.frequency[usable], np.log(amplitude)
    data = _PassData(delays, logs, energy, amplitude[0] ** 2, w, passes.first, bar, theory)
    free, times, design = _speed_and_length(data, way)
    speed, phase, phase_error = (free.speed, *_phase_speed(data, design, 2.0 * bar.gauge_distance))
    length, misfit = free.length, math.nan
    other = Ways(_speed_and_length(data, _other(way))[0].speed.value, math.nan)
    if math.isfinite(bar.length):
        length = FittedValue(bar.length, math.nan, 0)
        speed, misfit, ways = _known_length(data, way)
        phase, phase_error = _phase_speed(data, ways, 1.0)
        turned, left, _ = _known_length(data, _other(way))
        other = Ways(turned.value, left / misfit if misfit > 0.0 else math.nan)
    rod = bar.rod._replace(bar_speed=speed.value)
    attenuation, losses, losses_error = _losses(data, length)
    return Echoes(
        quiet=quiet,
        times=np.asarray(quiet.trace.start + step * passes.places),
        window=passes.size * step,
        first=skip,
        speed=speed,
        stated_speed=bar.speed,
        length=length,
        round_trip=free.length,
        attenuation=attenuation,
        frequency=passes.frequency[usable],
        phase_speed=phase,
        phase_speed_error=phase_error,
        theory_speed=np.asarray(w / wave_number(w, rod, theory).real),
        losses=losses,
        losses_error=losses_error,
        theory=theory,
        odd=_odd(data, times, design, step),
        other_way=other,
    )


def _other(way: Way) -> Way:
    return "away" if way == "towards" else "towards"


class _Places(NamedTuple):
    """Foot of the first pass, delay of the second one, and of a round trip, in samples."""

    foot: float
    near: float
    around: float


def _places(quiet: Quiet, bar: Bar, way: Way) -> _Places:
    """Find the passes by correlation with the first one.

    The foot is that of the straight line through a quarter and a half of the height, which noise hardly moves. The
    round trip is the first large correlation of the same sign once the first pulse is over. The second pass, turned
    over at one end, is the deepest correlation near its expected place, or the deepest of all if that is twice as deep.
    """
    x = quiet.trace.strain
    peak = float(np.abs(x).max())
    inside = quiet.onset + int(np.argmax(np.abs(x[quiet.onset :]) > FOOT_LEVELS[1] * peak))
    over = crossing(x, inside, FOOT_LEVELS[0] * peak, 1)
    top = inside + int(np.argmax(x[inside : int(over) + 1])) if math.isfinite(over) else inside
    quarter, half = (crossing(x, top, share * float(x[top]), -1) for share in FOOT_LEVELS)
    foot = 2.0 * quarter - half if math.isfinite(quarter) else float(quiet.onset)
    width = crossing(x, top, 0.5 * float(x[top]), 1) - foot
    begin, clear = max(round(foot), 0), int(PULSE_WIDTHS * width) if math.isfinite(width) else 0
    if not clear or begin + 2 * clear > x.size:
        raise InputError("echo trace", "one pulse alone", "a record of several round trips")
    same = scipy.signal.correlate(x[begin:], x[begin : begin + clear], "valid")
    around = _first_large(same, clear)
    if around <= clear + 1:
        raise InputError("echo trace", "no echo of the sign of the first pulse", "a record of several round trips")
    deepest = clear + int(np.argmin(same[clear:around]))
    expected = 2.0 * bar.delay / quiet.trace.step
    near = _near_peak(same[:around], expected if way == "towards" else around - expected, -1.0, deepest)
    near = near if same[near] < TWICE_AS_DEEP * same[deepest] else deepest
    return _Places(foot, float(near), float(around))


def _first_large(same: Array, clear: int) -> int:
    """Return the place of the first correlation of nine tenths of the largest one."""
    first = clear + int(np.argmax(same[clear:] >= LARGE * float(same[clear:].max())))
    return first + int(np.argmax(same[first : first + clear]))


def _near_peak(same: Array, expected: float, sign: float, fallback: int = 0) -> int:
    """Return the place of the strongest correlation within a tenth of the expected one."""
    low, high = int((1.0 - NEAR_SEARCH) * expected), int((1.0 + NEAR_SEARCH) * expected) + 1
    if low < 1 or high > same.size:
        return fallback
    return low + int(np.argmax(sign * same[low:high]))


def _passes(quiet: Quiet, places_of_passes: _Places, skip: int) -> _Passes:
    """Cut the passes out as long as they stand out of the noise, turn every second one over, and transform them."""
    foot, near, around = places_of_passes
    size = int(min(near, around - near))
    x, lead = quiet.trace.strain, int(LEAD * min(near, around - near))
    count = int(2 * ((x.size - foot) // around)) + 2
    places = np.array([round(foot + (n // 2) * around + (n % 2) * near) for n in range(count)], dtype=np.int64)
    places = places[places - lead + size <= x.size]
    ceiling = noise_ceiling(quiet.noise, x.size)
    drowned = [float(np.abs(x[max(p - lead, 0) : p - lead + size]).max()) <= ceiling for p in places]
    places = places[: drowned.index(True)] if any(drowned) else places
    numbers = np.arange(places.size)[skip:]
    places = places[skip:]
    if places.size and places[0] < lead:
        got = f"{places[0] * quiet.trace.step * 1e6:.4g} us before the first pass"
        allowed = f"at least {lead * quiet.trace.step * 1e6:.4g} us, a fifth of the time between passes"
        raise InputError("echo trace", got, allowed, "record with a longer pre-trigger, or set echoes.skip = 1")
    if places.size < FEWEST_PASSES:
        hint = "record longer, or skip fewer passes"
        raise InputError("echo trace", f"{places.size} passes", f"at least {FEWEST_PASSES} whole passes", hint)
    total = scipy.fft.next_fast_len(4 * size, real=True)
    taper = _taper(size, lead)
    # a free end turns the pulse over
    parts = [(-1.0) ** n * taper * x[p - lead : p - lead + size] for n, p in zip(numbers, places, strict=True)]
    spectra = np.array([scipy.fft.rfft(part, total) for part in parts])
    return _Passes(places, size, scipy.fft.rfftfreq(total, quiet.trace.step), spectra, skip)


def _taper(size: int, lead: int) -> Array:
    """Return a window with cosine flanks over a part of the lead on both sides."""
    wide = int(FLANK * lead)
    flank = 0.5 * (1.0 - np.cos(np.pi * (np.arange(wide) + 0.5) / max(wide, 1)))
    return np.concatenate([flank, np.ones(size - 2 * wide), flank[::-1]])


def _band(passes: _Passes, quiet: Quiet) -> NDArray[np.intp]:
    """Return the frequencies from the first that a window can hold to the first at which a pass is too weak."""
    amplitude = np.abs(passes.spectra)
    floor = ABOVE_NOISE * quiet.noise * math.sqrt(passes.size)
    clear = np.all(amplitude > np.maximum(floor, WEAKEST * amplitude.max(axis=1, keepdims=True)), axis=0)
    low = int(np.searchsorted(passes.frequency, 1.0 / (passes.size * quiet.trace.step)))
    sunk = np.flatnonzero(~clear[low:])
    return np.arange(low, low + (int(sunk[0]) if sunk.size else clear.size - low))


class _PassData(NamedTuple):
    """Delays of the passes after the first one (s) and logarithms of their amplitudes, each of shape (P, K).

    ``energy`` is that of each pass, ``weight`` that of each frequency w (rad/s) of the first one, ``first`` its number.
    """

    delays: Array
    logs: Array
    energy: Array
    weight: Array
    w: Array
    first: int
    bar: Bar
    theory: Theory


class _Free(NamedTuple):
    """Speed and length with a way known round the near end alone."""

    speed: FittedValue
    length: FittedValue


class _Plane(NamedTuple):
    """Least squares: values of shape (p, ...), inverse of the normal matrix, variance of unit weight, freedom."""

    value: Array
    inverse: Array
    variance: Array
    freedom: int

    def errors(self, place: int) -> Array:
        """Return the standard errors of a value."""
        return np.asarray(np.sqrt(self.inverse[place, place] * self.variance))

    def carried(self, slopes: Array) -> float:
        """Return the standard error of a function of the values with these slopes."""
        return float(np.sqrt(slopes @ self.inverse @ slopes * self.variance))


def _plane(design: Array, values: Array, weight: Array) -> _Plane:
    """Fit values of shape (P, ...) by design (P, p) with weights of shape (P,); no errors without freedom."""
    inverse = np.linalg.pinv((design.T * weight) @ design)
    value = np.asarray(inverse @ (design.T * weight) @ values)
    freedom = design.shape[0] - design.shape[1]
    left = values - design @ value
    squares = np.tensordot(weight, left**2, axes=1)
    variance = squares / freedom if freedom > 0 else np.full_like(squares, np.nan)
    return _Plane(value, np.asarray(inverse), np.asarray(variance), freedom)


def _turns(data: _PassData, way: Way) -> Array:
    """Return 1, the turns at the near and those at the far end before each pass, shape (P, 3)."""
    n = data.first + np.arange(data.energy.size)
    many, few = (n + 1) // 2, n // 2
    near, far = (many, few) if way == "towards" else (few, many)
    return np.column_stack([np.ones(n.size), near - near[0], far - far[0]])


def _delay(passes: _Passes, m: int, band: NDArray[np.intp], step: float) -> Array:
    """Return the delay of a pass after the first one at each frequency, by phase, s."""
    turn = np.unwrap(np.angle(passes.spectra[0][band] * np.conj(passes.spectra[m][band])))
    # the phase is known but for whole turns: the lowest frequency turns less than half of one
    turn -= 2.0 * np.pi * round(float(turn[0]) / (2.0 * np.pi))
    return np.asarray(step * (passes.places[m] - passes.places[0]) + turn / (2.0 * np.pi * passes.frequency[band]))


def _plain_times(data: _PassData, speed: float) -> Array:
    """Return the delays of a bar without dispersion, by the theory at a bar speed, s, shape (P,).

    By least squares of the phases, which are as uncertain as their amplitude is small: w |S|.
    """
    k = wave_number(data.w, data.bar.rod._replace(bar_speed=speed), data.theory).real
    # delay of each component over that in a bar without dispersion
    slower, weight = k * speed / data.w, data.weight * data.w**2
    return np.asarray(data.delays @ (weight * slower) / (weight @ slower**2))


def _speed_and_length(data: _PassData, way: Way) -> tuple[_Free, Array, Array]:
    """Return speed and length by turns at both ends, the plain times, and the design: c = 2 d/D, L = d (D + F)/D."""
    design, d = _turns(data, way), data.bar.gauge_distance
    speed = data.bar.speed
    for _ in range(ROUNDS):
        times = _plain_times(data, speed)
        fit = _plane(design, times, data.energy)
        near, far = float(fit.value[1]), float(fit.value[2])
        if not near > 0.0 or not far > 0.0:
            raise InputError("echo trace", "passes out of turn", "a pulse that runs from end to end")
        before, speed = speed, 2.0 * d / near
        if abs(speed / before - 1.0) < CONVERGED:
            break
    error = fit.carried(np.array([0.0, -speed / near, 0.0]))
    off = fit.carried(np.array([0.0, -d * far / near**2, d / near]))
    length = d * (near + far) / near
    return _Free(FittedValue(speed, error, fit.freedom), FittedValue(length, off, fit.freedom)), times, design


def _known_length(data: _PassData, way: Way) -> tuple[FittedValue, float, Array]:
    """Return the speed over known ways, the root mean square residual of the times (s), and the design."""
    d, turns = data.bar.gauge_distance, _turns(data, way)
    design = np.column_stack([np.ones(turns.shape[0]), 2.0 * (turns[:, 1] * d + turns[:, 2] * (data.bar.length - d))])
    speed = data.bar.speed
    for _ in range(ROUNDS):
        times = _plain_times(data, speed)
        fit = _plane(design, times, data.energy)
        before, speed = speed, 1.0 / float(fit.value[1])
        if abs(speed / before - 1.0) < CONVERGED:
            break
    left = float(np.sqrt(np.mean((times - design @ fit.value) ** 2)))
    return FittedValue(speed, float(fit.errors(1)) * speed**2, fit.freedom), left, design


def _phase_speed(data: _PassData, design: Array, way: float) -> tuple[Array, Array]:
    """Return c(f) = way over the second value of the fit of the delays at each frequency, and its standard error."""
    fit = _plane(design, data.delays, data.energy)
    speed = way / fit.value[1]
    return np.asarray(speed), np.asarray(fit.errors(1) * np.abs(speed / fit.value[1]))


def _trips(data: _PassData) -> Array:
    """Return 1, 1 for a pass turned over, and the round trips before each pass, shape (P, 3)."""
    n = data.first + np.arange(data.energy.size)
    return np.column_stack([np.ones(n.size), n % 2, n // 2 - n[0] // 2])


def _losses(data: _PassData, length: FittedValue) -> tuple[FittedValue, Array, Array]:
    """Return the attenuation by energy, that of each frequency, and its standard error, per round trip."""
    way, design = 2.0 * length.value, _trips(data)
    by_energy = _plane(design, data.logs @ data.weight / data.weight.sum(), data.energy)
    each = _plane(design, data.logs, data.energy)
    value = -float(by_energy.value[2]) / way
    unsure = 0.0 if math.isnan(length.error) else value * length.error / length.value
    mean = FittedValue(value, math.hypot(float(by_energy.errors(2)) / way, unsure), by_energy.freedom)
    return mean, np.asarray(-each.value[2] / way), np.asarray(each.errors(2) / way)


def _odd(data: _PassData, times: Array, design: Array, step: float) -> Odd | None:
    """Return the last of the first two passes that disagrees with those after it, in time or in amplitude.

    By Student's distribution once in a thousand records; a sample and `STRONGER` of amplitude always pass.
    """
    logs = data.logs @ data.weight / data.weight.sum()
    for k in (1, 0):
        if times.size - k - 1 - design.shape[1] < 2:
            continue
        late, surely_late = _foretold(design, times, data.energy, k)
        louder, surely_louder = _foretold(_trips(data), logs, data.energy, k)
        if (surely_late and abs(late) > step) or (surely_louder and abs(louder) > STRONGER):
            return Odd(data.first + k + 1, late, math.exp(louder))
    return None


def _foretold(design: Array, values: Array, weight: Array, k: int) -> tuple[float, bool]:
    """Return the difference of a value from the prediction by those after it, and whether chance hardly explains it."""
    after = _plane(design[k + 1 :], values[k + 1 :], weight[k + 1 :])
    apart = float(values[k] - design[k] @ after.value)
    spread = math.sqrt(float((1.0 / weight[k] + design[k] @ after.inverse @ design[k]) * after.variance))
    return apart, abs(apart) > float(scipy.special.stdtrit(after.freedom, 1.0 - 0.5 * ONCE_IN)) * spread
