"""``strikewave settings``: settings of a rotary machine, or a drop table, for a pulse or a specification."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from strikewave.analyses.record.options import complete_specification
from strikewave.base.constants import material
from strikewave.base.errors import InputError
from strikewave.reporting.options import Changes, Running, complete_case, quantity
from strikewave.reporting.output_options import StudyOutput
from strikewave.studies.search import DISC, DROP_TABLE, REFERENCE, STIFFNESS

if TYPE_CHECKING:
    from strikewave.cases.case import Case
    from strikewave.studies.search.drop_table import DropChoices


@dataclass(frozen=True)
class DropOptions:
    """What is tried of a drop table, and how high it falls."""

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
    interval: Annotated[
        float | None,
        quantity("--interval", si="s", bare=False, help='Time between blows, such as "20 ms"; needed without --spec.'),
    ] = None,
    peak: Annotated[
        float | None,
        quantity(
            "--peak",
            si="m/s^2",
            bare=False,
            help='Rigid-body peak acceleration, such as "4000 g"; needed without --spec.',
        ),
    ] = None,
    width: Annotated[
        float | None,
        quantity(
            "--width",
            si="s",
            bare=False,
            help='Pulse width at 10 % of the peak, such as "200 us"; needed without --spec.',
        ),
    ] = None,
    blows: Annotated[
        int | None,
        typer.Option(
            "--blows", metavar="COUNT", help="Number of blows; that of the case by default.", show_default=False
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
    from strikewave.studies.engine.runner import pool_of
    from strikewave.studies.search.rotary import SettingsChoices, check_changes, check_goal, is_rotary
    from strikewave.studies.search.rotary_candidate import blow_goal
    from strikewave.studies.search.rotary_report import SearchCommand

    place = source or (REFERENCE if spec is None else DROP_TABLE)
    if spec is not None:
        _refuse({"--peak": peak, "--width": width}, "none with --spec, which states it")
        case = load_case(place, changes or ())
        if not is_rotary(case):
            rotary = {"--interval": interval, "--blows": blows, "--strikers": strikers, "--striker-mass": striker_mass}
            _refuse(rotary | {"--stop-limit": stop_limit}, "none of a drop table: it is of a rotary machine (--from)")
            return _drop_table(output.tested(case), spec, drop, running, output, changes or (), plain=source is None)
    _refuse(drop.given(), "none of a rotary machine: it is of a drop table, with --spec")
    plain = not (changes or strikers or striker_mass or stop_limit or spec) and blows is None
    plain = plain and (place, vary, disc) == (REFERENCE, STIFFNESS, DISC)
    goal = blow_goal(interval, peak, width, material(disc, "--disc"), stop_limit, spec)
    choice = SettingsChoices(tuple(dict.fromkeys(strikers or ())), tuple(dict.fromkeys(striker_mass or ())), vary)
    check_changes(changes or (), vary)
    case = load_case(place, [*(changes or ()), *([] if blows is None else [f"feed.blows={blows}"])])
    check_goal(case, goal, choice)
    pool = pool_of(None, running.workers, running.cluster)
    asked = output.tested(case), (goal, choice), pool, plain
    return SearchCommand(*asked, place=running.store, fresh=running.fresh).run((), output)


def _refuse(options: Mapping[str, object], allowed: str) -> None:
    """Refuse the first option that is given and does not apply."""
    for option, value in options.items():
        if value:
            first = value[0] if isinstance(value, list) else value
            raise InputError(option, getattr(first, "word", first), allowed, "leave it out")


def _drop_table(
    case: Case, spec: str, drop: DropOptions, running: Running, output: StudyOutput, changes: Sequence[str], plain: bool
) -> int:
    """Design a drop table, and return the exit code."""
    from strikewave.specifications.reading import load_specification
    from strikewave.studies.engine.runner import pool_of
    from strikewave.studies.search.drop_report import DropCommand
    from strikewave.studies.search.drop_table import STROKE, DropGoal, check_drop, check_drop_changes

    specification = load_specification(spec)
    goal, choice = DropGoal(specification, specification.pulse_limits(), drop.stroke or STROKE), drop.choices()
    check_drop(case, goal, choice)
    check_drop_changes(changes, case, choice)
    pool = pool_of(None, running.workers, running.cluster)
    plain = plain and not (changes or drop.given())
    asked = case, (goal, choice), pool, plain
    return DropCommand(*asked, place=running.store, fresh=running.fresh).run((), output)
