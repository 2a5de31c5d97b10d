"""The report of an accelerometer on the end of a bar."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from strikewave.analyses.hopkinson.report.page import line_of, outcome_page
from strikewave.analyses.hopkinson.sensor_result import ReadSensitivity
from strikewave.base.declare import declarations
from strikewave.reporting import chapters
from strikewave.reporting.faces import cell_text, text_of
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table
from strikewave.reporting.style import WHOLE, one_diagram

if TYPE_CHECKING:
    from strikewave.analyses.hopkinson.sensor_result import SensorSolution

_SENSOR = (
    "The incident wave, carried from the gauge to the end, gives the motion of the sensor and its mount: v = 2 c ε at "
    "a bare end, m dv/dt = 2 E A ε − Z v for a rigid mass, waves in the disk for an elastic one. Reference and "
    "reading are low-passed alike at the bandwidth stated (zero phase, 4 poles a pass). The delay is that of the "
    "largest correlation, the sensitivity the slope by least squares of reading over reference."
)
_DOUBT = (
    "The uncertainty adds squares: the scatter of the slope by the residual, taken as noise of its own colour; by how "
    "much the noise of the reference lowers the slope; and what the set-up states for strain and bar speed. Nothing "
    "is in it for the mass on the end, nor for a wrong model of the end: to check these, compare the reflected wave, "
    "which the reference does not use."
)


def sensor_report(solution: SensorSolution) -> str:
    """Return the report of an accelerometer on the end of a bar as one HTML page."""
    tables = Section("Result", f"{_SENSOR}\n\n{_DOUBT}", sensor_tables(solution))
    head = chapters.Summary(
        "Report of an accelerometer on the end of a bar", sensor_words(solution), solution.highlights()
    )
    return outcome_page(solution, head, [Section("Pulses", "", _pictures(solution)), tables])


def _pictures(solution: SensorSolution) -> list[Picture]:
    """Return the pictures of reference, reading and record."""
    from strikewave.analyses.hopkinson.figures import (
        draw_accelerations,
        draw_end_record,
        draw_sensor_difference,
        draw_velocities,
    )

    return [
        Picture(
            one_diagram(lambda axes: draw_accelerations(axes, solution), WHOLE), "Reference and reading of the sensor."
        ),
        Picture(one_diagram(lambda axes: draw_sensor_difference(axes, solution)), "Their difference."),
        Picture(
            one_diagram(lambda axes: draw_velocities(axes, solution)),
            "Velocity: the reference, the reading integrated, and the end of the bar by both waves.",
        ),
        Picture(
            one_diagram(lambda axes: draw_end_record(axes, solution), WHOLE),
            "The strain at the gauge, and the windows of the pulses.",
        ),
    ]


def sensor_words(solution: SensorSolution) -> str:
    """Say in words what the sensor read: on the screen and at the head of the report."""
    sensitivity = solution.sensitivity
    value = text_of(sensitivity, "value", solution.given_units)
    what = "the sensitivity of the sensor" if solution.unit == "V" else "the reading over the reference"
    assumed = "The first pulse at the gauge is taken as compression, whatever its sign"
    return (
        f"{assumed}: {what} is {value} at {text_of(solution.bandwidth, 'value')} (standard uncertainty "
        f"{text_of(sensitivity, 'relative')}), and {text_of(solution.comparison, 'residual')} of "
        "the reading does not follow the reference."
        if solution.quoted
        else f"{assumed}. The rise of the pulse is too steep at this bandwidth for accelerations to be quoted."
    )


def sensor_tables(solution: SensorSolution) -> list[Table]:
    """Return the tables of an accelerometer on the end of a bar."""
    return [_sensitivity_table(solution), _agreement_table(solution), _uncertainty_table(solution)]


def _sensitivity_table(solution: SensorSolution) -> Table:
    found, peak, change = solution.sensitivity, solution.peak, solution.velocity_change

    def text(value: Any, name: str) -> str:
        return cell_text(value, name, solution.given_units)

    slope = f"{text(found, 'value')} ± {text(found, 'standard_uncertainty')}"
    by_peaks = text(found, "by_peaks")
    if not solution.quoted:
        slope = by_peaks = "not quoted: rise too steep"
    rows: list[list[Cell]] = [
        ["slope by least squares", NONE, NONE, slope],
        ["largest acceleration", text(peak, "acceleration"), text(peak, "reading"), by_peaks],
        ["velocity change", text(change, "velocity"), text(change, "reading_integral"), text(found, "by_velocity")],
    ]
    heads = ["quantity", "reference by the gauge", "reading", "reading over reference"]
    caption = (
        f"{solution.title}: sensitivity with its standard uncertainty, at {cell_text(solution.bandwidth, 'value')} "
        f"(set by: {solution.bandwidth.reason})"
    )
    return Table(caption, heads, rows)


def _agreement_table(solution: SensorSolution) -> Table:
    comparison, end = solution.comparison, solution.end
    disk = "" if end.disk_mass is None else f", elastic disk of {cell_text(end, 'disk_mass')}"
    rows = [
        line_of(comparison, "delay", "against gauge and bar speed"),
        line_of(comparison, "correlation", "at that delay"),
        line_of(comparison, "residual", "root mean square"),
        line_of(comparison, "reference_noise", "of the gauge, at the bandwidth"),
        line_of(solution.peak, "reading_noise", "at the bandwidth", solution.given_units),
        line_of(solution, "rise_diameters", "not quoted below 2, warned below 5"),
        line_of(solution.bandwidth, "noise", "at the gauge"),
        line_of(comparison, "reflected_misfit", "root mean square"),
        line_of(end, "mass", f"sensor and rigid disk{disk}"),
    ]
    return Table("Agreement of reading and reference", ["quantity", "value", "note"], rows)


def _uncertainty_table(solution: SensorSolution) -> Table:
    names = ("scatter", "bias", "strain_uncertainty", "speed_uncertainty", "relative")
    notes = {name: declarations(ReadSensitivity)[name].meaning for name in names}
    notes["speed_uncertainty"] += f" {solution.comparison.speed_power:.3g}"
    rows = [line_of(solution.sensitivity, name, note) for name, note in notes.items()]
    return Table("Relative standard uncertainty of the sensitivity", ["part", "value", "from"], rows)
