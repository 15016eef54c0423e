"""Weights of several techniques, and roulette."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats

__all__ = ["balance_heuristic", "power_heuristic", "russian_roulette"]


def balance_heuristic(pdfs: ArrayLike, counts: ArrayLike | None = None) -> Floats:
    """The weights of several techniques for a point, in proportion to how often each draws it.

    Parameters
    ----------
    pdfs : array_like, shape (..., k)
        The density of each technique at a point, by one measure.
    counts : array_like, shape (k,), optional
        How many samples each takes; by default alike.

    Returns
    -------
    ndarray, shape (..., k)
        n_i p_i / Σ n_j p_j: they sum to one; all are 0 where no technique reaches.

    Raises
    ------
    TypeError, ValueError
        If `pdfs` is not real, or `counts` of other shape.

    Notes
    -----
    Right to 4 rounding units whatever the size of densities, infinite ones included (a mirror's): these share all the
    weight. No other weights sum to much less variance.

    References
    ----------
    E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.

    Examples
    --------
    >>> balance_heuristic([1.0, 3.0])
    array([0.25, 0.75])
    """
    return power_heuristic(pdfs, counts, power=1.0)


def power_heuristic(pdfs: ArrayLike, counts: ArrayLike | None = None, *, power: float = 2.0) -> Floats:
    """As `balance_heuristic`, of powers: sharper, better where one of the techniques is nearly perfect.

    Parameters
    ----------
    pdfs : array_like, shape (..., k)
        The density of each technique at a point, by one measure.
    counts : array_like, shape (k,), optional
        How many samples each takes; by default alike.
    power : float
        At least 1; infinite is the maximum heuristic.

    Returns
    -------
    ndarray, shape (..., k)
        (n_i p_i)^power / Σ (n_j p_j)^power; all are 0 where no technique reaches.

    Raises
    ------
    TypeError, ValueError
        If `pdfs` is not real, `counts` of other shape, or `power` below 1.

    Notes
    -----
    Ratios to the largest are taken before the power, so nothing overflows.

    References
    ----------
    E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.

    Examples
    --------
    >>> power_heuristic([1.0, 3.0])
    array([0.1, 0.9])
    """
    p = _arrays.floats("pdfs", pdfs)
    if p.ndim == 0 or p.shape[-1] == 0:
        raise ValueError(f"pdfs: expected shape (..., k) of one technique or more, got {p.shape}")
    power = math.inf if power == math.inf else _arrays.number("power", power, 1)
    n = np.ones(p.shape[-1], p.dtype) if counts is None else _arrays.floats("counts", counts, p.dtype)
    if n.shape != p.shape[-1:] or not ((n >= 0) & np.isfinite(n)).all():
        raise ValueError(f"counts: expected {p.shape[-1]} numbers of at least 0, got shape {n.shape}")
    with np.errstate(invalid="ignore", divide="ignore", under="ignore"):
        # Each beside the largest, before the counts could overflow.
        largest = p.max(-1, keepdims=True)
        share = np.where(np.isinf(largest), np.isinf(p), p / largest) * (n / max(float(n.max()), 1e-30))
        share = np.where(largest > 0, share, largest * 0).astype(p.dtype)
        top = share.max(-1, keepdims=True)
        ratio = np.where(top > 0, share / np.where(top > 0, top, 1), top)
        ratio = np.where(ratio < 1, 0, ratio) if math.isinf(power) else ratio ** p.dtype.type(power)
        total = ratio.sum(-1, keepdims=True)
        return np.asarray(np.where(total > 0, ratio / np.where(total > 0, total, 1), total * ratio), p.dtype)


def russian_roulette(values: ArrayLike, survival: ArrayLike, u: ArrayLike, fallback: ArrayLike = 0.0) -> Floats:
    """Values that live on with a probability, weighted so that the mean stays.

    Parameters
    ----------
    values : array_like, shape (...)
        What survivors are worth.
    survival : array_like, shape (...)
        The probability to survive, in (0, 1]; where it is 0 all die. Others give NaN.
    u : array_like, shape (...)
        Uniform numbers in [0, 1): those below `survival` survive. All broadcast.
    fallback : array_like, shape (...)
        What the dead are worth.

    Returns
    -------
    ndarray, shape (...)
        (value - (1 - q) fallback) / q for survivors, else the fallback. Its mean over `u` is the value.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, or shapes do not broadcast.

    Notes
    -----
    Saves work, never variance: the variance grows by (1/q - 1) (value - fallback)². A survival of 0 where the value is
    not the fallback's is a bias.

    References
    ----------
    J. Arvo, D. Kirk, *Particle transport and image synthesis*, 1990.

    Examples
    --------
    >>> russian_roulette([1.0, 1.0], 0.5, [0.3, 0.8])
    array([2., 0.])
    """
    dtype = _arrays.result_dtype(values=values)
    v, q, x, c = (
        _arrays.floats(k, a, dtype)
        for k, a in (("values", values), ("survival", survival), ("u", u), ("fallback", fallback))
    )
    core = {"values": (v, 0), "survival": (q, 0), "u": (x, 0), "fallback": (c, 0)}
    shape, (v, q, x, c) = _arrays.broadcast(core)
    with np.errstate(divide="ignore", invalid="ignore"):
        out = np.where(x < q, (v - (1 - q) * c) / q, c)
        out = np.where((q >= 0) & (q <= 1) & (x >= 0) & (x <= 1), out, np.nan)
    return np.asarray(out, dtype).reshape(shape)
