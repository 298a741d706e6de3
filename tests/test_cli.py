"""The commands as scripts see them: what they print, which keys, which files, which exit code."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

import springform as sf
from helpers import QUICK, Result, done, evolved, in_process, sought, springform
from springform import scenes

pytestmark = pytest.mark.usefixtures("folder")

COMMANDS = ["init", "solve", "seek", "evolve", "resume", "show", "plot"]
SOLVE_KEYS = [
    *("nodes", "springs", "anchors", "cells", "force_differential", "force_min", "force_max"),
    *("force_mean", "residual", "converged", "iterations", "seconds"),
    *("method", "slack", "rods", "load_sum", "reaction_max", "reaction_max_at", "reaction_sum"),
]
RUN_KEYS = ["generations", "individuals", "seconds", "start", "best", "lowest", "digest"]
STANDING_KEYS = ["springs", "force_differential", "suf"]
SEEK_KEYS = ["steps", *STANDING_KEYS, "seconds"]
PICTURES = ["net.png", "net.svg", "forces.png", "depth.png"]
RUN_PICTURES = [*PICTURES, "fitness.png", "pareto.png"]
PURSE = """
springform = 1
name = "purse"
method = "dynamic"
[framework]
grid = "dia"
[[framework.cylinders]]
name = "a"
around = 12
along = 4
[[framework.joins]]
first = { ring = "a.end", start = 0, length = 6 }
second = { ring = "a.end", start = 6, length = 6 }
reversed = true
[[framework.anchors]]
ring = "a.start"
index = 0
position = [0.0, 0.0, 0.0]
[[framework.anchors]]
ring = "a.start"
index = 6
position = [2.0, 0.0, 0.0]
[[framework.anchors]]
ring = "a.end"
index = 0
position = [1.0, 0.0, 3.0]
"""


# --- streams and exit codes --------------------------------------------------------------------


def test_real_commands_print_one_object_and_nothing_else(folder: Path) -> None:
    out = ("--out", "run")
    shown = ("show", "run", "--generation", "2", "--individual", "3", "--out", "shown.toml")
    expected: list[tuple[tuple[str, ...], list[str]]] = [
        (("init", "sheet"), ["written"]),
        (("solve", "sheet.toml"), SOLVE_KEYS),
        (("seek", "sheet", "--steps", "3", "--type", "1", "--out", "sought.toml"), SEEK_KEYS),
        (("evolve", "sheet", *QUICK, *out), RUN_KEYS),
        (("resume", "run", "--generations", "5"), RUN_KEYS),
        (shown, STANDING_KEYS),
        (("plot", "run", "--out", "pictures"), ["pictures"]),
    ]
    for words, keys in expected:
        result = springform(*words, "--json")
        assert result.code == 0, result
        assert list(result.report) == keys
        progress = words[0] in ("seek", "evolve", "resume")
        assert result.err.count("\n") == progress, result
    report = result.report
    assert report["pictures"] == [f"pictures/{name}" for name in RUN_PICTURES]
    resumed = in_process("resume", "run", "--json").report
    for part in ("start", "best", "lowest"):
        assert list(resumed[part]) == STANDING_KEYS


def test_without_json_commands_print_words() -> None:
    result = done("solve", "sheet")
    assert [line[:20].strip().replace(" ", "_") for line in result.out.splitlines()] == SOLVE_KEYS
    assert result.err == ""
    words = done("evolve", "sheet", "--out", "run", *QUICK)
    assert "digest" in words.out
    assert "springs" in words.err


def test_progress_shows_pace_springs_and_differential() -> None:
    result = done("evolve", "sheet", "--out", "run", *QUICK, "--json")
    final = result.report["best"]
    assert re.search(r"generations .*4/4 .*/s", result.err)
    assert f"{final['springs']} springs" in result.err
    assert f"differential {final['force_differential']:.2f}" in result.err


def test_the_version() -> None:
    result = springform("--version")
    assert result == Result(0, f"springform {sf.__version__}\n", "")


def test_without_words_there_is_help() -> None:
    result = springform()
    assert result.code == 0
    assert result.err == ""
    for command in COMMANDS:
        assert command in result.out


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example_that_works(command: str, folder: Path) -> None:
    text = " ".join(re.sub(r"[│╭╮╰╯─]", " ", done(command, "--help").out).split())
    found = re.search(r"Example: springform (\S.*)$", text)
    assert found is not None, text
    evolved(out="runs/a") if command in ("resume", "show", "plot") else None
    words = found[1].split()
    if command == "show":
        words[words.index("12")] = "4"
        words[words.index("37")] = "5"
    if command == "evolve":
        words += [*QUICK]
    assert words[0] == command
    done(*words)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_is_explained(command: str) -> None:
    help_text = done(command, "--help").out
    rows = [line for line in help_text.splitlines() if re.match(r"│ \*? *--", line)]
    assert rows
    for row in rows:
        assert re.search(r"[a-z]{3}.*\s[A-Za-z]+", re.sub(r"--[a-z-]+", "", row)), row


# --- init --------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", sf.scene_names())
def test_init_writes_every_scene(scene: str, folder: Path) -> None:
    assert done("init", scene, "--json").report == {"written": f"{scene}.toml"}
    design = sf.load(f"{scene}.toml")
    assert design.to_file() == sf.load(scene).to_file()
    assert design.solve().converged
    done("init", scene, "--out", "other.json")
    assert sf.load("other.json").to_file() == design.to_file()
    sf.save(sf.load("other.json"), "again.toml")
    assert Path("again.toml").read_bytes() == Path(f"{scene}.toml").read_bytes()


def test_init_lists_the_scenes() -> None:
    assert [line.split()[0] for line in done("init").out.splitlines()] == sf.scene_names()
    assert list(done("init", "--json").report["scenes"]) == sf.scene_names()


def test_init_keeps_a_file_unless_forced(folder: Path) -> None:
    Path("sheet.toml").write_text("mine")
    assert in_process("init", "sheet").code == 2
    assert Path("sheet.toml").read_text() == "mine"
    done("init", "sheet", "--force")
    assert sf.load("sheet.toml").name == "sheet"


def grid_obj(folder: Path) -> Path:
    """A mesh of 3 x 3 quads."""
    path = folder / "grid.obj"
    vertices = [f"v {x} {y} {x * y / 9}" for y in range(4) for x in range(4)]
    corners = [4 * y + x + 1 for y in range(3) for x in range(3)]
    faces = [f"f {a} {a + 1} {a + 5} {a + 4}" for a in corners]
    path.write_text("\n".join([*vertices, *faces]) + "\n")
    return path


def test_init_takes_a_mesh(folder: Path) -> None:
    grid_obj(folder)
    done("init", "grid.obj")
    assert len(sf.load("grid.toml").anchors) == 4
    done("init", "grid.obj", "--anchors", "0, 3,13", "--out", "three.toml")
    design = sf.load("three.toml")
    assert len(design.anchors) == 3
    held = design.network().positions[design.anchors]
    assert held.tolist() == [[0, 0, 0], [3, 0, 0], [1, 3, 3 / 9]]
    assert done("solve", "three.toml", "--json").report["converged"]


# --- solve -------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", sf.scene_names())
def test_solve_reports_what_the_api_finds(scene: str) -> None:
    report = done("solve", scene, "--json").report
    assert list(report) == SOLVE_KEYS
    design = sf.load(scene)
    equilibrium = design.solve()
    measures = design.measure(equilibrium)
    del report["seconds"]
    assert report.pop("anchors") == len(design.anchors)
    for name in ("residual", "converged", "iterations", "method"):
        assert report.pop(name) == getattr(equilibrium, name)
    assert report.pop("slack") == (equilibrium.forces[: measures.springs] == 0).sum()
    assert report.pop("rods") == len(design.network().rods)
    # What holds the net and what loads it add up to nothing.
    assert report["load_sum"] == equilibrium.loads.sum(axis=0).tolist()
    outer = np.add(report.pop("load_sum"), report.pop("reaction_sum"))
    np.testing.assert_allclose(outer, 0, atol=1e-6 * measures.force_max)
    sizes = np.linalg.norm(equilibrium.reactions[design.anchors], axis=1)
    assert report.pop("reaction_max") == sizes.max()
    assert report.pop("reaction_max_at") == design.anchor_names[int(sizes.argmax())]
    assert report == {name: getattr(measures, name) for name in report}
    assert equilibrium.converged
    assert equilibrium.residual <= 1e-9


def rows(path: Path) -> list[dict[str, str]]:
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_results_can_be_read_by_other_programs(folder: Path) -> None:
    done("solve", "three-cylinders", "--out", "results")
    design = sf.load("results/design.toml")
    equilibrium = design.solve()
    nodes, springs = rows(folder / "results/nodes.csv"), rows(folder / "results/springs.csv")
    positions = np.array([[float(row[axis]) for axis in "xyz"] for row in nodes])
    np.testing.assert_array_equal(positions, equilibrium.positions)
    assert [row["key"] for row in nodes] == design.nodes
    held = {row["anchor"]: int(row["node"]) for row in nodes if row["anchor"]}
    assert held == dict(zip(design.anchor_names, design.anchors.tolist(), strict=True))
    ends = np.array([[int(row["node_a"]), int(row["node_b"])] for row in springs])
    np.testing.assert_array_equal(ends, design.network().springs)
    forces = np.array([float(row["force"]) for row in springs])
    np.testing.assert_array_equal(forces, equilibrium.forces)
    lengths = np.array([float(row["length"]) for row in springs])
    stretch = lengths - np.array([float(row["rest_length"]) for row in springs])
    np.testing.assert_allclose(
        np.array([float(row["stiffness"]) for row in springs]) * stretch, forces, rtol=1e-12
    )
    measures = json.loads((folder / "results/measures.json").read_text())
    assert measures["springs"] == len(springs)
    assert {ring["ring"] for ring in measures["apertures"]} >= {"trunk.start", "left.end"}
    lines = (folder / "results/net.obj").read_text().splitlines()
    assert sum(line.startswith("v ") for line in lines) == len(nodes)
    drawn = [[int(word) - 1 for word in line.split()[1:]] for line in lines if line[0] == "l"]
    assert drawn == ends.tolist()


@pytest.mark.parametrize("scene", ["one-cylinder", "sheet", "canopy"])
def test_both_solvers_agree(scene: str) -> None:
    sought("--steps", "5", "--type", "2", scene=scene)
    direct = done("solve", "out.toml", "--json").report
    stepped = done("solve", "out.toml", "--json", "--solver", "implicit-euler").report
    assert stepped["converged"]
    assert stepped["iterations"] > direct["iterations"]
    for name in ("force_min", "force_max", "force_mean", "force_differential"):
        assert stepped[name] == pytest.approx(direct[name], rel=1e-6)


def test_a_net_without_equilibrium_is_told_and_ends_with_1(folder: Path) -> None:
    design = sf.load("sheet").to_file()
    stiff = design.springs.model_copy(update={"stiffness": 1.7e308})
    sf.save(sf.Design(design.model_copy(update={"springs": stiff})), "stiff.toml")
    result = in_process("solve", "stiff.toml", "--json")
    assert result.code == 1
    assert result.report["converged"] is False
    assert result.err.startswith("springform: no equilibrium: ")
    assert result.err.count("\n") == 1


def test_tolerance_is_used() -> None:
    sought("--steps", "5", "--type", "2")
    words = ("solve", "out.toml", "--json", "--solver", "implicit-euler", "--tolerance")
    rough, fine = (done(*words, tolerance).report for tolerance in ("1e-3", "1e-9"))
    assert rough["iterations"] < fine["iterations"]
    assert fine["residual"] <= 1e-9 < rough["residual"] <= 1e-3


# --- plot --------------------------------------------------------------------------------------


def test_plot_draws_designs_and_runs(folder: Path) -> None:
    evolved()
    done("plot", "sheet", "--out", "deep/a")
    done("plot", "run", "--out", "b")
    assert sorted(path.name for path in (folder / "deep/a").iterdir()) == sorted(PICTURES)
    assert sorted(path.name for path in (folder / "b").iterdir()) == sorted(RUN_PICTURES)
    for path in folder.rglob("*.png"):
        assert path.read_bytes().startswith(b"\x89PNG")


def test_plot_draws_a_run_without_generations(folder: Path) -> None:
    evolved("--generations", "0")
    done("plot", "run", "--out", "a")
    assert len(list((folder / "a").iterdir())) == len(RUN_PICTURES)


def test_scenes_are_found_before_files_and_files_by_path(folder: Path) -> None:
    scenes.load_scene("sheet")
    done("init", "canopy", "--out", "own.toml")
    assert sf.load("own.toml").name == "canopy"
    Path("sheet").write_text("not a design")
    assert sf.load("sheet").name == "sheet"


def test_a_net_closed_on_itself_still_evolves(folder: Path) -> None:
    """Some springs of a purse carry next to nothing, so the start has no force differential."""
    design = folder / "purse.toml"
    design.write_text(PURSE)
    assert done("solve", design, "--json").report["force_differential"] is None
    report = done("evolve", design, "--out", "run", *QUICK, "--json").report
    assert report["best"]["force_differential"] is not None


def test_a_run_that_stands_still_says_so(folder: Path) -> None:
    words = ("--min-length", "5", "--population", "4", "--generations", "3", "--out", "run")
    result = done("evolve", "one-cylinder", *words, "--json")
    assert "the parent stayed in 3 of 3 generations" in result.err
    assert result.report["lowest"] == result.report["start"]
