"""Laws, rods, loads and supports of designs: against another resolution, and through evolution."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import springform as sf
from helpers import assert_refused, in_process
from springform import design_file
from springform.readings import slack
from springform.spring_laws import LAWS

CURVE = [[-0.1, -0.2], [0.0, 0.0], [0.2, 3.0], [0.6, 12.0]]
Data = dict[str, Any]


def framework(grid: str) -> Data:
    """Two cylinders on each other, four anchors at either end."""
    corners = [[1.5, 0.0], [0.0, 1.5], [-1.5, 0.0], [0.0, -1.5]]
    anchors = [
        {"ring": ring, "index": 2 * k, "position": [x, y, z]}
        for ring, z in (("low.start", 0.0), ("high.end", 3.0))
        for k, (x, y) in enumerate(corners)
    ]
    arcs = [{"ring": ring, "start": 0, "length": 8} for ring in ("low.end", "high.start")]
    return {
        "grid": grid,
        "cylinders": [{"name": name, "around": 8, "along": 2} for name in ("low", "high")],
        "joins": [{"first": arcs[0], "second": arcs[1], "cord": grid == "dia"}],
        "anchors": anchors,
    }


def grown(grid: str = "quad", **sections: Any) -> sf.Design:
    """Build a design whose cells differ in type and level."""
    cells = {"0": "1(1 6 1 1(1 1 6 1))", "3": "6", "5": "2(1 2 1 1)", "9": "6(6 6 1 1)"}
    data = {"springform": 1, "framework": framework(grid), "forest": {"cells": cells}, **sections}
    data["overrides"] = {"added": ["v0 v10"]}
    return sf.Design(design_file.from_data(data))


# --- another resolution, slow and by text ------------------------------------------------------


def places(node: str) -> tuple[str, int]:
    """Return the kind and number of the base element that a node's key names."""
    found = re.match(r"([vef])(\d+)", node)
    assert found
    return found[1], int(found[2])


def edge_of(design: sf.Design, a: str, b: str) -> int | None:
    """Return the base edge on which two nodes lie."""
    edges = [set(ends) for ends in design.mesh.edges.tolist()]
    on = []
    for kind, number in (places(a), places(b)):
        if kind == "f":
            return None
        on.append(
            {number} if kind == "e" else {e for e, ends in enumerate(edges) if number in ends}
        )
    common = on[0] & on[1]
    return min(common) if common else None


def border_edges(design: sf.Design) -> dict[str, set[int]]:
    """Return the base edges of every boundary."""
    number = {frozenset(ends): e for e, ends in enumerate(design.mesh.edges.tolist())}
    found = {}
    for part, side, path, closed in design.mesh.borders:
        pairs = list(zip(path, path[1:] + (path[:1] if closed else []), strict=False))
        found[f"{part}.{side}"] = {number[frozenset(pair)] for pair in pairs}
    return found


def faces_at(design: sf.Design, edge: int) -> int:
    ends = set(design.mesh.edges[edge].tolist())
    return sum(
        ends in ({face[k], face[(k + 1) % 4]} for k in range(4))
        for face in design.mesh.faces.tolist()
    )


def chosen(design: sf.Design, group: Data) -> list[int]:
    """Return the springs of a group."""
    cells, nodes = design.cells, design.nodes
    parts = [part for part, _, _, _ in design.mesh.borders][::2]
    part_of = design.mesh.map[0]
    borders = border_edges(design)
    ring = design._net.ring  # what the design calls free rings is tested elsewhere
    found = []
    for spring, (a, b) in enumerate(design.network().springs[design.cords].tolist()):
        owners = [
            cell
            for cell, address in enumerate(cells.addresses)
            if spring in cells.of(cells.springs, address)
        ]
        keys = nodes[a], nodes[b]
        holds = True
        if {"parts", "types", "levels"} & group.keys():
            holds = any(
                parts[part_of[cells.squares[cell][0]]] in group.get("parts", parts)
                and cells.types[cell] in [str(t) for t in group.get("types", [cells.types[cell]])]
                and cells.squares[cell][1] in group.get("levels", range(21))
                for cell in owners
            )
        if "along" in group:
            edge = edge_of(design, *keys)
            holds &= any(
                bool(ring[spring])
                if line == "ring"
                else edge is not None
                and (
                    edge in borders[line]
                    if line != "seam"
                    else any(edge in all_ for all_ in borders.values())
                    and faces_at(design, edge) > 1
                )
                for line in group["along"]
            )
        if "pairs" in group:
            holds &= any(set(pair.split()) == set(keys) for pair in group["pairs"])
        if holds:
            found.append(spring)
    return found


