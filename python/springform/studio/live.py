"""Live evolution: the net evolves while anchors are dragged and cells are brushed."""

from __future__ import annotations

import os
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from .. import _core
from ..design import Design
from ..errors import InputError, SpringformError
from ..network import Equilibrium
from ..parameters import Parameters, checked_parameters
from ..run import start_evolution
from .frames import Tables, tables_of

Status = Literal["running", "paused", "failed"]

DEFAULTS: dict[str, Any] = {
    "population": 100,
    "insertions": "1",
    "toggles": "2",
    "max_springs": 2000,
}
"""Parameters of live evolution that differ from a run's.

The net stays small enough to be quick; once it is full, as much is taken away as is added, so that
evolution goes on.
"""

_SHORTEST = 1 / 40
"""Shortest time between generations [s]: eyes follow no faster."""

_COUNTED = 20
"""Generations over which the rate is taken."""

_REMEMBERED = 400
"""Generations of which windows are told."""


@dataclass(frozen=True)
class Grown:
    """The parent after a generation, ready to be shown."""

    design: Design
    tables: Tables
    equilibrium: Equilibrium


@dataclass(frozen=True)
class Point:
    """What a generation gave."""

    generation: int
    springs: int
    force_differential: float | None


class Live:
    """Evolves a design in a thread of its own, generation by generation; safe to call from any.

    Attributes: `status`, `reason` (why it failed), `parameters`, `points` (of the last
    generations), `start` (the design that it began with).
    """

    def __init__(self, design: Design, parameters: Mapping[str, Any], tell: Callable[[], None]):
        """Begin at once; `tell` is called in the thread after every generation.

        Raises `InputError`: a parameter that is not allowed, or a design that gives no net.
        """
        self.start = design.closed
        self.parameters = self._checked(DEFAULTS | dict(parameters))
        self.status: Status = "running"
        self.reason = ""
        self.points: deque[Point] = deque(maxlen=_REMEMBERED)
        self._tell = tell
        self._changed = threading.Condition()
        self._moved: dict[str, tuple[float, float, float]] = {}
        self._wanted: dict[str, Any] = {}
        self._closed = False
        self._times: deque[float] = deque(maxlen=_COUNTED + 1)
        self._evolution = self._begun(self.start, None)
        self._grown = _grown(self.start)
        self._thread = threading.Thread(target=self._work, name="live evolution", daemon=True)
        self._thread.start()

    @property
    def generation(self) -> int:
        """Generations made."""
        return self.points[-1].generation if self.points else 0

    @property
    def rate(self) -> float:
        """Generations a second over the last ones; 0 while it stands still."""
        times = list(self._times)
        if self.status != "running" or len(times) < 2:
            return 0.0
        return (len(times) - 1) / max(times[-1] - times[0], 1e-9)

    @property
    def grown(self) -> Grown:
        """The parent now."""
        return self._grown

    def move_anchor(self, anchor: str, position: tuple[float, float, float]) -> None:
        """Hold an anchor elsewhere from the next generation on. Raises `InputError`: no such."""
        if anchor not in self.start.anchor_names:
            raise InputError("there is no anchor of this name", key=anchor)
        with self._changed:
            self._moved[anchor] = position
            self._changed.notify()

    def change(self, parameters: Mapping[str, Any]) -> None:
        """Change parameters from the next generation on. Raises `InputError`: not allowed."""
        with self._changed:
            self._checked(self.parameters.model_dump() | self._wanted | dict(parameters))
            self._wanted |= parameters
            self._changed.notify()

    def pause(self) -> None:
        """Stand still after the generation that is being made."""
        with self._changed:
            if self.status == "running":
                self.status = "paused"
                self._times.clear()
        self._tell()

    def go_on(self) -> None:
        """Go on after `pause`."""
        with self._changed:
            if self.status == "paused":
                self.status = "running"
            self._changed.notify()

    def close(self) -> Design:
        """End the thread and return what is shown."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()
        return self._grown.design

    # --- in the thread -------------------------------------------------------------------------

    def _work(self) -> None:
        try:
            while self._advanced():
                self._tell()
        except SpringformError as error:
            self.status, self.reason = "failed", str(error)
            self._tell()

    def _advanced(self) -> bool:
        """Make a generation, or show an anchor that was moved in a pause; False: it is over."""
        with self._changed:
            self._changed.wait_for(self._has_work)
            if self._closed:
                return False
            moved, self._moved = self._moved, {}
            wanted, self._wanted = self._wanted, {}
            running = self.status == "running"
        began = time.monotonic()
        design = self._grown.design
        if wanted:
            self.parameters = self._checked(self.parameters.model_dump() | wanted)
        if moved:
            design = with_anchors(design, moved)
        if moved or wanted:
            self._evolution = self._begun(design, self._evolution)
        if running:
            result = self._evolution.advance()
            design = design.edited(result["edits"])
        self._grown = _grown(design)
        if running:
            self._note(self._evolution)
            self._rest(began + _SHORTEST)
        return True

    def _has_work(self) -> bool:
        waiting = bool(self._moved or self._wanted)
        return self._closed or (self.status != "failed" and (self.status == "running" or waiting))

    def _rest(self, until: float) -> None:
        with self._changed:
            self._changed.wait_for(lambda: self._closed, max(0.0, until - time.monotonic()))

    def _note(self, evolution: _core.Evolution) -> None:
        standing = evolution.measures
        point = Point(evolution.generation, standing["springs"], standing["force_differential"])
        self.points.append(point)
        self._times.append(time.monotonic())

    def _begun(self, design: Design, before: _core.Evolution | None) -> _core.Evolution:
        """Return the algorithm at a design, counting on from where it was."""
        # One thread is left to the windows.
        threads = max(1, (os.cpu_count() or 2) - 1)
        resumed = None if before is None else (before.generation, before.start, None)
        return start_evolution(design, self.parameters, threads=threads, resumed=resumed)

    def _checked(self, values: Mapping[str, Any]) -> Parameters:
        return checked_parameters(values, self.start.file.method)


def with_anchors(design: Design, moved: Mapping[str, tuple[float, float, float]]) -> Design:
    """Return a design with anchors held elsewhere, by name [m]."""
    framework = design.file.framework
    anchors = tuple(
        anchor.model_copy(update={"position": moved.get(name, anchor.position)})
        for name, anchor in zip(design.anchor_names, framework.anchors, strict=True)
    )
    held = framework.model_copy(update={"anchors": anchors})
    file = design.file.model_copy(update={"framework": held})
    return Design(file, forest=design.forest)


def _grown(design: Design) -> Grown:
    return Grown(design, tables_of(design), design.solve())
