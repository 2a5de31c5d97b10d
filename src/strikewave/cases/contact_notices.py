"""Notices on the contact law of a case: its status, yield, and sizes and speeds beyond its range."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, Protocol

from strikewave.base.citations import FROM_MEMORY
from strikewave.base.constants import Material, material
from strikewave.base.quantities import AUTO, Value
from strikewave.base.result import FAILED, INFO, Notice
from strikewave.base.texts import percent, plain
from strikewave.cases.case import Case
from strikewave.cases.contact_of_case import cap_geometry, cushion_contact, cushion_of_contact, struck_material
from strikewave.cases.stack_of_case import DEFAULT_LAW, layer_material
from strikewave.cases.tables.contact import CUSHION, POWER, ContactTable
from strikewave.cases.tables.machine import AnyStriker
from strikewave.cases.tables.stack import LayerTable
from strikewave.contact import (
    FirstYield,
    Geometry,
    automatic_pressure,
    contact_modulus,
    damping_law,
    factor,
    first_yield,
    restitution,
    stiffness_law,
)
from strikewave.contact.cushions import cushion_law
from strikewave.contact.registry import Law

SAME_RESTITUTION = 1e-9
"""Two restitutions that differ by less are the same: far more than rounding of the closed form, far less than any law
errs."""
LARGEST_STRAIN = 1.0  # nothing is then left of a cushion whose law does not end before
KILO = 1e3  # newtons from which on a force is written in kN


class PressedBlow(Protocol):
    """A blow with the numbers of its contact, SI, such as `strikewave.machines.Blow`."""

    @property
    def indentation(self) -> float:
        """Largest indentation, m."""

    @property
    def residual_indentation(self) -> float:
        """Residual indentation, m."""

    @property
    def restitution(self) -> float:
        """Root of the work given back over the work taken."""

    @property
    def peak_force(self) -> float:
        """Largest force, N."""


def law_notices(case: Case) -> Iterator[Notice]:
    """Report where a contact law is from memory, or gives two free bodies another restitution than was asked for."""
    contact = case.contact
    if contact is None:
        return
    laws: list[Law] = [damping_law(contact.damping)]
    if contact.law == CUSHION:
        laws.append(cushion_law(cushion_of_contact(contact).law))
    elif contact.law != POWER:
        laws.append(stiffness_law(contact.law))
    for law in laws:
        if law.status == FROM_MEMORY:
            message = f"the contact law {law.name} is from memory: no text that states it could be opened"
            yield Notice("law-from-memory", message, 1.0, 0.0, severity=INFO)
    asked = contact.restitution.si
    resulting = float(restitution(factor(contact.damping, asked)))
    if abs(resulting - asked) > SAME_RESTITUTION:
        message = (
            f"the damping law {contact.damping} gives two free bodies e = {resulting:.4f}, not the {asked:g} asked "
            "for; exact gives it"
        )
        yield Notice("restitution-differs", message, resulting, asked)


def first_yield_of(striker: AnyStriker, contact: ContactTable, face: Material) -> FirstYield | None:
    """Return first yield of a striker on a face, or of the face below it; None where it is not known."""
    geometry = cap_geometry(striker, contact)
    return None if geometry is None else first_yield(material(striker.material), face, geometry)


def low_pressure_notices(striker: AnyStriker, contact: ContactTable, face: Material) -> Iterator[Notice]:
    """Warn where the largest pressure that was given lies below first yield."""
    first, cap = first_yield_of(striker, contact, face), contact.yield_pressure
    if first is not None and isinstance(cap, Value) and cap.si < first.pressure:
        message = (
            f"contact.yield_pressure, {plain(cap.si / 1e6, 4)}\xa0MPa, is below the "
            f"{plain(first.pressure / 1e6, 4)}\xa0MPa at which the "
            "weaker material first yields inside: the contact is taken as softer than it is"
        )
        yield Notice("yield-pressure-low", message, cap.si, first.pressure)


def yield_notices(striker: AnyStriker, contact: ContactTable, face: Material, peak: float) -> Iterator[Notice]:
    """Warn where an elastic contact goes beyond its first yield, or a cap lies below it.

    ``face`` is the material that is hit, ``peak`` the largest force, N.
    """
    yield from low_pressure_notices(striker, contact, face)
    first = first_yield_of(striker, contact, face)
    if first is not None and contact.yield_pressure is None and peak > first.load:
        message = (
            f"the contact yields below its surface (von Mises) beyond {force_words(first.load)} and is loaded with "
            f"{force_words(peak)}: the elastic law is outside its range; give contact.yield_pressure, such as "
            f'"{AUTO}"'
        )
        yield Notice("contact-yield", message, peak, first.load)


def joint_yield_notices(case: Case, greatest: Sequence[float]) -> Iterator[Notice]:
    """Warn where an elastic contact between two layers of a stack goes beyond its first yield.

    ``greatest`` are the largest forces of the blow at each joint of the stack, N, to which a preload adds.
    """
    layers = {layer.name: k for k, layer in enumerate(case.stack.layer)}
    for joint in case.stack.joint:
        if joint.kind != "contact" or joint.yield_pressure is not None or joint.radius is None:
            continue
        place = layers[joint.after]
        one, other = case.stack.layer[place : place + 2]
        of_line = "length" in stiffness_law(joint.law or DEFAULT_LAW).needs
        geometry = Geometry(joint.radius.si, length=joint.length.si if of_line and joint.length else None)
        first_body, second_body = (layer_material(x, f"stack.layer.{x.name}") for x in (one, other))
        first = first_yield(first_body, second_body, geometry)
        peak = float(greatest[place]) + (joint.preload.si if joint.preload else 0.0)
        if first is not None and peak > first.load:
            field = f"stack.joint.{joint.after}.yield_pressure"
            message = (
                f"the contact between {one.name} and {other.name} yields below its surface (von Mises) beyond "
                f"{force_words(first.load)} and is loaded with {force_words(peak)}: the elastic law is outside its "
                f'range; give {field}, such as "{AUTO}"'
            )
            yield Notice("contact-yield", message, peak, first.load)


def cushion_notices(case: Case, pressed: Sequence[PressedBlow]) -> Iterator[Notice]:
    """Report the strain of the cushion of a case's contact, the work that it gives back, and its set."""
    contact = case.contact
    if contact is None or contact.law != CUSHION or not pressed:
        return
    cushion, law = cushion_of_contact(contact), cushion_contact(contact)
    thickness, area = cushion.pad.thickness, cushion.pad.area
    most = max(pressed, key=lambda blow: blow.indentation)
    strain = most.indentation / thickness
    message = (
        f"the cushion ({cushion.law}) is pressed to {percent(strain)} of its {plain(thickness * 1e3)}\xa0mm, with "
        "up to "
        f"{plain(most.peak_force / area / 1e6)}\xa0MPa; it gives back {percent(most.restitution**2)} of the work of "
        "that blow"
    )
    if law.cap is not None:
        message += f", and {plain(pressed[-1].residual_indentation * 1e3)}\xa0mm stay after the last one"
    yield Notice("cushion", message, strain, LARGEST_STRAIN, severity=INFO)
    if strain >= LARGEST_STRAIN:
        message = (
            f"the cushion would be pressed to {percent(strain, 0)} of its thickness, which no pad bears: it is too thin"
        )
        yield Notice("cushion-solid", message, strain, LARGEST_STRAIN, severity=FAILED)
    blows = len(pressed)
    if blows > 1 and (cushion.wear.settling or cushion.wear.stiffening):
        message = (
            f"the cushion does not wear within a run: all {blows} blows meet it as it is after contact.cushion."
            "blows_before; its set is kept"
        )
        yield Notice("cushion-wear", message, float(blows), 1.0, severity=INFO)


