"""Page, screen and command of a map: where blows are equal, and what trains settle to."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

from strikewave.base.declare import declarations
from strikewave.base.texts import percent
from strikewave.reporting.faces import columns_of, face_table, text_of
from strikewave.reporting.parts import Cell, Link, Part, Section, Table, Tag
from strikewave.reporting.terminal import report_table, say, tell
from strikewave.studies.command import Report, StudyCommand
from strikewave.studies.engine.store import RunStore
from strikewave.studies.map.cells import MapCell, MapPlan
from strikewave.studies.map.figures import colour_label, picture
from strikewave.studies.map.study import MapStudy, make_map
from strikewave.studies.study import picture_section, study_page


def map_words(study: MapStudy) -> str:
    """Say in words what the map shows."""
    panels, rows, columns = study.plan.shape
    cells, even = panels * rows * columns, len(study.even_settings())
    sentences = [f"{cells} machines of {study.plan.blows} blows each, over {' and '.join(study.paths)}."]
    sentences += [study.verdicts.sentence] if study.verdicts.words else []
    if study.plan.train:
        first = max(study.shares, key=study.shares.__getitem__)
        sentences.append(f"Most of them ({percent(study.shares[first], 0)}) are in the regime {first}.")
    wanted = f"a CV of the peaks within {percent(study.wanted)}"
    if study.setting is None:
        sentences.append(
            f"{even} settings have {wanted} by the fast run, and none of those tried in full keeps it."
            if even
            else f"No setting has blows that all come with {wanted}."
        )
    elif study.setting.distance == 0.0:
        sentences.append(f"The case itself has {wanted}: {text_of(study, 'nearest_cv')} in a full run.")
    else:
        at = ", ".join(f"{chosen.name} = {chosen.text}" for chosen in study.shown_setting)
        sentences.append(
            f"The nearest setting with {wanted} is {at}: a full run has {text_of(study, 'nearest_cv')} and a mean peak "
            f"of {text_of(study, 'nearest_peak')}."
        )
    return " ".join(sentences)


def setting_table(study: MapStudy, caption: str) -> Table:
    """List the case beside the nearest setting with equal blows: settings, and what the blows come to."""
    settings, heads = [(study.here, study.present)], ["", "case"]
    if study.setting is not None:
        settings.append((study.setting.values, study.setting.cell))
        heads.append(f"nearest within {percent(study.wanted)}")
    rows: list[list[Cell]] = [
        [f"{axis.path} ({axis.shown_unit or '1'})", *(f"{axis.shown(values[k]):.5g}" for values, _ in settings)]
        for k, axis in enumerate(study.axes)
    ]
    rows += [[column.head, *column.texts()] for column in columns_of(MapCell, [cell for _, cell in settings])]
    return Table(caption, heads, rows)


def regime_table(study: MapStudy) -> Table:
    """List the share of the cells in each regime."""
    return Table(
        "Regimes", ["regime", "cells (%)"], [[name, f"{100 * share:.1f}"] for name, share in study.shares.items()]
    )


def page(study: MapStudy) -> str:
    """Return the report of a map as one HTML page."""
    regimes = f" Hatches name the regime of a train of {study.plan.train} blows." if study.plan.train else ""
    label = colour_label(study.colour)
    caption = (
        f"{label[0].upper()}{label[1:]}, over {' and '.join(study.paths[:2])}."
        f"{regimes} The star is the case, the diamond the nearest setting with equal blows."
    )
    nearest: list[Part] = [setting_table(study, "The case, and the nearest setting")]
    if study.refused:
        nearest.append(face_table(study, "refused", caption="Even by the fast run, but not in full"))
    if study.setting is not None:
        nearest.append(Link("equal-blows.toml", "The case with that setting, equal-blows.toml"))
    text = "By the fast run, as every cell of the map. Distance is in steps relative to the value of the case" + (
        f"; the nearest is {study.setting.distance:.3g} away." if study.setting is not None else "."
    )
    outcome = [picture_section("Map", picture(study), caption)]
    outcome.append(Section("The nearest setting with equal blows", text, nearest))
    if study.plan.train:
        tables = [regime_table(study)]
        failures: list[list[Cell]] = [[text, count] for text, count in study.failures.items()]
        if failures:
            tables.append(Table("Cells without a result, or without a regime", ["why", "cells"], failures))
        outcome.append(Section("Regimes", f"What a train of {study.plan.train} blows settles to.", tables))
    fields: list[list[Cell]] = [
        [name, field.quantity.si, field.meaning] for name, field in declarations(MapCell).items()
    ]
    held = Table("What map.nc and map.csv hold of each cell", ["field", "SI unit", "meaning"], fields)
    axes = Section("Axes and files", "", [face_table(study, "variables", caption="Axes"), held])
    status = Tag("no setting with equal blows", "bad") if study.broken else None
    return study_page(study, map_words(study), outcome, axes, "a map", status)


@dataclass
class MapCommand(StudyCommand[MapStudy]):
    """A map as a command.

    Attributes
    ----------
    wanted : float
        Coefficient of variation below which blows count as even.
    seconds : float
        About how long it takes.
    colour : str
        Quantity that the colours of the picture show.
    """

    name: ClassVar[str] = "map"
    bar: ClassVar[str] = "map"
    clocks: ClassVar[tuple[str, ...]] = ("left",)
    formats: ClassVar[tuple[str, ...]] = ("svg", "png")

    plan: MapPlan
    wanted: float
    seconds: float
    colour: str

    @property
    def marked_text(self) -> str:
        """The case as text, and above it what is asked."""
        return self.plan.marked_text(self.wanted)

    def announced(self, store: RunStore) -> float:
        """Say what is run, and about how long it takes."""
        panels, rows, columns = self.plan.shape
        size = f"{columns} x {rows}" + (f" x {panels}" if panels > 1 else "")
        cells, done = panels * rows * columns, self.plan.known(store)
        stored = f", {done} of {cells} cells are there already" if done else ""
        trains = f" and trains of {self.plan.train}" if self.plan.train else ""
        seconds = max((1.0 - done / cells) * self.seconds, 1.0)
        say(f"{size} machines, {self.plan.blows} blows{trains}: about {seconds:.0f} s on free cores{stored}")
        return done / cells

    def made(self, store: RunStore, report: Report) -> MapStudy:
        """Return the map."""
        study = make_map(self.plan, self.wanted, store, self.pool, lambda now: report(now.share, now.words))
        return dataclasses.replace(study, colour=self.colour)

    def summary(self, result: MapStudy) -> str:
        """Say what the blows are like, and where the nearest equal ones are."""
        return map_words(result)

    def show(self, result: MapStudy) -> None:
        """Print shares of the regimes, why cells failed, the case, and the nearest even setting."""
        report_table(regime_table(result))
        for text, count in result.failures.items():
            tell(f"no result, or no regime, in {count} cells: {text}")
        report_table(setting_table(result, f"{result.case.name}: {result.plan.blows} blows"))
        for refusal in result.refused:
            tell(f"even by the fast run, but not in full: {refusal.setting}: {refusal.why}")
