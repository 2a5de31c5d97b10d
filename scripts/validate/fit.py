"""Planted fits: cases with values of their own, records with noise, and whether intervals of the fit hold the truth.

    python scripts/validate/fit.py [--each 40] [--twins 10] [--shots 10] [--minutes 60]

Rotary machines, drop tables, pendulum hammers, layered bars and impacts are drawn, each with sizes of its own. Two
values of each are up to 30 % off in the case that is fitted. What is measured is a run of the drawn one: two numbers
with errors of 0.5 to 3 %, or what an ideal recorder writes, with white or coloured noise of as much of the peak. Of the
95 % intervals, 95 % shall hold the truth (one standard deviation of chance: sqrt(0.95 0.05/n)). Of the twins, fields
of which only a combination is felt are fitted too: they shall be named each time, and none of them be called
determined. Of the shots, 1, 2, 5 and 10 records of a drop whose amplitudes scatter by 2 % are fitted at once; that of
one is stated.

What is found is kept in out/validate/planted-fits.jsonl, so that a stopped study goes on; the tables go into
docs/fit.md. An hour of one core.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from kit import ROOT, table, write_into
from scipy.signal import lfilter

from strikewave import FitStudy, fit, load_case
from strikewave.base.errors import StrikewaveError
from strikewave.cases.case import Case
from strikewave.signal.interpolation import resampled
from strikewave.studies.simulation import Simulation

CASES = Path(__file__).parent / "cases"
PAGE = ROOT / "docs" / "fit.md"
KEPT = ROOT / "out" / "validate" / "planted-fits.jsonl"
QUIET = 0.02
"""Noise before the run begins that is recorded too, s: what is known of its colour comes from there."""
MOST_QUIET = 4000
"""Samples of it at most."""
OFF, DRAWN = 0.3, 0.2
"""Logarithm by which values of the fitted case are off at most, and by which drawn machines differ in what is known."""
SCATTER = 0.02
"""Standard deviation of the amplitude of shots."""
NUMBERS = {"first.rigid_peak": "m/s^2", "first.width": "s"}
"""What is stated of a rotary machine; of its twins the first alone."""


@dataclass(frozen=True)
class Kind:
    """Cases of a kind.

    Attributes
    ----------
    case : str
        A built-in case, or a file.
    known : tuple of str
        What drawn ones differ in, known to the fit.
    free : tuple of str
        What is fitted.
    twins : tuple of str
        Fields of which only a combination is felt; those of ``free`` that are none of them are fitted with them.
    rate : float
        Sampling rate of the record, Hz; 0 where numbers are stated.
    part : str
        Of the run.
    settings : tuple of str
        Of the case.
    twin_case : str
        The case of the twins, where it is another one.
    """

    case: str
    known: tuple[str, ...]
    free: tuple[str, ...]
    twins: tuple[str, ...]
    rate: float = 0.0
    part: str = ""
    settings: tuple[str, ...] = ()
    twin_case: str = ""


DEPTH = ("contact.reference_force", "contact.reference_depth")
KINDS = {
    "rotary machines, two numbers": Kind(
        "li-ma-2019",
        ("striker.mass", "striker.mount_stiffness", "object.mass", "object.nose_mass"),
        ("machine.engagement", "object.frame_stiffness"),
        ("machine.engagement", "object.frame_stiffness"),
    ),
    "drop tables": Kind(
        "jesd22-b111-b",
        ("machine.height", "object.mass", "object.frame_damping"),
        ("contact.reference_force", "contact.restitution"),
        DEPTH,
        200e3,
        settings=("contact.restitution=0.7",),
    ),
    "pendulum hammers": Kind(
        "mil-s-901d-hammer",
        ("striker.mass", "striker.mount_stiffness", "object.frame_stiffness"),
        ("object.mass", "contact.restitution"),
        DEPTH,
        200e3,
    ),
    "stacks": Kind(
        "li-ma-2019-fig13-bar",
        ("stack.layer.upper.length", "stack.layer.sensor.length", "stack.layer.lower.length"),
        ("load.peak", "load.duration"),
        ("load.peak", "stack.layer.bar.diameter"),
        5e6,
        "sensor.force",
        ("solver.step=20 ns",),
        "short-bar",
    ),
    "impacts of two bodies": Kind(
        "impact",
        ("machine.speed", "striker.mass", "object.mass"),
        ("contact.reference_force", "contact.restitution"),
        DEPTH,
        5e6,
        "rigid.force",
    ),
}


def opened(name: str, settings: Sequence[str]) -> Case:
    """Return a case: one of the folder beside this program, or a built-in one."""
    own = CASES / f"{name}.toml"
    return load_case(own if own.exists() else name, settings)


def moved(case: Case, fields: Sequence[str], reach: float, rng: np.random.Generator) -> Case:
    """Return a case with other values of some fields: off by a factor, and no more than a share may be."""
    values, changes = case.values(), {}
    for path in fields:
        size = values[path].si * math.exp(rng.uniform(-reach, reach))
        changes[path] = values[path].model_copy(update={"si": min(size, 0.95) if "restitution" in path else size})
    return case.with_values(changes, keep_tolerances=False)


def write_record(path: Path, case: Case, part: str, rate: float, rng: np.random.Generator, scatter: float = 0.0) -> str:
    """Write the record of a run with noise before it and on it; half of them have coloured noise."""
    curve = Simulation(case).history(part)
    ratio = 1.0 / rate / curve.history.step
    places = (np.arange(int((curve.history.values.size - 1) / ratio) - 1) + rng.random()) * ratio
    values = resampled(curve.history.values, places, ratio)
    values = np.concatenate([np.full(min(int(QUIET * rate), MOST_QUIET), values[0]), values])
    colour = rng.choice([0.0, 0.8])
    noise = lfilter([math.sqrt(1.0 - colour**2)], [1.0, -colour], rng.standard_normal(values.size + 100))[100:]
    values = (
        values * (1.0 + scatter * rng.standard_normal()) + rng.uniform(0.005, 0.03) * np.max(np.abs(values)) * noise
    )
    rows = np.column_stack([np.arange(values.size) / rate, values])
    np.savetxt(path, rows, delimiter=",", header=f"time (s),gauge ({curve.unit.replace('^', '')})", comments="")
    return f"{part}={path}" if part else str(path)


def stated(case: Case, names: dict[str, str], rng: np.random.Generator) -> list[str]:
    """Return numbers of a run with errors, and how large these are."""
    run, words = Simulation(case), []
    for name, unit in names.items():
        exact, share = run.number(name), rng.uniform(0.005, 0.03)
        assert exact is not None
        words.append(f"{name}={exact * (1.0 + share * rng.standard_normal())} {unit} +- {100.0 * share} %")
    return words


def planted(kind: Kind, seed: int, folder: Path, twins: bool) -> tuple[Case, FitStudy]:
    """Return a drawn case, and the fit that begins elsewhere; the first seed of which the case can be run is taken."""
    name = kind.twin_case if twins and kind.twin_case else kind.case
    others = [path for path in kind.free if path not in kind.twins and path in opened(name, ()).values()]
    free = [*kind.twins, *others] if twins else list(kind.free)
    for attempt in range(20):
        rng = np.random.default_rng([seed, attempt, twins])
        begun = opened(name, kind.settings if name == kind.case else ())
        begun = moved(begun, [path for path in kind.known if path in begun.values()], DRAWN, rng)
        truth = moved(begun, free, OFF, rng)
        try:
            if kind.rate:
                part = "gauge.stress" if name == "short-bar" else kind.part
                to = [write_record(folder / f"{seed}.csv", truth, part, kind.rate, rng)]
            else:
                to = stated(truth, dict([*NUMBERS.items()][:1]) if twins else NUMBERS, rng)
        except (StrikewaveError, ValueError, AssertionError):  # the strikers miss, or meet the edge of the face
            continue
        return truth, fit(begun, to, free)
    raise ValueError(f"no case of {kind.case} can be run")


def coverage(name: str, seed: int, folder: Path) -> dict[str, Any]:
    """Return how many intervals of a fit hold the truth, and how many values it calls open."""
    truth, study = planted(KINDS[name], seed, folder, twins=False)
    known = [one for one in study.parameters if one.determined]
    held = [one.low <= truth.values()[one.field.path].si <= one.high for one in known]
    return {"held": sum(held), "intervals": len(held), "open": len(study.parameters) - len(known)}


def named(name: str, seed: int, folder: Path) -> dict[str, Any]:
    """Return whether twins are named, they alone, and whether one is called determined."""
    kind = KINDS[name]
    _, study = planted(kind, seed, folder, twins=True)
    false = [one.field.path for one in study.parameters if one.determined and one.field.path in kind.twins]
    return {"alone": study.undetermined == [list(kind.twins)], "false": len(false)}


def shots(records: int, seed: int, folder: Path) -> dict[str, Any]:
    """Return how many intervals of several shots that scatter hold the truth, and their standard errors."""
    kind, rng = KINDS["drop tables"], np.random.default_rng([9000, seed])
    case = opened(kind.case, kind.settings)
    truth = moved(case, kind.free, OFF, rng)
    to = [write_record(folder / f"{k}.csv", truth, kind.part, kind.rate, rng, SCATTER) for k in range(records)]
    told = f" +- {100.0 * SCATTER:g} %" if records == 1 else ""
    study = fit(case, [f"{one}{told}" for one in to], kind.free)
    held = [one.low <= truth.values()[one.field.path].si <= one.high for one in study.parameters]
    return {"held": sum(held), "errors": [one.standard_error / one.value for one in study.parameters]}


Task = tuple[str, Callable[[Path], dict[str, Any]]]


def tasks(each: int, twins: int, most_shots: int) -> Iterator[Task]:
    """Yield key and work of each fit, of all kinds in turn, so that a study that is stopped has some of each."""
    for seed in range(max(each, twins, most_shots)):
        for name in KINDS:
            if seed < each:
                yield f"{name}/{seed}", lambda folder, name=name, seed=seed: coverage(name, seed, folder)
            if seed < twins:
                yield f"{name}/twins/{seed}", lambda folder, name=name, seed=seed: named(name, seed, folder)
        if seed < most_shots:
            for records in (1, 2, 5, 10):
                yield f"shots/{records}/{seed}", lambda folder, n=records, seed=seed: shots(n, seed, folder)


def share_words(held: int, count: int) -> str:
    """Return a share of intervals with one standard deviation of chance about 95 %."""
    chance = 100.0 * math.sqrt(0.95 * 0.05 / max(count, 1))
    return f"{100.0 * held / max(count, 1):.1f} % (95 ± {chance:.1f})"


def planted_table(found: dict[str, dict[str, Any]]) -> str:
    """Return the table of kinds, all of them last."""
    rows, every, both = [], list[dict[str, Any]](), list[dict[str, Any]]()
    for name in [*KINDS, "all"]:
        own = [one for key, one in found.items() if key.startswith(f"{name}/") and "/twins/" not in key]
        two = [one for key, one in found.items() if key.startswith(f"{name}/twins/")]
        every, both = every + own, both + two
        if name == "all":
            own, two = every, both
        held, count = (sum(one[what] for one in own) for what in ("held", "intervals"))
        cells = [str(len(own)), share_words(held, count), str(sum(one["open"] for one in own))]
        cells += [f"{sum(one['alone'] for one in two)} of {len(two)}", str(sum(one["false"] for one in two))]
        rows.append([name, *cells])
    heads = ["planted", "fits", "intervals of 95 % that hold", "called open, yet felt"]
    return table([*heads, "twins named, and they alone", "twins called determined"], rows)


def shot_table(found: dict[str, dict[str, Any]]) -> str:
    """Return the table of shots."""
    rows = []
    for records in (1, 2, 5, 10):
        own = [one for key, one in found.items() if key.startswith(f"shots/{records}/")]
        if own:
            force, loss = 100.0 * np.sqrt(np.mean(np.square([one["errors"] for one in own]), axis=0))
            words = f"{records}, its scatter stated" if records == 1 else str(records)
            held = share_words(sum(one["held"] for one in own), 2 * len(own))
            rows.append([words, str(len(own)), held, f"{force:.2f} %", f"{loss:.2f} %"])
    heads = ["shots", "fits", "intervals of 95 % that hold", "standard error of the stiffness"]
    return table([*heads, "of the restitution"], rows)


def main() -> None:
    """Run the studies that are asked for, print and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--each", type=int, default=40, help="fits of each kind")
    parser.add_argument("--twins", type=int, default=10, help="fits of twins of each kind")
    parser.add_argument("--shots", type=int, default=10, help="fits of each number of shots")
    parser.add_argument("--minutes", type=float, default=math.inf, help="after which no other fit begins")
    asked = parser.parse_args()
    begin, found = time.monotonic(), dict[str, dict[str, Any]]()
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    if KEPT.exists():
        found = dict(json.loads(line) for line in KEPT.read_text("utf-8").splitlines())
    with tempfile.TemporaryDirectory() as folder, KEPT.open("a", encoding="utf-8") as kept:
        for key, work in tasks(asked.each, asked.twins, asked.shots):
            if key in found:
                continue
            if time.monotonic() - begin > 60.0 * asked.minutes:
                break
            found[key] = work(Path(folder))
            print(key, found[key], flush=True)
            kept.write(json.dumps([key, found[key]]) + "\n")
            kept.flush()
    for name, text in (("planted", planted_table(found)), ("shots", shot_table(found))):
        print(f"\n{text}")
        write_into(PAGE, name, text)


if __name__ == "__main__":
    main()
