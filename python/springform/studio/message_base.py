"""Pieces of all messages between the engine and a window: numbers with limits, and the base."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Coordinate = Annotated[float, Field(ge=-1e6, le=1e6)]
Vector = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]
Key = Annotated[str, Field(max_length=200)]
Address = Annotated[str, Field(max_length=200)]

Side = Annotated[
    str,
    Field(pattern=r"^(design|pin/[0-9]{1,9}|run/[0-9]{1,9}(/[0-9]{1,9})?)$", max_length=40),
]
"""A net that can be looked at, pinned and compared: ``design``, ``pin/4``, the parent of a
generation of the run, ``run/34``, or an individual of it, ``run/34/2``."""


class Message(BaseModel):
    """What travels as JSON; nothing in it changes."""

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
        # Whoever reads a message finds every field in it.
        json_schema_serialization_defaults_required=True,
    )
