"""Depths compared: once, or over a filter of fixed width."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ._lookup import Kernel, _granted, _looked_up, _maps, _receivers, _result, _taps
from ._sets import MapSet
from .maps import ShadowMap

__all__ = ["Compared", "hard", "pcf"]


class Compared(NamedTuple):
    """What comparisons found, and where; arrays of the batch's shape."""

    lit: Floats
    """The lit fraction."""
    map_index: NDArray[np.intp]
    """The map that was looked into: the cascade, the face of a cube, the level; -1 where there is none."""
    share: Floats
    """How much the next map has counted, where two cross over; else 0."""


def _compared(result: Floats, found: tuple[NDArray[np.uint8], Floats | None] | None, wanted: bool) -> Floats | Compared:
    if not wanted:
        return result
    index, share = (np.zeros(result.shape, np.intp), None) if found is None else found
    named = np.where(index == 255, -1, index.astype(np.intp)).reshape(result.shape)
    return Compared(result, named, np.zeros_like(result) if share is None else share.reshape(result.shape))


@overload
def hard(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    receiver_plane: bool = ...,
    full_output: Literal[False] = ...,
    out: Floats | None = ...,
) -> Floats: ...
@overload
def hard(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    receiver_plane: bool = ...,
    full_output: Literal[True],
    out: Floats | None = ...,
) -> Compared: ...
def hard(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    bias: float = 0.0,
    slope_bias: float = 0.05,
    normal_offset: float = 0.0,
    receiver_plane: bool = True,
    full_output: bool = False,
    out: Floats | None = None,
) -> Floats | Compared:
    """Hard shadows: 1 where the light's centre is seen, 0 elsewhere, by one texel.

    Parameters
    ----------
    shadow_map : ShadowMap, Cascades, CubeShadowMap or VirtualShadowMap
        The depth that the light sees; its precision governs.
    receivers : array_like, shape (..., 3)
        Points in the world.
    normals : array_like, shape (..., 3), optional
        Unit normals of the receivers, geometric ones if there is a choice. Leading axes broadcast.
    bias : float
        World units of depth that a blocker must be nearer by.
    slope_bias : float
        Texels: a blocker must be nearer by the depth that the receiver's plane gains over them. Needs normals.
    normal_offset : float
        Texels that receivers are moved by along their normal, times the sine of the light's angle to it. Needs normals.
    receiver_plane : bool
        Compare with the receiver's tangent plane at the texel's centre rather than with its own depth. Needs normals.
    full_output : bool
        Also return which of several maps was looked into.
    out : ndarray, shape (...), optional
        The array to write into.

    Returns
    -------
    ndarray, shape (...), or Compared
        The lit fraction, 0 or 1 (between them where cascades cross over); 1 outside of the map and behind the light;
        NaN where a receiver or normal is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, or a bias but `bias` is negative.

    Notes
    -----
    Shadow edges are exact to half a texel. With `normals`, a lit plane at any angle shows no acne: the
    comparison happens where the texel's depth was taken. Without, choose `bias`; with ``receiver_plane=False``, a
    `slope_bias` of 0.5 covers a texel, and blockers nearer to the receiver than that detach from their shadows.
    Cost: one texel read.

    References
    ----------
    L. Williams, *Casting Curved Shadows on Curved Surfaces*, 1978. J. Isidoro, *Shadow Mapping: GPU-based Tips and
    Techniques*, GDC 2006 (receiver plane). D. Holbert, *Saying "Goodbye" to Shadow Acne*, GDC 2011 (normal offset).

    Examples
    --------
    >>> import numpy as np
    >>> depth = np.where(np.arange(4) < 2, 2.0, np.inf)[None].repeat(4, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> hard(above, [[-1.0, 0, 0], [1, 0, 0]], [0, 1, 0])
    array([0., 1.])
    """
    maps = _maps(shadow_map)
    granted = _granted(normals, bias, slope_bias, normal_offset, receiver_plane)
    wanted = _arrays.flag("full_output", full_output)
    shape, points, n = _receivers(maps, receivers, normals)
    result, flat = _result(out, shape, points.dtype)

    def look(_: Any, chart: tuple[Any, ...], granted: Any, to: Any) -> None:
        _kernels.hard(chart, points, n, granted, to[0])

    return _compared(result, _looked_up(maps, points, n, granted, [flat], [1.0], look), wanted)


