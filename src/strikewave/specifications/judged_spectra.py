"""Spectra that are judged by a specification, each by itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.records.budget.contributions import Budget
from strikewave.specifications.decisions import Rule, together
from strikewave.specifications.judged_records import clause_document, rests_on_indicative
from strikewave.specifications.judging import Clause
from strikewave.specifications.reading import Specification
from strikewave.specifications.spectrum_limits import SpectrumLimits

Array = NDArray[np.float64]


class JudgedSpectrum(NamedTuple):
    """A spectrum with its verdict."""

    name: str
    file: str
    channel: str
    frequency: Array
    values: Array
    clauses: tuple[Clause, ...]

    @property
    def verdict(self) -> str:
        """Of its clauses together."""
        return together(clause.verdict for clause in self.clauses)


@dataclass(frozen=True)
class SpectraVerdict:
    """The verdict on spectra, each judged by itself.

    Attributes
    ----------
    specification : Specification
        What they are judged by.
    limits : SpectrumLimits
        What it asks.
    rule, strict, budget
        How they are judged.
    spectra : tuple of JudgedSpectrum
        In the order of the files.
    """

    specification: Specification
    limits: SpectrumLimits
    rule: Rule
    strict: bool
    budget: Budget | None
    spectra: tuple[JudgedSpectrum, ...]

    @property
    def verdict(self) -> str:
        """Of all spectra together."""
        return together(one.verdict for one in self.spectra)

    @property
    def holds(self) -> tuple[str, ...]:
        """Names of the contributions that uncertainties hold; none where they play no part and were not found."""
        return (self.budget or Budget(())).names if self._uncertain else ()

    @property
    def not_stated(self) -> tuple[str, ...]:
        """What is not stated of the channel."""
        return (self.budget or Budget(())).not_stated if self._uncertain else ()

    @property
    def _uncertain(self) -> bool:
        return self.budget is not None or self.rule == "guarded"

    @property
    def clauses(self) -> list[Clause]:
        """Clauses of all spectra."""
        return [clause for one in self.spectra for clause in one.clauses]

    @property
    def by_indicative(self) -> bool:
        """Whether the verdict rests on a limit that is from memory."""
        return rests_on_indicative(self.clauses, self.verdict)

    def document(self) -> dict[str, Any]:
        """Return the entry of the JSON document, in SI."""
        rows = [
            {**clause_document(clause), "file": one.file, "channel": one.channel}
            for one in self.spectra
            for clause in one.clauses
        ]
        return {
            **self.specification.document(),
            "decision": self.rule,
            "strict": self.strict,
            "uncertainty": 0.0 if self.budget is None else self.budget.share,
            "uncertainty_holds": list(self.holds),
            "uncertainty_not_stated": list(self.not_stated),
            "verdict": self.verdict,
            "by_indicative_limits": self.by_indicative,
            "clauses": rows,
        }
