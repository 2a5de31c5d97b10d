"""The file of a test: [test], and the further tables of a test report of a laboratory. It changes no result.

Photographs that it names are decoded, made small and written anew, so that nothing of a file goes into a page as it is.
"""

from __future__ import annotations

import base64
import hashlib
import io
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Self, get_args, get_origin

from pydantic import BaseModel, BeforeValidator, Field, model_validator

from strikewave.base.errors import EXISTING_FILE, InputError
from strikewave.base.result import WARNING, Notice
from strikewave.cases.files import read_small_file
from strikewave.cases.paths import Form
from strikewave.cases.tables.common import CaseTable, PerformedTest, date_text, line_text, notes_text

MOST_ROWS, MOST_PHOTOGRAPHS, MOST_LINES = 100, 12, 20
"""Rows of equipment, specimens or signatures; photographs; statements."""


def _line(about: str) -> Any:
    return Field("", description=about)


Line = Annotated[str, BeforeValidator(line_text)]
Notes = Annotated[str, BeforeValidator(notes_text)]
Date = Annotated[str, BeforeValidator(date_text)]


class ReportTable(CaseTable):
    """[report]: the report itself, and the laboratory that signs it."""

    number: Line = _line("unique number of the report")
    issued: Date = _line("date of issue")
    last_day: Date = _line("last day of the test, where it took several; its first is the date of [test]")
    laboratory_address: Line = _line("address of the laboratory")
    laboratory_contact: Line = _line("telephone or mail of the laboratory")
    accreditation: Line = _line("accreditation, with its number")
    location: Line = _line("where the test was done, if not there")
    deviations: Notes = _line("additions to, deviations and exclusions from the method; none, if there were none")
    remarks: Notes = _line("what else the reader should know")
    statements: Annotated[
        tuple[Line, ...], Field(max_length=MOST_LINES, description="further sentences above the signatures")
    ] = ()


class CustomerTable(CaseTable):
    """[customer]: who asked for the test."""

    name: Line = _line("name of the customer")
    address: Line = _line("address")
    contact: Line = _line("person, telephone or mail")


class EnvironmentTable(CaseTable):
    """[environment]: the surroundings during the test."""

    temperature: Line = _line("such as 23 °C ± 2 °C")
    humidity: Line = _line("such as 45 % ± 10 %")
    pressure: Line = _line("such as 100 kPa")


class PhotographTable(CaseTable):
    """[[setup.photograph]]: a PNG or JPEG file beside this file, or in a folder below it."""

    file: Line = _line("name of the file")
    caption: Line = _line("what it shows")


class SetupTable(CaseTable):
    """[setup]: how the item was struck and measured."""

    machine: Line = _line("shock machine")
    programmer: Line = _line("pulse shaper, such as 6 mm of felt")
    fixture: Line = _line("fixture")
    mounting: Line = _line("how the item was mounted")
    torque: Line = _line("tightening torque of its screws")
    accelerometer_position: Line = _line("where the accelerometer was")
    accelerometer_mounting: Line = _line("stud, adhesive, wax")
    operation: Line = _line("whether the item was in operation, and what was monitored")
    photograph: Annotated[tuple[PhotographTable, ...], Field(max_length=MOST_PHOTOGRAPHS)] = ()


class TestedItemTable(CaseTable):
    """[[specimen]]: an item under test; once for each."""

    name: Line = _line("what it is")
    model: Line = _line("type, part number, state of hardware and software")
    serial_number: Line = _line("serial number, or what else tells it from others")
    received: Date = _line("date of receipt")
    condition: Line = _line("condition before the test")
    result: Line = _line("what its inspection or function test after it found")


class EquipmentTable(CaseTable):
    """[[equipment]]: an instrument; once for each."""

    name: Line = _line("what it is, such as accelerometer")
    model: Line = _line("maker and model")
    serial_number: Line = _line("serial or inventory number")
    calibrated: Date = _line("date of calibration")
    calibration_due: Date = _line("last day on which that holds")
    certificate: Line = _line("number of the certificate, and who issued it")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.calibrated and self.calibration_due and self.calibration_due < self.calibrated:
            raise InputError("calibration_due", self.calibration_due, f"a day from {self.calibrated} on")
        return self

    @property
    def called(self) -> str:
        """Name of the instrument in a sentence."""
        return " ".join(part for part in (self.name or "instrument", self.model, self.serial_number) if part)


class SignatureTable(CaseTable):
    """[[signature]]: a line to sign; once for each."""

    role: Line = _line("such as tested by, authorized by")
    name: Line = _line("name and function")


class ReportTables(CaseTable):
    """The tables of a file of a test beside [test]."""

    report: ReportTable = ReportTable()
    customer: CustomerTable = CustomerTable()
    specimen: Annotated[tuple[TestedItemTable, ...], Field(max_length=MOST_ROWS)] = ()
    setup: SetupTable = SetupTable()
    environment: EnvironmentTable = EnvironmentTable()
    equipment: Annotated[tuple[EquipmentTable, ...], Field(max_length=MOST_ROWS)] = ()
    signature: Annotated[tuple[SignatureTable, ...], Field(max_length=MOST_ROWS)] = ()


