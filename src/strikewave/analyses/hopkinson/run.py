"""The run of a split-Hopkinson set-up: a shot reduced and checked, a bar calibrated, or an accelerometer compared."""

from __future__ import annotations

import numpy as np

from strikewave.analyses.hopkinson.bar_end import Bench, Standing, bar_layer, compare_at_end
from strikewave.analyses.hopkinson.build import (
    HopkinsonCase,
    build_bar,
    build_disk,
    build_reading,
    build_specimen,
    build_striker,
    build_trace,
)
from strikewave.analyses.hopkinson.notices import (
    balance_notices,
    citations,
    constant_notices,
    digests,
    drift_notices,
    echo_notices,
    reading_notices,
    sensor_notices,
    shot_notices,
    sign_notices,
    stated_kind,
    stated_texts,
    strain_notices,
    striker_notices,
)
from strikewave.analyses.hopkinson.result import EchoSolution, HopkinsonSolution, SensorSolution
from strikewave.base.compiling import compiling_shown
from strikewave.base.constants import material
from strikewave.base.errors import InputError
from strikewave.hopkinson import (
    ANALYSES,
    Reduction,
    align,
    energy,
    equilibrium,
    find_pulses,
    momentum,
    reduce,
    striker_check,
)
from strikewave.hopkinson.checks import UNIFORM
from strikewave.hopkinson.echoes import calibrate_bar
from strikewave.hopkinson.reduction import StressStrainCurve
from strikewave.waves import BONDED, Stack
from strikewave.waves.limits import REFUSED, layer_notices, rise_in_diameters, rise_notices


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
        The result of a shot on a specimen, of an accelerometer on a bar end, or of a bar alone.

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
        *reading_notices([finding for trace in gauged for finding in trace.findings]),
        *sign_notices(
            stated_kind(stated_texts(case, gauged)),
            list(zip(pulses.traces, [path for _, path in gauges], strict=True)),
            all(trace.is_strain for trace in gauged),
        ),
        *drift_notices(pulses.traces, [path for _, path in gauges]),
        *constant_notices(setup, {"incident": constants, "transmitted": others}),
        *strain_notices(pulses),
        *shot_notices(reduction, pulses, float(true.stress[on].max())),
        *balance_notices(alike, impulses, setup.limits),
        *striker_notices(checked),
    ]
    # sources of the theory of equilibrium, where the impedance of the specimen is known
    theory = [] if specimen.transit is None else ["yang-shim-2005", "ravichandran-subhash-1994"]
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
        citations=citations(setup.solver.dispersion, ["kolsky-1963", "gray-2000", "maeda-1985", *theory]),
    )


def check_strain(reduction: Reduction, curve: StressStrainCurve) -> None:
    """Refuse a specimen that is shorter than the way by which its faces come together."""
    on = reduction.loading
    gone = np.flatnonzero(curve.strain[on] >= 1.0)
    if gone.size:
        when = float(reduction.time[on][gone[0]]) * 1e6
        got = f"{reduction.specimen.length * 1e3:.4g} mm, an engineering strain of 100 % after {when:.4g} us"
        hint = "look at the units of length and strain, and at diameter and speed of the bars"
        raise InputError("specimen.length", got, "more than the way by which its faces come together", hint)


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


def compare_accelerometer(case: HopkinsonCase) -> SensorSolution:
    """Set an accelerometer on the end of a bar beside its strain gauge."""
    setup = case.setup
    table, sensor = setup.bar.incident, setup.accelerometer
    assert sensor is not None
    bar, constants = build_bar(table, "bar.incident")
    gauged = build_trace(case, table.gauge, "bar.incident.gauge", bar)
    trace, findings = gauged.trace, gauged.findings
    reading = build_reading(case, sensor)
    standing = Standing(0.0 if sensor.mass is None else sensor.mass.si)
    if setup.disk is not None and setup.disk.mass is not None:
        standing = Standing(standing.mass + setup.disk.mass.si)
    elif setup.disk is not None:
        standing = Standing(standing.mass, build_disk(setup.disk, bar))
    bandwidth = setup.solver.bandwidth
    bench = Bench(bar, standing, setup.solver.dispersion)
    comparison = compare_at_end(trace, reading.trace, bench, None if bandwidth is None else bandwidth.si)
    strength = material(table.material).yield_strength if table.material else None
    layer = bar_layer(bar, strength)
    stack = Stack((layer,)) if standing.disk is None else Stack((layer, standing.disk), (BONDED,))
    # in the bar, by the gauge, and on the disk, N
    forces = [bar.stiffness * float(np.abs(comparison.pulses.incident).max())]
    if standing.disk is not None:
        forces.append(float(np.abs(comparison.motion.force).max()))
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
        *layer_notices(stack, np.array(forces)),
        *sensor_notices(comparison, setup),
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
