"""A run while people watch: started, paused, changed, continued and stopped from windows."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..design import Design, save
from ..errors import InputError, SpringformError
from ..evolution import FIXED, steer
from ..parameters import Parameters, checked_parameters
from ..run import STRATEGY, Run, open_run, start_evolution
from ..run_writer import RunWriter, create, reopen
from ..steering import Driver, Requests, driver_of, watch
from .choosing import AXES
from .run_messages import GenerationRow, LineageStep

Status = Literal["running", "paused", "ended", "failed"]

_CHECKPOINT = 1.0
"""Seconds between checkpoints [s]."""

_KEPT_ALGORITHMS = 4

_POLL = 0.25
"""Seconds between looks at requests, and at a run that another process drives [s]."""

ENDINGS = {
    "generations": "the number of generations is reached",
    "springs": "the number of springs is reached",
    "differential": "the force differential is reached",
    "suf": "the spring utilization factor is reached",
}
"""Why a run ended, by the name of the condition."""


class Evolving:
    """One run, in a thread of its own; safe to call from any thread.

    Attributes: `folder`, `status`, `reason` (why it ended, failed or stands still), `parameters`,
    `rows` (what every generation gave), `driver` (another process that drives it).
    """

    def __init__(self, folder: Path, tell: Callable[[], None]) -> None:
        """Prepare; `start` or `resume` begins. `tell` is called after whatever changes."""
        self.folder = folder
        self.status: Status = "paused"
        self.reason = ""
        self.parameters = Parameters()
        self.rows: list[GenerationRow] = []
        self.driver: Driver | None = None
        self._tell = tell
        self._watching = threading.Event()
        self._changed = threading.Condition()
        self._wanted: dict[str, Any] = {}
        self._parents: list[Design] = []
        self._edits: list[list[str]] = []
        self._columns: list[Mapping[str, NDArray[Any]]] = []
        self._resumed: list[dict[str, Any]] = []
        self._algorithms: dict[int, _core.Evolution] = {}
        self._thread: threading.Thread | None = None
        self._start: tuple[int, float | None] = (0, None)

    @property
    def began(self) -> tuple[int, float | None]:
        """Springs and force differential of the design that the run started from."""
        return self._start

    # --- control -------------------------------------------------------------------------------

    def start(self, design: Design, values: Mapping[str, Any]) -> None:
        """Make the run's folder and go. Raises `InputError`: what is refused."""
        self.parameters = checked_parameters(values, design.file.method)
        evolution = start_evolution(design, self.parameters, threads=_threads())
        self._start = evolution.start
        self._parents = [design.closed]
        self._resumed = [{"parameters": self.parameters, "strategy": None, "suf": None}]
        self._go(lambda: self._created(design), evolution)

    def open(self) -> None:
        """Read a run that is in the folder, to look at and to go on with."""
        self._read(open_run(self.folder))
        self.status, self.reason = self._left()
        self.watch()

    def watch(self) -> None:
        """Follow the run for as long as another process drives it."""
        if self._thread is not None and self._thread.is_alive():
            return
        self.driver = driver_of(self.folder)
        if self.driver is not None:
            self._driven(self.driver)
            self._watching.clear()
            self._thread = threading.Thread(target=self._follow, name="watching", daemon=True)
            self._thread.start()

    def go_on(self) -> None:
        """Continue a run that is paused. Raises `InputError`: another process began to drive it."""
        if self.driver is not None:
            steer(self.folder, "continue")
            return
        with self._changed:
            if self._thread is not None and self._thread.is_alive():
                self.status, self.reason = "running", ""
                self._changed.notify()
                return
        evolution = self._algorithm(len(self.rows), threads=_threads())
        self._go(self._reopened, evolution)

    def pause(self) -> None:
        """Stop after the generation that is being made; its thread keeps the folder's lock."""
        if self.driver is not None:
            steer(self.folder, "pause")
            return
        with self._changed:
            if self.status == "running":
                self.status = "paused"
        self._tell()

    def change(self, values: Mapping[str, Any]) -> None:
        """Change parameters from the next generation on. Raises `InputError`: what is refused."""
        if self.driver is not None:
            steer(self.folder, "change", **values)
            return
        if fixed := FIXED & set(values):
            raise InputError("stays as it was at the start of the run", key=min(fixed))
        with self._changed:
            merged = self.parameters.model_dump() | self._wanted | dict(values)
            checked_parameters(merged, self._parents[0].file.method)
            if self._thread is None or not self._thread.is_alive():
                raise InputError("continue the run first; then its parameters can be changed")
            self._wanted |= values
            self._changed.notify()
        self._tell()

    def stop(self) -> None:
        """End the thread after the generation that is being made; what was made is kept.

        What another process drives is left to it; `end_driver` asks it to end.
        """
        self._watching.set()
        if self.driver is not None and self._thread is not None:
            self._thread.join()
            return
        with self._changed:
            if self.status in ("running", "paused"):
                self.status, self.reason = "ended", "it was stopped"
            self._changed.notify()
        if self._thread is not None:
            self._thread.join()

    def end_driver(self) -> bool:
        """Ask another process that drives the run to end it; False: there is none."""
        if self.driver is None:
            return False
        steer(self.folder, "stop")
        return True

    # --- what was made -------------------------------------------------------------------------

    def parent(self, generation: int) -> Design:
        """Return the parent chosen in a generation; 0 is the start."""
        with self._changed:
            if not 0 <= generation < len(self._parents):
                raise InputError(f"there are generations 0 to {len(self._parents) - 1}")
            return self._parents[generation]

    def standing(self, generation: int) -> tuple[int, int | None]:
        """Return generation and number of the individual that was the parent after a generation.

        (0, None): it was the start still.
        """
        with self._changed:
            for row in reversed(self.rows[:generation]):
                if row.winner is not None:
                    return row.generation, row.winner
        return 0, None

    def suf(self, generation: int, individual: int) -> float | None:
        """Return the spring utilization factor of an individual; None if it is undefined."""
        with self._changed:
            value = float(self._columns[generation - 1]["suf"][individual])
        return value if np.isfinite(value) else None

    def individual(self, generation: int, individual: int) -> Design:
        """Rebuild an individual. Raises `InputError`: there is no such."""
        if not 1 <= generation <= len(self.rows):
            raise InputError(f"there are generations 1 to {len(self.rows)}")
        if not 0 <= individual < self.parameters.population:
            raise InputError(f"there are individuals 0 to {self.parameters.population - 1}")
        edits = self._kept_algorithm(generation - 1).individual(individual)
        return self.parent(generation - 1).edited(edits)

    def lineage(self, generation: int, individual: int | None) -> list[LineageStep]:
        """Return the ancestors of a parent or an individual, and what each mutation changed.

        The last comes last; generations in which the parent stayed are left out.
        """
        last = generation if individual is None else generation - 1
        winners = [(number, self.rows[number - 1].winner) for number in range(1, last + 1)]
        if individual is not None:
            winners.append((generation, individual))
        return [self._step(number, one) for number, one in winners if one is not None]

    def _step(self, generation: int, individual: int) -> LineageStep:
        columns = self._columns[generation - 1]
        differential = float(columns["force_differential"][individual])
        if self.rows[generation - 1].winner == individual:
            edits = self._edits[generation - 1]
        else:
            edits = self._kept_algorithm(generation - 1).individual(individual)
        return LineageStep(
            generation=generation,
            individual=individual,
            springs=int(columns["springs"][individual]),
            force_differential=differential if np.isfinite(differential) else None,
            edits=list(edits),
        )

    def columns(self, first: int) -> dict[str, NDArray[np.float32]]:
        """Return the axes of all individuals from a generation on."""
        with self._changed:
            chosen = self._columns[max(0, first - 1) :]
        return {
            name: np.concatenate(
                [np.asarray(columns[name], dtype=np.float32) for columns in chosen]
                or [np.empty(0, dtype=np.float32)]
            )
            for name in AXES
        }

    # --- in the thread -------------------------------------------------------------------------

    def _go(self, opened: Callable[[], Any], evolution: _core.Evolution) -> None:
        begun: list[BaseException | None] = []
        ready = threading.Event()

        def work() -> None:
            try:
                with opened() as writer:
                    self.status, self.reason = "running", ""
                    begun.append(None)
                    ready.set()
                    self._advance(evolution, writer)
            except SpringformError as error:
                if begun:
                    self.status, self.reason = "failed", str(error)
                else:
                    begun.append(error)
                ready.set()
            self._tell()

        self._thread = threading.Thread(target=work, name="evolution", daemon=True)
        self._thread.start()
        ready.wait()
        if begun and begun[0] is not None:
            raise begun[0]

    @contextmanager
    def _created(self, design: Design) -> Iterator[RunWriter]:
        with create(self.folder, design, self.parameters, self._start, "studio") as writer:
            yield writer

    @contextmanager
    def _reopened(self) -> Iterator[RunWriter]:
        with reopen(self.folder, "studio") as (run, writer):
            if run.generations != len(self.rows) or run.parameters != self.parameters:
                raise InputError("another process went on with the run; load the page again")
            yield writer

    def _advance(self, evolution: _core.Evolution, writer: RunWriter) -> None:
        written = time.monotonic()
        requests = Requests(self.folder)
        while (reason := evolution.reached(*self.parameters.ending())) is None or self._wanted:
            self._obey(requests, writer)
            with self._changed:
                if self.status == "paused":
                    writer.stand()
                    self._changed.wait_for(
                        lambda: self.status != "paused" or bool(self._wanted), _POLL
                    )
                wanted, self._wanted = self._wanted, {}
                ended = self.status == "ended"
            if ended:
                writer.checkpoint()
                break
            if wanted:
                evolution = self._with_changes(wanted, writer)
                continue
            if self.status != "running":
                continue
            writer.go_on()
            self._keep(evolution, writer)
            if time.monotonic() - written > _CHECKPOINT:
                writer.checkpoint()
                written = time.monotonic()
            self._tell()
        else:
            writer.checkpoint()
            self.status, self.reason = "ended", ENDINGS[reason]
        save(self.parent(len(self.rows)), self.folder / "best.toml")

    def _obey(self, requests: Requests, writer: RunWriter) -> None:
        """Do what other processes asked."""
        for request in requests.new():
            writer.log(f"was asked to {request.what}")
            if request.what == "pause":
                self.pause()
            elif request.what == "change":
                values = self.parameters.model_dump() | request.parameters
                try:
                    checked_parameters(values, self._parents[0].file.method)
                except InputError as error:
                    writer.log(f"refused a change: {error}")
                    continue
                with self._changed:
                    self._wanted |= request.parameters
            else:
                with self._changed:
                    if self.status == "paused" and request.what == "continue":
                        self.status, self.reason = "running", ""
                    elif request.what == "stop":
                        self.status, self.reason = "ended", "it was stopped"
                self._tell()

    def _follow(self) -> None:
        """Read what another process writes, until it is gone or nobody looks any more."""
        size, journal = -1, self.folder / "journal.jsonl"
        while not self._watching.is_set():
            watch(self.folder)
            driver = driver_of(self.folder)
            try:
                now = journal.stat().st_size if journal.exists() else 0
                grown = now != size
                if grown or driver is None:
                    self._read(open_run(self.folder))
                    size = now
            except SpringformError as error:
                self.status, self.reason, self.driver = "failed", str(error), None
                break
            before = self.driver, self.status
            if driver is not None:
                self._driven(driver)
            else:
                self.status, self.reason = self._left()
            # Last, since whoever finds no driver goes by the status.
            self.driver = driver
            if grown or (self.driver, self.status) != before:
                self._tell()
            if driver is None:
                break
            self._watching.wait(_POLL)

    def _driven(self, driver: Driver) -> None:
        self.status, self.reason = "paused" if driver.standing else "running", ""

    def _left(self) -> tuple[Status, str]:
        """Return how a run stands that its driver has left."""
        evolution = self._algorithm(len(self.rows), threads=1)
        reason = evolution.reached(*self.parameters.ending())
        return ("paused", "nobody drives it") if reason is None else ("ended", ENDINGS[reason])

    def _keep(self, evolution: _core.Evolution, writer: RunWriter) -> None:
        result = evolution.advance()
        standing = evolution.measures
        writer.add(evolution.generation, result, standing)
        with self._changed:
            self._parents.append(self._parents[-1].edited(result["edits"]))
            self._columns.append(result["columns"])
            self._edits.append(list(result["edits"]))
            self._resumed.append(
                {
                    "parameters": self.parameters,
                    "strategy": result["strategy"],
                    "suf": result["suf"],
                }
            )
            self.rows.append(
                generation_row(
                    evolution.generation,
                    standing["springs"],
                    standing["force_differential"],
                    result["suf"],
                    result["winner"],
                    result["columns"]["force_differential"],
                )
            )

    def _with_changes(self, wanted: dict[str, Any], writer: RunWriter) -> _core.Evolution:
        """Journal changed parameters, and return the algorithm that goes on with them."""
        generation = len(self.rows)
        values = self.parameters.model_dump() | wanted
        writer.checkpoint()
        writer.change(generation, wanted)
        with self._changed:
            self.parameters = checked_parameters(values, self._parents[0].file.method)
            self._resumed[generation]["parameters"] = self.parameters
            if set(wanted) & STRATEGY:
                self._resumed[generation]["strategy"] = None
            if self.rows:
                self.rows[-1] = self.rows[-1].model_copy(update={"changed": True})
            self._algorithms.pop(generation, None)
        self._tell()
        return self._algorithm(generation, threads=_threads())

    def _algorithm(self, generation: int, *, threads: int) -> _core.Evolution:
        """Return the algorithm as it stood after a generation."""
        at = self._resumed[generation]
        return start_evolution(
            self.parent(generation),
            at["parameters"],
            threads=threads,
            strategy=at["strategy"],
            resumed=(generation, self._start, at["suf"]),
        )

    def _kept_algorithm(self, generation: int) -> _core.Evolution:
        """Return the same, kept for more individuals of the next generation; it never advances."""
        if generation not in self._algorithms:
            self._algorithms[generation] = self._algorithm(generation, threads=1)
            while len(self._algorithms) > _KEPT_ALGORITHMS:
                self._algorithms.pop(next(iter(self._algorithms)), None)
        return self._algorithms[generation]

    def _read(self, run: Run) -> None:
        """Take over what a run's folder holds."""
        start, population = run.start, run.parameters.population
        known = len(self.rows)
        if not self._parents:
            self._start = start["springs"], start["force_differential"]
            self._parents = [run.design.closed]
            self._resumed = [{"strategy": None, "suf": None}]
        # Parameters may have been changed after the last generation that was read.
        self.parameters = run.parameters
        self._resumed[known]["parameters"] = run.parameters_after(known)
        if run.changed_after(known) & STRATEGY:
            self._resumed[known]["strategy"] = None
        if known:
            update = {"changed": bool(run.changed_after(known))}
            self.rows[-1] = self.rows[-1].model_copy(update=update)
        self._algorithms.pop(known, None)
        for number, line in enumerate(run.generation_lines[known:], start=known + 1):
            rows = slice((number - 1) * population, number * population)
            columns = {name: column[rows] for name, column in run.table.items()}
            self._parents.append(self._parents[-1].edited(line.edits))
            self._columns.append(columns)
            self._edits.append(list(line.edits))
            changed = run.changed_after(number)
            self._resumed.append(
                {
                    "parameters": run.parameters_after(number),
                    "strategy": None if changed & STRATEGY else line.strategy,
                    "suf": line.suf,
                }
            )
            row = generation_row(
                number,
                line.springs,
                line.force_differential,
                line.suf,
                line.parent,
                columns["force_differential"],
            )
            self.rows.append(row.model_copy(update={"changed": bool(changed)}))


def generation_row(
    generation: int,
    springs: int,
    differential: float | None,
    suf: float | None,
    winner: int | None,
    population: NDArray[Any],
) -> GenerationRow:
    """Return what windows are told of a generation; `population` are its force differentials."""
    known = np.asarray(population, dtype=np.float64)
    known = known[np.isfinite(known)]
    low, median, high = np.percentile(known, [25, 50, 75]) if len(known) else [None] * 3
    return GenerationRow(
        generation=generation,
        springs=springs,
        force_differential=differential,
        suf=suf,
        winner=winner,
        low=low,
        median=median,
        high=high,
        least=float(known.min()) if len(known) else None,
        changed=False,
    )


def _threads() -> int:
    # One thread is left to the net and to the windows.
    return max(1, (os.cpu_count() or 2) - 1)
