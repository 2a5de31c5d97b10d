"""The closing table: what Li & Ma 2019 get right, and what not, each with the computed numbers that say so."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from strikewave.studies.reproduction.contact_equations import delivered
from strikewave.studies.reproduction.examples import WaveExample
from strikewave.studies.reproduction.published import ROUNDED, published_number
from strikewave.studies.reproduction.types import Answer, Consistency, ElementNumbers, EquationRow, Finding
from strikewave.studies.reproduction.wave_equations import mean_over_rigid
from strikewave.units import STANDARD_GRAVITY

SAME = 1e-6
"""Relative difference up to which two computations of a number are the same."""
PARTLY = 1.0
"""Relative difference up to which a prediction is partly right."""
SLIGHT = 0.05
"""Largest plastic strain that may be called slight."""
SEEN = 0.01
"""Share of a wave below which a reflection is not seen in an experiment."""
RESOLVED = 3.0
"""Elements over the half width of a contact that resolve it."""
STEEPER = 1.1
"""A rise is steeper later than early from this ratio of slopes on."""

QUIET, REFLECTING, ELASTIC, WAVE = "quiet", "reflecting", "elastic", "wave"
"""Runs of finite elements: Figure 11 with non-reflecting faces, without, with them but without yielding; Figure 15."""
NOT_RUN = "The finite elements that would tell were not run."

Rows = Mapping[str, EquationRow]
Runs = Mapping[str, ElementNumbers | None]


def findings(
    equations: Sequence[EquationRow],
    checks: Sequence[Consistency],
    elements: Runs | None = None,
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

    Examples
    --------
    >>> from strikewave.studies.reproduction.equations import equation_rows
    >>> from strikewave.studies.reproduction.published import consistency_checks
    >>> table = findings(equation_rows(), consistency_checks())
    >>> [row.verdict for row in table if row.topic == "restitution"]
    ['partly']
    """
    rows = {row.number: row for row in equations}
    run = elements or {}
    return (
        *_contact(rows, checks),
        *_waves(rows, checks),
        *_experiments(checks),
        _faces(run.get(QUIET), run.get(REFLECTING)),
        _slopes(run.get(QUIET) or run.get(REFLECTING), run.get(ELASTIC)),
        _yielding(run.get(QUIET) or run.get(REFLECTING)),
        _specimen(run.get(WAVE)),
    )


