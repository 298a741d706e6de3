"""Engines side by side on one net, beside the reference: what every case is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..network import Network
from . import reference
from .records import Row
from .reference import Reference
from .timing import Effort, Spread, Timed, interleaved, ratio

MILLISECONDS = "ms"

REFERENCE = "reference"


@dataclass(frozen=True)
class Bench:
    """How a case is measured."""

    effort: Effort = field(default_factory=Effort)
    """How long."""
    quick: bool = False
    """Small nets and few rounds, to see that everything works; the figures mean nothing."""

    def springs(self, wanted: int) -> int:
        """Return how many springs a net of `wanted` springs is to have."""
        return max(200, wanted // 50) if self.quick else wanted

    def count(self, wanted: int) -> int:
        """Return how many generations or individuals are to be made instead of `wanted`."""
        return max(4, wanted // 50) if self.quick else wanted

    def compare(
        self,
        case: str,
        net: str,
        network: Network,
        contenders: Mapping[str, Timed],
        effort: Effort | None = None,
    ) -> Comparison:
        """Time contenders and the reference on a net, if it has been built, round by round."""
        judge = Reference(network) if reference.available() else None
        timed = dict(contenders)
        if judge is not None:
            timed[REFERENCE] = judge.timed()
        seconds = interleaved(timed, effort or self.effort)
        return Comparison(case, net, len(network.springs), seconds, judge)


@dataclass(frozen=True)
class Comparison:
    """Seconds of every contender, round by round."""

    case: str
    """Name of the case."""
    net: str
    """What was worked on."""
    springs: int
    """Springs of it."""
    seconds: Mapping[str, Sequence[float]]
    """By contender."""
    reference: Reference | None
    """What the ratios are over; None if it has not been built."""

    def row(self, engine: str, note: str, contender: str | None = None) -> Row:
        """Return the time of a contender, by default named like its engine."""
        seconds = self.seconds[engine if contender is None else contender]
        value = Spread.of([1e3 * second for second in seconds])
        over = None if self.reference is None else ratio(seconds, self.seconds[REFERENCE])
        return Row(
            self.case,
            self.net,
            self.springs,
            engine,
            MILLISECONDS,
            value,
            over,
            "" if self.reference is None else self.reference.name,
            note,
        )

    def reference_row(self) -> list[Row]:
        """Return the reference's own time, if it has been built."""
        if self.reference is None:
            return []
        value = Spread.of([1e3 * second for second in self.seconds[REFERENCE]])
        note = "analyse, factor and solve for three right-hand sides; matrix given"
        name = self.reference.name
        return [Row(self.case, self.net, self.springs, name, MILLISECONDS, value, note=note)]
