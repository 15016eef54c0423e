"""Soft shadows from distance fields: the fields, and the rays that ask them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ..accel import BVH
from ..light import DirectionalLight, DiskLight, PointLight, PolygonLight, RectLight, SphereLight, SpotLight
from ._fit import _centroid
from ._lookup import _points, _result
from .maps import Light, _unit

__all__ = ["DistanceGrid", "FieldLookup", "distance_field", "distance_grid"]

Distances: TypeAlias = Callable[[Floats], ArrayLike]
"""Distances of points (n, 3) from the surface, negative inside."""

_MAX_NODES = 1 << 30
_SLAB = 1 << 20


@dataclass(frozen=True, eq=False)
class DistanceGrid:
    """Distances from a scene's surfaces at the nodes of a grid of cubes.

    Parameters
    ----------
    distances : array_like, shape (X, Y, Z)
        In world units, negative inside; node (i, j, k) lies at ``low + cell * (i, j, k)``. Their precision is that of
        every lookup.
    low : array_like, shape (3,)
        The first node.
    cell : float
        The side of a cube.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type or shape, a distance is not finite, there are fewer than two nodes each way,
        or `cell` is not positive.

    Examples
    --------
    >>> grid = DistanceGrid(np.zeros((2, 3, 4), np.float32), (0, 0, 0), 0.5)
    >>> grid.high.tolist(), grid.nbytes
    ([0.5, 1.0, 1.5], 96)
    """

    distances: Floats
    low: NDArray[np.float64]
    cell: float

    def __post_init__(self) -> None:
        values = np.ascontiguousarray(_arrays.floats("distances", self.distances))
        if values.ndim != 3 or min(values.shape) < 2 or max(values.shape) >= 1 << 22:
            raise ValueError(f"distances: expected shape (X, Y, Z), at least 2 each, got {values.shape}")
        if not np.isfinite(values).all():
            raise ValueError("distances: expected finite numbers")
        low = _arrays.vectors("low", self.low, 3, np.float64)
        if low.shape != (3,) or not np.isfinite(low).all():
            raise ValueError("low: expected three finite numbers")
        object.__setattr__(self, "distances", values)
        object.__setattr__(self, "low", low)
        object.__setattr__(self, "cell", _arrays.number("cell", self.cell, above=0.0))

    @property
    def high(self) -> NDArray[np.float64]:
        """The last node."""
        return np.asarray(self.low + self.cell * (np.array(self.distances.shape) - 1))

    @property
    def nbytes(self) -> int:
        """Bytes of the distances."""
        return int(self.distances.nbytes)


def distance_grid(
    sources: BVH | Distances | Sequence[BVH | Distances],
    bounds: ArrayLike | None = None,
    *,
    resolution: int = 64,
    padding: float = 0.1,
    sign: Literal["winding", "angle_weighted", "none"] = "winding",
    dtype: DTypeLike = np.float32,
    progress: bool | Callable[[int, int], object] | None = None,
) -> DistanceGrid:
    """Distances from a scene at the nodes of a grid, for `distance_field`.

    Parameters
    ----------
    sources : BVH, callable, or a sequence of them
        Meshes, or functions from points (n, 3) to distances (n,), negative inside; of several the least counts at every
        node. Closed meshes that overlap, or stand on an open one, should come one by one: each then has an inside.
    bounds : array_like, shape (2, 3), optional
        The lowest and the highest corner that the grid must hold; needed unless all sources are meshes.
    resolution : int
        Cubes along the longest side of the grid.
    padding : float
        Of the longest side of the meshes' bounds, added to each side where `bounds` is not given: surfaces that a ray
        passes by must be in the grid.
    sign : {"winding", "angle_weighted", "none"}
        How the inside of meshes is told, as by `BVH.signed_distance`; "none" for meshes without an inside, whose
        shadows then want ``penumbra="outer"``.
    dtype : float32 or float64
        Of the distances.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total).

    Returns
    -------
    DistanceGrid
        Of (resolution + 1)³ nodes for a cube.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range, the grid would have more than 2³⁰ nodes, or a function gives
        other than one finite number a point.

    Notes
    -----
    Between nodes distances are interpolated: exact beside a flat surface, off by up to a cell where the surface is
    curved or edged within a cell; what is thinner than a cell may fall between nodes and casts no shadow. Memory is 4
    or 8 bytes a node. Cost: a nearest point a node and mesh, and with sign "winding" a winding number, which takes some
    ten times as long; of closed meshes only of the few nodes whose side does not follow from a neighbour's.

    Examples
    --------
    >>> ball = lambda p: np.linalg.norm(p, axis=-1) - 1.0
    >>> grid = distance_grid(ball, [(-2, -2, -2), (2, 2, 2)], resolution=8)
    >>> grid.distances.shape, grid.cell, float(grid.distances[4, 4, 4])
    ((9, 9, 9), 0.5, -1.0)
    """
    if isinstance(sources, BVH) or callable(sources):
        sources = [sources]
    if not isinstance(sources, Sequence):
        raise TypeError(f"sources: expected a BVH, a function or a sequence of them, got {type(sources).__name__}")
    parts = list(sources)
    if not parts:
        raise ValueError("sources: expected at least one")
    for part in parts:
        if not isinstance(part, BVH) and not callable(part):
            raise TypeError(f"sources: expected BVHs or functions, got {type(part).__name__}")
    _arrays.choice("sign", sign, ("winding", "angle_weighted", "none"))
    cubes = _arrays.count("resolution", resolution, 1, _MAX_NODES)
    margin = _arrays.number("padding", padding, 0.0)
    low, high = _bounds(parts, bounds, margin)
    extent = high - low
    cell = float(extent.max()) / cubes
    if not cell > 0.0:
        raise ValueError("bounds: expected an extent")
    nodes = np.maximum(np.ceil(extent / cell - 1e-6).astype(np.int64), 1) + 1
    if math.prod(nodes.tolist()) > _MAX_NODES:
        raise ValueError(f"resolution: {tuple(nodes.tolist())} nodes are more than 2³⁰")

    values = np.full(tuple(nodes), np.inf, _arrays.precision("dtype", dtype))
    axes = [low[i] + cell * np.arange(nodes[i]) for i in range(3)]
    tick = _arrays.progress_callback(progress, "distances")
    step = max(1, _SLAB // (len(axes[1]) * len(axes[2])))
    for k, part in enumerate(parts):
        # Closed meshes have two sides, which their distances alone tell apart almost everywhere.
        closed = part if sign == "winding" and isinstance(part, BVH) and _closed(part) else None
        mine = values if closed is None else np.empty_like(values)
        for first in range(0, len(values), step):
            points = _nodes(axes, first, first + step)
            found = _asked(part, points, sign if closed is None else "none").reshape(-1, *values.shape[1:])
            slab = slice(first, first + len(found))
            mine[slab] = np.minimum(values[slab], found) if closed is None else found
            if tick is not None:
                tick(k * len(values) + slab.stop, len(parts) * len(values))
        if closed is not None:
            np.minimum(values, mine * _sides_of(closed, axes, mine, cell), out=values)
    return DistanceGrid(values, low, cell)


def _nodes(axes: Sequence[NDArray[np.float64]], first: int, end: int) -> NDArray[np.float64]:
    """The nodes of some slabs, (n, 3)."""
    x, y, z = axes
    return np.stack(np.meshgrid(x[first:end], y, z, indexing="ij"), -1).reshape(-1, 3)


def _closed(mesh: BVH) -> bool:
    """Whether every edge is passed as often one way as the other: then the winding number changes at the surface alone.

    Vertices at one place are one.
    """
    faces = np.asarray(mesh.faces)
    if not len(faces):
        return False
    _, place = np.unique(mesh.positions, axis=0, return_inverse=True)
    corners = place.reshape(-1)[faces].astype(np.int64)
    edges = np.stack([corners, np.roll(corners, -1, 1)], -1).reshape(-1, 2)
    low, high = edges.min(-1), edges.max(-1)
    _, which = np.unique(low * (int(place.max()) + 1) + high, return_inverse=True)
    passed = np.bincount(which.reshape(-1), np.where(edges[:, 0] == low, 1.0, -1.0) * (low != high))
    return not passed.any()


# Winding numbers that start a side, before all that are left are asked for.
_SEEDS = 16


def _sides_of(mesh: BVH, axes: Sequence[NDArray[np.float64]], distances: Floats, cell: float) -> NDArray[np.int8]:
    """-1 inside of a closed mesh, 1 outside, at every node.

    Of two neighbours of which one is farther from the surface than from the other, both lie on one side. What one
    winding number tells goes from node to node along such pairs; nodes that none reaches are asked themselves.
    """
    # Roundings of distances aside.
    far = distances > cell * 1.001
    sides = np.zeros(distances.shape, np.int8)

    def ask(which: NDArray[np.intp]) -> None:
        i, j, k = np.unravel_index(which, sides.shape)
        points = np.stack([axes[0][i], axes[1][j], axes[2][k]], -1)
        sides.reshape(-1)[which] = np.where(mesh.signed_distance(points, "winding") < 0, -1, 1)

    for _ in range(_SEEDS):
        left = np.where(sides == 0, distances, -1).reshape(-1)
        seed = int(left.argmax())
        if not left[seed] > cell:
            break
        ask(np.array([seed]))
        while _spread(sides, far):
            pass
    rest = np.flatnonzero(sides == 0)
    for first in range(0, len(rest), _SLAB):
        ask(rest[first : first + _SLAB])
    return sides


def _spread(sides: NDArray[np.int8], far: NDArray[np.bool_]) -> bool:
    """Takes sides on along every axis, forwards and backwards; whether any node got one."""
    before = np.count_nonzero(sides)
    for axis in range(3):
        s, f = np.moveaxis(sides, axis, 0), np.moveaxis(far, axis, 0)
        for order in (range(1, len(s)), range(len(s) - 2, -1, -1)):
            back = 1 if order.step < 0 else -1
            for i in order:
                given = s[i + back]
                take = (s[i] == 0) & (f[i] | f[i + back])
                s[i][take] = given[take]
    return bool(np.count_nonzero(sides) > before)


def _bounds(
    parts: list[Any], bounds: ArrayLike | None, margin: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if bounds is not None:
        box = _arrays.vectors("bounds", bounds, 3, np.float64)
        if box.shape != (2, 3) or not np.isfinite(box).all() or (box[0] > box[1]).any():
            raise ValueError("bounds: expected a lowest and a highest corner, shape (2, 3)")
        return box[0], box[1]
    if not all(isinstance(p, BVH) for p in parts):
        raise ValueError("bounds: expected where a source is a function, which has none of its own")
    corners = [p.positions for p in parts if len(p.positions)]
    if not corners:
        raise ValueError("sources: expected at least one vertex")
    low = np.min([c.min(0) for c in corners], 0).astype(np.float64)
    high = np.max([c.max(0) for c in corners], 0).astype(np.float64)
    more = margin * float((high - low).max())
    return low - more, high + more


def _asked(part: Any, points: NDArray[np.float64], sign: Any) -> NDArray[np.float64]:
    if isinstance(part, BVH):
        if sign == "none":
            return np.asarray(part.closest_point(points).distance, np.float64)
        return np.asarray(part.signed_distance(points, sign), np.float64)
    return _called(part, points)


def _called(function: Distances, points: Floats) -> NDArray[np.float64]:
    found = np.asarray(function(points), np.float64)
    if found.shape != points.shape[:1]:
        raise ValueError(f"field: expected distances of shape {points.shape[:1]}, got {found.shape}")
    if not np.isfinite(found).all():
        raise ValueError("field: expected finite distances")
    return found


class FieldLookup(NamedTuple):
    """What `distance_field` found on its way; arrays of the batch's shape."""

    lit: Floats
    """The lit fraction."""
    closest: Floats
    """How closely the ray passes by things: -1 hides the light, 1 leaves it whole."""
    along: Floats
    """Where it passes so closely, in world units along the ray; 0 where nothing is near."""
    steps: Floats
    """Lookups into the field."""


