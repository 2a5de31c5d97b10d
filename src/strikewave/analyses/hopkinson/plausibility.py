"""What no shot shows: strains and stresses of a forgotten unit, specimens that a bar does not cover."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from strikewave.base.errors import InputError
from strikewave.base.percents import percent
from strikewave.base.result import Notice
from strikewave.hopkinson import Bar, Pulses, Reduction, Specimen, StressStrainCurve

BAR_STRAIN = 0.005
"""Plateau strain of a bar above which its material must be asked: a strong steel yields at 0.7 %."""
FLATTEST, SLENDEREST = 0.25, 2.0
"""Length over diameter: below it friction at the faces counts, above it the specimen buckles or is late."""
NEAREST_GAUGE = 10.0
"""Diameters between gauge and end of a bar after which the higher modes of a front have died away, as a rule."""
STRESS_OF_MODULUS = 0.1
"""Largest stress over the modulus: about the strength of a perfect crystal."""
LARGEST_STRESS = 10e9
"""Largest stress, Pa, where no modulus is stated."""


def check_strain(reduction: Reduction, curve: StressStrainCurve) -> None:
    """Refuse a specimen that is shorter than the way that its faces come together.

    Raises
    ------
    InputError
        If the engineering strain comes to 1 while the incident wave lasts.
    """
    on = reduction.loading
    gone = np.flatnonzero(curve.strain[on] >= 1.0)
    if gone.size:
        when = float(reduction.time[on][gone[0]]) * 1e6
        got = f"{reduction.specimen.length * 1e3:.4g} mm, an engineering strain of 100 % after {when:.4g} us"
        hint = "look at the units of length and strain, and at diameter and speed of the bars"
        raise InputError("specimen.length", got, "more than the way by which its faces come together", hint)


def strain_notices(pulses: Pulses) -> Iterator[Notice]:
    """Yield an incident pulse that would bring most bars to yield."""
    if pulses.plateau > BAR_STRAIN:
        message = (
            f"the plateau of the incident pulse is {percent(pulses.plateau, 2)} of strain: does the bar bear that?"
        )
        yield Notice("bar-strain", message, pulses.plateau, BAR_STRAIN)


def gauge_notices(bars: tuple[Bar, Bar]) -> Iterator[Notice]:
    """Yield a gauge so near the specimen that the wave is not yet one-dimensional there."""
    for name, bar in zip(("incident", "transmitted"), bars, strict=True):
        diameters = bar.gauge_distance / bar.diameter
        if diameters < NEAREST_GAUGE:
            message = (
                f"the gauge of the {name} bar is {diameters:.3g} diameters from the specimen: waves are not yet plane"
            )
            yield Notice("gauge-near", message, diameters, NEAREST_GAUGE)


def specimen_notices(specimen: Specimen, bars: tuple[Bar, Bar]) -> Iterator[Notice]:
    """Yield a specimen wider than a bar, and one too flat or too slender for a uniform stress."""
    width = math.sqrt(4.0 * specimen.area / math.pi)
    narrowest = min(bar.diameter for bar in bars)
    if width > narrowest:
        message = f"the specimen, {width * 1e3:.4g} mm wide, is wider than a bar, {narrowest * 1e3:.4g} mm"
        yield Notice("specimen-wide", message, width, narrowest)
    shape = specimen.length / width
    if shape > SLENDEREST:
        message = f"the specimen is {shape:.3g} times as long as wide: it may buckle, and comes late to equilibrium"
        yield Notice("specimen-slender", message, shape, SLENDEREST)
    if shape < FLATTEST:
        message = f"the specimen is {shape:.3g} times as long as wide: friction at its faces raises the stress"
        yield Notice("specimen-flat", message, shape, FLATTEST)


def stress_notices(stress: float, specimen: Specimen) -> Iterator[Notice]:
    """Yield a largest stress (Pa) that no specimen bears."""
    limit = LARGEST_STRESS if specimen.modulus is None else STRESS_OF_MODULUS * specimen.modulus
    if stress > limit:
        words = "10 GPa" if specimen.modulus is None else "a tenth of the stated modulus"
        message = f"the largest stress is {stress / 1e9:.4g} GPa, above {words}: look at units, gains and diameters"
        yield Notice("stress-implausible", message, stress, limit)
