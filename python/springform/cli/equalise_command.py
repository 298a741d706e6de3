"""The command that tunes stiffness: equalise."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from .. import results
from ..design import Design, load, save
from ..equalisation import BOUNDS, ITERATIONS, Equalised, EqualiseStep, equalise
from ..errors import InputError
from ..files import WriteError
from .terminal import DesignArgument, Json, print_report, progress_bar, say, update_bar

commands = typer.Typer()


@commands.command(
    "equalise",
    epilog="Example: `springform equalise three-cylinders --bounds 0.25,4 --out even.toml`",
)
def equalise_command(
    design: DesignArgument,
    bounds: Annotated[
        str | None,
        typer.Option(help="Smallest and largest factor on the stiffness; by default 0.25,4."),
    ] = None,
    values: Annotated[
        str | None,
        typer.Option(help="The only factors allowed, instead of bounds: 1,2,4 for doubled cords."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="The tuned design, a .toml or .json file, or a table of factors and forces, .csv."
        ),
    ] = None,
    iterations: Annotated[int, typer.Option(min=0, help="Most steps.")] = ITERATIONS,
    as_json: Json = False,
) -> None:
    """Tune the stiffness of every spring, within bounds, so that forces even out.

    A stiffer spring is a heavier or a doubled cord. The topology stays as it is.
    """
    if bounds is not None and values is not None:
        raise InputError("stands instead of --bounds; leave one of the two out", key="--values")
    limits = BOUNDS if bounds is None else _factors("--bounds", bounds)
    if len(limits) != 2:
        raise InputError(f"must be two factors such as 0.25,4, not {bounds}", key="--bounds")
    allowed = None if values is None else _factors("--values", values)
    if out is not None:
        _check_writable(out)
    net = load(design)
    with progress_bar("equalising") as progress:
        task = progress.add_task("equalising", total=None, springs="–", differential="–")

        def tell(step: EqualiseStep) -> None:
            update_bar(
                progress, task, step.iterations, step.springs, float(step.force_differential)
            )

        try:
            tuned = equalise(
                net,
                bounds=(limits[0], limits[1]),
                values=allowed,
                iterations=iterations,
                on_step=tell,
            )
        except InputError as error:
            raise _named(error, design) from None
    if out is not None:
        _write(tuned, net, out)
    factors = tuned.factors[tuned.cords]
    report = {
        "springs": len(tuned.cords),
        "force_differential": {"before": tuned.before, "after": tuned.after},
        "stiffness_factor": {
            "min": float(factors.min()),
            "max": float(factors.max()),
        },
        "iterations": tuned.iterations,
        "converged": tuned.converged,
        "seconds": tuned.seconds,
    }
    if allowed is not None:
        kinds, counts = np.unique(factors, return_counts=True)
        report["springs_by_factor"] = {
            f"{kind:g}": int(count) for kind, count in zip(kinds, counts, strict=True)
        }
    print_report(report, as_json)
    if not tuned.converged:
        say(f"stopped after {tuned.iterations} steps; more may even forces out further")


def _factors(key: str, text: str) -> tuple[float, ...]:
    try:
        return tuple(float(word) for word in text.split(","))
    except ValueError:
        raise InputError(f"must be factors such as 0.5,1,2, not {text}", key=key) from None


def _named(error: InputError, design: str) -> InputError:
    """Say what an error is about in the command's own words."""
    if error.key in ("bounds", "values"):
        return InputError(error.message, key=f"--{error.key}")
    return InputError(error.message, file=design)


def _write(tuned: Equalised, before: Design, path: Path) -> None:
    if path.suffix.lower() == ".csv" or tuned.design is None:
        results.write_factors(before, tuned, path)
    else:
        save(tuned.design, path)


def _check_writable(path: Path) -> None:
    if path.suffix.lower() not in (".toml", ".json", ".csv"):
        raise WriteError("must end in .toml, .json or .csv", file=path)
    if not path.parent.is_dir():
        raise WriteError(f"the folder {path.parent} does not exist; make it first", file=path)
