"""Limits of one-dimensional wave theory and of joints: notices for runs and bars.

With t the rise time that is left at the stated bandwidth B, t^2 = (rise of the load)^2 + (0.35/B)^2, c the bar
speed and d the diameter: below t c/d = 2 no peak acceleration is quoted, since the front disperses over lengths
of the diameter; from 2 to 5 it comes with a warning.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.result import Notice
from strikewave.base.texts import first_few, percent, plain
from strikewave.waves.bar import BarRun, Tap
from strikewave.waves.layers import Layer, Stack
from strikewave.waves.transit import TimeGrid

Array = NDArray[np.float64]

# The front disperses over lengths of the diameter, so that below 2 the rise is that of the bar; up to 5 a peak is
# good to some 10 % at best.
REFUSED, WARNED = 2.0, 5.0
"""Rise time in diameters of travel below which a peak acceleration is refused, and warned of."""
# Only higher modes are missing, which die within about a diameter of a face.
DISPERSED_REFUSED, DISPERSED_WARNED = 1.0, 2.0
"""Limits where the first mode of a round bar is followed exactly."""
RISE_OF_BANDWIDTH = 0.35  # ln 9/(2 pi) of one pole, and about as much of several
"""Rise time (10-90 %) times -3 dB bandwidth of a low-pass."""
MISMATCH_LIMIT = 0.01  # echoes then come 1 % early or late, which a figure shows
"""Largest relative error of a transit without a warning."""
LOSS_HELD = 0.05  # the aim of `fit_loss`, and below the scatter of materials
"""Largest deviation of a loss factor without a notice."""
TENSION_SHARE = 0.01  # chosen: above the error of a grid
"""Largest share of the force that tension in a joint takes without a notice."""
MOST_NAMES = 5  # a line stays a line
"""Most names that a notice lists before it counts the rest."""
# A tenth of the modulus is about the strength of a perfect crystal, and of rubber the linear law is off by as much
# there.
LARGEST_STRAIN = 0.1
"""Stress over modulus from which on a layer is reported."""
_ROUNDING = 1e-9
"""Relative rounding of a force at its limit, or of a number about to be rounded down."""
_SAME_PLACE = 1e-12  # a place on it still belongs to the layer before
"""Relative rounding of a face's place."""


def honest_bandwidth(stack: Stack) -> float:
    """Return the largest bandwidth at which peak accelerations need no warning, whatever the load, Hz.

    B = 0.35 c / (5 d), the smallest of all layers.
    """
    return min(RISE_OF_BANDWIDTH * layer.bar_speed / (WARNED * layer.diameter) for layer in stack.layers)


def rise_limits(stack: Stack) -> tuple[float, float]:
    """Return the rise time in diameters of travel below which a peak acceleration is refused, and warned of."""
    if all(layer.dispersion == "pochhammer-chree" for layer in stack.layers):
        return DISPERSED_REFUSED, DISPERSED_WARNED
    return REFUSED, WARNED


def rise_in_diameters(stack: Stack, rise: float, bandwidth: float) -> tuple[float, Layer]:
    """Return the smallest t c/d of all layers, and that layer."""
    left = math.hypot(rise, RISE_OF_BANDWIDTH / bandwidth)
    layer = min(stack.layers, key=lambda x: x.bar_speed / x.diameter)
    return left * layer.bar_speed / layer.diameter, layer


def rise_notices(stack: Stack, rise: float, bandwidth: float, peak: float | None = None) -> Iterator[Notice]:
    """Yield the notice on peak accelerations by the rise of the load; ``peak`` is one that may not be quoted."""
    ratio, layer = rise_in_diameters(stack, rise, bandwidth)
    refused, warned = rise_limits(stack)
    theory = "one-dimensional theory" if refused == REFUSED else "the first mode"
    at = "" if math.isinf(bandwidth) else f" at {plain(bandwidth / 1e3)}\xa0kHz"
    what = f"a rise of {plain(rise * 1e6)} us{at} is {plain(ratio, 2)} diameters of travel in {layer.name}"
    if ratio < refused:
        shown = "" if peak is None else f" ({theory} would say {plain(peak / STANDARD_GRAVITY, 4)}\xa0g)"
        message = (
            f"no peak acceleration is quoted{shown}: {what}, below {refused:g}; sensor readings are no better "
            f'founded; state it at a lower bandwidth: --set solver.bandwidth="{_quotable(layer, rise, refused)} kHz"'
        )
        yield Notice("rise-too-steep", message, ratio, refused)
    elif ratio < warned:
        why = "the front disperses" if refused == REFUSED else "higher modes are missing near the faces"
        message = f"{what}: below {warned:g} {why}; trust peak accelerations to some 10 % at best"
        yield Notice("rise-steep", message, ratio, warned)


