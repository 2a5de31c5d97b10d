"""The report of an accelerometer on the end of a bar."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from strikewave.analyses.hopkinson.report.page import delay_words, outcome_page
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.reporting import chapters
from strikewave.reporting.numbers import percent, with_unit
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
    comparison, share = solution.comparison, solution.uncertainty.combined
    sensitivity = _sensitivity(solution.sensitivity, solution.unit)
    numbers = [
        ("sensitivity" if solution.unit == "V" else "reading over reference", sensitivity if solution.quoted else NONE),
        ("standard uncertainty", percent(share, 2) if solution.quoted else NONE),
        ("largest acceleration", with_unit(solution.peaks[0], "m/s^2", "g")),
        ("velocity change", with_unit(comparison.velocities[0], "m/s", "m/s")),
        ("delay", delay_words(comparison.agreement.delay, 2)),
    ]
    tables = Section("Result", f"{_SENSOR}\n\n{_DOUBT}", sensor_tables(solution))
    head = chapters.Summary("Report of an accelerometer on the end of a bar", sensor_words(solution), numbers)
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
    comparison = solution.comparison
    sensitivity = _sensitivity(solution.sensitivity, solution.unit)
    what = "the sensitivity of the sensor" if solution.unit == "V" else "the reading over the reference"
    assumed = "The first pulse at the gauge is taken as compression, whatever its sign"
    return (
        f"{assumed}: {what} is {sensitivity} at {with_unit(comparison.bandwidth.value, 'Hz', 'kHz')} (standard "
        f"uncertainty {percent(solution.uncertainty.combined, 2)}), and {percent(comparison.agreement.residual, 1)} of "
        "the reading does not follow the reference."
        if solution.quoted
        else f"{assumed}. The rise of the pulse is too steep at this bandwidth for accelerations to be quoted."
    )


def sensor_tables(solution: SensorSolution) -> list[Table]:
    """Return the tables of an accelerometer on the end of a bar."""
    return [_sensitivity_table(solution), _agreement_table(solution), _uncertainty_table(solution)]


def _sensitivity_table(solution: SensorSolution) -> Table:
    comparison, unit = solution.comparison, solution.unit
    (peak, reading), (velocity, integral) = solution.peaks, comparison.velocities
    share = solution.uncertainty.combined
    slope = solution.sensitivity
    rows: list[list[Cell]] = [
        [
            "slope by least squares",
            NONE,
            NONE,
            f"{_sensitivity(slope, unit)} ± {_sensitivity(abs(slope) * share, unit, 2)}",
        ],
        [
            "largest acceleration",
            with_unit(peak, "m/s^2", "g"),
            _read(reading, unit),
            _sensitivity(reading / peak, unit),
        ],
        [
            "velocity change",
            with_unit(velocity, "m/s", "m/s"),
            _integral(integral, unit),
            _sensitivity(integral / velocity, unit),
        ],
    ]
    if not solution.quoted:
        rows[0][3] = rows[1][3] = "not quoted: rise too steep"
    heads = ["quantity", "reference by the gauge", "reading", "reading over reference"]
    bandwidth = comparison.bandwidth
    caption = (
        f"{solution.title}: sensitivity with its standard uncertainty, at {with_unit(bandwidth.value, 'Hz', 'kHz')} "
        f"(set by: {bandwidth.reason})"
    )
    return Table(caption, heads, rows)


def _agreement_table(solution: SensorSolution) -> Table:
    comparison, standing = solution.comparison, solution.standing
    reflected = NONE if math.isnan(comparison.reflected_misfit) else percent(comparison.reflected_misfit, 2)
    disk = f", elastic disk of {with_unit(standing.disk.mass, 'kg', 'gram')}" if standing.disk else ""
    rows: list[list[Cell]] = [
        ["delay of the reading", delay_words(comparison.agreement.delay, 3), "against gauge and bar speed"],
        ["correlation", f"{comparison.correlation:.5f}", "at that delay"],
        ["residual over reading", percent(comparison.agreement.residual, 2), "root mean square"],
        [
            "noise of the reference",
            with_unit(comparison.reference_noise, "m/s^2", "g"),
            "of the gauge, at the bandwidth",
        ],
        ["noise of the reading", _read(comparison.reading_noise, solution.unit), "at the bandwidth"],
        ["rise left, in diameters of travel", f"{solution.rise_diameters:.3g}", "not quoted below 2, warned below 5"],
        [
            "frequency at which the pulse sinks in noise",
            with_unit(comparison.bandwidth.noise, "Hz", "kHz"),
            "at the gauge",
        ],
        ["velocity by both waves, off the model", reflected, "root mean square"],
        ["mass on the end", with_unit(standing.mass, "kg", "gram"), f"sensor and rigid disk{disk}"],
    ]
    return Table("Agreement of reading and reference", ["quantity", "value", "note"], rows)


def _uncertainty_table(solution: SensorSolution) -> Table:
    parts, power = solution.uncertainty, solution.comparison.speed_power
    origins = {
        "scatter": "residual of the slope",
        "bias": "noise of the reference, which lowers a slope",
        "strain": "stated for the strain at the gauge",
        "speed": f"stated for the bar speed, which counts with its power {power:.3g}",
    }
    rows: list[list[Cell]] = [
        [name, NONE if math.isnan(part) else percent(part, 2), origins[name]] for name, part in parts._asdict().items()
    ]
    rows.append(["combined", percent(parts.combined, 2), "root of the sum of squares of those that are known"])
    return Table("Relative standard uncertainty of the sensitivity", ["part", "value", "from"], rows)


def _read(value: float, unit: str) -> str:
    """Write a reading: volts as they are, an acceleration in g."""
    return with_unit(value, "V", "mV") if unit == "V" else with_unit(value, "m/s^2", "g")


def _integral(value: float, unit: str) -> str:
    return f"{value * 1e6:.4g} mV ms" if unit == "V" else with_unit(value, "m/s", "m/s")


def _sensitivity(value: float, unit: str, digits: int = 5) -> str:
    """Write reading over reference: volts in mV/g, a ratio as it is."""
    return f"{value * STANDARD_GRAVITY * 1e3:.{digits}g} mV/g" if unit == "V" else f"{value:.{digits}g}"
