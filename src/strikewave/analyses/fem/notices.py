"""Notices of an explicit run: balances, overlaps, coarse contacts, strength."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from strikewave.analyses.fem.sectors import open_cuts, sectors, unlike_sectors
from strikewave.base.constants import material
from strikewave.base.result import BALANCE_LIMIT, FAILED, Notice
from strikewave.base.texts import percent, plain
from strikewave.cases.case import Case, origin_notices
from strikewave.cases.materials_of_case import material_notices
from strikewave.fem.contact import thickness
from strikewave.fem.mesh import TINY
from strikewave.fem.model import Model, stays
from strikewave.fem.run import (
    ENERGY_LIMIT,
    HOURGLASS_LIMIT,
    PRESSES,
    TOP,
    BalanceMeasure,
    FemRun,
    contact_measure,
    pressing_at_end,
    still_presses,
    top_duration,
)
from strikewave.fem.solids import Bilinear, HeatedSolid
from strikewave.fem.solve import ROUNDING
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import written
from strikewave.signal.pulse import FEWEST_INTERVALS

if TYPE_CHECKING:
    from strikewave.analyses.fem.result import FemSolution

FEWEST_FACES = 16.0  # 9 are 5 % off Hertz's peak, 21 are 1 %
"""Pressed faces of a whole contact below which its force depends on the mesh."""
ALL_PRESSED = 0.9  # flat on flat presses all but a rim, a curved surface much less
"""Share of a surface that is pressed, above which its ends, not its faces, bound the contact."""
# Nodes on a face carry half an element with them, and turn at once: where a bar with elements of length h meets its
# like, the mean force of the first interval is h/(2 c interval) times A rho c v/2. Of the bars of ``two-bars-fem``,
# on elements of 1 to 8 mm and intervals of 0.1 to 2 us, a top of less than one transit came with peaks up to seven
# times those of fine elements; without it they stayed within 5 %.
FEWEST_TRANSITS = 1.0
"""Fewest transits of a wave through an element at the contact that the top of its force lasts."""
LONGER = 1.1  # chosen: a tenth, as falls flatten
"""Factor on the time in which the last force, continued, falls to nothing."""
RISING = 0.9  # its fall says nothing about its end
"""Share of the peak above which the force at the end may still rise."""
RESTLESS, REST_YIELD = 1e-9, 1e-4
"""Largest shares of the energy of a blow that are left as vibration before it, and taken by yield on the way to rest:
ten times the aim of relaxation (`strikewave.fem.solve.REST`), and a hundredth of the 1 % of the balance."""


def all_notices(solution: FemSolution) -> Iterator[Notice]:
    """Yield the notices of all blows; of later ones those that are new, or break a limit."""
    model, (before, *later) = solution.model, solution.blows
    first = list(notices(before))
    yield from first
    codes = {notice.code for notice in first}
    yield from _unfinished(model, before.run)
    for blow in later:
        yield from (notice for notice in blow_notices(blow) if notice.broken or notice.code not in codes)
        yield from _unfinished(model, blow.run)


def notices(solution: FemSolution) -> Iterator[Notice]:
    """Yield the notices of the first blow."""
    case, model, run = solution.case, solution.model, solution.run
    yield from _stopped(model, run)
    yield from _balances(solution.measured_balance)
    yield from origin_notices(case)
    yield from model_notices(case, model)
    if run.added_mass > 0.0:
        share = run.added_mass / sum(part.mass for part in run.parts.values())
        message = (
            f"fem.least_step added {plain(run.added_mass)}\xa0kg to small elements, {percent(share, 2)} of all mass"
        )
        yield Notice("added-mass", message, share, 0.0)
    yield from _overlaps(model, run)
    yield from _contacts(model, run)
    yield from _coarse_contacts(case, model, run)
    yield from _strength(case, model, run)


def model_notices(case: Case, model: Model) -> Iterator[Notice]:
    """Yield the notices of a model before it is run."""
    yield from material_notices(case)
    yield from _fast_parts(model)
    sector_of = sectors(case, model)
    cuts, unlike = list(open_cuts(model, sector_of)), unlike_sectors(model, sector_of)
    if cuts:
        message = (
            f"nothing holds the cut {' and '.join(cuts)} in its plane, so the other sectors of that body are as good "
            f'as gone: add [[fem.boundary]] kind = "symmetry", side = "{cuts[0]}"'
        )
        yield Notice("cut-without-symmetry", message, float(len(cuts)), 0.0)
    if unlike:
        message = (
            f"{listed(unlike)} {'is a sector' if len(unlike) == 1 else 'are sectors'} that other parts do not match: "
            "energies, momentum, and forces between unlike parts are those of the mesh, not of whole bodies; mesh "
            "the same sector of all parts"
        )
        yield Notice("sectors-differ", message, float(len(unlike)), 0.0)


def _fast_parts(model: Model) -> Iterator[Notice]:
    """Yield a notice of parts that meet faster than a wave runs in one of them: the solids have no law of shocks."""
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
                f"{fields}: {' and '.join(parts)} meet at {plain(speed, 4)}\xa0m/s, faster than a wave in {slowest}, "
                f"{plain(limit, 4)}\xa0m/s: that makes a shock front, which the laws of solids do not cover; check "
                "the unit"
            )
            yield Notice("faster-than-wave", message, speed, limit)


def blow_notices(solution: FemSolution) -> Iterator[Notice]:
    """Yield the notices of a blow after the first, and of the relaxation before it; each names its blow."""
    case, model, run = solution.case, solution.model, solution.run
    rest, notices_of_blow = run.rest, list[Notice]()
    if rest is not None and not rest.kinetic_share <= RESTLESS:
        message = f"before it, bodies still vibrate with {rest.kinetic_share:.1e} of the energy of the blow before"
        notices_of_blow.append(Notice("blow-rest", message, rest.kinetic_share, RESTLESS))
    yielded = rest.plastic_energy / max(run.initial_energy, TINY) if rest is not None else 0.0
    if rest is not None and yielded > REST_YIELD:
        message = (
            f"on the way to rest before it the bodies yield with {plain(rest.plastic_energy)}\xa0J, {yielded:.1e} "
            "of its energy"
        )
        notices_of_blow.append(Notice("blow-yield", message, yielded, REST_YIELD))
    notices_of_blow += _stopped(model, run)
    notices_of_blow += _balances(solution.measured_balance)
    notices_of_blow += _contacts(model, run)
    notices_of_blow += _strength(case, model, run)
    for notice in notices_of_blow:
        yield replace(notice, message=f"blow {run.blow}: {notice.message}")


def _stopped(model: Model, run: FemRun) -> Iterator[Notice]:
    if run.stopped:
        message = f"the run ended early: {run.stopped}"
        yield Notice("stopped", message, float(run.time[-1]), model.controls.duration, severity=FAILED)


def _unfinished(model: Model, run: FemRun) -> Iterator[Notice]:
    """Yield a notice of each contact of bodies that still presses when a run ends, with the duration that it needs."""
    follows = run.blow < model.controls.blows
    for name in run.force if not run.stopped else ():
        measure, at_end = contact_measure(run, name), pressing_at_end(run, name)
        if measure is None or not still_presses(run, name) or stays(model, model.touching[name]):
            continue
        end, share = float(run.time[-1]), at_end / measure.peak
        falling = measure.at + (end - measure.at) / max(1.0 - share, 1.0 - RISING)  # on a straight line to zero
        enough = measure.begin + 2.0 * (end - measure.begin) if share > RISING else falling  # a half-sine, doubled
        message = (
            f"the contact {name} still presses with {percent(share, 0 if share > 0.1 else 1)} of its peak when "
            f"{f'blow {run.blow}' if follows else 'the run'} ends"
            + (", and the next begins without it" if follows else ": its impulse, and what it moves, are not whole")
            + f"; take fem.duration of {written(LONGER * enough * 1e6, 3)}\xa0us or more"
        )
        yield Notice("blow-unfinished" if follows else "contact-unfinished", message, share, PRESSES)


def _balances(balance: BalanceMeasure) -> Iterator[Notice]:
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
    """Yield a notice of each contact whose surfaces stand in each other before the blow, beyond rounding."""
    least = ROUNDING * float(np.ptp(model.mesh.points, axis=0).max())
    for overlap in run.overlaps:
        if overlap.deepest > least:
            place = ", ".join(f"{plain(x * 1e3, 4)}" for x in overlap.place)
            message = (
                f"{overlap.nodes} nodes of the contact {overlap.contact} stand inside the other side before the blow, "
                f"the deepest by {plain(overlap.deepest * 1e6)}\xa0um at ({place}) mm: they are let out without a "
                "force; move the parts apart, or match their meshes, where that matters"
            )
            yield Notice("initial-overlap", message, overlap.deepest, least)


def _contacts(model: Model, run: FemRun) -> Iterator[Notice]:
    """Yield notices of contacts without touch, of pulses with few intervals, and of elements too coarse for them."""
    interval = float(run.time[1] - run.time[0])
    for name in run.force:
        measure = contact_measure(run, name)
        if measure is None:
            message = f"nothing touched in the contact {name}: a longer fem.duration, or another place or velocity"
            yield Notice("no-contact", message, 0.0, 0.0)
        elif measure.duration < FEWEST_INTERVALS * interval:  # too few points give no shape of a pulse
            message = (
                f"the contact {name} lasts {plain(measure.duration * 1e6)}\xa0us, {measure.duration / interval:.1f} "
                "intervals of the histories: take a shorter fem.interval"
            )
            yield Notice("fem-interval", message, measure.duration / interval, FEWEST_INTERVALS)
        transit, side = _transit(model, model.touching[name])
        top = 0.0 if measure is None else top_duration(run, name)
        if measure is not None and top < FEWEST_TRANSITS * transit:
            message = (
                f"the elements of {side} are too coarse for the force of the contact {name}: it is above "
                f"{percent(TOP, 0)} of its peak, {plain(measure.peak / 1e3)}\xa0kN, for "
                f"{plain(top * 1e6, 2)}\xa0us, and a wave "
                f"takes {plain(transit * 1e6, 2)}\xa0us through one of them, so that their size decides the peak; take "
                "smaller elements there"
            )
            if measure.duration >= FEWEST_INTERVALS * LONGER * transit:
                message += f", or fem.interval of {plain(LONGER * transit * 1e6, 2)}\xa0us or more"
            yield Notice("pulse-coarse", message, top / transit, FEWEST_TRANSITS)


def _transit(model: Model, sides: Sequence[str]) -> tuple[float, str]:
    """Return the transit of a wave through the thinnest element of the coarser side of a contact, s, and that side."""
    rigid, mesh = {body.part for body in model.rigid}, model.mesh
    transits = [
        # graded parts are thinnest where they are struck; rigid ones have no waves
        (float(thickness(mesh, mesh.side(side)).min()) / model.solids[part].wave_speed, side)
        for side in sides
        if (part := side.rpartition(".")[0]) not in rigid
    ]
    return max(transits, default=(0.0, ""))


def _coarse_contacts(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Yield notices of contacts that press too few faces of a larger surface."""
    sector_of, sides = sectors(case, model), model.touching
    unlike = unlike_sectors(model, sector_of)
    for name, pressed in run.pressed.items():
        for side, (share, faces) in zip(sides[name], pressed.max(axis=0), strict=False):
            pieces = 1 if unlike else sector_of[side.partition(".")[0]].pieces
            if 0.0 < share < ALL_PRESSED and faces < FEWEST_FACES:
                message = (
                    f"only {plain(faces, 2)} faces of {side} are ever pressed at once: their number decides the "
                    f"force; take a smaller finest size there, so that {FEWEST_FACES:.0f} or more are"
                    + (f" (a {'half' if pieces == 2 else 'quarter'} of them in the sector)" if pieces > 1 else "")
                )
                yield Notice("contact-coarse", message, float(faces), FEWEST_FACES)


def _strength(case: Case, model: Model, run: FemRun) -> Iterator[Notice]:
    """Yield notices of elastic parts beyond the yield strength of their material."""
    for part in case.mesh.part if case.mesh else ():
        strength = material(part.material).yield_strength if part.material else None
        stress = float(run.von_mises[part.name].max()) if part.name in run.von_mises else 0.0
        yields = isinstance(model.solids[part.name], Bilinear | HeatedSolid)
        if strength is not None and stress > strength and not yields:
            message = (
                f"the elastic part {part.name} is loaded with {plain(stress / 1e6, 4)}\xa0MPa (von Mises), beyond the "
                f"{plain(strength / 1e6, 4)}\xa0MPa at which {part.material} yields: give it a solid with a yield "
                "strength"
            )
            yield Notice("fem-yield", message, stress, strength)
