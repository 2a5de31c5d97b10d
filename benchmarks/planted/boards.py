"""Boards that answer the blows of their base: integrated here, with what is known of them, and what can be wrong.

A board is a sum of modes: its absolute acceleration is that of the base, and of each oscillator on it, by their shares.
The oscillators are integrated on a grid many times as fine as the record (first-order hold, scipy).
"""

import zlib
from dataclasses import dataclass, field

import numpy as np
from scipy.signal import bessel, cont2discrete, lfilter, sosfilt

from . import faults
from .classes import log_uniform
from .drafts import Blow, Draft, Setting, quantised
from .noises import COLOURS, noise
from .shapes import draw_shape

SMOOTH = ("half-sine", "haversine", "versed-sine", "leaning", "gamma-like", "contact")
MOST = 30_000
"""Samples of a record."""
FINE = 12
"""Steps of the fine grid in one of the record."""


@dataclass
class Answer:
    """What a board does after one blow: absolute maximum, when, its time above a third, root mean square over that."""

    peak: float
    time: float
    duration: float
    rms: float
    begin: float
    end: float


@dataclass
class Board:
    """A base and a board of one record.

    Attributes
    ----------
    draft : Draft
        The board; its blows are what the faults refer to: the maxima.
    base : ndarray
        The base as it is recorded.
    blows : list of (begin, time, end, peak)
        Of the base.
    answers : list of Answer
        After each blow.
    modes : list of (frequency, damping, share)
        Damped frequency, Hz.
    """

    kind: str
    seed: int
    draft: Draft
    base: np.ndarray
    blows: list
    answers: list
    modes: list
    faults: dict = field(default_factory=dict)


def oscillator(base, step, frequency, damping):
    """Return the absolute acceleration of an oscillator whose base moves so: w^2 z + 2 d w z' of the relative motion."""
    omega = 2.0 * np.pi * frequency
    system = ([[0.0, 1.0], [-(omega**2), -2.0 * damping * omega]], [[0.0], [-1.0]], [[-(omega**2), -2.0 * damping * omega]], [[0.0]])  # fmt: skip
    a, b, c, d, _ = cont2discrete(tuple(np.array(m) for m in system), step, method="foh")
    poles = np.poly(a)
    zeros = np.poly(a - b @ c) - poles * (1.0 - d[0, 0])
    return lfilter(zeros, poles, base)