class Lapse(NamedTuple):
    """An instrument whose calibration does not hold on a day of the test, with the reason."""

    instrument: str
    why: str


@dataclass(frozen=True)
class StatedTest:
    """A test as stated in a file: the table [test], the others, and the photographs of the set-up."""

    test: PerformedTest = field(default_factory=PerformedTest)
    tables: ReportTables = field(default_factory=ReportTables)
    photographs: tuple[Photograph, ...] = ()
    file: str = ""

    def stated(self) -> dict[str, Any]:
        """Return the stated entries: the keys of [test], then the other tables by their names.

        Examples
        --------
        >>> StatedTest(PerformedTest(item="board 7"), ReportTables(customer={"name": "B. Buyer"})).stated()
        {'item': 'board 7', 'customer': {'name': 'B. Buyer'}}
        """
        stated, digests = {**self.test.stated(), **_given(self.tables)}, {x.file: x.digest for x in self.photographs}
        for row in stated.get("setup", {}).get("photograph", []):
            row["sha256"] = digests.get(row.get("file"), "")
        return stated

    @property
    def last_day(self) -> str:
        """The last day of the test as ISO 8601 has it; empty where none is stated."""
        return self.tables.report.last_day or self.test.date

    @property
    def lapses(self) -> list[Lapse]:
        """The instruments whose calibration does not hold on all days of the test."""
        first, last, lapses = self.test.date or self.last_day, self.last_day, list[Lapse]()
        for row in self.tables.equipment:
            if last and row.calibration_due and row.calibration_due < last:
                why = f"calibration was due on {row.calibration_due}, the test was on {last}"
                lapses.append(Lapse(row.called, why))
            elif first and row.calibrated and row.calibrated > first:
                lapses.append(Lapse(row.called, f"was calibrated on {row.calibrated}, after the test on {first}"))
        return lapses

    def notices(self) -> list[Notice]:
        """Return a warning for each calibration that does not hold."""
        return [Notice("calibration-overdue", f"{lapse[0]}: {lapse[1]}", severity=WARNING) for lapse in self.lapses]


NO_TEST = StatedTest()
"""Test of which nothing is stated."""


def _given(part: Any) -> Any:
    """Return the entries of a table, without empty ones."""
    if isinstance(part, tuple):
        return [entry for row in part if (entry := _given(row))]
    return {key: entry for key, row in part if (entry := _given(row))} if isinstance(part, CaseTable) else part


TEST_FORM = Form(PerformedTest, "test", 'item="board 7"')
TABLES_FORM = Form(ReportTables, "test", 'report.number="2026-117"')


def load_test(file: Path, option: str = "--test") -> StatedTest:
    """Read a test from a TOML file: a [test] table, or its keys alone, and tables of a test report."""
    document = read_small_file(file, option, 'a TOML file with [test], such as item = "board 7"')
    table = document.pop("test", {})
    if not isinstance(table, dict):
        raise InputError(option, table, "a table [test]")
    tables = {key: document.pop(key) for key in ReportTables.model_fields if key in document}
    test = TEST_FORM.read({**document, **table}, f"{option} ")
    more = TABLES_FORM.read(tables, f"{option} ")
    lists = {key: rows for key, rows in more if isinstance(rows, tuple)}  # rows in which nothing is filled in go
    more = more.model_copy(update={key: tuple(filter(_given, rows)) for key, rows in lists.items()})
    photographs = [
        read_photograph(file.parent, row.file, row.caption, f"{option} setup.photograph")
        for row in more.setup.photograph
        if row.file
    ]
    stated = StatedTest(test, more, tuple(photographs), str(file))
    if not stated.stated():
        raise InputError(option, file, "a file with one of " + ", ".join(PerformedTest.model_fields))
    return stated


def example_file() -> str:
    """Return a test file to fill in: every table and key, each with its explanation.

    Examples
    --------
    >>> example_file().splitlines()[3:5]
    ['[test]', 'item = ""  # what was tested']
    """
    return HEADER + "\n".join(_example("test", PerformedTest)) + "\n" + "".join(_example_tables(ReportTables, ""))


HEADER = """\
# What was tested, by whom and with what: fill in what you have; what stays empty is left out, and the test report
# lists what ISO/IEC 17025 asks for in 7.8. Dates are "YYYY-MM-DD". Write tables in double brackets once for each.

"""
_ABOUT_TEST = {
    "item": "what was tested",
    "serial_number": "its serial number",
    "operator": "who tested it",
    "laboratory": "name of the laboratory",
    "order": "number of the order",
    "date": "day of the test, or its first",
    "direction": "of the shocks, where all have one: +x, -x, +y, -y, +z or -z",
    "notes": "what else is to be kept with it; several lines between three quotes",
}


