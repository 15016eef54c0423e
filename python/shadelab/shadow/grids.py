"""Fields of distances: from meshes or functions, sampled on grids."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _arrays
from .._arrays import Floats
from ..accel import BVH

__all__ = ["DistanceGrid", "distance_grid"]

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
