"""Least squares in the unit cube: the best place, how the misfit rises about it, and runs side by side.

Every coordinate is the place of a value between its bounds, 0 to 1, so that all have one scale and a standard error of
a tenth means the same for each. Residuals are over their standard uncertainty.

What they come to can be kept in a store, by the content of the function and of what it is given, so that the same fit
asked again reads it. A fit takes the same way each time, so all that was kept is asked for again.
"""

from __future__ import annotations

import base64
import contextlib
import functools
import json
import math
from collections.abc import Callable, Iterator, Sequence
from contextvars import ContextVar
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from strikewave.studies.engine.evaluation import RunOutcome, content_key
from strikewave.studies.engine.pools import Pool, each_on
from strikewave.studies.engine.store import RunStore
from strikewave.studies.fit.covariance import Estimate
from strikewave.uncertainty.draws import latin_hypercube
from strikewave.uncertainty.runs import on_threads, or_none

Item = TypeVar("Item")
Result = TypeVar("Result")

MOST_KEPT = 64 * 2**20
"""Most bytes that a fit adds to its store: 5 million samples of residuals, some thousand runs on a pulse of
`strikewave.studies.fit.measured.MOST_SAMPLES`. What comes after them is made again where it is asked for again."""

_pool: ContextVar[Pool | None] = ContextVar("pool of the fit", default=None)
_kept: ContextVar[KeptResults | None] = ContextVar("kept results of the fit", default=None)


@contextlib.contextmanager
def running_on(pool: Pool | None) -> Iterator[None]:
    """Run the fits within on a pool; without one, on threads of this process."""
    if pool is None:
        yield
        return
    with pool:
        before = _pool.set(pool)
        try:
            yield
        finally:
            _pool.reset(before)


@contextlib.contextmanager
def keeping_in(store: RunStore | None) -> Iterator[None]:
    """Keep the results of the fits within in a store, and read known ones; without a store, keep nothing."""
    before = _kept.set(None if store is None else KeptResults(store))
    try:
        yield
    finally:
        _kept.reset(before)


def each_or_none(function: Callable[[Item], Result], items: list[Item]) -> list[Result | None]:
    """Return a result for each item, in their order; None where it could not be computed.

    Processes must be able to import the function: it is one of a module, a method, or a partial of such.
    """
    kept = _kept.get()
    return _made(function, items) if kept is None else kept.each_or_none(function, items)


def result_of(function: Callable[[Item], Result], item: Item) -> Result:
    """Return the result for one item; what makes it fail is raised."""
    kept = _kept.get()
    found = None if kept is None else kept.each_or_none(function, [item])[0]
    return function(item) if found is None else found


def _made(function: Callable[[Item], Result], items: list[Item]) -> list[Result | None]:
    pool = _pool.get()
    if len(items) == 1:  # threads and processes would take longer to begin
        return [or_none(function, items[0])]
    return on_threads(function, items) if pool is None else each_on(pool, functools.partial(or_none, function), items)


class KeptResults:
    """Results of the functions of a fit, kept in a store: numbers, lists and arrays of them; others are made anew.

    Parameters
    ----------
    store : RunStore
        Store that is read for known results and keeps the others.
    """

    def __init__(self, store: RunStore) -> None:
        self._store, self._known, self._size = store, store.known(), 0
        self._functions: dict[Callable[..., Any], bytes] = {}

    def each_or_none(self, function: Callable[[Item], Result], items: list[Item]) -> list[Result | None]:
        """Return a result for each item; those that the store has are read."""
        try:
            if function not in self._functions:
                self._functions[function] = content_key(function)
            keys = [content_key((self._functions[function], item)) for item in items]
        except TypeError:
            return _made(function, items)
        missing = {key: item for key, item in zip(keys, items, strict=True) if key not in self._known}
        made = dict(zip(missing, _made(function, list(missing.values())), strict=True)) if missing else {}
        self._keep(made)
        known = [key for key in dict.fromkeys(keys) if key not in made]
        read = {key: _read(text) for key, (text, _) in zip(known, self._store.documents(known), strict=True)}
        return [made[key] if key in made else read[key] for key in keys]

    def _keep(self, made: dict[bytes, Any]) -> None:
        texts = {key: _text(result) for key, result in made.items()}
        finished = [(key, RunOutcome(document=text)) for key, text in texts.items() if text]
        self._size += sum(len(outcome.document) for _, outcome in finished)
        if finished and self._size <= MOST_KEPT:
            self._store.keep((), finished)
            self._known |= {key for key, _ in finished}


