"""Faults planted in copies of measured records of one test, and whether each copy is judged right.

The records that are good as they stand are the truth of the copies: their figures must not change, whatever a fault
does to a sibling.
"""

import csv
import dataclasses
from pathlib import Path
from typing import NamedTuple

import numpy as np
from planted_judge import LIMIT, G, kept

from strikewave.records import Record, Request, read_file, read_record
from strikewave.records.campaign import compare, summed

FIGURES = ("peak", "rise", "width", "velocity_change")
UNCHANGED = 0.002
"""Share by which a figure of a good record may differ from an earlier one."""
SEED = 20190321


def records_of(folder, channel, unit):
    """Return the records of a folder, one channel of each, in the unit of the file."""
    found = []
    for path in sorted(Path(folder).iterdir()):
        try:
            found.append(read_record(str(path)).only([channel]))
        except Exception:  # not a record: a licence, a note
            continue
    return [dataclasses.replace(r, channels=(dataclasses.replace(r.channels[0], unit=unit),)) for r in found]


def readings_of(records):
    """Return all records, read and judged against one another."""
    return compare([read_file(record, {}, Request()) for record in records])


def figures(readings):
    """Return a row of status, blows and figures of the first blow for each record, SI."""
    rows = []
    for file in readings:
        pulses = file.channels[0].pulses
        row = {"file": Path(file.path).name, "status": file.status, "blows": len(pulses)}
        for name in FIGURES:
            row[name] = float(getattr(pulses[0], name)) if pulses else float("nan")
        rows.append(row)
    return rows


def write_figures(rows, path):
    """Write such rows."""
    with Path(path).open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def changed(rows, path):
    """Return the largest relative change of each figure of the good records against written ones, and the lines."""
    with Path(path).open(encoding="utf-8") as file:
        earlier = {row["file"]: row for row in csv.DictReader(file)}
    most, lines = dict.fromkeys(FIGURES, 0.0), []
    for row in rows:
        old = earlier.get(row["file"])
        if old is None:
            continue
        text = f"{row['file']}: {old['status']} {old['blows']} blows, now {row['status']} {row['blows']}"
        if old["status"] == "good":
            for name in FIGURES:
                before, now = float(old[name]), row[name]
                share = abs(now / before - 1.0)
                most[name] = max(most[name], share if np.isfinite(share) else np.inf)
                text += f"; {name} {before:.6g} -> {now:.6g} ({now / before - 1.0:+.2%})"
        lines.append(text)
    return most, lines


class Copy(NamedTuple):
    """A copy of a record with a fault, how many blows it holds, and whether its figures are wrong."""

    fault: str
    record: Record
    blows: int = 1
    wrong: bool = False


def quiet(record, blow):
    """Return the noise long before a blow, clear of its foot, forth and back again, as long as the record is."""
    channel = record.channels[0]
    last = max(round(0.6 * (blow.begin - channel.start) / channel.step), 64)
    head = channel.values[: min(last, channel.values.size)]
    return np.pad(head, (0, channel.values.size - head.size), mode="reflect")


def copies(record, blow, rng):
    """Return a copy of a record for each fault."""
    channel = record.channels[0]
    values, time = channel.values, channel.step * np.arange(channel.values.size)

    def copy(fault, values, blows=1, wrong=False):
        changed = dataclasses.replace(channel, values=np.asarray(values, dtype=float))
        path = Path(record.path).with_stem(f"{Path(record.path).stem} {fault}")
        return Copy(fault, dataclasses.replace(record, path=str(path), channels=(changed,)), blows, wrong)

    empty = quiet(record, blow)
    blips = np.zeros_like(values)
    for at in np.arange(rng.uniform(0, 1 / 60), time[-1], 1 / 60):
        blips += np.exp(-0.5 * ((time - at) / 0.4e-3) ** 2)
    found = [
        copy("no blow", empty, 0),
        copy("mains blips of 1 g", empty + blips, 0),
        copy("mains blips of 0.2 % of the peak", empty + 0.002 * abs(blow.peak) / G * blips, 0),
        copy("hum of 1 g alone", empty + np.sin(2 * np.pi * 60 * time), 0),
        copy("half gain", 0.5 * values, wrong=True),
        copy("other polarity", -values, wrong=True),
    ]
    begin, end = (round((t - channel.start) / channel.step) for t in (blow.begin, blow.end))
    pulse = (values - blow.offset / G)[max(begin - 1, 0) : end + 2]
    for share in (0.15, 0.3):
        for gap in (0.5, 1.5, 4.0):
            more = values.copy()
            room = more[end + round(gap * blow.width / channel.step) :][: pulse.size]
            room += share * pulse[: room.size]
            found.append(copy(f"rebound of {share:.0%}, {gap:g} widths after", more))
    return found


