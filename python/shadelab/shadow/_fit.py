"""Where a light's map looks: its frame, and the window that it is fitted to."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import Floats
from .._kernels import shadow as _kernels
from ..light import DirectionalLight, DiskLight, PointLight, PolygonLight, RectLight, SphereLight, SpotLight

# How far from its axis a light's map may look: 75 degrees.
_MAX_TANGENT = math.tan(math.radians(75.0))
# Nothing nearer than this fraction of the farthest depth is drawn into a perspective map.
_NEAREST = 1e-4


def _unit(name: str, v: NDArray[np.float64]) -> NDArray[np.float64]:
    # Squares of the largest and least numbers are out of range.
    largest = np.abs(v).max()
    if np.isfinite(largest) and largest > 0:
        v = v / largest
    length = np.linalg.norm(v)
    if not (np.isfinite(length) and length > 0):
        raise ValueError(f"{name}: expected a direction, got {v.tolist()}")
    return np.asarray(v / length)


def _centroid(corners: Any) -> NDArray[np.float64]:
    """The middle of a flat polygon's area."""
    points = np.asarray(corners, np.float64)
    sides = points - points[0]
    crosses = np.cross(sides[1:-1], sides[2:])
    shares = crosses @ crosses.sum(0)
    return np.asarray(points[0] + shares @ (sides[1:-1] + sides[2:]) / (3.0 * shares.sum()))


def _frame_along(axis: NDArray[np.float64]) -> NDArray[np.float64]:
    """Right, up, axis, with the world's y up unless the axis is close to it."""
    world_up = np.array([0.0, 1.0, 0.0]) if abs(axis[1]) < 0.99 else np.array([0.0, 0.0, 1.0])
    right = _unit("light", np.cross(axis, world_up))
    return np.stack([right, np.cross(right, axis), axis])


def _light_frame(
    light: Any, points: Floats, receivers: Floats | None
) -> tuple[bool, NDArray[np.float64], NDArray[np.float64], tuple[float, float]]:
    """Whether the map is perspective, its origin, its frame, and the light's sides."""
    if isinstance(light, RectLight):
        u, v = np.asarray(light.edge_u, np.float64), np.asarray(light.edge_v, np.float64)
        axis, right = _unit("light", np.cross(u, v)), _unit("light", u)
        frame = np.stack([right, np.cross(right, axis), axis])
        # Edges need not be square to each other: what counts is the extent along the map's sides.
        return True, np.asarray(light.center, np.float64), frame, (float(np.linalg.norm(u)), float(abs(v @ frame[1])))
    if isinstance(light, DiskLight | PolygonLight):
        center = light.center if isinstance(light, DiskLight) else _centroid(light.corners)
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
    sides: tuple[float, float] = (0.0, 0.0),
) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float]:
    """The origin moved before everything, the window, and the depths to draw between; `sides` are angles."""
    whole = _span(used, origin, frame)
    if whole is None:
        return origin, np.array([-1.0, 1, -1, 1]), 0.0, 1.0
    window, low, high = whole
    margin = max((high - low) * 0.01, 1e-6 * max(abs(low), abs(high), float(np.abs(window).max())), 1e-30)
    around = None if receivers is None else _span(receivers, origin, frame)
    if around is not None:
        # As of a perspective map: blockers as near the light as any may hide it.
        reach = np.tan(np.asarray(sides) / 2.0) * max(around[2] - low, 0.0)
        window = _common(window, around[0] + np.array([-1, 1, -1, 1]) * np.repeat(reach, 2))
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


def _coarse(x: float, steps: int = 8) -> float:
    """The next number up of so many (a power of two) to an octave: steps that binary fractions hold exactly."""
    if x <= 0.0:
        return x
    mantissa, exponent = math.frexp(x)
    # A rounding above a step is that step.
    return math.ldexp(math.ceil(mantissa * 2 * steps * (1.0 - 1e-12)) / (2 * steps), exponent)


def _snapped(
    middle: NDArray[np.float64], extent: float, size: tuple[int, int], border: float, steps: int
) -> NDArray[np.float64]:
    """A window about a place, whose texels are squares of a coarse size at whole multiples of it."""
    texel = _coarse(max(extent / (n - 2.0 * border - 1.0) for n in size), steps)
    first = [math.floor(m / texel - n / 2.0) for m, n in zip(middle, size, strict=True)]
    return np.array([first[0], first[0] + size[0], first[1], first[1] + size[1]]) * texel
