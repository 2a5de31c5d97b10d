"""The report of a reproduced paper: every equation, figure and published number that can be computed, on one page."""

from __future__ import annotations

import re
import shlex
import string
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from strikewave.analyses.fem.figures.pictures import mesh_picture, view_of
from strikewave.analyses.fem.report import fields_section
from strikewave.analyses.layered_bars import staircase_diagram, xt_diagram
from strikewave.analyses.wave.report import field_of_solution
from strikewave.base.shock_quantities import ACCELERATION, IMPULSE, LENGTH, MICROSECONDS, STRESS
from strikewave.base.texts import percent
from strikewave.cases.case import Case
from strikewave.papers.li_ma_2019 import compared_numbers as known
from strikewave.papers.li_ma_2019 import figures as draw
from strikewave.papers.li_ma_2019.compared_numbers import NumberRow, element_pulse, si_unit
from strikewave.papers.li_ma_2019.element_pulses import element_numbers, first_touch, struck_body, whole_force
from strikewave.papers.li_ma_2019.figures import PublishedMark, Ratio, gasket_figure, joint_figure, reading_traces
from strikewave.papers.li_ma_2019.published import half_sine_change, published_number
from strikewave.papers.li_ma_2019.report_tables import (
    ORIGINS,
    VERDICTS,
    claims_section,
    computed_text,
    elements_section,
    equation_sections,
    findings_section,
    materials_section,
    numbers_section,
    provenance_section,
    share,
    span_text,
    study_tables,
)
from strikewave.papers.li_ma_2019.result import Reproduction
from strikewave.papers.li_ma_2019.runs import (
    BAR,
    PASSING,
    QUIET_ELEMENTS,
    QUIET_WAVE_ELEMENTS,
    RIGID_ELEMENTS,
    WAVE_ELEMENTS,
    quick_changes,
)
from strikewave.papers.li_ma_2019.unknowns import AFTER, GasketStudy, JointStudy, extremes, ringing
from strikewave.reporting import chapters
from strikewave.reporting.faces import amount, text_of
from strikewave.reporting.numbers import listed, with_unit
from strikewave.reporting.parts import NONE, Cell, Code, Part, Picture, Section, Table, Tag
from strikewave.reporting.style import Trace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strikewave.analyses.fem.result import FemSolution


def reproduction_report(result: Reproduction) -> str:
    """Return the report as one HTML page: no script, nothing fetched."""
    runs = result.runs
    done = (
        f"{len(runs.cases)} cases were run: the rotary machine with its object as bodies and as stacks in which waves "
        "run, a bar alone"
        + (", and finite-element models" if runs.elements else "; the finite-element models were left out")
        + ". Every equation was computed as printed, as corrected and exactly; every published number is set beside "
        f"what was computed. Fitted to published numbers: {listed(sorted(set(fitted_inputs(result))))}."
    )
    verdicts: list[list[Cell]] = [[name, verdict] for name, verdict in runs.checked]
    commands = [*(again(case, runs.quick) for case in runs.cases), _command("bar", BAR, PASSING)]
    sections = [
        claims_section(result.findings, overview_picture(result)),
        *figure_sections(result),
        numbers_section(result.numbers, result.checks),
        *equation_sections(result.equations),
        elements_section(runs.elements, study_tables(result)),
        findings_section(result.findings),
        chapters.warnings(result.notices),
        Section("What was done", done, [Table("What the checks of the runs came to", ["run", "verdict"], verdicts)]),
        materials_section(result.numbers),
        provenance_section(runs.cases),
        Section("The runs, one by one", "Each has a report of its own.", [Code("\n".join(commands))]),
    ]
    status = Tag("quick: coarse elements", "warned") if runs.quick else Tag("all runs, full meshes", "good")
    if not runs.elements:
        status = Tag("the element models were not run", "warned")
    if result.broken:
        status = Tag("a run failed a check, see warnings", "bad")
    title, summary = "Report of a reproduction", reproduction_words(result)
    return chapters.result_page(result, chapters.Summary(title, summary, key_numbers(result), status), sections)


