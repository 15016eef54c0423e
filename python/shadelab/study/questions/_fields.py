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
    """The distance field of what casts shadows but for what lies flat under all: built once a scene, as trees are."""
    low, high = inputs.caster_positions.min(0), inputs.caster_positions.max(0)
    solid = np.ptp(inputs.caster_positions[inputs.caster_faces], axis=1).max(-1) < 0.4 * (high - low).max()
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
    return np.stack([shadow.distance_field(grid, inputs.points, inputs.geometric, l) for l in inputs.lights])


def field_counters(inputs: Any, field_resolution: int) -> dict[str, float]:
    """The bytes of a field."""
    return {"bytes": _grid(inputs, field_resolution).nbytes}
