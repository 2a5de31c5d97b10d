"""What to know of a buffer design: its search, its first stack, and the materials of that."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from strikewave.base.citations import FROM_MEMORY
from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.base.errors import IntegrationError
from strikewave.base.result import FAILED, INFO, Notice
from strikewave.base.texts import percent, plain
from strikewave.cases.stack_of_case import memory_notices
from strikewave.contact import AnyContact
from strikewave.contact.cushions import Pad, carried, elastomer, retardation_of, retarded
from strikewave.sensors.trial import channel_notices, sensor_pulse
from strikewave.studies.buffer.candidate import SHOWN_PERIODS, BufferCandidate, carries, slowest_shown, true_peak
from strikewave.studies.buffer.mounting_site import confined, reading_of, spread

if TYPE_CHECKING:
    from strikewave.studies.buffer.result import BufferStudy

LARGE_STRAIN = 0.1
"""Compression of a gasket over its thickness beyond which the modulus of small strain is outside its range: a
neo-Hookean rubber, s = E/3 (l - 1/l^2), is 12 % stiffer there."""
FITTED_LOSS = 0.05
"""Deviation of the loss factor over its band beyond which it is warned of: the height of the resonance errs by as
much. Chosen: 5 %, as `strikewave.studies.buffer.candidate.ALIKE`, within which stacks count as the same."""
COARSE = 0.02
"""Share of the limit beyond which a step of the recorder's bits is warned of: rounding then moves a peak at the limit
by up to 1 %."""


def _g(acceleration: float) -> str:
    """Write an acceleration in g."""
    return f"{acceleration / STANDARD_GRAVITY:.0f}\xa0g"


def study_notices(study: BufferStudy, skipped: int) -> Iterator[Notice]:
    """Yield what to know of the search, of the first stack, and of its materials."""
    if skipped:
        message = f"{skipped} stacks are left out: too many wavelengths thick, each would take seconds to try"
        yield Notice("stack-left-out", message, float(skipped), 0.0, severity=INFO)
    first, limit = study.candidates[0], study.goal.limit
    if study.broken:
        yield _why_none(study)
    if first.stack:
        yield from _pulse_lost(study, first)
        yield from _gasket_notices(study, first)
    yield from _other_blows(study, first)
    reading = study.reading(first)
    pulses = [{study.first_channel.sensor.name: sensor_pulse(reading)}]
    yield from channel_notices([study.first_channel], pulses, study.blows.assembly_mass)
    yield from memory_notices(study.site.table)
    if not first.whole:
        message = (
            f"the history ends {plain(study.motion.after_peak * 1e6, 4)}\xa0us after the surface's largest value, "
            "before "
            f"{first.name} has swung to one side at {plain(first.band.resonance, 4)}\xa0Hz: its largest reading "
            "may come later"
        )
        yield Notice("short-history", message, study.motion.after_peak, SHOWN_PERIODS / first.band.resonance)
    if reading.quantum > COARSE * limit:
        message = f"a step of the recorder is {_g(reading.quantum)} for a limit of {_g(limit)}: take a smaller range"
        yield Notice("coarse-steps", message, reading.quantum, COARSE * limit)
    yield from _not_robust(study, first)


def _pulse_lost(study: BufferStudy, first: BufferCandidate) -> Iterator[Notice]:
    """Yield whether the first stack passes too little of the pulse to show it."""
    width, passed = study.motion.width, first.band.within_10
    if not carries(first, width):
        message = (
            f"{first.name} passes within 10 % only up to {plain(passed)}\xa0Hz, and a pulse of "
            f"{plain(width * 1e6, 4)}\xa0us "
            f"needs about {plain(1.0 / width, 4)}\xa0Hz, one over its width: the reading is the buffer's own "
            "swing; it tells that the sensor survives, not what the pulse was"
        )
        yield Notice("pulse-lost", message, passed, 1.0 / width)


def _not_robust(study: BufferStudy, first: BufferCandidate) -> Iterator[Notice]:
    """Yield whether the first stack keeps the limit with the moduli of the table only."""
    leading, limit = first.leading, study.goal.limit
    if leading is None or not first.keeps or leading.robust:
        return
    most = max(leading.softer, leading.stiffer, leading.confined or 0.0)
    if most <= limit:
        what = "a modulus between, or no slip at other moduli, breaks the limit, or the history is too short to tell"
    else:
        what = f"the sensor reads up to {_g(most)}"
    ends = {name: spread(material(name)) for name in dict.fromkeys(layer.material for layer in first.stack)}
    tried = ", ".join(f"{name} {low:g} to {high:g} times" for name, (low, high) in ends.items())
    message = f"{first.name} is not sure to keep the limit ({tried} the modulus of the table, slip or none): {what}; "
    if study.robust is not None:
        message += f"measure the gaskets, or take {study.robust.name}, which is robust (--rank robust)"
    elif study.goal.rank == "robust":
        slowest = slowest_shown(first.stack, study.motion)
        message += (
            "measure the gaskets, or try thicker ones; no stack is known to be robust, which takes a history of half a "
            "period of the softest: this one is long enough for stacks like this that ring above "
            f"{plain(slowest)}\xa0Hz"
        )
    else:
        message += "measure the gaskets, or look for a robust stack with --rank robust"
    yield Notice("not-robust", message, most, limit)


def _why_none(study: BufferStudy) -> Notice:
    """Return the notice that no stack keeps the limit: which comes nearest, and what stands against it."""
    first, motion, limit = study.candidates[0], study.motion, study.goal.limit
    value = first.true_peak
    bound = study.site.range if first.clipped else limit
    message = (
        f"no stack keeps {_g(limit)}: the nearest, {first.name}, gives {_g(value)} at the "
        f"{'element' if first.clipped else 'reading'}"
    )
    if first.clipped and value > bound:
        message += f", beyond the range of {_g(bound)}"
    if motion.rigid_peak is not None and abs(motion.rigid_peak) > limit:
        message += (
            f"; the rigid-body pulse itself has {_g(abs(motion.rigid_peak))}, so that a buffer "
            "that keeps the limit no longer reads it"
        )
    return Notice("limit-not-kept", message + "; try softer or thicker gaskets, or more layers", value, bound, FAILED)


def _gasket_notices(study: BufferStudy, first: BufferCandidate) -> Iterator[Notice]:
    """Yield limits that the gaskets of the first stack exceed, and materials whose numbers are from memory."""
    assert first.leading is not None
    for layer, stress, strain in zip(first.stack, first.leading.stress, first.leading.strain, strict=True):
        strength = material(layer.material).yield_strength
        if strength is not None and stress > strength:
            message = (
                f"{layer} carries {plain(stress / 1e6)}\xa0MPa, beyond its yield strength of "
                f"{plain(strength / 1e6)}\xa0MPa"
            )
            yield Notice("gasket-yield", message, stress, strength)
        if strain > LARGE_STRAIN:
            message = f"{layer} is compressed by {percent(strain, 0)}: its modulus is that of small strain; it stiffens"
            message += _hardened(study, first)
            yield Notice("gasket-strain", message, strain, LARGE_STRAIN)
    if first.loss_error > FITTED_LOSS:
        message = f"the loss factor of {first.name} deviates by up to {percent(first.loss_error, 0)} over its band"
        yield Notice("loss-fit", message, first.loss_error, FITTED_LOSS)
    elastic = [spread(material(layer.material))[1] for layer in first.stack]
    factors = confined(first.stack, study.site.area)
    stiffer, usual = max(zip(factors, elastic, strict=True), key=lambda pair: pair[0] / pair[1])
    if stiffer > usual:
        message = (
            f"the elastomer is thin for its width: where its faces cannot slip it is up to {plain(stiffer)} times as "
            "stiff as computed (Gent & Lindley); the column no slip shows what is then read"
        )
        yield Notice("elastomer-confined", message, stiffer, usual)
    for name in dict.fromkeys(layer.material for layer in first.stack):
        row = material(name)
        if row.status == FROM_MEMORY:
            yield Notice("material-from-memory", f"{name}: {row.note}", 1.0, 0.0, severity=INFO)


def _hardened(study: BufferStudy, first: BufferCandidate) -> str:
    """Return in words what the mass of the sensor would reach on a neo-Hookean pad instead of a single elastomer."""
    row = material(first.stack[0].material)
    if len(first.stack) > 1 or row.kind != "elastomer":
        return ""
    site, (layer,) = study.site, study.site.mounting(first.stack).gaskets
    free: AnyContact = elastomer(Pad(layer.area, layer.thickness), layer.modulus, shape_factor=0.0)
    if layer.loss_factor > 0.0:
        free = retarded(free, retardation_of(layer.loss_factor, first.band.resonance))
    try:
        mass = carried(free, site.mass + 0.5 * layer.mass, study.motion.acceleration, study.motion.step)
    except IntegrationError:
        return "; as a neo-Hookean pad it would bottom out"
    return f"; on a neo-Hookean pad that lies loose, the sensor's mass would reach {_g(float(mass.acceleration.max()))}"


def _other_blows(study: BufferStudy, first: BufferCandidate) -> Iterator[Notice]:
    """Yield whether the first stack breaks the limit in another blow of the run."""
    others = [motion for motion in study.blows.motions if motion is not study.motion]
    readings = [(reading_of(study.site, first.stack, motion), motion.name) for motion in others]
    peaks = [(true_peak(reading), reading.clipped, name) for reading, name in readings]
    worst, clipped, name = max((p for p in peaks if p[1] or p[0] > study.goal.limit), default=(0.0, False, ""))
    if first.keeps and worst > 0.0:
        message = f"in {name} the sensor reads {_g(worst)} with {first.name}: try --blow"
        if clipped:
            message = f"in {name} the element reaches {_g(worst)} with {first.name}, and is cut off: try --blow"
        yield Notice("other-blow", message, worst, min(study.goal.limit, study.site.range))
