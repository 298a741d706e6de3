"""Equilibrium against closed forms, SciPy, and the animated solver."""

import threading
import time

import numpy as np
import pytest
import scipy.sparse
import scipy.sparse.linalg

import springform as sf
from springform.bench.nets import Cylinder


def scipy_equilibrium(network: sf.Network) -> np.ndarray:
    """Positions by SciPy's general sparse LU on the force density system."""
    ends, count = network.springs, len(network.positions)
    incidence = scipy.sparse.csr_matrix(
        (
            np.repeat([1.0, -1.0], len(ends)),
            (np.tile(np.arange(len(ends)), 2), ends.T.ravel()),
        ),
        shape=(len(ends), count),
    )
    laplacian = incidence.T @ scipy.sparse.diags(network.stiffness) @ incidence
    fixed, free = network.fixed, ~network.fixed
    side = network.loads[free] - laplacian[free][:, fixed] @ network.positions[fixed]
    positions = network.positions.copy()
    positions[free] = scipy.sparse.linalg.spsolve(laplacian[free][:, free].tocsc(), side)
    return positions


def evolved(scene: str, **parameters: object) -> sf.Design:
    """A design of many levels and types."""
    run = sf.evolve(sf.load(scene), population=8, generations=12, seed=3, **parameters)
    return run.best


def moved(network: sf.Network, seed: int) -> sf.Network:
    """The same network with its free nodes scattered."""
    scatter = np.random.default_rng(seed).normal(size=network.positions.shape)
    positions = np.where(network.fixed[:, None], network.positions, scatter)
    return sf.Network(positions, network.springs, network.fixed, stiffness=network.stiffness)


# Cords with rest lengths and rods are no linear systems; other engines check those.
LINEAR = [name for name in sf.scene_names() if not sf.load(name).network().rest_length.any()]


@pytest.mark.parametrize("scene", LINEAR)
def test_every_scene_agrees_with_scipy(scene: str) -> None:
    network = sf.load(scene).network()
    equilibrium = sf.solve(network)
    assert equilibrium.converged
    assert equilibrium.residual <= 1e-9
    np.testing.assert_allclose(equilibrium.positions, scipy_equilibrium(network), atol=1e-9)


@pytest.mark.parametrize("scene", LINEAR)
def test_evolved_scenes_agree_with_scipy(scene: str) -> None:
    network = evolved(scene).network()
    equilibrium = sf.solve(network)
    assert equilibrium.residual <= 1e-9
    np.testing.assert_allclose(equilibrium.positions, scipy_equilibrium(network), atol=1e-9)


@pytest.mark.parametrize("solver", ["implicit-euler", "dynamic-relaxation"])
@pytest.mark.parametrize("scene", LINEAR)
def test_solvers_by_steps_reach_the_same_equilibrium(scene: str, solver: sf.network.Solver) -> None:
    network = moved(evolved(scene).network(), seed=1)
    direct, animated = sf.solve(network), sf.solve(network, solver=solver)
    assert animated.converged
    assert animated.iterations > 3
    np.testing.assert_allclose(animated.positions, direct.positions, atol=1e-6)
    np.testing.assert_allclose(animated.forces, direct.forces, atol=1e-6)


def test_an_animation_moves_evenly_and_ends_at_equilibrium() -> None:
    network = moved(sf.load("one-cylinder").network(), seed=2)
    states = list(sf.animate(network, step=1.0, tolerance=1e-6))
    assert len(states) > 20
    assert states[-1].converged
    assert not any(state.converged for state in states[:-1])
    np.testing.assert_allclose(states[-1].positions, sf.solve(network).positions, atol=1e-4)


def test_one_spring_with_a_rest_length_hangs_at_its_closed_form() -> None:
    network = sf.Network(
        [[0, 0, 0], [0.1, 0, -1]], [[0, 1]], [0], stiffness=50.0, rest_length=1.0,
        loads=[[0, 0, 0], [0, 0, -10.0]],
    )  # fmt: skip
    equilibrium = sf.solve(network)
    assert equilibrium.converged
    np.testing.assert_allclose(equilibrium.positions[1], [0, 0, -1.2], atol=1e-9)
    np.testing.assert_allclose(equilibrium.forces, [10.0])


def test_rest_lengths_agree_between_newton_and_the_animated_solver() -> None:
    network = sf.load("one-cylinder").network()
    stretched = sf.Network(
        sf.solve(network).positions,
        network.springs,
        network.fixed,
        rest_length=0.1,
    )
    direct = sf.solve(stretched)
    animated = sf.solve(stretched, solver="implicit-euler", iterations=20000)
    assert direct.converged
    assert animated.converged
    np.testing.assert_allclose(animated.positions, direct.positions, atol=1e-6)


def test_dynamic_relaxation_refuses_what_it_does_not_know() -> None:
    network = sf.Network([[0, 0, 0], [1, 0, 0]], [[0, 1]], [0], self_weight=1.0)
    with pytest.raises(sf.InputError, match="dynamic-relaxation knows no rods"):
        sf.solve(network, solver="dynamic-relaxation")


@pytest.mark.parametrize("rest_ratio", [0.6, 0.9, 0.98])
def test_springs_that_carry_nothing_are_not_taken_for_struts(rest_ratio: float) -> None:
    # What carries nothing comes out on either side of zero; such a rest is none to leave.
    network = Cylinder(40, 24).net(rest_ratio).network()
    loose, exact = (sf.solve(network, tolerance=tolerance) for tolerance in (1e-6, 1e-9))
    assert loose.converged
    assert exact.converged
    assert loose.iterations <= exact.iterations
    assert exact.forces.min() > -1e-9


def test_a_net_that_nothing_holds_says_which_node() -> None:
    network = sf.Network([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1]], [0])
    equilibrium = sf.solve(network)
    assert not equilibrium.converged
    assert "node 2" in equilibrium.reason


def test_arrays_are_shared_not_copied() -> None:
    positions = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]])
    network = sf.Network(positions, np.array([[0, 1], [1, 2]], dtype=np.uint32), [0, 2])
    assert np.shares_memory(network.positions, positions)
    assert positions.flags.writeable


def test_the_interpreter_is_free_while_nets_are_solved() -> None:
    design = sf.load("three-cylinders")
    network = design.edited(
        f"{cell} subdivide 1 1 1 1" for cell in design.cells.addresses
    ).network()
    counted, done = 0, threading.Event()

    def work() -> None:
        deadline = time.monotonic() + 0.5
        while time.monotonic() < deadline:
            sf.solve(network, solver="implicit-euler", tolerance=1e-15, iterations=60)
        done.set()

    worker = threading.Thread(target=work)
    worker.start()
    while not done.is_set():
        counted += 1
        time.sleep(0)
    worker.join()
    # With the lock held, this thread would get a turn only between solves: some tens of times.
    assert counted > 1000