def reproduction_words(result: Reproduction) -> str:
    """Return the claims of the paper and the result in a paragraph, for the screen and the head of the report."""
    verdicts = [row.verdict for row in result.equations]
    counted = listed([f"{verdicts.count(name)} {name}" for name in VERDICTS if name in verdicts])
    broken = f"{result.verdicts.sentence} " if result.verdicts.words else ""
    return (
        f"{broken}The paper says that a contact law with damping gives the rigid-body pulse of a rotary shock "
        "machine, that one-dimensional waves give what a sensor reads beyond it, and that tests and LS-DYNA confirm "
        f"both. Of its {len(verdicts)} numbered equations: {counted}. What the machine was fitted to agrees by "
        "construction; what was not shows how far bodies, springs and waves of assumed dimensions come."
    )


def again(case: Case, quick: bool = False) -> str:
    """Return the command that runs a case as it was run here."""
    return _command(case.command, case.name, quick_changes(case.name) if quick and case.mesh else ())


def _command(command: str, case: str, changes: Sequence[str] = ()) -> str:
    return " ".join(["strikewave", command, case, *(f"--set {shlex.quote(change)}" for change in changes)])


page = reproduction_report
"""Page of a result in Python, found as `picture` is by `strikewave.reporting.shown_result`."""


def picture(result: Reproduction) -> Figure:
    """Return how far everything that can be compared is from the published numbers."""
    return overview_picture(result).figure


MARKS = (
    " The paper publishes numbers, no curves: they are marks, a level for a peak, a bar from first touch on for a "
    "width, with the words measured or LS-DYNA. Every curve is computed."
)
SHOWN_TIME = 4e-4
"""Shown time of a pulse, s: twice the published width, for its end and the ringing after it."""
HARDLY = 0.5
"""Share of the published drop of the peak by the buffer below which the drop counts as hardly met. Chosen."""


def mark(result: Reproduction, peak: str, width: str = "", what: str = "") -> PublishedMark:
    """Return the mark of a published peak, and of its width."""
    number = result.row(peak).number
    span = result.row(width).number.value if width else None
    return PublishedMark(number.value, ORIGINS[number.origin], span, what)


def sentence_of(row: NumberRow) -> str:
    """Return a published number in a sentence, with what was computed of it, by which case and in which role."""
    number = row.number
    unit, si = number.unit, si_unit(number.unit)
    what = number.quantity[:1].upper() + number.quantity[1:]
    begin = f"{what}: {ORIGINS[number.origin]} {with_unit(number.value, si, unit, 7)}"
    computed = []
    for answer in row.computed:
        if answer.value is None:
            continue
        off = answer.difference(number.value)
        if answer.role == "range":
            computed.append(f"computed {computed_text(answer, unit)} by {answer.by} (a range {answer.note})")
        else:
            role = answer.role if off is None or answer.role == "shown" else f"{answer.role}, {share(off)}"
            computed.append(f"computed {with_unit(answer.value, si, unit)} by {answer.by} ({role})")
    return f"{begin}, {listed(computed)}." if computed else f"{begin}, not computed."


def _sentences(result: Reproduction, *names: str) -> str:
    """Return what was computed of some published numbers, a paragraph each."""
    return "\n\n".join(sentence_of(result.row(name)) for name in names)


def ratios(result: Reproduction) -> list[Ratio]:
    """Return what is computed over what is published, for all numbers that can be compared, the case made for it."""
    return [
        Ratio(f"{row.number.where}: {row.number.name}", 1.0 + off, best.role, best.differences(row.number.value))
        for row in result.numbers
        if (best := row.best) is not None
        and best.role in ("fitted", "predicted", "range")
        and (off := best.difference(row.number.value)) is not None
    ]


