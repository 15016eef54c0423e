"""Pictures with their errors: gathered round by round, merged, and refined where they need it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._arrays import Floats

__all__: list[str] = []

# Pixels of a square that stop together.
_TILE = 8
# Samples of each pixel before any may stop.
PILOT = 32
# Pixels darker than this part of the picture's mean are held to the error of one that bright.
_DARK = 0.05


class Traced(NamedTuple):
    """A traced picture, with its error."""

    radiance: Floats
    """Mean of the samples, (H, W, 3), in W/(m² sr)."""
    variance: Floats
    """Variance of that mean, (H, W, 3), were samples independent: of scrambled points an upper bound as a rule."""
    samples: NDArray[np.int32]
    """How many samples each pixel has, (H, W)."""
    outliers: NDArray[np.int32]
    """How many of them, from the seventeenth on, outweighed all that came before them in their pixel, (H, W)."""
    removed: Floats | None = None
    """Mean of what `clamp` took away, (H, W, 3): `radiance + removed` is the picture without it; None without it."""

    @property
    def error(self) -> float:
        """The standard error (root mean square over pixels and channels) as a fraction of the mean radiance."""
        mean = float(self.radiance.mean(dtype=np.float64))
        deviation = float(np.sqrt(self.variance.mean(dtype=np.float64)))
        return deviation / mean if mean > 0 else (0.0 if deviation == 0 else np.inf)

    def merge(self, other: Traced) -> Traced:
        """One estimate of this run and another over different samples (by `start` or by seed).

        Parameters
        ----------
        other : Traced
            Of the same scene and size.

        Returns
        -------
        Traced

        Raises
        ------
        ValueError
            If the pictures are of different sizes, or one was clamped and the other was not.
        """
        if self.radiance.shape != other.radiance.shape:
            raise ValueError(f"other: expected shape {self.radiance.shape}, got {other.radiance.shape}")
        if (self.removed is None) != (other.removed is None):
            raise ValueError("other: expected both pictures clamped or none")
        dtype = self.radiance.dtype
        film = Film(self.radiance.shape[:2], dtype, self.removed is not None)
        film.add(self)
        film.add(other)
        return film.picture()


Round: TypeAlias = Callable[[int, int, NDArray[np.int32] | None], Iterable[Traced]]
"""(start, samples, pixels): those samples of the picture, or of the pixels listed as a picture of one row, in parts."""


class Film:
    """What all rounds of a picture have gathered, in double precision."""

    def __init__(self, shape: tuple[int, int], dtype: np.dtype[Any], clamped: bool) -> None:
        self.shape, self.dtype = shape, dtype
        n = shape[0] * shape[1]
        self.mean, self.squares = np.zeros((n, 3)), np.zeros((n, 3))
        self.count, self.outliers = np.zeros(n, np.int64), np.zeros(n, np.int64)
        self.removed = np.zeros((n, 3)) if clamped else None

    def add(self, part: Traced, pixels: NDArray[np.int32] | None = None) -> None:
        """Takes in a picture's samples, or those of the pixels listed (T. F. Chan and others' updating formulae)."""
        at = slice(None) if pixels is None else pixels
        a, b = self.count[at].astype(float)[:, None], part.samples.reshape(-1).astype(float)[:, None]
        n = a + b
        share = np.divide(b, n, out=np.zeros_like(n), where=n > 0)
        off = part.radiance.reshape(-1, 3).astype(float) - self.mean[at]
        # A lone sample has no spread, and says infinity.
        spread = np.where(b > 1, part.variance.reshape(-1, 3).astype(float), 0.0) * (b * (b - 1))
        self.squares[at] += spread + off * off * (a * share)
        self.mean[at] += off * share
        if self.removed is not None and part.removed is not None:
            self.removed[at] += (part.removed.reshape(-1, 3) - self.removed[at]) * share
        self.count[at] += part.samples.reshape(-1)
        self.outliers[at] += part.outliers.reshape(-1)

    def variance(self) -> NDArray[np.float64]:
        """Of the mean, (pixels, 3); infinite with less than two samples."""
        n = self.count.astype(float)[:, None]
        freedom = n * (n - 1)
        return np.divide(self.squares, freedom, out=np.full_like(self.squares, np.inf), where=freedom > 0)

    def picture(self) -> Traced:
        h, w = self.shape
        with np.errstate(over="ignore"):
            floats = [x.astype(self.dtype).reshape(h, w, 3) for x in (self.mean, self.variance())]
            removed = None if self.removed is None else self.removed.astype(self.dtype).reshape(h, w, 3)
        return Traced(
            floats[0],
            floats[1],
            self.count.astype(np.int32).reshape(h, w),
            self.outliers.astype(np.int32).reshape(h, w),
            removed,
        )

    def unsettled(self, target: float) -> NDArray[np.int32]:
        """Pixels of the tiles whose error is above the target."""
        h, w = self.shape
        variance = self.variance().mean(1)
        mean = self.mean.mean(1)
        rows, columns = -(-h // _TILE), -(-w // _TILE)
        y, x = np.divmod(np.arange(h * w), w)
        tile = y // _TILE * columns + x // _TILE
        n = np.bincount(tile, minlength=rows * columns)
        v, m = (np.bincount(tile, p, rows * columns) / n for p in (variance, mean))
        floor = _DARK * float(mean.mean())
        above = v > (target * np.maximum(m, floor)) ** 2
        return np.flatnonzero(above[tile]).astype(np.int32)


def rounds(trace: Round, film: Film, start: int, samples: int, first: int, target: float | None) -> Iterator[Traced]:
    """Pictures of `first`, twice, four times … as many samples, up to `samples`.

    Of the unsettled pixels alone if there is a target.
    """
    done = 0
    pixels = None
    while done < samples:
        count = min(max(first, done), samples - done)
        for part in trace(start + done, count, pixels):
            film.add(part, pixels)
        done += count
        yield film.picture()
        if target is not None and done >= PILOT:
            pixels = film.unsettled(target)
            if not pixels.size:
                return
