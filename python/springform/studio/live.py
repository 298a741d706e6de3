"""Live evolution: the net evolves while anchors are dragged and cells are brushed."""

from __future__ import annotations

import os
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Literal

from .. import _core
from ..design import Design
from ..errors import InputError, SpringformError
from ..files import WriteError
from ..network import Equilibrium
from ..parameters import Parameters, checked_parameters
from ..run import STRATEGY, start_evolution
from ..run_format import GenerationLine, generation_line
from .evolving import ENDINGS
from .frames import Tables, tables_of
from .live_file import Point, Standing, design_data, point_of

Status = Literal["running", "paused", "failed"]

DEFAULTS: dict[str, Any] = {
    "population": 100,
    "insertions": "1",
    "toggles": "2",
    "selection": "plus",
    "max_springs": 2000,
}
"""Parameters of live evolution that differ from a run's.

Only a better net replaces the parent: nobody ends a live evolution at its best generation, so it
must not drift away from it. With comma selection it does once the net is full and no springs that
come make up for what mutations undo: three-cylinders came to a force differential of 34 in 540
generations, and to 10.5 so. The net stays small enough to be quick.
"""

_SHORTEST = 1 / 40
"""Shortest time between generations [s]: eyes follow no faster."""

_COUNTED = 20
"""Generations over which the rate is taken."""

_REMEMBERED = 400
"""Generations of which windows are told."""

_CHECKPOINT = 1.0
"""Longest time that generations are kept as lines, before the net is kept as a whole [s]."""

_GOALS = frozenset({"until_springs", "until_differential", "until_suf"})


@dataclass(frozen=True)
class Grown:
    """The parent after a generation, ready to be shown."""

    design: Design
    tables: Tables
    equilibrium: Equilibrium


