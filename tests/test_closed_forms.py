"""Bare nets against closed forms: cables, minimal trees, surfaces, strings, bars and chains.

A minimal catenoid is not among them: a net of constant forces is geodesic, not minimal.
"""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import springform as sf

UP = np.array([0.0, 0.0, 1.0])


def solved(network: sf.Network, **arguments: Any) -> sf.Equilibrium:
    """The equilibrium, whose reactions balance the loads as forces and as moments."""
    result = sf.solve(network, **arguments)
    assert result.converged, result.reason
    outer = network.loads + result.reactions
    scale = max(np.abs(result.forces).max(), np.abs(network.loads).max())
    assert np.abs(outer.sum(axis=0)).max() <= 1e-9 * scale * len(outer)
    reach = np.abs(result.positions).max()
    moment = np.cross(result.positions, outer).sum(axis=0)
    assert np.abs(moment).max() <= 1e-9 * scale * reach * len(outer)
    return result


def chain(
    start: np.ndarray, end: np.ndarray, count: int, *, sag: float = 0.0, **arguments: Any
) -> sf.Network:
    """Springs one after the other between two fixed points, drawn as a line or a parabola."""
    share = np.linspace(0, 1, count + 1)[:, None]
    positions = start + share * (end - start) - 4 * sag * share * (1 - share) * UP
    return sf.Network(positions, list(pairwise(range(count + 1))), [0, count], **arguments)


class Catenary:
    """The elastic catenary between supports at one level (Irvine, Cable structures, 1981, 2.3)."""

    def __init__(self, span: float, unstretched: float, weight: float, stiffness: float) -> None:
        self.length, self.weight, self.stiffness = unstretched, weight, stiffness
        far = 10 * weight * unstretched * max(1.0, unstretched / abs(unstretched - span))
        self.pull = brentq(
            lambda pull: self._place(pull, unstretched)[0] - span, 1e-9 * far, far, xtol=1e-13
        )

    def _place(self, pull: float, at: np.ndarray | float) -> tuple[Any, Any]:
        half = self.weight * self.length / 2
        lifts = half - self.weight * np.asarray(at)
        x = pull * np.asarray(at) / self.stiffness + pull / self.weight * (
            np.arcsinh(half / pull) - np.arcsinh(lifts / pull)
        )
        z = (lifts**2 - half**2) / (2 * self.weight * self.stiffness) + (
            np.hypot(pull, lifts) - np.hypot(pull, half)
        ) / self.weight
        return x, z

    def positions(self, count: int) -> np.ndarray:
        x, z = self._place(self.pull, np.linspace(0, self.length, count + 1))
        return np.column_stack([x, np.zeros_like(x), z])

    def chain(self, span: float, count: int) -> sf.Network:
        piece = self.length / count
        loads = np.full((count + 1, 1), -self.weight * piece) * UP
        loads[[0, -1]] /= 2
        ends = np.zeros(3), np.array([span, 0.0, 0.0])
        # From a straight line: no springs hold it against its weight at first.
        return chain(
            *ends, count, axial_stiffness=self.stiffness, rest_length=piece,
            sense="tension", loads=loads,
        )  # fmt: skip


@pytest.mark.parametrize(
    ("unstretched", "stiffness"),
    [(1.2, 20.0), (0.9, 10.0), (1.2, 1e4), (2.0, 1e4)],
    ids=["elastic, sagging", "elastic, taut", "stiff", "stiff, deep"],
)
def test_a_heavy_cable_converges_to_the_catenary(
    unstretched: float, stiffness: float, record_property: Any
) -> None:
    span, weight = 1.0, 1.0
    exact = Catenary(span, unstretched, weight, stiffness)
    counts = [8, 16, 32, 64, 128]
    errors, pulls = [], []
    for count in counts:
        result = solved(exact.chain(span, count))
        errors.append(np.abs(result.positions - exact.positions(count)).max())
        pulls.append(abs(np.abs(result.reactions[0, 0]) - exact.pull))
    for name, values in (("position", errors), ("pull", pulls)):
        orders = np.log2(np.divide(values[:-1], values[1:]))
        record_property(f"{name} errors", str(values))
        record_property(f"{name} order", str(orders))
        print(f"{name}: errors {np.array(values)}, observed orders {orders}")
        assert np.all((orders[1:] > 1.9) & (orders[1:] < 2.1)), orders


def test_a_stiff_cable_is_the_inextensible_catenary() -> None:
    span, length = 1.0, 1.5
    # sinh(u)/u = length/span with u = w span / 2H.
    u = brentq(lambda u: np.sinh(u) / u - length / span, 1e-3, 10)
    exact = Catenary(span, length, 1.0, 2e4)
    assert exact.pull == pytest.approx(span / (2 * u), rel=1e-4)
    result = solved(exact.chain(span, 100))
    sag = span / (2 * u) * (np.cosh(u) - 1)
    assert -result.positions[:, 2].min() == pytest.approx(sag, rel=3e-4)
    assert result.reactions[0, 2] == pytest.approx(length / 2, rel=1e-9)


