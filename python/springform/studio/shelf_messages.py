"""Messages of the start page: scenes, documents, folders, and what is opened."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .message_base import Message as _Message


class SceneEntry(_Message):
    """A packaged scene."""

    name: str
    description: str


class DocumentEntry(_Message):
    """A document that was worked on before."""

    id: str
    name: str
    file: str | None
    changed: float
    """Seconds since 1970."""
    open: bool


class Shelf(_Message):
    """What can be opened."""

    scenes: list[SceneEntry]
    documents: list[DocumentEntry]


class FolderEntry(_Message):
    """What can be opened or entered in a folder."""

    name: str
    kind: Literal["folder", "design", "run"]


class Folder(_Message):
    """A folder of this machine, as far as the studio can open what is in it."""

    path: str
    parent: str | None
    entries: list[FolderEntry]


class Opening(_Message):
    """Ask for a new document from a scene or a design file."""

    source: Annotated[str, Field(min_length=1, max_length=4000)]


class Opened(_Message):
    """The document that was opened."""

    id: str
    went_on: bool
    """Whether it is a file's document, with changes since it was saved."""
