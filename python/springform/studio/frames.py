"""Binary frames: a header in JSON, then arrays. Nets travel as what changed, motion as arrays.

┌─────────────┬──────────────┬─────────┬─────────┬─────┐
│ u32, length │ header, JSON │ array 0 │ array 1 │ ... │   little-endian; header and arrays are
└─────────────┴──────────────┴─────────┴─────────┴─────┘   filled up to multiples of 4 bytes
"""

from __future__ import annotations

import struct
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..design import Design, Groups
from ..network import Network
from .frame_messages import ArrayHeader, NetHeader

Ints = NDArray[np.int32]

_TYPES = {"float32": "<f4", "int32": "<i4", "uint8": "|u1"}


def encode(header: Any, arrays: dict[str, NDArray[Any]]) -> bytes:
    """Return one frame: a header of `messages`, and arrays of float32, int32 or uint8."""
    described = [
        ArrayHeader.model_validate({"name": name, "type": array.dtype.name, "length": array.size})
        for name, array in arrays.items()
    ]
    text = header.model_copy(update={"arrays": described}).model_dump_json().encode()
    text += b" " * (-len(text) % 4)
    parts = [struct.pack("<I", len(text)), text]
    for array in arrays.values():
        data = np.ascontiguousarray(array, dtype=_TYPES[array.dtype.name]).tobytes()
        parts.append(data + b"\0" * (-len(data) % 4))
    return b"".join(parts)


@dataclass(frozen=True)
class Tables:
    """A grown net as three tables whose rows can be told apart: nodes, springs and cells."""

    nodes: list[str]
    springs: list[Hashable]
    cells: list[Hashable]
    columns: dict[str, NDArray[Any]]
    """Columns of springs and cells, one value a row."""
    boundaries: Groups
    cell_springs: Groups
    addresses: list[str]
    types: list[str]


def tables_of(design: Design) -> Tables:
    """Return the tables of a design's net."""
    network, cells, nodes = design.network(), design.cells, design.nodes
    stored = np.array(
        [design.setting.cell(design.forest, address)[2] for address in cells.addresses],
        dtype=np.uint8,
    )
    columns = _spring_columns(design, network) | {"cell_stored": stored}
    columns["cell_level"] = cells.squares[:, 1].astype(np.uint8)
    columns["cell_part"] = _parts_of_faces(design)[cells.squares[:, 0]]
    pairs = [(nodes[a], nodes[b]) for a, b in network.springs.tolist()]
    values = zip(*(columns[name].tolist() for name in SPRING_COLUMNS), strict=True)
    springs: list[Hashable] = [(*pair, *row) for pair, row in zip(pairs, values, strict=True)]
    around = _grouped(cells.boundaries, nodes)
    # A cell is sent anew if one of its springs is: rows of what went are unknown to the window.
    own = _grouped(cells.springs, springs)
    identities: list[Hashable] = list(
        zip(cells.addresses, cells.types, stored.tolist(), around, own, strict=True)
    )
    return Tables(
        nodes=nodes,
        springs=springs,
        cells=identities,
        columns=columns,
        boundaries=cells.boundaries,
        cell_springs=cells.springs,
        addresses=cells.addresses,
        types=cells.types,
    )


SPRING_COLUMNS = (
    "spring_level",
    "spring_part",
    "spring_ring",
    "spring_law",
    "spring_sense",
    "area",
    "stiffness",
    "rest_length",
    "constant_force",
)
"""Columns of springs, in the order in which they identify a row."""

CELL_COLUMNS = ("cell_stored", "cell_level", "cell_part")
"""Columns of cells."""


def net_frame(
    design: Design, tables: Tables, revision: int, base: tuple[int, Tables] | None
) -> bytes:
    """Return the frame that makes a net of revision `base`, or of nothing, the net of a design.

    A row that the base has is named by a run of rows of the base; all other rows are written out.
    """
    network = design.network()
    before = None if base is None else base[1]
    runs = {
        name: _runs(getattr(before, name) if before else [], getattr(tables, name))
        for name in ("nodes", "springs", "cells")
    }
    fresh = {name: _fresh_rows(found) for name, found in runs.items()}
    springs, cells = fresh["springs"], fresh["cells"]
    arrays: dict[str, NDArray[Any]] = {f"{name}_runs": found for name, found in runs.items()}
    arrays["spring_ends"] = network.springs[springs].astype(np.int32).reshape(-1)
    arrays |= {name: tables.columns[name][springs] for name in SPRING_COLUMNS}
    arrays |= {name: tables.columns[name][cells] for name in CELL_COLUMNS}
    for name, groups in (("boundary", tables.boundaries), ("own", tables.cell_springs)):
        arrays[f"{name}_counts"], arrays[f"{name}_items"] = _rows_of_groups(groups, cells)
    arrays["anchors"] = design.anchors.astype(np.int32)
    header = NetHeader(
        revision=revision,
        base=None if base is None else base[0],
        parts=part_names(design),
        anchor_names=list(design.anchor_names),
        node_keys=[tables.nodes[row] for row in fresh["nodes"]],
        addresses=[tables.addresses[row] for row in cells],
        types=[tables.types[row] for row in cells],
        arrays=[],
    )
    return encode(header, arrays)