def acute_triangle(rng: np.random.Generator) -> np.ndarray:
    """Corners in a random plane in space, all angles below 85°."""
    while True:
        corners = rng.uniform(-1, 1, (3, 3))
        sides = np.roll(corners, -1, axis=0) - corners
        cosines = [-(sides[i] @ sides[i - 1]) for i in range(3)]
        sizes = np.linalg.norm(sides, axis=1)
        cosines = [cosines[i] / (sizes[i] * sizes[i - 1]) for i in range(3)]
        if min(cosines) > np.cos(np.radians(85)) and sizes.min() > 0.2:
            return corners


def meeting(corners: np.ndarray, weights: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Where three constant forces balance, by the mechanics."""
    network = sf.Network(
        [*corners, start], [[0, 3], [1, 3], [2, 3]], [0, 1, 2], force=weights, sense="tension"
    )
    return np.asarray(solved(network, tolerance=1e-11).positions[3])


def between(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.degrees(np.arccos(a @ b / np.linalg.norm(a) / np.linalg.norm(b))))


@pytest.mark.parametrize("seed", range(50))
def test_equal_pulls_meet_at_the_fermat_point(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = acute_triangle(rng)
    found = meeting(corners, np.full(3, 2.0), corners.T @ rng.dirichlet([1, 1, 1]))
    rays = corners - found
    np.testing.assert_allclose([between(rays[i], rays[i - 1]) for i in range(3)], 120, atol=1e-5)
    # Trilinears csc(A + 60°) : csc(B + 60°) : csc(C + 60°).
    sides = np.linalg.norm(np.roll(corners, -1, axis=0) - np.roll(corners, 1, axis=0), axis=1)
    angles = [between(corners[i - 2] - corners[i], corners[i - 1] - corners[i]) for i in range(3)]
    shares = sides / np.sin(np.radians(np.array(angles) + 60))
    np.testing.assert_allclose(found, shares @ corners / shares.sum(), atol=1e-7)


@pytest.mark.parametrize("seed", range(50))
def test_unequal_pulls_meet_by_the_law_of_sines(seed: int) -> None:
    rng = np.random.default_rng([seed, 1])
    # The point and its rays come first: forces follow from the angles (Lami).
    turns = np.radians(rng.dirichlet([8, 8, 8]) * 360)
    if turns.max() > np.radians(170):
        turns = np.radians([100.0, 120.0, 140.0])
    ways = np.cumsum(turns)
    rays = np.column_stack([np.cos(ways), np.sin(ways), np.zeros(3)])
    point = rng.uniform(-1, 1, 3)
    corners = point + rays * rng.uniform(0.5, 2, (3, 1))
    # Opposite ray i lies the angle between the other two, turns[i - 1] beyond the next.
    weights = np.sin([turns[2], turns[0], turns[1]])
    found = meeting(corners, weights, corners.mean(axis=0))
    np.testing.assert_allclose(found, point, atol=1e-7)


@pytest.mark.parametrize("count", [1, 2, 5, 10, 40])
def test_equal_force_densities_between_straight_edges_are_a_hypar(count: int) -> None:
    size = count + 1
    u, v = np.meshgrid(np.linspace(0, 1, size), np.linspace(0, 1, size), indexing="ij")
    corners = np.array([[0, 0, 0], [0, 7, 3], [8, 0, 4], [9, 8, -1]], dtype=float)
    weights = np.stack([(1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v], axis=-1)
    exact = (weights @ corners).reshape(-1, 3)
    number = np.arange(size * size).reshape(size, size)
    springs = np.vstack(
        [
            np.column_stack([number[:-1].ravel(), number[1:].ravel()]),
            np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()]),
        ]
    )
    edge = np.zeros((size, size), dtype=bool)
    edge[[0, -1]] = edge[:, [0, -1]] = True
    start = np.where(edge.ravel()[:, None], exact, 5.0)
    result = solved(sf.Network(start, springs, edge.ravel(), stiffness=3.0))
    np.testing.assert_allclose(result.positions, exact, atol=1e-12 * 10 * size)


@pytest.mark.parametrize("prestress", [0.0, 1.0, 50.0])
@pytest.mark.parametrize("load", [1e-3, 1.0, 1e3])
def test_a_string_stiffens_with_the_cube_of_its_deflection(prestress: float, load: float) -> None:
    half, stiffness = 1.0, 1e4
    network = sf.Network(
        [[-half, 0, 0], [0, 0, 0], [half, 0, 0]], [[0, 1], [1, 2]], [0, 2],
        axial_stiffness=stiffness, prestress=prestress, sense="tension",
        loads=[[0, 0, 0], [0, 0, -load], [0, 0, 0]],
    )  # fmt: skip
    rest = half / (1 + prestress / stiffness)

    def carried(sag: float) -> float:
        length = np.hypot(half, sag)
        return 2 * stiffness * (length - rest) / rest * sag / length

    sag = brentq(lambda sag: carried(sag) - load, 0, 10, xtol=1e-16, rtol=1e-15)
    result = solved(network)
    assert -result.positions[1, 2] == pytest.approx(sag, rel=1e-6)
    # P = 2 T θ + EA θ³ (1 - 3/4 θ² + …) with θ the sag over half the span.
    slope = sag / half
    cubic = 2 * prestress * slope + stiffness * slope**3
    assert cubic == pytest.approx(load, rel=slope**2 + 1e-9)


@pytest.mark.parametrize("sense", ["both", "compression"])
def test_a_shallow_frame_follows_its_branch_up_to_the_limit(sense: str) -> None:
    half, rise, stiffness = 1.0, 0.2, 1e3
    rest = np.hypot(half, rise)

    def carried(sink: float) -> float:
        length = np.hypot(half, rise - sink)
        return 2 * stiffness * (rest - length) / rest * (rise - sink) / length

    # The limit point lies where the bars are (rest² half)^(1/3) long.
    limit = rise - np.sqrt((rest * half**2) ** (2 / 3) - half**2)
    assert carried(limit) > max(carried(0.98 * limit), carried(1.02 * limit))
    for share in (0.1, 0.5, 0.9, 0.99):
        load = share * carried(limit)
        sink = brentq(lambda sink, load=load: carried(sink) - load, 0, limit, xtol=1e-15)
        network = sf.Network(
            [[-half, 0, 0], [0, 0, rise], [half, 0, 0]], [[0, 1], [1, 2]], [0, 2],
            axial_stiffness=stiffness, sense=sense, loads=[[0, 0, 0], [0, 0, -load], [0, 0, 0]],
            fixed_axes=[(1, "y")],
        )  # fmt: skip
        result = solved(network)
        assert result.positions[1, 2] == pytest.approx(rise - sink, rel=1e-7)
        force = stiffness * (np.hypot(half, rise - sink) - rest) / rest
        np.testing.assert_allclose(result.forces, force, rtol=1e-7)


@pytest.mark.parametrize("push", [1.0, -1.0])
def test_one_cord_of_a_cross_carries(push: float) -> None:
    size, stiffness, load = 2.0, 1e8, 10.0 * push
    corners = [[0, 0, 0], [size, 0, 0], [0, 0, size], [size, 0, size]]
    springs = [[0, 2], [1, 3], [2, 3], [0, 3], [1, 2]]
    network = sf.Network(
        corners, springs, [0, 1], axial_stiffness=stiffness,
        sense=["both", "both", "both", "tension", "tension"],
        loads=[[0, 0, 0], [0, 0, 0], [load, 0, 0], [0, 0, 0]],
        fixed_axes=[(2, "y"), (3, "y")],
    )  # fmt: skip
    forces = solved(network).forces
    left, right, beam, rising, falling = forces
    taut, slack, leeward, windward = (
        (rising, falling, right, left) if push > 0 else (falling, rising, left, right)
    )
    assert slack == 0.0
    assert taut == pytest.approx(abs(load) * np.sqrt(2), rel=1e-5)
    assert leeward == pytest.approx(-abs(load), rel=1e-5)
    assert windward == pytest.approx(0.0, abs=1e-5)
    assert beam == pytest.approx(-10.0 if push > 0 else 0.0, abs=1e-4)


@pytest.mark.parametrize("count", [1, 2, 7, 50])
def test_a_chain_hangs_as_long_as_its_springs_say(count: int) -> None:
    rng = np.random.default_rng(count)
    stiffness = 10 ** rng.uniform(0, 3, count)
    rest = rng.uniform(0.1, 1, count)
    weights = rng.uniform(0.1, 1, count)
    start = np.vstack([np.zeros(3), rng.uniform(-1, 1, (count, 3))])
    network = sf.Network(
        start, list(pairwise(range(count + 1))), [0], stiffness=stiffness, rest_length=rest,
        sense="tension", loads=np.vstack([np.zeros(3), -weights[:, None] * UP]),
    )  # fmt: skip
    result = solved(network)
    carried = np.cumsum(weights[::-1])[::-1]
    depth = np.concatenate([[0.0], np.cumsum(rest + carried / stiffness)])
    np.testing.assert_allclose(result.forces, carried, rtol=1e-7)
    np.testing.assert_allclose(result.positions, -depth[:, None] * UP, atol=1e-7 * depth[-1])
    np.testing.assert_allclose(result.reactions[0], weights.sum() * UP, atol=1e-7)
