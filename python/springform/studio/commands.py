"""What requests do to a document: from a gesture to the action that is journalled."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from .. import design_file
from ..arrays import Floats
from ..design import Design
from ..design_schema import BUILT_IN_CELL_TYPES
from ..errors import DesignError, InputError
from ..evolution import seek
from .changes import Action, Place, ValueChange, values_of
from .changes import forest_action as _forest
from .changes import value_action as _value
from .density import set_density
from .editing_messages import DropSprings, SetDensity, SetSprings
from .messages import (
    EditCells,
    EditSpring,
    FixNode,
    MoveAnchor,
    SeekStress,
    SetFramework,
    SetValue,
)
from .orbits import cell_orbit, spring_orbit, whole_orbit
from .spring_groups import drop_springs, set_springs
from .supports import fix_node, move_anchor


def action_of(design: Design, request: BaseModel, positions: Floats) -> tuple[Action, list[str]]:
    """Return the action that a request asks for, and the cells to show afterwards.

    `positions` are those of the nodes now, (n, 3) [m]. Raises `InputError`: it does not fit.
    """
    match request:
        case EditCells():
            action, cells = edit_cells(design, request)
            return whole_orbit(design, action, cells) if request.orbit else (action, cells)
        case SeekStress():
            return seek_stress(design, request)
        case EditSpring():
            action = edit_spring(design, request)
        case MoveAnchor():
            action = move_anchor(design, request)
        case FixNode():
            action = fix_node(design, request, positions)
        case SetSprings():
            action = set_springs(design, request)
        case DropSprings():
            action = drop_springs(design, request)
        case SetDensity():
            action = set_density(design, request)
        case SetValue():
            action = set_value(design, request)
        case SetFramework():
            action = set_framework(design, request)
        case _:
            raise InputError("is no request that changes a design", key="type")
    return action, []


def edit_cells(design: Design, request: EditCells) -> tuple[Action, list[str]]:
    """Return the action on cells, and the cells to show afterwards."""
    cells = list(dict.fromkeys(request.cells))
    match request.what:
        case "subdivide":
            return _subdivide(design, cells, request.kind)
        case "off":
            parents = list(dict.fromkeys(_parent(cell) for cell in cells))
            return _toggle(parents, "off"), parents
        case "on":
            return _toggle(cells, "on"), _children(cells)
        case "retype":
            return _retype(design, cells, request.kind), cells
        case "turn":
            return _turn(design, cells), cells


def edit_spring(design: Design, request: EditSpring) -> Action:
    """Return the action that cuts or adds a spring, or all springs of its orbit."""
    first, second = request.nodes
    if request.orbit:
        return spring_orbit(design, first, second, request.what)
    _, added, cut = design.setting.notation(design.forest, "")
    pairs = {f"{first} {second}", f"{second} {first}"}
    if request.what == "cut":
        word = "unadd" if pairs & set(added) else "cut"
    else:
        word = "uncut" if pairs & set(cut) else "add"
    label = "Cut a spring" if request.what == "cut" else "Add a spring"
    return _forest(label, [f"{first} {second} {word}"])


def seek_stress(design: Design, request: SeekStress) -> tuple[Action, list[str]]:
    """Return the action that subdivides where the force is, and the last cells that it made."""
    edits: list[str] = []
    steps = 0
    for step in seek(design, steps=request.steps, type=request.kind, symmetry=request.orbit):
        edits += step.edits
        steps, last = step.step, step.edits
    if not steps:
        raise InputError("no cell of this design can be subdivided further")
    label = f"Seek stress, {steps} step{'s' if steps > 1 else ''}"
    divided = [edit.split(" ")[0] for edit in last if edit.split(" ")[1] == "subdivide"][:1]
    if request.orbit:
        return _forest(f"{label}, symmetrically", edits), _children(cell_orbit(design, divided))
    return _forest(label, edits), _children(divided)


def set_value(design: Design, request: SetValue) -> Action:
    """Return the action that changes one value of the design file."""
    if not request.path:
        raise InputError("must name a value", key="path")
    return _value(design, request.label, request.path, request.value)


def renamed(design: Design, name: str) -> Action:
    """Return the action that gives a design another name."""
    return _value(design, f"Rename to {name}", ["name"], name)


def set_framework(design: Design, request: SetFramework) -> Action:
    """Return the action that changes the framework, with the cells that fit it."""
    values = values_of(design)
    label = "Change the framework"
    framework = ValueChange(
        path=["framework"], before=values["framework"], after=dict(request.framework)
    )
    # What the form left out has its default, and stands in the file as such.
    wanted = values | {"framework": framework.after}
    empty = {"type": values["forest"]["type"], "cells": {}}
    bare: dict[str, Any] = {"added": [], "cut": []}
    try:
        after = values_of(Design(design_file.from_data(wanted)))
    except DesignError:
        # What names single nodes can't be carried to another framework.
        groups = [group for group in values["springs"]["groups"] if group["pairs"] is None]
        springs = values["springs"] | {"groups": groups}
        wanted |= {"forest": empty, "overrides": bare, "springs": springs}
        after = values_of(Design(design_file.from_data(wanted)))
    whole = ValueChange(path=[], before=values, after=after)
    return Action(label=label, changes=[whole])


def whole(design: Design, other: Design, label: str, origin: Place | None = None) -> Action:
    """Return the action that puts another design in place of a design; it may come from a run."""
    change = ValueChange(path=[], before=values_of(design), after=values_of(other.closed))
    return Action(label=label, changes=[change], origin=origin)


# --- cells ----------------------------------------------------------------------------------------


def _subdivide(design: Design, cells: list[str], kind: str | None) -> tuple[Action, list[str]]:
    edits = []
    for cell in cells:
        content, _, stored = design.setting.cell(design.forest, cell)
        if stored:
            edits.append(f"{cell} on")
        else:
            child = content if kind is None else kind
            edits.append(f"{cell} subdivide {child} {child} {child} {child}")
    return _forest(_counted("Subdivide", cells), edits), _children(cells)


def _toggle(cells: list[str], state: str) -> Action:
    label = _counted("Merge" if state == "off" else "Bring back", cells)
    return _forest(label, [f"{cell} {state}" for cell in cells])


def _retype(design: Design, cells: list[str], kind: str | None) -> Action:
    if kind is None:
        raise InputError("a new type needs its name", key="kind")
    kind = design.setting.cell_type(kind)
    edits = []
    for cell in cells:
        content, _, _ = design.setting.cell(design.forest, cell)
        if content != kind:
            edits.append(f"{cell} retype {content} {kind}")
    if not edits:
        raise InputError(f"the cells are of type {_type_name(kind)} already")
    return _forest(f"{_counted('Give', cells)} type {_type_name(kind)}", edits)


def _type_name(kind: str) -> str:
    """Return a cell type by number and name; types of one's own have only their name."""
    return f"{kind} {BUILT_IN_CELL_TYPES[int(kind)]}" if kind.isdecimal() else kind


def _turn(design: Design, cells: list[str]) -> Action:
    edits = []
    for cell in cells:
        content, _, _ = design.setting.cell(design.forest, cell)
        kind, _, turn = content.partition("@")
        turned = (int(turn or 0) + 1) % 4
        edits.append(f"{cell} retype {content} {kind}{f'@{turned}' if turned else ''}")
    return _forest(_counted("Turn", cells), edits)


def _parent(cell: str) -> str:
    if "." not in cell:
        raise InputError("is not part of a subdivided cell", key=cell)
    return cell.rsplit(".", 1)[0]


def _children(cells: list[str]) -> list[str]:
    return [f"{cell}.{child}" for cell in cells for child in range(4)]


def _counted(verb: str, cells: list[str]) -> str:
    return f"{verb} cell {cells[0]}" if len(cells) == 1 else f"{verb} {len(cells)} cells"
