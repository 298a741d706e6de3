"""Designs: a framework with a forest of cells, ready to grow, edit, solve and measure."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, design_file, scenes
from .arrays import Floats, numbers
from .design_schema import (
    Anchor,
    Arc,
    CellTypeDefinition,
    DesignFile,
    ForestSection,
    Overrides,
)
from .errors import DesignError, InputError
from .files import read_text
from .key_lines import KeyPath, line_of_key
from .network import TOLERANCE, Equilibrium, Network, Solver, solve
from .patch_schema import Gene, cells_of, core_patch
from .rigging_schema import NodeLoad, Pressure, Rod, SpringGroup

Groups = tuple[NDArray[np.uint32], NDArray[np.uint32]]
"""(starts, items): the items of group g are ``items[starts[g]:starts[g + 1]]``."""


class _Sections(NamedTuple):
    """What the core takes of a design file besides the framework and the forest."""

    groups: tuple[SpringGroup, ...]
    stiffness_factors: list[tuple[str, float]]
    rods: tuple[Rod, ...]
    node_loads: tuple[NodeLoad, ...]
    pressures: tuple[Pressure, ...]
    anchors: tuple[Anchor, ...]


METHODS: tuple[str, ...] = get_args(DesignFile.model_fields["method"].annotation)
"""Names of the filter methods."""


@dataclass(frozen=True)
class Cells:
    """The expressed cells of a design, in order of address, and what belongs to them."""

    addresses: list[str]
    """Such as ``12.0.3``: top-level cell, then children."""
    squares: NDArray[np.uint32]
    """(c, 4): top-level cell, level, and column and row among its 2^level x 2^level squares."""
    types: list[str]
    """Type as expressed: a number, or the name of a defined type."""
    springs: Groups
    """Springs of every cell; a shared spring belongs to all its cells."""
    boundaries: Groups
    """Nodes around every cell, corner c0 first."""

    def of(self, groups: Groups, address: str) -> NDArray[np.uint32]:
        """Return the items of one cell. Raises `DesignError`: no expressed cell is there."""
        try:
            cell = self.addresses.index(address)
        except ValueError:
            raise DesignError("is no expressed cell", key=address) from None
        starts, items = groups
        return items[starts[cell] : starts[cell + 1]]


@dataclass(frozen=True)
class Aperture:
    """A ring of a cylinder, or a side of a sheet, at equilibrium."""

    ring: str
    """Such as ``trunk.start``."""
    perimeter: float
    """[m]."""
    area: float
    """Size of the vector area [m2]; zero for a side of a sheet."""
    normal: tuple[float, float, float]
    """Unit normal; zero for a side of a sheet."""


@dataclass(frozen=True)
class Measures:
    """Measures of a net at equilibrium (the paper, section 3.6 and Fig. 15)."""

    springs: int
    """Number of springs."""
    nodes: int
    """Number of nodes."""
    cells: int
    """Number of expressed cells."""
    force_differential: float | None
    """Largest over smallest force; None if a spring carries next to nothing."""
    force_min: float
    """[N]."""
    force_max: float
    """[N]."""
    force_mean: float
    """[N]."""
    force_deviation: float
    """Standard deviation [N]."""
    force_variation: float
    """Standard deviation over mean."""
    force_range: float
    """Largest minus smallest [N]."""
    total_length: float
    """Sum of spring lengths [m]."""
    load_path: float
    """Sum of force times length [N m]."""
    area: float
    """Area of all cells but null ones [m2]."""
    shortest_spring: float
    """Smallest length of material between nodes [m]."""
    length_per_area: float
    """Total length over area [1/m]."""
    apertures: tuple[Aperture, ...] = ()
    """Rings and sides, part by part."""


class Design:
    """A framework, a forest and the rest of a design file; it does not change, edits make new ones.

    Attributes: `file` (the design file it came from), `forest`, `setting` (all but the forest).
    """

    def __init__(
        self,
        file: DesignFile,
        *,
        source: str | None = None,
        setting: _core.Setting | None = None,
        forest: _core.Forest | None = None,
    ) -> None:
        """Build the base mesh and the forest; `source` is the file that errors name.

        Raises `DesignError`: joins, cells or overrides that do not fit.
        """
        self.file = file
        self._source = source
        self.setting = self._build(self._new_setting) if setting is None else setting
        self.forest = self._build(self._new_forest) if forest is None else forest

    @property
    def name(self) -> str:
        """Name of the design."""
        return self.file.name

    @property
    def mesh(self) -> _core.BaseMesh:
        """The base mesh."""
        return self._mesh

    @cached_property
    def anchor_names(self) -> tuple[str, ...]:
        """Names of the anchors."""
        return self.file.framework.anchor_names()

    @property
    def anchor_vertices(self) -> list[int]:
        """Base vertex of every anchor, in the order of `anchor_names`."""
        return self.setting.anchors

    # --- growing -------------------------------------------------------------------------------

    @cached_property
    def _grown(self) -> tuple[_core.Net, Network]:
        net, arrays = self._build(lambda: self.setting.grow(self.closed.forest))
        return net, Network.from_core(arrays)

    @property
    def _net(self) -> _core.Net:
        return self._grown[0]

    @cached_property
    def closed(self) -> Design:
        """The design with all subdivisions that its method needs written into the forest."""
        return self.closed_by()[0]

    def closed_by(self) -> tuple[Design, list[str]]:
        """Return the closed design and the edits that closing took."""
        forest, edits = self._build(lambda: self.setting.closed(self.forest))
        return (self.with_forest(forest) if edits else self), edits

    def network(self) -> Network:
        """Grow the net: springs after all filters. Raises `DesignError`: nothing is left."""
        return self._grown[1]

    @cached_property
    def nodes(self) -> list[str]:
        """Keys of the nodes, in the order of the network's: ``v12``, ``e7:3/8``, ``f5:1/2,3/4``."""
        return self._net.nodes

    @property
    def cords(self) -> slice:
        """The net's own springs among the network's; the links of rods stand behind them."""
        return slice(0, len(self._net.ring))

    @property
    def anchors(self) -> NDArray[np.uint32]:
        """Node of every anchor, in the order of `anchor_names`."""
        return self._net.anchors

    @cached_property
    def cells(self) -> Cells:
        """The expressed cells."""
        net = self._net
        return Cells(
            net.cells, net.cell_squares, net.cell_types, net.cell_springs, net.cell_boundaries
        )

    # --- queries -------------------------------------------------------------------------------

    def cells_at(self, node: str) -> list[str]:
        """Return the addresses of expressed cells with a node on their boundary."""
        number = self._node(node)
        starts, items = self.cells.boundaries
        found = np.searchsorted(starts, np.flatnonzero(items == number), side="right") - 1
        return [self.cells.addresses[cell] for cell in found]

    def neighbours(self, address: str) -> list[str]:
        """Return the addresses of expressed cells that share an edge with an expressed cell."""
        self.cells.of(self.cells.springs, address)
        found: list[str] = self._build(lambda: self.setting.neighbours(self.closed.forest, address))
        return found

    def springs(self, address: str) -> NDArray[np.uint32]:
        """Return the numbers of the springs of an expressed cell."""
        return self.cells.of(self.cells.springs, address)

    def _node(self, node: str) -> int:
        try:
            return self.nodes.index(node)
        except ValueError:
            raise DesignError("is no node of the net", key=node) from None

    # --- equilibrium ---------------------------------------------------------------------------

    def solve(self, *, tolerance: float = TOLERANCE, solver: Solver = "direct") -> Equilibrium:
        """Grow and solve the net. Raises `DesignError`: no net is left after filtering."""
        return solve(self.network(), tolerance=tolerance, solver=solver)

    def measure(self, equilibrium: Equilibrium) -> Measures:
        """Measure an equilibrium of this design."""
        values: dict[str, Any] = self._build(
            lambda: self._net.measure(self.network(), equilibrium.positions, equilibrium.forces)
        )
        apertures = tuple(
            Aperture(f"{part}.{side}", perimeter, area, normal)
            for part, side, perimeter, area, normal in values.pop("apertures")
        )
        return Measures(**values, apertures=apertures)

    def inner_forces(self, equilibrium: Equilibrium) -> Floats:
        """Return the sum of spring forces of every expressed cell [N] (the paper, section 3.5)."""
        inner: Floats = self._build(lambda: self._net.inner_forces(equilibrium.forces))
        return inner

    # --- change --------------------------------------------------------------------------------

    def edited(self, edits: Iterable[str]) -> Design:
        """Return the design changed by edits, each a line such as ``12.0 subdivide 1 1 6 1``.

        Raises `DesignError`: an edit does not fit.
        """
        return self.with_forest(self._build(lambda: self.setting.edited(self.forest, list(edits))))

    def followed(self, edits: Iterable[str]) -> tuple[Design, list[str]]:
        """Return the design changed by edits, and all that was done, as one list for undoing.

        What is done to one instance of a gene is done to the others. Raises as `edited`.
        """
        forest, done = self._build(lambda: self.setting.followed(self.forest, list(edits)))
        return self.with_forest(forest), done

    def inverse(self, edits: Iterable[str]) -> list[str]:
        """Return the edits that undo `edits`. Raises `DesignError`: not edits of this framework."""
        inverse: list[str] = self._build(lambda: self.setting.inverse(list(edits)))
        return inverse

    def with_method(self, method: str) -> Design:
        """Return the design with another filter method. Raises `DesignError`: unknown method."""
        if method not in METHODS:
            known = ", ".join(METHODS)
            raise DesignError(f"there is no method '{method}'; use {known}", key="method")
        file = self.to_file().model_copy(update={"method": method})
        return Design(file, source=self._source)

    def with_springs(self, **group: Any) -> Design:
        """Return the design with one more group of springs, by the keys of `springs.groups`.

        Such as ``design.with_springs(axial_stiffness=9.8, rest_ratio=0.8, diameter=0.0025)`` for
        all springs, or ``design.with_springs(along=["ring"], stiffness=3.0)`` for some. Later
        groups win. Raises `DesignError`: a key or value that a design file may not have.
        """
        return self._with_section(("springs", "groups"), group)

    def with_stiffness_factors(self, factors: ArrayLike) -> Design:
        """Return the design with a factor on the stiffness of every cord, (c,) in their order.

        They multiply factors that the design has already and go by the two nodes of a spring, so
        that one of a spring that edits take away sleeps until it is back. Raises `InputError`:
        another shape, or not above 0.
        """
        values = numbers("factors", factors, (self.cords.stop,))
        if not (values > 0).all():
            raise InputError("must be above 0", key="factors")
        file, keys = self.to_file(), self.nodes
        held = {tuple(sorted(pair.split())): pair for pair in file.springs.stiffness_factors}
        said = dict(file.springs.stiffness_factors)
        springs = self.network().springs[self.cords].tolist()
        for (a, b), factor in zip(springs, values.tolist(), strict=True):
            pair = held.get(tuple(sorted((keys[a], keys[b]))), f"{keys[a]} {keys[b]}")
            said[pair] = said.get(pair, 1.0) * factor
        changed = {pair: factor for pair, factor in said.items() if factor != 1}
        springs_section = file.springs.model_copy(update={"stiffness_factors": changed})
        return Design(file.model_copy(update={"springs": springs_section}), source=self._source)

    def with_rod(self, along: str | None = None, **rod: Any) -> Design:
        """Return the design with a rod along a boundary, or `vertices`, by the keys of `rods`.

        Such as ``design.with_rod("tube.start", bending_stiffness=20.0, axial_stiffness=5e5)``.
        Raises `DesignError`: a key or value that a design file may not have.
        """
        place = {} if along is None else {"along": along}
        return self._with_section(("rods",), place | rod)

    def with_load(self, force: Sequence[float], **place: Any) -> Design:
        """Return the design with a force [N] on a node: `node`, `vertex`, or `ring` and `index`.

        Raises `DesignError`: a key or value that a design file may not have.
        """
        return self._with_section(("loads", "nodes"), {**place, "force": list(force)})

    def with_pressure(self, pressure: float, **cells: Any) -> Design:
        """Return the design with pressure [Pa] on cells, by the keys of `loads.pressures`.

        Raises `DesignError`: a key or value that a design file may not have.
        """
        return self._with_section(("loads", "pressures"), {**cells, "pressure": pressure})

    def _with_section(self, path: tuple[str, ...], section: dict[str, Any]) -> Design:
        data = design_file.to_data(self.to_file())
        table = data
        for key in path[:-1]:
            table = table.setdefault(key, {})
        table.setdefault(path[-1], []).append(section)
        return Design(design_file.from_data(data, self._source), source=self._source)

    def with_cell_types(self, types: Mapping[str, CellTypeDefinition]) -> Design:
        """Return the design with further cell types.

        Raises `DesignError`: one is there and has other springs.
        """
        known = self.file.cell_types
        for name, kind in types.items():
            if known.get(name, kind) != kind:
                problem = "has other springs in the patch; rename one of the two types"
                raise DesignError(problem, file=self._source, key=f"cell_types.{name}")
        if all(name in known for name in types):
            return self
        file = self.to_file().model_copy(
            update={"cell_types": dict(sorted({**known, **types}.items()))}
        )
        return Design(file, source=self._source)

    def with_gene(self, name: str, gene: Gene) -> Design:
        """Return the design with a gene that its forest can refer to.

        Raises `DesignError`: it has another gene of this name.
        """
        file = self.to_file()
        if file.genes.get(name, gene) != gene:
            problem = "is another gene; choose another name"
            raise DesignError(problem, file=self._source, key=f"genes.{name}")
        if name in file.genes:
            return self
        genes = dict(sorted({**file.genes, name: gene}.items()))
        return Design(file.model_copy(update={"genes": genes}), source=self._source)

    def renamed(self, name: str) -> Design:
        """Return the design under another name. Raises `DesignError`: not one line of text."""
        if not name.strip() or not name.isprintable():
            raise DesignError("must be a text on one line", key="name")
        file = self.file.model_copy(update={"name": name})
        other = Design(file, source=self._source, setting=self.setting, forest=self.forest)
        other._mesh = self._mesh
        return other

    def to_file(self) -> DesignFile:
        """Return the design file of this design, its forest written in cell notation."""
        framework, section = self.file.framework, self.file.forest
        default = str(section.type)
        for _ in range(framework.level):
            default = f"{section.type}({' '.join([default] * 4)})"
        cells, added, cut = self.setting.notation(self.forest, default)
        forest = ForestSection(type=section.type, cells=cells)
        overrides = Overrides(added=tuple(added), cut=tuple(cut))
        genes = {
            name: Gene(anchored=core[0], cells=cells_of(core))
            for name, core in self.setting.genes(self.forest)
        }
        changes = {"forest": forest, "overrides": overrides, "genes": genes}
        return self.file.model_copy(update=changes)

    def with_forest(self, forest: _core.Forest) -> Design:
        """Return the design with another forest on the same framework."""
        other = Design(self.file, source=self._source, setting=self.setting, forest=forest)
        other._mesh = self._mesh
        return other

    # --- building ------------------------------------------------------------------------------

    def _build(self, make: Callable[[], Any]) -> Any:
        try:
            return make()
        except _core.CoreError as error:
            key, problem = error.args
            raise DesignError(problem, file=self._source, key=key, line=self._line(key)) from None

    def _line(self, key: str) -> int | None:
        if self._source is None or not os.path.isfile(self._source):
            return None
        path: KeyPath = tuple(
            int(index) if index else word
            for index, word in re.findall(r"\[(\d+)\]|([^.\[\]]+)", key)
        )
        text = read_text(self._source)
        return line_of_key(text, path, "json" if self._source.endswith(".json") else "toml")

    def _new_setting(self) -> _core.Setting:
        file = self.file
        self._mesh = _base_mesh(file)
        vertices = self._anchor_vertices()
        return _core.Setting(
            self._mesh,
            [
                (name, list(kind.springs), kind.perimeter, kind.fan)
                for name, kind in file.cell_types.items()
            ],
            [(name, core_patch(gene.anchored, gene.cells)) for name, gene in file.genes.items()],
            file.method,
            vertices,
            [anchor.position for anchor in file.framework.anchors],
            list(file.framework.mesh.vertices) if file.framework.mesh else None,
            file.springs.stiffness,
            file.springs.ring_factor,
            _Sections(
                file.springs.groups,
                list(file.springs.stiffness_factors.items()),
                _rods(file),
                file.loads.nodes,
                file.loads.pressures,
                file.framework.anchors,
            ),
            TOLERANCE,
        )

    def _anchor_vertices(self) -> list[int]:
        vertices: dict[int, str] = {}
        for number, anchor in enumerate(self.file.framework.anchors):
            key, name = f"framework.anchors[{number}]", self.anchor_names[number]
            vertex = anchor.vertex
            if anchor.ring is not None and anchor.index is not None:
                part, side = anchor.ring.split(".")
                vertex = self._mesh.border_vertex(part, side, anchor.index)
            if vertex is None or vertex >= self._mesh.vertex_count:
                count = self._mesh.vertex_count
                raise _core.CoreError(key, f"there is no such vertex; there are {count}, from 0")
            if vertex in vertices:
                problem = f"joins put {name} on the node of {vertices[vertex]}; remove one of them"
                raise _core.CoreError(key, problem)
            vertices[vertex] = name
        return list(vertices)

    def _new_forest(self) -> _core.Forest:
        file = self.file
        return self.setting.forest(
            str(file.forest.type),
            file.framework.level,
            dict(file.forest.cells),
            list(file.overrides.added),
            list(file.overrides.cut),
        )


