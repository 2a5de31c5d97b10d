"""Two sensors on one object as a chapter: table and pictures."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from strikewave.analyses.record.paired import RecordPair
from strikewave.analyses.record.tables import amount, plus_minus
from strikewave.base.shock_quantities import BANDWIDTH, MICROSECONDS
from strikewave.base.texts import first_few, percent
from strikewave.records.thresholds import OfTwoSensors
from strikewave.reporting import faces
from strikewave.reporting.numbers import axis_unit, doubted, listed
from strikewave.reporting.parts import NONE, Cell, Part, Picture, Section, Table

MOST_ROWS = 60
"""Files of the table; pairs.csv has all."""
LEFT_OUT_FIRST = ("leads", "common peak", "differential peak", "alike up to")
"""Columns that a narrow screen leaves out."""
ANSWERS = {"yes": "yes", "no": "no", "cannot-tell": "undetermined"}
"""Whether two sensors move as one rigid body, in words."""

MOVE = {
    "yes": "{both} move as one rigid body",
    "no": "{both} do not move as one rigid body",
    "cannot-tell": "Whether {both} move as one rigid body is undetermined",
}


def pair_table(pairs: Sequence[RecordPair], why: bool = False) -> Table:
    """Return what two channels of each file do together, and in words why that is one rigid body or not."""
    rows: list[list[Cell]] = []
    size, delay_unit = axis_unit(*MICROSECONDS.units)
    for one in pairs[:MOST_ROWS]:
        found, unit = one.found, "" if one.first is None else one.first.channel.unit
        if found is None:
            rows.append([Path(one.file).name, ANSWERS[one.one_body], *[NONE] * 6, *([one.why] if why else [])])
            continue
        alike = math.nan if found.transfer is None else found.transfer.alike_to
        rows.append(
            [
                Path(one.file).name,
                ANSWERS[one.one_body],
                NONE
                if math.isnan(found.delay)
                else f"{' ± '.join(doubted(found.delay / size, found.delay_uncertainty / size))} {delay_unit}",
                one.leads or ("neither" if math.isfinite(found.delay) else NONE),
                NONE if math.isnan(found.gain) else " ± ".join(doubted(found.gain, found.gain_uncertainty)),
                "not separable"
                if math.isnan(found.rigid_peak)
                else plus_minus("peak", unit, found.rigid_peak, found.common_uncertainty),
                amount("peak", unit, found.differential_peak),
                faces.amount(BANDWIDTH, alike) if math.isfinite(alike) else NONE,
                *([one.why] if why else []),
            ]
        )
    first = next((one for one in pairs if one.first is not None and one.second is not None), None)
    names = "" if first is None else f": {_name(first, 0)} and {_name(first, 1)}"
    heads = ["file", "one rigid body", "delay of the second", "leads", "gain, second over first", "common peak"]
    heads += ["differential peak", "alike up to", *(["why"] if why else [])]
    return Table(f"Two sensors on one object{names}", heads, rows, empty="No file with both channels.")


def _name(pair: RecordPair, place: int) -> str:
    reading = (pair.first, pair.second)[place]
    return "" if reading is None else reading.channel.name


def pair_words(pairs: Sequence[RecordPair]) -> str:
    """Say whether both sensors move as one rigid body, and why where there is one answer for all files."""
    first = next((one for one in pairs if one.first is not None and one.second is not None), None)
    if first is None:
        return "No file has both channels of the pair."
    both = f"{_name(first, 0)} and {_name(first, 1)}"
    counts = Counter(one.one_body for one in pairs)
    if len(counts) > 1:
        named = [f"in {counts[answer]} {words}" for answer, words in ANSWERS.items() if counts[answer]]
        return f"{both} as one rigid body: {listed(named)} of {len(pairs)} files."
    reasons = {one.why for one in pairs}
    why = f": {reasons.pop()}" if len(reasons) == 1 else f", in each of {len(pairs)} files"
    return MOVE[pairs[0].one_body].format(both=both) + f"{why}."


def pair_card(pairs: Sequence[RecordPair]) -> tuple[str, str]:
    """Return the answer as a key number: of one file in a word, of several in how many they move so."""
    if len(pairs) == 1:
        return "one rigid body", ANSWERS[pairs[0].one_body]
    return "one rigid body, of all files", f"{sum(one.one_body == 'yes' for one in pairs)} of {len(pairs)}"


def pair_reasons(pairs: Sequence[RecordPair]) -> list[str]:
    """Return why, a line a file; files with the same answer and reason together."""
    groups: dict[tuple[str, str], list[str]] = {}
    for one in pairs:
        groups.setdefault((one.one_body, one.why), []).append(Path(one.file).name)
    words = {"yes": "one rigid body", "no": "not one rigid body", "cannot-tell": "undetermined"}
    return [f"{first_few(files, 1)}: {words[answer]}: {why}" for (answer, why), files in groups.items()]


def pair_section(pairs: Sequence[RecordPair]) -> Section:
    """Return table, reasons and pictures, those of the first file that has them."""
    from strikewave.analyses.record.figures.pairs import pair_figure, transfer_figure

    calibrated = percent(OfTwoSensors.CALIBRATED, 0)
    text = (
        "Common motion is half the sum of both channels, differential motion half of second less first. The delay is "
        "that of the largest cross-correlation, the gain that of the second over the first so shifted, each ± a "
        "standard uncertainty. Two sensors move as one rigid body where the gain is 1 and the delay 0 within twice "
        f"their uncertainty, {calibrated} for calibration and a share of a sample included. The peak of "
        "the common motion is that without ringing where it can be separated; what the differential motion does in its "
        "band is in its uncertainty. pairs.csv and transfer.csv have all figures."
    )
    parts: list[Part] = [pair_table(pairs, why=True)]
    drawn = next((one for one in pairs if one.found is not None and one.found.transfer is not None), None)
    if drawn is not None and drawn.found is not None and drawn.found.transfer is not None:
        transfer = drawn.found.transfer
        name = Path(drawn.file).name
        words = f"{name}: both channels around the largest blow, and what they share."
        parts.append(Picture(pair_figure(drawn), words))
        words = f"{name}: transfer function, mean of {transfer.averages} spectra, {transfer.resolution:.3g}\xa0Hz wide"
        if math.isfinite(transfer.trusted[0]):
            low, high = (faces.amount(BANDWIDTH, f) for f in transfer.trusted)
            words += f"; shaded from {low} to {high}, where it is known within 10 % and stands above the noise."
        else:
            words += "; nowhere known within 10 %."
        parts.append(Picture(transfer_figure(transfer), words))
    return Section("Two sensors", text, parts)
