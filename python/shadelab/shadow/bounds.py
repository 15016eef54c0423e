"""Bounds on a distribution from its moments: the mathematics of filtered shadow maps, for moments of any origin."""

from __future__ import annotations

from typing import Literal, TypeAlias

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels

__all__ = ["chebyshev_bound", "moment_bound"]

Method: TypeAlias = Literal["hausdorff", "hamburger"]
_METHODS = ("hausdorff", "hamburger")
# The share by which moments are drawn towards the middle, and the second and fourth moments there: as published for 32
# bits and for 16 (Peters & Klein 2015; Peters et al. 2017), and for double by the same rule.
BIAS = {"float32": (3e-7, 0.375), "float64": (1e-14, 0.375), "uint16": (6e-5, 0.628)}


def chebyshev_bound(mean: ArrayLike, square: ArrayLike, depth: ArrayLike, *, min_variance: float = 0.0) -> Floats:
    """The most of a distribution that can lie at a depth or beyond, from its mean and its mean square.

    Parameters
    ----------
    mean, square : array_like, shape (...)
        Means of z and of z².
    depth : array_like, shape (...)
        The depth t; all broadcast.
    min_variance : float
        Variances below it count as it.

    Returns
    -------
    ndarray, shape (...)
        variance / (variance + (t - mean)²) beyond the mean, 1 up to it. NaN where an argument is NaN.

    Raises
    ------
    TypeError, ValueError
        If shapes do not broadcast, or the least variance is negative.

    Notes
    -----
    Never less than the share itself, and met by two depths of which t is the farther (the one-sided Chebyshev
    inequality, of Cantelli); between the two it is more than the share. The variance is a difference: in float32
    about 1e-7 of the largest z² is lost.

    References
    ----------
    W. Donnelly, A. Lauritzen, *Variance Shadow Maps*, I3D 2006.

    Examples
    --------
    >>> chebyshev_bound(0.5, 0.5, 1.0)  # half at 0, half at 1
    array(0.5)
    """
    least = _arrays.number("min_variance", min_variance, 0.0)
    given = {"mean": (mean, 0), "square": (square, 0), "depth": (depth, 0)}
    (bound,) = _arrays.elementwise(_kernels.chebyshev_bound, given, [0], knobs={"min_variance": least})
    return bound


def moment_bound(
    moments: ArrayLike,
    depth: ArrayLike,
    *,
    method: Method = "hausdorff",
    bias: float | None = None,
) -> Floats:
    """The least of a distribution that must lie before a depth, from its first four moments.

    Parameters
    ----------
    moments : array_like, shape (..., 4)
        Means of z, z², z³ and z⁴.
    depth : array_like, shape (...)
        The depth t.
    method : {"hausdorff", "hamburger"}
        Whether z is known to lie in [-1, 1], which gives the sharper bound, or may lie anywhere.
    bias : float, optional
        The share by which moments are drawn towards (0, 0.375, 0, 0.375) first; 3e-7 in float32 (Peters & Klein 2015)
        and 1e-14 in float64 by default.

    Returns
    -------
    ndarray, shape (...)
        Never more than the share itself but for what `bias` and rounding do. NaN where an argument is NaN.

    Raises
    ------
    TypeError, ValueError
        If shapes do not broadcast, or the bias is not in [0, 1].

    Notes
    -----
    Sharp: some distribution with these moments meets it. Computed in double. Never more than the share by more than
    3e-7 in float32 and 1e-14 in float64, wherever in [-1, 1] depths and t lie: what the rounding of the moments may do
    is taken off, so that depths which they cannot tell from t (some 1e-3 from it in float32) count as not before it.
    Two depths are found exactly but for rounding and bias: at the farther of them at most 1e-3 off in float32 and
    1e-10 in float64 for gaps of 0.02 and more; between two that are close the bound is of no use in float32 (0.5 too
    little at gaps of 0.02, 1e-3 from 0.3 on), and 2e-6 off in float64.
    Moments that no distribution has, or t beyond [-1, 1], give what is nearest.

    References
    ----------
    C. Peters, R. Klein, *Moment Shadow Mapping*, I3D 2015. M. Krein, A. Nudelman, *The Markov Moment Problem and
    Extremal Problems*, 1977.

    Examples
    --------
    >>> moment_bound([0.0, 1.0, 0.0, 1.0], [-0.5, 0.5, 1.0]).round(6)  # half at -1, half at 1
    array([0.5, 0.5, 0.5])
    """
    _arrays.choice("method", method, _METHODS)
    given = {"moments": (moments, 4), "depth": (depth, 0)}
    share, target = BIAS[str(_arrays.result_dtype(moments=moments, depth=depth))]
    if bias is not None:
        share = _arrays.number("bias", bias, 0.0, 1.0)
    (bound,) = _arrays.elementwise(_kernels.moment_bound, given, [0], method, (share, target))
    return bound
