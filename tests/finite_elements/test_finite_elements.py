"""Finite element programs agree with springFORM: frozen, unloaded and loaded nets of elastic cords.

With every node held, the form is in balance under the forces claimed; let go without loads, it
stays where it is; loaded, it moves as springFORM says. That nodes stay where they are says little
by itself: a force wrong by a twentieth moves a steel net by microns. A program that finds no
equilibrium has validated nothing, which is an error.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import calculix
import nets
import numpy as np
import opensees
import pytest
from engine import Answer, NotValidatedError, lengths
from nets import FormFound

import springform as sf

BALANCE = 1e-6
"""Largest reaction at a free node of a frozen net, over the largest force."""
MOVEMENT = 1e-6
"""Largest distance between nodes, over the span."""
FORCE = 1e-5
"""Largest difference between forces, over the largest force."""

Solve = Callable[[sf.Network, Path], Answer]
LOADS = [
    ("hypar", "self-weight"),
    ("hypar", "self-weight and wind"),
    ("cord net", "self-weight"),
    ("cord net", "self-weight and wind"),
    ("cord net", "self-weight and storm"),
]


@pytest.fixture(scope="module")
def design() -> sf.Design:
    return nets.evolved()


@pytest.fixture(scope="module")
def form_found(design: sf.Design) -> dict[str, FormFound]:
    return {"hypar": nets.hypar(), "cord net": nets.cord_net(design)}


@pytest.fixture(params=["calculix", "opensees"])
def solve(request: pytest.FixtureRequest) -> Solve:
    if request.param == "calculix":
        return calculix.solve
    if not opensees.is_there():
        pytest.skip("OpenSeesPy is not installed; its licence keeps it out of the dependencies")
    return opensees.solve


@pytest.fixture(params=["hypar", "cord net"])
def net(request: pytest.FixtureRequest, form_found: dict[str, FormFound]) -> FormFound:
    return form_found[request.param]


def out_of_balance(solve: Solve, net: FormFound, claimed: np.ndarray, folder: Path) -> float:
    """Largest reaction at a free node with all nodes held [N]."""
    answer = solve(net.frozen(claimed), folder)
    return float(np.linalg.norm(answer.reactions[~net.network.fixed], axis=1).max())


def test_frozen_nets_are_in_balance(solve: Solve, net: FormFound, tmp_path: Path) -> None:
    largest = out_of_balance(solve, net, net.claimed, tmp_path)
    print(f"out of balance: {largest:.1e} N of {net.claimed.max():.6g} N")
    assert largest < BALANCE * net.claimed.max()


def test_a_force_wrong_by_a_twentieth_shows(solve: Solve, net: FormFound, tmp_path: Path) -> None:
    between_free = ~net.network.fixed[net.network.springs].any(axis=1)
    wrong = int(np.argmax(np.where(between_free, net.claimed, 0.0)))
    claimed = net.claimed.copy()
    claimed[wrong] *= 1.05
    largest = out_of_balance(solve, net, claimed, tmp_path)
    assert largest > BALANCE * net.claimed.max()
    assert largest == pytest.approx(0.05 * net.claimed[wrong], rel=1e-5)


def test_nets_rest_in_their_form(solve: Solve, net: FormFound, tmp_path: Path) -> None:
    answer = solve(net.network, tmp_path)
    moved = np.linalg.norm(answer.positions - net.network.positions, axis=1).max()
    off = np.abs(answer.forces - net.claimed).max()
    print(f"moved by {moved:.1e} m of {net.span:.6g} m, forces off by {off:.1e} N")
    assert moved < MOVEMENT * net.span
    assert off < FORCE * net.claimed.max()


@pytest.mark.parametrize(("name", "loads"), LOADS)
def test_loaded_nets_agree(
    solve: Solve, form_found: dict[str, FormFound], name: str, loads: str, tmp_path: Path
) -> None:
    net = form_found[name]
    loaded = net.under(loads)
    ours = sf.solve(loaded)
    assert ours.converged, ours.reason
    began = time.perf_counter()
    theirs = solve(loaded, tmp_path)
    seconds = time.perf_counter() - began

    displaced = np.linalg.norm(ours.positions - loaded.positions, axis=1).max()
    apart = np.linalg.norm(theirs.positions - ours.positions, axis=1).max()
    largest = ours.forces.max()
    off = np.abs(theirs.forces - ours.forces).max()
    reactions_off = np.abs(theirs.reactions - ours.reactions).max()
    slack = ours.forces == 0
    print(
        f"{displaced:.6g} m, {apart:.1e} m apart; {largest:.6g} N, {off:.1e} N off, "
        f"reactions {reactions_off:.1e} N; {slack.sum()} of {len(slack)} slack; "
        f"{ours.seconds:.3f} s and {seconds:.3f} s"
    )
    assert apart < MOVEMENT * net.span
    assert off < FORCE * largest
    assert reactions_off < FORCE * largest
    assert_same_slack(loaded, ours, theirs)
    # Each net goes slack where it should, or the lists would say nothing.
    assert bool(slack.any()) == loads.endswith("storm")


def assert_same_slack(network: sf.Network, ours: sf.Equilibrium, theirs: Answer) -> None:
    """Assert that the same cords are slack, but for those as good as at their unstressed length."""
    force = [
        network.stiffness * (lengths(found.positions, network.springs) - network.rest_length)
        for found in (ours, theirs)
    ]
    clear = np.min(np.abs(force), axis=0) > FORCE * ours.forces.max()
    np.testing.assert_array_equal((force[0] < 0)[clear], (force[1] < 0)[clear])


def test_the_designed_form_comes_back_from_the_cut_lengths(
    design: sf.Design, form_found: dict[str, FormFound]
) -> None:
    net = form_found["cord net"]
    for start in (net.network.positions, design.network().positions):
        again = sf.solve(nets.from_start(net.network, start))
        assert again.converged, again.reason
        moved = np.linalg.norm(again.positions - net.network.positions, axis=1).max()
        assert moved < MOVEMENT * net.span
        assert np.abs(again.forces - net.claimed).max() < FORCE * net.claimed.max()


def test_the_cord_net_is_denser_in_places(design: sf.Design) -> None:
    levels = design.cells.squares[:, 1]
    print(f"{len(design.network().springs)} springs, cells by level: {np.bincount(levels)}")
    assert len(design.network().springs) >= 900
    assert len(np.unique(levels)) >= 3


def test_what_finds_no_equilibrium_is_not_validated(solve: Solve, tmp_path: Path) -> None:
    """A cord that pulls its loose support along has no equilibrium."""
    pulled = sf.Network(
        [[0, 0, 0], [1, 0, 0]], [[0, 1]], [], axial_stiffness=10.0, rest_length=0.5,
        sense="tension", loads=[[0, 0, 0], [1, 0, 0]],
        fixed_axes=[(node, axis) for node in (0, 1) for axis in "yz"],
    )  # fmt: skip
    with pytest.raises(NotValidatedError, match="no equilibrium"):
        solve(pulled, tmp_path)


def test_a_load_on_a_node_without_cords_is_not_validated(solve: Solve, tmp_path: Path) -> None:
    loose = sf.Network(
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1]], [0], axial_stiffness=10.0, rest_length=0.5,
        sense="tension", loads=[[0, 0, 0], [1, 0, 0], [0, 0, 1]],
    )  # fmt: skip
    with pytest.raises(NotValidatedError):
        solve(loose, tmp_path)
