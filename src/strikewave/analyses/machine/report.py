"""The report of a machine's run as one HTML page."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from strikewave.analyses.layered_bars import (
    WaveField,
    field_pictures,
    fit_tables,
    layer_table,
    route_section,
    sensor_part,
)
from strikewave.analyses.machine.figures import pulses
from strikewave.analyses.machine.figures.animation import machine_page, write_machine_gif
from strikewave.analyses.machine.figures.geometry import strike_geometry
from strikewave.analyses.machine.figures.pulses import summary
from strikewave.analyses.machine.kind import kind_of
from strikewave.analyses.machine.result import (
    ANSWERS_CALLED,
    Solution,
    answer_columns,
    blow_columns,
    launch_tables,
    restitution_words,
    summary_words,
)
from strikewave.base.shock_quantities import KILOGRAMS, PULSE_WIDTH, RIGID_PEAK
from strikewave.reporting import chapters as shared
from strikewave.reporting.bands import band_sections
from strikewave.reporting.chapters import balance_table, layer_steps
from strikewave.reporting.columns import page_table
from strikewave.reporting.faces import amount, face_table, text_of
from strikewave.reporting.numbers import headed, listed, shown
from strikewave.reporting.parts import NONE, Cell, Flow, Link, Part, Picture, Section, Table, Tag
from strikewave.reporting.run_and_write import drawing
from strikewave.reporting.style import Trace, save, traces
from strikewave.reporting.terminal import progress_bar, say
from strikewave.uncertainty.runs import computed_beside
from strikewave.waves.transit import TimeGrid, field_nodes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.cases.case import Case


def report(solution: Solution, sections: Sequence[Section] = (), moving: str = "") -> str:
    """Return the report of a run as one HTML page: no script, nothing fetched, the same bytes each time.

    ``sections`` are shown after the pulses; ``moving`` names the file beside the report that shows the machine in
    motion, if there is one.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> page = report(run_case(load_case("li-ma-2019", ["feed.blows=1"])))
    >>> page.splitlines()[0], "<script" in page
    ('<!doctype html>', False)
    """
    parts = [
        pulse_pictures(solution, moving),
        *stack_section(solution),
        *sensor_section(solution),
        *sections,
        blow_table(solution),
        *band_sections(solution),
        *shared.published(solution.comparisons),
        shared.warnings(solution.notices),
        setup(solution.case),
        shared.inputs(solution.case),
        *accuracy_section(solution),
        checks(solution),
    ]
    summary = shared.Summary("Report of a run", summary_words(solution), solution.highlights())
    return shared.result_page(solution, summary, parts)


_DATA_FLOW = (
    "case file",
    "checks of units and fits",
    "machine",
    "motion with every contact located in time",
    "blows",
    "pulses: peak, width, velocity change",
    "comparison with published values",
)


_CONTACT = (
    "Contact, blow by blow. The coefficient of restitution is that of the contact: the square root of the work it "
    "gives back over the work it takes; the rebound speed depends on frame and mount too. The stiffness is the "
    "slope of the contact force at the largest indentation on the way back. What stays of the indentation, and the "
    "radius of the spot over that before, change only where the case gives a yield pressure."
)
_SLIDING = (
    "The nose slides across the face, blow by blow: the largest side force and the side impulse on the object, "
    "above 0 the way the nose passes, the heat of this friction, and the turntable's speed at first touch. The "
    "guide of the object bears the side force; the friction that this adds in the guide is not in the model."
)
_PARTS = "The parts with their numbers, counted as in the drawing"
_WORDS = (
    "A blow is one pass of one striker, all its re-contacts included. It is glancing when its approach speed is below "
    "half of the nominal one, double when a second group of contacts, more than a pulse width later, carries a tenth "
    "of the contact impulse, missed when the striker passed an object in place without touching it, and full "
    "otherwise. Time counts from {begun}. The rigid peak and its width, taken at 10 % of the peak, belong to "
    "the rigid-body acceleration: the momentum rate of the assembly over its mass, its zero that of a sensor, taken "
    "before the blow (of an object that falls, in the fall: gravity is not in it). The velocity change is the integral "
    "of this pulse from foot to foot, where 2 % of its peak is left. g is standard gravity, 9.80665 m/s²."
)


def setup(case: Case) -> Section:
    """Return the section on the machine, and on the way from the case to its numbers."""
    kind, layers, geometry = kind_of(case), layer_steps(case), strike_geometry(case)
    parts = _drawing(case.with_stale_fits_assumed())
    if layers:
        parts.append(Flow(layers, "The stack, from its loaded face on"))
    elif kind.chain:
        parts.append(Flow(kind.chain, "Bodies and links, in the order in which a blow runs through them"))
    parts.append(Flow(_DATA_FLOW, "From the case to this report"))
    strike = ""
    if geometry is not None and geometry.blow_angle:
        strike = f" The blow stands at {math.degrees(geometry.blow_angle):.4g}° to the radius at the strike position."
    elif geometry is not None:
        strike = " The nose of a striker acts on the object's face like a cam."
    return Section("Set-up", kind.description + strike, parts)


def _drawing(case: Case) -> list[Part]:
    """Return drawings of the machine and a table of its numbers; nothing for a machine that is not drawn."""
    drawing = kind_of(case).drawing(case)
    if drawing is None:
        return []
    rows: list[list[Cell]] = []
    for number, part in enumerate(drawing.parts, 1):
        name = f"{number} {part.name}" if part.place else part.name
        for entry in part.entries:
            looks = ("follows", "") if entry.provenance == "computed" else (entry.provenance, entry.provenance)
            rows.append([f"{name}: {entry.name}", entry.shown, Tag(*looks)])
        if not part.entries:
            rows.append([name, NONE, NONE])
    return [*drawing.pictures, Table(_PARTS, ["part", "value", "provenance"], rows)]


def blow_table(solution: Solution) -> Section:
    """Return the section on the blows, in the units and columns of the command line."""
    columns = blow_columns("blows", solution.blows, solution.band)
    table = page_table("Blows", columns, "No blow: no striker passed the object.")
    reference = solution.reference
    beside = (
        f"\n\nFor comparison, {kind_of(solution.case).reference_law} on a rigid object, at the nominal "
        f"{text_of(reference, 'approach_speed')} and with no frame or mount to bend: {reference.words}."
    )
    words = _WORDS.format(begun=solution.case.time_zero) if solution.blows else ""
    tables, answers = [table], solution.contact
    if solution.struck:
        tables.append(page_table(_CONTACT, blow_columns("contact", solution.struck)))
    if solution.slides:
        tables.append(page_table(_SLIDING, blow_columns("sliding", solution.struck)))
    if answers is not None and answers.differ:
        asked = restitution_words(answers)
        passed = "" if answers.first_yield is None else text_of(answers, "first_yield")
        caption = (
            f"{ANSWERS_CALLED}. The weaker material first yields inside at {passed}. Low and high are the ends of what "
            f"is known of the pressure that the contact bears. {asked[0].upper()}{asked[1:]}."
        )
        tables.append(page_table(caption, answer_columns(answers, solution.band)))
    return Section("Blows", words + beside, tables)


def pulse_pictures(solution: Solution, moving: str = "") -> Section:
    """Draw acceleration and force of the first blow, all pulses and the train; name the histories that are missing.

    ``moving`` is the name of the page that shows the machine in motion.
    """
    data, struck, first = solution.arrays, solution.struck, solution.first_blow
    parts: list[Part] = []
    sentences = [] if struck else ["No striker touched the object: there is no pulse to show."]

    def add(needs: Sequence[str], draw: Callable[[], Figure], caption: str, label: str) -> None:
        missing = [name for name in needs if name not in data]
        if missing:
            sentences.append(f"Without the history {listed(missing)} there is no picture: {label}")
        else:
            parts.append(Picture(draw(), caption, label))

    if first is not None:
        row = solution.blows.index(first)
        peaks = [entry for entry in solution.published if entry.quantity == "first.rigid_peak"]
        marked = peaks and not solution.case.changed_fields()
        add(
            ["pulse_time", "pulse_acceleration"],
            lambda: pulses.rigid_acceleration(solution, row),
            f"Rigid-body acceleration of the assembly, blow {first.index}"
            + ("; the marks are published peaks and widths." if marked else "."),
            f"Rigid-body acceleration over time, blow {first.index}: peak "
            f"{amount(RIGID_PEAK, first.rigid_peak, solution.band.get('first.rigid_peak'))}, "
            f"width {amount(PULSE_WIDTH, first.width, solution.band.get('first.width'))}.",
        )
        add(
            ["pulse_time", "pulse_force"],
            lambda: pulses.contact_force(solution, row),
            f"Contact force between striker and object, blow {first.index}. Each rise from zero is a contact.",
            f"Contact force over time, blow {first.index}: peak {text_of(first, 'peak_force')}, "
            f"{first.contacts} contacts.",
        )
        drawn = pulses.drawn_blows(solution)
        some = "" if len(drawn) == len(struck) else f" {len(drawn)} of {len(struck)} are drawn."
        add(
            ["pulse_time", "pulse_acceleration"],
            lambda: pulses.overlaid_pulses(solution),
            f"Rigid-body pulses of all blows over each other, each from its first touch.{some}",
            f"Rigid-body pulses of {len(drawn)} blows over each other; their peaks and widths stand in the table of "
            "blows.",
        )
    add(
        ["time", "rigid_acceleration"],
        lambda: pulses.whole_train(solution),
        "Rigid-body acceleration over the whole train"
        + ("; the marks are the peaks of the table of blows, with its numbers." if len(struck) else "."),
        f"Rigid-body acceleration over the whole train: {len(struck)} blows.",
    )
    if moving:
        parts.append(Link(moving, "The machine in motion, with its histories: the whole run, or one blow slowed down"))
    return Section("Pulses", "\n\n".join(sentences), parts)


def checks(solution: Solution) -> Section:
    """Return the section on balances, masses and phases."""
    masses: list[list[Cell]] = [[name, shown(mass, *KILOGRAMS.units)] for name, mass in solution.masses.items()]
    return Section(
        "Balances, masses and phases",
        "Energy: what the balance of work and losses misses, over the energy that flowed. Momentum: impulse of all "
        "forces less change of momentum, over the contact impulse; the worst blow.",
        [
            balance_table(solution.balance_checks),
            Table("Masses", ["body", headed("mass", *KILOGRAMS.units)], masses, empty="No mass is listed."),
            *launch_tables(solution),
            face_table(
                solution, "phase_rows", caption=f"Phases, from {solution.case.time_zero}", empty="No phase is listed."
            ),
        ],
    )


_SINCE_TOUCH = "time after first touch"


def struck_field(solution: Solution) -> WaveField | None:
    """Return the field of a machine's first blow on a stack; None where there is none. It holds no velocities."""
    from strikewave.cases.stack_of_case import build_stack, build_taps

    data = solution.arrays
    if "field_force" not in data:
        return None
    stack, setup = build_stack(solution.case), solution.waves
    assert setup is not None
    nodes, _ = field_nodes(stack, TimeGrid(setup.step, tuple(layer.steps for layer in setup.layers), 0.0))
    return WaveField(
        stack,
        data["field_time"].values,
        data["field_position"].values,
        nodes[:, 0],
        data["field_force"].values,
        None,
        build_taps(solution.case),
        _SINCE_TOUCH,
    )


