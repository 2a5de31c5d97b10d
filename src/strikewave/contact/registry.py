"""The tables of contact laws: our own, and those that installed packages add by entry point.

A package adds a law by naming an object of `DampingLaw`, `DamperLaw`, `StiffnessLaw` or `CushionLaw` in its
``pyproject.toml``::

    [project.entry-points."strikewave.damping_laws"]
    my-law = "my_package.laws:my_law"

and ``strikewave.damper_laws``, ``strikewave.stiffness_laws``, ``strikewave.cushion_laws`` for the others.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, wraps
from importlib.metadata import entry_points
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.citations import FROM_MEMORY, SOURCES
from strikewave.base.declare import KEY, MAIN, MORE
from strikewave.base.errors import InputError, StrikewaveError, StrikewaveWarning, nearest, show


@declare.dataclass
class Law:
    """Law of a contact with its description, in the order of the documents."""

    name: str = declare.word("as a case file and the command line name it", column=KEY, tables="list")
    function: Callable[..., Any]
    equation: str = declare.word("with the symbols of its kind", column=MAIN, tables="list full", order=1)

    @declare.computed(declare.word("what its symbols mean, with their units", key="symbols"))
    def explained(self) -> dict[str, str]:
        """Meaning of the symbols of its kind."""
        return dict(self.symbols)

    limits: str = declare.word("where it holds", label="range", column=MORE + 1, tables="full", order=1)
    status: str = declare.word("checked, quoted or from memory")
    source: str = declare.word("key of its source, or a reference in full")

    @declare.computed(declare.word("the source in full", label="source", column=MORE + 1, tables="full", order=2))
    def reference(self) -> str:
        """The source in full."""
        return SOURCES.get(self.source, self.source)

    seen: str = declare.word(
        "where its formula was seen, if not there", default="", label="seen in", column=MORE + 1, tables="full", order=2
    )
    note: str = declare.word("what a user should know", default="", column=MORE + 1, tables="full", order=2)

    group: ClassVar[str] = ""
    symbols: ClassVar[Mapping[str, str]] = {}

    @declare.computed(
        declare.word("status, marked", label="status", column=MAIN, tables="list full", in_document=False)
    )
    def mark(self) -> str:
        """Status, in capitals where its formula was not seen."""
        return f"! {self.status.upper()} !" if self.status == FROM_MEMORY else self.status


@dataclass(frozen=True)
class DampingLaw(Law):
    """A law chi(e) of the hysteresis factor: ``function(restitution) -> chi``."""

    group: ClassVar[str] = "strikewave.damping_laws"
    symbols: ClassVar[Mapping[str, str]] = {
        "F = K d^n (1 + chi d'/v0)": "N",
        "chi": "hysteresis factor, -",
        "e": "restitution asked for, -",
        "d, d'": "indentation and its rate, m, m/s",
        "v0": "approach speed, m/s",
    }


@dataclass(frozen=True)
class DamperLaw(Law):
    """A law of a damper c d^p d': ``function(stiffness, mass, number) -> Damper``.

    ``number`` is the restitution asked for, or a time where no restitution can be prescribed. ``given(number, n)`` is
    the restitution that comes out, None where it depends on the speed. ``exponent`` is the only n it takes, None any.
    """

    exponent: float | None = None
    given: Callable[[Any, float], NDArray[np.float64]] | None = None
    group: ClassVar[str] = "strikewave.damper_laws"
    symbols: ClassVar[Mapping[str, str]] = {
        "F = K d^n + c d^p d'": "N",
        "c": "coefficient of the damper, N s/m^(p+1)",
        "zeta": "damping ratio, -",
        "m": "reduced mass, kg",
        "e": "restitution asked for, -",
        "A": "time, s",
    }


def needed_words(law: StiffnessLaw | CushionLaw) -> str:
    """Return the names of the sizes or properties that a law takes, in words."""
    return ", ".join(name.replace("_", " ") for name in law.needs)


@declare.dataclass
class StiffnessLaw(Law):
    """A law of the elastic force: ``function(body1, body2, **needs) -> Stiffness or LogarithmicStiffness``.

    The sizes are radius1, radius2, length, datum_depth.
    """

    needs: tuple[str, ...] = declare.word("sizes that it takes, such as length", default=())
    needed = declare.phrase("needs", column=MORE, tables="list full", order=1)(needed_words)
    group: ClassVar[str] = "strikewave.stiffness_laws"
    symbols: ClassVar[Mapping[str, str]] = {
        "F": "force, N",
        "d": "indentation, m",
        "E*": "contact modulus, 1/E* = sum (1 - nu^2)/E, Pa",
        "R, R1, R2": "reduced radius 1/R = 1/R1 + 1/R2, radii (negative: a hole), m",
        "dR": "R1 + R2, m",
        "h": "length of the contact line, m",
        "D": "datum depth, m",
    }


@dataclass(frozen=True)
class CapLaw(Law):
    """A law of a contact beyond its yield load: ``function(body1, body2, sizes, pressure) -> PressureCap``."""

    symbols: ClassVar[Mapping[str, str]] = {
        "F_y": "yield load, N",
        "F_e": "elastic force at the same depth, N",
        "p": "largest contact pressure, Pa",
        "d_y, D, d_r": "depth at yield, largest depth, depth that stays, m",
        "s": "radius of the spot after over before, -",
        "E*, R, h": "contact modulus, Pa; reduced radius, length of the line, m",
    }


@declare.dataclass
class CushionLaw(Law):
    """A law of a cushion: ``function(pad, **properties) -> AnyContact``."""

    needs: tuple[str, ...] = declare.word("properties that it takes", default=())
    needed = declare.phrase("needs", column=MORE, tables="list full", order=1)(needed_words)
    options: tuple[str, ...] = declare.word("properties that it can do without", default=())
    group: ClassVar[str] = "strikewave.cushion_laws"
    symbols: ClassVar[Mapping[str, str]] = {
        "F": "force, N",
        "d, d'": "compression and its rate, m, m/s",
        "A, h": "area and thickness of the cushion, m^2, m",
        "x": "strain d/h, -",
        "E": "modulus at first touch, Pa",
    }


L = TypeVar("L", bound=Law)


def law_named(laws: Mapping[str, L], name: str, field: str, what: str) -> L:
    """Return a law by its name, or raise `InputError`, which offers the nearest."""
    if name not in laws:
        raise InputError(field, name, what, nearest(name, laws))
    return laws[name]


def with_added(kind: type[L], own: Mapping[str, L]) -> dict[str, L]:
    """Return our own laws of a kind and those of installed packages; a bad one is reported and left out."""
    added = {name: law for name, law in _added(kind.group, kind.__name__).items() if isinstance(law, kind)}
    return {**added, **own}


@cache
def _added(group: str, kind: str) -> dict[str, Any]:
    laws: dict[str, Any] = {}
    for point in entry_points(group=group):
        try:
            law = point.load()
        except (Exception, SystemExit) as error:  # whatever a foreign package does wrong
            _leave_out(point.name, f"{type(error).__name__}: {error}")
            continue
        if type(law).__name__ == kind and isinstance(law, Law):
            laws[law.name] = replace(law, function=_named(law))
        else:
            _leave_out(point.name, f"it is a {type(law).__name__}, not a {kind}")
    return laws


def _named(law: Law) -> Callable[..., Any]:
    """Return the function of a law of an installed package; its errors are reported as its own."""

    @wraps(law.function)
    def function(*arguments: Any, **sizes: Any) -> Any:
        origin = f"the contact law {law.name!r} of an installed package"
        try:
            value = law.function(*arguments, **sizes)
        except StrikewaveError:
            raise
        except (Exception, SystemExit) as error:  # one that ends the program is no better
            raise StrikewaveError(f"{origin} failed ({type(error).__name__}: {error})") from error
        if isinstance(law, DampingLaw) and np.asarray(value).dtype.kind not in "fiu":
            raise StrikewaveError(
                f"{origin} gives {show(value)}, which is no hysteresis factor: a real number is wanted"
            )
        return value

    return function


def _leave_out(name: str, why: str) -> None:
    message = f"the contact law {name!r} of an installed package is left out ({why})"
    warnings.warn(message, StrikewaveWarning, stacklevel=3)
