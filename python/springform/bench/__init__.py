"""Benchmarks: springFORM beside CHOLMOD and other engines, all timed in the same rounds.

Every case yields rows; `run` collects them. What a case measures, and how to read it, says
bench/README.md.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from ..errors import InputError
from ..files import WriteError, explain
from ..wording import nearest
from . import (
    equilibria,
    individuals,
    large,
    machine,
    page,
    peers,
    reference,
    runs,
    scikit_sparse,
    studio,
)
from .comparison import Bench
from .records import Row, write_csv
from .timing import Effort

__all__ = ["CASES", "GROUPS", "Bench", "Effort", "Row", "chosen", "run", "versions"]

CASES: dict[str, Callable[[str, Bench], Iterator[Row]]] = {
    "individual": individuals.individual,
    "paper-a": partial(runs.paper, wanted=runs.PAPER_A),
    "paper-b": partial(runs.paper, wanted=runs.PAPER_B),
    "growth": runs.growth,
    "nonlinear-2k": partial(equilibria.nonlinear, springs=2_000),
    "nonlinear-20k": partial(equilibria.nonlinear, springs=20_000),
    "nonlinear-200k": partial(equilibria.nonlinear, springs=200_000),
    "large-20k": partial(large.large, springs=20_000),
    "large-200k": partial(large.large, springs=200_000),
    "large-1m": partial(large.large, springs=1_000_000),
    "threads": individuals.threads,
    "stream": runs.stream,
    "studio": studio.studio,
}
"""All cases."""

GROUPS: dict[str, tuple[str, ...]] = {
    "default": ("individual", "growth", "nonlinear-2k", "large-20k", "threads", "stream", "studio"),
    "nonlinear": ("nonlinear-2k", "nonlinear-20k", "nonlinear-200k"),
    "large": ("large-20k", "large-200k", "large-1m"),
    "all": tuple(CASES),
}
"""Names for several cases; `default` is what is measured when none is named."""


@dataclass(frozen=True)
class Result:
    """What was measured of one case."""

    case: str
    """Its name."""
    rows: tuple[Row, ...]
    """Figures."""
    path: Path | None
    """The CSV file they are in."""


def chosen(names: Sequence[str]) -> list[str]:
    """Return cases by their names and those of groups, each once, in order.

    Raises `InputError`: a name that there is not.
    """
    known = [*CASES, *GROUPS]
    for name in names:
        if name not in known:
            raise InputError(
                f"there is no such case; {nearest(name, known)} the cases are {', '.join(CASES)}, "
                f"and {', '.join(GROUPS)} for several",
                key=name,
            )
    wanted = names or ("default",)
    return list(dict.fromkeys(case for name in wanted for case in GROUPS.get(name, (name,))))


def run(
    names: Sequence[str] = (),
    *,
    bench: Bench | None = None,
    out: str | os.PathLike[str] | None = None,
    label: str = "",
    on_row: Callable[[Row], None] = lambda _: None,
) -> Iterator[Result]:
    """Measure cases one after the other; yield each when it is done.

    With `out`, each case's rows are written to OUT/MACHINE/CASE.csv as soon as it is done, whole or
    not at all; `label` says there which code was timed. Raises `InputError`: an unknown case, a
    folder that can't be written, or no browser for the case `studio`; before anything is measured.
    """
    cases = chosen(names)
    if "studio" in cases:
        page.check()
    folder = None if out is None else _folder(Path(out) / machine.slug())
    return _measured(cases, Bench() if bench is None else bench, folder, label, on_row)


def _measured(
    cases: Sequence[str],
    bench: Bench,
    folder: Path | None,
    label: str,
    on_row: Callable[[Row], None],
) -> Iterator[Result]:
    wholes: list[Row] = []
    for case in cases:
        rows = list(_told(CASES[case](case, bench), on_row))
        if case.startswith("large-"):
            wholes += rows
            rows += _told(large.exponent(wholes), on_row)
        path = None if folder is None else folder / f"{case}.csv"
        if path is not None:
            write_csv(rows, path, label)
        yield Result(case, tuple(rows), path)


def versions() -> dict[str, str]:
    """Return the versions of everything that may run."""
    found = machine.versions()
    if reference.available():
        found |= reference.versions()
    wrapper = scikit_sparse.version()
    if wrapper is not None:
        found["scikit-sparse"] = wrapper
    peer_versions = {peer.distribution: peer.version() for peer in peers.PEERS}
    return found | {name: version for name, version in peer_versions.items() if version is not None}


def _told(rows: Iterable[Row], on_row: Callable[[Row], None]) -> Iterator[Row]:
    for row in rows:
        on_row(row)
        yield row


def _folder(path: Path) -> Path:
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(f"can't be made: {explain(error)}", file=path) from None
    return path
