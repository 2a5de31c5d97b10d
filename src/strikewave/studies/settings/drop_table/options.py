"""The options of a drop table, which ``settings --spec`` takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from strikewave.reporting.options.kinds import quantity

if TYPE_CHECKING:
    from strikewave.studies.settings.drop_table.study import DropChoices


@dataclass(frozen=True)
class DropOptions:
    """What is tried of a drop table, and how high it falls."""

    panel: ClassVar[str] = "Drop table (with --spec)"

    programmer: Annotated[
        list[str] | None,
        typer.Option(
            "--programmer",
            metavar="NAME[,KEY=VALUE]",
            help=(
                "Programmer: linear, a cushion law or a material, such as 'felt, stress=20 MPa, exponent=2.5, "
                "retardation=20 us'; linear, two rubbers and a felt by default; may be repeated."
            ),
            show_default=False,
        ),
    ] = None
    diameter: Annotated[
        list[float] | None,
        quantity(
            "--diameter",
            si="m",
            bare=False,
            help="Diameter of a pad; 50, 75, 100, 150, 200 and 300 mm by default; may be repeated.",
        ),
    ] = None
    table_mass: Annotated[
        list[float] | None,
        quantity(
            "--table-mass",
            si="kg",
            bare=False,
            help="Mass of the table with its load; that of the case by default; may be repeated.",
        ),
    ] = None
    stroke: Annotated[
        float | None,
        quantity("--stroke", si="m", bare=False, help="Largest drop height; 2 m by default."),
    ] = None

    def given(self) -> dict[str, object]:
        """Return the options that were given, by name."""
        named = {
            "--programmer": self.programmer,
            "--diameter": self.diameter,
            "--table-mass": self.table_mass,
            "--stroke": self.stroke,
        }
        return {option: value for option, value in named.items() if value}

    def choices(self) -> DropChoices:
        """Return what is tried.

        Raises
        ------
        InputError
            If a programmer is none.
        """
        from strikewave.studies.settings.drop_table.programmers import read_programmer
        from strikewave.studies.settings.drop_table.study import DropChoices

        programmers = tuple(read_programmer(word) for word in dict.fromkeys(self.programmer or ()))
        sizes, masses = (tuple(dict.fromkeys(map(float, one or ()))) for one in (self.diameter, self.table_mass))
        return DropChoices(programmers, sizes, masses)
