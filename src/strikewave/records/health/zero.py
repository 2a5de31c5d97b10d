"""Checks of the zero of a record before and after blows: unsettled, drift, shift, decay."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from strikewave.records.baseline import LOOK_BACK
from strikewave.records.contacts import MAD_TO_SIGMA
from strikewave.records.health.sampled_record import (
    BEGINNING,
    FEWEST_OF_PART,
    JUMPING,
    Array,
    BlowRecord,
    ResponseRecord,
    effects_of_level,
)
from strikewave.records.health_notice import Fault
from strikewave.records.measuring import FOOT
from strikewave.records.response import FEWEST
from strikewave.records.robust import alike_as_one
from strikewave.records.tail import TailModel
from strikewave.records.thresholds import OfBeginning, OfZero
from strikewave.signal.filters import ac_uncoupled

LAST_QUARTER = 4  # a drift of the velocity is that of the last quarter of what follows the blow
TIME_CONSTANTS = 40  # time constants of a decay of the zero that are tried
MOST_LOOKED_AT = 4000  # samples of a free decay in which its zero is looked for


class _Edges(NamedTuple):
    """Spans of the first and last part of a record without a blow."""

    begin: float
    end: float
    in_blow: float  # peak of the blow that it begins in; 0 for none
    in_motion: bool


def _edges(record: BlowRecord) -> _Edges:
    values, noise = record.values, record.noise
    part = max(values.size // BEGINNING, FEWEST_OF_PART)
    begin, end = (float(np.ptp(piece)) for piece in (values[:part], values[-part:]))
    middle = record.line.at(0.5 * values.size)
    above, below = (float(np.max(sign * (values[:part] - middle))) for sign in (1.0, -1.0))
    falls_off = float(np.ptp(values[part : 2 * part])) < OfBeginning.ONE_SIDED * begin
    one_sided = min(above, below) < OfBeginning.ONE_SIDED * max(above, below)
    struck = begin > OfBeginning.IN_MOTION * max(noise, end / OfBeginning.CUT_BLOW) and falls_off and one_sided
    in_motion = begin > OfBeginning.FALLS_OFF * end and begin > OfBeginning.IN_MOTION * noise
    return _Edges(begin, end, (above if above > below else -below) if struck else 0.0, in_motion)


def begins_in_blow(record: BlowRecord) -> Iterator[Fault]:
    """Find that a record in which no blow is seen begins in one."""
    if record.largest is None and record.once(_edges).in_blow:
        yield Fault(record.start, {"peak": record.once(_edges).in_blow}, start=record.start)


def begins_in_motion(record: BlowRecord) -> Iterator[Fault]:
    """Find that a record in which no blow is seen begins while something still swings."""
    if record.largest is None:
        edges = record.once(_edges)
        if not edges.in_blow and edges.in_motion:
            yield Fault(edges.begin, {"end": edges.end}, start=record.start)


def unsettled(record: BlowRecord) -> Iterator[Fault]:
    """Find that the zero of a record in which no blow is seen is far off, or drifts."""
    if record.largest is not None or record.once(_edges).in_blow or record.once(_edges).in_motion:
        return
    line, size = record.line, record.values.size
    strays = MAD_TO_SIGMA * float(np.median(np.abs(record.values - line.at(np.arange(size)))))
    scatter = max(strays, record.noise)
    drift, middle = line.slope * (size - 1), line.at(0.5 * size)
    if abs(drift) > OfBeginning.IN_MOTION * scatter or abs(middle) > OfBeginning.FAR_OFF * scatter:
        yield Fault(middle, {"drift": drift})


def drift_at_blow(record: BlowRecord) -> Iterator[Fault]:
    """Find a drift with nothing before the blow that tells where the zero stood: the line of the record is all."""
    pulse, line = record.largest, record.line
    if pulse is not None and not pulse.baseline.widths:
        missed = 0.5 * LOOK_BACK * abs(line.slope) * max(pulse.width, record.step) / record.step / abs(pulse.peak)
        if missed > OfZero.WRONG_PEAK:
            yield Fault(line.slope * (record.values.size - 1), {"missed": missed})


def drift_before(record: BlowRecord) -> Iterator[Fault]:
    """Find a drift of the zero before the largest blow, which is carried on under it."""
    pulse = record.largest
    if pulse is not None and pulse.baseline.widths:
        drift = pulse.baseline.slope * (record.values.size - 1)
        if abs(drift) > OfZero.NOTED * abs(pulse.peak):
            yield Fault(drift, {"share": abs(drift / pulse.peak)})


def offset(record: BlowRecord) -> Iterator[Fault]:
    """Find a zero that is far off before the largest blow."""
    pulse = record.largest
    share = 0.0 if pulse is None else abs(pulse.offset) / abs(pulse.peak)
    if pulse is not None and share > OfZero.NOTED:
        severity, harms = ("", ("spectrum",)) if share > OfZero.LARGE else ("good", ())
        yield Fault(pulse.offset, {"share": share}, severity, harms)


def offset_of_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find a zero of a response that is far off."""
    share = abs(record.largest.zero) / record.peak
    if not share < OfZero.NOTED:
        yield Fault(record.largest.zero, {"share": share}, severity="" if share > OfZero.LARGE else "good")


