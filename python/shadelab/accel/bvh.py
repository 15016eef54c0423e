"""The bounding volume hierarchy."""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike

from .. import _arrays
from .._kernels import accel as _kernels
from ._rays import Progress
from ._structure import Structure
from .moving import Movable
from .points import PointQueries

__all__ = ["BVH"]


Method = Literal["sah", "median", "lbvh"]


class BVH(PointQueries, Movable, Structure):
    """A bounding volume hierarchy over triangles: nodes of eight boxes, leaves of blocks of four triangles.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices. Their dtype, float32 or float64, governs every query.
    faces : array_like of int, shape (F, 3)
        Indices of vertices; at most 2**27 faces, also none.
    method : {"sah", "median", "lbvh"}
        Binned surface area heuristic; halves by the order of centres; or Morton order. See Notes.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Raises
    ------
    TypeError, ValueError
        If an array is of the wrong kind or shape, an index is out of range, a vertex is not finite or beyond 1e18
        (float64: 1e150), the whole mesh is smaller than 1e-12 (1e-100), or `method` is another word; the first that is
        bad is named.

    Notes
    -----
    Built in parallel; the tree does not depend on the number of threads. *sah* is the best to trace. *median* builds in
    about as long and *lbvh* in a third of it or less; random rays then take some 1.2 to 1.5 times as long. About 60 bytes
    a face in float32, 120 in float64. The arrays are copied: later changes to them do not matter.

    Boxes counted are those of all children of every node visited, up to eight each.

    Answers equal `brute_force` to the bit, at every SIMD level and number of threads, and through every way that rays
    are traced. No ray passes between faces that share an edge (watertight), in either precision and at any distance
    from the origin, up to coordinates of 1e18 in float32 and 1e150 in float64.

    References
    ----------
    I. Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, 2007. T. Karras, *Maximizing Parallelism in
    the Construction of BVHs, Octrees, and k-d Trees*, 2012. S. Woop, C. Benthin, I. Wald,
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

    _kernel = staticmethod(_kernels.build)

    def __init__(
        self, positions: ArrayLike, faces: ArrayLike, *, method: Method = "sah", progress: Progress = None
    ) -> None:
        _arrays.choice("method", method, ("sah", "median", "lbvh"))
        self._build(positions, faces, progress, method)
