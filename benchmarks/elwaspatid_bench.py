"""strikewave beside elwaspatid: its own example, and a loaded short bar, where it is wrong.

elwaspatid 2 takes the loaded end as anechoic while the load lasts: a load is an incident wave there, and both give the
same. A force that lasts beyond the first echo is not kept; the picture shows what becomes of a short bar.
"""

from pathlib import Path

import numpy as np
from peers import absent
from timing import best, table, write

from strikewave.reporting.style import Trace, save, traces
from strikewave.waves import End, Joint, Layer, LoadPulse, Stack, Tap, WantedError, run_bar

PICTURE = Path(__file__).parents[1] / "docs" / "images" / "loaded-short-bar.svg"
FORCE, LENGTH, DIAMETER, MODULUS, DENSITY = 19685.0, 0.07, 0.03, 211e9, 7820.0


def theirs(made, wave, steps, left):
    """Return the run of elwaspatid: its sign is tension above zero, and its wave enters at step 1."""
    from elwaspatid import WP2

    return WP2(made, -wave, nstep=steps, left=left)


def own_example(steps=300):
    """Return times of both, s, and the largest difference of the force, over the wave, in the middles of both bars.

    The example of elwaspatid's own page, in GPa and with 50 cells a bar: ``BarSet(E=[210, 78], rho=[7800, 2800],
    L=[1, 1.1], d=[0.030, 0.028])`` under 100 ones; bars that part when pulled.
    """
    from elwaspatid import BarSet

    made = BarSet(E=[210e9, 78e9], rho=[7800, 2800], L=[1, 1.1], d=[0.030, 0.028], nmin=50)
    rows = zip((7800.0, 2800.0), (210e9, 78e9), (0.030, 0.028), made.seg, strict=True)
    layers = tuple(
        Layer(f"bar {k}", density, modulus, 0.25 * np.pi * d**2, float(segment.xloc[-1]))
        for k, (density, modulus, d, segment) in enumerate(rows)
    )
    stack = Stack(layers, (Joint(unilateral=True),), End("free"))
    load = LoadPulse("rectangle", 1.0, 99.5 * made.dt, kind="incident")
    taps = [Tap(0, 0.5), Tap(1, 0.5)]

    def our_run():
        return run_bar(stack, load, taps, (steps - 2) * made.dt, WantedError(step=made.dt))

    def their_run():
        return theirs(made, np.ones(100), steps, "infinite")

    ours, peer = our_run(), their_run()
    misses = [
        np.abs(-segment.Force[1:, segment.Force.shape[1] // 2] - ours.force[:, k]).max()
        for k, segment in enumerate(peer.bar.seg)
    ]
    return best(their_run), best(our_run), float(max(misses))


def short_bar(steps=400):
    """Return velocities of the free end of a short bar under a steady force: time, ours, the closed form, theirs.

    The closed form: 2 F/Z at the first arrival and after each further round trip.
    """
    bar = Layer("bar", DENSITY, MODULUS, 0.25 * np.pi * DIAMETER**2, LENGTH)
    step = bar.transit / 50
    run = run_bar(
        Stack((bar,)), LoadPulse("rectangle", FORCE, 1.0), [Tap(0, 1.0)], (steps - 2) * step, WantedError(step=step)
    )
    arrived = np.floor((run.time / bar.transit + 1.0 + 1e-9) / 2.0)
    closed = 2.0 * FORCE / bar.impedance * arrived
    peer = None
    if not absent("elwaspatid"):
        from elwaspatid import BarSet

        made = BarSet(E=[MODULUS], rho=[DENSITY], L=[LENGTH], d=[DIAMETER], nmin=50)
        peer = theirs(made, FORCE * np.ones(steps), steps, "free").bar.seg[0].Veloc[1:, -1]
    return run.time, run.velocity[:, 0], closed, peer


def draw():
    """Draw the short bar into the docs and return the largest differences from the closed form, over 2 F/Z."""
    time_, ours, closed, peer = short_bar()
    jump = closed[closed > 0.0].min()
    curves = [Trace("strikewave", time_, ours)]
    if peer is not None:
        curves.append(Trace("elwaspatid 2.0", time_, peer))
    title = "Free end of a steel bar of 70 mm under a steady force of 19.7 kN"
    save(traces(title, curves, "m/s", "time after the start of the load"), PICTURE)
    return [float(np.abs(x - closed).max() / jump) for x in (ours, peer) if x is not None]


def section():
    """Return the part of the page of benchmarks."""
    if absent("elwaspatid"):
        return f"elwaspatid: {absent('elwaspatid')}; its own example and the loaded short bar were not run."
    peer, ours, miss = own_example()
    off = draw()
    rows = [
        ("own example (2 bars, 100 cells, 300 steps), time of the whole run", write(ours), write(peer)),
        ("the same: largest difference of the force", f"{miss:.0e} of the wave", ""),
        ("short bar under a steady force: largest error of the velocity", *(f"{x:.1g} x 2 F/Z" for x in off)),
    ]
    return f"""{table(("bar", "strikewave", "elwaspatid 2"), rows)}

elwaspatid takes the loaded end as anechoic while a load lasts. For an incident wave, its own example, both give the same;
a force on a short bar is lost with the first echo:

![Velocity of the free end: ours climbs by 2 F/Z each round trip, elwaspatid stays at the first step](images/{PICTURE.name})"""


if __name__ == "__main__":
    print(section())
