"""Messages of pins, and of two nets compared."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .changes import Place
from .figure_messages import Figures
from .message_base import Message, Side


class Pin(Message):
    """Pin a net, so that it is at hand whatever becomes of its run."""

    type: Literal["pin"] = "pin"
    id: int
    side: Side


class Unpin(Message):
    """Let a pinned net go."""

    type: Literal["unpin"] = "unpin"
    id: int
    pin: int


class RenamePin(Message):
    """Call a pinned net something else."""

    type: Literal["rename_pin"] = "rename_pin"
    id: int
    pin: int
    label: Annotated[str, Field(min_length=1, max_length=80, pattern=r"^\S(.*\S)?$")]


class PinState(Message):
    """A pinned net."""

    number: int
    label: str
    """What it is called: such as ``Generation 34, individual 2``, until somebody renames it."""
    place: Place | None
    """None: it was the design, after actions of its own."""
    suf: float | None
    """Spring utilization factor in its run; None if it is undefined."""
    figures: Figures


class Pins(Message):
    """What is pinned, in the order in which it was."""

    type: Literal["pins"] = "pins"
    pins: list[PinState]


class Comparing(Message):
    """Ask for two nets, compared."""

    first: Side
    second: Side


class ComparedNet(Message):
    """One of two nets at equilibrium."""

    label: str
    figures: Figures
    force_deviation: float
    """Standard deviation of the forces [N]."""
    load_path: float
    """Sum of force times length [N m]."""
    largest_reaction: float
    """Of all anchors [N]."""


class ComparedCount(Message):
    """Expressed cells of a type."""

    name: str
    first: int
    second: int


class ComparedReaction(Message):
    """What holds an anchor [N]; None where a net does not have it."""

    anchor: str
    first: float | None
    second: float | None


class Compared(Message):
    """Two nets, compared."""

    first: ComparedNet
    second: ComparedNet
    changed: int | None
    """Top-level cells whose subtrees differ; None on different frameworks."""
    types: list[ComparedCount]
    reactions: list[ComparedReaction]
