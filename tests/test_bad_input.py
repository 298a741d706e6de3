"""Bad input: one clear line, exit code 2, and nothing written or lost, whatever was wrong."""
# ruff: noqa: E501 (the tables of errors keep a case a line)

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

import springform as sf
from helpers import assert_says, in_process, refused, springform

pytestmark = pytest.mark.usefixtures("folder")

NET = """\
springform = 1
name = "net"
method = "dynamic"

[framework]
grid = "dia"

[[framework.cylinders]]
name = "trunk"
around = 8
along = 2

[[framework.cylinders]]
name = "branch"
around = 8
along = 2

[[framework.joins]]
first = { ring = "trunk.end", start = 0, length = 8 }
second = { ring = "branch.start", start = 0, length = 8 }

[[framework.anchors]]
ring = "trunk.start"
index = 0
position = [1.0, 0.0, 0.0]

[[framework.anchors]]
ring = "trunk.start"
index = 4
position = [-1.0, 0.0, 0.0]

[[framework.anchors]]
ring = "branch.end"
index = 2
position = [0.0, 1.0, 2.0]

[forest]
type = 1

[forest.cells]
3 = "1(1 6 1 1)"

[cell_types.star]
springs = ["c0-x", "x-m1"]

[springs]
stiffness = 1.0
"""
SQUARE = """\
springform = 1
name = "square"

[framework]
grid = "quad"

[[framework.sheets]]
name = "patch"
across = 1
along = 1

[[framework.anchors]]
vertex = 0
position = [0.0, 0.0, 0.0]

[[framework.anchors]]
vertex = 3
position = [1.0, 1.0, 0.0]
"""
ANCHOR = '[[framework.anchors]]\nring = "trunk.start"\n'


def line_of(text: str, part: str) -> int:
    return text[: text.index(part)].count("\n") + 1


def changed(old: str, new: str, text: str = NET) -> str:
    assert old in text
    return text.replace(old, new, 1)


def only_anchors(count: int) -> str:
    """The net with its first anchors only."""
    head, *anchors = NET.partition("[forest]")[0].split("[[framework.anchors]]")
    return "[[framework.anchors]]".join([head, *anchors[:count]]) + "[forest]\ntype = 1\n"


def placed_at(number: str) -> str:
    return changed("[1.0, 0.0, 0.0]", f"[{number}, 0.0, 0.0]")


def with_cell(notation: str, number: str = "3") -> str:
    return changed('3 = "1(1 6 1 1)"', f"{number} = {json.dumps(notation)}")


def nested(depth: int) -> str:
    """A cell that is divided again and again."""
    text = "1"
    for _ in range(depth):
        text = f"1({text} 1 1 1)"
    return text


def with_group(lines: str) -> str:
    """The net with a group of springs as its last table."""
    return f"{NET}\n[[springs.groups]]\n{lines}\n"


def with_factors(lines: str) -> str:
    """The net with a table of factors as its last one."""
    return f"{NET}\n[springs.stiffness_factors]\n{lines}\n"


def with_table(name: str, lines: str) -> str:
    return f"{NET}\n[[{name}]]\n{lines}\n"


LAST = NET.count("\n") + 3
ROD = "bending_stiffness = 1.0\naxial_stiffness = 1e4"

