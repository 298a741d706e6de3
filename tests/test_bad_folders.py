"""Folders in the way and damaged runs: one clear line, exit code 2, and nothing written or lost."""

from __future__ import annotations

import json
import random
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import springform as sf
from helpers import assert_refused, assert_says, in_process, refused

pytestmark = pytest.mark.usefixtures("folder")

OUT = ("--out", "new")


@pytest.fixture
def net(folder: Path) -> Path:
    """A valid design."""
    path = folder / "net.toml"
    sf.save(sf.load("one-cylinder"), path)
    return path


# --- folders -----------------------------------------------------------------------------------


def test_outputs_that_are_in_the_way(net: Path, folder: Path) -> None:
    short = ("--generations", "1", "--population", "2")
    assert_says(refused("evolve", net, "--out", "mine.txt", *short), "mine.txt")
    assert_says(refused("evolve", net, "--out", "mine.txt/run", *short), "mine.txt/run")
    assert_says(refused("evolve", net, "--out", "/proc/run", *short), "/proc/run")
    assert_says(refused("evolve", net, "--out", ".", *short), "not empty")
    assert_says(refused("evolve", net, "--out", "x" * 300, *short), "too long")
    assert_says(refused("solve", net, "--out", "mine.txt"), "mine.txt")
    assert_says(refused("solve", net, "--out", "/proc/results"), "/proc/results")
    assert_says(refused("plot", net, "--out", "/proc/pictures"), "/proc/pictures")
    assert_says(refused("init", "sheet", "--out", "net.toml"), "net.toml", "--force")


def test_results_do_not_replace_other_files(net: Path, folder: Path) -> None:
    net.rename(folder / "design.toml")
    assert_says(refused("solve", "design.toml", "--out", "."), "design.toml", "another folder")
    (folder / "results").mkdir()
    (folder / "results" / "net.obj").write_text("v 0 0 0\n")
    assert_says(refused("solve", "design.toml", "--out", "results"), "net.obj", "another folder")
    for _ in range(2):
        assert in_process("solve", "design.toml", "--out", "own").code == 0


@pytest.fixture
def run(folder: Path) -> Path:
    """A finished run of two checkpoints."""
    path = folder / "run"
    sf.evolve(sf.load("one-cylinder"), out=path, population=4, generations=3)
    sf.resume(path, generations=6)
    return path


def shown(generation: int | str, individual: int | str, out: str = "new.toml") -> tuple[str, ...]:
    words = ("--generation", str(generation), "--individual", str(individual))
    return ("show", "run", *words, "--out", out)


def test_runs_are_not_overwritten(run: Path) -> None:
    assert_says(refused("evolve", "sheet", "--out", run), "run", "already holds a run", "resume")
    assert_says(refused("solve", "sheet", "--out", run), "another folder")
    assert_says(refused(*shown(1, 1, "run/design.toml")), "run/design.toml")
    refused("seek", "one-cylinder", "--steps", "2", "--type", "1", "--out", "run/design.toml")


def test_individuals_that_are_not_there(run: Path) -> None:
    assert_says(refused(*shown(0, 0)), "generation 0", "1 to 6")
    assert_says(refused(*shown(7, 0)), "generation 7", "1 to 6")
    assert_says(refused(*shown(1, 4)), "individual 4", "0 to 3")
    assert_says(refused(*shown(1, -1)), "individual -1")
    assert_says(refused(*shown("1.5", 0)), "--generation")
    assert_says(refused(*shown(1, 1, "new.txt")), "new.txt")
    assert_says(refused(*shown(1, 1, "nowhere/new.toml")), "nowhere")


def test_options_of_resume(run: Path) -> None:
    assert_says(refused("resume", run, "--generations", "-1"), "generations")
    assert_says(refused("resume", run, "--threads", "0"), "threads")
    assert_says(refused("resume", run, "--population", "5"), "--population")


# --- damaged runs ------------------------------------------------------------------------------

NEEDED = ["run.json", "design.toml", "measures/0000001-0000003.parquet"]
MENDED = ["journal.jsonl", "measures/0000004-0000006.parquet", "log.txt", "lock", "best.toml"]
READERS: list[tuple[str, ...]] = [
    ("resume", "run"),
    shown(1, 1),
    ("plot", "run", *OUT),
]


