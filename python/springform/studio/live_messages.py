"""Messages of live evolution and of brushed cells."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from .message_base import Address, Message


class LiveEvolve(Message):
    """Let the net evolve before one's eyes, steer it, and keep or discard what it grew."""

    type: Literal["live_evolve"] = "live_evolve"
    id: int
    what: Literal["start", "pause", "continue", "change", "defaults", "keep", "discard", "restore"]
    """`change` and `defaults` are for parameters, whether something evolves or not; `restore`
    brings back what was discarded last."""
    parameters: dict[str, Any] = Field(default_factory=dict)
    """Of `start` and `change`; others stay as they are."""


class WeighCells(Message):
    """Brush a factor on the chance that evolution changes cells, and what descends from them."""

    type: Literal["weigh_cells"] = "weigh_cells"
    id: int
    cells: Annotated[list[Address], Field(max_length=100_000)]
    """None at all with no factor: all cells."""
    factor: Annotated[float, Field(ge=0, le=1e6)] | None
    """0: keep out; None: as if nothing had been brushed."""


class LivePoint(Message):
    """What a generation of live evolution gave."""

    generation: int
    springs: int
    force_differential: float | None


class LiveState(Message):
    """Live evolution, and the cells that were brushed."""

    type: Literal["live"] = "live"
    status: Literal["none", "running", "paused", "failed"] = "none"
    reason: str = ""
    """Why it failed or stands still; empty: because it was told to."""
    generation: int = 0
    rate: float = 0.0
    """Generations a second."""
    points: list[LivePoint] = Field(default_factory=list)
    """Of the last generations."""
    parameters: dict[str, Any] = Field(default_factory=dict)
    changed: list[str] = Field(default_factory=list)
    """Names of the parameters that differ from their defaults."""
    weights: dict[str, float] = Field(default_factory=dict)
    """Factors by address of cells."""
    restorable: bool = False
    """Whether something was discarded that can be brought back."""
