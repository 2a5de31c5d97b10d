"""The file of a test report: what it takes, what it refuses, photographs, calibrations that lapsed."""

import io
import json
import struct
import tomllib
import zlib

import pytest
from PIL import Image, ImageFile

from strikewave.base.errors import InputError
from strikewave.cases.performed_test import (
    LONGEST_SIDE,
    MOST_PHOTOGRAPHS,
    ReportTables,
    StatedTest,
    example_file,
    load_test,
)

WHOLE = """
item = "board 7"
date = "2026-03-02"
[report]
number = "TR-1"
statements = ["One.", "Two."]
[customer]
name = "B. Buyer"
[[specimen]]
name = "board"
serial_number = "7"
[[specimen]]
[setup]
fixture = "plate"
[[setup.photograph]]
file = "pictures/plate.png"
caption = "The plate."
[environment]
temperature = "23 °C"
[[equipment]]
name = "accelerometer"
calibrated = 2025-05-01
calibration_due = "2026-05-01"
[[signature]]
role = "tested by"
"""


def picture(kind="PNG", size=(40, 20), **more):
    found = io.BytesIO()
    Image.new("RGB", size, "red").save(found, kind, **more)
    return found.getvalue()


def written(folder, text, **files):
    for name, data in files.items():
        (folder / name).write_bytes(data)
    file = folder / "test.toml"
    file.write_text(text, "utf-8")
    return file


