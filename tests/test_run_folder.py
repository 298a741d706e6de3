"""Run folders: the same bits on any threads, after any kill, and readable while they grow."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.dataset
import pytest

import springform as sf
from helpers import assert_refused, assert_untouched, contents, in_process, springform, start

SETTINGS: dict[str, dict[str, Any]] = {
    "default": {},
    "recursive": {"method": "recursive"},
    "extensible, stress": {"method": "extensible", "weighting": "stress"},
    "self-adaptive": {"self_adapt": True, "insertions": "5%"},
    "plus, niche": {"selection": "plus", "niche": 40, "fitness": "differential"},
    "parent as reference": {"suf_reference": "parent", "min_length": 0.01, "toggles": "10%"},
}

FREQUENT = """
import sys
from springform import cli, evolution
evolution._FIRST_CHECKPOINT = evolution._CHECKPOINT_SHARE = float(sys.argv.pop(1))
"""
"""A command with checkpoints at another interval [s], so that short runs have many."""

KILLED_AT_STEP = """
import os, signal, sys
fatal, steps = int(sys.argv.pop(1)), 0
def counted(act):
    def step(*arguments, **options):
        global steps
        steps += 1
        if steps == fatal:
            os.kill(os.getpid(), signal.SIGKILL)
        return act(*arguments, **options)
    return step
for name in ("fsync", "replace", "mkdir"):
    setattr(os, name, counted(getattr(os, name)))
