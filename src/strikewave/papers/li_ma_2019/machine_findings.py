"""Findings on the machine's blow: its direction, what the paper neglects in it, and how it was recorded."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.result import Solution
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.materials import material
from strikewave.base.percents import percent
from strikewave.base.quantities import Value
from strikewave.cases.case import load_case
from strikewave.hopkinson.checks import UNIFORM, transits_to_uniform
from strikewave.papers.li_ma_2019.findings import RIGHT, judged
from strikewave.papers.li_ma_2019.joints import JointStudy, TrainScatter
from strikewave.papers.li_ma_2019.published import STRIKERS, published_number
from strikewave.papers.li_ma_2019.runs import FIXTURE, MACHINE, Runs
from strikewave.papers.li_ma_2019.types import Answer, Finding
from strikewave.sensors import Sensor, read, storage_recorder
from strikewave.uncertainty.statistics import variation

TANGENTIAL = (
    "machine.blow_angle=90 deg",
    "machine.engagement=0.1 mm",
    "machine.face_width=2 mm",
    "feed.stroke=60 mm",
    "feed.blows=1",
)
"""Changes to `MACHINE` that make its blow tangential: along the path of the noses, on a face so narrow that they leave
it at once; the stroke clears them."""
SAME_PEAK = 1e-3
"""Relative miss of a peak at which a speed is found."""
COSTLY = 0.05
"""Share of a peak whose loss matters: by as much measured and simulated peak of Figure 11 differ."""
FULL_SCALE = 5e4 * STANDARD_GRAVITY
"""Of the recorder, m/s^2: the range that the sensors of all cases are assumed to have."""


class TangentialBlow(NamedTuple):
    """A blow along the path of the noses: speed of the turntable (rad/s), approach (m/s), rigid peak (m/s^2)."""

    speed: float
    approach: float
    peak: float


def tangential_blow(speed: float | None = None) -> TangentialBlow:
    """Return the first blow of the machine where it is tangential, at its own or another speed in rad/s."""
    case = load_case(MACHINE, TANGENTIAL)
    if speed is not None:
        case = case.with_values({"machine.speed": Value(si=speed, typed=f"{speed:.9g} rad/s")})
    blow = observe(case).blows[0]
    return TangentialBlow(case.values()["machine.speed"].si, blow.approach_speed, blow.rigid_peak)


def tangential_speed(peak: float) -> TangentialBlow:
    """Return the tangential blow with a rigid peak (m/s^2), found by its speed: both are nearly proportional."""
    blow = tangential_blow()
    while abs(blow.peak / peak - 1.0) > SAME_PEAK:
        blow = tangential_blow(blow.speed * peak / blow.peak)
    return blow


def machine_findings(runs: Runs, joints: JointStudy | None = None) -> tuple[Finding, ...]:
    """Return what the machine's blow says of five statements of the paper.

    Parameters
    ----------
    runs : Runs
    joints : JointStudy, optional
        Where its trains are, the scatter of Figure 13 is also given with joints that chatter.
    """
    return (
        direction(runs.machine),
        spring_force(runs.machine),
        stress_evenness(),
        sampling(runs.machine),
        consistency(runs.fixture, joints.trains if joints else ()),
    )


def direction(machine: Solution) -> Finding:
    """Set the paper's main motion along the blow beside a cam, and a tangential machine beside that."""
    rim = published_number("speed").value * machine.case.values()["machine.radius"].si
    along = machine.blows[0].approach_speed
    across = math.sqrt(rim**2 - along**2)
    fast, slow = tangential_blow(), tangential_speed(published_number("rigid peak").value)
    interval = 2.0 * math.pi / (STRIKERS * slow.speed)
    small = along / published_number("speed").value
    return Finding(
        "main motion of the impact component",
        "also along the impact loading direction",
        "A contradiction: on a massive turntable it cannot hold together with 730 r/min and the measured pulse. On a "
        f"path of {machine.case.values()['machine.radius'].si * 1e3:.0f} mm (assumed) the nose has {rim:.1f} m/s; the "
        f"measured pulse needs {along:.1f} m/s along the blow, so that {across:.1f} m/s go across it, as of a cam. "
        f"Were the blow tangential, along the path, it would come with {fast.approach:.1f} m/s and give "
        f"{_g(fast.peak)}; it gives the measured {_g(slow.peak)} at {slow.speed * 30.0 / math.pi:.0f} r/min, where "
        f"{STRIKERS} components strike every {interval * 1e3:.0f} ms. All hold together only for noses on a circle of "
        f"{small * 1e3:.0f} mm. The radius is not published: it, or a picture of a mark on the struck face, would "
        "decide.",
        "open",
        "section 4.1; li-ma-2019",
    )


def spring_force(machine: Solution) -> Finding:
    """Return what spring, damper and weight take of the blow."""
    blow = machine.blows[0]
    share = abs(blow.support_impulse) / blow.contact_impulse
    return Finding(
        "spring force during the blow",
        "the compression of the spring is limited, so that its force can be neglected",
        f"Spring, damper and weight take {percent(share)} of the impulse of the contact "
        f"({abs(blow.support_impulse):.3f} of {blow.contact_impulse:.2f} N s; their preload and rate are assumed). "
        "Between blows the spring decides: it brings the object back.",
        judged(1.0 + share),
        "section 2.2; li-ma-2019",
    )


