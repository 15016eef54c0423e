"""Shadow maps and their filters: every function returns the lit fraction of a light, in [0, 1].

A `ShadowMap` holds the depth of a scene as a light sees it, linear along the light's axis. `hard` compares once, `pcf`
averages comparisons over a fixed width, `pcss` over the width that the blockers call for; `ray_traced` needs no map.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, accel
from ._arrays import Floats
from ._kernels import shadow as _kernels
from .accel import BVH
from .light import DirectionalLight, PointLight, RectLight

__all__ = ["Cost", "PCSS", "ShadowMap", "cost", "hard", "pcf", "pcss", "ray_traced", "shadow_map"]

Kernel: TypeAlias = Literal["vogel", "box", "grid"]
Cull: TypeAlias = Literal["none", "back", "front"]
Light: TypeAlias = DirectionalLight | PointLight | RectLight
Search: TypeAlias = Literal["region", "frustum"]
_KERNELS = ("vogel", "box", "grid")
_MAX_RESOLUTION = 16384
_MAX_SAMPLES = 4096
# How far from its axis a light's map may look: 75 degrees.
_MAX_TANGENT = math.tan(math.radians(75.0))
# Nothing nearer than this fraction of the farthest depth is drawn into a perspective map.
_NEAREST = 1e-4


@dataclass(frozen=True, eq=False)
class ShadowMap:
    """The depth of a scene as a light sees it.

    Parameters
    ----------
    depth : array_like, shape (H, W)
        Depth at texel centres, linear along the light's axis, infinite where nothing was hit. Row 0 is the top. Its
        precision is that of every lookup.
    projection : {"perspective", "orthographic"}
        Whether texels are rays from a point, or parallel.
    position : array_like, shape (3,)
        Where depth is zero: the light, or a point behind all casters for a directional light.
    frame : array_like, shape (3, 3)
        Unit vectors in rows: the map's right, its up, and the axis along which light travels.
    window : array_like, shape (4,)
        Left, right, bottom, top of the map: on the plane at depth 1 (perspective), or in world units.
    near, far : float
        The least and the greatest depth of anything in the map.
    light_size : (float, float)
        Sides of the light along right and up, in world units; 0 for a light without extent.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, a texel is NaN, the frame's rows are not unit vectors square to each
        other, the window has no extent, or depths are out of order (or negative in a perspective map).
    """

    depth: Floats
    projection: Literal["perspective", "orthographic"]
    position: NDArray[np.float64]
    frame: NDArray[np.float64]
    window: NDArray[np.float64]
    near: float
    far: float
    light_size: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        def fix(name: str, value: Any) -> None:
            object.__setattr__(self, name, value)

        depth = _arrays.floats("depth", self.depth)
        if depth.ndim != 2 or 0 in depth.shape:
            raise ValueError(f"depth: expected shape (H, W), neither zero, got {depth.shape}")
        if np.isnan(depth.min()):
            raise ValueError("depth: expected numbers or infinity, got NaN")
        fix("depth", depth)
        _arrays.choice("projection", self.projection, ("perspective", "orthographic"))
        for name, shape in (("position", (3,)), ("frame", (3, 3)), ("window", (4,))):
            value = _arrays.floats(name, getattr(self, name), np.float64)
            if value.shape != shape or not np.isfinite(value).all():
                raise ValueError(f"{name}: expected shape {shape} of finite numbers, got {value.tolist()}")
            fix(name, value)
        # Frames are rounded to the precision of maps.
        if np.abs(self.frame @ self.frame.T - np.eye(3)).max() > 1e-4:
            raise ValueError(f"frame: expected unit vectors square to each other, got {self.frame.tolist()}")
        left, right, bottom, top = self.window
        if not (left < right and bottom < top):
            raise ValueError(f"window: expected left < right and bottom < top, got {self.window.tolist()}")
        # Parallel maps have their origin anywhere along the axis.
        low = 0.0 if self.projection == "perspective" else -math.inf
        fix("near", _arrays.number("near", self.near, low))
        fix("far", _arrays.number("far", self.far, self.near))
        fix("light_size", _sides("light_size", self.light_size))

    @property
    def axis(self) -> NDArray[np.float64]:
        """The direction in which light travels along the middle of the map, shape (3,)."""
        return self.frame[2]

    @property
    def view(self) -> NDArray[np.float64]:
        """From world to the light's frame, looking down -z, shape (4, 4)."""
        rotation = self.frame * [[1.0], [1.0], [-1.0]]
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = rotation, -rotation @ self.position
        return matrix

    @property
    def matrix(self) -> NDArray[np.float64]:
        """From world to clip space, -w <= x, y, z <= w over the map and between `near` and `far`, shape (4, 4)."""
        left, right, bottom, top = self.window
        n, f = self.near, max(self.far, self.near + max(abs(self.near), 1.0) * 1e-6)
        width, height, range_ = right - left, top - bottom, f - n
        if self.projection == "perspective":
            projection = [
                [2 / width, 0, (right + left) / width, 0],
                [0, 2 / height, (top + bottom) / height, 0],
                [0, 0, -(f + n) / range_, -2 * f * n / range_],
                [0, 0, -1, 0],
            ]
        else:
            projection = [
                [2 / width, 0, 0, -(right + left) / width],
                [0, 2 / height, 0, -(top + bottom) / height],
                [0, 0, -2 / range_, -(f + n) / range_],
                [0, 0, 0, 1],
            ]
        return np.asarray(projection, np.float64) @ self.view

    def texel_size(self, depth: float = 1.0) -> float:
        """The larger side of a texel in world units, at a depth (which matters to a perspective map alone)."""
        left, right, bottom, top = self.window
        height, width = self.depth.shape
        size = max((right - left) / width, (top - bottom) / height)
        return float(size * depth if self.projection == "perspective" else size)

    def _geometry(self) -> list[float]:
        return [*self.position, *self.frame.ravel(), *self.window, self.near]


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


