"""``strikewave buffer``: rank gasket stacks under a sensor by what it then reads."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import Changes, Force, Json, Out

if TYPE_CHECKING:
    from strikewave.base.quantities import Value
    from strikewave.studies.buffer.choice import Choice

THICKNESSES = ("0.5 mm", "1 mm", "2 mm")
"""Of the gaskets unless said otherwise."""


def command(
    case: Annotated[
        str | None,
        typer.Argument(metavar="[CASE]", help="A case file or published case with the sensor.", show_default=False),
    ] = None,
    limit: Annotated[str, typer.Option("--limit", help='Largest reading, such as "5000 g".', show_default=False)] = "",
    sensor: Annotated[
        str | None, typer.Option("--sensor", help="Its name, where the case has several.", show_default=False)
    ] = None,
    blow: Annotated[str, typer.Option("--blow", help="worst, first, or the number of a blow.")] = "worst",
    material: Annotated[
        list[str] | None,
        typer.Option(
            "--material", help="Of the gaskets; repeated. Polymers and elastomers by default.", show_default=False
        ),
    ] = None,
    thickness: Annotated[
        list[str] | None,
        typer.Option("--thickness", help="Of the gaskets; repeated. 0.5, 1 and 2 mm by default.", show_default=False),
    ] = None,
    layers: Annotated[int, typer.Option("--layers", help="Most gaskets of a stack.")] = 3,
    rank: Annotated[str, typer.Option("--rank", help="bandwidth, peak or robust: what comes first.")] = "bandwidth",
    mass: Annotated[str | None, typer.Option("--mass", help="Of the sensor.", show_default=False)] = None,
    diameter: Annotated[
        str | None, typer.Option("--diameter", help="Of the gaskets; that of the case by default.", show_default=False)
    ] = None,
    model: Annotated[str | None, typer.Option("--model", help="A known accelerometer.", show_default=False)] = None,
    record: Annotated[
        str | None,
        typer.Option(
            "--record", metavar="FILE", help="Measured acceleration of the mounting surface.", show_default=False
        ),
    ] = None,
    channel: measured.Channels = None,
    unit: measured.Unit = None,
    sensitivity: measured.Sensitivity = None,
    rate: measured.Rate = None,
    time: measured.Time = None,
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Rank gasket stacks under a sensor by what it then reads of a blow, with their price in bandwidth.

    The blow is that of a machine case or a bar case at the sensor's tap, or a record. With --json, files are
    written only where --out says.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # for matrices this small, threads wait longer than they work
    from strikewave.base.errors import InputError
    from strikewave.reporting.run_and_write import Output
    from strikewave.studies.buffer.candidate import Goal
    from strikewave.studies.buffer.screen import BufferCommand, rank_buffers, source_of_case, source_of_record

    goal = Goal(_limit(limit), rank)
    choice = _choice(material, thickness, layers)
    given = _given(mass, diameter, model)
    if record is None:
        source = source_of_case(case, sensor, changes, given)
    else:
        if blow != "worst":
            raise InputError("--blow", blow, "only without --record, which holds one blow")
        stated = measured.stated_of(unit=unit, sensitivity=sensitivity)
        options = measured.options_of(rate, time, channel)
        source = source_of_record(record, stated, options, (case, sensor, changes), given)
    return rank_buffers(BufferCommand(source, blow, choice, goal), Output(out, force, json))


def _limit(text: str) -> float:
    from strikewave.base.errors import MISSING, InputError
    from strikewave.base.units import parse_quantity

    allowed = 'an acceleration above zero with its unit, such as "5000 g"'
    if not text:
        raise InputError("--limit", MISSING, allowed, 'add --limit "5000 g"')
    value = parse_quantity(text, "m/s^2", "--limit")
    if not 0.0 < value < math.inf:
        raise InputError("--limit", text, allowed)
    return value


def _quantity(text: str, si: str, highest: float, field: str) -> Value:
    """Read a quantity above zero as a case file would."""
    from strikewave.base.errors import InputError
    from strikewave.base.quantities import Range

    try:
        value = Range(si, 0.0, highest, open_low=True).read(text)
    except InputError as error:
        raise InputError(field, error.got, error.allowed, error.hint) from None
    return value.model_copy(update={"note": "chosen by strikewave buffer"})


def _choice(names: list[str] | None, sizes: list[str] | None, layers: int) -> Choice:
    from strikewave.studies.buffer.choice import Choice, stacks
    from strikewave.studies.buffer.seat import usual_materials

    thicknesses = tuple(_quantity(text, "m", 0.1, "--thickness") for text in sizes or THICKNESSES)
    choice = Choice(tuple(names or usual_materials()), thicknesses, layers)
    stacks(choice)
    return choice


def _given(mass: str | None, diameter: str | None, model: str | None) -> dict[str, Any]:
    """Return what was typed of the sensor."""
    found: dict[str, Any] = {} if model is None else {"model": model}
    if mass is not None:
        found["mass"] = _quantity(mass, "kg", 1e3, "--mass")
    if diameter is not None:
        found["diameter"] = _quantity(diameter, "m", 1.0, "--diameter")
    return found
