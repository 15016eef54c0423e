"""The bounding volume hierarchy."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import accel as _kernels
from ._rays import Hit, Progress, flat, hit_arrays, mesh_arrays, ray_arrays

__all__ = ["BVH", "Stats"]


class Stats(NamedTuple):
    """The size of a tree."""

    faces: int
    nodes: int
    blocks: int
    bytes: int
    children_per_node: float
    triangles_per_block: float


class BVH:
    """A bounding volume hierarchy over triangles: nodes of eight boxes, leaves of blocks of four triangles.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices. Their dtype, float32 or float64, governs every query.
    faces : array_like of int, shape (F, 3)
        Indices of vertices; at most 2**27 faces, also none.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Raises
    ------
    TypeError, ValueError
        If an array is of the wrong kind or shape, an index is out of range, a vertex is not finite or beyond 1e18
        (float64: 1e150), or the whole mesh is smaller than 1e-12 (1e-100); the first that is bad is named.

    Notes
    -----
    Binned surface area heuristic, built in parallel; the tree does not depend on the number of threads. About 60 bytes
    a face in float32, 120 in float64. The arrays are copied: later changes to them do not matter.

    Answers equal `brute_force` to the bit, at every SIMD level and number of threads, and through every way that rays
    are traced. No ray passes between faces that share an edge (watertight), in either precision and at any distance
    from the origin, up to coordinates of 1e18 in float32 and 1e150 in float64.

    References
    ----------
    I. Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007. S. Woop, C. Benthin, I. Wald,
    *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013.

    Examples
    --------
    >>> import numpy as np
    >>> triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    >>> bvh = BVH(triangle, [[0, 1, 2]])
    >>> hit = bvh.closest_hit([[0.25, 0.5, 2], [2, 2, 2]], [0, 0, -1])
    >>> hit.t, hit.face, hit.u, hit.v
    (array([ 2., inf], dtype=float32), array([ 0, -1], dtype=int32), array([0.25, 0.  ], dtype=float32), array([0.5, 0. ], dtype=float32))
    """  # noqa: E501

    def __init__(self, positions: ArrayLike, faces: ArrayLike, *, progress: Progress = None) -> None:
        p, f = mesh_arrays(positions, faces)
        # Own copies: normals are computed from them after the user may have changed the arrays.
        self._positions, self._faces = p.copy(), f.copy()
        self._positions.flags.writeable = self._faces.flags.writeable = False
        self._tree = _kernels.build(self._positions, self._faces, _arrays.progress_callback(progress, "BVH"))

    @property
    def positions(self) -> Floats:
        """The vertices, read-only."""
        return self._positions

    @property
    def faces(self) -> NDArray[np.int32]:
        """The faces, read-only."""
        return self._faces

    @property
    def dtype(self) -> np.dtype[Any]:
        """The precision of queries."""
        return self._positions.dtype

    def __repr__(self) -> str:
        s = self.stats()
        return f"BVH({s.faces} faces, {self.dtype}, {s.bytes / 2**20:.1f} MiB)"

    def stats(self) -> Stats:
        """Faces, nodes, blocks of triangles, bytes, and how full nodes (of 8) and blocks (of 4) are on average."""
        return Stats(*self._tree.stats())

    def closest_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        ignore_face: ArrayLike | None = None,
        *,
        normals: bool = False,
        out: Hit | None = None,
        progress: Progress = None,
    ) -> Hit:
        """Find the nearest hit of each ray.

        Parameters
        ----------
        origins, directions : array_like, shape (..., 3)
            Rays, converted to the structure's precision; leading axes broadcast. Directions need not be of unit length.
        t_min, t_max : float or array_like, shape (...)
            Hits lie in the open interval, in units of the direction's length: a ray with `t_max` at its nearest hit
            has none. For all rays, or for each.
        ignore_face : int or array_like of int, shape (...), optional
            A face that the ray does not meet, as the one that it starts on; -1 for none.
        normals : bool
            Return unit normals as well.
        out : Hit, optional
            Arrays to write into, of the batch's shape and the structure's dtype.
        progress : bool or callable, optional
            True for a bar, or called with (done, total).

        Returns
        -------
        Hit
            Arrays of the batch's shape.

        Raises
        ------
        TypeError, ValueError
            If an argument is not real, not of its shape, or does not broadcast; a scalar interval holds NaN.

        Notes
        -----
        Equal `t` goes to the lowest face. A ray with NaN or infinity in its origin or direction, NaN in its interval,
        or a direction of no (or less than the smallest normal) length gives NaN, and touches no other.

        `t` is right to a few units of round-off of the distance from the ray's origin to the triangle's vertices,
        divided by the cosine between ray and normal. Near the face's border, by as much, a ray may count as
        passing or missing it; the neighbour that shares the edge then has it.

        Neighbouring rays that run alike (a picture's, shape (H, W, 3)) are traced as packets: some 20 ns a ray and
        thread on meshes of 10^4 to 10^6 faces, and random rays 0.2 to 0.4 µs.
        """
        shape, rays = self._rays(origins, directions, t_min, t_max, ignore_face)
        hit = hit_arrays(shape, self.dtype, normals, out)
        _kernels.closest_hit(self._tree, rays, flat(hit), _arrays.progress_callback(progress, "closest_hit"))
        if hit.normal is not None:
            _kernels.normals(self._positions, self._faces, hit.face.reshape(-1), hit.normal.reshape(-1, 3))
        return hit

    def any_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        ignore_face: ArrayLike | None = None,
        *,
        out: NDArray[np.bool_] | None = None,
        progress: Progress = None,
    ) -> NDArray[np.bool_]:
        """Whether each ray hits anything: what shadows ask.

        Parameters
        ----------
        origins, directions, t_min, t_max, ignore_face, progress
            As for `closest_hit`.
        out : ndarray of bool, optional
            Array to write into, of the batch's shape.

        Returns
        -------
        ndarray of bool, of the batch's shape
            Equal to `closest_hit(...).face >= 0`, and found faster; False where there is no ray.

        Raises
        ------
        TypeError, ValueError
            As `closest_hit` does.
        """
        shape, rays = self._rays(origins, directions, t_min, t_max, ignore_face)
        result = _arrays.output("out", out, shape, np.bool_)
        _kernels.any_hit(self._tree, rays, result.reshape(-1), _arrays.progress_callback(progress, "any_hit"))
        return result

    def _rays(self, *rays: Any) -> tuple[tuple[int, ...], list[NDArray[Any]]]:
        return ray_arrays(self.dtype, self._faces.shape[0], *rays)
