"""Layered bars: layer steps a second beside elwaspatid (in a process of its own, where it is installed) and the floor."""

import importlib.util
import time

import numpy as np

from strikewave.materials import material
from strikewave.waves import BONDED, End, Stack, _kernels, round_bar
from strikewave.waves.transit import grid_of, state_at_rest, tables_of

LAYERS = (3, 10, 100, 1000)
STEP = 20e-9


def bar(layers):
    """Return a bar of steel and aluminium by turns, each layer of its own length."""
    steel, aluminium = material("65Mn"), material("2A12")
    rows = tuple(
        round_bar(f"layer {i}", aluminium if i % 2 else steel, 0.010 + 0.0007 * (i % 50), 0.03) for i in range(layers)
    )
    return Stack(rows, (BONDED,) * (layers - 1), End("free"))


def rate(layers, layer_steps=2e7):
    """Return layer steps a second of the bare loop."""
    stack = bar(layers)
    grid = grid_of(stack, STEP)
    tables, load = tables_of(stack, grid), np.sin(1e-3 * np.arange(int(layer_steps / layers)))
    times = []
    for _ in range(4):
        state = state_at_rest(stack, grid)
        begun = time.perf_counter()
        _kernels.run_on(tables, state, load)
        times.append(time.perf_counter() - begun)
    return load.size * layers / min(times)


def floor():
    """Return layer steps a second if only the bytes had to move: 2 values read and 2 written each, 32 bytes."""
    a = np.zeros(2_000_000)
    b = np.ones_like(a)
    times = []
    for _ in range(5):
        begun = time.perf_counter()
        np.copyto(a, b)
        times.append(time.perf_counter() - begun)
    return 16.0 * a.size / min(times) / 32.0


def peer(layers=3, steps=2000):
    """Return layer steps a second of elwaspatid on the same bar; None where it is not installed."""
    if importlib.util.find_spec("elwaspatid") is None:
        return None
    from elwaspatid import WP2, BarSet

    stack = bar(layers)
    rows = stack.layers
    made = BarSet(
        [x.modulus for x in rows],
        [x.density for x in rows],
        [x.length for x in rows],
        [x.diameter for x in rows],
        nmin=50,
    )
    wave = np.sin(1e-3 * np.arange(steps))
    begun = time.perf_counter()
    WP2(made, incw=wave, nstep=steps, left="free", right="free")
    return steps * layers / (time.perf_counter() - begun)


def rows():
    """Return the rows of the table."""
    limit, other = floor(), peer()
    found = []
    for layers in LAYERS:
        ours = rate(layers)
        target = {3: ">= 50 M", 100: ">= 120 M"}.get(layers, "")
        against = f"{ours / other:.0f} x" if other and layers == 3 else ""
        found.append((f"{layers} layers", f"{ours / 1e6:.0f} M/s", target, f"{limit / ours:.1f} x", against))
    named = "elwaspatid 2 (WP2, same bar, its own step of 50 a layer)"
    found.append((named, f"{other / 1e6:.3f} M/s" if other else "not installed", "", "", "1" if other else ""))
    return found