def force_words(newtons: float) -> str:
    """Return a force in words, N or kN."""
    return f"{plain(newtons)}\xa0N" if newtons < KILO else f"{plain(newtons / KILO)}\xa0kN"


SLENDER = 10.0
"""Length over thickness of a struck nose from which on it bends like a beam under a blow, and the line of contact is
not loaded evenly. Chosen: the usual lower limit of beam theory; the built-in machine has 3."""
LARGEST_INDENTATION = 0.05
"""Indentation over the radius of a nose beyond which it is warned of: at a twentieth the spot of Hertz has 0.22 of the
radius, and the sphere lies 1.3 % deeper there than the paraboloid that stands for it."""


BALL_MASS_OFF = 0.1
"""Share by which the mass of a ball may differ from that of its size and material. Chosen: a radius rounded to two
digits moves it by 5 % as a rule, the density of steels by 3 %; a diameter typed as a radius gives 8 times it."""


class _Face(NamedTuple):
    """The struck face: its width, m; the field that gives it, what was typed, and whether it is the width itself."""

    width: float
    field: str
    typed: object
    own: bool


def size_notices(case: Case, peak: float, indentation: float | None = None) -> Iterator[Notice]:
    """Warn where the contact of a striker is longer or wider than the face, or the nose heavier than its striker.

    ``peak`` is the largest contact force, N; ``indentation`` the largest, m, by the elastic law where it is not known.
    """
    striker, contact = case.striker, case.contact
    if striker is None or contact is None or contact.law in (POWER, CUSHION):
        return
    face = _struck_face(case)
    if not _of_line(contact.law):
        yield from _spot_notices(case, face, peak, indentation)
        return
    if striker.contact_length is None:
        return
    lengths = [("striker.contact_length", striker.contact_length)]
    for row in getattr(striker, "each", ()):
        if row.contact_length is not None:
            lengths.append((f"striker.each.{row.number.si:.0f}.contact_length", row.contact_length))
    path, length = max(lengths, key=lambda pair: pair[1].si)
    if face is not None and face.own:
        yield from _longer_than_face(path, length, face.width, face.field, face.typed)
    else:
        yield from _slender_nose(case, path, length)
    yield from _heavy_nose(case, path, length)


