"""A case on a page: its state as an address and as a command line, its fields, layers and sections."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlencode

import numpy as np

from strikewave.base.errors import InputError, StrikewaveError
from strikewave.base.texts import command_line, file_word
from strikewave.base.units import typed_number
from strikewave.reporting.numbers import spelled

CASE_FILE = ".toml"
"""Ending of the name of a case file."""
LARGEST_TEXT = 1_000_000
"""Most bytes of a case, as a file and in an address."""
LONGEST_LINK = 6000
"""Characters of an address that browsers, mail and proxies all leave whole."""
MOST_CHANGES = 200
LONGEST_CHANGE = 300
"""Bounds of the changes in an address: more than all fields of the largest built-in case."""


class CaseSource(NamedTuple):
    """A case as plain values for another process: a built-in one by name, or a text; with the folder of its files."""

    name: str
    text: str
    changes: tuple[str, ...]
    folder: str


@dataclass(frozen=True)
class CaseState:
    """A built-in case, or the text of a dropped file, with changed values by path."""

    name: str
    text: str = ""
    changes: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of_file(cls, path: Path) -> CaseState:
        """Return the state of a dropped case file."""
        try:
            return cls(path.name[: -len(CASE_FILE)], path.read_text("utf-8-sig"))
        except UnicodeDecodeError:
            raise StrikewaveError(f"{path.name}: a text file in UTF-8 is wanted") from None

    @classmethod
    def of_source(cls, source: CaseSource) -> CaseState:
        """Return the state of plain values."""
        pairs = (change.partition("=") for change in source.changes)
        return cls(source.name, source.text, {path: value for path, _, value in pairs})

    def source(self, folder: Path | str = "") -> CaseSource:
        """Return the state as plain values."""
        return CaseSource(self.name, self.text, tuple(f"{p}={v}" for p, v in self.changes.items()), str(folder))

    def changed(self, path: str, value: str) -> CaseState:
        """Return the state with one more change, in the place of an earlier one of that path."""
        return replace(self, changes={**self.changes, path: value})

    def without(self, path: str) -> CaseState:
        """Return the state with the case's own value of a path."""
        return replace(self, changes={p: v for p, v in self.changes.items() if p != path})

    def is_same_case(self, other: CaseState) -> bool:
        """Tell whether another state is of the same case, whatever is changed in it."""
        return (self.name, self.text) == (other.name, other.text)

    def query(self, changes_key: str = "set") -> list[tuple[str, str]]:
        """Return the state as the parts of an address; a dropped file that is too long for one is left out."""
        parts = [("case", self.name)]
        if self.text and self.fits_address:
            parts.append(("toml", self._packed))
        return parts + [(changes_key, f"{path}={value}") for path, value in self.changes.items()]

    @classmethod
    def read(cls, parts: Iterable[tuple[str, str]], usual: str, changes_key: str = "set") -> CaseState:
        """Return the state of an address.

        Examples
        --------
        >>> state = CaseState("mine", 'schema = 1', {"machine.speed": "700 rpm"})
        >>> CaseState.read(state.query(), "li-ma-2019") == state
        True
        """
        listed = list(parts)
        values = dict(reversed(listed))
        changes = [value for key, value in listed if key == changes_key]
        if len(changes) > MOST_CHANGES or any(len(change) > LONGEST_CHANGE for change in changes):
            raise InputError("address", f"{len(changes)} changes", f"at most {MOST_CHANGES} changes of usual length")
        pairs = (change.partition("=") for change in changes)
        return cls(values.get("case", usual), _unpacked(values.get("toml", "")), {p: v for p, _, v in pairs if p})

    def command(self, program: str = "run", *more: str) -> str:
        """Return the command line with the same result.

        Examples
        --------
        >>> CaseState("li-ma-2019", changes={"machine.speed": "700 rpm"}).command()
        "strikewave run li-ma-2019 --set 'machine.speed=700 rpm'"
        """
        options = [word for path, value in self.changes.items() for word in ("--set", f"{path}={value}")]
        return command_line([program, file_word(self.file), *options, *more])

    def python(self, call: str = "run_case", more: str = "") -> str:
        """Return the Python lines with the same result."""
        changes = list(self.source().changes)
        case = f"{self.file!r}, {changes!r}" if changes else f"{self.file!r}"
        return f"import strikewave\n\ncase = strikewave.load_case({case})\nresult = strikewave.{call}(case{more})"

    @cached_property
    def _packed(self) -> str:
        return base64.urlsafe_b64encode(zlib.compress(self.text.encode(), 9)).decode()

    @property
    def fits_address(self) -> bool:
        """True if the text is short enough for an address."""
        return len(self._packed) <= LONGEST_LINK

    @property
    def file(self) -> str:
        """Name of the case on a command line: a built-in one, or the file to be saved."""
        return f"{self.name}.toml" if self.text else self.name


