"""Operations of an element and step, counted: the kernels run as plain Python on numbers that count what is done to them.

`counted` starts a process of its own in which nothing is compiled. A sum, product, quotient or root counts as one;
comparisons and signs count as none.
"""

import json
import subprocess
import sys

KINDS = {
    "elastic": (False, False),
    "bilinear": (True, False),
    "elastic, full": (False, True),
    "bilinear, full": (True, True),
}
"""Whether it yields, whether it is fully integrated."""


class Number:
    """A number that counts what is done to it."""

    done = 0

    def __init__(self, value):
        self.value = float(value)

    def sqrt(self):
        """Return the root."""
        return counted_as_one(self.value**0.5)

    def __neg__(self):
        return Number(-self.value)

    def __abs__(self):
        return Number(abs(self.value))

    def __float__(self):
        return self.value


def counted_as_one(value):
    """Return the result of an operation, and count it."""
    Number.done += 1
    return Number(value)


def _lift(name, result):
    plain = getattr(float, name)
    setattr(Number, name, lambda self, other: result(plain(self.value, float(other))))


for _name in ("add", "sub", "mul", "truediv"):
    _lift(f"__{_name}__", counted_as_one)
    _lift(f"__r{_name}__", counted_as_one)
for _name in ("__lt__", "__le__", "__gt__", "__ge__", "__eq__"):
    _lift(_name, bool)


def counted():
    """Return operations of an element and step by kind of element."""
    found = subprocess.run([sys.executable, __file__], check=True, capture_output=True, text=True)
    return json.loads(found.stdout)


def operations(yields, full):
    """Bring one chunk of elements that move at random to the end of a step; return operations by element."""
    from types import SimpleNamespace
    from unittest import mock

    import numpy as np

    from strikewave.fem import _hexahedron_kernels, _solid_kernels
    from strikewave.fem import _layout as layout
    from strikewave.fem.engine import Engine
    from strikewave.fem.model import Controls, Model
    from strikewave.fem.shapes import block
    from strikewave.fem.solids import Bilinear, Elastic

    def lifted(array):
        return np.array([Number(value) for value in array.ravel()], object).reshape(array.shape)

    solid = Bilinear(7820.0, 211e9, 0.29, yield_strength=200e6) if yields else Elastic(7820.0, 211e9, 0.29)
    mesh = block("block", (2e-3, 3e-3, 4e-3), 1e-3, 1e-3, 1e-3)
    engine = Engine(Model(mesh, {"block": solid}, Controls(1e-6, full=("block",) if full else ())))
    kind = engine.solid.kinds[0]
    assert len(mesh.hexahedra) == layout.LANES == kind.number.size
    blocks = kind.blocks._replace(
        **{name: lifted(getattr(kind.blocks, name)) for name in ("constants", "state", "solids")}
    )
    v = np.random.default_rng(1).normal(0.0, 5.0, engine.v.shape)
    moving = [lifted(each) for each in (engine.x, v, engine.f)]
    slabs, step, viscous = np.array([[0, 1]]), Number(1e-7), (Number(0.06), Number(1.5))
    scratch, sums = lifted(np.zeros(layout.SCRATCH)), lifted(np.zeros((1, layout.SUMS)))
    Number.done, counting = 0, SimpleNamespace(sqrt=Number.sqrt)
    with mock.patch.object(_hexahedron_kernels, "math", counting), mock.patch.object(_solid_kernels, "math", counting):
        kind.forces(blocks, slabs, np.array([0]), *moving, step, viscous, scratch, sums)
    return round(Number.done / layout.LANES)


if __name__ == "__main__":
    import plain_kernels  # noqa: F401

    print(json.dumps({name: operations(*kind) for name, kind in KINDS.items()}))
