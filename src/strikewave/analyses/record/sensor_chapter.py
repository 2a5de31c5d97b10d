"""The blows of records on a sensor as a chapter."""

from __future__ import annotations

import math

from strikewave.analyses.record.sensor_trials import SensorTrials, lacking
from strikewave.analyses.record.tables import Names, amount, percent
from strikewave.base.shock_quantities import ACCELERATION, BANDWIDTH, KILOHERTZ, MICROSECONDS
from strikewave.reporting import faces
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import NONE, Cell, Section, Table

MOST_ROWS = 60
"""Blows of the table; sensor.csv has all."""


def sensor_table(found: SensorTrials, names: Names) -> Table:
    """Return what is left of each blow."""
    rows: list[list[Cell]] = []
    for blow in found.blows[:MOST_ROWS]:
        trial = blow.trial
        used = percent(trial.range_used) if trial.range_used > 0.0 else NONE
        clipped = faces.amount(MICROSECONDS, trial.time_clipped, digits=3)
        rows.append(
            [
                *(names[blow.file], blow.channel, str(blow.blow)),
                amount("peak", "m/s^2", trial.peak) + (" ?" if blow.doubted else ""),
                *(percent(trial.peak_left), percent(trial.width_left), used, clipped),
                *(percent(trial.ringing, 2), trial.verdict),
            ]
        )
    heads = ["file", "channel", "#", "highest value", "peak left", "width left", "of its range", "beyond it", "ringing"]
    many = f", the first {MOST_ROWS} of {len(found.blows)} blows" if len(found.blows) > MOST_ROWS else ""
    return Table(f"On {found.called}{many}", [*heads, "verdict"], rows, "No blow could be tried.")


MORE_COLUMNS = ("channel", "beyond it", "ringing")
"""Heads that a narrow screen leaves out first."""


def sensor_section(found: SensorTrials, names: Names) -> Section:
    """Return the chapter: the sensor, how it was tried, and what is left of each blow."""
    sensor, recorder, model = found.stated.sensor, found.stated.recorder, found.stated.model
    facts = [f"range {faces.amount(ACCELERATION, sensor.range)}"] if math.isfinite(sensor.range) else []
    facts += [
        f"resonance {faces.amount(KILOHERTZ, sensor.resonance)}, magnified {sensor.quality:.3g} times"
    ] * math.isfinite(sensor.resonance)
    lowest = f"lowest resonance {faces.amount(BANDWIDTH, found.resonance)} on its mounting"
    facts += [f"no {key} stated" for key in lacking(found.stated)]
    facts.append("directly mounted" if sensor.mounting.direct else lowest)
    if math.isfinite(recorder.sampling_rate):
        facts.append(f"recorded at {faces.amount(KILOHERTZ, recorder.sampling_rate)}")
    if math.isfinite(recorder.cutoff):
        facts.append(f"low-pass of {recorder.order} poles at {faces.amount(KILOHERTZ, recorder.cutoff)}")
    band = faces.amount(BANDWIDTH, found.band)
    origin = "" if model is None else f" {model.name}: {model.status}; {model.source}. {model.note}"
    text = (
        f"{found.sentence()} Sensor: {listed(facts)}.{origin} Each blow is taken as the motion of "
        f"the surface, up to {band}, that the records hold; its highest value has noise, and what lies between its "
        "samples, in it, and may be above its measured peak. Left is what would be read, over what is recorded. "
        "Ringing is the largest departure of the sensing element from the motion, over the peak, and has the lag of a "
        "mounting in it. A peak or width more than 5 % off is not taken. sensor.csv has every blow."
    )
    if any(blow.doubted for blow in found.blows):
        text += " ? a peak that a finding of the record harms."
    return Section("On another sensor", text, [sensor_table(found, names)])