class Cost(NamedTuple):
    """What a lookup asks of any machine, for one receiver."""

    texel_reads: int
    """The most texels read; `pcss` stops after the search where nothing blocks."""
    rays: int
    """Shadow rays."""
    bytes: int
    """The most bytes read from the map."""


def cost(technique: str, *, itemsize: int = 4, **knobs: Any) -> Cost:
    """What a technique of this chapter asks for one receiver, whatever the machine.

    Parameters
    ----------
    technique : {"hard", "pcf", "pcss", "ray_traced"}
        The function's name.
    itemsize : int
        Bytes of a texel.
    **knobs
        The function's own arguments; those that do not matter to the cost are ignored.

    Returns
    -------
    Cost

    Raises
    ------
    ValueError
        If there is no such technique.

    Examples
    --------
    >>> cost("pcss", blocker_samples=16, filter_samples=32)
    Cost(texel_reads=48, rays=0, bytes=192)
    """
    _arrays.choice("technique", technique, ("hard", "pcf", "pcss", "ray_traced"))
    if technique == "ray_traced":
        return Cost(0, int(knobs.get("samples", 16)), 0)
    if technique == "hard":
        reads = 1
    elif technique == "pcf":
        reads = int(knobs.get("samples", 16))
    else:
        reads = int(knobs.get("blocker_samples", 16)) + int(knobs.get("filter_samples", 32))
    return Cost(reads, 0, reads * itemsize)


def _sides(name: str, value: Any) -> tuple[float, float]:
    """One width for both sides, or a pair."""
    pair = (value, value) if np.ndim(value) == 0 else tuple(value)
    if len(pair) != 2:
        raise ValueError(f"{name}: expected a number or a pair, got {value!r}")
    return _arrays.number(name, pair[0], 0.0), _arrays.number(name, pair[1], 0.0)


