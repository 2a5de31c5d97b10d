"""A run of a machine: from rest to rest, blow after blow, every switch located."""

from __future__ import annotations

import bisect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import IntegrationError
from strikewave.contact._chain_kernels import MASS, OPEN
from strikewave.contact._integrator import Control
from strikewave.contact._law_kernels import DAMPER
from strikewave.contact.law import elastic_indentation, striking_law
from strikewave.contact.motion import MotionState, integrate
from strikewave.machines._kernels import RETRACTING, MachineSystem
from strikewave.machines._layout import FEED_SWITCH, layout_of
from strikewave.machines.drive import braking_time, expected_time, spin_up_time
from strikewave.machines.machine import BEFORE_TOUCH, Launch, Machine, RotaryDrive, energy, machine_system, start_state
from strikewave.machines.spans import ChainSpan, Impulses, Moments, Span, StackSpan, end_at_touch, top_of_flight
from strikewave.machines.strike import strike

Array = NDArray[np.float64]

# In a long flight the error of a step asks for no shorter ones, and DOP853 makes vibrations beyond 5.9 a step grow:
# up to thousands of g of a stiff frame. At 2.5 it takes 2.5e-4 of an amplitude off a step, as 1e-4 of critical
# damping would.
STABLE = 2.5
"""Longest step of a launched machine, in radians of the vibration of its frame."""


@dataclass(frozen=True)
class MachineRun:
    """A run of a machine; time 0 is the valve signal, or just before first touch of a launched machine."""

    machine: Machine
    """Machine that ran."""
    spans: tuple[Span, ...]
    """Spans between valve signal (or launch) and end, one after the other."""
    phases: tuple[tuple[str, float], ...]
    """Name and time of each phase, s."""
    energy_error: float
    """Energy that the balance misses over the energy that flowed."""
    ended: str = ""
    """End of following over rebounds: "rest", "brake", or "" where its time was over."""
    braked: float = 0.0
    """Kinetic energy that a brake took, J."""

    @property
    def end(self) -> float:
        """Time at which the object is back, s."""
        return self.spans[-1].end

    @property
    def held(self) -> tuple[float, float]:
        """Time for which the object was held in the strike position, until the retract command or the end, s."""
        if self.machine.launch is not None:
            return 0.0, self.end
        phases = dict(self.phases)
        return phases["fed"], phases["retract command"]

    @property
    def released(self) -> float:
        """Time at which the object began to move back with the carriage, or the end, s."""
        return dict(self.phases).get("retract", self.end)

    def span_at(self, time: float) -> Span:
        """Return the span at a time; where two meet, the later one."""
        begins = [span.begin for span in self.spans]
        return self.spans[max(bisect.bisect_right(begins, time) - 1, 0)]

    def deepest(self, time: float, striker: int) -> float:
        """Return the depth to which the spot of a striker (from 0) has yielded by a time, m."""
        return self.span_at(time).deepest(time, striker)

    def sample(self, times: Array) -> Moments:
        """Return the moments of the machine at times between 0 and the end, in any order; others raise ValueError."""
        wanted = np.atleast_1d(np.asarray(times, dtype=float))
        if len(self.spans) == 1:
            return self.spans[0].sample(wanted)
        begins = np.array([span.begin for span in self.spans])
        which = np.maximum(np.searchsorted(begins, wanted, side="right") - 1, 0)
        out = Moments(*(np.empty(wanted.size) for _ in Moments._fields))
        for k in np.unique(which):
            here = which == k
            for column, values in zip(out, self.spans[k].sample(wanted[here]), strict=True):
                column[here] = values
        return out

    def contacts(self) -> Array:
        """Return begin, end (s), approach speed (m/s) and striker (from 0) of each contact in order of time."""
        return _contacts(self.spans)

    def switch_times(self, which: int) -> Array:
        """Return when one of the machine's own switches changed, s."""
        rows = np.concatenate([span.switches() for span in self.spans])
        return rows[rows[:, 0] == which, 1]

    def impulses(self, begin: float, end: float) -> Impulses:
        """Return the impulses on the object between two times."""
        parts = [span.impulses(begin, end) for span in self.spans if span.begin < end and span.end > begin]
        return Impulses(*(sum(column) for column in zip(*parts, strict=True)))


