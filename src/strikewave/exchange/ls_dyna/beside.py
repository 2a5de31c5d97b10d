"""A run of LS-DYNA beside one of ours: forces, energies, fields, and how far they are apart; SI.

Of ours it reads what `strikewave fem` wrote: ``histories.nc`` and, where it is there, ``field.vtkhdf``.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, nearest
from strikewave.base.result import Notice
from strikewave.exchange.ls_dyna.agreement import Agreement, agreement
from strikewave.exchange.ls_dyna.ascii import Array
from strikewave.exchange.ls_dyna.folder import Contact, Extreme, Force, Ledger, LsDynaRun, Pulse, pulse_of, widened
from strikewave.fem.run import KEPT
from strikewave.fem.vtkhdf import stored_frames

LARGEST_FILE = 4 << 30
"""Bytes of histories."""
FACTOR = 2.0
"""A ratio within this factor of 1000, 1e6 ... is taken for a slip of units."""
SECTOR = 0.1
"""A ratio within this share of 2 or 4 is taken for sectors that differ."""
SHIFT = 0.02
"""Share of our width by which a pulse may begin earlier or later without a word."""
ASIDE = 10.0
"""Angle between the impulses of both that is worth a word, degrees."""
LATER = re.compile(r"histories-\d+\.nc")
"""Histories of the second blow and on."""
_SIZES = ("peak", "impulse")


@dataclass(frozen=True)
class OurRun:
    """What a result of ours holds.

    Attributes
    ----------
    folder : Path
    title : str
        Of its case.
    forces : mapping of str to Force
        Mean contact forces of the intervals, on the first of the two surfaces, by contact.
    ledger : Ledger
        ``internal`` is with the work of bulk viscosity, for which LS-DYNA has no line of its own.
    extremes : mapping of str to Extreme
        By part, over the frames of ``field.vtkhdf``; empty without it.
    blows : int
        That the folder holds; only the first is read.
    """

    folder: Path
    title: str
    forces: Mapping[str, Force]
    ledger: Ledger
    extremes: Mapping[str, Extreme]
    blows: int = 1


@dataclass(frozen=True)
class ForcePair:
    """A contact of ours and one of LS-DYNA.

    Attributes
    ----------
    name : str
        Of ours.
    contact : Contact
    side : str
        That of LS-DYNA whose impulse points as ours on the first surface does.
    ours, theirs : Pulse or None
        None where nothing touched.
    curves : tuple of Force
        Ours, theirs.
    angle : float
        Between both impulses, degrees; NaN without them.
    plain, moved : Agreement
        Of the sizes over both pulses: as they are, and with theirs moved so that both begin at once.
    """

    name: str
    contact: Contact
    side: str
    ours: Pulse | None
    theirs: Pulse | None
    curves: tuple[Force, Force]
    angle: float
    plain: Agreement
    moved: Agreement

    @property
    def shift(self) -> float:
        """How much later theirs begins, s; NaN where one did not touch."""
        return self.theirs.begin - self.ours.begin if self.ours and self.theirs else math.nan

    def difference(self, what: str) -> float:
        """Return (theirs - ours) / ours of ``peak``, ``impulse`` or ``width``."""
        if self.ours is None or self.theirs is None:
            return math.nan
        return relative(getattr(self.theirs, what), getattr(self.ours, what))


@dataclass(frozen=True)
class Beside:
    """Both runs, side by side.

    Attributes
    ----------
    theirs : LsDynaRun
    ours : OurRun or None
        None where there is nothing to lay beside.
    forces : tuple of ForcePair
    parts : mapping of str to str
        Their part by ours.
    warnings : tuple of Notice
    """

    theirs: LsDynaRun
    ours: OurRun | None = None
    forces: tuple[ForcePair, ...] = ()
    parts: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[Notice, ...] = ()


def read_ours(folder: Path) -> OurRun:
    """Return what a folder that `strikewave fem` wrote holds.

    Raises
    ------
    InputError
        If there is no such result, or a file is damaged.
    """
    path = folder / "histories.nc"
    if not path.is_file() or path.stat().st_size > LARGEST_FILE:
        raise InputError("--compare", str(folder), "a folder that strikewave fem wrote, with histories.nc")
    try:
        import xarray

        with xarray.open_dataset(path, engine="h5netcdf") as held:
            forces, ledger = _our_forces(held), _our_ledger(held)
            title = tomllib.loads(str(held.attrs["case"])).get("title", folder.name)
        blows = 1 + sum(LATER.fullmatch(one.name) is not None for one in folder.iterdir())
    except (OSError, KeyError, ValueError, TypeError, RuntimeError, AttributeError, MemoryError) as error:
        raise InputError("--compare", str(path), "histories as strikewave fem writes them", str(error)[:200]) from None
    return OurRun(folder, str(title), forces, ledger, _our_extremes(folder / "field.vtkhdf"), blows)


def lay_beside(
    theirs: LsDynaRun, ours: OurRun, contacts: Mapping[str, int] | None = None, parts: Mapping[str, int] | None = None
) -> Beside:
    """Lay a run of LS-DYNA beside one of ours.

    Parameters
    ----------
    theirs, ours
        Both runs.
    contacts, parts : mapping of str to int, optional
        Number in LS-DYNA by our name. Others go together by their names, or where there is one of each.

    Raises
    ------
    InputError
        If a name or number is not there.
    """
    numbers = {contact.name: contact.number for contact in theirs.contacts}
    titles = {contact.name: contact.title for contact in theirs.contacts}
    matched = _matched("--contact", list(ours.forces), numbers, titles, contacts or {})
    named = {contact.name: contact for contact in theirs.contacts}
    pairs = tuple(force_pair(name, ours.forces[name], named[other]) for name, other in matched.items())
    numbers = theirs.parts
    twins = _matched("--part", list(ours.extremes), numbers, {name: name for name in numbers}, parts or {})
    found = Beside(theirs, ours, pairs, twins)
    return Beside(theirs, ours, pairs, twins, tuple(_notices(found)))


def force_pair(name: str, ours: Force, contact: Contact) -> ForcePair:
    """Lay a contact force of LS-DYNA beside ours: on the side whose impulse points as ours does."""
    side = max(sorted(contact.sides), key=lambda key: float(contact.sides[key].gathered @ ours.gathered))
    theirs = contact.sides[side]
    a, b = pulse_of(ours), pulse_of(theirs)
    if a is None or b is None:
        nothing = Agreement(math.nan, math.nan, math.nan)
        return ForcePair(name, contact, side, a, b, (ours, theirs), math.nan, nothing, nothing)
    shift = b.begin - a.begin
    reference = ours.time, ours.size
    plain = agreement(reference, (theirs.time, theirs.size), (min(a.begin, b.begin), max(a.end, b.end)))
    moved = agreement(reference, (theirs.time - shift, theirs.size), (a.begin, max(a.end, b.end - shift)))
    return ForcePair(name, contact, side, a, b, (ours, theirs), _angle(ours.gathered, theirs.gathered), plain, moved)


def relative(value: float, reference: float) -> float:
    """Return (value - reference) / reference; NaN where the reference is 0."""
    return (value - reference) / reference if reference else math.nan


def slip(ratio: float) -> float | None:
    """Return the power of 1000 that a ratio is near to, as where units are mistaken; None where it is near 1.

    Examples
    --------
    >>> slip(1.02e6), slip(0.9e-3), slip(1.3), slip(30.0)
    (1000000.0, 0.001, None, None)
    """
    if not 0.0 < ratio < math.inf:
        return None
    power = round(math.log10(ratio) / 3.0)
    near = abs(math.log10(ratio) - 3.0 * power) < math.log10(FACTOR)
    return float(f"1e{3 * power}") if power and near else None


def _matched(
    option: str, ours: Sequence[str], numbers: Mapping[str, int], titles: Mapping[str, str], asked: Mapping[str, int]
) -> dict[str, str]:
    """Return the name of theirs by ours: as asked, else of the same title, else the only one of each.

    Where none of theirs has a title, and none was asked for, they are those of our deck, which numbers from 1 on.
    """
    by_number = {number: name for name, number in numbers.items()}
    found = {}
    for name, number in asked.items():
        if name not in ours:
            raise InputError(
                option, name, "a name of ours: " + (", ".join(ours) or "there is none"), nearest(name, ours)
            )
        if number not in by_number:
            listed = ", ".join(map(str, sorted(by_number))) or "there is none"
            raise InputError(option, number, f"a number of LS-DYNA: {listed}")
        found[name] = by_number[number]
    for name in ours:
        same = [other for other, title in titles.items() if title.casefold() == name.casefold()]
        if name not in found and len(same) == 1 and same[0] not in found.values():
            found[name] = same[0]
    if not found and not any(titles.values()):
        found = {name: by_number[number] for number, name in enumerate(ours, start=1) if number in by_number}
    if len(ours) == len(numbers) == 1 and not found:
        found[ours[0]] = next(iter(numbers))
    return found


def _our_forces(held: Any) -> dict[str, Force]:
    time = np.asarray(held["interval"].values, float)
    found = {}
    for key in held.data_vars:
        name = str(key)
        if name.startswith("contact.") and name.endswith(".mean_force"):
            own = name.removesuffix(".mean_force")
            impulse = np.asarray(held[f"{own}.impulse"].values, float)[-1]
            found[own.removeprefix("contact.")] = Force(time, np.asarray(held[key].values, float), impulse)
    if time.ndim != 1 or any(force.force.shape != (time.size, 3) for force in found.values()):
        raise ValueError("its contact forces are not three components over the intervals")
    return found


def _our_ledger(held: Any) -> Ledger:
    """Return our energies in LS-DYNA's words: bulk viscosity is part of ``internal``."""
    energy = {name: np.asarray(held[f"energy.{name}"].values, float) for name in (*KEPT, "external")}
    total = np.sum([energy[name] for name in KEPT], axis=0)
    internal = energy["internal"] + energy.pop("viscous")
    return Ledger(np.asarray(held["time"].values, float), {**energy, "internal": internal, "total": total})