def shadow_map(
    positions: ArrayLike,
    faces: ArrayLike,
    light: Light,
    resolution: int | tuple[int, int] = 1024,
    *,
    receivers: ArrayLike | None = None,
    cull: Cull = "none",
    progress: bool | Callable[[int, int], object] | None = None,
) -> ShadowMap:
    """Draw the depth of a mesh as a light sees it.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices of everything that casts a shadow. Their precision is the map's.
    faces : array_like of int, shape (F, 3)
        Triangles.
    light : PointLight, RectLight or DirectionalLight
        A point light is seen through one perspective map towards the scene's middle, a rectangular light through one
        from its centre along its normal, a directional light through a parallel one. All are fitted to the mesh.
    resolution : int or (int, int)
        Texels along both sides, or (width, height); at most 16384.
    receivers : array_like, shape (..., 3), optional
        Points that will be looked up. The map is then fitted to what lies between them and the light, which gives
        finer texels where a large scene casts onto a small view.
    cull : {"none", "back", "front"}
        Faces that are dropped. "front" keeps what faces away from the light: less acne, more leaks.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total).

    Returns
    -------
    ShadowMap

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, a vertex is not finite, or the light points nowhere.

    Notes
    -----
    Depth is linear and exact to a few roundings of its precision. Perspective maps look at most 75 degrees away from
    their axis; what lies outside of a map counts as lit. So a point light within its scene needs several maps, and a
    two-sided rectangular light is seen from its front alone. Cost: one rasterisation, and `resolution`² items.

    References
    ----------
    L. Williams, *Casting Curved Shadows on Curved Surfaces*, 1978.

    Examples
    --------
    >>> from shadelab.light import DirectionalLight
    >>> triangle = [[0.0, 1, 0], [1, 1, 0], [0, 1, 1]]
    >>> light = DirectionalLight(direction=(0, -1, 0), irradiance=(1, 1, 1))
    >>> shadow_map(triangle, [[0, 2, 1]], light, 8).depth.shape
    (8, 8)
    """
    points = _arrays.vectors("positions", positions)
    if points.ndim != 2:
        raise ValueError(f"positions: expected shape (V, 3), got {points.shape}")
    finite = np.isfinite(points).all(-1)
    if not finite.all():
        raise ValueError(f"positions: vertex {int(np.argmin(finite))} is not finite")
    given = np.asarray(faces)
    triangles = _arrays.indices("faces", given.reshape(0, 3) if given.size == 0 else given, 3, len(points))
    width, height = (resolution, resolution) if np.ndim(resolution) == 0 else resolution  # type: ignore[misc]
    width = _arrays.count("resolution", width, 1, _MAX_RESOLUTION)
    height = _arrays.count("resolution", height, 1, _MAX_RESOLUTION)
    _arrays.choice("cull", cull, ("none", "back", "front"))
    looked_up = None if receivers is None else _arrays.vectors("receivers", receivers).reshape(-1, 3)
    if looked_up is not None and not (seen := np.isfinite(looked_up).all(-1)).all():
        looked_up = looked_up[seen] if seen.any() else None

    perspective, origin, frame, sides = _light_frame(light, points, looked_up)
    # The map and its lookups must round the frame alike.
    origin, frame = (a.astype(points.dtype).astype(np.float64) for a in (origin, frame))
    cast = np.zeros(len(points), bool)
    cast[triangles] = True
    used = points if cast.all() else points[cast]
    if perspective:
        window, near, far = _fit_perspective(used, points, triangles, origin, frame, looked_up, sides)
    else:
        origin, window, near, far = _fit_orthographic(used, origin, frame, looked_up)
        origin = origin.astype(points.dtype).astype(np.float64)
    window = _grow(window, (width, height)).astype(points.dtype).astype(np.float64)

    depth = np.empty((height, width), points.dtype)
    view = (list(origin), frame.tolist(), list(window), near, far, perspective)
    _kernels.shadow_map(points, triangles, view, cull, _arrays.progress_callback(progress, "shadow map"), depth)
    # What was drawn is a tighter bound than what was fitted, and the blocker search starts there.
    drawn = np.isfinite(depth)
    if drawn.any():
        near, far = float(depth.min()), float(depth.max(where=drawn, initial=-np.inf))
    kind: Literal["perspective", "orthographic"] = "perspective" if perspective else "orthographic"
    return ShadowMap(depth, kind, origin, frame, window, near, far, sides)


def _unit(name: str, v: NDArray[np.float64]) -> NDArray[np.float64]:
    # Squares of the largest and least numbers are out of range.
    largest = np.abs(v).max()
    if np.isfinite(largest) and largest > 0:
        v = v / largest
    length = np.linalg.norm(v)
    if not (np.isfinite(length) and length > 0):
        raise ValueError(f"{name}: expected a direction, got {v.tolist()}")
    return np.asarray(v / length)


