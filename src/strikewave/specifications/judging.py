"""One shock against a specification: peak, pulse width, velocity change, band, cross-axis, sampling, filter.

Each clause has its value, limits, margin, status and verdict. What the health of the record, its sampling or a filter
does not allow to be stated is not: the verdict is ``cannot-tell`` with the reason.

Whether a value lies within its limits is decided by the value alone or with its uncertainty. Simple acceptance takes
the value as it is. Guarded decisions (ISO 14253-1, JCGM 106) leave a guard band of the expanded uncertainty U, k = 2,
on both sides of a limit, within which neither is stated.

Source: JCGM 106:2012, 8.2 (simple acceptance), 8.3 (guard bands, w = r U with r = 1); ISO 14253-1:2017.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.base.texts import percent
from strikewave.signal.pulse import FEWEST_INTERVALS, crossing, refine_peak
from strikewave.specifications.ideal_pulses import IdealPulse, Placement, PulseBand

Rule = Literal["simple", "guarded"]
# Verdicts; what is not judged lacks what only the user can say, such as the directions of the shocks
PASS, FAIL, CANNOT_TELL, NOT_JUDGED = "pass", "fail", "cannot-tell", "not-judged"
WORST_FIRST = (FAIL, CANNOT_TELL, PASS)


def decide(margin: float, uncertainty: float = 0.0, rule: Rule = "simple") -> str:
    """Return the verdict on a margin to the nearest limit, positive inside."""
    guard = uncertainty if rule == "guarded" else 0.0
    if math.isnan(margin) or math.isnan(guard):
        return CANNOT_TELL
    if margin >= guard:
        return PASS
    return FAIL if margin < -guard or guard == 0.0 else CANNOT_TELL


def together(verdicts: Iterable[str]) -> str:
    """Return the verdict of several: what fails one fails all, and of nothing nothing can be said."""
    found = set(verdicts)
    return next((verdict for verdict in WORST_FIRST if verdict in found), CANNOT_TELL)


Array = NDArray[np.float64]

NORMATIVE, QUOTED, INDICATIVE = "normative", "quoted", "indicative"
# Status of a number: read in the standard, second-hand from a text that is named, from memory
STATUSES = (NORMATIVE, QUOTED, INDICATIVE)
ROUNDING = 1e-9  # share of a value by which it may miss a limit: sums of some thousand samples are exact to that


class Limits(NamedTuple):
    """Limits of a value, and the status of their numbers."""

    low: float  # limits; infinite where there is none
    high: float
    status: str  # the weakest status of the numbers that it is made of

    def margin(self, value: float) -> float:
        """Return the distance to the nearer limit, positive inside."""
        return min(value - self.low, self.high - value)


@dataclass(frozen=True)
class PulseLimits:
    """Limits of a specification for a shock, in SI."""

    pulse: IdealPulse  # the ideal pulse
    status: str  # status of its peak and duration
    level: float = 0.1  # share of the measured peak at which the pulse width is taken
    # None where it asks nothing of it; the cross-axis limit is that of the largest value to either side
    peak: Limits | None = None
    width: Limits | None = None
    velocity_change: Limits | None = None
    # Shares of the duration before and after the ideal pulse over which the velocity change is integrated
    window: tuple[float, float] = (0.1, 0.1)
    cross_axis: Limits | None = None
    band: PulseBand | None = None  # the band; None where there is none
    band_status: str = INDICATIVE  # its status
    rate: Limits | None = None  # demands on the sampling rate, and on the cutoff of a low-pass, Hz
    cutoff: Limits | None = None


class MeasuredFigure(NamedTuple):
    """A value and its standard uncertainty: ``whole`` where it holds that of the acceleration too."""

    value: float
    uncertainty: float = 0.0
    whole: bool = False


@dataclass(frozen=True)
class Shock:
    """One measured shock."""

    values: Array  # acceleration, m/s^2, baseline taken off, with the sign that makes the pulse positive
    step: float  # time between samples, and of the first one, s
    begin: float
    peak_index: int  # sample of the peak
    # Peak, and width at 10 %, where they were measured better than from the samples alone; standard uncertainties
    figures: Mapping[str, MeasuredFigure] = field(default_factory=dict)
    filter_left: float = 1.0  # share of the peak of the ideal pulse that a filter leaves; 1 without one
    filter_cutoff: float = math.nan  # its cutoff, Hz; NaN without one
    # Why a figure is not to be trusted: by peak, width, velocity_change and cross_axis
    troubles: Mapping[str, str] = field(default_factory=dict)
    # Accelerations of cross-axis channels at the same times, by name
    cross_axis: Mapping[str, Array] = field(default_factory=dict)
    # Standard uncertainty of them, whatever they read: the noise of the noisiest before the shock, and amounts of a
    # budget; NaN where it is not known
    cross_axis_noise: float = 0.0
    # Expanded uncertainty, k = 2, of the acceleration as a share of it: of figures whose own is not whole
    uncertainty: float = 0.0
    filter_width: float = 1.0  # width of the smooth pulse of the blow that the filter makes of it, over that before

    @property
    def time(self) -> Array:
        """Time of each sample, s."""
        return np.asarray(self.begin + self.step * np.arange(self.values.size), dtype=np.float64)


@declare.dataclass
class Clause:
    """A clause and what it comes to, in its unit; NaN where there is nothing."""

    clause: str = declare.word("what is judged, such as peak")
    status: str = declare.word("of its limits: normative, quoted or indicative")
    unit: str = declare.word("SI unit of value, limit, margin and uncertainty")
    value: float = declare.word("what was found")
    low: float  # its limits; infinite where there is none
    high: float
    limit = declare.computed(declare.word("[low, high]; null where there is none"))(lambda one: (one.low, one.high))
    margin: float = declare.word("distance to the nearer limit, below 0 where it fails")
    uncertainty: float = declare.word("expanded uncertainty of the value, k = 2")
    verdict: str = declare.word("pass, fail, cannot-tell or not-judged")
    reason: str = declare.word("why nothing can be stated, or where it fails", default="")
    file: str | None = declare.word("measured file", default=None, optional=True)
    channel: str | None = declare.word("channel", default=None, optional=True)
    blow: int | None = declare.word("number of the blow, from 1", default=None, optional=True)

    @property
    def share(self) -> float:
        """Margin over half the distance of the limits, or over the limit where there is one: what clauses share."""
        half = 0.5 * (self.high - self.low)
        one = self.high if math.isfinite(self.high) else self.low
        scale = half if math.isfinite(half) else abs(one)
        return self.margin / scale if scale > 0.0 else math.nan


class ShockVerdict(NamedTuple):
    """Verdict on one shock."""

    clauses: tuple[Clause, ...]  # in their order
    start: float  # time of the begin of the ideal pulse, s
    placement: Placement | None  # how the band lies over it

    @property
    def verdict(self) -> str:
        """Verdict of all clauses together."""
        return together(clause.verdict for clause in self.clauses)

    def least_margin(self, limits: PulseLimits) -> float:
        """Return the least margin of the clauses on the pulse as a share of half their tolerance; NaN without any.

        That of a band is a share of its amplitude; sampling rate and cutoff are none of the pulse.
        """
        shares = [clause.share for clause in self.clauses if clause.unit != "Hz" and math.isfinite(clause.share)]
        if self.placement is not None and limits.band is not None:
            shares.append(self.placement.margin / (limits.band.amplitude * limits.pulse.peak))
        return min(shares, default=math.nan)


def weakest(*statuses: str) -> str:
    """Return the weakest of statuses."""
    return max(statuses, key=STATUSES.index)


def judged(
    name: str,
    value: float,
    limits: Limits,
    unit: str,
    uncertainty: float = 0.0,
    rule: Rule = "simple",
    reason: str = "",
) -> Clause:
    """Return the clause of a value; ``cannot-tell`` where a reason is given why nothing can be said of it."""
    margin = limits.margin(value)
    slack = ROUNDING * max(abs(value), abs(limits.low) if math.isfinite(limits.low) else 0.0)
    verdict = CANNOT_TELL if reason else decide(margin + slack if margin < 0.0 else margin, uncertainty, rule)
    if not reason and verdict == CANNOT_TELL:
        reason = "the uncertainty reaches over the limit" if math.isfinite(value) else "it could not be measured"
        reason = "its uncertainty is not known" if math.isfinite(value) and math.isnan(uncertainty) else reason
    return Clause(name, limits.status, unit, value, limits.low, limits.high, margin, uncertainty, verdict, reason)


def judge_shock(shock: Shock, limits: PulseLimits, rule: Rule = "simple", strict: bool = False) -> ShockVerdict:
    """Judge one shock."""
    pulse = limits.pulse
    peak = shock.figures.get("peak") or MeasuredFigure(refine_peak(shock.values, shock.peak_index)[1])
    first, last = _crossings(shock, limits.level * peak.value)
    width = MeasuredFigure(last - first, math.nan if shock.figures else 0.0)  # known at 10 % alone
    if limits.level == 0.1 and "width" in shock.figures:
        width = shock.figures["width"]
    centre = _start_about(pulse, limits.level, first, last, shock)
    placement = None
    if limits.band is not None:
        placement = limits.band.placed(shock.values, shock.step, shock.begin, centre)
    start = centre if placement is None else placement.start
    coarse = _too_few(shock, pulse)
    clauses: list[Clause] = []
    if limits.peak is not None:
        reason = shock.troubles.get("peak", "") or coarse
        clauses.append(_through_filter(shock, "peak", peak, limits.peak, rule, reason))
    if limits.width is not None:
        name = f"pulse width at {100.0 * limits.level:g} %"
        reason = shock.troubles.get("width", "") or coarse or _filtered_away(shock)
        clauses.append(_width_clause(shock, name, width, limits.width, rule, reason))
    if limits.velocity_change is not None:
        clauses.append(_velocity_clause(shock, limits, start, rule, coarse))
    if limits.band is not None and placement is not None:
        clauses.append(_band_clause(shock, limits, placement, peak, rule, coarse))
    if limits.cross_axis is not None:
        clauses.append(_cross_clause(shock, limits.cross_axis, pulse, start, rule))
    for name, value, demand, why in (
        ("sampling rate", 1.0 / shock.step, limits.rate, "the record is sampled too slowly"),
        ("filter", shock.filter_cutoff, limits.cutoff, "the filter is too low"),
    ):
        if demand is not None and math.isfinite(value):  # what does not meet a demand qualifies nothing
            clause = judged(name, value, demand, "Hz")
            clauses.append(replace(clause, verdict=CANNOT_TELL, reason=why) if clause.verdict == FAIL else clause)
    if strict:
        clauses = [refused(clause) for clause in clauses]
    return ShockVerdict(tuple(clauses), start, placement)


def not_judged(name: str, limits: Limits, unit: str, reason: str) -> Clause:
    """Return the clause of what only the user can say, and did not."""
    nothing = math.nan
    return Clause(name, limits.status, unit, nothing, limits.low, limits.high, nothing, nothing, NOT_JUDGED, reason)


def refused(clause: Clause) -> Clause:
    """Return a clause by which nothing is stated where its limit is indicative."""
    if clause.status != INDICATIVE or clause.verdict == NOT_JUDGED:
        return clause
    return replace(clause, verdict=CANNOT_TELL, reason="its limit is indicative (--strict)")


def _crossings(shock: Shock, level: float) -> tuple[float, float]:
    """Return when a shock crosses a level before and after its peak, s; NaN where it does not."""
    places = (crossing(shock.values, shock.peak_index, level, side) for side in (-1, 1))
    first, last = (shock.begin + shock.step * place for place in places)
    return first, last


def _start_about(pulse: IdealPulse, level: float, first: float, last: float, shock: Shock) -> float:
    """Return where the ideal pulse begins if the middles of both widths agree; else by the peak."""
    if math.isfinite(first) and math.isfinite(last):
        low, high = pulse.top
        begin = pulse.width(0.0) - pulse.width(level)
        share = low / (low + pulse.duration - high) if low + pulse.duration > high else 0.5
        middle = begin * share + 0.5 * pulse.width(level)
        return 0.5 * (first + last) - middle
    return shock.begin + shock.step * shock.peak_index - 0.5 * sum(pulse.top)


def _too_few(shock: Shock, pulse: IdealPulse) -> str:
    """Return why the sampling is too coarse for a shape, where it is."""
    count = pulse.duration / shock.step
    return "" if count >= FEWEST_INTERVALS else f"{count:.1f} samples a pulse; it takes {FEWEST_INTERVALS:g}"


def _filtered_away(shock: Shock) -> str:
    """Return why a filter leaves nothing to be stated of a pulse width, where it takes more than a tenth of a peak."""
    left = shock.filter_left
    return "" if left >= 0.9 else f"the filter leaves {percent(left, 0)} of the peak of the ideal pulse"


def _relative(shock: Shock, figure: MeasuredFigure) -> float:
    """Return the expanded uncertainty of a figure that grows with the acceleration.

    That of the acceleration, where it is stated, stands alone where that of the figure is not known; NaN without both.
    """
    if figure.whole:
        return COVERAGE * figure.uncertainty
    own = 0.0 if math.isnan(figure.uncertainty) and shock.uncertainty > 0.0 else figure.uncertainty
    return math.hypot(COVERAGE * own, shock.uncertainty * abs(figure.value))


def _through_filter(shock: Shock, name: str, figure: MeasuredFigure, limits: Limits, rule: Rule, reason: str) -> Clause:
    """Return the clause of a peak of which a filter may have taken a part: both peaks must have the same verdict."""
    clause = judged(name, figure.value, limits, "m/s^2", _relative(shock, figure), rule, reason)
    unfiltered_peak = figure.value / shock.filter_left if shock.filter_left > 0.0 else math.inf
    unfiltered = judged(name, unfiltered_peak, limits, "m/s^2", _relative(shock, figure), rule, reason)
    if not reason and unfiltered.verdict != clause.verdict:
        words = f"the filter leaves {percent(shock.filter_left)} of the peak of the ideal pulse"
        return replace(clause, verdict=CANNOT_TELL, reason=words)
    return clause


def _width_clause(shock: Shock, name: str, width: MeasuredFigure, limits: Limits, rule: Rule, reason: str) -> Clause:
    """Return the clause of a pulse width that a filter may have changed: both widths must have the same verdict."""
    doubt = COVERAGE * width.uncertainty
    clause = judged(name, width.value, limits, "s", doubt, rule, reason)
    without = judged(name, width.value / shock.filter_width, limits, "s", doubt, rule, reason)
    if not reason and without.verdict != clause.verdict:
        words = f"the filter alone makes the width {percent(shock.filter_width)} of that of the pulse without it"
        return replace(clause, verdict=CANNOT_TELL, reason=words)
    return clause


def _velocity_clause(shock: Shock, limits: PulseLimits, start: float, rule: Rule, coarse: str) -> Clause:
    """Return the clause of the velocity change: the integral over the ideal pulse and a little more."""
    pulse, (before, after) = limits.pulse, limits.window
    first, last = start - before * pulse.duration, start + (1.0 + after) * pulse.duration
    value = area_between(shock, first, last)
    reason = shock.troubles.get("velocity_change", "") or coarse
    if not reason and math.isnan(value):
        reason = "the record does not hold all of it"
    known = shock.figures.get("velocity_change", MeasuredFigure(value))
    assert limits.velocity_change is not None
    uncertainty = _relative(shock, known._replace(value=value))
    return judged("velocity change", value, limits.velocity_change, "m/s", uncertainty, rule, reason)


def area_between(shock: Shock, first: float, last: float) -> float:
    """Return the integral of a record from one time to another, s; NaN where it does not reach that far."""
    time = shock.time
    slack = 1e-9 * (last - first)
    if first < time[0] - slack or last > time[-1] + slack:
        return math.nan
    inside = time[(time > first) & (time < last)]
    grid = np.concatenate([[first], inside, [last]])
    return float(np.trapezoid(np.interp(grid, time, shock.values), grid))


def _band_clause(
    shock: Shock, limits: PulseLimits, placement: Placement, peak: MeasuredFigure, rule: Rule, coarse: str
) -> Clause:
    """Return the clause of the band: the smallest distance to it, as it lies best."""
    uncertainty = _relative(shock, peak)
    reason = coarse or shock.troubles.get("peak", "") or shock.troubles.get("width", "")
    within = Limits(0.0, math.inf, weakest(limits.band_status, limits.status))
    clause = judged("band", placement.margin, within, "m/s^2", uncertainty, rule, reason)
    if reason:
        return clause
    taken = (1.0 / shock.filter_left - 1.0) * peak.value if shock.filter_left > 0.0 else math.inf
    guard = uncertainty if rule == "guarded" else 0.0
    if clause.verdict != CANNOT_TELL and taken > abs(placement.margin) - guard:
        words = f"the filter leaves {percent(shock.filter_left)} of the peak of the ideal pulse"
        return replace(clause, verdict=CANNOT_TELL, reason=words)
    lacks = [
        f"{lack:.2g} durations {side} the pulse"
        for lack, side in ((placement.before, "before"), (placement.after, "after"))
        if lack > shock.step / limits.pulse.duration
    ]
    if clause.verdict == PASS and lacks:
        return replace(clause, verdict=CANNOT_TELL, reason=f"the record lacks {' and '.join(lacks)}")
    if clause.verdict == FAIL:
        share = (placement.time - placement.start) / limits.pulse.duration
        side = "above the upper" if placement.above else "below the lower"
        return replace(clause, reason=f"{side} curve {share:.2f} durations after the begin of the ideal pulse")
    return clause


def _cross_clause(shock: Shock, limits: Limits, pulse: IdealPulse, start: float, rule: Rule) -> Clause:
    """Return the clause of the cross-axis acceleration, the largest to either side while the pulse lasts."""
    if not shock.cross_axis:
        reason = "no cross-axis channel is named (--cross-axis)"
        return not_judged("cross-axis", limits._replace(low=math.nan), "m/s^2", reason)
    time = shock.time
    inside = (time >= start - 0.1 * pulse.duration) & (time <= start + 1.1 * pulse.duration)
    largest = float(np.max([np.max(np.abs(values[inside]), initial=0.0) for values in shock.cross_axis.values()]))
    uncertainty = _relative(shock, MeasuredFigure(largest, shock.cross_axis_noise))
    clause = judged("cross-axis", largest, limits, "m/s^2", uncertainty, rule)
    trouble = shock.troubles.get("cross_axis", "")
    return replace(clause, verdict=CANNOT_TELL, reason=trouble) if trouble and clause.verdict == PASS else clause


def worst_clauses(shocks: Sequence[ShockVerdict]) -> list[tuple[Clause, int]]:
    """Return each clause where it came out worst, with the place of that shock: fails first, then the least margin."""
    order = {FAIL: 0, CANNOT_TELL: 1, NOT_JUDGED: 2, PASS: 3}
    rows: dict[str, tuple[Clause, int]] = {}
    for place, shock in enumerate(shocks):
        for clause in shock.clauses:
            known = rows.get(clause.clause)
            if known is None or _rank(clause, order) < _rank(known[0], order):
                rows[clause.clause] = (clause, place)
    return list(rows.values())


def _rank(clause: Clause, order: Mapping[str, int]) -> tuple[int, float]:
    return order[clause.verdict], clause.share if math.isfinite(clause.share) else clause.margin


class DecibelBand(NamedTuple):
    """Tolerance of a spectrum within frequencies, dB about the nominal one."""

    first: float
    last: float
    low: float
    high: float
    status: str


@dataclass(frozen=True)
class SpectrumLimits:
    """Limits of a specification for a spectrum, in SI."""

    # Breakpoints, Hz and the unit of the kind; straight lines between them on logarithmic axes
    frequency: tuple[float, ...]
    level: tuple[float, ...]
    status: str  # status of the breakpoints
    q: float  # the spectrum that is meant
    kind: str
    side: str
    per_octave: float
    bands: tuple[DecibelBand, ...]  # tolerances
    share: Limits  # share of the natural frequencies, evenly spread in octaves, that must lie within them
    share_above: Limits | None = None  # share that must reach the nominal level

    def nominal(self, frequency: ArrayLike) -> Array:
        """Return the nominal spectrum at natural frequencies, Hz."""
        return np.exp(np.interp(np.log(frequency), np.log(self.frequency), np.log(self.level)))

    def grid(self) -> Array:
        """Return the natural frequencies at which it is judged, Hz: evenly in octaves, both ends included."""
        octaves = math.log2(self.frequency[-1] / self.frequency[0])
        return np.geomspace(self.frequency[0], self.frequency[-1], max(math.ceil(octaves * self.per_octave) + 1, 2))

    def curves(self, frequency: Array) -> tuple[Array, Array]:
        """Return the lower and the upper limit at natural frequencies, Hz; NaN where no tolerance is stated."""
        low, high = np.full(frequency.shape, np.nan), np.full(frequency.shape, np.nan)
        for band in self.bands:
            inside = (frequency >= band.first * (1.0 - 1e-9)) & (frequency <= band.last * (1.0 + 1e-9))
            low[inside], high[inside] = band.low, band.high
        nominal = self.nominal(frequency)
        return nominal * 10.0 ** (low / 20.0), nominal * 10.0 ** (high / 20.0)


def judge_spectrum(
    frequency: Array,
    values: Array,
    limits: SpectrumLimits,
    uncertainty: float | Array = 0.0,
    rule: Rule = "simple",
    strict: bool = False,
    trouble: str = "",
) -> tuple[Clause, ...]:
    """Judge a spectrum.

    With a guarded decision the spectrum passes if it does so wherever between up and down by its uncertainty it is
    moved as a whole, and fails if it passes nowhere.
    """
    low, high = limits.curves(frequency)
    nominal = limits.nominal(frequency)
    reach = np.broadcast_to(np.asarray(uncertainty, dtype=np.float64), values.shape)
    guarded = rule == "guarded"
    if guarded and not trouble and np.any(np.isnan(reach)):
        trouble = "its uncertainty is not known"
    statuses = [band.status for band in limits.bands]
    worst = _worst(frequency, values, low, high)
    status = weakest(limits.status, limits.share.status, *statuses)
    known = np.isfinite(low)
    within = _shares(values[known], low[known], high[known], reach[known])
    clauses = [_share("share within the tolerance", within, limits.share, status, trouble, worst, guarded)]
    if limits.share_above is not None:
        status = weakest(limits.status, limits.share_above.status)
        above = _shares(values, nominal, np.full(values.shape, math.inf), reach)
        clauses.append(_share("share at or above nominal", above, limits.share_above, status, trouble, "", guarded))
    return tuple(refused(clause) for clause in clauses) if strict else tuple(clauses)


def _worst(frequency: Array, values: Array, low: Array, high: Array) -> str:
    """Return where a spectrum is farthest outside, in words; empty where it is nowhere."""
    with np.errstate(divide="ignore", invalid="ignore"):
        out = np.fmax(20.0 * np.log10(values / high), 20.0 * np.log10(low / values))
    known = np.flatnonzero(np.isfinite(out))
    if not known.size or out[known].max() <= 0.0:
        return ""
    k = int(known[np.argmax(out[known])])
    side = "above" if values[k] > high[k] else "below"
    return f"{out[k]:.2g} dB {side} the tolerance at {frequency[k]:.4g}\xa0Hz"


LEAST = 1e-12  # uncertainty that is taken at least, so that nothing is divided by zero


class _Shares(NamedTuple):
    """Share of a spectrum within its limits: as measured, and the smallest and largest within its uncertainty."""

    measured: float
    least: float
    most: float


def _shares(values: Array, low: Array, high: Array, uncertainty: Array) -> _Shares:
    """Return the share of values within limits, as they are and moved as a whole; NaN where there is none.

    Moved by t from -1 to 1 a value is (1 + U)^t times as large, and lies within from t = ln(low / value) / ln(1 + U) to
    ln(high / value) / ln(1 + U): between two such edges, and from the last to -1 or 1, no share changes.
    """
    if not values.size or not np.all(np.isfinite(values)):
        return _Shares(math.nan, math.nan, math.nan)
    with np.errstate(divide="ignore"):
        room = np.log1p(np.maximum(np.nan_to_num(uncertainty), LEAST))
        first = np.sort((np.log(low / values) - ROUNDING) / room)
        last = np.sort((np.log(high / values) + ROUNDING) / room)
    edges = np.unique(np.clip(np.concatenate([first, last, [-1.0, 0.0, 1.0]]), -1.0, 1.0))
    moves = np.concatenate([[0.0], edges, 0.5 * (edges[1:] + edges[:-1])])
    begun = np.searchsorted(first, moves, "right")
    shares = (begun - np.searchsorted(last, moves, "left")) / values.size
    return _Shares(float(shares[0]), float(shares.min()), float(shares.max()))


def _share(name: str, shares: _Shares, limits: Limits, status: str, trouble: str, worst: str, guarded: bool) -> Clause:
    """Return the clause of a share, which must be enough wherever the spectrum is moved to."""
    enough = limits.low - 1e-12
    reason = trouble or worst
    if trouble or math.isnan(shares.measured):
        verdict = CANNOT_TELL
        reason = trouble or "no tolerance is stated at its natural frequencies, or it could not be measured"
    elif (shares.least if guarded else shares.measured) >= enough:
        verdict = PASS
    elif (shares.most if guarded else shares.measured) < enough:
        verdict = FAIL
    else:
        verdict = CANNOT_TELL
        reason = "; ".join(filter(None, ["the uncertainty reaches over the limit", worst]))
    margin = shares.measured - limits.low
    reach = max(shares.most - shares.measured, shares.measured - shares.least)
    return Clause(name, status, "1", shares.measured, limits.low, limits.high, margin, reach, verdict, reason)
