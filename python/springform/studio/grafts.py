"""Grafting in the studio: selections, patches that are lifted, planned and set."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..arrays import Floats
from ..design import Design
from ..errors import DesignError, InputError
from ..grafting import Frame, Grafted, best_anchor, graft, lift
from ..patch_file import Origin, Patch
from ..selections import select, vertex_of
from .changes import Action, ForestChange, ValueChange, values_of
from .graft_messages import (
    CopyPatch,
    Graft,
    GraftFigures,
    GraftPlan,
    PlacedPatch,
    PlanGraft,
    SelectCells,
)
from .motion import carried
from .orbits import cell_orbit


def selected(design: Design, request: SelectCells) -> list[str]:
    """Return the expressed cells that a request selects. Raises `InputError`: there are none."""
    words = request.words
    if request.around_best is not None:
        words = f'rings("{best_anchor(design)}", {request.around_best})'
    if words is not None:
        chosen = select(design, words)
    elif request.cells:
        chosen = _core.Selection(design.mesh, request.cells)
    else:
        raise InputError("select cells first")
    if request.orbit:
        chosen = _core.Selection(design.mesh, cell_orbit(design, chosen.addresses))
    if request.grow:
        level = min(address.count(".") for address in request.cells or chosen.addresses)
        change = chosen.grown if request.grow > 0 else chosen.shrunk
        chosen = change(design.mesh, abs(request.grow), level)
    found: list[str] = chosen.expressed(design.closed.forest)
    if not found:
        raise InputError("no cell would be left in the selection")
    return found


def lifted(design: Design, request: CopyPatch, origin: Origin) -> Patch:
    """Return the patch that a request asks for. Raises `InputError`: it can't be lifted."""
    cells = _core.Selection(design.mesh, request.cells)
    if request.anchor is not None:
        corners = design.mesh.faces[cells.faces]
        if not (corners == vertex_of(design, request.anchor)).any():
            raise InputError("is not touched by the selected cells", key=request.anchor)
    taken = lift(
        design,
        anchor=request.anchor,
        cells=cells,
        seed=request.seed,
        name=request.name,
        origin=origin,
    )
    words = " + ".join(cells.addresses[:40]) + (" + …" if len(cells.addresses) > 40 else "")
    described = taken.patch.origin.model_copy(update={"cells": words})
    return taken.patch.model_copy(update={"origin": described})


def planned(
    design: Design, patch: Patch, request: PlanGraft, positions: Floats, before: bool
) -> GraftPlan:
    """Return where a patch would come to lie, drawn on the net at `positions`, (n, 3) [m].

    With `before` both nets are solved and measured. Raises `InputError`: it does not fit there.
    """
    grafted = _grafted(design, patch, request)
    outline, springs = _drawn(design, grafted, positions)
    return GraftPlan(
        placed=[
            PlacedPatch(cell=one.frame[0], anchor=one.anchor, cells=list(one.cells))
            for one in grafted.placed
        ],
        skipped=[f"{one.where}: {one.why}" for one in grafted.skipped],
        outline=outline,
        springs=springs,
        turns=_turns(design, patch, request),
        before=graft_figures(design) if before else None,
        after=graft_figures(grafted.design) if before else None,
    )


def graft_action(design: Design, patch: Patch, request: Graft) -> tuple[Action, list[str]]:
    """Return the action that sets a patch, and the cells to show afterwards.

    Raises `InputError`: it does not fit there, or nothing would change.
    """
    grafted = _grafted(design, patch, request)
    if not grafted.edits:
        raise InputError("the cells are like the patch already; nothing would change")
    changes: list[ValueChange | ForestChange] = []
    before = values_of(design)["cell_types"]
    after = values_of(grafted.design)["cell_types"]
    if before != after:
        changes.append(ValueChange(path=["cell_types"], before=before, after=after))
    changes.append(ForestChange(edits=grafted.edits))
    count = len(grafted.placed)
    places = "in one place" if count == 1 else f"in {count} places"
    action = Action(label=f"Graft {patch.name} {places}", changes=changes)
    faces = sorted({face for one in grafted.placed for face in one.cells})
    region = _core.Selection(design.mesh, [str(face) for face in faces])
    return action, region.expressed(grafted.design.forest)


def graft_figures(design: Design) -> GraftFigures:
    """Return what a graft changes, of a design at equilibrium."""
    equilibrium = design.solve()
    measures = design.measure(equilibrium)
    ends = np.bincount(design.network().springs.ravel(), minlength=len(design.nodes))
    ends[design.anchors] = 0
    return GraftFigures(
        springs=measures.springs,
        force_differential=measures.force_differential,
        force_max=measures.force_max,
        force_min=measures.force_min,
        dangling=int(np.count_nonzero(ends == 1)),
        converged=equilibrium.converged,
    )