def _frame_along(axis: NDArray[np.float64]) -> NDArray[np.float64]:
    """Right, up, axis, with the world's y up unless the axis is close to it."""
    world_up = np.array([0.0, 1.0, 0.0]) if abs(axis[1]) < 0.99 else np.array([0.0, 0.0, 1.0])
    right = _unit("light", np.cross(axis, world_up))
    return np.stack([right, np.cross(right, axis), axis])


def _light_frame(
    light: Light, points: Floats, receivers: Floats | None
) -> tuple[bool, NDArray[np.float64], NDArray[np.float64], tuple[float, float]]:
    """Whether the map is perspective, its origin, its frame, and the light's sides."""
    if isinstance(light, RectLight):
        u, v = np.asarray(light.edge_u, np.float64), np.asarray(light.edge_v, np.float64)
        axis, right = _unit("light", np.cross(u, v)), _unit("light", u)
        frame = np.stack([right, np.cross(right, axis), axis])
        # Edges need not be square to each other: what counts is the extent along the map's sides.
        return True, np.asarray(light.center, np.float64), frame, (float(np.linalg.norm(u)), float(abs(v @ frame[1])))
    seen = points if receivers is None or not receivers.size else receivers
    finite = seen[np.isfinite(seen).all(-1)].astype(np.float64)
    middle = (finite.min(0) + finite.max(0)) / 2 if len(finite) else np.zeros(3)
    if isinstance(light, PointLight):
        position = np.asarray(light.position, np.float64)
        away = middle - position
        axis = _unit("light", away) if np.linalg.norm(away) > 0 else np.array([0.0, -1.0, 0.0])
        return True, position, _frame_along(axis), (0.0, 0.0)
    if isinstance(light, DirectionalLight):
        return False, middle, _frame_along(_unit("light", np.asarray(light.direction, np.float64))), (0.0, 0.0)
    raise TypeError(f"light: expected a PointLight, RectLight or DirectionalLight, got {type(light).__name__}")


def _span(
    points: Floats, origin: NDArray[np.float64], frame: NDArray[np.float64], near: float | None = None
) -> tuple[NDArray[np.float64], float, float] | None:
    """Window, least and greatest depth of points; at unit depth, from `near` on, if given. None if none is seen."""
    low, high = _kernels.span(np.ascontiguousarray(points), list(origin), frame.tolist(), near)
    if not low[2] <= high[2]:
        return None
    return np.array([low[0], high[0], low[1], high[1]]), low[2], high[2]