def judged(difference: float, right: float = ROUNDED, partly: float = PARTLY) -> Answer:
    """Return right, partly or not for a relative difference.

    Examples
    --------
    >>> judged(0.05), judged(-0.5), judged(3.0)
    ('right', 'partly', 'not')
    """
    return "right" if abs(difference) <= right else "partly" if abs(difference) <= partly else "not"


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
    kept = _worst(rows, "(1)", *balances)
    before, after, loss = (rows[number].deviation or 0.0 for number in ("(12)", "(13)", "(16)"))
    low, high = delivered(0.1), delivered(0.9)
    stiffness = _value(rows["(4)"], "printed")
    needed = _check(checks, "K, for a heavy striker", "force simulated").value
    return (
        Finding(
            "form of the contact force, balances of energy and momentum",
            "an elastic and a damping force; what is lost is the work of damping",
            f"Right to {kept:.0e}, against both bodies integrated in time.",
            judged(kept, SAME),
            "(1), " + ", ".join(balances),
        ),
        Finding(
            "stiffness of the line contact",
            "Palmgren's formula with the equivalent modulus of (5)",
            f"The formula is the rule of roller bearings to {abs(rows['(2)'].deviation or 0.0):.1%}. "
            f"(5) is upside down: {_value(rows['(5)'], 'printed'):.3g} where "
            f"{_value(rows['(5)'], 'exact'):.4g} Pa is meant.",
            "right" if rows["(5)"].verdict == "right" else "partly",
            "(2) to (5)",
        ),
        Finding(
            "energy lost by damping",
            "the speed over the depth is that of a linear spring, the integral 3/10",
            f"{before:+.1%} on the way in, {after:+.1%} on the way out, {loss:+.1%} in all.",
            judged(loss, 1e-3),
            "(12) to (16), (19), (20), (23)",
        ),
        Finding(
            "restitution",
            "the damping of (24) gives the restitution that is asked for",
            f"Asked for {_value(rows['(25)'], 'exact'):.3g} it gives {_value(rows['(25)'], 'printed'):.4f}; asked for "
            f"{low.asked:g} {low.printed:.4f}, for {high.asked:g} {high.printed:.4f}, whatever masses, speed and "
            "stiffness are. An estimate, good near 1; a damping that gives what is asked for is known.",
            judged(max(abs(rows["(25)"].deviation or 0.0), abs(low.printed / low.asked - 1.0)), 1e-3),
            "(24), (25)",
        ),
        Finding(
            "force of the machine's blow from the contact alone",
            "(25) establishes the rigid-body acceleration",
            f"The simulated force and width need K = {needed:.3g} N/m^(10/9) at most; (4) gives {stiffness:.3g} for a "
            f"line of 40 mm (assumed), {stiffness / needed:.0f} times that. What bends behind the contact is missing.",
            judged(stiffness / needed - 1.0),
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
            judged(shares, SAME),
            "(26), (27), (29), (31), (39)",
        ),
        Finding(
            "arrival of echoes",
            "after t_(l−x), and every t₀ from then on",
            f"In the example the first echo is taken to come after {echo:.2f} of its time, the next after {again:.2f}; "
            f"the largest strain of a pulse of two transits is off by {late:+.0%}. Amplitudes, and what a long load "
            "settles to, are right.",
            judged(max(1.0 - echo, abs(late)), 1e-3, 0.1),
            "(30), (32) to (36)",
        ),
        Finding(
            "acceleration from strain",
            "v = c ε for the sum of all waves",
            f"True of forward waves only. Under a slow pulse {fast + 1.0:.2f} times the acceleration between bars of "
            f"another impedance; a free end at {_value(rows['(38)'], 'printed'):.1f} instead of "
            f"{_value(rows['(38)'], 'exact'):.2f} m/s.",
            judged(fast, 1e-3),
            "(38), (40)",
        ),
        Finding(
            "experiment on stress waves as a test of the model",
            "verifies the model of (26) to (40)",
            f"Cylinders and sensor of nearly one impedance reflect {matched:.1e} of a wave: no echo of the model takes "
            "part, and its errors do not show.",
            "not" if matched < SEEN else "right",
            "(31); Table 2",
        ),
        Finding(
            "rigid-body and wave acceleration as parts of the total",
            "two parts that are superposed",
            f"The wave's mean over the specimen is {ratio:.4f} of net force over mass: it holds the rigid-body "
            "acceleration already, and adding that counts it twice. Taken apart as mean and remainder they are useful.",
            "partly" if judged(ratio - 1.0, 1e-3) == "right" else "right",
            "(40); sections 3.1, 3.2",
        ),
    )


def _experiments(checks: Sequence[Consistency]) -> tuple[Finding, ...]:
    buffered = _check(checks, "ratio of the peaks", "direct peak").value
    simulated = _check(checks, "ratio of the peaks", "rigid peak simulated").value
    width = published_number("rigid width simulated").value / published_number("rigid width").value
    larger = _check(checks, "ratio of the peaks", "peak ratio")
    rigid, wave = (_check(checks, "velocity change", used).value for used in ("rigid peak", "wave peak"))
    half = _check(checks, "half width of an elastic contact", "smallest element").value
    element = published_number("smallest element").value
    stated = larger.stated or 1.0
    return (
        Finding(
            "a sensor reads more than the rigid body's acceleration",
            "rigid-body dynamics alone does not describe a sensor that is mounted directly",
            f"Two sensors on one body read {buffered:.2f} : 1; as one rigid body they would read the same.",
            "right" if buffered > 1.0 + ROUNDED else "not",
            "Figure 5; li-ma-2019-fig5",
        ),
        Finding(
            "simulated and measured rigid-body pulse",
            "good consistency",
            f"Peaks {simulated - 1.0:+.1%}, widths {width - 1.0:+.1%}; how widths were measured is not said.",
            judged(max(abs(simulated - 1.0), abs(width - 1.0)), ROUNDED + SAME),
            "Figure 11; li-ma-2019",
        ),
        Finding(
            "peak with stress waves over that without",
            f"about {stated:g} times",
            f"{larger.value:.2f} times by the paper's own numbers.",
            judged(larger.value / stated - 1.0),
            "Figures 11, 13",
        ),
        Finding(
            "peak and width of the stress-wave pulse",
            "one pulse of 21 909.89 g and 252 µs",
            f"As one pulse it would change the speed by {wave:.1f} m/s, {wave / rigid:.1f} times what the blow of "
            "Figure 11 does: peak and width belong to different things, a short front and the whole blow.",
            judged(wave / rigid - 1.0),
            "Figure 13; li-ma-2019-fig13-bar",
        ),
        Finding(
            "mesh of the contact",
            f"smallest elements of {element * 1e3:g} mm",
            f"For a nose of 10 mm and a line of 40 mm (assumed) the elastic contact is {half * 1e3:.2f} mm wide to "
            f"either side: {half / element:.1f} elements, where it takes some {RESOLVED:g}.",
            "right" if half >= RESOLVED * element else "partly",
            "Figure 10; li-ma-2019-fem-rigid",
        ),
    )