def ball_notices(case: Case) -> Iterator[Notice]:
    """Warn where the striker is a ball whose mass is not that of its size and material.

    Examples
    --------
    >>> from strikewave.cases.case import load_case
    >>> [notice.code for notice in ball_notices(load_case("iso-16063-22-dropball", ["striker.mass=2 kg"]))]
    ['ball-mass']
    """
    striker, contact = case.striker, case.contact
    if striker is None or contact is None or striker.nose_radius is None:
        return
    if contact.law not in (POWER, CUSHION) and _of_line(contact.law):
        return  # the nose is then a semi-cylinder
    row = material(striker.material, "striker.material")
    ball = 4.0 / 3.0 * math.pi * striker.nose_radius.si**3 * row.density
    if abs(ball - striker.mass.si) > BALL_MASS_OFF * striker.mass.si:
        message = (
            "mass, size and material of the ball contradict one another: one of "
            f"{plain(striker.nose_radius.si * 1e3, 4)}\xa0mm radius "
            f"(striker.nose_radius) of {row.name} (striker.material) has {plain(ball, 4)}\xa0kg, not "
            f"{plain(striker.mass.si, 4)}\xa0kg (striker.mass); correct one of the three"
        )
        yield Notice("ball-mass", message, ball, striker.mass.si)


def joint_size_notices(case: Case) -> Iterator[Notice]:
    """Warn where the line of a contact between two layers is longer than the narrower of them is wide."""
    layers = {layer.name: k for k, layer in enumerate(case.stack.layer)}
    for joint in case.stack.joint:
        if joint.kind != "contact" or joint.length is None or not _of_line(joint.law):
            continue
        first = layers[joint.after]
        face = min((_layer_face(layer) for layer in case.stack.layer[first : first + 2]), key=lambda face: face.width)
        path = f"stack.joint.{joint.after}.length"
        yield from _longer_than_face(path, joint.length, face.width, face.field, face.typed)


def indentation_notices(indentation: float, radius: float) -> Iterator[Notice]:
    """Warn where a sphere goes deep beside its radius, both m."""
    share = indentation / radius
    if share > LARGEST_INDENTATION:
        message = (
            f"the indentation is {plain(100.0 * share, 2)} % of the radius of the nose: Hertz's law holds for small "
            "indentations; look at radius and materials"
        )
        yield Notice("indentation-large", message, share, LARGEST_INDENTATION)


