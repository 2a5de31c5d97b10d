"""The report of a reduced shot of split Hopkinson bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from strikewave.analyses.hopkinson.report.page import line_of, outcome_page
from strikewave.analyses.hopkinson.result import AnalysedCurve, WaveDelay
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.hopkinson import stress_difference, transits_to_uniform
from strikewave.hopkinson.checks import StrikerCheck
from strikewave.hopkinson.uniformity import UNIFORM
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import cell_text, columns_of, face_table, numbers_of, text_of
from strikewave.reporting.numbers import fixed, headed, percent, shown, spelled
from strikewave.reporting.parts import Cell, Picture, Section, Table, written
from strikewave.reporting.shown_units import shown_unit
from strikewave.reporting.style import WHOLE, one_diagram

if TYPE_CHECKING:
    from strikewave.analyses.hopkinson.result import HopkinsonSolution
    from strikewave.hopkinson.checks import Energy, Equilibrium, Momentum

RISE_SHARE = 0.8
"""Share of a straight rise that lies between 10 and 90 % of it."""
_SHOT = (
    "Compression is positive. Each pulse is carried from its gauge to the specimen; forces are F1 = E A (incident + "
    "reflected) and F2 = E A transmitted, face velocities c (incident − reflected) and c transmitted. 1-wave takes the "
    "stress from F2 and the rate from the reflected wave alone, 2-wave the stress from F1 with the same rate, 3-wave "
    "the mean force and all three waves."
)
_SLOPE = (
    "The slope of the rise is fitted from 10 to 50 % of the largest stress; in brackets is what it becomes where "
    "reflected and transmitted wave come a sample earlier or later. It is a check, not Young's modulus: equilibrium "
    "comes late in the rise, and the bar faces deform."
)


def shot_report(solution: HopkinsonSolution) -> str:
    """Return the report of a reduced shot as one HTML page."""
    sections = [
        Section("Pulses", "", _pictures(solution)),
        Section("Result", f"{_SHOT}\n\n{_SLOPE}", shot_tables(solution)),
    ]
    head = chapters.Summary("Report of a split-Hopkinson shot", shot_words(solution), solution.highlights())
    return outcome_page(solution, head, sections)


def _pictures(solution: HopkinsonSolution) -> list[Picture]:
    """Return the pictures of waves, forces and curves."""
    from strikewave.analyses.hopkinson.figures import (
        draw_curves,
        draw_difference,
        draw_forces,
        draw_rate,
        draw_record,
        draw_waves,
    )

    r, pulses = solution.reduction, solution.pulses
    return [
        Picture(
            one_diagram(lambda axes: draw_record(axes, pulses), WHOLE),
            "The strain records, and the windows of the pulses.",
        ),
        Picture(
            one_diagram(lambda axes: draw_waves(axes, r), WHOLE),
            "The waves at the specimen. The dotted line is the end of the incident wave.",
        ),
        Picture(one_diagram(lambda axes: draw_forces(axes, solution)), "Forces on both faces of the specimen."),
        Picture(one_diagram(lambda axes: draw_difference(axes, solution)), "Their difference."),
        Picture(one_diagram(lambda axes: draw_curves(axes, r)), "True stress over true strain."),
        Picture(one_diagram(lambda axes: draw_rate(axes, r)), "True strain rate over true strain."),
    ]


def shot_words(solution: HopkinsonSolution) -> str:
    """Say in words what the specimen did: on the screen and at the head of the report."""
    strain, stress, rate = (text_of(solution.largest, name) for name in ("strain", "stress", "rate"))
    _, missed, missing = _closing(solution)
    return (
        f"Each first pulse is taken as compression, whatever its sign: the specimen reached a true strain of {strain} "
        f"at {rate} (median) and a true stress of {stress}. The forces on its faces differ by "
        f"{text_of(solution.equilibrium, 'misfit')} of their mean, and {missed} of the incident impulse is {missing}."
    )


def _closing(solution: HopkinsonSolution) -> tuple[str, str, str]:
    """Return name and text of the field that says by how much the impulses miss each other, and how they do."""
    field, words = ("excess", "in excess") if solution.momentum.missing is None else ("missing", "missing")
    return field, cell_text(solution.momentum, field), words


def shot_tables(solution: HopkinsonSolution) -> list[Table]:
    """Return the tables of a reduced shot."""
    return [
        _curve_table(solution),
        _balance_table(solution),
        _alignment_table(solution),
        face_table(solution, "bars"),
        *_striker_table(solution),
        *_theory_table(solution),
    ]


def _curve_table(solution: HopkinsonSolution) -> Table:
    caption = (
        f"{solution.title}: largest true strain and stress, median true rate, slope from 10 to 50 % of the largest "
        "stress (and within a sample of misalignment); * the one chosen"
    )
    return page_table(caption, columns_of(AnalysedCurve, solution.analysed))


def _balance_table(solution: HopkinsonSolution) -> Table:
    equilibrium, impulses, work, limits = (
        solution.equilibrium,
        solution.momentum,
        solution.energy,
        solution.case.setup.limits,
    )
    wrong = "" if work.acceleration >= 0.0 else "; below 0: the forces do not balance"
    rows: list[list[Cell]] = [
        line_of(equilibrium, "misfit", f"limit {percent(limits.force_misfit.si, 0)}"),
        line_of(equilibrium, "force_ratio", "1 but for the specimen's own momentum"),
        [
            f"forces agree to {percent(UNIFORM, 0)}",
            _agreeing(equilibrium),
            f"in all over {cell_text(equilibrium, 'share')} of the loading",
        ],
        line_of(impulses, _closing(solution)[0], f"of the incident one; limit {percent(limits.momentum.si, 0)}"),
        ["incident, reflected, transmitted impulse", _three(impulses), f"specimen {cell_text(impulses, 'specimen')}"],
        ["incident, reflected, transmitted energy", _three(work), ""],
        line_of(
            work,
            "absorbed",
            f"deforms {cell_text(work, 'deformation')}, moves {cell_text(work, 'acceleration')}{wrong}",
        ),
    ]
    return Table(
        "Force, momentum and energy balance while the incident wave lasts", ["quantity", "value", "note"], rows
    )


def _agreeing(equilibrium: Equilibrium) -> str:
    """Write the longest stretch in which the forces agree."""
    if math.isnan(equilibrium.begin):
        return "in no lasting stretch"
    begin, end = (fixed(time, *MICROSECONDS.units, 1) for time in (equilibrium.begin, equilibrium.end))
    return f"from {begin} to {end} {spelled(shown_unit(*MICROSECONDS.units))}"


def _three(waves: Momentum | Energy) -> str:
    """Write what incident, reflected and transmitted wave carry."""
    numbers = numbers_of(waves, {})
    return f"{', '.join(text for text, _ in numbers)} {spelled(numbers[0][1])}"


def _alignment_table(solution: HopkinsonSolution) -> Table:
    alignment = solution.alignment
    caption = (
        f"Delay of the waves at the specimen against geometry; alignment {alignment.method}, dispersion "
        f"{alignment.dispersion} up to {cell_text(alignment, 'band')}, largest shift allowed "
        f"{cell_text(alignment, 'window')}, the rise"
    )
    return page_table(caption, columns_of(WaveDelay, alignment.delays))


def _striker_table(solution: HopkinsonSolution) -> list[Table]:
    check = solution.striker_check
    if check is None:
        return []
    measured, expected = (columns_of(StrikerCheck, [check], table) for table in ("measured", "expected"))
    rows = [[one.head, *one.cells(), *other.cells()] for one, other in zip(measured, expected, strict=True)]
    caption = f"Incident pulse compared with the striker; the plateau corresponds to {cell_text(check, 'speed')}"
    return [Table(caption, ["quantity", "measured", "v Zs/((Zs+Zb) c), 2 Ls/cs"], rows)]


def _theory_table(solution: HopkinsonSolution) -> list[Table]:
    """Say how soon an elastic specimen would be in equilibrium, where its density and modulus are known."""
    specimen, bar = solution.reduction.specimen, solution.reduction.bars[0]
    beta, transit = specimen.impedance_ratio(bar), specimen.transit
    if beta is None or transit is None:
        return []
    rise, uniform = solution.pulses.rise / RISE_SHARE / transit, percent(UNIFORM, 0)
    rows: list[list[Cell]] = [
        ["impedance of the specimen over that of the bar", f"{beta:.4g}"],
        [headed("transit of the specimen", *MICROSECONDS.units), written(shown(transit, *MICROSECONDS.units))],
        ["force difference after a step, transit 3", percent(float(stress_difference(beta, 3)), 1)],
        ["force difference after a step, transit 5", percent(float(stress_difference(beta, 5)), 2)],
        [f"transits to {uniform} after a step", f"{transits_to_uniform(beta):.4g}"],
        [
            f"transits to {uniform} under a straight rise of {rise:.3g} transits",
            f"{transits_to_uniform(beta, rise):.4g}",
        ],
    ]
    return [Table("Theoretical equilibrium of an elastic specimen", ["quantity", "value"], rows)]
