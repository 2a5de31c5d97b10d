"""The group of commands: a table of names and summaries; a command's module is imported when that command is used."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import functools
import importlib
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import typer
from typer.core import TyperCommand, TyperGroup

from strikewave.base.processes import Stopped, interrupts_as_such
from strikewave.reporting.output_options import working_on

if TYPE_CHECKING:
    from typer._click import Command, Context, HelpFormatter

PANELS: dict[str, dict[str, tuple[str, str]]] = {
    "Predict": {
        "run": ("strikewave.cli.run", "Run a case or a set-up file."),
        "wave": ("strikewave.analyses.wave.command", "Run a layered bar under its load."),
        "fem": ("strikewave.analyses.fem.command:fem", "Run an explicit finite-element model."),
        "impact": ("strikewave.analyses.impact.command:impact", "Solve the impact of two free bodies."),
        "laws": ("strikewave.analyses.impact.command:laws", "List the contact laws."),
        "reproduce": ("strikewave.papers.li_ma_2019.command", "Reproduce a published paper."),
    },
    "Measure": {
        "record": ("strikewave.analyses.record.command", "Measure the pulses of recorded files."),
        "srs": ("strikewave.analyses.record.srs", "Compute shock response spectra."),
        "spec": ("strikewave.analyses.record.spec", "List, show, begin or meet a specification."),
        "hopkinson": ("strikewave.analyses.hopkinson.command", "Reduce split-Hopkinson-bar records."),
        "identify": ("strikewave.analyses.impact.command:identify", "Identify a contact law from a pulse."),
        "compare": ("strikewave.analyses.compare.command", "Compare two histories, measured or simulated."),
    },
    "Design": {
        "fit": ("strikewave.studies.fit.command", "Fit values of a case to measurements."),
        "settings": ("strikewave.studies.search.settings_command", "Find machine settings for wanted blows."),
        "design": ("strikewave.studies.search.design_command", "Find settings of a case for wanted results."),
        "sweep": ("strikewave.studies.sweep.command", "Run a case over any of its settings."),
        "map": ("strikewave.studies.map.command", "Map a machine over two of its settings."),
        "scatter": ("strikewave.studies.scatter.command", "Propagate tolerances to the blows."),
        "buffer": ("strikewave.studies.buffer.command", "Rank gasket stacks under a sensor."),
    },
    "Exchange": {
        "deck": ("strikewave.analyses.fem.command:deck", "Write a model for LS-DYNA or OpenRadioss."),
        "ls-dyna": ("strikewave.analyses.fem.command:ls_dyna", "Read the results of an LS-DYNA run."),
    },
    "Look": {"app": ("strikewave.web.command", "Open the app in a browser.")},
    "Cases": {
        "new": ("strikewave.cli.case_commands:new_case", "Write a new case file to edit."),
        "validate": ("strikewave.cli.case_commands:validate_case", "Check a case without running it."),
        "diff": ("strikewave.cli.case_commands:diff_cases", "List the differences of two cases."),
        "cases": ("strikewave.cli.case_commands:list_cases", "List the built-in cases."),
        "materials": ("strikewave.cli.case_commands:list_materials", "List the materials with their sources."),
        "examples": ("strikewave.cli.program_commands:write_examples", "Copy notebooks, a record, studies and cases."),
        "doctor": ("strikewave.cli.program_commands:examine", "Say what is installed, missing and cached."),
    },
}
"""Panel of the help, name, module and summary of a command; its function is ``command``, or stands after a colon.

