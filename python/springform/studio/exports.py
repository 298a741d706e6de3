"""A design as files for others: the design file itself, its lines, or tables of its equilibrium."""

from __future__ import annotations

import io
import tempfile
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .. import results
from ..design import Design
from ..design_file import dump
from ..errors import InputError
from ..exchange.obj import line_obj
from ..wording import nearest


@dataclass(frozen=True)
class Export:
    """A file of a design."""

    suffix: str
    """Such as ".toml"."""
    media_type: str
    write: Callable[[Design], bytes]


def _tables(design: Design) -> bytes:
    """Return what `springform solve --out` writes, as one archive."""
    packed = io.BytesIO()
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(packed, "w") as archive:
        equilibrium = design.solve()
        measures = design.measure(equilibrium)
        for path in results.write(design, equilibrium, measures, Path(folder)):
            archive.write(path, path.name, zipfile.ZIP_DEFLATED)
    return packed.getvalue()


def _lines(design: Design) -> bytes:
    return line_obj(design.solve().positions, design.network().springs).encode()


EXPORTS: dict[str, Export] = {
    "toml": Export(
        ".toml", "application/toml", lambda design: dump(design.to_file(), "toml").encode()
    ),
    "json": Export(
        ".json", "application/json", lambda design: dump(design.to_file(), "json").encode()
    ),
    "obj": Export(".obj", "model/obj", _lines),
    "tables": Export(".zip", "application/zip", _tables),
}
"""By the name in the address."""


def export(design: Design, name: str) -> tuple[bytes, str, str]:
    """Return the bytes of a file, its suffix and media type. Raises `InputError`: no such file."""
    if name not in EXPORTS:
        raise InputError(f"is no export; {nearest(name, EXPORTS)}", key=name)
    chosen = EXPORTS[name]
    return chosen.write(design), chosen.suffix, chosen.media_type
