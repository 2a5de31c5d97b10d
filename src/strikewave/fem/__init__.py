"""Explicit finite elements for impact: meshes, solids, contact, runs. Knows no units and no screen.

`Model` holds what is run, `strikewave.fem.solve.solve` runs it, `FemRun` is what comes out.
"""

from importlib import import_module
from typing import Any

_HOMES = {
    "Bilinear": "solids",
    "Controls": "model",
    "CutSection": "model",
    "Driven": "model",
    "Elastic": "solids",
    "FemRun": "run",
    "FieldFrame": "run",
    "Fixed": "model",
    "Grading": "sections",
    "Guided": "model",
    "JohnsonCook": "solids",
    "Mesh": "mesh",
    "Model": "model",
    "NonReflecting": "model",
    "Point": "model",
    "Pressure": "model",
    "Rigid": "model",
    "RigidWall": "model",
    "SurfaceContact": "model",
    "Symmetry": "model",
    "Tie": "model",
    "TimeCurve": "model",
    "ZerilliArmstrong": "solids",
    "ball": "shapes",
    "block": "shapes",
    "check_mesh": "quality",
    "cylinder": "shapes",
    "frame": "shapes",
    "half_cylinder": "shapes",
    "half_space": "shapes",
    "joined": "mesh",
    "moved": "shapes",
    "quality_report": "quality",
    "read_mesh": "mesh_files",
    "tube": "shapes",
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
