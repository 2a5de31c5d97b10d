"""Rows of the reproduction of Li & Ma 2019: equations, published numbers, findings.

All values are in SI units; ``unit`` beside them is the text of the unit that a number was published in, or of the
quantity itself in a row of an equation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Section = Literal["3.1", "3.2"]
Verdict = Literal["right", "approximate", "misprint", "wrong", "definition"]
Origin = Literal["measured", "simulated", "given"]
Answer = Literal["right", "partly", "not", "open"]
Basis = Literal["independent", "round trip", "identity"]


@dataclass(frozen=True)
class EquationRow:
    """One numbered equation of the paper: as printed, corrected, exact.

    Attributes
    ----------
    number : str
        As the paper numbers it, "(24)"; the number that it uses twice is "(35)" and "second (35)".
    section : str
        "3.1" contact force, "3.2" stress wave.
    what : str
        What the equation says.
    formula : str
        The printed formula, plain Unicode text.
    corrected : str
        The repaired formula; empty where the printed one stands.
    tex, corrected_tex : str
        Both formulas to typeset, as TeX.
    quantity, unit : str
        The number that is compared, and its unit ("1" without one).
    printed, corrected_value, exact : float or None
        What the printed formula gives, the corrected one, and the answer they are held against (see ``basis``).
    verdict : str
        right: the numbers agree within rounding; approximate: an estimate, off by what the row shows; misprint: the
        formula as printed cannot be meant; wrong: it does not hold; definition: an identity or a name.
    note : str
        Why, and where the exact number comes from.
    basis : str
        What ``exact`` is: independent, found another way; round trip, the same rule inverted, or a number that was put
        in and is read back; identity, the same thing by algebra or by the conservation that the solution is built on.
    printed_unit : str
        Unit of the printed number where it is not ``unit``.
    """

    number: str
    section: Section
    what: str
    formula: str
    tex: str
    corrected: str
    corrected_tex: str
    quantity: str
    unit: str
    printed: float | None
    corrected_value: float | None
    exact: float | None
    verdict: Verdict
    note: str
    basis: Basis = "independent"
    printed_unit: str = ""

    @property
    def deviation(self) -> float | None:
        """What the printed value is off the exact one, relative to that (absolute where the exact one is 0).

        None where the two are not in one unit.
        """
        return None if self.printed_unit else _deviation(self.printed, self.exact)

    @property
    def corrected_deviation(self) -> float | None:
        """What the corrected value is off the exact one, as `deviation`."""
        return _deviation(self.corrected_value, self.exact)


@dataclass(frozen=True)
class PublishedNumber:
    """A number that the paper publishes.

    Attributes
    ----------
    name : str
        Key of the number, such as "rigid peak simulated".
    where : str
        Section, figure or table that says it.
    quantity : str
        What it is.
    value : float
        In SI units.
    unit : str
        Unit in which the paper says it ("g", "us", "N"); `strikewave.base.units` turns the value back.
    origin : str
        measured, simulated (with LS-DYNA) or given (chosen or stated by the authors).
    note : str
        What must be known to use it.
    """

    name: str
    where: str
    quantity: str
    value: float
    unit: str
    origin: Origin
    note: str = ""


@dataclass(frozen=True)
class Consistency:
    """A check of published numbers among each other.

    Attributes
    ----------
    what : str
        The question.
    uses : tuple of str
        Names of the published numbers in it.
    quantity, unit : str
        The number that answers it, SI.
    value : float
        What follows from the numbers.
    stated : float or None
        What the paper says about it, if it does.
    agrees : bool or None
        Whether the two agree; None where the paper says nothing.
    note : str
        How it follows, and what it means.
    """

    what: str
    uses: tuple[str, ...]
    quantity: str
    unit: str
    value: float
    stated: float | None
    agrees: bool | None
    note: str


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
        Of the contact force, N s.
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


@dataclass(frozen=True)
class Finding:
    """A line of the closing table: what the paper gets right, and what not.

    Attributes
    ----------
    topic, paper, found : str
        What it is about, what the paper says, what we find (with its numbers).
    verdict : str
        right, partly, not; open where what decides it is not published, or was not run.
    shown_by : str
        Equations, figures or cases that show it.
    ours : bool
        Whether the point is ours: the paper makes no statement of it.
    """

    topic: str
    paper: str
    found: str
    verdict: Answer
    shown_by: str
    ours: bool = False


def _deviation(value: float | None, exact: float | None) -> float | None:
    """Return (value - exact)/|exact|, or the difference where exact is 0; None where one is missing."""
    if value is None or exact is None:
        return None
    return (value - exact) / (abs(exact) or 1.0)