@overload
def distance_field(
    field: DistanceGrid | Distances,
    receivers: ArrayLike,
    normals: ArrayLike | None,
    light: Light,
    *,
    k: float | None = ...,
    light_size: float | None = ...,
    method: Literal["between", "step"] = ...,
    penumbra: Literal["centered", "outer"] = ...,
    max_steps: int = ...,
    step: float = ...,
    offset: float | None = ...,
    full_output: Literal[False] = ...,
    progress: bool | Callable[[int, int], object] | None = ...,
    out: Floats | None = ...,
) -> Floats: ...
@overload
def distance_field(
    field: DistanceGrid | Distances,
    receivers: ArrayLike,
    normals: ArrayLike | None,
    light: Light,
    *,
    k: float | None = ...,
    light_size: float | None = ...,
    method: Literal["between", "step"] = ...,
    penumbra: Literal["centered", "outer"] = ...,
    max_steps: int = ...,
    step: float = ...,
    offset: float | None = ...,
    full_output: Literal[True],
    progress: bool | Callable[[int, int], object] | None = ...,
    out: Floats | None = ...,
) -> FieldLookup: ...
def distance_field(
    field: DistanceGrid | Distances,
    receivers: ArrayLike,
    normals: ArrayLike | None,
    light: Light,
    *,
    k: float | None = None,
    light_size: float | None = None,
    method: Literal["between", "step"] = "between",
    penumbra: Literal["centered", "outer"] = "centered",
    max_steps: int = 128,
    step: float = 1.0,
    offset: float | None = None,
    full_output: bool = False,
    progress: bool | Callable[[int, int], object] | None = None,
    out: Floats | None = None,
) -> Floats | FieldLookup:
    """Soft shadows from a distance field: one ray to the light's centre, and how closely it passes by things.

    Parameters
    ----------
    field : DistanceGrid or callable
        Distances from what casts shadows: a grid, whose precision governs; or a function from points (n, 3) to
        distances (n,), asked once a step for all rays under way, in the receivers' precision.
    receivers : array_like, shape (..., 3)
        Points in the world.
    normals : array_like, shape (..., 3), or None
        Unit normals of the receivers. With them, rays start off the surface, and the receiver's own plane hides
        nothing.
    light : light of shadelab.light but AmbientLight
        Where rays go, and, unless `k` or `light_size` is given, how wide the light is.
    k : float, optional
        Hardness of the penumbra in place of the light's width: the reciprocal of the tangent of half the angle that the
        light spans; 8 is soft, 128 hard.
    light_size : float, optional
        The light's width in world units, or for a directional light the angle in radians that it spans (0.0093 for the
        sun).
    method : {"between", "step"}
        Whether the nearest point between two steps counts, or those alone that steps fall on, which bands.
    penumbra : {"centered", "outer"}
        Half of the light where the ray just touches, and less within: as an area light casts it, if things are thicker
        than the penumbra is wide; what is thin leaves half of the light behind it. Or none there, and all of the
        penumbra outside of the hard shadow: dark behind what is thin, too dark beside it; right for fields without an
        inside.
    max_steps : int
        Lookups at most, up to 4096; where they do not suffice the rest of the ray counts as free.
    step : float
        Of the distance that a step could take, in (0, 1]; less means more lookups and finds nearer points.
    offset : float, optional
        World units that rays start off the surface along its normal, and before which nothing counts; a cell of the
        grid by default, for a function a thousandth of the receivers' extent.
    full_output : bool
        Also return how closely rays pass by, where, and after how many steps.
    progress : bool or callable, optional
        True shows a bar; a callable gets (done, total).
    out : ndarray, shape (...), optional
        The array to write the lit fraction into.

    Returns
    -------
    ndarray, shape (...), or FieldLookup
        The lit fraction; with `full_output` the named tuple of all arrays. 1 where the ray does not meet the grid; NaN
        where a receiver or normal is not finite.

    Raises
    ------
    TypeError, ValueError
        If an argument has the wrong type, shape or range, or the light has no extent and neither `k` nor `light_size`
        is given.

    Notes
    -----
    A surface d beside the ray, t along it: the least s = d k / t decides. -1 is none of the light, 1 all
    of it, and between them a square light (`RectLight`) or a disk (all others) is cut by a chord ("centered"): exact
    beside a straight edge of something thick, where steps are short; or s is the lit fraction ("outer"). The point
    between steps is right beside an edge, and too near beside what is round. Fails where two things
    hide different parts of the light (only the closer counts), at the foot of things (nothing counts nearer than
    `offset`), for what is thinner than a cell, and where `max_steps` end before the ray does.

    Cost: a lookup between eight nodes a step, some tens of steps a ray; a function costs what it costs.

    References
    ----------
    I. Quilez, *Free penumbra shadows for raymarching distance fields*, 2007 (the least h k / t), 2018 (negative
    distances). S. Aaltonen, *GPU-based clay simulation and ray-tracing tech in Claybook*, GDC 2018 (between steps).

    Examples
    --------
    A wall half way up to a light of side 1, its edge at x = 0: a penumbra of half the light's width outside of it.

    >>> from shadelab.light import RectLight
    >>> light = RectLight(center=(0, 2, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 1), radiance=(1, 1, 1))
    >>> def wall(p):
    ...     beside, above = p[:, 0], np.abs(p[:, 1] - 1.0) - 0.01
    ...     outside = np.hypot(np.maximum(beside, 0.0), np.maximum(above, 0.0))
    ...     return outside + np.minimum(np.maximum(beside, above), 0.0)
    >>> receivers = [[-1.0, 0, 0], [0, 0, 0], [0.125, 0, 0], [0.25, 0, 0], [1, 0, 0]]
    >>> distance_field(wall, receivers, None, light, penumbra="outer", step=0.05).round(2)
    array([0.  , 0.  , 0.24, 0.48, 1.  ])
    """
    if not isinstance(field, DistanceGrid) and not callable(field):
        raise TypeError(f"field: expected a DistanceGrid or a function, got {type(field).__name__}")
    towards, spread = _target(light, k, light_size)
    between = _arrays.choice("method", method, ("between", "step")) == "between"
    outer = _arrays.choice("penumbra", penumbra, ("centered", "outer")) == "outer"
    profile = "outer" if outer else "box" if isinstance(light, RectLight) else "disk"
    most = _arrays.count("max_steps", max_steps, 1, 4096)
    share = _arrays.number("step", step, high=1.0, above=0.0)
    gap = None if offset is None else _arrays.number("offset", offset, high=1e15, above=0.0)
    if isinstance(field, DistanceGrid):
        shape, points, n = _points(field.distances.dtype, receivers, normals)
        result, flat = _result(out, shape, points.dtype)
        more = [np.empty_like(flat) for _ in range(3)]
        cells = 1.0 if gap is None else gap / field.cell
        how = (between, profile, most, share, cells)
        grid = (field.low.tolist(), field.cell)
        watch = _arrays.progress_callback(progress, "distance field")
        _kernels.distance_field(field.distances, grid, points, n, (*towards, *spread), how, watch, flat, more)
        found = more
    else:
        given = {"receivers": receivers} | ({} if normals is None else {"normals": normals})
        shape, points, n = _points(_arrays.result_dtype(**given), receivers, normals)
        result, flat = _result(out, shape, points.dtype)
        if gap is None:
            gap = 1e-3 * (float(np.ptp(points[np.isfinite(points).all(-1)], axis=0).max(initial=0.0)) or 1.0)
        found = _marched(field, points, n, towards, spread, (between, profile, most, share, gap), flat)
    if not _arrays.flag("full_output", full_output):
        return result
    return FieldLookup(result, *(a.reshape(shape) for a in found))


