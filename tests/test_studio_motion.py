"""The net in motion: it ends where the direct solver ends, follows what is held, and rests."""

from __future__ import annotations

import queue
import time
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest

import springform as sf
from springform.studio.motion import Motion, State, carried

DESIGN = sf.load("one-cylinder")


class Watch:
    """A motion and the states that it told."""

    def __init__(self) -> None:
        self.states: queue.Queue[State] = queue.Queue()
        self.motion = Motion(self.states.put)

    def until_settled(self) -> list[State]:
        found = []
        while not found or not found[-1].settled:
            found.append(self.states.get(timeout=30))
        return found

    def quiet(self) -> None:
        """Wait until nothing more is told."""
        while True:
            try:
                self.states.get(timeout=0.3)
            except queue.Empty:
                return


@pytest.fixture
def watch() -> Iterator[Watch]:
    watched = Watch()
    yield watched
    watched.motion.close()


def test_it_ends_at_the_equilibrium_of_the_direct_solver(watch: Watch) -> None:
    divided = DESIGN.edited(["3 subdivide 1 1 6 1", "17 retype 1 6"])
    watch.motion.take(DESIGN, 1)
    watch.until_settled()
    watch.motion.take(divided, 2)
    states = watch.until_settled()
    assert len(states) > 10  # it moved there, before one's eyes
    assert states[0].waited > 0  # for the change that it follows
    assert all(state.waited == 0 for state in states[1:])
    assert all(state.took > 0 for state in states)
    equilibrium = divided.solve()
    assert states[-1].converged
    np.testing.assert_allclose(states[-1].positions, equilibrium.positions, atol=1e-8)
    np.testing.assert_allclose(states[-1].forces, equilibrium.forces, atol=1e-8)
    steps = [np.abs(b.positions - a.positions).max() for a, b in pairwise(states)]
    assert steps[-1] < max(steps) / 10


def test_a_held_node_is_where_it_is_held_and_springs_back(watch: Watch) -> None:
    watch.motion.take(DESIGN, 1)
    rest = watch.until_settled()[-1]
    node = int(np.flatnonzero(~DESIGN.network().fixed)[20])
    place = rest.positions[node] + [0.4, -0.2, 0.3]
    watch.motion.hold("hand", DESIGN.nodes[node], place)
    pulled = watch.until_settled()[-1]
    np.testing.assert_allclose(pulled.positions[node], place)
    assert pulled.held == (node,)
    assert np.linalg.norm(pulled.reactions[node]) > 0.1
    watch.motion.release("hand")
    back = watch.until_settled()[-1]
    np.testing.assert_allclose(back.positions, rest.positions, atol=1e-8)


def test_it_pauses_steps_and_runs(watch: Watch) -> None:
    watch.motion.take(DESIGN, 1)
    watch.until_settled()
    watch.motion.command("pause")
    watch.quiet()
    watch.motion.take(DESIGN.edited(["3 subdivide 1 1 6 1"]), 2)
    paused = watch.states.get(timeout=30)
    assert (paused.running, paused.settled, paused.steps) == (False, False, 0)
    watch.quiet()
    watch.motion.command("step")
    assert watch.states.get(timeout=30).steps == 1
    watch.quiet()
    watch.motion.command("step")
    assert watch.states.get(timeout=30).steps == 2
    watch.motion.command("run")
    assert watch.until_settled()[-1].converged


def test_reset_goes_back_to_where_the_net_was_drawn(watch: Watch) -> None:
    divided = DESIGN.edited(["3 subdivide 1 1 6 1"])
    watch.motion.take(divided, 1)
    watch.until_settled()
    watch.motion.command("pause")
    watch.quiet()
    watch.motion.command("reset")
    np.testing.assert_allclose(watch.states.get(timeout=30).positions, divided.network().positions)


def test_a_net_that_can_not_settle_says_why(watch: Watch) -> None:
    # Held far beyond what numbers can carry.
    watch.motion.take(DESIGN, 1)
    watch.until_settled()
    watch.motion.hold("hand", DESIGN.nodes[30], np.array([1e200, 0.0, 0.0]))
    last = watch.until_settled()[-1]
    assert not last.converged
    assert last.reason
    watch.motion.release("hand")
    watch.motion.command("reset")
    time.sleep(0.05)
    assert watch.until_settled()[-1].converged


def test_new_nodes_start_between_their_neighbours() -> None:
    equilibrium = DESIGN.solve()
    divided = DESIGN.edited(["30 subdivide 1 1 1 1"])
    old = {key: row for row, key in enumerate(DESIGN.nodes)}
    positions = carried(divided, DESIGN.nodes, equilibrium.positions)
    for row, key in enumerate(divided.nodes):
        if key in old:
            np.testing.assert_array_equal(positions[row], equilibrium.positions[old[key]])
    new = [row for row, key in enumerate(divided.nodes) if key not in old]
    low, high = equilibrium.positions.min(axis=0), equilibrium.positions.max(axis=0)
    assert new
    assert ((positions[new] > low) & (positions[new] < high)).all()
