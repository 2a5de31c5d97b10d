"""Every number that Li & Ma 2019 publishes, once, in SI units, and what these numbers say of each other.

Figures are not available as data: only what the text and its tables state.
"""

from __future__ import annotations

import functools
import math

from strikewave.base.constants import Material
from strikewave.base.errors import InputError, nearest
from strikewave.base.units import DIMENSIONS, convertible, parse_quantity, take_apart
from strikewave.cases.case import load_case
from strikewave.cases.tables.fem import FramePart, HalfCylinder
from strikewave.contact import contact_modulus
from strikewave.papers.li_ma_2019.types import Consistency, Origin, PublishedNumber

EXPONENT = 10.0 / 9.0
"""Exponent n of the line contact, as (2) and (3) print it."""
_ORDER = 1.0 / (EXPONENT + 1.0)
ELASTIC_DURATION = 2.0 * math.sqrt(math.pi) * math.gamma(1.0 + _ORDER) / math.gamma(0.5 + _ORDER)
"""T v0/d(max) of an elastic blow, 2 int_0^1 dx/sqrt(1 - x^(n + 1)) = 3.090488 for n = 10/9."""
ELEMENTS = "li-ma-2019-fem-rigid"
"""Case whose nose and line of contact stand for those of the impact component, which the paper does not give."""
STRIKERS = 4
"""Impact components that would fit 7 blows in 150 ms at 730 r/min: they take 123 ms; three would take 164 ms."""
ROUNDED = 0.1
"""Two numbers agree with words such as "about" where they differ by less. Chosen: a tenth, by which a number rounded to
one digit may be off."""

_WIDTH = "how its width was measured is not stated"
_TABLES = (
    ("65Mn", "Tables 1, 2", ("7820 kg/m^3", "211 GPa", "0.288", "430 MPa")),
    ("2A12", "Table 1", ("2780 kg/m^3", "72 GPa", "0.33", "345 MPa")),
    ("45 steel", "Table 2", ("7850 kg/m^3", "210 GPa", "0.31", "355 MPa")),
)
_PROPERTIES = ("density", "Young's modulus", "Poisson's ratio", "yield strength")


@functools.cache
def published_numbers() -> tuple[PublishedNumber, ...]:
    """Return all published numbers in the order of the paper.

    Examples
    --------
    >>> numbers = published_numbers()
    >>> numbers[0].quantity, numbers[0].value
    ('impacts of the comparison', 7.0)
    """
    return (*_machine(), *_theory(), *_rigid(), *_wave(), *_materials())


def published_number(name: str) -> PublishedNumber:
    """Return a published number by its name.

    Examples
    --------
    >>> published_number("force simulated").value
    19685.34
    """
    known = {number.name: number for number in published_numbers()}
    if name not in known:
        raise InputError("published number", name, "a number of Li & Ma 2019", nearest(name, known))
    return known[name]


def _number(name: str, where: str, quantity: str, text: str, origin: Origin, note: str = "") -> PublishedNumber:
    """Turn "4151.25 g" into a number; one without a unit is a count or a ratio."""
    typed = take_apart(text)
    assert typed is not None
    unit = typed.unit or "1"
    si = convertible(unit, DIMENSIONS)
    value = typed.value if unit == "1" or si is None else parse_quantity(text, si[0], name)
    return PublishedNumber(name, where, quantity, value, unit, origin, note)


def _machine() -> tuple[PublishedNumber, ...]:
    five = "Figure 5"
    return (
        _number("comparison count", five, "impacts of the comparison", "7", "measured"),
        _number(
            "comparison time", five, "time that they take", "150 ms", "measured", "speed of the turntable not given"
        ),
        _number("direct peak", five, "first pulse, sensor mounted directly", "9707.12 g", "measured"),
        _number("buffered peak", five, "first pulse, sensor buffered and isolated", "6353.22 g", "measured", '"about"'),
    )


def _theory() -> tuple[PublishedNumber, ...]:
    equal = "stress is even in the specimen from so many transits on"
    return (
        _number("exponent", "(2), (3)", "force index of the line contact, 10/9", repr(10.0 / 9.0), "given"),
        _number("palmgren factor", "(2)", "factor of the indentation", "3.81", "given", "after A. Palmgren"),
        _number("integral", "(15)", "integral of the loss", "0.3", "given"),
        _number("least transits", "section 3.2", f"{equal}, least", "3", "given", "after G. Ravichandran"),
        _number("most transits", "section 3.2", f"{equal}, most", "5", "given", "after G. Ravichandran"),
    )


