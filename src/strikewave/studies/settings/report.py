"""The report of a search for settings: what was asked, what the best settings give, and what they cost."""

from __future__ import annotations

from strikewave.reporting import chapters
from strikewave.reporting.numbers import fixed, headed, percent, shown, spelled, with_unit
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, Tag, written
from strikewave.studies.settings.candidate import WITHIN, BlowSpread, Limit, SettingsCandidate
from strikewave.studies.settings.estimate import engagement_sensitivity
from strikewave.studies.settings.figures import settings_figure
from strikewave.studies.settings.search import VARIED
from strikewave.studies.settings.study import SettingsStudy, goal_words

MOST_ROWS = 40
"""Candidates in the table: more would not be read; settings.json has all."""
LIMIT_UNITS = {"Pa": "MPa", "m": "mm", "N": "kN", "m/s": "m/s", "N m": "N m"}
"""Usual units of limits; shares are shown in %."""


def settings_report(study: SettingsStudy) -> str:
    """Return the report of a search for settings as one HTML page: no script, nothing fetched, the same bytes."""
    caption = (
        "Left, how far the typical blow of each candidate misses the goal, by place, and its worst peak. Right, what "
        "the settings cost: scatter of the peaks over the largest force of the stop; filled where the goal is met."
    )
    sections = [
        Section("What the settings give", "", [Picture(settings_figure(study), caption, caption)]),
        _first_section(study),
        _ranking_section(study),
        chapters.warnings(study.notices),
        *_left_section(study),
        chapters.inputs(study.case_of()),
    ]
    status = Tag("goal missed", "bad") if study.broken else None
    summary = chapters.Summary(
        "Report of a search for machine settings", settings_words(study), _key_numbers(study), status
    )
    return chapters.result_page(study, summary, sections)


def settings_words(study: SettingsStudy) -> str:
    """Say in words what was found."""
    first, met = study.candidates[0], sum(one.meets for one in study.candidates)
    values = first.case.values()
    which = "None" if not met else str(met)
    settings = ", ".join(f"{path} = {values[path].typed}" for path in first.chosen)
    words = [
        f"{which} of {len(study.candidates)} settings that were run in full {'gives' if met == 1 else 'give'} "
        f"{spelled(goal_words(study.goal))}, each within {percent(WITHIN, 0)}, with all blows full and all limits "
        "kept.",
        f"{'The first' if met else 'The nearest'}: {settings}.",
    ]
    if not met:
        words.append(f"It misses the goal: {first.obstacles}.")
    return " ".join(words)


def _key_numbers(study: SettingsStudy) -> list[tuple[str, str]]:
    first, goal = study.candidates[0].observation, study.goal
    return [
        ("settings that meet the goal", f"{sum(one.meets for one in study.candidates)} of {len(study.candidates)}"),
        (f"typical peak; wanted {with_unit(goal.peak, 'm/s^2', 'g')}", with_unit(first.peak.typical, "m/s^2", "g")),
        (f"typical width; wanted {with_unit(goal.width, 's', 'us')}", with_unit(first.width.typical, "s", "us")),
        (f"interval; wanted {with_unit(goal.interval, 's', 'ms')}", with_unit(first.interval.typical, "s", "ms")),
        ("scatter of the peaks, CV", _share(first.peak.variation)),
        ("largest force of the stop", with_unit(first.supply.stop_force, "N", "kN", 3)),
    ]


def _share(value: float) -> str:
    return NONE if value != value else f"{written(100.0 * value, 3)} %"


def _first_section(study: SettingsStudy) -> Section:
    """Show what was chosen for the first candidate, its blows, and its limits."""
    first = study.candidates[0]
    values, observation = first.case.values(), first.observation
    chosen: list[list[Cell]] = [[path, str(values[path].typed)] for path in first.chosen]
    spreads: dict[str, tuple[BlowSpread, str, str]] = {
        "peak": (observation.peak, "m/s^2", "g"),
        "pulse width at 10 %": (observation.width, "s", "us"),
        "interval": (observation.interval, "s", "ms"),
    }
    wanted = (study.goal.peak, study.goal.width, study.goal.interval)
    blows: list[list[Cell]] = [
        [
            headed(name, si, usual),
            *(written(shown(value, si, usual)) for value in (asked, spread.typical, spread.first, spread.worst)),
            _share(spread.variation).removesuffix(" %"),
        ]
        for asked, (name, (spread, si, usual)) in zip(wanted, spreads.items(), strict=True)
    ]
    limits: list[list[Cell]] = [_limit(limit) for limit in first.limits]
    return Section(
        "The first candidate",
        "Typical is the median of the later full blows; worst is the blow farthest from the goal.",
        [
            Table("What was chosen", ["setting", "value"], chosen),
            Table("Blows", ["", "wanted", "typical", "first", "worst", "CV (%)"], blows),
            Table("Limits", ["limit", "value", "at most", "unit", "result"], limits),
        ],
    )