def load(design: str | os.PathLike[str]) -> Design:
    """Load a design: a .toml or .json file, or the name of a packaged scene.

    Raises `DesignError`: neither, or a file that is no valid design.
    """
    return Design(scenes.find(design), source=os.fspath(design))


def save(design: Design, path: str | os.PathLike[str]) -> None:
    """Write a design to a .toml or .json file, atomically and canonically.

    Raises `DesignError`: another kind of file. `WriteError`: the file can't be written.
    """
    design_file.save(design.to_file(), path)


def _rods(file: DesignFile) -> tuple[Rod, ...]:
    """Return the rods, those along rims of a mesh by their vertices."""
    mesh = file.framework.mesh
    if mesh is None:
        return file.rods
    return tuple(
        rod
        if rod.along is None
        else rod.model_copy(update={"along": None, "vertices": mesh.rims()[rod.along]})
        for rod in file.rods
    )


def _base_mesh(file: DesignFile) -> _core.BaseMesh:
    framework = file.framework
    if framework.mesh is not None:
        mesh = framework.mesh
        return _core.BaseMesh.from_faces(len(mesh.vertices), [list(face) for face in mesh.faces])
    parts = [(c.name, True, c.around, c.along) for c in framework.cylinders]
    parts += [(s.name, False, s.across, s.along) for s in framework.sheets]
    numbers = {part[0]: number for number, part in enumerate(parts)}

    def arc(arc: Arc) -> tuple[int, str, int, int]:
        name, side = arc.ring.split(".")
        return numbers[name], side, arc.start, arc.length

    joins = [(arc(j.first), arc(j.second), j.reversed, j.cord) for j in framework.joins]
    return _core.BaseMesh.from_framework(framework.grid == "dia", parts, joins)