def _step(record: BlowRecord) -> tuple[float, float, bool] | None:
    """Return when the zero steps, s, by how much, and whether within a width of a blow, which then did it."""
    step = level_step(record.values)
    if step is None:
        return None
    time = record.time(step[0])
    spans = [(pulse.begin - pulse.smooth.length, pulse.end + pulse.smooth.length) for pulse in record.pulses]
    return time, step[1], any(begin < time < end for begin, end in spans)


def step_with_blow(record: BlowRecord) -> Iterator[Fault]:
    """Find a zero that steps with a blow."""
    step = record.once(_step)
    if step is not None and step[2]:
        yield Fault(step[1], {"time": step[0]}, start=step[0])


def step_alone(record: BlowRecord) -> Iterator[Fault]:
    """Find a zero that steps between blows."""
    step = record.once(_step)
    if step is not None and not step[2]:
        yield Fault(step[1], {"time": step[0]}, start=step[0])


def _noted_tail(record: BlowRecord) -> tuple[TailModel, float] | None:
    """Return what the zero does after the blows, and its share of the smallest; None for motion, or what is none."""
    model = record.tail
    if model is None or record.once(_step) is not None or model.kind in ("rest", "motion", "ac-coupling"):
        return None
    share = abs(model.level) / min(abs(pulse.peak) for pulse in record.pulses)
    noted = not share < OfZero.NOTED_SHIFT and not abs(model.level) < OfZero.SHIFTED * model.level_error
    return (model, share) if noted else None


def drift_after(record: BlowRecord) -> Iterator[Fault]:
    """Find a zero that drifts on after the blows."""
    tail = record.once(_noted_tail)
    if tail is not None and tail[0].kind == "line" and not tail[1] < OfZero.NOTED:
        yield Fault(tail[0].level, {"share": tail[1]}, start=record.pulses[-1].end)


def zero_shift(record: BlowRecord) -> Iterator[Fault]:
    """Find a zero after the blows that is not that before them, for good or with a decay of its own."""
    tail = record.once(_noted_tail)
    if tail is None or tail[0].kind == "line":
        return
    (model, share), last = tail, record.pulses[-1]
    back = f", and comes back with a time constant of {1e3 * model.constant:.3g} ms" if model.kind == "decay" else ""
    effects = {name: abs(e) for name, e in effects_of_level(last, model.level, after_peak=True).items()}
    severity = "suspect" if share > OfZero.LARGE_SHIFT else ""
    yield Fault(model.level, {"share": share, "back": back}, severity, start=last.end, effects=effects, signed=False)


def ac_coupling(record: BlowRecord) -> Iterator[Fault]:
    """Find AC coupling, and what it does to the figures: the blows are measured again without it."""
    model = record.tail
    if model is None or model.kind != "ac-coupling":
        return
    effects: dict[str, float] = {}
    for pulse, other in zip(record.pulses, record.uncoupled_pulses, strict=False):
        for name in ("peak", "width", "velocity_change"):
            effect = getattr(pulse, name) / getattr(other, name) - 1.0
            if math.isfinite(effect):  # a blow that is cut has no width
                effects[name] = max(effects.get(name, 0.0), effect, key=abs)
    if not effects:  # nothing can be measured without it: half of a length over tau is what it takes off at least
        length = max(pulse.smooth.length for pulse in record.pulses)
        effects = {name: -min(0.5 * length / model.constant, 1.0) for name in ("peak", "width", "velocity_change")}
    details = {
        "level": model.level,
        "cutoff": 1.0 / (2.0 * math.pi * model.constant),
        "constant": 1e3 * model.constant,
        "doubt": 2e3 * model.constant_error,
    }
    yield Fault(model.constant, details, start=record.pulses[0].begin, effects=effects)


