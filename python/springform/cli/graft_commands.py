"""Commands on patches: patch, graft, symmetry, diff and distil."""

from __future__ import annotations

import os
import re
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from ..comparison import compare
from ..design import Design, load, save
from ..distil import distil, save_library
from ..errors import InputError, RunError
from ..files import WriteError
from ..grafting import best_anchor, graft, lift, measured, symmetries
from ..patch_file import Origin, load_patch, save_patch
from ..run import open_run
from ..run_format import is_run
from .terminal import Json, RunArgument, check_writable, print_report, print_table, say

commands = typer.Typer()

_Out = Annotated[Path, typer.Option(help="Where to write it; .toml or .json.")]


@commands.command(
    "patch", epilog="Example: `springform patch runs/a --anchor best --out crown.toml`"
)
def patch_command(
    source: Annotated[
        str, typer.Argument(metavar="DESIGN|RUN", help="A design, a scene's name or a run folder.")
    ],
    out: _Out,
    anchor: Annotated[
        str | None,
        typer.Option(help="Anchor to lift it from; best: where the largest force is least."),
    ] = None,
    rings: Annotated[int, typer.Option(help="Rings of cells round the anchor.")] = 2,
    cells: Annotated[
        str | None, typer.Option(help='Cells to lift, such as "rings(v12, 1) - 7.0".')
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Top-level cell to see it from.")] = None,
    rotate: Annotated[int, typer.Option(help="Quarter turns of the seed, 0 to 3.")] = 0,
    mirror: Annotated[bool, typer.Option("--mirror", help="See it mirrored.")] = False,
    generation: Annotated[
        int | None, typer.Option(help="Of a run: generation; by default the last.")
    ] = None,
    individual: Annotated[
        int | None, typer.Option(help="Of a run: individual; by default the generation's parent.")
    ] = None,
    name: Annotated[str | None, typer.Option(help="Name; by default the file's.")] = None,
    as_json: Json = False,
) -> None:
    """Lift cells as a patch: a small file without address or place, to be set elsewhere."""
    check_writable(out)
    design, origin = _source(source, generation, individual)
    if anchor is None and cells is None:
        raise InputError("is missing; name an anchor, or cells with --cells", key="--anchor")
    if anchor is not None and cells is not None:
        raise InputError("goes without --anchor; leave one out", key="--cells")
    if anchor == "best" and "best" not in design.anchor_names:
        anchor = best_anchor(design)
    if rings < 1:
        raise InputError(f"must be 1 or more, not {rings}", key="--rings")
    lifted = lift(
        design,
        anchor=anchor,
        rings=rings,
        cells=cells,
        seed=seed,
        rotate=_quarters(rotate),
        mirror=mirror,
        name=name or _name_of(out),
        origin=origin,
    )
    save_patch(lifted.patch, out)
    cell, turn, mirrored = lifted.frame
    report = {
        "written": str(out),
        "anchor": anchor,
        "cells": len(lifted.patch.walks),
        "seed": cell,
        "rotate": turn,
        "mirror": mirrored,
        "skipped": [asdict(one) for one in lifted.skipped],
        "origin": lifted.patch.origin.model_dump(exclude_none=True),
    }
    _report(report, as_json)


@commands.command(
    "graft",
    epilog="Example: `springform graft crown.toml three-cylinders --all-anchors --out a.toml`",
)
def graft_command(
    patch: Annotated[Path, typer.Argument(metavar="PATCH", help="A patch file.")],
    design: Annotated[
        str, typer.Argument(metavar="DESIGN|RUN", help="A design, a scene's name or a run folder.")
    ],
    out: _Out,
    at: Annotated[str | None, typer.Option(help="Top-level cell of the patch's seed.")] = None,
    rotate: Annotated[int, typer.Option(help="Quarter turns, 0 to 3.")] = 0,
    mirror: Annotated[bool, typer.Option("--mirror", help="The other way round.")] = False,
    orbit: Annotated[
        bool, typer.Option("--orbit", help="Also at all images under the framework's symmetries.")
    ] = False,
    all_anchors: Annotated[
        bool, typer.Option("--all-anchors", help="On every anchor, turned and mirrored to fit.")
    ] = False,
    at_each: Annotated[
        str | None, typer.Option(help="At each top-level cell of a selection.")
    ] = None,
    within: Annotated[str | None, typer.Option(help="Cells that may change.")] = None,
    as_gene: Annotated[
        str | None, typer.Option(help="Hold it by reference under a name: change one, change all.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Set a patch on a design: at a cell, on every anchor, or at each cell of a selection."""
    check_writable(out)
    if (at is not None) + all_anchors + (at_each is not None) != 1:
        problem = "say where, in one way: --at CELL, --all-anchors or --at-each SELECTION"
        raise InputError(problem)
    base, _ = _source(design, None, None)
    before = measured(base)
    grafted = graft(
        base,
        load_patch(patch),
        at=None if at is None else _cell(at),
        rotate=_quarters(rotate),
        mirror=mirror,
        orbit=orbit,
        anchors=all_anchors,
        at_each=at_each,
        within=within,
        as_gene=as_gene,
    )
    after = measured(grafted.design)
    save(grafted.design, out)
    frames = [
        {
            "anchor": one.anchor,
            "cell": one.frame[0],
            "rotate": one.frame[1],
            "mirror": one.frame[2],
            "cells": len(one.cells),
        }
        for one in grafted.placed
    ]
    names = ("springs", "force_differential")
    report = {
        "placed": len(grafted.placed),
        "cells": sum(len(one.cells) for one in grafted.placed),
        "frames": frames,
        "skipped": [asdict(one) for one in grafted.skipped],
        "edits": len(grafted.edits),
        **{
            name: {"before": getattr(before, name), "after": getattr(after, name)} for name in names
        },
        "written": str(out),
    }
    _report(report, as_json)


@commands.command("symmetry", epilog="Example: `springform symmetry three-cylinders`")
def symmetry_command(
    design: Annotated[str, typer.Argument(metavar="DESIGN", help="A design or a scene's name.")],
    as_json: Json = False,
) -> None:
    """Find the rotations and mirrors of a framework that carry anchors to anchors."""
    found = load(design)
    group = symmetries(found)
    names, orbits = dict(zip(found.anchor_vertices, found.anchor_names, strict=True)), []
    seen: set[str] = set()
    for vertex, name in names.items():
        if name not in seen:
            images = set(group.node_images(found.mesh, f"v{vertex}"))
            orbit = [other for at, other in names.items() if f"v{at}" in images]
            seen.update(orbit)
            orbits.append(orbit)
    cells = {frozenset(cell for cell, _, _ in group.images((face, 0, False)))
             for face in range(len(found.mesh.faces))}  # fmt: skip
    report = {
        "symmetries": len(group),
        "rotations": sum(not mirrored for mirrored in group.mirrored),
        "mirrors": sum(group.mirrored),
        "cells": len(found.mesh.faces),
        "orbits": len(cells),
        "anchor_orbits": orbits if as_json else [", ".join(orbit) for orbit in orbits],
    }
    print_report(report, as_json)


@commands.command("distil", epilog="Example: `springform distil runs/a --out genes`")
def distil_command(
    run: RunArgument,
    out: Annotated[Path, typer.Option(help="Folder for the gene library; empty or new.")],
    rings: Annotated[int, typer.Option(help="Rings of cells round anchors.")] = 1,
    seams: Annotated[bool, typer.Option(help="Also look along seams.")] = True,
    count: Annotated[int, typer.Option(help="How many patches to keep.")] = 12,
    least: Annotated[int, typer.Option(help="Fewest individuals that carry a patch.")] = 10,
    as_json: Json = False,
) -> None:
    """Find the patches that recur in a run and whose carriers fared best, as a gene library."""
    for name, value in (("--rings", rings), ("--count", count), ("--least", least)):
        if value < 1:
            raise InputError(f"must be 1 or more, not {value}", key=name)
    check_folder(out)
    found = distil(run, rings=rings, seams=seams, count=count, least=least)
    if not found:
        raise RunError("no patch recurs often enough; lower --least or evolve longer", file=run)
    rows = [
        {
            "file": str(file),
            "cells": len(one.patch.walks),
            "individuals": one.individuals,
            "advantage": one.advantage,
        }
        for one, file in zip(found, save_library(found, out), strict=True)
    ]
    if as_json:
        print_report({"patches": rows}, as_json)
        return
    lines = [
        f"{row['file']}: {row['cells']} cells, carried by {row['individuals']} individuals, "
        f"{row['advantage']:.3f} of the usual differential"
        for row in rows
    ]
    print_report({"patches": len(rows)}, as_json)
    print("\n".join(lines))


@commands.command("diff", epilog="Example: `springform diff a.toml b.toml --out diff.png`")
def diff_command(
    first: Annotated[str, typer.Argument(metavar="A", help="A design, scene or run folder.")],
    second: Annotated[str, typer.Argument(metavar="B", help="Another one.")],
    out: Annotated[Path | None, typer.Option(help="Picture to draw; .png or .svg.")] = None,
    top: Annotated[int, typer.Option(help="Cells to list by how much force moved.")] = 10,
    as_json: Json = False,
) -> None:
    """Compare two designs: cells, springs, and where force moved."""
    if out is not None and out.suffix not in (".png", ".svg"):
        raise WriteError("must end in .png or .svg", file=out)
    designs = (_source(first, None, None)[0], _source(second, None, None)[0])
    found = compare(*designs)
    if out is not None:
        # Matplotlib takes longer to import than most commands take to run.
        from ..plots import plot_difference  # noqa: PLC0415

        plot_difference(*designs, out)
    names = ("springs", "nodes", "cells", "force_differential", "force_min", "force_max",
             "force_mean", "total_length", "area")  # fmt: skip
    before, after = found.measures
    report: dict[str, Any] = {
        name: {"a": getattr(before, name), "b": getattr(after, name)} for name in names
    }
    report |= {f"type {kind}": {"a": a, "b": b} for kind, (a, b) in found.types.items()}
    report |= {f"level {level}": {"a": a, "b": b} for level, (a, b) in found.levels.items()}
    moved = [asdict(one) | {"change": one.change} for one in found.moved[: max(top, 0)]]
    report["same_framework"] = found.same_framework
    report["changed_cells"] = list(found.changed)
    report["moved"] = moved
    if out is not None:
        report["picture"] = str(out)
    if as_json:
        print_report(report, as_json)
        return
    pairs = {name: pair for name, pair in report.items() if isinstance(pair, dict)}
    rows = [(name.replace("_", " "), pair["a"], pair["b"]) for name, pair in pairs.items()]
    print_table(("", "A", "B"), rows)
    if not found.same_framework:
        say("the frameworks differ, so cells are not compared one by one")
        return
    print(f"\n{len(found.changed)} top-level cells differ; inner force moved most in")
    print_table(
        ("cell", "A [N]", "B [N]", "change [N]"),
        [(one["cell"], one["before"], one["after"], one["change"]) for one in moved],
    )


def _report(report: dict[str, Any], as_json: bool) -> None:
    """Print a report; on a terminal, lists as numbers and what was skipped on standard error."""
    if as_json:
        print_report(report, as_json)
        return
    lines = {name: value for name, value in report.items() if name not in ("frames", "skipped")}
    skipped = report["skipped"]
    print_report(lines | {"skipped": len(skipped)}, as_json)
    for one in skipped:
        say(f"skipped {one['where']}: {one['why']}")


def _source(
    source: str, generation: int | None, individual: int | None
) -> tuple[Design, Origin | None]:
    """A design, or an individual of a run and where it comes from."""
    if not (is_run(source) or os.path.isdir(source)):
        if generation is not None or individual is not None:
            raise InputError("goes with a run; leave it out", key="--generation")
        return load(source), None
    run = open_run(source)
    at = run.generations if generation is None else generation
    if individual is None:
        return run.parent(at), Origin(run=str(source), generation=at)
    found = run.individual(at, individual)
    return found, Origin(run=str(source), generation=at, individual=individual)


def _cell(text: str) -> int:
    if not re.fullmatch(r"\d{1,9}", text):
        problem = f"must be the number of a top-level cell, such as 12, not {text}"
        raise InputError(problem, key="--at")
    return int(text)


def _quarters(rotate: int) -> int:
    if not 0 <= rotate <= 3:
        raise InputError(f"must be 0 to 3 quarter turns, not {rotate}", key="--rotate")
    return rotate


def _name_of(out: Path) -> str:
    """A patch's name from its file's: what is no letter, digit or _ becomes _."""
    word = re.sub(r"[^a-z0-9_]", "_", out.stem.lower())
    return word if re.match(r"[a-z]", word) else f"patch_{word}"


def check_folder(path: Path) -> None:
    """Refuse a folder that is in the way before work is put into it."""
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise WriteError("is not empty; choose another folder", file=path)
