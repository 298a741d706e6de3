"""Rods that bend against closed forms: the elastica, large deflections of a cantilever, rings."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

import springform as sf
from nets import assert_order, solved

COUNTS = [8, 16, 32, 64, 128]
# So stiff along its axis that the rod keeps its length to 1e-6 and better, and what rounding of
# lengths is worth then [N].
AXIAL = 1e8
ROUNDING = 1e-15 * AXIAL


def in_plane(nodes: int) -> list[tuple[int, str]]:
    return [(node, "y") for node in range(nodes)]


def cantilever(count: int, load: float) -> tuple[sf.Equilibrium, float]:
    """A rod of length 1 and EI = 1 along x, clamped at one end, under a load at the other.

    Two fixed nodes clamp it in the middle of the link between them, where the rod begins.
    """
    link = 1 / (count - 0.5)
    positions = np.zeros((count + 1, 3))
    positions[:, 0] = link * (np.arange(count + 1) - 0.5)
    loads = np.zeros((count + 1, 3))
    loads[-1, 2] = -load
    network = sf.Network(
        positions, list(pairwise(range(count + 1))), [0, 1], axial_stiffness=AXIAL, loads=loads,
        rods=[sf.Rod(range(count + 1), 1.0)], fixed_axes=in_plane(count + 1),
    )  # fmt: skip
    return solved(network, ROUNDING), link


def bisshopp_drucker(load: float) -> tuple[float, float]:
    """Deflection, and distance of the end from the clamp along x (Bisshopp & Drucker, 1945)."""
    root = np.sqrt(load)

    def excess(modulus: float) -> float:
        return ellipk(modulus**2) - ellipkinc(turn(modulus), modulus**2) - root

    def turn(modulus: float) -> float:
        return float(np.arcsin(1 / (modulus * np.sqrt(2))))

    modulus = brentq(excess, np.sqrt(0.5) * (1 + 1e-15), 1 - 1e-14, xtol=1e-16)
    rest = ellipe(modulus**2) - ellipeinc(turn(modulus), modulus**2)
    end_slope = 2 * modulus**2 - 1
    return 1 - 2 / root * rest, float(np.sqrt(2 * end_slope) / root)


@pytest.mark.parametrize("load", [0.2, 1.0, 4.0, 10.0])
def test_a_cantilever_deflects_far(load: float, record_property: Any) -> None:
    down, out = bisshopp_drucker(load)
    if load in (1.0, 10.0):
        # As tabled in the source and by Howell, "Compliant mechanisms", 2001.
        assert down == pytest.approx({1.0: 0.30172, 10.0: 0.81061}[load], abs=5e-6)
        assert 1 - out == pytest.approx({1.0: 0.05643, 10.0: 0.55500}[load], abs=5e-6)
    errors = []
    for count in COUNTS:
        result, link = cantilever(count, load)
        x, _, z = result.positions[-1]
        errors.append(float(np.hypot(x - out, z + down)))
        (bending,) = result.bending_moments
        # The clamped end lies half a link before the first moment.
        at_clamp = bending[1] + 0.5 * link * load
        assert at_clamp == pytest.approx(load * out, rel=0.02 / count)
        np.testing.assert_allclose(
            bending[1:-1], load * (x - result.positions[1:-1, 0]), atol=1e-6 * load
        )
    assert_order(errors, record_property, "end")


def buckled(count: int, distance: float, rise: float) -> sf.Network:
    """A rod of length 1 and EI = 1 whose ends are held at a distance, drawn as a bow."""
    share = np.linspace(0, 1, count + 1)
    positions = np.column_stack([distance * share, 0 * share, rise * np.sin(np.pi * share)])
    return sf.Network(
        positions, list(pairwise(range(count + 1))), [0, count], axial_stiffness=AXIAL,
        rest_length=1 / count, rods=[sf.Rod(range(count + 1), 1.0, lengths=[1 / count] * count)],
        fixed_axes=in_plane(count + 1),
    )  # fmt: skip


@pytest.mark.parametrize("degrees", [20.0, 60.0, 100.0, 110.0])
def test_a_buckled_rod_is_the_elastica(degrees: float, record_property: Any) -> None:
    # Love, "Mathematical theory of elasticity", 1927, articles 262 and 263: the end slope gives all.
    parameter = np.sin(np.radians(degrees) / 2) ** 2
    whole = ellipk(parameter)
    thrust = (2 * whole) ** 2
    distance = 2 * ellipe(parameter) / whole - 1
    rise = np.sqrt(parameter) / whole
    errors: dict[str, list[float]] = {"rise": [], "thrust": [], "moment": [], "energy": []}
    # EI/2 ∫ κ² with κ² = 2 P/EI (cos θ - cos α).
    energy = thrust * (distance - np.cos(np.radians(degrees)))
    for count in COUNTS:
        result = solved(buckled(count, distance, 0.3), ROUNDING)
        # Bows up and down are alike.
        heights = np.abs(result.positions[:, 2])
        errors["rise"].append(abs(heights[count // 2] - rise))
        errors["thrust"].append(abs(result.reactions[0, 0] - thrust))
        (bending,) = result.bending_moments
        errors["moment"].append(abs(bending[count // 2] - thrust * rise))
        errors["energy"].append(abs((bending**2).sum() / count / 2 - energy))
        np.testing.assert_allclose(
            bending, result.reactions[0, 0] * heights, atol=1e-5 * bending.max()
        )
    for name, values in errors.items():
        assert_order(values, record_property, name)


def test_a_straight_rod_buckles_at_eulers_load() -> None:
    count = 32
    critical = {}
    for load in (0.98 * np.pi**2, 1.02 * np.pi**2):
        positions = np.zeros((count + 1, 3))
        positions[:, 0] = np.linspace(0, 1, count + 1)
        positions[:, 2] = 1e-3 * np.sin(np.pi * positions[:, 0])
        loads = np.zeros((count + 1, 3))
        loads[-1, 0] = -load
        network = sf.Network(
            positions, list(pairwise(range(count + 1))), [0], axial_stiffness=1e6,
            rest_length=1 / count, loads=loads,
            rods=[sf.Rod(range(count + 1), 1.0, lengths=[1 / count] * count)],
            fixed_axes=[*in_plane(count + 1), (count, "z")],
        )  # fmt: skip
        critical[load] = np.abs(solved(network, ROUNDING).positions[:, 2]).max()
    below, above = critical.values()
    assert below < 1e-6
    assert above > 0.1


def ring(count: int, push: float) -> sf.Equilibrium:
    """A rod of length 2 π and EI = 1 closed to a ring, pushed together at two opposite nodes."""
    turn = 2 * np.pi * np.arange(count) / count
    # Drawn as an ellipse.
    positions = np.column_stack([1.2 * np.cos(turn), 0 * turn, 0.8 * np.sin(turn)])
    loads = np.zeros((count, 3))
    quarter = count // 4
    loads[quarter, 2], loads[3 * quarter, 2] = -push, push
    link = 2 * np.sin(np.pi / count)
    pairs = [(node, (node + 1) % count) for node in range(count)]
    network = sf.Network(
        positions, pairs, [], axial_stiffness=1e5, rest_length=link, loads=loads,
        rods=[sf.Rod(range(count), 1.0, closed=True, lengths=[link] * count)],
        fixed_axes=[*in_plane(count), (0, "z"), (2 * quarter, "z"), (quarter, "x")],
    )  # fmt: skip
    return solved(network, ROUNDING)


@pytest.mark.parametrize("count", [8, 12, 40, 100])
def test_a_closed_rod_is_a_circle(count: int) -> None:
    result = ring(count, 0.0)
    middle = result.positions.mean(axis=0)
    np.testing.assert_allclose(np.linalg.norm(result.positions - middle, axis=1), 1.0, rtol=1e-6)
    # EI over the radius, to the last link: three nodes lie on the circle.
    np.testing.assert_allclose(result.bending_moments[0], 1.0, rtol=1e-5)
    np.testing.assert_allclose(result.reactions, 0.0, atol=1e-5)


def test_a_pinched_ring_gives_way(record_property: Any) -> None:
    # P R³/EI (π/4 - 2/π) under two opposite loads P (Timoshenko, "Strength of materials", 1930).
    push, errors = 1e-3, []
    for count in COUNTS[:-1]:
        quarter = count // 4
        heights = []
        for sign in (1, -1):
            z = ring(count, sign * push).positions[:, 2]
            heights.append(z[quarter] - z[3 * quarter])
        errors.append(abs((heights[1] - heights[0]) / (2 * push) - (np.pi / 4 - 2 / np.pi)))
    assert_order(errors, record_property, "pinch")
