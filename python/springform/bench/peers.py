"""Other engines on the same cylinder net: same law, same residual, judged by the same code.

Every peer is optional and imported when asked for. Within the clock: whatever has to be done anew
for a net, factorisation included. Outside: building the peer's data structures from arrays, and
our checks of the residual.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.metadata
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Floats
from .nets import Cords, relative_residual, spring_lengths

ANCHOR_WEIGHT = 1e8
"""Weight of ShapeOp's closeness constraints, springs being 1: anchors move by less than 1e-7 m."""

DAMPING = {2_000: 0.2, 20_000: 0.05, 200_000: 0.02}
"""Viscous damping c of compas_dr by size of the net, found by trial."""

EXPONENT = 0.1
"""Exponent of the damped outer loop around force density solvers; without damping it diverges."""


@dataclass(frozen=True)
class Outcome:
    """How far an engine came."""

    seconds: float
    """Seconds within the clock."""
    residual: float
    """Residual reached, by `relative_residual`."""
    iterations: int
    """Its own iterations."""


Engine = Callable[[Cords, float, float], Outcome]
"""Moves a net to a residual, or as far as it comes within a number of seconds."""


@dataclass(frozen=True)
class Peer:
    """Another engine."""

    module: str
    """What to import."""
    distribution: str
    """Name of its distribution."""
    engine: Engine
    """How to run it."""
    law: str
    """Law of its springs, and what we add around it."""
    largest: int
    """Most springs on which it is tried."""

    def version(self) -> str | None:
        """Return its version; None if it is not installed."""
        try:
            importlib.import_module(self.module)
            return importlib.metadata.version(self.distribution)
        except ImportError:
            return None


def _shapeop(cords: Cords, residual: float, seconds: float) -> Outcome:
    network = cords.network()
    ratios = (cords.rest_length / spring_lengths(cords.positions, cords.springs)).tolist()
    solver = importlib.import_module("compas_shapeop.shapeop").Solver()
    solver.points = cords.positions
    for node in np.flatnonzero(cords.fixed).tolist():
        solver.add_closeness_constraint(node, ANCHOR_WEIGHT)
    for (a, b), ratio in zip(cords.springs.tolist(), ratios, strict=True):
        solver.add_edge_strain_constraint(a, b, 1.0, ratio, ratio)
    began = time.perf_counter()
    solver.init()
    spent = time.perf_counter() - began
    iterations, left = 0, np.inf
    while left > residual and spent < seconds:
        began = time.perf_counter()
        solver.solve(1)
        spent += time.perf_counter() - began
        iterations += 1
        left = relative_residual(network, np.array(solver.points))
    return Outcome(spent, left, iterations)


def _compas_dr(cords: Cords, residual: float, seconds: float) -> Outcome:
    network = cords.network()
    count = len(cords.springs)
    data = importlib.import_module("compas_dr.numdata").InputData(
        vertices=cords.positions.tolist(),
        edges=cords.springs.tolist(),
        fixed=np.flatnonzero(cords.fixed).tolist(),
        loads=[[0.0] * 3] * len(cords.positions),
        qpre=[0.0] * count,
        fpre=[0.0] * count,
        lpre=[0.0] * count,
        linit=cords.rest_length.tolist(),
        # Stress times section: EA = 1000 E pi r² in its units of kN/mm² and mm.
        E=(cords.axial_stiffness / (3.14159 * 1e3)).tolist(),
        radius=[1.0] * count,
    )
    size = min(DAMPING, key=lambda springs: abs(np.log(springs / count)))
    checked = _Checks(network, residual, seconds)
    relax = importlib.import_module("compas_dr.solvers").dr_numpy
    with contextlib.suppress(_ReachedError):
        relax(data, kmax=10**7, tol1=0.0, tol2=0.0, c=DAMPING[size], callback=checked)
    return checked.outcome()


class _ReachedError(Exception):
    """Ends a peer's loop from its callback."""


