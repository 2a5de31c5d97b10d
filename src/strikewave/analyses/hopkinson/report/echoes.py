"""The report of a bar calibrated by its echoes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from strikewave.analyses.hopkinson.report.page import outcome_page
from strikewave.reporting import chapters
from strikewave.reporting.numbers import headed, percent, shown, with_unit
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, written
from strikewave.reporting.style import WHOLE, one_diagram

if TYPE_CHECKING:
    from strikewave.analyses.hopkinson.echo_result import EchoSolution
    from strikewave.hopkinson.echoes import FittedValue

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
    numbers = [
        ("bar speed", with_unit(echoes.speed.value, "m/s", "m/s", 5)),
        ("standard error", NONE if math.isnan(echoes.speed.error) else with_unit(echoes.speed.error, "m/s", "m/s", 2)),
        ("length", with_unit(echoes.length.value, "m", "mm", 5)),
        ("attenuation", f"{echoes.attenuation.value:.3g} 1/m"),
    ]
    sections = [Section("Pulses", "", pictures), Section("Result", _ECHOES, echo_tables(solution))]
    head = chapters.Summary("Report of a bar calibrated by its echoes", echo_words(solution), numbers)
    return outcome_page(solution, head, sections)


def echo_words(solution: EchoSolution) -> str:
    """Say in words what the echoes gave: on the screen and at the head of the report."""
    echoes = solution.echoes
    return (
        f"The bar speed by {echoes.times.size} passes is {with_unit(echoes.speed.value, 'm/s', 'm/s', 5)}, "
        f"{percent(solution.difference, 2, '+')} off the stated one."
    )


def echo_tables(solution: EchoSolution) -> list[Table]:
    """Return the tables of a bar calibrated by its echoes."""
    echoes = solution.echoes
    band = echoes.frequency
    rows: list[list[Cell]] = [
        [
            headed("bar speed", "m/s", "m/s"),
            *_estimated(echoes.speed, shown(1.0, "m/s", "m/s")),
            f"{percent(solution.difference, 2, '+')} off the stated {with_unit(solution.bar.speed, 'm/s', 'm/s', 6)}",
        ],
        [headed("length", "m", "mm"), *_estimated(echoes.round_trip, shown(1.0, "m", "mm")), _length_words(solution)],
        ["attenuation (1/m)", *_estimated(echoes.attenuation, 1.0), "by energy, ends included"],
        ["passes used", str(echoes.times.size), NONE, NONE, NONE, f"from number {echoes.first + 1} on"],
        [
            headed("band", "Hz", "kHz"),
            f"{shown(float(band[0]), 'Hz', 'kHz'):.3g} to {shown(float(band[-1]), 'Hz', 'kHz'):.3g}",
            NONE,
            NONE,
            NONE,
            "every pass ten times its noise",
        ],
    ]
    heads = ["quantity", "value", "standard error", "Student's factor, 95 %", "freedom", "note"]
    return [Table(f"{solution.title}: results from the echoes, dispersion {echoes.theory}", heads, rows)]


def _length_words(solution: EchoSolution) -> str:
    stated = solution.bar.length
    return (
        f"by round trips; given as {written(shown(stated, 'm', 'mm'), 6)}"
        if math.isfinite(stated)
        else "by round trips"
    )


def _estimated(estimate: FittedValue, scale: float) -> tuple[str, str, str, str]:
    if math.isnan(estimate.error):
        return f"{estimate.value * scale:.6g}", NONE, NONE, str(estimate.freedom)
    return (
        f"{estimate.value * scale:.6g}",
        f"{estimate.error * scale:.2g}",
        f"{estimate.student:.3g}",
        str(estimate.freedom),
    )
