"""Sections on what a machine's blows do in a stack, and what its taps and sensors show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.reporting.curves import Trace, traces
from strikewave.reporting.faces import face_table, text_of
from strikewave.reporting.parts import Part, Picture, Section
from strikewave.reporting.stack_chapters import (
    PEAK_WORDS,
    field_pictures,
    fit_table,
    layer_table,
    mismatch_words,
    route_section,
    sensor_part,
)
from strikewave.reporting.wave_field import WaveField
from strikewave.waves.transit import TimeGrid, field_nodes

if TYPE_CHECKING:
    from strikewave.analyses.machine.result import Solution


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
    text = f"{PEAK_WORDS} Total and wave are stated{band}, at the tap {names[0]}; route: {route}."
    if refused:
        text += " No peak of total and wave is quoted: see the warning on the rise."
    table = face_table(solution, "wave_blows", "waves", "Rigid, total and wave acceleration")
    parts: list[Part] = []
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
    if not refused:
        parts.append(table)
    sections = [Section("Stress waves", text, parts)]
    waves = data["route_acceleration"].values
    tap = next((k for k in range(len(names)) if np.isfinite(waves[:, k]).any()), None)
    if tap is not None and route == "exact":
        sections.append(_run_routes(solution, first, tap, until))
    return sections


def accuracy_section(solution: Solution) -> list[Section]:
    """Say how exact the waves are, layer by layer; nothing without a stack."""
    from strikewave.cases.losses_of_case import fitted_losses

    setup = solution.waves
    if setup is None or not any(solution.readings):
        return []

    losses = fitted_losses(solution.case)
    tables: list[Part] = [layer_table(setup), *([fit_table(losses)] if losses else [])]
    return [Section("Accuracy of the waves", mismatch_words(setup), tables)]


def _settled(force: Any) -> int:
    """Return how many samples of a blow's window hold waves."""
    return int(np.flatnonzero(np.isfinite(force).any(axis=0))[-1]) + 1


def _run_routes(solution: Solution, first: int, tap: int, until: int) -> Section:
    data = solution.arrays
    time, name = data["pulse_time"].values[:until], str(data["tap"].values[tap])
    rigid = data["rigid_acceleration_filtered"].values[first, :until]
    exact = data["tap_acceleration"].values[first, tap, :until]
    reading = solution.readings[first]
    quoted = reading is not None and reading.total_peak is not None
    waves = data["route_acceleration"].values[:, tap, :until]
    return route_section(name, quoted, time, exact, rigid, waves, _SINCE_TOUCH)


def sensor_section(solution: Solution) -> list[Section]:
    """Show what each sensor made of the blows, and what its buffer takes off; nothing without sensors."""
    readings = [reading for reading in solution.readings if reading is not None]
    if not solution.case.sensor or not readings:
        return []
    from strikewave.cases.sensors_of_case import build_channels

    channels, data = build_channels(solution.case), solution.arrays
    struck = [k for k, reading in enumerate(solution.readings) if reading is not None]
    curves = []
    for k, channel in enumerate(channels):
        values, start = data[f"reading_{k + 1}"], float(data[f"reading_{k + 1}_start"].values[struck[0]])
        samples = values.values[struck[0]]
        curves.append(
            Trace(channel.sensor.name, start + float(values.attrs["step"]) * np.arange(samples.size), samples)
        )
    index = solution.blows[struck[0]].index
    picture = traces(f"What the sensors read, blow {index}", curves, "g", _SINCE_TOUCH)
    table = face_table(solution, "sensor_rows")
    return [sensor_part(channels, picture, table)]
