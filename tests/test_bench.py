"""Benchmarks: nets are what they claim, the reference solves, the command keeps its contract."""

from __future__ import annotations

import csv
import importlib.util
import os
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import springform as sf
from helpers import assert_refused, assert_untouched, environment, in_process, springform, start
from springform import bench
from springform.bench import machine, nets, peers, reference, timing
from springform.bench.records import Row, write_csv
from springform.bench.timing import Effort, Spread

ROOT = Path(__file__).parent.parent
COLUMNS = ["case", "net", "springs", "engine", "figure", "minimum", "median", "maximum", "spread"]

cylinders = st.builds(
    nets.Cylinder, st.integers(2, 8).map(lambda n: 4 * n), st.integers(2, 12), st.booleans()
)


# --- nets -------------------------------------------------------------------------------------


@settings(max_examples=50)
@given(cylinders)
def test_cylinders_are_periodic_dia_grids(shape: nets.Cylinder) -> None:
    cords = shape.net(0.6)
    nodes = len(cords.positions)
    assert nodes == shape.around * (shape.rows + 1)
    rings = 2 * shape.around if shape.cables else 0
    assert len(cords.springs) == 2 * shape.around * shape.rows + rings
    pairs = {frozenset(pair) for pair in cords.springs.tolist()}
    assert len(pairs) == len(cords.springs), "each spring stands once"
    degree = np.bincount(cords.springs.ravel(), minlength=nodes).reshape(-1, shape.around)
    assert (degree[1:-1] == 4).all()
    assert (degree[[0, -1]] == (4 if shape.cables else 2)).all()
    # Turned by one column it has the same springs, so the seam is like any other place.
    row, column = np.divmod(np.arange(nodes), shape.around)
    turned = row * shape.around + (column + 1) % shape.around
    assert {frozenset(pair) for pair in turned[cords.springs].tolist()} == pairs


@settings(max_examples=50)
@given(cylinders, st.floats(0.1, 0.99))
def test_cylinders_have_anchors_and_rest_lengths(shape: nets.Cylinder, ratio: float) -> None:
    cords = shape.net(ratio)
    held = cords.fixed.reshape(-1, shape.around).sum(axis=1)
    assert held[0] == held[-1] == nets.ANCHORS
    assert held[1:-1].sum() == 0
    lengths = nets.spring_lengths(cords.positions, cords.springs)
    np.testing.assert_allclose(cords.rest_length, ratio * lengths)
    steps = lengths[: 2 * shape.around * shape.rows]
    np.testing.assert_allclose(steps, steps[0])


@pytest.mark.parametrize(
    ("springs", "size"), [(2_000, 1_920), (20_000, 19_840), (200_000, 199_584)]
)
def test_cylinders_have_the_sizes_of_the_cases(springs: int, size: int) -> None:
    shape = nets.Cylinder.of(springs)
    assert 2 * shape.around * shape.rows == size
    assert shape.rows % 4 == shape.around % 4 == 0


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000))
def test_children_are_refined_in_a_few_places(seed: int) -> None:
    shape = nets.Cylinder(16, 8)
    parent = shape.net(0.6)
    equilibrium = sf.solve(parent.network()).positions
    child = nets.child_of(shape, parent, equilibrium, seed)
    # A divided diamond: four sides become eight, its middle gets four spokes.
    assert len(child.springs) == len(parent.springs) + 3 * (8 + 4 - 4)
    assert len(child.positions) == len(parent.positions) + 3 * 5
    np.testing.assert_array_equal(child.positions[: len(equilibrium)], equilibrium)
    np.testing.assert_array_equal(child.fixed[: len(parent.fixed)], parent.fixed)
    kept = {
        frozenset(pair): rest
        for pair, rest in zip(parent.springs.tolist(), parent.rest_length, strict=True)
    }
    changed = [
        rest / kept[frozenset(pair)]
        for pair, rest in zip(child.springs.tolist(), child.rest_length, strict=True)
        if frozenset(pair) in kept and rest != kept[frozenset(pair)]
    ]
    assert len(changed) == 5
    assert all(0.8 <= factor <= 1.2 for factor in changed)
    assert sf.solve(child.network()).converged


def test_large_designs_have_about_the_springs_they_are_named_for() -> None:
    design = nets.large_design(20_000)
    assert abs(len(design.network().springs) / 20_000 - 1) < 0.05
    assert len(design.anchors) == 2 * nets.ANCHORS
    assert {"1", "6"} == set(design.cells.types)
    assert set(design.cells.squares[:, 1]) == {1, 2}


