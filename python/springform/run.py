"""Run folders: everything that a run needs to be read, resumed and rebuilt.

    RUN/run.json          format version, versions of the software, parameters
    RUN/design.toml       the design that the run started from
    RUN/journal.jsonl     one line a generation: the winner and its edits; appended
    RUN/measures/*.parquet   measures of every individual, one file a checkpoint
    RUN/best.toml         the final parent, once the run has ended
    RUN/log.txt           what happened when
    RUN/lock              held while a process drives the run

A checkpoint writes its measures first, then its journal lines. What a crash leaves behind the last
complete checkpoint is dropped on resuming and computed again, to the same bits.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import platform
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from . import _core
from .design import Design, load, save
from .errors import DesignError, InputError, RunError
from .files import WriteError, explain, read_text, remove_temporary, write_atomically
from .network import TOLERANCE
from .parameters import Parameters, Weighting, checked_parameters

VERSION = 1
"""Version of the run folder's format."""

Table = dict[str, NDArray[Any]]
"""Columns by name, one row an individual in order of generation and index; undefined is NaN."""

_FORCES = [f"force_{name}" for name in ("min", "max", "mean", "deviation", "variation", "range")]
_SIZES = ["total_length", "load_path", "area", "shortest_spring", "length_per_area", "residual"]
SCHEMA = pa.schema(
    dict.fromkeys(["generation", "individual", "springs", "nodes", "cells"], pa.uint32())
    | dict.fromkeys(["force_differential", "suf", *_FORCES, *_SIZES], pa.float64())
    | {"valid": pa.bool_(), "edits": pa.uint32(), "fingerprint": pa.uint64()}
)
"""Columns of the files of measures; undefined is null. Units as in `Measures`."""

_Count = Annotated[int, Field(ge=0, lt=2**32)]
_Amount = tuple[bool, Annotated[float, Field(ge=0)]]
_Strategy = tuple[_Amount, _Amount, _Amount, Weighting]


