"""What noise does to the figures of a record."""

from __future__ import annotations

import math

from strikewave.records.health.examined import Examined
from strikewave.records.health_notice import HealthNotice

NOISY = 15.0
"""Ratio of peak to noise, dB, below which a fitted pulse is suspect too: noise of a fifth of the peak."""


def noisy(record: Examined) -> list[HealthNotice]:
    """Find noise that hides a tenth of the peak: the figures are then those of a fitted smooth pulse."""
    fitted = [p for p in record.pulses if p.method == "fit"]
    if not fitted:
        return []
    ratio = min(20.0 * math.log10(abs(p.peak) / p.noise) for p in fitted if p.noise > 0.0)
    severity = "suspect" if ratio < NOISY else "good"
    message = f"the noise is only {ratio:.0f} dB below the peak: figures are those of a fitted smooth pulse"
    return [HealthNotice("noisy", message, ratio, severity=severity, harms=("rise",))]
