"""What questions about ray tests share: rays laid out as pictures, exact answers, misses told from errors.

A case is a grid of rays in square tiles, each tile another primitive and another eye. An answer is the distance `t` of
each ray, or -1 where it misses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import transform
from ..question import Candidate, Metric

__all__ = ["METRIC", "Rays", "also", "answer", "candidate", "display", "random_frame", "residual", "rounded", "tiles"]

Array = NDArray[Any]

TILE = 64
"""Rays along the side of a tile."""

EPS = float(np.finfo(np.float32).eps)

_METRIC_ABOUT = (
    "Root mean square of the relative error of the distance t, where a ray that is decided wrongly (a hit that was "
    "lost, or one that was invented) counts as an error of 1. So 0.01 is one wrong decision in 10 000 rays; without "
    "any, it is the error of t. The reference is exact for the very numbers that the techniques are given."
)


@dataclass(frozen=True)
class Rays:
    """What reference and candidates are given: rays and primitives in one precision, and what is right.

    `origins` and `directions` are (H, W, K, 3) and `primitives` (H, W, K, …), contiguous: ray against each of K
    primitives. `exact` is (H, W), in double, -1 where the ray misses all; `shade` is for pictures.
    """

    origins: Array
    directions: Array
    primitives: tuple[Array, ...]
    exact: Array
    shade: Array


def tiles(size: tuple[int, int]) -> tuple[Array, Array, Array, int]:
    """For each ray its place in its tile, x and y in (-1, 1), and the tile's number; and the number of tiles."""
    width, height = size
    columns, rows = max(width // TILE, 1), max(height // TILE, 1)
    x, y = np.arange(width), np.arange(height)
    column, row = x * columns // width, y * rows // height

    def place(at: Array, tile: Array) -> Array:
        start = np.searchsorted(tile, tile)
        return np.asarray((at - start + 0.5) / np.bincount(tile)[tile] * 2 - 1)

    number = row[:, None] * columns + column[None, :]
    shape = number.shape
    across, down = np.broadcast_to(place(x, column), shape), np.broadcast_to(place(y, row)[:, None], shape)
    return across, -down, number, columns * rows


def rounded(values: Array) -> Array:
    """Values as single precision has them, in double."""
    return np.asarray(values, np.float32).astype(np.float64)


def random_frame(rng: np.random.Generator, n: int) -> Array:
    """Rotation matrices (n, 3, 3), uniform."""
    return transform.quaternion_to_matrix(rng.normal(size=(n, 4)))[:, :3, :3]


def answer(t: Array) -> Array:
    """What a technique says of each ray, of its answers for K primitives: the nearest hit, or -1."""
    nearest = np.asarray(t).min(-1)
    return np.where(np.isposinf(nearest), nearest.dtype.type(-1), nearest)


def _met(value: Array, reference: Array) -> tuple[Array, Array, Array]:
    """Where a hit is right, lost, invented."""
    hit, met = reference >= 0, np.asarray(value) >= 0
    return hit & met, hit & ~met, ~hit & met


def _relative(value: Array, reference: Array) -> Array:
    right, _, _ = _met(value, reference)
    return np.where(right, (np.asarray(value, np.float64) - reference) / np.where(right, reference, 1), 0.0)


def residual(value: Array, reference: Array, inputs: Rays) -> Array:
    """The relative error of the distance, within -1 … 1; -1 where a hit was lost, 1 where one was invented."""
    _, lost, invented = _met(value, reference)
    apart = np.clip(_relative(value, reference), -1, 1)
    return np.where(np.isnan(value), np.nan, apart + invented - lost)


def _lost(value: Array, reference: Array, inputs: Rays) -> float:
    """Rays in a million that hit, and were said to miss."""
    return 1e6 * float(_met(value, reference)[1].mean())


def _invented(value: Array, reference: Array, inputs: Rays) -> float:
    """Rays in a million that miss, and were said to hit."""
    return 1e6 * float(_met(value, reference)[2].mean())


def _of_distance(value: Array, reference: Array, inputs: Rays) -> float:
    """The largest relative error of the distance of hits rightly found, in rounding units of single precision."""
    return float(np.abs(_relative(value, reference)).max(initial=0.0) / EPS)


also = {"lost per million": _lost, "invented per million": _invented, "largest error of t (eps)": _of_distance}


METRIC = Metric(
    "error of the distance, wrong decisions as 1",
    residual,
    about=_METRIC_ABOUT,
    signs=("a lost hit", "an invented one"),
)


def candidate(name: str, run: Callable[..., Array], about: str) -> Candidate:
    """A test in single precision as given, and with its arguments turned to double, which is part of its cost."""

    def prepare(inputs: Rays, precision: str) -> tuple[Array, ...]:
        arrays = (inputs.origins, inputs.directions, *inputs.primitives)
        return arrays if precision == "single" else tuple(v.astype(np.float64) for v in arrays)

    def counters(inputs: Rays, precision: str) -> dict[str, float]:
        return {"tests/ray": float(inputs.origins.shape[2])}

    return Candidate(name, run, {"precision": ("single", "double")}, prepare, counters, about=about)


def display(inputs: Rays, value: Array) -> Array:
    """Hits by shade, misses dark; lost hits magenta, invented ones orange."""
    _, lost, invented = _met(value, inputs.exact)
    seen = np.where(np.asarray(value) >= 0, inputs.shade, 0.12)
    picture = np.repeat(np.clip(seen, 0, 1)[..., None], 3, -1)
    picture[lost] = (1, 0, 1)
    picture[invented] = (1, 0.55, 0)
    return (picture * 255 + 0.5).astype(np.uint8)