def part_names(design: Design) -> list[str]:
    """Return the names of cylinders and sheets in the order of their numbers; "mesh" for a mesh."""
    framework = design.file.framework
    names = [part.name for part in framework.cylinders]
    names += [part.name for part in framework.sheets]
    return names or ["mesh"]


def _parts_of_faces(design: Design) -> NDArray[np.uint8]:
    parts, _ = design.mesh.map
    if len(parts) == 0:
        parts = np.zeros(len(design.mesh.faces), dtype=np.uint32)
    return np.minimum(parts, 255).astype(np.uint8)


def _spring_columns(design: Design, network: Network) -> dict[str, NDArray[Any]]:
    """Level and part of a spring are those of its deepest cell."""
    cells = design.cells
    starts, items = cells.springs
    owners = np.repeat(np.arange(len(cells.addresses)), np.diff(starts))
    level = np.zeros(len(network.springs), dtype=np.uint8)
    part = np.zeros(len(network.springs), dtype=np.uint8)
    ring = np.zeros(len(network.springs), dtype=np.uint8)
    ring[design.cords] = design._net.ring
    order = np.argsort(cells.squares[owners, 1], kind="stable")
    level[items[order]] = cells.squares[owners[order], 1]
    part[items[order]] = _parts_of_faces(design)[cells.squares[owners[order], 0]]
    return {
        "spring_level": level,
        "spring_part": part,
        "spring_ring": ring,
        "spring_law": _laws(design, network),
        # 0: pulls only, 1: pulls and pushes, 2: pushes only.
        "spring_sense": (1 - network.sense).astype(np.uint8),
        "area": np.nan_to_num(network.area, nan=0.0).astype(np.float32),
        "stiffness": network.stiffness.astype(np.float32),
        "rest_length": network.rest_length.astype(np.float32),
        "constant_force": network.force.astype(np.float32),
    }


_ROD = 5
"""In place of the number of a law: the spring is a link of a rod."""


def _laws(design: Design, network: Network) -> NDArray[np.uint8]:
    """Return the law of every spring: its place in `spring_laws.LAWS`, or `_ROD`."""
    laws = network.law.astype(np.uint8)
    laws[design.cords.stop :] = _ROD
    return laws


def _grouped(groups: Groups, names: Sequence[Hashable]) -> list[tuple[Hashable, ...]]:
    starts, items = groups
    named = [names[item] for item in items.tolist()]
    bounds = starts.tolist()
    return [tuple(named[a:b]) for a, b in pairwise(bounds)]


def _rows_of_groups(groups: Groups, rows: NDArray[np.int64]) -> tuple[Ints, Ints]:
    starts, items = groups
    counts = np.diff(starts)
    chosen = np.repeat(np.isin(np.arange(len(counts)), rows), counts)
    return counts[rows].astype(np.int32), items[chosen].astype(np.int32)


def _runs(before: Sequence[Hashable], after: Sequence[Hashable]) -> Ints:
    """Return rows of `after` as runs, flat: first row in `before` or -1 where new, and length."""
    places = {row: number for number, row in enumerate(before)}
    found = np.array([places.get(row, -1) for row in after], dtype=np.int64)
    if not len(found):
        return np.empty(0, dtype=np.int32)
    goes_on = np.where(found[1:] < 0, found[:-1] < 0, found[1:] == found[:-1] + 1)
    goes_on &= (found[1:] < 0) == (found[:-1] < 0)
    first = np.flatnonzero(np.concatenate(([True], ~goes_on)))
    lengths = np.diff(np.concatenate((first, [len(found)])))
    return np.column_stack((found[first], lengths)).astype(np.int32).reshape(-1)


def _fresh_rows(runs: Ints) -> NDArray[np.int64]:
    first, lengths = runs.reshape(-1, 2).T
    rows = np.repeat(first < 0, lengths)
    return np.flatnonzero(rows)