"""
"""A command that is killed just before it flushes, renames or makes its nth file."""


def evolved(folder: Path, scene: str = "one-cylinder", **parameters: Any) -> sf.Run:
    method = parameters.pop("method", "dynamic")
    defaults = {"population": 6, "generations": 6, "seed": 5, "threads": 1}
    return sf.evolve(sf.load(scene).with_method(method), out=folder, **(defaults | parameters))


def command(prelude: str, *words: object) -> list[str]:
    code = f"{prelude}\ncli.main()" if "cli" in prelude else f"{prelude}{FREQUENT}\ncli.main()"
    return [sys.executable, "-c", code, *map(str, words)]


def wait_for(condition: Any, what: str) -> None:
    """Wait until a condition holds, for at most 30 s."""
    end = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < end, f"no {what} after 30 s"
        time.sleep(0.02)


def generations_of(folder: Path) -> int:
    journal = folder / "journal.jsonl"
    return len(journal.read_text().splitlines()) if journal.exists() else 0


def assert_rows_are_complete(run: sf.Run) -> None:
    population, table = run.parameters.population, run.table
    numbers = np.arange(run.generations * population)
    assert (table["generation"] == numbers // population + 1).all()
    assert (table["individual"] == numbers % population).all()


# --- the same bits -----------------------------------------------------------------------------


@pytest.mark.parametrize("setting", SETTINGS)
def test_threads_do_not_change_a_bit(setting: str, tmp_path: Path) -> None:
    digests = {
        evolved(tmp_path / str(threads), threads=threads, **SETTINGS[setting]).digest()
        for threads in (1, 2, 3)
    }
    assert len(digests) == 1


def test_the_command_gives_the_same_digest_on_one_thread_and_two(tmp_path: Path) -> None:
    words = ("evolve", "three-cylinders", "--population", "10", "--generations", "8", "--json")
    reports = [
        springform(*words, "--out", tmp_path / threads, "--threads", threads).report
        for threads in ("1", "2")
    ]
    assert reports[0]["digest"] == reports[1]["digest"]
    for report in reports:
        del report["seconds"]
    assert reports[0] == reports[1]


def test_other_seeds_and_parameters_give_other_digests(tmp_path: Path) -> None:
    runs = [{}, {"seed": 6}, {"insertions": "4"}, {"generations": 7}, {"weighting": "deep"}]
    digests = {evolved(tmp_path / str(n), **changes).digest() for n, changes in enumerate(runs)}
    assert len(digests) == len(runs)


@pytest.mark.parametrize("setting", SETTINGS)
def test_a_run_in_two_goes_equals_one_in_one_go(setting: str, tmp_path: Path) -> None:
    whole = evolved(tmp_path / "whole", generations=9, **SETTINGS[setting])
    first = evolved(tmp_path / "parts", generations=4, **SETTINGS[setting])
    assert first.digest() != whole.digest()
    second = sf.resume(first, generations=9, threads=2)
    assert second.digest() == whole.digest()
    assert second.parents == whole.parents
    assert second.parameters == whole.parameters
    assert_rows_are_complete(second)


# --- killed ------------------------------------------------------------------------------------

LONG = ("--population", "12", "--generations", "60", "--threads", "1")


@pytest.fixture(scope="module")
def control(tmp_path_factory: pytest.TempPathFactory) -> sf.Run:
    """The long run, never stopped."""
    folder = tmp_path_factory.mktemp("control") / "run"
    return evolved(folder, population=12, generations=60, seed=1)


def finish(folder: Path, *words: str) -> sf.Run:
    """Resume a folder that holds a run, or else start the run anew."""
    begun = (folder / "run.json").exists()
    command = ("resume", folder) if begun else ("evolve", "one-cylinder", "--out", folder, *words)
    result = in_process(*command, "--json")
    assert result.code == 0, result
    return sf.open_run(folder)


@pytest.mark.parametrize("seed", range(20))
def test_a_killed_run_resumes_to_the_same_bits(seed: int, control: sf.Run, tmp_path: Path) -> None:
    draw, folder = random.Random(seed), tmp_path / "run"
    words = command(FREQUENT, 0.05, "evolve", "one-cylinder", "--out", folder, *LONG)
    process = subprocess.Popen(words, stderr=subprocess.DEVNULL)
    # Some runs are killed while they begin, most while they go on.
    if draw.random() < 0.8:
        wait_for(folder.exists, "folder")
    time.sleep(draw.uniform(0, 0.7))
    process.kill()
    process.wait()
    run = finish(folder, *LONG)
    assert run.digest() == control.digest()
    assert run.parents == control.parents
    assert_rows_are_complete(run)
    assert not list(folder.rglob(".*"))


@pytest.mark.parametrize("step", [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 17, 20, 23, 26])
def test_a_kill_at_any_step_of_writing_loses_nothing(step: int, tmp_path: Path) -> None:
    short = ("--population", "6", "--generations", "6", "--seed", "5", "--threads", "1")
    folder = tmp_path / "run"
    words = command(KILLED_AT_STEP, step, 0, "evolve", "one-cylinder", "--out", folder, *short)
    killed = subprocess.run(words, stderr=subprocess.PIPE, check=False)
    assert killed.returncode == -signal.SIGKILL, killed.stderr
    run = finish(folder, *short)
    assert run.digest() == evolved(tmp_path / "control").digest()
    assert_rows_are_complete(run)
    assert not list(folder.rglob(".*"))


def test_a_run_can_be_killed_and_resumed_again_and_again(control: sf.Run, tmp_path: Path) -> None:
    folder, draw = tmp_path / "run", random.Random(7)
    evolved(folder, population=12, generations=2, seed=1)
    for generations in range(12, 61, 12):
        words = command(FREQUENT, 0.03, "resume", folder, "--generations", generations)
        process = subprocess.Popen(words, stderr=subprocess.DEVNULL)
        time.sleep(draw.uniform(0.3, 0.9))
        process.kill()
        process.wait()
        assert_rows_are_complete(sf.open_run(folder))
    run = sf.resume(folder, generations=60)
    assert run.digest() == control.digest()


# --- one process drives, others read -----------------------------------------------------------


def test_a_second_process_is_refused_and_readers_are_not(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    endless = ("--population", "20", "--generations", "100000", "--threads", "1")
    words = command(FREQUENT, 0.1, "evolve", "one-cylinder", "--out", folder, *endless)
    process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
    try:
        wait_for(lambda: generations_of(folder) > 2, "generation")
        assert_refused(springform("resume", folder), "another process")
        again = springform("evolve", "one-cylinder", "--out", folder, *endless)
        assert_refused(again, "already holds a run")
        seen = []
        for _ in range(25):
            run = sf.open_run(folder)
            assert_rows_are_complete(run)
            assert run.best.network().springs.shape[0] == run.final["springs"]
            seen.append(run.generations)
            time.sleep(0.02)
        assert seen == sorted(seen)
        assert seen[-1] > seen[0]
        shown = in_process(
            *("show", folder, "--generation", 2, "--individual", 3, "--out", tmp_path / "a.toml")
        )
        assert shown.code == 0, shown
    finally:
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=30)
    assert process.returncode == 130, said
    assert_rows_are_complete(sf.open_run(folder))


def test_of_two_runs_begun_at_once_one_is_refused(tmp_path: Path) -> None:
    words = ("evolve", "one-cylinder", "--out", tmp_path / "run", *LONG)
    both = [start(*words) for _ in range(2)]
    said = [process.communicate(timeout=60)[1] for process in both]
    assert sorted(process.returncode for process in both) == [0, 2], said
    assert sf.open_run(tmp_path / "run").generations == 60


def test_a_copy_of_a_run_is_a_run(tmp_path: Path) -> None:
    digest = evolved(tmp_path / "run", generations=3).digest()
    shutil.copytree(tmp_path / "run", tmp_path / "elsewhere" / "copy")
    shutil.rmtree(tmp_path / "run")
    copied = sf.open_run(tmp_path / "elsewhere" / "copy")
    assert copied.digest() == digest
    assert sf.resume(copied, generations=6).digest() == evolved(tmp_path / "control").digest()


def test_what_another_process_made_meanwhile_is_kept(tmp_path: Path) -> None:
    early = evolved(tmp_path / "run", generations=3)
    late = sf.resume(tmp_path / "run", generations=8)
    again = sf.resume(early)
    assert again.generations == late.generations
    assert again.digest() == late.digest()


# --- the ends of runs --------------------------------------------------------------------------


def test_resuming_a_finished_run_changes_nothing_but_its_log(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    digest = evolved(folder).digest()
    before = contents(folder)
    report = springform("resume", folder, "--json").report
    assert report["digest"] == digest
    after = contents(folder)
    assert after.pop("log.txt") != before.pop("log.txt")
    assert after == before


def test_more_generations_are_journalled(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    evolved(folder, generations=3)
    report = in_process("resume", folder, "--generations", "5", "--json").report
    assert report["generations"] == 5
    assert report["individuals"] == 30
    run = sf.open_run(folder)
    assert run.parameters.generations == 5
    assert run.digest() == evolved(tmp_path / "control", generations=5).digest()
    assert in_process("resume", folder, "--json").report["digest"] == run.digest()


def test_fewer_generations_keep_what_is_there(tmp_path: Path) -> None:
    digest = evolved(tmp_path / "run").digest()
    assert sf.resume(tmp_path / "run", generations=2).digest() == digest


def test_a_run_without_generations_can_be_read_and_resumed(tmp_path: Path) -> None:
    run = evolved(tmp_path / "run", generations=0)
    assert run.generations == 0
    assert run.table == {}
    assert run.lowest is None
    assert run.final == run.start
    assert run.pareto().size == 0
    assert run.best.network().springs.shape[0] == run.start["springs"]
    whole = sf.resume(run, generations=6)
    assert whole.digest() == evolved(tmp_path / "control").digest()


# --- what is in the folder ---------------------------------------------------------------------


def test_the_table_is_a_parquet_data_set(tmp_path: Path) -> None:
    run = sf.resume(evolved(tmp_path / "run", generations=3), generations=6)
    dataset = pyarrow.dataset.dataset(tmp_path / "run" / "measures", format="parquet")
    assert len(dataset.files) == 2
    found = dataset.to_table(use_threads=False).sort_by(
        [("generation", "ascending"), ("individual", "ascending")]
    )
    table = run.table
    assert found.column_names == list(table)
    for name, column in table.items():
        read = found[name].combine_chunks()
        if column.dtype == np.float64:
            read = read.fill_null(np.nan)
        assert read.to_numpy(zero_copy_only=False).dtype == column.dtype
        np.testing.assert_array_equal(read.to_numpy(zero_copy_only=False), column)


def test_summaries_are_those_of_the_table(tmp_path: Path) -> None:
    run = evolved(tmp_path / "run", population=20)
    table = run.table
    lowest = int(np.nanargmin(table["force_differential"]))
    assert run.lowest == (table["generation"][lowest], table["individual"][lowest])
    for generation, winner in enumerate(run.parents, start=1):
        assert winner is not None
        row = (generation - 1) * 20 + winner
        parent = run.parent(generation)
        assert len(parent.network().springs) == table["springs"][row]
        assert parent.forest.fingerprint == table["fingerprint"][row]
    standing = {name: table[name][row] for name in run.final}
    # The table has what the mutant measured, the summary what it measures as a parent.
    assert run.final == pytest.approx(standing, rel=1e-9)
    points = list(zip(table["springs"], table["force_differential"], strict=True))
    front = {points[row] for row in run.pareto()}
    dominated = {
        (springs, force)
        for springs, force in points
        if any(s >= springs and f <= force and (s, f) != (springs, force) for s, f in points)
    }
    assert front == {point for point in points if not np.isnan(point[1])} - dominated


def test_a_run_says_where_it_came_from(tmp_path: Path) -> None:
    run = evolved(tmp_path / "run")
    design = sf.load(tmp_path / "run" / "design.toml")
    assert design.to_file() == sf.load("one-cylinder").to_file()
    assert sf.load(tmp_path / "run" / "best.toml").forest == run.best.forest
    settings = (tmp_path / "run" / "run.json").read_text()
    for word in (sf.__version__, '"seed": 5', '"population": 6', '"versions"'):
        assert word in settings
    log = (tmp_path / "run" / "log.txt").read_text()
    assert "started" in log
    assert "ended by generations after generation 6" in log


def test_nothing_grows_with_population_times_genome(tmp_path: Path) -> None:
    def sizes(name: str, **parameters: Any) -> tuple[float, float]:
        """Bytes of the journal a generation, and of all else but the design an individual."""
        folder = tmp_path / name
        run = evolved(folder, **parameters)
        measures = sum(path.stat().st_size for path in (folder / "measures").iterdir())
        individuals = run.generations * run.parameters.population
        return (folder / "journal.jsonl").stat().st_size / run.generations, measures / individuals

    small = sizes("small", population=100)
    large = sizes("large", scene="three-cylinders-dense", population=100)
    crowded = sizes("crowded", population=400)
    for journal, measures in (small, large, crowded):
        assert journal < 1000
        assert measures < 250
    assert large[1] < 1.2 * small[1]
    assert crowded[0] < 1.2 * small[0]


def test_a_run_without_a_folder_leaves_nothing_behind() -> None:
    run = sf.evolve(sf.load("one-cylinder"), population=3, generations=2)
    folder = run.folder
    assert folder.exists()
    run.individual(2, 1)
    del run
    assert not folder.exists()


# --- folders that are no place for a run -------------------------------------------------------


def test_a_folder_with_other_things_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "design.toml").write_text("# mine\n")
    words = ("evolve", "one-cylinder", "--out", tmp_path, "--generations", "1")
    assert_refused(assert_untouched(tmp_path, lambda: in_process(*words)), "not empty")


def test_an_empty_folder_becomes_a_run(tmp_path: Path) -> None:
    assert evolved(tmp_path).generations == 6


def test_an_interrupt_ends_with_the_generation(tmp_path: Path) -> None:
    folder = tmp_path / "run"
    endless = ("--population", "20", "--generations", "100000", "--threads", "1")
    words = command(FREQUENT, 0.05, "evolve", "one-cylinder", "--out", folder, *endless)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(words, **pipes)
    wait_for(lambda: generations_of(folder) > 0, "generation")
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert process.returncode == 130, err
    assert out == ""
    assert err == f"springform: interrupted; go on with: springform resume {folder}\n"
    made = sf.open_run(folder).generations
    assert made > 0
    log = (folder / "log.txt").read_text()
    assert f"interrupted after generation {made}" in log
    assert springform("resume", folder, "--generations", made + 5).code == 0
    control = evolved(tmp_path / "control", population=20, generations=made + 5, seed=1)
    assert sf.open_run(folder).digest() == control.digest()


def test_an_interrupt_of_a_script_raises_and_keeps_the_run(tmp_path: Path) -> None:
    def interrupt(progress: sf.Progress) -> None:
        if progress.generation == 3:
            os.kill(os.getpid(), signal.SIGINT)

    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        evolved(tmp_path / "run", on_generation=interrupt)
    assert signal.getsignal(signal.SIGINT) is before
    assert sf.open_run(tmp_path / "run").generations == 3
    resumed = sf.resume(tmp_path / "run")
    assert resumed.digest() == evolved(tmp_path / "control").digest()


def test_an_error_in_a_callback_leaves_a_run_to_resume(tmp_path: Path) -> None:
    def fail(progress: sf.Progress) -> None:
        if progress.generation == 3:
            raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        evolved(tmp_path / "run", on_generation=fail)
    assert sf.resume(tmp_path / "run").digest() == evolved(tmp_path / "control").digest()
