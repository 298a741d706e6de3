"""What is wrong with a design file, in words: from the checker's errors to one clear message."""

from __future__ import annotations

from collections.abc import Iterable
from typing import get_args

from pydantic import BaseModel
from pydantic_core import ErrorDetails

from .design_schema import DesignFile
from .key_lines import KeyPath
from .patch_schema import FREE_PATTERN, PATH_PATTERN, WALK_PATTERN
from .schema_base import NAME_PATTERN, SPRING_PATTERN
from .wording import nearest, shown

_MESSAGES = {
    "missing": "is missing; add it",
    "too_short": "is empty; fill it in",
    "string_too_short": "is empty; fill it in",
}

_TYPE_MESSAGES = {
    "int_type": "must be a whole number",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "bool_type": "must be true or false",
    "string_type": "must be a text in quotes",
    "tuple_type": "must be a list",
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "string_unicode": "must be a text of whole Unicode characters",
    "literal_error": "must be {expected}",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge}",
    "less_than_equal": "must be at most {le}",
}
_PATTERN_MESSAGES = {
    NAME_PATTERN: "must be a lower-case letter, then lower-case letters, digits and _",
    WALK_PATTERN: "must be a walk of f, l and r, with b only as its first step",
    FREE_PATTERN: "must be free sides of b, r, f, l, in this order",
    PATH_PATTERN: "must be a path of children 0-3 with dots, like 0.3",
    SPRING_PATTERN: 'must name two points of a cell, like "c0-x" (c0 to c3, m0 to m3, x)',
}
URGENCY = {"extra_forbidden": 0, "missing": 2}
"""Which errors are told first; the rest counts as 1."""


def path_of(error: ErrorDetails) -> KeyPath:
    """Return the path of the key that an error is about."""
    path = tuple(part for part in error["loc"] if part != "[key]")
    if path[:2] == ("forest", "cells"):
        path = tuple(map(str, path))
    return path + tuple(error.get("ctx", {}).get("path", ()))


def message_of(error: ErrorDetails, schema: type[BaseModel] = DesignFile) -> str:
    """Return what is wrong and what to do, in a file of a schema."""
    context = error.get("ctx", {})
    kind, value = error["type"], error["input"]
    if kind == "design":
        return str(context["message"])
    if kind == "extra_forbidden":
        known = _model_at(schema, error["loc"][:-1]).model_fields
        return f"unknown key; {nearest(str(error['loc'][-1]), known)}"
    if kind == "float_type" and isinstance(value, int) and not isinstance(value, bool):
        return "is too large a number; write a smaller one"
    if kind == "string_pattern_mismatch":
        return f"{_PATTERN_MESSAGES[context['pattern']]}, not {shown(value)}"
    if kind in _TYPE_MESSAGES:
        return f"{_TYPE_MESSAGES[kind].format(**context)}, not {shown(value)}"
    return _MESSAGES.get(kind, error["msg"])


def _model_at(model: type[BaseModel], path: Iterable[str | int]) -> type[BaseModel]:
    """Return the section that the table at `path` belongs to."""
    for part in path:
        if isinstance(part, str) and part in model.model_fields:
            model = _section_in(model.model_fields[part].annotation) or model
    return model


def _section_in(annotation: object) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_section_in, get_args(annotation))), None)
