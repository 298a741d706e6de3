"""Parameters of a run: checked, with defaults, and written into run folders."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    create_model,
)

from .errors import InputError
from .patch_file import Patch
from .wording import nearest

Weighting = Literal["unweighted", "linear", "exponential", "deep", "stress"]
DEFAULT_TYPES = {
    "recursive": ("1",),
    "extensible": ("1", "2", "3", "4", "5"),
    "dynamic": ("1", "6"),
}
"""Types that mutation draws unless told otherwise, by method."""


def parse_amount(text: object) -> tuple[bool, float]:
    """Return (is a share, number) of an amount such as ``3`` or ``5%``. Raises `ValueError`."""
    match = re.fullmatch(r"\s*(\d+)\s*|\s*(\d+(?:\.\d+)?)\s*%\s*", str(text), re.ASCII)
    if match is None:
        raise ValueError("must be a number of cells such as 3, or a percentage such as 5%")
    count, percentage = match.groups()
    if count is not None:
        if int(count) > 1_000_000:
            raise ValueError("must be at most 1000000 cells")
        return False, float(int(count))
    if float(percentage) > 100:
        raise ValueError("must be at most 100%")
    return True, float(percentage) / 100


def _check_amount(text: str) -> str:
    parse_amount(text)
    return text.replace(" ", "")


Amount = Annotated[str, BeforeValidator(str), AfterValidator(_check_amount)]


class Parameters(BaseModel):
    """Parameters of the hybrid evolutionary algorithm (the paper, sections 3.3 to 3.6)."""

    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True
    )

    population: Annotated[int, Field(ge=1, le=1_000_000)] = 150
    """Mutants a generation."""
    generations: Annotated[int, Field(ge=0, le=2**31)] = 300
    """Most generations."""
    seed: Annotated[int, Field(ge=0, lt=2**64)] = 1
    """Seed of all random draws."""
    types: Annotated[tuple[str, ...], Field(min_length=1, strict=False)] = ("1", "6")
    """Cell types that mutation draws."""
    weighting: Weighting = "exponential"
    """How cells are weighted when they are drawn."""
    weight_base: Annotated[float, Field(ge=1)] = 4.0
    """Base of the exponential weighting."""
    weight_exponent: Annotated[float, Field(ge=0)] = 1.0
    """Exponent on linear, deep and stress weights."""
    insertions: Amount = "3"
    """Step 1: cells that are subdivided, a number or a percentage."""
    switches: Amount = "3"
    """Step 2: cells that switch type."""
    toggles: Amount = "1"
    """Step 3: subdivisions that are turned off or on."""
    fitness: Literal["suf", "differential"] = "suf"
    """What the best individual has least of."""
    suf_reference: Literal["start", "parent", "zero"] = "start"
    """What the spring utilization factor is measured against."""
    niche: Annotated[int, Field(ge=0, lt=2**32)] | None = None
    """Compare only individuals within this many springs of the generation's median."""
    self_adapt: bool = False
    """Amounts and weighting belong to the individual and mutate with it."""
    min_length: Annotated[float, Field(gt=0)] | None = None
    """Shortest spring allowed [m]; individuals with a shorter one do not win."""
    min_springs: Annotated[int, Field(ge=1, lt=2**32)] | None = None
    """Fewest springs allowed; individuals with fewer do not win."""
    max_springs: Annotated[int, Field(ge=1, lt=2**32)] | None = None
    """Most springs allowed; individuals with more do not win."""
    selection: Literal["comma", "plus"] = "comma"
    """Whether the parent contends: plus, or not: comma."""
    genes: Annotated[tuple[Patch, ...], Field(strict=False)] = ()
    """Patches that step 4 inserts."""
    grafts: Amount = "1"
    """Step 4: most patches that are inserted, a number or a percentage of the top-level cells."""
    symmetry: bool = False
    """Mutate by orbits, so that every individual keeps the symmetries of the framework."""
    within: Annotated[tuple[str, ...], Field(min_length=1, strict=False)] | None = None
    """Addresses of the cells within which mutation stays."""
    cell_weights: dict[str, Annotated[float, Field(ge=0, le=1e6)]] = {}
    """Factors, by address, on the chance that a cell or one that descends from it is drawn.

    The nearest one counts; 0: never drawn, nor changed by a step on the cells above it. What grew
    in a cell of a factor above 1 is turned off that much more rarely.
    """
    until_springs: Annotated[int, Field(ge=1, lt=2**32)] | None = None
    """End once the parent has this many springs."""
    until_differential: Annotated[float, Field(gt=0)] | None = None
    """End once the parent's force differential reaches this, from wherever it starts."""
    until_suf: float | None = None
    """End once the parent's spring utilization factor is this or less."""

    def strategy(self) -> tuple[tuple[bool, float], tuple[bool, float], tuple[bool, float], str]:
        """Return the strategy parameters as the core takes them."""
        amounts = (self.insertions, self.switches, self.toggles)
        insertions, switches, toggles = (parse_amount(amount) for amount in amounts)
        return insertions, switches, toggles, self.weighting

    def ending(self) -> tuple[int, int | None, float | None, float | None]:
        """Return (generations, springs, differential, suf) at which a run ends."""
        return self.generations, self.until_springs, self.until_differential, self.until_suf


def checked_parameters(values: Mapping[str, Any], method: str = "dynamic") -> Parameters:
    """Return parameters from plain values; types default by method.

    Raises `InputError`: an unknown name or a value that is not allowed.
    """
    given = {
        name: value.item() if isinstance(value, np.generic) else value
        for name, value in values.items()
    }
    if given.get("types") is None:
        given["types"] = DEFAULT_TYPES[method]
    given["types"] = _listed(given["types"])
    try:
        return _in_order(Parameters(**given))
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
    key = ".".join(str(part) for part in fault["loc"])
    if fault["type"] == "extra_forbidden":
        raise InputError(f"unknown parameter; {nearest(key, Parameters.model_fields)}", key=key)
    problem = fault["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
    raise InputError(f"{problem}, not {fault['input']!r}", key=key)


def read_parameter(name: str, text: str) -> Any:
    """Return the value of a parameter from text; ``none`` takes a limit away.

    Raises `InputError`: there is no such parameter, or this is no value of it.
    """
    if name not in Parameters.model_fields:
        raise InputError(f"unknown parameter; {nearest(name, Parameters.model_fields)}", key=name)
    field = Parameters.model_fields[name]
    if text == "none" and field.default is None:
        return None
    if name == "types":
        return _listed(text)
    make: Any = create_model
    try:
        one = make("One", value=(field.annotation, field))
        return one.model_validate_strings({"value": text}).value
    except ValidationError as error:
        problem = error.errors(include_url=False)[-1]["msg"].removeprefix("Value error, ")
        raise InputError(f"{problem}, not {text!r}", key=name) from None


def _in_order(parameters: Parameters) -> Parameters:
    least, most = parameters.min_springs, parameters.max_springs
    if least is not None and most is not None and least > most:
        raise InputError(f"must be at most max_springs, {most}, not {least}", key="min_springs")
    return parameters


def _listed(types: Any) -> tuple[str, ...]:
    """Types as one text with commas, as one number, or as a list."""
    if isinstance(types, (str, int)):
        types = str(types).split(",")
    try:
        return tuple(str(kind).strip() for kind in types)
    except TypeError:
        raise InputError(f"must be a list of cell types, not {types!r}", key="types") from None
