"""The notices of split bars: constants, baselines, signs, echoes, shots, sensors; digests and sources."""

from __future__ import annotations

import contextlib
import hashlib
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.analyses.hopkinson.bar_end import SensorComparison
from strikewave.analyses.hopkinson.build import Gauged, HopkinsonCase, recorded_file
from strikewave.base.result import FAILED, INFO, WARNING, Notice
from strikewave.base.texts import percent, plain
from strikewave.cases.materials_of_case import far_numbers
from strikewave.cases.tables.hopkinson import HopkinsonSetup, LimitsTable, RecordedTable
from strikewave.hopkinson import Bar, BarMaterial
from strikewave.hopkinson.checks import LASTING, UNIFORM, Equilibrium, Momentum, StrikerCheck
from strikewave.hopkinson.echoes import Echoes, Way
from strikewave.hopkinson.pulses import Pulses, Quiet
from strikewave.hopkinson.reduction import Reduction
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers.columns import decode, encoding_of

MISMATCH = 0.005
"""Share by which stated density, modulus and speed may disagree. Chosen: a bar speed is measured to a few thousandths,
a modulus of a table holds to a per cent."""
DRIFT = 4.0
"""Standard errors by which means of parts of a quiet head may differ: noise alone does so in fewer than one of ten
thousand."""
DRIFT_SHARE = 1e-3
"""Share of the largest strain below which such a difference is not warned of: it changes no shown result."""


def digests(case: HopkinsonCase) -> dict[str, str]:
    """Return the SHA-256 of the files that a set-up names, by name; none of one that cannot be read."""
    setup, by_name = case.setup, {}
    records: list[RecordedTable | None] = [setup.bar.incident.gauge, setup.accelerometer]
    records.append(None if setup.bar.transmitted is None else setup.bar.transmitted.gauge)
    for record in records:
        if record is not None:
            with contextlib.suppress(OSError, ValueError), recorded_file(case, record).open("rb") as file:
                by_name[record.file] = hashlib.file_digest(file, "sha256").hexdigest()
    return by_name


def citations(theory: str, others: list[str]) -> tuple[str, ...]:
    """Return the keys of the sources, with that of the theory of dispersion."""
    return tuple(others if theory == "none" else [*others, "follansbee-frantz-1983"])


def reading_notices(findings: Iterable[HealthNotice]) -> Iterator[Notice]:
    """Yield the findings of reading the records."""
    for finding in findings:
        if finding.severity != "good":
            yield Notice(f"record-{finding.code}", finding.message, float(finding.value), 0.0)


def constant_notices(setup: HopkinsonSetup, constants: dict[str, BarMaterial]) -> Iterator[Notice]:
    """Yield densities and moduli far from those of any known material, and bars whose modulus belies their speed."""
    yield from far_numbers(setup)
    for name, elastic in constants.items():
        if abs(elastic.mismatch) > MISMATCH:
            message = (
                f"the modulus stated for the {name} bar differs by {percent(elastic.mismatch, 1, '+')} from rho c^2 = "
                f"{plain(elastic.modulus / 1e9, 4)}\xa0GPa of its density and speed, which is used"
            )
            yield Notice("constants-disagree", message, elastic.mismatch, MISMATCH)


def drift_notices(quiets: Iterable[Quiet], names: Iterable[str]) -> Iterator[Notice]:
    """Yield gauges whose baseline moves before the pulse."""
    for quiet, name in zip(quiets, names, strict=True):
        difference, error = quiet.drift
        limit = max(DRIFT * error, DRIFT_SHARE * float(abs(quiet.trace.strain).max()))
        if difference > limit:
            message = (
                f"the baseline of {name} moves by {plain(difference * 1e6)} ustrain before the pulse, more than noise "
                "does: forces and impulses are no surer than that"
            )
            yield Notice("baseline-drifts", message, difference, limit)


LENGTH_MISMATCH = 0.01
"""Share by which a stated length may differ from round trips and speed: a bar is measured better, and a wrong gauge
distance shows here."""
GAIN = 1e-3
"""Share of amplitude that passes may seem to gain in a round trip: no bar gains any, noise of a good record leaves a
thousandth."""
OTHER_WAY = 0.5
"""Misfit of the other way over that of the stated one below which it is proposed: it must be clearly better."""


