"""The command that measures: bench."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .terminal import Json, StoppedError, print_report, say

if TYPE_CHECKING:
    from ..bench import Row

commands = typer.Typer()


@commands.command("bench", epilog="Example: `springform bench individual threads`")
def bench_command(
    cases: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="CASE",
            help="Cases, or nonlinear, large, all for several; an unknown one lists all there are.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for a CSV file a case, below the machine's name.")
    ] = None,
    label: Annotated[
        str, typer.Option(help="What to call the code that is timed, in the files.")
    ] = "",
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Small nets, few rounds: to see that it works, not how fast."),
    ] = False,
    as_json: Json = False,
) -> None:
    """Time springFORM beside CHOLMOD and whatever other engines are installed."""
    # No other command is to wait for what only this one needs.
    from .. import bench  # noqa: PLC0415
    from ..bench import machine, page, reference  # noqa: PLC0415

    names = bench.chosen(cases or [])
    settings = bench.Bench()
    if quick:
        settings = bench.Bench(bench.Effort(2, 1, 1.0, 0.001), quick=True)
    shown = ""

    def show(row: Row) -> None:
        nonlocal shown
        if row.heading() != shown:
            shown = row.heading()
            (say if as_json else print)(shown)
        if not as_json:
            print(row.line(), flush=True)

    results = bench.run(names, bench=settings, out=out, label=label, on_row=show)
    if not reference.available():
        say("no ratios: the reference has not been built, which `make bench` does")
    if "studio" in names and not page.available():
        say("no window is measured: `make bench CASES=studio` does it, in Chromium")
    found: dict[str, list[dict[str, object]]] = {}
    try:
        for result in results:
            found[result.case] = [row.report() for row in result.rows]
            if result.path is not None:
                say(f"wrote {result.path}")
    except KeyboardInterrupt:
        whole = ", ".join(found) or "no case"
        raise StoppedError(f"{whole} had been measured; the case under way left no file") from None
    report = {
        "machine": {
            "name": machine.slug(),
            "processor": machine.processor(),
            "cores": machine.cores(),
        },
        "versions": bench.versions(),
        "label": label,
        "quick": quick,
        "cases": found,
    }
    if as_json:
        print_report(report, as_json)
    else:
        versions = ", ".join(f"{name} {version}" for name, version in bench.versions().items())
        say(f"on {machine.processor()}, {machine.cores()} cores; {versions}")
