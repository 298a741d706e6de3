"""Results of a solve as files that other programs read: tables, measures and lines."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from .arrays import Floats
from .design import Design, Measures
from .design_file import dump
from .equalisation import Equalised
from .exchange.obj import line_obj
from .files import WriteError, explain, write_atomically
from .network import Equilibrium
from .spring_laws import LAWS

_NODE_COLUMNS = (
    *("node", "key", "x", "y", "z", "anchor"),
    *("load_x", "load_y", "load_z", "reaction_x", "reaction_y", "reaction_z"),
)
_SPRING_COLUMNS = (
    *("spring", "node_a", "node_b", "stiffness", "rest_length", "length", "force"),
    *("member", "law", "strain", "stress", "energy"),
)


def write(design: Design, equilibrium: Equilibrium, measures: Measures, folder: Path) -> list[Path]:
    """Write design.toml, nodes.csv, springs.csv, measures.json and net.obj; return their paths.

    What the columns hold, and their units: docs/formats/results.md. Results that are there are
    replaced. Raises `WriteError`: the folder can't be written, or holds other files of these names.
    """
    network = design.network()
    labels = [*["cord"] * design.cords.stop, *rod_labels(design)]
    anchors = dict(zip(design.anchors.tolist(), design.anchor_names, strict=True))
    positions = equilibrium.positions.tolist()
    nodes = (
        (number, key, *position, anchors.get(number, ""), *load, *reaction)
        for number, (key, position, load, reaction) in enumerate(
            zip(
                design.nodes,
                positions,
                equilibrium.loads.tolist(),
                equilibrium.reactions.tolist(),
                strict=True,
            )
        )
    )
    springs = zip(
        range(len(network.springs)),
        *network.springs.T.tolist(),
        network.stiffness.tolist(),
        network.rest_length.tolist(),
        equilibrium.lengths.tolist(),
        equilibrium.forces.tolist(),
        labels,
        [LAWS[number] for number in network.law],
        _or_empty(equilibrium.strains),
        _or_empty(equilibrium.stresses),
        equilibrium.spring_energies.tolist(),
        strict=True,
    )
    contents = {
        "design.toml": dump(design.to_file(), "toml"),
        "nodes.csv": _csv(_NODE_COLUMNS, nodes),
        "springs.csv": _csv(_SPRING_COLUMNS, springs),
        "measures.json": json.dumps(finite(asdict(measures)), indent=2) + "\n",
        "net.obj": line_obj(equilibrium.positions, network.springs),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(f"can't be made: {explain(error)}", file=folder) from None
    # Beside measures.json the files are earlier results; elsewhere they are somebody's work.
    taken = [name for name in contents if (folder / name).exists()]
    if taken and "measures.json" not in taken:
        raise WriteError(
            "exists and is no earlier result; choose another folder", file=folder / taken[0]
        )
    for name, text in contents.items():
        write_atomically(folder / name, text.encode())
    return [folder / name for name in contents]


def write_factors(design: Design, tuned: Equalised, path: Path) -> None:
    """Write a table of springs by their node keys: factor, stiffness [N/m], length [m], force [N].

    Raises `WriteError`: the file can't be written.
    """
    keys = design.nodes
    springs = zip(
        ((keys[a], keys[b]) for a, b in tuned.network.springs.tolist()),
        tuned.factors.tolist(),
        tuned.network.stiffness.tolist(),
        tuned.equilibrium.lengths.tolist(),
        tuned.equilibrium.forces.tolist(),
        strict=True,
    )
    header = ["spring", "node_a", "node_b", "factor", "stiffness", "length", "force"]
    rows = ((number, *ends, *values) for number, (ends, *values) in enumerate(springs))
    write_atomically(path, _csv(header, rows).encode())


def rod_labels(design: Design) -> list[str]:
    """Return what each link of the rods belongs to, in the order of the network's springs."""
    labels: list[str] = []
    for number, (rod, said) in enumerate(zip(design.network().rods, design.file.rods, strict=True)):
        links = len(rod.nodes) - (not rod.closed)
        labels += [said.name or f"rod {number + 1}"] * links
    return labels


def finite(value: Any) -> Any:
    """Return plain data with None for numbers that JSON does not know."""
    if isinstance(value, dict):
        return {name: finite(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _or_empty(values: Floats) -> list[float | str]:
    return ["" if math.isnan(value) else value for value in values.tolist()]


def _csv(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()
