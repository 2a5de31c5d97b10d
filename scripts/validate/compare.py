"""Comparisons whose outcome is known: blows of a campaign against the others, and runs against themselves, changed.

Writes out/validate/compare.csv; docs/compare.md has the numbers. Half a minute.
"""

import csv
import tempfile
from pathlib import Path

import numpy as np
from kit import DATA, unpacked

from strikewave import compare, load_case, run_case, run_wave
from strikewave.base.constants import STANDARD_GRAVITY

CHANGES = {
    "as it is": lambda time, values: (time, values),
    "peak x 1.1": lambda time, values: (time, 1.1 * values),
    "5 us later": lambda time, values: (time + 5e-6, values),
    "time x 1.05": lambda time, values: (1.05 * time, values),
    "every 5 us on lines": lambda time, values: (
        grid := np.arange(time[0], time[-1], 5e-6),
        np.interp(grid, time, values),
    ),
    "noise of 2 % of the peak": lambda time, values: (
        time,
        values + 0.02 * np.abs(values).max() * np.random.default_rng(1).normal(size=values.size),
    ),
}


def written(path, time, values):
    """Write a history as a text file, with rest before and after it, and return its name."""
    step = float(time[1] - time[0])
    rest = np.zeros(time.size // 2)
    values = np.concatenate([rest, values, rest])
    table = np.column_stack([time[0] + step * (np.arange(values.size) - rest.size), values / STANDARD_GRAVITY])
    np.savetxt(path, table, delimiter=",", header="time (s),acceleration (g)", comments="", fmt="%.10g")
    return str(path)


def row(what, found):
    """Return a line of the table."""
    difference = {name: pair.difference for name, pair in found.figures.items()}
    return {
        "what": what,
        **{name: f"{100.0 * difference[name]:+.2f} %" for name in ("peak", "width", "velocity_change")},
        "shift (us)": f"{found.agreement.shift.shift * 1e6:.3f} +- {found.agreement.shift.uncertainty * 1e6:.3f}",
        "rms": f"{100.0 * found.agreement.rms:.2f} %",
        "srs (dB)": f"{found.values['srs']:.2f}",
        **{
            f"iso {name}": f"{value:.3f}" for name, value in found.agreement.rating._asdict().items() if name != "delay"
        },
        "inside": f"{100.0 * found.values['inside']:.1f} %",
    }


def campaign(folder):
    """Yield each good blow against the corridor of the others."""
    files = [path for path in unpacked(DATA / "smd-5kg-impacts", folder) if path.suffix == ".lvm"]
    files = [path for path in files if path.stem not in ("impact_00", "impact_01")]
    for left in files:
        left.rename(folder / "left.txt")
        yield row(
            f"{left.stem} against {len(files) - 1} others",
            compare(folder / "impact_*.lvm", folder / "left.txt", unit="g"),
        )
        (folder / "left.txt").rename(left)


def changed(name, time, values, folder):
    """Yield a history against itself with each change."""
    keep = np.isfinite(values)
    time, values = time[keep], values[keep]
    reference = written(folder / "a.csv", time, values)
    for what, change in CHANGES.items():
        found = compare(reference, written(folder / "b.csv", *change(time, values)))
        yield row(f"{name}, {what}", found)


def rows(folder):
    """Yield all lines."""
    yield from campaign(folder)
    arrays = run_case(load_case("li-ma-2019")).arrays
    yield from changed("li-ma-2019", arrays["pulse_time"].values, arrays["pulse_acceleration"].values[0], folder)
    bar = run_wave(load_case("togami-1996-bar"))
    yield from changed("togami-1996-bar", bar.run.time, bar.run.acceleration[:, 0], folder)


def main():
    """Print and write the table."""
    out = Path("out/validate")
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, (out / "compare.csv").open("w", newline="") as file:
        writer = None
        for line in rows(Path(folder)):
            print(" | ".join(line.values()), flush=True)
            if writer is None:
                writer = csv.DictWriter(file, line)
                writer.writeheader()
            writer.writerow(line)


if __name__ == "__main__":
    main()
