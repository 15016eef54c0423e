"""Generators, sequences, and warps with their densities."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from . import _arrays
from ._arrays import Floats
from ._kernels import sampling as _kernels

__all__ = [
    "Generator",
    "cosine_hemisphere_to_square",
    "disk_to_square",
    "philox",
    "sobol",
    "square_to_cosine_hemisphere",
    "square_to_cosine_hemisphere_pdf",
    "square_to_disk",
    "square_to_disk_pdf",
    "square_to_triangle",
    "square_to_triangle_pdf",
    "triangle_to_square",
]

DiskMethod: TypeAlias = Literal["concentric", "polar"]
TriangleMethod: TypeAlias = Literal["fold", "root"]


def _unsigned(name: str, value: ArrayLike, dtype: DTypeLike) -> NDArray[Any]:
    """`value` as unsigned integers of `dtype`, refused rather than wrapped where they do not fit."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected integers, got dtype {array.dtype}")
    limit = np.iinfo(np.dtype(dtype)).max
    if array.size and (int(array.min()) < 0 or int(array.max()) > limit):
        raise ValueError(f"{name}: expected integers from 0 to {limit}, got {array.min()} … {array.max()}")
    return array.astype(dtype)


def _precision(dtype: DTypeLike) -> np.dtype[Any]:
    """float32 or float64, as asked."""
    wanted = np.dtype(dtype)
    if wanted not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise TypeError(f"dtype: expected float32 or float64, got {wanted}")
    return wanted


def philox(counter: ArrayLike, key: ArrayLike) -> NDArray[np.uint32]:
    """Philox4x32-10: random bits as a function of a counter and a key.

    Parameters
    ----------
    counter : array_like of int, shape (..., 4)
        Four 32-bit words each.
    key : array_like of int, shape (..., 2)
        Two 32-bit words each. Leading axes broadcast.

    Returns
    -------
    ndarray of uint32, shape (..., 4)
        Under one key a bijection of the counters.

    Raises
    ------
    TypeError, ValueError
        If the words are not integers of 32 bits, or shapes do not fit.

    Notes
    -----
    Passes the known-answer tests published with Random123. About 5 ns a block and thread.

    References
    ----------
    J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, *Parallel random numbers: as easy as 1, 2, 3*, 2011.

    Examples
    --------
    >>> [hex(w) for w in philox([0, 0, 0, 0], [0, 0])]
    ['0x6627e8d5', '0xe169c58d', '0xbc57ac4c', '0x9b00dbd8']
    """
    named = {"counter": (_unsigned("counter", counter, np.uint32), 4), "key": (_unsigned("key", key, np.uint32), 2)}
    for name, (words, n) in named.items():
        if words.ndim == 0 or words.shape[-1] != n:
            raise ValueError(f"{name}: expected shape (..., {n}), got {words.shape}")
    shape, flat = _arrays.broadcast({name: (words, 1) for name, (words, _) in named.items()})
    out = _arrays.output("out", None, flat[0].shape, np.uint32)
    _kernels.philox(*flat, out)
    return out.reshape(*shape, 4)


@dataclass(frozen=True)
class Generator:
    """Random numbers as a function of where they are used: no state, so the order of asking does not matter.

    Parameters
    ----------
    seed : int
        From 0 to 2⁶⁴ − 1.

    Raises
    ------
    TypeError, ValueError
        If `seed` is no integer of 64 bits.

    Notes
    -----
    A number comes from one block of Philox4x32-10 (see `philox`), whose key is the seed and whose counter holds
    pixel, sample and dimension. Kernels draw from the same streams.

    References
    ----------
    J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, *Parallel random numbers: as easy as 1, 2, 3*, 2011.

    Examples
    --------
    >>> g = Generator(7)
    >>> bool(g.uniform(3, 1) == g.uniform(np.arange(5), 1)[3])
    True
    """

    seed: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "seed", _arrays.count("seed", self.seed, 0, 2**64 - 1))

    def uniform(
        self, pixel: ArrayLike, sample: ArrayLike = 0, dimension: ArrayLike = 0, dtype: DTypeLike = np.float64
    ) -> Floats:
        """Uniform numbers in [0, 1).

        Parameters
        ----------
        pixel : array_like of int
            From 0 to 2⁶⁴ − 1.
        sample, dimension : array_like of int
            From 0 to 2³² − 1. All three broadcast.
        dtype : float32 or float64
            Every multiple of 2⁻²⁴ or 2⁻⁵³ below one is equally likely; the float32 number is the float64 one
            rounded down.

        Returns
        -------
        ndarray
            One number each.

        Raises
        ------
        TypeError, ValueError
            If an argument is no integer of its range, or shapes do not broadcast.
        """
        precision = _precision(dtype)
        shape, (p, s, d) = _arrays.broadcast(
            {
                "pixel": (_unsigned("pixel", pixel, np.uint64), 0),
                "sample": (_unsigned("sample", sample, np.uint32), 0),
                "dimension": (_unsigned("dimension", dimension, np.uint32), 0),
            }
        )
        out = _arrays.output("out", None, p.shape, precision)
        _kernels.uniform(self.seed, p, s, d, out)
        return out.reshape(shape)


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
    out = _arrays.output("out", out, (n, dimensions), _precision(dtype))
    _kernels.sobol(None if scramble is None else seed, start, out)
    return out


