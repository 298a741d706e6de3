"""Errors of design files: each says where, what and what to do, whatever the file holds."""
# ruff: noqa: E501 (the tables of errors keep a case a line)

from __future__ import annotations

import errno
import json
import os
import random
from pathlib import Path
from typing import Any, Literal

import pytest

from springform import design_file, scenes
from springform.design_schema import DesignFile
from springform.errors import DesignError, InputError, SpringformError
from springform.files import WriteError, write_atomically
from springform.key_lines import Format

FORMATS: tuple[Format, ...] = ("toml", "json")


# --- errors ------------------------------------------------------------------------------------


def framework_of(**changes: Any) -> dict[str, Any]:
    framework: dict[str, Any] = {
        "cylinders": [
            {"name": "trunk", "around": 8, "along": 4},
            {"name": "left", "around": 8, "along": 4},
        ],
        "anchors": [
            {"ring": "trunk.start", "index": 0, "position": [0.0, 0.0, 0.0]},
            {"ring": "trunk.start", "index": 1, "position": [1.0, 0.0, 0.0]},
        ],
    }
    return framework | changes


def join_of(first: tuple[str, int, int], second: tuple[str, int, int]) -> dict[str, Any]:
    keys = ("ring", "start", "length")
    arcs = (dict(zip(keys, arc, strict=True)) for arc in (first, second))
    return {"joins": [dict(zip(("first", "second"), arcs, strict=True))]}


def mesh_of(**changes: Any) -> dict[str, Any]:
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    anchors = [{"vertex": n, "position": vertices[n]} for n in (0, 2)]
    return {"mesh": {"vertices": vertices, "faces": [[0, 1, 2, 3]]}, "anchors": anchors} | changes


ANCHOR = {"ring": "trunk.start", "index": 0, "position": [0, 0, 0]}
SHEET = {"name": "patch", "across": 4, "along": 4}