def speed_notices(bodies: Iterable[Material], speed: float, stated: str) -> Iterator[Notice]:
    """Warn where an approach is faster than a wave, or so fast that the inertia of what yields exceeds its strength.

    Above the wave speed c = sqrt(E/rho) of a body nothing runs ahead of the contact, and the elastic stress rho c v/2
    of equal bodies is half the modulus: it is a shock front. From v = sqrt(2 Y/rho) on, the stagnation pressure
    rho v^2/2 of material that flows is above its yield strength Y: contact laws are those of slow pressing, and no
    longer hold. ``stated`` is the field with the value that makes the speed (m/s), such as ``load.speed = 6 km/s``.
    """
    rows = list(bodies)
    slowest = min(rows, key=lambda row: row.bar_speed)
    if speed > slowest.bar_speed:
        message = (
            f"{stated}: the approach at {plain(speed, 4)}\xa0m/s is faster than a wave in {slowest.name}, "
            f"{plain(slowest.bar_speed, 4)}\xa0m/s (sqrt(E/rho)): that is a shock, which these laws do not describe; "
            "look at the unit, and do not trust force or pulse"
        )
        yield Notice("faster-than-wave", message, speed, slowest.bar_speed)
        return
    known = [(row, row.yield_strength) for row in rows if row.yield_strength is not None]
    if not known:
        return
    limit, name = min((math.sqrt(2.0 * strength / row.density), row.name) for row, strength in known)
    if speed > limit:
        message = (
            f"{stated}: the approach at {plain(speed, 4)}\xa0m/s is beyond {plain(limit)}\xa0m/s, where the "
            "inertia of yielding "
            f"{name} exceeds its strength (rho v^2/2 > Y): contact laws are those of slow pressing; do not trust force "
            "or pulse"
        )
        yield Notice("approach-fast", message, speed, limit)


def duration_notices(bodies: Iterable[tuple[str, float]], duration: float) -> Iterator[Notice]:
    """Warn where a contact is over before a wave has come back through a body: it does not move as one then.

    Parameters
    ----------
    bodies : iterable of (str, float)
        Material and mass, kg, of each; its size is taken as the edge of a cube.
    duration : float
        Duration of the contact, s.
    """
    returns = [
        (2.0 * (mass / row.density) ** (1.0 / 3.0) / row.bar_speed, mass, row.name)
        for row, mass in ((material(name), mass) for name, mass in bodies)
        if math.isfinite(mass)
    ]
    slowest = max(returns, default=None)
    if slowest is not None and duration < slowest[0]:
        back, mass, name = slowest
        message = (
            f"the contact lasts {plain(duration * 1e6)}\xa0us, and a wave takes {plain(back * 1e6)}\xa0us through "
            f"a cube of {plain(mass)}\xa0kg of {name} and back: the body does not move as one; follow it as layers "
            "(strikewave wave)"
        )
        yield Notice("contact-short", message, duration, back)


def damping_speed_notices(contact: ContactTable, approaches: Iterable[float]) -> Iterator[Notice]:
    """Warn where blows come slower than the lowest speed that the damping of the contact uses; approaches in m/s."""
    every = list(approaches)
    slow = [speed for speed in every if speed < contact.slowest_approach.si]
    if not slow:
        return
    message = (
        f"contact.slowest_approach, {plain(contact.slowest_approach.si, 4)}\xa0m/s, is above the approach speed of "
        f"{len(slow)} of "
        f"{len(every)} blows (from {plain(min(slow))}\xa0m/s): their damping is that of a blow at this speed, and they "
        f"give back more than the restitution asked for ({contact.restitution.si:g}); take a tenth of the approach "
        "speed"
    )
    yield Notice("slowest-approach", message, min(slow), contact.slowest_approach.si)


def _of_line(law: str) -> bool:
    return "length" in stiffness_law(law).needs


def _layer_face(layer: LayerTable) -> _Face:
    """Return the face of a layer: of one with an area, that of a round one."""
    if layer.diameter is not None:
        return _Face(layer.diameter.si, f"stack.layer.{layer.name}.diameter", layer.diameter.typed, True)
    area = layer.area
    width = math.inf if area is None else 2.0 * math.sqrt(area.si / math.pi)
    return _Face(width, f"stack.layer.{layer.name}.area", "" if area is None else area.typed, True)