def stack_section(solution: Solution) -> list[Section]:
    """Show rigid, total and wave acceleration of each blow, and the waves of the first one; nothing without a stack."""
    setup = solution.waves
    if setup is None:
        return []
    data, struck = solution.arrays, [k for k, reading in enumerate(solution.readings) if reading is not None]
    if not struck or "tap_acceleration" not in data:
        return [Section("Stress waves", "No blow touched the object: there are no waves to show.")]
    first, names = struck[0], [str(name) for name in data["tap"].values]
    reading = solution.readings[first]
    assert reading is not None
    route = solution.case.solver.route
    band = "" if reading.bandwidth is None else f" at a bandwidth of {text_of(reading, 'bandwidth')}"
    refused = reading.total_peak is None
    text = (
        "A peak is the value of largest magnitude, with its sign. Rigid is the momentum rate of the assembly over its "
        "mass; total is what a perfect sensor at the section would read; wave is total minus rigid. "
        f"Total and wave are stated{band}, at the tap {names[0]}; route: {route}."
    )
    if refused:
        text += " No peak of total and wave is quoted: see the warning on the rise."
    table = face_table(solution, "wave_blows", "waves", "Rigid, total and wave acceleration")
    parts: list[Part] = []
    time = data["pulse_time"].values
    until = int(np.flatnonzero(np.isfinite(data["tap_force"].values[first]).any(axis=0))[-1]) + 1  # waves have settled
    curves = [
        Trace(f"total, {name}", time[:until], data["tap_acceleration"].values[first, k, :until])
        for k, name in enumerate(names[:3])
    ]
    curves.append(Trace("rigid", time[:until], data["rigid_acceleration_filtered"].values[first, :until]))
    index = solution.blows[first].index
    parts.append(
        Picture(
            traces(f"Total and rigid-body acceleration, blow {index}", curves, "g", _SINCE_TOUCH),
            f"Total acceleration at the taps and rigid-body acceleration, both{band}; route: {route}.",
        )
    )
    force = [Trace(name, time[:until], data["tap_force"].values[first, k, :until]) for k, name in enumerate(names[:4])]
    force.append(Trace("contact", time[:until], data["pulse_force"].values[first, :until]))
    parts.append(
        Picture(
            traces(f"Force in the stack, blow {index}", force, "kN", _SINCE_TOUCH),
            f"Force in the stack at the taps, and the contact force that drives it; route: {route}.",
        )
    )
    field = struck_field(solution)
    if field is not None:
        parts += field_pictures(field)
    if not refused:
        parts.append(table)
    sections = [Section("Stress waves", text, parts)]
    waves = data["route_acceleration"].values
    tap = next((k for k in range(len(names)) if np.isfinite(waves[:, k]).any()), None)
    if tap is not None and route == "exact":
        rigid = data["rigid_acceleration_filtered"].values[first, :until]
        exact = data["tap_acceleration"].values[first, tap, :until]
        by_route = waves[:, tap, :until]
        sections.append(route_section(names[tap], not refused, time[:until], exact, rigid, by_route, _SINCE_TOUCH))
    return sections


