"""The report of a reduced shot of split Hopkinson bars."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from strikewave.analyses.hopkinson.report.page import outcome_page, time_text
from strikewave.hopkinson import ANALYSES, stress_difference, transits_to_uniform
from strikewave.hopkinson.uniformity import UNIFORM
from strikewave.reporting import chapters
from strikewave.reporting.numbers import fixed, headed, percent, shown, shown_heads, spelled, with_unit
from strikewave.reporting.parts import NONE, Cell, Picture, Section, Table, written
from strikewave.reporting.shown_units import shown_unit
from strikewave.reporting.style import WHOLE, one_diagram

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strikewave.analyses.hopkinson.result import HopkinsonSolution
    from strikewave.hopkinson.checks import Equilibrium, Slope

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
    summary = solution.summary()
    numbers = [
        ("largest true stress", with_unit(summary["stress"], "Pa", "MPa")),
        ("largest true strain", f"{100.0 * summary['strain']:.3g} %"),
        ("median true rate", f"{summary['rate']:.0f} 1/s"),
        ("force difference", percent(solution.equilibrium.misfit, 1)),
        (f"impulse {_closing(solution)}", percent(abs(solution.momentum.closure), 2)),
    ]
    sections = [
        Section("Pulses", "", _pictures(solution)),
        Section("Result", f"{_SHOT}\n\n{_SLOPE}", shot_tables(solution)),
    ]
    head = chapters.Summary("Report of a split-Hopkinson shot", shot_words(solution), numbers)
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
    summary = solution.summary()
    return (
        "Each first pulse is taken as compression, whatever its sign: "
        f"the specimen reached a true strain of {percent(summary['strain'], 1)} at {summary['rate']:.0f} 1/s (median) "
        f"and a true stress of {with_unit(summary['stress'], 'Pa', 'MPa')}. The forces on its faces differ by "
        f"{percent(solution.equilibrium.misfit, 1)} of their mean, and {percent(abs(solution.momentum.closure), 2)} "
        f"of the incident impulse is {_closing(solution)}."
    )


def _closing(solution: HopkinsonSolution) -> str:
    return "missing" if solution.momentum.closure >= 0.0 else "in excess"


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
    uniform = percent(UNIFORM, 0)
    specimen = NONE if math.isnan(impulses.specimen) else with_unit(impulses.specimen, "N s", "mN s", 3)
    wrong = "" if work.acceleration >= 0.0 else "; below 0: the forces do not balance"
    rows: list[list[Cell]] = [
        [
            "force difference over mean force",
            percent(equilibrium.misfit, 1),
            f"limit {percent(limits.force_misfit.si, 0)}",
        ],
        ["impulse on face 1 over face 2", f"{equilibrium.force_ratio:.4f}", "1 but for the specimen's own momentum"],
        [
            f"forces agree to {uniform}",
            _agreeing(equilibrium),
            f"in all over {percent(equilibrium.share, 0)} of the loading",
        ],
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
    return f"from {time_text(equilibrium.begin, 1)} to {time_text(equilibrium.end, 1)} {spelled(shown_unit('s', 'us'))}"


def _three(values: Sequence[float], si: str) -> str:
    return ", ".join(written(shown(value, si, si)) for value in values) + f" {spelled(shown_unit(si, si))}"


def _alignment_table(solution: HopkinsonSolution) -> Table:
    waves = solution.reduction.waves
    rows: list[list[Cell]] = [
        [name, *(time_text(late[k], 2, "+") for late in (waves.late_onset, waves.late_balance, waves.applied))]
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
    rise, uniform = solution.pulses.rise / RISE_SHARE / transit, percent(UNIFORM, 0)
    rows: list[list[Cell]] = [
        ["impedance of the specimen over that of the bar", f"{beta:.4g}"],
        [headed("transit of the specimen", "s", "us"), written(shown(transit, "s", "us"))],
        ["force difference after a step, transit 3", percent(float(stress_difference(beta, 3)), 1)],
        ["force difference after a step, transit 5", percent(float(stress_difference(beta, 5)), 2)],
        [f"transits to {uniform} after a step", f"{transits_to_uniform(beta):.4g}"],
        [
            f"transits to {uniform} under a straight rise of {rise:.3g} transits",
            f"{transits_to_uniform(beta, rise):.4g}",
        ],
    ]
    return [Table("Theoretical equilibrium of an elastic specimen", ["quantity", "value"], rows)]
