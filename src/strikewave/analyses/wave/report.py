"""The sections on stress waves and sensors: of a machine's first blow on a stack, and of a bar alone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.analyses.wave.figures.curves import insertion_loss, staircase_diagram
from strikewave.analyses.wave.figures.field import (
    QUANTITIES,
    WaveField,
    bar_field,
    sandwiched,
    snapshots,
    struck_field,
    xt_diagram,
)
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.reporting.curves import Trace, traces
from strikewave.reporting.numbers import fixed, listed, with_unit
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, Tag, written
from strikewave.sensors import insertion_loss as loss_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from strikewave.analyses.machine.result import Solution
    from strikewave.analyses.wave.run import BarSolution
    from strikewave.cases.losses_of_case import Loss
    from strikewave.sensors.channel import Channel
    from strikewave.waves.setup import WaveSetup

_SINCE_TOUCH, _SINCE_LOAD = "time after first touch (µs)", "time after the start of the load (µs)"

_PEAKS = (
    "A peak is the value of largest magnitude, with its sign. Rigid is the momentum rate of the assembly over its "
    "mass; total is what a perfect sensor at the section would read; wave is total less rigid, so that nothing is "
    "counted twice."
)
_ROUTES = (
    "The routes of Li & Ma 2019 take the neighbours of the specimen as endless, and are driven by the force on the "
    "loaded face. As printed, echoes come back too early and a backward wave moves its section the wrong way; "
    "corrected, both are mended. The paper then adds the wave to the rigid acceleration (superposed), which counts the "
    "rigid motion twice. Exact is the finite stack itself."
)


MOST_LAYERS = 50
"""Layers that a table lists."""


def fit_table(losses: Sequence[Loss]) -> Table:
    """List where energy is lost: loss factor asked for, band, by how much of it it is missed at most."""
    rows: list[list[Cell]] = [
        [loss.where, f"{loss.loss_factor:g}", f"{loss.low / 1e3:g} to {loss.high / 1e3:g}", f"{loss.error:.1%}"]
        for loss in losses
    ]
    return Table("How well the loss factors are held", ["where", "loss factor", "band (kHz)", "off by at most"], rows)


def layer_table(setup: WaveSetup) -> Table:
    """List the layers as asked for and as the time step made them."""
    rows: list[list[Cell]] = [
        [
            layer.name,
            written(layer.length_asked * 1e3, 7),
            written(layer.length_used * 1e3, 7),
            f"{layer.length_used / layer.length_asked - 1.0:+.1e}",
            layer.steps,
        ]
        for layer in setup.layers[:MOST_LAYERS]
    ]
    more = len(setup.layers) - MOST_LAYERS
    caption = f"Layers as the time step of {setup.step * 1e9:.4g} ns makes them"
    caption += f"; {more} more in the JSON" if more > 0 else ""
    return Table(
        caption, ["layer", "length asked (mm)", "length used (mm)", "difference", "steps of its transit"], rows
    )


def field_pictures(field: WaveField, quantity: str = "stress") -> list[Part]:
    """Show the whole field: the x-t diagram, and snapshots along the stack."""
    shown = QUANTITIES[quantity]
    meaning = {"RdBu": "blue is compression, red tension", "PuOr": "purple is along the blow, orange against it"}
    opens = any(joint.unilateral for joint in field.stack.joints)
    double = " A joint that can open is a double line while no force crosses it." if opens else ""
    return [
        Picture(
            xt_diagram(field, quantity),
            f"{shown.name.capitalize()} along the stack over time (exact): {meaning[shown.colours]}. Lines are faces "
            f"of layers, dotted ones taps; dashed is the leading front at the speeds of the bars.{double}",
        ),
        Picture(
            snapshots(field, quantity),
            f"{shown.name.capitalize()} along the stack at chosen times: while the front runs through, at the greatest "
            "values, and in the longest waits between. The darker a layer, the greater its impedance.",
        ),
    ]


def stack_section(solution: Solution) -> list[Section]:
    """Show rigid, total and wave acceleration of each blow, and the waves of the first one; nothing without a stack."""
    setup = getattr(solution, "waves", None)
    if setup is None:
        return []
    data, struck = solution.data, [k for k, reading in enumerate(solution.readings) if reading is not None]
    if not struck or "tap_acceleration" not in data:
        return [Section("Stress waves", "No blow touched the object: there are no waves to show.")]
    first, names = struck[0], [str(name) for name in data["tap"].values]
    reading = solution.readings[first]
    assert reading is not None
    route = solution.case.solver.route
    band = "" if reading.bandwidth is None else f" at a bandwidth of {with_unit(reading.bandwidth, 'Hz', 'kHz', 3)}"
    refused = reading.total_peak is None
    rows: list[list[Cell]] = []
    for k in struck:
        blow, seen = solution.blows[k], solution.readings[k]
        assert seen is not None
        numbers = (blow.rigid_peak, seen.total_peak, seen.wave_peak)
        rows.append([str(blow.index), *(fixed(number, "m/s^2", "g", 0) for number in numbers)])
    text = f"{_PEAKS} Total and wave are stated{band}, at the tap {names[0]}; route: {route}."
    if refused:
        text += " No peak of total and wave is quoted: see the warning on the rise."
    table = Table("Rigid, total and wave acceleration", ["blow", "rigid (g)", "total (g)", "wave (g)"], rows)
    parts: list[Part] = [] if refused else [table]
    time = data["pulse_time"].values
    until = _settled(data["tap_force"].values[first])
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
    sections = [Section("Stress waves", text, parts)]
    waves = data["route_acceleration"].values
    tap = next((k for k in range(len(names)) if np.isfinite(waves[:, k]).any()), None)
    if tap is not None and route == "exact":
        sections.append(_run_routes(solution, first, tap, until))
    from strikewave.cases.losses_of_case import fitted_losses

    losses = fitted_losses(solution.case)
    tables: list[Part] = [layer_table(setup), *([fit_table(losses)] if losses else [])]
    sections.append(Section("Accuracy of the waves", _mismatch_words(setup), tables))
    return sections


def _settled(force: Any) -> int:
    """Return how many samples of a blow's window hold waves."""
    return int(np.flatnonzero(np.isfinite(force).any(axis=0))[-1]) + 1


