"""The report of a bar calibrated by its echoes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from strikewave.analyses.hopkinson.report.page import outcome_page
from strikewave.base.declare import declarations
from strikewave.base.shock_quantities import BAR_SPEED, KILOHERTZ, LENGTH
from strikewave.hopkinson.echoes import Echoes
from strikewave.reporting import chapters
from strikewave.reporting.faces import amount, cell_text, label_of, text_of
from strikewave.reporting.numbers import headed, shown
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table
from strikewave.reporting.style import WHOLE, one_diagram

if TYPE_CHECKING:
    from strikewave.analyses.hopkinson.echo_result import EchoSolution

_ECHOES = (
    "Both ends are free, and the pulse passes the gauge again and again. The phase between two passes over a known way "
    "gives the speed at each frequency, the ratio of their amplitudes over a round trip the attenuation, losses at the "
    "ends included. All passes count at once, by least squares; the standard error is by what is left of them, and "
    "Student's factor times it holds 95 %. The error of the stated distance comes on top."
)


def echo_report(solution: EchoSolution) -> str:
    """Return the report of a bar calibrated by its echoes as one HTML page."""
    from strikewave.analyses.hopkinson.figures import draw_losses, draw_passes, draw_speed

    echoes = solution.echoes
    pictures = [
        Picture(one_diagram(lambda axes: draw_passes(axes, echoes), WHOLE), "The passes of the pulse at the gauge."),
        Picture(one_diagram(lambda axes: draw_speed(axes, echoes, solution.bar.speed)), "Phase speed by the echoes."),
        Picture(one_diagram(lambda axes: draw_losses(axes, echoes)), "Attenuation by the echoes."),
    ]
    sections = [Section("Pulses", "", pictures), Section("Result", _ECHOES, echo_tables(solution))]
    head = chapters.Summary("Report of a bar calibrated by its echoes", echo_words(solution), solution.highlights())
    return outcome_page(solution, head, sections)


def echo_words(solution: EchoSolution) -> str:
    """Say in words what the echoes gave: on the screen and at the head of the report."""
    echoes = solution.echoes
    return (
        f"The bar speed by {echoes.times.size} passes is {amount(BAR_SPEED, echoes.speed.value, digits=5)}, "
        f"{text_of(echoes, 'difference')} off the stated one."
    )


def echo_tables(solution: EchoSolution) -> list[Table]:
    """Return the tables of a bar calibrated by its echoes."""
    echoes = solution.echoes
    band = [shown(float(echoes.frequency[place]), *KILOHERTZ.units) for place in (0, -1)]
    given = f"; given as {amount(LENGTH, solution.bar.length, digits=6)}" if math.isfinite(solution.bar.length) else ""
    notes = {
        "speed": f"{cell_text(echoes, 'difference')} off the stated {cell_text(echoes, 'stated_speed')}",
        "round_trip": f"by round trips{given}",
        "attenuation": "by energy, ends included",
    }
    rows: list[list[Cell]] = [[*_fitted(echoes, name), note] for name, note in notes.items()]
    rows += [
        ["passes used", str(echoes.times.size), NONE, NONE, NONE, f"from number {echoes.first + 1} on"],
        [
            headed("band", *KILOHERTZ.units),
            f"{band[0]:.3g} to {band[1]:.3g}",
            NONE,
            NONE,
            NONE,
            "every pass ten times its noise",
        ],
    ]
    heads = ["quantity", "value", "standard error", "Student's factor, 95 %", "freedom", "note"]
    return [Table(f"{solution.title}: results from the echoes, dispersion {echoes.theory}", heads, rows)]


def _fitted(echoes: Echoes, name: str) -> list[Cell]:
    """Return label, value, standard error, Student's factor and freedom of a value by least squares."""
    one, fitted = declarations(Echoes)[name], getattr(echoes, name)
    si, usual = one.quantity[:2]
    doubt = [NONE, NONE]
    if not math.isnan(fitted.error):
        doubt = [f"{shown(fitted.error, si, usual):.2g}", f"{fitted.student:.3g}"]
    label = headed(label_of(name, one), si, usual)
    return [label, f"{shown(fitted.value, si, usual):.6g}", *doubt, str(fitted.freedom)]
