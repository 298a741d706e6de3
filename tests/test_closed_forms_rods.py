"""Rods that bend against closed forms: the elastica, large deflections of a cantilever, rings."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

import springform as sf
from equilibria import assert_order, solved

COUNTS = [8, 16, 32, 64, 128]
# So stiff along its axis that the rod keeps its length to 1e-6 and better.
AXIAL = 1e8


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
    return solved(network), link


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
    # Love, "Mathematical theory of elasticity", 1927, articles 262 and 263.
    parameter = np.sin(np.radians(degrees) / 2) ** 2
    whole = ellipk(parameter)
    thrust = (2 * whole) ** 2
    distance = 2 * ellipe(parameter) / whole - 1
    rise = np.sqrt(parameter) / whole
    errors: dict[str, list[float]] = {"rise": [], "thrust": [], "moment": [], "energy": []}
    # EI/2 ∫ κ² with κ² = 2 P/EI (cos θ - cos α).
    energy = thrust * (distance - np.cos(np.radians(degrees)))
    for count in COUNTS:
        result = solved(buckled(count, distance, 0.3))
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


def strut(
    count: int, load: float, axial: float, *, rise: float = 0.0, wind: float = 0.0
) -> sf.Network:
    """A rod of length 1 and EI = 1 on a pin, pushed at its other end, which stays on the axis.

    `wind` presses on a cell beside it, all of whose nodes are held.
    """
    positions = np.zeros((count + 4, 3))
    positions[: count + 1, 0] = np.linspace(0, 1, count + 1)
    positions[: count + 1, 2] = rise * np.sin(np.pi * positions[: count + 1, 0])
    held = range(count + 1, count + 4)
    positions[held] = [[0, 0, 1], [0, 1, 1], [1, 0, 1]]
    loads = np.zeros((count + 4, 3))
    loads[count, 0] = -load
    return sf.Network(
        positions, list(pairwise(range(count + 1))), [0, *held], axial_stiffness=axial,
        rest_length=1 / count, loads=loads,
        rods=[sf.Rod(range(count + 1), 1.0, lengths=[1 / count] * count)],
        fixed_axes=[*in_plane(count + 1), (count, "z")],
        pressure=[(held, wind)] if wind else [],
    )  # fmt: skip


def elastica(load: float) -> tuple[float, float]:
    """Distance of the ends and rise of a strut of length 1 and EI = 1 above its buckling load."""
    parameter = brentq(lambda m: (2 * ellipk(m)) ** 2 - load, 1e-15, 1 - 1e-15, xtol=1e-16)
    whole = ellipk(parameter)
    return 2 * ellipe(parameter) / whole - 1, float(np.sqrt(parameter)) / whole


def test_a_straight_rod_buckles_at_eulers_load() -> None:
    # The second as straight as can be: Newton's steps end there above the load too.
    for rise in (1e-3, 0.0):
        below, above = (
            np.abs(solved(strut(32, load, 1e6, rise=rise)).positions[:33, 2]).max()
            for load in (0.98 * np.pi**2, 1.02 * np.pi**2)
        )
        assert below < 1e-6
        assert above > 0.1


@pytest.mark.parametrize("share", [1.1, 1.5, 2.0])
@pytest.mark.parametrize("wind", [0.0, 1.0])
def test_a_straight_strut_above_eulers_load_becomes_the_elastica(
    share: float, wind: float, record_property: Any
) -> None:
    """Also where loads follow the shape, though not on the strut."""
    load = share * np.pi**2
    distance, rise = elastica(load)
    errors: dict[str, list[float]] = {"distance": [], "rise": []}
    for count in COUNTS[1:]:
        result = solved(strut(count, load, AXIAL, wind=wind))
        errors["distance"].append(abs(result.positions[count, 0] - distance))
        errors["rise"].append(abs(np.abs(result.positions[: count + 1, 2]).max() - rise))
    for name, values in errors.items():
        assert_order(values, record_property, name)


@pytest.mark.parametrize(("axial", "share"), [(1e6, 4.0), (1e8, 4.0), (1e6, 9.5), (1e8, 20.0)])
def test_a_strut_far_above_eulers_load_turns_over(axial: float, share: float) -> None:
    # Beyond 2.18 times the load, where its ends meet, the elastica is unstable too: the rod
    # ends straight on the other side of its pin, pulled.
    load = share * np.pi**2
    result = solved(strut(32, load, axial))
    assert result.positions[32, 0] == pytest.approx(-1 - load / axial, rel=1e-9)
    np.testing.assert_allclose(result.forces, load, rtol=1e-6)
    np.testing.assert_allclose(result.positions[:33, 2], 0.0, atol=1e-9)


def test_a_strut_that_is_not_given_the_steps_to_leave_says_so() -> None:
    network = strut(32, 4 * np.pi**2, 1e6)
    enough = sf.solve(network)
    assert enough.converged
    straight = 0
    for iterations in range(enough.iterations):
        result = sf.solve(network, iterations=iterations)
        assert not result.converged
        if "would not stay" in result.reason:
            straight += 1
            np.testing.assert_allclose(result.positions[:33, 2], 0.0, atol=1e-9)
    assert straight > 0


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_toggle_leaves_its_plane_of_symmetry(share: float) -> None:
    """Two bars up to a loaded top, which goes over sideways where its stiffness across is lost."""
    half, height, rest, axial = 1.0, 4.0, np.hypot(1.0, 4.0), 1e3

    def across(down: float) -> float:
        size = np.hypot(half, height - down)
        force = axial * (size / rest - 1)
        return axial / rest * (half / size) ** 2 + force / size * (1 - (half / size) ** 2)

    critical = brentq(across, 0.0, 1.0)
    down = share * critical
    size = np.hypot(half, height - down)
    load = -2 * axial * (size / rest - 1) * (height - down) / size
    network = sf.Network(
        [[-half, 0, 0], [half, 0, 0], [0, 0, height]], [(0, 2), (1, 2)], [0, 1],
        axial_stiffness=axial, rest_length=rest, sense="both",
        loads=[[0, 0, 0], [0, 0, 0], [0, 0, -load]],
        fixed_axes=[(2, "y")],
    )  # fmt: skip
    result = solved(network)
    if share < 1:
        top = height - down
    else:
        # Every rest above the supports is unstable now: the top hangs below them.
        top = brentq(
            lambda z: 2 * axial * (np.hypot(half, z) / rest - 1) * -z / np.hypot(half, z) - load,
            -2 * height, -height,
        )  # fmt: skip
    np.testing.assert_allclose(result.positions[2], [0, 0, top], atol=1e-7)


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
    # A circle carries moments alone, EI over the radius.
    return solved(network, least=1.0)


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
