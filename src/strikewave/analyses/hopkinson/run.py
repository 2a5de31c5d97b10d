"""Set-up in, solution out: a shot reduced and checked, a bar calibrated by echoes, or an accelerometer compared."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from strikewave.analyses.hopkinson.bar_end import Bench, SensorComparison, Standing, bar_layer, compare_at_end
from strikewave.analyses.hopkinson.build import (
    HopkinsonCase,
    build_bar,
    build_disk,
    build_reading,
    build_specimen,
    build_striker,
    build_trace,
    check_strain,
    gauge_notices,
    specimen_notices,
    strain_notices,
    stress_notices,
)
from strikewave.analyses.hopkinson.notices import (
    citations,
    constant_notices,
    digests,
    drift_notices,
    echo_notices,
    reading_notices,
    sign_notices,
    stated_kind,
    stated_texts,
)
from strikewave.analyses.hopkinson.result import EchoSolution, HopkinsonSolution, SensorSolution
from strikewave.base.compiling import compiling_shown
from strikewave.base.constants import material
from strikewave.base.errors import InputError
from strikewave.base.result import FAILED, Notice
from strikewave.base.texts import percent
from strikewave.cases.tables.hopkinson import HopkinsonSetup, LimitsTable
from strikewave.hopkinson import (
    ANALYSES,
    Bar,
    Pulses,
    Reduction,
    Specimen,
    align,
    energy,
    equilibrium,
    find_pulses,
    momentum,
    reduce,
    striker_check,
)
from strikewave.hopkinson.checks import LASTING, UNIFORM, Equilibrium, Momentum, StrikerCheck
from strikewave.hopkinson.echoes import calibrate_bar
from strikewave.waves import BONDED, Layer, Stack
from strikewave.waves.limits import REFUSED, layer_notices, rise_in_diameters, rise_notices

STRIKER_MISMATCH = 0.05
"""Share by which the incident pulse may differ from what its striker should make with no warning: the speed of a
striker and the factor of a bridge are each known to a few per cent."""
LATE_SHARE = 0.2
"""Share of the rise time by which a wave may be late at the specimen with no warning: the forces
then differ by a fifth of the plateau in the rise by timing alone."""
FEWEST_SAMPLES = 10.0
"""Fewest samples in the rise of the incident pulse with no warning: a wave that is a sample late then shifts the forces
by a tenth of the plateau."""


@compiling_shown()
def run_hopkinson(case: HopkinsonCase) -> HopkinsonSolution | SensorSolution | EchoSolution:
    """Reduce the shot of a set-up, compare the accelerometer on its bar, or calibrate the bar by echoes.

    Parameters
    ----------
    case : HopkinsonCase
        The set-up, as `load_setup` reads it.

    Returns
    -------
    HopkinsonSolution, SensorSolution or EchoSolution
        Of a shot on a specimen, of an accelerometer on a bar end, or of a bar alone.

    Raises
    ------
    InputError
        If files, channels, units or pulses cannot be used.
    """
    if case.setup.kind == "sensor":
        return compare_accelerometer(case)
    return _calibrate(case) if case.setup.kind == "echoes" else _reduce(case)


def _reduce(case: HopkinsonCase) -> HopkinsonSolution:
    setup = case.setup
    incident, transmitted = setup.bar.incident, setup.bar.transmitted
    assert transmitted is not None
    assert setup.specimen is not None
    first, constants = build_bar(incident, "bar.incident")
    second, others = build_bar(transmitted, "bar.transmitted", incident)
    bars, specimen = (first, second), build_specimen(setup.specimen)
    gauges = ((incident.gauge, "bar.incident.gauge"), (transmitted.gauge, "bar.transmitted.gauge"))
    gauged = [build_trace(case, gauge, path, bar) for (gauge, path), bar in zip(gauges, bars, strict=True)]
    if gauged[0].source == gauged[1].source:
        allowed = "another channel or file than that of the incident gauge"
        raise InputError("bar.transmitted.gauge.channel", transmitted.gauge.channel, allowed)
    pulses = find_pulses(gauged[0].trace, gauged[1].trace, bars)
    waves = align(pulses, bars, setup.solver.dispersion, setup.solver.alignment, specimen.transit or 0.0)
    reduction = reduce(waves, bars, specimen)
    for analysis in ANALYSES:
        check_strain(reduction, reduction.curve(analysis))
    true, on = reduction.curve(setup.solver.analysis).true(), reduction.loading
    alike, impulses = equilibrium(reduction, UNIFORM), momentum(reduction)
    striker = build_striker(setup, bars[0])
    checked = None if striker is None else striker_check(pulses, reduction, striker)
    notices = [
        *reading_notices([finding for one in gauged for finding in one.findings]),
        *sign_notices(
            stated_kind(stated_texts(case, gauged)),
            list(zip(pulses.traces, [path for _, path in gauges], strict=True)),
            all(one.is_strain for one in gauged),
        ),
        *drift_notices(pulses.traces, [path for _, path in gauges]),
        *constant_notices(setup, {"incident": constants, "transmitted": others}),
        *strain_notices(pulses),
        *gauge_notices(bars),
        *specimen_notices(specimen, bars),
        *stress_notices(float(true.stress[on].max()), specimen),
        *_alignment_notices(reduction, pulses),
        *_balance_notices(alike, impulses, setup.limits),
        *_striker_notices(checked),
    ]
    return HopkinsonSolution(
        case=case,
        pulses=pulses,
        reduction=reduction,
        equilibrium=alike,
        momentum=impulses,
        energy=energy(reduction),
        striker=striker,
        striker_check=checked,
        constants={"incident": constants, "transmitted": others},
        digests=digests(case),
        notices=tuple(notices),
        citations=citations(setup.solver.dispersion, ["kolsky-1963", "gray-2000", "maeda-1985", *_theory(specimen)]),
    )


def _calibrate(case: HopkinsonCase) -> EchoSolution:
    setup = case.setup
    table = setup.bar.incident
    bar, constants = build_bar(table, "bar.incident")
    trace, findings, *_ = build_trace(case, table.gauge, "bar.incident.gauge", bar)
    echoes = calibrate_bar(trace, bar, setup.echoes.way, int(setup.echoes.skip.si), setup.solver.dispersion)
    notices = [
        *reading_notices(findings),
        *drift_notices([echoes.quiet], ["bar.incident.gauge"]),
        *constant_notices(setup, {"incident": constants}),
        *echo_notices(echoes, bar, setup.echoes.way),
    ]
    return EchoSolution(
        case=case,
        bar=bar,
        echoes=echoes,
        digests=digests(case),
        notices=tuple(notices),
        citations=citations(setup.solver.dispersion, ["bacon-1998", "maeda-1985"]),
    )


def _theory(specimen: Specimen) -> list[str]:
    """Return the sources of the theory of equilibrium, where the specimen's impedance is known."""
    return [] if specimen.transit is None else ["yang-shim-2005", "ravichandran-subhash-1994"]


