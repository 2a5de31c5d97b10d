"""Random cases that tests share: machines of every kind, in other units and on another scale; chains of bodies.

Nothing here asks strikewave what a unit is: factors and dimensions are written down.
"""

from __future__ import annotations

import itertools
import re
from fractions import Fraction
from typing import NamedTuple

from hypothesis import strategies as st

from strikewave import load_case
from strikewave.contact import Chain, ChainContact, Contact, Spring, exact

KINDS = {
    "rotary": "li-ma-2019",
    "falling-ball": "iso-16063-22-dropball",
    "drop": "jesd22-b111-b",
    "pendulum": "mil-s-901d-hammer",
    "machete": "machete-13-teeth",
    "gas-gun": "en-166-ball",
    "amplifier": "rodgers-2009-amplifier",
    "dual-mass-amplifier": "dual-mass-amplifier",
}
"""A built-in case of every kind of machine."""


class Unit(NamedTuple):
    """The SI unit of a typed one, how many are in it, and the powers of mass, length and time."""

    si: str
    size: float
    powers: tuple[int, int, int]


def _units():
    pound, inch, pi = 0.45359237, 0.0254, 3.141592653589793
    gravity = 9.80665
    rows = {
        ("m", (0, 1, 0)): {"m": 1.0, "mm": 1e-3, "um": 1e-6, "in": inch, "ft": 12 * inch},
        ("kg", (1, 0, 0)): {"kg": 1.0, "gram": 1e-3, "lb": pound},
        ("s", (0, 0, 1)): {"s": 1.0, "ms": 1e-3, "us": 1e-6},
        ("m/s", (0, 1, -1)): {"m/s": 1.0, "mm/s": 1e-3, "ft/s": 12 * inch, "km/hour": 1 / 3.6},
        ("m/s^2", (0, 1, -2)): {"m/s^2": 1.0, "g": gravity, "ft/s^2": 12 * inch},
        ("rad", (0, 0, 0)): {"rad": 1.0, "deg": pi / 180},
        ("rad/s", (0, 0, -1)): {"rad/s": 1.0, "rpm": pi / 30, "deg/s": pi / 180},
        ("N", (1, 1, -2)): {"N": 1.0, "kN": 1e3, "MN": 1e6, "lbf": pound * gravity},
        ("N m", (1, 2, -2)): {"N m": 1.0, "kN m": 1e3, "lbf ft": pound * gravity * 12 * inch},
        ("N/m", (1, 0, -2)): {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6, "GN/m": 1e9, "lbf/in": pound * gravity / inch},
        ("N s/m", (1, 0, -1)): {"N s/m": 1.0, "kN s/m": 1e3, "lbf s/in": pound * gravity / inch},
        ("N m s/rad", (1, 2, -1)): {"N m s/rad": 1.0, "mN m s/rad": 1e-3},
        ("kg m^2", (1, 2, 0)): {"kg m^2": 1.0, "lb ft^2": pound * (12 * inch) ** 2},
        ("Pa", (1, -1, -2)): {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9, "psi": pound * gravity / inch**2},
        ("Hz", (0, 0, -1)): {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6},
    }
    return {word: Unit(si, size, powers) for (si, powers), sizes in rows.items() for word, size in sizes.items()}


UNITS = _units()
"""What the built-in cases are typed in, and units of other habits; inch, pound and standard gravity are exact."""


def typed_quantities(case, but=("recorder", "solver")):
    """Return the typed quantities of a case by path: number (a `Fraction`) and `Unit`; none of some tables."""
    found = {}
    for path, value in case.values().items():
        match = re.fullmatch(r"([-+.\deE]+) (.+)", str(value.typed))
        if match and path.split(".")[0] not in but:
            found[path] = Fraction(match[1]), UNITS[match[2]]
    return found


@st.composite
def other_units(draw, case):
    """Draw changes that say the quantities of a case in other units."""
    changes = []
    for path, (number, unit) in typed_quantities(case, but=()).items():
        alike = [word for word, other in UNITS.items() if other.si == unit.si]
        word = draw(st.sampled_from(alike))
        other = float(number * Fraction(unit.size) / Fraction(UNITS[word].size))
        changes.append(f"{path}={other!r} {word}")
    return changes


def on_scale(case, mass, length, time):
    """Return changes that take a case to another scale: each quantity times the powers of its dimension."""
    changes = []
    for path, (number, unit) in typed_quantities(case).items():
        m, l, t = unit.powers  # noqa: E741
        changes.append(f"{path}={float(number) * unit.size * mass**m * length**l * time**t!r} {unit.si}")
    return changes


@st.composite
def changed(draw, name):
    """Draw changes of a built-in machine: its striker, frame, contact and rail by up to some times."""
    case = load_case(name)
    now = {path: value.si for path, value in case.values().items()}
    share = draw(st.floats(0.3, 3.0))
    striker = now["striker.mass"] * (1.0 if case.machine.kind == "pendulum" else share)
    return [
        f"striker.mass={striker!r} kg",
        f"object.frame_stiffness={now['object.frame_stiffness'] * draw(st.floats(0.2, 5.0))!r} N/m",
        f"object.frame_damping={now['object.frame_damping'] * draw(st.floats(0.0, 2.0))!r} N s/m",
        f"contact.restitution={draw(st.floats(0.2, 1.0))!r}",
        *(["feed.blows=2"] if case.feed is not None else []),
    ]


@st.composite
def chains(draw):
    """Draw a free chain of two to four bodies on springs and lossy contacts, that touch, and their speeds."""
    count = draw(st.integers(2, 4))
    masses = {f"b{i}": 10.0 ** draw(st.floats(-2.0, 1.0)) for i in range(count)}
    links = []
    for behind, ahead in itertools.pairwise(masses):
        if draw(st.booleans()):
            stiffness = 10.0 ** draw(st.floats(4.0, 8.0))
            links.append(Spring(behind, ahead, stiffness, draw(st.floats(0.0, 0.1)) * stiffness**0.5))
        else:
            law = Contact(
                10.0 ** draw(st.floats(7.0, 10.0)), draw(st.floats(1.0, 2.0)), float(exact(draw(st.floats(0.2, 1.0))))
            )
            links.append(ChainContact(behind, ahead, law, slowest_approach=0.1))
    speeds = {name: draw(st.floats(-5.0, 5.0)) for name in masses}
    return Chain(masses, links=links), speeds
