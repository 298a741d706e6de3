"""Strange arguments of bare nets: an equilibrium or one clear error, never a panic."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import springform as sf

# --- bare nets ---------------------------------------------------------------------------------

FLOATS = st.floats(-100, 100) | st.sampled_from([math.nan, math.inf, 1e300, -1e300, 1e-300, 0.0])
FLOAT_TYPES = st.sampled_from([np.float64, np.float32, np.float16, np.int64, np.int8, np.bool_])
INTEGER_TYPES = st.sampled_from([np.uint32, np.int64, np.uint64, np.int8, np.float64, np.bool_])


@st.composite
def laid_out(draw: st.DrawFn, values: np.ndarray) -> Any:
    """An array in another layout: Fortran order, strided, reversed, read-only, a list."""
    match draw(st.integers(0, 6)):
        case 0 if values.ndim == 2:
            return np.asfortranarray(values)
        case 1 if values.ndim:
            return np.repeat(values, 2, axis=0)[::2]
        case 2 if values.ndim:
            return np.ascontiguousarray(values[::-1])[::-1]
        case 3 if values.ndim:
            values = values.copy()
            values.flags.writeable = False
            return values
        case 4:
            return values.tolist()
    return values


@st.composite
def inputs(draw: st.DrawFn) -> dict[str, Any]:
    """Arguments of a network, most of them right in most draws."""
    nodes, springs = draw(st.integers(0, 6)), draw(st.integers(0, 9))

    def floats(*shape: int) -> Any:
        if draw(st.integers(0, 9)) == 0:
            shape = draw(arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4))
        elements = FLOATS if draw(st.integers(0, 3)) == 0 else st.floats(0.1, 9)
        values = draw(arrays.arrays(np.float64, shape, elements=elements))
        if draw(st.integers(0, 3)) == 0 and np.isfinite(values).all():
            values = np.clip(values, -99, 99).astype(draw(FLOAT_TYPES))
        return draw(laid_out(values))

    def numbers(*shape: int) -> Any:
        least, most = (-1, nodes) if draw(st.integers(0, 9)) == 0 else (0, max(nodes - 1, 0))
        values = draw(arrays.arrays(np.int64, shape, elements=st.integers(least, most)))
        if draw(st.integers(0, 3)) == 0:
            values = values.astype(draw(INTEGER_TYPES))
        return draw(laid_out(values))

    given: dict[str, Any] = {
        "positions": floats(nodes, 3),
        "springs": numbers(springs, draw(st.sampled_from([2, 2, 2, 2, 3]))),
        "fixed": draw(laid_out(draw(arrays.arrays(np.bool_, nodes)))),
    }
    if draw(st.booleans()):
        given["fixed"] = numbers(draw(st.integers(0, nodes + 1)))
    for name, shape in (("stiffness", (springs,)), ("rest_length", (springs,))):
        if draw(st.booleans()):
            given[name] = floats(*draw(st.sampled_from([shape, ()])))
    if draw(st.booleans()):
        given["loads"] = floats(nodes, 3)
    return given


def snapshot(given: dict[str, Any]) -> dict[str, Any]:
    return {name: (type(value), np.array(value).tobytes()) for name, value in given.items()}


@settings(max_examples=1_500, deadline=None)
@given(inputs(), st.sampled_from(["direct", "implicit-euler"]))
def test_strange_nets_give_an_equilibrium_or_an_error(given: dict[str, Any], solver: Any) -> None:
    before = snapshot(given)
    try:
        network = sf.Network(**given)
        equilibrium = sf.solve(network, solver=solver, iterations=50)
        sf.residuals(network)
    except sf.InputError:
        pass
    else:
        assert equilibrium.converged or equilibrium.reason
        assert equilibrium.positions.shape == network.positions.shape
        assert equilibrium.forces.shape == (len(network.springs),)
        if equilibrium.converged:
            assert np.isfinite(equilibrium.positions).all()
            held = network.fixed
            assert (equilibrium.positions[held] == network.positions[held]).all()
    assert snapshot(given) == before


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("positions", None),
        ("positions", "net"),
        ("positions", [[0, 0], [1, 1]]),
        ("positions", [[0, 0, 0], [1, 1]]),
        ("positions", [[0, 0, 0], [1, 1, 1j]]),
        ("positions", [[0, 0, 0], [10**400, 0, 0]]),
        ("springs", None),
        ("springs", [[0, 1], [1]]),
        ("springs", [["a", "b"]]),
        ("springs", [[0.0, 1.0]]),
        ("springs", [[0, 10**30]]),
        ("springs", [0, 1]),
        ("fixed", None),
        ("fixed", [[True], [False, True]]),
        ("fixed", [0.5]),
        ("fixed", [True]),
        ("fixed", ["a"]),
        ("stiffness", [1, 2, 3]),
        ("stiffness", [[1]]),
        ("stiffness", "stiff"),
        ("stiffness", [None]),
        ("rest_length", [1, 2]),
        ("loads", [0, 0, 1]),
        ("loads", [[math.nan] * 3] * 2),
    ],
)
def test_wrong_arguments_of_a_net_are_named(key: str, value: Any) -> None:
    given: dict[str, Any] = {"positions": [[0, 0, 0], [1, 0, 0]], "springs": [[0, 1]], "fixed": [0]}
    with pytest.raises(sf.InputError) as caught:
        sf.solve(sf.Network(**(given | {key: value})))
    assert key in str(caught.value)
    assert str(caught.value).isprintable()
