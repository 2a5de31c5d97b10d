"""Walls of a frame as beams clamped at both ends and struck in the middle: stiffness, and the mass that moves.

Symbols: E Young's modulus (Pa), G shear modulus (Pa), nu Poisson's ratio, L span (m), b width (m), t thickness (m),
I = b t^3/12 second moment (m^4), A = b t area (m^2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from strikewave.fem.solids import AnySolid

MIDDLE_SHARE = 13.0 / 35.0
"""Share of the mass of a clamped beam that moves with its middle; see `middle_mass`."""


def bending_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a clamped beam in its middle by bending, k = 192 E I/L^3, N/m.

    For thin beams (t below about L/10) whose ends neither move nor turn. Source: Euler-Bernoulli; Timoshenko,
    Strength of Materials I, 1955, art. 41.

    Examples
    --------
    >>> from strikewave.fem.solids import Elastic
    >>> round(bending_stiffness(Elastic(7820.0, 211e9, 0.288), 0.1, 0.03, 0.005) / 1e6, 3)
    12.66
    """
    return 16.0 * body.youngs_modulus * width * (thickness / span) ** 3


def shear_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a beam in its middle by shear alone, k = 4 kappa G A/L, N/m.

    Each half carries half the force: F L/(4 kappa G A). kappa = 10 (1 + nu)/(12 + 11 nu) of a rectangle (Cowper 1966).

    Examples
    --------
    >>> from strikewave.fem.solids import Elastic
    >>> round(shear_stiffness(Elastic(7820.0, 211e9, 0.288), 0.1, 0.03, 0.005) / 1e6, 1)
    417.3
    """
    nu = body.poissons_ratio
    kappa = 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu)
    modulus = 0.5 * body.youngs_modulus / (1.0 + nu)
    return 4.0 * kappa * modulus * width * thickness / span


def clamped_stiffness(body: AnySolid, span: float, width: float, thickness: float) -> float:
    """Return force over deflection of a clamped beam in its middle, bending and shear in series, N/m.

    Source: Timoshenko 1921, whose two deflections add under a force that rests.

    Examples
    --------
    >>> from strikewave.fem.solids import Elastic
    >>> round(clamped_stiffness(Elastic(7820.0, 211e9, 0.288), 0.1, 0.03, 0.005) / 1e6, 3)
    12.287
    """
    sizes = (span, width, thickness)
    return 1.0 / (1.0 / bending_stiffness(body, *sizes) + 1.0 / shear_stiffness(body, *sizes))


def middle_mass(mass: float) -> float:
    """Return the mass at the middle of a clamped beam that has its kinetic energy, 13/35 of its own, kg.

    Rayleigh's method with the shape under a force that rests, w = 4 x^2 (3 L - 4 x)/L^3 up to the middle and mirrored
    beyond: the mean of w^2 is 13/35. Its first frequency is 1.6 % above the exact one, 22.373 sqrt(E I/(m L^3)).
    Source: Rayleigh, Theory of Sound, 1877, ch. IV.

    Examples
    --------
    >>> round(middle_mass(0.35), 6)
    0.13
    """
    return MIDDLE_SHARE * mass


@dataclass(frozen=True)
class FrameWall:
    """A wall of a frame between its side walls, struck in its middle.

    Where a column is bonded to its middle, the wall neither bends nor turns there: by symmetry what is left is a
    clamped beam of the span less the column, whose middle carries the strip under the column too.

    Parameters
    ----------
    solid : solid
    span, width, thickness : float
        L, b, t, m.
    held : float
        Length of the span that a bonded column holds flat, m.
    """

    solid: AnySolid
    span: float
    width: float
    thickness: float
    held: float = 0.0

    @property
    def mass(self) -> float:
        """Mass over the whole span, kg."""
        return self.solid.density * self.span * self.width * self.thickness

    @property
    def stiffness(self) -> float:
        """Force over deflection of the middle against the side walls, N/m."""
        return clamped_stiffness(self.solid, self.span - self.held, self.width, self.thickness)

    @property
    def middle_mass(self) -> float:
        """Mass that moves with the middle, kg."""
        share = self.held / self.span
        return share * self.mass + middle_mass((1.0 - share) * self.mass)


def endless_compliance(solid: AnySolid, width: float, thickness: float) -> float:
    """Return C of a beam without ends: an impulse P upon it deflects that place by w = C P sqrt(t), m/(N s^1.5).

    C = 1/(sqrt(2 pi) (E I)^(1/4) m^(3/4)), m mass per length: that of the Euler-Bernoulli beam, transformed by Laplace
    w(s) = F(s)/(2 sqrt(2) (E I)^(1/4) m^(3/4) s^(3/2)). It holds until bending waves come back from the ends. Source:
    the kind of equation is that of Timoshenko 1913 for a ball on a beam; the kernel is derived here, the tests find it
    by modes of a long beam.

    Examples
    --------
    >>> from strikewave.fem.solids import Elastic
    >>> print(f"{endless_compliance(Elastic(7820.0, 211e9, 0.288), 0.03, 0.005):.5f}")
    0.12421
    """
    inertia = width * thickness**3 / 12.0
    mass = solid.density * width * thickness
    return 1.0 / (math.sqrt(2.0 * math.pi) * (solid.youngs_modulus * inertia) ** 0.25 * mass**0.75)