def _fit_perspective(
    used: Floats,
    points: Floats,
    triangles: NDArray[np.int32],
    origin: NDArray[np.float64],
    frame: NDArray[np.float64],
    receivers: Floats | None,
    sides: tuple[float, float],
) -> tuple[NDArray[np.float64], float, float]:
    """The window at unit depth, and the depths to draw between."""
    whole = _span(used, origin, frame)
    if whole is None or whole[2] <= 0.0:
        return np.array([-1.0, 1, -1, 1]), 1.0, 1.0
    far = whole[2]
    near = far * _NEAREST
    front = used
    if whole[1] < near:
        # Where an edge passes the near plane, the triangle is seen from there on.
        corners = (points.astype(np.float64) - origin)[triangles]
        ends = np.concatenate([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 6)
        depths = np.stack([ends[:, :3] @ frame[2], ends[:, 3:] @ frame[2]])
        passing = (depths[0] < near) != (depths[1] < near)
        ends, depths = ends[passing], depths[:, passing]
        share = ((near - depths[0]) / (depths[1] - depths[0]))[:, None]
        # A rounding beyond the plane, so that none is lost before it.
        entries = ends[:, :3] + share * (ends[:, 3:] - ends[:, :3]) + frame[2] * (near * 1e-9)
        front = np.concatenate([used.astype(np.float64), entries + origin])
    seen = _span(front, origin, frame, near * (1.0 - 1e-6))
    if seen is None:
        return np.array([-1.0, 1, -1, 1]), 1.0, 1.0
    window, nearest, _ = seen
    if receivers is not None:
        around = _span(receivers, origin, frame, near)
        if around is not None:
            # A receiver looks at the light past blockers as near as any: its search may reach so far aside.
            reach = np.asarray(sides) / 2 * max(1 / nearest - 1 / around[2], 0.0)
            window = _common(window, around[0] + np.array([-1, 1, -1, 1]) * np.repeat(reach, 2))
    return np.clip(window, -_MAX_TANGENT, _MAX_TANGENT), near, far


def _fit_orthographic(
    used: Floats,
    origin: NDArray[np.float64],
    frame: NDArray[np.float64],
    receivers: Floats | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float]:
    """The origin moved before everything, the window, and the depths to draw between."""
    whole = _span(used, origin, frame)
    if whole is None:
        return origin, np.array([-1.0, 1, -1, 1]), 0.0, 1.0
    window, low, high = whole
    margin = max((high - low) * 0.01, 1e-6 * max(abs(low), abs(high), float(np.abs(window).max())), 1e-30)
    around = None if receivers is None else _span(receivers, origin, frame)
    if around is not None:
        window = _common(window, around[0])
    # One margin before the nearest, one behind the farthest caster.
    moved = origin + frame[2] * (low - 2 * margin)
    return moved, window, margin, high - low + 3 * margin


def _common(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """What two windows share; the first if they share nothing."""
    both = np.array([max(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), min(a[3], b[3])])
    return both if both[0] < both[1] and both[2] < both[3] else a


def _grow(window: NDArray[np.float64], size: tuple[int, int]) -> NDArray[np.float64]:
    """Two texels more on each side, so that a silhouette lies within; never without extent."""
    grown = window.astype(np.float64).copy()
    smallest = 1e-3 * max(float(np.abs(window).max()), float(np.ptp(window[:2])), float(np.ptp(window[2:])), 1e-30)
    for i, texels in ((0, size[0]), (2, size[1])):
        extent = max(grown[i + 1] - grown[i], smallest)
        middle = (grown[i] + grown[i + 1]) / 2
        half = extent * (0.5 + 2.0 / texels)
        grown[i], grown[i + 1] = middle - half, middle + half
    return grown


def _granted(
    shadow_map: ShadowMap,
    normals: ArrayLike | None,
    bias: float,
    slope_bias: float,
    normal_offset: float,
    receiver_plane: bool,
) -> tuple[float, float, float, bool]:
    if not isinstance(shadow_map, ShadowMap):
        raise TypeError(f"shadow_map: expected a ShadowMap, got {type(shadow_map).__name__}")
    return (
        _arrays.number("bias", bias),
        _arrays.number("slope_bias", slope_bias, 0.0),
        _arrays.number("normal_offset", normal_offset, 0.0),
        bool(receiver_plane) and normals is not None,
    )


def _receivers(
    shadow_map: ShadowMap, receivers: ArrayLike, normals: ArrayLike | None
) -> tuple[tuple[int, ...], Floats, Floats | None]:
    """The batch's shape, points and normals as (n, 3) in the map's precision."""
    dtype = shadow_map.depth.dtype
    named = {"receivers": (_arrays.vectors("receivers", receivers, 3, dtype), 1)}
    if normals is not None:
        named["normals"] = (_arrays.vectors("normals", normals, 3, dtype), 1)
    shape, flat = _arrays.broadcast(named)
    return shape, flat[0], flat[1] if normals is not None else None


def _result(out: Floats | None, shape: tuple[int, ...], dtype: Any) -> tuple[Floats, Floats]:
    result = _arrays.output("out", out, shape, dtype)
    return result, result.reshape(-1)


def _taps(name: str, kernel: str, samples: int, seed: int | None) -> tuple[str, int, int | None]:
    _arrays.choice("kernel", kernel, _KERNELS)
    n = _arrays.count(name, samples, 1, _MAX_SAMPLES)
    if kernel == "grid" and math.isqrt(n) ** 2 != n:
        raise ValueError(f"{name}: expected a square number for kernel 'grid', got {n}")
    return kernel, n, None if seed is None else _arrays.count("seed", seed, 0, 2**64 - 1)


def hard(
    shadow_map: ShadowMap,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    bias: float = 0.0,
    slope_bias: float = 0.05,
    normal_offset: float = 0.0,
    receiver_plane: bool = True,
    out: Floats | None = None,
) -> Floats:
    """Hard shadows: 1 where the light's centre is seen, 0 elsewhere, by one texel.

    Parameters
    ----------
    shadow_map : ShadowMap
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
    out : ndarray, shape (...), optional
        The array to write into.

    Returns
    -------
    ndarray, shape (...)
        The lit fraction, 0 or 1; 1 outside of the map and behind the light; NaN where a receiver or normal is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, or a bias is negative.

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
    granted = _granted(shadow_map, normals, bias, slope_bias, normal_offset, receiver_plane)
    shape, points, n = _receivers(shadow_map, receivers, normals)
    result, flat = _result(out, shape, points.dtype)
    perspective = shadow_map.projection == "perspective"
    _kernels.hard(shadow_map.depth, shadow_map._geometry(), perspective, points, n, granted, flat)
    return result


def pcf(
    shadow_map: ShadowMap,
    receivers: ArrayLike,
    normals: ArrayLike | None = None,
    *,
    samples: int = 16,
    radius: float = 1.5,
    units: Literal["texels", "world"] = "texels",
    kernel: Kernel = "vogel",
    seed: int | None = 0,
    bias: float = 0.0,
    slope_bias: float = 0.05,
    normal_offset: float = 0.0,
    receiver_plane: bool = True,
    out: Floats | None = None,
) -> Floats:
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
    kernel : {"vogel", "box", "grid"}
        Where the samples lie: on a disk (Vogel's spiral), in a square (a lattice), or in n × n cells of a square.
    seed : int or None
        Each receiver turns the disk, or shifts the square's points, by random amounts that follow from the seed and its
        place in the batch: noise instead of banding. None gives all receivers the same points.
    bias, slope_bias, normal_offset, receiver_plane, out
        As in `hard`.

    Returns
    -------
    ndarray, shape (...)
        The lit fraction, a multiple of 1 / `samples`; NaN where a receiver or normal is NaN.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range.

    Notes
    -----
    A penumbra of one width everywhere: right for antialiasing, wrong for an area light, whose shadow should harden at
    contact. As `radius` goes to 0 the result is that of `hard`. With normals the filter follows the receiver's tangent
    plane, so that wide filters need no more bias than narrow ones. Cost: `samples` texel reads.

    References
    ----------
    W. Reeves, D. Salesin, R. Cook, *Rendering Antialiased Shadows with Depth Maps*, 1987. H. Vogel, *A better way to
    construct the sunflower head*, 1979.

    Examples
    --------
    >>> import numpy as np
    >>> depth = np.where(np.arange(64) < 32, 2.0, np.inf)[None].repeat(64, 0)
    >>> frame = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    >>> above = ShadowMap(depth, "perspective", [0, 4, 0], frame, [-1, 1, -1, 1], 2.0, 4.0)
    >>> pcf(above, [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]], [0, 1, 0], radius=4, kernel="box", seed=None)
    array([0. , 0.5, 1. ])
    """
    granted = _granted(shadow_map, normals, bias, slope_bias, normal_offset, receiver_plane)
    taps = _taps("samples", kernel, samples, seed)
    half = _arrays.number("radius", radius, 0.0)
    texels = _arrays.choice("units", units, ("texels", "world")) == "texels"
    shape, points, n = _receivers(shadow_map, receivers, normals)
    result, flat = _result(out, shape, points.dtype)
    perspective = shadow_map.projection == "perspective"
    geometry = shadow_map._geometry()
    _kernels.pcf(shadow_map.depth, geometry, perspective, points, n, taps, half, texels, granted, flat)
    return result


@overload
def pcss(
    shadow_map: ShadowMap,
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
    shadow_map: ShadowMap,
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
    shadow_map: ShadowMap,
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
    kernel : {"vogel", "box", "grid"}, optional
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
    light's axis; under a rectangular light with kernel "box" also in profile. Fails where blockers at several depths
    overlap: they count as one at their mean depth, so shadows of the nearer are too sharp and light may leak. What the
    light's centre does not see cannot block. A few blocker samples miss thin blockers. Cost: `blocker_samples` texel
    reads, and `filter_samples` more where something blocks (one more where the search found nothing).

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
    granted = _granted(shadow_map, normals, bias, slope_bias, normal_offset, receiver_plane)
    sides = shadow_map.light_size if light_size is None else _sides("light_size", light_size)
    if light_size is None and max(sides) == 0.0:
        raise ValueError("light_size: the map's light has no extent, so its width must be given")
    perspective = shadow_map.projection == "perspective"
    if not perspective:
        if max(sides) >= math.pi:
            raise ValueError(f"light_size: expected an angle below pi, got {max(sides):g}")
        sides = 2.0 * math.tan(sides[0] / 2.0), 2.0 * math.tan(sides[1] / 2.0)
    if kernel is None:
        kernel = "box" if max(shadow_map.light_size) > 0.0 else "vogel"
    frustum = _arrays.choice("search", search, ("region", "frustum")) == "frustum"
    blockers = _taps("blocker_samples", kernel, blocker_samples, seed)
    filtered = _taps("filter_samples", kernel, filter_samples, seed)
    shape, points, n = _receivers(shadow_map, receivers, normals)
    result, flat = _result(out, shape, points.dtype)
    more = [np.empty_like(flat) for _ in range(3)] if full_output else None
    geometry = shadow_map._geometry()
    _kernels.pcss(
        shadow_map.depth, geometry, perspective, points, n, sides, blockers, frustum, filtered, granted, flat, more
    )
    return result if more is None else PCSS(result, *(a.reshape(shape) for a in more))


def ray_traced(
    bvh: BVH,
    receivers: ArrayLike,
    normals: ArrayLike | None,
    light: Light,
    samples: int = 16,
    *,
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
        rays start a little off the surface; without, by area, and from the receiver itself.
    light : PointLight, RectLight or DirectionalLight
        What rays are sent to; one ray suffices for a light without extent.
    samples : int
        Rays to a rectangular light, at most 4096; powers of two are most even.
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
    shadow edge across the stratified light is all that varies. With normals the estimate is a ratio of two sums, whose
    bias falls as 1 / samples; it is exact, without noise, where the light is wholly seen or hidden. Surfaces nearer to
    the light than 1e-4 of the distance hide nothing. Cost: `samples` shadow rays.

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
    named = {"receivers": (_arrays.vectors("receivers", receivers, 3, bvh.dtype), 1)}
    if normals is not None:
        named["normals"] = (_arrays.vectors("normals", normals, 3, bvh.dtype), 1)
    shape, flat = _arrays.broadcast(named)
    faces = None
    if ignore_face is not None:
        ids = accel._rays.ignored("ignore_face", ignore_face, "a face", len(bvh._faces))
        try:
            faces = np.ascontiguousarray(np.broadcast_to(ids, shape), np.int32).reshape(-1)
        except ValueError:
            raise ValueError(f"ignore_face: expected shape {shape}, got {ids.shape}") from None
    zero = [0.0, 0.0, 0.0]
    if isinstance(light, RectLight):
        kind, vectors = "rect", [list(map(float, v)) for v in (light.center, light.edge_u, light.edge_v)]
    elif isinstance(light, PointLight):
        kind, vectors, n = "point", [list(map(float, light.position)), zero, zero], 1
    elif isinstance(light, DirectionalLight):
        towards = -_unit("light", np.asarray(light.direction, np.float64))
        kind, vectors, n = "directional", [towards.tolist(), zero, zero], 1
    else:
        raise TypeError(f"light: expected a PointLight, RectLight or DirectionalLight, got {type(light).__name__}")
    # Points on a surface are off it by some roundings of the largest coordinate.
    reach = float(np.abs(bvh.positions).max(initial=0.0))
    offset = 32.0 * float(np.finfo(bvh.dtype).eps) * reach
    result, flat_out = _result(out, shape, bvh.dtype)
    watch = _arrays.progress_callback(progress, "shadow rays")
    normal = flat[1] if normals is not None else None
    _kernels.ray_traced(bvh._tree, flat[0], normal, faces, (kind, vectors), n, key, offset, watch, flat_out)
    return result
