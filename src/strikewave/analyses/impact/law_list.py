"""The list of the contact laws as a command: collect, try, print, draw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from strikewave.base import declare
from strikewave.base.citations import FROM_MEMORY
from strikewave.base.constants import material
from strikewave.base.declare import KEY, MORE, NO_UNIT
from strikewave.base.errors import InputError, nearest
from strikewave.base.result import INFO, Notice, Source
from strikewave.base.shock_quantities import RATIO
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
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import FaceRow, columns_of, face_columns, face_rows, face_table
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.numbers import listed
from strikewave.reporting.output_options import Output
from strikewave.reporting.run_and_write import Command, drawing, run_and_write
from strikewave.reporting.terminal import print_rows, say, table, tell

ASKED = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
"""Restitutions asked of each law; the overview shows every other."""
EXPONENT = 1.5
"""n for the dampers whose restitution depends on it."""
RADII, LENGTH, LOADS = (0.010, 0.020), 0.040, (100.0, 100e3)
"""Steel cylinders of the picture of the stiffness laws, m, and its loads, N."""

_CALLED = "damping law", "damper", "stiffness law", "pressure cap", "cushion law"
KINDS = dict(zip(("damping", "dampers", "stiffness", "caps", "cushions"), _CALLED, strict=True))
"""Kinds of laws, with what one of them is called."""


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
        return tuple((called, getattr(self, kind)) for kind, called in KINDS.items())


@declare.dataclass
class AskedLaw:
    """A law of which a restitution is asked."""

    law: Law = declare.part(Law, "the law", inline=True)
    asked: list[float] | None = declare.history(NO_UNIT, "restitutions asked for; null where none can be")
    given: list[float] | None = declare.history(NO_UNIT, "what comes out of them")


@declare.dataclass
class AskedDamper(AskedLaw):
    """A damper of which a restitution is asked."""

    @declare.computed(
        declare.word("what comes out", label="restitution", column=MORE, tables="list", order=1, in_document=False)
    )
    def relation(self) -> str:
        """Relation of the resulting restitution to the one asked for."""
        if self.asked is None or self.given is None:
            return "cannot be prescribed"
        if all(abs(value - asked) < 1e-9 for value, asked in zip(self.given, self.asked, strict=True)):
            return "gives e"
        return f"0.5 comes out as {self.given[self.asked.index(0.5)]:.4f}"


@declare.dataclass
class LawOfKind:
    """A law among those of all kinds."""

    kind: str = declare.word("which kind of law", column=KEY)
    law: Law = declare.part(Law, "the law", inline=True)


@declare.dataclass
class LawsResult(measured.AskedResult):
    """The laws of a name, or all; see `Result` for what it shares with others. The pictures show ``everything``."""

    command: ClassVar[str] = "laws"
    drawing: ClassVar[str] = "figures"
    main_rows: ClassVar[str] = "every_law"

    laws: Laws
    everything: Laws

    @property
    def title(self) -> str:
        """Title of the list."""
        return "Contact laws"

    @declare.computed(declare.number(RATIO, "n for the dampers whose restitution depends on it"))
    def exponent(self) -> float:
        """The exponent of the dampers."""
        return EXPONENT

    @declare.computed(
        declare.rows(
            AskedLaw,
            "damping laws, F = K d^n (1 + chi d'/v0), and the restitution that comes out for e",
            headline="count",
        )
    )
    def damping(self) -> list[AskedLaw]:
        """The damping laws."""
        return [AskedLaw(law, *_asked(self.laws, "damping", law)) for law in self.laws.damping.values()]

    @declare.computed(declare.rows(AskedDamper, "dampers, F = K d^n + c d^p d'", headline="count"))
    def dampers(self) -> list[AskedDamper]:
        """The dampers."""
        return [AskedDamper(law, *_asked(self.laws, "damper", law)) for law in self.laws.dampers.values()]

    @declare.computed(declare.rows(StiffnessLaw, "stiffness laws", headline="count"))
    def stiffness(self) -> list[StiffnessLaw]:
        """The stiffness laws."""
        return list(self.laws.stiffness.values())

    @declare.computed(declare.rows(CapLaw, "pressure caps: elastic-plastic contacts that remember", headline="count"))
    def caps(self) -> list[CapLaw]:
        """The laws of what yields."""
        return list(self.laws.caps.values())

    @declare.computed(declare.rows(CushionLaw, "cushions: pads between plane faces", headline="count"))
    def cushions(self) -> list[CushionLaw]:
        """The laws of cushions."""
        return list(self.laws.cushions.values())

    @declare.computed(declare.rows(LawOfKind, "laws of all kinds", in_document=False))
    def every_law(self) -> list[LawOfKind]:
        """The laws, each with its kind."""
        return [LawOfKind(kind, law) for kind in KINDS for law in getattr(self.laws, kind).values()]

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"laws.json": self.document_text(2)}


def list_laws(name: str | None, output: Output) -> int:
    """Print the laws of a name, or all of them, write them on request, and return the exit code."""
    origin = measured.source_of("command", "laws")
    return run_and_write(LawsCommand(name, origin), output, None, origin.text)


@dataclass(frozen=True)
class LawsCommand(Command[LawsResult]):
    """The list of the laws."""

    of_test: ClassVar[bool] = False

    name: str | None
    origin: Source

    def solve(self) -> LawsResult:
        """Return the laws, each with the restitution that it gives for the one asked."""
        everything = _all_laws()
        laws = _named(everything, self.name)
        return LawsResult(laws, everything, origin=self.origin, notices=_notices(laws))

    def summary(self, result: LawsResult) -> str:
        """Return the counts of the laws, or those of a name, in words."""
        laws = [(kind, list(laws_of_kind.values())) for kind, laws_of_kind in result.laws.kinds if laws_of_kind]
        if self.name is None:
            return f"{listed([f'{len(of_kind)} {kind}s' for kind, of_kind in laws])}."
        named = [(law, kind) for kind, of_kind in laws for law in of_kind]
        return " ".join(f"{law.name}, {kind}: {law.equation} ({law.status})." for law, kind in named)

    def show(self, result: LawsResult) -> None:
        """Print an overview, or the laws of a name in full."""
        if self.name is not None:
            _print_each(result)
            return
        for kind in KINDS:
            given = _given_columns(face_rows(result, kind)) if kind == "damping" else []
            print_rows(face_table(result, kind).caption, [*face_columns(result, kind, "list"), *given])
        tell("")
        tell(
            "one law in full: strikewave laws NAME; a law of your own: name it as an entry point in the "
            "pyproject.toml of an installed package (strikewave/contact/registry.py shows how)"
        )

    def draw(self, result: LawsResult, folder: Path) -> list[str]:
        """Write what the laws give, the stiffness laws over load, and the cushion laws with their pulses."""
        from strikewave.analyses.impact.figures import asked_given, cushion_curves, stiffness_over_load
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
        f"{name} ({kind})"
        for kind, laws_of_kind in laws.kinds
        for name, law in laws_of_kind.items()
        if law.status == FROM_MEMORY
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
    """Keep the restitutions that a law gives, and tell whether it works."""
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


def _asked(laws: Laws, kind: str, law: Law) -> tuple[list[float] | None, list[float] | None]:
    given = laws.given[f"{kind} {law.name}"]
    return None if given is None else list(ASKED), given


def _given_columns(rows: Sequence[FaceRow]) -> list[Column]:
    """Return columns of the resulting restitution for every other one asked."""
    return [
        Column(f"e = {ASKED[place]:g}", [row.value.given[place] for row in rows], decimals=4, priority=MORE)
        for place in range(0, len(ASKED), 2)
    ]


def _print_each(result: LawsResult) -> None:
    for row in result.every_law:
        law = row.law
        rows = [(column.head, *column.texts()) for column in columns_of(type(law), [law], "full") if column.values[0]]
        table(f"{law.name}, {KINDS[row.kind]}", [*keys(""), *texts("")], [*rows, *law.symbols.items()])
    for asked in result.damping:
        _print_given(asked, "Restitution of the damping law")
    for asked in result.dampers:
        if asked.given is None:
            tell("its restitution cannot be prescribed: it depends on the speed")
        else:
            _print_given(asked, f"Restitution of the damper (n = {EXPONENT:g} where it depends on n)")


def _print_given(law: AskedLaw, title: str) -> None:
    rows = [[f"{asked:g}", f"{value:.4f}"] for asked, value in zip(law.asked or (), law.given or (), strict=True)]
    table(title, [*numerals("asked", priority=KEY), *numerals("given")], rows)
