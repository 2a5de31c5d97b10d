"""Pages of the reports of split Hopkinson bars, and page and picture as files."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from strikewave.analyses.hopkinson.figures import (
    draw_accelerations,
    draw_curves,
    draw_difference,
    draw_end_record,
    draw_forces,
    draw_losses,
    draw_passes,
    draw_rate,
    draw_record,
    draw_sensor_difference,
    draw_speed,
    draw_velocities,
    draw_waves,
    echo_summary,
    sensor_summary,
    shot_summary,
)
from strikewave.analyses.hopkinson.result import (
    AnalysedCurve,
    EchoSolution,
    HopkinsonSolution,
    Outcome,
    ReadSensitivity,
    SensorSolution,
    WaveDelay,
)
from strikewave.base.declare import GivenUnits, declarations
from strikewave.base.shock_quantities import BAR_SPEED, KILOHERTZ, LENGTH, MICROSECONDS
from strikewave.base.texts import percent
from strikewave.hopkinson import stress_difference, transits_to_uniform
from strikewave.hopkinson.checks import UNIFORM, Energy, Equilibrium, Momentum, StrikerCheck
from strikewave.hopkinson.echoes import Echoes
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, cell_text, columns_of, face_table, label_of, numbers_of, text_of
from strikewave.reporting.numbers import fixed, headed, shown, shown_unit, spelled
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, written
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import WHOLE, one_diagram, save

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def outcome_page(solution: Outcome, summary: chapters.Summary, sections: Sequence[Section]) -> str:
    """Return the page of a report: its sections, then warnings and inputs."""
    last = [chapters.warnings(solution.notices), chapters.inputs(solution.case.setup)]
    return chapters.result_page(solution, summary, [*sections, *last])


def line_of(value: Any, field: str, note: str, given: GivenUnits = MappingProxyType({})) -> list[Cell]:
    """Return a line of a table: a field of a declared value with its label, and a note."""
    return [label_of(field, declarations(type(value))[field]), cell_text(value, field, given), note]


_ECHOES = (
    "Both ends are free, and the pulse passes the gauge again and again. The phase between two passes over a known way "
    "gives the speed at each frequency, the ratio of their amplitudes over a round trip the attenuation, losses at the "
    "ends included. All passes count at once, by least squares; the standard error is by what is left of them, and "
    "Student's factor times it holds 95 %. The error of the stated distance comes on top."
)


def echo_report(solution: EchoSolution) -> str:
    """Return the report of a bar calibrated by its echoes as one HTML page."""
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
    return outcome_page(solution, head, [Section("Pulses", "", _sensor_pictures(solution)), tables])


def _sensor_pictures(solution: SensorSolution) -> list[Picture]:
    """Return the pictures of reference, reading and record."""
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
        Section("Pulses", "", _shot_pictures(solution)),
        Section("Result", f"{_SHOT}\n\n{_SLOPE}", shot_tables(solution)),
    ]
    head = chapters.Summary("Report of a split-Hopkinson shot", shot_words(solution), solution.highlights())
    return outcome_page(solution, head, sections)


def _shot_pictures(solution: HopkinsonSolution) -> list[Picture]:
    """Return the pictures of waves, forces and curves."""
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


picture: dict[type, Callable[[Any], Figure]] = {
    HopkinsonSolution: shot_summary,
    SensorSolution: sensor_summary,
    EchoSolution: echo_summary,
}
page: dict[type, Callable[[Any], str]] = {
    HopkinsonSolution: shot_report,
    SensorSolution: sensor_report,
    EchoSolution: echo_report,
}
"""Pages of the results in Python, found as `picture` is by `strikewave.reporting.shown_result`."""


def draw_result(solution: HopkinsonSolution | SensorSolution | EchoSolution, folder: Path) -> list[str]:
    """Write page and picture of a set-up into a folder, and return their names."""
    with drawing(folder / "summary.svg") as path:
        save(picture[type(solution)](solution), path)
    with drawing(folder / "report.html") as path:
        path.write_text(page[type(solution)](solution), "utf-8", newline="\n")
    return ["report.html", "summary.svg"]
