"""What an action would do, before it is done: counts, figures and the springs that would come."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats
from ..design import Design
from .changes import Action
from .document import Document
from .messages import PreviewState
from .motion import carried
from .telling import figures_of

_MOST_SPRINGS = 6_000
"""New springs that are told one by one; beyond it only their number is."""


def preview_of(document: Document, action: Action, positions: Floats) -> PreviewState:
    """Return what an action would do to a document; nothing changes.

    `positions` are those of the nodes now, (n, 3) [m]. Raises `DesignError`: it does not fit.
    """
    before = document.design
    _, after = document.prepared(action)
    had, has = _springs(before), _springs(after)
    old_cells, new_cells = set(before.cells.addresses), set(after.cells.addresses)
    new = [place for pair, place in has.items() if pair not in had]
    gone = [place for pair, place in had.items() if pair not in has]
    placed = carried(after, before.nodes, positions)
    return PreviewState(
        springs_added=len(new),
        springs_removed=len(gone),
        cells_added=len(new_cells - old_cells),
        cells_removed=len(old_cells - new_cells),
        figures=figures_of(after),
        added=_lines(after, new, placed),
        removed=_lines(before, gone, positions),
    )


def _springs(design: Design) -> dict[frozenset[str], int]:
    nodes = design.nodes
    pairs = design.network().springs.tolist()
    return {frozenset((nodes[a], nodes[b])): row for row, (a, b) in enumerate(pairs)}


def _lines(design: Design, springs: list[int], positions: Floats) -> list[float]:
    if len(springs) > _MOST_SPRINGS:
        return []
    ends = positions[design.network().springs[springs]]
    flat: list[float] = np.round(ends, 5).reshape(-1).tolist()
    return flat