def slow_network(design: sf.Design, groups: list[Data], stiffness: float) -> sf.Network:
    """Resolve groups spring by spring and say the result in words of a bare network."""
    network, cells = design.network(), design.cells
    count = design.cords.stop
    said: list[Data] = [{} for _ in range(count)]
    rests, laws = ("rest_length", "rest_ratio", "prestress"), LAWS
    for group in groups:
        for spring in chosen(design, group):
            for family in (rests, laws):
                if set(family) & group.keys():
                    said[spring] = {k: v for k, v in said[spring].items() if k not in family}
            said[spring].update(group)
    ends = network.positions[network.springs]
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    columns: dict[str, list[Any]] = {
        name: [np.nan] * count
        for name in ("stiffness", "axial_stiffness", "force", "rest_length", "prestress")
    }
    curve = sf.Curve(CURVE)
    curves: list[sf.Curve | None] = [None] * count
    thermal, weight, sense = [0.0] * count, [0.0] * count, ["tension"] * count
    for spring, one in enumerate(said):
        levels = [
            int(cells.squares[cell][1])
            for cell, address in enumerate(cells.addresses)
            if spring in cells.of(cells.springs, address)
        ]
        if "curve" in one:
            curves[spring] = curve
        elif "force_density" in one:
            columns["stiffness"][spring] = one["force_density"]
        elif not set(laws) & one.keys():
            columns["stiffness"][spring] = stiffness
        for name in set(columns) & one.keys():
            columns[name][spring] = one[name]
        if "rest_ratio" in one:
            ratios = np.atleast_1d(one["rest_ratio"])
            ratio = ratios[min(max(levels, default=0), len(ratios) - 1)]
            columns["rest_length"][spring] = ratio * lengths[spring]
        if {"force", "force_density"} & one.keys():
            columns["rest_length"][spring] = columns["prestress"][spring] = np.nan
        else:
            thermal[spring] = one.get("thermal_expansion", 0.0) * one.get("temperature", 0.0)
        weight[spring] = one.get("self_weight", 0.0)
        sense[spring] = one.get("sense", "tension")
    return sf.Network(
        network.positions, network.springs, network.fixed, curve=curves, thermal_strain=thermal,
        sense=sense, self_weight=weight, **columns,
    )  # fmt: skip


def some(words: list[Any]) -> st.SearchStrategy[list[Any]]:
    return st.lists(st.sampled_from(words), min_size=1, max_size=3, unique=True)


@st.composite
def groups(draw: st.DrawFn) -> Data:
    choices = {
        "parts": some(["low", "high"]),
        "types": some([1, 2, 6]),
        "levels": some([0, 1, 2]),
        "along": some(["ring", "seam", "low.start", "low.end", "high.start"]),
        "pairs": some(["v0 v1", "v8 v0", "v0 v10", "v9 v10", "e3:1/2 v2"]),
    }
    law = draw(st.sampled_from([*LAWS, None]))
    values = st.sampled_from([0.5, 1.0, 7.0])
    group: Data = {}
    for name in draw(st.lists(st.sampled_from(list(choices)), max_size=2, unique=True)):
        group[name] = draw(choices[name])
    if law is not None:
        group[law] = CURVE if law == "curve" else draw(values)
    if law not in ("force", "force_density"):
        rest = draw(st.sampled_from(["rest_length", "rest_ratio", None]))
        if rest == "rest_length":
            group[rest] = draw(st.sampled_from([0.1, 0.4]))
        if rest == "rest_ratio":
            group[rest] = draw(st.sampled_from([0.5, 1.1, [0.9, 0.6], [0.2, 0.5, 0.8]]))
    for name, value in (
        ("sense", st.sampled_from(["tension", "both", "compression"])),
        ("self_weight", values),
        ("thermal_expansion", st.sampled_from([1e-3, -2e-3])),
        ("temperature", st.sampled_from([20.0, -10.0])),
    ):
        if draw(st.integers(0, 3)) == 0:
            group[name] = draw(value)
    if not group.keys() - choices.keys():
        group["sense"] = "both"
    return group


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(["quad", "dia"]), st.lists(groups(), min_size=1, max_size=4))
def test_groups_are_resolved_as_by_hand(grid: str, mix: list[Data]) -> None:
    design = grown(grid, springs={"stiffness": 1.5, "groups": mix})
    network, slow = design.network(), slow_network(design, mix, 1.5)
    for name in ("stiffness", "rest_length", "force", "sense", "loads", "self_weight"):
        np.testing.assert_allclose(
            getattr(network, name), getattr(slow, name), rtol=1e-12, atol=1e-15, err_msg=name
        )
    curved = slow.curve != 2**32 - 1
    np.testing.assert_array_equal(network.law == LAWS.index("curve"), curved if len(curved) else 0)
    equilibrium = design.solve()
    assert np.isfinite(equilibrium.positions).all()
    assert equilibrium.converged or equilibrium.reason


