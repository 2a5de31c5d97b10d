"""The report of an impact of two free bodies: its numbers, its histories, and the laws that it rests on."""

from __future__ import annotations

from strikewave.analyses.impact.figures.contact import impact_sheet
from strikewave.analyses.impact.result import MOST_ROWS, ImpactResult, answer_table, blow_table, first_rows
from strikewave.reporting import chapters
from strikewave.reporting.numbers import percent, with_unit
from strikewave.reporting.parts import Cell, Picture, Section, Table


def impact_report(result: ImpactResult) -> str:
    """Return the report of an impact as one HTML page: no script, nothing fetched, the same bytes each time."""
    drawn, many = result.drawn, len(result.blows) > 1
    figure = impact_sheet([result.blows[k] for k in drawn], [f"blow {k + 1}" for k in drawn], "")
    caption = (
        "Force over time and over indentation, and the phase plane: shares of the approach speed and of the depth."
    )
    rows: list[list[Cell]] = [[name, value] for name, value in first_rows(result.setup, result.blows[0])]
    sections = [
        Section("Histories", "", [Picture(figure, caption)]),
        Section("First blow" if many else "Blow", "", [Table("Numbers", ["", "value"], rows), *_answers(result)]),
        *([_blows(result)] if many else []),
        chapters.warnings(result.notices),
    ]
    summary = chapters.Summary("Report of an impact", impact_words(result), _key_numbers(result))
    return chapters.result_page(result, summary, sections)


def impact_words(result: ImpactResult) -> str:
    """Say in words what happens."""
    setup, first = result.setup, result.blows[0]
    m1, m2 = (with_unit(mass, "kg", "kg") if mass < float("inf") else "a fixed body" for mass in setup.masses)
    return (
        f"{m1} strikes {m2} at {with_unit(setup.speed, 'm/s', 'm/s')}: the force peaks at "
        f"{with_unit(float(first.peak_force), 'N', 'kN')} and lasts {with_unit(float(first.duration), 's', 'us')}; the "
        f"coefficient of restitution is {float(first.restitution):.4g}. Solved by the {first.method}."
    )


def _key_numbers(result: ImpactResult) -> list[tuple[str, str]]:
    first, energy = result.blows[0], float(result.blows[0].energy_lost)
    return [
        ("peak force", with_unit(float(first.peak_force), "N", "kN")),
        ("duration", with_unit(float(first.duration), "s", "us")),
        ("largest indentation", with_unit(float(first.max_indentation), "m", "um")),
        ("coefficient of restitution", f"{float(first.restitution):.4g}"),
        ("energy lost", with_unit(energy, "J", "J", 3)),
        ("energy lost, share of that of the approach", percent(1.0 - float(first.restitution) ** 2)),
    ]


def _answers(result: ImpactResult) -> list[Table]:
    if not result.answers.differ:
        return []
    heads, rows = answer_table(result.answers)
    return [Table("First blow with its contact elastic and yielding", heads, rows)]


def _blows(result: ImpactResult) -> Section:
    heads, rows = blow_table(result.blows)
    some = f"The first and last {MOST_ROWS // 2} of {len(result.blows)} blows." if len(result.blows) > MOST_ROWS else ""
    return Section("Blows", some, [Table("Blows on the same spot", heads, rows)])
