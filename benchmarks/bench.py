"""Times of strikewave beside its peers and beside the floor: ``make bench`` prints and writes docs/benchmarks.md.

Every peer runs in the same process on the same case at the same tolerance. A peer that cannot be run is named.
"""

import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import app_bench
import elements_bench
import machine_bench
import numba
import numpy as np
import peers
import peers_bench
import planted_boards
import planted_judge
import reading_bench
import records_bench
import studies_bench
import waves_bench
from scipy.integrate import solve_ivp
from timing import best, table, write

from strikewave import load_case, run_case
from strikewave.base.constants import material
from strikewave.contact import (
    Contact,
    PressureCap,
    damper_law,
    exact,
    hertz,
    johnson,
    line_cap,
    palmgren,
    point_cap,
    solve_impact,
)
from strikewave.contact import _pair_kernels as pairs
from strikewave.contact._integrator import empty_record
from strikewave.contact.law import rows

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "benchmarks.md"

FLOOR = """\
Where the CPU time of `run li-ma-2019 --json --no-band` goes, from bytecode, kernels in the cache (measured while other work took
both cores, which makes it a quarter longer than at rest):

| part | CPU time |
| --- | --- |
| python | 10 ms |
| import numpy | 103 ms |
| import llvmlite and numba | 130 ms |
| the command line, and the tables of a case (pydantic) | 150 ms |
| modules of machines, contact, waves, 160 kernels declared | 90 ms |
| the run: 19 000 steps, 500 000 samples of them | 185 ms |
| loading 13 kernels, first touch of memory, first use of everything else | 70 ms |

The first four are the floor of any command that runs a machine, 0.39 s here. The first run after install takes 12 s of a
processor for the run alone, 112 kernels: 4 s of them LLVM's, 8 s numba's own work before it, in Python. The fast engine of the
bands takes as much in a second process.
"""
"""What a process consists of, measured once."""

STIFFNESS, EXPONENT, RESTITUTION, M1, M2, SPEED = 4.7e9, 10 / 9, 0.5, 0.2, 0.459, 20.0


def impacts():
    """One impact: closed form and integrator, per Python call and inside a loop, beside scipy, Exudyn and MuJoCo."""
    chi = float(exact(RESTITUTION))
    contact = Contact(STIFFNESS, EXPONENT, chi)
    closed = solve_impact(contact, M1, M2, SPEED)
    million = Contact(np.full(1_000_000, STIFFNESS), EXPONENT, chi)
    # a cap that is never reached takes the same law to the integrator
    capped = Contact(STIFFNESS, EXPONENT, chi, cap=PressureCap(1e12, "line"))
    laws, ones, record = rows(contact, (2000,)), np.ones(2000), empty_record(1000, pairs.STATES, 1, pairs.MEMORIES)
    stepped, m = np.empty((pairs.ANSWERS, 2000)), M1 * M2 / (M1 + M2)

    def many():
        pairs.impacts(laws, m * ones, SPEED * ones, 0.0 * ones, 1e-8, record, stepped)

    many()

    def rates(_, y):
        d, rate = y[0] - y[1], y[2] - y[3]
        force = max(STIFFNESS * max(d, 0.0) ** EXPONENT * (1 + chi * rate / SPEED), 0.0)
        return [y[2], y[3], -force / M1, force / M2]

    def apart(t, y):
        return y[0] - y[1] if t > 0 else 1.0

    apart.terminal, apart.direction = True, -1
    depth, duration = float(closed.max_indentation), float(closed.duration)
    scale = np.array([depth, depth, SPEED, SPEED])

    def scipy_impact():
        return solve_ivp(
            rates, (0, 2 * duration), [0, 0, SPEED, 0], method="DOP853", rtol=1e-8, atol=1e-8 * scale, events=apart,
            first_step=1e-2 * depth / SPEED, dense_output=True,
        )  # fmt: skip

    solved = scipy_impact()
    end = solved.y[:, -1]
    at = float(closed.peak_time) + np.linspace(-1e-8, 1e-8, 201)
    d, _, rate, _ = solved.sol(at) - np.vstack([solved.sol(at)[1], 0 * at, solved.sol(at)[3], 0 * at])
    force = float(np.max(STIFFNESS * d**EXPONENT * (1 + chi * rate / SPEED)))
    peer = best(scipy_impact)

    def misses(restitution, largest):
        return f"{abs(restitution / RESTITUTION - 1):.0e}", f"{abs(largest / float(closed.peak_force) - 1):.0e}"

    ours = misses(stepped[pairs.RESTITUTION, 0], stepped[pairs.FORCE, 0])
    yielding = solve_impact(capped, M1, M2, SPEED)
    called = misses(float(yielding.restitution), float(yielding.peak_force))
    timed = [
        ("closed form, a million in one call, each", best(lambda: solve_impact(million, M1, M2, SPEED)) / 1e6, None),
        ("closed form, one Python call", best(lambda: solve_impact(contact, M1, M2, SPEED), 50), None),
        ("integrator at 1e-8, inside a compiled loop", best(many) / 2000, ours),
        ("integrator at 1e-8, one Python call", best(lambda: solve_impact(capped, M1, M2, SPEED), 50), called),
        ("scipy solve_ivp DOP853 at 1e-8", peer, misses((end[3] - end[2]) / SPEED, force)),
    ]
    made = [(how, write(t), *(miss or ("exact", "exact")), f"{peer / t:.0f} x") for how, t, miss in timed]
    return made + [(*row, "") for row in peers_bench.rows()]


