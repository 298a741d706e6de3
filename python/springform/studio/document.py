"""A document: a design and the history of what was done to it. No file, no clock, no selection."""

from __future__ import annotations

from collections.abc import Sequence

from ..design import Design
from ..errors import InputError
from .changes import Action, ForestChange, apply, inverse


class Document:
    """A design that actions change, with undo and redo without limit.

    Attributes: `design` (as it is now, closed), `actions` (all that can be undone or redone, in
    order), `position` (how many of them are done).
    """

    def __init__(
        self, design: Design, actions: Sequence[Action] = (), position: int | None = None
    ) -> None:
        """Start at a design that has `position` of the actions behind it, by default all."""
        self.design = design.closed
        self.actions = list(actions)
        self.position = len(self.actions) if position is None else position

    def prepared(self, action: Action) -> tuple[Action, Design]:
        """Return an action with what its filters write, and the design after it.

        Raises `DesignError`: the action does not fit, or it leaves no net.
        """
        after = apply(self.design, action)
        _, closing = after.setting.closed(after.forest)
        if closing:
            changes = [*action.changes, ForestChange(edits=closing)]
            action = action.model_copy(update={"changes": changes})
            after = after.closed
        after.network()
        return action, after

    def undone(self) -> Design:
        """Return the design before the last action. Raises `InputError`: there is none."""
        if self.position == 0:
            raise InputError("there is nothing to undo")
        return apply(self.design, inverse(self.design, self.actions[self.position - 1]))

    def redone(self) -> Design:
        """Return the design after the action undone last. Raises `InputError`: there is none."""
        if self.position == len(self.actions):
            raise InputError("there is nothing to redo")
        return apply(self.design, self.actions[self.position])

    def done(self, action: Action, design: Design) -> None:
        """Take an action from `prepared`; what was undone before it is gone."""
        self.actions[self.position :] = [action]
        self.position += 1
        self.design = design

    def moved(self, steps: int, design: Design) -> None:
        """Take a design from `undone` (steps -1) or `redone` (steps 1)."""
        self.position += steps
        self.design = design
