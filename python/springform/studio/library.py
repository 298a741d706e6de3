"""The documents of a user: where they are kept, and what can be opened."""

from __future__ import annotations

import hashlib
import os
import re
import secrets
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from ..design import Design, load
from ..errors import InputError
from ..files import WriteError, explain
from ..run import open_run
from ..run_format import is_run
from . import journal
from .telling import picture_of


@dataclass(frozen=True)
class Entry:
    """A document that was worked on before."""

    id: str
    name: str
    file: str | None
    changed: float
    """Seconds since 1970."""


def default_home() -> Path:
    """Return the folder in which documents are kept unless told otherwise."""
    return Path(platformdirs.user_data_path("springform")) / "documents"


class Library:
    """The folder of all documents, each in a folder of its own."""

    def __init__(self, home: Path) -> None:
        """Use a folder, made if missing. Raises `WriteError`: it can't be made."""
        self.home = home
        try:
            home.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise WriteError(f"can't be made: {explain(error)}", file=home) from None

    def folder(self, document: str) -> Path:
        """Return the folder of a document. Raises `InputError`: there is none."""
        folder = self.home / document
        if not re.fullmatch(r"[a-z0-9-]{1,80}", document) or not journal.is_document(folder):
            raise InputError("there is no such document", key=document)
        return folder

    def entries(self) -> list[Entry]:
        """Return the documents, the one changed last first; broken ones are left out."""
        return sorted(self._readable(), key=lambda entry: -entry.changed)

    def open(self, source: str) -> str:
        """Return the document of a scene, a design file or a run's best design; made if missing.

        A scene and a run give a new document each time. A file has one document; if the file
        was changed elsewhere, that is an action of its history.
        Raises `InputError`: there is no such source, or it is no valid design.
        """
        if os.path.isdir(source) and is_run(source):
            run = os.path.realpath(source)
            return self._create(open_run(source).best, None, run)
        design = load(source)
        if not os.path.isfile(source):
            return self._create(design, None)
        file = os.path.realpath(source)
        for entry in self.entries():
            if entry.file == file:
                return entry.id
        return self._create(design, file)

    def remove(self, document: str) -> None:
        """Remove a document for good; its design file stays. Raises `InputError`, `WriteError`.

        `InputError`: there is none, or another studio has it open.
        """
        folder = self.folder(document)
        with journal.reopen(folder):
            pass
        # Its name goes first: a folder that is half gone must not pass for a document.
        gone = self.home / f".{document}.removed"
        try:
            folder.rename(gone)
            shutil.rmtree(gone)
        except OSError as error:
            raise WriteError(f"can't be removed: {explain(error)}", file=folder) from None

    def picture(self, document: str) -> bytes:
        """Return the net of a document at equilibrium, as `telling.picture_of` writes it."""
        found, _, _ = journal.read(self.folder(document))
        return picture_of(found.design)

    def _create(self, design: Design, file: str | None, run: str | None = None) -> str:
        words = re.sub(r"[^a-z0-9]+", "-", design.name.lower()).strip("-")[:40] or "net"
        document = f"{words}-{secrets.token_hex(3)}"
        saved = None if file is None else file_hash(file)
        journal.create(self.home / document, design, file=file, saved=saved, run=run)
        return document

    def _readable(self) -> Iterator[Entry]:
        for folder in self.home.iterdir():
            if not journal.is_document(folder):
                continue
            try:
                settings = journal.read_settings(folder)
                document, _, _ = journal.read(folder)
            except InputError:
                continue
            path = folder / "journal.jsonl"
            changed = (path if path.exists() else folder / "document.json").stat().st_mtime
            yield Entry(folder.name, document.design.name, settings.file, changed)


def file_hash(path: str | os.PathLike[str]) -> str | None:
    """Return the SHA-256 of a file; None if it can't be read."""
    try:
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()
    except OSError:
        return None
