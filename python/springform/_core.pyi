"""Types of the compiled module: conversion between Python and the Rust crates, no algorithm.

Arrays cross without copies, and the interpreter lock is free during native work. Whatever is
refused raises `CoreError`. Edits are lines such as ``12.0 subdivide 1 1 6 1``, cells are addresses
such as ``12.0.3``, nodes are keys such as ``e7:3/8``. Sizes: n nodes, m springs, c expressed
cells, v base vertices, e base edges, f base faces.
"""

from collections.abc import Sequence
from typing import Any, Literal, Protocol, TypeAlias, TypedDict, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "BaseMesh",
    "Census",
    "CoreError",
    "Equalisation",
    "Evolution",
    "ForceStrainCurve",
    "Forest",
    "ImplicitEuler",
    "Net",
    "Selection",
    "Sensitivity",
    "Setting",
    "StressSeeking",
    "Symmetries",
    "__version__",
    "best_frame",
    "check_patch",
    "graft_patch",
    "lift",
    "misfits",
    "residuals",
    "solve",
    "turned_patch",
]

_Floats: TypeAlias = NDArray[np.float64]
_Numbers: TypeAlias = NDArray[np.uint32]
_Vector: TypeAlias = tuple[float, float, float]
_Side: TypeAlias = Literal["start", "end", "left", "right"]
_Ending: TypeAlias = Literal["generations", "springs", "differential", "suf"]

_Arc: TypeAlias = tuple[int, str, int, int]
"""(part, side, first vertex, number of edges)."""
_Groups: TypeAlias = tuple[_Numbers, _Numbers]
"""(starts, items): the items of group g are ``items[starts[g]:starts[g + 1]]``."""
_Amount: TypeAlias = tuple[bool, float]
"""(is a share, number of cells or share of them)."""
_Strategy: TypeAlias = tuple[_Amount, _Amount, _Amount, str]
"""(insertions, switches, toggles, weighting)."""
_Standing: TypeAlias = tuple[int, float | None]
"""(springs, force differential; None if undefined)."""

__version__: str

class CoreError(ValueError):
    """A refusal: ``args`` are (key, problem)."""

    args: tuple[str, str]

# --- topology ----------------------------------------------------------------------------------

@final
class BaseMesh:
    """Quads with their edges and borders; no coordinates."""

    @staticmethod
    def from_framework(
        dia: bool,
        parts: list[tuple[str, bool, int, int]],
        joins: list[tuple[_Arc, _Arc, bool, bool]],
    ) -> BaseMesh:
        """Join parts (name, closed, around or across, along) at (first, second, reversed, cord)."""

    @staticmethod
    def from_faces(vertex_count: int, faces: list[list[int]]) -> BaseMesh:
        """Take quads of four vertex numbers each."""

    @property
    def vertex_count(self) -> int:
        """Number of base vertices, v."""

    @property
    def faces(self) -> _Numbers:
        """Corners of every face, (f, 4)."""

    @property
    def edges(self) -> _Numbers:
        """Ends of every edge, (e, 2)."""

    def border_vertex(self, part: str, name: str, index: int) -> int | None:
        """Return a vertex of a part's border by its index; None if there is none."""

    @property
    def borders(self) -> list[tuple[str, _Side, list[int], bool]]:
        """(part, side, path of base vertices, closed) of every border."""

    @property
    def map(self) -> tuple[_Numbers, NDArray[np.int32]]:
        """Unrolled map: part of every face, (f,), and its corners, (f, 8) half columns and rows."""

@final
class Forest:
    """The genotype: quadtrees of cells, and overrides. It does not change."""

    @property
    def fingerprint(self) -> int:
        """A number that equal forests share, below 2^64."""

    def __eq__(self, other: object, /) -> bool: ...

# --- mechanics ---------------------------------------------------------------------------------

