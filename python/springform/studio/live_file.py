"""What is kept of live evolution in a document's folder, so that a killed studio takes it up again.

    FOLDER/live.json    parameters that were changed, and factors of cells that were brushed
    FOLDER/grown.json   the net that evolves and where it stands; only while there is one
    FOLDER/discarded.json   the one that was discarded last

Evolution is a function of the two: what a killed studio had grown since it last wrote grows again
the same way.
"""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from .. import design_file
from ..design import Design
from ..errors import InputError
from ..files import read_text, write_atomically

_SETTINGS = "live.json"
_NET = "grown.json"
_DISCARDED = "discarded.json"


class _Record(BaseModel):
    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


class LiveSettings(_Record):
    """What live.json holds."""

    springform_live: Literal[1] = 1
    parameters: dict[str, Any] = {}
    """Those that differ from their defaults."""
    weights: dict[str, float] = {}
    """Factors of brushed cells, by address."""


class Point(_Record):
    """What a generation gave."""

    generation: int
    springs: int
    force_differential: float | None


class Standing(_Record):
    """What grown.json holds."""

    springform_grown: Literal[1] = 1
    generation: int
    """Generations made."""
    start: tuple[int, float | None]
    """Springs and force differential of the net that it began with."""
    points: list[Point]
    """Of the last generations."""
    design: dict[str, Any]
    """The parent, as a design file."""

    def grown(self) -> Design:
        """Return the parent. Raises `DesignError`: it is no design."""
        return Design(design_file.from_data(self.design))


_R = TypeVar("_R", bound=_Record)


def design_data(design: Design) -> dict[str, Any]:
    """Return a closed design as `Standing` holds it."""
    found: dict[str, Any] = json.loads(design_file.dump(design.to_file(), "json"))
    return found


def read_settings(folder: Path) -> LiveSettings:
    """Return what was changed and brushed. Raises `InputError`: the file is damaged."""
    return _read(folder / _SETTINGS, LiveSettings) or LiveSettings()


def read_standing(folder: Path) -> Standing | None:
    """Return the net that evolved; None: there is none. Raises `InputError`: it is damaged."""
    return _read(folder / _NET, Standing)


def write_settings(folder: Path, settings: LiveSettings) -> None:
    """Keep what was changed and brushed. Raises `WriteError`."""
    write_atomically(folder / _SETTINGS, _json(settings))


def write_standing(folder: Path, standing: Standing) -> None:
    """Keep the net that evolves. Raises `WriteError`."""
    write_atomically(folder / _NET, _json(standing))


def forget_standing(folder: Path) -> None:
    """Remove the net that evolved, which was kept."""
    (folder / _NET).unlink(missing_ok=True)


def discard_standing(folder: Path) -> None:
    """Put the net that evolved aside; the one discarded before is gone."""
    with suppress(FileNotFoundError):
        (folder / _NET).replace(folder / _DISCARDED)


def restore_standing(folder: Path) -> None:
    """Bring back what was discarded last. Raises `InputError`: nothing was."""
    try:
        (folder / _DISCARDED).replace(folder / _NET)
    except FileNotFoundError:
        raise InputError("nothing was discarded that could be brought back") from None


def is_restorable(folder: Path) -> bool:
    """Whether something was discarded that can be brought back."""
    return (folder / _DISCARDED).exists()


def _read(path: Path, kind: type[_R]) -> _R | None:
    if not path.exists():
        return None
    try:
        return kind.model_validate_json(read_text(path))
    except ValidationError:
        problem = "is no record of live evolution of this version; delete it to go on without"
        raise InputError(problem, file=path) from None


def _json(record: _Record) -> bytes:
    return f"{record.model_dump_json()}\n".encode()
