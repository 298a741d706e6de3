"""Nets of surfaces against closed forms: minimal trees, hypars, cylinders under pressure, catenoids."""

from typing import Any

import numpy as np
import pytest

import springform as sf
from nets import assert_order, solved, tube


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


@pytest.mark.parametrize(("width", "height"), [(1.0, 1.0), (2.0, 1.0), (1.3, 2.0)])
def test_a_tree_between_four_corners_is_steiners(width: float, height: float) -> None:
    x, y = width / 2, height / 2
    corners = [[-x, -y, 0], [-x, y, 0], [x, -y, 0], [x, y, 0]]
    network = sf.Network(
        [*corners, [-0.1 * x, 0.3 * y, 0.2], [0.2 * x, -0.1 * y, -0.1]],
        [[0, 4], [1, 4], [2, 5], [3, 5], [4, 5]], [0, 1, 2, 3], force=1.5, sense="tension",
    )  # fmt: skip
    result = solved(network)
    # All angles are 120°; the tree is width + √3 height long.
    inner = x - y / np.sqrt(3)
    np.testing.assert_allclose(result.positions[4:], [[-inner, 0, 0], [inner, 0, 0]], atol=1e-7)
    assert result.lengths.sum() == pytest.approx(width + np.sqrt(3) * height, rel=1e-9)
    assert result.spring_energies.sum() == pytest.approx(1.5 * result.lengths.sum(), rel=1e-12)


def test_a_blunt_triangle_has_its_fermat_point_in_a_corner() -> None:
    # At the corner a constant force has no direction: no equilibrium, and the net says so.
    corners = np.array([[-2.0, 0, 0], [2.0, 0, 0], [0.1, 0.5, 0]])
    network = sf.Network(
        [*corners, [0, 0.2, 0.1]], [[0, 3], [1, 3], [2, 3]], [0, 1, 2], force=1.0, sense="tension"
    )
    result = sf.solve(network)
    assert not result.converged
    assert "node 3" in result.reason
    np.testing.assert_allclose(result.positions[3], corners[2], atol=1e-5)


def cylinder(around: int, pressure: float, stiffness: float) -> sf.Network:
    """Elastic hoops of radius 1 under pressure, a hoop a metre of length, half ones at the ends.

    Nothing but four nodes a hoop, which keep it from drifting, is held in its plane.
    """
    rows = 2
    turn = 2 * np.pi * np.arange(around) / around
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    positions = np.array([[x, y, z] for z in range(rows + 1) for x, y in ring])
    lines, rings = tube(rows, around)
    ends = np.repeat([0.5, *[1.0] * (rows - 1), 0.5], around)
    number = np.arange(len(positions)).reshape(rows + 1, around)
    after = np.roll(number, -1, axis=1)
    cells = np.stack([number[:-1], after[:-1], after[1:], number[1:]], axis=-1).reshape(-1, 4)
    quarter = around // 4
    held = [(node, "z") for node in number.ravel()]
    for row in number:
        held += [(row[0], "y"), (row[2 * quarter], "y")]
        held += [(row[quarter], "x"), (row[3 * quarter], "x")]
    nan = np.full
    return sf.Network(
        positions, [*rings, *lines], [],
        axial_stiffness=np.append(stiffness * ends, nan(len(lines), np.nan)),
        stiffness=np.append(nan(len(rings), np.nan), np.ones(len(lines))),
        sense="tension", pressure=[(cell, pressure) for cell in cells.tolist()],
        fixed_axes=[(int(node), axis) for node, axis in held],
    )  # fmt: skip


@pytest.mark.parametrize("share", [0.01, 0.3, 0.6])
def test_a_cylinder_under_pressure_carries_it_in_its_hoops(
    share: float, record_property: Any
) -> None:
    stiffness = 50.0
    pressure = share * stiffness
    # Hoop force p R, and R grows with it: R = R0 / (1 - p R0 / EA).
    radius = 1 / (1 - share)
    errors: dict[str, list[float]] = {"radius": [], "force": []}
    for around in (8, 16, 32, 64):
        network = cylinder(around, pressure, stiffness)
        result = solved(network)
        middle = slice(around, 2 * around)
        radii = np.hypot(*result.positions[:, :2].T)
        np.testing.assert_allclose(radii, radii[0], rtol=1e-7)
        np.testing.assert_allclose(result.forces[middle], 2 * result.forces[0], rtol=1e-7)
        # Of a polygon it is p R cos(π/n), to the last digit of the residual.
        flat = pressure * radii[0] * np.cos(np.pi / around)
        np.testing.assert_allclose(result.forces[middle], flat, rtol=1e-7)
        errors["radius"].append(abs(radii[0] - radius))
        errors["force"].append(abs(result.forces[around] - pressure * radius))
    for name, values in errors.items():
        assert_order(values, record_property, name)


