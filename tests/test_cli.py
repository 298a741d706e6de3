"""The commands as scripts see them: what they print, which keys, which files, which exit code."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import springform as sf
from helpers import QUICK, Result, in_process, springform
from springform import scenes

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


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder in which the commands run."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def done(*words: str | Path) -> Result:
    """Run a command that must end well."""
    result = in_process(*words)
    assert result.code == 0, result
    return result


def evolved(*words: str, out: str = "run", scene: str = "one-cylinder") -> sf.Run:
    """Evolve a little from the command line."""
    done("evolve", scene, "--out", out, *QUICK, *words)
    return sf.open_run(out)


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


# --- seek --------------------------------------------------------------------------------------


def sought(*words: str, scene: str = "one-cylinder", out: str = "out.toml") -> dict[str, Any]:
    return done("seek", scene, "--out", out, "--json", *words).report


def test_seek_divides_the_cell_of_highest_inner_force() -> None:
    report = sought("--steps", "1", "--type", "2")
    start = sf.load("one-cylinder")
    forces = start.inner_forces(start.solve())
    refined = sf.load("out.toml")
    expected = start.cells.addresses[int(np.argmax(forces))]
    assert refined.to_file().forest.cells == {int(expected): "1(2 2 2 2)"}
    measures = refined.measure(refined.solve())
    assert report["springs"] == measures.springs
    assert report["force_differential"] == measures.force_differential
    before = start.measure(start.solve())
    assert before.force_differential is not None
    assert measures.force_differential is not None
    rise = measures.force_differential - before.force_differential
    assert report["suf"] == pytest.approx(rise / (measures.springs - before.springs))


@pytest.mark.parametrize(
    ("method", "kind"), [("recursive", "1"), ("extensible", "5"), ("dynamic", "6")]
)
def test_seek_takes_methods_and_types(method: str, kind: str) -> None:
    report = sought("--steps", "5", "--type", kind, "--method", method)
    design = sf.load("out.toml")
    assert design.to_file().method == method
    assert report["steps"] == 5
    assert design.measure(design.solve()).springs == report["springs"]


def test_seek_ends_at_its_conditions() -> None:
    start = sf.load("one-cylinder")
    limit = 12.0
    report = sought("--steps", "200", "--type", "2", "--until-differential", str(limit))
    assert report["steps"] < 200
    assert report["force_differential"] >= limit
    steps = list(sf.seek(start, steps=report["steps"], type=2))
    assert all(step.force_differential < limit for step in steps[:-1])
    suf = steps[-1].suf
    assert suf is not None
    ended = sought("--steps", "200", "--type", "2", "--until-suf", str(suf))
    assert ended["steps"] <= report["steps"]
    assert ended["suf"] <= suf


# --- evolve ------------------------------------------------------------------------------------


def test_evolve_reports_what_the_run_holds() -> None:
    report = done("evolve", "sheet", "--out", "run", *QUICK, "--json").report
    run = sf.open_run("run")
    assert report["generations"] == run.generations == 4
    assert report["individuals"] == len(run.table["springs"]) == 24
    assert report["start"] == run.start
    assert report["best"] == run.final
    assert report["lowest"] == run.lowest_standing
    assert report["digest"] == run.digest()
    assert run.folder == Path("run")


def test_the_command_and_the_api_make_the_same_run() -> None:
    words = ("--types", "1,6", "--weighting", "linear", "--insertions", "5%", "--seed", "9")
    run = evolved(*words, "--method", "dynamic")
    same = sf.evolve(
        sf.load("one-cylinder"),
        population=6,
        generations=4,
        types=(1, 6),
        weighting="linear",
        insertions="5%",
        seed=9,
    )
    assert same.digest() == run.digest()
    assert same.parameters == run.parameters


def test_defaults_are_those_of_the_help() -> None:
    defaults = sf.Parameters().model_dump()
    text = " ".join(re.sub(r"[│╭╮╰╯─]", " ", done("evolve", "--help").out).split())
    stated = dict(re.findall(r"--([a-z-]+) (?:(?!--).)*?\[([a-z0-9]+)\]", text))
    # Types depend on the method; switches are off; genes and weights of cells are given.
    named = {name for name, value in defaults.items() if value is not None} - {
        "types",
        "self_adapt",
        "genes",
        "symmetry",
        "cell_weights",
    }
    for name in named:
        assert stated[name.replace("_", "-")] == str(defaults[name]).removesuffix(".0"), name


OPTIONS: list[tuple[str, ...]] = [
    ("--seed", "2"),
    ("--types", "1"),
    ("--types", "2,3,4,5"),
    ("--method", "recursive"),
    ("--method", "extensible"),
    ("--weighting", "unweighted"),
    ("--weighting", "linear"),
    ("--weighting", "deep"),
    ("--weighting", "stress"),
    ("--weight-base", "50"),
    ("--weighting", "stress", "--weight-exponent", "9"),
    ("--insertions", "5%"),
    ("--insertions", "0"),
    ("--switches", "10%"),
    ("--switches", "0"),
    ("--toggles", "50%"),
    ("--toggles", "0"),
    ("--fitness", "differential"),
    ("--suf-reference", "parent"),
    ("--suf-reference", "zero"),
    ("--niche", "2"),
    ("--self-adapt",),
    ("--min-length", "0.2"),
    ("--selection", "plus"),
]


def test_every_option_has_an_effect() -> None:
    base = ("--population", "12", "--generations", "8", "--switches", "2", "--toggles", "2")
    digests = {evolved(*base, *words, out="-".join(words)).digest() for words in [(), *OPTIONS]}
    assert len(digests) == len(OPTIONS) + 1


def test_methods_use_their_own_types_unless_told() -> None:
    kinds = {"recursive": {"1"}, "extensible": set("12345"), "dynamic": {"1", "6"}}
    for method, expected in kinds.items():
        run = evolved("--method", method, "--insertions", "20%", out=method)
        assert set(run.best.cells.types) == expected
        assert run.design.to_file().method == method


def test_given_types_are_drawn_and_others_are_not() -> None:
    run = evolved("--types", "3, 5", "--insertions", "20%")
    assert {kind.partition("@")[0] for kind in run.best.cells.types} == {"1", "3", "5"}


def test_amounts_are_counts_or_shares() -> None:
    nothing = ("--switches", "0", "--toggles", "0", "--generations", "1")
    cells = len(sf.load("one-cylinder").cells.addresses)
    for amount, number in (("7", 7), ("5%", -(-cells * 5 // 100)), ("0%", 0), ("100%", cells)):
        run = evolved("--insertions", amount, *nothing, out=amount)
        assert (run.table["edits"] == number).all()


def test_plus_keeps_a_parent_that_is_better() -> None:
    words = ("--fitness", "differential", "--generations", "12")
    comma, plus = (
        evolved(*words, "--selection", kind, out=kind).final["force_differential"]
        for kind in ("comma", "plus")
    )
    start = sf.open_run("plus").start["force_differential"]
    assert plus <= start < comma
    assert None in sf.open_run("plus").parents
    assert None not in sf.open_run("comma").parents


def test_fitness_decides_which_individual_wins() -> None:
    for fitness, column in (("differential", "force_differential"), ("suf", "suf")):
        run = evolved("--fitness", fitness, "--population", "20", out=fitness)
        table = run.table
        for generation, winner in enumerate(run.parents, start=1):
            mine = table["generation"] == generation
            rising = mine & (table["springs"] > 0)
            assert winner == int(np.nanargmin(table[column][rising]))


def test_suf_references() -> None:
    names = ("start", "parent", "zero")
    runs = {name: evolved("--suf-reference", name, out=name) for name in names}
    for name, run in runs.items():
        table, start = run.table, run.start
        for generation in (1, 2, 4):
            mine = table["generation"] == generation
            reference = {"springs": 0, "force_differential": 0.0}
            if name == "start" or (name == "parent" and generation == 1):
                reference = start
            elif name == "parent":
                parent = run.parent(generation - 1)
                measures = parent.measure(parent.solve())
                reference = vars(measures)
            added = table["springs"][mine].astype(float) - reference["springs"]
            rise = table["force_differential"][mine] - reference["force_differential"]
            defined = added > 0
            found = table["suf"][mine]
            np.testing.assert_allclose(found[defined], rise[defined] / added[defined], rtol=1e-9)
            assert np.isnan(found[~defined]).all()


def test_niche_compares_near_the_median_only() -> None:
    run = evolved("--niche", "3", "--population", "30", "--insertions", "10%")
    table = run.table
    for generation, winner in enumerate(run.parents, start=1):
        springs = table["springs"][table["generation"] == generation].astype(float)
        assert winner is not None
        assert abs(springs[winner] - np.median(springs)) <= 3.5


def test_min_length_bars_short_springs() -> None:
    limit = 0.2
    run = evolved("--min-length", str(limit), "--population", "20")
    table = run.table
    assert (table["shortest_spring"] < limit).any()
    for generation, winner in enumerate(run.parents, start=1):
        if winner is not None:
            assert table["shortest_spring"][(generation - 1) * 20 + winner] >= limit


def test_limits_on_springs_bar_nets_beyond_them() -> None:
    run = evolved("--min-springs", "290", "--max-springs", "300", "--population", "20")
    springs = run.table["springs"]
    assert ((springs < 290) | (springs > 300)).any()
    for generation, winner in enumerate(run.parents, start=1):
        if winner is not None:
            assert 290 <= springs[(generation - 1) * 20 + winner] <= 300


def test_self_adaptation_changes_the_strategy() -> None:
    def strategies(out: str) -> list[str]:
        lines = (Path(out) / "journal.jsonl").read_text().splitlines()
        return [json.dumps(json.loads(line)["strategy"]) for line in lines]

    evolved("--generations", "20", out="fixed")
    evolved("--generations", "20", "--self-adapt", "--insertions", "5%", out="adapted")
    assert len(set(strategies("fixed"))) == 1
    assert len(set(strategies("adapted"))) > 5


ENDINGS = [
    ("--until-springs", "500", "springs", lambda now: now["springs"] >= 500),
    ("--until-differential", "14", "differential", lambda now: now["force_differential"] >= 14),
    ("--until-suf", "0.05", "suf", lambda now: now["suf"] <= 0.05),
]


@pytest.mark.parametrize(("option", "limit", "reason", "reached"), ENDINGS, ids=lambda part: None)
def test_runs_end_at_their_conditions(option: str, limit: str, reason: str, reached: Any) -> None:
    run = evolved(option, limit, "--generations", "100")
    assert 0 < run.generations < 100
    assert reached(run.final)
    assert f"ended by {reason}" in (run.folder / "log.txt").read_text()
    earlier = sf.evolve(
        run.design, **(run.parameters.model_dump() | {"generations": run.generations - 1})
    )
    assert not earlier.generations or not reached(earlier.final)
    assert done("resume", "run", "--json").report["digest"] == run.digest()


def test_a_condition_that_holds_at_once_ends_at_once() -> None:
    run = evolved("--until-springs", "1")
    assert run.generations == 0
    assert done("resume", "run", "--json").report["generations"] == 0


# --- show --------------------------------------------------------------------------------------

SHOWN: dict[str, tuple[str, ...]] = {
    "default": (),
    "stress": ("--weighting", "stress"),
    "self-adaptive": ("--self-adapt", "--insertions", "5%"),
    "recursive": ("--method", "recursive", "--insertions", "8%", "--toggles", "5"),
    "extensible": ("--method", "extensible", "--weighting", "deep"),
    "parent as reference": ("--suf-reference", "parent", "--selection", "plus"),
}


@pytest.mark.parametrize("setting", SHOWN)
def test_any_individual_is_rebuilt_to_the_bit(setting: str) -> None:
    words = ("--population", "10", "--generations", "9", "--seed", "4", *SHOWN[setting])
    run = evolved(*words)
    table = run.table
    chosen = np.random.default_rng(1).choice(90, 32, replace=False)
    for row in chosen.tolist():
        generation, individual = int(table["generation"][row]), int(table["individual"][row])
        where = ("--generation", str(generation), "--individual", str(individual))
        report = done("show", "run", *where, "--out", "shown.toml", "--json").report
        design = sf.load("shown.toml")
        equilibrium = design.solve()
        measures = vars(design.measure(equilibrium)) | {"residual": equilibrium.residual}
        for name in set(measures) & set(table):
            expected = table[name][row].item()
            value = np.nan if measures[name] is None else measures[name]
            # A mutant is solved in its parent's order of elimination, a design in its own.
            if name != "residual":
                np.testing.assert_allclose(value, expected, rtol=1e-9, err_msg=f"{name} {row}")
        assert report["springs"] == measures["springs"]
        assert report["force_differential"] == pytest.approx(
            measures["force_differential"], rel=1e-9
        )
        assert design.forest == run.individual(generation, individual).forest


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
