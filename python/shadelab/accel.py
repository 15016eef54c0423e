"""Acceleration structures for ray queries, and the brute force that they must equal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._arrays import Floats
from ._kernels import accel as _kernels

__all__ = ["BVH", "Hit", "Stats", "brute_force", "offset_ray"]

Progress = bool | Callable[[int, int], object] | None


class Hit(NamedTuple):
    """Where rays meet a mesh; every array has the rays' shape.

    The point is `(1 - u - v) a + u b + v c` of the face's vertices, and `origin + t direction`. A miss has `t`
    infinite, `face` -1, `u` and `v` zero. What is no ray (see `BVH.closest_hit`) has `t`, `u`, `v` NaN and `face` -1.
    """

    t: Floats
    """Distance in units of the direction's length."""
    face: NDArray[np.int32]
    u: Floats
    v: Floats
    normal: Floats | None = None
    """Unit normals of the faces by their winding, (..., 3), if asked for; NaN at misses and on faces without area."""


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
        p, f = _mesh(positions, faces)
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
        hit = _hits(shape, self.dtype, normals, out)
        _kernels.closest_hit(self._tree, rays, _flat(hit), _arrays.progress_callback(progress, "closest_hit"))
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
        return _rays(self.dtype, self._faces.shape[0], *rays)


def brute_force(
    positions: ArrayLike,
    faces: ArrayLike,
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
    ignore_face: ArrayLike | None = None,
    *,
    progress: Progress = None,
) -> Hit:
    """Test every ray against every triangle: what each structure must return, to the bit.

    Parameters
    ----------
    positions, faces : array_like, shapes (V, 3) and (F, 3)
        The mesh, as for `BVH`; the vertices' dtype governs.
    origins, directions, t_min, t_max, ignore_face, progress
        The rays, as for `BVH.closest_hit`.

    Returns
    -------
    Hit
        Arrays of the batch's shape, without normals.

    Raises
    ------
    TypeError, ValueError
        As `BVH` and `BVH.closest_hit` do.

    Notes
    -----
    The rule that makes this comparable: a hit must pass its own triangle's box by the slab arithmetic of the nodes,
    its `t` is raised to the box's entry, and equal `t` goes to the lowest face. Slabs are padded by what the watertight
    test may be off by, so no hit is lost to its box. Costs about 1.5 ns times rays times faces, a thread.

    Examples
    --------
    >>> hit = brute_force([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [0.25, 0.5, 2], [0, 0, -1])
    >>> float(hit.t), int(hit.face)
    (2.0, 0)
    """
    p, f = _mesh(positions, faces)
    shape, rays = _rays(p.dtype, f.shape[0], origins, directions, t_min, t_max, ignore_face)
    hit = _hits(shape, p.dtype, False, None)
    _kernels.brute_force(p, f, rays, _flat(hit), _arrays.progress_callback(progress, "brute_force"))
    return hit


def offset_ray(
    points: ArrayLike,
    normals: ArrayLike,
    directions: ArrayLike | None = None,
    *,
    extent: ArrayLike | BVH | None = None,
    out: Floats | None = None,
) -> Floats:
    """Move points off the surface that they lie on, so that rays from there do not meet it again.

    Parameters
    ----------
    points : array_like, shape (..., 3)
        Points of faces, interpolated from the vertices: `(1 - u - v) a + u b + v c`.
    normals : array_like, shape (..., 3)
        Unit normals of the faces (not shading normals).
    directions : array_like, shape (..., 3), optional
        Rays that will start there; each point is moved to the side that its ray leaves to. Without, along the normal.
    extent : float or array_like, shape (...), or BVH, optional
        The largest coordinate, in magnitude, of the vertices of each point's face; or of a whole mesh, which a BVH
        knows. Without, that of all `points` together, which is right where they are spread over the mesh.
    out : ndarray, optional
        Array to write into, of the batch's shape and three components.

    Returns
    -------
    ndarray, shape (..., 3)
        Origins, 32 machine epsilons of `extent` away: 3.8e-6 of it in float32, 7e-15 in float64.

    Raises
    ------
    TypeError, ValueError
        If an argument is not real, not of its shape, or does not broadcast.

    Notes
    -----
    In the promoted precision of points, normals and directions. The distance is proven for the watertight test,
    from the round-off of interpolation, move and test (the derivation heads the kernel): a ray that leaves to its
    side never meets the face that it starts on, nor neighbours in its plane. That takes normals right to a tenth or
    so: on needles whose computed normal is not, use `ignore_face`. Points taken as `origin + t * direction` instead
    are off by about a machine epsilon of the ray's length, which the bound does not hold. What touches the surface
    within the distance (a box standing on a plane) may be passed by: the price of every offset. About 5 ns a point
    and thread.

    References
    ----------
    M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 4th edition, 2023, section 6.8. C. Wächter,
    N. Binder, *A Fast and Robust Method for Avoiding Self-Intersection*, Ray Tracing Gems, 2019, for the problem.

    Examples
    --------
    >>> offset_ray([1.0, 2.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.6, -0.8], extent=2.0)
    array([ 1.00000000e+00,  2.00000000e+00, -1.42108547e-14])
    """
    dtype = _arrays.result_dtype(points=points, normals=normals, directions=directions)
    p = _arrays.vectors("points", points, 3, dtype)
    core: dict[str, tuple[Floats, int]] = {
        "points": (p, 1),
        "normals": (_arrays.vectors("normals", normals, 3, dtype), 1),
    }
    if directions is not None:
        core["directions"] = (_arrays.vectors("directions", directions, 3, dtype), 1)
    if isinstance(extent, BVH):
        extent = float(np.abs(extent.positions).max(initial=0))
    elif extent is None:
        # NaN marks a bad point, not the extent of the others.
        extent = float(np.nan_to_num(np.abs(p), nan=0.0).max(initial=0))
    extents = _arrays.floats("extent", extent, dtype)
    if extents.ndim:
        core["extent"] = (extents, 0)
    shape, flat = _arrays.broadcast(core)
    arrays = dict(zip(core, flat, strict=True))
    result = _arrays.output("out", out, (*shape, 3), dtype)
    _kernels.offset_ray(
        arrays["points"],
        arrays["normals"],
        arrays.get("directions"),
        arrays.get("extent", extents.reshape(-1)),
        result.reshape(-1, 3),
    )
    return result


