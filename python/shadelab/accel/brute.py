"""Every ray against every triangle."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._kernels import accel as _kernels
from ._rays import AllHits, Hit, Progress, flat, hit_arrays, mesh_arrays, ray_arrays

__all__ = ["brute_force", "brute_force_all"]


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
    p, f = mesh_arrays(positions, faces)
    shape, rays = ray_arrays(p.dtype, f.shape[0], origins, directions, t_min, t_max, ignore_face)
    hit = hit_arrays(shape, p.dtype, False, None)
    callback = _arrays.progress_callback(progress, "brute_force")
    _kernels.closest_hit(_kernels.brute_force(p, f), rays, 0, flat(hit), callback)
    return hit


def brute_force_all(
    positions: ArrayLike,
    faces: ArrayLike,
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: ArrayLike = 0.0,
    t_max: ArrayLike = np.inf,
    ignore_face: ArrayLike | None = None,
    *,
    progress: Progress = None,
) -> AllHits:
    """Test every ray against every triangle and keep every hit: what `all_hits` of each structure must return.

    Parameters
    ----------
    positions, faces : array_like, shapes (V, 3) and (F, 3)
        The mesh, as for `BVH`; the vertices' dtype governs.
    origins, directions, t_min, t_max, ignore_face, progress
        The rays, as for `BVH.closest_hit`.

    Returns
    -------
    AllHits
        As `BVH.all_hits` gives.

    Raises
    ------
    TypeError, ValueError
        As `BVH` and `BVH.closest_hit` do.

    Notes
    -----
    By the rule of `brute_force`: a hit passes its own triangle's box, and its `t` is raised to the box's entry.

    Examples
    --------
    >>> floors = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
    >>> hits = brute_force_all(floors, [[0, 1, 2], [3, 4, 5]], [[0.25, 0.5, 2], [5, 5, 5]], [0, 0, -1])
    >>> hits.t, hits.face, hits.offsets
    (array([1., 2.]), array([1, 0], dtype=int32), array([0, 2, 2]))
    """
    p, f = mesh_arrays(positions, faces)
    _, rays = ray_arrays(p.dtype, f.shape[0], origins, directions, t_min, t_max, ignore_face)
    callback = _arrays.progress_callback(progress, "brute_force_all")
    return AllHits(*_kernels.all_hits(_kernels.brute_force(p, f), rays, 0, callback))
