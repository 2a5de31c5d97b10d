"""A search for settings as a command: run, print, draw."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave.cases.case import Case
from strikewave.reporting import measured_files as measured
from strikewave.reporting.layout import KEY, MORE, ScreenColumn, keys, numerals, texts
from strikewave.reporting.numbers import shown_unit, spelled, with_unit
from strikewave.reporting.options import Output
from strikewave.reporting.run_and_write import Command, run_and_write
from strikewave.reporting.terminal import fixed, number, progress_bar, table, tell
from strikewave.studies.settings.candidate import BlowGoal, Limit, SettingsCandidate
from strikewave.studies.settings.estimate import engagement_sensitivity
from strikewave.studies.settings.search import VARIED
from strikewave.studies.settings.study import (
    SettingsChoices,
    SettingsStudy,
    asked_line,
    design_settings,
    goal_words,
    name_of,
)

SHOWN = 6
"""First of the ranking in the table; the first of each other number of strikers follows."""
LIMIT_UNITS = {"Pa": "MPa", "m": "mm", "N": "kN", "m/s": "m/s", "N m": "N m"}
"""Units in which limits are shown; shares are shown in %, errors as they are."""


def find_settings(command: SettingsCommand, output: Output, usual_question: bool) -> int:
    """Search for settings, write and print them, and return the exit code.

    ``usual_question`` says that nothing but the goal was asked: only then the folder has its name alone.

    Raises
    ------
    InputError
        If the place is taken.
    """
    asked = asked_line(command.case, command.goal, command.choice)
    usual = name_of(command.goal) + ("" if usual_question else f"-{asked[-10:-2]}")
    if output.out is not None and _holds(output.out, asked):
        output = dataclasses.replace(output, force=True)
    return run_and_write(command, output, usual, asked)


@dataclass(frozen=True)
class SettingsCommand(Command[SettingsStudy]):
    """A search for settings that meet a goal."""

    indent: ClassVar[int | None] = None

    case: Case
    goal: BlowGoal
    choice: SettingsChoices

    def solve(self) -> SettingsStudy:
        """Return the study, with a bar on stderr."""
        with progress_bar("settings") as report:
            study = design_settings(self.case, self.goal, self.choice, report)
        return dataclasses.replace(study, asked=measured.asked())

    def summary(self, result: SettingsStudy) -> str:
        """Say which settings are first, and what they give."""
        from strikewave.studies.settings.report import settings_words

        return settings_words(result)

    def show(self, result: SettingsStudy) -> None:
        """Print the ranking, and the limits of the first."""
        _print(result)

    def draw(self, result: SettingsStudy, folder: Path) -> list[str]:
        """Write page and picture."""
        from strikewave.reporting.style import save
        from strikewave.studies.settings.figures import settings_figure
        from strikewave.studies.settings.report import settings_report

        save(settings_figure(result), folder / "settings.svg")
        (folder / "report.html").write_text(settings_report(result), "utf-8", newline="\n")
        return ["report.html", "settings.svg"]


def _holds(folder: Path, asked: str) -> bool:
    """Return whether a folder holds the result of the very same question."""
    try:
        with (folder / "case.toml").open("rb") as file:
            return file.read(len(asked.encode())) == asked.encode()
    except OSError:
        return False


def _print(study: SettingsStudy) -> None:
    first = study.candidates[0]
    met = sum(one.meets for one in study.candidates)
    others = {one.case.rotary_tables().machine.strikers.si: one for one in reversed(study.candidates)}
    shown = [one for one in study.candidates if one in study.candidates[:SHOWN] or one in others.values()]
    rows = [_cells(study, place, one) for place, one in enumerate(study.candidates, 1) if one in shown]
    title = f"{met} of {len(study.candidates)} settings give {goal_words(study.goal)}"
    table(title, _columns(study.choice.vary), rows)
    tell(
        "peak, width, interval: of the typical blow, the median of the later full ones; CV: scatter of all peaks; "
        "0.1 mm: change of the peak with that much of engagement"
    )
    tell(_header(study.case, study.goal, first))
    columns = [*keys("limit"), *numerals("value", "at most"), *texts("unit"), *texts("kept")]
    table("Limits of the first", columns, [_limit(x) for x in first.limits])
    if len(study.masses) > 1:
        rows = [_mass_cells(study, one) for one in study.masses]
        columns = [*numerals("striker (kg)", priority=KEY), *numerals("engagement (mm)", f"{study.choice.vary} (MN/m)")]
        columns += numerals("contact (kN)", "lost a blow (rpm)")
        table("What the mass of a striker costs", columns, rows)
    for count, why in study.left_out.items():
        tell(f"left out, {count} strikers: {why}")
    for why in study.failed[:SHOWN]:
        tell(f"no result, {why}")


def _columns(varied: str) -> list[ScreenColumn]:
    """Return the columns of the table of candidates; see `_cells`."""
    return [
        *numerals("#", priority=KEY),
        *numerals("strikers", "speed (rpm)", "engaged (mm)", f"{varied} (MN/m)"),
        *numerals("striker (kg)", "spring (kN/m)", "preload (N)", "damper (N s/m)", priority=MORE + 1),
        *numerals("peak (g)"),
        *numerals("CV (%)", priority=MORE),
        *numerals("width at 10 % (us)"),
        *numerals("interval (ms)", "stop (kN)", "largest displacement (mm)", "0.1 mm (%)", priority=MORE),
        *texts("meets"),
    ]


def _header(case: Case, goal: BlowGoal, first: SettingsCandidate) -> str:
    guess = first.estimate
    return (
        f"{goal_words(goal)}, from {case.name}: a half-sine changes the velocity by "
        f"{with_unit(guess['velocity_change'], 'm/s', 'm/s', 3)}, for which a first estimate asks an approach of "
        f"{with_unit(guess['approach'], 'm/s', 'm/s', 3)}; the full run has "
        f"{with_unit(first.observation.velocity_change, 'm/s', 'm/s', 3)} and "
        f"{with_unit(first.observation.approach, 'm/s', 'm/s', 3)}"
    )


def _cells(study: SettingsStudy, place: int, one: SettingsCandidate) -> list[str]:
    """Return a row of the table of candidates."""
    values, observation = one.case.values(), one.observation
    depth, radius = values["machine.engagement"].si, values["machine.radius"].si
    return [
        str(place),
        f"{values['machine.strikers'].si:.0f}",
        number(values["machine.speed"].si, "rad/s", "rpm"),
        number(depth, "m", "mm", 3),
        number(values[VARIED[study.choice.vary][0]].si, "N/m", "MN/m", 3),
        number(values["striker.mass"].si, "kg", "kg"),
        number(values["object.spring"].si, "N/m", "kN/m", 3),
        number(values["object.preload"].si, "N", "N", 3),
        number(values["object.damper"].si, "N s/m", "N s/m", 3),
        number(observation.peak.typical, "m/s^2", "g", 4),
        fixed(100.0 * observation.peak.variation, "1", "1", 2),
        fixed(observation.width.typical, "s", "us", 1),
        fixed(observation.interval.typical, "s", "ms", 3),
        number(observation.supply.stop_force, "N", "kN", 3),
        number(observation.largest_displacement, "m", "mm", 3),
        fixed(1e-2 * engagement_sensitivity(depth, radius), "1", "1", 1),
        "yes" if one.meets else "no",
    ]


def _limit(limit: Limit) -> list[str]:
    """Return a row of the table of limits."""
    usual = LIMIT_UNITS.get(limit.unit, "1")
    value, most = (number(x, limit.unit, usual, 3) for x in (limit.value, limit.limit))
    return [
        limit.name.replace("_", " "),
        value,
        most,
        spelled(shown_unit(limit.unit, usual)),
        "yes" if limit.kept else "no" if limit.decides else "warned",
    ]


def _mass_cells(study: SettingsStudy, one: SettingsCandidate) -> list[str]:
    """Return a row of the table of masses."""
    values = one.case.values()
    return [
        number(values["striker.mass"].si, "kg", "kg"),
        number(values["machine.engagement"].si, "m", "mm"),
        number(values[VARIED[study.choice.vary][0]].si, "N/m", "MN/m"),
        number(one.observation.peak_force, "N", "kN", 3),
        number(one.observation.supply.speed_lost, "rad/s", "rpm", 3),
    ]