def overview_picture(result: Reproduction) -> Picture:
    """Draw how far everything that can be compared is from the published numbers."""
    caption = (
        "Computed over published, for every measured or simulated number that is fitted, predicted or left between two "
        "ends by what is not published (a bar; its mark is what the case assumes); of several models the one made for "
        "it. Fitted numbers lie on 1 because their case was adjusted to them."
    )
    return Picture(draw.ratio_figure(ratios(result)), caption)


def figure_sections(result: Reproduction) -> Iterator[Section]:
    """Yield a section for each figure of the paper that can be computed."""
    for section in (_sensors, _passing, _train, _first_pulse, _fixture, _specimen):
        yield section(result)


def _sensors(result: Reproduction) -> Section:
    direct, buffered = (mark(result, name) for name in (known.DIRECT_PEAK, known.BUFFERED_PEAK))
    figure = draw.sensors_figure(
        result.runs.comparison, direct._replace(what="direct"), buffered._replace(what="buffered")
    )
    text = f"""The paper shows seven pulses in 150 ms of two equal sensors on one specimen: one mounted directly, one \
buffered by gaskets. Here the machine strikes a stack of nose, frame, fixture and specimen; both sensors sit at the \
same height, the buffered one on two PTFE gaskets with a 2A12 plate between them.

{_sentences(result, known.BUFFERED_PEAK, known.DIRECT_PEAK, known.SEVEN_WINDOW)}

Why it is a range: the buffered peak is fitted (by the engagement), so the direct one is that peak over what the \
gaskets pass of it, and nothing is published of them. The assumed PTFE hardly loses energy and magnifies the rigid \
pulse, so that it asks for a weak blow. {_over_gaskets(result.unknowns.gaskets)} Specimen, sensors, sampling and the \
speed of this test are not published either.

What would decide: material and thickness of the gaskets, or their insertion loss under this sensor, measured on a \
shaker or at the end of a bar; then the speed of this test.

{_buffering(result)}"""
    caption = "What the two sensors read, as computed with the assumed gaskets: all blows, and the first one." + MARKS
    mapped = (
        "Peak of the direct sensor in the blow in which the buffered one reads its published peak, over gaskets: "
        "modulus, loss factor, thickness. Every number is computed."
    )
    parts: list[Part] = [Picture(figure, caption), Picture(gasket_figure(result.unknowns.gaskets), mapped)]
    return Section("Paper's Figure 5: a direct and a buffered sensor", text, parts)


def _over_gaskets(study: GasketStudy) -> str:
    """Return the readings of the direct sensor over the map, and the gaskets with which it reads as measured."""
    published = published_number(known.DIRECT_PEAK).value
    every, calm = (span_text(*extremes([c.direct for c in cells]), "g") for cells in (study.reached, study.calm))
    near = min(study.calm, key=lambda cell: abs(abs(cell.direct) / published - 1.0))
    same = amount(ACCELERATION, abs(study.same_machine), digits=3)
    return (
        f"Over {len(study.cells)} gaskets, each with its own engagement, the direct sensor reads {every}; over the "
        f"{len(study.calm)} with which the buffered sensor rings less than the direct one, as the paper says of its "
        f"own, {calm}. One of {amount(LENGTH, near.thickness)} with a modulus of {amount(STRESS, near.modulus)} and a "
        f"loss factor of {near.loss_factor:g} gives {amount(ACCELERATION, abs(near.direct))}; with the engagement of "
        f"li-ma-2019, whatever the gasket, it would be {same}."
    )


