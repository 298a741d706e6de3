"""One window of a document, as the engine knows it."""

from __future__ import annotations

import asyncio
from collections import deque

from pydantic import BaseModel

from .motion import State


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
