"""Verdicts on records and on spectra by a specification."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.clauses import clause_columns, clause_words, decision_words, verdict_words, why_column
from strikewave.analyses.record.spectrum import SpectraAsked, SpectrumResult
from strikewave.base.declare import KEY
from strikewave.base.errors import InputError
from strikewave.base.result import FAILED, WARNING, Notice
from strikewave.records.budget import Budget
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.numbers import listed
from strikewave.reporting.options import Typed
from strikewave.reporting.parts import Picture, Section
from strikewave.reporting.terminal import print_rows, tell
from strikewave.specifications.judged_records import (
    Asked,
    JudgedSpectrum,
    SpectraVerdict,
    asked_of_spectra,
    judge_records,
)
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS, Clause, judge_spectrum
from strikewave.specifications.reading import Specification

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strikewave.analyses.record.result import RecordResult
    from strikewave.reporting.measured_files import SpectraJudging


def with_verdict(result: RecordResult, specification: Specification, asked: Asked) -> RecordResult:
    """Return the result of records with the verdict by a specification; a fail is a failed check."""
    verdict = judge_records(result.readings, specification, asked, result.filter)
    notices = verdict_notices(
        specification.title, verdict.verdict, verdict.by_indicative, [one for one, _ in verdict.clauses]
    )
    citations = ("jcgm-106", "iso-14253-1") if asked.rule == "guarded" else ()
    return dataclasses.replace(
        result, verdict=verdict, notices=(*result.notices, *notices), citations=(*result.citations, *citations)
    )


def verdict_notices(title: str, verdict: str, by_indicative: bool, clauses: list[Clause]) -> list[Notice]:
    """Return the notice of a verdict that is no pass."""
    if verdict not in (FAIL, CANNOT_TELL):
        return []
    names = listed(list(dict.fromkeys(clause.clause for clause in clauses if clause.verdict == verdict)))
    message = f"{verdict_words(verdict, by_indicative)} by {title}: {names or 'nothing could be judged'}"
    return [Notice("specification", message, severity=FAILED if verdict == FAIL else WARNING)]


Array = NDArray[np.float64]

FIXES = "the specification fixes it: leave it out"


@dataclass(frozen=True)
class SpectraJudge:
    """Judge of spectra: a specification, and how it is applied."""

    specification: Specification
    asked: Asked

    def wanted(self, asked: SpectraAsked) -> SpectraAsked:
        """Return what spectra are computed: those that the specification means, as far as sampling carries them."""
        limits = self.specification.spectrum_limits()
        first, last = limits.frequency[0], limits.frequency[-1]
        request, stated = asked.spectra, cast("Sequence[Typed]", asked.spectra.frequencies)
        if stated:
            raise InputError("--frequency", stated[0].word, "none with --spec", FIXES)
        rows: tuple[tuple[str, Any, Any, Any], ...] = (
            ("--kind", ", ".join(request.each_kind), "", limits.kind),
            ("--q", request.q, 10.0, limits.q),
            ("--from", request.low, 10.0, first),
            ("--to", request.high, None, last),
            ("--per-octave", request.per_octave, 12.0, limits.per_octave),
            ("--side", request.side, "maximax", limits.side),
            ("--part", request.part, "total", "total"),
        )
        for option, value, usual, wanted in rows:
            is_typed = isinstance(value, Typed) or value != usual
            same = value == wanted if isinstance(wanted, str) else value is not None and math.isclose(value, wanted)
            if is_typed and not same:
                allowed = wanted if isinstance(wanted, str) else f"{wanted:g}{' Hz' * (option in ('--from', '--to'))}"
                raise InputError(option, getattr(value, "word", value), f"{allowed} with this --spec", FIXES)
        fixed: dict[str, Any] = {"q": limits.q, "per_octave": limits.per_octave, "side": limits.side, "high": None}
        spectra = dataclasses.replace(request, low=Typed(first, f"{first:g} Hz"), **fixed)
        budget = Budget(()) if self.asked.budget is None and self.asked.from_record else self.asked.budget
        return dataclasses.replace(asked, spectra=spectra, budget=budget, own_range=True)

    def judged(self, result: SpectrumResult) -> SpectrumResult:
        """Return a result with its verdict; a fail is a failed check."""
        if result.reading.channel.unit != "m/s^2":
            unit = result.reading.channel.unit or "no known unit"
            raise InputError("--spec", unit, "records of an acceleration", "state the unit, such as --unit g")
        limits, side = self.specification.spectrum_limits(), result.side
        spectra = []
        for shock in result.channels:
            one, known = shock.judged or shock.found.spectra[0], shock.found.uncertainties
            frequency = np.asarray(one.frequency, dtype=np.float64)
            short = frequency[-1] < limits.frequency[-1] * 2.0 ** (-1.0 / limits.per_octave)
            lacks = f"its sampling rate carries natural frequencies up to {frequency[-1]:.4g}\xa0Hz" if short else ""
            inside = frequency <= limits.frequency[-1] * (1.0 + 1e-9)
            values = (frequency[inside], one.side(side)[inside])
            share = known[0].expanded[inside] / values[1] if known else math.nan
            found = judge_spectrum(*values, limits, share, self.asked.rule, self.asked.strict, shock.harmed or lacks)
            spectra.append(JudgedSpectrum(shock.name, shock.file, shock.channel, *values, found))
        verdict = SpectraVerdict(self.specification, limits, self.asked, tuple(spectra))
        notices = verdict_notices(self.specification.title, verdict.verdict, verdict.by_indicative, verdict.clauses)
        return dataclasses.replace(result, verdict=verdict, notices=(*result.notices, *notices))


def spectra_judge(judging: SpectraJudging, specification: Specification | None) -> SpectraJudge | None:
    """Return what judges spectra; None where no specification does."""
    if specification is None:
        return None
    return SpectraJudge(specification, asked_of_spectra(judging.decision, judging.strict, judging.uncertainty))


def spectra_sentence(verdict: SpectraVerdict) -> str:
    """Say what the verdict is, by what, and why."""
    count = len(verdict.spectra)
    many = "one spectrum" if count == 1 else f"{count} spectra"
    title = f"{verdict.specification.title} ({verdict.specification.file.edition})"
    words = [f"{verdict_words(verdict.verdict, verdict.by_indicative)}: {many} by {title}."]
    wrong = [
        (spectrum, clause)
        for spectrum in verdict.spectra
        for clause in spectrum.clauses
        if clause.verdict in (FAIL, CANNOT_TELL)
    ]
    for spectrum, clause in [pair for pair in wrong if pair[1].verdict == verdict.verdict][:3]:
        where = f"{spectrum.name}: " if count > 1 else ""
        words.append(f"{where}{clause_words(clause)}.")
    left = [spectrum.name for spectrum in verdict.spectra if spectrum.verdict == PASS]
    if count > 1 and left:
        words.append(f"{listed(left[:3])}{' and others' * (len(left) > 3)} pass.")
    return " ".join(words)


def print_spectra_verdict(verdict: SpectraVerdict) -> None:
    """Print the clauses of each spectrum."""
    print_rows(f"By {verdict.specification.title}", _columns(verdict))
    tell(decision_words(verdict.asked.rule, verdict.asked.holds, verdict.asked.not_stated))
    for spectrum in verdict.spectra:
        for clause in spectrum.clauses:
            if clause.reason:
                tell(f"{spectrum.name}, {clause.clause}: {clause.reason}", "  ")


def _columns(verdict: SpectraVerdict) -> list[Column]:
    named: dict[Any, str] = {(one.file, one.channel): one.name for one in verdict.spectra}
    names = [named[one.file, one.channel] for one in verdict.clauses]
    columns = [one for one in clause_columns(verdict.clauses) if one.name != "of tolerance"]
    return [Column("spectrum", names, priority=KEY, words=True), *columns]


def spectra_section(verdict: SpectraVerdict) -> Section:
    """Return the chapter of a verdict on spectra: the tolerance with the spectra over it, and the clauses."""
    from strikewave.analyses.record.figures.verdicts import spectrum_limits_figure

    drawn = [(spectrum.name, spectrum.frequency, spectrum.values, spectrum.verdict) for spectrum in verdict.spectra]
    file = verdict.specification.file
    text = (
        f"Q = {verdict.limits.q:g}, {verdict.limits.side}, {verdict.limits.per_octave:g} natural frequencies an "
        f"octave. Source: {file.source}." + (f" {' '.join(file.note.split())}" if file.note else "")
    )
    text = f"{decision_words(verdict.asked.rule, verdict.asked.holds, verdict.asked.not_stated)} {text}"
    picture = Picture(
        spectrum_limits_figure(verdict.limits, drawn, verdict.specification.title), "Spectra and tolerance."
    )
    table = page_table("Clauses", [*_columns(verdict), why_column(verdict.clauses)])
    return Section("Verdict by the specification", text, [picture, table])
