"""Explicit finite elements for impact: meshes, solids, contact, runs. Knows no units and no screen.

`Model` holds what is run, `strikewave.fem.solve.solve` runs it, `FemRun` is what comes out.
"""

from importlib import import_module
from typing import Any

_HOMES = {
    "Bilinear": "solids",
    "Contact": "model",
    "Controls": "model",
    "Curve": "model",
    "Driven": "model",
    "Elastic": "solids",
    "FemRun": "run",
    "Fixed": "model",
    "Frame": "run",
    "Grading": "grading",
    "Guided": "model",
    "JohnsonCook": "solids",
    "Mesh": "mesh",
    "Model": "model",
    "NonReflecting": "model",
    "Point": "model",
    "Pressure": "model",
    "Rigid": "model",
    "Section": "model",
    "Symmetry": "model",
    "Tie": "model",
    "Wall": "model",
    "ZerilliArmstrong": "solids",
    "ball": "round_shapes",
    "block": "shapes",
    "check_mesh": "quality",
    "cylinder": "round_shapes",
    "frame": "shapes",
    "half_cylinder": "round_shapes",
    "half_space": "round_shapes",
    "joined": "mesh",
    "moved": "shapes",
    "quality_report": "quality",
    "read_mesh": "imported",
    "tube": "round_shapes",
    "turned": "shapes",
}

__all__ = list(_HOMES)  # the names stand once, above


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used (PEP 562)."""
    if name in _HOMES:
        return getattr(import_module(f"strikewave.fem.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'strikewave.fem' has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
