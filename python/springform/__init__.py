"""springFORM: design tensile nets whose topology differs from place to place.

import springform as sf

design = sf.load("three-cylinders")
equilibrium = design.solve()
run = sf.evolve(design, population=150, generations=300, types=(1, 6), seed=1)
sf.save(run.best, "evolved.toml")
"""

from ._core import __version__
from .derivatives import Gradient, Response, Sensitivity, sensitivity
from .design import Aperture, Cells, Design, Measures, load, save
from .equalisation import Equalised, EqualiseStep, equalise
from .errors import DesignError, InputError, RunError, SpringformError
from .evolution import Progress, SeekStep, evolve, resume, seek
from .files import WriteError
from .network import Equilibrium, Network, Rod, animate, residuals, solve
from .parameters import Parameters
from .readings import Reading, read_spring
from .run import Run, open_run
from .scenes import names as scene_names
from .spring_laws import Curve

__all__ = [
    "Aperture",
    "Cells",
    "Curve",
    "Design",
    "DesignError",
    "EqualiseStep",
    "Equalised",
    "Equilibrium",
    "Gradient",
    "InputError",
    "Measures",
    "Network",
    "Parameters",
    "Progress",
    "Response",
    "Reading",
    "Rod",
    "Run",
    "RunError",
    "SeekStep",
    "Sensitivity",
    "SpringformError",
    "WriteError",
    "__version__",
    "animate",
    "equalise",
    "evolve",
    "load",
    "open_run",
    "read_spring",
    "residuals",
    "resume",
    "save",
    "scene_names",
    "seek",
    "sensitivity",
    "solve",
]