def test_prestress_is_the_force_in_the_drawn_geometry() -> None:
    for law in ({"axial_stiffness": 50.0}, {"stiffness": 40.0}):
        network = grown(springs={"groups": [{**law, "prestress": 2.0}]}).network()
        ends = network.positions[network.springs]
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        forces = network.stiffness * (lengths - network.rest_length)
        np.testing.assert_allclose(forces, 2.0, rtol=1e-12)


def test_a_file_without_groups_means_what_it_meant() -> None:
    plain = sf.load("three-cylinders")
    network = plain.network()
    assert not network.rods
    assert not len(network.self_weight)
    assert (network.stiffness == 1).all()
    assert not network.rest_length.any()
    one = plain.with_springs(stiffness=1.0, sense="both")
    np.testing.assert_array_equal(plain.solve().positions, one.solve().positions)


# --- loads, supports, rods ---------------------------------------------------------------------


def test_loads_and_supports_are_those_of_a_bare_network() -> None:
    data = framework("quad")
    data["anchors"][0]["holds"] = "xy"
    data["anchors"][1]["line"] = [0.0, 1.0, 1.0]
    data["anchors"][2]["plane"] = [1.0, 0.0, 0.0]
    loads = {
        "nodes": [
            {"vertex": 9, "force": [0.0, 0.0, -1.0]},
            {"ring": "low.end", "index": 3, "force": [0.5, 0.0, 0.0]},
            {"node": "v9", "force": [0.0, 0.0, -1.0]},
        ],
        "pressures": [
            {"parts": ["low"], "pressure": 0.3},
            {"cells": ["9"], "pressure": -0.2, "follower": True},
        ],
    }
    design = sf.Design(design_file.from_data({"springform": 1, "framework": data, "loads": loads}))
    network, cells = design.network(), design.cells
    a, b, c = design.anchors[:3].tolist()
    assert network.fixed_axes[a].tolist() == [True, True, False]
    assert {slide[0] for slide in network.slides} == {b, c}
    assert len(network.pressure) == 1
    bare = sf.Network(
        network.positions, network.springs, design.anchors[3:],
        fixed_axes=[(a, "x"), (a, "y")],
        slides=[(b, "line", [0, 1, 1]), (c, "plane", [1, 0, 0])],
        loads=network.loads,
        pressure=[(cells.of(cells.boundaries, "9").tolist(), -0.2)],
    )  # fmt: skip
    np.testing.assert_allclose(design.solve().positions, sf.solve(bare).positions, atol=1e-9)
    # Dead pressure on a closed run of cells sums up to pressure times the openings' vector areas.
    below = sum(
        (vector_area(network.positions[list(cells.of(cells.boundaries, address))])
         for address, square in zip(cells.addresses, cells.squares, strict=True) if square[0] < 16),
        np.zeros(3),
    )  # fmt: skip
    single = np.array([0.5, 0.0, -2.0])
    np.testing.assert_allclose(network.loads.sum(axis=0), 0.3 * below + single, atol=1e-12)
    equilibrium = design.solve()
    np.testing.assert_allclose(
        equilibrium.loads.sum(axis=0), -equilibrium.reactions.sum(axis=0), atol=1e-7
    )


def vector_area(points: np.ndarray) -> np.ndarray:
    return 0.5 * np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)


