"""Blows of a run of a machine on the object."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.shock_quantities import (
    CONTACT_TIME,
    IMPULSE,
    INDENTATION,
    PEAK_FORCE,
    PULSE_WIDTH,
    RATIO,
    RESTITUTION,
    RIGID_PEAK,
    RISE_TIME,
    SPEED,
    VELOCITY_CHANGE,
)
from strikewave.contact.elastoplastic import spot_after
from strikewave.contact.law import check_end
from strikewave.machines._layout import APEX_SWITCH
from strikewave.machines.run import MachineRun
from strikewave.machines.spans import Moments, blow_numbers
from strikewave.signal.pulse import foot_to_foot, measure_pulse

Array = NDArray[np.float64]

KINDS = ("full", "glancing", "double", "missed")
"""Kinds of blows; see `Blow`."""
GLANCING_SHARE = 0.5  # chosen: a quarter of its energy
"""Share of the nominal approach speed below which a blow is glancing."""
DOUBLE_SHARE = 0.1  # chosen: a tenth of the velocity change then is not that of the pulse
"""Share of the contact impulse in a later group of contacts from which on a blow is double."""
SMALLEST_SPEED = 1e-6  # a face that is only grazed gets none
"""Speed of the object to which momentum is resolved, m/s."""
WORK_SAMPLES = 2001  # the trapezoidal rule is off by less than 1e-6 of a half-sine
"""Samples of a contact over which its work is summed."""
WINDOW_BEFORE, WINDOW_AFTER, SAMPLE_STEP = 50e-6, 1.5e-3, 0.25e-6
"""Window about a blow, before first touch and at least so long after its last release; sampling, s (chosen: a pulse of
50 us has 200 samples)."""
# Pictures show 2.2 widths of a pulse, which is no wider than the time in touch where the frame does not swing longer.
AGAIN = 1.25
"""Shortest part of a window after the last release, over the time in touch."""
LONGEST_WINDOW = 1.0
"""Longest window of a blow, s, as long as `machine.follow` may be: a touch for longer is a rest."""
MOST_SAMPLES = 200_000  # beyond 50 ms it is sampled more coarsely
"""Most samples of such a window, 30 MB with all that is sampled."""


@declare.dataclass
class Blow:
    """One pass of one striker, or one of the rebounds of a launched machine, all its re-contacts included; SI.

    Theory of both velocity changes: :eq:`machine-velocity-change`.
    """

    index: int = declare.count(
        "number of the blow, from 1", label="#", column=KEY, tables="blows contact sliding waves"
    )
    kind: str = declare.word(
        "full, glancing (approach below half the nominal speed of a drive), double (a second group of contacts, more "
        "than a pulse width later, carries a tenth of the impulse) or missed",
        column=MAIN,
        tables="blows",
        is_tag=True,
    )
    striker: int = declare.count("which striker, from 1", in_document=False)
    time: float = declare.number(
        Quantity("s", "ms", decimals=3, digits=0),
        "first touch after the valve signal; the apex of the pass when missed",
        column=MAIN,
        tables="blows",
    )
    contacts: int = declare.count("intervals of contact", column=MORE + 2, tables="blows", order=1)
    approach_speed: float = declare.number(SPEED, "closing speed at first touch", column=MORE, tables="blows contact")
    rebound_speed: float = declare.number(
        SPEED,
        "parting speed at the release that ends the blow: the last one of a double blow, else the last one before a "
        "gap longer than the pulse, after which the striker only touches lightly",
        column=MORE,
        tables="contact",
    )
    contact_time: float = declare.number(
        CONTACT_TIME,
        "from first touch to the release that ends the blow, gaps between contacts included",
        column=MORE,
        tables="contact",
    )
    restitution: float = declare.number(
        RESTITUTION,
        "of the contact: square root of the work that it gives back over the work that it takes (Stronge)",
        column=MAIN,
        tables="contact",
    )
    indentation: float = declare.number(
        INDENTATION, "largest indentation of the contact", column=MAIN, tables="contact"
    )
    residual_indentation: float = declare.number(
        INDENTATION, "what stays of the indentation", column=MORE + 1, tables="contact"
    )
    contact_stiffness: float = declare.number(
        Quantity("N/m", "MN/m", decimals=1, digits=0),
        "slope of the contact force at the largest indentation, on the way back",
        column=MAIN,
        tables="contact",
    )
    flattening: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, decimals=4, digits=0),
        "radius of the spot after the blow over that before anything yielded",
        column=MORE + 1,
        tables="contact",
    )
    impulse: float = declare.number(
        IMPULSE,
        "of all forces on the object from first touch to the release that ends the blow",
        column=MORE + 1,
        tables="blows",
    )
    contact_impulse: float = declare.number(IMPULSE, "the part of the impulse by the strikers' contact")
    support_impulse: float = declare.number(
        IMPULSE, "the part of the impulse by spring, damper, stop and gravity", in_document=False
    )
    momentum_error: float = declare.number(
        RATIO, "impulse less change of momentum, over the larger of contact and support impulse", in_document=False
    )
    peak_force: float = declare.number(PEAK_FORCE, "largest contact force", column=MORE, tables="blows")
    side_force: float = declare.number(
        Quantity("N", "kN", decimals=2, digits=0),
        "largest force across the blow with which the sliding nose drags the face along, over all contacts of the "
        "pass: above 0 the way the nose passes. The guide of the object bears it",
        column=MAIN,
        tables="sliding",
    )
    side_impulse: float = declare.number(
        IMPULSE, "impulse of the side force over all contacts of the pass", column=MAIN, tables="sliding"
    )
    friction_heat: float = declare.number(
        Quantity("J", "J", decimals=2, digits=0),
        "heat of this sliding over all contacts of the pass",
        column=MORE,
        tables="sliding",
    )
    rigid_peak: float = declare.number(
        RIGID_PEAK,
        "peak of the assembly's rigid-body acceleration. The zero is that of a sensor, taken before the blow: of an "
        "object that falls, in the fall, so that gravity is in no figure of its pulse",
        band="rigid_peak",
        column=MAIN,
        tables="blows waves",
        headline="first rigid peak",
    )
    width: float = declare.number(
        PULSE_WIDTH,
        "width of that pulse at 10 % of its peak",
        band="width",
        column=MAIN,
        tables="blows",
        headline="first pulse width",
    )
    rise: float = declare.number(
        RISE_TIME, "time in which that pulse rises from 10 to 90 % of its peak", in_document=False
    )
    velocity_change: float = declare.number(
        VELOCITY_CHANGE,
        "integral of that pulse from foot to foot, where 2 % of its peak is left, as a record has it: what frame, "
        "spring and stop give the assembly from about first touch to the last release of the pulse, nothing later",
        band="velocity_change",
        column=MAIN,
        tables="blows",
        headline="first velocity change",
    )
    blow_velocity_change: float = declare.number(
        VELOCITY_CHANGE,
        "of the object's centre of mass from first touch to the release that ends the blow: impulse over its mass, "
        "gravity included; of a double blow over the whole pass, what spring and stop do between its contacts included",
    )
    largest_displacement: float = declare.number(
        Quantity("m", "mm", decimals=2, digits=0),
        "largest displacement of the struck face, rearward, after first touch and until the next blow or the "
        "retraction; of a missed blow, how far behind its place of rest the face was when the striker passed",
        column=MORE + 1,
        tables="blows",
    )
    turntable_speed: float = declare.number(
        Quantity("rad/s", "rad/s", decimals=3, digits=0), "at first touch", column=MORE, tables="sliding"
    )


def contact_table(run: MachineRun) -> Array:
    """Return all contacts in order of time: begin, end, approach speed, striker (from 0), pass; shape (N, 5).

    The passes of a launched machine that is followed over its rebounds are its blows.
    """
    table = run.contacts()
    if run.machine.rebounds is not None:
        return np.column_stack([table, blow_numbers(table)])
    angles = run.sample(table[:, 0]).turntable_angle if len(table) else np.empty(0)
    return np.column_stack([table, np.round(angles / run.machine.pitch)])


def counted_passes(run: MachineRun) -> dict[int, float]:
    """Return the passes whose apex fell while the object was held in place: pass number to time, s."""
    begin, end = run.held
    times = run.switch_times(APEX_SWITCH)
    times = times[(times >= begin) & (times <= end + 1e-12)]
    angles = run.sample(times).turntable_angle if times.size else np.empty(0)
    return {round(a / run.machine.pitch): float(t) for a, t in zip(angles, times, strict=True)}


def blows(run: MachineRun) -> tuple[Blow, ...]:
    """List the blows of a run in order of time, missed passes among them.

    A pass belongs to the list when its striker touched the object, or when its apex fell while the
    object was held in place.
    """
    table, counted = contact_table(run), counted_passes(run)
    passes = sorted({*counted, *(int(p) for p in table[:, 4])})
    starts = [float(table[table[:, 4] == p, 0][0]) if p in table[:, 4] else counted[p] for p in passes]
    listed = []
    for index, (struck_pass, start) in enumerate(zip(passes, starts, strict=True), start=1):
        until = starts[index] if index < len(starts) else run.end
        rows = table[table[:, 4] == struck_pass]
        if len(rows):
            listed.append(_struck(run, index, rows, until))
        else:
            listed.append(_missed(run, index, struck_pass, start))
    return tuple(listed)


def window_ends(run: MachineRun, all_blows: Sequence[Blow], tail: float = WINDOW_AFTER) -> Array:
    """Return the end of the window of each blow of a run, s; NaN where it missed.

    After the last release of its pass it lasts somewhat longer than the pass was in touch, and ``tail`` and a swing of
    the frame at least; but no longer than until the next blow, the end of the run, or `LONGEST_WINDOW`.
    """
    touches, swing = run.contacts(), 1.0 / run.machine.struck.frame_frequency
    edges = [*(blow.time for blow in all_blows), run.end]
    ends = np.full(len(all_blows), math.nan)
    for k, (blow, until) in enumerate(zip(all_blows, edges[1:], strict=True)):
        if blow.kind != "missed":
            last = float(touches[(touches[:, 0] >= blow.time) & (touches[:, 0] < until), 1].max())
            after = max(tail, swing, AGAIN * (last - blow.time))
            ends[k] = min(last + after, until, blow.time + LONGEST_WINDOW)
    return ends


def pulse_window(
    run: MachineRun, touch: float, until: float = math.inf, step: float = SAMPLE_STEP
) -> tuple[Array, Array, Array]:
    """Return time since first touch, contact force and rigid acceleration about a blow.

    The window ends at ``until`` (s after first touch), or where the motion ends.
    """
    since, moments = _window(run, touch, until, step)
    return since, moments.contact_force, moments.rigid_acceleration


def _window(run: MachineRun, touch: float, until: float, step: float) -> tuple[Array, Moments]:
    """Return time since first touch, and the moments of the machine then, about a blow."""
    after = min(until, run.end - touch)
    first, last = -int(min(WINDOW_BEFORE, touch) / step), int(after / step)
    since = step * np.arange(first, last + 1, dtype=np.float64)
    return since, run.sample(touch + since)


def _missed(run: MachineRun, index: int, number: int, time: float) -> Blow:
    undefined = (
        *("approach_speed", "rebound_speed", "contact_time", "restitution", "rigid_peak", "width", "rise"),
        *("indentation", "residual_indentation", "contact_stiffness", "flattening", "momentum_error"),
    )
    zero = (
        *("impulse", "contact_impulse", "support_impulse", "peak_force", "velocity_change"),
        *("blow_velocity_change", "side_force", "side_impulse", "friction_heat"),
    )
    passing = run.sample(np.array([time]))
    return Blow(
        index=index,
        kind="missed",
        striker=number % run.machine.strikers.count + 1,
        time=time,
        contacts=0,
        largest_displacement=float(passing.face_place[0]) + run.machine.engagement,
        turntable_speed=float(passing.turntable_speed[0]),
        **dict.fromkeys(undefined, math.nan),
        **dict.fromkeys(zero, 0.0),
    )


def _struck(run: MachineRun, index: int, rows: Array, until: float) -> Blow:
    struck = run.machine.struck
    begin, striker, last = float(rows[0, 0]), int(rows[0, 3]), float(rows[:, 1].max())
    after = max(WINDOW_AFTER, 1.0 / struck.frame_frequency)
    lasting = min(until, last + after, begin + LONGEST_WINDOW) - begin
    step = max(SAMPLE_STEP, lasting / MOST_SAMPLES)
    since, moments = _window(run, begin, lasting, step)
    force, acceleration = moments.contact_force, moments.rigid_acceleration
    pulse = measure_pulse(acceleration, step, since[0]) if acceleration.max() > 0 else None
    width = pulse.width if pulse else math.nan
    kind, end = _kind(run, rows, width)
    edges = run.sample(np.array([begin, end]))
    contact, support, _ = run.impulses(begin, end)
    heat = float(np.diff(run.sample(np.array([begin, last])).friction_heat)[0])
    side_force = float(moments.side_force[np.argmax(np.abs(moments.side_force))])
    blow_change = float(np.diff(edges.object_speed)[0])
    free = min(until, max(run.released, last))
    path = run.sample(np.linspace(begin, free, 2001)).assembly_place
    # just before the touch, which belongs to this blow
    before, (deep, restitution) = run.deepest(np.nextafter(begin, 0.0), striker), _work(run, rows)
    yielded = run.deepest(last, striker)
    if yielded > before:
        deep = yielded
    contact_law = run.machine.strikers.each[striker].contact
    check_end(contact_law, deep)
    spot = spot_after(contact_law, deep, yielded)
    rebound = run.span_at(np.nextafter(end, begin)).parting_speed(end, striker)
    return Blow(
        index=index,
        kind=kind,
        striker=striker + 1,
        time=begin,
        contacts=len(rows),
        approach_speed=float(rows[0, 2]),
        rebound_speed=rebound,
        contact_time=end - begin,
        restitution=restitution,
        indentation=deep,
        residual_indentation=spot.residual_indentation,
        contact_stiffness=spot.stiffness,
        flattening=spot.flattening,
        impulse=contact + support,
        contact_impulse=contact,
        support_impulse=support,
        momentum_error=abs(contact + support - struck.mass * blow_change)
        / max(contact, abs(support), struck.mass * SMALLEST_SPEED),
        peak_force=float(force.max()),
        side_force=side_force,
        side_impulse=run.impulses(begin, last).side,
        friction_heat=heat,
        rigid_peak=pulse.peak if pulse else math.nan,
        width=width,
        rise=pulse.rise if pulse else math.nan,
        velocity_change=foot_to_foot(acceleration, step) if pulse else math.nan,
        blow_velocity_change=blow_change,
        largest_displacement=float(path.max() - path[0]),
        turntable_speed=float(edges.turntable_speed[0]),
    )


def _work(run: MachineRun, rows: Array) -> tuple[float, float]:
    """Return the largest indentation of some contacts, m, and their restitution by work given back over work taken."""
    deepest, taken, back = 0.0, 0.0, 0.0
    for begin, end in rows[:, :2]:
        # up to just before its end: the energy of a nose that slips off is not given back
        moments = run.sample(np.linspace(begin, np.nextafter(end, begin), WORK_SAMPLES))
        d, force = moments.indentation, moments.contact_force
        work = 0.5 * (force[1:] + force[:-1]) * np.diff(d)
        deepest = max(deepest, float(d.max()))
        taken += float(work[work > 0.0].sum())
        back -= float(work[work < 0.0].sum())
    return deepest, math.sqrt(back / taken) if taken > 0.0 else math.nan


def _kind(run: MachineRun, rows: Array, width: float) -> tuple[str, float]:
    """Return the kind of a blow and when it ends, s: later light touches, a pulse width off, are no part of it."""
    last = float(rows[:, 1].max())
    gaps = np.flatnonzero(rows[1:, 0] - rows[:-1, 1] > width)
    end = float(rows[: gaps[0] + 1, 1].max()) if gaps.size else last
    if run.machine.launch is None and rows[0, 2] < GLANCING_SHARE * run.machine.nominal_approach:
        return "glancing", end
    if gaps.size:
        later = run.impulses(float(rows[gaps[0] + 1, 0]), last).contact
        # the fast engine has the same rule: `fast_run._kinds`
        if later > DOUBLE_SHARE * run.impulses(float(rows[0, 0]), last).contact:
            return "double", last
    return "full", end
