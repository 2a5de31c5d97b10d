"""The reports of split Hopkinson bars: tables, summary and page of a shot, of a bar alone, of a sensor on a bar end."""

from __future__ import annotations

import math
from collections.abc import Callable
from types import MappingProxyType
from typing import Any, NamedTuple

from strikewave.analyses.hopkinson.figures import pictures, sheet
from strikewave.analyses.hopkinson.result import (
    AnalysedCurve,
    EchoSolution,
    HopkinsonSolution,
    ReadSensitivity,
    SensorSolution,
    WaveDelay,
)
from strikewave.base.declare import GivenUnits, declarations
from strikewave.base.shock_quantities import BAR_SPEED, KILOHERTZ, LENGTH, MICROSECONDS
from strikewave.base.texts import percent
from strikewave.hopkinson import stress_difference, transits_to_uniform
from strikewave.hopkinson.checks import UNIFORM, Energy, Momentum, StrikerCheck
from strikewave.hopkinson.echoes import Echoes
from strikewave.reporting import chapters
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, cell_text, columns_of, face_table, label_of, numbers_of, text_of
from strikewave.reporting.numbers import fixed, headed, shown, shown_unit, spelled
from strikewave.reporting.parts import NONE, Cell, Section, Table, written

AnySolution = HopkinsonSolution | SensorSolution | EchoSolution


def line_of(value: Any, field: str, note: str, given: GivenUnits = MappingProxyType({})) -> list[Cell]:
    """Return a line of a table: a field of a declared value with its label, and a note."""
    return [label_of(field, declarations(type(value))[field]), cell_text(value, field, given), note]


_ECHOES = (
    "Both ends are free, and the pulse passes the gauge again and again. The phase between two passes over a known way "
    "gives the speed at each frequency, the ratio of their amplitudes over a round trip the attenuation, losses at the "
    "ends included. All passes count at once, by least squares; the standard error is by what is left of them, and "
    "Student's factor times it holds 95 %. The error of the stated distance comes on top."
)


def echo_words(solution: EchoSolution) -> str:
    """Return the result of the echoes in a sentence, for the screen and the head of the report."""
    echoes = solution.echoes
    return (
        f"The bar speed by {echoes.times.size} passes is {amount(BAR_SPEED, echoes.speed.value, digits=5)}, "
        f"{text_of(echoes, 'difference')} off the stated one."
    )


def echo_tables(solution: EchoSolution) -> list[Table]:
    """Return the tables of a bar calibrated by its echoes."""
    echoes = solution.echoes
    band = [shown(float(echoes.frequency[place]), *KILOHERTZ.units) for place in (0, -1)]
    stated = f"; given as {amount(LENGTH, solution.bar.length, digits=6)}" if math.isfinite(solution.bar.length) else ""
    notes = {
        "speed": f"{cell_text(echoes, 'difference')} off the stated {cell_text(echoes, 'stated_speed')}",
        "round_trip": f"by round trips{stated}",
        "attenuation": "by energy, ends included",
    }
    rows: list[list[Cell]] = []
    for name, note in notes.items():
        declared, fitted = declarations(Echoes)[name], getattr(echoes, name)
        si, usual = declared.quantity[:2]
        doubt = [NONE, NONE]
        if not math.isnan(fitted.error):
            doubt = [f"{shown(fitted.error, si, usual):.2g}", f"{fitted.student:.3g}"]
        value = f"{shown(fitted.value, si, usual):.6g}"
        rows.append([headed(label_of(name, declared), si, usual), value, *doubt, str(fitted.freedom), note])
    none = [NONE] * 3
    rows.append(["passes used", str(echoes.times.size), *none, f"from number {echoes.first + 1} on"])
    limits = f"{band[0]:.3g} to {band[1]:.3g}"
    rows.append([headed("band", *KILOHERTZ.units), limits, *none, "every pass ten times its noise"])
    heads = ["quantity", "value", "standard error", "Student's factor, 95 %", "freedom", "note"]
    return [Table(f"{solution.title}: results from the echoes, dispersion {echoes.theory}", heads, rows)]


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


