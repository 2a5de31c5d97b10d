"""``strikewave materials``: the table of materials with sources."""

from __future__ import annotations

import dataclasses

from strikewave.base.json_document import head
from strikewave.base.materials import materials
from strikewave.reporting.layout import MORE, keys, numerals, texts
from strikewave.reporting.options import Shown
from strikewave.reporting.terminal import print_json, significant, table, tell


def command(shown: Shown) -> int:
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
    rows = [
        [
            m.name,
            m.status,
            significant(m.density, 4),
            significant(m.youngs_modulus / 1e9, 4),
            f"{m.poissons_ratio:g}",
            "-" if m.yield_strength is None else significant(m.yield_strength / 1e6, 4),
            "-" if m.hardness is None else significant(m.hardness / 1e6, 4),
            "-" if m.loss_factor is None else f"{m.loss_factor:g}",
            significant(m.bar_speed, 4),
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
    return 0
