"""Point sets of a given size: strata, spirals, points that keep their distance, and masks of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import DTypeLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels
from ._arguments import many
from .sequences import golden_steps

__all__ = [
    "blue_noise_mask",
    "fibonacci_sphere",
    "latin_hypercube",
    "multi_jittered",
    "poisson_disk",
    "stratified",
    "vogel_disk",
]


def _seed(seed: int) -> int:
    return _arrays.count("seed", seed, 0, 2**64 - 1)


def stratified(
    counts: int | Sequence[int],
    *,
    jitter: bool = True,
    seed: int = 0,
    dtype: DTypeLike = np.float64,
    out: Floats | None = None,
) -> Floats:
    """One point in each cell of a grid.

    Parameters
    ----------
    counts : int or sequence of int
        How many cells along each axis, at least 1; a number means one axis.
    jitter : bool
        Uniform within the cell, or in its middle.
    seed : int
        Of the jitter.
    dtype : float32 or float64
        Of the result.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (product of counts, axes)
        Coordinates in [0, 1), the last axis running fastest.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    The standard error of an average falls as n^(-1/2 - 1/d) where the integrand is smooth, as n^(-1/2 - 1/(2d)) where
    it has an edge; with so many cells per axis, d is small in practice.

    References
    ----------
    R. L. Cook, *Stochastic sampling in computer graphics*, 1986.

    Examples
    --------
    >>> stratified((2, 2), jitter=False)
    array([[0.25, 0.25],
           [0.25, 0.75],
           [0.75, 0.25],
           [0.75, 0.75]])
    """
    if not isinstance(counts, int | np.integer | Sequence | np.ndarray) or isinstance(counts, str | bytes):
        raise TypeError(f"counts: expected an integer or several, got {type(counts).__name__}")
    axes = [counts] if isinstance(counts, int | np.integer) else list(counts)
    if not axes:
        raise ValueError("counts: expected at least one axis, got none")
    axes = [_arrays.count("counts", c, 1, 2**31 - 1) for c in axes]
    out = _arrays.output("out", out, (math.prod(axes), len(axes)), _arrays.precision("dtype", dtype))
    _kernels.stratified(_seed(seed), axes, bool(jitter), out)
    return out


def latin_hypercube(
    n: int,
    dimensions: int = 2,
    *,
    jitter: bool = True,
    seed: int = 0,
    dtype: DTypeLike = np.float64,
    out: Floats | None = None,
) -> Floats:
    """Points with one in each n-th of every axis ("n rooks").

    Parameters
    ----------
    n : int
        How many points, below 2³².
    dimensions : int
        At least 1.
    jitter : bool
        Uniform within the stratum, or in its middle.
    seed : int
        Different seeds give independent sets.
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
    Removes the variance of all that the integrand does along single axes, and none of what it does along several at
    once.

    References
    ----------
    M. D. McKay, R. J. Beckman, W. J. Conover, *A comparison of three methods for selecting values of input variables in
    the analysis of output from a computer code*, 1979.

    Examples
    --------
    >>> np.sort(latin_hypercube(4, 2, jitter=False), axis=0)
    array([[0.125, 0.125],
           [0.375, 0.375],
           [0.625, 0.625],
           [0.875, 0.875]])
    """
    n = _arrays.count("n", n, 0, 2**32 - 1)
    dimensions = _arrays.count("dimensions", dimensions, 1, 2**32 - 1)
    out = _arrays.output("out", out, (n, dimensions), _arrays.precision("dtype", dtype))
    _kernels.latin_hypercube(_seed(seed), bool(jitter), out)
    return out


def multi_jittered(
    n: int | tuple[int, int],
    *,
    correlated: bool = True,
    seed: int = 0,
    dtype: DTypeLike = np.float64,
    out: Floats | None = None,
) -> Floats:
    """Points of the square that are stratified as a grid and along both axes.

    Parameters
    ----------
    n : int or (columns, rows)
        How many points, below 2³¹. A number is laid out on the most nearly square grid that holds it.
    correlated : bool
        All columns share one order of their rows and all rows one of their columns, which keeps neighbours apart; or
        each has its own.
    seed : int
        Different seeds give independent sets.
    dtype : float32 or float64
        Of the result.
    out : ndarray, optional
        Where to write.

    Returns
    -------
    ndarray, shape (n, 2)
        Coordinates in [0, 1), in random order: of columns × rows points one in each cell, and one in each n-th of
        both axes. Where the grid's last row is not full, the second axis alone keeps its n-ths.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    What the integrand does along single axes is integrated as by n strata. For what it does across both, orders of
    their own keep the independence of jittered cells and halve its error on smooth products; shared orders look
    better, but err more than a jittered grid there, since whole rows err alike.

    References
    ----------
    K. Chiu, P. Shirley, C. Wang, *Multi-jittered sampling*, 1994.
    A. Kensler, *Correlated multi-jittered sampling*, 2013.

    Examples
    --------
    >>> np.sort(np.floor(multi_jittered((2, 2)) * 4), axis=0)
    array([[0., 0.],
           [1., 1.],
           [2., 2.],
           [3., 3.]])
    """
    if isinstance(n, tuple):
        if len(n) != 2:
            raise ValueError(f"n: expected a number or (columns, rows), got {n}")
        columns, rows = (_arrays.count("n", x, 1, 2**31 - 1) for x in n)
        total = _arrays.count("n", columns * rows, 1, 2**31 - 1)
    else:
        total = _arrays.count("n", n, 0, 2**31 - 1)
        columns = max(math.isqrt(max(total - 1, 0)) + 1, 1)
    out = _arrays.output("out", out, (total, 2), _arrays.precision("dtype", dtype))
    _kernels.multi_jittered(_seed(seed), columns, bool(correlated), out)
    return out


def _spiral(angle: float) -> tuple[tuple[int, int], tuple[int, int]]:
    """The golden angle and the first point's, in halves of fractions of 2¹²⁸ turns."""
    first = int((_arrays.number("rotation", angle) / (2 * math.pi)) % 1 * 2**64) % 2**64
    step = 2**128 - golden_steps(1)[0]
    return (step >> 64, step & (2**64 - 1)), (first, 0)