# framework, key of the error, parts of the message
FRAMEWORK_ERRORS: list[tuple[dict[str, Any], str, list[str]]] = [
    ({}, "", ["no cylinders, sheets or mesh"]),
    (framework_of(grid="did"), "grid", ["'quad' or 'dia'", '"did"']),
    (framework_of(level=21), "level", ["at most 20", "21"]),
    (framework_of(level=-1), "level", ["at least 0"]),
    (framework_of(level=True), "level", ["whole number", "true"]),
    (framework_of(level="3"), "level", ["whole number", '"3"']),
    (framework_of(level=1.0), "level", ["whole number", "1.0"]),
    (framework_of(level=9), "level", ["16777216 cells", "4000000", "lower the level"]),
    (framework_of(cylinders=[{"name": "a", "around": 2**32 - 1, "along": 9}]), "", ["coarser"]),
    (framework_of(cylinders=[{"name": "a", "around": 10**40, "along": 9}]), "cylinders[0].around", ["at most"]),
    (framework_of(cylinders=[{"name": "a", "around": 2, "along": 9}]), "cylinders[0].around", ["at least 3"]),
    (framework_of(cylinders=[{"name": "a", "arond": 9, "along": 9}]), "cylinders[0].arond", ["unknown key", "did you mean around?"]),
    (framework_of(cylinders=[{"name": "a", "along": 9}]), "cylinders[0].around", ["is missing"]),
    (framework_of(cylinders={"name": "a"}), "cylinders", ["must be a list", "a table"]),
    (framework_of(cylinders=[3]), "cylinders[0]", ["must be a table", "3"]),
    (framework_of(cylinders=[{"name": "Trunk", "around": 4, "along": 4}]), "cylinders[0].name", ["lower-case", '"Trunk"']),
    (framework_of(cylinders=[{"name": "a\n", "around": 4, "along": 4}]), "cylinders[0].name", ["lower-case"]),
    (framework_of(sheets=[{"name": "left", "across": 4, "along": 4}]), "sheets[0].name", ["left", "twice"]),
    (framework_of(grid="dia", sheets=[SHEET | {"along": 5}]), "sheets[0].along", ["even", "5", "4 or 6"]),
    (framework_of(grid="dia", sheets=[SHEET | {"along": 1}]), "sheets[0].along", ["even", "write 2"]),
    (framework_of(**join_of(("trunk.end", 0, 4), ("left.start", 0, 3))), "joins[0].second.length", ["3", "4", "equally long"]),
    (framework_of(**join_of(("trnk.end", 0, 4), ("left.start", 0, 4))), "joins[0].first.ring", ["trnk.end", "did you mean trunk.end?"]),
    (framework_of(**join_of(("trunk.left", 0, 4), ("left.start", 0, 4))), "joins[0].first.ring", ["trunk.left"]),
    (framework_of(**join_of(("trunk.end", 8, 4), ("left.start", 0, 4))), "joins[0].first.start", ["8", "0 to 7"]),
    (framework_of(**join_of(("trunk.end", 0, 9), ("left.start", 0, 9))), "joins[0].first.length", ["9", "8 edges"]),
    (framework_of(**join_of(("trunk.end", 0, 0), ("left.start", 0, 0))), "joins[0].first.length", ["at least 1"]),
    (framework_of(**join_of(("trunk.end", 3, 4), ("trunk.end", 3, 4))), "joins[0]", ["itself"]),
    (framework_of(sheets=[SHEET], **join_of(("patch.end", 2, 3), ("left.start", 0, 3))), "joins[0].first.length", ["2 edges from 2 on"]),
    (framework_of(sheets=[SHEET], **join_of(("patch.end", 4, 1), ("left.start", 0, 1))), "joins[0].first.start", ["0 to 3"]),
    (framework_of(grid="dia", sheets=[SHEET], **join_of(("patch.left", 0, 3), ("left.start", 0, 3))), "joins[0].first.length", ["2 edges"]),
    (framework_of(anchors=[]), "anchors", ["no anchor", "two or more"]),
    (framework_of(anchors=[ANCHOR]), "anchors", ["one anchor", "two or more"]),
    (framework_of(anchors=[ANCHOR, ANCHOR]), "anchors[1]", ["same node as A1"]),
    (framework_of(anchors=[ANCHOR | {"name": "A2"}, ANCHOR | {"index": 1}]), "anchors[1].name", ["A2", "anchor 1"]),
    (framework_of(anchors=[ANCHOR | {"name": " "}]), "anchors[0].name", ["one line"]),
    (framework_of(anchors=[ANCHOR | {"index": 8}]), "anchors[0].index", ["8", "0 to 7"]),
    (framework_of(anchors=[ANCHOR | {"index": -1}]), "anchors[0].index", ["at least 0"]),
    (framework_of(anchors=[ANCHOR | {"vertex": 3}]), "anchors[0]", ["vertex and a ring"]),
    (framework_of(anchors=[{"position": [0, 0, 0]}]), "anchors[0]", ["ring and index, or vertex"]),
    (framework_of(anchors=[{"ring": "left.end", "position": [0, 0, 0]}]), "anchors[0]", ["add index"]),
    (framework_of(anchors=[ANCHOR | {"ring": "rigt.end"}]), "anchors[0].ring", ["rigt.end"]),
    (framework_of(anchors=[ANCHOR | {"position": [0, 0]}]), "anchors[0].position", ["three numbers", "a list of 2"]),
    (framework_of(anchors=[ANCHOR | {"position": [0, 0, float("nan")]}]), "anchors[0].position[2]", ["finite", "nan"]),
    (framework_of(anchors=[ANCHOR | {"position": [float("-inf"), 0, 0]}]), "anchors[0].position[0]", ["finite", "-inf"]),
    (framework_of(anchors=[ANCHOR | {"position": [0, True, 0]}]), "anchors[0].position[1]", ["a number", "true"]),
    (framework_of(anchors=[ANCHOR | {"position": [0, 10**400, 0]}]), "anchors[0].position[1]", ["too large"]),
    (framework_of(sheets=[SHEET], anchors=[ANCHOR | {"ring": "patch.right", "index": 5}]), "anchors[0].index", ["0 to 4"]),
    (framework_of(sheets=[SHEET], grid="dia", anchors=[ANCHOR | {"ring": "patch.left", "index": 3}]), "anchors[0].index", ["0 to 2"]),
    (framework_of(sheets=[SHEET], anchors=[ANCHOR | {"ring": "patch.right", "index": 4}, ANCHOR | {"ring": "patch.end", "index": 4}]), "anchors[1]", ["same node as A1"]),
    (framework_of(mesh=mesh_of()["mesh"]), "cylinders", ["beside a mesh"]),
    (mesh_of(joins=join_of(("a.end", 0, 1), ("a.end", 2, 1))["joins"]), "joins", ["beside a mesh"]),
    (mesh_of(grid="dia"), "grid", ["mesh"]),
    (mesh_of(anchors=[ANCHOR, ANCHOR]), "anchors[0].ring", ["no rings"]),
    (mesh_of(anchors=[{"vertex": 4, "position": [0, 0, 0]}]), "anchors[0].vertex", ["4", "0 to 3"]),
    (mesh_of(mesh={"vertices": [[0, 0, 0]], "faces": [[0, 1, 2, 3]]}), "mesh.faces[0][1]", ["1 is no vertex", "0 to 0"]),
    (mesh_of(mesh={"vertices": [[0, 0, 0]] * 4, "faces": [[0, 1, 2, 2]]}), "mesh.faces[0]", ["corner twice"]),
    (mesh_of(mesh={"vertices": [[0, 0, 0]] * 5, "faces": [[0, 1, 2, 3]]}), "mesh.vertices[4]", ["in no face"]),
    (mesh_of(mesh={"vertices": [[0, 0, 0]] * 4, "faces": [[0, 1, 2]]}), "mesh.faces[0]", ["four vertex numbers"]),
    (mesh_of(mesh={"vertices": [[0, 0, 0]] * 4, "faces": []}), "mesh.faces", ["is empty"]),
    (mesh_of(mesh={"vertices": [[0, 0, 0]] * 4, "faces": [[0, 1, 2, -1]]}), "mesh.faces[0][3]", ["at least 0"]),
]  # fmt: skip


