"""The shocks of a test report: every one of a few; of many, a summary and those that stand out."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from statistics import fmean, stdev

from strikewave.analyses.record.verdicts.words import WHY_HEAD, why_of_shock
from strikewave.base.shock_quantities import SECONDS
from strikewave.base.texts import percent
from strikewave.reporting import faces
from strikewave.reporting.clause_words import amount, clause_name, doubted_words, limit_words, tag_of, value_words
from strikewave.reporting.parts import NONE, Cell, Table
from strikewave.specifications.judged_records import JudgedShock, RecordsVerdict
from strikewave.specifications.judging import CANNOT_TELL, FAIL, NORMATIVE, PASS, Clause, Limits, judged, together
from strikewave.specifications.shock_directions import DIRECTIONS

MOST_LISTED = 200
"""Shocks that are listed one by one: five sheets. Of more a summary is given, and those that do not pass."""
FIGURES = (("peak", "m/s^2"), ("pulse width", "s"), ("velocity change", "m/s"))
"""Figures of a shock, by the begin of the names of their clauses, and their SI units."""
_VALUE = re.compile(r"(?P<value>[−+]?\d\S*( ± \S+)?)\s(?P<unit>\D\S*)")
DOUBT = "; behind ± the expanded uncertainty, k = 2"
"""Ends the captions of tables of figures with it."""
UNSTATED = "not stated"
"""Stands for a direction that is not stated."""


def figures_of(shock: JudgedShock) -> list[Clause]:
    """Return peak, pulse width and velocity change as their clauses; as measured where the specification asks none."""
    pulse = shock.pulse
    values = (abs(pulse.peak), pulse.width, abs(pulse.velocity_change))
    found = []
    for (name, unit), value in zip(FIGURES, values, strict=True):
        own = [clause for clause in shock.found.clauses if clause.clause.startswith(name)]
        called = {"s": f"{name} at 10 %", "m/s": f"{name}, foot to foot"}.get(unit, name)
        found += own[:1] or [judged(called, value, Limits(value, value, NORMATIVE), unit)]
    return found


def groups(found: RecordsVerdict) -> Iterator[tuple[str, str, list[JudgedShock]]]:
    """Yield direction, channel and shocks of each group that has a direction and a channel in common."""
    channels = list(dict.fromkeys(shock.reading.channel.name for shock in found.shocks))
    for direction in (*DIRECTIONS, ""):
        for channel in channels:
            here = [one for one in found.shocks if (one.direction, one.reading.channel.name) == (direction, channel)]
            if here:
                yield direction, channel, here


def group_name(direction: str, channel: str, several: bool) -> str:
    """Return what a group is called."""
    words = f"direction {direction}" if direction else "direction not stated"
    return f"{words}, {channel}" if several else words


def several_channels(found: RecordsVerdict) -> bool:
    """Tell whether the shocks were taken on several channels."""
    return len({shock.reading.channel.name for shock in found.shocks}) > 1


def blow_verdicts(shocks: Sequence[JudgedShock]) -> list[str]:
    """Return the verdict on each blow: one on several channels is one, and passes where it does on all."""
    blows: dict[tuple[str, int], list[str]] = {}
    for one in shocks:
        blows.setdefault((one.file, one.number), []).append(one.found.verdict)
    return [together(of_channels) for of_channels in blows.values()]


def direction_tables(found: RecordsVerdict) -> list[Table]:
    """Return what was asked of each direction and what was done, and the clauses on all shocks together."""
    count = found.specification.count()
    clauses = {clause.clause: clause for clause in found.campaign}
    asked = NONE
    if count is not None:
        asked = f"{count.low:g}" if not math.isfinite(count.high) else f"{count.low:g} to {count.high:g}"
    rows: list[list[Cell]] = []
    for direction in (*DIRECTIONS, ""):
        here = [one for one in found.shocks if one.direction == direction]
        clause = clauses.pop(f"shocks in {direction}", None)
        if not here and clause is None:
            continue
        verdicts = blow_verdicts(here)
        counts: list[Cell] = [len(verdicts), *(verdicts.count(verdict) for verdict in (PASS, FAIL, CANNOT_TELL))]
        axis = direction.lstrip("+-") or NONE
        rows.append([direction or UNSTATED, axis, asked, *counts, NONE if clause is None else tag_of(clause.verdict)])
    heads = ["direction", "axis", "shocks asked for", "done", "pass", "fail", "cannot tell", "verdict"]
    others: list[list[Cell]] = [
        [one.clause, limit_words(one), value_words(one), tag_of(one.verdict), one.reason or NONE]
        for one in clauses.values()
    ]
    tables = [Table("Shocks by direction", heads, rows, "No shock was recorded.")]
    if others:
        tables.append(Table("All shocks together", ["clause", "asked for", "found", "verdict", "why"], others))
    return tables


def shock_tables(found: RecordsVerdict, names: dict[str, str]) -> list[Table]:
    """Return all shocks in a table or, of many, a summary, those that do not pass, and the largest and smallest."""
    numbered = list(enumerate(found.shocks, start=1))
    if len(numbered) <= MOST_LISTED:
        return [_listed(numbered, found, names, f"Each shock{DOUBT}")]
    odd = [one for one in numbered if one[1].found.verdict != PASS]
    left = f", the first {MOST_LISTED} of {len(odd)}" if len(odd) > MOST_LISTED else ""
    outliers = _listed(odd[:MOST_LISTED], found, names, f"Shocks that do not pass{left}{DOUBT}")
    extremes = _listed(_extremes(numbered), found, names, f"Shocks with the largest and smallest figures{DOUBT}")
    return [_summary(found), outliers, extremes]


def _listed(
    numbered: Sequence[tuple[int, JudgedShock]], found: RecordsVerdict, names: dict[str, str], caption: str
) -> Table:
    several = several_channels(found)
    rows: list[list[Cell]] = []
    for number, shock in numbered:
        inside = [clause for clause in shock.found.clauses if clause.clause == "band"]
        rows.append(
            [
                number,
                shock.direction or NONE,
                names[shock.file],
                *([shock.reading.channel.name] if several else []),
                shock.number,
                faces.amount(SECONDS, shock.pulse.time, digits=6),
                *map(doubted_words, figures_of(shock)),
                value_words(inside[0]) if inside else NONE,
                tag_of(shock.found.verdict),
                why_of_shock(shock),
            ]
        )
    heads = ["#", "direction", "record", *(["channel"] if several else []), "blow", "time"]
    heads += [*(clause_name(clause.clause) for clause in _model(found)), "band", "verdict", WHY_HEAD]
    empty = [place for place, head in enumerate(heads) if head == "band" and all(row[place] == NONE for row in rows)]
    kept = [place for place in range(len(heads)) if place not in empty]
    return Table(caption, *_units_in_heads([heads[k] for k in kept], [[row[k] for k in kept] for row in rows]), "None.")


def _units_in_heads(heads: Sequence[str], rows: Sequence[Sequence[Cell]]) -> tuple[list[str], list[list[Cell]]]:
    """Move a unit with which all cells of a column end into its head.

    Examples
    --------
    >>> _units_in_heads(["peak", "why"], [["50 ± 2 g", "-"], ["9.1 ± 0.4 g", "peak"]])
    (['peak (g)', 'why'], [['50 ± 2', '-'], ['9.1 ± 0.4', 'peak']])
    """
    columns = [[row[place] for row in rows] for place in range(len(heads))]
    named = list(heads)
    for place, column in enumerate(columns):
        parts = [_VALUE.fullmatch(str(cell)) for cell in column if cell != NONE]
        units = {part["unit"] for part in parts if part}
        if len(units) == 1 and all(parts):
            named[place] = f"{heads[place]} ({units.pop()})"
            columns[place] = [cell if cell == NONE else _VALUE.sub(r"\g<value>", str(cell)) for cell in column]
    return named, [list(row) for row in zip(*columns, strict=True)]


def _model(found: RecordsVerdict) -> list[Clause]:
    return figures_of(found.shocks[0])


def _summary(found: RecordsVerdict) -> Table:
    """Return range, mean and scatter of each figure of each group."""
    several, rows = several_channels(found), list[list[Cell]]()
    for direction, channel, here in groups(found):
        for clauses in zip(*(figures_of(one) for one in here), strict=True):
            values = [clause.value for clause in clauses if math.isfinite(clause.value)]
            if not values:
                continue
            mean, model = fmean(values), clauses[0]
            ends = [amount(model, value) for value in (min(values), mean, max(values))]
            scatter = percent(stdev(values) / mean, 2) if len(values) > 1 and mean else NONE
            rows.append(
                [group_name(direction, channel, several), clause_name(model.clause), len(values), *ends, scatter]
            )
    heads = ["shocks", "figure", "number", "smallest", "mean", "largest", "scatter (CV)"]
    return Table("All shocks, by direction", heads, rows)


def _extremes(numbered: Sequence[tuple[int, JudgedShock]]) -> list[tuple[int, JudgedShock]]:
    """Return the shocks with the largest and smallest of each figure."""
    chosen: dict[int, JudgedShock] = {}
    figures = [(number, shock, figures_of(shock)) for number, shock in numbered]
    for place in range(len(FIGURES)):
        known = [(row[place].value, number, shock) for number, shock, row in figures if math.isfinite(row[place].value)]
        for pick in (min, max) if known else ():
            _, number, shock = pick(known, key=lambda one: one[0])
            chosen[number] = shock
    return sorted(chosen.items(), key=lambda one: one[0])
