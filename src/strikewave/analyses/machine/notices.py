"""What a user should know about a run: broken ledgers, odd blows, yield, what the recorder misses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from strikewave.analyses.machine.result import Notice
from strikewave.base.materials import material
from strikewave.cases.case import Case
from strikewave.cases.tables import POWER, AnyStriker, ContactTable
from strikewave.contact import (
    Geometry,
    damping_law,
    factor,
    first_yield,
    restitution,
    stiffness_law,
)
from strikewave.contact.registry import FROM_MEMORY
from strikewave.machines import Blow

FAR_BEYOND = 100.0
"""Beyond this many times the load of first yield an elastic law says little about the force."""
LEDGER_LIMIT = 1e-6
"""Energy or momentum missing beyond this share breaks a stated limit."""
SAME_RESTITUTION = 1e-9
"""Two restitutions that differ by less are the same."""
FEWEST_INTERVALS = 10.0
"""Sampling intervals a pulse below which the recorder is warned of: the worst loss of peak is then 1.2 %."""


def notices(case: Case, found: Sequence[Blow]) -> tuple[Notice, ...]:
    """Return the notices of a run but for its ledger and its waves.

    Parameters
    ----------
    case : Case
        What ran.
    found : sequence of Blow
        Its blows.
    """
    struck = [blow for blow in found if blow.kind != "missed"]
    listed = [*_changed(case), *law_notices(case)]
    if not struck:
        listed.append(
            Notice(
                "no-blow",
                "no striker touched the object: see "
                + ("where it rests against machine.engagement" if case.launched() is None else "[machine]"),
                0.0,
                1.0,
                broken=True,
            )
        )
        return tuple(listed)
    listed += [*_odd_blows(case, found), *_rail(case), *_yield(case, struck), *_recorder(case, struck)]
    return tuple(listed)


def _changed(case: Case) -> Iterator[Notice]:
    changed = case.changed_fields() if case.published else []
    if changed:
        message = f"the published numbers belong to the case {case.source}; this one differs in {', '.join(changed)}"
        yield Notice("changed-case", message, float(len(changed)), 0.0)


def law_notices(case: Case) -> Iterator[Notice]:
    """Say where a contact law is from memory, or gives two free bodies another restitution than was asked for."""
    contact = case.contact
    if contact is None:
        return
    laws = [damping_law(contact.damping), *([stiffness_law(contact.law)] if contact.law != POWER else [])]
    for law in laws:
        if law.status == FROM_MEMORY:
            message = f"the contact law {law.name} is from memory: no text that states it could be opened"
            yield Notice("law-from-memory", message, 1.0, 0.0)
    asked = contact.restitution.si
    given = float(restitution(factor(contact.damping, asked)))
    if abs(given - asked) > SAME_RESTITUTION:
        message = (
            f"the damping law {contact.damping} gives two free bodies e = {given:.4f}, not the {asked:g} asked for; "
            "exact gives it"
        )
        yield Notice("restitution-differs", message, given, asked)


def ledger_notices(ledger: Mapping[str, float]) -> Iterator[Notice]:
    """Yield each error of a ledger (``energy_error``, ``momentum_error``, shares) that is beyond the limit."""
    for key, error in ledger.items():
        if not error <= LEDGER_LIMIT:
            name = key.removesuffix("_error")
            message = (
                f"the {name} ledger misses {error:.1e}: lower solver.tolerance (solver.step for a stack), or take "
                "less extreme values"
            )
            yield Notice(f"{name}-ledger", message, error, LEDGER_LIMIT, broken=True)


def _odd_blows(case: Case, found: Sequence[Blow]) -> Iterator[Notice]:
    made, wanted = sum(blow.kind != "missed" for blow in found), case.feed.blows.si if case.feed else 1.0
    if made != wanted:
        message = f"{made} blows instead of the {wanted:.0f} wanted"
        yield Notice("blow-count", message, float(made), wanted, broken=True)
    odd = [f"{blow.index} {blow.kind}" for blow in found if blow.kind != "full"]
    if odd:
        message = "not every blow is full: " + ", ".join(odd)
        if any(blow.kind == "double" for blow in found):
            message += "; impulse and velocity change of a double blow span its whole pass"
        yield Notice("blow-kind", message, float(len(odd)), 0.0)
    away = [blow for blow in found if blow.kind == "missed" and blow.retreat > 0.0]
    if away:
        farthest = max(blow.retreat for blow in away)
        message = (
            f"the object was still away, by up to {farthest * 1e3:.3g} mm, when the strikers of blow "
            f"{', '.join(str(blow.index) for blow in away)} passed: it needs a stiffer spring, more preload, less "
            "friction or a longer interval"
        )
        yield Notice("object-away", message, farthest, 0.0)
    cut = [str(blow.index) for blow in found if blow.kind != "missed" and not blow.width > 0.0]
    if cut:
        message = f"no width: the acceleration stays above 10 % of its peak around blow {', '.join(cut)}"
        yield Notice("pulse-width", message, float(len(cut)), 0.0)


def _yield(case: Case, struck: Sequence[Blow]) -> Iterator[Notice]:
    parts = case.impact()
    advice = ", or trust the rigid pulse, which hangs on frame and mount, more than the contact force"
    peak = max(blow.peak_force for blow in struck)
    yield from yield_notices(parts.striker, parts.contact, parts.object.material, peak, advice)


def yield_notices(
    striker: AnyStriker, contact: ContactTable, face: str, peak: float, otherwise: str = ""
) -> Iterator[Notice]:
    """Warn where an elastic contact goes beyond its first yield, or a cap lies below it.

    ``face`` is the material that is hit, ``peak`` the largest force, N, ``otherwise`` what to do besides.
    """
    if contact.law == POWER or striker.nose_radius is None:
        return
    of_line = "length" in stiffness_law(contact.law).needs
    length = striker.contact_length.si if of_line and striker.contact_length else None
    first = first_yield(material(striker.material), material(face), Geometry(striker.nose_radius.si, math.inf, length))
    if first is None:
        return
    given = contact.yield_pressure
    if given is not None:
        if given.si < first.pressure:
            message = (
                f"contact.yield_pressure, {given.typed}, is below the {first.pressure / 1e6:.4g} MPa at which the "
                "weaker material first yields inside: the contact is taken as softer than it is"
            )
            yield Notice("yield-pressure-low", message, given.si, first.pressure)
        return
    limit = first.load
    if peak > limit:
        message = (
            f"the contact yields below its surface (von Mises) beyond {_force(limit)} and is loaded with "
            f"{_force(peak)}, {peak / limit:.3g} times that: the elastic law "
            f"{'says little about this force' if peak > FAR_BEYOND * limit else 'is stretched'}; give "
            f"contact.yield_pressure{otherwise}"
        )
        yield Notice("contact-yield", message, peak, limit)


def _force(newtons: float) -> str:
    """Return a force in words, N or kN."""
    return f"{newtons:.3g} N" if newtons < 1e3 else f"{newtons / 1e3:.3g} kN"


def _rail(case: Case) -> Iterator[Notice]:
    """Say where the rail holds the object against the spring, away from its stop."""
    if case.launched() is not None or case.object is None:
        return
    o = case.rig().object
    holds = max((value.si for value in (o.friction, o.stiction) if value is not None), default=0.0)
    if holds > o.preload.si:
        message = (
            f"the rail holds with up to {_force(holds)} what the preload pulls back with {_force(o.preload.si)}: the "
            "object need not come back to its stop; give it more preload, or less friction"
        )
        yield Notice("rail-holds", message, holds, o.preload.si)


def _recorder(case: Case, struck: Sequence[Blow]) -> Iterator[Notice]:
    recorder = case.impact().recorder
    begin = recorder.begin
    end = begin + recorder.memory.si / recorder.sampling_rate.si
    last = struck[-1].time + struck[-1].width
    if end < last:
        lost = sum(blow.time + blow.width > end for blow in struck)
        message = (
            f"the recorder's memory ends before {lost} of {len(struck)} blows: give it more memory or a lower rate"
        )
        yield Notice("recorder-memory", message, end, last)
    if begin > struck[0].time:
        message = f"the recorder starts at {begin * 1e3:.4g} ms, after the first blow: shorten recorder.delay"
        yield Notice("recorder-delay", message, begin, struck[0].time)
    intervals = struck[0].width * recorder.sampling_rate.si
    if intervals < FEWEST_INTERVALS:
        message = f"{intervals:.1f} sampling intervals a pulse: the recorded peak may be more than 1 % low"
        yield Notice("recorder-rate", message, intervals, FEWEST_INTERVALS)
