"""Choosing: brushes, clusters and lineage of the individuals of a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import springform as sf
from springform.errors import InputError
from springform.studio.choosing import brushed, clusters
from springform.studio.evolving import Evolving


def table(seed: int, count: int) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    columns = {
        "springs": random.integers(100, 130, count).astype(np.float32),
        "force_differential": random.uniform(2, 90, count).astype(np.float32),
        "force_max": random.uniform(1, 3, count).astype(np.float32),
    }
    columns["force_differential"][random.random(count) < 0.1] = np.nan
    return columns


@given(st.integers(0, 100), st.integers(1, 80), st.integers(1, 12))
def test_clusters_share_out_what_is_brushed(seed: int, count: int, wanted: int) -> None:
    columns = table(seed, count)
    rows = np.flatnonzero(brushed(columns, {"springs": (105, 120), "force_differential": (0, 50)}))
    slow = [
        row
        for row in range(count)
        if 105 <= columns["springs"][row] <= 120 and columns["force_differential"][row] <= 50
    ]
    assert rows.tolist() == slow
    found = clusters(columns, rows, wanted)
    assert sum(size for _, size in found) == len(rows)
    assert len(found) <= wanted
    assert {row for row, _ in found} <= set(slow)
    assert len({row for row, _ in found}) == len(found)
    assert found == clusters(columns, rows, wanted)


def test_clusters_that_are_far_apart_are_found() -> None:
    columns = {name: np.repeat([1.0, 10.0, 100.0], 20) for name in table(0, 1)}
    columns["force_max"] = columns["force_max"] + np.tile(np.linspace(0, 0.1, 20), 3)
    found = clusters(columns, np.arange(60), 3)
    assert sorted((row // 20, size) for row, size in found) == [(0, 20), (1, 20), (2, 20)]


def test_what_is_no_axis_is_refused() -> None:
    with pytest.raises(InputError, match="there is no such axis"):
        brushed(table(1, 5), {"spring": (0, 1)})
    with pytest.raises(InputError, match="must be 1 to 100"):
        clusters(table(1, 5), np.arange(5), 0)


def test_a_lineage_leads_to_the_individual(tmp_path: Path) -> None:
    design = sf.load("one-cylinder")
    sf.evolve(design, out=tmp_path / "run", population=8, generations=6, insertions="2")
    run = Evolving(tmp_path / "run", lambda: None)
    run.open()
    for generation, individual in ((6, 3), (1, 0), (4, None)):
        now = design.closed
        for step in run.lineage(generation, individual):
            now = now.edited(step.edits)
            assert step.springs == len(now.network().springs)
        if individual is None:
            assert now.forest == run.parent(generation).forest
        else:
            assert now.forest == run.individual(generation, individual).forest
