"""The closing table: what Li & Ma 2019 get right, and what not, each with the computed numbers that show it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from strikewave.analyses.machine.observe import observe
from strikewave.analyses.machine.result import Solution
from strikewave.base import declare
from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.base.quantities import Value
from strikewave.base.texts import percent
from strikewave.cases.case import load_case
from strikewave.hopkinson.checks import UNIFORM, transits_to_uniform
from strikewave.papers.li_ma_2019.element_pulses import ElementNumbers
from strikewave.papers.li_ma_2019.equations import ContactExample, EquationRow, WaveExample, delivered, mean_over_rigid
from strikewave.papers.li_ma_2019.published import STRIKERS, Consistency, nose, published_number
from strikewave.papers.li_ma_2019.runs import FIXTURE, MACHINE, Runs
from strikewave.papers.li_ma_2019.unknowns import JointStudy, TrainScatter
from strikewave.sensors import Sensor, read, storage_recorder
from strikewave.uncertainty.statistics import variation

SAME = 1.0 + 1e-6
"""Factor up to which two computations of a number are the same: above what integration leaves."""
EXACT = 1.001
"""Factor up to which a formula does what it is derived for. Chosen: a thousandth, less than any use of it feels."""
RIGHT, PARTLY = 1.1, 1.5
"""Factors, up or down, up to which a prediction is right, and partly right. Chosen: a tenth is the paper's good
consistency of its simulation (peak +5 %, width +10 %)."""
RESOLVED = 3.0
"""Elements over the half width of a contact that resolve its pressure, an ellipse: fewer make steps of it."""
LINE = ContactExample().contact_length
"""Contact length of the example of (4), m; assumed."""

QUIET, REFLECTING, ELASTIC, WAVE = "quiet", "reflecting", "elastic", "wave"
"""Element runs: Figure 11 with the paper's non-reflecting faces, without, with them and without yield; Figure 15 with
them."""
NOT_RUN = "The finite elements that would answer this were not run."
"""Sentence of a finding whose runs were left out."""

Verdict = Literal["right", "partly", "not", "open"]


@declare.dataclass
class Finding:
    """A line of the closing table: what the paper gets right, and what not."""

    topic: str = declare.word("what it is about")
    paper: str = declare.word("what the paper says")
    found: str = declare.word("what we find, with its numbers")
    verdict: Verdict = declare.word("right, partly, not; open where what decides it is not published, or was not run")
    shown_by: str = declare.word("equations, figures or cases that show it")
    ours: bool = declare.word("whether the point is ours: the paper makes no statement of it", default=False)


Rows = Mapping[str, EquationRow]
ElementRuns = Mapping[str, ElementNumbers | None]


def findings(
    equations: Sequence[EquationRow],
    checks: Sequence[Consistency],
    elements: ElementRuns | None = None,
    sensors: tuple[float, float] | None = None,
) -> tuple[Finding, ...]:
    """Return what the paper gets right, and what not.

    ``elements`` are by `QUIET`, `REFLECTING`, `ELASTIC` and `WAVE`; one that is left out or None was not run.
    ``sensors`` is the peak of the direct sensor over that of the buffered one: smallest and largest over gaskets.
    """
    rows = {row.number: row for row in equations}
    run = elements or {}
    return (
        *_contact(rows, checks),
        *_waves(rows, checks),
        _sensors(checks, sensors),
        *_experiments(checks),
        _mesh(checks),
        _faces(run.get(QUIET), run.get(REFLECTING)),
        _slopes(run.get(QUIET), run.get(ELASTIC)),
        _yielding(run.get(QUIET), run.get(REFLECTING)),
        _specimen(run.get(WAVE)),
    )


def judged(ratio: float, right: float = RIGHT, partly: float = PARTLY) -> Verdict:
    """Return right, partly or not for a ratio of a statement to the truth: within a factor, up or down."""
    factor = max(ratio, 1.0 / ratio) if ratio > 0.0 else math.inf
    return "right" if factor <= right else "partly" if factor <= partly else "not"


def _worst(rows: Rows, *numbers: str) -> float:
    """Return the largest deviation of printed values."""
    return max(abs(rows[number].deviation or 0.0) for number in numbers)


def _value(row: EquationRow, column: str) -> float:
    """Return a number of a row."""
    value = getattr(row, column)
    if value is None:
        raise ValueError(f"equation {row.number} has no {column} value")
    return float(value)


def _check(checks: Sequence[Consistency], quantity: str, used: str) -> Consistency:
    """Return the check of a quantity that rests on a published number."""
    for check in checks:
        if check.quantity == quantity and used in check.uses:
            return check
    raise ValueError(f"no check of the {quantity} uses {used!r}")


def _contact(rows: Rows, checks: Sequence[Consistency]) -> tuple[Finding, ...]:
    balances = ("(6)", "(7)", "(8)", "(9)", "(10)", "(11)", "(17)", "(18)", "(21)", "(22)")
    deviation = _worst(rows, "(1)", *balances)
    before, after, loss = (rows[number].deviation or 0.0 for number in ("(12)", "(13)", "(16)"))
    low, high = delivered(0.1), delivered(0.9)
    stiffness = _value(rows["(4)"], "printed")
    needed = _check(checks, "K, for a heavy striker", "force simulated").value
    return (
        Finding(
            "form of the contact force, balances of energy and momentum",
            "an elastic and a damping force; what is lost is the work of damping",
            f"Right to {deviation:.0e}, against both bodies integrated in time.",
            judged(1.0 + deviation, SAME),
            "(1), " + ", ".join(balances),
        ),
        Finding(
            "stiffness of the line contact",
            "Palmgren's formula with the equivalent modulus of (5)",
            f"An empirical rule, without the radius. (5) is upside down: {_value(rows['(5)'], 'printed'):.3g} 1/Pa "
            f"where {_value(rows['(5)'], 'corrected_value'):.4g} Pa is meant.",
            "right" if rows["(5)"].verdict == "right" else "partly",
            "(2) to (5)",
        ),
        Finding(
            "energy lost by damping",
            "the speed over the depth is that of a linear spring, the integral 3/10",
            f"{percent(before, 1, '+')} on the way in, {percent(after, 1, '+')} on the way out, "
            f"{percent(loss, 1, '+')} in all.",
            judged(1.0 + loss, EXACT),
            "(12) to (16), (19), (20), (23)",
        ),
        Finding(
            "restitution",
            "the damping of (24) gives the restitution that is asked for",
            f"Asked for {_value(rows['(25)'], 'exact'):.3g} it gives {_value(rows['(25)'], 'printed'):.4f}; asked for "
            f"{low.asked:g} {low.printed:.4f}, for {high.asked:g} {high.printed:.4f}, whatever masses, speed and "
            "stiffness are. An estimate, good near 1; a damping that gives what is asked for is known.",
            judged(min(1.0 + (rows["(25)"].deviation or 0.0), low.printed / low.asked), EXACT),
            "(24), (25)",
        ),
        Finding(
            "force of the machine's blow from the contact alone",
            "(25) establishes the rigid-body acceleration",
            f"The simulated force and width need K = {needed:.3g} N/m^(10/9) at most; (4) gives {stiffness:.3g} for a "
            f"line of {LINE * 1e3:g} mm (assumed), {stiffness / needed:.0f} times that. A line that gave it would be "
            f"{LINE * (needed / stiffness) ** (9.0 / 8.0) * 1e3:.1f} mm long.",
            judged(stiffness / needed),
            "(4), (25); li-ma-2019",
        ),
    )


def _waves(rows: Rows, checks: Sequence[Consistency]) -> tuple[Finding, ...]:
    shares = _worst(rows, "(26)", "(27)", "(29)", "(31)", "(39)")
    echo, again = (_value(rows[n], "printed") / _value(rows[n], "exact") for n in ("(30)", "(33)"))
    late, fast = (rows[number].deviation or 0.0 for number in ("(36)", "(40)"))
    matched = _check(checks, "F_II, equal areas", "45 steel density").value
    ratio = mean_over_rigid(WaveExample())
    return (
        Finding(
            "transmission, reflection and speed of waves",
            "from impedances times areas; c = √(E/ρ)",
            f"Right to {shares:.0e}, against delay lines; c for waves far longer than the bar is thick.",
            judged(1.0 + shares, SAME),
            "(26), (27), (29), (31), (39)",
        ),
        Finding(
            "arrival of echoes",
            "after t_(l−x), and every t₀ from then on",
            f"In the example the first echo is taken to come after {echo:.2f} of its time, the next after {again:.2f}; "
            f"the largest strain of a pulse of two transits is off by {percent(late, 0, '+')}. Amplitudes, and what a "
            "long load settles to, are right.",
            judged(min(echo, again), EXACT),
            "(30), (32) to (36)",
        ),
        Finding(
            "acceleration from strain",
            "v = c ε for the sum of all waves",
            f"True of forward waves only. Under a slow pulse {fast + 1.0:.2f} times the acceleration between bars of "
            f"another impedance; a free end at {_value(rows['(38)'], 'printed'):.1f} instead of "
            f"{_value(rows['(38)'], 'exact'):.2f} m/s.",
            judged(1.0 + fast, EXACT),
            "(38), (40)",
        ),
        Finding(
            "experiment on stress waves as a test of the model",
            "verifies the model of (26) to (40)",
            f"If the areas are equal, which is not said, cylinders and sensor reflect {matched:.1e} of a wave: then no "
            "echo of the model takes part, and neither it nor its errors are tested.",
            "open",
            "(31); Table 2",
        ),
        Finding(
            "rigid-body and wave acceleration as parts of the total",
            "two parts that are superposed",
            "By Newton's law the wave's mean over the specimen is its net force over its mass "
            f"(here {ratio:.4f} of it): it holds the rigid-body acceleration already, and adding that counts it twice. "
            "Taken apart as mean and remainder they are useful.",
            "partly",
            "(40); sections 3.1, 3.2",
        ),
    )


def _sensors(checks: Sequence[Consistency], modelled: tuple[float, float] | None) -> Finding:
    """Return the finding on two sensors on one body."""
    measured = _check(checks, "ratio of the peaks", "direct peak").value
    model = ""
    if modelled is not None:
        low, high = modelled
        model = " Over gaskets that calm the pulse as theirs does, our model of both mounts gives "
        model += f"{low:.2f} to {high:.2f} : 1"
        model += ", which holds the measured ratio" if low <= measured <= high else ""
        model += ": what the gasket passes, measured on a shaker or a bar, would decide."
    return Finding(
        "a sensor reads more than the rigid body's acceleration",
        "rigid-body dynamics alone does not describe a sensor that is mounted directly",
        f"Two sensors on one body read {measured:.2f} : 1, as two fixed to a rigid body would not. That waves are why "
        f"does not follow: a gasket filters a rigid body's pulse too.{model}",
        "not" if judged(measured) == "right" else "partly",
        "Figure 5; li-ma-2019-fig5",
    )


def _experiments(checks: Sequence[Consistency]) -> tuple[Finding, ...]:
    simulated = _check(checks, "ratio of the peaks", "rigid peak simulated").value
    width = published_number("rigid width simulated").value / published_number("rigid width").value
    larger = _check(checks, "ratio of the peaks", "peak ratio")
    rigid, wave = (_check(checks, "velocity change", used).value for used in ("rigid peak", "wave peak"))
    stated = published_number("peak ratio").value
    return (
        Finding(
            "simulated and measured rigid-body pulse",
            "good consistency",
            f"Peaks {percent(simulated - 1.0, 1, '+')}, widths {percent(width - 1.0, 1, '+')}, so half-sines of them "
            f"differ by {percent(simulated * width - 1.0, 1, '+')} in impulse. Neither the error of the measurement "
            "nor how widths were read is said: what would be good is open.",
            "open",
            "Figure 11",
        ),
        Finding(
            "peak with stress waves over that without",
            f"about {stated:g} times",
            f"{larger.value:.2f} times by the paper's own numbers.",
            judged(larger.value / stated),
            "Figures 11, 13",
        ),
        Finding(
            "peak and width of the stress-wave pulse",
            "gives 21 909.89 g and 252 µs side by side; of their shape it says nothing",
            f"A half-sine of both would change the speed by {wave:.1f} m/s, {wave / rigid:.1f} times what one of the "
            "measured peak and width of Figure 11 does. If the blow is the same, the peak is that of something shorter "
            "than 252 µs.",
            "open",
            "Figure 13; li-ma-2019-fig13-bar",
            ours=True,
        ),
    )


def _mesh(checks: Sequence[Consistency]) -> Finding:
    """Return whether the elements resolve the contact."""
    half = _check(checks, "half width of an elastic contact", "smallest element").value
    element = published_number("smallest element").value
    radius, length = nose()
    return Finding(
        "mesh of the contact",
        f"refined there, smallest elements of {element * 1e3:g} mm; of the width of the contact it says nothing",
        f"For a nose of {radius * 1e3:g} mm and a line of {length * 1e3:.1f} mm (both of our case, not published) the "
        f"elastic contact is {half * 1e3:.2f} mm wide to either side: {half / element:.1f} elements, where pressures "
        f"take some {RESOLVED:g}. Forces need fewer: see the meshes.",
        "right" if half >= RESOLVED * element else "partly",
        "Figure 10; li-ma-2019-fem-rigid",
        ours=True,
    )


def _faces(quiet: ElementNumbers | None, reflecting: ElementNumbers | None) -> Finding:
    """Return the effect of non-reflecting faces on the blow, judged by the momentum that the body keeps."""
    topic, paper = "non-reflecting faces on the struck body", "they keep reflected waves off the result"
    shown = "li-ma-2019-fem-rigid-quiet, li-ma-2019-fem-rigid"
    if quiet is None or quiet.impulse is None or quiet.momentum is None:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    share = quiet.momentum / quiet.impulse
    effects = [f"they hold the body, which keeps {percent(share, 0)} of the impulse"]
    if reflecting is not None:
        pairs = (
            ("impulse", quiet.impulse, reflecting.impulse, 1.0, ".2f", "N s"),
            ("rigid-body peak", quiet.rigid_peak, reflecting.rigid_peak, STANDARD_GRAVITY, ".0f", "g"),
            ("force", quiet.peak_force, reflecting.peak_force, 1e3, ".2f", "kN"),
        )
        effects += [
            f"{what} {held / scale:{form}} {unit} with them, {free / scale:{form}} {unit} without"
            for what, held, free, scale, form, unit in pairs
            if held is not None and free is not None
        ]
    text = "; ".join(effects) + "."
    return Finding(topic, paper, text[0].upper() + text[1:], judged(share), shown)


def _slopes(run: ElementNumbers | None, elastic: ElementNumbers | None) -> Finding:
    """Return the rise of the pulse with and without yielding; for the paper's own bodies it stays open."""
    topic = "slope of the pulse"
    paper = "small while the contact is elastic, growing quickly once it is plastic"
    shown = "Figure 11; li-ma-2019-fem-rigid-quiet"
    if run is None or run.slope_early is None or run.slope_late is None:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    rise = "{:.3g} kN/µs from 10 to 30 % of the peak and {:.3g} from 50 to 90 %"
    result = f"In our frame the force rises by {rise.format(run.slope_early / 1e9, run.slope_late / 1e9)}; "
    if elastic is None or elastic.slope_early is None or elastic.slope_late is None:
        result += "without yield it was not run"
    else:
        steeper = run.slope_late / run.slope_early > RIGHT * elastic.slope_late / elastic.slope_early
        result += f"without yield by {rise.format(elastic.slope_early / 1e9, elastic.slope_late / 1e9)}: yielding "
        result += f"makes it {'' if steeper else 'no '}steeper"
    why = (
        "That is of a frame that rings and bends; no dimension is published, so that the paper's own bodies stay open."
    )
    return Finding(topic, paper, f"{result}. {why}", "open", shown)


