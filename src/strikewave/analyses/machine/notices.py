"""Notices of a run: broken balances, odd blows, yield, a recorder that misses a blow, an object that moves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from strikewave.analyses.machine.blow_histories import BlowHistory, BlowReading, Observed, TimedBlow, struck_blows
from strikewave.analyses.machine.kind import Release, kind_of
from strikewave.analyses.machine.result import ContactAnswer, ContactAnswers
from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.base.quantities import AUTO
from strikewave.base.result import FAILED, INFO, Notice, Verdict, balance_notices
from strikewave.base.shock_quantities import ACCELERATION
from strikewave.base.texts import percent, plain
from strikewave.cases.case import Case, origin_notices
from strikewave.cases.contact_notices import (
    cushion_notices,
    damping_speed_notices,
    force_words,
    joint_yield_notices,
    law_notices,
    low_pressure_notices,
    size_notices,
    speed_notices,
)
from strikewave.cases.contact_of_case import or_else, struck_material
from strikewave.cases.contact_parts import ELASTIC, YIELDING
from strikewave.cases.materials_of_case import material_notices
from strikewave.cases.stack_of_case import build_taps
from strikewave.cases.tables.contact import CUSHION
from strikewave.machines import Blow
from strikewave.machines.run import MachineRun
from strikewave.machines.spans import REST_SHARE, StackSpan
from strikewave.reporting.faces import amount, text_of
from strikewave.signal.pulse import FEWEST_INTERVALS, measure_pulse
from strikewave.waves.limits import (
    field_extremes,
    grid_notices,
    joint_notices,
    layer_notices,
    not_reached_notices,
    rise_notices,
)

if TYPE_CHECKING:
    from strikewave.machines.fast_run import FastTrain

HEAVY_ANVIL = 10.0
"""Mass of a free anvil over that of what meets it from which on it counts as fixed: it then costs less than a tenth of
the velocity change, M/(M + m). Chosen; the built-in cases have 100 and more."""

YIELD_TAKES = 0.01
"""Restitution that yield must take from what is asked of the damping to be reported: less is not measured."""


def notices(case: Case, blows: Sequence[Blow], answers: ContactAnswers | None) -> tuple[Notice, ...]:
    """Return the notices of a run but for its balances and its waves; ``answers`` are those of its first contact."""
    struck = struck_blows(blows)
    listed = [*origin_notices(case), *material_notices(case), *law_notices(case)]
    if not struck:
        return (*listed, *count_notices(case, blows))
    listed += [*_odd_blows(case, blows), *_rail(case), *_yield(case, answers), *_contact(case, struck)]
    return (*listed, *cushion_notices(case, struck), *_recorder(case, struck))


def count_notices(case: Case, blows: Sequence[TimedBlow]) -> Iterator[Notice]:
    """Report where no blow struck, or not as many as are wanted: a full or a fast run."""
    delivered, launched, wanted = len(struck_blows(blows)), case.launched(), 1.0
    if not delivered:
        where = "where it rests against machine.engagement" if launched is None else "[machine]"
        yield Notice("no-blow", f"no striker touched the object: see {where}", 0.0, 1.0, severity=FAILED)
        return
    if case.feed is not None:
        wanted = case.feed.blows.si
    elif launched is not None and launched.until == "rest":
        wanted = float(delivered)
    elif launched is not None and launched.until == "brake":
        wanted = or_else(launched.brake_after, 1.0)
    if delivered != wanted:
        message = f"{delivered} blows instead of the {wanted:.0f} wanted"
        yield Notice("blow-count", message, float(delivered), wanted, severity=FAILED)


def balance_of(run: MachineRun, blows: Sequence[Blow]) -> dict[str, float]:
    """Return the errors of the balances of a run, as shares."""
    errors = [blow.momentum_error for blow in struck_blows(blows)]
    errors += [span.momentum_error for span in run.spans if isinstance(span, StackSpan)]
    return {"energy_error": run.energy_error, "momentum_error": max(errors, default=0.0)}


def run_verdict(case: Case, run: MachineRun, blows: Sequence[Blow]) -> Verdict:
    """Return the verdict of a run without its readings, which equals that of all notices of `run_case`."""
    checks = [*balance_notices(balance_of(run, blows)), *count_notices(case, blows)]
    return Verdict.of([*checks, *cushion_notices(case, struck_blows(blows))])


def fast_not_judged(case: Case) -> tuple[str, ...]:
    """Return the checks that the fast engine cannot make: it has no impulse beside the momentum, and no indentation."""
    return ("momentum-balance", *(["cushion-solid"] if case.impact().contact.law == CUSHION else []))


def fast_verdict(case: Case, run: FastTrain) -> Verdict:
    """Return the verdict of a fast run, by the same limits: its blows are counted, and its energy balance is judged."""
    checks = [*balance_notices({"energy_error": run.energy_error}), *count_notices(case, run.blows)]
    return Verdict.of(checks, fast_not_judged(case))


def _odd_blows(case: Case, blows: Sequence[Blow]) -> Iterator[Notice]:
    yield from count_notices(case, blows)
    odd = [f"{blow.index} {blow.kind}" for blow in blows if blow.kind != "full"]
    if odd:
        message = "not every blow is full: " + ", ".join(odd)
        if "double" in [blow.kind for blow in blows]:
            message += "; impulse and blow velocity change of a double blow span its whole pass"
        yield Notice("blow-kind", message, float(len(odd)), 0.0)
    away = [blow for blow in blows if blow.kind == "missed" and blow.largest_displacement > 0.0]
    if away:
        farthest = max(blow.largest_displacement for blow in away)
        message = (
            f"the object was still away, by up to {plain(farthest * 1e3)}\xa0mm, when the strikers of blow "
            f"{', '.join(str(blow.index) for blow in away)} passed: it needs a stiffer spring, more preload, less "
            "friction or a longer interval"
        )
        yield Notice("object-away", message, farthest, 0.0)
    cut = [str(blow.index) for blow in struck_blows(blows) if not blow.width > 0.0]
    if cut:
        message = f"no width: the acceleration stays above 10 % of its peak around blow {', '.join(cut)}"
        yield Notice("pulse-width", message, float(len(cut)), 0.0)


def _yield(case: Case, answers: ContactAnswers | None) -> Iterator[Notice]:
    """Report a contact that passes first yield: the first blow as elastic and as yielding, and its restitution."""
    parts = case.impact()
    yield from low_pressure_notices(parts.striker, parts.contact, struck_material(case))
    if answers is None or answers.first_yield is None:
        return
    elastic, yielding = answers.row(ELASTIC), answers.row(YIELDING)
    if elastic is None or elastic.peak_force <= answers.first_yield:
        return
    asked, limit = answers.asked_restitution, answers.first_yield
    known = ""
    if answers.band is not None:
        low, high = amount(ACCELERATION, answers.band[0]), amount(ACCELERATION, answers.band[1])
        known = f" ({low} to {high} over what is known of the hardness)"
    if answers.taken == YIELDING and yielding is not None:
        if answers.differ:
            message = f"the contact yields: the first blow gives {_peaks(yielding)}{known}; elastic {_peaks(elastic)}"
            yield Notice("contact-yields", message, elastic.peak_force, limit, severity=INFO)
        if asked < 1.0 and yielding.restitution < asked - YIELD_TAKES:
            message = (
                f"damping and yield together give e = {plain(yielding.restitution)} in the first blow, not the "
                f"{asked:g} asked of the damping; where that already stood for what yields, ask for 1"
            )
            yield Notice("restitution-differs", message, yielding.restitution, asked)
        return
    head = f"the contact passes first yield ({force_words(limit)}) and is taken as elastic: the first blow gives"
    advice = f'contact.yield_pressure = "{AUTO}"'
    if yielding is None:
        message = f"{head} {_peaks(elastic)}; give contact.yield_pressure, which these materials do not tell"
    elif answers.differ:
        message = f"{head} {_peaks(elastic)}; {advice} gives {_peaks(yielding)}{known}"
    else:
        message = f"{head} {_peaks(elastic)}, and no more than {percent(answers.spread)} else with {advice}"
    yield Notice("contact-yield", message, elastic.peak_force, limit)


def _peaks(answer: ContactAnswer) -> str:
    """Return the peaks of a first blow in words."""
    return f"{text_of(answer, 'rigid_peak')} and {force_words(answer.peak_force)}"


def _contact(case: Case, struck: Sequence[Blow]) -> Iterator[Notice]:
    """Report where the contact of the blows lies beyond what its law holds for."""
    parts, values = case.impact(), case.values()
    approaches = [blow.approach_speed for blow in struck]
    peak, indentation = max([blow.peak_force for blow in struck]), max([blow.indentation for blow in struck])
    yield from size_notices(case, peak, indentation)
    bodies = material(parts.striker.material), struck_material(case)
    # the first setting that the case states is what makes the speed of the striker
    settings = [f"machine.{field}" for field in kind_of(case).settings if f"machine.{field}" in values]
    stated = f"{settings[0]} = {values[settings[0]].typed}" if settings else "machine"
    yield from speed_notices(bodies, max(approaches), stated)
    launched = case.launched()
    if launched is None or launched.until in (None, "time"):  # rebounds die out below any limit
        yield from damping_speed_notices(parts.contact, approaches)


def _rail(case: Case) -> Iterator[Notice]:
    """Report a rail that holds the object against the spring, away from its stop."""
    if case.launched() is not None or case.object is None:
        return
    o = case.rotary_tables().object
    holds = max(or_else(o.friction, 0.0), or_else(o.stiction, 0.0))
    if holds > o.preload.si:
        message = (
            f"the rail holds with up to {force_words(holds)} what the preload pulls back with "
            f"{force_words(o.preload.si)}: the object need not come back to its stop; give it more preload, or less "
            "friction"
        )
        yield Notice("rail-holds", message, holds, o.preload.si)


def _recorder(case: Case, struck: Sequence[Blow]) -> Iterator[Notice]:
    recorder = case.impact().recorder
    begin = recorder.begin
    end = begin + recorder.memory.si / recorder.sampling_rate.si
    last = struck[-1].time + struck[-1].width
    if end < last:
        lost = len([blow for blow in struck if blow.time + blow.width > end])
        message = (
            f"the recorder's memory ends before {lost} of {len(struck)} blows: give it more memory or a lower rate"
        )
        yield Notice("recorder-memory", message, end, last)
    if begin > struck[0].time:
        message = f"the recorder starts at {plain(begin * 1e3, 4)}\xa0ms, after the first blow: shorten recorder.delay"
        yield Notice("recorder-delay", message, begin, struck[0].time)
    intervals = struck[0].width * recorder.sampling_rate.si
    if intervals < FEWEST_INTERVALS:
        least = FEWEST_INTERVALS / struck[0].width
        message = f"{intervals:.1f} sampling intervals a pulse: {_peak_lost(intervals)}"
        message += f"; give recorder.sampling_rate at least {plain(least / 1e3)}\xa0kHz"
        yield Notice("recorder-rate", message, intervals, FEWEST_INTERVALS)


def _peak_lost(intervals: float) -> str:
    """Return the loss of the peak of a half-sine of so many sampling intervals, in words: 1 - cos(pi/(2 n)) at most."""
    if intervals < 1.0:
        missed = percent(1.0 - intervals, 0)
        return f"{missed} of the pulses fall between two samples, and the others show any part of the peak"
    return f"the recorded peak may be {percent(1.0 - math.cos(0.5 * math.pi / intervals), 1)} low"


def wave_notices(
    case: Case,
    run: MachineRun,
    histories: Sequence[BlowHistory | None],
    readings: Sequence[BlowReading | None],
    bandwidth: float,
) -> tuple[Notice, ...]:
    """Return the notices of the waves: rises of all blows, forces of the first one on a stack."""
    span = next((span for span in run.spans if isinstance(span, StackSpan)), None)
    if span is None or run.machine.layered is None:
        return ()
    stack = run.machine.layered.stack
    first = next(filter(None, readings))
    fronts = [history.front for history in histories if history is not None]
    _, force = span.field()
    largest, least, greatest = field_extremes(stack, span.field_position, force)
    lasting = span.end - span.begin
    return (
        *grid_notices(run.machine.layered.grid),
        *rise_notices(stack, min(contact_rise(span), *fronts), bandwidth, first.total_peak),
        *layer_notices(stack, largest),
        *not_reached_notices(
            stack, build_taps(case), lasting, f"the first blow, followed for {plain(lasting * 1e6, 4)}\xa0us,"
        ),
        *joint_notices(stack, least, greatest),
        *joint_yield_notices(case, greatest.tolist()),
    )


def contact_rise(span: StackSpan) -> float:
    """Return the rise of the contact force of a blow from 10 to 90 % of its peak, s."""
    force = np.concatenate([[0.0], span.history[:, 0]])
    return measure_pulse(force, span.step).rise


def launch_notices(case: Case, seen: Observed, start: Release) -> Iterator[Notice]:
    """Yield the notices of a machine without a drive."""
    yield from start.notices
    machine, touched = case.launched(), seen.run.contacts()
    if machine is None or not len(touched):
        return
    yield from _light_anvil(seen, start)
    if seen.machine.struck.falls:
        fall = -seen.machine.struck.gravity
        message = (
            "rigid peak, width and velocity change are those of a sensor whose zero is taken in the fall, as "
            f"specifications and records mean them: {plain(fall / STANDARD_GRAVITY, 4)}\xa0g above the "
            "acceleration of the object"
        )
        yield Notice("zero-in-fall", message, fall, severity=INFO)
    if seen.machine.rebounds is None:
        message = (
            f"only the first blow is followed, for {plain(machine.follow.si * 1e3)}\xa0ms after first touch "
            "(machine.follow): what rebounds strikes again unless a brake catches it; machine.until = "
            '"rest" follows it'
        )
        yield Notice("first-blow-only", message, machine.follow.si, 0.0, severity=INFO)
    else:
        yield _rebound_notice(seen)
    if touched[-1, 1] >= seen.run.end:
        message = (
            "striker and object still touch at the end: width, velocity change, impulse and rebound are not those of "
            "the whole blow"
        )
        yield Notice("contact-not-over", f"{message}; raise machine.follow", seen.run.end, machine.follow.si)


def cut_notices(case: Case, seen: Observed) -> Iterator[Notice]:
    """Warn of readings that end before the pulse does: their peaks may come later."""
    struck = [reading for reading in seen.readings if reading is not None]
    for channel in seen.view.channels:
        name = channel.sensor.name
        cut = len([reading for reading in struck if reading.sensors[name].cut])
        if not cut:
            continue
        where = f" in {cut} of {len(struck)} blows" if len(struck) > 1 else ""
        advice = f"take a higher sensor.{name}.cutoff" if case.launched() is None else "raise machine.follow"
        message = (
            f"the reading of sensor {name} ends before the pulse does{where}: the peak that is shown is not that of "
            f"the whole pulse; {advice}"
        )
        yield Notice("sensor-cut", message, float(cut), 0.0)


def _light_anvil(seen: Observed, start: Release) -> Iterator[Notice]:
    """Warn where an anvil that nothing holds is not heavy beside what falls on it."""
    anvil, mass = seen.machine.strikers.first, seen.machine.struck.mass
    if start.object == 0.0 or start.striker != 0.0 or anvil.mount_stiffness > 0.0:
        return
    if anvil.mass < HEAVY_ANVIL * mass:
        message = (
            f"the anvil ([striker], {plain(anvil.mass, 4)}\xa0kg) is free and not heavy beside the "
            f"{plain(mass, 4)}\xa0kg that meet it: it is thrown away, and the velocity change is "
            f"{percent(anvil.mass / (anvil.mass + mass), 0)} of that on a fixed one; give its whole mass, or "
            "striker.mount_stiffness to the ground"
        )
        yield Notice("anvil-light", message, anvil.mass, HEAVY_ANVIL * mass)


def _rebound_notice(seen: Observed) -> Notice:
    """Report how following over rebounds ended."""
    run, count = seen.run, len(seen.blows)
    if run.ended == "brake":
        message = f"a brake catches it at the top of its rebound after {count} blows and takes {plain(run.braked)}\xa0J"
        return Notice("brake", message, run.braked, 0.0, severity=INFO)
    if run.ended == "rest":
        limit = REST_SHARE * float(run.contacts()[0, 2])
        message = (
            f"it rests after {count} blows: it comes again with less than {plain(limit)}\xa0m/s, {REST_SHARE:g} of "
            "the first"
        )
        return Notice("rest", message, run.end, limit, severity=INFO)
    message = f"followed for {plain(run.end, 4)}\xa0s and {count} blows: it neither rests nor is it caught by then"
    return Notice("follow-ended", f"{message}; raise machine.longest, or take a time (machine.until)", run.end, run.end)


STANDING_SHARE = 0.02
"""An object stands if its speed is below this share of the nominal approach speed, and lies in place if it is off by
less than this share of the engagement. Chosen: the peak of a blow goes about as its speed, so 2 % of it."""
JUST_BEFORE = 1e-9  # s before first touch at which the object is observed: nothing pushes it yet


def feed_notices(run: MachineRun, blows: Sequence[Blow]) -> Iterator[Notice]:
    """Warn where strikers meet an object that is still fed, or that the feed has thrown off its stop."""
    struck = struck_blows(blows)
    if not struck:
        return
    drive, first, fed = run.machine.drive, struck[0], run.held[0]
    nominal = run.machine.nominal_approach
    before = run.sample(np.array([max(first.time - JUST_BEFORE, 0.0)]))
    forward = -float(before.object_speed[0])
    short = float(before.face_place[0]) + drive.engagement
    moving, away = abs(forward) > STANDING_SHARE * nominal, abs(short) > STANDING_SHARE * drive.engagement
    if first.time < fed and (moving or away):
        more = len([blow for blow in struck if blow.time < fed]) - 1
        where = f"{plain(short * 1e3)}\xa0mm short of its place" if away else "in its place"
        message = (
            f"the first blow{f' and {more} more' if more else ''} meets the object while it is still fed: at first "
            f"touch it is {where} and comes with {plain(forward)}\xa0m/s, and the approach is "
            f"{plain(first.approach_speed)}\xa0m/s instead of {plain(nominal)}\xa0m/s; the feed ends "
            f"{plain((fed - first.time) * 1e3)}\xa0ms later: let it end between two strikers (feed.arrival), or take a "
            "shorter feed.stroke_time"
        )
        yield Notice("struck-while-fed", message, first.time, fed)
    elif moving:
        way = "towards the striker" if forward > 0.0 else "away from the striker"
        message = (
            f"the first blow meets an object that still moves, {plain(abs(forward))}\xa0m/s {way}: the approach is "
            f"{plain(first.approach_speed)}\xa0m/s instead of {plain(nominal)}\xa0m/s; {_why_it_moves(run)}lengthen "
            "feed.stroke_time, raise object.preload, or let it arrive earlier (feed.arrival)"
        )
        yield Notice("first-blow-moving", message, abs(forward), STANDING_SHARE * nominal)


def _why_it_moves(run: MachineRun) -> str:
    """Return in words that the feed is quicker than the preload can follow, if it is; largest slope of (1 - cos)/2."""
    feed, struck = run.machine.drive.feed, run.machine.struck
    largest = 0.5 * math.pi * feed.fastest / (min(feed.acceleration, feed.cushion) * feed.stroke_time)
    held = struck.preload / struck.mass - struck.gravity
    if largest <= held:
        return ""
    return (
        f"the feed speeds up and stops with up to {plain(largest)}\xa0m/s^2, and the preload holds the object on "
        f"its stop only up to {plain(held)}\xa0m/s^2: "
    )