def test_links_of_rods_stand_behind_the_cords_and_are_not_measured() -> None:
    plain = grown("dia")
    rod = {"bending_stiffness": 3.0, "axial_stiffness": 1e4, "length": 10.0, "diameter": 0.01}
    design = plain.with_rod("low.start", **rod)
    network, cords = design.network(), design.cords
    np.testing.assert_array_equal(network.springs[cords], plain.network().springs)
    links = network.springs[cords.stop :]
    ring = network.rods[0]
    assert ring.closed
    assert len(links) == len(ring.nodes) == len(set(ring.nodes))
    assert links.tolist() == [
        list(p) for p in zip(ring.nodes, [*ring.nodes[1:], ring.nodes[0]], strict=True)
    ]
    assert network.rest_length[cords.stop :].sum() == pytest.approx(10.0)
    np.testing.assert_allclose(
        network.stiffness[cords.stop :] * network.rest_length[cords.stop :], 1e4
    )
    equilibrium = design.solve()
    assert equilibrium.converged, equilibrium.reason
    measures = design.measure(equilibrium)
    assert measures.springs == cords.stop
    assert measures.force_max == equilibrium.forces[cords].max()
    assert measures.total_length == pytest.approx(equilibrium.lengths[cords].sum())
    assert len(design.inner_forces(equilibrium)) == len(design.cells.addresses)
    assert len(equilibrium.bending_moments[0]) == len(ring.nodes)


def test_a_free_ring_of_rod_is_a_circle() -> None:
    """A closed rod that is only touched by weak cords is a circle, of moment EI/R."""
    data = framework("quad")
    data["anchors"] = data["anchors"][:2] + data["anchors"][4:]
    springs = {"groups": [{"force_density": 1e-6}]}
    rod: Data = {"along": "low.start", "bending_stiffness": 5.0, "axial_stiffness": 1e3}
    rod["length"] = 16 * 1.5 * np.sin(np.pi / 8)  # eight links between nodes on the circle
    design = sf.Design(
        design_file.from_data(
            {"springform": 1, "framework": data, "springs": springs, "rods": [rod]}
        )
    )
    equilibrium = design.solve(tolerance=1e-6)
    moments = equilibrium.bending_moments[0]
    np.testing.assert_allclose(moments, 5.0 / 1.5, rtol=1e-4)


def test_a_rod_goes_through_nodes_that_evolution_adds() -> None:
    design = sf.load("hung-in-rods")
    edits = [f"{face} subdivide 1 1 1 1" for face in range(4)]
    refined = design.edited(edits)
    before, after = design.network().rods[0], refined.network().rods[0]
    assert len(after.nodes) > len(before.nodes)
    assert sum(after.lengths or ()) == pytest.approx(sum(before.lengths or ()))


STIFF: Data = {"bending_stiffness": 5.0, "axial_stiffness": 1e4}


def of_mesh(
    faces: list[list[int]],
    anchored: tuple[int, ...],
    rods: list[Data],
    vertices: list[list[float]] | None = None,
) -> sf.Design:
    """A mesh whose vertices lie on a helix unless given, so that all edges have a length."""
    if vertices is None:
        turn = np.arange(max(map(max, faces)) + 1) / 3
        vertices = np.column_stack([np.cos(turn), np.sin(turn), 0.2 * turn]).tolist()
    anchors = [{"vertex": vertex, "position": vertices[vertex]} for vertex in anchored]
    mesh = {"vertices": vertices, "faces": faces}
    data = {"springform": 1, "framework": {"mesh": mesh, "anchors": anchors}, "rods": rods}
    return sf.Design(design_file.from_data(data))


def rod_nodes(design: sf.Design, number: int) -> list[str]:
    return [design.nodes[node] for node in design.network().rods[number].nodes]


def test_rods_run_along_the_rims_of_a_mesh() -> None:
    """The rings of a cylinder, and the same faces as a mesh that knows of no rings."""
    tube = sf.Design(design_file.from_data({"springform": 1, "framework": framework("quad")}))
    faces = tube.mesh.faces.tolist()
    paths = {f"{part}.{side}": path for part, side, path, closed in tube.mesh.borders if closed}
    rims = sorted(
        (sorted(path) for name, path in paths.items() if name in ("low.start", "high.end"))
    )
    rods = [{"along": f"rim.{number}"} | STIFF for number in (1, 2)]
    start = dict(zip(tube.nodes, tube.network().positions.tolist(), strict=True))
    vertices = [start[f"v{vertex}"] for vertex in range(tube.mesh.vertex_count)]
    anchored = tuple(int(vertex) for vertex in np.flatnonzero(tube.network().fixed))
    design = of_mesh(faces, anchored, rods, vertices)
    design = design.edited([f"{face} subdivide 1 1 1 1" for face in range(3)])
    for number, rim in enumerate(rims):
        ring = design.network().rods[number]
        keys = rod_nodes(design, number)
        assert ring.closed
        assert keys[0] == f"v{rim[0]}"
        assert sorted(key for key in keys if key[0] == "v") == sorted(
            f"v{vertex}" for vertex in rim
        )
    # With the nodes that subdividing adds, each once and on an edge of the rim.
    assert len(rod_nodes(design, 0)) > len(rims[0])
    assert design.solve().converged
    saved = design_file.dump(design.to_file(), "toml")
    assert 'along = "rim.1"' in saved