def test_a_cylinder_under_too_much_pressure_bursts_with_a_reason() -> None:
    result = sf.solve(cylinder(16, 1.2 * 50.0, 50.0))
    assert not result.converged
    assert "follow the shape" in result.reason
    assert np.isfinite(result.positions).all()


def catenoid(along: int, around: int) -> tuple[np.ndarray, np.ndarray]:
    """Points of the catenoid of radius 1 on a grid of squares in its conformal plane, ring by ring.

    (cosh u cos v, cosh u sin v, u); and u of every ring.
    """
    turn = 2 * np.pi / around
    u = turn * (np.arange(along + 1) - along / 2)
    v = turn * np.arange(around)
    points = np.stack(
        [np.outer(np.cosh(u), np.cos(v)), np.outer(np.cosh(u), np.sin(v)),
         np.outer(u, np.ones(around))], axis=-1,
    )  # fmt: skip
    return points.reshape(-1, 3), u


CATENOIDS = [(2, 8), (4, 16), (8, 32), (16, 64), (32, 128)]


def rims(along: int, around: int) -> list[int]:
    return [*range(around), *range(along * around, (along + 1) * around)]


def cone(points: np.ndarray, around: int) -> np.ndarray:
    """The rims of a net of rings joined by straight lines."""
    rings = points.reshape(-1, around, 3)
    share = np.linspace(0, 1, len(rings))[:, None, None]
    return ((1 - share) * rings[0] + share * rings[-1]).reshape(-1, 3)


def test_equal_force_densities_on_a_conformal_grid_converge_to_the_catenoid(
    record_property: Any,
) -> None:
    # Of conformal parameters the coordinates of a minimal surface are harmonic functions.
    errors = []
    for along, around in CATENOIDS:
        exact, _ = catenoid(along, around)
        network = sf.Network(
            cone(exact, around), np.vstack(tube(along, around)), rims(along, around), stiffness=2.0
        )
        errors.append(np.abs(solved(network).positions - exact).max())
    assert_order(errors, record_property, "position")


def surface_forces(along: int, around: int, u: np.ndarray, stress: float) -> np.ndarray:
    """The stress of a catenoid over the width that belongs to each spring of a tube [N]."""
    turn = 2 * np.pi / around
    across = np.repeat(np.cosh((u[:-1] + u[1:]) / 2), around)
    return stress * turn * np.append(across, np.repeat(np.cosh(u), around))


def test_equal_surface_stress_balances_on_the_catenoid(record_property: Any) -> None:
    # Forces of a node scale with h², so order 4 of the imbalance is order 2 of the surface's.
    #
    # No net of constant forces alone rests there: a meridian of n springs has n forces, of which
    # equilibrium of its rings leaves two free, and they don't resist sliding along the meridian.
    errors = []
    for along, around in CATENOIDS:
        exact, u = catenoid(along, around)
        network = sf.Network(
            exact, np.vstack(tube(along, around)), rims(along, around),
            force=surface_forces(along, around, u, 3.0), sense="tension",
        )  # fmt: skip
        errors.append(np.abs(sf.residuals(network)).max())
    assert_order(errors, record_property, "imbalance", order=4.0)


@pytest.mark.parametrize("stiffness", [1.0, 100.0])
def test_a_net_of_equal_surface_stress_rests_at_the_catenoid(
    stiffness: float, record_property: Any
) -> None:
    errors, waists = [], []
    for along, around in CATENOIDS:
        exact, u = catenoid(along, around)
        forces = surface_forces(along, around, u, 3.0)
        drawn = sf.Network(
            exact, np.vstack(tube(along, around)), rims(along, around), prestress=forces,
            axial_stiffness=stiffness * forces, sense="tension",
        )  # fmt: skip
        result = solved(drawn.started_at(cone(exact, around)))
        np.testing.assert_allclose(solved(drawn).positions, result.positions, atol=1e-6)
        errors.append(np.abs(result.positions - exact).max())
        waist = result.positions.reshape(along + 1, around, 3)[along // 2, 0]
        waists.append(abs(np.hypot(*waist[:2]) - 1))
    assert_order(errors, record_property, "position")
    assert_order(waists, record_property, "waist")
