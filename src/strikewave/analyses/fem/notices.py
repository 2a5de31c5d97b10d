"""What a user should know of an explicit run: balances, overlaps, coarse contacts, strength."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from strikewave.analyses.fem.sectors import open_cuts, sectors
from strikewave.base.materials import material
from strikewave.base.percents import percent
from strikewave.base.result import BALANCE_LIMIT, FAILED, Notice
from strikewave.cases.case import Case
from strikewave.cases.comparisons import origin_notices
from strikewave.cases.material_notices import material_notices
from strikewave.fem.blow_measures import still_presses
from strikewave.fem.measures import ENERGY_LIMIT, HOURGLASS_LIMIT, balance_measure
from strikewave.fem.mesh import TINY
from strikewave.fem.model import Model, stays
from strikewave.fem.repeated_blows import ROUNDING
from strikewave.fem.run import FemRun
from strikewave.fem.solids import Bilinear, HeatedSolid
from strikewave.signal.pulse import FEWEST_INTERVALS

FEWEST_FACES = 16.0
"""Pressed faces of a whole contact below which its force depends on the mesh: 9 are 5 % off Hertz's peak, 21 are 1
%."""
ALL_PRESSED = 0.9
"""Share of a surface that is pressed, above which its ends, not its faces, bound the contact: flat on flat presses all
but a rim, a curved surface much less."""
RESTLESS, REST_YIELD = 1e-9, 1e-4
"""Shares of the energy of a blow that may be left as vibration before it, and taken by yield on the way to rest.

Ten times what relaxation aims at (`strikewave.fem.repeated_blows.REST`); and a hundredth of the 1 % of the balance."""


def all_notices(case: Case, model: Model, runs: Sequence[FemRun]) -> Iterator[Notice]:
    """Yield what a user should know about all blows; of later ones what is new, or breaks a limit."""
    first = list(notices(case, model, runs[0]))
    yield from first
    codes = {notice.code for notice in first}
    for run in runs:
        later = blow_notices(case, model, run) if run.blow > 1 else ()
        yield from (notice for notice in later if notice.broken or notice.code not in codes)
        yield from _unfinished(model, run)


def notices(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Yield what a user should know about a run."""
    if run.stopped:
        message = f"the run ended early: {run.stopped}"
        yield Notice("stopped", message, float(run.time[-1]), model.controls.duration, severity=FAILED)
    yield from _balances(run)
    yield from origin_notices(case)
    yield from model_notices(case, model)
    if run.added_mass > 0.0:
        share = run.added_mass / sum(part.mass for part in run.parts.values())
        message = f"fem.least_step added {run.added_mass:.3g}\xa0kg to small elements, {percent(share, 2)} of all mass"
        yield Notice("added-mass", message, share, 0.0)
    yield from _overlaps(model, run)
    yield from _contacts(run)
    yield from _coarse_contacts(case, model, run)
    yield from _strength(case, model, run)


def model_notices(case: Case, model: Model) -> Iterator[Notice]:
    """Yield what a user should know about a model before it is run."""
    yield from material_notices(case)
    yield from _fast_parts(model)
    cuts = list(open_cuts(model, sectors(case, model)))
    if cuts:
        message = (
            f"nothing holds the cut {' and '.join(cuts)} in its plane, so the other sectors of that body are as good "
            f'as gone: add [[fem.boundary]] kind = "symmetry", side = "{cuts[0]}"'
        )
        yield Notice("cut-without-symmetry", message, float(len(cuts)), 0.0)


def _fast_parts(model: Model) -> Iterator[Notice]:
    """Report parts that meet faster than a wave runs in one of them: of shock fronts the solids here know nothing."""
    rigid = {body.part for body in model.rigid}
    for sides in model.touching.values():
        parts = [side.rpartition(".")[0] or side for side in sides]
        solids = {part: model.solids[part] for part in parts if part in model.solids and part not in rigid}
        speeds = [np.array(model.velocity.get(part, (0.0, 0.0, 0.0))) for part in parts]
        speed = float(np.linalg.norm(speeds[0] - (speeds[1] if len(speeds) > 1 else 0.0)))
        slowest = min(solids, key=lambda part: solids[part].wave_speed, default=None)
        if slowest is not None and speed > solids[slowest].wave_speed:
            limit = solids[slowest].wave_speed
            fields = " and ".join(f"mesh.part.{part}.velocity" for part in parts if part in model.velocity)
            message = (
                f"{fields}: {' and '.join(parts)} meet at {speed:.4g}\xa0m/s, faster than a wave in {slowest}, "
                f"{limit:.4g}\xa0m/s: it is a shock front, of which the laws of solids do not know; look at the unit"
            )
            yield Notice("faster-than-wave", message, speed, limit)


