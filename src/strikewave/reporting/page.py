"""The page: solution and further sections in, HTML text out.

Everything on it is a `Section`; the template knows four kinds of parts and nothing of machines.
"""

from __future__ import annotations

import functools
import hashlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from itertools import pairwise
from statistics import median
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from strikewave._version import __version__
from strikewave.analyses.wave.report import bar_sections, bar_words, felt_words, sensor_section, stack_section
from strikewave.reporting import chapters
from strikewave.reporting.numbers import listed, with_unit
from strikewave.reporting.parts import NONE, Picture, Section, Tag

if TYPE_CHECKING:
    from jinja2 import Template

    from strikewave.analyses.machine.result import Solution
    from strikewave.analyses.wave.run import BarSolution
    from strikewave.machines import Blow

_CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff]")


@dataclass(frozen=True)
class Head:
    """What stands above the sections of a page.

    Attributes
    ----------
    title : str
        Of the page.
    kicker : str
        What kind of report it is.
    subject, name : str
        What was run or read, such as ``Case``, and what it is called.
    digest : str
        SHA-256 of it; empty where there is none.
    status : Tag
        How it went.
    summary : str
        What happened, in words.
    numbers : sequence of (str, str)
        Key numbers: label and value with its unit.
    foot : str
        What the foot of the page says.
    """

    title: str
    kicker: str
    subject: str
    name: str
    digest: str
    status: Tag
    summary: str
    numbers: Sequence[tuple[str, str]]
    foot: str


def whole_page(head: Head, sections: Sequence[Section]) -> str:
    """Return a page: its head, a summary, the sections in their order."""
    page = _template().render(vars(head), version=__version__, css=_css(), sections=list(_numbered(sections)))
    return _CONTROL.sub("\ufffd", page)


def report(solution: Solution, sections: Sequence[Section] = (), moving: str = "") -> str:
    """Return the report of a run as one HTML page: no script, nothing fetched, the same bytes each time.

    Parameters
    ----------
    solution : Solution
        What ran and what it gave. Parts may be empty or None: the page then says so in words.
    sections : sequence of Section, optional
        Further sections, shown after the pulses in this order.
    moving : str, optional
        Name of the file beside the report that shows the machine in motion, if there is one.

    Examples
    --------
    >>> from strikewave import load_case, run_case
    >>> page = report(run_case(load_case("li-ma-2019", ["feed.blows=1"])))
    >>> page.splitlines()[0], "<script" in page
    ('<!doctype html>', False)
    """
    whole, solution = solution, _complete(solution)
    text = chapters.case_text(solution.case)
    digest = hashlib.sha256(text.encode("utf-8", "replace")).hexdigest()
    struck_by_machine = []
    if _has_machine(solution):
        struck_by_machine = [chapters.blow_table(solution), chapters.pulse_pictures(solution)]
        struck_by_machine += [*stack_section(whole), *sensor_section(whole)]
    listing = [
        chapters.setup(solution, moving),
        chapters.inputs(solution.case),
        *struck_by_machine,
        *sections,
        *([chapters.published(solution)] if _has_machine(solution) or solution.case.published else []),
        chapters.warnings(solution),
        chapters.checks(solution),
        chapters.sources(solution),
        chapters.reproduction(solution.case, text, digest),
    ]
    name = solution.case.name
    return whole_page(
        Head(
            title=solution.title,
            kicker="Report of a run",
            subject="Case",
            name=name,
            digest=digest,
            status=_status(solution),
            summary=_summary(solution, whole),
            numbers=_key_numbers(solution),
            foot=f"case {name or 'without name'} · SHA-256 of the case text {digest}",
        ),
        listing,
    )


def bar_report(solution: BarSolution, quantity: str = "stress") -> str:
    """Return the report of a bar alone as one HTML page; see `report`.

    ``quantity`` is what the pictures of the whole field show: stress, force or velocity.

    Examples
    --------
    >>> from strikewave import load_case, run_wave
    >>> "x-t" in bar_report(run_wave(load_case("li-ma-2019-fig13-bar")))
    False
    """
    return report(solution, bar_sections(solution, quantity))  # type: ignore[arg-type]  # what it lacks is said in words


@functools.cache
def _template() -> Template:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    folder = resources.files("strikewave.reporting")
    environment = Environment(
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        loader=FunctionLoader(lambda name: (folder / name).read_text("utf-8")),
    )
    return environment.get_template("template.html")


def _css() -> Any:
    from markupsafe import Markup

    return Markup((resources.files("strikewave.reporting") / "style.css").read_text("utf-8"))  # our own, no input


