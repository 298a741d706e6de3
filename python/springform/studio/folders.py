"""Folders of this machine, as a person looks for something to open or a place to save."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ..errors import InputError
from ..files import explain
from ..run_format import is_run
from .shelf_messages import Folder, FolderEntry

_ENDINGS = {".toml", ".json"}

_MOST_ENTRIES = 2000


def folder_at(path: str) -> Folder:
    """Return what a folder holds: folders, runs and designs; an empty path is where we started.

    What a file holds is not looked at: any `.toml` or `.json` may be a design.
    Raises `InputError`: it is no folder, or can't be read.
    """
    folder = Path.cwd() / Path(path).expanduser()
    try:
        folder = folder.resolve()
        entries = sorted(_entries(folder), key=lambda entry: (entry.kind, entry.name.lower()))
    except (OSError, ValueError) as error:
        raise InputError(f"can't be read: {explain(error)}", file=folder) from None
    parent = None if folder.parent == folder else str(folder.parent)
    order = ["folder", "run", "design"]
    entries.sort(key=lambda entry: order.index(entry.kind))
    return Folder(path=str(folder), parent=parent, entries=entries[:_MOST_ENTRIES])


def _entries(folder: Path) -> Iterator[FolderEntry]:
    for path in folder.iterdir():
        if path.name.startswith("."):
            continue
        if path.is_dir():
            yield FolderEntry(name=path.name, kind="run" if is_run(path) else "folder")
        elif path.suffix.lower() in _ENDINGS:
            yield FolderEntry(name=path.name, kind="design")
