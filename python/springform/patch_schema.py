"""The schema of patches: cells by their walks from a seed, in files and as genes of a design."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

from pydantic import AfterValidator, Field

from .schema_base import Section, fault
from .wording import shown

WALK_PATTERN = r"^[flrb]?[flr]*$"
"""How a walk is written."""

FREE_PATTERN = r"^b?r?f?l?$"
"""How free sides are written."""

PATH_PATTERN = r"^([0-3](\.[0-3])*)?$"
"""How a path of children is written."""


class PatchCell(Section):
    """What a patch holds of one top-level cell."""

    walk: Annotated[str, Field(pattern=WALK_PATTERN)] = ""
    """Steps from the seed across edges: f ahead, l and r to the left and right, b back."""
    free: Annotated[str, Field(pattern=FREE_PATTERN)] = ""
    """Sides that were free edges where it comes from, as the walker sees them."""
    path: Annotated[str, Field(pattern=PATH_PATTERN)] = ""
    """Children down to the cell, as the walker sees them; empty for the top-level cell."""
    cell: str
    """Cell notation, as the walker sees it."""


def _check_patch_cells(cells: tuple[PatchCell, ...]) -> tuple[PatchCell, ...]:
    places = sorted((cell.walk, cell.path) for cell in cells)
    for (walk, above), (other, path) in pairwise(places):
        if walk == other and f"{path}.".startswith(f"{above}." if above else ""):
            raise fault((), f"walk {shown(walk)}, path {shown(path)} is there twice; remove one")
    if all(cell.walk for cell in cells):
        raise fault((), 'no cell has the walk ""; the seed is missing')
    return cells


PatchCells = Annotated[
    tuple[PatchCell, ...], Field(strict=False, min_length=1), AfterValidator(_check_patch_cells)
]

CorePatch = tuple[bool, list[tuple[str, list[int], list[tuple[str, str]]]]]
"""A patch as the core takes it: whether corner 0 is an anchor; walk, free sides, subtrees."""

SIDES = "brfl"
"""Sides 0 to 3 of a cell as the walker sees them: back, right, forward, left."""


def core_patch(anchored: bool, cells: tuple[PatchCell, ...]) -> CorePatch:
    """Return cells of a patch as the core takes them."""
    rows: dict[str, tuple[list[int], list[tuple[str, str]]]] = {}
    for cell in cells:
        free = [SIDES.index(side) for side in cell.free]
        rows.setdefault(cell.walk, (free, []))[1].append((cell.path, cell.cell))
    return anchored, [(walk, free, texts) for walk, (free, texts) in rows.items()]


def cells_of(core: CorePatch) -> tuple[PatchCell, ...]:
    """Return the cells of a patch as the core gives it."""
    return tuple(
        PatchCell(walk=walk, free="".join(SIDES[side] for side in free), path=path, cell=text)
        for walk, free, texts in core[1]
        for path, text in texts
    )


class Gene(Section):
    """A patch that the forest holds by reference, such as `12 = "&crown@1m"`."""

    anchored: bool = False
    """Corner 0 of the seed lies on an anchor."""
    cells: PatchCells
    """Its cells; each changes in all places at once."""
