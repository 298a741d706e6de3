"""The schema of the design file: what a design may say, and what is checked before it is built.

What only the topology core can judge (cell notation, whether a node key or a cell number exists)
stays text here.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal, NamedTuple, Self

from pydantic import (
    BeforeValidator,
    Field,
    WithJsonSchema,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from .key_lines import KeyPath
from .patch_schema import Gene
from .rigging_schema import Loads, Rod, Springs, check_direction
from .schema_base import (
    SPRING_PATTERN,
    Count,
    Face,
    Name,
    Number,
    Point,
    Section,
    Text,
    Title,
    check_node_pairs,
    fault,
)
from .wording import index_range, nearest, shown

VERSION = 1
"""The format version that this program reads and writes."""

MAXIMUM_LEVEL = 20
"""The deepest `framework.level`."""

MAXIMUM_CELLS = 4_000_000
"""The largest number of cells of a framework at its level, counted before joining."""

BUILT_IN_CELL_TYPES = ("null", "quad", "braced", "diagonal", "strip", "inscribed", "dynamic")
"""Names of the built-in cell types, by number."""


class Cylinder(Section):
    """A cylinder of cells, closed around, with a free ring `NAME.start` and one `NAME.end`."""

    name: Name
    """Unique over cylinders and sheets: a lower-case letter, then letters, digits and _."""
    around: Annotated[Count, Field(ge=3)]
    """Number of edges, and of vertices, of each ring."""
    along: Count
    """Number of rows of edges between the two rings."""


class Sheet(Section):
    """An open patch of cells with the boundaries `NAME.start`, `.end`, `.left` and `.right`."""

    name: Name
    """Unique over cylinders and sheets: a lower-case letter, then letters, digits and _."""
    across: Count
    """Number of edges of `start` and `end`, which run from left to right."""
    along: Count
    """Number of rows between start and end; even on a dia-grid, where `left` and `right` then
    have half as many edges."""


class Arc(Section):
    """A run of edges on a boundary."""

    ring: str
    """The boundary, such as `trunk.end`."""
    start: Number
    """Index of the arc's first vertex."""
    length: Count
    """Number of edges; on a closed ring the indices run on past the last to 0."""


class Join(Section):
    """Two arcs of the same length that become one, edge by edge."""

    first: Arc
    """One arc."""
    second: Arc
    """The other arc."""
    reversed: bool = False
    """Whether the first arc's start meets the second one's end."""
    cord: bool = False
    """On a dia-grid: whether a cord runs along the seam, between half diamonds."""


class Anchor(Section):
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
    """Where the node is held [m], or where it starts along what it is free to follow."""
    holds: Literal["x", "y", "z", "xy", "xz", "yz", "xyz"] = "xyz"
    """Along which axes the node is held."""
    line: Point | None = None
    """Direction of a line through `position` on which the node slides."""
    plane: Point | None = None
    """Normal of a plane through `position` in which the node slides."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_direction("line", self.line)
        check_direction("plane", self.plane)
        if self.line is not None and self.plane is not None:
            raise fault((), "slides on a line and in a plane; give line or plane")
        if self.holds != "xyz" and (self.line is not None or self.plane is not None):
            raise fault(("holds",), "cannot stand beside line or plane; remove one of them")
        if self.vertex is not None:
            if self.ring is not None or self.index is not None:
                raise fault((), "has a vertex and a ring; give vertex, or ring and index")
        elif self.ring is None:
            raise fault((), "is on no node; give ring and index, or vertex")
        elif self.index is None:
            raise fault((), "has a ring without an index; add index")
        return self


class Mesh(Section):
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
                    raise fault(
                        ("faces", number, corner),
                        f"{vertex} is no vertex; the mesh has {index_range(len(used), 'vertices')}",
                    )
                used[vertex] = True
            if len(set(face)) < 4:
                raise fault(("faces", number), "has the same corner twice; give four different")
        loose = used.find(0)
        if loose >= 0:
            raise fault(("vertices", loose), f"vertex {loose} is in no face; use it or remove it")
        return self

    def rims(self) -> dict[str, tuple[int, ...]]:
        """Return the vertices around every open rim, the first once more at the end, by its name:
        `rim.1`, `rim.2` and so on in the order of their lowest vertices.

        A rim starts at its lowest vertex, towards the lower of its neighbours. Raises a fault: rims
        meet at a vertex.
        """
        faces_of = Counter(
            frozenset(pair) for face in self.faces for pair in pairwise((*face, face[0]))
        )
        beside: dict[int, list[int]] = {}
        for a, b in (sorted(edge) for edge, count in faces_of.items() if count == 1):
            beside.setdefault(a, []).append(b)
            beside.setdefault(b, []).append(a)
        for vertex, others in sorted(beside.items()):
            if len(others) != 2:
                raise fault(
                    (), f"the rims of the mesh meet at vertex {vertex}; give vertices instead"
                )
        found: dict[str, tuple[int, ...]] = {}
        left = set(beside)
        while left:
            start = min(left)
            rim = [start, min(beside[start])]
            while rim[-1] != start:
                rim.append(next(one for one in beside[rim[-1]] if one != rim[-2]))
            found[f"rim.{len(found) + 1}"] = tuple(rim)
            left -= set(rim)
        return found


class Boundary(NamedTuple):
    """The size of a ring, or of a sheet's side."""

    edges: int
    vertices: int
    closed: bool


