"""``strikewave settings``: settings of the rotary machine for blows of a peak and a width at an interval."""

from __future__ import annotations

import hashlib
import shutil
import time as clock
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.reporting.run_and_write import BROKEN
from strikewave.reporting.terminal import (
    Changes,
    Force,
    Json,
    Out,
    fixed,
    number,
    print_json,
    progress_bar,
    say,
    say_compiling,
    significant,
    table,
)

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.studies.settings.candidate import Candidate, Goal, Limit
    from strikewave.studies.settings.study import Choice, SettingsStudy

SHOWN = 6
"""First of the ranking in the table; the first of each other number of strikers follows."""
COLUMNS = (
    "#", "strikers", "speed\n(rpm)", "engaged\n(mm)", "{}\n(MN/m)", "striker\n(kg)", "spring\n(kN/m)",
    "preload\n(N)", "damper\n(N s/m)", "peak\n(g)", "CV\n(%)", "width\n(us)", "interval\n(ms)", "stop\n(kN)",
    "retreat\n(mm)", "0.1 mm\n(%)", "meets",
)  # fmt: skip
LEFT_OUT, WIDE = (5, 6, 7, 8, 12, 14, 15), 140
"""Columns of the table that a screen with fewer characters does without."""
LIMIT_UNITS = {"Pa": "MPa", "m": "mm", "N": "kN", "m/s": "m/s", "N m": "N m"}
"""Units in which limits are shown; shares are shown in %, errors as they are."""


