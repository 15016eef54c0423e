"""Soft shadows from maps of moments, at a cost that does not depend on the penumbra."""

from __future__ import annotations

from typing import Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from ._lookup import _light_sides, _receivers, _result
from .bounds import Method
from .filtered import _LEAST, _asked, _bias, _looked
from .moments import MomentMap, MomentMapSet
from .soft import PCSS

__all__ = ["variance_soft"]


@overload
def variance_soft(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    light_size: float | tuple[float, float] | None = ...,
    min_variance: float = ...,
    method: Method = ...,
    moment_bias: float | None = ...,
    light_bleeding: float = ...,
    bias: float = ...,
    slope_bias: float = ...,
    search_slope_bias: float = ...,
    normal_offset: float = ...,
    full_output: Literal[False] = ...,
    out: Floats | None = ...,
) -> Floats: ...
@overload
def variance_soft(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    light_size: float | tuple[float, float] | None = ...,
    min_variance: float = ...,
    method: Method = ...,
    moment_bias: float | None = ...,
    light_bleeding: float = ...,
    bias: float = ...,
    slope_bias: float = ...,
    search_slope_bias: float = ...,
    normal_offset: float = ...,
    full_output: Literal[True],
    out: Floats | None = ...,
) -> PCSS: ...
def variance_soft(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    light_size: float | tuple[float, float] | None = None,
    min_variance: float = _LEAST,
    method: Method = "hausdorff",
    moment_bias: float | None = None,
    light_bleeding: float = 0.0,
    bias: float = 0.0,
    slope_bias: float = 0.5,
    search_slope_bias: float = 0.0,
    normal_offset: float = 0.0,
    full_output: bool = False,
    out: Floats | None = None,
) -> Floats | PCSS:
    """Soft shadows from moments: two means over boxes in place of the search and the filter of `pcss`.

    Parameters
    ----------
    moment_map : MomentMap or MomentMapSet
        With filter "mip" or "summed_area", of any kind but exponentials. Four moments tell the blockers' depth
        themselves; two, if what does not block lies at the receiver's depth.
    receivers, normals, light_size, full_output, out
        As in `pcss`.
    min_variance, light_bleeding, bias, normal_offset
        As in `variance`.
    slope_bias, search_slope_bias : float
        Half sides of the filter, and of the search: a blocker must be nearer by the depth that the receiver's plane
        gains over them. Half of the filter's keeps slopes free of acne; over the search, which is wide, the same would
        drop the shadows of all that is near.
    method, moment_bias
        As in `moment`.

    Returns
    -------
    ndarray, shape (...), or PCSS
        The lit fraction; with `full_output` the named tuple of all arrays, as `pcss` gives it.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range, the map was filtered beforehand, or the light has no extent
        and `light_size` is not given.

    Notes
    -----
    No noise and no banding, and as cheap for a wide penumbra as for a narrow one: with a table 32 texels, with mips 16.
    Exact for one flat blocker and a flat receiver parallel to the light, but for the shape of mips; otherwise light
    bleeds where bounds are loose (see `variance`, `moment`), and where the search meets blockers at several depths.

    A receiver that slopes within a wide search counts among its own blockers: what they hide looks nearer than it is,
    and penumbrae are too narrow there. Of two moments the bound is looser than that of four wherever blockers lie at
    more than one depth: much light then bleeds.

    References
    ----------
    B. Yang et al., *Variance Soft Shadow Mapping*, Pacific Graphics 2010. A. Lauritzen, *Summed-Area Variance Shadow
    Maps*, GPU Gems 3, 2007. C. Peters et al., *Improved Moment Shadow Maps for Translucent Occluders, Soft Shadows and
    Single Scattering*, JCGT 2017.

    Examples
    --------
    >>> import numpy as np
    >>> from shadelab.shadow import ShadowMap, moment_map
    >>> depth = np.where(np.arange(64) < 32, 2.0, 4.0)[None].repeat(64, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> table = moment_map(above, "variance", filter="summed_area")
    >>> found = variance_soft(table, [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]], light_size=0.4, full_output=True)
    >>> found.lit.round(4), found.penumbra.round(4)
    (array([0. , 0.5, 1. ]), array([0.4, 0.4, 0. ]))
    """
    m = moment_map
    if not isinstance(m, MomentMap | MomentMapSet):
        raise TypeError(f"moment_map: expected a MomentMap, got {type(m).__name__}")
    if m.filter not in ("mip", "summed_area"):
        raise ValueError(f"moment_map: expected filter 'mip' or 'summed_area', got {m.filter!r}")
    if m.kind == "exponential_variance":
        raise ValueError("moment_map: expected kind 'variance' or 'moment', got 'exponential_variance'")
    shadow_map = m.shadow_map
    sides = _light_sides(shadow_map, light_size)
    asked = _asked(m, min_variance, method, moment_bias)
    searched = _arrays.number("search_slope_bias", search_slope_bias, 0.0)
    granted = _bias(bias, slope_bias, normal_offset, light_bleeding)
    shape, points, n = _receivers(shadow_map, receivers, normals)
    result, flat = _result(out, shape, points.dtype)
    results = [flat]
    if _arrays.flag("full_output", full_output):
        results += [np.empty_like(flat) for _ in range(3)]
    _looked(m, points, n, asked, granted, (*sides, searched), results, [1.0, np.nan, 0.0, 0.0])
    return PCSS(result, *(a.reshape(shape) for a in results[1:])) if len(results) > 1 else result
