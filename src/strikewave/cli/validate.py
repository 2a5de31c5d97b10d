"""``strikewave validate``: check a case or a set-up of split bars and list its values with their provenance."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from strikewave.base import declare
from strikewave.base.json_document import head
from strikewave.base.quantities import PROVENANCES, StatedValue, Value
from strikewave.base.result import Notice
from strikewave.cases.case import load_case
from strikewave.cases.case_files import read_case_text
from strikewave.reporting.layout import MORE, keys, texts
from strikewave.reporting.options.output import Shown
from strikewave.reporting.options.shared import CaseName, Changes
from strikewave.reporting.terminal import print_json, say, show_notices, table, tell


@declare.dataclass
class CheckedCase:
    """A case that was checked, and its values."""

    case: str = declare.word("name of the case")
    provenance: dict[str, int] = declare.word("how many values of each provenance")
    values: dict[str, StatedValue] = declare.named(StatedValue, "values by their paths")


def command(case: CaseName, *, changes: Changes = None, shown: Shown) -> int:
    """Check a case without running it.

    Lists every value and where it comes from, and names densities and moduli far from those of any known material.
    """
    from strikewave.analyses.by_tables import holds_setup
    from strikewave.analyses.check import check
    from strikewave.analyses.fem.build import build_model
    from strikewave.analyses.hopkinson.build import check_setup, load_setup, values_of
    from strikewave.cases.material_notices import far_numbers, material_notices

    if holds_setup(read_case_text(case)[0]):
        setup_case = load_setup(case, changes or ())
        missing, setup = check_setup(setup_case), setup_case.setup
        _show(setup.name, setup.title, dict(values_of(setup)), tuple(far_numbers(setup)), shown.json)
        if missing:
            say("not there yet: " + ", ".join(missing))
        return 0
    read = load_case(case, changes or ())
    check(read)
    if read.fem is not None:
        build_model(read)
    _show(read.name, read.title, read.values(), tuple(material_notices(read)), shown.json)
    if read.fem is not None:
        say(f"the mesh fits together; not checked: what boundaries and ties hold (strikewave fem {case} --check)")
    return 0


def _show(name: str, title: str, values: Mapping[str, Value], notices: Sequence[Notice], json: bool) -> None:
    """Print the values of a case with their provenance, and what a user should know of them."""
    counted = Counter[str](value.provenance for value in values.values())
    if json:
        checked = CheckedCase(name, dict(counted), {path: _stated(value) for path, value in values.items()})
        warnings = [notice.document() for notice in notices]
        print_json({**head({"value": "SI"}, warnings), **declare.content(checked)})
        return
    counts = ", ".join(f"{counted[provenance]} {provenance}" for provenance in PROVENANCES if counted[provenance])
    tell(f"valid: {counts}")
    shown = [[path, _typed(v), v.provenance, v.note] for path, v in values.items()]
    table(
        title or name,
        [*keys("field"), *texts("value"), *texts("provenance"), *texts("note", priority=MORE)],
        shown,
    )
    show_notices(notices)


def _typed(value: Value) -> str:
    """Return a value as it was typed, with its tolerance."""
    band = value.tolerance
    if band is None:
        return str(value.typed)
    return f"{value.typed} ± {band.typed}" + (f" ({band.distribution})" if band.distribution != "normal" else "")


def _stated(value: Value) -> StatedValue:
    """Return what the JSON document has of a value."""
    band = value.tolerance
    width = (None, None) if band is None else (value.half_width, band.distribution)
    return StatedValue(value.si, value.typed, value.provenance, value.note, *width)
