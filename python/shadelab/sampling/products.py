"""The product of means in place of the mean of a product."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .monte_carlo import Function, _problem, _values

__all__ = ["Split", "split_integral"]


class Split(NamedTuple):
    """The product approximation of ∫ f g and what it misses."""

    product: Any
    """Mean of f on g's support, times ∫ g."""
    integral: Any
    """∫ f g itself, by quadrature."""
    error: Any
    """`product - integral`."""
    mean_f: Any
    integral_g: Any
    bound: Any
    """|error| is at most this: the support's size times both standard deviations on it."""


def split_integral(
    f: Function | ArrayLike,
    g: Function | ArrayLike,
    *,
    low: ArrayLike = 0.0,
    high: ArrayLike = 1.0,
    nodes: int = 256,
    weights: ArrayLike | None = None,
) -> Split:
    """∫ f g ≈ (mean of f on g's support) × ∫ g: what shadow maps, ambient occlusion and split sums rest on.

    Parameters
    ----------
    f, g : callables, or array_like of shape (..., n)
        From points (n, d) to values (n,); or values at the nodes of a quadrature of one's own.
    low, high : array_like, shape () or (d,)
        The box, for callables.
    nodes : int
        Along each axis, for callables: composite Gauss-Legendre quadrature of 4 nodes a panel.
    weights : array_like, shape (n,), optional
        The quadrature's weights, for arrays; by default 1/n each: means.

    Returns
    -------
    Split
        The product, the integral, the error, its factors and its bound.

    Raises
    ------
    TypeError, ValueError
        If an argument is out of its domain, or only one of `f` and `g` is callable.

    Notes
    -----
    The error is minus the support's size times the covariance of f and g on it: none where either is constant there, or
    where they are unrelated. So the approximation is good where g's support is small (a point light) or f is smooth
    (a diffuse surface under even light). Where f or g jumps, the quadrature itself errs by about a panel.

    References
    ----------
    T. Akenine-Möller and others, *Real-Time Rendering*, 2018, section 7.
    B. Karis, *Real Shading in Unreal Engine 4*, 2013 (the split sum).

    Examples
    --------
    >>> found = split_integral(lambda x: x[:, 0], lambda x: 1 + x[:, 0])
    >>> round(found.product, 6), round(found.integral, 6), round(found.error, 6)
    (0.75, 0.833333, -0.083333)
    """
    if callable(f) != callable(g):
        raise TypeError("f, g: expected two callables or two arrays, got one of each")
    if callable(f) and callable(g):
        nodes = _arrays.count("nodes", nodes, 4, 4096)
        p = _problem(f, low, high, "plain", (), "balance", None, 0.5)
        points, w = _grid(nodes // 4, len(p.low))
        points, w = p.low + points * p.extent, w * float(np.prod(p.extent))
        fs, gs = _values("f", f, points), _values("g", g, points)
    else:
        fs, gs = (np.asarray(_arrays.floats(k, v), np.float64) for k, v in (("f", f), ("g", g)))  # type: ignore[arg-type]
        if fs.ndim == 0 or gs.ndim == 0 or fs.shape[-1] != gs.shape[-1]:
            raise ValueError(f"f, g: expected values at the same nodes, got shapes {fs.shape} and {gs.shape}")
        n = fs.shape[-1]
        w = np.full(n, 1 / n) if weights is None else np.asarray(_arrays.floats("weights", weights), np.float64)
        if w.shape != (n,):
            raise ValueError(f"weights: expected shape ({n},), got {w.shape}")
    inside = gs != 0
    with np.errstate(invalid="ignore", divide="ignore"):
        size = (w * inside).sum(-1)
        mean_f = np.where(size > 0, (w * inside * fs).sum(-1) / size, 0.0)
        integral_g = (w * gs).sum(-1)
        mean_g = np.where(size > 0, integral_g / size, 0.0)
        spread = [(w * inside * (x - m[..., None]) ** 2).sum(-1) for x, m in ((fs, mean_f), (gs, mean_g))]
    integral, product = (w * fs * gs).sum(-1), mean_f * integral_g
    bound = np.sqrt(np.maximum(spread[0], 0) * np.maximum(spread[1], 0))
    found = (product, integral, product - integral, mean_f, integral_g, bound)
    return Split(*(float(x) if np.ndim(x) == 0 else x for x in found))


def _grid(panels: int, d: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes and weights of the unit cube."""
    if (4 * panels) ** d > 1 << 24:
        raise ValueError(f"nodes: expected at most {int((1 << 24) ** (1 / d))} along each of {d} axes")
    x, w = np.polynomial.legendre.leggauss(4)
    x = ((np.arange(panels)[:, None] + (x + 1) / 2) / panels).ravel()
    w = np.tile(w / 2 / panels, panels)
    points = np.stack(np.meshgrid(*[x] * d, indexing="ij"), -1).reshape(-1, d)
    return points, np.asarray(np.prod(np.meshgrid(*[w] * d, indexing="ij"), axis=0)).ravel()
