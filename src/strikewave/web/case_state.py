"""A case as pages hold it: its state as an address and as a command line, its fields, layers and sections."""

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
"""Most bytes that a case may have, as a file and in an address."""
LONGEST_LINK = 6000
"""Characters of an address that browsers, mail and proxies all leave whole."""
MOST_CHANGES = 200
LONGEST_CHANGE = 300
"""Bounds of what an address may ask for: more than all fields of the largest built-in case."""


class CaseSource(NamedTuple):
    """A case as plain values for another process: a built-in one by name, or a text; and the folder of its files."""

    name: str
    text: str
    changes: tuple[str, ...]
    folder: str


@dataclass(frozen=True)
class CaseState:
    """A case with changes, as a page shows it.

    Attributes
    ----------
    name : str
        Name of a built-in case, or of a file that was dropped.
    text : str
        Text of the dropped file; empty for a built-in case.
    changes : mapping of str to str
        Changed values, by path.
    """

    name: str
    text: str = ""
    changes: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of_file(cls, path: Path) -> CaseState:
        """Return what a dropped case file says."""
        try:
            return cls(path.name[: -len(CASE_FILE)], path.read_text("utf-8-sig"))
        except UnicodeDecodeError:
            raise StrikewaveError(f"{path.name}: a text file in UTF-8 is wanted") from None

    @classmethod
    def of_source(cls, source: CaseSource) -> CaseState:
        """Return it from plain values."""
        pairs = (change.partition("=") for change in source.changes)
        return cls(source.name, source.text, {path: value for path, _, value in pairs})

    def source(self, folder: Path | str = "") -> CaseSource:
        """Return it as plain values."""
        return CaseSource(self.name, self.text, tuple(f"{p}={v}" for p, v in self.changes.items()), str(folder))

    def changed(self, path: str, value: str) -> CaseState:
        """Return it with one more change, in the place of an earlier one of that path."""
        return replace(self, changes={**self.changes, path: value})

    def without(self, path: str) -> CaseState:
        """Return it with the case's own value of a path."""
        return replace(self, changes={p: v for p, v in self.changes.items() if p != path})

    def is_same_case(self, other: CaseState) -> bool:
        """Whether another state is of the same case, whatever is changed in it."""
        return (self.name, self.text) == (other.name, other.text)

    def query(self, changes_key: str = "set") -> list[tuple[str, str]]:
        """Return it as the parts of an address; a dropped file that is too long for one is left out.

        Examples
        --------
        >>> CaseState("li-ma-2019", changes={"machine.speed": "700 rpm"}).query()
        [('case', 'li-ma-2019'), ('set', 'machine.speed=700 rpm')]
        """
        parts = [("case", self.name)]
        if self.text and self.fits_address:
            parts.append(("toml", self._packed))
        return parts + [(changes_key, f"{path}={value}") for path, value in self.changes.items()]

    @classmethod
    def read(cls, parts: Iterable[tuple[str, str]], usual: str, changes_key: str = "set") -> CaseState:
        """Return what an address says.

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
        """Return the command line that gives the same.

        Examples
        --------
        >>> CaseState("li-ma-2019", changes={"machine.speed": "700 rpm"}).command()
        "strikewave run li-ma-2019 --set 'machine.speed=700 rpm'"
        """
        words = [program, file_word(self.file)]
        for path, value in self.changes.items():
            words += ["--set", f"{path}={value}"]
        return command_line([*words, *more])

    def python(self, call: str = "run_case", more: str = "") -> str:
        """Return the Python lines that give the same.

        Examples
        --------
        >>> print(CaseState("li-ma-2019", changes={"machine.speed": "700 rpm"}).python())
        import strikewave
        <BLANKLINE>
        case = strikewave.load_case('li-ma-2019', ['machine.speed=700 rpm'])
        result = strikewave.run_case(case)
        """
        changes = list(self.source().changes)
        given = f"{self.file!r}, {changes!r}" if changes else f"{self.file!r}"
        return f"import strikewave\n\ncase = strikewave.load_case({given})\nresult = strikewave.{call}(case{more})"

    @cached_property
    def _packed(self) -> str:
        return base64.urlsafe_b64encode(zlib.compress(self.text.encode(), 9)).decode()

    @property
    def fits_address(self) -> bool:
        """Whether its text is short enough for an address."""
        return len(self._packed) <= LONGEST_LINK

    @property
    def file(self) -> str:
        """What a command line calls the case: a built-in name, or the file to be saved."""
        return f"{self.name}.toml" if self.text else self.name


def is_case(path: Path) -> bool:
    """Tell whether a dropped file is a case, by its name."""
    return path.name.lower().endswith(CASE_FILE)


def address(page: str, parts: Iterable[tuple[str, str]]) -> str:
    """Return the address of a page with its state.

    Examples
    --------
    >>> address("/machine", [("case", "a b")])
    '/machine?case=a+b'
    """
    words = urlencode(list(parts))
    return f"{page}?{words}" if words else page


def _unpacked(packed: str) -> str:
    """Return the text of a case from an address; never more of it than a case file may have."""
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
    """A quantity of a case.

    Attributes
    ----------
    path : str
        In the case.
    what, how : str
        Meaning of the quantity, and how to obtain it on a real machine.
    typed : str
        As the case has it, with its unit.
    unit : str
        The unit in which it is typed and slid; empty for a number.
    value : float
        In that unit.
    low, high, step : float
        Ends and step of the slider, in that unit.
    provenance : str
        Where the value of the case comes from.
    scale : float
        Size of its unit in SI.
    """

    path: str
    what: str
    how: str
    typed: str
    unit: str
    value: float
    low: float
    high: float
    step: float
    provenance: str
    scale: float

    def shown(self, si: float) -> float:
        """Return an SI value in the unit in which it is slid."""
        return si / self.scale

    def text(self, value: float) -> str:
        """Return a value of the slider as a case file has it.

        Examples
        --------
        >>> from strikewave import load_case
        >>> from strikewave.web.case_values import edited_fields
        >>> edited_fields(load_case("li-ma-2019"))["machine.speed"].text(700.0)
        '700 rpm'
        """
        number = f"{value:.0f}" if self.step >= 1.0 and float(value).is_integer() else f"{value:.6g}"
        return f"{number} {self.unit}".strip()

    def with_unit(self, typed: str) -> str:
        """Return what was typed into the field: a bare number has the unit that stands in its label.

        Examples
        --------
        >>> from strikewave import load_case
        >>> from strikewave.web.case_values import edited_fields
        >>> speed = edited_fields(load_case("li-ma-2019"))["machine.speed"]
        >>> speed.with_unit("7e2"), speed.with_unit("70 rad/s")
        ('7e2 rpm', '70 rad/s')
        """
        return f"{typed.strip()} {self.unit}".strip() if typed_number(typed) is not None else typed.strip()

    @property
    def label(self) -> str:
        """What it is called beside its slider: its whole path in words, for a mass may be that of striker or object."""
        words = self.path.replace(".", " ").replace("_", " ")
        return f"{words} ({spelled(self.unit)})" if self.unit else words


JOINTS = {
    "compliant": "stiffness = 1 GN/m\ndamping = 0 N s/m",
    "gasket": "material = PTFE\nthickness = 1 mm",
    "unilateral": "preload = 1 kN",
    "mass": "mass = 5 gram",
    "oscillator": "mass = 5 gram\nresonance = 50 kHz\nquality = 50",
    "contact": "law = hertz\nradius = 1 m",
    "cushion": "cushion.material = natural rubber 65 IRHD\ncushion.thickness = 10 mm\ncushion.diameter = 20 mm",
}
"""Kinds of joints, with properties that each may begin from."""


class StackRow(NamedTuple):
    """A layer, and the joint behind it: their keys, and each in words; no key and no words where there is no joint."""

    layer: str
    layer_words: str
    joint: str
    joint_words: str


class ListedStack(NamedTuple):
    """The layers of a bar, from the loaded face on, and the materials that one more may be of."""

    rows: list[StackRow]
    materials: list[str]


class BarSections(NamedTuple):
    """Stress and velocity of a bar, in the units shown.

    Attributes
    ----------
    time : array (times,)
    position : array (places,)
        From the first face, mm.
    layer : tuple of str
        Name of the layer of each place.
    stress : array (times, places)
        Compression above zero.
    velocity : array (times, places)
    labels : tuple of str
        Labels of time, stress and velocity, with their units.
    """

    time: Any
    position: Any
    layer: tuple[str, ...]
    stress: Any
    velocity: Any
    labels: tuple[str, str, str]

    def nearest(self, position: float) -> int:
        """Return the place that is nearest to a position, mm.

        Examples
        --------
        >>> empty = np.zeros((1, 3))
        >>> BarSections(np.zeros(1), np.array([0.0, 1.0, 2.0]), ("a",) * 3, empty, empty, ("",) * 3).nearest(1.2)
        1
        """
        return int(np.argmin(np.abs(self.position - position)))
