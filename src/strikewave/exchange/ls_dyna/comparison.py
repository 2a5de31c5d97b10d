"""A run of LS-DYNA compared with one of strikewave: forces, energies, fields, and their differences; SI.

Of strikewave it reads what `strikewave fem` wrote: ``histories.nc`` and, where it is there, ``field.vtkhdf``. Where a
sector of the bodies is meshed both runs are compared as meshed: the deck holds that sector alone.

How far one curve is from another: differences of size, of phase, and over the pulse.

Source: Sprague, M. A. & Geers, T. L. (2003), "Spectral elements and field separation for an acoustic fluid subject to
cavitation", J. Comput. Phys. 184, 149-162: M and P as below, C their root of squares.
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

from strikewave.base import declare
from strikewave.base.declare import MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.errors import InputError, nearest
from strikewave.base.result import Notice
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.exchange.ls_dyna.folder import (
    ContactPulse,
    EnergyHistory,
    Extreme,
    Force,
    LsDynaContact,
    LsDynaRun,
    pulse_of,
    widened,
)
from strikewave.exchange.ls_dyna.histories import LARGEST_FILE, Array
from strikewave.fem.run import KEPT
from strikewave.fem.vtkhdf import LONGEST_HINT, stored_frames

SAMPLES = 4096
"""Instants of a curve that are compared, at most: an integral over a pulse is then known to 1e-6."""


@declare.dataclass
class Agreement:
    """A curve against a reference over a window of time; r is the reference, c the curve."""

    magnitude: float = declare.number(
        Quantity(NO_UNIT, "%", "M", 2, 0, signed=True),
        "M = sqrt(integral of c^2 / integral of r^2) - 1",
        column=MORE + 1,
        tables="pair",
    )
    phase: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, "P", digits=3),
        "P = arccos(integral of c r / sqrt(integral of c^2 times integral of r^2)) / pi, from 0 to 1",
        column=MORE + 1,
        tables="pair",
    )
    rms: float = declare.number(
        Quantity(NO_UNIT, "%", "RMS", 2, 0),
        "root of the mean square difference over the largest reference",
        column=MORE + 1,
        tables="pair",
    )

    @declare.computed(
        declare.number(Quantity(NO_UNIT, NO_UNIT, "C", digits=3), "C = sqrt(M^2 + P^2)", column=MORE + 1, tables="pair")
    )
    def combined(self) -> float:
        """Magnitude and phase in one."""
        return math.hypot(self.magnitude, self.phase)


def agreement(reference: tuple[Array, Array], curve: tuple[Array, Array], window: tuple[float, float]) -> Agreement:
    """Compare a curve with a reference, each time (s) and values; straight lines between instants, 0 beyond them.

    Parameters
    ----------
    reference, curve : tuple of array (instants,)
        Times rise.
    window : tuple of float
        First and last instant, s.

    Returns
    -------
    Agreement
        NaN where one of them is 0 throughout.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 2001)
    >>> errors = agreement((t, np.sin(np.pi * t)), (t, 1.1 * np.sin(np.pi * t)), (0.0, 1.0))
    >>> round(errors.magnitude, 6), round(errors.phase, 6), round(errors.rms, 4)
    (0.1, 0.0, 0.0707)
    """
    t = instants(reference[0], curve[0], window)
    r, c = (np.interp(t, time, values, left=0.0, right=0.0) for time, values in (reference, curve))
    rr, cc, rc, off = (float(np.trapezoid(product, t)) for product in (r * r, c * c, r * c, (c - r) ** 2))
    if not (rr > 0.0 and cc > 0.0):
        return Agreement(math.nan, math.nan, math.nan)
    cosine = min(1.0, max(-1.0, rc / math.sqrt(rr * cc)))
    rms = math.sqrt(off / (t[-1] - t[0])) / float(np.abs(r).max())
    return Agreement(math.sqrt(cc / rr) - 1.0, math.acos(cosine) / math.pi, rms)


def instants(first: Array, second: Array, window: tuple[float, float]) -> Array:
    """Return the instants of two curves within a window and its ends, thinned to at most twice `SAMPLES`, rising."""
    inside = [time[(time > window[0]) & (time < window[1])] for time in (first, second)]
    thinned = [time[:: max(1, -(-len(time) // SAMPLES))] for time in inside]
    return np.unique(np.concatenate([*thinned, window]))


FACTOR = 2.0
"""A ratio within this factor of 1000, 1e6 ... is taken for a slip of units: no two codes differ by 500 otherwise."""
SECTOR = 0.1
"""A ratio within this share of 2 or 4 is taken for sectors that differ: forces of both codes agree to some per cent."""
SHIFT = 0.02
"""Share of the width by which a pulse may begin earlier or later without a warning: it moves no comparison of
curves."""
ASIDE = 10.0
"""Angle between the impulses from which on there is a warning, degrees: the force along one is then 1.5 % of less."""
LATER = re.compile(r"histories-\d+\.nc")
"""Histories of the second blow and on."""
_SIZES = ("peak", "impulse")
"""Quantities that grow with a sector; a width does not."""
DIFFERENCE = Quantity(NO_UNIT, "%", decimals=2, digits=0, signed=True)
SECTORS = (0.25, 0.5, 2.0, 4.0)
"""Ratios between a quarter, a half and a whole."""


@dataclass(frozen=True)
class StrikewaveRun:
    """A run of strikewave, as its result folder has it.

    Attributes
    ----------
    folder : Path
    title : str
        Title of its case.
    forces : mapping of str to Force
        Mean contact forces of the intervals, on the first of the two surfaces, by contact.
    energies : EnergyHistory
        ``internal`` is with the work of bulk viscosity, for which LS-DYNA has no line of its own.
    extremes : mapping of str to Extreme
        Extremes by part, over the frames of ``field.vtkhdf``; empty without it.
    blows : int
        Number of blows in the folder; only the first is read.
    as_meshed : bool
        Forces and energies are those of meshed sectors, whole bodies have more.
    """

    folder: Path
    title: str
    forces: Mapping[str, Force]
    energies: EnergyHistory
    extremes: Mapping[str, Extreme]
    blows: int = 1
    as_meshed: bool = False


@declare.dataclass
class PulseDifferences:
    """(LS-DYNA - strikewave) / strikewave of a pulse; NaN where nothing touched in one of them."""

    peak: float = declare.number(DIFFERENCE, "of the peaks", key="peak_difference", headline="peak", column=MAIN)
    impulse: float = declare.number(
        DIFFERENCE, "of the impulses", key="impulse_difference", headline="impulse", column=MORE
    )
    width: float = declare.number(
        DIFFERENCE, "of the widths", key="width_difference", headline="pulse width", column=MORE
    )


@declare.dataclass
class ForcePair:
    """A contact of strikewave and its counterpart in LS-DYNA.

    Beside what documents have:

    Attributes
    ----------
    name : str
        In strikewave.
    contact : LsDynaContact
        In LS-DYNA.
    curves : tuple of Force
        strikewave, LS-DYNA.
    """

    name: str
    contact: LsDynaContact
    curves: tuple[Force, Force]
    number: int = declare.count("number of the contact in LS-DYNA")
    side: str = declare.word("that of LS-DYNA whose impulse points as that on the first surface in strikewave")
    ls_dyna: ContactPulse | None = declare.part(
        ContactPulse, "pulse of LS-DYNA; null where nothing touched", label="LS-DYNA"
    )
    strikewave: ContactPulse | None = declare.part(
        ContactPulse, "pulse of strikewave; null where nothing touched", label="strikewave"
    )
    differences: PulseDifferences = declare.part(
        PulseDifferences, "(LS-DYNA - strikewave) / strikewave", inline=True, label="difference"
    )
    shift: float = declare.number(
        MICROSECONDS,
        "how much later the pulse of LS-DYNA begins; null where one run has no contact",
        label="onset later by",
        column=MORE + 1,
        tables="pair",
    )
    angle: float = declare.number(
        Quantity("deg", "deg", "angle of the impulses", digits=3),
        "between both impulses; null alike",
        column=MORE + 1,
        tables="pair",
    )
    plain: Agreement = declare.part(
        Agreement, "of the sizes over both pulses, as they are", key="as_they_are", label="as they are"
    )
    moved: Agreement = declare.part(
        Agreement,
        "the same with LS-DYNA's moved so that both begin at once",
        key="begun_together",
        label="onsets aligned",
    )


@dataclass(frozen=True)
class RunComparison:
    """A run of LS-DYNA and, where there is one, the run of strikewave that it is compared with.

    Attributes
    ----------
    ls_dyna : LsDynaRun
    strikewave : StrikewaveRun or None
        None where there is nothing to compare with.
    forces : tuple of ForcePair
    parts : mapping of str to str
        Part of LS-DYNA by part of strikewave.
    warnings : tuple of Notice
    """

    ls_dyna: LsDynaRun
    strikewave: StrikewaveRun | None = None
    forces: tuple[ForcePair, ...] = ()
    parts: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[Notice, ...] = ()


def read_strikewave(folder: Path) -> StrikewaveRun:
    """Return what a folder that `strikewave fem` wrote holds."""
    path = folder / "histories.nc"
    if not path.is_file() or path.stat().st_size > LARGEST_FILE:
        raise InputError("--compare", folder, "a folder that strikewave fem wrote, with histories.nc")
    try:
        import xarray

        with xarray.open_dataset(path, engine="h5netcdf") as dataset:
            as_meshed = "model_energy.kinetic" in dataset
            meshed = "model_" if as_meshed else ""
            forces, energies = _forces(dataset, meshed), _energies(dataset, meshed)
            title = tomllib.loads(str(dataset.attrs["case"])).get("title", folder.name)
        blows = 1 + sum(LATER.fullmatch(file.name) is not None for file in folder.iterdir())
    except (OSError, KeyError, ValueError, TypeError, RuntimeError, AttributeError, MemoryError) as error:
        hint = str(error)[:LONGEST_HINT]
        raise InputError("--compare", path, "histories as strikewave fem writes them", hint) from None
    return StrikewaveRun(folder, str(title), forces, energies, _extremes(folder / "field.vtkhdf"), blows, as_meshed)


def compare_runs(
    ls_dyna: LsDynaRun,
    strikewave: StrikewaveRun,
    contacts: Mapping[str, int] | None = None,
    parts: Mapping[str, int] | None = None,
) -> RunComparison:
    """Compare a run of LS-DYNA with one of strikewave.

    Parameters
    ----------
    ls_dyna, strikewave
        Both runs.
    contacts, parts : mapping of str to int, optional
        Number in LS-DYNA by name in strikewave. Others are paired by name, or where there is one of each.
    """
    numbers = {contact.name: contact.number for contact in ls_dyna.contacts}
    titles = {contact.name: contact.title for contact in ls_dyna.contacts}
    matched = _matched("--contact", list(strikewave.forces), numbers, titles, contacts or {})
    named = {contact.name: contact for contact in ls_dyna.contacts}
    pairs = tuple(force_pair(name, strikewave.forces[name], named[other]) for name, other in matched.items())
    numbers = ls_dyna.parts
    twins = _matched("--part", list(strikewave.extremes), numbers, {name: name for name in numbers}, parts or {})
    compared = RunComparison(ls_dyna, strikewave, pairs, twins)
    return RunComparison(ls_dyna, strikewave, pairs, twins, tuple(_notices(compared)))


def force_pair(name: str, strikewave: Force, contact: LsDynaContact) -> ForcePair:
    """Pair a contact force with that of LS-DYNA on the side whose impulse points the same way."""
    side = max(sorted(contact.sides), key=lambda key: float(contact.sides[key].gathered @ strikewave.gathered))
    ls_dyna = contact.sides[side]
    a, b = pulse_of(strikewave), pulse_of(ls_dyna)
    off, shift, angle = PulseDifferences(math.nan, math.nan, math.nan), math.nan, math.nan
    plain = moved = Agreement(math.nan, math.nan, math.nan)
    if a is not None and b is not None:
        off = PulseDifferences(*(relative(getattr(b, what), getattr(a, what)) for what in ("peak", "impulse", "width")))
        shift, angle = b.begin - a.begin, _angle(strikewave.gathered, ls_dyna.gathered)
        reference = strikewave.time, strikewave.size
        plain = agreement(reference, (ls_dyna.time, ls_dyna.size), (min(a.begin, b.begin), max(a.end, b.end)))
        moved = agreement(reference, (ls_dyna.time - shift, ls_dyna.size), (a.begin, max(a.end, b.end - shift)))
    return ForcePair(
        name, contact, (strikewave, ls_dyna), contact.number, side, b, a, off, shift, angle,
        plain, moved,
    )  # fmt: skip


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
    option: str,
    strikewave: Sequence[str],
    numbers: Mapping[str, int],
    titles: Mapping[str, str],
    stated: Mapping[str, int],
) -> dict[str, str]:
    """Return LS-DYNA's name by strikewave's: as asked, else of the same title, else the only one of each.

    Where LS-DYNA has no titles, and none was asked for, they are those of strikewave's deck, numbered from 1 on.
    """
    by_number = {number: name for name, number in numbers.items()}
    pairs = {}
    for name, number in stated.items():
        if name not in strikewave:
            raise InputError(
                option,
                name,
                "a name in strikewave: " + (", ".join(strikewave) or "there is none"),
                nearest(name, strikewave),
            )
        if number not in by_number:
            listed = ", ".join(map(str, sorted(by_number))) or "there is none"
            raise InputError(option, number, f"a number of LS-DYNA: {listed}")
        pairs[name] = by_number[number]
    for name in strikewave:
        same = [other for other, title in titles.items() if title.casefold() == name.casefold()]
        if name not in pairs and len(same) == 1 and same[0] not in pairs.values():
            pairs[name] = same[0]
    if not pairs and not any(titles.values()):
        pairs = {name: by_number[number] for number, name in enumerate(strikewave, start=1) if number in by_number}
    if len(strikewave) == len(numbers) == 1 and not pairs:
        pairs[strikewave[0]] = next(iter(numbers))
    return pairs


def _forces(dataset: Any, meshed: str) -> dict[str, Force]:
    """Return the mean forces of contacts; ``meshed`` begins the names of those of sectors, as the deck has them."""
    time = np.asarray(dataset["interval"].values, float)
    forces = {}
    for key in dataset.data_vars:
        name = str(key)
        if name.startswith(f"{meshed}contact.") and name.endswith(".mean_force"):
            own = name.removesuffix(".mean_force")
            impulse = np.asarray(dataset[f"{own}.impulse"].values, float)[-1]
            forces[own.removeprefix(f"{meshed}contact.")] = Force(time, np.asarray(dataset[key].values, float), impulse)
    if time.ndim != 1 or any(force.force.shape != (time.size, 3) for force in forces.values()):
        raise ValueError("its contact forces are not three components over the intervals")
    return forces


def _energies(dataset: Any, meshed: str) -> EnergyHistory:
    """Return the energies in LS-DYNA's words: bulk viscosity is part of ``internal``."""
    energy = {name: np.asarray(dataset[f"{meshed}energy.{name}"].values, float) for name in (*KEPT, "external")}
    total = np.sum([energy[name] for name in KEPT], axis=0)
    internal = energy["internal"] + energy.pop("viscous")
    return EnergyHistory(np.asarray(dataset["time"].values, float), {**energy, "internal": internal, "total": total})