def _our_extremes(path: Path) -> dict[str, Extreme]:
    if not path.is_file():
        return {}
    parts = _our_parts(path)
    found: dict[str, Extreme] = {}
    for frame in stored_frames(path):
        found = widened(found, frame, parts)
    return found


def _our_parts(path: Path) -> dict[str, tuple[NDArray[Any], slice]]:
    """Return nodes and elements of each part of a field."""
    import importlib

    h5py: Any = importlib.import_module("h5py")  # it has no types
    next(stored_frames(path), None)  # refuses what is damaged
    try:
        with h5py.File(path, "r") as file:
            grid = file["VTKHDF"]
            part = grid["CellData/part"][: len(grid["Types"])]
            names = [str(name) for name in grid["CellData/part"].attrs["names"]]
            cells = grid["Connectivity"][:].reshape(-1, 8)
            points = len(grid["Points"])
    except (OSError, KeyError, ValueError, TypeError, RuntimeError) as error:
        raise InputError("--compare", str(path), "fields as strikewave writes them", str(error)[:200]) from None
    ordered = len(part) == len(cells) and np.all(np.diff(part) >= 0) and len(cells)
    if not ordered or part[0] < 0 or part[-1] >= len(names) or cells.min() < 0 or cells.max() >= points:
        raise InputError(
            "--compare", str(path), "fields as strikewave writes them", "its parts do not fit its elements"
        )
    bounds = np.searchsorted(part, np.arange(len(names) + 1))
    elements = {name: slice(int(bounds[k]), int(bounds[k + 1])) for k, name in enumerate(names)}
    return {name: (np.unique(cells[own]), own) for name, own in elements.items() if own.stop > own.start}


