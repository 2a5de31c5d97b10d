"""A first blow of two free bodies with its contact elastic, and yielding at the pressures that are known."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace

from strikewave.analyses.impact.setup import Setup
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, Quantity
from strikewave.base.shock_quantities import RESTITUTION
from strikewave.cases.yield_pressure import ELASTIC, HIGH, LOW, WORTH_SHOWING, YIELDING, pressures_of_answers
from strikewave.contact import Impact, cap_of, solve_impact

CONTACT_FORCE = Quantity("N", "kN", digits=5)
CONTACT_TIME = Quantity("s", "us", digits=5)
CONTACT_DEPTH = Quantity("m", "um", digits=5)


@declare.dataclass
class ImpactAnswer:
    """A first blow with its contact elastic, or yielding from a load on (None where elastic), SI."""

    name: str = declare.word("answer of the contact: elastic, or yielding", label="contact", column=KEY)
    yield_load: float | None = declare.number(CONTACT_FORCE, "force at which it yields then", column=MAIN)
    peak_force: float = declare.number(CONTACT_FORCE, "largest force of the first blow then", column=MAIN)
    duration: float = declare.number(CONTACT_TIME, "its duration", column=MAIN)
    residual_indentation: float = declare.number(CONTACT_DEPTH, "what stays of its indentation", column=MAIN)
    restitution: float = declare.number(RESTITUTION, "its coefficient of restitution", column=MAIN)


@dataclass(frozen=True)
class ImpactAnswers:
    """The first blow by each answer of its contact; only the one that was asked for where no other is known."""

    rows: tuple[ImpactAnswer, ...]

    @property
    def differ(self) -> bool:
        """Whether their peak forces differ by so much that all are shown."""
        forces = [row.peak_force for row in self.rows]
        return max(forces) > (1.0 + WORTH_SHOWING) * min(forces)

    def row(self, name: str) -> ImpactAnswer | None:
        """Return an answer by its name; None where it was not found."""
        return next((row for row in self.rows if row.name == name), None)

    @property
    def band(self) -> tuple[float, float] | None:
        """Least and largest peak force over what is known of the pressure, N; None where it was given."""
        ends = self.row(LOW), self.row(HIGH)
        return None if ends[0] is None or ends[1] is None else (ends[0].peak_force, ends[1].peak_force)


def impact_answers(setup: Setup, blow: Impact) -> ImpactAnswers:
    """Return the first blow of a set-up by each answer of its contact.

    An elastic contact is set beside one that yields at the pressure of its materials, where they give one.
    """
    taken = ELASTIC if setup.cap is None else YIELDING
    found = {taken: _answer(taken, setup, blow)}
    if setup.loss.damper is None:
        for name, other in _others(setup, taken).items():
            with contextlib.suppress(ValueError):  # a logarithmic law that ends below the pressure
                found[name] = _answer(name, other, solve_impact(other.contact, *setup.masses, setup.speed))
    return ImpactAnswers(tuple(found[name] for name in (ELASTIC, LOW, YIELDING, HIGH) if name in found))


def _others(setup: Setup, taken: str) -> dict[str, Setup]:
    """Return the set-up of each answer but the one taken."""
    base = setup.base
    others = {} if taken == ELASTIC else {ELASTIC: replace(setup, cap=None)}
    by_materials = (setup.automatic or setup.cap is None) and base.bodies is not None
    if not by_materials or base.bodies is None or base.sizes.radius1 is None:
        return others
    for name, pressure in pressures_of_answers(None, *base.bodies).items():
        if name != taken and pressure is not None:
            others[name] = replace(setup, cap=cap_of(*base.bodies, base.cap_sizes, pressure))
    return others


def _answer(name: str, setup: Setup, blow: Impact) -> ImpactAnswer:
    load = None if setup.cap is None else float(setup.cap.yield_load)  # type: ignore[arg-type]
    numbers = (blow.peak_force, blow.duration, blow.residual_indentation, blow.restitution)
    return ImpactAnswer(name, load, *(float(number) for number in numbers))
