"""The command ``strikewave``: collects the commands, and turns errors into one line and an exit code.

Exit codes: 0 done, 1 our fault, 2 bad input, 3 done but a stated limit was broken.
"""

from __future__ import annotations

import os
import sys
import warnings
from typing import Any

import typer

from strikewave._version import __version__
from strikewave.analyses.fem import command as fem
from strikewave.analyses.fem import deck
from strikewave.analyses.fem.ls_dyna import command as ls_dyna
from strikewave.analyses.hopkinson import command as hopkinson
from strikewave.analyses.impact import command as impact
from strikewave.analyses.impact import identify, laws
from strikewave.analyses.machine import command as run
from strikewave.analyses.record import command as record
from strikewave.analyses.record import srs
from strikewave.analyses.wave import command as wave
from strikewave.base.errors import StrikewaveError, StrikewaveWarning
from strikewave.cli import cases, diff, materials, new, validate
from strikewave.papers.li_ma_2019 import command as reproduce
from strikewave.reporting.terminal import say
from strikewave.studies.buffer import command as buffer
from strikewave.studies.map import command as map
from strikewave.studies.scatter import command as scatter
from strikewave.studies.settings import command as settings

app = typer.Typer(
    name="strikewave",
    help="Predict, measure and design high-g impact tests.",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for name, command in (
    ("run", run.command),
    ("wave", wave.command),
    ("fem", fem.command),
    ("deck", deck.command),
    ("impact", impact.command),
    ("record", record.command),
    ("srs", srs.command),
    ("identify", identify.command),
    ("hopkinson", hopkinson.command),
    ("buffer", buffer.command),
    ("scatter", scatter.command),
    ("settings", settings.command),
    ("map", map.command),
    ("ls-dyna", ls_dyna.command),
    ("new", new.command),
    ("validate", validate.command),
    ("diff", diff.command),
    ("cases", cases.command),
    ("materials", materials.command),
    ("laws", laws.command),
    ("reproduce", reproduce.command),
):
    app.command(name)(command)


INTERRUPTED = 130
"""Exit code after Ctrl-C."""


def _print_version(wanted: bool) -> None:
    if wanted:
        sys.stdout.write(f"strikewave {__version__}\n")
        raise typer.Exit


@app.callback()
def _options(
    version: bool = typer.Option(False, "--version", help="Print the version.", callback=_print_version, is_eager=True),
) -> None:
    """Predict, measure and design high-g impact tests."""


def main() -> None:
    """Run the command line and exit."""
    warnings.showwarning = _show_warning
    if len(sys.argv) == 1:
        sys.argv.append("--help")
    sys.exit(_run())


def _show_warning(message: Warning | str, category: type[Warning], *rest: Any, **more: Any) -> None:
    if issubclass(category, StrikewaveWarning):
        say(f"warning: {message}")


def _run() -> int:
    """Run and return the exit code."""
    try:
        code = int(app(standalone_mode=False) or 0)
        sys.stdout.flush()
    except (typer.Abort, KeyboardInterrupt):
        code = INTERRUPTED
    except StrikewaveError as error:
        say(str(error))
        return 2
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except MemoryError:
        say("out of memory: a smaller recorder.memory, a larger solver.output_step or step, or fewer taps take less")
        return 2
    except Exception as error:
        if hasattr(error, "format_message"):  # typer's own errors: a wrong option, a missing argument
            say("strikewave: " + " ".join(error.format_message().split()) + " (see `strikewave --help`)")
            return 2
        if os.environ.get("STRIKEWAVE_TRACE"):
            raise
        say(f"internal error ({type(error).__name__}: {error}); please report it, with STRIKEWAVE_TRACE=1 set")
        return 1
    if code == INTERRUPTED:
        say("stopped; nothing was written")
    return code
