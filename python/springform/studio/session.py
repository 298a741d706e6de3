"""A session: one open document, its net in motion, and the windows that look at it."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel, ValidationError

from .. import _core
from ..design import Design, load, save
from ..design_schema import BUILT_IN_CELL_TYPES, DesignFile
from ..errors import InputError, SpringformError
from . import commands, journal
from .changes import Action, values_of
from .frames import Tables, encode, net_frame, tables_of
from .library import file_hash
from .messages import (
    REQUEST,
    AnchorState,
    CellTypeChoice,
    DocumentState,
    EditCells,
    EditSpring,
    Figures,
    FixNode,
    HistoryLine,
    Hold,
    MotionHeader,
    Move,
    MoveAnchor,
    Problem,
    Received,
    Release,
    Reply,
    Request,
    Save,
    SeekStress,
    SetFramework,
    SetValue,
    Travel,
    Undo,
    Welcome,
    protocol,
)
from .motion import Motion, State

_FRAMES_ON_THE_WAY = 3
"""Frames of motion that a window may not yet have drawn; more would only make it lag."""

_NETS_KEPT = 8
"""Earlier nets that a window may still have, so that it is sent what changed."""

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
        self._figures: dict[int, Figures] = {}
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

    async def close(self) -> None:
        """End the motion, write a snapshot and let the folder go."""
        async with self._order:
            self._motion.close()
            self._worker.shutdown()
            self._stack.close()

    # --- windows -------------------------------------------------------------------------------

    def join(self, version: str) -> Window:
        """Return a new window; it is sent the document and the net."""
        window = Window()
        self._windows.add(window)
        window.tell(Welcome(protocol=protocol(), version=version))
        window.tell(self.document_state())
        return window

    def leave(self, window: Window) -> None:
        """Forget a window and let go what it holds."""
        self._windows.discard(window)
        self._motion.release(window)

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
            cells = await self._do(window, request)
        except SpringformError as error:
            self._answer(window, request, problem=str(error))
        except _core.CoreError as error:
            key, problem = error.args
            self._answer(window, request, problem=f"{key}: {problem}")
        else:
            self._answer(window, request, cells=cells)

    def _answer(self, window: Window, request: Request, **answer: Any) -> None:
        number = getattr(request, "id", None)
        if number is not None:
            window.tell(Reply(id=number, **answer))
        elif "problem" in answer:
            window.tell(Problem(message=answer["problem"]))

    async def _do(self, window: Window, request: Request) -> list[str]:
        match request:
            case Received():
                window.on_the_way = max(0, window.on_the_way - 1)
                window.wake()
            case Hold():
                if request.node not in self.node_rows:
                    raise InputError("is no node of the net", key=request.node)
                self._motion.hold(window, request.node, np.array(request.position))
            case Release():
                self._motion.release(window)
            case Move():
                self._motion.command(request.what)
            case _:
                async with self._order:
                    return await self._change(request)
        return []

    # --- the document --------------------------------------------------------------------------

    @property
    def node_rows(self) -> set[str]:
        """Keys of the nodes of the net."""
        return self._node_keys

    async def _change(self, request: Request) -> list[str]:
        cells: list[str] = []
        match request:
            case Undo():
                opened = self._journal
                await self._in_thread(opened.redo if request.redo else opened.undo)
                await self._show()
            case Travel():
                await self._travel(request.position)
            case Save():
                await self._in_thread(lambda: self._save(request))
            case EditCells():
                action, cells = commands.edit_cells(self.design, request)
                await self.act(lambda: action)
            case SeekStress():
                made: list[str] = []

                def sought() -> Action:
                    action, found = commands.seek_stress(self.design, request)
                    made.extend(found)
                    return action

                await self.act(sought)
                cells = made
            case EditSpring():
                await self.act(lambda: commands.edit_spring(self.design, request))
            case MoveAnchor():
                await self.act(lambda: commands.move_anchor(self.design, request))
            case SetValue():
                await self.act(lambda: commands.set_value(self.design, request))
            case SetFramework():
                await self.act(lambda: commands.set_framework(self.design, request))
            case FixNode():
                positions = self._state.positions if self._state else self.design.solve().positions
                await self.act(lambda: commands.fix_node(self.design, request, positions))
        self._tell_document()
        return cells

    async def act(self, make: Callable[[], Action]) -> None:
        """Do an action in the document's thread and show its net."""
        await self._in_thread(lambda: self._journal.do(make()))
        await self._show()

    async def _travel(self, position: int) -> None:
        document = self._journal.document
        if position > len(document.actions):
            raise InputError(f"there are {len(document.actions)} actions", key="position")

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

    # --- what windows are told -----------------------------------------------------------------

    def document_state(self) -> DocumentState:
        """Return the document as windows are told of it."""
        document, design = self._journal.document, self.design
        first = max(0, document.position - _HISTORY_SHOWN)
        shown = document.actions[first : document.position + _HISTORY_SHOWN]
        values = values_of(design)
        anchors = zip(
            design.anchor_names,
            design.anchors.tolist(),
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
            figures=self._figures[document.position],
            before=self._figures.get(document.position - 1),
            anchors=[
                AnchorState(name=name, node=design.nodes[node], position=list(anchor.position))
                for name, node, anchor in anchors
            ],
            cell_types=cell_types_of(design),
            framework=values["framework"],
            stiffness=values["springs"]["stiffness"],
            ring_factor=values["springs"]["ring_factor"],
        )

    def _take_design(self) -> None:
        if self._journal.document.position not in self._figures:
            self._measure()
        self._revision += 1
        design = self.design
        self._node_keys = set(design.nodes)
        self._nets[self._revision] = (design, tables_of(design))
        self._nets.pop(self._revision - _NETS_KEPT, None)
        self._motion.take(design, self._revision)

    def _measure(self) -> None:
        position = self._journal.document.position
        # What was measured beyond the position belongs to actions that may be gone.
        for later in [number for number in self._figures if number >= position]:
            del self._figures[later]
        self._figures[position] = figures_of(self.design)

    def _tell_document(self) -> None:
        state = self.document_state()
        for window in self._windows:
            window.tell(state)

    def _moved(self, state: State) -> None:
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


