"""Documents of the studio: every action can be undone, and what is on the disk is what was done."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import springform as sf
from springform.errors import DesignError, InputError
from springform.studio import commands, journal
from springform.studio.changes import Action, ForestChange, apply, inverse, values_of
from springform.studio.document import Document
from springform.studio.editing_messages import SetSprings, SpringChoice
from springform.studio.frames import net_frame, tables_of
from springform.studio.library import Library
from springform.studio.messages import EditCells, EditSpring, FixNode, MoveAnchor, SetValue
from springform.studio.spring_groups import set_springs
from studio_client import apply_net, decode

START = sf.load("one-cylinder")


def _action(design: sf.Design, draw: tuple[int, int, float]) -> Action:
    """One action that a designer could do, chosen by three numbers."""
    what, where, size = draw
    cells, springs = design.cells.addresses, design.network().springs
    cell = cells[where % len(cells)]
    if what < 4:
        kind = ("subdivide", "off", "retype", "turn")[what]
        edit = EditCells.model_validate({"id": 1, "what": kind, "cells": [cell], "kind": "6"})
        return commands.edit_cells(design, edit)[0]
    if what == 4:
        nodes = [design.nodes[end] for end in springs[where % len(springs)]]
        return commands.edit_spring(design, EditSpring(id=1, what="cut", nodes=nodes))
    if what == 5:
        anchor = design.anchor_names[where % len(design.anchor_names)]
        place = MoveAnchor(id=1, anchor=anchor, position=[size, -size, 1.0])
        return commands.move_anchor(design, place)
    if what == 6:
        node = f"v{where % 16}"
        held = design.nodes.index(node) in design.anchors.tolist()
        fix = FixNode(id=1, node=node, fixed=not held)
        return commands.fix_node(design, fix, design.solve().positions)
    path: list[str | int] = ["springs", "stiffness"]
    value = SetValue(id=1, label="Stiffness", path=path, value=1.0 + abs(size))
    return commands.set_value(design, value)


DRAWS = st.tuples(st.integers(0, 7), st.integers(0, 400), st.floats(0.1, 3.0))
PLANS = st.lists(st.one_of(DRAWS, st.sampled_from(["undo", "redo"])), min_size=1, max_size=14)
SLOW = settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def _do(kept: journal.Journal, step: object) -> None:
    try:
        if step == "undo":
            kept.undo()
        elif step == "redo":
            kept.redo()
        else:
            assert isinstance(step, tuple)
            kept.do(_action(kept.document.design, step))
    except InputError:
        pass  # it did not fit this net, and so nothing may have happened


@SLOW
@given(plan=PLANS)
def test_all_can_be_undone_and_redone(plan: list[object], tmp_path_factory: object) -> None:
    document = Document(START)
    for step in plan:
        if not isinstance(step, tuple):
            continue
        try:
            document.done(*document.prepared(_action(document.design, step)))
        except InputError:
            continue
    end = values_of(document.design)
    while document.position:
        document.moved(-1, document.undone())
    assert values_of(document.design) == values_of(START)
    while document.position < len(document.actions):
        document.moved(1, document.redone())
    assert values_of(document.design) == end


@SLOW
@given(plan=PLANS, data=st.data())
def test_a_document_is_read_as_it_was_left(
    plan: list[object], data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("documents") / "net"
    journal.create(folder, START, file=None, saved=None)
    with journal.reopen(folder) as kept:
        for step in plan:
            _do(kept, step)
            if data.draw(st.booleans()):
                kept._snapshot()
        left = values_of(kept.document.design), kept.document.position, kept.document.actions
    if data.draw(st.booleans()):
        (folder / "snapshot.json").unlink()
    read, _, _ = journal.read(folder)
    assert (values_of(read.design), read.position, read.actions) == left


def test_half_a_line_is_dropped(tmp_path: Path) -> None:
    folder = tmp_path / "net"
    journal.create(folder, START, file=None, saved=None)
    with journal.reopen(folder) as kept:
        kept.do(Action(label="Subdivide", changes=[ForestChange(edits=["3 subdivide 1 1 1 1"])]))
    text = (folder / "journal.jsonl").read_bytes()
    (folder / "journal.jsonl").write_bytes(text + text[: len(text) // 2])
    with journal.reopen(folder) as kept:
        assert kept.document.position == 1
        kept.undo()
    assert journal.read(folder)[0].position == 0


def test_a_damaged_document_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / "net"
    journal.create(folder, START, file=None, saved=None)
    (folder / "journal.jsonl").write_text('{"line": "undone"}\n')
    with pytest.raises(InputError, match="line 1 does not fit"):
        journal.read(folder)
    (folder / "journal.jsonl").write_text("nonsense\n")
    with pytest.raises(InputError, match="line 1 is no line of a journal"):
        journal.read(folder)


def test_a_document_is_open_in_one_studio(tmp_path: Path) -> None:
    folder = tmp_path / "net"
    journal.create(folder, START, file=None, saved=None)
    with (
        journal.reopen(folder),
        pytest.raises(InputError, match="another studio has it open"),
        journal.reopen(folder),
    ):
        pass


def test_an_action_that_leaves_no_net_is_refused() -> None:
    document = Document(START)
    values = values_of(START)["framework"]["anchors"]
    path = ["framework", "anchors"]
    request = SetValue(id=1, label="One anchor", path=path, value=values[:1])
    with pytest.raises(DesignError):
        document.prepared(commands.set_value(START, request))
    assert document.position == 0


def test_filters_write_what_they_need_into_the_action() -> None:
    document = Document(START.with_method("recursive"))
    for cells in (["40"], ["40.0", "40.1", "40.2", "40.3"]):
        request = EditCells(id=1, what="subdivide", cells=cells, kind="1")
        action, after = document.prepared(commands.edit_cells(document.design, request)[0])
        document.done(action, after)
    assert len(action.changes) == 2
    assert after.closed is after
    document.moved(-1, document.undone())
    assert document.design.cells.addresses.count("40.0") == 1


def test_changes_check_what_they_meet() -> None:
    request = MoveAnchor(id=1, anchor="A1", position=[0.0, 0.0, 9.0])
    action = commands.move_anchor(START, request)
    moved = apply(START, action)
    with pytest.raises(DesignError, match="not as the change says"):
        apply(moved, action)
    assert values_of(apply(moved, inverse(moved, action))) == values_of(START)


@SLOW
@given(plan=st.lists(DRAWS, min_size=1, max_size=6))
def test_what_changed_makes_the_whole_net(plan: list[tuple[int, int, float]]) -> None:
    design, net, base = START, {}, None
    for number, draw in enumerate([None, *plan], start=1):
        try:
            if draw is not None:
                design = Document(design).prepared(_action(design, draw))[1]
        except InputError:
            continue
        tables = tables_of(design)
        net = apply_net(net, *decode(net_frame(design, tables, number, base)))
        whole = apply_net({}, *decode(net_frame(design, tables, number, None)))
        assert net == whole
        assert net["nodes"] == design.nodes
        ends = [(design.nodes[a], design.nodes[b]) for a, b in design.network().springs]
        assert net["springs"] == ends
        base = number, tables


def test_a_small_change_is_a_small_frame() -> None:
    dense = sf.load("three-cylinders-dense")
    divided = dense.edited(["40 subdivide 1 1 1 1"])
    base = 1, tables_of(dense)
    whole = net_frame(divided, tables_of(divided), 2, None)
    change = net_frame(divided, tables_of(divided), 2, base)
    assert len(change) < len(whole) / 10


def test_a_file_has_one_document(tmp_path: Path) -> None:
    library = Library(tmp_path / "home")
    file = tmp_path / "net.toml"
    sf.save(START, file)
    first = library.open(str(file))
    assert library.open(str(file)) == first
    assert library.open("one-cylinder") != library.open("one-cylinder")
    assert {entry.file for entry in library.entries()} == {str(file.resolve()), None}
    with pytest.raises(InputError):
        library.open("no-such-scene")
    with pytest.raises(InputError):
        library.folder("../../etc")


def test_a_snapshot_spares_the_replay(tmp_path: Path) -> None:
    folder = tmp_path / "net"
    journal.create(folder, START, file=None, saved=None)
    with journal.reopen(folder) as kept:
        for cell in range(40):
            kept.do(Action(label="", changes=[ForestChange(edits=[f"{cell} subdivide 1 1 1 1"])]))
        assert json.loads((folder / "snapshot.json").read_text())["lines"] == 32
    assert json.loads((folder / "snapshot.json").read_text())["lines"] == 40
    assert np.isclose(journal.read(folder)[0].design.cells.squares[:, 1].max(), 1)


def test_a_spring_that_changes_stays_with_its_cells() -> None:
    first, second = (START.nodes[end] for end in START.network().springs[0])
    request = SetSprings(
        id=1, choice=SpringChoice(pairs=[f"{first} {second}"]), says={"stiffness": 3.0}
    )
    stiffer = apply(START, set_springs(START, request))
    before = apply_net({}, *decode(net_frame(START, tables_of(START), 1, None)))
    change = net_frame(stiffer, tables_of(stiffer), 2, (1, tables_of(START)))
    whole = apply_net({}, *decode(net_frame(stiffer, tables_of(stiffer), 2, None)))
    assert apply_net(before, *decode(change)) == whole
