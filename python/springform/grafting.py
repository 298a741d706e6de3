"""Grafting: patches lifted from a design and set elsewhere, on one cell, an orbit or every anchor.

The paper, section 4.3, Figs. 22 and 23.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import _core
from .design import Design, Measures
from .errors import DesignError
from .network import Equilibrium
from .patch_file import Origin, Patch, PatchError
from .patch_schema import Gene, cells_of
from .selections import SelectionError, nodes_of, select, vertex_of

Frame = tuple[int, int, bool]
"""A top-level cell, quarter turns and whether it is mirrored: the patch's corner 0 comes to lie on
the cell's corner of that number."""


@dataclass(frozen=True)
class Skipped:
    """A cell that was left out."""

    where: str
    """The cell, or the seed and the walk from it."""
    why: str
    """The reason."""


@dataclass(frozen=True)
class Lifted:
    """A patch, where it was seen from, and what it does not hold."""

    patch: Patch
    """The patch."""
    frame: Frame
    """The seed and its orientation: grafting the patch there changes nothing."""
    skipped: tuple[Skipped, ...] = ()
    """Selected cells that the patch does not hold."""


@dataclass(frozen=True)
class Placed:
    """A patch where it was set."""

    frame: Frame
    """The seed and its orientation."""
    anchor: str | None
    """The anchor, if it was set on one."""
    cells: tuple[int, ...]
    """Top-level cells that were written."""


@dataclass(frozen=True)
class Grafted:
    """A design with patches set on it."""

    design: Design
    """The design, closed."""
    edits: list[str]
    """What was done, as one list that can be undone; lines as `Design.edited` takes them."""
    placed: tuple[Placed, ...]
    """Where the patch was set: frames in which at least one cell was written."""
    skipped: tuple[Skipped, ...] = field(default=())
    """What was not written."""


def lift(
    design: Design,
    *,
    anchor: str | None = None,
    rings: int = 2,
    cells: str | _core.Selection | None = None,
    seed: int | None = None,
    rotate: int = 0,
    mirror: bool = False,
    name: str = "patch",
    origin: Origin | None = None,
) -> Lifted:
    """Lift a patch: `rings` of cells round an anchor, or the selected `cells`, or both's overlap.

    Round an anchor the patch's first corner is the anchor and its seed the cell from which the
    others are nearest. Other selections are seen from the cell and turn that describe them in the
    least words, or from `seed`, turned by `rotate` quarters and mirrored as told.
    Raises `SelectionError`: nothing is selected, or there is no such anchor.
    """
    design = design.closed
    if anchor is None and cells is None:
        raise SelectionError("nothing is selected; give an anchor or cells")
    words = f"rings({anchor}, {rings})" if anchor is not None else str(cells)
    vertex = None if anchor is None else vertex_of(design, anchor)
    chosen = select(design, f'rings("{anchor}", {rings})' if cells is None else cells)
    frame = None
    if seed is not None:
        vertex, frame = None, (_checked_seed(design, seed), rotate % 4, mirror)
    core, seen_from, left_out = _refused(
        lambda: _core.lift(
            design.setting,
            design.forest,
            chosen,
            vertex=vertex,
            anchored=vertex is not None,
            frame=frame,
        )
    )
    held = cells_of(core)
    named = design.file.cell_types
    types = {kind: named[kind] for kind in named if any(kind in cell.cell for cell in held)}
    patch = Patch(name=name, anchored=core[0], cells=held, cell_types=types)
    figures = _origin(design, chosen, words)
    patch = patch.model_copy(update={"origin": (origin or Origin()).model_copy(update=figures)})
    return Lifted(patch, seen_from, tuple(Skipped(where, why) for where, why in left_out))


