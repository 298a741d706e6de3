"""Writing run folders: under a lock, checkpoint by checkpoint."""

from __future__ import annotations

import fcntl
import os
import platform
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from . import _core
from .design import Design, save
from .errors import RunError
from .files import WriteError, explain, remove_temporary, write_atomically
from .network import TOLERANCE
from .parameters import Parameters
from .run import Run
from .run_format import (
    SCHEMA,
    VERSION,
    ChangeLine,
    GenerationLine,
    RunSettings,
    file_hash,
    generation_line,
    is_run,
    journal_text,
    parts_of,
    read_settings,
)
from .steering import Lease, Program, check_free, driver_of

_ATTEMPTS = 4


class RunWriter:
    """Writes a run folder while a run goes on; made by `create` or `reopen`, under a lock."""

    def __init__(self, folder: Path, lease: Lease) -> None:
        """Write into a run folder that exists and is locked."""
        self._folder = folder
        self._lease = lease
        self._waiting: list[tuple[Mapping[str, NDArray[Any]], GenerationLine]] = []

    def add(self, generation: int, result: Mapping[str, Any], parent: Mapping[str, Any]) -> None:
        """Keep one generation until the next checkpoint."""
        count = len(result["columns"]["springs"])
        place = {
            "generation": np.full(count, generation, dtype=np.uint32),
            "individual": np.arange(count, dtype=np.uint32),
        }
        self._waiting.append(
            (place | result["columns"], generation_line(generation, result, parent))
        )

    def checkpoint(self) -> None:
        """Write what was added. Raises `WriteError`: nothing of it counts as written then."""
        self._lease.renew()
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
        self._append_text("journal.jsonl", journal_text(lines))
        self._waiting = []

    def stand(self) -> None:
        """Write what was added, and say that the run stands still."""
        self.checkpoint()
        self._lease.say(standing=True)

    def go_on(self) -> None:
        """Say that the run goes on, if it stood still."""
        self._lease.say(standing=False)

    def change(self, generation: int, parameters: Mapping[str, Any]) -> None:
        """Journal a change of parameters that holds from a generation on."""
        line = ChangeLine(generation=generation, parameters=dict(parameters))
        self._append_text("journal.jsonl", journal_text([line]))

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
    program: Program = "command line",
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
    with _locked(path, program) as lease:
        _refuse_run(path)
        remove_temporary(path)
        if parts_of(path) or (path / "journal.jsonl").exists():
            raise RunError("holds the rest of another run; choose another folder", file=path)
        try:
            (path / "measures").mkdir(exist_ok=True)
        except OSError as error:
            problem = f"can't be made: {explain(error)}"
            raise WriteError(problem, file=path / "measures") from None
        save(design, path / "design.toml")
        settings = RunSettings(
            springform_run=VERSION,
            versions={
                "springform": _core.__version__,
                "python": platform.python_version(),
                "numpy": np.__version__,
                "machine": platform.machine(),
            },
            tolerance=TOLERANCE,
            design=file_hash(path / "design.toml"),
            start=start,
            parameters=parameters.model_dump(mode="json"),
        )
        # Last, because a folder with this file counts as a run.
        text = settings.model_dump_json(indent=2) + "\n"
        write_atomically(path / "run.json", text.encode())
        yield RunWriter(path, lease)


@contextmanager
def reopen(folder: Path, program: Program = "command line") -> Iterator[tuple[Run, RunWriter]]:
    """Hold the lock of a run folder, dropping what lies behind its last complete checkpoint.

    Raises `RunError`: no run, a broken one, or one that another process drives. `WriteError`: it
    can't be written.
    """
    read_settings(folder)
    with _locked(folder, program) as lease:
        # Read under the lock: until now another process may have gone on with it.
        run = Run(folder)
        _check(run)
        write_atomically(folder / "journal.jsonl", journal_text(run.lines).encode())
        remove_temporary(folder)
        remove_temporary(folder / "measures")
        for _, last, path in parts_of(folder):
            if last > run.generations:
                path.unlink(missing_ok=True)
        yield run, RunWriter(folder, lease)


def _check(run: Run) -> None:
    """Read all that is there, so that a damaged run is refused before work is put into it."""
    _ = run.table, run.best


def _refuse_run(folder: Path) -> None:
    if is_run(folder):
        raise RunError("already holds a run; resume it or choose another folder", file=folder)


@contextmanager
def _locked(folder: Path, program: Program) -> Iterator[Lease]:
    path = folder / "lock"
    try:
        lock = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise WriteError(f"can't be written: {explain(error)}", file=path) from None
    try:
        for attempt in range(_ATTEMPTS):
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except OSError:
                # Whoever asks who drives holds the lock for a moment.
                if attempt + 1 < _ATTEMPTS:
                    time.sleep(0.05)
        else:
            driver = driver_of(folder)
            who = "" if driver is None else f": {driver}"
            problem = f"another process drives this run{who}; wait for it"
            raise RunError(problem, file=folder) from None
        check_free(lock, folder)
        lease = Lease(lock, program)
        try:
            yield lease
        finally:
            lease.end()
    finally:
        os.close(lock)
