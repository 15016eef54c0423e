"""Soft shadows from distance fields: the rays that ask them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import shadow as _kernels
from ..light import DirectionalLight, DiskLight, PointLight, PolygonLight, RectLight, SphereLight, SpotLight
from ._fit import _centroid
from ._lookup import _points, _result
from .grids import DistanceGrid, Distances, _called
from .maps import Light, _unit

__all__ = ["FieldLookup", "distance_field"]


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
