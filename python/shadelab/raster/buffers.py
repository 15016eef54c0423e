"""The G-buffer: what deferred shading needs of each pixel, in one pass."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import raster as _kernels
from . import _arguments
from ._arguments import Cull, Depth

__all__ = ["GBuffer", "g_buffer"]


class GBuffer(NamedTuple):
    """What deferred shading asks of each sample: arrays (H, W) or (H, W, S), vectors (…, 3)."""

    face: NDArray[np.int32]
    """The nearest face; -1 where there is none."""
    u: Floats
    """Weight of the face's second vertex."""
    v: Floats
    """Weight of the face's third vertex."""
    depth: Floats
    """z / w in the range of the depth convention; infinite where there is no face."""
    position: Floats
    """The point seen, in the space of the given positions; 0 where there is no face."""
    normal: Floats
    """Unit normal, interpolated or the face's own; 0 where there is no face."""
    material: NDArray[np.int32]
    """The face's material; -1 where there is no face."""


def g_buffer(
    clip: ArrayLike,
    faces: ArrayLike,
    positions: ArrayLike,
    size: tuple[int, int],
    samples: int = 1,
    *,
    normals: ArrayLike | None = None,
    material_ids: ArrayLike | None = None,
    cull: Cull = "none",
    depth: Depth = "standard",
    out: GBuffer | None = None,
) -> GBuffer:
    """Face, depth, position, normal and material of each sample, in one pass.

    Parameters
    ----------
    clip, faces, size, samples, cull, depth
        As in `rasterize`.
    positions : array_like, shape (V, 3)
        The vertices in the space in which shading happens, usually the world's.
    normals : array_like, shape (V, 3), optional
        Normals at the vertices; without them each face has its own, ``cross(b - a, c - a)`` made a unit vector.
    material_ids : array_like of int, shape (F,), optional
        Material of each face; without them all are 0.
    out : GBuffer, optional
        Arrays to write into: fresh memory costs as much as drawing.

    Returns
    -------
    GBuffer
        `face`, `u`, `v`, `depth`, `position`, `normal`, `material`.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range.

    Notes
    -----
    The same bits as `rasterize` and `interpolate`, except that normals are of unit length (a vanishing one is zero).
    Writes 44 (80) bytes a sample in float32 (float64).

    References
    ----------
    T. Saito, T. Takahashi, *Comprehensible Rendering of 3-D Shapes*, 1990.

    Examples
    --------
    >>> clip, positions = [[-1, -1, 0, 1], [3, -1, 0, 1], [-1, 3, 0, 1]], [[0, 0, 5], [4, 0, 5], [0, 4, 5]]
    >>> seen = g_buffer(clip, [[0, 1, 2]], positions, (2, 2))
    >>> seen.position[1, 0], seen.normal[1, 0]
    (array([0.5, 0.5, 5. ]), array([0., 0., 1.]))
    """
    points, triangles = _arguments.clip(clip), _arguments.faces(faces)
    dtype = points.dtype
    world = _arrays.vectors("positions", positions, 3, dtype)
    directions = None if normals is None else _arrays.vectors("normals", normals, 3, dtype)
    for name, array in (("positions", world), ("normals", directions)):
        if array is not None and array.shape != (len(points), 3):
            raise ValueError(f"{name}: expected shape ({len(points)}, 3), got {array.shape}")
    ids = None if material_ids is None else _arrays.indices("material_ids", material_ids)
    if ids is not None and ids.shape != (len(triangles),):
        raise ValueError(f"material_ids: expected shape ({len(triangles)},), got {ids.shape}")
    (width, height), samples = _arguments.size(size), _arguments.samples(samples)
    modes = _arguments.modes(cull, depth)
    shape = (height, width) if samples == 1 else (height, width, samples)
    if out is not None and not isinstance(out, GBuffer):
        raise TypeError(f"out: expected a GBuffer, got {type(out).__name__}")
    result = GBuffer(
        *(
            _arrays.output(
                f"out.{name}",
                None if out is None else getattr(out, name),
                (*shape, 3) if name in ("position", "normal") else shape,
                np.int32 if name in ("face", "material") else dtype,
            )
            for name in GBuffer._fields
        )
    )
    _kernels.g_buffer(points, triangles, (world, directions, ids), (width, height), samples, *modes, list(result))
    return result
