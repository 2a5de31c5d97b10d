"""The options of ``strikewave impact``, and the impact that they ask for."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from strikewave.base.errors import InputError
    from strikewave.base.materials import Material
    from strikewave.contact import AnyContact, Damper, Geometry, LogarithmicStiffness, PressureCap, Stiffness
    from strikewave.contact.registry import DamperLaw, DampingLaw

    AnyStiffness = Stiffness | LogarithmicStiffness

MOST_BLOWS = 1000


def _option(name: str, words: str) -> Any:
    return typer.Option(name, help=words, show_default=False)


M1 = Annotated[str, _option("--m1", "Mass of the striker, such as 0.2 (kg) or inf.")]
M2 = Annotated[str, _option("--m2", "Mass of the object, such as '459 gram' or inf.")]
Speed = Annotated[str, _option("--speed", "Approach speed, such as 20 (m/s).")]
Restitution = Annotated[
    str | None, typer.Option("-e", "--restitution", help="Restitution asked for, above 0 to 1 [1].", show_default=False)
]
Damping = Annotated[str | None, _option("--damping", "Damping law [exact]; `strikewave laws` lists them.")]
DamperName = Annotated[str | None, _option("--damper", "Damper instead of a damping law, such as tsuji-cut-off.")]
DamperTime = Annotated[str | None, _option("--time", "Time A of the damper kuwabara-kono, such as '1 us'.")]
K = Annotated[str | None, _option("--stiffness", "K in N/m^n.")]
Exponent = Annotated[str | None, _option("--exponent", "n.")]
LawName = Annotated[str | None, _option("--law", "Stiffness law instead, such as palmgren or hertz.")]
Length = Annotated[str | None, _option("--length", "Length of the contact line.")]
Radius1 = Annotated[str | None, _option("--radius1", "Radius of the striker.")]
Radius2 = Annotated[str, typer.Option("--radius2", help="Radius of the object: inf is a plane, negative a hole.")]
DatumDepth = Annotated[str | None, _option("--datum-depth", "Depth of a plane body (johnson).")]
Material1 = Annotated[str, typer.Option("--material1", help="Material of the striker.")]
Material2 = Annotated[str, typer.Option("--material2", help="Material of the object.")]
YieldPressure = Annotated[
    str | None, _option("--yield-pressure", "Largest pressure that the contact bears, such as '1.2 GPa'.")
]
YieldLoad = Annotated[str | None, _option("--yield-load", "Load at which the contact yields instead, with --shape.")]
Shape = Annotated[str | None, _option("--shape", "Shape of a contact that yields: line or point.")]
Repeat = Annotated[str, typer.Option("--repeat", help=f"Blows at the same speed on the same spot, to {MOST_BLOWS}.")]


@dataclass(frozen=True)
class StiffnessOptions:
    """What was typed of the stiffness: K and n, or a law with its sizes and materials."""

    stiffness: str | None
    exponent: str | None
    law: str | None
    length: str | None
    radius1: str | None
    radius2: str
    datum_depth: str | None
    materials: tuple[str, str]


@dataclass(frozen=True)
class LossOptions:
    """What was typed of the losses: a damping law or a damper."""

    restitution: str | None
    damping: str | None
    damper: str | None
    time: str | None


@dataclass(frozen=True)
class YieldOptions:
    """What was typed of yielding: a pressure, or a load and a shape."""

    pressure: str | None
    load: str | None
    shape: str | None

    @property
    def typed(self) -> list[tuple[str, str]]:
        """The options that were given."""
        given = (("--yield-pressure", self.pressure), ("--yield-load", self.load), ("--shape", self.shape))
        return [(name, text) for name, text in given if text is not None]


@dataclass(frozen=True)
class Base:
    """The stiffness of a contact, and the sizes and bodies it came from; without a law there are none."""

    stiffness: AnyStiffness
    sizes: Geometry
    needs: tuple[str, ...] = ()
    bodies: tuple[Material, Material] | None = None

    @property
    def shape(self) -> str | None:
        """Shape of the contact, as its law needs a length or a radius alone."""
        return "line" if "length" in self.needs else "point" if "radius1" in self.needs else None


@dataclass(frozen=True)
class Loss:
    """What takes energy: a damping law with its factor, or a damper."""

    law: DampingLaw | DamperLaw
    asked: float | None
    factor: float = 0.0
    damper: Damper | None = None


@dataclass(frozen=True)
class Setup:
    """An impact asked for, in SI."""

    masses: tuple[float, float]
    speed: float
    base: Base
    loss: Loss
    cap: PressureCap | None
    repeat: int
    contact: AnyContact = field(init=False)

    def __post_init__(self) -> None:
        """Make the force law."""
        stiffness, damper = self.base.stiffness, self.loss.damper
        words: dict[str, Any] = {"damper": damper} if damper else {"cap": self.cap}
        object.__setattr__(self, "contact", stiffness.contact(self.loss.factor, **words))


def read_bodies(m1: str, m2: str, speed: str) -> tuple[tuple[float, float], float]:
    """Return the masses and the approach speed.

    Raises
    ------
    InputError
        If one is not positive, or both masses are infinite.
    """
    from strikewave.base.errors import InputError

    masses = quantity(m1, "kg", "--m1", infinite=True), quantity(m2, "kg", "--m2", infinite=True)
    if all(math.isinf(mass) for mass in masses):
        raise InputError("--m2", m2, "at most one infinite mass")
    return masses, quantity(speed, "m/s", "--speed")


def read_base(typed: StiffnessOptions) -> Base:
    """Return the stiffness that was typed, or that a law gives.

    Raises
    ------
    InputError
        If there is none or two, the law is not known, or a size is missing or out of range.
    """
    from strikewave.base.errors import MISSING, InputError
    from strikewave.base.materials import material
    from strikewave.contact import Geometry, Stiffness, stiffness_law

    if (typed.stiffness is None) == (typed.law is None):
        allowed = "either --stiffness with --exponent, or --law"
        raise InputError("--stiffness", typed.stiffness or MISSING, allowed, "give exactly one of them")
    if typed.law is None:
        if typed.exponent is None:
            hint = "a line contact has 1.1111, a sphere 1.5"
            raise InputError("--exponent", MISSING, "the exponent n that belongs to --stiffness", hint)
        beside = {"--length": typed.length, "--radius1": typed.radius1, "--datum-depth": typed.datum_depth}
        for option, text in beside.items():
            if text is not None:
                raise InputError(option, text, "only with --law: --stiffness says it all", "remove it")
        k = plain(str(typed.stiffness), "--stiffness", 0.0, 1e30)
        return Base(Stiffness(k, plain(typed.exponent, "--exponent", 0.1, 10.0, "from")), Geometry())
    if typed.exponent is not None:
        raise InputError("--exponent", typed.exponent, "--exponent beside --stiffness", "a law brings its own")
    needs = stiffness_law(typed.law, "--law").needs
    one, other = (material(name, f"--material{i}") for i, name in enumerate(typed.materials, start=1))
    sizes = _sizes(typed)
    return Base(_by_law(typed.law, needs, sizes, (one, other)), sizes, needs, (one, other))


def _sizes(typed: StiffnessOptions) -> Geometry:
    from strikewave.contact import Geometry

    def size(text: str | None, name: str) -> float | None:
        return None if text is None else quantity(text, "m", name)

    radius1, depth = size(typed.radius1, "--radius1"), size(typed.datum_depth, "--datum-depth")
    return Geometry(radius1, second_radius(typed.radius2), size(typed.length, "--length"), depth)


def _by_law(law: str, needs: tuple[str, ...], sizes: Geometry, bodies: tuple[Material, Material]) -> AnyStiffness:
    """Return the stiffness by a law; errors name the options."""
    from strikewave.base.errors import MISSING, InputError
    from strikewave.contact import stiffness_of

    for need in ("length", "radius1"):
        if need in needs and getattr(sizes, need) is None:
            raise _missing(need, f"of the law {law}")
    for size in ("length", "datum_depth"):
        if size not in needs and getattr(sizes, size) is not None:
            option = "--" + size.replace("_", "-")
            raise InputError(option, f"{getattr(sizes, size):g} m", f"none for the law {law}", "remove it")
    radius, hole = sizes.radius1, -sizes.radius2
    if radius is not None and 0.0 < hole <= radius:
        raise InputError("--radius2", f"{-hole:g} m", f"a hole larger than --radius1, {radius:g} m")
    try:
        return stiffness_of(law, *bodies, sizes, "--law")
    except ArithmeticError:
        raise InputError("--law", law, "sizes whose stiffness is finite") from None
    except InputError as error:
        if error.field != "--law":
            raise InputError("--" + error.field.replace("_", "-"), MISSING, error.allowed) from None
        hint = "--datum-depth says it" if "datum_depth" in needs and sizes.datum_depth is None else ""
        raise InputError("--law", law, f"sizes that it holds for: {error.allowed}", hint) from None


def _missing(need: str, whose: str) -> InputError:
    from strikewave.base.errors import MISSING, InputError

    words, example = {"length": ("contact length", "40 mm"), "radius1": ("radius", "10 mm")}[need]
    return InputError(f"--{need}", MISSING, f"the {words} {whose}", f'such as --{need} "{example}"')


def read_loss(typed: LossOptions, stiffness: AnyStiffness, masses: tuple[float, float]) -> Loss:
    """Return the damping law or the damper asked for.

    Raises
    ------
    InputError
        If both are, the name is not known, or its number is missing, out of range or of another law.
    """
    from strikewave.base.errors import InputError
    from strikewave.contact import damping_law

    if typed.damper is not None:
        return _damper(typed, stiffness, masses)
    if typed.time is not None:
        raise InputError("--time", typed.time, "a time beside --damper kuwabara-kono")
    law = damping_law(typed.damping or "exact", "--damping")
    asked = _asked(typed.restitution)
    return Loss(law, asked, float(law.function(asked)))


def _asked(text: str | None) -> float:
    return plain("1" if text is None else text, "--restitution", 1e-6, 1.0)


def _damper(typed: LossOptions, stiffness: AnyStiffness, masses: tuple[float, float]) -> Loss:
    from strikewave.base.errors import InputError
    from strikewave.contact import LogarithmicStiffness, damper_law, reduced_mass

    name = str(typed.damper)
    law = damper_law(name, "--damper")
    if typed.damping is not None:
        raise InputError("--damper", name, "no --damping beside it", "a damper replaces the damping law: give one")
    if isinstance(stiffness, LogarithmicStiffness):
        hint = f"{stiffness.law} is logarithmic: take --damping, or palmgren or pereira"
        raise InputError("--damper", name, "a stiffness F = K d^n", hint)
    asked, time = _number(typed, law)
    try:
        damper = law.function(stiffness, float(reduced_mass(*masses)), time if asked is None else asked)
    except ValueError as error:
        raise InputError("--damper", name, "a damper that fits the contact", str(error)) from None
    return Loss(law, asked, damper=damper)


def _number(typed: LossOptions, law: DamperLaw) -> tuple[float | None, float]:
    """Return the restitution asked of a damper, or None and its time where none can be prescribed."""
    from strikewave.base.errors import MISSING, InputError

    if law.given is not None:
        if typed.time is not None:
            raise InputError("--time", typed.time, f"no time: the damper {law.name} takes --restitution")
        return _asked(typed.restitution), 0.0
    if typed.restitution is not None:
        hint = "give --time instead"
        raise InputError("--restitution", typed.restitution, f"none: {law.name} cannot be asked for one", hint)
    if typed.time is None:
        raise InputError("--time", MISSING, f"the time of the damper {law.name}", 'such as --time "1 us"')
    return None, quantity(typed.time, "s", "--time")


def read_cap(typed: YieldOptions, base: Base, damper: str | None) -> PressureCap | None:
    """Return the cap on the pressure, None where nothing yields.

    Raises
    ------
    InputError
        If a part of it is missing, given twice, or a damper stands beside it.
    """
    from strikewave.base.errors import MISSING, InputError, nearest
    from strikewave.contact import PressureCap
    from strikewave.contact.law import SHAPES

    if not typed.typed:
        return None
    if damper is not None:
        raise InputError(*typed.typed[0], "no --damper beside it", "a contact that yields takes --damping")
    if typed.shape is not None and typed.shape not in SHAPES:
        raise InputError("--shape", typed.shape, "line or point", nearest(typed.shape, SHAPES))
    if typed.pressure is not None:
        if len(typed.typed) > 1:
            raise InputError(*typed.typed[1], "no --yield-pressure beside it", "give one of them")
        return _cap_of_pressure(typed.pressure, base)
    if typed.load is None:
        raise InputError("--yield-load", MISSING, "the load that belongs to --shape", 'such as "6.5 kN"')
    shape = typed.shape or base.shape
    if shape is None:
        raise InputError("--shape", MISSING, "the shape of the contact that yields", "line or point")
    return PressureCap(quantity(typed.load, "N", "--yield-load"), shape)


def _cap_of_pressure(text: str, base: Base) -> PressureCap:
    from strikewave.base.errors import InputError
    from strikewave.contact import cap_of

    pressure, sizes = quantity(text, "Pa", "--yield-pressure"), base.sizes
    if base.shape is None or base.bodies is None:
        hint = "give --yield-load and --shape line|point"
        raise InputError("--yield-pressure", text, "a --law with a length or a radius", hint)
    if sizes.radius1 is None:
        raise _missing("radius1", "on which the yield pressure acts")
    one, other = base.bodies
    try:
        return cap_of(one, other, sizes, pressure)
    except ValueError as error:
        raise InputError("--yield-pressure", text, "a pressure that a body bears", str(error)) from None


def read_repeat(text: str) -> int:
    """Return the number of blows.

    Raises
    ------
    InputError
        If it is no whole number from 1 to `MOST_BLOWS`.
    """
    from strikewave.base.errors import InputError

    if not (text.isascii() and text.isdigit() and len(text) <= 4 and 1 <= int(text) <= MOST_BLOWS):
        raise InputError("--repeat", text, f"a whole number from 1 to {MOST_BLOWS}")
    return int(text)


def quantity(text: str, si: str, name: str, infinite: bool = False) -> float:
    """Return a typed quantity above zero.

    Raises
    ------
    InputError
        If it is not.
    """
    from strikewave.base.errors import InputError
    from strikewave.base.units import DIMENSIONS, parse_typed

    value = parse_typed(text, si, name)
    if not value > 0.0 or (math.isinf(value) and not infinite):
        raise InputError(name, text, f"{DIMENSIONS[si][0]} above zero" + (", or inf" if infinite else ""))
    return value


def second_radius(text: str) -> float:
    """Return a radius that may be negative, a hole, or inf, a plane.

    Raises
    ------
    InputError
        If it is zero, or no length.

    Examples
    --------
    >>> second_radius("-11 mm"), second_radius("inf")
    (-0.011, inf)
    """
    from strikewave.base.errors import InputError
    from strikewave.base.units import parse_typed

    value = parse_typed(text, "m", "--radius2")
    if value == 0.0 or value != value or value == -math.inf:
        raise InputError("--radius2", text, "a length, inf for a plane, or negative for a hole")
    return value


def plain(text: str, name: str, low: float, high: float, lower: str = "above") -> float:
    """Return a typed number above ``low``, or from it, to ``high``.

    Raises
    ------
    InputError
        If it is not.
    """
    from strikewave.base.errors import InputError

    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low <= value <= high or (lower == "above" and value == low):
        raise InputError(name, text, f"a number {lower} {low:g} and at most {high:g}")
    return value