@overload
def pcf(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    samples: int = ...,
    radius: float = ...,
    units: Literal["texels", "world"] = ...,
    kernel: Kernel = ...,
    bilinear: bool = ...,
    seed: int | None = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    receiver_plane: bool = ...,
    full_output: Literal[False] = ...,
    out: Floats | None = ...,
) -> Floats: ...
@overload
def pcf(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = ...,
    *,
    samples: int = ...,
    radius: float = ...,
    units: Literal["texels", "world"] = ...,
    kernel: Kernel = ...,
    bilinear: bool = ...,
    seed: int | None = ...,
    bias: float = ...,
    slope_bias: float = ...,
    normal_offset: float = ...,
    receiver_plane: bool = ...,
    full_output: Literal[True],
    out: Floats | None = ...,
) -> Compared: ...
def pcf(
    shadow_map: ShadowMap | MapSet,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    samples: int = 16,
    radius: float = 1.5,
    units: Literal["texels", "world"] = "texels",
    kernel: Kernel = "vogel",
    bilinear: bool = False,
    seed: int | None = 0,
    bias: float = 0.0,
    slope_bias: float = 0.05,
    normal_offset: float = 0.0,
    receiver_plane: bool = True,
    full_output: bool = False,
    out: Floats | None = None,
) -> Floats | Compared:
    """Percentage-closer filtering: the share of texels around a receiver that do not block it.

    Parameters
    ----------
    shadow_map, receivers, normals
        As in `hard`.
    samples : int
        Texels compared, at most 4096.
    radius : float
        Half the side of the filter.
    units : {"texels", "world"}
        Whether `radius` is in texels of the map, or in world units at the receiver, parallel to the map's plane.
    kernel : {"vogel", "box", "grid", "tent", "poisson"}
        Where the samples lie: on a disk (Vogel's spiral), in a square (a lattice), in n × n cells of a square, in a
        square and denser towards its middle, or on a disk apart from each other at random.
    bilinear : bool
        Each sample compares the four texels about it and weights them by their nearness, as hardware does: four times
        the reads, and steps of a texel's size no more.
    seed : int or None
        Each receiver turns the disk, or shifts the square's points, by random amounts that follow from the seed and its
        place in the batch: noise instead of banding. None gives all receivers the same points.
    bias, slope_bias, normal_offset, receiver_plane, full_output, out
        As in `hard`.

    Returns
    -------
    ndarray, shape (...), or Compared
        The lit fraction, a multiple of 1 / `samples` unless `bilinear`; NaN where a receiver or normal is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range, or the filter reaches beyond the border of one of several
        maps.

    Notes
    -----
    A penumbra of one width everywhere: right for antialiasing, wrong for an area light, whose shadow should harden at
    contact. As `radius` goes to 0 the result is that of `hard`. With normals the filter follows the receiver's tangent
    plane, so that wide filters need no more bias than narrow ones. Cost: `samples` texel reads, four times as many with
    `bilinear`.

    References
    ----------
    W. Reeves, D. Salesin, R. Cook, *Rendering Antialiased Shadows with Depth Maps*, 1987. H. Vogel, *A better way to
    construct the sunflower head*, 1979. D. Mitchell, *Spectrally Optimal Sampling for Distribution Ray Tracing*,
    SIGGRAPH 1991 (points that keep their distance).

    Examples
    --------
    >>> import numpy as np
    >>> depth = np.where(np.arange(64) < 32, 2.0, np.inf)[None].repeat(64, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> pcf(above, [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]], [0, 1, 0], radius=4, kernel="box", seed=None)
    array([0. , 0.5, 1. ])
    """
    maps = _maps(shadow_map)
    granted = _granted(normals, bias, slope_bias, normal_offset, receiver_plane)
    taps = _taps("samples", kernel, samples, seed)
    half = _arrays.number("radius", radius, 0.0)
    smooth = _arrays.flag("bilinear", bilinear)
    wanted = _arrays.flag("full_output", full_output)
    texels = _arrays.choice("units", units, ("texels", "world")) == "texels"
    # Texels beyond the filter that a receiver's own move and the texels between taps reach.
    beyond = granted[2] + (0.5 if smooth else 0.0)
    if isinstance(maps, MapSet) and texels:
        maps._wide(half + beyond)
    shape, points, n = _receivers(maps, receivers, normals)
    result, flat = _result(out, shape, points.dtype)

    def look(m: Any, chart: tuple[Any, ...], granted: Any, to: Any) -> None:
        if isinstance(maps, MapSet) and not texels:
            maps._wide(half / m.texel_size(_least_depth(m, points, chart[5])) + beyond)
        _kernels.pcf(chart, points, n, taps, (half, texels, smooth), granted, to[0])

    return _compared(result, _looked_up(maps, points, n, granted, [flat], [1.0], look), wanted)


def _least_depth(m: Any, points: Floats, chosen: tuple[NDArray[np.uint8], int]) -> float:
    """The least depth of receivers before the light, of those that look into a map; 1 in parallel maps."""
    if m.projection != "perspective":
        return 1.0
    which, own = chosen
    depth = (points[which == own] - m.position) @ m.axis
    return float(depth.min(where=depth > 0.0, initial=np.inf))
