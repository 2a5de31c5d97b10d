"""The report of a map: where blows are equal, what trains settle to, and the nearest setting with equal blows."""

from __future__ import annotations

from strikewave.reporting import chapters
from strikewave.reporting.numbers import percent, with_unit
from strikewave.reporting.parts import Cell, Link, Part, Picture, Section, Table, Tag
from strikewave.reporting.table_columns import page_table
from strikewave.studies.map.cells import FIELDS
from strikewave.studies.map.columns import at_words, setting_columns, setting_rows, shown_value
from strikewave.studies.map.figures import COLOURS, map_figure
from strikewave.studies.map.study import MapStudy


def map_report(study: MapStudy, colour: str = "cv") -> str:
    """Return the report of a map as one HTML page: no script, nothing fetched, the same bytes each time."""
    regimes = f" Hatches name the regime of a train of {study.plan.train} blows." if study.plan.train else ""
    caption = (
        f"{COLOURS[colour].label[0].upper()}{COLOURS[colour].label[1:]}, over {' and '.join(study.paths[:2])}."
        f"{regimes} The star is the case, the diamond the nearest setting with equal blows."
    )
    sections = [
        Section("Map", "", [Picture(map_figure(study, colour), caption, caption)]),
        _nearest_section(study),
        *([_regime_section(study)] if study.plan.train else []),
        chapters.warnings(study.notices),
        _axis_section(study),
        chapters.inputs(study.case),
    ]
    status = Tag("no setting with equal blows", "bad") if study.broken else None
    summary = chapters.Summary("Report of a map", map_words(study), _key_numbers(study), status)
    return chapters.result_page(study, summary, sections)


def map_words(study: MapStudy) -> str:
    """Say in words what the map shows."""
    panels, rows, columns = study.plan.shape
    cells, even = panels * rows * columns, len(study.even_settings())
    words = [f"{cells} machines of {study.plan.blows} blows each, over {' and '.join(study.paths)}."]
    words += [study.verdicts.sentence] if study.verdicts.words else []
    if study.plan.train:
        first = max(study.shares, key=study.shares.__getitem__)
        words.append(f"Most of them ({percent(study.shares[first], 0)}) are in the regime {first}.")
    wanted = f"a CV of the peaks within {percent(study.wanted)}"
    if study.setting is None:
        words.append(
            f"{even} settings have {wanted} by the fast run, and none of those tried in full keeps it."
            if even
            else f"No setting has blows that all come with {wanted}."
        )
    elif study.setting.distance == 0.0:
        words.append(f"The case itself has {wanted}: {percent(study.setting.cv, 2)} in a full run.")
    else:
        at = ", ".join(f"{path} = {text}" for path, text in _nearest(study, study.setting.values))
        words.append(
            f"The nearest setting with {wanted} is {at}: a full run has {percent(study.setting.cv, 2)} and a mean peak "
            f"of {with_unit(study.setting.peak, 'm/s^2', 'g')}."
        )
    return " ".join(words)


def _key_numbers(study: MapStudy) -> list[tuple[str, str]]:
    here = study.present
    pairs = [
        ("CV of the peaks of the case", shown_value(here["cv"], "1", "%")),
        ("mean peak of the case", with_unit(here["peak"], "m/s^2", "g")),
    ]
    setting = study.setting
    if setting is None:
        return [*pairs, ("settings with equal blows that a full run confirms", "none")]
    pairs += [(f"{path}, nearest with equal blows", text) for path, text in _nearest(study, setting.values)]
    pairs += [
        ("CV there, by a full run", shown_value(setting.cv, "1", "%")),
        ("mean peak there", with_unit(setting.peak, "m/s^2", "g")),
    ]
    return pairs


def _nearest(study: MapStudy, values: tuple[float, ...]) -> list[tuple[str, str]]:
    pairs = zip(study.plan.axes, values, strict=True)
    return [(axis.path, f"{axis.shown(value):.5g} {axis.unit}".strip()) for axis, value in pairs]


def _nearest_section(study: MapStudy) -> Section:
    """List the case beside the nearest setting with equal blows, and those that full runs refuted."""
    parts: list[Part] = [page_table("The case, and the nearest setting", setting_columns(study), setting_rows(study))]
    refused: list[list[Cell]] = [[at_words(study.plan.axes, one.values), one.reason] for one in study.refused]
    if refused:
        parts.append(Table("Even by the fast run, but not in full", ["setting", "why"], refused))
    if study.setting is not None:
        parts.append(Link("equal-blows.toml", "The case with that setting, equal-blows.toml"))
    text = "By the fast run, as every cell of the map. Distance is in steps relative to the value of the case" + (
        f"; the nearest is {study.setting.distance:.3g} away." if study.setting is not None else "."
    )
    return Section("The nearest setting with equal blows", text, parts)


def _regime_section(study: MapStudy) -> Section:
    """List the share of the cells in each regime, and why cells have no result."""
    rows: list[list[Cell]] = [[name, f"{100.0 * share:.1f}"] for name, share in study.shares.items()]
    failures: list[list[Cell]] = [[text, count] for text, count in study.failures.items()]
    tables = [Table("Regimes", ["regime", "cells (%)"], rows)]
    if failures:
        tables.append(Table("Cells without a result, or without a regime", ["why", "cells"], failures))
    return Section("Regimes", f"What a train of {study.plan.train} blows settles to.", tables)


def _axis_section(study: MapStudy) -> Section:
    """List the axes of the map and what its file holds."""
    rows: list[list[Cell]] = [
        [
            axis.path,
            axis.unit or "1",
            f"{axis.shown(axis.values[0]):.5g}",
            f"{axis.shown(axis.values[-1]):.5g}",
            len(axis.values),
            "logarithmic" if axis.log else "linear",
        ]
        for axis in study.plan.axes
    ]
    fields: list[list[Cell]] = [[name, unit, meaning] for name, (unit, meaning) in FIELDS.items()]
    tables = [
        Table("Axes", ["setting", "unit", "from", "to", "points", "spacing"], rows),
        Table("What map.nc and map.csv hold of each cell", ["field", "SI unit", "meaning"], fields),
    ]
    return Section("Axes and files", "", tables)
