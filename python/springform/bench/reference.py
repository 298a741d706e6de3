"""The reference: CHOLMOD's analyse, factor and solve of a net's Laplacian, three columns."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..errors import SpringformError
from ..network import Network
from .timing import Timed

LIBRARY = "SPRINGFORM_REFERENCE"
"""Environment variable that names the shared library built from bench/cholmod.c."""

STAGES = ("analyse", "factor", "solve")

LARGE = 100_000
"""Springs from which METIS and threads of the BLAS are tried, too."""


class ReferenceError(SpringformError):
    """The reference refuses a matrix or solves it wrongly."""


@dataclass(frozen=True)
class Laplacian:
    """A net's Laplacian over its free nodes, weighted by stiffness, and three right-hand sides."""

    starts: NDArray[np.int32]
    """(n + 1,) starts of the columns of the lower triangle."""
    rows: NDArray[np.int32]
    """Rows, ascending within a column."""
    values: Floats
    """Entries [N/m]."""
    sides: Floats
    """(n, 3) Fortran order [N]: what the anchors pull."""

    @classmethod
    def of(cls, network: Network) -> Laplacian:
        """Return the Laplacian of a network."""
        number = np.cumsum(~network.fixed) - 1
        ends, k = network.springs.astype(np.int64), network.stiffness
        free = ~network.fixed[ends]
        size = int((~network.fixed).sum())
        diagonal = np.zeros(size)
        sides = np.zeros((size, 3), order="F")
        for own, far in ((0, 1), (1, 0)):
            at = number[ends[:, own]]
            diagonal += np.bincount(at[free[:, own]], k[free[:, own]], size)
            held = free[:, own] & ~free[:, far]
            pull = k[held, None] * network.positions[ends[held, far]]
            for axis in range(3):
                sides[:, axis] += np.bincount(at[held], pull[:, axis], size)
        both = free.all(axis=1)
        pairs = number[ends[both]]
        rows = np.concatenate([np.arange(size), pairs.max(axis=1)])
        columns = np.concatenate([np.arange(size), pairs.min(axis=1)])
        values = np.concatenate([diagonal, -k[both]])
        order = np.lexsort((rows, columns))
        starts = np.concatenate([[0], np.cumsum(np.bincount(columns, minlength=size))])
        return cls(starts.astype(np.int32), rows[order].astype(np.int32), values[order], sides)

    def times(self, x: Floats) -> Floats:
        """Return the product with (n, 3) vectors."""
        columns = np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))
        product = np.zeros_like(x)
        for axis in range(x.shape[1]):
            below = self.values * x[columns, axis]
            product[:, axis] += np.bincount(self.rows, below, len(x))
            off = self.rows != columns
            above = self.values[off] * x[self.rows[off], axis]
            product[:, axis] += np.bincount(columns[off], above, len(x))
        return product


@dataclass(frozen=True)
class Variant:
    """One way of factoring, and on how many threads of the BLAS."""

    metis: bool
    supernodal: bool
    threads: int

    @property
    def name(self) -> str:
        """Such as ``cholmod AMD simplicial``."""
        words = ["cholmod", "METIS" if self.metis else "AMD"]
        words.append("supernodal" if self.supernodal else "simplicial")
        if self.threads > 1:
            words.append(f"{self.threads} threads")
        return " ".join(words)


class Reference:
    """CHOLMOD on one net, by whichever variant is fastest."""

    def __init__(self, network: Network) -> None:
        """Assemble the matrix, try the variants and keep the fastest."""
        self.matrix = Laplacian.of(network)
        cores = os.cpu_count() or 1
        large = len(network.springs) >= LARGE
        variants = [
            Variant(metis, supernodal, threads)
            for metis in ((False, True) if large else (False,))
            for supernodal in (False, True)
            for threads in sorted({1, cores if large and supernodal else 1})
        ]
        self.tried = {variant: self._trial(variant, large) for variant in variants}
        self.variant = min(self.tried, key=lambda variant: self.tried[variant])
        size = len(self.matrix.starts) - 1
        self._sample = 1 if large else max(1, round(2e4 / size))

    @property
    def name(self) -> str:
        """What was fastest."""
        return self.variant.name

    def timed(self) -> Timed:
        """Return a timer of one analyse, factor and solve: the median of a sample."""
        return lambda: float(np.median(self.stages(self._sample).sum(axis=1)))

    def stages(self, repeats: int, variant: Variant | None = None) -> Floats:
        """Return the seconds of every stage, (repeats, 3)."""
        library, blas = _library(), _blas()
        variant = variant or self.variant
        if blas is not None:
            blas.openblas_set_num_threads(variant.threads)
        size = len(self.matrix.starts) - 1
        seconds = np.zeros((repeats, 3))
        solution = np.zeros((size, 3), order="F")
        fill = ctypes.c_double()
        status = library.reference_run(
            size,
            _pointer(self.matrix.starts, ctypes.c_int),
            _pointer(self.matrix.rows, ctypes.c_int),
            _pointer(self.matrix.values, ctypes.c_double),
            _pointer(self.matrix.sides, ctypes.c_double),
            int(variant.metis),
            int(variant.supernodal),
            repeats,
            _pointer(seconds, ctypes.c_double),
            _pointer(solution, ctypes.c_double),
            ctypes.byref(fill),
        )
        if status != 0:
            raise ReferenceError(f"CHOLMOD refuses the matrix with status {status}")
        self._solution = solution
        return seconds

    def _trial(self, variant: Variant, large: bool) -> float:
        best = float(self.stages(2 if large else 20, variant).sum(axis=1).min())
        out = self.matrix.times(self._solution) - self.matrix.sides
        error = float(np.abs(out).max() / np.abs(self.matrix.sides).max())
        if not error < 1e-8:
            raise ReferenceError(f"{variant.name} solves with an error of {error:.1e}")
        return best


def available() -> bool:
    """Return whether the library has been built and can be loaded."""
    try:
        _library()
    except OSError:
        return False
    return True


def versions() -> dict[str, str]:
    """Return what the reference consists of."""
    numbers = (ctypes.c_int * 3)()
    _library().reference_version(numbers)
    found = {"cholmod": ".".join(map(str, numbers))}
    blas = _blas()
    if blas is None:
        found["blas"] = "not OpenBLAS"
    else:
        for name in ("openblas_get_config", "openblas_get_corename"):
            getattr(blas, name).restype = ctypes.c_char_p
        found["blas"] = blas.openblas_get_config().decode().strip()
    return found


@cache
def _library() -> ctypes.CDLL:
    path = os.environ.get(LIBRARY)
    if not path:
        raise FileNotFoundError(LIBRARY)
    return ctypes.CDLL(str(Path(path).resolve()))


@cache
def _blas() -> ctypes.CDLL | None:
    """The BLAS that CHOLMOD calls, if it is OpenBLAS."""
    _library()
    try:
        blas = ctypes.CDLL("libblas.so.3")
        blas.openblas_set_num_threads  # noqa: B018  # there or not
    except (OSError, AttributeError):
        return None
    return blas


def _pointer(array: NDArray[Any], kind: Any) -> Any:
    return array.ctypes.data_as(ctypes.POINTER(kind))
