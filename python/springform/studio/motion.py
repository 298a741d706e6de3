"""The net in motion: a thread that moves it to equilibrium, however it is pulled meanwhile."""

from __future__ import annotations

import copy
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..design import Design
from ..errors import InputError
from ..network import Equilibrium, Network, animate, solve

Command = Literal["run", "pause", "step", "reset"]

_PERIOD = 1 / 60
"""Seconds between steps [s], so that eyes can follow."""

_STEP = 0.5
"""Time step after the net was disturbed, in units of `animate`."""

_PULLED_STEP = 3.0
"""Time step while a node is dragged: the net follows the hand."""

_GROWTH = 1.08
"""Factor on the time step, so that the last of the motion does not take long."""

_NEAR = 1e-3
"""Residual at which the eye sees no more motion, and the direct solver finishes."""

_LAST_STEP = 600
"""Step at which the direct solver finishes, however far the net still is."""


@dataclass(frozen=True)
class State:
    """Where the net is."""

    revision: int
    """Revision of the net."""
    positions: Floats
    """(n, 3) [m]."""
    forces: Floats
    """(m,) [N]."""
    reactions: Floats
    """(n, 3) [N]."""
    steps: int
    """Steps since the net was last disturbed."""
    running: bool
    settled: bool
    """Nothing will move until something changes."""
    converged: bool
    residual: float
    reason: str
    held: tuple[int, ...]
    """Nodes that are dragged."""
    waited: float = 0.0
    """From the change that it follows until its step began [s]; 0 of later steps."""
    took: float = 0.0
    """What its step took [s]."""


