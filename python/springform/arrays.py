"""Arrays of numbers as callers give them: checked, converted, read-only."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError

Floats = NDArray[np.float64]


def wrong_shape(name: str, shape: tuple[int, ...], expected: str) -> InputError:
    """Return the error of an array of another shape."""
    return InputError(f"has shape {shape}, not {expected}", key=name)


def _array(name: str, values: ArrayLike, dtype: Any = None) -> NDArray[Any]:
    try:
        return np.asarray(values, dtype=dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"is no array of numbers: {error}", key=name) from None


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return a contiguous view of an array that can't be written."""
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


def numbers(name: str, values: ArrayLike, shape: tuple[int | None, ...]) -> Floats:
    """Return values as a read-only array of a shape, None being any size; one number is for all.

    Raises `InputError`: no numbers, or another shape.
    """
    array = _array(name, values, np.float64)
    if array.ndim == 0 and None not in shape:
        array = np.full(shape, array)  # type: ignore[arg-type]
    fits = array.ndim == len(shape) and all(
        wanted is None or wanted == found for wanted, found in zip(shape, array.shape, strict=True)
    )
    if not fits:
        words = ", ".join("n" if size is None else str(size) for size in shape)
        raise wrong_shape(name, array.shape, f"({words})" if len(shape) > 1 else f"({words},)")
    return read_only(array)


def node_numbers(name: str, values: ArrayLike, nodes: int) -> NDArray[np.uint32]:
    """Return values as numbers of nodes. Raises `InputError`: no numbers of nodes."""
    array = _array(name, values)
    if array.size == 0:
        array = array.reshape(0, 2).astype(np.uint32)
    if not np.issubdtype(array.dtype, np.integer):
        raise InputError("must hold whole numbers of nodes", key=name)
    if array.size and (array.min() < 0 or array.max() >= nodes):
        raise InputError(f"names a node that does not exist; there are {nodes}, from 0", key=name)
    return read_only(array.astype(np.uint32, copy=False))


def mask_of(fixed: ArrayLike, nodes: int) -> NDArray[np.bool_]:
    """Return one bool a node, from such or from the numbers of the nodes.

    Raises `InputError`: neither.
    """
    array = _array("fixed", fixed)
    if array.dtype == np.bool_:
        if array.shape != (nodes,):
            raise wrong_shape("fixed", array.shape, f"({nodes},)")
        return read_only(array)
    held = node_numbers("fixed", array.reshape(-1), nodes)
    mask = np.zeros(nodes, dtype=np.bool_)
    mask[held.reshape(-1)] = True
    return read_only(mask)


def axes_of(mask: NDArray[np.bool_], single: Iterable[tuple[int, str]]) -> NDArray[np.bool_]:
    """Return which axes hold each node, (n, 3): all of those in the mask, and single ones.

    Raises `InputError`: no such node or axis.
    """
    axes = np.repeat(mask[:, None], 3, axis=1)
    for node, axis in single:
        if axis not in ("x", "y", "z") or not 0 <= node < len(mask):
            raise InputError(
                f"must be a node and x, y or z, not {(node, axis)!r}", key="fixed_axes"
            )
        axes[node, "xyz".index(axis)] = True
    return read_only(axes)
