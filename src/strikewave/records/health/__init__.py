r"""Health checks of a record: one table for blows and for responses, and the functions that run them.

A check is one function, which finds one fault and returns it in numbers, and one row of `CHECKS`, which names it, says
how bad it is, what it looks at, and in which words. Its thresholds stand in `strikewave.records.thresholds`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from strikewave.records.health import blows, disturbances, limits, zero
from strikewave.records.health.sampled_record import SampledRecord
from strikewave.records.health_notice import (
    BLOW,
    EVERY,
    OF_BLOWS,
    OF_BOTH,
    OF_RESPONSES,
    Check,
    Fault,
    HealthNotice,
    worst_first,
)

__all__ = ["CHECKS", "examine"]

# Every check in the order of findings: why no blow is seen comes before that none is
CHECKS = (
    Check(
        "dead", "bad", OF_BOTH, blows.dead,
        "every sample is {value:unit}: the channel is dead or not connected", EVERY, ends=True,
    ),
    Check(
        "no-response", "bad", OF_RESPONSES, blows.early,
        "the channel reaches {peak:unit} {lead:.3g}\xa0ms before the peak of {blow} of the base, and {value:unit} "
        "after {blow} begins: it comes before what should drive it. Look at the names of the channels, at their clocks "
        "and at the choice of --base", EVERY, ends=True,
    ),
    Check(
        "no-response", "bad", OF_RESPONSES, blows.no_answer,
        "after the blows of the base the channel reaches {value:unit}, no more than before them: it is not connected, "
        "or does not answer", EVERY, ends=True,
    ),
    Check(
        "cut", "bad", OF_BLOWS, zero.begins_in_blow,
        "the record begins in a blow, at {peak:unit}: it is cut; record some time before the blow", EVERY,
    ),
    Check(
        "not-settled", "bad", OF_BLOWS, zero.begins_in_motion,
        "the record begins while something still swings ({value:unit} from top to bottom, at its end {end:unit})",
        EVERY,
    ),
    Check(
        "not-settled", "bad", OF_BLOWS, zero.unsettled,
        "the zero stands at {value:unit} and drifts by {drift:unit}: it has not settled", EVERY,
    ),
    Check(
        "drift", "suspect", OF_BLOWS, zero.drift_at_blow,
        "the zero drifts by {value:unit} over the record, and nothing before the blow tells where it stood: the peak "
        "may be wrong by {missed:%1}", (*BLOW, "spectrum"),
    ),
    Check(
        "drift", "good", OF_BLOWS, zero.drift_before,
        "before the blow the zero drifts, by {value:unit} over a length of the record, {share:%1} of the peak: it is "
        "carried on under the blow; the spectrum still holds it", ("spectrum",),
    ),
    Check(
        "not-settled", "suspect", OF_BLOWS, zero.offset,
        "the zero stands at {value:unit}, {share:%1} of the peak; it is taken off",
    ),
    Check(
        "no-pulse", "bad", OF_BLOWS, blows.only_swings,
        "the record spans {reach:unit}, but no one-sided blow stands out: it drifts, or swings", (*BLOW, "interval"),
    ),
    Check(
        "no-pulse", "bad", OF_BLOWS, blows.only_noise,
        "no blow stands out of the noise", (*BLOW, "interval", "spectrum"),
    ),
    Check(
        "clipped", "bad", OF_BLOWS, limits.clipped,
        "clipped at {value:unit} for {lasting:.4g}\xa0us {where}: the true peak is larger",
    ),
    Check(
        "clipped", "bad", OF_RESPONSES, limits.clipped_response,
        "clipped at {value:unit} for {lasting:.4g} us: the true peak is larger", EVERY,
    ),
    Check(
        "flat-top", "suspect", OF_BLOWS, limits.flat_top,
        "the top is flat: {value:%0} as wide at {tip:%0} of the peak as at {upper:%0} (an elastic pulse's {usual:%0}): "
        "sensor or amplifier may be near its limit; a pulse that is meant to be flat, or made by yielding, cannot be "
        "told from it{flanks}", BLOW,
    ),
    Check(
        "flat-top", "suspect", OF_BLOWS, limits.bent_tip,
        "a straight side, as that of a saw-tooth, would go on {value:%0} above the peak, and bends before it: sensor "
        "or amplifier may be near its limit; a tip that is meant to be round cannot be told from it", BLOW,
    ),
    Check(
        "slew-rate", "suspect", OF_BLOWS, limits.straight_side,
        "the blow at {time:.6g}\xa0s: {sides} straight over {over:%0} of the peak, at {slope:unit} per us, where a "
        "smooth pulse is curved: the amplifier may be too slow (slew rate), unless the pulse is meant to be straight; "
        "the true peak may be larger, the width smaller", BLOW,
    ),
    Check(
        "slew-rate", "suspect", OF_BLOWS, limits.corner,
        "the top is a corner: {sharpness:%0} as wide at {tip:%0} of the peak as at {upper:%0} (a smooth pulse's "
        "{usual:%0}): an amplifier that is too slow (slew rate) rises in a straight line until it meets the fall, "
        "unless the pulse is meant to be pointed; the true peak may be larger, the width smaller", BLOW,
    ),
    Check(
        "flat-top", "suspect", OF_RESPONSES, limits.saturated,
        "the highest top is flat for {value:%0} of its half swing (a sine's for {usual:%0}): the sensor or an "
        "amplifier may have saturated; the true peak is larger", EVERY,
    ),
    Check(
        "flat-top", "suspect", OF_RESPONSES, limits.compressed,
        "the highest tops are lower than what the base makes of the modes that fit the lower samples: the sensor or an "
        "amplifier may have saturated",
    ),
    Check(
        "slew-rate", "suspect", OF_RESPONSES, limits.slew_limited,
        "the steepest slope stays the same for {value:%0} of its half swing (a sine's for {usual:%0}): the amplifier "
        "was too slow (slew rate); the true peak is larger", EVERY,
    ),
    Check(
        "spike", "bad", OF_RESPONSES, limits.spike,
        "at {time:.6g} s one sample stands off its neighbours, at {value:unit}: a spike", EVERY,
    ),
    Check(
        "coarse", "suspect", OF_RESPONSES, limits.coarse,
        "the steps of the converter are {value:unit}, {share:%1} of the peak",
    ),
    Check(
        "not-settled", "suspect", OF_RESPONSES, zero.offset_of_response,
        "the zero stands at {value:unit}, {share:%1} of the peak; it is taken off",
    ),
    Check(
        "drift", "suspect", OF_RESPONSES, zero.drift_before_response,
        "before the blow the zero drifts, by {value:unit} over a length of the record, {share:%1} of the peak",
    ),
    Check(
        "ac-coupling", "suspect", OF_RESPONSES, zero.ac_coupling_of_response,
        "after the blow the zero decays from {decay:unit} as a high-pass of {cutoff:.4g} Hz makes it (AC coupling)",
    ),
    Check(
        "zero-shift", "suspect", OF_RESPONSES, zero.shift_after_response,
        "after the blow the zero has shifted by {value:unit}, {share:%1} of the peak{back}",
    ),
    Check(
        "zero-shift", "bad", OF_BLOWS, zero.step_with_blow,
        "at {time:.6g}\xa0s the zero shifts by {value:unit} and stays there: the sensor was overloaded or came loose",
        EVERY,
    ),
    Check(
        "zero-step", "bad", OF_BLOWS, zero.step_alone,
        "at {time:.6g}\xa0s the zero shifts by {value:unit} and stays there: the sensor was overloaded or came loose",
        EVERY,
    ),
    Check(
        "drift", "good", OF_BLOWS, zero.drift_after,
        "after the blows the zero drifts on by {value:unit}, {share:%1} of the peak: velocities drift", ("spectrum",),
    ),
    Check(
        "zero-shift", "suspect", OF_BLOWS, zero.zero_shift,
        "after the blows the zero has shifted by {value:unit}, {share:%1} of the peak{back}: velocities drift, and if "
        "it did so in the blow", ("spectrum",),
    ),
    Check(
        "ac-coupling", "suspect", OF_BLOWS, zero.ac_coupling,
        "after the blows the record decays from {level:unit} as a high-pass of {cutoff:.4g}\xa0Hz makes it (AC "
        "coupling, tau = {constant:.4g}\xa0ms +- {doubt:.2g}\xa0ms; --ac-coupling auto takes it off)", ("spectrum",),
    ),
    Check(
        "velocity-drift", "suspect", OF_BLOWS, zero.velocity_drift,
        "long after the last blow the record stands {off:unit} off its zero: the integrated velocity drifts by "
        "{share:%0} of the velocity change until the record ends", ("spectrum",),
    ),
    Check(
        "hum", "suspect", OF_RESPONSES, disturbances.hum_of_response,
        "hum of {frequency:g} Hz, {share:%1} of the peak",
    ),
    Check(
        "noise", "suspect", OF_RESPONSES, disturbances.noise_of_response,
        "before the blow the channel scatters by {value:unit}",
    ),
    Check(
        "few-samples", "bad", OF_BLOWS, limits.few_samples,
        "a blow has {value:.1f} samples: its peak may be missed by {loss:%1}; sample faster",
    ),
    Check(
        "few-samples", "suspect", OF_RESPONSES, limits.few_samples_of_swing,
        "a swing of {frequency:.4g} Hz has {value:.1f} samples; sample faster",
    ),
    Check(
        "alias", "suspect", OF_BLOWS, limits.aliased,
        "at half the sampling rate the spectrum still has {value:%1} of its largest value: what lies above was folded "
        "into the record, anywhere, also into the blow; sample faster or filter before", ("peak", "rise", "spectrum"),
    ),
    Check(
        "alias", "suspect", OF_RESPONSES, limits.aliased_response,
        "at half the sampling rate the spectrum still has {value:%1} of its largest value: what lies above was folded "
        "into the record; sample faster or filter before", EVERY,
    ),
    Check(
        "polarity", "suspect", OF_BLOWS, blows.polarity,
        "the blows are negative: is the sensor mounted the other way? --polarity -1 turns it",
    ),
    Check(
        "cut", "suspect", OF_BLOWS, blows.cut,
        "the blow at {value:.6g}\xa0s is cut by the {where} of the record", BLOW,
    ),
    Check(
        "cut", "suspect", OF_BLOWS, blows.part_of_blow,
        "the record {where} in another blow, of which it holds a part only; its figures are not among these",
    ),
    Check(
        "cut", "suspect", OF_RESPONSES, blows.cut_response,
        "{what} before the response falls below a third of its peak{several}: it lasts longer", ("duration", "rms"),
    ),
    Check(
        "no-foot", "suspect", OF_BLOWS, zero.no_foot,
        "the record does not come back to {foot:%0} of the peak beside the blow at {time:.6g}\xa0s: the velocity "
        "change is that of the smooth pulse; against the record over its length",
    ),
    Check(
        "noisy", "suspect", OF_BLOWS, disturbances.noisy,
        "the noise is only {value:.0f} dB below the peak: figures are those of a fitted smooth pulse", ("rise",),
    ),
    Check("hum", "suspect", OF_BLOWS, disturbances.hum, "hum of {frequency:g}\xa0Hz{share}"),
    Check(
        "noise", "suspect", OF_BLOWS, disturbances.noise,
        "noise before the blow wanders by {value:unit} over its length",
    ),
    Check(
        "short-pretrigger", "good", OF_BLOWS, disturbances.short_before,
        "only {value} widths of the blow lie before it: what drift, hum and slow noise do to its figures cannot be "
        "known",
    ),
    Check(
        "short-pretrigger", "good", OF_RESPONSES, disturbances.short_before_response,
        "only {value} samples lie before the first blow: the zero is the median of the whole record, and what drift, "
        "hum and noise do to the figures cannot be known",
    ),
    Check(
        "ringing", "suspect", OF_BLOWS, disturbances.ringing,
        "the blow at {time:.6g}\xa0s rings at {frequency}; without it the peak is {peak:unit}, the width {width}; with "
        "it",
    ),
    Check(
        "swings", "suspect", OF_BLOWS, disturbances.larger_elsewhere,
        "outside the blows the record reaches {value:unit}, more than their peak {peak:unit}: it swings; take the "
        "shock response spectrum rather than the pulse", BLOW,
    ),
    Check(
        "drop-height", "bad", OF_BLOWS, blows.above_fall,
        "the velocity change, {value:.3g}\xa0m/s, is above twice the speed of the fall, {speed:.3g}\xa0m/s",
        ("peak", "velocity_change", "spectrum"),
    ),
    Check(
        "drop-height", "suspect", OF_BLOWS, blows.below_fall,
        "the velocity change, {value:.3g}\xa0m/s, is below the speed of the fall, {speed:.3g}\xa0m/s",
        ("peak", "velocity_change", "spectrum"),
    ),
    Check(
        "rebound", "good", OF_BLOWS, blows.rebounds,
        "{count} smaller contact{several} beside {where}, {value:%0} of the peak, {lag:.4g}\xa0ms after it: no "
        "blow{several}, but rebounds",
    ),
    Check(
        "double-hit", "suspect", OF_BLOWS, blows.double_hit,
        "two blows at {first:.6g}\xa0s and {second:.6g}\xa0s{several}, of {peak:unit} and {other:unit}, "
        "{apart:.4g}\xa0ms apart: a double hit; both count",
    ),
    Check(
        "missing-blow", "suspect", OF_BLOWS, blows.missing_blow,
        "no blow at {places}, where one is due: the others come every {period:.5g}\xa0ms; the gaps are left out of the "
        "interval",
    ),
    Check(
        "mains", "suspect", OF_BLOWS, blows.mains_blips,
        "the {count} blows come every {period:.5g}\xa0ms, in step with the mains of {frequency:.3g}\xa0Hz, equally "
        "high and through the whole record: they may be blips of a supply, and no blows; one record does not show "
        "which",
        (*BLOW, "interval"),
    ),
)  # fmt: skip


def examine(record: SampledRecord, *only: Callable[[Any], Iterable[Fault]]) -> list[HealthNotice]:
    """Return everything that is wrong with a record, the worst first; or what some of the checks find.

    Examples
    --------
    >>> import numpy as np
    >>> from strikewave.records.health.sampled_record import BlowRecord, ResponseRecord
    >>> [finding.code for finding in examine(BlowRecord(np.full(1000, 3.0), 1e-5))]
    ['dead']
    >>> from strikewave.records.response import BaseBlow, measure_responses
    >>> blows = [BaseBlow(2e-3, 3e-3, 4e-3, 1.0)]
    >>> still = np.full(1000, 3.0)
    >>> record = ResponseRecord(still, 1e-5, 0.0, "", blows, measure_responses(still, 1e-5, 0.0, blows))
    >>> [finding.code for finding in examine(record)]
    ['dead']
    """
    notices: list[HealthNotice] = []
    for check in CHECKS:
        if check.of in (record.kind, OF_BOTH) and (not only or check.find in only):
            own = check.notices(record)
            if own and check.ends:
                return own
            notices += own
    return worst_first(notices)