The summary is the first line of the command's docstring. It stands here too, because reading it there would import the
module; a test holds both equal.
"""
WIDEST = 28  # chosen: half a line of 80 is left for the words
"""Characters of an option in the help; the words of a longer one begin on the next line."""
KEPT_HYPHEN = "\u2011"
"""A hyphen that no line ends at."""
SETTINGS: dict[str, Any] = {"help_option_names": ["-h", "--help"]}
"""Settings of every command."""


class CommandEntry(NamedTuple):
    """A command of the table."""

    panel: str
    module: str
    summary: str


HELP = CommandEntry("", "strikewave.cli.program_commands:show_help", "Show the help of a command.")
"""``strikewave help COMMAND`` works, and stands in no panel: ``strikewave COMMAND --help`` is shown below them."""


def entries() -> dict[str, CommandEntry]:
    """Return the table by names.

    Examples
    --------
    >>> entries()["srs"].panel
    'Measure'
    """
    return {name: CommandEntry(panel, *row) for panel, rows in PANELS.items() for name, row in rows.items()}


def command_function(module: str) -> Callable[..., Any]:
    """Import the module of a command and return its function, as the table names them."""
    path, _, name = module.partition(":")
    function: Callable[..., Any] = getattr(importlib.import_module(path), name or "command")
    return function


@functools.cache
def whole_command(name: str, module: str) -> Command:
    """Return the command of a module with all its options."""
    one = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    one.command(name, cls=SectionedCommand, context_settings=SETTINGS)(spread(command_function(module)))
    return typer.main.get_command(one)


class WholeWords:
    """A command whose help breaks no word, not even at a hyphen: ``mm-t-s`` and ``--json`` stand in one line."""

    def get_help(self, ctx: Context) -> str:
        """Return the help, in which other hyphens stood while it was put into lines."""
        formatter = ctx.make_formatter()
        for write in ("write_text", "write_dl", "write_usage"):
            setattr(formatter, write, _with_hyphens_kept(getattr(formatter, write)))
        self.format_help(ctx, formatter)  # type: ignore[attr-defined]  # of the command beside this class
        return formatter.getvalue().rstrip("\n").replace(KEPT_HYPHEN, "-")


def _with_hyphens_kept(write: Callable[..., None]) -> Callable[..., None]:
    """Return a method of a formatter that gets each hyphen as one that no line ends at."""

    def kept(one: Any) -> Any:
        if isinstance(one, str):
            return one.replace("-", KEPT_HYPHEN)
        return [tuple(map(kept, row)) for row in one] if isinstance(one, list) else one

    return lambda *texts, **sizes: write(*map(kept, texts), **sizes)


class SectionedCommand(WholeWords, TyperCommand):
    """A command whose help shows its options in sections: those of a panel of their own after the others."""

    def invoke(self, ctx: Context) -> Any:
        """Run the command, which knows the inputs of its result: its arguments name them."""
        inputs: list[str] = []
        for parameter in self.params:
            if parameter.param_type_name == "argument":
                value = ctx.params.get(str(parameter.name))
                words = [value] if isinstance(value, str | Path) else value or ()
                inputs += [str(word) for word in words if isinstance(word, str | Path)]
        with working_on(inputs):
            return super().invoke(ctx)

    def format_options(self, ctx: Context, formatter: HelpFormatter) -> None:
        """Write a section a panel, with one width for all."""
        sections: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is None:
                continue
            is_argument = parameter.param_type_name == "argument"
            panel = "Arguments" if is_argument else getattr(parameter, "rich_help_panel", None) or "Options"
            name = record[0].partition(" <")[0] if is_argument else record[0]  # no Python type beside CASE
            sections.setdefault(panel, []).append((name, record[1]))
        width = min(max(len(name) for rows in sections.values() for name, _ in rows), WIDEST)
        first = [panel for panel in ("Arguments", "Options") if panel in sections]
        for panel in dict.fromkeys([*first, *sections]):
            with formatter.section(panel):
                formatter.write_dl([(name.ljust(width), words) for name, words in sections[panel]], col_max=WIDEST)


class LazyCommand(TyperCommand):
    """A name with its summary; the command itself is imported when its words are parsed."""

    def __init__(self, name: str, entry: CommandEntry, hidden: bool = False) -> None:
        super().__init__(name, short_help=entry.summary, hidden=hidden, rich_markup_mode=None)
        self.entry = entry

    def make_context(
        self, info_name: str | None, args: list[str], parent: Context | None = None, **extra: Any
    ) -> Context:
        """Parse the words of the command itself, which then stands in the context in the place of this one."""
        return whole_command(str(self.name), self.entry.module).make_context(info_name, args, parent, **extra)


class CommandGroup(WholeWords, TyperGroup):
    """All commands, shown in panels."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        for name, entry in entries().items():
            self.add_command(LazyCommand(name, entry))
        self.add_command(LazyCommand("help", HELP, hidden=True))

    def invoke(self, ctx: Context) -> Any:
        """Run the command that is named."""
        try:
            with interrupts_as_such():
                return super().invoke(ctx)
        except KeyboardInterrupt as stop:
            raise Stopped from stop

    def format_commands(self, ctx: Context, formatter: HelpFormatter) -> None:
        """Write a section a panel, all in one column."""
        width = max(len(name) for name in self.commands)
        for panel, rows in PANELS.items():
            with formatter.section(panel):
                formatter.write_dl([(name.ljust(width), summary) for name, (_, summary) in rows.items()])


def spread(command: Callable[..., int]) -> Callable[..., int]:
    """Return a command whose groups are spread into their options, in their place; called, it puts them together again.

    A parameter annotated with a dataclass is a group; the fields of the dataclass are annotated as parameters of a
    command are, and have defaults where not required. Its ``panel``, a class variable, heads them in the help. The
    command runs in the context that its method ``in_force`` returns, if it has one.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Output:
    ...     out: str | None = None
    ...     json: bool = False
    >>> def command(file: str, output: Output) -> int:
    ...     return len(file) + output.json
    >>> list(inspect.signature(spread(command)).parameters)
    ['file', 'out', 'json']
    >>> spread(command)(file="a.csv", out=None, json=True)
    6
    """
    hints = get_type_hints(command, include_extras=True)
    groups = {name: hint for name, hint in hints.items() if dataclasses.is_dataclass(hint) and isinstance(hint, type)}
    options = [
        option
        for one in inspect.signature(command).parameters.values()
        for option in (_options(groups[one.name]) if one.name in groups else [one.replace(annotation=hints[one.name])])
    ]

    @functools.wraps(command)
    def gathered(**values: Any) -> int:
        with contextlib.ExitStack() as stack:
            for name, group in groups.items():
                values[name] = group(**{field.name: values.pop(field.name) for field in dataclasses.fields(group)})
                if hasattr(values[name], "in_force"):
                    stack.enter_context(values[name].in_force())
            return command(**values)

    keyword_only = [option.replace(kind=inspect.Parameter.KEYWORD_ONLY) for option in options]
    gathered.__dict__["__signature__"] = inspect.Signature(keyword_only)
    gathered.__annotations__ = {option.name: option.annotation for option in options}
    return gathered


def _options(group: type) -> list[inspect.Parameter]:
    """Return the fields of a group as parameters."""
    hints = get_type_hints(group, include_extras=True)
    panel: str | None = getattr(group, "panel", None)
    return [
        one.replace(kind=inspect.Parameter.KEYWORD_ONLY, annotation=_under(panel, hints[name]))
        for name, one in inspect.signature(group).parameters.items()
    ]


def _under(panel: str | None, annotation: Any) -> Any:
    """Return the annotation of an option whose help stands in a panel."""
    if panel is None or get_origin(annotation) is not Annotated:
        return annotation
    kind, option = get_args(annotation)
    placed = copy.copy(option)
    placed.rich_help_panel = panel
    return Annotated[kind, placed]
