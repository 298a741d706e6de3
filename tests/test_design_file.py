"""The design file: round trips, clear errors, and no traceback whatever the file holds."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from springform import design_file, scenes
from springform.design_schema import BUILT_IN_CELL_TYPES
from springform.errors import DesignError
from springform.key_lines import Format, line_of_key

FORMATS: tuple[Format, ...] = ("toml", "json")


# --- random valid designs ----------------------------------------------------------------------

NAMES = st.text("abyz019_", min_size=0, max_size=6).map("n{}".format) | st.sampled_from("abcxyz")
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=30)
TITLES = TEXTS.filter(lambda text: bool(text.strip()) and text.isprintable())
FLOATS = st.floats(allow_nan=False, allow_infinity=False)
POINTS = st.lists(FLOATS, min_size=3, max_size=3)
FACTORS = st.floats(min_value=0, exclude_min=True, allow_infinity=False)
NUMBERS = st.integers(0, 300)
NODES = (
    NUMBERS.map("v{}".format)
    | st.builds("e{}:{}/{}".format, NUMBERS, NUMBERS, NUMBERS)
    | st.builds("f{}:{}/{},{}/{}".format, NUMBERS, NUMBERS, NUMBERS, NUMBERS, NUMBERS)
)
PAIRS = st.lists(NODES, min_size=2, max_size=2, unique=True).map(" ".join)
CELL_POINTS = ("c0", "c1", "c2", "c3", "m0", "m1", "m2", "m3", "x")
CELL_SPRINGS = [f"{a}-{b}" for n, a in enumerate(CELL_POINTS) for b in CELL_POINTS[:n]]


@st.composite
def frameworks(draw: st.DrawFn) -> dict[str, Any]:
    grid = draw(st.sampled_from(["quad", "dia"]))
    step = 2 if grid == "dia" else 1
    names = draw(st.lists(NAMES, min_size=1, max_size=5, unique=True))
    cylinders, sheets = [], []
    rings: dict[str, tuple[int, bool]] = {}
    for name in names:
        width, along = draw(st.integers(3, 12)), draw(st.integers(1, 8)) * step
        if draw(st.booleans()):
            cylinders.append({"name": name, "around": width, "along": along})
            rings |= {f"{name}.{side}": (width, True) for side in ("start", "end")}
        else:
            sheets.append({"name": name, "across": width, "along": along})
            rings |= {f"{name}.{side}": (width, False) for side in ("start", "end")}
            rings |= {f"{name}.{side}": (along // step, False) for side in ("left", "right")}

    joins = []
    for first, second in draw(
        st.lists(st.tuples(*[st.sampled_from(sorted(rings))] * 2), max_size=4)
    ):
        if first == second:
            continue
        length = draw(st.integers(1, min(rings[first][0], rings[second][0])))
        join: dict[str, Any] = {}
        for side, ring in (("first", first), ("second", second)):
            edges, closed = rings[ring]
            start = draw(st.integers(0, edges - 1 if closed else edges - length))
            join[side] = {"ring": ring, "start": start, "length": length}
        for key in ("reversed", "cord"):
            if draw(st.booleans()):
                join[key] = draw(st.booleans())
        joins.append(join)

    # Sides share their ends with start and end; two anchors must not meet there.
    places = [
        {"ring": ring, "index": index}
        for ring, (edges, _) in rings.items()
        for index in (range(1, edges) if ring.endswith(("left", "right")) else range(edges))
    ] + [{"vertex": number} for number in range(6)]
    anchors = draw(st.lists(st.sampled_from(places), min_size=2, max_size=6, unique_by=str))
    framework = {
        "grid": grid,
        "level": draw(st.integers(0, 3)),
        "cylinders": cylinders,
        "sheets": sheets,
        "joins": joins,
        "anchors": draw(positioned(anchors)),
    }
    return {key: value for key, value in framework.items() if value or draw(st.booleans())}


@st.composite
def meshes(draw: st.DrawFn) -> dict[str, Any]:
    numbers = st.integers(0, 15)
    faces = draw(
        st.lists(st.lists(numbers, min_size=4, max_size=4, unique=True), min_size=1, max_size=6)
    )
    used = sorted({number for face in faces for number in face})
    faces = [[used.index(number) for number in face] for face in faces]
    vertices = draw(st.lists(POINTS, min_size=len(used), max_size=len(used)))
    anchored = draw(st.lists(st.integers(0, len(used) - 1), min_size=2, max_size=4, unique=True))
    return {
        "level": draw(st.integers(0, 3)),
        "anchors": draw(positioned([{"vertex": number} for number in anchored])),
        "mesh": {"vertices": vertices, "faces": faces},
    }


@st.composite
def positioned(draw: st.DrawFn, places: list[dict[str, Any]]) -> list[dict[str, Any]]:
    anchors = [place | {"position": draw(POINTS)} for place in places]
    if draw(st.booleans()):
        names = st.lists(TITLES, min_size=len(places), max_size=len(places), unique=True)
        anchors = [a | {"name": n} for a, n in zip(anchors, draw(names), strict=True)]
    return anchors


@st.composite
def designs(draw: st.DrawFn) -> dict[str, Any]:
    own_names = NAMES.filter(lambda name: name not in BUILT_IN_CELL_TYPES)
    cell_type = st.fixed_dictionaries(
        {},
        optional={
            "springs": st.lists(st.sampled_from(CELL_SPRINGS), max_size=20, unique=True),
            "perimeter": st.booleans(),
            "fan": st.booleans(),
        },
    )
    cell_types = draw(st.dictionaries(own_names, cell_type, max_size=3))
    types: st.SearchStrategy[int | str] = st.integers(0, 6)
    if cell_types:
        types |= st.sampled_from(sorted(cell_types))
    cells = st.dictionaries(st.integers(0, 2**32 - 1).map(str), TEXTS, max_size=5)
    sections: dict[str, st.SearchStrategy[Any]] = {
        "name": TITLES,
        "description": TEXTS,
        "method": st.sampled_from(["recursive", "extensible", "dynamic"]),
        "forest": st.fixed_dictionaries({}, optional={"type": types, "cells": cells}),
        "cell_types": st.just(cell_types),
        "springs": st.fixed_dictionaries(
            {}, optional={"stiffness": FACTORS | st.integers(1, 10**30), "ring_factor": FACTORS}
        ),
        "overrides": st.fixed_dictionaries(
            {}, optional={"added": st.lists(PAIRS, max_size=12), "cut": st.lists(PAIRS, max_size=3)}
        ),
    }
    required = {"springform": st.just(1), "framework": frameworks() | meshes()}
    if cell_types:
        required["cell_types"] = sections.pop("cell_types")
    return draw(st.fixed_dictionaries(required, optional=sections))


@settings(max_examples=1000, deadline=None)
@given(designs())
def test_saving_is_canonical_and_loses_nothing(data: dict[str, Any]) -> None:
    design = design_file.from_data(data)
    texts = {}
    for format in FORMATS:
        texts[format] = design_file.dump(design, format)
        again = design_file.parse(texts[format], format)
        assert again == design
        assert design_file.dump(again, format) == texts[format]
    # The two formats say the same, down to the sign of a zero.
    assert repr(tomllib.loads(texts["toml"])) == repr(json.loads(texts["json"]))
    assert design_file.parse(json.dumps(data), "json") == design


@settings(max_examples=60, deadline=None)
@given(designs())
def test_every_leaf_of_a_saved_design_is_found_on_its_line(data: dict[str, Any]) -> None:
    design = design_file.from_data(data)
    for format in FORMATS:
        text = design_file.dump(design, format)
        lines = text.split("\n")
        for path, value in leaves(json.loads(design_file.dump(design, "json"))):
            line = line_of_key(text, path, format)
            assert line is not None
            shown = json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
            assert shown in lines[line - 1]


def leaves(value: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[Any, Any]]:
    if isinstance(value, dict) and value:
        for key, item in value.items():
            yield from leaves(item, (*path, key))
    elif isinstance(value, list) and value:
        for number, item in enumerate(value):
            yield from leaves(item, (*path, number))
    elif not isinstance(value, (dict, list)):
        yield path, value


# Every number is the line it stands on; what begins with # or stands in quotes is bait.
NUMBERED_TOML = """# comment [not.a.table]
a = 2
b.c = 3
"b".'d' . e = 4 # = 5
f = '''
x = 1
''' # '
g = { h = 8, i.j = 8, k = { l = [8, 8] } }
m = [
  10, [ 10,
  11 ], # ], 13
  { n = 12, o = "]" }, 12,
]
[p.q]
r = 15
[[p.s]]
t = 17
[p.s.u]
v = 19
[[p.s]]
[[p.s.w]]
x = 22
[[p.s.w]]
x = [[24, 24],
     [25]]