def _example(path: str, model: type[BaseModel], brackets: str = "[]") -> Iterator[str]:
    yield f"{brackets[: len(brackets) // 2]}{path}{brackets[len(brackets) // 2 :]}"
    for key, entry in model.model_fields.items():
        if _row_model(entry.annotation) is None:
            empty = "[]" if get_origin(entry.annotation) is tuple else '""'
            yield f"{key} = {empty}  # {entry.description or _ABOUT_TEST[key]}"


def _example_tables(model: type[BaseModel], path: str) -> Iterator[str]:
    for key, entry in model.model_fields.items():
        row = _row_model(entry.annotation)
        inner = row or entry.annotation
        if not (isinstance(inner, type) and issubclass(inner, BaseModel)):
            continue
        below = f"{path}{key}"
        about = (inner.__doc__ or "").partition(": ")[2].strip()
        lines = list(_example(below, inner, "[[]]" if row else "[]"))
        yield f"\n# {about[:1].upper()}{about[1:]}\n" + "\n".join(lines) + "\n"
        yield from _example_tables(inner, f"{below}.")


def _row_model(annotation: Any) -> type[BaseModel] | None:
    """Return the table of the rows of an array of tables; None where the annotation is of no such array."""
    inner = next(iter(get_args(annotation)), None) if get_origin(annotation) is tuple else None
    return inner if isinstance(inner, type) and issubclass(inner, BaseModel) else None


LARGEST_PHOTOGRAPH = 30_000_000  # bytes of a file: a camera of 50 million pixels writes less
MOST_PIXELS = 50_000_000  # some 200 MB while they are decoded
LONGEST_SIDE = 1400  # pixels of a side in a page: 180 mm of paper at 200 dots an inch
QUALITY = 85  # of the JPEG in a page: chosen


@dataclass(frozen=True)
class Photograph:
    """A photograph fit for a page: name and caption as stated, the SHA-256 of the file, and the picture."""

    file: str
    caption: str
    digest: str
    jpeg: bytes

    @property
    def address(self) -> str:
        """The picture as the address of data within a page."""
        return "data:image/jpeg;base64," + base64.b64encode(self.jpeg).decode("ascii")


def read_photograph(folder: Path, file: str, caption: str, field: str) -> Photograph:
    """Read a PNG or JPEG file in a folder, or below it."""
    try:
        place = (folder / file).resolve()
        if not place.is_relative_to(folder.resolve()):
            raise InputError(field, file, "a file beside the test file, or in a folder below it")
        if not place.is_file():
            raise InputError(field, file, EXISTING_FILE)
        with place.open("rb") as opened:
            data = opened.read(LARGEST_PHOTOGRAPH + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(field, file, "a file that can be read", getattr(error, "strerror", "") or "") from None
    if len(data) > LARGEST_PHOTOGRAPH:
        raise InputError(field, file, f"a picture of at most {LARGEST_PHOTOGRAPH // 1_000_000} MB")
    return Photograph(file, caption, hashlib.sha256(data).hexdigest(), _redrawn(data, file, field))


def _redrawn(data: bytes, file: str, field: str) -> bytes:
    """Return the picture of a file as JPEG, upright, on white, and no larger than a page needs."""
    from PIL import Image, ImageFile, ImageOps

    allowed, most = "a PNG or JPEG picture", f"a picture of at most {MOST_PIXELS // 1_000_000} million pixels"
    cut = ImageFile.LOAD_TRUNCATED_IMAGES
    try:
        ImageFile.LOAD_TRUNCATED_IMAGES = False  # WeasyPrint allows them for the whole process
        with warnings.catch_warnings(), Image.open(io.BytesIO(data), formats=["PNG", "JPEG"]) as opened:
            warnings.simplefilter("ignore")
            width, height = opened.size
            if width * height > MOST_PIXELS:
                raise InputError(field, file, most, f"this one has {width} by {height}")
            opened.draft("RGB", (LONGEST_SIDE, LONGEST_SIDE))
            opened.load()
            image = ImageOps.exif_transpose(opened)
            image = image if image.mode in ("RGB", "RGBA", "L") else image.convert("RGBA")
            image.thumbnail((LONGEST_SIDE, LONGEST_SIDE))
            image = image.convert("RGBA")
    except InputError:
        raise
    except Image.DecompressionBombError:  # Pillow has a limit of its own, above ours
        raise InputError(field, file, most) from None
    except Exception as error:  # a damaged file may raise anything
        raise InputError(field, file, allowed, "" if isinstance(error, OSError) else type(error).__name__) from None
    finally:
        ImageFile.LOAD_TRUNCATED_IMAGES = cut
    white = Image.new("RGB", image.size, "white")
    white.paste(image, mask=image.getchannel("A"))
    written = io.BytesIO()
    white.save(written, "JPEG", quality=QUALITY, optimize=True)
    return written.getvalue()