class _Checks:
    """Looks at a peer's positions now and then, outside the clock."""

    def __init__(self, network: Any, residual: float, seconds: float) -> None:
        self._network, self._residual, self._limit = network, residual, seconds
        self._checking = 0.0
        self._began = time.perf_counter()
        self._left, self._steps, self._spent = np.inf, 0, 0.0

    def __call__(self, step: int, positions: Floats, *_: object) -> None:
        if step % 20:
            return
        began = time.perf_counter()
        self._spent = began - self._began - self._checking
        self._left = relative_residual(self._network, positions)
        self._steps = step
        self._checking += time.perf_counter() - began
        if self._left <= self._residual or self._spent > self._limit:
            raise _ReachedError

    def outcome(self) -> Outcome:
        return Outcome(self._spent, self._left, self._steps)


def _compas_fd(cords: Cords, residual: float, seconds: float) -> Outcome:
    fd_numpy = importlib.import_module("compas_fd.solvers").fd_numpy
    fixed = np.flatnonzero(cords.fixed).tolist()
    vertices, edges = cords.positions.tolist(), cords.springs.tolist()

    def solve(densities: Floats) -> Floats:
        found = fd_numpy(
            vertices=vertices, fixed=fixed, edges=edges, forcedensities=densities.tolist()
        )
        return np.asarray(found.vertices)

    return _by_force_densities(cords, residual, seconds, solve)


def _jax_fdm(cords: Cords, residual: float, seconds: float) -> Outcome:
    jax = importlib.import_module("jax")
    package = importlib.import_module("jax_fdm.equilibrium")
    jax.config.update("jax_enable_x64", True)
    network = importlib.import_module("jax_fdm.datastructures").FDNetwork
    datastructure = network.from_nodes_and_edges(cords.positions.tolist(), cords.springs.tolist())
    for node in np.flatnonzero(cords.fixed).tolist():
        datastructure.node_support(node)
    structure = package.EquilibriumStructureSparse.from_network(datastructure)
    number = {pair: at for at, pair in enumerate(map(tuple, cords.springs.tolist()))}
    order = np.array([number[pair] for pair in map(tuple, np.asarray(structure.edges).tolist())])
    model = package.EquilibriumModelSparse()
    anchors, loads = cords.positions[cords.fixed], np.zeros_like(cords.positions)
    equilibrium = jax.jit(lambda q: model.equilibrium(q, anchors, loads, structure))

    def solve(densities: Floats) -> Floats:
        positions = cords.positions.copy()
        positions[~cords.fixed] = np.asarray(equilibrium(densities[order]))
        return positions

    solve(np.ones(len(cords.springs)))  # compiles, once a process
    return _by_force_densities(cords, residual, seconds, solve)


def _by_force_densities(
    cords: Cords, residual: float, seconds: float, solve: Callable[[Floats], Floats]
) -> Outcome:
    """Our damped loop around a solver that knows force densities only."""
    network = cords.network()
    stiffness, rest = network.stiffness, network.rest_length
    lengths = spring_lengths(cords.positions, cords.springs)
    densities = stiffness * (1 - rest / lengths)
    spent, iterations, left = 0.0, 0, np.inf
    while left > residual and spent < seconds:
        began = time.perf_counter()
        positions = solve(densities)
        lengths = spring_lengths(positions, cords.springs)
        wanted = np.maximum(stiffness * (1 - rest / lengths), 1e-6 * stiffness)
        following = densities * (wanted / densities) ** EXPONENT
        spent += time.perf_counter() - began
        left = relative_residual(network, positions)
        densities = following
        iterations += 1
    return Outcome(spent, left, iterations)


PEERS = (
    Peer("compas_shapeop", "compas_shapeop", _shapeop, "EdgeStrain, linear springs", 200_000),
    Peer("compas_dr", "compas_dr", _compas_dr, "EA and initial lengths, linear springs", 20_000),
    Peer("compas_fd", "compas_fd", _compas_fd, "force densities in our damped loop", 20_000),
    Peer("jax_fdm", "jax_fdm", _jax_fdm, "force densities in our damped loop, compiled", 20_000),
)
"""All peers, the bar first."""
