"""Messages of selections, patches, grafts and symmetries."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ..schema_base import NAME_PATTERN
from .message_base import Address, Key, Message, Side

PatchName = Annotated[str, Field(pattern=NAME_PATTERN, max_length=60)]


class SelectCells(Message):
    """Find the cells that words select in what is shown; the reply names them."""

    type: Literal["select_cells"] = "select_cells"
    id: int
    words: Annotated[str, Field(max_length=4000)] | None
    """A selection as files and the command line have it, such as ``rings(A7, 2)``."""
    cells: Annotated[list[Address], Field(max_length=100_000)] = Field(default_factory=list)
    """Cells to start from, if there are no words."""
    around_best: Annotated[int, Field(ge=1, le=100)] | None = None
    """Rings of cells round the anchor that is resolved best, instead of words."""
    grow: Annotated[int, Field(ge=-100, le=100)] = 0
    """Rings of cells to add to them, or to take away."""
    orbit: bool = False
    """Whether their images under the framework's symmetries are selected too."""


class AskSymmetry(Message):
    """Ask which symmetries the framework has, and whether the net has them too."""

    type: Literal["ask_symmetry"] = "ask_symmetry"
    id: int


class ListPatches(Message):
    """Read the folder of patches again."""

    type: Literal["list_patches"] = "list_patches"
    id: int


class CopyPatch(Message):
    """Lift a patch from a net and keep it in the folder of patches.

    The net is named, since what is shown changes while a run is followed.
    """

    type: Literal["copy_patch"] = "copy_patch"
    id: int
    name: PatchName
    cells: Annotated[list[Address], Field(min_length=1, max_length=100_000)]
    anchor: Key | None
    """Anchor that it is seen from."""
    seed: Annotated[int, Field(ge=0)] | None
    """Top-level cell that it is seen from; None of both: whatever needs the fewest words."""
    side: Side = "design"


class RenamePatch(Message):
    """Give a patch another name."""

    type: Literal["rename_patch"] = "rename_patch"
    id: int
    patch: PatchName
    name: PatchName


class DeletePatch(Message):
    """Delete the file of a patch."""

    type: Literal["delete_patch"] = "delete_patch"
    id: int
    patch: PatchName


class _Placing(Message):
    patch: PatchName
    cell: Annotated[int, Field(ge=0)] | None
    """Top-level cell that the seed is set on."""
    anchor: Key | None
    """Anchor that it is set on; None of both: every anchor."""
    rotate: Annotated[int, Field(ge=-1000, le=1000)]
    """Steps: quarter turns, or round an anchor from cell to cell while the patch stays whole."""
    mirror: bool
    orbit: bool
    """Whether it is set on all images under the framework's symmetries."""


class PlanGraft(_Placing):
    """Ask where a patch would come to lie and, if wanted, what it would change."""

    type: Literal["plan_graft"] = "plan_graft"
    id: int
    measure: bool


class Graft(_Placing):
    """Set a patch on the design."""

    type: Literal["graft"] = "graft"
    id: int


class PatchTile(Message):
    """A cell of a patch, laid out flat."""

    x: float
    """Left, in top-level cells from the seed."""
    y: float
    """Bottom."""
    size: float
    kind: str
    """Cell type."""


class PatchEntry(Message):
    """A patch of the folder."""

    name: str
    problem: str
    """Why the file can't be used; empty if it can."""
    anchored: bool
    tiles: list[PatchTile]
    top_level: int
    """Top-level cells."""
    origin: str
    """Where it comes from, in words."""
    force_max: float | None
    """Largest force in its cells where it comes from [N]."""


class Patches(Message):
    """The folder of patches."""

    type: Literal["patches"] = "patches"
    folder: str
    patches: list[PatchEntry]


class SymmetryState(Message):
    """The symmetries of the framework."""

    type: Literal["symmetry"] = "symmetry"
    rotations: int
    """With the identity."""
    mirrors: int
    broken: str
    """Where the net does not have them; empty: it does."""
    problem: str
    """Why they can't be used; empty: they can."""


class GraftFigures(Message):
    """What a graft changes."""

    springs: int
    force_differential: float | None
    force_max: float
    force_min: float
    dangling: int
    """Nodes at the end of a single spring, and no anchor."""
    converged: bool


class PlacedPatch(Message):
    """A patch where it would be set."""

    cell: int
    """Top-level cell of the seed."""
    anchor: Key | None
    cells: list[int]
    """Top-level cells that are written."""


class GraftPlan(Message):
    """What a graft would do."""

    type: Literal["plan"] = "plan"
    placed: list[PlacedPatch]
    skipped: list[str]
    """What would be left out, and why."""
    outline: list[float]
    """Borders of the cells that are written, a segment six numbers [m]."""
    springs: list[float]
    """Springs of these cells [m]."""
    turns: int
    """Steps of rotation after which it lies as at first; 1: it lies whole in one way only."""
    before: GraftFigures | None
    after: GraftFigures | None
