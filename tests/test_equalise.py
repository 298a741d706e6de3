"""Equalising: the evolved net's differential is halved, and a file holds the tuned stiffness."""

import csv
from pathlib import Path

import numpy as np
import pytest

import springform as sf
from helpers import assert_refused, assert_untouched, in_process


@pytest.fixture(scope="module")
def evolved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The three-cylinder net of some 2,000 springs, evolved with few mutants a generation."""
    run = sf.evolve(
        sf.load("three-cylinders"),
        population=20,
        insertions=2,
        types=(1, 6),
        seed=1,
        until_springs=2000,
        generations=200,
    )
    path = tmp_path_factory.mktemp("evolved") / "evolved.toml"
    sf.save(run.best, path)
    return path


def test_the_differential_of_an_evolved_net_is_halved(evolved: Path, tmp_path: Path) -> None:
    table = tmp_path / "springs.csv"
    report = in_process("equalise", evolved, "--bounds", "0.25,4", "--out", table, "--json").report
    differential = report["force_differential"]
    assert report["springs"] >= 1900
    assert report["converged"]
    assert differential["after"] <= differential["before"] / 2
    assert 0.25 <= report["stiffness_factor"]["min"] <= report["stiffness_factor"]["max"] <= 4

    design = sf.load(evolved)
    assert differential["before"] == pytest.approx(
        design.measure(design.solve()).force_differential
    )
    # The table alone is enough to build the tuned net.
    rows = list(csv.DictReader(table.read_text().splitlines()))
    nodes, network = design.nodes, design.network()
    assert [(row["node_a"], row["node_b"]) for row in rows] == [
        (nodes[a], nodes[b]) for a, b in network.springs.tolist()
    ]
    tuned = sf.Network(
        network.positions,
        network.springs,
        network.fixed,
        stiffness=[float(row["stiffness"]) for row in rows],
    )
    forces = sf.solve(tuned).forces
    assert forces.max() / forces.min() == pytest.approx(differential["after"], rel=1e-6)
    np.testing.assert_allclose(forces, [float(row["force"]) for row in rows], rtol=1e-6)


def test_a_few_values_are_the_only_ones(evolved: Path) -> None:
    report = in_process("equalise", evolved, "--values", "4,1,2", "--json").report
    assert set(report["springs_by_factor"]) <= {"1", "2", "4"}
    assert sum(report["springs_by_factor"].values()) == report["springs"]
    differential = report["force_differential"]
    assert differential["after"] <= differential["before"] / 1.5


@pytest.mark.parametrize("scene", ["three-cylinders", "three-cylinders-elastic", "hung-in-rods"])
@pytest.mark.parametrize("ending", ["toml", "json"])
def test_the_tuned_design_gives_the_differential_again(
    scene: str, ending: str, tmp_path: Path
) -> None:
    path = tmp_path / f"even.{ending}"
    report = in_process("equalise", scene, "--out", path, "--json").report
    solved = in_process("solve", path, "--json").report
    before, after = report["force_differential"].values()
    assert after < before
    assert report["springs"] == solved["springs"] == sf.load(scene).cords.stop
    assert solved["force_differential"] == pytest.approx(after, rel=1e-6)
    # It is a design like others: canonical, and tuned further from where it is.
    again = tmp_path / f"again.{ending}"
    sf.save(sf.load(path), again)
    assert again.read_bytes() == path.read_bytes()
    further = sf.equalise(sf.load(path), bounds=(0.9, 1.1))
    assert further.before == pytest.approx(after, rel=1e-6)
    assert further.design is not None
    tuned = further.design.solve().forces[further.cords]
    assert tuned.max() / tuned.min() == pytest.approx(further.after, rel=1e-6)


def test_links_of_rods_are_neither_tuned_nor_counted() -> None:
    design = sf.load("hung-in-rods")
    tuned = sf.equalise(design)
    links = slice(design.cords.stop, None)
    assert len(tuned.factors[links]) > 0
    assert (tuned.factors[links] == 1).all()
    forces = tuned.equilibrium.forces[design.cords]
    assert forces.max() / forces.min() == pytest.approx(tuned.after)
    bare = sf.equalise(
        sf.Network(
            [[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0], [1, -1, 0]],
            [[0, 1], [1, 2], [1, 3], [1, 4]],
            [0, 2, 3, 4],
            axial_stiffness=[1e3, 1e3, 10, 10],
            prestress=[0, 0, 1, 2],
            rods=[sf.Rod([0, 1, 2], bending_stiffness=1.0)],
        )
    )
    assert bare.cords.tolist() == [2, 3]
    assert (bare.factors[:2] == 1).all()
    assert bare.after < 1.01 < bare.before


def test_a_factor_sleeps_while_its_spring_is_gone() -> None:
    tuned = sf.equalise(sf.load("three-cylinders"), iterations=50).design
    assert tuned is not None
    stiffness = tuned.network().stiffness
    split = "0 subdivide 1 1 1 1"
    changed = tuned.edited([split])
    keys, springs = changed.nodes, changed.network().springs.tolist()
    factors = tuned.file.springs.stiffness_factors
    names = [f"{keys[a]} {keys[b]}" for a, b in springs]
    assert changed.network().stiffness.tolist() == [factors.get(name, 1.0) for name in names]
    assert set(factors) - set(names)
    back = changed.edited(changed.inverse([split]))
    assert back.network().stiffness.tobytes() == stiffness.tobytes()


@pytest.mark.parametrize("scene", ["one-cylinder", "three-cylinders"])
def test_equalising_gives_the_same_bits_again(scene: str) -> None:
    first, second = (sf.equalise(sf.load(scene), bounds=(0.5, 2)) for _ in range(2))
    assert first.factors.tobytes() == second.factors.tobytes()
    assert first.after < first.before
    assert 0.5 <= first.factors.min() <= first.factors.max() <= 2


def test_steps_are_told_and_may_be_limited() -> None:
    told: list[sf.EqualiseStep] = []
    tuned = sf.equalise(sf.load("one-cylinder"), iterations=5, on_step=told.append)
    assert [step.iterations for step in told] == [1, 2, 3, 4, 5]
    assert not tuned.converged
    assert tuned.after <= tuned.before
    as_it_is = sf.equalise(sf.load("one-cylinder"), iterations=0)
    assert as_it_is.after == as_it_is.before
    assert (as_it_is.factors == 1).all()


def test_an_interrupt_comes_through() -> None:
    def interrupt(step: sf.EqualiseStep) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sf.equalise(sf.load("one-cylinder"), on_step=interrupt)


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["--bounds", "4,1"], ["--bounds", "lower"]),
        (["--bounds", "2,4"], ["--bounds", "as it is"]),
        (["--bounds", "0,4"], ["--bounds", "above 0"]),
        (["--bounds", "nan,4"], ["--bounds", "finite"]),
        (["--bounds", "1"], ["--bounds", "two factors"]),
        (["--bounds", "a,b"], ["--bounds", "a,b"]),
        (["--values", "2,4"], ["--values", "as it is"]),
        (["--values", "1"], ["--values", "two different"]),
        (["--values", ""], ["--values"]),
        (["--values", "1,2", "--bounds", "1,2"], ["--values", "--bounds"]),
        (["--out", "x.pdf"], ["x.pdf", ".toml", ".csv"]),
        (["--out", "missing/x.csv"], ["missing"]),
    ],
)
def test_bad_options_are_refused_on_one_line(
    words: list[str], parts: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = assert_untouched(tmp_path, lambda: in_process("equalise", "one-cylinder", *words))
    assert_refused(result, *parts)
