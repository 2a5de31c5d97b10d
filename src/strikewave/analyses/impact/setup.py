"""The impact by the options of ``strikewave impact``."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from strikewave.base.constants import Material, material
from strikewave.base.errors import MISSING, InputError
from strikewave.cases.contact_parts import pressure_of_materials, refuse_beyond_law
from strikewave.contact import (
    AnyContact,
    Damper,
    Geometry,
    LogarithmicStiffness,
    PressureCap,
    Stiffness,
    cap_of,
    damper_law,
    damping_law,
    reduced_mass,
    stiffness_law,
    stiffness_of,
)
from strikewave.contact.registry import DamperLaw, DampingLaw

if TYPE_CHECKING:
    from strikewave.analyses.impact.options import BodyOptions, LossOptions, StiffnessOptions, YieldOptions

AnyStiffness = Stiffness | LogarithmicStiffness


@dataclass(frozen=True)
class Base:
    """The stiffness of a contact, and the sizes and bodies it came from; without a law there are none."""

    stiffness: AnyStiffness
    sizes: Geometry
    needs: tuple[str, ...] = ()
    bodies: tuple[Material, Material] | None = None

    @property
    def cap_sizes(self) -> Geometry:
        """Sizes on which a pressure acts: those of a line only where the law needs a length."""
        return self.sizes if self.shape == "line" else replace(self.sizes, length=None)

    @property
    def shape(self) -> str | None:
        """Shape of the contact, as its law needs a length or a radius alone."""
        return "line" if "length" in self.needs else "point" if "radius1" in self.needs else None


@dataclass(frozen=True)
class ContactLoss:
    """The loss of energy: a damping law with its factor, or a damper."""

    law: DampingLaw | DamperLaw
    asked: float | None
    factor: float = 0.0
    damper: Damper | None = None


@dataclass(frozen=True)
class Setup:
    """The set-up of an impact, SI; ``automatic`` is True if the materials gave the cap."""

    masses: tuple[float, float]
    speed: float
    base: Base
    loss: ContactLoss
    cap: PressureCap | None
    repeat: int
    automatic: bool = False
    contact: AnyContact = field(init=False)

    def __post_init__(self) -> None:
        """Make the force law."""
        stiffness, damper = self.base.stiffness, self.loss.damper
        words: dict[str, Any] = {"damper": damper} if damper else {"cap": self.cap}
        object.__setattr__(self, "contact", stiffness.contact(self.loss.factor, **words))


def read_masses(typed: BodyOptions) -> tuple[float, float]:
    """Return the masses."""
    if math.isinf(typed.m1) and math.isinf(typed.m2):
        raise InputError("--m2", "inf", "at most one infinite mass")
    return typed.m1, typed.m2


def read_base(typed: StiffnessOptions) -> Base:
    """Return the stiffness that was typed, or that a law gives."""
    if (typed.stiffness is None) == (typed.law is None):
        allowed = "either --stiffness with --exponent, or --law"
        raise InputError(
            "--stiffness", MISSING if typed.stiffness is None else typed.stiffness, allowed, "give exactly one of them"
        )
    if typed.stiffness is not None:
        if typed.exponent is None:
            hint = "a line contact has 1.1111, a sphere 1.5"
            raise InputError("--exponent", MISSING, "the exponent n that belongs to --stiffness", hint)
        beside = {"--length": typed.length, "--radius1": typed.radius1, "--datum-depth": typed.datum_depth}
        for option, size in beside.items():
            if size is not None:
                raise InputError(option, f"{size:g} m", "only with --law: --stiffness says it all", "remove it")
        return Base(Stiffness(typed.stiffness, typed.exponent), Geometry())
    if typed.exponent is not None:
        raise InputError("--exponent", typed.exponent, "--exponent beside --stiffness", "a law brings its own")
    law = str(typed.law)
    needs = stiffness_law(law, "--law").needs
    bodies = material(typed.material1, "--material1"), material(typed.material2, "--material2")
    sizes = Geometry(typed.radius1, typed.radius2, typed.length, typed.datum_depth)
    return Base(_by_law(law, needs, sizes, bodies), sizes, needs, bodies)


def _by_law(law: str, needs: tuple[str, ...], sizes: Geometry, bodies: tuple[Material, Material]) -> AnyStiffness:
    """Return the stiffness by a law; errors name the options."""
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
    words, example = {"length": ("contact length", "40 mm"), "radius1": ("radius", "10 mm")}[need]
    return InputError(f"--{need}", MISSING, f"the {words} {whose}", f'such as --{need} "{example}"')


def read_loss(typed: LossOptions, stiffness: AnyStiffness, masses: tuple[float, float]) -> ContactLoss:
    """Return the damping law or the damper asked for."""
    if typed.damper is not None:
        return _damper(typed, stiffness, masses)
    if typed.time is not None:
        raise InputError("--time", f"{typed.time:g} s", "a time beside --damper kuwabara-kono")
    law = damping_law(typed.damping or "exact", "--damping")
    asked = _asked(typed)
    return ContactLoss(law, asked, float(law.function(asked)))


def _asked(typed: LossOptions) -> float:
    return 1.0 if typed.restitution is None else typed.restitution


def _damper(typed: LossOptions, stiffness: AnyStiffness, masses: tuple[float, float]) -> ContactLoss:
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
    return ContactLoss(law, asked, damper=damper)


def _number(typed: LossOptions, law: DamperLaw) -> tuple[float | None, float]:
    """Return the restitution asked of a damper, or None and its time where none can be prescribed."""
    if law.given is not None:
        if typed.time is not None:
            raise InputError("--time", f"{typed.time:g} s", f"no time: the damper {law.name} takes --restitution")
        return _asked(typed), 0.0
    if typed.restitution is not None:
        hint = "give --time instead"
        raise InputError("--restitution", typed.restitution, f"none: {law.name} cannot be asked for one", hint)
    if typed.time is None:
        raise InputError("--time", MISSING, f"the time of the damper {law.name}", 'such as --time "1 us"')
    return None, typed.time


def read_cap(typed: YieldOptions, base: Base, damper: str | None) -> PressureCap | None:
    """Return the cap on the pressure, None where nothing yields."""
    if not typed.typed:
        return None
    if damper is not None:
        raise InputError(*typed.typed[0], "no --damper beside it", "a contact that yields takes --damping")
    if typed.yield_pressure is not None:
        if len(typed.typed) > 1:
            raise InputError(*typed.typed[1], "no --yield-pressure beside it", "give one of them")
        return _cap_of_pressure(typed.yield_pressure, base)
    if typed.yield_load is None:
        raise InputError("--yield-load", MISSING, "the load that belongs to --shape", 'such as "6.5 kN"')
    shape = typed.shape or base.shape
    if shape is None:
        raise InputError("--shape", MISSING, "the shape of the contact that yields", "line or point")
    cap = PressureCap(typed.yield_load, shape)
    refuse_beyond_law(cap, base.stiffness, f"{typed.yield_load:g} N", "--yield-load")
    return cap


def _cap_of_pressure(pressure: float | str, base: Base) -> PressureCap:
    text, sizes = pressure if isinstance(pressure, str) else f"{pressure:g} Pa", base.sizes
    if base.shape is None or base.bodies is None:
        hint = "give --yield-load and --shape line|point"
        raise InputError("--yield-pressure", text, "a --law with a length or a radius", hint)
    if sizes.radius1 is None:
        raise _missing("radius1", "on which the yield pressure acts")
    one, other = base.bodies
    if isinstance(pressure, str):
        pressure = pressure_of_materials(one, other, "--yield-pressure").best
    try:
        cap = cap_of(one, other, base.cap_sizes, pressure)
    except ValueError as error:
        raise InputError("--yield-pressure", text, "a pressure that a body bears", str(error)) from None
    refuse_beyond_law(cap, base.stiffness, text, "--yield-pressure", pressure)
    return cap