def sensor_words(solution: SensorSolution) -> str:
    """Return the result of the sensor in a sentence, for the screen and the head of the report."""
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
    sensitivity, peak, change = solution.sensitivity, solution.peak, solution.velocity_change
    comparison, end, bandwidth = solution.comparison, solution.end, solution.bandwidth

    def text(value: Any, name: str) -> str:
        return cell_text(value, name, solution.given_units)

    slope = f"{text(sensitivity, 'value')} ± {text(sensitivity, 'standard_uncertainty')}"
    by_peaks = text(sensitivity, "by_peaks")
    if not solution.quoted:
        slope = by_peaks = "not quoted: rise too steep"
    by_velocity = text(sensitivity, "by_velocity")
    ratios: list[list[Cell]] = [
        ["slope by least squares", NONE, NONE, slope],
        ["largest acceleration", text(peak, "acceleration"), text(peak, "reading"), by_peaks],
        ["velocity change", text(change, "velocity"), text(change, "reading_integral"), by_velocity],
    ]
    caption = (
        f"{solution.title}: sensitivity with its standard uncertainty, at {cell_text(bandwidth, 'value')} "
        f"(set by: {bandwidth.reason})"
    )
    disk = "" if end.disk_mass is None else f", elastic disk of {cell_text(end, 'disk_mass')}"
    agreement = [
        line_of(comparison, "delay", "against gauge and bar speed"),
        line_of(comparison, "correlation", "at that delay"),
        line_of(comparison, "residual", "root mean square"),
        line_of(comparison, "reference_noise", "of the gauge, at the bandwidth"),
        line_of(peak, "reading_noise", "at the bandwidth", solution.given_units),
        line_of(solution, "rise_diameters", "not quoted below 2, warned below 5"),
        line_of(bandwidth, "noise", "at the gauge"),
        line_of(comparison, "reflected_misfit", "root mean square"),
        line_of(end, "mass", f"sensor and rigid disk{disk}"),
    ]
    names = ("scatter", "bias", "strain_uncertainty", "speed_uncertainty", "relative")
    notes = {name: declarations(ReadSensitivity)[name].meaning for name in names}
    notes["speed_uncertainty"] += f" {comparison.speed_power:.3g}"
    parts = [line_of(sensitivity, name, note) for name, note in notes.items()]
    return [
        Table(caption, ["quantity", "reference by the gauge", "reading", "reading over reference"], ratios),
        Table("Agreement of reading and reference", ["quantity", "value", "note"], agreement),
        Table("Relative standard uncertainty of the sensitivity", ["part", "value", "from"], parts),
    ]


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


def shot_words(solution: HopkinsonSolution) -> str:
    """Return the result of a shot in a sentence, for the screen and the head of the report."""
    strain, stress, rate = (text_of(solution.largest, name) for name in ("strain", "stress", "rate"))
    field, closing = ("excess", "in excess") if solution.momentum.missing is None else ("missing", "missing")
    missed = cell_text(solution.momentum, field)
    return (
        f"Each first pulse is taken as compression, whatever its sign: the specimen reached a true strain of {strain} "
        f"at {rate} (median) and a true stress of {stress}. The forces on its faces differ by "
        f"{text_of(solution.equilibrium, 'misfit')} of their mean, and {missed} of the incident impulse is {closing}."
    )


