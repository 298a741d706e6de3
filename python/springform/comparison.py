"""Two designs compared: by cells, by springs, and by where force moved."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from .arrays import Floats
from .design import Design, Measures
from .network import Equilibrium

Pair = tuple[int, int]
"""Of the first and of the second design."""


@dataclass(frozen=True)
class Moved:
    """The inner force of a top-level cell in both designs: the sum over its expressed cells."""

    cell: int
    """The top-level cell."""
    before: float
    """In the first design [N]."""
    after: float
    """In the second design [N]."""

    @property
    def change(self) -> float:
        """How much force came to the cell [N]."""
        return self.after - self.before


@dataclass(frozen=True)
class Comparison:
    """What differs between two designs."""

    measures: tuple[Measures, Measures]
    """Of both."""
    types: dict[str, Pair]
    """Expressed cells by type."""
    levels: dict[int, Pair]
    """Expressed cells by level."""
    same_framework: bool
    """Both have the same base mesh, so that cells and forces can be compared one by one."""
    changed: tuple[int, ...]
    """Top-level cells whose subtrees differ; empty on different frameworks."""
    moved: tuple[Moved, ...]
    """Top-level cells by how much force came or went, most first; empty on other frameworks."""


def compare(
    first: Design, second: Design, equilibria: tuple[Equilibrium, Equilibrium] | None = None
) -> Comparison:
    """Compare two designs; `equilibria` saves solving them again.

    Raises `DesignError`: one of them gives no net.
    """
    first, second = first.closed, second.closed
    solved = equilibria or (first.solve(), second.solve())
    same = np.array_equal(first.mesh.faces, second.mesh.faces)
    changed: tuple[int, ...] = ()
    moved: list[Moved] = []
    if same:
        notes = [one.setting.notation(one.forest, "")[0] for one in (first, second)]
        trees = [_expanded(one, note) for one, note in zip((first, second), notes, strict=True)]
        changed = tuple(cell for cell in trees[0] if trees[0][cell] != trees[1][cell])
        pairs = zip(cell_forces(first, solved[0]), cell_forces(second, solved[1]), strict=True)
        moved = [Moved(cell, float(a), float(b)) for cell, (a, b) in enumerate(pairs)]
        moved.sort(key=lambda one: (-abs(one.change), one.cell))
    types = Counter(first.cells.types), Counter(second.cells.types)
    levels = _levels(first), _levels(second)
    return Comparison(
        measures=(first.measure(solved[0]), second.measure(solved[1])),
        types={kind: (types[0][kind], types[1][kind]) for kind in sorted({*types[0], *types[1]})},
        levels={key: (levels[0][key], levels[1][key]) for key in sorted({*levels[0], *levels[1]})},
        same_framework=same,
        changed=changed,
        moved=tuple(one for one in moved if one.change),
    )


def cell_forces(design: Design, equilibrium: Equilibrium) -> Floats:
    """Return the inner force of every top-level cell, (f,) [N]."""
    faces = design.cells.squares[:, 0].astype(np.intp)
    weights = design.inner_forces(equilibrium)
    forces = np.bincount(faces, weights=weights, minlength=len(design.mesh.faces))
    return forces.astype(np.float64)


def _expanded(design: Design, notation: dict[int, str]) -> dict[int, str]:
    """Every top-level cell in notation, those of genes as what they hold."""
    held = [face for _, _, faces in design.setting.instances(design.forest) for face in faces]
    trees = {cell: notation.get(cell, "") for cell in range(len(design.mesh.faces))}
    return trees | {face: design.setting.tree(design.forest, face) for face in held}


def _levels(design: Design) -> Counter[int]:
    return Counter(int(level) for level in design.cells.squares[:, 1])