'y.z' = 26
time = 07:32:00
k = '''
"'''
l = 30
"""
NUMBERED_JSON = """
{"a": 2, "b": {"c": 2,
 "d": [3, [3,
  4], {"e": 4,
  "f": {"g, ]": 5}}], "h\\"": "}",
 "i\\u0041": 6},
"j": [
  [], {}, 8, [[8,
9], 9]]}
"""


@pytest.mark.parametrize(("text", "format"), [(NUMBERED_TOML, "toml"), (NUMBERED_JSON, "json")])
def test_lines_of_keys(text: str, format: Format) -> None:
    data = tomllib.loads(text) if format == "toml" else json.loads(text)
    found = [(path, value) for path, value in leaves(data) if isinstance(value, int)]
    assert len(found) > 8
    for path, value in found:
        assert line_of_key(text, path, format) == value, path


def test_a_missing_key_is_placed_on_the_nearest_table() -> None:
    assert line_of_key(NUMBERED_TOML, ("p", "s", 1, "w", 0, "none", 3), "toml") == 21
    assert line_of_key(NUMBERED_TOML, ("none",), "toml") is None


# --- scenes ------------------------------------------------------------------------------------


def test_the_scenes_are_all_there() -> None:
    assert scenes.names() == [
        "canopy",
        "hung-in-rods",
        "one-cylinder",
        "one-cylinder-quad",
        "ring-of-six",
        "sheet",
        "three-cylinders",
        "three-cylinders-dense",
        "three-cylinders-dense-quad",
        "three-cylinders-elastic",
        "three-cylinders-quad",
    ]


@pytest.mark.parametrize("name", scenes.names())
def test_scenes_are_canonical_files(name: str, tmp_path: Path) -> None:
    design = scenes.load_scene(name)
    assert design.name == name
    assert design.description
    assert design.method == "dynamic"
    path = tmp_path / "copy.toml"
    design_file.save(design, path)
    assert path.read_bytes() == (Path(scenes.__file__).parent / f"scenes/{name}.toml").read_bytes()
    assert scenes.find(str(path)) == design
    design_file.save(design, tmp_path / "copy.json")
    assert scenes.find(tmp_path / "copy.json") == design


def test_a_scene_that_is_not_there() -> None:
    with pytest.raises(DesignError) as caught:
        scenes.find("three-cylinder")
    assert "did you mean three-cylinders?" in str(caught.value)
    assert all(name in str(caught.value) for name in scenes.names())
    with pytest.raises(DesignError, match="no such file"):
        scenes.find("nowhere/net.toml")


def test_cells_are_counted_before_joining() -> None:
    assert scenes.load_scene("one-cylinder").framework.cell_count() == 16 * 9
    assert scenes.load_scene("one-cylinder-quad").framework.cell_count() == 16 * 8
    assert scenes.load_scene("canopy").framework.cell_count() == 64
    # One whole diamond, with a half one on its left and right; two halves at start and at end.
    held = [{"ring": "patch.start", "index": n, "position": [n, 0, 0]} for n in (0, 1)]
    sheet = {"name": "patch", "across": 2, "along": 2}
    framework = {"grid": "dia", "sheets": [sheet], "anchors": held}
    assert (
        design_file.from_data({"springform": 1, "framework": framework}).framework.cell_count() == 7
    )


# --- schema ------------------------------------------------------------------------------------


def test_the_schema_describes_every_key() -> None:
    schema = design_file.json_schema()
    json.dumps(schema)
    for name, section in [("DesignFile", schema), *schema["$defs"].items()]:
        assert section["additionalProperties"] is False, name
        for key, value in section["properties"].items():
            assert value.get("description"), f"{name}.{key}"
