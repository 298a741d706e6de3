"""Commands that evolve: what they report, what each option does, when runs end."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import springform as sf
from helpers import QUICK, done, evolved, sought

pytestmark = pytest.mark.usefixtures("folder")

# --- seek --------------------------------------------------------------------------------------


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
    digests = {
        evolved(*base, *words, out="-".join(("run", *words))).digest() for words in [(), *OPTIONS]
    }
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