def test_evolved_designs_are_the_same_each_time() -> None:
    first, again = (nets.evolved("one-cylinder", 400, ("1", "6"), "dynamic") for _ in range(2))
    assert len(first.network().springs) >= 400
    assert first.to_file() == again.to_file()


def test_our_residual_agrees_with_the_solver() -> None:
    network = nets.Cylinder(16, 8).net(0.6).network()
    out = np.linalg.norm(sf.residuals(network), axis=1).max()
    mean = np.abs(
        network.stiffness
        * (nets.spring_lengths(network.positions, network.springs) - network.rest_length)
    ).mean()
    assert nets.relative_residual(network, network.positions) == pytest.approx(out / mean)
    found = sf.solve(network)
    assert nets.relative_residual(network, found.positions) == pytest.approx(
        found.residual, rel=0.1
    )


# --- reference and peers ----------------------------------------------------------------------


def test_the_laplacian_holds_the_linear_equilibrium() -> None:
    design = sf.load("three-cylinders")
    network = design.network()
    matrix = reference.Laplacian.of(network)
    free = design.solve().positions[~network.fixed]
    np.testing.assert_allclose(matrix.times(free), matrix.sides, atol=1e-9)


def test_the_reference_solves_what_it_is_given() -> None:
    if not reference.available():
        assert "cholmod" not in bench.versions()
        return
    judge = reference.Reference(sf.load("three-cylinders").network())
    seconds = judge.stages(3)
    assert seconds.shape == (3, 3)
    assert (seconds > 0).all()
    assert judge.name.startswith("cholmod AMD")


def test_dynamic_relaxation_as_an_engine_reaches_the_residual() -> None:
    cords = nets.Cylinder(16, 8).net(0.6)
    found = sf.solve(cords.network(), tolerance=1e-6, solver="dynamic-relaxation")
    assert nets.relative_residual(cords.network(), found.positions) <= 1e-6 * (1 + 1e-9)


@pytest.mark.parametrize("peer", peers.PEERS, ids=lambda peer: peer.distribution)
def test_peers_reach_the_same_equilibrium(peer: peers.Peer) -> None:
    if peer.version() is None:
        assert importlib.util.find_spec(peer.module) is None
        return
    found = peer.engine(nets.Cylinder(8, 4).net(0.6), 1e-6, 30.0)
    assert found.residual <= 1e-6


# --- timing -----------------------------------------------------------------------------------


@given(st.lists(st.floats(1e-6, 1e3), min_size=1, max_size=20))
def test_spreads_are_ordered(values: list[float]) -> None:
    spread = Spread.of(values)
    assert spread.minimum <= spread.median <= spread.maximum
    assert spread.spread >= 0
    assert spread.repeats == len(values)


def test_contenders_take_turns_and_the_first_round_does_not_count() -> None:
    turns: list[str] = []

    def timed(name: str) -> timing.Timed:
        def work() -> float:
            turns.append(name)
            return float(len(turns))

        return work

    seconds = timing.interleaved({"a": timed("a"), "b": timed("b")}, Effort(rounds=3, fewest=3))
    assert "".join(turns) == "abababab"
    assert seconds == {"a": [3.0, 5.0, 7.0], "b": [4.0, 6.0, 8.0]}
    assert timing.ratio(seconds["a"], seconds["b"]).maximum == pytest.approx(7 / 8)


