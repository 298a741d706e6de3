"""What every message between the engine and a window is made of."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Key = Annotated[str, Field(max_length=200)]
Address = Annotated[str, Field(max_length=200)]


class Message(BaseModel):
    """A message, or a part of one: checked strictly, and closed."""

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
        # Whoever reads a message finds every field in it.
        json_schema_serialization_defaults_required=True,
    )
