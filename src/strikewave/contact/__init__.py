"""Contact laws and impacts: stiffness, damping, plasticity, one blow exactly, chains of bodies.

Examples
--------
>>> from strikewave.contact import Contact, exact, solve_impact
>>> blow = solve_impact(Contact(4.7e9, 10 / 9, exact(0.5)), 0.2, 0.459, 20.0)
>>> print(blow.restitution.round(12))
0.5
"""

from strikewave.contact.chain import Chain, ChainContact, ChainMotion, Friction, Spring, Stop, Vibration, simulate
from strikewave.contact.damping import (
    damper_law,
    damper_laws,
    damping_law,
    damping_laws,
    exact,
    factor,
    li_ma_printed,
    named_contact,
    restitution,
)
from strikewave.contact.elastoplastic import (
    CAP_LAWS,
    AutomaticPressure,
    FirstYield,
    automatic_pressure,
    cap_of,
    first_yield,
    hardness_of,
    line_cap,
    line_yield_pressure,
    point_cap,
    point_yield_pressure,
    slow_force,
    thornton_restitution,
    yield_speed,
)
from strikewave.contact.identification import Identified, identify
from strikewave.contact.impact import Impact, ImpactHistory, impact_history, reduced_mass, solve_impact
from strikewave.contact.law import AnyContact, Contact, Damper, HardeningContact, LogarithmicContact, PressureCap
from strikewave.contact.registry import CapLaw, CushionLaw, DamperLaw, DampingLaw, Law, StiffnessLaw
from strikewave.contact.stiffness import (
    Geometry,
    LogarithmicStiffness,
    Stiffness,
    contact_modulus,
    hertz,
    johnson,
    palmgren,
    stiffness_law,
    stiffness_laws,
    stiffness_of,
)

__all__ = [
    "CAP_LAWS",
    "AnyContact",
    "AutomaticPressure",
    "CapLaw",
    "Chain",
    "ChainContact",
    "ChainMotion",
    "Contact",
    "CushionLaw",
    "Damper",
    "DamperLaw",
    "DampingLaw",
    "FirstYield",
    "Friction",
    "Geometry",
    "HardeningContact",
    "Identified",
    "Impact",
    "ImpactHistory",
    "Law",
    "LogarithmicContact",
    "LogarithmicStiffness",
    "PressureCap",
    "Spring",
    "Stiffness",
    "StiffnessLaw",
    "Stop",
    "Vibration",
    "automatic_pressure",
    "cap_of",
    "contact_modulus",
    "damper_law",
    "damper_laws",
    "damping_law",
    "damping_laws",
    "exact",
    "factor",
    "first_yield",
    "hardness_of",
    "hertz",
    "identify",
    "impact_history",
    "johnson",
    "li_ma_printed",
    "line_cap",
    "line_yield_pressure",
    "named_contact",
    "palmgren",
    "point_cap",
    "point_yield_pressure",
    "reduced_mass",
    "restitution",
    "simulate",
    "slow_force",
    "solve_impact",
    "stiffness_law",
    "stiffness_laws",
    "stiffness_of",
    "thornton_restitution",
    "yield_speed",
]