def run_machine(
    machine: Machine, tolerance: float = 1e-9, progress: Callable[[float], None] | None = None
) -> MachineRun:
    """Run a machine: one with a drive from rest to rest, one without from just before first touch.

    Spin-up and braking follow closed forms; from the valve signal to the end of the retraction everything
    is integrated together, with every contact, stop, drive limit and feed phase as a located switch. Where
    the object is a stack of layers, each blow is followed by `strike` instead.

    Parameters
    ----------
    machine : Machine
        Machine to run.
    tolerance : float, optional
        Local error of a step over the scales of one contact.
    progress : callable, optional
        Called with the share of the expected time done, 0 to 1.

    Raises
    ------
    IntegrationError
        If the motion cannot be followed, or the turntable comes to a stand among the blows.
    ValueError
        If the drive cannot hold the set speed.
    """
    contacts = [striker.contact for striker in machine.strikers.each]
    if machine.layered is not None and any(striking_law(contact)[DAMPER] for contact in contacts):
        raise ValueError("a machine's striker takes a contact with hysteresis, not with a damper")
    system = machine_system(machine)
    at = layout_of(system)
    start = state = start_state(machine, system)
    approach = machine.nominal_approach
    expected, longest = _pace(machine)
    depth = elastic_indentation(machine.strikers.first.contact, machine.struck.nose_mass, approach)
    scale = np.full(start.y.size, 0.5 * machine.struck.mass * approach**2)
    scale[at.positions], scale[at.speeds] = depth, approach
    scale[[at.angle, at.belt_twist]] = depth / machine.radius
    scale[[at.turntable_speed, at.motor_speed]] = approach / machine.radius
    # thrice the expected time: a turntable that stalls ends the run there
    control = Control(tolerance, scale, 2e-3 * depth / approach, longest, 3.0 * expected)
    report = None if progress is None else (lambda t: progress(min(t / expected, 1.0)))
    spans: list[Span] = []
    sizes = len(system.chain.joins) + at.contacts.stop, at.switches  # behind the links stand the side forces
    rebounds, ended, braked = machine.rebounds, "", 0.0
    while True:
        motion = integrate(system, state, control, sizes, report)
        if motion.changes.time.size:  # none where the next striker touches at once
            spans.append(ChainSpan(machine.struck, at, motion))
        before, state = state, motion.end
        if state.mode[at.edge]:
            striker, x = int(state.mode[at.edge]), state.y[at.positions]
            raise IntegrationError(
                f"at {state.time:.4g} s striker {striker} met the edge of the face "
                f"{float(x[striker - 1] - x[at.nose]) * 1e3:.3g} mm behind it: make machine.face_width "
                f"({machine.drive.face_width * 1e3:.4g} mm) larger, or machine.engagement "
                f"({machine.engagement * 1e3:.4g} mm) smaller; or the object has not come back yet"
            )
        untouched = not np.any(state.mode[at.contacts] != OPEN)
        if (machine.layered is None and rebounds is None) or untouched or state.time >= control.end:
            break
        if rebounds is not None:
            if state.time >= expected:
                break
            ended = end_at_touch(rebounds, _contacts(spans), state.time, float(state.memory[at.contacts][0]))
            if ended == "brake":
                flying = spans[-1]
                assert isinstance(flying, ChainSpan)
                top = top_of_flight(flying, float(_contacts(spans)[-1, 1]))
                flight = integrate(system, before, control._replace(end=top), sizes)
                spans[-1] = ChainSpan(machine.struck, at, flight)
                state, braked = _caught(machine.start, system, flight.end)
            if ended:
                break
        if machine.layered is None:
            continue
        first = not any(isinstance(span, StackSpan) for span in spans)
        blow, state = strike(machine.layered, machine.struck, system, state, field=first)
        spans.append(blow)
        if machine.launch is not None and state.time >= expected:
            break
    finished = state.mode[at.feed] == RETRACTING and state.time < control.end
    if machine.launch is None and not finished:
        done = int(state.mode[at.passes])
        raise IntegrationError(
            f"after {state.time:.3g} s only {done} of {machine.drive.feed.blows} passes were made and the turntable "
            f"turns at {state.y[at.turntable_speed]:.3g} rad/s: give it more inertia or torque, or less engagement"
        )
    dissipated, (driven, dragged, fed, rubbed) = state.y[at.dissipated], state.y[at.of_drive]
    gained = energy(system, state) - energy(system, start)
    flowed = abs(driven) + dragged + rubbed + np.abs(dissipated).sum() + braked
    if machine.launch is not None:
        flowed += 0.5 * float(system.chain.bodies[:, MASS] @ start.y[at.speeds] ** 2)
    missing = gained - (driven - dragged - rubbed - dissipated.sum() - braked + fed)
    run = MachineRun(machine, tuple(spans), (), float(abs(missing) / flowed), ended, braked)
    last_speed = float(state.y[at.turntable_speed])
    return replace(run, phases=_phases(run, last_speed))


