"""Lookups into maps of moments: one texel, whatever the filter's width."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ._lookup import _looked_up, _receivers, _result
from ._sets import MapSet
from .bounds import _METHODS, BIAS, Method
from .moments import MomentMap, MomentMapSet

__all__ = ["FilteredLookup", "exponential_variance", "moment", "variance"]

# Depths within a thousandth of half the range count as one.
_LEAST = 1e-6


class FilteredLookup(NamedTuple):
    """What a lookup into a map of moments found; arrays of the batch's shape."""

    lit: Floats
    """The lit fraction."""
    moments: Floats
    """The filtered moments, (..., C); NaN outside of the map."""
    z: Floats
    """The receiver's depth less its biases, in [-1, 1] as moments have it; NaN outside of the map."""


def _moment_map(value: Any, kind: str) -> MomentMap | MomentMapSet:
    if not isinstance(value, MomentMap | MomentMapSet):
        raise TypeError(f"moment_map: expected a MomentMap, got {type(value).__name__}")
    if value.kind != kind:
        raise ValueError(f"moment_map: expected kind {kind!r}, got {value.kind!r}")
    return value


def _first(m: MomentMap | MomentMapSet) -> MomentMap:
    """One that stands for all of a set."""
    return m if isinstance(m, MomentMap) else m.maps[0]


def _asked(given: MomentMap | MomentMapSet, least: float, method: str, bias: float | None) -> tuple[Any, ...]:
    """The bound and its knobs, as the kernel takes them."""
    m = _first(given)
    if m.kind != "moment":
        return (m.kind, m.exponents), (_arrays.number("min_variance", least, 0.0), 0.0), ""
    _arrays.choice("method", method, _METHODS)
    # What is stored decides how much rounding there is, but never less than that of the sums.
    stored = "uint16" if m.moments.dtype == np.uint16 else str(m.shadow_map.depth.dtype)
    share, target = BIAS["float32" if m.moments.dtype == np.float32 else stored]
    if bias is not None:
        share = _arrays.number("moment_bias", bias, 0.0, 1.0)
    return (m.kind, m.exponents), (share, target), method


def _bias(bias: float, slope_bias: float, normal_offset: float, light_bleeding: float) -> tuple[float, ...]:
    return (
        _arrays.number("bias", bias),
        _arrays.number("slope_bias", slope_bias, 0.0),
        _arrays.number("normal_offset", normal_offset, 0.0),
        _arrays.number("light_bleeding", light_bleeding, 0.0, below=1.0),
    )


def _looked(
    given: MomentMap | MomentMapSet,
    points: Floats,
    normals: Floats | None,
    asked: tuple[Any, ...],
    bias: tuple[float, ...],
    width: Any,
    results: list[Floats],
    blanks: list[float],
) -> None:
    """Looks into the map that each receiver falls in; `results` begins with the lit fraction."""

    def look(_: Any, chart: tuple[Any, ...], granted: Any, to: Any) -> None:
        m = given if isinstance(given, MomentMap) else given.maps[chart[5][1]]
        store = (m.moments, m._levels(), m.filter == "summed_area", m.reduce, m._range())
        rest = [granted[0] + _rounding(m), *bias[1:]]
        _kernels.filtered(chart, store, points, normals, asked, rest, width, to[0], list(to[1:]) or None)

    _looked_up(given.shadow_map, points, normals, (bias[0], 0.0, 0.0, False), results, blanks[: len(results)], look)


def _rounding(m: MomentMap) -> float:
    """Moments round depths as shares of their range."""
    return 16.0 * float(np.finfo(m.shadow_map.depth.dtype).eps) * max(abs(m.near), abs(m.far))


def _lookup(
    m: MomentMap | MomentMapSet,
    asked: tuple[Any, ...],
    bias: tuple[float, ...],
    receivers: ArrayLike,
    normals: ArrayLike | None,
    radius: float | None,
    full_output: bool,
    out: Floats | None,
) -> Floats | FilteredLookup:
    chosen = m.filter in ("mip", "summed_area")
    if radius is not None and not chosen:
        raise ValueError(f"radius: the map was filtered beforehand, by filter {m.filter!r}")
    half = _first(m).reach
    if chosen:
        half = _arrays.number("radius", 4.0 if radius is None else radius, 0.0)
    maps = m.shadow_map
    if isinstance(maps, MapSet):
        maps._wide(half + bias[2])
    shape, points, n = _receivers(maps, receivers, normals)
    result, flat = _result(out, shape, points.dtype)
    results = [flat]
    if _arrays.flag("full_output", full_output):
        results += [np.empty((len(flat), m.channels), flat.dtype), np.empty_like(flat)]
    _looked(m, points, n, asked, bias, half, results, [1.0, np.nan, np.nan])
    if len(results) == 1:
        return result
    return FilteredLookup(result, results[1].reshape(*shape, m.channels), results[2].reshape(shape))