def command(
    interval: Annotated[
        str, typer.Option("--interval", help='Between blows, such as "20 ms".', show_default=False)
    ] = "",
    peak: Annotated[str, typer.Option("--peak", help='Rigid-body peak, such as "4000 g".', show_default=False)] = "",
    width: Annotated[
        str, typer.Option("--width", help='Of the pulse at 10 % of its peak, such as "200 us".', show_default=False)
    ] = "",
    blows: Annotated[
        int | None, typer.Option("--blows", help="How many; as the case has it by default.", show_default=False)
    ] = None,
    source: Annotated[
        str, typer.Option("--from", metavar="CASE", help="Case with what is not chosen: geometry, materials, stop.")
    ] = "li-ma-2019",
    changes: Changes = None,
    strikers: Annotated[
        list[int] | None,
        typer.Option(
            "--strikers", help="How many on the turntable; repeated. A ladder by default.", show_default=False
        ),
    ] = None,
    striker_mass: Annotated[
        list[str] | None,
        typer.Option(
            "--striker-mass", help="Of one; repeated. Half, once and twice the case's by default.", show_default=False
        ),
    ] = None,
    vary: Annotated[
        str, typer.Option("--vary", help="What gives the width: the stiffness of frame or mount.")
    ] = "frame",
    disc: Annotated[str, typer.Option("--disc", help="Material of the turntable, assumed.")] = "45 steel",
    stop_limit: Annotated[
        str | None, typer.Option("--stop-limit", help="Largest force of the object's stop.", show_default=False)
    ] = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Find settings of the rotary machine for blows of a peak and a width at an interval.

    Every candidate is checked by a full run of all its blows; the first one's case is written. With --json, files are
    written only where --out says. Exit code 3 says that no candidate meets the goal within 5 % and keeps all limits.
    """
    begun = clock.perf_counter()
    from strikewave.base.materials import material
    from strikewave.base.output_folder import check_place
    from strikewave.cases.case import load_case
    from strikewave.studies.settings.candidate import Goal
    from strikewave.studies.settings.study import Choice, check_goal, design_settings, name_of

    plain = not (changes or strikers or striker_mass or stop_limit) and blows is None
    plain = plain and (source, vary, disc) == ("li-ma-2019", "frame", "45 steel")

    goal = Goal(
        _quantity(interval, "s", "--interval", "20 ms"),
        _quantity(peak, "m/s^2", "--peak", "4000 g"),
        _quantity(width, "s", "--width", "200 us"),
        material(disc, "--disc"),
        None if stop_limit is None else _quantity(stop_limit, "N", "--stop-limit", "1 kN"),
    )
    masses = tuple(_quantity(text, "kg", "--striker-mass", "1 kg") for text in striker_mass or ())
    choice = Choice(tuple(dict.fromkeys(strikers or ())), tuple(dict.fromkeys(masses)), vary)
    case = load_case(source, [*(changes or ()), *([] if blows is None else [f"feed.blows={blows}"])])
    check_goal(case, goal, choice)
    asked, folder, replace = _asked(case, goal, choice), out, force
    if out is None and not json:
        folder, replace = Path("out") / (name_of(goal) + ("" if plain else f"-{asked[-10:-2]}")), True
    if folder is not None:
        replace = replace or _holds(folder, asked)
        check_place(folder, asked, replace)
    say_compiling()
    with progress_bar("settings") as report:
        study = design_settings(case, goal, choice, report)
    if folder is not None:
        _write(study, folder, asked, replace)
    if json:
        print_json(study.document(), indent=None)
    else:
        _print(study)
    say(f"done in {clock.perf_counter() - begun:.2f} s")
    return BROKEN if study.broken else 0


def _asked(case: Case, goal: Goal, choice: Choice) -> str:
    """Return the first line of the written case: what was asked, and a mark of everything that it was asked of."""
    from strikewave.cases.case import dump_case
    from strikewave.studies.settings.study import goal_words

    limits = goal.interval, goal.peak, goal.width, goal.disc.name, goal.stop_limit
    mark = hashlib.sha256(f"{limits} {choice} {dump_case(case)}".encode()).hexdigest()[:8]
    return f"# strikewave settings: {goal_words(goal)}, from {case.name or 'case'} ({mark})\n"


def _holds(folder: Path, asked: str) -> bool:
    """Return whether a folder holds the result of the very same question."""
    try:
        with (folder / "case.toml").open("rb") as file:
            return file.read(len(asked.encode())) == asked.encode()
    except OSError:
        return False


def _quantity(text: str, si: str, field: str, example: str) -> float:
    """Return an option as a number above zero in SI."""
    from strikewave.base.errors import MISSING, InputError
    from strikewave.base.units import DIMENSIONS, parse_quantity

    allowed = f'{DIMENSIONS[si][0]} above zero with its unit, such as "{example}"'
    if not text:
        raise InputError(field, MISSING, allowed, f'add {field} "{example}"')
    value = parse_quantity(text, si, field)
    if not value > 0.0:
        raise InputError(field, text, allowed)
    return value


def _write(study: SettingsStudy, folder: Path, asked: str, force: bool) -> None:
    """Write the case of the first candidate, all candidates, and their picture."""
    import json

    from strikewave.base.output_folder import whole_folder
    from strikewave.cases.case import dump_case
    from strikewave.reporting.style import save
    from strikewave.studies.settings.figures import settings_figure

    text = asked + dump_case(study.case_of())
    with whole_folder(folder, text, force) as place:
        (place / "case.toml").write_text(text, "utf-8")
        (place / "settings.json").write_text(json.dumps(study.document(), allow_nan=False) + "\n", "utf-8")
        save(settings_figure(study), place / "settings.svg")
    say(f"written: {str(folder).rstrip('/')}/ (case.toml, settings.json, settings.svg)")


def _print(study: SettingsStudy) -> None:
    from strikewave.studies.settings.study import goal_words

    first = study.candidates[0]
    say(_header(study.case, study.goal, first))
    met = sum(one.meets for one in study.candidates)
    others = {one.case.rig().machine.strikers.si: one for one in reversed(study.candidates)}
    shown = [one for one in study.candidates if one in study.candidates[:SHOWN] or one in others.values()]
    wide = shutil.get_terminal_size((160, 24)).columns >= WIDE
    kinds = [k for k in range(len(COLUMNS)) if wide or k not in LEFT_OUT]
    columns = [COLUMNS[k].format(study.choice.vary) for k in kinds]
    rows = [_cells(study, place, one) for place, one in enumerate(study.candidates, 1) if one in shown]
    title = f"{met} of {len(study.candidates)} settings give {goal_words(study.goal)}"
    table(title, columns, [[row[k] for k in kinds] for row in rows], left=0)
    say(
        "peak, width, interval: of the typical blow, the median of the later full ones; CV: scatter of all peaks; "
        "0.1 mm: change of the peak with that much of engagement"
    )
    table("Limits of the first", ["limit", "value", "at most", "unit", "kept"], [_limit(x) for x in first.limits])
    if len(study.masses) > 1:
        rows = [_mass_cells(study, one) for one in study.masses]
        names = ["striker (kg)", "engagement (mm)", f"{study.choice.vary} (MN/m)", "contact (kN)", "lost a blow (rpm)"]
        table("What the mass of a striker costs", names, rows, left=0)
    for count, why in study.left_out.items():
        say(f"left out, {count} strikers: {why}")
    for why in study.failed[:SHOWN]:
        say(f"no result, {why}")
    for notice in study.warnings:
        say(f"warning [{notice.code}]: {notice.message}")


def _header(case: Case, goal: Goal, first: Candidate) -> str:
    from strikewave.studies.settings.study import goal_words

    guess = first.estimate
    return (
        f"{goal_words(goal)}, from {case.name}: a half-sine changes the velocity by "
        f"{guess['velocity_change']:.3g} m/s, for which a first estimate asks an approach of "
        f"{guess['approach']:.3g} m/s; the full run has {first.seen.velocity_change:.3g} and "
        f"{first.seen.approach:.3g} m/s"
    )


def _cells(study: SettingsStudy, place: int, one: Candidate) -> list[str]:
    """Return a row of the table of candidates."""
    from strikewave.studies.settings.estimate import engagement_sensitivity
    from strikewave.studies.settings.search import VARIED

    values, seen = one.case.values(), one.seen
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
        number(seen.peak.typical, "m/s^2", "g", 4),
        fixed(100.0 * seen.peak.variation, "1", "1", 2),
        fixed(seen.width.typical, "s", "us", 1),
        fixed(seen.interval.typical, "s", "ms", 3),
        number(seen.supply.stop_force, "N", "kN", 3),
        number(seen.retreat, "m", "mm", 3),
        fixed(1e-2 * engagement_sensitivity(depth, radius), "1", "1", 1),
        "yes" if one.meets else "no",
    ]


def _limit(limit: Limit) -> list[str]:
    """Return a row of the table of limits."""
    unit = LIMIT_UNITS.get(limit.unit, "1")
    value, most = (number(x, limit.unit, unit, 3) for x in (limit.value, limit.limit))
    return [
        limit.name.replace("_", " "),
        value,
        most,
        unit,
        "yes" if limit.kept else "no" if limit.decides else "warned",
    ]


def _mass_cells(study: SettingsStudy, one: Candidate) -> list[str]:
    """Return a row of the table of masses."""
    from strikewave.studies.settings.search import VARIED

    values = one.case.values()
    return [
        number(values["striker.mass"].si, "kg", "kg"),
        number(values["machine.engagement"].si, "m", "mm"),
        number(values[VARIED[study.choice.vary][0]].si, "N/m", "MN/m"),
        significant(one.seen.peak_force / 1e3, 3),
        number(one.seen.supply.speed_lost, "rad/s", "rpm", 3),
    ]
