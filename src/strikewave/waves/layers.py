"""A bar of layers, joints and an end along the blow: the stack.

Symbols: rho density (kg/m^3), E Young's modulus (Pa), A area (m^2), l length (m), c = sqrt(E/rho) bar
speed (m/s), Z = rho c A impedance (N s/m), t = l/c transit time (s). Compression and motion along the
blow are positive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import Material
from strikewave.contact import _law_kernels
from strikewave.contact.law import AnyContact, striking_law
from strikewave.waves.dispersion import THEORIES, Theory

EndKind = Literal["free", "matched", "rigid", "mass", "spring", "dashpot", "oscillator"]
END_KINDS: tuple[EndKind, ...] = ("free", "matched", "rigid", "mass", "spring", "dashpot", "oscillator")
"""Kinds of the end; their order is that of the numbers in the kernels."""


@dataclass(frozen=True)
class Branch:
    """A Maxwell branch, spring and dashpot in series: stiffness (N/m) and relaxation time (s)."""

    stiffness: float
    relaxation: float


class LossFit(NamedTuple):
    """A spring with Maxwell branches that holds a loss factor over a band."""

    stiffness: float
    """Long-time stiffness k, N/m: that of the spring beside the branches."""
    branches: tuple[Branch, ...]
    """Branches from the longest to the shortest relaxation time; empty without loss."""
    error: float
    """Largest deviation of the loss factor over the band, relative to the wanted one."""
    band: tuple[float, float]
    """Lowest and highest frequency, Hz."""


@dataclass(frozen=True)
class Layer:
    """A prismatic part of a stack.

    Theory: :eq:`wave-force`.

    Parameters
    ----------
    name : str
        Name of the layer.
    density : float
        rho, kg/m^3.
    modulus : float
        E, Pa.
    area : float
        A, m^2.
    length : float
        l, m.
    diameter : float, optional
        Diameter of the bar, m; that of a solid round bar of the same area when left out. Only the limits of
        one-dimensional theory use it.
    yield_strength : float or None, optional
        Pa.
    poissons_ratio : float or None, optional
        Only dispersion uses it.
    speed : float, optional
        Speed before the load comes, m/s: a layer with a speed is a striker bar.
    loss : LossFit or None, optional
        Springs and dashpots per unit of E that give the material its loss factor; E is then the storage modulus
        in the middle of their band. Only the spectral solver takes it.
    dispersion : str, optional
        Theory by which short waves run slower; only the spectral solver takes another one than "none".

    Examples
    --------
    >>> bar = Layer("bar", 7820.0, 211e9, 7.0686e-4, 0.07)
    >>> round(bar.bar_speed, 2), round(bar.impedance), round(bar.transit * 1e6, 4)
    (5194.43, 28713, 13.476)
    """

    name: str
    density: float
    modulus: float
    area: float
    length: float
    diameter: float = 0.0
    yield_strength: float | None = None
    poissons_ratio: float | None = None
    speed: float = 0.0
    loss: LossFit | None = None
    dispersion: Theory = "none"

    def __post_init__(self) -> None:
        for key in ("density", "modulus", "area", "length"):
            value = getattr(self, key)
            if not 0.0 < value < math.inf:
                raise ValueError(f"{key} of layer {self.name!r} must be above zero and finite, got {value!r}")
        if self.diameter == 0.0:
            object.__setattr__(self, "diameter", math.sqrt(4.0 * self.area / math.pi))
        if self.dispersion not in THEORIES:
            raise ValueError(f"dispersion of layer {self.name!r} is one of {', '.join(THEORIES)}")
        if self.dispersion != "none" and self.poissons_ratio is None:
            raise ValueError(f"layer {self.name!r} needs a Poisson's ratio for its dispersion")

    @property
    def bar_speed(self) -> float:
        """Speed of a wave in the bar, c = sqrt(E/rho), m/s."""
        return math.sqrt(self.modulus / self.density)

    @property
    def impedance(self) -> float:
        """Wave impedance Z = rho c A, N s/m."""
        return self.density * self.bar_speed * self.area

    @property
    def transit(self) -> float:
        """Time of a wave from face to face, l/c, s."""
        return self.length / self.bar_speed

    @property
    def mass(self) -> float:
        """Mass rho A l, kg."""
        return self.density * self.area * self.length


def round_bar(name: str, material: Material, length: float, diameter: float, speed: float = 0.0) -> Layer:
    """Return a solid round bar of a material; lengths in m.

    Returns
    -------
    Layer
        With density, wave speed and area from material and diameter.

    Examples
    --------
    >>> from strikewave.base.constants import material
    >>> round(round_bar("bar", material("65Mn"), 0.1, 0.03).mass, 4)
    0.5528
    """
    area = 0.25 * math.pi * diameter**2
    density, modulus = material.density, material.youngs_modulus
    strength, ratio = material.yield_strength, material.poissons_ratio
    return Layer(name, density, modulus, area, length, diameter, strength, ratio, speed)


@dataclass(frozen=True)
class Joint:
    """Joint between two layers, bonded by default.

    With x the compression of the joint and x' its rate, the force is

        f = k x + c x' + sum of Maxwell branches

    or, for an infinite stiffness, whatever keeps x = 0. A unilateral joint pushes only: its force never
    falls below minus its preload, and it transmits nothing while its gap is open. With a preload the
    joint is bolted: forces count from the bolted state, and once it opens the bolt pulls with the preload.
    A joint with a mass is a rigid point mass between bonded faces. One with an attached mass bonds the faces and
    hangs the mass on them by its spring and dashpot: the seismic mass of a sensor. One with a contact pushes by an
    elastic contact law, retarded or not, and beyond its yield load plastically.

    Parameters
    ----------
    stiffness : float, optional
        k, N/m; infinite for faces that move together.
    damping : float, optional
        c, N s/m.
    branches : tuple of Branch, optional
        Maxwell branches of a gasket with loss.
    unilateral : bool, optional
        True if the joint can open.
    gap : float, optional
        Open gap at the start, m.
    preload : float, optional
        Compression that a bolt puts on the joint, N.
    mass : float, optional
        kg.
    attached : float, optional
        Mass on the spring, kg.
    contact : Contact, LogarithmicContact, HardeningContact or None, optional
        Law of a nonlinear contact, without hysteresis: faces that touch have no approach speed. Its damper may be a
        retarded one.
    yield_force : float, optional
        Force at which a gasket yields, N; the waves do not know it.
    """

    stiffness: float = math.inf
    damping: float = 0.0
    branches: tuple[Branch, ...] = ()
    unilateral: bool = False
    gap: float = 0.0
    preload: float = 0.0
    mass: float = 0.0
    attached: float = 0.0
    contact: AnyContact | None = None
    yield_force: float = math.inf

    def __post_init__(self) -> None:
        values = (self.damping, self.gap, self.preload, self.mass, self.attached)
        if not self.stiffness > 0.0 or not all(value >= 0.0 for value in values):
            raise ValueError(f"a joint takes no negative value, and a stiffness above zero: {self}")
        if self.contact is not None:
            _check_contact(self, striking_law(self.contact))
            object.__setattr__(self, "unilateral", True)
        if self.attached > 0.0 and (math.isinf(self.stiffness) or self.branches or self.unilateral or self.mass > 0.0):
            raise ValueError("a joint with an attached mass has a finite stiffness, maybe damping, and nothing else")
        if (self.gap > 0.0 or self.preload > 0.0) and not self.unilateral:
            raise ValueError("only a unilateral joint has a gap or a preload")
        if self.gap > 0.0 and self.preload > 0.0:
            raise ValueError("a joint with an open gap carries no preload")
        rigid = math.isinf(self.stiffness)
        if rigid and (self.damping > 0.0 or self.branches):
            raise ValueError("a joint of infinite stiffness has no damping")
        if self.mass > 0.0 and not (rigid and not self.unilateral):
            raise ValueError("a joint with a mass is bonded on both faces: put other joints beside it")

    @property
    def kind(self) -> str:
        """Kind of the joint: bonded, compliant, gasket, unilateral, mass, oscillator or contact."""
        if self.contact is not None:
            return "contact"
        if self.attached > 0.0:
            return "oscillator"
        if self.mass > 0.0:
            return "mass"
        if self.unilateral:
            return "unilateral"
        if self.branches:
            return "gasket"
        return "bonded" if math.isinf(self.stiffness) else "compliant"


def _check_contact(joint: Joint, law: NDArray[np.float64]) -> None:
    """Refuse values that a nonlinear contact between layers cannot have."""
    if math.isfinite(joint.stiffness) or joint.damping or joint.branches or joint.mass or joint.attached:
        raise ValueError("a joint with a contact law has a gap or a preload beside it, and nothing else")
    if law[_law_kernels.DAMPER] and law[_law_kernels.STYLE] != _law_kernels.RETARDED:
        raise ValueError("the contact law of a joint is elastic, or retarded: it takes no other damper")
    if law[_law_kernels.DAMPING]:
        raise ValueError("the contact law of a joint is elastic: give it a restitution of 1")
    yielding = law[_law_kernels.YIELD_LOAD]
    if joint.preload > yielding:
        raise ValueError(f"the preload of {joint.preload:g} N is beyond first yield at {yielding:g} N")


BONDED = Joint()
"""Faces that move together."""


@dataclass(frozen=True)
class End:
    """The far end: free, matched (an endless bar of the last layer), rigid, or a mass, spring, dashpot or oscillator.

    ``value`` is in kg, N/m or N s/m; the others take none. An oscillator is a mass (``value``) on a spring
    (``stiffness``, N/m) and dashpot (``damping``, N s/m): a sensor that sits on the end.
    """

    kind: EndKind = "free"
    value: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in END_KINDS:
            raise ValueError(f"an end is one of {', '.join(END_KINDS)}, got {self.kind!r}")
        if self.kind in ("mass", "spring", "dashpot", "oscillator") and not 0.0 < self.value < math.inf:
            raise ValueError(f"an end of kind {self.kind} needs a value above zero, got {self.value!r}")
        if self.kind == "oscillator" and not (0.0 < self.stiffness < math.inf and 0.0 <= self.damping < math.inf):
            raise ValueError(f"an end with a mass on a spring needs a stiffness above zero, got {self.stiffness!r}")


@dataclass(frozen=True)
class Stack:
    """Layers from the loaded face to the end, with a joint after each but the last.

    Raises
    ------
    ValueError
        If there is no layer, or not one joint between each two.

    Examples
    --------
    >>> bar = Layer("bar", 7820.0, 211e9, 7.0686e-4, 0.07)
    >>> stack = Stack((bar, bar), (BONDED,), End("rigid"))
    >>> round(stack.mass, 4), round(stack.transit * 1e6, 3)
    (0.7739, 26.952)
    """

    layers: tuple[Layer, ...]
    joints: tuple[Joint, ...] = ()
    end: End = field(default_factory=End)

    def __post_init__(self) -> None:
        if not self.layers:
            raise ValueError("a stack has at least one layer")
        if len(self.joints) != len(self.layers) - 1:
            raise ValueError(f"{len(self.layers)} layers need {len(self.layers) - 1} joints, got {len(self.joints)}")

    @property
    def mass(self) -> float:
        """Mass of layers, masses at joints and a mass at the end, kg."""
        ended = self.end.value if self.end.kind in ("mass", "oscillator") else 0.0
        carried = sum(joint.mass + joint.attached for joint in self.joints)
        return sum(layer.mass for layer in self.layers) + carried + ended

    @property
    def hung(self) -> tuple[tuple[int, float], ...]:
        """Masses on springs: index of the joint that carries each (that of the last layer: the end), and its kg."""
        masses = [(k, joint.attached) for k, joint in enumerate(self.joints) if joint.attached > 0.0]
        if self.end.kind == "oscillator":
            masses.append((len(self.layers) - 1, self.end.value))
        return tuple(masses)

    @property
    def transit(self) -> float:
        """Time of a wave through all layers, s."""
        return sum(layer.transit for layer in self.layers)
