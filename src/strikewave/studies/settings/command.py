"""``strikewave settings``: settings of the rotary machine for blows of a peak and a width at an interval."""

from __future__ import annotations

from typing import Annotated

import typer

from strikewave.reporting.terminal import Changes, Force, Json, Out


def command(
    interval: Annotated[
        str, typer.Option("--interval", help='Between blows, such as "20 ms".', show_default=False)
    ] = "",
    peak: Annotated[str, typer.Option("--peak", help='Rigid-body peak, such as "4000 g".', show_default=False)] = "",
    width: Annotated[
        str, typer.Option("--width", help='Of the pulse at 10 % of its peak, such as "200 us".', show_default=False)
    ] = "",
    blows: Annotated[
        int | None, typer.Option("--blows", help="How many; as the case has it by default.", show_default=False)
    ] = None,
    source: Annotated[
        str, typer.Option("--from", metavar="CASE", help="Case with what is not chosen: geometry, materials, stop.")
    ] = "li-ma-2019",
    changes: Changes = None,
    strikers: Annotated[
        list[int] | None,
        typer.Option(
            "--strikers", help="How many on the turntable; repeated. A ladder by default.", show_default=False
        ),
    ] = None,
    striker_mass: Annotated[
        list[str] | None,
        typer.Option(
            "--striker-mass", help="Of one; repeated. Half, once and twice the case's by default.", show_default=False
        ),
    ] = None,
    vary: Annotated[
        str, typer.Option("--vary", help="What gives the width: the stiffness of frame or mount.")
    ] = "frame",
    disc: Annotated[str, typer.Option("--disc", help="Material of the turntable, assumed.")] = "45 steel",
    stop_limit: Annotated[
        str | None, typer.Option("--stop-limit", help="Largest force of the object's stop.", show_default=False)
    ] = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Find settings of the rotary machine for blows of a peak and a width at an interval.

    Every candidate is checked by a full run of all its blows; the first one's case is written. With --json, files are
    written only where --out says. Exit code 3 says that no candidate meets the goal within 5 % and keeps all limits.
    """
    from strikewave.base.materials import material
    from strikewave.cases.case import load_case
    from strikewave.reporting.run_and_write import Output
    from strikewave.studies.settings.candidate import Goal
    from strikewave.studies.settings.screen import SettingsCommand, find_settings
    from strikewave.studies.settings.study import Choice, check_goal

    plain = not (changes or strikers or striker_mass or stop_limit) and blows is None
    plain = plain and (source, vary, disc) == ("li-ma-2019", "frame", "45 steel")
    goal = Goal(
        _quantity(interval, "s", "--interval", "20 ms"),
        _quantity(peak, "m/s^2", "--peak", "4000 g"),
        _quantity(width, "s", "--width", "200 us"),
        material(disc, "--disc"),
        None if stop_limit is None else _quantity(stop_limit, "N", "--stop-limit", "1 kN"),
    )
    masses = tuple(_quantity(text, "kg", "--striker-mass", "1 kg") for text in striker_mass or ())
    choice = Choice(tuple(dict.fromkeys(strikers or ())), tuple(dict.fromkeys(masses)), vary)
    case = load_case(source, [*(changes or ()), *([] if blows is None else [f"feed.blows={blows}"])])
    check_goal(case, goal, choice)
    return find_settings(SettingsCommand(case, goal, choice), Output(out, force, json), plain)


def _quantity(text: str, si: str, field: str, example: str) -> float:
    """Return an option as a number above zero in SI."""
    from strikewave.base.errors import MISSING, InputError
    from strikewave.base.units import DIMENSIONS, parse_quantity

    allowed = f'{DIMENSIONS[si][0]} above zero with its unit, such as "{example}"'
    if not text:
        raise InputError(field, MISSING, allowed, f'add {field} "{example}"')
    value = parse_quantity(text, si, field)
    if not value > 0.0:
        raise InputError(field, text, allowed)
    return value
