"""The studio: how soon a net follows the hand, and how often it is told.

A server in a process of its own, a client that speaks with it as a window does but draws nothing,
and, where it can be had, a window in Chromium.
"""

from __future__ import annotations

import json
import math
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from websockets.sync.client import ClientConnection, connect

from ..arrays import Floats
from ..design import Design, save
from . import page
from .comparison import Bench
from .nets import evolved, large_design
from .records import Row
from .timing import Spread

PULLED = 3_000
"""Springs of the net that is pulled."""

STREAMED = 20_000
"""Springs of the net that is streamed."""

_MOVES = 60
"""Moves of the pointer in a round."""

_ROUNDS = 5

_SECONDS = 1.0
"""How long frames are counted in a round [s]."""

_PERIOD = 1 / 60
"""Seconds between two moves of a pointer [s]."""

_DTYPES = {"float32": "<f4", "int32": "<i4", "uint8": "u1"}


def studio(case: str, bench: Bench) -> Iterator[Row]:
    """Time the way from a pointer's move to new positions, and count frames of a large net."""
    rounds = 2 if bench.quick else _ROUNDS
    net = evolved("three-cylinders", bench.springs(PULLED), ("1", "6"), "dynamic")
    with _window(net) as window:
        slowest = [window.follow(bench.count(_MOVES), start) for start in range(rounds)]
        note = f"of {bench.count(_MOVES)} moves, one after the other; server, socket and decoding"
        yield Row(
            case,
            "three-cylinders",
            window.springs,
            "springform",
            "ms to new positions, 95 %",
            Spread.of([1e3 * seconds for seconds in slowest]),
            note=note,
        )
    large = large_design(bench.springs(STREAMED))
    with _window(large) as window:
        window.pull(0.5)
        paces = [window.pull(_SECONDS) for _ in range(rounds)]
        note = f"frames while a node is pulled 60 times a second, {window.size / 1024:.0f} kB each"
        yield Row(
            case,
            "cylinder",
            window.springs,
            "springform",
            "frames/s",
            Spread.of(paces),
            note=note,
        )
    if page.available():
        yield from page.page(case, bench, net, large)


@contextmanager
def _window(design: Design) -> Iterator[_Window]:
    """Serve a design as `springform studio` does, and join it once it has settled."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "net.toml"
        save(design, file)
        words = ["studio", str(file), "--home", f"{folder}/home", "--no-browser", "--json"]
        program = [sys.executable, "-c", "from springform.cli import main; main()", *words]
        with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as process:
            try:
                assert process.stdout is not None
                address = str(json.loads(process.stdout.readline())["address"])
                server, document = address.removeprefix("http://").split("#")
                host, token = server.split("/?")
                socket = f"ws://{host}/api/documents/{document}/socket?{token}"
                with connect(socket, max_size=None, compression=None) as line:
                    yield _Window(line)
            finally:
                process.kill()


class _Window:
    """One client: it keeps where the net is, and answers every frame of motion."""

    def __init__(self, line: ClientConnection) -> None:
        self._line = line
        self.springs = 0
        self.size = 0
        """Bytes of the last frame of motion [B]."""
        nodes: list[str] = []
        anchors: set[int] = set()
        while True:
            header, arrays = self._frame(math.inf)
            if header["frame"] == "net":
                nodes, anchors = header["node_keys"], set(arrays["anchors"].tolist())
                self.springs = len(arrays["stiffness"])
            elif header["settled"]:
                break
        self._row = next(row for row in range(len(nodes) // 2, len(nodes)) if row not in anchors)
        self._key = nodes[self._row]
        self._start = arrays["positions"].reshape(-1, 3)[self._row].astype(float)
        extent = np.ptp(arrays["positions"].reshape(-1, 3), axis=0).max()
        self._reach = 0.02 * float(extent)
        self._turn = 0

    def follow(self, moves: int, start: int) -> float:
        """Return within which time 95 % of the moves of a node reached the client as positions."""
        seconds = []
        for move in range(moves):
            # Moves come at any time between two steps of the engine.
            time.sleep(((7 * move + start) % 17) * 1e-3)
            place, began = self._move(), time.perf_counter()
            while True:
                header, arrays = self._frame(math.inf)
                if header["frame"] == "motion":
                    now = arrays["positions"][3 * self._row : 3 * self._row + 3]
                    if np.abs(now - place).max() < 1e-5:
                        break
            seconds.append(time.perf_counter() - began)
        self._line.send('{"type": "release"}')
        return float(np.quantile(seconds, 0.95))

    def pull(self, seconds: float) -> float:
        """Return frames of motion a second while a node is pulled about."""
        began = moved = time.perf_counter()
        frames = 0
        while (now := time.perf_counter()) < began + seconds:
            if now >= moved:
                self._move()
                moved = now + _PERIOD
            header, _ = self._frame(moved)
            frames += header.get("frame") == "motion"
        return frames / (time.perf_counter() - began)

    def _move(self) -> Floats:
        self._turn += 1
        angle = 0.3 * self._turn
        place: Floats = self._start + self._reach * np.array(
            [math.cos(angle), math.sin(angle), math.sin(0.7 * angle)]
        )
        request = {"type": "hold", "node": self._key, "position": place.tolist()}
        self._line.send(json.dumps(request))
        return place

    def _frame(self, until: float) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return header and arrays of the next frame; none of both if there is none in time."""
        while True:
            left = None if until == math.inf else max(0.0, until - time.perf_counter())
            try:
                message = self._line.recv(left)
            except TimeoutError:
                return {}, {}
            if isinstance(message, bytes):
                break
        header, arrays = _decoded(message)
        if header["frame"] == "motion":
            self.size = len(message)
            self._line.send('{"type": "received"}')
        return header, arrays


def _decoded(frame: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    (length,) = struct.unpack_from("<I", frame)
    header: dict[str, Any] = json.loads(frame[4 : 4 + length])
    arrays, offset = {}, 4 + length
    for array in header["arrays"]:
        found = np.frombuffer(frame, _DTYPES[array["type"]], array["length"], offset)
        arrays[array["name"]] = found
        offset += found.nbytes + -found.nbytes % 4
    return header, arrays
