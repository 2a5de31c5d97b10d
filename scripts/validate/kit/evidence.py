"""Comparisons with measurements, published numbers, closed forms and other codes: one form, one record, one page.

A study hands its comparisons to `keep`. They go into `docs/validation.json`, an entry a version and study with its
date: the history is kept, and a study that runs again replaces its own. `docs/validation.md` and the summary in
`README.md` are made from that file alone, never by hand.
"""

from __future__ import annotations

import dataclasses
import datetime
import json
import statistics
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

from strikewave import __version__

from .pages import ROOT, table, written

RECORD = ROOT / "docs" / "validation.json"
PAGE = ROOT / "docs" / "validation.md"
README = ROOT / "README.md"
WIDTH = 120
"""Characters of a line of text."""
WEAKEST = 3
"""Studies whose worst prediction the page names first."""
LARGE = 0.10
"""A prediction that misses by more has to say why, and what is being done."""
NEAR = (0.01, 0.05, LARGE)
"""Misses within which predictions are counted."""

SHOCKS, BARS, TAYLOR = "Measured shock pulses", "Measured bar shots", "Measured Taylor bars"
"""Kinds of measurements, each counted alone: a bar that is met says nothing of the peak of a shock machine."""


class Study(NamedTuple):
    """Title of a study, the script that makes its rows, and the kind of what it measures."""

    title: str
    script: str
    measured: str = SHOCKS


STUDIES = {
    "machines": Study("Machines: built-in cases", "published.py"),
    "paper": Study("Li & Ma 2019 by elements", "reproduction.py"),
    "shocks": Study("Shocks of a drop table", "smd_shocks.py"),
    "felt": Study("A drop tower on felt", "felt_tower.py"),
    "hopkinson": Study("Split Hopkinson bars", "hopkinson_shots.py", BARS),
    "strikers": Study("Striker bars on incident bars", "striker_on_bar.py", BARS),
    "taylor": Study("Taylor bars by elements", "taylor_bars.py", TAYLOR),
    "closed forms": Study("Closed forms", "closed_forms.py"),
    "other codes": Study("Other codes", "other_codes.py"),
}

MEASURED = "measured"
KINDS = {
    "published": "Published and specified numbers",
    "specified": "Published and specified numbers",
    "simulated": "Published simulations",
    "closed form": "Closed forms",
}
"""Kind of what a number is held against, by the word for it: of what is measured the study says it; any other word is
the name of a code."""
OTHER_CODES = "Other codes, run beside or published"

Role = Literal["predicted", "fitted", "shown"]


@dataclasses.dataclass(frozen=True)
class Comparison:
    """A number that was computed, and what it is held against.

    Attributes
    ----------
    what, quantity : str
        What was tested, and which quantity of it.
    against : str
        What the reference is: measured, specified, simulated, published, closed form, or a code.
    role : str
        predicted: nothing was fitted to it; fitted: used to choose a value, so that agreement shows nothing; shown: not
        comparable, the note says why.
    reference, computed : float or None
        In ``unit``; None where a page has the miss alone, or where two fields are compared.
    unit : str
    miss : float or None
        Relative to the reference; of fields the norm of their difference over that of the reference.
    band : tuple of float or None
        Range of what is computed when its inputs move within what is known of them (95 %).
    note : str
        Why it misses, and what is being done; of what is shown, why it cannot be compared.
    written : str
        Day on which a prediction was written down, where the reference was opened only after that.
    within : tuple of int or None
        How many of the measured values, whose mean the reference is, lie in the band, and of how many; the band is then
        that of one of them.
    """

    what: str
    quantity: str
    against: str
    role: Role
    reference: float | None
    computed: float | None
    unit: str = ""
    miss: float | None = None
    band: tuple[float, float] | None = None
    note: str = ""
    written: str = ""
    within: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        """Find the miss of two numbers."""
        if self.miss is None and self.computed is not None and self.reference:
            object.__setattr__(self, "miss", self.computed / self.reference - 1.0)
        if self.role == "predicted" and abs(self.miss or 0.0) > LARGE and not self.note:
            raise ValueError(f"{self.what}, {self.quantity} misses by {self.miss:.3g}: say why, and what is being done")

    @property
    def held(self) -> bool | None:
        """Whether the band holds the reference; None where there is no band."""
        if self.band is None or self.reference is None:
            return None
        return self.band[0] <= self.reference <= self.band[1]


