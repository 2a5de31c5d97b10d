"""The dual-mass shock amplifier: a second mass on cushions above a drop table, which the rebounding table strikes.

Table and second mass fall together. The table comes to a pulse shaper on the anvil and is thrown back; the second mass,
on soft cushions, goes on down, closes the gap and meets the table, which comes up: a short, high pulse. Speeds are
positive upwards.

With the restitutions e1 of the table on the shaper and e2 of the two masses, the ratio mu = m/M of second mass to
table, and cushions that do nothing on the way, the masses close with (1 + e1) v, and the second one leaves with
(1 + e2) (1 + e1) v/(1 + mu) - v: `strikewave.machines.amplifier.next_speed` of e1 v. At best, elastic and light, it
goes three times as fast as it fell.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.contact.chain import Chain, ChainContact, Link, Spring, simulate
from strikewave.contact.law import AnyContact
from strikewave.machines.launch import linear_shaper

LONGEST_WAY = 1.0
"""How long the second mass may take to meet the table, s: chosen, ten times what soft cushions of 16 Hz take."""


class DualMass(NamedTuple):
    """Table and second mass, SI.

    Attributes
    ----------
    table, second : float
        Masses, kg.
    gap : float
        Way of the second mass to the pad on the table while both fall, its cushions unloaded, m.
    cushion_stiffness, cushion_damping : float
        All cushions together, N/m and N s/m.
    shaper_stiffness, shaper_restitution : float
        Of the table on the anvil: a linear spring with a damper that never pulls, N/m.
    pad : Contact
        Law of the contact between second mass and table.
    """

    table: float
    second: float
    gap: float
    cushion_stiffness: float
    cushion_damping: float
    shaper_stiffness: float
    shaper_restitution: float
    pad: AnyContact


class SecondImpact(NamedTuple):
    """How the second mass comes to the table.

    Attributes
    ----------
    time : float
        After the table has met the shaper, s.
    table, second : float
        Speeds, upwards, m/s.
    gain : float
        Speed with which the second mass leaves, by the law of the pad between rigid masses, over the speed of the fall.
    cushion_force, shaper_force : float
        Force of the cushions and of the shaper at that moment, N.
    """

    time: float
    table: float
    second: float
    gain: float
    cushion_force: float
    shaper_force: float


def second_impact(masses: DualMass, speed: float, gravity: float = STANDARD_GRAVITY) -> SecondImpact:
    """Return how the second mass comes to the table after a fall at a speed.

    Raises
    ------
    ValueError
        If it does not come there within `LONGEST_WAY`.

    Notes
    -----
    Newton's law for two masses, integrated with located switches (`strikewave.contact.chain.simulate`). How such a
    machine is built is from memory; of stacked bodies that fall together for high shocks tell Duan et al. 2023.

    Examples
    --------
    >>> from strikewave.contact import Contact
    >>> soft = DualMass(20.0, 2.0, 10e-3, 1.0, 0.0, 5e7, 1.0, Contact(1e9, 1.0))
    >>> impact = second_impact(soft, speed=3.0, gravity=0.0)
    >>> round(impact.table, 3), round(impact.second, 3), round(impact.gain, 3)  # v, -v and 2 (1 + 1)/(1.1) - 1
    (3.0, -3.0, 2.636)
    """
    shaper = linear_shaper(masses.shaper_stiffness, masses.table, masses.shaper_restitution)
    links: list[Link] = [
        ChainContact("anvil", "table", shaper),
        Spring("table", "second", masses.cushion_stiffness, masses.cushion_damping, offset=-masses.gap),
        ChainContact("table", "second", masses.pad),
    ]
    chain = Chain({"table": masses.table, "second": masses.second}, links, {"anvil": 0.0}, -gravity)
    places, speeds = {"table": 0.0, "second": masses.gap}, {"table": -speed, "second": -speed}
    duration = math.pi * math.sqrt(masses.table / masses.shaper_stiffness) + masses.gap / speed
    while duration < LONGEST_WAY:
        duration = min(2.0 * duration, LONGEST_WAY)
        motion = simulate(chain, places, speeds, duration)
        contacts = motion.contacts(2)
        if len(contacts) and contacts[0, 1] < duration:
            begin, end = float(contacts[0, 0]), float(contacts[0, 1])
            table, second = (float(v) for v in motion.speeds(begin))
            shaper_force, cushion_force, _ = (float(force) for force in motion.forces(begin))
            gain = float(motion.speeds(end)[1]) / speed
            return SecondImpact(begin, table, second, gain, cushion_force, shaper_force)
    hint = "take a smaller gap or softer cushions"
    raise ValueError(f"the second mass does not meet the table within {LONGEST_WAY:g} s: {hint}")
