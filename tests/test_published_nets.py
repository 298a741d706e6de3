"""Published nets and laws of springs: forces, reactions and displacements at their tolerances."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import springform as sf

FILES = sorted((Path(__file__).parent / "benchmarks").glob("*.json"))
# A net of constant forces is another net from elsewhere: it may collapse.
STARTS = [(path, 0.0) for path in FILES] + [
    (path, 0.1) for path in FILES if path.stem != "steiner_square"
]
SENSES = {"cable": "tension", "bar": "both", "strut": "compression"}


def laws(case: dict[str, Any]) -> dict[str, Any]:
    """What a file says of its members, as arguments of a network."""
    members = case["members"]
    if case["kind"] == "fdm":
        return {"stiffness": [member["q"] for member in members]}
    if case["kind"] == "constant_force":
        return {"force": [member["T"] for member in members]}
    return {
        "axial_stiffness": [member["EA"] for member in members],
        "rest_length": [member["L0"] for member in members],
        "sense": [SENSES[member["role"]] for member in members],
    }


def network(case: dict[str, Any], *, loaded: bool = True, shift: float = 0.0) -> sf.Network:
    """The net of a file; free nodes start off by up to `shift` of its span."""
    positions = np.array(case["nodes"], dtype=float)
    held = np.zeros(positions.shape, dtype=bool)
    held[case["fixed"]] = True
    for node, axis in case["fixed_dofs"]:
        held[node, "xyz".index(axis)] = True
    scatter = np.random.default_rng(1).uniform(-1, 1, positions.shape)
    start = positions + np.where(held, 0, shift * np.ptp(positions, axis=0).max() * scatter)
    loads = np.zeros(positions.shape)
    for node, *load in case["loads"] if loaded else []:
        loads[node] += load
    return sf.Network(
        start,
        [[member["i"], member["j"]] for member in case["members"]],
        np.array(case["fixed"], dtype=int),
        loads=loads,
        fixed_axes=[(node, axis) for node, axis in case["fixed_dofs"]],
        **laws(case),
    )


def angles_at(node: int, net: sf.Network, positions: np.ndarray) -> list[float]:
    """Angles between the springs at a node [degrees]."""
    far = [b if a == node else a for a, b in net.springs if node in (a, b)]
    rays = positions[far] - positions[node]
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    pairs = [(i, j) for i in range(len(rays)) for j in range(i)]
    return [float(np.degrees(np.arccos(rays[i] @ rays[j]))) for i, j in pairs]


def check(case: dict[str, Any], net: sf.Network, equilibrium: sf.Equilibrium) -> None:
    """Everything that a file expects, at its tolerance."""
    expected, tolerance = case["expected"], case["tolerance"]
    given = np.array(case["nodes"], dtype=float)
    positions, forces = equilibrium.positions, equilibrium.forces

    def allowed(force: np.ndarray | float) -> Any:
        share = tolerance.get("force_rel", 0.0) * np.abs(force)
        return tolerance.get("force_abs", 0.0) + share

    for node, *position in expected.get("positions", []):
        assert np.abs(positions[node] - position).max() <= tolerance["position_abs"]
    for node, *displacement in expected.get("displacements", []):
        moved = positions[node] - given[node]
        assert np.abs(moved - displacement).max() <= tolerance["displacement_abs"]
    for member, force in expected.get("forces", []):
        assert abs(forces[member] - force) <= allowed(force)
    for node, *reaction in expected.get("reactions", []):
        size = float(np.linalg.norm(reaction))
        assert np.abs(equilibrium.reactions[node] - reaction).max() <= allowed(size)
    for node, reaction in expected.get("reactions_z", []):
        assert abs(equilibrium.reactions[node, 2] - reaction) <= allowed(reaction)
    for member in expected.get("slack_members", []):
        assert forces[member] == 0.0
    for node, angle in expected.get("angles_deg", []):
        found = angles_at(node, net, positions)
        np.testing.assert_allclose(found, angle, atol=tolerance["angle_abs"])
    if "total_length" in expected:
        ends = positions[net.springs]
        total = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
        assert total == pytest.approx(expected["total_length"], rel=tolerance["length_rel"])
    for name, found in (("force_max", forces.max()), ("force_min", forces.min())):
        if name in expected:
            assert abs(found - expected[name]) <= allowed(expected[name])
    if "displacement_max" in expected:
        largest = np.linalg.norm(positions - given, axis=1).max()
        assert abs(largest - expected["displacement_max"]) <= tolerance["displacement_abs"]


Found = Callable[[sf.Network, sf.Equilibrium], Any]


def force(*members: int) -> Found:
    return lambda _, result: result.forces[list(members)]


def place(node: int, axis: int) -> Found:
    return lambda _, result: result.positions[node, axis]


def moved(node: int) -> Found:
    """Displacement from the drawn place [mm]."""
    return lambda net, result: 1e3 * (result.positions[node] - net.positions[node])


# How to read what the sources print off a result that started as drawn.
PUBLISHED: dict[tuple[str, str], Found] = {
    ("braced_frame_slack_diagonal", "force in cable 0-2"): force(4),
    ("braced_frame_slack_diagonal", "force in bar 2-3"): force(2),
    ("braced_frame_slack_diagonal", "all other members"): force(0, 1, 3, 5),
    ("heavy_cable_ssnl114", "uz at midspan"): place(20, 2),
    ("heavy_cable_ssnl114", "exact elastic catenary"): place(20, 2),
    ("saafan_1970_12_cables", "node 3 (node 4 of the papers) ux,uy,uz, elastic catenary"): moved(3),
    ("saafan_1970_12_cables", "same, straight element"): moved(3),
    ("textbook_cable_400_600_400", "horizontal reaction"): (
        lambda _, r: np.abs(r.reactions[[0, 4], 0])
    ),
    ("textbook_cable_400_600_400", "vertical reaction at the right support"): (
        lambda _, r: r.reactions[4, 2]
    ),
    ("textbook_cable_400_600_400", "tension, first member"): force(0),
    ("textbook_cable_400_600_400", "tension, last member (max)"): force(3),
    ("textbook_cable_400_600_400", "drop of node 3 below the right support"): (
        lambda _, r: r.positions[4, 2] - r.positions[3, 2]
    ),
    ("three_cable_shortened", "tension member 0"): force(0),
    ("three_cable_shortened", "tension members 1,2"): force(1, 2),
    ("three_cable_shortened", "z of node 3"): place(3, 2),
    ("tight_rope_two_bar", "z of node 1"): place(1, 2),
    ("tight_rope_two_bar", "tension, both members"): force(0, 1),
}  # fmt: skip


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_published_numbers(path: Path) -> None:
    case = json.loads(path.read_text())
    net = network(case)
    result = sf.solve(net)
    for entry in case.get("published") or []:
        if isinstance(entry["value"], str):
            # Another program's tables, which are the file's expected ones.
            close = {
                "position_abs": entry["rel_tol"],
                "force_rel": entry["rel_tol"],
                "force_abs": 0.0,
            }
            check(case | {"tolerance": case["tolerance"] | close}, net, result)
            continue
        found = PUBLISHED[path.stem, entry["quantity"]](net, result)
        np.testing.assert_allclose(
            found, entry["value"], rtol=entry.get("rel_tol", 0), atol=entry.get("abs_tol", 0)
        )


def test_every_expectation_is_checked() -> None:
    known = {
        "positions", "displacements", "forces", "reactions", "reactions_z", "slack_members",
        "angles_deg", "total_length", "force_max", "force_min", "displacement_max",
        "unloaded_displacement_max",
    }  # fmt: skip
    for path in FILES:
        assert set(json.loads(path.read_text())["expected"]) <= known, path


@pytest.mark.parametrize(("path", "shift"), STARTS, ids=lambda value: getattr(value, "stem", value))
def test_published_nets(path: Path, shift: float) -> None:
    case = json.loads(path.read_text())
    net = network(case, shift=shift)
    equilibrium = sf.solve(net)
    assert equilibrium.converged, equilibrium.reason
    check(case, net, equilibrium)
    along = equilibrium.positions[net.springs[:, 1]] - equilibrium.positions[net.springs[:, 0]]
    pulls = (equilibrium.forces / equilibrium.lengths)[:, None] * along
    joints = net.loads + equilibrium.reactions
    np.add.at(joints, net.springs[:, 0], pulls)
    np.add.at(joints, net.springs[:, 1], -pulls)
    assert np.abs(joints).max() <= 1e-9 * max(np.abs(equilibrium.forces).max(), 1.0)
    balance = equilibrium.reactions.sum(axis=0) + net.loads.sum(axis=0)
    assert np.abs(balance).max() <= 1e-9 * max(np.abs(equilibrium.forces).sum(), 1.0)


def test_a_prestressed_net_rests_where_it_was_drawn() -> None:
    case = json.loads((FILES[0].parent / "hypar20_selfweight_wind.json").read_text())
    equilibrium = sf.solve(network(case, loaded=False))
    moved = np.linalg.norm(equilibrium.positions - np.array(case["nodes"]), axis=1).max()
    assert moved <= case["tolerance"]["unloaded_displacement_abs"]
    held = {"axial_stiffness": [m["EA"] for m in case["members"]], "sense": "tension"}
    springs = [[m["i"], m["j"]] for m in case["members"]]
    prestress = [m["F0"] for m in case["members"]]
    again = sf.Network(case["nodes"], springs, case["fixed"], prestress=prestress, **held)
    np.testing.assert_allclose(sf.solve(again).forces, prestress, rtol=1e-6)


def test_laws_mix_in_one_net() -> None:
    nan = float("nan")
    net = sf.Network(
        [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]],
        [[0, 1], [1, 2], [2, 3]],
        [0, 3],
        stiffness=[10.0, nan, nan],
        force=[nan, 5.0, nan],
        axial_stiffness=[nan, nan, 100.0],
        rest_length=[nan, nan, 0.5],
    )
    equilibrium = sf.solve(net)
    np.testing.assert_allclose(equilibrium.forces, 5.0, rtol=1e-9)
    np.testing.assert_allclose(equilibrium.positions[1, 0], 0.5, rtol=1e-9)
    np.testing.assert_allclose(equilibrium.positions[2, 0], 3 - 0.5 * 1.05, rtol=1e-9)


def test_a_strut_lifts_off() -> None:
    positions, springs = [[0, 0, 0], [0, 0, 1], [0, 0, 3]], [[0, 1], [1, 2]]
    pulled = sf.Network(
        positions, springs, [0, 2], stiffness=[100.0, 1.0], rest_length=[1.0, 0.0],
        sense=["compression", "tension"], fixed_axes=[(1, "x"), (1, "y")],
    )  # fmt: skip
    equilibrium = sf.solve(pulled)
    assert equilibrium.forces[0] == 0.0
    np.testing.assert_allclose(equilibrium.positions[1], [0, 0, 3], atol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ({"stiffness": 1.0, "force": 2.0}, "more than one law"),
        ({"force": float("nan")}, "no law"),
        ({"axial_stiffness": 1.0, "rest_length": 0.0}, "unstressed length"),
        ({"rest_length": 1.0, "prestress": 1.0, "stiffness": 1.0}, "give one"),
        ({"prestress": 5.0}, "rest length of"),
        ({"sense": "pull"}, "must be tension"),
        ({"sense": ["both"]}, "shape"),
        ({"fixed_axes": [(1, "w")]}, "x, y or z"),
    ],
)
def test_laws_that_do_not_fit_are_refused(arguments: dict[str, Any], problem: str) -> None:
    with pytest.raises(sf.InputError, match=problem):
        sf.Network([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1], [1, 2]], [0, 2], **arguments)
