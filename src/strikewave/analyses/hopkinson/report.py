"""The reports of split Hopkinson bars: a shot, an accelerometer on a bar end, a bar calibrated by its echoes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.hopkinson import ANALYSES, stress_difference, transits_to_uniform
from strikewave.reporting import chapters
from strikewave.reporting.numbers import decimals_in, fixed, headed, percent, shown, shown_heads, spelled, with_unit
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, written
from strikewave.reporting.shown_units import shown_unit
from strikewave.reporting.style import WHOLE, one_diagram

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strikewave.analyses.hopkinson.echo_result import EchoSolution
    from strikewave.analyses.hopkinson.outcome import Outcome
    from strikewave.analyses.hopkinson.result import HopkinsonSolution
    from strikewave.analyses.hopkinson.sensor_result import SensorSolution
    from strikewave.hopkinson.checks import Equilibrium, Slope
    from strikewave.hopkinson.echoes import FittedValue

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
_ECHOES = (
    "Both ends are free, and the pulse passes the gauge again and again. The phase between two passes over a known way "
    "gives the speed at each frequency, the ratio of their amplitudes over a round trip the attenuation, losses at the "
    "ends included. All passes count at once, by least squares; the standard error is by what is left of them, and "
    "Student's factor times it holds 95 %. The error of the stated distance comes on top."
)
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


def shot_tables(solution: HopkinsonSolution) -> list[Table]:
    """Return the tables of a reduced shot."""
    return [
        _curve_table(solution),
        _balance_table(solution),
        _alignment_table(solution),
        _bar_table(solution),
        *_striker_table(solution),
        *_theory_table(solution),
    ]


def _curve_table(solution: HopkinsonSolution) -> Table:
    on, slopes = solution.reduction.loading, solution.slopes()
    rows: list[list[Cell]] = []
    for name in ANALYSES:
        slope, true = slopes[name], solution.reduction.curve(name).true()
        rows.append(
            [
                name + (" *" if name == solution.case.setup.solver.analysis else ""),
                f"{100.0 * float(true.strain[on].max()):.2f}",
                fixed(float(true.stress[on].max()), "Pa", "MPa", 1),
                fixed(float(np.median(true.rate[on])), "1/s", "1/s", 0),
                _slope(slope),
            ]
        )
    heads = shown_heads(
        "analysis", "true strain (%)", "true stress (MPa)", "true rate (1/s)", "slope of the rise (GPa)"
    )
    caption = (
        f"{solution.title}: largest true strain and stress, median true rate, slope from 10 to 50 % of the largest "
        "stress (and within a sample of misalignment); * the one chosen"
    )
    return Table(caption, heads, rows)


def _slope(slope: Slope) -> str:
    """Write a slope with the values between which a sample of misalignment moves it."""
    if math.isnan(slope.value):
        return NONE
    value = written(shown(slope.value, "Pa", "GPa"), 3)
    if math.isnan(slope.low):
        return value
    low = written(shown(slope.low, "Pa", "GPa"), 3)
    above = f"{low} or more" if math.isinf(slope.high) else f"{low} to {written(shown(slope.high, 'Pa', 'GPa'), 3)}"
    return f"{value} ({above})"


def _balance_table(solution: HopkinsonSolution) -> Table:
    equilibrium, impulses, work, limits = (
        solution.equilibrium,
        solution.momentum,
        solution.energy,
        solution.case.setup.limits,
    )
    specimen = NONE if math.isnan(impulses.specimen) else with_unit(impulses.specimen, "N s", "mN s", 3)
    wrong = "" if work.acceleration >= 0.0 else "; below 0: the forces do not balance"
    rows: list[list[Cell]] = [
        [
            "force difference over mean force",
            percent(equilibrium.misfit, 1),
            f"limit {percent(limits.force_misfit.si, 0)}",
        ],
        ["impulse on face 1 over face 2", f"{equilibrium.force_ratio:.4f}", "1 but for the specimen's own momentum"],
        ["forces agree to 5 %", _agreeing(equilibrium), f"in all over {percent(equilibrium.share, 0)} of the loading"],
        [
            "missing impulse" if impulses.closure >= 0.0 else "excess impulse",
            percent(abs(impulses.closure), 2),
            f"of the incident one; limit {percent(limits.momentum.si, 0)}",
        ],
        ["incident, reflected, transmitted impulse", _three(impulses[:3], "N s"), f"specimen {specimen}"],
        ["incident, reflected, transmitted energy", _three(work[:3], "J"), ""],
        [
            "absorbed energy",
            with_unit(work.absorbed, "J", "J"),
            f"deforms {with_unit(work.deformation, 'J', 'J')}, "
            f"moves {with_unit(work.acceleration, 'J', 'J', 3)}{wrong}",
        ],
    ]
    return Table(
        "Force, momentum and energy balance while the incident wave lasts", ["quantity", "value", "note"], rows
    )


def _agreeing(equilibrium: Equilibrium) -> str:
    """Write the longest stretch in which the forces agree."""
    if math.isnan(equilibrium.begin):
        return "in no lasting stretch"
    return f"from {_time(equilibrium.begin, 1)} to {_time(equilibrium.end, 1)} {spelled(shown_unit('s', 'us'))}"


def _three(values: Sequence[float], si: str) -> str:
    return ", ".join(written(shown(value, si, si)) for value in values) + f" {spelled(shown_unit(si, si))}"


def _alignment_table(solution: HopkinsonSolution) -> Table:
    waves = solution.reduction.waves
    rows: list[list[Cell]] = [
        [name, *(_time(late[k], 2, "+") for late in (waves.late_onset, waves.late_balance, waves.applied))]
        for k, name in enumerate(("reflected", "transmitted"))
    ]
    caption = (
        f"Delay of the waves at the specimen against geometry; alignment {waves.method}, dispersion "
        f"{waves.theory} up to {with_unit(waves.band, 'Hz', 'kHz')}, largest shift allowed "
        f"{with_unit(waves.window, 's', 'us', 3)}, the rise"
    )
    return Table(caption, shown_heads("wave", "by onset (us)", "by balance (us)", "applied shift (us)"), rows)


def _bar_table(solution: HopkinsonSolution) -> Table:
    rows: list[list[Cell]] = [
        [
            name,
            written(shown(constants.density, "kg/m^3", "kg/m^3"), 5),
            written(shown(constants.modulus, "Pa", "GPa"), 5),
            written(shown(constants.speed, "m/s", "m/s"), 6),
            constants.derived,
            written(shown(bar.impedance, "N s/m", "N s/m"), 5),
            f"{noise * 1e6:.3g}",
        ]
        for (name, constants), bar, noise in zip(
            solution.constants.items(), solution.reduction.bars, solution.reduction.waves.noise, strict=True
        )
    ]
    heads = shown_heads("bar", "density (kg/m^3)", "modulus (GPa)", "speed (m/s)", "derived", "impedance (N s/m)")
    return Table("Bars, with the constant that follows from the two others", [*heads, "noise (µε)"], rows)


def _striker_table(solution: HopkinsonSolution) -> list[Table]:
    check = solution.striker_check
    if check is None:
        return []
    rows: list[list[Cell]] = [
        ["plateau strain (µε)", written(check.strain * 1e6), written(check.strain_expected * 1e6)],
        [
            headed("pulse width at 50 %", "s", "us"),
            *(written(shown(width, "s", "us")) for width in (check.duration, check.duration_expected)),
        ],
    ]
    caption = (
        f"Incident pulse compared with the striker; the plateau corresponds to {with_unit(check.speed, 'm/s', 'm/s')}"
    )
    return [Table(caption, ["quantity", "measured", "v Zs/((Zs+Zb) c), 2 Ls/cs"], rows)]


def _theory_table(solution: HopkinsonSolution) -> list[Table]:
    """Say how soon an elastic specimen would be in equilibrium, where its density and modulus are known."""
    specimen, bar = solution.reduction.specimen, solution.reduction.bars[0]
    beta, transit = specimen.impedance_ratio(bar), specimen.transit
    if beta is None or transit is None:
        return []
    rise = solution.pulses.rise / RISE_SHARE / transit
    rows: list[list[Cell]] = [
        ["impedance of the specimen over that of the bar", f"{beta:.4g}"],
        [headed("transit of the specimen", "s", "us"), written(shown(transit, "s", "us"))],
        ["force difference after a step, transit 3", percent(float(stress_difference(beta, 3)), 1)],
        ["force difference after a step, transit 5", percent(float(stress_difference(beta, 5)), 2)],
        ["transits to 5 % after a step", f"{transits_to_uniform(beta):.4g}"],
        [f"transits to 5 % under a straight rise of {rise:.3g} transits", f"{transits_to_uniform(beta, rise):.4g}"],
    ]
    return [Table("Theoretical equilibrium of an elastic specimen", ["quantity", "value"], rows)]


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
        ["delay of the reading", _delay(comparison.agreement.delay, 3), "against gauge and bar speed"],
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


def _time(value: float, decimals: int, sign: str = "") -> str:
    """Write a time in the unit shown, with the decimals that it has in microseconds."""
    return f"{shown(value, 's', 'us'):{sign}.{decimals_in('s', 'us', decimals)}f}"


def _delay(value: float, decimals: int) -> str:
    return f"{_time(value, decimals, '+')} {spelled(shown_unit('s', 'us'))}"


def _read(value: float, unit: str) -> str:
    """Write a reading: volts as they are, an acceleration in g."""
    return with_unit(value, "V", "mV") if unit == "V" else with_unit(value, "m/s^2", "g")


def _integral(value: float, unit: str) -> str:
    return f"{value * 1e6:.4g} mV ms" if unit == "V" else with_unit(value, "m/s", "m/s")


def _sensitivity(value: float, unit: str, digits: int = 5) -> str:
    """Write reading over reference: volts in mV/g, a ratio as it is."""
    return f"{value * STANDARD_GRAVITY * 1e3:.{digits}g} mV/g" if unit == "V" else f"{value:.{digits}g}"


def shot_words(solution: HopkinsonSolution) -> str:
    """Say in words what the specimen did: on the screen and at the head of the report."""
    summary = solution.summary()
    return (
        f"The specimen reached a true strain of {percent(summary['strain'], 1)} at {summary['rate']:.0f} 1/s (median) "
        f"and a true stress of {with_unit(summary['stress'], 'Pa', 'MPa')}. The forces on its faces differ by "
        f"{percent(solution.equilibrium.misfit, 1)} of their mean, and {percent(abs(solution.momentum.closure), 2)} "
        f"of the incident impulse is {_closing(solution)}."
    )


def shot_report(solution: HopkinsonSolution) -> str:
    """Return the report of a reduced shot as one HTML page."""
    from strikewave.analyses.hopkinson.figures import (
        draw_curves,
        draw_difference,
        draw_forces,
        draw_rate,
        draw_record,
        draw_waves,
    )

    r, pulses = solution.reduction, solution.pulses
    pictures = [
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
    summary = solution.summary()
    numbers = [
        ("largest true stress", with_unit(summary["stress"], "Pa", "MPa")),
        ("largest true strain", f"{100.0 * summary['strain']:.3g} %"),
        ("median true rate", f"{summary['rate']:.0f} 1/s"),
        ("force difference", percent(solution.equilibrium.misfit, 1)),
        (f"impulse {_closing(solution)}", percent(abs(solution.momentum.closure), 2)),
    ]
    sections = [Section("Pulses", "", pictures), Section("Result", f"{_SHOT}\n\n{_SLOPE}", shot_tables(solution))]
    head = chapters.Summary("Report of a split-Hopkinson shot", shot_words(solution), numbers)
    return _page(solution, head, sections)


def _closing(solution: HopkinsonSolution) -> str:
    return "missing" if solution.momentum.closure >= 0.0 else "in excess"


def sensor_words(solution: SensorSolution) -> str:
    """Say in words what the sensor read: on the screen and at the head of the report."""
    comparison = solution.comparison
    sensitivity = _sensitivity(solution.sensitivity, solution.unit)
    what = "The sensitivity of the sensor" if solution.unit == "V" else "The reading over the reference"
    return (
        f"{what} is {sensitivity} at {with_unit(comparison.bandwidth.value, 'Hz', 'kHz')} (standard "
        f"uncertainty {percent(solution.uncertainty.combined, 2)}), and {percent(comparison.agreement.residual, 1)} of "
        "the reading does not follow the reference."
        if solution.quoted
        else "The rise of the pulse is too steep at this bandwidth for accelerations to be quoted."
    )


def sensor_report(solution: SensorSolution) -> str:
    """Return the report of an accelerometer on the end of a bar as one HTML page."""
    from strikewave.analyses.hopkinson.figures import (
        draw_accelerations,
        draw_end_record,
        draw_sensor_difference,
        draw_velocities,
    )

    comparison, share = solution.comparison, solution.uncertainty.combined
    pictures = [
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
    sensitivity = _sensitivity(solution.sensitivity, solution.unit)
    numbers = [
        ("sensitivity" if solution.unit == "V" else "reading over reference", sensitivity if solution.quoted else NONE),
        ("standard uncertainty", percent(share, 2) if solution.quoted else NONE),
        ("largest acceleration", with_unit(solution.peaks[0], "m/s^2", "g")),
        ("velocity change", with_unit(comparison.velocities[0], "m/s", "m/s")),
        ("delay", _delay(comparison.agreement.delay, 2)),
    ]
    tables = Section("Result", f"{_SENSOR}\n\n{_DOUBT}", sensor_tables(solution))
    head = chapters.Summary("Report of an accelerometer on the end of a bar", sensor_words(solution), numbers)
    return _page(solution, head, [Section("Pulses", "", pictures), tables])


def echo_words(solution: EchoSolution) -> str:
    """Say in words what the echoes gave: on the screen and at the head of the report."""
    echoes = solution.echoes
    return (
        f"The bar speed by {echoes.times.size} passes is {with_unit(echoes.speed.value, 'm/s', 'm/s', 5)}, "
        f"{percent(solution.difference, 2, '+')} off the stated one."
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
    return _page(solution, head, sections)


def _page(solution: Outcome, summary: chapters.Summary, sections: Sequence[Section]) -> str:
    last = [chapters.warnings(solution.notices), chapters.inputs(solution.case.setup)]
    return chapters.result_page(solution, summary, [*sections, *last])
