"""The numbers that Li & Ma 2019 publish, and what they say of each other."""

from __future__ import annotations

import functools
import math
from typing import Literal

from strikewave.base import declare
from strikewave.base.constants import Material
from strikewave.base.declare import Quantity
from strikewave.base.errors import InputError, nearest
from strikewave.base.units import DIMENSIONS, convertible, parse_quantity, take_apart
from strikewave.cases.case import load_case
from strikewave.cases.tables.fem import FramePart, HalfCylinder
from strikewave.contact import contact_modulus

Origin = Literal["measured", "simulated", "given"]
SEE_UNIT = Quantity.of_data("SI, see unit")
"""Quantity of a number whose unit stands beside it."""


@declare.dataclass
class PublishedNumber:
    """A number that the paper publishes: ``value`` in SI units, ``unit`` as the paper writes it."""

    name: str = declare.word('key of the number, such as "rigid peak simulated"')
    where: str = declare.word("section, figure or table that says it")
    quantity: str = declare.word("what it is")
    value: float
    unit: str
    origin: Origin = declare.word("measured, simulated (with LS-DYNA) or given (chosen or stated by the authors)")
    note: str = declare.word("what must be known to use it", default="")


@declare.dataclass
class Consistency:
    """A check of published numbers among each other."""

    what: str = declare.word("the question")
    uses: tuple[str, ...] = declare.word("names of the published numbers in it")
    quantity: str = declare.word("the number that answers it")
    unit: str = declare.word("its SI unit")
    value: float = declare.number(SEE_UNIT, "what follows from the numbers")
    stated: float | None = declare.number(SEE_UNIT, "what the paper says about it, if it does")
    agrees: bool | None = declare.word("whether the two agree; null where the paper says nothing")
    note: str = declare.word("how it follows, and what it means")


EXPONENT = 10.0 / 9.0
"""Exponent n of the line contact, as (2) and (3) print it."""
_ORDER = 1.0 / (EXPONENT + 1.0)
ELASTIC_DURATION = 2.0 * math.sqrt(math.pi) * math.gamma(1.0 + _ORDER) / math.gamma(0.5 + _ORDER)
"""T v0/d(max) of an elastic blow, 2 int_0^1 dx/sqrt(1 - x^(n + 1)) = 3.090488 for n = 10/9."""
ELEMENTS = "li-ma-2019-fem-rigid"
"""Case whose nose and line of contact stand for those of the impact component, which are not published."""
STRIKERS = 4
"""Impact components that would fit 7 blows in 150 ms at 730 r/min: they take 123 ms; three would take 164 ms."""
ROUNDED = 0.1
"""Two numbers agree with words such as "about" below this difference. Chosen: the error of rounding to one digit."""

_WIDTH = "how its width was measured is not stated"
_EVEN = "stress is even in the specimen from so many transits on"
_NUMBERS: tuple[tuple[str, str, str, str, Origin, str], ...] = (
    ("comparison count", "Figure 5", "impacts of the comparison", "7", "measured", ""),
    ("comparison time", "Figure 5", "time that they take", "150 ms", "measured", "speed of the turntable not given"),
    ("direct peak", "Figure 5", "first pulse, sensor mounted directly", "9707.12 g", "measured", ""),
    ("buffered peak", "Figure 5", "first pulse, sensor buffered and isolated", "6353.22 g", "measured", '"about"'),
    ("exponent", "(2), (3)", "force index of the line contact, 10/9", repr(EXPONENT), "given", ""),
    ("palmgren factor", "(2)", "factor of the indentation", "3.81", "given", "after A. Palmgren"),
    ("integral", "(15)", "integral of the loss", "0.3", "given", ""),
    ("least transits", "section 3.2", f"{_EVEN}, least", "3", "given", "after G. Ravichandran"),
    ("most transits", "section 3.2", f"{_EVEN}, most", "5", "given", "after G. Ravichandran"),
    ("speed", "section 4.1", "speed of the turntable", "730 rpm", "given", "in both experiments"),
    ("count", "Figure 9", "impacts", "11", "measured", ""),
    ("typical peak", "Figure 9", "peak, usually", "4000 g", "measured", '"about"'),
    ("typical width", "Figure 9", "pulse width, usually", "200 us", "measured", '"about"'),
    ("smallest element", "Figure 10", "smallest size of the mesh", "0.5 mm", "given", ""),
    ("gravity", "Figure 10", "gravity", "9.8 m/s^2", "given", "along the blow"),
    ("simulated time", "Figure 10", "time that is simulated", "1 ms", "given", ""),
    ("output interval", "Figure 10", "interval of the results", "1 us", "given", ""),
    ("rigid peak", "Figure 11", "first rigid-body pulse", "4151.25 g", "measured", ""),
    ("rigid width", "Figure 11", "its width", "200 us", "measured", _WIDTH),
    (
        "rigid peak simulated",
        "Figure 11",
        "first rigid-body pulse",
        "4374.52 g",
        "simulated",
        "contact force over mass",
    ),
    ("force simulated", "Figure 11", "largest contact force", "19685.34 N", "simulated", ""),
    ("rigid width simulated", "Figure 11", "its width", "220 us", "simulated", _WIDTH),
    ("wave peak", "Figure 13", "first pulse of the sensor between cylinders", "21909.89 g", "measured", ""),
    ("wave width", "Figure 13", "its width", "252 us", "measured", _WIDTH),
    ("peak ratio", "Figure 13", "its peak over that of Figure 11", "4", "given", '"about"'),
    ("wave peak simulated", "Figure 15", "first pulse, mean of the specimen", "22841.7 g", "simulated", ""),
)
"""Name, place, quantity, text, origin and note of each published number but the materials, in their order."""
_TABLES = (
    ("65Mn", "Tables 1, 2", ("7820 kg/m^3", "211 GPa", "0.288", "430 MPa")),
    ("2A12", "Table 1", ("2780 kg/m^3", "72 GPa", "0.33", "345 MPa")),
    ("45 steel", "Table 2", ("7850 kg/m^3", "210 GPa", "0.31", "355 MPa")),
)
_PROPERTIES = ("density", "Young's modulus", "Poisson's ratio", "yield strength")


