"""Explicit elements against CalculiX on the same meshes: fields at all instants, forces and speeds; two minutes.

    python scripts/validate/other_codes.py

Both codes discretise the same equations with elements, steps and damping of their own. The models are those of
`tests/fem/test_calculix.py`, which shows too that what they differ by vanishes with the size of the elements. Without
CalculiX on the PATH nothing is kept.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from kit import ROOT, Comparison, keep

sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT / "benchmarks"))

import calculix

from fem import test_calculix as models

CONTACT = (
    "of the contact, not of the bodies: CalculiX's is a linear penalty, which leaves a gap that closes; the difference "
    "falls as the penalty hardens (tests/fem/test_calculix.py)"
)
"""Why bodies in contact differ more."""
KINKS = "stress has kinks where a wave loads beyond yield: of first order, it halves with the elements"
FIELDS = ("displacement", "velocity", "stress")


def field(what: str, quantity: str, miss: float, note: str = "") -> Comparison:
    """Return a comparison of fields: the norm of their difference over that of CalculiX's, over all instants."""
    code = f"CalculiX {calculix.version()}"
    return Comparison(what, quantity, code, "predicted", None, None, miss=float(miss), note=note)


def comparisons(folder: Path) -> Iterator[Comparison]:
    """Yield a bent tower, a plastic rod, and two bars that meet."""
    for element, full in (("C3D8R", ()), ("C3D8", ("tower",))):
        both = models.solved(models.tower(2e-3, full=full), folder, element=element, every=2)
        for name, miss in zip(FIELDS, models.differences(both), strict=True):
            yield field(f"bent steel tower, 2 mm, {element}", name, miss)
    both = models.solved(models.rod(1.25e-3), folder, element="C3D8R", every=2)
    for name, miss in zip(FIELDS, models.differences(both), strict=True):
        yield field("steel rod that yields, 1.25 mm, C3D8R", name, miss, KINKS if miss > 0.05 else "")
    both = models.solved(models.striking_bars(), folder, penalty=2e14)
    what = "two steel bars of 100 mm, 5 m/s, 2.5 mm, C3D8R"
    for quantity, of in (
        ("contact force, means of 2 µs", lambda fields: models.mean_forces(both, fields, "two", 4)),
        ("momentum of the struck bar", lambda fields: models.momentum_z(both, fields, "two")),
        ("stress at the middle", lambda fields: models.mid_stress(both, fields, "two")),
    ):
        miss = models.difference(of(both.ours), of(both.theirs))
        yield field(what, quantity, miss, CONTACT if miss > 0.05 else "")


def main() -> None:
    """Run both codes and keep what they differ by."""
    if calculix.CCX is None:
        print(calculix.HOW_TO_GET)
        return
    with tempfile.TemporaryDirectory() as place:
        keep("other codes", list(comparisons(Path(place))))


if __name__ == "__main__":
    main()
