"""Selections of cells, written as text: by address, lattice, rings, force and map, put together.

    12.0.3                        a cell and all that lies in it
    all                           every cell
    lattice(trunk, 14..1, 0..2)   columns and rows of a part, from 0; columns run on round
    map(trunk, 0..4, 1..2.5)      cells whose centre lies in a region of the unrolled map
    rings(A7, 2)                  two rings of cells round an anchor, a node (v12), a ring
                                  (trunk.start) or a seam (seam:0, the number of the join)
    row(12)                       all cells of a cylinder or sheet at the height of one
    loop(12)                      cells from edge to opposite edge, through sides 0 and 2 of one
    part(trunk)                   all cells of a cylinder or sheet
    force(3..), force(1..2)       cells by the sum of the forces of their springs [N]
    gene(crown)                   cells of everything that holds a gene by reference
    grow(S, 1), shrink(S, 1)      with, or without, what touches the border of a selection
    S + T, S - T, S & T           united, subtracted, what lies in both; from left to right

Rings, `grow` and `shrink` count top-level cells; a last number asks for a deeper level:
`rings(A7, 2, 1)`. Names with other characters than letters, digits and `_ . : /` stand in quotes.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from . import _core
from .design import Design
from .errors import InputError
from .wording import nearest, shown

_TOKENS = re.compile(r'\s*(?:(?P<word>[\w.:/]+)|"(?P<quoted>[^"]*)"|(?P<sign>[-+&(),]))')
_ADDRESS = re.compile(r"\d+(\.[0-3])*")
_RANGE = re.compile(r"(\d+(?:\.\d+)?)?\.\.(\d+(?:\.\d+)?)?")
_DEEPEST = 8  # of rings: a level is made of squares over the whole mesh


class SelectionError(InputError):
    """A selection that can't be read, or that selects nothing."""


def select(design: Design, selection: str | _core.Selection) -> _core.Selection:
    """Return the cells that a text selects in a design.

    Raises `SelectionError`: the text is no selection, names what does not exist, or selects
    nothing; `DesignError`: forces are asked for and the design gives no net.
    """
    found = _Reader(design, selection).selection() if isinstance(selection, str) else selection
    if not found:
        raise SelectionError(f"{shown(str(selection))} selects no cell; select at least one")
    return found


def nodes_of(design: Design, place: str) -> list[str]:
    """Return the keys of the base nodes that a name stands for.

    The name is an anchor's, a node key, a ring such as ``trunk.start``, or a seam such as
    ``seam:0``. Raises `SelectionError`: there is nothing of that name.
    """
    if place in design.anchor_names:
        return [f"v{vertex_of(design, place)}"]
    if re.fullmatch(r"v\d+|e\d+:\d+/\d+|f\d+:\d+/\d+,\d+/\d+", place):
        return [place]
    framework = design.file.framework
    if match := re.fullmatch(r"seam:(\d+)", place):
        number = int(match[1])
        if number >= len(framework.joins):
            raise SelectionError(f"there is no seam {number}; there are {len(framework.joins)}")
        arc = framework.joins[number].first
        part, side = arc.ring.split(".")
        boundary = framework.boundaries()[arc.ring]
        indices = [(arc.start + step) % boundary.vertices for step in range(arc.length + 1)]
        vertices = [design.mesh.border_vertex(part, side, index) for index in indices]
        return [f"v{vertex}" for vertex in dict.fromkeys(vertices)]
    for part, side, path, _ in design.mesh.borders:
        if f"{part}.{side}" == place:
            return [f"v{vertex}" for vertex in path]
    known = [*design.anchor_names, *framework.boundaries()]
    known += [f"seam:{number}" for number in range(len(framework.joins))]
    raise SelectionError(f"nothing is called {shown(place)}; {nearest(place, known)}")


def vertex_of(design: Design, anchor: str) -> int:
    """Return the base vertex of an anchor. Raises `SelectionError`: there is no such anchor."""
    if anchor not in design.anchor_names:
        hint = nearest(anchor, design.anchor_names)
        raise SelectionError(f"there is no anchor {shown(anchor)}; {hint}")
    vertex: int = design.anchor_vertices[design.anchor_names.index(anchor)]
    return vertex


