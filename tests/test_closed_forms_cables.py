"""Cables, strings, bars and chains against closed forms."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import springform as sf
from nets import UP, assert_order, chain, solved


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
        assert_order(values, record_property, name)


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
