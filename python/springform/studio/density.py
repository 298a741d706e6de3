"""Density: all cells of a cylinder, or of the net, brought to one level."""

from __future__ import annotations

from collections.abc import Iterator

from ..design import Design
from ..design_schema import MAXIMUM_CELLS
from ..errors import InputError
from .changes import Action, forest_action
from .editing_messages import SetDensity


def set_density(design: Design, request: SetDensity) -> Action:
    """Return the action that brings all cells of a part, or of the net, to a level.

    Cells that are coarser are subdivided, what was switched off in them comes back; those that are
    finer are merged, and keep their children for later.
    """
    edits: list[str] = []
    merged: set[str] = set()
    for address, level in _cells(design, request.part):
        if level > request.level:
            above = ".".join(address.split(".")[: request.level + 1])
            if above not in merged:
                merged.add(above)
                edits.append(f"{above} off")
        else:
            edits += _subdivisions(design, address, request.level - level)
        if 4 * len(edits) > MAXIMUM_CELLS:
            raise InputError("makes too many cells; choose a lower level", key="level")
    if not edits:
        raise InputError(f"all cells are of level {request.level} already", key="level")
    where = "the net" if request.part is None else request.part
    return forest_action(f"Bring {where} to level {request.level}", edits)


def _cells(design: Design, part: str | None) -> Iterator[tuple[str, int]]:
    """Yield address and level of the expressed cells of a part."""
    framework = design.file.framework
    names = [one.name for one in framework.cylinders] + [one.name for one in framework.sheets]
    if part is not None and part not in names:
        raise InputError("no cylinder or sheet is called that", key=part)
    of_face, _ = design.mesh.map
    cells = design.cells
    for address, (face, level, *_) in zip(cells.addresses, cells.squares.tolist(), strict=True):
        if part is None or names[of_face[face]] == part:
            yield address, level


def _subdivisions(design: Design, address: str, levels: int) -> Iterator[str]:
    if levels <= 0:
        return
    kind, _, stored = design.setting.cell(design.forest, address)
    if stored:
        yield f"{address} on"
        return
    yield from _new(address, kind, levels)


def _new(address: str, kind: str, levels: int) -> Iterator[str]:
    if levels:
        yield f"{address} subdivide {kind} {kind} {kind} {kind}"
        for child in range(4):
            yield from _new(f"{address}.{child}", kind, levels - 1)
