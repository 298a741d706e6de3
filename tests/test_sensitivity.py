"""Derivatives of equilibria against central finite differences, on random nets."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import springform as sf

STEP = 1e-3
KINDS = ("stiffness", "rest_length", "force", "loads", "supports")


def _net(seed: int, share: float, **changes: Any) -> sf.Network:
    """A grid of cords in a frame, bulged at random, with a rod across it."""
    rng = np.random.default_rng(seed)
    size = 5
    at = np.arange(size * size).reshape(size, size)
    x, y = np.divmod(np.arange(size * size), size)
    positions = np.column_stack([x, y, 0 * x]) + rng.uniform(-0.2, 0.2, (size * size, 3))
    springs = np.vstack(
        [
            np.column_stack([at[:, :-1].ravel(), at[:, 1:].ravel()]),
            np.column_stack([at[:-1].ravel(), at[1:].ravel()]),
        ]
    )
    edge = sorted({*at[0], *at[-1], *at[:, 0], *at[:, -1]})
    slider = int(at[0, 2])
    lengths = np.linalg.norm(positions[springs[:, 1]] - positions[springs[:, 0]], axis=1)
    middle = at[2].tolist()
    rod = sf.Rod(middle, 0.05, lengths=[1.0] * (size - 1))
    arrays = {
        "stiffness": rng.uniform(0.5, 2, len(springs)),
        "rest_length": share * lengths,
        "loads": rng.uniform(-0.1, 0.1, positions.shape),
    } | changes
    return sf.Network(
        arrays.pop("positions", positions),
        springs,
        [node for node in edge if node != slider],
        slides=[(slider, "plane", (1, 0.3, 0.2))],
        rods=[rod],
        **arrays,
    )


@settings(max_examples=60, deadline=None, derandomize=True, database=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 0.8), st.sampled_from(KINDS))
def test_derivatives_agree_with_differences(seed: int, share: float, kind: str) -> None:
    network = _net(seed, share)
    equilibrium = sf.solve(network, tolerance=1e-12)
    assert equilibrium.converged
    sensitivity = sf.sensitivity(network, equilibrium)
    rng = np.random.default_rng(seed + 1)
    by_positions = rng.normal(size=network.positions.shape)
    by_forces = rng.normal(size=len(network.springs))
    shape = network.positions.shape if kind in ("loads", "supports") else by_forces.shape
    change = rng.uniform(-0.1, 0.1, shape)
    if kind == "supports":
        change[~network.fixed] = 0
    response = sensitivity.response(**{kind: change})
    gradient = sensitivity.gradient(positions=by_positions, forces=by_forces)

    def moved(step: float) -> sf.Equilibrium:
        start = equilibrium.positions + (step * change if kind == "supports" else 0)
        values = {
            "stiffness": network.stiffness,
            "rest_length": network.rest_length,
            "loads": network.loads,
        }
        if kind in values:
            values[kind] = values[kind] + step * change
        other = _net(seed, share, positions=start, **values)
        if kind == "force":
            other.force = np.ascontiguousarray(step * change)
        result = sf.solve(other, tolerance=1e-12)
        assert result.converged, result.reason
        return result

    ends = [moved(step * STEP) for step in (2, 1, -1, -2)]
    weights = np.array([-1, 8, -8, 1]) / (12 * STEP)
    positions = sum(w * end.positions for w, end in zip(weights, ends, strict=True))
    forces = sum(w * end.forces for w, end in zip(weights, ends, strict=True))
    np.testing.assert_allclose(
        response.positions, positions, rtol=0, atol=1e-5 * np.abs(positions).max()
    )
    np.testing.assert_allclose(response.forces, forces, rtol=0, atol=1e-5 * np.abs(forces).max())
    expected = (by_positions * positions).sum() + (by_forces * forces).sum()
    found = (getattr(gradient, kind) * change).sum()
    terms = np.abs(by_positions * positions).sum() + np.abs(by_forces * forces).sum()
    assert found == pytest.approx(expected, abs=1e-5 * terms)


def test_what_has_no_derivatives_is_refused_with_the_reason() -> None:
    cord = {"rest_length": 2.0, "sense": "tension"}
    slack = sf.Network([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1], [1, 2]], [0, 2], **cord)
    with pytest.raises(sf.InputError, match="singular: near node 1"):
        sf.sensitivity(slack, sf.solve(slack))
    heavy = sf.Network([[0, 0, 0], [1, 0, 0]], [[0, 1]], [0], self_weight=1.0)
    with pytest.raises(sf.InputError, match="follow the shape"):
        sf.sensitivity(heavy, sf.solve(heavy))
    stopped = sf.solve(_net(1, 0.5), iterations=1)
    with pytest.raises(sf.InputError, match="did not converge"):
        sf.sensitivity(_net(1, 0.5), stopped)
    with pytest.raises(sf.InputError, match="another network"):
        sf.sensitivity(slack, sf.solve(_net(1, 0.5)))


def test_weights_of_another_shape_are_refused() -> None:
    network = _net(3, 0.5)
    sensitivity = sf.sensitivity(network, sf.solve(network))
    with pytest.raises(sf.InputError, match="forces"):
        sensitivity.gradient(forces=np.ones(3))
    with pytest.raises(sf.InputError, match="loads"):
        sensitivity.response(loads=np.ones((3, 3)))
