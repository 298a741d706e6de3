"""Laws of springs, loads and supports of bare nets, each against what defines it."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

import springform as sf
from equilibria import UP, chain, solved

POINTS = [[-0.02, -1.0], [0, 0], [0.05, 12.0], [0.1, 15.0], [0.2, 40.0], [0.25, 41.0]]
exact = settings(max_examples=200, deadline=None, derandomize=True, database=None)


def pchip(points: np.ndarray, strain: np.ndarray) -> np.ndarray:
    """SciPy's monotone cubic, continued straight, in the end no less steep than the last chord."""
    curve = PchipInterpolator(points[:, 0], points[:, 1])
    inside = np.clip(strain, points[0, 0], points[-1, 0])
    [run, rise] = points[-1] - points[-2]
    slope = curve.derivative()(inside)
    slope = np.where(strain > points[-1, 0], np.maximum(slope, rise / run), slope)
    return curve(inside) + slope * (strain - inside)


@exact
@given(
    st.lists(st.tuples(st.floats(0.01, 0.3), st.floats(0, 50)), min_size=1, max_size=8),
    st.integers(0, 3),
)
def test_a_curve_is_scipys_monotone_cubic(steps: list[tuple[float, float]], below: int) -> None:
    points = np.vstack([[0, 0], np.cumsum(steps, axis=0)])
    points -= points[min(below, len(points) - 2)]
    points[-1, 1] += 1.0
    strain = np.linspace(points[0, 0] - 0.2, points[-1, 0] + 0.2, 300)
    found = sf.Curve(points).force(strain)
    np.testing.assert_allclose(found, pchip(points, strain), atol=1e-11 * np.abs(points).max())


@pytest.mark.parametrize("sense", ["both", "tension"])
@pytest.mark.parametrize("length", [0.9, 0.99, 1.0, 1.03, 1.17, 1.25, 1.6])
def test_a_spring_follows_its_curve_and_stores_the_area_under_it(length: float, sense: str) -> None:
    rest, points = 2.0, np.array(POINTS)
    curve = sf.Curve(points)
    network = sf.Network(
        [[0, 0, 0], [rest * length, 0, 0]], [[0, 1]], [0, 1], curve=curve, rest_length=rest,
        sense=sense, area=2e-6,
    )  # fmt: skip
    result = sf.solve(network)

    def force(strain: float) -> float:
        pulled = float(pchip(points, np.array(strain)))
        return max(pulled, 0.0) if sense == "tension" else pulled

    strain = length - 1
    assert result.forces[0] == pytest.approx(force(strain), rel=1e-12, abs=1e-12)
    energy, _ = quad(force, 0, strain, points=sorted({0.0, *points[:, 0]}), epsabs=1e-13)
    assert result.spring_energies[0] == pytest.approx(rest * energy, rel=1e-9, abs=1e-12)
    assert result.strains[0] == pytest.approx(strain, abs=1e-14)
    assert result.stresses[0] == pytest.approx(result.forces[0] / 2e-6)
    assert result.lengths[0] == pytest.approx(rest * length)


def test_a_weight_on_a_measured_cord_hangs_where_its_curve_says() -> None:
    points, rest = np.array(POINTS), 1.5
    for load in (5.0, 14.0, 30.0, 40.5):
        network = sf.Network(
            [[0, 0, 0], [0.3, 0.1, -1]], [[0, 1]], [0], curve=sf.Curve(points), rest_length=rest,
            sense="tension", loads=[[0, 0, 0], [0, 0, -load]],
        )  # fmt: skip
        result = solved(network)
        assert pchip(points, result.strains)[0] == pytest.approx(load, rel=1e-8)
        np.testing.assert_allclose(result.positions[1, :2], 0, atol=1e-6)


STIFF = {"axial_stiffness": 500.0, "rest_length": 0.8}
CURVED = {"curve": sf.Curve([[0, 0], [0.1, 50.0]]), "rest_length": 0.8}


