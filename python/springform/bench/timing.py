"""Timing side by side: every round runs all contenders in turn, so that noise hits them alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

Timed = Callable[[], float]
"""Does a piece of work and returns the seconds that count."""


@dataclass(frozen=True)
class Spread:
    """A figure over repeats."""

    minimum: float
    """Smallest."""
    median: float
    """Median."""
    maximum: float
    """Largest."""
    spread: float
    """Distance between the quartiles over the median."""
    repeats: int
    """How often it was measured."""

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Return the spread of at least one value."""
        middle = statistics.median(values)
        width = 0.0
        if len(values) > 1:
            low, _, high = statistics.quantiles(values, n=4, method="inclusive")
            width = (high - low) / middle if middle else 0.0
        return cls(min(values), middle, max(values), width, len(values))


@dataclass(frozen=True)
class Effort:
    """How long to measure."""

    rounds: int = 15
    """Most rounds."""
    fewest: int = 3
    """Fewest rounds, whatever they take."""
    seconds: float = 20.0
    """After this long only the fewest rounds are made."""
    sample: float = 0.02
    """Shortest sample [s]: shorter work is repeated within a round."""


def sampled(once: Timed, effort: Effort) -> Timed:
    """Return a timer that repeats short work until a sample is long enough, and takes the median.

    The median of many short pieces of work passes over those that other programs interrupted.
    """

    def sample() -> float:
        seconds = [once()]
        while sum(seconds) < effort.sample:
            seconds.append(once())
        return statistics.median(seconds)

    return sample


def clocked(work: Callable[[], object], effort: Effort) -> Timed:
    """Return a timer of `work`, sampled."""
    return sampled(lambda: seconds_of(work), effort)


def seconds_of(work: Callable[[], object]) -> float:
    """Return the wall time of one call [s]."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def interleaved(contenders: Mapping[str, Timed], effort: Effort) -> dict[str, list[float]]:
    """Run all contenders in turn, round by round, and return the seconds of each.

    A first round warms up and does not count, unless it alone takes longer than the effort.
    """
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    began = time.perf_counter()
    first = {name: timed() for name, timed in contenders.items()}
    if time.perf_counter() - began > effort.seconds:
        for name, value in first.items():
            seconds[name].append(value)
    for done in range(effort.rounds):
        if done >= effort.fewest and time.perf_counter() - began > effort.seconds:
            break
        if time.perf_counter() - began > 3 * effort.seconds and all(seconds.values()):
            break
        for name, timed in contenders.items():
            seconds[name].append(timed())
    return seconds


def ratio(seconds: Sequence[float], reference: Sequence[float]) -> Spread:
    """Return the ratio of two contenders, round by round."""
    return Spread.of([ours / theirs for ours, theirs in zip(seconds, reference, strict=True)])