def _quotable(layer: Layer, rise: float, refused: float) -> str:
    """Return a bandwidth at which a peak acceleration is quoted with a warning, kHz, rounded down."""
    left = math.sqrt(max((refused * layer.diameter / layer.bar_speed) ** 2 - rise**2, 0.0))
    highest = RISE_OF_BANDWIDTH / left / 1e3
    digit = 10.0 ** (math.floor(math.log10(highest)) - 1)
    return f"{plain(math.floor(highest / digit - _ROUNDING) * digit)}"


def layer_notices(stack: Stack, largest_force: Array) -> Iterator[Notice]:
    """Yield layers shorter than thick, and layers whose stress passes yield or comes near the modulus.

    ``largest_force`` is the largest magnitude of the force in each layer, N.
    """
    short = [layer for layer in stack.layers if layer.length < layer.diameter]
    if short:
        names = first_few([layer.name for layer in short], MOST_NAMES)
        worst = min(short, key=lambda x: x.length / x.diameter)
        message = (
            f"shorter than thick: {names}; one-dimensional theory knows neither their end effects nor their radial "
            "motion"
        )
        yield Notice("short-layer", message, worst.length / worst.diameter, 1.0)
    for layer, force in zip(stack.layers, largest_force, strict=True):
        strength, stress = layer.yield_strength, force / layer.area
        if strength is not None and stress > strength:
            speed = strength * layer.area / layer.impedance
            message = (
                f"the stress in {layer.name} reaches {plain(stress / 1e6, 4)}\xa0MPa, beyond its yield strength of "
                f"{plain(strength / 1e6, 4)}\xa0MPa (a wave of {plain(speed)}\xa0m/s): elastic waves no longer hold"
            )
            yield Notice("stress-yield", message, stress, strength)
        elif stress > LARGEST_STRAIN * layer.modulus:
            message = (
                f"the stress in {layer.name} reaches {plain(stress / 1e6, 4)}\xa0MPa, "
                f"{percent(stress / layer.modulus)} of "
                f"its modulus of {plain(layer.modulus / 1e6, 4)}\xa0MPa: linear waves hold for small strains "
                "alone; look at the units of load, speed, modulus and sizes"
            )
            yield Notice("strain-large", message, stress, LARGEST_STRAIN * layer.modulus)


def joint_notices(stack: Stack, least_force: Array, greatest_force: Array, load_peak: float = 0.0) -> Iterator[Notice]:
    """Yield joints that opened, closed their gap, carry tension though bonded, and gaskets that yield.

    ``least_force`` and ``greatest_force`` are those at each joint, N; what is far below ``load_peak`` has not arrived.
    """
    most = max(float(np.max(np.abs([least_force, greatest_force]), initial=0.0)), load_peak)
    pulled = []
    for k, joint in enumerate(stack.joints):
        where = f"between {stack.layers[k].name} and {stack.layers[k + 1].name}"
        least, greatest = float(least_force[k]), float(greatest_force[k])
        if max(-least, greatest) > joint.yield_force:
            message = (
                f"the gasket {where} is loaded with {plain(max(-least, greatest) / 1e3)}\xa0kN, beyond its yield at "
                f"{plain(joint.yield_force / 1e3)}\xa0kN: its linear spring no longer holds"
            )
            yield Notice("gasket-yield", message, max(-least, greatest), joint.yield_force)
        if joint.unilateral and joint.gap > 0.0:
            outcome = "closes" if greatest > 0.0 else "stays open and transmits nothing"
            message = f"the gap of {plain(joint.gap * 1e6)}\xa0um {where} {outcome}"
            yield Notice("joint-gap", message, greatest, 0.0)
        elif joint.unilateral and joint.preload > 0.0 and least <= -joint.preload * (1.0 - _ROUNDING):
            message = f"the joint {where} opens: tension reaches its preload of {plain(joint.preload, 4)}\xa0N"
            yield Notice("joint-opened", message, least, -joint.preload)
        elif not joint.unilateral and least < -TENSION_SHARE * most:
            pulled.append((least, where))
    if pulled:
        places = first_few([f"{where} ({plain(-least / 1e3)}\xa0kN)" for least, where in pulled], MOST_NAMES)
        message = (
            f"tension in the joint {places}: true only if it is glued, welded or bolted hard enough (a gasket counts "
            "as glued on both sides); else make it unilateral, with the preload of its bolt"
        )
        yield Notice("joint-tension", message, -min(pulled)[0], TENSION_SHARE * most)


def loss_notices(losses: Sequence[tuple[str, float, float, float, float]]) -> Iterator[Notice]:
    """Yield loss factors that are held badly, of rows of place, wanted loss factor, error and band (Hz)."""
    for where, loss_factor, error, low, high in losses:
        if error > LOSS_HELD:
            message = (
                f"the loss factor {loss_factor:g} of {where} is held to {percent(error)} only from "
                f"{low / 1e3:g}\xa0kHz to {high / 1e3:g}\xa0kHz: narrow the band"
            )
            yield Notice("loss-fit", message, error, LOSS_HELD)


