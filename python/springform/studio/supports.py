"""Supports: nodes that are held, slide along axes, on a line or in a plane, or are let go."""

from __future__ import annotations

from typing import Any

from ..arrays import Floats
from ..design import Design
from ..errors import DesignError, InputError
from .changes import Action, value_action, value_at, values_of
from .messages import FixNode, MoveAnchor

_PATH: list[str | int] = ["framework", "anchors"]


def move_anchor(design: Design, request: MoveAnchor) -> Action:
    """Return the action that holds an anchor elsewhere."""
    try:
        number = design.anchor_names.index(request.anchor)
    except ValueError:
        raise DesignError("there is no anchor of this name", key=request.anchor) from None
    path = [*_PATH, number, "position"]
    return value_action(design, f"Move anchor {request.anchor}", path, request.position)


def fix_node(design: Design, request: FixNode, positions: Floats) -> Action:
    """Return the action that makes a node an anchor where it is now, changes how an anchor is
    held, or lets it go.
    """
    anchors: list[dict[str, Any]] = value_at(values_of(design), _PATH)
    # Names that stand for places in the list must not move to other anchors.
    named = [
        anchor | {"name": name} for anchor, name in zip(anchors, design.anchor_names, strict=True)
    ]
    row = _row(design, request.node)
    held = design.anchors.tolist()
    support = {"holds": request.holds, "line": request.line, "plane": request.plane}
    if not request.fixed:
        if row not in held:
            raise InputError("is no anchor", key=request.node)
        number = held.index(row)
        label = f"Let go anchor {design.anchor_names[number]}"
        return value_action(design, label, _PATH, named[:number] + named[number + 1 :])
    place = [round(value, 6) for value in positions[row].tolist()]
    if row in held:
        number = held.index(row)
        if _support(anchors[number]) == support:
            raise InputError("is held like that already", key=request.node)
        # A node that has slid stays where it is.
        changed = anchors[number] | support | {"position": place}
        label = f"Anchor {design.anchor_names[number]} {_told(request)}"
        return value_action(design, label, [*_PATH, number], changed)
    if not request.node.startswith("v"):
        problem = "lies inside a cell or on an edge; only corners of top-level cells can be held"
        raise InputError(problem, key=request.node)
    name = _free_name(design)
    new = {"name": name, "vertex": int(request.node[1:]), "position": place} | support
    label = f"Hold a node as anchor {name}"
    return value_action(design, label, _PATH, [*named, new])


def _support(anchor: dict[str, Any]) -> dict[str, Any]:
    return {key: anchor[key] for key in ("holds", "line", "plane")}


def _told(request: FixNode) -> str:
    if request.line is not None:
        return "slides on a line"
    if request.plane is not None:
        return "slides in a plane"
    free = [axis for axis in "xyz" if axis not in request.holds]
    return f"slides along {' and '.join(free)}" if free else "is fixed"


def _row(design: Design, node: str) -> int:
    try:
        return design.nodes.index(node)
    except ValueError:
        raise DesignError("is no node of the net", key=node) from None


def _free_name(design: Design) -> str:
    number = len(design.anchor_names) + 1
    while f"A{number}" in design.anchor_names:
        number += 1
    return f"A{number}"
