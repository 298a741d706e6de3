"""Changes of a design that can be kept and undone: edits of the forest, values of its file."""

from __future__ import annotations

import copy
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from .. import design_file
from ..design import Design
from ..errors import DesignError, InputError

Path = tuple[str | int, ...]
"""Where a value stands in a design file, such as ``("framework", "anchors", 6, "position")``."""


class _Record(BaseModel):
    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


class ForestChange(_Record):
    """Edits of the forest, each a line such as ``12.0 subdivide 1 1 6 1``."""

    of: Literal["forest"] = "forest"
    edits: list[str]


class ValueChange(_Record):
    """A value of the design file, whatever the file may hold."""

    of: Literal["value"] = "value"
    path: list[str | int]
    before: Any
    """As it was, plain data; checked against the design that the change meets."""
    after: Any
    """As it becomes, plain data."""


Change = ForestChange | ValueChange


class Place(_Record):
    """Where a net comes from: a parent or an individual of a run."""

    run: str
    """Folder of the run: within the document's folder, such as ``runs/0001``, or absolute."""
    generation: int
    """0 is the start."""
    individual: int | None
    """None: the parent for the next generation."""

    @property
    def label(self) -> str:
        """In words, such as ``Generation 34, individual 2``."""
        if self.generation == 0:
            return "Start of the run"
        rest = "its parent" if self.individual is None else f"individual {self.individual}"
        return f"Generation {self.generation}, {rest}"


class Action(_Record):
    """What one gesture did: one step of undo."""

    label: str
    """What was done, such as ``Subdivide 3 cells``."""
    changes: list[Change]
    origin: Place | None = None
    """Where the net was taken from, if it was taken over as a whole."""


def apply(design: Design, action: Action) -> Design:
    """Return the design after an action. Raises `DesignError`: it does not fit the design."""
    for change in action.changes:
        design = _changed(design, change)
    return design


def inverse(design: Design, action: Action) -> Action:
    """Return the action that undoes `action`; `design` is any with the same framework."""
    changes: list[Change] = []
    for change in reversed(action.changes):
        if isinstance(change, ForestChange):
            changes.append(ForestChange(edits=design.inverse(change.edits)))
        else:
            swapped = {"before": change.after, "after": change.before}
            changes.append(change.model_copy(update=swapped))
    return action.model_copy(update={"changes": changes})


def values_of(design: Design) -> dict[str, Any]:
    """Return the design's file as plain data: dictionaries, lists, numbers and texts."""
    return design.to_file().model_dump(mode="json")


def value_at(values: Any, path: list[str | int]) -> Any:
    """Return the value at a path. Raises `DesignError`: there is none."""
    for step in path:
        try:
            values = values[step]
        except (LookupError, TypeError):
            raise DesignError("there is no such value", key=_key(path)) from None
    return values


def forest_action(label: str, edits: list[str]) -> Action:
    """Return the action of edits of the forest."""
    return Action(label=label, changes=[ForestChange(edits=edits)])


def value_action(design: Design, label: str, path: list[str | int], after: Any) -> Action:
    """Return the action that changes one value of the design file.

    Raises `InputError`: nothing would change; `DesignError`: no such value, or it is not allowed.
    """
    before = value_at(values_of(design), path)
    change = ValueChange(path=path, before=before, after=after)
    action = Action(label=label, changes=[change])
    # As the file holds it, so that the change can be checked when it is undone.
    kept = value_at(values_of(apply(design, action)), path)
    if kept == before:
        raise InputError("nothing would change", key=".".join(str(step) for step in path))
    return Action(label=label, changes=[change.model_copy(update={"after": kept})])


def _changed(design: Design, change: Change) -> Design:
    if isinstance(change, ForestChange):
        return design.edited(change.edits)
    values = values_of(design)
    if value_at(values, change.path) != change.before:
        raise DesignError("is not as the change says", key=_key(change.path))
    if not change.path:
        return Design(design_file.from_data(change.after))
    value_at(values, change.path[:-1])[change.path[-1]] = copy.deepcopy(change.after)
    return Design(design_file.from_data(values))


def _key(path: list[str | int]) -> str:
    return ".".join(str(step) for step in path) or "design"
