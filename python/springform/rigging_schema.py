"""Sections of the design file on springs, rods and loads, chosen by place and not by number."""

from __future__ import annotations

import math
import re
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator, model_validator
from pydantic_core import PydanticCustomError

from .schema_base import (
    NODE_PATTERN,
    Number,
    Point,
    Section,
    Title,
    check_node_pair,
    check_node_pairs,
    fault,
)
from .wording import shown

_Positive = Annotated[float, Field(gt=0)]
_NotNegative = Annotated[float, Field(ge=0)]

LAWS = ("stiffness", "axial_stiffness", "force_density", "force", "curve")
"""Keys of a group of springs that say how force follows length; at most one of them."""

REST_LENGTHS = ("rest_length", "rest_ratio", "prestress")
"""Keys of a group of springs that say the unstressed length; at most one of them."""


def check_direction(key: str, direction: tuple[float, float, float] | None) -> None:
    """Raise a fault if a direction has no length."""
    if direction is not None and not 1e-150 < math.hypot(*direction) < 1e150:
        raise fault((key,), "is no direction; write three numbers, not all zero, such as [0, 0, 1]")


def _check_ratio(value: object) -> object:
    ratios = value if isinstance(value, (list, tuple)) else [value]
    for number, ratio in enumerate(ratios):
        if isinstance(ratio, bool) or not isinstance(ratio, (int, float)) or not 0 <= ratio < 1e150:
            path = (number,) if isinstance(value, (list, tuple)) else ()
            raise fault(path, f"must be a number, at least 0, not {shown(ratio)}")
    if not ratios:
        raise fault((), "is empty; write a number, or one a level")
    if isinstance(value, (list, tuple)):
        return tuple(float(ratio) for ratio in value)
    return float(value)  # type: ignore[arg-type]


def _check_curve(value: object) -> object:
    if isinstance(value, str):
        raise fault(
            (), f"names the file {shown(value)}, which only a design in a file can; list points"
        )
    if not isinstance(value, (list, tuple)):
        raise fault((), f"must be a list of points [strain, force], not {shown(value)}")
    for number, point in enumerate(value):
        if not isinstance(point, (list, tuple)) or len(point) != 2:
            raise fault((number,), f"must be a point [strain, force], not {shown(point)}")
    return tuple(map(tuple, value))


def _check_types(value: object) -> object:
    for number, word in enumerate(value if isinstance(value, (list, tuple)) else ()):
        if isinstance(word, bool) or not isinstance(word, (int, str)):
            raise fault((number,), f"must be a type's number or name, not {shown(word)}")
        if isinstance(word, int) and not 0 <= word < 2**32:
            raise fault((number,), f"no cell type has the number {shown(word)}")
    return value


Parts = Annotated[tuple[str, ...], Field(strict=False, min_length=1)]
Types = Annotated[
    tuple[int | str, ...], BeforeValidator(_check_types), Field(strict=False, min_length=1)
]
Levels = Annotated[
    tuple[Annotated[int, Field(ge=0, le=20)], ...], Field(strict=False, min_length=1)
]
Ratio = Annotated[float | tuple[float, ...], BeforeValidator(_check_ratio)]
CurvePoints = Annotated[
    tuple[tuple[float, float], ...],
    BeforeValidator(_check_curve),
    Field(strict=False),
    WithJsonSchema(
        {
            "anyOf": [
                {
                    "type": "array",
                    "items": {
                        "type": "array",
                        "items": {"type": "number"},
                        "minItems": 2,
                        "maxItems": 2,
                    },
                },
                {"type": "string", "minLength": 1},
            ]
        }
    ),
]


def _section_area(diameter: float | None, area: float | None) -> float | None:
    return area if diameter is None else math.pi * diameter**2 / 4


def _check_section(diameter: float | None, area: float | None) -> None:
    if diameter is not None and area is not None:
        raise fault(("area",), "cannot stand beside a diameter; remove one of the two")