def drawn(
    rng, kind, seed, count=1, per_swing=(14.0, 80.0), before=None, lasts=(1.0, 2.5), ratios=(0.3, 3.0), close=False
):
    """Return a board without noise.

    ``per_swing``: samples of a swing of the fastest mode; ``lasts``: of the time to a twentieth, how much is recorded.
    """
    shape, width, peak = draw_shape(rng, SMOOTH), log_uniform(rng, 50e-6, 10e-3), log_uniform(rng, 50.0, 20_000.0)
    length = width / shape.width
    number = int(rng.integers(1, 4))
    slowest = rng.uniform(*ratios) / (2.0 * length)
    apart = np.concatenate([[1.0], rng.uniform(1.4, 2.6, number - 1)])
    frequencies = slowest * np.cumprod(apart)
    dampings = np.array([log_uniform(rng, 0.005, 0.06) for _ in frequencies])
    shares = np.array([1.0, *(rng.choice([-1, 1]) * rng.uniform(0.15, 0.8) for _ in range(number - 1))])
    step = min(1.0 / frequencies[-1] / rng.uniform(*per_swing), width / 12.0 if per_swing[0] > 10.0 else width / 4.0)
    decay = 3.0 / np.min(2.0 * np.pi * frequencies * dampings)
    step = max(step, count * decay * lasts[1] / MOST)
    if step > min(1.0 / frequencies[-1] / per_swing[0], width / (10.0 if per_swing[0] > 10.0 else 4.0)):
        return drawn(rng, kind, seed, count, per_swing, before, lasts, ratios)
    how = Setting(shape, width, peak, step, 0.0)
    lead = rng.uniform(5.0, 40.0) * length if before is None else before
    interval = length + rng.uniform(*lasts) * decay
    size = int((lead + count * interval) / step)
    fine = step / FINE
    time = fine * np.arange(size * FINE)
    drive, blows = np.zeros(time.size), []
    for k in range(count):
        begin = lead + k * interval
        height = peak * (1.0 + 0.05 * rng.normal() * (count > 1))
        pulse = height * shape.at((time - begin) / length)
        drive += pulse
        blows.append((begin, begin + length, height))
    if per_swing[0] >= 10.0:  # a recorder with a filter
        sections = bessel(8, 2.0 * 0.3 / FINE, output="sos", norm="mag")
        drive = sosfilt(sections, drive)
    tops = [np.argmax(np.where(abs(time - 0.5 * (b + e)) < e - b, drive, 0.0)) for b, e, _ in blows]
    blows = [(begin, float(time[top]), end, height) for (begin, end, height), top in zip(blows, tops, strict=True)]
    whole = (1.0 - np.sum(shares)) * drive
    for frequency, damping, share in zip(frequencies, dampings, shares, strict=True):
        whole = whole + share * oscillator(drive, fine, frequency, damping)
    if rng.random() < 0.5:
        whole = -whole
    answers = []
    for k, (begin, _, _, _) in enumerate(blows):
        first = int(begin / fine)
        last = int(blows[k + 1][0] / fine) if k + 1 < count else time.size
        part = np.abs(whole[first:last])
        high = np.flatnonzero(part >= part.max() / 3.0)
        held = whole[first + high[0] : first + high[-1] + 1]
        answers.append(
            Answer(
                part.max(),
                float(time[first + np.argmax(part)]),
                fine * (high[-1] - high[0]),
                float(np.sqrt(np.mean(held**2))),
                begin,
                last * fine,
            )
        )
    modes = [
        (f * np.sqrt(1.0 - d**2), d, s) for f, d, s in zip(frequencies, dampings, shares, strict=True)
    ]  # fmt: skip
    draft = Draft(how, whole[::FINE].copy())
    draft.blows = [Blow(a.time, a.peak, length, 0.0, a.peak, b[0], b[2]) for a, b in zip(answers, blows, strict=True)]
    return Board(kind, seed, draft, drive[::FINE].copy(), blows, answers, modes)


def recorded(rng, board, decibels=(40.0, 75.0), colour=None, bits=None):
    """Add noise to base and board and round both to the steps of a converter."""
    draft = board.draft
    colour = str(rng.choice(COLOURS, p=[0.6, 0.2, 0.0, 0.2])) if colour is None else colour
    ratio = rng.uniform(*decibels)
    draft.values = draft.values + faults.level(draft) * 10.0 ** (-ratio / 20.0) * noise(rng, draft.values.size, colour)
    draft.values = np.clip(draft.values, -draft.limit, draft.limit)
    span = rng.uniform(1.2, 4.0) * max(faults.level(draft), float(np.max(np.abs(draft.values))))
    draft.values = quantised(draft.values, span, int(rng.integers(12, 17)) if bits is None else bits)
    top = max(abs(blow[3]) for blow in board.blows)
    base = board.base + top * 10.0 ** (-rng.uniform(50.0, 75.0) / 20.0) * rng.normal(size=board.base.size)
    board.base = quantised(base, 2.0 * top, 16)
    board.faults = {**draft.faults, "noise": colour, "decibels": ratio}
    return board


def with_fault(change, decibels=(40.0, 75.0), colour=None, bits=None, **more):
    """Return a class: a board with a fault."""

    def draw(rng, kind, seed):
        board = drawn(rng, kind, seed, **more)
        change(rng, board.draft)
        return recorded(rng, board, decibels, colour if colour is None else str(rng.choice(colour)), bits)

    return draw