class Motion:
    """Moves a net in a thread of its own and tells every state; safe to call from any thread."""

    def __init__(self, tell: Callable[[State], None]) -> None:
        """Start the thread; `tell` is called in it, after every step."""
        self._tell = tell
        self._changed = threading.Condition()
        self._network: Network | None = None
        self._nodes: list[str] = []
        self._revision = 0
        self._positions: Floats = np.empty((0, 3))
        self._holds: dict[object, tuple[str, Floats]] = {}
        self._running = True
        self._disturbed = False
        self._disturbed_at = 0.0
        self._placed = 0
        self._single_steps = 0
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="motion", daemon=True)
        self._thread.start()

    def take(self, design: Design, revision: int) -> None:
        """Go on with another net; nodes that it shares with the last one stay where they are."""
        network, nodes = design.network(), design.nodes
        with self._changed:
            self._positions = carried(design, self._nodes, self._positions)
            self._network, self._nodes, self._revision = network, nodes, revision
            self._placed += 1
            self._disturb()

    def place(self, nodes: list[str], positions: Floats) -> None:
        """Note where nodes were shown, (n, 3) [m]: the next net starts from there."""
        with self._changed:
            self._network, self._nodes, self._positions = None, nodes, positions
            self._placed += 1
            self._disturb()

    def hold(self, hand: object, node: str, position: Floats) -> None:
        """Hold a node somewhere; every hand holds one at most."""
        with self._changed:
            self._holds[hand] = (node, position)
            self._disturb()

    def release(self, hand: object) -> None:
        """Let go what a hand holds."""
        with self._changed:
            if self._holds.pop(hand, None) is not None:
                self._disturb()

    def command(self, what: Command) -> None:
        """Run, pause, make one step, or put the net back to where it was drawn."""
        with self._changed:
            if what == "step":
                self._running = False
                self._single_steps += 1
            elif what == "reset" and self._network is not None:
                self._positions = self._network.positions
                self._placed += 1
            elif what != "reset":
                self._running = what == "run"
            if what != "step":
                self._disturb()
            self._changed.notify()

    def close(self) -> None:
        """End the thread."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()

    def _disturb(self) -> None:
        self._disturbed = True
        self._disturbed_at = time.perf_counter()
        self._changed.notify()

    # --- in the thread -------------------------------------------------------------------------

    def _work(self) -> None:
        steps: Iterator[State] = iter(())
        moving, next_step = False, 0.0
        while True:
            with self._changed:
                self._wait(next_step if moving else None)
                if self._closed:
                    return
                began, waited = time.perf_counter(), 0.0
                if self._disturbed:
                    self._disturbed, waited = False, began - self._disturbed_at
                    steps = self._motion()
                self._single_steps = max(self._single_steps - 1, 0)
                placed = self._placed
            next_step = time.monotonic() + _PERIOD
            state = next(steps, None)
            moving = False
            if state is not None and self._keep(state, placed):
                moving = state.running and not state.settled
                took = time.perf_counter() - began
                self._tell(replace(state, waited=waited, took=took))

    def _wait(self, until: float | None) -> None:
        """Wait until it is time for a step, or something changes; the lock is held."""
        timeout = None if until is None else max(0.0, until - time.monotonic())
        self._changed.wait_for(
            lambda: self._closed or self._disturbed or self._single_steps > 0, timeout
        )

    def _keep(self, state: State, placed: int) -> bool:
        """Take the positions of a state, unless the net was placed elsewhere meanwhile."""
        with self._changed:
            current = placed == self._placed
            if current:
                self._positions = state.positions
            return current

    def _motion(self) -> Iterator[State]:
        """Return the states from now on; the lock is held."""
        network, holds = self._network, self._holds
        if network is None:
            return iter(())
        rows = {key: row for row, key in enumerate(self._nodes)}
        held = {rows[key]: place for key, place in holds.values() if key in rows}
        pulled = with_held(network, self._positions, held)
        return _states(pulled, self._revision, self._running, tuple(held))


def _states(
    network: Network, revision: int, running: bool, held: tuple[int, ...]
) -> Iterator[State]:
    def state(now: Equilibrium, steps: int, settled: bool) -> State:
        return State(
            revision,
            now.positions,
            now.forces,
            now.reactions,
            steps,
            running,
            settled,
            now.converged,
            now.residual,
            now.reason if settled else "",
            held,
        )

    try:
        still = solve(network, solver="implicit-euler", iterations=0)
        if not running or still.converged:
            yield state(still, 0, still.converged)
        if still.converged:
            return
        step = _PULLED_STEP if held else _STEP
        for number, now in enumerate(animate(network, step=step, growth=_GROWTH), start=1):
            if not np.isfinite(now.positions).all():
                break
            near = now.residual <= _NEAR or number >= _LAST_STEP
            if now.converged or near:
                network = network.started_at(now.positions)
                break
            yield state(now, number, False)
        last = solve(network)
        yield state(last, number, True)
    except InputError as error:
        size = len(network.positions)
        zeros = np.zeros((size, 3))
        nothing = np.zeros(len(network.springs))
        positions = network.positions
        yield State(
            revision, positions, nothing, zeros, 0, running, True, False, np.nan, str(error), held
        )


def with_held(network: Network, positions: Floats, held: Mapping[int, Floats]) -> Network:
    """Return the network at positions, fixed nodes where they belong, and some nodes held."""
    free = network.started_at(positions)
    if not held:
        return free
    placed, axes = free.positions.copy(), free.fixed_axes.copy()
    for row, place in held.items():
        placed[row] = place
        axes[row] = True
    other = copy.copy(free)
    other.positions = placed
    other.fixed_axes = axes
    other.fixed = np.asarray(axes.all(axis=1))
    other.slides = [slide for slide in free.slides if slide[0] not in held]
    return other


def carried(design: Design, known_nodes: Sequence[str], positions: Floats) -> Floats:
    """Return where the nodes of a design are: known ones at their positions, new ones between.

    `known_nodes` are the keys of the nodes that `positions` are of, (n, 3) [m].
    """
    network = design.network()
    old = {key: row for row, key in enumerate(known_nodes)}
    rows = np.array([old.get(key, -1) for key in design.nodes], dtype=np.int64)
    known: NDArray[np.bool_] = np.greater_equal(rows, 0)
    if not known.any():
        return network.positions
    placed = np.where(known[:, None], positions[np.maximum(rows, 0)], network.positions)
    placed = np.where(network.fixed_axes, network.positions, placed)
    return _between(network.springs, placed, known | network.fixed)


def _between(springs: NDArray[np.uint32], positions: Floats, known: NDArray[np.bool_]) -> Floats:
    """Move unknown nodes to the mean of their neighbours, wave by wave from the known ones."""
    positions, known = positions.copy(), known.copy()
    ends = np.concatenate((springs, springs[:, ::-1])).astype(np.int64)
    while not known.all():
        sums = np.zeros_like(positions)
        counts = np.zeros(len(positions))
        reach = ends[known[ends[:, 0]] & ~known[ends[:, 1]]]
        if not len(reach):
            break
        np.add.at(sums, reach[:, 1], positions[reach[:, 0]])
        np.add.at(counts, reach[:, 1], 1)
        reached = counts > 0
        positions[reached] = sums[reached] / counts[reached, None]
        known |= reached
    return positions
