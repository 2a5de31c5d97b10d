"""Options that the commands on records share: filters and verdicts, and what they are on a request."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, get_args

import typer

from strikewave.base.errors import InputError
from strikewave.base.units import parse_quantity, take_apart
from strikewave.reporting.options import (
    Decision,
    LowPassOptions,
    Uncertainty,
    budget_in_python,
    cutoff_of,
    low_pass_of,
    parsed,
    quantity,
    wrong_choice,
)
from strikewave.signal.filters import HighPass
from strikewave.specifications.judging import Rule

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from strikewave.analyses.record.verdicts import SpectraJudge
    from strikewave.records import Request
    from strikewave.signal.filters import Filter
    from strikewave.specifications.judged_records import Asked
    from strikewave.specifications.reading import Specification

ALLOWED_HIGH_PASS = 'a cutoff above zero such as "5 Hz"'
ALLOWED_COUPLING = 'auto, a time constant above zero such as "1.6 ms", or a cutoff such as "100 Hz"'


def _time_constant(word: str, field: str) -> str | float:
    """Return the time constant of AC coupling, s, or ``auto``.

    Examples
    --------
    >>> _time_constant("auto", ""), _time_constant("1.6 ms", ""), round(_time_constant("100 Hz", ""), 6)
    ('auto', 0.0016, 0.001592)
    """
    if word.strip() == "auto":
        return "auto"
    typed = take_apart(word)
    unit = "" if typed is None else typed.unit
    try:
        value = parse_quantity(word, "Hz" if "Hz" in unit else "s", field)
    except InputError as error:
        raise InputError(field, word, ALLOWED_COUPLING) from error
    if not 0.0 < value < math.inf:
        raise InputError(field, word, ALLOWED_COUPLING)
    return 1.0 / (2.0 * math.pi * value) if "Hz" in unit else value


@dataclass(frozen=True)
class FilterOptions(LowPassOptions):
    """What is taken off a record, or smoothed, before it is measured."""

    ac_coupling: Annotated[
        str | None,
        parsed(
            "--ac-coupling",
            read=_time_constant,
            help='AC coupling to take off: auto, a time constant such as "1.6 ms", or a cutoff such as "100 Hz"; '
            "none by default.",
            metavar="auto|TIME|FREQUENCY",
        ),
    ] = None
    high_pass: Annotated[
        float | None,
        quantity("--high-pass", si="Hz", help="Zero-phase high-pass, -3 dB for both passes; none by default."),
    ] = None

    def on(self, request: Request) -> Request:
        """Return a request with these filters."""
        high_pass = None if self.high_pass is None else HighPass(self.high_pass)
        coupling = "" if self.ac_coupling is None else self.ac_coupling
        return dataclasses.replace(request, filter=self.low_pass(), ac_coupling=coupling, high_pass=high_pass)


def filtered_folder(usual: str, request: Request) -> str:
    """Return the usual folder of a result: what is filtered gets one of its own beside what is not.

    Examples
    --------
    >>> from strikewave.records import Request
    >>> from strikewave.signal.filters import HighPass
    >>> filtered_folder("srs-a", Request()), filtered_folder("srs-a", Request(high_pass=HighPass(5.0)))
    ('srs-a', 'srs-a-82cd0941')
    """
    filters = (request.filter, request.ac_coupling, request.high_pass)
    return usual + (f"-{hashlib.sha256(repr(filters).encode()).hexdigest()[:8]}" if any(filters) else "")


def filtered(
    request: Request,
    filter: str | float | Filter | None,
    ac_coupling: str | float | None,
    high_pass: str | float | None,
) -> Request:
    """Return a request with the filters that a call names; a bare number is in Hz, of a time constant in s.

    Examples
    --------
    >>> from strikewave.records import Request
    >>> wanted = filtered(Request(), "CFC 1000", "100 Hz", 5.0)
    >>> str(wanted.filter), round(wanted.ac_coupling, 6), wanted.high_pass.cutoff
    ('CFC 1000 (SAE J211)', 0.001592, 5.0)
    """
    word = "" if ac_coupling is None else ac_coupling if isinstance(ac_coupling, str) else f"{ac_coupling} s"
    return dataclasses.replace(
        request,
        filter=low_pass_of(filter),
        ac_coupling="" if ac_coupling is None else _time_constant(word, "ac_coupling"),
        high_pass=None if high_pass is None else HighPass(cutoff_of(high_pass, "high_pass", ALLOWED_HIGH_PASS)),
    )


def complete_specification(incomplete: str) -> list[str]:
    """Return the built-in specifications that begin so, with their conditions."""
    from strikewave.specifications.reading import asked_names

    return [name for name in asked_names() if name.startswith(incomplete)]


@dataclass(frozen=True)
class SpecificationOptions:
    """What is judged by which specification, and how."""

    panel: ClassVar[str] = "Specification"

    spec: Annotated[
        str | None,
        typer.Option(
            "--spec",
            metavar="NAME|FILE[:CONDITION]",
            help="Specification to judge by, see strikewave spec list; none by default.",
            show_default=False,
            autocompletion=complete_specification,
        ),
    ] = None
    decision: Decision = "simple"
    uncertainty: Uncertainty = None
    strict: Annotated[bool, typer.Option("--strict", help="State no verdict by limits that are from memory.")] = False

    @classmethod
    def in_python(
        cls, spec: str | None, decision: Rule, uncertainty: str | float | Path | None, strict: bool, **more: Any
    ) -> Self:
        """Return the options of a call in plain values."""
        if decision not in get_args(Rule):
            raise wrong_choice(decision, "decision", get_args(Rule))
        budget = budget_in_python(uncertainty)
        several = {name: [more[name]] if isinstance(more[name], str | int) else more[name] for name in more}
        lists = {name: [str(one) for one in values] or None for name, values in several.items()}
        return cls(spec, decision, budget, strict, **lists)

    def specification(self) -> Specification | None:
        """Return the specification that is asked for; None for none."""
        from strikewave.specifications.reading import load_specification

        if self.spec is None:
            self._nothing_else()
            return None
        return load_specification(self.spec)

    def spectra_judge(self) -> SpectraJudge | None:
        """Return what spectra are judged by, and how; None for nothing."""
        from strikewave.analyses.record.verdicts import SpectraJudge
        from strikewave.specifications.judged_records import asked_of_spectra

        specification = self.specification()
        if specification is None:
            return None
        return SpectraJudge(specification, asked_of_spectra(self.decision, self.strict, self.uncertainty))

    def _nothing_else(self) -> None:
        """Refuse what makes no sense without a specification."""
        given = [("--decision", self.decision != "simple"), ("--strict", self.strict)]
        for option, is_given in given:
            if is_given:
                raise InputError(option, "no --spec", "only with a specification", "add --spec NAME")


@dataclass(frozen=True)
class RecordSpecificationOptions(SpecificationOptions):
    """The same, with what only the user knows of the shocks of files."""

    direction: Annotated[
        list[str] | None,
        typer.Option(
            "--direction",
            metavar="[FILES][#CHANNEL]=DIRECTION",
            help="Direction of the shocks, such as +x, 'up*.csv=-z' or 'shot.csv#2=+y'; may be repeated.",
            show_default=False,
        ),
    ] = None
    cross_axis: Annotated[
        list[str] | None,
        typer.Option(
            "--cross-axis",
            metavar="[FILES#]CHANNEL",
            help="Channel that measures across the shock, such as y or 'x*.csv#y'; may be repeated.",
            show_default=False,
        ),
    ] = None

    def _nothing_else(self) -> None:
        super()._nothing_else()
        for option, given in (("--direction", self.direction), ("--cross-axis", self.cross_axis)):
            if given:
                raise InputError(option, "no --spec", "only with a specification", "add --spec NAME")

    def asked(self, test: Mapping[str, Any]) -> Asked:
        """Return how records are judged; the direction that a test states holds where no option does."""
        from strikewave.specifications.judged_records import Asked
        from strikewave.specifications.shock_directions import read_direction

        stated = [test["direction"]] if test.get("direction") and not self.direction else []
        words = [("--direction", word) for word in self.direction or ()] + [("test.direction", word) for word in stated]
        directions = [read_direction(word, option) for option, word in words]
        return Asked(self.decision, self.strict, self.uncertainty, directions, tuple(self.cross_axis or ()))
