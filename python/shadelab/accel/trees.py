"""Trees that part space: octree, kd-tree, BSP tree."""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike

from .. import _arrays
from .._kernels import accel as _kernels
from ._order import Order, order
from ._rays import Progress, mesh_arrays
from ._structure import Structure

__all__ = ["BSPTree", "KDTree", "Octree", "Order"]


class Octree(Structure):
    """An octree over triangles: cells parted in the middle into eight, as long as they hold more than some triangles.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices. Their dtype, float32 or float64, governs every query.
    faces : array_like of int, shape (F, 3)
        Indices of vertices; at most 2**27 faces, also none.
    leaf_size : int
        Cells with so many triangles, or fewer, are not parted.
    max_depth : int
        Nor are cells so deep, up to 32.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Raises
    ------
    TypeError, ValueError
        As `BVH` does; `leaf_size` or `max_depth` out of range.

    Notes
    -----
    A triangle stands in every cell that its box reaches into, 16 on average at most: then cells stay whole. Cells adapt
    to where detail is, but not to its shape: planes go through the middle, whatever they cut.

    Boxes counted are the octants of the nodes that a ray visits, empty ones left out.

    References
    ----------
    A. Glassner, *Space Subdivision for Fast Ray Tracing*, 1984. J. Revelles, C. Ureña, M. Lastra, *An Efficient
    Parametric Algorithm for Octree Traversal*, 2000.

    Examples
    --------
    >>> tree = Octree([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> hit = tree.closest_hit([0.25, 0.5, 2], [0, 0, -1])
    >>> float(hit.t), int(hit.face)
    (2.0, 0)
    """

    _kernel = staticmethod(_kernels.octree)

    def __init__(
        self,
        positions: ArrayLike,
        faces: ArrayLike,
        *,
        leaf_size: int = 8,
        max_depth: int = 16,
        progress: Progress = None,
    ) -> None:
        size, depth = _arrays.count("leaf_size", leaf_size, 1, 2**27), _arrays.count("max_depth", max_depth, 0, 32)
        self._build(positions, faces, progress, size, depth)

    def order(self, eye: ArrayLike, *, front_to_back: bool = False) -> Order:
        """Faces by their distance from an eye, roughly: as cells come.

        Parameters
        ----------
        eye : array_like, shape (3,)
            Where one looks from, at all sides.
        front_to_back : bool
            The nearest first, as occlusion culling wants them; else the farthest first, as painters do.

        Returns
        -------
        Order
            Each face once, with its corners.

        Raises
        ------
        TypeError, ValueError
            If `eye` is not a finite point.

        Notes
        -----
        Faces of different cells come in a true order; those within one cell, and those that stand in several (listed in
        the nearest), may not. `BSPTree` with "polygon_aligned" gives a true order.
        """
        return order(self._tree, self.dtype, eye, front_to_back)


class KDTree(Structure):
    """A kd-tree over triangles: cells parted by planes across axes, put where they pay most.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices. Their dtype, float32 or float64, governs every query.
    faces : array_like of int, shape (F, 3)
        Indices of vertices; at most 2**27 faces, also none.
    method : {"sah", "median"}
        Planes of least expected cost by the surface area heuristic, which also cuts off empty space; or the median of
        the triangles' centres, across the axis along which they spread most.
    leaf_size : int
        Cells with so many triangles, or fewer, are not parted.
    max_depth : int, optional
        Nor are cells so deep, up to 96; from the number of faces if None.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Raises
    ------
    TypeError, ValueError
        As `BVH` does; `method` is another word, `leaf_size` or `max_depth` out of range.

    Notes
    -----
    A triangle stands in every cell that its box reaches into, 16 on average at most: then cells stay whole. With "sah"
    cells are also kept whole where parting does not pay. Boxes counted are planes tested, one for each inner node
    visited.

    References
    ----------
    J. L. Bentley, *Multidimensional Binary Search Trees Used for Associative Searching*, 1975. V. Havran, *Heuristic
    Ray Shooting Algorithms*, 2000. M. Shevtsov, A. Soupikov, A. Kapustin, *Highly Parallel Fast KD-tree Construction
    for Interactive Ray Tracing of Dynamic Scenes*, 2007.

    Examples
    --------
    >>> tree = KDTree([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> hit = tree.closest_hit([0.25, 0.5, 2], [0, 0, -1])
    >>> float(hit.t), int(hit.face)
    (2.0, 0)
    """

    _kernel = staticmethod(_kernels.kd_tree)

    def __init__(
        self,
        positions: ArrayLike,
        faces: ArrayLike,
        *,
        method: Literal["sah", "median"] = "sah",
        leaf_size: int = 4,
        max_depth: int | None = None,
        progress: Progress = None,
    ) -> None:
        _arrays.choice("method", method, ("sah", "median"))
        size, (p, f) = _arrays.count("leaf_size", leaf_size, 1, 2**27), mesh_arrays(positions, faces)
        self._build(p, f, progress, method, size, _depth(max_depth, 8, 1.3, 96, len(f)))