def _limit(limit: Limit) -> list[Cell]:
    usual = LIMIT_UNITS.get(limit.unit, "1")
    value, most = (written(shown(x, limit.unit, usual) if usual != "1" else x, 3) for x in (limit.value, limit.limit))
    result = Tag("kept", "good") if limit.kept else Tag("broken", "bad") if limit.decides else Tag("warned", "warned")
    unit = headed("", limit.unit, usual).strip(" ()") if usual != "1" else "1"
    return [limit.name.replace("_", " "), value, most, unit, result]


def _ranking_section(study: SettingsStudy) -> Section:
    """List the first of the ranking, and what the mass of a striker costs."""
    stiffness = VARIED[study.choice.vary][0]
    columns = (
        ("speed", "machine.speed", "rad/s", "rpm"),
        ("engagement", "machine.engagement", "m", "mm"),
        (f"stiffness of the {study.choice.vary}", stiffness, "N/m", "MN/m"),
        ("striker", "striker.mass", "kg", "kg"),
        ("spring", "object.spring", "N/m", "kN/m"),
        ("preload", "object.preload", "N", "N"),
        ("damper", "object.damper", "N s/m", "N s/m"),
    )
    heads = ["#", "strikers", *(headed(name, si, usual) for name, _, si, usual in columns)]
    heads += [headed("peak", "m/s^2", "g"), "CV (%)", headed("width", "s", "us"), headed("interval", "s", "ms")]
    heads += [headed("stop force", "N", "kN"), headed("largest displacement", "m", "mm"), "per 0.1 mm (%)", "meets"]
    rows: list[list[Cell]] = []
    for place, one in enumerate(study.candidates[:MOST_ROWS], 1):
        values, seen = one.case.values(), one.observation
        depth, radius = values["machine.engagement"].si, values["machine.radius"].si
        rows.append(
            [
                str(place),
                f"{values['machine.strikers'].si:.0f}",
                *(written(shown(values[path].si, si, usual)) for _, path, si, usual in columns),
                fixed(seen.peak.typical, "m/s^2", "g", 0),
                _share(seen.peak.variation).removesuffix(" %"),
                fixed(seen.width.typical, "s", "us", 1),
                fixed(seen.interval.typical, "s", "ms", 3),
                written(shown(seen.supply.stop_force, "N", "kN"), 3),
                written(shown(seen.largest_displacement, "m", "mm"), 3),
                written(1e-2 * engagement_sensitivity(depth, radius), 2),
                Tag("yes", "good") if one.meets else Tag("no", "bad"),
            ]
        )
    more = len(study.candidates) - len(rows)
    text = (
        "Peak, width and interval are those of the typical blow; per 0.1 mm is the change of the peak with that much "
        f"of engagement.{f' settings.json has {more} more.' if more else ''}"
    )
    tables = [Table(f"Candidates, best first, for {spelled(goal_words(study.goal))}", heads, rows)]
    if len(study.masses) > 1:
        tables.append(_mass_table(study, stiffness))
    return Section("Candidates", text, tables)


def _mass_table(study: SettingsStudy, stiffness: str) -> Table:
    def cells(one: SettingsCandidate) -> list[Cell]:
        values = one.case.values()
        return [
            written(shown(values["striker.mass"].si, "kg", "kg")),
            written(shown(values["machine.engagement"].si, "m", "mm")),
            written(shown(values[stiffness].si, "N/m", "MN/m")),
            written(shown(one.observation.peak_force, "N", "kN"), 3),
            written(shown(one.observation.supply.speed_lost, "rad/s", "rpm"), 3),
        ]

    heads = [headed("striker", "kg", "kg"), headed("engagement", "m", "mm")]
    heads += [headed(f"stiffness of the {study.choice.vary}", "N/m", "MN/m"), headed("contact force", "N", "kN")]
    heads += [headed("speed lost in a blow", "rad/s", "rpm")]
    return Table("What the mass of a striker costs, all else as the first", heads, [cells(one) for one in study.masses])


def _left_section(study: SettingsStudy) -> list[Section]:
    """List what was not run, or gave no result; nothing where there is none."""
    rows: list[list[Cell]] = [[f"{count} strikers", why] for count, why in study.left_out.items()]
    rows += [["no result", why] for why in study.failed]
    return [Section("Left out", "", [Table("Not run, or without a result", ["what", "why"], rows)])] if rows else []
