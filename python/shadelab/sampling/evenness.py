"""How even a point set is: discrepancies and spectra."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import sampling as _kernels

__all__ = ["PowerSpectrum", "discrepancy", "power_spectrum", "star_discrepancy"]


def _in_cube(points: ArrayLike) -> Floats:
    """`points` in double precision, shape (n, d), refused beyond the unit cube."""
    array = _arrays.floats("points", points, np.float64)
    if array.ndim != 2 or 0 in array.shape:
        raise ValueError(f"points: expected shape (n, d) with n and d at least 1, got {array.shape}")
    inside = (array >= 0) & (array <= 1)
    if not inside.all():
        at = tuple(int(i) for i in np.argwhere(~inside)[0])
        raise ValueError(f"points: expected coordinates in [0, 1], got {array[at]} at {at}")
    return array


def star_discrepancy(points: ArrayLike) -> float:
    """The largest difference between a box's volume and the share of points in it, over all boxes from the origin.

    Parameters
    ----------
    points : array_like, shape (n, d)
        In [0, 1].

    Returns
    -------
    float
        From 1 / (2n) for the best set on one axis, to 1.

    Raises
    ------
    TypeError, ValueError
        If the points are not real, not of that shape, or beyond the cube.

    Notes
    -----
    Exact in any dimension, up to rounding: within a few units of 1e-16. All boxes through points are candidates; those
    that cannot exceed the best found so far are passed over. The cost grows as n² in one and two dimensions and as n^d
    beyond: tens of thousands of points in two, thousands in three, a hundred in five.

    References
    ----------
    H. Niederreiter, *Discrepancy and convex programming*, 1972.
    D. P. Dobkin, D. Eppstein, D. P. Mitchell, *Computing the discrepancy with applications to supersampling patterns*,
    1996.

    Examples
    --------
    >>> star_discrepancy([[0.25], [0.75]])
    0.25
    """
    return float(_kernels.star_discrepancy(_in_cube(points)))


def discrepancy(
    points: ArrayLike, kind: Literal["centered", "wraparound", "mixture", "star"] = "centered", *, squared: bool = False
) -> float:
    """The discrepancy in the mean square, over all boxes of a kind in all projections.

    Parameters
    ----------
    points : array_like, shape (n, d)
        In [0, 1].
    kind : {"centered", "wraparound", "mixture", "star"}
        Boxes from the nearest corner (CD2), on the torus (WD2), between these (MD2), or from the origin (Warnock's, of
        the full dimension alone).
    squared : bool
        Return its square.

    Returns
    -------
    float
        An upper bound of the error of averages over integrands of unit variation of that kind.

    Raises
    ------
    TypeError, ValueError
        If the points are not real, not of that shape, or beyond the cube, or the kind is unknown.

    Notes
    -----
    A sum over n² / 2 pairs of d terms, with compensation; of a small discrepancy about 1e-16 (4/3)^d is lost in its
    square. SciPy returns the square for all kinds but the star's.

    References
    ----------
    T. T. Warnock, *Computational investigations of low-discrepancy point sets*, 1972.
    F. J. Hickernell, *A generalized discrepancy and quadrature error bound*, 1998.
    Y.-D. Zhou, K.-T. Fang, J.-H. Ning, *Mixture discrepancy for quasi-random point sets*, 2013.

    Examples
    --------
    >>> round(discrepancy([[0.5]], squared=True), 6)
    0.083333
    """
    _arrays.choice("kind", kind, ("centered", "wraparound", "mixture", "star"))
    square = max(float(_kernels.discrepancy(kind, _in_cube(points))), 0.0)
    return square if squared else square**0.5


class PowerSpectrum(NamedTuple):
    """What `power_spectrum` returns."""

    power: NDArray[np.float64]
    """By frequency, (2 reach + 1, 2 reach + 1), the second axis by rows; (0, 0), in the middle, is n."""
    frequency: NDArray[np.float64]
    """The mean of each ring's frequencies, (reach,)."""
    radial: NDArray[np.float64]
    """The mean power of each ring, whose radii are within half of 1 … reach."""
    anisotropy: NDArray[np.float64]
    """The variance over a ring in units of its squared mean: 1 for random points, more where directions differ."""


def power_spectrum(points: ArrayLike, reach: int | None = None) -> PowerSpectrum:
    """The power of the frequencies of a point set on the torus, in two dimensions and by rings.

    Parameters
    ----------
    points : array_like, shape (n, 2) or (sets, n, 2)
        In [0, 1]. Several sets of a kind are averaged.
    reach : int
        Frequencies along each axis from -reach to reach, whole numbers: all that the torus knows. By default 2 √n,
        up to 256.

    Returns
    -------
    PowerSpectrum
        |Σ exp(-2πi k·x)|² / n by frequency k, and by rings. Random points have 1 on average everywhere; blue noise
        has next to none at low frequencies.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain.

    Notes
    -----
    By direct summation, within 1e-14 reach n of the exact sum of a set; the cost is n reach² per set.

    References
    ----------
    R. A. Ulichney, *Dithering with blue noise*, 1988.

    Examples
    --------
    >>> power_spectrum([[0.0, 0.0], [0.5, 0.5]], reach=1).power.round(12)
    array([[2., 0., 2.],
           [0., 2., 0.],
           [2., 0., 2.]])
    """
    array = _arrays.vectors("points", points, 2, np.float64)
    if array.ndim not in (2, 3):
        raise ValueError(f"points: expected shape (n, 2) or (sets, n, 2), got {array.shape}")
    sets = array[None] if array.ndim == 2 else array
    flat = _in_cube(sets.reshape(-1, 2)).reshape(sets.shape)
    if reach is None:
        reach = min(max(int(2 * sets.shape[1] ** 0.5), 1), 256)
    reach = _arrays.count("reach", reach, 1, 4096)
    total = np.zeros((2 * reach + 1, 2 * reach + 1))
    for one in flat:
        power = np.empty_like(total)
        _kernels.power_spectrum(one, reach, power)
        total += power
    total /= len(flat)
    return PowerSpectrum(total, *_rings(total, reach))


def _rings(power: Floats, reach: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Mean frequency, mean power and relative variance of the rings around 1 … reach."""
    k = np.arange(-reach, reach + 1)
    distance = np.hypot(k, k[:, None])
    ring = np.rint(distance).astype(int)
    use = (ring >= 1) & (ring <= reach)

    def mean(values: Floats) -> NDArray[np.float64]:
        sums = np.bincount(ring[use], values[use], reach + 1)[1:]
        return np.asarray(sums / np.bincount(ring[use], minlength=reach + 1)[1:])

    radial = mean(power)
    spread = mean(power**2) - radial**2
    anisotropy = np.divide(spread, radial**2, out=np.zeros_like(spread), where=radial > 0)
    return mean(distance), radial, anisotropy