class _NetworkArrays(Protocol):
    """A bare network; C-contiguous arrays."""

    @property
    def positions(self) -> _Floats:
        """(n, 3) [m]."""

    @property
    def springs(self) -> _Numbers:
        """(m, 2)."""

    @property
    def fixed_axes(self) -> NDArray[np.bool_]:
        """(n, 3)."""

    @property
    def stiffness(self) -> _Floats:
        """(m,) [N/m]."""

    @property
    def rest_length(self) -> _Floats:
        """(m,) [m]."""

    @property
    def force(self) -> _Floats:
        """(m,) [N]."""

    @property
    def sense(self) -> NDArray[np.int8]:
        """(m,): 1 tension, 0 both, -1 compression."""

    @property
    def curve(self) -> _Numbers:
        """(m,): number in `curves`; 2^32 - 1 where a spring has none; empty if none has one."""

    @property
    def curves(self) -> Sequence[ForceStrainCurve]:
        """Measured curves."""

    @property
    def loads(self) -> _Floats:
        """(n, 3) [N]."""

    @property
    def self_weight(self) -> _Floats:
        """(m,) [N/m] of length at equilibrium; empty if no spring has any."""

    @property
    def pressure(self) -> Sequence[tuple[Sequence[int], float]]:
        """Nodes around a cell, and the pressure on it [Pa]."""

    @property
    def rods(self) -> Sequence[_Rod]:
        """Rods that bend."""

    @property
    def slides(self) -> Sequence[tuple[int, bool, _Vector]]:
        """(node, whether in a plane, the line's direction or the plane's normal)."""

class _Rod(Protocol):
    @property
    def nodes(self) -> Sequence[int]:
        """Consecutive nodes."""

    @property
    def closed(self) -> bool:
        """The last node is followed by the first."""

    @property
    def lengths(self) -> Sequence[float] | None:
        """Unstressed lengths of the links [m]; not None."""

    @property
    def bending_stiffness(self) -> float:
        """EI [N m2]."""

class _Sections(Protocol):
    """What a design file says besides framework and forest, section by section."""

    @property
    def groups(self) -> Sequence[Any]:
        """Groups of springs."""

    @property
    def rods(self) -> Sequence[Any]:
        """Rods along boundaries."""

    @property
    def node_loads(self) -> Sequence[Any]:
        """Forces on nodes."""

    @property
    def pressures(self) -> Sequence[Any]:
        """Pressures on cells."""

    @property
    def anchors(self) -> Sequence[Any]:
        """Anchors with their supports."""

class _Measures(TypedDict):
    springs: int
    nodes: int
    cells: int
    force_differential: float | None
    force_min: float
    force_max: float
    force_mean: float
    force_deviation: float
    force_variation: float
    force_range: float
    total_length: float
    load_path: float
    area: float
    shortest_spring: float
    length_per_area: float

class _MeasuresAndApertures(_Measures):
    apertures: list[tuple[str, _Side, float, float, _Vector]]
    """(part, side, perimeter [m], area [m2], unit normal)."""

class _SolveResult(TypedDict):
    positions: _Floats
    reactions: _Floats
    loads: _Floats
    forces: _Floats
    spring_energies: _Floats
    bending_moments: list[_Floats]
    residual: float
    worst_node: int | None
    converged: bool
    iterations: int
    method: str
    reason: str

@final
class Setting:
    """Everything of a design but its forest."""

    def __new__(
        cls,
        mesh: BaseMesh,
        cell_types: list[tuple[str, list[str], bool, bool]],
        genes: list[tuple[str, _Patch]],
        method: str,
        anchors: list[int],
        anchor_positions: list[_Vector],
        drawn: list[_Vector] | None,
        stiffness: float,
        ring_factor: float,
        sections: _Sections,
        tolerance: float,
    ) -> Setting:
        """Take types (name, springs, perimeter, fan) and anchors' vertices and positions [m].

        `drawn` are positions of base vertices [m]; without them they are found from the anchors.
        `stiffness` is in N/m.
        """

    @property
    def anchors(self) -> list[int]:
        """Base vertex of every anchor."""

    def forest(
        self, kind: str, level: int, cells: dict[int, str], added: list[str], cut: list[str]
    ) -> Forest:
        """Make a forest: cells of a type subdivided to a level, but for those in notation."""

    def notation(self, forest: Forest, default: str) -> tuple[dict[int, str], list[str], list[str]]:
        """Return the top-level cells that differ from `default`, in notation; added; cut."""

    def edited(self, forest: Forest, edits: list[str]) -> Forest:
        """Return a forest changed by edits."""

    def followed(self, forest: Forest, edits: list[str]) -> tuple[Forest, list[str]]:
        """Return the same, and all edits: with those to the other instances of genes."""

    def tree(self, forest: Forest, face: int) -> str:
        """Return the notation of a top-level cell as it stands, even if a gene holds it."""

    def genes(self, forest: Forest) -> list[tuple[str, _Patch]]:
        """Return the genes with their cells as a forest holds them."""

    def instances(self, forest: Forest) -> list[tuple[str, _Frame, list[int]]]:
        """Return (gene, frame, top-level cells) of all that a forest holds by reference."""

    def cell(self, forest: Forest, address: str) -> tuple[str, bool, bool]:
        """Return (type and turn, switched on, owns children) of the cell at an address."""

    def closed(self, forest: Forest) -> tuple[Forest, list[str]]:
        """Return a closed copy of a forest, and the edits that closing took."""

    def inverse(self, edits: list[str]) -> list[str]:
        """Return the edits that undo edits."""

    def drawn(self) -> _Floats:
        """Return the drawn positions of base vertices, (v, 3) [m]."""

    def grow(self, forest: Forest) -> tuple[Net, dict[str, Any]]:
        """Return the net of a closed forest, and what its network holds, by name."""

    def neighbours(self, forest: Forest, address: str) -> list[str]:
        """Return the expressed cells that share an edge with an expressed cell."""

    def cell_type(self, word: str) -> str:
        """Return the canonical word of a cell type that the method allows."""