@functools.cache
def published_numbers() -> tuple[PublishedNumber, ...]:
    """Return all published numbers in the order of the paper; one without a unit is a count or a ratio.

    Examples
    --------
    >>> numbers = published_numbers()
    >>> numbers[0].quantity, numbers[0].value
    ('impacts of the comparison', 7.0)
    """
    rows = list(_NUMBERS)
    for material, where, texts in _TABLES:
        for what, text in zip(_PROPERTIES, texts, strict=True):
            rows.append((f"{material} {what}", where, f"{material}: {what}", text, "given", ""))
    numbers = []
    for name, where, quantity, text, origin, note in rows:
        typed = take_apart(text)
        assert typed is not None
        unit = typed.unit or "1"
        si = convertible(unit, DIMENSIONS)
        value = typed.value if unit == "1" or si is None else parse_quantity(text, si[0], name)
        numbers.append(PublishedNumber(name, where, quantity, value, unit, origin, note))
    return tuple(numbers)


def published_number(name: str) -> PublishedNumber:
    """Return a published number by its name."""
    known = {number.name: number for number in published_numbers()}
    if name not in known:
        raise InputError("published number", name, "a number of Li & Ma 2019", nearest(name, known))
    return known[name]


def printed_material(name: str) -> Material:
    """Return a material as Tables 1 and 2 print it."""
    density, modulus, ratio, strength = (published_number(f"{name} {what}").value for what in _PROPERTIES)
    return Material(name, density, modulus, ratio, "metal", "li-ma-2019", "checked", "as printed", strength)