def _target(
    light: Light, k: float | None, light_size: float | None
) -> tuple[tuple[bool, list[float]], tuple[bool, float]]:
    """Whether a position, and it or the direction; whether the tangent of half the angle, and it or half the width."""
    if not isinstance(
        light, RectLight | DiskLight | PolygonLight | SphereLight | PointLight | SpotLight | DirectionalLight
    ):
        raise TypeError(f"light: expected a light of shadelab.light but AmbientLight, got {type(light).__name__}")
    if k is not None and light_size is not None:
        raise ValueError("light_size: expected one of k and light_size, got both")
    half = 0.0
    place: Any
    if isinstance(light, DirectionalLight):
        towards = (False, (-_unit("light", np.asarray(light.direction, np.float64))).tolist())
    else:
        if isinstance(light, RectLight):
            place, half = light.center, 0.5 * math.sqrt(light.area)
        elif isinstance(light, DiskLight | SphereLight):
            place, half = light.center, light.radius
        elif isinstance(light, PolygonLight):
            place, half = _centroid(light.corners), math.sqrt(light.area / math.pi)
        else:
            place = light.position
        towards = (True, [float(x) for x in place])
    if k is not None:
        return towards, (True, 1.0 / _arrays.number("k", k, above=0.0))
    if light_size is not None:
        whole = _arrays.number("light_size", light_size, 0.0)
        if not isinstance(light, DirectionalLight):
            return towards, (False, 0.5 * whole)
        if whole >= math.pi:
            raise ValueError(f"light_size: expected an angle below pi, got {whole:g}")
        return towards, (True, math.tan(0.5 * whole))
    if half == 0.0:
        raise ValueError("light_size: the light has no extent, so its width or k must be given")
    return towards, (False, half)


