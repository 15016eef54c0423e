"""Shadow maps: the depth of a scene as a light sees it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ..light import DirectionalLight, DiskLight, PointLight, PolygonLight, RectLight, SphereLight, SpotLight
from ._fit import _fit_orthographic, _fit_perspective, _grow, _light_frame, _snapped
from ._fit import _unit as _unit

__all__ = ["ShadowMap", "shadow_map"]

Cull: TypeAlias = Literal["none", "back", "front"]
Light: TypeAlias = DirectionalLight | PointLight | SpotLight | RectLight | DiskLight | SphereLight | PolygonLight
_MAX_RESOLUTION = 16384
Surface: TypeAlias = Literal["first", "second", "midpoint"]
Bits: TypeAlias = Literal[16, 24, 32] | None
_SURFACES = ("first", "second", "midpoint")
_BITS = (16, 24, 32)


@dataclass(frozen=True, eq=False)
class ShadowMap:
    """The depth of a scene as a light sees it.

    Parameters
    ----------
    depth : array_like, shape (H, W)
        Depth at texel centres, linear along the light's axis, infinite where nothing was hit. Row 0 is the top. Its
        precision is that of every lookup. With `bits`, integers q that stand for near + q · step, the largest of them
        for nothing.
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
    bits : {None, 16, 24, 32}
        Whether depth is stored as integers, and of which size: 16 bits as uint16, 24 and 32 as uint32.
    dtype : float32 or float64
        The precision of lookups where depth is stored as integers; otherwise that of `depth`.
    rounding : float
        World units of depth that drawing may have rounded off, which lookups grant to receivers.
    widest : (float, float)
        The widest light that `pcss` may take it for: of a map that was fitted to receivers, what it reaches aside for.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, a texel is NaN, the frame's rows are not unit vectors square to each
        other and as a light sees them (up is right × axis), the window has no extent, `near` lies beyond `far`, or a
        depth of a perspective map is negative.
    """

    depth: NDArray[Any]
    projection: Literal["perspective", "orthographic"]
    position: NDArray[np.float64]
    frame: NDArray[np.float64]
    window: NDArray[np.float64]
    near: float
    far: float
    light_size: tuple[float, float] = (0.0, 0.0)
    bits: Bits = None
    dtype: np.dtype[Any] = np.dtype(np.float32)  # noqa: RUF009
    rounding: float = 0.0
    widest: tuple[float, float] = (math.inf, math.inf)

    def __post_init__(self) -> None:
        def fix(name: str, value: Any) -> None:
            object.__setattr__(self, name, value)

        depth = _arrays.floats("depth", self.depth) if self.bits is None else _integers(self.depth, self.bits)
        if depth.ndim != 2 or 0 in depth.shape:
            raise ValueError(f"depth: expected shape (H, W), neither zero, got {depth.shape}")
        if np.isnan(depth.min()):
            raise ValueError("depth: expected numbers or infinity, got NaN")
        if self.bits is None and self.projection == "perspective" and depth.min() < 0.0:
            raise ValueError(f"depth: expected none below 0 in a perspective map, got {float(depth.min()):g}")
        fix("depth", depth)
        fix("dtype", depth.dtype if self.bits is None else _arrays.precision("dtype", self.dtype))
        _arrays.choice("projection", self.projection, ("perspective", "orthographic"))
        for name, shape in (("position", (3,)), ("frame", (3, 3)), ("window", (4,))):
            value = _arrays.floats(name, getattr(self, name), np.float64)
            if value.shape != shape or not np.isfinite(value).all():
                raise ValueError(f"{name}: expected shape {shape} of finite numbers, got {value.tolist()}")
            fix(name, value)
        # Frames are rounded to the precision of maps.
        if np.abs(self.frame @ self.frame.T - np.eye(3)).max() > 1e-4:
            raise ValueError(f"frame: expected unit vectors square to each other, got {self.frame.tolist()}")
        if np.linalg.det(self.frame) > 0.0:
            raise ValueError(
                f"frame: expected right, up = right x axis, axis, got a mirrored one, {self.frame.tolist()}"
            )
        left, right, bottom, top = self.window
        if not (left < right and bottom < top):
            raise ValueError(f"window: expected left < right and bottom < top, got {self.window.tolist()}")
        # Parallel maps have their origin anywhere along the axis.
        low = 0.0 if self.projection == "perspective" else -math.inf
        fix("near", _arrays.number("near", self.near, low))
        fix("far", _arrays.number("far", self.far, self.near))
        fix("light_size", _sides("light_size", self.light_size))
        fix("widest", tuple(w if w == math.inf else _arrays.number("widest", w, 0.0) for w in self.widest))
        fix("rounding", _arrays.number("rounding", self.rounding, 0.0))

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

    @property
    def step(self) -> float:
        """The depth between two stored integers, of which rounding loses half at most; 0 where depths are floats."""
        return 0.0 if self.bits is None else (self.far - self.near) / (2**self.bits - 2)

    @property
    def granted(self) -> float:
        """World units of depth that lookups always grant to receivers: `rounding`, and half a `step`."""
        return self.rounding + 0.5 * self.step

    @property
    def bytes(self) -> int:
        """What the depths occupy."""
        return self.depth.nbytes

    def depths(self) -> Floats:
        """Depths as numbers, infinite where there is nothing: `depth` itself, or what its integers stand for."""
        if self.bits is None:
            return self.depth
        found = (self.near + self.step * self.depth.astype(np.float64)).astype(self.dtype)
        found[self.depth == 2**self.bits - 1] = np.inf
        return found

    def texel_size(self, depth: float = 1.0) -> float:
        """The larger side of a texel in world units, at a depth (which matters to a perspective map alone)."""
        left, right, bottom, top = self.window
        height, width = self.depth.shape
        size = max((right - left) / width, (top - bottom) / height)
        return float(size * depth if self.projection == "perspective" else size)

    def _geometry(self) -> list[float]:
        return [*self.position, *self.frame.ravel(), *self.window, self.near]

    def _chart(self, chosen: tuple[NDArray[np.uint8], int] | None = None) -> tuple[Any, ...]:
        """The map as kernels take it, for all receivers or for those that chose it."""
        steps = None if self.bits is None else (self.near, self.step, 2**self.bits - 1)
        return self.depth, self._geometry(), self.projection == "perspective", steps, None, chosen


def _integers(value: Any, bits: Any) -> NDArray[Any]:
    """Stored depths of so many bits."""
    _stored(bits)
    given = _arrays.array("depth", value)
    wanted = np.dtype(np.uint16 if bits == 16 else np.uint32)
    if given.dtype != wanted:
        raise TypeError(f"depth: expected {wanted} for {bits} bits, got {given.dtype}")
    if given.size and int(given.max()) >= 2**bits:
        raise ValueError(f"depth: expected integers below 2**{bits}, got {int(given.max())}")
    return np.require(given, requirements=["C", "A"])


def _sides(name: str, value: Any) -> tuple[float, float]:
    """One width for both sides, or a pair."""
    several = isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim > 0)
    pair = tuple(value) if several else (value, value)
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
    light_size: float | tuple[float, float] | None = None,
    cull: Cull = "none",
    surface: Surface = "first",
    bits: Bits = None,
    snap: bool = False,
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
        A point light and a sphere are seen through one perspective map towards the scene's middle (`cube_shadow_map`
        looks all around), a spot light through one along its axis, a rectangle, a disk or a polygon through one from
        its centre along its normal, a directional light through a parallel one. All are fitted to the mesh. For `pcss`
        round lights and polygons are squares of the same area.
    resolution : int or (int, int)
        Texels along both sides, or (width, height); at most 16384.
    receivers : array_like, shape (..., 3), optional
        Points that will be looked up. The map is then fitted to what lies between them and the light, which gives
        finer texels where a large scene casts onto a small view. Those that are not finite do not count; an empty
        batch asks for nothing, and the map is fitted to the mesh. `pcss` finds all that it looks for; a `pcf` that is
        wider than two texels takes what lies farther out for lit.
    light_size : float or (float, float), optional
        The width that `pcss` will take the light for, where it is more than the light's own: with `receivers` the map
        then reaches as far aside as penumbrae ask. As there, an angle for directional light.
    cull : {"none", "back", "front"}
        Faces that are dropped. "front" keeps what faces away from the light: less acne, more leaks.
    surface : {"first", "second", "midpoint"}
        The depth that is kept: of the first surface that light meets; of the next behind it; or half way between the
        two. With the last two the lit sides of closed bodies need no bias, neither constant nor by slope.
    bits : {None, 16, 24, 32}
        Store depths in integers of so many bits, in equal steps between the nearest and the farthest depth drawn.
    snap : bool
        Of directional light: texels lie at whole multiples of their size, which is one of 8 to an octave, in a frame
        that depends on the mesh and the light alone. Receivers that move then shift the map by whole texels, and
        edges of shadows stay where they are. Costs up to an eighth of the resolution, of more than 8 texels a side.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total).

    Returns
    -------
    ShadowMap

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, a vertex is not finite, no receiver is, the light points nowhere, or
        texels of light that is not directional are to be snapped.

    Notes
    -----
    Depth is linear and exact to a few roundings of its precision; with `bits`, to half a `ShadowMap.step` beside them,
    which lookups grant to receivers. Perspective maps look at most 75 degrees away from their axis; what lies outside
    of a map counts as lit. So a point light within its scene needs `cube_shadow_map`, and a two-sided rectangular light
    is seen from its front alone. Cost: one rasterisation (two for other surfaces than the first), and `resolution`²
    items.

    The second surface is that of the texel's own ray. An open sheet has none of its own: what lies behind it takes its
    place, and with "second" the sheet casts no shadow on it. "midpoint" stands half way, wherever that is. Where bodies
    touch or are thinner than a texel's slope, acne or leaks return.

    References
    ----------
    L. Williams, *Casting Curved Shadows on Curved Surfaces*, 1978. Y. Wang, S. Molnar, *Second-Depth Shadow Mapping*,
    1994. A. Woo, *The Shadow Depth Map Revisited*, Graphics Gems III, 1992 (midpoint).

    Examples
    --------
    >>> from shadelab.light import DirectionalLight
    >>> triangle = [[0.0, 1, 0], [1, 1, 0], [0, 1, 1]]
    >>> light = DirectionalLight(direction=(0, -1, 0), irradiance=(1, 1, 1))
    >>> shadow_map(triangle, [[0, 2, 1]], light, 8).depth.shape
    (8, 8)
    """
    points, triangles = _casters(positions, faces)
    size = _size(resolution)
    _arrays.choice("cull", cull, ("none", "back", "front"))
    how = _how(surface, bits)
    whole = _arrays.flag("snap", snap)
    looked_up = None if receivers is None else _finite("receivers", receivers)
    wide = (0.0, 0.0) if light_size is None else _sides("light_size", light_size)
    if isinstance(light, DirectionalLight) and max(wide) >= math.pi:
        raise ValueError(f"light_size: expected an angle below pi, got {max(wide):g}")

    if whole and not isinstance(light, DirectionalLight):
        raise ValueError(f"snap: expected directional light for whole texels, got {type(light).__name__}")
    if whole and min(size) <= 8:
        raise ValueError(f"snap: expected a resolution above 8 for whole texels, got {min(size)}")
    seen, sides = _fitted(points, triangles, light, size, looked_up, whole, wide)
    drawn = _drawn(points, triangles, seen, size, cull, how, sides, _arrays.progress_callback(progress, "shadow map"))
    fitted = looked_up is not None and looked_up.size > 0
    return replace(drawn, widest=_widest(sides, wide)) if fitted else drawn


