"""``strikewave deck``: a model of hexahedra as input of LS-DYNA or OpenRadioss."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strikewave.reporting.terminal import CaseName, Changes, Force, Json, Out, own_mark, print_json, say

if TYPE_CHECKING:
    from strikewave.base.result import Notice
    from strikewave.cases.case import Case
    from strikewave.exchange.deck import Deck, Heading
    from strikewave.exchange.units import UnitSystem
    from strikewave.fem.model import Model

CODES = {"ls-dyna": (".k",), "openradioss": ("_0000.rad", "_0001.rad")}
"""Codes, and how the names of their files end."""


def command(
    case: CaseName,
    code: Annotated[str, typer.Option("--code", help="ls-dyna or openradioss.")] = "ls-dyna",
    units: Annotated[str, typer.Option("--units", help="SI, mm-t-s, mm-ms-kg or mm-g-us.")] = "mm-t-s",
    changes: Changes = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Write a model of hexahedra for another code: CASE.k, or CASE_0000.rad and CASE_0001.rad.

    With --json, files are written only where --out says.
    """
    from strikewave.analyses.fem.build import build_model
    from strikewave.analyses.fem.field_names import fields_of_case
    from strikewave.analyses.fem.notices import model_notices
    from strikewave.base.errors import InputError, nearest
    from strikewave.cases.case import dump_case, load_case
    from strikewave.exchange.ls_dyna.deck import ls_dyna_deck
    from strikewave.exchange.radioss.deck import radioss_deck
    from strikewave.exchange.units import unit_system

    if code not in CODES:
        raise InputError("--code", code, ", ".join(CODES), nearest(code, CODES))
    system = unit_system(units, "--units")
    read = load_case(case, changes or ())
    model = build_model(read)
    heading = _heading(read, model)
    with fields_of_case(model):
        deck = (ls_dyna_deck if code == "ls-dyna" else radioss_deck)(model, system, heading)
    names = [f"{heading.stem}{ending}" for ending in deck.files]
    notices = list(model_notices(read, model))
    text = f"{dump_case(read)}\n# as a deck of {code} in {system.name}\n"
    folder = out
    if out is None and not json:
        folder, force = Path("out") / f"{read.name or 'case'}-deck{own_mark(text, changes)}", True
    if folder is not None:
        _write(deck, names, folder, text, force)
    for notice in notices:
        say(f"warning [{notice.code}]: {notice.message}")
    if json:
        print_json(_document(read, model, deck, notices, {"code": code, "system": system.name, "files": names}))
    else:
        _show(model, deck, system)
    return 0


def _heading(case: Case, model: Model) -> Heading:
    """Return what the deck of a case is called; parts that are sectors are told of."""
    from strikewave._version import __version__
    from strikewave.analyses.fem.sectors import sectors
    from strikewave.exchange.deck import Heading

    frames = int(case.fem.frames.si) if case.fem else 0
    found = sectors(case, model)
    pieces = {name: found[name].pieces for name in model.mesh.names if found[name].pieces > 1}
    notes = [
        f"{', '.join(name for name in pieces if pieces[name] == many)}: 1/{many} of the body is modelled; "
        f"forces, energies and masses of the whole are {many} times these"
        for many in sorted(set(pieces.values()))
    ]
    return Heading(case.title or case.name or "a case", case.name or "case", __version__, frames, tuple(notes))


def _write(deck: Deck, names: list[str], folder: Path, text: str, force: bool) -> None:
    """Write the files of a deck and its case into a folder, all or none."""
    from strikewave.base.output_folder import whole_folder

    stem = names[0].removesuffix(next(iter(deck.files)))
    own = [f"{stem}{ending}" for endings in CODES.values() for ending in endings]
    with whole_folder(folder, text, force, own) as place:
        for name, pieces in zip(names, deck.files.values(), strict=True):
            with (place / name).open("w", encoding="ascii", newline="\n") as file:
                file.writelines(pieces)
        (place / "case.toml").write_text(text, "utf-8")
    say(f"written: {folder}/ ({', '.join([*names, 'case.toml'])})")


def _show(model: Model, deck: Deck, system: UnitSystem) -> None:
    length, mass, time = system.words
    say(f"{len(model.mesh.hexahedra)} elements, {len(model.mesh.points)} nodes, in {length}, {mass}, {time}")
    for line in deck.differs:
        say(f"done in its own way: {line}")
    for line in deck.left_out or ("nothing",):
        say(f"left out: {line}")


def _document(case: Case, model: Model, deck: Deck, notices: Sequence[Notice], said: dict[str, Any]) -> dict[str, Any]:
    """Return the JSON document of a deck."""
    from strikewave.base.json_document import head, plain, without

    found = [without(dataclasses.asdict(notice), "broken") for notice in notices]

    counts = {"elements": len(model.mesh.hexahedra), "nodes": len(model.mesh.points), "parts": list(model.mesh.names)}
    lists = {"left_out": list(deck.left_out), "differs": list(deck.differs)}
    document: dict[str, Any] = plain({**head({}, found), "case": case.name, **said, **counts, **lists})
    return document