def _marched(
    function: Distances,
    points: Floats,
    normals: Floats | None,
    towards: tuple[bool, list[float]],
    spread: tuple[bool, float],
    how: tuple[bool, str, int, float, float],
    out: Floats,
) -> list[Floats]:
    """What the kernel does, for a function: all rays take their steps together."""
    between, profile, most, share, gap = how
    dtype = points.dtype
    origin = points if normals is None else points + normals * dtype.type(gap)
    finite = np.isfinite(origin).all(-1)
    away = np.asarray(towards[1], dtype) - (origin if towards[0] else 0)
    away = np.broadcast_to(away, origin.shape)
    length = np.linalg.norm(away, axis=-1)
    reach = length if towards[0] else np.full(len(points), np.inf, dtype)
    with np.errstate(invalid="ignore", divide="ignore"):
        direction = away / length[:, None]
        per = 1.0 / np.maximum(spread[1] if spread[0] else spread[1] / reach, 1e-6)
        rise = np.full(len(points), -1.0) if normals is None else np.einsum("ij,ij->i", normals, direction)
    per = np.broadcast_to(per, len(points))
    closest, along, steps = np.ones_like(out), np.zeros_like(out), np.zeros_like(out)
    floor = 0.0 if profile == "outer" else -1.0
    t, moved, before = np.full(len(points), gap, np.float64), np.zeros(len(points)), np.full(len(points), -1.0)
    active = np.flatnonzero(finite & (t < reach))
    for _ in range(most):
        if not len(active):
            break
        at = t[active]
        h = _called(function, (origin[active] + direction[active] * at[:, None]).astype(dtype))
        d, place = h.copy(), at.copy()
        if between:
            last, back = before[active], np.full(len(active), -1.0)
            seen = (last > 0) & (h > 0)
            m = moved[active]
            back[seen] = (m[seen] ** 2 + h[seen] ** 2 - last[seen] ** 2) / (2 * m[seen])
            inside = (back > 0) & (back < m)
            d[inside] = np.sqrt(np.maximum(h[inside] ** 2 - back[inside] ** 2, 0))
            place[inside] -= back[inside]
        own = (rise[active] > 0) & (h >= (1 - 1e-3) * (gap + at * rise[active]))
        with np.errstate(invalid="ignore", divide="ignore"):
            found = d * per[active] / place
        better = (found < closest[active]) & ~own
        closest[active[better]], along[active[better]] = found[better], place[better]
        steps[active] += 1
        before[active] = h
        moved[active] = np.maximum(share * np.abs(h), 0.25 * gap)
        t[active] += moved[active]
        active = active[(closest[active] > floor) & (t[active] < reach[active])]
    np.maximum(closest, floor, out=closest)
    if profile == "outer":
        out[:] = closest
    elif profile == "box":
        out[:] = 0.5 + 0.5 * closest
    else:
        out[:] = 0.5 + (np.arcsin(closest) + closest * np.sqrt(1 - closest * closest)) / np.pi
    for a in (out, closest, along):
        a[~finite] = np.nan
    return [closest, along, steps]
