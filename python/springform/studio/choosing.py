"""Choosing among the individuals of a run: what is brushed, and clusters of it.

Clusters are k-means++ with scipy (Arthur and Vassilvitskii, "k-means++: the advantages of careful
seeding", 2007); every axis counts alike, by its spread.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2  # type: ignore[import-untyped]  # scipy has no types

from ..errors import InputError

AXES = (
    "springs",
    "force_differential",
    "suf",
    "force_max",
    "force_min",
    "shortest_spring",
    "total_length",
)
"""Columns by which individuals are told apart; `generation` is another axis."""

_CLUSTERED = ("springs", "force_differential", "force_max")
_LOGARITHMIC = frozenset({"force_differential"})
_SEED = 1
_ROUNDS = 40


def brushed(
    columns: Mapping[str, NDArray[Any]], brushes: Mapping[str, Sequence[float]]
) -> NDArray[np.bool_]:
    """Return which rows lie within (least, most) on every axis that is brushed, (n,).

    What is undefined lies within nothing. Raises `InputError`: there is no such axis.
    """
    chosen: NDArray[np.bool_] = np.isfinite(columns["force_differential"])
    for axis, (least, most) in brushes.items():
        if axis not in columns:
            raise InputError(f"there is no such axis; there are {', '.join(columns)}", key=axis)
        chosen &= (columns[axis] >= least) & (columns[axis] <= most)
    return chosen


def clusters(
    columns: Mapping[str, NDArray[Any]], rows: NDArray[np.int64], count: int
) -> list[tuple[int, int]]:
    """Return (row, size) of the individual nearest to the middle of each cluster, largest first.

    By springs, force differential and largest force; the same for the same rows. Raises
    `InputError`: a number of clusters that is not allowed.
    """
    if not 1 <= count <= 100:
        raise InputError(f"must be 1 to 100, not {count}", key="count")
    if not len(rows):
        return []
    points = np.column_stack([_spread(name, columns[name][rows]) for name in _CLUSTERED])
    most = min(count, len(np.unique(points, axis=0)))
    random = np.random.default_rng(_SEED)
    middles, labels = kmeans2(points, most, iter=_ROUNDS, minit="++", rng=random)
    found = []
    for label in range(len(middles)):
        members = np.flatnonzero(labels == label)
        if len(members):
            distances = ((points[members] - middles[label]) ** 2).sum(axis=1)
            found.append((int(rows[members[distances.argmin()]]), len(members)))
    return sorted(found, key=lambda one: (-one[1], one[0]))


def _spread(name: str, values: NDArray[Any]) -> NDArray[np.float64]:
    known = np.asarray(values, dtype=np.float64)
    known = np.log(known) if name in _LOGARITHMIC else known
    deviation = float(known.std())
    spread: NDArray[np.float64] = (known - known.mean()) / (deviation if deviation > 0 else 1.0)
    return spread
