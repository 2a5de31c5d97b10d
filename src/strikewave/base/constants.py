"""Constants of nature that many rooms need."""

from __future__ import annotations

STANDARD_GRAVITY = 9.80665
"""Standard gravity, m/s^2 (exact, CGPM 1901)."""
