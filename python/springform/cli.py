"""The command line: one command a step of the work, one JSON object with --json."""

from __future__ import annotations

import json
import math
import os
import shlex
import sys
import time
from collections.abc import Callable, Iterator
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

from . import _core, results, scenes
from .design import Design, load, save
from .errors import InputError, SpringformError, printable
from .evolution import OnGeneration, evolve, resume, seek
from .evolution import Progress as GenerationProgress
from .exchange.obj import design_from_obj
from .files import WriteError, explain
from .network import TOLERANCE
from .parameters import Parameters
from .run import Run, open_run
from .run_format import is_run

INTERRUPTED = 130
NOT_CONVERGED = 1
BAD_INPUT = 2

app = typer.Typer(
    add_completion=False,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    help="Design tensile nets whose topology differs from place to place.",
    epilog="Start with `springform init three-cylinders`, then `springform solve` and "
    "`springform evolve`.",
)
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


def main() -> None:
    """Run the command line; bad input gives one line on standard error and exit code 2."""
    try:
        code = app(sys.argv[1:] or ["--help"], standalone_mode=False) or 0
        sys.stdout.flush()
        if code == INTERRUPTED:
            _say("springform: interrupted")
    except typer.TyperException as error:
        code = _refuse(error.format_message())
    except SpringformError as error:
        code = _refuse(str(error))
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        code = _refuse(f"{where}{explain(error)}")
    except typer.Exit as request:
        code = request.exit_code
    except _InterruptedError as error:
        _say(f"springform: interrupted; {error}")
        code = INTERRUPTED
    sys.exit(code)


class _InterruptedError(Exception):
    """Says how to go on."""


def _refuse(message: str) -> int:
    _say(f"springform: {printable(message)}")
    return BAD_INPUT


@app.command(epilog="Example: `springform init three-cylinders --out net.toml`")
def init(
    name: Annotated[
        str | None, typer.Argument(help="A scene's name, or a quad mesh as an .obj file.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Where to write; by default NAME.toml in this folder.")
    ] = None,
    anchors: Annotated[
        str | None,
        typer.Option(help="With an .obj file: numbers of the anchored vertices, from 0: 0,5,9."),
    ] = None,
    force: Annotated[bool, typer.Option(help="Replace a file that exists.")] = False,
    as_json: Json = False,
) -> None:
    """Write a packaged scene, or a quad mesh, as a design file; without a name, list the scenes."""
    if name is None:
        listed = {scene: scenes.load_scene(scene).description for scene in scenes.names()}
        _print_report({"scenes": listed} if as_json else listed, as_json)
        return
    from_mesh = name.lower().endswith(".obj")
    if anchors is not None and not from_mesh:
        raise InputError("goes with an .obj file only; leave it out", key="--anchors")
    file = design_from_obj(name, _numbers(anchors)) if from_mesh else scenes.load_scene(name)
    target = out or Path(f"{Path(name).stem}.toml")
    if target.exists() and not force:
        raise WriteError("exists; choose another file with --out or add --force", file=target)
    design = Design(file, source=name)
    design.network()
    save(design, target)
    _print_report({"written": str(target)}, as_json)


def _numbers(text: str | None) -> list[int] | None:
    if text is None:
        return None
    try:
        return [int(word) for word in text.split(",")]
    except ValueError:
        raise InputError(f"must be numbers such as 0,5,9, not {text}", key="--anchors") from None


@app.command("solve", epilog="Example: `springform solve three-cylinders --json`")
def solve_command(
    design: DesignArgument,
    out: Annotated[
        Path | None, typer.Option(help="Folder for nodes.csv, springs.csv, measures.json, net.obj.")
    ] = None,
    solver: Annotated[
        str, typer.Option(help="direct, or implicit-euler: step by step as the paper does.")
    ] = "direct",
    tolerance: Annotated[
        float, typer.Option(help="Largest residual over the mean spring force.")
    ] = TOLERANCE,
    as_json: Json = False,
) -> None:
    """Grow the net of a design and find its equilibrium."""
    if not 0 < tolerance < 1:
        raise InputError(f"must be between 0 and 1, not {tolerance}", key="--tolerance")
    if solver not in ("direct", "implicit-euler"):
        raise InputError(f"must be direct or implicit-euler, not {solver}", key="--solver")
    began = time.perf_counter()
    net = load(design)
    equilibrium = net.solve(tolerance=tolerance, solver=solver)  # type: ignore[arg-type]
    measures = net.measure(equilibrium)
    report = {
        "nodes": measures.nodes,
        "springs": measures.springs,
        "anchors": len(net.anchors),
        "cells": measures.cells,
        "force_differential": measures.force_differential,
        "force_min": measures.force_min,
        "force_max": measures.force_max,
        "force_mean": measures.force_mean,
        "residual": equilibrium.residual,
        "converged": equilibrium.converged,
        "iterations": equilibrium.iterations,
        "seconds": time.perf_counter() - began,
    }
    if out is not None:
        results.write(net, equilibrium, measures, out)
    _print_report(report, as_json)
    if not equilibrium.converged:
        _say(f"springform: no equilibrium: {equilibrium.reason}")
        raise typer.Exit(NOT_CONVERGED)