DESIGNS: dict[str, tuple[str, list[str]]] = {
    # The text itself.
    "empty": ("", ["springform"]),
    "half a table": (NET[: NET.index("length = 8")], ["broken TOML", f"net.toml:{line_of(NET, 'first')}:"]),
    "no quotes": (changed('"dia"', "dia"), ["broken TOML", "net.toml:6:"]),
    "a table twice": (NET + "[forest]\n", ["broken TOML"]),
    "a key twice": (changed("around = 8", "around = 8\naround = 8"), ["broken TOML"]),
    "a picture": ("\x89PNG\r\n\x1a\n\0\0", ["broken TOML"]),
    "another file": ("v 0 0 0\nf 1 2 3 4\n", ["broken TOML", "net.toml:1:"]),
    # Springs, rods, loads and supports.
    "a group of nothing": (with_group('parts = ["trunk"]'), ["springs.groups[0]: says nothing", f"net.toml:{LAST - 1}:"]),
    "a group of an unknown part": (with_group('stiffness = 2.0\nparts = ["trnk"]'), ["springs.groups[0].parts[0]", "did you mean trunk?", f"net.toml:{LAST + 1}:"]),
    "a group along nothing": (with_group('stiffness = 2.0\nalong = ["trunk.left"]'), ["springs.groups[0].along[0]", "no boundary is called", f"net.toml:{LAST + 1}:"]),
    "a group of an unknown type": (with_group('stiffness = 2.0\ntypes = ["stra"]'), ["springs.groups[0].types[0]", "no cell type 'stra'", f"net.toml:{LAST + 1}:"]),
    "a group of a level too deep": (with_group("stiffness = 2.0\nlevels = [21]"), ["springs.groups[0].levels[0]: must be at most 20"]),
    "a group of no pairs": (with_group("stiffness = 2.0\npairs = []"), ["springs.groups[0].pairs: is empty"]),
    "a pair of one node": (with_group('stiffness = 2.0\npairs = ["v1"]'), ["springs.groups[0].pairs[0]", "does not name two nodes", f"net.toml:{LAST + 1}:"]),
    "a pair of lost nodes": (with_group('stiffness = 2.0\npairs = ["v1 v999"]'), ["springs.groups[0].pairs[0]", "v999", f"net.toml:{LAST + 1}:"]),
    "a factor of one node": (with_factors('"v1" = 2.0'), ["springs.stiffness_factors.v1", "does not name two nodes", f"net.toml:{LAST}:"]),
    "a factor of lost nodes": (with_factors('"v1 v999" = 2.0'), ["springs.stiffness_factors.v1 v999", "v999", f"net.toml:{LAST}:"]),
    "a factor of 0": (with_factors('"v0 v8" = 0.0'), ["springs.stiffness_factors.v0 v8: must be greater than 0", f"net.toml:{LAST}:"]),
    "a factor twice": (with_factors('"v0 v8" = 2.0\n"v8 v0" = 3.0'), ["springs.stiffness_factors.v8 v0", "same spring as v0 v8", f"net.toml:{LAST + 1}:"]),
    "two laws": (with_group("stiffness = 2.0\naxial_stiffness = 3.0"), ["springs.groups[0].axial_stiffness: cannot stand beside stiffness", f"net.toml:{LAST + 1}:"]),
    "two rest lengths": (with_group("rest_length = 2.0\nprestress = 3.0"), ["springs.groups[0].prestress: cannot stand beside rest_length"]),
    "a rest length of a force": (with_group("force = 2.0\nrest_ratio = 0.5"), ["springs.groups[0].rest_ratio: means nothing beside force"]),
    "a curve prestressed beyond reach": (with_group("prestress = -2.0\ncurve = [[0, 0], [1, 1]]"), ["springs.groups[0]", "without force"]),
    "a curve that falls": (with_group("curve = [[0, 0], [0.1, 2], [0.2, 1]]"), ["springs.groups[0].curve: point 2 has a force below", f"net.toml:{LAST}:"]),
    "a curve of numbers": (with_group("curve = [0, 1]"), ["springs.groups[0].curve[0]: must be a point"]),
    "no axial stiffness": (with_group("axial_stiffness = 0.0"), ["springs.groups[0].axial_stiffness: must be greater than 0"]),
    "no force": (with_group("force = 0.0"), ["springs.groups[0].force: must not be 0"]),
    "a negative ratio": (with_group("rest_ratio = [0.5, -1.0]"), ["springs.groups[0].rest_ratio[1]: must be a number, at least 0"]),
    "an unknown sense": (with_group('sense = "pull"'), ["springs.groups[0].sense: must be 'tension', 'both' or 'compression'"]),
    "two sections": (with_group("diameter = 0.1\narea = 0.1"), ["springs.groups[0].area: cannot stand beside a diameter"]),
    "a frozen cord": (with_group("rest_ratio = 0.5\nthermal_expansion = 1.0\ntemperature = -2.0"), ["springs.groups[0]", "shrinks to nothing"]),
    "a prestress beyond reach": (with_group("prestress = 1000.0"), ["springs.groups[0]", "without force"]),
    "a rod along nothing": (with_table("rods", f'along = "trunk.strat"\n{ROD}'), ["rods[0].along", "did you mean trunk.start?", f"net.toml:{LAST}:"]),
    "a rod without stiffness": (with_table("rods", 'along = "trunk.start"\nbending_stiffness = 1.0'), ["rods[0].axial_stiffness: is missing"]),
    "a rod along two things": (with_table("rods", f'along = "trunk.start"\nvertices = [0, 1, 2]\n{ROD}'), ["rods[0].vertices: cannot stand beside along", f"net.toml:{LAST + 1}:"]),
    "a rod without a way": (with_table("rods", ROD), ["rods[0]: runs along nothing; give along, or vertices"]),
    "a rod across cells": (with_table("rods", f"vertices = [0, 1, 9]\n{ROD}"), ["rods[0].vertices[1]: vertices 0 and 1 are not joined by an edge", f"net.toml:{LAST}:"]),
    "a rod over a vertex twice": (with_table("rods", f"vertices = [0, 8, 1, 8]\n{ROD}"), ["rods[0].vertices: has a vertex twice", f"net.toml:{LAST}:"]),
    "a rod over a lost vertex": (with_table("rods", f"vertices = [999, 0, 1]\n{ROD}"), ["rods[0].vertices[0]: there is no such vertex", f"net.toml:{LAST}:"]),
    "a rod along a rim of a cylinder": (with_table("rods", f'along = "rim.1"\n{ROD}'), ["rods[0].along: no boundary is called \"rim.1\""]),
    "a load on no node": (with_table("loads.nodes", "force = [0, 0, 1]"), ["loads.nodes[0]: must be on one node"]),
    "a load on two nodes": (with_table("loads.nodes", 'force = [0, 0, 1]\nvertex = 3\nnode = "v3"'), ["loads.nodes[0]: must be on one node"]),
    "a load on half a ring": (with_table("loads.nodes", 'force = [0, 0, 1]\nring = "trunk.start"'), ["loads.nodes[0]: has a ring or an index without the other"]),
    "a load on a lost ring node": (with_table("loads.nodes", 'force = [0, 0, 1]\nring = "trunk.start"\nindex = 8'), ["loads.nodes[0].index: 8 is out of range"]),
    "a load on a lost vertex": (with_table("loads.nodes", "force = [0, 0, 1]\nvertex = 999"), ["loads.nodes[0]", "no such vertex"]),
    "a load on a node that is not grown": (with_table("loads.nodes", 'force = [0, 0, 1]\nnode = "e0:1/4"'), ["loads.nodes[0]", "the net has no node e0:1/4"]),
    "pressure on a lost cell": (with_table("loads.pressures", 'pressure = 1.0\ncells = ["999"]'), ["loads.pressures[0].cells[0]", "no top-level cell 999", f"net.toml:{LAST + 1}:"]),
    "pressure on no cell": (with_table("loads.pressures", 'pressure = 1.0\ncells = ["x"]'), ["loads.pressures[0].cells[0]", "not a cell address"]),
    "an anchor that holds nothing": (changed("index = 4", 'index = 4\nholds = "q"'), ["framework.anchors[1].holds"]),
    "an anchor that slides nowhere": (changed("index = 4", "index = 4\nline = [0, 0, 0]"), ["framework.anchors[1].line: is no direction"]),
    "an anchor that slides and holds": (changed("index = 4", 'index = 4\nholds = "x"\nline = [0, 0, 1]'), ["framework.anchors[1].holds: cannot stand beside line or plane"]),
    # Keys and values.
    "an unknown key": (changed("stiffness =", "stifness ="), ["springs.stifness", "did you mean stiffness?", f"net.toml:{line_of(NET, 'stiffness')}:"]),
    "an unknown section": (changed("[springs]", "[spring]"), ["spring:", "did you mean springs?"]),
    "another version": (changed("springform = 1", "springform = 2"), ["format version 2"]),
    "no version": (changed("springform = 1\n", ""), ["springform: is missing"]),
    "an unknown method": (changed('"dynamic"', '"dynamc"'), ["method", "'dynamic'"]),
    "an unknown grid": (changed('"dia"', '"tri"'), ["framework.grid", "'quad' or 'dia'"]),
    "a text for a number": (changed("around = 8", 'around = "8"'), ["cylinders[0].around", "whole number", "net.toml:10:"]),
    "a fraction of a cell": (changed("around = 8", "around = 8.5"), ["cylinders[0].around", "whole number"]),
    "a negative number": (changed("along = 2", "along = -2"), ["cylinders[0].along", "at least 1"]),
    "a name twice": (changed('"branch"', '"trunk"'), ["cylinders[1].name", "used twice"]),
    # Joins.
    "joins of unequal length": (changed('"branch.start", start = 0, length = 8', '"branch.start", start = 0, length = 6'), ["joins[0].second.length", "6", "8", f"net.toml:{line_of(NET, 'second')}:"]),
    "a join longer than its ring": (NET.replace("length = 8", "length = 9"), ["joins[0].first.length", "9 is too long"]),
    "a join to no ring": (changed('"branch.start"', '"brunch.start"'), ["joins[0].second.ring", "did you mean branch.start?"]),
    "a join with itself": (changed('"branch.start"', '"trunk.end"'), ["joins[0]"]),
    # Anchors.
    "no anchor": (only_anchors(0), ["framework.anchors", "no anchor"]),
    "one anchor": (only_anchors(1), ["framework.anchors", "one anchor"]),
    "an anchor off the ring": (changed("index = 4", "index = 8"), ["anchors[1].index", "8 is out of range"]),
    "an anchor on no ring": (changed('ring = "branch.end"', 'ring = "branch.left"'), ["anchors[2].ring"]),
    "an anchor twice": (changed("index = 4", "index = 0"), ["anchors[1]", "same node"]),
    "anchors that a join puts together": (changed(ANCHOR + "index = 0", '[[framework.anchors]]\nring = "trunk.end"\nindex = 0', changed(ANCHOR + "index = 4", '[[framework.anchors]]\nring = "branch.start"\nindex = 0')), ["anchors[1]", "A1", "A2"]),
    "an anchor in two dimensions": (placed_at("1.0, 0.0"), ["anchors[0].position", "three numbers"]),
    # Numbers.
    "not a number": (placed_at("nan"), ["anchors[0].position[0]", "finite", f"net.toml:{line_of(NET, '[1.0')}:"]),
    "infinity": (placed_at("-inf"), ["anchors[0].position[0]", "finite"]),
    "too large a number": (placed_at("1" + "0" * 400), ["anchors[0].position[0]"]),
    "thousands of digits": (placed_at("1" * 5000), ["digits"]),
    "no stiffness": (changed("stiffness = 1.0", "stiffness = 0.0"), ["springs.stiffness", "greater than 0"]),
    "infinite stiffness": (changed("stiffness = 1.0", "stiffness = inf"), ["springs.stiffness", "finite"]),
    # Sizes.
    "a level deeper than the limit": (changed("[framework]", "[framework]\nlevel = 21"), ["framework.level", "at most 20"]),
    "a level with too many cells": (changed("[framework]", "[framework]\nlevel = 20"), ["framework.level", "lower the level"]),
    "too many cells": (changed("around = 8", "around = 4000000"), ["framework", "coarser"]),
    "a cell deeper than the limit": (with_cell(nested(21)), ["forest.cells.3", "20"]),
    "a cell nested without end": (with_cell("1(" * 100_000), ["forest.cells.3"]),
    # Cells.
    "a cell that is not there": (with_cell("1", "48"), ["forest.cells.48", f"net.toml:{line_of(NET, '3 = ')}:"]),
    "a cell far off": (with_cell("1", "4294967295"), ["forest.cells.4294967295"]),
    "a cell without a number": (with_cell("1", "first"), ["forest.cells.first"]),
    "a cell of no known type": (with_cell("1(1 7 1 1)"), ["forest.cells.3", "'7'"]),
    "a cell with three children": (with_cell("1(1 1 1)"), ["forest.cells.3", "column"]),
    "a cell with five children": (with_cell("1(1 1 1 1 1)"), ["forest.cells.3", "column"]),
    "a cell that does not end": (with_cell("1(1 1 1 1"), ["forest.cells.3", "column"]),
    "a cell turned too far": (with_cell("1@4"), ["forest.cells.3", "turn"]),
    "a cell in other words": (with_cell("quad(é)"), ["forest.cells.3"]),
    "an empty cell": (with_cell(""), ["forest.cells.3"]),
    # Types.
    "a type of no number": (changed("type = 1", "type = 7"), ["forest.type", "0 to 6"]),
    "a type of no name": (changed("type = 1", 'type = "stor"'), ["forest.type", "star"]),
    "a type that recursive does not allow": (changed('"dynamic"', '"recursive"'), ["forest", "recursive"]),
    "a type that extensible does not allow": (changed('"dynamic"', '"extensible"'), ["forest", "extensible"]),
    "a spring from nowhere": (changed("c0-x", "c4-x"), ["cell_types.star.springs[0]"]),
    # Overrides.
    "an override of one node": (NET + '[overrides]\ncut = ["v1"]\n', ["overrides.cut[0]", '"v1 v17"']),
    "an override of no node": (NET + '[overrides]\ncut = ["v1 v999"]\n', ["overrides.cut[0]"]),
    "an override off the edge": (NET + '[overrides]\nadded = ["v1 e0:3/2"]\n', ["overrides.added[0]"]),
    # Nothing left.
    "nothing but null cells": (changed("type = 1", "type = 0", changed('3 = "1(1 6 1 1)"', "")), ["forest"]),
    "everything cut": (SQUARE + '[overrides]\ncut = ["v0 v1", "v1 v3", "v0 v2", "v2 v3"]\n', ["anchor"]),
}  # fmt: skip


