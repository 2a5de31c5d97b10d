"""Binary formats part by part: heads, types and tables laid out by hand, each word of a head different from the others."""

import math
import shutil
import struct
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records.readers import Options, common, containers, recorders, tables
from strikewave.records.readers.common import ArrayColumn
from strikewave.records.readers.headings import PICO

from .samples import uff_set

NAN = math.nan


def shown(record):
    return [(c.name, c.unit, c.values.tolist(), c.step, c.start) for c in record.channels]


# WAV


def riff(form, data, before=b"", size=None, tag=b"RIFF", order="<"):
    chunks = b"fmt " + struct.pack(order + "I", len(form)) + form + before
    return (
        tag
        + bytes(4)
        + b"WAVE"
        + chunks
        + b"data"
        + struct.pack(order + "I", len(data) if size is None else size)
        + data
    )


def wav_form(order="<", kind=1, channels=2, rate=500, bits=16, extension=b""):
    return struct.pack(order + "HHIIHH", kind, channels, rate, 77, 88, bits) + extension


@pytest.fixture
def written(tmp_path):
    def write(content, name="blow"):
        (tmp_path / name).write_bytes(content)
        return tmp_path / name

    return write


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("block", [1, 3, 1000])
@pytest.mark.parametrize(("bits", "kind"), [(8, 1), (16, 1), (24, 1), (32, 1), (32, 3), (64, 3)])
def test_wav_samples_of_any_width_and_order(written, monkeypatch, order, block, bits, kind):
    """Two channels of four values: the first and the last of the full scale, and two between."""
    monkeypatch.setattr(recorders, "BLOCK", block)
    full = 2 ** (bits - 1)
    ints = [[-full, full - 1], [3, -5], [full // 3, 100], [-(full // 7), 1]]
    size = bits // 8
    if kind == 3:
        data = np.array(ints, float).astype(f"{order}f{size}").tobytes()
    elif bits == 8:
        data = bytes(value + 128 for row in ints for value in row)
    else:
        data = b"".join(v.to_bytes(size, "little" if order == "<" else "big", signed=True) for row in ints for v in row)
    path = written(riff(wav_form(order, kind, bits=bits), data, tag=b"RIFF" if order == "<" else b"RIFX", order=order))
    record = recorders.read_wav(path, Options())
    scale = 1.0 if kind == 3 else float(full)
    expected = np.array(ints, "f4" if (kind, bits) == (3, 32) else "f8").astype(float) / scale
    assert [c.values.tolist() for c in record.channels] == expected.T.tolist()
    assert [(c.name, c.step, c.start) for c in record.channels] == [
        ("channel 1", 0.002, 0.0),
        ("channel 2", 0.002, 0.0),
    ]
    assert [(f.code, f.value) for f in record.findings] == ([("wav-scale", scale)] if kind == 1 else [])


def test_chunks_before_the_samples_are_passed_over(written, monkeypatch):
    """Those of odd length are padded; one that is longer than the file ends the search."""
    samples = struct.pack("<4h", 1, 2, 3, 4)
    for length in (0, 1, 2, 5):
        other = b"LIST" + struct.pack("<I", length) + bytes(length + length % 2)
        assert (
            recorders.read_wav(written(riff(wav_form(), samples, other * 2)), Options()).channels[1].values[1]
            == 4 / 2**15
        )
    with pytest.raises(InputError, match="no samples"):
        recorders.read_wav(written(riff(wav_form(), samples, b"LIST" + struct.pack("<I", 999))), Options())
    with pytest.raises(InputError, match="no samples"):
        recorders.read_wav(written(riff(wav_form()[:15] + b"", samples)), Options())
    other = b"LIST" + bytes(4)
    assert len(recorders.read_wav(written(riff(wav_form(), samples, other * 998)), Options()).channels) == 2
    with pytest.raises(InputError, match="no samples"):
        recorders.read_wav(written(riff(wav_form(), samples, other * 999)), Options())
    monkeypatch.setattr(recorders, "_MOST_CHUNKS", 3)
    assert len(recorders.read_wav(written(riff(wav_form(), samples, other)), Options()).channels) == 2
    with pytest.raises(InputError, match="no samples"):
        recorders.read_wav(written(riff(wav_form(), samples, other * 2)), Options())


def test_a_wav_file_of_64_bits_tells_its_size_ahead(written):
    samples = struct.pack("<6h", 1, 2, 3, 4, 5, 6)
    ds64 = b"ds64" + struct.pack("<IQQ", 16, 99, 8)
    layout = recorders._layout(written(riff(wav_form(), samples, ds64, 2**32 - 1, b"RF64")))
    assert (layout.size, layout.kind, layout.channels, layout.rate, layout.bits, layout.order) == (
        8,
        1,
        2,
        500,
        16,
        "<",
    )
    assert recorders._layout(written(riff(wav_form(), samples, ds64, 12, b"RF64"))).size == 12
    path = written(riff(wav_form(), samples, size=2**32 - 1))
    record = recorders.read_wav(path, Options())  # cut where no size is known
    assert (record.channels[0].values.size, [f.code for f in record.findings]) == (3, ["wav-scale"])


def test_an_extended_format_names_its_own(written):
    samples = np.arange(4.0, dtype="<f4").tobytes()
    extended = wav_form(kind=0xFFFE, bits=32, extension=struct.pack("<HHIH", 22, 32, 0, 3))
    assert recorders.read_wav(written(riff(extended, samples)), Options()).channels[1].values.tolist() == [1.0, 3.0]
    assert len(extended) == 26
    assert recorders.read_wav(written(riff(extended + bytes(8), samples)), Options()).channels[0].values.tolist() == [
        0.0,
        2.0,
    ]
    with pytest.raises(InputError, match="kind 65534"):
        recorders.read_wav(written(riff(extended[:24], samples)), Options())


@pytest.mark.parametrize(
    ("form", "words"),
    [
        (wav_form(bits=12), "samples of 12 bits"), (wav_form(kind=7), "kind 7"), (wav_form(kind=7, bits=32), "kind 7"), (wav_form(kind=3, bits=24), "samples of 24 bits"),
        (wav_form(channels=0), "no samples"), (wav_form(channels=9), "no samples"),
    ],
)  # fmt: skip
def test_wav_files_without_plain_samples_are_refused(written, form, words):
    with pytest.raises(InputError, match=words):
        recorders.read_wav(written(riff(form, bytes(12))), Options())
    assert math.isnan(recorders.read_wav(written(riff(wav_form(rate=0), bytes(12))), Options()).channels[0].step)
    assert recorders.read_wav(written(riff(wav_form(channels=6), bytes(12))), Options()).channels[5].values.size == 1


def test_a_wav_file_that_ends_early_says_so(written):
    record = recorders.read_wav(written(riff(wav_form(), bytes(12), size=13)), Options())
    assert [(f.code, f.value) for f in record.findings][1:] == [("cut-off", 3.0)]
    assert recorders.sniff_wav(b"RF64....WAVE")
    assert not recorders.sniff_wav(b"RIFF....AVI ")
    assert not recorders.sniff_wav(b"RIFD....WAVE")


# MATLAB


def element(kind, body, order="<"):
    return struct.pack(order + "II", kind, len(body)) + body + bytes(-len(body) % 8)


def matrix(name, numbers, kind=9, flags=6, shape=None, order="<"):
    shape = (len(numbers), 1) if shape is None else shape
    body = element(6, struct.pack(order + "II", flags, 0), order) + element(
        5, struct.pack(f"{order}{len(shape)}i", *shape), order
    )
    return element(
        14, body + element(1, name.encode(), order) + element(kind, numbers_of(numbers, kind, order), order), order
    )


def numbers_of(numbers, kind, order):
    return np.asarray(numbers).astype(order + containers._TYPES[kind]).tobytes()


HEAD = {"<": b"MATLAB".ljust(124) + b"\x00\x01IM", ">": b"MATLAB".ljust(124) + b"\x01\x00MI"}


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("kind", [1, 2, 3, 4, 5, 6, 7, 9, 12, 13])
def test_every_type_of_numbers_of_matlab(written, order, kind):
    record = containers.read_mat(written(HEAD[order] + matrix("abc", [3, 5, 100], kind, order=order)), Options())
    assert shown(record)[0][:3] == ("abc", "", [3.0, 5.0, 100.0])


def test_classes_that_are_no_numbers_are_passed_over(written):
    """Classes from 6 to 15 hold numbers; 0x0800 marks complex ones, other flags nothing of the kind."""
    parts = [matrix(f"class{k}", [3, 5], flags=k) for k in (1, 4, 5, 6, 15, 16)]
    parts += [matrix("complex", [3, 5], flags=0x0806), matrix("global", [3, 5], flags=0x0406)]
    record = containers.read_mat(written(HEAD["<"] + b"".join(parts)), Options())
    assert [c.name for c in record.channels] == ["class6", "class15", "global"]
    assert record.findings[0].value == 5
    assert "class1, class4, class5, class16, complex" in record.findings[0].message


def test_small_elements_hold_up_to_four_bytes(written):
    """Kind and size in one word, the bytes in the next."""
    body = element(6, struct.pack("<II", 6, 0)) + element(5, struct.pack("<2i", 3, 1))
    small = struct.pack("<I", 3 << 16 | 1) + b"abc\0" + struct.pack("<I", 3 << 16 | 2) + b"\x07\x08\x09\0"
    assert shown(containers.read_mat(written(HEAD["<"] + element(14, body + small)), Options()))[0][:3] == (
        "abc",
        "",
        [7.0, 8.0, 9.0],
    )
    found = list(containers._elements(memoryview(small + element(9, b"12345") + element(5, b"z")), "<"))
    assert [(kind, bytes(part)) for kind, part in found] == [
        (1, b"abc"),
        (2, b"\x07\x08\x09"),
        (9, b"12345"),
        (5, b"z"),
    ]
    assert [
        bytes(part) for _, part in containers._elements(memoryview(struct.pack("<I", 9 << 16 | 1) + b"abcdefgh"), "<")
    ] == [b"abcd"]
    assert list(containers._elements(memoryview(b"1234567"), "<")) == []


def struct_of(name, fields, length=5):
    body = element(6, struct.pack("<II", 2, 0)) + element(5, struct.pack("<2i", 1, 1)) + element(1, name.encode())
    names = b"".join(field.encode().ljust(length, b"\0") for field, _ in fields)
    return element(
        14, body + element(5, struct.pack("<i", length)) + element(1, names) + b"".join(part for _, part in fields)
    )


def test_fields_of_structs_have_the_name_of_their_place(written):
    inner = struct_of("", [("bar", matrix("", [1, 2])), ("dt", matrix("", [4])), ("", matrix("", [7, 7]))])
    record = containers.read_mat(
        written(HEAD["<"] + struct_of("run", [("in", inner), ("top", matrix("", [3, 5]))])), Options()
    )
    assert shown(record)[0] == ("run/in/bar", "", [1.0, 2.0], 4.0, 0.0)
    assert [c.name for c in record.channels] == ["run/in/bar"]  # the other one has no step
    two = struct_of("run", [("top", matrix("", [3, 5]))]).replace(struct.pack("<2i", 1, 1), struct.pack("<2i", 2, 1))
    assert "run" in containers.read_mat(written(HEAD["<"] + two + matrix("a", [1, 2])), Options()).findings[0].message


def test_structs_nest_up_to_eight_deep(written):
    part = matrix("", [1, 2])
    for _ in range(7):
        part = struct_of("", [("a", part)])
    assert [
        c.name for c in containers.read_mat(written(HEAD["<"] + struct_of("s", [("a", part)])), Options()).channels
    ] == ["s/" + "a/" * 7 + "a"]
    part = struct_of("", [("a", part)])
    with pytest.raises(InputError, match="no arrays"):
        containers.read_mat(written(HEAD["<"] + struct_of("s", [("a", part)])), Options())


def test_tables_of_matlab_lie_column_by_column(written):
    record = containers.read_mat(
        written(HEAD["<"] + matrix("ab", range(6), shape=(3, 2)) + matrix("dt", [2])), Options()
    )
    assert shown(record) == [("ab 1", "", [0.0, 1.0, 2.0], 2.0, 0.0), ("ab 2", "", [3.0, 4.0, 5.0], 2.0, 0.0)]
    with pytest.raises(InputError, match=r"6 numbers for a shape of \(3, 3\)"):
        containers.read_mat(written(HEAD["<"] + matrix("ab", range(6), shape=(3, 3))), Options())
    record = containers.read_mat(
        written(HEAD["<"] + matrix("cube", range(8), shape=(2, 2, 2)) + matrix("a", [1, 2])), Options()
    )
    assert record.findings[0].message == "1 arrays are no channels: cube"


def test_compressed_arrays_are_unpacked_no_further_than_they_claim(written):
    import zlib

    packed = zlib.compress(matrix("abc", [3, 5]))
    assert (
        containers.read_mat(written(HEAD["<"] + struct.pack("<II", 15, len(packed)) + packed), Options())
        .channels[0]
        .name
        == "abc"
    )
    empty = zlib.compress(struct.pack("<II", 14, 0) + b"xyz")
    assert containers._unpacked(written(b"file"), memoryview(empty), "<") == (
        14,
        b"x",
    )  # zlib takes a bound of zero for none
    three = zlib.compress(struct.pack("<II", 14, 3) + b"abcdef")
    assert containers._unpacked(written(b"file"), memoryview(three), "<") == (14, b"abc")
    packed = zlib.compress(b"1234567")
    with pytest.raises(InputError, match="compressed array is empty"):
        containers.read_mat(written(HEAD["<"] + struct.pack("<II", 15, len(packed)) + packed), Options())
    with pytest.raises(InputError, match="ends within an array"):
        containers.read_mat(written(HEAD["<"] + struct.pack("<II", 15, len(packed) + 1) + packed), Options())


def old_matrix(name, numbers, form=0, shape=None, imaginary=0, order="<"):
    shape = (len(numbers), 1) if shape is None else shape
    kind = containers._OLD_TYPES[form // 10 % 10]
    head = struct.pack(order + "5i", form + 1000 * (order == ">"), *shape, imaginary, len(name) + 1)
    return head + name.encode() + b"\0" + np.asarray(numbers).astype(order + kind).tobytes()


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("form", [0, 10, 20, 30, 40, 50])
def test_every_type_of_numbers_of_version_4(written, order, form):
    parts = [("abc", [3, 5, 100]), ("de", [7, 8, 9])]
    content = b"".join(old_matrix(*part, form, order=order) for part in parts)
    assert containers.sniff_mat(content)
    assert [one[:3] for one in shown(containers.read_mat(written(content), Options()))] == [
        ("abc", "", [3.0, 5.0, 100.0]),
        ("de", "", [7.0, 8.0, 9.0]),
    ]


@pytest.mark.parametrize(
    "head",
    [
        old_matrix("abc", [3], 60 - 60 + 1), struct.pack("<5i", 60, 1, 1, 0, 4) + b"abc\0", old_matrix("abc", [3], shape=(-1, 1)),
        old_matrix("abc", [3], imaginary=2), old_matrix("a c", [3]), old_matrix("", [3]), old_matrix("a" * 255, [3]),
        old_matrix("abc", [3]).replace(b"abc\0", b"abcd"), struct.pack("<5i", 1000, 1, 1, 0, 4) + b"abc\0" + bytes(8),
    ],
)  # fmt: skip
def test_what_is_no_head_of_version_4(head):
    assert not containers.sniff_mat(head + bytes(8))


def test_heads_of_version_4_up_to_their_limits():
    assert containers._old_head(old_matrix("ab", [3], shape=(0, 7)), 0) == ("<f8", (0, 7), 20, False, 3)
    assert containers._old_head(b"xyz" + old_matrix("a" * 254, [3], 30, imaginary=1, order=">"), 3) == (
        ">i2",
        (1, 1),
        23,
        True,
        255,
    )
    whole = old_matrix("ab", [3])
    assert containers._old_head(whole[:24], 0) is not None
    assert containers._old_head(whole[:23], 0) is None


def test_complex_arrays_of_version_4_are_passed_over(written):
    both = old_matrix("ab", [3, 5, 0, 0], shape=(2, 1), imaginary=1) + old_matrix("cd", [7, 8])
    assert [c.name for c in containers.read_mat(written(both), Options()).channels] == ["cd"]
    with pytest.raises(InputError, match="no array begins at byte 39"):
        containers.read_mat(written(old_matrix("ab", [3, 5]) + b"rest"), Options())
    with pytest.raises(InputError, match="ends within an array"):
        containers.read_mat(written(old_matrix("ab", [3, 5])[:-1]), Options())


def test_more_arrays_than_the_most_are_refused(written, monkeypatch):
    monkeypatch.setattr(containers.common, "MOST_ARRAYS", 2)
    assert len(containers.read_mat(written(old_matrix("ab", [3, 5]) * 2), Options()).channels) == 2
    with pytest.raises(InputError, match="at most 2 arrays"):
        containers.read_mat(written(old_matrix("ab", [3, 5]) * 3), Options())
    passed_over = matrix("class4", [3, 5], flags=4)
    assert len(containers.read_mat(written(HEAD["<"] + matrix("a", [3, 5]) + passed_over), Options()).channels) == 1
    with pytest.raises(InputError, match="at most 2 arrays"):
        containers.read_mat(written(HEAD["<"] + matrix("a", [3, 5]) + passed_over + matrix("b", [3, 5])), Options())
    assert not containers.sniff_mat(HEAD["<"][:127])
    assert containers.sniff_mat(HEAD[">"])


# Rigol


def family(written, head, size=400):
    return recorders._family(written(head.ljust(size, b"\0")))


@pytest.mark.parametrize(
    ("head", "expected"),
    [
        (b"\xa5\xa5\xa4\x01", ("B", "wfm1000b")), (b"\xa1\xa5\0\0", ("C", "wfm1000c")), (b"\x01\xff\xff\xff", ("Z", "wfm1000z")),
        (b"\xa5\xa5\x38\0DS2072", ("2", "wfm2000")), (b"\xa5\xa5\x38\0DS4022", ("4", "wfm4000")), (b"\xa5\xa5\x38\0MSO4012", ("4", "wfm4000")),
        (b"\xa5\xa5\x38\0DS6104", ("6", "wfm6000")), (b"\xa5\xa5\x38\0MSO6", ("6", "wfm6000")), (b"RG03", ("DHO", "dho1000")),
        (b"RG01" + bytes(8) + struct.pack("<I", 144), ("5", "bin5000")),
        (b"RG01" + bytes(8) + struct.pack("<I", 128), ("7", "bin7000_8000")),
        ((b"RG01" + bytes(8) + struct.pack("<I", 128)).ljust(100, b"\0") + b"MSO8", ("8", "bin7000_8000")),
        ((b"RG01" + bytes(8) + struct.pack("<I", 128)).ljust(100, b"\0") + b"DS8", ("8", "bin7000_8000")),
        ((b"RG01" + bytes(8) + struct.pack("<I", 128)).ljust(101, b"\0") + b"DS8", ("7", "bin7000_8000")),
        ((b"RG01" + bytes(8) + struct.pack("<I", 129)).ljust(100, b"\0") + b"DS8", ("5", "bin5000")),
        (b"RG03" + bytes(8) + struct.pack("<I", 128), ("DHO", "dho1000")), (b"\xa5\xa5\0\0", ("E", "wfm1000e")),
    ],
)  # fmt: skip
def test_the_family_of_an_oscilloscope_is_told_by_its_head(written, head, expected):
    assert family(written, head) == expected
    assert recorders.sniff_rigol(head)
    assert not recorders.sniff_rigol(b"x" + head)


def points(count, first=1, second=0):
    head = bytearray(b"\xa5\xa5\0\0".ljust(100, b"\x09"))
    head[28:32] = struct.pack("<I", count)
    head[49], head[73] = first, second
    return bytes(head)


@pytest.mark.parametrize(
    ("head", "size", "form"),
    [
        (points(144), 400, "C"), (points(128), 400, "C"), (points(143), 400, "E"), (points(129), 400, "E"), (points(72, 1, 1), 400, "C"),
        (points(144, 0, 3), 400, "C"), (points(144, 0, 0), 400, "E"), (points(0), 256, "E"), (points(64, 2, 2), 400, "C"),
        (points(144)[:75], 400, "E"),
    ],
)  # fmt: skip
def test_a_head_of_one_family_with_the_samples_of_another(written, head, size, form):
    """So many points of each channel that is on, behind a head of 256 or 272 bytes."""
    if len(head) < 76:
        path = written(head)
        assert recorders._family(path)[0] == form
        return
    assert family(written, head, size)[0] == form


def test_channels_of_oscilloscopes_have_their_unit_step_and_start():
    def channel(**how):
        said = {
            "volts": [1.0, 2.0],
            "seconds_per_point": 3e-6,
            "times": [-5e-3, 0.0],
            "unit": SimpleNamespace(name="a"),
            "channel_number": 4,
        }
        return SimpleNamespace(**{**said, **how})

    column = recorders._analog_column(channel())
    assert (column.name, column.size, column.unit, column.step, column.start, column.load().tolist()) == (
        "CH4",
        2,
        "A",
        3e-6,
        -5e-3,
        [1.0, 2.0],
    )
    assert (
        recorders._analog_column(channel(times=None)).start == recorders._analog_column(channel(times=[])).start == 0.0
    )
    assert [recorders._analog_column(channel(unit=SimpleNamespace(name=n))).unit for n in ("v", "W", "unknown")] == [
        "V",
        "W",
        "",
    ]
    assert recorders._analog_column(channel(unit="")).unit == "V"


def test_channels_of_an_oscilloscope_that_are_switched_on_are_read(written, monkeypatch):
    """Of four the second and the last; the first is off, the third has no samples."""
    asked = []

    def channel(waveform, number, form):
        asked.append((waveform, number, form))
        volts = {1: [9.0], 2: [1.0, 2.0, 4.0], 3: [], 4: [3.0, 5.0, 7.0]}[number]
        return SimpleNamespace(
            enabled=number > 1, volts=volts, seconds_per_point=0.5, times=[-3.0], unit=SimpleNamespace(name="V"),
            channel_number=number,
        )  # fmt: skip

    parsers = SimpleNamespace(parse_file=lambda family, path: [f"{family} waveform"])
    monkeypatch.setitem(sys.modules, "RigolWFM", None)
    monkeypatch.setattr(
        recorders.common,
        "extra",
        lambda name, _: parsers if name.endswith("rigol") else SimpleNamespace(Channel=channel),
    )
    path = written(b"RG03" + bytes(300))
    assert shown(recorders.parse_rigol(path, Options())) == [
        ("CH2", "V", [1.0, 2.0, 4.0], 0.5, -3.0), ("CH4", "V", [3.0, 5.0, 7.0], 0.5, -3.0),
    ]  # fmt: skip
    assert asked == [("DHO waveform", number, "dho1000") for number in (1, 2, 3, 4)]


# TDMS


def test_segments_of_a_tdms_file_are_counted_by_their_heads(written, monkeypatch):
    def part(size, flags=0, order="little", tag=b"TDSm"):
        return tag + flags.to_bytes(4, "little") + bytes(4) + size.to_bytes(8, order) + bytes(8) + bytes(size)

    assert not recorders._has_many_segments(written(part(0) * 1000))
    assert recorders._has_many_segments(written(part(0) * 1001))
    monkeypatch.setattr(recorders, "MANY_SEGMENTS", 3)
    assert not recorders._has_many_segments(written(part(5) * 3))
    assert recorders._has_many_segments(written(part(5) * 4))
    assert recorders._has_many_segments(written(part(5) + part(7, 1 << 6, "big") + part(0) + b"x"))
    assert not recorders._has_many_segments(written(part(5) + b"x" + part(7) * 3))
    assert not recorders._has_many_segments(written(part(5) + part(7, tag=b"TDSx") + part(0) * 3))
    assert not recorders._has_many_segments(written(part(5)[:20]))
    assert recorders.sniff_tdms(b"TDSm ")
    assert not recorders.sniff_tdms(b"TDSh ")


class Sized(SimpleNamespace):
    def __len__(self):
        return 3


def test_waveforms_of_tdms_have_grid_unit_and_clock_time():
    time = SimpleNamespace(seconds=24107 * 86400, second_fractions=2**62)
    properties = {
        "wf_increment": 0.5,
        "wf_start_offset": -3.0,
        "wf_xunit_string": "ms",
        "NI_UnitDescription": "g",
        "wf_start_time": time,
    }
    column = recorders._tdms_column(Sized(properties=properties, group_name="g", read_data=None), "g/a")
    assert (column.name, column.size, column.unit, column.step, column.start, column.folder) == (
        "g/a",
        3,
        "g",
        5e-4,
        -3e-3,
        "g/",
    )
    assert column.origin == 24107 * 86400 * PICO + PICO // 4
    still = recorders._tdms_column(
        Sized(properties={**properties, "wf_increment": 0.0, "unit_string": "V"}, group_name="g", read_data=None), "a"
    )
    np.testing.assert_equal((still.step, still.origin, still.unit), (NAN, None, "V"))
    plain = recorders._tdms_column(Sized(properties={"wf_increment": 0.5}, group_name="g", read_data=None), "a")
    np.testing.assert_equal((plain.step, plain.start, plain.origin), (0.5, NAN, None))


def test_clock_times_of_a_tdms_channel_begin_at_its_first():
    class Channel(Sized):
        def __getitem__(self, k):
            return SimpleNamespace(seconds=24107 * 86400 + 5 * k, second_fractions=2**63)

        def read_data(self):
            return SimpleNamespace(as_datetime64=lambda unit: f"read in {unit}")

    column = recorders._stamps(Channel(group_name="shots"), "shots/t")
    assert column.origin == 24107 * 86400 * PICO + PICO // 2
    assert (column.name, column.size, column.folder, column.time) == ("shots/t", 3, "shots/", True)
    assert column.load() == "read in ns"


def test_clock_times_of_tdms_before_1970_are_none():
    def of(seconds, fractions=0):
        return recorders._clock_time(SimpleNamespace(seconds=seconds, second_fractions=fractions))

    assert of(24107 * 86400 - 1) is None
    assert of(24107 * 86400, 2**64 - 1) == 24107 * 86400 * PICO + PICO - 1
    assert recorders._clock_time(SimpleNamespace(seconds=5e9)) is None
    assert recorders._clock_time(SimpleNamespace(second_fractions=5)) is None


@pytest.mark.parametrize(
    ("properties", "expected"),
    [
        ({}, True), ({"wf_xunit_string": "Hz"}, True), ({"wf_increment": 5.0, "wf_xunit_string": "Hz"}, False),
        ({"wf_increment": 0.0, "wf_xunit_string": "Hz"}, True), ({"wf_increment": 5.0, "wf_xunit_string": "s"}, True), ({"wf_increment": 5.0}, True),
    ],
)  # fmt: skip
def test_a_spectrum_of_tdms_is_not_over_time(properties, expected):
    assert recorders._is_over_time(SimpleNamespace(properties=properties)) is expected


# Universal files, MDF, IDE


def data_set(**how):
    said = {
        "func_type": 1,
        "data": np.arange(5.0),
        "abscissa_spacing": 1,
        "num_pts": 4,
        "abscissa_inc": 0.25,
        "abscissa_min": -3.0,
    }
    return {**said, "ordinate_axis_units_lab": "g", "ordinate_axis_lab": "bar", "x": np.arange(5.0), **how}


def test_a_time_response_has_its_samples_grid_and_unit():
    (column,) = recorders._response_columns(data_set(), 3)
    assert (column.name, column.size, column.load().tolist(), column.unit, column.step, column.start, column.folder) == (
        "bar", 4, [0.0, 1.0, 2.0, 3.0], "g", 0.25, -3.0, "3",
    )  # fmt: skip
    assert recorders._response_columns(data_set(num_pts=0), 3)[0].size == 5
    assert math.isnan(recorders._response_columns(data_set(abscissa_inc=0.0), 3)[0].step)
    both = recorders._response_columns(data_set(abscissa_spacing=0, abscissa_axis_units_lab="ms"), 3)
    assert [(c.name, c.size, c.unit, c.time, c.folder) for c in both] == [
        ("bar", 4, "g", False, "3"),
        ("time", 4, "ms", True, "3"),
    ]
    assert math.isnan(both[0].step)
    assert (
        recorders._response_columns(data_set(func_type=4), 3)
        == recorders._response_columns(data_set(data=np.array([1j])), 3)
        == recorders._response_columns(data_set(data=[]), 3)
        == []
    )


def test_names_of_data_sets_are_the_first_that_is_filled():
    assert recorders._name({"ordinate_axis_lab": "NONE", "rsp_ent_name": "null", "id1": "a blow"}, 3) == "a blow"
    assert recorders._name({"ordinate_axis_lab": "", "rsp_ent_name": "top", "id1": "a blow"}, 3) == "top"
    assert recorders._name({}, 3) == "channel 4"
    assert recorders.sniff_uff(b"    -1\n    58\n")
    assert not recorders.sniff_uff(b"     1\n    58\n")


class Conversion(SimpleNamespace):
    def convert(self, values, as_object):
        assert as_object is False
        return 2.0 * values + 3.0


def mdf_file(samples, conversion=None, version="4.10", masters=()):
    signal = SimpleNamespace(samples=np.asarray(samples), conversion=conversion, unit="g")
    return SimpleNamespace(get=lambda **_: signal, version=version, masters_db=dict(masters))


@pytest.mark.parametrize(
    ("version", "kind", "plain"),
    [
        ("4.10", 1, True),
        ("4.10", 3, False),
        ("3.30", 3, False),
        ("3.30", 65535, True),
        ("4.00", 65535, False),
        ("3.30", 9, True),
        ("4.10", 9, False),
    ],
)
def test_conversions_of_mdf_are_plain_or_left_out(version, kind, plain):
    raw = []
    (column,) = recorders._signal_columns(
        mdf_file([1, 2], Conversion(conversion_type=kind), version), 5, 2, SimpleNamespace(name="bar"), raw
    )
    assert (column.name, column.size, column.unit, column.folder, column.time) == ("bar", 2, "g", "5", False)
    assert column.load().tolist() == ([5.0, 7.0] if plain else [1, 2])
    assert raw == ([] if plain else ["bar"])


def test_channels_of_mdf_are_read_group_by_group(written, monkeypatch):
    """Two groups of two channels; one of words, and one whose conversion is no plain one."""
    samples = {(0, 0): [0.0, 0.5, 1.0], (0, 1): [3.0, 5.0, 7.0], (1, 0): ["a", "b", "c"], (1, 1): [1, 2, 4]}
    groups = [[SimpleNamespace(name=f"{g}{k}") for k in range(2)] for g in range(2)]

    class File(SimpleNamespace):
        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def get(self, group, index, raw, ignore_invalidation_bits):
            conversion = Conversion(conversion_type=7) if (group, index) == (1, 1) else None
            return SimpleNamespace(samples=np.array(samples[group, index]), conversion=conversion, unit="g")

    file = File(groups=[SimpleNamespace(channels=one) for one in groups], version="4.10", masters_db={0: 0})
    monkeypatch.setattr(recorders.common, "extra", lambda *_: SimpleNamespace(MDF=lambda *_, **how: file))
    monkeypatch.setattr(recorders.logging, "disable", lambda level: None)
    record = recorders.parse_mdf(written(b"MDF"), Options())
    assert next((c.name, c.values.tolist(), c.step) for c in record.channels) == ("01", [3.0, 5.0, 7.0], 0.5)
    assert record.channels[1].values.tolist() == [1.0, 2.0, 4.0]
    assert [(f.code, f.value) for f in record.findings] == [("array-ignored", 1), ("not-converted", 1)]
    assert "10" in record.findings[0].message
    assert "11" in record.findings[1].message
    monkeypatch.setattr(recorders.common, "MOST_ARRAYS", 3)
    assert len(recorders.parse_mdf(written(b"MDF"), Options()).channels) == 2
    monkeypatch.setattr(recorders.common, "MOST_ARRAYS", 2)
    with pytest.raises(InputError, match="at most 2 arrays"):
        recorders.parse_mdf(written(b"MDF"), Options())


def test_the_master_of_a_group_of_mdf_is_its_time():
    channel = SimpleNamespace(name="bar")
    assert recorders._signal_columns(mdf_file([1.0, 2.0], masters={5: 2}), 5, 2, channel, [])[0][0] == "time"
    assert not recorders._signal_columns(mdf_file([1.0, 2.0], masters={5: 3}), 5, 2, channel, [])[0].time
    for samples in (["a"], np.zeros((2, 2)), []):
        assert recorders._signal_columns(mdf_file(samples), 5, 2, channel, []) == []
    words = SimpleNamespace(convert=lambda values, as_object: np.array(["a", "b"]))
    assert recorders._physical(np.array([1, 2]), words).tolist() == [1, 2]
    assert recorders.sniff_mdf(b"MDF     3")
    assert recorders.sniff_mdf(b"UnFinMF ")
    assert not recorders.sniff_mdf(b"MDF    x")


def test_numbers_of_ide_are_fractions():
    assert [recorders._ratio(word) for word in ("1/8", "3", "2.5/5")] == [0.125, 3.0, 0.5]
    with pytest.raises(ValueError, match="os"):
        recorders._ratio("os.x")


def test_axes_of_ide_lie_over_microseconds(written, monkeypatch):
    class Events(SimpleNamespace):
        def __len__(self):
            return self.count

    def channel(count=3, axes=2):
        values = np.array([[0.0, 5.0, 10.0], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
        events = Events(count=count, arraySlice=lambda: values)
        names = [SimpleNamespace(displayName=name, units=("Acc", unit)) for name, unit in (("X", "g"), ("Y", "N"))]
        return SimpleNamespace(id=8, name="board", subchannels=(names * 3)[:axes], getSession=lambda: events)

    path = written(b"x")
    claimed = []
    monkeypatch.setattr(recorders.common, "guard", lambda path, size: claimed.append(size))
    columns = recorders._sensor_columns(path, channel())
    assert claimed == [8.0 * 3 * 3]  # time and two axes
    assert [(c.name, c.size, c.unit, c.folder, c.time, c.load().tolist()) for c in columns] == [
        ("time", 3, "s", "8", True, pytest.approx([0.0, 5e-6, 1e-5], rel=1e-15)), ("board/X", 3, "g", "8", False, [1.0, 2.0, 3.0]),
        ("board/Y", 3, "N", "8", False, [4.0, 5.0, 6.0]),
    ]  # fmt: skip
    assert recorders._sensor_columns(path, channel(count=0)) == []
    assert (
        len(recorders._sensor_columns(path, channel(count=2, axes=4))) == 3
    )  # eight samples of a byte; of axes without samples none
    with pytest.raises(InputError, match="channel board claims 3 samples"):
        recorders._sensor_columns(path, channel(count=3, axes=3))
    missing = channel()
    missing.subchannels[0] = None
    missing.subchannels[1].units = None
    assert [(c.name, c.unit) for c in recorders._sensor_columns(path, missing)] == [("time", "s"), ("board/Y", "")]
    assert recorders.sniff_ide(b"\x1aE\xdf\xa3" + bytes(120) + b"mide")
    assert not recorders.sniff_ide(b"\x1aE\xdf\xa3" + bytes(121) + b"mide")


# HDF5 and NetCDF


@pytest.mark.parametrize("at", [0, 512, 1024, 2048, 4096])
def test_hdf_may_begin_behind_a_block_of_the_user(at):
    signature = b"\x89HDF\r\n\x1a\n"
    assert containers.sniff_hdf(bytes(at) + signature)
    assert not containers.sniff_hdf(bytes(at + 1) + signature)


@pytest.fixture
def hdf_file(tmp_path):
    import h5py

    with h5py.File(tmp_path / "blow.h5", "w") as file:
        yield file


def hdf_read(file):
    """Read a copy of a file that is still being written."""
    file.flush()
    copy = Path(file.filename).with_suffix(".copy")
    shutil.copy(file.filename, copy)
    return containers.parse_hdf(copy, Options())


def test_grids_and_units_of_hdf_are_attributes_of_array_group_or_file(hdf_file):
    hdf_file.attrs["fs"] = 8.0
    hdf_file["a"] = [1.0, 2.0, 3.0]
    hdf_file["a"].attrs["Unit"] = "g"
    hdf_file["run/b"] = np.array([4.0, 5.0, 6.0])
    hdf_file["run"].attrs["dt"] = 0.5
    hdf_file["run/t0"] = 7.0
    hdf_file["own/c"] = [7.0, 8.0, 9.0]
    hdf_file["own/c"].attrs["dt"] = 0.25
    record = hdf_read(hdf_file)
    assert shown(record) == [
        ("a", "g", [1.0, 2.0, 3.0], 0.125, 0.0), ("own/c", "", [7.0, 8.0, 9.0], 0.25, 0.0), ("run/b", "", [4.0, 5.0, 6.0], 0.5, 7.0),
    ]  # fmt: skip


def test_groups_of_hdf_nest_up_to_sixteen_deep(hdf_file):
    import h5py

    hdf_file["a/" * 16 + "x"] = [1.0, 2.0]
    hdf_file["a/" * 17 + "y"] = [1.0, 2.0]
    hdf_file["#refs#/z"] = [1.0, 2.0]
    assert [(folder.count("/"), name) for folder, name, _ in containers._datasets(hdf_file, h5py)] == [(16, "x")]


def test_names_of_blocks_of_pandas_and_fields_of_tables(hdf_file, monkeypatch):
    hdf_file["df/block0_values"] = np.arange(6.0).reshape(3, 2)
    hdf_file["df/block0_items"] = np.array([b"bar", b"top"])
    hdf_file["df/block1_values"] = np.arange(6.0).reshape(3, 2)
    hdf_file["df/block1_items"] = [1, 2]
    hdf_file["df/block2_values"] = np.arange(6.0).reshape(3, 2)
    hdf_file["df/block2_items"] = np.array([b"bar"])
    table = np.zeros(3, [("index", "f8"), ("v", "f8", (2,)), ("word", "S3"), ("n", "i4"), ("deep", "f8", (2, 2))])
    table["index"], table["v"], table["n"] = [5.0, 7.0, 9.0], [[1, 4], [2, 5], [3, 6]], [7, 8, 9]
    hdf_file["run/table"] = table
    assert containers._block_names(hdf_file["df/block0_values"]) == ["bar", "top"]
    assert (
        containers._block_names(hdf_file["df/block1_values"])
        == containers._block_names(hdf_file["df/block0_items"])
        == []
    )
    record = hdf_read(hdf_file)
    assert [one[0] for one in shown(record)] == [
        "df/bar", "df/top", "df/block1_values 1", "df/block1_values 2", "df/block2_values 1", "df/block2_values 2", "run/table/v 1", "run/table/v 2",
        "run/table/n",
    ]  # fmt: skip
    assert shown(record)[7:] == [
        ("run/table/v 2", "", [4.0, 5.0, 6.0], 2.0, 5.0),
        ("run/table/n", "", [7.0, 8.0, 9.0], 2.0, 5.0),
    ]
    monkeypatch.setattr(containers.common, "MOST_COLUMNS", 1)
    assert containers._block_names(hdf_file["df/block0_values"]) == []
    assert [c.name for c in containers._fields("run/", "table", hdf_file["run/table"])] == ["run/table/index"]
    monkeypatch.setattr(containers.common, "MOST_COLUMNS", 2)
    assert containers._block_names(hdf_file["df/block0_values"]) == ["bar", "top"]
    hdf_file["df/block3_values"] = np.zeros((3, 2))
    hdf_file.create_group("df/block3_items")
    assert containers._block_names(hdf_file["df/block3_values"]) == []  # no data set


def test_what_is_no_channel_of_hdf(hdf_file, monkeypatch):
    hdf_file["text"] = np.full((4, 1), 65, np.uint16)
    hdf_file["text"].attrs["MATLAB_class"] = np.bytes_("char")
    for name in ("node", "time"):
        hdf_file[name] = [1.0, 2.0, 3.0]
        hdf_file[name].make_scale()
    hdf_file["df/axis1"] = [3.0, 5.0, 7.0]
    hdf_file["df/v"] = [1.0, 2.0, 3.0]
    hdf_file["empty"] = np.zeros(0)
    hdf_file["bar"] = [1.0, 2.0, 3.0]
    record = hdf_read(hdf_file)
    assert [(c.name, c.step, c.start) for c in record.channels] == [("bar", 1.0, 1.0), ("df/v", 2.0, 3.0)]
    assert "empty, node, text" in record.findings[0].message
    monkeypatch.setattr(containers.common, "MOST_ARRAYS", 6)
    with pytest.raises(InputError, match="at most 6 arrays"):
        hdf_read(hdf_file)
    monkeypatch.setattr(containers.common, "MOST_ARRAYS", 7)
    assert len(hdf_read(hdf_file).channels) == 2
    monkeypatch.setattr(containers, "MOST_ATTRIBUTES", 1)
    for k in range(3):
        hdf_file["bar"].attrs[f"a{k}"] = k
    assert [name for name, _ in containers._attributes(hdf_file["bar"])] == ["a0"]


@pytest.mark.parametrize("own", [False, True])
def test_classic_netcdf_has_scales_grids_and_scalars(tmp_path, own):
    """A step of its own goes before that of the file, and what has none is then left out."""
    from scipy.io import netcdf_file

    with netcdf_file(tmp_path / "a.nc", "w") as file:
        file.createDimension("n", 3)
        for name, kind, values in (("bar", "h", [1, 2, 3]), ("top", "d", [4.0, 5.0, 6.0]), ("word", "c", [b"a"] * 3)):
            file.createVariable(name, kind, ("n",))[:] = values
        file.variables["bar"].scale_factor, file.variables["bar"].unit = 0.5, "g"
        if own:
            file.variables["top"].dt = 0.25
        file.variables["top"].units = "N"
        file.createVariable("fs", "d", ()).data[...] = 8.0
        file.t0 = 7.0
    top = ("top", "N", [4.0, 5.0, 6.0], 0.25 if own else 0.125, 7.0)
    expected = [top] if own else [("bar", "g", [0.5, 1.0, 1.5], 0.125, 7.0), top]
    assert shown(containers.read_netcdf(tmp_path / "a.nc", Options())) == expected
    assert containers.sniff_netcdf(b"CDF\x02")
    assert not containers.sniff_netcdf(b"CDF\x05")


# What a file claims


def test_readers_claim_the_bytes_that_a_file_promises(tmp_path, monkeypatch, hdf_file):
    claimed = []
    monkeypatch.setattr(common, "guard", lambda path, size, compressed=True: claimed.append((size, compressed)))
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(str(tmp_path / "a.tdms")) as file:
        file.write_segment(
            [nptdms.ChannelObject("g", "a", np.arange(9.0)), nptdms.ChannelObject("g", "b", np.arange(7, dtype="i2"))]
        )
    recorders.parse_tdms(tmp_path / "a.tdms", Options())
    assert claimed[:2] == [(72, False), (14, False)]  # then what all channels take in memory
    claimed.clear()
    hdf_file.create_dataset("a", data=np.zeros((5, 6), "f4"), chunks=(2, 3))
    containers._columns(tmp_path, "", "a", hdf_file["a"])
    assert claimed == [(24.0, True)]


def test_more_arrays_than_the_most_of_other_formats_are_refused(tmp_path, monkeypatch):
    import pyuff

    pyuff.UFF(str(tmp_path / "a.uff")).write_sets([uff_set(0, label="a"), uff_set(0, label="b")], "overwrite")
    monkeypatch.setattr(recorders.common, "MOST_ARRAYS", 2)
    assert [c.name for c in recorders.read_uff(tmp_path / "a.uff", Options()).channels] == ["a", "b"]
    monkeypatch.setattr(recorders.common, "MOST_ARRAYS", 1)
    with pytest.raises(InputError, match="it has 2"):
        recorders.read_uff(tmp_path / "a.uff", Options())


# Parquet


@pytest.mark.parametrize("batch", [1, 4, 7, 100])
def test_parquet_is_read_batch_by_batch(tmp_path, monkeypatch, batch):
    import pyarrow as pa
    import pyarrow.parquet as pq

    monkeypatch.setattr(tables, "_BATCH", batch)
    n = 34
    times = (np.arange(n) * 500).astype("M8[us]")
    fields = [
        pa.field("time", pa.timestamp("us")),
        pa.field("bar", pa.float64(), metadata={"Units": "g"}),
        pa.field("on", pa.bool_()),
    ]
    fields += [pa.field("sensor", pa.dictionary(pa.int8(), pa.string())), pa.field("list", pa.list_(pa.int8()))]
    words = pa.array(["top", "bar"] * 17).dictionary_encode()
    columns = [
        pa.array(times),
        np.arange(n) * 2.0,
        pa.array([k % 3 == 0 for k in range(n)]),
        words,
        pa.array([[1]] * n),
    ]
    pq.write_table(pa.table(columns, schema=pa.schema(fields)), tmp_path / "a.parquet", row_group_size=10)
    record = tables.read_parquet(tmp_path / "a.parquet", Options())
    assert [(c.name, c.unit, c.values[:3].tolist(), c.step) for c in record.channels] == [
        ("top bar", "g", [0.0, 4.0, 8.0], 1e-3), ("top on", "", [1.0, 0.0, 0.0], 1e-3), ("bar bar", "g", [2.0, 6.0, 10.0], 1e-3),
        ("bar on", "", [0.0, 1.0, 0.0], 1e-3),
    ]  # fmt: skip
    assert record.channels[0].values.size == 17


def test_parquet_states_its_grid_in_short_metadata(tmp_path, monkeypatch):
    import pyarrow as pa
    import pyarrow.parquet as pq

    said = {b"fs": b"8", b"T0": b"3".ljust(199), b"dt": b"5".ljust(200)}
    table = pa.table({"a": [1.0, None, 3.0], "w": ["x", "y", "z"]}).replace_schema_metadata(said)
    pq.write_table(table, tmp_path / "a.parquet")
    channel = tables.read_parquet(tmp_path / "a.parquet", Options()).channels[0]
    np.testing.assert_equal((channel.values, channel.step, channel.start), ([1.0, NAN, 3.0], 0.125, 3.0))
    monkeypatch.setattr(tables, "MOST_LABELS", 3)
    with pq.ParquetFile(tmp_path / "a.parquet") as file:
        assert tables._words_of(file, "w") == {"x": 0, "y": 1, "z": 2}
        assert tables._coded(file, "w", {"y": 1, "z": 2})().tolist()[1:] == [1.0, 2.0]
        monkeypatch.setattr(tables, "MOST_LABELS", 2)
        assert tables._words_of(file, "w") == {}


# Excel


def sheet(*rows, left=10**6):
    columns, cells = tables._columns("a.xlsx", rows, left)
    return [(c.name, c.unit, c.load().tolist(), c.words) for c in columns], cells


def test_columns_of_a_sheet_end_with_its_last_number():
    rows = [("t [s]", "bar", None), (0.0, 1, None), (0.5, None, 7), (1.0, 3), (None, None, None), ("end",)]
    (first, second, third), cells = sheet(*rows)
    assert first == ("t", "s", [0.0, 0.5, 1.0], ())
    np.testing.assert_equal(second[2], [1.0, NAN, 3.0])
    np.testing.assert_equal(third, ("column 3", "", [NAN, 7.0, NAN], ()))
    assert cells == 4 + 4 + 4 + 3 + 4 + 2
    assert sheet(("bar [g]",), (None, "a remark"), (3.0,), (5.0,))[0] == [("bar", "g", [3.0, 5.0], ())]


def test_the_first_hundred_letters_of_a_cell_name_a_setting_and_the_last_two_hundred_rows_of_a_head_are_kept():
    for blanks, step in ((89, 5e-4), (90, NAN)):
        rows = [("name", "bar"), ("delta t" + " " * blanks + "[ms]", 0.5), (None, 3.0), (None, 5.0)]
        ((column, *_),) = [tables._columns("a.xlsx", rows, 99)[0]]
        np.testing.assert_equal((len(rows[1][0]), column.step), (blanks + 11, step))
    for more, first in ((199, "first"), (200, "x")):
        above, lines = tables._begin([("first",), *[("x",)] * more, (1.0,)])
        assert (len(above), above[0], list(lines)) == (200, (first,), [(1.0,)])


def test_sheets_of_more_rows_or_cells_than_the_most_are_refused(monkeypatch):
    rows = [(1.0, 2.0)] * 4
    assert sheet(*rows, left=12)[1] == 12
    with pytest.raises(InputError, match="more than 3 rows"):
        sheet(*rows, left=11)
    monkeypatch.setattr(tables, "MOST_ROWS", 4)
    sheet(*rows)
    monkeypatch.setattr(tables, "MOST_ROWS", 3)
    with pytest.raises(InputError, match="more than 3 rows"):
        sheet(*rows)


def test_words_beside_numbers_become_labels_where_most_lines_have_one():
    rows = [("sensor", "v"), ("bar", 1.0), (" top ", 2.0), ("bar", 3.0), (None, 4.0), ("", 5.0)]
    found, _ = sheet(*rows)
    assert (found[1][0], found[1][3]) == ("sensor", ("bar", "top"))
    np.testing.assert_equal(found[1][2], [0.0, 1.0, 0.0, NAN, NAN])
    assert len(sheet(*rows, (None, 6.0))[0]) == 1  # half of them
    assert len(sheet(("sensor", "v"), ("bar", 1.0), ("top", 2.0), (7.0, 3.0))[0]) == 2


def test_rows_of_numbers_behind_a_name_are_of_the_head():
    head = [("name", "bar"), ("delta t", 0.5), ("offset", 3.0)]
    above, lines = tables._begin([*head, (None, 1.0), (None, 2.0)])
    assert (above, list(lines)) == (head, [(None, 1.0), (None, 2.0)])
    above, lines = tables._begin([*head, ("bar", 1.0), ("top", 2.0), ("bar", 3.0)])  # the name comes again
    assert (above, list(lines)) == (head, [("bar", 1.0), ("top", 2.0), ("bar", 3.0)])
    above, lines = tables._begin([*head[:2], ("what",), (5, 6)])
    assert (above, list(lines)) == ([*head[:2], ("what",)], [(5, 6)])
    above, lines = tables._begin([("a", 1.0), ("b", 2.0)])
    assert (above, list(lines)) == ([], [("a", 1.0), ("b", 2.0)])
    above, lines = tables._begin([(), ("x",), (" ", 4.0)])
    assert (above, list(lines)) == ([(), ("x",)], [(" ", 4.0)])


def test_a_head_of_more_rows_than_the_most_is_cut(monkeypatch):
    monkeypatch.setattr(tables, "LONGEST_HEAD", 3)
    above, lines = tables._begin([*[(f"{k}",) for k in range(5)], (1.0,)])
    assert (above, list(lines)) == ([("2",), ("3",), ("4",)], [(1.0,)])
    above, lines = tables._begin([(chr(97 + k), 1.0) for k in range(5)])
    assert (above, len(list(lines))) == ([], 5)


@pytest.mark.parametrize(
    ("row", "expected"),
    [
        ((1.0, "a"), True),
        ((1.0, "a", "b"), False),
        ((None, 1), True),
        ((), False),
        ((None,), False),
        (("a",), False),
        ((math.inf, True), True),
    ],
)
def test_a_row_of_numbers_has_as_many_as_words(row, expected):
    assert tables._numeric(row) is expected
    assert math.isnan(tables._number(10**400))


def test_names_and_units_stand_in_the_last_rows_of_text():
    def names(*rows, places=(0, 1, 2)):
        return tables._names(list(rows), 3, places)

    assert names(("t [s]", "bar/g")) == [("t", "s"), ("bar", "g"), ("", "")]
    assert names(("x", "y", "z"), ("t [s]", "bar", "top"), ("ms", "[g]", None)) == [
        ("t", "ms"),
        ("bar", "g"),
        ("top", ""),
    ]
    assert names(("t", "bar", "top"), ("a", "b", "c")) == [("a", ""), ("b", ""), ("c", "")]
    assert names(("t", "bar", "top"), ("s", "g", "what"), places=(0, 1)) == [("t", "s"), ("bar", "g"), ("top", "")]
    assert names(("t", "bar", "top"), ("s", "g", "what")) == [("s", ""), ("g", ""), ("what", "")]
    assert names(("t", "bar", "top"), ("delta t", "x", None), (None, None), (1.0, "a", "b")) == [
        ("t", ""),
        ("bar", ""),
        ("top", ""),
    ]
    assert names() == [("", "")] * 3
    assert names(("s", "g", "N")) == [("s", ""), ("g", ""), ("N", "")]


def test_few_numbers_beside_long_columns_are_settings():
    def column(name, count, size=40, folder=""):
        values = np.full(size, NAN)
        values[:count] = 1.0
        return ArrayColumn(name, size, lambda: values, folder=folder)

    kept, left = tables._without_settings(
        [column("a", 32), column("b", 16), column("c", 15), column("d", 3, folder="x/"), column("e", 0, 0)]
    )
    assert ([c.name for c in kept], left) == (["a", "b", "d"], ["c"])
    kept, left = tables._without_settings([column("a", 31), column("c", 15)])
    assert ([c.name for c in kept], left) == (["a", "c"], [])


def test_rows_below_the_last_number_of_any_column_are_left_out():
    columns = [
        ArrayColumn("a", 5, lambda: np.array([1.0, 2.0, NAN, NAN, NAN])),
        ArrayColumn("b", 5, lambda: np.array([NAN, 5.0, NAN, 6.0, NAN])),
    ]
    first, second = tables._trimmed(columns)
    assert (first.name, first.size, second.name, second.size) == ("a", 4, "b", 4)
    np.testing.assert_equal(first.load(), [1.0, 2.0, NAN, NAN])
    np.testing.assert_equal(second.load(), [NAN, 5.0, NAN, 6.0])
    assert tables._trimmed([]) == []


def test_settings_of_a_sheet_give_step_start_and_origin():
    rows = [
        ("waveform", "bar [g]", "top"),
        ("t0", "10:00:00", "10:00:03"),
        ("delta t [ms]", 0.5, 0.25),
        ("start [ms]", 4.0, 5.0),
    ]
    columns, _ = tables._columns("a.xlsx", [*rows, *[(None, 1.0, 2.0)] * 3], 10**6)
    assert [(c.name, c.unit, c.step, c.start) for c in columns] == [("bar", "g", 5e-4, 4e-3), ("top", "", 2.5e-4, 5e-3)]
    assert columns[1].origin - columns[0].origin == 3 * PICO
    assert tables.sniff_excel(b"PK\x03\x04....docProps/")
    assert not tables.sniff_excel(b"PK\x03\x04....mimetype")
    assert not tables.sniff_excel(b"PK\x05\x06xl/")


def test_a_workbook_is_read_up_to_so_many_sheets_and_cells(tmp_path, monkeypatch):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for sheet_ in (book.active, book.create_sheet("b")):
        for row in [("t", "v"), *[(k, 2.0 * k) for k in range(3)]]:
            sheet_.append(row)
    book.save(tmp_path / "a.xlsx")
    assert [c.name for c in tables.read_excel(tmp_path / "a.xlsx", Options()).channels] == ["Sheet/v", "b/v"]
    monkeypatch.setattr(tables, "MOST_CELLS", 24)
    assert len(tables.read_excel(tmp_path / "a.xlsx", Options()).channels) == 2
    monkeypatch.setattr(tables, "MOST_CELLS", 23)
    with pytest.raises(InputError, match="more than 3 rows"):
        tables.read_excel(tmp_path / "a.xlsx", Options())
    monkeypatch.setattr(tables, "MOST_SHEETS", 1)
    assert [c.name for c in tables.read_excel(tmp_path / "a.xlsx", Options()).channels] == ["v"]
