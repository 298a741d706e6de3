"""The studio's server: who may speak with it, what it withstands, and what a kill can lose."""

from __future__ import annotations

import io
import json
import random
import signal
import socket
import threading
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from helpers import assert_refused, springform
from springform.design import load
from springform.studio import journal
from studio_client import Server, serving


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with serving(tmp_path_factory.mktemp("home")) as running:
        yield running


@pytest.mark.parametrize(
    "path", ["/", "/api/shelf", "/api/documents/{document}", "/api/documents/{document}/export/obj"]
)
def test_nobody_comes_in_without_the_token(server: Server, path: str) -> None:
    path = path.format(document=server.document)
    assert server.get(server.path(path))[0] in (200, 404)  # 404: the page is not built
    assert server.get(path, Authorization=f"Bearer {server.token}")[0] in (200, 404)
    for other in ("", "wrong", server.token[:-1], "%C3%BC"):
        assert server.get(f"{path}?token={other}")[0] == 403


@pytest.mark.parametrize("host", ["example.org", "127.0.0.1", "127.0.0.1:1", "0.0.0.0:{port}"])
def test_nobody_comes_in_by_another_name(server: Server, host: str) -> None:
    status, body = server.get(server.path("/api/shelf"), Host=host.format(port=server.port))
    assert status == 403
    assert b"documents" not in body


@pytest.mark.parametrize(
    "origin", ["http://example.org", "null", "https://127.0.0.1:{port}", "http://127.0.0.1:1"]
)
def test_no_other_page_comes_in(server: Server, origin: str) -> None:
    origin = origin.format(port=server.port)
    assert server.get(server.path("/api/shelf"), Origin=origin)[0] == 403
    body = json.dumps({"source": "sheet"})
    path = server.path("/api/documents")
    assert server.get(path, method="POST", body=body, Origin=origin)[0] == 403
    with pytest.raises(InvalidStatus) as refused:
        connect(server.socket_address(), origin=origin)
    assert refused.value.response.status_code == 403


def test_the_socket_needs_the_token(server: Server) -> None:
    with pytest.raises(InvalidStatus) as refused:
        connect(server.socket_address("wrong"))
    assert refused.value.response.status_code == 403
    with connect(server.socket_address(), origin=f"http://localhost:{server.port}"):
        pass


def test_it_listens_on_this_machine_only(server: Server) -> None:
    def answers(address: str) -> bool:
        with socket.socket() as probe:
            probe.settimeout(2)
            return probe.connect_ex((address, server.port)) == 0

    assert answers("127.0.0.1")
    own = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
    assert not any(answers(str(one)) for one in own if not str(one).startswith("127."))


def test_what_can_not_be_opened_says_why(server: Server) -> None:
    body = json.dumps({"source": "no-such-net"})
    status, answer = server.get(server.path("/api/documents"), method="POST", body=body)
    assert status == 422
    assert "no such file or scene" in json.loads(answer)["problem"]
    assert server.get(server.path("/api/documents/none"))[0] == 422
    assert server.get(server.path("/api/documents"), method="POST", body="[]")[0] == 422
    assert server.get(server.path("/api/scenes/none/picture"))[0] == 422
    status, answer = server.get(server.path(f"/api/documents/{server.document}/export/xyz"))
    assert status == 422
    assert "toml" in json.loads(answer)["problem"]


def test_a_curve_is_read_or_refused_with_its_line(server: Server) -> None:
    def read(body: str, name: str = "cord.csv") -> tuple[int, dict[str, Any]]:
        path = f"{server.path('/api/curve')}&name={name}"
        status, answer = server.get(path, method="POST", body=body)
        return status, json.loads(answer)

    status, curve = read("strain [%];force [N]\n0;0\n10;1,5\n")
    assert (status, curve) == (200, {"strains": [0.0, 0.1], "forces": [0.0, 1.5]})
    assert read("strain,force [N]\n0,0\n1,-\n") == (
        422,
        {"problem": 'cord.csv:3: the force is "-"; write a finite number'},
    )
    status, refusal = read("#" * (2**20 + 1))
    assert status == 422
    assert "larger than 1 MiB" in refusal["problem"]


def test_a_model_is_what_the_command_line_writes(server: Server, tmp_path: Path) -> None:
    def exported(name: str) -> bytes:
        status, body = server.get(server.path(f"/api/documents/{server.document}/export/{name}"))
        assert status == 200
        assert isinstance(body, bytes)
        return body

    file = tmp_path / "net.toml"
    file.write_bytes(exported("toml"))
    assert springform("solve", file, "--out", tmp_path / "results").code == 0
    with zipfile.ZipFile(io.BytesIO(exported("tables"))) as tables:
        for name in tables.namelist():
            assert tables.read(name) == (tmp_path / "results" / name).read_bytes(), name
    assert exported("obj") == (tmp_path / "results" / "net.obj").read_bytes()
    (tmp_path / "net.json").write_bytes(exported("json"))
    assert load(tmp_path / "net.json").to_file() == load(file).to_file()