def dead(rng, draft):
    """Leave nothing but noise: the cable is off."""
    draft.values = np.zeros_like(draft.values)


def coarse(rng, draft):
    """Round to steps of 2 to 30 % of the peak."""
    step = faults.level(draft) * log_uniform(rng, 0.02, 0.3)
    draft.faults["step"] = step / faults.level(draft)
    draft.values = step * np.round(draft.values / step)


def coarse_recorded(rng, kind, seed):
    """Record with a converter of few bits, which rounds last."""
    board = recorded(rng, drawn(rng, kind, seed))
    coarse(rng, board.draft)
    board.faults["step"] = board.draft.faults["step"]
    return board


def spike(rng, draft):
    """One sample that is wrong, higher than all others."""
    blow = draft.blows[-1]
    at = int((blow.begin + rng.uniform(0.0, 1.0) * (draft.time[-1] - blow.begin)) / draft.setting.step)
    height = rng.uniform(1.2, 5.0)
    draft.values[at] = rng.choice([-1, 1]) * height * faults.level(draft)
    draft.faults["spike"] = height


def coupled(rng, draft):
    """AC coupling, its cutoff over that of the pulse, 1/(2 lengths), from 1/1000 to 1/3."""
    faults.ac_coupling(rng, draft, log_uniform(rng, 0.001, 0.3) / (2.0 * draft.setting.length))


def shift(rng, draft):
    """Shift the zero with the blow, for good."""
    blow = draft.blows[-1]
    share = np.clip((draft.time - blow.begin) / (blow.time - blow.begin), 0.0, 1.0)
    strength = rng.uniform(0.02, 0.5)
    draft.values += rng.choice([-1, 1]) * strength * faults.level(draft) * share
    draft.faults["shift"] = strength


CLASSES = {
    "clean-board": with_fault(lambda rng, d: None),
    "clean-board-train": with_fault(lambda rng, d: None, count=5),
    "board-clipped": with_fault(lambda rng, d: faults.clip(rng, d, rng.uniform(0.4, 0.95))),
    "board-saturated": with_fault(lambda rng, d: faults.saturate(rng, d, rng.uniform(0.5, 0.95), rng.uniform(6.0, 20.0))),
    "board-slewing": with_fault(lambda rng, d: faults.slew(rng, d, rng.uniform(0.3, 0.9))),
    "board-coarse": coarse_recorded,
    "board-offset": with_fault(lambda rng, d: faults.offset(rng, d, 10 ** rng.uniform(-2.0, 0.5))),
    "board-drift": with_fault(lambda rng, d: faults.drift(rng, d, rng.uniform(0.02, 0.6))),
    "board-thermal": with_fault(lambda rng, d: faults.thermal(rng, d, 10 ** rng.uniform(-1.3, 0.3))),
    "board-shift": with_fault(shift),
    "board-ac-coupling": with_fault(coupled),
    "board-hum": with_fault(lambda rng, d: faults.hum(rng, d, rng.uniform(0.02, 0.3))),
    "board-noise": with_fault(lambda rng, d: None, decibels=(6.0, 35.0), colour=COLOURS),
    "board-dead": with_fault(dead),
    "board-few-samples": with_fault(lambda rng, d: None, per_swing=(2.5, 8.0), ratios=(1.0, 4.0)),
    "board-cut": with_fault(lambda rng, d: None, lasts=(0.02, 0.25)),
    "board-cut-train": with_fault(lambda rng, d: None, lasts=(0.02, 0.25), count=4),
    "board-short": with_fault(lambda rng, d: faults.offset(rng, d, 0.1), before=0.0),
    "board-spike": with_fault(spike),
}  # fmt: skip
"""Each class with how it is drawn."""


def draw(kind, seed):
    """Return a draw again, or a new one."""
    return CLASSES[kind](np.random.default_rng([zlib.crc32(kind.encode()), seed]), kind, seed)
