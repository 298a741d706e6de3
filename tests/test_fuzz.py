"""Broken and strange designs and nets: a result or one clear error, never a panic."""

from __future__ import annotations

import copy
import json
import math
import random
import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import springform as sf
from springform import design_file
from springform.canonical_text import json_text, toml_text

SEEDS = 12
MUTANTS = 900
"""Mutants a seed: more than ten thousand together."""

LARGEST = 1_500
"""Frameworks of more cells are left out for speed; refusing far too large ones is tested."""

SLOWEST = 5.0
"""Seconds that no case may take."""

NUMBERS: list[Any] = [
    *(0, 1, 2, 3, 4, 7, -1, 20, 21, 2**31, 2**32 - 1, 2**32, 2**64, 10**400),
    *(0.0, -0.0, 0.5, 1e-300, 5e-324, 1e300, -1e300, 1.7e308, math.nan, math.inf, -math.inf),
    *(True, None, "3", "", [], {}),
]
WORDS = [
    "",
    "a",
    "trunk.start",
    "left.end",
    "p.left",
    "A1",
    "quad",
    "dia",
    "1",
    "x\ny",
    "é",
    "\x1b",
]
COORDINATES = [0.0, 1.0, -2.5, 1e300, -1e300, 1e150, 1e-300, 5e-324, 1e9]

Data = dict[str, Any]


# --- valid designs -----------------------------------------------------------------------------