def laws():
    """Laws that need the integrator, each in a compiled loop at 1e-8: 0.2 kg and 0.459 kg at 5 m/s, 65Mn steel."""
    steel, m = material("65Mn"), M1 * M2 / (M1 + M2)
    ball, roller = hertz(steel, steel, 0.01), palmgren(steel, steel, 0.04)
    line = line_cap(steel, steel, 0.01, np.inf, 0.04, 1.2e9)
    slow = johnson(steel, steel, 0.01, np.inf, 0.04, 0.03)
    cases = {
        "Thornton sphere, 10 mm, 1.2 GPa": ball.contact(cap=point_cap(steel, steel, 0.01, np.inf, 1.2e9)),
        "line on Palmgren's law, 40 mm, 1.2 GPa": roller.contact(cap=line),
        "Johnson's logarithmic law, e = 0.7": slow.contact(exact(0.7)),
        "line on Johnson's law, 1.2 GPa": slow.contact(cap=line),
        "Tsuji's damper, never pulling, e = 0.5": ball.contact(
            damper=damper_law("tsuji-cut-off").function(ball, m, 0.5)
        ),
    }
    ones, made = np.ones(1000), []
    record, out = empty_record(1000, pairs.STATES, 1, pairs.MEMORIES), np.empty((pairs.ANSWERS, 1000))
    for name, contact in cases.items():
        table = rows(contact, (1000,))
        pairs.impacts(table, m * ones, 5.0 * ones, 0.0 * ones, 1e-8, record, out)
        seconds = best(lambda table=table: pairs.impacts(table, m * ones, 5.0 * ones, 0.0 * ones, 1e-8, record, out))
        made.append((name, write(seconds / 1000), f"{out[pairs.RESTITUTION, 0]:.4f}"))
    return made