def _numbered(listing: Sequence[Section]) -> Iterator[dict[str, Any]]:
    """Yield what the template shows of each section: tables and pictures are counted through the whole page."""
    from markupsafe import Markup

    from strikewave.reporting.inline import inline_svg

    count = {"table": 0, "picture": 0}
    for place, section in enumerate(listing, 1):
        blocks: list[dict[str, Any]] = []
        for part in section.parts:
            if part.kind in count:
                count[part.kind] += 1
            block: dict[str, Any] = {"kind": part.kind, "part": part, "number": count.get(part.kind, 0)}
            if isinstance(part, Picture):
                svg = inline_svg(part.figure, f"p{count['picture']}", part.label or part.caption)
                wide = part.figure.get_figwidth() > 5.5
                block = {**block, "kind": "pictures", "shown": [{**block, "svg": Markup(svg), "wide": wide}]}
                if blocks and blocks[-1]["kind"] == "pictures":
                    blocks[-1]["shown"] += block["shown"]
                    continue
            blocks.append(block)
        yield {"id": f"section-{place}", "title": section.title, "paragraphs": section.paragraphs(), "blocks": blocks}


def _complete(solution: Any) -> Any:
    """Return what the page asks of a solution; what it has not is None."""
    names = ["blows", "data", "published", "warnings", "ledger", "masses", "phases", "citations", "reference"]
    names += ["readings", "taps", "waves", "launch", "collisions"]
    found = {name: getattr(solution, name, None) for name in names}
    return SimpleNamespace(title=solution.title, case=solution.case, **found)


def _has_machine(solution: Solution) -> bool:
    return getattr(solution.case, "machine", None) is not None


def _struck(solution: Solution) -> list[Blow]:
    return [blow for blow in solution.blows or () if blow.kind != "missed"]


def _status(solution: Solution) -> Tag:
    broken = [notice.code for notice in solution.warnings or () if notice.broken]
    if broken:
        return Tag(f"stated limit broken: {listed(broken)}", "bad")
    many = len(solution.warnings or ())
    warned = f"; {many} warning{'s' if many > 1 else ''}, see below" if many else ""
    return Tag(f"no stated limit broken{warned}", "warned" if many else "good")


def _interval(struck: Sequence[Blow]) -> float | None:
    """Return the median time between blows, s; None for fewer than two."""
    return median(b.time - a.time for a, b in pairwise(struck)) if len(struck) > 1 else None


def _summary(solution: Solution, given: Any) -> str:
    """Say in words what happened."""
    if not _has_machine(solution):
        return bar_words(given) if getattr(solution, "taps", None) else "A stack alone, without a machine."
    struck = _struck(solution)
    if not struck:
        missed = len(solution.blows or ())
        passes = f" {missed} {'striker' if missed == 1 else 'strikers'} passed without touching it." if missed else ""
        return f"No blow: no striker touched the object.{passes} There is no pulse to measure."
    first, later = struck[0], [blow for blow in struck[1:] if blow.kind in ("full", "double")]
    kinds = [blow.kind for blow in solution.blows]
    odd = [f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds) if kind != "full"]
    whole = "all full" if not odd else f"among {len(kinds)} passes {listed(odd)}"
    many = "One blow, full" if len(struck) == 1 and not odd else f"{len(struck)} blows, {whole}"
    interval = _interval(struck)
    apart = "" if interval is None else f", {with_unit(interval, 's', 'ms')} apart (median)"
    width = with_unit(first.width, "s", "us")
    wide = f"is {width} wide at 10 % of its peak" if width != NONE else "has no width"
    words = [
        f"{many}{apart}.",
        f"The first reaches a rigid-body acceleration of {with_unit(first.rigid_peak, 'm/s^2', 'g')}, {wide} and "
        f"changes the object's velocity by {with_unit(first.velocity_change, 'm/s', 'm/s', 3)}; the contact force "
        f"peaks at {with_unit(first.peak_force, 'N', 'kN', 3)}.",
    ]
    if later:
        peak, span = (median(getattr(blow, name) for blow in later) for name in ("rigid_peak", "width"))
        words.append(f"Later blows: {with_unit(peak, 'm/s^2', 'g')} and {with_unit(span, 's', 'us')} (medians).")
    words += felt_words(given)
    return " ".join(words)


def _key_numbers(solution: Solution) -> list[tuple[str, str]]:
    if not _has_machine(solution):
        return []
    struck = _struck(solution)
    wanted = getattr(getattr(solution.case, "feed", None), "blows", None)
    pairs = [("blows" if wanted is None else f"blows of {wanted.si:.0f} wanted", str(len(struck)))]
    if not struck:
        return pairs
    first = struck[0]
    pairs += [
        ("first peak, rigid body", with_unit(first.rigid_peak, "m/s^2", "g")),
        ("first width, at 10 % of the peak", with_unit(first.width, "s", "us")),
        ("velocity change, first blow", with_unit(first.velocity_change, "m/s", "m/s", 3)),
        ("contact force, first blow", with_unit(first.peak_force, "N", "kN", 3)),
    ]
    interval = _interval(struck)
    return pairs if interval is None else [*pairs, ("interval, median", with_unit(interval, "s", "ms"))]
