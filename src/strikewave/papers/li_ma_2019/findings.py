"""The closing table: what Li & Ma 2019 get right, and what not, each with the computed numbers that show it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.percents import percent
from strikewave.papers.li_ma_2019.contact_equations import delivered
from strikewave.papers.li_ma_2019.examples import ContactExample, WaveExample
from strikewave.papers.li_ma_2019.published import nose, published_number
from strikewave.papers.li_ma_2019.types import Answer, Consistency, ElementNumbers, EquationRow, Finding
from strikewave.papers.li_ma_2019.wave_equations import mean_over_rigid

SAME = 1.0 + 1e-6
"""Factor up to which two computations of a number are the same: above what integration leaves."""
EXACT = 1.001
"""Factor up to which a formula does what it is derived for. Chosen: a thousandth, less than any use of it feels."""
RIGHT, PARTLY = 1.1, 1.5
"""Factors, up or down, up to which a prediction is right, and partly right. Chosen: a tenth is what the paper calls
good consistency of its simulation (peak +5 %, width +10 %)."""
RESOLVED = 3.0
"""Elements over the half width of a contact that resolve its pressure, an ellipse: fewer make steps of it."""
LINE = ContactExample().contact_length
"""Of the example of (4), m; assumed."""

QUIET, REFLECTING, ELASTIC, WAVE = "quiet", "reflecting", "elastic", "wave"
"""Runs of finite elements: Figure 11 with the paper's non-reflecting faces, without, with them and without yielding;
Figure 15 with them.
"""
NOT_RUN = "The finite elements that would answer this were not run."
"""Sentence of a finding whose runs were left out."""

Rows = Mapping[str, EquationRow]
Runs = Mapping[str, ElementNumbers | None]


def findings(
    equations: Sequence[EquationRow],
    checks: Sequence[Consistency],
    elements: Runs | None = None,
    sensors: tuple[float, float] | None = None,
) -> tuple[Finding, ...]:
    """Return what the paper gets right, and what not.

    Parameters
    ----------
    equations : sequence of EquationRow
        As `equation_rows` computes them.
    checks : sequence of Consistency
        As `consistency_checks` computes them.
    elements : mapping of str to ElementNumbers, optional
        By `QUIET`, `REFLECTING`, `ELASTIC` and `WAVE`; what is left out or None was not run.
    sensors : tuple of float, optional
        Peak of the direct sensor over that of the buffered one: smallest and largest over gaskets.

    Examples
    --------
    >>> from strikewave.papers.li_ma_2019.equations import equation_rows
    >>> from strikewave.papers.li_ma_2019.published import consistency_checks
    >>> table = findings(equation_rows(), consistency_checks())
    >>> [row.verdict for row in table if row.topic == "restitution"]
    ['partly']
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


def judged(ratio: float, right: float = RIGHT, partly: float = PARTLY) -> Answer:
    """Return right, partly or not for what a statement gives over what is true: within a factor, up or down.

    Examples
    --------
    >>> judged(1.05), judged(1 / 1.4), judged(0.5), judged(0.0)
    ('right', 'partly', 'not', 'not')
    """
    factor = max(ratio, 1.0 / ratio) if ratio > 0.0 else math.inf
    return "right" if factor <= right else "partly" if factor <= partly else "not"


def _worst(rows: Rows, *numbers: str) -> float:
    """Return the largest deviation of printed values."""
    return max(abs(rows[number].deviation or 0.0) for number in numbers)


def _value(row: EquationRow, column: str) -> float:
    """Return a number of a row.

    Raises
    ------
    ValueError
        If the row does not have it.
    """
    value = getattr(row, column)
    if value is None:
        raise ValueError(f"equation {row.number} has no {column} value")
    return float(value)


def _check(checks: Sequence[Consistency], quantity: str, used: str) -> Consistency:
    """Return the check of a quantity that rests on a published number.

    Raises
    ------
    ValueError
        If there is none.
    """
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
    """Return what non-reflecting faces do to the blow: the momentum that the body keeps decides."""
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
            f"{what} {one / scale:{form}} {unit} with them, {other / scale:{form}} {unit} without"
            for what, one, other, scale, form, unit in pairs
            if one is not None and other is not None
        ]
    return Finding(topic, paper, _sentence("; ".join(effects) + "."), judged(share), shown)


def _slopes(run: ElementNumbers | None, elastic: ElementNumbers | None) -> Finding:
    """Return how the pulse rises, with and without yielding; what the paper's own bodies do stays open."""
    topic = "slope of the pulse"
    paper = "small while the contact is elastic, growing quickly once it is plastic"
    shown = "Figure 11; li-ma-2019-fem-rigid-quiet"
    slopes, unyielding = _rise(run), _rise(elastic)
    if slopes is None:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    result = f"In our frame the force rises by {_in_words(*slopes)}; "
    if unyielding is None:
        result += "without yield it was not run"
    else:
        steeper = slopes[1] / slopes[0] > RIGHT * unyielding[1] / unyielding[0]
        result += f"without yield by {_in_words(*unyielding)}: yielding makes it {'' if steeper else 'no '}steeper"
    why = (
        "That is of a frame that rings and bends; no dimension is published, so that the paper's own bodies stay open."
    )
    return Finding(topic, paper, f"{result}. {why}", "open", shown)


def _rise(run: ElementNumbers | None) -> tuple[float, float] | None:
    """Return both slopes of the rise, N/s."""
    if run is None or run.slope_early is None or run.slope_late is None:
        return None
    return run.slope_early, run.slope_late


def _in_words(early: float, late: float) -> str:
    return f"{early / 1e9:.3g} kN/µs from 10 to 30 % of the peak and {late / 1e9:.3g} from 50 to 90 %"


def _yielding(quiet: ElementNumbers | None, reflecting: ElementNumbers | None) -> Finding:
    """Return whether bodies yield, and how far."""
    topic, paper = "yielding", "slight plastic deformation of striker and frame, almost none of the shell"
    shown = "li-ma-2019-fem-rigid-quiet, li-ma-2019-fem-rigid"
    runs = [(words, run) for words, run in (("with", quiet), ("without", reflecting)) if run is not None]
    strains = [(words, run.plastic_strain) for words, run in runs if run.plastic_strain is not None]
    stresses = [(words, run.shell_stress) for words, run in runs if run.shell_stress is not None]
    if not strains:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    result = (
        f"Largest plastic strain {', '.join(f'{percent(strain, 2)} {words}' for words, strain in strains)} "
        "non-reflecting faces"
    )
    result += "; it depends on the mesh and on the slope beyond yield, which is assumed."
    if stresses:
        bears = ", ".join(f"{stress / 1e6:.0f} MPa {words}" for words, stress in stresses)
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


def _sentence(text: str) -> str:
    return text[0].upper() + text[1:]