def loop_through(mesh: _core.BaseMesh, face: int) -> list[int]:
    """Return the faces that a walk through side 2 of a face, and one through side 0, meet.

    It goes from edge to opposite edge until it ends at a border, at an edge with three faces or
    more, or where it has been.
    """
    at_edge: dict[frozenset[int], list[tuple[int, int]]] = {}
    for number, corners in enumerate(mesh.faces.tolist()):
        for edge in range(4):
            ends = frozenset((corners[edge], corners[(edge + 1) % 4]))
            at_edge.setdefault(ends, []).append((number, edge))
    across = {
        row[turn]: row[1 - turn] for row in at_edge.values() if len(row) == 2 for turn in (0, 1)
    }
    found = [face]
    for way in (2, 0):
        at = face, way
        while at in across:
            number, entered = across[at]
            if number in found:
                break
            found.append(number)
            at = number, (entered + 2) % 4
    return found


class _Reader:
    """Reads one selection from left to right."""

    def __init__(self, design: Design, text: str) -> None:
        self._design, self._text = design, text
        self._tokens: list[tuple[str, str]] = []
        at = 0
        while at < len(text.rstrip()):
            match = _TOKENS.match(text, at)
            if match is None:
                raise self._error(f"does not belong here: {shown(text[at:].strip()[:1])}")
            kind = match.lastgroup or ""
            self._tokens.append((kind, match[kind]))
            at = match.end()
        self._tokens.append(("end", ""))
        self._at = 0

    def selection(self) -> _core.Selection:
        found = self._sum()
        if self._peek()[0] != "end":
            raise self._error(f"{shown(self._peek()[1])} does not belong here")
        return found

    def _sum(self) -> _core.Selection:
        left = self._term()
        while self._peek() in (("sign", "+"), ("sign", "-"), ("sign", "&")):
            sign = self._next()[1]
            right = self._term()
            put = {"+": left.union, "-": left.difference, "&": left.intersection}
            left = put[sign](right)
        return left

    def _term(self) -> _core.Selection:
        kind, word = self._next()
        if (kind, word) == ("sign", "("):
            inner = self._sum()
            self._expect(")")
            return inner
        if kind == "word" and _ADDRESS.fullmatch(word):
            found: _core.Selection = self._core(lambda: _core.Selection(self._design.mesh, [word]))
            return found
        if (kind, word) == ("word", "all"):
            return _core.Selection.all(self._design.mesh)
        functions = {
            "lattice": self._lattice,
            "map": self._map,
            "rings": self._rings,
            "row": self._row,
            "loop": self._loop,
            "part": self._whole_part,
            "force": self._force,
            "gene": self._gene,
            "grow": self._grow,
            "shrink": self._shrink,
        }
        if kind != "word" or word not in functions:
            known = nearest(word, [*functions, "all"])
            what = shown(word) if word else "the end"
            raise self._error(f"expected a cell such as 12.0 or a name, not {what}; {known}")
        self._expect("(")
        selected = functions[word]()
        self._expect(")")
        return selected

    def _lattice(self) -> _core.Selection:
        part = self._part()
        columns, rows = self._whole_range(), self._whole_range()
        return _core.Selection.lattice(self._design.mesh, part, columns, rows)

    def _map(self) -> _core.Selection:
        part = self._part()
        bounds: list[int] = []
        for low, high in (self._range(), self._range()):
            bounds += [round(min(max(end, -1e9), 1e9) * 2**24) for end in (low, high)]
        design = self._design
        return _core.Selection.on_map(design.mesh, design.closed.forest, part, bounds)

    def _rings(self) -> _core.Selection:
        nodes = nodes_of(self._design, self._word("an anchor, node, ring or seam"))
        count, level = self._count_and_level()
        mesh = self._design.mesh
        found: _core.Selection = self._core(
            lambda: _core.Selection.rings(mesh, nodes, count, level)
        )
        return found

    def _row(self) -> _core.Selection:
        mesh, face = self._design.mesh, self._face()
        parts, corners = mesh.map
        heights = corners[:, 1::2].sum(axis=1)
        level = (parts == parts[face]) & (heights == heights[face])
        return _core.Selection(mesh, [str(cell) for cell in np.flatnonzero(level)])

    def _loop(self) -> _core.Selection:
        mesh = self._design.mesh
        return _core.Selection(mesh, [str(cell) for cell in loop_through(mesh, self._face())])

    def _face(self) -> int:
        face = self._whole("a top-level cell")
        if face >= len(self._design.mesh.faces):
            raise self._error(f"there is no top-level cell {face}")
        return face

    def _whole_part(self) -> _core.Selection:
        mesh, part = self._design.mesh, self._part()
        cells = [str(cell) for cell in np.flatnonzero(mesh.map[0] == part)]
        return _core.Selection(mesh, cells)

    def _grow(self) -> _core.Selection:
        inner = self._sum()
        count, level = self._count_and_level()
        return inner.grown(self._design.mesh, count, level)

    def _shrink(self) -> _core.Selection:
        inner = self._sum()
        count, level = self._count_and_level()
        return inner.shrunk(self._design.mesh, count, level)

    def _force(self) -> _core.Selection:
        low, high = self._range(first=True)
        design = self._design.closed
        forces = design.inner_forces(design.solve())
        chosen = np.flatnonzero((forces >= low) & (forces <= high))
        addresses = [design.cells.addresses[cell] for cell in chosen]
        return _core.Selection(design.mesh, addresses)

    def _gene(self) -> _core.Selection:
        name = self._word("a gene")
        genes = self._design.file.genes
        if name not in genes:
            raise self._error(f"no gene is called {shown(name)}; {nearest(name, genes)}")
        rows = self._design.setting.instances(self._design.forest)
        cells = [str(cell) for gene, _, faces in rows if gene == name for cell in faces]
        return _core.Selection(self._design.mesh, cells)

    def _part(self) -> int:
        framework = self._design.file.framework
        parts = [cylinder.name for cylinder in framework.cylinders]
        parts += [sheet.name for sheet in framework.sheets]
        name = self._word("a part")
        if name not in parts:
            raise self._error(f"no part is called {shown(name)}; {nearest(name, parts)}")
        return parts.index(name)

    def _range(self, *, first: bool = False) -> tuple[float, float]:
        if not first:
            self._expect(",")
        word = self._word("a range")
        match = _RANGE.fullmatch(word)
        if match is None:
            raise self._error(f"expected a range such as 2..5 or 3.., not {shown(word)}")
        low, high = match.groups()
        return float(low or "-inf"), float(high or "inf")

    def _whole_range(self) -> tuple[int, int]:
        low, high = self._range()
        ends = (0 if low == float("-inf") else low, 2**32 - 1 if high == float("inf") else high)
        if any(end != int(end) or end >= 2**32 for end in ends):
            raise self._error("columns and rows are whole numbers, such as 0..3")
        return int(ends[0]), int(ends[1])

    def _count_and_level(self) -> tuple[int, int]:
        self._expect(",")
        count, level = self._whole("a number of rings"), 0
        if self._peek() == ("sign", ","):
            self._next()
            level = self._whole("a level")
        if count > 10_000 or level > _DEEPEST:
            raise self._error(f"at most 10000 rings, of level 0 to {_DEEPEST}, are possible")
        return count, level

    def _whole(self, what: str) -> int:
        word = self._word(what)
        if not re.fullmatch(r"\d{1,9}", word):
            raise self._error(f"expected {what}, not {shown(word)}")
        return int(word)

    def _word(self, what: str) -> str:
        kind, word = self._next()
        if kind not in ("word", "quoted"):
            raise self._error(f"expected {what}, not {shown(word) if word else 'the end'}")
        return word

    def _expect(self, sign: str) -> None:
        kind, word = self._next()
        if (kind, word) != ("sign", sign):
            raise self._error(f"expected {sign!r}, not {shown(word) if word else 'the end'}")

    def _peek(self) -> tuple[str, str]:
        return self._tokens[self._at]

    def _next(self) -> tuple[str, str]:
        token = self._tokens[self._at]
        self._at = min(self._at + 1, len(self._tokens) - 1)
        return token

    def _core(self, make: Callable[[], Any]) -> Any:
        try:
            return make()
        except _core.CoreError as error:
            raise self._error(error.args[1]) from None

    def _error(self, problem: str) -> SelectionError:
        return SelectionError(f"selection {shown(self._text)}: {problem}")
