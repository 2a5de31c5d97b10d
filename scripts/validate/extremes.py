"""Random cases at the edge of what is valid: a balance closes, or a refusal names the field; nothing hangs or breaks.

A case of an analysis is a built-in one with up to four of its quantities a thousand times smaller or larger, drawn anew
until it is valid: each draw that is not must be refused by a line that names its field. An impact, a spectrum and a
record have all of theirs drawn, over many powers of ten. `--each` of them (500), `--only` some
analyses, `--minutes` ends an analysis earlier. Each fate is one of

- closed: energy and momentum balance, or what closed forms say of the numbers;
- reported: a result that says itself which check failed, and exits with 3;
- refused: a valid case that is not run: one line names a field, or where its motion could not be followed and what to
  change;
- long: more than 10 s of a processor, which ends it here; a user sees its progress, and can stop it;
- wrong or broke, which there must not be.

Prints a table; with `--write`, its rows go into that of docs/faults.md.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import math
import multiprocessing
import os
import sys
import time
import warnings
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
from kit import ROOT, renewed, table, write_into

from strikewave import load_case, run_case, run_fem, run_wave
from strikewave.analyses.by_tables import check_case
from strikewave.base.errors import StrikewaveError
from strikewave.base.result import BALANCE_LIMIT, Result
from strikewave.cases.case import Case
from strikewave.contact import Contact, exact, solve_impact
from strikewave.records.measuring import find_pulses
from strikewave.signal.srs import srs

PAGE, TABLE = ROOT / "docs/faults.md", "random cases"
SEED = 2027
PATIENCE, STILL = 10.0, 900.0
"""Seconds of a processor after which a case is taken to hang, twenty times what the usual one takes; and seconds of
any kind, for one that waits."""
COMPILING, IMPORTING = 120.0, 15.0
"""Seconds of a processor more for the first case of an analysis, which compiles, and of a process, which imports."""
DECADES = 3.0
"""Powers of ten by which a quantity of a case is moved at most."""
MACHINES = (
    "li-ma-2019",
    "li-ma-2019-fig5",
    "iso-16063-22-dropball",
    "jesd22-b111-b",
    "mil-s-901d-hammer",
    "machete-13-teeth",
    "en-166-ball",
    "rodgers-2009-amplifier",
    "dual-mass-amplifier",
)
BARS = ("li-ma-2019-fig13-bar", "togami-1996-bar")
BLOCK = ROOT / "scripts/validate/cases/block.toml"
"""A block on a wall: a mesh of 40 elements."""


def moved(name: str, chance: np.random.Generator, *more: str) -> Case:
    """Return a valid case with up to four of its quantities moved, but for those of recorder and solver."""
    values = {
        path: value.si
        for path, value in load_case(name, more).values().items()
        if path.split(".")[0] not in ("recorder", "solver") and value.si
    }
    while True:
        chosen = chance.choice(list(values), size=min(len(values), int(chance.integers(1, 5))), replace=False)
        changes = [f"{path}={values[path] * 10.0 ** chance.uniform(-DECADES, DECADES)!r}" for path in chosen]
        try:
            case = load_case(name, [*more, *changes])
            check_case(case)
            return case
        except StrikewaveError as error:
            if ":" not in str(error):
                raise AssertionError(f"no field is named: {error}") from error


def fate_of(result: Result, balance: dict[str, float]) -> str:
    """Return what became of a result with balances."""
    if result.broken:
        return "reported"
    return "closed" if all(abs(error) <= BALANCE_LIMIT for error in balance.values()) else f"wrong: {balance}"


def machine(chance: np.random.Generator) -> str:
    """Run a machine."""
    name = str(chance.choice(MACHINES))
    blows = ["feed.blows=2"] if load_case(name).feed is not None else []
    result = run_case(moved(name, chance, *blows))
    return fate_of(result, result.balance)


def wave(chance: np.random.Generator) -> str:
    """Run a layered bar."""
    name = str(chance.choice(BARS))
    result = run_wave(moved(name, chance))
    return fate_of(result, result.balance)


def fem(chance: np.random.Generator) -> str:
    """Run a block of elements onto a wall; its balances have limits of their own, which its checks hold."""
    result = run_fem(moved(str(BLOCK), chance))
    return fate_of(result, {})


def impact(chance: np.random.Generator) -> str:
    """Solve an impact: the energy that is lost is that of the restitution, and no force is without an indentation."""
    exponent, restitution = chance.uniform(1.0, 2.0), chance.uniform(0.01, 1.0)
    stiffness, mass1, mass2 = 10.0 ** chance.uniform([0, -9, -9], [14, 6, 6])
    speed = 10.0 ** chance.uniform(-6, 4)
    answer = solve_impact(Contact(stiffness, exponent, float(exact(restitution))), mass1, mass2, speed)
    energy = 0.5 * mass1 * mass2 / (mass1 + mass2) * speed**2
    lost = float(answer.energy_lost) / energy
    closes = math.isclose(lost, 1.0 - restitution**2, rel_tol=0.0, abs_tol=1e-9)
    sizes = [float(answer.peak_force), float(answer.max_indentation), float(answer.duration)]
    return "closed" if closes and all(0.0 < size < math.inf for size in sizes) else f"wrong: {lost} {sizes}"


def half_sine(chance: np.random.Generator) -> tuple[np.ndarray, float, float, float]:
    """Return a record of a half-sine, its step (s), peak (m/s^2) and duration (s), over many powers of ten."""
    peak, width = 10.0 ** chance.uniform([-6, -7], [9, 1])
    step = width / chance.integers(50, 500)
    time = step * np.arange(int(12 * width / step))
    return (
        np.where((time > 3 * width) & (time < 4 * width), peak * np.sin(np.pi * (time / width - 3.0)), 0.0),
        step,
        peak,
        width,
    )


def spectrum(chance: np.random.Generator) -> str:
    """Take a shock spectrum: it grows with the record, to the bit of a power of two, and ends at the peak."""
    values, step, peak, width = half_sine(chance)
    frequencies = np.geomspace(0.01, 25.0, 12) / width / 2.0
    q = 10.0 ** chance.uniform(-0.3, 3.0)
    found, larger = (srs(times * values, step, frequencies, q).maximax for times in (1.0, 1024.0))
    alike = np.allclose(larger, 1024.0 * found, rtol=1e-12, atol=0.0)
    # a stiff resonator follows the base: 12.5 periods in a half-sine leave at most 4 % of dynamic amplification
    ends = abs(found[-1] / peak - 1.0) < 0.05
    return "closed" if alike and ends and np.all(found >= 0.0) else f"wrong: {found} {larger} {peak}"


def record(chance: np.random.Generator) -> str:
    """Find a half-sine in a record with an offset and noise of a thousandth: peak and velocity change to 1 %."""
    values, step, peak, width = half_sine(chance)
    values = values + peak * (chance.normal(scale=1e-3, size=values.size) + chance.uniform(-1.0, 1.0))
    pulses = find_pulses(values, step)
    if len(pulses) != 1:
        return f"wrong: {len(pulses)} pulses"
    change = 2.0 / math.pi * peak * width
    closes = abs(pulses[0].peak / peak - 1.0) < 0.01 and abs(pulses[0].velocity_change / change - 1.0) < 0.01
    return "closed" if closes else f"wrong: {pulses[0]} of {peak} {change}"


ANALYSES: dict[str, Callable[[np.random.Generator], str]] = {
    "run": machine,
    "wave": wave,
    "fem": fem,
    "impact": impact,
    "srs": spectrum,
    "record": record,
}
ENDED = "broke: the process ended"
FATES = ("closed", "reported", "refused", "wrong", "broke", "long")


def fate(analysis: str, k: int) -> str:
    """Return what became of the k-th case of an analysis."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ANALYSES[analysis](np.random.default_rng([SEED, k, *analysis.encode()]))
    except StrikewaveError as error:
        words = str(error)
        named = isinstance(error, RuntimeError) or ":" in words
        return f"refused: {words}" if named else f"wrong: no field is named: {words}"
    except Exception as error:
        return f"broke: {type(error).__name__}: {error}"


