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


def number_entry(name: str, value: Value | None, unit: str = "") -> list[PartNumber]:
    """Return one entry for a value of a case in a unit, none where it is absent."""
    return [] if value is None else [PartNumber(name, written_value(value, unit), value.provenance)]


def written_value(value: Value, unit: str) -> str:
    """Write a value of a case in a unit, as a drawing shows it."""
    number = in_unit(value.si, dict(USUAL.keys())[unit], unit) if unit else value.si
    return f"{significant(float(number))}{'' if unit in ('', 'deg') else ' '}{DRAWN.get(unit, spelled(unit))}"


def length_entry(name: str, value: Value | None) -> list[PartNumber]:
    """Return an entry in mm."""
    return number_entry(name, value, "mm")


def stiffness_entry(name: str, value: Value | None) -> list[PartNumber]:
    """Return an entry in kN/m, from a million on in MN/m."""
    unit = "kN/m" if value is None or value.si < 1e6 else "MN/m"
    return number_entry(name, value, unit)


def damping_entry(name: str, value: Value | None) -> list[PartNumber]:
    """Return an entry in N s/m."""
    return number_entry(name, value, "N s/m")


def mass_entry(name: str, value: Value | None) -> list[PartNumber]:
    """Return an entry in kg, below a tenth in g."""
    return number_entry(name, value, "gram" if value is not None and value.si < 0.1 else "kg")


def fall_entries(height: Value | None, friction: Value | None) -> list[PartNumber]:
    """Return the entries of a free fall: its height, and the friction on the way as a share of the weight."""
    return [*number_entry(DROP_HEIGHT.label, height, DROP_HEIGHT.usual), *number_entry("friction of weight", friction)]


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
            *number_entry("speed", machine.speed, "rpm"),
            *number_entry("inertia", machine.inertia, "kg m^2"),
            *number_entry("drive, at most", machine.torque, "N m"),
        ],
    )
    yield PartEntry(
        "striker",
        "strikers",
        [
            *number_entry("count", machine.strikers),
            *length_entry("path radius R", machine.radius),
            *length_entry("nose radius", striker.nose_radius),
            *mass_entry("moving mass, each", striker.mass),
            *stiffness_entry("mount", striker.mount_stiffness),
        ],
    )
    angle, approach = geometry.touch_angle(), geometry.approach(machine.speed.si)
    meets = "none" if math.isnan(angle) else f"{significant(-math.degrees(angle), 3)}°"
    speed = "none" if math.isnan(approach) else f"{significant(approach, 4)} m/s"
    yield PartEntry(
        "strike",
        "strike",
        [
            *length_entry("engagement q", machine.engagement),
            *number_entry("blow to radius", machine.blow_angle, "deg"),
            *length_entry("face width", machine.face_width),
            PartNumber("angle from first touch", meets, "computed"),
            PartNumber("approach, nominal", speed, "computed"),
        ],
    )


def _object(case: Case) -> Iterator[PartEntry]:
    """Yield nose, frame and assembly, or the layers of a stack."""
    struck, layers = case.rotary_tables().object, case.stack.layer
    for layer in layers[:MOST_LAYERS]:
        entries = length_entry("length", layer.length)
        entries += length_entry("diameter", layer.diameter)
        entries += number_entry("area", layer.area, "mm^2") if layer.diameter is None else []
        yield PartEntry(f"layer {layer.name}", shortened(layer.name, 16), entries)
    if layers:
        if len(layers) > MOST_LAYERS:
            yield PartEntry("", f"{len(layers) - MOST_LAYERS} further layers", [])
        return
    entries = [*mass_entry("mass of the object", struck.mass), *mass_entry("of it the nose", struck.nose_mass)]
    yield PartEntry("nose", "nose", entries)
    entries = [*stiffness_entry("stiffness", struck.frame_stiffness), *damping_entry("damping", struck.frame_damping)]
    yield PartEntry("frame", "frame", entries)
    yield PartEntry("assembly", "assembly with sensor", [])


def _held_by(case: Case) -> Iterator[PartEntry]:
    """Yield what holds and feeds the object."""
    tables = case.rotary_tables()
    struck, feed = tables.object, tables.feed
    preload = number_entry("preload", struck.preload, "N")
    yield PartEntry("spring", "heavy-load spring", [*stiffness_entry("rate", struck.spring), *preload])
    yield PartEntry("damper", "damper", damping_entry("damping", struck.damper))
    restitution = number_entry("restitution", struck.stop_restitution)
    yield PartEntry("stop", "stop", [*stiffness_entry("stiffness", struck.stop_stiffness), *restitution])
    carried = number_entry("gravity along blow", struck.gravity, "m/s^2")
    carried += number_entry("friction of the rails", struck.friction, "N")
    yield PartEntry("carriage", "carriage", carried)
    time = number_entry("stroke time", feed.stroke_time, "ms")
    yield PartEntry("feed", "feed", [*length_entry("stroke s", feed.stroke), *time])
