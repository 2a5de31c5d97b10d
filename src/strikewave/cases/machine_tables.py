"""[machine] of the machines without a drive, by their kind: what is let go, and how it comes to the blow."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias, get_args

from pydantic import BeforeValidator, Field

from strikewave.base.errors import MISSING, InputError, nearest
from strikewave.base.quantities import (
    Count,
    FollowTime,
    Inertia,
    Length,
    Mass,
    MaybeAmbient,
    MaybeAngle,
    MaybeFriction,
    MaybeGap,
    MaybeHeatRatio,
    MaybeInertia,
    MaybeLength,
    MaybeMass,
    MaybePressure,
    MaybeShare,
    MaybeSpeed,
    MaybeTime,
    MaybeTorque,
    MaybeVolume,
    Restitution,
    SwingAngle,
    Value,
)
from strikewave.cases.tables import Machine, Name, Table


class Launched(Table):
    """What every machine without a drive has: ``follow``, how long it is watched after first touch."""

    follow: FollowTime = Value(si=10e-3, typed="10 ms")


class FallingBall(Launched):
    """[machine]: a ball that falls on the object; [striker] is the ball, in free flight where it has no mount.

    ``friction`` is that of its guide as a share of its weight (0).
    """

    kind: Literal["falling-ball"]
    height: Length
    friction: MaybeShare = None


class Drop(Launched):
    """[machine]: a table that falls with the object on an anvil; [contact] is the pulse shaper between them.

    [object] is the table with what it carries, [striker] the anvil, on its mount to the ground or free to move.
    ``friction`` is that of the guides as a share of the weight (0).
    """

    kind: Literal["drop"]
    height: Length
    friction: MaybeShare = None


class Pendulum(Launched):
    """[machine]: an arm let go at an ``angle`` from hanging, whose [striker] meets the object at the lowest point.

    ``mass``, ``centre`` (of gravity from the pivot) and ``inertia`` (about the pivot) are those of the whole arm, the
    striker included; ``period`` of small swings may stand for the inertia. ``radius`` is pivot to striker.
    """

    kind: Literal["pendulum"]
    angle: SwingAngle
    mass: Mass
    centre: Length
    radius: Length
    inertia: MaybeInertia = None
    period: MaybeTime = None


class Machete(Launched):
    """[machine]: a Machete hammer, drawn back by ``teeth`` of its ratchet wheel of ``wheel_teeth``.

    The object sits in the head of the arm and meets a fixed anvil, which is [striker]. ``weight`` hangs on a ``drum``
    of that radius; ``inertia`` is that of arm, head and counterweight about the shaft, ``radius`` shaft to head;
    ``mass`` and ``centre`` are those of an arm that is not balanced. ``friction`` is the torque of the shaft;
    ``strike_angle`` is where the arm strikes, from hanging down.
    """

    kind: Literal["machete"]
    teeth: Count
    wheel_teeth: Count
    inertia: Inertia
    radius: Length
    weight: MaybeMass = None
    drum: MaybeLength = None
    mass: MaybeMass = None
    centre: MaybeLength = None
    friction: MaybeTorque = None
    strike_angle: MaybeAngle = None


class GasGun(Launched):
    """[machine]: a gun whose projectile, [striker], flies at the object.

    Either its ``speed`` is known, or it follows, as an upper bound, from the reservoir (absolute ``pressure``,
    ``volume``), the barrel (diameter ``bore``, ``length``, ``friction`` in N), the ``ambient`` pressure (1 atm), the
    ``heat_ratio`` of the gas (1.4) and its ``sound_speed`` (343 m/s).
    """

    kind: Literal["gas-gun"]
    speed: MaybeSpeed = None
    pressure: MaybePressure = None
    volume: MaybeVolume = None
    bore: MaybeLength = None
    length: MaybeLength = None
    friction: MaybeFriction = None
    ambient: MaybeAmbient = None
    heat_ratio: MaybeHeatRatio = None
    sound_speed: MaybeSpeed = None


class BodyTable(Table):
    """[[machine.body]]: a body of the amplifier below the striker: restitution to the body above, and gap to it (0)."""

    name: Name
    mass: Mass
    restitution: Restitution
    gap: MaybeGap = None


class Amplifier(Launched):
    """[machine]: bodies that fall in a line on a floor and hit one another, each faster than the one below.

    From the floor up: the rows of [[machine.body]], [striker], [object]. ``restitution`` is that of the lowest body on
    the floor, ``gap`` that between striker and object (0); the restitution of those two is that of [contact].
    """

    kind: Literal["amplifier"]
    height: Length
    restitution: Restitution
    gap: MaybeGap = None
    friction: MaybeShare = None
    body: tuple[BodyTable, ...] = ()


AnyLaunched: TypeAlias = FallingBall | Drop | Pendulum | Machete | GasGun | Amplifier
KINDS = {str(table.model_fields["kind"].annotation.__args__[0]): table for table in (Machine, *get_args(AnyLaunched))}
"""Every machine that there is: its kind and its table."""
BAR_ALONE = "a bar is no machine: give [[stack.layer]] and [load], and `strikewave wave` runs it"


def _of_known_kind(raw: Any) -> Any:
    """Refuse a machine of no known kind."""
    if not isinstance(raw, dict) or raw.get("kind") in list(KINDS):
        return raw
    kind = raw.get("kind", MISSING)
    hint = BAR_ALONE if kind == "hopkinson" else "" if kind is MISSING else nearest(str(kind), KINDS)
    raise InputError("kind", kind, "one of " + ", ".join(f"'{known}'" for known in KINDS), hint)


AnyMachine = Annotated[Machine | AnyLaunched, Field(discriminator="kind"), BeforeValidator(_of_known_kind)]
"""[machine] of any kind."""
