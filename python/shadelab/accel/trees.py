"""Trees that part space: octree, kd-tree, BSP tree."""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike

from .. import _arrays
from .._kernels import accel as _kernels
from ._order import Order, order
from ._rays import Progress
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

    def __init__(
        self,
        positions: ArrayLike,
        faces: ArrayLike,
        *,
        leaf_size: int = 8,
        max_depth: int = 16,
        progress: Progress = None,
    ) -> None:
        size, depth = _arrays.count("leaf_size", leaf_size, 1), _arrays.count("max_depth", max_depth, 0, 32)
        self._build(positions, faces, _kernels.octree, progress, size, depth)

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
        size, depth = _arrays.count("leaf_size", leaf_size, 1), _depth(max_depth, 8, 1.3, len(faces))  # type: ignore[arg-type]
        self._build(positions, faces, _kernels.kd_tree, progress, method, size, depth)


class BSPTree(Structure):
    """A tree of planes that part space in two, which also orders what it holds.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices. Their dtype, float32 or float64, governs every query.
    faces : array_like of int, shape (F, 3)
        Indices of vertices; at most 2**27 faces, also none.
    leaf_size : int
        Cells with so many triangles, or fewer, are not parted.
    max_depth : int, optional
        Nor are cells so deep, up to 96; from the number of faces if None.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Raises
    ------
    TypeError, ValueError
        As `BVH` does; `leaf_size` or `max_depth` out of range.

    Notes
    -----
    Each cell is halved in the middle, across x, y and z in turn. A triangle stands in every cell that its box reaches
    into, 16 on average at most: then cells stay whole. Boxes counted are planes tested, one for each inner node
    visited.

    References
    ----------
    T. Akenine-Möller, E. Haines, N. Hoffman, *Real-Time Rendering*, 4th edition, 2018, section 19.1.2.

    Examples
    --------
    >>> tree = BSPTree([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> hit = tree.closest_hit([0.25, 0.5, 2], [0, 0, -1])
    >>> float(hit.t), int(hit.face)
    (2.0, 0)
    """

    def __init__(
        self,
        positions: ArrayLike,
        faces: ArrayLike,
        *,
        leaf_size: int = 8,
        max_depth: int | None = None,
        progress: Progress = None,
    ) -> None:
        size, depth = _arrays.count("leaf_size", leaf_size, 1), _depth(max_depth, 16, 2.0, len(faces))  # type: ignore[arg-type]
        self._build(positions, faces, _kernels.bsp_tree, progress, size, depth)

    def order(self, eye: ArrayLike, *, front_to_back: bool = False) -> Order:
        """Faces by their distance from an eye.

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
        the nearest), may not.
        """
        return order(self._tree, self.dtype, eye, front_to_back)


def _depth(max_depth: int | None, least: int, more: float, faces: int) -> int:
    if max_depth is not None:
        return _arrays.count("max_depth", max_depth, 0, 96)
    return int(least + more * max(faces, 1).bit_length())