@final
class Net:
    """Nodes, springs and cells of a grown net."""

    @property
    def nodes(self) -> list[str]:
        """Key of every node."""

    @property
    def anchors(self) -> _Numbers:
        """Node of every anchor."""

    @property
    def ring(self) -> NDArray[np.bool_]:
        """Which springs lie along a free ring or rim, (m,)."""

    @property
    def cells(self) -> list[str]:
        """Addresses of the expressed cells."""

    @property
    def cell_squares(self) -> _Numbers:
        """Face, level, column and row of every expressed cell, (c, 4)."""

    @property
    def cell_types(self) -> list[str]:
        """Types of the expressed cells, as expressed."""

    @property
    def cell_springs(self) -> _Groups:
        """Springs of every expressed cell."""

    @property
    def spring_cells(self) -> _Groups:
        """Expressed cells of every spring."""

    @property
    def cell_boundaries(self) -> _Groups:
        """Nodes around every expressed cell, corner c0 first."""

    def inner_forces(self, forces: _Floats) -> _Floats:
        """Return the sum of spring forces of every expressed cell, (c,) [N]."""

    def measure(
        self, network: _NetworkArrays, positions: _Floats, forces: _Floats
    ) -> _MeasuresAndApertures:
        """Measure the net at positions, (n, 3) [m], with forces, (m,) [N]."""

@final
class ForceStrainCurve:
    """A measured curve of force against strain."""

    def __new__(cls, points: list[list[float]]) -> ForceStrainCurve:
        """Take points (strain, force [N])."""

    @property
    def axial_stiffness(self) -> float:
        """Force over strain at the last point [N]."""

    def strain(self, forces: _Floats) -> _Floats:
        """Return the least strains at which the curve has forces [N]."""

    def force(self, strains: _Floats) -> _Floats:
        """Return the force at strains, (s,) [N]."""

@final
class ImplicitEuler:
    """A bare network on its way to equilibrium."""

    def __new__(
        cls, network: _NetworkArrays, step: float, growth: float, drag: float
    ) -> ImplicitEuler: ...
    def advance(self, tolerance: float) -> _SolveResult:
        """Make one time step and return the state after it."""

class _Gradient(TypedDict):
    stiffness: _Floats
    rest_length: _Floats
    force: _Floats
    loads: _Floats
    supports: _Floats

class _Response(TypedDict):
    positions: _Floats
    forces: _Floats

@final
class Sensitivity:
    """The factored tangent stiffness of a bare network at its equilibrium."""

    def __new__(cls, network: _NetworkArrays, positions: _Floats) -> Sensitivity:
        """Take equilibrium positions, (n, 3) [m]."""

    def gradient(self, by_positions: _Floats, by_forces: _Floats) -> _Gradient:
        """Return the gradient of a scalar of positions, (n, 3), and spring forces, (m,)."""

    def response(
        self,
        stiffness: _Floats,
        rest_length: _Floats,
        force: _Floats,
        loads: _Floats,
        supports: _Floats,
    ) -> _Response:
        """Return the change of the equilibrium with changes of all parameters."""

@final
class Equalisation:
    """Stiffness factors of a bare network on their way to even forces."""

    def __new__(
        cls,
        network: _NetworkArrays,
        tuned: list[int],
        bounds: list[float],
        values: list[float],
        tolerance: float,
    ) -> Equalisation:
        """Take two bounds on the factors, or, where there are any, the only values allowed.

        `tuned` are the springs whose stiffness is tuned and whose forces count, ascending.
        """

    def advance(self) -> bool:
        """Make one step; return False once there is none left to make."""

    @property
    def factors(self) -> _Floats:
        """Best factors so far, (m,)."""

    @property
    def before(self) -> float:
        """Force differential with factors of 1."""

    @property
    def differential(self) -> float:
        """Force differential with the best factors."""

    @property
    def differential_now(self) -> float:
        """Force differential where the steps are now."""

    @property
    def iterations(self) -> int:
        """Steps made."""