def _extremes(path: Path) -> dict[str, Extreme]:
    if not path.is_file():
        return {}
    parts = _parts(path)
    extremes: dict[str, Extreme] = {}
    for frame in stored_frames(path):
        extremes = widened(extremes, frame, parts)
    return extremes


def _parts(path: Path) -> dict[str, tuple[NDArray[Any], slice]]:
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
        raise InputError("--compare", path, "fields as strikewave writes them", str(error)[:LONGEST_HINT]) from None
    ordered = len(part) == len(cells) and np.all(np.diff(part) >= 0) and len(cells)
    if not ordered or part[0] < 0 or part[-1] >= len(names) or cells.min() < 0 or cells.max() >= points:
        raise InputError("--compare", path, "fields as strikewave writes them", "its parts do not fit its elements")
    bounds = np.searchsorted(part, np.arange(len(names) + 1))
    elements = {name: slice(int(bounds[k]), int(bounds[k + 1])) for k, name in enumerate(names)}
    return {name: (np.unique(cells[own]), own) for name, own in elements.items() if own.stop > own.start}


def _angle(a: Array, b: Array) -> float:
    """Return the angle between two vectors, degrees; NaN where one is 0."""
    sizes = float(np.linalg.norm(a) * np.linalg.norm(b))
    return math.degrees(math.acos(min(1.0, max(-1.0, float(a @ b) / sizes)))) if sizes else math.nan


