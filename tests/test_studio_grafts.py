"""Grafting in the studio: selections, the folder of patches, plans, grafts and whole orbits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

from springform import Design, _core, load
from springform.errors import InputError
from springform.grafting import graft, symmetries
from springform.patch_file import load_patch
from springform.selections import select
from springform.studio.changes import apply
from springform.studio.commands import edit_spring
from springform.studio.grafts import frames_around, graft_figures
from springform.studio.messages import EditSpring
from springform.studio.patches import tiles_of
from studio_client import Server, Window, serving

PLACE: dict[str, Any] = {
    "patch": "crown",
    "cell": None,
    "anchor": None,
    "rotate": 0,
    "mirror": False,
    "orbit": False,
}


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    with serving(tmp_path, "three-cylinders") as running:
        yield running


def select_words(window: Window, words: str | None, **more: Any) -> list[str]:
    reply = window.ask(type="select_cells", words=words, **more)
    assert reply["problem"] is None, reply
    return list(reply["cells"])


def lift_crown(window: Window) -> None:
    around = select_words(window, "rings(A3, 1)")
    window.ask(type="edit_cells", what="subdivide", cells=around[:1], kind="1")
    cells = select_words(window, "rings(A3, 2)")
    copied = {"type": "copy_patch", "name": "crown", "cells": cells, "anchor": "A3", "seed": None}
    assert window.ask(**copied)["problem"] is None


def test_words_select_what_they_select_everywhere(server: Server) -> None:
    design = load("three-cylinders")
    with server.window() as window:
        for words in ("rings(A7, 2)", "row(12)", "loop(12)", "part(trunk)", "all"):
            found = select_words(window, words)
            assert found == select(design, words).expressed(design.forest)
        part = select(design, "part(trunk)")
        assert set(select(design, "row(0)").faces) <= set(part.faces)
        assert len(select(design, "row(0)").faces) > 2
        # A loop is the same from wherever it is begun.
        loop = select(design, "loop(40)").faces
        assert len(loop) > 2
        one = select_words(window, None, cells=["40"])
        more = select_words(window, None, cells=one, grow=1)
        assert select_words(window, None, cells=more, grow=-1) == one
        orbit = select_words(window, "40", orbit=True)
        images = symmetries(design).images((40, 0, False))
        assert set(orbit) == {str(face) for face, _, _ in images}
        assert window.ask(type="select_cells", words="rings(A99, 1)")["problem"]
        assert window.ask(type="select_cells", words=None, cells=one, grow=-1)["problem"]


def test_a_plan_changes_nothing_and_a_graft_is_one_action(server: Server) -> None:
    with server.window() as window:
        lift_crown(window)
        before = server.state()
        plan = window.ask(type="plan_graft", measure=True, **PLACE)["answer"]
        assert server.state() == before
        assert {one["anchor"] for one in plan["placed"]} == {f"A{n}" for n in range(1, 13)}
        assert len(plan["springs"]) % 6 == 0
        assert plan["before"]["springs"] == before["figures"]["springs"]
        reply = window.ask(type="graft", **PLACE)
        assert reply["problem"] is None
        after = server.state()
        assert after["position"] == before["position"] + 1
        assert after["figures"]["springs"] == plan["after"]["springs"]
        assert after["figures"]["force_max"] == pytest.approx(plan["after"]["force_max"], rel=1e-6)
        assert plan["after"]["dangling"] == 0
        assert window.ask(type="undo", redo=False)["problem"] is None
        assert server.state()["figures"] == before["figures"]
        turned = window.ask(type="plan_graft", measure=False, **PLACE | {"rotate": 1})["answer"]
        assert turned["placed"] == plan["placed"]


def test_a_plan_asked_for_right_after_an_action_is_of_the_net_that_it_made(server: Server) -> None:
    with server.window() as window:
        lift_crown(window)
        window.settle()
        for cell in ("3", "7", "11", "15"):
            window.tell(id=-1, type="edit_cells", what="subdivide", cells=[cell], kind="1")
            plan = window.ask(type="plan_graft", measure=True, **PLACE)
            assert plan["problem"] is None
            springs = server.state()["figures"]["springs"]
            assert plan["answer"]["before"]["springs"] == springs


def test_what_does_not_fit_says_why(server: Server) -> None:
    with server.window() as window:
        lift_crown(window)
        before = server.state()
        for change in ({"cell": 99999}, {"anchor": "nobody"}, {"patch": "nothing"}):
            for kind in ({"type": "graft"}, {"type": "plan_graft", "measure": True}):
                assert window.ask(**kind, **PLACE | change)["problem"]
        free = {"type": "copy_patch", "name": "free", "cells": ["90"], "anchor": None, "seed": None}
        assert window.ask(**free)["problem"] is None
        assert "anchor corner" in window.ask(type="graft", **PLACE | {"patch": "free"})["problem"]
        assert "touched" in window.ask(**free | {"name": "far", "anchor": "A3"})["problem"]
        assert "called that already" in window.ask(**free)["problem"]
        assert server.state() == before


def test_patches_are_files_that_are_renamed_and_deleted(server: Server, tmp_path: Path) -> None:
    with server.window() as window:
        lift_crown(window)
        file = tmp_path / "patches" / "crown.toml"
        patch = load_patch(file)
        assert patch.anchored
        (tmp_path / "patches" / "broken.toml").write_text("springform_patch = 1")
        renaming = {"type": "rename_patch", "patch": "crown", "name": "other"}
        assert window.ask(**renaming)["problem"] is None
        assert not file.exists()
        assert load_patch(file.with_stem("other")).cells == patch.cells
        assert "broken" in window.ask(**renaming | {"patch": "other", "name": "broken"})["problem"]
        assert window.ask(type="delete_patch", patch="other")["problem"] is None
        window.tell(type="list_patches", id=900)
        while (event := window.receive()).get("type") != "patches" or len(event["patches"]) != 1:
            pass
        assert event["patches"][0]["problem"]


def test_tiles_of_a_patch_cover_it_once(server: Server, tmp_path: Path) -> None:
    with server.window() as window:
        lift_crown(window)
    patch = load_patch(tmp_path / "patches" / "crown.toml")
    tiles = tiles_of(patch)
    assert sum(tile.size**2 for tile in tiles) == pytest.approx(len(patch.walks))
    places = {(tile.x, tile.y) for tile in tiles}
    assert len(places) == len(tiles)


def test_frames_round_an_anchor_put_the_corner_on_it(server: Server, tmp_path: Path) -> None:
    with server.window() as window:
        lift_crown(window)
    design, patch = load("three-cylinders"), load_patch(tmp_path / "patches" / "crown.toml")
    for anchor, vertex in zip(design.anchor_names, design.anchor_vertices, strict=True):
        for mirror in (False, True):
            # On a ring it would lie half beyond the border if it were turned.
            [frame] = frames_around(design, patch, anchor, mirror=mirror)
            assert design.mesh.faces[frame[0]][frame[1]] == vertex
            assert graft(design, patch, at=[frame]).skipped == ()
            assert frame[2] is mirror
        best = _core.best_frame(design.setting, patch.core(), vertex)
        assert frames_around(design, patch, anchor, mirror=False)[0] == best


def test_a_patch_turns_round_an_anchor_as_far_as_it_stays_whole(server: Server) -> None:
    with server.window() as window:
        lift_crown(window)
        node = "v31"
        assert window.ask(type="fix_node", node=node, fixed=True)["problem"] is None
        inner = server.state()["anchors"][-1]["name"]
        around = select_words(window, f"rings({inner}, 1)")
        one = {"type": "edit_cells", "what": "subdivide", "cells": around[:1], "kind": "1"}
        assert window.ask(**one)["problem"] is None
        cells = select_words(window, f"rings({inner}, 1)")
        copied = {"type": "copy_patch", "name": "flower", "cells": cells, "anchor": inner}
        assert window.ask(**copied, seed=None)["problem"] is None
        assert window.ask(type="undo", redo=False)["problem"] is None
        place = PLACE | {"patch": "flower", "anchor": inner}
        plans = [
            window.ask(type="plan_graft", measure=False, **place | {"rotate": turn})["answer"]
            for turn in range(5)
        ]
        assert [plan["turns"] for plan in plans] == [4] * 5
        assert all(plan["skipped"] == [] for plan in plans)
        seeds = [plan["placed"][0]["cell"] for plan in plans]
        assert set(seeds[:4]) == {int(cell.split(".")[0]) for cell in around}
        assert seeds[4] == seeds[0]
        # On the rings nothing is lost by a rotation either: the patch lies in its one way.
        crown = PLACE | {"anchor": "A3"}
        for turn in range(3):
            asked = {"type": "plan_graft", "measure": False, **crown, "rotate": turn}
            plan = window.ask(**asked)["answer"]
            assert (plan["turns"], plan["skipped"]) == (1, [])


@pytest.mark.parametrize("what", ["subdivide", "retype", "off"])
def test_the_lock_edits_the_whole_orbit(server: Server, what: str) -> None:
    design = load("three-cylinders")
    orbit = {face for face, _, _ in symmetries(design).images((40, 0, False))}
    with server.window() as window:
        divide = {"type": "edit_cells", "what": "subdivide", "cells": ["40"], "kind": "1"}
        if what == "off":
            assert window.ask(**divide, orbit=True)["problem"] is None
        cells = ["40.1"] if what == "off" else ["40"]
        kind = "2" if what == "retype" else "1"
        asked = {"type": "edit_cells", "what": what, "cells": cells, "kind": kind, "orbit": True}
        reply = window.ask(**asked)
        assert reply["problem"] is None
        assert {int(cell.split(".")[0]) for cell in reply["cells"]} == orbit
        told = window.ask(type="ask_symmetry")["answer"]
        assert (told["rotations"], told["mirrors"], told["broken"]) == (6, 6, "")
        done = server.state()["position"]
        assert window.ask(**divide | {"cells": ["41"]})["problem"] is None
        assert window.ask(type="ask_symmetry")["answer"]["broken"]
        assert server.state()["position"] == done + 1


def springs_of(design: Design) -> set[frozenset[str]]:
    nodes = design.nodes
    return {frozenset((nodes[a], nodes[b])) for a, b in design.network().springs.tolist()}


def images_of(design: Design, pair: Iterable[str]) -> set[frozenset[str]]:
    """Return where the symmetries carry a spring, by its ends: the slow way."""
    group = symmetries(design)
    ends = [group.node_images(design.mesh, node) for node in pair]
    return {frozenset(image) for image in zip(*ends, strict=True)}


@pytest.mark.parametrize(("scene", "kinds"), [("three-cylinders", 1), ("one-cylinder-quad", 2)])
def test_the_lock_cuts_and_adds_whole_orbits_of_springs(scene: str, kinds: int) -> None:
    design = load(scene)
    before = springs_of(design)
    # Some lie across a mirror, which carries them to themselves; some share ends with their images.
    sizes = set()
    for pair in sorted(before, key=sorted)[::7]:
        asked = EditSpring(id=1, what="cut", nodes=sorted(pair), orbit=True)
        action = edit_spring(design, asked)
        cut = apply(design, action)
        orbit = images_of(design, sorted(pair))
        sizes.add(len(orbit))
        assert before - springs_of(cut) >= orbit
        symmetries(design).check(cut.setting, cut.closed.forest)
        again = asked.model_copy(update={"what": "add"})
        assert springs_of(apply(cut, edit_spring(cut, again))) == before
        with pytest.raises(InputError, match="already"):
            edit_spring(cut, asked)
    assert len(sizes) == kinds
    ends = sorted(design.nodes[row] for row in design.anchors[:2])
    asked = EditSpring(id=1, what="add", nodes=ends, orbit=True)
    added = apply(design, edit_spring(design, asked))
    assert springs_of(added) - before == images_of(design, ends)
    assert (
        springs_of(apply(added, edit_spring(added, asked.model_copy(update={"what": "cut"}))))
        == before
    )


def test_an_orbit_of_springs_that_would_break_a_rule_is_refused_whole(server: Server) -> None:
    design = load("three-cylinders")
    with server.window() as window:
        state = server.state()
        a1 = design.nodes[design.anchors[0]]
        at_anchor = [sorted(pair) for pair in springs_of(design) if a1 in pair]
        replies = [
            window.ask(type="edit_spring", what="cut", nodes=nodes, orbit=True)["problem"]
            for nodes in at_anchor
        ]
        assert any(replies), "an anchor without springs is no net"
        now = server.state()
        done = now["position"]
        assert done == replies.count(None)
        assert now["figures"]["springs"] < state["figures"]["springs"]
        assert now["history"][0]["label"] == "Cut 12 springs, symmetrically"
        assert window.ask(type="travel", position=0)["problem"] is None
        assert server.state()["figures"] == state["figures"]
        # One of the images is no spring any more, because a cell there is divided.
        nodes = at_anchor[0]
        window.settle()
        other = min(images_of(design, nodes) - {frozenset(nodes)}, key=sorted)
        square = next(
            address
            for address, ring in zip(window.net["addresses"], window.net["boundaries"], strict=True)
            if other <= set(ring)
        )
        divide = {"type": "edit_cells", "what": "subdivide", "cells": [square], "kind": "1"}
        assert window.ask(**divide)["problem"] is None
        before = server.state()
        refused = window.ask(type="edit_spring", what="cut", nodes=nodes, orbit=True)["problem"]
        assert "is no spring of the net, though an image of it is" in refused
        assert server.state() == before


def test_the_lock_holds_for_stress_seeking(server: Server) -> None:
    with server.window() as window:
        asked = {"type": "seek_stress", "steps": 1, "kind": "1"}
        reply = window.ask(**asked, orbit=True)
        divided = {cell.rsplit(".", 1)[0] for cell in reply["cells"]}
        design = load("three-cylinders")
        first = int(min(divided, key=int))
        assert divided == {str(face) for face, _, _ in symmetries(design).images((first, 0, False))}
        assert window.ask(**asked | {"steps": 2}, orbit=True)["problem"] is None
        state = server.state()
        labels = [line["label"] for line in state["history"]]
        assert labels == [
            "Seek stress, 1 step, symmetrically",
            "Seek stress, 2 steps, symmetrically",
        ]
        assert window.ask(type="ask_symmetry")["answer"]["broken"] == ""
        assert window.ask(**asked)["problem"] is None
        assert "differ" in window.ask(**asked, orbit=True)["problem"]


def test_a_loose_end_is_counted() -> None:
    design = load("one-cylinder")
    assert graft_figures(design).dangling == 0
