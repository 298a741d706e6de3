"""The line of a key in a TOML or JSON text, for error messages."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Literal, NamedTuple

Format = Literal["toml", "json"]
KeyPath = tuple[str | int, ...]

_Path = tuple[str, ...]  # indices as text, so that a table key "12" and an index 12 look alike

_TOKEN = re.compile(
    r"""(?P<text>\"{3}(?:\\.|[^\\])*?\"{3,5} | '{3}.*?'{3,5} | "(?:\\.|[^"\\\n])*" | '[^'\n]*')
      | (?P<comment>\#[^\n]*)
      | (?P<newline>\n)
      | (?P<mark>[\[\]{},:=])
      | (?P<bare>[^\s\[\]{},:=\#"']+)""",
    re.VERBOSE | re.DOTALL,
)
_KEY_PART = re.compile(r""""(?:\\.|[^"\\])*"|'[^']*'|[^\s."']+""")


def line_of_key(text: str, path: KeyPath, format: Format) -> int | None:
    """Return the 1-based line where the key at `path` stands in `text`.

    `path` holds keys and array indices, such as ``("framework", "joins", 2, "first")``. Where the
    key is not written, the line of the nearest enclosing key that is; None when there is none.
    `text` should be valid TOML or JSON: in a broken text the answer is a guess, never an error.
    """
    wanted = tuple(map(str, path))
    lines: dict[_Path, int] = {}
    for full_place, line in _places(text, format):
        place = full_place[: len(wanted)]
        for length in range(len(place), 0, -1):
            if place[:length] in lines:
                break
            lines[place[:length]] = line
    for length in range(len(wanted), 0, -1):
        if wanted[:length] in lines:
            return lines[wanted[:length]]
    return None


def repeated_json_key(text: str) -> tuple[str, int] | None:
    """Return the first key, with its line, that a JSON object holds for the second time."""
    seen: set[_Path] = set()
    for place, line in _places(text, "json"):
        if place in seen:
            return place[-1], line
        seen.add(place)
    return None


class _Token(NamedTuple):
    kind: str
    text: str
    line: int


class _Container:
    """A table or an array that is open at the current token."""

    def __init__(self, kind: Literal["table", "array"], path: _Path) -> None:
        self.kind = kind
        self.path = path
        self.value_path = path  # of the value that is read, or was read last
        self.items = 0
        self.key: list[str] = []
        self.expects: Literal["key", "value", "end"] = "key" if kind == "table" else "value"


def _tokens(text: str) -> Iterator[_Token]:
    line, position = 1, 0
    for match in _TOKEN.finditer(text):
        line += text.count("\n", position, match.start())
        position = match.start()
        if match.lastgroup and match.lastgroup != "comment":
            yield _Token(match.lastgroup, match.group(), line)


def _places(text: str, format: Format) -> Iterator[tuple[_Path, int]]:
    """Yield the path and line of every key and array item, in the order of the text."""
    tokens = _tokens(text)
    separator = "=" if format == "toml" else ":"
    root = _Container("table", ())
    root.expects = "key" if format == "toml" else "value"  # all of a JSON text is one value
    stack = [root]
    table_counts: dict[_Path, int] = {}

    for token in tokens:
        top = stack[-1]
        if token.kind == "newline":
            if top is root and format == "toml":
                top.expects, top.key = "key", []
        elif token.text in ("]", "}") and len(stack) > 1:
            stack.pop()
        elif token.text == ",":
            top.expects = "key" if top.kind == "table" else "value"
        elif top.expects == "key":
            if token.text == "[":
                top.path = _header(tokens, table_counts)
                yield top.path, token.line
                top.expects = "end"
            elif token.text == separator:
                top.value_path = top.path + _parts(top.key)
                yield top.value_path, token.line
                top.expects, top.key = "value", []
            else:
                top.key.append(token.text)
        elif top.expects == "value":
            if top.kind == "array":
                top.value_path = (*top.path, str(top.items))
                top.items += 1
                yield top.value_path, token.line
            top.expects = "end"
            if token.text in ("[", "{"):
                stack.append(_Container("array" if token.text == "[" else "table", top.value_path))


def _header(tokens: Iterator[_Token], table_counts: dict[_Path, int]) -> _Path:
    """Read ``[a.b]`` or ``[[a.b]]`` after its first bracket; return the path of the table."""
    words: list[str] = []
    is_array = False
    for token in tokens:
        if token.text == "[" and not words:
            is_array = True
        elif token.text in ("]", "\n"):
            break
        else:
            words.append(token.text)

    parts = _parts(words)
    path: _Path = ()
    for depth, part in enumerate(parts, start=1):
        path = (*path, part)
        if is_array and depth == len(parts):
            table_counts[path] = table_counts.get(path, 0) + 1
        if path in table_counts:
            path = (*path, str(table_counts[path] - 1))
    return path


def _parts(words: list[str]) -> _Path:
    """Split a dotted key, given as its tokens."""
    return tuple(_unquoted(part) for part in _KEY_PART.findall("".join(words)))


def _unquoted(part: str) -> str:
    if part.startswith("'"):
        return part[1:-1]
    if part.startswith('"'):
        try:
            return str(json.loads(part))
        except ValueError:
            return part[1:-1]
    return part
