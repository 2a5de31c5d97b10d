"""A map asked for in plain values: settings with their ranges as texts, as the command line and Python take them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from strikewave.base.compile_progress import compiling_shown
from strikewave.base.errors import InputError, nearest
from strikewave.cases.case import Case
from strikewave.studies.axes import Axis, axis_of, units_of
from strikewave.studies.engine.runner import share_reporter
from strikewave.studies.engine.variables import read_ends, read_list
from strikewave.studies.map.defaults import EQUAL, POINTS, TRAIN, X, Y
from strikewave.studies.map.study import MapStudy, make_map, plan_of

MOST_PANELS = 6
"""Most values of a third setting."""


@compiling_shown()
def map(
    case: Case,
    x: str = X,
    y: str = Y,
    *,
    panels: str | None = None,
    points: tuple[int, int] = POINTS,
    log: Sequence[str] = (),
    blows: int | None = None,
    train: int = TRAIN,
    want_cv: float = EQUAL,
    workers: int = 1,
    progress: Callable[[float], None] | None = None,
) -> MapStudy:
    """Map a machine over two of its settings: how even its blows are, and the nearest setting with equal blows.

    Parameters
    ----------
    case : Case
        Of a rotary machine.
    x, y : str, optional
        Setting along each axis, with a range or without: ``machine.speed=400..1000 rpm``. Without one it goes from
        half to twice the value of the case.
    panels : str, optional
        Third setting, with the value of each panel: ``object.damper=10 N s/m, 40 N s/m``.
    points : (int, int), optional
        Along x and y.
    log : sequence of str, optional
        Axes with logarithmic spacing: ``x``, ``y``.
    blows : int, optional
        That of the case by default.
    train : int, optional
        Blows of the longer train that names the regime; 0 for none.
    want_cv : float, optional
        Largest coefficient of variation of equal blows.
    workers : int, optional
        Processes. With more than one, call it below ``if __name__ == "__main__":``.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Returns
    -------
    MapStudy
        Fields over both settings, and the nearest setting with equal blows, if there is one.

    Raises
    ------
    InputError
        If the case has no such setting, a range is none, or the map is too large.

    Examples
    --------
    >>> import strikewave
    >>> case = strikewave.load_case("li-ma-2019")
    >>> study = strikewave.map(case, "machine.speed=700..730 rpm", points=(2, 2), blows=3, train=0)
    >>> study.field("cv").shape
    (1, 2, 2)
    """
    plan = plan_of(case, axes_of(case, (x, y, panels), points, log), blows, train)
    return make_map(plan, want_cv, workers, progress=share_reporter(progress))


def axes_of(
    case: Case, given: tuple[str, str, str | None], points: tuple[int, int], log: Sequence[str]
) -> tuple[Axis, ...]:
    """Return the axes of a map from what was typed."""
    axes = []
    for option, text, size in zip(("x", "y"), given[:2], points, strict=True):
        path, equals, typed = (part.strip() for part in str(text).partition("="))
        _check_path(case, path)
        ends = read_ends(case, path, typed)
        if equals and ends is None:
            raise InputError(f"--{option}", text, "setting=low..high", f'such as --{option} {X}="400..1000 rpm"')
        axes.append(axis_of(case, path, ends, size, option in log))
    if given[2] is None:
        return tuple(axes)
    path, _, listed = (part.strip() for part in given[2].partition("="))
    _check_path(case, path)
    values = read_list(case, path, listed)
    if not 1 <= len(values) <= MOST_PANELS:
        allowed = f"setting=value,value, with 1 to {MOST_PANELS} values"
        raise InputError("--panels", given[2], allowed, 'such as object.damper="10 N s/m, 40 N s/m"')
    return (*axes, Axis(path, *units_of(path, values[0]), tuple(sorted(v.si for v in values))))


def _check_path(case: Case, path: str) -> None:
    if path not in case.values():
        raise InputError(path, path, "a quantity of the case", nearest(path, case.values()))