def _grafted(design: Design, patch: Patch, request: PlanGraft | Graft) -> Grafted:
    """Set a patch where a request says. Raises `InputError`: it does not fit there."""
    if request.cell is not None:
        return graft(
            design,
            patch,
            at=request.cell,
            rotate=request.rotate,
            mirror=request.mirror,
            orbit=request.orbit,
        )
    names = design.anchor_names if request.anchor is None else (request.anchor,)
    if not patch.anchored:
        raise InputError(
            "was not lifted at an anchor, so its anchor corner is unknown; set it on a cell",
            key=patch.name,
        )
    around = [frames_around(design, patch, name, mirror=request.mirror) for name in names]
    frames = [row[request.rotate % len(row)] for row in around]
    orbit = request.orbit and request.anchor is not None
    grafted = graft(design, patch, at=frames, orbit=orbit)
    anchors = dict(zip(frames, names, strict=True))
    placed = tuple(replace(one, anchor=anchors.get(one.frame)) for one in grafted.placed)
    return replace(grafted, placed=placed)


def _turns(design: Design, patch: Patch, request: PlanGraft) -> int:
    """Return the steps of rotation after which the patch lies as at first."""
    if request.cell is not None:
        return 4
    names = design.anchor_names if request.anchor is None else (request.anchor,)
    rows = [len(frames_around(design, patch, name, mirror=request.mirror)) for name in names]
    return math.lcm(*rows)


def frames_around(design: Design, patch: Patch, anchor: str, *, mirror: bool) -> list[Frame]:
    """Return the frames with the patch's first corner on an anchor, from the one that fits best.

    They follow each other round the anchor, a cell a step, without those in which more of the patch
    would fall off the net; with `mirror` they are those of the other hand.
    Raises `InputError`: there is no such anchor.
    """
    vertex, core = vertex_of(design, anchor), patch.core()
    best = _core.best_frame(design.setting, core, vertex)
    if best is None:
        raise DesignError("touches no cell", key=anchor)
    ring = _faces_round(design.mesh.faces.tolist(), vertex)
    frames = [(face, corner, best[2] is not mirror) for face, corner in ring]
    misfits = dict(zip(frames, _core.misfits(design.setting, core, frames), strict=True))
    start = frames.index(min(frames, key=lambda frame: (misfits[frame], frame)))
    least = min(skipped for skipped, _ in misfits.values())
    turned = frames[start:] + frames[:start]
    return [frame for frame in turned if misfits[frame][0] == least]


def _faces_round(faces: Sequence[Sequence[int]], vertex: int) -> list[tuple[int, int]]:
    """Return faces at a vertex, each with its corner there, as they follow each other round it."""
    left = {face: row.index(vertex) for face, row in enumerate(faces) if vertex in row}
    # A border is where the way round begins, if there is one.
    after = {faces[face][(corner + 1) % 4]: face for face, corner in left.items()}
    before = {faces[face][corner - 1] for face, corner in left.items()}
    first = next((face for start, face in after.items() if start not in before), min(left))
    found = [(first, left.pop(first))]
    while left:
        face, corner = found[-1]
        following = after.get(faces[face][corner - 1])
        following = following if following in left else min(left)
        found.append((following, left.pop(following)))
    return found


def _drawn(design: Design, grafted: Grafted, positions: Floats) -> tuple[list[float], list[float]]:
    """Return borders and springs of the cells that a graft writes, as segments on the net now."""
    after = grafted.design
    network = after.network()
    places = carried(after, design.nodes, positions)
    written = {face for one in grafted.placed for face in one.cells}
    numbers = np.flatnonzero(np.isin(after.cells.squares[:, 0], sorted(written)))
    starts, items = after.cells.springs
    own = [items[starts[cell] : starts[cell + 1]] for cell in numbers]
    springs = np.unique(np.concatenate(own)) if own else np.empty(0, dtype=np.uint32)
    corners, around = after.cells.boundaries
    count: dict[tuple[int, int], int] = {}
    for cell in numbers:
        ring = around[corners[cell] : corners[cell + 1]].tolist()
        for pair in zip(ring, [*ring[1:], ring[0]], strict=True):
            ends = min(pair), max(pair)
            count[ends] = count.get(ends, 0) + 1
    # What two of the cells share lies inside.
    border = np.array([pair for pair, times in count.items() if times == 1], dtype=np.int64)
    return _segments(places, border.reshape(-1, 2)), _segments(places, network.springs[springs])


def _segments(places: Floats, pairs: NDArray[np.integer[Any]]) -> list[float]:
    found: list[float] = np.round(places[pairs], 4).reshape(-1).tolist()
    return found


__all__ = [
    "frames_around",
    "graft_action",
    "graft_figures",
    "lifted",
    "planned",
    "selected",
]
