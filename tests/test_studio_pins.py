"""Pins and comparisons: what is pinned outlives its run, the studio and the window."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import springform as sf
from springform.comparison import compare
from springform.errors import InputError
from springform.patch_file import load_patch
from springform.selections import select
from springform.studio.grafts import lifted
from springform.studio.messages import CopyPatch
from springform.studio.pins import PinFolder
from springform.studio.telling import figures_of
from studio_client import Server, Window, decode, serving

POPULATION = 8


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> sf.Run:
    folder = tmp_path_factory.mktemp("runs") / "a"
    sf.evolve(
        sf.load("one-cylinder"), out=folder, population=POPULATION, generations=5, insertions="2"
    )
    return sf.open_run(folder)


@pytest.fixture
def server(run: sf.Run, tmp_path: Path) -> Iterator[Server]:
    # A copy, since some tests take the run away.
    folder = tmp_path / "run"
    shutil.copytree(run.folder, folder)
    with serving(tmp_path / "home", str(folder)) as server:
        yield server


def pins(window: Window) -> list[dict[str, Any]]:
    """Wait for the next list of pins."""
    while (event := window.receive()).get("type") != "pins":
        pass
    found = event["pins"]
    assert isinstance(found, list)
    return found


def pin(window: Window, side: str) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    window.number += 1
    window.tell(type="pin", id=window.number, side=side)
    listed, reply = [], None
    while reply is None:
        event = window.receive()
        if event.get("type") == "pins":
            listed = event["pins"]
        if event.get("type") == "reply":
            reply = event
    return reply, listed


def test_a_pin_is_told_to_all_windows_and_outlives_run_and_studio(
    run: sf.Run, server: Server, tmp_path: Path
) -> None:
    with server.window() as window, server.window() as other:
        assert pins(window) == pins(other) == []
        reply, listed = pin(window, "run/4/3")
        assert reply["problem"] is None
        assert pins(other) == listed
        (kept,) = listed
        assert kept["label"] == "Generation 4, individual 3"
        assert kept["place"]["generation"] == 4
        row = (run.table["generation"] == 4) & (run.table["individual"] == 3)
        assert kept["figures"]["springs"] == run.table["springs"][row][0]
        assert kept["figures"]["force_differential"] == pytest.approx(
            run.table["force_differential"][row][0], rel=1e-12
        )
        assert kept["suf"] == pytest.approx(run.table["suf"][row][0], rel=1e-6)
        again, _ = pin(window, "run/4/3")
        assert "pinned already" in again["problem"]
    server.process.kill()
    server.process.wait()
    shutil.rmtree(tmp_path / "run")
    home = tmp_path / "home"
    (document,) = [path.name for path in home.iterdir() if (path / "pins.json").exists()]
    with serving(home) as again_served:
        again_served.document = document
        with again_served.window() as window:
            assert pins(window) == listed
            assert (
                window.ask(type="look", generation=None, individual=None, pin=1)["problem"] is None
            )
            looked = again_served.state()
            assert looked["looking"]["pin"] == 1
            assert looked["looking"]["generation"] is None
            assert window.ask(type="reinstate", side="pin/1")["problem"] is None
        taken = again_served.state()
        assert taken["figures"] == kept["figures"]
        assert taken["history"][-1]["label"] == "Take over generation 4, individual 3"
        assert taken["history"][-1]["origin"] == kept["place"]


def test_a_net_taken_over_is_pinned_as_the_individual_that_it_is(server: Server) -> None:
    with server.window() as window:
        window.ask(type="look", generation=3, individual=None, pin=None)
        reply, listed = pin(window, "run/3")
        assert reply["problem"] is None
        parent = listed[0]["place"]
        assert parent["individual"] is not None  # the parent is an individual, too
        window.ask(type="reinstate", side="run/3")
        again, _ = pin(window, "design")
        assert "pinned already" in again["problem"]
        window.ask(type="seek_stress", steps=1, kind="1")
        reply, listed = pin(window, "design")
        assert reply["problem"] is None
        assert listed[1]["place"] is None
        assert listed[1]["label"] == "Design after 2 actions"
        again, _ = pin(window, "design")
        assert "pinned already" in again["problem"]
        assert window.ask(type="unpin", pin=1)["problem"] is None
        assert "no such pin" in window.ask(type="unpin", pin=1)["problem"]
        reply, listed = pin(window, "run/1/0")
        assert [one["number"] for one in listed] == [2, 3]


def test_a_pin_is_renamed_for_all_windows_and_for_good(server: Server, tmp_path: Path) -> None:
    with server.window() as window, server.window() as other:
        pin(window, "run/4/3")
        pin(window, "run/2/1")
        while len(told := pins(other)) < 2:
            pass
        assert window.ask(type="rename_pin", pin=2, label="Lobby, third try")["problem"] is None
        renamed = [told[0], told[1] | {"label": "Lobby, third try"}]
        assert pins(other) == renamed
        assert "no such pin" in window.ask(type="rename_pin", pin=9, label="Hall")["problem"]
        for unfit in ("", " Hall", "a" * 81):
            reply = window.ask(type="rename_pin", pin=2, label=unfit)
            assert reply["key"] == "label"
            assert reply["problem"].startswith("label: ")
    server.process.kill()
    server.process.wait()
    with serving(tmp_path / "home") as again:
        again.document = server.document
        with again.window() as window:
            assert pins(window) == renamed
            assert (
                window.ask(type="look", generation=None, individual=None, pin=2)["problem"] is None
            )
            assert again.state()["looking"]["label"] == "Generation 2, individual 1"


def test_the_net_that_is_named_is_taken_over_whatever_is_shown_by_then(server: Server) -> None:
    with server.window() as window:
        window.ask(type="look", generation=4, individual=2, pin=None)
        window.ask(type="look", generation=5, individual=None, pin=None)
        assert window.ask(type="reinstate", side="run/4/2")["problem"] is None
        last = server.state()["history"][-1]
        assert last["label"] == "Take over generation 4, individual 2"
        assert (last["origin"]["generation"], last["origin"]["individual"]) == (4, 2)
        assert "your design" in window.ask(type="reinstate", side="design")["problem"]
        assert "0 to 5" in window.ask(type="reinstate", side="run/77")["problem"]


def test_a_patch_is_of_the_net_that_is_named_whatever_is_shown_by_then(
    server: Server, run: sf.Run, tmp_path: Path
) -> None:
    individual = run.individual(4, 2)
    cells = select(individual, "all").expressed(individual.forest)
    asked = CopyPatch(id=1, name="crown", cells=cells, anchor=None, seed=None, side="run/4/2")
    request = asked.model_dump(exclude={"id"})
    with server.window() as window:
        window.ask(type="look", generation=5, individual=None, pin=None)
        assert window.ask(**request)["problem"] is None
        assert "0 to 5" in window.ask(**request | {"side": "run/77"})["problem"]
    patch = load_patch(tmp_path / "home" / "patches" / "crown.toml")
    assert patch.origin is not None
    assert (patch.origin.generation, patch.origin.individual) == (4, 2)
    assert patch.cells == lifted(individual, asked, patch.origin).cells
    assert patch.cells != lifted(run.parent(5), asked, patch.origin).cells


def test_a_design_taken_over_from_a_pin_keeps_the_name_of_the_pin(server: Server) -> None:
    with server.window() as window:
        pin(window, "design")
        window.ask(type="rename_pin", pin=1, label="Oslo")
        window.ask(type="look", generation=None, individual=None, pin=1)
        assert server.state()["looking"]["label"] == "Oslo"
        window.ask(type="reinstate", side="pin/1")
        assert server.state()["history"][-1]["label"] == "Take over Oslo"


def test_two_nets_are_compared_as_the_package_compares_them(run: sf.Run, server: Server) -> None:
    first, second = run.individual(5, 2), run.individual(1, 0)
    with server.window() as window:
        pin(window, "run/1/0")
        body = json.dumps({"first": "run/5/2", "second": "pin/1"})
        path = server.path(f"/api/documents/{server.document}/compare")
        status, answer = server.get(path, method="POST", body=body)
    assert status == 200
    told, found = json.loads(answer), compare(first, second)
    for side, design, measures in zip(
        ("first", "second"), (first, second), found.measures, strict=True
    ):
        equilibrium = design.solve()
        reactions = np.linalg.norm(equilibrium.reactions[design.anchors], axis=1)
        figures = figures_of(design).model_dump(mode="json")
        assert told[side]["figures"] == figures
        assert told[side]["load_path"] == pytest.approx(measures.load_path)
        assert [one[side] for one in told["reactions"]] == pytest.approx(reactions.tolist())
        assert told[side]["largest_reaction"] == pytest.approx(reactions.max())
    assert told["changed"] == len(found.changed) > 0
    assert {one["name"]: (one["first"], one["second"]) for one in told["types"]} == found.types


def test_a_picture_is_the_net_itself(run: sf.Run, server: Server) -> None:
    def springs(side: str) -> int:
        status, answer = server.get(server.path(f"/api/documents/{server.document}/net/{side}"))
        assert status == 200
        length = int.from_bytes(answer[:4], "little")
        _, arrays = decode(answer[4 : 4 + length])
        return len(arrays["spring_ends"]) // 2

    assert springs("run/2/7") == len(run.individual(2, 7).network().springs)
    assert springs("run/5") == len(run.parent(5).network().springs)
    assert springs("design") == server.state()["figures"]["springs"]


@pytest.mark.parametrize("side", ["pin/9", "run/99/0", "run/1/99", "nets", "pin/-1", "run/1/2/3"])
def test_what_is_no_net_is_refused(server: Server, side: str) -> None:
    status, answer = server.get(server.path(f"/api/documents/{server.document}/net/{side}"))
    assert status == 422
    assert "\n" not in json.loads(answer)["problem"]
    with server.window() as window:
        window.tell(type="pin", id=1, side=side)
        while (event := window.receive()).get("type") not in ("problem", "reply"):
            pass
        assert event.get("problem") or event.get("message")


def test_a_broken_list_of_pins_is_not_written_over(tmp_path: Path) -> None:
    design = sf.load("one-cylinder")
    figures = figures_of(design)
    folder = PinFolder(tmp_path)
    folder.keep(design, "Design at the start", None, None, figures)
    text = (tmp_path / "pins.json").read_text()
    (tmp_path / "pins.json").write_text(text[: len(text) // 2])
    broken = PinFolder(tmp_path)
    assert broken.pins == []
    with pytest.raises(InputError, match="no list of pins"):
        broken.keep(design, "Design at the start", None, None, figures)
    assert (tmp_path / "pins.json").read_text() == text[: len(text) // 2]
    (tmp_path / "pins.json").write_text(text)
    assert [one.number for one in PinFolder(tmp_path).pins] == [1]
    assert PinFolder(tmp_path).design(1).forest == design.closed.forest
