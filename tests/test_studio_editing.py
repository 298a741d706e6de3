"""Editing in the studio: springs by groups, supports, density, and what a preview tells."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from springform.design import Design, load
from springform.errors import DesignError, InputError
from springform.rigging_schema import LAWS, REST_LENGTHS
from springform.studio.changes import apply, inverse
from springform.studio.commands import action_of
from springform.studio.document import Document
from springform.studio.messages import REQUEST
from springform.studio.preview import preview_of
from springform.studio.spring_groups import group_lines, merged

NET = load("one-cylinder")
START = NET.solve().positions


def done(design: Design, **request: Any) -> Design:
    """Do a request, check that undoing it brings back the design, and return the design after."""
    document = Document(design)
    asked = REQUEST.validate_python({"id": 1, **request})
    action, _ = action_of(document.design, asked, document.design.solve().positions)
    action, after = document.prepared(action)
    assert apply(after, inverse(after, action)).to_file() == document.design.to_file()
    return after


def springs(design: Design, choice: dict[str, Any], **says: Any) -> Design:
    return done(design, type="set_springs", choice=choice, says=says)


# --- springs --------------------------------------------------------------------------------------

CHOICES: list[dict[str, Any]] = [{}, {"parts": ["a"]}, {"pairs": ["v1 v2"]}, {"pairs": ["v1 v3"]},
                                 {"pairs": ["v2 v1", "v1 v3"]}, {"levels": [0]}]  # fmt: skip
WORDS = st.one_of(
    st.fixed_dictionaries({"stiffness": st.sampled_from([1.0, 2.0])}),
    st.fixed_dictionaries({"axial_stiffness": st.just(9.0), "rest_ratio": st.sampled_from([0.8])}),
    st.fixed_dictionaries({"force": st.just(3.0)}),
    st.fixed_dictionaries({"sense": st.sampled_from(["both", "tension"])}),
    st.fixed_dictionaries({"diameter": st.just(0.002)}),
    st.fixed_dictionaries({"prestress": st.just(4.0), "sense": st.just("both")}),
)


def said_of(groups: list[dict[str, Any]], spring: str, key: str) -> object:
    """What groups say of a spring: the slow twin of the core, for springs as in `CHOICES`."""
    said = None
    for group in groups:
        pairs = group.get("pairs")
        of = pairs is None or any(set(pair.split()) == set(spring.split()) for pair in pairs)
        rivals = next((keys for keys in (LAWS, REST_LENGTHS) if key in keys), (key,))
        if of and any(one in group for one in rivals):
            said = {one: group[one] for one in rivals if one in group}
    return said


@given(st.lists(st.tuples(st.sampled_from(CHOICES), WORDS), min_size=1, max_size=7))
@settings(deadline=None)
def test_groups_that_are_outdone_go_and_nothing_else_changes(
    words: list[tuple[dict[str, Any], dict[str, Any]]],
) -> None:
    groups: list[dict[str, Any]] = []
    every: list[dict[str, Any]] = []
    for choice, says in words:
        groups = merged(groups, choice, says)
        every.append({**choice, **says})
    assert len(groups) <= len(every)
    constant = {"force": 3.0}
    for spring in ("v1 v2", "v1 v3", "v7 v8"):
        law = said_of(every, spring, "stiffness")
        assert said_of(groups, spring, "stiffness") == law
        for key in ("sense", "diameter"):
            assert said_of(groups, spring, key) == said_of(every, spring, key)
        # Beside a constant force an unstressed length means nothing, and may be forgotten.
        if law != constant:
            found = said_of(groups, spring, "prestress")
            assert found == said_of(every, spring, "prestress") or found is None


@pytest.mark.parametrize(
    ("says", "law"),
    [
        ({"stiffness": 2.5}, "stiffness"),
        ({"axial_stiffness": 12.0, "rest_ratio": 0.8}, "axial_stiffness"),
        ({"force_density": 1.5}, "force_density"),
        ({"force": 0.2}, "force"),
        ({"curve": [[0.0, 0.0], [0.5, 3.0], [1.0, 4.0]], "rest_ratio": 0.7}, "curve"),
    ],
)
def test_a_law_holds_for_the_springs_that_are_chosen(says: dict[str, Any], law: str) -> None:
    nodes = NET.nodes
    pair = [" ".join(nodes[end] for end in NET.network().springs[7])]
    after = springs(NET, {"pairs": pair}, **says)
    network = after.network()
    assert network.law[7] == LAWS.index(law)
    others = np.arange(len(network.law)) != 7
    for name in ("law", "stiffness", "rest_length", "force"):
        values, before = getattr(network, name), getattr(NET.network(), name)
        np.testing.assert_array_equal(values[others], before[others])
    assert after.solve().converged
    assert len(group_lines(after)) == 1
    back = springs(after, {"pairs": pair}, **dict.fromkeys(says))
    assert back.to_file().springs == NET.to_file().springs


def test_axial_stiffness_refers_to_the_unstressed_length() -> None:
    after = springs(NET, {}, axial_stiffness=12.0, rest_ratio=0.8)
    network = after.network()
    np.testing.assert_allclose(network.stiffness * network.rest_length, 12.0)
    equilibrium = after.solve()
    strain = (equilibrium.lengths - network.rest_length) / network.rest_length
    np.testing.assert_allclose(equilibrium.forces, np.maximum(12.0 * strain, 0), atol=1e-9)


def test_the_last_word_counts_and_can_be_taken_back() -> None:
    first = springs(NET, {"parts": ["tube"]}, stiffness=5.0, sense="both")
    second = springs(first, {}, stiffness=2.0)
    assert (second.network().stiffness == 2.0).all()
    third = springs(second, {"parts": ["tube"]}, stiffness=7.0)
    assert (third.network().stiffness == 7.0).all()
    assert [group.says for group in group_lines(third)] == ["both", "k = 2 N/m", "k = 7 N/m"]
    assert (done(third, type="drop_springs", group=2).network().stiffness == 2.0).all()


@pytest.mark.parametrize(
    ("choice", "says"),
    [
        ({}, {}),
        ({}, {"colour": "red"}),
        ({}, {"parts": ["tube"]}),
        ({}, {"stiffness": -1.0}),
        ({}, {"stiffness": "soft"}),
        ({}, {"stiffness": 1.0, "force": 2.0}),
        ({}, {"axial_stiffness": 1.0, "rest_length": 0.0}),
        ({"parts": ["nothing"]}, {"stiffness": 1.0}),
        ({"pairs": ["v1"]}, {"stiffness": 1.0}),
        ({"pairs": ["v1 v999999"]}, {"stiffness": 1.0}),
    ],
)
def test_what_springs_can_not_be_is_refused(choice: dict[str, Any], says: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        springs(NET, choice, **says)


def test_there_must_be_a_group_to_take_back() -> None:
    with pytest.raises(InputError, match="0 groups"):
        done(NET, type="drop_springs", group=0)


# --- supports -------------------------------------------------------------------------------------


def held_axes(design: Design, node: str) -> list[bool]:
    axes: list[bool] = design.network().fixed_axes[design.nodes.index(node)].tolist()
    return axes


def test_a_node_is_held_slides_and_is_let_go() -> None:
    node = next(
        key for row, key in enumerate(NET.nodes) if key[0] == "v" and row not in NET.anchors
    )
    held = done(NET, type="fix_node", node=node, fixed=True)
    assert held_axes(held, node) == [True] * 3
    row = NET.nodes.index(node)
    np.testing.assert_allclose(held.file.framework.anchors[-1].position, START[row], atol=1e-6)
    sliding = done(held, type="fix_node", node=node, fixed=True, holds="xy")
    assert held_axes(sliding, node) == [True, True, False]
    assert sliding.anchor_names == held.anchor_names
    place = [float(value) for value in START[row] + [0.3, 0.0, 0.2]]
    moved_away = done(held, type="move_anchor", anchor=held.anchor_names[-1], position=place)
    for way in ("line", "plane"):
        along = done(moved_away, type="fix_node", node=node, fixed=True, **{way: [1.0, 1.0, 0.0]})
        equilibrium = along.solve()
        moved = equilibrium.positions[along.nodes.index(node)] - np.array(
            along.file.framework.anchors[-1].position
        )
        unit = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
        across = moved - (moved @ unit) * unit if way == "line" else (moved @ unit) * unit
        assert np.linalg.norm(moved) > 1e-3
        np.testing.assert_allclose(across, 0, atol=1e-9)
    free = done(sliding, type="fix_node", node=node, fixed=False)
    assert free.network().positions.shape == NET.network().positions.shape
    assert len(free.anchors) == len(NET.anchors)


def test_supports_that_do_not_fit_are_refused() -> None:
    anchor = NET.nodes[NET.anchors[0]]
    inner = done(NET, type="set_density", part=None, level=1)
    edge = next(key for key in inner.nodes if key[0] != "v")
    with pytest.raises(InputError, match="held like that already"):
        done(NET, type="fix_node", node=anchor, fixed=True)
    with pytest.raises(InputError, match="only corners"):
        action_of(
            inner.closed,
            REQUEST.validate_python({"type": "fix_node", "id": 1, "node": edge, "fixed": True}),
            inner.solve().positions,
        )
    with pytest.raises(DesignError):
        done(NET, type="fix_node", node=anchor, fixed=True, line=[0.0, 0.0, 0.0])
    with pytest.raises(DesignError):
        done(NET, type="fix_node", node=anchor, fixed=True, holds="x", line=[0.0, 0.0, 1.0])


# --- density --------------------------------------------------------------------------------------


@pytest.mark.parametrize("part", [None, "trunk"])
def test_density_brings_all_cells_of_a_part_to_one_level(part: str | None) -> None:
    net = load("three-cylinders-quad")
    names = [one.name for one in net.file.framework.cylinders]
    of_face, _ = net.mesh.map

    def levels(design: Design, inside: bool) -> set[int]:
        squares = design.cells.squares
        chosen = [
            level
            for face, level, *_ in squares.tolist()
            if (part is None or names[of_face[face]] == part) == inside
        ]
        return set(chosen)

    mixed = net.edited(["0 subdivide 1 1 1 1", "0.2 subdivide 1 1 1 1"])
    document = Document(mixed)
    request = REQUEST.validate_python({"type": "set_density", "id": 1, "part": part, "level": 1})
    action, _ = action_of(mixed, request, mixed.solve().positions)
    _, after = document.prepared(action)
    assert levels(after, inside=True) == {1}
    if part is not None:
        assert levels(after, inside=False) == levels(mixed, inside=False)
    with pytest.raises(InputError, match="level 1 already"):
        action_of(after, request, after.solve().positions)
    back = REQUEST.validate_python({"type": "set_density", "id": 1, "part": part, "level": 0})
    action, _ = action_of(after, back, after.solve().positions)
    assert levels(Document(after).prepared(action)[1], inside=True) == {0}


def test_density_of_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="no cylinder or sheet"):
        done(NET, type="set_density", part="nothing", level=1)


# --- previews -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "action",
    [
        {"type": "edit_cells", "what": "subdivide", "cells": ["9"], "kind": None},
        {"type": "edit_cells", "what": "retype", "cells": ["9", "10"], "kind": "3"},
        {"type": "set_value", "label": "x", "path": ["method"], "value": "recursive"},
        {"type": "seek_stress", "steps": 3, "kind": "1"},
        {"type": "set_density", "part": None, "level": 1},
    ],
)
def test_a_preview_tells_what_the_action_does_and_does_nothing(action: dict[str, Any]) -> None:
    start = NET.edited(["9 subdivide 1 1 1 1"]) if action["type"] == "set_value" else NET
    start = start.edited(["9.1 subdivide 1 1 1 1"]) if action["type"] == "set_value" else start
    document = Document(start)
    before = document.design.to_file()
    request = REQUEST.validate_python({"type": "preview", "id": 1, "action": {"id": 1, **action}})
    made, _ = action_of(document.design, request.action, document.design.solve().positions)
    told = preview_of(document, made, document.design.solve().positions)
    assert document.design.to_file() == before
    assert document.actions == []
    _, after = document.prepared(made)
    change = len(after.network().springs) - len(document.design.network().springs)
    assert told.springs_added - told.springs_removed == change
    change = len(after.cells.addresses) - len(document.design.cells.addresses)
    assert told.cells_added - told.cells_removed == change
    assert len(told.added) == 6 * told.springs_added
    assert len(told.removed) == 6 * told.springs_removed
    assert np.isfinite(told.added).all()
    assert told.figures.springs == after.measure(after.solve()).springs


# --- frameworks -----------------------------------------------------------------------------------


def test_springs_chosen_by_nodes_do_not_stand_in_the_way_of_another_framework() -> None:
    pair = next(
        " ".join(NET.nodes[end] for end in ends) for ends in NET.network().springs[::-1].tolist()
    )
    marked = springs(springs(NET, {"pairs": [pair]}, stiffness=3.0), {}, diameter=0.002)
    framework = marked.file.framework.model_dump(mode="json")
    framework["cylinders"][0]["along"] = 2
    after = done(marked, type="set_framework", framework=framework)
    assert [group.says for group in group_lines(after)] == ["⌀ 0.002 m"]
