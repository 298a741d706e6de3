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
from collections.abc import Callable, Iterable, Iterator
from typing import Annotated, Any, Literal, NamedTuple, Self, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    WithJsonSchema,
    field_validator,
    model_validator,
)
from pydantic_core import ErrorDetails, PydanticCustomError

from .canonical_text import json_text, toml_text
from .errors import DesignError, printable
from .files import read_text, write_atomically
from .key_lines import Format, KeyPath, line_of_key, repeated_json_key
from .wording import index_range, key_text, nearest, shown

VERSION = 1
"""The format version that this program reads and writes."""

MAXIMUM_LEVEL = 20
"""The deepest `framework.level`."""

MAXIMUM_CELLS = 4_000_000
"""The largest number of cells of a framework at its level, counted before joining."""

BUILT_IN_CELL_TYPES = ("null", "quad", "braced", "diagonal", "strip", "inscribed", "dynamic")
"""Names of the built-in cell types, by number."""

_MAXIMUM_NUMBER = 2**32 - 1  # the core counts cells and vertices in 32 bits
_NAME = r"^[a-z][a-z0-9_]*$"
_SPRING = r"^(?:c[0-3]|m[0-3]|x)-(?:c[0-3]|m[0-3]|x)$"
_NODE = r"(?:v[0-9]+|e[0-9]+:[0-9]+/[0-9]+|f[0-9]+:[0-9]+/[0-9]+,[0-9]+/[0-9]+)"


# --- schema ------------------------------------------------------------------------------------


def _fault(path: KeyPath, message: str) -> PydanticCustomError:
    """An error at `path`, seen from the model that raises it."""
    return PydanticCustomError("design", "{message}", {"message": printable(message), "path": path})


def _rows_of(count: int, what: str) -> BeforeValidator:
    def check(value: object) -> object:
        if not isinstance(value, (list, tuple)) or len(value) != count:
            raise _fault((), f"must be {what}, not {shown(value)}")
        return value

    return BeforeValidator(check)


def _check_text(value: str) -> str:
    try:
        value.encode()
    except UnicodeEncodeError:
        raise _fault((), f"{_TYPE_MESSAGES['string_unicode']}, not {shown(value)}") from None
    return value


def _check_title(value: str) -> str:
    if not value.strip() or not value.isprintable():
        raise _fault((), f"must be a text on one line, not {shown(value)}")
    return value


Name = Annotated[str, Field(pattern=_NAME)]
Text = Annotated[str, AfterValidator(_check_text)]  # JSON can escape half a character
Title = Annotated[str, Field(min_length=1), AfterValidator(_check_title)]
Number = Annotated[int, Field(ge=0, le=_MAXIMUM_NUMBER)]
Count = Annotated[int, Field(ge=1, le=_MAXIMUM_NUMBER)]
Point = Annotated[
    tuple[float, float, float], _rows_of(3, "three numbers [x, y, z]"), Field(strict=False)
]
Face = Annotated[
    tuple[Number, Number, Number, Number],
    _rows_of(4, "four vertex numbers [a, b, c, d]"),
    Field(strict=False),
]


class _Section(BaseModel):
    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True
    )


class Cylinder(_Section):
    """A cylinder of cells, closed around, with a free ring `NAME.start` and one `NAME.end`."""

    name: Name
    """Unique over cylinders and sheets: a lower-case letter, then letters, digits and _."""
    around: Annotated[Count, Field(ge=3)]
    """Number of edges, and of vertices, of each ring."""
    along: Count
    """Number of rows of edges between the two rings."""


class Sheet(_Section):
    """An open patch of cells with the boundaries `NAME.start`, `.end`, `.left` and `.right`."""

    name: Name
    """Unique over cylinders and sheets: a lower-case letter, then letters, digits and _."""
    across: Count
    """Number of edges of `start` and `end`, which run from left to right."""
    along: Count
    """Number of rows between start and end; even on a dia-grid, where `left` and `right` then
    have half as many edges."""


class Arc(_Section):
    """A run of edges on a boundary."""

    ring: str
    """The boundary, such as `trunk.end`."""
    start: Number
    """Index of the arc's first vertex."""
    length: Count
    """Number of edges; on a closed ring the indices run on past the last to 0."""