def test_rods_run_along_vertices() -> None:
    along_rim: Data = {"along": "rim.1"} | STIFF
    strip = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]]
    around = [0, 1, 2, 3, 7, 6, 5, 4, 0]
    by_name = of_mesh(strip, (0, 3, 4), [along_rim])
    by_number = of_mesh(strip, (0, 3, 4), [{"vertices": around} | STIFF])
    assert by_name.network().rods == by_number.network().rods
    np.testing.assert_array_equal(by_name.solve().positions, by_number.solve().positions)
    across = of_mesh(strip, (0, 3, 4), [{"vertices": [4, 5, 1]} | STIFF]).network().rods[0]
    assert (across.nodes, across.closed) == ([4, 5, 1], False)
    # On a cylinder, too: a rod from ring to ring.
    data = framework("quad")
    tube = sf.Design(design_file.from_data({"springform": 1, "framework": data}))
    edges = {frozenset(ends) for ends in tube.mesh.edges.tolist()}
    first = tube.mesh.borders[0][2][0]
    second = next(b for b in range(8, tube.mesh.vertex_count) if {first, b} in edges)
    third = next(b for b in range(second + 1, tube.mesh.vertex_count) if {second, b} in edges)
    post = tube.with_rod(vertices=[first, second, third], **STIFF).network().rods[0]
    assert (len(post.nodes), post.closed) == (3, False)


def test_what_is_no_rim_is_said() -> None:
    strip = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]]
    box = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    bow = [[0, 1, 2, 3], [3, 4, 5, 6]]
    rod: Data = {"along": "rim.1"} | STIFF
    for faces, along, problem in (
        (strip, "rim.2", r'rods\[0\].along: no rim is called "rim.2"; did you mean rim.1'),
        (strip, "trunk.start", r"rods\[0\].along: no rim is called"),
        (box, "rim.1", r"rods\[0\].along: the mesh is closed and has no rims; give vertices"),
        (bow, "rim.1", r"rods\[0\].along: the rims of the mesh meet at vertex 3; give vertices"),
    ):
        with pytest.raises(sf.DesignError, match=problem):
            of_mesh(faces, (0, 2, 4), [rod | {"along": along}])


# --- readings, results -------------------------------------------------------------------------


def test_readings_say_number_unit_and_formula() -> None:
    design = grown(springs={"groups": [{"axial_stiffness": 9.8, "diameter": 0.0025}]})
    equilibrium = design.solve()
    for spring in range(0, design.cords.stop, 7):
        readings = {one.name: one for one in sf.read_spring(design.network(), equilibrium, spring)}
        assert "EA (L − L0)/L0" in readings["force"].formula
        assert "unstressed length" in readings["force"].formula
        assert readings["axial stiffness"].value == pytest.approx(9.8)
        strain = readings["length"].value / readings["unstressed length"].value - 1
        assert readings["strain"].value == pytest.approx(strain)
        assert readings["force"].value == pytest.approx(max(9.8 * strain, 0.0))
        area = np.pi * 0.0025**2 / 4
        assert readings["stress"].value == pytest.approx(readings["force"].value / area)
        assert readings["force"].text.endswith(" N")
    with pytest.raises(sf.InputError, match="there is no spring"):
        sf.read_spring(design.network(), equilibrium, 10**6)


def test_the_command_line_reads_a_spring_and_reports_forces() -> None:
    done = in_process("solve", "hung-in-rods", "--spring", "3", "--json")
    assert done.code == 0, done
    report = done.report
    assert (report["rods"], report["slack"]) == (2, 0)
    np.testing.assert_allclose(report["load_sum"], -np.array(report["reaction_sum"]), atol=1e-6)
    names = [one["name"] for one in report["spring"]["readings"]]
    assert names[:3] == ["force", "axial stiffness", "length"]
    assert "elastic" not in in_process("solve", "hung-in-rods", "--spring", "3").out
    assert_refused(in_process("solve", "hung-in-rods", "--spring", "9999"), "there is no spring")


