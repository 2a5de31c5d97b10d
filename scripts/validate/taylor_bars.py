"""Bars of 4340 steel and OFHC copper on a rigid wall (Taylor 1948) beside their measured shapes.

Runs every shot with constants from the literature, none chosen by these shots, and writes the tables of
docs/taylor-bars.md and its pictures: final length, diameter of the foot, diameter at 0.2 of the first length, outline.
``--only shots`` (or convergence, causes, pictures) does a part. ``--from-page`` runs nothing: it keeps the comparisons
of the table that the page has.
"""

import argparse
import dataclasses
import re
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
from kit import DATA as MEASURED
from kit import IMAGES, ROOT, Comparison, cells_of, keep, table, write_into
from kit.evidence import LARGE

from strikewave.fem.model import Controls, Model, RigidWall, Symmetry
from strikewave.fem.shapes import cylinder
from strikewave.fem.solids import HeatedSolid, JohnsonCook, ZerilliArmstrong
from strikewave.fem.solve import RunOptions, solve
from strikewave.reporting.style import BLUE, RED, legend_below, new_figure, quiet, save

DATA = MEASURED / "taylor-bars"
PAGE = ROOT / "docs" / "taylor-bars.md"
PROCESSES = 2

COPPER = {"density": 8960.0, "youngs_modulus": 124e9, "poissons_ratio": 0.34}
STEEL = {"density": 7830.0, "youngs_modulus": 200e9, "poissons_ratio": 0.29}
LAWS: dict[str, HeatedSolid] = {
    "copper, Johnson-Cook": JohnsonCook(
        **COPPER, A=90e6, B=292e6, n=0.31, C=0.025, m=1.09, melting_temperature=1356.0, specific_heat=383.0
    ),
    "copper, Zerilli-Armstrong": ZerilliArmstrong(
        **COPPER, C0=65e6, C2=890e6, C3=0.0028, C4=0.000115, specific_heat=383.0
    ),
    "steel, Johnson-Cook": JohnsonCook(
        **STEEL, A=792e6, B=510e6, n=0.26, C=0.014, m=1.03, melting_temperature=1793.0, specific_heat=477.0
    ),
}
"""Constants of Johnson & Cook 1983 and Zerilli & Armstrong 1987; 0.9 of the plastic work is heat."""
SOURCES = {
    "CuZerilli": "copper, Johnson & Cook, Zerilli & Armstrong",
    "CuWilkins": "copper, Wilkins & Guinan",
    "StJohnson": "steel, Johnson & Cook",
    "StGust": "steel, Gust",
}
"""Who measured the shots of each table."""
COLLAPSES = ("StGust", 312.0)
"""Table and speed of the shot left out: the edge of its hot foot is drawn so thin that the steps find no end."""
ACROSS = 14
"""Elements over the diameter of the shots; the table of convergence says what that leaves."""
COARSE = 10
"""The same of the causes: their differences do not wait for the finest mesh."""
STOPS = 2.5
"""Duration over (first less final length) / speed; twice is what an even stop takes, and the flow then rests."""
LEAST = 40e-6
"""Duration at least, s: a short bar swings on after its stop."""
SETTLED = 0.25
"""Share of the run, its end, over which the length is averaged: a bar that flies off still swings by a thousandth."""
AT_REST = 2e-3
"""Largest share of the plastic work that may still be done in that time."""
MEASURES = (("length", "final_length"), ("foot", "foot"), ("bulge", "bulge"))
"""What is compared: of the computed shape, of the shot."""
NAMES = ("length", "foot", "at 0.2 L₀")
"""The same in heads of tables."""


@dataclasses.dataclass(frozen=True)
class Shot:
    """A measured bar; lengths in m, below 0 where not given; ``volume`` is that of its outline over the first."""

    source: str
    density: float
    temperature: float
    speed: float
    length: float
    final_length: float
    diameter: float
    foot: float
    bulge: float
    volume: float

    @property
    def metal(self) -> str:
        """Copper or steel."""
        return "copper" if self.source.startswith("Cu") else "steel"


@dataclasses.dataclass(frozen=True)
class Shape:
    """A computed bar at rest: lengths in m, outline (places, 2) as radius and height over the foot."""

    length: float
    foot: float
    bulge: float
    outline: np.ndarray
    energy_error: float
    hourglass: float


