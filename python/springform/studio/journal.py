"""Documents on the disk: a start, a journal to which every action is added, and snapshots.

    FOLDER/document.json    version, and the design file that the document belongs to
    FOLDER/start.json       the design that it began with
    FOLDER/journal.jsonl    a line an action, undo or redo; on the disk before it counts
    FOLDER/snapshot.json    the design after a number of lines, so that opening need not replay all
    FOLDER/lock             held by the studio that has the document open

What a killed studio was writing is the last line at most; reading drops it.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from .. import design_file
from ..design import Design
from ..errors import DesignError, InputError
from ..files import WriteError, explain, read_text, remove_temporary, write_atomically
from .changes import Action, apply, inverse
from .document import Document

VERSION = 1
"""The format version of document folders that this program reads and writes."""

_LINES_A_SNAPSHOT = 32


class _Record(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class DocumentSettings(_Record):
    """What document.json holds."""

    springform_document: Literal[1] = 1
    file: str | None = None
    """The design file that saving writes; None if there is none yet."""
    saved: str | None = None
    """SHA-256 of that file as it was last read or written."""
    run: str | None = None
    """The run folder that it was opened with."""


class DoneLine(_Record):
    """A line of the journal: an action was done."""

    line: Literal["done"] = "done"
    action: Action


class MovedLine(_Record):
    """A line of the journal: the last action was undone, or the last one undone was redone."""

    line: Literal["undone", "redone"]


_LINE: TypeAdapter[DoneLine | MovedLine] = TypeAdapter(
    Annotated[DoneLine | MovedLine, Field(discriminator="line")]
)


class Journal:
    """A document's folder, open and locked; made by `create` or `reopen`.

    Attributes: `folder`, `document`, `settings`.
    """

    def __init__(
        self, folder: Path, document: Document, settings: DocumentSettings, lines: int
    ) -> None:
        """Go on writing a folder whose journal holds `lines` lines."""
        self.folder = folder
        self.document = document
        self.settings = settings
        self._lines = lines
        self._file = (folder / "journal.jsonl").open("ab")

    def do(self, action: Action) -> Action:
        """Do an action and return it with what its filters wrote; once this returns, it is kept.

        Raises `DesignError`: the action does not fit. `WriteError`: it can't be kept; then it is
        not done.
        """
        action, design = self.document.prepared(action)
        self._append(DoneLine(action=action))
        self.document.done(action, design)
        self._snapshot_now_and_then()
        return action

    def undo(self) -> Action:
        """Undo the last action and return it. Raises `InputError`: there is none."""
        design = self.document.undone()
        self._append(MovedLine(line="undone"))
        self.document.moved(-1, design)
        self._snapshot_now_and_then()
        return self.document.actions[self.document.position]

    def redo(self) -> Action:
        """Redo the action that was undone last and return it. Raises `InputError`: none was."""
        design = self.document.redone()
        self._append(MovedLine(line="redone"))
        self.document.moved(1, design)
        self._snapshot_now_and_then()
        return self.document.actions[self.document.position - 1]

    def belong_to(self, file: str | None, saved: str | None) -> None:
        """Note the design file that the document belongs to, and its hash."""
        self.settings = self.settings.model_copy(update={"file": file, "saved": saved})
        write_atomically(self.folder / "document.json", _json(self.settings))

    def close(self) -> None:
        """Write a snapshot and close the journal."""
        self._snapshot()
        self._file.close()

    def _append(self, line: DoneLine | MovedLine) -> None:
        before = self._file.tell()
        try:
            try:
                self._file.write(_json(line))
                self._file.flush()
                os.fsync(self._file.fileno())
            except OSError:
                # Half a line would stand in the way of everything that follows.
                os.ftruncate(self._file.fileno(), before)
                raise
        except OSError as error:
            path = self.folder / "journal.jsonl"
            raise WriteError(f"can't be written: {explain(error)}", file=path) from None
        self._lines += 1

    def _snapshot_now_and_then(self) -> None:
        if self._lines % _LINES_A_SNAPSHOT == 0:
            self._snapshot()

    def _snapshot(self) -> None:
        design = json.loads(design_file.dump(self.document.design.to_file(), "json"))
        text = json.dumps({"lines": self._lines, "design": design})
        write_atomically(self.folder / "snapshot.json", text.encode())


def create(
    folder: Path,
    design: Design,
    *,
    file: str | None,
    saved: str | None,
    run: str | None = None,
) -> None:
    """Make the folder of a new document.

    Raises `DesignError`: the design gives no net. `WriteError`: the folder can't be written.
    """
    design.network()
    try:
        folder.mkdir(parents=True)
    except OSError as error:
        raise WriteError(f"can't be made: {explain(error)}", file=folder) from None
    start = design_file.dump(design.closed.to_file(), "json")
    write_atomically(folder / "start.json", start.encode())
    # Last, because a folder with this file counts as a document.
    settings = DocumentSettings(file=file, saved=saved, run=run)
    write_atomically(folder / "document.json", _json(settings))


def is_document(folder: Path) -> bool:
    """Whether a folder holds a document."""
    return (folder / "document.json").is_file()


def read_settings(folder: Path) -> DocumentSettings:
    """Read document.json. Raises `InputError`: it is missing or broken."""
    path = folder / "document.json"
    try:
        return DocumentSettings.model_validate_json(read_text(path))
    except ValidationError:
        raise _broken(path, "is no document of this version") from None


def read(folder: Path) -> tuple[Document, int, int]:
    """Return a document, its journal's number of lines, and their size in bytes.

    Raises `InputError`: the folder holds no document, or a broken one.
    """
    read_settings(folder)
    lines, size = _journal_lines(folder / "journal.jsonl")
    count, design = _snapshot_of(folder, len(lines))
    actions: list[Action] = []
    position = 0
    try:
        for number, line in enumerate(lines, start=1):
            if isinstance(line, DoneLine):
                actions[position:] = [line.action]
                step = 1
            else:
                step = -1 if line.line == "undone" else 1
            action = actions[position + min(step, 0)]
            if number > count:
                design = apply(design, action if step > 0 else inverse(design, action))
            position += step
            if not 0 <= position <= len(actions):
                raise IndexError
    except (DesignError, IndexError):
        raise _broken(folder / "journal.jsonl", f"line {number} does not fit") from None
    return Document(design, actions, position), len(lines), size


@contextmanager
def reopen(folder: Path) -> Iterator[Journal]:
    """Hold the lock of a document's folder and go on writing it.

    Raises `InputError`: no document, a broken one, or one that another studio has open.
    """
    with _locked(folder):
        document, lines, size = read(folder)
        remove_temporary(folder)
        journal = folder / "journal.jsonl"
        if journal.exists() and journal.stat().st_size > size:
            os.truncate(journal, size)
        opened = Journal(folder, document, read_settings(folder), lines)
        try:
            yield opened
        finally:
            opened.close()


def _journal_lines(path: Path) -> tuple[list[DoneLine | MovedLine], int]:
    if not path.exists():
        return [], 0
    # What stands after the last line end was being written when the studio died.
    *complete, _ = path.read_bytes().split(b"\n")
    lines = []
    for number, text in enumerate(complete, start=1):
        try:
            lines.append(_LINE.validate_json(text))
        except ValidationError:
            raise _broken(path, f"line {number} is no line of a journal") from None
    return lines, sum(len(text) + 1 for text in complete)


def _snapshot_of(folder: Path, lines: int) -> tuple[int, Design]:
    """Return the number of lines that a design has behind it, and the design."""
    path = folder / "snapshot.json"
    if path.exists():
        try:
            snapshot = json.loads(read_text(path))
            count: Any = snapshot["lines"]
            if 0 <= count <= lines:
                return count, Design(design_file.from_data(snapshot["design"], str(path)))
        except (ValueError, LookupError, TypeError, InputError):
            raise _broken(path, "is no snapshot") from None
    return 0, Design(design_file.load(folder / "start.json"))


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    try:
        lock = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise WriteError(f"can't be opened: {explain(error)}", file=folder) from None
    try:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise InputError("another studio has it open; close that first", file=folder) from None
        yield
    finally:
        os.close(lock)


def _json(record: BaseModel) -> bytes:
    return f"{record.model_dump_json()}\n".encode()


def _broken(path: Path, problem: str) -> InputError:
    return InputError(f"{problem}; the document is damaged, restore it", file=path)