def ring_anchors(*rings: str, around: int) -> list[Data]:
    """Three anchors on each ring, rings above each other."""
    return [
        {
            "ring": ring,
            "index": index,
            "position": [
                2 * math.cos(2 * math.pi * index / around),
                2 * math.sin(2 * math.pi * index / around),
                float(height),
            ],
        }
        for height, ring in enumerate(rings)
        for index in range(0, around, max(around // 3, 1))
    ]


def arc(ring: str, start: int, length: int) -> Data:
    return {"ring": ring, "start": start, "length": length}


CYLINDER: Data = {
    "springform": 1,
    "name": "cylinder",
    "method": "dynamic",
    "framework": {
        "grid": "dia",
        "cylinders": [{"name": "trunk", "around": 6, "along": 3}],
        "anchors": ring_anchors("trunk.start", "trunk.end", around=6),
    },
    "forest": {"type": 1, "cells": {"0": "1(1 6 1 1)", "3": "6", "7": "1[1 1(1 1 1 1) 6@1 1]"}},
    "springs": {"stiffness": 2.0, "ring_factor": 3.0},
    "overrides": {"added": ["v0 v8"], "cut": ["v1 v2"]},
}
BRANCHING: Data = {
    "springform": 1,
    "name": "branching",
    "method": "extensible",
    "framework": {
        "grid": "quad",
        "cylinders": [{"name": n, "around": 8, "along": 2} for n in ("trunk", "left", "right")],
        "joins": [
            {"first": arc("trunk.end", 2, 4), "second": arc("left.start", 2, 4)},
            {"first": arc("trunk.end", 6, 4), "second": arc("right.start", 6, 4)},
            {
                "first": arc("left.start", 6, 4),
                "second": arc("right.start", 2, 4),
                "reversed": True,
                "cord": True,
            },
        ],
        "anchors": ring_anchors("trunk.start", "left.end", "right.end", around=8),
    },
    "forest": {"type": "star", "cells": {"5": "3@2(1 2 4 5@3)", "11": "0"}},
    "cell_types": {"star": {"springs": ["c0-x", "x-m1", "c2-x"], "perimeter": True}},
}
SHEETS: Data = {
    "springform": 1,
    "name": "sheets",
    "method": "recursive",
    "framework": {
        "grid": "quad",
        "level": 1,
        "sheets": [{"name": "p", "across": 3, "along": 4}, {"name": "q", "across": 3, "along": 2}],
        "joins": [{"first": arc("p.end", 0, 3), "second": arc("q.start", 0, 3)}],
        "anchors": [
            {"ring": "p.start", "index": 0, "position": [0.0, 0.0, 1.0]},
            {"ring": "p.start", "index": 3, "position": [3.0, 0.0, 0.0], "name": "low"},
            {"ring": "q.end", "index": 0, "position": [0.0, 6.0, 0.0]},
            {"vertex": 9, "position": [3.0, 6.0, 1.0]},
        ],
    },
    "forest": {"cells": {"4": "1(1(1 1 1 1) 1 1 1)"}},
}
RIGGED: Data = {
    "springform": 1,
    "name": "rigged",
    "method": "dynamic",
    "framework": {
        "grid": "dia",
        "cylinders": [{"name": "trunk", "around": 6, "along": 3}],
        "anchors": [
            anchor | {"holds": "xy"} if number == 1 else anchor
            for number, anchor in enumerate(ring_anchors("trunk.start", "trunk.end", around=6))
        ],
    },
    "forest": {"type": 1, "cells": {"0": "1(1 6 1 1)"}},
    "springs": {
        "stiffness": 2.0,
        "stiffness_factors": {"v0 v8": 0.5, "v9 v0": 4.0, "e3:1/2 v2": 3.0},
        "groups": [
            {"axial_stiffness": 9.8, "rest_ratio": [0.7, 0.8], "diameter": 0.0025},
            {"parts": ["trunk"], "types": [1, "6"], "levels": [1], "force_density": 3.0},
            {"along": ["ring", "trunk.end"], "force": 2.0, "self_weight": 0.1},
            {"pairs": ["v0 v8"], "curve": [[0, 0], [0.2, 3.0]], "rest_length": 0.5},
            {"levels": [0], "thermal_expansion": 1e-4, "temperature": -30.0, "sense": "both"},
        ],
    },
    "rods": [
        {"along": "trunk.start", "bending_stiffness": 2.0, "axial_stiffness": 1e4, "length": 9.0}
    ],
    "loads": {
        "nodes": [{"ring": "trunk.end", "index": 1, "force": [0, 0, -1.0]}],
        "pressures": [
            {"parts": ["trunk"], "pressure": 0.2},
            {"cells": ["3"], "levels": [0], "pressure": 0.1, "follower": True},
        ],
    },
}
MESH: Data = {
    "springform": 1,
    "name": "mesh",
    "method": "dynamic",
    "framework": {
        "mesh": {
            "vertices": [[float(x), float(y), 0.1 * x * y] for y in range(4) for x in range(4)],
            "faces": [
                [4 * y + x, 4 * y + x + 1, 4 * y + x + 5, 4 * y + x + 4]
                for y in range(3)
                for x in range(3)
            ],
        },
        "anchors": [
            {"vertex": v, "position": [float(v % 4), float(v // 4), v / 10]} for v in (0, 3, 12, 15)
        ],
    },
    "forest": {"type": 6, "cells": {"4": "2(1 6 6 1)"}},
    "overrides": {"added": ["v0 f4:1/2,1/2"], "cut": []},
}
DESIGNS = [CYLINDER, BRANCHING, SHEETS, MESH, RIGGED]


# --- mutations that know the structure ---------------------------------------------------------


def places(node: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of everything in nested tables and lists."""
    inner = node.items() if isinstance(node, dict) else enumerate(node)
    for key, value in inner:
        yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from places(value, (*path, key))


def parent_of(data: Data, path: tuple[Any, ...]) -> Any:
    node: Any = data
    for key in path[:-1]:
        node = node[key]
    return node


def replace_one(data: Data, draw: random.Random) -> None:
    path = draw.choice(list(places(data)))
    parent_of(data, path)[path[-1]] = draw.choice(NUMBERS + WORDS)


def delete_one(data: Data, draw: random.Random) -> None:
    path = draw.choice(list(places(data)))
    del parent_of(data, path)[path[-1]]


def swap_two(data: Data, draw: random.Random) -> None:
    first, second = (draw.choice(list(places(data))) for _ in range(2))
    one, two = (copy.deepcopy(parent_of(data, path)[path[-1]]) for path in (first, second))
    try:
        parent_of(data, first)[first[-1]] = two
        parent_of(data, second)[second[-1]] = one
    except (KeyError, IndexError, TypeError):
        pass  # one place was inside the other


def repeat_row(data: Data, draw: random.Random) -> None:
    rows = framework(data).get(draw.choice(["cylinders", "sheets", "joins", "anchors"]))
    if isinstance(rows, list) and rows:
        rows.insert(draw.randrange(len(rows) + 1), copy.deepcopy(draw.choice(rows)))


def misspell_key(data: Data, draw: random.Random) -> None:
    keyed = [path for path in places(data) if isinstance(path[-1], str)]
    path = draw.choice(keyed)
    node = parent_of(data, path)
    node[path[-1] + draw.choice(["s", "_", ".", " ", "\n"])] = node.pop(path[-1])


# --- mutations that mostly give designs --------------------------------------------------------


def framework(data: Data) -> Data:
    section = data.setdefault("framework", {})
    return section if isinstance(section, dict) else {}


def rows_of(data: Data, name: str) -> list[Data]:
    rows = framework(data).get(name)
    return [row for row in rows if isinstance(row, dict)] if isinstance(rows, list) else []


def section_of(data: Data, name: str) -> Data:
    section = data.get(name)
    if not isinstance(section, dict):
        section = data[name] = {}
    return section


def random_cell(draw: random.Random, depth: int = 0) -> str:
    kind = draw.choice(["0", "1", "1", "1", "2", "3@1", "4@3", "5", "6", "6", "star"])
    if depth > 4 or draw.random() < 0.5:
        return kind
    children = " ".join(random_cell(draw, depth + 1) for _ in range(4))
    return kind + (f"({children})" if draw.random() < 0.8 else f"[{children}]")


def broken_cell(draw: random.Random) -> str:
    text = list(random_cell(draw))
    for _ in range(draw.randint(1, 3)):
        text.insert(draw.randrange(len(text) + 1), draw.choice("()[]@ 0199x\té,"))
    return "".join(text)


def deep_cell(draw: random.Random) -> str:
    text = "1"
    for _ in range(draw.choice([3, 6, 9, 19, 20, 21, 30, 500])):
        children = ["1"] * 4
        children[draw.randrange(4)] = text
        text = f"1({' '.join(children)})"
    return text


def change_cell(data: Data, draw: random.Random) -> None:
    forest = section_of(data, "forest")
    cells = forest.get("cells")
    if not isinstance(cells, dict):
        cells = forest["cells"] = {}
    make = draw.choices([random_cell, broken_cell, deep_cell], [12, 1, 1])[0]
    number = draw.choices([draw.randrange(9), draw.randrange(60), 10**9], [12, 2, 1])[0]
    cells[str(number)] = make(draw)


def change_type(data: Data, draw: random.Random) -> None:
    section_of(data, "forest")["type"] = draw.choice([0, 1, 1, 2, 3, 4, 5, 6, "star", 7])


def change_method(data: Data, draw: random.Random) -> None:
    data["method"] = draw.choice(["recursive", "extensible", "dynamic"])


def change_grid(data: Data, draw: random.Random) -> None:
    framework(data)["grid"] = draw.choice(["quad", "dia"])


def change_level(data: Data, draw: random.Random) -> None:
    framework(data)["level"] = draw.choice([0, 1, 1, 2, 2, 3, 21])


def change_size(data: Data, draw: random.Random) -> None:
    for part in rows_of(data, draw.choice(["cylinders", "sheets"])):
        part[draw.choice(["around", "across", "along"])] = draw.choice([1, 2, 3, 4, 8, 2**20])


def change_join(data: Data, draw: random.Random) -> None:
    for join in rows_of(data, "joins"):
        for side in ("first", "second"):
            if isinstance(join.get(side), dict):
                join[side]["start"] = draw.randrange(8)
                join[side]["length"] = draw.choice([1, 2, 4, 8])
        if draw.random() < 0.5:
            for side in ("first", "second"):
                if isinstance(join.get(side), dict):
                    join[side]["length"] = 4
        join["reversed"], join["cord"] = draw.random() < 0.5, draw.random() < 0.5


def join_with_itself(data: Data, draw: random.Random) -> None:
    joins = framework(data).setdefault("joins", [])
    names = [part.get("name") for part in rows_of(data, "cylinders") + rows_of(data, "sheets")]
    if isinstance(joins, list) and names:
        side = draw.choice(["start", "end"])
        other = draw.choice(["start", "end", "left"])
        length = draw.choice([1, 2, 3, 4])
        joins.append(
            {
                "first": arc(f"{draw.choice(names)}.{side}", draw.randrange(6), length),
                "second": arc(f"{draw.choice(names)}.{other}", draw.randrange(6), length),
                "reversed": draw.random() < 0.5,
                "cord": draw.random() < 0.5,
            }
        )


def move_anchors(data: Data, draw: random.Random) -> None:
    """Let anchors stand on other vertices, joined ones among them."""
    for anchor in rows_of(data, "anchors"):
        if draw.random() < 0.5:
            if draw.random() < 0.5 and "ring" in anchor:
                anchor["index"] = draw.randrange(8)
            else:
                anchor.pop("ring", None)
                anchor.pop("index", None)
                anchor["vertex"] = draw.randrange(40)


def scale_anchors(data: Data, draw: random.Random) -> None:
    factor = draw.choice(COORDINATES)
    for anchor in rows_of(data, "anchors"):
        position = anchor.get("position")
        if isinstance(position, list):
            anchor["position"] = [
                part * factor if isinstance(part, float) else part for part in position
            ]


def place_anchors(data: Data, draw: random.Random) -> None:
    """Hold all anchors at one place."""
    place = [draw.choice(COORDINATES) for _ in range(3)]
    for anchor in rows_of(data, "anchors"):
        anchor["position"] = place


def scatter_anchor(data: Data, draw: random.Random) -> None:
    anchors = rows_of(data, "anchors")
    if anchors:
        draw.choice(anchors)["position"] = [draw.choice(COORDINATES) for _ in range(3)]


def drop_anchors(data: Data, draw: random.Random) -> None:
    anchors = framework(data).get("anchors")
    if isinstance(anchors, list):
        del anchors[draw.randrange(len(anchors) + 1) :]


def change_springs(data: Data, draw: random.Random) -> None:
    springs = section_of(data, "springs")
    springs[draw.choice(["stiffness", "ring_factor"])] = draw.choice(
        [1e-300, 5e-324, 1e-12, 1.0, 1e12, 1e300, 1.7e308, 0.0]
    )


PROPERTIES: dict[str, list[Any]] = {
    "parts": [["trunk"], ["left", "p"], [], ["x"], "trunk"],
    "types": [[1], [6, "star"], [99], [True]],
    "levels": [[0], [1, 2], [-1], [21]],
    "along": [["ring"], ["seam"], ["trunk.end"], ["trunk"]],
    "pairs": [["v0 v1"], ["v0 v0"], ["v0"], ["v0 v999999"]],
    "rest_ratio": [0.5, [0.5, 0.9], [], [-1.0], 1e300],
    "curve": [[[0, 0], [0.1, 2]], [[0, 0]], [[0, 1], [1, 2]], [[0.0]], 3.0],
    "sense": ["tension", "both", "compression", "pull"],
    "cells": [["0"], ["0.1", "2"], ["99999"], ["x"]],
    "force": [[0.0, 0.0, -1.0], 2.0, 0.0, -1e300],
    "node": ["v0", "v1", "e0:1/2", "q"],
    "holds": ["x", "xy", "xyz", "q"],
    "line": [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1e300, 0.0, 0.0]],
    "plane": [[0.0, 1.0, 1.0], [0, 0]],
    "follower": [True, False],
}


def change_rigging(data: Data, draw: random.Random) -> None:
    """Give springs, rods, loads or an anchor another property, right or wrong."""
    springs, loads = section_of(data, "springs"), section_of(data, "loads")
    table, name = draw.choice(
        [
            *((springs, "groups"), (loads, "nodes"), (loads, "pressures")),
            *((data, "rods"), (framework(data), "anchors")),
        ]
    )
    rows = table.get(name)
    if not isinstance(rows, list):
        rows = table[name] = []
    if not rows or draw.random() < 0.2:
        rows.append({})
    row = draw.choice(rows)
    if not isinstance(row, dict):
        return
    for _ in range(draw.choice([1, 1, 2, 3])):
        numbers = (
            *("stiffness", "axial_stiffness", "force_density", "rest_length", "prestress"),
            *("diameter", "area", "self_weight", "thermal_expansion", "temperature"),
            *("bending_stiffness", "length", "pressure", "index", "vertex"),
        )
        key = draw.choice([*PROPERTIES, *numbers])
        row[key] = draw.choice(PROPERTIES.get(key, [*NUMBERS, 0.5, 1.0, 2.0, 10.0]))


def random_node(draw: random.Random) -> str:
    def fraction() -> str:
        if draw.random() < 0.9:
            return draw.choice(["1/2", "1/2", "1/4", "3/4", "5/8"])
        return f"{draw.choice([0, 1, 2, 2**40])}/{draw.choice([0, 1, 3, 4, 2**33])}"

    number = draw.choices([draw.randrange(12), 2**32, 10**30], [20, 1, 1])[0]
    kind = draw.choice(["v", "v", "e", "f"])
    if kind == "v":
        return f"v{number}"
    return f"{kind}{number}:{fraction()}" + (f",{fraction()}" if kind == "f" else "")


def override(data: Data, draw: random.Random) -> None:
    pairs = section_of(data, "overrides").setdefault(draw.choice(["added", "cut"]), [])
    if isinstance(pairs, list):
        for _ in range(draw.choice([1, 1, 2, 9])):
            pairs.append(f"{random_node(draw)} {random_node(draw)}")


def define_type(data: Data, draw: random.Random) -> None:
    points = ["c0", "c1", "c2", "c3", "m0", "m1", "m2", "m3", "x"]
    springs = [
        "-".join(draw.sample(points, 2) if draw.random() < 0.98 else ["c0", "c0"])
        for _ in range(draw.randrange(6))
    ]
    section_of(data, "cell_types")["star"] = {
        "springs": springs,
        "perimeter": draw.random() < 0.5,
        "fan": draw.random() < 0.3,
    }


Mutation = Callable[[Data, random.Random], None]
BLIND: list[Mutation] = [replace_one, delete_one, swap_two, repeat_row, misspell_key]
KNOWING: list[Mutation] = [
    *(change_cell, change_cell, change_type, change_method, change_grid, change_level, change_size),
    *(change_join, join_with_itself, move_anchors, scale_anchors, place_anchors, scatter_anchor),
    *(drop_anchors, change_springs, override, define_type, change_rigging, change_rigging),
]


def mutated_data(draw: random.Random) -> Data:
    data = copy.deepcopy(draw.choice(DESIGNS))
    for _ in range(draw.choice([1, 1, 1, 2, 4])):
        draw.choice(BLIND if draw.random() < 0.1 else KNOWING)(data, draw)
    return data


def mutated_text(draw: random.Random) -> tuple[str, design_file.Format]:
    """A design's text with bytes changed, taken out, put in or moved."""
    format: design_file.Format = draw.choice(["toml", "json"])
    design = copy.deepcopy(draw.choice(DESIGNS))
    write = {"toml": toml_text, "json": json_text}[format]
    text = bytearray(write(design).encode())
    for _ in range(draw.choice([1, 1, 2, 4, 16])):
        at = draw.randrange(len(text))
        end = at + draw.choice([0, 1, 1, 2, 30])
        bits = bytes(
            draw.choices(b'0123456789.-+e{}[]()@",=:\n\t #\\\x00\xff_aAx', k=draw.randrange(4))
        )
        text[at:end] = draw.choice([bits, bits, bytes(text[at:end]) * 2])
        text = text or bytearray(b" ")
    return text.decode(errors="replace"), format


def mutant(draw: random.Random) -> tuple[str, design_file.Format]:
    if draw.random() < 0.15:
        return mutated_text(draw)
    return json.dumps(mutated_data(draw)), "json"


# --- the whole way -----------------------------------------------------------------------------


def grow(text: str, format: design_file.Format, draw: random.Random) -> str:
    """Take a text the whole way; return how far it came."""
    file = design_file.parse(text, format, "net.toml")
    if file.framework.cell_count() > LARGEST:
        return "large"
    design = sf.Design(file, source="net.toml")
    saved = design_file.dump(design.to_file(), "toml")
    again = sf.Design(design_file.parse(saved, "toml"))
    assert design_file.dump(again.to_file(), "toml") == saved
    network = design.network()
    equilibrium = design.solve()
    design.measure(equilibrium)
    design.inner_forces(equilibrium)
    assert equilibrium.converged or equilibrium.reason
    if equilibrium.converged:
        assert np.isfinite(equilibrium.positions).all()
        assert (equilibrium.positions[network.fixed] == network.positions[network.fixed]).all()
    # A net that takes hundreds of steps would make the run of it slower than a case may be.
    if draw.random() < 0.02 and equilibrium.iterations < 100:
        run = sf.evolve(design, population=3, generations=2, threads=1)
        run.individual(2, 1).network()
        return "evolved"
    return "solved" if equilibrium.converged else "unsolved"


@pytest.mark.parametrize("seed", range(SEEDS))
def test_mutated_designs_give_a_net_or_one_clear_error(seed: int) -> None:
    ends: Counter[str] = Counter()
    for number in range(MUTANTS):
        draw = random.Random(f"{seed} {number}")
        text, format = mutant(draw)
        began = time.monotonic()
        try:
            end = grow(text, format, draw)
        except sf.SpringformError as error:
            end = "refused" if str(error).isprintable() else "refused in a mess"
        except BaseException as error:
            # A panic of the core is no Exception.
            raise AssertionError(f"seed {seed}, mutant {number}:\n{text}") from error
        assert time.monotonic() - began < SLOWEST, f"seed {seed}, mutant {number}:\n{text}"
        ends[end] += 1
    assert ends["refused in a mess"] == 0
    assert ends["solved"] > 0.15 * MUTANTS, ends
    assert ends["refused"] > 0.2 * MUTANTS, ends
    assert ends["evolved"] > 0
