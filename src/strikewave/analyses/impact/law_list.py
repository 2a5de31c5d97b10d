"""The list of the contact laws as a command: collect, try, print, draw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from strikewave.base.errors import InputError, nearest
from strikewave.base.materials import material
from strikewave.base.result import INFO, Notice, Source
from strikewave.contact import (
    CAP_LAWS,
    CapLaw,
    CushionLaw,
    DamperLaw,
    DampingLaw,
    Geometry,
    Law,
    StiffnessLaw,
    damper_laws,
    damping_laws,
    restitution,
    stiffness_laws,
)
from strikewave.contact.cushions import cushion_laws
from strikewave.contact.registry import FROM_MEMORY
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column
from strikewave.reporting.layout import KEY, MORE, keys, numerals, texts
from strikewave.reporting.numbers import listed
from strikewave.reporting.options.output import Output
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.shown_result import columns_of
from strikewave.reporting.terminal import say, table, tell

ASKED = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Restitutions asked of each law; the overview shows every other."""
EXPONENT = 1.5
"""n for the dampers whose restitution depends on it."""
RADII, LENGTH, LOADS = (0.010, 0.020), 0.040, (100.0, 100e3)
"""Steel cylinders of the picture of the stiffness laws, m, and its loads, N."""


class Laws(NamedTuple):
    """The laws to show, by kind; ``given`` holds what each damping law and damper makes of `ASKED`."""

    damping: dict[str, DampingLaw]
    dampers: dict[str, DamperLaw]
    stiffness: dict[str, StiffnessLaw]
    caps: dict[str, CapLaw]
    cushions: dict[str, CushionLaw]
    given: dict[str, list[float] | None]

    @property
    def kinds(self) -> tuple[tuple[str, Mapping[str, Law]], ...]:
        """Kind in words, and its laws."""
        laws: tuple[Mapping[str, Law], ...] = (self.damping, self.dampers, self.stiffness, self.caps, self.cushions)
        kinds = ("damping law", "damper", "stiffness law", "pressure cap", "cushion law")
        return tuple(zip(kinds, laws, strict=True))