def velocity_drift(record: BlowRecord) -> Iterator[Fault]:
    """Find an integrated velocity that still wanders off long after the last blow, when nothing moves any more."""
    if not record.pulses:
        return
    pulse = record.pulses[-1]
    after = record.values[record.place(pulse.end) :] - pulse.offset
    lasts, total = after.size * record.step, abs(pulse.velocity_change)
    tail = after[-(after.size // LAST_QUARTER) :]
    if tail.size < OfZero.FEWEST or not total > 0.0 or lasts < OfZero.LONG_AFTER * pulse.width:
        return
    off = float(np.mean(tail))
    drift = off * after.size * record.step
    unsure = OfZero.SHIFTED * float(np.std(tail)) / math.sqrt(tail.size) * after.size * record.step
    share = abs(drift) / total
    if share < OfZero.NOTED_DRIFT or abs(drift) < unsure or _as_at_first(record, off + pulse.offset, drift):
        return
    severity = "" if share > OfZero.LARGE_DRIFT else "good"
    yield Fault(drift, {"off": off, "share": share}, severity=severity, start=pulse.end)


def _as_at_first(record: BlowRecord, level: float, drift: float) -> bool:
    """Tell whether a record ends where it began, long before the first blow, much nearer than its drift says.

    Then its zero stands, and what it stood at before a later blow was motion: of a feed, or what the blow before left.
    """
    first = record.values[: record.values.size // BEGINNING]
    if first.size < FEWEST_OF_PART or record.time(2 * first.size) > record.pulses[0].begin:
        return False
    after = (record.values.size - record.place(record.pulses[-1].end)) * record.step
    least = min(abs(drift), abs(record.pulses[-1].velocity_change))
    return abs(level - float(np.median(first))) * after < OfZero.NOTED_DRIFT * least


def no_foot(record: BlowRecord) -> Iterator[Fault]:
    """Find blows after or before which the record does not come back to 2 % of the peak.

    The smooth pulse, whose area is then the velocity change, and the record over its length are two measures of it.
    """
    open_ = [p for p in record.pulses if p.method == "record" and p.begin == p.smooth.begin and p.width > 0.0]
    if not open_:
        return
    largest = 0.0
    for pulse in open_:
        part = record.values[record.place(pulse.begin) : record.place(pulse.end) + 1]
        area = record.step * float(np.sum(part - pulse.offset))
        effect = pulse.velocity_change / area - 1.0 if area * pulse.peak > 0.0 else math.inf
        largest = max(largest, effect, key=abs)
    first = open_[0]
    effects = {"velocity_change": largest}
    yield Fault(len(open_), {"time": first.time, "foot": FOOT}, start=first.begin, end=first.end, effects=effects)


def level_step(values: Array) -> tuple[int, float] | None:
    """Return where a record steps from one quiet level to another, and by how much; None where it does not.

    The step is at least 8 % of what the record spans, and ten times what either level strays.
    """
    sums = np.cumsum(values - np.mean(values))
    place = int(np.argmax(np.abs(sums))) + 1
    parts = values[:place], values[place:]
    if min(part.size for part in parts) < max(OfZero.FEWEST, values.size // BEGINNING):
        return None
    before, after = (float(np.median(part)) for part in parts)
    stray = max(float(np.quantile(np.abs(part - np.median(part)), OfZero.STRAY_QUANTILE)) for part in parts)
    shift = after - before
    least = max(OfZero.STEP_OF_STRAY * stray, OfZero.STEP_OF_SPAN * float(np.ptp(values)))
    return (place, shift) if abs(shift) > least else None


def _larger(effects: Mapping[str, float], others: Mapping[str, float]) -> dict[str, float]:
    """Return effects, with those of others where figures jump and they are larger."""
    return {**effects, **{name: max(effects.get(name, 0.0), others[name], key=abs) for name in JUMPING}}


class _Straight(NamedTuple):
    """A response without the drift before its blow, and that over the record; none where it is not significant."""

    above: Array
    drift: float = 0.0
    slope: float = 0.0


def _straight(record: ResponseRecord) -> _Straight:
    line = _line_before(record)
    if line is None:
        return _Straight(record.above)
    places = np.arange(record.values.size)
    return _Straight(record.above - line[1] * (places - 0.5 * (record.first - 1)), line[1] * (places.size - 1), line[1])


def _drifts(record: ResponseRecord) -> bool:
    return abs(record.once(_straight).drift) > OfZero.NOTED_SHIFT * record.peak


def drift_before_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find a zero that drifts before the blow of a response; what that does is measured without it."""
    straight = record.once(_straight)
    if _drifts(record):
        end = record.place(record.largest.begin + record.largest.duration)
        moved = record.moved_by(abs(straight.slope) * (end - 0.5 * record.first))
        effects = _larger(record.against(straight.above), moved)
        yield Fault(straight.drift, {"share": abs(straight.drift) / record.peak}, effects=effects)


class _ZeroAfter(NamedTuple):
    """Zero of a response after its last decay begins: a lasting offset, or a decay, and the values behind it."""

    above: Array
    begin: int
    level: float
    decay: float
    constant: float

    def curve(self, step: float) -> Array:
        """Return where the zero stands at each sample."""
        since = np.maximum((np.arange(self.above.size) - self.begin) * step, 0.0)
        return np.asarray(self.level + self.decay * np.exp(-since / self.constant))

    def size(self, step: float) -> float:
        """Return how far the zero is off at most."""
        return float(np.max(np.abs(self.curve(step)[self.begin :])))


def _after(record: ResponseRecord) -> _ZeroAfter | None:
    """Return what the zero does after the response; None where that is worth no word.

    A slope before the blow that noise made, carried on, makes a shift: one must be there without it, too.
    """
    straight = record.once(_straight)
    models = []
    for above in (record.above, straight.above) if _drifts(record) else (record.above,):
        model = _zero_after(record, above)
        if model is None:
            return None
        models.append(_ZeroAfter(above, *model))
    least = min(models, key=lambda model: abs(model.level + model.decay))
    return None if least.size(record.step) / record.peak < OfZero.NOTED_SHIFT else least


def _coupled(record: ResponseRecord) -> bool:
    after = record.once(_after)
    if after is None or not after.decay or not abs(after.level) < OfZero.OWN_SIZE * abs(after.decay):
        return False
    return _is_coupled(record, after.above, after.decay, after.constant)


def ac_coupling_of_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find a zero that decays after a response as AC coupling makes it; what that does is measured without it."""
    after = record.once(_after)
    if after is not None and record.once(_coupled):
        plain = record.against(ac_uncoupled(after.above, record.step, after.constant))
        effects = _larger(plain, record.moved_by(after.size(record.step)))
        details = {"decay": after.decay, "cutoff": 1.0 / (2.0 * math.pi * after.constant)}
        yield Fault(after.constant, details, start=record.blows[-1].end, effects=effects)


def shift_after_response(record: ResponseRecord) -> Iterator[Fault]:
    """Find a zero that has shifted with the last blow of a response; what that does is measured without it."""
    after = record.once(_after)
    if after is None or record.once(_coupled):
        return
    size = after.size(record.step)
    places, begin = np.arange(after.above.size), record.span(record.responses[-1])[0]
    ramp = np.clip((places - begin) / max(after.begin - record.first, 1), 0.0, 1.0)
    moved = record.against(after.above - ramp * after.curve(record.step))
    effects = {name: abs(effect) for name, effect in moved.items()}
    share = size / record.peak
    effects = _larger({**effects, "peak": max(effects.get("peak", 0.0), share)}, record.moved_by(size))
    back = f", and comes back with a time constant of {1e3 * after.constant:.3g} ms" if after.decay else ""
    details = {"share": share, "back": back}
    start = record.blows[-1].end
    yield Fault(after.level + after.decay, details, start=start, effects=effects, signed=False)


def _line_before(record: ResponseRecord) -> tuple[float, float] | None:
    """Return level and slope a sample of what lies before the first blow; None where no slope is significant.

    Noise with a long memory makes slopes too: where much follows the last decay, it must lie where the line leads.
    """
    before = record.above[: record.first]
    if before.size < 2 * FEWEST:
        return None
    place = np.arange(before.size) - 0.5 * (before.size - 1)
    power = float(np.sum(place**2))
    slope = float(np.sum(place * before)) / power
    rest = before - np.mean(before) - slope * place
    error = math.sqrt(float(np.mean(rest**2)) * alike_as_one(rest) / power)
    if not abs(slope) > OfZero.BEFORE_A_RESPONSE * error:
        return None
    last = record.place(record.responses[-1].decay.end)
    tail = record.above[last:]
    if tail.size >= 2 * FEWEST:
        expected = slope * (last + 0.5 * tail.size - 0.5 * record.first)
        if abs(float(np.mean(tail)) - expected) > OfZero.CARRIED_ON * abs(expected):
            return None
    return float(np.mean(before)), slope


class _FreeDecay(NamedTuple):
    """The last free decay: where it begins, values and times since then, and cosines and sines of its modes."""

    begin: int
    values: Array
    since: Array
    swinging: Array

    def beside(self, *more: Array) -> tuple[float, Array, Array]:
        """Fit the modes with further columns; return squares left, amplitudes, and what is left."""
        columns = np.hstack([self.swinging, *(column[:, None] for column in more)])
        amplitudes = np.asarray(np.linalg.lstsq(columns, self.values, rcond=None)[0], dtype=np.float64)
        rest = np.asarray(self.values - columns @ amplitudes, dtype=np.float64)
        return float(rest @ rest), amplitudes, rest

    def decayed(self, constant: float) -> tuple[float, Array, Array]:
        """Fit the modes with a constant and a decay."""
        return self.beside(np.ones(self.values.size), np.exp(-self.since / constant))


def _free_decay(record: ResponseRecord, above: Array) -> _FreeDecay | None:
    """Return the last free decay, thinned, to the end of the record; None where it is too short."""
    last = record.responses[-1]
    begin, end = record.place(last.decay.begin), record.values.size
    if end - begin < 2 * FEWEST:
        return None
    every = max((end - begin) // MOST_LOOKED_AT, 1)
    values = above[begin:end:every]
    since = np.asarray(record.step * every * np.arange(values.size), dtype=np.float64)
    waves = [np.empty((values.size, 0))]
    for mode in last.modes:
        wave = np.exp(since * (-1.0 / mode.decay_time + 2j * np.pi * mode.frequency))
        waves.append(np.stack([wave.real, wave.imag], axis=1))
    return _FreeDecay(begin, values, since, np.hstack(waves))


def _zero_after(record: ResponseRecord, above: Array) -> tuple[int, float, float, float] | None:
    """Return where the last free decay begins, and level, decay and its time constant of the zero from there on.

    Fitted beside the modes: a constant, or a constant and a decay that explains more. None where neither stands out.
    """
    from scipy.optimize import minimize_scalar

    part = _free_decay(record, above)
    if part is None:
        return None
    plain, only = part.beside(), part.beside(np.ones(part.values.size))
    first, last = OfZero.FASTEST * record.period, 0.5 * float(part.since[-1])
    constants = np.geomspace(first, last, TIME_CONSTANTS) if last > 2.0 * record.period else np.empty(0)
    if constants.size:
        best = int(np.argmin([part.decayed(float(constant))[0] for constant in constants]))
        low, high = constants[max(best - 1, 0)], constants[min(best + 1, constants.size - 1)]
        bounds = math.log(low), math.log(high)
        constant = math.exp(minimize_scalar(lambda size: part.decayed(math.exp(size))[0], bounds=bounds).x)
        fit = part.decayed(constant)
        if _explains(only, fit):
            return part.begin, float(fit[1][-2]), float(fit[1][-1]), constant
    return (part.begin, float(only[1][-1]), 0.0, math.inf) if _explains(plain, only) else None


def _is_coupled(record: ResponseRecord, above: Array, decay: float, constant: float) -> bool:
    """Tell whether a decay of the zero is that of AC coupling: without it the zero then stands where it did before.

    A decay of another kind leaves a shift, as it is not as large as the area before demands.
    """
    part = _free_decay(record, ac_uncoupled(above, record.step, constant))
    return part is not None and abs(float(part.beside(np.ones(part.values.size))[1][-1])) < OfZero.OWN_SIZE * abs(decay)


def _explains(before: tuple[float, Array, Array], fit: tuple[float, Array, Array]) -> bool:
    """Tell whether a fit leaves so much less than the one before that it is no chance, whatever the colour."""
    squares, _, rest = fit
    return before[0] - squares > OfZero.BEFORE_A_RESPONSE**2 * squares / rest.size * alike_as_one(rest, 0.99)