def fibonacci_sphere(n: int, *, rotation: float = 0, dtype: DTypeLike = np.float64) -> Floats:
    """Evenly spread unit directions on a spiral from pole to pole.

    Parameters
    ----------
    n : int
        How many.
    rotation : float
        About z, in radians.
    dtype : float32 or float64
        Of the result.

    Returns
    -------
    ndarray, shape (n, 3)
        The i-th has z = 1 - (2i + 1) / n and is turned by i golden angles, 2π (1 - 1/φ).

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Every direction stands for the area 4π / n. Within 3 rounding units of 1 at any n: angles are reduced in integers.

    References
    ----------
    R. Swinbank, R. J. Purser, *Fibonacci grids: a novel approach to global modelling*, 2006.
    Á. González, *Measurement of areas on a sphere using Fibonacci and latitude-longitude lattices*, 2010.

    Examples
    --------
    >>> fibonacci_sphere(5)[:, 2]
    array([ 0.8,  0.4,  0. , -0.4, -0.8])
    """
    out = _arrays.output("out", None, (many("n", n), 3), _arrays.precision("dtype", dtype))
    _kernels.fibonacci_sphere(*_spiral(rotation), out)
    return out


def vogel_disk(n: int, *, rotation: float = 0, dtype: DTypeLike = np.float64) -> Floats:
    """Evenly spread points of the unit disk, on a sunflower's spiral.

    Parameters
    ----------
    n : int
        How many.
    rotation : float
        In radians; a random one for each pixel makes a filter kernel of its own.
    dtype : float32 or float64
        Of the result.

    Returns
    -------
    ndarray, shape (n, 2)
        The i-th at the radius √((i + ½) / n), turned by i golden angles, 2π (1 - 1/φ).

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    Every point stands for the area π / n. Within 3 rounding units of 1 at any n: angles are reduced in integers.

    References
    ----------
    H. Vogel, *A better way to construct the sunflower head*, 1979.

    Examples
    --------
    >>> np.hypot(*vogel_disk(2).T)
    array([0.5      , 0.8660254])
    """
    out = _arrays.output("out", None, (many("n", n), 2), _arrays.precision("dtype", dtype))
    _kernels.vogel_disk(*_spiral(rotation), out)
    return out


