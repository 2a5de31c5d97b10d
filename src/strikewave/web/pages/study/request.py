"""The request of the page of studies: as plain values, as a command line, in Python."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from typing import NamedTuple

from strikewave.base.texts import command_line, file_word
from strikewave.web.case_state import CaseSource


class StudyText(NamedTuple):
    """A text of the form: key, label, example, and True if it takes several lines."""

    key: str
    label: str
    example: str
    lines: bool = False


class StudyKind(NamedTuple):
    """A kind of study: its command and function, its purpose, and the texts of its form."""

    name: str
    what: str
    texts: tuple[StudyText, ...]


VARY = StudyText("vary", "settings to vary, a line each", "machine.speed=600..800 rpm:5", lines=True)
RUNS = StudyText("runs", "runs", "")
ALONE = ("runs", "analysis")
"""Texts of one word, not a list."""
KINDS = {
    kind.name: kind
    for kind in (
        StudyKind(
            "fit",
            "Find values of the case from measured numbers or records.",
            (
                StudyText("to", "measured, a line each", "first.rigid_peak=4000 g", lines=True),
                StudyText("free", "free fields, a line each", "machine.engagement", lines=True),
            ),
        ),
        StudyKind(
            "sweep",
            "Run the case over some of its settings.",
            (VARY, StudyText("keep", "numbers to keep, a line each", "first.rigid_peak", lines=True), RUNS),
        ),
        StudyKind(
            "design",
            "Find settings for goals, or which goals exclude each other.",
            (
                VARY,
                StudyText("goals", "goals, a line each", "first.rigid_peak = 4000 g +- 5 %", lines=True),
                StudyText("analysis", "analysis", "fast"),
                RUNS,
            ),
        ),
        StudyKind(
            "settings",
            "Find settings of a rotary machine for blows of a wanted interval, peak and width.",
            (
                StudyText("interval", "interval of the blows", "20 ms"),
                StudyText("peak", "their peak", "4000 g"),
                StudyText("width", "their width at 10 % of it", "200 us"),
            ),
        ),
        StudyKind(
            "map",
            "Show how even the blows of a rotary machine are over two settings.",
            (
                StudyText("x", "along x", "machine.speed=600..800 rpm"),
                StudyText("y", "along y", "object.spring=20..80 kN/m"),
                StudyText("points", "points along x and y", "20x20"),
            ),
        ),
        StudyKind("scatter", "See what tolerances do to the blows, and which one matters.", (RUNS,)),
    )
}
"""The kinds of studies, by name."""


class StudyRequest(NamedTuple):
    """A request: the kind, the case, and the typed texts by key, in lines."""

    kind: str
    source: CaseSource
    texts: tuple[tuple[str, tuple[str, ...]], ...]

    def lines(self, key: str) -> list[str]:
        """Return the typed lines of a text; nothing where it was left empty."""
        return [line.strip() for name, lines in self.texts if name == key for line in lines if line.strip()]

    def line(self, key: str, usual: str = "") -> str:
        """Return the one line of a text."""
        return next(iter(self.lines(key)), usual)

    @property
    def mark(self) -> str:
        """Name of the stored runs of the request, so that it continues where it was stopped."""
        return hashlib.sha256(repr(self._replace(source=self.source._replace(folder=""))).encode()).hexdigest()[:16]

    def commands(self) -> list[tuple[str, str]]:
        """Return the lines with the same result.

        Examples
        --------
        >>> source = CaseSource("li-ma-2019", "", (), "")
        >>> asked = StudyRequest("sweep", source, (("vary", ("machine.speed=600..800 rpm:5",)), ("keep", ("cv",))))
        >>> asked.commands()[0][1]
        "strikewave sweep li-ma-2019 --vary 'machine.speed=600..800 rpm:5' --keep cv"
        """
        file = f"{self.source.name}.toml" if self.source.text else self.source.name
        if self.kind == "design":
            lines = [("design.toml", self._design_file(file)), ("command line", "strikewave design design.toml")]
        else:
            command = [self.kind, *(["--from"] if self.kind == "settings" else []), file_word(file)]
            for change in self.source.changes:
                command += ["--set", change]
            for key, _ in self.texts:
                for line in self.lines(key):
                    command += [f"--{key}", line]
            lines = [("command line", command_line(command))]
        case = f"strikewave.load_case({file!r}, {list(self.source.changes)!r})"
        first = f"case={case}" if self.kind == "settings" else case
        call = ", ".join([first, *self._arguments()])
        return [*lines, ("Python", f"import strikewave\n\nresult = strikewave.{self.kind}({call})")]

    def _arguments(self) -> list[str]:
        """Return the arguments of the function of a kind, beside the case."""
        runs = self.line("runs")
        if self.kind == "scatter":
            return [f"runs={runs}"] if runs else []
        if self.kind == "map":
            named = [f"{key}={self.line(key)!r}" for key in ("x", "y") if self.line(key)]
            points = self.line("points").replace("x", ", ")
            return [*named, f"points=({points})"] if points else named
        if self.kind == "settings":
            return [f"{key}={self.line(key)!r}" for key, _ in self.texts if self.line(key)]
        several = [f"{key}={self.lines(key)!r}" for key, _ in self.texts if key not in ALONE and self.lines(key)]
        several += [f"analysis={self.line('analysis')!r}"] if self.line("analysis") else []
        return [*several, f"runs={runs}"] if runs else several

    def _design_file(self, case: str) -> str:
        """Return the file that the command of designs reads; a JSON string is one of TOML."""
        head = ["schema = 1", f"case = {json.dumps(case)}", f"goals = {json.dumps(self.lines('goals'))}"]
        head += [f"analysis = {json.dumps(self.line('analysis'))}"] if self.line("analysis") else []
        head += [f"runs = {self.line('runs')}"] if self.line("runs") else []
        tables = [("set", self.source.changes), ("vary", self.lines("vary"))]
        return "\n".join(head + [line for name, texts in tables if texts for line in _table(name, texts)])


def _table(name: str, settings: Iterable[str]) -> list[str]:
    """Return the lines of a table of settings that were typed as ``path=value``."""
    typed = [text.partition("=") for text in settings]
    return [f"[{name}]", *(f"{path.strip()} = {json.dumps(value.strip().strip(QUOTES))}" for path, _, value in typed)]


QUOTES = "\"'"
"""Around a value that is typed as in a shell."""
