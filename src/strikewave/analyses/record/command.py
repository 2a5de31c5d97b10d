"""``strikewave record``: what measured records say, file by file and together."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import typer

from strikewave.analyses.record.options import FilterOptions, RecordSpecificationOptions
from strikewave.base.errors import InputError
from strikewave.reporting import measured_files as measured
from strikewave.reporting.options import quantity
from strikewave.reporting.output_options import Output


def command(
    files: measured.Files,
    *,
    measurement: measured.MeasurementOptions,
    drop_height: Annotated[
        float | None,
        quantity("--drop-height", si="m", help='Free fall before the blow, such as "1.2 m"; not checked by default.'),
    ] = None,
    base: Annotated[
        str | None,
        typer.Option(
            "--base", metavar="CHANNEL", help="Driving channel: the others are responses to its blow; none by default."
        ),
    ] = None,
    columns: Annotated[
        Literal["channels", "repeats"],
        typer.Option("--columns", help="What the columns of a file are: channels, or repeats of one test."),
    ] = "channels",
    fail_on: Annotated[
        Literal["bad", "suspect"] | None,
        typer.Option(
            "--fail-on", help="Status of a file, or a worse one, that makes the exit code 3; none by default."
        ),
    ] = None,
    motion: Annotated[
        bool, typer.Option("--motion", help="Velocity and displacement too, by integration, with their drift.")
    ] = False,
    pair: Annotated[
        str | None,
        typer.Option(
            "--pair",
            metavar="CHANNEL,CHANNEL",
            help="Two channels compared as sensors on one object: common and differential motion, delay, gain and "
            "transfer function; none by default.",
        ),
    ] = None,
    sensor: Annotated[
        str | None,
        typer.Option(
            "--sensor",
            metavar="MODEL|FILE",
            help="Sensor on which the blows are tried: a known accelerometer, or a .toml file with [[sensor]].",
            show_default=False,
        ),
    ] = None,
    judging: RecordSpecificationOptions,
    filtering: FilterOptions,
    output: Output,
) -> int:
    """Measure the pulses of recorded files.

    Gives status, health and pulses of each file, and the statistics of all together. With --json, no files are
    written unless --out is given. Files that come as a shell lists them are taken in the natural order of their
    names, a2 before a10. --spec judges each blow by a specification; --sensor says whether a sensor could take it, and
    what is left of it. The exit code is 3 where a file could not be read, has a status of --fail-on, or where the
    verdict by a specification is FAIL.
    """
    from strikewave.analyses.record.screen import examine_records
    from strikewave.analyses.record.sensor_pairs import read_pair
    from strikewave.cases.stack_of_case import stated_sensor
    from strikewave.records import Request

    if base and columns == "repeats":
        raise InputError("--base", base, "a channel of files whose columns are channels", "leave out --columns repeats")

    if pair is not None and columns == "repeats":
        raise InputError("--pair", pair, "channels of files whose columns are channels", "leave out --columns repeats")
    two = () if pair is None else read_pair(pair)
    height = math.nan if drop_height is None else drop_height
    channels = tuple(measurement.channel or ())
    wanted = filtering.on(Request(channels, measurement.calibration(), height, base=base or ""))
    specification = judging.specification()
    tried = None if sensor is None else stated_sensor(sensor, "--sensor")
    shown = (columns == "repeats", fail_on or "", motion)
    judge = (specification, judging.asked)
    budget = judging.uncertainty
    return examine_records(files, wanted, measurement.reading(), output, *shown, *judge, two, tried, budget)
