"""WAV: samples of sound cards and some recorders; integers come as parts of full scale."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import Options
from strikewave.records.readers.common import ArrayColumn, assemble, damaged
from strikewave.records.record import Record

BLOCK = 2**18
"""Frames of 24-bit samples that are unpacked at a time: 3 MB, little beside the channel."""
_INTEGERS = {8: "u1", 16: "i2", 32: "i4"}
"""NumPy's types of integers by their bits; those of 8 bits have no sign."""
_FLOATS = {32: "f4", 64: "f8"}
"""NumPy's types of floats by their bits."""
_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE
"""Formats: plain integers, floats, and one that names its format farther on."""
_MOST_CHUNKS = 1000
"""Chunks before the samples: players write a few, and a hostile file could have them without end."""
_UNKNOWN_SIZE = 2**32 - 1
"""Size of the samples where 32 bits do not hold it."""


class _WavFormat(NamedTuple):
    order: str
    kind: int
    channels: int
    rate: int
    bits: int
    begin: int
    size: int


def sniff(head: bytes) -> bool:
    """Return whether a file begins like a WAV file."""
    return head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE"


def read(path: Path, options: Options) -> Record:
    """Read a WAV file; integer samples are divided by their full scale."""
    layout = _layout(path)
    width = layout.bits // 8 * layout.channels
    frames = min(layout.size, path.stat().st_size - layout.begin) // width if width else 0
    if frames < 1:
        raise damaged(path, "it has no samples", "a file with samples")
    integer = layout.kind == _PCM
    known = {_PCM: _INTEGERS, _FLOAT: _FLOATS}.get(layout.kind, {})
    kind = known.get(layout.bits, "u1" if integer and layout.bits == 24 else "")
    if not kind:
        raise damaged(path, f"samples of {layout.bits} bits, kind {layout.kind}", "WAV of plain integers or floats")
    shape = (frames, layout.channels) + ((3,) if layout.bits == 24 else ())
    samples = np.memmap(path, layout.order + kind, "r", layout.begin, shape)
    scale = 2.0 ** (layout.bits - 1) if integer else 1.0
    columns = [
        ArrayColumn(f"channel {k + 1}", frames, lambda k=k: _scaled(samples[:, k], layout, scale))  # type: ignore[misc]
        for k in range(layout.channels)
    ]
    findings = [
        HealthNotice(
            "wav-scale", f"integers of {layout.bits} bits, 1 is full scale: give a sensitivity", scale, severity="good"
        )
    ] * integer
    if layout.begin + layout.size > path.stat().st_size and layout.size < _UNKNOWN_SIZE:
        findings.append(HealthNotice("cut-off", "the file ends before its samples do", float(frames)))
    return assemble(path, "wav", columns, options, (1.0 / layout.rate if layout.rate else np.nan, 0.0), findings)


def _layout(path: Path) -> _WavFormat:
    """Walk the chunks of the file up to its samples."""
    size = path.stat().st_size
    with path.open("rb") as file:
        order = ">" if file.read(12)[:4] == b"RIFX" else "<"
        form, big = b"", 0
        for _ in range(_MOST_CHUNKS):
            head = file.read(8)
            if len(head) < 8:
                break
            name, length = struct.unpack(order + "4sI", head)
            begin = file.tell()
            if name == b"ds64":
                big = struct.unpack("<QQ", file.read(16))[1]
            elif name == b"fmt ":
                form = file.read(min(length, 40))
            elif name == b"data" and len(form) >= 16:
                kind, channels, rate, _, _, bits = struct.unpack(order + "HHIIHH", form[:16])
                if kind == _EXTENSIBLE and len(form) >= 26:
                    kind = struct.unpack(order + "H", form[24:26])[0]
                return _WavFormat(
                    order, kind, channels, rate, bits, begin, big if big and length == _UNKNOWN_SIZE else length
                )
            if begin + length > size:
                break
            file.seek(begin + length + length % 2)
    raise damaged(path, "it has no samples", "a file with samples")


def _scaled(raw: Any, layout: _WavFormat, scale: float) -> Any:
    """Return the samples of one channel, the full scale of integers being 1."""
    out = np.empty(len(raw))
    for k in range(0, len(raw), BLOCK):
        part = np.asarray(raw[k : k + BLOCK])
        if layout.bits == 24:
            low, middle, high = (part[:, j].astype(np.int32) for j in ((0, 1, 2) if layout.order == "<" else (2, 1, 0)))
            part = low | (middle << 8) | (high.astype(np.int8).astype(np.int32) << 16)
        out[k : k + BLOCK] = part
    if layout.kind == _PCM:
        out -= 128.0 if layout.bits == 8 else 0.0
        out /= scale
    return out