def _angle(a: Array, b: Array) -> float:
    """Return the angle between two vectors, degrees; NaN where one is 0."""
    sizes = float(np.linalg.norm(a) * np.linalg.norm(b))
    return math.degrees(math.acos(min(1.0, max(-1.0, float(a @ b) / sizes)))) if sizes else math.nan


def _notices(beside: Beside) -> Iterator[Notice]:
    """Yield what to know before the numbers are believed."""
    ours, theirs = beside.ours, beside.theirs
    assert ours is not None
    if ours.blows > 1:
        words = f"our run has {ours.blows} blows: the first alone is laid beside LS-DYNA's"
        yield Notice("blows", words, float(ours.blows), 1.0)
    paired = {pair.name for pair in beside.forces}
    for name in (name for name in ours.forces if name not in paired):
        free = ", ".join(contact.name for contact in theirs.contacts) or "none"
        words = f"our contact {name} stands alone; LS-DYNA has: {free}; --contact {name}=NUMBER lays one beside it"
        yield Notice("contact-unpaired", words, math.nan, math.nan)
    for name in (name for name in ours.extremes if theirs.fields and name not in beside.parts):
        free = ", ".join(f"{number} {title}" for title, number in theirs.parts.items())
        words = f"our part {name} stands alone; LS-DYNA has: {free}; --part {name}=NUMBER lays one beside it"
        yield Notice("part-unpaired", words, math.nan, math.nan)
    off = _slips(beside, ours)
    if off:
        told = ", ".join(f"{what} {factor:g}" for what, factor in off.items())
        words = f"LS-DYNA over ours is near a factor of 1000 or a power of it ({told}): is --units right?"
        yield Notice("units", words, next(iter(off.values())), 1.0)
    for pair in beside.forces:
        yield from _pair_notices(pair, bool(off))