class SpringGroup(Section):
    """What some springs are made of. A spring is in the group if it meets all that is said of it:
    parts, types and levels of one of its cells, along, pairs; all springs are if nothing is.

    Each property of a spring comes from the last group that has the spring and says something of
    the property.
    """

    name: Title | None = None
    """What the group is called."""
    parts: Parts | None = None
    """Cylinders and sheets."""
    types: Types | None = None
    """Cell types, as expressed: numbers, or names of types of your own."""
    levels: Levels | None = None
    """How often the cell's top-level cell is subdivided down to it; `framework.level` counts."""
    along: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] | None = None
    """"ring" for all free rings and rims, "seam" for all seams, or boundaries: `trunk.start`."""
    pairs: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] | None = None
    """Springs by their two node keys."""

    stiffness: _Positive | None = None
    """Law F = k (L - r): k [N/m]; unstressed length 0 unless said."""
    axial_stiffness: _Positive | None = None
    """Law F = EA (L - L0)/L0: EA [N], which refers to the unstressed length L0."""
    force_density: _Positive | None = None
    """Law F = q L: q [N/m]."""
    force: float | None = None
    """Law F = T, whatever the length: T [N], not 0; negative ones push."""
    curve: CurvePoints | None = None
    """Measured law: points [strain, force in N] of ascending strain, among them [0, 0]; the strain
    refers to the unstressed length. In a file also the name of a CSV file of such points, in a path
    relative to the design's: they become part of the design when it is loaded."""

    rest_length: _NotNegative | None = None
    """Unstressed length [m]."""
    rest_ratio: Ratio | None = None
    """Unstressed over drawn length: one number, or one for each level from 0, the last of them for
    deeper ones; the deepest cell of a spring counts."""
    prestress: float | None = None
    """Force at the drawn length [N], instead of an unstressed length."""

    sense: Literal["tension", "both", "compression"] | None = None
    """Whether the springs pull only, which is so unless said, push only, or do both."""
    diameter: _Positive | None = None
    """Diameter of the round cross-section [m], for stresses."""
    area: _Positive | None = None
    """Area of the cross-section [m2], instead of a diameter."""
    self_weight: _NotNegative | None = None
    """Weight along -z [N/m], by unstressed length; by length where that is 0."""
    thermal_expansion: float | None = None
    """Strain for a degree [1/K]."""
    temperature: float | None = None
    """Temperature above the one at which lengths are given [K]: L0 (1 + expansion temperature)."""

    @property
    def section_area(self) -> float | None:
        """Area of the cross-section [m2]."""
        return _section_area(self.diameter, self.area)

    def said(self, keys: tuple[str, ...]) -> list[str]:
        """Return those of the keys that the group gives."""
        return [key for key in keys if getattr(self, key) is not None]

    @field_validator("pairs")
    @classmethod
    def _check_pairs(cls, pairs: tuple[str, ...] | None) -> tuple[str, ...] | None:
        return None if pairs is None else check_node_pairs(pairs)

    @model_validator(mode="after")
    def _check(self) -> Self:
        _check_section(self.diameter, self.area)
        for keys in (LAWS, REST_LENGTHS):
            if len(given := self.said(keys)) > 1:
                raise fault((given[1],), f"cannot stand beside {given[0]}; remove one of the two")
        laws, rests = self.said(LAWS), self.said(REST_LENGTHS)
        if laws and rests and laws[0] in ("force_density", "force"):
            raise fault((rests[0],), f"means nothing beside {laws[0]}; remove it")
        if self.force == 0:
            raise fault(("force",), "must not be 0")
        choice = ("name", "parts", "types", "levels", "along", "pairs")
        if not self.said(tuple(key for key in type(self).model_fields if key not in choice)):
            raise fault((), "says nothing of its springs; give them a law, say, or remove it")
        return self


class Springs(Section):
    """What every spring is made of."""

    stiffness: Annotated[float, Field(gt=0)] = 1.0
    """Force per length [N/m] of springs to which no group gives a law."""
    ring_factor: Annotated[float, Field(gt=0)] = 1.0
    """Factor on that stiffness for springs along free rings and free edges of sheets."""
    groups: Annotated[tuple[SpringGroup, ...], Field(strict=False)] = ()
    """Springs of other laws; later groups win."""
    stiffness_factors: dict[str, _Positive] = Field(default={})
    """Factor on the stiffness that a spring has by its law, by its two node keys; what
    `springform equalise` writes. Unstressed length, section and weight stay."""

    @field_validator("stiffness_factors")
    @classmethod
    def _check_factors(cls, factors: dict[str, float]) -> dict[str, float]:
        seen: dict[frozenset[str], str] = {}
        for pair in factors:
            try:
                check_node_pair(pair)
            except PydanticCustomError as error:
                raise fault((pair,), (error.context or {})["message"]) from None
            if (other := seen.setdefault(frozenset(pair.split()), pair)) != pair:
                raise fault((pair,), f"is the same spring as {other}; remove one of the two")
        return factors