def work(pipe: Connection) -> None:
    """Answer with the fate of each case that is asked for."""
    while True:
        pipe.send(fate(*pipe.recv()))


class Worker:
    """A process that makes cases, and is replaced where one hangs; its first case has some seconds more."""

    def __init__(self, more: float) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, far = context.Pipe()
        self.process = context.Process(target=work, args=(far,), daemon=True)
        self.process.start()
        far.close()
        self.more = more

    def ask(self, analysis: str, k: int) -> str | None:
        """Return the fate of a case, or None where it hangs, or ended the process."""
        until = self.spent() + PATIENCE + self.more
        latest = time.monotonic() + STILL
        self.more = 0.0
        self.pipe.send((analysis, k))
        try:
            while not self.pipe.poll(1.0):
                if self.spent() > until or time.monotonic() > latest:
                    return None
            return str(self.pipe.recv())
        except EOFError:
            return ENDED

    def spent(self) -> float:
        """Return the seconds of a processor that the process has had; 0 where the system does not tell."""
        with contextlib.suppress(OSError):
            fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
            return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        return 0.0

    def end(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.join()


def main() -> int:
    """Make the cases and print the table; return how many were wrong."""
    parser = argparse.ArgumentParser(description="random cases at the edge of what is valid")
    parser.add_argument("--each", type=int, default=500, help="cases of an analysis")
    parser.add_argument("--minutes", type=float, default=math.inf, help="of an analysis at most")
    parser.add_argument("--only", action="append", choices=ANALYSES, help="one analysis; may be repeated")
    parser.add_argument("--write", action="store_true", help="the table into docs/faults.md")
    asked = parser.parse_args()
    rows, bad = [], 0
    for analysis in asked.only or ANALYSES:
        worker = Worker(COMPILING)
        counts: collections.Counter[str] = collections.Counter()
        end = time.monotonic() + 60.0 * asked.minutes
        for k in range(asked.each):
            if time.monotonic() > end:
                break
            found = worker.ask(analysis, k)
            if found in (None, ENDED):
                worker.end()
                worker = Worker(IMPORTING)
            word, _, what = (found or "long").partition(":")
            counts[word] += 1
            if word not in FATES[:3]:
                print(f"{analysis} {k}: {word}{what}", flush=True)
        worker.end()
        rows.append([f"`{analysis}`", *(str(counts[word]) for word in FATES)])
        bad += sum(counts[word] for word in FATES[3:5])
    heads = ("Analysis", *FATES)
    print(table(heads, rows))
    if asked.write:
        write_into(PAGE, TABLE, table(heads, renewed(PAGE, TABLE, rows)))
    return bad


if __name__ == "__main__":
    sys.exit(bool(main()))
