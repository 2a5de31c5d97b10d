"""Chapter of a report on the verdict: clauses, shocks by direction, and the band over each shock."""

from __future__ import annotations

from strikewave.analyses.clauses import SHOWN, clause_columns, clause_name, decision_words, doubted_words, tag_of
from strikewave.analyses.record.figures.verdicts import shock_figure
from strikewave.analyses.record.sentences import WHY_HEAD, name_of_shock, why_of_shock
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table
from strikewave.specifications.judged_records import JudgedShock, RecordsVerdict
from strikewave.specifications.judging import NOT_JUDGED, WORST_FIRST, Clause

MOST_DRAWN = 12  # shocks that are drawn, those that fail first: each adds some 40 kB to a page that must open at once
DRAWN_FIRST = 2  # shocks that are drawn before the tables: a row of the page, so that pulse and band are seen at once
MOST_ROWS = 200  # shocks that the table lists; JSON has all


def verdict_section(records: RecordsVerdict, names: dict[str, str]) -> Section:
    """Return the chapter of a verdict."""
    several, many = several_channels(records), len(records.shocks) > 1
    tables: list[Part] = [clause_table(records, names)]
    if many:
        tables.append(_shock_table(records, names, several))
    drawn = sorted(records.shocks, key=lambda shock: WORST_FIRST.index(shock.found.verdict))[:MOST_DRAWN]
    place = "within the band" if records.limits.band is not None else "about the ideal pulse"
    pictures = []
    for shock in drawn:
        name, verdict = name_of_shock(shock, names, several), SHOWN[shock.found.verdict]
        figure = shock_figure(shock, records.limits, name)
        pictures.append(Picture(figure, f"{name}: {verdict}.", f"Shock {name} {place}: {verdict}."))
    text = decision_words(records.asked.rule, records.asked.holds, records.asked.not_stated)
    by = " (ISO 14253-1, JCGM 106)" if records.asked.rule == "guarded" else ""
    text += f" U is the expanded uncertainty{by}. {limit_words_of(records)}"
    if len(records.shocks) > len(drawn):
        text += f" {len(drawn)} of {len(records.shocks)} shocks are drawn, those that fail first."
    return Section("Verdict by the specification", text, [*pictures[:DRAWN_FIRST], *tables, *pictures[DRAWN_FIRST:]])


def clause_table(verdict: RecordsVerdict, names: dict[str, str]) -> Table:
    """Return the clauses with what came out, each of several shocks where it came out worst."""
    several, many = several_channels(verdict), len(verdict.shocks) > 1

    def why(clause: Clause, shock: JudgedShock | None) -> str | None:
        named = many and shock is not None and clause.verdict != NOT_JUDGED
        return ": ".join([name_of_shock(shock, names, several)] * named + [clause.reason] * bool(clause.reason)) or None

    columns = clause_columns([clause for clause, _ in verdict.clauses])
    columns.append(Column("where and why" if many else "why", [why(*pair) for pair in verdict.clauses]))
    return page_table("Clauses" + (", each where it came out worst" if many else ""), columns)


def several_channels(verdict: RecordsVerdict) -> bool:
    """Tell whether shocks of several channels were judged."""
    return len({shock.reading.channel.name for shock in verdict.shocks}) > 1


def limit_words_of(verdict: RecordsVerdict) -> str:
    """Say how the band lies, how the numbers of the specification are known, and where they come from."""
    file, words = verdict.specification.file, ""
    if verdict.limits.band is not None:
        words = (
            "The band lies where the smallest distance of the record to it is largest; the velocity change is "
            "integrated about that place. "
        )
    words += (
        "The status of a limit is normative (read in the standard), quoted (second-hand) or indicative (from memory); "
        "that of its weakest number counts."
    )
    note = f" {' '.join(file.note.split())}" if file.note else ""
    demands = "".join(f" {one.text.rstrip('.')} (not judged here)." for one in file.demand)
    return f"{words}\n\nSource: {file.source}.{note}{demands}"


def _shock_table(verdict: RecordsVerdict, names: dict[str, str], several: bool) -> Table:
    by_name = list(dict.fromkeys(clause.clause for shock in verdict.shocks for clause in shock.found.clauses))
    directed = any(shock.direction for shock in verdict.shocks)
    rows: list[list[Cell]] = []
    for shock in verdict.shocks[:MOST_ROWS]:
        clauses = {clause.clause: clause for clause in shock.found.clauses}
        rows.append(
            [
                name_of_shock(shock, names, several),
                tag_of(shock.found.verdict),
                *([shock.direction or NONE] if directed else []),
                *[doubted_words(clauses[name]) if name in clauses else NONE for name in by_name],
                why_of_shock(shock),
            ]
        )
    heads = ["shock", "verdict", *(["direction"] if directed else []), *map(clause_name, by_name), WHY_HEAD]
    left = f", the first {MOST_ROWS} of {len(verdict.shocks)}" if len(verdict.shocks) > MOST_ROWS else ""
    return Table(f"Shocks{left}", heads, rows)
