"""The packaged scenes: designs to start from, to test with and to show."""

from __future__ import annotations

import os
from importlib.resources import files
from importlib.resources.abc import Traversable

from .design_file import load, parse
from .design_schema import DesignFile
from .errors import DesignError
from .wording import nearest


def names() -> list[str]:
    """Return the names of the packaged scenes, sorted."""
    entries = (entry.name for entry in _folder().iterdir())
    return sorted(name.removesuffix(".toml") for name in entries if name.endswith(".toml"))


def load_scene(name: str) -> DesignFile:
    """Return the packaged scene called `name`. Raises `DesignError`: there is no such scene."""
    known = names()
    if name not in known:
        raise DesignError(f"there is no scene of this name; {_hint(name, known)}", file=name)
    text = (_folder() / f"{name}.toml").read_text(encoding="utf-8")
    return parse(text, "toml", f"{name}.toml")


def find(design: str | os.PathLike[str]) -> DesignFile:
    """Return the design that `design` names: a packaged scene, or a .toml or .json file.

    Raises `DesignError`: there is neither, or the file is no valid design.
    """
    name = os.fspath(design)
    known = names()
    if name in known:
        return load_scene(name)
    if os.path.isdir(name):
        raise DesignError("is a folder; a run's design is its best.toml", file=name)
    if name.lower().endswith(".obj"):
        raise DesignError("is a mesh; make a design of it: springform init FILE.obj", file=name)
    if os.path.exists(name) or os.path.dirname(name):
        return load(name)
    raise DesignError(f"there is no such file or scene; {_hint(name, known)}", file=name)


def _folder() -> Traversable:
    return files(__package__) / "scenes"


def _hint(name: str, known: list[str]) -> str:
    hint = nearest(name.removesuffix(".toml"), known)
    scenes = f"the scenes are {', '.join(known)}"
    return f"{hint} {scenes}" if hint.startswith("did") else scenes
