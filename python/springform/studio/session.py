"""A session: one open document, its net in motion, and the windows that look at it."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError

from .. import _core
from ..arrays import Floats
from ..design import Design, load, save
from ..design_schema import DesignFile
from ..errors import InputError, SpringformError
from ..patch_file import Origin
from . import commands, grafts, journal
from .changes import Action, values_of
from .choosing import brushed, clusters
from .document import Document
from .evolving import Evolving
from .frames import Tables, encode, net_frame, tables_of
from .graft_messages import (
    AskSymmetry,
    CopyPatch,
    DeletePatch,
    Graft,
    ListPatches,
    PlanGraft,
    RenamePatch,
    SelectCells,
)
from .library import file_hash
from .live import Grown
from .live_stage import LiveStage
from .messages import (
    REQUEST,
    AnchorState,
    Answer,
    Brushes,
    Cluster,
    Clusters,
    DocumentState,
    Evolve,
    Figures,
    Follow,
    HistoryLine,
    Hold,
    Lineage,
    LiveEvolve,
    Look,
    Looked,
    Move,
    MoveAnchor,
    Preview,
    PreviewState,
    Problem,
    Received,
    Reinstate,
    Release,
    Reply,
    Request,
    RunState,
    Save,
    SteerRun,
    TableHeader,
    Travel,
    Undo,
    WeighCells,
    Welcome,
    protocol,
)
from .motion import Motion, State
from .patches import PatchFolder
from .preview import preview_of
from .spring_groups import group_lines
from .telling import cell_types_of, figures_of, motion_frame, picture_of, state_of

_FRAMES_ON_THE_WAY = 3
"""Frames of motion that a window may not yet have drawn; more would only make it lag."""

_NETS_KEPT = 8
"""Earlier nets that a window may still have, so that it is sent what changed."""

_RUN_PERIOD = 0.1
"""Seconds between messages about the run [s]."""

_HISTORY_SHOWN = 200
"""Actions on each side of the position that windows are told."""

T = TypeVar("T")


class Window:
    """One window: what it has been sent, and what waits for it."""

    def __init__(self) -> None:
        self._events: deque[str] = deque()
        self._wake = asyncio.Event()
        self.revision = 0
        """Revision of the net that the window has; 0: none."""
        self.drawn: State | None = None
        """State of motion that it was sent last."""
        self.on_the_way = 0
        """Frames of motion that it has not yet drawn."""
        self.generations = 0
        """Generations of the run that it was told of."""

    def tell(self, event: BaseModel) -> None:
        """Send an event."""
        self._events.append(event.model_dump_json())
        self._wake.set()

    def wake(self) -> None:
        """Look whether there is something to send."""
        self._wake.set()

    def next_event(self) -> str | None:
        """Return the event to send next, if one waits."""
        return self._events.popleft() if self._events else None

    async def woken(self) -> None:
        """Wait until there may be something to send."""
        await self._wake.wait()
        self._wake.clear()


class Session:
    """An open document. All methods run in the event loop; the work is done in threads."""

    def __init__(self, folder: Path) -> None:
        """Open a document's folder. Raises `InputError`: see `journal.reopen`."""
        self._stack = ExitStack()
        self._journal = self._stack.enter_context(journal.reopen(folder))
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="document")
        self._order = asyncio.Lock()
        self._loop = asyncio.get_running_loop()
        self._windows: set[Window] = set()
        self._patches = PatchFolder(folder.parent / "patches")
        self._figures: dict[int, Figures] = {}
        self._looking: tuple[Looked, Design, Figures] | None = None
        self._following = False
        self._run: Evolving | None = self._newest_run()
        self._live = LiveStage(self._tell_all, self._show_grown)
        self._run_told = 0.0
        self._run_waits = False
        self._revision = 0
        self._nets: dict[int, tuple[Design, Tables]] = {}
        self._state: State | None = None
        self._state_frame: bytes = b""
        self._saved = self._read_file()
        self._motion = Motion(lambda state: self._call(self._moved, state))
        self._take_design()

    @property
    def design(self) -> Design:
        """The design now."""
        return self._journal.document.design

    @property
    def shown(self) -> Design:
        """The design, or the individual that is shown instead."""
        return self.design if self._looking is None else self._looking[1]

    async def close(self) -> None:
        """End the motion, write a snapshot and let the folder go."""
        async with self._order:
            await self._live.close()
            if self._run is not None:
                await asyncio.to_thread(self._run.stop)
            self._motion.close()
            self._worker.shutdown()
            self._stack.close()

    # --- windows -------------------------------------------------------------------------------

    async def join(self, version: str) -> Window:
        """Return a new window; it is sent the document and the net."""
        window = Window()
        window.tell(Welcome(protocol=protocol(), version=version))
        async with self._order:
            self._windows.add(window)
            window.tell(self._document_state())
            self._tell_run(window)
            window.tell(self._live.state())
        return window

    def leave(self, window: Window) -> None:
        """Forget a window and let go what it holds."""
        self._windows.discard(window)
        self._motion.release(window)
        if not self._windows:
            self._live.pause()

    async def outgoing(self, window: Window) -> AsyncIterator[str | bytes]:
        """Yield what a window is to be sent, for as long as somebody asks."""
        while True:
            await window.woken()
            while (event := window.next_event()) is not None:
                yield event
            if window.revision != self._revision:
                base = self._nets.get(window.revision)
                before = None if base is None else (window.revision, base[1])
                window.revision = self._revision
                yield net_frame(*self._nets[self._revision], self._revision, before)
            state = self._state
            if (
                state is not None
                and state is not window.drawn
                and state.revision == window.revision
                and window.on_the_way < _FRAMES_ON_THE_WAY
            ):
                window.drawn = state
                window.on_the_way += 1
                yield self._motion_frame(state)

    async def receive(self, window: Window, text: str | bytes) -> None:
        """Do what a window asks; whatever it sends, the session goes on."""
        try:
            request = REQUEST.validate_json(text)
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            place = ".".join(str(part) for part in first["loc"])
            window.tell(Problem(message=f"not understood: {place}: {first['msg']}"))
            return
        try:
            if isinstance(request, Preview):
                self._answer(window, request, preview=await self._preview(request))
                return
            cells, answer = await self._do(window, request)
        except SpringformError as error:
            self._answer(window, request, problem=str(error))
        except _core.CoreError as error:
            key, problem = error.args
            self._answer(window, request, problem=f"{key}: {problem}")
        else:
            self._answer(window, request, cells=cells, answer=answer)

    def _answer(self, window: Window, request: Request, **answer: Any) -> None:
        number = getattr(request, "id", None)
        if number is not None:
            window.tell(Reply(id=number, **answer))
        elif "problem" in answer:
            window.tell(Problem(message=answer["problem"]))

    async def _do(self, window: Window, request: Request) -> tuple[list[str], Answer | None]:
        match request:
            case Received():
                window.on_the_way = max(0, window.on_the_way - 1)
                window.wake()
            case Hold():
                if request.node not in self.node_rows:
                    raise InputError("is no node of the net", key=request.node)
                if self._live.live is None:
                    self._motion.hold(window, request.node, np.array(request.position))
                else:
                    self._live.move_anchor(self._anchor_at(request.node), request.position)
            case Release():
                self._motion.release(window)
            case Move():
                self._motion.command(request.what)
            case SelectCells() | AskSymmetry() | PlanGraft():
                async with self._order:
                    return await self._in_thread(lambda: self._found(request))
            case ListPatches() | CopyPatch() | RenamePatch() | DeletePatch():
                async with self._order:
                    await self._file_patch(request)
            case _:
                async with self._order:
                    return await self._change(request), None
        return [], None

    # --- the document --------------------------------------------------------------------------

    @property
    def node_rows(self) -> set[str]:
        """Keys of the nodes of the net."""
        return self._node_keys

    async def _change(self, request: Request) -> list[str]:
        cells: list[str] = []
        match request:
            case Evolve() | SteerRun():
                await self._steer(request)
                return []
            case LiveEvolve():
                await self._steer_live(request)
            case WeighCells():
                await self._live.weigh(request)
                return []
            case MoveAnchor() if self._live.live is not None:
                self._live.move_anchor(request.anchor, request.position)
                return []
            case Look():
                self._following = False
                await self._look(request.generation, request.individual)
                self._tell_runs()
            case Follow():
                await self._follow(request.on)
            case Reinstate():
                await self._reinstate()
            case Save():
                await self._in_thread(lambda: self._save(request))
            case Undo() | Travel():
                await self._travel(self._goal(request))
            case Graft():
                patch = await self._in_thread(lambda: self._patches.load(request.patch))
                cells = await self.act(lambda: grafts.graft_action(self.design, patch, request))
            case _:
                cells = await self.act(
                    lambda: commands.action_of(self.design, request, self._now())
                )
        self._tell_document()
        return cells

    def _now(self) -> Floats:
        """Return where the nodes of the net are."""
        return self.design.solve().positions if self._state is None else self._state.positions

    def _goal(self, request: Undo | Travel) -> int:
        document = self._journal.document
        if isinstance(request, Travel):
            if request.position > len(document.actions):
                raise InputError(f"there are {len(document.actions)} actions", key="position")
            return request.position
        if request.redo and document.position == len(document.actions):
            raise InputError("there is nothing to redo")
        if not request.redo and document.position == 0:
            raise InputError("there is nothing to undo")
        return document.position + (1 if request.redo else -1)

    async def act(self, make: Callable[[], tuple[Action, list[str]]]) -> list[str]:
        """Do an action in the document's thread, show its net, and return the cells it made."""
        self._check_design_is_shown()

        def done() -> list[str]:
            action, cells = make()
            self._journal.do(action)
            return cells

        cells = await self._in_thread(done)
        await self._show()
        return cells

    async def _preview(self, request: Preview) -> PreviewState:
        self._check_design_is_shown()
        # A copy of its own, so that actions need not wait for what is only looked at.
        document, positions = Document(self.design), self._now()

        def look() -> PreviewState:
            action, _ = commands.action_of(document.design, request.action, positions)
            return preview_of(document, action, positions)

        return await asyncio.to_thread(look)

    async def _travel(self, position: int) -> None:
        self._check_design_is_shown()
        document = self._journal.document

        def travel() -> None:
            while document.position > position:
                self._journal.undo()
            while document.position < position:
                self._journal.redo()

        await self._in_thread(travel)
        await self._show()

    async def _show(self) -> None:
        await self._in_thread(self._measure)
        self._take_design()

    async def _in_thread(self, work: Callable[[], T]) -> T:
        return await self._loop.run_in_executor(self._worker, work)

    def _save(self, request: Save) -> None:
        settings = self._journal.settings
        path = request.path or settings.file
        if path is None:
            raise InputError("the document has no file yet; say where to save it", key="path")
        target = Path(path).expanduser()
        if not target.is_absolute():
            target = Path.cwd() / target
        own = settings.file is not None and target == Path(settings.file)
        if target.exists() and not (own or request.replace):
            raise InputError("exists; choose another name or allow to replace it", file=target)
        save(self.design, target)
        self._journal.belong_to(str(target), file_hash(target))
        self._saved = self.design.to_file()

    def _read_file(self) -> DesignFile | None:
        """Return what the document's file holds; take it over if it was changed elsewhere."""
        settings = self._journal.settings
        if settings.file is None or (now := file_hash(settings.file)) is None:
            return None
        try:
            held = load(settings.file).closed
        except InputError:
            return None
        if now != settings.saved:
            label = f"Read {Path(settings.file).name}, changed elsewhere"
            self._journal.do(commands.whole(self.design, held, label))
            self._journal.belong_to(settings.file, now)
        return held.to_file()

    # --- live evolution ------------------------------------------------------------------------

    async def _steer_live(self, request: LiveEvolve) -> None:
        if request.what == "start":
            self._check_design_is_shown()
            self._following = False
        kept = await self._live.steer(request, self.design)
        if kept is not None:
            design, generation = kept
            label = f"Evolve live, {generation} generation{'' if generation == 1 else 's'}"
            await self.act(lambda: (commands.whole(self.design, design, label), []))
        elif request.what == "discard":
            self._take_design()

    def _show_grown(self, grown: Grown) -> None:
        self._revision += 1
        self._node_keys = set(grown.design.nodes)
        self._keep_net(grown.design, grown.tables)
        self._motion.place(grown.design.nodes, grown.equilibrium.positions)
        self._state, self._state_frame = state_of(grown.equilibrium, self._revision), b""
        for window in self._windows:
            window.wake()

    def _anchor_at(self, node: str) -> str:
        design = self.design
        for row, name in zip(design.anchors, design.anchor_names, strict=True):
            if design.nodes[row] == node:
                return name
        problem = "is no anchor; while the net evolves only anchors can be dragged"
        raise InputError(problem, key=node)

    # --- selections and patches ----------------------------------------------------------------

    def _found(
        self, request: SelectCells | AskSymmetry | PlanGraft
    ) -> tuple[list[str], Answer | None]:
        if isinstance(request, SelectCells):
            return grafts.selected(self.shown, request), None
        if isinstance(request, AskSymmetry):
            return [], grafts.symmetry_state(self.design)
        self._check_design_is_shown()
        patch = self._patches.load(request.patch)
        return [], grafts.planned(self.design, patch, request, self._now(), request.measure)

    async def _file_patch(
        self, request: ListPatches | CopyPatch | RenamePatch | DeletePatch
    ) -> None:
        await self._in_thread(lambda: self._filed(request))
        listing = await self._in_thread(self._patches.listing)
        for window in self._windows:
            window.tell(listing)

    def _filed(self, request: ListPatches | CopyPatch | RenamePatch | DeletePatch) -> None:
        match request:
            case CopyPatch():
                looked = None if self._looking is None else self._looking[0]
                origin = Origin()
                if looked is not None:
                    run, place = str(self._known_run().folder), looked.individual
                    origin = Origin(run=run, generation=looked.generation, individual=place)
                self._patches.keep(grafts.lifted(self.shown, request, origin))
            case RenamePatch():
                self._patches.rename(request.patch, request.name)
            case DeletePatch():
                self._patches.delete(request.patch)

    # --- the run -------------------------------------------------------------------------------

    def _newest_run(self) -> Evolving | None:
        """Return the run that the document had last, to look at and to go on with."""
        folders = sorted((self._journal.folder / "runs").glob("[0-9]*"), reverse=True)
        if self._journal.settings.run is not None:
            folders.append(Path(self._journal.settings.run))
        for folder in folders:
            run = Evolving(folder, self._run_changed)
            try:
                run.open()
            except InputError:
                continue  # it died before it was a run
            return run
        return None

    async def _steer(self, request: Evolve | SteerRun) -> None:
        run = self._run
        if isinstance(request, Evolve):
            if self._live.live is not None:
                raise InputError("the net evolves; keep or discard what it grew first")
            if run is not None:
                await asyncio.to_thread(run.stop)
            runs = self._journal.folder / "runs"
            run = Evolving(runs / f"{len(list(runs.glob('*'))) + 1:04}", self._run_changed)
            values = {"cell_weights": self._live.weights} | request.parameters
            start = self._start_of(request)
            await self._in_thread(lambda: run.start(start, values))
            self._run, self._following = run, True
            for window in self._windows:
                window.generations = 0
        elif run is None:
            raise InputError("there is no run; start one")
        elif request.what == "change":
            await self._in_thread(lambda: run.change(request.parameters))
        elif request.what == "continue":
            await self._in_thread(run.go_on)
        elif request.what == "pause":
            await self._in_thread(run.pause)
        elif not await self._in_thread(run.end_driver):
            await asyncio.to_thread(run.stop)
        self._tell_runs()

    def _start_of(self, request: Evolve) -> Design:
        if not request.looked:
            return self.design
        if self._looking is None:
            raise InputError("look at an individual first")
        return self._looking[1]

    async def _follow(self, on: bool) -> None:
        self._following = on
        if on and self._run is not None:
            await self._look(len(self._run.rows), None)
        self._tell_runs()

    async def _look(self, generation: int | None, individual: int | None) -> None:
        if generation is None:
            self._looking = None
        else:
            if self._live.live is not None:
                raise InputError("the net evolves; keep or discard what it grew first")
            run = self._known_run()

            def rebuild() -> tuple[Looked, Design, Figures]:
                if individual is None:
                    found = run.parent(generation)
                else:
                    found = run.individual(generation, individual)
                looked = Looked(generation=generation, individual=individual)
                return looked, found, figures_of(found)

            self._looking = await self._in_thread(rebuild)
        self._take_design()

    async def _reinstate(self) -> None:
        if self._looking is None:
            raise InputError("look at an individual first")
        looked, design, _ = self._looking
        name = f"generation {looked.generation}"
        if looked.individual is not None:
            name += f", individual {looked.individual}"
        self._looking, self._following = None, False
        await self.act(lambda: (commands.whole(self.design, design, f"Take over {name}"), []))
        self._tell_runs()

    def _known_run(self) -> Evolving:
        if self._run is None:
            raise InputError("there is no run; start one")
        return self._run

    def table(self, first: int) -> bytes:
        """Return the frame with all individuals of the run from a generation on."""
        run = self._known_run()
        header = TableHeader(first=first, population=run.parameters.population, arrays=[])
        return encode(header, run.columns(first))

    def lineage(self, generation: int, individual: int | None) -> Lineage:
        """Return where a parent or an individual of the run came from."""
        run = self._known_run()
        if not 1 <= generation <= len(run.rows):
            raise InputError(f"there are generations 1 to {len(run.rows)}")
        if individual is not None and not 0 <= individual < run.parameters.population:
            raise InputError(f"there are individuals 0 to {run.parameters.population - 1}")
        return Lineage(steps=run.lineage(generation, individual))

    def clusters(self, asked: Brushes) -> Clusters:
        """Return clusters of the individuals that are brushed."""
        run = self._known_run()
        columns: dict[str, Any] = dict(run.columns(1))
        population = run.parameters.population
        columns["generation"] = np.arange(len(columns["springs"])) // population + 1
        rows = np.flatnonzero(brushed(columns, asked.brushes))
        found = clusters(columns, rows, asked.count)
        return Clusters(
            brushed=len(rows),
            clusters=[
                Cluster(generation=row // population + 1, individual=row % population, size=size)
                for row, size in found
            ],
        )

    def picture(self, generation: int, individual: int) -> bytes:
        """Return the net of an individual at equilibrium, as a frame of its net and its motion."""
        return picture_of(self._known_run().individual(generation, individual))

    def _check_design_is_shown(self) -> None:
        if self._live.live is not None:
            raise InputError("the net evolves; keep or discard what it grew first")
        if self._looking is not None:
            raise InputError("this is not your design; take it over, or go back to your design")

    def _run_changed(self) -> None:
        """Called in the run's thread: windows are told a few times a second, not more."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._run_soon)

    def _run_soon(self) -> None:
        if self._run_waits:
            return
        self._run_waits = True
        wait = max(0.0, self._run_told + _RUN_PERIOD - self._loop.time())
        self._loop.call_later(wait, lambda: self._loop.create_task(self._run_now()))

    async def _run_now(self) -> None:
        self._run_waits, self._run_told = False, self._loop.time()
        self._tell_runs()
        run = self._run
        if not self._following or run is None or not run.rows or self._order.locked():
            return
        async with self._order:
            with suppress(InputError):
                await self._look(len(run.rows), None)
                self._tell_document()

    def _tell_runs(self) -> None:
        for window in self._windows:
            self._tell_run(window)

    def _tell_run(self, window: Window) -> None:
        run = self._run
        first = window.generations + 1
        rows = [] if run is None else run.rows[first - 1 :]
        if run is not None and run.rows:
            # The last row told may have been marked as changed since.
            first = max(1, first - 1)
            rows = run.rows[first - 1 :]
        window.generations = 0 if run is None else len(run.rows)
        window.tell(
            RunState(
                status="none" if run is None else run.status,
                reason="" if run is None else run.reason,
                folder="" if run is None else str(run.folder),
                driver="" if run is None or run.driver is None else str(run.driver),
                following=self._following,
                parameters={} if run is None else run.parameters.model_dump(mode="json"),
                generations=window.generations,
                first=first,
                rows=rows,
            )
        )

    # --- what windows are told -----------------------------------------------------------------

    async def document_state(self) -> DocumentState:
        """Return the document as windows are told of it, between two actions."""
        async with self._order:
            return self._document_state()

    def _document_state(self) -> DocumentState:
        document, design = self._journal.document, self.design
        looked = self._looking
        nodes = design.nodes if looked is None else looked[1].nodes
        held = design.anchors if looked is None else looked[1].anchors
        first = max(0, document.position - _HISTORY_SHOWN)
        shown = document.actions[first : document.position + _HISTORY_SHOWN]
        values = values_of(design)
        anchors = zip(
            design.anchor_names,
            held.tolist(),
            design.file.framework.anchors,
            strict=True,
        )
        return DocumentState(
            document=self._journal.folder.name,
            name=design.name,
            file=self._journal.settings.file,
            saved=self._saved is not None and self._saved == design.to_file(),
            method=design.file.method,
            revision=self._revision,
            position=document.position,
            length=len(document.actions),
            history=[
                HistoryLine(label=action.label, number=number)
                for number, action in enumerate(shown, start=first + 1)
            ],
            figures=self._figures[document.position] if looked is None else looked[2],
            before=self._figures.get(document.position - 1) if looked is None else None,
            looking=None if looked is None else looked[0],
            anchors=[
                AnchorState(
                    name=name,
                    node=nodes[node],
                    position=list(anchor.position),
                    holds=anchor.holds,
                    line=None if anchor.line is None else list(anchor.line),
                    plane=None if anchor.plane is None else list(anchor.plane),
                )
                for name, node, anchor in anchors
            ],
            cell_types=cell_types_of(design),
            framework=values["framework"],
            stiffness=values["springs"]["stiffness"],
            ring_factor=values["springs"]["ring_factor"],
            spring_groups=group_lines(design),
        )

    def _take_design(self) -> None:
        if self._journal.document.position not in self._figures:
            self._measure()
        self._revision += 1
        design = self.shown
        self._node_keys = set(design.nodes)
        self._keep_net(design, tables_of(design))
        self._motion.take(design, self._revision)

    def _keep_net(self, design: Design, tables: Tables) -> None:
        self._nets[self._revision] = (design, tables)
        self._nets.pop(self._revision - _NETS_KEPT, None)

    def _measure(self) -> None:
        position = self._journal.document.position
        # What was measured beyond the position belongs to actions that may be gone.
        for later in [number for number in self._figures if number >= position]:
            del self._figures[later]
        self._figures[position] = figures_of(self.design)

    def _tell_document(self) -> None:
        state = self._document_state()
        for window in self._windows:
            window.tell(state)

    def _tell_all(self, event: BaseModel) -> None:
        for window in self._windows:
            window.tell(event)

    def _moved(self, state: State) -> None:
        if self._live.live is not None:
            return  # a last step of the net that was shown before
        self._state, self._state_frame = state, b""
        for window in self._windows:
            window.wake()

    def _motion_frame(self, state: State) -> bytes:
        if not self._state_frame or state is not self._state:
            self._state_frame = motion_frame(state, self._nets[state.revision][0])
        return self._state_frame

    def _call(self, what: Callable[[State], None], state: State) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(what, state)
