"""What a run of LS-DYNA gave, alone or beside a run of ours: JSON document and source."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from strikewave.exchange.ls_dyna.comparison import ForcePair, RunComparison
from strikewave.exchange.ls_dyna.folder import ContactPulse, EnergyHistory, Extreme, LsDynaContact, pulse_of
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import Column
from strikewave.reporting.numbers import percent, with_unit
from strikewave.reporting.shown_result import Curve, columns_of, history_curve

UNITS = {
    "peak": "N", "at": "s", "impulse": "N s", "begin": "s", "end": "s", "width": "s", "span": "s", "shift": "s",
    "angle": "deg", "peak_difference": "1", "impulse_difference": "1", "width_difference": "1",
    "magnitude": "1", "phase": "1", "combined": "1", "rms": "1", "displacement": "m", "von_mises": "Pa",
    "plastic_strain": "1", "largest": "J", "last": "J",
}  # fmt: skip
"""Of the JSON document."""


@dataclass(frozen=True)
class LsDynaResult(measured.AskedResult):
    """A run of LS-DYNA, alone or beside one of ours; see `Result` for what it shares with others.

    Attributes
    ----------
    found : RunComparison
        Both runs, and what they differ in.
    """

    command: ClassVar[str] = "ls-dyna"

    found: RunComparison

    @property
    def title(self) -> str:
        """The case of ours that it is laid beside, or the name of its folder."""
        theirs, ours = self.found.ls_dyna, self.found.strikewave
        return f"LS-DYNA compared with strikewave: {ours.title}" if ours else f"LS-DYNA: {folder_name(theirs.folder)}"

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        return UNITS

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        comparison, theirs, ours = self.found, self.found.ls_dyna, self.found.strikewave
        parts = {name: {"number": n, **_extreme(theirs.extremes.get(name))} for name, n in theirs.parts.items()}
        content = {
            "folder": str(theirs.folder),
            "files": [path.name for path in theirs.files],
            "span": theirs.span,
            "states": theirs.frames,
            "contacts": [_contact(contact) for contact in theirs.contacts],
            "energy": _energies(theirs.energies),
            "parts": parts,
        }
        if ours is not None:
            content["comparison"] = {
                "folder": str(ours.folder),
                "title": ours.title,
                "contacts": {pair.name: _pair(pair) for pair in comparison.forces},
                "energy": _energies(ours.energies),
                "parts": {
                    name: {"of": comparison.parts.get(name), **_extreme(one)} for name, one in ours.extremes.items()
                },
            }
        return content

    def highlights(self) -> list[tuple[str, str]]:
        """Return the largest force of the first contact in LS-DYNA, and its difference from ours where there is one."""
        pulses = [(contact.name, pulse_of(contact.first)) for contact in self.found.ls_dyna.contacts]
        numbers = [("contacts", str(len(pulses)))]
        for name, pulse in pulses[:1]:
            peak = None if pulse is None else pulse.peak
            numbers.append((f"peak of contact {name}", with_unit(peak, "N", "kN")))
        for pair in self.found.forces[:1]:
            numbers.append((f"difference of {pair.name}", percent(pair.difference("peak"), 1, "+")))
        return numbers

    def columns(self) -> list[Column]:
        """Return the contacts of both runs where they are compared, else those of LS-DYNA."""
        if self.found.strikewave is not None:
            rows = [{"name": pair.name, **_pair(pair)} for pair in self.found.forces]
        else:
            contacts = self.found.ls_dyna.contacts
            rows = [{"name": contact.name, **(_pulse(pulse_of(contact.first)) or {})} for contact in contacts]
        return columns_of(rows, UNITS)

    def brief(self) -> dict[str, str]:
        """Return the peaks of both runs and their difference, or the pulses of LS-DYNA."""
        if self.found.strikewave is not None:
            return {"name": "", "strikewave.peak": "kN", "ls_dyna.peak": "kN", "peak_difference": "1"}
        return {"name": "", "peak": "kN", "width": "us", "impulse": "N s"}

    def preview(self) -> Curve | None:
        """Return the force of the first contact in LS-DYNA."""
        for contact in self.found.ls_dyna.contacts[:1]:
            return history_curve(contact.first.time, contact.first.size, "N", "kN", f"force of contact {contact.name}")
        return None

    def texts(self) -> dict[str, str]:
        """Return the JSON document as a file."""
        return {"comparison.json": self.document_text(2)}


def folder_name(folder: Path) -> str:
    """Return what the run of a folder is called."""
    return folder.absolute().name or "run"


def _contact(contact: LsDynaContact) -> dict[str, Any]:
    sides = {side: _pulse(pulse_of(force)) for side, force in sorted(contact.sides.items())}
    return {"number": contact.number, "title": contact.title, "sides": sides}


def _pulse(pulse: ContactPulse | None) -> dict[str, float] | None:
    return None if pulse is None else {**dataclasses.asdict(pulse), "width": pulse.width}


def _pair(pair: ForcePair) -> dict[str, Any]:
    agreements = {"as_they_are": pair.plain, "begun_together": pair.moved}
    return {
        "number": pair.contact.number,
        "side": pair.side,
        "ls_dyna": _pulse(pair.ls_dyna),
        "strikewave": _pulse(pair.strikewave),
        **{f"{what}_difference": pair.difference(what) for what in ("peak", "impulse", "width")},
        "shift": pair.shift,
        "angle": pair.angle,
        **{name: {**dataclasses.asdict(one), "combined": one.combined} for name, one in agreements.items()},
    }


def _energies(balance: EnergyHistory | None) -> dict[str, dict[str, float]] | None:
    if balance is None:
        return None
    return {name: {"largest": float(v[abs(v).argmax()]), "last": float(v[-1])} for name, v in balance.energy.items()}


def _extreme(one: Extreme | None) -> dict[str, float]:
    return {} if one is None else dataclasses.asdict(one)
