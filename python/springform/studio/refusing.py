"""What a window is told of a message that does not fit, as an answer if it has a number."""

from __future__ import annotations

from pydantic import ValidationError
from pydantic_core import from_json

from .messages import Problem, Reply

_AXES: dict[int | str, str] = dict(enumerate("xyz"))

_LARGEST_NUMBER = 2**53
"""Beyond it windows can't tell numbers of requests apart."""


def not_understood(text: str | bytes, error: ValidationError) -> Reply | Problem:
    """Return the answer to a message that does not fit the declarations.

    A request that is not answered would wait for ever in its window.
    """
    first = error.errors(include_url=False)[0]
    # A request's own name comes first, as the declarations tell them apart by it.
    _, *place = first["loc"] or ("",)
    where = _AXES[place[-1]] if _is_coordinate(place) else ".".join(str(part) for part in place)
    words = first["msg"].replace("Input should be", "must be")
    problem = f"{where}: {words}" if where else words
    number = _number_of(text)
    if number is None:
        return Problem(message=f"not understood: {problem}")
    return Reply(id=number, problem=problem, key=where or None)


def _is_coordinate(place: list[int | str]) -> bool:
    """Return whether a place is a coordinate of a position or direction."""
    return len(place) > 1 and place[-2] in ("position", "line", "plane") and place[-1] in _AXES


def _number_of(text: str | bytes) -> int | None:
    try:
        number = from_json(text)["id"]
    except (ValueError, TypeError, KeyError, IndexError):
        return None
    is_number = isinstance(number, int) and not isinstance(number, bool)
    return number if is_number and 0 <= number <= _LARGEST_NUMBER else None
