"""Evolving and stress-seeking: the loops round the native core."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

from . import _core
from .design import Design, save
from .errors import InputError
from .grafting import check_fits
from .parameters import Parameters, checked_parameters
from .patch_file import Patch, load_patch
from .run import Run, Table, open_run, start_evolution
from .run_writer import RunWriter, create, reopen
from .selections import select
from .steering import Asked, Driver, Requests, ask_driver, is_watched

_FIRST_CHECKPOINT = 1.0
"""Seconds between checkpoints at first."""

_CHECKPOINT_SHARE = 0.02
"""Share of the time so far between checkpoints later, so that long runs keep few files."""


_POLL = 0.05
"""Seconds between looks for requests while a run stands still [s]."""

FIXED = frozenset({"population", "seed", "genes"})
"""Parameters that a run keeps from its start to its end."""


@dataclass(frozen=True)
class Progress:
    """What one generation gave, as told to `on_generation`."""

    generation: int
    """Number of the generation, from 1."""
    springs: int
    """Springs of the parent now."""
    force_differential: float | None
    """Force differential of the parent now."""
    suf: float | None
    """Spring utilization factor of the parent now."""
    columns: Table
    """Measures of the generation's individuals by name, as in `Run.table`."""


OnGeneration = Callable[[Progress], None]


def evolve(
    design: Design,
    *,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    on_generation: OnGeneration | None = None,
    **parameters: Any,
) -> Run:
    """Evolve a design and return the run; parameters are those of `Parameters`, by name.

    `genes` may be patches or their files; `within` and the keys of `cell_weights` selections as
    text. Types that genes define and
    the design lacks are added to it.
    `out` is the run folder; without it the run lives in a temporary folder as long as the result.
    `threads` is the number of threads, by default one a core; it does not change the result.
    A keyboard interrupt leaves a folder that `resume` picks up.
    Raises `InputError`: a parameter that is not allowed, a design that gives no net, or a folder
    that already holds a run or can't be written.
    """
    design, parameters = _prepared(design, parameters)
    checked = checked_parameters(parameters, design.file.method)
    evolution = start_evolution(design, checked, threads=_threads(threads))
    keeper = tempfile.TemporaryDirectory(prefix="springform-") if out is None else None
    folder = out if keeper is None else os.path.join(keeper.name, "run")
    assert folder is not None
    with create(folder, design, checked, evolution.start) as writer:
        writer.log(f"started with {checked.model_dump_json()}")
        _Drive(Path(folder), evolution, checked, writer, _threads(threads)).go(on_generation)
    run = _finished(folder)
    if keeper is not None:
        run._keeper = keeper  # type: ignore[attr-defined]  # the folder goes when the run does
    return run


def resume(
    folder: str | os.PathLike[str] | Run,
    *,
    generations: int | None = None,
    threads: int | None = None,
    on_generation: OnGeneration | None = None,
) -> Run:
    """Go on with a run where it stopped, to the same bits as if it had not; return the run.

    `generations` is a new number of generations to end at. A run that is at its end stays as it is.
    Raises `RunError`: no run, a broken one, or one that another process drives.
    """
    path = folder.folder if isinstance(folder, Run) else Path(folder)
    threads = _threads(threads)
    with reopen(path) as (run, writer):
        parameters = run.parameters
        if generations is not None:
            changed = parameters.model_dump() | {"generations": generations}
            parameters = checked_parameters(changed, run.design.file.method)
        if parameters != run.parameters:
            writer.change(run.generations, {"generations": generations})
        # It is written anew at the end; until then it would be of an earlier generation.
        (path / "best.toml").unlink(missing_ok=True)
        writer.log(f"resumed after generation {run.generations}")
        evolution = run.evolution(run.generations, threads=threads)
        _Drive(path, evolution, parameters, writer, threads).go(on_generation)
    return _finished(path)


