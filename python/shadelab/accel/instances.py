"""Two levels: placed copies of hierarchies."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from typing import Any, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import accel as _kernels
from ..transform import normal_matrix
from ._rays import Hit, Progress, hit_arrays, ray_arrays
from ._structure import Counts, Stats
from .bvh import BVH

__all__ = ["AllInstanceHits", "InstanceHit", "InstancedBVH"]

# Normals that are carried at a time.
_TOGETHER = 1 << 16


class InstanceHit(NamedTuple):
    """Where rays meet instances; as `Hit`, with the number of the instance, -1 at misses."""

    t: Floats
    """Distance in units of the direction's length, in the world."""
    face: NDArray[np.int32]
    """Of the instance's own mesh."""
    u: Floats
    v: Floats
    instance: NDArray[np.int32]
    normal: Floats | None = None
    """Unit normals in the world, (..., 3), if asked for; NaN at misses and on faces without area."""


class AllInstanceHits(NamedTuple):
    """Every hit of a batch of rays, one ray after the other; each ray's by `t`, then by instance, then by face."""

    offsets: NDArray[np.int64]
    """Where each ray's hits begin, and where the last one's end: (rays + 1,). Rays count in the batch's C order."""
    t: Floats
    face: NDArray[np.int32]
    u: Floats
    v: Floats
    instance: NDArray[np.int32]


