"""``strikewave buffer``: rank gasket stacks under a sensor by what it then reads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

import typer

from strikewave.base.errors import InputError
from strikewave.base.quantities import Value
from strikewave.reporting import measured_files as measured
from strikewave.reporting.options import Changes, Running, case_name, quantity, typed_value
from strikewave.reporting.output_options import StudyOutput
from strikewave.studies.buffer import LAYERS, THICKEST, WORST


@dataclass(frozen=True)
class StackOptions:
    """Gaskets that stacks may be made of, and what ranks the stacks; see `strikewave.StackChoices`."""

    material: Annotated[
        list[str] | None,
        typer.Option(
            "--material",
            metavar="MATERIAL",
            help="Material of the gaskets; all polymers and elastomers by default; may be repeated.",
            show_default=False,
        ),
    ] = None
    thickness: Annotated[
        list[Value] | None,
        typed_value(
            "--thickness",
            si="m",
            highest=THICKEST,
            help="Thickness of the gaskets; 0.5, 1 and 2 mm by default; may be repeated.",
        ),
    ] = None
    layers: Annotated[int, typer.Option("--layers", metavar="COUNT", help="Largest number of gaskets in a stack.")] = (
        LAYERS
    )
    rank: Annotated[
        Literal["bandwidth", "peak", "robust"],
        typer.Option("--rank", help="Quantity that ranks the stacks that keep the limit."),
    ] = "bandwidth"


@dataclass(frozen=True)
class SensorOptions:
    """The sensor: its name in a case, and what is stated of it in place of what the case has."""

    sensor: Annotated[
        str | None,
        typer.Option(
            "--sensor", metavar="NAME", help="Name of the sensor, where the case has several.", show_default=False
        ),
    ] = None
    mass: Annotated[
        Value | None,
        typed_value("--mass", si="kg", highest=1e3, help="Mass of the sensor; that of the case by default."),
    ] = None
    diameter: Annotated[
        Value | None,
        typed_value("--diameter", si="m", highest=1.0, help="Diameter of the gaskets; that of the case by default."),
    ] = None
    model: Annotated[
        str | None,
        typer.Option(
            "--model", metavar="NAME", help="A known accelerometer; that of the case by default.", show_default=False
        ),
    ] = None

    def stated(self) -> dict[str, Any]:
        """Return what is stated of the sensor."""
        from strikewave.studies.buffer.stacks import chosen

        sizes = {"mass": self.mass, "diameter": self.diameter}
        values = {name: chosen(value) for name, value in sizes.items() if value is not None}
        return values if self.model is None else {"model": self.model, **values}


def command(
    case: Annotated[
        str | None, case_name("CASE", "Case with the sensor: a case file, or the name of a built-in case.")
    ] = None,
    *,
    limit: Annotated[
        float, quantity("--limit", si="m/s^2", bare=False, help='Largest allowed reading, such as "5000 g".')
    ],
    blow: Annotated[
        str, typer.Option("--blow", metavar="worst|first|NUMBER", help="Blow that the stacks are compared at.")
    ] = WORST,
    stacks: StackOptions,
    mounted: SensorOptions,
    record: Annotated[
        str | None,
        typer.Option(
            "--record",
            metavar="FILE",
            help="Measured acceleration of the mounting surface, instead of a run of the case.",
            show_default=False,
        ),
    ] = None,
    measurement: measured.MeasurementOptions,
    changes: Changes = None,
    running: Running,
    output: StudyOutput,
) -> int:
    """Rank gasket stacks under a sensor.

    They are ranked by what the sensor reads of a blow, and by the bandwidth that is left. The blow is that of a machine
    case or a layered bar at the sensor's tap, or a record. With --json, no files are written unless --out is given.
    """
    from strikewave.studies.buffer.report import BufferCommand, source_of_case, source_of_record
    from strikewave.studies.buffer.stacks import BufferGoal, StackChoices, all_stacks
    from strikewave.studies.engine.runner import Workers

    goal = BufferGoal(limit, stacks.rank)
    choice = StackChoices(stacks.material or (), stacks.thickness or (), stacks.layers)
    all_stacks(choice)  # refuses too many before the case is run
    if record is None:
        source = source_of_case(case, mounted.sensor, changes, mounted.stated())
    else:
        if blow != WORST:
            raise InputError("--blow", blow, "only without --record, which holds one blow")
        stated, options = measurement.calibration(), measurement.reading()
        source = source_of_record(record, stated, options, (case, mounted.sensor, changes), mounted.stated())
    pool = Workers(running.workers, cluster=running.cluster).pool()
    return BufferCommand(source, blow, choice, goal, pool, place=running.store, fresh=running.fresh).run(output)