def _slips(beside: Beside, ours: OurRun) -> dict[str, float]:
    """Return powers of 1000 between LS-DYNA's numbers and ours, by what they are of."""
    both: dict[str, tuple[float, float]] = {}
    for pair in beside.forces:
        if pair.ours and pair.theirs:
            for what in ("peak", "impulse", "width"):
                both[f"{what} of {pair.name}"] = getattr(pair.theirs, what), getattr(pair.ours, what)
    if beside.theirs.ledger and "total" in beside.theirs.ledger.energy:
        totals = (one.energy["total"] for one in (beside.theirs.ledger, ours.ledger))
        theirs, own = (float(np.nan_to_num(np.abs(total)).max(initial=0.0)) for total in totals)
        both["total energy"] = theirs, own
    for name, other in beside.parts.items():
        for what in ("displacement", "von_mises"):
            extremes = beside.theirs.extremes.get(other), ours.extremes[name]
            if extremes[0]:
                both[f"{what.replace('_', ' ')} of {name}"] = getattr(extremes[0], what), getattr(extremes[1], what)
    found = {what: slip(a / b) for what, (a, b) in both.items() if b}
    return {what: factor for what, factor in found.items() if factor}


def _pair_notices(pair: ForcePair, slipped: bool) -> Iterator[Notice]:
    a, b = pair.ours, pair.theirs
    if a is None or b is None:
        who = " nor ".join(name for name, one in (("ours", a), ("LS-DYNA's", b)) if one is None)
        yield Notice("no-contact", f"contact {pair.name}: nothing touches in {who}", 0.0, math.nan)
        return
    if slipped:
        return
    for many in (0.25, 0.5, 2.0, 4.0):
        if all(abs(getattr(b, what) / many - getattr(a, what)) < SECTOR * getattr(a, what) for what in _SIZES):
            words = f"contact {pair.name}: LS-DYNA's force is about {many:g} times ours: is one of them a sector?"
            yield Notice("sector", words, b.peak / a.peak, many)
    if abs(pair.shift) > SHIFT * a.width:
        later = "later" if pair.shift > 0.0 else "earlier"
        words = f"contact {pair.name}: LS-DYNA's pulse begins {abs(pair.shift) * 1e6:.4g} us {later} than ours"
        yield Notice("time-shift", words, pair.shift, SHIFT * a.width)
    if pair.angle > ASIDE:
        words = f"contact {pair.name}: the impulses are {pair.angle:.3g} degrees apart: are both the same contact?"
        yield Notice("direction", words, pair.angle, ASIDE)
