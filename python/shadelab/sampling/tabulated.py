"""Points and indices in proportion to given weights."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels

__all__ = ["AliasTable", "Draw", "Tabulated1D", "Tabulated2D", "alias_table"]


class Draw(NamedTuple):
    """Points of a tabulated density."""

    point: Floats
    """In [0, 1), shape (...) or (..., 2)."""
    pdf: Floats
    """The density there."""
    cell: NDArray[np.int32]
    """The cell that the point lies in, shape (...), or column and row (..., 2); -1 where `u` is outside [0, 1]."""


class Tabulated1D:
    """A density over [0, 1], constant in each of n equal cells.

    Parameters
    ----------
    weights : array_like, shape (n,)
        Finite, at least 0, one of them positive; their scale does not matter. float32 makes a table of float32.

    Raises
    ------
    TypeError, ValueError
        If `weights` is not one row of such numbers (the first other one is named), or longer than the precision can
        tell apart (2²² in float32).

    Notes
    -----
    The density is the difference of the very sums that are inverted, so estimates are unbiased; in float32 a cell's
    probability is rounded to 6e-8 of the whole, and cells below that may never come (their `pdf` is 0 then). Sums are
    made in double. The expected cost of a sample does not depend on n.

    References
    ----------
    L. Devroye, *Non-Uniform Random Variate Generation*, 1986, section III.2.4.

    Examples
    --------
    >>> table = Tabulated1D([1.0, 3.0])
    >>> table.sample([0.125, 0.625]).point
    array([0.25, 0.75])
    >>> table.pdf([0.25, 0.75])
    array([0.5, 1.5])
    """

    def __init__(self, weights: ArrayLike) -> None:
        array = _arrays.floats("weights", weights)
        if array.ndim != 1:
            raise ValueError(f"weights: expected shape (n,), got {array.shape}")
        self._set(_kernels.Table1D(array), array.dtype, len(array))

    def _set(self, table: Any, dtype: np.dtype[Any], n: int) -> None:
        self._table, self.dtype, self.cells = table, dtype, n

    @classmethod
    def _of(cls, table: Any, dtype: np.dtype[Any], n: int) -> Tabulated1D:
        self = object.__new__(cls)
        self._set(table, dtype, n)
        return self

    def __repr__(self) -> str:
        return f"Tabulated1D({self.cells} cells, {self.dtype})"

    @property
    def mean(self) -> float:
        """The mean of the weights: their integral over [0, 1]; NaN for a conditional density."""
        return float(self._table.mean())

    def sample(self, u: ArrayLike) -> Draw:
        """The points below which shares `u` in [0, 1] of the probability lie; never in a cell without weight."""
        given = {"u": (_arrays.floats("u", u, self.dtype), 0)}
        return Draw(*_arrays.elementwise(self._table.sample, given, [0, 0, (0, np.int32)]))

    def pdf(self, x: ArrayLike) -> Floats:
        """The density at `x`; 0 outside [0, 1]."""
        return _arrays.elementwise(self._table.pdf, {"x": (_arrays.floats("x", x, self.dtype), 0)}, [0])[0]

    def invert(self, x: ArrayLike) -> Floats:
        """The share of the probability below `x`: the inverse of `sample`."""
        return _arrays.elementwise(self._table.invert, {"x": (_arrays.floats("x", x, self.dtype), 0)}, [0])[0]


class Tabulated2D:
    """A density over the unit square, constant in each of H × W equal cells.

    Parameters
    ----------
    weights : array_like, shape (H, W)
        Finite, at least 0, one of them positive. x runs along a row from left to right, y from row 0 on.

    Raises
    ------
    TypeError, ValueError
        If `weights` is not a table of such numbers (the first other one is named).

    Notes
    -----
    A row by the marginal density, then a place in it; see `Tabulated1D` for what precision means here. Rows without
    weight never come. Eight bytes a cell in float32.

    References
    ----------
    M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 2023, appendix A.

    Examples
    --------
    >>> table = Tabulated2D([[0.0, 1.0], [2.0, 1.0]])
    >>> table.sample([0.5, 0.5]).cell, table.pdf([0.25, 0.75])
    (array([0, 1], dtype=int32), array(2.))
    """

    def __init__(self, weights: ArrayLike) -> None:
        array = _arrays.floats("weights", weights)
        if array.ndim != 2 or not array.size:
            raise ValueError(f"weights: expected shape (H, W), got {array.shape}")
        self._table, self.dtype, self.shape = _kernels.Table2D(array), array.dtype, array.shape

    def __repr__(self) -> str:
        return f"Tabulated2D({self.shape[0]} × {self.shape[1]} cells, {self.dtype})"

    @property
    def mean(self) -> float:
        """The mean of the weights: their integral over the square."""
        return float(self._table.mean())

    @property
    def marginal(self) -> Tabulated1D:
        """The density of y alone."""
        return Tabulated1D._of(self._table.along(), self.dtype, self.shape[0])

    def conditional(self, row: int) -> Tabulated1D:
        """The density of x within a row; even where the row has no weight."""
        row = _arrays.count("row", row, 0, self.shape[0] - 1)
        return Tabulated1D._of(self._table.along(row), self.dtype, self.shape[1])

    def sample(self, u: ArrayLike) -> Draw:
        """Points for `u` of the unit square: its second number chooses the row, its first the place in it."""
        given = {"u": (_arrays.vectors("u", u, 2, self.dtype), 2)}
        return Draw(*_arrays.elementwise(self._table.sample, given, [2, 0, (2, np.int32)]))

    def pdf(self, points: ArrayLike) -> Floats:
        """The density at points (..., 2); 0 outside the unit square."""
        given = {"points": (_arrays.vectors("points", points, 2, self.dtype), 2)}
        return _arrays.elementwise(self._table.pdf, given, [0])[0]

    def invert(self, points: ArrayLike) -> Floats:
        """Where in the unit square points (..., 2) come from: the inverse of `sample`."""
        given = {"points": (_arrays.vectors("points", points, 2, self.dtype), 2)}
        return _arrays.elementwise(self._table.invert, given, [2])[0]


class AliasTable:
    """Indices in proportion to weights, one comparison each; see `alias_table`."""

    def __init__(self, share: Floats, alias: NDArray[np.uint32]) -> None:
        self.share = share
        """Of each column, the part that keeps the column's own index."""
        self.alias = alias
        """The index that the rest of the column goes to."""

    def __repr__(self) -> str:
        return f"AliasTable({len(self.share)} weights, {self.share.dtype})"

    @property
    def probability(self) -> Floats:
        """How likely each index is, from the table itself."""
        n = len(self.share)
        given_away = np.bincount(self.alias, 1 - self.share.astype(np.float64), n)
        return np.asarray((self.share + given_away) / n, self.share.dtype)

    def sample(self, u: ArrayLike) -> tuple[NDArray[np.int64], Floats]:
        """Indices for numbers `u` in [0, 1] (-1 for others), and what is left of each `u`: uniform again in [0, 1)."""
        given = {"u": (_arrays.floats("u", u, self.share.dtype), 0)}
        index, rest = _arrays.elementwise(_kernels.sample_alias, given, [(0, np.int64), 0], self.share, self.alias)
        return index, rest