def _notices(comparison: RunComparison) -> Iterator[Notice]:
    """Yield what makes the numbers doubtful."""
    strikewave, ls_dyna = comparison.strikewave, comparison.ls_dyna
    assert strikewave is not None
    if strikewave.blows > 1:
        message = f"strikewave's run has {strikewave.blows} blows: only the first is compared"
        yield Notice("blows", message, float(strikewave.blows), 1.0)
    paired = {pair.name for pair in comparison.forces}
    for name in (name for name in strikewave.forces if name not in paired):
        free = ", ".join(contact.name for contact in ls_dyna.contacts) or "none"
        message = f"contact {name} has no counterpart; LS-DYNA has: {free}; --contact {name}=NUMBER names one"
        yield Notice("contact-unpaired", message, math.nan, math.nan)
    for name in (name for name in strikewave.extremes if ls_dyna.fields and name not in comparison.parts):
        free = ", ".join(f"{number} {title}" for title, number in ls_dyna.parts.items())
        message = f"part {name} has no counterpart; LS-DYNA has: {free}; --part {name}=NUMBER names one"
        yield Notice("part-unpaired", message, math.nan, math.nan)
    factors = _slips(comparison, strikewave)
    if factors:
        listed = ", ".join(f"{what} {factor:g}" for what, factor in factors.items())
        message = f"LS-DYNA over strikewave is near 1000 or a power of it ({listed}): is --units right?"
        yield Notice("units", message, next(iter(factors.values())), 1.0)
    for pair in comparison.forces:
        yield from _pair_notices(pair, bool(factors))