@pytest.mark.parametrize(
    ("framework", "key", "parts"), FRAMEWORK_ERRORS, ids=lambda case: str(case)[:40]
)
def test_errors_in_the_framework(framework: dict[str, Any], key: str, parts: list[str]) -> None:
    text = json.dumps({"springform": 1, "framework": framework}, indent=1)
    error = error_of(text, "json")
    assert error.key == ".".join(filter(None, ("framework", key)))
    assert error.line is not None
    for part in parts:
        assert part in error.message


BASE = """springform = 1
[framework]
[[framework.cylinders]]
name = "trunk"
around = 8
along = 4
[[framework.anchors]]
ring = "trunk.start"
index = 0
position = [0, 0, 0]
[[framework.anchors]]
ring = "trunk.start"
index = 4
position = [1, 0, 0]
"""
HUGE = "9" * 5000

# text, format, line and key of the error, parts of the message
TEXT_ERRORS: list[tuple[str, Format, int | None, str | None, list[str]]] = [
    ("", "toml", None, "springform", ["is missing"]),
    ("{}", "json", None, "springform", ["is missing"]),
    ("[]", "json", None, None, ["must be a table", "a list of 0"]),
    ("3", "json", None, None, ["must be a table"]),
    ("", "json", 1, None, ["broken JSON", "column 1"]),
    ('{"springform": 1,\n}', "json", 2, None, ["broken JSON", "column 1"]),
    ('{"springform": 1,\n "springform": 1}', "json", 2, "springform", ["twice"]),
    ('{"springform": 1, "framework": {"a": 1,\n "a": 2}}', "json", 2, "a", ["twice"]),
    (BASE + "a =", "toml", 15, None, ["broken TOML", "Invalid value"]),
    (BASE + "a = = 3\n", "toml", 15, None, ["broken TOML", "column 5"]),
    (BASE + "index = 3\n", "toml", 15, None, ["broken TOML"]),
    ("a = " + "[" * 100_000, "toml", None, None, ["nested too deeply"]),
    ("[" * 100_000, "json", None, None, ["nested too deeply"]),
    ('{"a":' * 100_000, "json", None, None, ["nested too deeply"]),
    ('{"springform": 1,\n"zzz": ' + "[" * 400 + "]" * 400 + "}", "json", 2, "zzz", ["unknown key"]),
    (BASE.replace("= 8", "= " + "[" * 200 + "]" * 200), "toml", 5, "framework.cylinders[0].around", ["a list of 1"]),
    (BASE + "a." * 500 + "a = 1", "toml", 15, "framework.anchors[1].a", ["unknown key"]),
    (f"springform = {HUGE}", "toml", None, None, ["too many digits"]),
    (f'{{"springform": {HUGE}}}', "json", None, None, ["too many digits"]),
    (f"springform = 0x{HUGE}", "toml", 1, "springform", ["more than 20 digits"]),
    (BASE.replace("= 1\n", "= 2\n", 1), "toml", 1, "springform", ["version 2", "reads 1"]),
    (BASE.replace("= 1\n", "= true\n", 1), "toml", 1, "springform", ["format version", "true"]),
    (BASE.replace("= 1\n", '= "1"\n', 1), "toml", 1, "springform", ["format version", '"1"']),
    (BASE.replace("around = 8", "around = 8.0"), "toml", 5, "framework.cylinders[0].around", ["whole number, not 8.0"]),
    (BASE.replace("along = 4", "along = 2020-01-01"), "toml", 6, "framework.cylinders[0].along", ["a date"]),
    (BASE.replace("along = 4", "alon = 4"), "toml", 6, "framework.cylinders[0].alon", ["did you mean along?"]),
    (BASE.replace("along = 4\n", ""), "toml", 3, "framework.cylinders[0].along", ["is missing"]),
    (BASE.replace("[1, 0, 0]", "[1, nan, 0]"), "toml", 14, "framework.anchors[1].position[1]", ["finite"]),
    (BASE.replace("[1, 0, 0]", "[\n1,\n1e999,\n0]"), "toml", 16, "framework.anchors[1].position[1]", ["finite", "inf"]),
    (BASE.replace("index = 4", "index = 0"), "toml", 11, "framework.anchors[1]", ["same node as A1"]),
    (BASE + "[forest.cells]\n1 = '1'\n1x = '1'\n", "toml", 17, "forest.cells.1x", ["not the number of a cell"]),
    (BASE + "[forest.cells]\n01 = '1'\n", "toml", 16, "forest.cells.01", ["not the number of a cell"]),
    (BASE + "[forest.cells]\n-1 = '1'\n", "toml", 16, "forest.cells.-1", ["not the number of a cell"]),
    (BASE + "[forest.cells]\n9999999999 = '1'\n", "toml", 16, "forest.cells.9999999999", ["at most 4294967295"]),
    (BASE + "[forest.cells]\n1 = 1\n", "toml", 16, "forest.cells.1", ["a text in quotes"]),
    (BASE + "[forest]\ntype = 7\n", "toml", 16, "forest.type", ["number 7", "0 to 6"]),
    (BASE + "[forest]\ntype = true\n", "toml", 16, "forest.type", ["number or name"]),
    (BASE + "[forest]\ntype = 'str'\n[cell_types.star]", "toml", 16, "forest.type", ["did you mean star?"]),
    (BASE + "[forest]\ntype = 'str'\n", "toml", 16, "forest.type", ["there is none"]),
    (BASE + "[cell_types.star]\nsprings = ['c0-x',\n'c4-x']", "toml", 17, "cell_types.star.springs[1]", ["two points"]),
    (BASE + "[cell_types.star]\nsprings = ['c0-x',\n'x-c0']", "toml", 17, "cell_types.star.springs[1]", ["twice"]),
    (BASE + "[cell_types.star]\nsprings = ['x-x']", "toml", 16, "cell_types.star.springs[0]", ["one end"]),
    (BASE + "[cell_types.star]\nfann = true", "toml", 16, "cell_types.star.fann", ["did you mean fan?"]),
    (BASE + "[cell_types.Star]\n", "toml", 15, "cell_types.Star", ["lower-case"]),
    (BASE + "[cell_types.quad]\n", "toml", 15, "cell_types.quad", ["built-in"]),
    (BASE + "[springs]\nstiffness = 0\n", "toml", 16, "springs.stiffness", ["greater than 0"]),
    (BASE + "[springs]\nring_factor = inf\n", "toml", 16, "springs.ring_factor", ["finite"]),
    (BASE + "[overrides]\ncut = ['v1 v2',\n 'v1 w2']\n", "toml", 17, "overrides.cut[1]", ["two nodes"]),
    (BASE + "[overrides]\nadded = ['v1 v1']\n", "toml", 16, "overrides.added[0]", ["one node twice"]),
    (BASE + "[spring]\na = 1\n", "toml", 15, "spring", ["unknown key", "did you mean springs?"]),
    (BASE + "[zzz]\na = 1\n", "toml", 15, "zzz", ["unknown key", "framework"]),
    ('{"springform": 1, "name":\n "\\ud800", "framework": {}}', "json", 1, "name", ["Unicode"]),
    ('{"springform": 1,\n "\\ud800\\n\\u001b": 1}', "json", None, None, ["Unicode"]),
    ('{"springform": 1,\n "\\u001b": 1}', "json", 2, "\x1b", ["unknown key"]),
    ('{"springform": 1,\n "description": "\\ud800"}', "json", 2, "description", ["Unicode"]),
    ('{"springform": 1,\n "forest": {"cells": {\n"1": "\\ud800"}}}', "json", 3, "forest.cells.1", ["Unicode"]),
    ('{"springform": 1,\n "name": null, "framework": {}}', "json", 2, "name", ["a text in quotes, not null"]),
    ("name = ''\n" + BASE, "toml", 1, "name", ["is empty"]),
    ('name = "a\\nb"\n' + BASE, "toml", 1, "name", ["one line"]),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "format", "line", "key", "parts"), TEXT_ERRORS, ids=lambda case: str(case)[-40:]
)
def test_errors_in_texts(
    text: str, format: Format, line: int | None, key: str | None, parts: list[str]
) -> None:
    error = error_of(text, format)
    assert (error.line, error.key) == (line, key)
    for part in parts:
        assert part in error.message


