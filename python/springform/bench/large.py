"""Cases `large-*`: from forest to measures on one big net, by the same calls as small ones."""

from __future__ import annotations

import ctypes
import itertools
import json
import math
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from ..design import Design
from .comparison import Bench
from .nets import large_design
from .records import Row
from .timing import Spread

FEW_ROUNDS = 3
"""Most rounds on nets beyond the size of a cache."""

STAGES = ("filter", "nodes and springs", "order, factor, solve", "measure")


def large(case: str, bench: Bench, springs: int) -> Iterator[Row]:
    """Time the way from forest to measures, its parts, and its memory."""
    wanted = bench.springs(springs)
    design = large_design(wanted)
    parts: dict[str, list[float]] = {stage: [] for stage in STAGES}
    residual = 0.0

    def whole() -> float:
        nonlocal residual
        seconds, residual = _once(design)
        for stage, value in zip(STAGES, seconds, strict=True):
            parts[stage].append(value)
        return sum(seconds)

    effort = replace(bench.effort, rounds=min(FEW_ROUNDS, bench.effort.rounds))
    net = "cylinder from an irregular forest"
    compared = bench.compare(case, net, design.network(), {"springform": whole}, effort)
    note = f"from forest to measures, residual {residual:.1e}"
    yield compared.row("springform", note)
    for stage, values in parts.items():
        value = Spread.of([1e3 * second for second in values])
        note = "called from Python, conversions included"
        yield Row(case, net, compared.springs, f"springform {stage}", "ms", value, note=note)
    yield from compared.reference_row()
    if compared.reference is not None:
        for variant, seconds in compared.reference.tried.items():
            value = Spread.of([1e3 * seconds])
            yield Row(
                case, net, compared.springs, variant.name, "ms", value, note="tried, best of two"
            )
    if sys.platform == "linux":
        yield _memory(case, net, wanted)


def exponent(rows: Sequence[Row]) -> Iterator[Row]:
    """Compare the growth of time from the smallest to the largest net with the reference's."""
    whole = [row for row in rows if row.engine == "springform" and row.figure == "ms"]
    if len(whole) < 2 or whole[0].ratio is None or whole[-1].ratio is None:
        return
    first, last = whole[0], whole[-1]
    assert first.ratio is not None
    assert last.ratio is not None
    growth = math.log(last.springs / first.springs)
    own = math.log(last.value.median / first.value.median) / growth
    theirs = own - math.log(last.ratio.median / first.ratio.median) / growth
    for engine, value in (("springform", own), ("reference", theirs)):
        note = f"from {first.springs} to {last.springs} springs"
        yield Row(
            "large",
            first.net,
            last.springs,
            engine,
            "exponent of time",
            Spread.of([value]),
            note=note,
        )


def _once(design: Design) -> tuple[list[float], float]:
    """Seconds of every stage from a design's forest, nothing kept from before, and the residual."""
    fresh = Design(design.file, setting=design.setting, forest=design.forest)
    clock = [time.perf_counter()]
    closed = fresh.closed
    clock.append(time.perf_counter())
    closed.network()
    clock.append(time.perf_counter())
    found = closed.solve()
    clock.append(time.perf_counter())
    closed.measure(found)
    clock.append(time.perf_counter())
    return [last - first for first, last in itertools.pairwise(clock)], found.residual


def _memory(case: str, net: str, springs: int) -> Row:
    """Peak memory of the way from forest to measures, in a process of its own."""
    script = "from springform.bench import large; large.print_memory()"
    command = [sys.executable, "-c", script, str(springs)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    each = (found["peak"] - found["before"]) / found["springs"]
    note = f"peak {found['peak'] / 1e6:.0f} MB, {found['before'] / 1e6:.0f} MB before"
    return Row(
        case,
        net,
        found["springs"],
        "springform",
        "bytes a spring at the peak",
        Spread.of([each]),
        note=note,
    )


def print_memory() -> None:
    """Print the memory [bytes] before one way from forest to measures, and its peak."""
    design = large_design(int(sys.argv[1]))
    # What building the design has freed goes back to the system, or the peak would hide in it.
    ctypes.CDLL(None).malloc_trim(0)
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    before = _status("VmRSS")
    _once(design)
    report = {"before": before, "peak": _status("VmHWM"), "springs": len(design.network().springs)}
    print(json.dumps(report))


def _status(name: str) -> int:
    found = re.search(rf"{name}:\s+(\d+) kB", Path("/proc/self/status").read_text(encoding="ascii"))
    assert found is not None
    return 1024 * int(found[1])