@app.command(
    "seek", epilog="Example: `springform seek one-cylinder --steps 40 --type 2 --out a.toml`"
)
def seek_command(
    design: DesignArgument,
    steps: Annotated[int, typer.Option(min=1, help="Most subdivisions.")],
    type: Annotated[str, typer.Option(help="Cell type of the children.")],
    out: Annotated[Path, typer.Option(help="Where to write the refined design.")],
    method: Method = None,
    until_differential: UntilDifferential = None,
    until_suf: UntilSuf = None,
    as_json: Json = False,
) -> None:
    """Direct stress-seeking: subdivide the cell of highest inner force, solve, repeat."""
    began = time.perf_counter()
    start = _load(design, method)
    _check_writable(out)
    step, ended = None, None
    with _progress("seeking") as progress:
        task = progress.add_task("seeking", total=steps, springs="–", differential="–")
        limits = {"until_differential": until_differential, "until_suf": until_suf}
        try:
            for step in seek(start, steps=steps, type=type, **limits):
                _update(progress, task, step.step, step.springs, step.force_differential)
        except (SpringformError, KeyboardInterrupt) as error:
            if step is None:
                raise
            ended = error
    if step is None:
        raise InputError("no cell of this design can be subdivided further", file=design)
    save(step.design, out)
    if isinstance(ended, KeyboardInterrupt):
        raise _InterruptedError(f"{out} holds the design after {step.step} steps")
    _print_report(
        {
            "steps": step.step,
            "springs": step.springs,
            "force_differential": step.force_differential,
            "suf": step.suf,
            "seconds": time.perf_counter() - began,
        },
        as_json,
    )
    if ended is not None:
        _say(f"ended after {step.step} steps: {ended}")


