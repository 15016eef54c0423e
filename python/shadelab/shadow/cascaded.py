"""Cascades: several maps of one directional light, for parts of the view by their distance."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ..light import DirectionalLight
from ..scene import Camera
from ._fit import _coarse, _fit_orthographic, _grow, _light_frame, _snapped
from ._sets import MapSet
from .maps import Bits, Cull, Surface, _casters, _drawn, _how, _rounded, _size, _used, _View

__all__ = ["Cascades", "cascade_splits", "cascades"]

Splits: TypeAlias = Literal["practical", "logarithmic", "uniform"]
_SPLITS = ("practical", "logarithmic", "uniform")
_MAX_CASCADES = 32


@dataclass(frozen=True, eq=False)
class Cascades(MapSet):
    """Maps of a directional light for parts of a view: what `cascades` gives.

    Parameters
    ----------
    maps : tuple of ShadowMap
        One for each part of the view, the nearest first.
    border : float
        Texels by which each map reaches beyond its part.
    splits : ndarray, shape (n + 1,)
        Where parts begin, as distances along the view's axis, and where the last one ends.
    eye, axis : ndarray, shape (3,)
        Where the view is from, and the unit vector that it looks along.
    blend : float
        The last share of each part, in which it gives way to the next.
    """

    splits: NDArray[np.float64]
    eye: NDArray[np.float64]
    axis: NDArray[np.float64]
    blend: float

    def _chosen(self, points: Floats) -> tuple[NDArray[np.uint8], NDArray[np.uint8], Floats]:
        first, after = np.empty(len(points), np.uint8), np.empty(len(points), np.uint8)
        share = np.empty(len(points), points.dtype)
        cuts = (self.eye.tolist(), self.axis.tolist(), self.splits.tolist(), self.blend)
        _kernels.cascades(points, cuts, first, after, share)
        return first, after, share


def cascade_splits(
    near: float, far: float, count: int = 4, *, method: Splits = "practical", weight: float = 0.5
) -> NDArray[np.float64]:
    """Distances at which a view is cut into parts.

    Parameters
    ----------
    near, far : float
        Where the first part begins and the last one ends, both above 0.
    count : int
        Parts, at most 32.
    method : {"practical", "logarithmic", "uniform"}
        Parts of equal ratio, under which texels grow with pixels; of equal length; or a mean of the two.
    weight : float
        Of the logarithmic in "practical" splits: the λ of Zhang et al., in [0, 1].

    Returns
    -------
    ndarray, shape (count + 1,)
        near, the cuts, far.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or range.

    Notes
    -----
    Logarithmic splits n (f/n)^(i/m) give every part the same worst ratio of a texel to a pixel, but for far ≫ near
    spend most parts on the first units before the eye; uniform ones n + (f − n) i/m spend most on the distance.

    References
    ----------
    F. Zhang, H. Sun, L. Xu, L. Lun, *Parallel-Split Shadow Maps for Large-scale Virtual Environments*, VRCIA 2006.

    Examples
    --------
    >>> cascade_splits(1.0, 16.0, 2, method="logarithmic"), cascade_splits(1.0, 16.0, 2)
    (array([ 1.,  4., 16.]), array([ 1.  ,  6.25, 16.  ]))
    """
    n = _arrays.number("near", near, above=0.0)
    f = _arrays.number("far", far, above=n)
    parts = _arrays.count("count", count, 1, _MAX_CASCADES)
    _arrays.choice("method", method, _SPLITS)
    share = _arrays.number("weight", weight, 0.0, 1.0)
    if method != "practical":
        share = 1.0 if method == "logarithmic" else 0.0
    i = np.arange(parts + 1) / parts
    # As a power of each, since their ratio may overflow.
    cuts = share * np.exp((1.0 - i) * math.log(n) + i * math.log(f)) + (1.0 - share) * (n + (f - n) * i)
    cuts[0], cuts[-1] = n, f
    return np.asarray(cuts)


def cascades(
    positions: ArrayLike,
    faces: ArrayLike,
    light: DirectionalLight,
    camera: Camera,
    resolution: int | tuple[int, int] = 1024,
    *,
    aspect: float = 16 / 9,
    count: int = 4,
    method: Splits = "practical",
    weight: float = 0.5,
    near: float | None = None,
    far: float | None = None,
    stable: bool = True,
    blend: float = 0.1,
    border: int = 8,
    cull: Cull = "none",
    surface: Surface = "first",
    bits: Bits = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Cascades:
    """Draw several maps of a directional light, each for a part of the view.

    Parameters
    ----------
    positions, faces, cull, surface, bits
        As in `shadow_map`.
    light : DirectionalLight
        The sun.
    camera : Camera
        The view.
    resolution : int or (int, int)
        Texels of each map.
    aspect : float
        The picture's width over its height, in [1e-6, 1e6].
    count, method, weight
        How the view is cut; see `cascade_splits`.
    near, far : float, optional
        Where it is cut, along the camera's axis, from 1e-15 to 1e15. By default the camera's own planes where it has
        them; else from the nearest point of the mesh's bounds (at least a thousandth of the farthest) to the farthest,
        both moved outwards to one of 8 numbers to an octave, so that they stay the same while the camera moves a
        little.
    stable : bool
        Fit each map to the sphere about its part, with texels of a coarse size at whole multiples of it: shadow edges
        stay where they are while the camera turns and moves. False fits it to the part's corners and the mesh: finer
        texels, which shimmer.
    blend : float
        The last share of each part in which it crosses over to the next, in [0, 1): no seams, twice the lookups there.
    border : int
        Texels by which maps reach beyond their part, for filters.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total) for each map.

    Returns
    -------
    Cascades
        For `hard`, `pcf` and `pcss`. Receivers beyond `far` are lit; those before `near` look into the first map.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range, or borders leave nothing of the maps.

    Notes
    -----
    The sphere about the part from n to f of a view whose corners are k = tan(fov_y / 2) √(1 + aspect²) aside at unit
    distance stands at min(f, (n + f)(1 + k²)/2). It does not depend on where the camera looks, so that neither does the
    texel; rounding the texel up costs 1/64 of it at most. Depths are those of the whole mesh: nothing that casts into
    the view is lost. Cost: `count` rasterisations of the whole mesh.

    References
    ----------
    F. Zhang et al., *Parallel-Split Shadow Maps for Large-scale Virtual Environments*, VRCIA 2006. M. Valient, *Stable
    Rendering of Cascaded Shadow Maps*, ShaderX6, 2008 (sphere and whole texels). R. Dimitrov, *Cascaded Shadow Maps*,
    NVIDIA, 2007.

    Examples
    --------
    >>> from shadelab.mesh import plane
    >>> from shadelab.shadow import hard
    >>> ground = plane((100.0, 100.0))
    >>> sun = DirectionalLight((0, -1, 0))
    >>> maps = cascades(ground.positions, ground.faces, sun, Camera((0, 2, 0), (0, 2, -1), near=1.0, far=50.0), 256)
    >>> maps.splits.round(2), maps.index([[0, 0, -3.0], [0, 0, -40], [0, 0, -60]])
    (array([ 1.  ,  7.95, 16.29, 28.28, 50.  ]), array([ 0,  3, -1]))
    """
    points, triangles = _casters(positions, faces)
    if not isinstance(light, DirectionalLight):
        raise TypeError(f"light: expected a DirectionalLight, got {type(light).__name__}")
    if not isinstance(camera, Camera):
        raise TypeError(f"camera: expected a Camera, got {type(camera).__name__}")
    size = _size(resolution)
    wide = _arrays.number("aspect", aspect, 1e-6, 1e6)
    steady, share = _arrays.flag("stable", stable), _arrays.number("blend", blend, 0.0, below=1.0)
    margin = _arrays.count("border", border, 0)
    if 2 * margin + 1 >= min(size):
        raise ValueError(f"border: expected less than half the resolution, {min(size)}, got {margin}")
    _arrays.choice("cull", cull, ("none", "back", "front"))
    how = _how(surface, bits)
    watch = _arrays.progress_callback(progress, "cascades")

    used = _used(points, triangles)
    eye = np.asarray(camera.eye, np.float64)
    view = camera.view()
    to_world, axis = view[:3, :3].T, -view[2, :3]
    begin, end = _range(used, eye, axis, camera, near, far)
    if not 1e-15 <= begin < end <= 1e15:
        raise ValueError(f"near, far: expected distances from 1e-15 to 1e15, got {begin:g} and {end:g}")
    splits = cascade_splits(begin, end, count, method=method, weight=weight)

    # The frame and the origin follow from the mesh alone: nothing moves with the camera.
    _, origin, frame, _ = _light_frame(light, points, None)
    origin, frame = (_rounded(a, points.dtype) for a in (origin, frame))
    moved, _, low, high = _fit_orthographic(used, origin, frame, None)
    moved = _rounded(moved, points.dtype)
    up = math.tan(camera.fov_y / 2.0)
    maps = []
    for i in range(len(splits) - 1):
        n, f = splits[i], splits[i + 1]
        if i > 0:
            # Receivers that cross over from the part before look into this map too.
            n -= share * (n - splits[i - 1])
        if steady:
            k2 = up * up * (1.0 + wide * wide)
            middle = min(f, (n + f) * (1.0 + k2) / 2.0)
            radius = math.sqrt(max((f - middle) ** 2 + f * f * k2, (middle - n) ** 2 + n * n * k2))
            place = frame @ (eye + axis * middle - moved)
            window = _snapped(place[:2], 2.0 * radius, size, margin, 64)
        else:
            corners = np.array([[x * up * wide, y * up, -1.0] for x in (-1, 1) for y in (-1, 1)])
            both = np.concatenate([corners * n, corners * f]) @ to_world.T + eye
            window = _bordered(_fit_orthographic(used, moved, frame, both)[1], size, margin)
        seen = _View(False, moved, frame, _rounded(window, points.dtype), low, high)
        maps.append(_drawn(points, triangles, seen, size, cull, how, (0.0, 0.0)))
        if watch is not None:
            watch(i + 1, len(splits) - 1)
    return Cascades(tuple(maps), float(margin), splits, eye, axis, share)


def _bordered(window: NDArray[np.float64], size: tuple[int, int], border: int) -> NDArray[np.float64]:
    """The window with so many texels more on each side."""
    grown = _grow(window, size)
    for k, texels in ((0, size[0]), (2, size[1])):
        extent = grown[k + 1] - grown[k]
        more = extent * max(border - 2, 0) / max(texels - 2 * border, 1)
        grown[k], grown[k + 1] = grown[k] - more, grown[k + 1] + more
    return grown


def _range(
    used: Floats, eye: NDArray[np.float64], axis: NDArray[np.float64], camera: Camera, near: Any, far: Any
) -> tuple[float, float]:
    """Where cascades begin and end."""
    least, most = 1.0, 2.0
    if len(used):
        low, high = used.min(0).astype(np.float64), used.max(0).astype(np.float64)
        corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, -1).T
        depths = (corners - eye) @ axis
        least, most = float(depths.min()), float(depths.max())
    if far is not None:
        end = _arrays.number("far", far, 1e-15, 1e15)
    elif camera.far is not None and math.isfinite(camera.far):
        end = camera.far
    else:
        # A view away from all ends somewhere.
        end = _coarse(most) if most > 0.0 else 1.0
    if near is not None:
        return _arrays.number("near", near, 1e-15, below=end), end
    if camera.near is not None and camera.near < end:
        return camera.near, end
    return 1.0 / _coarse(1.0 / min(max(least, 1e-3 * end), 0.5 * end)), end
