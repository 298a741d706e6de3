"""Bare networks and their equilibrium: inputs and results are separate types."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .errors import InputError

Floats = NDArray[np.float64]
Solver = Literal["direct", "implicit-euler", "dynamic-relaxation"]

TOLERANCE = 1e-9
"""Largest residual at a free node over the mean spring force at which a net counts as solved."""

_ITERATIONS = {"direct": 200, "implicit-euler": 5000, "dynamic-relaxation": 200_000}


class Network:
    """Springs between nodes: the inputs of a solve. n nodes, m springs; the arrays are read-only.

    Spring force F = T + k (L - r) [N], tension positive, within the spring's sense: k stiffness
    [N/m], L length [m], r rest length [m], T constant force [N].

    Attributes: `positions` (n, 3) start positions [m]; `springs` (m, 2) node numbers; `fixed`
    (n,) bool, held along all axes; `fixed_axes` (n, 3) bool, held along x, y, z; `stiffness` (m,)
    [N/m]; `rest_length` (m,) [m]; `force` (m,) [N]; `sense` (m,): 1 tension, 0 both,
    -1 compression; `loads` (n, 3) [N].
    """

    positions: Floats
    springs: NDArray[np.uint32]
    fixed: NDArray[np.bool_]
    fixed_axes: NDArray[np.bool_]
    stiffness: Floats
    rest_length: Floats
    force: Floats
    sense: NDArray[np.int8]
    loads: Floats

    def __init__(
        self,
        positions: ArrayLike,
        springs: ArrayLike,
        fixed: ArrayLike,
        *,
        stiffness: ArrayLike | None = None,
        axial_stiffness: ArrayLike | None = None,
        force: ArrayLike | None = None,
        rest_length: ArrayLike | None = None,
        prestress: ArrayLike | None = None,
        sense: str | Sequence[str] = "both",
        loads: ArrayLike | None = None,
        fixed_axes: Iterable[tuple[int, str]] = (),
    ) -> None:
        """Check and hold the arrays; arrays of the right type are shared, not copied.

        `fixed` is one bool a node, or the numbers of the fixed nodes; `fixed_axes` holds further
        nodes along single axes: (node, "x"), … Values for springs are one number, or one a
        spring. A spring has one of three laws; in an array, NaN says that a spring has another:

        - `stiffness` k [N/m], 1 unless said: F = k (L - r);
        - `axial_stiffness` EA [N], which refers to the unstressed length L0: F = EA (L - L0)/L0;
        - `force` T [N]: F = T, whatever the length.

        The first two take the unstressed length from `rest_length` [m], or from `prestress` [N],
        the force at the start positions; without either it is 0 for `stiffness` and the length
        at the start for `axial_stiffness`. `sense` is "tension", "both" or "compression", one or
        one a spring. `loads` are one vector a node [N]; none if None.
        Raises `InputError`: a shape or value that does not fit.
        """
        self.positions = _numbers("positions", positions, (None, 3))
        nodes = len(self.positions)
        self.springs = _node_numbers("springs", springs, nodes)
        if self.springs.ndim != 2 or self.springs.shape[1] != 2:
            raise _wrong_shape("springs", self.springs.shape, "(m, 2)")
        self.fixed_axes = _axes(_mask(fixed, nodes), fixed_axes)
        self.fixed = _read_only(np.asarray(self.fixed_axes.all(axis=1)))
        laws = _Laws(self.positions, self.springs)
        self.stiffness, self.rest_length, self.force = laws.resolve(
            stiffness, axial_stiffness, force, rest_length, prestress
        )
        self.sense = _senses(sense, len(self.springs))
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
    reactions: Floats
    """(n, 3) [N]: what holds the nodes; zero along free axes."""
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
    moves the net step by step, as the paper does (footnote 1), and "dynamic-relaxation" by explicit
    steps with kinetic damping. A net that finds no equilibrium is no error: see `converged` and
    `reason`. Raises `InputError`: the network or solver is refused.
    """
    if solver not in _ITERATIONS:
        known = ", ".join(_ITERATIONS)
        raise InputError(f"unknown solver '{solver}'; use one of {known}", key="solver")
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


