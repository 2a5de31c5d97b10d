"""How well planted blows are found and measured: the table of docs/benchmarks.md (``make bench`` writes it)."""

import tempfile
from collections import defaultdict
from pathlib import Path

import numpy as np
import planted
import timing

from strikewave.records import Request, read_file, read_record

SEED, COUNT = 20190321, 200
G = 9.80665
FIGURES = ("peak", "rise", "width", "velocity_change")
BANDS = ((5, 15), (15, 25), (25, 40), (40, 60))
"""Decibels of signal over noise."""


class Tally:
    """What was planted, found, and missed by how much, in one group of records."""

    def __init__(self):
        self.records = self.planted = self.found = self.false = self.clipped = self.flagged = self.wrongly = 0
        self.errors = defaultdict(list)

    def spread(self, name):
        """Return median and scaled median deviation of the relative errors of a figure."""
        errors = np.array(self.errors[name])
        errors = errors[np.isfinite(errors)]
        if not errors.size:
            return np.nan, np.nan
        middle = np.median(errors)
        return middle, 1.4826 * np.median(np.abs(errors - middle))


def measure(record, path):
    """Write a record, read it back, and return its reading."""
    planted.write(record, path)
    return read_file(read_record(path), {}, Request()).channels[0]


def tallied(seed=SEED, count=COUNT):
    """Return a tally a band of decibels, without and with ringing."""
    rng = np.random.default_rng(seed)
    tallies = defaultdict(Tally)
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(count):
            record = planted.plant(rng)
            reading = measure(record, Path(folder) / "record.csv")
            band = next(b for b in BANDS if b[0] <= record.signal_to_noise < b[1])
            _compare(tallies[band, record.ringing > 0.0], record, reading)
    return tallies


def _compare(tally, record, reading):
    tally.records += 1
    tally.planted += len(record.blows)
    said = any(finding.code == "clipped" for finding in reading.findings)
    tally.clipped += record.clipped
    tally.flagged += record.clipped and said
    tally.wrongly += said and not record.clipped
    left = list(reading.pulses)
    for blow in record.blows:
        middle = blow.begin + 0.5 * blow.duration
        near = [pulse for pulse in left if abs(pulse.time - middle) < 0.6 * blow.duration]
        if not near:
            continue
        pulse = near[0]
        left.remove(pulse)
        tally.found += 1
        if record.clipped:
            continue
        truth = record.figures(blow)
        for name in FIGURES:
            scale = G if name in ("peak", "velocity_change") else 1.0
            tally.errors[name].append(getattr(pulse, name) / (scale * truth[name]) - 1.0)
        tally.errors["smooth peak"].append(pulse.smooth.peak / (G * truth["peak"]) - 1.0)
        tally.errors["smooth width"].append(pulse.smooth.width() / truth["width"] - 1.0)
        tally.errors["time"].append((pulse.time - truth["time"]) / blow.duration)
        tally.errors["ringing frequency"].append(pulse.ringing_frequency / record.ringing_frequency - 1.0)
    tally.false += len(left)


def rows(tallies):
    """Return the rows of the table."""
    lines = []
    for (band, ringing), tally in sorted(tallies.items()):
        cells = [
            f"{band[0]}-{band[1]} dB" + (", ringing" if ringing else ""),
            str(tally.records),
            f"{tally.found} of {tally.planted}",
            str(tally.false),
            f"{tally.flagged} of {tally.clipped}" + (f", {tally.wrongly} wrongly" if tally.wrongly else ""),
        ]
        for name in (*FIGURES, "time", "smooth peak", "smooth width", "ringing frequency"):
            bias, spread = tally.spread(name)
            cells.append("-" if np.isnan(bias) else f"{100 * bias:+.1f} ± {100 * spread:.1f}")
        lines.append(cells)
    return lines


HEAD = (
    "signal over noise", "records", "blows found", "false ones", "clipping reported", "peak",
    "rise time 10-90 %", "pulse width at 10 %", "velocity change", "time (of duration)", "smooth peak", "smooth width", "ringing frequency",
)  # fmt: skip


def table():
    """Return the table in markdown."""
    return timing.table(HEAD, rows(tallied()))


if __name__ == "__main__":
    print(table())