def _buffering(result: Reproduction) -> str:
    """Return the effect of the buffer on peak and ringing, as measured and as computed."""
    direct, buffered = (result.row(name) for name in (known.DIRECT_PEAK, known.BUFFERED_PEAK))
    if not (direct.best and direct.best.value and buffered.best and buffered.best.value):
        return ""
    taken = 1.0 - buffered.best.value / direct.best.value
    measured = 1.0 - buffered.number.value / direct.number.value
    # of the raw readings after the first touch of the first blow
    first = [reading_traces(result.runs.comparison, name)[0] for name in ("direct", "buffered")]
    loud, soft = (ringing(trace.time, trace.values) for trace in first)
    verdict = "The computed buffer does not calm the pulse" if soft >= loud else "The computed buffer calms the pulse"
    rms = [amount(ACCELERATION, value) for value in (soft, loud)]
    return (
        f"What the buffer does is {'hardly ' if taken < HARDLY * measured else ''}met: it takes {percent(taken)} off "
        f"the computed peak, where {percent(measured)} were measured. {verdict}: after {amount(MICROSECONDS, AFTER)} "
        f"the buffered sensor reads {rms[0]} (root mean square), the direct one {rms[1]}. The assumed gaskets are a "
        "spring under the sensor's mass; those of the experiment are not known."
    )


def _passing(result: Reproduction) -> Section:
    solution = result.runs.passing
    field, layer = field_of_solution(solution), solution.taps[0][1].layer
    text = """The paper draws the multiple reflections of a wave in the specimen and counts its passages. If its \
areas are equal, which is not said, its own experiment cannot show them: 45 steel between 65Mn reflects next to \
nothing. Here the specimen is 2A12 between 65Mn, and the load rises within 0.3 µs and stays.

The equations as printed let the echo come back after the way to interface II alone, and the next one a transit later; \
in truth it has that way to go and back. The heights of the steps and the end are right. The corrected sum and the \
finite stack, solved by delay lines, agree until the first echo from beyond the neighbours."""
    shown = 2.2 * solution.waves.layers[0].steps * solution.waves.step  # s: the wave is then at the far end
    parts: list[Part] = [
        Picture(
            draw.passing_figure(solution),
            "Left: the way of the front through the specimen, and when it passes the middle, exact and by the "
            "equations as printed. Right: the force there under a steep front, by three routes; all computed.",
        ),
        Picture(
            staircase_diagram(field, layer, solution.run.time, solution.run.face_force),
            "How the force grows at both interfaces: steps of the closed form (dotted), the stack, and endless "
            "neighbours.",
        ),
        Picture(
            xt_diagram(field.up_to(shown)),
            "Stress along the stack over time: blue is compression, red tension; lines are faces of layers.",
        ),
    ]
    return Section("Paper's Figure 7: multiple reflections", text, parts)


def _train(result: Reproduction) -> Section:
    typical = mark(result, known.TYPICAL_PEAK, what="typical")
    figure = draw.train_figure(result.runs.machine, result.runs.equal_blows, typical)
    text = f"""The paper shows 11 rigid-body pulses at 730 r/min whose peaks are usually about 4000 g and whose widths \
are about 200 µs; it explains their differences by the object, which does not come to rest between blows.

{_sentences(result, known.TYPICAL_PEAK, known.TYPICAL_WIDTH)}

Why they differ: two values were fitted to the first pulse, which the usual one nearly equals, so that this agreement \
says little. After the first blow the object still moves on its stop when the next striker comes. The second machine, \
li-ma-2019-equal-blows, has another damper, stop and preload and shows that the drop after the first blow goes away."""
    caption = (
        "Left: rigid-body acceleration of the whole train, as computed, with the typical peak as a level. Right: peak "
        "of each blow, and of the machine with equal blows." + MARKS
    )
    return Section("Paper's Figure 9: eleven rigid-body pulses", text, [Picture(figure, caption)])


