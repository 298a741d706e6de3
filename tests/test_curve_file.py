"""Measured curves from CSV files: units and layouts, lines of errors, designs that name them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import springform as sf
from helpers import assert_refused, assert_untouched, in_process
from springform.curve_file import curve_in

POINTS = [[0.0, 0.0], [0.1, 1.15], [0.2, 1.92], [0.4, 2.95]]
PLAIN = "strain,force [N]\n0,0\n0.1,1.15\n0.2,1.92\n0.4,2.95\n"
DESIGN = """\
springform = 1
name = "cord"

[framework]
grid = "dia"
cylinders = [{{ name = "tube", around = 8, along = 4 }}]
anchors = [
{anchors}
]

[[springs.groups]]
curve = "{curve}"
{rest}
"""


def design(curve: str, rest: str = "rest_ratio = 0.8") -> str:
    anchors = [
        f'{{ ring = "tube.{ring}", index = {index}, position = [{x}, {y}, {z}] }},'
        for ring, z in (("start", 0.0), ("end", 2.0))
        for index, x, y in ((0, 1.0, 0.0), (2, 0.0, 1.0), (4, -1.0, 0.0), (6, 0.0, -1.0))
    ]
    return DESIGN.format(curve=curve, rest=rest, anchors="\n".join(anchors))


@pytest.mark.parametrize(
    "text",
    [
        PLAIN,
        "# a test\n\nforce [N], strain [%], time [s]\n0,0,1\n1.15,10,2\n1.92,20,3\n2.95,40,\n",
        "Strain [mm/m];Force (mN)\n0;0\n100;1150,0\n200;1920\n400;2,95e3\n",
        "\ufeffstrain [-]\tforce [kN]\r\n0.1\t0.00115\r\n0.2\t0,00192\r\n0.4\t0.00295\r\n",
    ],
)
def test_units_and_layouts(text: str, tmp_path: Path) -> None:
    path = tmp_path / "cord.csv"
    path.write_text(text, newline="")
    np.testing.assert_allclose(sf.Curve.read(path).points, POINTS, rtol=1e-14)


def test_what_a_file_holds_is_read_as_the_file() -> None:
    assert np.allclose(curve_in(PLAIN.encode(), "cord.csv"), POINTS)
    for data, problem in (
        (b"", "cord.csv: is empty"),
        (b"strain,force [N]\n0,x\n", 'cord.csv:2: the force is "x"; write a finite number'),
        (b"strain,force [N]\n\xff,1\n", "cord.csv:2: byte 0xff is not UTF-8 text"),
    ):
        with pytest.raises(sf.InputError, match=re.escape(problem)):
            curve_in(data, "cord.csv")


def test_the_origin_is_added_between_pushes_and_pulls(tmp_path: Path) -> None:
    path = tmp_path / "bar.csv"
    path.write_text("strain,force [N]\n-0.1,-5\n0.1,4\n")
    assert sf.Curve.read(path).points.tolist() == [[-0.1, -5.0], [0.0, 0.0], [0.1, 4.0]]


BROKEN: list[tuple[str, list[str]]] = [
    ("", ["cord.csv: is empty"]),
    ("0,0\n0.1,1\n", ["cord.csv:1: has no column of strain"]),
    ("strain\n0\n", ["cord.csv:1: has no column of force"]),
    ("strain,force\n0,0\n", ["cord.csv:1: force has no unit; write one of mN, N, daN, kN"]),
    ("strain,force [lbf]\n0,0\n", ['cord.csv:1: force has the unit "lbf"']),
    ("strain [N],force [N]\n0,0\n", ['cord.csv:1: strain has the unit "N"']),
    ("strain,force [N],force [N]\n", ["cord.csv:1: has two columns of force"]),
    ("strain,force [N]\n", ["cord.csv: needs two points or more"]),
    ("strain,force [N]\n0,0\n\n0.1,x\n", ['cord.csv:4: the force is "x"']),
    ("strain,force [N]\n0,0\n0.1\n", ["cord.csv:3: the force is empty"]),
    ("strain,force [N]\n0,0\nnan,1\n", ["cord.csv:3: the strain", "finite"]),
    ("# a\nstrain,force [N]\n0,0\n0.2,2\n0.1,3\n", ["cord.csv:5: the point has a strain"]),
    ("strain,force [N]\n0,0\n0.2,2\n0.3,1\n", ["cord.csv:4: the point has a force below"]),
    ("strain,force [N]\n0.2,2\n0.3,2\n", ["cord.csv:3: must end with a rise"]),
    ("strain,force [N]\n0,1\n0.3,2\n", ["cord.csv:3: must have the point"]),
]


@pytest.mark.parametrize(("text", "parts"), BROKEN)
def test_broken_files_are_refused_on_one_line(
    text: str, parts: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("cord.csv").write_text(text)
    Path("net.toml").write_text(design("cord.csv"))
    result = assert_untouched(tmp_path, lambda: in_process("solve", "net.toml"))
    assert_refused(result, *parts)
    with pytest.raises(sf.InputError):
        sf.Curve.read("cord.csv")


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    (tmp_path / "net.toml").write_text(design("lost.csv"))
    result = assert_untouched(tmp_path, lambda: in_process("solve", tmp_path / "net.toml"))
    assert_refused(result, "lost.csv", "no such file")


def test_a_file_can_only_be_named_in_a_file() -> None:
    with pytest.raises(sf.DesignError, match="only a design in a file"):
        sf.load("one-cylinder").with_springs(curve="cord.csv")


def test_the_design_finds_the_file_beside_it_and_holds_its_points_then(tmp_path: Path) -> None:
    (tmp_path / "cords").mkdir()
    (tmp_path / "cords" / "cord.csv").write_text(PLAIN)
    path = tmp_path / "net.toml"
    path.write_text(design("cords/cord.csv"))
    named = sf.load(path)
    assert [list(point) for point in named.file.springs.groups[0].curve or ()] == POINTS
    elsewhere = tmp_path / "saved.json"
    sf.save(named, elsewhere)
    (tmp_path / "cords" / "cord.csv").unlink()
    forces = sf.load(elsewhere).solve().forces
    assert forces.tobytes() == named.solve().forces.tobytes()
    assert forces.min() > 0


def test_prestress_of_a_measured_curve_is_its_force_as_drawn(tmp_path: Path) -> None:
    (tmp_path / "cord.csv").write_text(PLAIN)
    path = tmp_path / "net.toml"
    # Beyond the last test point, too.
    for prestress in (0.7, 1.92, 3.4):
        path.write_text(design("cord.csv", f"prestress = {prestress}"))
        network = sf.load(path).network()
        drawn = sf.solve(network, iterations=0)
        np.testing.assert_allclose(drawn.forces, prestress, rtol=1e-12)
        ends = network.positions[network.springs]
        bare = sf.Network(
            network.positions,
            network.springs,
            network.fixed,
            curve=sf.Curve(POINTS),
            prestress=prestress,
            sense="tension",
        )
        np.testing.assert_allclose(bare.rest_length, network.rest_length, rtol=1e-14)
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        strain = float(sf.Curve(POINTS).strain(prestress))
        np.testing.assert_allclose(network.rest_length, lengths / (1 + strain), rtol=1e-14)
        assert sf.solve(network).converged


def test_beyond_the_last_point_stiffness_stays_above_0() -> None:
    # Moler's slope at the end of these points would be 0.
    curve = sf.Curve([[0, 0], [0.1, 3.0], [0.2, 3.2]])
    beyond = np.array([0.2, 0.3, 0.7])
    np.testing.assert_allclose(np.diff(curve.force(beyond)) / np.diff(beyond), 2.0, rtol=1e-12)
    # A weight heavier than any of the test still hangs at rest.
    hung = sf.Network(
        [[0, 0, 0], [0, 0, -1.0]], [[0, 1]], [0], curve=curve, loads=[[0, 0, 0], [0, 0, -4.0]]
    )
    equilibrium = sf.solve(hung)
    assert equilibrium.converged
    assert equilibrium.strains[0] == pytest.approx(0.2 + 0.8 / 2.0, rel=1e-9)