class _Record(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class _Settings(_Record):
    springform_run: int
    versions: dict[str, str]
    tolerance: float
    design: str
    """SHA-256 of design.toml."""
    start: tuple[_Count, float | None]
    """Springs and force differential of the start."""
    parameters: dict[str, Any]


class _Generation(_Record):
    """A line of the journal: what a generation chose as its parent."""

    generation: _Count
    parent: _Count | None
    springs: _Count
    force_differential: float | None
    suf: float | None
    strategy: _Strategy
    edits: list[str]


class _Change(_Record):
    """A line of the journal: parameters that hold from a generation on."""

    generation: _Count
    parameters: dict[str, Any]


_Line = _Generation | _Change
_LINE: TypeAdapter[_Line] = TypeAdapter(_Line)


class Run:
    """A run folder, as far as it is complete.

    Attributes: `folder`, `design` (the start), `parameters`.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        """Open a run folder. Raises `RunError`: it holds no run, or a broken one."""
        self.folder = Path(folder)
        self._settings = _read_settings(self.folder)
        self.design = _read_design(self.folder, self._settings)
        lines, parts = _read_journal(self.folder), _parts(self.folder)
        self.generations = _complete(lines, parts)
        self._lines = [line for line in lines if line.generation <= self.generations]
        self._parts = [part for part in parts if part[1] <= self.generations]
        self.parameters = self._current_parameters()

    @property
    def parents(self) -> list[int | None]:
        """Index of the winner of every generation; None where the parent stayed."""
        return [line.parent for line in self._chosen]

    @property
    def _chosen(self) -> list[_Generation]:
        return [line for line in self._lines if isinstance(line, _Generation)]

    @cached_property
    def table(self) -> Table:
        """Measures of every individual. Raises `RunError`: a file of measures is broken."""
        population = self.parameters.population
        tables = [_read_part(*part, population) for part in self._parts]
        if not tables:
            return {}
        merged = pa.concat_tables(tables)
        return {name: _numpy(merged.column(name)) for name in merged.column_names}

    @property
    def best(self) -> Design:
        """The final parent."""
        return self.parent(self.generations)

    def parent(self, generation: int) -> Design:
        """Return the parent chosen in a generation; 0 is the start with its filters applied."""
        self._check_generation(generation, first=0)
        lines = self._chosen[:generation]
        edits = [edit for line in lines for edit in line.edits]
        parent = self._changed(self.design.closed, edits, f"generation {generation}")
        winners = [(line.generation, line.parent) for line in lines if line.parent is not None]
        if winners:
            self._check_individual(parent, *winners[-1])
        return parent

    def individual(self, generation: int, individual: int) -> Design:
        """Rebuild any individual that was ever evaluated. Raises `RunError`: there is no such."""
        self._check_generation(generation, first=1)
        if not 0 <= individual < self.parameters.population:
            last = self.parameters.population - 1
            raise RunError(f"there is no individual {individual}; there are 0 to {last}")
        parent = self.parent(generation - 1)
        edits = self.evolution(generation - 1, threads=1).individual(individual)
        name = f"generation {generation}, individual {individual}"
        rebuilt = self._changed(parent, edits, name)
        self._check_individual(rebuilt, generation, individual)
        return rebuilt

    @property
    def start(self) -> dict[str, Any]:
        """Springs, force differential and SUF of the start."""
        springs, differential = self._settings.start
        return {"springs": springs, "force_differential": differential, "suf": None}

    @property
    def final(self) -> dict[str, Any]:
        """Springs, force differential and SUF of the final parent."""
        if not self._chosen:
            return self.start
        last = self._chosen[-1]
        return {name: getattr(last, name) for name in ("springs", "force_differential", "suf")}

    @property
    def lowest(self) -> tuple[int, int] | None:
        """(generation, individual) of the lowest force differential; None if there is none."""
        row = self._lowest_row()
        return None if row is None else (self._at("generation", row), self._at("individual", row))

    @property
    def lowest_standing(self) -> dict[str, Any] | None:
        """Springs, force differential and SUF of the individual of lowest force differential."""
        row = self._lowest_row()
        if row is None:
            return None
        suf = float(self.table["suf"][row])
        return {
            "springs": self._at("springs", row),
            "force_differential": float(self.table["force_differential"][row]),
            "suf": None if np.isnan(suf) else suf,
        }

    def pareto(self) -> NDArray[np.int64]:
        """Return the rows of the Pareto set: no other has as many springs at a lower differential.

        Ascending in springs and force differential.
        """
        table = self.table
        if not table:
            return np.empty(0, dtype=np.int64)
        rows = np.flatnonzero(~np.isnan(table["force_differential"]))
        differential, springs = table["force_differential"][rows], table["springs"][rows]
        order = np.lexsort((rows, differential, -springs.astype(np.int64)))
        lowest = np.minimum.accumulate(np.concatenate(([np.inf], differential[order][:-1])))
        front: NDArray[np.int64] = rows[order[differential[order] < lowest]][::-1]
        return front

    def digest(self) -> str:
        """Return a hash of the final genotype and of the whole table of measures."""
        state = hashlib.sha256()
        cells, added, cut = self.design.setting.notation(self.best.forest, "")
        state.update(json.dumps([cells, added, cut]).encode())
        for name, column in self.table.items():
            state.update(name.encode())
            state.update(
                np.ascontiguousarray(column).astype(column.dtype.newbyteorder("<")).tobytes()
            )
        return state.hexdigest()

    def evolution(self, generation: int, *, threads: int) -> _core.Evolution:
        """Return the algorithm as it stood after a generation."""
        self._check_generation(generation, first=0)
        line = self._chosen[generation - 1] if generation else None
        return start_evolution(
            self.parent(generation),
            self.parameters,
            threads=threads,
            strategy=line.strategy if line else None,
            resumed=(generation, self._settings.start, line.suf if line else None),
        )

    def _changed(self, design: Design, edits: Sequence[str], name: str) -> Design:
        try:
            return design.edited(edits).renamed(f"{self.design.name}, {name}")
        except DesignError as error:
            problem = f"does not lead to {name}: {error.message}"
            raise _broken(self.folder / "journal.jsonl", problem) from None

    def _check_individual(self, design: Design, generation: int, individual: int) -> None:
        fingerprints = self.table["fingerprint"][self.table["generation"] == generation]
        if design.forest.fingerprint not in fingerprints[individual : individual + 1]:
            problem = f"does not lead to individual {individual} of generation {generation}"
            raise _broken(self.folder / "journal.jsonl", problem)

    def _current_parameters(self) -> Parameters:
        values = dict(self._settings.parameters)
        for line in self._lines:
            if isinstance(line, _Change):
                values |= line.parameters
        try:
            return checked_parameters(values, self.design.file.method)
        except InputError as error:
            path = self.folder / "run.json"
            raise RunError(error.message, file=path, key=f"parameters.{error.key}") from None

    def _lowest_row(self) -> int | None:
        differential = self.table.get("force_differential")
        if differential is None or np.isnan(differential).all():
            return None
        return int(np.nanargmin(differential))

    def _at(self, column: str, row: int) -> int:
        return int(self.table[column][row])

    def _check_generation(self, generation: int, first: int) -> None:
        if not first <= generation <= self.generations:
            raise RunError(
                f"there is no generation {generation}; there are {first} to {self.generations}",
                file=self.folder,
            )


def open_run(folder: str | os.PathLike[str]) -> Run:
    """Open a run folder. Raises `RunError`: it holds no run, or a broken one."""
    return Run(folder)


def is_run(folder: str | os.PathLike[str]) -> bool:
    """Whether a folder holds a run."""
    try:
        return (Path(folder) / "run.json").is_file()
    except (OSError, ValueError):
        return False  # a path that no file can have


def start_evolution(
    design: Design,
    parameters: Parameters,
    *,
    threads: int,
    strategy: Any = None,
    resumed: Any = None,
) -> _core.Evolution:
    """Return the algorithm at a design. Raises `DesignError`: it gives no net."""
    # A design that gives no net says why, with file and key.
    design.network()
    try:
        types = [design.setting.cell_type(kind) for kind in parameters.types]
        return _core.Evolution(
            design.setting,
            design.forest,
            population=parameters.population,
            seed=parameters.seed,
            types=types,
            strategy=parameters.strategy() if strategy is None else strategy,
            base=parameters.weight_base,
            exponent=parameters.weight_exponent,
            self_adapt=parameters.self_adapt,
            fitness=parameters.fitness,
            suf_reference=parameters.suf_reference,
            niche=parameters.niche,
            min_length=parameters.min_length,
            selection=parameters.selection,
            threads=threads,
            resumed=resumed,
        )
    except _core.CoreError as error:
        key, problem = error.args
        raise InputError(problem, key=key) from None


class RunWriter:
    """Writes a run folder while a run goes on; made by `create` or `reopen`, under a lock."""

    def __init__(self, folder: Path) -> None:
        """Write into a run folder that exists and is locked."""
        self._folder = folder
        self._waiting: list[tuple[Mapping[str, NDArray[Any]], _Generation]] = []

    def add(self, generation: int, result: Mapping[str, Any], parent: Mapping[str, Any]) -> None:
        """Keep one generation until the next checkpoint."""
        count = len(result["columns"]["springs"])
        place = {
            "generation": np.full(count, generation, dtype=np.uint32),
            "individual": np.arange(count, dtype=np.uint32),
        }
        line = _Generation(
            generation=generation,
            parent=result["winner"],
            springs=parent["springs"],
            force_differential=parent["force_differential"],
            suf=result["suf"],
            strategy=result["strategy"],
            edits=result["edits"],
        )
        self._waiting.append((place | result["columns"], line))

    def checkpoint(self) -> None:
        """Write what was added. Raises `WriteError`: nothing of it counts as written then."""
        if not self._waiting:
            return
        columns, lines = zip(*self._waiting, strict=True)
        first, last = lines[0].generation, lines[-1].generation

        def column(name: str) -> pa.Array:
            return pa.array(np.concatenate([rows[name] for rows in columns]), from_pandas=True)

        table = pa.table([column(name) for name in SCHEMA.names], schema=SCHEMA)
        sink = pa.BufferOutputStream()
        pq.write_table(table, sink, compression="zstd", write_page_checksum=True)
        name = f"{first:07}-{last:07}.parquet"
        write_atomically(self._folder / "measures" / name, sink.getvalue().to_pybytes())
        self._append_text("journal.jsonl", _journal_text(lines))
        self._waiting = []

    def change(self, generation: int, parameters: Mapping[str, Any]) -> None:
        """Journal a change of parameters that holds from a generation on."""
        line = _Change(generation=generation, parameters=dict(parameters))
        self._append_text("journal.jsonl", _journal_text([line]))

    def log(self, message: str) -> None:
        """Add a line to the log."""
        now = datetime.now(UTC).isoformat(timespec="seconds")
        self._append_text("log.txt", f"{now} {message}\n")

    def _append_text(self, name: str, text: str) -> None:
        path = self._folder / name
        try:
            with open(path, "ab") as file:
                before = file.tell()
                try:
                    file.write(text.encode())
                    file.flush()
                    os.fsync(file.fileno())
                except OSError:
                    # Half a line would stand in the way of everything that follows.
                    os.ftruncate(file.fileno(), before)
                    raise
        except OSError as error:
            raise WriteError(f"can't be written: {explain(error)}", file=path) from None


@contextmanager
def create(
    folder: str | os.PathLike[str],
    design: Design,
    parameters: Parameters,
    start: tuple[int, float | None],
) -> Iterator[RunWriter]:
    """Make a run folder and hold its lock.

    Raises `RunError`: the folder holds a run, or something else. `WriteError`: it can't be written.
    """
    path = Path(folder)
    _refuse_run(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
        # Where a run began and died before it was one, there is a lock.
        in_use = any(path.iterdir()) and not (path / "lock").exists()
    except (OSError, ValueError) as error:
        raise WriteError(f"can't be made: {explain(error)}", file=path) from None
    if in_use:
        raise RunError("is not empty; choose another folder", file=path)
    with _locked(path):
        _refuse_run(path)
        remove_temporary(path)
        if _parts(path) or (path / "journal.jsonl").exists():
            raise RunError("holds the rest of another run; choose another folder", file=path)
        try:
            (path / "measures").mkdir(exist_ok=True)
        except OSError as error:
            problem = f"can't be made: {explain(error)}"
            raise WriteError(problem, file=path / "measures") from None
        save(design, path / "design.toml")
        settings = _Settings(
            springform_run=VERSION,
            versions={
                "springform": _core.__version__,
                "python": platform.python_version(),
                "numpy": np.__version__,
                "machine": platform.machine(),
            },
            tolerance=TOLERANCE,
            design=_hash(path / "design.toml"),
            start=start,
            parameters=parameters.model_dump(mode="json"),
        )
        # Last, because a folder with this file counts as a run.
        text = settings.model_dump_json(indent=2) + "\n"
        write_atomically(path / "run.json", text.encode())
        yield RunWriter(path)


@contextmanager
def reopen(folder: Path) -> Iterator[tuple[Run, RunWriter]]:
    """Hold the lock of a run folder, dropping what lies behind its last complete checkpoint.

    Raises `RunError`: no run, a broken one, or one that another process drives. `WriteError`: it
    can't be written.
    """
    _read_settings(folder)
    with _locked(folder):
        # Read under the lock: until now another process may have gone on with it.
        run = Run(folder)
        _check(run)
        write_atomically(folder / "journal.jsonl", _journal_text(run._lines).encode())
        remove_temporary(folder)
        remove_temporary(folder / "measures")
        for _, last, path in _parts(folder):
            if last > run.generations:
                path.unlink(missing_ok=True)
        yield run, RunWriter(folder)


def _check(run: Run) -> None:
    """Read all that is there, so that a damaged run is refused before work is put into it."""
    _ = run.table, run.best


def _refuse_run(folder: Path) -> None:
    if is_run(folder):
        raise RunError("already holds a run; resume it or choose another folder", file=folder)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    path = folder / "lock"
    try:
        lock = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise WriteError(f"can't be written: {explain(error)}", file=path) from None
    try:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise RunError("another process drives this run; wait for it", file=folder) from None
        yield
    finally:
        os.close(lock)


def _broken(path: Path, problem: str, line: int | None = None) -> RunError:
    return RunError(f"{problem}; the run folder is damaged, restore it", file=path, line=line)


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _read_settings(folder: Path) -> _Settings:
    path = folder / "run.json"
    if not is_run(folder):
        raise RunError("holds no run: run.json is missing", file=folder)
    text = read_text(path, RunError)
    try:
        version = json.loads(text)["springform_run"]
        if version == VERSION:
            return _Settings.model_validate_json(text)
    except (ValueError, LookupError, TypeError, RecursionError):
        raise _broken(path, "is no run's settings") from None
    raise RunError(f"has version {version}; this program reads version {VERSION}", file=path)


def _read_design(folder: Path, settings: _Settings) -> Design:
    path = folder / "design.toml"
    read_text(path, RunError)
    if _hash(path) != settings.design:
        raise _broken(path, "is not the design that the run started from")
    return load(path)


def _journal_text(lines: Sequence[_Line]) -> str:
    return "".join(f"{line.model_dump_json()}\n" for line in lines)


def _read_journal(folder: Path) -> list[_Line]:
    path = folder / "journal.jsonl"
    if not path.exists():
        return []
    # What stands after the last line end was being written when the process died.
    *complete, _ = read_text(path, RunError).split("\n")
    lines: list[_Line] = []
    generation = 0
    for number, text in enumerate(complete, start=1):
        try:
            line = _LINE.validate_json(text)
        except ValidationError:
            raise _broken(path, "is no line of a journal", number) from None
        generation += isinstance(line, _Generation)
        if line.generation != generation:
            raise _broken(path, f"is not about generation {generation}", number)
        lines.append(line)
    return lines


def _parts(folder: Path) -> list[tuple[int, int, Path]]:
    """(first generation, last generation, file) of every file of measures, ascending."""
    parts = []
    for path in (folder / "measures").glob("*.parquet"):
        first, _, last = path.stem.partition("-")
        if not (first.isdecimal() and last.isdecimal()):
            raise _broken(path, "is no file of measures")
        parts.append((int(first), int(last), path))
    return sorted(parts)


def _complete(lines: Sequence[_Line], parts: Sequence[tuple[int, int, Path]]) -> int:
    """The last generation of which the journal and all measures are there."""
    journalled = lines[-1].generation if lines else 0
    complete = 0
    for first, last, path in parts:
        if first != complete + 1:
            raise _broken(path, f"the measures of generation {complete + 1} are missing before it")
        if last > journalled:
            break
        complete = last
    return complete


def _read_part(first: int, last: int, path: Path, population: int) -> pa.Table:
    try:
        # On one thread and without Python's own files: a thread of Arrow that still holds on to
        # Python when the interpreter ends aborts the process.
        data = pa.BufferReader(path.read_bytes())
        file = pq.ParquetFile(data, pre_buffer=False, page_checksum_verification=True)
        table = file.read(use_threads=False)
    except (OSError, ValueError, pa.ArrowException):
        raise _broken(path, "is no complete file of measures") from None
    generations = np.repeat(np.arange(first, last + 1), population)
    if not table.schema.equals(SCHEMA) or not np.array_equal(table["generation"], generations):
        raise _broken(path, "does not hold what its name says")
    return table


def _numpy(column: pa.ChunkedArray) -> NDArray[Any]:
    if pa.types.is_floating(column.type):
        column = column.fill_null(float("nan"))
    array: NDArray[Any] = column.to_numpy()
    return array
