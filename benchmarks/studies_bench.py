"""Studies: what a run costs beside its own time, two processes against one, and the memory of many runs."""

import os
import subprocess
import sys
import time
from dataclasses import dataclass

import numpy as np
from timing import table, write

from strikewave import load_case
from strikewave.studies.engine.evaluation import Job, KeptHistory, RunOutcome
from strikewave.studies.engine.plan import grid, read_variable, varied
from strikewave.studies.engine.pools import ProcessPool
from strikewave.studies.engine.runner import carry_out
from strikewave.studies.engine.store import RunStore
from strikewave.studies.sweep.study import plan_of

RUNS, FAST, KEPT = 2000, 400, 20_000
"""Runs that compute nothing, fast runs of eleven blows, and runs that keep pulses."""
PULSES, SAMPLES = 11, 200
"""Of a run whose pulses are kept."""
CASE = "li-ma-2019"


@dataclass(frozen=True)
class Nothing:
    """An evaluation that computes nothing, and keeps so many pulses of noise, which no file packs well."""

    pulses: int = 0
    names: tuple[str, ...] = ("speed",)

    def __call__(self, case):
        """Return the speed of the machine, and its pulses."""
        speed = case.machine.speed.si
        noise = np.random.default_rng(int(1e9 * speed))
        kept = [
            KeptHistory("pulse", "m/s^2", k, 0.0, 1e-6, noise.random(SAMPLES).astype(np.float32).astype(float))
            for k in range(self.pulses)
        ]
        return RunOutcome((speed,), tuple(kept))


def study(runs, pulses=0):
    """Make so many runs in this process, and return how long it took, s of a processor."""
    variable = read_variable(load_case(CASE), f"machine.speed=40..90 rad/s:{runs}")
    job = Job(varied(load_case(CASE), [variable], "bench"), Nothing(pulses))
    begun = time.process_time()
    with RunStore(None) as store, ProcessPool(1) as pool:
        carry_out(job, grid([variable]), store, pool)
        disk = sum(path.stat().st_size for path in store.folder.iterdir())
    return time.process_time() - begun, disk


def memory(runs):
    """Return the largest memory of a process that keeps the pulses of so many runs, and the disk that they take."""
    words = f"import studies_bench as s, resource; d = s.study({runs}, s.PULSES)[1]; "
    words += "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, d)"
    found = subprocess.run(
        [sys.executable, "-c", words], cwd=os.path.dirname(__file__), capture_output=True, check=True
    )
    peak, disk = map(int, found.stdout.split())
    return peak * (1 if sys.platform == "darwin" else 1024), disk


def scaling():
    """Return how long some fast runs take on one process and on two, s, once both are ready."""
    plan = plan_of(load_case(CASE), [f"machine.speed=600..800 rpm:{FAST}"], ["cv"], "fast")
    found = []
    for count in (1, 2):
        with ProcessPool(count) as pool:
            with RunStore(None) as store:
                carry_out(plan.job, plan.rows[: 4 * count], store, pool)  # imports and kernels
            with RunStore(None) as store:
                begun = time.perf_counter()
                carry_out(plan.job, plan.rows, store, pool)
                found.append(time.perf_counter() - begun)
    return found


def section():
    """Return the section of the page of benchmarks."""
    alone, _ = study(RUNS)
    one, two = scaling()
    few, many = memory(KEPT // 10), memory(KEPT)
    lines = [
        ("a run that computes nothing, everything about it", write(alone / RUNS), "below 2 ms"),
        (f"{FAST} fast runs of eleven blows, one process", write(one), ""),
        ("the same, two processes", write(two), f"{one / two:.2f} times as fast; 1.8 wanted on two free cores"),
        (f"{KEPT // 10} runs, {PULSES} pulses of {SAMPLES} samples kept", f"{few[0] / 1e6:.0f} MB", "memory at most"),
        (f"{KEPT} of them", f"{many[0] / 1e6:.0f} MB", f"{many[1] / KEPT / 1e3:.1f} kB of disk a run"),
    ]
    return f"""## Studies

{table(("work", "measured", "which is"), lines)}

Ten times the runs took {many[0] / few[0]:.2f} times the memory. 100 000 runs take {many[1] / KEPT * 1e5 / 1e9:.1f} GB of disk."""


if __name__ == "__main__":
    print(section())
