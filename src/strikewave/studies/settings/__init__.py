"""Settings of machines for an asked pulse; what a search begins with unless said otherwise."""

from typing import Literal

REFERENCE, DISC = "li-ma-2019", "45 steel"
"""Case and material of the turntable."""
DROP_TABLE = "jesd22-b111-b"
"""Case of a drop table, with a specification."""
STIFFNESS: Literal["frame"] = "frame"
"""Stiffness that sets the pulse width."""
