"""What the blows of a machine are now, and what may be changed to make them equal; it runs in processes of the app."""

from __future__ import annotations

import re
from pathlib import Path

import strikewave
from strikewave.analyses.machine.figures_of import figures_of
from strikewave.analyses.machine.quick_look import quick_look
from strikewave.analyses.machine.result import INTERVAL
from strikewave.base.shock_quantities import PULSE_WIDTH, RIGID_PEAK
from strikewave.base.units import in_unit
from strikewave.cases.case import Case
from strikewave.studies.design.design_file import load_design
from strikewave.studies.engine.variables import read_variable
from strikewave.studies.settings.study import is_rotary
from strikewave.studies.sweep.plan import varied_texts
from strikewave.web.case.fields import edited_fields
from strikewave.web.case.loading import loaded
from strikewave.web.case.state import CaseSource

NOW = (
    ("interval", "interval", INTERVAL),
    ("peak", "first.rigid_peak", RIGID_PEAK),
    ("width", "first.width", PULSE_WIDTH),
)
"""What can be asked of the blows: key of the form, name of the result, what it measures."""
STUDY = Path(strikewave.__file__).parent / "examples" / "studies" / "equal-blows.toml"
"""What equal blows are, and which support of the object is looked for, as shares of that of its case."""
ANY_MACHINE = re.compile(r"(%|= 0|smallest)$")
"""Ends of goals without a quantity: a force or a length is a limit of the machine of that study alone."""
RUNS = 300
"""Runs of a page: fewer than of the study, for somebody waits."""


def wishes(source: CaseSource) -> dict[str, dict[str, list[str]]]:
    """Return what stands in the forms at first, by study and key: the blows as they are, and the support to be varied.

    Examples
    --------
    >>> wishes(CaseSource("li-ma-2019", "", (), ""))["design"]["vary"][0]
    'object.damper=20..120 N s/m'
    """
    case = loaded(source)
    figures = figures_of(quick_look(case).blows)
    now = {key: [f"{in_unit(figures[name], *of.units):.4g} {of.usual}"] for key, name, of in NOW if name in figures}
    return {"settings": now, "design": _equal_blows(case)} if is_rotary(case) else {}


def _equal_blows(case: Case) -> dict[str, list[str]]:
    """Return what the study of equal blows asks, its ranges in proportion to the support of another case."""
    study, fields, ranges = load_design(STUDY), edited_fields(case), []
    for text in varied_texts(study.file.vary):
        axis = read_variable(study.case, text).axis
        one, of_study = fields.get(axis.path), study.case.values()[axis.path].si
        if one is not None and one.value > 0.0:
            low, high = (f"{end / of_study * one.value:.4g}" for end in (axis.values[0], axis.values[-1]))
            ranges.append(f"{axis.path}={low}..{high} {one.unit}".strip())
    goals = [goal for goal in study.file.goals if ANY_MACHINE.search(goal)]
    return {"vary": ranges, "goals": goals, "analysis": [study.file.analysis], "runs": [str(RUNS)]}
