"""The folder of patches: files that all documents share, laid out, renamed, deleted."""

from __future__ import annotations

import re
from pathlib import Path

from ..errors import InputError
from ..files import WriteError, explain
from ..patch_file import Origin, Patch, load_patch, save_patch
from .graft_messages import PatchEntry, Patches, PatchTile

_STEPS = {"f": 0, "l": 1, "b": 2, "r": 3}
"""Quarter turns, counter-clockwise, that a step of a walk makes."""

_AHEAD = ((0, 1), (-1, 0), (0, -1), (1, 0))
"""Column and row ahead, by quarter turns of the walker."""

_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Column and row of a cell's children."""

_TOKENS = re.compile(r"[^\s()\[\]]+|[()\[\]]")


class PatchFolder:
    """A folder of patch files, each named as its patch."""

    def __init__(self, folder: Path) -> None:
        """Use a folder, which need not exist."""
        self.folder = folder

    def listing(self) -> Patches:
        """Return all patches by name, broken files with what is wrong."""
        files = [*self.folder.glob("*.toml"), *self.folder.glob("*.json")]
        entries = [_entry(file) for file in sorted(files, key=lambda file: file.stem)]
        return Patches(folder=str(self.folder), patches=entries)

    def load(self, name: str) -> Patch:
        """Return a patch. Raises `InputError`: there is none, or its file is broken."""
        return load_patch(self._file(name))

    def keep(self, patch: Patch) -> None:
        """Write a new patch. Raises `InputError`: the name is taken. `WriteError`: it can't be."""
        self._check_free(patch.name)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise WriteError(f"can't be made: {explain(error)}", file=self.folder) from None
        save_patch(patch, self.folder / f"{patch.name}.toml")

    def rename(self, name: str, other: str) -> None:
        """Give a patch another name. Raises `InputError`: see `load` and `keep`."""
        if name == other:
            return
        self.keep(self.load(name).model_copy(update={"name": other}))
        self.delete(name)

    def delete(self, name: str) -> None:
        """Delete the file of a patch. Raises `InputError`: there is none."""
        file = self._file(name)
        try:
            file.unlink()
        except OSError as error:
            raise WriteError(f"can't be deleted: {explain(error)}", file=file) from None

    def _file(self, name: str) -> Path:
        for ending in (".toml", ".json"):
            file = self.folder / f"{name}{ending}"
            if file.is_file():
                return file
        raise InputError("there is no such patch", key=name)

    def _check_free(self, name: str) -> None:
        try:
            self._file(name)
        except InputError:
            return
        raise InputError("a patch is called that already; choose another name", key=name)


def tiles_of(patch: Patch) -> list[PatchTile]:
    """Return the cells of a patch laid out flat: the seed at 0, 0, the way ahead is up.

    Where a walk leads round an irregular vertex, cells may come to lie on each other.
    """
    tiles: list[PatchTile] = []
    for cell in patch.cells:
        x, y, heading = 0.0, 0.0, 0
        for step in cell.walk:
            heading = (heading + _STEPS[step]) % 4
            ahead = _AHEAD[heading]
            x, y = x + ahead[0], y + ahead[1]
        # What is stored as the walker sees it is turned about the middle of its top-level cell.
        for left, bottom, size, kind in _leaves(cell.cell, cell.path):
            tile = left, bottom
            for _ in range(heading):
                tile = 1 - tile[1] - size, tile[0]
            tiles.append(PatchTile(x=x + tile[0], y=y + tile[1], size=size, kind=kind))
    return tiles


def _leaves(notation: str, path: str) -> list[tuple[float, float, float, str]]:
    """Return left, bottom, size and type of every expressed cell in a square of size 1."""
    left, bottom, size = 0.0, 0.0, 1.0
    for child in filter(None, path.split(".")):
        size /= 2
        column, row = _CORNERS[int(child)]
        left, bottom = left + column * size, bottom + row * size
    found: list[tuple[float, float, float, str]] = []
    tokens = _TOKENS.findall(notation)

    def read(at: int, left: float, bottom: float, size: float, shown: bool) -> int:
        kind = tokens[at].partition("@")[0]
        opening = tokens[at + 1] if at + 1 < len(tokens) else ""
        if shown and opening != "(":
            found.append((left, bottom, size, kind))
        if opening not in ("(", "["):
            return at + 1
        at += 2
        for column, row in _CORNERS:
            corner = left + column * size / 2, bottom + row * size / 2
            at = read(at, *corner, size / 2, shown and opening == "(")
        return at + 1

    read(0, left, bottom, size, True)
    return found


def _entry(file: Path) -> PatchEntry:
    try:
        patch = load_patch(file)
        tiles = tiles_of(patch)
    except (InputError, IndexError) as error:
        problem = str(error) if isinstance(error, InputError) else "has a cell that can't be read"
        return PatchEntry(
            name=file.stem,
            problem=problem,
            anchored=False,
            tiles=[],
            top_level=0,
            origin="",
            force_max=None,
        )
    return PatchEntry(
        name=file.stem,
        problem="",
        anchored=patch.anchored,
        tiles=tiles,
        top_level=len(patch.walks),
        origin=_in_words(patch.origin),
        force_max=patch.origin.force_max,
    )


def _in_words(origin: Origin) -> str:
    words = origin.design
    if origin.generation is not None:
        words += f", generation {origin.generation}"
    if origin.individual is not None:
        words += f", individual {origin.individual}"
    return words
