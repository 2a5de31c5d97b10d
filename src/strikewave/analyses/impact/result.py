"""What an impact of two free bodies gives: blows, numbers, tables, notices."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from strikewave.analyses.impact.answers import ImpactAnswers
from strikewave.analyses.impact.setup import ContactLoss, Setup
from strikewave.base.errors import InputError
from strikewave.base.quantities import AUTO
from strikewave.base.result import INFO, Notice
from strikewave.cases.contact_range_notices import duration_notices, indentation_notices, speed_notices
from strikewave.cases.yield_pressure import ELASTIC, YIELDING
from strikewave.contact import Impact, Stiffness, first_yield, impact_history, reduced_mass, solve_impact
from strikewave.contact.elastoplastic import cap_law_of
from strikewave.contact.registry import FROM_MEMORY
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import shown_heads, spelled, with_unit
from strikewave.reporting.shown_result import Curve, columns_of, history_curve
from strikewave.reporting.shown_units import shown_unit
from strikewave.reporting.terminal import number

ERRORS = {"closed form": 1e-9, "integrator": 1e-6}
"""Difference of restitutions, by the method, from which on it is no rounding."""
LEAST_ENERGY = 1e-100
"""Smallest m v0^2 solved, J; the largest is its inverse."""
MOST_ROWS = 20
MOST_DRAWN = 5

_BLOW_UNITS = {
    "restitution": "1",
    "max_indentation": "m",
    "residual_indentation": "m",
    "peak_force": "N",
    "duration": "s",
    "energy_lost": "J",
    "flattening": "1",
}
_UNITS = {
    **_BLOW_UNITS,
    "asked_restitution": "1",
    "peak_time": "s",
    "turning_time": "s",
    "stiffness": "N/m^n",
    "exponent": "1",
    "slope": "N/m",
    "load": "N",
    "hysteresis_factor": "1",
    "damper_coefficient": "N s/m^(p+1)",
    "damper_exponent": "1",
    "yield_load": "N",
}


@dataclass(frozen=True)
class ImpactResult(measured.AskedResult):
    """Blows of two free bodies, and what was asked for; see `Result` for what it shares with others.

    Attributes
    ----------
    setup : Setup
        What was asked for.
    blows : list of Impact
        One blow after another on the same spot.
    answers : ImpactAnswers
        The first blow with its contact elastic and yielding.
    """

    command: ClassVar[str] = "impact"

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

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return _UNITS

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head; its first keys are those of the first blow."""
        setup, first = self.setup, self.blows[0]
        return {
            **_numbers(first),
            "asked_restitution": setup.loss.asked,
            "peak_time": float(first.peak_time),
            "turning_time": float(first.turning_time),
            "method": first.method,
            **_law_keys(setup),
            "blows": [_numbers(blow) for blow in self.blows],
            "differ": self.answers.differ,
            "answers": [vars(row) for row in self.answers.rows],
        }

    def highlights(self) -> list[tuple[str, str]]:
        """Return coefficient of restitution, peak force, duration and largest indentation of the first blow."""
        first = self.blows[0]
        return [
            ("coefficient of restitution", f"{float(first.restitution):.4g}"),
            ("peak force", with_unit(float(first.peak_force), "N", "kN")),
            ("duration", with_unit(float(first.duration), "s", "us")),
            ("indentation", with_unit(float(first.max_indentation), "m", "um")),
        ]

    def columns(self) -> list[Column]:
        """Return the blows, one after another on the same spot."""
        return columns_of([_numbers(blow) for blow in self.blows], _UNITS)

    def brief(self) -> dict[str, str]:
        """Return restitution, indentation, force, duration and loss."""
        return {"restitution": "1", "max_indentation": "um", "peak_force": "kN", "duration": "us", "energy_lost": "J"}

    def preview(self) -> Curve:
        """Return the force of the first blow."""
        blow = impact_history(self.blows[0])
        return history_curve(blow.time, blow.force, "N", "kN", "contact force")

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


def _notices(setup: Setup, blow: Impact, answers: ImpactAnswers) -> tuple[Notice, ...]:
    """Return what is odd about the first blow, and the laws that stand here from memory."""
    notices = [
        _restitution_differs(setup, blow),
        _contact_yields(setup, blow, answers),
        _answers_differ(setup, answers),
    ]
    return (*_beyond(setup, blow), *(notice for notice in notices if notice), *_from_memory(setup))


def _blows(setup: Setup) -> list[Impact]:
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
        if not all(math.isfinite(value) for value in _numbers(blow).values()):
            raise InputError("impact", _given(setup), "masses, speed and stiffness whose result is finite")
        deepest = float(blow.deepest)
    return blows if setup.cap is not None else blows * setup.repeat


def _given(setup: Setup) -> str:
    return f"{setup.masses[0]:g} kg, {setup.masses[1]:g} kg, {setup.speed:g} m/s"


def _numbers(blow: Impact) -> dict[str, float]:
    return {name: float(getattr(blow, name)) for name in _BLOW_UNITS}