def _run_routes(solution: Solution, first: int, tap: int, until: int) -> Section:
    data = solution.data
    time, name = data["pulse_time"].values[:until], str(data["tap"].values[tap])
    rigid = data["rigid_acceleration_filtered"].values[first, :until]
    exact = data["tap_acceleration"].values[first, tap, :until]
    reading = solution.readings[first]
    quoted = reading is not None and reading.total_peak is not None
    waves = data["route_acceleration"].values[:, tap, :until]
    return _route_section(name, quoted, time, exact, rigid, waves, _SINCE_TOUCH)


def _route_section(name: str, quoted: bool, time: Any, exact: Any, rigid: Any, waves: Any, since: str) -> Section:
    """Set the paper's three routes beside the exact solution at one tap; peaks only where they may be quoted."""
    printed, corrected = waves
    curves = [
        Trace("exact, total", time, exact),
        Trace("as printed, wave", time, printed),
        Trace("corrected, wave", time, corrected),
        Trace("superposed: rigid + as printed", time, rigid + printed),
    ]
    rows: list[list[Cell]] = [[c.label, fixed(_largest(c.values), "m/s^2", "g", 0)] for c in curves]
    peaks = Table(f"Largest acceleration at {name} by route", ["route", "peak (g)"], rows)
    return Section(
        "The paper's routes beside the exact solution",
        _ROUTES,
        [
            Picture(traces(f"Acceleration at {name} by four routes", curves, "g", since), f"Acceleration at {name}."),
            *([peaks] if quoted else []),
        ],
    )


def _largest(values: Any) -> float:
    finite = values[np.isfinite(values)]
    return float(finite[np.argmax(np.abs(finite))]) if finite.size else math.nan


def _mismatch_words(setup: WaveSetup) -> str:
    return (
        "Waves run on delay lines: exact but for the rounding of each transit to whole time steps. The largest "
        f"relative difference of a transit is {setup.mismatch:.1e}."
    )


