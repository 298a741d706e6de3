"""Helpers of the tests that drive the command line as its users and their scripts do."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import Any
from unittest import mock

import springform as sf
from springform import cli

COMMAND = str(Path(sysconfig.get_path("scripts")) / "springform")
QUICK = ("--population", "6", "--generations", "4")


@dataclass(frozen=True)
class Result:
    """What a command left: its exit code and its two streams."""

    code: int
    out: str
    err: str

    @property
    def report(self) -> dict[str, Any]:
        """The one JSON object on standard output; anything else there, or NaN, is an error."""
        found = json.loads(self.out, parse_constant=_refuse_constant)
        assert isinstance(found, dict)
        assert self.out.count("\n") == 1
        return found


def _refuse_constant(word: str) -> None:
    raise AssertionError(f"{word} is no JSON")


def springform(*words: str | Path, **options: Any) -> Result:
    """Run the command in a process of its own; options go to `subprocess.run`."""
    command = [COMMAND, *map(str, words)]
    options = {"capture_output": True, "text": True, "timeout": 120} | options
    done = subprocess.run(command, check=False, **options)
    return Result(done.returncode, done.stdout, done.stderr)


def start(*words: str | Path, **options: Any) -> subprocess.Popen[str]:
    """Start the command and return its process, streams piped."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([COMMAND, *map(str, words)], **(pipes | options))


def in_process(*words: str | Path) -> Result:
    """Run what the command runs, in this process: the same code up to the interpreter's exit."""
    out, err = StringIO(), StringIO()
    argv = [COMMAND, *map(str, words)]
    with mock.patch.object(sys, "argv", argv), redirect_stdout(out), redirect_stderr(err):
        try:
            cli.main()
        except SystemExit as request:
            code = request.code
    assert isinstance(code, int)
    return Result(code, out.getvalue(), err.getvalue())


def done(*words: str | Path) -> Result:
    """Run a command that must end well."""
    result = in_process(*words)
    assert result.code == 0, result
    return result


def evolved(*words: str, out: str = "run", scene: str = "one-cylinder") -> sf.Run:
    """Evolve a little from the command line."""
    done("evolve", scene, "--out", out, *QUICK, *words)
    return sf.open_run(out)


def sought(*words: str, scene: str = "one-cylinder", out: str = "out.toml") -> dict[str, Any]:
    """Seek stress from the command line; return what it says."""
    return done("seek", scene, "--out", out, "--json", *words).report


def assert_refused(result: Result, *parts: str) -> None:
    """Assert that a command said on one line what was wrong, and nothing else."""
    assert result.code == 2, result
    assert result.out == "", result
    assert result.err.count("\n") == 1, result
    assert result.err.startswith("springform: "), result
    assert result.err.isprintable() or result.err[:-1].isprintable(), result
    assert "Traceback" not in result.err
    for part in parts:
        assert part in result.err, result


def contents(folder: Path) -> dict[str, str]:
    """Hashes of all files below a folder by path, and folders."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        if path.is_file()
        else "folder"
        for path in sorted(folder.rglob("*"))
    }


def assert_untouched(folder: Path, act: Callable[[], Any]) -> Any:
    """Assert that an act leaves every file below a folder as it is; return what it returns."""
    before = contents(folder)
    result = act()
    assert contents(folder) == before
    return result


def environment(**changes: str) -> dict[str, str]:
    """The environment with changes."""
    return dict(os.environ) | changes


def refused(*words: str | Path, run: Callable[..., Result] = in_process) -> str:
    """Run a command that must be refused and change no file; return its one line."""
    result: Result = assert_untouched(Path.cwd(), lambda: run(*words))
    assert_refused(result)
    return result.err


def assert_says(line: str, *parts: str) -> None:
    """A line has all these parts."""
    for part in parts:
        assert part in line, line