def steer(folder: str | os.PathLike[str], what: Asked, **parameters: Any) -> Driver:
    """Ask whoever drives a run to pause, continue, stop or change parameters; return who that is.

    The driver, a command line or a studio, obeys between two generations; a change is a line of
    the run's journal. Raises `RunError`: nobody drives it. `InputError`: a parameter that is not
    allowed.
    """
    path = Path(folder)
    run = open_run(path)
    if what != "change" and parameters:
        raise InputError("only a change has parameters", key=min(parameters))
    if what == "change":
        if not parameters:
            raise InputError("name parameters to change, such as insertions=5%")
        if fixed := FIXED & set(parameters):
            raise InputError("stays as it was at the start of the run", key=min(fixed))
        _, parameters = _prepared(run.design, parameters)
        checked_parameters(run.parameters.model_dump() | parameters, run.design.file.method)
    return ask_driver(path, what, parameters)


@dataclass(frozen=True)
class SeekStep:
    """One step of direct stress-seeking."""

    step: int
    """Steps made, from 1."""
    design: Design
    """The design after the step."""
    edits: list[str]
    """What the step did."""
    springs: int
    """Number of springs."""
    force_differential: float | None
    """Largest over smallest force."""
    suf: float | None
    """Spring utilization factor against the start."""


def seek(
    design: Design,
    *,
    steps: int,
    type: int | str = 1,
    until_differential: float | None = None,
    until_suf: float | None = None,
    symmetry: bool = False,
) -> Iterator[SeekStep]:
    """Subdivide the cell of highest inner force, solve, repeat (the paper, section 3.5).

    Yields every step; ends after `steps`, at a condition, or when no cell can be divided. With
    `symmetry` a step subdivides the whole orbit of that cell under the framework's symmetries.
    Raises `InputError`: a type that the method does not allow, a design that gives no net, or one
    that does not have the symmetries.
    """
    checked_parameters({"until_differential": until_differential, "until_suf": until_suf})
    design.network()
    now = design.closed
    kind = _refused(lambda: design.setting.cell_type(str(type)), key="type")
    group = _refused(lambda: _core.Symmetries(design.setting)) if symmetry else None
    seeking = _refused(
        lambda: _core.StressSeeking(design.setting, now.forest, kind, symmetries=group)
    )
    for step in range(1, steps + 1):
        edits = _refused(seeking.advance)
        if not edits:
            return
        now = now.edited(edits)
        measures = seeking.measures
        yield SeekStep(
            step, now, edits, measures["springs"], measures["force_differential"], seeking.suf
        )
        if seeking.reached(step, None, until_differential, until_suf):
            return


def _prepared(design: Design, parameters: dict[str, Any]) -> tuple[Design, dict[str, Any]]:
    """Read genes and selections, and give the design the types of the genes."""
    parameters = dict(parameters)
    if parameters.get("genes"):
        genes = parameters["genes"]
        listed = [genes] if isinstance(genes, (str, os.PathLike, Patch)) else list(genes)
        parameters["genes"] = [
            gene if isinstance(gene, Patch) else load_patch(gene) for gene in listed
        ]
        for gene in parameters["genes"]:
            check_fits(design, gene)
            design = design.with_cell_types(gene.cell_types)
    if isinstance(parameters.get("within"), (str, _core.Selection)):
        parameters["within"] = select(design, parameters["within"]).addresses
    if parameters.get("cell_weights"):
        parameters["cell_weights"] = {
            address: factor
            for cells, factor in parameters["cell_weights"].items()
            for address in select(design, cells).addresses
        }
    return design, parameters


def _refused(make: Callable[[], Any], key: str | None = None) -> Any:
    try:
        return make()
    except _core.CoreError as error:
        core_key, problem = error.args
        raise InputError(problem, key=key or core_key) from None


def _finished(folder: str | os.PathLike[str]) -> Run:
    run = open_run(folder)
    save(run.best, run.folder / "best.toml")
    return run