class Join(_Section):
    """Two arcs of the same length that become one, edge by edge."""

    first: Arc
    """One arc."""
    second: Arc
    """The other arc."""
    reversed: bool = False
    """Whether the first arc's start meets the second one's end."""
    cord: bool = False
    """On a dia-grid: whether a cord runs along the seam, between half diamonds."""


class Anchor(_Section):
    """A node that is held in space: `ring` and `index`, or `vertex`."""

    name: Title | None = None
    """Unique; without it the anchors are called A1, A2, … by their order."""
    ring: str | None = None
    """The boundary, such as `trunk.start`."""
    index: Number | None = None
    """Index of the vertex on the boundary."""
    vertex: Number | None = None
    """Number of the base vertex, instead of `ring` and `index`."""
    position: Point
    """Where the node is held [m]."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.vertex is not None:
            if self.ring is not None or self.index is not None:
                raise _fault((), "has a vertex and a ring; give vertex, or ring and index")
        elif self.ring is None:
            raise _fault((), "is on no node; give ring and index, or vertex")
        elif self.index is None:
            raise _fault((), "has a ring without an index; add index")
        return self


class Mesh(_Section):
    """A base mesh of quads, instead of cylinders, sheets and joins."""

    vertices: Annotated[tuple[Point, ...], Field(strict=False)]
    """Drawn positions [m], one row a vertex; every vertex is in a face."""
    faces: Annotated[tuple[Face, ...], Field(strict=False, min_length=1)]
    """The four vertex numbers of each face, in order around it."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        used = bytearray(len(self.vertices))
        for number, face in enumerate(self.faces):
            for corner, vertex in enumerate(face):
                if vertex >= len(used):
                    raise _fault(
                        ("faces", number, corner),
                        f"{vertex} is no vertex; the mesh has {index_range(len(used), 'vertices')}",
                    )
                used[vertex] = True
            if len(set(face)) < 4:
                raise _fault(("faces", number), "has the same corner twice; give four different")
        loose = used.find(0)
        if loose >= 0:
            raise _fault(("vertices", loose), f"vertex {loose} is in no face; use it or remove it")
        return self


class Boundary(NamedTuple):
    """The size of a ring, or of a sheet's side."""

    edges: int
    vertices: int
    closed: bool


