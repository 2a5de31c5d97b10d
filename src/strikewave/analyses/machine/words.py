"""What a machine is and how it was set, in words: for the screen and for the report."""

from __future__ import annotations

from typing import TYPE_CHECKING

from strikewave.reporting.numbers import fixed, with_unit
from strikewave.reporting.parts import Cell, Table

if TYPE_CHECKING:
    from strikewave.analyses.machine.result import Solution
    from strikewave.cases.case import Case

_FREE_OBJECT = ("contact", "nose", "frame", "assembly", "support, where there is one")
MACHINES = {
    "rotary": (
        "A rotary machine: a turntable carries the strikers, a hydraulic feed brings the object into their path, each "
        "striker hits it in turn, and a preloaded spring and a damper bring it back to its stop before the next one "
        "comes. After the wanted number of passes the feed "
        "withdraws the object and the turntable is braked.",
        (
            "turntable",
            "mount",
            "striker",
            "contact",
            "nose",
            "frame",
            "assembly",
            "spring, damper, stop",
            "carriage of the feed",
        ),
    ),
    "falling-ball": (
        "A falling ball: it is let go at a height and falls on the object, whose support carries it. The run begins "
        "just before first touch.",
        ("falling ball", *_FREE_OBJECT),
    ),
    "drop": (
        "A drop table: it falls with what it carries on an anvil; the pulse shaper between them is the contact. "
        "The object is the table with its load, and the blow goes upwards. The run begins just before first touch.",
        ("ground", "mount of the anvil, where there is one", "anvil", "pulse shaper", "nose", "frame", "assembly"),
    ),
    "pendulum": (
        "A pendulum: an arm is let go at an angle, and the striker on it meets the object at the lowest point. The run "
        "begins just before first touch.",
        ("arm", "mount", "striker", *_FREE_OBJECT),
    ),
    "machete": (
        "A Machete hammer: an arm is drawn back by a number of teeth of a ratchet wheel and driven by a weight; the "
        "object sits in its head and meets a fixed anvil. Arm and weight are taken as what gives the object its speed. "
        "The run begins just before first touch.",
        ("anvil", "contact", "nose", "frame", "assembly"),
    ),
    "gas-gun": (
        "A gas gun: gas drives a projectile through a barrel, and it flies at the object. The run begins just before "
        "first touch.",
        ("projectile", *_FREE_OBJECT),
    ),
    "amplifier": (
        "A stacked velocity amplifier: bodies fall in a line, the lowest meets the floor, and each hits the next one, "
        "which leaves faster than it came. The bodies below collide in pairs by their restitutions; the blow of the "
        "last one, the striker, on the object is followed in full. The run begins just before that first touch.",
        ("floor", "bodies", "striker", "contact", "nose", "frame", "assembly"),
    ),
}
"""Kind of machine: its description, and its bodies and links in the order in which a blow runs through them."""

_SHOWN = {
    "rotary": (
        ("speed", "rad/s", "rpm", ""),
        ("strikers", "", "", "strikers"),
        ("engagement", "m", "mm", "engagement"),
    ),
    "falling-ball": (("height", "m", "m", "drop height"),),
    "drop": (("height", "m", "m", "drop height"),),
    "pendulum": (("angle", "rad", "deg", "release angle"), ("radius", "m", "m", "radius")),
    "machete": (("teeth", "", "", "teeth"), ("weight", "kg", "kg", "weight"), ("radius", "m", "m", "radius")),
    "gas-gun": (("speed", "m/s", "m/s", "speed"), ("pressure", "Pa", "bar", "pressure, absolute")),
    "amplifier": (("height", "m", "m", "drop height"),),
}
"""Kind of machine: field, SI unit, unit shown and name of each setting that stands in the head."""
_OF_LAUNCH = {
    "approach_speed": ("approach speed at first touch", "m/s", "m/s"),
    "energy_released": ("energy given on the way to first touch", "J", "J"),
    "energy_at_touch": ("kinetic energy of what meets, at first touch", "J", "J"),
    "gain": ("gain of the line: fastest speed of the object over that at the floor", "", ""),
}

COLLISION_HEADS = (
    *("time (ms)", "lower", "upper", "lower before (m/s)", "upper before (m/s)"),
    *("lower after (m/s)", "upper after (m/s)", "impulse (N s)", "energy lost (J)"),
)


def settings(solution: Solution) -> list[str]:
    """Return the main settings of a machine, each with its unit."""
    case = solution.case
    shown = []
    for key, si, unit, name in _SHOWN.get(getattr(case.machine, "kind", ""), ()):
        value = getattr(case.machine, key)
        if value is not None:
            shown.append(f"{name} {with_unit(value.si, si, unit)}".strip() if si else f"{value.si:.0f} {name}")
    approach = solution.launch.get("approach_speed", solution.reference.approach_speed)
    shown += [f"nominal approach {approach:.4g} m/s", f"object {solution.masses['object']:.4g} kg"]
    return shown + ([f"{case.feed.blows.si:.0f} blows wanted"] if case.feed else [])


def reference_law(case: Case) -> str:
    """Return in words which law stands beside the blows for comparison."""
    return "the printed contact law" if case.launched() is None else "the contact law of the case"


def launch_tables(solution: Solution) -> list[Table]:
    """Return how a machine without a drive came to first touch; nothing for one with a drive."""
    if not solution.launch:
        return []
    rows: list[list[Cell]] = []
    for key, value in solution.launch.items():
        name, si, unit = _OF_LAUNCH[key]
        rows.append([name, with_unit(value, si, unit, 6) if si else f"{value:.4g}"])
    made = [Table("Up to first touch", ["quantity", "value"], rows)]
    collisions: list[list[Cell]] = [list(row) for row in collision_rows(solution)]
    if collisions:
        caption = "Collisions in the line, by restitution alone; speeds upwards, time after the lowest met the floor"
        made.append(Table(caption, list(COLLISION_HEADS), collisions))
    return made


def collision_rows(solution: Solution) -> list[list[str]]:
    """Return the collisions of an amplifier as the rows of a table; see `COLLISION_HEADS`."""
    return [
        [
            fixed(c.time, "s", "ms", 4),
            c.lower,
            c.upper,
            *(f"{v:.4f}" for v in (c.lower_before, c.upper_before, c.lower_after, c.upper_after)),
            f"{c.impulse:.5g}",
            f"{c.energy_lost:.5g}",
        ]
        for c in solution.collisions
    ]
