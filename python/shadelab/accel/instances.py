"""Two levels: placed copies of hierarchies."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import accel as _kernels
from ._rays import Progress, ray_arrays
from .bvh import BVH

__all__ = ["AllInstanceHits", "InstanceHit", "InstancedBVH"]


class InstanceHit(NamedTuple):
    """Where rays meet instances; as `Hit`, with the number of the instance, -1 at misses."""

    t: Floats
    """Distance in units of the direction's length, in the world."""
    face: NDArray[np.int32]
    """Of the instance's own mesh."""
    u: Floats
    v: Floats
    instance: NDArray[np.int32]


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
        self._tree = _kernels.Instances(trees, self._transforms, self._inverse, self._dtype == np.float64)
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

    def closest_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        *,
        progress: Progress = None,
    ) -> InstanceHit:
        """Find the nearest hit of each ray.

        Parameters
        ----------
        origins, directions, t_min, t_max, progress
            As for `BVH.closest_hit`, in the world.

        Returns
        -------
        InstanceHit
            Arrays of the batch's shape.

        Raises
        ------
        TypeError, ValueError
            As `BVH.closest_hit` does.

        Notes
        -----
        Rays are followed one by one, not in packets: pictures gain nothing from their coherence.
        """
        shape, rays = self._rays(origins, directions, t_min, t_max)
        t, u, v = (np.empty(shape, self._dtype) for _ in range(3))
        face, instance = np.empty(shape, np.int32), np.empty(shape, np.int32)
        out = [a.reshape(-1) for a in (t, face, u, v)]
        callback = _arrays.progress_callback(progress, "closest_hit")
        self._tree.closest_hit(rays, out, instance.reshape(-1), callback)
        return InstanceHit(t, face, u, v, instance)

    def any_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        *,
        progress: Progress = None,
    ) -> NDArray[np.bool_]:
        """Whether each ray hits anything.

        Parameters
        ----------
        origins, directions, t_min, t_max, progress
            As for `BVH.closest_hit`, in the world.

        Returns
        -------
        ndarray of bool, of the batch's shape

        Raises
        ------
        TypeError, ValueError
            As `BVH.closest_hit` does.
        """
        shape, rays = self._rays(origins, directions, t_min, t_max)
        result = np.empty(shape, np.bool_)
        self._tree.any_hit(rays, result.reshape(-1), _arrays.progress_callback(progress, "any_hit"))
        return result

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        *,
        progress: Progress = None,
    ) -> AllInstanceHits:
        """Find every hit of each ray, in every instance: none lost, none twice.

        Parameters
        ----------
        origins, directions, t_min, t_max, progress
            As for `BVH.closest_hit`, in the world.

        Returns
        -------
        AllInstanceHits
            The hits of all rays; those of ray `i` stand at `offsets[i]:offsets[i + 1]`.

        Raises
        ------
        TypeError, ValueError
            As `BVH.closest_hit` does.
        """
        _, rays = self._rays(origins, directions, t_min, t_max)
        return AllInstanceHits(*self._tree.all_hits(rays, _arrays.progress_callback(progress, "all_hits")))

    def _rays(self, *rays: Any) -> tuple[tuple[int, ...], list[NDArray[Any]]]:
        o, d, t_min, t_max = rays
        return ray_arrays(self._dtype, self._faces, o, d, t_min, t_max, None)


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
