"""Sequences that fill the unit cube more evenly than random points, in any number of dimensions."""

from __future__ import annotations

import decimal
import functools
from typing import Literal

import numpy as np
from numpy.typing import DTypeLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels
from ._arguments import many
from .generators import Generator

__all__ = ["halton", "hammersley", "r2", "sobol"]


def _first(n: int, start: int, seed: int) -> tuple[int, int, int]:
    """How many points, the index of the first, and the seed, checked."""
    n, start = many("n", n), _arrays.count("start", start)
    if start + n > 2**64:
        raise ValueError(f"start: expected start + n of at most 2**64, got {start + n}")
    return n, start, _arrays.count("seed", seed, 0, 2**64 - 1)


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
        From 1 to 1,111.
    scramble : {"owen", None}
        Nested uniform scrambling, or the plain sequence, whose first point is the origin.
    seed : int
        Different seeds give independent scrambles.
    start : int
        Index of the first point, for going on later. `start + n` is at most 2⁶⁴.
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
    high dimensions are uneven until n is large. In float64 the binary digits from the 33rd on are scrambled together,
    by a hash of those above. Direction numbers are Joe and Kuo's (new-joe-kuo-6), of all polynomials up to degree 13.

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
    n, start, seed = _first(n, start, seed)
    dimensions = _arrays.count("dimensions", dimensions, 1, _kernels.SEQUENCE_DIMENSIONS)
    if scramble is not None:
        _arrays.choice("scramble", scramble, ("owen",))
    out = _arrays.output("out", out, (n, dimensions), _arrays.precision("dtype", dtype))
    _kernels.sobol(None if scramble is None else seed, start, out)
    return out


def halton(
    n: int,
    dimensions: int = 2,
    *,
    scramble: Literal["owen", "digits"] | None = "owen",
    seed: int = 0,
    start: int = 0,
    dtype: DTypeLike = np.float64,
    out: Floats | None = None,
) -> Floats:
    """Points of Halton's sequence, by default Owen-scrambled.

    Parameters
    ----------
    n : int
        How many points.
    dimensions : int
        From 1 to 1,111; each has its own prime.
    scramble : {"owen", "digits", None}
        A random permutation of each digit for every value of the digits above it; one for each position, as SciPy's;
        or the plain sequence, whose first point is the origin.
    seed : int
        Different seeds give independent scrambles.
    start : int
        Index of the first point, for going on later. `start + n` is at most 2⁶⁴.
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
    Of any b^k successive points with an index that is a multiple of b^k first, one is in each b^k-th of the axis whose
    base is b, scrambled or not. Plain coordinates of large bases run along lines until n passes the bases' product:
    scramble beyond six dimensions or so. Scrambled points are each uniform, so averages are unbiased. The nested
    permutations are of the form (a · digit + c) modulo the base, which any two digits see as uniformly random; "owen"
    scrambles digits one by one until 2³² indices are told apart, and all that follow together. Plain float64
    coordinates are within two ulps.

    References
    ----------
    J. H. Halton, *On the efficiency of certain quasi-random sequences of points*, 1960.
    A. B. Owen, *Randomly permuted (t, m, s)-nets and (t, s)-sequences*, 1995 ("owen").
    A. B. Owen, *A randomized Halton algorithm in R*, 2017 ("digits").

    Examples
    --------
    >>> halton(4, 2, scramble=None)
    array([[0.        , 0.        ],
           [0.5       , 0.33333333],
           [0.25      , 0.66666667],
           [0.75      , 0.11111111]])
    """
    n, start, seed = _first(n, start, seed)
    dimensions = _arrays.count("dimensions", dimensions, 1, _kernels.SEQUENCE_DIMENSIONS)
    if scramble is not None:
        _arrays.choice("scramble", scramble, ("owen", "digits"))
    out = _arrays.output("out", out, (n, dimensions), _arrays.precision("dtype", dtype))
    _kernels.halton(scramble, seed, start, out)
    return out