def _threads(threads: int | None) -> int:
    if threads is None:
        return os.cpu_count() or 1
    if not 1 <= threads <= 1024:
        raise InputError(f"must be 1 to 1024, not {threads}", key="threads")
    return threads


class _Drive:
    """A run that this process drives to its end, obeying what others ask between generations."""

    def __init__(
        self,
        folder: Path,
        evolution: _core.Evolution,
        parameters: Parameters,
        writer: RunWriter,
        threads: int,
    ) -> None:
        self._folder = folder
        self._evolution = evolution
        self._parameters = parameters
        self._writer = writer
        self._threads = threads
        self._requests = Requests(folder)
        self._stands = self._stopped = False

    def go(self, on_generation: OnGeneration | None) -> None:
        """Make generations until the run ends. Raises `KeyboardInterrupt`: it was interrupted."""
        began = written = time.monotonic()
        with _interrupts_noted() as interrupted:
            while (reason := self._reason()) is None:
                if not self._stands:
                    self._make_one(on_generation)
                now = time.monotonic()
                if not self._stands and self._is_due(now - written, now - began):
                    self._writer.checkpoint()
                    written = now
                self._obey()
                if interrupted:
                    self._writer.checkpoint()
                    generation = self._evolution.generation
                    self._writer.log(f"interrupted after generation {generation}")
                    raise KeyboardInterrupt
            self._writer.checkpoint()
            generation = self._evolution.generation
            self._writer.log(f"ended by {reason} after generation {generation}")

    def _reason(self) -> str | None:
        if self._stopped:
            return "request"
        return self._evolution.reached(*self._parameters.ending())

    def _make_one(self, on_generation: OnGeneration | None) -> None:
        result = self._evolution.advance()
        parent = self._evolution.measures
        generation = self._evolution.generation
        self._writer.add(generation, result, parent)
        if on_generation is not None:
            on_generation(
                Progress(
                    generation,
                    parent["springs"],
                    parent["force_differential"],
                    result["suf"],
                    result["columns"],
                )
            )

    def _is_due(self, since: float, so_far: float) -> bool:
        if since <= _FIRST_CHECKPOINT:
            return False
        return since > _CHECKPOINT_SHARE * so_far or is_watched(self._folder)

    def _obey(self) -> None:
        """Do what was asked; while the run stands still, wait a moment."""
        if self._stands:
            self._writer.stand()
            time.sleep(_POLL)
        for request in self._requests.new():
            if request.what == "pause":
                self._stands = True
            elif request.what == "continue":
                self._stands = False
                self._writer.go_on()
            elif request.what == "stop":
                self._stopped = True
            elif request.what == "change":
                self._change(request.parameters)
            self._writer.log(f"was asked to {request.what}")

    def _change(self, values: dict[str, Any]) -> None:
        """Journal changed parameters and go on as a run does that is resumed."""
        writer, generation = self._writer, self._evolution.generation
        try:
            method = open_run(self._folder).design.file.method
            changed = checked_parameters(self._parameters.model_dump() | values, method)
        except InputError as error:
            writer.log(f"refused a change: {error}")
            return
        writer.checkpoint()
        writer.change(generation, values)
        self._parameters = changed
        run = open_run(self._folder)
        self._evolution = run.evolution(generation, threads=self._threads)


@contextmanager
def _interrupts_noted() -> Iterator[list[int]]:
    """Yield a list that a keyboard interrupt fills, so that it waits for the generation's end.

    A second one interrupts at once. Outside the main thread no interrupt arrives anyway.
    """
    noted: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield noted
        return

    def note(number: int, frame: FrameType | None) -> None:
        if noted:
            raise KeyboardInterrupt
        noted.append(number)

    before = signal.signal(signal.SIGINT, note)
    try:
        yield noted
    finally:
        signal.signal(signal.SIGINT, before)
