"""What a machine is and how it was set, in words: for the screen and for the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median
from typing import TYPE_CHECKING

from strikewave.analyses.machine.kind import MachineKind, kind_of
from strikewave.analyses.machine.result import INTERVAL, ContactAnswer, ContactAnswers, LineCollision, Solution
from strikewave.base.declare import NO_UNIT
from strikewave.base.result import Band
from strikewave.base.shock_quantities import KILOGRAMS, PULSE_WIDTH, RIGID_PEAK, VELOCITY, VELOCITY_CHANGE
from strikewave.cases.contact_parts import YIELDING
from strikewave.cases.tables.machine_kinds import KINDS
from strikewave.machines import Blow
from strikewave.reporting.columns import Column, page_table
from strikewave.reporting.faces import amount, bands_below, columns_of, part_tables, text_of
from strikewave.reporting.layout import KEY
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import NONE, Table

if TYPE_CHECKING:
    from strikewave.cases.case import Case

MACHINES = {kind: (table.description, table.chain) for kind, table in KINDS.items() if issubclass(table, MachineKind)}
"""Kind of machine: its description, and its bodies and links in the order in which a blow runs through them."""
ANSWERS_CALLED = "First blow with its contact elastic and yielding"


def settings(solution: Solution) -> list[str]:
    """Return the main settings of a machine, each with its unit."""
    case = solution.case
    words = []
    for key, one in kind_of(case).settings.items():
        value = getattr(case.machine, key)
        if value is not None:
            is_count = one.si == NO_UNIT
            words.append(f"{value.si:.0f} {one.label}" if is_count else f"{one.label} {amount(one, value.si)}".strip())
    approach = (solution.launch or {}).get("approach_speed", solution.reference.approach_speed)
    words += [f"nominal approach {amount(VELOCITY, approach)}"]
    words += [f"object {amount(KILOGRAMS, solution.masses['object'])}"]
    return words + ([f"{case.feed.blows.si:.0f} blows wanted"] if case.feed else [])


def reference_law(case: Case) -> str:
    """Return in words which law stands beside the blows for comparison."""
    return kind_of(case).reference_law


def answer_columns(answers: ContactAnswers, bands: Mapping[str, Band] | None = None) -> list[Column]:
    """Return the columns of the answers of a contact, with the digits that the bands leave."""
    called = [row.name + (" (this run)" if row.name == answers.taken else "") for row in answers.rows]
    _, *rest = columns_of(ContactAnswer, answers.rows, bands=blow_bands(bands or {}))
    return [Column("contact", called, priority=KEY, words=True), *rest]


def blow_bands(bands: Mapping[str, Band]) -> dict[str, list[Band]]:
    """Return the bands of the first blow and of later ones by what they are of."""
    return bands_below(bands, ("first", "typical"))


def blow_columns(table: str, blows: Sequence[Blow], bands: Mapping[str, Band] | None = None) -> list[Column]:
    """Return the columns of a table of blows, ``blows``, ``contact`` or ``sliding``, for screen, page and app.

    Examples
    --------
    >>> [column.head for column in blow_columns("contact", [])][:4]
    ['#', 'approach speed (m/s)', 'rebound speed (m/s)', 'contact time (µs)']
    """
    return columns_of(Blow, blows, table, blow_bands(bands or {}))


def restitution_words(answers: ContactAnswers) -> str:
    """Say which restitution was asked of the damping, and which comes out of the contact."""
    taken = answers.row(answers.taken)
    came = "" if taken is None else f", {taken.restitution:.4g} comes out of the first blow"
    yields = " (damping and yield together)" if answers.taken == YIELDING else ""
    return f"coefficient of restitution: {answers.asked_restitution:g} asked of the damping{came}{yields}"


def launch_tables(solution: Solution) -> list[Table]:
    """Return how a machine without a drive came to first touch; nothing for one with a drive."""
    if not solution.launch:
        return []
    tables = part_tables(solution, "launch", "Up to first touch")
    if solution.collisions:
        caption = "Collisions in the line, by restitution alone; speeds upwards, time after the lowest met the floor"
        tables.append(page_table(caption, columns_of(LineCollision, solution.collisions)))
    return tables


def summary_words(solution: Solution) -> str:
    """Say in words what happened: blows, the first and the later ones, each number with its band where it has one.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> summary_words(run_case(load_case("li-ma-2019", ["feed.blows=1"]))).partition(".")[0]
    'One blow, full'
    """
    struck, first, band = solution.struck, solution.first_blow, solution.band
    if first is None:
        missed = len(solution.blows)
        passes = f" {missed} {'striker' if missed == 1 else 'strikers'} passed without touching it." if missed else ""
        return f"No blow: no striker touched the object.{passes} There is no pulse to measure."
    kinds = [blow.kind for blow in solution.blows]
    odd = [f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds) if kind != "full"]
    whole = "all full" if not odd else f"among {len(kinds)} passes {listed(odd)}"
    many = "One blow, full" if len(struck) == 1 and not odd else f"{len(struck)} blows, {whole}"
    interval = amount(INTERVAL, solution.interval, band.get("interval"))
    apart = "" if solution.interval is None else f", {interval} apart (median)"
    width = amount(PULSE_WIDTH, first.width, band.get("first.width"))
    wide = f"is {width} wide at 10 % of its peak" if width != NONE else "has no width"
    words = [
        f"{many}{apart}.",
        f"The first reaches a rigid-body acceleration of "
        f"{amount(RIGID_PEAK, first.rigid_peak, band.get('first.rigid_peak'))}, {wide} and has a velocity change of "
        f"{amount(VELOCITY_CHANGE, first.velocity_change, band.get('first.velocity_change'))}; the contact force peaks "
        f"at {text_of(first, 'peak_force')}.",
    ]
    later = _later(struck)
    if later:
        peak, span = (median(getattr(blow, name) for blow in later) for name in ("rigid_peak", "width"))
        words.append(
            f"Later blows: {amount(RIGID_PEAK, peak, band.get('typical.rigid_peak'))} and "
            f"{amount(PULSE_WIDTH, span, band.get('typical.width'))} (medians)."
        )
    return " ".join([*words, *_felt_words(solution)])


def _later(struck: Sequence[Blow]) -> list[Blow]:
    """Return the blows after the first that count as typical."""
    return [blow for blow in struck[1:] if blow.kind in ("full", "double")]


def _felt_words(solution: Solution) -> list[str]:
    """Say in words what taps and sensors felt of the first blow; nothing without a stack or sensors."""
    reading = next((r for r in solution.readings if r is not None), None)
    if reading is None:
        return []
    words = []
    if reading.total_peak is not None and reading.bandwidth is not None and "tap" in solution.arrays:
        band, tap = text_of(reading, "bandwidth"), solution.arrays["tap"].values[0]
        words.append(f"At the tap {tap} it reaches {text_of(reading, 'total_peak')} in all, at {band}.")
    read = [f"{name} {text_of(pulse, 'peak')}" for name, pulse in reading.sensors.items()]
    if read:
        words.append(f"Sensors read, with resonance and all they pass beyond that bandwidth: {listed(read)}.")
    return words
