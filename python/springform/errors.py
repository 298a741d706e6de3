"""Exceptions: one tree, one clear line each."""

from __future__ import annotations

import os


class SpringformError(Exception):
    """Base of every error that springFORM raises on purpose."""


class InputError(SpringformError):
    """Input that cannot be used: a file, a key in it, an argument.

    `str()` gives one printable line, ``FILE:LINE: KEY: what is wrong; what to do``, without the
    parts that are not known. The command line prints it and exits with code 2.

    Attributes: `message` (what is wrong; what to do), `file`, `key` (such as
    ``framework.joins[2].second.length``) and `line` (from 1), each None where unknown.
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | os.PathLike[str] | None = None,
        key: str | None = None,
        line: int | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.file = None if file is None else os.fspath(file)
        self.key = key
        self.line = line

    def __str__(self) -> str:
        place = self.file
        if self.line is not None:
            place = f"{self.file}:{self.line}" if self.file else f"line {self.line}"
        return printable(": ".join(part for part in (place, self.key, self.message) if part))


class DesignError(InputError):
    """A design file, scene or mesh that is broken, or that describes an impossible net."""


class RunError(InputError):
    """A run folder that is missing, broken, or in the way."""


def printable(text: str) -> str:
    """Return `text` on one line, with everything escaped that a terminal cannot show."""
    # Keys and file names come from outside: line breaks, terminal escapes and lone surrogates
    # would break the promise of one line that every terminal can show.
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
