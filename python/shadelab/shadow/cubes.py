"""Maps of a point light all around: the six faces of a cube."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ..light import PointLight, SphereLight
from ._fit import _MAX_TANGENT, _NEAREST, _frame_along
from ._sets import MapSet
from .maps import Bits, Cull, Surface, _casters, _drawn, _how, _rounded, _used, _View

__all__ = ["CubeShadowMap", "cube_shadow_map"]


@dataclass(frozen=True, eq=False)
class CubeShadowMap(MapSet):
    """The depth of a scene all around a light: what `cube_shadow_map` gives.

    Parameters
    ----------
    maps : tuple of six ShadowMap
        Towards +x, -x, +y, -y, +z and -z, each as a spot light along that axis sees it, and a little wider than the
        cube's face.
    border : float
        Texels by which each map is wider than its face, on every side.
    """

    @property
    def position(self) -> NDArray[np.float64]:
        """The light's, shape (3,)."""
        position: NDArray[np.float64] = self.maps[0].position
        return position

    def _chosen(self, points: Floats) -> tuple[NDArray[np.uint8], None, None]:
        faces = np.empty(len(points), np.uint8)
        _kernels.cube_faces(points, list(self.position), faces)
        return faces, None, None


def cube_shadow_map(
    positions: ArrayLike,
    faces: ArrayLike,
    light: PointLight | SphereLight,
    resolution: int = 512,
    *,
    border: int = 8,
    cull: Cull = "none",
    surface: Surface = "first",
    bits: Bits = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> CubeShadowMap:
    """Draw the depth of a mesh all around a light.

    Parameters
    ----------
    positions, faces, cull, surface, bits
        As in `shadow_map`.
    light : PointLight or SphereLight
        What stands in the cube's middle.
    resolution : int
        Texels along a side of each of the six maps, their borders among them.
    border : int
        Texels by which maps reach beyond their face at the least: filters of `pcf` may be as wide. About a sphere they
        reach as far as `pcss` may search from there, up to 75 degrees off their axis.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total) for each face.

    Returns
    -------
    CubeShadowMap
        For `hard`, `pcf` and `pcss`.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, a vertex is not finite, or borders leave nothing of the maps.

    Notes
    -----
    A receiver is looked up in the face of the largest component of its direction. Filters stay in that face's map,
    whose border holds what lies beyond the edge, so that nothing leaks there; the texels of two faces meet at an edge
    at an angle, and shadow edges may shift by a texel. Depth is that along each face's axis. Cost: six rasterisations.

    References
    ----------
    P. Gerasimov, *Omnidirectional Shadow Mapping*, GPU Gems, 2004.

    Examples
    --------
    >>> from shadelab.mesh import box
    >>> from shadelab.shadow import hard
    >>> room = box((4.0, 4, 4))
    >>> around = cube_shadow_map(room.positions, room.faces, PointLight((0, 0, 0)), 64)
    >>> around.index([[1.9, 0, 0], [0, -1.9, 0]]), hard(around, [[1.9, 0, 0], [0, -3, 0]], [0, 1, 0])
    (array([0, 3]), array([1., 0.]))
    """
    points, triangles = _casters(positions, faces)
    side = _arrays.count("resolution", resolution, 1, 16384)
    margin = _arrays.count("border", border, 0)
    if 2 * margin >= side:
        raise ValueError(f"border: expected less than half the resolution, {side}, got {margin}")
    _arrays.choice("cull", cull, ("none", "back", "front"))
    how = _how(surface, bits)
    if not isinstance(light, PointLight | SphereLight):
        raise TypeError(f"light: expected a PointLight or a SphereLight, got {type(light).__name__}")
    watch = _arrays.progress_callback(progress, "cube shadow map")
    place, across = light.position if isinstance(light, PointLight) else light.center, 0.0
    if isinstance(light, SphereLight):
        across = math.sqrt(math.pi) * light.radius
    origin = _rounded(np.asarray(place, np.float64), points.dtype)

    used = _used(points, triangles)
    if len(used):
        away = used.astype(np.float64) - origin
        far = float(np.abs(away).max())
        near = far * _NEAREST
        nearest = max(_nearest(points[triangles] - origin), near)
        reach = across / 2.0 * max(1.0 / nearest - 1.0 / far, 0.0)
    else:
        near, far, reach = 1.0, 1.0, 0.0
    # The face ends at 1, its border so many texels farther.
    # Receivers where two faces meet may fall on either by rounding: a quarter of a texel more.
    half = min(max(1.0 / (1.0 - 2.0 * max(margin, 0.25) / side), 1.0 + reach), _MAX_TANGENT)
    window = _rounded(np.array([-half, half, -half, half]), points.dtype)
    maps = []
    for k in range(6):
        axis = np.zeros(3)
        axis[k // 2] = 1.0 - 2.0 * (k % 2)
        seen = _View(True, origin, _frame_along(axis), window, near, far)
        maps.append(_drawn(points, triangles, seen, (side, side), cull, how, (across, across)))
        if watch is not None:
            watch(k + 1, 6)
    return CubeShadowMap(tuple(maps), (1.0 - 1.0 / half) * side / 2.0)


def _nearest(triangles: NDArray[np.float64]) -> float:
    """A bound on how near triangles about the origin come, along the largest component of each point: 0 if unknown.

    The cube about the origin that holds no point of a triangle's own box.
    """
    low, high = triangles.min(1), triangles.max(1)
    apart = np.maximum(np.maximum(low, -high), 0.0).max(-1)
    return float(apart.min())