def test_a_preview_changes_nothing_and_tells_only_who_asked(server: Server) -> None:
    with server.window() as first, server.window() as second:
        first.settle()
        second.settle()
        before = server.state()
        action = {"type": "set_density", "id": 1, "part": None, "level": 2}
        reply = first.ask(type="preview", action=action)
        assert reply["problem"] is None
        assert reply["preview"]["springs_added"] > 0
        assert server.state() == before
        assert second.ask(type="move", what="run")["preview"] is None


def test_what_follows_an_action_at_once_is_of_the_net_after_it(server: Server) -> None:
    """Nothing waits for the motion to show the net: the next request may come before it does."""
    with server.window() as window:
        window.settle()
        done = server.state()["position"]
        sent = 0
        for face in range(0, 40, 2):
            cell = {"what": "subdivide", "cells": [str(face)], "kind": None}
            following = {"what": "subdivide", "cells": [str(face + 1)], "kind": None}
            action = {"type": "edit_cells", "id": sent + 3, **following}
            window.tell(id=sent + 1, type="edit_cells", **cell)
            for number in (2, 3):
                window.tell(id=sent + number, type="preview", action=action)
            sent += 3
        answered: dict[int, dict[str, Any]] = {}
        while len(answered) < sent:
            event = window.receive()
            if event.get("type") == "reply":
                answered[event["id"]] = event
        assert [event["problem"] for event in answered.values() if event["problem"]] == []
        assert all(answered[number]["preview"]["springs_added"] > 0 for number in range(3, sent, 3))
        window.number = sent
        assert window.ask(type="travel", position=done)["problem"] is None


def test_a_window_sees_what_another_does(server: Server) -> None:
    with server.window() as first, server.window() as second:
        first.settle()
        second.settle()
        done = server.state()["position"]
        reply = first.ask(type="edit_cells", what="subdivide", cells=["40"], kind="1")
        assert reply["problem"] is None
        assert reply["cells"] == ["40.0", "40.1", "40.2", "40.3"]
        first.settle()
        while second.document is None or second.document["position"] != done + 1:
            second.receive()
        second.settle()
        assert second.net == first.net
        assert first.motion is not None
        assert second.motion is not None
        np.testing.assert_array_equal(first.motion[1]["positions"], second.motion[1]["positions"])
        assert second.ask(type="undo", redo=False)["problem"] is None
        assert server.state()["position"] == done


def test_a_request_of_unfit_values_is_answered_with_what_is_wrong(server: Server) -> None:
    with server.window() as window:
        reply = window.ask(type="move_anchor", anchor="A1", position=[1e9, 0, 0])
        assert reply["key"] == "x"
        assert reply["problem"] == "x: must be less than or equal to 1000000"
        assert window.ask(type="move_anchor", anchor="A1")["problem"] == "position: Field required"
        assert "tag" in window.ask(type="no such request")["problem"]


def test_an_action_that_does_not_fit_is_answered_and_changes_nothing(server: Server) -> None:
    with server.window() as window:
        before = server.state()
        for request in (
            {"type": "edit_cells", "what": "subdivide", "cells": ["999999"], "kind": None},
            {"type": "edit_cells", "what": "subdivide", "cells": ["not a cell"], "kind": None},
            {"type": "edit_cells", "what": "off", "cells": ["40"], "kind": None},
            {"type": "edit_cells", "what": "retype", "cells": ["40"], "kind": "99"},
            {"type": "edit_spring", "what": "cut", "nodes": ["v0", "v99999"]},
            {"type": "edit_spring", "what": "add", "nodes": ["v0", "v0"]},
            {"type": "move_anchor", "anchor": "nobody", "position": [0, 0, 0]},
            {"type": "fix_node", "node": "v2", "fixed": False},
            {"type": "set_value", "label": "x", "path": ["springs", "nothing"], "value": 1},
            {"type": "set_value", "label": "x", "path": ["springs", "stiffness"], "value": -1},
            {"type": "set_framework", "framework": {"grid": "round"}},
            {"type": "travel", "position": 10**6},
            {"type": "save", "path": None, "replace": False},
            {"type": "seek_stress", "steps": 1, "kind": "nothing"},
            {"type": "set_springs", "choice": {}, "says": {}},
            {"type": "set_springs", "choice": {}, "says": {"stiffness": -1}},
            {"type": "set_springs", "choice": {}, "says": {"stiffness": 1, "force": 2}},
            {"type": "set_springs", "choice": {"parts": ["nobody"]}, "says": {"force": 2}},
            {"type": "set_springs", "choice": {"pairs": ["v0"]}, "says": {"force": 2}},
            {"type": "drop_springs", "group": 10**6},
            {"type": "set_density", "part": "nobody", "level": 1},
            {"type": "set_density", "part": None, "level": 0},
            {"type": "fix_node", "node": "v0", "fixed": True, "line": [0, 0, 0]},
            {"type": "fix_node", "node": "v0", "fixed": True, "holds": "x", "plane": [0, 0, 1]},
            {
                "type": "preview",
                "action": {"type": "set_density", "id": 1, "part": "no", "level": 1},
            },
        ):
            assert window.ask(**request)["problem"], request
        window.tell(type="hold", node="nowhere", position=[0, 0, 0])
        while not window.problems:
            window.receive()
        assert server.state() == before