class InstancedBVH:
    """Placed copies of hierarchies, and a hierarchy over them: a forest costs one tree and a matrix for each other.

    Parameters
    ----------
    objects : sequence of BVH
        One for each instance; the same one as often as it stands in the scene. All of one precision.
    transforms : array_like, shape (N, 4, 4) or (4, 4)
        Affine matrices from each object's space to the world; mirrored, sheared and scaled as they may be.

    Raises
    ------
    TypeError, ValueError
        If an object is no BVH or of another precision, a matrix is not affine, not finite, or singular (to 1e-12 of
        its largest entries); the first that is bad is named.

    Notes
    -----
    A ray is carried into each object's space with its direction unnormalised, so `t` is the world's, and answered
    there: to the bit what the object's BVH gives for `carried` rays. Equal `t` goes to the lowest instance, then the
    lowest face. The boxes of the upper hierarchy are widened so that none culls a hit (the bound heads the kernel).

    No ray passes between faces of one instance that share an edge. Between faces of two instances that only meet in
    the world it may: each is carried and rounded for itself.

    Examples
    --------
    >>> import numpy as np
    >>> import shadelab as sl
    >>> box = sl.mesh.box()
    >>> one = sl.accel.BVH(box.positions, box.faces)
    >>> two = InstancedBVH([one, one], [sl.transform.translate([0, 0, -5]), sl.transform.scale(2.0)])
    >>> hit = two.closest_hit([0.1, 0.2, 9], [0, 0, -1])
    >>> float(hit.t), int(hit.instance)
    (8.0, 1)
    """

    def __init__(self, objects: Sequence[BVH], transforms: ArrayLike) -> None:
        self._place(objects, transforms)

    def _place(self, objects: Sequence[BVH], transforms: ArrayLike) -> None:
        if isinstance(objects, np.ndarray) or not isinstance(objects, Iterable):
            raise TypeError(f"objects: expected a sequence of BVHs, got {type(objects).__name__}")
        objects = tuple(objects)
        for i, bvh in enumerate(objects):
            if not isinstance(bvh, BVH):
                raise TypeError(f"objects: expected BVHs, got {type(bvh).__name__} at {i}")
            if bvh.dtype != objects[0].dtype:
                raise TypeError(f"objects: expected all of {objects[0].dtype}, got {bvh.dtype} at {i}")
        m = _arrays.matrices("transforms", transforms, 4, np.float64)
        m = m.reshape(-1, 4, 4) if m.size else m.reshape(0, 4, 4)
        if len(m) != len(objects):
            raise ValueError(f"transforms: expected {len(objects)}, one for each of objects, got {len(m)}")
        self._dtype = objects[0].dtype if objects else np.dtype(np.float64)
        self._objects, self._transforms = objects, m.copy()
        self._inverse = _inverses(self._transforms)
        trees = [bvh._tree for bvh in objects]
        start = time.perf_counter()
        self._tree = _kernels.Instances(trees, self._transforms, self._inverse, self._dtype == np.float64)
        self._build_ms = (time.perf_counter() - start) * 1e3
        self._faces = max((len(bvh.faces) for bvh in objects), default=0)

    @property
    def objects(self) -> tuple[BVH, ...]:
        """Each instance's hierarchy."""
        return self._objects

    @property
    def transforms(self) -> Floats:
        """Each instance's matrix, (N, 4, 4), in double precision."""
        return self._transforms.copy()

    @property
    def dtype(self) -> np.dtype[Any]:
        """The precision of queries."""
        return self._dtype

    def __len__(self) -> int:
        return len(self._objects)

    def carried(self, origins: ArrayLike, directions: ArrayLike, instance: int) -> tuple[Floats, Floats]:
        """Rays in the space of an instance's object, as the queries carry them, to the bit.

        Parameters
        ----------
        origins, directions : array_like, shape (..., 3)
            Rays in the world, converted to the structure's precision.
        instance : int
            Which instance.

        Returns
        -------
        origins, directions : ndarray, shape (..., 3)

        Raises
        ------
        TypeError, ValueError
            If an argument is not real or not of its shape; there is no such instance.
        """
        m = self._inverse[_arrays.count("instance", instance, 0, len(self) - 1)]

        def linear(v: Floats) -> Floats:
            # In the order of the kernel's sums.
            x = np.asarray(v, np.float64)
            return x[..., :1] * m[:3, 0] + x[..., 1:2] * m[:3, 1] + x[..., 2:] * m[:3, 2]

        o = _arrays.vectors("origins", origins, 3, self._dtype)
        d = _arrays.vectors("directions", directions, 3, self._dtype)
        with np.errstate(invalid="ignore", over="ignore"):
            return (linear(o) + m[:3, 3]).astype(self._dtype), linear(d).astype(self._dtype)

    def __repr__(self) -> str:
        return f"InstancedBVH({len(self)} instances, {self.dtype})"

    def __copy__(self) -> Self:
        other = type(self).__new__(type(self))
        other.__dict__.update(self.__dict__)
        return other

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        # Nothing in it ever changes.
        return self.__copy__()

    def __getstate__(self) -> dict[str, Any]:
        # The upper hierarchy follows from the objects and their places.
        return {"objects": self._objects, "transforms": self._transforms}

    def __setstate__(self, state: dict[str, Any]) -> None:
        missing = {"objects", "transforms"} - set(state)
        if missing:
            raise ValueError(f"the saved {type(self).__name__} lacks {', '.join(sorted(missing))}")
        self._place(state["objects"], state["transforms"])

    def stats(self) -> Stats:
        """Size and make of the upper hierarchy; each of `objects` tells its own.

        Returns
        -------
        Stats
            `faces` and `references` count instances.
        """
        return Stats._make((*self._tree.stats(), self._build_ms))

    def closest_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        ignore_face: ArrayLike | None = None,
        ignore_instance: ArrayLike | None = None,
        *,
        normals: bool = False,
        out: InstanceHit | None = None,
        progress: Progress = None,
    ) -> InstanceHit:
        """Find the nearest hit of each ray.

        Parameters
        ----------
        origins, directions, t_min, t_max, progress
            As for `BVH.closest_hit`, in the world.
        ignore_face, ignore_instance : int or array_like of int, shape (...), optional
            The face and instance on which a ray starts, and which it does not meet there; -1 for none. Both or neither.
        normals : bool
            Return unit normals in the world as well.
        out : InstanceHit, optional
            Arrays to write into, of the batch's shape and the structure's dtype.

        Returns
        -------
        InstanceHit
            Arrays of the batch's shape.

        Raises
        ------
        TypeError, ValueError
            As `BVH.closest_hit` does; one of `ignore_face` and `ignore_instance` is missing.

        Notes
        -----
        Rays are followed one by one, not in packets: pictures gain nothing from their coherence. Normals are carried as
        `shadelab.transform.transform_normals` does: what was outside stays so, in mirrored copies too.
        """
        shape, rays, ignored = self._rays(origins, directions, t_min, t_max, ignore_face, ignore_instance)
        hit = self._hit_arrays(shape, _arrays.flag("normals", normals), out)
        for array in hit[:5] if out is not None else ():
            *rays, ignored = _arrays.apart(array, *rays, ignored)
        callback = _arrays.progress_callback(progress, "closest_hit")
        flat = [a.reshape(-1) for a in (hit.t, hit.face, hit.u, hit.v)]
        self._tree.closest_hit(rays, ignored, flat, hit.instance.reshape(-1), callback)
        if hit.normal is not None:
            self._normals(hit.face.reshape(-1), hit.instance.reshape(-1), hit.normal.reshape(-1, 3))
        return hit

    def any_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        ignore_face: ArrayLike | None = None,
        ignore_instance: ArrayLike | None = None,
        *,
        out: NDArray[np.bool_] | None = None,
        progress: Progress = None,
    ) -> NDArray[np.bool_]:
        """Whether each ray hits anything.

        Parameters
        ----------
        origins, directions, t_min, t_max, ignore_face, ignore_instance, progress
            As for `closest_hit`.
        out : ndarray of bool, optional
            Array to write into, of the batch's shape.

        Returns
        -------
        ndarray of bool, of the batch's shape

        Raises
        ------
        TypeError, ValueError
            As `closest_hit` does.
        """
        shape, rays, ignored = self._rays(origins, directions, t_min, t_max, ignore_face, ignore_instance)
        result = _arrays.output("out", out, shape, np.bool_)
        callback = _arrays.progress_callback(progress, "any_hit")
        self._tree.any_hit(rays, ignored, result.reshape(-1), callback)
        return result

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        ignore_face: ArrayLike | None = None,
        ignore_instance: ArrayLike | None = None,
        *,
        progress: Progress = None,
    ) -> AllInstanceHits:
        """Find every hit of each ray, in every instance: none lost, none twice.

        Parameters
        ----------
        origins, directions, t_min, t_max, ignore_face, ignore_instance, progress
            As for `closest_hit`.

        Returns
        -------
        AllInstanceHits
            The hits of all rays; those of ray `i` stand at `offsets[i]:offsets[i + 1]`.

        Raises
        ------
        TypeError, ValueError
            As `closest_hit` does.
        MemoryError
            If there is no memory for all hits.
        """
        _, rays, ignored = self._rays(origins, directions, t_min, t_max, ignore_face, ignore_instance)
        return AllInstanceHits(*self._tree.all_hits(rays, ignored, _arrays.progress_callback(progress, "all_hits")))

    def counts(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        ignore_face: ArrayLike | None = None,
        ignore_instance: ArrayLike | None = None,
        *,
        query: Literal["closest_hit", "any_hit", "all_hits"] = "closest_hit",
        progress: Progress = None,
    ) -> Counts:
        """Count the boxes and triangles that each ray tests, in the upper hierarchy and in the objects together.

        Parameters
        ----------
        origins, directions, t_min, t_max, ignore_face, ignore_instance, progress
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
        """
        _arrays.choice("query", query, ("closest_hit", "any_hit", "all_hits"))
        shape, rays, ignored = self._rays(origins, directions, t_min, t_max, ignore_face, ignore_instance)
        result = Counts(np.empty(shape, np.int32), np.empty(shape, np.int32))
        out = [result.boxes.reshape(-1), result.triangles.reshape(-1)]
        self._tree.counts(query, rays, ignored, out, _arrays.progress_callback(progress, "counts"))
        return result

    def _rays(
        self, o: ArrayLike, d: ArrayLike, t_min: ArrayLike, t_max: ArrayLike, face: Any, instance: Any
    ) -> tuple[tuple[int, ...], list[NDArray[Any]], NDArray[np.int32]]:
        """The batch's shape, the rays' arrays, and the instances in which faces are ignored."""
        if (face is None) != (instance is None):
            raise ValueError("ignore_face, ignore_instance: expected both or neither")
        shape, arrays = ray_arrays(self._dtype, self._faces, o, d, t_min, t_max, face, instance, len(self))
        return shape, arrays[:5], arrays[5]

    def _hit_arrays(self, shape: tuple[int, ...], normals: bool, out: InstanceHit | None) -> InstanceHit:
        if out is not None and not isinstance(out, InstanceHit):
            raise TypeError(f"out: expected an InstanceHit, got {type(out).__name__}")
        given = None if out is None else Hit(out.t, out.face, out.u, out.v, out.normal)
        hit = hit_arrays(shape, self._dtype, normals, given)
        instance = _arrays.output("out.instance", None if out is None else out.instance, shape, np.int32)
        return InstanceHit(*hit[:4], instance, hit.normal)

    def _normals(self, face: NDArray[np.int32], instance: NDArray[np.int32], out: Floats) -> None:
        """Normals of faces, carried to the world; NaN at misses."""
        out[...] = np.nan
        cofactors = normal_matrix(self._transforms)
        for bvh in {id(b): b for b in self._objects}.values():
            mine = np.array([b is bvh for b in self._objects])
            hits = np.flatnonzero((instance >= 0) & mine[instance])
            own = np.empty((hits.size, 3), self._dtype)
            _kernels.normals(bvh._positions, bvh._faces, face[hits], own)
            for some in (slice(at, at + _TOGETHER) for at in range(0, hits.size, _TOGETHER)):
                world = np.einsum("nij,nj->ni", cofactors[instance[hits[some]]], own[some].astype(np.float64))
                with np.errstate(invalid="ignore"):
                    out[hits[some]] = world / np.linalg.norm(world, axis=-1, keepdims=True)


def _inverses(m: Floats) -> Floats:
    """The inverses of affine matrices; what has none is refused."""
    for i, matrix in enumerate(m):
        if not np.isfinite(matrix).all():
            raise ValueError(f"transforms: matrix {i} is not finite")
        if not np.array_equal(matrix[3], [0, 0, 0, 1]):
            raise ValueError(
                f"transforms: expected affine matrices, the last row of matrix {i} is {matrix[3].tolist()}"
            )
        largest = np.abs(matrix[:3, :3]).max()
        if largest < 1e-150 or largest > 1e150 or np.linalg.svd(matrix[:3, :3] / largest)[1][-1] < 1e-12:
            raise ValueError(f"transforms: matrix {i} is singular")
    return np.ascontiguousarray(np.linalg.inv(m))
