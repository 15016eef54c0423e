"""Shadow passes as they are run: the map of a light, and what is looked up in it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import light, shadow
from .._arrays import Floats
from ..accel import BVH


def chart_of(
    settings: Mapping[str, Any], arrays: Any, lamp: Any, camera: Any, size: tuple[int, int], points: Floats
) -> Any:
    """One map of a light, a cube's, cascades, or the pages of a virtual map that points look into."""
    knobs = dict(settings)
    kind, count = knobs.pop("kind", "single"), knobs.pop("cascades", None)
    mesh = arrays.positions, arrays.faces
    if kind == "cube":
        # What a spot light's cone leaves dark is none of the map's business.
        around = light.PointLight(lamp.position) if isinstance(lamp, light.SpotLight) else lamp
        return shadow.cube_shadow_map(*mesh, around, **knobs)
    if kind == "virtual":
        pixel = 2.0 * math.tan(float(camera.fov_y) / 2.0) / size[1]
        return shadow.virtual_shadow_map(*mesh, lamp, points, eye=camera.eye, pixel=pixel, **knobs)
    if count is None:
        return shadow.shadow_map(*mesh, lamp, **knobs, receivers=points)
    forward = -np.asarray(camera.view(), np.float64)[2]
    depths = points @ forward[:3] + forward[3]
    # A plan saw a coarser picture.
    knobs["far"] = max(knobs["far"], float(depths.max(initial=0.0)) * 1.001)
    ways = {"count": count, "method": "logarithmic", "aspect": size[0] / size[1], **knobs}
    return shadow.cascades(*mesh, lamp, camera, **ways)


def lit_by(
    settings: Mapping[str, Any],
    lamp: Any,
    points: Floats,
    normals: Floats,
    chart: Any,
    bvh: BVH | None,
    within: Floats | None = None,
) -> Any:
    """The lit fraction of every receiver, by the technique and the knobs of a pass.

    `within` are all that will ever be looked up, to whose depth moments reach; by default the receivers.
    """
    knobs = dict(settings)
    technique = knobs.pop("technique")
    if technique == "ray_traced":
        assert bvh is not None
        return shadow.ray_traced(bvh, points, normals, lamp, **knobs)
    chart, knobs = shadow._prepared(technique, chart, points if within is None else within, knobs)
    return getattr(shadow, technique)(chart, points, normals, **knobs)
