"""What the hierarchy knows about points: nearest points of the mesh, inside and outside."""

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
    _moments: Any = None
    _pseudonormals: Any = None

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
        limit = _arrays.knob_array("max_distance", max_distance, dtype)
        if limit.ndim:
            given["max_distance"] = (limit, 0)
        full = _arrays.flag("full_output", full_output)
        brute = _arrays.choice("method", method, ("tree", "brute_force")) == "brute_force"
        shape, flat = _arrays.broadcast(given)
        limits = flat[1] if limit.ndim else limit.reshape(1)
        n = flat[0].shape[0]
        point, distance, u, v = np.empty((n, 3), dtype), *(np.empty(n, dtype) for _ in range(3))
        face, feature = np.empty(n, np.int32), np.empty(n, np.int32)
        callback = _arrays.progress_callback(progress, "closest_point")
        _kernels.closest_point(self._tree, flat[0], limits, [point, distance, face, u, v, feature], brute, callback)
        results: list[Any] = [a.reshape(shape) for a in (distance, face, u, v, feature)[: 5 if full else 4]]
        return ClosestPoint(point.reshape((*shape, 3)), *results)

    def winding_number(
        self,
        points: ArrayLike,
        *,
        max_error: float = 1e-3,
        out: Floats | None = None,
        progress: Progress = None,
    ) -> Floats:
        """How often the mesh goes round each point: one inside a closed mesh, zero outside, fractions at open ones.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            Points, converted to the structure's precision.
        max_error : float
            By how much the answer may be off: far parts of the mesh are taken by their moments. With 0 every triangle
            is summed, at a cost linear in their number.
        out : ndarray, optional
            Array to write into, of the batch's shape and the structure's dtype.
        progress : bool or callable, optional
            True for a bar, or called with (done, total).

        Returns
        -------
        ndarray, of the batch's shape
            The solid angle of the mesh seen from each point, over 4π; positive where faces show their backs, that is
            inside a mesh whose faces run counter-clockwise seen from outside.

        Raises
        ------
        TypeError, ValueError
            If `points` is not real or not of its shape; `max_error` is negative or not finite.

        Notes
        -----
        `max_error` is proven (the derivation heads the kernel), and the error seen smaller by a hundred times as a
        rule. Summed in double precision in either dtype, by an exact predicate where a point is next to a triangle's
        plane: of a closed mesh the sum over all is an integer to some 1e-11 for every point that is not on it, however
        near. On a face it is the mean of both sides. Where meshes overlap numbers add up; a mesh inside out counts
        negative. A point that is not finite gives NaN and touches no other.

        The first call with a bound computes the moments, and keeps them: 192 bytes a node, some 10 to 20 a face.

        References
        ----------
        A. Jacobson, L. Kavan, O. Sorkine-Hornung, *Robust Inside-Outside Segmentation using Generalized Winding
        Numbers*, 2013. G. Barill, N. Dickson, R. Schmidt, D. Levin, A. Jacobson, *Fast Winding Numbers for Soups and
        Clouds*, 2018. A. van Oosterom, J. Strackee, *The Solid Angle of a Plane Triangle*, 1983.

        Examples
        --------
        >>> import shadelab as sl
        >>> box = sl.mesh.box()
        >>> sl.accel.BVH(box.positions, box.faces).winding_number([[0, 0, 0], [2, 0, 0]]).round(2) + 0.0
        array([1., 0.])
        """
        error = _arrays.number("max_error", max_error, 0.0)
        p = _arrays.vectors("points", points, 3, self._positions.dtype)
        result = _arrays.output("out", out, p.shape[:-1], p.dtype)
        moments = self._moments
        if error and moments is None:
            moments = self._moments = _kernels.Moments(self._tree)
        callback = _arrays.progress_callback(progress, "winding_number")
        (p,) = _arrays.apart(result, p.reshape(-1, 3))
        _kernels.winding_number(self._tree, moments if error else None, error, p, result.reshape(-1), callback)
        return result

    def contains(self, points: ArrayLike, *, max_error: float = 0.01, progress: Progress = None) -> NDArray[np.bool_]:
        """Whether each point is inside: its winding number exceeds one half.

        Parameters
        ----------
        points, max_error, progress
            As for `winding_number`.

        Returns
        -------
        ndarray of bool, of the batch's shape

        Raises
        ------
        TypeError, ValueError
            As `winding_number` does.

        Notes
        -----
        Of closed meshes whose faces all run one way, this is exact for every point that is not on the surface: their
        winding numbers are integers, and any `max_error` below one half tells them apart. Closed parts may overlap
        (the union counts), touch, or share edges three at a time. Open meshes are completed by the surface where the
        winding number is one half; near it `max_error` counts. Points on the surface may go either way; what is not
        finite is outside.

        Examples
        --------
        >>> import shadelab as sl
        >>> torus = sl.mesh.torus()
        >>> sl.accel.BVH(torus.positions, torus.faces).contains([[0, 0, 0], [1, 0, 0]])
        array([False,  True])
        """
        # Comparisons with NaN are false.
        return np.asarray(self.winding_number(points, max_error=max_error, progress=progress) > 0.5)

    def signed_distance(
        self,
        points: ArrayLike,
        method: Literal["winding", "angle_weighted"] = "winding",
        *,
        max_error: float = 0.01,
        progress: Progress = None,
    ) -> Floats:
        """The distance of each point from the surface, negative inside.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            Points, converted to the structure's precision.
        method : {"winding", "angle_weighted"}
            How inside is told from outside: by the winding number (see `contains`), or by the angle-weighted normal
            at the nearest point.
        max_error : float
            Of the winding number, as for `contains`.
        progress : bool or callable, optional
            True for a bar, or called with (done, total).

        Returns
        -------
        ndarray, of the batch's shape
            `closest_point(points).distance` with its sign; infinite if there are no faces.

        Raises
        ------
        TypeError, ValueError
            If `points` is not real or not of its shape; `method` is another word; as `winding_number` does.

        Notes
        -----
        Which is right where:

        - closed meshes, faces counter-clockwise seen from outside: both.
        - open meshes: "winding" completes them sensibly; "angle_weighted" tells the side of the nearest face, so its
          zero set is the surface alone, and beyond a border the sign jumps.
        - overlapping or nested closed parts: "winding" takes the union; "angle_weighted" is wrong within overlaps,
          where the nearest face may be an inner one. The distance is that to the nearest face, also an inner one.
        - non-manifold edges, as of solids that touch: "winding" is right; "angle_weighted" is not always, there.
        - flipped faces: "winding" where few are; "angle_weighted" next to them not.
        - self-intersection: "winding" counts what is wound at least once as inside.

        Vertices at one position count as one, so that split vertices (of seams) do no harm. "angle_weighted" costs
        little beside `closest_point`; its normals are computed at the first call and kept, some 120 bytes a face.

        References
        ----------
        J. A. Bærentzen, H. Aanæs, *Signed Distance Computation Using the Angle Weighted Pseudonormal*, 2005; and as
        for `winding_number`.

        Examples
        --------
        >>> import shadelab as sl
        >>> box = sl.mesh.box((2, 2, 2))
        >>> sl.accel.BVH(box.positions, box.faces).signed_distance([[0, 0, 0.5], [0, 0, 3]])
        array([-0.5,  2. ])
        """
        _arrays.choice("method", method, ("winding", "angle_weighted"))
        near = self.closest_point(points, full_output=True, progress=progress)
        p = _arrays.vectors("points", points, 3, self._positions.dtype)
        distance = near.distance
        if method == "winding":
            inside = self.contains(p, max_error=max_error, progress=progress)
            return np.where(inside, -distance, distance)
        if self._pseudonormals is None:
            self._pseudonormals = _kernels.Pseudonormals(self._positions, self._faces)
        nearest = [near.point.reshape(-1, 3), near.face.reshape(-1), np.asarray(near.feature).reshape(-1)]
        self._pseudonormals.sign(p.reshape(-1, 3), nearest, distance.reshape(-1))
        return distance
