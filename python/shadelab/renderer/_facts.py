"""What a plan asks about a scene: bounds, whether anything can shade anything, what a light reaches."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _arrays, geometry, light, raster, shadow

RESOLUTIONS = (256, 512, 1024, 2048)


@dataclass(frozen=True)
class Facts:
    """What a plan asks about a scene, computed once."""

    positions: NDArray[np.float64]
    faces: NDArray[np.int32]
    eye: NDArray[np.float64]
    pixel: float
    """Size of a pixel at unit distance."""
    nearest: float
    """Least distance of the scene's bounds from the eye."""
    extent: float
    """Diagonal of the scene's bounds."""
    unshadowed: str
    """Why nothing in the scene can shade anything else; empty if something can."""


def facts_of(scene: Any, size: tuple[int, int]) -> Facts:
    arrays = scene.flatten(np.float32)
    positions, faces = arrays.positions.astype(np.float64), arrays.faces
    eye = np.asarray(scene.camera.eye, np.float64)
    used = positions[np.unique(faces)] if len(faces) else np.zeros((1, 3))
    low, high = used.min(0), used.max(0)
    nearest = float(np.linalg.norm(np.maximum(np.maximum(low - eye, eye - high), 0.0)))
    pixel = 2.0 * math.tan(float(scene.camera.fov_y) / 2.0) / size[1]
    extent = float(np.linalg.norm(high - low))
    if not len(faces):
        reason = "the scene has no surfaces"
    elif _is_flat(used, extent):
        reason = "all surfaces lie in one plane"
    elif _is_convex(positions, faces, eye, extent):
        reason = "the only body is convex, and cannot shade itself"
    else:
        reason = ""
    return Facts(positions, faces, eye, pixel, nearest, extent, reason)


def _is_flat(points: NDArray[np.float64], extent: float) -> bool:
    centred = points - points.mean(0)
    normal = np.linalg.eigh(centred.T @ centred)[1][:, 0]
    return bool(np.abs(centred @ normal).max() <= 1e-6 * extent)