class Framework(_Section):
    """The metatopology: cylinders and sheets with their joins, or a mesh; and the anchors."""

    grid: Literal["quad", "dia"] = "quad"
    """How cells lie in cylinders and sheets: in rows, or as staggered diamonds."""
    level: Annotated[int, Field(ge=0, le=MAXIMUM_LEVEL)] = 0
    """How often every cell is subdivided."""
    cylinders: Annotated[tuple[Cylinder, ...], Field(strict=False)] = ()
    """Cylinders, in the order of their cells' numbers."""
    sheets: Annotated[tuple[Sheet, ...], Field(strict=False)] = ()
    """Sheets, numbered after the cylinders."""
    joins: Annotated[tuple[Join, ...], Field(strict=False)] = ()
    """Which arcs of the boundaries become one."""
    anchors: Annotated[tuple[Anchor, ...], Field(strict=False)] = ()
    """At least two, each on a node of its own."""
    mesh: Mesh | None = None
    """A base mesh instead of cylinders, sheets and joins."""

    def boundaries(self) -> dict[str, Boundary]:
        """Return every boundary by its name, such as `trunk.end` or `patch.left`."""
        found = {}
        for cylinder in self.cylinders:
            for side in ("start", "end"):
                found[f"{cylinder.name}.{side}"] = Boundary(cylinder.around, cylinder.around, True)
        for sheet in self.sheets:
            along = sheet.along // 2 if self.grid == "dia" else sheet.along
            for side, edges in (
                ("start", sheet.across),
                ("end", sheet.across),
                ("left", along),
                ("right", along),
            ):
                found[f"{sheet.name}.{side}"] = Boundary(edges, edges + 1, False)
        return found

    def cell_count(self) -> int:
        """Return the number of cells at `level`, counted before joining."""
        dia = self.grid == "dia"
        count = len(self.mesh.faces) if self.mesh else 0
        for cylinder in self.cylinders:
            count += cylinder.around * (cylinder.along + dia)
        for sheet in self.sheets:
            count += sheet.across * sheet.along
            # The half diamonds at start and end are one row more; those at left and right add
            # one cell to every second row.
            count += (sheet.across + sheet.along // 2) * dia
        return count << 2 * self.level

    def anchor_names(self) -> tuple[str, ...]:
        """Return the name of every anchor: its own, or A1, A2, … by its place in the list."""
        return tuple(anchor.name or f"A{n}" for n, anchor in enumerate(self.anchors, start=1))

    @model_validator(mode="after")
    def _check(self) -> Self:
        self._check_parts()
        self._check_size()
        boundaries = self.boundaries()
        for number, join in enumerate(self.joins):
            self._check_join(("joins", number), join, boundaries)
        for number, anchor in enumerate(self.anchors):
            self._check_anchor(("anchors", number), anchor, boundaries)
        self._check_anchors_differ()
        return self

    def _check_parts(self) -> None:
        if self.mesh:
            for key in ("cylinders", "sheets", "joins"):
                if getattr(self, key):
                    raise _fault((key,), "cannot stand beside a mesh; remove one of the two")
            if self.grid == "dia":
                raise _fault(("grid",), 'must be "quad" for a mesh, whose cells are as drawn')
        elif not self.cylinders and not self.sheets:
            raise _fault((), "has no cylinders, sheets or mesh; add one of them")

        seen = set()
        named: dict[str, tuple[Cylinder | Sheet, ...]]
        named = {"cylinders": self.cylinders, "sheets": self.sheets}
        for key, parts in named.items():
            for number, part in enumerate(parts):
                if part.name in seen:
                    raise _fault(
                        (key, number, "name"), f"{part.name} is used twice; choose another name"
                    )
                seen.add(part.name)
        if self.grid == "dia":
            for number, sheet in enumerate(self.sheets):
                if sheet.along % 2:
                    raise _fault(
                        ("sheets", number, "along"),
                        f"must be even on a dia-grid, not {sheet.along}; "
                        f"write {sheet.along - 1 or 2} or {sheet.along + 1 + (sheet.along == 1)}",
                    )

    def _check_size(self) -> None:
        count = self.cell_count()
        if count > MAXIMUM_CELLS:
            raise _fault(
                ("level",) if self.level else (),
                f"makes {count} cells, more than {MAXIMUM_CELLS}; "
                f"{'lower the level' if self.level else 'make the framework coarser'}",
            )

    def _check_join(self, path: KeyPath, join: Join, boundaries: dict[str, Boundary]) -> None:
        for side, arc in (("first", join.first), ("second", join.second)):
            boundary = _boundary((*path, side, "ring"), arc.ring, boundaries)
            last = boundary.vertices - 1 if boundary.closed else boundary.edges - 1
            if arc.start > last:
                raise _fault(
                    (*path, side, "start"),
                    f"{arc.start} is off the boundary; on {arc.ring} an arc starts at 0 to {last}",
                )
            room = boundary.edges if boundary.closed else boundary.edges - arc.start
            if arc.length > room:
                where = "" if boundary.closed else f" from {arc.start} on"
                raise _fault(
                    (*path, side, "length"),
                    f"{arc.length} is too long; {arc.ring} has {room} edges{where}",
                )
        if join.first.length != join.second.length:
            raise _fault(
                (*path, "second", "length"),
                f"{join.second.length} differs from the first arc's {join.first.length}; "
                "make both arcs equally long",
            )
        if join.first == join.second:
            raise _fault(path, "joins an arc with itself; name two different arcs")

    def _check_anchor(self, path: KeyPath, anchor: Anchor, boundaries: dict[str, Boundary]) -> None:
        if anchor.ring is not None and anchor.index is not None:
            if self.mesh:
                raise _fault((*path, "ring"), "a mesh has no rings; give vertex instead")
            count = _boundary((*path, "ring"), anchor.ring, boundaries).vertices
            if anchor.index >= count:
                raise _fault(
                    (*path, "index"),
                    f"{anchor.index} is out of range; {anchor.ring} has "
                    f"{index_range(count, 'vertices')}",
                )
        elif self.mesh and anchor.vertex is not None and anchor.vertex >= len(self.mesh.vertices):
            raise _fault(
                (*path, "vertex"),
                f"{anchor.vertex} is out of range; the mesh has "
                f"{index_range(len(self.mesh.vertices), 'vertices')}",
            )

    def _check_anchors_differ(self) -> None:
        if len(self.anchors) < 2:
            count = ("no anchor", "one anchor")[len(self.anchors)]
            raise _fault(("anchors",), f"{count}: a net needs two or more; add anchors")
        names: dict[str, int] = {}
        places: dict[tuple[str | int | None, int | None], int] = {}
        corners = dict(self._corners())
        anchor_names = self.anchor_names()
        for number, (name, anchor) in enumerate(zip(anchor_names, self.anchors, strict=True)):
            other = names.setdefault(name, number)
            if other != number:
                raise _fault(
                    ("anchors", number, "name"),
                    f"{name} is also the name of anchor {other + 1}; choose another name",
                )
            place: tuple[str | int | None, int | None] = (anchor.vertex, None)
            if anchor.ring is not None and anchor.index is not None:
                place = corners.get((anchor.ring, anchor.index), (anchor.ring, anchor.index))
            other = places.setdefault(place, number)
            if other != number:
                raise _fault(
                    ("anchors", number),
                    f"{name} is on the same node as {anchor_names[other]}; remove one",
                )

    def _corners(self) -> Iterator[tuple[tuple[str, int], tuple[str, int]]]:
        """Yield the ends of left and right sides as the vertices of start and end they are."""
        boundaries = self.boundaries()
        for sheet in self.sheets:
            for side, index in (("left", 0), ("right", sheet.across)):
                name = f"{sheet.name}.{side}"
                yield (name, 0), (f"{sheet.name}.start", index)
                yield (name, boundaries[name].edges), (f"{sheet.name}.end", index)


def _check_cell_numbers(value: object) -> object:
    if not isinstance(value, dict):
        return value
    cells = {}
    for key, notation in value.items():
        if isinstance(key, str):
            if not re.fullmatch(r"0|[1-9][0-9]{0,9}", key):
                raise _fault((key,), "is not the number of a cell; write a whole number")
            cells[int(key)] = notation
        else:
            cells[key] = notation
    return cells


def _check_number_or_name(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (int, str)):
        raise _fault((), f"must be a type's number or name, not {shown(value)}")
    return value


class ForestSection(_Section):
    """The genotype: what stands in the top-level cells."""

    type: Annotated[int | str, BeforeValidator(_check_number_or_name)] = 1
    """Type of the cells that are not listed: a number, or the name of a type of your own."""
    cells: Annotated[
        dict[Number, Text],
        BeforeValidator(_check_cell_numbers),
        WithJsonSchema(
            {
                "type": "object",
                "patternProperties": {r"^(0|[1-9][0-9]*)$": {"type": "string"}},
                "additionalProperties": False,
            }
        ),
    ] = {}
    """Cell notation by the number of the top-level cell."""

    @field_validator("cells")
    @classmethod
    def _sort(cls, cells: dict[int, str]) -> dict[int, str]:
        return dict(sorted(cells.items()))


class CellTypeDefinition(_Section):
    """A cell type of your own: springs between the named points of a cell."""

    springs: Annotated[tuple[Annotated[str, Field(pattern=_SPRING)], ...], Field(strict=False)] = ()
    """Springs such as "c0-x": corners c0 to c3, edge middles m0 to m3, centre x."""
    perimeter: bool = False
    """Whether the four edges are springs, stitched through every node on them."""
    fan: bool = False
    """Whether the centre has a spring to every node on the boundary."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        seen = set()
        for number, spring in enumerate(self.springs):
            ends = frozenset(spring.split("-"))
            if len(ends) < 2:
                raise _fault(("springs", number), f"{spring} has one end; name two points")
            if ends in seen:
                raise _fault(("springs", number), f"{spring} is there twice; remove one")
            seen.add(ends)
        return self


class Springs(_Section):
    """What every spring is made of."""

    stiffness: Annotated[float, Field(gt=0)] = 1.0
    """Force per length [N/m]."""
    ring_factor: Annotated[float, Field(gt=0)] = 1.0
    """Factor on the stiffness of springs along free rings and free edges of sheets."""


def _check_node_pair(value: str) -> str:
    if not re.fullmatch(f"{_NODE} {_NODE}", value):
        raise _fault(
            (), f'{shown(value)} does not name two nodes; write it like "v1 v17" or "v3 e7:1/2"'
        )
    first, second = value.split(" ")
    if first == second:
        raise _fault((), f"{shown(value)} names one node twice; name two nodes")
    return value


class Overrides(_Section):
    """Springs that a designer added or cut by hand, each as two node keys.

    A node key is `v12` (base vertex), `e7:3/8` (on a base edge) or `f5:1/2,3/4` (in a base face).
    """

    added: Annotated[tuple[str, ...], Field(strict=False)] = ()
    """Springs to add."""
    cut: Annotated[tuple[str, ...], Field(strict=False)] = ()
    """Springs to leave out."""

    @field_validator("added", "cut")
    @classmethod
    def _check(cls, pairs: tuple[str, ...]) -> tuple[str, ...]:
        for number, pair in enumerate(pairs):
            try:
                _check_node_pair(pair)
            except PydanticCustomError as error:
                raise _fault((number,), (error.context or {})["message"]) from None
        return pairs


def _check_version(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int):
        raise _fault((), f"must be the format version, {VERSION}, not {shown(value)}")
    if value != VERSION:
        raise _fault(
            (), f"format version {shown(value)} is not known here; this program reads {VERSION}"
        )
    return value


class DesignFile(_Section):
    """A design of a tensile net, as it stands in a file."""

    springform: Annotated[Literal[1], BeforeValidator(_check_version)]
    """Version of this format."""
    name: Title = "untitled"
    """What the design is called; one line."""
    description: Text = ""
    """What it is about."""
    method: Literal["recursive", "extensible", "dynamic"] = "dynamic"
    """How neighbouring cells of different levels are made to fit."""
    framework: Framework
    """The metatopology and its anchors."""
    forest: ForestSection = ForestSection()
    """The cells; without it all are of type 1 and uniform."""
    cell_types: dict[Name, CellTypeDefinition] = {}
    """Cell types of your own, by name."""
    springs: Springs = Springs()
    """What the springs are made of."""
    overrides: Overrides = Overrides()
    """Springs added and cut by hand."""

    @field_validator("cell_types")
    @classmethod
    def _check_cell_types(
        cls, types: dict[str, CellTypeDefinition]
    ) -> dict[str, CellTypeDefinition]:
        for name in types:
            if name in BUILT_IN_CELL_TYPES:
                raise _fault((name,), f"{name} is a built-in type; choose another name")
        return dict(sorted(types.items()))

    @model_validator(mode="after")
    def _check(self) -> Self:
        kind = self.forest.type
        path = ("forest", "type")
        if isinstance(kind, str) and kind not in self.cell_types:
            raise _fault(path, f"no cell type is called {kind}; {nearest(kind, self.cell_types)}")
        if isinstance(kind, int) and not 0 <= kind < len(BUILT_IN_CELL_TYPES):
            raise _fault(
                path,
                f"no cell type has the number {shown(kind)}; "
                f"write 0 to {len(BUILT_IN_CELL_TYPES) - 1}, or a name from cell_types",
            )
        return self


# --- reading -----------------------------------------------------------------------------------


def parse(text: str, format: Format, source: str | None = None) -> DesignFile:
    """Return the design in a TOML or JSON text.

    `source` is what errors call the text, such as its file name. Raises `DesignError`: the text
    is broken (with its line and column), or is not a valid design (with key and line).
    """
    data = _parse_toml(text, source) if format == "toml" else _parse_json(text, source)
    return from_data(data, source, lambda path: line_of_key(text, path, format))


def load(path: str | os.PathLike[str]) -> DesignFile:
    """Return the design in the file at `path`, which ends in .toml or .json.

    Raises `DesignError`: see `parse`; also where the file cannot be read.
    """
    format = _format_of(path)
    return parse(read_text(path, DesignError), format, os.fspath(path))


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
    first = min(details, key=lambda detail: _URGENCY.get(detail["type"], 1))
    path = _path_of(first)
    message = _message_of(first)
    raise DesignError(message, file=source, key=key_text(path) or None, line=line_of(path))


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


# --- error messages ----------------------------------------------------------------------------

_MESSAGES = {
    "missing": "is missing; add it",
    "too_short": "is empty; fill it in",
    "string_too_short": "is empty; fill it in",
}

_TYPE_MESSAGES = {
    "int_type": "must be a whole number",
    "float_type": "must be a number",
    "finite_number": "must be a finite number",
    "bool_type": "must be true or false",
    "string_type": "must be a text in quotes",
    "tuple_type": "must be a list",
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "string_unicode": "must be a text of whole Unicode characters",
    "literal_error": "must be {expected}",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge}",
    "less_than_equal": "must be at most {le}",
}
_PATTERN_MESSAGES = {
    _NAME: "must be a lower-case letter, then lower-case letters, digits and _",
    _SPRING: 'must name two points of a cell, like "c0-x" (c0 to c3, m0 to m3, x)',
}
_URGENCY = {"extra_forbidden": 0, "missing": 2}


def _path_of(error: ErrorDetails) -> KeyPath:
    path = tuple(part for part in error["loc"] if part != "[key]")
    if path[:2] == ("forest", "cells"):
        path = tuple(map(str, path))
    return path + tuple(error.get("ctx", {}).get("path", ()))


def _message_of(error: ErrorDetails) -> str:
    context = error.get("ctx", {})
    kind, value = error["type"], error["input"]
    if kind == "design":
        return str(context["message"])
    if kind == "extra_forbidden":
        known = _model_at(error["loc"][:-1]).model_fields
        return f"unknown key; {nearest(str(error['loc'][-1]), known)}"
    if kind == "float_type" and isinstance(value, int) and not isinstance(value, bool):
        return "is too large a number; write a smaller one"
    if kind == "string_pattern_mismatch":
        return f"{_PATTERN_MESSAGES[context['pattern']]}, not {shown(value)}"
    if kind in _TYPE_MESSAGES:
        return f"{_TYPE_MESSAGES[kind].format(**context)}, not {shown(value)}"
    return _MESSAGES.get(kind, error["msg"])


def _model_at(path: Iterable[str | int]) -> type[BaseModel]:
    """Return the section that the table at `path` belongs to."""
    model: type[BaseModel] = DesignFile
    for part in path:
        if isinstance(part, str) and part in model.model_fields:
            model = _section_in(model.model_fields[part].annotation) or model
    return model


def _section_in(annotation: object) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(_section_in, get_args(annotation))), None)


def _boundary(path: KeyPath, name: str, boundaries: dict[str, Boundary]) -> Boundary:
    if name not in boundaries:
        raise _fault(path, f"no boundary is called {shown(name)}; {nearest(name, boundaries)}")
    return boundaries[name]


def _format_of(path: str | os.PathLike[str]) -> Format:
    suffix = os.path.splitext(os.fspath(path))[1].lower()
    if suffix == ".toml":
        return "toml"
    if suffix == ".json":
        return "json"
    raise DesignError("a design file ends in .toml or .json; rename it", file=path)


# --- writing -----------------------------------------------------------------------------------

_ALWAYS_WRITTEN = {"springform", "name", "method", "grid"}


def dump(design_file: DesignFile, format: Format) -> str:
    """Return the canonical text of a design, in TOML or JSON."""
    data = _without_defaults(design_file)
    return json_text(data) if format == "json" else toml_text(data)


def save(design_file: DesignFile, path: str | os.PathLike[str]) -> None:
    """Write a design to `path`, as TOML or JSON by its suffix; the file is whole or untouched.

    Raises `DesignError`: another suffix. `WriteError`: the file cannot be written.
    """
    write_atomically(path, dump(design_file, _format_of(path)).encode())


def _without_defaults(section: BaseModel) -> dict[str, Any]:
    table = {}
    for key, field in type(section).model_fields.items():
        value = getattr(section, key)
        if value is not None and (key in _ALWAYS_WRITTEN or value != field.default):
            table[key] = _plain(value)
    return table


def _plain(value: object) -> Any:
    if isinstance(value, BaseModel):
        return _without_defaults(value)
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value
