"""The run of one document, as windows ask of it and are told of it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from ..design import Design
from ..errors import InputError
from ..run import Run
from .changes import Place
from .choosing import brushed, clusters
from .evolving import Evolving
from .frame_messages import TableHeader
from .frames import encode
from .run_messages import (
    Brushes,
    Cluster,
    Clusters,
    Lineage,
    RunLine,
    RunState,
    SteerRun,
)
from .window import Window

_PERIOD = 0.1
"""Seconds between messages about the run [s]."""

InThread = Callable[[Callable[[], Any]], Awaitable[Any]]
"""Does work in the document's thread."""


class RunStage:
    """The run of a document, if it has one. Methods run in the event loop.

    Attributes: `run` (None: there is no run), `following` (the newest parent is shown).
    """

    def __init__(
        self, folder: Path, former: str | None, changed: Callable[[], Awaitable[None]]
    ) -> None:
        """`folder` holds the document's runs, `former` is one elsewhere to begin with.

        `changed` is called when there is something to tell, a few times a second and not more.
        """
        self.following = False
        self._folder = folder
        self._former = None if former is None else Path(former)
        self._changed = changed
        self._loop = asyncio.get_running_loop()
        self._told = 0.0
        self._waits = False
        self.run: Evolving | None = None
        self._known = self._lines()
        self.run = self._newest()

    @property
    def generations(self) -> int:
        """Generations that the run made; 0: there is none."""
        return 0 if self.run is None else len(self.run.rows)

    @property
    def name(self) -> str:
        """The run's folder as pins and the history name it; empty: there is none."""
        return "" if self.run is None else self._name_of(self.run.folder)

    def _name_of(self, folder: Path) -> str:
        own = folder.parent == self._folder
        return f"{self._folder.name}/{folder.name}" if own else str(folder)

    def suf(self, place: Place) -> float | None:
        """Return the spring utilization factor of an individual; None for one of another run."""
        if self.run is None or place.run != self.name or place.individual is None:
            return None
        return self.run.suf(place.generation, place.individual)

    def known(self) -> Evolving:
        """Return the run. Raises `InputError`: there is none."""
        if self.run is None:
            raise InputError("there is no run; start one")
        return self.run

    @property
    def _folders(self) -> dict[int, Path]:
        """The document's runs, the newest first; 0 is one elsewhere that it began with."""
        own = {int(folder.name): folder for folder in self._folder.glob("[0-9]*")}
        folders = own if self._former is None else own | {0: self._former}
        # A studio that was killed may have left a folder that is no run yet.
        return {number: folders[number] for number in sorted(folders, reverse=True)}

    def _lines(self) -> dict[int, RunLine]:
        """Return all runs in short, as their folders hold them."""
        lines = {}
        for number, folder in self._folders.items():
            with suppress(InputError):
                run = Run(folder)
                lines[number] = RunLine(
                    number=number,
                    name=self._name_of(folder),
                    generations=run.generations,
                    springs=run.final["springs"],
                    force_differential=run.final["force_differential"],
                    fitness=run.parameters.fitness,
                )
        return lines

    def _runs(self) -> list[RunLine]:
        """Return all runs in short, the one that is shown as it stands now."""
        rows = [] if self.run is None else self.run.rows
        now: dict[str, Any] = {}
        if rows:
            now = {name: getattr(rows[-1], name) for name in ("springs", "force_differential")}
            now["generations"] = len(rows)
        return [
            line.model_copy(update=now) if line.name == self.name else line
            for line in self._known.values()
        ]

    def _newest(self) -> Evolving | None:
        """Return the run that the document had last, to look at and to go on with."""
        for number in self._folders:
            with suppress(InputError):
                return self._opened(number)
        return None

    def _opened(self, number: int) -> Evolving:
        run = Evolving(self._folders[number], self._run_changed)
        run.open()
        return run

    async def open(self, number: int, in_thread: InThread) -> None:
        """Show another run; the one before ends, and can be gone on with when it is shown again.

        Raises `InputError`: there is no such run, or it is damaged.
        """
        if number not in self._folders:
            raise InputError("there is no such run", key="number")
        if self.run is not None and self.run.folder == self._folders[number]:
            return
        run = await in_thread(lambda: self._opened(number))
        await self._show(run)
        self.following = False

    async def _show(self, run: Evolving) -> None:
        if self.run is not None:
            await asyncio.to_thread(self.run.stop)
        self.run = run
        self._known = await asyncio.to_thread(self._lines)

    async def start(self, design: Design, values: dict[str, Any], in_thread: InThread) -> None:
        """Start a run and follow it. Raises `InputError`: the values do not fit."""
        folder = self._folder / f"{len(list(self._folder.glob('*'))) + 1:04}"
        run = Evolving(folder, self._run_changed)
        await in_thread(lambda: run.start(design, values))
        await self._show(run)
        self.following = True

    async def steer(self, request: SteerRun, in_thread: InThread) -> None:
        """Do what a window asks of the run. Raises `InputError`: it does not fit."""
        run = self.known()
        if request.what == "change":
            await in_thread(lambda: run.change(request.parameters))
        elif request.what == "continue":
            await in_thread(run.go_on)
        elif request.what == "pause":
            await in_thread(run.pause)
        elif not await in_thread(run.end_driver):
            await asyncio.to_thread(run.stop)

    def table(self, first: int) -> bytes:
        """Return the frame with all individuals of the run from a generation on."""
        run = self.known()
        header = TableHeader(first=first, population=run.parameters.population, arrays=[])
        return encode(header, run.columns(first))

    def lineage(self, generation: int, individual: int | None) -> Lineage:
        """Return where a parent or an individual of the run came from."""
        run = self.known()
        if not 1 <= generation <= len(run.rows):
            raise InputError(f"there are generations 1 to {len(run.rows)}")
        if individual is not None and not 0 <= individual < run.parameters.population:
            raise InputError(f"there are individuals 0 to {run.parameters.population - 1}")
        return Lineage(steps=run.lineage(generation, individual))

    def clusters(self, asked: Brushes) -> Clusters:
        """Return clusters of the individuals that are brushed."""
        run = self.known()
        columns: dict[str, Any] = dict(run.columns(1))
        population = run.parameters.population
        columns["generation"] = np.arange(len(columns["springs"])) // population + 1
        rows = np.flatnonzero(brushed(columns, asked.brushes))
        found = clusters(columns, rows, asked.count)
        return Clusters(
            brushed=len(rows),
            clusters=[
                Cluster(generation=row // population + 1, individual=row % population, size=size)
                for row, size in found
            ],
        )

    def tell(self, window: Window) -> None:
        """Tell a window what it does not know of the run."""
        run = self.run
        first = window.generations + 1
        rows = [] if run is None else run.rows[first - 1 :]
        if run is not None and run.rows:
            # The last row told may have been marked as changed since.
            first = max(1, first - 1)
            rows = run.rows[first - 1 :]
        window.generations = 0 if run is None else len(run.rows)
        window.tell(
            RunState(
                status="none" if run is None else run.status,
                reason="" if run is None else run.reason,
                folder="" if run is None else str(run.folder),
                name=self.name,
                driver="" if run is None or run.driver is None else str(run.driver),
                following=self.following,
                parameters={} if run is None else run.parameters.model_dump(mode="json"),
                start_springs=0 if run is None else run.began[0],
                start_differential=None if run is None else run.began[1],
                runs=self._runs(),
                generations=window.generations,
                first=first,
                rows=rows,
            )
        )

    def _run_changed(self) -> None:
        """Called in the run's thread: windows are told a few times a second, not more."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._soon)

    def _soon(self) -> None:
        if self._waits:
            return
        self._waits = True
        wait = max(0.0, self._told + _PERIOD - self._loop.time())
        self._loop.call_later(wait, lambda: self._loop.create_task(self._now()))

    async def _now(self) -> None:
        self._waits, self._told = False, self._loop.time()
        await self._changed()
