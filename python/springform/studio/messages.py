"""Every message between the engine and a window, declared once; TypeScript is generated from here.

Windows send requests as JSON, one a text frame. The engine answers each that has a number with a
`Reply`, tells events as JSON, and sends nets and motion as binary frames (`frames`). Positions and
lengths in m, forces in N.
"""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter
from pydantic.json_schema import GenerateJsonSchema

from .changes import Place
from .editing_messages import CurvePoints, DropSprings, SetDensity, SetSprings, SpringGroupLine
from .figure_messages import Figures
from .frame_messages import Frame
from .graft_messages import (
    AskSymmetry,
    CopyPatch,
    DeletePatch,
    Graft,
    GraftPlan,
    ListPatches,
    Patches,
    PlanGraft,
    RenamePatch,
    SelectCells,
    SymmetryState,
)
from .live_messages import LiveEvolve, LiveState, WeighCells
from .message_base import Address, Key, Vector
from .message_base import Message as _Message
from .pin_messages import Compared, Comparing, Pin, Pins, RenamePin, Unpin
from .run_messages import (
    Brushes,
    Clusters,
    Evolve,
    Follow,
    Lineage,
    Look,
    Looked,
    OpenRun,
    Reinstate,
    RunState,
    SteerRun,
)
from .shelf_messages import Folder, Opened, Opening, Shelf

# --- requests: from a window to the engine --------------------------------------------------------


class EditCells(_Message):
    """Subdivide, switch off, switch on or retype cells."""

    type: Literal["edit_cells"] = "edit_cells"
    id: int
    what: Literal["subdivide", "off", "on", "retype", "turn"]
    cells: Annotated[list[Address], Field(min_length=1, max_length=100_000)]
    kind: Annotated[str, Field(max_length=100)] | None = None
    """Cell type of the children, or the new type."""
    orbit: bool = False
    """Whether the images under the framework's symmetries are edited too."""


class EditSpring(_Message):
    """Cut the spring between two nodes, or add one."""

    type: Literal["edit_spring"] = "edit_spring"
    id: int
    what: Literal["cut", "add"]
    nodes: Annotated[list[Key], Field(min_length=2, max_length=2)]
    orbit: bool = False
    """Whether the images under the framework's symmetries are cut or added too."""


class MoveAnchor(_Message):
    """Hold an anchor somewhere else."""

    type: Literal["move_anchor"] = "move_anchor"
    id: int
    anchor: Key
    position: Vector


class FixNode(_Message):
    """Make a base vertex an anchor where it is now, hold an anchor otherwise, or let it go."""

    type: Literal["fix_node"] = "fix_node"
    id: int
    node: Key
    fixed: bool
    holds: Literal["x", "y", "z", "xy", "xz", "yz", "xyz"] = "xyz"
    """Along which axes it is held; it slides along the others."""
    line: Vector | None = None
    """Direction of a line on which it slides."""
    plane: Vector | None = None
    """Normal of a plane in which it slides."""


class SeekStress(_Message):
    """Subdivide the cell of highest inner force, a number of times."""

    type: Literal["seek_stress"] = "seek_stress"
    id: int
    steps: Annotated[int, Field(ge=1, le=1000)]
    kind: Annotated[str, Field(max_length=100)]
    orbit: bool = False
    """Whether a step subdivides all images of the cell under the framework's symmetries."""


class SetValue(_Message):
    """Change a value of the design file."""

    type: Literal["set_value"] = "set_value"
    id: int
    label: Annotated[str, Field(max_length=200)]
    path: Annotated[list[str | int], Field(max_length=20)]
    value: Any


class SetFramework(_Message):
    """Change the framework; cells that no longer fit start anew."""

    type: Literal["set_framework"] = "set_framework"
    id: int
    framework: dict[str, Any]


class Preview(_Message):
    """Tell what an action would do, and do nothing."""

    type: Literal["preview"] = "preview"
    id: int
    action: Annotated[
        EditCells | EditSpring | SeekStress | SetDensity | SetValue | SetSprings,
        Field(discriminator="type"),
    ]


class Undo(_Message):
    """Undo the last action, or redo the one that was undone last."""

    type: Literal["undo"] = "undo"
    id: int
    redo: bool


class Travel(_Message):
    """Undo or redo until a number of actions is done."""

    type: Literal["travel"] = "travel"
    id: int
    position: Annotated[int, Field(ge=0)]


class Save(_Message):
    """Write the design file; a path makes it the document's file."""

    type: Literal["save"] = "save"
    id: int
    path: Annotated[str, Field(max_length=4000)] | None = None
    replace: bool = False
    """Whether another file that exists is replaced."""


class Revert(_Message):
    """Put back what the document's file holds; an action like any other."""

    type: Literal["revert"] = "revert"
    id: int


class Move(_Message):
    """Let the net move, stop it, make one step, or put it back to where it was drawn."""

    type: Literal["move"] = "move"
    id: int
    what: Literal["run", "pause", "step", "reset"]


class Hold(_Message):
    """Hold a node somewhere for as long as it is dragged."""

    type: Literal["hold"] = "hold"
    node: Key
    position: Vector


