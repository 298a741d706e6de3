"""The design file: its schema, and reading and writing it as TOML or JSON.

Saving is canonical: fixed order, fixed layout, defaults left out, floats at full precision. So a
design that is saved, loaded and saved again gives the same bytes, and two saved designs can be
compared line by line. What only the topology core can judge (cell notation, whether a node key
or a cell number exists) stays text here.
"""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Callable
from typing import Any

from pydantic import BaseModel, ValidationError

from .canonical_text import json_text, toml_text
from .curve_file import read_curve
from .design_messages import URGENCY, message_of, path_of
from .design_schema import DesignFile
from .errors import DesignError
from .files import read_text, write_atomically
from .key_lines import Format, KeyPath, line_of_key, repeated_json_key
from .wording import key_text


def parse(text: str, format: Format, source: str | None = None) -> DesignFile:
    """Return the design in a TOML or JSON text.

    `source` is what errors call the text, such as its file name. Raises `DesignError`: the text
    is broken (with its line and column), or is not a valid design (with key and line).
    """
    return from_data(
        read_data(text, format, source), source, lambda path: line_of_key(text, path, format)
    )


def read_data(text: str, format: Format, source: str | None = None) -> object:
    """Return the tables and lists in a TOML or JSON text. Raises `DesignError`: it is broken."""
    return _parse_toml(text, source) if format == "toml" else _parse_json(text, source)


def load(path: str | os.PathLike[str]) -> DesignFile:
    """Return the design in the file at `path`, which ends in .toml or .json.

    Raises `DesignError`: see `parse`; also where the file cannot be read.
    """
    format = format_of(path)
    text, source = read_text(path, DesignError), os.fspath(path)
    data = read_data(text, format, source)
    _read_curves(data, os.path.dirname(source))
    return from_data(data, source, lambda path: line_of_key(text, path, format))


def from_data(
    data: object,
    source: str | None = None,
    line_of: Callable[[KeyPath], int | None] = lambda path: None,
) -> DesignFile:
    """Return the design in `data`: dictionaries, lists, numbers and texts, as in a JSON file.

    `line_of` gives the line of a key path. Raises `DesignError`: not a valid design.
    """
    try:
        return DesignFile.model_validate(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
    # A misspelt key is also a missing one: say first what was written, then what was not.
    first = min(details, key=lambda detail: URGENCY.get(detail["type"], 1))
    path = path_of(first)
    message = message_of(first)
    raise DesignError(message, file=source, key=key_text(path) or None, line=line_of(path))


def _read_curves(data: object, folder: str) -> None:
    """Put the points of CSV files in place of their names: a design holds all that it needs."""
    springs = data.get("springs") if isinstance(data, dict) else None
    groups = springs.get("groups") if isinstance(springs, dict) else None
    for group in groups if isinstance(groups, list) else ():
        if isinstance(group, dict) and isinstance(name := group.get("curve"), str):
            group["curve"] = [
                list(point) for point in read_curve(os.path.join(folder, name), DesignError)
            ]


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of the design file."""
    schema = DesignFile.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | schema


_TOML_PLACE = re.compile(
    r"(?P<what>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)", re.DOTALL
)


def _parse_toml(text: str, source: str | None) -> object:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = _TOML_PLACE.fullmatch(str(error))
        if place is None:
            raise _broken("TOML", str(error), source) from error
        line = int(place["line"] or text.count("\n") + 1)
        column = f"column {place['column']}: " if place["column"] else "at the end: "
        raise _broken("TOML", column + place["what"], source, line) from error
    except RecursionError as error:
        raise _broken("TOML", "lists or tables are nested too deeply", source) from error
    except ValueError as error:  # Python reads no whole number of more than 4,300 digits
        raise _broken("TOML", "a number has too many digits", source) from error


def _parse_json(text: str, source: str | None) -> object:
    try:
        return json.loads(text, object_pairs_hook=_unique_keys)
    except _RepeatedKeyError as error:
        key, line = repeated_json_key(text) or (str(error), None)
        raise DesignError(
            "the key is there twice; remove one", file=source, key=key, line=line
        ) from error
    except json.JSONDecodeError as error:
        what = f"column {error.colno}: {error.msg}"
        raise _broken("JSON", what, source, error.lineno) from error
    except RecursionError as error:
        raise _broken("JSON", "lists or objects are nested too deeply", source) from error
    except ValueError as error:
        raise _broken("JSON", "a number has too many digits", source) from error


class _RepeatedKeyError(Exception):
    pass


def _unique_keys(pairs: list[tuple[str, object]]) -> dict[str, object]:
    table = dict(pairs)
    if len(table) < len(pairs):
        seen = set()
        for key, _ in pairs:
            if key in seen:
                raise _RepeatedKeyError(key)
            seen.add(key)
    return table


def _broken(format: str, what: str, source: str | None, line: int | None = None) -> DesignError:
    return DesignError(f"broken {format}, {what}; correct it", file=source, line=line)


def format_of(path: str | os.PathLike[str]) -> Format:
    """Return the format of a file by its ending. Raises `DesignError`: another ending."""
    suffix = os.path.splitext(os.fspath(path))[1].lower()
    if suffix == ".toml":
        return "toml"
    if suffix == ".json":
        return "json"
    raise DesignError("the file must end in .toml or .json; rename it", file=path)


def to_data(design_file: DesignFile) -> dict[str, Any]:
    """Return a design as dictionaries, lists, numbers and texts, which `from_data` takes."""
    return without_defaults(design_file)


_ALWAYS_WRITTEN = {"springform", "springform_patch", "name", "method", "grid", "walk"}


def dump(design_file: DesignFile, format: Format) -> str:
    """Return the canonical text of a design, in TOML or JSON."""
    data = to_data(design_file)
    return json_text(data) if format == "json" else toml_text(data)


def save(design_file: DesignFile, path: str | os.PathLike[str]) -> None:
    """Write a design to `path`, as TOML or JSON by its suffix; the file is whole or untouched.

    Raises `DesignError`: another suffix. `WriteError`: the file cannot be written.
    """
    write_atomically(path, dump(design_file, format_of(path)).encode())


def without_defaults(section: BaseModel) -> dict[str, Any]:
    """Return a section as plain data, without what is as it is by default."""
    table = {}
    for key, field in type(section).model_fields.items():
        value = getattr(section, key)
        if value is not None and (key in _ALWAYS_WRITTEN or value != field.default):
            table[key] = _plain(value)
    return table


def _plain(value: object) -> Any:
    if isinstance(value, BaseModel):
        return without_defaults(value)
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value
