"""The schema of the design file: what a design may say, and what is checked before it is built.

What only the topology core can judge (cell notation, whether a node key or a cell number exists)
stays text here.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal, NamedTuple, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    WithJsonSchema,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from .errors import printable
from .key_lines import KeyPath
from .wording import index_range, nearest, shown

VERSION = 1
"""The format version that this program reads and writes."""

MAXIMUM_LEVEL = 20
"""The deepest `framework.level`."""

MAXIMUM_CELLS = 4_000_000
"""The largest number of cells of a framework at its level, counted before joining."""

BUILT_IN_CELL_TYPES = ("null", "quad", "braced", "diagonal", "strip", "inscribed", "dynamic")
"""Names of the built-in cell types, by number."""

_MAXIMUM_NUMBER = 2**32 - 1  # the core counts cells and vertices in 32 bits
NAME_PATTERN = r"^[a-z][a-z0-9_]*$"
"""What cylinders, sheets and cell types may be called."""

SPRING_PATTERN = r"^(?:c[0-3]|m[0-3]|x)-(?:c[0-3]|m[0-3]|x)$"
"""How a spring of a cell type is written."""

_NODE = r"(?:v[0-9]+|e[0-9]+:[0-9]+/[0-9]+|f[0-9]+:[0-9]+/[0-9]+,[0-9]+/[0-9]+)"


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
        raise _fault(
            (), f"must be a text of whole Unicode characters, not {shown(value)}"
        ) from None
    return value


def _check_title(value: str) -> str:
    if not value.strip() or not value.isprintable():
        raise _fault((), f"must be a text on one line, not {shown(value)}")
    return value


Name = Annotated[str, Field(pattern=NAME_PATTERN)]
Text = Annotated[str, AfterValidator(_check_text)]  # JSON can escape half a character
Title = Annotated[str, Field(min_length=1), AfterValidator(_check_title)]
Spring = Annotated[str, Field(pattern=SPRING_PATTERN)]
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

    springs: Annotated[
        tuple[Annotated[str, Field(pattern=SPRING_PATTERN)], ...], Field(strict=False)
    ] = ()
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


WALK_PATTERN = r"^[flrb]?[flr]*$"
"""How a walk is written."""

FREE_PATTERN = r"^b?r?f?l?$"
"""How free sides are written."""

PATH_PATTERN = r"^([0-3](\.[0-3])*)?$"
"""How a path of children is written."""


class PatchCell(_Section):
    """What a patch holds of one top-level cell."""

    walk: Annotated[str, Field(pattern=WALK_PATTERN)] = ""
    """Steps from the seed across edges: f ahead, l and r to the left and right, b back."""
    free: Annotated[str, Field(pattern=FREE_PATTERN)] = ""
    """Sides that were free edges where it comes from, as the walker sees them."""
    path: Annotated[str, Field(pattern=PATH_PATTERN)] = ""
    """Children down to the cell, as the walker sees them; empty for the top-level cell."""
    cell: str
    """Cell notation, as the walker sees it."""


def _check_patch_cells(cells: tuple[PatchCell, ...]) -> tuple[PatchCell, ...]:
    places = sorted((cell.walk, cell.path) for cell in cells)
    for (walk, above), (other, path) in pairwise(places):
        if walk == other and f"{path}.".startswith(f"{above}." if above else ""):
            raise _fault((), f"walk {shown(walk)}, path {shown(path)} is there twice; remove one")
    if all(cell.walk for cell in cells):
        raise _fault((), 'no cell has the walk ""; the seed is missing')
    return cells


PatchCells = Annotated[
    tuple[PatchCell, ...], Field(strict=False, min_length=1), AfterValidator(_check_patch_cells)
]

CorePatch = tuple[bool, list[tuple[str, list[int], list[tuple[str, str]]]]]
"""A patch as the core takes it: whether corner 0 is an anchor; walk, free sides, subtrees."""

SIDES = "brfl"
"""Sides 0 to 3 of a cell as the walker sees them: back, right, forward, left."""


def core_patch(anchored: bool, cells: tuple[PatchCell, ...]) -> CorePatch:
    """Return cells of a patch as the core takes them."""
    rows: dict[str, tuple[list[int], list[tuple[str, str]]]] = {}
    for cell in cells:
        free = [SIDES.index(side) for side in cell.free]
        rows.setdefault(cell.walk, (free, []))[1].append((cell.path, cell.cell))
    return anchored, [(walk, free, texts) for walk, (free, texts) in rows.items()]


def cells_of(core: CorePatch) -> tuple[PatchCell, ...]:
    """Return the cells of a patch as the core gives it."""
    return tuple(
        PatchCell(walk=walk, free="".join(SIDES[side] for side in free), path=path, cell=text)
        for walk, free, texts in core[1]
        for path, text in texts
    )


class Gene(_Section):
    """A patch that the forest holds by reference, such as `12 = "&crown@1m"`."""

    anchored: bool = False
    """Corner 0 of the seed lies on an anchor."""
    cells: PatchCells
    """Its cells; each changes in all places at once."""


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
    genes: dict[Name, Gene] = {}
    """Patches that the forest holds by reference, by name."""
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


def _boundary(path: KeyPath, name: str, boundaries: dict[str, Boundary]) -> Boundary:
    if name not in boundaries:
        raise _fault(path, f"no boundary is called {shown(name)}; {nearest(name, boundaries)}")
    return boundaries[name]