def echo_notices(echoes: Echoes, bar: Bar, way: Way) -> Iterator[Notice]:
    """Yield a misfit of speed, length, losses, the way of the first pulse, or passes at the begin."""
    speed, other = echoes.speed, echoes.other_way
    off = echoes.difference
    limit = max(MISMATCH, speed.student * speed.error / bar.speed if speed.freedom > 0 else 0.0)
    turned = "away" if way == "towards" else "towards"
    ask = f'echoes.way = "{turned}" would give {plain(other.speed, 5)}\xa0m/s: which way does the first pulse run?'
    if other.misfit < OTHER_WAY:
        message = f"the times of the passes fit the other way of the first pulse better; {ask}"
        yield Notice("way-differs", message, other.misfit, OTHER_WAY)
    if abs(off) > limit:
        message = (
            f"the speed by echoes, {plain(speed.value, 5)}\xa0m/s, is {percent(off, 2, '+')} off the stated "
            f"{plain(bar.speed, 5)}\xa0m/s"
        )
        if not other.misfit < OTHER_WAY and abs(other.speed / bar.speed - 1.0) < OTHER_WAY * abs(off):
            message += f"; {ask}"
        yield Notice("speed-differs", message, off, limit)
    if speed.freedom < 1:
        yield Notice("no-scatter", "the speed stands on as few passes as tell it: it has no error", 0.0, 1.0)
    longer = echoes.round_trip.value / bar.length - 1.0 if math.isfinite(bar.length) else 0.0
    if abs(longer) > LENGTH_MISMATCH:
        message = (
            f"the stated length of {plain(bar.length * 1e3, 5)}\xa0mm is "
            f"{percent(-longer / (1.0 + longer), 1, '+')} off the {plain(echoes.round_trip.value * 1e3, 5)}\xa0mm by "
            "round trips and turns at the near end: is it, or the gauge distance, off?"
        )
        yield Notice("length-differs", message, longer, LENGTH_MISMATCH)
    gained = -2.0 * echoes.length.value * echoes.attenuation.value
    if gained > max(GAIN, 2.0 * echoes.length.value * 2.0 * echoes.attenuation.error):
        message = (
            f"passes gain {percent(gained, 2)} of amplitude in a round trip: do pulses overlap, or was "
            "one met on its way?"
        )
        yield Notice("attenuation-negative", message, echoes.attenuation.value, 0.0)
    if echoes.odd is not None:
        number = echoes.odd.number
        message = (
            f"pass {number} does not go with those after it: {plain(echoes.odd.late * 1e6, sign='+')}\xa0us late, "
            f"{plain(echoes.odd.strength)} times as "
            f"strong as they say; did it meet a specimen? echoes.skip = {number} leaves it out"
        )
        yield Notice("first-passes-differ", message, float(number), math.nan)


HEAD = 8192
"""Bytes of a text file in which its head is searched."""
_LONGEST = 300
"""Characters of a line that are searched: bounds the time of patterns."""
_TENSION = (
    r"tension|tensile|pull(?:ed|ing)?|zug(?:versuch|probe|stab|spannung|welle|belastung|beanspruchung)?|gezogen|traction|"
    r"shtb|thpb|tshb|拉伸"
)
_COMPRESSION = r"compress(?:ion|ive|ed)|druck(?:versuch|probe|spannung|welle|belastung|beanspruchung)?|gestaucht|压缩"
"""Words for the kind of a shot in English, German, French and Chinese. The name of the pressure bar itself is none: it
is used of tensile bars too."""
_SIGN_WORD = r"positive?|pos\.|negative?|neg\.|plus|minus"
_SIGN_MARK = r"\+|[-−]"
_WORD = {
    kind: re.compile(rf"(?:(?<![^\W_])|(?<=[一-鿿]))(?:{words})(?:(?![^\W_])|(?=[一-鿿]))", re.IGNORECASE)
    for kind, words in (("tension", _TENSION), ("compression", _COMPRESSION))
}
_STATED = [
    re.compile(
        rf"(?<![^\W_])(?:(?P<tension>{_TENSION})|{_COMPRESSION})[\s:=(,]{{0,3}}(?:is|ist|are)?\s{{0,2}}"
        rf"(?P<sign>(?:{_SIGN_WORD})(?![^\W_])|(?:{_SIGN_MARK})(?=\s{{0,9}}(?:$|[),;\]])))",
        re.IGNORECASE,
    ),
    re.compile(
        rf"(?<![^\W_])(?:(?P<sign>{_SIGN_WORD}|(?:{_SIGN_MARK})(?=\s{{0,2}}(?:is|ist|=|:)))\s{{0,2}}(?:is|ist|=|:|in)?)\s{{0,2}}"
        rf"(?:(?P<tension>{_TENSION})|{_COMPRESSION})(?![^\W_])",
        re.IGNORECASE,
    ),
]
"""A sign that is stated: ``tension positive``, ``compression (-)``, ``+ = tension``. A mark is a sign where nothing
follows it, or where it is said to mean something: in ``compression - shot 3`` it is a dash."""