def _slips(comparison: RunComparison, strikewave: StrikewaveRun) -> dict[str, float]:
    """Return powers of 1000 between the numbers of LS-DYNA and strikewave, by what they are of."""
    both: dict[str, tuple[float, float]] = {}
    for pair in comparison.forces:
        if pair.strikewave and pair.ls_dyna:
            for what in ("peak", "impulse", "width"):
                both[f"{what} of {pair.name}"] = getattr(pair.ls_dyna, what), getattr(pair.strikewave, what)
    if comparison.ls_dyna.energies and "total" in comparison.ls_dyna.energies.energy:
        totals = (history.energy["total"] for history in (comparison.ls_dyna.energies, strikewave.energies))
        ls_dyna, own = (float(np.nan_to_num(np.abs(total)).max(initial=0.0)) for total in totals)
        both["total energy"] = ls_dyna, own
    for name, other in comparison.parts.items():
        for what in ("displacement", "von_mises"):
            extremes = comparison.ls_dyna.extremes.get(other), strikewave.extremes[name]
            if extremes[0]:
                both[f"{what.replace('_', ' ')} of {name}"] = getattr(extremes[0], what), getattr(extremes[1], what)
    factors = {what: slip(a / b) for what, (a, b) in both.items() if b}
    return {what: factor for what, factor in factors.items() if factor}


