"""Pictures of designs and runs: they are there, show something, and are the same every time."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import cast
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import LogNorm
from matplotlib.image import imread

from springform import plots, scenes
from springform.design import load, save
from springform.evolution import evolve
from springform.files import WriteError
from springform.plots import style
from springform.plots.generations import parent_values, spread
from springform.plots.view import View, axonometric, broadest
from springform.run import Run, open_run

DESIGN_FILES = ["net.png", "net.svg", "forces.png", "depth.png"]
RUN_FILES = [*DESIGN_FILES, "fitness.png", "pareto.png"]


def assert_shows_something(files: list[Path], folder: Path, expected: list[str]) -> None:
    assert [file.name for file in files] == expected
    assert sorted(folder.iterdir()) == sorted(files)
    for file in files:
        if file.suffix == ".svg":
            paths = ElementTree.parse(file).iter("{http://www.w3.org/2000/svg}path")
            assert sum(1 for _ in paths) > 100
            continue
        pixels = imread(file)[:, :, :3]
        inked = np.any(pixels < 0.95, axis=2)
        assert inked.mean() > 0.003, file
        # Something lies in every quarter of the paper, and nothing touches its edges.
        middle, centre = inked.shape[0] // 2, inked.shape[1] // 2
        for half in (inked[:middle], inked[middle:], inked[:, :centre], inked[:, centre:]):
            assert half.any(), file
        for edge in (inked[:3], inked[-3:], inked[:, :3], inked[:, -3:]):
            assert not edge.any(), file


@pytest.fixture(scope="module")
def evolved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "run"
    evolve(load("canopy"), out=folder, population=6, generations=4, seed=3, threads=1)
    return folder


@pytest.mark.parametrize("scene", scenes.names())
def test_every_scene_is_drawn(scene: str, tmp_path: Path) -> None:
    files = plots.plot_design(load(scene), tmp_path / "new" / "folder")
    assert_shows_something(files, tmp_path / "new" / "folder", DESIGN_FILES)


def test_same_bytes_whatever_the_settings(tmp_path: Path) -> None:
    design = load("sheet")
    first = [file.read_bytes() for file in plots.plot_design(design, tmp_path)]
    with mpl.rc_context({"font.size": 30, "lines.linewidth": 9, "axes.facecolor": "red"}):
        before = dict(mpl.rcParams)
        second = [file.read_bytes() for file in plots.plot_design(load("sheet"), tmp_path)]
        assert dict(mpl.rcParams) == before
    assert first == second


def test_every_cell_type_and_turn(tmp_path: Path) -> None:
    words = ["0", "1", "2", "3", "3@1", "4", "4@1", "5", "6", "star", "star@3"]
    cells = dict(enumerate(words))
    cells[40] = f"1({' '.join(words[:3])} 1({' '.join(words[5:9])}))"
    plain = tmp_path / "plain.toml"
    save(load("one-cylinder-quad"), plain)
    file = tmp_path / "types.toml"
    lines = [f'{number} = "{word}"' for number, word in cells.items()]
    star = '[cell_types.star]\nsprings = ["c0-x", "x-m1"]\nperimeter = true'
    file.write_text("\n".join([plain.read_text(), "[forest.cells]", *lines, star]))
    design, folder = load(file), tmp_path / "pictures"
    assert set(design.cells.types) == {*"0123456", "star"}
    assert_shows_something(plots.plot_design(design, folder), folder, DESIGN_FILES)


@pytest.mark.filterwarnings("error")
def test_any_name_is_drawn(tmp_path: Path) -> None:
    design = load("canopy").renamed("網 $x_$ <&> " + "long " * 60)
    assert_shows_something(plots.plot_design(design, tmp_path), tmp_path, DESIGN_FILES)


def test_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(WriteError, match="cannot be made"):
        plots.plot_design(load("canopy"), tmp_path / "file" / "folder")


def test_run_is_drawn_and_the_same_each_time(evolved: Path, tmp_path: Path) -> None:
    files = plots.plot_run(open_run(evolved), tmp_path)
    assert_shows_something(files, tmp_path, RUN_FILES)
    first = [file.read_bytes() for file in files]
    assert first == [file.read_bytes() for file in plots.plot_run(open_run(evolved), tmp_path)]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("undefined", ["some", "all"])
def test_run_with_undefined_individuals(evolved: Path, tmp_path: Path, undefined: str) -> None:
    run = open_run(evolved)
    rows = slice(2, None, 3) if undefined == "some" else slice(None)
    for column in ("force_differential", "suf"):
        run.table[column] = np.array(run.table[column])
        run.table[column][rows] = np.nan
    assert_shows_something(plots.plot_run(run, tmp_path), tmp_path, RUN_FILES)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("population", "generations"), [(1, 1), (2, 0)])
def test_shortest_runs(tmp_path: Path, population: int, generations: int) -> None:
    folder, out = tmp_path / "run", tmp_path / "pictures"
    evolve(load("canopy"), out=folder, population=population, generations=generations, threads=1)
    assert_shows_something(plots.plot_run(open_run(folder), out), out, RUN_FILES)
    shutil.rmtree(folder)


def test_spread_counts_only_what_is_defined() -> None:
    table = {
        "generation": np.array([1, 1, 1, 2, 2, 3], dtype=np.uint32),
        "suf": np.array([1.0, 2.0, 3.0, np.nan, 5.0, np.nan]),
        "springs": np.array([10, 20, 30, 40, 50, 0], dtype=np.uint32),
        "valid": np.array([True, True, True, True, True, False]),
    }
    medians = spread(table, "suf", 4)[2]
    np.testing.assert_array_equal(medians, [2.0, 5.0, np.nan, np.nan])
    np.testing.assert_array_equal(spread(table, "springs", 3)[2], [20, 45, np.nan])
    np.testing.assert_allclose(spread(table, "suf", 1)[:, 0], [1.1, 1.5, 2.0, 2.5, 2.9])


def test_parent_stays_without_a_winner() -> None:
    table = {
        "generation": np.array([1, 1, 2, 2, 3, 3]),
        "individual": np.array([0, 1, 0, 1, 0, 1]),
        "springs": np.array([11, 12, 13, 14, 15, 16]),
    }
    run = cast(Run, SimpleNamespace(generations=3, parents=[1, None, 0], table=table))
    np.testing.assert_array_equal(parent_values(run, "springs", 10.0), [10, 12, 12, 15])


@pytest.mark.parametrize("view", [plots.AXONOMETRIC, plots.PLAN, plots.FRONT, plots.SIDE])
def test_views_turn_without_stretching(view: View) -> None:
    axes = view.axes()
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_views_show_what_they_are_called() -> None:
    point = np.array([[1.0, 2.0, 3.0]])
    np.testing.assert_array_equal(plots.PLAN.project(point), [[1, 2, 3]])
    np.testing.assert_array_equal(plots.FRONT.project(point), [[1, 3, -2]])
    np.testing.assert_array_equal(plots.SIDE.project(point), [[2, 3, 1]])
    box = np.array([[0.0, 0.0, 0.0], [4.0, 1.0, 2.0]])
    assert broadest(box) == plots.FRONT
    assert axonometric(box, np.array([[0, 1]], dtype=np.uint32)).name == "axonometric"


def test_scale_of_forces() -> None:
    assert not isinstance(style.force_norm(np.array([1.0, 4.9])), LogNorm)
    assert isinstance(style.force_norm(np.array([1.0, 5.1])), LogNorm)
    slack = style.force_norm(np.array([-0.1, 0.0, 1e-16, 0.5, 8.0, np.nan]))
    assert style.ends(slack) == (0.5, 8.0)
    same = style.force_norm(np.array([2.0, 2.0]))
    assert style.ends(same) == (1.0, 3.0)
    for nothing in (np.zeros(3), np.array([])):
        low, high = style.ends(style.force_norm(nothing))
        assert low < high


def test_net_in_a_figure_of_ones_own() -> None:
    design = load("canopy")
    equilibrium = design.solve()
    axes = style.add_axes(style.new_figure(4, 4), 0, 0, 4, 4)
    axes.set_xlim(-7, 7)
    axes.set_ylim(-7, 7)
    colours = plots.draw_net(axes, design, equilibrium, view=plots.PLAN)
    assert axes.get_xlim() == (-7, 7)
    assert colours.norm.vmax == pytest.approx(equilibrium.forces.max())
    assert {text.get_text() for text in axes.texts} == set(design.anchor_names)


def test_plain_numbers() -> None:
    numbers = [0.0, 0.153167, 5.384, 10.0, 1234.5, 1e-7, 2.5e9, np.nan]
    shown = ["0", "0.153", "5.38", "10", "1,234", "1e-07", "2.5e+09", "undefined"]
    assert [style.plain(number) for number in numbers] == shown
