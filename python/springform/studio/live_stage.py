"""Live evolution of one document, and the cells that were brushed."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..design import Design
from ..errors import InputError
from ..parameters import checked_parameters
from ..run import start_evolution
from ..run_format import GenerationLine
from . import live_file
from .live import DEFAULTS, Grown, Live
from .live_messages import LiveEvolve, LivePoint, LiveState, WeighCells

_PERIOD = 0.1
"""Shortest time between messages [s]; nets are shown as they come."""

_MOST_WEIGHTS = 100_000


class LiveStage:
    """The live evolution of a document, if there is one. Methods run in the event loop.

    Attributes: `live` (None: nothing evolves).
    """

    def __init__(
        self,
        folder: Path,
        design: Callable[[], Design],
        tell: Callable[[LiveState], None],
        show: Callable[[Grown], None],
    ) -> None:
        """Take up what the document's folder holds.

        `design` gives the document's design, `tell` is given states for all windows, `show` the net
        after every generation. Raises `InputError`: the folder's files are damaged.
        """
        self.live: Live | None = None
        self._folder = folder
        self._design = design
        self._loop = asyncio.get_running_loop()
        self._tell = tell
        self._show = show
        self._shown: Grown | None = None
        self._waits = False
        self._settings = live_file.read_settings(folder)
        self.take_up()

    @property
    def weights(self) -> dict[str, float]:
        """Factors of the cells that were brushed, by address."""
        return self._settings.weights

    def take_up(self) -> None:
        """Go back to the net that was not kept nor discarded, if there is one; it stands still."""
        standing = live_file.read_standing(self._folder)
        if standing is not None:
            self.live = self._begun(standing.grown(), standing)
            self._tell(self.state())

    def state(self) -> LiveState:
        """Return what windows are told."""
        live = self.live
        if live is None:
            method = self._design().file.method
            parameters = checked_parameters(DEFAULTS | self._settings.parameters, method)
            return LiveState(
                weights=self.weights,
                changed=list(self._settings.parameters),
                parameters=parameters.model_dump(mode="json"),
                restorable=live_file.is_restorable(self._folder),
            )
        points = [LivePoint.model_validate(point.model_dump()) for point in list(live.points)]
        return LiveState(
            status=live.status,
            reason=live.reason,
            generation=live.generation,
            rate=round(live.rate, 1),
            points=points,
            parameters=live.wanted.model_dump(mode="json"),
            changed=list(self._settings.parameters),
            weights=self.weights,
        )

    async def steer(self, request: LiveEvolve) -> tuple[Design, int] | None:
        """Do what a window asks; return the design to keep, and its generation, if it ends so.

        What is to be kept stays in the folder until `forget`. Raises `InputError`: it does not fit.
        """
        if request.what == "change":
            await self._change(request.parameters)
            return None
        if request.what == "defaults":
            await self._forget_changes()
            return None
        if request.what == "start":
            await self._start(request.parameters)
            return None
        if request.what == "restore":
            await self._restore()
            return None
        live = self._known()
        if request.what == "pause":
            live.pause()
        elif request.what == "continue":
            live.go_on()
        else:
            design = await asyncio.to_thread(live.close)
            self.live = None
            if request.what == "keep":
                return design, live.generation
            live_file.discard_standing(self._folder)
        self._tell(self.state())
        return None

    def forget(self) -> None:
        """Forget the net that evolved, which was kept."""
        live_file.forget_standing(self._folder)
        self._tell(self.state())

    async def weigh(self, request: WeighCells) -> None:
        """Take factors on cells; None takes them away. Raises `InputError`: too many."""
        weights = dict(self.weights)
        if request.factor is None:
            gone = set(request.cells)
            weights = {cell: factor for cell, factor in weights.items() if cell not in gone}
            weights = weights if gone else {}
        else:
            weights |= dict.fromkeys(request.cells, request.factor)
        if len(weights) > _MOST_WEIGHTS:
            raise InputError(f"at most {_MOST_WEIGHTS} cells can be brushed", key="cells")
        checked_parameters({"cell_weights": weights})
        if self.live is not None:
            await asyncio.to_thread(self.live.change, {"cell_weights": weights})
        await self._remember(self._settings.model_copy(update={"weights": weights}))

    def move_anchor(self, anchor: str, position: list[float]) -> None:
        """Hold an anchor elsewhere while the net evolves."""
        x, y, z = position
        self._known().move_anchor(anchor, (x, y, z))

    def pause(self) -> None:
        """Stand still, because nobody looks."""
        if self.live is not None:
            self.live.pause()

    async def close(self) -> None:
        """End the thread; what was neither kept nor discarded stays in the folder."""
        if self.live is not None:
            await asyncio.to_thread(self.live.close)
            self.live = None

    async def _start(self, parameters: dict[str, Any]) -> None:
        if self.live is not None:
            raise InputError("the net evolves already; keep or discard what it grew first")
        if parameters:
            await self._change(parameters)
        self.live = await asyncio.to_thread(self._begun, self._design(), None)
        self._tell(self.state())
        self._grew()

    async def _restore(self) -> None:
        if self.live is not None:
            raise InputError("the net evolves; keep or discard what it grew first")
        live_file.restore_standing(self._folder)
        self.take_up()
        self._grew()

    def _begun(self, design: Design, standing: live_file.Standing | None) -> Live:
        values = {"cell_weights": self.weights} | self._settings.parameters

        def keep(now: live_file.Standing) -> None:
            live_file.write_standing(self._folder, now)

        def add(line: GenerationLine) -> None:
            live_file.add_generation(self._folder, line)

        return Live(design, values, self._grew, keep, add, standing)

    async def _change(self, parameters: dict[str, Any]) -> None:
        """Take other parameters, whether something evolves or not; refused ones change nothing."""
        method = self._design().file.method
        values = self._settings.parameters | parameters
        checked = checked_parameters(DEFAULTS | values, method)
        if self.live is not None:
            await asyncio.to_thread(self.live.change, parameters)
        else:
            await asyncio.to_thread(start_evolution, self._design(), checked, threads=1)
        taken, defaults = checked.model_dump(), checked_parameters(DEFAULTS, method).model_dump()
        changed = {name: value for name, value in values.items() if taken[name] != defaults[name]}
        await self._remember(self._settings.model_copy(update={"parameters": changed}))

    async def _forget_changes(self) -> None:
        """Take the default of every parameter again."""
        defaults = checked_parameters(DEFAULTS, self._design().file.method).model_dump(mode="json")
        if self.live is not None:
            values = {name: defaults[name] for name in self._settings.parameters}
            await asyncio.to_thread(self.live.change, values)
        await self._remember(self._settings.model_copy(update={"parameters": {}}))

    async def _remember(self, settings: live_file.LiveSettings) -> None:
        await asyncio.to_thread(live_file.write_settings, self._folder, settings)
        self._settings = settings
        self._tell(self.state())

    def _known(self) -> Live:
        if self.live is None:
            raise InputError("nothing evolves live; start it first")
        return self.live

    def _grew(self) -> None:
        """Called in the evolution's thread: show its net, and soon tell its figures."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._grown_now)

    def _grown_now(self) -> None:
        if self.live is None:
            return
        grown = self.live.grown
        if grown is not self._shown:
            self._shown = grown
            self._show(grown)
        if not self._waits:
            self._waits = True
            self._loop.call_later(_PERIOD, self._told)

    def _told(self, *_: Any) -> None:
        self._waits = False
        if self.live is not None:
            self._tell(self.state())
