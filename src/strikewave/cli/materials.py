"""``strikewave materials``: the table of materials with sources."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

from strikewave.base.json_document import head
from strikewave.base.materials import Material, materials
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.options.output import Show, Shown
from strikewave.reporting.shown_units import showing
from strikewave.reporting.terminal import number, print_json, table, tell


def command(*, show: Show = None, shown: Shown) -> int:
    """List the materials with their sources.

    Elastic constants, yield strength, hardness, loss factor, status and source.
    """
    entries = materials().values()
    if shown.json:
        units = {
            "density": "kg/m^3",
            "youngs_modulus": "Pa",
            "poissons_ratio": "1",
            "yield_strength": "Pa",
            "hardness": "Pa",
            "loss_factor": "1",
        }
        units |= {"bar_speed": "m/s"}
        listed = [{**dataclasses.asdict(m), "bar_speed": m.bar_speed} for m in entries]
        print_json({**head(units), "materials": listed})
        return 0
    with showing(show):
        _print(list(entries))
    return 0


def _print(entries: Sequence[Material]) -> None:
    """Print the table of materials."""
    rows = [
        [
            m.name,
            m.status,
            number(m.density, "kg/m^3", "kg/m^3"),
            number(m.youngs_modulus, "Pa", "GPa"),
            f"{m.poissons_ratio:g}",
            number(m.yield_strength, "Pa", "MPa"),
            number(m.hardness, "Pa", "MPa"),
            "-" if m.loss_factor is None else f"{m.loss_factor:g}",
            number(m.bar_speed, "m/s", "m/s"),
        ]
        for m in entries
    ]
    columns = [
        *keys("name"),
        *texts("status", priority=MORE),
        *numerals("density (kg/m³)", "E (GPa)"),
        *numerals("nu", priority=MORE),
    ]
    columns += [*numerals("yield (MPa)"), *numerals("hardness (MPa)", "loss factor", priority=MORE)]
    columns += numerals("bar speed (m/s)")
    tell(f"{len(rows)} materials; --json has the source of each.")
    table("Materials", columns, rows)
