"""Quad meshes from OBJ files."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from springform import design_file, scenes
from springform.errors import DesignError
from springform.exchange.obj import design_from_obj, read_obj

CANOPY = Path(scenes.__file__).parent / "scenes" / "canopy.obj"
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


@pytest.fixture
def obj(tmp_path: Path) -> Path:
    return tmp_path / "net.obj"


@st.composite
def grids(draw: st.DrawFn) -> tuple[list[tuple[float, ...]], list[tuple[int, ...]]]:
    across, along = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    numbers = st.floats(allow_nan=False, allow_infinity=False)
    count = (across + 1) * (along + 1)
    points = st.tuples(numbers, numbers, numbers)
    vertices = draw(st.lists(points, min_size=count, max_size=count))
    faces = []
    for row in range(along):
        for column in range(across):
            first = row * (across + 1) + column
            faces.append((first, first + 1, first + across + 2, first + across + 1))
    return list(vertices), draw(st.permutations(faces))


@settings(max_examples=300, deadline=None)
@given(grids(), st.sampled_from(["{}", "{}/1", "{}//3", "{}/1/3"]), st.booleans())
def test_every_quad_mesh_is_read_back(
    tmp_path_factory: pytest.TempPathFactory,
    grid: tuple[list[tuple[float, ...]], list[tuple[int, ...]]],
    corner: str,
    relative: bool,
) -> None:
    vertices, faces = grid
    lines = ["# a mesh", "mtllib none.mtl", "o net", ""]
    lines += [f"v {x!r} {y!r}  {z!r} # a vertex" for x, y, z in vertices] + ["vn 0 0 1"]
    shift = -len(vertices) if relative else 1
    lines += ["f " + " ".join(corner.format(n + shift) for n in face) for face in faces]
    path = tmp_path_factory.mktemp("obj") / "net.obj"
    path.write_text("\r\n".join(lines))
    assert read_obj(path) == (vertices, faces)

    design = design_from_obj(path)
    corners = [anchor.vertex for anchor in design.framework.anchors]
    assert len(corners) == 4
    assert corners[0] == 0
    assert corners[-1] == len(vertices) - 1
    assert design_file.parse(design_file.dump(design, "toml"), "toml") == design


def test_anchors_are_where_the_mesh_has_them(obj: Path) -> None:
    obj.write_text(SQUARE + "f 1 2 3 4\n")
    design = design_from_obj(obj, anchors=[2, 0])
    assert design.name == "net"
    assert [(a.vertex, a.position) for a in design.framework.anchors] == [
        (2, (1.0, 1.0, 0.0)),
        (0, (0.0, 0.0, 0.0)),
    ]


def test_the_packaged_canopy_comes_from_its_obj_file() -> None:
    design = design_from_obj(CANOPY)
    scene = scenes.load_scene("canopy")
    assert design.framework == scene.framework
    assert design.framework.mesh is not None
    assert len(design.framework.mesh.faces) == 64
    assert len(design.framework.anchors) == 5
    assert {anchor.position[2] for anchor in design.framework.anchors} == {1.0, 2.8}


def test_a_continued_line_is_one_statement(obj: Path) -> None:
    obj.write_text(SQUARE + "f 1 2 \\\n3 4\n")
    assert read_obj(obj)[1] == [(0, 1, 2, 3)]
    obj.write_text(SQUARE + "f 1 2 3 4\n\nf 1 2 \\\n3 5\n")
    assert error_of(obj).line == 7


# text, line of the error, parts of the message
ERRORS: list[tuple[str, int | None, list[str]]] = [
    ("", None, ["no faces"]),
    (SQUARE, None, ["no faces"]),
    (SQUARE + "f 1 2 3\n", 5, ["face with 3 corners; springFORM needs quads: quadrangulate"]),
    (SQUARE + "v 2 2 2\nf 1 2 3 4 5\n", 6, ["face with 5 corners"]),
    (SQUARE + "f\n", 5, ["face with 0 corners"]),
    (SQUARE + "f 1 2 3 3\n", 5, ["same corner twice"]),
    (SQUARE + "f 1 2 3 -2\n", 5, ["same corner twice"]),
    (SQUARE + "f 1 2 3 4\nf 4 3 2 1\n", 6, ["face of line 5 once more"]),
    (SQUARE + "f 1 2 3 5\n", 5, ["vertex 5", "4 vertices"]),
    (SQUARE + "f 1 2 3 0\n", 5, ['vertex "0"', "from 1"]),
    (SQUARE + "f 1 2 3 -5\n", 5, ["vertex -5", "4 vertices"]),
    (SQUARE + "f 1 2 3 x\n", 5, ['"x"', "vertex numbers"]),
    (SQUARE + "f 1 2 3 4.0\n", 5, ['"4.0"', "vertex numbers"]),
    (SQUARE + "f 1 2 3 /4\n", 5, ['"/4"']),
    (SQUARE + "f 1 2 3 ²\n", 5, ['"²"']),
    (SQUARE + f"f 1 2 3 {'9' * 5000}\n", 5, ["from 1"]),
    (SQUARE + "v 5 5 5\nf 1 2 3 4\n", 5, ["vertex 5 is in no face"]),
    (SQUARE + "v 5 5\nf 1 2 3 4\n", 5, ["2 numbers", "v x y z"]),
    (SQUARE.replace("1 1 0", "1 nan 0") + "f 1 2 3 4\n", 3, ['"nan"', "finite"]),
    (SQUARE.replace("1 1 0", "1 1e999 0") + "f 1 2 3 4\n", 3, ['"1e999"', "finite"]),
    (SQUARE.replace("1 1 0", "1 1,0 0") + "f 1 2 3 4\n", 3, ['"1,0"', "not a number"]),
]


@pytest.mark.parametrize(("text", "line", "parts"), ERRORS, ids=lambda case: str(case)[-30:])
def test_errors(obj: Path, text: str, line: int | None, parts: list[str]) -> None:
    obj.write_text(text, encoding="utf-8")
    error = error_of(obj)
    assert error.line == line
    for part in parts:
        assert part in error.message


def error_of(path: Path, anchors: list[int] | None = None) -> DesignError:
    with pytest.raises(DesignError) as caught:
        design_from_obj(path, anchors)
    assert str(caught.value).startswith(str(path))
    assert str(caught.value).isprintable()
    return caught.value


def test_anchors_that_make_no_net(obj: Path) -> None:
    obj.write_text(SQUARE + "f 1 2 3 4\n")
    assert "--anchors" in error_of(obj, [1]).message
    assert "--anchors" in error_of(obj, []).message
    assert "no vertex 4" in error_of(obj, [0, 4]).message
    assert "no vertex -1" in error_of(obj, [0, -1]).message
    assert "anchored twice" in error_of(obj, [1, 1]).message

    # A closed box has no boundary, so no corners.
    box = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
    obj.write_text(box + "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n")
    error = error_of(obj)
    assert "no corner" in error.message
    assert "--anchors" in error.message
    assert len(design_from_obj(obj, [0, 7]).framework.anchors) == 2


def test_a_file_that_is_not_there(obj: Path) -> None:
    assert "no such file" in error_of(obj).message


def message_of(path: Path) -> str:
    try:
        design_from_obj(path)
    except DesignError as error:
        return str(error)
    return ""


def test_mutated_files_give_a_mesh_or_one_clear_error(obj: Path) -> None:
    random_source = random.Random(1)
    original = CANOPY.read_bytes()
    outcomes = {"mesh": 0, "error": 0}
    for _ in range(2000):
        data = bytearray(original)
        for _ in range(random_source.choice((1, 1, 2, 5))):
            place = random_source.randrange(len(data))
            if random_source.random() < 0.5:
                data[place] = random_source.randrange(256)
            else:
                del data[place : place + random_source.randrange(1, 20)]
        obj.write_bytes(data)
        message = message_of(obj)
        outcomes["error" if message else "mesh"] += 1
        assert message.isprintable()
    assert min(outcomes.values()) > 20