def _pair_notices(pair: ForcePair, slipped: bool) -> Iterator[Notice]:
    a, b = pair.strikewave, pair.ls_dyna
    if a is None or b is None:
        who = " nor ".join(name for name, pulse in (("strikewave", a), ("LS-DYNA", b)) if pulse is None)
        yield Notice("no-contact", f"contact {pair.name}: no contact in {who}", 0.0, math.nan)
        return
    if slipped:
        return
    for many in SECTORS:
        if all(abs(getattr(b, what) / many - getattr(a, what)) < SECTOR * getattr(a, what) for what in _SIZES):
            message = f"contact {pair.name}: LS-DYNA's force is about {many:g} times strikewave's: is one a sector?"
            yield Notice("sector", message, b.peak / a.peak, many)
    if abs(pair.shift) > SHIFT * a.width:
        later = "later" if pair.shift > 0.0 else "earlier"
        message = (
            f"contact {pair.name}: LS-DYNA's pulse begins {abs(pair.shift) * 1e6:.4g} us {later} than strikewave's"
        )
        yield Notice("time-shift", message, pair.shift, SHIFT * a.width)
    if pair.angle > ASIDE:
        message = f"contact {pair.name}: the impulses are {pair.angle:.3g} degrees apart: are both the same contact?"
        yield Notice("direction", message, pair.angle, ASIDE)