@pytest.fixture
def net(folder: Path) -> Path:
    """A valid design."""
    path = folder / "net.toml"
    path.write_text(NET)
    return path


def test_the_net_of_this_file_is_valid(net: Path) -> None:
    assert in_process("solve", net).code == 0
    assert sf.load(net).solve().converged
    (net.parent / "square.toml").write_text(SQUARE)
    assert in_process("solve", "square.toml").code == 0


# --- designs -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", DESIGNS)
def test_designs(name: str, folder: Path) -> None:
    text, parts = DESIGNS[name]
    (folder / "net.toml").write_text(text)
    line = refused("solve", "net.toml")
    assert line.startswith("springform: net.toml:")
    assert_says(line, *parts)


JSON_DESIGNS = [
    ("", ["broken JSON", "net.json:1"]),
    ("{", ["broken JSON"]),
    ('{"springform": 1,}', ["broken JSON"]),
    ("[]", ["must be a table"]),
    ("null", ["must be a table"]),
    ('{"springform": 1, "springform": 1}', ["twice"]),
    ('{"springform": NaN}', ["springform"]),
    ('{"springform": 1, "framework": {}, "froest": {}}', ["froest", "did you mean forest?"]),
    ('{"springform": 1, "framework": ' + "[" * 100_000, ["broken JSON", "nested"]),
]