class Live:
    """Evolves a design in a thread of its own, generation by generation; safe to call from any.

    Attributes: `status`, `reason` (why it failed or stands still), `parameters`, `points` (of the
    last generations).
    """

    def __init__(
        self,
        design: Design,
        parameters: Mapping[str, Any],
        tell: Callable[[], None],
        keep: Callable[[Standing], None],
        add: Callable[[GenerationLine], None],
        standing: Standing | None = None,
    ):
        """Begin at once, or take up where it stood and wait for `go_on`.

        In the thread `tell` is called after every generation. Before, the generation is put on the
        disk: by `add` as what changed, or by `keep` with all that there is.
        Raises `InputError`: a parameter that is not allowed, or a design that gives no net.
        """
        design = design.closed
        self._method = design.file.method
        self.parameters = self._checked(DEFAULTS | dict(parameters))
        self.status: Status = "running" if standing is None else "paused"
        self.reason = "" if standing is None else "taken up as it stood when the studio ended"
        self.points: deque[Point] = deque(standing.points if standing else (), maxlen=_REMEMBERED)
        self._tell = tell
        self._keep = keep
        self._add = add
        self._changed = threading.Condition()
        self._moved: dict[str, tuple[float, float, float]] = {}
        self._wanted: dict[str, Any] = {}
        self._closed = False
        self._times: deque[float] = deque(maxlen=_COUNTED + 1)
        self._strategy = None if standing is None else standing.strategy
        self._suf = None if standing is None else standing.suf
        self._evolution = self._begun(
            design, None if standing is None else (standing.generation, standing.start)
        )
        self._reached = standing is not None and self._goal() is not None
        self._grown = _grown(design)
        self._kept_at = float("-inf")
        self._unkept = standing is None
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
    def wanted(self) -> Parameters:
        """The parameters from the next generation on."""
        with self._changed:
            values = self.parameters.model_dump() | self._wanted
        return self._checked(values)

    @property
    def grown(self) -> Grown:
        """The parent now."""
        return self._grown

    def move_anchor(self, anchor: str, position: tuple[float, float, float]) -> None:
        """Hold an anchor elsewhere from the next generation on. Raises `InputError`: no such."""
        if anchor not in self._grown.design.anchor_names:
            raise InputError("there is no anchor of this name", key=anchor)
        with self._changed:
            self._moved[anchor] = position
            self._changed.notify()

    def change(self, parameters: Mapping[str, Any]) -> None:
        """Change parameters from the next generation on. Raises `InputError`: not allowed."""
        values = self.wanted.model_dump() | dict(parameters)
        # The algorithm itself says what it would refuse.
        start_evolution(self._grown.design, self._checked(values), threads=1)
        with self._changed:
            self._wanted |= parameters
            self._changed.notify()

    def pause(self) -> None:
        """Stand still after the generation that is being made."""
        with self._changed:
            if self.status == "running":
                self.status = "paused"
                self._times.clear()
                self._changed.notify()
        self._tell()

    def go_on(self) -> None:
        """Go on after `pause`."""
        with self._changed:
            if self.status == "paused":
                self.status, self.reason = "running", ""
            self._changed.notify()

    def close(self) -> Design:
        """End the thread, keep where it stands, and return what is shown."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()
        with suppress(WriteError):  # where it stood before is there
            self._checkpoint()
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
            if wanted:
                self.parameters = self._checked(self.parameters.model_dump() | wanted)
            running = self.status == "running"
        began = time.monotonic()
        if not (running or moved or wanted):
            self._checkpoint()
            return True
        design, line = self._grown.design, None
        changed = bool(moved or wanted)
        if changed:
            design = self._begin_anew(design, moved, wanted)
        if running:
            result = self._evolution.advance()
            design = design.edited(result["edits"])
            line = generation_line(self._evolution.generation, result, self._evolution.measures)
            self._strategy, self._suf = line.strategy, line.suf
        whole = changed or began > self._kept_at + _CHECKPOINT
        if line is not None and not whole:
            self._add(line)  # first, so that nobody sees what a kill would take away
        self._grown, self._unkept = _grown(design), True
        if line is not None:
            self.points.append(point_of(line))
            self._times.append(time.monotonic())
            self._pause_at_goal()
        if whole:
            self._checkpoint()
        if running:
            self._rest(began + _SHORTEST)
        return True

    def _begin_anew(
        self, design: Design, moved: Mapping[str, Any], wanted: Mapping[str, Any]
    ) -> Design:
        """Go on with other anchors and parameters; return the parent as it is held then."""
        if _GOALS & set(wanted):
            self._reached = False
        if moved:
            design = with_anchors(design, moved)
        # What was measured otherwise, or adapted from what is not wanted now, is not the parent's.
        if moved or "suf_reference" in wanted:
            self._suf = None
        if (STRATEGY | {"self_adapt"}) & set(wanted):
            self._strategy = None
        before = self._evolution
        self._evolution = self._begun(design, (before.generation, before.start))
        return design

    def _has_work(self) -> bool:
        if self._closed or self.status == "failed":
            return self._closed
        return bool(self.status == "running" or self._moved or self._wanted or self._unkept)

    def _pause_at_goal(self) -> None:
        """Stand still at the generation that reaches a goal; whoever goes on goes beyond it."""
        goal, reached = self._goal(), self._reached
        self._reached = goal is not None
        with self._changed:
            if goal is not None and not reached and self.status == "running":
                self.status, self.reason = "paused", ENDINGS[goal]
                self._times.clear()

    def _goal(self) -> str | None:
        _, springs, differential, suf = self.parameters.ending()
        return self._evolution.reached(None, springs, differential, suf)

    def _checkpoint(self) -> None:
        """Put the evolution on the disk, if it is not there. Raises `WriteError`."""
        if not self._unkept:
            return
        evolution = self._evolution
        standing = Standing(
            generation=evolution.generation,
            start=evolution.start,
            points=list(self.points),
            design=design_data(self._grown.design),
            strategy=self._strategy,
            suf=self._suf,
        )
        self._keep(standing)
        self._unkept, self._kept_at = False, time.monotonic()

    def _rest(self, until: float) -> None:
        with self._changed:
            self._changed.wait_for(lambda: self._closed, max(0.0, until - time.monotonic()))

    def _begun(
        self, design: Design, stood: tuple[int, tuple[int, float | None]] | None
    ) -> _core.Evolution:
        """Return the algorithm at a design, counting on from a generation and a start."""
        return start_evolution(
            design,
            self.parameters,
            # One thread is left to the windows.
            threads=max(1, (os.cpu_count() or 2) - 1),
            strategy=self._strategy,
            resumed=None if stood is None else (*stood, self._suf),
        )

    def _checked(self, values: Mapping[str, Any]) -> Parameters:
        return checked_parameters(values, self._method)


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
