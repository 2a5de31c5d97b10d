"""Rigid and wave parts of single channels as a chapter: joint fit and band split beside one another."""

from __future__ import annotations

import math
from collections.abc import Sequence

from strikewave.analyses.record.tables import Names, percent, plus_minus, rows_of
from strikewave.records.measuring import RecordedPulse
from strikewave.records.reading import FileReading
from strikewave.reporting.parts import NONE, Cell, Section, Table, written

MOST_ROWS = 60
"""Blows of the table; pulses.csv has all."""


def rigid_sections(files: Sequence[FileReading], names: Names) -> list[Section]:
    """Return what of the blows is rigid, by two methods; nothing where no blow rings."""
    found = [
        (names[file.path], reading, k, pulse)
        for file, reading in rows_of(files)
        for k, pulse in enumerate(reading.pulses, 1)
        if pulse.rigid is not None or pulse.split is not None
    ]
    if not found:
        return []
    cells = [[name, reading.channel.name, k, *_cells(pulse, reading.channel.unit)] for name, reading, k, pulse in found]
    text = (
        "Two ways to the pulse without its wave part. The joint fit takes pulse and one mode together. The band split "
        "takes a low-pass between the band of the pulse and the lowest mode, where its costs are least, and corrects "
        "the peak by what it takes off ideal pulses as wide. Costs are over the peak: how differently these pulses "
        "come out, what is left of the wave part, and what the lowest mode does in the pulse's own band. Apart is the "
        "difference of both peaks over its standard uncertainty: beyond 2 one of them is wrong. Where costs come to "
        "more than 10 % of the peak, the bands of pulse and wave part overlap, and they cannot be separated this way."
    )
    if len(cells) > MOST_ROWS:
        text += f" The first {MOST_ROWS} of {len(cells)} blows are listed."
    heads = ["file", "channel", "#", "joint fit", "model", "band split", "apart", "cutoff (kHz)", "lowest mode (kHz)"]
    heads += ["filter takes", "costs: shape", "wave left", "elastic", "energy of the wave part"]
    table = Table("Peaks without the wave part, ± a standard uncertainty", heads, cells[:MOST_ROWS])
    return [Section("Rigid and wave parts", text, [table])]


def _cells(pulse: RecordedPulse, unit: str) -> list[Cell]:
    rigid, split = pulse.rigid, pulse.split
    joint = NONE if rigid is None else plus_minus("peak", unit, rigid.peak, rigid.peak_uncertainty)
    model = NONE if rigid is None else rigid.model
    if split is None:
        return [joint, model, *[NONE] * 9]
    apart = pulse.methods_apart
    return [
        joint,
        model,
        plus_minus("peak", unit, split.peak, split.peak_uncertainty) if split.separable else "not separable",
        NONE if math.isnan(apart) else f"{apart:.2g}",
        *(written(frequency / 1e3, 3) for frequency in (split.cutoff, split.lowest_mode)),
        *(percent(share, 2) for share in (split.loss, split.loss_uncertainty, split.leak, split.elastic)),
        percent(split.wave_energy, 2),
    ]
