"""The columns of the tables of a scatter study, for screen and page, and how shares are written."""

from __future__ import annotations

import math
from typing import NamedTuple

from strikewave.reporting.layout import KEY, MORE
from strikewave.reporting.numbers import LEAST_SHARE, headed, share_with_error, shown
from strikewave.reporting.parts import NONE, written
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.scatter.study import ScatterStudy
from strikewave.uncertainty.draws import UncertainInput
from strikewave.uncertainty.shares import Share, Shares

CALLED = {
    "peak": ("peak", "m/s^2", "g"),
    "width": ("pulse width at 10 %", "s", "us"),
    "interval": ("interval", "s", "ms"),
    "velocity_change": ("velocity change", "m/s", "m/s"),
}
"""Figures of a blow: what they are called, SI unit, and the usual unit."""
FEWEST_DIGITS = 3
"""Significant digits of coefficients of variation and shares: their bounds are wider."""


def in_percent(value: float | None) -> str:
    """Write a share in per cent; a dash where there is none.

    Examples
    --------
    >>> in_percent(0.012345), in_percent(float("nan")), in_percent(float("inf")), in_percent(1e-9)
    ('1.23 %', '–', 'none', '< 1e-4 %')
    """
    if value is None or math.isnan(value):
        return NONE
    if math.isinf(value):
        return "none"
    if 0.0 < abs(value) < LEAST_SHARE:
        return "< 1e-4 %"
    return f"{written(100.0 * value, FEWEST_DIGITS)} %"


def between(low: str, high: str) -> str:
    """Write bounds; a dash where one is missing."""
    return NONE if NONE in (low, high) else f"{low} to {high}"


def _bare(value: float | None) -> str:
    """Write a share for a column that has the sign in its head."""
    return in_percent(value).removesuffix(" %")


def _with_error(share: float | None, error: float | None) -> str:
    """Write a share with its standard error for a column that has the sign in its head.

    Examples
    --------
    >>> _with_error(0.412345, 0.031), _with_error(0.0, 0.021), _with_error(0.5, float("nan"))
    ('41 ± 3', '0 ± 2', '50')
    """
    if share is None or error is None or not LEAST_SHARE < error < math.inf:
        return _bare(share)
    return share_with_error(share, error).removesuffix(" %")


class FigureRow(NamedTuple):
    """A figure of a blow over the runs: its key, over all blows or the later ones."""

    study: ScatterStudy
    name: str
    blows: str = "all"

    @property
    def called(self) -> str:
        """What it is called, with the unit in which it is shown."""
        return headed(*CALLED[self.name])

    def shown(self, value: float) -> str:
        """Write a value of it."""
        _, si, usual = CALLED[self.name]
        return written(shown(value, si, usual), 5)

    @property
    def spread(self) -> tuple[float, ...]:
        """Median, bounds, and limit of its scatter within a run."""
        figure = self.study.figure(self.name)
        return tuple((figure.later if self.blows == "later" else figure.within)[:4])

    @property
    def still(self) -> float:
        """Scatter that the dynamics alone make."""
        return self.study.nominal_run.variation(self.name, self.blows == "later")


def _mean_bounds(row: FigureRow) -> str:
    mean = row.study.figure(row.name).mean
    return between(row.shown(mean.low), row.shown(mean.high))


def _cv_bounds(row: FigureRow) -> str:
    mean = row.study.figure(row.name).mean
    return between(_bare(mean.cv_low), _bare(mean.cv_high))


MEAN_COLUMNS: tuple[TableColumn[FigureRow], ...] = (
    TableColumn("figure", lambda row: row.called, priority=KEY, words=True),
    TableColumn("mean", lambda row: row.shown(row.study.figure(row.name).mean.mean)),
    TableColumn("95 % bounds", _mean_bounds),
    TableColumn("typical blow", lambda row: row.shown(row.study.figure(row.name).typical.mean), priority=MORE),
    TableColumn("CV (%)", lambda row: _bare(row.study.figure(row.name).mean.cv)),
    TableColumn("95 % bounds of the CV (%)", _cv_bounds),
)
"""Means of the runs, and CV between them."""
WITHIN_COLUMNS: tuple[TableColumn[FigureRow], ...] = (
    TableColumn("figure", lambda row: CALLED[row.name][0], priority=KEY, words=True),
    TableColumn("blows", lambda row: row.blows, priority=KEY, words=True),
    TableColumn("dynamics alone", lambda row: _bare(row.still)),
    TableColumn("median of the runs", lambda row: _bare(row.spread[0])),
    TableColumn("95 % bounds", lambda row: between(_bare(row.spread[1]), _bare(row.spread[2]))),
    TableColumn("95 % of runs below", lambda row: _bare(row.spread[3])),
)
"""Scatter within a run, %."""


def mean_rows(study: ScatterStudy) -> list[FigureRow]:
    """Return a row a figure."""
    return [FigureRow(study, name) for name in CALLED]


def within_rows(study: ScatterStudy) -> list[FigureRow]:
    """Return two rows a figure: over all blows, and without the first."""
    return [FigureRow(study, name, blows) for name in CALLED for blows in ("all", "later")]


class ShareRow(NamedTuple):
    """The share of a tolerance, and what that is."""

    share: Share
    tolerance: UncertainInput

    @property
    def typed(self) -> str:
        """The value with its tolerance, as typed."""
        band = self.tolerance.value.tolerance
        return str(self.tolerance.value.typed) + ("" if band is None else f" ± {band.typed}")

    @property
    def drawn(self) -> str:
        """How often it is drawn."""
        return "each striker" if self.tolerance.strikers else "once a run"


def share_rows(study: ScatterStudy, shares: Shares) -> list[ShareRow]:
    """Return a row a tolerance, the largest share first."""
    known = {one.path: one for one in study.tolerances}
    return [ShareRow(row, known[row.path]) for row in shares.rows]


def sum_words(shares: Shares) -> str:
    """Write the sum of shares with its bounds."""
    return f"{in_percent(shares.sum)} ({between(in_percent(shares.sum_low), in_percent(shares.sum_high))})"


def share_columns(study: ScatterStudy) -> tuple[TableColumn[ShareRow], ...]:
    """Return the columns of shares; of Sobol indices with the total ones."""
    columns: list[TableColumn[ShareRow]] = [
        TableColumn("tolerance", lambda row: row.share.path, priority=KEY, words=True),
        TableColumn("value", lambda row: row.typed, priority=MORE, words=True),
        TableColumn("drawn", lambda row: row.drawn, priority=MORE, words=True),
        TableColumn("provenance", lambda row: row.tolerance.value.provenance, priority=MORE, words=True),
        TableColumn("share (%)", lambda row: _with_error(row.share.share, row.share.standard_error)),
        TableColumn("", lambda row: "" if row.share.distinct else "*", words=True),
        TableColumn("95 % bounds", lambda row: between(_bare(row.share.low), _bare(row.share.high))),
    ]
    if study.plan.shares == "sobol":
        columns += [
            TableColumn("total (%)", lambda row: _with_error(row.share.total, row.share.total_standard_error)),
            TableColumn(
                "95 % bounds of the total",
                lambda row: between(_bare(row.share.total_low), _bare(row.share.total_high)),
                priority=MORE,
            ),
        ]
    return tuple(columns)
