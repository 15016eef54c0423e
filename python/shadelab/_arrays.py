"""The dtype, shape and broadcasting policy: what every public function does with its arguments.

float32 stays float32, float64 stays float64, half promotes to single; arrays of equal standing promote as NumPy
does; lists and integers that mean coordinates become double. Kernels see C-contiguous, aligned, native arrays.
"""

from __future__ import annotations

import math
import operator
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

Floats: TypeAlias = NDArray[np.floating[Any]]
"""An array of float32 or float64."""

__all__ = [
    "Floats",
    "apart",
    "array",
    "broadcast",
    "choice",
    "coarse_step",
    "count",
    "elementwise",
    "flag",
    "floats",
    "image",
    "indices",
    "knob_array",
    "matrices",
    "number",
    "output",
    "precision",
    "progress_callback",
    "result_dtype",
    "vectors",
    "warn_if_coarse",
]


def _own_dtype(name: str, value: Any) -> np.dtype[Any] | None:
    """The precision that one argument asks for; None if it has no say (Python numbers and lists)."""
    dtype = getattr(value, "dtype", None)
    if dtype is None:
        return None
    if not isinstance(dtype, np.dtype):
        # Other libraries' arrays have dtypes of their own.
        dtype = array(name, value).dtype
    if dtype.kind in "iub":
        return np.dtype(np.float64)
    if dtype.kind != "f":
        raise TypeError(f"{name}: expected real numbers, got dtype {dtype}")
    return np.dtype(np.float64 if dtype.itemsize > 4 else np.float32)


def result_dtype(**arrays: Any) -> np.dtype[Any]:
    """The precision in which arrays of equal standing are computed together.

    Arguments that are None do not count, nor do Python numbers and lists beside an array.
    """
    own = [d for d in (_own_dtype(n, a) for n, a in arrays.items() if a is not None) if d is not None]
    return np.result_type(*own) if own else np.dtype(np.float64)


def array(name: str, value: Any) -> NDArray[Any]:
    """`value` as an array of whatever it holds; ragged lists are refused."""
    try:
        return np.asarray(value)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}: {error}") from None


def floats(name: str, value: ArrayLike, dtype: DTypeLike | None = None) -> Floats:
    """`value` as a C-contiguous array of float32 or float64 (or of the `dtype` that governs)."""
    target = np.dtype(dtype) if dtype is not None else result_dtype(**{name: value})
    given = array(name, value)
    if given.dtype.kind not in "fiub":
        raise TypeError(f"{name}: expected real numbers, got dtype {given.dtype}")
    with np.errstate(over="ignore"):
        return np.require(given, dtype=target, requirements=["C", "A"])


def vectors(name: str, value: ArrayLike, n: int = 3, dtype: DTypeLike | None = None) -> Floats:
    """`value` as vectors of `n` components, shape (..., n)."""
    given = floats(name, value, dtype)
    if given.ndim == 0 or given.shape[-1] != n:
        raise ValueError(f"{name}: expected shape (..., {n}), got {given.shape}")
    return given


def matrices(name: str, value: ArrayLike, n: int = 4, dtype: DTypeLike | None = None) -> Floats:
    """`value` as square matrices, shape (..., n, n)."""
    given = floats(name, value, dtype)
    if given.shape[-2:] != (n, n):
        raise ValueError(f"{name}: expected shape (..., {n}, {n}), got {given.shape}")
    return given


def image(name: str, value: ArrayLike, channels: int | None = None, dtype: DTypeLike | None = None) -> Floats:
    """A picture of radiometric values, (H, W) or (H, W, C); integer pictures are refused."""
    kind = getattr(value, "dtype", np.dtype(float)).kind
    if kind in "iub":
        raise TypeError(
            f"{name}: expected linear floating-point values, got an integer picture; "
            f"convert with shadelab.color.decode_transfer({name} / 255.0)"
        )
    given = floats(name, value, dtype)
    if given.ndim not in (2, 3) or (channels is not None and (given.ndim != 3 or given.shape[-1] != channels)):
        expected = "(H, W) or (H, W, C)" if channels is None else f"(H, W, {channels})"
        raise ValueError(f"{name}: expected shape {expected}, got {given.shape}")
    return given


def indices(name: str, value: ArrayLike, n: int | None = None, below: int | None = None) -> NDArray[np.int32]:
    """`value` as int32 indices, of `n` columns and in [0, below) if given; the first bad index is named."""
    given = array(name, value)
    if given.size == 0 and given.dtype.kind == "f":
        given = given.astype(np.int32)
    if given.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected integers, got dtype {given.dtype}")
    if n is not None and (given.ndim != 2 or given.shape[-1] != n):
        raise ValueError(f"{name}: expected shape (m, {n}), got {given.shape}")
    limit = np.iinfo(np.int32).max if below is None else below - 1
    if given.size and (given.min() < 0 or given.max() > limit):
        bad = (given < 0) | (given > limit)
        at = tuple(int(i) for i in np.argwhere(bad)[0])
        raise ValueError(f"{name}: index {given[at]} at {at} is out of range [0, {limit + 1})")
    return np.require(given, dtype=np.int32, requirements=["C", "A"])


