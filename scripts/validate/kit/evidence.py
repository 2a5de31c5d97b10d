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
from collections.abc import Iterable, Sequence
from typing import Any, Literal

from strikewave import __version__

from .pages import ROOT, table, written

RECORD = ROOT / "docs" / "validation.json"
PAGE = ROOT / "docs" / "validation.md"
README = ROOT / "README.md"
WEAKEST = 3
"""Studies whose worst prediction the page names first."""
LARGE = 0.10
"""A prediction that misses by more has to say why, and what is being done."""
NEAR = (0.01, 0.05, LARGE)
"""Misses within which predictions are counted."""

STUDIES = {
    "machines": ("Machines: built-in cases", "published.py"),
    "paper": ("Li & Ma 2019 by elements", "reproduction.py"),
    "shocks": ("Shocks of a drop table", "smd_shocks.py"),
    "felt": ("A drop tower on felt", "felt_tower.py"),
    "hopkinson": ("Split Hopkinson bars", "hopkinson_shots.py"),
    "strikers": ("Striker bars on incident bars", "striker_on_bar.py"),
    "taylor": ("Taylor bars by elements", "taylor_bars.py"),
    "closed forms": ("Closed forms", "closed_forms.py"),
    "other codes": ("Other codes", "other_codes.py"),
}
"""Title of each study, and the script that made its rows."""

KINDS = {
    "measured": "Measurements",
    "published": "Published and specified numbers",
    "specified": "Published and specified numbers",
    "simulated": "Published simulations",
    "closed form": "Closed forms",
}
"""Kind of what a number is held against, by the word for it; any other word is the name of a code."""
OTHER_CODES = "Other codes, run beside"

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

    def __post_init__(self) -> None:
        """Find the miss of two numbers."""
        if self.miss is None and self.computed is not None and self.reference:
            object.__setattr__(self, "miss", self.computed / self.reference - 1.0)
        if self.role == "predicted" and abs(self.miss or 0.0) > LARGE and not self.note:
            raise ValueError(f"{self.what}, {self.quantity} misses by {self.miss:.3g}: say why, and what is being done")

    @property
    def kind(self) -> str:
        """Kind of what it is held against."""
        return KINDS.get(self.against, OTHER_CODES)

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
    """Write the page, and the summary into the README."""
    PAGE.write_text(page(record), "utf-8")
    summary = totals_by_kind(latest(record))
    README.write_text(written(README.read_text("utf-8"), "how well it is known", summary), "utf-8")


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
        self.title, self.script = STUDIES[study]
        self.rows = [
            Comparison(**{"reference": None, "computed": None, **row, "band": _pair(row.get("band"))})
            for row in entry["rows"]
        ]
        predicted = [one for one in self.rows if one.role == "predicted" and one.miss is not None]
        self.worst = max(predicted, key=lambda one: abs(one.miss or 0.0), default=None)


def _pair(band: list[float] | None) -> tuple[float, float] | None:
    return None if band is None else (band[0], band[1])


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
    rows = [row for one in studies for row in one.rows]
    kinds = dict.fromkeys([*KINDS.values(), OTHER_CODES])
    return {kind: own for kind in kinds if (own := [row for row in rows if row.kind == kind])}


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


def history(record: Record) -> str:
    """Return the table of versions: predictions of each kind, and how near they come."""
    lines = []
    for version, own in record.items():
        kept = [Kept(study, version, entry) for study, entry in own.items()]
        date = max(one.date for one in kept)
        for kind, rows in _by_kind(kept).items():
            misses = _misses(rows)
            near = [str(sum(miss <= most for miss in misses)) for most in NEAR]
            lines.append([version, date, kind, str(len(misses)), *near])
    heads = ["Version", "Date", "Held against", "Predicted", *(f"within {100.0 * most:.0f} %" for most in NEAR)]
    return table(heads, lines, 3)


def line(one: Comparison, notes: Sequence[str]) -> list[str]:
    """Return the cells of a comparison; its note is named by its place among all."""
    band = "–" if one.band is None else f"{one.band[0]:.4g} to {one.band[1]:.4g}"
    held = {True: "yes", False: "no", None: "–"}[one.held]
    miss = "–" if one.miss is None else percents(one.miss)
    unit = f" ({one.unit})" if one.unit not in ("", "1") else ""
    quantity = f"{one.quantity}{unit}"
    note = f"{notes.index(one.note) + 1}" if one.note else ""
    numbers = [number(one.reference), number(one.computed), miss, band, held, note]
    return [one.what, quantity, one.against, one.role, *numbers]


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


def _sentence(note: str) -> str:
    return f"{note[:1].upper()}{note[1:].rstrip('.')}." if note else ""


def page(record: Record) -> str:
    """Return the page."""
    studies = latest(record)
    count = sum(len(one.rows) for one in studies)
    parts = [INTRODUCTION, "## Totals\n", f"{count} comparisons, by what they are held against:\n"]
    parts += [totals_by_kind(studies), "", "By study:\n", totals(studies), ""]
    parts += ["## The weakest predictions\n", "The worst row of each study, the three worst studies first.\n"]
    parts += [weakest(studies), "", "## History\n", history(record), ""]
    for one in studies:
        parts += _section(one)
    return "\n".join(parts)