def _yielding(quiet: ElementNumbers | None, reflecting: ElementNumbers | None) -> Finding:
    """Return whether bodies yield, and how far."""
    topic, paper = "yielding", "slight plastic deformation of striker and frame, almost none of the shell"
    shown = "li-ma-2019-fem-rigid-quiet, li-ma-2019-fem-rigid"
    runs = [(faces, run) for faces, run in (("with", quiet), ("without", reflecting)) if run is not None]
    strains = [(faces, run.plastic_strain) for faces, run in runs if run.plastic_strain is not None]
    stresses = [(faces, run.shell_stress) for faces, run in runs if run.shell_stress is not None]
    if not strains:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    result = (
        f"Largest plastic strain {', '.join(f'{percent(strain, 2)} {faces}' for faces, strain in strains)} "
        "non-reflecting faces"
    )
    result += "; it depends on the mesh and on the slope beyond yield, which is assumed."
    if stresses:
        bears = ", ".join(f"{stress / 1e6:.0f} MPa {faces}" for faces, stress in stresses)
        limit = published_number("2A12 yield strength").value
        result += f" The shell, taken as elastic, bears {bears}; it would yield at {limit / 1e6:.0f} MPa."
    return Finding(topic, paper, result, "partly" if max(strain for _, strain in strains) > 0.0 else "not", shown)