def sensor_section(solution: Solution) -> list[Section]:
    """Show what each sensor made of the blows, and what its buffer takes off; nothing without sensors."""
    tables = getattr(solution.case, "sensor", ())
    readings = [reading for reading in getattr(solution, "readings", ()) or () if reading is not None]
    if not tables or not readings:
        return []
    from strikewave.cases.sensors_of_case import build_channels

    channels, data = build_channels(solution.case), solution.data
    struck = [k for k, reading in enumerate(solution.readings) if reading is not None]
    rows: list[list[Cell]] = []
    for k in struck:
        seen = solution.readings[k]
        assert seen is not None
        for name, pulse in seen.sensors.items():
            clipped = Tag("clipped", "bad") if pulse.clipped else Tag("no")
            width = fixed(pulse.width, "s", "us", 1)
            rows.append([str(solution.blows[k].index), name, fixed(pulse.peak, "m/s^2", "g", 0), width, clipped])
    curves = []
    for k, channel in enumerate(channels):
        values, start = data[f"reading_{k + 1}"], float(data[f"reading_{k + 1}_start"].values[struck[0]])
        held = values.values[struck[0]]
        curves.append(Trace(channel.sensor.name, start + float(values.attrs["step"]) * np.arange(held.size), held))
    index = solution.blows[struck[0]].index
    picture = traces(f"What the sensors read, blow {index}", curves, "g", _SINCE_TOUCH)
    table = Table("Sensor readings", ["blow", "sensor", "peak (g)", "width (µs)", "clipped"], rows)
    return [_sensors(channels, picture, table)]


def _sensors(channels: Sequence[Channel], picture: Figure, readings: Table) -> Section:
    """Describe the sensors, show what they read, and what their buffers take off."""
    described: list[list[Cell]] = []
    for sensor, _, recorder in channels:
        described.append(
            [
                sensor.name,
                "direct" if sensor.mounting.direct else f"{len(sensor.mounting.gaskets)} gaskets",
                _finite(sensor.resonance / 1e3),
                _finite(sensor.range / STANDARD_GRAVITY),
                _finite(recorder.sampling_rate / 1e3),
                _finite(recorder.cutoff / 1e3),
                str(recorder.bits or NONE),
            ]
        )
    heads = ["sensor", "mounting", "resonance (kHz)", "range (g)", "sampling (kHz)", "filter (kHz)", "bits"]
    words = "Readings as the recorders kept them: mounting, resonance, range, filter, sampling and bits included."
    parts: list[Part] = [Table("Sensors and their recorders", heads, described), Picture(picture, words), readings]
    buffered = [channel.sensor for channel in channels if not channel.sensor.mounting.direct]
    if buffered:
        frequency = np.geomspace(1e3, 1e5, 201)
        curves = [(sensor.name, frequency, loss_of(sensor.mounting, frequency)) for sensor in buffered]
        words = "What the buffer takes off the motion of the surface below it; below 0 it amplifies."
        parts += [Picture(insertion_loss(curves), words), loss_table(channels)]
    return Section("Sensors", "", parts)


LOSS_FREQUENCIES = (1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5)
"""Where the insertion loss of a buffer is listed, Hz."""


def loss_table(channels: Sequence[Channel]) -> Table:
    """List the insertion loss of the buffered sensors."""
    shown = np.array(LOSS_FREQUENCIES)
    rows: list[list[Cell]] = [
        [sensor.name, *(f"{value:.1f}" for value in loss_of(sensor.mounting, shown))]
        for sensor, _, _ in channels
        if not sensor.mounting.direct
    ]
    return Table(
        "Insertion loss (dB; below 0 the mounting amplifies)", ["sensor", *(f"{f / 1e3:g} kHz" for f in shown)], rows
    )


def _finite(value: float) -> str:
    return "none" if math.isinf(value) else written(value, 4)


def tap_rows(solution: BarSolution) -> list[list[str]]:
    """Return a row a tap with its largest values, for the route of the case."""
    rows = []
    for k, (name, tap) in enumerate(solution.taps):
        peaks, layer = solution.peaks(k, solution.route), solution.run.stack.layers[tap.layer]
        stress = None if peaks["force"] is None else peaks["force"] / layer.area
        rows.append(
            [
                name,
                solution.route,
                layer.name,
                f"{tap.position:g}",
                fixed(peaks["force"], "N", "kN", 3),
                fixed(stress, "Pa", "MPa", 2),
                fixed(peaks["velocity"], "m/s", "m/s", 3),
                fixed(peaks["acceleration"], "m/s^2", "g", 0),
            ]
        )
    return rows


