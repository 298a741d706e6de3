"""The command line: one command a step of the work, one JSON object with --json."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from .. import _core
from ..errors import SpringformError, printable
from ..files import explain
from . import (
    bench_commands,
    design_commands,
    equalise_command,
    graft_commands,
    run_commands,
    studio_command,
)
from .terminal import BAD_INPUT, INTERRUPTED, StoppedError, say

__all__ = ["main"]

app = typer.Typer(
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    help="Design tensile nets whose topology differs from place to place.",
    epilog="Start with `springform init three-cylinders`, then `springform solve` and "
    "`springform evolve`.",
)


def main() -> None:
    """Run the command line; bad input gives one line on standard error and exit code 2."""
    try:
        code = app(sys.argv[1:] or ["--help"], standalone_mode=False) or 0
        sys.stdout.flush()
        if code == INTERRUPTED:
            say("springform: interrupted")
    except typer.TyperException as error:
        code = _refuse(error.format_message())
    except SpringformError as error:
        code = _refuse(str(error))
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        code = _refuse(f"{where}{explain(error)}")
    except typer.Exit as request:
        code = request.exit_code
    except KeyboardInterrupt:  # before a command began
        say("springform: interrupted")
        code = INTERRUPTED
    except StoppedError as error:
        say(f"springform: interrupted; {error}")
        code = INTERRUPTED
    sys.exit(code)


def _refuse(message: str) -> int:
    say(f"springform: {printable(message)}")
    return BAD_INPUT


def _version(wanted: bool) -> None:
    if wanted:
        print(f"springform {_core.__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


app.add_typer(design_commands.commands)
app.add_typer(equalise_command.commands)
app.add_typer(run_commands.commands)
app.add_typer(graft_commands.commands)
app.add_typer(bench_commands.commands)
app.add_typer(studio_command.commands)
