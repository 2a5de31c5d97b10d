"""Set-up in, solution out: an accelerometer on the end of a bar, and the warnings on the comparison."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from strikewave.analyses.hopkinson.bar_end import Bench, SensorComparison, Standing, bar_layer, compare_at_end
from strikewave.analyses.hopkinson.build import build_bar, build_disk, build_reading, build_trace
from strikewave.analyses.hopkinson.notices import citations, constant_notices, digests, drift_notices, reading_notices
from strikewave.analyses.hopkinson.plausibility import strain_notices
from strikewave.analyses.hopkinson.sensor_result import SensorSolution
from strikewave.analyses.hopkinson.setup_file import HopkinsonCase
from strikewave.analyses.hopkinson.sign_notices import sign_notices, stated_kind, stated_texts
from strikewave.base.materials import material
from strikewave.base.percents import percent
from strikewave.base.result import Notice
from strikewave.cases.tables.hopkinson import HopkinsonSetup
from strikewave.hopkinson import Bar
from strikewave.waves import BONDED, Layer, Stack
from strikewave.waves.limits import REFUSED, layer_notices, rise_in_diameters, rise_notices

MISFIT = 0.1
"""Residual over the reading above which it is warned of: a slope by least squares is then mostly that of something else
than the reference. Chosen: a tenth."""
REFLECTED_MISFIT = 0.05
"""Share by which the reflected wave may contradict the model of the end with no warning. Chosen: gauges and bar
speed are known to a few per cent."""


def compare_accelerometer(case: HopkinsonCase) -> SensorSolution:
    """Set an accelerometer on the end of a bar beside its strain gauge.

    Raises
    ------
    InputError
        If files, channels, units or pulses cannot be used.
    """
    setup = case.setup
    table, sensor = setup.bar.incident, setup.accelerometer
    assert sensor is not None
    bar, constants = build_bar(table, "bar.incident")
    gauged = build_trace(case, table.gauge, "bar.incident.gauge", bar)
    trace, findings = gauged.trace, gauged.findings
    reading = build_reading(case, sensor)
    standing = _standing(setup, bar)
    bandwidth = setup.solver.bandwidth
    bench = Bench(bar, standing, setup.solver.dispersion)
    comparison = compare_at_end(trace, reading.trace, bench, None if bandwidth is None else bandwidth.si)
    strength = material(table.material).yield_strength if table.material else None
    stack = _stack(bar_layer(bar, strength), standing)
    rise = comparison.pulses.rise
    notices = [
        *reading_notices([*findings, *reading.findings]),
        *constant_notices(setup, {"incident": constants}),
        *sign_notices(
            stated_kind(stated_texts(case, [gauged])),
            [(comparison.pulses.traces[0], "bar.incident.gauge")],
            gauged.is_strain,
        ),
        *drift_notices(comparison.pulses.traces[:1], ["bar.incident.gauge"]),
        *strain_notices(comparison.pulses),
        *rise_notices(stack, rise, comparison.bandwidth.value),
        *layer_notices(stack, _largest_forces(comparison, bar, stack)),
        *_bandwidth_notices(comparison),
        *_agreement_notices(comparison),
        *_reflected_notices(comparison),
        *_uncertainty_notices(setup),
    ]
    return SensorSolution(
        case=case,
        bar=bar,
        standing=standing,
        unit=reading.unit,
        comparison=comparison,
        rise_diameters=(ratio := rise_in_diameters(stack, rise, comparison.bandwidth.value)[0]),
        quoted=ratio >= REFUSED,
        constants={"incident": constants},
        digests=digests(case),
        notices=tuple(notices),
        citations=citations(setup.solver.dispersion, ["togami-1996", "maeda-1985"]),
    )


def _standing(setup: HopkinsonSetup, bar: Bar) -> Standing:
    """Return what stands on the end of the bar: the sensor's own mass, and the disk below it."""
    assert setup.accelerometer is not None
    own = setup.accelerometer.mass.si if setup.accelerometer.mass is not None else 0.0
    if setup.disk is None:
        return Standing(own)
    if setup.disk.mass is not None:
        return Standing(own + setup.disk.mass.si)
    return Standing(own, build_disk(setup.disk, bar))


def _stack(bar: Layer, standing: Standing) -> Stack:
    return Stack((bar,)) if standing.disk is None else Stack((bar, standing.disk), (BONDED,))


def _largest_forces(found: SensorComparison, bar: Bar, stack: Stack) -> np.ndarray:
    """Return the largest force in the bar, by the gauge, and on the disk, N."""
    passing = bar.stiffness * float(np.abs(found.pulses.incident).max())
    return np.array([passing, float(np.abs(found.motion.force).max())])[: len(stack.layers)]


def _bandwidth_notices(found: SensorComparison) -> Iterator[Notice]:
    value, noise = found.bandwidth.value, found.bandwidth.noise
    if value > noise * (1.0 + 1e-9):
        message = (
            f"the bandwidth of {value / 1e3:.4g} kHz lies above {noise / 1e3:.4g} kHz, where the incident pulse sinks "
            "in the noise of its gauge: the reference holds noise there, and no dispersion is corrected"
        )
        yield Notice("bandwidth-noise", message, value, noise)


def _agreement_notices(found: SensorComparison) -> Iterator[Notice]:
    agreement, rise = found.agreement, found.pulses.rise
    if agreement.sensitivity < 0.0:
        message = "the sensor reads against the blow: it is mounted the other way, or its leads are swapped"
        yield Notice("sensor-reversed", message, agreement.sensitivity, 0.0)
    if abs(agreement.delay) > rise:
        message = (
            f"the reading is {agreement.delay * 1e6:+.3g} us late, more than the rise of the pulse, {rise * 1e6:.3g} "
            "us: is the gauge distance, the bar speed or the clock of one record off?"
        )
        yield Notice("sensor-late", message, agreement.delay, rise)
    if agreement.residual > MISFIT:
        message = f"{percent(agreement.residual)} of the reading does not follow the reference"
        yield Notice("sensor-misfit", message, agreement.residual, MISFIT)


def _reflected_notices(found: SensorComparison) -> Iterator[Notice]:
    misfit = found.reflected_misfit
    if misfit > REFLECTED_MISFIT:
        message = (
            f"the reflected wave says that the end moves {percent(misfit)} otherwise than the incident wave and what "
            "stands on the end do: is a mass, the gauge distance or the bar speed off, or does the joint open?"
        )
        yield Notice("reflected-differs", message, misfit, REFLECTED_MISFIT)


def _uncertainty_notices(setup: HopkinsonSetup) -> Iterator[Notice]:
    missing = [key for key in ("strain", "speed") if getattr(setup.uncertainty, key) is None]
    if missing:
        message = (
            f"the uncertainty of the sensitivity holds its scatter, but nothing for {' and '.join(missing)}: state "
            + " and ".join(f"uncertainty.{key}" for key in missing)
        )
        yield Notice("uncertainty-partial", message, math.nan, math.nan)