def accuracy_section(solution: Solution) -> list[Section]:
    """Return the section on the accuracy of the waves, layer by layer; nothing without a stack."""
    from strikewave.cases.stack_of_case import fitted_losses

    setup = solution.waves
    if setup is None or not any(solution.readings):
        return []

    losses = fitted_losses(solution.case)
    tables: list[Part] = [layer_table(setup), *fit_tables(losses)]
    text = (
        "Waves run on delay lines: exact but for the rounding of each transit to whole time steps. The largest "
        f"relative difference of a transit is {setup.mismatch:.1e}."
    )
    return [Section("Accuracy of the waves", text, tables)]


def sensor_section(solution: Solution) -> list[Section]:
    """Show the readings of each sensor, and what its buffer takes off; nothing without sensors."""
    struck = [k for k, reading in enumerate(solution.readings) if reading is not None]
    if not solution.case.sensor or not struck:
        return []
    from strikewave.cases.stack_of_case import build_channels

    channels, data, curves = build_channels(solution.case), solution.arrays, list[Trace]()
    for k, channel in enumerate(channels):
        values, start = data[f"reading_{k + 1}"], float(data[f"reading_{k + 1}_start"].values[struck[0]])
        samples = values.values[struck[0]]
        time = start + float(values.attrs["step"]) * np.arange(samples.size)
        curves.append(Trace(channel.sensor.name, time, samples))
    title = f"What the sensors read, blow {solution.blows[struck[0]].index}"
    picture = traces(title, curves, "g", _SINCE_TOUCH)
    return [sensor_part(channels, picture, face_table(solution, "sensor_rows"))]


