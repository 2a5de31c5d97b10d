"""Records as the JSON document holds them: files, channels, blows, responses, campaigns."""

from __future__ import annotations

import math
from typing import Any

from strikewave.analyses.record.chosen import cutoff_for
from strikewave.base.constants import COVERAGE
from strikewave.records.band_split import BandSplit
from strikewave.records.budget.contributions import RECORD
from strikewave.records.campaign import Campaign
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import ChannelReading, FileReading
from strikewave.records.response import MeasuredResponse
from strikewave.signal.filters import Filter, effect_on_half_sine
from strikewave.signal.pulse import HALF_SINE_WIDTH

RIGID = ("peak", "width", "velocity_change", "peak_uncertainty", "width_uncertainty", "velocity_change_uncertainty")
"""Figures of the pulse without ringing."""
SPLIT = ("peak", "width", "peak_uncertainty", "width_uncertainty")
"""Figures of the rigid part by the band split."""


def file_row(file: FileReading, filter_: Filter | None) -> dict[str, Any]:
    """Return a file as a row, its channels in a list."""
    return {
        "file": file.path,
        "format": file.format,
        "status": file.status,
        "reasons": file.reasons,
        "health": [f.health_document() for f in file.findings],
        "channels": [_channel(reading, filter_) for reading in file.channels],
    }


def _channel(reading: ChannelReading, filter_: Filter | None) -> dict[str, Any]:
    channel = reading.channel
    return {
        "name": channel.name,
        "number": reading.number,
        "sampling_rate": channel.sampling_rate,
        "samples": channel.values.size,
        "unit": channel.unit or None,
        "status": reading.status,
        "calibration": reading.calibration.stated(),
        "health": [f.health_document() for f in reading.findings],
        "pulses": [
            {**pulse_row(pulse), "uncertainty": uncertainty_row(reading, place)}
            for place, pulse in enumerate(reading.pulses)
        ],
        "response": None if reading.response is None else response_row(reading.response),
        "responses": [response_row(response) for response in reading.responses],
        "advised_cutoff": cutoff_for(reading),
        "filter": None if filter_ is None else filter_effect(reading, filter_),
    }


def response_row(response: MeasuredResponse) -> dict[str, Any]:
    """Return a response as a row, its modes in a list."""
    modes = [{**mode._asdict(), "decay_time": mode.decay_time} for mode in response.modes]
    begin, end = response.decay
    return {**response._asdict(), "modes": modes, "decay": {"begin": begin, "end": end}}


def pulse_row(pulse: RecordedPulse) -> dict[str, Any]:
    """Return a pulse as a row."""
    names = ("time", "peak", "rise", "width", "velocity_change", "ringing_frequency", "offset", "noise", "method")
    row = {name: getattr(pulse, name) for name in (*names, "begin", "end")}
    return {
        **row,
        "smooth_peak": pulse.smooth.peak,
        "smooth_width": pulse.smooth.width(),
        "smooth_misfit": pulse.smooth.misfit,
        **{f"{name}_uncertainty": value for name, value in pulse.uncertainty._asdict().items()},
        **{f"rigid_{name}": getattr(pulse.rigid, name, math.nan) for name in RIGID},
        "split": None if pulse.split is None else split_row(pulse.split, pulse.methods_apart),
        "rebounds": [rebound._asdict() for rebound in pulse.rebounds],
    }


def uncertainty_row(reading: ChannelReading, place: int) -> dict[str, Any]:
    """Return the uncertainties of a blow: by a budget, or of noise and baseline alone."""
    if reading.uncertainties:
        found = reading.uncertainties[place]
        return {name: one.document() for name, one in found.figures.items()}
    return {
        name: {
            "standard": value,
            "expanded": COVERAGE * value,
            "coverage": COVERAGE,
            "method": RECORD,
            "contributions": [{"name": RECORD, "standard": value, "share": 1.0}],
        }
        for name, value in reading.pulses[place].uncertainty._asdict().items()
    }


def split_row(split: BandSplit, apart: float = math.nan) -> dict[str, Any]:
    """Return a band split as a row: no figures where it cannot be separated, but its reason."""
    without = {} if split.separable else dict.fromkeys(SPLIT, math.nan)
    return {**split._asdict(), **without, "separable": split.separable, "reason": split.reason, "methods_apart": apart}


def filter_effect(reading: ChannelReading, filter_: Filter) -> dict[str, Any]:
    """Return what a filter did to the peaks and widths of a channel, and what it does to a half-sine as wide."""
    widths = [pulse.width for pulse in reading.unfiltered if pulse.width > 0.0]
    pairs = list(zip(reading.unfiltered, reading.pulses, strict=False))
    same = pairs if len(reading.unfiltered) == len(reading.pulses) else []
    effect = effect_on_half_sine(filter_, min(widths) / HALF_SINE_WIDTH) if widths else None
    return {
        "name": str(filter_),
        "cutoff": filter_.half_power(reading.channel.step),
        "peak_left": [after.peak / before.peak for before, after in same],
        "width_left": [after.width / before.width for before, after in same],
        "half_sine_peak_left": None if effect is None else effect.peak,
        "half_sine_width_left": None if effect is None else effect.width,
        "half_sine_velocity_change_left": None if effect is None else effect.velocity_change,
        "effect": [pulse.smooth.through(filter_)._asdict() for pulse in reading.unfiltered],
    }


def campaign_row(campaign: Campaign) -> dict[str, Any]:
    """Return all blows of a channel together as a row."""
    return {
        "channel": campaign.channel,
        **{name: value._asdict() for name, value in campaign.statistics.items()},
        "trend": {name: value._asdict() for name, value in campaign.trends.items()},
        "outliers": [
            {"file": one.path, **{k: v for k, v in one._asdict().items() if k != "path"}} for one in campaign.outliers
        ],
        "left_out": [
            {"file": path, "figures": list(figures), "reason": reason} for path, figures, reason in campaign.left_out
        ],
    }
