"""``strikewave laws``: every contact law with equation, range, status, source and what restitution it gives."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from strikewave.base.json_document import head
from strikewave.reporting.terminal import Force, Json, Out, print_json, say, table

if TYPE_CHECKING:
    from strikewave.contact import CapLaw, DamperLaw, DampingLaw, Law, StiffnessLaw

ASKED = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Restitutions asked of each law; the overview shows every other."""
EXPONENT = 1.5
"""n for the dampers whose restitution depends on it."""
RADII, LENGTH, LOADS = (0.010, 0.020), 0.040, (100.0, 100e3)
"""Steel cylinders of the picture of the stiffness laws, m, and its loads, N."""

Name = Annotated[
    str | None, typer.Argument(metavar="[NAME]", help="A law, of whatever kind; all by default.", show_default=False)
]


class Laws(NamedTuple):
    """The laws to show, by kind; ``given`` holds what each damping law and damper makes of `ASKED`."""

    damping: dict[str, DampingLaw]
    dampers: dict[str, DamperLaw]
    stiffness: dict[str, StiffnessLaw]
    caps: dict[str, CapLaw]
    given: dict[str, list[float] | None]

    @property
    def kinds(self) -> tuple[tuple[str, Mapping[str, Law]], ...]:
        """Kind in words, and its laws."""
        laws: tuple[Mapping[str, Law], ...] = (self.damping, self.dampers, self.stiffness, self.caps)
        return tuple(zip(("damping law", "damper", "stiffness law", "pressure cap"), laws, strict=True))


def command(name: Name = None, out: Out = None, force: Force = False, json: Json = False) -> int:
    """List the contact laws: damping, dampers, stiffness, pressure caps, with status, source and what they give."""
    everything = _all_laws()
    laws = _named(everything, name)
    document = _document(laws)
    if out is not None:
        _write(everything.damping, document, out, force)
    if json:
        print_json(document)
    elif name is None:
        _print_all(laws)
    else:
        _print_each(laws)
    if not json:
        for warning in document["warnings"]:
            say(f"warning [{warning['code']}]: {warning['message']}")
        if name is None:
            say(
                "one law in full: strikewave laws NAME; a law of your own: name it as an entry point in the "
                "pyproject.toml of an installed package (strikewave/contact/registry.py shows how)"
            )
    return 0


def _all_laws() -> Laws:
    """Return every law that works; one of an installed package that fails is told and left out."""
    from strikewave.contact import CAP_LAWS, damper_laws, damping_laws, stiffness_laws

    given: dict[str, list[float] | None] = {}
    damping = {name: law for name, law in damping_laws().items() if _try(given, "damping", law)}
    dampers = {name: law for name, law in damper_laws().items() if _try(given, "damper", law)}
    return Laws(damping, dampers, stiffness_laws(), CAP_LAWS, given)


def _try(given: dict[str, list[float] | None], kind: str, law: Any) -> bool:
    """Put down what a law gives, and tell whether it works."""
    import numpy as np

    from strikewave.contact import restitution

    asked = np.array(ASKED)
    try:
        found: Any = None
        if kind == "damping":
            found = restitution(law.function(asked))
        elif law.given is not None:
            found = law.given(asked, EXPONENT)
        values = None if found is None else [float(value) for value in np.broadcast_to(found, asked.shape)]
    except Exception as error:  # whatever a law of a foreign package does wrong
        say(f"warning: the {kind} law {law.name!r} is left out ({type(error).__name__}: {error})")
        return False
    given[f"{kind} {law.name}"] = values
    return True


def _named(laws: Laws, name: str | None) -> Laws:
    """Return the laws of a name, which may be of several kinds."""
    from strikewave.base.errors import InputError, nearest

    if name is None:
        return laws
    known = {known for _, found in laws.kinds for known in found}
    if name not in known:
        raise InputError("NAME", name, "a contact law", nearest(name, known))

    def of(found: dict[str, Any]) -> dict[str, Any]:
        return {name: found[name]} if name in found else {}

    return Laws(of(laws.damping), of(laws.dampers), of(laws.stiffness), of(laws.caps), laws.given)


def _document(laws: Laws) -> dict[str, Any]:
    """Return the JSON document."""
    from strikewave.base.json_document import plain

    listed = {
        "damping": [{**_entry(law), **_given(laws, "damping", law)} for law in laws.damping.values()],
        "dampers": [{**_entry(law), **_given(laws, "damper", law)} for law in laws.dampers.values()],
        "stiffness": [{**_entry(law), "needs": list(law.needs)} for law in laws.stiffness.values()],
        "caps": [_entry(law) for law in laws.caps.values()],
    }
    document = {**head({"asked": "1", "given": "1"}, _warnings(laws)), "exponent": EXPONENT, **listed}
    return dict(plain(document))


def _entry(law: Law) -> dict[str, Any]:
    return {
        "name": law.name,
        "equation": law.equation,
        "symbols": dict(law.symbols),
        "limits": law.limits,
        "status": law.status,
        "source": law.source,
        "reference": law.reference,
        "seen": law.seen,
        "note": law.note,
    }


