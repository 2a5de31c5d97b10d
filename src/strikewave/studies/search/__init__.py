"""Settings of machines and cases for wanted results; the cases that searches begin with by default."""

from typing import Literal

REFERENCE, DISC = "li-ma-2019", "45 steel"
"""Case of the rotary machine, and the material assumed for its turntable: no source states it."""
DROP_TABLE = "jesd22-b111-b"
"""Case of a drop table: chosen."""
STIFFNESS: Literal["frame"] = "frame"
"""Stiffness that sets the pulse width: chosen, since one frame is exchanged sooner than the mounts of all strikers."""