@pytest.mark.parametrize(("text", "parts"), JSON_DESIGNS, ids=range(len(JSON_DESIGNS)))
def test_designs_in_json(text: str, parts: list[str], folder: Path) -> None:
    (folder / "net.json").write_text(text)
    line = refused("solve", "net.json")
    assert line.startswith("springform: net.json:")
    assert_says(line, *parts)


def test_line_100_is_no_emoji(folder: Path) -> None:
    (folder / "net.toml").write_text(NET + "#\n" * (99 - NET.count("\n")) + "100\n")
    assert ":100:" in refused("solve", "net.toml")


OUT = ("--out", "new")
COMMANDS: list[tuple[str, ...]] = [
    ("solve", "{}", "--json"),
    ("solve", "{}", *OUT),
    ("seek", "{}", "--steps", "2", "--type", "1", "--out", "new.toml"),
    ("evolve", "{}", *OUT, "--json"),
    ("plot", "{}", *OUT),
]
SUBJECTS = [
    "broken.toml",
    "missing.toml",
    "three-cylnders",
    "",
    ".",
    "mine.txt",
    "empty.toml",
    "a\nb",
]


@pytest.mark.parametrize("subject", SUBJECTS)
@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_every_command_refuses_a_bad_design(
    command: tuple[str, ...], subject: str, folder: Path
) -> None:
    (folder / "broken.toml").write_text(NET[:200])
    (folder / "empty.toml").write_text(DESIGNS["nothing but null cells"][0])
    refused(*(word.format(subject) for word in command))