def alias_table(weights: ArrayLike) -> AliasTable:
    """A table to draw indices in proportion to weights in constant time.

    Parameters
    ----------
    weights : array_like, shape (n,)
        Finite, at least 0, one of them positive.

    Returns
    -------
    AliasTable
        With `sample(u)`, the columns' `share` and `alias`, and each index's `probability`.

    Raises
    ------
    TypeError, ValueError
        If `weights` is not one row of such numbers; the first other one is named.

    Notes
    -----
    One comparison a sample whatever n, but neighbouring `u` go to unrelated indices: `Tabulated1D` keeps strata. An
    index's probability is right to a few rounding units of 1/n; one of no weight never comes. In float32 a number `u`
    has 24 bits, so that beyond some 10⁵ indices use float64.

    References
    ----------
    A. J. Walker, *An efficient method for generating discrete random variables with general distributions*, 1977.
    M. D. Vose, *A linear algorithm for generating random numbers with a given distribution*, 1991.

    Examples
    --------
    >>> table = alias_table([1.0, 3.0])
    >>> table.probability, table.sample([0.0, 0.25, 0.75])[0]
    (array([0.25, 0.75]), array([0, 1, 1]))
    """
    array = _arrays.floats("weights", weights)
    if array.ndim != 1:
        raise ValueError(f"weights: expected shape (n,), got {array.shape}")
    share, alias = np.empty_like(array), np.empty(array.shape, np.uint32)
    _kernels.alias_table(array, share, alias)
    return AliasTable(share, alias)
