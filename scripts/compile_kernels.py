"""Compile the kernels that the tests use, each once: `python scripts/compile_kernels.py [PROCESSES]`.

Test processes that begin cold would each compile all of them. Here the families are shared out between processes, the
longest first; what is in the cache already costs a second or two.
"""

import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context


def fast_train() -> None:
    """Compile the fast run of a machine; the integrator that it shares with the full run is taken from there."""
    from strikewave.machines.fast_run import compile_fast_run

    compile_fast_run()


def machine() -> None:
    """Run a machine with its bodies, and one without a drive."""
    from strikewave import load_case, run_case

    run_case(load_case("li-ma-2019", ["feed.blows=2"]))
    run_case(load_case("rodgers-2009-amplifier"))


def struck_stack() -> None:
    """Strike layers that carry a sensor on gaskets."""
    from strikewave import load_case, run_case

    run_case(load_case("li-ma-2019-fig5", ["feed.blows=1"]))


def waves() -> None:
    """Run layered bars: on delay lines, struck by a body, by their spectrum."""
    from strikewave import load_case, run_wave

    run_wave(load_case("li-ma-2019-fig13-bar"))
    run_wave(load_case("togami-1996-bar"))
    run_wave(load_case("li-ma-2019-fig13-bar", ["solver.dispersion=pochhammer-chree"]))


def elements() -> None:
    """Run explicit elements: contact, plasticity."""
    from strikewave import load_case
    from strikewave.analyses.fem.run import run_fem

    run_fem(load_case("two-bars-fem", ["fem.duration=4 us", "fem.interval=1 us"]), 1)
    run_fem(load_case("taylor-bar-fem", ["fem.duration=4 us", "fem.interval=1 us"]), 1)


def impacts_and_spectra() -> None:
    """Solve an impact in closed form, a chain of bodies, a shock spectrum, a line through a record."""
    import numpy as np

    from strikewave.contact import Chain, ChainContact, Contact, Spring, exact, simulate, solve_impact
    from strikewave.records.contacts import robust_line
    from strikewave.signal.srs import srs

    contact = Contact(4.7e9, 1.1, float(exact(0.5)))
    solve_impact(contact, 0.2, 0.459, 20.0)
    bodies = {"striker": 0.2, "nose": 0.06, "assembly": 0.4}
    chain = Chain(bodies, [ChainContact("striker", "nose", contact), Spring("nose", "assembly", 9e7, 200.0)])
    simulate(chain, {}, {"striker": 3.0}, duration=400e-6)
    time = np.arange(2000) * 1e-5
    srs(np.sin(np.pi * np.clip(time / 1e-3, 0.0, 1.0)), 1e-5, np.geomspace(10.0, 1e4, 20))
    robust_line(time)


FAMILIES = (machine, fast_train, struck_stack, elements, waves, impacts_and_spectra)
"""The longest first, and the machine before the fast run, which waits for it."""


def timed(family: int) -> tuple[str, str]:
    """Run a family; return its name, and how long it took or why it failed: the tests will say more of that."""
    begun = time.perf_counter()
    try:
        FAMILIES[family]()
    except Exception as error:
        return FAMILIES[family].__name__, f"{type(error).__name__}: {error}"
    return FAMILIES[family].__name__, f"{time.perf_counter() - begun:.1f} s"


if __name__ == "__main__":
    with ProcessPoolExecutor(int(sys.argv[1]) if len(sys.argv) > 1 else 2, get_context("spawn")) as pool:
        for name, outcome in pool.map(timed, range(len(FAMILIES))):
            print(f"kernels of {name.replace('_', ' ')}: {outcome}", flush=True)
