"""The table of the case beside the nearest setting with equal blows, for screen and page."""

from __future__ import annotations

from typing import NamedTuple

from strikewave.reporting.layout import KEY
from strikewave.reporting.numbers import headed, percent, shown
from strikewave.reporting.parts import written
from strikewave.reporting.table_columns import TableColumn
from strikewave.studies.axes import Axis
from strikewave.studies.map.study import MapStudy

SHOWN = (
    ("CV of the peaks", "cv", "1", "%"),
    ("CV from 2nd blow", "cv_later", "1", "%"),
    ("mean rigid peak", "peak", "m/s^2", "g"),
    ("missed blows", "missed", "1", "1"),
    ("largest displacement", "largest_displacement", "m", "mm"),
    ("largest force of the stop", "stop_force", "N", "kN"),
    ("first to last blow", "train_time", "s", "ms"),
)
"""What is shown of a setting: words, name of the field, SI unit and usual unit."""


class SettingRow(NamedTuple):
    """A quantity, with its unit, of the case and of the nearest setting."""

    called: str
    shown: tuple[str, ...]


def setting_rows(study: MapStudy) -> list[SettingRow]:
    """Return a row an axis, and a row a quantity of the blows."""
    settings = [(study.here, study.present)]
    if study.setting is not None:
        settings.append((study.setting.values, study.setting.cell))
    rows = [
        SettingRow(f"{axis.path} ({axis.unit or '1'})", tuple(f"{axis.shown(values[k]):.5g}" for values, _ in settings))
        for k, axis in enumerate(study.plan.axes)
    ]
    return rows + [
        SettingRow(
            f"{called} (%)" if usual == "%" else headed(called, si, usual),
            tuple(shown_value(cell[name], si, usual).removesuffix(" %") for _, cell in settings),
        )
        for called, name, si, usual in SHOWN
    ]


def setting_columns(study: MapStudy) -> tuple[TableColumn[SettingRow], ...]:
    """Return the columns: the case, and the nearest setting where there is one."""
    columns: list[TableColumn[SettingRow]] = [
        TableColumn("", lambda row: row.called, priority=KEY, words=True),
        TableColumn("case", lambda row: row.shown[0]),
    ]
    if study.setting is not None:
        columns.append(TableColumn(f"nearest within {percent(study.wanted)}", lambda row: row.shown[1]))
    return tuple(columns)


def shown_value(value: float, si: str, usual: str) -> str:
    """Write a value of a cell; a share in per cent.

    Examples
    --------
    >>> shown_value(0.0123, "1", "%"), shown_value(0.0205, "s", "ms")
    ('1.23 %', '20.5')
    """
    if usual == "%":
        return f"{written(100.0 * value, 3)} %" if value == value else written(value)
    return written(shown(value, si, usual), 5)


def at_words(axes: tuple[Axis, ...], values: tuple[float, ...]) -> str:
    """Write the values of a setting."""
    return ", ".join(f"{axis.path} = {axis.typed(value)}" for axis, value in zip(axes, values, strict=True))
