"""``strikewave record``: what measured records say, file by file and together."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import Force, Json, Out

if TYPE_CHECKING:
    from strikewave.signal.filters import Filter


def command(
    files: measured.Files,
    channel: measured.Channels = None,
    unit: measured.Unit = None,
    sensitivity: measured.Sensitivity = None,
    gain: measured.Gain = None,
    excitation: measured.Excitation = None,
    rated_excitation: measured.RatedExcitation = None,
    count: measured.Count = None,
    polarity: measured.Polarity = None,
    rate: measured.Rate = None,
    time: measured.Time = None,
    drop_height: Annotated[
        str | None, typer.Option("--drop-height", help='Fall before the blow, such as "1.2 m".', show_default=False)
    ] = None,
    cutoff: Annotated[
        str | None,
        typer.Option("--filter", help="Zero-phase low-pass: -3 dB there for both passes.", show_default=False),
    ] = None,
    cfc: Annotated[
        str | None,
        typer.Option("--cfc", help="SAE J211 filter of this channel class, such as 1000.", show_default=False),
    ] = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Examine records: status, health, pulses, campaign.

    With --json, files are written only where --out says.
    """
    from strikewave.analyses.record.screen import examine_records
    from strikewave.records import Request
    from strikewave.reporting.run_and_write import Output

    stated = measured.stated_of(
        unit=unit, sensitivity=sensitivity, gain=gain, excitation=excitation,
        rated_excitation=rated_excitation, count=count, polarity=polarity,
    )  # fmt: skip
    height = math.nan if drop_height is None else measured.positive(drop_height, "m", "--drop-height")
    wanted = Request(tuple(channel or ()), stated, height, _filter(cutoff, cfc))
    return examine_records(files, wanted, measured.options_of(rate, time, channel), Output(out, force, json))


def _filter(cutoff: str | None, cfc: str | None) -> Filter | None:
    from strikewave.base.errors import InputError
    from strikewave.signal.filters import Filter

    if cutoff is not None and cfc is not None:
        raise InputError("--cfc", cfc, "either --filter or --cfc", "leave one out")
    if cutoff is not None:
        return Filter(measured.positive(cutoff, "Hz", "--filter"))
    if cfc is None:
        return None
    try:
        channel_class = float(cfc)
    except ValueError:
        channel_class = math.nan
    if not 0.0 < channel_class < 1e6:
        raise InputError("--cfc", cfc, "a channel frequency class, such as 60, 180, 600 or 1000")
    return Filter.sae_j211(channel_class)
