"""The nets that are timed: each is made here, once, from few numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..design import Design, load
from ..design_file import parse
from ..evolution import evolve
from ..network import Network

Whole = NDArray[np.int64]

CABLE_STIFFNESS = 4.0
"""Axial stiffness EA of the boundary cables [N], that of net springs being 1."""

ANCHORS = 8
"""Anchors on each end ring of a cylinder."""

TOP_LEVEL_SPRINGS = 10.5
"""Springs a top-level cell of the large designs comes to, near enough."""


@dataclass(frozen=True)
class Cords:
    """A net of cords: where its nodes are drawn, and the law of every spring."""

    positions: Floats
    """(n, 3) start positions [m]: drawn ones, or taken over from a parent."""
    springs: NDArray[np.uint32]
    """(m, 2) nodes of every spring."""
    axial_stiffness: Floats
    """(m,) EA [N]."""
    rest_length: Floats
    """(m,) unstressed length L0 [m]."""
    fixed: NDArray[np.bool_]
    """(n,) anchors."""

    def network(self) -> Network:
        """Return the network: both senses, no loads."""
        return Network(
            self.positions,
            self.springs,
            self.fixed,
            axial_stiffness=self.axial_stiffness,
            rest_length=self.rest_length,
        )


@dataclass(frozen=True)
class Cylinder:
    """A periodic dia-grid on a cylinder of radius 1 m, anchored at eight nodes of each end ring.

    ```text
    row 1    o   o   o      every second row is turned by half a step, so
            / \\ / \\ / \\     that a node has two springs up and two down;
    row 0  o   o   o   o    with cables, the end rings are springs, too
    ```
    """

    around: int
    """Nodes of a row."""
    rows: int
    """Rows of springs: one less than rows of nodes."""
    cables: bool = False
    """Whether the end rings have boundary cables of four times the axial stiffness."""

    @classmethod
    def of(cls, springs: int) -> Cylinder:
        """Return the cylinder of about so many springs that is as high as it is wide."""
        around = 4 * round((springs * math.pi / 4) ** 0.5 / 4)
        return cls(around, 4 * round(around * (2 / math.pi) / 4))

    def __str__(self) -> str:
        cables = ", cables" if self.cables else ""
        return f"cylinder {self.around} x {self.rows}{cables}"

    def net(self, rest_ratio: float) -> Cords:
        """Return the net, drawn with square diamonds; rest lengths are a ratio of drawn lengths.

        The 2 around rows springs of EA = 1 N come first, then any cables of EA = 4 N.
        """
        nodes = self.around * (self.rows + 1)
        row, column = np.divmod(np.arange(nodes), self.around)
        angle = (column + 0.5 * (row % 2)) * (2 * np.pi / self.around)
        height = row * (np.pi / self.around)
        positions = np.column_stack([np.cos(angle), np.sin(angle), height])
        below = row < self.rows
        springs = [
            np.column_stack([self._node(row, column), self._above(row, column, side)])[below]
            for side in (0, 1)
        ]
        ring = np.arange(self.around)
        ends = (0, self.rows) if self.cables else ()
        springs += [
            np.column_stack([self._node(end, ring), self._node(end, ring + 1)]) for end in ends
        ]
        pairs = np.concatenate(springs).astype(np.uint32)
        stiffness = np.ones(len(pairs))
        stiffness[2 * self.around * self.rows :] = CABLE_STIFFNESS
        fixed = np.zeros(nodes, dtype=np.bool_)
        held = np.arange(ANCHORS) * self.around // ANCHORS
        fixed[self._node(0, held)] = fixed[self._node(self.rows, held)] = True
        rest = rest_ratio * spring_lengths(positions, pairs)
        return Cords(positions, pairs, stiffness, rest, fixed)

    def diamonds(self) -> list[list[int]]:
        """Return the four nodes of every diamond: lowest, the two above it, highest."""
        row, column = np.divmod(np.arange(self.around * (self.rows - 1)), self.around)
        sides = [self._above(row, column, side) for side in (0, 1)]
        corners = [self._node(row, column), *sides, self._node(row + 2, column)]
        found: list[list[int]] = np.column_stack(corners).tolist()
        return found

    def _node(self, row: Whole | int, column: Whole) -> Whole:
        return row * self.around + column % self.around

    def _above(self, row: Whole, column: Whole, side: int) -> Whole:
        """The node above in the same column, or the other that a half turn brings beside it."""
        return self._node(row + 1, column + np.where(row % 2 == 1, side, -side))


def child_of(
    shape: Cylinder,
    parent: Cords,
    equilibrium: Floats,
    seed: int,
    *,
    subdivisions: int = 3,
    changes: int = 5,
) -> Cords:
    """Return a child of a cylinder's net, starting at its parent's equilibrium.

    As many diamonds as `subdivisions` are divided into four: their sides are halved and their
    middle gets a node. As many further springs as `changes` get a rest length up to 20 % longer
    or shorter. New nodes start in the middle of the nodes that they divide.
    """
    random = np.random.default_rng(seed)
    number = {(int(a), int(b)): at for at, (a, b) in enumerate(parent.springs)}
    ratio = parent.rest_length[0] / spring_lengths(parent.positions, parent.springs[:1])[0]
    drawn, start = list(parent.positions), list(equilibrium)
    springs: list[tuple[int, int]] = []
    stiffness: list[float] = []
    rest: list[float] = []
    gone: set[int] = set()

    def middle_of(nodes: list[int]) -> int:
        for places in (drawn, start):
            places.append(np.mean([places[node] for node in nodes], axis=0))
        return len(drawn) - 1

    for bottom, right, left, top in random.permutation(shape.diamonds()).tolist():
        if len(gone) == 4 * subdivisions:
            break
        pairs = [(bottom, right), (bottom, left), (right, top), (left, top)]
        sides = [number[pair] for pair in pairs]
        if gone.intersection(sides):
            continue
        gone.update(sides)
        centre = middle_of([bottom, right, left, top])
        for side, (a, b) in zip(sides, pairs, strict=True):
            middle = middle_of([a, b])
            springs += [(a, middle), (middle, b), (middle, centre)]
            stiffness += [parent.axial_stiffness[side]] * 2 + [1.0]
            spoke = np.linalg.norm(drawn[middle] - drawn[centre])
            rest += [parent.rest_length[side] / 2] * 2 + [float(ratio * spoke)]
    kept = np.setdiff1d(np.arange(len(parent.springs)), list(gone))
    kept_rest = parent.rest_length[kept].copy()
    changed = random.choice(len(kept), changes, replace=False)
    kept_rest[changed] *= random.uniform(0.8, 1.2, changes)
    fixed = np.zeros(len(start), dtype=np.bool_)
    fixed[: len(parent.fixed)] = parent.fixed
    return Cords(
        np.array(start),
        np.concatenate([parent.springs[kept], np.array(springs, dtype=np.uint32)]),
        np.concatenate([parent.axial_stiffness[kept], stiffness]),
        np.concatenate([kept_rest, rest]),
        fixed,
    )


def evolved(scene: str, springs: int, types: tuple[str, ...], method: str) -> Design:
    """Return a packaged scene evolved until it has so many springs, the same each time."""
    run = evolve(
        load(scene).with_method(method),
        population=20,
        generations=1000,
        types=types,
        insertions="5",
        fitness="differential",
        seed=1,
        until_springs=springs,
    )
    return run.best


def large_design(springs: int) -> Design:
    """Return a one-cylinder dia-grid of about so many springs, from an irregular forest.

    Top-level cells are subdivided once; one in eight is of type 6 within, one in eight has a child
    that is subdivided again, drawn from a fixed seed. Eight anchors a ring.
    """
    along = round((springs / TOP_LEVEL_SPRINGS / 2) ** 0.5)
    around = 2 * along
    random = np.random.default_rng(1)
    cells = []
    for face in range(around * along):
        children = ["1", "1", "1", "1"]
        draw = random.integers(0, 8)
        if draw == 0:
            children = ["6", "6", "6", "6"]
        elif draw == 1:
            children[random.integers(0, 4)] = "1(1 1 1 1)"
        else:
            continue
        cells.append(f'{face} = "1({" ".join(children)})"')
    anchors = []
    for end, height in (("start", 0.0), ("end", float(along))):
        for index in range(ANCHORS):
            at = index * around // ANCHORS
            angle, radius = 2 * np.pi * at / around, 0.5 * along
            x, y = float(radius * np.cos(angle)), float(radius * np.sin(angle))
            anchors.append(
                f'[[framework.anchors]]\nring = "tube.{end}"\nindex = {at}\n'
                f"position = [{x!r}, {y!r}, {height!r}]\n"
            )
    text = "\n".join(
        [
            'springform = 1\nname = "large"\nmethod = "dynamic"\n',
            '[framework]\ngrid = "dia"\nlevel = 1\n',
            f'[[framework.cylinders]]\nname = "tube"\naround = {around}\nalong = {along}\n',
            *anchors,
            "[forest.cells]",
            *cells,
        ]
    )
    return Design(parse(text, "toml", "large.toml"))


def spring_lengths(positions: Floats, springs: NDArray[np.uint32]) -> Floats:
    """Return the length of every spring [m], (m,)."""
    lengths: Floats = np.linalg.norm(positions[springs[:, 1]] - positions[springs[:, 0]], axis=1)
    return lengths


def relative_residual(network: Network, positions: Floats) -> float:
    """Return the largest force out of balance at a free node over the mean spring force.

    Written anew in NumPy, so that every engine is judged by the same code, which is none of theirs.
    In a net that is all but slack a millionth of what a spring would carry if it were stretched by
    the whole net stands for the mean, as in `springform.solve`.
    """
    ends = network.springs.astype(np.int64)
    along = positions[ends[:, 1]] - positions[ends[:, 0]]
    lengths = np.linalg.norm(along, axis=1)
    forces = network.force + network.stiffness * (lengths - network.rest_length)
    pull = along * (forces / lengths)[:, None]
    nodes = len(positions)
    sums = np.empty((nodes, 3))
    for axis in range(3):
        sums[:, axis] = np.bincount(ends[:, 0], pull[:, axis], nodes)
        sums[:, axis] -= np.bincount(ends[:, 1], pull[:, axis], nodes)
    free = ~network.fixed
    held = network.positions[network.fixed]
    span = (held.max(axis=0) - held.min(axis=0)).max()
    stretched = (network.stiffness * np.maximum(network.rest_length, span)).max()
    scale = max(np.abs(forces).mean(), 1e-6 * stretched)
    return float(np.linalg.norm(sums[free], axis=1).max() / scale)
