"""Bare networks and their equilibrium: inputs and results are separate types."""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .arrays import Floats, axes_of, mask_of, node_numbers, numbers, read_only, wrong_shape
from .errors import InputError
from .spring_laws import Curves, resolve, senses, spring_lengths

Solver = Literal["direct", "implicit-euler", "dynamic-relaxation"]

TOLERANCE = 1e-9
"""Largest residual at a free node over the mean spring force at which a net counts as solved."""

_ITERATIONS = {"direct": 500, "implicit-euler": 5000, "dynamic-relaxation": 200_000}

Slide = tuple[int, str, Sequence[float]]
"""A node, "line" and a direction, or "plane" and a normal."""


@dataclass(frozen=True)
class Rod:
    """A rod that bends, by three-node elements (Adriaenssens & Barnes 2001).

    Straight when unstressed; springs between its nodes carry its axial force.
    """

    nodes: Sequence[int]
    """Nodes along the rod, three or more, each once."""
    bending_stiffness: float
    """EI [N m2]."""
    closed: bool = False
    """The last node is followed by the first."""
    lengths: Sequence[float] | None = None
    """Unstressed length of every link [m]; None: the lengths at the start."""


class Network:
    """Springs between nodes, loads and supports. n nodes, m springs; the arrays are read-only.

    Spring force F = T + k (L - r) [N], tension positive, within the spring's sense: k stiffness
    [N/m], L length [m], r rest length [m], T constant force [N]. With a measured curve,
    F = EA(ε)·ε of the strain ε = (L - r)/r.

    Attributes: `positions` (n, 3) start positions [m]; `springs` (m, 2) node numbers; `fixed`
    (n,) bool, held along all axes; `fixed_axes` (n, 3) bool, held along x, y, z; `slides`;
    `stiffness` (m,) [N/m], with a curve its secant to the last point; `rest_length` (m,) [m];
    `force` (m,) [N]; `law` (m,), the place in `LAWS` of the law that was said; `sense` (m,): 1
    tension, 0 both, -1 compression; `area` (m,) of the cross-sections [m2], NaN where unknown;
    `loads` (n, 3) [N]; `self_weight` (m,) [N/m] of the springs without a rest length, or empty;
    `pressure`; `rods`.
    """

    positions: Floats
    springs: NDArray[np.uint32]
    fixed: NDArray[np.bool_]
    fixed_axes: NDArray[np.bool_]
    slides: list[tuple[int, bool, tuple[float, float, float]]]
    stiffness: Floats
    rest_length: Floats
    force: Floats
    law: NDArray[np.uint8]
    sense: NDArray[np.int8]
    curve: NDArray[np.uint32]
    curves: list[_core.ForceStrainCurve]
    area: Floats
    loads: Floats
    self_weight: Floats
    pressure: list[tuple[list[int], float]]
    rods: list[Rod]

    def __init__(
        self,
        positions: ArrayLike,
        springs: ArrayLike,
        fixed: ArrayLike,
        *,
        stiffness: ArrayLike | None = None,
        axial_stiffness: ArrayLike | None = None,
        force: ArrayLike | None = None,
        curve: Curves = None,
        rest_length: ArrayLike | None = None,
        prestress: ArrayLike | None = None,
        thermal_strain: ArrayLike | None = None,
        sense: str | Sequence[str] = "both",
        area: ArrayLike | None = None,
        loads: ArrayLike | None = None,
        self_weight: ArrayLike | None = None,
        pressure: Iterable[tuple[Sequence[int], float]] = (),
        rods: Iterable[Rod] = (),
        fixed_axes: Iterable[tuple[int, str]] = (),
        slides: Iterable[Slide] = (),
    ) -> None:
        """Check and hold the arrays; arrays of the right type are shared, not copied.

        Values for springs are one number, or one a spring. A spring has one of four laws; in an
        array, NaN (for curves: None) says that a spring has another:

        - `stiffness` k [N/m], 1 unless said: F = k (L - r);
        - `axial_stiffness` EA [N], which refers to the unstressed length L0: F = EA (L - L0)/L0;
        - `force` T [N]: F = T, whatever the length;
        - `curve`, a measured one of force against strain (L - L0)/L0.

        The unstressed length comes from `rest_length` [m], or from `prestress` [N], the
        force at the start positions; without either it is 0 for `stiffness` and the length at the
        start for the others. `thermal_strain` α Δϑ lengthens it: L0 (1 + α Δϑ).
        `sense` is "tension", "both" or "compression".

        `loads` are dead, one vector a node [N]. `self_weight` [N/m] pulls along -z, half at each
        end of a spring: by the unstressed length before `thermal_strain`, or, where that is 0, by
        the length at equilibrium. `pressure` [Pa] is square to cells wherever they move: (nodes
        around a cell, pressure), positive along the normal of the right-hand rule.

        `fixed` is one bool a node, or the numbers of the fixed nodes; `fixed_axes` holds further
        nodes along single axes: (node, "x"), …; `slides` lets nodes move on a line or in a plane
        through their start: (node, "line", direction) or (node, "plane", normal).
        Raises `InputError`: a shape or value that does not fit.
        """
        self.positions = numbers("positions", positions, (None, 3))
        nodes = len(self.positions)
        self.springs = node_numbers("springs", springs, nodes)
        if self.springs.ndim != 2 or self.springs.shape[1] != 2:
            raise wrong_shape("springs", self.springs.shape, "(m, 2)")
        count = len(self.springs)
        self.fixed_axes = axes_of(mask_of(fixed, nodes), fixed_axes)
        self.fixed = read_only(np.asarray(self.fixed_axes.all(axis=1)))
        self.slides = [_slide(slide) for slide in slides]
        lengths = spring_lengths(self.positions, self.springs)
        self.stiffness, self.rest_length, self.force, self.curve, self.curves, self.law = resolve(
            lengths,
            stiffness=stiffness,
            axial_stiffness=axial_stiffness,
            force=force,
            curve=curve,
            rest_length=rest_length,
            prestress=prestress,
            thermal_strain=thermal_strain,
        )
        self.sense = senses(sense, count)
        self.area = numbers("area", np.nan if area is None else area, (count,))
        self.loads = numbers("loads", 0.0 if loads is None else loads, (nodes, 3))
        self.self_weight = read_only(np.zeros(0))
        if self_weight is not None:
            warm = 0.0 if thermal_strain is None else np.asarray(thermal_strain)
            self._weigh(
                numbers("self_weight", self_weight, (count,)), self.rest_length / (1 + warm)
            )
        self.pressure = [([int(node) for node in cell], float(value)) for cell, value in pressure]
        self.rods = [self._rod(number, rod) for number, rod in enumerate(rods)]

    @classmethod
    def from_core(cls, arrays: dict[str, Any]) -> Network:
        """Return the network that the core made, from its arrays by name; they are not copied."""
        network = cls.__new__(cls)
        for name, value in arrays.items():
            setattr(network, name, read_only(value) if isinstance(value, np.ndarray) else value)
        network.fixed = read_only(np.asarray(network.fixed_axes.all(axis=1)))
        network.rods = [Rod(*rod) for rod in arrays["rods"]]
        return network

    def __repr__(self) -> str:
        return (
            f"Network({len(self.positions)} nodes, {len(self.springs)} springs, "
            f"{int(self.fixed.sum())} fixed)"
        )

    def started_at(self, positions: ArrayLike) -> Network:
        """Return the same network with another start: a neighbour's equilibrium, say.

        Nodes keep what their supports hold. Raises `InputError`: another shape.
        """
        start = numbers("positions", positions, self.positions.shape)
        moved = np.where(self.fixed_axes, 0.0, start - self.positions)
        for node, in_plane, along in self.slides:
            unit = np.array(along) / np.linalg.norm(along)
            on_line = (moved[node] @ unit) * unit
            moved[node] = moved[node] - on_line if in_plane else on_line
        other = copy.copy(self)
        other.positions = read_only(self.positions + moved)
        return other

    def stiffened(self, factors: ArrayLike) -> Network:
        """Return the same network with a factor on the stiffness k of every spring, or of each.

        Springs of constant force have none. Raises `InputError`: another shape, or not above 0.
        """
        values = numbers("factors", factors, (len(self.springs),))
        if not (values > 0).all():
            raise InputError("must be above 0", key="factors")
        other = copy.copy(self)
        other.stiffness = read_only(self.stiffness * values)
        return other

    def _weigh(self, weight: Floats, unstressed: Floats) -> None:
        """Lump the weight of springs with an unstressed length; that of others follows them."""
        lumped = np.zeros(len(self.positions))
        halves = np.repeat(0.5 * weight * unstressed, 2)
        np.add.at(lumped, self.springs.reshape(-1), halves)
        loads = self.loads.copy()
        loads[:, 2] -= lumped
        self.loads = read_only(loads)
        follows = self.rest_length == 0
        if (weight[follows] != 0).any():
            self.self_weight = read_only(np.where(follows, weight, 0.0))

    def _rod(self, number: int, rod: Rod) -> Rod:
        nodes = [int(node) for node in rod.nodes]
        pairs = list(zip(nodes, nodes[1:] + (nodes[:1] if rod.closed else []), strict=False))
        if min(nodes, default=0) < 0 or max(nodes, default=0) >= len(self.positions):
            raise InputError("names a node that does not exist", key=f"rods[{number}]")
        joined = {frozenset(pair) for pair in self.springs.tolist()}
        for pair in pairs:
            if frozenset(pair) not in joined:
                raise InputError(
                    f"has no spring between nodes {pair[0]} and {pair[1]}; add one that carries "
                    "its axial force",
                    key=f"rods[{number}]",
                )
        lengths = (
            spring_lengths(self.positions, pairs).tolist() if rod.lengths is None else rod.lengths
        )
        return Rod(nodes, float(rod.bending_stiffness), rod.closed, [float(one) for one in lengths])