@overload
def variance(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    radius: float | None = ...,
    min_variance: float = ...,
    light_bleeding: float = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    full_output: Literal[False] = ...,
    out: Floats | None = ...,
) -> Floats: ...
@overload
def variance(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    radius: float | None = ...,
    min_variance: float = ...,
    light_bleeding: float = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    full_output: Literal[True],
    out: Floats | None = ...,
) -> FilteredLookup: ...
def variance(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    radius: float | None = None,
    min_variance: float = _LEAST,
    light_bleeding: float = 0.0,
    bias: float = 0.0,
    slope_bias: float = 0.0,
    normal_offset: float = 0.0,
    full_output: bool = False,
    out: Floats | None = None,
) -> Floats | FilteredLookup:
    """Variance shadow maps: filtered shadows from the mean and the variance of depth.

    Parameters
    ----------
    moment_map : MomentMap or MomentMapSet
        Of kind "variance"; of one map, of cascades or of a cube.
    receivers : array_like, shape (..., 3)
        Points in the world.
    normals : array_like, shape (..., 3), optional
        Unit normals of the receivers; biases by slope and along the normal need them.
    radius : float, optional
        Half the side of the filter in texels of the shadow map, where the map's filter is "mip" or "summed_area"; 4 by
        default.
    min_variance : float
        Variances below it count as it: what rounding leaves of none would be shadow. In squares of half the range of
        depth, so that 1e-6 blurs a contact over a thousandth of it.
    light_bleeding : float
        Lit fractions up to it count as 0, those above are stretched to [0, 1]: less light where there should be none,
        and penumbrae too dark.
    bias : float
        World units of depth that a blocker must be nearer by.
    slope_bias : float
        Half sides of the filter: a blocker must be nearer by the depth that the receiver's plane gains over them.
    normal_offset : float
        As in `hard`.
    full_output : bool
        Also return the filtered moments and the depth that they were asked about.
    out : ndarray, shape (...), optional
        The array to write into.

    Returns
    -------
    ndarray, shape (...), or FilteredLookup
        An upper bound on the lit fraction by percentage-closer filtering with the same weights; 1 outside of the map;
        NaN where a receiver or normal is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape, kind or range.

    Notes
    -----
    Exact where one flat blocker hides a receiver that lies, like it, parallel to the light's plane. Never darker than
    percentage-closer filtering (up to `light_bleeding`), so a lit plane shows no acne at any angle. Fails where
    blockers lie at two depths: the nearer casts light through the farther, up to a share of (gap below / gap in all)².
    Cost: 4 texels of 2 numbers (8 for mips, 16 for a table).

    References
    ----------
    W. Donnelly, A. Lauritzen, *Variance Shadow Maps*, I3D 2006. A. Lauritzen, *Summed-Area Variance Shadow Maps*, GPU
    Gems 3, 2007.

    Examples
    --------
    >>> import numpy as np
    >>> from shadelab.shadow import ShadowMap, moment_map
    >>> depth = np.where(np.arange(64) < 32, 2.0, 4.0)[None].repeat(64, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> filtered = moment_map(above, "variance", filter="summed_area")
    >>> variance(filtered, [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]]).round(4)
    array([0. , 0.5, 1. ])
    """
    m = _moment_map(moment_map, "variance")
    granted = _bias(bias, slope_bias, normal_offset, light_bleeding)
    return _lookup(m, _asked(m, min_variance, "", None), granted, receivers, normals, radius, full_output, out)


