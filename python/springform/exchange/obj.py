"""Base meshes from Wavefront OBJ files: quads only."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ..design_file import from_data
from ..design_schema import DesignFile
from ..errors import DesignError
from ..files import read_text
from ..wording import index_range, shown

Vertex = tuple[float, float, float]
Face = tuple[int, int, int, int]


def read_obj(path: str | os.PathLike[str]) -> tuple[list[Vertex], list[Face]]:
    """Return the vertices [m] and the faces (vertex numbers from 0) of a quad mesh.

    Only `v` and `f` lines count; texture, normals, groups and materials are passed over. Raises
    `DesignError` with the line: the file cannot be read, a face is not a quad, has a corner
    twice or names a vertex that is not there, a number is malformed or not finite, a vertex is in
    no face, there are no faces.
    """
    source = os.fspath(path)
    vertices: list[Vertex] = []
    vertex_lines: list[int] = []
    faces: list[Face] = []
    face_lines: list[int] = []
    for line, words in _statements(read_text(path, DesignError)):
        try:
            if words[0] == "v":
                vertices.append(_vertex(words[1:]))
                vertex_lines.append(line)
            elif words[0] == "f":
                faces.append(_face(words[1:], len(vertices)))
                face_lines.append(line)
        except _MalformedError as error:
            raise DesignError(str(error), file=source, line=line) from None
    if not faces:
        raise DesignError("holds no faces; give a mesh of quads", file=source)

    # A face may name vertices that come after it, so this waits for the end of the file.
    used = bytearray(len(vertices))
    first_lines: dict[frozenset[int], int] = {}
    for face, line in zip(faces, face_lines, strict=True):
        first = first_lines.setdefault(frozenset(face), line)
        if first != line:
            raise DesignError(
                f"the face of line {first} once more; remove one of the two", file=source, line=line
            )
        for number in face:
            if number >= len(vertices):
                raise DesignError(
                    f"face with vertex {number + 1}, but the file has "
                    f"{len(vertices)} vertices; correct the face",
                    file=source,
                    line=line,
                )
            used[number] = True
    loose = used.find(0)
    if loose >= 0:
        raise DesignError(
            f"vertex {loose + 1} is in no face; remove it, or use it in a face",
            file=source,
            line=vertex_lines[loose],
        )
    return vertices, faces


def design_from_obj(
    path: str | os.PathLike[str], anchors: Sequence[int] | None = None
) -> DesignFile:
    """Return a design whose base mesh is the quad mesh in an OBJ file, named after the file.

    `anchors` are vertex numbers from 0 in the order of the file; without them the corners of the
    boundary are anchored, which are the vertices in exactly one face. Anchors are held where the
    mesh has them. Raises `DesignError`: see `read_obj`; an anchor that is not a vertex or is
    there twice; fewer than two anchors.
    """
    source = os.fspath(path)
    vertices, faces = read_obj(path)
    if anchors is None:
        uses = Counter(number for face in faces for number in face)
        anchors = sorted(number for number, count in uses.items() if count == 1)
        if len(anchors) < 2:
            found = "one corner" if anchors else "no corner"
            raise DesignError(
                f"the boundary has {found} to anchor; give two vertices or more with --anchors",
                file=source,
            )
    seen: set[int] = set()
    for number in anchors:
        if not 0 <= number < len(vertices):
            raise DesignError(
                f"no vertex {shown(number)} to anchor; the mesh has "
                f"{index_range(len(vertices), 'vertices')}",
                file=source,
            )
        if number in seen:
            raise DesignError(f"vertex {number} is anchored twice; name it once", file=source)
        seen.add(number)
    if len(anchors) < 2:
        raise DesignError(
            "a net needs two anchors or more; give more vertices with --anchors", file=source
        )

    stem = os.path.splitext(os.path.basename(source))[0]
    return from_data(
        {
            "springform": 1,
            "name": stem if stem.strip() and stem.isprintable() else "mesh",
            "framework": {
                "anchors": [{"vertex": n, "position": list(vertices[n])} for n in anchors],
                "mesh": {"vertices": vertices, "faces": faces},
            },
        },
        source,
    )


class _MalformedError(Exception):
    """A statement that makes no sense; says what is wrong and what to do."""


def _statements(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the words of every statement with the line it begins on."""
    begun: list[str] = []
    first = 0
    for line, row in enumerate(text.split("\n"), start=1):
        content = row.split("#", 1)[0].rstrip()
        if not begun:
            first = line
        begun += content.removesuffix("\\").split()
        if begun and not content.endswith("\\"):
            yield first, begun
            begun = []
    if begun:
        yield first, begun


def _vertex(words: list[str]) -> Vertex:
    # After x y z some programs write a weight or a colour.
    if len(words) < 3:
        raise _MalformedError(f"vertex with {len(words)} numbers; write v x y z")
    x, y, z = (_coordinate(word) for word in words[:3])
    return x, y, z


def _coordinate(word: str) -> float:
    try:
        value = float(word) if "_" not in word else math.nan
    except ValueError:
        raise _MalformedError(f"{shown(word)} is not a number; correct the vertex") from None
    if not math.isfinite(value):
        raise _MalformedError(f"{shown(word)} is not a finite number; correct the vertex")
    return value


def _face(words: list[str], vertex_count: int) -> Face:
    if len(words) != 4:
        raise _MalformedError(
            f"face with {len(words)} corners; springFORM needs quads: quadrangulate the mesh first"
        )
    a, b, c, d = (_corner(word, vertex_count) for word in words)
    if len({a, b, c, d}) < 4:
        raise _MalformedError("face with the same corner twice; correct the face")
    return a, b, c, d


def _corner(word: str, vertex_count: int) -> int:
    number = word.split("/", 1)[0]
    digits = number.removeprefix("-")
    if not (digits.isascii() and digits.isdigit()):
        raise _MalformedError(f"{shown(word)} is not a corner of a face; write vertex numbers")
    if len(digits) > 10 or int(digits) == 0:
        raise _MalformedError(f"face with vertex {shown(number)}; vertices are numbered from 1")
    if digits == number:
        return int(digits) - 1
    if int(digits) > vertex_count:
        raise _MalformedError(
            f"face with vertex {number}, but only {vertex_count} vertices stand before it; "
            "correct the face"
        )
    return vertex_count - int(digits)


def line_obj(positions: NDArray[np.float64], springs: NDArray[np.uint32]) -> str:
    """Return an OBJ text with a vertex a node [m] and a line a spring, for Rhino and others."""
    vertices = (f"v {x!r} {y!r} {z!r}" for x, y, z in positions.tolist())
    lines = (f"l {a + 1} {b + 1}" for a, b in springs.tolist())
    return "\n".join(["# net of springs: v in m, l a spring", *vertices, *lines]) + "\n"