class StatedKind(NamedTuple):
    """The kind of a shot by texts: sign of tension, 0 for none; place of a word for tension; mention of compression."""

    tension_sign: int
    sign_words: str
    tension: str
    compression: bool


def stated_kind(texts: Mapping[str, str]) -> StatedKind:
    """Return the kind of a shot by texts, by their places; contradicting signs count as none.

    Examples
    --------
    >>> stated_kind({"title": "tension positive"}).tension_sign, stated_kind({"title": "compression +"}).tension_sign
    (1, -1)
    >>> stated_kind({"title": "SHTB 18CrNiMo7-6", "file": "attention.csv"}).tension
    'title says SHTB'
    """
    signs: dict[int, str] = {}
    tension, compression = "", False
    for where, text in texts.items():
        for line in text.splitlines():
            part = line[:_LONGEST]
            for pattern in _STATED:
                for match in pattern.finditer(part):
                    sign = -1 if match["sign"].lower().startswith(("neg", "min", "-", "−")) else 1
                    signs.setdefault(sign if match["tension"] else -sign, f"{where} says {match[0].strip()}")
                # a word that states a sign says nothing of the kind of the shot
                part = pattern.sub(" ", part)
            word = _WORD["tension"].search(part)
            tension = tension or (f"{where} says {word[0]}" if word else "")
            compression = compression or _WORD["compression"].search(part) is not None
    sign, words = next(iter(signs.items())) if len(signs) == 1 else (0, "")
    return StatedKind(sign, words, tension, compression)


def stated_texts(case: HopkinsonCase, gauged: Sequence[Gauged]) -> dict[str, str]:
    """Return the texts of set-up, names of channels and heads of files, by their places."""
    texts: dict[str, str] = {}

    def add(table: Any, path: str) -> None:
        items = table.items() if isinstance(table, Mapping) else getattr(table, "__dict__", {}).items()
        for key, value in items:
            place = f"{path}.{key}" if path else str(key)
            if isinstance(value, str) and value:
                texts[f"the {place} of the set-up"] = value
            add(value, place)

    add(case.setup, "")
    for trace in gauged:
        file, name = trace.source
        texts |= {f"the channel {name}": name, f"the head of {file.name}": head_of(file)}
    return texts


def head_of(file: Path) -> str:
    """Return the lines of words at the beginning of a text file; nothing of another one."""
    try:
        with file.open("rb") as opened:
            raw = opened.read(HEAD)
    except OSError:
        return ""
    encoding = encoding_of(raw)
    lines = decode(raw, encoding).splitlines() if encoding else []
    return "\n".join(line for line in lines if re.search(r"[^\W\d_eE]", line))


def sign_notices(kind: StatedKind, traces: Sequence[tuple[Quiet, str]], in_strain: bool) -> Iterator[Notice]:
    """Yield contradictions to compression in each first pulse, from a stated sign of tension and from the traces.

    ``traces`` are turned so that their first pulse is positive, each with the name of its gauge; ``in_strain`` is True
    if the files hold strain, whose sign is not that of a wiring.
    """
    for trace, name in traces:
        if kind.tension_sign and trace.polarity == kind.tension_sign:
            sign = "positive" if trace.polarity > 0 else "negative"
            message = (
                f"{kind.sign_words}, and the first pulse of {name} is {sign}: that is tension, while it is taken as "
                "compression; the curve of a tensile shot is wrong"
            )
            yield Notice("tension", message, float(trace.polarity), severity=WARNING)
    if not kind.tension_sign and kind.tension and not kind.compression:
        message = (
            f"{kind.tension}, while each first pulse is taken as compression: the curve of a tensile shot is wrong"
        )
        yield Notice("tension", message, severity=WARNING)
    polarities = {trace.polarity for trace, _ in traces}
    if len(polarities) > 1:
        message = (
            f"the first pulses of {' and '.join(name for _, name in traces)} have opposite signs, while in "
            "compression as in tension they have the same sign: is a gauge turned round, or a channel not of this shot?"
        )
        yield Notice("signs-differ", message, float("nan"), severity=WARNING if in_strain else INFO)


