"""What is asked of settings: how the blows shall be, and what may be chosen for them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import MISSING, InputError
from strikewave.base.materials import Material
from strikewave.signal.pulse import WIDTH_FRACTION
from strikewave.specifications.ideal_pulses import HALF_SINE as HALF_SINE_SHAPE
from strikewave.specifications.reading import Specification, load_specification


@dataclass(frozen=True)
class BlowGoal:
    """What the blows shall be, SI; ``disc`` carries the strikers, ``stop_limit`` is the largest force of the stop.

    With a specification peak and width are those of its ideal pulse, and each blow is judged by it.
    """

    interval: float
    peak: float
    width: float
    disc: Material
    stop_limit: float | None = None
    specification: Specification | None = None


@dataclass(frozen=True)
class SettingsChoices:
    """What may be chosen: numbers of strikers, masses of one (empty: several about the case), what sets the width."""

    strikers: tuple[int, ...] = ()
    masses: tuple[float, ...] = ()
    vary: str = "frame"


def blow_goal(
    interval: float | None,
    peak: float | None,
    width: float | None,
    disc: Material,
    stop_limit: float | None = None,
    spec: str | None = None,
) -> BlowGoal:
    """Return what blows shall be: as given, or those of a specification, at its rate where no interval is given.

    Raises
    ------
    InputError
        If something is missing, or the specification cannot be read, or is of no half-sine.

    Examples
    --------
    >>> from strikewave.base.materials import Material, material
    >>> goal = blow_goal(None, None, None, material("45 steel"), spec="iec-60068-2-27-bump:100g-2ms")
    >>> round(goal.interval, 4), round(goal.peak / STANDARD_GRAVITY), round(goal.width * 1e3, 3)
    (0.3333, 100, 1.872)
    """
    specification = None
    if spec is not None:
        specification = load_specification(spec)
        pulse = specification.pulse
        if pulse.shape != HALF_SINE_SHAPE:
            raise InputError("--spec", specification.asked, "a half-sine: no blow of this machine is a " + pulse.shape)
        peak, width, rate = pulse.peak, pulse.width(WIDTH_FRACTION), specification.repetition()
        if interval is None and rate is not None:
            interval = 1.0 / (rate.high if math.isfinite(rate.high) else rate.low)
    if interval is None:
        hint = "a drop table is set by --spec; strikewave spec new writes one of your own"
        raise InputError("--interval", MISSING, 'time between blows, such as "20 ms"', hint)
    if peak is None or width is None:
        option, example = ("--peak", "4000 g") if peak is None else ("--width", "200 us")
        raise InputError(option, MISSING, f'that of the blows, such as "{example}", or --spec')
    return BlowGoal(interval, peak, width, disc, stop_limit, specification)


def goal_words(goal: BlowGoal) -> str:
    """Return a goal in words.

    Examples
    --------
    >>> from strikewave.base.materials import Material, material
    >>> goal_words(BlowGoal(0.02, 4000 * 9.80665, 200e-6, material("45 steel")))
    'blows of 4000 g and 200 us every 20 ms'
    """
    pulse = f"{goal.peak / STANDARD_GRAVITY:.6g} g and {goal.width * 1e6:.6g} us"
    by = "" if goal.specification is None else f", by {goal.specification.asked}"
    return f"blows of {pulse} every {goal.interval * 1e3:.6g} ms{by}"


def name_of(goal: BlowGoal) -> str:
    """Return the name of the case and of the folder of a goal.

    Examples
    --------
    >>> from strikewave.base.materials import Material, material
    >>> name_of(BlowGoal(0.02, 4000 * 9.80665, 200e-6, material("45 steel")))
    'settings-20ms-4000g-200us'
    """
    return f"settings-{goal.interval * 1e3:.6g}ms-{goal.peak / STANDARD_GRAVITY:.6g}g-{goal.width * 1e6:.6g}us"
