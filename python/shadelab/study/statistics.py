"""The statistics of a study: debiased errors, their confidence, medians of times, dominance.

A Monte Carlo reference R comes as two independent halves A and B. For an answer x the mean of (x − A)(x − B) estimates
the mean of (x − R)² without the reference's own noise, which (x − (A + B)/2)² would add. Sums are double.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Interval",
    "bootstrap",
    "median_interval",
    "nondominated",
    "product_sums",
    "resample",
    "root",
    "tile_labels",
]

CONFIDENCE = 0.95
"""The confidence of every interval of a study."""

REPLICATES = 500
"""Bootstrap replicates: the 2.5 % quantile then rests on a dozen of them."""


@dataclass(frozen=True)
class Interval:
    """A figure and its confidence interval."""

    value: float
    low: float
    high: float

    @property
    def known(self) -> bool:
        """Whether the figure is finite."""
        return math.isfinite(self.value)


def root(square: Any) -> Any:
    """The root of a debiased square, which noise may have put below zero (then the error is too small to be seen)."""
    return np.sqrt(np.maximum(square, 0.0))


def tile_labels(shape: tuple[int, ...], tiles: int = 256) -> NDArray[np.intp]:
    """A label for each element that says which tile it lies in; about `tiles` near-square tiles over the first axes.

    Errors of neighbouring pixels are alike, so tiles, not pixels, are what the bootstrap draws.
    """
    if len(shape) == 1:
        return np.arange(shape[0], dtype=np.intp) * min(tiles, max(shape[0], 1)) // max(shape[0], 1)
    height, width = shape[:2]
    side = max(math.sqrt(height * width / tiles), 1.0)
    columns = max(math.ceil(width / side), 1)
    rows = (np.arange(height) / side).astype(np.intp)
    return rows[:, None] * columns + (np.arange(width) / side).astype(np.intp)[None, :]


def product_sums(
    a: NDArray[Any], b: NDArray[Any], labels: NDArray[np.intp], tiles: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sums of a·b over each tile, and the elements in each; trailing axes (channels) are averaged."""
    product = np.multiply(a, b, dtype=np.float64)
    if product.ndim > labels.ndim:
        product = product.reshape(*labels.shape, -1).mean(-1)
    sums = np.bincount(labels.ravel(), product.ravel(), tiles).astype(np.float64)
    return sums, np.bincount(labels.ravel(), minlength=tiles).astype(np.float64)


def resample(counts: NDArray[np.float64], seed: int = 0, replicates: int = REPLICATES) -> NDArray[np.float64]:
    """How often each tile is drawn in each replicate, shape (replicates, tiles); empty tiles are never drawn.

    The same counts and seed give the same draws, so that two candidates are compared on the same replicates.
    """
    filled = counts > 0
    n = int(filled.sum())
    weights = np.zeros((replicates, counts.size))
    if n:
        rng = np.random.default_rng(seed)
        weights[:, filled] = rng.multinomial(n, np.full(n, 1.0 / n), size=replicates)
    return weights


def bootstrap(sums: NDArray[np.float64], counts: NDArray[np.float64], seed: int = 0) -> NDArray[np.float64]:
    """Replicates of the mean over all elements, tiles drawn with replacement."""
    weights = resample(counts, seed)
    total = weights @ counts
    return np.divide(weights @ sums, total, out=np.full(len(weights), np.nan), where=total > 0)


def interval_of(replicates: NDArray[np.float64], value: float) -> Interval:
    """The percentile interval of bootstrap replicates around a value, widened to hold the value itself."""
    if not math.isfinite(value) or not np.isfinite(replicates).all():
        return Interval(value, value, value)
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(replicates, [tail, 1 - tail])
    return Interval(value, min(float(low), value), max(float(high), value))


def median_interval(values: list[float] | NDArray[Any]) -> Interval:
    """The median and its distribution-free interval between order statistics.

    The narrowest symmetric pair that covers the median with at least 95 % is taken; with fewer than six values no pair
    does, and smallest to largest (94 % for five, 75 % for three) is what there is.
    """
    ordered = np.sort(np.asarray(values, np.float64))
    n = len(ordered)
    if n == 0:
        return Interval(math.nan, math.nan, math.nan)
    # P(fewer than k values lie below the median) for k = 1, 2, …: the binomial tail that cutting k values costs.
    k, tail = 0, 2.0 ** (1 - n)
    while (n - 1) // 2 > k and tail + 2.0 * math.comb(n, k + 1) / 2.0**n <= 1 - CONFIDENCE:
        k += 1
        tail += 2.0 * math.comb(n, k) / 2.0**n
    return Interval(float(np.median(ordered)), float(ordered[k]), float(ordered[n - 1 - k]))


def nondominated(replicates: list[NDArray[np.float64]], costs: list[Interval]) -> list[bool]:
    """Which candidates no other beats beyond confidence on both axes.

    `replicates` are bootstrap replicates of each candidate's error on common draws, or one value where there are none.
    A candidate is dropped if some other has a cost interval wholly below its own, and an error below its own in all but
    the tail of the replicates.
    """
    tail = (1 - CONFIDENCE) / 2
    keep = []
    for p, cost in zip(replicates, costs, strict=True):
        if not (np.isfinite(p).all() and cost.known):
            keep.append(False)
            continue
        beaten = False
        for q, other in zip(replicates, costs, strict=True):
            if q is p or not (other.known and other.high < cost.low) or not np.isfinite(q).all():
                continue
            if np.quantile(p - q, tail) > 0:
                beaten = True
                break
        keep.append(not beaten)
    return keep
