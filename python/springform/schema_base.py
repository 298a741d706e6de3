"""Pieces that all sections of the design file are made of: numbers, names, node keys, faults."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from .errors import printable
from .key_lines import KeyPath
from .wording import shown

_MAXIMUM_NUMBER = 2**32 - 1  # the core counts cells and vertices in 32 bits
NAME_PATTERN = r"^[a-z][a-z0-9_]*$"
"""What cylinders, sheets and cell types may be called."""

SPRING_PATTERN = r"^(?:c[0-3]|m[0-3]|x)-(?:c[0-3]|m[0-3]|x)$"
"""How a spring of a cell type is written."""

NODE_PATTERN = r"(?:v[0-9]+|e[0-9]+:[0-9]+/[0-9]+|f[0-9]+:[0-9]+/[0-9]+,[0-9]+/[0-9]+)"
"""How a node is written: v12, e7:3/8 or f5:1/2,3/4."""


def fault(path: KeyPath, message: str) -> PydanticCustomError:
    """An error at `path`, seen from the model that raises it."""
    return PydanticCustomError("design", "{message}", {"message": printable(message), "path": path})


def _rows_of(count: int, what: str) -> BeforeValidator:
    def check(value: object) -> object:
        if not isinstance(value, (list, tuple)) or len(value) != count:
            raise fault((), f"must be {what}, not {shown(value)}")
        return value

    return BeforeValidator(check)


def _check_text(value: str) -> str:
    try:
        value.encode()
    except UnicodeEncodeError:
        raise fault((), f"must be a text of whole Unicode characters, not {shown(value)}") from None
    return value


def _check_title(value: str) -> str:
    if not value.strip() or not value.isprintable():
        raise fault((), f"must be a text on one line, not {shown(value)}")
    return value


Name = Annotated[str, Field(pattern=NAME_PATTERN)]
Text = Annotated[str, AfterValidator(_check_text)]  # JSON can escape half a character
Title = Annotated[str, Field(min_length=1), AfterValidator(_check_title)]
Spring = Annotated[str, Field(pattern=SPRING_PATTERN)]
Number = Annotated[int, Field(ge=0, le=_MAXIMUM_NUMBER)]
Count = Annotated[int, Field(ge=1, le=_MAXIMUM_NUMBER)]
Point = Annotated[
    tuple[float, float, float], _rows_of(3, "three numbers [x, y, z]"), Field(strict=False)
]
Face = Annotated[
    tuple[Number, Number, Number, Number],
    _rows_of(4, "four vertex numbers [a, b, c, d]"),
    Field(strict=False),
]


class Section(BaseModel):
    """A table of the design file."""

    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


def check_node_pair(value: str) -> str:
    """Return two node keys with a space between. Raises a fault: anything else."""
    if not re.fullmatch(f"{NODE_PATTERN} {NODE_PATTERN}", value):
        raise fault(
            (), f'{shown(value)} does not name two nodes; write it like "v1 v17" or "v3 e7:1/2"'
        )
    first, second = value.split(" ")
    if first == second:
        raise fault((), f"{shown(value)} names one node twice; name two nodes")
    return value


def check_node_pairs(pairs: tuple[str, ...]) -> tuple[str, ...]:
    """Return pairs of node keys, each written with a space. Raises a fault: they aren't."""
    for number, pair in enumerate(pairs):
        try:
            check_node_pair(pair)
        except PydanticCustomError as error:
            raise fault((number,), (error.context or {})["message"]) from None
    return pairs