def _first_pulse(result: Reproduction) -> Section:
    data = result.runs.machine.arrays
    curves = [Trace("machine model", data["pulse_time"].values, data["pulse_acceleration"].values[0])]
    named = ((RIGID_ELEMENTS, "elements"), (QUIET_ELEMENTS, "elements, non-reflecting faces"))
    curves += _pulses(result, named)
    quiet = result.runs.element_solution(QUIET_ELEMENTS)
    if quiet is not None and (history := whole_force(quiet)) is not None:  # what the paper calls acceleration
        time, force, _ = history
        mass = quiet.run.groups[struck_body(quiet)].mass
        curves.append(Trace("the same, contact force over mass", time - first_touch(quiet), force / mass))
    marks = [mark(result, known.RIGID_PEAK, known.RIGID_WIDTH), mark(result, known.DYNA_PEAK, known.DYNA_WIDTH)]
    figure = draw.pulse_figure("First rigid-body pulse", curves, marks, SHOWN_TIME)
    text = f"""The paper compares its measured first pulse with that of LS-DYNA: force of the contact over the whole \
mass. Here the machine model of bodies, contact law and frame gives it, and finite-element models: the half-cylinder \
on the frame that holds the shell, with faces that reflect as they do, and with the paper's non-reflecting ones.

{_sentences(result, known.RIGID_PEAK, known.RIGID_WIDTH, known.DYNA_PEAK, known.DYNA_WIDTH, known.DYNA_FORCE)}

Why they differ: peak and width of the measured pulse are what the machine model is fitted to, so that only its \
shape is its own; its contact force is not that of LS-DYNA, because a lumped nose answers a stiff contact with a \
spike. Non-reflecting faces hold the free object as dashpots to the ground would and take its momentum: \
the contact force over the mass, which the paper calls the rigid-body acceleration, is none there. The elements ring, \
because the walls of the assumed frame bend. {_momenta(result)}{_left_out(result, RIGID_ELEMENTS)}"""
    caption = "Rigid-body acceleration of the struck object in the first blow, as computed." + MARKS
    parts: list[Part] = [Picture(figure, caption)]
    solution = result.runs.element_solution(RIGID_ELEMENTS)
    return Section("Paper's Figure 11: the first rigid-body pulse", text, [*parts, *_model_pictures(solution)])


def _pulses(result: Reproduction, named: Iterable[tuple[str, str]]) -> list[Trace]:
    """Return the pulses of the finite-element models that were run, by case and label."""
    solutions = [(result.runs.element_solution(name), label) for name, label in named]
    pulses = [(element_pulse(solution), label) for solution, label in solutions if solution is not None]
    return [Trace(label, pulse.time, pulse.acceleration) for pulse, label in pulses]


def _momenta(result: Reproduction) -> str:
    """Set the impulse of the blow beside that of half-sines of the published peaks and widths."""
    struck_mass = result.row(known.DYNA_FORCE).number.value / result.row(known.DYNA_PEAK).number.value
    measured, simulated = (
        half_sine_change(result.row(peak).number.value, result.row(width).number.value) * struck_mass
        for peak, width in ((known.RIGID_PEAK, known.RIGID_WIDTH), (known.DYNA_PEAK, known.DYNA_WIDTH))
    )
    faces = {RIGID_ELEMENTS: "with faces that reflect", QUIET_ELEMENTS: "with non-reflecting ones"}
    solutions = {name: result.runs.element_solution(name) for name in faces}
    impulses = [
        f"{amount(IMPULSE, impulse, digits=3)} {faces[name]}"
        for name, solution in solutions.items()
        if solution is not None and (impulse := element_numbers(solution).impulse) is not None
    ]
    if not impulses:
        return ""
    return (
        "That the elements meet peak and width by fit is one crest of a ringing pulse, not its shape: the impulse of "
        f"the blow is {listed(impulses)}, where half-sines of the published peaks and widths have "
        f"{amount(IMPULSE, measured, digits=3)} (measured) and {amount(IMPULSE, simulated, digits=3)} (LS-DYNA). "
    )


def _left_out(result: Reproduction, name: str) -> str:
    """Return a sentence where a model was not run, or has a coarse mesh."""
    if result.runs.element_solution(name) is None:
        return f"Not run here: {name}."
    return "The meshes are coarse here (--quick)." if result.runs.quick else ""


