"""A window of the studio for tests: it starts a server, speaks with it, and takes frames apart."""

from __future__ import annotations

import http.client
import json
import struct
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from websockets.sync.client import ClientConnection, connect

from helpers import COMMAND

_TYPES = {"float32": "<f4", "int32": "<i4", "uint8": "u1"}


@dataclass
class Server:
    """A studio in a process of its own."""

    process: subprocess.Popen[str]
    port: int
    token: str
    document: str
    home: Path

    @property
    def host(self) -> str:
        return f"127.0.0.1:{self.port}"

    def path(self, path: str, token: str | None = None) -> str:
        return f"{path}?token={self.token if token is None else token}"

    def get(
        self, path: str, *, method: str = "GET", body: str | None = None, **headers: str
    ) -> tuple[int, Any]:
        """Return status and body of a request; headers are given by name, `_` for `-`."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, body, named)
        answer = connection.getresponse()
        return answer.status, answer.read()

    def state(self) -> dict[str, Any]:
        """Return the document as the engine tells it."""
        status, body = self.get(self.path(f"/api/documents/{self.document}"))
        assert status == 200
        found = json.loads(body)
        assert isinstance(found, dict)
        return found

    def socket_address(self, token: str | None = None) -> str:
        return f"ws://{self.host}{self.path(f'/api/documents/{self.document}/socket', token)}"

    @contextmanager
    def window(self) -> Iterator[Window]:
        with connect(self.socket_address(), max_size=None) as socket:
            yield Window(socket)


@contextmanager
def serving(
    home: Path, source: str = "one-cylinder", document: str | None = None
) -> Iterator[Server]:
    """Run a studio on a source, or on a document of before; it is killed at the end."""
    named = [] if document else [source]
    words = [COMMAND, "studio", *named, "--home", str(home), "--no-browser", "--json"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        told = json.loads(process.stdout.readline())
        address, _, opened = told["address"].partition("#")
        port, token = int(address.split(":")[2].split("/")[0]), address.split("token=")[1]
        yield Server(process, port, token, document or opened, home)
    finally:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()


@dataclass
class Window:
    """A connection that answers frames, and keeps what it was told."""

    socket: ClientConnection
    number: int = 0
    net: dict[str, Any] = field(default_factory=dict)
    motion: tuple[dict[str, Any], dict[str, Any]] | None = None
    document: dict[str, Any] | None = None
    problems: list[str] = field(default_factory=list)

    def receive(self, timeout: float = 30) -> dict[str, Any]:
        """Return the next event or header."""
        message = self.socket.recv(timeout)
        if isinstance(message, str):
            event: dict[str, Any] = json.loads(message)
            if event["type"] == "document":
                self.document = event
            if event["type"] == "problem":
                self.problems.append(event["message"])
            return event
        header, arrays = decode(message)
        if header["frame"] == "net":
            self.net = apply_net(self.net, header, arrays)
        else:
            self.motion = header, arrays
            self.tell(type="received")
        return header

    def tell(self, **request: Any) -> None:
        self.socket.send(json.dumps(request))

    def ask(self, **request: Any) -> dict[str, Any]:
        """Send a request and return its reply."""
        self.number += 1
        self.tell(id=self.number, **request)
        while True:
            event = self.receive()
            if event.get("type") == "reply" and event["id"] == self.number:
                return event

    def settle(self) -> None:
        """Wait until the net of the document has come to rest."""
        while True:
            if self.motion is not None and self.net and self.document is not None:
                header = self.motion[0]
                current = header["revision"] == self.net["revision"] == self.document["revision"]
                if current and header["settled"]:
                    return
            self.receive()


def decode(frame: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return header and arrays of a binary frame."""
    (length,) = struct.unpack_from("<I", frame)
    header = json.loads(frame[4 : 4 + length])
    arrays, offset = {}, 4 + length
    for array in header["arrays"]:
        found = np.frombuffer(frame, _TYPES[array["type"]], array["length"], offset)
        arrays[array["name"]] = found
        offset += found.nbytes + -found.nbytes % 4
    assert offset == len(frame)
    return header, arrays


def apply_net(
    before: dict[str, Any], header: dict[str, Any], arrays: dict[str, Any]
) -> dict[str, Any]:
    """Return the net of a frame, row by row as plain lists: the slow twin of the window's code."""
    assert header["base"] in (None, before.get("revision"))
    old = before if header["base"] is not None else {}

    def merged(runs: str, name: str, fresh: list[Any]) -> list[Any]:
        rows, taken = [], iter(fresh)
        for first, length in arrays[runs].reshape(-1, 2).tolist():
            kept = old.get(name, [])[first : first + length]
            rows += kept if first >= 0 else [next(taken) for _ in range(length)]
        assert next(taken, None) is None
        return rows

    def grouped(name: str, names: list[Any]) -> list[list[Any]]:
        items = iter(arrays[f"{name}_items"].tolist())
        return [[names[next(items)] for _ in range(n)] for n in arrays[f"{name}_counts"].tolist()]

    def runs_kept(runs: str, name: str) -> list[Any]:
        pieces = [(a, n) for a, n in arrays[runs].reshape(-1, 2).tolist() if a >= 0]
        return [row for a, n in pieces for row in old[name][a : a + n]]

    # A window knows springs by their rows, so a cell can only be kept with all of its springs.
    springs_kept = set(runs_kept("springs_runs", "springs"))
    for own in runs_kept("cells_runs", "own"):
        assert springs_kept.issuperset(own)
    net: dict[str, Any] = {"revision": header["revision"]}
    net["nodes"] = merged("nodes_runs", "nodes", header["node_keys"])
    ends = arrays["spring_ends"].reshape(-1, 2).tolist()
    pairs = [(net["nodes"][a], net["nodes"][b]) for a, b in ends]
    net["springs"] = merged("springs_runs", "springs", pairs)
    for name in ("spring_level", "spring_part", "spring_ring", "stiffness", "rest_length"):
        net[name] = merged("springs_runs", name, arrays[name].tolist())
    net["addresses"] = merged("cells_runs", "addresses", header["addresses"])
    net["types"] = merged("cells_runs", "types", header["types"])
    for name in ("cell_stored", "cell_level", "cell_part"):
        net[name] = merged("cells_runs", name, arrays[name].tolist())
    net["boundaries"] = merged("cells_runs", "boundaries", grouped("boundary", net["nodes"]))
    net["own"] = merged("cells_runs", "own", grouped("own", net["springs"]))
    return net
