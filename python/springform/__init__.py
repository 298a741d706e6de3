"""springFORM: design tensile nets whose topology differs from place to place.

import springform as sf

design = sf.load("three-cylinders")
equilibrium = design.solve()
run = sf.evolve(design, population=150, generations=300, types=(1, 6), seed=1)
sf.save(run.best, "evolved.toml")
"""

from ._core import __version__
from .comparison import Comparison, Moved, compare
from .derivatives import Gradient, Response, Sensitivity, sensitivity
from .design import Aperture, Cells, Design, Measures, load, save
from .distil import Distilled, distil, save_library
from .equalisation import Equalised, EqualiseStep, equalise
from .errors import DesignError, InputError, RunError, SpringformError
from .evolution import Progress, SeekStep, evolve, resume, seek
from .files import WriteError
from .grafting import (
    Grafted,
    Lifted,
    Skipped,
    anchor_peaks,
    best_anchor,
    edit_orbit,
    graft,
    lift,
    symmetries,
)
from .network import Equilibrium, Network, Rod, animate, residuals, solve
from .parameters import Parameters
from .patch_file import Patch, PatchError, load_patch, save_patch
from .readings import Reading, read_spring
from .run import Run, open_run
from .scenes import names as scene_names
from .selections import SelectionError, select
from .spring_laws import Curve

__all__ = [
    "Aperture",
    "Cells",
    "Comparison",
    "Curve",
    "Design",
    "DesignError",
    "Distilled",
    "EqualiseStep",
    "Equalised",
    "Equilibrium",
    "Gradient",
    "Grafted",
    "InputError",
    "Lifted",
    "Measures",
    "Moved",
    "Network",
    "Parameters",
    "Patch",
    "PatchError",
    "Progress",
    "Reading",
    "Response",
    "Rod",
    "Run",
    "RunError",
    "SeekStep",
    "SelectionError",
    "Sensitivity",
    "Skipped",
    "SpringformError",
    "WriteError",
    "__version__",
    "anchor_peaks",
    "animate",
    "best_anchor",
    "compare",
    "distil",
    "edit_orbit",
    "equalise",
    "evolve",
    "graft",
    "lift",
    "load",
    "load_patch",
    "open_run",
    "read_spring",
    "residuals",
    "resume",
    "save",
    "save_library",
    "save_patch",
    "scene_names",
    "seek",
    "select",
    "sensitivity",
    "solve",
    "symmetries",
]