class BSPTree(Structure):
    """A tree of planes that part space in two, which also orders what it holds.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices. Their dtype, float32 or float64, governs every query.
    faces : array_like of int, shape (F, 3)
        Indices of vertices; at most 2**27 faces, also none.
    method : {"axis_aligned", "polygon_aligned"}
        Each cell is halved in the middle, across x, y and z in turn; or parted by the plane of one of its triangles.
    leaf_size : int, optional
        Cells with so many triangles, or fewer, are not parted: 8, or 1 with "polygon_aligned".
    max_depth : int, optional
        Nor are cells so deep, up to 96 (128 with "polygon_aligned"); from the number of faces if None.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Raises
    ------
    TypeError, ValueError
        As `BVH` does; `method` is another word, `leaf_size` or `max_depth` out of range.

    Notes
    -----
    With "axis_aligned" a triangle stands in every cell that its box reaches into, 16 on average at most: then cells
    stay whole. Boxes counted are planes tested, one for each inner node visited.

    With "polygon_aligned" triangles that a plane crosses are cut, into eight fragments on average at most (and 4096
    more): then cells stay whole. Of eight triangles the one is taken whose plane cuts fewest and halves best; where
    none parts the cell well, as in convex meshes, a plane across an axis is. A triangle's side is exact; cut ones are
    followed in double precision, and what lies within 2e-14 of the scene's largest coordinates of a plane counts as
    lying in it. Rays are tested against whole triangles, so answers equal `brute_force` here too. Boxes counted are
    those around the triangles of the halves that a ray reaches. Made for `order`, not for speed.

    References
    ----------
    H. Fuchs, Z. Kedem, B. Naylor, *On Visible Surface Generation by A Priori Tree Structures*, SIGGRAPH 1980.
    T. Akenine-Möller, E. Haines, N. Hoffman, *Real-Time Rendering*, 4th edition, 2018, section 19.1.2.

    Examples
    --------
    >>> floors = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
    >>> tree = BSPTree(floors, [[0, 1, 2], [3, 4, 5]], method="polygon_aligned")
    >>> tree.order([0.0, 0, 5]).face, tree.order([0.0, 0, -5]).face
    (array([0, 1], dtype=int32), array([1, 0], dtype=int32))
    """

    _kernel = staticmethod(_kernels.bsp_tree)

    def __init__(
        self,
        positions: ArrayLike,
        faces: ArrayLike,
        *,
        method: Literal["axis_aligned", "polygon_aligned"] = "axis_aligned",
        leaf_size: int | None = None,
        max_depth: int | None = None,
        progress: Progress = None,
    ) -> None:
        _arrays.choice("method", method, ("axis_aligned", "polygon_aligned"))
        polygon = method == "polygon_aligned"
        size = (1 if polygon else 8) if leaf_size is None else _arrays.count("leaf_size", leaf_size, 1, 2**27)
        p, f = mesh_arrays(positions, faces)
        depth = _depth(max_depth, *((128, 0.0, 128) if polygon else (16, 2.0, 96)), len(f))
        self._build(p, f, progress, method, size, depth)

    def order(self, eye: ArrayLike, *, front_to_back: bool = False) -> Order:
        """Faces, or fragments of them, by their distance from an eye.

        Parameters
        ----------
        eye : array_like, shape (3,)
            Where one looks from, at all sides.
        front_to_back : bool
            The nearest first, as occlusion culling wants them; else the farthest first, as painters do.

        Returns
        -------
        Order
            With "axis_aligned" each face once, with its corners. With "polygon_aligned" triangles that are faces or,
            where a plane cut them, parts of faces.

        Raises
        ------
        TypeError, ValueError
            If `eye` is not a finite point.

        Notes
        -----
        With "polygon_aligned" and leaves of one fragment the order is true: nothing hides what comes after it, seen
        back to front, also where triangles overlap in a ring or pass through each other. Exceptions are cells that were
        kept whole by the limits of `BSPTree`, and what lies within round-off of one plane. With "axis_aligned" faces of
        different cells come in a true order; those within one cell, and those that stand in several (listed in the
        nearest), may not.
        """
        return order(self._tree, self.dtype, eye, front_to_back)


def _depth(max_depth: int | None, least: int, more: float, most: int, faces: int) -> int:
    if max_depth is not None:
        return _arrays.count("max_depth", max_depth, 0, most)
    return int(least + more * faces.bit_length())
