"""Kernels of contacts as Python runs them: nothing is compiled, so that each is asked alone, with small numbers."""

from types import SimpleNamespace

from strikewave.contact import _chain_kernels, _integrator, _kernels, _law_kernels, _pair_kernels, chain

MODULES = _kernels, _law_kernels, _chain_kernels, _pair_kernels, _integrator, chain
TAUGHT = {"derivatives": 6, "forces": 6, "switches": 6, "horizon": 5, "switch": 6}
"""What a system is taught, and how many arguments that takes."""


def interpret(monkeypatch, kernels):
    """Let the kernels of contacts call one another as plain functions; return some of them so, by name."""
    for module in MODULES:
        for name, value in list(vars(module).items()):
            if hasattr(value, "py_func"):
                monkeypatch.setattr(module, name, value.py_func)
    return SimpleNamespace(**{kernel.__name__: kernel.py_func for kernel in kernels})


def taught(home, kind):
    """Return what the module of a system teaches the integrator, as plain functions by name."""
    asked = SimpleNamespace(instance_class=kind)
    return SimpleNamespace(**{name: getattr(home, f"_{name}")(asked, *[None] * (n - 1)) for name, n in TAUGHT.items()})


def integrate_plainly(monkeypatch, home, kind):
    """Let the integrator follow systems of a kind as plain functions."""
    for name, function in vars(taught(home, kind)).items():
        monkeypatch.setattr(_integrator, name, function)
