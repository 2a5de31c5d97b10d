"""Hum and noise beside a response, and too little before the blow to know them."""

from __future__ import annotations

from strikewave.base.constants import COVERAGE
from strikewave.base.percents import percent
from strikewave.records.health.noise import NOTED_HUM, NOTED_NOISE, hum_beside
from strikewave.records.health.response.examined import JUMPING, ExaminedResponse, finding
from strikewave.records.health_notice import HARMED, HealthNotice
from strikewave.records.modes import FEWEST


def hum(record: ExaminedResponse) -> list[HealthNotice]:
    """Find a line of the mains beside the response."""
    spans = [(record.blows[one.blow - 1].begin, one.begin + one.duration) for one in record.responses]
    found = hum_beside(record.values, record.step, record.start, spans)
    if found is None or found[1] < NOTED_HUM * record.peak:
        return []
    frequency, amplitude = found
    message = f"hum of {frequency:g} Hz, {percent(amplitude / record.peak)} of the peak"
    return [finding("hum", message, amplitude, record.moved_by(amplitude), signed=False)]


def noise(record: ExaminedResponse) -> list[HealthNotice]:
    """Find noise of any colour, or motion before the blow, that moves the figures."""
    reach = COVERAGE * record.noise
    effects = record.moved_by(reach)
    if max(effects["peak"], effects["rms"]) < NOTED_NOISE and not any(effects[name] > HARMED for name in JUMPING):
        return []
    message = f"before the blow the channel scatters by {record.text(record.noise)}"
    return [finding("noise", message, record.noise, effects, signed=False)]


def short_before(record: ExaminedResponse) -> list[HealthNotice]:
    """Find that too little lies before the first blow to know the zero and the noise."""
    if record.first >= FEWEST:
        return []
    message = (
        f"only {record.first} samples lie before the first blow: the zero is the median of the whole record, and what "
        "drift, hum and noise do to the figures cannot be known"
    )
    return [HealthNotice("short-pretrigger", message, record.first, severity="good", end=record.blows[0].begin)]