@dataclass(frozen=True)
class LawsResult(measured.AskedResult):
    """The laws that are shown; see `Result` for what it shares with others.

    Attributes
    ----------
    laws : Laws
        Those of the name that was asked for, or all.
    everything : Laws
        All laws, which the pictures show.
    """

    command: ClassVar[str] = "laws"

    laws: Laws
    everything: Laws

    @property
    def title(self) -> str:
        """What it lists."""
        return "Contact laws"

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return {"asked": "1", "given": "1"}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        laws = self.laws
        return {
            "exponent": EXPONENT,
            "damping": [{**_entry(law), **_given(laws, "damping", law)} for law in laws.damping.values()],
            "dampers": [{**_entry(law), **_given(laws, "damper", law)} for law in laws.dampers.values()],
            "stiffness": [{**_entry(law), "needs": list(law.needs)} for law in laws.stiffness.values()],
            "caps": [_entry(law) for law in laws.caps.values()],
            "cushions": [
                {**_entry(law), "needs": list(law.needs), "options": list(law.options)}
                for law in laws.cushions.values()
            ],
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return how many laws there are of each kind."""
        return [(kind, str(len(rows))) for kind, rows in self.content().items() if isinstance(rows, list)]

    def columns(self) -> list[Column]:
        """Return the laws with equation, status and source."""
        kinds = {kind: rows for kind, rows in self.content().items() if isinstance(rows, list)}
        rows = [{"kind": kind, **row} for kind, rows in kinds.items() for row in rows]
        return columns_of(rows, self.units())

    def brief(self) -> dict[str, str]:
        """Return kind, name, equation and status."""
        return dict.fromkeys(("kind", "name", "equation", "status"), "")

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"laws.json": self.document_text(2)}


def list_laws(name: str | None, output: Output) -> int:
    """Print the laws of a name, or all of them, write them on request, and return the exit code.

    Raises
    ------
    InputError
        If no law has the name.
    """
    origin = measured.source_of("command", "laws")
    return run_and_write(LawsCommand(name, origin), output, None, origin.text)


@dataclass(frozen=True)
class LawsCommand(Command[LawsResult]):
    """The list of the laws."""

    of_test: ClassVar[bool] = False

    name: str | None
    origin: Source

    def solve(self) -> LawsResult:
        """Return the laws, with what each makes of the restitution asked for."""
        everything = _all_laws()
        laws = _named(everything, self.name)
        return LawsResult(laws, everything, origin=self.origin, notices=_notices(laws))

    def summary(self, result: LawsResult) -> str:
        """Count the laws, or say what those of a name are."""
        laws = [(kind, list(laws_of_kind.values())) for kind, laws_of_kind in result.laws.kinds if laws_of_kind]
        if self.name is None:
            return f"{listed([f'{len(of_kind)} {kind}s' for kind, of_kind in laws])}."
        named = [(law, kind) for kind, of_kind in laws for law in of_kind]
        return " ".join(f"{law.name}, {kind}: {law.equation} ({law.status})." for law, kind in named)

    def show(self, result: LawsResult) -> None:
        """Print an overview, or the laws of a name in full."""
        if self.name is not None:
            _print_each(result.laws)
            return
        _print_all(result.laws)
        tell("")
        tell(
            "one law in full: strikewave laws NAME; a law of your own: name it as an entry point in the "
            "pyproject.toml of an installed package (strikewave/contact/registry.py shows how)"
        )

    def draw(self, result: LawsResult, folder: Path) -> list[str]:
        """Write what the laws give, the stiffness laws over load, and the cushion laws with their pulses."""
        from strikewave.analyses.impact.figures.contact import asked_given, stiffness_over_load
        from strikewave.analyses.impact.figures.cushions import cushion_curves
        from strikewave.reporting.style import save

        steel, loads = material("65Mn"), np.geomspace(*LOADS, 61)
        figures = {
            "asked-given": asked_given(result.everything.damping),
            "stiffness-laws": stiffness_over_load(steel, steel, Geometry(*RADII, LENGTH), loads),
            "cushion-laws": cushion_curves(),
        }
        names = [f"{name}{suffix}" for name in figures for suffix in (".svg", ".png")]
        for name in names:
            with drawing(folder / name) as path:
                save(figures[Path(name).stem], path)
        return names


def _notices(laws: Laws) -> tuple[Notice, ...]:
    """Return a notice that names the laws whose formula was not seen in an opened text."""
    names = [
        f"{name} ({kind})" for kind, laws_of_kind in laws.kinds for name, law in laws_of_kind.items() if _unseen(law)
    ]
    message = f"from memory, the formula not seen in an opened text: {', '.join(names)}"
    return (Notice("law-from-memory", message, severity=INFO),) if names else ()


def _all_laws() -> Laws:
    """Return every law that works; one of an installed package that fails is reported and left out."""
    given: dict[str, list[float] | None] = {}
    damping = {name: law for name, law in damping_laws().items() if _try(given, "damping", law)}
    dampers = {name: law for name, law in damper_laws().items() if _try(given, "damper", law)}
    return Laws(damping, dampers, stiffness_laws(), CAP_LAWS, cushion_laws(), given)


def _try(given: dict[str, list[float] | None], kind: str, law: Any) -> bool:
    """Put down what a law gives, and tell whether it works."""
    asked = np.array(ASKED)
    try:
        answer: Any = None
        if kind == "damping":
            answer = restitution(law.function(asked))
        elif law.given is not None:
            answer = law.given(asked, EXPONENT)
        values = None if answer is None else [float(value) for value in np.broadcast_to(answer, asked.shape)]
    except Exception as error:  # whatever a law of a foreign package does wrong
        say(f"warning: the {kind} law {law.name!r} is left out ({type(error).__name__}: {error})")
        return False
    given[f"{kind} {law.name}"] = values
    return True


def _named(laws: Laws, name: str | None) -> Laws:
    """Return the laws of a name, which may be of several kinds."""
    if name is None:
        return laws
    known = {known for _, laws_of_kind in laws.kinds for known in laws_of_kind}
    if name not in known:
        raise InputError("NAME", name, "a contact law", nearest(name, known))

    def of(laws_of_kind: dict[str, Any]) -> dict[str, Any]:
        return {name: laws_of_kind[name]} if name in laws_of_kind else {}

    contact = of(laws.damping), of(laws.dampers), of(laws.stiffness), of(laws.caps)
    return Laws(*contact, of(laws.cushions), laws.given)


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


def _unseen(law: Law) -> bool:
    return law.status == FROM_MEMORY


def _mark(law: Law) -> str:
    return f"! {law.status.upper()} !" if _unseen(law) else law.status


def _print_all(laws: Laws) -> None:
    shown = range(0, len(ASKED), 2)
    named = [*keys("name"), *texts("status"), *texts("equation")]
    needing = [*named, *texts("needs", priority=MORE)]
    columns = [*named, *numerals(*(f"e = {ASKED[k]:g}" for k in shown), priority=MORE)]
    rows = []
    for law in laws.damping.values():
        given = laws.given[f"damping {law.name}"] or []
        rows.append([law.name, _mark(law), law.equation, *(f"{given[k]:.4f}" for k in shown)])
    table("Damping laws, F = K d^n (1 + chi d'/v0), and the restitution that comes out for e", columns, rows)
    rows = [
        [law.name, _mark(law), law.equation, _relation(laws.given[f"damper {law.name}"])]
        for law in laws.dampers.values()
    ]
    table("Dampers, F = K d^n + c d^p d'", [*named, *texts("restitution", priority=MORE)], rows)
    rows = [[law.name, _mark(law), law.equation, _needs(law)] for law in laws.stiffness.values()]
    table("Stiffness laws", needing, rows)
    rows = [[law.name, _mark(law), law.equation] for law in laws.caps.values()]
    table("Pressure caps: elastic-plastic contacts that remember", named, rows)
    rows = [[law.name, _mark(law), law.equation, _needs(law)] for law in laws.cushions.values()]
    table("Cushions: pads between plane faces", needing, rows)


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
    for kind, laws_of_kind in laws.kinds:
        for law in laws_of_kind.values():
            table(f"{law.name}, {kind}", [*keys(""), *texts("")], _rows(law))
    for name in laws.damping:
        _print_given(laws.given[f"damping {name}"], "Restitution of the damping law")
    for name in laws.dampers:
        given = laws.given[f"damper {name}"]
        if given is None:
            tell("its restitution cannot be prescribed: it depends on the speed")
        else:
            _print_given(given, f"Restitution of the damper (n = {EXPONENT:g} where it depends on n)")


def _rows(law: Law) -> list[tuple[str, str]]:
    rows = [("equation", law.equation), ("range", law.limits), ("needs", _needs(law)), ("status", _mark(law))]
    rows += [("source", law.reference), ("seen in", law.seen), ("note", law.note)]
    return [(what, text) for what, text in rows if text] + list(law.symbols.items())


def _print_given(given: Sequence[float] | None, title: str) -> None:
    rows = [[f"{asked:g}", f"{value:.4f}"] for asked, value in zip(ASKED, given or (), strict=False)]
    table(title, [*numerals("asked", priority=KEY), *numerals("given")], rows)
