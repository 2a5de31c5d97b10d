"""Files of recorders, oscilloscopes and analysers: TDMS, MDF, IDE, Rigol, WAV, and the universal file format.

TDMS has channels of LabVIEW and DIAdem in groups, most with a grid of their own; MDF those of vehicles and test
benches, each group over its master channel; IDE those of enDAQ and Mide, calibrated by the file; Rigol what the screen
held, in volts; WAV integers as parts of full scale; the universal file time responses, as text or binary. Formulas,
scripts and attachments that a file may carry are not run, read or opened, and of a number that may be written as an
expression a decimal number or one fraction is taken. Files of the first four, whose blocks can promise more than any
memory holds, are read in a child process with limits.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import importlib.util
import logging
import math
import re
import struct
import sys
import types
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers import Options, common
from strikewave.records.readers.child import isolated
from strikewave.records.readers.headings import PICO, seconds_in
from strikewave.records.record import Record

MANY_SEGMENTS = 1000  # segments read under limits beyond it: npTDMS looks at each for each channel, for minutes
# Head of a segment: mark, flags, version, offsets of the next one and of its samples; flag of big-endian numbers
_TDMS_HEAD, _BIG_ENDIAN = 28, 1 << 6

# Seconds from 1904, from which TDMS counts, to 1970: an earlier time is that of no clock, but of a waveform without one
_FIRST_SECOND = 24107 * 86400


def sniff_tdms(head: bytes) -> bool:
    """Return whether a file begins like TDMS."""
    return head[:4] == b"TDSm"


def read_tdms(path: Path, options: Options) -> Record:
    """Read the numeric channels of a TDMS file, in a child process where it has many segments."""
    common.extra("nptdms", path)
    return isolated("tdms", path, options) if _has_many_segments(path) else parse_tdms(path, options)


def _has_many_segments(path: Path) -> bool:
    """Tell whether a file has more than `MANY_SEGMENTS`, by the heads with which they begin."""
    size, place = path.stat().st_size, 0
    with path.open("rb") as file:
        for _ in range(MANY_SEGMENTS):
            file.seek(place)
            head = file.read(_TDMS_HEAD)
            if place >= size or len(head) < _TDMS_HEAD or head[:4] != b"TDSm":
                return False
            flags, length = int.from_bytes(head[4:8], "little"), head[12:20]
            place += _TDMS_HEAD + int.from_bytes(length, "big" if flags & _BIG_ENDIAN else "little")
    return place < size


def parse_tdms(path: Path, options: Options) -> Record:
    """Read the numeric channels of a TDMS file; an index file beside it is not looked at."""
    nptdms = common.extra("nptdms", path)
    logging.getLogger("nptdms").setLevel(logging.CRITICAL)
    with path.open("rb") as opened, nptdms.TdmsFile.open(opened, raw_timestamps=True) as file:
        columns: list[common.ArrayColumn] = []
        skipped: list[str] = []
        for channel in (channel for group in file.groups() for channel in group.channels()):
            name = f"{channel.group_name}/{channel.name}"
            raw = channel._raw_data_dtype()
            is_stamp = channel.data_type is nptdms.types.TimeStamp
            if (channel.dtype.kind not in "biuf" and not is_stamp) or not len(channel) or not _is_over_time(channel):
                skipped.append(name)
                continue
            common.guard(path, len(channel) * max(raw.itemsize, 1), compressed=False)
            columns.append(_stamps(channel, name) if is_stamp else _tdms_column(channel, name))
        return common.assemble(path, "tdms", columns, options, findings=common.left_out(skipped))


def _is_over_time(channel: Any) -> bool:
    """Tell whether a channel is a waveform over time, or has no grid; a spectrum has a grid of frequencies."""
    properties = channel.properties
    unit = common.text(properties.get("wf_xunit_string"))
    return not unit or not common.number(properties.get("wf_increment")) > 0.0 or seconds_in(unit) is not None


def _tdms_column(channel: Any, name: str) -> common.ArrayColumn:
    """Return a channel with the grid, the clock time of its begin and the unit of its properties."""
    properties = channel.properties
    scale = seconds_in(common.text(properties.get("wf_xunit_string"))) or 1.0
    step = common.number(properties.get("wf_increment")) * scale
    start = common.number(properties.get("wf_start_offset")) * scale
    unit = common.text(properties.get("unit_string")) or common.text(properties.get("NI_UnitDescription"))
    grid = step if step > 0.0 else float("nan")
    origin = _clock_time(properties.get("wf_start_time")) if step > 0.0 else None
    folder = f"{channel.group_name}/"
    return common.ArrayColumn(name, len(channel), channel.read_data, unit, grid, start, folder, origin=origin)


def _stamps(channel: Any, name: str) -> common.ArrayColumn:
    """Return a channel of clock times, as time since the first of them."""
    folder = f"{channel.group_name}/"
    origin = _clock_time(channel[0])
    return common.ArrayColumn(
        name, len(channel), lambda: channel.read_data().as_datetime64("ns"), folder=folder, time=True, origin=origin
    )


def _clock_time(value: Any) -> int | None:
    """Return a timestamp as one number, ps; None for another value, and for one that was never set."""
    seconds, fractions = getattr(value, "seconds", None), getattr(value, "second_fractions", None)
    if seconds is None or fractions is None or int(seconds) < _FIRST_SECOND:
        return None
    return int(seconds) * PICO + (int(fractions) * PICO >> 64)


# Conversions from numbers to numbers, without text or formulas, by version
_PLAIN = {3: {0, 1, 2, 6, 7, 8, 9, 65535}, 4: {0, 1, 2, 4, 5, 6}}


def sniff_mdf(head: bytes) -> bool:
    """Return whether a file begins like MDF."""
    return head[:8] in (b"MDF     ", b"UnFinMF ")


def read_mdf(path: Path, options: Options) -> Record:
    """Read the numeric channels of an MDF file."""
    common.extra("asammdf", path)
    return isolated("mdf", path, options)


def parse_mdf(path: Path, options: Options) -> Record:
    """Read an MDF file in this process."""
    logging.disable(logging.CRITICAL)
    asammdf = common.extra("asammdf", path)
    columns: list[common.ArrayColumn] = []
    skipped: list[str] = []
    raw: list[str] = []
    # An open file has no name with an ending that would have it unpacked.
    with path.open("rb") as opened, asammdf.MDF(opened, process_bus_logging=False, use_display_names=False) as file:
        groups = range(len(file.groups))
        for group in groups:
            for index, channel in enumerate(file.groups[group].channels):
                common.check_count(path, len(columns) + len(skipped))
                channel_columns = _signal_columns(file, group, index, channel, raw)
                columns += channel_columns
                skipped += [channel.name] * (not channel_columns)
        findings = [*common.left_out(skipped)]
        if raw:
            listed = ", ".join(raw[:8])
            findings.append(HealthNotice("not-converted", f"their conversion is text or a formula: {listed}", len(raw)))
        return common.assemble(path, "mdf", columns, options, findings=findings)


def _signal_columns(file: Any, group: int, index: int, channel: Any, raw: list[str]) -> list[common.ArrayColumn]:
    """Return a channel; the master channel of its group is its time."""
    signal = file.get(group=group, index=index, raw=True, ignore_invalidation_bits=True)
    values = signal.samples
    if values.dtype.kind not in "biuf" or values.ndim != 1 or not values.size:
        return []
    version = 4 if str(file.version) >= "4" else 3
    conversion = signal.conversion
    if conversion is not None and conversion.conversion_type not in _PLAIN[version]:
        raw.append(channel.name)
        conversion = None
    master = file.masters_db.get(group) == index
    unit = common.text(signal.unit)
    name = "time" if master else str(channel.name)
    load = functools.partial(_physical, values, conversion)
    return [common.ArrayColumn(name, values.size, load, unit, folder=f"{group}", time=master)]


def _physical(values: Any, conversion: Any) -> Any:
    if conversion is None:
        return values
    try:
        return common.floats(conversion.convert(values, as_object=False))
    except TypeError:
        return values


_MICROSECOND = 1e-6  # s; times of such a file are in microseconds
_MOST_PER_BYTE = 8  # samples for each byte of the file at most: a sample has one bit at least


def sniff_ide(head: bytes) -> bool:
    """Return whether a file begins like an IDE file: EBML whose document type is ``mide``."""
    return head[:4] == b"\x1aE\xdf\xa3" and b"mide" in head[:128]


def read_ide(path: Path, options: Options) -> Record:
    """Read the channels of an IDE file."""
    common.extra("idelib", path)
    return isolated("ide", path, options)


def parse_ide(path: Path, options: Options) -> Record:
    """Read an IDE file in this process."""
    logging.disable(logging.CRITICAL)
    idelib = common.extra("idelib", path)
    common.extra("idelib.parsers", path).valEval = _ratio
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        opened = idelib.importFile(str(path), quiet=True)
        with opened:
            columns: list[common.ArrayColumn] = []
            skipped: list[str] = []
            for channel in list(opened.channels.values())[: common.MOST_ARRAYS]:
                channel_columns = _sensor_columns(path, channel)
                columns += channel_columns
                skipped += [str(channel.name)] * (not channel_columns)
            return common.assemble(path, "ide", columns, options, findings=common.left_out(skipped))


def _ratio(value: Any) -> float:
    """Return the number that a text such as ``"1/32768"`` writes."""
    above, _, below = common.text(value).partition("/")
    return float(above) / float(below or 1.0)


def _sensor_columns(path: Path, channel: Any) -> list[common.ArrayColumn]:
    """Return the axes of one sensor, with their time, in place of what the file keeps of them."""
    events = channel.getSession()
    size = len(events)
    if not size:
        return []
    if size * len(channel.subchannels) > _MOST_PER_BYTE * path.stat().st_size:
        raise common.damaged(path, f"channel {channel.name} claims {size} samples")
    common.guard(path, 8.0 * size * (len(channel.subchannels) + 1))
    values = events.arraySlice()
    folder = f"{channel.id}"
    columns = [common.ArrayColumn("time", size, lambda: values[0] * _MICROSECOND, "s", folder=folder, time=True)]
    for k, axis in enumerate(channel.subchannels, start=1):
        if axis is not None and k < len(values):
            unit = common.text((axis.units or ("", ""))[1])
            name = f"{channel.name}/{axis.displayName}"
            columns.append(common.ArrayColumn(name, size, lambda k=k: values[k], unit, folder=folder))  # type: ignore[misc]
    return columns


# Family and parser of RigolWFM by the first four bytes
_MAGIC = {
    b"\xa5\xa5\xa4\x01": ("B", "wfm1000b"),
    b"\xa1\xa5\x00\x00": ("C", "wfm1000c"),
    b"\xa5\xa5\x00\x00": ("E", "wfm1000e"),
    b"\x01\xff\xff\xff": ("Z", "wfm1000z"),
    b"\xa5\xa5\x38\x00": ("2", "wfm2000"),
    b"RG01": ("5", "bin5000"),
    b"RG03": ("DHO", "dho1000"),
}
_MOST_CHANNELS = 4  # analog channels of any of these oscilloscopes


def sniff_rigol(head: bytes) -> bool:
    """Return whether a file begins like one of a Rigol oscilloscope."""
    return head[:4] in _MAGIC


def read_rigol(path: Path, options: Options) -> Record:
    """Read the analog channels of a Rigol file."""
    if importlib.util.find_spec("RigolWFM") is None or sys.modules.get("RigolWFM", True) is None:
        common.extra("RigolWFM", path)
    return isolated("rigol", path, options)


def parse_rigol(path: Path, options: Options) -> Record:
    """Read a Rigol file in this process, with nothing of RigolWFM but its parsers."""
    package = types.ModuleType("RigolWFM")
    spec = importlib.util.find_spec("RigolWFM")
    package.__path__ = list(spec.submodule_search_locations or []) if spec else []
    package.__spec__ = spec  # without one nobody else in this process could look for it
    sys.modules["RigolWFM"] = package
    parsers, channels = common.extra("RigolWFM.rigol", path), common.extra("RigolWFM.channel", path)
    family, form = _family(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        waveform = parsers.parse_file(family, str(path))[0]
        form = form or getattr(waveform, "parser_name", "") or type(waveform).__module__.rpartition(".")[2]
        columns = []
        for k in range(1, _MOST_CHANNELS + 1):
            channel = channels.Channel(waveform, k, form)
            if channel.enabled and channel.volts is not None and len(channel.volts):
                columns.append(_analog_column(channel))
    if not columns:
        raise common.damaged(path, "no channel was switched on", "a file with samples")
    return common.assemble(path, "rigol", columns, options)


def _family(path: Path) -> tuple[str, str]:
    """Return family and parser of the oscilloscope from the first bytes."""
    with path.open("rb") as file:
        head = file.read(300)
    family, form = _MAGIC[head[:4]]
    common.guard(path, path.stat().st_size)
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


def _analog_column(channel: Any) -> common.ArrayColumn:
    volts = np.asarray(channel.volts)
    step = float(channel.seconds_per_point)
    start = float(channel.times[0]) if channel.times is not None and len(channel.times) else 0.0
    unit = {"V": "V", "A": "A", "W": "W"}.get(str(getattr(channel.unit, "name", "v")).upper(), "")
    return common.ArrayColumn(f"CH{channel.channel_number}", volts.size, lambda: volts, unit, step, start)


BLOCK = 2**18  # frames of 24-bit samples that are unpacked at a time: 3 MB, little beside the channel
_INTEGERS = {8: "u1", 16: "i2", 32: "i4"}  # numPy's types of integers by their bits; those of 8 bits have no sign
_FLOATS = {32: "f4", 64: "f8"}  # numPy's types of floats by their bits
_PCM, _FLOAT, _EXTENSIBLE = 1, 3, 0xFFFE  # formats: plain integers, floats, and one that names its format farther on
_MOST_CHUNKS = 1000  # chunks before the samples: players write a few, and a hostile file could have them without end
_UNKNOWN_SIZE = 2**32 - 1  # size of the samples where 32 bits do not hold it


class _WavFormat(NamedTuple):
    order: str
    kind: int
    channels: int
    rate: int
    bits: int
    begin: int
    size: int


def sniff_wav(head: bytes) -> bool:
    """Return whether a file begins like a WAV file."""
    return head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE"


def read_wav(path: Path, options: Options) -> Record:
    """Read a WAV file; integer samples are divided by their full scale."""
    layout = _layout(path)
    width = layout.bits // 8 * layout.channels
    frames = min(layout.size, path.stat().st_size - layout.begin) // width if width else 0
    if frames < 1:
        raise common.damaged(path, "it has no samples", "a file with samples")
    integer = layout.kind == _PCM
    known = {_PCM: _INTEGERS, _FLOAT: _FLOATS}.get(layout.kind, {})
    kind = known.get(layout.bits, "u1" if integer and layout.bits == 24 else "")
    if not kind:
        raise common.damaged(
            path, f"samples of {layout.bits} bits, kind {layout.kind}", "WAV of plain integers or floats"
        )
    shape = (frames, layout.channels) + ((3,) if layout.bits == 24 else ())
    samples = np.memmap(path, layout.order + kind, "r", layout.begin, shape)
    scale = 2.0 ** (layout.bits - 1) if integer else 1.0
    columns = [
        common.ArrayColumn(f"channel {k + 1}", frames, lambda k=k: _scaled(samples[:, k], layout, scale))  # type: ignore[misc]
        for k in range(layout.channels)
    ]
    findings = [
        HealthNotice(
            "wav-scale", f"integers of {layout.bits} bits, 1 is full scale: give a sensitivity", scale, severity="good"
        )
    ] * integer
    if layout.begin + layout.size > path.stat().st_size and layout.size < _UNKNOWN_SIZE:
        findings.append(HealthNotice("cut-off", "the file ends before its samples do", float(frames)))
    return common.assemble(path, "wav", columns, options, (1.0 / layout.rate if layout.rate else np.nan, 0.0), findings)


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
    raise common.damaged(path, "it has no samples", "a file with samples")


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


TIME_RESPONSE = 1  # function type of a time response
MEASURED = 58  # data set of a function at a degree of freedom
# Beginning of a data set: -1 in a line, then its number
_UFF_HEAD = re.compile(rb"\A[ \r\n]*-1 *\r?\n *\d{1,5}[bB \r\n]")


def sniff_uff(head: bytes) -> bool:
    """Return whether a file begins like a universal file."""
    return _UFF_HEAD.match(head) is not None


def read_uff(path: Path, options: Options) -> Record:
    """Read the time responses of a universal file; other data sets are passed over."""
    pyuff = importlib.import_module("pyuff")
    with warnings.catch_warnings(), contextlib.suppress(OSError):
        warnings.simplefilter("ignore")
        file = pyuff.UFF(str(path))
        kinds = file.get_set_types()
        common.check_count(path, len(kinds))
        columns: list[common.ArrayColumn] = []
        skipped: list[str] = []
        for k, kind in enumerate(kinds):
            set_columns = _response_columns(file.read_sets(k), len(columns)) if kind == MEASURED else []
            columns += set_columns
            skipped += [f"data set {kind}"] * (not set_columns)
        return common.assemble(path, "uff", columns, options, findings=common.left_out(skipped))
    raise common.damaged(path, "it cannot be opened")


def _response_columns(data_set: dict[str, Any], count: int) -> list[common.ArrayColumn]:
    """Return a time response, with its abscissa where that is uneven."""
    values = data_set["data"]
    if data_set["func_type"] != TIME_RESPONSE or np.iscomplexobj(values) or not len(values):
        return []
    folder = f"{count}"
    unit = _label(data_set, "ordinate_axis_units_lab")
    even = data_set["abscissa_spacing"] == 1
    values = values[: data_set["num_pts"]] if data_set["num_pts"] > 0 else values
    step, start = (data_set["abscissa_inc"], data_set["abscissa_min"]) if even else (math.nan, math.nan)
    step = step if step > 0.0 else math.nan
    column = common.ArrayColumn(_name(data_set, count), len(values), lambda: values, unit, step, start, folder)
    if even:
        return [column]
    stamps, scale = data_set["x"][: len(values)], _label(data_set, "abscissa_axis_units_lab")
    return [column, common.ArrayColumn("time", len(stamps), lambda: stamps, scale, folder=folder, time=True)]


def _name(data_set: dict[str, Any], count: int) -> str:
    """Return the label of the ordinate, the entity or the first line of the header, the first that is filled."""
    names = (_label(data_set, name) for name in ("ordinate_axis_lab", "rsp_ent_name", "id1"))
    return next((name for name in names if name), f"channel {count + 1}")


def _label(data_set: dict[str, Any], name: str) -> str:
    label = common.text(data_set.get(name, ""))
    return "" if label.upper() in ("NONE", "NULL") else label
