"""Commands on runs: evolve, resume and show."""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from ..design import save
from ..errors import InputError
from ..evolution import OnGeneration, evolve, resume, steer
from ..evolution import Progress as GenerationProgress
from ..files import WriteError
from ..parameters import Parameters, read_parameter
from ..run import Run, open_run
from ..run_format import is_run
from ..steering import ASKED
from .terminal import (
    DesignArgument,
    Json,
    Method,
    RunArgument,
    StoppedError,
    Threads,
    UntilDifferential,
    UntilSuf,
    check_writable,
    load_design,
    print_report,
    progress_bar,
    say,
    update_bar,
)

commands = typer.Typer()


@commands.command(
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
    min_springs: Annotated[int | None, typer.Option(help="Fewest springs allowed.")] = None,
    max_springs: Annotated[int | None, typer.Option(help="Most springs allowed.")] = None,
    selection: Annotated[str | None, typer.Option(help="comma or plus [comma].")] = None,
    genes: Annotated[
        list[Path] | None,
        typer.Option(help="Patch file, or folder of them, to insert; may be given again."),
    ] = None,
    grafts: Annotated[
        str | None, typer.Option(help="Most genes inserted in a mutant: 1, or 5% of the cells [1].")
    ] = None,
    symmetry: Annotated[
        bool, typer.Option("--symmetry", help="Keep the symmetries of the framework.")
    ] = False,
    within: Annotated[
        str | None, typer.Option(help='Cells within which mutation stays, as "rings(A7, 2)".')
    ] = None,
    cell_weights: Annotated[
        list[str] | None,
        typer.Option(
            "--cell-weight",
            help='Factor on the chance that cells are drawn, as "rings(A7, 2)=4"; 0: kept as they '
            "are. May be given again.",
        ),
    ] = None,
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
        "min_springs": min_springs,
        "max_springs": max_springs,
        "selection": selection,
        "genes": gene_files(genes or []) or None,
        "grafts": grafts,
        "symmetry": symmetry,
        "within": within,
        "cell_weights": cell_weights_of(cell_weights or []) or None,
        "until_springs": until_springs,
        "until_differential": until_differential,
        "until_suf": until_suf,
    }
    parameters = {name: value for name, value in given.items() if value is not None}
    start = load_design(design, method)

    def run(on_generation: OnGeneration) -> Run:
        return evolve(start, out=out, threads=threads, on_generation=on_generation, **parameters)

    total = Parameters().generations if generations is None else generations
    _report_run(_drive(run, out, total, 0), began, as_json)


@commands.command("resume", epilog="Example: `springform resume runs/a`")
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


@commands.command(
    "steer", epilog="Example: `springform steer runs/a change insertions=5% weighting=deep`"
)
def steer_command(
    run: RunArgument,
    what: Annotated[
        str, typer.Argument(metavar="WHAT", help="pause, continue, stop, or change parameters.")
    ],
    changes: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME=VALUE]...", help="Parameters to change, as those of evolve."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Ask whoever drives a run for something; done between two generations."""
    asked = next((word for word in ASKED if word == what), None)
    if asked is None:
        raise InputError(f"must be one of {', '.join(ASKED)}, not {what!r}", key="WHAT")
    driver = steer(run, asked, **parameters_of(changes or []))
    print_report({"asked": asked, "driver": driver.program, "process": driver.pid}, as_json)


def parameters_of(texts: list[str]) -> dict[str, Any]:
    """Return parameters from ``name=value``. Raises `InputError`: no such, or no such value."""
    found: dict[str, Any] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"must be a name and a value, such as insertions=5%, not {text!r}")
        name = name.strip().replace("-", "_")
        found[name] = read_parameter(name, value.strip())
    return found


@commands.command(
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
    check_writable(out)
    found = open_run(run)
    design = found.individual(generation, individual)
    row = (generation - 1) * found.parameters.population + individual
    table = found.table
    report = {name: table[name][row].item() for name in ("springs", "force_differential", "suf")}
    save(design, out)
    print_report(report, as_json)


def cell_weights_of(texts: list[str]) -> dict[str, float]:
    """Return factors by selection. Raises `InputError`: not ``SELECTION=FACTOR``."""
    factors: dict[str, float] = {}
    for text in texts:
        cells, _, factor = text.rpartition("=")
        try:
            factors[cells.strip()] = float(factor)
        except ValueError:
            cells = ""
        if not cells.strip():
            problem = f"must be cells and a factor, such as 12.0=4, not {text!r}"
            raise InputError(problem, key="--cell-weight")
    return factors


def gene_files(paths: list[Path]) -> list[Path]:
    """Return patch files: those given, and all in given folders, by name."""
    files: list[Path] = []
    for path in paths:
        found = sorted(path.glob("*.toml")) if path.is_dir() else [path]
        if not found:
            raise InputError("holds no patch; name a file, or a folder with .toml files", file=path)
        files += found
    return files


def _drive(run: Callable[[OnGeneration], Run], folder: Path, total: int, done: int) -> Run:
    go_on = f"go on with: springform resume {shlex.quote(str(folder))}"
    try:
        return _withprogress_bar(run, total, done)
    except KeyboardInterrupt:
        raise StoppedError(go_on if is_run(folder) else "the run had not begun") from None
    except WriteError as error:
        if not is_run(folder):
            raise
        raise WriteError(f"{error.message}; then {go_on}", file=error.file) from None


def _withprogress_bar(run: Callable[[OnGeneration], Run], total: int, done: int) -> Run:
    with progress_bar("generations") as progress:
        task = progress.add_task(
            "generations", total=total, completed=done, springs="–", differential="–"
        )

        def show(now: GenerationProgress) -> None:
            update_bar(progress, task, now.generation, now.springs, now.force_differential)

        return run(show)


def _report_run(finished: Run, began: float, as_json: bool) -> None:
    if finished.stayed:
        say(
            f"the parent stayed in {finished.stayed} of {finished.generations} generations: "
            "no mutant was fit, or better with plus selection"
        )
    print_report(
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
