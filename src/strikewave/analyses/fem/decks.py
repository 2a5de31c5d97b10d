"""A deck for another code as a command: build the model, write it in the code's words, print what differs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

from strikewave._version import __version__
from strikewave.analyses.fem.build import build_model
from strikewave.analyses.fem.field_names import fields_of_case
from strikewave.analyses.fem.notices import model_notices
from strikewave.analyses.fem.sectors import sectors
from strikewave.base.result import Source
from strikewave.cases.case import Case
from strikewave.cases.written_case import dump_case
from strikewave.exchange.deck import Deck, Heading
from strikewave.exchange.ls_dyna.deck import ls_dyna_deck
from strikewave.exchange.radioss.deck import radioss_deck
from strikewave.exchange.units import UnitSystem
from strikewave.fem.model import Model
from strikewave.reporting.columns import Column
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import Command, case_folder, run_and_write
from strikewave.reporting.shown_result import ShownResult
from strikewave.reporting.terminal import tell

CODES = {"ls-dyna": (".k",), "openradioss": ("_0000.rad", "_0001.rad")}
"""Codes, and how the names of their files end."""


@dataclass(frozen=True)
class DeckResult(ShownResult):
    """A model written for another code; see `Result` for what it shares with others.

    Attributes
    ----------
    case : Case
        What the model was built from.
    model : Model
        Of the case.
    deck : Deck
        The files, and what differs or is left out.
    code : str
        One of `CODES`.
    system : UnitSystem
        Units of the deck.
    stem : str
        What the names of its files begin with.
    """

    command: ClassVar[str] = "deck"
    drawing: ClassVar[str] = ""

    case: Case
    model: Model
    deck: Deck
    code: str
    system: UnitSystem
    stem: str

    @property
    def title(self) -> str:
        """The title of the case."""
        return self.case.title or self.case.name

    @property
    def source(self) -> Source:
        """The case, with code and units below."""
        return Source("case", self.case.name, marked_text(self.case, self.code, self.system))

    @cached_property
    def names(self) -> list[str]:
        """The names of its files."""
        return [f"{self.stem}{ending}" for ending in self.deck.files]

    def highlights(self) -> list[tuple[str, str]]:
        """Return code, units, and the size of the mesh."""
        mesh = self.model.mesh
        sizes = [("elements", str(len(mesh.hexahedra))), ("nodes", str(len(mesh.points)))]
        return [("code", self.code), ("units", self.system.name), *sizes]

    def columns(self) -> list[Column]:
        """Return what differs from the model, and what is left out."""
        differs, left_out = self.deck.differs, self.deck.left_out
        kinds = ["differs"] * len(differs) + ["left out"] * len(left_out)
        return [Column("kind", kinds), Column("what", [*differs, *left_out])]

    def brief(self) -> dict[str, str]:
        """Return both columns."""
        return {"kind": "", "what": ""}

    def units(self) -> dict[str, str]:
        """Return nothing: counts have no unit."""
        return {}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        mesh = self.model.mesh
        return {
            "case": self.case.name,
            "code": self.code,
            "system": self.system.name,
            "files": self.names,
            "elements": len(mesh.hexahedra),
            "nodes": len(mesh.points),
            "parts": list(mesh.names),
            "left_out": list(self.deck.left_out),
            "differs": list(self.deck.differs),
        }


def marked_text(case: Case, code: str, system: UnitSystem) -> str:
    """Return the text of a case with code and units below: another code is another result."""
    return f"{dump_case(case)}\n# as a deck of {code} in {system.name}\n"


def write_deck(case: Case, changes: list[str], code: str, system: UnitSystem, output: Output) -> int:
    """Write the deck of a case, print what differs, and return the exit code.

    Raises
    ------
    InputError
        If the case has no mesh, parts of it do not fit together, or the code has no word for one.
    """
    text = marked_text(case, code, system)
    model = build_model(case)
    command = DeckCommand(case, model, code, system)
    return run_and_write(command, output, case_folder(f"{case.name or 'case'}-deck", text, changes), text)


@dataclass(frozen=True)
class DeckCommand(Command[DeckResult]):
    """The deck of an element case for another code."""

    of_test: ClassVar[bool] = False

    case: Case
    model: Model
    code: str
    system: UnitSystem

    def solve(self) -> DeckResult:
        """Return the deck."""
        heading = _heading(self.case, self.model)
        with fields_of_case(self.model):
            deck = (ls_dyna_deck if self.code == "ls-dyna" else radioss_deck)(self.model, self.system, heading)
        notices = tuple(model_notices(self.case, self.model))
        return DeckResult(self.case, self.model, deck, self.code, self.system, heading.stem, notices=notices)

    def summary(self, result: DeckResult) -> str:
        """Say how large the model is, and in which units."""
        mesh, (length, mass, time) = result.model.mesh, result.system.words
        counted = f"{len(mesh.hexahedra)} elements, {len(mesh.points)} nodes"
        return f"A deck of {result.code}: {counted}, in {length}, {mass}, {time}."

    def show(self, result: DeckResult) -> None:
        """Print what differs from the model, and what is left out."""
        for line in result.deck.differs:
            tell(f"done in its own way: {line}", "  ")
        for line in result.deck.left_out or ("nothing",):
            tell(f"left out: {line}", "  ")

    def hand_over(self, result: DeckResult, folder: Path) -> list[str]:
        """Write the files of the deck piece by piece, for they may be long."""
        for name, pieces in zip(result.names, result.deck.files.values(), strict=True):
            with (folder / name).open("w", encoding="ascii", newline="\n") as file:
                file.writelines(pieces)
        return result.names


def _heading(case: Case, model: Model) -> Heading:
    """Return the heading of the deck of a case; it names the parts that are sectors."""
    frames = int(case.fem.frames.si) if case.fem else 0
    sector_of = sectors(case, model)
    pieces = {name: sector_of[name].pieces for name in model.mesh.names if sector_of[name].pieces > 1}
    notes = [
        f"{', '.join(name for name in pieces if pieces[name] == many)}: 1/{many} of the body is modelled; "
        f"forces, energies and masses of the whole are {many} times these"
        for many in sorted(set(pieces.values()))
    ]
    return Heading(case.title or case.name or "a case", case.name or "case", __version__, frames, tuple(notes))