def poisson_disk(
    radius: float,
    dimensions: Literal[2, 3] = 2,
    *,
    domain: Literal["torus", "square", "disk"] = "torus",
    attempts: int = 30,
    seed: int = 0,
    dtype: DTypeLike = np.float64,
) -> Floats:
    """Random points no two of which are nearer than a radius, nearly as many as fit.

    Parameters
    ----------
    radius : float
        The least distance, above zero. Below 1/2 on the torus, whose own distances end there.
    dimensions : {2, 3}
        Of the square or the cube, the disk or the ball.
    domain : {"torus", "square", "disk"}
        [0, 1)^d with distances around its edges (so that it tiles) or within; or the ball of radius 1 about the origin.
    attempts : int
        How many candidates are thrown around a point before it is given up; more fill the last gaps.
    seed : int
        Different seeds give independent sets.
    dtype : float32 or float64
        Of the result.

    Returns
    -------
    ndarray, shape (n, dimensions)
        In the order of growth. In float32, rounded, distances may fall short of the radius by 1e-7.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, or the points would be more than 2²⁸.

    Notes
    -----
    About 0.7 / radius² points on the unit square with the default attempts: discs of half the radius cover 55 % of it.
    Memory is one cell of d doubles per radius^d / d^(d/2) of volume. One thread.

    References
    ----------
    R. Bridson, *Fast Poisson disk sampling in arbitrary dimensions*, 2007.

    Examples
    --------
    >>> p = poisson_disk(0.1, seed=1)
    >>> d = np.abs(p[:, None] - p) % 1
    >>> d = np.hypot(*np.moveaxis(np.minimum(d, 1 - d), -1, 0))
    >>> bool(d[np.triu_indices(len(p), 1)].min() >= 0.1)
    True
    """
    radius = _arrays.number("radius", radius, above=0)
    if dimensions not in (2, 3):
        raise ValueError(f"dimensions: expected 2 or 3, got {dimensions!r}")
    _arrays.choice("domain", domain, ("torus", "square", "disk"))
    if domain == "torus" and radius >= 0.5:
        raise ValueError(f"radius: expected less than 0.5 on the torus, got {radius:g}")
    extent = 2 if domain == "disk" else 1
    if (extent * math.sqrt(dimensions) / radius) ** dimensions > 2**28:
        raise ValueError(f"radius: expected one of which 2**28 cells of a grid fill the domain, got {radius:g}")
    attempts = _arrays.count("attempts", attempts, 1, 2**31 - 1)
    flat = _kernels.poisson_disk(domain, dimensions, radius, attempts, _seed(seed))
    points: Floats = flat.reshape(-1, dimensions).astype(_arrays.precision("dtype", dtype), copy=False)
    if domain != "disk" and points.dtype == np.float32:
        np.minimum(points, np.nextafter(np.float32(1), np.float32(0)), out=points)
    return points


def blue_noise_mask(
    size: int | tuple[int, int], *, sigma: float = 1.5, seed: int = 0, dtype: DTypeLike = np.float64
) -> Floats:
    """A tile of thresholds whose errors are blue noise: the pixels below any threshold are evenly spread.

    Parameters
    ----------
    size : int or (width, height)
        Of the tile, at least 2 and at most 2²² pixels; a number means a square.
    sigma : float
        Of the Gaussian by which pixels repel each other, in pixels; 1.5 is Ulichney's.
    seed : int
        Different seeds give independent masks.
    dtype : float32 or float64
        Of the result.

    Returns
    -------
    ndarray, shape (height, width)
        Each of (k + ½) / n, k = 0 … n - 1, once: a uniform random number for each pixel as well.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    It tiles without seams. To dither, compare a picture with it; to offset a sequence pixel by pixel, add it modulo 1.

    References
    ----------
    R. Ulichney, *The void-and-cluster method for dither array generation*, 1993.

    Examples
    --------
    >>> mask = blue_noise_mask(16)
    >>> bool((np.sort(mask, axis=None) == (np.arange(256) + 0.5) / 256).all())
    True
    """
    width, height = _arrays.counts("size", size if isinstance(size, tuple) else (size, size), 2, 1)
    if not 2 <= width * height <= 2**22:
        raise ValueError(f"size: expected 2 to 2**22 pixels, got {width} x {height}")
    sigma = _arrays.number("sigma", sigma, 0.3, 64)
    ranks = _kernels.blue_noise_mask(width, height, sigma, _seed(seed)).reshape(height, width)
    mask: Floats = ((ranks + 0.5) / (width * height)).astype(_arrays.precision("dtype", dtype))
    return mask
