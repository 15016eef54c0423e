"""Light from the lights, reflected once at given points, with its error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays, light
from .._arrays import Floats
from .._kernels import pathtrace as _kernels
from ..accel import BVH
from ._common import Estimate, check_bvh, merge, surface_offset

__all__ = ["DirectLight", "direct_light"]


class DirectLight(NamedTuple):
    """Direct light at given points."""

    radiance: Floats
    """Mean of the samples, (..., 3), in W/(m² sr)."""
    variance: Floats
    """Variance of that mean if samples were independent, (..., 3): for scrambled points an upper bound as a rule."""
    samples: int
    """How many samples each rectangle has."""

    def merge(self, other: DirectLight) -> DirectLight:
        """One estimate of this run and another over different samples (by `start` or by seed)."""
        return DirectLight(*merge(Estimate(*self), Estimate(*other)))


def direct_light(
    bvh: BVH,
    lights: light.Light | Sequence[light.Light],
    points: ArrayLike,
    normals: ArrayLike,
    base_color: ArrayLike,
    metallic: ArrayLike = 0.0,
    roughness: ArrayLike = 0.5,
    specular: ArrayLike = 1.0,
    *,
    wo: ArrayLike | None = None,
    eye: ArrayLike | None = None,
    material_ids: ArrayLike | None = None,
    samples: int = 256,
    start: int = 0,
    seed: int = 0,
    geometric_normals: ArrayLike | None = None,
    offset: float | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> DirectLight:
    """Light from the lights, reflected once at given points, with exact shadows: the reference of shadow techniques.

    Parameters
    ----------
    bvh : BVH
        What stands in the way; its precision governs.
    lights : light or sequence of lights
        Their sum is returned.
    points, normals : array_like, shape (..., 3)
        Surface points and unit (shading) normals.
    base_color : array_like, shape (3,), (..., 3) or (m, 3)
        See `shadelab.brdf.metallic_roughness`: one material for all points, one for each, or a table of m.
    metallic, roughness, specular : array_like
        Likewise, without the last axis.
    wo : array_like, shape (..., 3), optional
        Unit directions to the eye. Either this or `eye` is needed.
    eye : array_like, shape (3,), optional
        The eye's position.
    material_ids : array_like of int, shape (...), optional
        Rows of the table; a negative one marks no surface, whose radiance is zero.
    samples : int
        Of each rectangle (a point of it, and a direction of the mirrors' lobe); powers of two are the best.
    start : int
        Index of the first sample, for going on where a run ended: `merge` the results.
    seed : int
        Runs of different seeds are independent.
    geometric_normals : array_like, shape (..., 3), optional
        Unit normals of the faces themselves, for light from below them and for `offset`; `normals` if None.
    offset : float, optional
        How far above the surface shadow rays start; 16 rounding units of the largest coordinate if None.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Returns
    -------
    DirectLight
        Radiance towards the eye, the variance of that mean, the number of samples. Zero seen from below a surface, NaN
        where an element is not a number.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, a row is out of the table, or neither or both of `wo` and `eye` are given.

    Notes
    -----
    Lights of some size stop, from the side that shines, the light of others, as in `path_trace`.

    Unbiased, but for light that passes between a surface and what touches it within `offset`. Samples are
    Owen-scrambled Sobol' points: behind an edge of shadow the error falls about as samples^(-3/4), so that `variance`
    overstates it; half the squared difference of two seeds is an unbiased measure. Sums are in double. The same bits
    for the same seed, whatever the threads.

    References
    ----------
    E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.
    A. B. Owen, *Scrambled net variance for integrals of smooth functions*, 1997.

    Examples
    --------
    >>> blocker = BVH([[-1.0, 1, -1], [1, 1, -1], [0, 1, 1]], [[0, 1, 2]])
    >>> sun, up = light.DirectionalLight((0, -1, 0), irradiance=(np.pi,) * 3), [0.0, 1.0, 0.0]
    >>> direct_light(blocker, sun, [[0.0, 0, 0], [5.0, 0, 0]], up, [0.5] * 3, specular=0.0, wo=up).radiance
    array([[0. , 0. , 0. ],
           [0.5, 0.5, 0.5]])
    """
    check_bvh(bvh)
    table = light._table("lights", lights)
    dtype = bvh._positions.dtype
    r = light._receivers(points, normals, wo, eye, (base_color, metallic, roughness, specular), material_ids, dtype)
    samples = _arrays.count("samples", samples, 1, 1 << 24)
    start = _arrays.count("start", start, 0, 2**32 - samples)
    seed = _arrays.count("seed", seed, 0, 2**64 - 1)
    above = surface_offset(bvh._positions) if offset is None else _arrays.number("offset", offset, 0.0)
    faces = None
    if geometric_normals is not None:
        faces = _arrays.vectors("geometric_normals", geometric_normals, 3, dtype)
        if faces.shape != (*r.shape, 3):
            raise ValueError(f"geometric_normals: expected shape {(*r.shape, 3)}, got {faces.shape}")
        faces = faces.reshape(-1, 3)
    mean, variance = (np.empty((*r.shape, 3), dtype) for _ in range(2))
    _kernels.direct_light(
        bvh._tree,
        r.arrays,
        r.is_eye,
        r.material_ids,
        (faces, above),
        table,
        (samples, start, seed),
        (mean.reshape(-1, 3), variance.reshape(-1, 3)),
        _arrays.progress_callback(progress, "direct light"),
    )
    return DirectLight(mean, variance, samples)
