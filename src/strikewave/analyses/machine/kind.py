"""Interface of a kind of machine: one class in a module of its own in the folder `kinds`.

The class is the table [machine] of the case file, and it has all that only this kind knows: how it comes to first
touch, its words, its sources, its drawing. Nothing else asks which kind a machine is. A module of the folder imports
at its head only what a table needs (see `strikewave.cases.tables.machine_kinds`); physics is imported in its methods.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple

from strikewave.base.declare import Quantity
from strikewave.base.errors import MISSING, InputError
from strikewave.base.result import Notice
from strikewave.cases.tables.machine import LaunchedTable, MachineTable

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.contact.law import AnyContact
    from strikewave.machines import Machine
    from strikewave.machines.amplifier import Collisions
    from strikewave.machines.launch import RigidPendulum
    from strikewave.reporting.parts import Picture


class PartNumber(NamedTuple):
    """A number of a part: what it is, the number with its unit, where it comes from."""

    name: str
    shown: str
    provenance: str


class PartEntry(NamedTuple):
    """A part: the name by which the drawing points at it, what it is called, its numbers."""

    place: str
    name: str
    entries: Sequence[PartNumber]


class Drawing(NamedTuple):
    """Drawing of a machine: pictures, and the numbered parts that they point at."""

    pictures: Sequence[Picture]
    parts: Sequence[PartEntry]


class MachineKind(MachineTable):
    """A kind of machine: its table, and what it says of itself.

    Attributes
    ----------
    description : str
        Description of the machine and its function, in two or three sentences.
    chain : tuple of str
        Bodies and links in the order in which a blow runs through them.
    settings : mapping of str to Quantity
        Main settings in the head of a result, by the field of the table; counts have no unit.
    sources : tuple of str
        Keys of `strikewave.base.citations`: what its way to first touch follows.
    reference_law : str
        Contact on a rigid object that the blows are compared with; see `rigid_contact`.
    """

    description: ClassVar[str]
    chain: ClassVar[tuple[str, ...]]
    settings: ClassVar[Mapping[str, Quantity]]
    sources: ClassVar[tuple[str, ...]] = ()
    reference_law: ClassVar[str]

    @abstractmethod
    def rigid_contact(self, case: Case, machine: Machine) -> tuple[AnyContact, float]:
        """Return the contact that is set beside the blows for comparison, and the mass behind the striker, kg."""

    def drawing(self, case: Case) -> Drawing | None:
        """Return the machine drawn with its numbers; None where it is not drawn."""
        return None


class Release(NamedTuple):
    """Approach of a machine to first touch, SI; speeds along the blow, at first touch.

    Attributes
    ----------
    energy : float
        Energy that weight or gas gave the moving parts on the way, less friction, J.
    travel : float
        Time from the release (of a gun: the muzzle, so 0) to first touch, s.
    striker, object : float
        Speeds, m/s.
    arm : float
        Speed of an arm, rad/s.
    pendulum : RigidPendulum or None
        The arm that carries the striker.
    gain : float or None
        Speed of the object over that of its fall, for a machine that makes it faster than it fell.
    line : Collisions or None
        The collisions on the way, and after it.
    bodies : tuple of str
        Names of the bodies that collide, from the bottom.
    notices : tuple of Notice
        Notices to the user about it.
    """

    energy: float
    travel: float = 0.0
    striker: float = 0.0
    object: float = 0.0
    arm: float = 0.0
    pendulum: RigidPendulum | None = None
    gain: float | None = None
    line: Collisions | None = None
    bodies: tuple[str, ...] = ()
    notices: tuple[Notice, ...] = ()


DROP_HEIGHT = Quantity("m", "m", "drop height")
FREE_OBJECT = ("contact", "nose", "frame", "assembly", "support, where there is one")
"""The end of the chain of a machine that strikes an object at rest."""


class LaunchedKind(LaunchedTable, MachineKind):
    """A kind of machine without a drive.

    Attributes
    ----------
    falls : {"nothing", "striker", "object", "both"}
        Bodies that gravity moves along the blow while it is followed. A striker falls with the blow; an object falls
        against it, on what strikes it; both fall alike, against the blow.
    mount : {"none", "optional", "needed"}
        Need of a mount that holds the striker: one that flies has none.
    """

    falls: ClassVar[Literal["nothing", "striker", "object", "both"]] = "nothing"
    mount: ClassVar[Literal["none", "optional", "needed"]] = "none"
    reference_law: ClassVar[str] = "the contact law of the case"

    @abstractmethod
    def release(self, case: Case, mass: float) -> Release:
        """Return how it comes to first touch with an object of so many kg."""

    def rigid_contact(self, case: Case, machine: Machine) -> tuple[AnyContact, float]:
        """Return the contact law of the case and the mass that strikes, of an arm the effective one."""
        striker, launch = machine.strikers.first, machine.launch
        arm = None if launch is None else launch.arm
        return striker.contact, striker.mass if arm is None else arm.inertia / arm.radius**2

    def inconsistencies(self, case: Case) -> Iterator[InputError]:
        """Yield an error for each value of the striker that this kind cannot have, or needs."""
        striker = case.impact().striker
        mount = striker.mount_stiffness
        if self.mount == "needed" and mount is None:
            yield InputError("striker.mount_stiffness", MISSING, "of the striker on its arm", 'such as "300 MN/m"')
        if self.mount == "none" and mount is not None:
            yield InputError("striker.mount_stiffness", mount.typed, f"none: the striker of a {self.kind} flies")
        if mount is None and striker.mount_damping is not None:
            allowed = "only with striker.mount_stiffness: without it there is no mount"
            yield InputError("striker.mount_damping", striker.mount_damping.typed, allowed, "remove it")


def kind_of(case: Case) -> MachineKind:
    """Return the machine of a case as its kind.

    Examples
    --------
    >>> from strikewave import load_case
    >>> kind_of(load_case("jesd22-b111-b")).sources
    ('jesd22-b104',)
    """
    machine = case.machine
    if not isinstance(machine, MachineKind):
        raise InputError("machine", MISSING, "[machine] with its tables")
    return machine