Record = dict[str, dict[str, dict[str, Any]]]
"""Date and rows of each study of each version."""


def read_record() -> Record:
    """Return what was kept."""
    return json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}


def keep(study: str, rows: Sequence[Comparison], from_page: bool = False) -> None:
    """Put the rows of a study into the record, and write page and summary anew.

    ``from_page``: the rows are what the study's own table says, with the digits it has; nothing was run.
    """
    if study not in STUDIES or not rows:
        raise ValueError(f"{study}: {len(rows)} rows; allowed: rows of one of {', '.join(STUDIES)}")
    record = read_record()
    own = record.setdefault(__version__, {})
    entry = {"date": datetime.date.today().isoformat(), "from_page": from_page}
    own[study] = {**entry, "rows": [_row(one) for one in rows]}
    record[__version__] = {name: own[name] for name in STUDIES if name in own}
    RECORD.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", "utf-8")
    write_pages(record)
    print(f"{study}: {len(rows)} comparisons kept in {RECORD.relative_to(ROOT)}", flush=True)


def write_pages(record: Record) -> None:
    """Write the page, and what the README has of it."""
    for path, text in pages(record).items():
        path.write_text(text, "utf-8")


def pages(record: Record) -> dict[Path, str]:
    """Return the pages as the record makes them: `docs/validation.md`, and the README with its two parts."""
    studies = latest(record)
    readme = written(README.read_text("utf-8"), "written down before", written_before(studies))
    return {PAGE: page(record), README: written(readme, "how well it is known", totals_by_kind(studies))}


def _row(one: Comparison) -> dict[str, Any]:
    """Return a comparison as the record has it, with six digits: more are those of no measurement."""
    row = {key: value for key, value in dataclasses.asdict(one).items() if value not in (None, "")}
    return {key: _rounded(value) for key, value in row.items()}


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.6g}")
    return [_rounded(one) for one in value] if isinstance(value, tuple) else value


class Kept:
    """A study as it was last kept: version, date, rows."""

    def __init__(self, study: str, version: str, entry: dict[str, Any]) -> None:
        self.study, self.version, self.date, self.from_page = study, version, entry["date"], entry["from_page"]
        self.title, self.script, self.measured = STUDIES[study]
        self.rows = [
            Comparison(**{"reference": None, "computed": None, **row, **{key: _pair(row.get(key)) for key in PAIRS}})
            for row in entry["rows"]
        ]
        predicted = [one for one in self.rows if one.role == "predicted" and one.miss is not None]
        self.worst = max(predicted, key=lambda one: abs(one.miss or 0.0), default=None)

    def kind_of(self, row: Comparison) -> str:
        """Return the kind of what a row is held against."""
        return self.measured if row.against == MEASURED else KINDS.get(row.against, OTHER_CODES)


PAIRS = ("band", "within")
"""Fields of a comparison that JSON has as lists."""


def _pair(pair: list[Any] | None) -> tuple[Any, Any] | None:
    return None if pair is None else (pair[0], pair[1])


def latest(record: Record) -> list[Kept]:
    """Return each study as its newest version kept it."""
    found = []
    for study in STUDIES:
        versions = [name for name in record if study in record[name]]
        if versions:
            version = max(versions, key=lambda name: record[name][study]["date"])
            found.append(Kept(study, version, record[version][study]))
    return found


def percents(share: float) -> str:
    """Return a miss in percent, with as many digits as it has."""
    if share == 0.0:
        return "0"
    return f"{100.0 * share:+.1f} %" if abs(share) >= 5e-4 else f"{100.0 * share:+.1g} %"


def number(value: float | None) -> str:
    """Return a number, a dash where there is none."""
    return "–" if value is None else f"{value:.5g}"


def totals(studies: Iterable[Kept]) -> str:
    """Return the table of studies: how many predictions, how near, how many bands hold."""
    return _totals((one.title, one.rows) for one in studies)


def totals_by_kind(studies: Iterable[Kept]) -> str:
    """Return the table of kinds, each alone: a closed form that is met says nothing of a machine."""
    return _totals(_by_kind(studies).items())


