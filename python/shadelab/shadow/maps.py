"""Shadow maps: the depth of a scene as a light sees it."""

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
from ..light import DirectionalLight, DiskLight, PointLight, PolygonLight, RectLight, SphereLight, SpotLight

__all__ = ["ShadowMap", "shadow_map"]

Cull: TypeAlias = Literal["none", "back", "front"]
Light: TypeAlias = DirectionalLight | PointLight | SpotLight | RectLight | DiskLight | SphereLight | PolygonLight
_MAX_RESOLUTION = 16384
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
    light : light of shadelab.light, but for ambient light
        A point light and a sphere are seen through one perspective map towards the scene's middle, a spot light through
        one along its axis, a rectangle, a disk or a polygon through one from its centre along its normal, a directional
        light through a parallel one. All are fitted to the mesh. For `pcss` round lights and polygons are squares of
        the same area.
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
        if isinstance(light, SpotLight) and light.outer_angle < math.pi / 2:
            cone = math.tan(light.outer_angle)
            window = np.clip(window, -cone, cone)
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
    if isinstance(light, DiskLight | PolygonLight):
        center = light.center if isinstance(light, DiskLight) else np.mean(light.corners, 0)
        side = math.sqrt(light.area)
        frame = _frame_along(_unit("light", np.asarray(light.normal, np.float64)))
        return True, np.asarray(center, np.float64), frame, (side, side)
    if isinstance(light, SpotLight):
        axis = _unit("light", np.asarray(light.direction, np.float64))
        return True, np.asarray(light.position, np.float64), _frame_along(axis), (0.0, 0.0)
    seen = points if receivers is None or not receivers.size else receivers
    finite = seen[np.isfinite(seen).all(-1)].astype(np.float64)
    middle = (finite.min(0) + finite.max(0)) / 2 if len(finite) else np.zeros(3)
    if isinstance(light, PointLight | SphereLight):
        position = np.asarray(light.position if isinstance(light, PointLight) else light.center, np.float64)
        away = middle - position
        axis = _unit("light", away) if np.linalg.norm(away) > 0 else np.array([0.0, -1.0, 0.0])
        side = math.sqrt(math.pi) * light.radius if isinstance(light, SphereLight) else 0.0
        return True, position, _frame_along(axis), (side, side)
    if isinstance(light, DirectionalLight):
        return False, middle, _frame_along(_unit("light", np.asarray(light.direction, np.float64))), (0.0, 0.0)
    raise TypeError(f"light: expected a light that a map can look from, got {type(light).__name__}")


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