def error_of(text: str, format: Format) -> DesignError:
    with pytest.raises(DesignError) as caught:
        design_file.parse(text, format, "net.file")
    shown = str(caught.value)
    assert shown.isprintable(), "one line that a terminal can show"
    assert shown.startswith("net.file")
    assert len(shown) < 300
    return caught.value


def test_one_line_says_where_what_and_what_to_do() -> None:
    text = BASE.replace("index = 4", "index = 8")
    assert str(error_of(text, "toml")) == (
        "net.file:13: framework.anchors[1].index: 8 is out of range; "
        "trunk.start has vertices 0 to 7"
    )
    assert issubclass(DesignError, InputError)
    assert issubclass(InputError, SpringformError)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    cases = {
        tmp_path / "net.txt": ".toml or .json",
        tmp_path / "none.toml": "no such file",
        tmp_path / "folder.toml": "is a folder",
        tmp_path / "bytes.toml": "not UTF-8",
        tmp_path / "nul\0.toml": "character",
    }
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "bytes.toml").write_bytes(b"springform = 1\nname = '\xff'")
    for path, part in cases.items():
        with pytest.raises(DesignError, match=part) as caught:
            design_file.load(path)
        assert str(caught.value).isprintable()
    with pytest.raises(DesignError) as caught:
        design_file.load(tmp_path / "bytes.toml")
    assert caught.value.line == 2


