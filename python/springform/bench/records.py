"""Rows of figures, as tables for people and as CSV files that stay."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path

from ..files import write_atomically
from .timing import Spread


@dataclass(frozen=True)
class Row:
    """One figure of one engine on one net, and its ratio to the reference in the same rounds."""

    case: str
    """Name of the case."""
    net: str
    """What was worked on."""
    springs: int
    """Springs of it."""
    engine: str
    """Who worked."""
    figure: str
    """What the numbers are, with their unit."""
    value: Spread
    """The figure over repeats."""
    ratio: Spread | None = None
    """Over the reference, round by round."""
    reference: str = ""
    """What the ratio is over."""
    note: str = ""
    """What to know: residual, tolerance, what is included."""

    def report(self) -> dict[str, object]:
        """Return the row as plain values by name."""
        plain: dict[str, object] = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, Spread):
                prefix = "" if field.name == "value" else f"{field.name}_"
                plain |= {
                    f"{prefix}{part.name}": getattr(value, part.name) for part in fields(value)
                }
            elif value is None:
                plain |= {f"{field.name}_{part.name}": None for part in fields(Spread)}
            else:
                plain[field.name] = value
        return plain

    def heading(self) -> str:
        """Return what the row is about as one line for people."""
        return f"{self.case}: {self.net}, {self.springs} springs"

    def line(self) -> str:
        """Return the row as one line for people, to be read below its heading."""
        value = f"{_short(self.value.median)} {self.figure}"
        parts = [f"  {self.engine:<32} {value:>22} {_range(self.value):<18}"]
        if self.ratio is not None:
            over = f"{_short(self.ratio.median)} x {self.reference}"
            parts.append(f"{over} {_range(self.ratio)}")
        if self.note:
            parts.append(self.note)
        return "  ".join(parts)


def write_csv(rows: Iterable[Row], path: Path, label: str) -> None:
    """Write rows to a CSV file, whole or not at all; `label` says which code was timed.

    Raises `WriteError`: the file can't be written.
    """
    reports = [{"code": label, **row.report()} for row in rows]
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(reports[0]) if reports else ["code"])
    writer.writeheader()
    for report in reports:
        writer.writerow({name: _cell(value) for name, value in report.items()})
    write_atomically(path, text.getvalue().encode())


def _cell(value: object) -> object:
    if value is None:
        return ""
    return f"{value:.5g}" if isinstance(value, float) else value


def _range(value: Spread) -> str:
    if value.repeats == 1:
        return ""
    return f"({_short(value.minimum)} to {_short(value.maximum)})"


def _short(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
