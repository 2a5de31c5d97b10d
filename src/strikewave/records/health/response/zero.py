"""The zero of a response: off, drifting, shifted with the blow, or decaying after it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.percents import percent
from strikewave.records.correlation import alike_as_one
from strikewave.records.health.response.examined import JUMPING, ExaminedResponse, finding
from strikewave.records.health_notice import HealthNotice
from strikewave.records.modes import FEWEST
from strikewave.signal.coupling import ac_uncoupled

Array = NDArray[np.float64]

SLOPED, SHIFTED = 5.0, 5.0
"""Standard errors of a slope before the blow, and of a shift after it, that are some."""
CARRIED_ON = 0.5
"""Share of what a drift comes to after the last decay by which what lies there may differ from it."""
NOTED_ZERO, LARGE_ZERO = 0.05, 0.5
"""Shares of the peak at which an offset that is taken off is noted, and at which the range was ill used."""
NOTED_SHIFT = 0.01
"""Share of the peak from which on a shift of the zero is worth a word."""
TIME_CONSTANTS, FASTEST = 40, 0.3
"""Time constants of a decay of the zero that are tried, and swings that the shortest lasts."""
MOST_LOOKED_AT = 4000
"""Samples of a free decay in which its zero is looked for."""
OWN_SIZE = 0.3
"""Share of a decay that is left of the zero without AC coupling of its time constant, or beside it, at most."""


def _larger(effects: Mapping[str, float], others: Mapping[str, float]) -> dict[str, float]:
    """Return effects, with those of others where figures jump and they are larger."""
    jumping = {name: max(effects.get(name, 0.0), others[name], key=abs) for name in JUMPING}
    return {**effects, **jumping}


def offset(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a zero that is far off."""
    zero = record.largest.zero
    share = abs(zero) / record.peak
    if share < NOTED_ZERO:
        return []
    message = f"the zero stands at {record.text(zero)}, {percent(share)} of the peak; it is taken off"
    return [HealthNotice("not-settled", message, zero, severity="suspect" if share > LARGE_ZERO else "good")]


