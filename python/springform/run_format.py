"""The format of run folders: what their files hold, and how they are read.

    RUN/run.json          format version, versions of the software, parameters
    RUN/design.toml       the design that the run started from
    RUN/journal.jsonl     one line a generation: the winner and its edits; appended
    RUN/measures/*.parquet   measures of every individual, one file a checkpoint
    RUN/best.toml         the final parent, once the run has ended
    RUN/log.txt           what happened when
    RUN/lock              held while a process drives the run, and says which
    RUN/requests.jsonl    what others ask of the driver between generations
    RUN/watched           touched by whoever watches, so that checkpoints come quickly

A checkpoint writes its measures first, then its journal lines. What a crash leaves behind the last
complete checkpoint is dropped on resuming and computed again, to the same bits.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from .design import Design, load
from .errors import RunError
from .files import read_text
from .parameters import Weighting

VERSION = 1
"""Version of the run folder's format."""

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
Strategy = tuple[_Amount, _Amount, _Amount, Weighting]


class _Record(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class RunSettings(_Record):
    """What run.json holds."""

    springform_run: int
    versions: dict[str, str]
    tolerance: float
    design: str
    """SHA-256 of design.toml."""
    start: tuple[_Count, float | None]
    """Springs and force differential of the start."""
    parameters: dict[str, Any]


class GenerationLine(_Record):
    """A line of the journal: what a generation chose as its parent."""

    generation: _Count
    parent: _Count | None
    springs: _Count
    force_differential: float | None
    suf: float | None
    strategy: Strategy
    edits: list[str]


class ChangeLine(_Record):
    """A line of the journal: parameters that hold from a generation on."""

    generation: _Count
    parameters: dict[str, Any]


JournalLine = GenerationLine | ChangeLine
_LINE: TypeAdapter[JournalLine] = TypeAdapter(JournalLine)


def generation_line(
    generation: int, result: Mapping[str, Any], parent: Mapping[str, Any]
) -> GenerationLine:
    """Return what is kept of a generation, from its result and the measures of the new parent."""
    return GenerationLine(
        generation=generation,
        parent=result["winner"],
        springs=parent["springs"],
        force_differential=parent["force_differential"],
        suf=result["suf"],
        strategy=result["strategy"],
        edits=result["edits"],
    )


def is_run(folder: str | os.PathLike[str]) -> bool:
    """Whether a folder holds a run."""
    try:
        return (Path(folder) / "run.json").is_file()
    except (OSError, ValueError):
        return False  # a path that no file can have


def broken(path: Path, problem: str, line: int | None = None) -> RunError:
    """Return the error for a file that is not as it was written."""
    return RunError(f"{problem}; the run folder is damaged, restore it", file=path, line=line)


def file_hash(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def read_settings(folder: Path) -> RunSettings:
    """Read run.json. Raises `RunError`: there is none, or a broken one."""
    path = folder / "run.json"
    if not is_run(folder):
        raise RunError("holds no run: run.json is missing", file=folder)
    text = read_text(path, RunError)
    try:
        version = json.loads(text)["springform_run"]
        if version == VERSION:
            return RunSettings.model_validate_json(text)
    except (ValueError, LookupError, TypeError, RecursionError):
        raise broken(path, "is no run's settings") from None
    raise RunError(f"has version {version}; this program reads version {VERSION}", file=path)


def read_design(folder: Path, settings: RunSettings) -> Design:
    """Read the start. Raises `RunError`: it is not the design that the run started from."""
    path = folder / "design.toml"
    read_text(path, RunError)
    if file_hash(path) != settings.design:
        raise broken(path, "is not the design that the run started from")
    return load(path)


def journal_text(lines: Sequence[JournalLine]) -> str:
    """Return lines as they stand in the journal."""
    return "".join(f"{line.model_dump_json()}\n" for line in lines)


def read_journal(folder: Path) -> list[JournalLine]:
    """Read all complete lines. Raises `RunError`: one that is no line of a journal."""
    path = folder / "journal.jsonl"
    if not path.exists():
        return []
    # What stands after the last line end was being written when the process died.
    *complete, _ = read_text(path, RunError).split("\n")
    lines: list[JournalLine] = []
    generation = 0
    for number, text in enumerate(complete, start=1):
        try:
            line = _LINE.validate_json(text)
        except ValidationError:
            raise broken(path, "is no line of a journal", number) from None
        generation += isinstance(line, GenerationLine)
        if line.generation != generation:
            raise broken(path, f"is not about generation {generation}", number)
        lines.append(line)
    return lines


def parts_of(folder: Path) -> list[tuple[int, int, Path]]:
    """Return (first generation, last generation, file) of every file of measures, ascending."""
    parts = []
    for path in (folder / "measures").glob("*.parquet"):
        first, _, last = path.stem.partition("-")
        if not (first.isdecimal() and last.isdecimal()):
            raise broken(path, "is no file of measures")
        parts.append((int(first), int(last), path))
    return sorted(parts)


def complete_generations(
    lines: Sequence[JournalLine], parts: Sequence[tuple[int, int, Path]]
) -> int:
    """Return the last generation of which the journal and all measures are there."""
    journalled = lines[-1].generation if lines else 0
    complete = 0
    for first, last, path in parts:
        if first != complete + 1:
            raise broken(path, f"the measures of generation {complete + 1} are missing before it")
        if last > journalled:
            break
        complete = last
    return complete


def read_part(first: int, last: int, path: Path, population: int) -> pa.Table:
    """Read a file of measures. Raises `RunError`: it does not hold what its name says."""
    try:
        # On one thread and without Python's own files: a thread of Arrow that still holds on to
        # Python when the interpreter ends aborts the process.
        data = pa.BufferReader(path.read_bytes())
        file = pq.ParquetFile(data, pre_buffer=False, page_checksum_verification=True)
        table = file.read(use_threads=False)
    except (OSError, ValueError, pa.ArrowException):
        raise broken(path, "is no complete file of measures") from None
    generations = np.repeat(np.arange(first, last + 1), population)
    if not table.schema.equals(SCHEMA) or not np.array_equal(table["generation"], generations):
        raise broken(path, "does not hold what its name says")
    return table


def as_numpy(column: pa.ChunkedArray) -> NDArray[Any]:
    """Return a column with NaN for null."""
    if pa.types.is_floating(column.type):
        column = column.fill_null(float("nan"))
    array: NDArray[Any] = column.to_numpy()
    return array
