"""Sequences that fill the unit cube more evenly than random points."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import DTypeLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels
from ._arguments import precision

__all__ = ["sobol"]


def sobol(
    n: int,
    dimensions: int = 2,
    *,
    scramble: Literal["owen"] | None = "owen",
    seed: int = 0,
    start: int = 0,
    dtype: DTypeLike = np.float64,
    out: Floats | None = None,
) -> Floats:
    """Points of Sobol's sequence, by default Owen-scrambled.

    Parameters
    ----------
    n : int
        How many points; powers of two are the even ones.
    dimensions : int
        From 1 to 256.
    scramble : {"owen", None}
        Nested uniform scrambling, or the plain sequence, whose first point is the origin.
    seed : int
        Different seeds give independent scrambles.
    start : int
        Index of the first point, for going on later. `start + n` is at most 2³², where the sequence ends.
    dtype : float32 or float64
        Of the result.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (n, dimensions)
        Coordinates in [0, 1).

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Natural order (SciPy's is Gray code order: the same points in each aligned block of 2^k). Each aligned block of
    2^k points has one in every elementary interval of the first two dimensions, scrambled or not; scrambled points
    are each uniform, so averages are unbiased, with an error that falls as n^(-3/2) on smooth integrands. Pairs of
    high dimensions are uneven until n is large. Coordinates have 32 digits, filled up by hashing in float64 when
    scrambled. About 2 ns a coordinate and thread.

    References
    ----------
    S. Joe, F. Y. Kuo, *Constructing Sobol sequences with better two-dimensional projections*, 2008.
    A. B. Owen, *Randomly permuted (t, m, s)-nets and (t, s)-sequences*, 1995.
    S. Laine, T. Karras, *Stratified sampling for stochastic transparency*, 2011.
    B. Burley, *Practical hash-based Owen scrambling*, 2020.

    Examples
    --------
    >>> sobol(4, 2, scramble=None)
    array([[0.  , 0.  ],
           [0.5 , 0.5 ],
           [0.25, 0.75],
           [0.75, 0.25]])
    """
    n = _arrays.count("n", n)
    dimensions = _arrays.count("dimensions", dimensions, 1, _kernels.SOBOL_DIMENSIONS)
    if scramble is not None:
        _arrays.choice("scramble", scramble, ("owen",))
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    start = _arrays.count("start", start)
    if start + n > 2**32:
        raise ValueError(f"start: expected start + n of at most 2**32, where the sequence ends, got {start + n}")
    out = _arrays.output("out", out, (n, dimensions), precision(dtype))
    _kernels.sobol(None if scramble is None else seed, start, out)
    return out
