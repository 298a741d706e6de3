"""Runs that one process drives and others watch and steer."""

from __future__ import annotations

import json
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import springform as sf
from helpers import COMMAND, springform
from springform.errors import InputError
from springform.evolution import steer
from springform.steering import Driver, driver_of
from springform.studio.evolving import Evolving

WORDS = ("one-cylinder", "--population", "10", "--insertions", "1", "--threads", "1")


def wait_for(condition: Callable[[], object]) -> None:
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end, "waited for a minute"
        time.sleep(0.02)


@contextmanager
def driven(folder: Path, generations: int = 100_000) -> Iterator[subprocess.Popen[bytes]]:
    """Drive a run by the command line in a process of its own, killed at the end."""
    words = [COMMAND, "evolve", *WORDS, "--generations", str(generations), "--out", str(folder)]
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        wait_for(lambda: (folder / "run.json").exists() and (folder / "journal.jsonl").exists())
        yield process
    finally:
        process.kill()
        process.wait()


def test_the_command_line_obeys_between_generations_to_the_same_bits(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    with driven(folder) as process:
        driver = driver_of(folder)
        assert driver is not None
        assert (driver.program, driver.pid) == ("command line", process.pid)
        steer(folder, "pause")
        wait_for(lambda: (now := driver_of(folder)) is not None and now.standing)
        at = sf.open_run(folder).generations
        asked = springform("steer", folder, "change", "insertions=5%", f"generations={at + 6}")
        assert asked.code == 0
        assert springform("steer", folder, "continue").code == 0
        process.wait(60)
    assert driver_of(folder) is None
    run = sf.open_run(folder)
    assert run.generations == at + 6
    assert run.changed_after(at) == {"insertions", "generations"}
    assert run.parameters.insertions == "5%"
    # Every individual is rebuilt from the journal, those after the change too.
    last = run.individual(at + 6, 3)
    row = (at + 5) * 10 + 3
    assert last.forest.fingerprint == run.table["fingerprint"][row]
    # The run is the one that stopped there, was changed, and went on.
    other = tmp_path / "other"
    sf.evolve(sf.load("one-cylinder"), out=other, population=10, insertions="1", generations=at)
    again = Evolving(other, lambda: None)
    again.open()
    assert again.parameters.generations == at
    journal = (other / "journal.jsonl").read_text()
    change = {"generation": at, "parameters": {"insertions": "5%", "generations": at + 6}}
    (other / "journal.jsonl").write_text(journal + json.dumps(change) + "\n")
    assert sf.resume(other).digest() == run.digest()


def test_a_run_stands_still_while_its_parameters_change(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    with driven(folder) as process:
        steer(folder, "pause")
        wait_for(lambda: (now := driver_of(folder)) is not None and now.standing)
        at = sf.open_run(folder).generations
        journal = folder / "journal.jsonl"
        for count in range(1, 6):
            steer(folder, "change", insertions=f"{count}%")
            end = time.monotonic() + 60
            seen = 0
            # Whoever follows sees no moment in which it moves, until well after the change.
            while seen < 100:
                seen += f'"{count}%"' in journal.read_text()
                now = driver_of(folder)
                assert now is not None
                assert now.standing
                assert time.monotonic() < end
                time.sleep(0.001)
        steer(folder, "continue")
        wait_for(lambda: (now := driver_of(folder)) is not None and not now.standing)
        steer(folder, "stop")
        process.wait(60)
    assert sf.open_run(folder).generations >= at


def test_the_studio_watches_and_steers_what_the_command_line_drives(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    told = threading.Event()
    with driven(folder) as process:
        watched = Evolving(folder, told.set)
        watched.open()
        assert watched.driver is not None
        assert watched.driver.pid == process.pid
        made = len(watched.rows)
        wait_for(lambda: len(watched.rows) > made)
        watched.pause()
        wait_for(lambda: watched.status == "paused")
        watched.change({"insertions": "2"})
        wait_for(lambda: watched.parameters.insertions == "2")
        assert watched.rows[-1].changed
        watched.go_on()
        wait_for(lambda: watched.status == "running")
        assert watched.end_driver()
        process.wait(60)
        wait_for(lambda: watched.driver is None)
        assert watched.status == "paused"
        # Now it is free, and the studio may drive it.
        made = len(watched.rows)
        watched.go_on()
        driver = driver_of(folder)
        assert driver is not None
        assert driver.program == "studio"
        wait_for(lambda: len(watched.rows) > made + 1)
        steer(folder, "pause")
        wait_for(lambda: watched.status == "paused")
        watched.stop()
    run = sf.open_run(folder)
    numbers = run.table["generation"].astype(int) * 10 + run.table["individual"]
    assert len(set(numbers.tolist())) == len(numbers) == 10 * run.generations


def test_a_stale_lock_is_noticed_and_a_far_lease_is_kept(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    with driven(folder) as process:
        process.kill()
        process.wait()
    assert "command line" in (folder / "lock").read_text()
    assert driver_of(folder) is None
    with pytest.raises(InputError, match="nobody drives this run; resume it"):
        steer(folder, "pause")
    far = Driver(program="studio", pid=1, host="elsewhere", renewed=time.time(), standing=False)
    (folder / "lock").write_text(far.model_dump_json())
    assert str(driver_of(folder)) == "the studio (process 1 on elsewhere)"
    done = sf.open_run(folder).generations
    with pytest.raises(InputError, match=r"the studio \(process 1 on elsewhere\); wait for it"):
        sf.resume(folder, generations=done + 1)
    dead = far.model_copy(update={"renewed": time.time() - 3600})
    (folder / "lock").write_text(dead.model_dump_json())
    assert sf.resume(folder, generations=done + 1).generations == done + 1
    assert (folder / "lock").read_text() == ""


def test_what_is_refused_is_said_and_asks_nothing(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    with driven(folder):
        for words, problem in (
            (("nap",), "must be one of pause, continue, stop, change"),
            (("change",), "name parameters to change"),
            (("change", "insertions"), "must be a name and a value"),
            (("change", "insertion=3"), "unknown parameter; did you mean insertions"),
            (("change", "insertions=many"), "must be a number of cells"),
            (("change", "population=3"), "stays as it was at the start of the run"),
            (("pause", "insertions=3"), "only a change has parameters"),
        ):
            refused = springform("steer", folder, *words)
            assert refused.code == 2
            assert problem in refused.err, refused.err
        assert not (folder / "requests.jsonl").exists()