@dataclass(frozen=True)
class Equilibrium:
    """Result of a solve: n nodes, m springs; arrays in the order of the network's."""

    positions: Floats
    """(n, 3) [m]."""
    forces: Floats
    """(m,) [N], tension positive."""
    lengths: Floats
    """(m,) [m]."""
    strains: Floats
    """(m,): (L - r)/r; NaN where a spring has no rest length."""
    stresses: Floats
    """(m,) [Pa]: force over the area of the cross-section; NaN where that is unknown."""
    reactions: Floats
    """(n, 3) [N]: what holds the nodes; zero along free axes."""
    loads: Floats
    """(n, 3) [N]: dead loads, weight and pressure."""
    spring_energies: Floats
    """(m,) [J]: strain energy; for a constant force, force times length."""
    bending_moments: list[Floats]
    """[N m], one a node, for every rod."""
    residual: float
    """Largest force out of balance at a free node over the mean spring force."""
    worst_node: int | None
    """Node of the largest residual, if any node is out of balance."""
    converged: bool
    """The residual is within the tolerance."""
    iterations: int
    """Iterations made: linear solves, steps, or Euler steps."""
    method: str
    """linear, preconditioned, newton, interior or implicit-euler."""
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
    start: ArrayLike | None = None,
) -> Equilibrium:
    """Solve a network; the interpreter lock is free meanwhile.

    "direct" factors stiffness matrices, and chooses its method by the net; "implicit-euler" moves
    the net step by step, as the paper does (footnote 1), "dynamic-relaxation" by explicit steps
    with kinetic damping, for springs without curves and dead loads only. `start` are positions to
    start at instead of the network's, such as a neighbour's equilibrium. A net that finds no
    equilibrium is no error: see `converged` and `reason`. Raises `InputError`: the network or
    solver is refused.
    """
    if solver not in _ITERATIONS:
        known = ", ".join(_ITERATIONS)
        raise InputError(f"unknown solver '{solver}'; use one of {known}", key="solver")
    _check("tolerance", tolerance)
    limit = _ITERATIONS[solver] if iterations is None else iterations
    if not 0 <= limit < 2**31:
        raise InputError(f"must be 0 to {2**31 - 1}, not {limit}", key="iterations")
    network = network if start is None else network.started_at(start)
    began = time.perf_counter()
    try:
        result = _core.solve(network, tolerance, limit, solver)
    except _core.CoreError as error:
        key, problem = error.args
        raise InputError(problem, key=key) from None
    return _equilibrium(network, result, time.perf_counter() - began)


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
        state = _equilibrium(network, euler.advance(tolerance), time.perf_counter() - start)
        yield state
        if state.converged:
            return


def residuals(network: Network) -> Floats:
    """Return the force out of balance at every free node of a network as it stands, (n, 3) [N]."""
    return _core.residuals(network)


def _equilibrium(network: Network, result: _core._SolveResult, seconds: float) -> Equilibrium:
    lengths = spring_lengths(result["positions"], network.springs)
    rest = network.rest_length
    strains = np.divide(lengths - rest, rest, out=np.full(len(rest), np.nan), where=rest > 0)
    return Equilibrium(
        **result,
        lengths=lengths,
        strains=strains,
        stresses=result["forces"] / network.area,
        seconds=seconds,
    )


def _slide(slide: Slide) -> tuple[int, bool, tuple[float, float, float]]:
    node, path, along = slide
    if path not in ("line", "plane"):
        raise InputError(f"must be a line or a plane, not {path!r}", key="slides")
    x, y, z = numbers("slides", along, (3,)).tolist()
    return int(node), path == "plane", (x, y, z)


def _check(name: str, value: float, least: float | None = None) -> None:
    if not math.isfinite(value) or (value <= 0 if least is None else value < least):
        bound = "above 0" if least is None else f"at least {least}"
        raise InputError(f"must be finite and {bound}, not {value}", key=name)