class _View(NamedTuple):
    """What a map looks at."""

    perspective: bool
    origin: NDArray[np.float64]
    frame: NDArray[np.float64]
    window: NDArray[np.float64]
    near: float
    far: float


def _fitted(
    points: Floats,
    triangles: NDArray[np.int32],
    light: Light,
    size: tuple[int, int],
    looked_up: Floats | None,
    snap: bool = False,
    wide: tuple[float, float] = (0.0, 0.0),
) -> tuple[_View, tuple[float, float]]:
    """What the one map of a light looks at, and the light's sides."""
    perspective, origin, frame, sides = _light_frame(light, points, None if snap else looked_up)
    # The map and its lookups must round the frame alike.
    origin, frame = (_rounded(a, points.dtype) for a in (origin, frame))
    used = _used(points, triangles)
    if perspective:
        reaching = _widest(sides, wide)
        window, near, far = _fit_perspective(used, points, triangles, origin, frame, looked_up, reaching)
        if isinstance(light, SpotLight) and light.outer_angle < math.pi / 2:
            cone = math.tan(light.outer_angle)
            window = np.clip(window, -cone, cone)
    else:
        origin, window, near, far = _fit_orthographic(used, origin, frame, looked_up, wide)
        origin = _rounded(origin, points.dtype)
    if snap:
        middle = np.array([window[0] + window[1], window[2] + window[3]]) / 2.0
        window = _snapped(middle, float(max(np.ptp(window[:2]), np.ptp(window[2:]), 1e-30)), size, 2.0, 8)
    else:
        window = _grow(window, size)
    return _View(perspective, origin, frame, _rounded(window, points.dtype), near, far), sides


