"""A window of the studio in Chromium: what `studio/tests/measures.ts` measures there, as rows.

It needs the sources of the studio with their packages, which `SPRINGFORM_STUDIO` names;
`make bench` sets it.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..design import Design, load, save
from ..errors import InputError
from ..evolution import evolve
from .comparison import Bench
from .records import Row
from .timing import Spread

_MOVES = 120
"""Moves of the pointer in a round."""

_ROUNDS = 5

_INDIVIDUALS = 2_500
"""Individuals of a generation of the gallery."""

_GENERATIONS = 20

_CHROMIUM = "/usr/bin/chromium"
"""Where it is unless `CHROMIUM` says otherwise, as in `studio/playwright.config.ts`."""

_PHASES = {
    "asked": ("page: pointer to request", "the pointer's queue in Chromium, and the page's work"),
    "waited": ("engine: waiting", "until the step under way is done"),
    "solved": ("engine: step", "one step of the net"),
    "carried": ("transport", "there and back, coding, queues of the engine and of the page"),
    "applied": ("page: decode and apply", "until colours and panels know"),
    "drawn": ("page: draw", "until the page's part of a picture is done"),
}
"""Parts of the way from a pointer's move to a picture, by their keys."""


def available() -> bool:
    """Return whether the sources of the studio are known."""
    return bool(os.environ.get("SPRINGFORM_STUDIO"))


def check() -> None:
    """Check that a window can be measured, if it is to be.

    Raises `InputError`: Node.js or Chromium is not there.
    """
    if not available():
        return
    if shutil.which("npx") is None:
        raise InputError("a window needs Node.js 20 or newer; install it so that `npx` is found")
    chromium = os.environ.get("CHROMIUM", _CHROMIUM)
    if shutil.which(chromium) is None:
        raise InputError(
            f"a window needs Chromium, and {chromium} is none; install it (Debian: chromium), "
            "or name it in CHROMIUM"
        )


def page(case: str, bench: Bench, pulled: Design, large: Design) -> Iterator[Row]:
    """Measure a window that pulls one net, pulls and picks in a larger one, and scrolls a gallery.

    Raises `InputError`: Chromium could not be driven, with what it said.
    """
    with tempfile.TemporaryDirectory(prefix="springform-") as folder:
        found = _measured(Path(folder), bench, pulled, large)
    chromium = f"Chromium {found['chromium']}"
    yield from _pulled(case, "three-cylinders", found["pulled"], chromium)
    yield from _large(case, "cylinder", found, chromium)
    springs = len(load("canopy").network().springs)
    yield from _gallery(case, springs, found["gallery"], chromium)


def _measured(folder: Path, bench: Bench, pulled: Design, large: Design) -> dict[str, Any]:
    save(pulled, folder / "pulled.toml")
    save(large, folder / "large.toml")
    evolve(
        load("canopy"),
        out=folder / "run",
        population=bench.count(_INDIVIDUALS),
        generations=bench.count(_GENERATIONS),
        insertions="1",
        seed=1,
    )
    out = folder / "figures.json"
    wanted = {
        "pulled": str(folder / "pulled.toml"),
        "large": str(folder / "large.toml"),
        "run": str(folder / "run"),
        "rounds": 1 if bench.quick else _ROUNDS,
        "moves": 30 if bench.quick else _MOVES,
        "out": str(out),
    }
    (folder / "wanted.json").write_text(json.dumps(wanted), encoding="utf-8")
    environment = os.environ | {"SPRINGFORM_MEASURE": str(folder / "wanted.json")}
    command = ["npx", "playwright", "test", "--project", "measures"]
    done = subprocess.run(
        command,
        cwd=os.environ["SPRINGFORM_STUDIO"],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0 or not out.exists():
        said = [line.strip() for line in (done.stdout + done.stderr).splitlines() if line.strip()]
        reason = next((line for line in said if "rror" in line), said[-1] if said else "nothing")
        raise InputError(f"Chromium did not measure; it said: {reason}")
    found: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
    return found


def _pulled(
    case: str, net: str, rounds: Sequence[Mapping[str, Any]], chromium: str
) -> Iterator[Row]:
    springs = rounds[0]["springs"]
    moves = len(rounds[0]["delays"])
    note = f"of about {moves} moves, 60 a second, from the pointer's event on; {chromium}"
    late = Spread.of([_most(one["delays"]) for one in rounds])
    yield Row(case, net, springs, "page", "ms to new positions, 95 %", late, note=note)
    for key, (engine, explained) in _PHASES.items():
        times = Spread.of([_most([move[key] for move in one["moves"]]) for one in rounds])
        drawn = ", drawn in software" if key == "drawn" else ""
        yield Row(case, net, springs, engine, "ms, 95 %", times, note=explained + drawn)


def _large(case: str, net: str, found: Mapping[str, Any], chromium: str) -> Iterator[Row]:
    rounds = found["large"]
    springs = rounds[0]["springs"]

    def row(engine: str, figure: str, values: Sequence[float], note: str) -> Row:
        return Row(case, net, springs, engine, figure, Spread.of(values), note=note)

    size = f"{rounds[0]['size'] / 1024:.0f} kB each"
    taken = [one["taken"] for one in rounds]
    yield row("page", "frames/s", taken, f"taken while a node is pulled 60 times a second, {size}")
    drawn = [one["drawn"] for one in rounds]
    yield row("page: draw", "pictures/s", drawn, f"meanwhile, drawn in software; {chromium}")
    late = [_most(one["delays"]) for one in rounds]
    yield row("page", "ms to new positions, 95 %", late, "from the pointer's event on")
    picked = [_most(hovers) for hovers in found["hovers"]]
    yield row("page", "ms to pick, 95 %", picked, "until what lies under the pointer is told")
    told = "from the button's event until the page's part of a picture of the cells is done"
    yield row("page", "ms to select by a lasso", found["lassos"], told)


def _gallery(case: str, springs: int, found: Mapping[str, Any], chromium: str) -> Iterator[Row]:
    net = f"canopy, gallery of {found['individuals']}"
    for figure, key, note in (
        ("elements at most", "elements", "in the gallery, while it is scrolled"),
        ("ms, longest task", "longest", "0: none that Chromium calls long, 50 ms or more"),
        ("pictures/s", "frames", f"meanwhile; {chromium}"),
    ):
        yield Row(case, net, springs, "page", figure, Spread.of([float(found[key])]), note=note)


def _most(times: Sequence[float]) -> float:
    """Return within what 95 % of the times are."""
    return float(np.quantile(times, 0.95))
