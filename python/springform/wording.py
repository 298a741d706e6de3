"""Small pieces of error messages: hints, ranges, values and keys as people read them."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable

from .key_lines import KeyPath


def nearest(word: str, known: Iterable[str]) -> str:
    """Return a hint for a word that is not known: the nearest one that is, or all there are."""
    names = list(known)
    close = difflib.get_close_matches(word, names, n=1)
    if close:
        return f"did you mean {close[0]}?"
    if not names:
        return "there is none"
    more = ", …" if len(names) > 12 else ""
    return f"there are {', '.join(names[:12])}{more}" if len(names) > 1 else f"there is {names[0]}"


def index_range(count: int, what: str) -> str:
    """Return the numbers that `count` things have, such as "vertices 0 to 15"."""
    return f"{what} 0 to {count - 1}" if count else f"no {what}"


def shown(value: object) -> str:
    """Return a value of a file as the file would show it, cut to a readable length."""
    if value is None or isinstance(value, (bool, str)):
        short = f"{value[:39]}…" if isinstance(value, str) and len(value) > 40 else value
        return json.dumps(short, ensure_ascii=False)
    if isinstance(value, int) and abs(value) >= 10**20:
        return "a number of more than 20 digits"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (list, tuple)):
        return f"a list of {len(value)}"
    return "a table" if isinstance(value, dict) else "a date or time"


def key_text(path: KeyPath) -> str:
    """Return a key path as people write it, such as ``framework.joins[2].first``."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += f".{part}" if text else part
    return text