def graft(
    design: Design,
    patch: Patch,
    *,
    at: int | Sequence[Frame] | None = None,
    rotate: int = 0,
    mirror: bool = False,
    orbit: bool = False,
    anchors: bool | Sequence[str] = False,
    at_each: str | _core.Selection | None = None,
    within: str | _core.Selection | None = None,
    as_gene: str | None = None,
) -> Grafted:
    """Set a patch on a design and return what became of it; no cell is written half.

    At one top-level cell `at`, turned by `rotate` quarters and mirrored as told, with `orbit` at
    all its images under the framework's symmetries; or in given frames; or on every anchor, or
    those named, where seed and orientation are found; or at each top-level cell of a selection.
    With `as_gene` the design holds the patch by reference, under that name: whatever changes it in
    one place changes it in all; where it does not lie whole it is skipped.
    Types that the patch defines and the design lacks are added to it.
    Raises `PatchError`: the patch does not go with the design, nothing of it could be written, or
    the seed does not exist; `SelectionError`: nothing is selected.
    """
    check_fits(design, patch)
    design = design.with_cell_types(patch.cell_types).closed
    core = patch.core()
    names: list[str | None] = []
    if anchors:
        chosen = design.anchor_names if anchors is True else tuple(anchors)
        frames, names = _anchor_frames(design, patch, chosen), [*chosen]
    elif at_each is not None:
        frames = [(face, rotate % 4, mirror) for face in select(design, at_each).faces]
    elif isinstance(at, int):
        frames = [(_checked_seed(design, at), rotate % 4, mirror)]
    elif at is not None:
        frames = list(at)
    else:
        raise SelectionError("no place is given; say at which cell, or on the anchors")
    if orbit:
        images = [symmetries(design).images(frame) for frame in frames]
        frames, names = list(dict.fromkeys(image for row in images for image in row)), []
    if as_gene is not None:
        return _refer(design, patch, as_gene, frames, names or [None] * len(frames))
    region = None if within is None else select(design, within)
    forest, edits, results = _refused(
        lambda: _core.graft_patch(design.setting, design.forest, core, frames, within=region)
    )
    placed, skipped = [], []
    labels = names or [None] * len(frames)
    for frame, name, (cells, left) in zip(frames, labels, results, strict=True):
        if cells:
            placed.append(Placed(frame, name, tuple(cells)))
        start = f"cell {frame[0]}" if name is None else name
        for walk, cell, why in left:
            way = f"{start}, walk {walk}" if walk else start
            skipped.append(Skipped(way if cell is None else f"{way}, cell {cell}", why))
    if not placed:
        raise PatchError(f"nothing of the patch could be set: {skipped[0].where}: {skipped[0].why}")
    return Grafted(design.with_forest(forest), edits, tuple(placed), tuple(skipped))


def _refer(
    design: Design, patch: Patch, name: str, frames: Sequence[Frame], labels: Sequence[str | None]
) -> Grafted:
    """Set a patch by reference: whole or not at all."""
    now = design.with_gene(name, Gene(anchored=patch.anchored, cells=patch.cells))
    edits: list[str] = []
    placed, skipped = [], []
    for frame, label in zip(frames, labels, strict=True):
        cell, turn, mirrored = frame
        orientation = f"@{turn}{'m' if mirrored else ''}" if turn or mirrored else ""
        line = f"{cell} refer {name}{orientation}"
        try:
            now, done = now.followed([line])
        except DesignError as error:
            skipped.append(Skipped(f"cell {cell}" if label is None else label, error.message))
            continue
        edits += done
        instances = {seed: faces for _, (seed, _, _), faces in now.setting.instances(now.forest)}
        placed.append(Placed(frame, label, tuple(instances[cell])))
    if not placed:
        raise PatchError(f"nothing of the patch could be set: {skipped[0].where}: {skipped[0].why}")
    closed, closing = now.closed_by()
    return Grafted(closed, edits + closing, tuple(placed), tuple(skipped))


