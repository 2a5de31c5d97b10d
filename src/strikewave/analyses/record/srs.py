"""``strikewave srs``: the shock response spectrum of a measured record."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import Force, Json, Out


def command(
    file: Annotated[
        str, typer.Argument(metavar="FILE", help="A measured file of any known format.", show_default=False)
    ],
    q: Annotated[str, typer.Option("--q", help="Quality factor 1 / (2 damping ratio), or inf.")] = "10",
    low: Annotated[str, typer.Option("--from", help="Lowest natural frequency.")] = "10 Hz",
    high: Annotated[
        str | None, typer.Option("--to", help="Highest; 100 kHz or 2/5 of the sampling rate.", show_default=False)
    ] = None,
    per_octave: Annotated[str, typer.Option("--per-octave", help="Frequencies an octave.")] = "12",
    frequency: Annotated[
        list[str] | None, typer.Option("--frequency", help="These frequencies instead; repeated.", show_default=False)
    ] = None,
    kind: Annotated[
        list[str] | None,
        typer.Option(
            "--kind", help="absolute (default), displacement or pseudo-velocity; may be repeated.", show_default=False
        ),
    ] = None,
    side: Annotated[str, typer.Option("--side", help="maximax, positive or negative.")] = "maximax",
    part: Annotated[str, typer.Option("--part", help="total, primary (while the shock lasts) or residual.")] = "total",
    end: Annotated[
        str | None, typer.Option("--end", help="When the shock ends, in the file's time.", show_default=False)
    ] = None,
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
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Compute shock response spectra of a record, its zero line taken off.

    With --json, files are written only where --out says.
    """
    from strikewave.analyses.record.spectrum import KIND_UNITS, SIDES, Wanted, compute_spectra
    from strikewave.reporting.run_and_write import Output
    from strikewave.signal.srs import PARTS

    stated = measured.stated_of(
        unit=unit, sensitivity=sensitivity, gain=gain, excitation=excitation,
        rated_excitation=rated_excitation, count=count, polarity=polarity,
    )  # fmt: skip
    kinds = tuple(dict.fromkeys(_one_of(k, tuple(KIND_UNITS), "--kind") for k in kind or ["absolute"]))
    _one_of(side, SIDES, "--side")
    _one_of(part, PARTS, "--part")
    quality = math.inf if q.strip().lower() == "inf" else _number(q, "--q", "a quality factor above zero, or inf")
    wanted = Wanted(quality, frequency, (low, high, per_octave), kinds, side, part, end)
    return compute_spectra(file, wanted, stated, measured.options_of(rate, time, channel), Output(out, force, json))


def _number(text: str, field: str, allowed: str) -> float:
    from strikewave.base.errors import InputError

    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise InputError(field, text, allowed)
    return value


def _one_of(word: str, choices: Sequence[str], field: str) -> str:
    from strikewave.base.errors import InputError, nearest

    if word not in choices:
        raise InputError(field, word, "one of " + ", ".join(choices), nearest(word, choices))
    return word
