"""``strikewave ls-dyna``: what a run of LS-DYNA gave, alone or beside a run of ours."""

from __future__ import annotations

import dataclasses
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import Force, Json, Out, number, own_mark, print_json, say, table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from strikewave.exchange.ls_dyna.beside import Beside, ForcePair
    from strikewave.exchange.ls_dyna.folder import Contact, Extreme, Ledger, LsDynaRun, Pulse

UNITS = {
    "peak": "N", "at": "s", "impulse": "N s", "begin": "s", "end": "s", "width": "s", "span": "s", "shift": "s",
    "angle": "deg", "peak_difference": "1", "impulse_difference": "1", "width_difference": "1",
    "magnitude": "1", "phase": "1", "combined": "1", "rms": "1", "displacement": "m", "von_mises": "Pa",
    "plastic_strain": "1", "largest": "J", "last": "J",
}  # fmt: skip
"""Of the JSON document."""


def command(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="With rcforc, glstat, binout or d3plot.", show_default=False)
    ],
    units: Annotated[
        str | None,
        typer.Option(
            "--units",
            help="Units of its deck: SI, mm-t-s, mm-ms-kg or mm-g-us; its files have none.",
            show_default=False,
        ),
    ] = None,
    beside: Annotated[
        Path | None,
        typer.Option("--beside", metavar="DIR", help="A result of strikewave fem to lay beside.", show_default=False),
    ] = None,
    contact: Annotated[
        list[str] | None,
        typer.Option(
            "--contact", metavar="NAME=NUMBER", help="Our contact and LS-DYNA's; may be repeated.", show_default=False
        ),
    ] = None,
    part: Annotated[
        list[str] | None,
        typer.Option(
            "--part", metavar="NAME=NUMBER", help="Our part and LS-DYNA's; may be repeated.", show_default=False
        ),
    ] = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Read what a run of LS-DYNA gave: contact forces, energies, fields; with --beside, next to a run of ours.

    With --json, files are written only where --out says.
    """
    from strikewave.base.errors import MISSING, InputError
    from strikewave.exchange.ls_dyna.beside import Beside, lay_beside, read_ours
    from strikewave.exchange.ls_dyna.folder import read_folder
    from strikewave.exchange.units import SYSTEMS, unit_system

    if units is None:
        hint = "the files of LS-DYNA have no units: say those of the deck"
        raise InputError("--units", MISSING, "one of " + ", ".join(SYSTEMS), hint)
    numbers = [_numbers("--contact", contact), _numbers("--part", part)]
    for option, given in (("--contact", contact), ("--part", part)):
        if beside is None and given:
            raise InputError(option, given[0], "only with a result of ours to lay beside", "add --beside DIR")
    system = unit_system(units, "--units")
    ours = read_ours(beside) if beside is not None else None
    theirs = read_folder(folder, system)
    found = lay_beside(theirs, ours, *numbers) if ours else Beside(theirs)
    if out is not None or not json:
        own = _own_place(folder, units, str(beside.resolve() if beside else ""), numbers)
        _write(found, out or own, force or out is None)
    print_json(_document(found)) if json else _show(found)
    return 0


def _numbers(option: str, given: Sequence[str] | None) -> dict[str, int]:
    """Return numbers by name from NAME=NUMBER."""
    from strikewave.base.errors import InputError

    found: dict[str, int] = {}
    for text in given or ():
        name, _, number = text.rpartition("=")
        if not name or not number.strip().isdecimal() or name in found:
            raise InputError(option, text, "NAME=NUMBER, each name once", f"such as {option} ball=1")
        found[name] = int(number)
    return found


def _own_place(folder: Path, *options: Any) -> Path:
    """Return the place of a result for which none was named: its own for each folder and options."""
    asked = repr((str(folder.resolve()), *options))
    return Path("out") / f"ls-dyna-{_named(folder)}{own_mark(asked, [asked])}"


def _named(folder: Path) -> str:
    return folder.absolute().name or "run"


def _write(found: Beside, place: Path, force: bool) -> None:
    """Write report, picture and numbers into a folder."""
    import json

    from strikewave.analyses.fem.ls_dyna.figures import beside_sheet
    from strikewave.analyses.fem.ls_dyna.report import ls_dyna_report
    from strikewave.base.output_folder import whole_folder
    from strikewave.reporting.style import save

    theirs, ours = found.theirs, found.ours
    read = [*theirs.files, *([ours.folder / "histories.nc", ours.folder / "field.vtkhdf"] if ours else [])]
    text = measured.identity(shlex.join(["strikewave", *sys.argv[1:]]), measured.digests_of(read))
    title = f"LS-DYNA beside strikewave: {ours.title}" if ours else f"LS-DYNA: {_named(theirs.folder)}"
    with whole_folder(place, text, force) as home:
        (home / "record.toml").write_text(text, "utf-8")
        (home / "beside.json").write_text(json.dumps(_document(found), indent=2, allow_nan=False) + "\n", "utf-8")
        save(beside_sheet(found, title), home / "beside.svg")
        (home / "report.html").write_text(ls_dyna_report(found, text), "utf-8", newline="\n")
    say(f"written: {place}/ (report.html, beside.svg, beside.json, record.toml)")


def _document(found: Beside) -> dict[str, Any]:
    """Return the JSON document."""
    from strikewave.base.json_document import head, plain, without

    theirs, ours = found.theirs, found.ours
    notices = [without(dataclasses.asdict(notice), "broken") for notice in found.warnings]
    document = {
        **head(UNITS, notices),
        "folder": str(theirs.folder),
        "files": [path.name for path in theirs.files],
        "span": theirs.span,
        "states": theirs.frames,
        "contacts": [_contact(contact) for contact in theirs.contacts],
        "energy": _ledger(theirs.ledger),
        "parts": {name: {"number": n, **_extreme(theirs.extremes.get(name))} for name, n in theirs.parts.items()},
    }
    if ours is not None:
        document["beside"] = {
            "folder": str(ours.folder),
            "title": ours.title,
            "contacts": {pair.name: _pair(pair) for pair in found.forces},
            "energy": _ledger(ours.ledger),
            "parts": {name: {"of": found.parts.get(name), **_extreme(one)} for name, one in ours.extremes.items()},
        }
    return dict(plain(document))


def _contact(contact: Contact) -> dict[str, Any]:
    from strikewave.exchange.ls_dyna.folder import pulse_of

    sides = {side: _pulse(pulse_of(force)) for side, force in sorted(contact.sides.items())}
    return {"number": contact.number, "title": contact.title, "sides": sides}


def _pulse(pulse: Pulse | None) -> dict[str, float] | None:
    return None if pulse is None else {**dataclasses.asdict(pulse), "width": pulse.width}


def _pair(pair: ForcePair) -> dict[str, Any]:
    agreements = {"as_they_are": pair.plain, "begun_together": pair.moved}
    return {
        "number": pair.contact.number,
        "side": pair.side,
        "ls_dyna": _pulse(pair.theirs),
        "ours": _pulse(pair.ours),
        **{f"{what}_difference": pair.difference(what) for what in ("peak", "impulse", "width")},
        "shift": pair.shift,
        "angle": pair.angle,
        **{name: {**dataclasses.asdict(one), "combined": one.combined} for name, one in agreements.items()},
    }


def _ledger(ledger: Ledger | None) -> dict[str, dict[str, float]] | None:
    if ledger is None:
        return None
    return {name: {"largest": float(v[abs(v).argmax()]), "last": float(v[-1])} for name, v in ledger.energy.items()}


def _extreme(one: Extreme | None) -> dict[str, float]:
    return {} if one is None else dataclasses.asdict(one)


def _show(found: Beside) -> None:
    """Print contacts, energies, fields, and how far both are apart."""
    _show_read(found.theirs)
    for pair in found.forces:
        _show_pair(pair)
    from strikewave.analyses.fem.ls_dyna.report import contact_table, energy_table, field_table

    for made in (contact_table(found.theirs.contacts), energy_table(found), field_table(found)):
        if made.rows:
            table(made.caption, list(made.columns), [[str(cell) for cell in row] for row in made.rows], left=2)
    for notice in found.warnings:
        say(f"warning [{notice.code}]: {notice.message}")


def _show_read(theirs: LsDynaRun) -> None:
    first, last = (number(t, "s", "us") for t in theirs.span)
    fields = theirs.fields
    solids = f"; {len(fields.mesh.hexahedra)} solids, {theirs.frames} states" if fields else ""
    say(f"read: {', '.join(path.name for path in theirs.files)}; from {first} to {last} us{solids}")


def _show_pair(pair: ForcePair) -> None:
    from strikewave.analyses.fem.ls_dyna.report import pair_table

    made = pair_table(pair)
    table(made.caption, list(made.columns), [[str(cell) for cell in row] for row in made.rows])