def shot_tables(solution: HopkinsonSolution) -> list[Table]:
    """Return the tables of a reduced shot."""
    equilibrium, impulses, work = solution.equilibrium, solution.momentum, solution.energy
    limits, alignment = solution.case.setup.limits, solution.alignment

    def three(waves: Momentum | Energy) -> str:
        numbers = numbers_of(waves, {})
        return f"{', '.join(text for text, _ in numbers)} {spelled(numbers[0][1])}"

    stretch = "in no lasting stretch"
    if not math.isnan(equilibrium.begin):
        begin, end = (fixed(time, *MICROSECONDS.units, 1) for time in (equilibrium.begin, equilibrium.end))
        stretch = f"from {begin} to {end} {spelled(shown_unit(*MICROSECONDS.units))}"
    wrong = "" if work.acceleration >= 0.0 else "; below 0: the forces do not balance"
    parts = f"deforms {cell_text(work, 'deformation')}, moves {cell_text(work, 'acceleration')}{wrong}"
    in_all = f"in all over {cell_text(equilibrium, 'share')} of the loading"
    closing = "excess" if impulses.missing is None else "missing"
    balance: list[list[Cell]] = [
        line_of(equilibrium, "misfit", f"limit {percent(limits.force_misfit.si, 0)}"),
        line_of(equilibrium, "force_ratio", "1 but for the specimen's own momentum"),
        [f"forces agree to {percent(UNIFORM, 0)}", stretch, in_all],
        line_of(impulses, closing, f"of the incident one; limit {percent(limits.momentum.si, 0)}"),
        ["incident, reflected, transmitted impulse", three(impulses), f"specimen {cell_text(impulses, 'specimen')}"],
        ["incident, reflected, transmitted energy", three(work), ""],
        line_of(work, "absorbed", parts),
    ]
    curves = (
        f"{solution.title}: largest true strain and stress, median true rate, slope from 10 to 50 % of the largest "
        "stress (and within a sample of misalignment); * the one chosen"
    )
    delays = (
        f"Delay of the waves at the specimen against geometry; alignment {alignment.method}, dispersion "
        f"{alignment.dispersion} up to {cell_text(alignment, 'band')}, largest shift allowed "
        f"{cell_text(alignment, 'window')}, the rise"
    )
    tables = [
        page_table(curves, columns_of(AnalysedCurve, solution.analysed)),
        Table(
            "Force, momentum and energy balance while the incident wave lasts", ["quantity", "value", "note"], balance
        ),
        page_table(delays, columns_of(WaveDelay, alignment.delays)),
        face_table(solution, "bars"),
    ]
    if (check := solution.striker_check) is not None:
        measured, expected = (columns_of(StrikerCheck, [check], table) for table in ("measured", "expected"))
        rows = [[own.head, *own.cells(), *other.cells()] for own, other in zip(measured, expected, strict=True)]
        caption = f"Incident pulse compared with the striker; the plateau corresponds to {cell_text(check, 'speed')}"
        tables.append(Table(caption, ["quantity", "measured", "v Zs/((Zs+Zb) c), 2 Ls/cs"], rows))
    specimen, bar = solution.reduction.specimen, solution.reduction.bars[0]
    beta, transit = specimen.impedance_ratio(bar), specimen.transit
    if beta is not None and transit is not None:
        rise, uniform = solution.pulses.rise / RISE_SHARE / transit, percent(UNIFORM, 0)
        under_rise = f"transits to {uniform} under a straight rise of {rise:.3g} transits"
        theory: list[list[Cell]] = [
            ["impedance of the specimen over that of the bar", f"{beta:.4g}"],
            [headed("transit of the specimen", *MICROSECONDS.units), written(shown(transit, *MICROSECONDS.units))],
            ["force difference after a step, transit 3", percent(float(stress_difference(beta, 3)), 1)],
            ["force difference after a step, transit 5", percent(float(stress_difference(beta, 5)), 2)],
            [f"transits to {uniform} after a step", f"{transits_to_uniform(beta):.4g}"],
            [under_rise, f"{transits_to_uniform(beta, rise):.4g}"],
        ]
        tables.append(Table("Theoretical equilibrium of an elastic specimen", ["quantity", "value"], theory))
    return tables


class Kind(NamedTuple):
    """The report of a kind of result: its title, its summary, the text above its tables, and these."""

    title: str
    summary: Callable[[Any], str]
    method: str
    tables: Callable[[Any], list[Table]]


KINDS: dict[type, Kind] = {
    HopkinsonSolution: Kind("Report of a split-Hopkinson shot", shot_words, f"{_SHOT}\n\n{_SLOPE}", shot_tables),
    SensorSolution: Kind(
        "Report of an accelerometer on the end of a bar", sensor_words, f"{_SENSOR}\n\n{_DOUBT}", sensor_tables
    ),
    EchoSolution: Kind("Report of a bar calibrated by its echoes", echo_words, _ECHOES, echo_tables),
}


def page(solution: AnySolution) -> str:
    """Return the report of a set-up as one HTML page, found as `picture` is by `strikewave.reporting.shown_result`."""
    kind = KINDS[type(solution)]
    sections = [
        Section("Pulses", "", pictures(solution)),
        Section("Result", kind.method, kind.tables(solution)),
        chapters.warnings(solution.notices),
        chapters.inputs(solution.case.setup),
    ]
    head = chapters.Summary(kind.title, kind.summary(solution), solution.highlights())
    return chapters.result_page(solution, head, sections)


picture = sheet
"""Picture of a result in Python."""