picture, page = summary, report
"""Picture and page of a result in Python, see `strikewave.reporting.shown_result`."""


def draw_result(solution: Solution, folder: Path, animate: bool = False) -> list[str]:
    """Write page and pictures of a run into a folder, and return their names."""

    def sheet() -> bool:
        save(summary(solution), folder / "summary.svg")
        return True

    with computed_beside(sheet) as is_written:
        moving = _animate(solution, folder) if animate else []
        with drawing(folder / "report.html") as path:
            page = report(solution, moving=moving[0] if moving else "")
            path.write_text(page, "utf-8", newline="\n")
        with drawing(folder / "summary.svg"):
            if not is_written():
                sheet()
    return ["report.html", "summary.svg", *moving]


def _animate(solution: Solution, folder: Path) -> list[str]:
    """Write the machine in motion as a page and as a GIF, and return their names."""
    with drawing(folder / "machine.html") as path:
        page = machine_page(solution)
        if page is None:
            say("no animation: only the rotary machine can be shown in motion")
            return []
        path.write_text(page, "utf-8", newline="\n")
    with drawing(folder / "machine.gif") as path, progress_bar("machine.gif", clocks=("left",)) as progress:
        write_machine_gif(solution, path, progress)
    return [name for name in ("machine.html", "machine.gif") if (folder / name).exists()]
