"""Who drives a run, and what others ask of the driver: pause, go on, stop, change parameters.

    RUN/lock              who drives; locked for as long as the driver lives
    RUN/requests.jsonl    a line a request, appended by anyone; the driver obeys between generations
    RUN/watched           touched now and then by whoever watches, so that checkpoints come quickly

A driver that died leaves its lock behind, which nobody holds: it is stale. Where locks do not reach
other machines, the driver's lease says that it lives: it renews it at every checkpoint.
"""

from __future__ import annotations

import fcntl
import os
import platform
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from .errors import RunError
from .files import WriteError, explain

Program = Literal["command line", "studio"]
Asked = Literal["pause", "continue", "stop", "change"]
ASKED: tuple[Asked, ...] = ("pause", "continue", "stop", "change")
"""What a driver can be asked for."""

LEASE = 30.0
"""Seconds for which a driver on another machine counts as alive after it was heard [s]."""

_LINE = 512
"""Length of what a lock says [bytes]."""

_WATCHED = 5.0
"""Seconds for which a run counts as watched after somebody looked [s]."""


class Driver(BaseModel):
    """Who drives a run: what the lock holds."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    program: Program
    pid: int
    host: str
    renewed: float
    """Seconds since 1970."""
    standing: bool
    """Whether it was paused."""

    def __str__(self) -> str:
        """Return words such as ``the studio (process 812)``."""
        where = "" if self.host == platform.node() else f" on {self.host}"
        return f"the {self.program} (process {self.pid}{where})"


class Request(BaseModel):
    """What somebody asked of the driver."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    what: Asked
    parameters: dict[str, Any] = {}


class Lease:
    """The lock of a run while this process drives it; made by `RunWriter`'s makers."""

    def __init__(self, file: int, program: Program) -> None:
        """Sign an open and locked lock file."""
        self._file = file
        self._program: Program = program
        self._standing = False
        self.renew()

    def say(self, *, standing: bool) -> None:
        """Say that the run stands still, or goes on, if that is new."""
        if standing != self._standing:
            self._standing = standing
            self.renew()

    def renew(self) -> None:
        """Say that the driver lives."""
        driver = Driver(
            program=self._program,
            pid=os.getpid(),
            host=platform.node(),
            renewed=time.time(),
            standing=self._standing,
        )
        # Of one length, so that whoever reads meanwhile finds no rest of a longer text.
        text = driver.model_dump_json().encode().ljust(_LINE - 1) + b"\n"
        with suppress(OSError):  # a full disk must not end the run
            os.pwrite(self._file, text, 0)
            os.ftruncate(self._file, len(text))

    def end(self) -> None:
        """Leave an empty lock behind."""
        with suppress(OSError):
            os.ftruncate(self._file, 0)


class Requests:
    """The requests to a driver from now on."""

    def __init__(self, folder: Path) -> None:
        """Begin after what was asked of earlier drivers."""
        self._path = folder / "requests.jsonl"
        self._read = self._path.stat().st_size if self._path.exists() else 0

    def new(self) -> list[Request]:
        """Return what was asked since the last time; what is no request is left out."""
        try:
            if self._path.stat().st_size <= self._read:
                return []
            with self._path.open("rb") as file:
                file.seek(self._read)
                text = file.read()
        except OSError:
            return []
        complete = text[: text.rfind(b"\n") + 1]
        self._read += len(complete)
        found = []
        for line in complete.splitlines():
            with suppress(ValidationError):
                found.append(Request.model_validate_json(line))
        return found


def driver_of(folder: Path) -> Driver | None:
    """Return who drives a run; None: nobody does, whatever a dead driver left behind."""
    try:
        file = os.open(folder / "lock", os.O_RDONLY)
    except OSError:
        return None
    try:
        signed = _signed(file)
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            return signed
        return signed if signed is not None and _far_and_alive(signed) else None
    finally:
        os.close(file)


def check_free(file: int, folder: Path) -> None:
    """Refuse a lock whose driver lives on another machine. Raises `RunError`."""
    signed = _signed(file)
    if signed is not None and _far_and_alive(signed):
        raise RunError(f"another process drives this run: {signed}; wait for it", file=folder)


def ask_driver(folder: Path, what: Asked, parameters: Mapping[str, Any] | None = None) -> Driver:
    """Ask whoever drives a run for something, and return who that is.

    The driver obeys between two generations. Raises `RunError`: nobody drives it. `WriteError`: the
    request can't be written.
    """
    driver = driver_of(folder)
    if driver is None:
        raise RunError("nobody drives this run; resume it", file=folder)
    line = Request(what=what, parameters=dict(parameters or {})).model_dump_json() + "\n"
    path = folder / "requests.jsonl"
    try:
        with path.open("ab") as file:
            file.write(line.encode())
    except OSError as error:
        raise WriteError(f"can't be written: {explain(error)}", file=path) from None
    return driver


def watch(folder: Path) -> None:
    """Let the driver know that somebody watches."""
    with suppress(OSError):
        (folder / "watched").touch()


def is_watched(folder: Path) -> bool:
    """Whether somebody watched lately."""
    try:
        return time.time() - (folder / "watched").stat().st_mtime < _WATCHED
    except OSError:
        return False


def _signed(file: int) -> Driver | None:
    try:
        return Driver.model_validate_json(os.pread(file, 4096, 0))
    except (OSError, ValidationError):
        return None


def _far_and_alive(driver: Driver) -> bool:
    return driver.host != platform.node() and time.time() - driver.renewed < LEASE
