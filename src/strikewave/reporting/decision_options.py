"""Options of commands that judge what was measured: the decision rule, and the uncertainty that it takes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from strikewave.reporting.options.kinds import parsed

if TYPE_CHECKING:
    from pathlib import Path

    from strikewave.records.budget import Budget


def read_budget(word: str, field: str) -> Budget:
    """Return the budget of a share, or of a file.

    Examples
    --------
    >>> read_budget("5 %", "--uncertainty").share
    0.05
    """
    from strikewave.specifications.budget_file import load_budget

    return load_budget(word, field)


def budget_in_python(value: str | float | Path | None) -> Budget | None:
    """Return the budget of a call in plain values, where a number is a share; None for none.

    Examples
    --------
    >>> found = budget_in_python(0.05)
    >>> found.share, found.contributions[0].name
    (0.05, '5 % of the acceleration, as stated')
    """
    if value is None:
        return None
    return read_budget(f"{100.0 * value:g} %" if isinstance(value, int | float) else str(value), "uncertainty")


Decision = Annotated[
    Literal["simple", "guarded"],
    typer.Option(
        "--decision",
        help="Decision rule: by the value alone, or with a guard band of its expanded uncertainty (ISO 14253-1).",
    ),
]
Uncertainty = Annotated[
    Any,
    parsed(
        "--uncertainty",
        read=read_budget,
        metavar="SHARE|FILE",
        help="Expanded uncertainty (k = 2) of the acceleration, such as 5 %, or a .toml file with an uncertainty "
        "budget; noise and baseline alone by default.",
    ),
]
