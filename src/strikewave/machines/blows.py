"""What a run of the rotary machine did to the object, blow by blow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.contact.chain import contacts
from strikewave.machines._kernels import APEX_SWITCH, FEED, HELD
from strikewave.machines.rotary import RotaryRun
from strikewave.signal.pulse import measure_pulse

Array = NDArray[np.float64]

KINDS = ("full", "glancing", "double", "missed")
"""What a blow can be; see `Blow`."""
GLANCING_SHARE = 0.5
"""A blow whose approach speed is below this share of the nominal one is called glancing."""
DOUBLE_SHARE = 0.1
"""A blow is called double when a later group of contacts carries this share of its contact impulse."""
WINDOW_BEFORE, WINDOW_AFTER, SAMPLE_STEP = 50e-6, 1.5e-3, 0.25e-6
"""Window about a blow, before first touch and at least so long after first touch and last release; sampling, s."""


@dataclass(frozen=True)
class Blow:
    """One pass of one striker, all its re-contacts included; SI.

    Attributes
    ----------
    index : int
        Number of the blow, from 1.
    kind : str
        full, glancing (approach below half the nominal speed), double (a second group of contacts, more
        than a pulse width later, carries a tenth of the impulse) or missed.
    striker : int
        Which striker, from 1.
    time : float
        First touch after the valve signal; the apex of the pass when missed.
    contacts : int
        Intervals of contact.
    approach_speed, rebound_speed : float
        Closing speed at first touch, parting speed at the last release.
    impulse : float
        Of all forces on the object from first touch to last release, N s.
    contact_impulse, support_impulse : float
        Its two parts: the strikers' contact; spring, damper, stop and gravity.
    momentum_error : float
        Impulse less change of momentum, over the contact impulse.
    peak_force : float
        Largest contact force.
    rigid_peak, width, rise : float
        Of the assembly's rigid-body acceleration; width at 10 % of the peak.
    velocity_change : float
        Of the object's centre of mass from first touch to last release: impulse over its mass.
    retreat : float
        Largest retreat after first touch, until the next blow or the retraction, m.
    turntable_speed : float
        At first touch, rad/s.
    """

    index: int
    kind: str
    striker: int
    time: float
    contacts: int
    approach_speed: float
    rebound_speed: float
    impulse: float
    contact_impulse: float
    support_impulse: float
    momentum_error: float
    peak_force: float
    rigid_peak: float
    width: float
    rise: float
    velocity_change: float
    retreat: float
    turntable_speed: float


def contact_table(run: RotaryRun) -> Array:
    """Return all contacts in order of time: begin, end, approach speed, striker (from 0), pass; shape (N, 5)."""
    place = run.places
    rows = []
    for striker in range(place.strikers):
        found = contacts(run.motion, striker)
        rows.append(np.column_stack([found, np.full(len(found), striker, dtype=float)]))
    table = np.concatenate(rows)
    table = table[np.argsort(table[:, 0], kind="stable")]
    angles = run.motion.sample(table[:, 0])[0][:, place.angle] if len(table) else np.empty(0)
    return np.column_stack([table, np.round(angles / run.machine.pitch)])


def counted_passes(run: RotaryRun) -> dict[int, float]:
    """Return the passes whose apex fell while the object was held in place: pass number to time, s."""
    record, place = run.motion.record, run.places
    held = record.mode[:, place.links + FEED] == HELD
    if not held.any():
        return {}
    begin = record.time[held][0]
    end = record.time[held][-1] + record.step[held][-1]
    apex = record.event[:, 0] == place.own_switches + APEX_SWITCH
    times = record.event_time[apex]
    times = times[(times >= begin) & (times <= end)]
    angles = run.motion.sample(times)[0][:, place.angle]
    return {round(a / run.machine.pitch): float(t) for a, t in zip(angles, times, strict=True)}


def blows(run: RotaryRun) -> tuple[Blow, ...]:
    """List the blows of a run in order of time, missed passes among them.

    A pass belongs to the list when its striker touched the object, or when its apex fell while the
    object was held in place.
    """
    table, counted = contact_table(run), counted_passes(run)
    passes = sorted({*counted, *(int(p) for p in table[:, 4])})
    per_step = run.motion.impulses()
    starts = [float(table[table[:, 4] == p, 0][0]) if p in table[:, 4] else counted[p] for p in passes]
    found = []
    for index, (number, start) in enumerate(zip(passes, starts, strict=True), start=1):
        until = starts[index] if index < len(starts) else run.motion.end.time
        rows = table[table[:, 4] == number]
        if len(rows):
            found.append(_struck(run, index, rows, per_step, until))
        else:
            found.append(_missed(run, index, number, start))
    return tuple(found)


def pulse_window(
    run: RotaryRun, touch: float, until: float = math.inf, step: float = SAMPLE_STEP
) -> tuple[Array, Array, Array]:
    """Return time since first touch, contact force and rigid acceleration about a blow.

    The window ends at ``until`` (s after first touch), or where the motion ends.
    """
    after = min(until, run.motion.end.time - touch)
    first, last = -round(min(WINDOW_BEFORE, touch) / step), int(after / step)
    since = step * np.arange(first, last + 1, dtype=np.float64)
    _, forces = run.motion.sample(touch + since)
    return since, forces[:, run.places.contacts].sum(axis=1), run.rigid_acceleration(forces)


def _missed(run: RotaryRun, index: int, number: int, time: float) -> Blow:
    state = run.motion.sample(np.array([time]))[0][0]
    nothing = dict.fromkeys(
        ("approach_speed", "rebound_speed", "rigid_peak", "width", "rise", "retreat", "momentum_error"), math.nan
    )
    zeros = dict.fromkeys(("impulse", "contact_impulse", "support_impulse", "peak_force", "velocity_change"), 0.0)
    return Blow(
        index=index,
        kind="missed",
        striker=number % run.places.strikers + 1,
        time=time,
        contacts=0,
        turntable_speed=float(state[run.places.angle + 1]),
        **nothing,
        **zeros,
    )


def _struck(run: RotaryRun, index: int, rows: Array, per_step: Array, until: float) -> Blow:
    place, record, struck = run.places, run.motion.record, run.machine.struck
    begin, end = float(rows[0, 0]), float(rows[:, 1].max())
    striker = int(rows[0, 3])
    states, _ = run.motion.sample(np.array([begin, end]))
    speeds = states[:, place.bodies : place.angle]
    masses = np.array([struck.nose_mass, struck.assembly_mass])
    momentum = speeds[:, place.nose :] @ masses
    within = (record.time >= begin - 1e-15) & (record.time + record.step <= end + 1e-15)
    links = per_step[within].sum(axis=0)
    contact = float(links[place.contacts].sum())
    support = float(links[place.stop] - links[place.support]) + struck.mass * struck.gravity * (end - begin)
    change = float(momentum[1] - momentum[0])
    since, force, acceleration = pulse_window(run, begin, min(until, end + WINDOW_AFTER) - begin)
    pulse = measure_pulse(acceleration, SAMPLE_STEP, since[0]) if acceleration.max() > 0 else None
    free = min(until, max(dict(run.phases)["retract"], end))
    path = run.motion.sample(np.linspace(begin, free, 2001))[0][:, place.assembly]
    width = pulse.width if pulse else math.nan
    return Blow(
        index=index,
        kind=_kind(run, rows, per_step, width),
        striker=striker + 1,
        time=begin,
        contacts=len(rows),
        approach_speed=float(rows[0, 2]),
        rebound_speed=float(speeds[1, place.nose] - speeds[1, striker]),
        impulse=contact + support,
        contact_impulse=contact,
        support_impulse=support,
        momentum_error=abs(contact + support - change) / contact,
        peak_force=float(force.max()),
        rigid_peak=pulse.peak if pulse else math.nan,
        width=width,
        rise=pulse.rise if pulse else math.nan,
        velocity_change=change / struck.mass,
        retreat=float(path.max() - path[0]),
        turntable_speed=float(states[0, place.angle + 1]),
    )


def _kind(run: RotaryRun, rows: Array, per_step: Array, width: float) -> str:
    if rows[0, 2] < GLANCING_SHARE * run.machine.nominal_approach:
        return "glancing"
    record = run.motion.record
    gaps = np.flatnonzero(rows[1:, 0] - rows[:-1, 1] > width)
    if gaps.size:
        contact = per_step[:, run.places.contacts].sum(axis=1)
        inside = (record.time >= rows[0, 0]) & (record.time < rows[:, 1].max())
        later = (record.time >= rows[gaps[0] + 1, 0]) & inside
        if contact[later].sum() > DOUBLE_SHARE * contact[inside].sum():
            return "double"
    return "full"