def _text(result: Any) -> str:
    """Return a result as a text, exact to the bit; empty of one that is not kept."""
    if isinstance(result, np.ndarray) and result.ndim == 1 and result.dtype == np.float64:
        return json.dumps(base64.b64encode(result.astype("<f8").tobytes()).decode())
    numbers = result if isinstance(result, list) else [result]
    return json.dumps(result) if result is None or all(isinstance(number, float) for number in numbers) else ""


def _read(text: str) -> Any:
    """Return a result from its text."""
    found = json.loads(text)
    if not isinstance(found, str):
        return found
    return np.frombuffer(base64.b64decode(found), "<f8").astype(np.float64)


Array = NDArray[np.float64]
Residuals = Callable[[Array], Array]
"""Takes a place; returns the residuals, or raises what `each_or_none` takes for a failure."""

SCREENED, MOST_SCREENED = 8, 32
"""Places tried before the search, for each coordinate and at most: chosen so that a valley a fifth as wide as the
bounds is met, at the cost of one search."""
STARTS, MOST_STARTS = 3, 8
"""Searches: from the place of the case, and from the best of those tried; at most, where they end apart and none
well."""
ALIKE = 0.01  # distance of two ends that count as one: searches agree better, but along undetermined directions
APART = 0.1  # distance of two places that count as different starts
STEP, FINAL_STEP = 1e-4, 5e-4
"""Steps of the slopes: to one side on the way, to both sides at the end. A run errs by 1e-8, so the first is good to
1e-4, and the last, whose curvature cancels, to 1e-5."""
STAIRS = 3.0
"""Moves that residuals feel at once, over which slopes are taken: they are then good to a third, and by both sides to a
few per cent."""
ACCURACY = 1e-7  # step of a coordinate at which a search ends: far below any standard error that data can have
ROUGH = 1e-4  # the same for searches from other places: enough to see where they end
MOST_STEPS = 40  # most steps of a search: a smooth one takes five to fifteen
FAILED_OVER = 10.0  # residuals of a place that cannot be run, over the largest at the start: worse than any that can
QUADRATIC = 0.3
"""Share by which the misfit at two standard errors may differ from a parabola's: beyond, the profile is followed; a
bound moves by half of it."""
PROFILE_STEPS = 12  # halvings of the interval in which an end of a profile lies: to 1e-3 of it and better


