"""The design file that a document belongs to: where it is saved, and what it holds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..design import Design, load, save
from ..design_schema import DesignFile
from ..errors import InputError
from .changes import Action
from .commands import renamed, whole
from .document import Document
from .journal import Journal
from .library import file_hash
from .messages import Save


@dataclass(frozen=True)
class Saving:
    """What saving does: a file written, and perhaps a name taken from it first."""

    target: Path
    design: Design
    """As it is written."""
    action: Action | None
    """Gives the document the file's name; None if it keeps its own."""


def saving(journal: Journal, request: Save, *, naming: bool) -> Saving:
    """Return where a document is saved, and as what.

    A path without an ending gets `.toml`; with `naming` a new path gives the document its name.
    Raises `InputError`: there is no path yet, or another file is there.
    """
    settings, design = journal.settings, journal.document.design
    path = request.path or settings.file
    if path is None:
        raise InputError("the document has no file yet; say where to save it", key="path")
    target = Path.cwd() / Path(path).expanduser()
    if not target.suffix:
        target = target.with_name(f"{target.name}.toml")
    own = settings.file is not None and target == Path(settings.file)
    if target.exists() and not (own or request.replace):
        raise InputError("exists; choose another name or allow to replace it", file=target)
    if own or not naming or target.stem == design.file.name:
        return Saving(target, design, None)
    action, after = Document(design).prepared(renamed(design, target.stem))
    return Saving(target, after, action)


def write(journal: Journal, done: Saving) -> None:
    """Write a document's file and note that it belongs to the document. Raises `WriteError`."""
    save(done.design, done.target)
    journal.belong_to(str(done.target), file_hash(done.target))


def reverting(journal: Journal) -> Action:
    """Return the action that puts back what a document's file holds, and note that it was read.

    Raises `InputError`: there is no file yet, or it holds no valid design.
    """
    file = journal.settings.file
    if file is None:
        raise InputError("the document has no file yet", key="path")
    action = whole(journal.document.design, load(file).closed, f"Go back to {Path(file).name}")
    journal.belong_to(file, file_hash(file))
    return action


def taken_over(journal: Journal) -> DesignFile | None:
    """Return what a document's file holds; take it over if it was changed elsewhere."""
    settings = journal.settings
    if settings.file is None or (now := file_hash(settings.file)) is None:
        return None
    try:
        design = load(settings.file).closed
    except InputError:
        return None
    if now != settings.saved:
        label = f"Read {Path(settings.file).name}, changed elsewhere"
        journal.do(whole(journal.document.design, design, label))
        journal.belong_to(settings.file, now)
    return design.to_file()
