"""A drop table: the table falls with the object on an anvil."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal

from strikewave.analyses.machine.kind import LaunchedKind, Release, Setting
from strikewave.base.quantities import Length, MaybeShare

if TYPE_CHECKING:
    from strikewave.cases.case import Case


class Drop(LaunchedKind):
    """[machine]: a table that falls with the object on an anvil; [contact] is the pulse shaper between them.

    [object] is the table with what it carries, [striker] the anvil, on its mount to the ground or free to move.
    ``friction`` is that of the guides as a share of the weight (0).
    """

    kind: Literal["drop"]
    height: Length
    friction: MaybeShare = None

    description: ClassVar[str] = (
        "A drop table: it falls with what it carries on an anvil; the pulse shaper between them is the contact. "
        "The object is the table with its load, and the blow goes upwards. The run begins just before first touch."
    )
    chain: ClassVar[tuple[str, ...]] = (
        *("ground", "mount of the anvil, where there is one", "anvil", "pulse shaper"),
        *("nose", "frame", "assembly"),
    )
    settings: ClassVar[tuple[Setting, ...]] = (Setting("height", "m", "m", "drop height"),)
    sources: ClassVar[tuple[str, ...]] = ("jesd22-b104",)
    falls: ClassVar = "object"
    mount: ClassVar = "optional"

    def release(self, case: Case, mass: float) -> Release:
        """Return a table at v = sqrt(2 g (1 - friction) h), downwards."""
        from strikewave.analyses.machine.falling import fall

        speed, travel, energy = fall(self.height, self.friction, mass)
        return Release(energy, travel, object=-speed)
