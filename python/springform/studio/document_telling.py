"""What windows are told of a document."""

from __future__ import annotations

from ..design import Design
from .changes import values_of
from .figure_messages import Figures
from .journal import Journal
from .messages import AnchorState, DocumentState, HistoryLine
from .run_messages import Looked
from .spring_groups import group_lines
from .telling import cell_types_of

_HISTORY_SHOWN = 200
"""Actions on each side of the position that windows are told."""


def document_state(
    journal: Journal,
    shown: Design,
    *,
    saved: bool,
    revision: int,
    figures: Figures,
    own: Figures,
    before: Figures | None,
    looking: Looked | None,
) -> DocumentState:
    """Return the document's state; `shown` is its design or what is looked at instead."""
    document = journal.document
    design = document.design
    first = max(0, document.position - _HISTORY_SHOWN)
    actions = document.actions[first : document.position + _HISTORY_SHOWN]
    values = values_of(design)
    return DocumentState(
        document=journal.folder.name,
        name=design.name,
        file=journal.settings.file,
        saved=saved,
        method=design.file.method,
        revision=revision,
        position=document.position,
        length=len(document.actions),
        history=[
            HistoryLine(label=action.label, number=number, origin=action.origin)
            for number, action in enumerate(actions, start=first + 1)
        ],
        figures=figures,
        own=own,
        before=before,
        looking=looking,
        anchors=_anchors(design, shown),
        cell_types=cell_types_of(design),
        framework=values["framework"],
        stiffness=values["springs"]["stiffness"],
        ring_factor=values["springs"]["ring_factor"],
        spring_groups=group_lines(design),
    )


def _anchors(design: Design, shown: Design) -> list[AnchorState]:
    anchors = zip(
        design.anchor_names,
        shown.anchors.tolist(),
        design.file.framework.anchors,
        strict=True,
    )
    return [
        AnchorState(
            name=name,
            node=shown.nodes[node],
            position=list(anchor.position),
            holds=anchor.holds,
            line=None if anchor.line is None else list(anchor.line),
            plane=None if anchor.plane is None else list(anchor.plane),
        )
        for name, node, anchor in anchors
    ]
