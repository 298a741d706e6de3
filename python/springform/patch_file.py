"""Patches: cells without address or place, as values and as small files of their own.

A file is TOML or JSON with a version, saved canonically; `docs/formats/patch.md` describes it.
"""

from __future__ import annotations

import os
from itertools import groupby
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError
from pydantic_core import PydanticCustomError

from .canonical_text import json_text, toml_text
from .design_file import format_of, read_data, without_defaults
from .design_messages import URGENCY, message_of, path_of
from .design_schema import CellTypeDefinition
from .errors import InputError, printable
from .files import read_text, write_atomically
from .key_lines import Format, line_of_key
from .patch_schema import CorePatch, PatchCells, cells_of, core_patch
from .schema_base import Name
from .wording import key_text, shown

VERSION = 1
"""The version of patch files that this program reads and writes."""


class PatchError(InputError):
    """A patch file that is broken, or a patch that does not go with a design."""


def _fault(message: str) -> PydanticCustomError:
    return PydanticCustomError("design", "{message}", {"message": printable(message)})


def _check_version(value: object) -> object:
    if isinstance(value, bool) or value != VERSION:
        raise _fault(
            f"patch version {shown(value)} is not known here; this program reads {VERSION}"
        )
    return value


class _Section(BaseModel):
    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


class Origin(_Section):
    """Where a patch comes from, and how it stood there."""

    design: str = ""
    """Name of the design."""
    run: str | None = None
    """Folder of the run, if it comes from one."""
    generation: int | None = None
    """Generation of the individual in the run; 0 is the start."""
    individual: int | None = None
    """Individual of the generation; without it its parent for the next."""
    cells: str = ""
    """What was selected."""
    springs: int | None = None
    """Springs of the whole net."""
    force_differential: float | None = None
    """Largest over smallest force of the whole net."""
    force_mean: float | None = None
    """Mean force of the whole net [N]."""
    force_max: float | None = None
    """Largest force in the cells of the patch [N]."""


class Patch(_Section):
    """Cells without address or place: the paper's "directional logic for neighboring"."""

    springform_patch: Annotated[int, BeforeValidator(_check_version)] = VERSION
    """Version of this format."""
    name: Name = "patch"
    """What the patch is called: a lower-case letter, then letters, digits and _."""
    anchored: bool = False
    """Corner 0 of the seed lay on an anchor."""
    origin: Origin = Origin()
    """Where it comes from."""
    cell_types: dict[Name, CellTypeDefinition] = {}
    """Definitions of the types that are not built in."""
    cells: PatchCells
    """Shorter walks first, then in the order f, l, r, b: breadth first."""

    @property
    def walks(self) -> list[str]:
        """Walks to the top-level cells, the seed's first."""
        return [walk for walk, _ in groupby(cell.walk for cell in self.cells)]

    def core(self) -> CorePatch:
        """Return the patch as the core takes it."""
        return core_patch(self.anchored, self.cells)

    def with_core(self, core: CorePatch) -> Patch:
        """Return the patch with other cells, as the core gives them."""
        return self.model_copy(update={"anchored": core[0], "cells": cells_of(core)})


def parse_patch(data: object, source: str | None = None, text: str | None = None) -> Patch:
    """Return the patch in plain data; `text` is the file, for lines. Raises `PatchError`."""
    try:
        return Patch.model_validate(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
    first = min(details, key=lambda detail: URGENCY.get(detail["type"], 1))
    path = path_of(first)
    line = None
    if text is not None and source is not None:
        line = line_of_key(text, path, _format(source))
    key = key_text(path) or None
    raise PatchError(message_of(first, Patch), file=source, key=key, line=line)


def load_patch(path: str | os.PathLike[str]) -> Patch:
    """Load a patch from a .toml or .json file.

    Raises `PatchError`: the file is no patch, or one of another version; `DesignError`: it can't
    be read.
    """
    format = format_of(path)
    text = read_text(path, PatchError)
    data = read_data(text, format, os.fspath(path))
    if isinstance(data, dict) and "springform_patch" not in data:
        what = "a design" if "springform" in data else "something else"
        raise PatchError(f"is {what}, no patch: springform_patch is missing", file=path)
    return parse_patch(data, os.fspath(path), text)


def patch_data(patch: Patch) -> dict[str, Any]:
    """Return a patch as plain data, without what is as it is by default."""
    return without_defaults(patch)


def dump_patch(patch: Patch, format: Format) -> str:
    """Return the canonical text of a patch, in TOML or JSON."""
    data = patch_data(patch)
    return json_text(data) if format == "json" else toml_text(data)


def save_patch(patch: Patch, path: str | os.PathLike[str]) -> None:
    """Write a patch to a .toml or .json file, atomically and canonically.

    Raises `DesignError`: another ending. `WriteError`: the file can't be written.
    """
    write_atomically(path, dump_patch(patch, format_of(path)).encode())


def _format(source: str) -> Format:
    return "json" if source.endswith(".json") else "toml"