def _contacts(spans: Sequence[Span]) -> Array:
    """Return the contacts of some spans; see `MachineRun.contacts`."""
    rows = np.concatenate([span.contacts() for span in spans])
    return np.asarray(rows[np.argsort(rows[:, 0], kind="stable")])


def _caught(launch: Launch | RotaryDrive, system: MachineSystem, state: MotionState) -> tuple[MotionState, float]:
    """Return a state in which the launched bodies stand still, and the kinetic energy that the brake took, J."""
    at, moving = layout_of(system), energy(system, state)
    stopped = state._replace(y=state.y.copy())
    if isinstance(launch, Launch):
        speeds = stopped.y[at.speeds]
        if launch.object_speed:
            speeds[at.object] = 0.0
        if launch.striker_speed:
            speeds[at.strikers] = 0.0
        if launch.arm is not None:
            speeds[at.strikers] = stopped.y[at.turntable_speed] = 0.0
    return stopped, moving - energy(system, stopped)


def _pace(machine: Machine) -> tuple[float, float]:
    """Return the expected time of a run, and its longest step, s."""
    if isinstance(machine.start, Launch):
        lasting = BEFORE_TOUCH + machine.start.follow
        return lasting, min(0.02 * lasting, STABLE / (2.0 * math.pi * machine.struck.frame_frequency))
    pitch_time = machine.pitch / machine.start.turntable.speed
    return expected_time(machine.start.feed, pitch_time), 0.02 * pitch_time  # fifty a pitch: no touch is stepped over


def _phases(run: MachineRun, last_speed: float) -> tuple[tuple[str, float], ...]:
    """Return name and time of each phase."""
    start, touched = run.machine.start, run.contacts()
    if isinstance(start, Launch):
        touch = [("blows", float(touched[0, 0]))] if len(touched) else []
        how = [(run.ended, run.end)] if run.ended else []
        return (("release", -start.travel), *touch, *how, ("end", run.end))
    disc, feed = start.turntable, start.feed
    times = run.switch_times(FEED_SWITCH)  # feed, fed, perhaps the end of the hold, retract, back
    at_speed = -feed.wait
    named = [
        ("spin-up", at_speed - spin_up_time(disc)),
        ("at speed", at_speed),
        ("valve signal", 0.0),
        ("feed", float(times[0])),
        ("fed", float(times[1])),
        ("retract command", float(times[-2]) - feed.release_delay),
        ("retract", float(times[-2])),
        ("brake", run.end),
        ("stopped", run.end + braking_time(disc, last_speed)),
    ]
    if len(touched):
        named.append(("blows", float(touched[0, 0])))
    return tuple(sorted(named, key=lambda item: item[1]))