def _axes(mask: NDArray[np.bool_], single: Iterable[tuple[int, str]]) -> NDArray[np.bool_]:
    axes = np.repeat(mask[:, None], 3, axis=1)
    for node, axis in single:
        if axis not in ("x", "y", "z") or not 0 <= node < len(mask):
            raise InputError(
                f"must be a node and x, y or z, not {(node, axis)!r}", key="fixed_axes"
            )
        axes[node, "xyz".index(axis)] = True
    return _read_only(axes)


_SENSES = {"tension": 1, "both": 0, "compression": -1}


def _senses(sense: str | Sequence[str], count: int) -> NDArray[np.int8]:
    words = [sense] * count if isinstance(sense, str) else list(sense)
    if len(words) != count:
        raise _wrong_shape("sense", (len(words),), f"({count},)")
    unknown = sorted(set(words) - set(_SENSES))
    if unknown:
        raise InputError(f"must be tension, both or compression, not {unknown[0]}", key="sense")
    return _read_only(np.array([_SENSES[word] for word in words], dtype=np.int8))


class _Laws:
    """Resolves what was said of springs to stiffness, rest length and constant force."""

    def __init__(self, positions: Floats, springs: NDArray[np.uint32]) -> None:
        self._count = len(springs)
        self._positions, self._springs = positions, springs

    def resolve(
        self,
        stiffness: ArrayLike | None,
        axial_stiffness: ArrayLike | None,
        force: ArrayLike | None,
        rest_length: ArrayLike | None,
        prestress: ArrayLike | None,
    ) -> tuple[Floats, Floats, Floats]:
        if axial_stiffness is None and force is None and prestress is None:
            # The plain case keeps the caller's arrays.
            plain = self._values("stiffness", 1.0 if stiffness is None else stiffness)
            rest = self._values("rest_length", 0.0 if rest_length is None else rest_length)
            return plain, rest, self._values("force", 0.0)
        hooke = self._values("stiffness", np.nan if stiffness is None else stiffness)
        axial = self._values("axial_stiffness", _or_nan(axial_stiffness))
        constant = self._values("force", _or_nan(force))
        said = (~np.isnan([hooke, axial, constant])).sum(axis=0)
        if stiffness is None and axial_stiffness is None and force is None:
            hooke, said = np.ones(self._count), np.ones(self._count, dtype=np.int64)
        if (wrong := np.flatnonzero(said != 1)).size:
            what = "no law" if said[wrong[0]] == 0 else "more than one law"
            raise InputError(
                f"spring {wrong[0]} has {what}; give one of stiffness, axial_stiffness and force",
                key="stiffness",
            )
        given = self._values("rest_length", _or_nan(rest_length))
        stress = self._values("prestress", _or_nan(prestress))
        if (twice := np.flatnonzero(~np.isnan(given) & ~np.isnan(stress))).size:
            raise InputError(
                f"spring {twice[0]} has a prestress and a rest length; give one", key="prestress"
            )
        elastic = np.isnan(constant)
        # Numbers that overflow here are refused with the others that are not finite.
        with np.errstate(all="ignore"):
            ends = self._positions[self._springs]
            lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
            unstressed = np.where(np.isnan(axial), 0.0, lengths)
            from_stress = np.where(
                np.isnan(axial), lengths - stress / hooke, lengths / (1.0 + stress / axial)
            )
        rest = np.where(np.isnan(stress), np.where(np.isnan(given), unstressed, given), from_stress)
        rest = np.where(elastic, rest, 0.0)
        if (bad := np.flatnonzero(~np.isnan(axial) & ~(rest > 0))).size:
            raise InputError(
                f"spring {bad[0]} has an unstressed length of {rest[bad[0]]:g} m; "
                "axial_stiffness needs one above 0",
                key="rest_length",
            )
        if (bad := np.flatnonzero(rest < 0)).size:
            raise InputError(
                f"spring {bad[0]} would have a rest length of {rest[bad[0]]:g} m; lower it",
                key="prestress",
            )
        with np.errstate(all="ignore"):
            rate = np.where(np.isnan(axial), hooke, axial / rest)
        return (
            _read_only(np.where(elastic, rate, 0.0)),
            _read_only(rest),
            _read_only(np.where(elastic, 0.0, constant)),
        )

    def _values(self, name: str, values: ArrayLike) -> Floats:
        return _numbers(name, values, (self._count,))


def _or_nan(values: ArrayLike | None) -> ArrayLike:
    return np.nan if values is None else values