def garbage(size: int) -> bytes:
    return random.Random(size).randbytes(size)


DAMAGE: dict[str, Callable[[Path], object]] = {
    "missing": lambda path: path.unlink(),
    "empty": lambda path: path.write_bytes(b""),
    "garbage": lambda path: path.write_bytes(garbage(500)),
    "a folder": lambda path: (path.unlink(), path.mkdir()),
    "zeros at the end": lambda path: path.write_bytes(path.read_bytes()[:-20] + b"\0" * 20),
    "half": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
}


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("name", NEEDED)
def test_damaged_files_of_a_run_are_named(name: str, damage: str, run: Path) -> None:
    DAMAGE[damage](run / name)
    for words in READERS:
        line = refused(*words)
        assert "run" in line
        assert_says(
            line, Path(name).name if damage != "missing" or name != NEEDED[2] else "measures"
        )


@pytest.mark.parametrize("name", ["missing", "empty", "half"])
@pytest.mark.parametrize("file", MENDED)
def test_what_can_be_made_again_is(file: str, name: str, run: Path) -> None:
    digest = sf.open_run(run).digest()
    path = run / file
    if name == "half" and file.endswith(".parquet"):
        DAMAGE[name](path)
        assert_says(refused("resume", run), path.name)
        return
    DAMAGE[name](path) if not (name == "empty" and file.endswith(".parquet")) else path.unlink()
    assert in_process("resume", run, "--generations", "6").code == 0
    assert sf.open_run(run).digest() == digest


@pytest.mark.parametrize("seed", range(6))
def test_runs_damaged_at_random_are_refused_or_the_same(seed: int, run: Path, folder: Path) -> None:
    whole = folder / "whole"
    run.rename(whole)
    digest = sf.open_run(whole).digest()
    draw = random.Random(seed)
    names = sorted(path for path in whole.rglob("*") if path.is_file() and path.stat().st_size)
    for _ in range(12):
        shutil.copytree(whole, run)
        path = run / draw.choice(names).relative_to(whole)
        data = bytearray(path.read_bytes())
        if draw.random() < 0.5:
            del data[draw.randrange(len(data)) :]
        else:
            for _ in range(draw.choice([1, 3, 50])):
                data[draw.randrange(len(data))] = draw.randrange(256)
        path.write_bytes(data)
        result = in_process("resume", run, "--generations", "6", "--json")
        if result.code == 0:
            assert result.report["digest"] == digest, path
        elif result.code:
            assert_refused(result, "run")
        shutil.rmtree(run)


JOURNAL_LINES = [
    "{}",
    "[]",
    "3",
    "null",
    '"parent"',
    '{"generation": 7}',
    '{"parameters": {}}',
    '{"generation": 7, "parameters": 3}',
    '{"generation": 9, "parent": 1, "springs": 3, "force_differential": 2.0, "suf": 1.0,'
    ' "strategy": [], "edits": []}',
    '{"generation": 7, "parent": -1}',
    "{" * 5000,
]


@pytest.mark.parametrize("line", JOURNAL_LINES, ids=lambda line: line[:20])
def test_broken_lines_of_the_journal(line: str, run: Path) -> None:
    with open(run / "journal.jsonl", "a") as journal:
        journal.write(line + "\n")
    assert_says(refused("resume", run), "journal.jsonl:8:")


@pytest.mark.parametrize(
    ("key", "value", "part"),
    [
        ("springform_run", 2, "version 2"),
        ("springform_run", "1", "version"),
        ("start", [1], "run.json"),
        ("start", ["a", 2.0], "run.json"),
        ("design", "", "design.toml"),
        ("parameters", [], "run.json"),
        ("parameters", {"population": -1}, "parameters.population"),
        ("parameters", {"populatoin": 1}, "did you mean population?"),
        ("parameters", {"types": 5.5}, "types"),
        ("tolerance", None, "run.json"),
    ],
)
def test_broken_settings_of_a_run(key: str, value: Any, part: str, run: Path) -> None:
    settings = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(json.dumps(settings | {key: value}))
    assert_says(refused("resume", run), "run/", part)


def test_a_journal_of_another_run(run: Path) -> None:
    lines = (run / "journal.jsonl").read_text().replace(" subdivide", " merge")
    (run / "journal.jsonl").write_text(lines)
    refused("resume", run)