def figures_of(design: Design) -> Figures:
    """Return the measures of a design at equilibrium."""
    equilibrium = design.solve()
    measures = asdict(design.measure(equilibrium))
    chosen = {name: measures[name] for name in Figures.model_fields if name in measures}
    return Figures(**chosen, converged=equilibrium.converged, reason=equilibrium.reason)


def cell_types_of(design: Design) -> list[CellTypeChoice]:
    """Return the cell types that a design's method allows."""
    names = dict(enumerate(BUILT_IN_CELL_TYPES))
    words = {str(number): name for number, name in names.items()}
    words |= {name: name for name in design.file.cell_types}
    found = []
    for word, name in words.items():
        try:
            design.setting.cell_type(word)
        except _core.CoreError:
            continue
        found.append(CellTypeChoice(word=word, name=name))
    return found


def motion_frame(state: State, design: Design) -> bytes:
    """Return the frame of a state of motion."""
    residual = float(state.residual)
    header = MotionHeader(
        revision=state.revision,
        steps=state.steps,
        running=state.running,
        settled=state.settled,
        converged=state.converged,
        residual=residual if np.isfinite(residual) else None,
        reason=state.reason,
        held=list(state.held),
        arrays=[],
    )
    with np.errstate(over="ignore"):
        arrays = {
            "positions": state.positions.astype(np.float32).reshape(-1),
            "forces": state.forces.astype(np.float32),
            "reactions": state.reactions[design.anchors].astype(np.float32).reshape(-1),
        }
    return encode(header, arrays)
