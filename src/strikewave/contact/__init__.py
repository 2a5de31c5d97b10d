"""Contact laws and impacts: stiffness, damping, one blow in closed form, chains of bodies.

Examples
--------
>>> from strikewave.contact import Contact, exact, solve_impact
>>> blow = solve_impact(Contact(4.7e9, 10 / 9, exact(0.5)), 0.2, 0.459, 20.0)
>>> print(blow.restitution.round(12))
0.5
"""

from strikewave.contact.chain import Chain, ChainMotion, Spring, Stop, Touch, simulate
from strikewave.contact.damping import DAMPING_LAWS, exact, factor, li_ma_printed, restitution
from strikewave.contact.impact import History, Impact, impact_history, reduced_mass, solve_impact
from strikewave.contact.law import Contact, Damper, LogarithmicContact, PressureCap
from strikewave.contact.stiffness import (
    STIFFNESS_LAWS,
    Stiffness,
    contact_modulus,
    hertz,
    line_contact_yield_load,
    palmgren,
)

__all__ = [
    "DAMPING_LAWS",
    "STIFFNESS_LAWS",
    "Chain",
    "ChainMotion",
    "Contact",
    "Damper",
    "History",
    "Impact",
    "LogarithmicContact",
    "PressureCap",
    "Spring",
    "Stiffness",
    "Stop",
    "Touch",
    "contact_modulus",
    "exact",
    "factor",
    "hertz",
    "impact_history",
    "li_ma_printed",
    "line_contact_yield_load",
    "palmgren",
    "reduced_mass",
    "restitution",
    "simulate",
    "solve_impact",
]