@pytest.mark.parametrize("law", [STIFF, CURVED], ids=["axial", "curve"])
@pytest.mark.parametrize("warming", [-0.01, 0.0, 0.02])
def test_warmth_lengthens_cords_and_keeps_their_axial_stiffness(
    law: dict[str, Any], warming: float
) -> None:
    network = chain(np.zeros(3), np.array([2.0, 0, 0]), 2, thermal_strain=warming, **law)
    result = solved(network)
    rest = 0.8 * (1 + warming)
    np.testing.assert_allclose(network.rest_length, rest)
    # F = EA (L - L0)/L0 with the lengthened L0, and strain refers to that.
    np.testing.assert_allclose(result.forces, 500.0 * (1 - rest) / rest, rtol=1e-12)
    np.testing.assert_allclose(result.strains * 500.0, result.forces, rtol=1e-12)


def test_warmth_does_not_weigh() -> None:
    ends = np.zeros(3), np.array([2.0, 0, 0])
    cold = chain(*ends, 4, **STIFF, self_weight=3.0)
    warm = chain(*ends, 4, **STIFF, self_weight=3.0, thermal_strain=0.05)
    np.testing.assert_array_equal(warm.loads, cold.loads)
    assert cold.loads.sum() == pytest.approx(-3.0 * 4 * 0.8)


@pytest.mark.parametrize("rest_length", [0.0, 0.3])
def test_self_weight_is_halved_to_both_ends(rest_length: float) -> None:
    network = chain(
        np.zeros(3), np.array([2.0, 0, 0.5]), 5, stiffness=40.0, rest_length=rest_length,
        self_weight=np.arange(1.0, 6.0), sense="tension",
    )  # fmt: skip
    result = solved(network)
    # By the unstressed length, or by the length at equilibrium where there is none.
    weights = np.arange(1.0, 6.0) * (rest_length or result.lengths)
    expected = np.zeros((6, 3))
    np.add.at(expected[:, 2], network.springs.ravel(), np.repeat(-weights / 2, 2))
    np.testing.assert_allclose(result.loads, expected, atol=1e-12)
    assert result.reactions[:, 2].sum() == pytest.approx(weights.sum(), rel=1e-9)


@pytest.mark.parametrize("pull", [-20.0, 15.0])
def test_a_bar_pulls_and_pushes(pull: float) -> None:
    network = sf.Network(
        [[0, 0, 0], [1, 0, 0]], [[0, 1]], [0], axial_stiffness=100.0, sense="both",
        loads=[[0, 0, 0], [pull, 0, 0]], slides=[(1, "line", [2.0, 0, 0])],
    )  # fmt: skip
    result = solved(network)
    assert result.forces[0] == pytest.approx(pull, rel=1e-9)
    assert result.positions[1, 0] == pytest.approx(1 + pull / 100.0, rel=1e-9)
    assert result.spring_energies[0] == pytest.approx(pull**2 / 200.0, rel=1e-8)
    np.testing.assert_allclose(result.reactions, [[-pull, 0, 0], [0, 0, 0]], atol=1e-7)


@pytest.mark.parametrize("path", ["line", "plane"])
def test_a_node_slides_where_it_may(path: str) -> None:
    along = np.array([1.0, 2.0, -0.5])
    anchors = np.array([[3.0, 0, 0], [0, 2.0, 1.0], [-1.0, -1.0, 2.0]])
    stiffness = np.array([1.0, 2.0, 3.0])
    network = sf.Network(
        [*anchors, [0.2, 0.1, 0]], [[0, 3], [1, 3], [2, 3]], [0, 1, 2], stiffness=stiffness,
        slides=[(3, path, along)], loads=[[0, 0, 0]] * 3 + [[0, 0, -4.0]],
    )  # fmt: skip
    result = solved(network)
    # Where a spring without rest length would rest, moved onto the way at the least cost.
    free = (stiffness @ anchors + [0, 0, -4.0]) / stiffness.sum()
    start, unit = network.positions[3], along / np.linalg.norm(along)
    part = ((free - start) @ unit) * unit
    expected = start + (part if path == "line" else free - start - part)
    np.testing.assert_allclose(result.positions[3], expected, atol=1e-9)
    off = result.reactions[3] - (result.reactions[3] @ unit) * unit
    held = result.reactions[3] @ unit if path == "line" else off
    np.testing.assert_allclose(held, 0, atol=1e-9)
    np.testing.assert_allclose(result.reactions[3], stiffness.sum() * (expected - free), atol=1e-9)