def _rigid() -> tuple[PublishedNumber, ...]:
    nine, ten, eleven = "Figure 9", "Figure 10", "Figure 11"
    return (
        _number("speed", "section 4.1", "speed of the turntable", "730 rpm", "given", "in both experiments"),
        _number("count", nine, "impacts", "11", "measured"),
        _number("typical peak", nine, "peak, usually", "4000 g", "measured", '"about"'),
        _number("typical width", nine, "pulse width, usually", "200 us", "measured", '"about"'),
        _number("smallest element", ten, "smallest size of the mesh", "0.5 mm", "given"),
        _number("gravity", ten, "gravity", "9.8 m/s^2", "given", "along the blow"),
        _number("simulated time", ten, "time that is simulated", "1 ms", "given"),
        _number("output interval", ten, "interval of the results", "1 us", "given"),
        _number("rigid peak", eleven, "first rigid-body pulse", "4151.25 g", "measured"),
        _number("rigid width", eleven, "its width", "200 us", "measured", _WIDTH),
        _number(
            "rigid peak simulated",
            eleven,
            "first rigid-body pulse",
            "4374.52 g",
            "simulated",
            "contact force over mass",
        ),
        _number("force simulated", eleven, "largest contact force", "19685.34 N", "simulated"),
        _number("rigid width simulated", eleven, "its width", "220 us", "simulated", _WIDTH),
    )


def _wave() -> tuple[PublishedNumber, ...]:
    thirteen = "Figure 13"
    return (
        _number("wave peak", thirteen, "first pulse of the sensor between cylinders", "21909.89 g", "measured"),
        _number("wave width", thirteen, "its width", "252 us", "measured", _WIDTH),
        _number("peak ratio", thirteen, "its peak over that of Figure 11", "4", "given", '"about"'),
        _number("wave peak simulated", "Figure 15", "first pulse, mean of the specimen", "22841.7 g", "simulated"),
    )


def _materials() -> tuple[PublishedNumber, ...]:
    return tuple(
        _number(f"{material} {what}", where, f"{material}: {what}", text, "given")
        for material, where, texts in _TABLES
        for what, text in zip(_PROPERTIES, texts, strict=True)
    )


def printed_material(name: str) -> Material:
    """Return a material as Tables 1 and 2 print it.

    Examples
    --------
    >>> round(printed_material("65Mn").bar_speed, 2)
    5194.43
    """
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
    return (*_peaks(), *_pulses(), *_times(), *_model())


def _value(name: str) -> float:
    return published_number(name).value


def half_sine_change(peak: float, width: float) -> float:
    """Return what a half-sine pulse changes a speed by, 2 A T/pi, m/s.

    Examples
    --------
    >>> round(half_sine_change(4151.25 * 9.80665, 200e-6), 2)
    5.18
    """
    return 2.0 * peak * width / math.pi