def _warp(name: str, value: ArrayLike, into: int, kernel: Callable[..., None], size: int = 2, *method: str) -> Floats:
    """Vectors of `size` components through a kernel, into vectors of `into` (0: into numbers)."""
    array = _arrays.vectors(name, value, size)
    flat = array.reshape(-1, size)
    out = _arrays.output("out", None, (len(flat), max(into, 1)), array.dtype)
    kernel(flat, *method, out)
    return out.reshape(array.shape[:-1] + ((into,) if into else ()))


def square_to_disk(u: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """Points of the unit square onto the unit disk, areas in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1].
    method : {"concentric", "polar"}
        Squares become circles, neighbours stay together; or radius √u and angle 2πv, torn along a radius.

    Returns
    -------
    ndarray, shape (..., 2)
        Points, no farther from the centre than one, up to rounding.

    Raises
    ------
    TypeError, ValueError
        If `u` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Within 3 rounding units of 1 of the exact point (4 for "polar"). About 10 ns a point and thread.

    References
    ----------
    P. Shirley, K. Chiu, *A low distortion map between disk and square*, 1997.

    Examples
    --------
    >>> square_to_disk([[0.5, 0.5], [1.0, 0.5]])
    array([[0., 0.],
           [1., 0.]])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _warp("u", u, 2, _kernels.square_to_disk, 2, method)


def disk_to_square(points: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """The inverse of `square_to_disk`.

    Parameters
    ----------
    points : array_like, shape (..., 2)
        In the unit disk.
    method : {"concentric", "polar"}
        That of the map which is inverted.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If `points` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Back on the square within 4 rounding units of 1. About 10 ns a point and thread.

    Examples
    --------
    >>> disk_to_square([0.5, 0.0])
    array([0.75, 0.5 ])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _warp("points", points, 2, _kernels.disk_to_square, 2, method)


def square_to_disk_pdf(points: ArrayLike) -> Floats:
    """The density of `square_to_disk`'s points per area: 1/π in the disk, 0 outside.

    Parameters
    ----------
    points : array_like, shape (..., 2)

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    TypeError, ValueError
        If `points` is not real or not of two components.

    Notes
    -----
    The rim counts as inside, four rounding units wide.

    Examples
    --------
    >>> square_to_disk_pdf([[0.5, 0.0], [1.5, 0.0]])
    array([0.31830989, 0.        ])
    """
    return _warp("points", points, 0, _kernels.square_to_disk_pdf)


def square_to_triangle(u: ArrayLike, method: TriangleMethod = "fold") -> Floats:
    """Points of the unit square onto barycentrics (u, v), areas in constant proportion.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1].
    method : {"fold", "root"}
        Folding the square (little distortion, no root), or (1 - √s, t√s), which keeps lines through one corner.

    Returns
    -------
    ndarray, shape (..., 2)
        u, v ≥ 0 with u + v ≤ 1: the point (1 - u - v) a + u b + v c of a triangle a, b, c.

    Raises
    ------
    TypeError, ValueError
        If `u` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Within 1 rounding unit of 1. About 1 ns a point and thread.

    References
    ----------
    E. Heitz, *A low-distortion map between triangle and square*, 2019 ("fold").
    P. Shirley, C. Wang, K. Zimmerman, *Monte Carlo techniques for direct lighting calculations*, 1996 ("root").

    Examples
    --------
    >>> square_to_triangle([[0.5, 0.5], [0.0, 1.0]])
    array([[0.25, 0.25],
           [0.  , 1.  ]])
    """
    _arrays.choice("method", method, ("fold", "root"))
    return _warp("u", u, 2, _kernels.square_to_triangle, 2, method)


def triangle_to_square(barycentrics: ArrayLike, method: TriangleMethod = "fold") -> Floats:
    """The inverse of `square_to_triangle`.

    Parameters
    ----------
    barycentrics : array_like, shape (..., 2)
        u, v ≥ 0 with u + v ≤ 1.
    method : {"fold", "root"}
        That of the map which is inverted.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If `barycentrics` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Back on the square within 2 rounding units of 1; "root" is singular at u = 1, where all t meet, and near it
    returns t within a rounding unit over √s. About 1 ns a point and thread.

    Examples
    --------
    >>> triangle_to_square([0.25, 0.25])
    array([0.5, 0.5])
    """
    _arrays.choice("method", method, ("fold", "root"))
    return _warp("barycentrics", barycentrics, 2, _kernels.triangle_to_square, 2, method)


def square_to_triangle_pdf(barycentrics: ArrayLike) -> Floats:
    """The density of `square_to_triangle`'s barycentrics: 2 in the triangle, 0 outside.

    Parameters
    ----------
    barycentrics : array_like, shape (..., 2)

    Returns
    -------
    ndarray, shape (...)
        Of a triangle in space, the density per area is one over its area instead.

    Raises
    ------
    TypeError, ValueError
        If `barycentrics` is not real or not of two components.

    Examples
    --------
    >>> square_to_triangle_pdf([[0.25, 0.25], [0.75, 0.75]])
    array([2., 0.])
    """
    return _warp("barycentrics", barycentrics, 0, _kernels.square_to_triangle_pdf)


def square_to_cosine_hemisphere(u: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """Points of the unit square onto directions about z, in proportion to the cosine.

    Parameters
    ----------
    u : array_like, shape (..., 2)
        In [0, 1].
    method : {"concentric", "polar"}
        The disk map underneath, see `square_to_disk`.

    Returns
    -------
    ndarray, shape (..., 3)
        Unit directions with z ≥ 0; z = 0 only from the square's border ("polar": from u = 1).

    Raises
    ------
    TypeError, ValueError
        If `u` is not real or not of two components, or the method is unknown.

    Notes
    -----
    Within 3 rounding units of 1 ("polar": 4), and z to 2 rounding units of itself down to the
    horizon. About 10 ns a point and thread.

    References
    ----------
    Malley's method, in P. Shirley, R. L. Morley, *Realistic Ray Tracing*, 2003.

    Examples
    --------
    >>> square_to_cosine_hemisphere([0.5, 0.5])
    array([0., 0., 1.])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _warp("u", u, 3, _kernels.square_to_cosine_hemisphere, 2, method)


def cosine_hemisphere_to_square(directions: ArrayLike, method: DiskMethod = "concentric") -> Floats:
    """The inverse of `square_to_cosine_hemisphere`.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions with z ≥ 0.
    method : {"concentric", "polar"}
        That of the map which is inverted.

    Returns
    -------
    ndarray, shape (..., 2)
        In [0, 1).

    Raises
    ------
    TypeError, ValueError
        If `directions` is not real or not of three components, or the method is unknown.

    Notes
    -----
    Back on the square within 4 rounding units of 1. About 10 ns a direction and thread.

    Examples
    --------
    >>> cosine_hemisphere_to_square([0.0, 0.0, 1.0])
    array([0.5, 0.5])
    """
    _arrays.choice("method", method, ("concentric", "polar"))
    return _warp("directions", directions, 2, _kernels.cosine_hemisphere_to_square, 3, method)


def square_to_cosine_hemisphere_pdf(directions: ArrayLike) -> Floats:
    """The density of `square_to_cosine_hemisphere`'s directions per solid angle: cos θ / π, 0 below the horizon.

    Parameters
    ----------
    directions : array_like, shape (..., 3)
        Unit directions.

    Returns
    -------
    ndarray, shape (...)

    Raises
    ------
    TypeError, ValueError
        If `directions` is not real or not of three components.

    Examples
    --------
    >>> square_to_cosine_hemisphere_pdf([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    array([0.31830989, 0.        ])
    """
    return _warp("directions", directions, 0, _kernels.square_to_cosine_hemisphere_pdf, 3)