@overload
def exponential_variance(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    radius: float | None = ...,
    min_variance: float = ...,
    light_bleeding: float = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    full_output: Literal[False] = ...,
    out: Floats | None = ...,
) -> Floats: ...
@overload
def exponential_variance(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    radius: float | None = ...,
    min_variance: float = ...,
    light_bleeding: float = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    full_output: Literal[True],
    out: Floats | None = ...,
) -> FilteredLookup: ...
def exponential_variance(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    radius: float | None = None,
    min_variance: float = _LEAST,
    light_bleeding: float = 0.0,
    bias: float = 0.0,
    slope_bias: float = 1.0,
    normal_offset: float = 0.0,
    full_output: bool = False,
    out: Floats | None = None,
) -> Floats | FilteredLookup:
    """Exponential variance shadow maps: Chebyshev's bound on depths that an exponential has stretched.

    Parameters
    ----------
    moment_map : MomentMap or MomentMapSet
        Of kind "exponential_variance", with one exponential (2 moments) or two (4).
    receivers, normals, radius, light_bleeding, bias, normal_offset, full_output, out
        As in `variance`.
    min_variance : float
        As in `variance`; each exponential stretches it by its slope at the receiver.
    slope_bias : float
        As in `variance`; 1 keeps a lit plane of any slope free of acne.

    Returns
    -------
    ndarray, shape (...), or FilteredLookup
        An upper bound on the lit fraction, the lesser of one for each exponential; 1 outside of the map; NaN where a
        receiver or normal is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape, kind or range.

    Notes
    -----
    The larger the exponent a, the less light bleeds through blockers at two depths: e^(az) pushes all that is before
    the last of them together. But a receiver that is not flat within the filter darkens, which two exponentials keep in
    check. Cost: 4 texels of 2 or 4 numbers (8 for mips, 16 for a table), one or two exponentials.

    References
    ----------
    A. Lauritzen, M. McCool, *Layered Variance Shadow Maps*, GI 2008.

    Examples
    --------
    >>> import numpy as np
    >>> from shadelab.shadow import ShadowMap, moment_map
    >>> depth = np.where(np.arange(64) < 32, 2.0, 4.0)[None].repeat(64, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> filtered = moment_map(above, "exponential_variance", filter="summed_area")
    >>> exponential_variance(filtered, [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]]).round(4)
    array([0. , 0.5, 1. ])
    """
    m = _moment_map(moment_map, "exponential_variance")
    granted = _bias(bias, slope_bias, normal_offset, light_bleeding)
    return _lookup(m, _asked(m, min_variance, "", None), granted, receivers, normals, radius, full_output, out)


@overload
def moment(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    method: Method = ...,
    moment_bias: float | None = ...,
    radius: float | None = ...,
    light_bleeding: float = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    full_output: Literal[False] = ...,
    out: Floats | None = ...,
) -> Floats: ...
@overload
def moment(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    method: Method = ...,
    moment_bias: float | None = ...,
    radius: float | None = ...,
    light_bleeding: float = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    full_output: Literal[True],
    out: Floats | None = ...,
) -> FilteredLookup: ...
def moment(
    moment_map: MomentMap | MomentMapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    method: Method = "hausdorff",
    moment_bias: float | None = None,
    radius: float | None = None,
    light_bleeding: float = 0.0,
    bias: float = 0.0,
    slope_bias: float = 1.0,
    normal_offset: float = 0.0,
    full_output: bool = False,
    out: Floats | None = None,
) -> Floats | FilteredLookup:
    """Moment shadow maps: the most that can be lit, given four moments of depth.

    Parameters
    ----------
    moment_map : MomentMap or MomentMapSet
        Of kind "moment".
    receivers, normals, radius, light_bleeding, bias, normal_offset, full_output, out
        As in `variance`.
    method : {"hausdorff", "hamburger"}
        Whether the bound uses that depths lie in the map's range: less light bleeds then.
    moment_bias : float, optional
        The share by which moments are drawn towards others that are safe from rounding; as published by default: 3e-7
        for float32, 6e-5 for 16 bits; 1e-14 for float64.
    slope_bias : float
        As in `variance`; 1 keeps a lit plane of any slope free of acne.

    Returns
    -------
    ndarray, shape (...), or FilteredLookup
        An upper bound on the lit fraction by percentage-closer filtering with the same weights; 1 outside of the map;
        NaN where a receiver or normal is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape, kind or range.

    Notes
    -----
    Exact for two depths in the filter, and for a receiver at the far end of three; light bleeds where there are more.
    See `moment_bound` for the bound itself. Receivers that slope within the filter are darkened by their own plane
    unless `slope_bias` grants it, which detaches contact shadows by as much. Cost: 4 texels of 4 numbers (8 for mips,
    16 for a table), a matrix of 3 x 3 and two roots.

    References
    ----------
    C. Peters, R. Klein, *Moment Shadow Mapping*, I3D 2015. C. Peters et al., *Improved Moment Shadow Maps for
    Translucent Occluders, Soft Shadows and Single Scattering*, JCGT 2017.

    Examples
    --------
    >>> import numpy as np
    >>> from shadelab.shadow import ShadowMap, moment_map
    >>> depth = np.where(np.arange(64) < 32, 2.0, 4.0)[None].repeat(64, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> filtered = moment_map(above, filter="summed_area")
    >>> moment(filtered, [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]]).round(4)
    array([0. , 0.5, 1. ])
    """
    m = _moment_map(moment_map, "moment")
    granted = _bias(bias, slope_bias, normal_offset, light_bleeding)
    return _lookup(m, _asked(m, 0.0, method, moment_bias), granted, receivers, normals, radius, full_output, out)