def processes():
    """Whole processes and the warm run of the published case."""
    case = load_case("li-ma-2019")
    run_case(case)
    struck = load_case("li-ma-2019-fig13")
    run_case(struck)
    stacked = best(lambda: run_case(struck))
    python = sys.executable

    # modules are kept as bytecode, as after any install: to read 250 of them as text takes a quarter of a second
    usual = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}

    def process(*words):
        return best(lambda: subprocess.run([python, *words], check=True, capture_output=True, env=usual), 3)

    run = "-m", "strikewave", "run", "li-ma-2019", "--out"
    with tempfile.TemporaryDirectory() as folder:
        whole, bare = (process(*run, folder, *words) for words in ([], ["--no-band"]))
    answers = process("-m", "strikewave", "run", "li-ma-2019", "--json", "--no-band")
    alone = best(lambda: run_case(case))
    band = best(lambda: run_case(case, band=True)) - alone
    with tempfile.TemporaryDirectory() as folder:  # no kernels yet, as after an install
        empty = {**usual, "NUMBA_CACHE_DIR": folder}
        begun = time.perf_counter()
        subprocess.run([python, *run, f"{folder}/out"], check=True, capture_output=True, env=empty)
        first = time.perf_counter() - begun
    return [
        ("run_case of li-ma-2019, 11 blows, warm", write(alone), "< 0.5 s"),
        ("the bands of its results, 192 fast runs, warm", write(band), "< 0.5 s"),
        ("run_case of li-ma-2019-fig13: 11 blows, stack of 5 layers, sensor, taps", write(stacked), "< 0.5 s"),
        ("whole process, all files, bands", write(whole), "< 2 s"),
        ("the same, first run after install: kernels compile", write(first), "< 10 s"),
        ("whole process, all files, without bands", write(bare), "< 2 s"),
        ("whole process, JSON only, without bands", write(answers), "< 1 s"),
        ("import strikewave", write(process("-c", "import strikewave") - process("-c", "pass")), "< 0.3 s"),
        ("strikewave --help", write(process("-m", "strikewave", "--help")), "< 0.5 s"),
    ]


def processor():
    """Return the processor's name."""
    path = Path("/proc/cpuinfo")
    names = (
        [line.split(":")[1].strip() for line in path.read_text().splitlines() if line.startswith("model name")]
        if path.exists()
        else []
    )
    return names[0] if names else platform.processor()


def main():
    """Run all benchmarks, print them, and write the page."""
    # floor of the closed form: 40 nodes, each one exponential and one power, about 25 ns a node on one core
    nodes = 40
    x = np.random.default_rng(1).random(200_000) + 0.5
    floor = best(lambda: np.expm1(x) ** 0.53) / x.size * nodes
    text = "\n\n".join(
        [
            "# Benchmarks",
            "Written by `make bench`; the shortest of several tries, everything in one run on one machine.",
            f"Machine: {processor()}, {os.cpu_count()} cores; Python {platform.python_version()}, numpy {np.__version__}, "
            f"numba {numba.__version__}.",
            "## One impact",
            "0.2 kg at 20 m/s on 0.459 kg, K = 4.7e9 N/m^(10/9), e = 0.5. Targets: 3 us closed form, 12 us integrator in a "
            "compiled loop, 2 s a million. The times of peers are those of the solve alone; Exudyn and MuJoCo are compiled, and "
            "have contact laws of their own, which are not the one asked for.",
            table(("how", "time", "miss of e", "miss of the largest force", "against scipy"), impacts()),
            f"Floor of the closed form: its duration is a quadrature of {nodes} nodes, each an exponential and a power; numpy needs "
            f"{write(floor)} for as many.",
            "Laws that need the integrator, at 1e-8 in a compiled loop, 0.2 kg and 0.459 kg at 5 m/s:",
            table(("law", "time", "e that comes out"), laws()),
            "## The published machine",
            table(("work", "time", "target"), processes()),
            FLOOR,
            machine_bench.section(),
            studies_bench.section(),
            waves_bench.section(),
            elements_bench.section(),
            records_bench.section(),
            reading_bench.section(),
            app_bench.section(),
            "## Planted blows",
            *planted_judge.section(),
            "## Planted response channels",
            *planted_boards.section(),
            "## Peers",
            "`make bench` installs scipy, pyyeti, endaq, elwaspatid, Exudyn and MuJoCo beside strikewave in `.bench/venv`, in the "
            "versions of benchmarks/requirements.txt, and runs CalculiX where the system has it. One that cannot be run is named.",
            table(("peer", "version"), peers.rows()),
        ]
    )
    print(text)
    PAGE.write_text(text + "\n", "utf-8")


if __name__ == "__main__":
    main()
