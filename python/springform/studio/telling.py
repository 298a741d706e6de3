"""What windows are told of designs and their motion: figures, cell types, frames, pictures."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from .. import _core
from ..arrays import Floats
from ..design import Design
from ..design_schema import BUILT_IN_CELL_TYPES
from ..network import Equilibrium
from .figure_messages import Figures
from .frame_messages import MotionHeader
from .frames import encode, net_frame, tables_of
from .messages import CellTypeChoice
from .motion import State


def figures_of(design: Design) -> Figures:
    """Return the measures of a design at equilibrium."""
    equilibrium = design.solve()
    measures = asdict(design.measure(equilibrium))
    chosen = {name: measures[name] for name in Figures.model_fields if name in measures}
    return Figures(**chosen, converged=equilibrium.converged, reason=equilibrium.reason)


def cell_types_of(design: Design) -> list[CellTypeChoice]:
    """Return the cell types that a design's method allows."""
    names = dict(enumerate(BUILT_IN_CELL_TYPES))
    words = {str(number): name for number, name in names.items()}
    words |= {name: name for name in design.file.cell_types}
    found = []
    for word, name in words.items():
        try:
            design.setting.cell_type(word)
        except _core.CoreError:
            continue
        found.append(CellTypeChoice(word=word, name=name))
    return found


def motion_frame(state: State, design: Design) -> bytes:
    """Return the frame of a state of motion."""
    residual = float(state.residual)
    header = MotionHeader(
        revision=state.revision,
        steps=state.steps,
        running=state.running,
        settled=state.settled,
        converged=state.converged,
        residual=residual if np.isfinite(residual) else None,
        reason=state.reason,
        held=list(state.held),
        held_by=_sizes(state.reactions[list(state.held)]),
        waited=state.waited,
        took=state.took,
        arrays=[],
    )
    with np.errstate(over="ignore"):
        arrays = {
            "positions": state.positions.astype(np.float32).reshape(-1),
            "forces": state.forces.astype(np.float32),
            "reactions": state.reactions[design.anchors].astype(np.float32).reshape(-1),
        }
    return encode(header, arrays)


def _sizes(vectors: Floats) -> list[float]:
    sizes: list[float] = np.nan_to_num(np.linalg.norm(vectors, axis=1)).tolist()
    return sizes


def state_of(equilibrium: Equilibrium, revision: int) -> State:
    """Return the state of a net that rests at equilibrium."""
    return State(
        revision=revision,
        positions=equilibrium.positions,
        forces=equilibrium.forces,
        reactions=equilibrium.reactions,
        steps=0,
        running=False,
        settled=True,
        converged=equilibrium.converged,
        residual=equilibrium.residual,
        reason=equilibrium.reason,
        held=(),
    )


def picture_of(design: Design) -> bytes:
    """Return the net of a design at equilibrium: the net frame's length, it, and a motion frame."""
    state = state_of(design.solve(), 1)
    net = net_frame(design, tables_of(design), 1, None)
    return len(net).to_bytes(4, "little") + net + motion_frame(state, design)
