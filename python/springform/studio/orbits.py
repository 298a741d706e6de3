"""The symmetry lock: what is done to a cell or spring is done to its whole orbit, or not at all."""

from __future__ import annotations

from typing import Literal

from .. import _core
from ..design import Design
from ..errors import InputError
from ..grafting import edit_orbit, symmetries
from .changes import Action, ForestChange, forest_action
from .graft_messages import SymmetryState


def cell_orbit(design: Design, cells: list[str]) -> list[str]:
    """Return cells with all their images, each once."""
    images = symmetries(design).edits(design.setting, [f"{cell} on" for cell in cells])
    return [line.split(" ")[0] for line in images]


def whole_orbit(design: Design, action: Action, cells: list[str]) -> tuple[Action, list[str]]:
    """Return an action on cells done to all their images too, and the images of `cells`.

    Raises `InputError`: the images can't be edited alike.
    """
    changes = [
        change.model_copy(update={"edits": _images(design, change.edits)})
        if isinstance(change, ForestChange)
        else change
        for change in action.changes
    ]
    label = f"{action.label}, symmetrically"
    return Action(label=label, changes=changes), cell_orbit(design, cells)


def spring_orbit(design: Design, first: str, second: str, what: Literal["cut", "add"]) -> Action:
    """Return the action that cuts or adds a spring and all its images, each once.

    What is cut or there already stays so. Raises `InputError`: an image can't be cut because the
    net has no such spring, or not be added because it lacks a node; nothing would change.
    """
    _, added, cut = design.setting.notation(design.forest, "")
    taken = {_pair(line): "uncut" for line in cut} | {_pair(line): "unadd" for line in added}
    nodes = design.nodes
    known = set(nodes)
    springs = {frozenset((nodes[a], nodes[b])) for a, b in design.network().springs.tolist()}
    edits = []
    for line in edit_orbit(design, [f"{first} {second} add"]):
        a, b, _ = line.split(" ")
        undone = taken.get(frozenset((a, b)))
        if what == "cut" and undone != "uncut":
            if undone is None and frozenset((a, b)) not in springs:
                _refuse(f"{a} {b}", "is no spring of the net")
            edits.append(f"{a} {b} {undone or 'cut'}")
        elif what == "add" and undone == "uncut":
            edits.append(f"{a} {b} uncut")
        elif what == "add" and undone is None and frozenset((a, b)) not in springs:
            missing = [node for node in (a, b) if node not in known]
            if missing:
                _refuse(missing[0], "is no node of the net")
            edits.append(f"{a} {b} add")
    if not edits:
        done = "cut" if what == "cut" else "there"
        raise InputError(f"the spring and its images are {done} already")
    many = "a spring" if len(edits) == 1 else f"{len(edits)} springs"
    return forest_action(f"{what.capitalize()} {many}, symmetrically", edits)


def symmetry_state(design: Design) -> SymmetryState:
    """Return which symmetries a framework has, and whether the net has them too."""
    try:
        group = symmetries(design)
    except InputError as error:
        return SymmetryState(rotations=1, mirrors=0, broken="", problem=error.message)
    mirrors = sum(group.mirrored)
    broken = ""
    try:
        group.check(design.setting, design.closed.forest)
    except _core.CoreError as error:
        broken = error.args[1]
    return SymmetryState(rotations=len(group) - mirrors, mirrors=mirrors, broken=broken, problem="")


def _images(design: Design, edits: list[str]) -> list[str]:
    """Return edits with their images; cells that have the same type by another turn are taken."""
    found = []
    for line in edit_orbit(design, edits):
        words = line.split(" ")
        if words[1] == "retype":
            content = design.setting.cell(design.forest, words[0])[0]
            if content.partition("@")[0] == words[2].partition("@")[0]:
                words[2] = content
        found.append(" ".join(words))
    return found


def _pair(line: str) -> frozenset[str]:
    return frozenset(line.split(" "))


def _refuse(key: str, problem: str) -> None:
    raise InputError(
        f"{problem}, though an image of it is; take the symmetry lock off, or make the net "
        "symmetric first",
        key=key,
    )
