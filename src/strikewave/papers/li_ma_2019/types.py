"""Rows of the reproduction of Li & Ma 2019: equations, published numbers, findings.

All values are in SI units; ``unit`` beside them is the text of the unit that a number was published in, or of the
quantity itself in a row of an equation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from strikewave.base import declare
from strikewave.base.declare import Quantity
from strikewave.base.shock_quantities import RATIO

Section = Literal["3.1", "3.2"]
Verdict = Literal["right", "approximate", "misprint", "wrong", "definition"]
Origin = Literal["measured", "simulated", "given"]
Answer = Literal["right", "partly", "not", "open"]
Basis = Literal["independent", "round trip", "identity"]
SEE_UNIT = Quantity.of_data("SI, see unit")


@declare.dataclass
class EquationRow:
    """One numbered equation of the paper: as printed, corrected, exact."""

    number: str = declare.word('as the paper numbers it, "(24)"; that which it uses twice is "(35)" and "second (35)"')
    section: Section = declare.word("3.1 contact force, 3.2 stress wave")
    what: str = declare.word("what the equation says")
    formula: str = declare.word("the printed formula, plain Unicode text")
    tex: str = declare.word("it to typeset, as TeX")
    corrected: str = declare.word("the repaired formula; empty where the printed one stands")
    corrected_tex: str = declare.word("it to typeset, as TeX")
    quantity: str = declare.word("the number that is compared")
    unit: str = declare.word('its unit; "1" without one')
    printed: float | None = declare.number(
        Quantity.of_data("SI, see printed_unit, else unit"), "what the printed formula gives"
    )
    corrected_value: float | None = declare.number(SEE_UNIT, "what the corrected one gives")
    exact: float | None = declare.number(SEE_UNIT, "the answer that they are held against: see basis")
    verdict: Verdict = declare.word(
        "right: the numbers agree within rounding; approximate: an estimate, off by what the row shows; misprint: the "
        "formula as printed cannot be meant; wrong: it does not hold; definition: an identity or a name"
    )
    note: str = declare.word("why, and where the exact number comes from")
    basis: Basis = declare.word(
        "what the exact one is: independent, found another way; round trip, the same rule inverted, or a number that "
        "was put in and is read back; identity, the same thing by algebra or by the conservation that the solution is "
        "built on",
        default="independent",
    )
    printed_unit: str = declare.word("unit of the printed number where it is not unit", default="")

    @declare.computed(declare.number(RATIO, "what the printed value is off the exact one; null in another unit"))
    def deviation(self) -> float | None:
        """What the printed value is off the exact one, relative to that (absolute where the exact one is 0).

        None where the two are not in one unit.
        """
        return None if self.printed_unit else _deviation(self.printed, self.exact)

    @declare.computed(declare.number(RATIO, "what the corrected value is off the exact one"))
    def corrected_deviation(self) -> float | None:
        """What the corrected value is off the exact one, as `deviation`."""
        return _deviation(self.corrected_value, self.exact)


@declare.dataclass
class PublishedNumber:
    """A number that the paper publishes.

    Attributes
    ----------
    value : float
        In SI units.
    unit : str
        Unit in which the paper says it ("g", "us", "N"); `strikewave.base.units` turns the value back.
    """

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


@dataclass(frozen=True)
class ElementNumbers:
    """What a run of finite elements measured; None where it was not asked for.

    Attributes
    ----------
    peak_force : float or None
        Largest force of the contact between striker and fixture, N.
    rigid_peak : float or None
        Largest acceleration of the whole struck body, its momentum rate over its mass, m/s^2.
    width : float or None
        Width of that pulse at 10 % of its peak, s.
    impulse : float or None
        Impulse of the contact force, N s.
    momentum : float or None
        Largest that the struck body gained, N s.
    slope_early, slope_late : float or None
        Steepness of the rise of the contact force between 10 and 30 %, and between 50 and 90 % of its peak, N/s.
    section_peak : float or None
        Largest acceleration of the mid section of the sensor, m/s^2.
    mean_peak : float or None
        Largest acceleration of the sensor, mean over the part, m/s^2.
    plastic_strain : float or None
        Largest equivalent plastic strain anywhere.
    shell_stress : float or None
        Largest von Mises stress of the cylinder shell that the frame holds, Pa.
    """

    peak_force: float | None = None
    rigid_peak: float | None = None
    width: float | None = None
    impulse: float | None = None
    momentum: float | None = None
    slope_early: float | None = None
    slope_late: float | None = None
    section_peak: float | None = None
    mean_peak: float | None = None
    plastic_strain: float | None = None
    shell_stress: float | None = None


@declare.dataclass
class Finding:
    """A line of the closing table: what the paper gets right, and what not."""

    topic: str = declare.word("what it is about")
    paper: str = declare.word("what the paper says")
    found: str = declare.word("what we find, with its numbers")
    verdict: Answer = declare.word("right, partly, not; open where what decides it is not published, or was not run")
    shown_by: str = declare.word("equations, figures or cases that show it")
    ours: bool = declare.word("whether the point is ours: the paper makes no statement of it", default=False)


def _deviation(value: float | None, exact: float | None) -> float | None:
    """Return (value - exact)/|exact|, or the difference where exact is 0; None where one is missing."""
    if value is None or exact is None:
        return None
    return (value - exact) / (abs(exact) or 1.0)
