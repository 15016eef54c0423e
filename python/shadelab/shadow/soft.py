"""Filters as wide as the blockers call for."""

from __future__ import annotations

import math
from typing import Any, Literal, NamedTuple, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ._lookup import Kernel, _granted, _light_sides, _looked_up, _maps, _receivers, _result, _taps
from ._sets import MapSet
from .maps import ShadowMap

__all__ = ["PCSS", "pcss"]

Search: TypeAlias = Literal["region", "frustum"]


class PCSS(NamedTuple):
    """What `pcss` found on its way; arrays of the batch's shape."""

    lit: Floats
    """The lit fraction."""
    blocker_depth: Floats
    """Mean depth of the blockers; NaN where there are none."""
    penumbra: Floats
    """Width of the penumbra along the larger side of the light, in world units; 0 without blockers."""
    search_radius: Floats
    """Half the larger side of the search region, in texels."""


@overload
def pcss(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    light_size: float | tuple[float, float] | None = ...,
    blocker_samples: int = ...,
    filter_samples: int = ...,
    search: Search = ...,
    kernel: Kernel | None = ...,
    seed: int | None = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    receiver_plane: bool = ...,
    full_output: Literal[False] = ...,
    out: Floats | None = ...,
) -> Floats: ...
@overload
def pcss(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    light_size: float | tuple[float, float] | None = ...,
    blocker_samples: int = ...,
    filter_samples: int = ...,
    search: Search = ...,
    kernel: Kernel | None = ...,
    seed: int | None = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    receiver_plane: bool = ...,
    full_output: Literal[True],
    out: Floats | None = ...,
) -> PCSS: ...
def pcss(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    light_size: float | tuple[float, float] | None = None,
    blocker_samples: int = 16,
    filter_samples: int = 32,
    search: Search = "region",
    kernel: Kernel | None = None,
    seed: int | None = 0,
    bias: float = 0.0,
    slope_bias: float = 0.05,
    normal_offset: float = 0.0,
    receiver_plane: bool = True,
    full_output: bool = False,
    out: Floats | None = None,
) -> Floats | PCSS:
    """Percentage-closer soft shadows: a penumbra as wide as light, blocker and receiver make it.

    Parameters
    ----------
    shadow_map, receivers, normals
        As in `hard`.
    light_size : float or (float, float), optional
        Width of the light in world units, or its sides along the map's right and up; that of the map's own light by
        default. For an orthographic map the angle in radians that the light spans (0.0093 for the sun).
    blocker_samples, filter_samples : int
        Texels read to find the blockers' mean depth, and to filter; at most 4096 each.
    search : {"region", "frustum"}
        What counts as a blocker: as first published, all that blocks in the region of the map that the light could be
        hidden in; or of that only what lies between the receiver and the light, which wants many `blocker_samples`.
    kernel : {"vogel", "box", "grid", "tent", "poisson"}, optional
        As in `pcf`; "box" is the shape of a rectangular light and the default for it, "vogel" that of a disk.
    seed, bias, slope_bias, normal_offset, receiver_plane
        As in `pcf`.
    full_output : bool
        Also return the blocker depth, the penumbra width and the search radius.
    out : ndarray, shape (...), optional
        The array to write the lit fraction into.

    Returns
    -------
    ndarray, shape (...), or PCSS
        The lit fraction; with `full_output` the named tuple of all arrays. NaN where a receiver or normal is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range, or the light has no extent and `light_size` is not given.

    Notes
    -----
    1. Blocker search over the region in which the light could be hidden by something at the map's least depth. A
       caster close to the light makes it wide: then few samples fall near the receiver, distant blockers beside the
       light's cone widen the shadows of near ones, and thin contact shadows fade. The frustum search leaves distant
       blockers out, but with few samples often finds none at all. Then
       the texel under the receiver counts, if it blocks.
    2. Penumbra w = (d_receiver - d_blocker) / d_blocker · light_size, depths being linear along the light's axis
       (w = (d_receiver - d_blocker) · 2 tan(light_size / 2) for an orthographic map).
    3. Percentage-closer filtering over w.

    Exact, up to noise and texels, for one flat blocker parallel to the light and a receiver of any slope near the
    light's axis; under a rectangular light with kernel "box" also in profile. Fails where blockers at several
    depths overlap: they count as one at their mean depth, so shadows of the nearer are too sharp and light may
    leak. What the light's centre does not see cannot block. A few blocker samples miss thin blockers. What lies
    outside a map does not block: where one of several (cascades, cubes, pages) ends within the search or the
    filter, shadows grow too light, so give them borders as wide as the widest penumbra. Cost: `blocker_samples`
    texel reads, and `filter_samples` more where something blocks (one more where the search found nothing).

    References
    ----------
    R. Fernando, *Percentage-Closer Soft Shadows*, SIGGRAPH 2005 Sketches.

    Examples
    --------
    >>> import numpy as np
    >>> depth = np.where(np.arange(64) < 32, 2.0, np.inf)[None].repeat(64, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> found = pcss(above, [[-1.0, 0, 0], [0, 0, 0]], [0, 1, 0], light_size=0.4, full_output=True, seed=None)
    >>> found.lit, found.penumbra
    (array([0. , 0.5]), array([0.4, 0.4]))
    """
    maps = _maps(shadow_map)
    granted = _granted(normals, bias, slope_bias, normal_offset, receiver_plane)
    sides = _light_sides(maps, light_size)
    if kernel is None:
        kernel = "box" if max(maps.light_size) > 0.0 else "vogel"
    frustum = _arrays.choice("search", search, ("region", "frustum")) == "frustum"
    blockers = _taps("blocker_samples", kernel, blocker_samples, seed)
    filtered = _taps("filter_samples", kernel, filter_samples, seed)
    wanted = _arrays.flag("full_output", full_output)
    shape, points, n = _receivers(maps, receivers, normals)
    result, flat = _result(out, shape, points.dtype)
    results = [flat, *(np.empty_like(flat) for _ in range(3 if wanted else 0))]

    def look(_: Any, chart: tuple[Any, ...], granted: Any, to: Any) -> None:
        more = list(to[1:]) if len(to) > 1 else None
        _kernels.pcss(chart, points, n, sides, blockers, frustum, filtered, granted, to[0], more)

    _looked_up(maps, points, n, granted, results, [1.0, math.nan, 0.0, 0.0][: len(results)], look)
    return PCSS(result, *(a.reshape(shape) for a in results[1:])) if wanted else result
