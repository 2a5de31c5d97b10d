"""The request of the page of records: as plain values, as a command line, in Python."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import strikewave
from strikewave.base.texts import command_line, file_word

FILTERS = ("filter", "high_pass", "ac_coupling")
"""Options that change the record and its baseline before blows are measured."""
STATED = ("unit", "sensitivity", "polarity", "rate", "time", "time_unit")
"""Options that state properties of the files and their channels."""
COMPARED = ("unit", "sensitivity", "rate", "filter")
"""The part of these options that `strikewave compare` takes."""
GROUPS = {
    "calibration": ("Calibration", ("sensitivity", "polarity")),
    "reading": ("Reading", ("time", "time_unit")),
    "filter": ("Filtering", ("cutoff", "cfc", "high_pass", "ac_coupling")),
    "examination": ("Examination", ("base",)),
}
"""Groups of keywords of Python, each with its class and its part of these options."""


def count_of_files(count: int) -> str:
    """Return a count of files in words."""
    return f"{count} file" if count == 1 else f"{count} files"


class RecordRequest(NamedTuple):
    """A request about measured files; options are those of `strikewave record`, empty for none."""

    folder: str
    names: tuple[str, ...]  # in the order of the test
    unit: str = ""
    channel: str = ""
    sensitivity: str = ""
    polarity: str = ""
    rate: str = ""
    time: str = ""
    time_unit: str = ""
    base: str = ""
    filter: str = ""
    high_pass: str = ""
    ac_coupling: str = ""
    spec: str = ""  # name of a built-in specification
    spectrum: bool = True  # whether the shock response spectrum is drawn
    q: str = "10"  # its quality factor
    beside: str = ""  # a built-in case with its part, such as li-ma-2019:rigid

    def grouped(self, *leave: str) -> dict[str, Any]:
        """Return properties of the files, and the filters, by keywords of Python: a mapping for a group.

        Examples
        --------
        >>> RecordRequest("", ("a.csv",), unit="g", channel="1", filter="CFC 1000", time="t").grouped()
        {'channels': ['1'], 'unit': 'g', 'filter': 'CFC 1000', 'reading': {'time': 't'}}
        """
        stated = {
            key: value for key in (*STATED, *FILTERS, "base") if key not in leave and (value := getattr(self, key))
        }
        if stated.keys() & {"high_pass", "ac_coupling"} and "filter" in stated:
            low_pass = stated.pop("filter").strip()
            stated |= {"cfc": low_pass[3:]} if low_pass.upper().startswith("CFC") else {"cutoff": low_pass}
        plain: dict[str, Any] = {key: stated[key] for key in ("unit", "rate", "filter") if key in stated}
        groups = {group: {key: stated[key] for key in keys if key in stated} for group, (_, keys) in GROUPS.items()}
        channels: dict[str, Any] = {"channels": [self.channel]} if self.channel else {}
        return {**channels, **plain, **{group: values for group, values in groups.items() if values}}

    def keywords(self, *leave: str) -> dict[str, Any]:
        """Return properties of the files, and the filters, as keywords of Python, but for some options."""
        return {
            key: getattr(strikewave, GROUPS[key][0])(**value) if isinstance(value, dict) else value
            for key, value in self.grouped(*leave).items()
        }

    def commands(self, compared: str = "", alike: Sequence[str] = ()) -> list[tuple[str, str]]:
        """Return the lines with the same result.

        The first file is compared with the simulation unless another one is named; spectra are of all files unless
        those in one unit are named.

        Examples
        --------
        >>> print(RecordRequest("", ("a b.csv",), unit="g", filter="CFC 1000").commands()[0][1])
        strikewave record 'a b.csv' --unit g --cfc 1000
        strikewave srs 'a b.csv' --unit g --cfc 1000 --kind pseudo-velocity --q 10
        """
        shared = self._options((*STATED, *FILTERS))
        channel = ["--channel", self.channel] if self.channel else []
        of_record = [*(["--base", self.base] if self.base else []), *(["--spec", self.spec] if self.spec else [])]
        files = [file_word(name) for name in self.names]
        lines = [["record", *files, *channel, *shared, *of_record]]
        if self.spectrum:
            spectrum = ["--kind", "pseudo-velocity", "--q", self.q]
            lines.append(["srs", *map(file_word, alike or self.names), *channel, *shared, *spectrum])
        if self.beside and self.names:
            file = file_word(compared or self.names[0])
            place = f"{file}#{self.channel}" if self.channel else file
            lines.append(["compare", place, self.beside, *self._options(COMPARED)])
        options = ""
        for key, value in {**self.grouped(), **({"spec": self.spec} if self.spec else {})}.items():
            text = repr(value)
            if isinstance(value, dict):
                text = f"strikewave.{GROUPS[key][0]}({', '.join(f'{name}={entry!r}' for name, entry in value.items())})"
            options += f", {key}={text}"
        python = f"import strikewave\n\nresult = strikewave.record({list(self.names)!r}{options})"
        return [("command line", "\n".join(map(command_line, lines))), ("Python", python)]

    def _options(self, keys: Sequence[str]) -> list[str]:
        """Return options of a command line, those that are set."""
        options: list[str] = []
        for key in keys:
            value = getattr(self, key).strip()
            if key == "filter" and value.upper().startswith("CFC"):
                options += ["--cfc", value[3:].strip()]
            elif value:
                options += [f"--{key.replace('_', '-')}", value]
        return options


TEXTS = {
    "unit": ("unit of the numbers", "that of the file, or such as g"),
    "channel": ("channel", "all, or a name or number"),
    "sensitivity": ("sensitivity", "such as 1.2 mV/g"),
    "ac_coupling": ("AC coupling to take off", "none, or auto, 10 ms, 20 Hz"),
    "q": ("Q of the spectrum", "10 by default"),
    "beside": ("simulation beside it", "none, or such as li-ma-2019:rigid"),
}
"""Typed options: label, and example of a text."""
SELDOM = {
    "polarity": ("polarity", "1, or -1 to turn it"),
    "base": ("base channel", "none, or the one that drives the others"),
    "rate": ("sampling rate", "such as 200 kHz, where a file has no time"),
    "time": ("column of time", "found by itself, or a name or number"),
    "time_unit": ("unit of the time", "that of the file, or such as ms"),
}
"""Typed options that few files need, folded."""
CUTOFFS = {
    "filter": (
        "low-pass",
        "Zero-phase low-pass before blows are measured: a cutoff, or a class such as CFC 1000",
        True,
    ),
    "high_pass": ("high-pass", "Zero-phase high-pass, which takes a slow baseline off", False),
}
"""Options with a slider: label, effect, and whether no filter is at the upper end."""
_LABELS = {key: label for key, (label, *_) in {**TEXTS, **SELDOM, **CUTOFFS, "spec": ("specification",)}.items()}
_OPTION = re.compile(r"--([a-z]+(?:-[a-z]+)*)|^([a-z_]+)(?=: )")


def on_page(message: str) -> str:
    """Return a message that names options of the command or of Python with the fields of the page instead.

    Examples
    --------
    >>> on_page("the blows are negative: --polarity -1 turns it"), on_page("high_pass: got 1")
    ('the blows are negative: “polarity” -1 turns it', '“high-pass”: got 1')
    >>> on_page("state it, such as --rated-excitation")
    'state it, such as --rated-excitation'
    """

    def named(option: re.Match[str]) -> str:
        label = _LABELS.get((option[1] or option[2]).replace("-", "_"))
        return f"“{label}”" if label else option[0]

    return _OPTION.sub(named, message)
