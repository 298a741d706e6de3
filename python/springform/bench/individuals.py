"""Cases `individual` and `threads`: mutants from mutation to measures, one generation at a time."""

from __future__ import annotations

import itertools
import multiprocessing
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from multiprocessing.synchronize import Barrier

from .. import _core
from ..design import Design
from ..parameters import checked_parameters
from ..run import start_evolution
from . import machine, scikit_sparse
from .comparison import Bench
from .nets import evolved
from .records import Row
from .timing import Spread, Timed, interleaved, ratio, seconds_of

SCENE = "three-cylinders"

POPULATION = 150
"""Mutants a generation, as in the paper's runs (A.1)."""


@dataclass(frozen=True)
class Kind:
    """How nets of a case are grown."""

    method: str
    """Filter method."""
    types: tuple[str, ...]
    """Cell types that mutation draws."""
    words: str
    """What to call it."""

    def design(self, springs: int) -> Design:
        """Return the scene evolved to so many springs."""
        return evolved(SCENE, springs, self.types, self.method)


DYNAMIC = Kind("dynamic", ("1", "6"), "types 1 and 6")
RECURSIVE = Kind("recursive", ("1",), "QrT")


def generation(
    design: Design, kind: Kind, *, population: int, seed: int, threads: int
) -> _core.Evolution:
    """Return the algorithm with a design as parent, before its next generation."""
    parameters = checked_parameters(
        {"population": population, "seed": seed, "types": kind.types}, kind.method
    )
    return start_evolution(design, parameters, threads=threads)


def individual(case: str, bench: Bench) -> Iterator[Row]:
    """Time complete individuals of about 2,000 and 3,000 springs, and their stages."""
    for springs in (2000, 3000):
        for kind in (DYNAMIC, RECURSIVE):
            design = kind.design(bench.springs(springs))
            yield from _whole(case, bench, kind, design)
            yield from _stages(case, bench, kind, design)


def _whole(case: str, bench: Bench, kind: Kind, design: Design) -> Iterator[Row]:
    population = bench.count(POPULATION)
    seeds = itertools.count(1)

    def mutants() -> float:
        evolution = generation(design, kind, population=population, seed=next(seeds), threads=1)
        return seconds_of(evolution.advance) / population

    contenders: dict[str, Timed] = {"springform": mutants}
    wrapper = scikit_sparse.timed(design.network(), bench.effort)
    if wrapper is not None:
        contenders[scikit_sparse.NAME] = wrapper
    net = f"{SCENE}, {kind.words}"
    compared = bench.compare(case, net, design.network(), contenders)
    note = (
        f"one of {population} mutants: mutation, filters, net, equilibrium to 1e-9, measures; "
        "choice of the next parent included; 1 thread"
    )
    yield compared.row("springform", note)
    yield from compared.reference_row()
    if wrapper is not None:
        yield compared.row(scikit_sparse.NAME, "the same through Python, simplicial, AMD")


def _stages(case: str, bench: Bench, kind: Kind, design: Design) -> Iterator[Row]:
    """The stages of mutants that are made one after the other, as the core sees them end."""
    count = bench.count(POPULATION)
    evolution = generation(design, kind, population=count, seed=1, threads=1)
    spent: dict[str, list[float]] = {}

    def mutants() -> float:
        found = evolution.stages(count, 1)
        for stage, seconds in found.items():
            spent.setdefault(stage, []).append(float(seconds[0]) / count)
        return sum(seconds[-1] for seconds in spent.values())

    net = f"{SCENE}, {kind.words}, stage by stage"
    compared = bench.compare(case, net, design.network(), {"springform": mutants})
    # The rounds that count are the last ones: the first warms up.
    rounds = len(compared.seconds["springform"])
    stages = {stage: seconds[-rounds:] for stage, seconds in spent.items() if any(seconds)}
    compared = replace(compared, seconds={**compared.seconds, **stages})
    yield compared.row("springform", "all stages, one mutant after the other, 1 thread")
    for stage in stages:
        # Stages that the solver does not tell apart count as the next one that it does.
        merged = [name for name in spent if name not in stages] if stage == "solve" else []
        note = f"with {' and '.join(merged)}" if merged else ""
        yield compared.row(f"springform, {stage}", note, stage)


# --- threads ------------------------------------------------------------------------------------


def threads(case: str, bench: Bench) -> Iterator[Row]:
    """Compare threads of one process with as many processes of one thread, at the same time."""
    count = machine.cores()
    springs, population = bench.springs(2000), bench.count(2 * POPULATION)
    design = DYNAMIC.design(springs)
    seeds = itertools.count(1)

    def one_process() -> float:
        evolution = generation(
            design, DYNAMIC, population=count * population, seed=next(seeds), threads=count
        )
        return seconds_of(evolution.advance)

    spawn = multiprocessing.get_context("spawn")
    barrier = spawn.Barrier(count)
    with ProcessPoolExecutor(count, spawn, _join_barrier, (barrier,)) as pool:

        def processes() -> float:
            arguments = [(springs, population, next(seeds)) for _ in range(count)]
            return max(pool.map(_one_thread, *zip(*arguments, strict=True)))

        contenders = {"threads": one_process, "processes": processes}
        seconds = interleaved(contenders, bench.effort)
    individuals = count * population
    net = f"{SCENE}, {DYNAMIC.words}"
    for name in contenders:
        value = Spread.of([individuals / second for second in seconds[name]])
        over = ratio(seconds["processes"], seconds["threads"]) if name == "threads" else None
        words = f"{count} threads" if name == "threads" else f"{count} processes of one thread"
        yield Row(
            case,
            net,
            len(design.network().springs),
            f"springform, {words}",
            "individuals/s",
            value,
            over,
            f"{count} processes of one thread" if over else "",
            "1 means that threads cost nothing" if over else "all at the same time",
        )


_barrier: Barrier | None = None


def _join_barrier(barrier: Barrier) -> None:
    global _barrier  # noqa: PLW0603  # how a pool's processes are given what can't be sent later
    _barrier = barrier


@cache
def _worker_design(springs: int) -> Design:
    return DYNAMIC.design(springs)


def _one_thread(springs: int, population: int, seed: int) -> float:
    design = _worker_design(springs)
    evolution = generation(design, DYNAMIC, population=population, seed=seed, threads=1)
    assert _barrier is not None
    _barrier.wait(timeout=600)
    return seconds_of(evolution.advance)
