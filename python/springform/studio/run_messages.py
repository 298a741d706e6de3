"""Messages of runs, and of their individuals."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from .message_base import Message, Side


class Evolve(Message):
    """Start a run with parameters; what is left out has its default."""

    type: Literal["evolve"] = "evolve"
    id: int
    side: Side = "design"
    """The net that it starts from."""
    parameters: dict[str, Any]


class SteerRun(Message):
    """Pause a run, let it go on, end it, or change parameters from the next generation on."""

    type: Literal["steer_run"] = "steer_run"
    id: int
    what: Literal["pause", "continue", "stop", "change"]
    parameters: dict[str, Any] = Field(default={})


class Look(Message):
    """Show a parent or an individual of the run instead of the design, or the design again."""

    type: Literal["look"] = "look"
    id: int
    generation: Annotated[int, Field(ge=0)] | None
    """None: the design."""
    individual: Annotated[int, Field(ge=0)] | None
    """None: the parent that the generation chose."""
    pin: int | None = None
    """What is pinned, instead of a generation."""


class Follow(Message):
    """Show the parent of the newest generation for as long as the run goes on, or no longer."""

    type: Literal["follow"] = "follow"
    id: int
    on: bool


class Reinstate(Message):
    """Make a net the design; it is named, since what is shown changes while a run is followed."""

    type: Literal["reinstate"] = "reinstate"
    id: int
    side: Side


class Looked(Message):
    """A parent, an individual or something pinned that is shown instead of the design."""

    label: str
    """Such as ``Generation 34, individual 2``."""
    generation: int | None
    """In the document's run; None: it is pinned, and of no run or of an earlier one."""
    individual: int | None
    pin: int | None
    """Of what is in no generation of the run."""


class GenerationRow(Message):
    """What a generation gave: its parent now, and the force differentials of its individuals."""

    generation: int
    springs: int
    force_differential: float | None
    suf: float | None
    winner: int | None
    """Individual that became parent; None: the parent stayed."""
    least: float | None
    low: float | None
    """First quartile."""
    median: float | None
    high: float | None
    """Third quartile."""
    changed: bool
    """Parameters were changed after it."""


class OpenRun(Message):
    """Show another run of the document, to look at and to go on with."""

    type: Literal["open_run"] = "open_run"
    id: int
    number: int


class RunLine(Message):
    """A run of the document, in short."""

    number: int
    """In the order in which they were started, from 1."""
    name: str
    """Its folder, as pins and the history name it."""
    generations: int
    springs: int
    """Of its last parent."""
    force_differential: float | None
    fitness: str
    """What its best has least of."""


class RunState(Message):
    """The run of the document that is shown, and which others there are."""

    type: Literal["run"] = "run"
    status: Literal["none", "running", "paused", "ended", "failed"]
    reason: str
    folder: str
    name: str
    """The folder as pins and the history name it."""
    driver: str
    """Another process that drives it; empty: this studio does, or nobody."""
    following: bool
    parameters: dict[str, Any]
    start_springs: int
    """Of the design that it started from."""
    start_differential: float | None
    runs: list[RunLine]
    """All runs of the document, the newest first; the one that is shown has its `name`."""
    generations: int
    """Generations made."""
    first: int
    """Generation of the first row; earlier ones are as they were told before."""
    rows: list[GenerationRow]


class LineageStep(Message):
    """An ancestor, or the individual itself: what its mutation changed."""

    generation: int
    individual: int
    springs: int
    force_differential: float | None
    edits: list[str]
    """Such as ``12.0 subdivide 1 1 6 1``."""


class Lineage(Message):
    """Where an individual came from, the last step last."""

    steps: list[LineageStep]


class Brushes(Message):
    """Ask for clusters of what is brushed on axes."""

    brushes: dict[str, Annotated[list[float], Field(min_length=2, max_length=2)]]
    """Least and most by axis."""
    count: int


class Cluster(Message):
    """A cluster of individuals, by the one nearest to its middle."""

    generation: int
    individual: int
    size: int


class Clusters(Message):
    """Clusters of what is brushed, the largest first."""

    brushed: int
    """Individuals that are brushed."""
    clusters: list[Cluster]
