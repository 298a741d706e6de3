"""One visual language for all pictures: colours, type, figures, and saving them."""

from __future__ import annotations

import io
import math
import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap, LinearSegmentedColormap, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import NDArray

from ..errors import printable
from ..files import WriteError, explain, write_atomically

DPI = 200
"""Resolution of the pictures."""

INK = "#1c2127"
"""Text and lines that matter."""

GREY = "#69727d"
"""Text and lines that explain."""

PALE = "#d5dae0"
"""Lines that only guide the eye."""

ACCENT = "#a3217a"
"""The one line that a chart is about; it belongs to FORCE_COLOURS and stands out from SPREAD."""

SPREAD = "#4f7cac"
"""Bands of a population's spread."""

TITLE, TEXT, SMALL = 12.0, 8.0, 7.0
"""Sizes of type [pt]."""


ROD, SLACK = "#14786b", "#8d97a2"
"""Rods and slack cords, whose colours are on no scale."""


def _part(name: str, first: float, last: float) -> Colormap:
    shades = matplotlib.colormaps[name](np.linspace(first, last, 256))
    return ListedColormap(shades, name=f"springform_{name}")


FORCE_COLOURS = _part("plasma_r", 0.26, 1.0)
"""Perceptually uniform and colour-blind-safe; on white paper the strongest springs are darkest."""

LEVEL_COLOURS: Colormap = LinearSegmentedColormap.from_list(
    "springform_levels", ["#dde5ed", "#a3bdd6", "#5f8bb8", "#2d5a8c", "#0d2646"]
)
"""Levels of cells: even steps from light to dark, not to be taken for forces."""

GENERATION_COLOURS: Colormap = ListedColormap(
    LEVEL_COLOURS(np.linspace(0.25, 1.0, 256)), name="springform_generations"
)
"""Generations, the same way, but dark enough for a single point."""

_SETTINGS = {
    "font.family": ["DejaVu Sans"],
    "font.size": TEXT,
    "text.color": INK,
    "axes.edgecolor": GREY,
    "axes.linewidth": 0.6,
    "axes.labelcolor": INK,
    "axes.labelsize": TEXT,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.minor.size": 0.0,
    "ytick.minor.size": 0.0,
    "legend.frameon": False,
    "legend.fontsize": SMALL,
    "savefig.dpi": DPI,
    "svg.hashsalt": "springform",
}


@contextmanager
def styled() -> Iterator[None]:
    """Draw with this style and nobody's own settings, so that pictures are the same everywhere."""
    settings: dict[str, Any] = {
        key: value
        for key, value in matplotlib.rcParamsDefault.items()
        if not key.startswith(("backend", "interactive", "toolbar", "webagg", "date."))
    }
    # Typed loosely: the stubs list every setting by name.
    style = matplotlib.rc_context(cast(Any, {**settings, **_SETTINGS}))
    with style, warnings.catch_warnings():
        # A name in a script that the font lacks shows as boxes; that is no reason to talk.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


def new_figure(width: float, height: float) -> Figure:
    """Return an empty white figure of a size in inches."""
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def add_axes(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Return new axes at a place in inches from the lower left corner."""
    across, up = figure.get_size_inches()
    return figure.add_axes((left / across, bottom / up, width / across, height / up))


def add_title(figure: Figure, name: str, facts: str, *, margin: float = 0.4) -> None:
    """Write the title line of a picture: what it shows, and its facts below, smaller."""
    across, up = figure.get_size_inches()
    left = margin / across
    most = int(across * 8)
    name = name if len(name) <= most else f"{name[: most - 1]}…"
    figure.text(
        left,
        1 - 0.3 / up,
        printable(name),
        fontsize=TITLE,
        fontweight="bold",
        va="top",
        parse_math=False,
    )
    figure.text(left, 1 - 0.57 / up, facts, fontsize=TEXT, color=GREY, va="top", parse_math=False)


def save(figure: Figure, folder: Path, name: str) -> Path:
    """Write a picture atomically and return its path; the same picture gives the same bytes.

    Raises `WriteError`: it can't be written.
    """
    kind = name.rsplit(".", 1)[1]
    # Dates and versions would change the bytes without changing the picture.
    metadata = {"Date": None, "Creator": "springform"} if kind == "svg" else {"Software": None}
    buffer = io.BytesIO()
    figure.savefig(buffer, format=kind, metadata=metadata)
    path = folder / name
    write_atomically(path, buffer.getvalue())
    return path


def make_folder(folder: str | os.PathLike[str]) -> Path:
    """Make a folder for pictures, if need be, and return it. Raises `WriteError`: it can't be."""
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise WriteError(f"cannot be made: {explain(error)}", file=folder) from error
    return Path(folder)


def force_norm(forces: NDArray[np.float64]) -> Normalize:
    """Return the scale of forces [N]: logarithmic if the largest is more than five times the least.

    A logarithmic scale ends at a ten-thousandth of the largest force: slack springs have no place
    on it.
    """
    finite = forces[np.isfinite(forces)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    if finite.size and high > 0 and low < high / 5:
        positive = finite[finite >= high * 1e-4]
        return LogNorm(float(positive.min()), high, clip=True)
    if not low < high:
        low, high = low - 0.5 * (abs(low) or 1.0), high + 0.5 * (abs(high) or 1.0)
    return Normalize(low, high, clip=True)


def ends(norm: Normalize) -> tuple[float, float]:
    """Return the smallest and largest value on a scale that `force_norm` made."""
    # The stubs allow for scales without ends.
    return float(cast(float, norm.vmin)), float(cast(float, norm.vmax))


def plain(value: float, _position: int | None = None) -> str:
    """Return a number as people write it, with up to three significant digits."""
    if not math.isfinite(value):
        return "undefined"
    if value != 0 and (abs(value) < 1e-4 or abs(value) >= 1e6):
        return f"{value:.3g}"
    digits = 3 if value == 0 else max(0, 2 - math.floor(math.log10(abs(value))))
    text = f"{value:,.{digits}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def count(number: int, singular: str) -> str:
    """Return a number of things in words, such as "1 spring" or "1,024 springs"."""
    return f"{number:,} {singular}{'' if number == 1 else 's'}"


def set_ticks(axis: Axis, low: float, high: float, *, log: bool, count: int = 5) -> None:
    """Give an axis few, round ticks in plain numbers: on a log scale 1-2-5 if they are few."""
    if log:
        decades = math.log10(high / low)
        subs = (1.0,) if decades > 4 else (1.0, 3.0) if decades > 2 else (1.0, 2.0, 5.0)
        axis.set_major_locator(LogLocator(base=10, subs=subs, numticks=50))
        axis.set_minor_formatter(NullFormatter())
    else:
        axis.set_major_locator(MaxNLocator(count, steps=[1, 2, 5, 10]))
    axis.set_major_formatter(FuncFormatter(plain))
