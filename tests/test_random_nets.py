"""Ten thousand random nets: they converge or say why, balance, obey their laws and lose energy."""

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import springform as sf

NAN = float("nan")
TENSION, BOTH, COMPRESSION = 1, 0, -1

# Each batch is a test of its own, so that the batches spread over processes.
BATCHES, EXAMPLES = 10, 1000
quick = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.too_slow],
)
sizes = st.integers(1, 24)
seeds = st.integers(0, 2**32 - 1)


class Draft:
    """A connected, anchored net whose springs still lack their laws."""

    def __init__(self, rng: np.random.Generator, free: int) -> None:
        self.rng = rng
        self.span = 10 ** rng.uniform(-1, 1)
        anchors = int(rng.integers(1, max(2, free // 2) + 1))
        self.nodes = free + anchors
        self.positions = rng.uniform(-1, 1, (self.nodes, 3)) * self.span
        if rng.random() < 0.2:
            self.positions[:, 2] = 0.0
        order = rng.permutation(self.nodes)
        self.anchors = order[:anchors]
        # A tree holds every node; further springs join what they like.
        tree = [(order[i], order[rng.integers(0, i)]) for i in range(anchors, self.nodes)]
        known = {frozenset(pair) for pair in tree}
        more = []
        for _ in range(int(rng.integers(0, 2 * self.nodes + 1))):
            pair = rng.choice(self.nodes, 2, replace=False)
            if frozenset(pair) not in known:
                known.add(frozenset(pair))
                more.append(tuple(pair))
        self.springs = np.array(tree + more)
        self.tree = len(tree)
        self.count = len(self.springs)
        self.lengths = lengths(self.positions, self.springs)
        self.base = 10 ** rng.uniform(-2, 5)
        self.stiffness = self.base * 10 ** rng.uniform(-2, 2, self.count)
        self.rest = self.lengths * rng.uniform(0.2, 1.5, self.count)
        self.force = self.stiffness * self.lengths * rng.uniform(0.05, 1.0, self.count)

    def loads(self) -> np.ndarray:
        """Random dead loads on all nodes or on a few, on one at least."""
        loaded = self.rng.random(self.nodes) < self.rng.choice([0.2, 1.0])
        loaded[self.rng.integers(self.nodes)] = True
        size = self.base * self.span * 10 ** self.rng.uniform(-3, 1)
        return self.rng.normal(size=(self.nodes, 3)) * size * loaded[:, None]

    def network(
        self, laws: np.ndarray, loads: np.ndarray, keep: np.ndarray, **arguments: Any
    ) -> sf.Network:
        """Laws: 0 Hooke, 1 axial stiffness, 2 force density, 3 constant force."""

        def where(law: np.ndarray, values: np.ndarray) -> np.ndarray:
            return np.where(law, values, NAN)[keep]

        arguments = {"fixed": self.anchors, "sense": "tension"} | arguments
        return sf.Network(
            self.positions,
            self.springs[keep],
            stiffness=where((laws == 0) | (laws == 2), self.stiffness),
            axial_stiffness=where(laws == 1, self.stiffness * self.rest),
            force=where(laws == 3, self.force),
            rest_length=np.where(laws < 2, self.rest, np.where(laws == 2, 0.0, NAN))[keep],
            loads=loads,
            **arguments,
        )


def lengths(positions: np.ndarray, springs: np.ndarray) -> np.ndarray:
    return np.linalg.norm(positions[springs[:, 1]] - positions[springs[:, 0]], axis=1)


def tension_net(free: int, seed: int) -> sf.Network:
    """A connected, anchored net of cords that has an equilibrium.

    A spring of constant force may pull its ends together, where it has no direction and the net
    no equilibrium. Such springs therefore come with loads that hold them where the others rest,
    between nodes that the others hold; where the net starts, these loads hold nothing.
    """
    draft = Draft(np.random.default_rng([free, seed]), free)
    laws = draft.rng.integers(0, 4, draft.count)
    laws[: draft.tree] %= 3
    elastic = laws < 3
    loads = draft.loads()
    rest = sf.solve(draft.network(laws, loads, elastic))
    carried = np.zeros(draft.nodes)
    np.maximum.at(carried, draft.springs[elastic].ravel(), np.repeat(rest.forces, 2))
    carried[draft.anchors] = np.inf
    room = carried[draft.springs].min(axis=1)
    along = rest.positions[draft.springs[:, 1]] - rest.positions[draft.springs[:, 0]]
    size = np.linalg.norm(along, axis=1)
    constant = ~elastic & (size > 1e-2 * draft.span) & (room > 1e-3 * rest.forces.max())
    draft.force = np.minimum(draft.force, 10 * room)
    pulls = (draft.force[constant] / size[constant])[:, None] * along[constant]
    np.add.at(loads, draft.springs[constant, 0], -pulls)
    np.add.at(loads, draft.springs[constant, 1], pulls)
    return draft.network(laws, loads, elastic | constant)


def any_net(free: int, seed: int) -> sf.Network:
    """A net of all senses; nodes may be loose, held along an axis, or in one place."""
    draft = Draft(np.random.default_rng([free, seed, 1]), free)
    rng = draft.rng
    if rng.random() < 0.3:
        draft.positions[rng.integers(draft.nodes)] = draft.positions[rng.integers(draft.nodes)]
        draft.rest = np.maximum(draft.rest, 1e-3 * draft.span)
    axes = [(int(node), "xyz"[rng.integers(3)]) for node in rng.integers(0, draft.nodes, 3)]
    held = rng.random()
    keep = rng.random(draft.count) < rng.choice([0.7, 1.0], p=[0.3, 0.7])
    # Constant forces and struts leave few nets an equilibrium: half of the nets have none.
    laws = rng.integers(0, rng.choice([3, 4]), draft.count)
    senses = ("both", "tension", "compression")[: rng.integers(1, 4)]
    return draft.network(
        laws,
        draft.loads() * rng.integers(0, 2),
        keep,
        fixed=draft.anchors if held < 0.8 else draft.anchors[:1] if held < 0.95 else [],
        fixed_axes=axes[: rng.integers(0, 4)],
        sense=list(rng.choice(senses, keep.sum())),
    )


def forces_by_law(network: sf.Network, size: np.ndarray) -> np.ndarray:
    elastic = network.force + network.stiffness * (size - network.rest_length)
    pulled = np.where(network.sense == TENSION, np.maximum(elastic, 0.0), elastic)
    return np.where(network.sense == COMPRESSION, np.minimum(pulled, 0.0), pulled)


def energy(network: sf.Network, positions: np.ndarray) -> tuple[float, float]:
    """Potential energy of springs and loads [J], and the sum of the sizes of its terms."""
    size = lengths(positions, network.springs)
    force = forces_by_law(network, size)
    soft = network.stiffness == 0
    springs = np.where(soft, force * size, 0.5 * force**2 / np.where(soft, 1, network.stiffness))
    work = network.loads * positions
    return springs.sum() - work.sum(), np.abs(springs).sum() + np.abs(work).sum()


def check(network: sf.Network, result: sf.Equilibrium) -> None:
    """What holds of every result, converged or not."""
    for values in (result.positions, result.forces, result.reactions, result.residual):
        assert np.isfinite(values).all()
    assert result.converged == (result.reason == "")
    size = lengths(result.positions, network.springs)
    scale = max(np.abs(result.forces).max(initial=0.0), np.abs(network.loads).max(initial=0.0))
    rounding = 1e-14 * (network.stiffness * (size + network.rest_length)).max(initial=0.0)
    law = forces_by_law(network, size)
    np.testing.assert_allclose(result.forces, law, rtol=1e-12, atol=rounding)
    np.testing.assert_array_equal(
        result.positions[network.fixed_axes], network.positions[network.fixed_axes]
    )
    np.testing.assert_array_equal(result.reactions[~network.fixed_axes], 0.0)
    if not result.converged:
        return
    # Joint by joint, reactions, loads and forces balance; so do their sums.
    along = result.positions[network.springs[:, 1]] - result.positions[network.springs[:, 0]]
    pulls = (result.forces / np.where(size > 0, size, 1.0))[:, None] * along
    balance = network.loads + result.reactions
    np.add.at(balance, network.springs[:, 0], pulls)
    np.add.at(balance, network.springs[:, 1], -pulls)
    allowed = 1e-9 * scale + len(network.springs) * rounding
    assert np.linalg.norm(balance, axis=1).max() <= allowed
    total = np.linalg.norm((network.loads + result.reactions).sum(axis=0))
    assert total <= len(network.positions) * allowed


def check_energy(network: sf.Network, result: sf.Equilibrium) -> None:
    before, terms_before = energy(network, network.positions)
    after, terms_after = energy(network, result.positions)
    assert after <= before + 1e-12 * (terms_before + terms_after)


@pytest.mark.parametrize("batch", range(BATCHES // 2))
def test_cords_converge(batch: int) -> None:
    @quick
    @given(sizes, seeds)
    def converges(free: int, seed: int) -> None:
        network = tension_net(free, seed + (batch << 32))
        result = sf.solve(network)
        assert result.converged, (result.reason, result.residual)
        assert result.residual <= 1e-9
        check(network, result)
        check_energy(network, result)

    converges()


@pytest.mark.parametrize("batch", range(BATCHES // 2))
def test_any_net_converges_or_says_why(batch: int) -> None:
    @quick
    @given(sizes, seeds)
    def converges_or_says_why(free: int, seed: int) -> None:
        network = any_net(free, seed + (batch << 32))
        result = sf.solve(network)
        check(network, result)
        # Springs of no length at the start are parted, which may take energy.
        directed = lengths(network.positions, network.springs).min(initial=1.0) > 0
        if result.converged and directed:
            check_energy(network, result)

    converges_or_says_why()