def check_fits(design: Design, patch: Patch) -> None:
    """Refuse a patch that a design can't take.

    Raises `PatchError`: it has more top-level cells than the framework, or types that the method
    does not allow; `DesignError`: it defines a type in another way than the design.
    """
    room = len(design.mesh.faces)
    if len(patch.walks) > room:
        raise PatchError(
            f"has {len(patch.walks)} top-level cells, the framework of {design.name} only {room}; "
            "lift fewer cells",
            key=patch.name,
        )
    with_types = design.with_cell_types(patch.cell_types)
    _refused(lambda: _core.check_patch(with_types.setting, patch.core()), key=patch.name)


def symmetries(design: Design) -> _core.Symmetries:
    """Return the rotations and mirrors of a framework that carry anchors to anchors.

    Raises `PatchError`: there are too many, as where parts are not joined.
    """
    found: _core.Symmetries = _refused(lambda: _core.Symmetries(design.setting))
    return found


def edit_orbit(design: Design, edits: Sequence[str]) -> list[str]:
    """Return edits with all their images under the symmetries of the framework, each once.

    Raises `PatchError`: an edit has an image that does something else to the same cell.
    """
    group = symmetries(design)
    lines: list[str] = _refused(lambda: group.edits(design.setting, list(edits)))
    return lines


def anchor_peaks(design: Design, equilibrium: Equilibrium) -> dict[str, float]:
    """Return the largest force at every anchor over the mean force; the least is resolved best."""
    springs = design.network().springs
    mean = float(np.mean(equilibrium.forces))
    return {
        name: float(np.max(equilibrium.forces[(springs == node).any(axis=1)])) / mean
        for name, node in zip(design.anchor_names, design.anchors, strict=True)
    }


def best_anchor(design: Design) -> str:
    """Return the anchor that is resolved best: least largest incident force over mean force."""
    peaks = anchor_peaks(design, design.solve())
    return min(peaks, key=lambda name: peaks[name])


def measured(design: Design) -> Measures:
    """Solve and measure a design. Raises `DesignError`: no net is left after filtering."""
    return design.measure(design.solve())


def _anchor_frames(design: Design, patch: Patch, anchors: Sequence[str]) -> list[Frame]:
    if not patch.anchored:
        raise PatchError(
            "was not lifted at an anchor, so its anchor corner is unknown; name cells to set it at",
            key=patch.name,
        )
    core, vertices = patch.core(), [vertex_of(design, anchor) for anchor in anchors]
    frames: list[Frame] = _refused(
        lambda: [_core.best_frame(design.setting, core, vertex) for vertex in vertices]
    )
    return frames


def _origin(design: Design, chosen: _core.Selection, words: str) -> dict[str, Any]:
    equilibrium = design.solve()
    measures = design.measure(equilibrium)
    starts, items = design.cells.springs
    within = set(chosen.expressed(design.forest))
    numbers = [at for at, address in enumerate(design.cells.addresses) if address in within]
    parts = [items[starts[cell] : starts[cell + 1]] for cell in numbers]
    springs = np.concatenate(parts) if parts else np.empty(0, dtype=np.uint32)
    return {
        "design": design.name,
        "cells": words,
        "springs": measures.springs,
        "force_differential": measures.force_differential,
        "force_mean": measures.force_mean,
        "force_max": float(equilibrium.forces[springs].max()) if len(springs) else None,
    }


def _checked_seed(design: Design, seed: int) -> int:
    if not 0 <= seed < len(design.mesh.faces):
        last = len(design.mesh.faces) - 1
        raise SelectionError(f"there is no top-level cell {seed}; there are 0 to {last}")
    return seed


def _refused(make: Callable[[], Any], key: str | None = None) -> Any:
    try:
        return make()
    except _core.CoreError as error:
        core_key, problem = error.args
        raise PatchError(problem, key=": ".join(filter(None, (key, core_key)))) from None


__all__ = [
    "Frame",
    "Grafted",
    "Lifted",
    "Placed",
    "Skipped",
    "anchor_peaks",
    "best_anchor",
    "check_fits",
    "edit_orbit",
    "graft",
    "lift",
    "measured",
    "nodes_of",
    "symmetries",
]
