"""Stages of an evaluation: their names, and that timing them leaves a run where it is."""

from __future__ import annotations

import springform as sf
from springform.parameters import checked_parameters
from springform.run import start_evolution


def test_stages_are_timed_and_the_run_stays_where_it_is() -> None:
    """Every stage has a time in every round; the next generation is the same with and without."""
    design = sf.load("one-cylinder")
    parameters = checked_parameters({"population": 4, "seed": 7}, design.file.method)
    timed = start_evolution(design, parameters, threads=1)
    other = start_evolution(design, parameters, threads=1)
    seconds = timed.stages(4, 3)
    assert list(seconds) == ["mutate", "filter", "nodes", "order", "factor", "solve", "measure"]
    assert all(times.shape == (3,) and (times >= 0).all() for times in seconds.values())
    assert all((seconds[stage] > 0).all() for stage in ("mutate", "nodes", "solve", "measure"))
    assert timed.generation == 0
    assert timed.advance()["columns"]["fingerprint"].tolist() == (
        other.advance()["columns"]["fingerprint"].tolist()
    )
