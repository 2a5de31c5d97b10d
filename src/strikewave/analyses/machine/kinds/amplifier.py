"""A stacked velocity amplifier: bodies that fall in a line and hit one another, each faster than the one below."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import DROP_HEIGHT, Drawing, LaunchedKind, PartEntry, Release
from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.base.errors import InputError
from strikewave.base.quantities import DropHeight, Mass, MaybeGap, MaybeShare, Restitution
from strikewave.base.result import INFO, Notice
from strikewave.cases.tables.common import CaseTable, Name

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.machines.amplifier import Collision, Collisions

LONGEST_LINE = 1.0
"""Longest time for which a line is followed until its top body is struck, s: the largest `machine.follow`."""
MOST_COLLISIONS = 1000
"""Collisions at which a line is given up: chosen; bodies that come to rest on one another collide without end."""
FLOOR, STRIKER, OBJECT = "floor", "striker", "object"
"""Names of the bodies that have no row of their own."""


class BodyTable(CaseTable):
    """[[machine.body]]: a body of the amplifier below the striker: restitution to the body above, and gap to it (0)."""

    name: Name
    mass: Mass
    restitution: Restitution
    gap: MaybeGap = None


class Amplifier(LaunchedKind):
    """[machine]: bodies that fall in a line on a floor and hit one another, each faster than the one below.

    From the floor up: the rows of [[machine.body]], [striker], [object]. ``restitution`` is that of the lowest body on
    the floor, ``gap`` that between striker and object (0); the restitution of those two is that of [contact].
    """

    kind: Literal["amplifier"]
    height: DropHeight
    restitution: Restitution
    gap: MaybeGap = None
    friction: MaybeShare = None
    body: tuple[BodyTable, ...] = ()

    description: ClassVar[str] = (
        "A stacked velocity amplifier: bodies fall in a line, the lowest meets the floor, and each hits the next one, "
        "which leaves faster than it came. The bodies below collide in pairs by their restitutions; the blow of the "
        "last one, the striker, on the object is followed in full. The run begins just before that first touch."
    )
    chain: ClassVar[tuple[str, ...]] = ("floor", "bodies", "striker", "contact", "nose", "frame", "assembly")
    settings: ClassVar = {"height": DROP_HEIGHT}
    sources: ClassVar[tuple[str, ...]] = ("rodgers-2009",)
    falls: ClassVar = "both"

    def release(self, case: Case, mass: float) -> Release:
        """Return striker and object as the collisions below leave them when they first meet."""
        from strikewave.analyses.machine.build import guided_fall
        from strikewave.cases.contact_of_case import or_else
        from strikewave.machines.amplifier import BodyLine, collide

        parts = case.impact()
        names = [FLOOR, STRIKER, OBJECT]
        for row in self.body:
            if row.name in names:
                allowed = f"a name of its own, none of {', '.join(names)}"
                raise InputError(f"machine.body.{row.name}.name", row.name, allowed)
            names.append(row.name)
        bodies = (*(row.mass.si for row in self.body), parts.striker.mass.si, mass)
        speed, travel, energy = guided_fall(self.height, self.friction, sum(bodies))
        line = BodyLine(
            masses=(math.inf, *bodies),
            restitutions=(
                self.restitution.si,
                *(row.restitution.si for row in self.body),
                parts.contact.restitution.si,
            ),
            gaps=(0.0, *(or_else(row.gap, 0.0) for row in self.body), or_else(self.gap, 0.0)),
            speeds=(0.0, *(-speed for _ in bodies)),
            gravity=STANDARD_GRAVITY,
        )
        top = len(bodies) - 1
        struck = next((c for c in collide(line, LONGEST_LINE, MOST_COLLISIONS).collisions if c.pair == top), None)
        if struck is None:
            allowed = f"a line whose object is struck within {LONGEST_LINE:g} s and {MOST_COLLISIONS} collisions"
            hint = "take smaller gaps or lighter upper bodies"
            raise InputError("machine.body", f"{len(bodies)} bodies", allowed, hint)
        followed = collide(line, struck.time + self.follow.si, MOST_COLLISIONS)
        notices = [
            Notice("line-of-bodies", word, float(len(followed.collisions)), 0.0, severity=INFO)
            for word in followed.words
        ]
        named = (FLOOR, *(row.name for row in self.body), STRIKER, OBJECT)
        notices += [*_gain_notices(followed, named, self.height.si), *_overlap_notices(case, followed, struck)]
        again = sum(c.pair == top for c in followed.collisions) - 1
        if again:
            message = (
                f"the striker meets the object {again} more times in the line of bodies: only the first is followed"
            )
            notices.append(Notice("later-blows", message, float(again), 0.0, severity=INFO))
        striker, thing = struck.before
        return Release(
            energy,
            travel + struck.time,
            striker=striker,
            object=thing,
            gain=followed.gain,
            line=followed,
            bodies=named,
            notices=tuple(notices),
        )

    def drawing(self, case: Case) -> Drawing:
        """Return a schematic."""
        from strikewave.analyses.machine.figures import drawing as s

        floor = ("restitution, floor", self.restitution, "")
        parts = [s.fall_part("floor", "fall and floor", self.height, self.friction, floor)]
        for row in self.body:
            gap = ("gap above", row.gap, "mm")
            numbers = s.part_numbers(("mass", row.mass, s.MASS), ("restitution above", row.restitution, ""), gap)
            parts.append(PartEntry(row.name, row.name, numbers))
        parts += [s.striker_part(case, "striker"), s.contact_part(case, "contact"), s.object_part(case, "object")]
        sketch = s.Schematic(parts)
        sketch.ground((1.6, 0.6), (8.4, 0.6))
        sketch.number("floor", (1.2, 0.9))
        count = len(self.body) + 2
        step = 6.4 / count
        for k, place in enumerate((*(row.name for row in self.body), "striker", "object")):
            half, low = 1.8 - 1.2 * k / count, 1.1 + k * step
            look = "body" if place == "object" else "striker"
            sketch.block((5.0 - half, low), (5.0 + half, low + 0.72 * step), look, place)
        sketch.number("contact", (6.2, 1.1 + (count - 1) * step - 0.14 * step))
        sketch.arrow((2.2, 6.4), (2.2, 4.8), "all fall")
        sketch.blow((8.4, 5.2), (8.4, 6.8))
        return sketch.drawing("The velocity amplifier")


def _gain_notices(followed: Collisions, names: tuple[str, ...], height: float) -> Iterator[Notice]:
    """Warn where a line does not amplify, or where its gain is not that of its collisions alone."""
    from strikewave.machines.amplifier import gain_limit_of

    line, gain = followed.line, followed.gain
    heavier = [
        f"{names[k + 1]} ({line.masses[k + 1]:.3g} kg) than {names[k]} ({line.masses[k]:.3g} kg)"
        for k in range(1, len(line.masses) - 1)
        if line.masses[k + 1] >= line.masses[k]
    ]
    if heavier:
        message = (
            f"an amplifier grows lighter upwards, but no lighter is {', '.join(heavier)}: a body leaves slower the "
            "heavier it is beside what strikes it; look at the masses"
        )
        yield Notice("bodies-heavier-above", message, float(len(heavier)), 0.0)
    if gain < 1.0:
        message = (
            f"the object leaves with {gain:.3g} of the speed of the fall: the line does not amplify; take a lighter "
            "object, fewer bodies, or higher restitutions"
        )
        yield Notice("no-gain", message, gain, 1.0)
    limit = gain_limit_of(line.restitutions)
    if gain > limit:
        message = (
            f"the gain of {gain:.3g} is more than the {limit:.3g} of these restitutions for vanishing mass ratios: the "
            f"bodies fall another {sum(line.gaps) * 1e3:.3g} mm as their gaps close, beside a height of "
            f"{height * 1e3:.3g} mm, and gain counts from the first collision; take smaller gaps"
        )
        yield Notice("gain-of-gaps", message, gain, limit)


def _overlap_notices(case: Case, followed: Collisions, struck: Collision) -> Iterator[Notice]:
    """Warn where the striker is in two contacts at once: pairs then no longer tell how fast it comes."""
    from strikewave.cases.contact_of_case import face_contact
    from strikewave.contact import solve_impact

    parts, masses = case.impact(), followed.line.masses
    contact = face_contact(parts.striker, parts.contact, material(parts.object.material, "object.material"))
    lasts = float(solve_impact(contact, masses[-2], masses[-1], struck.before[0] - struck.before[1]).duration)
    below = [c.time for c in followed.collisions if c.pair == struck.pair - 1]
    before = struck.time - max((t for t in below if t <= struck.time), default=-math.inf)
    after = min((t for t in below if t > struck.time), default=math.inf) - struck.time
    if min(before, after) < lasts:
        when = f"{before * 1e6:.3g} us before" if before < lasts else f"{after * 1e6:.3g} us after"
        message = (
            f"the striker is hit from below {when} it meets the object, and that contact lasts {lasts * 1e6:.3g} us: "
            "contacts overlap, and collisions in pairs do not hold; take a larger machine.gap, or follow the line by "
            "strikewave.machines.amplifier.collide_softly"
        )
        yield Notice("contacts-overlap", message, min(before, after), lasts)
