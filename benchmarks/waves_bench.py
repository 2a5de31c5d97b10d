"""Layered bars: layer steps and layer frequencies a second, beside elwaspatid and the floor."""

import time

import elwaspatid_bench
import numpy as np
from peers import absent
from timing import best, table, write

from strikewave.base.compiled import kernel
from strikewave.base.constants import material
from strikewave.waves import BONDED, End, LoadPulse, Stack, round_bar
from strikewave.waves._kernels import advance, arriving_at_face
from strikewave.waves.dispersion import Rod, wave_number
from strikewave.waves.spectral import SpectralStack
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


@kernel
def bare_loop(tables, state, load):
    """Run a stack under a force without recording."""
    for n in range(load.size):
        advance(tables, state, load[n] - arriving_at_face(tables, state))


def rate(layers, layer_steps=2e7):
    """Return layer steps a second of the bare loop."""
    stack = bar(layers)
    grid = grid_of(stack, STEP)
    tables, load = tables_of(stack, grid), np.sin(1e-3 * np.arange(int(layer_steps / layers)))
    times = []
    for _ in range(4):
        state = state_at_rest(stack, grid)
        begun = time.perf_counter()
        bare_loop(tables, state, load)
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
    """Return layer steps a second of elwaspatid on the same bar; None where it cannot be run."""
    if absent("elwaspatid"):
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
    found.append((named, f"{other / 1e6:.3f} M/s" if other else absent("elwaspatid"), "", "", "1" if other else ""))
    return found


def spectral_rows(bins=8000):
    """Return the rows of the spectral solver: one recursion per layer and frequency, beside its exponential alone."""
    x = np.linspace(0.0, 1.0, 1_000_000) * (1.0 + 1.0j)
    floor = best(lambda: np.exp(x)) / x.size
    found = []
    for layers in LAYERS:
        step = 1e-7
        spectrum = SpectralStack(bar(layers), LoadPulse("sine-squared", 1e4, 1e-4), step, max(200, bins * 3 // layers))
        spectrum.look([(0, 0.5)])
        each = best(lambda spectrum=spectrum: spectrum.ends(), 3) / (spectrum.s.size * layers)
        found.append((f"{layers} layers", write(each), f"{each / floor:.1f} x"))
    w = np.linspace(0.0, 5e6, 20_000) - 1e4j
    each = best(lambda: wave_number(w, Rod(0.01, 5000.0, 0.29)), 3) / w.size
    found.append(("wave number of Pochhammer and Chree, 20 000 frequencies to 5 MHz, 20 mm steel", write(each), ""))
    return found


def section():
    """Return the section of the page of benchmarks."""
    return f"""## Waves in a layered bar

Layer steps a second of the bare delay lines, one core, bonded joints.

{table(("bar", "layer steps", "target", "above the floor", "against elwaspatid"), rows())}

Floor: a layer step reads two waves and writes two, 32 bytes, at the speed at which numpy copies memory. Few layers stay in
the cache and can be below it.

The spectral solver, time for each layer at each frequency:

{table(("bar", "each", "above the floor"), spectral_rows())}

Floor: the one complex exponential that a layer needs, by numpy.

{elwaspatid_bench.section()}"""


if __name__ == "__main__":
    print(section())