def _by_kind(studies: Iterable[Kept]) -> dict[str, list[Comparison]]:
    kinds: dict[str, list[Comparison]] = {kind: [] for kind in (SHOCKS, BARS, TAYLOR, *KINDS.values(), OTHER_CODES)}
    for study in studies:
        for row in study.rows:
            kinds[study.kind_of(row)].append(row)
    return {kind: rows for kind, rows in kinds.items() if rows}


def _misses(rows: Iterable[Comparison]) -> list[float]:
    """Return the sizes of the misses of the predictions, the smallest first."""
    return sorted(abs(row.miss) for row in rows if row.role == "predicted" and row.miss is not None)


def _totals(groups: Iterable[tuple[str, Sequence[Comparison]]]) -> str:
    lines = []
    for title, rows in groups:
        misses = _misses(rows)
        held = [row.held for row in rows if row.held is not None and row.role == "predicted"]
        median = f"{100.0 * statistics.median(misses):.2g} %" if misses else "–"
        largest = f"{100.0 * misses[-1]:.2g} %" if misses else "–"
        bands = f"{sum(held)} of {len(held)}" if held else "–"
        counts = [sum(row.role == role for row in rows) for role in ("fitted", "shown")]
        lines.append([title, str(len(misses)), median, largest, bands, *map(str, counts)])
    heads = ["Held against", "predicted", "median miss", "largest", "bands that hold", "fitted", "shown"]
    return table(heads, lines)


def of_all(one: Comparison) -> str:
    """Return how many of the measured values lie in the band, in words."""
    return "–" if one.within is None else f"{one.within[0]} of {one.within[1]}"


def written_before(studies: Iterable[Kept]) -> str:
    """Return what was predicted before it was measured, or before the measured was opened: sentences and a table."""
    rows, sentences = [], []
    for study in studies:
        own = [row for row in study.rows if row.written]
        if own:
            settings = len({row.what for row in own})
            misses = "; ".join(
                _written_misses([row for row in own if row.quantity == quantity])
                for quantity in dict.fromkeys(row.quantity for row in own)
            )
            sentences.append(
                f"{study.title}: {settings} settings were predicted, and written down, before their blows were opened; "
                f"{misses}."
            )
        rows += own
    if not rows:
        return "No prediction was written down before its measurement was opened."
    if any(row.held is False for row in rows):
        sentences.insert(0, "**The next setting of a machine is not yet predicted.**")
        sentences.append(SAME_SETTING)
    heads = [
        "Setting",
        "Quantity",
        "Written down",
        "Predicted",
        "95 % band of a blow",
        "Measured",
        "Miss",
        "Blows in it",
    ]
    cells = []
    for row in rows:
        band = "–" if row.band is None else f"{row.band[0]:.4g} to {row.band[1]:.4g}"
        numbers = [number(row.computed), band, number(row.reference), percents(row.miss or 0.0), of_all(row)]
        cells.append([row.what, f"{row.quantity} ({row.unit})", row.written, *numbers])
    return "\n".join([*textwrap.wrap(" ".join(sentences), WIDTH), "", table(heads, cells, 3)])


def _written_misses(rows: Sequence[Comparison]) -> str:
    """Return how far the predictions of a quantity are off, and how many measured values lie in their bands."""
    misses = sorted((row.miss for row in rows if row.miss is not None), key=abs)
    pairs = [row.within for row in rows if row.within is not None]
    inside, count = (sum(pair[k] for pair in pairs) for k in (0, 1))
    ends = f"{100.0 * misses[0]:+.0f} to {100.0 * misses[-1]:+.0f} %"
    return f"{rows[0].quantity}: {ends}, {inside} of {count} blows in their 95 % bands"


def history(record: Record) -> str:
    """Return the table of versions: predictions of each kind, and how near they come."""
    lines = []
    for version, own in record.items():
        kept = [Kept(study, version, entry) for study, entry in own.items()]
        for kind, rows in _by_kind(kept).items():
            date = max(one.date for one in kept if any(one.kind_of(row) == kind for row in one.rows))
            misses = _misses(rows)
            near = [str(sum(miss <= most for miss in misses)) for most in NEAR]
            lines.append([version, date, kind, str(len(misses)), *near])
    heads = ["Version", "Date", "Held against", "Predicted", *(f"within {100.0 * most:.0f} %" for most in NEAR)]
    return table(heads, lines, 3)