def felt_words(solution: Solution) -> list[str]:
    """Say in words what taps and sensors felt of the first blow; nothing without a stack or sensors."""
    reading = next((r for r in getattr(solution, "readings", None) or () if r is not None), None)
    if reading is None:
        return []
    words = []
    if reading.total_peak is not None and reading.bandwidth is not None and "tap" in solution.data:
        band, tap = with_unit(reading.bandwidth, "Hz", "kHz", 3), solution.data["tap"].values[0]
        words.append(f"At the tap {tap} it reaches {with_unit(reading.total_peak, 'm/s^2', 'g')} in all, at {band}.")
    read = [f"{name} {with_unit(pulse.peak, 'm/s^2', 'g')}" for name, pulse in reading.sensors.items()]
    if read:
        words.append(f"Sensors read, with resonance and all they pass beyond that bandwidth: {listed(read)}.")
    return words


def bar_words(solution: BarSolution) -> str:
    """Say in words what a bar alone felt at its taps."""
    words = []
    for name, _, layer, _, force, stress, velocity, acceleration in tap_rows(solution):
        quoted = f" and {acceleration} g" if acceleration != NONE else ""
        words.append(f"{name} (in {layer}): {force} kN, {stress} MPa, {velocity} m/s{quoted}")
    return f"A stack alone under its load, route {solution.route}. Largest values, with their sign: {'; '.join(words)}."


def error_words(solution: BarSolution) -> str:
    """Say how exact the waves of a bar are."""
    velocity, acceleration = solution.accuracy
    bounds = "no bound" if math.isinf(velocity) else f"velocity {velocity:.1e}, acceleration {acceleration:.1e}"
    step = f"{solution.waves.step * 1e9:.4g} ns"
    if solution.method == "spectral":
        dispersion = solution.case.solver.dispersion
        return (
            f"spectral solver, dispersion: {dispersion}; error over the largest value at the taps, estimated from half "
            f"the step: {bounds}; time step {step}"
        )
    return (
        f"error bound over the largest value at the taps: {bounds}; time step {step}, largest mismatch of a transit "
        f"{solution.waves.mismatch:.1e}"
    )


def joint_rows(solution: BarSolution, most: int = 5) -> list[list[str]]:
    """List the joints that can open, and their first openings and closings."""

    def times(values: Sequence[float]) -> str:
        shown = ", ".join(f"{t * 1e6:.5g}" for t in values[:most])
        return (shown or NONE) + (f" and {len(values) - most} more" if len(values) > most else "")

    return [
        [row["after"], row["kind"], f"{row['preload']:g}", times(row["opened"]), times(row["closed"])]
        for row in solution.joints()
    ]


def contact_rows(solution: BarSolution) -> list[list[str]]:
    """List what the contact of a striker came to; nothing without one."""
    contact = solution.contact()
    if contact is None:
        return []
    touches = contact["contacts"]
    last = f"{touches[-1]['end'] * 1e6:.5g}" if touches else NONE
    return [
        ["peak force (kN)", f"{contact['peak_force'] / 1e3:.5g}"],
        ["deepest indentation (um)", f"{contact['max_indentation'] * 1e6:.4g}"],
        ["contacts, the last one until (us)", f"{len(touches)}, {last}"],
        ["impulse (N s)", f"{contact['impulse']:.5g}"],
        ["rebound speed of the striker (m/s)", f"{contact['rebound_speed']:.4g}"],
        ["energy lost in the contact (J)", f"{contact['energy_lost']:.4g}"],
    ]


CONTACT_HEADS = ["contact of the striker", "value"]


def hung_rows(solution: BarSolution) -> list[list[str]]:
    """List the masses on springs and their largest acceleration, without any filter."""
    return [
        [row["where"], f"{row['mass'] * 1e3:.4g}", f"{row['peak'] / STANDARD_GRAVITY:.5g}"]
        for row in solution.oscillators()
    ]


HUNG_HEADS = ["mass on a spring", "mass (gram)", "largest acceleration (g)"]


JOINT_HEADS = ["after", "kind", "preload (N)", "opens at (us)", "closes at (us)"]


def _staircase(field: WaveField, layer: int, solution: BarSolution) -> Picture:
    """Show how force grows at both faces of a layer between two others."""
    name, run = field.stack.layers[layer].name, solution.run
    words = (
        f"Force at both faces of {name} over the largest load. Dashed: the closed form for bonded joints and endless "
        "neighbours under this load, until the first echo from beyond them arrives (upright line); dotted: its steps "
        "for a load that jumps."
    )
    return Picture(staircase_diagram(field, layer, run.time, run.face_force), words)


