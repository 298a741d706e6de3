"""Ten thousand random nets: they converge or say why, balance, obey their laws and lose energy."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import springform as sf
from springform.spring_laws import NO_CURVE

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
        # What came later is drawn on its own, so that the nets of before stay.
        self.more = np.random.default_rng(rng.bit_generator.seed_seq.spawn(1)[0])
        self.curves = [self._curve() for _ in range(2)]
        warm = self.more.random() < 0.3
        self.warmth = self.more.uniform(-0.05, 0.05, self.count) * warm

    def _curve(self) -> sf.Curve:
        """A measured cord that goes on pulling harder beyond its last point."""
        strains = np.cumsum(self.more.uniform(0.02, 0.3, self.more.integers(1, 6)))
        slopes = 10 ** self.more.uniform(-1, 1, len(strains))
        slopes[-1] = slopes[-2:].max()
        forces = np.cumsum(slopes * np.diff(strains, prepend=0.0)) * self.base * self.span
        pushed = [[-0.1, -0.05 * forces[0]]] if self.more.random() < 0.5 else []
        return sf.Curve([*pushed, [0.0, 0.0], *np.column_stack([strains, forces])])

    def with_curves(self, laws: np.ndarray) -> np.ndarray:
        """Laws of which some Hooke and axial ones are measured curves instead."""
        share = self.more.choice([0.0, 0.3, 1.0])
        curved = (laws < 2) & (self.more.random(self.count) < share)
        return np.where(curved, self.more.integers(4, 6, self.count), laws)

    def rods(self, keep: np.ndarray) -> dict[str, Any]:
        """A rod along springs that are kept, if there are two in a row."""
        if self.more.random() < 0.6:
            return {}
        ways = [*self.springs[keep].tolist(), *self.springs[keep][:, ::-1].tolist()]
        nodes = list(ways[self.more.integers(len(ways))]) if ways else []
        while after := [b for a, b in ways if nodes and a == nodes[-1] and b not in nodes]:
            nodes.append(after[self.more.integers(len(after))])
        around = np.array([*pairwise(range(len(nodes))), (-1, 0)])
        if len(nodes) < 3 or lengths(self.positions[nodes], around).min() == 0:
            return {}
        stiffness = self.base * self.span**3 * 10 ** self.more.uniform(-4, 1)
        closed = [nodes[-1], nodes[0]] in ways and self.more.random() < 0.7
        return {"rods": [sf.Rod(nodes, stiffness, closed)]}

    def followers(self) -> dict[str, Any]:
        """Pressure on a few cells, and weight of springs."""
        found: dict[str, Any] = {}
        if self.nodes > 2 and self.more.random() < 0.15:
            size = self.base / self.span * 10 ** self.more.uniform(-3, 1)
            cells = [
                self.more.permutation(self.nodes)[: self.more.integers(3, 5)].tolist()
                for _ in range(self.more.integers(1, 4))
            ]
            found["pressure"] = [(cell, size * self.more.normal()) for cell in cells]
        if self.more.random() < 0.15:
            found["self_weight"] = self.base * 10 ** self.more.uniform(-3, 0)
        return found

    def supports(self) -> dict[str, Any]:
        """Some free nodes that are held along axes, or slide on a line or in a plane."""
        free = np.setdiff1d(np.arange(self.nodes), self.anchors)
        some = self.more.permutation(free)[: self.more.integers(0, 4)]
        axes: list[tuple[int, str]] = []
        slides: list[sf.network.Slide] = []
        for node in some.tolist():
            if (kind := int(self.more.integers(3))) == 0:
                axes += [(node, axis) for axis in "xyz"[: self.more.integers(1, 3)]]
            else:
                slides.append((node, ("line", "plane")[kind - 1], self.more.normal(size=3)))
        return {"fixed_axes": axes, "slides": slides}

    def loads(self) -> np.ndarray:
        """Random dead loads on all nodes or on a few, on one at least."""
        loaded = self.rng.random(self.nodes) < self.rng.choice([0.2, 1.0])
        loaded[self.rng.integers(self.nodes)] = True
        size = self.base * self.span * 10 ** self.rng.uniform(-3, 1)
        return self.rng.normal(size=(self.nodes, 3)) * size * loaded[:, None]

    def network(
        self, laws: np.ndarray, loads: np.ndarray, keep: np.ndarray, **arguments: Any
    ) -> sf.Network:
        """Laws: 0 Hooke, 1 axial stiffness, 2 force density, 3 constant force, 4 and 5 curves."""

        def where(law: np.ndarray, values: np.ndarray) -> np.ndarray:
            return np.where(law, values, NAN)[keep]

        arguments = {"fixed": self.anchors, "sense": "tension"} | arguments
        return sf.Network(
            self.positions,
            self.springs[keep],
            stiffness=where((laws == 0) | (laws == 2), self.stiffness),
            axial_stiffness=where(laws == 1, self.stiffness * self.rest),
            force=where(laws == 3, self.force),
            rest_length=np.where(laws == 2, 0.0, np.where(laws == 3, NAN, self.rest))[keep],
            curve=[self.curves[law - 4] if law > 3 else None for law in laws[keep]],
            thermal_strain=self.warmth[keep],
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
    laws = draft.with_curves(laws)
    elastic = laws != 3
    loads = draft.loads()
    supports = draft.supports()
    rest = sf.solve(draft.network(laws, loads, elastic, **supports))
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
    return draft.network(laws, loads, elastic | constant, **supports)


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
    laws = draft.with_curves(rng.integers(0, rng.choice([3, 4]), draft.count))
    senses = ("both", "tension", "compression")[: rng.integers(1, 4)]
    fixed = draft.anchors if held < 0.8 else draft.anchors[:1] if held < 0.95 else []
    axes = axes[: rng.integers(0, 4)]
    loads = draft.loads() * rng.integers(0, 2)
    sense = list(rng.choice(senses, keep.sum()))
    supports = draft.supports()
    taken = {*map(int, fixed), *(node for node, _ in axes + supports["fixed_axes"])}
    return draft.network(
        laws,
        loads,
        keep,
        fixed=fixed,
        fixed_axes=axes + supports["fixed_axes"],
        slides=[slide for slide in supports["slides"] if slide[0] not in taken],
        sense=sense,
        **draft.rods(keep),
        **draft.followers(),
    )


def forces_by_law(network: sf.Network, size: np.ndarray) -> np.ndarray:
    elastic = network.force + network.stiffness * (size - network.rest_length)
    for number, curve in enumerate(network.curves):
        here = network.curve == number
        strain = (size[here] - network.rest_length[here]) / network.rest_length[here]
        elastic[here] = curve.force(strain)
    pulled = np.where(network.sense == TENSION, np.maximum(elastic, 0.0), elastic)
    return np.where(network.sense == COMPRESSION, np.minimum(pulled, 0.0), pulled)


def bends(network: sf.Network) -> Iterator[tuple[list[int], float, float, float]]:
    """Three nodes of a rod, the lengths of its links between them, and EI."""
    for rod in network.rods:
        count = len(rod.nodes)
        for first in range(count if rod.closed else count - 2):
            nodes = [rod.nodes[(first + step) % count] for step in range(3)]
            links = [rod.lengths[(first + step) % len(rod.lengths)] for step in range(2)]
            yield nodes, *links, rod.bending_stiffness


def bending(network: sf.Network, positions: np.ndarray) -> tuple[float, np.ndarray]:
    """Energy of rods [J], and their pulls on the nodes [N]: moments over lever arms."""
    energy, pulls = 0.0, np.zeros(positions.shape)
    for (a, b, c), first, second, stiffness in bends(network):
        links = positions[b] - positions[a], positions[c] - positions[b]
        sizes = [max(np.linalg.norm(link), 1e-300) for link in links]
        units = [link / size for link, size in zip(links, sizes, strict=True)]
        cosine = float(units[0] @ units[1])
        chord = max(np.sqrt(max(first**2 + second**2 + 2 * first * second * cosine, 0)),
                    1e-9 * (first + second))  # fmt: skip
        energy += 2 * stiffness * (first + second - chord) / (first * second)
        rate = 2 * stiffness / chord
        at_a = -rate * (units[1] - cosine * units[0]) / sizes[0]
        at_c = rate * (units[0] - cosine * units[1]) / sizes[1]
        pulls[a] += at_a
        pulls[c] += at_c
        pulls[b] -= at_a + at_c
    return energy, pulls


def energy(network: sf.Network, positions: np.ndarray) -> tuple[float, float]:
    """Potential energy of springs, rods and loads [J], and the sum of the sizes of its terms."""
    size = lengths(positions, network.springs)
    force = forces_by_law(network, size)
    soft = network.stiffness == 0
    springs = np.where(soft, force * size, 0.5 * force**2 / np.where(soft, 1, network.stiffness))
    if network.curves:
        # Areas under curves are checked with the laws.
        at = sf.solve(network, start=positions, iterations=0)
        np.testing.assert_allclose(at.positions, positions, atol=1e-9 * np.abs(positions).max())
        springs = np.where(network.curve == NO_CURVE, springs, at.spring_energies)
    work = network.loads * positions
    bent, _ = bending(network, positions)
    # A rod's energy is a difference of lengths, which round.
    links = sum(one.bending_stiffness / min(one.lengths) for one in network.rods)
    terms = np.abs(springs).sum() + np.abs(work).sum() + bent + links
    return springs.sum() + bent - work.sum(), terms


def check(network: sf.Network, result: sf.Equilibrium) -> None:
    """What holds of every result, converged or not."""
    for values in (result.positions, result.forces, result.reactions, result.residual):
        assert np.isfinite(values).all()
    assert result.converged == (result.reason == "")
    size = lengths(result.positions, network.springs)
    scale = max(np.abs(result.forces).max(initial=0.0), np.abs(result.loads).max(initial=0.0))
    rounding = 1e-14 * (network.stiffness * (size + network.rest_length)).max(initial=0.0)
    if network.self_weight.size or network.pressure:
        # A net that only such loads stretch may shrink to a point, and its loads with it.
        start = lengths(network.positions, network.springs)
        rounding = max(rounding, 1e-14 * (network.stiffness * start).max(initial=0.0))
    law = forces_by_law(network, size)
    np.testing.assert_allclose(result.forces, law, rtol=1e-12, atol=rounding)
    np.testing.assert_array_equal(
        result.positions[network.fixed_axes], network.positions[network.fixed_axes]
    )
    _, bent = bending(network, result.positions)
    sliding = np.zeros(len(network.positions), dtype=bool)
    for node, in_plane, along in network.slides:
        sliding[node] = True
        moved = result.positions[node] - network.positions[node]
        unit = np.array(along) / np.linalg.norm(along)
        held = result.reactions[node]
        off = (moved @ unit) if in_plane else moved - (moved @ unit) * unit
        free = held - (held @ unit) * unit if in_plane else held @ unit
        reach = np.abs(result.positions).max()
        assert np.abs(off).max() <= 1e-12 * (reach + np.abs(network.positions).max())
        size_of = max(scale, np.abs(bent).max(initial=0.0), np.linalg.norm(held))
        assert np.abs(free).max() <= 1e-12 * size_of + rounding
    np.testing.assert_array_equal(result.reactions[~network.fixed_axes & ~sliding[:, None]], 0.0)
    if not result.converged:
        return
    # Joint by joint, reactions, loads, forces and rods balance; so do reactions and loads.
    along = result.positions[network.springs[:, 1]] - result.positions[network.springs[:, 0]]
    pulls = (result.forces / np.where(size > 0, size, 1.0))[:, None] * along
    balance = result.loads + result.reactions
    np.add.at(balance, network.springs[:, 0], pulls)
    np.add.at(balance, network.springs[:, 1], -pulls)
    rods = 1e-14 * np.abs(bent).max(initial=0.0) + 1e-14 * sum(
        8 * stiffness / min(first, second) ** 2 for _, first, second, stiffness in bends(network)
    )
    allowed = 1e-9 * scale + len(network.springs) * rounding + rods
    assert np.linalg.norm(balance + bent, axis=1).max() <= allowed
    total = np.linalg.norm((result.loads + result.reactions).sum(axis=0))
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
        dead = not network.pressure and not network.self_weight.size
        if result.converged and directed and dead:
            check_energy(network, result)

    converges_or_says_why()
