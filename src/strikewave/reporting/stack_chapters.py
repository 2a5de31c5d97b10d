"""Sections on the waves and sensors of a stack, whether a machine or a load strikes it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.reporting.curves import Trace, traces
from strikewave.reporting.numbers import fixed
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written
from strikewave.reporting.wave_curves import insertion_loss
from strikewave.reporting.wave_field import QUANTITIES, WaveField, snapshots, xt_diagram
from strikewave.sensors import insertion_loss as loss_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.cases.losses_of_case import Loss
    from strikewave.sensors.channel import Channel
    from strikewave.waves.setup import WaveSetup


MOST_LAYERS = 50
"""Layers that a table lists."""
LOSS_FREQUENCIES = (1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5)
"""Where the insertion loss of a buffer is listed, Hz."""
PEAK_WORDS = (
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


def route_section(name: str, quoted: bool, time: Any, exact: Any, rigid: Any, waves: Any, since: str) -> Section:
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


def mismatch_words(setup: WaveSetup) -> str:
    """Say how waves ran on delay lines, and by how much a transit was rounded."""
    return (
        "Waves run on delay lines: exact but for the rounding of each transit to whole time steps. The largest "
        f"relative difference of a transit is {setup.mismatch:.1e}."
    )


def sensor_part(channels: Sequence[Channel], picture: Figure, readings: Table) -> Section:
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