def _fixture(result: Reproduction) -> Section:
    wave = mark(result, known.WAVE_PEAK, known.WAVE_WIDTH)
    figure = draw.fixture_figure(result.runs.fixture, "oscilloscope", [wave])
    front = draw.front_figure(result.runs.bar, [wave._replace(width=None)])
    text = f"""The paper clamps a sensor between two cylinders, reads it with an oscilloscope and finds a first peak \
of 21 909.89 g; it takes this for the stress wave on top of the rigid-body pulse. Here nothing is fitted: machine and \
frame are those of Figure 9, the fixture is a stack of assumed dimensions with joints that can open.

{_sentences(result, known.WAVE_PEAK, known.WAVE_WIDTH)}

Why it is a range: in this stack the frame is a spring between nose and cylinders. Its force rises over some 80 µs, \
and a smooth pulse of that size cannot accelerate the stack behind it much beyond its rigid-body acceleration while \
the joints hold. {_over_joints(result.unknowns.joints)}

What would decide: the torque of the bolts and the stiffness of the faces; or the test again with bolts so tight that \
they cannot open, where chatter ends and a steep front does not; or strain gauges on both cylinders, whose force stays \
at that of the preload while a joint is open.

The second picture shows how steep a front in a bar would have to be: a rise of 5 µs, chosen so that the wave in an \
endless bar accelerates by just the published peak. It is no prediction, it is beyond what one-dimensional theory may \
quote for a bar of this diameter, and so short a pulse has 4 % of the blow's impulse. A width of 252 µs is \
that of the whole blow, not of such a front."""
    caption = (
        "What the sensor between the cylinders reads, as computed with joints that hold: all blows, and the first."
    )
    second = (
        "The sensor fixture as a bar alone under a front of 5 µs; the front was chosen to give the level that is "
        "marked, at the far end it doubles." + MARKS
    )
    mapped = (
        "Peak of the sensor between the cylinders in the first blow, without its range, over preload and stiffness of "
        "the faces of both joints. Every number is computed."
    )
    parts: list[Part] = [
        Picture(figure, caption + MARKS),
        Picture(front, second),
        Picture(joint_figure(result.unknowns.joints), mapped),
        mechanism_table(result.unknowns.joints),
    ]
    return Section("Paper's Figure 13: a sensor between two cylinders", text, parts)


def _over_joints(study: JointStudy) -> str:
    """Return the readings of the sensor over the map, and the joints that keep the rigid pulse."""
    peaks = span_text(*extremes([cell.blow.peak for cell in study.keeping]), "g")
    clipped = sum(cell.blow.clipped for cell in study.cells)
    return (
        "Where the bolts press less than the tension behind the front the joints open and chatter, and each closing is "
        f"a steep front. Over {len(study.cells)} pairs of preload and faces {len(study.keeping)} keep the rigid pulse "
        f"within 5 %; with these the sensor reads {peaks}, beyond the assumed range of 50 000 g in {clipped} of all. "
        "Among what was tried, chatter and the closure of a gap are all that gives 20 000 g and more and keeps the "
        "rigid pulse: a stiffer frame changes it, and a sensor that resonates near the pulse gives too little. The "
        "peak of a joint that chatters depends on every detail, the damping of its faces and the resonance of the "
        "sensor too: it can be bounded, not predicted."
    )


def mechanism_table(study: JointStudy) -> Table:
    """List possible causes of the published peak, and whether each keeps the rigid pulse."""
    rows: list[list[Cell]] = [
        [
            mechanism.name,
            amount(ACCELERATION, abs(mechanism.blow.peak), digits=3),
            text_of(mechanism.blow, "rigid_peak"),
            text_of(mechanism.blow, "rigid_width"),
            Tag("kept", "good") if mechanism.blow.keeps(study.assumed) else Tag("not kept", "bad"),
        ]
        for mechanism in study.mechanisms
    ]
    heads = ["what", "peak of the sensor, without its range", "rigid peak", "rigid width", "rigid pulse"]
    return Table("What may give the published peak", heads, rows)