def is_case(path: Path) -> bool:
    """Tell whether a dropped file is a case, by its name."""
    return path.name.lower().endswith(CASE_FILE)


def address(page: str, parts: Iterable[tuple[str, str]]) -> str:
    """Return the address of a page with its state."""
    query = urlencode(list(parts))
    return f"{page}?{query}" if query else page


def _unpacked(packed: str) -> str:
    """Return the text of a case from an address; at most as much as a case file may have."""
    if not packed:
        return ""
    try:
        unpack = zlib.decompressobj()
        data = unpack.decompress(base64.b64decode(packed.encode(), b"-_", validate=True), LARGEST_TEXT + 1)
        if len(data) > LARGEST_TEXT or not unpack.eof:
            raise ValueError("too long")
        return data.decode()
    except (ValueError, zlib.error):
        raise InputError("address", "toml=…", "a whole case as this app wrote it", "drop the file instead") from None


class EditedField(NamedTuple):
    """A quantity of a case with its slider; all numbers but ``scale`` in the unit of the slider."""

    path: str
    what: str  # meaning of the quantity
    how: str  # way to obtain it on a real machine
    typed: str  # as the case has it, with its unit
    unit: str  # empty for a number
    value: float
    low: float
    high: float
    step: float
    provenance: str
    scale: float  # size of the unit in SI

    def shown(self, si: float) -> float:
        """Return an SI value in the unit of the slider."""
        return si / self.scale

    def text(self, value: float) -> str:
        """Return a value of the slider as a case file has it."""
        number = f"{value:.0f}" if self.step >= 1.0 and float(value).is_integer() else f"{value:.6g}"
        return f"{number} {self.unit}".strip()

    def with_unit(self, typed: str) -> str:
        """Return a typed text; a bare number takes the unit of the label.

        Examples
        --------
        >>> speed = EditedField("machine.speed", "", "", "730 rpm", "rpm", 730.0, 500.0, 900.0, 1.0, "published", 0.105)
        >>> speed.with_unit("7e2"), speed.with_unit("70 rad/s"), speed.text(700.0)
        ('7e2 rpm', '70 rad/s', '700 rpm')
        """
        return f"{typed.strip()} {self.unit}".strip() if typed_number(typed) is not None else typed.strip()

    @property
    def label(self) -> str:
        """Label beside the slider: the whole path in words, since both striker and object have a mass."""
        name = self.path.replace(".", " ").replace("_", " ")
        return f"{name} ({spelled(self.unit)})" if self.unit else name


JOINTS = {
    "compliant": "stiffness = 1 GN/m\ndamping = 0 N s/m",
    "gasket": "material = PTFE\nthickness = 1 mm",
    "unilateral": "preload = 1 kN",
    "mass": "mass = 5 gram",
    "oscillator": "mass = 5 gram\nresonance = 50 kHz\nquality = 50",
    "contact": "law = hertz\nradius = 1 m",
    "cushion": "cushion.material = natural rubber 65 IRHD\ncushion.thickness = 10 mm\ncushion.diameter = 20 mm",
}
"""Kinds of joints, each with the properties that it begins from."""


class StackRow(NamedTuple):
    """A layer and the joint behind it: keys and labels; empty for the joint where there is none."""

    layer: str
    layer_label: str
    joint: str
    joint_label: str


class ListedStack(NamedTuple):
    """The layers of a bar from the loaded face on, and the materials of one more."""

    rows: list[StackRow]
    materials: list[str]


class BarSections(NamedTuple):
    """Stress and velocity of a bar, in the units shown."""

    time: Any  # shape (times,)
    position: Any  # mm from the first face, shape (places,)
    layer: tuple[str, ...]  # name of the layer of each place
    stress: Any  # compression above zero, shape (times, places)
    velocity: Any  # shape (times, places)
    labels: tuple[str, str, str]  # of time, stress and velocity, with their units

    def nearest(self, position: float) -> int:
        """Return the place that is nearest to a position in mm."""
        return int(np.argmin(np.abs(self.position - position)))