def test_a_byte_order_mark_and_foreign_line_ends_do_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "net.toml"
    path.write_bytes(b"\xef\xbb\xbf" + BASE.replace("\n", "\r\n").encode())
    assert design_file.load(path) == design_file.parse(BASE, "toml")


# --- writing -----------------------------------------------------------------------------------


def test_files_that_cannot_be_written(tmp_path: Path) -> None:
    design = design_file.parse(BASE, "toml")
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "file").write_text("")
    cases = {
        tmp_path / "none" / "net.toml": "does not exist",
        tmp_path / "folder.toml": "is a folder",
        tmp_path / "file" / "net.toml": "not a folder",
        tmp_path / ("n" * 300 + ".toml"): "too long",
        tmp_path / "nul\0.toml": "character",
    }
    for path, part in cases.items():
        with pytest.raises(WriteError, match=part):
            design_file.save(design, path)
    with pytest.raises(DesignError, match="rename it"):
        design_file.save(design, tmp_path / "net.yaml")
    with pytest.raises(WriteError, match="not an ordinary file"):
        write_atomically("/dev/null", b"")
    assert sorted(os.listdir(tmp_path)) == ["file", "folder.toml"]


def test_a_failed_write_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "net.toml"
    write_atomically(path, b"old")
    path.chmod(0o640)

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "no space")

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(WriteError, match="no space left"):
            write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["net.toml"]

    link = tmp_path / "link.toml"
    link.symlink_to(path)
    write_atomically(link, b"new")
    assert path.read_bytes() == b"new"
    assert link.is_symlink()
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_file_over_the_limit_is_a_clear_error(tmp_path: Path) -> None:
    resource = pytest.importorskip("resource")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(WriteError, match="larger than allowed"):
            write_atomically(tmp_path / "net.toml", bytes(100_000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert os.listdir(tmp_path) == []


# --- mutation fuzz -----------------------------------------------------------------------------

MUTATIONS = 10_000
SPLICES = [
    "nan", "-inf", "1e999", "true", "-1", "0", "[", "]", "{", "}", "[[", "]]", '"', "'''", ",", "=",
    ".", "\n", "\r", "\0", "\ud7ff", "#", "\\", "\\ud800", "99999999999999999999", "[framework]",
    "[[framework.joins]]", '"springform"', "null", "1_0", "0x", "07:32:00", "{}", "[[[[", '""',
]  # fmt: skip


def scene_text(name: str) -> str:
    return (Path(scenes.__file__).parent / "scenes" / f"{name}.toml").read_text(encoding="utf-8")


def mutated(text: str, random_source: random.Random) -> str:
    for _ in range(random_source.choice((1, 1, 1, 2, 3, 8))):
        kind = random_source.randrange(6)
        place = random_source.randrange(len(text) + 1)
        lines = text.split("\n")
        line = random_source.randrange(len(lines))
        if kind == 0:
            text = text[:place] + chr(random_source.randrange(1, 256)) + text[place + 1 :]
        elif kind == 1:
            text = text[:place] + text[place + random_source.randrange(1, 12) :]
        elif kind == 2:
            text = text[:place] + random_source.choice(SPLICES) + text[place:]
        elif kind == 3:
            text = "\n".join(lines[:line] + lines[line + 1 :])
        elif kind == 4:
            other = random_source.randrange(len(lines))
            text = "\n".join([*lines[:line], lines[other], *lines[line:]])
        else:
            text = text[:place]
    return text


def design_or_error(text: str, format: Format) -> DesignFile | DesignError:
    try:
        return design_file.parse(text, format, "net")
    except DesignError as error:
        return error


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("seed", range(4))
def test_mutated_scenes_give_a_design_or_one_clear_error(format: Format, seed: int) -> None:
    random_source = random.Random(seed)
    names = scenes.names()
    texts = [design_file.dump(scenes.load_scene(name), format) for name in names]
    # Small files oftener: what a mutation can hit is the same in all of them.
    weights = [1 / len(text) for text in texts]
    outcomes: dict[Literal["design", "error"], int] = {"design": 0, "error": 0}
    for _ in range(MUTATIONS // (4 * len(FORMATS))):
        text = mutated(random_source.choices(texts, weights)[0], random_source)
        result = design_or_error(text, format)
        if isinstance(result, DesignError):
            outcomes["error"] += 1
            assert str(result).isprintable()
            assert len(str(result)) < 600
        else:
            outcomes["design"] += 1
            assert design_file.parse(design_file.dump(result, format), format) == result
    assert min(outcomes.values()) > 20