def shots(name: str) -> list[Shot]:
    """Return the shots of a table, three lines each; the columns are told in the README beside it."""
    lines = [list(map(float, line.split())) for line in (DATA / f"{name}.dat").read_text("utf-8").splitlines() if line]
    return [
        Shot(name, *row[1:6], row[8], row[9], row[10], more[3] / more[2])
        for row, more in zip(lines[::3], lines[1::3], strict=True)
    ]


def outline_of(name: str) -> np.ndarray:
    """Return a measured outline, radius and height in mm."""
    return np.loadtxt(DATA / f"{name}.dat")


def bar(solid, shot, across=ACROSS, friction=0.0, full=False, hourglass=0.05) -> Shape:
    """Run a quarter of the bar of a shot against a rigid wall until it rests."""
    size = shot.diameter / across
    mesh = cylinder("bar", shot.diameter, shot.length, size, size, "quarter")
    solid = dataclasses.replace(solid, density=shot.density, preheat=shot.temperature - solid.room_temperature)
    duration = max(STOPS * (shot.length - shot.final_length) / shot.speed, LEAST)
    run = solve(
        Model(
            mesh,
            {"bar": solid},
            Controls(duration, 1e-6, full=("bar",) if full else (), hourglass=hourglass),
            velocity={"bar": (0.0, 0.0, -shot.speed)},
            boundaries=(Symmetry("bar.x-"), Symmetry("bar.y-")),
            walls=(RigidWall("bar.bottom", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), friction),),
        ),
        RunOptions(frames=40),
    )
    begun = round((1.0 - SETTLED) * len(run.time))
    if run.stopped or run.energy["plastic"][-1] > (1.0 + AT_REST) * run.energy["plastic"][begun]:
        raise RuntimeError(f"{shot}: {run.stopped or 'still flows'}")
    foot, top, side = (np.unique(mesh.side(f"bar.{name}")) for name in ("bottom", "top", "round"))
    places = [mesh.points + frame.displacement for frame in run.frames]
    lengths = [place[top, 2].mean() - place[foot, 2].mean() for place in places]
    last = places[-1]
    row = np.unique(np.round(mesh.points[side, 2], 9), return_inverse=True)[1]
    radius = np.bincount(row, np.hypot(*last[side, :2].T)) / np.bincount(row)
    height = np.bincount(row, last[side, 2] - last[foot, 2].mean()) / np.bincount(row)
    internal = run.energy["internal"][-1]
    return Shape(
        length=float(np.mean(lengths[-round(SETTLED * len(lengths)) :])),
        foot=2.0 * float(radius[height < 0.1 * shot.length].max()),
        bulge=2.0 * float(np.interp(0.2 * shot.length, height, radius)),
        outline=np.column_stack([radius, height]),
        energy_error=float(np.abs(run.energy_error).max()),
        hourglass=float(run.energy["hourglass"][-1] / internal),
    )


def percent(computed: float, measured: float) -> str:
    """Return a difference in percent, or a dash where nothing was measured."""
    return "–" if measured <= 0.0 else f"{100.0 * (computed / measured - 1.0):+.1f} %"


def beside(computed: float, measured: float) -> str:
    """Return what was measured, what was computed, in mm, and their difference."""
    if measured <= 0.0:
        return f"– / {1e3 * computed:.2f}"
    return f"{1e3 * measured:.2f} / {1e3 * computed:.2f} ({percent(computed, measured)})"


def apply(job):
    """Run one bar: law, shot, and what else is asked."""
    law, shot, more = job
    return bar(law if isinstance(law, HeatedSolid) else LAWS[law], shot, **more)


def compared(run) -> str:
    """Return the table of all shots that can be judged."""
    chosen = [shot for name in SOURCES for shot in shots(name) if (name, shot.speed) != COLLAPSES]
    jobs = [(law, shot, {}) for shot in chosen for law in LAWS if law.startswith(shot.metal)]
    rows = []
    for (law, shot, _), shape in zip(jobs, run(apply, jobs), strict=True):
        volume = f"{shot.volume:.3f}" if shot.volume > 0.0 else "–"
        bar_words = f"{SOURCES[shot.source]}, {1e3 * shot.length:.1f} × {1e3 * shot.diameter:.2f}"
        row = [bar_words, f"{shot.speed:.0f}", f"{shot.temperature:.0f}", law.partition(", ")[2]]
        rows.append([*row, *(beside(getattr(shape, a), getattr(shot, b)) for a, b in MEASURES), volume])
        print(*rows[-1], f"energy {shape.energy_error:.0e}, hourglass {shape.hourglass:.1%}", flush=True)
    heads = ["Bar, mm", "m/s", "K", "Law", "Length", "Foot, across", "At 0.2 L₀, across", "Volume of the outline"]
    return table(heads, rows)