def test_a_design_that_is_a_folder_or_a_device(folder: Path) -> None:
    (folder / "net.toml").mkdir()
    assert_says(refused("solve", "net.toml"), "net.toml", "folder")
    os.mkfifo(folder / "pipe.txt")
    refused("solve", "pipe.txt")
    refused("solve", "x" * 300 + ".toml")


def test_a_design_in_another_encoding(folder: Path) -> None:
    (folder / "net.toml").write_bytes(NET.replace('"net"', '"Netz für Zürich"').encode("latin-1"))
    assert_says(refused("solve", "net.toml"), "net.toml:2:", "UTF-8")


# --- meshes ------------------------------------------------------------------------------------

QUAD = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
MESHES = [
    ("", ["no faces"]),
    (QUAD, ["no faces"]),
    (QUAD + "f 1 2 3\nf 1 3 4\n", ["mesh.obj:5", "3 corners", "quad"]),
    (QUAD + "v 2 2 2\nf 1 2 3 4\n", ["mesh.obj:5", "vertex 5", "no face"]),
    (QUAD + "v 2 2 2\nf 1 2 3 4 5\n", ["mesh.obj:6", "5 corners"]),
    (QUAD + "f 1 2 3 9\n", ["mesh.obj:5", "vertex 9"]),
    (QUAD + "f 1 2 3 3\n", ["mesh.obj:5", "twice"]),
    (QUAD + "f 0 1 2 3\n", ["mesh.obj:5", "numbered from 1"]),
    (QUAD.replace("1 1 0", "1 nan 0") + "f 1 2 3 4\n", ["mesh.obj:3", "finite"]),
    (QUAD.replace("1 1 0", "1 1") + "f 1 2 3 4\n", ["mesh.obj:3"]),
    ("\x89PNG\0", ["no faces"]),
]


