"""A deck for another code as a command: build the model, write it in the code's words, print what differs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from strikewave._version import __version__
from strikewave.analyses.fem.build import build_model, fields_of_case
from strikewave.analyses.fem.notices import model_notices
from strikewave.analyses.fem.sectors import sectors
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN
from strikewave.base.result import Source
from strikewave.cases.case import Case, dump_case
from strikewave.exchange.deck import Heading
from strikewave.exchange.ls_dyna.deck import ls_dyna_deck
from strikewave.exchange.radioss import radioss_deck
from strikewave.exchange.units import UnitSystem
from strikewave.fem.model import Model
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, case_folder, run_and_write
from strikewave.reporting.shown_result import ShownResult
from strikewave.reporting.terminal import tell

CODES = {"ls-dyna": (".k",), "openradioss": ("_0000.rad", "_0001.rad")}
"""Endings of the names of the files of each code."""


@declare.dataclass
class DeckNote:
    """A difference of the other code's model, or a part of ours that its deck does not hold."""

    kind: str = declare.word("differs, or left out", column=KEY)
    what: str = declare.word("the same in words", column=MAIN)


@declare.dataclass
class DeckResult(ShownResult):
    """Model written for another code: its case, the units of the deck, and the text of each file, not yet made."""

    command: ClassVar[str] = "deck"
    drawing: ClassVar[str] = ""
    main_rows: ClassVar[str] = "notes"

    case: Case
    system: UnitSystem
    pieces: Sequence[Iterator[str]]
    case_name: str = declare.word("name of the case", key="case")
    code: str = declare.word("ls-dyna or openradioss", headline="code")
    units_called: str = declare.word("units of the deck", key="system", headline="units")
    names: list[str] = declare.word("files that it would write", key="files")
    elements: int = declare.count("how many elements", headline="elements")
    nodes: int = declare.count("how many nodes", headline="nodes")
    parts: Sequence[str] = declare.word("names of the parts")
    left_out: Sequence[str] = declare.word("what the deck does not hold, in words")
    differs: Sequence[str] = declare.word("what the other code does otherwise, in words")

    @property
    def title(self) -> str:
        """The title of the case."""
        return self.case.title or self.case.name

    @property
    def source(self) -> Source:
        """The case, with code and units below."""
        return Source("case", self.case.name, marked_text(self.case, self.code, self.system))

    @declare.computed(declare.rows(DeckNote, "what differs from the model, and what is left out", in_document=False))
    def notes(self) -> list[DeckNote]:
        """Differences from the model, and parts that are left out."""
        differs = [DeckNote("differs", what) for what in self.differs]
        return differs + [DeckNote("left out", what) for what in self.left_out]


def marked_text(case: Case, code: str, system: UnitSystem) -> str:
    """Return the text of a case with code and units below: another code is another result."""
    return f"{dump_case(case)}\n# as a deck of {code} in {system.name}\n"


def write_deck(case: Case, changes: list[str], code: str, system: UnitSystem, output: Output) -> int:
    """Write the deck of a case, print what differs, and return the exit code."""
    text = marked_text(case, code, system)
    command = DeckCommand(case, build_model(case), code, system)
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
        mesh, names = self.model.mesh, [f"{heading.stem}{ending}" for ending in deck.files]
        return DeckResult(
            case=self.case,
            system=self.system,
            pieces=list(deck.files.values()),
            case_name=self.case.name,
            code=self.code,
            units_called=self.system.name,
            names=names,
            elements=len(mesh.hexahedra),
            nodes=len(mesh.points),
            parts=mesh.names,
            left_out=deck.left_out,
            differs=deck.differs,
            notices=tuple(model_notices(self.case, self.model)),
        )

    def summary(self, result: DeckResult) -> str:
        """Say how large the model is, and in which units."""
        length, mass, time = result.system.words
        counted = f"{result.elements} elements, {result.nodes} nodes"
        return f"A deck of {result.code}: {counted}, in {length}, {mass}, {time}."

    def show(self, result: DeckResult) -> None:
        """Print what differs from the model, and what is left out."""
        for line in result.differs:
            tell(f"done in its own way: {line}", "  ")
        for line in result.left_out or ("nothing",):
            tell(f"left out: {line}", "  ")

    def hand_over(self, result: DeckResult, folder: Path) -> list[str]:
        """Write the files of the deck piece by piece, for they may be long."""
        for name, pieces in zip(result.names, result.pieces, strict=True):
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