def test_a_warm_start_ends_at_the_same_equilibrium() -> None:
    cold = chain(
        np.zeros(3), np.array([2.0, 0, 0]), 12, axial_stiffness=200.0, rest_length=0.2,
        sense="tension", loads=np.tile(-0.5 * UP, (13, 1)),
    )  # fmt: skip
    first = solved(cold)
    again = solved(cold, start=first.positions)
    assert again.iterations == 0
    np.testing.assert_array_equal(again.positions, first.positions)
    # From the equilibrium of a neighbour too, and the supports stay where they are.
    elsewhere = solved(cold, start=first.positions + np.array([0.1, 0.2, -0.3]))
    np.testing.assert_allclose(elsewhere.positions, first.positions, atol=1e-7)


def test_a_pressed_net_that_rests_takes_no_step() -> None:
    network = sf.Network(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0.1]],
        [[0, 4], [1, 4], [2, 4], [3, 4]], [0, 1, 2, 3], axial_stiffness=50.0, rest_length=0.6,
        pressure=[([a, b, 4], 3.0) for a, b in [(0, 1), (1, 2), (2, 3), (3, 0)]],
    )  # fmt: skip
    first = solved(network)
    assert solved(network, start=first.positions).iterations == 0


def test_the_animated_solver_moves_curves_rods_and_slides_to_the_same_rest() -> None:
    count = 6
    positions = np.column_stack(
        [
            np.linspace(0, 2, count + 1),
            np.zeros(count + 1),
            0.2 * np.sin(np.linspace(0, 3, count + 1)),
        ]
    )
    none = [None] * count
    network = sf.Network(
        [*positions, [1.0, 0.8, 1.5]], [*pairwise(range(count + 1)), (3, 7)], [0, 1, 7],
        axial_stiffness=[300.0] * count + [np.nan],
        curve=[*none, sf.Curve([[0, 0], [0.1, 3.0], [0.4, 20.0]])],
        rest_length=[*np.linalg.norm(np.diff(positions, axis=0), axis=1), 1.1],
        rods=[sf.Rod(range(count + 1), 2.0)], slides=[(count, "plane", [1.0, 0, 0])],
        loads=[[0, 0, -0.2]] * 7 + [[0, 0, 0]],
    )  # fmt: skip
    direct = solved(network)
    animated = sf.solve(network, solver="implicit-euler", iterations=20000)
    assert animated.converged
    np.testing.assert_allclose(animated.positions, direct.positions, atol=1e-5)
    np.testing.assert_allclose(animated.forces, direct.forces, atol=1e-4)
    np.testing.assert_allclose(animated.bending_moments[0], direct.bending_moments[0], atol=1e-4)


def test_the_worst_node_is_that_of_the_largest_residual() -> None:
    network = chain(
        np.zeros(3), np.array([2.0, 0, 0]), 8, axial_stiffness=200.0, rest_length=0.1,
        sense="tension", loads=np.tile(-0.5 * UP, (9, 1)),
    )  # fmt: skip
    stopped = sf.solve(network, iterations=1)
    assert not stopped.converged
    at = sf.residuals(network.started_at(stopped.positions))
    sizes = np.linalg.norm(at, axis=1)
    assert stopped.worst_node == sizes.argmax()
    assert stopped.residual == pytest.approx(sizes.max() / stopped.forces.mean(), rel=1e-9)
    assert f"node {stopped.worst_node} is worst" in stopped.reason
