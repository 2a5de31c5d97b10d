"""What an impact of two free bodies comes to: its blows, its contact elastic and yielding, and notices."""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

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
from strikewave.contact import Impact, Stiffness, cap_of, first_yield, impact_history, reduced_mass, solve_impact
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


ERRORS = {"closed form": 1e-9, "integrator": 1e-6}
"""Difference of restitutions, by the method, from which on it is no rounding."""
LEAST_ENERGY = 1e-100
"""Smallest m v0^2 solved, J; the largest is its inverse."""
MOST_ROWS = 20
MOST_DRAWN = 5


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
        units = {one.given_by: unit if power == 1.0 else f"{unit}^{power:.6g}" for one, unit, power in powers if power}
        return {given_by: (unit, unit) for given_by, unit in units.items()}


@declare.dataclass
class ImpactResult(measured.AskedResult):
    """Blows of two free bodies, and what was asked for; see `Result` for what it shares with others.

    Beside what documents have:

    Attributes
    ----------
    setup : Setup
        Requested set-up.
    blows : list of Impact
        One blow after another on the same spot.
    answers : ImpactAnswers
        The first blow with its contact elastic and yielding.
    """

    command: ClassVar[str] = "impact"
    main_rows: ClassVar[str] = "spot_blows"

    setup: Setup
    blows: list[Impact]
    answers: ImpactAnswers

    @property
    def title(self) -> str:
        """The laws, and the restitution that comes out."""
        setup, first = self.setup, self.blows[0]
        kind = "damping" if setup.loss.damper is None else "damper"
        asked = "" if setup.loss.asked is None else f", {setup.loss.asked:g} asked for"
        where = " in blow 1" if setup.repeat > 1 else ""
        law = _stiffness_words(setup) if setup.base.stiffness.law == "given" else setup.base.stiffness.law
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
        return _force_law(self.setup)

    @property
    def given_units(self) -> GivenUnits:
        """Those of its law."""
        return self.law.given_units

    @declare.computed(declare.rows(SpotBlow, "blows on the same spot", key="blows", headline="first"))
    def spot_blows(self) -> list[SpotBlow]:
        """The blows, one after another on the same spot."""
        return [SpotBlow(**_numbers(blow)) for blow in self.blows]

    @declare.computed(declare.word("whether the answers of the contact differ so much that all are shown"))
    def differ(self) -> bool:
        """Whether the answers of the contact differ by so much that all are shown."""
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
        return {"history.csv": _histories(self, self.drawn)}

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"impact.json": self.document_text(2)}


def impact_notices(setup: Setup, blow: Impact, answers: ImpactAnswers) -> tuple[Notice, ...]:
    """Return what is odd about the first blow, and the laws that stand here from memory."""
    notices = [
        _restitution_differs(setup, blow),
        _contact_yields(setup, blow, answers),
        _answers_differ(setup, answers),
    ]
    return (*_beyond(setup, blow), *(notice for notice in notices if notice), *_from_memory(setup))


def solved_blows(setup: Setup) -> list[Impact]:
    """Solve the blows; without a cap on the pressure one is as the other."""
    if not LEAST_ENERGY < float(reduced_mass(*setup.masses)) * setup.speed * setup.speed < 1.0 / LEAST_ENERGY:
        raise InputError("impact", _given(setup), "masses and a speed whose energy is finite")
    blows: list[Impact] = []
    deepest = 0.0
    for _ in range(setup.repeat if setup.cap is not None else 1):
        try:
            blow = solve_impact(setup.contact, *setup.masses, setup.speed, deepest)
        except ValueError as error:
            raise InputError("impact", _given(setup), "numbers that the contact can do with", str(error)) from None
        blows.append(blow)
        if not all(map(math.isfinite, _numbers(blow).values())):
            raise InputError("impact", _given(setup), "masses, speed and stiffness whose result is finite")
        deepest = float(blow.deepest)
    return blows if setup.cap is not None else blows * setup.repeat


def _given(setup: Setup) -> str:
    return f"{setup.masses[0]:g} kg, {setup.masses[1]:g} kg, {setup.speed:g} m/s"


def _numbers(blow: Impact) -> dict[str, float]:
    return {name: float(getattr(blow, name)) for name in declarations(SpotBlow)}


def _force_law(setup: Setup) -> ForceLaw:
    stiffness, loss, cap = setup.base.stiffness, setup.loss, setup.cap
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


def _beyond(setup: Setup, blow: Impact) -> list[Notice]:
    """Return notices on an indentation large beside the radius, too fast an approach, too short a contact."""
    radius, bodies, notices = setup.base.sizes.radius1, setup.base.bodies, list[Notice]()
    if setup.base.shape == "point" and radius is not None:
        notices += indentation_notices(float(blow.max_indentation), radius)
    if bodies is not None:
        names = [body.name for body in bodies]
        notices += speed_notices(bodies, setup.speed, f"--speed {setup.speed:g}\xa0m/s")
        notices += duration_notices(zip(names, setup.masses, strict=True), float(blow.duration))
    return notices


def _restitution_differs(setup: Setup, blow: Impact) -> Notice | None:
    asked, came = setup.loss.asked, float(blow.restitution)
    if asked is None or abs(came - asked) <= ERRORS[blow.method]:
        return None
    if float(blow.flattening) > 1.0:
        if asked == 1.0:
            return None
        message = (
            f"the contact yields: e = {came:.4f} comes out, not the {asked:g} asked of {setup.loss.law.name} alone"
        )
    elif setup.loss.damper is None:
        message = f"the law {setup.loss.law.name} gives e = {came:.4f}, not the {asked:g} asked for; exact gives it"
    else:
        message = (
            f"the damper {_expected(setup)}gives e = {came:.4f}, not the {asked:g} asked for; tsuji-cut-off gives it"
        )
    return Notice("restitution-differs", message, came, asked)


