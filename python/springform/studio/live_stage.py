"""Live evolution of one document, and the cells that were brushed."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

from ..design import Design
from ..errors import InputError
from ..parameters import checked_parameters
from .live import DEFAULTS, Grown, Live
from .live_messages import LiveEvolve, LivePoint, LiveState, WeighCells

_PERIOD = 0.1
"""Shortest time between messages [s]; nets are shown as they come."""

_MOST_WEIGHTS = 100_000


class LiveStage:
    """The live evolution of a document, if there is one. Methods run in the event loop.

    Attributes: `live` (None: nothing evolves), `weights` (factors by address that were brushed).
    """

    def __init__(self, tell: Callable[[LiveState], None], show: Callable[[Grown], None]) -> None:
        """`tell` is given states for all windows, `show` the net after every generation."""
        self.live: Live | None = None
        self.weights: dict[str, float] = {}
        self._loop = asyncio.get_running_loop()
        self._tell = tell
        self._show = show
        self._shown: Grown | None = None
        self._waits = False

    def state(self) -> LiveState:
        """Return what windows are told."""
        live = self.live
        if live is None:
            return LiveState(weights=self.weights, parameters=DEFAULTS)
        points = [
            LivePoint(
                generation=point.generation,
                springs=point.springs,
                force_differential=point.force_differential,
            )
            for point in list(live.points)
        ]
        return LiveState(
            status=live.status,
            reason=live.reason,
            generation=live.generation,
            rate=round(live.rate, 1),
            points=points,
            parameters=live.parameters.model_dump(mode="json"),
            weights=self.weights,
        )

    async def steer(self, request: LiveEvolve, design: Design) -> tuple[Design, int] | None:
        """Do what a window asks; return the design to keep, and its generation, if it ends so.

        Raises `InputError`: it does not fit.
        """
        if request.what == "start":
            if self.live is not None:
                raise InputError("the net evolves already; keep or discard what it grew first")
            values = {"cell_weights": self.weights} | request.parameters
            self.live = await asyncio.to_thread(Live, design, values, self._grew)
            self._grew()
            return None
        live = self._known()
        if request.what == "change":
            await asyncio.to_thread(live.change, request.parameters)
        elif request.what == "pause":
            live.pause()
        elif request.what == "continue":
            live.go_on()
        else:
            return await self._end(live, request.what == "keep")
        self._tell(self.state())
        return None

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
        self.weights = weights
        self._tell(self.state())

    def move_anchor(self, anchor: str, position: list[float]) -> None:
        """Hold an anchor elsewhere while the net evolves."""
        x, y, z = position
        self._known().move_anchor(anchor, (x, y, z))

    def pause(self) -> None:
        """Stand still, because nobody looks."""
        if self.live is not None:
            self.live.pause()

    async def close(self) -> None:
        """End the thread; what was not kept is gone."""
        if self.live is not None:
            await asyncio.to_thread(self.live.close)
            self.live = None

    async def _end(self, live: Live, keep: bool) -> tuple[Design, int] | None:
        design = await asyncio.to_thread(live.close)
        self.live = None
        self._tell(self.state())
        return (design, live.generation) if keep else None

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