def blow_notices(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Yield what a user should know about a blow after the first, and how the bodies came to it."""
    rest = run.rest
    if rest is not None and not rest.kinetic_share <= RESTLESS:
        message = f"before it, bodies still vibrate with {rest.kinetic_share:.1e} of the energy of the blow before"
        yield _named(run, Notice("blow-rest", message, rest.kinetic_share, RESTLESS))
    yielded = rest.plastic_energy / max(run.initial_energy, TINY) if rest is not None else 0.0
    if rest is not None and yielded > REST_YIELD:
        message = (
            f"on the way to rest before it the bodies yield with {rest.plastic_energy:.3g}\xa0J, {yielded:.1e} of its"
        )
        yield _named(run, Notice("blow-yield", f"{message} energy", yielded, REST_YIELD))
    if run.stopped:
        message = f"the run ended early: {run.stopped}"
        yield _named(run, Notice("stopped", message, float(run.time[-1]), model.controls.duration, severity=FAILED))
    for group in (_balances(run), _contacts(run), _strength(case, model, run)):
        yield from (_named(run, notice) for notice in group)


def _named(run: FemRun, notice: Notice) -> Notice:
    """Return a notice that names its blow."""
    return replace(notice, message=f"blow {run.blow}: {notice.message}")


def _unfinished(model: Model, run: FemRun) -> Iterator[Notice]:
    """Say which contacts still press when a blow ends that another one follows."""
    for name in run.force if run.blow < model.controls.blows else ():
        if still_presses(run, name) and not stays(model, model.touching[name]):
            message = (
                f"the contact {name} still presses when blow {run.blow} ends, and the next begins without it: "
                "a longer fem.duration"
            )
            yield Notice("blow-unfinished", message, float(run.time[-1]), model.controls.duration)


def _balances(run: FemRun) -> Iterator[Notice]:
    balance = balance_measure(run)
    if not abs(balance.energy) <= ENERGY_LIMIT:
        what = "too much" if balance.energy > 0.0 else "missing"
        message = (
            f"{percent(abs(balance.energy), 2)} of the energy is {what}: take a smaller fem.safety or smaller elements"
        )
        yield Notice("energy-balance", message, abs(balance.energy), ENERGY_LIMIT, severity=FAILED)
    if not balance.hourglass <= HOURGLASS_LIMIT:
        message = (
            f"hourglass modes hold {percent(balance.hourglass)} of the internal energy: take smaller elements, or "
            'elements = "full" for the part that bends'
        )
        yield Notice("hourglass-energy", message, balance.hourglass, HOURGLASS_LIMIT, severity=FAILED)
    if not balance.momentum <= BALANCE_LIMIT:
        message = f"the momentum balance error is {balance.momentum:.1e}"
        yield Notice("momentum-balance", message, balance.momentum, BALANCE_LIMIT, severity=FAILED)


def _overlaps(model: Model, run: FemRun) -> Iterator[Notice]:
    """Say which surfaces stood in each other before the blow, beyond rounding."""
    least = ROUNDING * float(np.ptp(model.mesh.points, axis=0).max())
    for overlap in run.overlaps:
        if overlap.deepest > least:
            place = ", ".join(f"{x * 1e3:.4g}" for x in overlap.place)
            message = (
                f"{overlap.nodes} nodes of the contact {overlap.contact} stand inside the other side before the blow, "
                f"the deepest by {overlap.deepest * 1e6:.3g}\xa0um at ({place}) mm: they are let out without a force; "
                "move the parts apart, or match their meshes, where that matters"
            )
            yield Notice("initial-overlap", message, overlap.deepest, least)


def _contacts(run: FemRun) -> Iterator[Notice]:
    """Say which contacts nothing touched, and which pulses the interval of the histories is too long for."""
    from strikewave.fem.measures import contact_measure

    interval = float(run.time[1] - run.time[0])
    for name in run.force:
        measure = contact_measure(run, name)
        if measure is None:
            message = f"nothing touched in the contact {name}: a longer fem.duration, or another place or velocity"
            yield Notice("no-contact", message, 0.0, 0.0)
        elif measure.duration < FEWEST_INTERVALS * interval:
            message = (
                f"the contact {name} lasts {measure.duration * 1e6:.3g}\xa0us, {measure.duration / interval:.1f} "
                "intervals of the histories: take a shorter fem.interval"
            )
            yield Notice("fem-interval", message, measure.duration / interval, FEWEST_INTERVALS)


def _coarse_contacts(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Say which contacts press so few faces of a larger surface that their force depends on the mesh."""
    sector_of = sectors(case, model)
    sides = model.touching
    for name, pressed in run.pressed.items():
        for side, (share, faces) in zip(sides[name], pressed.max(axis=0), strict=False):
            pieces = sector_of[side.partition(".")[0]].pieces
            if 0.0 < share < ALL_PRESSED and pieces * faces < FEWEST_FACES:
                message = (
                    f"only {pieces * faces:.2g} faces of {side} are ever pressed at once: their number decides the "
                    f"force; take a smaller finest size there, so that {FEWEST_FACES:.0f} or more are"
                    + (f" (a {'half' if pieces == 2 else 'quarter'} of them in the sector)" if pieces > 1 else "")
                )
                yield Notice("contact-coarse", message, pieces * float(faces), FEWEST_FACES)


def _strength(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Say which elastic parts go beyond the yield strength of their material."""
    for part in case.mesh.part if case.mesh else ():
        strength = material(part.material).yield_strength if part.material else None
        stress = float(run.von_mises[part.name].max()) if part.name in run.von_mises else 0.0
        yields = isinstance(model.solids[part.name], Bilinear | HeatedSolid)
        if strength is not None and stress > strength and not yields:
            message = (
                f"the elastic part {part.name} is loaded with {stress / 1e6:.4g}\xa0MPa (von Mises), beyond the "
                f"{strength / 1e6:.4g}\xa0MPa at which {part.material} yields: give it a solid with a yield strength"
            )
            yield Notice("fem-yield", message, stress, strength)