def broadcast(core: dict[str, tuple[Floats, int]], *, lone: bool = False) -> tuple[tuple[int, ...], list[Floats]]:
    """Broadcasts leading axes. `core` maps a name to (array, number of trailing core axes).

    Returns the batch shape and the arrays flattened to (n, *core), C-contiguous; with `lone` those that hold but one
    item to (1, *core), for kernels that take one for all.
    """
    leads = {name: a.shape[: a.ndim - k] for name, (a, k) in core.items()}
    try:
        shape = np.broadcast_shapes(*leads.values())
    except ValueError:
        raise ValueError("cannot broadcast " + ", ".join(f"{n}: {s}" for n, s in leads.items())) from None
    size = math.prod(shape)
    flat = []
    for a, k in core.values():
        tail = a.shape[a.ndim - k :]
        if lone and math.prod(a.shape[: a.ndim - k]) == 1:
            flat.append(np.require(a.reshape((1, *tail)), requirements=["C", "A"]))
            continue
        full = a if a.shape[: a.ndim - k] == shape else np.broadcast_to(a, shape + tail)
        flat.append(np.require(full.reshape((size, *tail)), requirements=["C", "A"]))
    return shape, flat


def knob_array(name: str, value: ArrayLike, dtype: DTypeLike) -> Floats:
    """Numbers of the precision that governs; NaN is for elements of arrays, not for all."""
    given = floats(name, value, dtype)
    if given.ndim == 0 and np.isnan(given):
        raise ValueError(f"{name}: expected a number, got nan")
    return given


Core: TypeAlias = int | tuple[int, int]
"""The trailing axes of one element: 0 for a number, 3 for a vector of three, (4, 4) for a matrix."""


def elementwise(
    kernel: Callable[..., None],
    given: Mapping[str, tuple[ArrayLike, Core]],
    outputs: Sequence[Core | tuple[Core, DTypeLike]],
    *options: Any,
    knobs: dict[str, ArrayLike] | None = None,
) -> tuple[NDArray[Any], ...]:
    """Calls `kernel(*options, given, out)` on arguments of equal standing, broadcast, and gives new arrays.

    `given` maps a name to (value, core); `outputs` gives each result's core, with its dtype where that is not the
    arguments' precision. `knobs` are numbers that follow `given` and broadcast with them, but have no say in the
    precision; a single one must not be NaN.
    """
    dtype = result_dtype(**{name: value for name, (value, _) in given.items()})
    core: dict[str, tuple[Floats, int]] = {}
    for name, (value, n) in given.items():
        if isinstance(n, tuple):
            core[name] = matrices(name, value, n[0], dtype), 2
        else:
            core[name] = (vectors(name, value, n, dtype), 1) if n else (floats(name, value, dtype), 0)
    for name, knob in (knobs or {}).items():
        core[name] = (knob_array(name, knob, dtype), 0)
    shape, flat = broadcast(core)
    out = []
    for o in outputs:
        n, kind = (o, dtype) if isinstance(o, int) or isinstance(o[1], int) else o
        out.append(np.empty(shape + (n if isinstance(n, tuple) else (n,) if n else ()), kind))
    kernel(*options, flat, out)
    return tuple(out)


def output(name: str, out: NDArray[Any] | None, shape: Sequence[int], dtype: DTypeLike) -> NDArray[Any]:
    """`out` checked against shape, dtype and layout, or a new array where it is None."""
    if out is None:
        return np.empty(tuple(shape), dtype)
    if not isinstance(out, np.ndarray):
        raise TypeError(f"{name}: expected an array to write into, got {type(out).__name__}")
    if out.shape != tuple(shape) or out.dtype != np.dtype(dtype):
        raise ValueError(
            f"{name}: expected shape {tuple(shape)} and dtype {np.dtype(dtype)}, got {out.shape} and {out.dtype}"
        )
    if not (out.flags.c_contiguous and out.flags.aligned and out.flags.writeable):
        raise ValueError(f"{name}: expected a C-contiguous, writeable array")
    return out


def apart(out: NDArray[Any], *arrays: Any) -> tuple[Any, ...]:
    """The arrays, and copies of those that lie where results are written."""
    return tuple(a.copy() if np.may_share_memory(a, out) else a for a in arrays)


