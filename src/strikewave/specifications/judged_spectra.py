"""Spectra that are judged by a specification, each by itself."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.records.budget import RECORD, SAMPLING, Budget
from strikewave.specifications.decisions import Rule, together
from strikewave.specifications.judged_records import BY_INDICATIVE, VERDICT, Asked, rests_on_indicative
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


def asked_of_spectra(rule: Rule = "simple", strict: bool = False, budget: Budget | None = None) -> Asked:
    """Return how spectra are judged: without a budget uncertainty plays a part in a guarded decision alone."""
    return Asked(rule, strict, budget, from_record=(RECORD, SAMPLING) if rule == "guarded" else ())


@declare.dataclass
class SpectraVerdict:
    """The verdict on spectra, each judged by itself.

    Attributes
    ----------
    limits : SpectrumLimits
        What it asks.
    spectra : tuple of JudgedSpectrum
        In the order of the files.
    """

    specification: Specification = declare.part(Specification, "what they are judged by", inline=True)
    limits: SpectrumLimits
    asked: Asked = declare.part(Asked, "how", inline=True)
    spectra: tuple[JudgedSpectrum, ...]

    @declare.computed(VERDICT)
    def verdict(self) -> str:
        """Of all spectra together."""
        return together(one.verdict for one in self.spectra)

    @declare.computed(BY_INDICATIVE)
    def by_indicative(self) -> bool:
        """Whether the verdict rests on a limit that is from memory."""
        return rests_on_indicative(self.clauses, self.verdict)

    @declare.computed(declare.rows(Clause, "clauses of all spectra"))
    def clauses(self) -> list[Clause]:
        """Clauses of all spectra, with file and channel."""
        return [replace(clause, file=one.file, channel=one.channel) for one in self.spectra for clause in one.clauses]