class Search:
    """Least squares over the unit cube, on all cores; it remembers the best place, for an interrupt.

    Parameters
    ----------
    residuals : callable
        See `Residuals`.
    size : int
        Number of dimensions of the cube.
    advance : callable, optional
        Called with the number of runs so far and the smallest misfit.
    stairs : ndarray, optional
        Step of each coordinate that first changes the residuals; 0 where they change smoothly.
    """

    def __init__(
        self,
        residuals: Residuals,
        size: int,
        advance: Callable[[int, float], None] | None = None,
        stairs: Array | None = None,
    ) -> None:
        self._residuals, self.size, self._advance = residuals, size, advance
        self._least = STAIRS * (np.zeros(size) if stairs is None else stairs)
        self.runs = 0
        self.best: tuple[float, Array] | None = None
        self._failed: Array | None = None
        self._last: dict[bytes, Array] = {}

    @property
    def residuals(self) -> Residuals:
        """Residuals that the search minimizes; new ones keep only the best place of the old ones."""
        return self._residuals

    @residuals.setter
    def residuals(self, other: Residuals) -> None:
        if other != self._residuals:
            self._residuals, self._last = other, {}
            self.best = self.best and (math.inf, self.best[1])

    def of_others(self, residuals: Residuals) -> Search:
        """Return a search of other residuals of the same cube, which goes on counting the runs."""
        search = Search(residuals, self.size, self._advance, self._least / STAIRS)
        search.runs = self.runs
        return search

    def many(self, places: Sequence[Array]) -> list[Array | None]:
        """Return the residuals at some places; None where they cannot be found."""
        found = each_or_none(self._residuals, list(places))
        for place, residuals in zip(places, found, strict=True):
            self.runs += 1
            if residuals is not None and (self.best is None or float(residuals @ residuals) < self.best[0]):
                self.best = (float(residuals @ residuals), place)
        if self._advance is not None and self.best is not None:
            self._advance(self.runs, self.best[0])
        return found

    def at(self, place: Array) -> Array:
        """Return the residuals at a place, and such as no other has where it cannot be run."""
        key = place.tobytes()
        if key not in self._last:  # a search asks for the residuals, then for the slopes there
            found = self.many([place])[0]
            assert self._failed is not None
            self._last = {key: self._failed if found is None else found}
        return self._last[key]

    def begin(self, place: Array) -> Array:
        """Return the residuals at the first place; what makes it fail is raised."""
        found = result_of(self._residuals, place)
        self._failed = np.full(found.size, FAILED_OVER * max(float(np.max(np.abs(found))), 1.0))
        self.best = (float(found @ found), place)
        return found

    def slopes(self, place: Array, middle: Array, step: float, both: bool = False) -> Array:
        """Return the slopes of the residuals, from one side or from both; 0 where neither can be run."""
        steps = np.maximum(step, self._least)
        signs = np.where(place + steps <= 1.0, 1.0, -1.0)
        moves = list(np.diag(signs * steps))
        found = self.many([place + move for move in moves])
        others = self.many([np.clip(place - move, 0.0, 1.0) for move in moves]) if both else [None] * self.size
        columns = []
        for k, (one, other) in enumerate(zip(found, others, strict=True)):
            move = moves[k][k]
            back = place[k] - max(min(place[k] - move, 1.0), 0.0)
            if one is not None and other is not None and back != 0.0:
                columns.append((one - other) / (move + back))
            elif one is not None:
                columns.append((one - middle) / move)
            elif other is not None and back != 0.0:
                columns.append((middle - other) / back)
            else:
                columns.append(np.zeros_like(middle))
        return np.column_stack(columns)

    def descend(
        self, start: Array, free: Sequence[int] | None = None, accuracy: float = ACCURACY
    ) -> tuple[Array, Array]:
        """Return the best place near a start, and the residuals there; only the ``free`` coordinates move."""
        from scipy.optimize import least_squares

        moving = list(range(self.size)) if free is None else list(free)
        if not moving:
            return start, self.at(start)

        def whole(part: Array) -> Array:
            place = start.copy()
            place[moving] = part
            return place

        def slopes(part: Array) -> Array:
            place = whole(part)
            return self.slopes(place, self.at(place), STEP)[:, moving]

        inside = np.clip(start[moving], 1e-6, 1.0 - 1e-6)
        answer = least_squares(
            lambda part: self.at(whole(part)),
            inside,
            slopes,
            bounds=(0.0, 1.0),
            xtol=accuracy,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=MOST_STEPS,
        )
        return whole(answer.x), answer.fun

    def wide(
        self, start: Array, explained: Callable[[Array], bool] = lambda residuals: True
    ) -> list[tuple[Array, Array]]:
        """Return where searches from several starts end, the best first.

        They are `STARTS`, and more while their ends differ and none leaves residuals that are ``explained`` by noise.
        """
        tried = [*latin_hypercube(self.size, min(SCREENED * self.size, MOST_SCREENED))]
        found = [(float(r @ r), u) for u, r in zip(tried, self.many(tried), strict=True) if r is not None]
        starts, ends = [start], list[tuple[Array, Array]]()
        for _, place in sorted(found, key=lambda one: one[0]):
            if len(starts) < MOST_STARTS and all(np.linalg.norm(place - one) > APART for one in starts):
                starts.append(place)
        for one in starts:
            if len(ends) >= STARTS and (_agree(ends) or any(explained(left) for _, left in ends)):
                break
            ends.append(self.descend(one, accuracy=ACCURACY if one is start else ROUGH))
        own = ends[0][0]
        ends.sort(key=lambda one: float(one[1] @ one[1]))
        return ends if ends[0][0] is own else [self.descend(ends[0][0]), *ends[1:]]


