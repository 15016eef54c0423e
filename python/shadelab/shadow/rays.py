"""Shadows by rays: the reference of all maps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays, accel
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ..accel import BVH
from ..light import (
    AmbientLight,
    DirectionalLight,
    DiskLight,
    PointLight,
    PolygonLight,
    RectLight,
    SphereLight,
    SpotLight,
)
from ..light.kinds import Light, _table
from ._lookup import _MAX_SAMPLES, _points, _result
from .maps import _unit

__all__ = ["ray_traced"]

Sampler: TypeAlias = Literal["sobol", "independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton"]


def ray_traced(
    bvh: BVH,
    receivers: ArrayLike,
    normals: ArrayLike | None,
    light: Light,
    samples: int = 16,
    *,
    sampler: Sampler = "sobol",
    offsets: ArrayLike | None = None,
    seed: int = 0,
    ignore_face: ArrayLike | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
    out: Floats | None = None,
) -> Floats:
    """Shadows by rays to points on the light: no map, no bias, noise instead.

    Parameters
    ----------
    bvh : BVH
        Everything that casts a shadow; its precision governs.
    receivers : array_like, shape (..., 3)
        Points in the world.
    normals : array_like, shape (..., 3), or None
        Unit normals of the receivers. With them, points of the light count by the irradiance that they would send, and
        rays start a little off the surface; without, as they are drawn (by area; of spheres and ambient light by solid
        angle), and from the receiver itself.
    light : light of shadelab.light
        What rays are sent to; one ray suffices for a light without extent. Of a spot light what stands before it
        counts, not its cone; to ambient light rays go in all directions.
    samples : int
        Rays to a light with an area, at most 4096; powers of two are most even.
    sampler : {"sobol", "independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton"}
        The point set over the light, drawn for each receiver anew; as `pathtrace.path_trace` takes it.
    offsets : array_like, shape (..., 2), optional
        With them all receivers share one point set, each shifted by its own offset modulo 1. From two tiles of
        `sampling.blue_noise_mask`, looked up by pixel, the noise of neighbours differs as much as it can, and the eye
        averages it.
    seed : int
        Scrambles the points of the light, for each receiver anew.
    ignore_face : array_like of int, shape (...), optional
        The face that each receiver lies on, which then hides nothing; -1 for none.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total).
    out : ndarray, shape (...), optional
        The array to write into.

    Returns
    -------
    ndarray, shape (...)
        The lit fraction; 1 where no point of the light is above the receiver's horizon; NaN where a receiver or normal
        is not finite.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range.

    Notes
    -----
    Tends to the exact fraction as `samples` grows: the error of a penumbra falls about as samples^(-3/4), since a
    shadow edge across the stratified light is all that varies; with "independent" points as samples^(-1/2). With
    normals the estimate is a ratio of two sums, whose bias falls as 1 / samples; it is exact, without noise, where the
    light is wholly seen or hidden. Surfaces nearer to the light than 1e-4 of the distance hide nothing. Cost: `samples`
    shadow rays.

    References
    ----------
    E. Heitz, S. Hill, M. McGuire, *Combining Analytic Direct Illumination and Stochastic Shadows*, I3D 2018. R. Cook,
    T. Porter, L. Carpenter, *Distributed Ray Tracing*, 1984.

    Examples
    --------
    >>> from shadelab.accel import BVH
    >>> from shadelab.light import RectLight
    >>> roof = BVH([[-9.0, 1, -9], [0, 1, -9], [0, 1, 9], [-9, 1, 9]], [[0, 1, 2], [0, 2, 3]])
    >>> light = RectLight(center=(0, 2, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 1), radiance=(1, 1, 1))
    >>> ray_traced(roof, [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]], None, light, samples=64)
    array([0. , 0.5, 1. ])
    """
    if not isinstance(bvh, BVH):
        raise TypeError(f"bvh: expected a BVH, got {type(bvh).__name__}")
    n = _arrays.count("samples", samples, 1, _MAX_SAMPLES)
    key = _arrays.count("seed", seed, 0, 2**64 - 1)
    shape, points, normal = _points(bvh.dtype, receivers, normals)
    faces = None
    if ignore_face is not None:
        ids = accel._rays.ignored("ignore_face", ignore_face, "a face", len(bvh._faces))
        try:
            faces = np.ascontiguousarray(np.broadcast_to(ids, shape), np.int32).reshape(-1)
        except ValueError:
            raise ValueError(f"ignore_face: expected shape {shape}, got {ids.shape}") from None
    _arrays.choice("sampler", sampler, get_args(Sampler))
    shifts = None
    if offsets is not None:
        wide = _arrays.vectors("offsets", offsets, 2, np.float64)
        if not np.isfinite(wide).all():
            raise ValueError("offsets: expected finite numbers")
        # In double, before a sample is added: large ones would leave no digits to it.
        given = (wide - np.floor(wide)).astype(bvh.dtype)
        try:
            shifts = np.ascontiguousarray(np.broadcast_to(given, (*shape, 2))).reshape(-1, 2)
        except ValueError:
            raise ValueError(f"offsets: expected shape {(*shape, 2)}, got {given.shape}") from None
    zero = [0.0, 0.0, 0.0]
    table: NDArray[np.float64] | None = None
    if isinstance(light, RectLight):
        kind, vectors = "rect", [list(map(float, v)) for v in (light.center, light.edge_u, light.edge_v)]
    elif isinstance(light, PointLight | SpotLight):
        kind, vectors, n = "point", [list(map(float, light.position)), zero, zero], 1
    elif isinstance(light, DirectionalLight):
        towards = -_unit("light", np.asarray(light.direction, np.float64))
        kind, vectors, n = "directional", [towards.tolist(), zero, zero], 1
    elif isinstance(light, DiskLight | SphereLight | PolygonLight | AmbientLight):
        kind, vectors, table = "area", [zero, zero, zero], _table("light", light)
    else:
        raise TypeError(f"light: expected a light of shadelab.light, got {type(light).__name__}")
    # Points on a surface are off it by some roundings of the largest coordinate.
    reach = float(np.abs(bvh.positions).max(initial=0.0))
    offset = 32.0 * float(np.finfo(bvh.dtype).eps) * reach
    result, flat_out = _result(out, shape, bvh.dtype)
    watch = _arrays.progress_callback(progress, "shadow rays")
    target = (kind, vectors, table)
    _kernels.ray_traced(bvh._tree, points, normal, faces, target, n, (sampler, key), shifts, offset, watch, flat_out)
    return result