def _widest(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    return max(a[0], b[0]), max(a[1], b[1])


def _drawn(
    points: Floats,
    triangles: NDArray[np.int32],
    seen: _View,
    size: tuple[int, int],
    cull: str,
    how: tuple[str, Bits],
    sides: tuple[float, float],
    watch: Any = None,
) -> ShadowMap:
    """The map of a view that fits the points' precision."""
    surface, bits = how
    depth = np.empty(size[::-1], points.dtype)
    near, far = seen.near, seen.far
    view = (list(seen.origin), seen.frame.tolist(), list(seen.window), near, far, seen.perspective)
    _kernels.shadow_map(points, triangles, view, cull, surface, watch, depth)
    # What was drawn is a tighter bound than what was fitted, and the blocker search starts there.
    drawn = np.isfinite(depth)
    if drawn.any():
        near, far = float(depth.min()), float(depth.max(where=drawn, initial=-np.inf))
    stored: NDArray[Any] = depth
    if bits is not None:
        stored = np.empty(depth.shape, np.uint16 if bits == 16 else np.uint32)
        _kernels.quantize_depth(depth, (near, (far - near) / (2**bits - 2), 2**bits - 1), stored)
    kind: Literal["perspective", "orthographic"] = "perspective" if seen.perspective else "orthographic"
    rounding = _rounding(points, seen)
    return ShadowMap(stored, kind, seen.origin, seen.frame, seen.window, near, far, sides, bits, points.dtype, rounding)


def _rounding(points: Floats, seen: _View) -> float:
    """What drawing may round off.

    Casters' own coordinates were rounded once; depths in parallel maps are drawn as shares of the whole range.
    """
    coordinates = float(np.abs(points).max(initial=0.0))
    return float(np.finfo(points.dtype).eps) * (2.0 * coordinates + (0.0 if seen.perspective else 8.0 * abs(seen.far)))


def _rounded(a: NDArray[np.float64], dtype: Any) -> NDArray[np.float64]:
    return a.astype(dtype).astype(np.float64)


def _casters(positions: ArrayLike, faces: ArrayLike) -> tuple[Floats, NDArray[np.int32]]:
    points = _arrays.vectors("positions", positions)
    if points.ndim != 2:
        raise ValueError(f"positions: expected shape (V, 3), got {points.shape}")
    finite = np.isfinite(points).all(-1)
    if not finite.all():
        raise ValueError(f"positions: vertex {int(np.argmin(finite))} is not finite")
    given = _arrays.array("faces", faces)
    return points, _arrays.indices("faces", given.reshape(0, 3) if given.size == 0 else given, 3, len(points))


def _used(points: Floats, triangles: NDArray[np.int32]) -> Floats:
    """The points that some triangle has for a corner."""
    cast = np.zeros(len(points), bool)
    cast[triangles] = True
    return points if cast.all() else points[cast]


def _size(resolution: Any) -> tuple[int, int]:
    """Width and height in texels."""
    try:
        width, height = (resolution, resolution) if np.ndim(resolution) == 0 else resolution
    except ValueError:
        raise ValueError(f"resolution: expected a number or (width, height), got {resolution!r}") from None
    return (
        _arrays.count("resolution", width, 1, _MAX_RESOLUTION),
        _arrays.count("resolution", height, 1, _MAX_RESOLUTION),
    )


def _how(surface: Any, bits: Any) -> tuple[str, Bits]:
    _arrays.choice("surface", surface, _SURFACES)
    if bits is not None:
        _stored(bits)
    return surface, bits


def _stored(bits: Any) -> None:
    """Refuses sizes of integers that depth is not stored in."""
    if isinstance(bits, bool) or not isinstance(bits, int | np.integer) or bits not in _BITS:
        raise ValueError(f"bits: expected None, 16, 24 or 32, got {bits!r}")


def _finite(name: str, receivers: ArrayLike) -> Floats | None:
    """The points that are finite, (n, 3); None for an empty batch."""
    points = _arrays.vectors(name, receivers).reshape(-1, 3)
    if not len(points):
        return None
    seen = np.isfinite(points).all(-1)
    if not seen.any():
        raise ValueError(f"{name}: expected a finite point, got none among {len(points)}")
    return points if seen.all() else points[seen]
