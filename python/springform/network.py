"""Bare networks and their equilibrium: inputs and results are separate types."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .errors import InputError

Floats = NDArray[np.float64]
Solver = Literal["direct", "implicit-euler"]

TOLERANCE = 1e-9
"""Largest residual at a free node over the mean spring force at which a net counts as solved."""

_ITERATIONS = {"direct": 200, "implicit-euler": 5000}


class Network:
    """Springs between nodes: the inputs of a solve. n nodes, m springs; the arrays are read-only.

    Spring force F = k (L - r) [N]: k stiffness [N/m], L length [m], r rest length [m].

    Attributes: `positions` (n, 3) start positions [m]; `springs` (m, 2) node numbers; `fixed` (n,)
    bool; `stiffness` (m,) [N/m]; `rest_length` (m,) [m]; `loads` (n, 3) [N].
    """

    positions: Floats
    springs: NDArray[np.uint32]
    fixed: NDArray[np.bool_]
    stiffness: Floats
    rest_length: Floats
    loads: Floats

    def __init__(
        self,
        positions: ArrayLike,
        springs: ArrayLike,
        fixed: ArrayLike,
        *,
        stiffness: ArrayLike = 1.0,
        rest_length: ArrayLike = 0.0,
        loads: ArrayLike | None = None,
    ) -> None:
        """Check and hold the arrays; arrays of the right type are shared, not copied.

        `fixed` is one bool a node, or the numbers of the fixed nodes. `stiffness` and
        `rest_length` are one number, or one a spring. `loads` are one vector a node; none if None.
        Raises `InputError`: a shape or value that does not fit.
        """
        self.positions = _numbers("positions", positions, (None, 3))
        nodes = len(self.positions)
        self.springs = _node_numbers("springs", springs, nodes)
        if self.springs.ndim != 2 or self.springs.shape[1] != 2:
            raise _wrong_shape("springs", self.springs.shape, "(m, 2)")
        self.fixed = _mask(fixed, nodes)
        count = len(self.springs)
        self.stiffness = _numbers("stiffness", stiffness, (count,))
        self.rest_length = _numbers("rest_length", rest_length, (count,))
        self.loads = _numbers("loads", 0.0 if loads is None else loads, (nodes, 3))

    def __repr__(self) -> str:
        return (
            f"Network({len(self.positions)} nodes, {len(self.springs)} springs, "
            f"{int(self.fixed.sum())} fixed)"
        )


@dataclass(frozen=True)
class Equilibrium:
    """Result of a solve: n nodes, m springs; arrays in the order of the network's."""

    positions: Floats
    """(n, 3) [m]."""
    forces: Floats
    """(m,) [N], tension positive."""
    residual: float
    """Largest force out of balance at a free node over the mean spring force."""
    converged: bool
    """The residual is within the tolerance."""
    iterations: int
    """Iterations made: linear solves, Newton steps, or Euler steps."""
    reason: str
    """Why the net did not converge; empty if it did."""
    seconds: float = field(compare=False)
    """Time of the solve [s]."""


def solve(
    network: Network,
    *,
    tolerance: float = TOLERANCE,
    solver: Solver = "direct",
    iterations: int | None = None,
) -> Equilibrium:
    """Solve a network; the interpreter lock is free meanwhile.

    "direct" factors the stiffness matrix (with rest lengths: Newton's method); "implicit-euler"
    moves the net step by step, as the paper does (footnote 1). A net that finds no equilibrium is
    no error: see `converged` and `reason`. Raises `InputError`: the network or solver is refused.
    """
    if solver not in _ITERATIONS:
        raise InputError(f"unknown solver '{solver}'; use direct or implicit-euler", key="solver")
    _check("tolerance", tolerance)
    limit = _ITERATIONS[solver] if iterations is None else iterations
    if not 0 <= limit < 2**31:
        raise InputError(f"must be 0 to {2**31 - 1}, not {limit}", key="iterations")
    start = time.perf_counter()
    try:
        result = _core.solve(network, tolerance, limit, solver)
    except _core.CoreError as error:
        key, problem = error.args
        raise InputError(problem, key=key) from None
    return Equilibrium(**result, seconds=time.perf_counter() - start)


