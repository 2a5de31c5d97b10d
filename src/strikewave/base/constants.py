"""Constants of nature and of convention that many rooms need."""

from __future__ import annotations

STANDARD_GRAVITY = 9.80665
"""Standard gravity, m/s^2 (exact, CGPM 1901)."""
COVERAGE = 2.0
"""Coverage factor k of an expanded uncertainty: 95.45 % of a normal distribution (JCGM 100, 6.2)."""
