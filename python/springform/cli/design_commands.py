"""Commands on designs: init, solve, seek and plot."""

from __future__ import annotations

import os
import time
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, get_args

import numpy as np
import typer

from .. import results, scenes
from ..design import Design, load, save
from ..errors import InputError, SpringformError
from ..evolution import seek
from ..exchange.obj import design_from_obj
from ..files import WriteError
from ..network import TOLERANCE, Equilibrium, Solver
from ..readings import read_spring, slack
from ..run import Run, open_run
from ..run_format import is_run
from .terminal import (
    NOT_CONVERGED,
    DesignArgument,
    Json,
    Method,
    StoppedError,
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


@commands.command(epilog="Example: `springform init three-cylinders --out net.toml`")
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
        print_report({"scenes": listed} if as_json else listed, as_json)
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
    print_report({"written": str(target)}, as_json)


@commands.command("solve", epilog="Example: `springform solve three-cylinders --json`")
def solve_command(
    design: DesignArgument,
    out: Annotated[
        Path | None, typer.Option(help="Folder for nodes.csv, springs.csv, measures.json, net.obj.")
    ] = None,
    solver: Annotated[
        str, typer.Option(help="direct; implicit-euler, as the paper does; or dynamic-relaxation.")
    ] = "direct",
    tolerance: Annotated[
        float, typer.Option(help="Largest residual over the mean spring force.")
    ] = TOLERANCE,
    spring: Annotated[
        int | None, typer.Option(help="Number of a spring to read: force, strain, lengths, law.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Grow the net of a design and find its equilibrium."""
    if not 0 < tolerance < 1:
        raise InputError(f"must be between 0 and 1, not {tolerance}", key="--tolerance")
    if solver not in get_args(Solver):
        known = ", ".join(get_args(Solver))
        raise InputError(f"must be one of {known}, not {solver}", key="--solver")
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
        "method": equilibrium.method,
        "slack": int(slack(equilibrium, net.cords).sum()),
        "rods": len(net.network().rods),
        "load_sum": equilibrium.loads.sum(axis=0).tolist(),
        **_reactions(net, equilibrium),
    }
    if out is not None:
        results.write(net, equilibrium, measures, out)
    if spring is not None:
        report = {**report, **_spring(net, equilibrium, spring, as_json)}
    print_report(report, as_json)
    if not equilibrium.converged:
        say(f"springform: no equilibrium: {equilibrium.reason}{_worst(net, equilibrium)}")
        raise typer.Exit(NOT_CONVERGED)


@commands.command(
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
    symmetry: Annotated[
        bool, typer.Option("--symmetry", help="Subdivide whole orbits of the framework.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Direct stress-seeking: subdivide the cell of highest inner force, solve, repeat."""
    began = time.perf_counter()
    start = load_design(design, method)
    check_writable(out)
    step, ended = None, None
    with progress_bar("seeking") as progress:
        task = progress.add_task("seeking", total=steps, springs="–", differential="–")
        limits = {"until_differential": until_differential, "until_suf": until_suf}
        try:
            for step in seek(start, steps=steps, type=type, symmetry=symmetry, **limits):
                update_bar(progress, task, step.step, step.springs, step.force_differential)
        except (SpringformError, KeyboardInterrupt) as error:
            if step is None:
                raise
            ended = error
    if step is None:
        raise InputError("no cell of this design can be subdivided further", file=design)
    save(step.design, out)
    if isinstance(ended, KeyboardInterrupt):
        raise StoppedError(f"{out} holds the design after {step.step} steps")
    print_report(
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
        say(f"ended after {step.step} steps: {ended}")


@commands.command("plot", epilog="Example: `springform plot runs/a --out pictures`")
def plot_command(
    source: Annotated[
        str, typer.Argument(metavar="DESIGN|RUN", help="A design, a scene's name or a run folder.")
    ],
    out: Annotated[Path, typer.Option(help="Folder for the pictures; made if missing.")],
    as_json: Json = False,
) -> None:
    """Draw the net coloured by force, its forces and cells, and how a run went."""
    # Matplotlib takes longer to import than most commands take to run.
    from .. import plots  # noqa: PLC0415

    folder = is_run(source) or os.path.isdir(source)
    subject = open_run(source) if folder else load(source)
    if isinstance(subject, Run):
        _ = subject.table  # a damaged run is refused before a picture is drawn
        paths = plots.plot_run(subject, out)
    else:
        paths = plots.plot_design(subject, out)
    print_report({"pictures": [str(path) for path in paths]}, as_json)


def _reactions(net: Design, equilibrium: Equilibrium) -> dict[str, Any]:
    """Return the largest reaction with its anchor, and the sum of all."""
    at_anchors = equilibrium.reactions[net.anchors]
    sizes = np.linalg.norm(at_anchors, axis=1)
    largest = int(np.argmax(sizes))
    return {
        "reaction_max": float(sizes[largest]),
        "reaction_max_at": net.anchor_names[largest],
        "reaction_sum": equilibrium.reactions.sum(axis=0).tolist(),
    }


def _worst(net: Design, equilibrium: Equilibrium) -> str:
    """Return where the node of the largest residual is, if there is one."""
    worst = equilibrium.worst_node
    if worst is None:
        return ""
    x, y, z = (f"{value:.4g}" for value in equilibrium.positions[worst])
    return f"; node {worst} is {net.nodes[worst]} at ({x}, {y}, {z})"


def _spring(net: Design, equilibrium: Equilibrium, spring: int, as_json: bool) -> dict[str, Any]:
    """Return what a spring does, to be printed."""
    found = read_spring(net.network(), equilibrium, spring)
    a, b = (net.nodes[node] for node in net.network().springs[spring])
    if as_json:
        return {"spring": {"nodes": [a, b], "readings": [asdict(one) for one in found]}}
    lines = {f"  {one.name}": f"{one.text:<16} {one.formula}" for one in found}
    return {f"spring {spring}": f"{a} to {b}", **lines}


def _numbers(text: str | None) -> list[int] | None:
    if text is None:
        return None
    try:
        return [int(word) for word in text.split(",")]
    except ValueError:
        raise InputError(f"must be numbers such as 0,5,9, not {text}", key="--anchors") from None
