"""Pinned nets of a document, on the disk: each a design of its own, so that it outlives its run.

FOLDER/pins.json         version, and a list of all pins with their figures
FOLDER/pins/0003.json    the net of pin 3, a design file
"""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from ..design import Design, load, save
from ..errors import InputError
from ..files import WriteError, explain, read_text, write_atomically
from .changes import Place
from .figure_messages import Figures
from .pin_messages import PinState


class _Kept(BaseModel):
    """What pins.json holds."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    springform_pins: Literal[1] = 1
    next: int = 1
    """Number of the next pin; none is given twice."""
    pins: list[PinState] = []


class PinFolder:
    """The pins of one document.

    Attributes: `problem` (why pins.json can't be read; nothing is written over it then, or None).
    """

    def __init__(self, folder: Path) -> None:
        """Read what is pinned; `folder` is the document's."""
        self._folder = folder
        self._kept = _Kept()
        self.problem: InputError | None = None
        path = folder / "pins.json"
        if not path.exists():
            return
        try:
            self._kept = _Kept.model_validate_json(read_text(path))
        except InputError as error:
            self.problem = error
        except ValidationError:
            problem = "is no list of pins of this version; restore it, or move it away"
            self.problem = InputError(problem, file=path)

    @property
    def pins(self) -> list[PinState]:
        """What is pinned, in the order in which it was."""
        return self._kept.pins

    def pin(self, number: int) -> PinState:
        """Return a pin. Raises `InputError`: there is none of this number."""
        for pin in self.pins:
            if pin.number == number:
                return pin
        raise InputError("there is no such pin; it was let go", key=f"pin {number}")

    def design(self, number: int) -> Design:
        """Return the net of a pin. Raises `InputError`: there is none, or it can't be read."""
        self.pin(number)
        return load(self._path(number))

    def keep(
        self, design: Design, label: str, place: Place | None, suf: float | None, figures: Figures
    ) -> PinState:
        """Pin a net. Raises `InputError`: it is pinned, or the pins can't be read or written."""
        if self.problem is not None:
            raise self.problem
        for pin in self.pins:
            if self._is(pin, design, place, figures):
                raise InputError("it is pinned already", key=pin.label)
        number = self._kept.next
        path = self._path(number)
        try:
            path.parent.mkdir(exist_ok=True)
        except OSError as error:
            raise WriteError(f"can't be made: {explain(error)}", file=path.parent) from None
        save(design.closed, path)
        pin = PinState(number=number, label=label, place=place, suf=suf, figures=figures)
        self._write(_Kept(next=number + 1, pins=[*self.pins, pin]))
        return pin

    def drop(self, number: int) -> None:
        """Let a pin go. Raises `InputError`: there is none, or the list can't be written."""
        gone = self.pin(number)
        pins = [pin for pin in self.pins if pin is not gone]
        self._write(self._kept.model_copy(update={"pins": pins}))
        with contextlib.suppress(OSError):  # it is in no list any more
            self._path(number).unlink()

    def rename(self, number: int, label: str) -> None:
        """Call a pin something else. Raises `InputError`: there is none, or it can't be written."""
        renamed = self.pin(number)
        pins = [
            pin.model_copy(update={"label": label}) if pin is renamed else pin for pin in self.pins
        ]
        self._write(self._kept.model_copy(update={"pins": pins}))

    def _is(self, pin: PinState, design: Design, place: Place | None, figures: Figures) -> bool:
        """Whether a net is the pinned one."""
        if place is not None or pin.place is not None:
            return pin.place == place
        alike = pin.figures == figures
        return alike and self.design(pin.number).to_file() == design.closed.to_file()

    def _write(self, kept: _Kept) -> None:
        text = kept.model_dump_json(indent=1) + "\n"
        write_atomically(self._folder / "pins.json", text.encode())
        self._kept = kept

    def _path(self, number: int) -> Path:
        return self._folder / "pins" / f"{number:04}.json"
