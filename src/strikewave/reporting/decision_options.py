"""Options of commands that judge what was measured: the decision rule, and the uncertainty that it takes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from strikewave.reporting.options import parsed

if TYPE_CHECKING:
    from strikewave.records.budget.contributions import Budget


def read_budget(word: str, field: str) -> Budget:
    """Return the budget of a share, or of a file.

    Examples
    --------
    >>> read_budget("5 %", "--uncertainty").share
    0.05
    """
    from strikewave.specifications.budget_file import load_budget

    return load_budget(word, field)


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
