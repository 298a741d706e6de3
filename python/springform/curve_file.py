"""Measured force–strain curves from CSV files, as test machines and spreadsheets write them."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Iterator

from . import _core
from .errors import InputError
from .files import decoded, read_text
from .wording import shown

_STRAIN_UNITS = {"": 1.0, "-": 1.0, "1": 1.0, "m/m": 1.0, "mm/mm": 1.0, "%": 1e-2, "mm/m": 1e-3}
_FORCE_UNITS = {"mN": 1e-3, "N": 1.0, "daN": 10.0, "kN": 1e3}
_HEADING = re.compile(r"\s*(strain|force)\s*(?:[\[(]\s*(\S*?)\s*[\])])?\s*", re.IGNORECASE)

Row = tuple[int, list[str]]
"""Line, from 1, and cells."""


def read_curve(
    path: str | os.PathLike[str], kind: type[InputError] = InputError
) -> list[tuple[float, float]]:
    """Return the test points (strain, force [N]) in a CSV file; (0, 0) is added if no strain is 0.

    The first row names the columns with their units, `strain [%]` and `force [N]`; others are
    passed over. Raises an error of `kind`, with the line: no such file, columns or units, no
    number, points that are none of a cord.
    """
    return _Reader(read_text(path, kind), os.fspath(path), kind).points()


def curve_in(data: bytes, name: str) -> list[tuple[float, float]]:
    """Return the test points in what a CSV file holds, as `read_curve` does.

    Raises `InputError` as there; `name` is what it calls the file.
    """
    return _Reader(decoded(data, name), name, InputError).points()


class _Reader:
    def __init__(self, text: str, path: str, kind: type[InputError]) -> None:
        self._text = text
        self._path = path
        self._kind = kind

    def points(self) -> list[tuple[float, float]]:
        rows = self._rows()
        first = next(rows, None)
        if first is None:
            raise self._error('is empty; begin with a row such as "strain [%],force [N]"')
        columns = self._columns(*first)
        points: list[tuple[float, float]] = []
        lines: list[int] = []
        for line, cells in rows:
            strain, force = (self._number(line, cells, *column) for column in columns)
            points.append((strain, force))
            lines.append(line)
        if points and not any(strain == 0 for strain, _ in points):
            place = sum(strain < 0 for strain, _ in points)
            points.insert(place, (0.0, 0.0))
            lines.insert(place, lines[min(place, len(lines) - 1)])
        self._check(points, lines)
        return points

    def _rows(self) -> Iterator[Row]:
        """Yield the rows with something in them; a row that begins with # is a remark."""
        lines = [
            (number, line)
            for number, line in enumerate(self._text.splitlines(), start=1)
            if line.strip() and not line.lstrip().startswith("#")
        ]
        heading = lines[0][1] if lines else ""
        self._separator = max(";\t,", key=heading.count)
        for number, line in lines:
            yield number, next(csv.reader([line], delimiter=self._separator))

    def _columns(self, line: int, cells: list[str]) -> list[tuple[str, int, float]]:
        """Return name, place and unit of the columns of strain and force."""
        found: dict[str, tuple[str, int, float]] = {}
        for place, cell in enumerate(cells):
            if not (heading := _HEADING.fullmatch(cell)):
                continue
            name, unit = heading[1].lower(), heading[2] or ""
            units = _STRAIN_UNITS if name == "strain" else _FORCE_UNITS
            if unit not in units:
                known = ", ".join(word for word in units if word)
                what = f"the unit {shown(unit)}" if unit else "no unit"
                raise self._error(f"{name} has {what}; write one of {known} in brackets", line)
            if name in found:
                raise self._error(f"has two columns of {name}; remove one", line)
            found[name] = name, place, units[unit]
        for name in ("strain", "force"):
            if name not in found:
                problem = (
                    f'has no column of {name}; begin with a row such as "strain [%],force [N]"'
                )
                raise self._error(problem, line)
        return [found["strain"], found["force"]]

    def _number(self, line: int, cells: list[str], name: str, place: int, unit: float) -> float:
        cell = cells[place].strip() if place < len(cells) else ""
        # Where a comma does not part cells, it may part a number.
        text = cell if self._separator == "," else cell.replace(",", ".")
        try:
            number = float(text) * unit
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            what = shown(cell) if cell else "empty"
            raise self._error(f"the {name} is {what}; write a finite number", line)
        return number

    def _check(self, points: list[tuple[float, float]], lines: list[int]) -> None:
        try:
            _core.ForceStrainCurve([list(point) for point in points])
        except _core.CoreError as error:
            problem = str(error.args[1])
            if point := re.match(r"point (\d+) ", problem):
                problem = problem.replace(point[0], "the point ", 1)
                place = int(point[1])
            else:
                place = len(lines) - 1
            line = lines[place] if lines else None
            raise self._error(f"{problem}; correct the points", line) from None

    def _error(self, problem: str, line: int | None = None) -> InputError:
        return self._kind(problem, file=self._path, line=line)
