"""Sections on the waves and sensors of a stack, whether a machine or a load strikes it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from strikewave.base.shock_quantities import ACCELERATION, KILOHERTZ, LENGTH, STEP
from strikewave.reporting.curves import Trace, traces
from strikewave.reporting.faces import amount
from strikewave.reporting.numbers import fixed, headed, percent, shown
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table, written
from strikewave.reporting.wave_curves import insertion_loss
from strikewave.reporting.wave_field import QUANTITIES, WaveField, snapshots, xt_diagram
from strikewave.sensors import insertion_loss as loss_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.cases.stack_of_case import FittedLoss
    from strikewave.sensors.trial import SensorChannel
    from strikewave.waves.transit import WaveSetup


MOST_LAYERS = 50
"""Layers that a table lists (chosen: about two screens; the JSON lists all)."""
LOSS_FREQUENCIES = (1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 1e5)
"""Where the insertion loss of a buffer is listed, Hz (chosen: 1, 2, 5 steps over the flat range and the resonances of
shock accelerometers)."""
PEAK_WORDS = (
    "A peak is the value of largest magnitude, with its sign. Rigid is the momentum rate of the assembly over its "
    "mass; total is what a perfect sensor at the section would read; wave is total minus rigid."
)
_RECORDED = {"resonance": KILOHERTZ, "range": ACCELERATION, "sampling": KILOHERTZ, "filter": KILOHERTZ}
"""What the table of sensors says of each."""
_ROUTES = (
    "The routes of Li & Ma 2019 take the neighbours of the specimen as endless, with the force on the loaded face as "
    "input. As printed, echoes return too early and a backward wave has the wrong sign; the corrected route repairs "
    "both. The paper then adds the wave to the rigid acceleration (superposed), which counts the rigid motion twice. "
    "The exact route is the finite stack itself."
)


def fit_table(losses: Sequence[FittedLoss]) -> Table:
    """List where energy is lost: the loss factor of the case, its band, the largest relative deviation of the model."""
    rows: list[list[Cell]] = []
    for loss in losses:
        low, high = (f"{shown(end, *KILOHERTZ.units):g}" for end in (loss.low, loss.high))
        rows.append([loss.where, f"{loss.loss_factor:g}", f"{low} to {high}", percent(loss.error, 1)])
    band = headed("band", *KILOHERTZ.units)
    return Table("Fit of the loss factors", ["where", "loss factor", band, "largest deviation"], rows)


def layer_table(setup: WaveSetup) -> Table:
    """List the layers as asked for and as the time step made them."""
    rows: list[list[Cell]] = [
        [
            layer.name,
            written(shown(layer.length_asked, *LENGTH.units), 7),
            written(shown(layer.length_used, *LENGTH.units), 7),
            f"{layer.length_used / layer.length_asked - 1.0:+.1e}",
            layer.steps,
        ]
        for layer in setup.layers[:MOST_LAYERS]
    ]
    more = len(setup.layers) - MOST_LAYERS
    caption = f"Layers, rounded to whole time steps of {amount(STEP, setup.step)}"
    caption += f"; {more} more in the JSON" if more > 0 else ""
    lengths = [headed(name, *LENGTH.units) for name in ("length in the case", "length used")]
    return Table(
        caption,
        ["layer", *lengths, "relative difference", "time steps of a transit"],
        rows,
    )


def field_pictures(field: WaveField, quantity: str = "stress") -> list[Part]:
    """Show the whole field: the x-t diagram, and snapshots along the stack."""
    drawn = QUANTITIES[quantity]
    meaning = {"RdBu": "blue is compression, red tension", "PuOr": "purple is along the blow, orange against it"}
    opens = any(joint.unilateral for joint in field.stack.joints)
    double = " A joint that can open is a double line while no force crosses it." if opens else ""
    return [
        Picture(
            xt_diagram(field, quantity),
            f"{drawn.name.capitalize()} along the stack over time (exact): {meaning[drawn.colours]}. Lines are faces "
            f"of layers, dotted ones taps; the dashed line is the leading front at the bar wave speeds.{double}",
        ),
        Picture(
            snapshots(field, quantity),
            f"{drawn.name.capitalize()} along the stack at chosen times: as the front passes, at the largest values, "
            "and in the longest intervals between. The darker a layer, the larger its impedance.",
        ),
    ]


def route_section(name: str, quoted: bool, time: Any, exact: Any, rigid: Any, waves: Any, since: str) -> Section:
    """Compare the paper's three routes with the exact solution at one tap; peaks only where they may be quoted."""
    printed, corrected = waves
    curves = [
        Trace("exact, total", time, exact),
        Trace("as printed, wave", time, printed),
        Trace("corrected, wave", time, corrected),
        Trace("superposed: rigid + as printed", time, rigid + printed),
    ]
    rows: list[list[Cell]] = [[c.label, fixed(_largest(c.values), *ACCELERATION.units, 0)] for c in curves]
    peaks = Table(f"Largest acceleration at {name} by route", ["route", headed("peak", *ACCELERATION.units)], rows)
    return Section(
        "Routes of the paper compared with the exact solution",
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


def sensor_part(channels: Sequence[SensorChannel], picture: Figure, readings: Table) -> Section:
    """Show what the sensors read, describe them, and say what their buffers take off."""
    described: list[list[Cell]] = []
    for sensor, _, recorder in channels:
        stated = (sensor.resonance, sensor.range, recorder.sampling_rate, recorder.cutoff)
        described.append(
            [
                sensor.name,
                "direct" if sensor.mounting.direct else f"{len(sensor.mounting.gaskets)} gaskets",
                *(
                    "none" if math.isinf(value) else written(shown(value, *of.units), 4)
                    for value, of in zip(stated, _RECORDED.values(), strict=True)
                ),
                str(recorder.bits or NONE),
            ]
        )
    described_by = ["sensor", "mounting", *(headed(name, *of.units) for name, of in _RECORDED.items()), "bits"]
    caption = "Sensor readings as recorded: with mounting, resonance, range, filter, sampling and bits."
    parts: list[Part] = [
        Picture(picture, caption),
        readings,
        Table("Sensors and their recorders", described_by, described),
    ]
    buffered = [channel.sensor for channel in channels if not channel.sensor.mounting.direct]
    if buffered:
        frequency = np.geomspace(1e3, 1e5, 201)
        curves = [(sensor.name, frequency, loss_of(sensor.mounting, frequency)) for sensor in buffered]
        caption = "Insertion loss: how much the buffer reduces the motion below it; negative where it amplifies."
        parts += [Picture(insertion_loss(curves), caption), loss_table(channels)]
    return Section("Sensors", "", parts)


def loss_table(channels: Sequence[SensorChannel]) -> Table:
    """List the insertion loss of the buffered sensors."""
    rows: list[list[Cell]] = [
        [sensor.name, *(f"{value:.1f}" for value in loss_of(sensor.mounting, np.array(LOSS_FREQUENCIES)))]
        for sensor, _, _ in channels
        if not sensor.mounting.direct
    ]
    return Table(
        "Insertion loss (dB; negative where the mounting amplifies)",
        ["sensor", *(amount(KILOHERTZ, f) for f in LOSS_FREQUENCIES)],
        rows,
    )