class Framework(Section):
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
                    raise fault((key,), "cannot stand beside a mesh; remove one of the two")
            if self.grid == "dia":
                raise fault(("grid",), 'must be "quad" for a mesh, whose cells are as drawn')
        elif not self.cylinders and not self.sheets:
            raise fault((), "has no cylinders, sheets or mesh; add one of them")

        seen = set()
        named: dict[str, tuple[Cylinder | Sheet, ...]]
        named = {"cylinders": self.cylinders, "sheets": self.sheets}
        for key, parts in named.items():
            for number, part in enumerate(parts):
                if part.name in seen:
                    raise fault(
                        (key, number, "name"), f"{part.name} is used twice; choose another name"
                    )
                seen.add(part.name)
        if self.grid == "dia":
            for number, sheet in enumerate(self.sheets):
                if sheet.along % 2:
                    raise fault(
                        ("sheets", number, "along"),
                        f"must be even on a dia-grid, not {sheet.along}; "
                        f"write {sheet.along - 1 or 2} or {sheet.along + 1 + (sheet.along == 1)}",
                    )

    def _check_size(self) -> None:
        count = self.cell_count()
        if count > MAXIMUM_CELLS:
            raise fault(
                ("level",) if self.level else (),
                f"makes {count} cells, more than {MAXIMUM_CELLS}; "
                f"{'lower the level' if self.level else 'make the framework coarser'}",
            )

    def _check_join(self, path: KeyPath, join: Join, boundaries: dict[str, Boundary]) -> None:
        for side, arc in (("first", join.first), ("second", join.second)):
            boundary = _boundary((*path, side, "ring"), arc.ring, boundaries)
            last = boundary.vertices - 1 if boundary.closed else boundary.edges - 1
            if arc.start > last:
                raise fault(
                    (*path, side, "start"),
                    f"{arc.start} is off the boundary; on {arc.ring} an arc starts at 0 to {last}",
                )
            room = boundary.edges if boundary.closed else boundary.edges - arc.start
            if arc.length > room:
                where = "" if boundary.closed else f" from {arc.start} on"
                raise fault(
                    (*path, side, "length"),
                    f"{arc.length} is too long; {arc.ring} has {room} edges{where}",
                )
        if join.first.length != join.second.length:
            raise fault(
                (*path, "second", "length"),
                f"{join.second.length} differs from the first arc's {join.first.length}; "
                "make both arcs equally long",
            )
        if join.first == join.second:
            raise fault(path, "joins an arc with itself; name two different arcs")

    def _check_anchor(self, path: KeyPath, anchor: Anchor, boundaries: dict[str, Boundary]) -> None:
        if anchor.ring is not None and anchor.index is not None:
            if self.mesh:
                raise fault((*path, "ring"), "a mesh has no rings; give vertex instead")
            count = _boundary((*path, "ring"), anchor.ring, boundaries).vertices
            if anchor.index >= count:
                raise fault(
                    (*path, "index"),
                    f"{anchor.index} is out of range; {anchor.ring} has "
                    f"{index_range(count, 'vertices')}",
                )
        elif self.mesh and anchor.vertex is not None and anchor.vertex >= len(self.mesh.vertices):
            raise fault(
                (*path, "vertex"),
                f"{anchor.vertex} is out of range; the mesh has "
                f"{index_range(len(self.mesh.vertices), 'vertices')}",
            )

    def _check_anchors_differ(self) -> None:
        if len(self.anchors) < 2:
            count = ("no anchor", "one anchor")[len(self.anchors)]
            raise fault(("anchors",), f"{count}: a net needs two or more; add anchors")
        names: dict[str, int] = {}
        places: dict[tuple[str | int | None, int | None], int] = {}
        corners = dict(self._corners())
        anchor_names = self.anchor_names()
        for number, (name, anchor) in enumerate(zip(anchor_names, self.anchors, strict=True)):
            other = names.setdefault(name, number)
            if other != number:
                raise fault(
                    ("anchors", number, "name"),
                    f"{name} is also the name of anchor {other + 1}; choose another name",
                )
            place: tuple[str | int | None, int | None] = (anchor.vertex, None)
            if anchor.ring is not None and anchor.index is not None:
                place = corners.get((anchor.ring, anchor.index), (anchor.ring, anchor.index))
            other = places.setdefault(place, number)
            if other != number:
                raise fault(
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
                raise fault((key,), "is not the number of a cell; write a whole number")
            cells[int(key)] = notation
        else:
            cells[key] = notation
    return cells


def _check_number_or_name(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (int, str)):
        raise fault((), f"must be a type's number or name, not {shown(value)}")
    return value


class ForestSection(Section):
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
    ] = Field(default={})
    """Cell notation by the number of the top-level cell."""

    @field_validator("cells")
    @classmethod
    def _sort(cls, cells: dict[int, str]) -> dict[int, str]:
        return dict(sorted(cells.items()))


