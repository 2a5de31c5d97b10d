"""The parts of a rotary machine with their numbers, as the table beside its drawing gives them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from strikewave.analyses.machine.figures.geometry import StrikeGeometry
from strikewave.analyses.machine.kind import DROP_HEIGHT, PartEntry, PartNumber
from strikewave.base.quantities import PROVENANCES
from strikewave.base.units import USUAL, in_unit
from strikewave.reporting.curves import shortened
from strikewave.reporting.numbers import spelled
from strikewave.reporting.parts import written

if TYPE_CHECKING:
    from strikewave.base.quantities import Value
    from strikewave.cases.case import Case

DRAWN = {"deg": "°", "gram": "g", "rpm": "r/min"}
"""Units that drawings spell otherwise than sentences do."""
MOST_LAYERS = 6
"""Layers of a stack that are listed one by one."""


def significant(value: float, digits: int = 4) -> str:
    """Write a number to so many significant digits, without an exponent where it stays readable.

    Examples
    --------
    >>> significant(5.501265), significant(40000.0), significant(1e-7), significant(-0.0)
    ('5.501', '40000', '1e-07', '0')
    """
    return written(value + 0.0, digits)  # no zero has a sign


def quantity(name: str, value: Value | None, unit: str = "") -> list[PartNumber]:
    """Return one entry for a value of a case in a unit, none where it is absent."""
    return [] if value is None else [PartNumber(name, shown(value, unit), value.provenance)]


def shown(value: Value, unit: str) -> str:
    """Write a value of a case in a unit, as a drawing shows it."""
    number = in_unit(value.si, dict(USUAL.keys())[unit], unit) if unit else value.si
    return f"{significant(float(number))}{'' if unit in ('', 'deg') else ' '}{DRAWN.get(unit, spelled(unit))}"


def length(name: str, value: Value | None) -> list[PartNumber]:
    """Return an entry in mm."""
    return quantity(name, value, "mm")


def stiffness(name: str, value: Value | None) -> list[PartNumber]:
    """Return an entry in kN/m, from a million on in MN/m."""
    unit = "kN/m" if value is None or value.si < 1e6 else "MN/m"
    return quantity(name, value, unit)


def damping(name: str, value: Value | None) -> list[PartNumber]:
    """Return an entry in N s/m."""
    return quantity(name, value, "N s/m")


def mass(name: str, value: Value | None) -> list[PartNumber]:
    """Return an entry in kg, below a tenth in g."""
    return quantity(name, value, "gram" if value is not None and value.si < 0.1 else "kg")


def fall(height: Value | None, friction: Value | None) -> list[PartNumber]:
    """Return the entries of a free fall: its height, and the friction on the way as a share of the weight."""
    return [*quantity(DROP_HEIGHT.label, height, DROP_HEIGHT.usual), *quantity("friction of weight", friction)]


def provenance_words(parts: Sequence[PartEntry]) -> str:
    """Say how many of the numbers of some parts have each provenance."""
    marks = [entry.provenance for part in parts for entry in part.entries if entry.provenance != "computed"]
    counted = [f"{marks.count(word)} {word}" for word in PROVENANCES if word in marks]
    return f"Of the {len(marks)} numbers shown {', '.join(counted)}."


def machine_parts(case: Case, geometry: StrikeGeometry) -> list[PartEntry]:
    """Return the parts of a rotary machine in the order in which a blow runs through them."""
    return [*_struck_by(case, geometry), *_object(case), *_held_by(case)]


def _struck_by(case: Case, geometry: StrikeGeometry) -> Iterator[PartEntry]:
    """Yield turntable, strikers and the strike itself."""
    tables = case.rotary_tables()
    machine, striker = tables.machine, tables.striker
    yield PartEntry(
        "turntable",
        "turntable",
        [
            *quantity("speed", machine.speed, "rpm"),
            *quantity("inertia", machine.inertia, "kg m^2"),
            *quantity("drive, at most", machine.torque, "N m"),
        ],
    )
    yield PartEntry(
        "striker",
        "strikers",
        [
            *quantity("count", machine.strikers),
            *length("path radius R", machine.radius),
            *length("nose radius", striker.nose_radius),
            *mass("moving mass, each", striker.mass),
            *stiffness("mount", striker.mount_stiffness),
        ],
    )
    angle, approach = geometry.touch_angle(), geometry.approach(machine.speed.si)
    meets = "none" if math.isnan(angle) else f"{significant(-math.degrees(angle), 3)}°"
    speed = "none" if math.isnan(approach) else f"{significant(approach, 4)} m/s"
    yield PartEntry(
        "strike",
        "strike",
        [
            *length("engagement q", machine.engagement),
            *quantity("blow to radius", machine.blow_angle, "deg"),
            *length("face width", machine.face_width),
            PartNumber("angle from first touch", meets, "computed"),
            PartNumber("approach, nominal", speed, "computed"),
        ],
    )


def _object(case: Case) -> Iterator[PartEntry]:
    """Yield nose, frame and assembly, or the layers of a stack."""
    struck, layers = case.rotary_tables().object, case.stack.layer
    for layer in layers[:MOST_LAYERS]:
        entries = length("length", layer.length)
        entries += length("diameter", layer.diameter)
        entries += quantity("area", layer.area, "mm^2") if layer.diameter is None else []
        yield PartEntry(f"layer {layer.name}", shortened(layer.name, 16), entries)
    if layers:
        if len(layers) > MOST_LAYERS:
            yield PartEntry("", f"{len(layers) - MOST_LAYERS} further layers", [])
        return
    entries = [*mass("mass of the object", struck.mass), *mass("of it the nose", struck.nose_mass)]
    yield PartEntry("nose", "nose", entries)
    entries = [*stiffness("stiffness", struck.frame_stiffness), *damping("damping", struck.frame_damping)]
    yield PartEntry("frame", "frame", entries)
    yield PartEntry("assembly", "assembly with sensor", [])


def _held_by(case: Case) -> Iterator[PartEntry]:
    """Yield what holds and feeds the object."""
    tables = case.rotary_tables()
    struck, feed = tables.object, tables.feed
    preload = quantity("preload", struck.preload, "N")
    yield PartEntry("spring", "heavy-load spring", [*stiffness("rate", struck.spring), *preload])
    yield PartEntry("damper", "damper", damping("damping", struck.damper))
    restitution = quantity("restitution", struck.stop_restitution)
    yield PartEntry("stop", "stop", [*stiffness("stiffness", struck.stop_stiffness), *restitution])
    carried = quantity("gravity along blow", struck.gravity, "m/s^2")
    carried += quantity("friction of the rails", struck.friction, "N")
    yield PartEntry("carriage", "carriage", carried)
    time = quantity("stroke time", feed.stroke_time, "ms")
    yield PartEntry("feed", "feed", [*length("stroke s", feed.stroke), *time])