BAR_STRAIN = 0.005
"""Plateau strain of a bar above which its material must be asked: a strong steel yields at 0.7 %."""
FLATTEST, SLENDEREST = 0.25, 2.0
"""Length over diameter: below it friction at the faces counts, above it the specimen buckles or is late."""
NEAREST_GAUGE = 10.0
"""Diameters between gauge and end of a bar after which the higher modes of a front have died away, as a rule."""
STRESS_OF_MODULUS = 0.1
"""Largest stress over the modulus: about the strength of a perfect crystal."""
LARGEST_STRESS = 10e9
"""Largest stress, Pa, where no modulus is stated. Chosen: above the strength of any metal."""
STRIKER_MISMATCH = 0.05
"""Share by which the incident pulse may differ from that of its striker: the speed of a striker and the factor of a
bridge are each known to a few per cent."""
LATE_SHARE = 0.2
"""Share of the rise time by which a wave may be late: the forces then differ by a fifth of the plateau by timing
alone."""
FEWEST_SAMPLES = 10.0
"""Least samples in the rise: a wave that is a sample late shifts the forces by a tenth of the plateau."""


def strain_notices(pulses: Pulses) -> Iterator[Notice]:
    """Yield an incident pulse that would bring most bars to yield."""
    if pulses.plateau > BAR_STRAIN:
        message = (
            f"the plateau of the incident pulse is {percent(pulses.plateau, 2)} of strain: does the bar bear that?"
        )
        yield Notice("bar-strain", message, pulses.plateau, BAR_STRAIN)


def shot_notices(reduction: Reduction, pulses: Pulses, largest_stress: float) -> Iterator[Notice]:
    """Yield gauges, a specimen, a stress (Pa) and an alignment that are not plausible in a shot."""
    bars, specimen, waves = reduction.bars, reduction.specimen, reduction.waves
    for name, bar in zip(("incident", "transmitted"), bars, strict=True):
        diameters = bar.gauge_distance / bar.diameter
        if diameters < NEAREST_GAUGE:
            message = (
                f"the gauge of the {name} bar is {plain(diameters)} diameters from the specimen: waves are not yet "
                "plane"
            )
            yield Notice("gauge-near", message, diameters, NEAREST_GAUGE)
    width, narrowest = math.sqrt(4.0 * specimen.area / math.pi), min(bar.diameter for bar in bars)
    if width > narrowest:
        message = f"the specimen, {plain(width * 1e3, 4)} mm wide, is wider than a bar, {plain(narrowest * 1e3, 4)} mm"
        yield Notice("specimen-wide", message, width, narrowest)
    shape = specimen.length / width
    if shape > SLENDEREST:
        message = f"the specimen is {plain(shape)} times as long as wide: it may buckle, and comes late to equilibrium"
        yield Notice("specimen-slender", message, shape, SLENDEREST)
    if shape < FLATTEST:
        message = f"the specimen is {plain(shape)} times as long as wide: friction at its faces raises the stress"
        yield Notice("specimen-flat", message, shape, FLATTEST)
    limit, bound = LARGEST_STRESS, "10 GPa"
    if specimen.modulus is not None:
        limit, bound = STRESS_OF_MODULUS * specimen.modulus, "a tenth of the stated modulus"
    if largest_stress > limit:
        message = (
            f"the largest stress is {plain(largest_stress / 1e9, 4)} GPa, above {bound}: look at units, gains and "
            "diameters"
        )
        yield Notice("stress-implausible", message, largest_stress, limit)
    samples, rise = pulses.rise / pulses.step, plain(waves.window * 1e6)
    if waves.beyond:
        message = (
            f"alignment by {waves.method} would move a wave by more than the {rise} us rise of the incident pulse: "
            "geometry is kept; look at distances and speeds"
        )
        yield Notice("alignment-refused", message, waves.window, waves.window)
    late = max(waves.late_balance, key=abs)
    if waves.method == "geometric" and abs(late) > LATE_SHARE * waves.window:
        reflected, transmitted = (plain(1e6 * own, sign="+") for own in waves.late_balance)
        message = (
            f"by the balance of forces the reflected wave is {reflected} us and the transmitted {transmitted} us late "
            f"at the specimen, of a rise of {rise} us: is a gauge distance or a bar speed off?"
        )
        yield Notice("waves-late", message, late, LATE_SHARE * waves.window)
    if samples < FEWEST_SAMPLES:
        message = f"the rise of the incident pulse has {plain(samples)} samples"
        yield Notice("few-samples", message, samples, FEWEST_SAMPLES)


