"""Runs: what an evolution made, read from its folder and rebuilt."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from . import _core
from .design import Design
from .errors import DesignError, InputError, RunError
from .parameters import Parameters, checked_parameters, parse_amount
from .run_format import (
    ChangeLine,
    GenerationLine,
    as_numpy,
    broken,
    complete_generations,
    parts_of,
    read_design,
    read_journal,
    read_part,
    read_settings,
)

STRATEGY = frozenset({"insertions", "switches", "toggles", "weighting"})
"""Parameters that individuals may have of their own."""

Table = dict[str, NDArray[Any]]
"""Columns by name, one row an individual in order of generation and index; undefined is NaN."""


class Run:
    """A run folder, as far as it is complete.

    Attributes: `folder`, `design` (the start), `parameters`, `generations` (made so far), `lines`
    (of the journal).
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        """Open a run folder. Raises `RunError`: it holds no run, or a broken one."""
        self.folder = Path(folder)
        self._settings = read_settings(self.folder)
        self.design = read_design(self.folder, self._settings)
        lines, parts = read_journal(self.folder), parts_of(self.folder)
        self.generations = complete_generations(lines, parts)
        self.lines = [line for line in lines if line.generation <= self.generations]
        self._parts = [part for part in parts if part[1] <= self.generations]
        self.parameters = self.parameters_after(self.generations)

    @property
    def parents(self) -> list[int | None]:
        """Index of the winner of every generation; None where the parent stayed."""
        return [line.parent for line in self._chosen]

    @property
    def stayed(self) -> int:
        """Number of generations in which the parent stayed, because nobody was better or fit."""
        return sum(parent is None for parent in self.parents)

    @property
    def _chosen(self) -> list[GenerationLine]:
        return [line for line in self.lines if isinstance(line, GenerationLine)]

    @cached_property
    def table(self) -> Table:
        """Measures of every individual. Raises `RunError`: a file of measures is broken."""
        population = self.parameters.population
        tables = [read_part(*part, population) for part in self._parts]
        if not tables:
            return {}
        merged = pa.concat_tables(tables)
        return {name: as_numpy(merged.column(name)) for name in merged.column_names}

    @property
    def best(self) -> Design:
        """The final parent."""
        return self.parent(self.generations)

    def parent(self, generation: int) -> Design:
        """Return the parent chosen in a generation; 0 is the start with its filters applied."""
        self._check_generation(generation, first=0)
        lines = self._chosen[:generation]
        edits = [edit for line in lines for edit in line.edits]
        parent = self._changed(self.design.closed, edits, f"generation {generation}")
        winners = [(line.generation, line.parent) for line in lines if line.parent is not None]
        if winners:
            self._check_individual(parent, *winners[-1])
        return parent

    def individual(self, generation: int, individual: int) -> Design:
        """Rebuild any individual that was ever evaluated. Raises `RunError`: there is no such."""
        self._check_generation(generation, first=1)
        if not 0 <= individual < self.parameters.population:
            last = self.parameters.population - 1
            raise RunError(f"there is no individual {individual}; there are 0 to {last}")
        parent = self.parent(generation - 1)
        edits = self.evolution(generation - 1, threads=1).individual(individual)
        name = f"generation {generation}, individual {individual}"
        rebuilt = self._changed(parent, edits, name)
        self._check_individual(rebuilt, generation, individual)
        return rebuilt

    @property
    def start(self) -> dict[str, Any]:
        """Springs, force differential and SUF of the start."""
        springs, differential = self._settings.start
        return {"springs": springs, "force_differential": differential, "suf": None}

    @property
    def final(self) -> dict[str, Any]:
        """Springs, force differential and SUF of the final parent."""
        if not self._chosen:
            return self.start
        last = self._chosen[-1]
        return {name: getattr(last, name) for name in ("springs", "force_differential", "suf")}

    @property
    def lowest(self) -> tuple[int, int] | None:
        """(generation, individual) of the lowest force differential; None if there is none.

        The start does not count, nor do individuals with springs below the minimum length.
        """
        row = self._lowest_row()
        return None if row is None else (self._at("generation", row), self._at("individual", row))

    @property
    def lowest_standing(self) -> dict[str, Any]:
        """Springs, force differential and SUF of `lowest`; of the start if there is none."""
        row = self._lowest_row()
        if row is None:
            return self.start
        suf = float(self.table["suf"][row])
        return {
            "springs": self._at("springs", row),
            "force_differential": float(self.table["force_differential"][row]),
            "suf": None if np.isnan(suf) else suf,
        }

    def pareto(self) -> NDArray[np.int64]:
        """Return the rows of the Pareto set: no other has as many springs at a lower differential.

        Ascending in springs and force differential.
        """
        table = self.table
        if not table:
            return np.empty(0, dtype=np.int64)
        rows = np.flatnonzero(~np.isnan(table["force_differential"]))
        differential, springs = table["force_differential"][rows], table["springs"][rows]
        order = np.lexsort((rows, differential, -springs.astype(np.int64)))
        lowest = np.minimum.accumulate(np.concatenate(([np.inf], differential[order][:-1])))
        front: NDArray[np.int64] = rows[order[differential[order] < lowest]][::-1]
        return front

    def digest(self) -> str:
        """Return a hash of the final genotype and of the whole table of measures."""
        state = hashlib.sha256()
        cells, added, cut = self.design.setting.notation(self.best.forest, "")
        state.update(json.dumps([cells, added, cut]).encode())
        for name, column in self.table.items():
            state.update(name.encode())
            state.update(
                np.ascontiguousarray(column).astype(column.dtype.newbyteorder("<")).tobytes()
            )
        return state.hexdigest()

    def evolution(self, generation: int, *, threads: int) -> _core.Evolution:
        """Return the algorithm as it stood after a generation."""
        self._check_generation(generation, first=0)
        line = self._chosen[generation - 1] if generation else None
        # Amounts and weighting that were changed here hold in place of the parent's own.
        changed = self.changed_after(generation) & STRATEGY
        own = line.strategy if line and not changed else None
        return start_evolution(
            self.parent(generation),
            self.parameters_after(generation),
            threads=threads,
            strategy=own,
            resumed=(generation, self._settings.start, line.suf if line else None),
        )

    def _changed(self, design: Design, edits: Sequence[str], name: str) -> Design:
        try:
            return design.edited(edits).renamed(f"{self.design.name}, {name}")
        except DesignError as error:
            problem = f"does not lead to {name}: {error.message}"
            raise broken(self.folder / "journal.jsonl", problem) from None

    def _check_individual(self, design: Design, generation: int, individual: int) -> None:
        fingerprints = self.table["fingerprint"][self.table["generation"] == generation]
        if design.forest.fingerprint not in fingerprints[individual : individual + 1]:
            problem = f"does not lead to individual {individual} of generation {generation}"
            raise broken(self.folder / "journal.jsonl", problem)

    @property
    def generation_lines(self) -> list[GenerationLine]:
        """Lines of the journal that say what each generation chose."""
        return self._chosen

    def changed_after(self, generation: int) -> set[str]:
        """Return the names of the parameters that were changed after a generation."""
        return {
            name
            for line in self.lines
            if isinstance(line, ChangeLine) and line.generation == generation
            for name in line.parameters
        }

    def parameters_after(self, generation: int) -> Parameters:
        """Return the parameters of the generation that follows one."""
        values = dict(self._settings.parameters)
        for line in self.lines:
            if isinstance(line, ChangeLine) and line.generation <= generation:
                values |= line.parameters
        try:
            return checked_parameters(values, self.design.file.method)
        except InputError as error:
            path = self.folder / "run.json"
            raise RunError(error.message, file=path, key=f"parameters.{error.key}") from None

    def _lowest_row(self) -> int | None:
        if not self.table:
            return None
        table, limits = self.table, self.parameters
        differential = table["force_differential"].copy()
        if limits.min_length is not None:
            differential[table["shortest_spring"] < limits.min_length] = np.nan
        if limits.min_springs is not None:
            differential[table["springs"] < limits.min_springs] = np.nan
        if limits.max_springs is not None:
            differential[table["springs"] > limits.max_springs] = np.nan
        return None if np.isnan(differential).all() else int(np.nanargmin(differential))

    def _at(self, column: str, row: int) -> int:
        return int(self.table[column][row])

    def _check_generation(self, generation: int, first: int) -> None:
        if not first <= generation <= self.generations:
            raise RunError(
                f"there is no generation {generation}; there are {first} to {self.generations}",
                file=self.folder,
            )