# --- the command ------------------------------------------------------------------------------


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder in which the commands run."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_one_json_object_and_one_file_a_case(folder: Path) -> None:
    cases = ("nonlinear-2k", "large-20k", "stream")
    result = springform("bench", *cases, "--quick", "--json", "--out", "out", "--label", "here")
    assert result.code == 0, result
    report = result.report
    assert list(report) == ["machine", "versions", "label", "quick", "cases"]
    assert list(report["cases"]) == list(cases)
    assert report["quick"] is True
    found = sorted(path.relative_to(folder / "out") for path in (folder / "out").rglob("*.csv"))
    assert found == sorted(Path(machine.slug()) / f"{case}.csv" for case in cases)
    for case in cases:
        with open(folder / "out" / machine.slug() / f"{case}.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == len(report["cases"][case]) > 0
        assert list(rows[0])[: len(COLUMNS) + 1] == ["code", *COLUMNS]
        assert {row["code"] for row in rows} == {"here"}
        assert {row["case"] for row in rows} == {case}


@pytest.mark.parametrize("case", ["individual", "paper-a", "growth", "threads", "studio"])
def test_cases_run(case: str) -> None:
    report = in_process("bench", case, "--quick", "--json").report
    rows = report["cases"][case]
    assert rows
    assert all(row["minimum"] <= row["median"] <= row["maximum"] for row in rows)
    if case == "paper-a":
        assert all("the same on any threads" in row["note"] for row in rows)


def test_a_window_is_measured_in_chromium(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPRINGFORM_STUDIO", str(ROOT / "studio"))
    rows = in_process("bench", "studio", "--quick", "--json").report["cases"]["studio"]
    found = {(row["net"].split(",")[0], row["engine"], row["figure"]): row for row in rows}
    parts = [engine for net, engine, figure in found if figure == "ms, 95 %"]
    assert len(parts) == 6
    late = found["three-cylinders", "page", "ms to new positions, 95 %"]
    for engine in ("page: pointer to request", "engine: step", "page: decode and apply"):
        part = found["three-cylinders", engine, "ms, 95 %"]
        assert part["springs"] == late["springs"]
        assert part["maximum"] > 0
    assert found["cylinder", "page", "ms to select by a lasso"]["median"] > 0
    assert found["canopy", "page", "elements at most"]["maximum"] < 500


def test_without_chromium_there_is_one_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("SPRINGFORM_STUDIO", str(ROOT / "studio"))
    monkeypatch.setenv("CHROMIUM", str(tmp_path / "no-chromium"))
    assert_refused(in_process("bench", "studio", "--quick"), "Chromium", "no-chromium")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert_refused(in_process("bench", "studio", "--quick"), "Node.js")


def test_words_are_printed_without_json() -> None:
    result = in_process("bench", "stream", "--quick")
    assert result.code == 0
    assert "generations/s" in result.out
    assert result.out.startswith("stream: three-cylinders")


@pytest.mark.parametrize(("word", "hint"), [("individul", "individual"), ("speed", "nonlinear-2k")])
def test_unknown_cases_are_refused_before_anything_is_measured(
    folder: Path, word: str, hint: str
) -> None:
    result = assert_untouched(folder, lambda: in_process("bench", "growth", word, "--out", "out"))
    assert_refused(result, word, hint)


def test_groups_name_several_cases() -> None:
    assert bench.chosen(["large", "large-20k"]) == ["large-20k", "large-200k", "large-1m"]
    assert bench.chosen([]) == list(bench.GROUPS["default"])
    assert bench.chosen(["all"]) == list(bench.CASES)


def test_a_folder_that_cannot_be_made_is_refused(folder: Path) -> None:
    (folder / "out").write_text("in the way")
    assert_refused(in_process("bench", "stream", "--quick", "--out", "out"), "out")


def test_an_interrupt_leaves_whole_files_only(folder: Path) -> None:
    running = start("bench", "stream", "growth", "--quick", "--out", "out", "--json")
    out = folder / "out" / machine.slug()
    for _ in range(600):
        if (out / "stream.csv").exists():
            break
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    stdout, stderr = running.communicate(timeout=60)
    names = {path.name for path in out.iterdir()}
    if running.returncode == 0:
        assert names == {"stream.csv", "growth.csv"}
        return
    assert running.returncode == 130
    assert stdout == ""
    assert names <= {"stream.csv", "growth.csv"}
    assert "interrupted" in stderr
    assert "Traceback" not in stderr


def test_files_are_written_whole(tmp_path: Path) -> None:
    value = Spread.of([1.0, 2.0, 4.0])
    row = Row("case", "net", 3, "engine", "ms", value, note='a "note", with commas')
    path = tmp_path / "case.csv"
    write_csv([row], path, "label")
    with open(path, newline="") as file:
        (found,) = csv.DictReader(file)
    assert found["note"] == row.note
    assert found["ratio_median"] == ""
    assert [found[name] for name in ("minimum", "median", "maximum")] == ["1", "2", "4"]
    assert os.listdir(tmp_path) == ["case.csv"]


def test_without_the_reference_only_own_figures_are_given() -> None:
    result = springform("bench", "stream", "--quick", env=environment(SPRINGFORM_REFERENCE=""))
    assert result.code == 0
    assert "make bench" in result.err


# --- the guard --------------------------------------------------------------------------------


@pytest.mark.parametrize(("words", "hint"), [((), "BASE"), (("no-such-commit",), "no-such-commit")])
def test_the_guard_refuses_in_one_line(words: tuple[str, ...], hint: str) -> None:
    command = ["python3", str(ROOT / "bench" / "guard.py"), *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if "valgrind" in done.stderr:
        hint = "valgrind"
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert hint in done.stderr