def balance_notices(alike: Equilibrium, impulses: Momentum, limits: LimitsTable) -> Iterator[Notice]:
    """Yield forces and impulses that miss each other by more than the limits."""
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


def striker_notices(checked: StrikerCheck | None) -> Iterator[Notice]:
    """Yield an incident pulse that its striker should not make."""
    if checked is None:
        return
    pairs = (
        ("strain", checked.strain, checked.strain_expected, "plateau strain"),
        ("duration", checked.duration, checked.duration_expected, "width"),
    )
    for code, measured, expected, name in pairs:
        off = measured / expected - 1.0
        if abs(off) > STRIKER_MISMATCH:
            message = f"the {name} of the incident pulse is {percent(off, 1, '+')} off what the striker should make"
            yield Notice(f"striker-{code}", message, off, STRIKER_MISMATCH)


MISFIT = 0.1
"""Largest residual over the reading: above, the slope is mostly that of something else than the reference. Chosen: a
tenth."""
REFLECTED_MISFIT = 0.05
"""Share by which the reflected wave may contradict the model of the end. Chosen: gauges and bar speed are known to a
few per cent."""


def sensor_notices(comparison: SensorComparison, setup: HopkinsonSetup) -> Iterator[Notice]:
    """Yield a reading and a reference that disagree, or whose uncertainty is not stated."""
    value, noise = comparison.bandwidth.value, comparison.bandwidth.noise
    if value > noise * (1.0 + 1e-9):
        message = (
            f"the bandwidth of {plain(value / 1e3, 4)} kHz lies above {plain(noise / 1e3, 4)} kHz, where the incident "
            "pulse sinks in the noise of its gauge: the reference holds noise there, and no dispersion is corrected"
        )
        yield Notice("bandwidth-noise", message, value, noise)
    agreement, rise = comparison.agreement, comparison.pulses.rise
    if agreement.sensitivity < 0.0:
        message = "the sensor reads against the blow: it is mounted the other way, or its leads are swapped"
        yield Notice("sensor-reversed", message, agreement.sensitivity, 0.0)
    if abs(agreement.delay) > rise:
        message = (
            f"the reading is {plain(agreement.delay * 1e6, sign='+')} us late, more than the rise of the pulse, "
            f"{plain(rise * 1e6)} us: is the gauge distance, the bar speed or the clock of one record off?"
        )
        yield Notice("sensor-late", message, agreement.delay, rise)
    if agreement.residual > MISFIT:
        message = f"{percent(agreement.residual)} of the reading does not follow the reference"
        yield Notice("sensor-misfit", message, agreement.residual, MISFIT)
    misfit = comparison.reflected_misfit
    if misfit > REFLECTED_MISFIT:
        message = (
            f"the reflected wave says that the end moves {percent(misfit)} otherwise than the incident wave and what "
            "stands on the end do: is a mass, the gauge distance or the bar speed off, or does the joint open?"
        )
        yield Notice("reflected-differs", message, misfit, REFLECTED_MISFIT)
    missing = [key for key in ("strain", "speed") if getattr(setup.uncertainty, key) is None]
    if missing:
        message = (
            f"the uncertainty of the sensitivity holds its scatter, but nothing for {' and '.join(missing)}: state "
            + " and ".join(f"uncertainty.{key}" for key in missing)
        )
        yield Notice("uncertainty-partial", message, math.nan, math.nan)
