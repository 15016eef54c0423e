"""Rays against primitives."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import geometry as _kernels

__all__ = ["RayHit", "ray_triangle"]


class RayHit(NamedTuple):
    """Where rays meet triangles; `t` infinite and `u`, `v` zero where they do not."""

    t: Floats
    """Distance in units of the direction's length."""
    u: Floats
    """Weight of the vertex `b`."""
    v: Floats
    """Weight of the vertex `c`."""


def ray_triangle(
    origins: ArrayLike,
    directions: ArrayLike,
    a: ArrayLike,
    b: ArrayLike,
    c: ArrayLike,
    method: Literal["watertight", "moller_trumbore", "plane"] = "watertight",
    *,
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
) -> RayHit:
    """Intersect rays with triangles, one with one.

    Parameters
    ----------
    origins, directions : array_like, shape (..., 3)
        Rays. Directions need not be of unit length.
    a, b, c : array_like, shape (..., 3)
        The triangles' vertices, in either winding. Leading axes broadcast.
    method : {"watertight", "moller_trumbore", "plane"}
        Edge functions in the ray's frame, which no ray slips past between triangles that share an edge; Cramer's
        rule on the edges; or the plane's point, then barycentrics. See Notes.
    t_min, t_max : float or array_like, shape (...)
        Hits lie in the open interval, in units of the direction's length.

    Returns
    -------
    RayHit
        `t`, `u`, `v` of the batch's shape: the point is `(1 - u - v) a + u b + v c`, and `origin + t direction`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast; a scalar interval holds NaN.

    Notes
    -----
    Computed in the promoted precision of rays and triangles. Borders count as inside; rays in the triangle's plane
    miss, and so do rays at triangles without area, unless they pass within round-off of them. NaN or infinity in a
    ray or a triangle, or a direction of no length, gives NaN at that element. Directions of any normal length are
    as good as unit ones. On triangles of good shape, met at 30 degrees or more, `t` is right to 5 machine epsilons
    of the distance.

    *watertight* decides by the exact sign of its edge functions on vertices that are off by at most
    `3.5 eps (|a - o|)`, alike for every triangle that shares them: rays at edges and vertices of a closed mesh always
    hit. The others round each triangle by itself; at edges some rays in a million pass between, and on slivers more.
    All weights lose digits as the triangle's longest edge over its height. *moller_trumbore* costs least; about 15, 10,
    15 ns a ray and thread. Coordinates beyond 1e18 in float32 (1e150 in float64) overflow, and miss.

    References
    ----------
    S. Woop, C. Benthin, I. Wald, *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013. T. Möller, B. Trumbore,
    *Fast, Minimum Storage Ray/Triangle Intersection*, Journal of Graphics Tools 2(1), 1997. D. Badouel, *An Efficient
    Ray-Polygon Intersection*, Graphics Gems, 1990.

    Examples
    --------
    >>> hit = ray_triangle([0.25, 0.5, 2.0], [0, 0, -1.0], [0, 0, 0], [1, 0, 0], [0, 1, 0])
    >>> float(hit.t), float(hit.u), float(hit.v)
    (2.0, 0.25, 0.5)
    """
    _arrays.choice("method", method, ("watertight", "moller_trumbore", "plane"))
    named = {"origins": origins, "directions": directions, "a": a, "b": b, "c": c}
    dtype = _arrays.result_dtype(**named)
    core = {n: (_arrays.vectors(n, v, 3, dtype), 1) for n, v in named.items()}
    for name, value in (("t_min", t_min), ("t_max", t_max)):
        array = _arrays.floats(name, value, dtype)
        if array.ndim == 0 and np.isnan(array):
            raise ValueError(f"{name}: expected a number, got nan")
        core[name] = (array, 0)
    shape, flat = _arrays.broadcast(core)
    t, u, v = (np.empty(shape, dtype) for _ in range(3))
    out = [x.reshape(-1) for x in (t, u, v)]
    _kernels.ray_triangle(method, flat[:2], flat[2:5], flat[5:], out)
    return RayHit(t, u, v)
