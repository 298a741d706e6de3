"""One fixed layout for plain data as TOML or JSON: a row of numbers a line, made for `diff`."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

_WIDTH = 88  # of a list of texts on one line


def toml_text(table: dict[str, Any]) -> str:
    """Return `table` as TOML: tables apart by a blank line, tables in arrays written inline.

    Keys of tables in arrays must be bare keys; values finite numbers, texts, booleans, and lists
    and tables of them.
    """
    return "\n".join(_toml_lines(table, ())).lstrip("\n") + "\n"


def json_text(table: dict[str, Any]) -> str:
    """Return `table` as JSON, indented by two, with every row of numbers on one line.

    Values are finite numbers, texts, booleans, and lists and tables of them.
    """
    return _json_value(table, "\n") + "\n"


def _json_value(value: object, newline: str) -> str:
    """Indent tables and lists of rows; keep a row of numbers or texts on one line."""
    inner = newline + "  "
    if isinstance(value, dict) and value:
        rows = [f"{_scalar(key)}: {_json_value(item, inner)}" for key, item in value.items()]
        return "{" + inner + ("," + inner).join(rows) + newline + "}"
    if isinstance(value, list) and _has_rows(value):
        rows = [_json_value(item, inner) for item in value]
        return "[" + inner + ("," + inner).join(rows) + newline + "]"
    return _scalar(value)


def _toml_lines(table: dict[str, Any], path: tuple[str, ...]) -> Iterator[str]:
    """Yield the lines of a table: its values, then its tables, each after a blank line."""
    tables = {}
    for key, value in table.items():
        if isinstance(value, dict) or _is_table_array(value):
            tables[key] = value
        else:
            yield f"{_toml_key(key)} = {_toml_value(value)}"
    for key, value in tables.items():
        name = ".".join((*path, key))
        if isinstance(value, list):
            for item in value:
                yield f"\n[[{name}]]"
                for item_key, item_value in item.items():
                    yield f"{item_key} = {_toml_value(item_value)}"
        else:
            # A table that only holds tables is there without a header of its own.
            if not value or any(
                not isinstance(item, dict) and not _is_table_array(item) for item in value.values()
            ):
                yield f"\n[{name}]"
            yield from _toml_lines(value, (*path, key))


def _toml_key(key: str) -> str:
    return key if re.fullmatch("[A-Za-z0-9_-]+", key) else _scalar(key)


def _toml_value(value: object) -> str:
    if isinstance(value, dict):
        items = ", ".join(f"{key} = {_toml_value(item)}" for key, item in value.items())
        return f"{{ {items} }}"
    if isinstance(value, list) and _has_rows(value):
        return "[\n" + "".join(f"  {_toml_value(item)},\n" for item in value) + "]"
    return _scalar(value)


def _scalar(value: object) -> str:
    # Numbers, texts and lists of them look the same in JSON and in TOML, but for one character.
    return json.dumps(value, ensure_ascii=False, allow_nan=False).replace("\x7f", "\\u007f")


def _has_rows(value: list[Any]) -> bool:
    """Whether a list is written with one item a line."""
    if any(isinstance(item, (list, dict)) for item in value):
        return True
    return any(isinstance(item, str) for item in value) and len(_scalar(value)) > _WIDTH


def _is_table_array(value: object) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)