def _expected(setup: Setup) -> str:
    """Return the name of a damper, and what its own relation says where it is something else than asked for."""
    law: Any = setup.loss.law
    expected = float(law.given(setup.loss.asked, setup.base.stiffness[1]))
    relation = f"(its relation says {expected:.4f}) " if abs(expected - float(setup.loss.asked or 0.0)) > 1e-9 else ""
    return f"{law.name} {relation}"


def _answers_differ(setup: Setup, answers: ImpactAnswers) -> Notice | None:
    """Say what a contact that yields would give as elastic, and over what is known of its pressure."""
    elastic, yielding = answers.row(ELASTIC), answers.row(YIELDING)
    if setup.cap is None or elastic is None or yielding is None or not answers.differ:
        return None
    message = f"the contact yields: the first blow gives {_kilonewtons(yielding.peak_force)}{_known(answers)}; elastic "
    message += _kilonewtons(elastic.peak_force)
    return Notice("contact-yields", message, elastic.peak_force, yielding.yield_load or math.nan, severity=INFO)


def _known(answers: ImpactAnswers) -> str:
    """Return the range of the peak force in words; nothing where the pressure was given."""
    if answers.band is None:
        return ""
    low, high = (_kilonewtons(force) for force in answers.band)
    return f" ({low} to {high} over what is known of the hardness)"


def _kilonewtons(force: float) -> str:
    return f"{force / 1e3:.4g} kN"


def _contact_yields(setup: Setup, blow: Impact, answers: ImpactAnswers) -> Notice | None:
    """Warn of a contact solved as elastic whose materials would yield, of a cap below that, or of no check at all."""
    sizes, bodies, peak = setup.base.sizes, setup.base.bodies, float(blow.peak_force)
    if bodies is None:
        return None
    if sizes.radius1 is None:
        message = "whether the contact yields is not checked: --radius1 says where"
        return None if setup.cap else Notice("yield-unchecked", message)
    first = first_yield(*bodies, setup.base.cap_sizes)
    if first is None:
        return None
    pressure, limit = first
    if setup.cap is not None:
        capped = float(setup.cap.yield_load)  # type: ignore[arg-type]
        if capped >= limit:
            return None
        message = f"the contact is let yield from {capped:.4g} N on; the materials first yield inside at {limit:.4g} N"
        return Notice("yield-pressure-low", message + f" ({pressure / 1e9:.3g} GPa): is the unit right?", capped, limit)
    if peak <= limit:
        return None
    message = (
        f"the peak force of {peak / 1e3:.4g} kN is above the {limit / 1e3:.4g} kN at which the materials first yield "
        f"inside; elastic here (first yield is at {pressure / 1e9:.3g} GPa)"
    )
    yielding = answers.row(YIELDING)
    if yielding is None:
        message += "; --yield-pressure takes yielding in"
    else:
        message += f"; --yield-pressure {AUTO} gives {_kilonewtons(yielding.peak_force)}{_known(answers)}"
    return Notice("contact-yield", message, peak, limit)


def _from_memory(setup: Setup) -> list[Notice]:
    stiffness, law = setup.base.stiffness, setup.loss.law
    kind = "damping law" if setup.loss.damper is None else "damper"
    used = (("stiffness law", stiffness.law, stiffness.status), (kind, law.name, law.status))
    origin = "stands here from memory: its formula was not seen in an opened text"
    return [
        Notice("law-from-memory", f"the {k} {name} {origin}", severity=INFO) for k, name, s in used if s == FROM_MEMORY
    ]


def _histories(result: ImpactResult, drawn: list[int]) -> str:
    """Return the drawn blows in time as CSV."""
    histories = {k + 1: impact_history(result.blows[k]) for k in drawn}
    columns = [Column("blow", [blow for blow, history in histories.items() for _ in history.time])]
    for name, si in (("time", "s"), ("indentation", "m"), ("rate", "m/s"), ("force", "N")):
        columns.append(Column(name, np.concatenate([getattr(one, name) for one in histories.values()]), si))
    return csv_table(columns, HISTORY_DIGITS)


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


def _stiffness_words(setup: Setup) -> str:
    stiffness = setup.base.stiffness
    if isinstance(stiffness, Stiffness):
        return f"{stiffness.stiffness:.6g} N/m^{stiffness.exponent:.4g}"
    return f"slope {stiffness.slope:.6g} N/m, load {stiffness.load:.6g} N"


def blow_columns(result: ImpactResult) -> list[Column]:
    """Return the columns of the blows on the same spot: of many, the first and the last."""
    rows = [replace(row, name=str(k)) for k, row in enumerate(face_rows(result, "spot_blows"), start=1)]
    if len(rows) > MOST_ROWS:
        rows[MOST_ROWS // 2 : -MOST_ROWS // 2] = [FaceRow("...", None)]
    number = Column("blow", [row.name for row in rows], priority=KEY)
    return [number, *face_columns(result, "spot_blows", rows=rows)]


def impact_words(result: ImpactResult) -> str:
    """Say in words what happens."""
    setup, numbers = result.setup, dict(result.highlights())
    m1, m2 = (amount(KILOGRAMS, mass) if mass < float("inf") else "a fixed body" for mass in setup.masses)
    return (
        f"{m1} strikes {m2} at {amount(VELOCITY, setup.speed)}: the force peaks at {numbers['peak force']} and "
        f"lasts {numbers['duration']}; the coefficient of restitution is {numbers['coefficient of restitution']}. "
        f"Solved by the {result.first.method}."
    )