def animate(
    network: Network,
    *,
    step: float = 0.5,
    drag: float = 1.0,
    growth: float = 1.0,
    tolerance: float = TOLERANCE,
) -> Iterator[Equilibrium]:
    """Move a network to equilibrium by implicit Euler steps, and yield the state after each.

    `step` is the time step in units in which a node's mass equals its springs' stiffness, `drag`
    the force against velocity per unit of mass, `growth` a factor on the step after every step.
    Ends once converged. Raises `InputError`: the network is refused.
    """
    for name, value in {"step": step, "growth": growth, "tolerance": tolerance}.items():
        _check(name, value)
    _check("drag", drag, least=0)
    try:
        euler = _core.ImplicitEuler(network, step, growth, drag)
    except _core.CoreError as error:
        key, problem = error.args
        raise InputError(problem, key=key) from None
    while True:
        start = time.perf_counter()
        state = Equilibrium(**euler.advance(tolerance), seconds=time.perf_counter() - start)
        yield state
        if state.converged:
            return


def residuals(network: Network) -> Floats:
    """Return the force out of balance at every free node of a network as it stands, (n, 3) [N]."""
    return _core.residuals(network)


def _check(name: str, value: float, least: float | None = None) -> None:
    if not math.isfinite(value) or (value <= 0 if least is None else value < least):
        bound = "above 0" if least is None else f"at least {least}"
        raise InputError(f"must be finite and {bound}, not {value}", key=name)


def _wrong_shape(name: str, shape: tuple[int, ...], expected: str) -> InputError:
    return InputError(f"has shape {shape}, not {expected}", key=name)


def _array(name: str, values: ArrayLike, dtype: Any = None) -> NDArray[Any]:
    try:
        return np.asarray(values, dtype=dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"is no array of numbers: {error}", key=name) from None


def _read_only(array: NDArray[Any]) -> NDArray[Any]:
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


def _numbers(name: str, values: ArrayLike, shape: tuple[int | None, ...]) -> Floats:
    array = _array(name, values, np.float64)
    if array.ndim == 0 and None not in shape:
        array = np.full(shape, array)  # type: ignore[arg-type]
    fits = array.ndim == len(shape) and all(
        wanted is None or wanted == found for wanted, found in zip(shape, array.shape, strict=True)
    )
    if not fits:
        words = ", ".join("n" if size is None else str(size) for size in shape)
        raise _wrong_shape(name, array.shape, f"({words})" if len(shape) > 1 else f"({words},)")
    return _read_only(array)


def _node_numbers(name: str, values: ArrayLike, nodes: int) -> NDArray[np.uint32]:
    array = _array(name, values)
    if array.size == 0:
        array = array.reshape(0, 2).astype(np.uint32)
    if not np.issubdtype(array.dtype, np.integer):
        raise InputError("must hold whole numbers of nodes", key=name)
    if array.size and (array.min() < 0 or array.max() >= nodes):
        raise InputError(f"names a node that does not exist; there are {nodes}, from 0", key=name)
    return _read_only(array.astype(np.uint32, copy=False))


def _mask(fixed: ArrayLike, nodes: int) -> NDArray[np.bool_]:
    array = _array("fixed", fixed)
    if array.dtype == np.bool_:
        if array.shape != (nodes,):
            raise _wrong_shape("fixed", array.shape, f"({nodes},)")
        return _read_only(array)
    numbers = _node_numbers("fixed", array.reshape(-1), nodes)
    mask = np.zeros(nodes, dtype=np.bool_)
    mask[numbers.reshape(-1)] = True
    return _read_only(mask)
