"""What every solution of split bars shares: files and their digests, sources, what reading and constants say."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Iterable, Iterator

from strikewave.analyses.hopkinson.build import recorded_file
from strikewave.analyses.hopkinson.setup_file import HopkinsonCase
from strikewave.base.percents import percent, plain
from strikewave.base.result import Notice
from strikewave.cases.material_notices import far_numbers
from strikewave.cases.tables.hopkinson import HopkinsonSetup, RecordedTable
from strikewave.hopkinson import BarMaterial
from strikewave.hopkinson.pulses import Quiet
from strikewave.records.health_notice import HealthNotice

MISMATCH = 0.005
"""Share by which stated density, modulus and speed may disagree with no warning. Chosen: a bar's speed is measured to a
few thousandths, where the modulus of a table holds to a per cent."""
DRIFT = 4.0
"""Standard errors by which means of parts of a quiet head may differ with no warning: noise alone comes so far in fewer
than one of ten thousand."""
DRIFT_SHARE = 1e-3
"""Share of the largest strain of the record below which such a difference is not warned of: it changes no result that
is shown."""


def digests(case: HopkinsonCase) -> dict[str, str]:
    """Return the SHA-256 of the files that a set-up names, by these names; none of one that cannot be read."""
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