def judged(records):
    """Yield (fault, file, right, why) for each fault planted in each good record, among its siblings as they are."""
    rng = np.random.default_rng(SEED)
    plain = [read_file(record, {}, Request()) for record in records]
    together = compare(plain)
    good = [k for k, file in enumerate(together) if file.status == "good" and len(file.channels[0].pulses) == 1]
    for k in good:
        blow = plain[k].channels[0].pulses[0]
        for copy in copies(records[k], blow, rng):
            reading = read_file(copy.record, {}, Request())
            files = compare([reading if k == j else file for j, file in enumerate(plain)])
            why = reasons(files, k, good, blow, copy.blows, copy.wrong)
            yield copy.fault, Path(records[k].path).name, not why, "; ".join(why)


def reasons(files, k, good, blow, count, wrong):
    """Return in what a copy, its siblings or their mean are judged wrong."""
    [one] = files[k].channels
    stated = kept(one, "peak")
    why = []
    if wrong:
        if files[k].status == "good" or stated:
            why.append(f"status {files[k].status}, peak stated" if stated else "status good")
    elif len(stated) != count:
        why.append(
            f"{len(stated)} blows stated of {count} ({len(one.pulses)} reported, {files[k].status}: {', '.join(f.code for f in files[k].all_findings)})"
        )
    elif count and abs(stated[0] / blow.peak - 1.0) > LIMIT:
        why.append(f"peak off by {stated[0] / blow.peak - 1.0:+.1%}")
    harmed = [Path(files[j].path).name for j in good if j != k and files[j].status != "good"]
    if harmed:
        why.append(f"siblings judged {', '.join(harmed)}")
    campaign = summed(files)
    rest = [files[j].channels[0].pulses[0].peak for j in good if j != k or (count and not wrong)]
    said = campaign.statistics.get("peak") if campaign else None
    if said is None or abs(said.mean / float(np.mean(rest)) - 1.0) > 0.01:
        why.append(f"mean off by {said.mean / float(np.mean(rest)) - 1.0:+.1%}" if said else "no mean")
    return why


def several(records):
    """Yield the same for several faults in one campaign: a third of the files emptied, with blips."""
    rng = np.random.default_rng(SEED + 1)
    plain = [read_file(record, {}, Request()) for record in records]
    good = [k for k, f in enumerate(compare(plain)) if f.status == "good" and len(f.channels[0].pulses) == 1]
    for share, name in ((0.2, "a fifth"), (0.4, "two fifths")) if len(good) > 4 else ():
        chosen = sorted(int(k) for k in rng.choice(good, max(1, round(share * len(good))), replace=False))
        for place, fault in ((1, "mains blips"), (4, "half gain")):
            files = list(plain)
            for k in chosen:
                copy = copies(records[k], plain[k].channels[0].pulses[0], rng)[place]
                files[k] = read_file(copy.record, {}, Request())
            files = compare(files)
            why = [f"{Path(files[k].path).name} stated" for k in chosen if kept(files[k].channels[0], "peak")]
            rest = [k for k in good if k not in chosen]
            why += [f"{Path(files[k].path).name} {files[k].status}" for k in rest if files[k].status != "good"]
            said = summed(files).statistics.get("peak")
            true = float(np.mean([files[k].channels[0].pulses[0].peak for k in rest]))
            if said is None or abs(said.mean / true - 1.0) > 0.01:
                why.append(f"mean off by {said.mean / true - 1.0:+.1%}" if said else "no mean")
            yield f"{fault} in {name}", f"{len(chosen)} of {len(good)}", not why, "; ".join(why)


def report(folder, channel, unit, earlier=None, output=None):
    """Return all of it as lines of markdown."""
    records = records_of(folder, channel, unit)
    rows = figures(readings_of(records))
    lines = [f"{len(records)} records, channel {channel}, {sum(r['status'] == 'good' for r in rows)} good.", ""]
    if output:
        write_figures(rows, output)
    if earlier:
        most, told = changed(rows, earlier)
        lines += [f"- {line}" for line in told]
        lines += ["", "Largest change of a good record: " + ", ".join(f"{n} {v:.3%}" for n, v in most.items()) + "."]
        lines += ["Unchanged within 0.2 %." if max(most.values()) <= UNCHANGED else "CHANGED by more than 0.2 %.", ""]
    else:
        lines += [
            f"- {r['file']}: {r['status']}, {r['blows']} blows, " + ", ".join(f"{n} {r[n]:.6g}" for n in FIGURES)
            for r in rows
        ] + [""]
    tried = [*judged(records), *several(records)]
    lines += ["| planted | judged right | otherwise |", "| --- | --- | --- |"]
    for fault in dict.fromkeys(fault for fault, *_ in tried):
        these = [(file, right, why) for name, file, right, why in tried if name == fault]
        wrong = [f"{file}: {why}" for file, right, why in these if not right]
        lines.append(f"| {fault} | {len(these) - len(wrong)} of {len(these)} | {'; '.join(wrong[:3]) or '-'} |")
    lines += ["", f"{sum(right for _, _, right, _ in tried)} of {len(tried)} judged right."]
    return lines