def _faces(quiet: ElementNumbers | None, reflecting: ElementNumbers | None) -> Finding:
    """Say what non-reflecting faces do to the blow."""
    topic, paper = "non-reflecting faces on the struck body", "they keep reflected waves off the result"
    shown = "li-ma-2019-fem-rigid-quiet, li-ma-2019-fem-rigid"
    if quiet is None or quiet.rigid_peak is None or reflecting is None or reflecting.rigid_peak is None:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    with_faces, without = quiet.rigid_peak, reflecting.rigid_peak
    words = [f"rigid-body peak {_g(with_faces)} with them, {_g(without)} without"]
    if quiet.peak_force is not None and reflecting.peak_force is not None:
        words.append(f"force {quiet.peak_force / 1e3:.2f} and {reflecting.peak_force / 1e3:.2f} kN")
    if quiet.impulse is not None and reflecting.impulse is not None:
        words.append(f"impulse {quiet.impulse:.3g} and {reflecting.impulse:.3g} N s")
    if quiet.impulse is not None and quiet.momentum is not None:
        words.append(f"with them the body keeps {quiet.momentum / quiet.impulse:.0%} of the impulse")
    return Finding(topic, paper, _sentence("; ".join(words) + "."), judged(with_faces / without - 1.0), shown)


def _slopes(run: ElementNumbers | None, elastic: ElementNumbers | None) -> Finding:
    """Say whether the pulse steepens, and whether it does so because of yielding."""
    topic = "slope of the pulse"
    paper = "small while the contact is elastic, growing quickly once it is plastic"
    shown = "Figure 11; li-ma-2019-fem-rigid-quiet"
    ratio, unyielding = _steepening(run), _steepening(elastic)
    if ratio is None:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    found = f"{ratio:.2f} times as steep from 50 to 90 % of the peak as from 10 to 30 %"
    if ratio < STEEPER:
        return Finding(topic, paper, f"{found}: it does not steepen.", "not", shown)
    if unyielding is None:
        return Finding(topic, paper, f"{found}. Whether yielding is why was not run.", "partly", shown)
    alike = unyielding >= STEEPER
    why = "so it is not yielding that steepens it" if alike else "so it is yielding that steepens it"
    found = f"{found}; {unyielding:.2f} times with elastic bodies, {why}."
    return Finding(topic, paper, found, "partly" if alike else "right", shown)


def _steepening(run: ElementNumbers | None) -> float | None:
    """Return the late slope over the early one."""
    if run is None or run.slope_early is None or run.slope_late is None:
        return None
    return run.slope_late / run.slope_early


def _yielding(run: ElementNumbers | None) -> Finding:
    """Say whether the contact yields, and how far."""
    topic, paper, shown = "yielding", "slight plastic deformation beside the elastic one", "li-ma-2019-fem-rigid-quiet"
    if run is None or run.plastic_strain is None:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    strain = run.plastic_strain
    verdict: Answer = "not" if strain <= 0.0 else "right" if strain <= SLIGHT else "partly"
    found = f"Largest plastic strain {strain:.2%}, with the yield strength of Table 1."
    return Finding(topic, paper, found, verdict, shown)


def _specimen(run: ElementNumbers | None) -> Finding:
    """Set the specimen's mean acceleration beside the simulated one."""
    topic, shown = "mean acceleration of the specimen between two cylinders", "Figure 15; li-ma-2019-fem-wave"
    printed = published_number("wave peak simulated").value
    paper = f"{_g(printed)} in its finite elements"
    if run is None or run.mean_peak is None:
        return Finding(topic, paper, NOT_RUN, "open", shown)
    words = f"{_g(run.mean_peak)}, mean of the part"
    if run.section_peak is not None:
        words += f"; {_g(run.section_peak)} in its mid section"
    found = f"{words}. Shape, speed and joints are assumed, so that only the order of magnitude can be judged."
    return Finding(topic, paper, found, judged(run.mean_peak / printed - 1.0), shown)


def _g(acceleration: float) -> str:
    return f"{acceleration / STANDARD_GRAVITY:.0f} g"


def _sentence(text: str) -> str:
    return text[0].upper() + text[1:]
