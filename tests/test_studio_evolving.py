"""Runs that are steered from windows: the same bits as ever, and changes are kept."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import springform as sf
from helpers import springform
from springform.errors import InputError
from springform.studio.evolving import Evolving

DESIGN = sf.load("one-cylinder")
PARAMETERS = {"population": 12, "generations": 8, "insertions": "2"}


class Steered:
    """A run, and a way to wait for it."""

    def __init__(self, folder: Path) -> None:
        self.told = threading.Event()
        self.run = Evolving(folder, self.told.set)

    def until(self, generations: int) -> None:
        while len(self.run.rows) < generations:
            assert self.run.status in ("running", "paused"), self.run.reason
            self.told.wait(30)
            self.told.clear()

    def ended(self) -> None:
        assert self.run._thread is not None
        self.run._thread.join(60)


@pytest.fixture
def steered(tmp_path: Path) -> Iterator[Steered]:
    one = Steered(tmp_path / "run")
    yield one
    one.run.stop()


def test_it_makes_the_run_that_the_command_line_makes(steered: Steered, tmp_path: Path) -> None:
    steered.run.start(DESIGN, PARAMETERS)
    steered.ended()
    assert steered.run.status == "ended"
    assert steered.run.reason == "the number of generations is reached"
    plain = sf.evolve(DESIGN, out=tmp_path / "plain", **PARAMETERS)
    assert sf.open_run(steered.run.folder).digest() == plain.digest()
    row = steered.run.rows[-1]
    assert (row.springs, row.force_differential) == (
        plain.final["springs"],
        plain.final["force_differential"],
    )
    np.testing.assert_allclose(
        steered.run.columns(1)["springs"], plain.table["springs"].astype(np.float32)
    )


def test_every_individual_is_rebuilt(steered: Steered) -> None:
    steered.run.start(DESIGN, PARAMETERS)
    steered.ended()
    run = sf.open_run(steered.run.folder)
    for generation, individual in ((1, 0), (5, 7), (8, 11)):
        found = steered.run.individual(generation, individual)
        assert found.forest == run.individual(generation, individual).forest
    with pytest.raises(InputError):
        steered.run.individual(9, 0)
    with pytest.raises(InputError):
        steered.run.individual(1, 12)


def test_changed_parameters_hold_from_then_on_and_are_kept(steered: Steered) -> None:
    steered.run.start(DESIGN, PARAMETERS | {"generations": 10_000})
    steered.until(3)
    steered.run.pause()
    steered.run.change({"insertions": "20%"})
    steered.run.go_on()
    changed = len(steered.run.rows)
    steered.until(changed + 4)
    steered.run.stop()
    run = sf.open_run(steered.run.folder)
    at = [number for number, row in enumerate(steered.run.rows, start=1) if row.changed]
    assert len(at) == 1
    assert run.parameters_after(at[0] - 1).insertions == "2"
    assert run.parameters_after(at[0]).insertions == "20%"
    # Before and after the change, from the folder and from memory.
    for generation in (at[0], at[0] + 1, at[0] + 3):
        found = run.individual(generation, 3)
        assert found.forest == steered.run.individual(generation, 3).forest
    springs = run.table["springs"].reshape(-1, 12).mean(axis=1)
    assert springs[at[0]] - springs[at[0] - 1] > springs[1] - springs[0]


def test_a_run_goes_on_after_it_was_closed(steered: Steered, tmp_path: Path) -> None:
    steered.run.start(DESIGN, PARAMETERS | {"generations": 10_000})
    steered.until(2)
    steered.run.stop()
    other = Steered(steered.run.folder)
    other.run.open()
    made = len(other.run.rows)
    assert other.run.rows == steered.run.rows
    other.run.go_on()
    other.until(made + 2)
    other.run.stop()
    resumed = springform("resume", other.run.folder, "--generations", made + 8, "--json").report
    plain = {"population": 12, "insertions": "2", "generations": made + 8}
    control = sf.evolve(DESIGN, out=tmp_path / "control", **plain)
    assert resumed["digest"] == control.digest()


def test_what_is_refused_is_said_and_starts_nothing(steered: Steered) -> None:
    with pytest.raises(InputError, match="population"):
        steered.run.start(DESIGN, {"population": 0})
    with pytest.raises(InputError):
        steered.run.start(DESIGN, {"nonsense": 1})
    assert not steered.run.folder.exists()
    steered.run.start(DESIGN, PARAMETERS | {"generations": 10_000})
    with pytest.raises(InputError, match="stays as it was"):
        steered.run.change({"population": 5})
    with pytest.raises(InputError):
        steered.run.change({"insertions": "many"})


def test_two_can_not_drive_one_run(steered: Steered) -> None:
    steered.run.start(DESIGN, PARAMETERS | {"generations": 10_000})
    steered.until(1)
    steered.run.pause()
    other = Evolving(steered.run.folder, lambda: None)
    steered.until(1)
    while not (steered.run.folder / "journal.jsonl").exists():
        pass
    other.open()
    with pytest.raises(InputError, match="another process drives this run: the studio"):
        sf.resume(steered.run.folder)
    # Another studio asks whoever drives.
    made = len(steered.run.rows)
    other.go_on()
    steered.until(made + 1)
    other.stop()
    assert steered.run.status == "running"
