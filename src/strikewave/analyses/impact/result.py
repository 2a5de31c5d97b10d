"""The result of an impact of two free bodies: its blows, its contact elastic and yielding, and notices."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from strikewave.analyses.impact.setup import Setup
from strikewave.base import declare
from strikewave.base.citations import FROM_MEMORY
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, GivenUnits, Quantity, declarations
from strikewave.base.errors import InputError
from strikewave.base.quantities import AUTO
from strikewave.base.result import INFO, Notice
from strikewave.base.shock_quantities import FORCE, KILOGRAMS, RATIO, RESTITUTION, VELOCITY
from strikewave.cases.contact_notices import duration_notices, indentation_notices, speed_notices
from strikewave.cases.contact_parts import ELASTIC, HIGH, LOW, WORTH_SHOWING, YIELDING, pressures_of_answers
from strikewave.contact import (
    DampingLaw,
    Impact,
    Stiffness,
    cap_of,
    first_yield,
    impact_history,
    reduced_mass,
    solve_impact,
)
from strikewave.contact.elastoplastic import cap_law_of
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import FaceRow, amount, face_columns, face_rows
from strikewave.reporting.shown_result import Curve, history_curve

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
        """True if their peak forces differ by so much that all are shown."""
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
    taken, base = ELASTIC if setup.cap is None else YIELDING, setup.base
    others = {} if taken == ELASTIC else {ELASTIC: replace(setup, cap=None)}
    if (setup.automatic or setup.cap is None) and base.bodies is not None and base.sizes.radius1 is not None:
        for name, pressure in pressures_of_answers(None, *base.bodies).items():
            if name != taken and pressure is not None:
                others[name] = replace(setup, cap=cap_of(*base.bodies, base.cap_sizes, pressure))
    answers = {taken: _answer(taken, setup, blow)}
    for name, other in others.items() if setup.loss.damper is None else ():
        with contextlib.suppress(ValueError):  # a logarithmic law that ends below the pressure
            answers[name] = _answer(name, other, solve_impact(other.contact, *setup.masses, setup.speed))
    return ImpactAnswers(tuple(answers[name] for name in (ELASTIC, LOW, YIELDING, HIGH) if name in answers))


def _answer(name: str, setup: Setup, blow: Impact) -> ImpactAnswer:
    load = None if setup.cap is None else float(setup.cap.yield_load)  # type: ignore[arg-type]
    numbers = (blow.peak_force, blow.duration, blow.residual_indentation, blow.restitution)
    return ImpactAnswer(name, load, *(float(number) for number in numbers))


ERRORS = {"closed form": 1e-9, "integrator": 1e-6}
"""Difference of restitutions, by the method, from which on it is no rounding."""
LEAST_ENERGY = 1e-100  # smallest m v0^2 solved, J, and inverse of the largest: products beyond overflow
MOST_ROWS, MOST_DRAWN = 20, 5  # blows in a table and in a picture: chosen


@declare.dataclass
class SpotBlow:
    """A blow on a spot, SI."""

    restitution: float = declare.number(
        RESTITUTION, "separation speed over approach speed", column=MAIN, headline="coefficient of restitution"
    )
    max_indentation: float = declare.number(
        CONTACT_DEPTH, "largest indentation", label="largest indentation", column=MORE, headline="largest indentation"
    )
    residual_indentation: float = declare.number(CONTACT_DEPTH, "indentation that stays", column=MORE + 1)
    peak_force: float = declare.number(CONTACT_FORCE, "largest force", column=MAIN, headline="peak force")
    duration: float = declare.number(CONTACT_TIME, "length of the contact", column=MAIN, headline="duration")
    energy_lost: float = declare.number(
        Quantity("J", "J", digits=5), "kinetic energy lost", column=MORE, headline="energy lost"
    )
    flattening: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, decimals=4, digits=0),
        "radius of the unloaded spot over that before it yielded",
        column=MORE + 1,
    )


@declare.dataclass
class FirstBlow(SpotBlow):
    """The first blow, and what was asked of it, SI."""

    asked_restitution: float | None = declare.number(
        RATIO,
        "coefficient of restitution that was asked of the damping",
        label="coefficient of restitution asked for",
        column=MAIN,
    )
    peak_time: float = declare.number(
        CONTACT_TIME, "when the force is largest", label="time of the peak force", column=MAIN
    )
    turning_time: float = declare.number(
        CONTACT_TIME, "when the indentation is largest", label="time of the largest indentation", column=MAIN
    )
    method: str = declare.word("closed form, or integrator", label="solved by", column=MAIN)


OF_STIFFNESS = Quantity.of_data("N/m^n", digits=6)
OF_DAMPER = Quantity.of_data("N s/m^(p+1)", digits=6)
"""Their exponents are those of the laws: see `ForceLaw.given_units`."""


@declare.dataclass
class ForceLaw:
    """The force law of a contact, SI; None where a key does not apply."""

    stiffness: float | None = declare.number(OF_STIFFNESS, "K of F = K d^n; null of another law", column=MAIN)
    exponent: float | None = declare.number(RATIO, "n", column=MAIN)
    slope: float | None = declare.number(
        Quantity("N/m", "N/m", digits=6), "of a logarithmic law, d = (F / slope) ln(load / F)", column=MAIN
    )
    load: float | None = declare.number(Quantity("N", "N", digits=6), "of a logarithmic law", column=MAIN)
    hysteresis_factor: float | None = declare.number(
        Quantity(NO_UNIT, NO_UNIT, digits=6), "chi of F = K d^n (1 + chi d' / v0)", column=MAIN
    )
    law: str = declare.word("stiffness law; given where the stiffness was", label="stiffness law", column=MAIN)
    law_status: str = declare.word("checked, quoted or from memory", label="status of the stiffness law", column=MAIN)
    damping: str | None = declare.word("damping law", label="damping law", column=MAIN)
    damping_status: str | None = declare.word("as above", label="status of the damping law", column=MAIN)
    damper: str | None = declare.word("damper instead of the hysteresis", column=MAIN)
    damper_status: str | None = declare.word("as above", label="status of the damper", column=MAIN)
    damper_coefficient: float | None = declare.number(OF_DAMPER, "of the damper", column=MAIN)
    damper_exponent: float | None = declare.number(RATIO, "of the damper, p", column=MAIN)
    yield_load: float | None = declare.number(CONTACT_FORCE, "force at which the contact yields", column=MAIN)
    shape: str | None = declare.word("point or line", label="shape of the contact", column=MAIN)
    cap: str | None = declare.word("law by which it yields", label="law by which it yields", column=MAIN)
    cap_status: str | None = declare.word("as above", label="status of that law", column=MAIN)

    @property
    def given_units(self) -> GivenUnits:
        """Units of the stiffness and of the damper, with the exponents that they have."""
        damper = None if self.damper_exponent is None else self.damper_exponent + 1.0
        powers = ((OF_STIFFNESS, "N/m", self.exponent), (OF_DAMPER, "N s/m", damper))
        units = {}
        for kind, base, power in powers:
            if power:
                unit = base if power == 1.0 else f"{base}^{power:.6g}"
                units[kind.given_by] = (unit, unit)
        return units


@declare.dataclass
class ImpactResult(measured.AskedResult):
    """Blows of two free bodies on the same spot, and their set-up; see `Result` for what it shares with others."""

    command: ClassVar[str] = "impact"
    main_rows: ClassVar[str] = "spot_blows"

    setup: Setup
    blows: list[Impact]
    answers: ImpactAnswers

    @property
    def title(self) -> str:
        """The laws, and the resulting coefficient of restitution."""
        setup, first, stiffness = self.setup, self.blows[0], self.setup.base.stiffness
        kind = "damping" if setup.loss.damper is None else "damper"
        asked = "" if setup.loss.asked is None else f", {setup.loss.asked:g} asked for"
        where, law = " in blow 1" if setup.repeat > 1 else "", stiffness.law
        if law == "given" and isinstance(stiffness, Stiffness):
            law = f"{stiffness.stiffness:.6g} N/m^{stiffness.exponent:.4g}"
        return f"Stiffness {law}, {kind} {setup.loss.law.name}: e = {float(first.restitution):.4g}{where}{asked}"

    @declare.computed(declare.part(FirstBlow, "numbers of the first blow", label="first blow", inline=True))
    def first(self) -> FirstBlow:
        """The first blow."""
        blow = self.blows[0]
        return FirstBlow(
            **_numbers(blow),
            asked_restitution=self.setup.loss.asked,
            peak_time=float(blow.peak_time),
            turning_time=float(blow.turning_time),
            method=blow.method,
        )

    @declare.computed(declare.part(ForceLaw, "law of the contact", label="contact", inline=True))
    def law(self) -> ForceLaw:
        """The force law."""
        stiffness, loss, cap = self.setup.base.stiffness, self.setup.loss, self.setup.cap
        damping, damper = (loss.law, None) if loss.damper is None else (None, loss.law)
        cap_law = None if cap is None else cap_law_of(cap)
        return ForceLaw(
            **{key: getattr(stiffness, key, None) for key in ("stiffness", "exponent", "slope", "load")},
            hysteresis_factor=loss.factor if damping else None,
            law=stiffness.law,
            law_status=stiffness.status,
            damping=getattr(damping, "name", None),
            damping_status=getattr(damping, "status", None),
            damper=getattr(damper, "name", None),
            damper_status=getattr(damper, "status", None),
            damper_coefficient=getattr(loss.damper, "coefficient", None),
            damper_exponent=getattr(loss.damper, "exponent", None),
            yield_load=getattr(cap, "yield_load", None),
            shape=getattr(cap, "shape", None),
            cap=getattr(cap_law, "name", None),
            cap_status=getattr(cap_law, "status", None),
        )

    @property
    def given_units(self) -> GivenUnits:
        """Units of the numbers of its law."""
        return self.law.given_units

    @declare.computed(declare.rows(SpotBlow, "blows on the same spot", key="blows", headline="first"))
    def spot_blows(self) -> list[SpotBlow]:
        """The blows, one after another on the same spot."""
        return [SpotBlow(**_numbers(blow)) for blow in self.blows]

    @declare.computed(declare.word("whether the answers of the contact differ so much that all are shown"))
    def differ(self) -> bool:
        """True if the answers of the contact differ by so much that all are shown."""
        return self.answers.differ

    @declare.computed(declare.rows(ImpactAnswer, "first blow with its contact elastic and yielding", key="answers"))
    def contact_answers(self) -> tuple[ImpactAnswer, ...]:
        """The first blow by each answer of its contact."""
        return self.answers.rows

    def preview(self) -> Curve:
        """Return the force of the first blow."""
        blow = impact_history(self.blows[0])
        return history_curve(blow.time, blow.force, *FORCE.units, "contact force")

    @property
    def drawn(self) -> list[int]:
        """The blows whose histories are kept and drawn, from 0."""
        return _drawn(len(self.blows))

    def tables(self) -> dict[str, str]:
        """Return the drawn blows in time as CSV text."""
        histories = {k + 1: impact_history(self.blows[k]) for k in self.drawn}
        columns = [Column("blow", [blow for blow, history in histories.items() for _ in history.time])]
        for name, si in (("time", "s"), ("indentation", "m"), ("rate", "m/s"), ("force", "N")):
            values = np.concatenate([getattr(history, name) for history in histories.values()])
            columns.append(Column(name, values, si))
        return {"history.csv": csv_table(columns, HISTORY_DIGITS)}

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"impact.json": self.document_text(2)}


def impact_notices(setup: Setup, blow: Impact, answers: ImpactAnswers) -> tuple[Notice, ...]:
    """Return the notices on the first blow, and on laws from memory."""
    beyond, restitution = _beyond(setup, blow), _restitution_differs(setup, blow)
    contact = [*_contact_yields(setup, blow, answers), *_answers_differ(setup, answers)]
    return (*beyond, *restitution, *contact, *_from_memory(setup))


def solved_blows(setup: Setup) -> list[Impact]:
    """Solve the blows; without a cap on the pressure all are equal."""
    stated = f"{setup.masses[0]:g} kg, {setup.masses[1]:g} kg, {setup.speed:g} m/s"
    if not LEAST_ENERGY < float(reduced_mass(*setup.masses)) * setup.speed * setup.speed < 1.0 / LEAST_ENERGY:
        raise InputError("impact", stated, "masses and a speed whose energy is finite")
    blows: list[Impact] = []
    deepest = 0.0
    for _ in range(setup.repeat if setup.cap is not None else 1):
        try:
            blow = solve_impact(setup.contact, *setup.masses, setup.speed, deepest)
        except ValueError as error:
            raise InputError("impact", stated, "numbers that the contact can do with", str(error)) from None
        blows.append(blow)
        if not all(map(math.isfinite, _numbers(blow).values())):
            raise InputError("impact", stated, "masses, speed and stiffness whose result is finite")
        deepest = float(blow.deepest)
    return blows if setup.cap is not None else blows * setup.repeat


def _numbers(blow: Impact) -> dict[str, float]:
    return {name: float(getattr(blow, name)) for name in declarations(SpotBlow)}


def _beyond(setup: Setup, blow: Impact) -> Iterator[Notice]:
    """Yield notices on an indentation large beside the radius, too fast an approach, too short a contact."""
    radius, bodies = setup.base.sizes.radius1, setup.base.bodies
    if setup.base.shape == "point" and radius is not None:
        yield from indentation_notices(float(blow.max_indentation), radius)
    if bodies is not None:
        names = [body.name for body in bodies]
        yield from speed_notices(bodies, setup.speed, f"--speed {setup.speed:g}\xa0m/s")
        yield from duration_notices(zip(names, setup.masses, strict=True), float(blow.duration))


def _restitution_differs(setup: Setup, blow: Impact) -> Iterator[Notice]:
    """Yield a notice where the restitution is not the one asked for; of a damper with that of its own relation."""
    asked, came = setup.loss.asked, float(blow.restitution)
    yields, law = float(blow.flattening) > 1.0, setup.loss.law
    if asked is None or abs(came - asked) <= ERRORS[blow.method] or (yields and asked == 1.0):
        return
    if yields:
        message = f"the contact yields: e = {came:.4f} comes out, not the {asked:g} asked of {law.name} alone"
    elif isinstance(law, DampingLaw):
        message = f"the law {law.name} gives e = {came:.4f}, not the {asked:g} asked for; exact gives it"
    else:
        expected = asked if law.given is None else float(law.given(asked, setup.base.stiffness[1]))
        relation = f"(its relation says {expected:.4f}) " if abs(expected - asked) > 1e-9 else ""
        message = f"the damper {law.name} {relation}gives e = {came:.4f}, not the {asked:g} asked for; tsuji-cut-off "
        message += "gives it"
    yield Notice("restitution-differs", message, came, asked)


def _answers_differ(setup: Setup, answers: ImpactAnswers) -> Iterator[Notice]:
    """Report the peak force of a contact that yields, as elastic and over the range of its pressure."""
    elastic, yielding = answers.row(ELASTIC), answers.row(YIELDING)
    if setup.cap is not None and elastic is not None and yielding is not None and answers.differ:
        message = f"the contact yields: the first blow gives {_kilonewtons(yielding.peak_force)}{_known(answers)}; "
        message += f"elastic {_kilonewtons(elastic.peak_force)}"
        yield Notice("contact-yields", message, elastic.peak_force, yielding.yield_load or math.nan, severity=INFO)


def _known(answers: ImpactAnswers) -> str:
    """Return the range of the peak force in words; nothing where the pressure was given."""
    if answers.band is None:
        return ""
    return f" ({' to '.join(map(_kilonewtons, answers.band))} over what is known of the hardness)"


def _kilonewtons(force: float) -> str:
    return f"{force / 1e3:.4g} kN"


def _contact_yields(setup: Setup, blow: Impact, answers: ImpactAnswers) -> Iterator[Notice]:
    """Warn of a contact solved as elastic whose materials would yield, of a cap below that, or of no check at all."""
    sizes, bodies, peak = setup.base.sizes, setup.base.bodies, float(blow.peak_force)
    first = None if bodies is None or sizes.radius1 is None else first_yield(*bodies, setup.base.cap_sizes)
    if bodies is not None and sizes.radius1 is None and setup.cap is None:
        yield Notice("yield-unchecked", "whether the contact yields is not checked: --radius1 says where")
    if first is None:
        return
    pressure, limit = first
    if setup.cap is not None:
        capped = float(setup.cap.yield_load)  # type: ignore[arg-type]
        if capped < limit:
            message = f"the contact is let yield from {capped:.4g} N on; the materials first yield inside at "
            message += f"{limit:.4g} N ({pressure / 1e9:.3g} GPa): is the unit right?"
            yield Notice("yield-pressure-low", message, capped, limit)
        return
    if peak <= limit:
        return
    message = (
        f"the peak force of {peak / 1e3:.4g} kN is above the {limit / 1e3:.4g} kN at which the materials first yield "
        f"inside; elastic here (first yield is at {pressure / 1e9:.3g} GPa)"
    )
    yielding = answers.row(YIELDING)
    if yielding is None:
        message += "; --yield-pressure takes yielding in"
    else:
        message += f"; --yield-pressure {AUTO} gives {_kilonewtons(yielding.peak_force)}{_known(answers)}"
    yield Notice("contact-yield", message, peak, limit)


def _from_memory(setup: Setup) -> list[Notice]:
    stiffness, law = setup.base.stiffness, setup.loss.law
    kind = "damping law" if setup.loss.damper is None else "damper"
    used = (("stiffness law", stiffness.law, stiffness.status), (kind, law.name, law.status))
    origin = "stands here from memory: its formula was not seen in an opened text"
    return [
        Notice("law-from-memory", f"the {k} {name} {origin}", severity=INFO) for k, name, s in used if s == FROM_MEMORY
    ]


def _drawn(count: int) -> list[int]:
    """Return the blows to draw, from 0: the first, the last and some between them.

    Examples
    --------
    >>> _drawn(3), _drawn(1000)
    ([0, 1, 2], [0, 5, 31, 177, 999])
    """
    if count <= MOST_DRAWN:
        return list(range(count))
    return [round(count ** (k / (MOST_DRAWN - 1))) - 1 for k in range(MOST_DRAWN)]


def blow_columns(result: ImpactResult) -> list[Column]:
    """Return the columns of the blows on the same spot: of many, the first and the last."""
    rows = [replace(row, name=str(k)) for k, row in enumerate(face_rows(result, "spot_blows"), start=1)]
    if len(rows) > MOST_ROWS:
        rows[MOST_ROWS // 2 : -MOST_ROWS // 2] = [FaceRow("...", None)]
    number = Column("blow", [row.name for row in rows], priority=KEY)
    return [number, *face_columns(result, "spot_blows", rows=rows)]


def impact_words(result: ImpactResult) -> str:
    """Return the summary of an impact in words."""
    setup, numbers = result.setup, dict(result.highlights())
    m1, m2 = (amount(KILOGRAMS, mass) if mass < float("inf") else "a fixed body" for mass in setup.masses)
    return (
        f"{m1} strikes {m2} at {amount(VELOCITY, setup.speed)}: the force peaks at {numbers['peak force']} and "
        f"lasts {numbers['duration']}; the coefficient of restitution is {numbers['coefficient of restitution']}. "
        f"Solved by the {result.first.method}."
    )
