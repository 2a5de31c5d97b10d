"""What one blow of several came to: rebound, yield, and whether it was over when it ended; SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.fem.measures import contact_measure
from strikewave.fem.mesh import TINY
from strikewave.fem.run import FemRun, Rest

Array = NDArray[np.float64]
PRESSES = 0.01
"""Share of the peak above which a contact still presses at the end of a run: the last 1 % of a pulse gives no speed."""


@dataclass(frozen=True)
class BlowMeasure:
    """A blow among several.

    Attributes
    ----------
    blow : int
        From 1.
    restitution : mapping of str to float or None
        By contact or wall; see `restitution`.
    plastic_strain : mapping of str to float
        Largest at the end, of each part that deforms: of all blows so far.
    plastic_energy : mapping of str to float
        Plastic work of this blow in each part that deforms, J.
    rest : Rest or None
        How the bodies came to rest before it.
    """

    blow: int
    restitution: Mapping[str, float | None]
    plastic_strain: Mapping[str, float]
    plastic_energy: Mapping[str, float]
    rest: Rest | None


def blow_measure(run: FemRun, touching: Mapping[str, Sequence[str]]) -> BlowMeasure:
    """Measure a blow; ``touching`` are the sides of each contact and wall, `Model.touching`."""
    return BlowMeasure(
        blow=run.blow,
        restitution={name: restitution(run, name, sides) for name, sides in touching.items()},
        plastic_strain={name: float(values[-1]) for name, values in run.plastic_strain.items()},
        plastic_energy=dict(run.plastic_work),
        rest=run.rest,
    )


def restitution(run: FemRun, name: str, sides: Sequence[str]) -> float | None:
    """Return the speed of separation over that of approach of the two bodies of a contact, from their momenta.

    A body is all that ties or common nodes join, so that its vibration counts for nothing. Both speeds are along the
    impulse of the contact, the first at the end and the second at the start of the run; a wall rests. None where
    nothing touched, the bodies did not approach each other at the start, or still press at the end.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> down, up = np.array([0.0, 0.0, -2.0]), np.array([0.0, 0.0, 1.5])
    >>> ball = SimpleNamespace(mass=1.0, velocity=np.array([down, 0.0 * down, up, up]))
    >>> impulse = np.array([[0.0, 0.0, x] for x in (0.0, 2.0, 3.5, 3.5)])
    >>> run = SimpleNamespace(time=np.arange(4.0), impulse={"a": impulse}, parts={"ball": ball}, bodies=())
    >>> restitution(run, "a", ("ball.round",))
    0.75
    """
    if contact_measure(run, name) is None or still_presses(run, name):
        return None
    impulse = run.impulse[name][-1]
    normal = impulse / max(float(np.linalg.norm(impulse)), TINY)
    speeds = [_velocity(run, side.rpartition(".")[0] or side) for side in sides]
    relative = speeds[0] - (speeds[1] if len(speeds) > 1 else 0.0)
    approach, separation = -float(relative[0] @ normal), float(relative[-1] @ normal)
    return separation / approach if approach > 0.0 else None


def _velocity(run: FemRun, part: str) -> Array:
    """Return momentum over mass (instants, 3) of the body that a part belongs to, m/s."""
    names = next((body for body in run.bodies if part in body), (part,))
    momentum = sum((run.parts[name].mass * run.parts[name].velocity for name in names), np.zeros(3))
    return np.asarray(momentum / sum(run.parts[name].mass for name in names))


def pressing_at_end(run: FemRun, name: str) -> float:
    """Return the mean force of a contact over the last interval of a run, N."""
    last = (run.impulse[name][-1] - run.impulse[name][-2]) / (run.time[-1] - run.time[-2])
    return float(np.linalg.norm(last))


def still_presses(run: FemRun, name: str) -> bool:
    """Tell whether a contact presses at the end of a run, by the mean force of the last interval."""
    measure = contact_measure(run, name)
    return measure is not None and pressing_at_end(run, name) > PRESSES * measure.peak
