"""Result of a run of LS-DYNA, alone or compared with a run of strikewave."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from strikewave.base import declare
from strikewave.base.declare import KEY
from strikewave.base.shock_quantities import FORCE, MICROSECONDS
from strikewave.exchange.ls_dyna.comparison import ForcePair, RunComparison
from strikewave.exchange.ls_dyna.folder import ContactPulse, EnergyHistory, Extreme, LsDynaContact, pulse_of
from strikewave.fem.run import EnergyExtent
from strikewave.reporting import measured_files as measured
from strikewave.reporting.shown_result import Curve, history_curve


@declare.dataclass
class ContactSide:
    """One side of a contact of LS-DYNA."""

    contact: LsDynaContact = declare.part(LsDynaContact, "the contact")
    side: str = declare.word("A or B", column=KEY, tables="contacts")
    pulse: ContactPulse | None = declare.part(ContactPulse, "what its force comes to; None where nothing touched")


@declare.dataclass
class LsDynaPart:
    """A part of LS-DYNA."""

    number: int = declare.count("number of the part")
    extreme: Extreme | None = declare.part(Extreme, "the most that it came to", inline=True, optional=True)


@declare.dataclass
class ReadRun:
    """Run of LS-DYNA as read from its files."""

    folder: str = declare.word("folder that was read")
    files: list[str] = declare.word("files that were read")
    span: tuple[float, float] = declare.history(MICROSECONDS, "first and last instant of anything")
    states: int = declare.count("instants of its fields", headline="states of d3plot")
    contacts: tuple[LsDynaContact, ...] = declare.rows(LsDynaContact, "its contacts")
    contact_count: int = declare.count("how many these are", headline="contacts", in_document=False)
    energy: dict[str, EnergyExtent] | None = declare.named(EnergyExtent, "its energies; null where no file has them")
    parts: dict[str, LsDynaPart] = declare.named(LsDynaPart, "its parts")


@declare.dataclass
class StrikewavePart:
    """A part of strikewave."""

    of: str | None = declare.word("part of LS-DYNA that it is compared with; null where there is none")
    extreme: Extreme = declare.part(Extreme, "the most that it came to", inline=True)


@declare.dataclass
class StrikewaveBeside:
    """The run of strikewave that LS-DYNA is compared with."""

    folder: str = declare.word("its folder")
    title: str = declare.word("title of its case")
    contacts: dict[str, ForcePair] = declare.named(ForcePair, "its contacts with their counterparts in LS-DYNA")
    energy: dict[str, EnergyExtent] = declare.named(EnergyExtent, "its energies, in the words of LS-DYNA")
    parts: dict[str, StrikewavePart] = declare.named(StrikewavePart, "its parts")


@declare.dataclass
class LsDynaResult(measured.AskedResult):
    """A run of LS-DYNA, alone or compared with one of strikewave; ``runs`` holds both and their differences."""

    command: ClassVar[str] = "ls-dyna"

    runs: RunComparison

    @property
    def main_rows(self) -> str:  # type: ignore[override]  # which they are is known of the result alone
        """The contacts of both runs where they are compared, else those of LS-DYNA."""
        return "pulses" if self.runs.strikewave is None else "pairs"

    @property
    def title(self) -> str:
        """Case of strikewave that it is compared with, or the name of its folder."""
        theirs, ours = self.runs.ls_dyna, self.runs.strikewave
        return f"LS-DYNA compared with strikewave: {ours.title}" if ours else f"LS-DYNA: {folder_name(theirs.folder)}"

    @declare.computed(declare.named(ForcePair, "strongest contact of both", headline="first", in_document=False))
    def strongest_pair(self) -> dict[str, ForcePair]:
        """The contact of the largest force in strikewave, of those that touch in both runs; none where none does."""
        peaks = {name: pair.strikewave.peak for name, pair in self.pairs.items() if pair.strikewave and pair.ls_dyna}
        most = max(peaks, key=peaks.__getitem__, default="")
        return {most: self.pairs[most]} if peaks else {}

    @declare.computed(declare.named(ContactPulse, "strongest contact", headline="first", in_document=False))
    def strongest_pulse(self) -> dict[str, ContactPulse]:
        """The contact of the largest force in LS-DYNA, where no pair is; none where nothing touched."""
        touched = {name: pulse for name, pulse in self.pulses.items() if pulse}
        most = max(touched, key=lambda name: touched[name].peak, default="")
        return {most: touched[most]} if touched and not self.strongest_pair else {}

    @declare.computed(declare.named(ContactPulse, "contacts of LS-DYNA", label="contact", in_document=False))
    def pulses(self) -> dict[str, ContactPulse | None]:
        """Peak and impulse of each contact of LS-DYNA."""
        return {contact.name: pulse_of(contact.first) for contact in self.runs.ls_dyna.contacts}

    @declare.computed(declare.named(ForcePair, "contacts of both runs", label="contact", in_document=False))
    def pairs(self) -> dict[str, ForcePair]:
        """The contacts of both runs."""
        return {pair.name: pair for pair in self.runs.forces}

    @declare.computed(declare.rows(ContactSide, "contacts of LS-DYNA", in_document=False))
    def sides(self) -> list[ContactSide]:
        """Each side of each contact of LS-DYNA."""
        contacts = self.runs.ls_dyna.contacts
        return [ContactSide(contact, side, pulse) for contact in contacts for side, pulse in contact.pulses.items()]

    @declare.computed(declare.part(ReadRun, "what was read of LS-DYNA", inline=True, headline="first"))
    def read(self) -> ReadRun:
        """Contents of the files of LS-DYNA."""
        theirs = self.runs.ls_dyna
        return ReadRun(
            folder=str(theirs.folder),
            files=[path.name for path in theirs.files],
            span=theirs.span,
            states=theirs.frames,
            contacts=theirs.contacts,
            contact_count=len(theirs.contacts),
            energy=_extents(theirs.energies),
            parts={name: LsDynaPart(number, theirs.extremes.get(name)) for name, number in theirs.parts.items()},
        )

    @declare.computed(declare.part(StrikewaveBeside, "the run of strikewave that it is compared with", optional=True))
    def comparison(self) -> StrikewaveBeside | None:
        """The run of strikewave that it is compared with; None where there is none."""
        ours, parts = self.runs.strikewave, self.runs.parts
        if ours is None:
            return None
        extremes = {name: StrikewavePart(parts.get(name), extreme) for name, extreme in ours.extremes.items()}
        return StrikewaveBeside(str(ours.folder), ours.title, self.pairs, _extents(ours.energies) or {}, extremes)

    def preview(self) -> Curve | None:
        """Return the force of the first contact in LS-DYNA."""
        if not self.runs.ls_dyna.contacts:
            return None
        contact = self.runs.ls_dyna.contacts[0]
        label = f"force of contact {contact.name}"
        return history_curve(contact.first.time, contact.first.size, *FORCE.units, label)

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"comparison.json": self.document_text(2)}


def folder_name(folder: Path) -> str:
    """Return the name of the run of a folder."""
    return folder.absolute().name or "run"


def _extents(balance: EnergyHistory | None) -> dict[str, EnergyExtent] | None:
    return None if balance is None else {name: EnergyExtent.of(values) for name, values in balance.energy.items()}