@pytest.mark.parametrize(("text", "parts"), MESHES, ids=range(len(MESHES)))
def test_meshes(text: str, parts: list[str], folder: Path) -> None:
    (folder / "mesh.obj").write_text(text)
    assert_says(refused("init", "mesh.obj"), "mesh.obj", *parts)


@pytest.mark.parametrize("anchors", ["", "0", "0,0", "0,9", "a,b", "0,-1", "0;1", "0,1.5"])
def test_anchors_of_meshes(anchors: str, folder: Path) -> None:
    (folder / "mesh.obj").write_text(QUAD + "f 1 2 3 4\n")
    refused("init", "mesh.obj", f"--anchors={anchors}")


def test_a_mesh_that_is_not_there() -> None:
    assert_says(refused("init", "mesh.obj"), "mesh.obj", "no such file")


# --- options -----------------------------------------------------------------------------------

EVOLVE = ("evolve", "one-cylinder", *OUT)
SEEK = ("seek", "one-cylinder", "--steps", "2", "--type", "1", "--out", "new.toml")
OPTIONS: list[tuple[tuple[str, ...], list[str]]] = [
    (("bogus",), ["bogus"]),
    (("--bogus",), ["--bogus"]),
    (("solv", "sheet"), ["solv"]),
    (("a\nb",), []),
    (("solve",), ["DESIGN"]),
    (("solve", "sheet", "canopy"), ["canopy"]),
    (("solve", "sheet", "--tolernace", "1e-9"), ["--tolernace", "--tolerance"]),
    (("solve", "sheet", "--tolerance", "tight"), ["--tolerance"]),
    (("solve", "sheet", "--tolerance", "nan"), ["--tolerance"]),
    (("solve", "sheet", "--tolerance", "0"), ["--tolerance"]),
    (("solve", "sheet", "--tolerance", "2"), ["--tolerance"]),
    (("solve", "sheet", "--solver", "magic"), ["--solver", "implicit-euler"]),
    (("solve", "sheet", "--out"), ["--out"]),
    (("init", "sheep"), ["sheep", "did you mean sheet?"]),
    (("init", "sheet", "--anchors", "1,2"), ["--anchors"]),
    (("init", "sheet", "--out", "sheet.txt"), ["sheet.txt", ".toml"]),
    (("init", "sheet", "--out", "nowhere/sheet.toml"), ["nowhere"]),
    (("init", "sheet", "--out", "mine.txt/sheet.toml"), ["mine.txt"]),
    (SEEK[:2], ["--steps"]),
    ((*SEEK[:2], "--steps", "2", "--out", "new.toml"), ["--type"]),
    (SEEK[:-2], ["--out"]),
    ((*SEEK, "--steps", "0"), ["--steps"]),
    ((*SEEK, "--steps", "-1"), ["--steps"]),
    ((*SEEK, "--steps", "many"), ["--steps"]),
    ((*SEEK, "--type", "7"), ["7"]),
    ((*SEEK, "--type", ""), []),
    ((*SEEK, "--type", "1,6"), ["1,6"]),
    ((*SEEK, "--type", "2", "--method", "recursive"), ["recursive"]),
    ((*SEEK, "--type", "6", "--method", "extensible"), ["extensible"]),
    ((*SEEK, "--method", "magic"), ["magic", "recursive"]),
    ((*SEEK, "--until-suf", "nan"), ["until_suf"]),
    ((*SEEK, "--until-differential", "inf"), ["until_differential"]),
    ((*SEEK, "--until-differential", "-2"), ["until_differential"]),
    ((*SEEK[:-1], "new.txt"), ["new.txt", ".toml"]),
    ((*SEEK[:-1], "nowhere/new.toml"), ["nowhere"]),
    (EVOLVE[:2], ["--out"]),
    ((*EVOLVE, "--population", "0"), ["population", "1"]),
    ((*EVOLVE, "--population", "-5"), ["population"]),
    ((*EVOLVE, "--population", "1e3"), ["--population"]),
    ((*EVOLVE, "--population", "1000001"), ["population", "1000000"]),
    ((*EVOLVE, "--population", "9" * 30), ["population"]),
    ((*EVOLVE, "--generations", "-1"), ["generations"]),
    ((*EVOLVE, "--generations", "9" * 30), ["generations"]),
    ((*EVOLVE, "--seed", "-1"), ["seed"]),
    ((*EVOLVE, "--seed", str(2**64)), ["seed"]),
    ((*EVOLVE, "--types", ""), ["types"]),
    ((*EVOLVE, "--types", "1,7"), ["types", "7"]),
    ((*EVOLVE, "--types", "1;6"), ["types"]),
    ((*EVOLVE, "--types", "1,2", "--method", "recursive"), ["types", "recursive"]),
    ((*EVOLVE, "--types", "6", "--method", "extensible"), ["types", "extensible"]),
    ((*EVOLVE, "--method", "magic"), ["method", "dynamic"]),
    ((*EVOLVE, "--weighting", "heavy"), ["weighting", "exponential"]),
    ((*EVOLVE, "--weight-base", "nan"), ["weight_base"]),
    ((*EVOLVE, "--weight-base", "0.5"), ["weight_base"]),
    ((*EVOLVE, "--weight-exponent", "-1"), ["weight_exponent"]),
    ((*EVOLVE, "--insertions", "-3"), ["insertions", "5%"]),
    ((*EVOLVE, "--insertions", "101%"), ["insertions", "100%"]),
    ((*EVOLVE, "--insertions", "1.5"), ["insertions"]),
    ((*EVOLVE, "--insertions", "9" * 5000), ["insertions"]),
    ((*EVOLVE, "--insertions", "nan%"), ["insertions"]),
    ((*EVOLVE, "--switches", "few"), ["switches"]),
    ((*EVOLVE, "--toggles", "1000001"), ["toggles"]),
    ((*EVOLVE, "--fitness", "beauty"), ["fitness", "differential"]),
    ((*EVOLVE, "--suf-reference", "end"), ["suf_reference", "parent"]),
    ((*EVOLVE, "--niche", "-1"), ["niche"]),
    ((*EVOLVE, "--niche", "1.5"), ["--niche"]),
    ((*EVOLVE, "--min-length", "0"), ["min_length"]),
    ((*EVOLVE, "--min-length", "nan"), ["min_length"]),
    ((*EVOLVE, "--min-springs", "0"), ["min_springs"]),
    ((*EVOLVE, "--min-springs", "9", "--max-springs", "8"), ["min_springs", "max_springs"]),
    ((*EVOLVE, "--selection", "roulette"), ["selection", "comma"]),
    ((*EVOLVE, "--until-springs", "0"), ["until_springs"]),
    ((*EVOLVE, "--until-differential", "0"), ["until_differential"]),
    ((*EVOLVE, "--until-suf", "inf"), ["until_suf"]),
    ((*EVOLVE, "--threads", "0"), ["threads"]),
    ((*EVOLVE, "--threads", "5000"), ["threads"]),
    ((*EVOLVE, "--self-adapt=yes"), ["--self-adapt"]),
    (("resume",), ["RUN"]),
    (("resume", "nowhere"), ["nowhere", "no run"]),
    (("resume", "."), ["no run"]),
    (("resume", "mine.txt"), ["mine.txt", "no run"]),
    (("resume", "x" * 300), ["no run"]),
    (("show", "nowhere", "--generation", "1", "--individual", "0", "--out", "new.toml"), ["nowhere", "no run"]),
    (("plot", "sheet"), ["--out"]),
    (("plot", "sheet", "--out", "mine.txt"), ["mine.txt"]),
    (("plot", "sheet", "--out", "mine.txt/new"), ["mine.txt"]),
]  # fmt: skip


@pytest.mark.parametrize(("words", "parts"), OPTIONS, ids=lambda case: " ".join(case)[-60:])
def test_options(words: tuple[str, ...], parts: list[str]) -> None:
    assert_says(refused(*words), *parts)


@pytest.mark.parametrize(
    "words",
    [OPTIONS[0][0], OPTIONS[6][0], (*EVOLVE, "--population", "0"), ("solve", "broken.toml")],
    ids=lambda words: words[0],
)
def test_real_processes_say_the_same(words: tuple[str, ...], folder: Path) -> None:
    (folder / "broken.toml").write_text(NET[:200])
    assert refused(*words) == refused(*words, run=springform)
