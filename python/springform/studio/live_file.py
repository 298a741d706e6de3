"""What is kept of live evolution in a document's folder, so that a killed studio takes it up again.

    FOLDER/live.json    parameters that were changed, and factors of cells that were brushed
    FOLDER/grown.json   the net that evolves and where it stands; only while there is one
    FOLDER/grown.jsonl  every generation since, a line each, as in a run's journal
    FOLDER/discarded.json   the one that was discarded last

Evolution is a function of these: a generation that a killed studio had not finished is made again
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
from ..errors import DesignError, InputError
from ..files import WriteError, explain, read_text, write_atomically
from ..run_format import GenerationLine, Strategy

_SETTINGS = "live.json"
_NET = "grown.json"
_LINES = "grown.jsonl"
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
    strategy: Strategy | None = None
    """Numbers of mutations and weighting of the parent; None: those of the parameters."""
    suf: float | None = None
    """Spring utilization factor of the parent, where it was measured."""

    def grown(self) -> Design:
        """Return the parent. Raises `DesignError`: it is no design."""
        return Design(design_file.from_data(self.design))


_R = TypeVar("_R", bound=_Record)


def point_of(line: GenerationLine) -> Point:
    """Return what windows are told of a generation."""
    return Point(
        generation=line.generation,
        springs=line.springs,
        force_differential=line.force_differential,
    )


def design_data(design: Design) -> dict[str, Any]:
    """Return a closed design as `Standing` holds it."""
    found: dict[str, Any] = json.loads(design_file.dump(design.to_file(), "json"))
    return found


def read_settings(folder: Path) -> LiveSettings:
    """Return what was changed and brushed. Raises `InputError`: the file is damaged."""
    return _read(folder / _SETTINGS, LiveSettings) or LiveSettings()


def read_standing(folder: Path) -> Standing | None:
    """Return the net that evolved, as it was last seen; None: there is none.

    Raises `InputError`: it is damaged.
    """
    standing = _read(folder / _NET, Standing)
    if standing is None:
        return None
    lines = _lines_after(folder / _LINES, standing.generation)
    return _advanced(standing, lines, folder) if lines else standing


def write_settings(folder: Path, settings: LiveSettings) -> None:
    """Keep what was changed and brushed. Raises `WriteError`."""
    write_atomically(folder / _SETTINGS, _json(settings))


def write_standing(folder: Path, standing: Standing) -> None:
    """Keep the net that evolves. Raises `WriteError`."""
    write_atomically(folder / _NET, _json(standing))
    # Lines that a kill leaves here are older than the net, and don't count.
    (folder / _LINES).unlink(missing_ok=True)


def add_generation(folder: Path, line: GenerationLine) -> None:
    """Keep a generation after the net that was written last. Raises `WriteError`."""
    try:
        with open(folder / _LINES, "ab") as file:
            # A line that a kill cut short must not swallow this one.
            file.write(b"\n" + line.model_dump_json().encode())
    except OSError as error:
        raise WriteError(f"can't be written: {explain(error)}", file=folder / _LINES) from None


def forget_standing(folder: Path) -> None:
    """Remove the net that evolved, which was kept."""
    for name in (_NET, _LINES):
        (folder / name).unlink(missing_ok=True)


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


def _lines_after(path: Path, generation: int) -> list[GenerationLine]:
    """Return the generations that follow one, without gaps; others were cut short, or are older."""
    if not path.exists():
        return []
    lines: list[GenerationLine] = []
    for text in read_text(path).split("\n"):
        try:
            line = GenerationLine.model_validate_json(text)
        except ValidationError:
            continue
        if line.generation == generation + len(lines) + 1:
            lines.append(line)
    return lines


def _advanced(standing: Standing, lines: list[GenerationLine], folder: Path) -> Standing:
    try:
        design = standing.grown()
        for line in lines:
            design = design.edited(line.edits)
    except DesignError:
        problem = "does not fit the net that it grew from; delete it to go on without"
        raise InputError(problem, file=folder / _LINES) from None
    return standing.model_copy(
        update={
            "generation": lines[-1].generation,
            "points": [*standing.points, *map(point_of, lines)],
            "design": design_data(design),
            "strategy": lines[-1].strategy,
            "suf": lines[-1].suf,
        }
    )


def _json(record: _Record) -> bytes:
    return f"{record.model_dump_json()}\n".encode()