def solve(network: _NetworkArrays, tolerance: float, iterations: int, solver: str) -> _SolveResult:
    """Solve a bare network by "direct", "implicit-euler" or "dynamic-relaxation"."""

def residuals(network: _NetworkArrays) -> _Floats:
    """Return the force out of balance at every free node, (n, 3) [N]."""

# --- grafting ----------------------------------------------------------------------------------

_Patch = tuple[bool, list[tuple[str, list[int], list[tuple[str, str]]]]]
"""Whether corner 0 is an anchor, and (walk, free sides, (path of children, cell notation))."""
_Frame = tuple[int, int, bool]
"""(top-level cell, turn, mirrored)."""

@final
class Selection:
    """A region of cells: a value, equal to others that cover the same."""

    def __new__(cls, mesh: BaseMesh, addresses: list[str]) -> Selection:
        """Select the cells at addresses, whether or not a forest divides so far."""

    @staticmethod
    def all(mesh: BaseMesh) -> Selection:
        """Select all cells."""

    @staticmethod
    def lattice(
        mesh: BaseMesh, part: int, columns: tuple[int, int], rows: tuple[int, int]
    ) -> Selection:
        """Select top-level cells in ranges, ends included; columns run on round a cylinder."""

    @staticmethod
    def on_map(mesh: BaseMesh, forest: Forest, part: int, bounds: list[int]) -> Selection:
        """Select expressed cells by their centre on the unrolled map.

        `bounds` are left, right, bottom and top in units of 2^-24 columns and rows.
        """

    @staticmethod
    def rings(mesh: BaseMesh, nodes: list[str], count: int, level: int) -> Selection:
        """Select cells of a level in rings round nodes."""

    def grown(self, mesh: BaseMesh, times: int, level: int) -> Selection:
        """Return the selection with the cells of a level that touch it, so many times over."""

    def shrunk(self, mesh: BaseMesh, times: int, level: int) -> Selection:
        """Return the selection without the cells of a level that touch others."""

    def union(self, other: Selection) -> Selection:
        """Return what lies in either."""

    def difference(self, other: Selection) -> Selection:
        """Return what lies in this but not in the other."""

    def intersection(self, other: Selection) -> Selection:
        """Return what lies in both."""

    def __eq__(self, other: object, /) -> bool: ...
    def __bool__(self, /) -> bool: ...
    @property
    def addresses(self) -> list[str]:
        """Addresses of the fewest squares that cover it."""

    @property
    def faces(self) -> list[int]:
        """Top-level cells of which some part is selected."""

    def expressed(self, forest: Forest) -> list[str]:
        """Return the expressed cells of a forest that lie in it."""

def lift(
    setting: Setting,
    forest: Forest,
    selection: Selection,
    *,
    vertex: int | None = None,
    anchored: bool = False,
    frame: _Frame | None = None,
) -> tuple[_Patch, _Frame, list[tuple[str, str]]]:
    """Return a patch, its frame, and (address, why) of what it does not hold."""

def graft_patch(
    setting: Setting,
    forest: Forest,
    patch: _Patch,
    frames: list[_Frame],
    *,
    within: Selection | None = None,
) -> tuple[Forest, list[str], list[tuple[list[int], list[tuple[str, int | None, str]]]]]:
    """Return the closed forest, the edits, and for every frame the cells written and skipped.

    What is skipped is (walk, top-level cell, why).
    """

def check_patch(setting: Setting, patch: _Patch) -> None:
    """Refuse a patch that can't be read, or has types that the method does not allow."""

def best_frame(setting: Setting, patch: _Patch, vertex: int) -> _Frame | None:
    """Return the frame at a base vertex in which a patch fits best."""

def misfits(setting: Setting, patch: _Patch, frames: list[_Frame]) -> list[tuple[int, int]]:
    """Return how badly a patch lies in frames: cells skipped, sides free that were not or were."""

def turned_patch(setting: Setting, patch: _Patch, turn: int, mirrored: bool) -> _Patch:
    """Return a patch as it is seen after quarter turns, mirrored or not."""