def _alignment_notices(reduction: Reduction, pulses: Pulses) -> Iterator[Notice]:
    waves, samples = reduction.waves, pulses.rise / pulses.step
    if waves.beyond:
        message = (
            f"alignment by {waves.method} would move a wave by more than the {waves.window * 1e6:.3g} us rise of the "
            "incident pulse: geometry is kept; look at distances and speeds"
        )
        yield Notice("alignment-refused", message, waves.window, waves.window)
    late = max(waves.late_balance, key=abs)
    if waves.method == "geometric" and abs(late) > LATE_SHARE * waves.window:
        message = (
            f"by the balance of forces the reflected wave is {waves.late_balance[0] * 1e6:+.3g} us and the transmitted "
            f"{waves.late_balance[1] * 1e6:+.3g} us late at the specimen, of a rise of {waves.window * 1e6:.3g} us: is "
            "a gauge distance or a bar speed off?"
        )
        yield Notice("waves-late", message, late, LATE_SHARE * waves.window)
    if samples < FEWEST_SAMPLES:
        message = f"the rise of the incident pulse has {samples:.3g} samples"
        yield Notice("few-samples", message, samples, FEWEST_SAMPLES)


def _balance_notices(alike: Equilibrium, impulses: Momentum, limits: LimitsTable) -> Iterator[Notice]:
    if not alike.misfit <= limits.force_misfit.si:
        message = (
            f"the forces on the two faces differ by {percent(alike.misfit)} of their mean while the incident wave lasts"
        )
        yield Notice("force-misfit", message, alike.misfit, limits.force_misfit.si, severity=FAILED)
    if not abs(impulses.closure) <= limits.momentum.si:
        kind = "missing" if impulses.closure > 0.0 else "excess"
        message = f"impulses do not close: {kind} impulse of {percent(abs(impulses.closure))} of the incident one"
        yield Notice("momentum", message, impulses.closure, limits.momentum.si, severity=FAILED)
    if math.isnan(alike.begin):
        message = (
            f"there is no stretch of {LASTING:g} rise times in which the forces agree to {percent(UNIFORM, 0)}; in all "
            f"they do over {percent(alike.share, 0)} of the loading"
        )
        yield Notice("no-equilibrium", message, alike.share, math.nan)


def _striker_notices(checked: StrikerCheck | None) -> Iterator[Notice]:
    if checked is None:
        return
    pairs = (
        ("strain", checked.strain, checked.strain_expected, "plateau strain"),
        ("duration", checked.duration, checked.duration_expected, "width"),
    )
    for code, measured, expected, words in pairs:
        off = measured / expected - 1.0
        if abs(off) > STRIKER_MISMATCH:
            message = f"the {words} of the incident pulse is {percent(off, 1, '+')} off what the striker should make"
            yield Notice(f"striker-{code}", message, off, STRIKER_MISMATCH)


MISFIT = 0.1
"""Residual over the reading above which it is warned of: a slope by least squares is then mostly that of something else
than the reference. Chosen: a tenth."""
REFLECTED_MISFIT = 0.05
"""Share by which the reflected wave may contradict the model of the end with no warning. Chosen: gauges and bar
speed are known to a few per cent."""


def compare_accelerometer(case: HopkinsonCase) -> SensorSolution:
    """Set an accelerometer on the end of a bar beside its strain gauge."""
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
