"""``strikewave settings``: settings of the rotary machine for blows of a peak and a width at an interval."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from strikewave.reporting.options import Changes, Output, complete_case, quantity
from strikewave.studies.settings.defaults import DISC, REFERENCE, STIFFNESS


def command(
    *,
    interval: Annotated[float, quantity("--interval", si="s", bare=False, help='Time between blows, such as "20 ms".')],
    peak: Annotated[
        float, quantity("--peak", si="m/s^2", bare=False, help='Rigid-body peak acceleration, such as "4000 g".')
    ],
    width: Annotated[
        float, quantity("--width", si="s", bare=False, help='Pulse width at 10 % of the peak, such as "200 us".')
    ],
    blows: Annotated[
        int | None,
        typer.Option(
            "--blows", metavar="COUNT", help="Number of blows; that of the case by default.", show_default=False
        ),
    ] = None,
    source: Annotated[
        str,
        typer.Option(
            "--from",
            metavar="CASE",
            help="Case that gives what is not chosen: geometry, materials, stop.",
            autocompletion=complete_case,
        ),
    ] = REFERENCE,
    changes: Changes = None,
    strikers: Annotated[
        list[int] | None,
        typer.Option(
            "--strikers",
            metavar="COUNT",
            help="Number of strikers on the turntable; 1, 2, 3, 4, 6, 8 and 12 by default; may be repeated.",
            show_default=False,
        ),
    ] = None,
    striker_mass: Annotated[
        list[float] | None,
        quantity(
            "--striker-mass",
            si="kg",
            bare=False,
            help="Mass of one striker; half, once and twice that of the case by default; may be repeated.",
        ),
    ] = None,
    vary: Annotated[
        Literal["frame", "mount"],
        typer.Option("--vary", help="Stiffness that sets the pulse width: of the frame, or of the striker's mount."),
    ] = STIFFNESS,
    disc: Annotated[str, typer.Option("--disc", metavar="MATERIAL", help="Material assumed for the turntable.")] = DISC,
    stop_limit: Annotated[
        float | None,
        quantity(
            "--stop-limit", si="N", bare=False, help="Largest allowed force of the object's stop; no limit by default."
        ),
    ] = None,
    output: Output,
) -> int:
    """Find machine settings for wanted blows.

    For the rotary machine: settings for blows of a wanted peak and width at a wanted interval. Every candidate is
    checked by a full run of all its blows; the best one is written as case.toml. With --json, no files
    are written unless --out is given. The exit code is 3 where no candidate meets the goal within 5 % and keeps all
    limits.
    """
    from strikewave.base.materials import material
    from strikewave.cases.case import load_case
    from strikewave.studies.settings.candidate import BlowGoal
    from strikewave.studies.settings.screen import SettingsCommand, find_settings
    from strikewave.studies.settings.study import SettingsChoices, check_changes, check_goal

    plain = not (changes or strikers or striker_mass or stop_limit) and blows is None
    plain = plain and (source, vary, disc) == (REFERENCE, STIFFNESS, DISC)
    goal = BlowGoal(interval, peak, width, material(disc, "--disc"), stop_limit)
    choice = SettingsChoices(tuple(dict.fromkeys(strikers or ())), tuple(dict.fromkeys(striker_mass or ())), vary)
    check_changes(changes or (), vary)
    case = load_case(source, [*(changes or ()), *([] if blows is None else [f"feed.blows={blows}"])])
    check_goal(case, goal, choice)
    return find_settings(SettingsCommand(output.tested(case), goal, choice), output, plain)
