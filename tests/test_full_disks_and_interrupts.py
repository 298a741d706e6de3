"""Full disks, interrupts, and runs too large: nothing is lost, and one line says what to do."""

from __future__ import annotations

import errno
import os
import pty
import re
import resource
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

import springform as sf
from helpers import Result, assert_refused, assert_says, in_process, refused, springform, start

pytestmark = pytest.mark.usefixtures("folder")


@pytest.fixture
def net(folder: Path) -> Path:
    """A valid design."""
    sf.save(sf.load("one-cylinder"), folder / "net.toml")
    return folder / "net.toml"


# --- full disks --------------------------------------------------------------------------------


def limited(size: int) -> Callable[[], None]:
    """No file may grow beyond a size, as under `ulimit -f`."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    return limit


@pytest.mark.parametrize("size", [0, 500, 1000])
def test_no_room_for_a_design(size: int, net: Path) -> None:
    words = ("init", "three-cylinders", "--out", "net.toml", "--force")
    line = refused(*words, run=lambda *w: springform(*w, preexec_fn=limited(size)))
    assert_says(line, "net.toml", "ulimit -f")


@pytest.mark.parametrize("size", [0, 100, 2_000, 4_000, 10_000, 30_000])
def test_a_run_on_a_full_disk_can_go_on(size: int, folder: Path) -> None:
    words = ("one-cylinder", "--population", "20", "--generations", "30", "--out", "run")
    full = springform("evolve", *words, preexec_fn=limited(size))
    assert_refused(full, "ulimit -f")
    begun = (folder / "run" / "run.json").exists()
    assert begun == ("springform resume run" in full.err)
    result = in_process("resume", "run") if begun else in_process("evolve", *words)
    assert result.code == 0, result
    control = sf.evolve(sf.load("one-cylinder"), population=20, generations=30)
    assert sf.open_run("run").digest() == control.digest()


def test_every_write_of_a_run_may_fail(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    words = ("one-cylinder", "--population", "4", "--generations", "3", "--out", "run")
    control = sf.evolve(sf.load("one-cylinder"), population=4, generations=3).digest()
    monkeypatch.setattr("springform.evolution._FIRST_CHECKPOINT", 0)
    monkeypatch.setattr("springform.evolution._CHECKPOINT_SHARE", 0)
    flush = os.fsync
    for fatal in range(100):
        steps = iter(range(1000))

        def full(descriptor: int, steps: Any = steps, fatal: int = fatal) -> None:
            if next(steps) == fatal:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            flush(descriptor)

        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", full)
            failed = in_process("evolve", *words)
        if next(steps) < fatal:
            break
        if failed.code:
            assert_refused(failed, "no space left", "run")
        begun = (folder / "run" / "run.json").exists()
        again = in_process("resume", "run") if begun else in_process("evolve", *words)
        assert again.code == 0, again
        assert sf.open_run("run").digest() == control
        assert not list((folder / "run").rglob(".*"))
        shutil.rmtree(folder / "run")
    assert fatal > 15


def test_pictures_and_results_on_a_full_disk(net: Path, folder: Path) -> None:
    for command in ("solve", "plot"):
        out = folder / command
        full = springform(command, net, "--out", out, preexec_fn=limited(300))
        assert_refused(full, "ulimit -f")
        assert all(path.stat().st_size == 0 or path.stat().st_size < 300 for path in out.iterdir())
        assert not list(out.glob(".*"))


def test_standard_output_that_is_full_or_closed(net: Path) -> None:
    with open("/dev/full", "w") as full:
        result = springform("solve", net, "--json", capture_output=False, stdout=full, stderr=-1)
    assert result.code == 2
    assert (
        result.err == "springform: no space left on the disk; free some, or choose another place\n"
    )
    reader, writer = os.pipe()
    os.close(reader)
    with open(writer, "w") as closed:
        result = springform("init", capture_output=False, stdout=closed, stderr=subprocess.PIPE)
    assert "Traceback" not in result.err
    assert "Exception ignored" not in result.err


# --- interrupts and memory ---------------------------------------------------------------------


def interrupted(*words: str | Path) -> Result:
    """Interrupt the command once the bar on its terminal says that one of many steps is made."""
    terminal, end = pty.openpty()
    wide = os.environ | {"TERM": "xterm", "COLUMNS": "200"}
    with open(terminal, "rb", buffering=0) as shown, start(*words, stderr=end, env=wide) as process:
        os.close(end)
        err = b""
        try:
            while not re.search(rb"[1-9]\d*/\d+", err):
                err += shown.read(1000)
            process.send_signal(signal.SIGINT)
            out, _ = process.communicate(timeout=60)
        finally:
            process.kill()
        with suppress(OSError):  # the end of a terminal that nobody writes to any more
            while more := shown.read(1000):
                err += more
    return Result(process.returncode, out, err.decode())


def test_an_interrupted_search_keeps_its_steps(folder: Path) -> None:
    words = ("seek", "three-cylinders-dense", "--steps", "100000", "--type", "2", "--out", "a.toml")
    result = interrupted(*words)
    assert (result.code, result.out) == (130, "")
    assert_says(result.err, "interrupted", "a.toml")
    before = len(sf.load("three-cylinders-dense").network().springs)
    assert len(sf.load(folder / "a.toml").network().springs) > before


def test_an_interrupt_while_it_loads_says_nothing() -> None:
    codes = []
    for at in range(16):
        process = start("solve", "one-cylinder")
        maps = Path(f"/proc/{process.pid}/maps")
        while "springform/_core" not in maps.read_text():
            assert process.poll() is None
            time.sleep(0.001)
        time.sleep(0.05 * at)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
        assert process.returncode in (0, 130, -signal.SIGINT), err
        assert err in ("", "springform: interrupted\n")
        codes.append(process.returncode)
    assert -signal.SIGINT in codes


def test_a_search_that_fails_keeps_its_steps(folder: Path) -> None:
    result = in_process("seek", "one-cylinder", "--steps", "9", "--type", "0", "--out", "a.toml")
    assert result.code == 0
    assert "ended after" in result.err
    assert sf.load(folder / "a.toml").solve().converged


def test_two_interrupts_at_once_do_no_harm(folder: Path) -> None:
    process = start("evolve", "one-cylinder", "--generations", "100000", "--out", "run")
    while not (folder / "run" / "run.json").exists():
        time.sleep(0.02)
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 130, err
    assert_says(err, "interrupted", "springform resume run")
    sf.open_run("run").best.network()


def test_a_large_population_can_be_interrupted(folder: Path) -> None:
    words = ("--population", "3000", "--generations", "1000", "--out", "run")
    result = interrupted("evolve", "one-cylinder", *words)
    assert result.code == 130, result
    assert_says(result.err, "interrupted", "springform resume run")
