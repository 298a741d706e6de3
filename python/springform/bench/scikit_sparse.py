"""CHOLMOD through scikit-sparse, to show what the Python layer adds to the reference."""

from __future__ import annotations

import importlib
import importlib.metadata

from ..network import Network
from .reference import Laplacian
from .timing import Effort, Timed, clocked

NAME = "scikit-sparse"


def timed(network: Network, effort: Effort) -> Timed | None:
    """Return a timer of analyse, factor and solve; None if scikit-sparse is not installed."""
    try:
        sparse = importlib.import_module("scipy.sparse")
        cholmod = importlib.import_module("sksparse.cholmod")
    except ImportError:
        return None
    matrix = Laplacian.of(network)
    size = len(matrix.starts) - 1
    lower = sparse.csc_matrix((matrix.values, matrix.rows, matrix.starts), shape=(size, size))

    def work() -> object:
        factor = cholmod.analyze(lower, mode="simplicial", ordering_method="amd")
        factor.cholesky_inplace(lower)
        return factor(matrix.sides)

    return clocked(work, effort)


def version() -> str | None:
    """Return the version of scikit-sparse; None if it is not installed."""
    try:
        return importlib.metadata.version(NAME)
    except importlib.metadata.PackageNotFoundError:
        return None