class CellTypeDefinition(Section):
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
                raise fault(("springs", number), f"{spring} has one end; name two points")
            if ends in seen:
                raise fault(("springs", number), f"{spring} is there twice; remove one")
            seen.add(ends)
        return self


class Overrides(Section):
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
        return check_node_pairs(pairs)


def _check_version(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int):
        raise fault((), f"must be the format version, {VERSION}, not {shown(value)}")
    if value != VERSION:
        raise fault(
            (), f"format version {shown(value)} is not known here; this program reads {VERSION}"
        )
    return value


class DesignFile(Section):
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
    cell_types: dict[Name, CellTypeDefinition] = Field(default={})
    """Cell types of your own, by name."""
    genes: dict[Name, Gene] = Field(default={})
    """Patches that the forest holds by reference, by name."""
    springs: Springs = Springs()
    """What the springs are made of."""
    rods: Annotated[tuple[Rod, ...], Field(strict=False)] = ()
    """Rods that bend, along boundaries or vertices."""
    loads: Loads = Loads()
    """What pulls and presses on the net, besides its springs' weight."""
    overrides: Overrides = Overrides()
    """Springs added and cut by hand."""

    @field_validator("cell_types")
    @classmethod
    def _check_cell_types(
        cls, types: dict[str, CellTypeDefinition]
    ) -> dict[str, CellTypeDefinition]:
        for name in types:
            if name in BUILT_IN_CELL_TYPES:
                raise fault((name,), f"{name} is a built-in type; choose another name")
        return dict(sorted(types.items()))

    @model_validator(mode="after")
    def _check(self) -> Self:
        kind = self.forest.type
        path = ("forest", "type")
        if isinstance(kind, str) and kind not in self.cell_types:
            raise fault(path, f"no cell type is called {kind}; {nearest(kind, self.cell_types)}")
        if isinstance(kind, int) and not 0 <= kind < len(BUILT_IN_CELL_TYPES):
            raise fault(
                path,
                f"no cell type has the number {shown(kind)}; "
                f"write 0 to {len(BUILT_IN_CELL_TYPES) - 1}, or a name from cell_types",
            )
        self._check_places()
        return self

    def _check_places(self) -> None:
        """Refuse names of parts and boundaries that the framework lacks."""
        framework = self.framework
        parts = [one.name for one in framework.cylinders] + [one.name for one in framework.sheets]
        boundaries = framework.boundaries()
        chosen: list[tuple[KeyPath, tuple[str, ...] | None]] = []
        for number, group in enumerate(self.springs.groups):
            path: KeyPath = ("springs", "groups", number)
            chosen.append(((*path, "parts"), group.parts))
            for at, line in enumerate(group.along or ()):
                if line not in ("ring", "seam"):
                    _boundary((*path, "along", at), line, boundaries)
        for number, pressure in enumerate(self.loads.pressures):
            chosen.append((("loads", "pressures", number, "parts"), pressure.parts))
        for path, names in chosen:
            for at, name in enumerate(names or ()):
                if name not in parts:
                    hint = nearest(name, parts)
                    raise fault((*path, at), f"no part is called {shown(name)}; {hint}")
        for number, rod in enumerate(self.rods):
            if rod.along is not None:
                self._check_rod(("rods", number, "along"), rod.along, boundaries)
        for number, load in enumerate(self.loads.nodes):
            if load.ring is not None and load.index is not None:
                path = ("loads", "nodes", number)
                count = _boundary((*path, "ring"), load.ring, boundaries).vertices
                if load.index >= count:
                    have = index_range(count, "vertices")
                    raise fault(
                        (*path, "index"), f"{load.index} is out of range; {load.ring} has {have}"
                    )

    def _check_rod(self, path: KeyPath, along: str, boundaries: dict[str, Boundary]) -> None:
        mesh = self.framework.mesh
        if mesh is None:
            _boundary(path, along, boundaries)
            return
        try:
            rims = mesh.rims()
        except PydanticCustomError as error:
            raise fault(path, (error.context or {})["message"]) from None
        if not rims:
            raise fault(path, "the mesh is closed and has no rims; give vertices instead")
        if along not in rims:
            raise fault(path, f"no rim is called {shown(along)}; {nearest(along, rims)}")


def _boundary(path: KeyPath, name: str, boundaries: dict[str, Boundary]) -> Boundary:
    if name not in boundaries:
        raise fault(path, f"no boundary is called {shown(name)}; {nearest(name, boundaries)}")
    return boundaries[name]