def limit(values: list[float], ratio: float) -> tuple[str, float]:
    """Return the order that three values show, a dash where they are not monotonic, and their limit by the first order.

    The edge of the foot is a corner: no higher order is taken for granted.
    """
    first, second = values[1] - values[0], values[2] - values[1]
    order = f"{np.log(first / second) / np.log(ratio) + 0.0:.1f}" if first * second > 0.0 else "–"
    return order.removeprefix("-") if order == "-0.0" else order, values[2] + second / (ratio - 1.0)


def converged(run) -> str:
    """Return the table of meshes: three with one point, one with full integration."""
    chosen = [("StJohnson", 0, "steel, Johnson-Cook"), ("StJohnson", 2, "steel, Johnson-Cook")]
    chosen += [("CuZerilli", 2, "copper, Johnson-Cook")]
    meshes = [{"across": COARSE}, {"across": ACROSS}, {"across": 2 * COARSE}, {"across": COARSE, "full": True}]
    jobs = [(law, shots(name)[k], mesh) for name, k, law in chosen for mesh in meshes]
    shapes = list(run(apply, jobs))
    rows = []
    for k, (table_name, row, law) in enumerate(chosen):
        shot, found = shots(table_name)[row], shapes[k * len(meshes) : (k + 1) * len(meshes)]
        for name, (key, _) in zip(NAMES, MEASURES, strict=True):
            values = [getattr(shape, key) for shape in found]
            order, end = limit(values[:3], 2.0**0.5)
            cells = [f"{1e3 * value:.3f}" for value in values]
            rows.append([f"{law}, {shot.speed:.0f} m/s", name, *cells[:3], order, f"{1e3 * end:.3f}"])
            rows[-1] += [percent(values[1], end), *cells[3:]]
            print(*rows[-1], flush=True)
    heads = ["Bar", "mm", "D₀/10", "D₀/14", "D₀/20", "order", "limit", "D₀/14 off", "full, D₀/10"]
    return table(heads, rows)


def caused(run) -> str:
    """Return the table of causes: what each change alone does to two shots of copper."""
    cook, zerilli = LAWS["copper, Johnson-Cook"], LAWS["copper, Zerilli-Armstrong"]
    change = dataclasses.replace
    changes = [
        ("Johnson-Cook as published, one point, no friction", cook, {}),
        ("elements half as large", cook, {"across": 2 * COARSE}),
        ("full integration", cook, {"full": True}),
        ("hourglass coefficient 0.01", cook, {"hourglass": 0.01}),
        ("friction 0.05 on the wall", cook, {"friction": 0.05}),
        ("friction 0.1", cook, {"friction": 0.1}),
        ("friction 0.2", cook, {"friction": 0.2}),
        ("no heat (isothermal)", change(cook, specific_heat=np.inf), {}),
        ("all plastic work is heat", change(cook, heat_fraction=1.0), {}),
        ("no rate: C = 0", change(cook, C=0.0), {}),
        ("A 60 MPa instead of 90", change(cook, A=60e6), {}),
        ("n 0.5 instead of 0.31", change(cook, n=0.5), {}),
        ("Zerilli-Armstrong as published", zerilli, {}),
        ("Zerilli-Armstrong, full integration", zerilli, {"full": True}),
        ("Zerilli-Armstrong, friction 0.05", zerilli, {"friction": 0.05}),
        ("Zerilli-Armstrong, friction 0.1", zerilli, {"friction": 0.1}),
        ("Zerilli-Armstrong, no heat", change(zerilli, specific_heat=np.inf), {}),
    ]
    chosen = [shots("CuZerilli")[0], shots("CuZerilli")[2]]
    jobs = [(law, shot, {"across": COARSE, **more}) for _, law, more in changes for shot in chosen]
    shapes = iter(run(apply, jobs))
    rows = []
    for name, _, _ in changes:
        row = [name]
        for shot in chosen:
            shape = next(shapes)
            row += [percent(getattr(shape, a), getattr(shot, b)) for a, b in MEASURES]
        rows.append(row)
        print(*row, flush=True)
    return table(["Changed alone", *(f"{name}, {s.speed:.0f} m/s" for s in chosen for name in NAMES)], rows)