def _is_convex(
    positions: NDArray[np.float64], faces: NDArray[np.int32], eye: NDArray[np.float64], extent: float
) -> bool:
    """Whether the faces form one closed convex surface, seen from outside.

    A closed surface that is convex at every edge consists of convex bodies, each of Euler characteristic 2.
    """
    if not 4 <= len(faces) <= 200_000:
        return False
    # Vertices that were split for normals or texture coordinates are one.
    points, welded = np.unique(positions, axis=0, return_inverse=True)
    f = welded.reshape(-1)[faces]
    start, end = f.reshape(-1), np.roll(f, -1, axis=1).reshape(-1)
    opposite = np.roll(f, -2, axis=1).reshape(-1)
    key, reverse = start * len(points) + end, end * len(points) + start
    order = np.argsort(key)
    at = np.searchsorted(key[order], reverse)
    if len(np.unique(key)) != len(key) or (at == len(key)).any() or (key[order[at]] != reverse).any():
        return False
    if len(np.unique(f)) - len(key) // 2 + len(f) != 2:
        return False
    normals = np.cross(points[f[:, 1]] - points[f[:, 0]], points[f[:, 2]] - points[f[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)
    across = points[opposite[order[at]]] - points[start]
    rises = np.einsum("ij,ij->i", across, np.repeat(normals, 3, axis=0))
    outside = np.einsum("ij,ij->i", eye - points[f[:, 0]], normals) > 0
    return bool(rises.max() <= 1e-6 * extent and outside.any())


def brightness(lamp: Any) -> float:
    if isinstance(lamp, light.RectLight):
        return max(lamp.mean_radiance)
    emitted = next(getattr(lamp, n) for n in ("radiance", "intensity", "irradiance") if hasattr(lamp, n))
    return float(np.max(emitted))


def flat(lamp: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """The middle and the normal of a flat light."""
    if isinstance(lamp, light.PolygonLight):
        return np.mean(lamp.corners, 0), np.asarray(lamp.normal)
    if isinstance(lamp, light.RectLight | light.DiskLight):
        return np.asarray(lamp.center), np.asarray(shadow._unit("normal", np.asarray(lamp.normal)))
    return None


def outline(lamp: Any) -> NDArray[np.float64] | None:
    """Points whose hull holds a light with an outline, (n, 3)."""
    if isinstance(lamp, light.RectLight | light.PolygonLight):
        return np.asarray(lamp.corners)
    if isinstance(lamp, light.DiskLight):
        normal = shadow._unit("normal", np.asarray(lamp.normal))
        side = np.eye(3)[int(np.argmin(np.abs(normal)))]
        x = shadow._unit("normal", np.cross(normal, side)) * lamp.radius
        y = np.cross(normal, x)
        return np.asarray(lamp.center) + [a * x + b * y for a in (-1, 1) for b in (-1, 1)]
    if isinstance(lamp, light.SphereLight):
        turns = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
        return np.asarray(lamp.center) + turns * lamp.radius
    return None


def highest(lamp: Any, directions: NDArray[Any]) -> NDArray[Any]:
    """How far a light with an outline reaches along unit directions (n, 3), from the origin."""
    if isinstance(lamp, light.SphereLight | light.DiskLight):
        reach: Any = lamp.radius
        if isinstance(lamp, light.DiskLight):
            along = directions @ shadow._unit("normal", np.asarray(lamp.normal)).astype(directions.dtype)
            reach = reach * np.sqrt(np.maximum(1 - along * along, 0))
        return np.asarray(directions @ np.asarray(lamp.center, directions.dtype) + reach)
    corners = np.asarray(lamp.corners, directions.dtype)
    return np.asarray((directions @ corners.T).max(-1))


def depths_before(lamp: Any, positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far positions are before a flat light, or from a sphere."""
    plane = flat(lamp)
    if plane is None:
        return np.asarray(np.linalg.norm(positions - np.asarray(lamp.center), axis=-1) - lamp.radius)
    return np.asarray((positions - plane[0]) @ plane[1])


def unlit(lamp: Any, facts: Facts) -> str:
    """Why a light reaches nothing; empty if it may."""
    if brightness(lamp) == 0.0:
        return "it emits nothing"
    if flat(lamp) is not None and not lamp.two_sided:
        depths = depths_before(lamp, facts.positions[np.unique(facts.faces)])
        if depths.max(initial=-math.inf) <= 1e-6 * facts.extent:
            return "it faces away from every surface"
    return ""


def beyond_one_map(lamp: Any, facts: Facts) -> str:
    """Why one shadow map cannot see what a light shines on; empty if it can."""
    used = facts.positions[np.unique(facts.faces)]
    if flat(lamp) is not None:
        if lamp.two_sided and depths_before(lamp, used).min() < -1e-6 * facts.extent:
            return "the light shines to both sides, and a map sees one"
    elif isinstance(lamp, light.SpotLight):
        if lamp.outer_angle > math.radians(65.0):
            return "the light's cone is wider than a map can look"
    elif isinstance(lamp, light.PointLight | light.SphereLight):
        # Whether the bounds' corners lie in the cone of a map towards their middle.
        position = np.asarray(lamp.position if isinstance(lamp, light.PointLight) else lamp.center)
        low, high = used.min(0), used.max(0)
        corners = np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij")).reshape(3, -1).T
        away, axis = corners - position, (low + high) / 2 - position
        along, length = away @ axis, np.linalg.norm(away, axis=-1) * np.linalg.norm(axis)
        if (along <= length * math.cos(math.radians(65.0))).any():
            return "the light stands close to or within the scene, and one map cannot see all around"
    return ""


def too_close(lamp: Any, facts: Facts) -> str:
    """Why what a light's middle sees says little of what all of it does; empty if it may."""
    corners = np.asarray(outline(lamp))
    middle = np.asarray(lamp.center) if hasattr(lamp, "center") else corners.mean(0)
    reach = lamp.radius if hasattr(lamp, "radius") else np.linalg.norm(corners - middle, axis=-1).max()
    across = 2.0 * float(reach)
    at = facts.positions[facts.faces]
    plane = flat(lamp)
    if plane is not None:
        depths = (at - plane[0]) @ plane[1]
        at = at[((np.abs(depths) if lamp.two_sided else depths) > 1e-6 * facts.extent).any(-1)]
    if not len(at):
        return ""
    nearest = float(geometry.closest_point_triangle(middle, *np.moveaxis(at, 1, 0), full_output=True).distance.min())
    if nearest >= across:
        return ""
    return (
        f"surfaces come as near to the light ({nearest:.2g}) as it is wide ({across:.2g}): a map from its middle does "
        "not see what they hide"
    )


def widest_penumbra(lamp: Any, facts: Facts) -> float:
    """A bound by similar triangles, on receivers of any tilt; if too wide for a pixel already without tilt, that alone.

    The rays from a light through one point of a blocker meet a plane within the light's diameter, times how much
    farther the plane is than the blocker, over the least cosine of a ray and the plane's normal: the norm of a
    projection along the ray. The nearest blocker over the farthest receiver bounds the one, corners of the light and
    of faces the other.
    """
    depths = depths_before(lamp, facts.positions[np.unique(facts.faces)])
    if depths.min() <= 0.0:
        return math.inf
    corners = np.asarray(outline(lamp))
    if isinstance(lamp, light.RectLight | light.PolygonLight):
        across, behind = max(math.dist(a, b) for a in corners for b in corners), 0.0
    else:
        across = 2.0 * float(lamp.radius)
        behind = across if isinstance(lamp, light.SphereLight) else 0.0
    width = across * float((depths.max() + behind) / depths.min() - 1.0)
    if not width < facts.nearest * facts.pixel:
        return width
    return width / max(_least_cosine(corners, facts), 1e-300)


def _least_cosine(corners: NDArray[np.float64], facts: Facts) -> float:
    """Of normals and directions to a light, where it shines on a seen side; 0 if it crosses a plane."""
    at = facts.positions[facts.faces]
    normals = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    length = np.linalg.norm(normals, axis=-1)
    at, normals = at[length > 0], normals[length > 0] / length[length > 0, None]
    normals *= np.sign(np.einsum("ij,ij->i", facts.eye - at[:, 0], normals))[:, None]
    low, high, far = np.full(len(at), math.inf), np.full(len(at), -math.inf), np.zeros(len(at))
    for corner in corners:
        height = np.einsum("ij,ij->i", corner - at[:, 0], normals)
        low, high = np.minimum(low, height), np.maximum(high, height)
        far = np.maximum(far, np.linalg.norm(at - corner, axis=-1).max(-1, initial=0.0))
    shone = high > 1e-9 * far
    return float((np.maximum(low, 0.0) / np.maximum(far, 1e-300))[shone].min(initial=1.0))


def resolution_for(facts: Facts) -> int:
    """The least resolution whose texels are no larger than a pixel at the scene's middle."""
    distance = facts.nearest + facts.extent / 2
    texels = facts.extent / max(distance * facts.pixel, 1e-30)
    return next((r for r in RESOLUTIONS if r >= texels), RESOLUTIONS[-1])


def check_scene(scene: Any) -> None:
    from ..scene import Scene

    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected a Scene, got {type(scene).__name__}")


def checked_size(size: Any) -> tuple[int, int]:
    try:
        width, height = size
    except (TypeError, ValueError):
        kind: type[Exception] = TypeError if np.ndim(size) == 0 else ValueError
        raise kind(f"size: expected (width, height), got {size!r}") from None
    return _arrays.count("size", width, 1, raster.MAX_SIZE), _arrays.count("size", height, 1, raster.MAX_SIZE)
