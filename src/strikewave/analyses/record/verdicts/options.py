"""The options of a verdict, which ``record`` and ``srs`` take."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, get_args

import typer

from strikewave.base.errors import InputError
from strikewave.reporting.options import Decision, Uncertainty, budget_in_python, wrong_choice
from strikewave.specifications.judging import Rule

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from strikewave.analyses.record.verdicts.judged_spectra import SpectraJudge
    from strikewave.specifications.judged_records import Asked
    from strikewave.specifications.reading import Specification


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
        """Return the options of a call in plain values.

        Raises
        ------
        InputError
            If one is none that it can be.
        """
        if decision not in get_args(Rule):
            raise wrong_choice(decision, "decision", get_args(Rule))
        budget = budget_in_python(uncertainty)
        several = {name: [more[name]] if isinstance(more[name], str | int) else more[name] for name in more}
        lists = {name: [str(one) for one in values] or None for name, values in several.items()}
        return cls(spec, decision, budget, strict, **lists)

    def specification(self) -> Specification | None:
        """Return the specification that is asked for; None for none.

        Raises
        ------
        InputError
            If it cannot be used, or is not named and something else of it is asked for.
        """
        from strikewave.specifications.reading import load_specification

        if self.spec is None:
            self._nothing_else()
            return None
        return load_specification(self.spec)

    def spectra_judge(self) -> SpectraJudge | None:
        """Return what spectra are judged by, and how; None for nothing."""
        from strikewave.analyses.record.verdicts.judged_spectra import SpectraJudge
        from strikewave.specifications.judged_records import asked_of_spectra

        specification = self.specification()
        if specification is None:
            return None
        return SpectraJudge(specification, asked_of_spectra(self.decision, self.strict, self.uncertainty))

    def _nothing_else(self) -> None:
        """Refuse what makes no sense without a specification."""
        given = [
            ("--decision", self.decision != "simple"),
            ("--strict", self.strict),
        ]
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