def stress_evenness() -> Finding:
    """Return what three to five transits are worth, and what the experiment has of them."""
    most = round(published_number("most transits").value)
    bar = material("65Mn")
    sensor = next(layer for layer in load_case(FIXTURE).stack.layer if layer.name == "sensor")
    steel, transit = material(sensor.material), sensor.length.si / material(sensor.material).bar_speed
    width = published_number("wave width").value
    ratios = [matter.impedance / bar.impedance for matter in (steel, material("2A12"))]
    steps = [transits_to_uniform(ratio) for ratio in ratios]
    slow = transits_to_uniform(ratios[0], 0.5 * width / transit)
    return Finding(
        "stress is even in the specimen after 3 to 5 transits",
        "so the incident wave should last longer than (3 to 5) t₀",
        f"After a step it is: to {percent(UNIFORM, 0)} after {steps[0]:.0f} of 45 steel between 65Mn of equal area, "
        f"after {steps[1]:.0f} of 2A12. Under a straight rise that lasts half of the published {width * 1e6:.0f} µs it "
        f"takes {slow:.0f}. A sensor of {sensor.length.si * 1e3:g} mm (assumed) has t₀ = {transit * 1e6:.2f} µs: the "
        f"pulse lasts {width / transit:.0f} t₀, and its stress is even for most of it. What lasts so long does not "
        "show how a wave passes.",
        "not" if max(steps) > most else "partly" if slow > most else "right",
        "section 3.2; Figure 13",
    )


def lost_between_samples(width: float, rate: float) -> float:
    """Return the share of its peak that a half-sine loses at worst between two samples, 1 - cos(pi/(2 N)), N = T f.

    The peak lies midway between two samples at worst, 1/(2 f) from both.

    Examples
    --------
    >>> round(lost_between_samples(200e-6, 10e3), 3)
    0.293
    """
    return 1.0 - math.cos(0.5 * math.pi / (width * rate))


def costly_rate(width: float) -> float:
    """Return the sampling rate at which a half-sine loses `COSTLY` of its peak at worst, Hz.

    Examples
    --------
    >>> round(lost_between_samples(200e-6, costly_rate(200e-6)), 12)
    0.05
    """
    return 0.5 * math.pi / (width * math.acos(1.0 - COSTLY))


def sampling(machine: Solution) -> Finding:
    """Return what a recorder takes off the rigid pulse."""
    width, recorder = published_number("rigid width").value, storage_recorder(FULL_SCALE)
    times, pulse = (machine.arrays[name].values for name in ("pulse_time", "pulse_acceleration"))
    first = pulse[0] if pulse.ndim > 1 else pulse
    reading = read(Sensor(), recorder, first, float(times[1] - times[0]), float(times[0]))
    kept = float(np.abs(reading.values).max() / np.abs(first).max())
    rate = recorder.sampling_rate
    return Finding(
        "sampling of the built-in recorder",
        "its limited frequency lets the measured curve show the trend alone, and distorts it",
        f"The rate is not published. A half-sine of {width * 1e6:.0f} µs loses {percent(COSTLY, 0)} of its peak "
        f"between samples at worst at {costly_rate(width) / 1e3:.0f} kHz, {percent(lost_between_samples(width, rate))} "
        f"at {rate / 1e3:g} kHz (assumed). With a filter of {recorder.order} poles at {recorder.cutoff / 1e3:g} kHz "
        f"(assumed) such a recorder shows {percent(kept)} of the computed peak. Rate and filter would decide.",
        "open",
        "Figure 11; li-ma-2019",
    )


def consistency(fixture: Solution, trains: tuple[TrainScatter, ...]) -> Finding:
    """Return whether the peaks of the stress-wave test scatter more than those of the rigid pulse."""
    rigid = variation([blow.rigid_peak for blow in fixture.blows if blow.kind != "missed"])
    peaks = [reading.sensors["oscilloscope"].peak for reading in fixture.readings if reading is not None]
    found = (
        f"With joints that hold, the sensor's peaks scatter by {percent(variation(np.abs(peaks)))} over the train, as "
        f"the rigid ones do ({percent(rigid)}): a smooth pulse passes on what comes. "
    )
    verdict: Answer = "open"
    if trains:
        chatter = [one.sensor for one in trains]
        found += (
            f"With joints that chatter, by {percent(min(chatter))} to {percent(max(chatter))} in {len(trains)} pairs "
            "of preload and faces. "
        )
        verdict = "partly" if max(chatter) > RIGHT * rigid else "not"
    else:
        found += "Joints that chatter were not run. "
    found += "Peaks of all blows, not published, would tell."
    return Finding(
        "consistency of the stress-wave pulses", "even worse than that of the rigid ones", found, verdict, "Figure 13"
    )


def _g(acceleration: float) -> str:
    return f"{acceleration / STANDARD_GRAVITY:.0f} g"
