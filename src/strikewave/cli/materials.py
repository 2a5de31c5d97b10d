"""``strikewave materials``: the table of materials with sources."""

from __future__ import annotations

from strikewave.base import declare
from strikewave.base.json_document import head
from strikewave.base.materials import Material, materials
from strikewave.reporting.options.output import Show, Shown
from strikewave.reporting.shown_units import showing
from strikewave.reporting.terminal import print_json, print_rows, tell


@declare.dataclass
class MaterialList:
    """All materials."""

    materials: list[Material] = declare.rows(Material, "the materials")


def command(*, show: Show = None, shown: Shown) -> int:
    """List the materials with their sources.

    Elastic constants, yield strength, hardness, loss factor, status and source.
    """
    from strikewave.reporting.faces import columns_of

    listed = MaterialList(list(materials().values()))
    if shown.json:
        print_json({**head(declare.units(MaterialList)), **declare.content(listed)})
        return 0
    with showing(show):
        tell(f"{len(listed.materials)} materials; --json has the source of each.")
        print_rows("Materials", columns_of(Material, listed.materials))
    return 0
