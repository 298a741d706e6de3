"""Cases `nonlinear-*`: cords with rest lengths on a cylinder, cold, warm, and other engines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

from ..network import Network, Solver, solve
from . import peers
from .comparison import Bench
from .nets import Cords, Cylinder, child_of, relative_residual
from .records import Row
from .timing import Timed, ratio, sampled

REST_RATIOS = (0.6, 0.3, 0.9, 0.98)
"""Rest length over drawn length: well stressed, strongly, weakly, all but slack."""

TOLERANCES = (1e-6, 1e-9)
"""Residuals that are solved to."""

CHILDREN = 8
"""Children of one parent that are solved in turn."""

PEER_RESIDUAL = 1e-6
"""Residual at which engines are compared: not all of them reach 1e-9."""

LIMIT = 5.0
"""Seconds after which an engine is given up, up to 20,000 springs; in proportion beyond."""

MOST_ROUNDS = 5
"""Most rounds with all engines: the slow ones take seconds."""

MOST_IMPLICIT = 20_000
"""Most springs on which implicit Euler steps are tried."""


def nonlinear(case: str, bench: Bench, springs: int) -> Iterator[Row]:
    """Time the cylinder net of about so many springs."""
    shape = Cylinder.of(bench.springs(springs))
    for rest_ratio in REST_RATIOS:
        yield from _cold(case, bench, shape, rest_ratio)
    if springs <= 2_000:
        cabled = Cylinder(shape.around, shape.rows, cables=True)
        yield from _cold(case, bench, cabled, 0.6)
        yield from _warm(case, bench, shape)
    yield from _engines(case, bench, shape, 0.6)
    if springs <= 20_000:
        yield from _engines(case, bench, shape, 0.9)


@dataclass
class _Watched:
    """An engine on a net, as a timer that keeps how far it came the last time."""

    engine: peers.Engine
    cords: Cords
    residual: float
    limit: float
    outcome: peers.Outcome | None = None

    def __call__(self) -> float:
        self.outcome = self.engine(self.cords, self.residual, self.limit)
        return self.outcome.seconds

    def note(self) -> str:
        assert self.outcome is not None
        found = self.outcome
        words = "cold to" if found.residual <= self.residual else "cold, NOT REACHED:"
        return (
            f"{words} {self.residual:g}, residual {found.residual:.1e} in "
            f"{found.iterations} iterations"
        )


def _own(solver: Solver) -> peers.Engine:
    """One of our solvers as an engine; it stops by itself and is given no limit."""

    def engine(cords: Cords, residual: float, _limit: float) -> peers.Outcome:
        network = cords.network()
        found = solve(network, tolerance=residual, solver=solver)
        left = relative_residual(network, found.positions)
        if found.converged:
            # Summed in another order, a residual just below the bound may come out just above.
            left = min(left, max(residual, left / (1 + 1e-6)))
        return peers.Outcome(found.seconds, left, found.iterations)

    return engine


def _cold(case: str, bench: Bench, shape: Cylinder, rest_ratio: float) -> Iterator[Row]:
    cords = shape.net(rest_ratio)
    watched = {
        f"{tolerance:g}": _Watched(_own("direct"), cords, tolerance, bench.effort.seconds)
        for tolerance in TOLERANCES
    }
    net = f"{shape}, rest {rest_ratio:g}"
    timed = {name: sampled(one, bench.effort) for name, one in watched.items()}
    compared = bench.compare(case, net, cords.network(), timed)
    for tolerance, one in watched.items():
        yield compared.row("springform", one.note(), tolerance)
    yield from compared.reference_row()


def _warm(case: str, bench: Bench, shape: Cylinder) -> Iterator[Row]:
    parent = shape.net(0.6)
    start = solve(parent.network()).positions
    children = [child_of(shape, parent, start, seed).network() for seed in range(CHILDREN)]

    def all_children(tolerance: float) -> Timed:
        # The same clock as for cold nets: the arrays' way from Python is not counted.
        one_each = [
            sampled(partial(seconds_to_solve, child, tolerance), bench.effort) for child in children
        ]
        return lambda: sum(child() for child in one_each) / CHILDREN

    timed = {f"{tolerance:g}": all_children(tolerance) for tolerance in TOLERANCES}
    compared = bench.compare(case, f"{shape}, rest 0.6", children[0], timed)
    words = f"mean of {CHILDREN} children, 3 subdivisions and 5 changes each"
    for tolerance in timed:
        note = f"warm from the parent's positions to {tolerance}, {words}"
        yield compared.row("springform", note, tolerance)


def seconds_to_solve(network: Network, tolerance: float) -> float:
    """Return the seconds that a solve says it took [s]."""
    return solve(network, tolerance=tolerance).seconds


def _engines(case: str, bench: Bench, shape: Cylinder, rest_ratio: float) -> Iterator[Row]:
    """All engines in the same rounds, and how often their time springFORM's goes."""
    cords = shape.net(rest_ratio)
    engines: dict[str, tuple[peers.Engine, str]] = {
        "springform": (_own("direct"), "both senses"),
        "dynamic relaxation": (_own("dynamic-relaxation"), "ours, kinetic damping"),
    }
    if len(cords.springs) <= MOST_IMPLICIT:
        scheme = "ours, the paper's scheme with growing steps: implicit Euler and BiCGSTAB"
        engines["implicit Euler"] = (_own("implicit-euler"), scheme)
    for peer in peers.PEERS:
        version = peer.version()
        if version is not None and len(cords.springs) <= peer.largest:
            engines[f"{peer.distribution} {version}"] = (peer.engine, peer.law)
    limit = min(bench.effort.seconds, LIMIT) * max(1.0, len(cords.springs) / MOST_IMPLICIT)
    watched = {
        name: _Watched(engine, cords, PEER_RESIDUAL, limit) for name, (engine, _) in engines.items()
    }
    effort = replace(bench.effort, rounds=min(MOST_ROUNDS, bench.effort.rounds))
    net = f"{shape}, rest {rest_ratio:g}, all engines"
    timed = {name: sampled(one, effort) for name, one in watched.items()}
    compared = bench.compare(case, net, cords.network(), timed, effort)
    for name, one in watched.items():
        yield compared.row(name, f"{one.note()}; {engines[name][1]}")
    for name in list(watched)[1:]:
        times = ratio(compared.seconds[name], compared.seconds["springform"])
        yield Row(case, net, compared.springs, name, "times springform's time", times)
