"""What every command shares: options, reports, progress and messages on the terminal."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from .. import results
from ..design import Design, load
from ..files import WriteError
from ..run_format import is_run

INTERRUPTED = 130
NOT_CONVERGED = 1
BAD_INPUT = 2

# Without emoji, or line 100 of a file would be shown as one.
_errors = Console(stderr=True, highlight=False, soft_wrap=True, emoji=False)

DesignArgument = Annotated[
    str, typer.Argument(metavar="DESIGN", help="A design file (.toml, .json) or a scene's name.")
]
RunArgument = Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output.")]
Method = Annotated[
    str | None,
    typer.Option("--method", help="recursive, extensible or dynamic; by default the design's."),
]
UntilDifferential = Annotated[
    float | None,
    typer.Option(help="End once the force differential reaches this, from wherever it starts."),
]
UntilSuf = Annotated[
    float | None, typer.Option(help="End once the spring utilization factor is this or less.")
]
Threads = Annotated[
    int | None, typer.Option(help="Threads; by default one a core. The result stays the same.")
]


class StoppedError(Exception):
    """Says how to go on."""


def load_design(design: str, method: str | None) -> Design:
    """Load a design, with another filter method if one is given."""
    loaded = load(design)
    return loaded if method is None else loaded.with_method(method)


def check_writable(path: Path) -> None:
    """Refuse a file of the wrong kind before work is put into it."""
    if path.suffix not in (".toml", ".json"):
        raise WriteError("must end in .toml or .json", file=path)
    if not path.parent.is_dir():
        raise WriteError(f"the folder {path.parent} does not exist; make it first", file=path)
    if path.name == "design.toml" and is_run(path.parent):
        raise WriteError("is what a run started from; choose another file", file=path)


class _Pace(ProgressColumn):
    """Generations or steps a second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed:.1f}/s")


@contextmanager
def progress_bar(what: str) -> Iterator[Progress]:
    """Show how work goes on, on standard error."""
    columns = (
        TextColumn(what),
        BarColumn(),
        MofNCompleteColumn(),
        _Pace(),
        TextColumn("{task.fields[springs]} springs"),
        TextColumn("differential {task.fields[differential]}"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=_errors) as progress:
        try:
            yield progress
        except BaseException:
            # What went wrong is said on one line, without a bar beside it.
            progress.live.transient = True
            progress.live.stop()
            progress.disable = True
            raise


def update_bar(progress: Progress, task: Any, done: int, springs: int, value: float | None) -> None:
    """Show how much of a task is done, and the net now."""
    differential = "–" if value is None else f"{value:.2f}"
    progress.update(task, completed=done, springs=str(springs), differential=differential)


def say(message: str) -> None:
    """Print a message on standard error."""
    _errors.print(message, markup=False)


def print_report(report: dict[str, Any], as_json: bool) -> None:
    """Print a report on standard output, as one JSON object or as lines."""
    if as_json:
        print(json.dumps(results.finite(report)))
        return
    width = max(20, *map(len, report))
    for name, value in report.items():
        print(f"{name.replace('_', ' '):<{width}} {_words(value)}")


def print_table(head: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    """Print rows under a head on standard output, numbers to the right."""
    texts = [list(head), *([_words(value) for value in row] for row in rows)]
    widths = [max(len(row[at]) for row in texts) for at in range(len(head))]
    for row in texts:
        cells = [row[0].ljust(widths[0])]
        cells += [text.rjust(width) for text, width in zip(row[1:], widths[1:], strict=True)]
        print("  ".join(cells).rstrip())


def _words(value: Any) -> str:
    words = str(value)
    match value:
        case None:
            words = "undefined"
        case bool():
            words = "yes" if value else "no"
        case float():
            words = "undefined" if math.isnan(value) else f"{value:.6g}"
        case dict():
            parts = (f"{_words(part)} {name.replace('_', ' ')}" for name, part in value.items())
            words = ", ".join(parts)
        case list() if value and all(isinstance(part, float) for part in value):
            words = ", ".join(map(_words, value))
        case list():
            words = "\n".join(str(part) for part in value)
    return words