def line(one: Comparison, notes: Sequence[str]) -> list[str]:
    """Return the cells of a comparison; its note is named by its place among all."""
    band = "–" if one.band is None else f"{one.band[0]:.4g} to {one.band[1]:.4g}"
    held = {True: "yes", False: "no", None: "–"}[one.held]
    if one.within is not None:
        held += f", {of_all(one)}"
    miss = "–" if one.miss is None else percents(one.miss)
    unit = f" ({one.unit})" if one.unit not in ("", "1") else ""
    quantity = f"{one.quantity}{unit}"
    note = f"{notes.index(one.note) + 1}" if one.note else ""
    numbers = [number(one.reference), number(one.computed), miss, band, held, note]
    return [one.what, quantity, one.against, one.role, *numbers]


SAME_SETTING = "All other predictions of shock pulses are of later blows at the setting that was fitted."
"""What the other rows of measured shock pulses are: later blows of Li & Ma 2019, records of a drop table kept out."""
HEADS = ("What", "Quantity", "Against", "Role", "Reference", "Computed", "Miss", "Band", "Held", "Note")
WORDS = 4
"""Columns of words among them."""
INTRODUCTION = """\
# Validation: what is computed against what is known

Made by `make validate` from runs, never by hand; the numbers are in `docs/validation.json`. Each row holds one number
against a measurement, a published or specified number, a closed form, or another code. Its role:

- **predicted**: nothing was fitted to it;
- **fitted**: it chose a value, so that agreement shows nothing;
- **shown**: not comparable; the note says why.

The band is the range of what is computed when inputs move within what is known of them (95 %), and "held" says
whether the reference lies in it. What was fitted how is on the pages of the studies: [records](fit-measured.md),
[Taylor bars](taylor-bars.md), [split Hopkinson bars](hopkinson.md#real-shots), [the paper](reproduction.md),
[elements](fem-theory.md#measured).
"""


def weakest(studies: Iterable[Kept]) -> str:
    """Return the worst prediction of each of the weakest studies, and what is being done."""
    worst = [(one.title, one.worst) for one in studies if one.worst is not None]
    worst.sort(key=lambda pair: -abs(pair[1].miss or 0.0))
    lines = []
    for title, one in worst[:WEAKEST]:
        lines.append(f"- **{title}**: {one.what}, {one.quantity}: {percents(one.miss or 0.0)}. {_sentence(one.note)}")
    return "\n".join(lines)


def _section(one: Kept) -> list[str]:
    """Return the part of the page of one study."""
    notes = list(dict.fromkeys(row.note for row in one.rows if row.note))
    made = f"`python scripts/validate/{one.script}`, version {one.version}, {one.date}"
    made += ": as its own table has the numbers" if one.from_page else ""
    told = [f"{k}. {_sentence(note)}" for k, note in enumerate(notes, 1)]
    cells = table(HEADS, [line(row, notes) for row in one.rows], WORDS)
    return [f"## {one.title}\n", f"{made}.\n", cells, "", *told, *([""] if told else [])]


def _notes_of_written(studies: Iterable[Kept]) -> list[str]:
    """Return why the predictions that were written down before miss, each reason once."""
    return list(dict.fromkeys(row.note for one in studies for row in one.rows if row.written and row.note))


def _sentence(note: str) -> str:
    return f"{note[:1].upper()}{note[1:].rstrip('.')}." if note else ""


def page(record: Record) -> str:
    """Return the page."""
    studies = latest(record)
    count = sum(len(one.rows) for one in studies)
    parts = [INTRODUCTION, "## Written down before it was measured\n", written_before(studies), ""]
    parts += [*(f"- {_sentence(note)}" for note in _notes_of_written(studies)), ""]
    parts += ["## Totals\n", f"{count} comparisons, by what they are held against:\n"]
    parts += [totals_by_kind(studies), "", "By study:\n", totals(studies), ""]
    parts += ["## The weakest predictions\n", "The worst row of each study, the three worst studies first.\n"]
    parts += [weakest(studies), "", "## History\n", history(record), ""]
    for one in studies:
        parts += _section(one)
    return "\n".join(parts)