@app.command(
    "evolve",
    epilog="Example: `springform evolve three-cylinders --out runs/a --until-springs 2000`",
)
def evolve_command(
    design: DesignArgument,
    out: Annotated[Path, typer.Option(help="Run folder to make.")],
    population: Annotated[int | None, typer.Option(help="Mutants a generation [150].")] = None,
    generations: Annotated[int | None, typer.Option(help="Most generations [300].")] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of all random draws [1].")] = None,
    types: Annotated[
        str | None, typer.Option(help="Cell types that mutation draws, such as 1,6.")
    ] = None,
    method: Method = None,
    weighting: Annotated[
        str | None,
        typer.Option(help="unweighted, linear, exponential, deep or stress [exponential]."),
    ] = None,
    weight_base: Annotated[
        float | None, typer.Option(help="Base of the exponential weighting [4].")
    ] = None,
    weight_exponent: Annotated[
        float | None, typer.Option(help="Exponent on linear, deep and stress weights [1].")
    ] = None,
    insertions: Annotated[
        str | None, typer.Option(help="Cells subdivided in each mutant: 3 or 5% [3].")
    ] = None,
    switches: Annotated[
        str | None, typer.Option(help="Cells that switch type in each mutant: 3 or 5% [3].")
    ] = None,
    toggles: Annotated[
        str | None, typer.Option(help="Subdivisions turned off or on: 1 or 5% [1].")
    ] = None,
    fitness: Annotated[str | None, typer.Option(help="suf or differential [suf].")] = None,
    suf_reference: Annotated[
        str | None, typer.Option(help="start, parent or zero [start].")
    ] = None,
    niche: Annotated[
        int | None,
        typer.Option(help="Compare only within this many springs of the generation's median."),
    ] = None,
    self_adapt: Annotated[
        bool, typer.Option("--self-adapt", help="Amounts and weighting mutate with individuals.")
    ] = False,
    min_length: Annotated[float | None, typer.Option(help="Shortest spring allowed [m].")] = None,
    selection: Annotated[str | None, typer.Option(help="comma or plus [comma].")] = None,
    until_springs: Annotated[
        int | None, typer.Option(help="End once the parent has this many springs.")
    ] = None,
    until_differential: UntilDifferential = None,
    until_suf: UntilSuf = None,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Evolve the topology of a design and keep the run in a folder."""
    began = time.perf_counter()
    given = {
        "population": population,
        "generations": generations,
        "seed": seed,
        "types": types,
        "weighting": weighting,
        "weight_base": weight_base,
        "weight_exponent": weight_exponent,
        "insertions": insertions,
        "switches": switches,
        "toggles": toggles,
        "fitness": fitness,
        "suf_reference": suf_reference,
        "niche": niche,
        "self_adapt": self_adapt,
        "min_length": min_length,
        "selection": selection,
        "until_springs": until_springs,
        "until_differential": until_differential,
        "until_suf": until_suf,
    }
    parameters = {name: value for name, value in given.items() if value is not None}
    start = _load(design, method)

    def run(on_generation: OnGeneration) -> Run:
        return evolve(start, out=out, threads=threads, on_generation=on_generation, **parameters)

    total = Parameters().generations if generations is None else generations
    _report_run(_drive(run, out, total, 0), began, as_json)


@app.command("resume", epilog="Example: `springform resume runs/a`")
def resume_command(
    run: RunArgument,
    generations: Annotated[int | None, typer.Option(help="New number of generations.")] = None,
    threads: Threads = None,
    as_json: Json = False,
) -> None:
    """Go on with a run where it stopped, to the same bits as if it had not stopped."""
    began = time.perf_counter()
    before = open_run(run)

    def go_on(on_generation: OnGeneration) -> Run:
        return resume(before, generations=generations, threads=threads, on_generation=on_generation)

    total = before.parameters.generations if generations is None else generations
    _report_run(_drive(go_on, run, total, before.generations), began, as_json)


@app.command(
    epilog="Example: `springform show runs/a --generation 12 --individual 37 --out a.toml`"
)
def show(
    run: RunArgument,
    generation: Annotated[int, typer.Option(help="Generation, from 1.")],
    individual: Annotated[int, typer.Option(help="Individual, from 0.")],
    out: Annotated[Path, typer.Option(help="Where to write the design.")],
    as_json: Json = False,
) -> None:
    """Rebuild any individual that a run ever evaluated, as a design."""
    _check_writable(out)
    found = open_run(run)
    design = found.individual(generation, individual)
    row = (generation - 1) * found.parameters.population + individual
    table = found.table
    report = {name: table[name][row].item() for name in ("springs", "force_differential", "suf")}
    save(design, out)
    _print_report(report, as_json)


@app.command("plot", epilog="Example: `springform plot runs/a --out pictures`")
def plot_command(
    source: Annotated[
        str, typer.Argument(metavar="DESIGN|RUN", help="A design, a scene's name or a run folder.")
    ],
    out: Annotated[Path, typer.Option(help="Folder for the pictures; made if missing.")],
    as_json: Json = False,
) -> None:
    """Draw the net coloured by force, its forces and cells, and how a run went."""
    # Matplotlib takes longer to import than most commands take to run.
    from . import plots  # noqa: PLC0415

    folder = is_run(source) or os.path.isdir(source)
    subject = open_run(source) if folder else load(source)
    if isinstance(subject, Run):
        _ = subject.table  # a damaged run is refused before a picture is drawn
        paths = plots.plot_run(subject, out)
    else:
        paths = plots.plot_design(subject, out)
    _print_report({"pictures": [str(path) for path in paths]}, as_json)


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


def _load(design: str, method: str | None) -> Design:
    loaded = load(design)
    return loaded if method is None else loaded.with_method(method)


def _check_writable(path: Path) -> None:
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
def _progress(what: str) -> Iterator[Progress]:
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


def _update(progress: Progress, task: Any, done: int, springs: int, value: float | None) -> None:
    differential = "–" if value is None else f"{value:.2f}"
    progress.update(task, completed=done, springs=str(springs), differential=differential)


def _drive(run: Callable[[OnGeneration], Run], folder: Path, total: int, done: int) -> Run:
    go_on = f"go on with: springform resume {shlex.quote(str(folder))}"
    try:
        return _with_progress(run, total, done)
    except KeyboardInterrupt:
        raise _InterruptedError(go_on if is_run(folder) else "the run had not begun") from None
    except WriteError as error:
        if not is_run(folder):
            raise
        raise WriteError(f"{error.message}; then {go_on}", file=error.file) from None


def _with_progress(run: Callable[[OnGeneration], Run], total: int, done: int) -> Run:
    with _progress("generations") as progress:
        task = progress.add_task(
            "generations", total=total, completed=done, springs="–", differential="–"
        )

        def show(now: GenerationProgress) -> None:
            _update(progress, task, now.generation, now.springs, now.force_differential)

        return run(show)


def _report_run(finished: Run, began: float, as_json: bool) -> None:
    if finished.stayed:
        _say(
            f"the parent stayed in {finished.stayed} of {finished.generations} generations: "
            "no mutant was fit, or better with plus selection"
        )
    _print_report(
        {
            "generations": finished.generations,
            "individuals": finished.generations * finished.parameters.population,
            "seconds": time.perf_counter() - began,
            "start": finished.start,
            "best": finished.final,
            "lowest": finished.lowest_standing,
            "digest": finished.digest(),
        },
        as_json,
    )


def _say(message: str) -> None:
    _errors.print(message, markup=False)


def _print_report(report: dict[str, Any], as_json: bool) -> None:
    if as_json:
        print(json.dumps(results.finite(report)))
        return
    width = max(20, *map(len, report))
    for name, value in report.items():
        print(f"{name.replace('_', ' '):<{width}} {_words(value)}")


def _words(value: Any) -> str:
    match value:
        case None:
            return "undefined"
        case bool():
            return "yes" if value else "no"
        case float():
            return "undefined" if math.isnan(value) else f"{value:.6g}"
        case dict():
            return ", ".join(
                f"{_words(part)} {name.replace('_', ' ')}" for name, part in value.items()
            )
        case list():
            return "\n".join(str(part) for part in value)
    return str(value)