def _mesh(positions: ArrayLike, faces: ArrayLike) -> tuple[Floats, NDArray[np.int32]]:
    p = _arrays.vectors("positions", positions)
    if p.ndim != 2:
        raise ValueError(f"positions: expected shape (V, 3), got {p.shape}")
    array = np.asarray(faces)
    f = _arrays.indices("faces", array.reshape(0, 3) if array.size == 0 else array, 3, p.shape[0])
    if f.shape[0] > 2**27:
        raise ValueError(f"faces: expected at most {2**27}, got {f.shape[0]}")
    if not np.isfinite(p).all():
        at = int(np.argwhere(~np.isfinite(p).all(-1))[0, 0])
        raise ValueError(f"positions: vertex {at} is not finite: {p[at].tolist()}")
    if len(p):
        # Products of three edges must neither overflow nor vanish.
        largest, smallest = (1e18, 1e-12) if p.dtype == np.float32 else (1e150, 1e-100)
        far = np.abs(p).max(-1)
        if far.max() > largest:
            at = int(far.argmax())
            raise ValueError(f"positions: vertex {at} lies beyond {largest:g}: {p[at].tolist()}; scale the mesh down")
        extent = float(np.ptp(p, axis=0).max())
        if 0.0 < extent < smallest:
            raise ValueError(f"positions: extent {extent:g} is below {smallest:g}; scale the mesh up")
    return p, f


def _rays(
    dtype: np.dtype[Any],
    faces: int,
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: ArrayLike,
    t_max: ArrayLike,
    ignore_face: ArrayLike | None,
) -> tuple[tuple[int, ...], list[NDArray[Any]]]:
    """The batch's shape; origins, directions, t_min, t_max, ignore_face of its length, or of length one."""
    core: dict[str, tuple[NDArray[Any], int]] = {
        "origins": (_arrays.vectors("origins", origins, 3, dtype), 1),
        "directions": (_arrays.vectors("directions", directions, 3, dtype), 1),
    }
    for name, value in (("t_min", t_min), ("t_max", t_max)):
        array = _arrays.floats(name, value, dtype)
        if array.ndim == 0 and np.isnan(array):
            raise ValueError(f"{name}: expected a number, got nan")
        core[name] = (array, 0)
    core["ignore_face"] = (_ignored(ignore_face, faces), 0)
    # What is one for all stays one.
    many = {n: c for n, c in core.items() if c[1] or c[0].ndim}
    shape, flat = _arrays.broadcast(many)
    arrays = dict(zip(many, flat, strict=True))
    return shape, [arrays.get(n, core[n][0].reshape(-1)) for n in core]


def _ignored(ignore_face: ArrayLike | None, faces: int) -> NDArray[np.int32]:
    if ignore_face is None:
        return np.array(-1, np.int32)
    array = np.asarray(ignore_face)
    if array.dtype.kind not in "iu":
        raise TypeError(f"ignore_face: expected integers, got dtype {array.dtype}")
    bad = (array < -1) | (array >= max(faces, 1))
    if bad.any():
        raise ValueError(f"ignore_face: expected -1 or a face below {faces}, got {array[bad].flat[0]}")
    return np.require(array, np.int32, ["C", "A"])


def _hits(shape: tuple[int, ...], dtype: np.dtype[Any], normals: bool, out: Hit | None) -> Hit:
    given: Any = out if out is not None else Hit(*[None] * 4)  # type: ignore[arg-type]
    if not isinstance(given, Hit):
        raise TypeError(f"out: expected a Hit, got {type(out).__name__}")
    t, u, v = (_arrays.output(f"out.{n}", getattr(given, n), shape, dtype) for n in "tuv")
    face = _arrays.output("out.face", given.face, shape, np.int32)
    normal = _arrays.output("out.normal", given.normal, (*shape, 3), dtype) if normals else None
    return Hit(t, face, u, v, normal)


def _flat(hit: Hit) -> list[NDArray[Any]]:
    return [hit.t.reshape(-1), hit.face.reshape(-1), hit.u.reshape(-1), hit.v.reshape(-1)]
