"""Virtual shadow maps: of a map too large to be held, the pages that a view looks into."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ._sets import MapSet
from .maps import Light, ShadowMap, _casters, _finite, _fitted, _rounding

__all__ = ["VirtualShadowMap", "virtual_shadow_map"]

_LARGEST = 16384


@dataclass(frozen=True, eq=False)
class _Level:
    """One level: the geometry of a whole map, and the pages of it that are there."""

    whole: ShadowMap
    pages: Floats
    table: NDArray[np.int32]
    size: tuple[int, int]
    bits: int

    @property
    def granted(self) -> float:
        return self.whole.granted

    @property
    def position(self) -> NDArray[np.float64]:
        return self.whole.position

    @property
    def axis(self) -> NDArray[np.float64]:
        return self.whole.axis

    @property
    def dtype(self) -> np.dtype[Any]:
        return self.whole.dtype

    @property
    def projection(self) -> str:
        return self.whole.projection

    @property
    def light_size(self) -> tuple[float, float]:
        return self.whole.light_size

    @property
    def bytes(self) -> int:
        return self.pages.nbytes + self.table.nbytes

    def texel_size(self, depth: float = 1.0) -> float:
        return self.whole.texel_size(depth) / max(self.size)

    def _chart(self, chosen: tuple[NDArray[np.uint8], int] | None = None) -> tuple[Any, ...]:
        perspective = self.projection == "perspective"
        return self.pages, self.whole._geometry(), perspective, None, (self.table, self.bits, list(self.size)), chosen


@dataclass(frozen=True, eq=False)
class VirtualShadowMap(MapSet):
    """The pages of a large shadow map that a view looks into: what `virtual_shadow_map` gives.

    Parameters
    ----------
    maps : tuple
        The levels, the finest first.
    border : float
        Texels about every receiver whose pages are there.
    page : int
        Texels along a side of a page.
    eye, pixel :
        What chooses a receiver's level: where the view is from, and the size of its pixels at unit distance.
    needed, reused : int
        Pages that the view looks into, and how many of them were taken from a map before.
    """

    page: int
    eye: tuple[float, float, float]
    pixel: float
    needed: int
    reused: int

    @property
    def resolution(self) -> int:
        """Texels along a side of the whole of the finest level."""
        return int(self.maps[0].size[0])

    @property
    def tables(self) -> tuple[NDArray[np.int32], ...]:
        """For each level where its pages lie among those held, -1 for one that is not there."""
        return tuple(level.table for level in self.maps)

    @property
    def resident(self) -> int:
        """Pages held."""
        return int(sum((level.table >= 0).sum() for level in self.maps))

    @property
    def whole_bytes(self) -> int:
        """What the whole of the finest level would occupy."""
        return self.resolution**2 * self.dtype.itemsize

    @property
    def reuse_rate(self) -> float:
        """The share of the needed pages that a map before had drawn; NaN where none is needed."""
        return self.reused / self.needed if self.needed else math.nan

    def hit_rate(self, receivers: ArrayLike) -> float:
        """The share of receivers that find their page at the level they ask for.

        Parameters
        ----------
        receivers : array_like, shape (..., 3)
            Points in the world.

        Returns
        -------
        float
            1 for those that the map was made for; NaN for none. Others fall back to coarser levels, or are lit.
        """
        points = _arrays.vectors("receivers", receivers, 3, self.dtype).reshape(-1, 3)
        points = np.ascontiguousarray(points[np.isfinite(points).all(-1)])
        wanted = self._wanted(points)
        return float((self._settled(points, wanted.copy()) == wanted).mean()) if len(points) else math.nan

    def _wanted(self, points: Floats) -> NDArray[np.uint8]:
        return _wanted(self.maps[0]._chart(), points, self.eye, self.pixel, len(self.maps))

    def _settled(self, points: Floats, levels: NDArray[np.uint8]) -> NDArray[np.uint8]:
        for i, level in enumerate(self.maps):
            last = i + 1 == len(self.maps)
            moved = levels.copy()
            _kernels.page_settle(level._chart((levels, i)), points, 255 if last else i + 1, moved)
            levels = moved
        return levels

    def _chosen(self, points: Floats) -> tuple[NDArray[np.uint8], None, None]:
        return self._settled(points, self._wanted(points)), None, None


def _wanted(chart: Any, points: Floats, eye: Any, pixel: float, count: int) -> NDArray[np.uint8]:
    """The level that each receiver asks for."""
    levels = np.zeros(len(points), np.uint8)
    if count > 1:
        _kernels.page_levels(chart, points, (list(eye), pixel), count, levels)
    return levels


def virtual_shadow_map(
    positions: ArrayLike,
    faces: ArrayLike,
    light: Light,
    receivers: ArrayLike,
    resolution: int = 8192,
    *,
    page: int = 128,
    border: int = 8,
    eye: ArrayLike | None = None,
    pixel: float | None = None,
    previous: VirtualShadowMap | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> VirtualShadowMap:
    """Draw those pages of a large shadow map that a view looks into.

    Parameters
    ----------
    positions, faces, light
        As in `shadow_map`, and fitted to the mesh as there.
    receivers : array_like, shape (..., 3)
        Points that will be looked up, of a G-buffer say. Those that are not finite do not count.
    resolution : int
        Texels along a side of the whole map: a power of two, at most 16384.
    page : int
        Texels along a side of a page: a power of two, from 64 to the resolution.
    border : int
        Texels about every receiver whose pages are drawn too, for filters.
    eye : array_like, shape (3,), optional
        Where the view is from. With `pixel`, each receiver asks for the level whose texels are no larger than its
        pixel: every level has half the resolution of the one before, down to a page. Without, there is the finest level
        alone.
    pixel : float, optional
        The size of a pixel at unit distance, 2 tan(fov_y / 2) / height.
    previous : VirtualShadowMap, optional
        A map of the same mesh, light and knobs, of a frame before: its pages are taken over as they are. What has
        changed in the mesh is not noticed but by its bounds.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total) for each level.

    Returns
    -------
    VirtualShadowMap
        For `hard`, `pcf` and `pcss`.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range, sizes are not powers of two, only one of `eye` and `pixel` is
        given, or `previous` is of another map.

    Notes
    -----
    Where a page is there, its texels are those of the whole map of its level to the bit (of the finest level, those
    of ``shadow_map(positions, faces, light, resolution)``; others have its window): triangles go through the same
    arithmetic, and only the tiles of pages are drawn. Where it is not, receivers look into the next coarser level
    that has one, and are lit if none has. `pcss` searches from the least depth that pages hold: what stands nearer
    to the light and casts onto none of them widens its search in the whole map alone. Memory is that of pages, 4 or
    8 bytes a texel. Cost: for each level that is asked for, one pass over all vertices and triangles.

    References
    ----------
    A. Lefohn, S. Sengupta, J. Owens, *Resolution-Matched Shadow Maps*, TOG 2007. B. Karis, R. Stubbe, G. Wihlidal,
    *Nanite: A Deep Dive*, SIGGRAPH 2021 courses (virtual shadow maps: pages by what is seen, kept between frames).

    Examples
    --------
    >>> from shadelab.light import DirectionalLight
    >>> from shadelab.mesh import plane
    >>> ground = plane((8.0, 8.0))
    >>> seen = [[0.1, 0, 0.1], [0.2, 0, 0.1]]
    >>> large = virtual_shadow_map(ground.positions, ground.faces, DirectionalLight((0, -1, 0)), seen, 4096)
    >>> large.resident, large.bytes / large.whole_bytes < 0.01, large.hit_rate(seen)
    (1, True, 1.0)
    """
    points, triangles = _casters(positions, faces)
    side, square = _power("resolution", resolution, 64, _LARGEST), _power("page", page, 64, _LARGEST)
    if square > side:
        raise ValueError(f"page: expected at most the resolution, {side}, got {square}")
    margin = _arrays.count("border", border, 0, side)
    if (eye is None) != (pixel is None):
        raise ValueError(f"{'eye' if eye is None else 'pixel'}: expected beside {'pixel' if eye is None else 'eye'}")
    at, size, count = (0.0, 0.0, 0.0), 0.0, 1
    if eye is not None:
        place = _arrays.vectors("eye", eye, 3, np.float64)
        if place.shape != (3,) or not np.isfinite(place).all():
            raise ValueError(f"eye: expected three finite numbers, got {place.tolist()}")
        at, size = (float(place[0]), float(place[1]), float(place[2])), _arrays.number("pixel", pixel, above=0.0)
        count = (side // square).bit_length()
    looked_up = _finite("receivers", _arrays.floats("receivers", receivers, points.dtype))
    seen_from = np.zeros((0, 3), points.dtype) if looked_up is None else np.ascontiguousarray(looked_up)
    watch = _arrays.progress_callback(progress, "virtual shadow map")

    seen, sides = _fitted(points, triangles, light, (side, side), None)
    kind: Any = "perspective" if seen.perspective else "orthographic"
    # One texel stands for the whole: its window, and nothing else of it, is asked for.
    blank = np.full((1, 1), np.inf, points.dtype)
    rounding = _rounding(points, seen)
    whole = ShadowMap(blank, kind, seen.origin, seen.frame, seen.window, seen.near, seen.far, sides, rounding=rounding)
    bits = square.bit_length() - 1
    none = np.zeros((0, square, square), points.dtype)

    def level(size: int, pages: Floats, table: NDArray[np.int32]) -> _Level:
        return _Level(whole, pages, table, (size, size), bits)

    empty = [level(side >> i, none, np.full(2 * (side >> i >> bits,), -1, np.int32)) for i in range(count)]
    if previous is not None:
        _same(previous, empty, square)
    wanted = _wanted(empty[0]._chart(), seen_from, at, size, count)
    view = (list(seen.origin), seen.frame.tolist(), list(seen.window), seen.near, seen.far, seen.perspective)
    made, needed, reused = [], 0, 0
    for i, old in enumerate(empty):
        marks = np.zeros(old.table.shape, np.uint8)
        _kernels.page_marks(old._chart((wanted, i)), seen_from, float(margin), bits, marks)
        there = marks > 0
        n = int(there.sum())
        table = np.full(old.table.shape, -1, np.int32)
        table[there] = np.arange(n)
        pages = np.empty((n, square, square), points.dtype)
        fresh = table.copy()
        if previous is not None:
            before = previous.maps[i]
            kept = there & (before.table >= 0)
            pages[table[kept]] = before.pages[before.table[kept]]
            fresh[kept] = -1
            reused += int(kept.sum())
        if (fresh >= 0).any():
            _draw(points, triangles, view, old.size, fresh, bits, pages)
        made.append(level(old.size[0], pages, table))
        needed += n
        if watch is not None:
            watch(i + 1, count)
    # As of any map, the least depth drawn.
    nearest = min((float(m.pages.min(initial=np.inf)) for m in made), default=math.inf)
    if math.isfinite(nearest):
        whole = replace(whole, near=nearest, far=max(whole.far, nearest))
        made = [replace(m, whole=whole) for m in made]
    return VirtualShadowMap(tuple(made), float(margin), square, at, size, needed, reused)


def _draw(
    points: Floats,
    triangles: NDArray[np.int32],
    view: Any,
    size: tuple[int, int],
    table: NDArray[np.int32],
    bits: int,
    pages: Floats,
) -> None:
    """Draws the pages that a table names, and leaves others as they are."""
    slots = table[table >= 0]
    if len(slots) == len(pages):
        _kernels.shadow_pages(points, triangles, view, list(size), table, bits, None, pages)
        return
    new = np.empty((len(slots), *pages.shape[1:]), pages.dtype)
    packed = np.full(table.shape, -1, np.int32)
    packed[table >= 0] = np.arange(len(slots))
    _kernels.shadow_pages(points, triangles, view, list(size), packed, bits, None, new)
    pages[slots] = new


def _power(name: str, value: Any, low: int, high: int) -> int:
    n = _arrays.count(name, value, low, high)
    if n & (n - 1):
        raise ValueError(f"{name}: expected a power of two, got {n}")
    return n


def _same(previous: Any, levels: list[_Level], page: int) -> None:
    """Refuses pages of another map."""
    if not isinstance(previous, VirtualShadowMap):
        raise TypeError(f"previous: expected a VirtualShadowMap, got {type(previous).__name__}")
    a, b = previous.maps[0].whole, levels[0].whole
    like = previous.page == page and len(previous.maps) == len(levels) and previous.maps[0].size == levels[0].size
    if not (like and a.dtype == b.dtype and a._geometry()[:-1] == b._geometry()[:-1] and a.projection == b.projection):
        raise ValueError("previous: expected a map of the same mesh, light and knobs")
