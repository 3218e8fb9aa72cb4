"""The door of the command line: which verbs there are, and what errors become.

Whatever is heavy to import is imported inside the commands, so that ``suite --help`` answers at once.
"""

from __future__ import annotations

import io
import os
import signal
import sys
from collections.abc import Sequence
from types import FrameType
from typing import Annotated

import typer
from typer.exceptions import TyperException

from suite.cli.audit import audit
from suite.cli.check import check
from suite.cli.check_planner import check_planner
from suite.cli.compare import compare
from suite.cli.export import export
from suite.cli.generate import generate
from suite.cli.importing import importing
from suite.cli.merge import merge
from suite.cli.new_planner import new_planner
from suite.cli.options import EXIT_INTERRUPTED, EXIT_USAGE, say
from suite.cli.planners import planners
from suite.cli.plot import plot
from suite.cli.predictors import predictors
from suite.cli.report import report
from suite.cli.run import run
from suite.cli.show import show
from suite.cli.table import table
from suite.cli.version import version


def _print_version(asked: bool) -> None:
    if asked:
        from suite.experiment.code import DISTRIBUTION, installed

        print(f"{DISTRIBUTION} {installed(DISTRIBUTION) or 'not installed'}")
        raise typer.Exit


app = typer.Typer(
    help="Compare motion planners for continuum arms among moving obstacles.",
    rich_markup_mode=None,  # rich help would double the time of --help
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for verb in (
    run, table, show, report, compare, plot, merge, export, generate,
    planners, new_planner, check_planner, predictors, check, audit, version,
):  # fmt: skip
    app.command()(verb)
app.add_typer(importing, name="import")


@app.callback()
def _every(
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_print_version, help="Show the version and exit.")
    ] = False,
) -> None:
    """What every command may be preceded by."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    0 is done, 1 what was looked for was found (a regression, a violation under ``audit --strict``, a check that
    failed), 2 a usage or input error, or a disk that takes no more, 3 nothing to compare, 4 inconclusive under
    ``compare --strict``, 130 interrupted with everything finished saved.
    """
    for asked in (signal.SIGINT, signal.SIGTERM):
        signal.signal(asked, _interrupt)
    if isinstance(sys.stdout, io.TextIOWrapper):  # a name that the terminal cannot show must not end what it names
        sys.stdout.reconfigure(errors="backslashreplace")
    given = list(sys.argv[1:] if arguments is None else arguments)
    try:
        code = _call(given or ["--help"])
        sys.stdout.flush()
    except TyperException as error:
        say(f"error: {error.format_message()}")
        return EXIT_USAGE
    except ValueError as error:
        if not _is_a_users(error):
            raise
        say(f"error: {error}")
        return EXIT_USAGE
    except BrokenPipeError:  # whoever reads has read enough
        _drop_output()
        return 0
    except OSError as error:
        _drop_output()
        say(f"error: {error.filename or 'output'}: cannot be read or written: {error.strerror or error}")
        return EXIT_USAGE
    except (KeyboardInterrupt, typer.Abort) as error:
        if isinstance(error.__cause__, EOFError):  # which Click takes for an end of input
            raise error.__cause__ from None
        say("stopped before anything ran")
        return EXIT_INTERRUPTED
    return code if isinstance(code, int) else 0


def _call(given: list[str]) -> object:
    """Run the command; an interrupt stays one, whatever Numba makes of it while it compiles."""
    try:
        return app(given, prog_name="suite", standalone_mode=False)
    except RuntimeError as error:
        if isinstance(error, typer.Abort) or signal.getsignal(signal.SIGINT) is not _stop_at_once:
            raise
        raise KeyboardInterrupt from None


def _is_a_users(error: ValueError) -> bool:
    """Whether the error is a mistake of the user, with a line written for them."""
    from scenarios import UserError

    return isinstance(error, UserError)


def _drop_output() -> None:
    """Let Python not try once more, when it ends, to write what cannot be written."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _interrupt(number: int, frame: FrameType | None) -> None:
    """End a run saved and without orphans; whoever asks again does not want to wait for that.

    What has finished is in the journal already, and workers end with this process.
    """
    for again in (signal.SIGINT, signal.SIGTERM):
        signal.signal(again, _stop_at_once)
    raise KeyboardInterrupt


def _stop_at_once(number: int, frame: FrameType | None) -> None:
    os.write(2, b"suite: stopped at once; what had finished is saved, and the same command goes on from there\n")
    os._exit(EXIT_INTERRUPTED)