def _specimen(result: Reproduction) -> Section:
    solution = result.runs.element_solution(WAVE_ELEMENTS)
    named = ((WAVE_ELEMENTS, "elements"), (QUIET_WAVE_ELEMENTS, "elements, non-reflecting faces"))
    marks = [mark(result, known.DYNA_WAVE_PEAK)]
    figure = draw.pulse_figure("Mean acceleration of the specimen", _pulses(result, named), marks, SHOWN_TIME)
    text = f"""The paper averages the acceleration of its specimen over the elements of LS-DYNA and finds \
22 841.7 g. Here a finite-element model has the sensor between two cylinders in the same frame.

{_sentences(result, known.DYNA_WAVE_PEAK)}

Why they differ: the mean acceleration of a body is the sum of the forces on its faces over its mass. Here the \
struck wall lies on the upper cylinder, so that in the first tens of microseconds the blow drives the column of \
cylinders and sensor, while the sides of the frame lag behind: the specimen is accelerated far more than the whole \
object. Shapes, joints and speed are not those of the paper, which are not published: that the size is about met shows \
how such a peak can come about, closer agreement than that is chance. {_left_out(result, WAVE_ELEMENTS)}"""
    caption = "Acceleration of the specimen, averaged over its elements, as computed." + MARKS
    parts: list[Part] = [Picture(figure, caption)]
    return Section("Paper's Figure 15: the specimen in the elements", text, [*parts, *_model_pictures(solution)])


def _model_pictures(solution: FemSolution | None) -> Iterator[Picture]:
    """Yield the mesh of a model, as the paper's Figures 10 and 14 show theirs, and its bodies cut open in the blow."""
    if solution is None:
        return
    mesh = mesh_picture(solution.model.mesh, view_of(solution.model))
    yield Picture(mesh, f"The mesh of {solution.case.name} before the blow.")
    yield from (part for part in fields_section(solution).parts if isinstance(part, Picture))


def pictures(result: Reproduction) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of every picture of the figures of the paper."""
    for section in figure_sections(result):
        number = "figure-" + re.findall(r"\d+", section.title)[0]
        shown = [part.figure for part in section.parts if isinstance(part, Picture)]
        for k, figure in enumerate(shown):
            yield number + ("" if k == 0 else f"-{string.ascii_lowercase[k]}"), figure


def key_numbers(result: Reproduction) -> list[tuple[str, str]]:
    """Return the three numbers at the head of the report: published ones that nothing was fitted to."""

    def ranged(name: str, label: str) -> list[tuple[str, str]]:
        best = result.row(name).best
        return [(label, computed_text(best, "g"))] if best is not None and best.role == "range" else []

    verdicts = [row.verdict for row in result.equations]
    label = f"equations hold as printed, and {verdicts.count('definition')} definitions"
    numbers = [(label, f"{verdicts.count('right')} of {len(verdicts)}")]
    numbers += ranged(known.WAVE_PEAK, "stress-wave peak over what joints may be")
    row = result.row(known.DYNA_FORCE)
    if result.runs.element_solution(QUIET_ELEMENTS) is None or row.best is None:
        return numbers + ranged(known.DIRECT_PEAK, "peak of the direct sensor over what gaskets may be")
    off = row.best.difference(row.number.value)
    return [*numbers, ("force on non-reflecting elements: off LS-DYNA's by", NONE if off is None else share(off))]


def fitted_inputs(result: Reproduction) -> list[str]:
    """Return the values that any case was fitted with, each as path and value."""
    return [
        f"{path} = {value.typed}"
        for case in result.runs.cases
        for path, value in case.values().items()
        if value.provenance == "fitted"
    ]
