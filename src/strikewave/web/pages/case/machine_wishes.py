"""What the blows of a machine are now, and what may be changed to make them equal; it runs in processes of the app."""

from __future__ import annotations

from strikewave.analyses.machine.figures_of import figures_of
from strikewave.analyses.machine.quick_look import quick_look
from strikewave.base.units import in_unit
from strikewave.cases.case import Case
from strikewave.studies.settings.study import is_rotary
from strikewave.web.case.fields import edited_fields
from strikewave.web.case.loading import loaded
from strikewave.web.case.state import CaseSource

NOW = (
    ("interval", "interval", "s", "ms"),
    ("peak", "first.rigid_peak", "m/s^2", "g"),
    ("width", "first.width", "s", "us"),
)
"""What can be asked of the blows: key of the form, name of the result, SI unit, unit shown."""
REACH = {"object.damper": (1.0, 6.0), "object.preload": (0.25, 2.0), "object.stop_restitution": (0.2, 1.0)}
"""Support of the object over that of the case in which equal blows are looked for, as the study of
docs/studies/equal-blows.toml does."""
EQUAL = ("cv < 2 %", "missed = 0", "stop_force smallest")
"""What equal blows are: peaks that agree as the study asks, none missed; and of these the easiest on the stop."""
RUNS = 300


def wishes(source: CaseSource) -> dict[str, dict[str, list[str]]]:
    """Return what stands in the forms at first, by study and key: the blows as they are, and the support to be varied.

    Examples
    --------
    >>> wishes(CaseSource("li-ma-2019", "", (), ""))["design"]["vary"][0]
    'object.damper=20..120 N s/m'
    """
    case = loaded(source)
    figures = figures_of(quick_look(case).blows)
    now = {key: [f"{in_unit(figures[name], si, unit):.4g} {unit}"] for key, name, si, unit in NOW if name in figures}
    equal = {"vary": _ranges(case), "goals": list(EQUAL), "analysis": ["fast"], "runs": [str(RUNS)]}
    return {"settings": now, "design": equal} if is_rotary(case) else {}


def _ranges(case: Case) -> list[str]:
    fields, ranges = edited_fields(case), []
    for path, ends in REACH.items():
        one = fields.get(path)
        if one is not None and one.value > 0.0:
            low, high = (f"{share * one.value:.4g}" for share in ends)
            ranges.append(f"{path}={low}..{high} {one.unit}".strip())
    return ranges
