"""``strikewave settings``: settings of a rotary machine, or a drop table, for a pulse or a specification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from strikewave.base.constants import material
from strikewave.base.errors import InputError
from strikewave.reporting.measured_files import complete_specification
from strikewave.reporting.options import Changes, Running, complete_case, quantity
from strikewave.reporting.output_options import StudyOutput
from strikewave.studies.search import DISC, DROP_TABLE, REFERENCE, STIFFNESS

if TYPE_CHECKING:
    from strikewave.studies.search.drop_table import DropChoices


@dataclass(frozen=True)
class DropOptions:
    """Options of a drop table: programmers, pads and masses to try, and the largest drop height."""

    panel: ClassVar[str] = "Drop table (with --spec)"

    programmer: Annotated[
        list[str] | None,
        typer.Option(
            "--programmer",
            metavar="NAME[,KEY=VALUE]",
            help=(
                "Programmer: linear, a cushion law or a material, such as 'felt, stress=20 MPa, exponent=2.5, "
                "retardation=20 us'; linear, two rubbers and a felt by default; may be repeated."
            ),
            show_default=False,
        ),
    ] = None
    diameter: Annotated[
        list[float] | None,
        quantity(
            "--diameter",
            si="m",
            bare=False,
            help="Diameter of a pad; 50, 75, 100, 150, 200 and 300 mm by default; may be repeated.",
        ),
    ] = None
    table_mass: Annotated[
        list[float] | None,
        quantity(
            "--table-mass",
            si="kg",
            bare=False,
            help="Mass of the table with its load; that of the case by default; may be repeated.",
        ),
    ] = None
    stroke: Annotated[
        float | None, quantity("--stroke", si="m", bare=False, help="Largest drop height; 2 m by default.")
    ] = None

    def given(self) -> dict[str, object]:
        """Return the options that were given, by name."""
        named = {
            "--programmer": self.programmer,
            "--diameter": self.diameter,
            "--table-mass": self.table_mass,
            "--stroke": self.stroke,
        }
        return {option: value for option, value in named.items() if value}

    def choices(self) -> DropChoices:
        """Return what is tried."""
        from strikewave.studies.search.drop_table import DropChoices
        from strikewave.studies.search.programmers import read_programmer

        programmers = tuple(read_programmer(word) for word in dict.fromkeys(self.programmer or ()))
        sizes, masses = (tuple(dict.fromkeys(map(float, one or ()))) for one in (self.diameter, self.table_mass))
        return DropChoices(programmers, sizes, masses)


@dataclass(frozen=True)
class BlowOptions:
    """Wanted blows of the rotary machine, SI."""

    interval: Annotated[
        float | None,
        quantity("--interval", si="s", bare=False, help='Time between blows, such as "20 ms"; needed without --spec.'),
    ] = None
    peak: Annotated[
        float | None,
        quantity(
            "--peak",
            si="m/s^2",
            bare=False,
            help='Rigid-body peak acceleration, such as "4000 g"; needed without --spec.',
        ),
    ] = None
    width: Annotated[
        float | None,
        quantity(
            "--width",
            si="s",
            bare=False,
            help='Pulse width at 10 % of the peak, such as "200 us"; needed without --spec.',
        ),
    ] = None
    blows: Annotated[
        int | None,
        typer.Option(
            "--blows", metavar="COUNT", help="Number of blows; that of the case by default.", show_default=False
        ),
    ] = None
    stop_limit: Annotated[
        float | None,
        quantity(
            "--stop-limit", si="N", bare=False, help="Largest allowed force of the object's stop; no limit by default."
        ),
    ] = None


@dataclass(frozen=True)
class RotaryOptions:
    """Values that are tried of the rotary machine."""

    strikers: Annotated[
        list[int] | None,
        typer.Option(
            "--strikers",
            metavar="COUNT",
            help="Number of strikers on the turntable; 1, 2, 3, 4, 6, 8 and 12 by default; may be repeated.",
            show_default=False,
        ),
    ] = None
    striker_mass: Annotated[
        list[float] | None,
        quantity(
            "--striker-mass",
            si="kg",
            bare=False,
            help="Mass of one striker; half, once and twice that of the case by default; may be repeated.",
        ),
    ] = None
    vary: Annotated[
        Literal["frame", "mount"],
        typer.Option("--vary", help="Stiffness that sets the pulse width: of the frame, or of the striker's mount."),
    ] = STIFFNESS
    disc: Annotated[str, typer.Option("--disc", metavar="MATERIAL", help="Material assumed for the turntable.")] = DISC


def command(
    *,
    spec: Annotated[
        str | None,
        typer.Option(
            "--spec",
            metavar="NAME|FILE[:CONDITION]",
            help="Specification to design to, see strikewave spec list; none by default.",
            show_default=False,
            autocompletion=complete_specification,
        ),
    ] = None,
    source: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="CASE",
            help="Case that gives what is not chosen; li-ma-2019 by default, with --spec a drop table, jesd22-b111-b.",
            show_default=False,
            autocompletion=complete_case,
        ),
    ] = None,
    changes: Changes = None,
    wanted: BlowOptions,
    rotary: RotaryOptions,
    drop: DropOptions,
    running: Running,
    output: StudyOutput,
) -> int:
    """Find machine settings for wanted blows.

    For the rotary machine: settings for blows of a wanted peak and width at a wanted interval. Every candidate is
    checked by a full run of all its blows; the best one is written as case.toml, the others as case-2.toml and so on.
    A search that is stopped is continued by the same command. With --spec: height, programmer and mass of a drop
    table for the pulse of a specification, or settings of the rotary machine of --from, each judged by it. With
    --json, no files are written unless --out is given. The exit code is 3 where no candidate meets the goal and
    keeps all limits.
    """
    from strikewave.cases.case import load_case
    from strikewave.specifications.reading import load_specification
    from strikewave.studies.engine.runner import Workers
    from strikewave.studies.search import drop_table as drops
    from strikewave.studies.search.rotary import SettingsChoices, check_changes, check_goal, is_rotary
    from strikewave.studies.search.rotary_candidate import blow_goal
    from strikewave.studies.search.settings_report import SearchCommand

    place, typed = source or (REFERENCE if spec is None else DROP_TABLE), changes or ()
    workers = Workers(running.workers, cluster=running.cluster)
    if spec is not None:
        _refuse({"--peak": wanted.peak, "--width": wanted.width}, "none with --spec, which states it")
        case = load_case(place, typed)
        if not is_rotary(case):
            options = {
                "--interval": wanted.interval,
                "--blows": wanted.blows,
                "--strikers": rotary.strikers,
                "--striker-mass": rotary.striker_mass,
                "--stop-limit": wanted.stop_limit,
            }
            _refuse(options, "none of a drop table: it is of a rotary machine (--from)")
            case, specification, drop_choice = output.tested(case), load_specification(spec), drop.choices()
            drop_goal = drops.DropGoal(specification, specification.pulse_limits(), drop.stroke or drops.STROKE)
            drops.check_drop(case, drop_goal, drop_choice)
            drops.check_drop_changes(typed, case, drop_choice)
            usual = source is None and not (changes or drop.given())
            return SearchCommand(
                case, (drop_goal, drop_choice), workers.pool(), usual, place=running.store, fresh=running.fresh
            ).run((), output)
    _refuse(drop.given(), "none of a rotary machine: it is of a drop table, with --spec")
    usual = not (changes or spec or rotary.strikers or rotary.striker_mass or wanted.stop_limit)
    usual = usual and wanted.blows is None and (place, rotary.vary, rotary.disc) == (REFERENCE, STIFFNESS, DISC)
    goal = blow_goal(
        wanted.interval, wanted.peak, wanted.width, material(rotary.disc, "--disc"), wanted.stop_limit, spec
    )
    strikers, masses = tuple(dict.fromkeys(rotary.strikers or ())), tuple(dict.fromkeys(rotary.striker_mass or ()))
    choice = SettingsChoices(strikers, masses, rotary.vary, rotary.disc)
    check_changes(typed, rotary.vary)
    case = load_case(place, [*typed, *([] if wanted.blows is None else [f"feed.blows={wanted.blows}"])])
    check_goal(case, goal, choice)
    return SearchCommand(
        output.tested(case), (goal, choice), workers.pool(), usual, place=running.store, fresh=running.fresh
    ).run((), output)


def _refuse(options: Mapping[str, object], allowed: str) -> None:
    """Refuse the first option that is given and does not apply."""
    for option, value in options.items():
        if value:
            first = value[0] if isinstance(value, list) else value
            raise InputError(option, getattr(first, "word", first), allowed, "leave it out")
