"""The options of ``strikewave impact`` and ``identify``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

import typer

from strikewave.base.errors import InputError
from strikewave.base.quantities import AUTO
from strikewave.base.units import DIMENSIONS, parse_typed
from strikewave.reporting.options import Typed, bare_number, parsed, quantity

MOST_BLOWS = 1000  # on one spot: a table of more is not read
MOST_STIFFNESS = 1e300  # N/m^n, whose unit depends on n: products of it still are numbers


def radius(name: str, help: str) -> Any:
    """Return an option that takes a radius: negative is a hole, inf a plane."""
    return parsed(name, read=second_radius, help=help, metavar="LENGTH")


def second_radius(text: str, field: str = "--radius2") -> float:
    """Return a radius that may be negative, a hole, or inf, a plane.

    Examples
    --------
    >>> second_radius("-11 mm"), second_radius("inf")
    (-0.011, inf)
    """
    value = parse_typed(text, "m", field)
    if value == 0.0 or value != value or value == -math.inf:
        raise InputError(field, text, "a length, inf for a plane, or negative for a hole")
    return value


def contact_pressure(text: str, field: str = "--yield-pressure") -> float | str:
    """Return the largest pressure of a contact, Pa, or the word for that of the softer body.

    Examples
    --------
    >>> contact_pressure("1.2 GPa"), contact_pressure("auto")
    (1200000000.0, 'auto')
    """
    if text.strip() == AUTO:
        return AUTO
    value = parse_typed(text, "Pa", field)
    if not 0.0 < value < math.inf:
        raise InputError(field, text, f"{DIMENSIONS['Pa'][0]} above zero, or {AUTO}")
    return value


def _pressure_words(pressure: float | str | None) -> str | None:
    return pressure if pressure is None or isinstance(pressure, str) else f"{pressure:g} Pa"


@dataclass(frozen=True)
class BodyOptions:
    """The two bodies and their approach."""

    panel: ClassVar[str] = "Bodies"

    m1: Annotated[
        float, quantity("--m1", si="kg", infinite=True, help="Mass of the striker, such as 0.2 (kg), or inf.")
    ]
    m2: Annotated[
        float, quantity("--m2", si="kg", infinite=True, help='Mass of the object, such as "459 gram", or inf.')
    ]
    speed: Annotated[float, quantity("--speed", si="m/s", help="Approach speed, such as 20 (m/s).")]


@dataclass(frozen=True)
class LossOptions:
    """The losses: a damping law or a damper."""

    panel: ClassVar[str] = "Losses"

    restitution: Annotated[
        float | None,
        bare_number(
            "-e",
            "--restitution",
            above=1e-6,
            high=1.0,
            help="Coefficient of restitution asked for, above 0 to 1; 1 by default.",
        ),
    ] = None
    damping: Annotated[
        str | None,
        typer.Option(
            "--damping",
            metavar="NAME",
            help="Damping law; exact by default; `strikewave laws` lists them.",
            show_default=False,
        ),
    ] = None
    damper: Annotated[
        str | None,
        typer.Option(
            "--damper",
            metavar="NAME",
            help="Damper instead of a damping law, such as tsuji-cut-off; none by default.",
            show_default=False,
        ),
    ] = None
    time: Annotated[
        float | None, quantity("--time", si="s", help='Time A of the damper kuwabara-kono, such as "1 us".')
    ] = None


@dataclass(frozen=True)
class StiffnessOptions:
    """The stiffness: K and n, or a law with its sizes and materials."""

    panel: ClassVar[str] = "Stiffness"

    stiffness: Annotated[
        float | None, bare_number("--stiffness", high=1e30, help="Stiffness K in N/m^n; or give --law.")
    ] = None
    exponent: Annotated[
        float | None,
        bare_number("-n", "--exponent", low=0.1, high=10.0, help="Exponent n that belongs to --stiffness."),
    ] = None
    law: Annotated[
        str | None,
        typer.Option(
            "--law",
            metavar="NAME",
            help="Stiffness law instead of --stiffness, such as palmgren or hertz.",
            show_default=False,
        ),
    ] = None
    length: Annotated[
        float | None, quantity("--length", si="m", help='Length of the contact line of a law, such as "40 mm".')
    ] = None
    radius1: Annotated[float | None, quantity("--radius1", si="m", help='Radius of the striker, such as "10 mm".')] = (
        None
    )
    radius2: Annotated[
        float, radius("--radius2", help="Radius of the object: inf, a plane, by default; negative is a hole.")
    ] = math.inf
    datum_depth: Annotated[
        float | None, quantity("--datum-depth", si="m", help="Depth of a plane body, for the law johnson.")
    ] = None
    material1: Annotated[str, typer.Option("--material1", metavar="MATERIAL", help="Material of the striker.")] = "65Mn"
    material2: Annotated[str, typer.Option("--material2", metavar="MATERIAL", help="Material of the object.")] = "65Mn"


@dataclass(frozen=True)
class YieldOptions:
    """Yielding: a pressure, or a load and a shape."""

    panel: ClassVar[str] = "Yielding"

    yield_pressure: Annotated[
        Any,
        parsed(
            "--yield-pressure",
            read=contact_pressure,
            help='Largest pressure of the contact, such as "1.2 GPa", or auto, of the softer body; elastic by default.',
            metavar="PRESSURE|auto",
        ),
    ] = None
    yield_load: Annotated[
        float | None,
        quantity("--yield-load", si="N", help='Load at which the contact yields, such as "6.5 kN", with --shape.'),
    ] = None
    shape: Annotated[
        Literal["line", "point"] | None,
        typer.Option("--shape", help="Shape of a contact that yields; that of the law by default.", show_default=False),
    ] = None

    @property
    def typed(self) -> list[tuple[str, str]]:
        """The options that were given, with what was."""
        given = {
            "--yield-pressure": _pressure_words(self.yield_pressure),
            "--yield-load": None if self.yield_load is None else f"{self.yield_load:g} N",
            "--shape": self.shape,
        }
        return [(name, text) for name, text in given.items() if text is not None]


@dataclass(frozen=True)
class MassOptions:
    """Options for the masses."""

    mass: Annotated[
        Typed | None, quantity("--mass", si="kg", help='Reduced mass, such as "0.14 kg"; estimated by default.')
    ] = None
    m1: Annotated[
        Typed | None, quantity("--m1", si="kg", infinite=True, help="Mass of the striker, such as 0.2 (kg), or inf.")
    ] = None
    m2: Annotated[
        Typed | None,
        quantity(
            "--m2",
            si="kg",
            infinite=True,
            help='Mass of the struck body, such as "459 gram"; needed for an acceleration.',
        ),
    ] = None
