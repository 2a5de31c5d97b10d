"""A rotary machine in which no two numbers are alike, so that whatever is taken for another shows."""

import dataclasses
import math

import numpy as np

from strikewave.contact import Contact
from strikewave.contact._chain_kernels import PUSHING, SLIDING
from strikewave.machines._kernels import HELD, LEFT
from strikewave.machines._layout import layout_of
from strikewave.machines.drive import Feed, Turntable
from strikewave.machines.fast_run import train_tables
from strikewave.machines.machine import Machine, RotaryDrive, Striker, Strikers
from strikewave.machines.struck_object import StruckObject

STRIKERS = (
    Striker(0.9, 2.0e6, 70.0, Contact(3.0e9, 1.5, 0.4), angle_error=0.01, reach_error=0.4e-3),
    Striker(1.1, 3.0e6, 90.0, Contact(4.0e9, 1.3, 0.3), angle_error=-0.02, reach_error=-0.3e-3),
    Striker(1.3, 5.0e6, 110.0, Contact(5.0e9, 1.2, 0.2), angle_error=0.03, reach_error=0.7e-3),
)
OBJECT = StruckObject(0.07, 0.43, 9.1e7, 210.0, 41e3, 390.0, 23.0, 2.1e5, 0.55, 9.7, friction=31.0, stiction=47.0)
DISC = Turntable(4.3, 0.21, 76.0, 41.0, 19.0, 0.023, 31.0, 0.7, 2100.0, 1.3)
FEED = Feed(1.2, 0.011, 0.0203, 0.031, 0.72, 5, 0.0037, 0.027, acceleration=0.45, cushion=0.35)
THETA, TURNING = 4.09, 71.0
"""Angle of the turntable: the third striker is 0.07 before its strike position; and its speed."""


def uneven(**changes):
    """Return the machine, with some settings of its strikers, object, turntable, feed or drive changed."""
    strikers = Strikers(STRIKERS, 0.3, friction=0.17, sliding_damping=2.3)
    drive = RotaryDrive(DISC, FEED, 5.5e-3, blow_angle=0.3, face_width=0.16)
    parts = {"strikers": strikers, "struck": OBJECT, "disc": DISC, "feed": FEED, "drive": drive}
    for part, values in changes.items():
        parts[part] = dataclasses.replace(parts[part], **values)
    start = dataclasses.replace(parts["drive"], turntable=parts["disc"], feed=parts["feed"])
    return Machine(parts["strikers"], parts["struck"], start)


def circle(machine, striker, theta, radius=None):
    """Return along and across the blow, from the strike position, where a striker stands on its circle; complex, m.

    The point R exp(i (theta - own angle)), turned by the angle of the blow, from where a nose without errors strikes.
    """
    one, angle = machine.strikers.each[striker], machine.drive.blow_angle
    own = machine.pitch * striker - one.angle_error
    reach = machine.radius + one.reach_error if radius is None else radius
    return reach * complex(math.cos(theta - own - angle), math.sin(theta - own - angle)) - machine.radius * complex(
        math.cos(angle), -math.sin(angle)
    )


def parts(frame=9.1e3, **changes):
    """Return the tables and both parts of a fast run, the third striker about to touch, and the layouts of both.

    The frame is so soft that what it bends by is seen in every digit.
    """
    changes["struck"] = {"frame_stiffness": frame} | changes.get("struck", {})
    tables, going, struck = train_tables(uneven(**changes))
    at = layout_of(tables.flight)
    y, mode, memory = going.y, going.mode, going.memory
    y[at.positions], y[at.speeds] = -4.7e-3, 0.9
    y[at.turntable] = THETA, TURNING, 0.013, 73.0
    y[at.energies] = np.arange(at.states)[at.energies]
    mode[at.held_modes] = np.arange(at.modes)[at.held_modes]
    mode[at.support], mode[at.stop], mode[at.rail] = PUSHING, PUSHING, SLIDING
    mode[at.feed], mode[at.on_face], mode[at.touching], mode[at.edge] = HELD, 1, 2, 0
    memory[at.own_memory] = 0.51, THETA + 0.3
    tables.mounted.deepest[:], tables.mounted.growth[:] = [1e-5, 2e-5, 3e-5], [1.1, 1.2, 1.3]
    tables.flight.seats[:, LEFT] = tables.mounted.deepest * (1.0 - 1.0 / tables.mounted.growth)
    return tables, going, struck, at, layout_of(tables.blow)
