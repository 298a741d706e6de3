"""Headers of binary frames."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .message_base import Address, Key, Message


class ArrayHeader(Message):
    """One array of a frame."""

    name: str
    type: Literal["float32", "int32", "uint8"]
    length: int


class NetHeader(Message):
    """A net, as what differs from an earlier one."""

    frame: Literal["net"] = "net"
    revision: int
    base: int | None
    """Revision that runs refer to; None: there are no runs."""
    parts: list[str]
    anchor_names: list[str]
    node_keys: list[Key]
    """Of new nodes."""
    addresses: list[Address]
    """Of new cells."""
    types: list[str]
    """Of new cells."""
    arrays: list[ArrayHeader]


class MotionHeader(Message):
    """Where the net is, and what its springs carry."""

    frame: Literal["motion"] = "motion"
    revision: int
    """Revision of the net that the arrays belong to."""
    steps: int
    """Steps made since the net was last disturbed."""
    running: bool
    settled: bool
    """Nothing will move until something changes."""
    converged: bool
    residual: float | None
    """Largest force out of balance over the mean spring force; None if it is undefined."""
    reason: str
    held: list[int]
    """Nodes that are dragged."""
    held_by: list[float]
    """Force with which each of them is held there [N]."""
    waited: float
    """From the change that it follows until its step began [s]; 0 of later steps."""
    took: float
    """What its step took [s]."""
    arrays: list[ArrayHeader]


class TableHeader(Message):
    """Measures of all individuals from a generation on."""

    frame: Literal["table"] = "table"
    first: int
    """Generation of the first individual."""
    population: int
    arrays: list[ArrayHeader]


Frame = Annotated[NetHeader | MotionHeader | TableHeader, Field(discriminator="frame")]
