"""Messages on what springs are made of, and on density."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from .message_base import Message


class SpringChoice(Message):
    """Which springs: those that meet all that is said, all springs if nothing is."""

    parts: list[str] | None = None
    types: list[int | str] | None = None
    levels: list[int] | None = None
    along: list[str] | None = None
    pairs: Annotated[list[Annotated[str, Field(max_length=400)]], Field(max_length=200_000)] | (
        None
    ) = None
    """Springs by their two node keys, such as "v1 e7:1/2"."""


class SetSprings(Message):
    """Say law, unstressed length, sense or section of some springs, as a group of the file does."""

    type: Literal["set_springs"] = "set_springs"
    id: int
    choice: SpringChoice
    says: dict[str, Any]
    """By the keys of `springs.groups`; null takes back what was said of these springs."""


class CurvePoints(Message):
    """A measured curve, as it was read from a CSV file."""

    strains: list[float]
    forces: list[float]
    """Of every test point [N]."""


class DropSprings(Message):
    """Take back all that a group says of its springs."""

    type: Literal["drop_springs"] = "drop_springs"
    id: int
    group: Annotated[int, Field(ge=0)]


class SetDensity(Message):
    """Bring all cells of a cylinder or sheet, or of the net, to one level."""

    type: Literal["set_density"] = "set_density"
    id: int
    part: Annotated[str, Field(max_length=200)] | None = None
    """None: the whole net."""
    level: Annotated[int, Field(ge=0, le=8)]


class SpringGroupLine(Message):
    """A group of springs of the design file, for people."""

    title: str
    """Which springs."""
    says: str
    """What of them."""