def shifted(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a zero that drifts, shifts with the blow, or decays as AC coupling makes it; measure again without that.

    A slope before the blow that noise made, carried on, makes a shift: one must be there without it, too.
    """
    places = np.arange(record.values.size)
    line = _line_before(record)
    findings = []
    straight = record.above
    if line is not None:
        drift = line[1] * (record.values.size - 1)
        straight = record.above - line[1] * (places - 0.5 * (record.first - 1))
        message = (
            f"before the blow the zero drifts, by {record.text(drift)} over a length of the record, "
            f"{percent(abs(drift) / record.peak)} of the peak"
        )
        end = record.place(record.largest.begin + record.largest.duration)
        effects = _larger(record.against(straight), record.moved_by(abs(line[1]) * (end - 0.5 * record.first)))
        findings = [finding("drift", message, drift, effects)] if abs(drift) > NOTED_SHIFT * record.peak else []
    afters = [
        (above, _zero_after(record, above)) for above in ((record.above, straight) if findings else (record.above,))
    ]
    found = [(above, after) for above, after in afters if after is not None]
    if len(found) < len(afters):
        return findings
    return findings + _shifted_after(record, *min(found, key=lambda pair: abs(pair[1][1] + pair[1][2])))


def _shifted_after(
    record: ExaminedResponse, above: Array, after: tuple[int, float, float, float]
) -> list[HealthNotice]:
    """Tell a zero that has shifted with the last blow from one that decays after it, and what that does."""
    places = np.arange(above.size)
    begin, level, decay, constant = after
    since = np.maximum((places - begin) * record.step, 0.0)
    curve = level + decay * np.exp(-since / constant)
    size = float(np.max(np.abs(curve[begin:])))
    share = size / record.peak
    if share < NOTED_SHIFT:
        return []
    start = record.blows[-1].end
    if decay and abs(level) < OWN_SIZE * abs(decay) and _is_coupled(record, above, decay, constant):
        message = (
            f"after the blow the zero decays from {record.text(decay)} as a high-pass of "
            f"{1.0 / (2.0 * math.pi * constant):.4g} Hz makes it (AC coupling)"
        )
        effects = record.against(ac_uncoupled(above, record.step, constant))
        effects = _larger(effects, record.moved_by(size))
        return [finding("ac-coupling", message, constant, effects, start=start)]
    ramp = np.clip((places - record.span(record.responses[-1])[0]) / max(begin - record.first, 1), 0.0, 1.0)
    message = f"after the blow the zero has shifted by {record.text(level + decay)}, {percent(share)} of the peak"
    if decay:
        message += f", and comes back with a time constant of {1e3 * constant:.3g} ms"
    effects = {name: abs(effect) for name, effect in record.against(above - ramp * curve).items()}
    effects = _larger({**effects, "peak": max(effects.get("peak", 0.0), share)}, record.moved_by(size))
    return [finding("zero-shift", message, level + decay, effects, signed=False, start=start)]


def _line_before(record: ExaminedResponse) -> tuple[float, float] | None:
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
    if not abs(slope) > SLOPED * error:
        return None
    last = record.place(record.responses[-1].decay.end)
    tail = record.above[last:]
    if tail.size >= 2 * FEWEST:
        expected = slope * (last + 0.5 * tail.size - 0.5 * record.first)
        if abs(float(np.mean(tail)) - expected) > CARRIED_ON * abs(expected):
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
        found = np.asarray(np.linalg.lstsq(columns, self.values, rcond=None)[0], dtype=np.float64)
        rest = np.asarray(self.values - columns @ found, dtype=np.float64)
        return float(rest @ rest), found, rest

    def decayed(self, constant: float) -> tuple[float, Array, Array]:
        """Fit the modes with a constant and a decay."""
        return self.beside(np.ones(self.values.size), np.exp(-self.since / constant))


def _free_decay(record: ExaminedResponse, above: Array) -> _FreeDecay | None:
    """Return the last free decay, thinned, to the end of the record; None where it is too short."""
    one = record.responses[-1]
    begin, end = record.place(one.decay.begin), record.values.size
    if end - begin < 2 * FEWEST:
        return None
    every = max((end - begin) // MOST_LOOKED_AT, 1)
    values = above[begin:end:every]
    since = np.asarray(record.step * every * np.arange(values.size), dtype=np.float64)
    waves = [np.empty((values.size, 0))]
    for mode in one.modes:
        wave = np.exp(since * (-1.0 / mode.decay_time + 2j * np.pi * mode.frequency))
        waves.append(np.stack([wave.real, wave.imag], axis=1))
    return _FreeDecay(begin, values, since, np.hstack(waves))


def _zero_after(record: ExaminedResponse, above: Array) -> tuple[int, float, float, float] | None:
    """Return where the last free decay begins, and level, decay and its time constant of the zero from there on.

    Fitted beside the modes: a constant, or a constant and a decay that explains more. None where neither stands out.
    """
    from scipy.optimize import minimize_scalar

    part = _free_decay(record, above)
    if part is None:
        return None
    plain, only = part.beside(), part.beside(np.ones(part.values.size))
    first, last = FASTEST * record.period, 0.5 * float(part.since[-1])
    constants = np.geomspace(first, last, TIME_CONSTANTS) if last > 2.0 * record.period else np.empty(0)
    if constants.size:
        best = int(np.argmin([part.decayed(float(constant))[0] for constant in constants]))
        low, high = constants[max(best - 1, 0)], constants[min(best + 1, constants.size - 1)]
        found = minimize_scalar(lambda size: part.decayed(math.exp(size))[0], bounds=(math.log(low), math.log(high)))
        constant = math.exp(found.x)
        fit = part.decayed(constant)
        if _explains(only, fit):
            return part.begin, float(fit[1][-2]), float(fit[1][-1]), constant
    return (part.begin, float(only[1][-1]), 0.0, math.inf) if _explains(plain, only) else None


def _is_coupled(record: ExaminedResponse, above: Array, decay: float, constant: float) -> bool:
    """Tell whether a decay of the zero is that of AC coupling: without it the zero then stands where it did before.

    A decay of another kind leaves a shift, as it is not as large as the area before demands.
    """
    part = _free_decay(record, ac_uncoupled(above, record.step, constant))
    return part is not None and abs(float(part.beside(np.ones(part.values.size))[1][-1])) < OWN_SIZE * abs(decay)


def _explains(before: tuple[float, Array, Array], fit: tuple[float, Array, Array]) -> bool:
    """Tell whether a fit leaves so much less than the one before that it is no chance, whatever the colour."""
    squares, _, rest = fit
    return before[0] - squares > SHIFTED**2 * squares / rest.size * alike_as_one(rest, 0.99)
