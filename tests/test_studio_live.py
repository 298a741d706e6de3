"""Live evolution: anchors are moved and cells brushed meanwhile, and one action keeps it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import springform as sf
from springform.errors import InputError
from springform.run_format import GenerationLine
from springform.studio.live import Live
from springform.studio.live_file import (
    Standing,
    add_generation,
    forget_standing,
    read_standing,
    write_standing,
)
from studio_client import Server, Window, serving

DESIGN = sf.load("one-cylinder")


class Watched:
    """A live evolution, what it puts on the disk, and a way to wait for its generations."""

    def __init__(self, standing: Standing | None = None, **parameters: Any) -> None:
        self.told = threading.Event()
        self.kept: list[Standing] = []
        values = {"population": 8} | parameters
        design = DESIGN if standing is None else standing.grown()
        self.lines: list[GenerationLine] = []
        self.live = Live(
            design, values, self.told.set, self.kept.append, self.lines.append, standing
        )

    def until(self, generation: int) -> None:
        while self.live.generation < generation:
            assert self.live.status != "failed", self.live.reason
            self.told.wait(30)
            self.told.clear()


@pytest.fixture
def watched() -> Iterator[Watched]:
    one = Watched()
    yield one
    one.live.close()


def test_it_makes_the_parents_that_a_run_makes(watched: Watched) -> None:
    watched.until(4)
    values = watched.live.parameters.model_dump() | {"generations": 4}
    run = sf.evolve(DESIGN, **values)
    points = list(watched.live.points)[:4]
    assert [point.generation for point in points] == [1, 2, 3, 4]
    last = points[-1]
    assert (last.springs, last.force_differential) == (
        run.final["springs"],
        run.final["force_differential"],
    )


def test_it_goes_on_with_a_moved_anchor(watched: Watched) -> None:
    watched.until(2)
    watched.live.move_anchor("A1", (0.5, 0.25, 3.0))
    watched.until(watched.live.generation + 3)
    grown = watched.live.grown
    anchor = grown.design.anchors[grown.design.anchor_names.index("A1")]
    np.testing.assert_array_equal(grown.equilibrium.positions[anchor], (0.5, 0.25, 3.0))
    assert grown.equilibrium.converged
    with pytest.raises(InputError):
        watched.live.move_anchor("A99", (0, 0, 0))


def test_it_keeps_out_of_cells_of_factor_zero() -> None:
    faces = len(DESIGN.mesh.faces)
    watched = Watched(cell_weights={str(face): 0.0 for face in range(faces) if face != 3})
    watched.until(5)
    design = watched.live.close()
    divided = {address.split(".")[0] for address in design.cells.addresses if "." in address}
    assert divided == {"3"}


def test_an_anchor_moves_in_a_pause_and_no_generation_is_made(watched: Watched) -> None:
    watched.until(1)
    watched.live.pause()
    watched.until(watched.live.generation)
    watched.live.move_anchor("A2", (1.0, 1.0, 1.0))
    while tuple(watched.live.grown.design.file.framework.anchors[1].position) != (1.0, 1.0, 1.0):
        watched.told.wait(30)
        watched.told.clear()
    made = watched.live.generation
    watched.live.go_on()
    watched.until(made + 1)


def test_what_was_put_on_the_disk_goes_on_as_if_nothing_had_been(watched: Watched) -> None:
    watched.until(3)
    watched.live.move_anchor("A1", (0.5, 0.25, 3.0))
    watched.live.change({"insertions": "2"})
    watched.until(watched.live.generation + 3)
    watched.live.pause()
    while watched.kept[-1].generation != watched.live.generation:
        watched.told.wait(30)
        watched.told.clear()
    standing = watched.kept[-1]
    assert Standing.model_validate_json(standing.model_dump_json()) == standing
    again = Watched(standing, insertions="2")
    try:
        assert (again.live.status, again.live.generation) == ("paused", standing.generation)
        assert list(again.live.points) == list(watched.live.points)
        assert again.live.grown.design.forest == watched.live.grown.design.forest
        for one in (watched, again):
            one.live.go_on()
            one.until(standing.generation + 4)
    finally:
        again.live.close()
    after = [list(one.live.points) for one in (watched, again)]
    number = len(standing.points) + 4
    assert after[0][:number] == after[1][:number]


def test_every_generation_is_on_the_disk_as_the_net_or_as_a_line_after_it(
    watched: Watched, tmp_path: Path
) -> None:
    watched.until(30)
    watched.live.close()
    # The net as it was once, and the lines that came until the next one: what a kill leaves.
    kept = [standing.generation for standing in watched.kept]
    lines = [line.generation for line in watched.lines]
    assert sorted({*kept, *lines}) == list(range(1, watched.live.generation + 1))
    first, last = watched.kept[0], watched.kept[-1]
    write_standing(tmp_path, first)
    between = watched.lines[: kept[1] - kept[0] - 1]
    assert len(between) > 3
    for line in between:
        add_generation(tmp_path, line)
    found = read_standing(tmp_path)
    assert found is not None
    assert found.generation == first.generation + len(between)
    assert found.points == last.points[: found.generation]
    again = Watched(found)
    try:
        again.live.go_on()
        again.until(last.generation)
    finally:
        design = again.live.close()
    assert list(again.live.points)[: last.generation] == last.points
    if again.live.generation == last.generation:
        assert design.forest == last.grown().forest


def test_lines_cut_short_or_older_do_not_count(watched: Watched, tmp_path: Path) -> None:
    watched.until(6)
    watched.live.close()
    first, lines = watched.kept[0], watched.lines
    for line in lines[:2]:
        add_generation(tmp_path, line)
    assert read_standing(tmp_path) is None
    write_standing(tmp_path, first)
    assert read_standing(tmp_path) == first
    for line in lines[:3]:
        add_generation(tmp_path, line)
    path = tmp_path / "grown.jsonl"
    path.write_bytes(path.read_bytes()[:-9])
    cut = read_standing(tmp_path)
    assert cut is not None
    assert cut.generation == lines[1].generation
    for line in lines[2:4]:
        add_generation(tmp_path, line)
    whole = read_standing(tmp_path)
    assert whole is not None
    assert whole.generation == lines[3].generation
    forget_standing(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_what_a_parent_adapted_outlives_a_kill_and_a_moved_anchor() -> None:
    watched = Watched(self_adapt=True, selection="comma", insertions="3", toggles="2")
    try:
        watched.until(5)
        watched.live.pause()
        while watched.live.generation != watched.kept[-1].generation:
            watched.told.wait(30)
            watched.told.clear()
        standing = watched.kept[-1]
        assert standing.strategy is not None
        assert standing.strategy != watched.live.parameters.strategy()
        again = Watched(standing, self_adapt=True, selection="comma", insertions="3", toggles="2")
        for one in (watched, again):
            one.live.go_on()
            one.until(standing.generation + 3)
        again.live.close()
        count = len(standing.points) + 3
        assert list(again.live.points)[:count] == list(watched.live.points)[:count]
        watched.live.pause()
        watched.live.move_anchor("A1", (0.5, 0.25, 3.0))
        while watched.kept[-1].grown().file.framework.anchors[0].position != (0.5, 0.25, 3.0):
            watched.told.wait(30)
            watched.told.clear()
        assert watched.kept[-1].strategy == watched.lines[-1].strategy
    finally:
        watched.live.close()


def test_a_goal_is_a_pause_that_can_be_passed() -> None:
    watched = Watched(until_springs=len(DESIGN.network().springs) + 10)
    try:
        while watched.live.status == "running":
            watched.told.wait(30)
            watched.told.clear()
        reached = watched.live.points[-1]
        assert (watched.live.status, watched.live.reason) == (
            "paused",
            "the number of springs is reached",
        )
        assert reached.springs >= watched.live.parameters.until_springs
        assert all(p.springs < reached.springs for p in list(watched.live.points)[:-1])
        watched.live.go_on()
        watched.until(reached.generation + 3)
    finally:
        watched.live.close()


def test_parameters_are_refused_before_they_count(watched: Watched) -> None:
    for name, value in (("population", 0), ("types", ["9"]), ("insertions", "a lot")):
        with pytest.raises(InputError) as refused:
            watched.live.change({name: value})
        assert refused.value.key == name
    watched.live.change({"weighting": "stress"})
    watched.until(watched.live.generation + 2)
    assert watched.live.parameters.weighting == "stress"
    assert watched.live.parameters.population == 8


@pytest.fixture
def window(tmp_path: Path) -> Iterator[Window]:
    with serving(tmp_path / "home") as server, server.window() as one:
        yield one


def live_at(window: Window, generation: int) -> dict[str, Any]:
    while True:
        event = window.receive()
        if event.get("type") == "live" and event["generation"] >= generation:
            return event


def test_keeping_is_one_action_and_discarding_none(window: Window) -> None:
    window.settle()
    assert window.document is not None
    springs = window.document["figures"]["springs"]
    assert window.ask(type="live_evolve", what="start")["problem"] is None
    live_at(window, 3)
    copy = {"type": "copy_patch", "name": "crown", "cells": ["0"], "anchor": None, "seed": None}
    for request in ({"type": "seek_stress", "steps": 1, "kind": "1"}, copy):
        refused = window.ask(**request)["problem"]
        assert refused == "the net evolves; keep or discard what it grew first"
    moved = [0.5, 0.5, 4.0]
    assert window.ask(type="move_anchor", anchor="A1", position=moved)["problem"] is None
    live_at(window, 6)
    assert window.ask(type="live_evolve", what="discard")["problem"] is None
    window.settle()
    assert window.document["position"] == 0
    assert window.document["figures"]["springs"] == springs
    assert window.ask(type="weigh_cells", cells=["0", "1"], factor=0)["problem"] is None
    assert window.ask(type="live_evolve", what="start")["problem"] is None
    state = live_at(window, 3)
    assert state["weights"] == {"0": 0.0, "1": 0.0}
    assert window.ask(type="move_anchor", anchor="A1", position=moved)["problem"] is None
    live_at(window, state["generation"] + 5)
    assert window.ask(type="live_evolve", what="keep")["problem"] is None
    window.settle()
    assert window.document["position"] == 1
    label = window.document["history"][0]["label"]
    assert label.startswith("Evolve live, ")
    assert window.document["anchors"][0]["position"] == moved
    kept = json.dumps(window.document["figures"])
    assert window.ask(type="undo", redo=False)["problem"] is None
    window.settle()
    assert window.document["figures"]["springs"] == springs
    assert window.ask(type="undo", redo=True)["problem"] is None
    window.settle()
    assert json.dumps(window.document["figures"]) == kept


def test_parameters_are_changed_before_and_while_it_evolves(window: Window) -> None:
    window.settle()
    change = {"type": "live_evolve", "what": "change"}
    reply = window.ask(**change, parameters={"population": 0})
    assert reply["key"] == "population"
    assert reply["problem"].startswith("population: must be greater than or equal to 1")
    assert window.ask(**change, parameters={"types": ["9"]})["key"] == "types"
    assert window.ask(**change, parameters={"population": 12})["problem"] is None
    assert window.ask(type="live_evolve", what="start")["problem"] is None
    state = live_at(window, 2)
    assert (state["parameters"]["population"], state["changed"]) == (12, ["population"])
    assert window.ask(**change, parameters={"fitness": "differential"})["problem"] is None
    state = live_at(window, state["generation"] + 2)
    assert state["parameters"]["fitness"] == "differential"
    assert set(state["changed"]) == {"population", "fitness"}
    assert window.ask(**change, parameters={"fitness": "suf"})["problem"] is None
    state = live_at(window, state["generation"] + 2)
    assert (state["parameters"]["fitness"], state["changed"]) == ("suf", ["population"])
    assert window.ask(**change, parameters={"insertions": "a lot"})["key"] == "insertions"
    assert window.ask(type="live_evolve", what="defaults")["problem"] is None
    state = live_at(window, state["generation"] + 2)
    assert (state["parameters"]["population"], state["changed"]) == (100, [])


def test_keeping_what_did_not_change_is_no_action(window: Window) -> None:
    """What was undone can be redone after it."""
    window.settle()
    assert (
        window.ask(type="edit_cells", what="subdivide", cells=["9"], kind=None)["problem"] is None
    )
    assert window.ask(type="undo", redo=False)["problem"] is None
    window.settle()
    change = {"type": "live_evolve", "what": "change"}
    # No mutant is allowed, so the parent stays.
    assert window.ask(**change, parameters={"max_springs": 1})["problem"] is None
    assert window.ask(type="live_evolve", what="start")["problem"] is None
    live_at(window, 3)
    assert window.ask(type="live_evolve", what="keep")["problem"] is None
    window.settle()
    assert window.document["position"] == 0
    assert len(window.document["history"]) == 1
    assert window.ask(type="undo", redo=True)["problem"] is None


def begin(server: Server, window: Window) -> dict[str, Any]:
    """Brush, change a parameter and let it evolve; return what windows are told then."""
    window.settle()
    assert window.ask(type="weigh_cells", cells=["0", "1"], factor=0)["problem"] is None
    change = {"type": "live_evolve", "what": "change", "parameters": {"population": 9}}
    assert window.ask(**change)["problem"] is None
    assert window.ask(type="live_evolve", what="start")["problem"] is None
    live_at(window, 5)
    assert window.ask(type="live_evolve", what="pause")["problem"] is None
    folder = server.home / server.document
    while True:
        state = live_at(window, 5)
        standing = read_standing(folder)
        paused = state["status"] == "paused" and standing is not None
        if paused and standing.generation == state["generation"]:
            return state
        window.ask(type="live_evolve", what="pause")


def test_a_killed_studio_takes_it_up_where_it_stood(tmp_path: Path) -> None:
    with serving(tmp_path / "home") as server, server.window() as window:
        before = begin(server, window)
        nodes = window.net["nodes"]
    with serving(tmp_path / "home", document=server.document) as again, again.window() as window:
        after = live_at(window, 0)
        assert after["status"] == "paused"
        assert after["reason"]
        same = ("generation", "points", "parameters", "weights", "changed")
        assert {name: after[name] for name in same} == {name: before[name] for name in same}
        while not window.net:
            window.receive()
        assert window.net["nodes"] == nodes
        assert window.ask(type="live_evolve", what="continue")["problem"] is None
        live_at(window, before["generation"] + 3)
        assert window.ask(type="live_evolve", what="keep")["problem"] is None
        assert again.state()["position"] == 1
    # What was kept is in the document, and not taken up a second time.
    with serving(tmp_path / "home", document=server.document) as last, last.window() as window:
        state = live_at(window, 0)
        assert (state["status"], state["weights"]) == ("none", before["weights"])
        assert last.state()["position"] == 1
