"""What can be looked at, pinned and compared: the design, the individuals of its run, and pins."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..comparison import compare
from ..design import Design
from ..network import Equilibrium
from .changes import Place
from .document import Document
from .figure_messages import Figures
from .message_base import Side
from .pin_messages import (
    Compared,
    ComparedCount,
    ComparedNet,
    ComparedReaction,
    Comparing,
    Pin,
    Pins,
    RenamePin,
    Unpin,
)
from .pins import PinFolder
from .run_messages import Look, Looked
from .run_stage import RunStage
from .telling import figures_of, picture_of


@dataclass(frozen=True)
class Net:
    """A net with its name, and where it comes from."""

    design: Design
    label: str
    place: Place | None
    """None: it is the design, after actions of its own."""


@dataclass(frozen=True)
class Looking:
    """What is shown instead of the design."""

    looked: Looked
    net: Net
    figures: Figures


class PinStage:
    """The pins of one document; what takes long is safe in any thread."""

    def __init__(self, folder: Path, document: Document, runs: RunStage) -> None:
        """`folder` is the document's."""
        self.folder = PinFolder(folder)
        self._document = document
        self._runs = runs

    def state(self) -> Pins:
        """Return what windows are told."""
        return Pins(pins=self.folder.pins)

    def net(self, side: Side) -> Net:
        """Return a net by what windows call it. Raises `InputError`: there is no such."""
        kind, *numbers = side.split("/")
        if kind == "pin":
            pin = self.folder.pin(int(numbers[0]))
            return Net(self.folder.design(pin.number), pin.label, pin.place)
        if kind == "run":
            generation, *rest = (int(number) for number in numbers)
            return self._of_run(generation, rest[0] if rest else None)
        document = self._document
        last = document.actions[document.position - 1] if document.position else None
        return Net(document.design, "My design", None if last is None else last.origin)

    def looking(self, look: Look) -> Looking:
        """Return what a window wants to look at. Raises `InputError`: there is no such."""
        place = None if look.pin is None else self.folder.pin(look.pin).place
        generation, individual, pin = look.generation, look.individual, look.pin
        if place is not None and place.run == self._runs.name:
            generation, individual, pin = place.generation, place.individual, None
        if pin is None and generation is not None:
            net = self._of_run(generation, individual)
        else:
            net = self.net(f"pin/{pin}")
            generation = individual = None
        looked = Looked(label=net.label, generation=generation, individual=individual, pin=pin)
        return Looking(looked, net, figures_of(net.design))

    def change(self, request: Pin | Unpin | RenamePin) -> None:
        """Do what a window asks. Raises `InputError`: no such net or pin, or it is pinned."""
        match request:
            case Pin():
                self._pin(request.side)
            case Unpin():
                self.folder.drop(request.pin)
            case RenamePin():
                self.folder.rename(request.pin, request.label)

    def picture(self, side: Side) -> bytes:
        """Return a net at equilibrium, as a frame of its net and one of its motion."""
        return picture_of(self.net(side).design)

    def compared(self, asked: Comparing) -> Compared:
        """Return two nets, compared. Raises `InputError`: there is no such."""
        nets = self.net(asked.first), self.net(asked.second)
        designs = nets[0].design.closed, nets[1].design.closed
        solved = designs[0].solve(), designs[1].solve()
        found = compare(*designs, solved)
        reactions = [_reactions(*one) for one in zip(designs, solved, strict=True)]
        names = list(dict.fromkeys([*reactions[0], *reactions[1]]))
        told = [
            ComparedNet(
                label=net.label,
                figures=figures_of(design),
                force_deviation=measures.force_deviation,
                load_path=measures.load_path,
                largest_reaction=max(held.values(), default=0.0),
            )
            for net, design, measures, held in zip(
                nets, designs, found.measures, reactions, strict=True
            )
        ]
        return Compared(
            first=told[0],
            second=told[1],
            changed=len(found.changed) if found.same_framework else None,
            types=[
                ComparedCount(name=kind, first=counts[0], second=counts[1])
                for kind, counts in found.types.items()
            ],
            reactions=[
                ComparedReaction(
                    anchor=name, first=reactions[0].get(name), second=reactions[1].get(name)
                )
                for name in names
            ],
        )

    def _pin(self, side: Side) -> None:
        net = self.net(side)
        place = net.place
        if place is None:
            count = self._document.position
            label = f"Design after {count} actions" if count else "Design at the start"
            label = "Design after 1 action" if count == 1 else label
        else:
            label = place.label
        suf = None if place is None else self._runs.suf(place)
        self.folder.keep(net.design, label, place, suf, figures_of(net.design))

    def _of_run(self, generation: int, individual: int | None) -> Net:
        run = self._runs.known()
        if individual is None:
            design, (made, winner) = run.parent(generation), run.standing(generation)
        else:
            design, made, winner = run.individual(generation, individual), generation, individual
        shown = Place(run=self._runs.name, generation=generation, individual=individual)
        return Net(design, shown.label, Place(run=shown.run, generation=made, individual=winner))


def _reactions(design: Design, equilibrium: Equilibrium) -> dict[str, float]:
    """Return the size of what holds each anchor [N], by name."""
    sizes = np.linalg.norm(equilibrium.reactions[design.anchors], axis=1)
    return dict(zip(design.anchor_names, sizes.tolist(), strict=True))