def _struck_face(case: Case) -> _Face | None:
    """Return the struck face, of a nose that of a cube of its mass; None where it is not known."""
    if case.stack.layer:
        return _layer_face(case.stack.layer[0])
    if case.object is None or case.object.nose_mass is None:
        return None
    nose = case.object.nose_mass
    volume = nose.si / material(case.object.material).density
    return _Face(volume ** (1.0 / 3.0), "object.nose_mass", nose.typed, False)


def _longer_than_face(path: str, length: Value, width: float, field: str, typed: object) -> Iterator[Notice]:
    if length.si > width:
        message = (
            f"the line of contact, {plain(length.si * 1e3, 4)}\xa0mm ({path}), is longer than the struck face is wide, "
            f"{plain(width * 1e3, 4)}\xa0mm ({field} = {typed}): the contact is too stiff; give the length that "
            "touches, at most the width"
        )
        yield Notice("contact-longer-than-face", message, length.si, width)


def _slender_nose(case: Case, path: str, length: Value) -> Iterator[Notice]:
    """Warn where a struck nose of its mass, as long as the contact, would be a thin beam."""
    if case.object is None or case.object.nose_mass is None:
        return
    nose, row = case.object.nose_mass, material(case.object.material)
    volume = nose.si / row.density
    thickness = math.sqrt(volume / length.si)
    if length.si > SLENDER * thickness:
        longest = (SLENDER * math.sqrt(volume)) ** (2.0 / 3.0)
        message = (
            f"a struck nose of {plain(nose.si, 4)}\xa0kg (object.nose_mass) of {row.name} that is "
            f"{plain(length.si * 1e3, 4)}\xa0mm long ({path}) "
            f"would be {plain(thickness * 1e3)}\xa0mm thick: it bends, and the line is not loaded evenly; give the "
            f"length of the face (up to {plain(longest * 1e3)}\xa0mm for this mass), or the mass of the nose"
        )
        yield Notice("contact-longer-than-face", message, length.si, longest)


def _heavy_nose(case: Case, path: str, length: Value) -> Iterator[Notice]:
    """Warn where a semi-cylinder of radius and length alone is heavier than the striker."""
    striker = case.striker
    if striker is None or striker.nose_radius is None:
        return
    row = material(striker.material)
    nose = 0.5 * math.pi * striker.nose_radius.si**2 * length.si * row.density
    if nose > striker.mass.si:
        message = (
            f"a semi-cylinder of {plain(striker.nose_radius.si * 1e3, 4)}\xa0mm (striker.nose_radius) and "
            f"{plain(length.si * 1e3, 4)}\xa0mm ({path}) of "
            f"{row.name} has {plain(nose)}\xa0kg, more than the striker ({plain(striker.mass.si, 4)}\xa0kg): one "
            "of the three is wrong"
        )
        yield Notice("nose-heavy", message, nose, striker.mass.si)


def _spot_notices(case: Case, face: _Face | None, peak: float, indentation: float | None) -> Iterator[Notice]:
    """Warn where the spot of a sphere is wider than the face, or deep beside the radius of the nose."""
    striker, contact = case.striker, case.contact
    if striker is None or contact is None or striker.nose_radius is None:
        return
    radius = striker.nose_radius.si
    bodies = material(striker.material), struck_material(case)
    spot = (0.75 * peak * radius / contact_modulus(*bodies)) ** (1.0 / 3.0)
    given = contact.yield_pressure
    if given is not None:
        # by the materials it bears their hardness, the low end, on its whole plastic area
        borne = given.si if isinstance(given, Value) else automatic_pressure(*bodies).low
        spot = max(spot, math.sqrt(peak / (math.pi * borne)))
    if face is not None and 2.0 * spot > face.width:
        whose = "the struck face" if face.own else "a cube of the nose's mass"
        message = (
            f"the spot of contact is {plain(2e3 * spot)}\xa0mm wide at the largest force, and {whose} "
            f"{plain(face.width * 1e3)}\xa0mm ({face.field} = {face.typed}): the law takes the face as endless; give a "
            "smaller striker.nose_radius, or a larger face"
        )
        yield Notice("spot-wider-than-face", message, 2.0 * spot, face.width)
    deep = spot**2 / radius if indentation is None else indentation
    yield from indentation_notices(deep, radius)
