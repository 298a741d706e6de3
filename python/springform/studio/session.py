"""A session: one open document, its net in motion, and the windows that look at it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError

from .. import _core
from ..arrays import Floats
from ..design import Design
from ..errors import InputError, SpringformError
from ..patch_file import Origin
from . import commands, grafts, journal, orbits, own_file
from .changes import Action
from .document import Document
from .document_telling import document_state
from .figure_messages import Figures
from .frames import Tables, net_frame, tables_of
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
from .live import Grown
from .live_messages import LiveEvolve, WeighCells
from .live_stage import LiveStage
from .messages import (
    REQUEST,
    Answer,
    DocumentState,
    Hold,
    Move,
    MoveAnchor,
    Preview,
    PreviewState,
    Problem,
    Received,
    Release,
    Reply,
    Request,
    Revert,
    Save,
    Travel,
    Undo,
    Welcome,
    protocol,
)
from .motion import Motion, State, carried
from .patches import PatchFolder
from .pin_messages import Pin, RenamePin, Unpin
from .pin_stage import Looking, PinStage
from .preview import preview_of
from .refusing import not_understood
from .run_messages import (
    Evolve,
    Follow,
    Look,
    OpenRun,
    Reinstate,
    SteerRun,
)
from .run_stage import RunStage
from .telling import figures_of, motion_frame, state_of
from .window import Window

_FRAMES_ON_THE_WAY = 3
"""Frames of motion that a window may not yet have drawn; more would only make it lag."""

_NETS_KEPT = 8
"""Earlier nets that a window may still have, so that it is sent what changed."""

T = TypeVar("T")


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
        self._looking: Looking | None = None
        settings = self._journal.settings
        self.runs = RunStage(self._journal.folder / "runs", settings.run, self._run_now)
        self.pins = PinStage(self._journal.folder, self._journal.document, self.runs)
        self._revision = 0
        self._nets: dict[int, tuple[Design, Tables]] = {}
        self._state: State | None = None
        self._state_frame: bytes = b""
        self._saved = own_file.taken_over(self._journal)
        self._live = LiveStage(
            self._journal.folder, lambda: self.design, self._tell_all, self._show_grown
        )
        self._motion = Motion(lambda state: self._call(self._moved, state))
        self._take_design()
        if self._live.live is not None:
            self._show_grown(self._live.live.grown)

    @property
    def design(self) -> Design:
        """The design now."""
        return self._journal.document.design

    @property
    def shown(self) -> Design:
        """The design, or the individual that is shown instead."""
        return self.design if self._looking is None else self._looking.net.design

    async def close(self) -> None:
        """End the motion, write a snapshot and let the folder go."""
        async with self._order:
            await self._live.close()
            if self.runs.run is not None:
                await asyncio.to_thread(self.runs.run.stop)
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
            self.runs.tell(window)
            window.tell(self.pins.state())
            window.tell(self._live.state())
            if self.pins.folder.problem is not None:
                window.tell(Problem(message=str(self.pins.folder.problem)))
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
            window.tell(not_understood(text, error))
            return
        try:
            if isinstance(request, Preview):
                self._answer(window, request, preview=await self._preview(request))
                return
            cells, answer = await self._do(window, request)
        except SpringformError as error:
            key = error.key if isinstance(error, InputError) else None
            self._answer(window, request, problem=str(error), key=key)
        except _core.CoreError as error:
            key, problem = error.args
            self._answer(window, request, problem=f"{key}: {problem}", key=key)
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
            case Pin() | Unpin() | RenamePin():
                async with self._order:
                    await self._in_thread(lambda: self.pins.change(request))
                    self._tell_all(self.pins.state())
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
            case Evolve() | SteerRun() | OpenRun():
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
                self.runs.following = False
                await self._look(request)
                self._tell_runs()
            case Follow():
                await self._follow(request.on)
            case Reinstate():
                await self._reinstate(request)
            case Save() | Revert():
                await self._use_file(request)
            case Undo() | Travel():
                await self._travel(self._goal(request))
            case Graft():
                patch = await self._in_thread(lambda: self._patches.load(request.patch))
                cells = await self.act(lambda: grafts.graft_action(self.design, patch, request))
            case _:
                cells = await self.act(
                    lambda: commands.action_of(self.design, request, self._now(self.design))
                )
        self._tell_document()
        return cells

    def _now(self, design: Design) -> Floats:
        """Return where the nodes of a design are, new ones between those that the motion knows."""
        state = self._state
        if state is None:
            return design.solve().positions
        shown, _ = self._nets[state.revision]
        return state.positions if shown is design else carried(design, shown.nodes, state.positions)

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
        document = Document(self.design)

        def look() -> PreviewState:
            positions = self._now(document.design)
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

    async def _use_file(self, request: Save | Revert) -> None:
        if isinstance(request, Revert):
            await self.act(lambda: (own_file.reverting(self._journal), []))
            self._saved = self.design.to_file()
            return
        # Nothing is done to the design while something else is shown.
        shown = self._looking is None and self._live.live is None
        done = own_file.saving(self._journal, request, naming=shown)
        await self._in_thread(lambda: own_file.write(self._journal, done))
        if (action := done.action) is not None:
            await self.act(lambda: (action, []))
        self._saved = self.design.to_file()

    # --- live evolution ------------------------------------------------------------------------

    async def _steer_live(self, request: LiveEvolve) -> None:
        if request.what in ("start", "restore"):
            self._check_design_is_shown()
            self.runs.following = False
        kept = await self._live.steer(request)
        if kept is not None:
            design, generation = kept
            if design.closed.to_file() == self.design.to_file():
                self._live.forget()
                self._take_design()
                return
            label = f"Evolve live, {generation} generation{'' if generation == 1 else 's'}"
            try:
                await self.act(lambda: (commands.whole(self.design, design, label), []))
            except SpringformError:
                self._live.take_up()
                raise
            self._live.forget()
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
            return [], orbits.symmetry_state(self.design)
        self._check_design_is_shown()
        patch = self._patches.load(request.patch)
        return [], grafts.planned(
            self.design, patch, request, self._now(self.design), request.measure
        )

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
                net = self.pins.net(request.side)
                if request.side == "design":
                    self._check_nothing_evolves()
                origin = Origin()
                if request.side.startswith("run/") and (place := net.place) is not None:
                    run = str(self.runs.known().folder)
                    origin = Origin(
                        run=run, generation=place.generation, individual=place.individual
                    )
                self._patches.keep(grafts.lifted(net.design, request, origin))
            case RenamePatch():
                self._patches.rename(request.patch, request.name)
            case DeletePatch():
                self._patches.delete(request.patch)

    # --- the run -------------------------------------------------------------------------------

    async def _steer(self, request: Evolve | SteerRun | OpenRun) -> None:
        if isinstance(request, OpenRun):
            await self._open_run(request.number)
            return
        if isinstance(request, SteerRun):
            await self.runs.steer(request, self._in_thread)
            self._tell_runs()
            return
        self._check_nothing_evolves()
        values = {"cell_weights": self._live.weights} | request.parameters
        net = await self._in_thread(lambda: self.pins.net(request.side))
        await self.runs.start(net.design, values, self._in_thread)
        self._tell_other_run()

    async def _open_run(self, number: int) -> None:
        await self.runs.open(number, self._in_thread)
        # What was looked at was in the other run.
        if self._looking is not None:
            self._looking = None
            self._take_design()
            self._tell_document()
        self._tell_other_run()

    def _tell_other_run(self) -> None:
        for window in self._windows:
            window.generations = 0
        self._tell_runs()

    async def _follow(self, on: bool) -> None:
        self.runs.following = on
        if on and self.runs.run is not None:
            await self._look_at_newest()
        self._tell_runs()

    async def _look_at_newest(self) -> None:
        newest = Look(id=0, generation=self.runs.generations, individual=None)
        await self._look(newest)

    async def _look(self, request: Look) -> None:
        if request.generation is None and request.pin is None:
            self._looking = None
        else:
            self._check_nothing_evolves()
            self._looking = await self._in_thread(lambda: self.pins.looking(request))
        self._take_design()

    async def _reinstate(self, request: Reinstate) -> None:
        if request.side == "design":
            raise InputError("this is your design; look at an individual first")
        self._check_nothing_evolves()
        net = await self._in_thread(lambda: self.pins.net(request.side))
        # Without a place it is a pin, which may have a name of somebody's own.
        label = f"Take over {net.label if net.place is None else net.place.label.lower()}"
        self._looking, self.runs.following = None, False
        await self.act(
            lambda: (commands.whole(self.design, net.design, label, net.place), []),
        )
        self._tell_runs()

    def _check_nothing_evolves(self) -> None:
        if self._live.live is not None:
            raise InputError("the net evolves; keep or discard what it grew first")

    def _check_design_is_shown(self) -> None:
        self._check_nothing_evolves()
        if self._looking is not None:
            raise InputError("this is not your design; take it over, or go back to your design")

    async def _run_now(self) -> None:
        self._tell_runs()
        if not self.runs.following or not self.runs.generations or self._order.locked():
            return
        async with self._order:
            with suppress(InputError):
                await self._look_at_newest()
                self._tell_document()

    def _tell_runs(self) -> None:
        for window in self._windows:
            self.runs.tell(window)

    # --- what windows are told -----------------------------------------------------------------

    async def document_state(self) -> DocumentState:
        """Return the document as windows are told of it, between two actions."""
        async with self._order:
            return self._document_state()

    @property
    def is_saved(self) -> bool:
        """Whether the document's file holds the design as it is now."""
        return self._saved is not None and self._saved == self.design.to_file()

    @property
    def belongs_to_file(self) -> bool:
        """Whether the document has a file of its own."""
        return self._journal.settings.file is not None

    @property
    def is_looked_at(self) -> bool:
        """Whether a window is open on it."""
        return bool(self._windows)

    def _document_state(self) -> DocumentState:
        document, looked = self._journal.document, self._looking
        return document_state(
            self._journal,
            self.shown,
            saved=self.is_saved,
            revision=self._revision,
            figures=self._figures[document.position] if looked is None else looked.figures,
            own=self._figures[document.position],
            before=self._figures.get(document.position - 1) if looked is None else None,
            looking=None if looked is None else looked.looked,
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