def _specimen(run: ElementNumbers | None) -> Finding:
    """Compare the specimen's mean acceleration with the simulated one; assumed shapes make it partly right at best."""
    topic, shown = "mean acceleration of the specimen between two cylinders", "Figure 15; li-ma-2019-fem-wave-quiet"
    printed, force = (published_number(name).value for name in ("wave peak simulated", "force simulated"))
    paper = f"{_g(printed)} in its finite elements, with non-reflecting faces"
    if run is None or run.mean_peak is None:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    result = f"{_g(run.mean_peak)}, mean of the part, with such faces"
    if run.section_peak is not None:
        result += f"; {_g(run.section_peak)} in its mid section"
    if run.peak_force is not None:
        result += (
            f"; under a force of {run.peak_force / 1e3:.1f} kN, where the paper has {force / 1e3:.1f} kN on the same "
        )
        result += "frame at the same speed"
    result = f"{result}. It moves by some per cent with the mesh; shape and joints are assumed."
    return Finding(topic, paper, result, "not" if judged(run.mean_peak / printed) == "not" else "partly", shown)


def _g(acceleration: float) -> str:
    return f"{acceleration / STANDARD_GRAVITY:.0f} g"


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
"""Relative miss of a peak at which a speed is accepted: below the digits that a sentence shows."""
COSTLY = 0.05
"""Share of a peak whose loss matters: the difference of measured and simulated peak of Figure 11."""
FULL_SCALE = 5e4 * STANDARD_GRAVITY
"""Full scale of the recorder, m/s^2: the assumed range of the sensors of all cases."""


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
    # peak and speed are nearly proportional: a few steps meet it
    while abs(blow.peak / peak - 1.0) > SAME_PEAK:
        blow = tangential_blow(blow.speed * peak / blow.peak)
    return blow


