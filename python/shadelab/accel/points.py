"""What the hierarchy knows about points: the nearest point of the mesh."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import accel as _kernels
from ._rays import Progress

__all__ = ["ClosestPoint"]


class ClosestPoint(NamedTuple):
    """The points of a mesh nearest to others; every array has the batch's shape.

    The point is `(1 - u - v) a + u b + v c` of the face's vertices. Where nothing is near enough `distance` is
    infinite, `face` -1, `point` NaN, `u` and `v` zero. What is no point (see `BVH.closest_point`) has NaN, and
    `face` -1.
    """

    point: Floats
    """Shape (..., 3)."""
    distance: Floats
    face: NDArray[np.int32]
    u: Floats
    v: Floats
    feature: NDArray[np.int32] | None = None
    """With `full_output`: 0 inside the face, 1 to 3 on the edges ab, bc, ca, 4 to 6 at the vertices a, b, c; or -1."""


class PointQueries:
    """The queries of `BVH` about points."""

    _tree: Any
    _positions: Floats
    _faces: NDArray[np.int32]

    def closest_point(
        self,
        points: ArrayLike,
        max_distance: ArrayLike = np.inf,
        *,
        method: Literal["tree", "brute_force"] = "tree",
        full_output: bool = False,
        progress: Progress = None,
    ) -> ClosestPoint:
        """Find the point of the mesh that is nearest to each point.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            Points, converted to the structure's precision.
        max_distance : float or array_like, shape (...)
            Only what is nearer counts. For all points, or for each; a good bound saves much time.
        method : {"tree", "brute_force"}
            Brute force tests every triangle, and gives the same bits.
        full_output : bool
            Also say whether each point lies inside its face, on an edge or at a vertex.
        progress : bool or callable, optional
            True for a bar, or called with (done, total).

        Returns
        -------
        ClosestPoint
            Arrays of the batch's shape.

        Raises
        ------
        TypeError, ValueError
            If an argument is not real, not of its shape, or does not broadcast; a scalar `max_distance` is NaN.

        Notes
        -----
        Of faces at equal computed distance the lowest is taken, as at a vertex that several share. On an edge the
        faces' distances may differ by a rounding, and either be found. `distance` is right to 4 machine epsilons of
        the distance to the face's farthest vertex (on slivers whose height is below 1e-4 of their length in float32,
        1e-10 in float64, to 64). The point found lies in its face, but along a sliver it may slide by more.
        A point with NaN or infinity, or with a
        coordinate beyond 1e18 in float32 and 1e150 in float64, gives NaN and touches no other.

        References
        ----------
        C. Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5.

        Examples
        --------
        >>> import shadelab as sl
        >>> bvh = sl.accel.BVH([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> near = bvh.closest_point([[0.25, 0.25, 2], [2, 0, 0]])
        >>> near.distance, near.point[1]
        (array([2., 1.]), array([1., 0., 0.]))
        """
        dtype = self._positions.dtype
        given: dict[str, tuple[Floats, int]] = {"points": (_arrays.vectors("points", points, 3, dtype), 1)}
        limit = _arrays.floats("max_distance", max_distance, dtype)
        if limit.ndim:
            given["max_distance"] = (limit, 0)
        elif np.isnan(limit):
            raise ValueError("max_distance: expected a number, got nan")
        brute = _arrays.choice("method", method, ("tree", "brute_force")) == "brute_force"
        shape, flat = _arrays.broadcast(given)
        limits = flat[1] if limit.ndim else limit.reshape(1)
        n = flat[0].shape[0]
        point, distance, u, v = np.empty((n, 3), dtype), *(np.empty(n, dtype) for _ in range(3))
        face, feature = np.empty(n, np.int32), np.empty(n, np.int32)
        callback = _arrays.progress_callback(progress, "closest_point")
        _kernels.closest_point(self._tree, flat[0], limits, [point, distance, face, u, v, feature], brute, callback)
        results: list[Any] = [a.reshape(shape) for a in (distance, face, u, v, feature)[: 5 if full_output else 4]]
        return ClosestPoint(point.reshape((*shape, 3)), *results)
