"""Distilling: the patches that recur in a run and whose carriers fared best, as a gene library.

The paper, section 5: "the ability to identify successful gene sets within the expanding data
structure".
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from .errors import RunError
from .files import WriteError, explain
from .patch_file import Origin, Patch, save_patch
from .patch_schema import cells_of
from .run import Run, open_run
from .selections import nodes_of, select

_SIMILAR = 0.05  # of the springs: whom an individual is compared with


@dataclass(frozen=True)
class Distilled:
    """A patch that recurs in a run."""

    patch: Patch
    """The patch; its origin is the best individual that carries it."""
    individuals: int
    """How many individuals carry it."""
    advantage: float
    """Mean of their force differential over the median of individuals with similar springs."""


def distil(
    run: Run | str | os.PathLike[str],
    *,
    rings: int = 1,
    seams: bool = True,
    count: int = 12,
    least: int = 10,
) -> list[Distilled]:
    """Return the best `count` patches that recur in a run, best first.

    Patches are `rings` of cells round anchors and, with `seams`, one ring round every vertex of a
    seam, of every individual that the run evaluated. They are ranked by how their carriers fared:
    the logarithm of the force differential over the median of the individuals whose springs differ
    by at most 5 %, summed over the square root of their number. At least `least` individuals carry
    each.
    Raises `RunError`: the run has no generation, or is broken.
    """
    run = run if isinstance(run, Run) else open_run(run)
    if not run.generations:
        raise RunError("has made no generation yet; evolve first", file=run.folder)
    design = run.design.closed
    census = _core.Census(design.setting, _sites(run, rings, seams=seams))
    scores = relative_differentials(run)
    population = run.parameters.population
    for generation in range(run.generations):
        rows = scores[generation * population : (generation + 1) * population]
        listed = [None if np.isnan(score) else float(score) for score in rows]
        census.count(run.evolution(generation, threads=1), listed)
    named = design.file.cell_types
    found = []
    for number, (core, carriers, total, best) in enumerate(census.ranked(least)[:count], start=1):
        cells = cells_of(core)
        row = (best[0] - 1) * population + best[1]
        patch = Patch(
            name=f"{'anchor' if core[0] else 'seam'}_{number:02}",
            anchored=core[0],
            cells=cells,
            cell_types={kind: named[kind] for kind in named if any(kind in c.cell for c in cells)},
            origin=Origin(
                design=run.design.name,
                run=str(run.folder),
                generation=best[0],
                individual=best[1],
                cells=f"carried by {carriers} individuals",
                springs=int(run.table["springs"][row]),
                force_differential=float(run.table["force_differential"][row]),
                force_mean=float(run.table["force_mean"][row]),
            ),
        )
        found.append(Distilled(patch, carriers, math.exp(total / carriers)))
    return found


def save_library(found: Sequence[Distilled], folder: str | os.PathLike[str]) -> list[Path]:
    """Write patches into a folder that is empty or not there yet, a file each; return the files.

    Raises `WriteError`: the folder holds something, or can't be written.
    """
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
        taken = any(path.iterdir())
    except OSError as error:
        raise WriteError(f"can't be made: {explain(error)}", file=path) from None
    if taken:
        raise WriteError("is not empty; choose another folder", file=path)
    files = [path / f"{one.patch.name}.toml" for one in found]
    for one, file in zip(found, files, strict=True):
        save_patch(one.patch, file)
    return files


def relative_differentials(run: Run) -> NDArray[np.float64]:
    """Return every individual's force differential among those of similar spring count.

    It is the logarithm of the ratio to their median; NaN where the differential is undefined.
    """
    springs = run.table["springs"].astype(np.float64)
    logs = np.log(run.table["force_differential"])
    scores = np.full(len(logs), np.nan)
    valid = np.flatnonzero(~np.isnan(logs))
    order = valid[np.argsort(springs[valid], kind="stable")]
    sorted_springs = springs[order]
    first = np.searchsorted(sorted_springs, sorted_springs * (1 - _SIMILAR), side="left")
    last = np.searchsorted(sorted_springs, sorted_springs * (1 + _SIMILAR), side="right")
    medians: dict[Any, float] = {}
    for row, low, high in zip(order, first, last, strict=True):
        if (low, high) not in medians:
            medians[low, high] = float(np.median(logs[order[low:high]]))
        scores[row] = logs[row] - medians[low, high]
    return scores


def _sites(run: Run, rings: int, *, seams: bool) -> list[tuple[int, bool, _core.Selection]]:
    design = run.design.closed
    anchors = dict.fromkeys(design.anchor_vertices)
    along: dict[int, None] = {}
    for number in range(len(design.file.framework.joins) if seams else 0):
        along |= dict.fromkeys(int(node[1:]) for node in nodes_of(design, f"seam:{number}"))
    sites = [(vertex, True, select(design, f"rings(v{vertex}, {rings})")) for vertex in anchors]
    return sites + [
        (vertex, False, select(design, f"rings(v{vertex}, 1)"))
        for vertex in along
        if vertex not in anchors
    ]
