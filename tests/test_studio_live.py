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
from springform.studio.live import Live
from studio_client import Window, serving

DESIGN = sf.load("one-cylinder")


class Watched:
    """A live evolution, and a way to wait for its generations."""

    def __init__(self, **parameters: Any) -> None:
        self.told = threading.Event()
        self.live = Live(DESIGN, {"population": 8} | parameters, self.told.set)

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
    refused = window.ask(type="seek_stress", steps=1, kind="1")["problem"]
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