class Rod(Section):
    """A rod that bends, through all nodes of the net along a boundary, or along vertices; it is no
    cord of the net."""

    name: Title | None = None
    """What the rod is called."""
    along: str | None = None
    """The boundary, such as `trunk.start`, or `rim.1` of a mesh; on a ring or rim the rod is
    closed."""
    vertices: Annotated[tuple[Number, ...], Field(strict=False, min_length=3)] | None = None
    """Base vertices instead, each joined to the next by an edge of the base mesh; the first once
    more at the end closes the rod."""
    bending_stiffness: _NotNegative
    """EI [N m2], the same about all axes; the rod is straight without force."""
    axial_stiffness: _Positive
    """EA [N], which refers to the unstressed length."""
    length: _Positive | None = None
    """Unstressed length of the whole rod [m], the same for each edge of the boundary; without it
    every link is as long as it is drawn."""
    diameter: _Positive | None = None
    """Diameter of the round cross-section [m], for stresses."""
    area: _Positive | None = None
    """Area of the cross-section [m2], instead of a diameter."""
    self_weight: _NotNegative = 0.0
    """Weight along -z [N/m], by unstressed length."""

    @property
    def section_area(self) -> float | None:
        """Area of the cross-section [m2]."""
        return _section_area(self.diameter, self.area)

    @model_validator(mode="after")
    def _check(self) -> Self:
        _check_section(self.diameter, self.area)
        if self.along is None and self.vertices is None:
            raise fault((), "runs along nothing; give along, or vertices")
        if self.vertices is not None:
            if self.along is not None:
                raise fault(("vertices",), "cannot stand beside along; remove one of the two")
            open_end = self.vertices[:-1]
            if len(set(open_end)) < len(open_end) or self.vertices[-1] in open_end[1:]:
                raise fault(
                    ("vertices",), "has a vertex twice; only the first may stand at the end"
                )
        return self


class NodeLoad(Section):
    """A force on a node: `ring` and `index`, `vertex`, or `node`."""

    ring: str | None = None
    """The boundary, such as `trunk.start`."""
    index: Number | None = None
    """Index of the vertex on the boundary."""
    vertex: Number | None = None
    """Number of the base vertex."""
    node: str | None = None
    """Key of the node, such as "e7:3/8"."""
    force: Point
    """[N]."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        ways = [self.ring is not None, self.vertex is not None, self.node is not None]
        if sum(ways) != 1:
            raise fault((), "must be on one node; give ring and index, vertex, or node")
        if (self.ring is None) != (self.index is None):
            raise fault((), "has a ring or an index without the other; give both")
        if self.node is not None and not re.fullmatch(NODE_PATTERN, self.node):
            raise fault(
                ("node",), f'{shown(self.node)} is no node; write it like "v12" or "e7:1/2"'
            )
        return self


class Pressure(Section):
    """Pressure on cells that meet all that is said of them; on all cells if nothing is."""

    parts: Parts | None = None
    """Cylinders and sheets."""
    types: Types | None = None
    """Cell types, as expressed."""
    levels: Levels | None = None
    """Levels of cells."""
    cells: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] | None = None
    """Addresses of cells, such as "12.0"; of a subdivided one, all cells below it."""
    pressure: float
    """[Pa], positive along the normal of the right-hand rule round the cell's corners."""
    follower: bool = False
    """Whether it stays square to the cells wherever they move; else it is as on the drawn cells."""


class Loads(Section):
    """What pulls and presses on the net."""

    nodes: Annotated[tuple[NodeLoad, ...], Field(strict=False)] = ()
    """Forces on single nodes; they keep their direction."""
    pressures: Annotated[tuple[Pressure, ...], Field(strict=False)] = ()
    """Pressure on cells; pressures on one cell add up."""
