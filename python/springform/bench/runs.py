"""Cases `paper-a`, `paper-b`, `growth` and `stream`: runs of many generations."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ..design import Design, load
from ..evolution import Progress, evolve
from ..run import Run
from . import machine, reference
from .comparison import Bench
from .individuals import DYNAMIC, POPULATION, SCENE, generation
from .records import Row
from .reference import Reference
from .timing import Spread, Timed, interleaved, seconds_of

WINDOW = 10
"""Generations over which a pace is taken."""

PAUSE_EVERY = 10
"""Generations between two samples of the reference within a run."""


@dataclass(frozen=True)
class Paper:
    """A run of the paper (A.1): so many individuals, all of about the same number of springs."""

    springs: int
    """Springs of the design it starts from."""
    margin: int
    """How many springs more or less an individual may have."""
    generations: int
    """Generations of 150."""
    hours: str
    """What the paper took, on twelve logical cores."""


PAPER_A = Paper(2000, 100, 300, "10 h 26 min")
PAPER_B = Paper(3000, 150, 289, "22 h 36 min")


@dataclass
class _Watch:
    """Counts who is outside, and times the reference now and then, off the run's clock."""

    wanted: Paper
    reference: Timed | None
    outside: int = 0
    seen: int = 0
    paused: float = 0.0
    reference_seconds: list[float] = field(default_factory=list)

    def __call__(self, now: Progress) -> None:
        began = time.perf_counter()
        springs = now.columns["springs"]
        off = np.abs(springs.astype(np.int64) - self.wanted.springs)
        self.outside += int(np.sum(off > self.wanted.margin))
        self.seen += len(springs)
        if self.reference is not None and now.generation % PAUSE_EVERY == 0:
            self.reference_seconds.append(self.reference())
        self.paused += time.perf_counter() - began


def paper(case: str, bench: Bench, wanted: Paper) -> Iterator[Row]:
    """Time one of the paper's runs on all cores and on one, and compare what they found."""
    start = DYNAMIC.design(bench.springs(wanted.springs))
    judge = Reference(start.network()) if reference.available() else None
    digests: dict[int, str] = {}
    for threads in sorted({machine.cores(), 1}, reverse=True):
        timer = None if judge is None else judge.timed()
        watch = _Watch(wanted, timer)
        began = time.perf_counter()
        run = _paper_run(start, bench, wanted, threads, watch)
        seconds = time.perf_counter() - began - watch.paused
        digests[threads] = run.digest()
        same = digests[threads] == next(iter(digests.values()))
        individuals = run.generations * run.parameters.population
        over, name = None, ""
        if judge is not None and watch.reference_seconds:
            each = seconds * threads / individuals
            over = Spread.of([each / statistics.median(watch.reference_seconds)])
            name = f"{judge.name} an individual and thread"
        note = (
            f"{individuals} individuals, {100 * watch.outside / watch.seen:.2f} % more than "
            f"{wanted.margin} springs off {wanted.springs}, run folder written; digest "
            f"{digests[threads][:12]}, {'the same' if same else 'NOT THE SAME'} on any threads; "
            f"the paper took {wanted.hours} on twelve logical cores"
        )
        words = f"{threads} thread{'s' if threads > 1 else ''}"
        springs = len(start.network().springs)
        yield Row(
            case,
            SCENE,
            springs,
            f"springform, {words}",
            "s",
            Spread.of([seconds]),
            over,
            name,
            note,
        )


def _paper_run(start: Design, bench: Bench, wanted: Paper, threads: int, watch: _Watch) -> Run:
    # Parents stay within half the margin, so that next to all of their mutants stay within it.
    return evolve(
        start,
        population=POPULATION,
        generations=bench.count(wanted.generations),
        types=DYNAMIC.types,
        insertions="1",
        toggles="1",
        min_springs=None if bench.quick else wanted.springs - wanted.margin // 2,
        max_springs=None if bench.quick else wanted.springs + wanted.margin // 2,
        fitness="differential",
        seed=1,
        threads=threads,
        on_generation=watch,
    )


def growth(case: str, bench: Bench) -> Iterator[Row]:
    """Time a run from the bare framework: generations a second, at worst and in the middle."""
    times = [time.perf_counter()]
    threads = machine.cores()
    run = evolve(
        load(SCENE),
        population=POPULATION,
        generations=bench.count(300),
        types=DYNAMIC.types,
        insertions="1",
        seed=1,
        threads=threads,
        on_generation=lambda _: times.append(time.perf_counter()),
    )
    size = min(WINDOW, len(times) - 1)
    paces = [size / (last - first) for first, last in zip(times, times[size:], strict=False)]
    springs = [line["springs"] for line in (run.start, run.final)]
    note = (
        f"windows of {size} generations of {POPULATION}, {springs[0]} to {springs[1]} "
        f"springs; {times[-1] - times[0]:.1f} s in all, run folder written; {threads} threads"
    )
    yield Row(case, SCENE, springs[1], "springform", "generations/s", Spread.of(paces), note=note)


def stream(case: str, bench: Bench) -> Iterator[Row]:
    """Time generations whose winner is solved and packed for a viewer, as live pictures need."""
    start = DYNAMIC.design(bench.springs(2000))
    threads, population = machine.cores(), bench.count(POPULATION)
    evolution = generation(start, DYNAMIC, population=population, seed=1, threads=threads)
    size = 0

    def one() -> None:
        nonlocal size
        evolution.advance()
        size = len(_frame(Design(start.file, setting=start.setting, forest=evolution.forest)))

    seconds = interleaved({"stream": lambda: seconds_of(one)}, bench.effort)["stream"]
    springs = evolution.measures["springs"]
    note = f"{population} mutants and a frame of {size / 1024:.0f} kB; {threads} threads"
    pace = Spread.of([1 / second for second in seconds])
    yield Row(case, SCENE, springs, "springform", "generations/s", pace, note=note)


def _frame(design: Design) -> bytes:
    found, network = design.solve(), design.network()
    arrays = (
        found.positions.astype(np.float32),
        network.springs,
        found.forces.astype(np.float32),
    )
    return b"".join(array.tobytes() for array in arrays)