def bar_tables(solution: BarSolution) -> list[tuple[str, list[str], list[list[str]]]]:
    """Return the further tables of a bar, captions, heads and rows: contact, masses on springs, joints, layers."""
    layers = [
        [layer.name, f"{stress / 1e6:.4g}"]
        for layer, stress in zip(solution.waves.layers, solution.layer_stress, strict=False)
    ]
    listed = [
        ("Contact of the striker", CONTACT_HEADS, contact_rows(solution)),
        ("Masses on springs", HUNG_HEADS, hung_rows(solution)),
        ("Joints that can open", JOINT_HEADS, joint_rows(solution)),
        ("Largest stress in each layer", ["layer", "stress (MPa)"], layers[:MOST_LAYERS]),
    ]
    return [entry for entry in listed if entry[2]]


def bar_sections(solution: BarSolution, quantity: str = "stress") -> list[Section]:
    """Show load, taps, the field of a quantity, staircase, routes and accuracy of a bar alone."""
    run, time = solution.run, solution.run.time
    heads = ["tap", "route", "layer", "position", "force (kN)", "stress (MPa)", "velocity (m/s)", "acceleration (g)"]
    rows: list[list[Cell]] = [list(row) for row in tap_rows(solution)]
    names = [name for name, _ in solution.taps[:4]]
    parts: list[Part] = [Table("Largest values at the taps", heads, rows)]
    for caption, columns, listing in bar_tables(solution):
        parts.append(Table(caption, columns, [list(row) for row in listing]))
    force = [Trace(name, time, run.force[:, k]) for k, name in enumerate(names)]
    speed = [Trace(name, time, run.velocity[:, k]) for k, name in enumerate(names)]
    total = [Trace(name, time, run.acceleration[:, k]) for k, name in enumerate(names)]
    parts += [
        Picture(
            traces("Force", [*force, Trace("first face", time, run.face_force)], "kN", _SINCE_LOAD),
            "Force at the taps, and on the first face (exact).",
        ),
        Picture(traces("Velocity", speed, "m/s", _SINCE_LOAD), "Velocity at the taps (exact)."),
        Picture(
            traces("Acceleration", [*total, Trace("the whole stack", time, solution.rigid)], "g", _SINCE_LOAD),
            "Acceleration at the taps (exact), and of the stack as one body."
            + ("" if solution.quoted else " Its peaks are not to be quoted: see the warnings."),
        ),
    ]
    field = bar_field(solution)
    parts += field_pictures(field, quantity)
    layer = sandwiched(field)
    if layer is not None:
        parts.append(_staircase(field, layer, solution))
    sections = [Section("Stress waves", "", parts)]
    if solution.channels:
        read = [
            Trace(channel.sensor.name, reading.time, reading.values)
            for channel, reading in zip(solution.channels, solution.readings, strict=True)
        ]
        pulses: list[list[Cell]] = [
            [
                name,
                fixed(pulse.peak, "m/s^2", "g", 0),
                fixed(pulse.width, "s", "us", 1),
                Tag("clipped", "bad") if pulse.clipped else Tag("no"),
            ]
            for name, pulse in solution.sensors.items()
        ]
        picture = traces("What the sensors read", read, "g", _SINCE_LOAD)
        table = Table("Sensor readings", ["sensor", "peak (g)", "width (µs)", "clipped"], pulses)
        sections.append(_sensors(solution.channels, picture, table))
    tap = next((k for k, (name, _) in enumerate(solution.taps) if (name, "corrected") in solution.routes), None)
    if tap is not None:
        name = solution.taps[tap][0]
        waves = [solution.routes[name, route].acceleration for route in ("as printed", "corrected")]
        sections.append(
            _route_section(name, solution.quoted, time, run.acceleration[:, tap], solution.rigid, waves, _SINCE_LOAD)
        )
    words = error_words(solution)
    words = words[0].upper() + words[1:]
    tables: list[Part] = [] if solution.method == "spectral" else [layer_table(solution.waves)]
    if solution.losses:
        tables.append(fit_table(solution.losses))
    sections.append(Section("Accuracy of the waves", f"{words}.", tables))
    return sections