def end_notices(stack: Stack, duration: float) -> Iterator[Notice]:
    """Yield a matched end whose true echo would be back while the load lasts."""
    echo = 2.0 * stack.layers[-1].transit
    if stack.end.kind == "matched" and echo < duration:
        message = (
            f"the end is matched, as if {stack.layers[-1].name} were endless; at its length the echo would be back "
            f"after {plain(echo * 1e6)}\xa0us, within the load of {plain(duration * 1e6)}\xa0us"
        )
        yield Notice("matched-end", message, echo, duration)


def arrival_time(stack: Stack, layer: int, position: float, faces: Sequence[int] = (0,)) -> float:
    """Return the arrival of the first wave at a place, s: a layer, from 0, and a share of its length.

    Waves begin at time 0 at some ``faces``: face k stands before layer k, the last one behind the last layer; without
    one the arrival is infinite. Loss makes the front faster; dispersion does not count: no part of a wave is before
    it.
    """
    transits = []
    for part in stack.layers:  # the front meets a lossy layer with all its springs, which relax only later
        loss = part.loss
        stiffness = 1.0 if loss is None else loss.stiffness + sum(branch.stiffness for branch in loss.branches)
        transits.append(part.transit / math.sqrt(stiffness))
    ends = np.concatenate([[0.0], np.cumsum(transits)])
    place = ends[layer] + position * transits[layer]
    return min((abs(float(place - ends[face])) for face in faces), default=math.inf)


def not_reached_notices(
    stack: Stack,
    taps: Sequence[tuple[str, Tap]],
    lasting: float,
    stated: str,
    faces: Sequence[int] = (0,),
    begin: float = 0.0,
) -> Iterator[Notice]:
    """Yield a notice of the named taps, and of the layers, that no wave reaches within a run of a time, s.

    ``stated`` is the setting that ends the run, such as ``solver.duration = 20 us``; waves begin at ``faces``, as in
    `arrival_time`, and at ``begin``, s.
    """
    late = [
        (f"tap {name}", time)
        for name, tap in taps
        if (time := begin + arrival_time(stack, tap.layer, tap.position, faces)) > lasting
    ]
    for k, layer in enumerate(stack.layers):
        time = begin + min(arrival_time(stack, k, position, faces) for position in (0.0, 1.0))
        if time >= lasting:
            late.append((f"layer {layer.name}", time))
    if late and faces:
        places = first_few([f"{place} ({plain(time * 1e6, 4)}\xa0us)" for place, time in late], MOST_NAMES)
        last = max(time for _, time in late)
        message = (
            f"{stated} ends before the wave arrives at {places}: values there are no results; follow it for more "
            f"than {plain(last * 1e6, 4)}\xa0us"
        )
        yield Notice("not-reached", message, lasting, last)


def bar_extremes(run: BarRun) -> tuple[Array, Array, Array]:
    """Return largest magnitude of force in each layer, and least and greatest force at each joint, of a bar."""
    least, greatest = run.face_least.min(axis=1), run.face_greatest.max(axis=1)
    np.fmin.at(least, run.field_layer, run.field_least)
    np.fmax.at(greatest, run.field_layer, run.field_greatest)
    largest = np.nan_to_num(np.fmax(np.abs(least), np.abs(greatest)))
    behind, before = run.face_least[:-1, 1], run.face_least[1:, 0]
    above, below = run.face_greatest[:-1, 1], run.face_greatest[1:, 0]
    return largest, np.nan_to_num(np.fmin(behind, before)), np.nan_to_num(np.fmax(above, below))


def field_extremes(stack: Stack, position: Array, force: Array) -> tuple[Array, Array, Array]:
    """Return largest magnitude of force in each layer, and least and greatest force at each joint, from a field."""
    ends = np.cumsum([layer.length for layer in stack.layers])
    which = np.minimum(np.searchsorted(ends * (1.0 + _SAME_PLACE), position), len(stack.layers) - 1)
    largest = np.array([np.abs(force[:, which == k]).max(initial=0.0) for k in range(len(stack.layers))])
    joints = [int(np.argmin(np.abs(position - end))) for end in ends[:-1]]
    return largest, force[:, joints].min(axis=0, initial=np.inf), force[:, joints].max(axis=0, initial=-np.inf)


def grid_notices(grid: TimeGrid) -> Iterator[Notice]:
    """Yield a time step that changes a layer noticeably."""
    if grid.mismatch > MISMATCH_LIMIT:
        message = (
            f"the time step of {plain(grid.step * 1e9, 4)} ns changes a transit by {percent(grid.mismatch)}: leave "
            "solver.step out, or take a finer one"
        )
        yield Notice("coarse-step", message, grid.mismatch, MISMATCH_LIMIT)