_PLACE = {
    "patch": "nobody",
    "cell": 3,
    "anchor": None,
    "rotate": 1,
    "mirror": False,
    "orbit": False,
}


def _malformed(chance: random.Random, good: list[dict[str, Any]]) -> str | bytes:
    """A message with something wrong: bytes, broken JSON, or a good one with a part replaced."""
    junk: list[Any] = [None, -1, 1e308, "", "x" * 300, [], {}, [[]], {"a": 1}, "\x00", True, 2**70]
    kind = chance.randrange(4)
    text = json.dumps(chance.choice(good))
    if kind == 0:
        return chance.randbytes(chance.randrange(64))
    if kind == 1:
        at = chance.randrange(len(text))
        return text[:at] + chance.choice(["", "\x00", "}", '"', "[" * 50]) + text[at + 1 :]
    message = dict(chance.choice(good))
    if kind == 2:
        message[chance.choice([*message, "more"])] = chance.choice(junk)
    else:
        del message[chance.choice(list(message))]
    # Whatever is left well-formed by chance asks for something that does not exist.
    return json.dumps(message)


def test_ten_thousand_malformed_messages_change_nothing(server: Server) -> None:
    chance = random.Random(7)
    good: list[dict[str, Any]] = [
        {"type": "edit_cells", "id": 1, "what": "subdivide", "cells": ["x"], "kind": None},
        {"type": "edit_spring", "id": 1, "what": "cut", "nodes": ["x", "y"]},
        {"type": "move_anchor", "id": 1, "anchor": "nobody", "position": [0, 0, 0]},
        {"type": "fix_node", "id": 1, "node": "x", "fixed": True},
        {"type": "set_value", "id": 1, "label": "x", "path": ["nothing"], "value": 1},
        {"type": "travel", "id": 1, "position": 10**9},
        {"type": "hold", "node": "x", "position": [0, 0, 0]},
        {"type": "seek_stress", "id": 1, "steps": 1, "kind": "nothing"},
        {"type": "set_framework", "id": 1, "framework": {}},
        {"type": "select_cells", "id": 1, "words": "rings(nobody, 1)", "grow": 1, "orbit": True},
        {"type": "ask_symmetry", "id": 1},
        {"type": "copy_patch", "id": 1, "name": "p", "cells": ["x"], "anchor": None, "seed": None},
        {"type": "rename_patch", "id": 1, "patch": "nobody", "name": "other"},
        {"type": "delete_patch", "id": 1, "patch": "nobody"},
        {"type": "plan_graft", "id": 1, "measure": True, **_PLACE},
        {"type": "graft", "id": 1, **_PLACE},
        {"type": "set_springs", "id": 1, "choice": {"pairs": ["x y"]}, "says": {"force": 0}},
        {"type": "drop_springs", "id": 1, "group": 10**6},
        {"type": "set_density", "id": 1, "part": "nobody", "level": 0},
        {"type": "fix_node", "id": 1, "node": "x", "fixed": True, "holds": "xy"},
        {
            "type": "preview",
            "id": 1,
            "action": {"type": "set_springs", "id": 1, "choice": {}, "says": {"no": 1}},
        },
    ]
    before = server.state()
    answers = 0
    for _ in range(20):
        with connect(server.socket_address(), max_size=None) as window:

            def listen(window: Any = window) -> None:
                nonlocal answers
                # What was sent last is answered last.
                while '"id":77' not in str(message := window.recv(60)):
                    if isinstance(message, str):
                        answers += '"problem"' in message or '"reply"' in message

            listening = threading.Thread(target=listen)
            listening.start()
            for _ in range(500):
                window.send(_malformed(chance, good))
            window.send('{"type":"move","id":77,"what":"run"}')
            listening.join()
    assert server.process.poll() is None
    assert answers >= 9_000  # a few are well-formed by chance, and need no answer
    assert server.state() == before
    with server.window() as window:
        assert window.ask(type="move", what="run")["problem"] is None


