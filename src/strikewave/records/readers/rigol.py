"""Rigol oscilloscopes: what the screen held, in volts (.wfm of DS1000 to DS6000, .bin of MSO5000 to 8000, DHO)."""

from __future__ import annotations

import importlib.util
import sys
import types
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.records.readers import Options
from strikewave.records.readers.child import isolated
from strikewave.records.readers.common import ArrayColumn, assemble, damaged, extra, guard
from strikewave.records.record import Record

_MAGIC = {
    b"\xa5\xa5\xa4\x01": ("B", "wfm1000b"),
    b"\xa1\xa5\x00\x00": ("C", "wfm1000c"),
    b"\xa5\xa5\x00\x00": ("E", "wfm1000e"),
    b"\x01\xff\xff\xff": ("Z", "wfm1000z"),
    b"\xa5\xa5\x38\x00": ("2", "wfm2000"),
    b"RG01": ("5", "bin5000"),
    b"RG03": ("DHO", "dho1000"),
}
"""Family and parser of RigolWFM by the first four bytes."""
_MOST_CHANNELS = 4
"""Analog channels of any of these oscilloscopes."""


def sniff(head: bytes) -> bool:
    """Return whether a file begins like one of a Rigol oscilloscope."""
    return head[:4] in _MAGIC


def read(path: Path, options: Options) -> Record:
    """Read the analog channels of a Rigol file."""
    if importlib.util.find_spec("RigolWFM") is None or sys.modules.get("RigolWFM", True) is None:
        extra("RigolWFM", path)
    return isolated("rigol", path, options)


def parse(path: Path, options: Options) -> Record:
    """Read a Rigol file in this process, with nothing of RigolWFM but its parsers."""
    package = types.ModuleType("RigolWFM")
    spec = importlib.util.find_spec("RigolWFM")
    package.__path__ = list(spec.submodule_search_locations or []) if spec else []
    sys.modules["RigolWFM"] = package
    parsers, channels = extra("RigolWFM.rigol", path), extra("RigolWFM.channel", path)
    family, form = _family(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        waveform = parsers.parse_file(family, str(path))[0]
        form = form or getattr(waveform, "parser_name", "") or type(waveform).__module__.rpartition(".")[2]
        columns = []
        for k in range(1, _MOST_CHANNELS + 1):
            channel = channels.Channel(waveform, k, form)
            if channel.enabled and channel.volts is not None and len(channel.volts):
                columns.append(_column(channel))
    if not columns:
        raise damaged(path, "no channel was switched on", "a file with samples")
    return assemble(path, "rigol", columns, options)


def _family(path: Path) -> tuple[str, str]:
    """Return family and parser of the oscilloscope from the first bytes."""
    with path.open("rb") as file:
        head = file.read(300)
    family, form = _MAGIC[head[:4]]
    guard(path, path.stat().st_size)
    if family == "2":
        model = head[4:24]
        if model.startswith((b"DS4", b"MSO4")):
            return "4", "wfm4000"
        if model.startswith((b"DS6", b"MSO6")):
            return "6", "wfm6000"
    if head[:4] == b"RG01" and int.from_bytes(head[12:16], "little") == 128:
        return ("8" if head[100:104] in (b"MSO8",) or head[100:103] == b"DS8" else "7"), "bin7000_8000"
    if family == "E" and len(head) >= 76:
        points = int.from_bytes(head[28:32], "little") * (bool(head[49]) + bool(head[73]))
        if points and path.stat().st_size - points in (256, 272):
            return "C", "wfm1000c"
    return family, form


def _column(channel: Any) -> ArrayColumn:
    volts = np.asarray(channel.volts)
    step = float(channel.seconds_per_point)
    start = float(channel.times[0]) if channel.times is not None and len(channel.times) else 0.0
    unit = {"V": "V", "A": "A", "W": "W"}.get(str(getattr(channel.unit, "name", "v")).upper(), "")
    return ArrayColumn(f"CH{channel.channel_number}", volts.size, lambda: volts, unit, step, start)