def _law_keys(setup: Setup) -> dict[str, Any]:
    """Return what the force law is; null where a key does not apply."""
    stiffness, loss, cap = setup.base.stiffness, setup.loss, setup.cap
    numbers = {key: getattr(stiffness, key, None) for key in ("stiffness", "exponent", "slope", "load")}
    of_damping, cap_law = loss.damper is None, cap and cap_law_of(cap)
    damping, damper = (loss.law, None) if of_damping else (None, loss.law)
    return {
        **numbers,
        "hysteresis_factor": loss.factor if of_damping else None,
        "law": stiffness.law,
        "law_status": stiffness.status,
        "damping": damping and damping.name,
        "damping_status": damping and damping.status,
        "damper": damper and damper.name,
        "damper_status": damper and damper.status,
        "damper_coefficient": loss.damper and loss.damper.coefficient,
        "damper_exponent": loss.damper and loss.damper.exponent,
        "yield_load": cap and cap.yield_load,
        "shape": cap and cap.shape,
        "cap": cap_law and cap_law.name,
        "cap_status": cap_law and cap_law.status,
    }


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


def first_rows(setup: Setup, blow: Impact) -> list[tuple[str, str]]:
    """Return what is known of a blow, in words."""

    def shown(value: Any, si: str, unit: str) -> str:
        return f"{number(float(value), si, unit, 6)} {spelled(shown_unit(si, unit))}"

    asked = setup.loss.asked
    rows = [
        ("restitution", f"{blow.restitution:.6g}, " + ("none" if asked is None else f"{asked:g}") + " asked for"),
        ("largest indentation", shown(blow.max_indentation, "m", "um")),
        ("time of the largest indentation", shown(blow.turning_time, "s", "us")),
        ("peak force", shown(blow.peak_force, "N", "N")),
        ("time of the peak force", shown(blow.peak_time, "s", "us")),
        ("duration", shown(blow.duration, "s", "us")),
        ("energy lost", shown(blow.energy_lost, "J", "J")),
        ("stiffness", f"{_stiffness_words(setup)} ({_status(setup.base.stiffness.law, setup.base.stiffness.status)})"),
        _loss_row(setup.loss),
        ("solved", blow.method),
    ]
    if setup.cap is not None:
        rows += [
            ("yield load", f"{shown(setup.cap.yield_load, 'N', 'N')} ({setup.cap.shape})"),
            ("residual indentation", shown(blow.residual_indentation, "m", "um")),
            ("flattening", f"{blow.flattening:.6g}"),
        ]
    return rows


def _loss_row(loss: ContactLoss) -> tuple[str, str]:
    named = _status(loss.law.name, loss.law.status)
    if loss.damper is None:
        return "hysteresis factor", f"{loss.factor:.6g} ({named})"
    c, p = float(loss.damper.coefficient), float(loss.damper.exponent)  # type: ignore[arg-type]
    return "damper", f"{c:.6g} N s/m^{p + 1.0:.4g} ({named})"


def _status(name: str, status: str) -> str:
    return name if name == status else f"{name}, {status}"


def _stiffness_words(setup: Setup) -> str:
    stiffness = setup.base.stiffness
    if isinstance(stiffness, Stiffness):
        return f"{stiffness.stiffness:.6g} N/m^{stiffness.exponent:.4g}"
    return f"slope {stiffness.slope:.6g} N/m, load {stiffness.load:.6g} N"


def answer_table(answers: ImpactAnswers) -> tuple[list[str], list[list[str]]]:
    """Return heads and rows of the first blow with its contact elastic and yielding."""
    columns = ["contact", "yield load (kN)", "peak force (kN)", "duration (us)", "residual (um)", "restitution"]
    rows = [
        [
            row.name,
            number(row.yield_load, "N", "kN", 5),
            number(row.peak_force, "N", "kN", 5),
            number(row.duration, "s", "us", 5),
            number(row.residual_indentation, "m", "um", 5),
            f"{row.restitution:.4f}",
        ]
        for row in answers.rows
    ]
    return shown_heads(*columns), rows


def blow_table(blows: list[Impact]) -> tuple[list[str], list[list[str]]]:
    """Return heads and rows of blows on the same spot: of many, the first and the last."""
    columns = ["blow", "restitution", "largest indentation (um)", "residual (um)", "peak force (kN)", "duration (us)"]
    columns += ["energy lost (J)", "flattening"]
    half = MOST_ROWS // 2
    hidden = range(half, len(blows) - half) if len(blows) > MOST_ROWS else range(0)
    rows = [_blow_row(k, blow) for k, blow in enumerate(blows) if k not in hidden]
    if hidden:
        rows.insert(half, ["..."] * len(columns))
    return shown_heads(*columns), rows


def _blow_row(k: int, blow: Impact) -> list[str]:
    return [
        str(k + 1),
        f"{blow.restitution:.4f}",
        number(float(blow.max_indentation), "m", "um", 5),
        number(float(blow.residual_indentation), "m", "um", 5),
        number(float(blow.peak_force), "N", "kN", 5),
        number(float(blow.duration), "s", "us", 5),
        number(float(blow.energy_lost), "J", "J", 5),
        f"{blow.flattening:.4f}",
    ]