def test_a_message_that_is_too_large_ends_only_its_window(server: Server) -> None:
    def send_and_listen(window: ClientConnection) -> None:
        window.send("x" * (5 * 2**20))
        while True:
            window.recv(timeout=30)

    with connect(server.socket_address(), max_size=None) as window, pytest.raises(ConnectionClosed):
        send_and_listen(window)
    assert server.state()["position"] >= 0


@pytest.mark.parametrize("part", range(5))
def test_a_kill_loses_at_most_the_action_in_flight(part: int, tmp_path: Path) -> None:
    chance = random.Random(part)
    with serving(tmp_path) as running:
        folder = tmp_path / running.document
    done = 0
    for _ in range(10):
        with serving(tmp_path) as running:
            # Only the first document is worked on; the one that starting made is left alone.
            running.document = folder.name
            last, wait = done + chance.randrange(8), chance.uniform(0, 0.03)
            asked = done
            try:
                with running.window() as window:
                    while True:
                        if asked == last:
                            killing = threading.Timer(wait, running.process.kill)
                            killing.start()
                        asked += 1
                        reply = window.ask(**_next_action(chance, asked))
                        assert reply["problem"] is None, reply
                        done = asked
            except (ConnectionClosed, OSError, EOFError, InvalidHandshake):
                killing.join()
        _, lines, _ = journal.read(folder)
        assert done <= lines <= asked
        done = lines
    assert done > 0
    with journal.reopen(folder) as kept:
        while kept.document.position:
            kept.undo()


def _next_action(chance: random.Random, number: int) -> dict[str, Any]:
    if number % 3 == 0:
        says = {"stiffness": 1.0 + number}
        return {"type": "set_springs", "choice": {"parts": ["tube"]}, "says": says}
    position = [chance.uniform(1, 3), chance.uniform(1, 3), float(number)]
    return {"type": "move_anchor", "anchor": "A1", "position": position}


def test_saving_writes_a_file_that_the_command_line_reads(tmp_path: Path) -> None:
    file = tmp_path / "net.toml"
    assert springform("init", "one-cylinder", "--out", file).code == 0
    with serving(tmp_path / "home", str(file)) as running:
        assert running.state()["saved"]
        with running.window() as window:
            window.ask(type="edit_cells", what="subdivide", cells=["9"], kind="1")
            assert not running.state()["saved"]
            assert window.ask(type="save", path=None, replace=False)["problem"] is None
            other = tmp_path / "other.json"
            other.write_text("{}")
            path = {"type": "save", "path": str(other)}
            assert "exists" in window.ask(**path, replace=False)["problem"]
            assert window.ask(**path, replace=True)["problem"] is None
        state = running.state()
        assert state["saved"]
        assert state["file"] == str(other)
    for saved in (file, other):
        report = springform("solve", saved, "--json").report
        assert report["springs"] == state["figures"]["springs"]


def test_a_file_that_was_changed_elsewhere_is_an_action(tmp_path: Path) -> None:
    file = tmp_path / "net.toml"
    springform("init", "one-cylinder", "--out", file)
    with serving(tmp_path / "home", str(file)) as running:
        first = running.document
    springform("seek", file, "--steps", "3", "--type", "1", "--out", file)
    with serving(tmp_path / "home", str(file)) as running:
        assert running.document == first
        state = running.state()
        assert state["history"][0]["label"] == "Read net.toml, changed elsewhere"
        assert state["saved"]


def test_it_ends_when_told(tmp_path: Path) -> None:
    with serving(tmp_path) as running:
        with running.window() as window:
            window.settle()
            running.process.send_signal(signal.SIGINT)
            assert running.process.wait(20) == 0
        folder = tmp_path / running.document
    assert (folder / "snapshot.json").exists()


def test_bad_sources_and_ports_are_refused(server: Server, tmp_path: Path) -> None:
    home = ("--home", tmp_path / "home", "--no-browser")
    assert_refused(springform("studio", "no-such-net", *home), "no such file or scene")
    taken = springform("studio", *home, "--port", str(server.port))
    assert_refused(taken, f"port {server.port} can't be used")
    file = tmp_path / "file"
    file.write_text("")
    assert_refused(springform("studio", "--home", file, "--no-browser"), "can't be made")