def elastic_stiffness(force: float, duration: float, mass: float) -> float:
    """Return the stiffness with which an elastic n = 10/9 blow has this peak force and duration, N/m^(10/9).

    d = 2 F T^2/[(n + 1) m kappa^2], K = F/d^n, kappa = T v0/d.

    Examples
    --------
    >>> round(elastic_stiffness(19685.34, 220e-6, 0.459) / 1e8, 2)
    2.46
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


def _agree(value: float, stated: float) -> bool:
    return abs(value / stated - 1.0) < ROUNDED


def _peaks() -> tuple[Consistency, ...]:
    force, rigid, measured = (_value(name) for name in ("force simulated", "rigid peak simulated", "rigid peak"))
    ratio, stated = _value("wave peak") / measured, _value("peak ratio")
    return (
        Consistency(
            "What mass does the simulated force move?",
            ("force simulated", "rigid peak simulated"),
            "struck mass",
            "kg",
            force / rigid,
            None,
            None,
            "Force over acceleration, by Newton's second law as the paper says; it states no mass.",
        ),
        Consistency(
            "How many times as large as the rigid-body peak is that of the stress wave?",
            ("wave peak", "rigid peak", "peak ratio"),
            "ratio of the peaks",
            "1",
            ratio,
            stated,
            _agree(ratio, stated),
            "Both measured.",
        ),
        Consistency(
            "How far is the simulated rigid-body peak from the measured one?",
            ("rigid peak simulated", "rigid peak"),
            "ratio of the peaks",
            "1",
            rigid / measured,
            None,
            None,
            '"Good consistency"; the widths differ by a tenth. What would be good is not said.',
        ),
        Consistency(
            "How much does the buffer take off a peak?",
            ("direct peak", "buffered peak"),
            "ratio of the peaks",
            "1",
            _value("direct peak") / _value("buffered peak"),
            None,
            None,
            "Two sensors in one blow. In two experiments, Figures 13 and 11, the ratio is far larger.",
        ),
    )


def _pulses() -> tuple[Consistency, ...]:
    rim = half_sine_change(_value("rigid peak"), _value("rigid width")) / _value("speed")
    pairs = (
        (
            "first measured rigid-body pulse",
            "rigid peak",
            "rigid width",
            f"The rim of a turntable of {rim * 1e3:.0f} mm radius is as fast at 730 r/min.",
        ),
        ("simulated rigid-body pulse", "rigid peak simulated", "rigid width simulated", "As a half-sine."),
        (
            "measured stress-wave pulse",
            "wave peak",
            "wave width",
            "Several times what the blow of Figure 11 does; that peak and width belong to one half-sine is not said.",
        ),
    )
    speeds = tuple(
        Consistency(
            f"By what would the {what} change the speed, as a half-sine?",
            (peak, width),
            "velocity change",
            "m/s",
            half_sine_change(_value(peak), _value(width)),
            None,
            None,
            note,
        )
        for what, peak, width, note in pairs
    )
    force, width = _value("force simulated"), _value("rigid width simulated")
    impulse = Consistency(
        "What impulse has the simulated contact force, as a half-sine?",
        ("force simulated", "rigid width simulated"),
        "impulse",
        "N s",
        half_sine_change(force, width),
        None,
        None,
        "Mass times velocity change of the simulated pulse.",
    )
    return (*speeds, impulse)


def _times() -> tuple[Consistency, ...]:
    turn = 2.0 * math.pi / _value("speed")
    each = turn / STRIKERS * 1e3
    interval = _value("comparison time") / (_value("comparison count") - 1.0)
    return (
        Consistency(
            "How long does a turn take?",
            ("speed",),
            "period of the turntable",
            "s",
            turn,
            None,
            None,
            f"How many impact components there are is not said; {STRIKERS} would strike every {each:.1f} ms.",
        ),
        Consistency(
            "How far apart were the seven impacts at most?",
            ("comparison count", "comparison time"),
            "interval",
            "s",
            interval,
            None,
            None,
            "If the first and the last one are 150 ms apart; the speed of that test is not given.",
        ),
        Consistency(
            "How many results does the simulated pulse have?",
            ("rigid width simulated", "output interval"),
            "results",
            "1",
            _value("rigid width simulated") / _value("output interval"),
            None,
            None,
            "Enough: a half-sine loses nothing at so many.",
        ),
    )


def _model() -> tuple[Consistency, ...]:
    steel = printed_material("65Mn")
    force, width = _value("force simulated"), _value("rigid width simulated")
    stiffness = elastic_stiffness(force, width, force / _value("rigid peak simulated"))
    modulus = contact_modulus(steel, steel)
    radius, length = nose()
    half = math.sqrt(4.0 * force * radius / (math.pi * modulus * length))
    first, other = steel.impedance, printed_material("45 steel").impedance
    element = _value("smallest element")
    assumed = f"a nose of {radius * 1e3:g} mm and a line of {length * 1e3:g} mm ({ELEMENTS}, none published)"
    return (
        Consistency(
            "How stiff is an elastic contact with the simulated force and width?",
            ("force simulated", "rigid width simulated", "rigid peak simulated"),
            "K, for a heavy striker",
            "N/m^(10/9)",
            stiffness,
            None,
            None,
            "A lighter striker would need less still. (4) gives 4.7e9 for a line of 40 mm, assumed.",
        ),
        Consistency(
            "How wide is the contact that the mesh must resolve?",
            ("force simulated", "smallest element"),
            "half width of an elastic contact",
            "m",
            half,
            None,
            None,
            f"Hertz, under the simulated force, for {assumed}: {half / element:.1f} elements of {element * 1e3:g} mm.",
        ),
        Consistency(
            "How much of a wave do the cylinders of section 4.2 reflect at the sensor?",
            ("65Mn density", "65Mn Young's modulus", "45 steel density", "45 steel Young's modulus"),
            "F_II, equal areas",
            "1",
            (first - other) / (first + other),
            None,
            None,
            "Next to nothing, if areas are equal, which is not said: then the echoes of (30) to (37) do not take part.",
        ),
    )