def open_run(folder: str | os.PathLike[str]) -> Run:
    """Open a run folder. Raises `RunError`: it holds no run, or a broken one."""
    return Run(folder)


def start_evolution(
    design: Design,
    parameters: Parameters,
    *,
    threads: int,
    strategy: Any = None,
    resumed: Any = None,
) -> _core.Evolution:
    """Return the algorithm at a design. Raises `DesignError`: it gives no net."""
    # A design that gives no net says why, with file and key.
    design.network()
    within = parameters.within
    try:
        types = [design.setting.cell_type(kind) for kind in parameters.types]
        return _core.Evolution(
            design.setting,
            design.forest,
            population=parameters.population,
            seed=parameters.seed,
            types=types,
            strategy=parameters.strategy() if strategy is None else strategy,
            base=parameters.weight_base,
            exponent=parameters.weight_exponent,
            self_adapt=parameters.self_adapt,
            fitness=parameters.fitness,
            suf_reference=parameters.suf_reference,
            niche=parameters.niche,
            min_length=parameters.min_length,
            min_springs=parameters.min_springs,
            max_springs=parameters.max_springs,
            selection=parameters.selection,
            threads=threads,
            genes=[gene.core() for gene in parameters.genes],
            grafts=parse_amount(parameters.grafts),
            symmetries=_core.Symmetries(design.setting) if parameters.symmetry else None,
            within=None if within is None else _core.Selection(design.mesh, list(within)),
            cell_weights=list(parameters.cell_weights.items()),
            resumed=resumed,
        )
    except _core.CoreError as error:
        key, problem = error.args
        raise InputError(problem, key=key) from None
