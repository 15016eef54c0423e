"""Shadows through fields of distances, as questions ask for them: built once a scene, and kept while it lives."""

from __future__ import annotations

import threading
import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import shadow

__all__ = ["field_counters", "field_lit"]

Array = NDArray[Any]

_FIELDS: weakref.WeakKeyDictionary[Any, dict[int, Any]] = weakref.WeakKeyDictionary()
"""The fields of each case, as long as its inputs live."""
_LOCK = threading.Lock()


def _grid(inputs: Any, field_resolution: int) -> Any:
    """The distance field of what casts shadows but for large faces flat under all: built once a scene, as trees are.

    None if nothing else is there.
    """
    low, high = inputs.caster_positions.min(0), inputs.caster_positions.max(0)
    corners, side = inputs.caster_positions[inputs.caster_faces], (high - low).max()
    large = np.ptp(corners, axis=1).max(-1) >= 0.4 * side
    solid = ~(large & (corners[..., 1].max(-1) <= low[1] + 1e-3 * side))
    if not solid.any():
        return None
    with _LOCK:
        kept = _FIELDS.setdefault(inputs, {})
        if field_resolution not in kept:
            bvh = type(inputs.bvh)(inputs.caster_positions, inputs.caster_faces[solid])
            seen = inputs.caster_positions[np.unique(inputs.caster_faces[solid])]
            margin = 0.1 * np.ptp(seen, axis=0).max()
            box = [seen.min(0) - margin, seen.max(0) + margin]
            dtype = inputs.points.dtype
            kept[field_resolution] = shadow.distance_grid(bvh, box, resolution=field_resolution, dtype=dtype)
        return kept[field_resolution]


def field_lit(inputs: Any, prepared: None, field_resolution: int) -> Array:
    """The lit fraction of each light by cones through the field."""
    grid = _grid(inputs, field_resolution)
    if grid is None:
        return np.ones((len(inputs.lights), *inputs.points.shape[:-1]), inputs.points.dtype)
    return np.stack([shadow.distance_field(grid, inputs.points, inputs.geometric, l) for l in inputs.lights])


def field_counters(inputs: Any, field_resolution: int) -> dict[str, float]:
    """The bytes of a field."""
    grid = _grid(inputs, field_resolution)
    return {"bytes": 0 if grid is None else grid.nbytes}
