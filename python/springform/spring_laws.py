"""Laws of springs: what was said of each, as stiffness, rest length, constant force and curve."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .arrays import Floats, numbers, read_only, wrong_shape
from .curve_file import read_curve
from .errors import InputError

NO_CURVE = 2**32 - 1
"""In place of the number of a curve: the spring has none."""

LAWS = ("stiffness", "axial_stiffness", "force_density", "force", "curve")
"""Names of the laws, in the order of their numbers."""

_SENSES = {"tension": 1, "both": 0, "compression": -1}


class Curve:
    """A measured force–strain curve: a monotone cubic through test points (Fritsch & Butland 1984).

    Strain refers to the unstressed length L0 of a cord: (L - L0)/L0. Beyond the points the curve
    goes on straight, after the last at least as steep as the chord from the point before.
    Attributes: `points` (p, 2): strain and force [N].
    """

    points: Floats

    def __init__(self, points: ArrayLike) -> None:
        """Take points of ascending strain and force [N] that don't fall, among them (0, 0), with a
        rise at the end.

        Raises `InputError`: points that are none of a cord.
        """
        self.points = numbers("points", points, (None, 2))
        try:
            self._native = _core.ForceStrainCurve(self.points.tolist())
        except _core.CoreError as error:
            raise InputError(error.args[1], key="points") from None

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Curve:
        """Return the curve in a CSV file of test points: see docs/formats/curve.md.

        Raises `InputError`: with the line, points that are none of a cord.
        """
        return cls(read_curve(path))

    @property
    def axial_stiffness(self) -> float:
        """Force over strain at the last point [N]: the secant axial stiffness EA."""
        return self._native.axial_stiffness

    @property
    def native(self) -> _core.ForceStrainCurve:
        """The curve as the core knows it."""
        return self._native

    def force(self, strain: ArrayLike) -> Floats:
        """Return the force at strains [N]."""
        strains = np.asarray(strain, dtype=np.float64)
        return self._native.force(strains.reshape(-1)).reshape(strains.shape)

    def strain(self, force: ArrayLike) -> Floats:
        """Return the least strains at which the cord pulls with forces [N]."""
        forces = np.asarray(force, dtype=np.float64)
        return self._native.strain(forces.reshape(-1)).reshape(forces.shape)

    def __repr__(self) -> str:
        strain, force = self.points[-1]
        return f"Curve({len(self.points)} points to {force:g} N at a strain of {strain:g})"


Curves = Curve | Sequence[Curve | None] | None


class SpringLaws(NamedTuple):
    """What the core takes: F = T + k (L - r), or F = k r g((L - r)/r) where a curve g is."""

    stiffness: Floats
    """k, (m,) [N/m]."""
    rest_length: Floats
    """r, (m,) [m]."""
    force: Floats
    """T, (m,) [N]."""
    curve: NDArray[np.uint32]
    """Number in `curves`, or `NO_CURVE`, (m,); empty if no spring has a curve."""
    curves: list[_core.ForceStrainCurve]
    law: NDArray[np.uint8]
    """Place in `LAWS` of the law that was said, (m,)."""


def senses(sense: str | Sequence[str], count: int) -> NDArray[np.int8]:
    """Return 1 for tension, 0 for both and -1 for compression, one a spring.

    Raises `InputError`: another word, or another number of words.
    """
    words = [sense] * count if isinstance(sense, str) else list(sense)
    if len(words) != count:
        raise wrong_shape("sense", (len(words),), f"({count},)")
    unknown = sorted(set(words) - set(_SENSES))
    if unknown:
        raise InputError(f"must be tension, both or compression, not {unknown[0]}", key="sense")
    return read_only(np.array([_SENSES[word] for word in words], dtype=np.int8))


def resolve(
    lengths: Floats,
    *,
    stiffness: ArrayLike | None,
    axial_stiffness: ArrayLike | None,
    force: ArrayLike | None,
    curve: Curves,
    rest_length: ArrayLike | None,
    prestress: ArrayLike | None,
    thermal_strain: ArrayLike | None,
) -> SpringLaws:
    """Resolve what was said of springs whose lengths at the start are (m,) [m].

    Raises `InputError`: no law, or more than one, for a spring; an unstressed length not above 0.
    """
    return _Resolver(lengths).resolve(
        stiffness, axial_stiffness, force, curve, rest_length, prestress, thermal_strain
    )


class _Resolver:
    def __init__(self, lengths: Floats) -> None:
        self._lengths = lengths
        self._count = len(lengths)

    def resolve(
        self,
        stiffness: ArrayLike | None,
        axial_stiffness: ArrayLike | None,
        force: ArrayLike | None,
        curve: Curves,
        rest_length: ArrayLike | None,
        prestress: ArrayLike | None,
        thermal_strain: ArrayLike | None,
    ) -> SpringLaws:
        none = np.zeros(0, dtype=np.uint32)
        said = (axial_stiffness, force, curve, prestress, thermal_strain)
        if all(value is None for value in said):
            # The plain case keeps the caller's arrays.
            plain = self._values("stiffness", 1.0 if stiffness is None else stiffness)
            rest = self._values("rest_length", 0.0 if rest_length is None else rest_length)
            said_law = read_only(np.zeros(self._count, dtype=np.uint8))
            return SpringLaws(plain, rest, self._values("force", 0.0), none, [], said_law)
        if all(value is None for value in (stiffness, axial_stiffness, force, curve)):
            stiffness = 1.0
        hooke = self._values("stiffness", _or_nan(stiffness))
        axial = self._values("axial_stiffness", _or_nan(axial_stiffness))
        constant = self._values("force", _or_nan(force))
        number, curves = self._curves(curve)
        curved = number != NO_CURVE
        self._check_one_law(~np.isnan([hooke, axial, constant]), curved)
        axial = np.where(curved, [curves[n].axial_stiffness if c else 0.0
                                  for n, c in zip(number, curved, strict=True)], axial)  # fmt: skip
        rest = self._rest_lengths(hooke, axial, constant, number, curves, rest_length, prestress)
        with np.errstate(all="ignore"):
            rate = np.where(np.isnan(axial), hooke, axial / rest)
        elastic = np.isnan(constant)
        axially = np.where(np.isnan(axial), 0, LAWS.index("axial_stiffness"))
        said_law = np.where(elastic, axially, LAWS.index("force"))
        said_law = np.where(curved, LAWS.index("curve"), said_law)
        strain = self._values("thermal_strain", 0.0 if thermal_strain is None else thermal_strain)
        if (bad := np.flatnonzero(~(strain > -1))).size:
            raise InputError(f"must be above -1, not {strain[bad[0]]:g}", key="thermal_strain")
        # Whatever its unstressed length, a cord keeps its axial stiffness: k r.
        rate = np.where(np.isnan(axial), rate, rate / (1 + strain))
        return SpringLaws(
            read_only(np.where(elastic, rate, 0.0)),
            read_only(np.where(elastic, rest * (1 + strain), 0.0)),
            read_only(np.where(elastic, 0.0, constant)),
            read_only(number) if curves else none,
            [one.native for one in curves],
            read_only(said_law.astype(np.uint8)),
        )

    def _curves(self, curve: Curves) -> tuple[NDArray[np.uint32], list[Curve]]:
        given = [curve] * self._count if curve is None or isinstance(curve, Curve) else list(curve)
        if len(given) != self._count:
            raise wrong_shape("curve", (len(given),), f"({self._count},)")
        curves = list({id(one): one for one in given if one is not None}.values())
        places = {id(one): place for place, one in enumerate(curves)}
        number = [NO_CURVE if one is None else places[id(one)] for one in given]
        return np.array(number, dtype=np.uint32), curves

    def _check_one_law(self, laws: NDArray[np.bool_], curved: NDArray[np.bool_]) -> None:
        said = laws.sum(axis=0) + curved
        if (wrong := np.flatnonzero(said != 1)).size:
            what = "no law" if said[wrong[0]] == 0 else "more than one law"
            raise InputError(
                f"spring {wrong[0]} has {what}; "
                "give one of stiffness, axial_stiffness, force and curve",
                key="stiffness",
            )

    def _rest_lengths(
        self,
        hooke: Floats,
        axial: Floats,
        constant: Floats,
        number: NDArray[np.uint32],
        curves: list[Curve],
        rest_length: ArrayLike | None,
        prestress: ArrayLike | None,
    ) -> Floats:
        curved = number != NO_CURVE
        given = self._values("rest_length", _or_nan(rest_length))
        stress = self._values("prestress", _or_nan(prestress))
        if (twice := np.flatnonzero(~np.isnan(given) & ~np.isnan(stress))).size:
            raise InputError(
                f"spring {twice[0]} has a prestress and a rest length; give one", key="prestress"
            )
        lengths = self._lengths
        # Numbers that overflow here are refused with the others that are not finite.
        with np.errstate(all="ignore"):
            unstressed = np.where(np.isnan(axial), 0.0, lengths)
            from_stress = np.where(
                np.isnan(axial), lengths - stress / hooke, lengths / (1.0 + stress / axial)
            )
            for place, one in enumerate(curves):
                its = (number == place) & ~np.isnan(stress)
                from_stress[its] = lengths[its] / (1.0 + one.strain(stress[its]))
        rest = np.where(np.isnan(stress), np.where(np.isnan(given), unstressed, given), from_stress)
        rest = np.where(np.isnan(constant), rest, 0.0)
        if (bad := np.flatnonzero(~np.isnan(axial) & ~(rest > 0))).size:
            what = "a measured curve" if curved[bad[0]] else "axial_stiffness"
            raise InputError(
                f"spring {bad[0]} has an unstressed length of {rest[bad[0]]:g} m; "
                f"{what} needs one above 0",
                key="rest_length",
            )
        if (bad := np.flatnonzero(rest < 0)).size:
            raise InputError(
                f"spring {bad[0]} would have a rest length of {rest[bad[0]]:g} m; lower it",
                key="prestress",
            )
        return rest

    def _values(self, name: str, values: ArrayLike) -> Floats:
        return numbers(name, values, (self._count,))


def spring_lengths(
    positions: Floats, springs: Iterable[Sequence[int]] | NDArray[np.uint32]
) -> Floats:
    """Return the length of every spring, (m,) [m]."""
    with np.errstate(all="ignore"):
        ends = positions[np.asarray(springs)]
        lengths: Floats = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return lengths


def _or_nan(values: ArrayLike | None) -> ArrayLike:
    return np.nan if values is None else values