def _given(laws: Laws, kind: str, law: Law) -> dict[str, Any]:
    given = laws.given[f"{kind} {law.name}"]
    return {"asked": list(ASKED) if given is not None else None, "given": given}


def _warnings(laws: Laws) -> list[dict[str, Any]]:
    names = [f"{name} ({kind})" for kind, found in laws.kinds for name, law in found.items() if _unseen(law)]
    if not names:
        return []
    message = f"from memory, the formula not seen in an opened text: {', '.join(names)}"
    return [{"code": "law-from-memory", "message": message, "value": None, "limit": None}]


def _unseen(law: Law) -> bool:
    from strikewave.contact.registry import FROM_MEMORY

    return law.status == FROM_MEMORY


def _mark(law: Law) -> str:
    return f"! {law.status.upper()} !" if _unseen(law) else law.status


def _print_all(laws: Laws) -> None:
    shown = range(0, len(ASKED), 2)
    columns = ["name", "status", "equation", *(f"e = {ASKED[k]:g}" for k in shown)]
    rows = []
    for law in laws.damping.values():
        given = laws.given[f"damping {law.name}"] or []
        rows.append([law.name, _mark(law), law.equation, *(f"{given[k]:.4f}" for k in shown)])
    table("Damping laws, F = K d^n (1 + chi d'/v0), and the restitution that comes out for e", columns, rows, left=3)
    rows = [
        [law.name, _mark(law), law.equation, _relation(laws.given[f"damper {law.name}"])]
        for law in laws.dampers.values()
    ]
    table("Dampers, F = K d^n + c d^p d'", ["name", "status", "equation", "restitution"], rows, left=4)
    rows = [[law.name, _mark(law), law.equation, _needs(law)] for law in laws.stiffness.values()]
    table("Stiffness laws", ["name", "status", "equation", "needs"], rows, left=4)
    rows = [[law.name, _mark(law), law.equation] for law in laws.caps.values()]
    table("Pressure caps: elastic-plastic contacts that remember", ["name", "status", "equation"], rows, left=3)


def _relation(given: Sequence[float] | None) -> str:
    """Say how a damper stands to the restitution asked for.

    Examples
    --------
    >>> _relation(ASKED), _relation(None)
    ('gives e', 'cannot be prescribed')
    """
    if given is None:
        return "cannot be prescribed"
    if all(abs(value - asked) < 1e-9 for value, asked in zip(given, ASKED, strict=True)):
        return "gives e"
    middle = ASKED.index(0.5)
    return f"0.5 comes out as {given[middle]:.4f}"


def _needs(law: Law) -> str:
    return ", ".join(need.replace("_", " ") for need in getattr(law, "needs", ()))


def _print_each(laws: Laws) -> None:
    for kind, found in laws.kinds:
        for law in found.values():
            table(f"{law.name}, {kind}", ["", ""], _rows(law), left=2)
    for name in laws.damping:
        _print_given(laws.given[f"damping {name}"], "Restitution of the damping law")
    for name in laws.dampers:
        given = laws.given[f"damper {name}"]
        if given is None:
            say("its restitution cannot be prescribed: it depends on the speed")
        else:
            _print_given(given, f"Restitution of the damper (n = {EXPONENT:g} where it depends on n)")


def _rows(law: Law) -> list[tuple[str, str]]:
    rows = [("equation", law.equation), ("range", law.limits), ("needs", _needs(law)), ("status", _mark(law))]
    rows += [("source", law.reference), ("seen in", law.seen), ("note", law.note)]
    return [(what, text) for what, text in rows if text] + list(law.symbols.items())


def _print_given(given: Sequence[float] | None, title: str) -> None:
    columns = ["asked", *(f"{asked:g}" for asked in ASKED)]
    table(title, columns, [["given", *(f"{value:.4f}" for value in given or ())]])


def _write(damping: Mapping[str, DampingLaw], document: dict[str, Any], out: Path, force: bool) -> None:
    import json

    import numpy as np

    from strikewave.analyses.impact.figures.contact import asked_given, stiffness_over_load
    from strikewave.base.materials import material
    from strikewave.base.output_folder import whole_folder
    from strikewave.contact import Geometry
    from strikewave.reporting.measured_files import identity
    from strikewave.reporting.style import save

    text = identity(shlex.join(["strikewave", *sys.argv[1:]]), {})
    steel = material("65Mn")
    figures = {
        "asked-given": asked_given(damping),
        "stiffness-laws": stiffness_over_load(steel, steel, Geometry(*RADII, LENGTH), np.geomspace(*LOADS, 61)),
    }
    with whole_folder(out, text, force) as place:
        (place / "record.toml").write_text(text, "utf-8")
        (place / "laws.json").write_text(json.dumps(document, indent=2, ensure_ascii=False) + "\n", "utf-8")
        for name, figure in figures.items():
            for suffix in (".svg", ".png"):
                save(figure, place / (name + suffix))
    say(f"written: {out}/ (laws.json, {', '.join(f'{name}.svg, {name}.png' for name in figures)}, record.toml)")