def pictured(run) -> str:
    """Draw the measured outlines beside the computed ones; return nothing for the page."""
    chosen = [("taylorCuJohnsonCook130", "CuZerilli", 0), ("taylorCuJohnsonCook146", "CuZerilli", 1)]
    chosen += [(f"taylorStJohnsonCook{speed}", "StJohnson", k) for k, speed in enumerate((208, 282, 343))]
    lines = {
        "copper": [
            ("Johnson-Cook", "copper, Johnson-Cook", {}),
            ("Zerilli-Armstrong", "copper, Zerilli-Armstrong", {}),
            ("Zerilli-Armstrong, friction 0.1", "copper, Zerilli-Armstrong", {"friction": 0.1}),
        ],
        "steel": [
            ("Johnson-Cook", "steel, Johnson-Cook", {}),
            ("Johnson-Cook, friction 0.1", "steel, Johnson-Cook", {"friction": 0.1}),
        ],
    }
    styles = {
        "Johnson-Cook": {"color": BLUE},
        "Zerilli-Armstrong": {"color": RED},
        "Zerilli-Armstrong, friction 0.1": {"color": RED, "linestyle": ":"},
        "Johnson-Cook, friction 0.1": {"color": BLUE, "linestyle": ":"},
    }
    jobs = [(law, shots(name)[k], more) for _, name, k in chosen for _, law, more in lines[shots(name)[k].metal]]
    shapes = iter(run(apply, jobs))
    figure = new_figure((10.0, 4.6))
    panels = figure.subplots(1, len(chosen), sharex=True, sharey=True)
    for axes, (measured, name, k) in zip(panels, chosen, strict=True):
        shot = shots(name)[k]
        radius, height = outline_of(measured).T
        on = radius > 0.0
        for label, *_ in lines[shot.metal]:
            axes.plot(*(1e3 * next(shapes).outline.T), label=label, **styles[label])
        axes.plot(radius[on], height[on], "o", color="black", markersize=3, label="measured")
        if shot.foot > 0.0:
            axes.plot([5e2 * shot.foot], [0.0], "x", color="black", label="measured, table")
        quiet(axes, f"{shot.metal}, {shot.speed:.0f} m/s", "radius (mm)", "height (mm)" if axes is panels[0] else "")
        axes.set_xlim(3.0, 6.5)
    legend_below(figure)
    IMAGES.mkdir(exist_ok=True)
    save(figure, IMAGES / "taylor-bars.svg")
    return ""


HOT = 1000.0
"""Temperature above which 4340 steel is austenite, K."""
WHY_HOT = (
    "the steel is austenite at this temperature, which constants of the cold steel do not know. No published constants "
    "of austenite at these rates are at hand: until there are, such a run is no prediction to rely on"
)
WHY_FOOT = (
    "friction on the wall, the law and the temper of the copper all move the foot by as much, and no source reports "
    "the first and the last ([causes](taylor-bars.md#why-copper-misses)). A shot with a measured friction would decide"
)
NAMED = ("final length", "diameter of the foot", "diameter at 0.2 L₀")
"""What is compared, in the order of the columns."""


def comparisons(cells: list[list[str]]) -> list[Comparison]:
    """Return what the rows of the table compare; lengths in mm."""
    rows = []
    for bar_words, speed, temperature, law, *measures, _ in cells:
        what = f"{bar_words} mm, {speed} m/s, {temperature} K, {law}"
        for quantity, cell in zip(NAMED, measures, strict=True):
            found = re.fullmatch(r"([\d.]+) / ([\d.]+) \(.*\)", cell)
            if found is None:
                continue  # not measured
            measured, computed = map(float, found.groups())
            large = abs(computed / measured - 1.0) > LARGE
            note = (WHY_HOT if float(temperature) > HOT else WHY_FOOT) if large else ""
            rows.append(Comparison(what, quantity, "measured", "predicted", measured, computed, "mm", note=note))
    return rows


PARTS = {"shots": compared, "convergence": converged, "causes": caused, "pictures": pictured}


def main() -> None:
    """Run the parts that are asked for, all by default, and write what they give into the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=PARTS, action="append")
    parser.add_argument("--from-page", action="store_true", help="keep the comparisons of the page, run nothing")
    words = parser.parse_args()
    asked = [] if words.from_page else words.only or list(PARTS)
    with ProcessPoolExecutor(PROCESSES, get_context("spawn")) as pool:
        for name in asked:
            text = PARTS[name](pool.map)
            if text:
                write_into(PAGE, name, text)
    if words.from_page or "shots" in asked:
        keep("taylor", comparisons(cells_of(PAGE, "shots")), words.from_page)


if __name__ == "__main__":
    main()
