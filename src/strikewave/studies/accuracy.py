"""How accurately studies run a machine: one tolerance for all of them."""

from __future__ import annotations

RUN_TOLERANCE = 1e-7
"""Local error of a step of a full run, over the scales of one contact. Measured on the blows of li-ma-2019: it
changes no peak by more than 1e-8, and takes half the time of 1e-10. Blows that amplify errors stay below 1e-6."""
FINER_TOLERANCE = 1e-8
"""Local error of a second try where a motion cannot be followed: two switches of friction and stop that fell into one
step may then be apart."""