def _agree(ends: Sequence[tuple[Array, Array]]) -> bool:
    """Tell whether searches ended at one place."""
    return all(float(np.linalg.norm(place - ends[0][0])) < ALIKE for place, _ in ends)


class ProfileEnds(NamedTuple):
    """Ends of the interval of a coordinate along its profile, and the profile: places and standard errors there."""

    low: float
    high: float
    places: Array
    deviations: Array


def profile(search: Search, found: Estimate, coordinate: int) -> ProfileEnds:
    """Follow the misfit along one coordinate, the others at their best, to where it has risen by `Estimate.reach`.

    The rise is counted in that of a parabola with the variance of the estimate, so that correlated noise is in it.
    """
    middle, reach = float(found.place[coordinate]), float(found.reach[coordinate])
    others = [k for k in range(found.place.size) if k != coordinate]
    whole = found.jacobian.T @ found.jacobian
    information = float(whole[coordinate, coordinate])
    if others:  # the Schur complement: the curvature with the others at their best
        cross = whole[others, coordinate]
        information -= float(cross @ np.linalg.pinv(whole[np.ix_(others, others)]) @ cross)
    variance = float(found.covariance[coordinate, coordinate])
    per = max(information * variance, np.finfo(float).tiny)
    points = {middle: 0.0}

    def risen(value: float, near: Array) -> tuple[float, Array]:
        """Return by how many standard errors the misfit has risen at a value, and the place."""
        place = near.copy()
        place[coordinate] = value
        place, residuals = search.descend(place, others)
        points[value] = math.sqrt(max(float(residuals @ residuals) - found.misfit, 0.0) / per)
        return points[value], place

    def between(inner: float, outer: float, near: Array) -> float:
        """Return where the misfit has risen by `reach` between two values."""
        value = outer
        for _ in range(PROFILE_STEPS):
            low, high = points[inner], points[outer]
            # by the chord, but never so near an end that the interval hardly shrinks
            value = inner + min(max((reach - low) / (high - low), 0.1), 0.9) * (outer - inner)
            rise, place = risen(value, near)
            if abs(rise - reach) < 0.005 * reach:  # 0.5 %: below what the covariance itself is known to
                break
            inner, outer, near = (value, outer, place) if rise < reach else (inner, value, near)
        return value

    ends = []
    for sign, bound in ((-1.0, 0.0), (1.0, 1.0)):
        inner, near, end = middle, found.place, bound
        for factor in (1.0, 2.0, 4.0, 8.0, math.inf):  # doubled until it has risen so far, or the bound is met
            far = middle + sign * factor * reach * math.sqrt(variance)
            outer = far if 0.0 < far < 1.0 else bound
            rise, place = risen(outer, near)
            if rise >= reach:
                end = between(inner, outer, near)
                break
            if outer == bound:
                break
            inner, near = outer, place
        ends.append(end)
    order = sorted(points)
    signed = [math.copysign(points[value], value - middle) for value in order]
    return ProfileEnds(ends[0], ends[1], np.array(order), np.array(signed))


def is_quadratic(search: Search, found: Estimate, coordinate: int) -> bool:
    """Tell whether the misfit at two standard errors of a coordinate is that of a parabola, with the others along."""
    variance = float(found.covariance[coordinate, coordinate])
    if variance <= 0.0:
        return True
    along = 2.0 * found.covariance[:, coordinate] / math.sqrt(variance)
    expected = float(np.sum((found.jacobian @ along) ** 2))
    places = [found.place + along, found.place - along]
    if any(np.any((place < 0.0) | (place > 1.0)) for place in places):
        return False
    rises = [None if one is None else float(one @ one) - found.misfit for one in search.many(places)]
    return all(rise is not None and abs(rise - expected) <= QUADRATIC * expected for rise in rises)