class Release(_Message):
    """Let the dragged node go."""

    type: Literal["release"] = "release"


class Received(_Message):
    """A frame of motion was drawn; the engine may send another."""

    type: Literal["received"] = "received"


Request = Annotated[
    EditCells
    | EditSpring
    | MoveAnchor
    | FixNode
    | SeekStress
    | SetValue
    | SetFramework
    | SetSprings
    | DropSprings
    | SetDensity
    | Preview
    | Undo
    | Travel
    | Save
    | Revert
    | Move
    | Evolve
    | SteerRun
    | OpenRun
    | Look
    | Follow
    | Reinstate
    | Pin
    | Unpin
    | RenamePin
    | LiveEvolve
    | WeighCells
    | SelectCells
    | AskSymmetry
    | ListPatches
    | CopyPatch
    | RenamePatch
    | DeletePatch
    | PlanGraft
    | Graft
    | Hold
    | Release
    | Received,
    Field(discriminator="type"),
]
REQUEST: TypeAdapter[Request] = TypeAdapter(Request)


# --- events: from the engine to windows -----------------------------------------------------------


class HistoryLine(_Message):
    """One action of the history."""

    label: str
    number: int
    """Actions done once this one is, from 1."""
    origin: Place | None
    """Where the net was taken from, if it was taken over as a whole."""


class AnchorState(_Message):
    """An anchor as the design file holds it."""

    name: str
    node: Key
    position: Vector
    holds: str
    """Along which axes it is held."""
    line: Vector | None
    """Direction of the line on which it slides."""
    plane: Vector | None
    """Normal of the plane in which it slides."""


class PreviewState(_Message):
    """What an action would do."""

    springs_added: int
    springs_removed: int
    cells_added: int
    cells_removed: int
    figures: Figures
    """Figures after it."""
    added: list[float]
    """Ends of the springs that would come, six numbers each [m]; empty if they are very many."""
    removed: list[float]
    """Ends of the springs that would go, six numbers each [m]; empty if they are very many."""


class CellTypeChoice(_Message):
    """A cell type that the method allows."""

    word: str
    name: str


class DocumentState(_Message):
    """The document as it is now."""

    type: Literal["document"] = "document"
    document: str
    name: str
    file: str | None
    """The design file that saving writes."""
    saved: bool
    """Whether that file holds the document as it is now."""
    method: str
    revision: int
    """Revision of the net."""
    position: int
    """Actions done."""
    length: int
    """Actions that are done or can be redone."""
    history: list[HistoryLine]
    """The actions round the position, in order."""
    figures: Figures
    own: Figures
    """Figures of the design, whatever is looked at."""
    before: Figures | None
    """Figures before the last action; None at the start."""
    anchors: list[AnchorState]
    cell_types: list[CellTypeChoice]
    framework: dict[str, Any]
    stiffness: float
    ring_factor: float
    spring_groups: list[SpringGroupLine]
    """What is said of some springs; of two that say the same of a spring, the later counts."""
    looking: Looked | None
    """What is shown instead of the design; figures and net are of that."""


class Welcome(_Message):
    """First message to a window."""

    type: Literal["welcome"] = "welcome"
    protocol: str
    """Hash of these declarations; a window of another protocol must be loaded anew."""
    version: str


Answer = Annotated[SymmetryState | GraftPlan, Field(discriminator="type")]


class Reply(_Message):
    """Answer to a request."""

    type: Literal["reply"] = "reply"
    id: int
    problem: str | None = None
    """What is wrong and what to do; None: it was done."""
    key: str | None = None
    """What the problem is about, such as a parameter, where that is known."""
    cells: list[Address] = Field(default=[])
    """Cells that the action made or changed."""
    preview: PreviewState | None = None
    """What was asked by `preview`."""
    answer: Answer | None = None
    """What else was asked for."""


class Problem(_Message):
    """Something went wrong that no request asked for."""

    type: Literal["problem"] = "problem"
    message: str


Event = Annotated[
    DocumentState | RunState | Pins | LiveState | Patches | Welcome | Reply | Problem,
    Field(discriminator="type"),
]


# --- what is fetched ------------------------------------------------------------------------------


class Refusal(_Message):
    """Why something that was fetched is refused."""

    problem: str


class Protocol(_Message):
    """All of them, for the generator."""

    request: Request
    event: Event
    frame: Frame
    shelf: Shelf
    folder: Folder
    opening: Opening
    opened: Opened
    refusal: Refusal
    lineage: Lineage
    brushes: Brushes
    clusters: Clusters
    comparing: Comparing
    compared: Compared
    curve: CurvePoints


class _PlainSchema(GenerateJsonSchema):
    """Without titles of fields, or every field would be a type of its own in TypeScript."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False


def schema() -> dict[str, Any]:
    """Return the JSON Schema of all messages."""
    return Protocol.model_json_schema(schema_generator=_PlainSchema, mode="serialization")


def protocol() -> str:
    """Return a hash of all messages."""
    return hashlib.sha256(json.dumps(schema(), sort_keys=True).encode()).hexdigest()[:16]
