"""What is reported of planted response channels against their truth: silent misses, false alarms.

A figure of a response is stated where no finding harms it and none of the channel is bad. Peak, duration and root mean
square are missed beyond 5 %; a delay beyond 5 % of a swing of the strongest mode; frequency and damping of the strongest
mode beyond 5 % and three times their stated uncertainty. What is wrong with the base is judged by planted_judge.
"""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from planted import boards

from strikewave.records import Channel, Record, Request, read_file

G = 9.80665
LIMIT = 0.05
NAMES = {
    "board-clipped": {"clipped"},
    "board-saturated": {"flat-top", "clipped"},
    "board-slewing": {"slew-rate", "flat-top"},
    "board-coarse": {"coarse"},
    "board-offset": {"not-settled"},
    "board-drift": {"drift", "zero-shift"},
    "board-thermal": {"drift", "zero-shift", "ac-coupling"},
    "board-shift": {"zero-shift"},
    "board-ac-coupling": {"ac-coupling"},
    "board-hum": {"hum", "noise", "drift"},
    "board-noise": {"noise"},
    "board-dead": {"dead", "no-response"},
    "board-few-samples": {"few-samples", "alias"},
    "board-cut": {"cut"},
    "board-cut-train": {"cut"},
    "board-short": {"short-pretrigger"},
    "board-spike": {"spike"},
}
"""Findings that name the fault of a class."""


@dataclass
class BoardVerdict:
    """What became of one draw."""

    kind: str
    seed: int
    status: str
    codes: tuple
    errors: dict
    silent: list = field(default_factory=list)
    withheld: list = field(default_factory=list)
    alarms: list = field(default_factory=list)
    named: bool = False


def read(board):
    """Return the readings of base and board."""
    step, start = board.draft.setting.step, board.draft.begin_time
    channels = Channel("base", board.base, step, start, "g"), Channel("board", board.draft.values, step, start, "g")
    return read_file(Record("a.csv", "text", channels), {}, Request(base="base")).channels


def judged(board):
    """Return the verdict on a draw."""
    base, reading = read(board)
    codes = tuple(f"{f.code}:{f.severity}" for f in reading.findings)
    harmed = {name for f in reading.findings for name in f.harms}
    if reading.status == "bad":
        harmed |= {"peak", "delay", "duration", "rms", "frequency", "damping"}
    found = BoardVerdict(board.kind, board.seed, reading.status, codes, {})
    found.named = bool({f.code for f in reading.findings} & NAMES.get(board.kind, set()))
    if len(base.pulses) != len(board.blows) or len(reading.responses) != len(board.blows):
        if reading.status == "good":
            found.silent.append(f"{len(base.pulses)} blows of {len(board.blows)}")
        return found
    period = 1.0 / board.modes[0][0]
    for answer, blow, one in zip(board.answers, board.blows, reading.responses, strict=True):
        swing = 1.0 / one.modes[0].frequency if one.modes else period
        errors = {
            "peak": abs(one.peak) / G / answer.peak - 1.0,
            "delay": (one.delay - (answer.time - blow[1])) / swing,
            "duration": one.duration / answer.duration - 1.0,
            "rms": one.rms / G / answer.rms - 1.0,
        }
        missed = {name for name, error in errors.items() if abs(error) > LIMIT}
        for mode in one.modes[:1]:
            f, d, _ = min(board.modes, key=lambda m: abs(m[0] - mode.frequency))
            errors |= {"frequency": mode.frequency / f - 1.0, "damping": mode.damping / d - 1.0}
            doubts = {"frequency": mode.frequency_uncertainty / f, "damping": mode.damping_uncertainty / d}
            missed |= {name for name, doubt in doubts.items() if abs(errors[name]) > max(LIMIT, 3.0 * doubt)}
        for name, error in errors.items():
            found.errors.setdefault(name, []).append(error)
            if name in missed and name not in harmed:
                found.silent.append(f"{name} {error:+.1%}")
            if name not in missed and name in harmed:
                found.withheld.append(name)
    if board.kind.startswith("clean"):
        found.alarms = [f"{f.code}: {f.message}" for f in reading.findings if f.severity != "good" and f.code != "base"]
    return found


def judged_class(kind, count, first=0):
    """Return the verdicts on so many draws of a class."""
    return [judged(boards.draw(kind, first + k)) for k in range(count)]


INTRODUCTION = (
    "Boards made by benchmarks/planted/boards.py: one to three modes, driven by one blow of their base (or five, four), "
    "integrated by scipy on a grid twelve times as fine as the record; noise 40 to 75 dB below, white, pink or "
    "autoregressive, 12 to 16 bits; then one fault a class, with a strength from hardly to very harmful. A silent miss is "
    "a draw in which a figure is stated that is off: peak, duration, RMS by more than 5 %, the delay by 5 % of a swing, "
    "frequency and damping of the strongest mode by 5 % and three times their stated uncertainty. Fault named: the share "
    "of draws with a finding of its kind, however weak the fault. A false alarm is a finding on a clean board that makes "
    "it suspect or bad. Withheld though right: draws in which a figure that is not off is harmed by a finding. "
    "`python scripts/validate/response_channels.py` draws them."
)


def section(count=100):
    """Return the lines of the page of benchmarks."""
    return [INTRODUCTION, "", *table(list(boards.CLASSES), count)]


def table(kinds, count, first=0):
    """Return a line a class: silent misses, by figure; draws on which the fault is named; false alarms."""
    lines = [
        "| class | draws | silent misses | of which | fault named | suspect or bad | false alarms | withheld though right |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for kind in kinds:
        found = judged_class(kind, count, first)
        silent = [v for v in found if v.silent]
        of = Counter(text.split()[0] for v in silent for text in v.silent)
        withheld = Counter(name for v in found for name in set(v.withheld))
        lines.append(
            f"| {kind} | {count} | {len(silent)} ({len(silent) / count:.0%}) | {', '.join(f'{k} {n}' for k, n in of.most_common()) or '-'} "
            f"| {np.mean([v.named for v in found]):.0%} | {np.mean([v.status != 'good' for v in found]):.0%} "
            f"| {sum(bool(v.alarms) for v in found)} | {', '.join(f'{k} {n}' for k, n in withheld.most_common()) or '-'} |"
        )
    return lines