def machine_findings(runs: Runs, joints: JointStudy | None = None) -> tuple[Finding, ...]:
    """Return the findings from the machine's blow; trains of ``joints`` add the scatter of chatter."""
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
    """Return the share of spring, damper and weight in the blow."""
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
    """Return the transits until stress is even, in theory and in the experiment."""
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
    """
    return 1.0 - math.cos(0.5 * math.pi / (width * rate))


def costly_rate(width: float) -> float:
    """Return the sampling rate at which a half-sine loses `COSTLY` of its peak at worst, Hz."""
    return 0.5 * math.pi / (width * math.acos(1.0 - COSTLY))


def sampling(machine: Solution) -> Finding:
    """Return the loss of the rigid pulse in a recorder."""
    width, recorder = published_number("rigid width").value, storage_recorder(FULL_SCALE)
    times, pulse = (machine.arrays[name].values for name in ("pulse_time", "pulse_acceleration"))
    # a row is a blow
    first = pulse[0] if pulse.ndim > 1 else pulse
    reading = read(Sensor(), recorder, first, float(times[1] - times[0]), float(times[0]))
    share = float(np.abs(reading.values).max() / np.abs(first).max())
    rate = recorder.sampling_rate
    return Finding(
        "sampling of the built-in recorder",
        "its limited frequency lets the measured curve show the trend alone, and distorts it",
        f"The rate is not published. A half-sine of {width * 1e6:.0f} µs loses {percent(COSTLY, 0)} of its peak "
        f"between samples at worst at {costly_rate(width) / 1e3:.0f} kHz, {percent(lost_between_samples(width, rate))} "
        f"at {rate / 1e3:g} kHz (assumed). With a filter of {recorder.order} poles at {recorder.cutoff / 1e3:g} kHz "
        f"(assumed) such a recorder shows {percent(share)} of the computed peak. Rate and filter would decide.",
        "open",
        "Figure 11; li-ma-2019",
    )


def consistency(fixture: Solution, trains: tuple[TrainScatter, ...]) -> Finding:
    """Return whether the peaks of the stress-wave test scatter more than those of the rigid pulse."""
    rigid = variation([blow.rigid_peak for blow in fixture.blows if blow.kind != "missed"])
    peaks = [reading.sensors["oscilloscope"].peak for reading in fixture.readings if reading is not None]
    text = (
        f"With joints that hold, the sensor's peaks scatter by {percent(variation(np.abs(peaks)))} over the train, as "
        f"the rigid ones do ({percent(rigid)}): a smooth pulse passes on what comes. "
    )
    verdict: Verdict = "open"
    if trains:
        chatter = [train.sensor for train in trains]
        text += (
            f"With joints that chatter, by {percent(min(chatter))} to {percent(max(chatter))} in {len(trains)} pairs "
            "of preload and faces. "
        )
        verdict = "partly" if max(chatter) > RIGHT * rigid else "not"
    else:
        text += "Joints that chatter were not run. "
    text += "Peaks of all blows, not published, would tell."
    return Finding(
        "consistency of the stress-wave pulses", "even worse than that of the rigid ones", text, verdict, "Figure 13"
    )