# --- evolution ---------------------------------------------------------------------------------

LAW_MIXES: dict[str, Data] = {
    "a rest length": {"springs": {"groups": [{"stiffness": 5.0, "rest_ratio": 0.6}]}},
    "axial stiffness by level": {
        "springs": {"groups": [{"axial_stiffness": 10.0, "rest_ratio": [0.5, 0.6, 0.7]}]}
    },
    "prestress": {"springs": {"groups": [{"axial_stiffness": 10.0, "prestress": 3.0}]}},
    "constant force": {"springs": {"groups": [{"along": ["ring"], "force": 0.05}]}},
    "force density": {
        "springs": {"groups": [{"force_density": 3.0}, {"types": [6], "force_density": 5.0}]}
    },
    "a measured curve": {"springs": {"groups": [{"curve": CURVE, "rest_ratio": 0.7}]}},
    "slack cords": {"springs": {"groups": [{"axial_stiffness": 10.0, "rest_ratio": 0.98}]}},
    "weight and wind": {
        "springs": {"groups": [{"axial_stiffness": 10.0, "rest_ratio": 0.6, "self_weight": 0.1}]},
        "loads": {"pressures": [{"parts": ["low"], "pressure": 0.2, "follower": True}]},
    },
    "rods": {
        "springs": {"groups": [{"axial_stiffness": 10.0, "rest_ratio": 0.6}]},
        "rods": [
            {"along": "low.start", "bending_stiffness": 5.0, "axial_stiffness": 1e4, "length": 9.4}
        ],
    },
}  # fmt: skip


@pytest.mark.parametrize("name", LAW_MIXES)
def test_runs_of_every_law_go_on_to_the_same_bits(name: str, tmp_path: Path) -> None:
    design = grown("dia", **LAW_MIXES[name])
    words = {"population": 10, "types": (1, 6), "seed": 3}
    whole = sf.evolve(design, out=tmp_path / "whole", generations=4, threads=1, **words)
    part = sf.evolve(design, out=tmp_path / "part", generations=2, threads=2, **words)
    resumed = sf.resume(part, generations=4, threads=2)
    assert resumed.digest() == whole.digest()
    assert whole.generations == 4
    defined = np.isfinite(whole.table["force_differential"])
    assert defined.any() or name == "slack cords"
    rebuilt = sf.open_run(tmp_path / "whole").individual(2, 4)
    assert rebuilt.file.springs == design.file.springs
    if name != "slack cords":
        best = whole.best
        assert best.solve().converged


def test_a_net_without_equilibrium_is_refused_as_a_start_and_never_wins() -> None:
    design = grown(springs={"groups": [{"axial_stiffness": 1.0, "rest_length": 1.0}]})
    design = design.with_pressure(500.0, follower=True)
    assert not design.solve().converged
    with pytest.raises(sf.SpringformError, match="equilibrium"):
        sf.evolve(design, population=4, generations=1)


def test_a_load_needs_its_node() -> None:
    design = grown().with_load([0.0, 0.0, -1.0], node="f14:1/4,1/4")
    with pytest.raises(sf.DesignError, match=r"loads\.nodes\[0\].*no node f14:1/4,1/4"):
        design.network()


def test_groups_that_cannot_be_are_named_with_their_spring() -> None:
    design = grown().with_springs(stiffness=1.0, prestress=1e3)
    with pytest.raises(sf.DesignError, match=r"springs\.groups\[0\].*the spring v\d+ \S+ would be"):
        design.network()


def test_sections_are_saved_and_loaded_to_the_same_bytes(tmp_path: Path) -> None:
    for mix in LAW_MIXES.values():
        design = grown("dia", **mix)
        for kind in ("toml", "json"):
            path = tmp_path / f"net.{kind}"
            sf.save(design, path)
            again = sf.load(path)
            assert again.file.springs == design.file.springs
            assert again.file.rods == design.file.rods
            assert again.file.loads == design.file.loads
            first = path.read_bytes()
            sf.save(again, path)
            assert path.read_bytes() == first


def test_slack_cords_make_the_differential_undefined() -> None:
    design = grown("dia", **LAW_MIXES["slack cords"])
    equilibrium = design.solve()
    loose = slack(equilibrium, design.cords)
    assert design.measure(equilibrium).force_differential is None or not loose.any()
