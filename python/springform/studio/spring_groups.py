"""Laws, unstressed lengths and senses of some springs, said as groups of the design file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..design import Design
from ..errors import InputError
from ..rigging_schema import LAWS, REST_LENGTHS, SpringGroup
from .changes import Action, value_action, value_at, values_of
from .editing_messages import DropSprings, SetSprings, SpringGroupLine

_CHOICE = ("parts", "types", "levels", "along", "pairs")
"""Keys of a group that say which springs are in it."""

_SECTIONS = ("diameter", "area")

_PATH: list[str | int] = ["springs", "groups"]

_WORDS = {
    "stiffness": "k = {} N/m",
    "axial_stiffness": "EA = {} N",
    "force_density": "q = {} N/m",
    "force": "T = {} N",
    "curve": "a measured curve",
    "rest_length": "L0 = {} m",
    "rest_ratio": "L0 = {} × drawn",
    "prestress": "prestress {} N",
    "sense": "{}",
    "diameter": "⌀ {} m",
    "area": "A = {} m²",
    "self_weight": "{} N/m",
    "thermal_expansion": "α = {} /K",
    "temperature": "{} K warmer",
}
"""How a property is told in a line."""


def set_springs(design: Design, request: SetSprings) -> Action:
    """Return the action that says something of some springs; None takes back what was said.

    What is said is the last word: springs that other groups have, too, follow it.
    """
    choice = {key: list(value) for key in _CHOICE if (value := getattr(request.choice, key))}
    unknown = set(request.says) - (set(SpringGroup.model_fields) - {*_CHOICE, "name"})
    if unknown or not request.says:
        raise InputError("is nothing that springs have", key=", ".join(sorted(unknown)) or "says")
    groups = _groups(design)
    label = f"{_title(choice).capitalize()}: {_told(request.says) or 'as they were'}"
    return value_action(design, label[:200], _PATH, merged(groups, choice, request.says))


def drop_springs(design: Design, request: DropSprings) -> Action:
    """Return the action that removes a group."""
    groups = _groups(design)
    if request.group >= len(groups):
        raise InputError(f"there are {len(groups)} groups, from 0", key="group")
    label = f"Take back: {_title(groups[request.group])}"
    return value_action(design, label, _PATH, groups[: request.group] + groups[request.group + 1 :])


def group_lines(design: Design) -> list[SpringGroupLine]:
    """Return the groups of a design as lines for people, in order."""
    return [
        SpringGroupLine(title=group.get("name") or _title(group), says=_told(group))
        for group in _groups(design)
    ]


def merged(
    groups: Sequence[Mapping[str, Any]], choice: Mapping[str, Any], says: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Return groups with one more word on the springs of a choice, and without what it outdoes.

    A property of a spring comes from the last group that has the spring and says something of
    the property, so what the same springs are told further up can go.
    """
    outdone = set(says)
    for rivals in (LAWS, REST_LENGTHS, _SECTIONS):
        if outdone & set(rivals):
            outdone |= set(rivals)
    if {"force", "force_density"} & {key for key, value in says.items() if value is not None}:
        outdone |= set(REST_LENGTHS)
    kept = [left for group in groups if (left := _without(group, choice, outdone))]
    said = {key: value for key, value in says.items() if value is not None}
    if said and kept and _same(_chosen(kept[-1]), choice):
        kept[-1] = kept[-1] | said
    elif said:
        kept.append({**choice, **said})
    return kept


def _without(
    group: Mapping[str, Any], choice: Mapping[str, Any], outdone: set[str]
) -> dict[str, Any]:
    """Return what is left of a group; nothing if none of its words counts any more."""
    left = dict(group)
    own = _chosen(group)
    if _same(own, choice):
        left = {key: value for key, value in group.items() if key not in outdone}
    elif set(own) == set(choice) == {"pairs"} and _properties(group) <= outdone:
        chosen = _ends(choice["pairs"])
        left["pairs"] = [pair for pair in own["pairs"] if not _ends([pair]) <= chosen]
        if not left["pairs"]:
            return {}
    return left if _properties(left) else {}


def _groups(design: Design) -> list[dict[str, Any]]:
    groups = value_at(values_of(design), _PATH)
    return [{key: value for key, value in group.items() if value is not None} for group in groups]


def _chosen(group: Mapping[str, Any]) -> dict[str, Any]:
    return {key: group[key] for key in _CHOICE if key in group}


def _properties(group: Mapping[str, Any]) -> set[str]:
    return set(group) - {*_CHOICE, "name"}


def _same(first: Mapping[str, Any], second: Mapping[str, Any]) -> bool:
    def sets(choice: Mapping[str, Any]) -> dict[str, set[Any]]:
        return {
            key: set(_ends(value)) if key == "pairs" else {str(one) for one in value}
            for key, value in choice.items()
        }

    return sets(first) == sets(second)


def _ends(pairs: Sequence[str]) -> set[frozenset[str]]:
    return {frozenset(pair.split()) for pair in pairs}


def _title(group: Mapping[str, Any]) -> str:
    """Return which springs a choice means."""
    words = [", ".join(group["parts"])] if "parts" in group else []
    if "types" in group:
        words.append("type " + ", ".join(map(str, group["types"])))
    if "levels" in group:
        words.append("level " + ", ".join(map(str, group["levels"])))
    if "along" in group:
        lines = {"ring": "free rings", "seam": "seams"}
        words.append(", ".join(lines.get(line, line) for line in group["along"]))
    if "pairs" in group:
        count = len(group["pairs"])
        words.append("one spring" if count == 1 else f"{count} springs")
    return ", ".join(words) or "all springs"


def _told(says: Mapping[str, Any]) -> str:
    words = []
    for key, form in _WORDS.items():
        if (value := says.get(key)) is not None:
            number = isinstance(value, (int, float)) and not isinstance(value, bool)
            words.append(form.format(f"{value:g}" if number else value))
    return " · ".join(words)