def hammersley(
    n: int,
    dimensions: int = 2,
    *,
    scramble: Literal["owen", "digits"] | None = None,
    seed: int = 0,
    dtype: DTypeLike = np.float64,
) -> Floats:
    """Hammersley's point set: i / n, and Halton's sequence in the other dimensions.

    Parameters
    ----------
    n : int
        How many points; with fewer or more all of them change.
    dimensions : int
        From 1 to 1,112.
    scramble : {"owen", "digits", None}
        As of `halton`; the first coordinate is then random within its n-th.
    seed : int
        Different seeds give independent scrambles.
    dtype : float32 or float64
        Of the result.

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
    Its discrepancy is of order log^(d-1) n / n, a logarithm less than that of a sequence. In two dimensions and with n
    a power of two, each elementary interval holds one point.

    References
    ----------
    J. M. Hammersley, *Monte Carlo methods for solving multivariable problems*, 1960.

    Examples
    --------
    >>> hammersley(4)
    array([[0.  , 0.  ],
           [0.25, 0.5 ],
           [0.5 , 0.25],
           [0.75, 0.75]])
    """
    n = many("n", n)
    dimensions = _arrays.count("dimensions", dimensions, 1, _kernels.SEQUENCE_DIMENSIONS + 1)
    rest = halton(n, max(dimensions - 1, 1), scramble=scramble, seed=seed, dtype=dtype)
    first: Floats = np.arange(n, dtype=np.float64)
    if scramble is not None:
        first = first + Generator(seed).uniform(2**64 - 1, np.arange(n) % 2**32, 0)
    # Rounded down: the float below one stays below it.
    first = np.minimum((first / max(n, 1)).astype(rest.dtype), np.nextafter(rest.dtype.type(1), rest.dtype.type(0)))
    return np.concatenate([first[:, None], rest], 1)[:, :dimensions]


@functools.lru_cache
def golden_steps(dimensions: int) -> tuple[int, ...]:
    """⌊2¹²⁸ φ⁻¹⌋, ⌊2¹²⁸ φ⁻²⌋ … of the root φ > 1 of φ^(d+1) = φ + 1."""
    with decimal.localcontext() as context:
        # Powers up to φ^-d lose digits as d grows: φ is near 1, and each product half a unit.
        context.prec = 60
        x = decimal.Decimal(2)
        while True:
            # Newton from above falls monotonically until it cannot.
            power = x**dimensions
            nearer = x - (power * x - x - 1) / ((dimensions + 1) * power - 1)
            if nearer >= x:
                break
            x = nearer
        inverse, product, steps = 1 / x, decimal.Decimal(1), []
        for _ in range(dimensions):
            product *= inverse
            steps.append(int(product * 2**128))
    return tuple(steps)


def r2(
    n: int,
    dimensions: int = 2,
    *,
    offset: float | Literal["random"] = 0.5,
    seed: int = 0,
    start: int = 0,
    dtype: DTypeLike = np.float64,
    out: Floats | None = None,
) -> Floats:
    """Points of the additive sequence of the generalised golden ratio, "R2" in two dimensions.

    Parameters
    ----------
    n : int
        How many points.
    dimensions : int
        From 1 to 1,111.
    offset : float or "random"
        Point 0: this in all dimensions, or a random point (of `seed`), which makes averages unbiased.
    seed : int
        For a random offset.
    start : int
        Index of the first point, for going on later. `start + n` is at most 2⁶⁴.
    dtype : float32 or float64
        Of the result.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (n, dimensions)
        Coordinates in [0, 1): offset + i (φ⁻¹, φ⁻², …) modulo 1, φ the root of φ^(d+1) = φ + 1.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Computed in integers of 128 bits and rounded down: exact to the last digit at every index. In two dimensions its
    smallest distance falls as n^(-1/2) with no repetition at any n; in more than about ten dimensions Sobol's sequence
    is better.

    References
    ----------
    M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018.

    Examples
    --------
    >>> r2(3, offset=0)
    array([[0.        , 0.        ],
           [0.75487767, 0.56984029],
           [0.50975533, 0.13968058]])
    """
    n, start, seed = _first(n, start, seed)
    dimensions = _arrays.count("dimensions", dimensions, 1, _kernels.SEQUENCE_DIMENSIONS)
    if isinstance(offset, str):
        _arrays.choice("offset", offset, ("random",))
        starts = [int(u * 2**53) << 75 for u in Generator(seed).uniform(2**64 - 2, 0, np.arange(dimensions))]
    else:
        starts = [int(_arrays.number("offset", offset, 0, below=1) * 2**64) << 64] * dimensions
    out = _arrays.output("out", out, (n, dimensions), _arrays.precision("dtype", dtype))
    halves = [[(x >> 64, x & (2**64 - 1)) for x in xs] for xs in (golden_steps(dimensions), starts)]
    _kernels.r2(*halves, start, out)
    return out
