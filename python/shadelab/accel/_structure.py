"""The one protocol of all structures."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import accel as _kernels
from ._rays import AllHits, Hit, Progress, flat, hit_arrays, mesh_arrays, ray_arrays

__all__ = ["Counts", "Stats", "Structure"]


class Stats(NamedTuple):
    """The size and make of a structure."""

    faces: int
    nodes: int
    """Inner nodes; a grid is one."""
    leaves: int
    """Leaves, or cells, that hold triangles."""
    depth: int
    """Nodes above the deepest leaf."""
    references: int
    """Triangles in leaves, each as often as it stands there: more than `faces` where triangles straddle cells."""
    sah_cost: float
    """Nodes entered and triangles tested by a random line through the scene's box, on average, if nothing stops it
    (the surface area heuristic, with equal costs)."""
    bytes: int
    children_per_node: float
    """How many children nodes have on average."""
    triangles_per_block: float
    """How many triangles are tested together on average, four at most."""
    build_ms: float
    """How long the build took, milliseconds."""


class Counts(NamedTuple):
    """What each ray costs; arrays of the rays' shape."""

    boxes: NDArray[np.int32]
    """Boxes, cells or planes tested: each structure says which."""
    triangles: NDArray[np.int32]
    """Triangles tested."""


class Structure:
    """What all structures over triangles share: the queries, which equal `brute_force` to the bit.

    Made by its subclasses: `BVH`, `UniformGrid`, `Octree`, `KDTree`, `BSPTree`.
    """

    _kernel: ClassVar[Callable[..., Any]]
    """Builds the tree from positions, faces, options and a callback of progress."""
    _positions: Floats
    _faces: NDArray[np.int32]
    _tree: Any
    _build_ms: float
    _options: tuple[Any, ...]

    def _build(self, positions: ArrayLike, faces: ArrayLike, progress: Progress, *options: Any) -> None:
        p, f = mesh_arrays(positions, faces)
        # Own copies: normals are computed from them after the user may have changed the arrays.
        self._positions, self._faces = p.copy(), f.copy()
        self._positions.flags.writeable = self._faces.flags.writeable = False
        callback = _arrays.progress_callback(progress, type(self).__name__)
        start = time.perf_counter()
        self._tree = type(self)._kernel(self._positions, self._faces, *options, callback)
        self._build_ms, self._options = (time.perf_counter() - start) * 1e3, options

    def __copy__(self) -> Self:
        other = type(self).__new__(type(self))
        other.__dict__.update(self.__dict__)
        return other

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        # Nothing in it ever changes.
        return self.__copy__()

    def __getstate__(self) -> dict[str, Any]:
        # The tree follows from the mesh and the options, at every number of threads.
        return {"positions": self._positions, "faces": self._faces, "options": self._options}

    def __setstate__(self, state: dict[str, Any]) -> None:
        missing = {"positions", "faces", "options"} - set(state)
        if missing:
            raise ValueError(f"the saved {type(self).__name__} lacks {', '.join(sorted(missing))}")
        self._build(state["positions"], state["faces"], None, *state["options"])

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
        return f"{type(self).__name__}({s.faces} faces, {self.dtype}, {s.bytes / 2**20:.1f} MiB)"

    def stats(self) -> Stats:
        """Size and make: nodes, depth, expected cost, bytes, time of the build.

        Returns
        -------
        Stats
        """
        return Stats._make((*self._tree.stats(), self._build_ms))

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

        In a `BVH` neighbouring rays that run alike (a picture's, shape (H, W, 3)) are traced as packets: some 20 ns a
        ray and thread on meshes of 10^4 to 10^6 faces, and random rays 0.2 to 0.4 µs.
        """
        shape, rays = self._rays(origins, directions, t_min, t_max, ignore_face)
        hit = hit_arrays(shape, self.dtype, _arrays.flag("normals", normals), out)
        callback = _arrays.progress_callback(progress, "closest_hit")
        for array in hit[:4] if out is not None else ():
            rays = list(_arrays.apart(array, *rays))
        _kernels.closest_hit(self._tree, rays, _width(shape), flat(hit), callback)
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
        callback = _arrays.progress_callback(progress, "any_hit")
        _kernels.any_hit(self._tree, rays, _width(shape), result.reshape(-1), callback)
        return result

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        ignore_face: ArrayLike | None = None,
        *,
        progress: Progress = None,
    ) -> AllHits:
        """Find every hit of each ray: none lost, none twice.

        Parameters
        ----------
        origins, directions, t_min, t_max, ignore_face, progress
            As for `closest_hit`.

        Returns
        -------
        AllHits
            The hits of all rays, one ray after the other in the order of the flattened batch; those of ray `i` stand at
            `offsets[i]:offsets[i + 1]`, by `t`, then by face. The first is the ray's `closest_hit`.

        Raises
        ------
        TypeError, ValueError
            As `closest_hit` does.
        MemoryError
            If there is no memory for all hits.

        Notes
        -----
        What is no ray (see `closest_hit`) has no hits. A ray through an edge that faces share meets them all or, within
        round-off, one of them. Memory is linear in hits: 16 bytes each in float32 (28 in float64), twice for a moment.
        """
        shape, rays = self._rays(origins, directions, t_min, t_max, ignore_face)
        callback = _arrays.progress_callback(progress, "all_hits")
        return AllHits(*_kernels.all_hits(self._tree, rays, _width(shape), callback))

    def counts(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        ignore_face: ArrayLike | None = None,
        *,
        query: Literal["closest_hit", "any_hit", "all_hits"] = "closest_hit",
        progress: Progress = None,
    ) -> Counts:
        """Count the boxes and triangles that each ray tests.

        Parameters
        ----------
        origins, directions, t_min, t_max, ignore_face, progress
            As for `closest_hit`.
        query : str
            The query that is followed: "closest_hit", "any_hit" or "all_hits".

        Returns
        -------
        Counts
            int32 arrays of the batch's shape.

        Raises
        ------
        TypeError, ValueError
            As `closest_hit` does; `query` is another word.

        Notes
        -----
        Rays are followed one by one: what traces them together tests a box once for many. Zeros where there is no ray.
        """
        _arrays.choice("query", query, ("closest_hit", "any_hit", "all_hits"))
        shape, rays = self._rays(origins, directions, t_min, t_max, ignore_face)
        result = Counts(np.empty(shape, np.int32), np.empty(shape, np.int32))
        out = [result.boxes.reshape(-1), result.triangles.reshape(-1)]
        _kernels.counts(query, self._tree, rays, out, _arrays.progress_callback(progress, "counts"))
        return result

    def _rays(self, *rays: Any) -> tuple[tuple[int, ...], list[NDArray[Any]]]:
        return ray_arrays(self.dtype, self._faces.shape[0], *rays)


def _width(shape: tuple[int, ...]) -> int:
    """The width of the pictures whose rays a batch of this shape may be; 0 for a list of rays."""
    return shape[-1] if len(shape) > 1 else 0