def number(
    name: str,
    value: Any,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    above: float | None = None,
    below: float | None = None,
) -> float:
    """A finite Python float in [low, high], and strictly between `above` and `below` if given."""
    try:
        if isinstance(value, np.complexfloating) or (isinstance(value, np.ndarray) and value.dtype.kind == "c"):
            # NumPy would drop the imaginary part with a warning.
            raise TypeError
        if isinstance(value, str | bytes | bytearray):
            # Python would read digits.
            raise TypeError
        x = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a number, got {type(value).__name__}") from None
    except OverflowError:
        raise ValueError(f"{name}: expected a number in the range of floats, got {type(value).__name__}") from None
    if not math.isfinite(x):
        raise ValueError(f"{name}: expected a finite number, got {x}")
    if x < low or x > high or (above is not None and x <= above) or (below is not None and x >= below):
        left = f"({above:g}" if above is not None else f"[{low:g}" if math.isfinite(low) else "(-inf"
        right = f"{below:g})" if below is not None else f"{high:g}]" if math.isfinite(high) else "inf)"
        raise ValueError(f"{name}: expected a number in {left}, {right}, got {x:g}")
    return x


def count(name: str, value: Any, low: int = 0, high: int | None = None) -> int:
    """An integer in [low, high]."""
    try:
        x = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: expected an integer, got {type(value).__name__}") from None
    if x < low or (high is not None and x > high):
        bound = f"at least {low}" if high is None else f"from {low} to {high}"
        raise ValueError(f"{name}: expected an integer {bound}, got {x}")
    return x


def counts(name: str, value: Any, n: int, low: int = 0, high: int | None = None) -> tuple[int, ...]:
    """`n` integers in [low, high]."""
    try:
        given = () if isinstance(value, str | bytes | dict | set) else tuple(value)
    except TypeError:
        given = ()
    if len(given) != n:
        raise TypeError(f"{name}: expected {n} integers, got {type(value).__name__}")
    return tuple(count(name, x, low, high) for x in given)


def path(name: str, value: Any) -> Path:
    """A path of a file."""
    try:
        given = os.fspath(value)
    except TypeError:
        raise TypeError(f"{name}: expected a path, got {type(value).__name__}") from None
    if isinstance(given, bytes):
        raise TypeError(f"{name}: expected a path, got bytes")
    if not given or "\0" in given:
        raise ValueError(f"{name}: expected the path of a file, got {given!r}")
    return Path(given)


def choice(name: str, value: Any, options: Sequence[str]) -> str:
    """One of `options`."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected a string, got {type(value).__name__}")
    if value not in options:
        raise ValueError(f"{name}: expected one of {', '.join(map(repr, options))}, got {value!r}")
    return value


def flag(name: str, value: Any) -> bool:
    """True or False."""
    if isinstance(value, bool | np.bool_) or (isinstance(value, int) and value in (0, 1)):
        return bool(value)
    raise TypeError(f"{name}: expected True or False, got {type(value).__name__}")


def precision(name: str, value: Any) -> np.dtype[Any]:
    """float32 or float64."""
    try:
        dtype = np.dtype(value)
    except (TypeError, ValueError):
        dtype = np.dtype(object)
    if value is None or dtype not in (np.float32, np.float64):
        raise TypeError(f"{name}: expected float32 or float64, got {value!r}")
    return dtype


def coarse_step(positions: NDArray[Any], dtype: DTypeLike) -> float:
    """The steps of a precision at points so far from the origin that it loses their shape; zero if it does not."""
    if not positions.size:
        return 0.0
    low, high = positions.min(0).astype(np.float64), positions.max(0).astype(np.float64)
    step = float(np.finfo(np.dtype(dtype)).eps) * float(np.maximum(np.abs(low), np.abs(high)).max())
    return step if step > 1e-3 * float((high - low).max()) else 0.0


def warn_if_coarse(positions: NDArray[Any], dtype: DTypeLike, level: int) -> None:
    """Warns at the caller's line if points are so far from the origin that a precision loses their shape."""
    if step := coarse_step(positions, dtype):
        text = f"scene: {np.dtype(dtype)} loses its shape so far from the origin (steps of {step:.2g}); move it there"
        warnings.warn(text, RuntimeWarning, stacklevel=level)


def progress_callback(progress: bool | Callable[[int, int], object] | None, label: str) -> Any:
    """What kernels call with (done, total): None, the user's callable, or a progress bar for True."""
    if progress is None or progress is False:
        return None
    if progress is True:
        from tqdm.auto import tqdm

        bar = tqdm(total=1, desc=label, leave=False)

        def show(done: int, total: int) -> None:
            bar.total = total
            bar.n = done
            bar.refresh()
            if done >= total:
                bar.close()

        return show
    if not callable(progress):
        raise TypeError(f"progress: expected True, False or a callable (done, total), got {type(progress).__name__}")
    return progress