def bomb(width, height):
    """Return a small PNG that claims to be huge."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"IDAT", zlib.compress(bytes(1000))), (b"IEND", b"")]
    body = b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + body


def test_a_whole_file_is_read_and_stated_again_without_what_is_empty(tmp_path):
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "plate.png").write_bytes(picture())
    found = load_test(written(tmp_path, WHOLE))
    stated = found.stated()
    assert list(stated) == ["item", "date", "report", "customer", "specimen", "setup", "environment", "equipment",
                            "signature"]  # fmt: skip
    assert stated["specimen"] == [{"name": "board", "serial_number": "7"}]
    assert stated["equipment"][0]["calibrated"] == "2025-05-01"
    assert stated["report"] == {"number": "TR-1", "statements": ["One.", "Two."]}
    assert len(stated["setup"]["photograph"][0]["sha256"]) == 64
    assert found.photographs[0].caption == "The plate."


def test_the_file_to_fill_in_has_every_key_and_states_nothing_until_it_is_filled_in(strikewave, tmp_path):
    assert strikewave("new", "mine.toml", "--from", "test")[0] == 0
    text = (tmp_path / "mine.toml").read_text()
    assert text == example_file()
    document = tomllib.loads(text)
    for name, model in ReportTables.model_fields.items():
        table = document[name][0] if isinstance(document[name], list) else document[name]
        inner = model.annotation if hasattr(model.annotation, "model_fields") else model.annotation.__args__[0]
        assert list(table) == list(inner.model_fields), name
    with pytest.raises(InputError, match="a file with one of item"):
        load_test(tmp_path / "mine.toml")
    (tmp_path / "mine.toml").write_text(text.replace('item = ""', 'item = "board 7"'))
    assert load_test(tmp_path / "mine.toml").stated() == {"item": "board 7"}
    assert strikewave("new", "mine.toml", "--from", "test")[0] == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[custmer]\nname = "a"', 'custmer: unknown key'),
        ('[customer]\nnmae = "a"', 'customer.nmae: unknown key; did you mean "name"?'),
        ("customer = 3", "customer: got 3"),
        ('[equipment]\nname = "a"', "write [[equipment]], once for each"),
        ("equipment = 7", "equipment: got 7"),
        ('[[equipment]]\ncalibrated = "yesterday"', "equipment.0.calibrated: got"),
        ('[[equipment]]\ncalibrated = "2026-01-01"\ncalibration_due = "2025-01-01"', "a day from 2026-01-01 on"),
        ("[[specimen]]\nserial_number = 7", 'write it in quotes: "7"'),
        ('[report]\nnumber = "a\\u0000b"', "U+0000"),
        ('[report]\nnumber = "a\\nb"', "U+000A"),
        ('[report]\nstatements = "one"', "statements"),
        (f'[report]\nremarks = "{"x" * 2001}"', "at most 2000 characters"),
        (f"[report]\nstatements = {['x'] * 21}", "at most 20 items"),
        ("[[setup.photograph]]\nfile = 'p.png'\n" * (MOST_PHOTOGRAPHS + 1), f"at most {MOST_PHOTOGRAPHS} items"),
        ("[[signature]]\nrole = 'x'\n" * 101, "at most 100 items"),
        ("# " + "x" * 100_001, "a file of at most 100 kB"),
        ("[[setup.photograph]]\nfile = 'absent.png'", "no such file: absent.png"),
        ("[[setup.photograph]]\nfile = '../outside.png'", "a file beside the test file"),
        ("[[setup.photograph]]\nfile = '/etc/passwd'", "a file beside the test file"),
        ('[[setup.photograph]]\nfile = "."', "no such file"),
        ("[[setup.photograph]]\nfile = 'words.png'", "a PNG or JPEG picture"),
        ("[[setup.photograph]]\nfile = 'moving.png'", "a PNG or JPEG picture"),
        ("[[setup.photograph]]\nfile = 'cut.jpg'", "a PNG or JPEG picture"),
        ("[[setup.photograph]]\nfile = 'bomb.png'", "at most 50 million pixels"),
        ("[[setup.photograph]]\nfile = 'large.png'", "at most 50 million pixels; this one has 9000 by 9000"),
        ("[[setup.photograph]]\nfile = 'false.png'", "a PNG or JPEG picture"),
        ("[[setup.photograph]]\nfile = 'link.png'", "a file beside the test file"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_one_line_that_names_the_option_and_the_key(monkeypatch, tmp_path, text, words):
    monkeypatch.setattr(ImageFile, "LOAD_TRUNCATED_IMAGES", True)  # as WeasyPrint sets it
    folder = tmp_path / "inner"
    folder.mkdir()
    (tmp_path / "outside.png").write_bytes(picture())
    (folder / "link.png").symlink_to(tmp_path / "outside.png")
    (folder / "words.png").write_text("<script>alert(1)</script>")
    (folder / "moving.png").write_bytes(picture("GIF"))
    (folder / "cut.jpg").write_bytes(picture("JPEG", (400, 400))[:900])
    (folder / "bomb.png").write_bytes(bomb(60_000, 60_000))
    (folder / "large.png").write_bytes(bomb(9_000, 9_000))
    (folder / "false.png").write_bytes(bomb(5_000, 5_000))
    with pytest.raises(InputError) as caught:
        load_test(written(folder, text))
    assert words in str(caught.value)
    assert str(caught.value).startswith("--test")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_a_photograph_is_drawn_anew_small_and_without_what_else_its_file_holds(tmp_path, kind):
    exif = Image.Exif()
    exif[0x010E] = "secret place"
    exif[0x0112] = 6  # lies on its side
    data = picture(kind, (4 * LONGEST_SIDE, LONGEST_SIDE), exif=exif) + b"<script>"
    found = load_test(written(tmp_path, "[[setup.photograph]]\nfile = 'p'", p=data)).photographs[0]
    with Image.open(io.BytesIO(found.jpeg)) as image:
        assert image.format == "JPEG"
        assert image.size == (LONGEST_SIDE // 4, LONGEST_SIDE)  # upright, and as small as said
    assert b"secret" not in found.jpeg
    assert b"script" not in found.jpeg


def test_a_transparent_drawing_stands_on_white(tmp_path):
    data = io.BytesIO()
    Image.new("RGBA", (8, 8), (0, 0, 0, 0)).save(data, "PNG")
    found = load_test(written(tmp_path, "[[setup.photograph]]\nfile = 'p.png'", **{"p.png": data.getvalue()}))
    with Image.open(io.BytesIO(found.photographs[0].jpeg)) as image:
        assert min(image.getpixel((4, 4))) > 250


@pytest.mark.parametrize(
    ("date", "last", "calibrated", "due", "lapsed"),
    [
        ("2026-03-02", "", "2025-03-02", "2026-03-02", False),  # due on the day itself
        ("2026-03-02", "", "2025-03-02", "2026-03-01", True),
        ("2026-03-02", "2026-03-05", "2025-03-02", "2026-03-04", True),  # lapsed while the test lasted
        ("2026-03-02", "", "2026-03-02", "", False),
        ("2026-03-02", "", "2026-03-03", "2027-03-03", True),  # calibrated only after it
        ("", "", "2025-03-02", "2026-03-01", False),  # no day, nothing to say
    ],
)
def test_a_calibration_holds_from_its_day_to_the_day_on_which_it_is_due(date, last, calibrated, due, lapsed):
    row = {"name": "amplifier", "calibrated": calibrated, "calibration_due": due}
    tables = ReportTables(report={"last_day": last}, equipment=[row])
    found = StatedTest(StatedTest().test.model_copy(update={"date": date}), tables)
    assert bool(found.lapses) is lapsed
    assert [notice.code for notice in found.notices()] == ["calibration-overdue"] * lapsed


@pytest.mark.verify
def test_a_measured_file_carries_all_tables_of_its_test_and_warns_of_a_lapsed_calibration(strikewave, tmp_path):
    rows = [f"{1e-5 * k:.6f},{1000.0 if 40 < k < 60 else 0.0}" for k in range(400)]
    (tmp_path / "shot.csv").write_text("\n".join(["time (s),a (g)", *rows]))
    text = WHOLE.replace('"2026-05-01"', '"2026-01-01"').replace('file = "pictures/plate.png"', "")
    test = written(tmp_path, text)
    code, shown, _ = strikewave("record", "shot.csv", "--test", test, "--json", "--out", "out", "--xlsx")
    document = json.loads(shown)
    assert code == 0
    assert document["test"] == load_test(test).stated()
    assert "calibration-overdue" in [one["code"] for one in document["warnings"]]
    assert tomllib.loads((tmp_path / "out" / "record.toml").read_text())["test"] == document["test"]


def test_a_case_takes_the_table_test_alone(strikewave, tmp_path):
    test = written(tmp_path, WHOLE.replace('file = "pictures/plate.png"', ""))
    code, shown, _ = strikewave("wave", "--no-band", "li-ma-2019-fig13-bar", "--test", test, "--json")
    assert code == 0
    assert json.loads(shown)["test"] == {"item": "board 7", "date": "2026-03-02"}