def consistency_checks() -> tuple[Consistency, ...]:
    """Return what the published numbers say of each other.

    Examples
    --------
    >>> for check in consistency_checks()[:2]:
    ...     print(check.quantity, round(check.value, 3), check.agrees)
    struck mass 0.459 None
    ratio of the peaks 5.278 False
    """
    value = {number.name: number.value for number in published_numbers()}
    force, rigid, measured = (value[name] for name in ("force simulated", "rigid peak simulated", "rigid peak"))
    width, element = value["rigid width simulated"], value["smallest element"]
    ratio, stated = value["wave peak"] / measured, value["peak ratio"]
    measured_change = half_sine_change(measured, value["rigid width"])
    turn = 2.0 * math.pi / value["speed"]
    steel, other = printed_material("65Mn"), printed_material("45 steel")
    reflected = (steel.impedance - other.impedance) / (steel.impedance + other.impedance)
    radius, length = nose()
    half = math.sqrt(4.0 * force * radius / (math.pi * contact_modulus(steel, steel) * length))
    assumed = f"a nose of {radius * 1e3:g} mm and a line of {length * 1e3:g} mm ({ELEMENTS}, none published)"
    rows = (
        (
            "What mass does the simulated force move?",
            ("force simulated", "rigid peak simulated"),
            ("struck mass", "kg", force / rigid),
            "Force over acceleration, by Newton's second law as the paper says; it states no mass.",
        ),
        (
            "How many times as large as the rigid-body peak is that of the stress wave?",
            ("wave peak", "rigid peak", "peak ratio"),
            ("ratio of the peaks", "1", ratio),
            "Both measured.",
        ),
        (
            "How far is the simulated rigid-body peak from the measured one?",
            ("rigid peak simulated", "rigid peak"),
            ("ratio of the peaks", "1", rigid / measured),
            '"Good consistency"; the widths differ by a tenth. What would be good is not said.',
        ),
        (
            "How much does the buffer take off a peak?",
            ("direct peak", "buffered peak"),
            ("ratio of the peaks", "1", value["direct peak"] / value["buffered peak"]),
            "Two sensors in one blow. In two experiments, Figures 13 and 11, the ratio is far larger.",
        ),
        (
            "By what would the first measured rigid-body pulse change the speed, as a half-sine?",
            ("rigid peak", "rigid width"),
            ("velocity change", "m/s", measured_change),
            f"The rim of a turntable of {measured_change / value['speed'] * 1e3:.0f} mm radius is as fast at "
            "730 r/min.",
        ),
        (
            "By what would the simulated rigid-body pulse change the speed, as a half-sine?",
            ("rigid peak simulated", "rigid width simulated"),
            ("velocity change", "m/s", half_sine_change(rigid, width)),
            "As a half-sine.",
        ),
        (
            "By what would the measured stress-wave pulse change the speed, as a half-sine?",
            ("wave peak", "wave width"),
            ("velocity change", "m/s", half_sine_change(value["wave peak"], value["wave width"])),
            "Several times what the blow of Figure 11 does; that peak and width belong to one half-sine is not said.",
        ),
        (
            "What impulse has the simulated contact force, as a half-sine?",
            ("force simulated", "rigid width simulated"),
            ("impulse", "N s", half_sine_change(force, width)),
            "Mass times velocity change of the simulated pulse.",
        ),
        (
            "How long does a turn take?",
            ("speed",),
            ("period of the turntable", "s", turn),
            f"How many impact components there are is not said; {STRIKERS} would strike every "
            f"{turn / STRIKERS * 1e3:.1f} ms.",
        ),
        (
            "How far apart were the seven impacts at most?",
            ("comparison count", "comparison time"),
            ("interval", "s", value["comparison time"] / (value["comparison count"] - 1.0)),
            "If the first and the last one are 150 ms apart; the speed of that test is not given.",
        ),
        (
            "How many results does the simulated pulse have?",
            ("rigid width simulated", "output interval"),
            ("results", "1", width / value["output interval"]),
            "Enough: a half-sine loses nothing at so many.",
        ),
        (
            "How stiff is an elastic contact with the simulated force and width?",
            ("force simulated", "rigid width simulated", "rigid peak simulated"),
            ("K, for a heavy striker", "N/m^(10/9)", elastic_stiffness(force, width, force / rigid)),
            "A lighter striker would need less still. (4) gives 4.7e9 for a line of 40 mm, assumed.",
        ),
        (
            "How wide is the contact that the mesh must resolve?",
            ("force simulated", "smallest element"),
            ("half width of an elastic contact", "m", half),
            f"Hertz, under the simulated force, for {assumed}: {half / element:.1f} elements of {element * 1e3:g} mm.",
        ),
        (
            "How much of a wave do the cylinders of section 4.2 reflect at the sensor?",
            ("65Mn density", "65Mn Young's modulus", "45 steel density", "45 steel Young's modulus"),
            ("F_II, equal areas", "1", reflected),
            "Next to nothing, if areas are equal, which is not said: then the echoes of (30) to (37) do not take part.",
        ),
    )
    checks = []
    for question, uses, (quantity, unit, number), note in rows:
        own = stated if "peak ratio" in uses else None  # the only one of these that the paper states
        agrees = None if own is None else abs(number / own - 1.0) < ROUNDED
        checks.append(Consistency(question, uses, quantity, unit, number, own, agrees, note))
    return tuple(checks)


def half_sine_change(peak: float, width: float) -> float:
    """Return the velocity change of a half-sine pulse, 2 A T/pi, m/s."""
    return 2.0 * peak * width / math.pi


def elastic_stiffness(force: float, duration: float, mass: float) -> float:
    """Return the stiffness with which an elastic n = 10/9 blow has this peak force and duration, N/m^(10/9).

    d = 2 F T^2/[(n + 1) m kappa^2], K = F/d^n, kappa = T v0/d.
    """
    depth = 2.0 * force * duration**2 / ((EXPONENT + 1.0) * mass * ELASTIC_DURATION**2)
    return force / depth**EXPONENT


@functools.cache
def nose() -> tuple[float, float]:
    """Return radius of the nose and length of the line of contact, m, of the case `ELEMENTS`.

    Examples
    --------
    >>> nose()
    (0.03, 0.031488)
    """
    mesh = load_case(ELEMENTS).mesh
    parts = {part.name: part for part in mesh.part} if mesh else {}
    striker, frame = parts["striker"], parts["frame"]
    if not isinstance(striker, HalfCylinder) or not isinstance(frame, FramePart):
        raise ValueError(f"{ELEMENTS} must have a half-cylinder named striker and a frame")
    return striker.radius.si, min(striker.length.si, frame.depth.si)
