"""Two histories compared: for the command, and in plain values for Python."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.analyses.clauses import budget_notices
from strikewave.analyses.compare.agreement import (
    LOST,
    PREFIX,
    QUANTITIES,
    RULES,
    ComparedCurve,
    CurveAgreement,
    SpecificationVerdict,
    agreement,
    checked_curve,
    judged_by,
    shift_to_gap,
    specified_curve,
    verdict_notices,
)
from strikewave.analyses.compare.limits import DEVIATIONS, ComparisonLimit, Scoring, judge, limit_notices, read_limit
from strikewave.analyses.compare.result import CompareResult
from strikewave.analyses.compare.sources import SourceName, SourceOptions, is_simulated, parse_name, read_source
from strikewave.base.errors import InputError
from strikewave.base.result import INFO, Notice, Result, Source, Verdicts
from strikewave.base.shock_quantities import usual_unit
from strikewave.base.texts import percent
from strikewave.records.ringing import FEWEST_AFTER, RINGS_WITHIN, strongest_frequency
from strikewave.records.thresholds import OfRingingSought
from strikewave.reporting import measured_files as measured
from strikewave.reporting.numbers import listed
from strikewave.reporting.options import low_pass_of, wrong_choice
from strikewave.signal.alignment import are_opposite
from strikewave.signal.filters import Filter
from strikewave.signal.pulse import measure_pulse
from strikewave.specifications.judging import Rule

MEASURED = ("record", "campaign")  # kinds of histories that were measured
ALIGNMENTS = (*RULES, "none")  # rules by which B is shifted
SHIFTS_APART = 3.0  # standard uncertainties by which two shifts differ that are not one: noise alone does that in 0.3 %
# Shares by which frequency and size of what rings after a blow may differ in a record and in the run of its machine for
# both to be one motion: a run with assumed masses and stiffnesses is no better, and a mount rings elsewhere
SAME_RING, SAME_SWING = 0.1, 0.25

# Argument in Python: a name, or a solution of run, wave or fem, alone or with the name of its part
Compared = str | Path | Result | tuple[Result, str]


@dataclasses.dataclass(frozen=True)
class CompareRequest:
    """Request for a comparison, without the names of the two."""

    reading: SourceOptions = dataclasses.field(default_factory=SourceOptions)
    align: str = "correlation"
    factor: float = DEVIATIONS
    between: tuple[float | None, float | None] = (None, None)
    limits: tuple[ComparisonLimit, ...] = ()
    decision: Rule = "simple"

    @classmethod
    def of(
        cls,
        align: str,
        limits: Sequence[ComparisonLimit],
        scoring: Scoring,
        judging: measured.DecisionOptions,
        measurement: measured.MeasurementOptions,
        low_pass: Filter | None,
    ) -> CompareRequest:
        """Return what the options say."""
        stated, options = measurement.calibration(), measurement.reading()
        reading = SourceOptions(stated, options, low_pass, scoring.band, judging.uncertainty)
        between = (scoring.begin, scoring.end)
        return cls(reading, align, scoring.deviations, between, tuple(limits), judging.decision)


@measured.with_groups(calibration=measured.Calibration, scoring=Scoring, judging=measured.Judging)
def compare(
    a: Compared,
    b: Compared,
    *,
    align: str = "correlation",
    filter: str | float | Filter | None = None,
    limits: Sequence[str] = (),
    unit: Any = None,
    rate: str | float | None = None,
    calibration: measured.Calibration | None = None,
    scoring: Scoring | None = None,
    judging: measured.Judging | None = None,
) -> CompareResult:
    """Hold one history against another: measured, simulated, or the corridor of a campaign.

    It is what ``strikewave compare`` does; see docs/compare.md for what a name can stand for.

    Parameters
    ----------
    a, b : str, Path, Result or (Result, str)
        The reference, and what is held against it: ``FILE#CHANNEL``, a pattern or a folder of measured files,
        ``CASE:PART``, or the folder of a result; ``@N`` behind it takes blow N. Or a solution of `run_case`, `run_wave`
        or `run_fem`, alone or with a part: ``(solution, "sensor@2")``.
    align : str, optional
        ``correlation``, ``onset``, ``peak`` or ``none``.
    filter : str, float or Filter, optional
        Zero-phase low-pass that both go through: its cutoff, with a unit or in Hz, ``"CFC 1000"``, or a filter.
    limits : sequence of str, optional
        Such as ``"iso18571 > 0.8"`` or ``"peak < 5 %"``.
    unit : str or mapping, optional
        Unit of the values of measured files.
    rate : str or float, optional
        Sampling rate of files without a time column.
    calibration : Calibration, optional
        Sensitivity, gain, bridge voltages and polarity of measured files.
    scoring : Scoring, optional
        Interval, corridor and band in which they are judged.
    judging : Judging, optional
        Decision rule by which A is judged by a specification, and the uncertainty of what was measured.

    Returns
    -------
    CompareResult
        Both histories over one clock, their differences, ISO 18571 scores and the verdict.

    Raises
    ------
    InputError, StrikewaveError
        If one cannot be read, or the two cannot be compared.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> import strikewave
    >>> time = np.arange(2000) * 1e-6
    >>> def shot(at, size):
    ...     return size * np.exp(-(((time - at) / 5e-5) ** 2))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     for name, values in (("a.csv", shot(1e-3, 500.0)), ("b.csv", shot(1.02e-3, 510.0))):
    ...         table = np.column_stack([time, values])
    ...         np.savetxt(f"{folder}/{name}", table, delimiter=",", header="time (s),frame (g)", comments="")
    ...     found = strikewave.compare(f"{folder}/a.csv", f"{folder}/b.csv", limits=["peak < 5 %"])
    >>> found.verdict, round(found.figures["peak"].difference, 4), round(found.agreement.shift.shift * 1e6, 3)
    ('pass', 0.02, -20.0)
    """
    if align not in ALIGNMENTS:
        raise wrong_choice(align, "align", ALIGNMENTS)
    judging = judging or measured.Judging()
    judging.check_only(measured.DecisionOptions, "compare")
    request = CompareRequest.of(
        align,
        [read_limit(word, "limits") for word in limits],
        scoring or Scoring(),
        judging,
        measured.MeasurementOptions.of(None, unit, rate, calibration),
        low_pass_of(filter),
    )
    origin = measured.source_in_python(f"{_called(a)} and {_called(b)}", judging.performed)
    origin = dataclasses.replace(origin, kind="comparison")
    return compared(a, b, request, origin)


def _called(one: Compared) -> str:
    """Return what a side is called."""
    if isinstance(one, tuple):
        return f"{_called(one[0])}:{one[1]}"
    return one.source.name if isinstance(one, Result) else str(one)


def compared(a: Compared, b: Compared, request: CompareRequest, origin: Source) -> CompareResult:
    """Read both and return how well they agree.

    A measured history is read first, so that of a part of a simulation the same quantity is taken.
    """
    if str(a).startswith(PREFIX):
        raise InputError("A", str(a), "a history", "name the specification second: it is what A is held against")
    specification = None
    if str(b).startswith(PREFIX):
        second, specification = specified_curve("B", str(b))
        second = second.filtered(request.reading.low_pass)
        first = _side("A", a, request.reading, second.unit)
    elif _is_simulated(a) and not _is_simulated(b):
        second = _side("B", b, request.reading)
        first = _side("A", a, request.reading, second.unit)
    else:
        first = _side("A", a, request.reading)
        second = _side("B", b, request.reading, first.unit)
    _check_units(first, second)
    if request.decision != "simple" and specification is None:
        raise InputError("--decision", request.decision, "only with a specification", "name it as B: spec:NAME")
    if request.reading.budget is not None and not any(side.kind in MEASURED for side in (first, second)):
        raise InputError("--uncertainty", "no measured file", "only with a record as A or B", "leave it out")
    if specification is not None and first.kind == "campaign":
        hint = "a mean may keep limits that its shocks do not: strikewave record --spec judges each of them"
        raise InputError("A", first.name, "one blow of a record, or a simulation", hint)
    judged = None
    if specification is not None:
        judged = judged_by(specification, first, request.reading.low_pass, request.decision, request.reading.budget)
    return compared_curves(first, second, request, origin, judged)


def _is_simulated(one: Compared) -> bool:
    return not isinstance(one, str | Path) or is_simulated(str(one))


def _side(option: str, one: Compared, reading: SourceOptions, unit: str = "") -> ComparedCurve:
    """Return the history that a side stands for."""
    if isinstance(one, str | Path):
        return read_source(option, str(one), reading, unit)
    from strikewave.analyses.compare.simulated import solution_curve

    solution, part = one if isinstance(one, tuple) else (one, "")
    name = parse_name(f"solution:{part}") if part else SourceName("solution")
    if not isinstance(solution, Result):
        raise InputError(option, type(solution).__name__, "a name, or a solution of run, wave or fem")
    curve = solution_curve(option, solution, name.part, name.blow, unit)
    return checked_curve(option, curve).filtered(reading.low_pass)


def compared_curves(
    first: ComparedCurve,
    second: ComparedCurve,
    request: CompareRequest,
    origin: Source,
    specified: SpecificationVerdict | None = None,
) -> CompareResult:
    """Return how well two histories agree."""
    begin, end = request.between
    between = None
    if begin is not None or end is not None:
        between = (first.history.start if begin is None else begin, first.history.end if end is None else end)
        if not between[0] < between[1]:
            raise InputError("--to", f"{between[1]:g} s", f"a time after --from, {between[0]:g} s")
    curves = agreement(first, second, request.align, between)
    result = CompareResult(
        first,
        second,
        curves,
        request.align,
        request.reading.low_pass,
        request.factor,
        specified=specified,
        origin=origin,
        citations=("iso-18571", "smallwood-1981", *(("jcgm-100", "jcgm-101") if request.reading.budget else ())),
        budget=request.reading.budget,
        verdicts=Verdicts([one.verdict for one in (first, second) if one.verdict], "simulations"),
    )
    judged = judge(request.limits, result.values, result.expanded)
    failed = () if specified is None else verdict_notices(specified)
    notices = (
        *(() if request.reading.budget is None else budget_notices(request.reading.budget)),
        *failed,
        *limit_notices(judged),
        *_notices(first, second, curves, result),
        *_as_the_run_does(first, second),
        *_as_the_run_does(second, first),
    )
    return dataclasses.replace(result, judged=judged, notices=notices)


def _as_the_run_does(curve: ComparedCurve, other: ComparedCurve) -> list[Notice]:
    """Return the notices of a curve: what rings in a record is the motion of the machine where its run rings alike."""
    rings = [notice for notice in curve.notices if notice.code == "ringing"]
    if not rings or curve.kind == "simulation" or other.kind != "simulation":
        return list(curve.notices)
    (mine, swing), (theirs, its_swing) = _ringing(curve), _ringing(other)
    if not (abs(mine / theirs - 1.0) < SAME_RING and abs(swing / its_swing - 1.0) < SAME_SWING):
        return list(curve.notices)
    message = (
        f"{curve.name} rings at {mine / 1e3:.3g}\xa0kHz, by {percent(swing, 0)} of the peak after the blow, as "
        f"{other.name} does ({theirs / 1e3:.3g}\xa0kHz, {percent(its_swing, 0)}): it is the motion of the machine"
    )
    return [*(one for one in curve.notices if one not in rings), Notice("ringing", message, swing, severity=INFO)]


def _ringing(curve: ComparedCurve) -> tuple[float, float]:
    """Return the frequency of what swings after the largest pulse, Hz, and by which share of its peak; NaN for none."""
    upright, step = curve.sign * curve.history.values, curve.history.step
    pulse = measure_pulse(upright, step, curve.history.start)
    if math.isnan(pulse.width):  # it goes on beyond an end of the history
        return math.nan, math.nan
    begin = round((pulse.time + pulse.width - curve.history.start) / step)
    after = upright[begin : begin + round(RINGS_WITHIN * pulse.width / step)]
    if after.size < FEWEST_AFTER:
        return math.nan, math.nan
    swing = 0.5 * float(np.ptp(after)) / pulse.peak
    frequency = strongest_frequency(after, step, OfRingingSought.LOWEST_RATIO / pulse.width)
    return (frequency, swing) if swing > 0.0 else (math.nan, math.nan)


def _check_units(a: ComparedCurve, b: ComparedCurve) -> None:
    """Refuse two histories of different quantities, or one of an unknown unit beside one in SI."""
    if a.unit == b.unit:
        return
    for one, other in ((a, b), (b, a)):
        if not one.unit:
            usual = usual_unit(other.unit)
            hint = f"{other.name} is in {other.unit}: state --unit, such as {usual}"
            raise InputError("--unit", f"{one.name}, in an unknown unit", "known units, or none of both", hint)
    words = [f"{one.name} in {one.unit} ({QUANTITIES.get(one.unit, 'another quantity')})" for one in (a, b)]
    raise InputError("B", words[1], f"the quantity of A, {words[0]}", "take another channel or part")


def _notices(a: ComparedCurve, b: ComparedCurve, curves: CurveAgreement, result: CompareResult) -> list[Notice]:
    """Return what the user should know of the comparison itself."""
    notices = []
    if are_opposite(a.history, b.history) or a.sign != b.sign:
        files = [one for one in (a, b) if one.measured is not None]
        turned = "--polarity -1 turns the measured one round"
        if len(files) == 2:
            turned = "polarity = -1 under [all] in a file beside one, such as shot.csv.toml, turns that one round"
        notices.append(Notice("polarity", f"A and B have opposite signs, and B is not turned: {turned}"))
    if result.align == "correlation":
        to_gap = shift_to_gap(a, b)
        doubt, apart = math.hypot(to_gap.uncertainty, curves.shift.uncertainty), abs(to_gap.shift - curves.shift.shift)
        if apart > SHIFTS_APART * doubt:  # it depends on frequencies beyond the gap, as pickup in both makes them
            message = (
                f"A and B are coherent at low frequencies and, beyond a gap, again, as a pickup in both makes them: "
                f"the shift by the low ones alone is {1e6 * to_gap.shift:.6g}\xa0us; --filter takes the pickup off both"
            )
            notices.append(Notice("alignment-doubt", message, apart, SHIFTS_APART * doubt))
    if curves.lost > LOST:
        coarse = max(a.history.step, b.history.step)
        message = (
            f"{percent(curves.lost)} of the RMS of the more finely sampled history lies above half the sampling rate "
            f"of the other, {0.5 / coarse:.4g}\xa0Hz, which cannot hold it: --filter takes it off both"
        )
        notices.append(Notice("above-nyquist", message, curves.lost, LOST))
    out = [f"{one.figure} of {one.of}" for one in result.in_bands if not one.inside]
    if out:
        message = f"{listed(out)} outside the band of the simulation".replace("_", " ")
        notices.append(Notice("outside-band", message, float(len(out)), 0.0, INFO))
    return notices