@final
class Symmetries:
    """Rotations and mirrors of a framework that carry anchors to anchors."""

    def __new__(cls, setting: Setting) -> Symmetries: ...
    def __len__(self, /) -> int: ...
    @property
    def mirrored(self) -> list[bool]:
        """Which of them mirror cells."""

    def images(self, frame: _Frame) -> list[_Frame]:
        """Return where every one of them carries a frame."""

    def node_images(self, mesh: BaseMesh, node: str) -> list[str]:
        """Return where every one of them carries a node."""

    def carried(self, setting: Setting, forest: Forest, number: int) -> Forest:
        """Return a forest as one of them carries it, without added and cut springs."""

    def edits(self, setting: Setting, edits: list[str]) -> list[str]:
        """Return edits and their images, each once."""

    def check(self, setting: Setting, forest: Forest) -> None:
        """Refuse a forest that is not symmetric."""

# --- evolution ---------------------------------------------------------------------------------

class _Generation(TypedDict):
    columns: dict[str, NDArray[Any]]
    """One row an individual; undefined numbers are NaN."""
    winner: int | None
    """Index of the individual that became parent; None: the parent stayed."""
    edits: list[str]
    """What made the winner of the parent before."""
    strategy: _Strategy
    """Strategy of the parent now."""
    suf: float | None
    """Spring utilization factor of the parent now."""

@final
class Evolution:
    """A run of the hybrid evolutionary algorithm at some generation."""

    def __new__(
        cls,
        setting: Setting,
        forest: Forest,
        *,
        population: int,
        seed: int,
        types: list[str],
        strategy: _Strategy,
        base: float,
        exponent: float,
        self_adapt: bool,
        fitness: str,
        suf_reference: str,
        niche: int | None,
        min_length: float | None,
        min_springs: int | None,
        max_springs: int | None,
        selection: str,
        threads: int,
        genes: list[_Patch] = ...,
        grafts: tuple[bool, float] = ...,
        symmetries: Symmetries | None = None,
        within: Selection | None = None,
        cell_weights: list[tuple[str, float]] = ...,
        resumed: tuple[int, _Standing, float | None] | None = None,
    ) -> Evolution:
        """Start at a forest, or go on after a generation.

        `resumed` is (generation, standing of the run's start, the parent's spring utilization
        factor). `min_length` is in m. `cell_weights` are factors by address of cells.
        """

    def advance(self) -> _Generation:
        """Make one generation and take its winner as parent."""

    def individual(self, index: int) -> list[str]:
        """Return the edits that make an individual of the next generation of the parent now."""

    def stages(self, count: int, rounds: int) -> dict[str, NDArray[np.float64]]:
        """Make the first individuals of the next generation on this thread, round after round.

        Returns the seconds that each stage took, by name, one a round: mutate, filter, nodes,
        order, factor, solve, measure. The run stays where it is.
        """

    def reached(
        self,
        generations: int | None,
        springs: int | None,
        differential: float | None,
        suf: float | None,
    ) -> _Ending | None:
        """Return the ending condition that holds now."""

    @property
    def forest(self) -> Forest:
        """Closed genotype of the parent now."""

    @property
    def measures(self) -> _Measures:
        """Measures of the parent now."""

    @property
    def generation(self) -> int:
        """Number of generations made."""

    @property
    def start(self) -> _Standing:
        """Standing of the design that the run began with."""

@final
class Census:
    """Patches that recur in a run, and how their carriers fared."""

    def __new__(cls, setting: Setting, sites: list[tuple[int, bool, Selection]]) -> Census:
        """Look at sites: (base vertex, whether it is an anchor, cells)."""

    def count(self, evolution: Evolution, scores: list[float | None]) -> None:
        """Count the individuals of the next generation by their scores; None: left out."""

    def ranked(self, least: int) -> list[tuple[_Patch, int, float, tuple[int, int]]]:
        """Return (patch, carriers, sum of scores, the best carrier) of patches, best first."""

@final
class StressSeeking:
    """A net that is refined where its force is."""

    def __new__(
        cls, setting: Setting, forest: Forest, kind: str, *, symmetries: Symmetries | None = None
    ) -> StressSeeking: ...
    def advance(self) -> list[str]:
        """Subdivide the cell of highest inner force, or its orbit; return the edits, if any."""

    def reached(
        self, step: int, steps: int | None, differential: float | None, suf: float | None
    ) -> _Ending | None:
        """Return the ending condition that holds after `step` steps."""

    @property
    def suf(self) -> float | None:
        """Spring utilization factor against the start."""

    @property
    def forest(self) -> Forest:
        """Closed genotype now."""

    @property
    def measures(self) -> _Measures:
        """Measures now."""
