"""Cell types as small drawings: the springs inside a cell, as its type and turn place them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..design import Design
from .view import Floats

NULL = "0"
"""The type without springs."""

_POINTS = {
    **{f"c{k}": point for k, point in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)])},
    **{f"m{k}": point for k, point in enumerate([(0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5)])},
    "x": (0.5, 0.5),
}
_FAN = tuple(f"x-{point}" for point in _POINTS if point != "x")
_BUILT_IN = {
    "0": (),
    "1": (),
    "2": ("x-c0", "x-c1", "x-c2", "x-c3"),
    "3": ("c0-c2",),
    "4": ("m0-m2",),
    "5": ("m0-m1", "m1-m2", "m2-m3", "m3-m0"),
    "6": _FAN,
}
_NAMES = {
    "0": "0 null",
    "1": "1 quad",
    "2": "2 braced",
    "3": "3 diagonal",
    "4": "4 strip",
    "5": "5 inscribed",
    "6": "6 dynamic",
}


def type_name(kind: str) -> str:
    """Return how a type is called in a legend: number and name, or the name it was given."""
    return _NAMES.get(kind, kind)


def type_words(design: Design, cells: NDArray[np.intp]) -> list[str]:
    """Return type and turn of every cell as expressed, such as ``3@1``."""
    forest, setting = design.closed.forest, design.setting
    words = []
    for cell in cells:
        kind = design.cells.types[cell]
        stored, _, _ = setting.cell(forest, design.cells.addresses[cell])
        # A cell may be expressed as another type than it stores: then its turn has no meaning.
        words.append(stored if stored.split("@")[0] == kind else kind)
    return words


def pattern(design: Design, word: str) -> Floats:
    """Return the springs (s, 2, 2) of a type and turn inside the unit square, a little shrunk."""
    kind, _, turn = word.partition("@")
    own = design.file.cell_types.get(kind)
    springs: tuple[str, ...] = _BUILT_IN.get(kind, ())
    if own is not None:
        springs = (*own.springs, *(_FAN if own.fan else ()))
    ends = [[_turned(point, int(turn or 0)) for point in spring.split("-")] for spring in springs]
    return 0.5 + 0.76 * (np.array(ends, dtype=np.float64).reshape(-1, 2, 2) - 0.5)


def _turned(point: str, turn: int) -> tuple[float, float]:
    return _POINTS[point if point == "x" else f"{point[0]}{(int(point[1]) + turn) % 4}"]
